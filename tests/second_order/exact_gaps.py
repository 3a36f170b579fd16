"""Gaps of pairs of simple bodies at any pose, in closed form, independent of second order."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from kilter.arrays import Array

Surface = Callable[[Array], tuple[float, Array]]
"""Value and gradient of a function that is negative inside a body."""


def unit(v: Sequence[float] | Array) -> Array:
    """The unit vector along v."""
    return np.asarray(v, dtype=float) / np.linalg.norm(v)


@dataclass(frozen=True)
class Pose:
    """A part that has moved: x -> center + shift + turn (x - center)."""

    center: Array
    shift: Array
    turn: Array

    def at(self, x: Array) -> Array:
        """A point of the part after the motion."""
        return self.center + self.shift + self.turn @ (x - self.center)

    def along(self, d: Array) -> Array:
        """A direction of the part after the motion."""
        return self.turn @ d

    def back(self, x: Array) -> Array:
        """The point of the part that the motion takes to x."""
        return self.center + self.turn.T @ (x - self.center - self.shift)


def pose(center: Array, motion: Array) -> Pose:
    """The pose of a part after the motion (r, theta), shape (6,)."""
    return Pose(center, motion[:3], Rotation.from_rotvec(motion[3:]).as_matrix())


Gap = Callable[[Pose, Pose], float]
"""The gap as a function of the poses of a and b."""


def swapped(gap: Gap) -> Gap:
    """The gap with parts a and b exchanged."""
    return lambda a, b: gap(b, a)


def vertex_plane(v: Array, x: Array, n: Array) -> Gap:
    """A vertex v of b over the plane through x of a with outward normal n."""
    return lambda a, b: float((b.at(v) - a.at(x)) @ a.along(n))


def lines(xa: Array, ea: Array, xb: Array, eb: Array, n: Array, radii: float = 0.0) -> Gap:
    """Two lines as edges or as axes of cylinders whose radii add to `radii`."""

    def gap(a: Pose, b: Pose) -> float:
        m = unit(np.cross(a.along(ea), b.along(eb)))
        m = m * np.sign(m @ n)
        return float((b.at(xb) - a.at(xa)) @ m) - radii

    return gap


def sphere_plane(c: Array, r: float, x: Array, n: Array) -> Gap:
    """A sphere of b over a plane of a."""
    return lambda a, b: float((b.at(c) - a.at(x)) @ a.along(n)) - r


def spheres(ca: Array, ra: float, cb: Array, rb: float) -> Gap:
    """Two spheres; ra < 0: that of b within the hollow of a."""
    side = np.sign(ra)
    return lambda a, b: float(side * np.linalg.norm(b.at(cb) - a.at(ca)) - ra - rb)


def _polar(a: Pose, x: Array, d: Array, p: Array) -> tuple[float, float]:
    """Distance of p from the axis of a through x along d, and height along it."""
    q, axis = p - a.at(x), a.along(d)
    height = float(q @ axis)
    return float(np.linalg.norm(q - height * axis)), height


def sphere_cylinder(c: Array, r: float, x: Array, d: Array, radius: float) -> Gap:
    """A sphere of b at a cylinder of a; radius < 0: within."""

    def gap(a: Pose, b: Pose) -> float:
        rho, _ = _polar(a, x, d, b.at(c))
        return (rho - radius if radius > 0 else -radius - rho) - r

    return gap


def sphere_cone(
    c: Array, r: float, apex: Array, d: Array, half: float, *, inside: bool = False
) -> Gap:
    """A sphere of b at a cone of a."""

    def gap(a: Pose, b: Pose) -> float:
        rho, t = _polar(a, apex, d, b.at(c))
        off = rho * np.cos(half) - t * np.sin(half)
        return float(-off if inside else off) - r

    return gap


def sphere_torus(c: Array, r: float, x: Array, d: Array, ring: float, tube: float) -> Gap:
    """A sphere of b at the outside of a torus of a."""

    def gap(a: Pose, b: Pose) -> float:
        rho, t = _polar(a, x, d, b.at(c))
        return float(np.hypot(rho - ring, t)) - tube - r

    return gap


def line_sphere(x: Array, e: Array, c: Array, radius: float) -> Gap:
    """An edge of b at a sphere of a."""
    return lambda a, b: _polar(b, x, e, a.at(c))[0] - radius


def rim_plane(c: Array, d: Array, r: float, x: Array, n: Array) -> Gap:
    """A circle of b, of centre c across d, over a plane of a."""

    def gap(a: Pose, b: Pose) -> float:
        up, axis = a.along(n), b.along(d)
        return float((b.at(c) - a.at(x)) @ up - r * np.linalg.norm(up - (up @ axis) * axis))

    return gap


def ellipsoid_plane(c: Array, axes: Array, x: Array, n: Array) -> Gap:
    """An ellipsoid of b, half axes along the world's, over a plane of a."""

    def gap(a: Pose, b: Pose) -> float:
        up = a.along(n)
        return float((b.at(c) - a.at(x)) @ up - np.linalg.norm(axes * (b.turn.T @ up)))

    return gap


def implicit(fa: Surface, fb: Surface, x: Array) -> Gap:
    """Two surfaces that touch at x, by Newton's method on the common normal."""

    def residual(y: Array, a: Pose, b: Pose) -> Array:
        p, reach, tilt = y[:3], y[3], y[4]
        value_a, slope = fa(a.back(p))
        out = unit(a.along(slope))
        value_b, slope = fb(b.back(p + reach * out))
        both = out + unit(b.along(slope))
        across = both - (both @ out) * out
        return np.array([value_a, value_b, *(across + tilt * out)])

    def gap(a: Pose, b: Pose) -> float:
        y = np.array([*a.at(x), 0.0, 0.0])
        for _ in range(30):
            r = residual(y, a, b)
            steps = 1e-6 * np.eye(5)
            slope = np.column_stack(
                [(residual(y + h, a, b) - residual(y - h, a, b)) / 2e-6 for h in steps]
            )
            change = np.linalg.solve(slope, -r)
            y = y + change
            if np.linalg.norm(change) < 1e-14:
                break
        return float(y[3])

    return gap
