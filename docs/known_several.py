"""Pictures of known answers: several contacts, several parts, and rolling parts."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from known_drawing import (
    FRONT,
    RIGHT,
    SIDE,
    TOP,
    UP,
    Drawing,
    Seen,
    X,
    Y,
    Z,
    annulus,
    band,
    box,
    disc,
    foot,
    ground,
    on_ground,
    recipe,
    weeble,
)
from line_drawing import View, arc

sys.path.append(str(Path(__file__).resolve().parents[1] / "tests" / "scenes"))

from balance_cases import PEG, RING, WIRE

# several contacts --------------------------------------------------------------------------


@recipe("05")
def _trough(drawing: Drawing) -> None:
    view = drawing.view(FRONT)
    at, radius = view.flat(drawing.mass()), 1 / drawing.curvature(0, 1, Y)
    rim = 1.8 * abs(drawing.point(0)[0])
    view.held([[0, 0], [rim, rim], [rim, -0.3], [-rim, -0.3], [-rim, rim]])
    view.part(disc(at, radius))
    drawing.marked(view)
    view.turn("free", at, 0.5 * radius)
    side = drawing.view(SIDE)
    side.held(box([-2, 0], [2, rim]), behind=True)
    side.held(box([-2, -0.3], [2, 0]))
    side.part(disc(at, radius))
    side.way("free", at)
    drawing.marked(side)


def balls_below(drawing: Drawing, view: View) -> None:
    """Held balls, the farthest first."""
    depth = np.cross(view.right, view.up)
    centers = []
    for k in range(len(drawing.assembly.contacts)):
        along = np.cross(drawing.normal(k), depth)
        radius = 1 / drawing.curvature(k, 0, along / np.linalg.norm(along))
        centers.append((drawing.point(k) - radius * drawing.normal(k), radius))
    for center, radius in sorted(centers, key=lambda one: float(one[0] @ depth)):
        view.held(disc(view.flat(center), radius))


@recipe("06")
def _on_two(drawing: Drawing) -> None:
    for seen, way in ((FRONT, "returns"), (SIDE, "falls")):
        view = drawing.view(seen)
        balls_below(drawing, view)
        at = view.flat(drawing.mass())
        view.part(disc(at, 1 / drawing.curvature(0, 1, Y)))
        view.way(way, at, None if way == "returns" else [0, 0])
        drawing.marked(view)


@recipe("07")
def _on_three(drawing: Drawing) -> None:
    for seen in (FRONT, TOP):
        view = drawing.view(seen)
        balls_below(drawing, view)
        at = view.flat(drawing.mass())
        view.part(disc(at, 1 / drawing.curvature(0, 1, Y)))
        view.way("returns", at)
        drawing.marked(view)


@recipe("28")
def _cup(drawing: Drawing) -> None:
    view = drawing.view()
    at, contact = view.flat(drawing.mass()), view.flat(drawing.point(0))
    rim = 1.7 * contact
    mirrored = rim * [-1, 1]
    low = -0.25
    view.held(
        [[0, 0], rim, rim + 0.3 * RIGHT, [0.3, low], [-0.3, low], mirrored - 0.3 * RIGHT, mirrored]
    )
    view.part(disc(at, 1 / drawing.curvature(0, 1, Y)))
    view.way("returns", at)
    drawing.marked(view)


def stacked(drawing: Drawing, view: View, walls: Sequence[float]) -> float:
    """Draw balls 1 and 2 on a floor between walls at `walls`; return their radius [m]."""
    top, radius = drawing.mass("2")[2] + 0.7, drawing.mass("1")[2]
    half = max([1.6 * radius, *(abs(x) for x in walls)])
    view.held(box([-half - 0.2, -0.2], [half + 0.2, 0]))
    for x in walls:
        view.held(box([min(x, x + 0.2 * np.sign(x)), 0], [max(x, x + 0.2 * np.sign(x)), top]))
    for k, name in enumerate("12"):
        view.part(disc(view.flat(drawing.mass(name)), radius), k)
    return radius


@recipe("15")
def _zigzag(drawing: Drawing) -> None:
    view = drawing.view(FRONT)
    tube = drawing.point(3)[0]
    stacked(drawing, view, [-tube, tube])
    drawing.marked(view, "1", "2")
    above = drawing.view(TOP)
    above.held(annulus([0, 0], tube, tube + 0.2))
    radius = drawing.mass("1")[2]
    for k, name in enumerate("12"):
        above.part(disc(above.flat(drawing.mass(name)), radius), k)
    above.turn("free", [0, 0], 0.5)
    drawing.marked(above, "1", "2")


@recipe("16")
def _tight(drawing: Drawing) -> None:
    view = drawing.view()
    radius = stacked(drawing, view, [-drawing.mass("1")[2], drawing.mass("1")[2]])
    for name in "12":
        view.turn("free", view.flat(drawing.mass(name)), 0.6 * radius)
    drawing.marked(view, "1", "2")


def toppling(drawing: Drawing, seen: Seen) -> None:
    """Two balls, the upper rolling off the lower, which goes the other way."""
    view = drawing.view(seen)
    stacked(drawing, view, [])
    low, high = (view.flat(drawing.mass(name)) for name in "12")
    view.way("falls", high, low)
    view.way("falls", low, left=True)
    drawing.marked(view, "1", "2")


@recipe("17")
def _plates(drawing: Drawing) -> None:
    view = drawing.view(FRONT)
    stacked(drawing, view, [-drawing.mass("1")[2], drawing.mass("1")[2]])
    drawing.marked(view, "1", "2")
    toppling(drawing, SIDE)


@recipe("18")
def _no_walls(drawing: Drawing) -> None:
    toppling(drawing, FRONT)


@recipe("19", "20")
def _plank(drawing: Drawing) -> None:
    view = drawing.view()
    n = view.flat(drawing.normal(0))
    along = np.array([n[1], -n[0]])
    for s in (1, -1):
        flip = np.array([s, 1])
        at = view.flat(drawing.point(0))
        ends = [at - 0.35 * along, at + 0.5 * along]
        view.held(np.array([*ends, ends[1] - 0.2 * n, ends[0] - 0.2 * n]) * flip)
    at = view.flat(drawing.mass())
    view.part([[-1, 0], [1, 0], [1, 0.16], [0.05, 0.16], [-0.05, 0.16], [-1, 0.16]])
    view.part(box([-0.04, at[1]], [0.04, 0]))
    view.part(disc(at, 0.2))
    view.way("returns", at, [0, abs(n[1] / n[0])])
    drawing.marked(view)


def wire(view: View, middle: float, start: float = -90, end: float = 270) -> None:
    """A ring of the scene from the front, or a part of it."""
    whole = end - start == 360
    view.part(
        annulus([0, middle], RING, RING + 2 * WIRE)
        if whole
        else band([0, middle], RING, RING + 2 * WIRE, start, end)
    )


@recipe("21")
def _ring(drawing: Drawing) -> None:
    view = drawing.view(FRONT)
    at = view.flat(drawing.mass())
    view.held(disc([0, -PEG], PEG))
    wire(view, -RING)
    view.turn("free", at, 0.36 * RING)
    drawing.marked(view)
    side = drawing.view(SIDE)
    side.part(box([-WIRE, -2 * RING - 2 * WIRE], [WIRE, 2 * WIRE]))
    side.held(box([-1.1, -2 * PEG], [1.1, 0]))
    side.way("free", at)
    drawing.marked(side)


@recipe("22", "R8")
def _hook(drawing: Drawing) -> None:
    view = drawing.view()
    at = view.flat(drawing.mass())
    view.held(disc([0, -PEG], PEG))
    if at[1] < 0:
        wire(view, -RING, -90, 200)
        view.part(box([-0.22, -RING * 2 - 0.55], [0.22, -2 * RING]))
    else:
        wire(view, -RING, -20, 200)
        view.part(box([-0.1, 2 * WIRE], [0.1, at[1]]))
        view.part(disc(at, 0.25))
    view.way("returns", at, at + RING * UP)
    drawing.marked(view)


@recipe("23")
def _ring_up(drawing: Drawing) -> None:
    middle = drawing.mass()[2]
    view = drawing.view(FRONT)
    view.held(disc([0, -PEG], PEG))
    view.part(annulus([0, middle], middle - 2 * WIRE, middle))
    view.way("falls", [0, middle], [0, -PEG])
    drawing.marked(view)
    side = drawing.view(SIDE)
    side.held(box([-1.1, -2 * PEG], [1.1, 0]))
    side.part(box([-WIRE, 0], [WIRE, 2 * middle]))
    side.way("falls", [0, middle], [0, 0])
    drawing.marked(side)


@recipe("24", "24b")
def _over_edge(drawing: Drawing) -> None:
    view = drawing.view()
    inner, at = drawing.point(1)[0], view.flat(drawing.mass())
    view.held(box([inner - 0.5, -1.1], [0, 0]))
    view.part([[inner, 0], [0.15, 0], [0.15, -0.8], [0.95, -0.8], [0.95, 0.35], [inner, 0.35]])
    if drawing.edge is None:
        view.way("falls", at)
    else:
        stop = drawing.point(4)[0]
        view.part(box([0.95, -0.1], [stop, 0.1]))
        view.held(box([stop, -1.1], [stop + 0.35, 0.5]))
        view.turn("returns", [0, 0], 0.6)
    drawing.marked(view)


@recipe("26", "27")
def _dumbbell(drawing: Drawing) -> None:
    hollow, radius = (1 / drawing.curvature(0, side, Y) for side in (0, 1))
    left, right = (drawing.point(k) + radius * drawing.normal(k) for k in (1, 0))
    bowl = arc([0, 0], -hollow, 205, 335)
    low = -1.12 * -hollow
    outline = np.vstack([bowl, [[bowl[-1, 0], low], [bowl[0, 0], low]]])
    view = drawing.view(FRONT)
    view.held(outline)
    view.part(box([left[0], left[2] - 0.07], [right[0], right[2] + 0.07]))
    for one in (left, right):
        view.part(disc(view.flat(one), radius))
    drawing.marked(view)
    if drawing.edge is None:
        view.way("returns", view.flat(drawing.mass()), [0, 0])
        above = drawing.view(TOP)
        above.held(annulus([0, 0], -hollow * 0.95, -hollow * 1.08))
        above.part(box([left[0], -0.07], [right[0], 0.07]))
        for one in (left, right):
            above.part(disc(above.flat(one), radius))
        above.turn("free", [0, 0], 0.8 * right[0])
        drawing.marked(above)
        return
    side = drawing.view(SIDE)
    axis, contact = side.flat(left), side.flat(drawing.point(0))
    section = arc([0, 0], -contact[1], 205, 335)  # through the contacts
    side.held(np.vstack([section, [[section[-1, 0], low], [section[0, 0], low]]]))
    side.part(disc(axis, axis[1] - contact[1]))
    side.turn("returns", axis, 1.6 * radius)
    drawing.marked(side)


@recipe("33")
def _box(drawing: Drawing) -> None:
    for seen in (FRONT, TOP):
        view = drawing.view(seen)
        feet = np.array([view.flat(drawing.point(k)) for k in range(4)])
        low, high = feet.min(axis=0), feet.max(axis=0)
        if seen is FRONT:
            view.held(ground([0, 0], 0, 1.6))
            high = high + 2 * drawing.mass()[2] * UP
        else:
            view.held(box([-1.6, -1.1], [1.6, 1.1]))
            view.turn("free", view.flat(drawing.mass()), 0.42)
        view.part(box(low, high))
        if seen is FRONT:
            view.way("free", view.flat(drawing.mass()))
        drawing.marked(view)


@recipe("34")
def _on_balls(drawing: Drawing) -> None:
    view = drawing.view()
    view.held(ground([0, 0], 0, 2.0))
    for k, name in enumerate("231"):
        at = view.flat(drawing.mass(name))
        view.part(disc(at, at[1]), k + 1)
    top = drawing.point(1)[2]
    view.part(box([-1.6, top], [1.6, 2 * drawing.mass()[2] - top]))
    for name in "b231":
        view.way("free", view.flat(drawing.mass(name)))
    drawing.marked(view, *"b231")


@recipe("35")
def _two_boxes(drawing: Drawing) -> None:
    view = drawing.view()
    view.held(ground([0, 0], 0, 1.6))
    for k, (name, first) in enumerate((("1", 0), ("2", 4))):
        feet = np.array([drawing.point(first + j) for j in range(4)])
        low = [feet[:, 0].min(), feet[0, 2]]
        view.part(box(low, [feet[:, 0].max(), 2 * drawing.mass(name)[2] - low[1]]), k)
        view.way("free", view.flat(drawing.mass(name)))
    drawing.marked(view, "1", "2")


@recipe("36", "R9")
def _plank_on_two(drawing: Drawing) -> None:
    cylinders = drawing.curvature(0, 0, Y) == 0
    for seen in (FRONT, SIDE):
        view = drawing.view(seen)
        radius, at = 1 / drawing.curvature(0, 0, X), view.flat(drawing.mass())
        if seen is SIDE and cylinders:
            view.held(box([-1.3, -2 * radius], [1.3, 0]))
        else:
            for s in (1, -1) if seen is FRONT else (0,):
                view.held(disc([s * drawing.point(0)[0], -radius], radius))
        half = 1.5 if seen is FRONT else 0.8 + 0.2 * cylinders
        view.part(box([-half, 0], [half, 2 * at[1]]))
        if seen is SIDE and not cylinders:
            view.way("falls", at, [0, -radius])
        drawing.marked(view)


@recipe("37")
def _feet(drawing: Drawing) -> None:
    radius = 1 / drawing.curvature(0, 1, X)
    for seen in (FRONT, SIDE):
        view = drawing.view(seen)
        spread = drawing.point(0)[0] if seen is FRONT else 0.0
        at = view.flat(drawing.mass())
        view.held(ground([0, 0], 0, spread + 0.9))
        for s in (1, -1) if spread else (0,):
            view.part(foot(np.array([s * spread, 0]), radius, 0.7))
        top = radius - np.sqrt(radius**2 - 0.7**2)
        view.part(box([-spread - 0.7, top], [spread + 0.7, 2 * at[1] - top]))
        if seen is FRONT:
            view.way("free", at)
        else:
            view.turn("returns", at, 0.9 * radius)
        drawing.marked(view)


@recipe("38")
def _bowls(drawing: Drawing) -> None:
    view = drawing.view()
    hollow, radius = (1 / drawing.curvature(0, side, Y) for side in (0, 1))
    reach = 0.55
    for k in range(2):
        at = view.flat(drawing.point(k))
        angle = np.degrees(np.arcsin(-reach / hollow))
        cup = arc(at - [0, hollow], -hollow, 270 - angle, 270 + angle)
        low = at[1] - 0.3
        view.held(np.vstack([cup, [[at[0] + reach, low], [at[0] - reach, low]]]))
    feet = [view.flat(drawing.point(k)) + radius * UP for k in range(2)]
    at = view.flat(drawing.mass())
    view.part(box([-1, -0.06], [1, 0.06]))
    view.part(box([-0.05, at[1]], [0.05, 0]))
    for one in feet:
        view.part(disc(one, radius))
    view.part(disc(at, 0.2))
    view.way("returns", at, at - [0, hollow])
    drawing.marked(view)


@recipe("39")
def _six(drawing: Drawing) -> None:
    above = drawing.view(TOP)
    feet = [above.flat(drawing.point(k)) for k in range(6)]
    around = sorted(feet, key=lambda one: float(np.arctan2(one[1], one[0])))
    above.held(disc([0, 0], 2.9))
    above.part(1.12 * np.array(around))
    for k, one in enumerate(feet):
        above.part(disc(one, 0.17), 1 + k // 2)
    drawing.marked(above)
    close = drawing.view(("a foot", X, Z))
    close.close = True
    along = np.asarray(drawing.assembly.contacts[0].feature[0].along)
    across = np.cross(drawing.normal(0), along)
    close.held(ground([0, 0], drawing.curvature(0, 0, along), 0.75), behind=True)
    close.held(ground([0, 0], drawing.curvature(0, 0, across), 0.45))
    close.part([[0, 0], [0.18, 0.42], [0.5, 0.42], [0.5, 0.6], [-0.5, 0.6], [-0.5, 0.42],
                [-0.18, 0.42]])  # fmt: skip


# rolling -----------------------------------------------------------------------------------


@recipe("R1", "R2")
def _board(drawing: Drawing) -> None:
    view, _, _ = on_ground(drawing, FRONT, "", half=1.2)
    view.part(box([-1, 0], [1, 2 * drawing.mass()[2]]))
    view.turn("returns", view.flat(drawing.mass()), 1.15)
    drawing.marked(view)
    if len(drawing.assembly.contacts) > 1:
        side, _, _ = on_ground(drawing, SIDE, "", half=1.2)
        side.part(box([-1, 0], [1, 2 * drawing.mass()[2]]))
        drawing.marked(side)


@recipe("R3")
def _stone(drawing: Drawing) -> None:
    view, _, above = on_ground(drawing, FRONT, "", half=1.2)
    at = view.flat(drawing.mass())
    cap = foot(np.zeros(2), 1 / above, 1.1)
    view.part(np.vstack([cap, [[0.7, 2 * at[1]], [-0.7, 2 * at[1]]]]))
    view.turn("returns", at, 0.9)
    drawing.marked(view)


@recipe("R7")
def _on_slope(drawing: Drawing) -> None:
    view = drawing.view()
    n = view.flat(drawing.normal(0))
    radius = 1 / drawing.curvature(0, 1, Y)
    view.held(ground(view.flat(drawing.point(0)), 0, 1.5, turn=-float(np.arctan2(n[0], n[1]))))
    weeble(drawing, view, radius * n, radius)
