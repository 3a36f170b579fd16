"""Proofs of places as data that anyone can verify.

A map has, for each corner of the masses and centres of the part (case) and each height, findings:

    top          the part whose top carries the part alone, or null for several tops
    low, high    the rectangle of centres of mass
    places       centres with forces that hold everything; the hull of the places stands, since the
                 balance is linear in the place
    motions      each excludes the centres of a half plane
    shares       on several tops without friction: forces and motions move with the part. Forces
                 keep to the contact about these shares of its weight
                 (`kilter.analysis.placing.moving_load`), and motions exclude polygons
                 (`kilter.analysis.placing.upright_prisms`)

Areas of contact, heights and the touched tops follow from the assembly, so the file has none. A
part on a held top changes nothing in the assembly, so its proof without the part decides.

At a given place the proof is that of `kilter.check` for the assembly with the part.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely

from kilter.analysis.margins.margin_answer import changed_proof
from kilter.analysis.placing.place_at import AtPlace
from kilter.analysis.placing.place_map import Finding, LevelMap, PlaceMap
from kilter.analysis.placing.polygon_sets import both, moved, rings_of, union, without
from kilter.analysis.placing.upright_prisms import (
    Landings,
    PlacedLoads,
    PlacedPrism,
    Top,
    placed_prism,
)
from kilter.arrays import Array
from kilter.assembly import Assembly, Part
from kilter.contact import ContactSet
from kilter.errors import InputError
from kilter.files.own import kilter_json
from kilter.mechanics.bundle import make_bundle
from kilter.mechanics.certificate import ForceProof
from kilter.mechanics.program import Program, build_program

# Maps of places of a part, for each corner of its masses and centres, and their combination.


AROUND = 1.0
"""Width of the margin around the parts of an assembly in which places on a floor are mapped
[lengths of the part]."""


@dataclass(frozen=True, slots=True, eq=False)
class CaseMap:
    """The map of places in a case."""

    part: Part
    """With the mass and the centre of mass of the case."""
    offset: Array
    """Shift of its centre of mass from the stated centre [length unit], shape (2,)."""
    levels: tuple[LevelMap, ...]
    """In the coordinates of the centre of mass of the case."""
    programs: int


def case_prism(part: Part, units: str) -> tuple[PlacedPrism, Array]:
    """A part as a prism to put down, and its centre of mass, shape (3,).

    Raises `InputError` if the part is no upright convex prism.
    """
    alone = Assembly([part], units=units)
    prism = placed_prism(alone)
    if prism is None:
        raise InputError(
            "a map of places needs a box or another upright convex prism",
            part=part.name,
            hint="give a place: at=[x, y]",
            option="give a place: --at X Y",
        )
    return prism, alone.geometry.center[0]


def map_domain(assembly: Assembly, tops: Sequence[Top], part: PlacedPrism) -> shapely.Geometry:
    """Rectangle of the centres that are mapped: around the parts, without the far floor."""
    shown = [top for top in tops if not assembly.parts[top.part].table] or list(tops)
    bounds = np.array([top.polygon.bounds for top in shown])
    size = np.ptp(part.footprint, axis=0)
    low = bounds[:, :2].min(axis=0) - AROUND * size
    high = bounds[:, 2:].max(axis=0) + AROUND * size
    return shapely.box(*low, *high)


def bounding_loads(
    assembly: Assembly, contacts: ContactSet, loads: PlacedLoads
) -> tuple[PlacedLoads, bool]:
    """The part on a program with every force that contacts could transmit; True if it has more."""
    outer: Program = build_program(assembly, contacts, possible=True)
    if len(outer.part_a) == len(loads.program.part_a):
        return loads, False
    return PlacedLoads(outer, loads.part, loads.friction), True


def map_cases(
    assembly: Assembly,
    contacts: ContactSet,
    tops: list[Top],
    part: Part,
    cases: Sequence[Part],
    domain: shapely.Geometry,
    strip: float,
    clear: float,
) -> list[CaseMap]:
    """The map of places for each case of a part."""
    nominal, center = case_prism(part, assembly.units)
    same_height = float(contacts.searched.gap_of(np.array([2 * nominal.radius]))[0])
    program = build_program(assembly, contacts)
    maps = []
    for case in cases:
        prism, middle = case_prism(case, assembly.units)
        offset = (middle - center)[:2]
        loads = PlacedLoads(program, prism, assembly.friction)
        bound, _ = bounding_loads(assembly, contacts, loads)
        places = PlaceMap(Landings(tops, prism, same_height, clear), loads, bound, strip)
        levels = tuple(places.levels(moved(domain, offset)))
        maps.append(CaseMap(case, offset, levels, places.programs))
    return maps


def combined_levels(maps: Sequence[CaseMap]) -> tuple[LevelMap, ...]:
    """Places that stand in each case, and that fall in some case, by height."""
    if len(maps) == 1 and not maps[0].offset.any():
        return maps[0].levels
    by_height: dict[float, list[tuple[CaseMap, LevelMap]]] = {}
    for case in maps:
        for level in case.levels:
            by_height.setdefault(level.height, []).append((case, level))
    return tuple(
        _combined(height, found, complete=len(found) == len(maps))
        for height, found in sorted(by_height.items())
    )


def _combined(height: float, found: list[tuple[CaseMap, LevelMap]], *, complete: bool) -> LevelMap:
    """The places of one height, of all cases."""
    stands = [moved(level.stands, -case.offset) for case, level in found]
    falls = union([moved(level.falls, -case.offset) for case, level in found])
    whole = union(
        [
            moved(geometry, -case.offset)
            for case, level in found
            for geometry in (level.stands, level.falls, level.open)
        ]
    )
    inner = _common(stands) if complete else shapely.Polygon()
    return LevelMap(height, inner, falls, without(whole, union([inner, falls])))


def _common(areas: list[shapely.Geometry]) -> shapely.Geometry:
    """The intersection of several areas."""
    common = areas[0]
    for area in areas[1:]:
        common = both(common, area)
    return common


ALONE, PLACE = "assembly without the part", "place"
"""Subjects of the proofs of a map, and of a given place."""


@dataclass(frozen=True, slots=True, eq=False)
class MapQuestion:
    """Data of a map that its proof needs."""

    contacts: ContactSet
    domain: shapely.Geometry
    """Rectangle of the centres."""
    clear: float
    """Distance to parts beside the part [length unit]."""
    levels: tuple[LevelMap, ...]
    """Maps of all cases together."""
    maps: tuple[CaseMap, ...]


def at_proof(
    at: AtPlace, mass: tuple[float, float], center_within: float, options: dict[str, Any]
) -> dict[str, Any]:
    """The proof of the verdict at a place: of a case that falls, or of all cases of the part.

    Raises `InputError` if a verdict is undecided.
    """
    falling = [verdict for verdict in at.verdicts if verdict.verdict == "unstable"]
    proofs = []
    for verdict in falling[:1] or at.verdicts:
        part = verdict.assembly.parts[-1]
        change = {"part": part_data(part, verdict.assembly.units)}
        proofs.append(({"about": PLACE, "change": change}, verdict.proof(options=options)))
    data = {
        "part": part_data(at.part, at.worst.assembly.units),
        "mass": list(mass),
        "center_within": center_within,
    }
    return make_bundle("place", proofs, place=data)


def map_proof(
    assembly: Assembly,
    part: Part,
    question: MapQuestion,
    mass: tuple[float, float],
    center_within: float,
    options: dict[str, Any],
) -> dict[str, Any]:
    """The proof of a map of places.

    Raises `InputError` if the assembly without the part is undecided.
    """
    contacts = question.contacts
    alone = None
    for held in (True, False):
        alone = alone or changed_proof(assembly, contacts, {}, held, None, options)
    if alone is None:
        raise InputError("the assembly without the part is undecided, so the map has no proof")
    data = {
        "part": part_data(part, assembly.units),
        "mass": list(mass),
        "center_within": center_within,
        "clear": question.clear,
        "domain": [float(x) for x in question.domain.bounds],
        "levels": [
            {
                "height": level.height,
                "stands": rings_of(level.stands),
                "falls": rings_of(level.falls),
            }
            for level in question.levels
        ],
        "cases": [
            [
                {
                    "height": level.height,
                    "findings": [_finding_data(finding, assembly) for finding in level.findings],
                }
                for level in case.levels
            ]
            for case in question.maps
        ],
    }
    return make_bundle("place", [({"about": ALONE, "change": {}}, alone)], map=data)


def part_data(part: Part, units: str) -> dict[str, Any]:
    """An assembly file with a part alone."""
    return kilter_json.to_dict(Assembly([part], units=units))


def _finding_data(finding: Finding, assembly: Assembly) -> dict[str, Any]:
    carried, near, moving = finding.carried, finding.near, {}
    points, motions = carried.points, carried.motions
    if near is not None:
        points = tuple((place, near.forces(proof)) for place, proof in points)
        motions = tuple(near.motion(motion, len(assembly.parts)) for motion in motions)
    if finding.shares is not None:
        moving["shares"] = {assembly.names[k]: share for k, share in finding.shares.items()}
    return {
        "top": None if finding.top < 0 else assembly.names[finding.top],
        "low": finding.low.tolist(),
        "high": finding.high.tolist(),
        "places": [_place_data(place, proof) for place, proof in points],
        "motions": [_over_largest(motion).tolist() for motion in motions],
        **moving,
    }


def _place_data(place: Array, proof: ForceProof) -> dict[str, Any]:
    data: dict[str, Any] = {"at": place.tolist(), "forces": proof.forces.tolist()}
    if proof.friction.any():
        data["friction"] = proof.friction.tolist()
    return data


def _over_largest(motion: Array) -> Array:
    return motion / max(float(np.abs(motion).max(initial=0.0)), 1e-300)
