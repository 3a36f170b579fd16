"""Proof files: all that a stranger needs to recompute a verdict, and its recomputation.

`make_proof` writes the parts, contact points, load and the forces or the motion of a
verdict as data. `verify_proof` reads the assembly anew, finds its contacts anew, holds both
against the proof number by number, and judges the forces or the motion again. No solver is
used, and nothing of the solvers is imported.
"""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kilter.assembly import Assembly
from kilter.contact.contact_set import ContactSet, Tolerance
from kilter.errors import InputError
from kilter.mechanics.certificate import (
    ForceProof,
    MotionProof,
    check_forces,
    check_motion,
    part_sizes,
)
from kilter.mechanics.joints import carried, carriers, reference_point
from kilter.mechanics.program import CONTACT, JOINT, Program, build_program

__all__ = ["Verification", "make_proof", "proof_tolerance", "verify_proof"]

Array = NDArray[np.float64]

FORMAT = 1
SAME = 1e-9
"""Numbers of the file and of the proof agree to this part of their size."""


@dataclass(frozen=True, slots=True)
class Verification:
    """Whether a proof holds, what it says, and why it does not hold."""

    holds: bool
    verdict: str
    reasons: tuple[str, ...]
    residual: float | None
    power: float | None


def make_proof(
    assembly: Assembly,
    contacts: ContactSet,
    program: Program,
    certificate: ForceProof | MotionProof | None,
    options: dict[str, Any],
) -> dict[str, Any]:
    """A proof as JSON data.

    Raises
    ------
    InputError
        If the verdict is undecided: then there is no proof.
    """
    if certificate is None:
        raise InputError("an undecided verdict has no proof to write")
    stable = isinstance(certificate, ForceProof)
    rows = np.flatnonzero(program.kind == CONTACT)
    mu = contacts.patch_mu[program.source[rows]]
    names = program.names
    proof: dict[str, Any] = {
        "kilter_proof": FORMAT,
        "verdict": "stable" if stable else "unstable",
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
        "joints": _joints(assembly, program, certificate),
    }
    if isinstance(certificate, ForceProof):
        forces = certificate.forces[rows, None] * program.normal[rows]
        proof["forces"] = forces.tolist()
        proof["certificate"] = {"kind": "forces", "residual": certificate.residual}
    else:
        motion = certificate.motion
        proof["motion"] = {
            name: motion[k].tolist() for k, name in enumerate(names) if program.free[k]
        }
        proof["certificate"] = {
            "kind": "motion",
            "power": certificate.power,
            "violation": certificate.violation,
        }
    proof["digest"] = _digest(proof)
    return proof


def _joints(
    assembly: Assembly, program: Program, certificate: ForceProof | MotionProof | None
) -> list[dict[str, Any]]:
    """Joints with their wrench on the second part about `point`."""
    found = []
    for number, joint in enumerate(assembly.joints):
        about, wrench = reference_point(assembly, number), None
        if isinstance(certificate, ForceProof):
            rows = _rows_of(program, number)
            wrench = carried(*_frame_of(program, rows), certificate.forces[rows], about).tolist()
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


def _rows_of(program: Program, joint: int) -> NDArray[np.int64]:
    return np.flatnonzero((program.kind == JOINT) & (program.source == joint))


def _frame_of(program: Program, rows: NDArray[np.int64]) -> tuple[Array, NDArray[np.bool_], Array]:
    """Normals of the rows of a joint, which are angular, and the point they are taken at."""
    at = program.point[rows[0]] if len(rows) else np.zeros(3)
    return program.normal[rows], program.angular[rows], at


def _joint_forces(program: Program, joint: dict[str, Any], number: int) -> tuple[Array, list[str]]:
    """Forces of the rows of a joint that its wrench stands for, and what it cannot carry."""
    wrench, about = np.asarray(joint["wrench"], dtype=float), np.asarray(joint["point"])
    if wrench.shape != (6,):
        raise ValueError("a wrench has not six numbers")
    rows = _rows_of(program, number)
    frame = _frame_of(program, rows)
    forces = carriers(*frame, wrench, about)
    force, torque = np.abs(wrench[:3]).max(), np.abs(wrench[3:]).max()
    length = float(program.arm[rows].max(initial=0.0)) or float(program.radius.min())
    reach = length + (float(np.linalg.norm(about - frame[2])) if len(rows) else 0.0)
    size = np.repeat([force + torque / length, reach * force + torque], 3)
    size += SAME * float(program.weight.min()) * np.repeat([1.0, length], 3)
    if (np.abs(wrench - carried(*frame, forces, about)) <= SAME * size).all():
        return forces, []
    pair = " and ".join(repr(name) for name in joint["parts"])
    return forces, [f"the {joint['kind']} joint of {pair} carries what its kind cannot"]


def _digest(proof: dict[str, Any]) -> str:
    body = {key: value for key, value in proof.items() if key != "digest"}
    text = json.dumps(body, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()


def proof_tolerance(proof: dict[str, Any]) -> Tolerance:
    """The contact tolerance that a proof was made with."""
    try:
        values = proof["tolerance"]
        gap, clearance = values["gap"], values.get("clearance")
        return Tolerance(
            gap=None if gap is None else float(gap),
            relative_gap=float(values["relative_gap"]),
            angle=float(values["angle"]),
            clearance=None if clearance is None else float(clearance),
        )
    except (KeyError, TypeError, ValueError):
        raise InputError("the proof has no usable tolerance", hint="make it anew") from None


def verify_proof(assembly: Assembly, contacts: ContactSet, proof: dict[str, Any]) -> Verification:
    """Recompute a proof from an assembly and the contacts found in it.

    Raises
    ------
    InputError
        If the proof is not one: keys missing, or of the wrong kind.
    """
    try:
        return _verify(assembly, contacts, proof)
    except (KeyError, TypeError, ValueError, IndexError) as error:
        what = f"the proof cannot be read ({type(error).__name__}: {error})"
        raise InputError(what, hint="make it anew with kilter check --proof") from None


def _verify(assembly: Assembly, contacts: ContactSet, proof: dict[str, Any]) -> Verification:
    if proof.get("kilter_proof") != FORMAT:
        raise InputError(
            f"this is no kilter proof of format {FORMAT}", hint="give a file of check --proof"
        )
    reasons = []
    if proof.get("digest") != _digest(proof):
        reasons.append("the file was changed after it was written (its digest does not fit)")
    verdict = str(proof["verdict"])
    stable = "forces" in proof
    if verdict != ("stable" if stable else "unstable"):
        reasons.append(f"it says {verdict!r} but carries {'forces' if stable else 'a motion'}")
    program = build_program(assembly, contacts)
    reasons += _differences(assembly, contacts, program, proof)
    residual = power = None
    if not reasons and stable:
        residual, more = _recheck_forces(program, proof)
        reasons += more
    elif not reasons:
        power, more = _recheck_motion(assembly, contacts, program, proof)
        reasons += more
    return Verification(not reasons, verdict, tuple(reasons), residual, power)


def _near(one: Any, other: Any, size: float) -> bool:
    a, b = np.asarray(one, dtype=float), np.asarray(other, dtype=float)
    return a.shape == b.shape and bool((np.abs(a - b) <= SAME * size).all())


def _differences(
    assembly: Assembly, contacts: ContactSet, program: Program, proof: dict[str, Any]
) -> list[str]:
    """Where the proof speaks of something else than the file."""
    reasons = []
    gravity = float(np.linalg.norm(assembly.gravity))
    if not _near(proof["gravity"], assembly.gravity, gravity):
        reasons.append(f"its gravity is {proof['gravity']}, the file's {assembly.gravity.tolist()}")
    if not _near(proof["down"], assembly.down, 1.0):
        reasons.append("its direction of gravity is not the file's")
    if proof["planar"] != assembly.planar or proof["units"] != assembly.units:
        reasons.append("it is planar, or in units, where the file is not")
    reasons += _different_parts(program, proof["parts"])
    reasons += _different_points(contacts, program, proof["points"])
    loads = [(e["part"], e["point"], e["force"], e["torque"]) for e in proof["loads"]]
    own = [
        (e.part, None if e.point is None else e.point.tolist(), e.force.tolist(), e.torque.tolist())
        for e in assembly.loads
    ]
    if loads != own:
        reasons.append("its loads are not the file's")
    keys = ("parts", "kind", "point", "axis")
    joints = [[entry[key] for key in keys] for entry in proof["joints"]]
    own_joints = _joints(assembly, program, None)
    if joints != [[entry[key] for key in keys] for entry in own_joints]:
        reasons.append("its joints are not the file's")
    return reasons


def _different_parts(program: Program, parts: list[dict[str, Any]]) -> list[str]:
    if [part["name"] for part in parts] != list(program.names):
        return ["its parts are not the file's"]
    reasons = []
    for k, part in enumerate(parts):
        if part["grounded"] == bool(program.free[k]):
            reasons.append(
                f"part {part['name']!r} is {'held' if part['grounded'] else 'free'} in it"
            )
        if not _near(part["mass"], program.mass[k], program.mass[k]):
            reasons.append(f"part {part['name']!r} has another mass in it")
        reach = program.radius[k] + float(np.abs(program.center[k]).max())
        if not _near(part["center"], program.center[k], reach):
            reasons.append(f"part {part['name']!r} has another centre of mass in it")
    return reasons[:10]


def _different_points(
    contacts: ContactSet, program: Program, points: list[dict[str, Any]]
) -> list[str]:
    rows = np.flatnonzero(program.kind == CONTACT)
    if len(points) != len(rows):
        return [f"it has {len(points)} contact points, the file {len(rows)}"]
    if not len(rows):
        return []
    pairs = [[program.names[program.part_a[k]], program.names[program.part_b[k]]] for k in rows]
    if [list(p["parts"]) for p in points] != pairs:
        return ["its contacts are between other parts"]
    size = float(np.abs(program.point).max()) + float(program.radius.max())
    reasons = []
    if not _near([p["x"] for p in points], program.point[rows], size):
        reasons.append("its contact points are not where the file's are")
    if not _near([p["normal"] for p in points], program.normal[rows], 1.0):
        reasons.append("its contact normals are not the file's")
    if not _near([p["mu"] for p in points], contacts.patch_mu[program.source[rows]], 1.0):
        reasons.append("its friction coefficients are not the file's")
    return reasons


def _recheck_forces(program: Program, proof: dict[str, Any]) -> tuple[float, list[str]]:
    rows = np.flatnonzero(program.kind == CONTACT)
    given = np.asarray(proof["forces"], dtype=float).reshape(-1, 3)
    if len(given) != len(rows):
        return float("nan"), ["it has not one force a contact point"]
    forces = np.zeros(len(program.part_a))
    forces[rows] = np.einsum("ij,ij->i", given, program.normal[rows])
    reasons = []
    aside = np.linalg.norm(given - forces[rows, None] * program.normal[rows], axis=1)
    scale = np.maximum(np.abs(forces[rows]), float(program.weight.min()) * SAME)
    if (aside > SAME * scale + 1e-300).any():
        reasons.append("a force leaves its cone: it is not along the normal")
    if (forces[rows] < 0).any():
        reasons.append("a contact force pulls")
    for number, entry in enumerate(proof["joints"]):
        mine, more = _joint_forces(program, entry, number)
        forces[_rows_of(program, number)] = mine
        reasons += more
    judged = check_forces(program, forces)
    if not _near(judged.residual, proof["certificate"]["residual"], 1.0):
        reasons.append("its residual is not that of its forces")
    if not judged.holds:
        reasons.append(f"the forces leave {judged.residual:.3g} of a part's weight unbalanced")
    return judged.residual, reasons


def _recheck_motion(
    assembly: Assembly, contacts: ContactSet, program: Program, proof: dict[str, Any]
) -> tuple[float, list[str]]:
    if set(proof["motion"]) != {n for n, f in zip(program.names, program.free, strict=True) if f}:
        return float("nan"), ["its motion is not one of the free parts"]
    motion = np.zeros((len(program.names), 6))
    for name, six in proof["motion"].items():
        motion[assembly.index[name]] = six
    outer = build_program(assembly, contacts, possible=True, sticking=True)
    judged = check_motion(outer, motion)
    reasons = []
    if not judged.holds:
        reasons.append(
            f"the motion gains {judged.power:.3g} W and violates contacts by "
            f"{judged.violation:.3g}: that proves nothing"
        )
    sizes = part_sizes(outer, motion, per_radius=False)
    if not _near(sizes.max(initial=0.0), 1.0, 1.0):
        reasons.append("its fastest part does not move by 1")
    if outer.planar and motion[:, [1, 3, 5]].any():
        reasons.append("its motion leaves the plane")
    if not _near(judged.violation, proof["certificate"]["violation"], 1.0):
        reasons.append("its violation is not that of its motion")
    claimed = float(proof["certificate"]["power"])
    if abs(judged.power - claimed) > SAME * abs(claimed):
        reasons.append(f"its power is {judged.power:.6g} W, not {claimed:.6g} W")
    return judged.power, reasons
