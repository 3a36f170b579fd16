"""Errors: one root, and each error carries its evidence as attributes.

"No" is an answer, not an error: an unstable assembly is a result. Errors are for wrong
input (`InputError`, exit code 2 of the command) and for a fault of kilter itself.
"""

from __future__ import annotations

import difflib
import re
import shlex
from collections.abc import Iterable, Sequence

__all__ = [
    "InputError",
    "KilterError",
    "SolverError",
    "nearest_name",
    "shell_words",
    "some",
    "some_names",
    "visible",
]


LIKE = 0.6
"""Names less like each other than this are no slips of one another: 'pge' and 'peg' have .67."""


class KilterError(Exception):
    """Root of every error that kilter raises on purpose."""


class InputError(KilterError):
    """Wrong input: says what is wrong, where, and what to do.

    Parameters
    ----------
    what : str
        What is wrong, without a full stop.
    file : str, optional
        The file it is in.
    part : str, optional
        The part it is about.
    hint : str, optional
        What to do about it, in Python.
    option : str, optional
        What to do about it on the command line, where that differs.

    Examples
    --------
    >>> print(InputError("mass is -1", part="C2", hint="give a mass above zero"))
    part 'C2': mass is -1; give a mass above zero
    """

    def __init__(
        self,
        what: str,
        *,
        file: str | None = None,
        part: str | None = None,
        hint: str | None = None,
        option: str | None = None,
    ) -> None:
        super().__init__(what)
        self.what = what
        self.file = file
        self.part = part
        self.hint = hint
        self.option = option

    def __str__(self) -> str:
        return self._said(self.hint)

    @property
    def for_command(self) -> str:
        """The message for who typed a command: options in place of Python."""
        return self._said(self.option or self.hint)

    def _said(self, hint: str | None) -> str:
        place = [self.file] if self.file else []
        place += [f"part {_short(self.part)}"] if self.part is not None else []
        message = ": ".join([*place, self.what])
        return f"{message}; {hint}" if hint else message

    def located(self, *, file: str | None = None, part: str | None = None) -> InputError:
        """The same error with the place filled in where it was unknown."""
        return type(self)(
            self.what,
            file=self.file or file,
            part=self.part or part,
            hint=self.hint,
            option=self.option,
        )

    def about(self, what: str, *, part: str | None = None) -> InputError:
        """The same error with other words for what is wrong, and the same remedy."""
        return type(self)(
            what, file=self.file, part=self.part or part, hint=self.hint, option=self.option
        )


class SolverError(KilterError):
    """A solver broke down (not: said "infeasible"); `status` is what it returned."""

    def __init__(self, what: str, *, status: str = "") -> None:
        super().__init__(what)
        self.status = status


def nearest_name(name: str, names: Iterable[str]) -> str | None:
    """The known name most like `name`; None where none is like it, or two are alike.

    Examples
    --------
    >>> nearest_name("densty", ["density", "mass"])
    'density'
    >>> nearest_name("cube", ["cube-1", "cube-2"]) is None
    True
    >>> nearest_name("c2", ["C1", "C2", "c3"])
    'C2'
    """
    given, names = str(name), list(names)
    same = [one for one in names if one.casefold() == given.casefold()]
    if len(same) == 1:
        return same[0]
    found = difflib.get_close_matches(given, names, n=2, cutoff=LIKE)
    likeness = [difflib.SequenceMatcher(None, one, given).ratio() for one in found]
    return None if not found or likeness[0] in likeness[1:] else found[0]


def some_names(names: Sequence[str], limit: int = 5) -> str:
    """The first names for a message, and how many more there are.

    Examples
    --------
    >>> some_names(["a", "b", "c"], limit=2)
    "'a', 'b' and 1 more"
    """
    return some([_short(name) for name in names[: limit + 1]], limit, len(names))


def some(words: Sequence[str], limit: int = 5, total: int | None = None) -> str:
    """The first of some words, and how many more there are of `total`."""
    total = len(words) if total is None else total
    shown = ", ".join(words[:limit])
    return f"{shown} and {total - limit} more" if total > limit else shown


def _short(name: str, limit: int = 60) -> str:
    return repr(name if len(name) <= limit else name[: limit - 3] + "...")


def visible(text: str) -> str:
    """The text in one line, with what does not print escaped: it moves no cursor, turns no line.

    Examples
    --------
    >>> print(visible("a\\x1b[31mb\\n\\u202ec \xfc"))
    a\\x1b[31mb\\n\\u202ec \xfc
    """
    return "".join(c if c.isprintable() else repr(c)[1:-1] for c in text)


def shell_words(words: Iterable[str]) -> str:
    """A command as it is typed, in the shells of Windows too: quotes are double.

    Examples
    --------
    >>> print(shell_words(["kilter", "check", "a b.stl", "--ground", "bolt*", "--angle", "1"]))
    kilter check "a b.stl" --ground "bolt*" --angle 1
    """
    return " ".join(map(_shell_word, words))


def _shell_word(word: str) -> str:
    if re.search(r'["$`]', word):  # quotes that only some shells know
        return shlex.quote(word)
    return word if re.fullmatch(r"[\w@%+=:,./-]+", word) else f'"{word}"'
