"""Data of the page for the fall of a balanced assembly."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from kilter import Assembly, Box, Cylinder, Part, Pose, Sphere
from kilter.analysis.everything import everything
from kilter.arrays import Array
from kilter.scenes import scene
from kilter.show.packing import unpack
from kilter.show.scene import build_scene


def array(packed: dict[str, str]) -> Array:
    return unpack(packed).astype(float)


def fall_of(assembly: Assembly) -> dict[str, Any] | None:
    found: dict[str, Any] | None = build_scene(everything(assembly))["given"]["fall"]
    return found


@pytest.mark.slow
def test_its_energy_is_in_joules_whatever_the_unit_of_length() -> None:
    base = Part("base", Sphere(100.0), grounded=True)
    aside = Part("aside", Sphere(10.0), Pose([900, 0, 0]), grounded=True)
    ball = Part("ball", Sphere(50.0), Pose([0, 0, 150]), mass=2.0)
    fall = fall_of(Assembly([base, aside, ball], units="mm"))
    assert fall is not None
    assert fall["parts"] == [2]
    places = fall["places"]
    heights = array(places["motions"]).reshape(-1, 1, 6)[:, 0, 2]
    energies = array(places["energies"])
    assert heights[-1] < -20
    np.testing.assert_allclose(energies, 2.0 * 9.81 * heights / 1000, rtol=1e-5, atol=1e-9)
    assert array(places["lengths"])[-1] > 90
    assert fall["words"].startswith("balanced: the slightest push makes ball fall")


@pytest.mark.slow
@pytest.mark.parametrize(("thick", "friction"), [(0.6, "holds"), (1.4, "falls")])
def test_it_says_what_friction_makes_of_it(thick: float, friction: str) -> None:
    """A board on a roller rolls back if its centre is at most the radius above the roller."""
    lying = Pose.of([[1, 0, 0], [0, 0, -1], [0, 1, 0]]).rotation
    roller = Part("roller", Cylinder(0.5, 2.0), Pose([0, 0, 0], lying), grounded=True)
    board = Part("board", Box([3, 1, thick]), Pose([0, 0, 0.5 + thick / 2]))
    fall = fall_of(Assembly([roller, board], friction=0.8))
    assert fall is not None
    assert fall["friction"] == friction
    assert fall["places"] is not None


@pytest.mark.slow
def test_what_is_not_balanced_has_none() -> None:
    assert fall_of(scene("tower")) is None
