"""Proofs of margins as data that anyone can verify: forces within a limit, a motion beyond it.

Each limit belongs to a change of the assembly: gravity along another direction, a single
coefficient at every contact, further loads. Just within the limit forces hold the changed
assembly, just beyond it a motion starts; both are as near to the limit as they are proved.
`kilter.analysis.limit_check` compares the stated value with the change.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from kilter.analysis.decision.judge import judge
from kilter.analysis.turning_tolerances import AROUND_LIMIT
from kilter.arrays import TINY, Array, cross
from kilter.assembly import Assembly
from kilter.contact import ContactSet
from kilter.mechanics.bundle import apply_change
from kilter.mechanics.certificate import ForceProof, MotionProof, check_motion
from kilter.mechanics.program import build_program
from kilter.mechanics.proof import Evidence, make_proof

if TYPE_CHECKING:
    from kilter.analysis.margins.margin import Margin

__all__ = ["changed_proof", "margin_proofs"]

Change = Callable[[float], dict[str, Any]]
About = tuple[dict[str, Any], dict[str, Any]]


def margin_proofs(limits: Margin, *, options: dict[str, Any]) -> list[About]:
    """Proofs of every limit of a margin: tilts, friction, bonds, load factors, pushes, loads."""
    proofs = []
    for what, (within, beyond), change, upwards, motion, more in _limits(limits):
        steps = AROUND_LIMIT if within == beyond else (0.0, *AROUND_LIMIT)
        for held in (True, False):
            sign = -1.0 if held == upwards else 1.0
            value = within if held else beyond
            for step in steps:
                at = value + sign * step * max(abs(value), 1.0)
                if at < 0 and what in ("friction", "bond"):
                    break
                data = _proof(limits, change(at), held, None if held else motion, options)
                if data is not None:
                    unit = more.get("unit", 1.0)
                    about = {"about": what, "value": at * unit, "held": held, "change": change(at)}
                    proofs.append((about | more.get("data", {}), data))
                    break
    return proofs


def _limits(
    limits: Margin,
) -> Iterator[tuple[str, tuple[float, float], Change, bool, MotionProof | None, dict[str, Any]]]:
    """Yield for each limit its name, a value on each side, the change of the file, and the motion.

    A flag states whether larger values are beyond the limit. The last entry has the unit of the
    stated value, and further data of the statement.

    The sides are the values that are held and not held, if both are proved; else a single value.
    """
    tilt, nearest, friction, bond = limits.tilt, limits.nearest, limits.friction_limit, limits.bond
    down = limits.program.down
    if tilt is not None and tilt.limit.motion is not None and (tilt.down != down).any():
        sides = tilt.angle, tilt.angle
        yield "tilt", sides, _turn_gravity(down, tilt.down), True, tilt.limit.motion, {}
    about = limits.about
    if about is not None and np.isfinite(about.tilt_deg):
        angle = float(np.radians(about.tilt_deg))
        turned = _turn_gravity(down, cross(about.axis, down))
        more = {"data": {"axis": about.axis.tolist()}}
        yield "tilt about the axis", (angle, angle), turned, True, about.limit.motion, more
    if nearest is not None and (nearest.down != down).any():
        sides = nearest.angle, nearest.lower
        yield "nearest held", sides, _turn_gravity(down, nearest.down), False, nearest.motion, {}
    if friction is not None and friction.value > 0 and friction.attained:
        sides = friction.value, friction.lower
        yield "friction", sides, lambda mu: {"mu": mu}, False, friction.motion, {}
    if limits.bond_limit is not None and bond is not None:
        motion = limits.bond_limit.limit.motion
        yield "bond", (bond, bond), lambda share: {"strength": share}, False, motion, {}
    least, greatest = limits.load_limits or (None, None)
    scaled = _scale_loads(limits)
    more = {} if limits.push is None else {"data": {"push": limits.push.tolist()}}
    if greatest is not None and np.isfinite(greatest.value):
        sides = greatest.value, greatest.value
        yield "load factor", sides, scaled, True, greatest.motion, more
    if least is not None and np.isfinite(least.value):
        sides = -least.value, -least.value
        yield "least load factor", sides, scaled, False, least.motion, more
    for push in limits.pushes:
        if np.isfinite(push.force):
            weight = float(limits.program.weight[limits.program.free].sum())
            pushed = _push_part(limits.assembly, push.part, push.direction * weight)
            sides = push.force / weight, push.force / weight
            share = {"unit": weight}
            yield f"push of {push.part}", sides, pushed, True, push.limit.motion, share
    for load in limits.loads:
        if 0 < load.load < np.inf:
            within, beyond = load.load / load.unit, load.beyond / load.unit
            sides = within, beyond if np.isfinite(beyond) else within
            pressed = _push_part(limits.assembly, load.part, down * load.unit)
            share = {"unit": load.unit}
            yield f"load on {load.part}", sides, pressed, True, load.limit.motion, share


def _turn_gravity(down: Array, toward: Array) -> Change:
    """Function from an angle [rad] to a changed file, with gravity turned `toward` a direction."""
    aside = toward - (toward @ down) * down
    aside = aside / max(float(np.linalg.norm(aside)), TINY)
    return lambda angle: {"down": (np.cos(angle) * down + np.sin(angle) * aside).tolist()}


def _load(part: str, force: Array, torque: Array, point: Array | None = None) -> dict[str, Any]:
    where = None if point is None else point.tolist()
    return {"part": part, "force": force.tolist(), "torque": torque.tolist(), "point": where}


def _scale_loads(limits: Margin) -> Change:
    """Function from a load factor to a changed file, with scaled loads or a body force."""
    assembly, program = limits.assembly, limits.program
    if limits.push is None:
        return lambda share: {
            "loads": [
                _load(load.part, share * load.force, share * load.torque, load.point)
                for load in assembly.loads
            ]
        }
    given = [_load(load.part, load.force, load.torque, load.point) for load in assembly.loads]
    push = limits.push * program.g
    return lambda share: {
        "loads": given
        + [
            _load(name, share * mass * push, np.zeros(3))
            for name, mass, free in zip(program.names, program.mass, program.free, strict=True)
            if free
        ]
    }


def _push_part(assembly: Assembly, part: str, force: Array) -> Change:
    given = [_load(load.part, load.force, load.torque, load.point) for load in assembly.loads]
    return lambda share: {"loads": [*given, _load(part, share * force, np.zeros(3))]}


def _proof(
    limits: Margin,
    change: dict[str, Any],
    held: bool,
    motion: MotionProof | None,
    options: dict[str, Any],
) -> dict[str, Any] | None:
    """Proof that the assembly after a change holds or falls; None if there is no proof."""
    return changed_proof(limits.assembly, limits.contacts, change, held, motion, options)


def changed_proof(
    assembly: Assembly,
    contacts: ContactSet,
    change: dict[str, Any],
    held: bool,
    motion: MotionProof | None,
    options: dict[str, Any],
) -> dict[str, Any] | None:
    """Proof of a changed assembly: forces that hold it, or a motion; None without a proof.

    Parameters
    ----------
    assembly, contacts
        The assembly of the file and its contacts.
    change : dict
        Differences from the file, as in `kilter.mechanics.bundle`.
    held : bool
        True for a proof by forces.
    motion : MotionProof or None
        A motion that may be the proof.
    options : dict
        Options with which the file was read.
    """
    assembly, contacts = apply_change(assembly, contacts, change)
    # no force that was left out may stop a motion
    program = build_program(assembly, contacts, possible=not held)
    proof: ForceProof | MotionProof | None = None
    if motion is not None:
        proof = check_motion(program, motion.motion)
    if proof is None or not proof.holds:
        judged = judge(program)
        proof = judged.forces if held else judged.motion
    if proof is None or not proof.holds:
        return None
    evidence = Evidence("open") if program.mu.any() else None
    return make_proof(assembly, contacts, program, proof, options, evidence=evidence)
