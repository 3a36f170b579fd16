"""The parser of a command line, on the standard library's argparse.

argparse collects the words of each option; `Declared` converts them to values. Three rules are
beyond argparse, and `with_values` rewrites their words: an option with a single value takes a word
that begins with a minus; ``--floor`` takes a number only; options such as ``--ground`` take several
names, which end before a file. After ``--`` all words are files.
"""

from __future__ import annotations

import argparse
import inspect
import re
import shutil
import textwrap
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, NoReturn

from kilter.cli.commands import COMMANDS, functions_of
from kilter.cli.declarations import Declared, declared_of
from kilter.cli.overview import PURPOSE
from kilter.cli.quantities import number_of
from kilter.errors import InputError, nearest_name
from kilter.values.guesses import meant_word, remedy_of

COMPLETION = "--print-completion"
"""Option of the program that writes a script for a shell."""
FLOOR = "--floor"
"""The option whose value may be missing."""
WIDTH = 80
"""Columns of a help text; narrower where the terminal is narrower."""
MESSAGES = (
    (r"argument ([^:]+): ignored explicit argument (.+)", r"\1 takes no value, but has \2"),
    (r"the following arguments are required: (.+)", r"\1 is missing"),
    (r"argument ([^:]+): (.+)", r"\1: \2"),
)
"""Messages of argparse, and their words here."""


class _Help(argparse.RawDescriptionHelpFormatter):
    """Help texts with the values of an option once: `-o, --output FILE`."""

    def _format_action_invocation(self, action: argparse.Action) -> str:
        if not action.option_strings or action.nargs == 0:
            return super()._format_action_invocation(action)
        return f"{', '.join(action.option_strings)} {action.help_values}"  # type: ignore[attr-defined]


class CommandParser(argparse.ArgumentParser):
    """Parser of a command. Its errors are `InputError`, with the name of the option that is meant.

    - `declared`: the parameters of the command, by name.
    """

    def __init__(self, declared: Sequence[Declared] = (), **settings: Any) -> None:
        super().__init__(formatter_class=_formatter, allow_abbrev=False, **settings)
        # words such as -.5g and -1e-3 are values
        self._negative_number_matcher = re.compile(r"-\.?\d")
        self.declared = {each.name: each for each in declared}
        self.of_name = {name: each for each in declared for name in each.declaration.names}
        groups: dict[str, Any] = {}
        for each in declared:
            panel = each.declaration.panel
            if panel not in groups:
                groups[panel] = self.add_argument_group(panel)
            _add(groups[panel], each)

    def error(self, message: str) -> NoReturn:
        """Raise an error of the parser as InputError."""
        message = " ".join(message.split())
        count = re.fullmatch(r"argument ([^:]+): expected (?:\d+|one) arguments?", message)
        if count:
            name = count[1].split("/")[-1]
            message = f"{name} needs {self.of_name[name].metavar}"
        for pattern, words in MESSAGES:
            message = re.sub(pattern, words, message)
        raise self.wrong(message)

    def wrong(self, message: str) -> InputError:
        """The error for wrong usage, with the command of the help."""
        return InputError(message, hint=f"see '{self.prog} --help'")

    def values(self, words: Sequence[str]) -> dict[str, Any]:
        """Values of the parameters of the command.

        Raises `InputError` if the command line is wrong.
        """
        given, unknown = self.parse_known_intermixed_args(with_values(words, self.of_name))
        if unknown:
            raise self.wrong(self._unknown(unknown[0]))
        return {name: each.value(getattr(given, name)) for name, each in self.declared.items()}

    def _unknown(self, word: str) -> str:
        """Words about a word that the command does not have."""
        name = word.split("=")[0]
        if not word.startswith("-"):
            return f"there is a word too many: {word!r:.60}"
        meant = meant_word(name, set(self.of_name))
        if meant is not None:
            return f"there is no option {name}: use {meant}"
        remedy = remedy_of("--", name.lstrip("-").lower())
        near = nearest_name(name, self.of_name)
        other = f": {remedy}" if remedy else f": did you mean {near}?" if near else ""
        return f"there is no option {name:.40}{other}"


def _formatter(prog: str) -> argparse.HelpFormatter:
    return _Help(prog, max_help_position=26, width=min(_columns(), WIDTH))


def _columns() -> int:
    return shutil.get_terminal_size().columns


def _add(group: Any, each: Declared) -> None:
    """Add a parameter to a group of the parser."""
    declared = each.declaration
    text = declared.help.replace("%", "%%")
    if (
        each.default not in (None, False, ())
        and not each.required
        and not isinstance(each.default, Path)
    ):
        text += f" [default: {str(each.default).replace('%', '%%')}]"
    if not declared.names:
        optional = not each.required
        count = {} if not each.repeats else {"nargs": "+"}
        group.add_argument(
            each.name,
            metavar=each.metavar.strip("[]").removesuffix("..."),
            help=text,
            **({"nargs": "?"} if optional else count),
        )
        return
    if each.is_flag:
        group.add_argument(
            *declared.names, dest=each.name, action="store_const", const=True, help=text
        )
        return
    action = group.add_argument(
        *declared.names,
        dest=each.name,
        action="append" if each.repeats else "store",
        help=text,
        required=each.required,
        **({"nargs": len(each.kinds)} if len(each.kinds) > 1 else {}),
    )
    action.help_values = each.metavar


def with_values(words: Sequence[str], options: Mapping[str, Declared]) -> list[str]:
    """Write ``--option=value`` where argparse would read the value as something else."""
    from kilter.assembly.question import LOWEST  # imported late: a help text does not need it

    result: list[str] = []
    rest = deque(words)
    while rest:
        word = rest.popleft()
        each = options.get(word)
        if word == "--":
            return [*result, *(f"./{name}" if name[:1] == "-" else name for name in rest)]
        if word == FLOOR and each is not None:
            height = rest and number_of(rest[0]) is not None and not Path(rest[0]).exists()
            result.append(f"{word}={rest.popleft() if height else LOWEST}")
        elif each is not None and each.is_list:
            names: list[str] = []
            while rest and not rest[0].startswith("-") and not (names and is_file(rest[0])):
                names.append(rest.popleft())
            result += [f"{word}={name}" for name in names] or [word]
        elif word.startswith("--no-") and word not in options and _saved(word[5:]):
            result.append(f"--off={word[5:]}")
        elif each is not None and not each.is_flag and len(each.kinds) == 1 and rest:
            typed = rest[0].startswith("-") and rest[0] not in options and rest[0] != "--"
            result.append(f"{word}={rest.popleft()}" if typed else word)
            if not typed:
                result.append(rest.popleft())
        else:
            result.append(word)
    return result


def _saved(name: str) -> bool:
    """Whether saved choices have the option of a name."""
    from kilter.files.own.choices_writing import OFF

    return name.replace("-", "_") in OFF


def is_file(word: str) -> bool:
    """Whether a word exists as a path, or ends like a file that kilter reads."""
    from kilter.files.file_content import ENDINGS

    try:
        return Path(word).suffix.lower() in ENDINGS or Path(word).exists()
    except OSError:  # longer than a path may be
        return False


def parser_of(function: Callable[..., int]) -> CommandParser:
    """The parser of the function of a command."""
    declared = declared_of(function)
    command = function.__name__.replace("_", "-")
    arguments = " ".join(each.metavar for each in declared if not each.declaration.names)
    return CommandParser(
        declared,
        prog=f"kilter {command}",
        usage=f"kilter {command} [options] {arguments}",
        description=_paragraphs(function.__doc__ or ""),
        add_help=False,
    )


def _paragraphs(text: str) -> str:
    """Paragraphs of a help text, each filled to the width of the terminal."""
    width = min(_columns(), WIDTH)
    each = inspect.cleandoc(text).split("\n\n")
    return "\n\n".join(textwrap.fill(" ".join(one.split()), width) for one in each).replace(
        "%", "%%"
    )


def help_text(name: str) -> str:
    """The help text of a command."""
    [function] = functions_of(name)
    return parser_of(function).format_help().replace("usage:", "Usage:", 1)


def values_of(function: Callable[..., int], words: Sequence[str]) -> dict[str, Any]:
    """Values of the parameters of a command, from the words after its name.

    Raises `InputError` if the command line is wrong.
    """
    return parser_of(function).values(words)


def completion(shell: str) -> str:
    """A script that completes the words of `kilter` in a shell: bash, fish, tcsh or zsh.

    Raises `InputError` if the extra `completion` is missing, or the shell is unknown.
    """
    try:
        import shtab
    except ImportError:
        raise InputError(
            "completion needs the package shtab", hint="pip install 'kilter[completion]'"
        ) from None
    if shell not in shtab.SUPPORTED_SHELLS:
        raise InputError(
            f"there is no completion for {shell!r:.40}",
            hint=f"give one of {', '.join(shtab.SUPPORTED_SHELLS)}",
        )
    program = argparse.ArgumentParser("kilter", description=PURPOSE)
    program.add_argument("--version", action="store_true", help="Print the version.")
    commands = program.add_subparsers(parser_class=argparse.ArgumentParser)
    for name, function in zip(COMMANDS, functions_of(None), strict=True):
        parent = parser_of(function)
        commands.add_parser(name, parents=[parent], help=parent.description)
    return str(shtab.complete(program, shell))
