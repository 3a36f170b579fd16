"""The intersection of stable cones, and its proofs.

The intersection is found as a stable cone is, with distances to facets in place of forces:

    e.g = 0,   q.g - f = 0,   f >= 0

so that knife edges which agree but for rounding stay what they are.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.sparse import csc_array, vstack

from kilter.analysis.judge import judge
from kilter.analysis.regions.cone_oracle import ConeOracle
from kilter.analysis.regions.growth import grow
from kilter.analysis.regions.polyhedral_cone import Cone, make_cone
from kilter.analysis.regions.stable_cone import Proof
from kilter.analysis.turning_tolerances import (
    BEYOND_CONE,
    BLUR_OVER_TOLERANCE,
)
from kilter.arrays import Array
from kilter.assembly import Assembly
from kilter.contact import ContactSet
from kilter.mechanics.mechanics_tolerances import TOLERANCE
from kilter.mechanics.program import build_program

__all__ = ["common_proofs", "intersection"]


def intersection(cones: Sequence[Cone], first: Array) -> tuple[Cone, int]:
    """The intersection of cones, and how many linear programs it took.

    Parameters
    ----------
    cones : sequence of Cone
    first : ndarray, shape (3,)
        A direction to ask first.
    """
    blur = max(cone.blur for cone in cones)
    equations = np.vstack([cone.equations for cone in cones])
    facets = np.vstack([cone.facets for cone in cones])
    if not len(equations) + len(facets):
        return make_cone(equations, facets, np.empty((0, 3)), blur), 0
    count = len(facets)
    distances = csc_array(np.vstack([np.zeros((len(equations), count)), -np.eye(count)]))
    loads = vstack([csc_array(equations), csc_array(facets)], format="csc")
    coarse = blur > BLUR_OVER_TOLERANCE * TOLERANCE
    oracle = ConeOracle(
        distances, loads, np.zeros(count, dtype=bool), 0.1 / blur if coarse else None
    )
    grown = grow(oracle, first, blur, lambda: None)
    cone = make_cone(
        np.array([e for e, _, _ in grown.equations]),
        np.array([q for q, _ in grown.facets]),
        np.array([found.point for found in grown.points]),
        blur,
    )
    return cone, oracle.programs


def common_proofs(
    cone: Cone, assemblies: Sequence[Assembly], contacts: Sequence[ContactSet]
) -> list[tuple[Proof, int]]:
    """Proofs of a common region, each with the position of its assembly.

    Forces in every assembly for each ray and both signs of each line; for each facet and
    both sides of each equation, a motion in one assembly.
    """
    stable = [("ray", ray, ray) for ray in cone.rays]
    stable += [("line", line, sign * line) for line in cone.lines for sign in (1.0, -1.0)]
    proofs = []
    for k, (assembly, own) in enumerate(zip(assemblies, contacts, strict=True)):
        for about, vector, down in stable:
            judged = judge(build_program(assembly.with_down(down), own).frictionless).forces
            if judged is not None:
                proofs.append((Proof(about, vector, down, judged), k))
    beyond = [("facet", q, -q, cone.rays[np.abs(cone.rays @ q) <= cone.blur]) for q in cone.facets]
    beyond += [("equation", e, s * e, cone.rays) for e in cone.equations for s in (1.0, -1.0)]
    for about, vector, outward, on in beyond:
        base = on.mean(axis=0) if len(on) else np.zeros(3)
        proofs += _unstable(about, vector, base, outward, assemblies, contacts)
    return proofs


def _unstable(
    about: str,
    vector: Array,
    base: Array,
    outward: Array,
    assemblies: Sequence[Assembly],
    contacts: Sequence[ContactSet],
) -> list[tuple[Proof, int]]:
    """A motion in the first assembly that does not hold just beyond the boundary, if any."""
    if assemblies[0].planar and not outward[[0, 2]].any():
        return []
    for angle in BEYOND_CONE[2:]:
        down = base + angle * outward
        down = down / np.linalg.norm(down)
        for k, (assembly, own) in enumerate(zip(assemblies, contacts, strict=True)):
            judged = judge(build_program(assembly.with_down(down), own).frictionless)
            if judged.stable is False and judged.motion is not None:
                return [(Proof(about, vector, down, judged.motion), k)]
    return []
