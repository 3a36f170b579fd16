"""Recheck a proof file against the program of its assembly: numbers first, then evidence.

The exclusion of all motions that obey Coulomb's law is verified in
`kilter.friction.exclusion_file`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from kilter.arrays import TINY, Array, Index
from kilter.assembly import Assembly
from kilter.contact.contact_set import ContactSet
from kilter.mechanics.certificate import ForceProof, check_forces, check_motion, part_sizes
from kilter.mechanics.degenerate import allowed_program
from kilter.mechanics.joints import joint_forces, joint_wrench
from kilter.mechanics.law_check import LawProof, check_law
from kilter.mechanics.mechanics_tolerances import (
    AGREES,
    POWER_ROUNDING,
    RULED_OUT,
    UNITS_IN_LAST_PLACE,
)
from kilter.mechanics.program import Program, build_program
from kilter.mechanics.proof import (
    coefficients,
    digest_of,
    frame_of,
    joints_of,
    open_pairs_of,
    rows_of,
)
from kilter.mechanics.rows import BONDED, CONTACT, JOINT, OF_JOINTS


@dataclass(frozen=True, slots=True, eq=False)
class RecheckResult:
    """Result of a recheck of a proof: objections, measures of the evidence, and notes.

    `residual` is the largest imbalance of a part over its weight [-], `power` that of the motion if
    the fastest part moves at 1 m/s [W].
    """

    reasons: list[str]
    residual: float | None
    power: float | None
    notes: list[str]


def recheck(assembly: Assembly, contacts: ContactSet, proof: dict[str, Any]) -> RecheckResult:
    """Recompute a proof from an assembly and the contacts found in it.

    The proof must have the form that `kilter.mechanics.proof_form` verifies.
    """
    reasons = []
    if proof.get("digest") != digest_of(proof):
        reasons.append("the file was changed after it was written (its digest does not fit)")
    has_forces = "forces" in proof
    friction = proof.get("friction")
    reasons += _verdict_objections(proof["verdict"], has_forces, friction)
    program = build_program(assembly, contacts)
    reasons += _subject_objections(assembly, contacts, program, proof)
    residual = power = None
    notes: list[str] = []
    if not reasons and has_forces:
        friction_program = program.frictionless if friction is None else program
        residual, reasons = _recheck_forces(friction_program, proof)
        if friction is not None:
            objections, notes = _recheck_friction(program, friction, assembly)
            reasons += objections
    elif not reasons:
        power, reasons = _recheck_motion(assembly, contacts, proof)
        notes += _open_pair_notes(proof["open_pairs"])
    return RecheckResult(reasons, residual, power, notes)


def _verdict_objections(verdict: str, balanced: bool, friction: dict[str, Any] | None) -> list[str]:
    """Objections to a stated verdict that the evidence of its proof does not support."""
    guarantee = "proved" if friction is None else friction["guarantee"]
    if not balanced:
        supported = "unstable"
    elif guarantee == "proved":
        supported = "stable"
    else:
        supported = "potentially-stable"
    if verdict in ("balanced", "potentially-stable") and supported == "stable":
        verdict = supported  # small pushes decide: `kilter.second_order.proofs.push_recheck`
    if verdict == "settles" and guarantee == "open":
        return []  # a claim beyond equilibrium: verification repeats the tries
    if verdict != supported:
        return [f"the proof states {verdict!r} but carries the evidence of {supported!r}"]
    if friction is None or not balanced:
        return []
    if (guarantee == "refuted") != (friction["witness"] is not None):
        return [
            f"the proof states {guarantee!r} but "
            f"{'has no' if guarantee == 'refuted' else 'has a'} witness"
        ]
    if guarantee == "proved" and not friction["exclusion"]:
        return ["the proof states 'proved' but not how every motion was excluded"]
    return []


def _agree(first: Any, second: Any, size: float) -> bool:
    """True if two arrays have the same shape and differ by at most `AGREES` times `size`."""
    a, b = np.asarray(first, dtype=float), np.asarray(second, dtype=float)
    return a.shape == b.shape and bool((np.abs(a - b) <= AGREES * size).all())


def _subject_objections(
    assembly: Assembly, contacts: ContactSet, program: Program, proof: dict[str, Any]
) -> list[str]:
    """Objections to a proof whose parts, contacts or loads differ from those of the assembly."""
    reasons = []
    gravity = float(np.linalg.norm(assembly.gravity))
    if not _agree(proof["gravity"], assembly.gravity, gravity):
        reasons.append(f"its gravity is {proof['gravity']}, the file's {assembly.gravity.tolist()}")
    if not _agree(proof["down"], assembly.down, 1.0):
        reasons.append("its direction of gravity differs from that of the file")
    if proof["planar"] != assembly.planar or proof["units"] != assembly.units:
        reasons.append("the proof and the file differ in `planar` or in units")
    reasons += _part_objections(program, proof["parts"])
    reasons += _point_objections(contacts, program, proof["points"])
    loads = [
        (load["part"], load["point"], load["force"], load["torque"]) for load in proof["loads"]
    ]
    file_loads = [
        (
            load.part,
            None if load.point is None else load.point.tolist(),
            load.force.tolist(),
            load.torque.tolist(),
        )
        for load in assembly.loads
    ]
    if loads != file_loads:
        reasons.append("its loads differ from those of the file")
    if proof.get("straps", []) != [strap.to_dict() for strap in assembly.straps]:
        reasons.append("its straps differ from those of the file")
    joints = [{**entry, "wrench": None} for entry in proof["joints"]]
    if joints != joints_of(assembly, program, None):
        reasons.append("its joints differ from those of the file")
    return reasons


def _part_objections(program: Program, parts: list[dict[str, Any]]) -> list[str]:
    """Objections to the parts of a proof, at most 10."""
    if [part["name"] for part in parts] != list(program.names):
        return ["its parts differ from those of the file"]
    reasons = []
    for k, part in enumerate(parts):
        if part["grounded"] == bool(program.free[k]):
            reasons.append(
                f"part {part['name']!r} is {'held' if part['grounded'] else 'free'} in the proof"
            )
        if not program.free[k]:
            continue  # the ground carries it, so that its mass counts nowhere
        if not _agree(part["mass"], program.mass[k], program.mass[k]):
            reasons.append(f"part {part['name']!r} has another mass in the proof")
        reach = program.radius[k] + float(np.abs(program.center[k]).max())
        if not _agree(part["center"], program.center[k], reach):
            reasons.append(f"part {part['name']!r} has another centre of mass in the proof")
    return reasons[:10]


def _point_objections(
    contacts: ContactSet, program: Program, points: list[dict[str, Any]]
) -> list[str]:
    """Objections to the contact points of a proof: wrong position, normal, friction or bond."""
    rows = np.flatnonzero(program.kind == CONTACT)
    if len(points) != len(rows):
        return [f"the proof has {len(points)} contact points, the file {len(rows)}"]
    if not len(rows):
        return []
    pairs = [[program.names[program.part_a[k]], program.names[program.part_b[k]]] for k in rows]
    if [list(p["parts"]) for p in points] != pairs:
        return ["its contacts are between other parts"]
    size = float(np.abs(program.point).max()) + float(program.radius.max())
    reasons = []
    if not _agree([p["x"] for p in points], program.point[rows], size):
        reasons.append("its contact points are at other places than those of the file")
    if not _agree([p["normal"] for p in points], program.normal[rows], 1.0):
        reasons.append("its contact normals differ from those of the file")
    if not _agree([p["mu"] for p in points], coefficients(contacts, program, rows), 1.0):
        reasons.append("its friction coefficients differ from those of the file")
    pulls = [p.get("pull", 0.0) for p in points]
    tied = [p.get("tied", False) for p in points]
    strongest = float(program.pull.max(initial=0.0))
    same_pull = _agree(pulls, program.pull[rows], strongest) and tied == program.tied[rows].tolist()
    if not same_pull or not _same_shear(program, rows, [p.get("shear") for p in points]):
        reasons.append("its bonds differ from those of the file")
    return reasons


def _same_shear(program: Program, rows: Index, given: list[float | None]) -> bool:
    """True if the shear limits in a proof (None: no limit) are those of the program's rows."""
    limits = program.shear[rows]
    if [limit is None for limit in given] != np.isnan(limits).tolist():
        return False
    strongest = float(program.cohesion.max(initial=0.0))
    return _agree([limit or 0.0 for limit in given], np.nan_to_num(limits), strongest)


def _given_forces(
    program: Program, given: Any, joints: Any, pulls: Any = ()
) -> tuple[Array, Array, list[str]]:
    """Normal and friction forces of the rows from the forces in a proof, and objections.

    The proof has forces of contact points, of joints, and the pulls of straps with a capacity.

    Returns forces, shape (K,), friction, shape (K, 3), and the objections to them.
    """
    rows = np.flatnonzero(program.kind == CONTACT)
    vectors = np.asarray(given, dtype=float).reshape(-1, 3)
    if len(vectors) != len(rows):
        zeros = np.zeros(len(program.part_a))
        return (
            zeros,
            np.zeros((len(zeros), 3)),
            ["the proof does not have a force for each contact point"],
        )
    forces, friction = program.row_forces(vectors)
    of_joints = np.isin(program.kind, OF_JOINTS)
    if len(joints) != int(of_joints.sum()):
        return forces, friction, ["the proof does not have a force for each row of a joint"]
    forces[of_joints] = joints
    straps, strap = program.bounded_straps
    if len(pulls) != len(straps):
        return forces, friction, ["the proof does not have a pull for each strap with a capacity"]
    forces[program.strap_pieces] = np.asarray(pulls, dtype=float)[strap]
    capacity = program.capacity[straps]
    if (forces[straps] < -AGREES * capacity).any():
        return forces, friction, ["a strap pushes"]
    if (forces[straps] > (1 + AGREES) * capacity).any():
        return forces, friction, ["a strap pulls more than its capacity"]
    tangential = np.linalg.norm(friction[rows], axis=1)
    bond = np.maximum(program.pull[rows], program.tied[rows] * np.linalg.norm(vectors, axis=1))
    push = np.maximum(np.abs(forces[rows]), float(program.weight.min()) * AGREES)
    slack = AGREES * np.maximum(push, bond) + TINY  # f' of a bond is a small difference
    reasons = []
    limit = program.mu[rows] * np.maximum(forces[rows], 0) + program.cohesion[rows]
    beyond = tangential > limit + np.maximum(slack, AGREES * program.cohesion[rows])
    if (beyond & ~np.isnan(program.shear[rows])).any():
        reasons.append("a force across a bond exceeds its shear limit")
    if (beyond & np.isnan(program.shear[rows])).any():
        rough = bool(program.mu.any())
        why = (
            "its friction exceeds mu times its normal force"
            if rough
            else "it is not along the normal"
        )
        reasons.append(f"a force leaves its cone: {why}")
    if (forces[rows] < -AGREES * bond).any():
        bonded = bool(program.pull.any())
        reasons.append("a force pulls more than its bond" if bonded else "a contact force pulls")
    return forces, friction, reasons


def _joint_forces(program: Program, joint: dict[str, Any], number: int) -> tuple[Array, list[str]]:
    """Forces of a joint's rows that transmit the wrench given in a proof, and objections."""
    wrench, about = np.asarray(joint["wrench"], dtype=float), np.asarray(joint["point"])
    rows = rows_of(program, number)
    frame = frame_of(program, rows)
    forces = _shared(program, rows, joint_forces(*frame, wrench, about))
    force, torque = np.abs(wrench[:3]).max(), np.abs(wrench[3:]).max()
    turning = rows[program.angular[rows]]
    length = float(program.arm[turning].max(initial=0.0)) or float(program.radius.min())
    reach = length + (float(np.linalg.norm(about - frame[2])) if len(rows) else 0.0)
    size = np.repeat([force + torque / length, reach * force + torque], 3)
    size += AGREES * float(program.weight.min()) * np.repeat([1.0, length], 3)
    if (np.abs(wrench - joint_wrench(*frame, forces, about)) <= AGREES * size).all():
        return forces, []
    pair = " and ".join(repr(name) for name in joint["parts"])
    return forces, [f"the {joint['kind']} joint of {pair} has a load that its kind cannot carry"]


def _shared(program: Program, rows: Index, forces: Array) -> Array:
    """Forces of a joint's rows in which the part along the free motion counts once.

    Each of the rows along the free motion has this whole part in `forces`.
    """
    guides = np.flatnonzero(program.kind[rows] != JOINT)
    single = forces.copy()
    single[guides[1:]] = 0.0
    whole = np.zeros(len(program.part_a))
    whole[rows] = single
    return program.by_stops(whole)[rows]


def proof_forces(program: Program, proof: dict[str, Any]) -> tuple[Array, Array, list[str]]:
    """Forces along the rows, (K,), and across them, (K, 3), of a proof [N], and objections."""
    joints = np.zeros(len(program.part_a))
    joint_objections: list[str] = []
    for number, entry in enumerate(proof["joints"]):
        joints[rows_of(program, number)], objections = _joint_forces(program, entry, number)
        joint_objections += objections
    joints = joints[np.isin(program.kind, OF_JOINTS)]
    forces, friction, reasons = _given_forces(
        program, proof["forces"], joints, proof.get("pulls", [])
    )
    return forces, friction, reasons + joint_objections


def _recheck_forces(program: Program, proof: dict[str, Any]) -> tuple[float, list[str]]:
    """Check the equilibrium forces of a proof: relative residual [-], and objections."""
    forces, friction, reasons = proof_forces(program, proof)
    judged = check_forces(program, forces, friction)
    rounding = 10 * UNITS_IN_LAST_PLACE * _squeeze(program, judged) / AGREES
    if not _agree(judged.residual, proof["certificate"]["residual"], max(1.0, rounding)):
        reasons.append("its stated residual differs from that of its forces")
    if not judged.holds:
        reasons.append(_unbalanced(program, judged))
    return judged.residual, reasons


def _unbalanced(program: Program, judged: ForceProof) -> str:
    """Reason why forces are no proof: the imbalance over the weight, and the largest forces."""
    squeeze = _squeeze(program, judged)
    hard = f"; its forces press a part with {squeeze:.1e} weights" if squeeze > RULED_OUT else ""
    return f"the forces leave {judged.residual:.3g} of a part's weight unbalanced{hard}"


def _squeeze(program: Program, judged: ForceProof) -> float:
    """Largest sum of the forces on a part, over its weight [-]."""
    sums = program.force_sums(judged.forces, judged.friction)[program.free]
    return float((sums / np.maximum(program.weight[program.free], TINY)).max(initial=0.0))


def _recheck_friction(
    program: Program, friction: dict[str, Any], assembly: Assembly
) -> tuple[list[str], list[str]]:
    """Check the motion that obeys Coulomb's law in a proof; returns objections and notes."""
    reasons: list[str] = []
    notes: list[str] = []
    witness = friction["witness"]
    if witness is not None:
        law = _witness_check(program, witness, assembly)
        if law is None:
            return [
                "its motion does not belong to the free parts, contacts and joints of the file"
            ], notes
        if not law.holds:
            reasons.append(f"the motion breaks Coulomb's law by {law.residual:.3g}")
        claimed = witness["power"], witness["residual"]
        if not _agree((law.power, law.residual), claimed, 1.0):
            reasons.append("the power or residual of the motion differs from its stated value")
        notes.append(f"a motion obeys Coulomb's law too, to {law.residual:.1e}")
    return reasons, notes


def _witness_check(
    program: Program, witness: dict[str, Any], assembly: Assembly
) -> LawProof | None:
    """Check a motion in a proof against the contact law; None if it does not fit the program."""
    free = {n for n, f in zip(program.names, program.free, strict=True) if f}
    kinds = {"forces": (CONTACT,), "joints": OF_JOINTS, "bonds": (BONDED,)}
    rows = {key: np.isin(program.kind, kind) for key, kind in kinds.items()}
    if set(witness["acceleration"]) != free or any(
        len(witness[key]) != int(mask.sum()) for key, mask in rows.items()
    ):
        return None
    acceleration = np.zeros((len(program.names), 6))
    for name, six in witness["acceleration"].items():
        acceleration[assembly.index[name]] = six
    forces = np.zeros((len(program.part_a), 3))
    for key, mask in rows.items():
        forces[mask] = np.asarray(witness[key], dtype=float).reshape(-1, 3)
    return check_law(program, acceleration, forces)


def _open_pair_notes(pairs: list[Any]) -> list[str]:
    """A note on the open (uncertain) pairs, whose contacts the motion of a proof respects."""
    if not pairs:
        return []
    return [f"the motion is possible whatever the {len(pairs)} open pairs do"]


def _recheck_motion(
    assembly: Assembly, contacts: ContactSet, proof: dict[str, Any]
) -> tuple[float, list[str]]:
    """Check the motion of a proof of instability: its power, and objections."""
    program = build_program(assembly, contacts)
    if set(proof["motion"]) != {n for n, f in zip(program.names, program.free, strict=True) if f}:
        return float("nan"), ["its motion does not belong to the free parts"]
    motion = np.zeros((len(program.names), 6))
    for name, six in proof["motion"].items():
        motion[assembly.index[name]] = six
    outer = build_program(assembly, contacts, possible=True)
    judged = check_motion(outer, motion)
    if not judged.holds and len(contacts.degenerate):
        # at a degenerate point a motion may violate some of the normals, but not all
        outer = allowed_program(assembly, contacts, motion) or outer
        judged = check_motion(outer, motion)
    reasons = []
    if not judged.holds:
        reasons.append(
            f"the motion gains {judged.power:.3g} W and violates contacts by "
            f"{judged.violation:.3g}, {judged.ratio:.3g} of what it needs: that proves nothing"
        )
    if proof["open_pairs"] != open_pairs_of(assembly, contacts):
        reasons.append("its open pairs differ from those of the file, so the motion may be blocked")
    sizes = part_sizes(outer, motion, per_radius=False)
    if not _agree(sizes.max(initial=0.0), 1.0, 1.0):
        reasons.append("its fastest part does not move by 1")
    if outer.planar and motion[:, [1, 3, 5]].any():
        reasons.append("its motion leaves the plane")
    if not _agree(judged.violation, proof["certificate"]["violation"], 1.0):
        reasons.append("its stated violation differs from that of its motion")
    claimed = float(proof["certificate"]["power"])
    # near a limit the power is a small difference of large terms (cancellation)
    terms = float(np.abs(outer.load * motion).sum())
    if abs(judged.power - claimed) > AGREES * abs(claimed) + POWER_ROUNDING * terms:
        reasons.append(f"its power is {judged.power:.6g} W, not {claimed:.6g} W")
    return judged.power, reasons
