"""Ways out for parts that move as one: straight lines, or two, that nothing present stops.

Directions are tried in one order: those that were asked for, the axes (upwards first), then for
each part those that its contacts suggest: away from all that it touches, and along each of its
normals. A direction that presses against a contact is left out before any sweep. Of several parts
that move as one, contacts among themselves do not count, and any of them may be stopped.

A way of two legs goes along d1 to where a corner comes level with another, or half way between
two such places, and leaves along d2. (All places where what stops d2 changes are of that kind.)

A bolt stays while its nut is on, and the nut comes off along its axis alone, over the thread; with
other parts it does not turn.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from kilter.analysis.planning.order.sweeps import Direction, Sweeps
from kilter.analysis.planning.states.part_sets import members
from kilter.arrays import Array, Index, Mask
from kilter.contact import ContactSet
from kilter.errors import InputError
from kilter.rigid import unit

__all__ = ["Direction", "Leg", "Removal", "Screw"]

NORMALS = 12
"""Normals of a part's contacts that are tried as directions."""
PLACES = 200
"""Places at which a way may turn that are tried for each direction."""


@dataclass(frozen=True, slots=True)
class Leg:
    """A straight piece of a way out: unit direction, world frame, and length [length unit]."""

    direction: Direction
    length: float


@dataclass(frozen=True, slots=True)
class Screw:
    """A nut on a bolt, by position, and the axis along which it comes off (unit)."""

    bolt: int
    nut: int
    axis: Direction


class Removal:
    """Ways out of the parts of an assembly.

    Parameters
    ----------
    contacts : ContactSet
    directions : sequence of "axes", "normals" or array_like, shape (3,)
        What is tried, in this order; vectors need not be unit.
    screws : sequence of Screw

    Attributes
    ----------
    sweeps : Sweeps
    screws : list of Screw

    Raises
    ------
    InputError
        If a direction is none.
    """

    def __init__(
        self,
        contacts: ContactSet,
        *,
        directions: Sequence[str | ArrayLike] = ("axes", "normals"),
        screws: Sequence[Screw] = (),
    ) -> None:
        self.sweeps = Sweeps(contacts)
        self._geometry = contacts.assembly.geometry
        self._up = -contacts.assembly.down
        self._angle = contacts.tolerance.angle
        self._touching = _touching(contacts)
        self._given = [_direction(one) if not isinstance(one, str) else one for one in directions]
        unknown = [one for one in directions if isinstance(one, str) and one not in SUGGESTED]
        if unknown or not self._given:
            raise InputError(
                f"a direction is {unknown[0] if unknown else 'missing'!r}",
                hint="give axes, normals or x,y,z",
            )
        self._known: dict[int, list[Direction]] = {}
        self.screws = list(screws)

    def way_out(self, moved: int, present: int, *, legs: int = 1) -> tuple[Leg, ...] | None:
        """A way out of parts past those of a set, of so many legs; None where none was found.

        Parameters
        ----------
        moved, present : int
            Sets, as of `kilter.analysis.planning.states.part_sets`; what is moved moves as one.
        legs : {1, 2}
        """
        others = present & ~moved
        directions = self.directions(moved)
        for screw in self.screws:
            bolt, nut = 1 << screw.bolt, 1 << screw.nut
            if (moved & bolt and others & nut) or (moved & nut and moved != nut and others & bolt):
                return None
            if moved == nut and others & bolt:
                back = _negative(screw.axis)
                directions, others, legs = [screw.axis, back], others & ~bolt, 1
        if legs == 1:
            parts = self._members(moved)
            for direction in self._unpressed(moved, others, directions):
                if not any(self.sweeps.stops(part, others, direction) for part in parts):
                    return (Leg(direction, float("inf")),)
            return None
        return self._by_two_legs(moved, others, directions)

    def stopping(self, moved: int, present: int, direction: Direction) -> int:
        """All parts of a set that stop some parts along a direction."""
        others = self._members(present & ~moved)
        parts = self._members(moved)
        stop = self.sweeps.stops
        return sum(1 << k for k in others if any(stop(p, 1 << k, direction) for p in parts))

    def lets_go(self, moved: int, present: int) -> bool:
        """Whether no contact presses along one of the directions that are tried."""
        others = present & ~moved
        over = any(1 << s.nut == moved and others >> s.bolt & 1 for s in self.screws)
        return over or bool(self._unpressed(moved, others, self.directions(moved)))

    @property
    def threads(self) -> frozenset[tuple[int, int]]:
        """Bolts and nuts, by position."""
        return frozenset((one.bolt, one.nut) for one in self.screws)

    def over(self, moved: int, present: Mask) -> int | None:
        """The bolt that a nut comes off, of the parts present; None where it is on none."""
        on = (one.bolt for one in self.screws if 1 << one.nut == moved and present[one.bolt])
        return next(on, None)

    def touching(
        self, moved: int, present: Mask, direction: Direction
    ) -> tuple[list[int], list[int]]:
        """Present parts that some parts touch, and those that they slide along in a direction."""
        other, normals = self._touched(moved)
        here = present[other]
        slides = here & (np.abs(normals @ np.array(direction)) <= self._angle)
        return np.unique(other[here]).tolist(), np.unique(other[slides]).tolist()

    def directions(self, moved: int) -> list[Direction]:
        """Directions that are tried for parts that move as one, in their order."""
        if moved not in self._known:
            found: list[Direction] = []
            for one in self._given:
                if not isinstance(one, str):
                    found.append(one)
                else:
                    found += self._axes() if one == "axes" else self._normals(moved)
            self._known[moved] = list(dict.fromkeys(found))
        return self._known[moved]

    def _members(self, parts: int) -> list[int]:
        found: list[int] = members(parts, len(self._touching)).tolist()
        return found

    def _touched(self, moved: int) -> tuple[Index, Array]:
        """The part of each contact point of some parts with another, and the normal towards it."""
        if not moved & (moved - 1):
            return self._touching[moved.bit_length() - 1]
        parts = self._members(moved)
        other = np.concatenate([self._touching[part][0] for part in parts])
        normals = np.concatenate([self._touching[part][1] for part in parts])
        outside = ~np.isin(other, parts)
        return other[outside], normals[outside]

    def _axes(self) -> list[Direction]:
        axes = [_direction(sign * axis) for sign in (1.0, -1.0) for axis in np.eye(3)]
        return sorted(axes, key=lambda d: -round(float(np.array(d) @ self._up), 9))

    def _normals(self, moved: int) -> list[Direction]:
        """Away from all that is touched, then along each normal away from a part."""
        away = -self._touched(moved)[1]
        away = away[np.sort(np.unique(away.round(9), axis=0, return_index=True)[1])]
        mean = away.sum(axis=0)
        found = [mean] if np.linalg.norm(mean) > self._angle else []
        return [_direction(one) for one in [*found, *away[:NORMALS]]]

    def _unpressed(
        self, moved: int, others: int, directions: Iterable[Direction]
    ) -> list[Direction]:
        """Directions that press against no contact with a part of a set."""
        other, normals = self._touched(moved)
        here = np.isin(other, self._members(others))
        most = self._angle
        return [d for d in directions if not (normals[here] @ np.array(d) > most).any()]

    def _by_two_legs(
        self, moved: int, others: int, directions: list[Direction]
    ) -> tuple[Leg, ...] | None:
        parts, rest = self._members(moved), self._members(others)
        pairs = [(part, other) for part in parts for other in rest]
        for first in self._unpressed(moved, others, directions):
            for distance in self._places(parts, rest, first):
                start = distance * np.array(first)
                if any(self.sweeps.pair_stops(*pair, first, distance=distance) for pair in pairs):
                    break
                for second in directions:
                    if second in (first, _negative(first)):
                        continue
                    if not any(self.sweeps.pair_stops(*p, second, start=start) for p in pairs):
                        return Leg(first, distance), Leg(second, float("inf"))
        return None

    def _places(self, parts: list[int], others: list[int], direction: Direction) -> list[float]:
        """Lengths of a first leg: where corners come level, and half way between, ascending."""
        if not others:
            return []
        g, along, sweeps = self._geometry, np.array(direction), self.sweeps

        def heights(some: list[int]) -> Array:
            corners = np.concatenate([g.corners_of(k).reshape(-1, 3) for k in some])
            return np.unique((corners @ along).round(9))

        level = np.unique(heights(others)[:, None] - heights(parts)[None])
        level = level[level > min(sweeps.tolerance(p, q) for p in parts for q in others)]
        least = min(sweeps.tolerance(part, part) for part in parts)
        level = level[np.diff(level, prepend=0.0) > least]
        both = np.sort(np.concatenate([level, (level[1:] + level[:-1]) / 2]))
        return [float(one) for one in both[:PLACES]]


SUGGESTED = ("axes", "normals")
"""Directions by name."""


def _direction(vector: ArrayLike) -> Direction:
    """A unit vector as a key: no minus zero."""
    x, y, z = (unit(np.asarray(vector, dtype=np.float64), "direction") + 0.0).round(12) + 0.0
    return float(x), float(y), float(z)


def _negative(direction: Direction) -> Direction:
    x, y, z = (0.0 - one for one in direction)
    return x, y, z


def _touching(contacts: ContactSet) -> list[tuple[Index, Array]]:
    """Of each part, the other part of each of its contact points, and the normal towards it."""
    a, b = contacts.patch_parts[contacts.point_patch].T
    part, other = np.concatenate([a, b]), np.concatenate([b, a])
    normal = np.concatenate([contacts.normals, -contacts.normals])
    order = np.argsort(part, kind="stable")
    bounds = np.searchsorted(part[order], np.arange(len(contacts.assembly) + 1))
    return [
        (other[order[bounds[k] : bounds[k + 1]]], normal[order[bounds[k] : bounds[k + 1]]])
        for k in range(len(contacts.assembly))
    ]
