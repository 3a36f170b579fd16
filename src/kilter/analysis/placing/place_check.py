"""Verify the proof of a map of places, without any solver.

Heights, touched tops and areas of contact are computed anew from the assembly and the part. The
forces of each place must balance everything, and each motion excludes the half plane in which its
power suffices. The polygons that the file states must lie within what this proves.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import shapely
from shapely import Geometry

from kilter.analysis.placing.moving_load import ContactRoom
from kilter.analysis.placing.place_at import part_cases
from kilter.analysis.placing.place_proofs import bounding_loads, case_prism, part_data
from kilter.analysis.placing.polygon_sets import (
    both,
    is_within,
    moved,
    union,
    without,
)
from kilter.analysis.placing.shifted_load import excluded_side, remaining
from kilter.analysis.placing.upright_prisms import (
    Landing,
    Landings,
    PlacedLoads,
    find_tops,
    places_left,
)
from kilter.arrays import Array
from kilter.assembly import Assembly, Part
from kilter.contact import ContactSet
from kilter.files.own import kilter_json
from kilter.mechanics.certificate import check_forces
from kilter.mechanics.program import Program, build_program
from kilter.mechanics.proof_form import (
    NUMBER,
    SIX,
    VECTOR,
    WORD,
    every,
    keys,
    list_of,
    named,
    nullable,
    optional_keys,
    require,
)

PLANE = list_of(NUMBER, 2)
POLYGONS = list_of(list_of(list_of(PLANE)))
PLACE = every(keys(at=PLANE, forces=list_of(NUMBER)), optional_keys(friction=list_of(VECTOR)))
FINDING = every(
    keys(
        top=nullable(WORD),
        low=PLANE,
        high=PLANE,
        places=list_of(PLACE),
        motions=list_of(list_of(SIX)),
    ),
    optional_keys(shares=named(NUMBER)),
)
GIVEN = keys(part=keys(), mass=list_of(NUMBER, 2), center_within=NUMBER)
"""Keys of the question at a place."""
MAP = keys(
    part=keys(),
    mass=list_of(NUMBER, 2),
    center_within=NUMBER,
    clear=NUMBER,
    domain=list_of(NUMBER, 4),
    levels=list_of(keys(height=NUMBER, stands=POLYGONS, falls=POLYGONS)),
    cases=list_of(list_of(keys(height=NUMBER, findings=list_of(FINDING)))),
)
"""Keys of the map of a proof of places."""


def require_place_form(bundle: Mapping[str, Any], names: Sequence[str]) -> None:
    """Reject a map of places in a proof file if an entry has a wrong key or type.

    Arguments and errors as for a plan (`kilter.analysis.planning.plan_proof_form`).
    """
    require(keys(place=GIVEN) if "place" in bundle else keys(map=MAP), bundle)


def wrong_places(
    assembly: Assembly, contacts: ContactSet, bundle: Mapping[str, Any], verdicts: Sequence[str]
) -> Iterator[str]:
    """Reasons why the proofs of a file do not prove its places; none if they do."""
    if "place" in bundle:
        yield from _wrong_cases(assembly, bundle)
        return
    data = bundle["map"]
    if [entry["change"] for entry in bundle["proofs"]] != [{}]:
        yield "the proof of the assembly without the part is missing"
        return
    part = _part_of(data["part"])
    if part is None or not np.allclose(assembly.down, [0, 0, -1]):
        yield "there is no part to put down, or gravity does not act along -z"
        return
    stands, falls = _proved_places(assembly, contacts, data, part, verdicts[0] != "unstable")
    extent = float(np.ptp(np.reshape(data["domain"], (2, 2)), axis=0).max())
    for level in data["levels"]:
        height = level["height"]
        for name, proved in (("stands", stands), ("falls", falls)):
            stated = _polygons(level[name])
            if stated is None:
                yield f"a polygon at height {height:g} crosses itself"
            elif not is_within(stated, proved.get(height, shapely.Polygon()), extent):
                verb = "stand" if name == "stands" else "fall"
                yield f"places at height {height:g} {verb} by statement, but not by proof"


def _wrong_cases(assembly: Assembly, bundle: Mapping[str, Any]) -> Iterator[str]:
    """Reasons why proofs at a place are not those of all cases, or of a case that falls."""
    data = bundle["place"]
    given = [entry["change"] for entry in bundle["proofs"]]
    part = _part_of(data["part"])
    if part is None:
        yield "there is no part to put down"
        return
    cases = [
        {"part": part_data(case, assembly.units)}
        for case in part_cases(part, tuple(data["mass"]), data["center_within"])
    ]
    falls = "motion" in bundle["proofs"][0]["proof"] and len(given) == 1
    if not (given == cases or (falls and given[0] in cases)):
        yield "the proofs are not those of all masses and centres of the part"


def _part_of(data: Mapping[str, Any]) -> Part | None:
    """The only part of an assembly file; None if it has another number of parts."""
    parts = kilter_json.from_dict(data).parts
    return parts[0] if len(parts) == 1 else None


def _polygons(rings: Sequence[Any]) -> Geometry | None:
    """The area of polygons from lists of rings; None if it is not valid."""
    try:
        pieces = [shapely.Polygon(outline, holes) for outline, *holes in rings]
    except (ValueError, shapely.errors.GEOSException):
        return None
    if not all(piece.is_valid for piece in pieces):
        return None
    return union(pieces)


def _proved_places(
    assembly: Assembly, contacts: ContactSet, data: Mapping[str, Any], part: Part, alone: bool
) -> tuple[dict[float, Geometry], dict[float, Geometry]]:
    """Places by height that are proved to stand, and to fall, for all cases of the part.

    `alone`: whether the assembly stands without the part.
    """
    nominal, center = case_prism(part, assembly.units)
    same_height = float(contacts.searched.gap_of(np.array([2 * nominal.radius]))[0])
    cases = part_cases(part, tuple(data["mass"]), data["center_within"])
    tops, program = find_tops(assembly), build_program(assembly, contacts)
    stands: dict[float, list[Geometry]] = {}
    falls: dict[float, list[Geometry]] = {}
    for case, levels in zip(cases, data["cases"], strict=False):
        prism, middle = case_prism(case, assembly.units)
        offset = (middle - center)[:2]
        landings = Landings(tops, prism, same_height, data["clear"])
        findings = {level["height"]: level["findings"] for level in levels}
        loads = PlacedLoads(program, prism, assembly.friction)
        bound, _ = bounding_loads(assembly, contacts, loads)
        for landing in landings.at(moved(shapely.box(*data["domain"]), offset)):
            recheck = _LandingCheck(landings, landing, loads, bound, alone)
            inner, out = recheck.proved(findings.get(landing.height, []))
            stands.setdefault(landing.height, []).append(moved(inner, -offset))
            falls.setdefault(landing.height, []).append(moved(out, -offset))
    complete = len(data["cases"]) == len(cases)
    return (
        {
            height: shapely.intersection_all(areas)
            for height, areas in stands.items()
            if complete and len(areas) == len(cases)
        },
        {height: union(areas) for height, areas in falls.items()},
    )


class _LandingCheck:
    """Recheck of the findings at one height, for one mass and centre of the part."""

    def __init__(
        self,
        landings: Landings,
        landing: Landing,
        loads: PlacedLoads,
        bound: PlacedLoads,
        alone: bool,
    ) -> None:
        self.landings, self.landing = landings, landing
        self.loads, self.bound, self.alone = loads, bound, alone
        self.tops = {loads.program.names[top.part]: top for top in landing.tops}
        self.known = [top for top in landing.tops if top.upright]

    def proved(self, findings: Sequence[Mapping[str, Any]]) -> tuple[Geometry, Geometry]:
        """Places that are proved to stand, and places that are proved to fall."""
        stands: list[Geometry] = []
        falls: list[Geometry] = []
        for finding in findings:
            low, high = np.array(finding["low"], float), np.array(finding["high"], float)
            if not (high > low).all():
                continue
            checked = self._moving if "shares" in finding else self._several
            if finding["top"] is not None:
                checked = self._single
            inner, out = checked(finding, low, high)
            stands.append(inner)
            falls.append(out)
        for top in self.known:
            inner, out = self._without_forces(top)
            stands.append(inner)
            falls.append(out)
        here = self.landing.here
        return both(union(stands), here), both(union(falls), here)

    def _without_forces(self, top: Any) -> tuple[Geometry, Geometry]:
        """Places on a single top that need no forces: on a held part, or with the centre beside."""
        only = self.landings.only(self.landing, top)
        beside = without(only, top.polygon)
        if self.loads.program.free[top.part]:
            return shapely.Polygon(), beside
        on_it = both(only, top.polygon)
        return (on_it, beside) if self.alone else (shapely.Polygon(), only)

    def _single(
        self, finding: Mapping[str, Any], low: Array, high: Array
    ) -> tuple[Geometry, Geometry]:
        """Places on a single top that its forces and motions prove."""
        top = self.tops.get(finding["top"])
        if top is None or not top.upright or not self.loads.program.free[top.part]:
            return shapely.Polygon(), shapely.Polygon()
        only = self.landings.only(self.landing, top)
        carried = [
            place["at"]
            for place in finding["places"]
            if _balances(self.loads.on_top(top, np.array(place["at"], float))[0], place)
        ]
        middle = (low + high) / 2
        left = _left(*self.bound.on_top(top, middle), low, high, finding["motions"])
        inner = both(both(_hull(carried), top.polygon), only)
        return inner, without(both(only, shapely.box(*low, *high)), left)

    def _several(
        self, finding: Mapping[str, Any], low: Array, high: Array
    ) -> tuple[Geometry, Geometry]:
        """Places in a rectangle, on several tops, that its forces and motions prove."""
        cell, height, middle = shapely.box(*low, *high), self.landing.height, (low + high) / 2
        nowhere = shapely.Polygon()
        sure = self.landings.areas(self.known, low, high, any_place=False)
        possible = self.landings.areas(self.landing.tops, low, high, any_place=True)
        inner, out = nowhere, nowhere
        if sure and finding["places"]:
            carried = []
            for place in finding["places"]:
                program, wrenches = self.loads.on_areas(sure, height, middle)
                shift = np.array(place["at"], float) - middle
                more = shift[0] * wrenches[0] + shift[1] * wrenches[1]
                if _balances(program.with_rows(applied=program.applied + more), place):
                    carried.append(place["at"])
            inner = both(_hull(carried), cell)
        if possible and len(self.known) == len(self.landing.tops):
            hull = shapely.convex_hull(union(list(possible.values())))
            out = without(cell, hull)
            program, wrenches = self.bound.on_areas(possible, height, middle)
            left = _left(program, wrenches, low, high, finding["motions"])
            out = union([out, without(cell, left)])
        return inner, out

    def _moving(
        self, finding: Mapping[str, Any], low: Array, high: Array
    ) -> tuple[Geometry, Geometry]:
        """Places in a rectangle that forces and motions prove that move with the part."""
        cell, height, middle = shapely.box(*low, *high), self.landing.height, (low + high) / 2
        nowhere = shapely.Polygon()
        if self.loads.friction > 0 or len(self.known) < len(self.landing.tops):
            return nowhere, nowhere
        possible = self.landings.areas(self.known, low, high, any_place=True)
        inner, out = nowhere, without(cell, shapely.convex_hull(union(list(possible.values()))))
        if not possible:
            return inner, out
        names = [self.loads.program.names[k] for k in possible]
        shares = np.array([finding["shares"].get(name, np.nan) for name in names], float)
        if finding["places"] and np.isfinite(shares).all():
            program, wrenches = self.loads.on_areas(possible, height, middle)
            contact = ContactRoom(self.loads.part, possible, low, high)
            known = len(self.loads.program.part_a)
            weight = self.loads.part.mass * program.g
            carried = []
            for place in finding["places"]:
                shift = np.array(place["at"], float) - middle
                more = shift[0] * wrenches[0] + shift[1] * wrenches[1]
                forces = np.maximum(np.array(place["forces"], float)[known:], 0.0)
                if _balances(
                    program.with_rows(applied=program.applied + more), place
                ) and contact.holds(shares, weight, shift, forces):
                    carried.append(place["at"])
            inner = both(_hull(carried), cell)
        left = cell
        tops = [top for top in self.known if top.part in possible]
        for motion in finding["motions"]:
            if np.shape(motion) == (len(self.loads.program.names) + 1, 6):
                given = np.array(motion, float)
                left = both(left, places_left(self.bound, tops, height, low, high, given))
        return inner, union([out, without(cell, left)])


def _balances(program: Program, place: Mapping[str, Any]) -> bool:
    """Whether the forces of a place balance everything."""
    count = len(program.part_a)
    forces = np.array(place["forces"], float)
    friction = np.array(place.get("friction") or np.zeros((count, 3)), float)
    if forces.shape != (count,) or friction.shape != (count, 3):
        return False
    return check_forces(program, forces, friction).holds


def _left(
    program: Program, wrenches: Array, low: Array, high: Array, motions: Sequence[Any]
) -> Geometry:
    """Places of a rectangle that motions do not exclude; the load is at its middle."""
    middle, half = (low + high) / 2, (high - low) / 2
    whole = shapely.box(*-half, *half)
    left = whole
    for motion in motions:
        if np.shape(motion) != (len(program.names), 6):
            continue
        side = excluded_side(program, wrenches, -half, half, np.array(motion, float))
        if side is not None:
            left = remaining(left, side, whole)
    return moved(left, middle)


def _hull(places: Sequence[Any]) -> Geometry:
    if len(places) < 3:
        return shapely.Polygon()
    return shapely.convex_hull(shapely.multipoints(np.array(places, float)))
