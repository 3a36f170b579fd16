"""What touches of a part at a given contact: a face, an edge or a vertex, and how it curves."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np

from kilter.arrays import Array
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

    Raises
    ------
    InputError
        If the kind is unknown, a direction is missing or a number is not finite.

    Examples
    --------
    >>> Feature("face", [0, 1, 0], (0, 2.0))  # a cylinder of radius 1/2 along y
    Feature('face', along=(0, 1, 0), curvature=(0, 2))
    """

    kind: FeatureKind
    along: Any = None
    curvature: Any = 0.0

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

    def __repr__(self) -> str:
        along = "" if self.along is None else f", along={in_brackets(self.along)}"
        bent = f", curvature={in_brackets(self.curvature)}" if self.curvature.any() else ""
        return f"Feature({self.kind!r}{along}{bent})"

    def tensor(self, normal: Array) -> Array:
        """The curvature as a symmetric tensor across a unit normal, shape (3, 3)."""
        flat = np.eye(3) - np.outer(normal, normal)
        if self.along is None:
            return np.asarray(self.curvature[0] * flat)
        along = unit(flat @ self.along)
        other = np.cross(normal, along)
        k, across = self.curvature
        return np.asarray(k * np.outer(along, along) + across * np.outer(other, other))
