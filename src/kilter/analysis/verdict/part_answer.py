"""Answers about a single part: how it starts to move, and the forces of its contacts."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from kilter.arrays import Array
from kilter.tell.record import Lines, Record, Shape, Twist
from kilter.validate import frozen


class PartAnswer(Record):
    """The answer of `kilter.check` about a single part: ``verdict["upper"]``."""

    name: str
    """Name of the part."""
    grounded: bool
    """Whether the part is held."""
    mass: float
    """Mass [kg]."""
    material: str | None
    """Name of the material in the file."""
    layer: str | None
    """Name of the layer in the file."""
    displacement: Twist | None
    """Shift [length unit] and rotation [rad] of the displacement program; null if not computed."""
    acceleration: Twist | None
    """Linear [m/s^2] and angular [rad/s^2] acceleration, world frame; null if not known."""
    relative: Annotated[Array, Shape(2)] | None
    """Sizes of the linear, and of radius x angular, acceleration over that of gravity [-]."""
    moves: bool
    """Whether the part starts to move."""
    moved_by_proof: bool
    """Whether the motion of the proof moves the part."""
    motion: str
    """How the part starts to move, in words."""
    below: str | None = None
    """Part onto which the part falls straight down; null unless it falls freely onto a part."""
    fall: float | None = None
    """Length of this fall in the drawn pose [length unit]."""
    slow_motion: str | None
    """An acceleration below the threshold of `moves`, in words, if no part is above it."""

    def __repr__(self) -> str:
        return f"<PartAnswer: {self.name!r} {self.motion}>"


class PointForces(Record):
    """Contact forces on a part, from one or all other parts; arrays are read-only."""

    part: str
    """The part on which the forces act."""
    points: Lines
    """Contact points, world frame [length unit]."""
    forces: Lines
    """Force at each point, world frame [N]."""
    pressures: Array
    """Components of the forces along the normals [N]; negative for a pull of a bond."""

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
