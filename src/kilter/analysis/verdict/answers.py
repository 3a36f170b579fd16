"""Joints, open pairs and unsupported contacts, which several answers share."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kilter.analysis.decision.open_question import open_pairs_answer
from kilter.assembly import Assembly
from kilter.contact import ContactSet
from kilter.tell.record import Answer, InPython, UnitWord, Vector, key

if TYPE_CHECKING:
    from kilter.tell.answer_data.common_data import JointData, OpenPairData, UnsupportedData

__all__ = ["OfAssembly", "joints_answer", "unsupported_answer"]


class OfAssembly(Answer):
    """Base class of answers about an assembly and its contacts."""

    assembly: InPython[Assembly]
    """The assembly."""
    contacts: InPython[ContactSet]
    """Its contacts."""

    @property
    @key
    def units(self) -> UnitWord:
        """Unit of length."""
        return self.assembly.units

    @property
    @key
    def down(self) -> Vector:
        """Direction of gravity, unit."""
        return self.assembly.down

    @property
    @key
    def joints(self) -> list[JointData]:
        """Joints, with those that fastening added."""
        return self.assembly.joints_data()

    @property
    @key
    def open_pairs(self) -> list[OpenPairData]:
        """Pairs of parts whose contact the geometry does not determine."""
        return open_pairs_answer(self.assembly, self.contacts)


def joints_answer(assembly: Assembly) -> list[JointData]:
    """JSON data of the joints of an assembly, including those added by fastening."""
    return assembly.joints_data()


def unsupported_answer(assembly: Assembly, contacts: ContactSet) -> list[UnsupportedData]:
    """JSON data of the pairs of parts whose kind of contact is not modelled."""
    return [
        {"parts": [assembly.names[i] for i in u.ends], "kind": u.kind, "point": list(u.point)}
        for u in contacts.unsupported
    ]
