"""A proof judged again on the program of an assembly: number by number, then its evidence.

That no motion obeys Coulomb's law is judged elsewhere (`kilter.friction.exclusion_file`).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from kilter.arrays import TINY, Array, Index
from kilter.assembly import Assembly
from kilter.contact.contact_set import ContactSet
from kilter.mechanics.certificate import check_forces, check_motion, part_sizes
from kilter.mechanics.degenerate import allowed_program
from kilter.mechanics.joints import joint_forces, joint_wrench
from kilter.mechanics.law_check import LawProof, check_law
from kilter.mechanics.mechanics_tolerances import AGREES, POWER_ROUNDING
from kilter.mechanics.program import Program, build_program
from kilter.mechanics.proof import (
    coefficients,
    digest_of,
    frame_of,
    joints_of,
    open_pairs_of,
    rows_of,
)
from kilter.mechanics.rows import CONTACT, JOINT

__all__ = ["RecheckResult", "recheck"]

LEAST_TRIES = 8
"""Tries that must have come to rest for a proof to say that it settles."""


@dataclass(frozen=True, slots=True, eq=False)
class RecheckResult:
    """What speaks against a proof, what its evidence is worth, and notes; see `Verification`."""

    reasons: list[str]
    residual: float | None
    power: float | None
    notes: list[str]


def recheck(assembly: Assembly, contacts: ContactSet, proof: dict[str, Any]) -> RecheckResult:
    """Recompute a proof, of the form of proofs, from an assembly and the contacts found in it."""
    reasons = []
    if proof.get("digest") != digest_of(proof):
        reasons.append("the file was changed after it was written (its digest does not fit)")
    balanced = "forces" in proof
    friction = proof.get("friction")
    reasons += _wrong_verdict(proof["verdict"], balanced, friction)
    program = build_program(assembly, contacts)
    reasons += _differences(assembly, contacts, program, proof)
    residual = power = None
    notes: list[str] = []
    if not reasons and balanced:
        judged = program.frictionless if friction is None else program
        residual, reasons = _recheck_forces(judged, proof)
        if friction is not None:
            more, notes = _recheck_friction(program, friction, assembly)
            reasons += more
    elif not reasons:
        power, reasons = _recheck_motion(assembly, contacts, proof)
        notes += _survived(proof["open_pairs"])
    return RecheckResult(reasons, residual, power, notes)


def _wrong_verdict(verdict: str, balanced: bool, friction: dict[str, Any] | None) -> list[str]:
    """A word where the verdict is not what its evidence can carry."""
    guarantee = "proved" if friction is None else friction["guarantee"]
    if not balanced:
        fits = "unstable"
    elif guarantee == "proved":
        fits = "stable"
    elif guarantee == "open" and _settles(friction):
        fits = "settles"
    else:
        fits = "potentially-stable"
    if verdict == "balanced" and friction is None:
        verdict = "stable"  # second order separates the two: `kilter.analysis.verification`
    if verdict != fits:
        return [f"it says {verdict!r} but carries the evidence of {fits!r}"]
    if friction is None or not balanced:
        return []
    if (guarantee == "refuted") != (friction["witness"] is not None):
        return [
            f"it says {guarantee!r} but {'has no' if guarantee == 'refuted' else 'has a'} witness"
        ]
    if guarantee == "proved" and not friction["exclusion"]:
        return ["it says 'proved' but not how every motion was excluded"]
    return []


def _settles(friction: dict[str, Any] | None) -> bool:
    """Whether every try of enough is there."""
    tries = None if friction is None else friction["tries"]
    return tries is not None and LEAST_TRIES <= tries["of"] == len(tries["forces"])


def _near(one: Any, other: Any, size: float) -> bool:
    a, b = np.asarray(one, dtype=float), np.asarray(other, dtype=float)
    return a.shape == b.shape and bool((np.abs(a - b) <= AGREES * size).all())


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
    own_joints = joints_of(assembly, program, None)
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
    if not _near([p["mu"] for p in points], coefficients(contacts, program, rows), 1.0):
        reasons.append("its friction coefficients are not the file's")
    pulls = [p.get("pull", 0.0) for p in points]
    tied = [p.get("tied", False) for p in points]
    strongest = float(program.pull.max(initial=0.0))
    same = _near(pulls, program.pull[rows], strongest) and tied == program.tied[rows].tolist()
    if not same or not _same_shear(program, rows, [p.get("shear") for p in points]):
        reasons.append("its bonds are not the file's")
    return reasons


def _same_shear(program: Program, rows: Index, given: list[float | None]) -> bool:
    """Whether limits of shear, None where there is none, are those of the rows."""
    own = program.shear[rows]
    if [one is None for one in given] != np.isnan(own).tolist():
        return False
    strongest = float(program.cohesion.max(initial=0.0))
    return _near([one or 0.0 for one in given], np.nan_to_num(own), strongest)


def _given_forces(program: Program, given: Any, joints: Any) -> tuple[Array, Array, list[str]]:
    """Forces along and across the rows from vectors at the contact points, and complaints."""
    rows = np.flatnonzero(program.kind == CONTACT)
    vectors = np.asarray(given, dtype=float).reshape(-1, 3)
    if len(vectors) != len(rows):
        none = np.zeros(len(program.part_a))
        return none, np.zeros((len(none), 3)), ["it has not one force a contact point"]
    forces, friction = program.row_forces(vectors)
    if len(joints) != int((program.kind == JOINT).sum()):
        return forces, friction, ["it has not one force a row of a joint"]
    forces[np.flatnonzero(program.kind == JOINT)] = joints
    aside = np.linalg.norm(friction[rows], axis=1)
    bond = np.maximum(program.pull[rows], program.tied[rows] * np.linalg.norm(vectors, axis=1))
    size = np.maximum(np.abs(forces[rows]), float(program.weight.min()) * AGREES)
    slack = AGREES * np.maximum(size, bond) + TINY  # of a bond, f' is the rest of larger numbers
    reasons = []
    most = program.mu[rows] * np.maximum(forces[rows], 0) + program.cohesion[rows]
    beyond = aside > most + np.maximum(slack, AGREES * program.cohesion[rows])
    if (beyond & ~np.isnan(program.shear[rows])).any():
        reasons.append("a force across a bond is above what it bears")
    if (beyond & np.isnan(program.shear[rows])).any():
        rough = bool(program.mu.any())
        why = "its friction is above mu times its push" if rough else "it is not along the normal"
        reasons.append(f"a force leaves its cone: {why}")
    if (forces[rows] < -AGREES * bond).any():
        bonded = bool(program.pull.any())
        reasons.append("a force pulls more than its bond" if bonded else "a contact force pulls")
    return forces, friction, reasons


def _joint_forces(program: Program, joint: dict[str, Any], number: int) -> tuple[Array, list[str]]:
    """Forces of the rows of a joint that its wrench stands for, and what it cannot carry."""
    wrench, about = np.asarray(joint["wrench"], dtype=float), np.asarray(joint["point"])
    rows = rows_of(program, number)
    frame = frame_of(program, rows)
    forces = joint_forces(*frame, wrench, about)
    force, torque = np.abs(wrench[:3]).max(), np.abs(wrench[3:]).max()
    turning = rows[program.angular[rows]]
    length = float(program.arm[turning].max(initial=0.0)) or float(program.radius.min())
    reach = length + (float(np.linalg.norm(about - frame[2])) if len(rows) else 0.0)
    size = np.repeat([force + torque / length, reach * force + torque], 3)
    size += AGREES * float(program.weight.min()) * np.repeat([1.0, length], 3)
    if (np.abs(wrench - joint_wrench(*frame, forces, about)) <= AGREES * size).all():
        return forces, []
    pair = " and ".join(repr(name) for name in joint["parts"])
    return forces, [f"the {joint['kind']} joint of {pair} carries what its kind cannot"]


def _recheck_forces(program: Program, proof: dict[str, Any]) -> tuple[float, list[str]]:
    joints = np.zeros(len(program.part_a))
    beyond: list[str] = []
    for number, entry in enumerate(proof["joints"]):
        joints[rows_of(program, number)], more = _joint_forces(program, entry, number)
        beyond += more
    joints = joints[program.kind == JOINT]
    forces, friction, reasons = _given_forces(program, proof["forces"], joints)
    reasons += beyond
    judged = check_forces(program, forces, friction)
    if not _near(judged.residual, proof["certificate"]["residual"], 1.0):
        reasons.append("its residual is not that of its forces")
    if not judged.holds:
        reasons.append(f"the forces leave {judged.residual:.3g} of a part's weight unbalanced")
    return judged.residual, reasons


def _recheck_friction(
    program: Program, friction: dict[str, Any], assembly: Assembly
) -> tuple[list[str], list[str]]:
    """Complaints about, and notes on, the evidence of friction."""
    reasons, notes = [], []
    seated, witness = friction["seated"], friction["witness"]
    if seated is not None:
        residual, more = _recheck_balance(program, seated)
        reasons += [f"seated: {word}" for word in more]
        notes.append(f"seated by forces that balance to {residual:.1e} of a weight")
    reasons += _recheck_tries(program, friction["tries"], notes)
    if witness is not None:
        law = _law_of(program, witness, assembly)
        if law is None:
            return [*reasons, "its motion is not one of the free parts, contacts and joints"], notes
        if not law.holds:
            reasons.append(f"the motion breaks Coulomb's law by {law.residual:.3g}")
        claimed = witness["power"], witness["residual"]
        if not _near((law.power, law.residual), claimed, 1.0):
            reasons.append("power or residual of the motion are not those that it states")
        notes.append(f"a motion obeys Coulomb's law too, to {law.residual:.1e}")
    return reasons, notes


def _recheck_balance(program: Program, given: dict[str, Any]) -> tuple[float, list[str]]:
    """Residual of forces that are to balance every part, and complaints."""
    forces, across, reasons = _given_forces(program, given["forces"], given["joints"])
    judged = check_forces(program, forces, across)
    if not judged.holds or not _near(judged.residual, given["residual"], 1.0):
        reasons.append("the forces do not balance")
    return judged.residual, reasons


def _recheck_tries(program: Program, tries: dict[str, Any], notes: list[str]) -> list[str]:
    """Complaints about the forces of the tries, and a note on them."""
    reasons, worst = [], 0.0
    if tries["passed"] != len(tries["forces"]) or tries["passed"] > tries["of"]:
        return ["it has not the forces of every try that it says came to rest"]
    for number, one in enumerate(tries["forces"], 1):
        residual, more = _recheck_balance(program, one)
        reasons += [f"try {number}: {word}" for word in more]
        worst = max(worst, residual)
    if tries["passed"]:
        notes.append(
            f"{tries['passed']} of {tries['of']} tries came to rest, by forces that balance to "
            f"{worst:.1e} of a weight; the way there is not repeated here"
        )
    return reasons


def _law_of(program: Program, witness: dict[str, Any], assembly: Assembly) -> LawProof | None:
    """The motion judged; None where it is one of other parts, contacts or joints."""
    free = {n for n, f in zip(program.names, program.free, strict=True) if f}
    rows = {"forces": program.kind == CONTACT, "joints": program.kind == JOINT}
    if set(witness["acceleration"]) != free or any(
        len(witness[key]) != int(own.sum()) for key, own in rows.items()
    ):
        return None
    acceleration = np.zeros((len(program.names), 6))
    for name, six in witness["acceleration"].items():
        acceleration[assembly.index[name]] = six
    forces = np.zeros((len(program.part_a), 3))
    for key, own in rows.items():
        forces[own] = np.asarray(witness[key], dtype=float).reshape(-1, 3)
    return check_law(program, acceleration, forces)


def _survived(pairs: list[Any]) -> list[str]:
    """Which open pairs the motion of a proof is held against."""
    if not pairs:
        return []
    return [f"the motion is one whatever {len(pairs)} open pairs do at their most"]


def _recheck_motion(
    assembly: Assembly, contacts: ContactSet, proof: dict[str, Any]
) -> tuple[float, list[str]]:
    program = build_program(assembly, contacts)
    if set(proof["motion"]) != {n for n, f in zip(program.names, program.free, strict=True) if f}:
        return float("nan"), ["its motion is not one of the free parts"]
    motion = np.zeros((len(program.names), 6))
    for name, six in proof["motion"].items():
        motion[assembly.index[name]] = six
    outer = build_program(assembly, contacts, possible=True)
    judged = check_motion(outer, motion)
    if not judged.holds and len(contacts.degenerate):
        # it may enter along some of the normals of a degenerate point, not along all of them
        outer = allowed_program(assembly, contacts, motion) or outer
        judged = check_motion(outer, motion)
    reasons = []
    if not judged.holds:
        reasons.append(
            f"the motion gains {judged.power:.3g} W and violates contacts by "
            f"{judged.violation:.3g}: that proves nothing"
        )
    if proof["open_pairs"] != open_pairs_of(assembly, contacts):
        reasons.append("its open pairs, which the motion has to survive, are not the file's")
    sizes = part_sizes(outer, motion, per_radius=False)
    if not _near(sizes.max(initial=0.0), 1.0, 1.0):
        reasons.append("its fastest part does not move by 1")
    if outer.planar and motion[:, [1, 3, 5]].any():
        reasons.append("its motion leaves the plane")
    if not _near(judged.violation, proof["certificate"]["violation"], 1.0):
        reasons.append("its violation is not that of its motion")
    claimed = float(proof["certificate"]["power"])
    # near a limit the power is what is left of a sum of larger numbers
    terms = float(np.abs(outer.load * motion).sum())
    if abs(judged.power - claimed) > AGREES * abs(claimed) + POWER_ROUNDING * terms:
        reasons.append(f"its power is {judged.power:.6g} W, not {claimed:.6g} W")
    return judged.power, reasons
