"""Pieces of answers as JSON data that several of them share."""

from __future__ import annotations

from typing import Any

from kilter.assembly import Assembly
from kilter.contact import ContactSet

__all__ = ["joints_answer", "unsupported_answer"]


def joints_answer(assembly: Assembly) -> list[dict[str, Any]]:
    """Joints of an assembly, those that were fastened among them."""
    return assembly.joints_data()


def unsupported_answer(assembly: Assembly, contacts: ContactSet) -> list[dict[str, Any]]:
    """Pairs that touch in a way that is not modelled."""
    return [
        {"parts": [assembly.names[i] for i in u.parts], "kind": u.kind, "point": list(u.point)}
        for u in contacts.unsupported
    ]
