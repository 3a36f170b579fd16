"""Twelve everyday things as a stranger draws them in CAD, each once right and once with a mistake.

Play is drawn centred, glue and screws are not drawn, and nothing is marked as held. `Expected` is
what the owner wants to hear, fixed by the geometry: the lowest rung of the ladder of assumptions
that holds, the parts that fall on every rung, and where loose bodies lie. Lengths are mm, z is up.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import pytest

pytest.importorskip("OCP", reason="needs the extra kilter[step]")

from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut, BRepAlgoAPI_Fuse
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakePolygon
from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakeCylinder, BRepPrimAPI_MakePrism
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt, gp_Vec

Solids = dict[str, Any]
"""OCCT solids by the names of their parts."""
DIRECTIONS = {"x": (1, 0, 0), "y": (0, 1, 0), "z": (0, 0, 1)}


@dataclass(frozen=True)
class Expected:
    """The useful first answer about a thing.

    Attributes
    ----------
    holds : str, optional
        Lowest rung that holds without friction; None if none does.
    drawn : frozenset of str
        Parts that fall as drawn.
    falls : frozenset of str
        Parts that fall on every rung.
    may_fall : frozenset of str
        Further parts that may be counted among these, since the falling parts press on them.
    below : mapping
        Body (name of its largest part) -> parts onto which it falls, and the way [mm]; None if
        several are right.
    """

    holds: str | None
    drawn: frozenset[str]
    falls: frozenset[str] = frozenset()
    may_fall: frozenset[str] = frozenset()
    below: Mapping[str, tuple[frozenset[str], float | None]] = field(default_factory=dict)


@dataclass(frozen=True)
class Thing:
    """A thing: its drawing, right or with a mistake, and the useful answer to both."""

    name: str
    draw: Callable[[bool], Solids]
    right: Expected
    wrong: Expected


# solids -----------------------------------------------------------------------------------


def box(low: Sequence[float], high: Sequence[float]) -> Any:
    """A box between two corners."""
    return BRepPrimAPI_MakeBox(gp_Pnt(*low), gp_Pnt(*high)).Shape()


def rod(along: str, start: Sequence[float], length: float, radius: float) -> Any:
    """A cylinder from the middle of an end along an axis."""
    axis = gp_Ax2(gp_Pnt(*start), gp_Dir(*DIRECTIONS[along]))
    return BRepPrimAPI_MakeCylinder(axis, float(radius), float(length)).Shape()


def cut(solid: Any, *tools: Any) -> Any:
    """A solid without others."""
    for tool in tools:
        solid = BRepAlgoAPI_Cut(solid, tool).Shape()
    return solid


def fused(solid: Any, *others: Any) -> Any:
    """Several solids as a single one."""
    for other in others:
        solid = BRepAlgoAPI_Fuse(solid, other).Shape()
    return solid


def profile(points: Iterable[Sequence[float]], left: float, right: float) -> Any:
    """A prism along x with an outline in y and z."""
    wire = BRepBuilderAPI_MakePolygon()
    for y, z in points:
        wire.Add(gp_Pnt(left, float(y), float(z)))
    wire.Close()
    face = BRepBuilderAPI_MakeFace(wire.Wire()).Face()
    return BRepPrimAPI_MakePrism(face, gp_Vec(right - left, 0, 0)).Shape()


def some(*names: str) -> frozenset[str]:
    """A set of names."""
    return frozenset(names)


def numbered(name: str, count: int) -> list[str]:
    """Names with the numbers from 1."""
    return [f"{name}_{k + 1}" for k in range(count)]


# the things -------------------------------------------------------------------------------


def drawer_cabinet(flawed: bool) -> Solids:
    """Glued boards with rails, and three drawers .5 above their rails; or a pair of rails less."""
    solids = {
        "Side_left": box((0, 0, 0), (18, 400, 640)),
        "Side_right": box((482, 0, 0), (500, 400, 640)),
        "Top": box((0, 0, 640), (500, 400, 658)),
        "Bottom": box((18, 0, 60), (482, 400, 78)),
        "Back": box((18, 382, 78), (482, 400, 640)),
    }
    for k, low in enumerate((100, 280, 460), start=1):
        if not (flawed and k == 2):
            solids[f"Rail_left_{k}"] = box((18, 10, low), (30, 370, low + 12))
            solids[f"Rail_right_{k}"] = box((470, 10, low), (482, 370, low + 12))
        bottom = low + 12.5
        outer = box((19, 0, bottom), (481, 370, bottom + 120))
        solids[f"Drawer_{k}"] = cut(outer, box((31, 12, bottom + 12), (469, 358, bottom + 121)))
    return solids


DRAWERS = numbered("Drawer", 3)
RAILS = [f"Rail_{side}_{k}" for side in ("left", "right") for k in (1, 2, 3)]
CABINET_BOARDS = ["Bottom", "Back", *DRAWERS]


def phone_stand(flawed: bool) -> Solids:
    """A slanted back with a ledge on four feet, and a phone .2 in front of both; or no ledge."""
    up, out = directions_of_back(20)
    corner = (30.0, 15.0)

    def at(along: float, outward: float) -> tuple[float, float]:
        return (
            corner[0] + along * up[0] + outward * out[0],
            corner[1] + along * up[1] + outward * out[1],
        )

    rear = [(0, 0), (110, 0), (110, 8), at(90, -6), at(90, 0)]
    foot_of_back = at((8 - corner[1]) / up[1], 0)
    ledge = [at(0, 0), at(0, 15), at(6, 15), at(6, 19), (2, 10)]
    solids = {
        "Stand": profile([*rear, *([foot_of_back, (0, 8)] if flawed else ledge)], 0, 80),
        "Phone": profile([at(0.2, 0.2), at(150.2, 0.2), at(150.2, 8.2), at(0.2, 8.2)], 4, 76),
    }
    places = [(10, 8), (70, 8), (10, 100), (70, 100)]
    feet = [rod("z", (x, y, -3), 3, 5) for x, y in places]
    return {**solids, **dict(zip(numbered("Foot", 4), feet, strict=True))}


def directions_of_back(degrees: float) -> tuple[tuple[float, float], tuple[float, float]]:
    """The directions along and out of a back that leans by an angle, in y and z."""
    sine, cosine = math.sin(math.radians(degrees)), math.cos(math.radians(degrees))
    return (sine, cosine), (-cosine, sine)


def hinge(flawed: bool) -> Solids:
    """Two leaves that lie on the floor and a pin with .1 of play; or the pin lies 20 higher."""
    middle = (0.0, 0.0, 6.0)
    hole = rod("x", (-5, 0, 6), 70, 2.6)
    left = box((0, -30, 0), (60, -7, 3))
    right = box((0, 7, 0), (60, 30, 3))
    for start, end in ((0, 20), (40, 60)):
        knuckle = rod("x", (start, *middle[1:]), end - start, 6)
        left = fused(left, box((start, -8, 0), (end, 0, 3)), knuckle)
    knuckle = rod("x", (20.2, *middle[1:]), 19.6, 6)
    right = fused(right, box((20.2, 0, 0), (39.8, 8, 3)), knuckle)
    pin = rod("x", (-1, 0, 26 if flawed else 6), 62, 2.5)
    return {"Leaf_A": cut(left, hole), "Leaf_B": cut(right, hole), "Pin": pin}


def box_with_lid(flawed: bool) -> Solids:
    """A lid with a rim, .2 above its box and .2 from its sides; or 12 higher."""
    lift = 12.0 if flawed else 0.0
    body = cut(box((0, 0, 0), (100, 70, 40)), box((3, 3, 3), (97, 67, 41)))
    rim = cut(
        box((3.2, 3.2, 35.2 + lift), (96.8, 66.8, 40.2 + lift)),
        box((5.2, 5.2, 35 + lift), (94.8, 64.8, 40.2 + lift)),
    )
    lid = fused(box((0, 0, 40.2 + lift), (100, 70, 43.2 + lift)), rim)
    return {"Box": body, "Lid": lid}


def keyboard(flawed: bool) -> Solids:
    """A case, a plate on four posts, six switches with caps, all with play; or no posts."""
    case = cut(box((0, 0, 0), (100, 70, 20)), box((3, 3, 2), (97, 67, 21)))
    posts = [rod("z", (x, y, 2), 10, 3) for x in (8, 92) for y in (8, 62)]
    solids = {"Case": case if flawed else fused(case, *posts)}
    plate = box((3.2, 3.2, 12.1), (96.8, 66.8, 13.6))
    centers = [(x, y) for y in (25.5, 44.5) for x in (31.0, 50.0, 69.0)]

    def square(x: float, y: float, size: float, low: float, high: float) -> Any:
        return box((x - size / 2, y - size / 2, low), (x + size / 2, y + size / 2, high))

    solids["Plate"] = cut(plate, *(square(x, y, 14, 12, 14) for x, y in centers))
    for k, (x, y) in enumerate(centers, start=1):
        body, flange = square(x, y, 13.8, 7, 13.7), square(x, y, 15.6, 13.7, 14.7)
        solids[f"Switch_{k}"] = fused(body, flange, square(x, y, 4, 14.7, 18))
        solids[f"Keycap_{k}"] = cut(square(x, y, 18, 16.2, 22), square(x, y, 4.2, 16, 18.1))
    return solids


SWITCHES, KEYCAPS = numbered("Switch", 6), numbered("Keycap", 6)


def gearbox(flawed: bool) -> Solids:
    """Two halves, two shafts in bearings with play, pressed gears; or a bearing less."""
    bores = [rod("y", (x, -45, 40), 90, 13.05) for x in (-20, 20)]
    lower = cut(box((-50, -40, 0), (50, 40, 40)), box((-44, -34, 6), (44, 34, 41)), *bores)
    upper = cut(box((-50, -40, 40), (50, 40, 80)), box((-44, -34, 39), (44, 34, 74)), *bores)
    solids = {"Housing_lower": lower, "Housing_upper": upper}
    places = [(x, y) for x in (-20, 20) for y in (-40, 34)]
    for k, (x, y) in enumerate(places[: 3 if flawed else 4], start=1):
        ring = cut(rod("y", (x, y, 40), 6, 13), rod("y", (x, y - 1, 40), 8, 6.02))
        solids[f"Bearing_{k}"] = ring
    for k, x in enumerate((-20, 20), start=1):
        shaft = rod("y", (x, -45, 40), 90, 6)
        solids[f"Shaft_{k}"] = shaft
        solids[f"Gear_{k}"] = cut(rod("y", (x, -6, 40), 12, 19.9), shaft)
    return solids


TURNING = [*numbered("Bearing", 4), *numbered("Shaft", 2), *numbered("Gear", 2)]


def clamp(flawed: bool) -> Solids:
    """A screw that overlaps its thread, and a pad .2 above a workpiece; or no workpiece."""
    frame = fused(
        box((-20, -15, 0), (75, 15, 20)),
        box((55, -15, 20), (75, 15, 100)),
        box((-15, -15, 100), (75, 15, 120)),
    )
    handle = box((-25, -4, 135), (25, 4, 143))
    solids = {
        "Frame": cut(frame, rod("z", (0, 0, 99), 22, 3.4)),
        "Screw": fused(rod("z", (0, 0, 62), 73, 4), rod("z", (0, 0, 55), 8, 3), handle),
        "Pad": cut(rod("z", (0, 0, 50.2), 7.8, 10), rod("z", (0, 0, 54.8), 5, 3.2)),
    }
    return solids if flawed else {**solids, "Workpiece": box((-20, -15, 20), (20, 15, 50))}


def shelf(flawed: bool) -> Solids:
    """A glued carcass, dowels size on size, and a shelf .2 above them; or two dowels less."""
    places = [(x, y) for x in (8, 508) for y in (40, 200)]
    dowels = [rod("x", (x, y, 400), 20, 4) for x, y in places]
    solids = {
        "Side_left": cut(box((0, 0, 0), (18, 250, 700)), *dowels[:2]),
        "Side_right": cut(box((518, 0, 0), (536, 250, 700)), *dowels[2:]),
        "Top": box((0, 0, 700), (536, 250, 718)),
        "Bottom": box((18, 0, 80), (518, 250, 98)),
        "Back": box((18, 240, 98), (518, 250, 700)),
        "Shelf": box((19, 5, 404.2), (517, 235, 422.2)),
    }
    return {**solids, **dict(zip(numbered("Dowel", 4)[: 2 if flawed else 4], dowels, strict=False))}


def snap_case(flawed: bool) -> Solids:
    """A cover that hangs by hooks with .2 of play, with a board on it; or no ledges for them."""
    body = cut(box((0, 0, 6), (80, 50, 36)), box((2, 2, 5), (78, 48, 34)))
    legs = [box((x, y, 0), (x + 2, y + 12, 6)) for x in (0, 78) for y in (0, 38)]
    ledges = [box((30, y, 14), (50, y + 1.2, 16)) for y in (2, 46.8)]
    hooks = [
        box((32, 3.6, 8), (48, 5, 18)),
        box((32, 2.4, 16.2), (48, 3.6, 18)),
        box((32, 45, 8), (48, 46.4, 18)),
        box((32, 46.4, 16.2), (48, 47.6, 18)),
    ]
    return {
        "Body": fused(body, *legs, *([] if flawed else ledges)),
        "Cover": fused(box((2.2, 2.2, 6.2), (77.8, 47.8, 8.2)), *hooks),
        "Board": box((10, 8, 8.2), (70, 42, 9.8)),
    }


def pulley(flawed: bool) -> Solids:
    """An axle with .1 of play in two cheeks, and a wheel with .2 of play on it; or no axle."""
    hole = rod("y", (0, -30, 55), 60, 4.1)
    cheeks = [box((-15, y, 8), (15, y + 6, 80)) for y in (-22, 16)]
    bracket = cut(fused(box((-40, -30, 0), (40, 30, 8)), *cheeks), hole)
    wheel = cut(rod("y", (0, -15, 55), 30, 25), rod("y", (0, -16, 55), 32, 4.2))
    solids = {"Bracket": bracket, "Wheel": wheel}
    return solids if flawed else {**solids, "Axle": rod("y", (0, -25, 55), 50, 4)}


def lamp(flawed: bool) -> Solids:
    """Base, post, arm and head that touch, a bulb .3 above its rim; or an arm 3 off its post."""
    head = cut(
        rod("z", (130, 0, 320), 50, 30),
        rod("z", (130, 0, 319), 6, 20),
        rod("z", (130, 0, 324), 36, 25),
    )
    return {
        "Base": rod("z", (0, 0, 0), 25, 90),
        "Post": box((-10, -10, 25), (10, 10, 400)),
        "Arm": box((13 if flawed else 10, -8, 370), (160, 8, 390)),
        "Head": head,
        "Bulb": rod("z", (130, 0, 324.3), 25.7, 22),
    }


def picture(flawed: bool) -> Solids:
    """A picture with a hanger .5 above a screwed hook; or no hook."""
    holes = [rod("y", (0, -4, z), 34, 1.7) for z in (622, 634)]
    through = [rod("y", (0, -4, z), 8, 2.1) for z in (622, 634)]
    hook = fused(
        box((-10, -3, 600), (10, 0, 640)),
        box((-10, -10, 600), (10, -3, 604)),
        box((-10, -13, 600), (10, -10, 610)),
    )
    hanger = fused(
        box((-20, -15, 611), (20, -13.3, 640)),
        box((-8, -13.3, 611), (8, -9.7, 614)),
        box((-8, -9.7, 604.5), (8, -3.3, 614)),
    )
    wall = box((-500, 0, 0), (500, 100, 1000))
    solids = {
        "Wall": wall if flawed else cut(wall, *holes),
        "Frame": box((-150, -35, 350), (150, -15, 650)),
        "Hanger": hanger,
        "Bumper_1": box((-140, -15, 360), (-120, -0.2, 380)),
        "Bumper_2": box((120, -15, 360), (140, -0.2, 380)),
    }
    if not flawed:
        solids["Hook"] = cut(hook, *through)
        for k, z in enumerate((622, 634), start=1):
            solids[f"Screw_{k}"] = fused(rod("y", (0, -3, z), 33, 2), rod("y", (0, -5, z), 2, 4))
    return solids


SCREWS = numbered("Screw", 2)
PICTURE = ["Frame", "Hanger", *numbered("Bumper", 2)]
ALL_RAILS = {f"Drawer_{k}": (some(f"Rail_left_{k}", f"Rail_right_{k}"), 0.5) for k in (1, 2, 3)}
LEAN = math.radians(20)
CAPS_AND_SWITCHES = {
    **{f"Keycap_{k}": (some(f"Switch_{k}"), 0.1) for k in range(1, 7)},
    **{f"Switch_{k}": (some("Plate"), 0.1) for k in range(1, 7)},
}
ROUND_PLAY = {
    # a bearing lies around its shaft: it falls onto the shaft, or with the shaft onto the housing
    **{
        f"Bearing_{k}": (some("Housing_lower", f"Shaft_{(k + 1) // 2}"), None) for k in (1, 2, 3, 4)
    },
    "Gear_1": (some("Bearing_1", "Bearing_2"), 0.02),
    "Gear_2": (some("Bearing_3", "Bearing_4"), 0.02),
}

THINGS = (
    Thing(
        "drawer cabinet",
        drawer_cabinet,
        Expected("joined", some(*CABINET_BOARDS, *RAILS), below=ALL_RAILS),
        Expected(
            None,
            some(*CABINET_BOARDS, *(name for name in RAILS if not name.endswith("2"))),
            some("Drawer_2"),
            below={**ALL_RAILS, "Drawer_2": (some("Drawer_1"), 60.0)},
        ),
    ),
    Thing(
        "phone stand",
        phone_stand,
        Expected("play", some("Phone"), below={"Phone": (some("Stand"), 0.2 / math.cos(LEAN))}),
        Expected(
            None,
            some("Phone"),
            some("Phone"),
            below={"Phone": (some("Stand"), 0.2 / math.sin(LEAN))},
        ),
    ),
    Thing(
        "hinge",
        hinge,
        Expected("play", some("Pin"), below={"Pin": (some("Leaf_A", "Leaf_B"), 0.1)}),
        Expected(None, some("Pin"), some("Pin"), below={"Pin": (some("Leaf_A", "Leaf_B"), 11.5)}),
    ),
    Thing(
        "box with lid",
        box_with_lid,
        Expected("play", some("Lid"), below={"Lid": (some("Box"), 0.2)}),
        Expected(None, some("Lid"), some("Lid"), below={"Lid": (some("Box"), 12.2)}),
    ),
    Thing(
        "keyboard",
        keyboard,
        Expected(
            "play",
            some("Plate", *SWITCHES, *KEYCAPS),
            below={**CAPS_AND_SWITCHES, "Plate": (some("Case"), 0.1)},
        ),
        Expected(
            None,
            some("Plate", *SWITCHES, *KEYCAPS),
            some("Plate", *SWITCHES, *KEYCAPS),
            below={**CAPS_AND_SWITCHES, "Plate": (some("Case"), 10.1)},
        ),
    ),
    Thing(
        "gearbox",
        gearbox,
        Expected("play", some(*TURNING), below=ROUND_PLAY),
        Expected(
            None,
            some(*(name for name in TURNING if name != "Bearing_4")),
            some("Shaft_2", "Gear_2"),
            # no part is put to rest beside parts without a rest within their play
            some(*(name for name in TURNING if name not in ("Shaft_2", "Gear_2", "Bearing_4"))),
            below={
                **{name: way for name, way in ROUND_PLAY.items() if name != "Bearing_4"},
                "Gear_2": (some("Bearing_3"), 0.02),
            },
        ),
    ),
    Thing(
        "clamp",
        clamp,
        Expected("fits", some("Screw", "Pad"), below={"Pad": (some("Workpiece"), 0.2)}),
        Expected(None, some("Screw", "Pad"), some("Pad"), below={"Pad": (some("Frame"), 30.2)}),
    ),
    Thing(
        "shelf",
        shelf,
        Expected(
            "joined",
            some("Bottom", "Back", "Shelf"),
            below={"Shelf": (some(*numbered("Dowel", 4)), 0.2)},
        ),
        Expected(
            None,
            some("Bottom", "Back", "Shelf"),
            some("Shelf"),
            below={"Shelf": (some(*numbered("Dowel", 2)), 0.2)},
        ),
    ),
    Thing(
        "snap-fit case",
        snap_case,
        Expected("play", some("Cover", "Board"), below={"Cover": (some("Body"), 0.2)}),
        Expected(
            None,
            some("Cover", "Board"),
            some("Cover", "Board"),
            below={"Cover": (some("floor"), 6.2)},
        ),
    ),
    Thing(
        "pulley",
        pulley,
        Expected(
            "play",
            some("Axle", "Wheel"),
            below={"Axle": (some("Bracket"), 0.1), "Wheel": (some("Axle"), 0.2)},
        ),
        Expected(None, some("Wheel"), some("Wheel"), below={"Wheel": (some("Bracket"), 22.0)}),
    ),
    Thing(
        "lamp",
        lamp,
        Expected("joined", some("Arm", "Head", "Bulb"), below={"Bulb": (some("Head"), 0.3)}),
        Expected(
            None,
            some("Arm", "Head", "Bulb"),
            some("Arm", "Head", "Bulb"),
            below={"Head": (some("floor"), 320.0), "Bulb": (some("Head"), 0.3)},
        ),
    ),
    Thing(
        "picture",
        picture,
        Expected("joined", some("Hook", *SCREWS, *PICTURE), below={"Frame": (some("Hook"), 0.5)}),
        Expected(None, some(*PICTURE), some(*PICTURE), below={"Frame": (some("floor"), 350.0)}),
    ),
)
"""The twelve things."""
