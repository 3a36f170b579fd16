"""Proof files: all that a stranger needs to recompute a verdict.

The parts, contact points, load and the forces or the motion of a verdict as data; with
friction also the motion that obeys Coulomb's law beside forces of equilibrium, and the
forces by which its own weight seats it. `kilter.analysis.verification` recomputes it.
"""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass
from typing import Any

import numpy as np

from kilter.arrays import Array, Index, Mask
from kilter.assembly import Assembly
from kilter.contact.contact_set import ContactSet
from kilter.contact.open_pairs import still_open
from kilter.errors import InputError
from kilter.mechanics.certificate import ForceProof, MotionProof
from kilter.mechanics.joints import joint_wrench, reference_point
from kilter.mechanics.law_check import LawProof
from kilter.mechanics.program import Program
from kilter.mechanics.proof_form import FORMAT
from kilter.mechanics.rows import CONTACT, JOINT

__all__ = [
    "Evidence",
    "coefficients",
    "digest_of",
    "frame_of",
    "joints_of",
    "make_proof",
    "open_pairs_of",
    "rows_of",
]


@dataclass(frozen=True, slots=True, eq=False)
class Evidence:
    """What a verdict with friction carries beside its forces of equilibrium.

    Attributes
    ----------
    guarantee : {"proved", "refuted", "open"}
    witness : LawProof or None
        A motion that obeys the contact law.
    seated : ForceProof or None
        Forces by which its own weight seats it.
    tries : tuple of ForceProof
        Forces of each try that came to rest, put down loosely.
    of : int
        Tries that were asked for.
    exclusion : dict or None
        How every motion was excluded, with all steps (`kilter.friction.exclusion_file`).
    """

    guarantee: str
    witness: LawProof | None = None
    seated: ForceProof | None = None
    tries: tuple[ForceProof, ...] = ()
    of: int = 0
    exclusion: dict[str, Any] | None = None


def make_proof(
    assembly: Assembly,
    contacts: ContactSet,
    program: Program,
    certificate: ForceProof | MotionProof | None,
    options: dict[str, Any],
    *,
    evidence: Evidence | None = None,
) -> dict[str, Any]:
    """A proof as JSON data.

    Parameters
    ----------
    evidence : Evidence, optional
        Where the verdict rests on friction.

    Raises
    ------
    InputError
        If the verdict is undecided: then there is no proof.
    """
    if certificate is None:
        raise InputError("an undecided verdict has no proof to write")
    rows = np.flatnonzero(program.kind == CONTACT)
    mu = coefficients(contacts, program, rows)
    names = program.names
    proof: dict[str, Any] = {
        "kilter_proof": FORMAT,
        "verdict": _verdict(certificate, evidence),
        "units": assembly.units,
        "planar": assembly.planar,
        "gravity": assembly.gravity.tolist(),
        "down": assembly.down.tolist(),
        "options": options,
        "tolerance": {
            "gap": contacts.tolerance.gap,
            "relative_gap": contacts.tolerance.relative_gap,
            "angle": contacts.tolerance.angle,
            "clearance": contacts.tolerance.clearance,
        },
        "parts": [
            {
                "name": name,
                "grounded": not free,
                "mass": float(mass),
                "center": center.tolist(),
            }
            for name, free, mass, center in zip(
                names, program.free, program.mass, program.center, strict=True
            )
        ],
        "points": [
            {
                "parts": [names[program.part_a[k]], names[program.part_b[k]]],
                "x": program.point[k].tolist(),
                "normal": program.normal[k].tolist(),
                "mu": float(friction),
                **_bond(program, int(k)),
            }
            for k, friction in zip(rows, mu, strict=True)
        ],
        "loads": [
            {
                "part": load.part,
                "point": None if load.point is None else load.point.tolist(),
                "force": load.force.tolist(),
                "torque": load.torque.tolist(),
            }
            for load in assembly.loads
        ],
        "joints": joints_of(assembly, program, certificate),
    }
    if isinstance(certificate, ForceProof):
        proof["forces"] = _vectors(program, certificate)
        proof["certificate"] = {"kind": "forces", "residual": certificate.residual}
        if evidence is not None:
            proof["friction"] = _friction(program, evidence, rows)
    else:
        motion = certificate.motion
        proof["motion"] = {
            name: motion[k].tolist() for k, name in enumerate(names) if program.free[k]
        }
        proof["open_pairs"] = open_pairs_of(assembly, contacts)
        proof["certificate"] = {
            "kind": "motion",
            "power": certificate.power,
            "violation": certificate.violation,
        }
    proof["digest"] = digest_of(proof)
    return proof


def _verdict(certificate: ForceProof | MotionProof, evidence: Evidence | None) -> str:
    if isinstance(certificate, MotionProof):
        return "unstable"
    if evidence is None or evidence.guarantee == "proved":
        return "stable"
    settles = evidence.guarantee == "open" and 0 < evidence.of == len(evidence.tries)
    return "settles" if settles else "potentially-stable"


def coefficients(contacts: ContactSet, program: Program, rows: Index) -> Array:
    """The friction coefficients of contact rows as the file has them; 0 where bonds bear shear."""
    otherwise = program.tied[rows] | ~np.isnan(program.shear[rows])
    mu: Array = np.where(otherwise, 0.0, contacts.patch_mu[program.source[rows]])
    return mu


def _bond(program: Program, row: int) -> dict[str, Any]:
    """What a bond gives to a contact row, where there is one."""
    found: dict[str, Any] = {}
    if program.pull[row] > 0:
        found["pull"] = float(program.pull[row])
    if program.tied[row]:
        found["tied"] = True
    if not np.isnan(program.shear[row]):
        found["shear"] = float(program.shear[row])
    return found


def _vectors(program: Program, proof: ForceProof) -> list[list[float]]:
    """Forces at the contact rows, shape (C, 3)."""
    vectors = program.point_forces(proof.forces, proof.friction)
    return [[float(x) for x in vector] for vector in vectors]


def _friction(program: Program, evidence: Evidence, rows: Index) -> dict[str, Any]:
    """The evidence of friction as data."""
    joints = np.flatnonzero(program.kind == JOINT)
    seated, witness = evidence.seated, evidence.witness
    data: dict[str, Any] = {"guarantee": evidence.guarantee, "exclusion": evidence.exclusion}
    data["seated"] = None if seated is None else _balanced(program, seated, joints)
    tries = [_balanced(program, one, joints) for one in evidence.tries]
    data["tries"] = {"passed": len(tries), "of": evidence.of, "forces": tries}
    data["witness"] = None if witness is None else {
        "acceleration": {
            name: witness.acceleration[k].tolist()
            for k, name in enumerate(program.names)
            if program.free[k]
        },
        "forces": witness.forces[rows].tolist(),
        "joints": witness.forces[joints].tolist(),
        "power": witness.power,
        "residual": witness.residual,
    }  # fmt: skip
    return data


def open_pairs_of(assembly: Assembly, contacts: ContactSet) -> list[dict[str, Any]]:
    """The open pairs, whatever which may do a motion proves its verdict."""
    names = assembly.names
    pairs = still_open(contacts.open_pairs, assembly)
    return [{"parts": [names[k] for k in one.parts], "kind": one.kind} for one in pairs]


def _balanced(program: Program, proof: ForceProof, joints: Index) -> dict[str, Any]:
    """Forces that balance every part as data."""
    return {
        "forces": _vectors(program, proof),
        "joints": proof.forces[joints].tolist(),
        "residual": proof.residual,
    }


def joints_of(
    assembly: Assembly, program: Program, certificate: ForceProof | MotionProof | None
) -> list[dict[str, Any]]:
    """Joints with their wrench on the second part about `point`."""
    found = []
    for number, joint in enumerate(assembly.joints):
        about, wrench = reference_point(assembly, number), None
        if isinstance(certificate, ForceProof):
            rows = rows_of(program, number)
            wrench = joint_wrench(
                *frame_of(program, rows), certificate.forces[rows], about
            ).tolist()
        found.append(
            {
                "parts": list(joint.parts),
                "kind": joint.kind,
                "point": about.tolist(),
                "axis": None if joint.axis is None else joint.axis.tolist(),
                "wrench": wrench,
            }
        )
    return found


def rows_of(program: Program, joint: int) -> Index:
    """The rows of a joint, by its position in the assembly."""
    return np.flatnonzero((program.kind == JOINT) & (program.source == joint))


def frame_of(program: Program, rows: Index) -> tuple[Array, Mask, Array]:
    """Normals of the rows of a joint, which are angular, and the point they are taken at."""
    at = program.point[rows[0]] if len(rows) else np.zeros(3)
    return program.normal[rows], program.angular[rows], at


def digest_of(proof: dict[str, Any]) -> str:
    """The hash of all that a proof says but itself."""
    body = {key: value for key, value in proof.items() if key != "digest"}
    text = json.dumps(body, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()
