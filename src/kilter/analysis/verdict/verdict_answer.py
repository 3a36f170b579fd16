"""JSON data for parts of a check's answer: densities, proof, friction and forces."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from kilter.analysis.decision.judge import Judgement
from kilter.analysis.verdict.contact_forces import ContactForces
from kilter.assembly import Assembly, Joint
from kilter.assembly.masses import DEFAULT_DENSITY
from kilter.contact import ContactSet
from kilter.mechanics.certificate import ForceProof, MotionProof
from kilter.mechanics.program import Program
from kilter.mechanics.rows import DRAG, STOP

if TYPE_CHECKING:
    from kilter.friction.answer import FrictionAnswer
    from kilter.tell.answer_data.check_data import (
        CertificateData,
        DensityData,
        ForcesData,
        FrictionData,
        JointForceData,
        PatchForceData,
    )

__all__ = ["certificate_answer", "density_answer", "forces_answer", "friction_answer"]


def density_answer(assembly: Assembly) -> DensityData:
    """Densities from which masses of free parts are computed [kg/m^3], as JSON data.

    `given` is the range of the stated densities. `default` is the density of the parts without
    mass and density. Either is None if no part uses it.
    """
    free = [
        part.density for part in assembly.parts if not part.grounded and part.given_mass is None
    ]
    given = [density for density in free if density is not None]
    return {
        "given": [min(given), max(given)] if given else None,
        "default": DEFAULT_DENSITY if len(given) < len(free) else None,
    }


def certificate_answer(
    proof: ForceProof | MotionProof | None, judgement: Judgement
) -> CertificateData:
    """Kind of the proof that holds, and errors of the best forces and motion, as JSON data."""
    forces, motion = judgement.forces, judgement.motion
    kind: Literal["forces", "motion"] | None = "motion"
    if proof is None or isinstance(proof, ForceProof):
        kind = None if proof is None else "forces"
    return {
        "kind": kind,
        "residual": None if forces is None else forces.residual,
        "power": None if motion is None else motion.power,
        "violation": None if motion is None else motion.violation,
    }


def friction_answer(answer: FrictionAnswer | None, effort: float) -> FrictionData | None:
    """Evidence that friction excludes motions, as JSON data; None if it was not examined."""
    if answer is None or not answer.examined:
        return None
    witness, seating, exclusion = answer.witness, answer.seating, answer.exclusion
    return {
        "witness": None
        if witness is None
        else {"power": witness.law.power, "residual": witness.law.residual, "found": witness.found},
        "seating": {
            "seated": seating.seated,
            "residual": seating.residual,
            "direction": None if seating.runaway is None else seating.runaway.tolist(),
        },
        "settling": {"ends": list(answer.settling.ends), "of": answer.settling.of},
        "exclusion": None
        if exclusion is None
        else {
            "proved": exclusion.proved,
            "kind": exclusion.kind,
            "programs": exclusion.programs,
            "bound": exclusion.bound,
            "assumes": exclusion.assumes,
        },
        "effort": effort,
        "work": answer.work,
    }


def forces_answer(
    forces: ContactForces | None, contacts: ContactSet, program: Program
) -> ForcesData | None:
    """Contact forces [N] on the second part of each patch, as JSON data; None without forces."""
    if forces is None:
        return None
    rows = np.argsort(forces.patch_of, kind="stable")
    ends = np.cumsum(np.bincount(forces.patch_of, minlength=len(forces.patch)))
    points = program.point[forces.rows]
    patches: list[PatchForceData] = []
    for k, members in enumerate(np.split(rows, ends[:-1]) if len(ends) else []):
        patch = forces.patch[k]
        presses, rubs = np.isfinite(forces.center[k]).all(), np.isfinite(forces.utilisation[k])
        used = forces.bond_utilisation[k]
        patches.append(
            {
                "parts": [program.names[i] for i in contacts.patch_parts[patch]],
                "kind": str(contacts.patch_kind[patch]),
                "resultant": forces.resultant[k].tolist(),
                "normal_force": float(forces.normal_force[k]),
                "center": forces.center[k].tolist() if presses else None,
                "utilisation": float(forces.utilisation[k]) if rubs else None,
                "bond_utilisation": float(used) if np.isfinite(used) else None,
                "points": points[members].tolist(),
                "forces": (forces.force[members] + 0.0).tolist(),
            }
        )
    data: ForcesData = {"least": forces.least, "residual": forces.residual, "patches": patches}
    joints = [
        _guide_forces(forces, program, joint, number)
        for number, joint in enumerate(contacts.assembly.joints)
        if joint.guide
    ]
    return {**data, "joints": joints} if joints else data


def _guide_forces(
    forces: ContactForces, program: Program, joint: Joint, number: int
) -> JointForceData:
    """Forces or torques along the axis of a joint on its first part, as JSON data."""
    mine = program.source == number
    sizes = {}
    for name, kind in (("stop", STOP), ("friction", DRAG)):
        rows = np.flatnonzero(mine & (program.kind == kind))
        # the force of a row acts on the second part along its normal
        sizes[name] = 0.0 - float(program.normal[rows] @ joint.axis @ forces.row_forces[rows])
    return {
        "parts": list(joint.parts),
        "kind": "prismatic" if joint.kind == "prismatic" else "revolute",
        "stop": sizes["stop"],
        "friction": sizes["friction"],
        "spring": joint.stiffness * joint.rest,
    }
