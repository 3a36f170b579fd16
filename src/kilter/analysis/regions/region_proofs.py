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

from kilter.analysis.analysis_tolerances import BEYOND_CONE
from kilter.analysis.decision.cascade import fits_left_out
from kilter.analysis.decision.doubts import doubts_of
from kilter.analysis.decision.judge import judge
from kilter.analysis.decision.motion import find_motion
from kilter.analysis.decision.open_question import open_pair_names
from kilter.analysis.regions.polyhedral_cone import Cone
from kilter.analysis.regions.stable_cone import DirectionProof, StableCone
from kilter.analysis.verdict.remarks import remarks, touching_nothing
from kilter.arrays import Array, Mask
from kilter.assembly import Assembly
from kilter.contact import ContactSet
from kilter.errors import some_names
from kilter.mechanics.certificate import (
    ForceProof,
    MotionProof,
    check_forces,
    check_motion,
    part_sizes,
)
from kilter.mechanics.mechanics_tolerances import TOLERANCE
from kilter.mechanics.program import Program, bounding_program, build_program
from kilter.mechanics.proof import Evidence, make_proof


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


@dataclass(frozen=True, slots=True, eq=False)
class VerifiedDirection:
    """Proof of a direction of gravity, verified on a newly built program."""

    proof: DirectionProof
    assembly: Assembly
    """With gravity along the direction."""
    contacts: ContactSet
    program: Program
    """With gravity along the direction; without friction if the region has none."""
    certificate: ForceProof | MotionProof

    def data(self, options: dict[str, Any], *, friction: bool) -> RegionProof:
        """The proof as data for `kilter.verify`."""
        # forces in the cones of friction hold it; what must happen is another question
        evidence = Evidence("open") if friction else None
        data = make_proof(
            self.assembly, self.contacts, self.program, self.certificate, options, evidence=evidence
        )
        return RegionProof(self.proof.about, self.proof.vector, self.assembly, data)


def verified_direction(
    proof: DirectionProof,
    assembly: Assembly,
    contacts: ContactSet,
    program: Program,
    *,
    friction: bool,
) -> VerifiedDirection | None:
    """Verify a proof on a newly built program; None if it fails.

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
    return VerifiedDirection(proof, turned, contacts, program, certificate)


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


# Warnings about a stable region: thin regions, loose parts, and forces that were left out.


LIMIT = 100
"""Largest number of free parts for which all parts that start to move are named."""
TILT = 0.01
"""Tilt of gravity out of a flat region, at which the moving parts are computed [rad]."""
NAMED = 0.01
"""A part that moves less than this fraction of the largest motion is not named."""


def warnings_of(
    assembly: Assembly, contacts: ContactSet, program: Program, stable: StableCone, gap_deg: float
) -> list[str]:
    """Warnings about a stable region and its assembly, as sentences for users.

    Arguments: `gap_deg`: how far apart the inner and the outer cone were to be at most [deg].
    """
    rubs = bool(program.mu.any())
    warnings = [*remarks(assembly, contacts), *_inner(assembly, contacts, rubs)]
    warnings += fits_left_out(assembly, contacts, program)
    alone = touching_nothing(assembly, contacts)
    if alone:
        warnings.append(
            f"touches nothing, so it falls whatever the orientation: {some_names(alone)}"
        )
    whole = 2 if program.planar else 3
    if not rubs and 0 < stable.cone.dimension < whole and not further_forces(contacts, rubs):
        warnings.append(_knife_edge(program, stable))
    if program.tolerance[program.free].max(initial=0.0) > TOLERANCE:
        warnings.append(
            "the coordinates have limited accuracy: directions within "
            f"{np.degrees(stable.cone.blur):.2g} deg of the boundary count as on the boundary"
        )
    if np.degrees(stable.gap) > gap_deg:
        why = ": the time limit ended the search" if stable.is_cut else ""
        warnings.append(
            f"the boundary of the region is known only to {np.degrees(stable.gap):.2g} deg instead"
            f" of the required {gap_deg:g} deg{why}"
        )
    missing = sum(not proof.certificate.holds for proof in stable.proofs)
    if missing:
        warnings.append(
            f"{missing} of {len(stable.proofs)} proofs exceed the tolerance of the data"
        )
    return warnings


def further_forces(contacts: ContactSet, rubs: bool) -> bool:
    """Whether forces that the region leaves out may hold the assembly in more directions."""
    friction = not rubs and bool((contacts.patch_mu > 0).any())
    return friction or doubts_of(contacts.assembly, contacts).further_forces


def _inner(assembly: Assembly, contacts: ContactSet, rubs: bool) -> list[str]:
    """Sentences about friction and open pairs that the region leaves out; both may enlarge it."""
    why = []
    if not rubs and (contacts.patch_mu > 0).any():
        why.append("friction")
    if contacts.open_pairs:
        why.append(f"the forces of open pairs ({open_pair_names(assembly, contacts)})")
    if not why:
        return []
    word = "held" if rubs else "stable"
    return [
        f"left out: {' and '.join(why)}; every direction in the answer is {word}, and further"
        " directions may be"
    ]


def _knife_edge(program: Program, stable: StableCone) -> str:
    """Sentence about a region without area on the sphere, and the parts to hold in it."""
    cone = stable.cone
    tilts = [
        proof
        for proof in stable.proofs
        if proof.about == "equation" and isinstance(proof.certificate, MotionProof)
    ]
    axes = [proof.vector for proof in tilts[::2]]
    moving = np.zeros(len(program.names), dtype=bool)
    for proof in tilts:
        moving |= _starts(program, proof)
    names = [n for n, starts in zip(program.names, moving, strict=True) if starts]
    first = "" if int(program.free.sum()) <= LIMIT else "at least "
    along = " and ".join(_direction(axis) for axis in axes)
    what = {"ray": "one direction", "line": "one direction and its opposite"}
    space = "the plane" if program.planar else "space"
    return (
        f"a knife edge: stable only for {what.get(cone.kind, f'a {cone.kind} of directions')}, "
        f"which has no width in {space}. The slightest tilt along {along}, to either side, moves "
        f"these parts: {first}{some_names(names)}. Hold them against this motion by a stop, a "
        "clamp or friction"
    )


def _starts(program: Program, proof: DirectionProof) -> Mask:
    """Mask of the parts that start to move for the direction of a proof.

    For many parts, those that move in the proof.
    """
    if int(program.free.sum()) <= LIMIT:
        side = np.sign(proof.vector @ proof.down)
        down = proof.down + TILT * side * proof.vector
        motion = find_motion(program.turned(down))
        if motion.known:
            return motion.moves
    assert isinstance(proof.certificate, MotionProof)
    sizes = part_sizes(program, proof.certificate.motion, per_radius=False)
    starts: Mask = sizes > NAMED * sizes.max(initial=0.0)
    return starts


def _direction(axis: Array) -> str:
    """Describe a direction by the name of its coordinate axis, else by its numbers."""
    for k, name in enumerate("xyz"):
        if abs(axis[k]) > 1 - 1e-9:
            return name
    return "(" + ", ".join(f"{value:.3g}" for value in axis + 0.0) + ")"
