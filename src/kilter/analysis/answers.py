"""Pieces of answers as JSON data that several of them share."""

from __future__ import annotations

from typing import Any

import numpy as np

from kilter.assembly import Assembly
from kilter.contact import ContactSet

__all__ = ["contacts_answer", "joints_answer", "unsupported_answer"]


def joints_answer(assembly: Assembly) -> list[dict[str, Any]]:
    """Joints of an assembly, those that were fastened among them."""
    return [{"parts": list(joint.parts), "kind": joint.kind} for joint in assembly.joints]


def unsupported_answer(assembly: Assembly, contacts: ContactSet) -> list[dict[str, Any]]:
    """Pairs that touch in a way that is not modelled."""
    return [
        {"parts": [assembly.names[i] for i in u.parts], "kind": u.kind, "point": list(u.point)}
        for u in contacts.unsupported
    ]


def contacts_answer(assembly: Assembly, contacts: ContactSet) -> dict[str, Any]:
    """The answer of `kilter contacts --json`."""
    names = assembly.names
    edges = [None if np.isinf(e) else float(e) for e in contacts.gap_edges]
    return {
        "units": assembly.units,
        "patches": [
            {
                "parts": [names[i] for i in contacts.patch_parts[k]],
                "kind": str(contacts.patch_kind[k]),
                "area": float(contacts.patch_area[k]),
                "gap": float(contacts.patch_gap[k, np.abs(contacts.patch_gap[k]).argmax()]),
                "gap_range": contacts.patch_gap[k].tolist(),
                "normal": contacts.patch_normal[k].tolist(),
                "mu": float(contacts.patch_mu[k]),
                "points": contacts.points[
                    contacts.patch_start[k] : contacts.patch_start[k + 1]
                ].tolist(),
            }
            for k in range(len(contacts))
        ],
        "unsupported": unsupported_answer(assembly, contacts),
        "rejected": [
            {
                "parts": [names[i] for i in r.parts],
                "gap": r.gap,
                "angle_deg": float(np.degrees(r.angle)),
                "why": r.why,
            }
            for r in contacts.rejected
        ],
        "overlaps": [
            {
                "parts": [names[i] for i in o.parts],
                "volume": o.volume,
                "depth": o.depth,
                "why": o.why,
            }
            for o in contacts.overlaps
        ],
        "joints": joints_answer(assembly),
        "histogram": {"edges": edges, "counts": contacts.gap_counts.tolist()},
        "tolerance": {
            "gap": contacts.gap,
            "angle_deg": float(np.degrees(contacts.tolerance.angle)),
            "clearance": contacts.tolerance.clearance,
        },
        "warnings": [*assembly.notes, *assembly.geometry.warnings, *contacts.warnings],
    }
