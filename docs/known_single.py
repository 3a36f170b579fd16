"""Pictures of known answers: a body on a single contact or line of contact."""

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


def ball(drawing: Drawing, ways: Sequence[str], half: float = 0.0) -> None:
    """A ball on its ground, from the front, and for two motions also from the side."""
    for seen, way in zip((FRONT, SIDE), ways, strict=False):
        view, _, above = on_ground(drawing, seen, way, half)
        view.part(disc(view.flat(drawing.mass()), 1 / above))
        drawing.marked(view)


BALLS = {
    "01": ["free"], "02": ["falls"], "03": ["returns"], "04": ["returns", "returns"],
    "29": ["falls", "free"], "30": ["returns", "free"], "R4": ["falls"], "R5": ["returns"],
}  # fmt: skip
for _number, _ways in BALLS.items():
    RECIPES[_number] = lambda drawing, ways=_ways: ball(drawing, ways)


@recipe("08")
def _ellipsoid(drawing: Drawing) -> None:
    height = drawing.mass()[2]
    for seen in (FRONT, SIDE):
        view, _, above = on_ground(drawing, seen, "free", half=1.5)
        axes = [np.sqrt(height / above), height]
        view.part(view.flat(drawing.mass()) + disc([0, 0], 1) * axes)
        view.turn("returns", view.flat(drawing.mass()), 1.2 * height)
        drawing.marked(view)


@recipe("09")
def _weeble(drawing: Drawing) -> None:
    view, _, above = on_ground(drawing, FRONT, "free", half=1.5)
    weeble(drawing, view, np.array([0, 1 / above]), 1 / above)


@recipe("10")
def _half_cylinder(drawing: Drawing) -> None:
    view, _, above = on_ground(drawing, FRONT, "free", half=1.5)
    radius = 1 / above
    view.part(arc([0, radius], radius, 180, 360))
    view.turn("returns", [0, 0.1 * radius], 1.1 * radius)
    drawing.marked(view)


@recipe("11")
def _box_on_cylinder(drawing: Drawing) -> None:
    view, _, _ = on_ground(drawing, FRONT, "falls", half=1.2)
    high = 2 * drawing.mass()[2]
    view.part(box([-0.9, 0], [0.9, high]))
    drawing.marked(view)


@recipe("12", "R6")
def _crossed(drawing: Drawing) -> None:
    ways = ("falls", "free") if drawing.edge is None else ("returns", "free")
    view, _, _ = on_ground(drawing, FRONT, ways[0], half=1.0)
    radius = drawing.mass()[2]
    view.part(box([-1.3, 0], [1.3, 2 * radius]))
    drawing.marked(view)
    side, _, above = on_ground(drawing, SIDE, ways[1], half=1.3)
    side.part(disc(side.flat(drawing.mass()), 1 / above))
    drawing.marked(side)


@recipe("13", "14")
def _parallel(drawing: Drawing) -> None:
    convex = drawing.curvature(0, 0, X) > 0
    view, _, above = on_ground(drawing, FRONT, "falls" if convex else "returns", half=1.1)
    view.part(disc(view.flat(drawing.mass()), 1 / above))
    drawing.marked(view)
    ends = sorted(drawing.point(k)[1] for k in range(len(drawing.assembly.contacts)))
    side, _, _ = on_ground(drawing, SIDE, "free", half=1.25 * ends[-1])
    side.part(box([ends[0], 0], [ends[-1], 2 / above]))
    drawing.marked(side)


@recipe("31")
def _ball_in_ring(drawing: Drawing) -> None:
    view = drawing.view(FRONT)
    hollow, tube = 1 / drawing.curvature(0, 0, X), 1 / drawing.curvature(0, 0, Y)
    radius, at = drawing.mass()[2], view.flat(drawing.mass())
    middle = [0, -hollow]
    view.held(annulus(middle, -hollow, -hollow + 2 * tube))
    view.part(disc(at, radius))
    view.way("returns", at, middle)
    drawing.marked(view)
    side = drawing.view(SIDE)
    for z in (-tube, -2 * hollow + tube):
        side.held(disc([0, z], tube))
    side.held(box([-tube, -tube], [tube, -2 * hollow + tube]), behind=True)
    side.part(disc(at, radius))
    side.way("falls", at, [0, -tube])
    drawing.marked(side)


@recipe("32")
def _coin(drawing: Drawing) -> None:
    ball(drawing, ["free"])
    radius = drawing.mass()[2]
    side = drawing.view(SIDE)
    side.held(ground([0, 0], 0, 1.2 * radius))
    side.part(box([-0.08, 0], [0.08, 2 * radius]))
    side.way("falls", side.flat(drawing.mass()), [0, 0])
    drawing.marked(side)


@recipe("25")
def _pivot(drawing: Drawing) -> None:
    view = drawing.view()
    view.held([[-0.3, -1], [0.3, -1], [0.12, 0], [-0.12, 0]])
    arms = [[0, 0], [0.75, -0.62], [0.9, -0.45], [0.1, 0.28], [-0.1, 0.28], [-0.9, -0.45]]
    view.part([*arms, [-0.75, -0.62]])
    for s in (1, -1):
        view.part(disc([s * 0.85, -0.58], 0.2))
    view.turn("returns", [0, 0], 0.55)
    drawing.marked(view)
