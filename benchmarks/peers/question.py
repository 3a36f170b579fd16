"""Question: an assembly with its contacts and its program, the input of every tool."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

import kilter
from kilter.arrays import Array
from kilter.assembly import Assembly
from kilter.contact.contact_set import ContactSet
from kilter.mechanics.program import Program, build_program
from kilter.rigid import quaternion_to_matrix, rotation_between

__all__ = ["Question"]


@dataclass(frozen=True)
class Question:
    """An assembly to judge, with the contacts that kilter detects.

    Attributes
    ----------
    assembly : Assembly
        Assembly without joints and loads, with a single friction coefficient.
    """

    assembly: Assembly

    @cached_property
    def contacts(self) -> ContactSet:
        """Detected contact patches and points."""
        return kilter.contacts(self.assembly)

    @cached_property
    def program(self) -> Program:
        """Equilibrium of the free parts under contact forces."""
        return build_program(self.assembly, self.contacts)

    @cached_property
    def upright(self) -> Array:
        """Rotation matrix that turns gravity to -z, shape (3, 3)."""
        return quaternion_to_matrix(rotation_between(self.assembly.down, [0, 0, -1]))

    @cached_property
    def length(self) -> float:
        """Mean side of the free parts, the unit of length of the scaled scene [m]."""
        geometry = self.assembly.geometry
        return float(np.mean(geometry.size[~geometry.grounded])) / 3**0.5

    @cached_property
    def weight(self) -> float:
        """Mean mass of the free parts, the unit of mass of the scaled scene [kg]."""
        geometry = self.assembly.geometry
        return float(np.mean(geometry.mass[~geometry.grounded]))
