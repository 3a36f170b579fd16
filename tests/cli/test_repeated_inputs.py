"""Numbers of an answer that repeat its question: each as it was asked, in the unit of its file."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import reduce
from typing import Any

import pytest

import kilter
from kilter import Assembly, Bond, Box, Load, Part, PlanRules, Strap
from kilter.contact import Tolerance
from kilter.scenes.pieces import block

BASE = block("base", [-500, -500, -10], [500, 500, 0], grounded=True)
BOX = Part("box", Box([100, 200, 30]), [0, 0, 15], density=1234.0)
MORE = Part("more", Box([10, 10, 10]), [200, 0, 5])
PLAIN = Assembly([BASE, BOX], units="mm", friction=0.5, gravity=[0, 0, -3.7])
BONDED = Assembly(
    [BASE, BOX, Part("top", Box([50, 50, 50]), [0, 0, 55], mass=0.3)],
    units="mm",
    bonds=[Bond(("base", "box"), pull=7.0, shear=3.0), Bond(("box", "top"), pull_per_area=0.02)],
)
ANCHORED = Strap([("ground", [400, 0, 15]), ("box", [50, 0, 15])], tension=12.5)
PUSH = Load("box", force=[-11, 0, 0])
STRAPPED = Assembly([BASE, BOX], units="mm", friction=0.5, straps=[ANCHORED])
CASES: dict[str, tuple[Callable[[], Any], dict[str, Any]]] = {
    "check": (
        lambda: kilter.check(
            PLAIN.with_parts([MORE]), tolerance=Tolerance(gap=0.02, angle=0.01, clearance=0.3)
        ),
        {
            "gravity": [0, 0, -3.7], "down": [0, 0, -1],
            "density.given": [1234, 1234], "density.default": 1000, "tolerance.gap": 0.02,
            "tolerance.angle_deg": 0.5729577951308232, "tolerance.clearance": 0.3,
        },
    ),
    "check of bonds": (
        lambda: kilter.check(BONDED),
        {
            "bonds.0.pull": 7, "bonds.0.shear": 3, "bonds.1.pull_per_area": 0.02,
            "bonds.1.shear": None,
        },
    ),
    "check at an effort": (
        lambda: kilter.check(PLAIN, down=[0.2, 0, -1], effort=0.3, require="proved"),
        {"friction.effort": 0.3, "down": [0.19611613513818404, 0, -0.9805806756909202]},
    ),
    "margin": (lambda: kilter.margin(PLAIN, pushed=[]), {"down": [0, 0, -1]}),
    "plan": (
        lambda: kilter.plan(
            PLAIN, PlanRules(press=2.5, directions=[[0, 0, 1]], carried=[0.1, 0.2, 0])
        ),
        {
            "assumes.press": 2.5, "assumes.directions.0": [0, 0, 1],
            "assumes.carried": [0.1, 0.2, 0], "steps.0.down": [0, 0, -1],
        },
    ),
    "hold": (
        lambda: kilter.hold(replace(STRAPPED, straps=[], loads=[PUSH]), straps=[ANCHORED]),
        {"straps.0.tension": 12.5, "straps.0.candidate": 1},
    ),
    "settle": (lambda: kilter.settle(PLAIN, reach=2.25), {"reach": 2.25}),
    "place": (
        lambda: kilter.place(PLAIN, replace(BOX, name="next"), center_within=0.125, mass=[1, 2]),
        {"center_within": 0.125, "mass": [1, 2]},
    ),
    "transport": (
        lambda: kilter.transport(STRAPPED, polar=False),
        {"straps.0.tension": 12.5, "straps.0.capacity": None, "gravity": 9.81, "down": [0, 0, -1]},
    ),
    "transport under a code": (
        lambda: kilter.transport(PLAIN, code="en12195", forward=[0, 1, 0]),
        {"forward": [0, 1, 0], "cases.0.acceleration": [0, -0.8 * 3.7, 0]},
    ),
    "hold under a code": (
        lambda: kilter.hold(
            replace(STRAPPED, straps=[]), straps=[ANCHORED], code="en12195", forward=[-1, 0, 0]
        ),
        {"cases.0.acceleration": [0.8 * 9.81, 0, 0]},
    ),
    "collapse": (lambda: kilter.transport(PLAIN, collapse=True, fc=1.2), {"fc": 1.2}),
    "verify": (
        lambda: kilter.verify(PLAIN, kilter.check(PLAIN).proof()), {"gravity": [0, 0, -3.7]},
    ),
}  # fmt: skip


@pytest.mark.quick(3)
@pytest.mark.parametrize("name", CASES)
def test_a_number_of_the_question_is_repeated_as_asked(name: str) -> None:
    ask, expected = CASES[name]
    answer = ask().to_dict()
    for path, value in expected.items():
        steps = [int(step) if step.isdigit() else step for step in path.split(".")]
        found = reduce(lambda data, step: data[step], steps, answer)
        assert found == pytest.approx(value, abs=1e-15), path
