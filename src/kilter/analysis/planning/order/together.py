"""Units of parts that block each other along a direction, so that they can only move together.

For a direction d, let u -> v if v blocks u. A set that leaves along d must contain all parts that
block its members, so no arrow may leave it. The smallest such sets are the strongly connected
components without an outgoing arrow. Let R(u) be all units reached from u: it is such a component
if R(v) = R(u) for each v in it. A component with a single member leaves alone. A component
that reaches a grounded part cannot leave.
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
    """Units of a plan (bit sets of parts that move together): given groups, and single free parts.

    Raises `InputError` if a pattern matches no part, a group has a grounded part, or two groups
    share a part.
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
            raise InputError(
                f"{some_names(twice)} is in two groups", hint="name it in a single group"
            )
        units.append(unit)
        seen |= unit
    return units + [1 << k for k in np.flatnonzero(~grounded).tolist() if not seen >> k & 1]


def blocked_together(
    removal: Removal, units: Sequence[int], present: int, base: int
) -> list[tuple[int, Direction]]:
    """Units that can leave together along a direction, but not separately, each with a direction.

    Returns bit set of moved parts and direction, the fewest parts first.
    """
    directions = list(dict.fromkeys(d for unit in units for d in removal.directions(unit)))
    moves: dict[int, Direction] = {}
    for direction in directions:
        for moved in _components(removal, units, present, base, direction):
            moves.setdefault(moved, direction)
    return sorted(moves.items(), key=lambda move: (move[0].bit_count(), move[0]))


def _components(
    removal: Removal, units: Sequence[int], present: int, base: int, direction: Direction
) -> list[int]:
    """Groups of units that block each other along a direction and are blocked by no other unit."""
    size = present.bit_length()
    unit_of = {part: unit for unit in units for part in members(unit, size).tolist()}
    stops: dict[int, int] = {}

    def stopping(unit: int) -> int:
        if unit not in stops:
            stops[unit] = removal.stopping(unit, present, direction)
        return stops[unit]

    reached: dict[int, int] = {}
    for unit in units:
        component, new = unit, unit
        while new and not component & base:
            other = unit_of[(new & -new).bit_length() - 1]
            new &= ~other
            met = stopping(other)
            if met & base:
                component |= met
                break
            more = sum({unit_of[part] for part in members(met & ~component, size).tolist()})
            component |= more
            new |= more
        reached[unit] = component
    return [
        component
        for component in dict.fromkeys(reached.values())
        if not component & base and component not in units
        and all(reached[other] == component for other in units if other & component)
    ]  # fmt: skip
