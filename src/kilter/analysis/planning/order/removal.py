"""Search for free paths out of an assembly for parts that move together, with one or two legs.

A leg is a straight segment of the path.

Directions are tried in this order: given vectors, the axes (upwards first), then for each part the
directions that its contacts suggest: away from all touched parts, and along each contact normal.
A direction that presses against a contact is skipped before any collision test. Contacts between
parts that move together do not count; the path must be free for each of them.

A path of two legs follows d1 up to a point at which two corners are level, or to the midpoint
between two such points, and leaves along d2. (The set of parts that block d2 changes only at such
points.)

A bolt stays while its nut is on. The nut comes off along its axis only, over the thread, and not
together with other parts.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from kilter.analysis.planning.order.sweeps import Direction, Sweeps
from kilter.analysis.planning.states.holds import mask_of, members
from kilter.analysis.planning.states.known_proofs import State
from kilter.analysis.planning.states.states import States
from kilter.arrays import Array, Index, Mask
from kilter.assembly import Load
from kilter.contact import ContactSet
from kilter.contact.contact_tolerances import THREAD
from kilter.contact.curved.coaxial_faces import coaxial_fits
from kilter.errors import InputError
from kilter.rigid import unit

__all__ = [
    "Direction",
    "Leg",
    "Pressed",
    "Pressing",
    "Removal",
    "Screw",
    "direction_of",
    "find_screws",
    "press_loads",
]


NORMALS = 12
"""Largest number of contact normals of a part that are tried as directions."""
PLACES = 200
"""Largest number of turning points of a path that are tried for each direction."""


@dataclass(frozen=True, slots=True)
class Leg:
    """Straight leg of a path: unit direction (world frame) and length [length unit]."""

    direction: Direction
    length: float


@dataclass(frozen=True, slots=True)
class Screw:
    """A bolt and its nut, by index, and the unit axis along which the nut comes off."""

    bolt: int
    nut: int
    axis: Direction


class Removal:
    """Search for free paths out of an assembly for parts that move together.

    Arguments: `directions` (3,): directions in the order in which they are tried; vectors need not
    be unit vectors. Raises `InputError` if a direction is invalid or missing.
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
        self._angle = contacts.searched.angle
        self._contacts_by_part = _contacts_by_part(contacts)
        self._given = [
            direction_of(direction) if not isinstance(direction, str) else direction
            for direction in directions
        ]
        unknown = [
            direction
            for direction in directions
            if isinstance(direction, str) and direction not in SUGGESTED
        ]
        if unknown or not self._given:
            raise InputError(
                f"a direction is {unknown[0] if unknown else 'missing'!r}",
                hint="give axes, normals or x,y,z",
            )
        self._known: dict[int, list[Direction]] = {}
        self.screws = list(screws)

    def way_out(self, moved: int, present: int, *, legs: int = 1) -> tuple[Leg, ...] | None:
        """Free path of `legs` legs for moved parts out of a set of parts; None if none was found.

        Arguments: `moved`, `present`: bit sets (`kilter.analysis.planning.states.holds`) of the
        parts that move together,.
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
            for direction in self._free_directions(moved, others, directions):
                if not any(self.sweeps.stops(part, others, direction) for part in parts):
                    return (Leg(direction, float("inf")),)
            return None
        return self._by_two_legs(moved, others, directions)

    def passes(self, legs: Sequence[Leg], moved: int, present: int) -> bool:
        """Whether a path, which is free without some parts, is free in a set of parts."""
        others, start = np.array(self._members(present & ~moved), dtype=int), np.zeros(3)
        for leg in legs:
            for part in self._members(moved):
                if self.sweeps.leg_stops(
                    part, others, leg.direction, distance=leg.length, start=start
                ):
                    return False
            start = start + (leg.length if np.isfinite(leg.length) else 0.0) * np.array(
                leg.direction
            )
        return True

    def stopping(self, moved: int, present: int, direction: Direction) -> int:
        """Present parts, as a bit set, that block the moved parts along a direction."""
        others = self._members(present & ~moved)
        parts = self._members(moved)
        stop = self.sweeps.stops
        return sum(1 << k for k in others if any(stop(p, 1 << k, direction) for p in parts))

    def lets_go(self, moved: int, present: int) -> bool:
        """Whether moved parts can start in a tried direction without pressing on a contact."""
        others = present & ~moved
        over = any(1 << s.nut == moved and others >> s.bolt & 1 for s in self.screws)
        return over or bool(self._free_directions(moved, others, self.directions(moved)))

    @property
    def threads(self) -> frozenset[tuple[int, int]]:
        """Threads as pairs (index of the bolt, index of the nut)."""
        return frozenset((screw.bolt, screw.nut) for screw in self.screws)

    def over(self, moved: int, present: Mask) -> int | None:
        """Index of the present bolt on whose thread the moved nut is; None if it is on none."""
        on = (s.bolt for s in self.screws if 1 << s.nut == moved and present[s.bolt])
        return next(on, None)

    def touching(
        self, moved: int, present: Mask, direction: Direction
    ) -> tuple[list[int], list[int]]:
        """Indices of the parts that touch moved parts, and of the parts along which these slide."""
        other, normals = self._contacts_of_moved(moved)
        here = present[other]
        slides = here & (np.abs(normals @ np.array(direction)) <= self._angle)
        return np.unique(other[here]).tolist(), np.unique(other[slides]).tolist()

    def directions(self, moved: int) -> list[Direction]:
        """Directions to try for parts that move together, the most promising first."""
        if moved not in self._known:
            directions: list[Direction] = []
            for entry in self._given:
                if not isinstance(entry, str):
                    directions.append(entry)
                else:
                    directions += self._axes() if entry == "axes" else self._normals(moved)
            self._known[moved] = list(dict.fromkeys(directions))
        return self._known[moved]

    def _members(self, parts: int) -> list[int]:
        """Indices of the parts in a bit set."""
        indices: list[int] = members(parts, len(self._contacts_by_part)).tolist()
        return indices

    def _contacts_of_moved(self, moved: int) -> tuple[Index, Array]:
        """For each contact point of moved parts: the other part, and the normal towards it."""
        if not moved & (moved - 1):
            return self._contacts_by_part[moved.bit_length() - 1]
        parts = self._members(moved)
        other = np.concatenate([self._contacts_by_part[part][0] for part in parts])
        normals = np.concatenate([self._contacts_by_part[part][1] for part in parts])
        outside = ~np.isin(other, parts)
        return other[outside], normals[outside]

    def _axes(self) -> list[Direction]:
        """The six axis directions in which removal is tried, the most upward direction first."""
        axes = [direction_of(sign * axis) for sign in (1.0, -1.0) for axis in np.eye(3)]
        return sorted(axes, key=lambda d: -round(float(np.array(d) @ self._up), 9))

    def _normals(self, moved: int) -> list[Direction]:
        """Mean direction away from all parts that moved parts touch, then each single normal."""
        away = -self._contacts_of_moved(moved)[1]
        away = away[np.sort(np.unique(away.round(9), axis=0, return_index=True)[1])]
        mean = away.sum(axis=0)
        first = [mean] if np.linalg.norm(mean) > self._angle else []
        return [direction_of(vector) for vector in [*first, *away[:NORMALS]]]

    def _free_directions(
        self, moved: int, others: int, directions: Iterable[Direction]
    ) -> list[Direction]:
        """Directions along which moved parts do not press on a contact with the other parts."""
        other, normals = self._contacts_of_moved(moved)
        here = np.isin(other, self._members(others))
        most = self._angle
        return [d for d in directions if not (normals[here] @ np.array(d) > most).any()]

    def _by_two_legs(
        self, moved: int, others: int, directions: list[Direction]
    ) -> tuple[Leg, ...] | None:
        """Free path of two legs for moved parts past the other parts; None if none was found."""
        parts, rest = self._members(moved), self._members(others)
        ahead, stops = np.array(rest, dtype=int), self.sweeps.leg_stops
        for first in self._free_directions(moved, others, directions):
            for distance in self._places(parts, rest, first):
                start = distance * np.array(first)
                if any(stops(part, ahead, first, distance=distance) for part in parts):
                    break
                for second in directions:
                    if second in (first, _negative(first)):
                        continue
                    if not any(stops(part, ahead, second, start=start) for part in parts):
                        return Leg(first, distance), Leg(second, float("inf"))
        return None

    def _places(self, parts: list[int], others: list[int], direction: Direction) -> list[float]:
        """Lengths of a first leg at which corners of moved and other parts align; midpoints.

        In ascending order.
        """
        if not others:
            return []
        g, along, sweeps = self._geometry, np.array(direction), self.sweeps

        def heights(group: list[int]) -> Array:
            corners = np.concatenate([g.corners_of(k).reshape(-1, 3) for k in group])
            return np.unique((corners @ along).round(9))

        level = np.unique(heights(others)[:, None] - heights(parts)[None])
        level = level[level > min(sweeps.tolerance(p, q) for p in parts for q in others)]
        least = min(sweeps.tolerance(part, part) for part in parts)
        level = level[np.diff(level, prepend=0.0) > least]
        both = np.sort(np.concatenate([level, (level[1:] + level[:-1]) / 2]))
        return [float(length) for length in both[:PLACES]]


SUGGESTED = ("axes", "normals")
"""Names of the suggested groups of directions."""


def direction_of(vector: ArrayLike) -> Direction:
    """Unit vector of a direction as a dictionary key, rounded and without negative zeros."""
    x, y, z = (unit(np.asarray(vector, dtype=np.float64), "direction") + 0.0).round(12) + 0.0
    return float(x), float(y), float(z)


def _negative(direction: Direction) -> Direction:
    """The opposite of a direction, without negative zeros."""
    x, y, z = (0.0 - component for component in direction)
    return x, y, z


def _contacts_by_part(contacts: ContactSet) -> list[tuple[Index, Array]]:
    """For each part: the other part at each of its contact points, and the normal towards it."""
    a, b = contacts.patch_parts[contacts.point_patch].T
    part, other = np.concatenate([a, b]), np.concatenate([b, a])
    normal = np.concatenate([contacts.normals, -contacts.normals])
    order = np.argsort(part, kind="stable")
    bounds = np.searchsorted(part[order], np.arange(len(contacts.assembly) + 1))
    return [
        (other[order[bounds[k] : bounds[k + 1]]], normal[order[bounds[k] : bounds[k + 1]]])
        for k in range(len(contacts.assembly))
    ]


# Verdicts on an assembly while a force presses an inserted part in.


@dataclass(frozen=True, slots=True, eq=False)
class Pressed:
    """Verdicts on a step: before its part is inserted, and while the part is pressed in."""

    standing: State
    pressed: State | None
    """None if the standing parts do not hold even before."""

    @property
    def stable(self) -> bool | None:
        """Whether the parts hold before the insertion and under the pressing force."""
        return self.standing.stable if self.pressed is None else self.pressed.stable

    @property
    def moves(self) -> Mask:
        """Mask of the moving parts in the first of the two states that falls, shape (N,)."""
        return self.standing.moves if self.pressed is None else self.pressed.moves


@dataclass(slots=True)
class Pressing:
    """Verdicts on the steps of a plan under the force that presses parts in."""

    states: States
    """States without the force."""
    force: float
    """Pressing force [N]."""
    _of: dict[tuple[int, Direction], States] = field(default_factory=dict)

    def judge_of(self, moved: int, direction: Direction) -> Callable[[Mask, Mask], Pressed]:
        """Create the function that judges a step before insertion and under the pressing force.

        Its arguments are the masks of standing and held parts.
        """
        coming = mask_of(moved, len(self.states.assembly))

        def judge(present: Mask, held: Mask) -> Pressed:
            standing = self.states.judge(present, held & present)
            if not standing.stable:
                return Pressed(standing, None)
            pressed = self.states_of(moved, direction).judge(present | coming, held)
            return Pressed(standing, pressed)

        return judge

    def states_of(self, moved: int, direction: Direction) -> States:
        """States of the assembly with the pressing force on the moved parts."""
        key = moved, direction
        if key not in self._of:
            assembly = self.states.assembly
            names = [assembly.names[k] for k in members(moved, len(assembly)).tolist()]
            mass = dict(zip(assembly.names, assembly.geometry.mass.tolist(), strict=True))
            loads = press_loads(names, [mass[name] for name in names], direction, self.force)
            loaded = replace(assembly, loads=[*assembly.loads, *(Load(**load) for load in loads)])
            self._of[key] = States(loaded, self.states.contacts)
        return self._of[key]


def press_loads(
    names: list[str], mass: list[float], direction: Direction, force: float
) -> list[dict[str, Any]]:
    """Loads for a file that distribute a force [N] over parts by mass."""
    along = force * np.array(direction)
    return [
        {"part": name, "force": (along * (share / sum(mass))).tolist(), "torque": [0.0] * 3}
        for name, share in zip(names, mass, strict=True)
    ]


# Bolts with their nuts, as (bolt, nut, axis along which the nut comes off).


def find_screws(contacts: ContactSet, named: Iterable[tuple[str, str]]) -> list[Screw]:
    """Match each named bolt with the nuts around it; return a screw for each pair.

    Raises `InputError` if a pattern matches no part, or no nut of a pair is round a bolt.
    """
    assembly = contacts.assembly
    screw_of: dict[tuple[int, int], Screw] = {}
    for pair in named:
        if isinstance(pair, str) or len(pair) != 2:
            raise InputError(f"screws have {pair!r:.60}", hint="give pairs of a bolt and a nut")
        bolts, nuts = (sorted(map(assembly.index_of, assembly.matching(entry))) for entry in pair)
        wanted = {(bolt, nut) for bolt in bolts for nut in nuts if bolt != nut}
        fits = coaxial_fits(assembly, wanted, contacts.searched, thickest=THREAD, thinnest=THREAD)
        screws = [(fit.ends, fit.axis) for fit in fits if fit.ends in wanted]
        if not screws:
            raise InputError(
                f"no {pair[1]!r} surrounds the shaft of a {pair[0]!r}",
                hint="name the bolt, then the nut",
            )
        for (bolt, nut), axis in screws:
            x, y, z = (float(entry) + 0.0 for entry in axis.round(12))
            screw_of.setdefault((bolt, nut), Screw(bolt, nut, (x, y, z)))
    return list(screw_of.values())
