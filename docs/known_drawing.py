"""Common elements of the pictures of known answers: data of a scene, outlines, the ground."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
from line_drawing import View, arc
from numpy.typing import ArrayLike

from kilter.arrays import Array

sys.path.append(str(Path(__file__).resolve().parents[1] / "tests" / "scenes"))

from balance_cases import Case

BESIDE = 0.1
"""Distance below the limit at which a case is drawn [unit of its parameter]."""
THICK = 0.25
"""Thickness of drawn ground, relative to its half width [-]."""
SIZED = ("08", "R6")
"""Cases whose limit is a size of the body."""
X, Y, Z = np.eye(3)
RIGHT, UP = np.eye(2)
Seen = tuple[str, Array, Array]
"""Name of a view, with its directions to the right and up."""
FRONT, SIDE, TOP = ("front", X, Z), ("side", Y, Z), ("top", X, Y)


class Drawing:
    """The data of a case from its scene, and the views of its picture."""

    def __init__(self, case: Case) -> None:
        self.case = case
        self.assembly = case.build(0.0 if case.limit is None else case.limit - BESIDE)
        self.edge = None if case.limit is None else case.build(case.limit)
        self.views: list[View] = []

    def view(self, seen: Seen = FRONT) -> View:
        """Add a view beside the others."""
        name, right, up = seen
        self.views.append(View(right, up, name))
        return self.views[-1]

    def point(self, k: int) -> Array:
        """Position of the k-th contact, shape (3,) [m]."""
        return np.asarray(self.assembly.contacts[k].points[0])

    def normal(self, k: int) -> Array:
        """Unit normal of the k-th contact, away from its first part, shape (3,)."""
        return np.asarray(self.assembly.contacts[k].normal)

    def curvature(self, k: int, side: int, along: Array) -> float:
        """Normal curvature of a part of the k-th contact along a tangent [1/m]."""
        feature = self.assembly.contacts[k].feature[side]
        values = np.atleast_1d(feature.curvature)
        if feature.along is None:  # the same in every direction
            return float(values[0])
        first = np.asarray(feature.along)
        weights = np.array([along @ first, along @ np.cross(self.normal(k), first)]) ** 2
        return float(weights[: len(values)] @ values)

    def mass(self, name: str = "b") -> Array:
        """Centre of mass of a part, shape (3,)."""
        [part] = [part for part in self.assembly.parts if part.name == name]
        return np.asarray(part.pose.position)

    def marked(self, view: View, *names: str) -> None:
        """Mark centres of mass, and their positions at the limit."""
        for name in names or ("b",):
            view.center(view.flat(self.mass(name)))
            if self.edge is not None and self.case.number not in SIZED:
                [at] = [part.pose.position for part in self.edge.parts if part.name == name]
                if not np.allclose(at, self.mass(name)):
                    view.limit(view.flat(at))


def box(low: ArrayLike, high: ArrayLike) -> Array:
    """The corners of an upright rectangle."""
    (a, b), (c, d) = low, high  # type: ignore[misc]
    return np.array([[a, b], [c, b], [c, d], [a, d]])


def disc(center: ArrayLike, radius: float) -> Array:
    """A full circle."""
    return arc(center, radius, 0, 352.5)


def band(center: ArrayLike, inner: float, outer: float, start: float, end: float) -> Array:
    """The part of an annulus between two angles [degrees]."""
    return np.vstack([arc(center, inner, start, end), arc(center, outer, end, start)])


def annulus(center: ArrayLike, inner: float, outer: float) -> Array:
    """A ring: two circles."""
    return np.vstack([disc(center, inner), [[np.nan, np.nan]], disc(center, outer)])


def ground(
    at: ArrayLike, curvature: float, half: float, *, turn: float = 0.0, depth: float | None = None
) -> Array:
    """A piece of held ground with its surface through a point, `half` to each side."""
    if curvature > 0 and 1 / curvature <= 1.5 * half:
        return disc(np.asarray(at) - [0, 1 / curvature], 1 / curvature)
    reach = half if curvature == 0 else min(half, 0.92 / abs(curvature))
    x = np.linspace(-reach, reach, 2 if curvature == 0 else 25)
    z = -curvature * x**2 / (1 + np.sqrt(1 - (curvature * x) ** 2))
    low = min(z.min(), 0.0) - (THICK * half if depth is None else depth)
    points = np.column_stack([[*x, reach, -reach], [*z, low, low]])
    cos, sin = np.cos(turn), np.sin(turn)
    return np.asarray(at) + points @ [[cos, sin], [-sin, cos]]


def foot(at: Array, radius: float, half: float) -> Array:
    """The lower cap of a ball."""
    angle = np.degrees(np.arcsin(half / radius))
    return arc(at + radius * UP, radius, 270 - angle, 270 + angle)


def on_ground(
    drawing: Drawing, seen: Seen, way: str, half: float = 0.0
) -> tuple[View, float, float]:
    """The ground under the first contact, with the curvatures of ground and body in this view."""
    view = drawing.view(seen)
    below, above = (drawing.curvature(0, side, seen[1]) for side in (0, 1))
    across = drawing.curvature(0, 0, np.cross(drawing.normal(0), seen[1]))
    half = half or 1.6 / above
    at = np.array([view.flat(drawing.mass())[0], view.flat(drawing.point(0))[1]])
    if below == 0 and across < 0:  # along a trough
        rim = ground(at, across, half)[:, 1].max()
        view.held(box(at - [half, 0], [at[0] + half, rim]), behind=True)
    depth = 2 / across if below == 0 and across > 0 else None  # along a cylinder
    view.held(ground(at, below, half, depth=depth))
    if way:
        arm = 1 / below if below else None
        view.way(way, view.flat(drawing.mass()), None if arm is None else at - [0, arm])
    return view, below, above


def weeble(drawing: Drawing, view: View, middle: Array, radius: float) -> None:
    """A round body that comes back about its middle."""
    view.part(disc(middle, radius))
    view.turn("returns", middle, 1.17 * radius)
    drawing.marked(view)


Recipe = Callable[[Drawing], None]
RECIPES: dict[str, Recipe] = {}


def recipe(*numbers: str) -> Callable[[Recipe], Recipe]:
    """Decorator that registers a function as the recipe of cases."""

    def enter(draw: Recipe) -> Recipe:
        RECIPES.update(dict.fromkeys(numbers, draw))
        return draw

    return enter
