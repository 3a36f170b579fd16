"""Proofs of the rays and facets of a region, as data that anyone can verify.

Forces hold every ray and both signs of every line; a motion starts for a direction just outside
of every facet and on both sides of every equation. For several assemblies a ray has forces in
each, a facet a motion in the first that does not hold beyond it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from kilter.analysis.decision.judge import judge
from kilter.analysis.regions.polyhedral_cone import Cone
from kilter.analysis.regions.stable_cone import DirectionProof
from kilter.analysis.turning_tolerances import BEYOND_CONE
from kilter.arrays import Array
from kilter.assembly import Assembly
from kilter.contact import ContactSet
from kilter.mechanics.certificate import ForceProof, MotionProof, check_forces, check_motion
from kilter.mechanics.program import Program, bounding_program, build_program
from kilter.mechanics.proof import Evidence, make_proof

__all__ = ["RegionProof", "common_proofs", "region_proof"]


@dataclass(frozen=True, slots=True, eq=False)
class RegionProof:
    """Proof of a ray, line, facet or equation of a region: an assembly with forces or a motion."""

    about: str
    """One of "ray", "line", "facet", "equation"."""
    vector: Array
    """The ray, the line or the normal, shape (3,)."""
    assembly: Assembly
    """With gravity along the direction that is proved: the ray, either sign of the line, or a
    direction just outside."""
    data: dict[str, Any]
    """For `kilter.verify`."""

    def __repr__(self) -> str:
        return f"RegionProof(about={self.about!r}, vector={self.vector.tolist()})"


def region_proof(
    proof: DirectionProof,
    assembly: Assembly,
    contacts: ContactSet,
    program: Program,
    *,
    friction: bool,
    options: dict[str, Any],
) -> RegionProof | None:
    """Convert a proof to data, after it was verified on a newly built program; None if it fails.

    Arguments: `program`: newly built from them, with any direction of gravity; a region needs it
    only once.
    """
    turned = assembly.with_down(proof.down)
    program = program.turned(turned.down)
    if isinstance(proof.certificate, ForceProof) and not friction:
        program = program.frictionless
    certificate = _certified(program, turned, contacts, proof, friction)
    if not certificate.holds:
        return None
    # forces in the cones of friction hold it; what must happen is another question
    evidence = Evidence("open") if friction else None
    data = make_proof(turned, contacts, program, certificate, options, evidence=evidence)
    return RegionProof(proof.about, proof.vector, turned, data)


def _certified(
    program: Program, turned: Assembly, contacts: ContactSet, proof: DirectionProof, friction: bool
) -> ForceProof | MotionProof:
    """The forces or motion of a proof, recomputed on a program."""
    given = proof.certificate
    if isinstance(given, ForceProof):
        return check_forces(program, given.forces, given.friction)
    if friction:
        return check_motion(program, given.motion)
    # no force that was left out may stop the motion
    outer = bounding_program(turned, contacts)
    return check_motion(outer, given.motion)


def common_proofs(
    cone: Cone, assemblies: Sequence[Assembly], contacts: Sequence[ContactSet]
) -> list[tuple[DirectionProof, int]]:
    """Proofs of the region of several assemblies, each with the index of its assembly.

    Forces in every assembly for each ray and both signs of each line; for each facet and
    both sides of each equation, a motion in some assembly.
    """
    stable = [("ray", ray, ray) for ray in cone.rays]
    stable += [("line", line, sign * line) for line in cone.lines for sign in (1.0, -1.0)]
    proofs = []
    for k, (assembly, contact_set) in enumerate(zip(assemblies, contacts, strict=True)):
        for about, vector, down in stable:
            judged = judge(build_program(assembly.with_down(down), contact_set).frictionless).forces
            if judged is not None:
                proofs.append((DirectionProof(about, vector, down, judged), k))
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
) -> list[tuple[DirectionProof, int]]:
    """Find the assembly that falls just beyond a boundary of the common region, with its motion.

    Empty list if no assembly is proved to fall.
    """
    if assemblies[0].planar and not outward[[0, 2]].any():
        return []
    for angle in BEYOND_CONE[2:]:
        down = base + angle * outward
        down = down / np.linalg.norm(down)
        for k, (assembly, contact_set) in enumerate(zip(assemblies, contacts, strict=True)):
            judged = judge(build_program(assembly.with_down(down), contact_set).frictionless)
            if judged.stable is False and judged.motion is not None:
                return [(DirectionProof(about, vector, down, judged.motion), k)]
    return []
