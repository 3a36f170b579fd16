"""Pictures of known answers: a body on one contact, or on one line."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from known_drawing import (
    FRONT,
    RECIPES,
    SIDE,
    Drawing,
    X,
    Y,
    annulus,
    box,
    disc,
    ground,
    on_ground,
    recipe,
    weeble,
)
from line_drawing import arc


def ball(told: Drawing, ways: Sequence[str], half: float = 0.0) -> None:
    """A ball on what its first contact says, from the front and, of two ways, from the side."""
    for seen, way in zip((FRONT, SIDE), ways, strict=False):
        view, _, above = on_ground(told, seen, way, half)
        view.part(disc(view.flat(told.mass()), 1 / above))
        told.marked(view)


BALLS = {
    "01": ["free"], "02": ["falls"], "03": ["returns"], "04": ["returns", "returns"],
    "29": ["falls", "free"], "30": ["returns", "free"], "R4": ["falls"], "R5": ["returns"],
}  # fmt: skip
for _number, _ways in BALLS.items():
    RECIPES[_number] = lambda told, ways=_ways: ball(told, ways)


@recipe("08")
def _ellipsoid(told: Drawing) -> None:
    height = told.mass()[2]
    for seen in (FRONT, SIDE):
        view, _, above = on_ground(told, seen, "free", half=1.5)
        axes = [np.sqrt(height / above), height]
        view.part(view.flat(told.mass()) + disc([0, 0], 1) * axes)
        view.turn("returns", view.flat(told.mass()), 1.2 * height)
        told.marked(view)


@recipe("09")
def _weeble(told: Drawing) -> None:
    view, _, above = on_ground(told, FRONT, "free", half=1.5)
    weeble(told, view, np.array([0, 1 / above]), 1 / above)


@recipe("10")
def _half_cylinder(told: Drawing) -> None:
    view, _, above = on_ground(told, FRONT, "free", half=1.5)
    radius = 1 / above
    view.part(arc([0, radius], radius, 180, 360))
    view.turn("returns", [0, 0.1 * radius], 1.1 * radius)
    told.marked(view)


@recipe("11")
def _box_on_cylinder(told: Drawing) -> None:
    view, _, _ = on_ground(told, FRONT, "falls", half=1.2)
    high = 2 * told.mass()[2]
    view.part(box([-0.9, 0], [0.9, high]))
    told.marked(view)


@recipe("12", "R6")
def _crossed(told: Drawing) -> None:
    ways = ("falls", "free") if told.edge is None else ("returns", "free")
    view, _, _ = on_ground(told, FRONT, ways[0], half=1.0)
    radius = told.mass()[2]
    view.part(box([-1.3, 0], [1.3, 2 * radius]))
    told.marked(view)
    side, _, above = on_ground(told, SIDE, ways[1], half=1.3)
    side.part(disc(side.flat(told.mass()), 1 / above))
    told.marked(side)


@recipe("13", "14")
def _parallel(told: Drawing) -> None:
    convex = told.curvature(0, 0, X) > 0
    view, _, above = on_ground(told, FRONT, "falls" if convex else "returns", half=1.1)
    view.part(disc(view.flat(told.mass()), 1 / above))
    told.marked(view)
    ends = sorted(told.point(k)[1] for k in range(len(told.assembly.contacts)))
    side, _, _ = on_ground(told, SIDE, "free", half=1.25 * ends[-1])
    side.part(box([ends[0], 0], [ends[-1], 2 / above]))
    told.marked(side)


@recipe("31")
def _ball_in_ring(told: Drawing) -> None:
    view = told.view(FRONT)
    hollow, tube = 1 / told.curvature(0, 0, X), 1 / told.curvature(0, 0, Y)
    radius, at = told.mass()[2], view.flat(told.mass())
    middle = [0, -hollow]
    view.held(annulus(middle, -hollow, -hollow + 2 * tube))
    view.part(disc(at, radius))
    view.way("returns", at, middle)
    told.marked(view)
    side = told.view(SIDE)
    for z in (-tube, -2 * hollow + tube):
        side.held(disc([0, z], tube))
    side.held(box([-tube, -tube], [tube, -2 * hollow + tube]), behind=True)
    side.part(disc(at, radius))
    side.way("falls", at, [0, -tube])
    told.marked(side)


@recipe("32")
def _coin(told: Drawing) -> None:
    ball(told, ["free"])
    radius = told.mass()[2]
    side = told.view(SIDE)
    side.held(ground([0, 0], 0, 1.2 * radius))
    side.part(box([-0.08, 0], [0.08, 2 * radius]))
    side.way("falls", side.flat(told.mass()), [0, 0])
    told.marked(side)


@recipe("25")
def _pivot(told: Drawing) -> None:
    view = told.view()
    view.held([[-0.3, -1], [0.3, -1], [0.12, 0], [-0.12, 0]])
    arms = [[0, 0], [0.75, -0.62], [0.9, -0.45], [0.1, 0.28], [-0.1, 0.28], [-0.9, -0.45]]
    view.part([*arms, [-0.75, -0.62]])
    for s in (1, -1):
        view.part(disc([s * 0.85, -0.58], 0.2))
    view.turn("returns", [0, 0], 0.55)
    told.marked(view)
