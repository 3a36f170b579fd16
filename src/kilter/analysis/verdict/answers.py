"""JSON data of joints and unsupported contacts, which several answers share."""

from __future__ import annotations

from typing import Any

from kilter.assembly import Assembly

__all__ = ["joints_answer"]


def joints_answer(assembly: Assembly) -> list[Any]:
    """JSON data of the joints of an assembly, including those added by fastening."""
    return [joint.to_dict() for joint in assembly.joints_data()]
