"""The map of places: at which centres (x, y) does the next part stand?

The part is lowered straight down (`kilter.analysis.placing.upright_prisms`). All tops of one
height on which it rests decide:

    a single top       the forces under the part are equal to its weight at its centre, so it stands
                       exactly where the centre is on the top and a load there is carried
    several tops       the area of contact moves with the part. Without friction, the forces of a
                       rectangle of places move with it (`kilter.analysis.placing.moving_load`), and
                       each motion leaves polygons (`kilter.analysis.placing.upright_prisms`). With
                       friction, the area that all places of a rectangle have gives places that
                       surely stand; the area that any place has gives places that surely fall.
                       Around the places that are left, smaller rectangles are searched: they keep
                       what is proved in the larger rectangle

Places flush with the side of a neighbour have further contacts, which the map does not contain:
it states nothing about them beyond the places that stand.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import shapely

from kilter.analysis.placing.moving_load import Footing, MovingLoad
from kilter.analysis.placing.near_load import (
    NearAnswer,
    NearProof,
    NearQuestion,
    near_moving,
    near_places,
)
from kilter.analysis.placing.polygon_sets import (
    GRID,
    NOTHING,
    across,
    both,
    cleaned,
    polygons_of,
    union,
    without,
)
from kilter.analysis.placing.shifted_load import CarriedPlaces, ShiftedLoad
from kilter.analysis.placing.upright_prisms import Landing, Landings, PlacedLoads, Top
from kilter.arrays import Array
from kilter.assembly import Assembly
from kilter.contact import ContactSet
from kilter.errors import some, some_names
from kilter.mechanics.program import Program

MOST_PROGRAMS = 20_000
"""Largest number of programs of a map; places that are not decided then stay open."""
FEW_TOPS = 8
"""Number of tops up to which a rectangle of places is searched as a whole."""
WIDE = 0.1
"""Extent above which a cell of a large assembly is searched with the parts near it only [sizes of
the part]."""
SAME_CUT = 1e-9
"""Share of the width of a polygon below which two cuts are equal [-]."""
COARSE = 0.05
"""Accuracy of the polygons in a rectangle whose areas of contact vary [sides]: smaller rectangles
follow."""


@dataclass(frozen=True, slots=True, eq=False)
class Finding:
    """Forces and motions that decide places on a single top or in a rectangle of places."""

    low: Array
    high: Array
    """The rectangle of centres [length unit], shape (2,)."""
    top: int
    """The part whose top carries the part alone; -1 for several."""
    carried: CarriedPlaces
    """Forces at places that stand, and motions, in the coordinates of the map."""
    shares: dict[int, float] | None = None
    """Forces and motions move with the part: shares of its weight on each top; empty without
    forces. None if they do not."""
    near: NearProof | None = None
    """Forces and motions are those of the parts near the load; None if they are those of all."""


@dataclass(frozen=True, slots=True, eq=False)
class LevelMap:
    """Places at which the part rests at one height."""

    height: float
    """Height of its underside [length unit]."""
    stands: shapely.Geometry
    falls: shapely.Geometry
    """Places that forces prove, and places that motions exclude."""
    open: shapely.Geometry
    """The other places."""
    findings: tuple[Finding, ...] = ()
    """Forces and motions that prove it; empty if several maps are combined."""


@dataclass(eq=False)
class PlaceMap:
    """Computes the map of places of a part on an assembly of upright prisms.

    Arguments: `loads`, `bound`: the assembly with the forces that its contacts transmit, and with
    every force that they could transmit; equal if nothing is open; `strip`: largest width of the
    open strip between places that stand and places that fall [length unit].
    """

    landings: Landings
    loads: PlacedLoads
    bound: PlacedLoads
    strip: float
    programs: int = 0
    _findings: list[Finding] = field(default_factory=list)

    def levels(self, domain: shapely.Geometry) -> list[LevelMap]:
        """The map of a domain of centres, a level for each height, the lowest first."""
        return [self._level(landing) for landing in self.landings.at(domain)]

    def _level(self, landing: Landing) -> LevelMap:
        stands, falls = [], []
        shared = landing.here
        self._findings = []
        for top in landing.tops:
            only = self.landings.only(landing, top)
            if not only.area > 0:
                continue
            shared = without(shared, only)
            if top.upright:
                carried = self._on_single(top)
                stands.append(both(only, carried.inner))
                falls.append(without(only, carried.outer))
        for piece in polygons_of(cleaned(shared)):
            if piece.area <= NOTHING * landing.here.area:
                continue
            inside, outside = self._on_several(landing, piece)
            stands += inside
            falls += outside
        grid = GRID * float(np.abs(landing.here.bounds).max())
        inner = union(stands, grid)
        out = without(union(falls, grid), inner, grid)
        left = without(landing.here, union([inner, out], grid), grid)
        return LevelMap(landing.height, inner, out, left, tuple(self._findings))

    # a single top ------------------------------------------------------------------------

    def _on_single(self, top: Top) -> CarriedPlaces:
        """Places of the part on a single top: those at which the top carries its weight."""
        if not self.loads.program.free[top.part]:  # the part has no effect on the assembly
            nowhere = shapely.Polygon()
            proved, possible = not self._alone.inner.is_empty, not self._alone.outer.is_empty
            return CarriedPlaces(
                top.polygon if proved else nowhere, top.polygon if possible else nowhere
            )
        low, high = np.array(top.polygon.bounds[:2]), np.array(top.polygon.bounds[2:])
        middle, half = (low + high) / 2, (high - low) / 2
        inner, near = self._near(
            lambda question, most: near_places(question, top, low, high, self.strip, most)
        )
        if inner is None:
            load, bound = (
                ShiftedLoad(
                    *loads.on_top(top, middle), -half, half, known_motions=self._alone.motions
                )
                for loads in (self.loads, self.bound)
            )
            inner = self._counted(load.places(self.strip))
            if self.bound is not self.loads:
                inner = inner.with_outside_of(self._counted(bound.places(self.strip)))
        carried = inner.shifted(middle)
        self._findings.append(Finding(low, high, top.part, carried, near=near))
        return CarriedPlaces(both(carried.inner, top.polygon), both(carried.outer, top.polygon))

    def _near(
        self, places: Callable[[NearQuestion, float], NearAnswer]
    ) -> tuple[CarriedPlaces | None, NearProof | None]:
        """Carried places of a load, if the parts near it decide them.

        `places` decides them with at most a number of parts.
        """
        question = self._near_question
        if question is None:
            return None, None
        for most in question.most_parts:
            found, proof, programs = places(question, most)
            self.programs += programs
            if found is not None:
                return found, proof
        return None, None

    @cached_property
    def _near_question(self) -> NearQuestion | None:
        """The assembly with known forces; None if it does not stand without the part."""
        points = self._alone.points
        return NearQuestion(self.loads, self.bound, points[0][1]) if points else None

    @cached_property
    def _alone(self) -> CarriedPlaces:
        """Whether the assembly stands without the part: all places of a square, or none."""
        one = np.ones(2)
        none = np.zeros((2, len(self.loads.program.names), 6))
        inner = self._searched(self.loads.program, none, one, 1.0)
        if self.bound is self.loads:
            return inner
        return inner.with_outside_of(self._searched(self.bound.program, none, one, 1.0))

    def _searched(
        self, program: Program, wrenches: Array, half: Array, accuracy: float
    ) -> CarriedPlaces:
        """Carried shifts of a load in a rectangle around 0."""
        return self._counted(ShiftedLoad(program, wrenches, -half, half).places(accuracy))

    def _counted(self, found: CarriedPlaces) -> CarriedPlaces:
        self.programs += found.programs
        return found

    # several tops --------------------------------------------------------------------------

    def _on_several(
        self, landing: Landing, piece: shapely.Geometry
    ) -> tuple[list[shapely.Geometry], list[shapely.Geometry]]:
        """Places of a polygon that stand, and places that fall, on several tops of one height."""
        stands: list[shapely.Geometry] = []
        falls: list[shapely.Geometry] = []
        moving = self._smooth and all(top.upright for top in landing.tops)
        decided = self._decided_moving if moving else self._decided
        rest, again = self._few(landing, piece) if moving else self._cells(landing, piece), JOINED
        while rest and self.programs < MOST_PROGRAMS:
            cell = rest.pop()
            low, high = np.array(cell.bounds[:2]), np.array(cell.bounds[2:])
            inner, out, settled = decided(landing, cell, low, high)
            stands.append(inner)
            falls.append(out)
            if not settled:
                rest += self._halves(cell, union([inner, out]), low, high)
            if moving and not rest and again:
                # strips of neighbouring cells lie side by side: together they may be too wide
                again -= 1
                left = polygons_of(without(piece, union([*stands, *falls])))
                rest = [strip for strip in left if not strip.buffer(-self.strip / 2).is_empty]
        return stands, falls

    def _few(self, landing: Landing, piece: shapely.Geometry) -> list[shapely.Geometry]:
        """A polygon, halved until its rectangle has few tops: many have no shares in common."""
        low, high = np.array(piece.bounds).reshape(2, 2)
        side = self.landings.part.size
        few = len(landing.near(low, high, side / 2)) <= FEW_TOPS
        if few or float((high - low).max()) <= side:
            return [piece]
        axis = int((high - low).argmax())
        middle = (low[axis] + high[axis]) / 2
        ends = [(low, np.where(np.arange(2) == axis, middle, high))]
        ends.append((np.where(np.arange(2) == axis, middle, low), high))
        halves = [both(piece, shapely.box(*least, *most)) for least, most in ends]
        parts = [part for half in halves for part in polygons_of(half)]
        return [cell for part in parts for cell in self._few(landing, part)]

    @property
    def _smooth(self) -> bool:
        """True if no contact has friction."""
        return self.loads.friction == 0 and not self.bound.program.mu.any()

    def _decided_moving(
        self, landing: Landing, cell: shapely.Geometry, low: Array, high: Array
    ) -> tuple[shapely.Geometry, shapely.Geometry, bool]:
        """As `_decided`, with contacts that move with the part."""
        possible = self.landings.areas(landing.tops, low, high, any_place=True)
        # moments of the part alone: its centre lies within the hull of its contact
        hull = shapely.convex_hull(union(list(possible.values())))
        out, cell = without(cell, hull), both(cell, hull)
        if cell.area <= NOTHING * float(np.prod(high - low)):
            nowhere = shapely.Polygon()
            self._findings.append(Finding(low, high, -1, CarriedPlaces(nowhere, nowhere), {}))
            return nowhere, out, True
        accuracy = max(self.strip / 2, COARSE * float((high - low).max()))
        tops = [top for top in landing.tops if top.part in possible]
        footing = Footing(tops, possible, landing.height, low, high)
        span = float((np.array(cell.bounds[2:]) - cell.bounds[:2]).max())
        wide = span > WIDE * self.landings.part.size

        # the places of a wide cell that stay open are searched again in smaller cells
        found, near = self._near(
            lambda question, most: near_moving(
                question, footing, accuracy, cell, most, partly=wide and bool(np.isfinite(most))
            )
        )
        settled, shares = False, None if near is None else near.shares
        if found is None:
            found, shares, settled = self._moving(footing, accuracy, cell)
        named = dict(zip(possible, np.asarray(shares).tolist(), strict=False))
        self._findings.append(Finding(low, high, -1, found, named, near))
        stands = both(cell, found.inner)
        return stands, union([out, without(without(cell, stands), found.outer)]), settled

    def _moving(
        self, footing: Footing, accuracy: float, cell: shapely.Geometry
    ) -> tuple[CarriedPlaces, Array, bool]:
        """As `_decided_moving`, with all parts; also the shares of the load."""
        load = MovingLoad.of_areas(self.loads, footing)
        found, settled = self._counted(load.places_of(accuracy, cell)), False
        if self.bound is not self.loads:
            bound = MovingLoad.of_areas(self.bound, footing)
            outside = self._counted(bound.places_of(accuracy, cell))
            # places that no motion excludes may stand; places that all contacts hold cannot fall
            unsure = [without(each.outer, each.inner) for each in (found, outside)]
            settled = both(cell, union(unsure)).area <= NOTHING * cell.area
            found = found.with_outside_of(outside)
        return found, load.shares, settled

    def _decided(
        self, landing: Landing, cell: shapely.Geometry, low: Array, high: Array
    ) -> tuple[shapely.Geometry, shapely.Geometry, bool]:
        """Places of a cell that stand, places that fall, and whether smaller cells are useless."""
        known = [top for top in landing.tops if top.upright]
        unknown = len(known) < len(landing.tops)
        nowhere = shapely.Polygon()
        possible = self.landings.areas(landing.tops, low, high, any_place=True)
        # moments of the part alone: its centre lies within the hull of its contact
        hull = shapely.convex_hull(union(list(possible.values())))
        out = nowhere if unknown else without(cell, hull)
        cell = cell if unknown else both(cell, hull)
        if cell.area <= NOTHING * float(np.prod(high - low)):
            self._keep(CarriedPlaces(nowhere, nowhere), low, high)  # the areas alone decide
            return nowhere, out, True
        sure = self.landings.areas(known, low, high, any_place=False)
        same = not unknown and _equal_areas(sure, possible)
        exact = same and self.bound is self.loads
        span = float((high - low).max())
        accuracy = self.strip / 2 if same else max(self.strip / 2, COARSE * span)
        inside = self._carried(sure, possible if exact else None, landing.height, low, high,
                               accuracy)  # fmt: skip
        stands = both(cell, inside.inner)
        if unknown or without(cell, stands).area <= NOTHING * cell.area:
            self._keep(inside, low, high, motions=False)
            return stands, out, True
        outside = inside
        if not exact:
            outside = self._outside(possible, landing.height, low, high, accuracy, inside)
        self._keep(inside.with_outside_of(outside), low, high)
        return stands, union([out, without(cell, outside.outer)]), same

    def _keep(self, carried: CarriedPlaces, low: Array, high: Array, motions: bool = True) -> None:
        """Keep the forces and motions that decide places of a rectangle."""
        kept = carried if motions else carried.without_motions()
        self._findings.append(Finding(low, high, -1, kept))

    def _cells(self, landing: Landing, piece: shapely.Geometry) -> list[shapely.Geometry]:
        """Cells of a polygon in which the kinds of corners of the areas of contact are constant."""
        low, high = np.array(piece.bounds).reshape(2, 2)
        tops = landing.near(low, high, self.landings.part.size)
        cuts = [self._cuts(tops, axis, low[axis], high[axis]) for axis in (0, 1)]
        cells = [
            both(shapely.box(u, v, s, t), piece)
            for u, s in zip(cuts[0][:-1], cuts[0][1:], strict=True)
            for v, t in zip(cuts[1][:-1], cuts[1][1:], strict=True)
        ]
        return [part for cell in cells for part in polygons_of(cell)]

    def _halves(
        self, cell: shapely.Geometry, decided: shapely.Geometry, low: Array, high: Array
    ) -> list[shapely.Geometry]:
        """Halves of the places of a cell that are left; none of a strip that is thin enough."""
        halves = []
        for piece in polygons_of(without(cell, decided)):
            least, most = np.array(piece.bounds[:2]), np.array(piece.bounds[2:])
            if piece.buffer(-self.strip / 2 * THIN).is_empty:
                continue
            if (most - least < (high - low) * SHRUNK).any():  # the rectangle alone is sharper
                halves.append(piece)
                continue
            extent = most - least if decided.is_empty else across(piece)
            axis = int(extent.argmax())
            middle = (least[axis] + most[axis]) / 2
            for sign in (0, 1):
                first, last = least.copy(), most.copy()
                (last if sign == 0 else first)[axis] = middle
                halves += polygons_of(both(piece, shapely.box(*first, *last)))
        return halves

    def _cuts(self, tops: list[Top], axis: int, low: float, high: float) -> list[float]:
        """Coordinates at which the kind of a corner of the area of contact changes."""
        ends = {low, high}
        along = self.landings.part.footprint[:, axis]
        reach = {float(along.min()), float(along.max())}
        for top in tops:
            for side in shapely.get_coordinates(top.polygon)[:, axis].tolist():
                ends |= {side - shift for shift in (*reach, 0.0) if low < side - shift < high}
        values = sorted(ends)
        width = SAME_CUT * (high - low)
        kept = [value for k, value in enumerate(values) if not k or value - values[k - 1] > width]
        return kept if kept[-1] == high or len(kept) > 1 else [low, high]

    def _carried(
        self,
        areas: dict[int, shapely.Geometry],
        possible: dict[int, shapely.Geometry] | None,
        height: float,
        low: Array,
        high: Array,
        accuracy: float,
    ) -> CarriedPlaces:
        """Places of a rectangle at which forces in fixed areas of contact hold the part.

        Their motions count with the possible areas; without these nothing is excluded.
        """
        middle, half = (low + high) / 2, (high - low) / 2
        if not areas:
            return CarriedPlaces(shapely.Polygon(), shapely.box(*low, *high))
        program, wrenches = self.loads.on_areas(areas, height, middle)
        bound = None if possible is None else self.loads.on_areas(possible, height, middle)[0]
        load = ShiftedLoad(
            program,
            wrenches,
            -half,
            half,
            bound,
            known=self.loads.alone,
            proofs="forces" if possible is None else "both",
        )
        return self._counted(load.places(accuracy)).shifted(middle)

    def _outside(
        self,
        possible: dict[int, shapely.Geometry],
        height: float,
        low: Array,
        high: Array,
        accuracy: float,
        inside: CarriedPlaces,
    ) -> CarriedPlaces:
        """Places of a rectangle that no motion excludes, with all possible areas of contact.

        The places `inside` are carried on smaller areas, and so on these.
        """
        middle, half = (low + high) / 2, (high - low) / 2
        program, wrenches = self.bound.on_areas(possible, height, middle)
        known = self.bound.alone
        load = ShiftedLoad(program, wrenches, -half, half, known=known, proofs="motions")
        carried = inside.shifted(-middle).points
        return self._counted(load.places(accuracy, carried)).shifted(middle)


SHRUNK = 0.7
"""Share of a side of a rectangle below which the places left in it are searched again as a whole:
their own rectangle has more sure and fewer possible areas."""


JOINED = 2
"""Number of times that open strips of several cells are joined, and searched if too wide."""
THIN = 0.75
"""Width of a strip that is not searched further [accuracies]. It is below 1, since the strips of
neighbouring cells may lie side by side."""


def _equal_areas(first: dict[int, shapely.Geometry], second: dict[int, shapely.Geometry]) -> bool:
    """Whether two sets of areas of contact are equal."""
    if first.keys() != second.keys():
        return False
    return all(
        shapely.symmetric_difference(first[k], second[k]).area <= NOTHING * second[k].area
        for k in first
    )


# Warnings of a map of places: reasons why places stay open.


def map_warnings(
    assembly: Assembly,
    tops: Sequence[Top],
    contacts: ContactSet,
    levels: Sequence[LevelMap],
    strip: float,
) -> list[str]:
    """Warnings about parts that are no upright prisms, and about pairs that leave places open.

    Arguments: `strip`: width above which an open area is no strip between places [length unit].
    """
    warnings = []
    other = [assembly.names[top.part] for top in tops if not top.upright]
    if other:
        warnings.append(
            f"the map leaves places on {some_names(other, 3)} open: only tops of upright prisms "
            "are mapped"
        )
    wide = any(
        not piece.buffer(-strip).is_empty for level in levels for piece in polygons_of(level.open)
    )
    if wide and contacts.open_pairs:
        pairs = [
            " and ".join(repr(assembly.names[k]) for k in pair.ends) for pair in contacts.open_pairs
        ]
        warnings.append(
            f"the map leaves places open, because the geometry does not decide whether "
            f"{some(pairs, 1)} touch"
        )
    return warnings
