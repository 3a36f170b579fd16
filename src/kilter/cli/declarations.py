"""Declarations of options and arguments, and the values of the words that a user typed for them."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import StrEnum
from types import NoneType
from typing import Any, get_args, get_origin

from kilter.errors import InputError

__all__ = ["Argument", "Declaration", "Declared", "Option", "declared_of"]

NUMBERS = {float: "a number", int: "a whole number"}
"""Types of numbers, each in words."""


@dataclass(frozen=True, slots=True)
class Declaration:
    """An option, or an argument (without names), of a command.

    Attributes
    ----------
    names : tuple of str
        Names of the option on the command line, the long one last.
    help : str
        Its sentence in the help text of the command.
    metavar : str
        Its values in the help text, such as "X Y Z". An option with several names ends with "...".
    panel : str
        Heading of its group in the help text.
    show_default : bool
        Whether the help text has its default.
    reads : callable or None
        Function that converts a word to a value, in place of the type.
    """

    names: tuple[str, ...]
    help: str = ""
    metavar: str = ""
    panel: str = "Options"
    show_default: bool = True
    reads: Callable[[str], Any] | None = None


def Option(*names: str, **settings: Any) -> Any:
    """Declare an option of a command."""
    return Declaration(names, **settings)


def Argument(**settings: Any) -> Any:
    """Declare an argument of a command: a word that follows no option."""
    return Declaration((), panel="Arguments", **settings)


@dataclass(frozen=True, slots=True)
class Declared:
    """A parameter of a command: its declaration, the types of its values, whether it repeats.

    Attributes
    ----------
    name : str
        Name of the parameter.
    declaration : Declaration
        Its names and its help.
    kinds : tuple of type
        Types of its values; a single `bool` for a flag.
    repeats : bool
        Whether the option may be given several times.
    default : object
        Value of an option that is not given; `inspect.Parameter.empty` where one is required.
    """

    name: str
    declaration: Declaration
    kinds: tuple[Any, ...]
    repeats: bool
    default: Any

    @classmethod
    def of(cls, parameter: inspect.Parameter) -> Declared:
        """Take apart the annotation of a parameter: an annotated type, optional or not."""
        annotated, declaration = get_args(parameter.annotation)
        [kind] = (
            [one for one in get_args(annotated) or (annotated,) if one is not NoneType]
            if (NoneType in get_args(annotated))
            else [annotated]
        )
        repeats = get_origin(kind) is list
        kind = get_args(kind)[0] if repeats else kind
        kinds = get_args(kind) if get_origin(kind) is tuple else (kind,)
        return cls(parameter.name, declaration, kinds, repeats, parameter.default)

    @property
    def is_flag(self) -> bool:
        """Whether the option has no value."""
        return self.kinds == (bool,)

    @property
    def is_list(self) -> bool:
        """Whether several names may follow the option."""
        return bool(self.declaration.names) and self.declaration.metavar.endswith("...")

    @property
    def label(self) -> str:
        """Name of the option, or of the argument, for a message."""
        return (self.declaration.names or (self.metavar,))[-1]

    @property
    def metavar(self) -> str:
        """Its values in the help text."""
        if issubclass(self.kinds[0], StrEnum):
            return "|".join(self.kinds[0])
        return self.declaration.metavar

    def value(self, words: Any) -> Any:
        """Value of what the parser collected: a word, nested lists of words, True, or None.

        Raises
        ------
        InputError
            If a word is not a number, or not one of the words that the option accepts.
        """
        if words is None:
            return self.default
        if self.is_flag:
            return words
        if not self.repeats:
            return self._once(words)
        return [self._once(each) for each in words]

    def _once(self, words: str | Sequence[str]) -> Any:
        if isinstance(words, str):
            return self._single(words, self.kinds[0])
        return tuple(map(self._single, words, self.kinds))

    def _single(self, word: str, kind: Any) -> Any:
        if self.declaration.reads is not None:
            return self.declaration.reads(word)
        try:
            return kind(word)
        except ValueError:
            wanted = NUMBERS.get(kind) or f"one of {self.metavar}"
            raise InputError(
                f"{self.label} has {word!r:.40}, not {wanted}",
                hint=f"write {self.label} {self.metavar}",
            ) from None


def declared_of(command: Callable[..., int]) -> list[Declared]:
    """The parameters of the function of a command, whose annotations are declarations."""
    parameters = inspect.signature(command, eval_str=True).parameters.values()
    return [Declared.of(parameter) for parameter in parameters]
