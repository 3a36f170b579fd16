"""Exceptions of kilter, and helpers for the words of their messages.

"No" is an answer, not an error: an unstable assembly is a result. Exceptions are raised for wrong
input (`InputError`, exit code 2 of the command) and for failures of kilter itself. They carry
their evidence as attributes.
"""

from __future__ import annotations

import difflib
import os
import re
import shlex
from collections.abc import Iterable, Sequence

FAULT = 70
"""Exit code of the command after a fault of kilter itself."""
NO_MEMORY = "not enough memory; leave parts out, or use coarser meshes"
LONGEST = 80
"""Longest name in a message or in a text [characters]."""
LONGEST_PATH = 300
"""Longest path or command in a message [characters]."""
LONGEST_MESSAGE = 2000
"""Largest number of characters of a message on a terminal."""
QUOTED = re.compile(r"(?<!\w)'((?:[^'\\]|\\.)*+)'(?!\w)")
"""A quoted name in a message; an apostrophe within a word begins no name."""


LIKE = 0.6
"""Least similarity [-] at which a name counts as a misspelling; 'pge' and 'peg' have 0.67."""


class KilterError(Exception):
    """Base class of the exceptions that kilter raises: wrong input, time limit, solver failure."""


class TimeLimitReached(KilterError):
    """Error: the time limit ended a computation before its result was complete.

    Parameters
    ----------
    known : str
        A sentence with the facts that are known; empty if the caller adds them.
    """

    def __init__(self, known: str = "") -> None:
        super().__init__(f"the time limit was reached. {known}".rstrip())
        self.known = known


class InputError(KilterError):
    """Error: wrong input; the message states the problem, its place and the remedy.

    Parameters
    ----------
    what : str
        The problem, without a full stop.
    file : str, optional
        File of the problem.
    part : str, optional
        Name of the part that has the problem.
    hint : str, optional
        Remedy in Python.
    option : str, optional
        Remedy on the command line, if it differs from `hint`.

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
        self.what = _with_short_names(what)
        super().__init__(self.what)
        self.file = file
        self.part = part
        self.hint = hint and _with_short_names(hint, LONGEST_PATH)
        self.option = option and _with_short_names(option, LONGEST_PATH)

    def __str__(self) -> str:
        return self._message(self.hint)

    @property
    def for_command(self) -> str:
        """Message for the command line, with command-line options in place of Python arguments."""
        return self._message(self.option or self.hint)

    def _message(self, hint: str | None) -> str:
        place = [short_name(self.file, LONGEST_PATH)] if self.file else []
        place += [f"part {_short(self.part)}"] if self.part is not None else []
        message = ": ".join([*place, self.what])
        return f"{message}; {hint}" if hint else message

    def located(self, *, file: str | None = None, part: str | None = None) -> InputError:
        """Copy of the error that also names a file and a part, unless it has them already."""
        return type(self)(
            self.what,
            file=self.file or file,
            part=self.part or part,
            hint=self.hint,
            option=self.option,
        )

    def about(self, what: str, *, part: str | None = None) -> InputError:
        """Copy of the error with another statement of the problem and the same remedy."""
        return type(self)(
            what, file=self.file, part=self.part or part, hint=self.hint, option=self.option
        )


class SolverError(KilterError):
    """Error: a solver failed to finish; `status` is its return status. Not for infeasibility."""

    def __init__(self, what: str, *, status: str = "") -> None:
        super().__init__(what)
        self.status = status


def nearest_name(name: str, names: Iterable[str]) -> str | None:
    """The known name most similar to `name`; None if none is similar, or two equally so.

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
    same = [known for known in names if known.casefold() == given.casefold()]
    if len(same) == 1:
        return same[0]
    similar = difflib.get_close_matches(given, names, n=2, cutoff=LIKE)
    likeness = [difflib.SequenceMatcher(None, match, given).ratio() for match in similar]
    return None if not similar or likeness[0] in likeness[1:] else similar[0]


def some_names(names: Sequence[str], limit: int = 5) -> str:
    """Text with the first `limit` names in quotes, and the number of further names.

    Examples
    --------
    >>> some_names(["a", "b", "c"], limit=2)
    "'a', 'b' and 1 more"
    """
    return some([_short(name) for name in names[: limit + 1]], limit, len(names))


def some(words: Sequence[str], limit: int = 5, total: int | None = None) -> str:
    """Text with the first `limit` words, and the number of the others among `total`."""
    total = len(words) if total is None else total
    shown = ", ".join(words[:limit])
    return f"{shown} and {total - limit} more" if total > limit else shown


def _short(name: str) -> str:
    """A name in quotes, cut to `LONGEST` characters."""
    return repr(_cut(name, LONGEST))


def _with_short_names(message: str, width: int = LONGEST) -> str:
    """A message whose quoted names are cut to `width` characters."""
    return QUOTED.sub(lambda found: f"'{_cut(found[1], width)}'", message)


def visible(text: str, keep: str = "") -> str:
    """Escape the characters of a text that do not print, such as line breaks and terminal codes.

    Parameters
    ----------
    text : str
    keep : str
        Characters that stay, such as the line breaks of a text of several lines.

    Examples
    --------
    >>> print(visible("a\\x1b[31mb\\n\\u202ec \xfc"))
    a\\x1b[31mb\\n\\u202ec \xfc
    """
    hidden = [c for c in set(text) if not (c.isprintable() or c in keep)]
    return text.translate({ord(c): repr(c)[1:-1] for c in hidden}) if hidden else text


def message_line(message: str) -> str:
    """A message for a terminal: names are cut, characters that do not print are escaped.

    Examples
    --------
    >>> message_line(f"touches nothing: '{'b' * 70_000}'")[:34]
    "touches nothing: 'bbbbbbbbbbbbbbbb"
    >>> len(message_line(f"touches nothing: '{'b' * 70_000}'"))
    99
    """
    return _cut(visible(_with_short_names(message)), LONGEST_MESSAGE)


def short_name(name: str, width: int = LONGEST) -> str:
    """A name or path for display: escaped as by `visible`, and cut to `width` characters.

    Examples
    --------
    >>> short_name("a\\nb")
    'a\\\\nb'
    >>> short_name("bracket-assembly_1/nut-bolt-assembly_2/nut", width=24)
    'bracket...assembly_2/nut'
    """
    return _cut(visible(_cut(name, 4 * width)), width)


def _cut(text: str, width: int) -> str:
    """A text without its middle, if it is longer than `width` characters."""
    if len(text) <= width:
        return text
    # names from CAD are paths, and their last component identifies the part
    head = (width - 3) // 3
    return f"{text[:head]}...{text[head + 3 - width :]}"


def fault_words(error: Exception, words: Sequence[str]) -> str:
    """Message for an internal error of kilter: the error, its place, and how to report it."""
    import traceback
    from importlib.metadata import version

    last = traceback.extract_tb(error.__traceback__)[-1]
    module = last.filename.replace("\\", "/").rsplit("/kilter/", 1)[-1]
    detail = " ".join(str(error).split())[:200]
    return (
        f"a fault of kilter itself: {type(error).__name__}: {detail} "
        f"(kilter {version('kilter')}, {module}:{last.lineno}); please report it with the "
        f"command 'kilter {' '.join(words)}', the file and the output of 'kilter doctor'"
    )


def shell_words(words: Iterable[str]) -> str:
    """Join words to a shell command, with quotes if needed; double quotes suit Windows, too.

    Examples
    --------
    >>> print(shell_words(["kilter", "check", "a b.stl", "--ground", "bolt*", "--angle", "1"]))
    kilter check "a b.stl" --ground "bolt*" --angle 1
    """
    return " ".join(map(_shell_word, words))


def _shell_word(word: str) -> str:
    # double quotes would not protect these in POSIX shells; Windows has "\\" in paths
    if re.search(r'["$`]' if os.name == "nt" else r'["$`!\\]', word):
        return shlex.quote(word)
    return word if re.fullmatch(r"[\w@%+=:,./-]+", word) else f'"{word}"'
