"""Conversion of the words of a command line to a `Reading` and a `Tolerance`."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import TYPE_CHECKING

from kilter.errors import InputError
from kilter.files.reading import LOWEST, Reading

if TYPE_CHECKING:
    from kilter.contact import Tolerance

__all__ = [
    "contact_tolerance",
    "pair_of",
    "reading_of",
    "with_floor_value",
    "with_two_names",
]

PAIRS = ("--fasten", "--before", "--screws")
"""Options with two names as their value."""
BOND = "--bond"
"""Option with two names and a pull [N] as its value."""


def reading_of(
    ground: list[str] | None,
    floor: str | None,
    without: list[str] | None,
    down: tuple[float, float, float] | None,
    friction: float | None,
    units: str | None,
    density: float | None,
    fasten: list[str] | None = None,
    fasten_suggested: bool = False,
    fasten_overlaps: bool = False,
    up: str | None = None,
    contacts: str | None = None,
    keyframe: str | None = None,
    base: str | None = None,
    stud_pull: float | None = None,
    stud_shear: str | None = None,
    brick_sides: str | None = None,
    bond: list[str] | None = None,
) -> Reading:
    """Return the reading for the values of the options of a command."""
    return Reading(
        ground=tuple(ground or ()),
        floor=None if floor is None else _height(floor),
        without=tuple(without or ()),
        down=down,
        friction=friction,
        units=units,
        density=density,
        fasten=tuple(pair_of("--fasten", words) for words in fasten or ()),
        fasten_suggested=fasten_suggested,
        fasten_overlaps=fasten_overlaps,
        up=up,
        contacts=contacts,
        keyframe=keyframe,
        base=base,
        stud_pull=stud_pull,
        stud_shear=stud_shear,
        brick_sides=brick_sides,
        bond=tuple(_bond_of(words) for words in bond or ()),
    )


def pair_of(option: str, words: str) -> tuple[str, str]:
    """Return the two names in a value of an option of `PAIRS`, as `with_two_names` wrote it.

    Raises
    ------
    InputError
        If the value does not have two names.
    """
    try:
        first, second = json.loads(words)
    except ValueError:
        first = second = None
    if not (isinstance(first, str) and isinstance(second, str)):
        raise InputError(
            f"{option} has {words!r}", hint=f'give two names after it: {option} "bolt*" "nut*"'
        )
    return first, second


def _bond_of(words: str) -> tuple[str, str, float]:
    """Return the two names and the pull of each point [N], as `with_two_names` wrote them."""
    try:
        first, second, pull = json.loads(words)
        pull = float(pull)
    except (ValueError, TypeError):
        pull = math.nan
    if not (math.isfinite(pull) and pull >= 0 and isinstance(first, str)):
        raise InputError(
            f"{BOND} has {words!r}", hint=f'give two names and newtons: {BOND} "brick*" plate 0.98'
        )
    return first, str(second), pull


def with_two_names(words: list[str]) -> list[str]:
    """Join each ``--fasten A B`` into a single word, since the option parser repeats only these.

    The same holds for every option of `PAIRS` and for ``--bond A B T``.

    Raises
    ------
    InputError
        If two names, or two names and a pull, do not follow the option.

    Examples
    --------
    >>> with_two_names(["check", "--fasten", "bolt*", "nut", "a.json"])
    ['check', '--fasten=["bolt*", "nut"]', 'a.json']
    """
    result: list[str] = []
    k = 0
    while k < len(words):
        if words[k] == "--":
            return result + words[k:]
        option = words[k]
        if option not in (*PAIRS, BOND):
            result.append(words[k])
            k += 1
            continue
        count = 3 if option == BOND else 2
        given = words[k + 1 : k + 1 + count]
        if len(given) < count or any(word.startswith("--") for word in given):
            also, more = (" and newtons", " 0.98") if option == BOND else ("", "")
            raise InputError(
                f"{option} needs two names{also}",
                hint=f'for instance {option} "bolt*" "nut*"{more}',
            )
        result.append(f"{option}={json.dumps(given)}")
        k += 1 + count
    return result


def with_floor_value(words: list[str]) -> list[str]:
    """Add the default value to each ``--floor`` without a height.

    Examples
    --------
    >>> with_floor_value(["--floor", "a.stl"]), with_floor_value(["--floor", "-0.5"])
    (['--floor=lowest', 'a.stl'], ['--floor=-0.5'])
    """
    result: list[str] = []
    rest = iter(range(len(words)))
    for k in rest:
        if words[k] == "--":
            return result + words[k:]
        if words[k] != "--floor":
            result.append(words[k])
            continue
        following = words[k + 1] if k + 1 < len(words) else ""
        if _is_number(following) and not Path(following).exists():
            result.append(f"--floor={following}")
            next(rest)
        else:
            result.append(f"--floor={LOWEST}")
    return result


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True


def _height(floor: str) -> float | str:
    """Return the height of the floor, or the word for the lowest point."""
    try:
        return floor if floor == LOWEST else float(floor)
    except ValueError:
        raise InputError(
            f"--floor has {floor!r}, which is not a height", hint="give a number or no value"
        ) from None


def contact_tolerance(
    gap: float | None, angle: float | None, loose: bool, clearance: float | None = None
) -> Tolerance:
    """Return the tolerance of contacts for the values of the options.

    Raises
    ------
    InputError
        If a value is not positive, or the angle [deg] is 45 or more.
    """
    from kilter.contact import Tolerance

    base = Tolerance.loose() if loose else Tolerance()
    if gap is not None and not (math.isfinite(gap) and gap > 0):
        raise InputError(f"--gap is {gap:g}", hint="give a length above zero, in file units")
    if angle is not None and not (math.isfinite(angle) and 0 < angle < 45):
        raise InputError(f"--angle is {angle:g}", hint="give an angle between 0 and 45 degrees")
    if clearance is not None and not (math.isfinite(clearance) and clearance > 0):
        raise InputError(
            f"--clearance is {clearance:g}", hint="give a length above zero, in file units"
        )
    return Tolerance(
        gap=gap,
        relative_gap=base.relative_gap,
        angle=base.angle if angle is None else math.radians(angle),
        clearance=clearance,
    )
