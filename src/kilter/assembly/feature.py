"""What touches of a part at a given contact: a face, an edge or a vertex, and how it curves."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np

from kilter.arrays import TINY, Array
from kilter.assembly.assembly_tolerances import ACROSS
from kilter.errors import InputError, nearest_name
from kilter.rigid import in_brackets, unit
from kilter.validate import finite

__all__ = ["Feature", "FeatureKind"]

FeatureKind = Literal["face", "edge", "vertex"]
KINDS: tuple[FeatureKind, ...] = get_args(FeatureKind)


@dataclass(frozen=True, slots=True, eq=False)
class Feature:
    """What touches of one part at the points of a `GivenContact`; it decides at second order.

    Parameters
    ----------
    kind : {"face", "edge", "vertex"}
        A rim is an edge.
    along : array_like, shape (3,), optional
        Tangent of the edge; of a face, one of its principal directions, where its two
        curvatures differ. World frame, of any length, across the normal of the contact.
    curvature : float or pair of float
        [1/length unit], positive where the part is convex. Of a face along `along` and across
        it (one number: the same in every direction, as a sphere of radius 1 / curvature); of an
        edge in the plane of its tangent and the normal: a rim of radius r whose plane leans
        from the normal by beta has cos(beta) / r.
    point, axis : array_like, shape (3,), optional
        A line that the face is a surface of revolution about, or the rim a circle: a point on
        it [length unit] and its direction, of any length, world frame. It tells how the
        surface goes on, so that a part may be seen to turn freely: a cone or a torus is not
        known by its curvatures, as a plane, a sphere and a cylinder are.

    Raises
    ------
    InputError
        If the kind is unknown, a direction is missing, a number is not finite, or one of `point`
        and `axis` is given without the other.

    Examples
    --------
    >>> Feature("face", [0, 1, 0], (0, 2.0))  # a cylinder of radius 1/2 along y
    Feature('face', along=(0, 1, 0), curvature=(0, 2))
    >>> Feature("edge", [1, 0, 0], 2.0, point=[0, 0, 0.5], axis=[0, 1, 0])  # the rim of a coin
    Feature('edge', along=(1, 0, 0), curvature=(2, 0), point=(0, 0, 0.5), axis=(0, 1, 0))
    """

    kind: FeatureKind
    along: Any = None
    curvature: Any = 0.0
    point: Any = None
    axis: Any = None

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            near = nearest_name(str(self.kind), KINDS)
            hint = f"did you mean {near!r}?" if near else f"give one of {', '.join(KINDS)}"
            raise InputError(f"a feature is {self.kind!r:.40}", hint=hint)
        given: Any = self.curvature
        twice = given if np.ndim(given) else (given, given if self.kind == "face" else 0.0)
        curvature = finite(twice, (2,), f"curvature of a {self.kind}")
        object.__setattr__(self, "curvature", curvature)
        if self.along is not None:
            object.__setattr__(self, "along", unit(self.along, f"direction of a {self.kind}"))
        directed = self.kind == "edge" or (self.kind == "face" and curvature[0] != curvature[1])
        if directed and self.along is None:
            raise InputError(f"a feature, {self.kind}, has no direction", hint='give "along"')
        if self.kind == "edge" and curvature[1]:
            raise InputError("an edge has two curvatures", hint="give one, along it")
        if self.kind == "vertex" and (curvature.any() or self.along is not None):
            raise InputError("a vertex has a curvature or a direction", hint="leave it out")
        self._set_axis()

    def _set_axis(self) -> None:
        """The line that it is of revolution about."""
        if (self.point is None) != (self.axis is None):
            raise InputError(
                f"a feature, {self.kind}, is of revolution about half a line",
                hint='give both "point" and "axis", or neither',
            )
        if self.axis is None:
            return
        if self.kind == "vertex":
            raise InputError("a vertex is of revolution about a line", hint="leave it out")
        object.__setattr__(self, "point", finite(self.point, (3,), f"point of a {self.kind}"))
        object.__setattr__(self, "axis", unit(self.axis, f"axis of a {self.kind}"))

    def __repr__(self) -> str:
        along = "" if self.along is None else f", along={in_brackets(self.along)}"
        bent = f", curvature={in_brackets(self.curvature)}" if self.curvature.any() else ""
        line = "" if self.axis is None else (
            f", point={in_brackets(self.point)}, axis={in_brackets(self.axis)}"
        )  # fmt: skip
        return f"Feature({self.kind!r}{along}{bent}{line})"

    def tensor(self, normal: Array) -> Array:
        """The curvature as a symmetric tensor across a unit normal, shape (3, 3)."""
        flat = np.eye(3) - np.outer(normal, normal)
        if self.along is None:
            return np.asarray(self.curvature[0] * flat)
        along = unit(flat @ self.along)
        other = np.cross(normal, along)
        k, across = self.curvature
        return np.asarray(k * np.outer(along, along) + across * np.outer(other, other))

    def off_axis(self, points: Array, outward: Array) -> float:
        """How far a surface or rim about `axis` misses what this is at some points [-].

        The normal of a surface of revolution meets its axis; around it goes one of its principal
        directions, with a curvature of 1 / (distance to the axis along the normal).

        Parameters
        ----------
        points : ndarray, shape (n, 3)
        outward : ndarray, shape (3,)
            Unit normal at all of them, out of the part.
        """
        arms = points - self.point
        arms = arms - np.outer(arms @ self.axis, self.axis)
        distance = np.linalg.norm(arms, axis=1)[:, None]
        most = float(np.abs(self.curvature).max())
        if self.kind == "face" and (distance * most <= ACROSS).all():  # a pole, or a plane
            uneven = abs(float(self.curvature[0] - self.curvature[1])) / max(most, TINY)
            return max(float(np.linalg.norm(np.cross(self.axis, outward))), uneven)
        if not distance.all():
            return np.inf
        around = np.cross(self.axis, arms / distance)
        bent = around @ self.tensor(outward) * distance
        misses = [
            np.abs(around @ outward),
            np.abs(bent - around * (arms @ outward)[:, None] / distance).max(axis=1),
        ]
        if self.kind == "edge":
            misses.append(np.linalg.norm(np.cross(around, self.along), axis=1))
        return float(np.max(misses, initial=0.0))
