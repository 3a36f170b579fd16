"""Levels: how surely an assembly holds, the lowest first, and which verdict reaches which.

equilibrium    forces that hold it exist
settles        put down loosely it comes to rest, in every try, and no motion was found
proved         no motion can start, without friction or with it
strict         nor does any motion cost nothing to first order (second order; not built yet)
"""

from __future__ import annotations

from kilter.errors import InputError

__all__ = ["LEVELS", "REQUIRE", "holds", "level_of", "require_level"]

LEVELS = ("equilibrium", "settles", "proved", "strict")
"""From the lowest on."""
REQUIRE = "settles"
"""What is asked for where nothing is said."""
REACHED = {"stable": "proved", "settles": "settles", "potentially-stable": "equilibrium"}
"""The level of a verdict; the others reach none."""


def level_of(verdict: str) -> str | None:
    """The level that a verdict reaches.

    Examples
    --------
    >>> [level_of(word) for word in ("stable", "potentially-stable", "unstable")]
    ['proved', 'equilibrium', None]
    """
    return REACHED.get(verdict)


def holds(level: str | None, require: str) -> bool:
    """Whether a level is the one that is asked for, or above.

    Examples
    --------
    >>> holds("settles", "settles"), holds("settles", "proved"), holds(None, "equilibrium")
    (True, False, False)
    """
    return level is not None and LEVELS.index(level) >= LEVELS.index(require)


def require_level(word: str) -> str:
    """The level that is asked for.

    Raises
    ------
    InputError
        If there is no such level, or it is not built yet.
    """
    if word not in LEVELS:
        raise InputError(
            f"there is no level {word!r:.40}", hint=f"require one of {', '.join(LEVELS[:-1])}"
        )
    if word == "strict":
        raise InputError(
            "motions of second order are not looked at yet, so that nothing is held 'strict'",
            hint="require 'proved'",
            option="give --require proved",
        )
    return word
