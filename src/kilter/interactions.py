"""What acts between parts, or on them: friction, loads, given contacts, joints."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from kilter.errors import InputError
from kilter.rigid import frozen, in_range, number, unit

__all__ = ["FrictionPair", "GivenContact", "Joint", "JointKind", "Load"]

JointKind = Literal["fixed", "revolute", "prismatic", "cylindrical", "spherical"]


@dataclass(frozen=True, slots=True, eq=False)
class FrictionPair:
    """Friction coefficient [-] of every contact between two parts."""

    parts: tuple[str, str]
    mu: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "parts", tuple(self.parts))
        object.__setattr__(self, "mu", number(self.mu, "friction coefficient", lowest=0))


@dataclass(frozen=True, slots=True, eq=False)
class Load:
    """A force [N] at a point and a torque [N x length unit] on a part, fixed in the world.

    Loads do not turn with the assembly. `point` is in the world frame; None means the
    part's centre of mass.
    """

    part: str
    force: Any = (0.0, 0.0, 0.0)
    torque: Any = (0.0, 0.0, 0.0)
    point: Any = None

    def __post_init__(self) -> None:
        for name in ("force", "torque", "point"):
            value = getattr(self, name)
            if value is None and name == "point":
                continue
            value = frozen(value, (3,))
            if not np.isfinite(value).all():
                raise InputError(
                    f"{name} of a load is {value.tolist()}",
                    part=self.part,
                    hint="give finite numbers",
                )
            in_range(value, f"{name} of a load")
            object.__setattr__(self, name, value)


@dataclass(frozen=True, slots=True, eq=False)
class GivenContact:
    """Contact points between two parts, used instead of detection for that pair.

    `points`, shape (n, 3), and `normal`, shape (3,), from the first part to the second,
    are in the world frame.
    """

    parts: tuple[str, str]
    points: Any
    normal: Any
    mu: float | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "parts", tuple(self.parts))
        points = frozen(self.points, (-1, 3)) if len(self.points) else np.empty((0, 3))
        if not len(points) or not np.isfinite(points).all():
            raise InputError(
                f"contact of {self.parts[0]!r} and {self.parts[1]!r} has no usable points",
                hint="give one point or more",
            )
        object.__setattr__(self, "points", points)
        object.__setattr__(self, "normal", unit(self.normal, "normal of a contact"))
        if self.mu is not None:
            object.__setattr__(self, "mu", number(self.mu, "friction coefficient", lowest=0))


@dataclass(frozen=True, slots=True, eq=False)
class Joint:
    """A two-sided connection of two parts, or of a part and the ground.

    `point` and `axis`, both shape (3,), are in the world frame.
    """

    parts: tuple[str, str]
    kind: JointKind = "fixed"
    point: Any = None
    axis: Any = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "parts", tuple(self.parts))
        if self.point is not None:
            object.__setattr__(self, "point", frozen(self.point, (3,)))
        if self.axis is not None:
            object.__setattr__(self, "axis", unit(self.axis, "axis of a joint"))
