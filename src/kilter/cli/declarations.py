"""Declarations of options and arguments, and the values of a usual command line.

The library of options takes longer to import than a small assembly takes to check. `usual_values`
therefore reads the usual command lines from the declarations alone. The library reads all others,
among them each faulty command line, and writes the help texts.
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import NoneType
from typing import Any, get_args, get_origin

__all__ = ["Argument", "Declaration", "Option", "usual_values"]

PLAIN_SETTINGS = {"metavar", "help", "rich_help_panel", "show_default"}
"""Settings of a declaration that do not change values."""
READERS: dict[Any, tuple[re.Pattern[str], Callable[[str], Any]]] = {
    str: (re.compile(r".+", re.DOTALL), str),
    Path: (re.compile(r".+", re.DOTALL), Path),
    int: (re.compile(r"[0-9]{1,9}"), int),
    float: (re.compile(r"[0-9]{1,9}(\.[0-9]{1,17})?(e-?[0-9]{1,2})?"), float),
}
"""For each type of a value: the words of it that are read here, and the conversion of a word."""


@dataclass(frozen=True, slots=True)
class Declaration:
    """An option or argument of a command, as the library of options declares it.

    Attributes
    ----------
    kind : str
        "Option" or "Argument".
    names : tuple of str
        Names of the option on the command line; empty for an argument.
    settings : dict
        Further settings: help text and others.
    """

    kind: str
    names: tuple[str, ...]
    settings: dict[str, Any]


def Option(*names: str, **settings: Any) -> Any:
    """Declare an option of a command."""
    return Declaration("Option", names, settings)


def Argument(**settings: Any) -> Any:
    """Declare an argument of a command: a word that follows no option."""
    return Declaration("Argument", (), settings)


@dataclass(frozen=True, slots=True)
class _Declared:
    """A parameter of a command: its declaration, the type of its values, whether it repeats."""

    declaration: Declaration
    kind: Any
    repeats: bool

    @classmethod
    def of(cls, parameter: inspect.Parameter) -> _Declared:
        """Take apart the annotation of a parameter: an annotated type, optional or not."""
        annotated, declaration = get_args(parameter.annotation)
        kinds = [kind for kind in get_args(annotated) if kind is not NoneType]
        optional = NoneType in get_args(annotated) and len(kinds) == 1
        kind = kinds[0] if optional else annotated
        repeats = get_origin(kind) is list
        return cls(declaration, get_args(kind)[0] if repeats else kind, repeats)

    def value(self, word: str) -> Any:
        """Value of a word; None if the library of options must read it."""
        pattern, convert = READERS.get(self.kind, (None, None))
        plain = self.declaration.settings.keys() <= PLAIN_SETTINGS and not word.startswith("-")
        if pattern is None or convert is None or not plain or not pattern.fullmatch(word):
            return None
        return convert(word)


def usual_values(command: Callable[..., int], words: Sequence[str]) -> dict[str, Any] | None:
    """Values of the parameters of a command for a usual command line; None for all others.

    A usual command line has each option by its full name, followed by its value as a separate word.

    Parameters
    ----------
    command : callable
        Function of the command; each parameter is annotated with a `Declaration`.
    words : sequence of str
        Words of the command line after the name of the command.
    """
    parameters = inspect.signature(command, eval_str=True).parameters
    declared = {name: _Declared.of(parameter) for name, parameter in parameters.items()}
    arguments = [name for name in declared if declared[name].declaration.kind == "Argument"]
    options = {each: name for name in declared for each in declared[name].declaration.names}
    typed: list[tuple[str, Any]] = []
    rest = iter(words)
    for word in rest:
        if word.startswith("-"):
            name = options.get(word)
            if name is None:
                return None
            flag = declared[name].kind is bool
            typed.append((name, True if flag else declared[name].value(next(rest, ""))))
        elif arguments:
            name = arguments[0] if declared[arguments[0]].repeats else arguments.pop(0)
            typed.append((name, declared[name].value(word)))
        else:
            return None
    values: dict[str, Any] = {}
    for name, value in typed:
        if value is None or (name in values and not declared[name].repeats):
            return None
        values[name] = [*values.get(name, ()), value] if declared[name].repeats else value
    missing = {name: parameters[name].default for name in parameters.keys() - values.keys()}
    return None if inspect.Parameter.empty in missing.values() else values | missing
