"""Polyhedral cones in R^3: kind, lines, rays, equations, facets, axis, and membership test.

    C = {g : e.g = 0 for the equations e,  q.g >= 0 for the facets q}
      = lines + {sums of rays, not negative}

The facets are unit inward normals within the span of C, the rays unit and orthogonal to the
lines. The rank of the facets is the dimension less the number of lines, and these two
numbers name the kind.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from kilter.analysis.analysis_tolerances import NO_LENGTH
from kilter.arrays import Array, Mask
from kilter.validate import frozen

KINDS = {
    (0, 0): "none",
    (1, 0): "ray",
    (1, 1): "line",
    (2, 0): "fan",
    (2, 1): "half-plane",
    (2, 2): "plane",
    (3, 0): "cone",
    (3, 1): "wedge",
    (3, 2): "half-space",
    (3, 3): "all",
}
"""Kinds by dimension and number of lines."""


ROUGHEST = 0.5
"""Normals with singular values below this count as dependent; independent ones have 1 and more [-].
"""


@dataclass(frozen=True, slots=True, eq=False)
class Cone:
    """A polyhedral cone of directions, world frame; every vector has length 1.

    Attributes
    ----------
    lines : ndarray, shape (l, 3)
        Orthonormal basis of the directions both of whose signs are in it.
    rays : ndarray, shape (r, 3)
        Extreme rays, orthogonal to the lines.
    equations : ndarray, shape (3 - dimension, 3)
        Orthonormal normals of the span.
    facets : ndarray, shape (f, 3)
        Inward normals within the span.
    blur : float
        Directions closer to the boundary than this count as on it [rad].
    strict : bool
        A direction within `blur` of the boundary counts as outside, if the cone fills space.

    Examples
    --------
    >>> quarter = make_cone([[0, 1, 0]], [[1, 0, 0], [0, 0, 1]], [[1, 0, 0], [0, 0, 1]], 1e-8)
    >>> quarter.kind, quarter.half_angle_deg
    ('fan', 45.0)
    >>> quarter.contains([[2, 0, 1], [1, 1, 0], [-1, 0, 1]])
    array([ True, False, False])
    """

    lines: Array
    rays: Array
    equations: Array
    facets: Array
    blur: float
    strict: bool = False

    @property
    def dimension(self) -> int:
        """Dimension of the span of the cone, 0 to 3."""
        return 3 - len(self.equations)

    @property
    def kind(self) -> str:
        """Kind of the cone, a word of `KINDS` such as "fan" or "wedge"."""
        return KINDS[self.dimension, len(self.lines)]

    @property
    def center(self) -> Array | None:
        """Axis of the widest circular cone within this cone, unit, shape (3,); None without one."""
        if not len(self.facets):
            return None
        return self.rays[0] if len(self.rays) == 1 else widest_axis(self.facets)

    @property
    def half_angle_deg(self) -> float | None:
        """Half angle of the widest circular cone within this cone [deg]; None without one."""
        fixed = {"none": None, "ray": 0.0, "line": 0.0, "plane": 180.0, "all": 180.0}
        if self.kind in fixed:
            return fixed[self.kind]
        center = self.center
        assert center is not None
        nearest = self.facets[(self.facets @ center).argmin()]
        sine = float(nearest @ center)
        angle = float(np.arcsin(sine))
        if sine >= 0.7:  # the sine is flat near a right angle
            angle = np.pi / 2 - 2 * float(np.arcsin(np.linalg.norm(nearest - center) / 2))
        return round(float(np.degrees(max(angle - self.inwards, 0.0))), 12)

    @property
    def inwards(self) -> float:
        """Angle from every facet within which a direction does not yet count as inside [rad]."""
        return self.blur if self.strict and self.dimension == 3 else 0.0

    def candidates(self, down: Array) -> Iterator[Array]:
        """Yield directions in the cone: its axis, or without an axis those nearest to `down`."""
        if self.center is not None:
            yield self.center
        elif len(self.lines):  # a line, a plane, all: as near to gravity as it goes
            along = self.lines.T @ (self.lines @ down)
            # rounding of an exact zero must not become a direction
            length = float(np.linalg.norm(along))
            on_lines = along / length if length > NO_LENGTH else self.lines[0]
            yield down if self.kind == "all" else on_lines
            yield from self.lines
        yield from self.rays

    def contains(self, directions: ArrayLike, margin: float = 0.0) -> Mask:
        """Whether given directions are in the cone, at least `margin` from its facets.

        Parameters
        ----------
        directions : array_like, shape (..., 3)
            Directions of any length; zero is in no cone but the whole space.
        margin : float
            How far inside the facets they must be, within the span [rad]; the span itself
            is always blurred by `blur`.

        Returns
        -------
        ndarray of bool, shape (...)
        """
        given = np.asarray(directions, dtype=np.float64)
        length = np.linalg.norm(given, axis=-1)
        unit = given / np.where(length > 0, length, 1.0)[..., None]
        flat = (np.abs(unit @ self.equations.T) <= self.blur).all(axis=-1)
        blur = self.inwards or (-self.blur if margin <= 0 else 0.0)
        least = np.sin(margin) + blur
        inside: Mask = flat & (unit @ self.facets.T >= least).all(axis=-1)
        stable: Mask = inside & (length > 0) & (self.dimension > 0)
        return stable

    def depth(self, direction: Array) -> float:
        """Least angle from a unit direction in the cone to a facet [rad]; 0 outside the cone."""
        sine = float((self.facets @ direction).min(initial=1.0))
        return max(float(np.arcsin(np.clip(sine, 0.0, 1.0))) - self.inwards, 0.0)


def make_cone(equations: ArrayLike, facets: ArrayLike, points: ArrayLike, blur: float) -> Cone:
    """Create a cone from its equations, its facets, and points that include its extreme rays.

    Arguments: `equations` (e, 3); `facets` (f, 3); `points` (n, 3); `blur` [rad].

    Examples
    --------
    >>> make_cone(np.empty((0, 3)), [[0, 0, 1]], [[0, 0, 1]], 1e-8).kind
    'half-space'
    """
    e, q = (np.asarray(rows, dtype=np.float64).reshape(-1, 3) for rows in (equations, facets))
    _, values, vectors = np.linalg.svd(np.vstack([e, q, np.zeros((3, 3))]))
    lines = vectors[values <= min(blur, ROUGHEST)]  # an equation stays one, however rough
    on_lines = lines.T @ lines
    q = _units(q - q @ on_lines)
    rays = _rays(e, q, lines, np.asarray(points, dtype=np.float64).reshape(-1, 3), blur)
    # no negative zeros: they would be read as a direction
    lines, rays, e, q = (frozen(rows + 0.0) for rows in (lines, rays, e, q))
    return Cone(lines, rays, e, q, blur)


def _units(rows: Array) -> Array:
    length = np.linalg.norm(rows, axis=1, keepdims=True)
    units: Array = rows / np.where(length > 0, length, 1.0)
    return units


def _rays(equations: Array, facets: Array, lines: Array, points: Array, blur: float) -> Array:
    """Extreme rays of a cone, orthogonal to its lines, from points that include them."""
    rank = 3 - len(equations) - len(lines)
    if rank <= 1:
        return facets[:rank]
    tight = np.abs(points @ facets.T) <= blur
    aside = points - points @ (lines.T @ lines)
    length = np.linalg.norm(aside, axis=1)
    if rank == 2:
        chosen = [np.where(tight[:, k], length, -1.0).argmax() for k in range(len(facets))]
        return _units(aside[chosen])
    extreme = _extreme(tight, facets, blur)
    return _sort_around_axis(points[extreme] if extreme.any() else points, facets)


def _extreme(tight: Mask, facets: Array, blur: float) -> Mask:
    """Mask of the extreme rays among points: those that lie on two facets in different planes."""
    extreme = np.zeros(len(tight), dtype=bool)
    for k, row in enumerate(tight):
        normals = facets[row]
        if len(normals) > 1:
            extreme[k] = bool((np.linalg.norm(np.cross(normals[0], normals), axis=1) > blur).any())
    return extreme


def _sort_around_axis(rays: Array, facets: Array) -> Array:
    """Sort rays by angle around the axis of the cone; the ray with the largest entries is first."""
    axis = widest_axis(facets)
    side = np.cross(axis, np.eye(3)[np.abs(axis).argmin()])
    angle = np.arctan2(rays @ np.cross(axis, side), rays @ side)
    ordered = rays[np.argsort(angle)]
    return np.roll(ordered, -int(np.lexsort(ordered.round(6).T)[-1]), axis=0)


def widest_axis(facets: ArrayLike) -> Array:
    """Axis of the widest circular cone within given facets: the unit u with the largest min q.u.

    The q are the facet normals.

    Arguments: `facets` (f, 3): unit inward normals, in an open half-space; at least one normal.

    Notes
    -----
    A problem of the type of linear programs: at most three facets determine the axis. The
    facet that it violates most joins them until none is violated.

    Examples
    --------
    >>> widest_axis([[1, 0, 0], [0, 1, 0], [0.6, 0.8, 0.0]]).round(6)
    array([0.707107, 0.707107, 0.      ])
    """
    q = np.asarray(facets, dtype=np.float64)
    basis = [0]
    axis: Array = q[0]
    for _ in range(3 * len(q) + 10):
        reach = q @ axis
        worst = int(reach.argmin())
        if worst in basis or reach[worst] >= reach[basis].min() - 1e-15:
            break
        basis, axis = _axis_of([*basis, worst], q)
    return axis


def _axis_of(candidates: list[int], q: Array) -> tuple[list[int], Array]:
    """Axis of the widest circular cone inside up to four facets, and the facets that it touches.

    A subset may have that axis without touching the cone: the subset of least reach is the basis.
    """
    best: tuple[float, list[int], Array] | None = None
    least = np.inf
    for size in (1, 2, 3):
        for chosen in itertools.combinations(candidates, size):
            axis = _equidistant(q[list(chosen)])
            if axis is None:
                continue
            reach = float((q[candidates] @ axis).min())
            own = float((q[list(chosen)] @ axis).min())
            wider = best is None or reach > best[0] + 1e-15
            if wider or (best and reach >= best[0] - 1e-15 and own < least - 1e-15):
                best, least = (reach, list(chosen), axis), own
    assert best is not None
    return best[1], best[2]


def _equidistant(q: Array) -> Array | None:
    """Unit vector with the same angle to each of up to three facet normals; None if degenerate."""
    if len(q) < 3:
        axis = q.sum(axis=0)
    else:
        axis = np.cross(q[1] - q[0], q[2] - q[0])
        axis = axis if axis @ q[0] > 0 else -axis
    length = float(np.linalg.norm(axis))
    return axis / length if length > 1e-14 else None
