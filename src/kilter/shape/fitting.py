"""Fit cylinders, cones and spheres through points: first algebraically, then by least squares.

The normals n of facets that are inscribed in a surface determine its axis. For a cylinder they are
perpendicular to the axis. For a cone they make a constant angle with the axis, and the plane of
every facet contains the apex. Gauss-Newton steps on the distances of the points

    cylinder  |p - a (a.p)| - R,     cone  |p - a (a.p)| cos w - (a.p) sin w,   p = x - point

then refine the result until they no longer reduce the distances. For points on a surface the result
is exact to rounding.

References
----------
Distances and their derivatives: W. Gander, J. Hrebicek (eds.), Solving Problems in Scientific
Computing Using Maple and MATLAB, chapter "Fitting of circles, cylinders and cones"; sphere:
the linear system |x|^2 = 2 c.x + k.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from kilter.arrays import Array, across, ratio
from kilter.shape.shape_tolerances import (
    BEHIND_APEX,
    FIT_RANK,
    LARGEST_RATIO,
    NARROWEST_CONE,
    STEP_RANK,
    WIDEST_CONE,
)
from kilter.shape.solid import Surface

STEPS = 30
"""Largest number of Gauss-Newton steps."""


def fit_sphere(points: Array, normals: Array, weights: Array) -> Surface | None:
    """Fit a sphere to points with normals; None if they do not determine a sphere.

    Arguments: `points` (n, 3); `normals` (m, 3): unit normals of the facets; not used for a sphere;
    `weights` (m,): areas of the facets; not used for a sphere.

    Examples
    --------
    >>> corners = np.array([[1., 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1]])
    >>> round(fit_sphere(corners + 5, corners, np.ones(5)).radius, 12)
    1.0
    """
    middle = points.mean(axis=0)
    p = points - middle
    size = float(np.abs(p).max())
    if len(points) < 4 or size == 0.0:
        return None
    p = p / size
    matrix = np.column_stack([2 * p, np.ones(len(p))])
    solution, _, rank, _ = np.linalg.lstsq(matrix, (p * p).sum(axis=1), rcond=FIT_RANK)
    square = float(solution[3] + solution[:3] @ solution[:3])
    if rank < 4 or not 0 < square < LARGEST_RATIO**2:
        return None
    return Surface("sphere", middle + solution[:3] * size, radius=float(np.sqrt(square)) * size)


def fit_cylinder(points: Array, normals: Array, weights: Array) -> Surface | None:
    """Fit a cylinder to points with normals; None if they do not determine a cylinder.

    Arguments: `points` (n, 3); `normals` (m, 3): unit normals of the facets; `weights` (m,): areas
    of the facets.
    """
    _, vectors = np.linalg.eigh((normals * weights[:, None]).T @ normals)
    axis = vectors[:, 0]
    middle, size = _middle_and_size(points)
    if len(points) < 5 or size == 0.0:
        return None
    p = (points - middle) / size
    u, v = across(axis)
    matrix = np.column_stack([2 * p @ u, 2 * p @ v, np.ones(len(p))])
    flat = p - (p @ axis)[:, None] * axis
    solution, _, rank, _ = np.linalg.lstsq(matrix, (flat * flat).sum(axis=1), rcond=FIT_RANK)
    square = float(solution[2] + solution[:2] @ solution[:2])
    if rank < 3 or not 0 < square < LARGEST_RATIO**2:
        return None
    center, radius = solution[0] * u + solution[1] * v, float(np.sqrt(square))

    def residual(state: tuple[Array, Array, float]) -> tuple[Array, Array]:
        """Signed distances of the points from a cylinder, and their derivatives."""
        center, axis, radius = state
        u, v = across(axis)
        along, aside, e = _split(p - center, axis)
        eu, ev = e @ u, e @ v
        return aside - radius, np.column_stack([-eu, -ev, -eu * along, -ev * along, -1 + 0 * eu])

    def update(state: tuple[Array, Array, float], step: Array) -> tuple[Array, Array, float]:
        """The parameters of the cylinder after a step of the fit."""
        center, axis, radius = state
        u, v = across(axis)
        turned = axis + step[2] * u + step[3] * v
        shift = step[0] * u + step[1] * v
        return center + shift, turned / float(np.linalg.norm(turned)), radius + step[4]

    center, axis, radius = _gauss_newton((center, axis, radius), residual, update)
    if not 0 < radius < LARGEST_RATIO:
        return None
    center = center - (center @ axis) * axis
    return Surface("cylinder", middle + center * size, axis, radius=float(radius) * size)


def fit_cone(points: Array, normals: Array, weights: Array) -> Surface | None:
    """Fit a cone to points with normals; None if no cone has all points on the same side.

    The parameters are those of `fit_cylinder`.
    """
    middle, size = _middle_and_size(points)
    if len(points) < 6 or size == 0.0 or len(normals) < 3:
        return None
    p = (points - middle) / size
    mean = (normals * weights[:, None]).sum(axis=0) / weights.sum()
    spread = normals - mean
    _, vectors = np.linalg.eigh((spread * weights[:, None]).T @ spread)
    axis = vectors[:, 0]
    start = _cone_start(p, axis)
    if start is None:
        return None

    def residual(state: tuple[Array, Array, float]) -> tuple[Array, Array]:
        """Signed distances of the points from a cone, and their derivatives."""
        apex, axis, angle = state
        u, v = across(axis)
        along, aside, e = _split(p - apex, axis)
        cos, sin = np.cos(angle), np.sin(angle)
        eu, ev = e @ u, e @ v
        side = along * cos + aside * sin
        columns = [-eu * cos, -ev * cos, sin + 0 * eu, -eu * side, -ev * side, -side]
        return aside * cos - along * sin, np.column_stack(columns)

    def update(state: tuple[Array, Array, float], step: Array) -> tuple[Array, Array, float]:
        """The parameters of the cone after a step of the fit."""
        apex, axis, angle = state
        u, v = across(axis)
        turned = axis + step[3] * u + step[4] * v
        shift = step[0] * u + step[1] * v + step[2] * axis
        return apex + shift, turned / float(np.linalg.norm(turned)), angle + step[5]

    apex, axis, angle = _gauss_newton(start, residual, update)
    if not NARROWEST_CONE < angle < WIDEST_CONE or float(np.abs(apex).max()) > LARGEST_RATIO:
        return None
    if float(((p - apex) @ axis).min()) < -BEHIND_APEX:
        return None
    return Surface("cone", middle + apex * size, axis, half_angle=float(angle))


FITS: dict[str, Callable[[Array, Array, Array], Surface | None]] = {
    "cylinder": fit_cylinder,
    "cone": fit_cone,
    "sphere": fit_sphere,
}
"""Fit of each kind, in the order of trial: points on two parallel circles also lie on a sphere."""


def _middle_and_size(points: Array) -> tuple[Array, float]:
    """Mean of points, and their largest coordinate relative to the mean."""
    middle = points.mean(axis=0)
    return middle, float(np.abs(points - middle).max())


def _split(p: Array, axis: Array) -> tuple[Array, Array, Array]:
    """Height of points along an axis, distance from it, and unit direction away from it."""
    along = p @ axis
    away = p - along[:, None] * axis
    aside = np.linalg.norm(away, axis=1)
    return along, aside, ratio(away, aside[:, None])


def _cone_start(p: Array, axis: Array) -> tuple[Array, Array, float] | None:
    """First estimate of apex, axis and half angle of a cone, for a given axis; None if impossible.

    Points of a cone satisfy |across - c|^2 = (along - h)^2 tan^2 w. This equation is linear in c,
    the foot of the axis, and in auxiliary unknowns. Then |across - c| is linear in `along`. The
    result is None for a cylinder or plane.
    """
    u, v = across(axis)
    x, y, z = p @ u, p @ v, p @ axis
    matrix = np.column_stack([2 * x, 2 * y, z * z, z, np.ones(len(p))])
    solution, *_ = np.linalg.lstsq(matrix, x * x + y * y, rcond=FIT_RANK)
    aside = np.hypot(x - solution[0], y - solution[1])
    line = np.column_stack([z, np.ones(len(z))])
    (slope, offset), *_ = np.linalg.lstsq(line, aside, rcond=FIT_RANK)
    if abs(slope) < NARROWEST_CONE:
        return None
    apex = solution[0] * u + solution[1] * v - offset / slope * axis
    return apex, axis * np.sign(slope), float(np.arctan(abs(slope)))


def _gauss_newton(
    state: tuple[Array, Array, float],
    residual: Callable[[tuple[Array, Array, float]], tuple[Array, Array]],
    update: Callable[[tuple[Array, Array, float], Array], tuple[Array, Array, float]],
) -> tuple[Array, Array, float]:
    """Minimise a sum of squares by Gauss-Newton steps; steps that increase it are rejected.

    Each step solves the normal equations; the next step corrects their rounding. The iteration
    ends when a step no longer halves the sum of squares: at rounding, or if the points fit no
    surface of the kind.
    """
    off, jacobian = residual(state)
    best = float(off @ off)
    for _ in range(STEPS):
        step = np.linalg.lstsq(jacobian.T @ jacobian, -jacobian.T @ off, rcond=STEP_RANK)[0]
        trial = update(state, np.asarray(step, dtype=np.float64))
        off, jacobian = residual(trial)
        now = float(off @ off)
        if not now < best:
            break
        slow = now > 0.5 * best
        state, best = trial, now
        if slow:
            break
    return state
