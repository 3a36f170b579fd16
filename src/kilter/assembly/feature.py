"""Feature: the face, edge or vertex of a part at a given contact, with its curvature."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np

from kilter.arrays import TINY, Array
from kilter.assembly.assembly_tolerances import ACROSS
from kilter.errors import InputError, nearest_name
from kilter.rigid import in_brackets, unit
from kilter.validate import finite
from kilter.values.value import Value

FeatureKind = Literal["face", "edge", "vertex"]
KINDS: tuple[FeatureKind, ...] = get_args(FeatureKind)


@dataclass(frozen=True, slots=True, eq=False)
class Feature(Value):
    """Curvature of a part's face, edge or vertex at a given contact, for the second-order test.

    Parameters
    ----------
    kind : {"face", "edge", "vertex"}
        Kind of the feature; a circular rim is an edge.
    along : array_like, shape (3,), optional
        Tangent of an edge; or a principal direction of a face, if its two curvatures differ.
        World frame, of any length, across the normal of the contact.
    curvature : float or pair of float
        Curvature, positive if the part is convex [1/length unit]. For a face: along `along` and
        across it, or a single number for all directions, as for a sphere of radius 1 / curvature.
        For an edge: in the plane of its tangent and the normal. A rim of radius r whose plane
        makes the angle beta with the normal has cos(beta) / r.
    point, axis : array_like, shape (3,), optional
        Axis of revolution of the face or rim: a point on it [length unit] and its direction, of
        any length, world frame. The axis determines the surface away from the point, so that a
        free rotation can be found. The curvatures alone determine a plane, a sphere and a
        cylinder, but not a cone or a torus.

    Raises
    ------
    InputError
        If the kind is unknown, a direction is missing, a number is not finite, or only one of
        `point` and `axis` is given.

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
            raise InputError(f"a feature has the kind {self.kind!r:.40}", hint=hint)
        given: Any = self.curvature
        twice = given if np.ndim(given) else (given, given if self.kind == "face" else 0.0)
        curvature = finite(twice, (2,), f"curvature of a {self.kind}")
        object.__setattr__(self, "curvature", curvature)
        if self.along is not None:
            object.__setattr__(self, "along", unit(self.along, f"direction of a {self.kind}"))
        directed = self.kind == "edge" or (self.kind == "face" and curvature[0] != curvature[1])
        if directed and self.along is None:
            raise InputError(
                f"the direction of the feature {self.kind!r} is missing", hint='give "along"'
            )
        if self.kind == "edge" and curvature[1]:
            raise InputError(
                "two curvatures are given for an edge", hint="give only that along the edge"
            )
        if self.kind == "vertex" and (curvature.any() or self.along is not None):
            raise InputError("a vertex cannot have a curvature or a direction", hint="remove it")
        self._set_axis()

    def _set_axis(self) -> None:
        """Check the axis of revolution of the feature, and store it as an array."""
        if (self.point is None) != (self.axis is None):
            raise InputError(
                f"the feature {self.kind!r} has only one of point and axis",
                hint='give both "point" and "axis", or neither',
            )
        if self.axis is None:
            return
        if self.kind == "vertex":
            raise InputError("a vertex cannot have an axis of revolution", hint="remove it")
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
        """Curvature tensor of the feature in the plane across a unit normal, shape (3, 3)."""
        flat = np.eye(3) - np.outer(normal, normal)
        if self.along is None:
            return np.asarray(self.curvature[0] * flat)
        along = unit(flat @ self.along)
        other = np.cross(normal, along)
        k, across = self.curvature
        return np.asarray(k * np.outer(along, along) + across * np.outer(other, other))

    def off_axis(self, points: Array, outward: Array) -> float:
        """How far the feature deviates from a surface of revolution about its axis [-].

        0: not at all.

        The normal of a surface of revolution meets its axis. A principal direction is tangent to
        the circle around the axis, with the curvature 1 / (distance to the axis along the normal).

        Parameters
        ----------
        points : ndarray, shape (n, 3)
            Contact points.
        outward : ndarray, shape (3,)
            Unit normal out of the part, the same at all points.

        Returns
        -------
        float
            Largest deviation of normal, principal direction and relative curvature; infinite if
            a point is on the axis.
        """
        arms = points - self.point
        arms = arms - np.outer(arms @ self.axis, self.axis)
        distance = np.linalg.norm(arms, axis=1)[:, None]
        most = float(np.abs(self.curvature).max())
        if (
            self.kind == "face" and (distance * most <= ACROSS).all()
        ):  # all points are poles, or the face is a plane
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
