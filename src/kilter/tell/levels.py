"""Levels: how surely an assembly holds, the lowest first, and which verdict reaches which.

equilibrium    forces that hold it exist
settles        put down loosely it comes to rest, in every try, and no motion was found
proved         no motion can start, without friction or with it
strict         nor does it fall from a small push: no motion is neutral, or second order says so;
               looked at where it is asked for, by a check
"""

from __future__ import annotations

from kilter.errors import InputError

__all__ = ["LEVELS", "REQUIRE", "holds", "level_of", "require_level"]

LEVELS = ("equilibrium", "settles", "proved", "strict")
"""From the lowest on."""
REQUIRE = "settles"
"""What is asked for where nothing is said."""
REACHED = {
    "stable": "proved",
    "settles": "settles",
    "potentially-stable": "equilibrium",
    "balanced": "equilibrium",
}
"""The level of a verdict; the others reach none."""


def level_of(verdict: str, *, strict: bool = False) -> str | None:
    """The level that a verdict reaches; `strict`: a stable one is that too.

    Examples
    --------
    >>> [level_of(word) for word in ("stable", "potentially-stable", "unstable")]
    ['proved', 'equilibrium', None]
    """
    return "strict" if strict and verdict == "stable" else REACHED.get(verdict)


def holds(level: str | None, require: str) -> bool:
    """Whether a level is the one that is asked for, or above.

    Examples
    --------
    >>> holds("settles", "settles"), holds("settles", "proved"), holds(None, "equilibrium")
    (True, False, False)
    """
    return level is not None and LEVELS.index(level) >= LEVELS.index(require)


def require_level(word: str, *, strict: bool = False) -> str:
    """The level that is asked for; `strict` where that may be it.

    Raises
    ------
    InputError
        If there is no such level, or it is not looked at here.
    """
    known = LEVELS if strict else LEVELS[:-1]
    if word not in LEVELS:
        raise InputError(
            f"there is no level {word!r:.40}", hint=f"require one of {', '.join(known)}"
        )
    if word not in known:
        raise InputError(
            "motions of second order are looked at by a check of one assembly only",
            hint="require 'proved'",
            option="give --require proved",
        )
    return word
