"""A true proof of each kind, and the judge of its assembly."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
from balance_cases import GRIP, ROLLING
from mesh_rounds import as_mesh, ball
from places import case_of, side_by_side
from test_answer import BALL, FLOOR, WALL
from test_held import RADIAL, coupling
from test_stopped import STOP, overhanging

import kilter
from kilter import Assembly, Box, Feature, GivenContact, Part, Pose, Sphere
from kilter.mechanics.program import build_program
from kilter.scenes.paper import figure_9
from kilter.second_order.proofs.second_order_recheck import recheck_second_order

BLOCK = Part("block", Box([1, 1, 1]), Pose([4, 0, 0.5]))
LOW = Part("low", Sphere(0.5), Pose([0, 0, 0.5]), grounded=True)
TOP = Part("top", Sphere(0.5), Pose([0, 0, 1.5]))
BEHIND = Part("behind", Box([10, 1, 10]), Pose([0, -1.5, 5]), grounded=True)
AROUND = [
    Part(f"wall {k}", Box([0.2, 3, 1] if k < 2 else [1.6, 0.2, 1]), Pose([*at, 0.5]))
    for k, at in enumerate([(-0.9, 0), (0.9, 0), (0, -0.9), (0, 0.9)])
]
INSIDE = Pose([0, 0, 0.8])
HANDLE = GivenContact(("wall", "ball"), [[0, -1, 1]], [1, 0, 0])
"""A contact with unknown features; a spin of the ball opens it."""
POST = Part("post", Box([1, 1, 3]), Pose([-1, 0, 1.5]), grounded=True)
GIVEN = GivenContact(
    ("post", "top"),
    [[-0.5, 0, 1.5]],
    [1, 0, 0],
    feature=(Feature("face"), Feature("face", curvature=2)),
)
LYING = GivenContact(
    ("floor", "ball"),
    [[0, 0, 0]],
    [0, 0, 1],
    feature=(Feature("face", [0, 1, 0], (0, -0.5)), Feature("face", [1, 0, 0], (1, 0.5))),
)
"""A trough and a body of equal or larger curvature: the energy is level to second order."""
NEAR = Part("near", Sphere(0.1), Pose([-0.605, 0, 1.5]), grounded=True)
"""A ball 5 mm from the upper ball."""
RIGHT = Pose([2, 0, 1])
EDGED = [("a", Pose([-0.5, -0.5, 0.5])), ("b", Pose([0.5, 0.5, 0.5]))]
BLANK = GivenContact(("wall", "b"), [[-1, 0, 1]], [1, 0, 0])
FORCE = 2.0 * 9.81 / (6 * np.sqrt(0.5))
HELD = {"state": "minimum", "neutral": 0, "free": 0, "held": [FORCE] * 6}


def in_a_bowl() -> Assembly:
    return case_of("03").build(0.0)


def in_a_bowl_at_a_wall() -> Assembly:
    """A ball in a bowl at a wall with unknown features."""
    bowl = in_a_bowl()
    touch = GivenContact(("base", "b"), [[-0.7, 0, 0.7]], [1, 0, 0])
    return Assembly(bowl.parts, contacts=[*bowl.contacts, touch], detect=False)


def side_by_side_of(known: Assembly, *, unknown: Assembly) -> Assembly:
    """Two cases side by side; the contacts of the second have unknown features."""
    row = side_by_side([known, unknown])
    contacts = [
        one if one.parts[1].startswith("0-") else GivenContact(one.parts, one.points, one.normal)
        for one in row.contacts
    ]
    return Assembly(row.parts, contacts=contacts, detect=False)


def rolling(number: str, off: float) -> Assembly:
    case = next(case for case in ROLLING if case.number == number)
    return case.build((case.limit or 0.0) + off)


def rubbing(*made: Assembly) -> Assembly:
    row = side_by_side(made)
    return Assembly(row.parts, contacts=row.contacts, friction=GRIP, detect=False)


BUILD: dict[str, Callable[[], Assembly]] = {
    "held": lambda: coupling(RADIAL),
    "level": lambda: Assembly([FLOOR, BLOCK]),
    "locked": figure_9,
    "stopped": lambda: overhanging(STOP),
    "minimum": in_a_bowl,
    "cones": lambda: case_of("39").build(0.45),
    "rolls": lambda: Assembly([FLOOR, BALL]),
    "idle": lambda: Assembly([FLOOR, WALL, BALL]),
    "unknown": in_a_bowl_at_a_wall,
    "path": lambda: case_of("02").build(0.0),
    "place": lambda: Assembly([LOW, TOP]),
    "mesh": lambda: Assembly([LOW, as_mesh(ball(0.5, 24, [0, 0, 1.5], [0, 0, 0.2]))]),
    "joined": lambda: side_by_side([case_of(number).build(0.0) for number in ("03", "07")]),
    "worst": lambda: side_by_side([case_of(number).build(0.0) for number in ("02", "03")]),
    "board": lambda: rolling("R1", -0.1),
    "plane": lambda: Assembly([FLOOR, replace(BLOCK, pose=Pose([0, 0, 0.5]))], planar=True),
    "mixed": lambda: side_by_side([coupling(RADIAL), in_a_bowl()]),
    "half": lambda: side_by_side_of(case_of("02").build(0.0), unknown=in_a_bowl()),
    "corner": lambda: Assembly([FLOOR, WALL, BEHIND, BALL]),
    "together": lambda: Assembly([FLOOR, *AROUND, replace(BALL, shape=Sphere(0.8), pose=INSIDE)]),
    "odd": lambda: Assembly([FLOOR, WALL, BALL], contacts=[HANDLE]),
    "beside": lambda: Assembly([LOW, TOP, POST], contacts=[GIVEN]),
    "flat": lambda: Assembly([FLOOR, BALL], contacts=[LYING], detect=False),
    "near": lambda: Assembly([LOW, TOP, NEAR]),
    "pair": lambda: Assembly([FLOOR, WALL, BALL, replace(BALL, name="other", pose=RIGHT)]),
    "sharp": lambda: Assembly([FLOOR, *(replace(BLOCK, name=name, pose=at) for name, at in EDGED)]),
    "doubtful": lambda: Assembly(
        [FLOOR, WALL, as_mesh(ball(1.0, 24, [0, 0, 1]))], contacts=[BLANK]
    ),
    "boards": lambda: rubbing(rolling("R1", -0.1), rolling("R1", 0.1), in_a_bowl()),
}


@cache
def proved(kind: str) -> tuple[Callable[[Any], list[str]], dict[str, Any]]:
    """The judge of an assembly, and its proof of second order."""
    assembly = BUILD[kind]()
    contacts = kilter.contacts(assembly)
    program = build_program(assembly, contacts).frictionless
    data = kilter.check(assembly).proof().get("second_order")
    if kind == "held":  # nothing is neutral, and nothing said of it
        data = HELD
    return lambda given: recheck_second_order(assembly, contacts, program, given), data
