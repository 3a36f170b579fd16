"""Parts that move only as one: what stops one another, along one direction.

Along d, let u -> v where v stops u. What leaves along d has to take with it all that stops any of
it, so the sets that can leave are those that no arrow leaves. The least of them are the strongly
connected components without an arrow outwards: from u, follow all arrows; what is reached is such
a component where from each of its members the same is reached. One of a single member leaves by
itself; one that reaches a grounded part does not leave.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from kilter.analysis.planning.order.removal import Direction, Removal
from kilter.analysis.planning.states.part_sets import members
from kilter.assembly import Assembly
from kilter.errors import InputError, some_names

__all__ = ["blocked_together", "units_of_groups"]


def units_of_groups(assembly: Assembly, groups: Iterable[str | Iterable[str]]) -> list[int]:
    """Sets of parts that move as one: each group, and every other part that is not grounded.

    Parameters
    ----------
    assembly : Assembly
    groups : iterable of str or of iterables of str
        Names; ``*`` and ``?`` are globs.

    Raises
    ------
    InputError
        If a pattern matches no part, a group has a grounded part, or two have one in common.
    """
    units, seen = [], 0
    grounded = assembly.geometry.grounded
    for group in groups:
        names = sorted(assembly.matching(group), key=assembly.index_of)
        if not names:
            raise InputError("a group names no part", hint="name its parts")
        fixed = [name for name in names if assembly[name].grounded]
        if fixed:
            raise InputError(
                f"a group has {some_names(fixed)}, held from the start", hint="leave it out"
            )
        unit = sum(1 << assembly.index_of(name) for name in names)
        if unit & seen:
            twice = [assembly.names[k] for k in members(unit & seen, len(assembly))]
            raise InputError(f"{some_names(twice)} is in two groups", hint="name it in one")
        units.append(unit)
        seen |= unit
    return units + [1 << k for k in np.flatnonzero(~grounded).tolist() if not seen >> k & 1]


def blocked_together(
    removal: Removal, units: Sequence[int], present: int, base: int
) -> list[tuple[int, Direction]]:
    """Sets of several units that leave along a direction as one and no part of them alone.

    Parameters
    ----------
    removal : Removal
    units : sequence of int
        Sets of parts that move as one anyway, all present.
    present, base : int
        Parts that are present; grounded ones.

    Returns
    -------
    list of (int, direction)
        The fewest parts first.
    """
    directions = list(dict.fromkeys(one for unit in units for one in removal.directions(unit)))
    found: dict[int, Direction] = {}
    for direction in directions:
        for moved in _components(removal, units, present, base, direction):
            found.setdefault(moved, direction)
    return sorted(found.items(), key=lambda one: (one[0].bit_count(), one[0]))


def _components(
    removal: Removal, units: Sequence[int], present: int, base: int, direction: Direction
) -> list[int]:
    """Components of several units without an arrow outwards, along one direction."""
    size = present.bit_length()
    unit_of = {part: unit for unit in units for part in members(unit, size).tolist()}
    stops: dict[int, int] = {}

    def stopping(unit: int) -> int:
        if unit not in stops:
            stops[unit] = removal.stopping(unit, present, direction)
        return stops[unit]

    reached: dict[int, int] = {}
    for unit in units:
        found, new = unit, unit
        while new and not found & base:
            one = unit_of[(new & -new).bit_length() - 1]
            new &= ~one
            met = stopping(one)
            if met & base:
                found |= met
                break
            more = sum({unit_of[part] for part in members(met & ~found, size).tolist()})
            found |= more
            new |= more
        reached[unit] = found
    return [
        found
        for found in dict.fromkeys(reached.values())
        if not found & base and found not in units
        and all(reached[one] == found for one in units if one & found)
    ]  # fmt: skip
