"""Answers about a single part: how it starts to move, and the forces of its contacts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from kilter.analysis.decision.motion import PartMotion
from kilter.arrays import Array
from kilter.validate import frozen

__all__ = ["PartAnswer", "PointForces"]


@dataclass(frozen=True, slots=True, eq=False)
class PartAnswer:
    """The answer of `kilter.check` about a single part: ``verdict["upper"]``.

    Attributes
    ----------
    name : str
    grounded : bool
        Whether the part is held.
    mass : float
        Mass [kg].
    moves : bool
        Whether the part starts to move.
    acceleration : ndarray, shape (6,), or None
        Linear [m/s^2] and angular [rad/s^2] acceleration, world frame; None if not known.
    displacement : ndarray, shape (6,), or None
        Shift [length unit] and rotation [rad] of the displacement program; None if not computed.
    motion : PartMotion
        The same as ``verdict.motion["upper"]``.
    words : str
        How the part starts to move, in words.
    """

    name: str
    grounded: bool
    mass: float
    moves: bool
    acceleration: Array | None
    displacement: Array | None
    motion: PartMotion
    words: str

    def __repr__(self) -> str:
        return f"<PartAnswer: {self.name!r} {self.words}>"


@dataclass(frozen=True, slots=True, eq=False)
class PointForces:
    """Contact forces on a part, from one or all other parts; arrays are read-only.

    Attributes
    ----------
    part : str
        The part on which the forces act.
    points : ndarray, shape (k, 3)
        Contact points, world frame [length unit].
    forces : ndarray, shape (k, 3)
        Force at each point, world frame [N].
    pressures : ndarray, shape (k,)
        Components of the forces along the normals [N]; negative for a pull of a bond.
    """

    part: str
    points: Array
    forces: Array
    pressures: Array

    def __len__(self) -> int:
        return len(self.points)

    @property
    def resultant(self) -> Array:
        """Sum of the contact forces, shape (3,) [N]."""
        return frozen(self.forces.sum(axis=0))

    @property
    def center(self) -> Array | None:
        """Centre of pressure of the contact forces, shape (3,) [length unit]; None without force.

        None if the contacts carry no normal force.
        """
        size = np.abs(self.pressures)
        if not size.any():
            return None
        return frozen(size @ self.points / size.sum())

    def moment(self, about: ArrayLike) -> Array:
        """Torque of the contact forces about a point, shape (3,), world frame [N x length unit]."""
        arms = self.points - frozen(about, (3,), "about")
        return frozen(np.cross(arms, self.forces).sum(axis=0))

    def __repr__(self) -> str:
        size = float(np.linalg.norm(self.resultant))
        return f"<PointForces: {size:.6g} N on {self.part!r} at {len(self)} points>"
