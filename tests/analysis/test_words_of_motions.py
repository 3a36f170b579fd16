"""Words of motions, against the motion that a body of this shape has."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

import kilter
from kilter.assembly import Load, Strap
from kilter.scenes.pieces import block, turn
from kilter.scenes.stacks import block_on_slope
from kilter.tell.words import motion_words

TABLE = block("table", [-5, -5, -1], [5, 5, 0], grounded=True)
ROUND = {
    "ball": (kilter.Part("ball", kilter.Sphere(0.5), [0, 0, 0.5]), 5 / 7),
    "roller": (
        kilter.Part(
            "roller", kilter.Cylinder(0.5, 1.0), kilter.Pose([0, 0, 0.5], turn([1, 0, 0], 90))
        ),
        2 / 3,
    ),
}


@pytest.mark.parametrize("name", ["ball", "roller"])
@pytest.mark.quick(1)
def test_a_round_part_on_a_rough_slope_rolls(name: str) -> None:
    """The centre accelerates by 5/7 of g sin for a ball, 2/3 for a cylinder."""
    part, share = ROUND[name]
    steep = np.arctan(1 / 3)
    down = [np.sin(steep), 0, -np.cos(steep)]
    assembly = kilter.Assembly([TABLE, part], friction=0.8).with_down(down)
    size = share * np.sin(steep)
    assert kilter.check(assembly).summary == f"{name} rolls down +x at {size:.4g} g"
    carried = kilter.transport(kilter.Assembly([TABLE, part], friction=0.8), polar=False)
    assert carried.to_dict()["limits"][0]["motion"][0]["words"] == "rolls"
    smooth = kilter.check(assembly.with_friction(0.0)).summary
    assert smooth == f"{name} slides down +x at {np.sin(steep):.4g} g"


def test_a_load_whose_strap_gives_way_slides_level() -> None:
    """The motion of the proof opens the sliding contact by mu times the slip; the words do not."""
    load = block("load", [0, 0, 0], [1, 1, 1])
    strap = Strap([("table", [0.5, 3, 0]), ("load", [0.5, 1, 1])], capacity=100.0)
    pushed = kilter.Assembly(
        [TABLE, load],
        friction=0.75,
        straps=[strap],
        loads=[Load("load", force=[0, -0.95 * 9810, 0])],
    )
    verdict = kilter.check(pushed)
    assert verdict.summary.startswith("load slides -y, ")
    assert any("is not modelled" in warning for warning in verdict.to_dict()["warnings"])


@pytest.mark.parametrize(("size", "words"), [(0.1, "12395"), (100.0, "12395"), (1e4, "12400")])
def test_points_of_axes_have_digits_relative_to_the_part(size: float, words: str) -> None:
    """A part of this size tips about its edge, far from the origin."""
    edge, spin = np.array([12395.0, 0.0, 50.0]), np.array([0.0, 6.0, 0.0])
    arm = np.array([size, 0.0, 0.0])
    linear = np.cross(spin, arm)
    relative = np.array([np.linalg.norm(linear), size * np.linalg.norm(spin)])
    told = motion_words(
        np.append(linear, spin), relative, np.array([0, 0, -1.0]), center=edge + arm, sizes=False
    )
    assert told.startswith(f"tips about +y through ({words}, 0, ")


@pytest.mark.parametrize("mu", [0.0, 0.2, 0.8])
def test_z_kappa_and_displacements_ignore_friction(mu: float) -> None:
    """A block on a slope of 30 degrees: kappa is sin 30 without friction, and z is -m sin 30."""
    slope = block_on_slope(30.0, friction=mu)
    answer = kilter.check(slope, measures=True).to_dict()
    mass = float(slope.geometry.mass[~slope.geometry.grounded].sum())
    assert answer["instability"] == pytest.approx(0.5, abs=1e-6)
    assert answer["z"] <= -0.5 * mass
    smooth = kilter.check(dataclasses.replace(slope, friction=0.0)).to_dict()
    assert answer["z"] == pytest.approx(smooth["z"], rel=1e-6)
    for part, other in zip(answer["parts"], smooth["parts"], strict=True):
        assert part["displacement"] == pytest.approx(other["displacement"], abs=1e-5)
