"""Levels of confidence that an assembly holds, from the lowest, and the level of each verdict.

equilibrium    forces that hold it exist
settles        put down loosely it comes to rest in every try, and no motion was found
proved         no motion can start, without friction or with it
strict         also a small push does not make it fall: no motion is neutral, or second order
               proves it; a check decides this level only if it is required
"""

from __future__ import annotations

from enum import StrEnum

from kilter.errors import InputError


class VerdictWord(StrEnum):
    """The word of a verdict, such as "stable"; it compares equal to its text.

    Examples
    --------
    >>> VerdictWord.STABLE, VerdictWord.STABLE == "stable", VerdictWord("potentially-stable").name
    ('stable', True, 'POTENTIALLY_STABLE')
    """

    STABLE = "stable"
    SETTLES = "settles"
    POTENTIALLY_STABLE = "potentially-stable"
    BALANCED = "balanced"
    UNSTABLE = "unstable"
    UNDECIDED = "undecided"

    def __repr__(self) -> str:
        return repr(self.value)


LEVELS = ("equilibrium", "settles", "proved", "strict")
"""All levels, from the lowest to the highest."""
REQUIRE = "settles"
"""Level that is required by default."""
REACHED = {
    "stable": "proved",
    "settles": "settles",
    "potentially-stable": "equilibrium",
    "balanced": "equilibrium",
}
"""Level of each verdict. Other verdicts reach no level."""


def level_of(verdict: str, *, strict: bool = False) -> str | None:
    """Return the level (strength of stability, such as "settles") of a verdict; None for no level.

    With `strict`, a stable verdict has the level "strict".

    Examples
    --------
    >>> [level_of(word) for word in ("stable", "potentially-stable", "unstable")]
    ['proved', 'equilibrium', None]
    """
    return "strict" if strict and verdict == "stable" else REACHED.get(verdict)


def holds(level: str | None, require: str) -> bool:
    """Return whether a level of stability is at least the required level.

    Examples
    --------
    >>> holds("settles", "settles"), holds("settles", "proved"), holds(None, "equilibrium")
    (True, False, False)
    """
    return level is not None and LEVELS.index(level) >= LEVELS.index(require)


def level_rank(level: str | None) -> int:
    """Return the rank of a level of stability, from 0 for the lowest; -1 without a level.

    Examples
    --------
    >>> level_rank(None), level_rank("settles")
    (-1, 1)
    """
    return -1 if level is None else LEVELS.index(level)


def require_level(word: str, *, strict: bool = False) -> str:
    """Return `word` if it is a level that a user may require; else raise an error.

    Raises `InputError` if the level does not exist or is not available.
    """
    known = LEVELS if strict else LEVELS[:-1]
    if word not in LEVELS:
        raise InputError(
            f"the level {word!r:.40} does not exist", hint=f"require one of {', '.join(known)}"
        )
    if word not in known:
        raise InputError(
            "the level 'strict' is available only for the check of a single assembly",
            hint="require 'proved'",
            option="give --require proved",
        )
    return word
