"""Units, joints and open pairs, which several answers share."""

from __future__ import annotations

from kilter.analysis.decision.open_question import AnsweredPair, answered_pairs
from kilter.assembly import ListedJoint
from kilter.assembly.supported_answer import SupportedAnswer
from kilter.contact import ContactSet
from kilter.tell.record import InPython, UnitWord, Vector, key


class OfAssembly(SupportedAnswer):
    """Base class of answers about an assembly and its contacts."""

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
    def joints(self) -> tuple[ListedJoint, ...]:
        """Joints, with those that fastening added."""
        return self.assembly.joints_data()

    @property
    @key
    def open_pairs(self) -> tuple[AnsweredPair, ...]:
        """Pairs of parts whose contact the geometry does not determine."""
        return answered_pairs(self.assembly, self.contacts)
