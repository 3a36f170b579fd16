"""Maps of places of a part, for each corner of its masses and centres, and their combination.

A place stands if it stands in each case, and it falls if it falls in some case
(`kilter.analysis.placing.uncertain_part`). The places of all cases are those of the stated centre.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from kilter.analysis.placing.landings import Landings
from kilter.analysis.placing.place_map import LevelMap, PlaceMap
from kilter.analysis.placing.placed_loads import PlacedLoads
from kilter.analysis.placing.polygon_sets import both, moved, union, without
from kilter.analysis.placing.upright_prisms import PlacedPrism, Top, placed_prism
from kilter.arrays import Array
from kilter.assembly import Assembly, Part
from kilter.contact import ContactSet
from kilter.errors import InputError
from kilter.mechanics.program import Program, build_program

__all__ = ["CaseMap", "bounding_loads", "case_prism", "combined_levels", "map_cases", "map_domain"]

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
