"""Assemblies: parts, held parts, interactions, and the geometry and mass properties of parts."""

from kilter.assembly.assembly import Assembly, require_assembly
from kilter.assembly.bonds import Bond, ListedBond
from kilter.assembly.feature import Feature
from kilter.assembly.interactions import FrictionPair, GivenContact, Joint, ListedJoint, Load
from kilter.assembly.part import GROUND, Part
from kilter.assembly.straps import Strap

__all__ = [
    "GROUND",
    "Assembly",
    "Bond",
    "Feature",
    "FrictionPair",
    "GivenContact",
    "Joint",
    "ListedBond",
    "ListedJoint",
    "Load",
    "Part",
    "Strap",
    "require_assembly",
]
