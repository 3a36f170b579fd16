"""Mass, centre of mass and inertia of bodies that a file states in several pieces.

The sum of rigidly joined pieces i, with d_i = c_i - c, is

    m = sum m_i,   c = sum m_i c_i / m,   I = sum I_i + m_i (|d_i|^2 E - d_i d_i^T).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from kilter.arrays import Array
from kilter.assembly.geometry import build_geometry
from kilter.assembly.inertia import inertia_numbers
from kilter.assembly.part import Part
from kilter.rigid import Pose

__all__ = ["MassProperties"]


@dataclass(frozen=True, slots=True, eq=False)
class MassProperties:
    """Mass [kg], centre [length unit], and inertia about it [kg x length unit^2], in one frame."""

    mass: float
    center: Array
    """Shape (3,)."""
    inertia: Array
    """Shape (3, 3)."""

    @classmethod
    def of_part(cls, part: Part) -> Self:
        """The mass properties of a part, world frame; those of its shape if none are given."""
        geometry = build_geometry([part], part.units)
        return cls(float(geometry.mass[0]), geometry.center[0], geometry.inertia[0])

    @classmethod
    def sum(cls, pieces: Sequence[MassProperties]) -> Self:
        """The mass properties of rigidly joined pieces, in their common frame.

        Examples
        --------
        >>> ends = [MassProperties(1.0, np.array([x, 0, 0]), np.zeros((3, 3))) for x in (-1, 1)]
        >>> MassProperties.sum(ends).inertia.diagonal().tolist()
        [0.0, 2.0, 2.0]
        """
        mass = np.array([piece.mass for piece in pieces])
        centers = np.array([piece.center for piece in pieces])
        center = mass @ centers / mass.sum()
        inertia = sum((piece.inertia for piece in pieces), _steiner(mass, centers - center))
        return cls(float(mass.sum()), center, inertia)

    def about(self, center: Array) -> MassProperties:
        """The same mass with its moments about another point, which becomes the centre of mass."""
        return MassProperties(
            self.mass, center, self.inertia + _steiner(np.array([self.mass]), center - self.center)
        )

    def outside(self, pose: Pose) -> MassProperties:
        """The same body in the frame outside of `pose`, whose inner frame it is given in."""
        turn = pose.matrix
        return MassProperties(self.mass, pose.apply([self.center])[0], turn @ self.inertia @ turn.T)

    def fields(self, pose: Pose) -> dict[str, Any]:
        """Mass, centre of mass and inertia as fields of a part with this pose."""
        own = self.outside(pose.inverse())
        return {
            "mass": own.mass,
            "center_of_mass": own.center,
            "inertia": inertia_numbers((own.inertia + own.inertia.T) / 2),
        }


def _steiner(mass: Array, arms: Array) -> Array:
    """Inertia of point masses at `arms` about the origin, shape (3, 3)."""
    second = np.einsum("n,ni,nj->ij", mass, np.atleast_2d(arms), np.atleast_2d(arms))
    inertia: Array = np.trace(second) * np.eye(3) - second
    return inertia
