"""The answer of `kilter margin` as JSON data."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from kilter.analysis.answers import joints_answer
from kilter.mechanics.certificate import MotionProof
from kilter.mechanics.program import Program

if TYPE_CHECKING:
    from kilter.analysis.margins.load_limit import Limit
    from kilter.analysis.margins.margin import Margin
    from kilter.analysis.margins.uncertainty import Uncertainty

__all__ = ["margin_answer", "starting"]

MOVES = 1e-6
"""A part moves in a mechanism where it is faster than this part of the fastest."""


def margin_answer(margin: Margin) -> dict[str, Any]:
    """The answer of `kilter margin --json`."""
    program, friction = margin.program, margin.friction
    factor = margin.load_factor
    about = margin.about
    return {
        "verdict": margin.verdict.verdict,
        "guarantee": margin.verdict.guarantee,
        "units": margin.assembly.units,
        "down": margin.assembly.down.tolist(),
        "joints": joints_answer(margin.assembly),
        "tilt_deg": margin.tilt_deg,
        "tilt_lower_deg": None if margin.tilt is None else float(np.degrees(margin.tilt.lower)),
        "tilt_down": None if margin.tilt_down is None else margin.tilt_down.tolist(),
        "tilt_limit": None if margin.tilt is None else _limit(program, margin.tilt.limit),
        "about": None
        if about is None
        else {
            "tilt_deg": float(np.degrees(about[0])) if np.isfinite(about[0]) else None,
            "limit": _limit(program, about[1]),
        },
        "friction": None if friction is None else float(friction.value),
        "friction_limit": None
        if friction is None
        else {
            "lower": float(friction.lower),
            "attained": friction.attained,
            "residual": friction.forces.residual,
            "moves": starting(program, friction.mechanism),
        },
        "load_factor": None if factor is None else _interval(factor),
        "load_factor_bracket": _bracket(margin),
        "load_limits": None if factor is None else [_limit(program, f) for f in factor],
        "pushes": [
            {
                "part": push.part,
                "direction": push.direction.tolist(),
                "force": float(push.force) if np.isfinite(push.force) else None,
                "lower": float(push.lower) if np.isfinite(push.lower) else None,
                "limit": _limit(program, push.limit),
            }
            for push in margin.pushes
        ],
        "uncertainty": _uncertainty(program, margin.uncertainty),
        "helps": [
            {
                "of": one.of,
                "what": one.what,
                "parts": list(one.parts),
                "gain": float(one.gain) if np.isfinite(one.gain) else None,
                "sentence": one.sentence,
            }
            for one in margin.helps
        ],
        "warnings": list(margin.warnings),
        "seconds": margin.seconds,
    }


def _interval(factor: tuple[Limit | None, Limit | None]) -> list[float | None] | None:
    least, greatest = factor
    if least is None or greatest is None:
        return None
    ends = (-least.value, greatest.value)
    return [float(end) + 0.0 if np.isfinite(end) else None for end in ends]


def _uncertainty(program: Program, worst: Uncertainty | None) -> dict[str, Any] | None:
    """The worst case over intervals, and where it is."""
    if worst is None:
        return None
    ranges = worst.ranges
    ends = worst.load_factor
    at = None
    if worst.worst is not None:
        mass, shift = worst.worst
        at = {
            name: {"mass_factor": float(mass[k]), "shift": (shift[k] + 0.0).tolist()}
            for k, name in enumerate(program.names)
            if program.free[k]
        }
    return {
        "mass": list(ranges.mass),
        "com": ranges.center,
        "mu": list(ranges.mu),
        "normal_deg": ranges.normal_deg,
        "kind": worst.kind,
        "held": worst.held,
        "tilt_deg": worst.tilt_deg,
        "load_factor": None
        if ends is None
        else [float(end) + 0.0 if np.isfinite(end) else None for end in ends],
        "corners": worst.corners,
        "worst": at,
    }


def _bracket(margin: Margin) -> dict[str, list[float | None] | None] | None:
    """Where the limits with sliding that does not dilate lie; null where it was not asked."""
    if margin.guaranteed is None or margin.load_factor is None:
        return None
    sure, most = _interval(margin.guaranteed), _interval(margin.load_factor)
    if most is None:
        return {"least": None, "greatest": None}
    inner = sure if sure is not None else [None, None]
    return {"least": [most[0], inner[0]], "greatest": [inner[1], most[1]]}


def _limit(program: Program, limit: Limit | None) -> dict[str, Any] | None:
    """Evidence at a limit: how well forces balance, the mechanism, and what lies between."""
    if limit is None:
        return None
    return {
        "residual": limit.forces.residual,
        "gap": float(limit.gap) if np.isfinite(limit.gap) else None,
        "moves": starting(program, limit.mechanism),
        "mechanism": None
        if limit.mechanism is None
        else {
            name: (limit.mechanism.motion[k] + 0.0).tolist()
            for k, name in enumerate(program.names)
            if program.free[k]
        },
    }


def starting(program: Program, mechanism: MotionProof | None) -> list[str]:
    """Names of the parts that move in a mechanism."""
    if mechanism is None:
        return []
    motion = mechanism.motion
    size = np.linalg.norm(motion[:, :3], axis=1) + program.radius * np.linalg.norm(
        motion[:, 3:], axis=1
    )
    fast = size > MOVES * float(size.max(initial=0.0))
    return [n for n, moves in zip(program.names, fast & program.free, strict=True) if moves]
