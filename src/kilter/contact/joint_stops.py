"""Stops of joints: the limits at which a joint stands, within the tolerance of gaps.

The position of a joint is 0 in the drawn pose. A limit counts as reached if its distance from 0,
times the radius of the larger free part for a turn, is at most the tolerance of gaps of the smaller
one. A joint beyond a limit has no stop there: no admissible motion leads to this pose.
"""

from __future__ import annotations

from kilter.assembly import Assembly, Joint
from kilter.contact.gaps import Tolerance
from kilter.tell.numbers import rounded_up

__all__ = ["joints_beyond", "reached_limits"]


def reached_limits(assembly: Assembly, joint: Joint, tolerance: Tolerance) -> tuple[bool, bool]:
    """Whether a joint stands at its lower and at its upper limit."""
    if joint.limits is None:
        return False, False
    gap, arm = _gap_and_arm(assembly, joint, tolerance)
    low, high = (abs(limit) * arm <= gap for limit in joint.limits)
    return low, high


def joints_beyond(assembly: Assembly, tolerance: Tolerance) -> list[str]:
    """Notes about joints that are drawn beyond their limits, with the gap that would count."""
    notes = []
    for joint in assembly.joints:
        low, high = joint.limits or (0.0, 0.0)
        beyond = max(low, -high)
        gap, arm = _gap_and_arm(assembly, joint, tolerance)
        if beyond * arm > gap:
            unit = assembly.units if joint.kind == "prismatic" else "rad"
            notes.append(
                f"the {joint.kind} joint of {' and '.join(map(repr, joint.parts))} is drawn "
                f"{beyond:.3g} {unit} beyond its limits, so its stop is left out (--gap "
                f"{rounded_up(beyond * arm, 3)} counts it)"
            )
    return notes


def _gap_and_arm(assembly: Assembly, joint: Joint, tolerance: Tolerance) -> tuple[float, float]:
    """Tolerance of gaps of the smaller free part, and gap per unit of the position of a joint."""
    geometry, index = assembly.geometry, assembly.index
    ends = [index[name] for name in joint.parts if name in index]
    free = [k for k in ends if not geometry.grounded[k]] or ends
    arm = float(geometry.radius[free].max()) if joint.kind == "revolute" else 1.0
    return float(tolerance.gap_of(geometry.size[free]).min()), arm
