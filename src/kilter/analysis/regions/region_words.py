"""Warnings about a stable region: thin regions, loose parts, and forces that were left out."""

from __future__ import annotations

import numpy as np

from kilter.analysis.decision.doubts import doubts_of
from kilter.analysis.decision.fitted_normals import fits_left_out
from kilter.analysis.decision.motion import find_motion
from kilter.analysis.decision.open_question import open_pair_names
from kilter.analysis.regions.stable_cone import DirectionProof, StableCone
from kilter.analysis.verdict.remarks import remarks, touching_nothing
from kilter.arrays import Array, Mask
from kilter.assembly import Assembly
from kilter.contact import ContactSet
from kilter.errors import some_names
from kilter.mechanics.certificate import MotionProof, part_sizes
from kilter.mechanics.mechanics_tolerances import TOLERANCE
from kilter.mechanics.program import Program

__all__ = ["further_forces", "warnings_of"]


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
