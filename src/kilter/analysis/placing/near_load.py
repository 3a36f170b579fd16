"""A load that is shifted on a large assembly, decided by the parts near it alone.

Let S be some of the free parts. From known forces f of equilibrium of the whole assembly follow

    places that stand   forces within S that carry the load, the weights of S and the forces f of
                        the other parts on S; with f elsewhere they balance the whole assembly
    places that fall    a motion of S that no contact prevents while all other parts are held: it
                        is a motion of the whole assembly

For the forces S has the parts below the load, for the motions also all parts that rest on these, at
first only the nearest. If both sets of places meet, they are the answer, and the size of the
assembly does not count. Otherwise the whole is searched.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from kilter.analysis.placing.moving_load import MovingLoad
from kilter.analysis.placing.polygon_sets import both, without
from kilter.analysis.placing.shifted_load import SAME, CarriedPlaces, ShiftedLoad, meet
from kilter.arrays import Array, Index, Mask
from kilter.mechanics.certificate import ForceProof
from kilter.mechanics.load_checks import check_load_forces
from kilter.mechanics.program import Program

Points = tuple[tuple[Array, ForceProof], ...]
"""Carried shifts and their forces."""
LARGE = 0.5
"""Share of the free parts above which the parts near a load are no smaller problem [-]."""
NEAREST = (64, 192)
"""Numbers of parts that are tried first if there are more near a load."""
RESTS = 0.1
"""Least cosine between a normal and the vertical if a part rests on the other at a row [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class NearParts:
    """Free parts that are near a load in a program, with the rows at them."""

    near: Mask
    """Shape (N,)."""
    rows: Index
    """All rows at these parts."""
    inside: Mask
    """Mask of the rows without an end at another free part."""

    @classmethod
    def of(
        cls, program: Program, part: int, *, above: bool, most: float = np.inf
    ) -> NearParts | None:
        """The parts below a part that carries a load; None if they are too many.

        Arguments: `above`: whether all parts that rest on these are included; `most`: number of
        them that count, the nearest to a vertical line through the part.
        """
        free = np.append(program.free, False)  # the ground is the last
        rises = -program.normal @ program.down
        lower = np.where(rises > 0, program.part_a, program.part_b)
        upper = np.where(rises > 0, program.part_b, program.part_a)
        rests = (np.abs(rises) > RESTS) & free[lower] & free[upper]
        lower, upper = lower[rests], upper[rests]
        near = _reached(free, part, lower, upper, above)
        if near.sum() > most:
            arm = program.center - program.center[part]
            aside = np.linalg.norm(arm - np.outer(arm @ program.down, program.down), axis=1)
            aside[[part, *lower[upper == part].tolist()]] = -1.0  # the load touches these
            if (aside < 0).sum() > most:
                return None
            chosen = np.flatnonzero(near)
            few = np.zeros(len(free), dtype=bool)
            few[chosen[np.argsort(aside[chosen], kind="stable")[: int(most)]]] = True
            both = few[lower] & few[upper]
            near = _reached(few, part, lower[both], upper[both], above)
        if not 0 < near.sum() <= LARGE * free.sum():
            return None
        ends = np.stack([program.part_a, program.part_b])
        rows = np.flatnonzero(near[ends].any(axis=0))
        crossing = (free & ~near)[ends[:, rows]].any(axis=0)
        return cls(near[:-1], rows, np.asarray(~crossing))

    def alone(self, program: Program) -> Program:
        """The program in which all other parts are held."""
        return program.with_rows(free=self.near).taking(self.rows)

    def loaded(self, program: Program, base: ForceProof) -> Program:
        """The program of these parts under the known forces of the others."""
        alone = self.alone(program)
        forces, friction = base.forces[self.rows], base.friction[self.rows]
        others = alone.wrenches(
            np.where(self.inside, 0.0, forces), np.where(self.inside[:, None], 0.0, friction)
        )
        return alone.taking(self.inside).with_rows(applied=program.applied + others)

    def without_last(self, count: int) -> NearParts:
        """The same without the last part, for a program with only the first `count` rows."""
        known = self.rows < count
        return NearParts(self.near[:-1], self.rows[known], self.inside[known])

    def lifted(self, points: Points, program: Program, wrenches: Array, base: ForceProof) -> Points:
        """The shifts that forces of these parts carry, with forces of all parts.

        Arguments: `points`: shifts and forces of the rows inside; `wrenches` (2, N, 6): change of
        the load per unit of shift; `base`: known forces, which the other parts keep.
        """
        if not points:
            return ()
        shifts, rows = np.array([shift for shift, _ in points]), self.rows[self.inside]
        forces = np.repeat(base.forces[None], len(shifts), axis=0)
        friction = np.repeat(base.friction[None], len(shifts), axis=0)
        forces[:, rows] = [proof.forces for _, proof in points]
        friction[:, rows] = [proof.friction for _, proof in points]
        checked = check_load_forces(
            self.alone(program),
            np.tensordot(shifts, wrenches, axes=1),
            forces[:, self.rows],
            friction[:, self.rows] if friction.any() else None,
        )
        return tuple(
            (shift, ForceProof(along, across, max(proof.residual, base.residual), proof.holds))
            for shift, along, across, proof in zip(shifts, forces, friction, checked, strict=True)
            if proof.holds
        )


def _reached(free: Mask, part: int, lower: Index, upper: Index, above: bool) -> Mask:
    """The free parts on which a part rests, with `above` also all that rest on these."""
    near = np.zeros(len(free), dtype=bool)
    near[part] = free[part]
    ways = [(upper, lower), (lower, upper)]
    for start, end in ways if above else ways[:1]:
        count = 0
        while count < near.sum():
            count = int(near.sum())
            near[end[near[start]]] = True
    return near


def most_parts(program: Program) -> list[float]:
    """Numbers of parts near a load that are tried in a program, the smallest first."""
    free = int(program.free.sum())
    return [*(most for most in NEAREST if 2 * most < free), np.inf]


def near_places(
    load: ShiftedLoad,
    bound: ShiftedLoad,
    part: int,
    base: ForceProof,
    accuracy: float,
    most: float,
) -> tuple[CarriedPlaces | None, int]:
    """The carried shifts of a load on a part, by the parts near it; and the number of programs.

    Arguments: `bound`: the same load on the program with all forces that contacts could transmit;
    `base`: forces of equilibrium of `load.program` before the load was added; `most`: largest
    number of parts. None in place of the shifts if those that are carried and those that are
    excluded do not meet.
    """
    below = NearParts.of(load.program, part, above=False, most=most)
    if below is None:
        return None, 0
    program = below.loaded(load.program, base)
    inside = ShiftedLoad(program, load.wrenches, load.low, load.high, proofs="forces")
    carried = inside.places(accuracy)
    points, programs = (
        below.lifted(carried.points, load.program, load.wrenches, base),
        carried.programs,
    )
    hull = _hull(points)
    whole = shapely.box(*load.low, *load.high)
    if points and hull.area >= whole.area * (1 - SAME):
        return CarriedPlaces(hull, whole, programs, points), programs
    around = NearParts.of(bound.program, part, above=True, most=most)
    if around is None:
        return None, programs
    outer = ShiftedLoad(
        around.alone(bound.program), load.wrenches, load.low, load.high, proofs="motions"
    )
    found = outer.places(accuracy, points)
    programs += found.programs
    if not meet(hull, found.outer, accuracy, load.high - load.low):
        return None, programs
    return CarriedPlaces(hull, found.outer, programs, points, found.motions), programs


def near_moving(
    load: MovingLoad,
    bound: MovingLoad,
    base: ForceProof,
    accuracy: float,
    cell: shapely.Geometry,
    most: float,
    *,
    partly: bool,
) -> tuple[CarriedPlaces | None, Array, int]:
    """The places of a cell at which a part stands, by the parts near it, as `MovingLoad.places_of`.

    Also the shares of its weight on the areas, and the number of programs. Arguments: `bound`: the
    same load on the program with all forces that contacts could transmit; `base`: forces of
    equilibrium of the assembly without the part; `most`: largest number of parts; `partly`: whether
    places may stay open. None in place of the places if those that stand and those that fall do not
    meet.
    """
    part, known = len(load.program.names) - 1, len(load.loads.program.part_a)
    below = NearParts.of(load.program, part, above=False, most=most)
    if below is None:
        return None, load.shares, 0
    inside = load.on(below.without_last(known).loaded(load.loads.program, base), "forces")
    carried = inside.places_of(accuracy, cell)
    middle, programs = (load.contact.low + load.contact.high) / 2, carried.programs
    new = len(load.program.part_a) - known
    padded = ForceProof(
        np.append(base.forces, np.zeros(new)), np.vstack([base.friction, np.zeros((new, 3))]),
        base.residual, base.holds,
    )  # fmt: skip
    points = below.lifted(carried.shifted(-middle).points, load.program, load.wrenches, padded)
    points = tuple((shift + middle, proof) for shift, proof in points)
    hull = _hull(points)
    if without(cell, hull).buffer(-accuracy / 2).is_empty:
        whole = shapely.box(*load.contact.low, *load.contact.high)
        return CarriedPlaces(hull, whole, programs, points), inside.shares, programs
    around = NearParts.of(bound.program, part, above=True, most=most)
    if around is None:
        return None, inside.shares, programs
    others = around.without_last(len(bound.loads.program.part_a))
    found = bound.on(others.alone(bound.loads.program), "motions").places_of(accuracy, cell)
    programs += found.programs
    unsure = without(both(cell, found.outer), hull)
    if not (partly or unsure.buffer(-accuracy / 2).is_empty):
        return None, inside.shares, programs
    places = CarriedPlaces(hull, found.outer, programs, points, found.motions)
    return places, inside.shares, programs


def _hull(points: Points) -> shapely.Geometry:
    """The convex hull of carried shifts."""
    if not points:
        return shapely.Polygon()
    return shapely.convex_hull(shapely.multipoints([shift for shift, _ in points]))
