"""Masonry with mortar that bears tension: piers in wind and under eccentric loads, corbels.

A course is a single block of length b along x, depth d along y and height h, on a held block or
on the floor. A joint opens about its edge if the moment M of the loads and weights W above it
exceeds the moment of the mortar's tensile strength p over the area A,

    M = p A a / 2                a: length of the joint across its edge; compression has no limit

Without tension the resultant must stay within the section (Rankine). Friction bears the shear,
mu (f_n + p A). Strengths are in N/mm2, as in tables of mortar.
"""

from __future__ import annotations

from itertools import pairwise

from kilter.assembly import Assembly, Bond, Load, Part
from kilter.rigid import Pose
from kilter.scenes.pieces import floor
from kilter.scenes.registry import listed
from kilter.shape.primitives import Box

BLOCK = (0.4, 0.2, 0.2)
"""Length, depth and height of a block [m]."""
DENSITY = 2000.0
"""Density of masonry [kg/m^3]."""
N_PER_MM2 = 1e6
"""1 N/mm^2 in N/m^2."""


def _course(number: int, x: float = 0.0) -> Part:
    """Build the block of a masonry course, by number from 1; course 0 is held, below z = 0."""
    name = f"course-{number}" if number else "base"
    at = Pose([x, 0.0, (number - 0.5) * BLOCK[2]])
    return Part(name, Box(BLOCK), at, grounded=not number, density=DENSITY)


def _with_mortar(
    parts: list[Part], strength: float, friction: float, loads: list[Load] | None = None
) -> Assembly:
    """Build an assembly in which mortar joins each part to the part before it.

    Its strength is in N/mm2.
    """
    bonds = [
        Bond((low.name, high.name), pull_per_area=strength * N_PER_MM2, kind="mortar")
        for low, high in pairwise(parts)
    ]
    return Assembly(parts, friction=friction, loads=loads or [], bonds=bonds)


def _on_floor(count: int) -> list[Part]:
    """Parts of a masonry pier: a floor and `count` courses."""
    length, depth, _ = BLOCK
    pier = [_course(k) for k in range(1, count + 1)]
    return [floor([-length, -depth], [length, depth]), *pier]


@listed(
    "mortared-corbel",
    "eight mortared courses, each a quarter of its length beyond the course below",
    source="cohesive cantilever courses",
    answer="stable",
)
def corbel(
    count: int = 8, *, step: float = 0.1, strength: float = 0.1, friction: float = 0.6
) -> Assembly:
    """Mortared courses on a held block, each `step` beyond the course below it toward +x.

    The lowest joint opens about the edge of the held block: n W ((n + 1) step - b) / 2 against
    p d (b - step)^2 / 2. Dry courses stand up to (n + 1) step = b.

    Arguments: `step`: offset between courses [m]; `strength`: tensile strength p of the mortar
    [N/mm2]; `friction`: friction coefficient [-].
    """
    parts = [_course(k, k * step) for k in range(count + 1)]
    return _with_mortar(parts, strength, friction)


@listed(
    "pier-in-wind",
    "a mortared pier in a wind that would overturn it dry",
    source="Rankine, resultant within the section",
    answer="stable",
)
def pier_in_wind(
    count: int = 4, *, wind: float = 2000.0, strength: float = 0.1, friction: float = 0.6
) -> Assembly:
    """A mortared pier, with a wind force toward +y at the middle of each course.

    The wind overturns the pier about its foot if q b H^2 / 2 > (n W + p b d) d / 2. The height is
    H = n h; a course has width b, depth d, height h and weight W.

    Arguments: `wind`: pressure q of the wind [N/m2]; `strength`: tensile strength p of the mortar
    [N/mm2]; `friction`: friction coefficient [-].
    """
    parts = _on_floor(count)
    length, _, height = BLOCK
    loads = [Load(part.name, [0, wind * length * height, 0]) for part in parts[1:]]
    return _with_mortar(parts, strength, friction, loads)


@listed(
    "eccentric-pier",
    "a mortared pier under an eccentric load",
    source="Rankine, resultant within the section",
    answer="stable",
)
def eccentric_pier(
    count: int = 3,
    *,
    load: float = 5000.0,
    eccentricity: float = 0.25,
    strength: float = 0.1,
    friction: float = 0.6,
) -> Assembly:
    """A mortared pier, with a load on its top beside the axis, toward +x.

    The upper joint opens about its edge: P (e - b / 2) against (W + p b d) b / 2.

    Arguments: `load`: load P [N]; `eccentricity`: distance e from the axis [m]; `strength`: tensile
    strength p of the mortar [N/mm2]; `friction`: friction coefficient [-].
    """
    parts = _on_floor(count)
    top = [eccentricity, 0.0, count * BLOCK[2]]
    return _with_mortar(parts, strength, friction, [Load(parts[-1].name, [0, 0, -load], point=top)])
