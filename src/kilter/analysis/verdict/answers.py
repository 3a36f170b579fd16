"""Assumed supports, units, joints and open pairs, which several answers share."""

from __future__ import annotations

from kilter.analysis.decision.open_question import AnsweredPair, answered_pairs
from kilter.assembly import Assembly, ListedJoint
from kilter.contact import ContactSet
from kilter.tell.record import Answer, InPython, UnitWord, Vector, key


class SupportedAnswer(Answer):
    """Base class of answers about an assembly that may have an assumed support."""

    assembly: InPython[Assembly]
    """The assembly."""

    @property
    @key
    def assumed(self) -> tuple[str, ...]:
        """Options that are assumed: "floor" or "ground" if the file holds no part, "units"."""
        return tuple(self.assembly.assumed)


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
