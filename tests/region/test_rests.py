"""How an assembly rests in the directions of its region, against closed forms."""

import numpy as np
import pytest
from balance_cases import CASES

import kilter
from kilter.assembly import Assembly
from kilter.errors import InputError
from kilter.scenes.pieces import block


def corner(mu: float = 0.0) -> Assembly:
    """A cube in the corner of three walls."""
    walls = [
        block("floor", [-1, -1, -1], [2, 2, 0], grounded=True),
        block("left", [-1, -1, 0], [0, 2, 2], grounded=True),
        block("back", [0, -1, 0], [2, 0, 2], grounded=True),
    ]
    return Assembly([*walls, block("cube", [0, 0, 0], [1, 1, 1])]).with_friction(mu)


@pytest.mark.slow
def test_a_cube_in_a_corner_is_v_shaped_about_its_axis() -> None:
    """The nearest wall is arcsin(1 / sqrt 3) away; no curvature is asked for."""
    axis, *edges = kilter.region(corner(), rests=True).rests
    assert axis.down == pytest.approx(-np.ones(3) / np.sqrt(3))
    assert (axis.state, axis.rate) == ("minimum", None)
    assert axis.tilt_deg == pytest.approx(np.degrees(np.arcsin(1 / np.sqrt(3))))
    assert len(edges) == 3
    for edge in edges:
        assert (edge.state, edge.tilt_deg, edge.moving) == ("free", pytest.approx(0), ("cube",))


@pytest.mark.slow
@pytest.mark.parametrize("wall", [[1, 0, 0], [0, 1, 0], [0, 0, 1]])
def test_up_to_its_tilt_it_stays_and_beyond_it_moves(wall: list[int]) -> None:
    rest = kilter.region(corner(), rests=True).rests[0]
    assert rest.tilt_deg is not None
    across = wall - (wall @ rest.down) * rest.down
    across /= np.linalg.norm(across)
    for by, verdict in ((-1e-3, "stable"), (1e-3, "unstable")):
        angle = np.radians(rest.tilt_deg) + by
        down = np.cos(angle) * rest.down + np.sin(angle) * across
        assert kilter.check(corner().with_down(down)).verdict == verdict


@pytest.mark.slow
@pytest.mark.parametrize(
    ("number", "state"), [("01", "free"), ("02", "balanced"), ("03", "minimum"), ("05", "free")]
)
def test_what_is_round_rests_as_a_check_says(number: str, state: str) -> None:
    assembly = next(case for case in CASES if case.number == number).build(0.0)
    rests = kilter.region(assembly, rests=True).rests
    at = [rest for rest in rests if np.allclose(rest.down, assembly.down, atol=1e-9)]
    straight = at or [rests[0]]
    assert straight[0].state == state
    assert straight[0].strict == (state == "minimum")


def test_a_ball_in_a_bowl_has_no_width_but_swings_as_a_pendulum_does() -> None:
    """Of length R - r: the well is curved, and to first order any tilt is too much."""
    bowl = next(case for case in CASES if case.number == "03").build(0.0)
    (rest,) = kilter.region(bowl, rests=True).rests
    assert (rest.tilt_deg, rest.moving) == (0.0, ())
    assert rest.rate == pytest.approx(np.sqrt(9.81 / 0.6), rel=1e-6)


def test_friction_is_refused() -> None:
    with pytest.raises(InputError, match="only without friction"):
        kilter.region(corner(0.3), rests=True)


def test_nothing_is_told_that_was_not_asked() -> None:
    assert kilter.region(corner()).to_dict()["rests"] == []


def test_where_no_direction_is_stable_there_is_no_rest() -> None:
    floating = [
        block("held", [0, 0, 0], [1, 1, 1], grounded=True),
        block("b", [3, 0, 0], [4, 1, 1]),
    ]
    answer = kilter.region(Assembly(floating), rests=True)
    assert (answer.kind, answer.rests) == ("none", ())
