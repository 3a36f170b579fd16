"""Directions of gravity that contacts with friction can hold, enclosed between two polyhedra.

    C = {g : exists f in K:  J^T f + W g = 0},   W g = (m_i g, 0)_i

is a convex cone; its boundary is round. A conic program projects a direction v onto it,

    min 1/2 |g - v|^2:  A f + B g = 0,  f in K

and if v is outside, it gives both: the ray g, with forces that prove it, and the facet
n = v - g, n.g' <= 0 for all g' of C, with a motion that proves it (Moreau: v is the sum of its
projections onto C and onto its polar cone; n is a sum of m_i dr_i of a motion in the dual cones).

The facets bound C from outside, the rays from inside. As soon as the rays span a cone with width
and the facets a cone with a tip, a cheaper program takes the place of the projection: the largest
share of the way from a direction inside C to an extreme ray v of the outer cone. It gives a ray and
a facet, too (`kilter.analysis.regions.boundary_rays`). An extreme ray that is
farther from the inner cone than the required gap is the next target, the farthest first.

The greatest angle that remains is the gap. The planes x = 0, y = 0, z = 0 divide the outer cone,
so that its edges span at most a right angle whatever the kind: on an edge between v_1 and v_2,
with an angle e between them, no direction is farther from C than

    asin(max(sin d_1, sin d_2) / cos(e / 2))

and within the outer cone no direction is farther than an edge. In a plane each cone of friction
has two rays, so C is polyhedral and found exactly (`kilter.analysis.regions.stable_cone`).

For each direction of C, forces that hold it exist. Whether it must stay there is another
question (`kilter.friction.answer`).

References
----------
R. Mattikalli, D. Baraff, P. Khosla, Finding all stable orientations of assemblies with
friction, IEEE Transactions on Robotics and Automation 12, 1996.
J. Moreau, Decomposition orthogonale d'un espace hilbertien selon deux cones mutuellement
polaires, 1962.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from kilter.analysis.regions.cone_cutting import ConeCutting
from kilter.analysis.regions.stable_cone import DirectionProof, StableCone, stable_cone
from kilter.analysis.turning_tolerances import GAP_DEG
from kilter.errors import InputError, TimeLimitReached
from kilter.mechanics.certificate import ForceProof, MotionProof, check_forces, check_motion
from kilter.mechanics.coulomb_cones import cone_problem, pyramid, pyramid_forces
from kilter.mechanics.opening import Opening
from kilter.mechanics.program import Program

__all__ = ["friction_cone"]

SHARES = (0.9, 0.45, 0.2)
"""Distances up to which extreme rays of the outer cone are kept, as shares of the gap, in turn."""


def friction_cone(
    program: Program, *, gap_deg: float = GAP_DEG, progress: Callable[[str], None] | None = None
) -> StableCone:
    """Enclose the directions of gravity that contacts with friction can hold.

    Arguments: `gap_deg`: [deg]; ends earlier, with the gap that is left, after `PROGRAMS` programs
    or at the limit of `kilter.work.stop_after`. Raises `TimeLimitReached` if no direction is yet
    known to be held, or none yet known not to be. Raises `InputError` if loads are given: the set
    is then no cone.

    Examples
    --------
    >>> from kilter.scenes import stacks
    >>> from kilter.contact import contacts
    >>> from kilter.mechanics.program import build_program
    >>> block = stacks.block_on_slope(0.0, friction=0.5)
    >>> found = friction_cone(build_program(block, contacts(block)))
    >>> found.cone.kind, bool(found.gap < np.radians(0.1))
    ('cone', True)
    """
    if program.applied[program.free].any():
        raise InputError(
            "loads are given: their effect depends on the size of gravity, so the held directions"
            " are not a cone",
            hint="leave the loads out, or check a single direction",
        )
    if program.planar or not program.mu.any() or not program.free.any():
        return _exact(program, progress)
    search = ConeCutting(program, progress)
    try:
        for share in SHARES:
            while search.cut(share * np.radians(gap_deg)):
                pass
            cone = search.answer()
            if cone.gap <= np.radians(gap_deg):
                break
    except TimeLimitReached:
        if not search.rays or not search.facets:
            raise
        return replace(search.answer(), is_cut=True)
    return cone


def _exact(program: Program, progress: Callable[[str], None] | None) -> StableCone:
    """The stable directions in the plane, exactly; a friction cone there has two rays."""
    rays = pyramid(program, 2)
    cone = stable_cone(rays, progress=progress)
    opening = Opening(cone_problem(program))

    def judged(proof: DirectionProof) -> ForceProof | MotionProof:
        turned, certificate = program.turned(proof.down), proof.certificate
        if isinstance(certificate, ForceProof):
            return check_forces(turned, *pyramid_forces(program, rays, certificate.forces))
        motion = check_motion(turned, certificate.motion)
        # what a simplex leaves of a violation is mended
        return motion if motion.holds else check_motion(turned, opening.mended(motion.motion))

    proofs = tuple(replace(proof, certificate=judged(proof)) for proof in cone.proofs)
    return replace(cone, proofs=proofs)
