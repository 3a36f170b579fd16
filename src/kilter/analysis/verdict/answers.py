"""JSON data of joints and unsupported contacts, which several answers share."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kilter.assembly import Assembly
from kilter.contact import ContactSet

if TYPE_CHECKING:
    from kilter.tell.answer_data.common_data import JointData, UnsupportedData

__all__ = ["joints_answer", "unsupported_answer"]


def joints_answer(assembly: Assembly) -> list[JointData]:
    """JSON data of the joints of an assembly, including those added by fastening."""
    return assembly.joints_data()


def unsupported_answer(assembly: Assembly, contacts: ContactSet) -> list[UnsupportedData]:
    """JSON data of the pairs of parts whose kind of contact is not modelled."""
    return [
        {"parts": [assembly.names[i] for i in u.ends], "kind": u.kind, "point": list(u.point)}
        for u in contacts.unsupported
    ]
