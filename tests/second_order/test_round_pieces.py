"""Exact separation of solids of balls and cylinders; such a solid balances high on a ball."""

from dataclasses import replace

import numpy as np
import pytest
from lathe import turned_part

import kilter
from kilter.assembly import Assembly, Part
from kilter.assembly.lowest import lowest_heights
from kilter.rigid import Pose, turn_of
from kilter.scenes.pieces import floor
from kilter.second_order.parts.separation import bodies_of

UP = np.array([0.0, 0.0, 1.0])
LIMIT = 1 / np.sqrt(2)


def roly_poly(height: float) -> Part:
    return turned_part("b", [(0, 0), (1, 1, 0, 1), (1, 1 + height), (0, 1 + height)])


CAPSULE = turned_part("b", [(0, 0), (1, 1, 0, 1), (1, 2), (0, 3, 0, 2)])


def on_table(part: Part) -> Assembly:
    return Assembly([floor([-8, -8], [8, 8]), part])


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    ("part", "state"),
    [
        (roly_poly(LIMIT - 1e-3), "free"),
        (roly_poly(LIMIT + 1e-3), "balanced"),
        (CAPSULE, "balanced"),
    ],
    ids=["below", "above", "capsule"],
)
def test_a_roly_poly_stands_up_to_r_over_root_two_and_falls_beyond(part: Part, state: str) -> None:
    assembly = on_table(part)
    verdict = kilter.check(assembly)
    assert verdict.second_order_answer is not None
    assert verdict.second_order_answer.state == state
    assert kilter.verify(assembly, verdict.proof()).holds
    if state == "balanced":
        configuration = verdict.second_order_answer.configuration
        assert configuration is not None
        shift, turn = configuration.motion[1, :3], turn_of(configuration.motion[1, 3:])
        # the lowest point of the exact body, turned, lies over the table, and its centre is lower
        geometry = assembly.geometry
        center = geometry.center[1]
        lowest = float(lowest_heights(geometry, turn.T @ UP)[1] - center @ (turn.T @ UP))
        assert lowest + float((center + shift) @ UP) > 0
        assert shift @ UP < 0


def test_pieces_hold_every_corner_of_the_part() -> None:
    for part in (roly_poly(0.5), CAPSULE):
        assembly = Assembly([Part("b", part.shape, Pose([1, 2, 3]))])
        pieces = bodies_of(assembly, 0)
        assert pieces is not None
        n = np.random.default_rng(0).normal(size=(200, 3))
        n /= np.linalg.norm(n, axis=1)[:, None]
        reach = np.max([one.reach(n) for one in pieces], axis=0)
        assert (reach >= (assembly.geometry.vertices @ n.T).max(axis=0) - 1e-12).all()


@pytest.mark.parametrize(
    "profile",
    [
        [(0, 0), (1, 0), (0, 2)],  # a cone
        [(0, 0), (1, 0), (1, 2), (0.9, 2), (0.9, 0.1), (0, 0.1)],  # a cup
    ],
    ids=["cone", "cup"],
)
def test_what_they_do_not_hold_has_no_answer(profile: list[tuple[float, ...]]) -> None:
    assert bodies_of(Assembly([turned_part("b", profile)]), 0) is None


def test_a_flat_face_beyond_them_has_no_answer() -> None:
    solid = roly_poly(1.0).shape
    corners = solid.vertices.copy()
    spike = int(np.argmax(corners[:, 2] - np.linalg.norm(corners[:, :2], axis=1)))
    for height, known in ((2.0, True), (2.5, False)):
        corners[spike, 2] = height
        part = Part("b", replace(solid, vertices=corners))
        assert (bodies_of(Assembly([part]), 0) is not None) == known
