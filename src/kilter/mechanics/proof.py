"""Proof files: all data that a reader needs to recompute a verdict.

A proof holds the parts, contact points, load, and the forces or the motion of a verdict. With
friction it also holds the steps that exclude every motion, or a motion that obeys Coulomb's law
beside the forces of equilibrium. `kilter.analysis.verification` recomputes it.
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
from kilter.mechanics.rows import BONDED, CONTACT, OF_JOINTS


@dataclass(frozen=True, slots=True, eq=False)
class Evidence:
    """Evidence of a verdict with friction that a proof file has beside equilibrium forces."""

    guarantee: str
    """One of "proved", "refuted", "open". Whether no other motion obeys the contact law."""
    witness: LawProof | None = None
    """A motion that obeys the contact law."""
    settles: bool = False
    """Whether every try came to rest: a claim without a proof, since verification repeats them."""
    exclusion: dict[str, Any] | None = None
    """Proof that excludes every motion, with all steps (`kilter.friction.exclusion_file`)."""


TOLERANCES = ("gap", "relative_gap", "angle", "clearance")
"""Keys of the tolerance in a proof file."""


def make_proof(
    assembly: Assembly,
    contacts: ContactSet,
    program: Program,
    certificate: ForceProof | MotionProof | None,
    options: dict[str, Any],
    *,
    evidence: Evidence | None = None,
) -> dict[str, Any]:
    """JSON data of a proof file, from a certificate and the evidence about friction.

    Arguments: `options`: reading options of the file; if it is empty, those that the assembly
    remembers. The proof lists those that were assumed as well.

    Raises `InputError` if the verdict is undecided (`certificate` is None): it has no
    proof.
    """
    if certificate is None:
        raise InputError("an undecided verdict has no proof to write")
    rows = np.flatnonzero(program.kind == CONTACT)
    proof: dict[str, Any] = {
        "kilter_proof": FORMAT,
        "verdict": _verdict_word(certificate, evidence),
        "units": assembly.units,
        "planar": assembly.planar,
        "gravity": assembly.gravity.tolist(),
        "down": assembly.down.tolist(),
        "options": {**(options or assembly.reading or {}), **assembly.assumed},
        "tolerance": {key: getattr(contacts.searched, key) for key in TOLERANCES},
        "parts": _parts_data(program),
        "points": _points_data(program, rows, coefficients(contacts, program, rows)),
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
    if assembly.straps:
        proof["straps"] = [strap.to_dict() for strap in assembly.straps]
    if isinstance(certificate, ForceProof):
        proof["forces"] = _contact_forces(program, certificate)
        pulls = certificate.forces[program.bounded_straps[0]]
        if len(pulls):
            proof["pulls"] = pulls.tolist()
        proof["certificate"] = {"kind": "forces", "residual": certificate.residual}
        if evidence is not None:
            proof["friction"] = _friction_data(program, evidence, rows)
    else:
        motion = certificate.motion
        proof["motion"] = {
            name: motion[k].tolist() for k, name in enumerate(program.names) if program.free[k]
        }
        proof["open_pairs"] = open_pairs_of(assembly, contacts)
        proof["certificate"] = {
            "kind": "motion",
            "power": certificate.power,
            "violation": certificate.violation,
        }
    proof["digest"] = digest_of(proof)
    return proof


def _parts_data(program: Program) -> list[dict[str, Any]]:
    """The parts of a proof file."""
    rows = zip(program.names, program.free, program.mass, program.center, strict=True)
    return [
        {"name": name, "grounded": not free, "mass": float(mass), "center": center.tolist()}
        for name, free, mass, center in rows
    ]


def _points_data(program: Program, rows: Index, mu: Array) -> list[dict[str, Any]]:
    """The contact points of a proof file, with their friction coefficients."""
    names = program.names
    return [
        {
            "parts": [names[program.part_a[k]], names[program.part_b[k]]],
            "x": program.point[k].tolist(),
            "normal": program.normal[k].tolist(),
            "mu": float(friction),
            **_bond_data(program, int(k)),
        }
        for k, friction in zip(rows, mu, strict=True)
    ]


def _verdict_word(certificate: ForceProof | MotionProof, evidence: Evidence | None) -> str:
    """Verdict word of a proof file that its certificate and evidence support."""
    if isinstance(certificate, MotionProof):
        return "unstable"
    if evidence is None or evidence.guarantee == "proved":
        return "stable"
    settles = evidence.guarantee == "open" and evidence.settles
    return "settles" if settles else "potentially-stable"


def coefficients(contacts: ContactSet, program: Program, rows: Index) -> Array:
    """Friction coefficients of contact rows for a proof file; 0 at bonds of limited shear."""
    sheared_by_bond = program.tied[rows] | ~np.isnan(program.shear[rows])
    mu: Array = np.where(sheared_by_bond, 0.0, contacts.patch_mu[program.source[rows]])
    return mu


def _bond_data(program: Program, row: int) -> dict[str, Any]:
    """Strength of the bond of a contact row, as keys of its point in a proof; {} without a bond."""
    data: dict[str, Any] = {}
    if program.pull[row] > 0:
        data["pull"] = float(program.pull[row])
    if program.tied[row]:
        data["tied"] = True
    if not np.isnan(program.shear[row]):
        data["shear"] = float(program.shear[row])
    return data


def _contact_forces(program: Program, proof: ForceProof) -> list[list[float]]:
    """Force vector of a force proof at each contact row [N], shape (C, 3)."""
    vectors = program.point_forces(proof.forces, proof.friction)
    return [[float(x) for x in vector] for vector in vectors]


def _friction_data(program: Program, evidence: Evidence, rows: Index) -> dict[str, Any]:
    """JSON data of the evidence of a verdict with friction."""
    joints = np.isin(program.kind, OF_JOINTS)
    witness = evidence.witness
    data: dict[str, Any] = {"guarantee": evidence.guarantee, "exclusion": evidence.exclusion}
    data["witness"] = None if witness is None else {
        "acceleration": {
            name: witness.acceleration[k].tolist()
            for k, name in enumerate(program.names)
            if program.free[k]
        },
        "forces": witness.forces[rows].tolist(),
        "joints": witness.forces[joints].tolist(),
        "bonds": witness.forces[program.kind == BONDED].tolist(),
        "power": witness.power,
        "residual": witness.residual,
    }  # fmt: skip
    return data


def open_pairs_of(assembly: Assembly, contacts: ContactSet) -> list[dict[str, Any]]:
    """JSON data of the open pairs; a motion is a proof only if it respects all their contacts."""
    names = assembly.names
    pairs = still_open(contacts.open_pairs, assembly)
    return [{"parts": [names[k] for k in pair.ends], "kind": pair.kind} for pair in pairs]


def joints_of(
    assembly: Assembly, program: Program, certificate: ForceProof | MotionProof | None
) -> list[dict[str, Any]]:
    """JSON data of the joints; with forces, also the wrench on the second part about `point`."""
    entries = []
    for number, joint in enumerate(assembly.joints):
        about, wrench = reference_point(assembly, number), None
        if isinstance(certificate, ForceProof):
            rows = rows_of(program, number)
            wrench = joint_wrench(
                *frame_of(program, rows), certificate.forces[rows], about
            ).tolist()
        entries.append(
            {
                "parts": list(joint.parts),
                "kind": joint.kind,
                "point": about.tolist(),
                "axis": None if joint.axis is None else joint.axis.tolist(),
                **joint.free_axes,
                **joint.guide,
                "wrench": wrench,
            }
        )
    return entries


def rows_of(program: Program, joint: int) -> Index:
    """Indices of the rows of a joint, with stops and friction, by its position in the assembly."""
    return np.flatnonzero(np.isin(program.kind, OF_JOINTS) & (program.source == joint))


def frame_of(program: Program, rows: Index) -> tuple[Array, Mask, Array]:
    """Directions of the rows of a joint, mask of the angular rows, and the point of the rows."""
    at = program.point[rows[0]] if len(rows) else np.zeros(3)
    return program.normal[rows], program.angular[rows], at


def digest_of(proof: dict[str, Any]) -> str:
    """Hash of a proof's JSON data without its key `digest`."""
    body = {key: value for key, value in proof.items() if key != "digest"}
    text = json.dumps(body, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()
