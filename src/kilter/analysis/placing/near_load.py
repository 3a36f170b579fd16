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

from collections.abc import Container, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np
import shapely

from kilter.analysis.placing.moving_load import Footing, MovingLoad
from kilter.analysis.placing.polygon_sets import both, without
from kilter.analysis.placing.shifted_load import SAME, CarriedPlaces, ShiftedLoad, meet
from kilter.analysis.placing.upright_prisms import PlacedLoads, Top
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


class RestGraph:
    """Rows at each part of a program, and the free parts that rest on each other."""

    def __init__(self, program: Program) -> None:
        self.program = program
        parts = len(program.names)
        free = np.append(program.free, False)  # the ground is the last
        rises = -program.normal @ program.down
        lower = np.where(rises > 0, program.part_a, program.part_b)
        upper = np.where(rises > 0, program.part_b, program.part_a)
        rests = (np.abs(rises) > RESTS) & free[lower] & free[upper]
        pairs = np.unique(np.column_stack([lower[rests], upper[rests]]), axis=0)
        self.below: list[list[int]] = [[] for _ in range(parts)]
        self.above: list[list[int]] = [[] for _ in range(parts)]
        for low, high in pairs.tolist():
            self.below[high].append(low)
            self.above[low].append(high)
        ends = np.concatenate([program.part_a, program.part_b])
        self._order = np.argsort(ends, kind="stable") % max(len(program.part_a), 1)
        self._start = np.searchsorted(np.sort(ends), np.arange(parts + 1))

    def rows_at(self, parts: Index) -> Index:
        """All rows at some parts, ascending."""
        spans = [self._order[self._start[k] : self._start[k + 1]] for k in parts.tolist()]
        rows: Index = np.unique(np.concatenate([np.empty(0, dtype=np.int64), *spans]))
        return rows

    def reached(self, parts: Iterable[int], above: bool, among: Container[int]) -> set[int]:
        """Parts and those on which they rest, with `above` also all that rest on these."""
        near = {part for part in parts if part in among}
        for ways in (self.below, self.above) if above else (self.below,):
            rest = list(near)
            while rest:
                new = [k for k in ways[rest.pop()] if k not in near and k in among]
                near.update(new)
                rest += new
        return near


@dataclass(frozen=True, slots=True, eq=False)
class NearParts:
    """Free parts that are near a load in a program, with the rows at them."""

    parts: Index
    """Numbers of the near parts, and of the parts on the other side of their rows."""
    near: Mask
    """Parts among these that are near, shape (n,)."""
    rows: Index
    """All rows at the near parts."""
    inside: Mask
    """Mask of the rows without an end at another free part."""

    @classmethod
    def of(
        cls, graph: RestGraph, touched: Sequence[int], place: Array, *, above: bool, most: float
    ) -> NearParts | None:
        """The parts below parts that a load touches; None if they are too many.

        Arguments: `place`: a point of the load, shape (3,); `above`: whether all parts that rest on
        these are included; `most`: number of them that count, the nearest to a vertical line
        through the load.
        """
        program = graph.program
        free = np.flatnonzero(program.free)
        near = graph.reached(touched, above, set(free.tolist()))
        if len(near) > most:
            must = [part for part in touched if part in near]
            if len(must) > most:
                return None
            chosen = np.array(sorted(near - set(must)), dtype=np.int64)
            arm = program.center[chosen] - place
            aside = np.linalg.norm(arm - np.outer(arm @ program.down, program.down), axis=1)
            order = np.argsort(aside, kind="stable")[: int(most) - len(must)]
            near = graph.reached(touched, above, {*must, *chosen[order].tolist()})
        if len(near) > LARGE * len(free):
            return None
        chosen = np.array(sorted(near), dtype=np.int64)
        rows = graph.rows_at(chosen)
        ends = np.stack([program.part_a[rows], program.part_b[rows]])
        parts = np.unique(np.concatenate([ends[ends >= 0], chosen, np.array(touched, dtype=int)]))
        crossing = np.append(program.free, False)[ends] & ~np.isin(ends, chosen)
        return cls(parts, np.isin(parts, chosen), rows, np.asarray(~crossing.any(axis=0)))

    def alone(self, program: Program) -> Program:
        """The program of these parts in which all other parts are held."""
        return program.excerpt(self.parts, self.rows).with_rows(free=self.near)

    def loaded(self, alone: Program, base: ForceProof) -> Program:
        """The program of these parts alone under the known forces of the others."""
        forces, friction = base.forces[self.rows], base.friction[self.rows]
        others = alone.wrenches(
            np.where(self.inside, 0.0, forces), np.where(self.inside[:, None], 0.0, friction)
        )
        return alone.taking(self.inside).with_rows(applied=alone.applied + others)

    @property
    def numbers(self) -> dict[int, int]:
        """The number in the program of these parts, for each number in the whole program."""
        return {part: k for k, part in enumerate(self.parts.tolist())}

    def lifted(self, points: Points, load: ShiftedLoad, base: ForceProof) -> Points:
        """The shifts that forces of these parts carry, with the forces of all rows at them.

        Arguments: `points`: shifts and forces of the rows inside, and of further rows; `load`: the
        load on these parts alone, with all rows; `base`: known forces, which the others keep.
        """
        if not points:
            return ()
        shifts, count = np.array([shift for shift, _ in points]), len(self.rows)
        total, within = len(load.program.part_a), int(self.inside.sum())
        forces, friction = np.zeros((len(shifts), total)), np.zeros((len(shifts), total, 3))
        forces[:, :count], friction[:, :count] = base.forces[self.rows], base.friction[self.rows]
        for k, (_, proof) in enumerate(points):
            for given, known in ((forces[k], proof.forces), (friction[k], proof.friction)):
                given[:count][self.inside] = known[:within]
                given[count:] = known[within:]
        checked = check_load_forces(
            load.program,
            np.tensordot(shifts, load.wrenches, axes=1),
            forces,
            friction if friction.any() else None,
        )
        return tuple(
            (shift, replace(proof, residual=max(proof.residual, base.residual)))
            for shift, proof in zip(shifts, checked, strict=True)
            if proof.holds
        )


@dataclass(frozen=True, slots=True, eq=False)
class NearProof:
    """Forces of all rows and motions of all parts from those of the parts near a load."""

    base: ForceProof
    """Known forces of the program without the load."""
    below: NearParts
    """Parts whose forces change."""
    around: NearParts | None
    """Parts that move; None without motions."""
    shares: Array | None = None
    """Shares of the weight of a part on the areas that it may touch."""

    def forces(self, proof: ForceProof) -> ForceProof:
        """Forces of all rows from those of the near parts; rows of the load itself are last."""
        count = len(self.below.rows)
        forces, friction = self.base.forces.copy(), self.base.friction.copy()
        forces[self.below.rows] = proof.forces[:count]
        friction[self.below.rows] = proof.friction[:count]
        return replace(
            proof,
            forces=np.append(forces, proof.forces[count:]),
            friction=np.vstack([friction, proof.friction[count:]]),
        )

    def motion(self, motion: Array, parts: int) -> Array:
        """Motion of all parts, from that of the near parts; the part that is put down is the last.

        Arguments: `parts`: number of parts of the assembly.
        """
        assert self.around is not None
        count = len(self.around.parts)
        whole = np.zeros((parts, 6))
        whole[self.around.parts] = motion[:count]
        return np.vstack([whole, motion[count:]])


NearAnswer = tuple[CarriedPlaces | None, NearProof | None, int]
"""Carried places, their proof, and the number of programs; None if the near parts do not decide."""


@dataclass(frozen=True, eq=False)
class NearQuestion:
    """An assembly that stands, with known forces, on which a part is put down.

    Arguments: `bound`: the same as `loads` with all forces that contacts could transmit; `base`:
    forces of equilibrium of `loads.program`.
    """

    loads: PlacedLoads
    bound: PlacedLoads
    base: ForceProof

    @cached_property
    def graph(self) -> RestGraph:
        """The graph of the contacts."""
        return RestGraph(self.loads.program)

    @cached_property
    def bound_graph(self) -> RestGraph:
        """The graph of all contacts that are possible."""
        return self.graph if self.bound is self.loads else RestGraph(self.bound.program)

    @property
    def most_parts(self) -> list[float]:
        """Numbers of parts near a load that are tried, the smallest first."""
        free = int(self.loads.program.free.sum())
        return [*(most for most in NEAREST if 2 * most < free), np.inf]


def near_places(
    question: NearQuestion, top: Top, low: Array, high: Array, accuracy: float, most: float
) -> NearAnswer:
    """The carried places on a free top, by the parts near it; and the number of programs.

    Arguments: `low`, `high` (2,): the rectangle of places [length unit]; `most`: largest number of
    parts. The places are shifts from the middle of the rectangle. None in place of them if those
    that are carried and those that are excluded do not meet.
    """
    middle, half = (low + high) / 2, (high - low) / 2

    def load(loads: PlacedLoads, near: NearParts, program: Program) -> ShiftedLoad:
        on = PlacedLoads(program, loads.part, loads.friction)
        local = replace(top, part=near.numbers[top.part])
        return ShiftedLoad(*on.on_top(local, middle), -half, half)

    touched = [top.part, *question.graph.below[top.part]]
    place = question.loads.program.center[top.part]
    below = NearParts.of(question.graph, touched, place, above=False, most=most)
    if below is None:
        return None, None, 0
    alone = below.alone(question.loads.program)
    inside = load(question.loads, below, below.loaded(alone, question.base))
    carried = replace(inside, proofs="forces").places(accuracy)
    points = below.lifted(carried.points, load(question.loads, below, alone), question.base)
    programs, hull = carried.programs, _hull(points)
    whole = shapely.box(*-half, *half)
    if points and hull.area >= whole.area * (1 - SAME):
        proof = NearProof(question.base, below, None)
        return CarriedPlaces(hull, whole, programs, points), proof, programs
    touched = [top.part, *question.bound_graph.below[top.part]]
    around = NearParts.of(question.bound_graph, touched, place, above=True, most=most)
    if around is None:
        return None, None, programs
    outer = load(question.bound, around, around.alone(question.bound.program))
    found = replace(outer, proofs="motions").places(accuracy, points)
    programs += found.programs
    if not meet(hull, found.outer, accuracy, 2 * half):
        return None, None, programs
    places = CarriedPlaces(hull, found.outer, programs, points, found.motions)
    return places, NearProof(question.base, below, around), programs


def near_moving(
    question: NearQuestion,
    footing: Footing,
    accuracy: float,
    cell: shapely.Geometry,
    most: float,
    *,
    partly: bool,
) -> NearAnswer:
    """The places of a cell at which a part stands, by the parts near it, as `MovingLoad.places_of`.

    Also the number of programs. Arguments: `most`: largest number of parts; `partly`: whether
    places may stay open. None in place of the places if those that stand and those that fall do not
    meet.
    """
    touched, place = list(footing.areas), np.append(footing.middle, footing.height)

    def load(
        loads: PlacedLoads, near: NearParts, program: Program, proofs: Literal["forces", "motions"]
    ) -> MovingLoad:
        on = PlacedLoads(program, loads.part, loads.friction)
        moving = MovingLoad.of_areas(on, footing.renumbered(near.numbers))
        moving.proofs = proofs
        return moving

    below = NearParts.of(question.graph, touched, place, above=False, most=most)
    if below is None:
        return None, None, 0
    alone = below.alone(question.loads.program)
    inside = load(question.loads, below, below.loaded(alone, question.base), "forces")
    carried = inside.places_of(accuracy, cell)
    programs, shifted = carried.programs, carried.shifted(-footing.middle)
    whole = load(question.loads, below, alone, "forces")
    points = below.lifted(shifted.points, whole, question.base)
    points = tuple((shift + footing.middle, proof) for shift, proof in points)
    hull = _hull(points)
    if without(cell, hull).buffer(-accuracy / 2).is_empty:
        everywhere = shapely.box(*footing.low, *footing.high)
        proof = NearProof(question.base, below, None, inside.shares)
        return CarriedPlaces(hull, everywhere, programs, points), proof, programs
    around = NearParts.of(question.bound_graph, touched, place, above=True, most=most)
    if around is None:
        return None, None, programs
    moving = load(question.bound, around, around.alone(question.bound.program), "motions")
    found = moving.places_of(accuracy, cell)
    programs += found.programs
    unsure = without(both(cell, found.outer), hull)
    if not (partly or unsure.buffer(-accuracy / 2).is_empty):
        return None, None, programs
    places = CarriedPlaces(hull, found.outer, programs, points, found.motions)
    return places, NearProof(question.base, below, around, inside.shares), programs


def _hull(points: Points) -> shapely.Geometry:
    """The convex hull of carried shifts."""
    if not points:
        return shapely.Polygon()
    return shapely.convex_hull(shapely.multipoints([shift for shift, _ in points]))
