"""Declarations of options and arguments, and the values of the words that a user typed for them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import Field, dataclass, fields
from enum import StrEnum
from types import NoneType
from typing import Any, get_args, get_origin, get_type_hints

from kilter.cli.quantities import READS
from kilter.errors import InputError
from kilter.values.declaration import REQUIRED, Declaration

NUMBERS = {float: "a number", int: "a whole number"}
"""Types of numbers, each in words."""


@dataclass(frozen=True, slots=True)
class Declared:
    """A parameter of a command: its declaration, the types of its values, whether it repeats."""

    name: str
    """Name of the parameter."""
    declaration: Declaration
    """Its names and its help."""
    kinds: tuple[Any, ...]
    """Types of its values; a single `bool` for a flag."""
    repeats: bool
    """Whether the option may be given several times."""
    default: Any
    """Value of an option that is not given; `REQUIRED` where one is required."""

    @property
    def required(self) -> bool:
        """Whether the option, or the argument, must be given."""
        return self.default is REQUIRED

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

        Raises `InputError` if a word is not a number, or not one of the words that the option
        accepts.
        """
        if words is None:
            return self.default
        if self.is_flag:
            return words
        if not self.repeats:
            return self._once(words)
        values = [self._once(each) for each in words]
        return tuple(values) if isinstance(self.default, tuple) else values

    def _once(self, words: str | Sequence[str]) -> Any:
        if isinstance(words, str):
            return self._single(words, self.kinds[0])
        return tuple(map(self._single, words, self.kinds))

    def _single(self, word: str, kind: Any) -> Any:
        if self.declaration.reads:
            return READS[self.declaration.reads](word)
        try:
            return kind(word)
        except ValueError:
            wanted = NUMBERS.get(kind) or f"one of {self.metavar}"
            raise InputError(
                f"{self.label} has {word!r:.40}, not {wanted}",
                hint=f"write {self.label} {self.metavar}",
            ) from None


def declared_in(record: type) -> list[Declared]:
    """The options of a record: its fields with a declaration."""
    kinds = get_type_hints(record)
    return [_declared(each, kinds[each.name]) for each in fields(record) if each.metadata]


def _declared(entry: Field[Any], annotation: Any) -> Declared:
    """The option of a field: types of its values, and whether it repeats, from its annotation."""
    declaration = entry.metadata["option"]
    kind = annotation
    if NoneType in get_args(annotation):
        kind = next(one for one in get_args(annotation) if one is not NoneType)
    repeats = get_origin(kind) is list or Ellipsis in get_args(kind)
    kind = get_args(kind)[0] if repeats else kind
    kinds = get_args(kind) if get_origin(kind) is tuple else (kind,)
    kinds = (str,) if declaration.reads else kinds
    return Declared(entry.name, declaration, kinds, repeats, entry.default)


def declared_of(command: Callable[..., int]) -> list[Declared]:
    """The options and arguments of the function of a command."""
    declared: list[Declared] = command.declared  # type: ignore[attr-defined]
    return declared
