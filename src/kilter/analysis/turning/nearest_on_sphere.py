"""The most nearly stable direction on the Euclidean sphere, exactly.

    max over |g|_2 = 1 of z(g) = -(distance of 0 from the boundary of Q)

reached at the outward normal of the facet of Q nearest to 0. A hull of points of Q lies in Q, so
its nearest facet bounds that distance from below; where it is a facet of Q the bound is met.
Only the nearest facet is asked each time: the rest of Q stays unknown.
"""

from __future__ import annotations

from dataclasses import dataclass

from kilter.analysis.turning.reachable import OUTSIDE, Reachable
from kilter.arrays import Array
from kilter.errors import SolverError
from kilter.mechanics.program import Program

__all__ = ["SphereDirection", "nearest_on_sphere"]


PROGRAMS = 20_000
"""More programs than this are not solved."""


@dataclass(frozen=True, slots=True, eq=False)
class SphereDirection:
    """Unit `direction`, shape (3,), the greatest `z` [kg x length unit], `programs` solved."""

    direction: Array
    z: float
    programs: int


def nearest_on_sphere(program: Program) -> SphereDirection | None:
    """The unit direction with the greatest z; None where a direction is stable.

    Raises
    ------
    InputError
        If loads are given.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> from kilter.contact import find_contacts
    >>> from kilter.mechanics.program import build_program
    >>> assembly = scene("wall-on-short-base")
    >>> best = nearest_on_sphere(build_program(assembly, find_contacts(assembly)))
    >>> np.round(best.direction, 9) + 0.0, round(best.z, 6)
    (array([ 0.,  0., -1.]), -6.684)
    """
    known = Reachable(program)
    hull = known.hull
    if hull is None or len(known.basis) < len(known.work.unit.axes):
        return None
    while True:
        nearest = int(hull.offsets.argmin())
        offset = float(hull.offsets[nearest])
        if hull.done[nearest] or known.ask(nearest):
            break
        if known.work.programs >= PROGRAMS:
            raise SolverError(f"the nearest direction needs more than {PROGRAMS} programs")
    if offset <= OUTSIDE:
        return None
    direction = hull.normals[nearest] @ known.basis
    return SphereDirection(direction, -offset * known.work.unit.mass, known.work.programs)
