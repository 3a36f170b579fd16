"""What is held to first order, by its forces alone: nothing else is asked."""

from __future__ import annotations

import copy

import numpy as np
import pytest
from places import case_of, side_by_side

import kilter
from kilter import Assembly, Feature, GivenContact, Part, Pose
from kilter.analysis.neutral import find_neutral
from kilter.mechanics.program import Program, build_program
from kilter.mechanics.proof import digest_of
from kilter.scenes import scene
from kilter.scenes.walls import wall_of
from kilter.second_order import critical, level_rest_search, whole
from kilter.second_order.held import Held, find_held, judge_held
from kilter.shape.primitives import Box

Z = np.array([0.0, 0.0, 1.0])


def coupling(turns: tuple[float, float, float]) -> Assembly:
    """Maxwell's coupling: three balls of a plate, each in a groove of right angle.

    The grooves lie at 0, 120 and 240 degrees and run in the given directions.
    """
    parts = [
        Part("base", Box([1, 1, 1]), Pose([0, 0, -2]), grounded=True),
        Part("b", Box([1, 1, 1]), Pose([0, 0, 0.3]), mass=2.0),
    ]
    contacts = []
    for k, turn in enumerate(turns):
        at = np.array([np.cos(2 * np.pi * k / 3), np.sin(2 * np.pi * k / 3), 0])
        side = np.array([-np.sin(turn), np.cos(turn), 0])
        for sense in (1, -1):
            n = (Z + sense * side) / np.sqrt(2)
            feature = (Feature("face"), Feature("face", curvature=10.0))
            contacts.append(GivenContact(("base", "b"), [at - 0.1 * n], n, feature=feature))
    return Assembly(parts, contacts=contacts, detect=False)


RADIAL = (0.0, 2 * np.pi / 3, 4 * np.pi / 3)


def program_of(assembly: Assembly) -> Program:
    return build_program(assembly, kilter.contacts(assembly)).frictionless


def test_grooves_towards_the_middle_hold_a_plate() -> None:
    """Six equal forces of m g / (6 cos 45), and nothing moves."""
    program = program_of(coupling(RADIAL))
    force = 2.0 * 9.81 / (6 * np.sqrt(0.5))
    assert judge_held(program, Held(np.full(6, force))) == ""
    assert judge_held(program, Held(np.full(6, force * (1 + 1e-6))))
    assert kilter.check(coupling(RADIAL)).second_order is None


@pytest.mark.parametrize("turn", [1e-2, -1e-2])
def test_parallel_grooves_do_not_and_nearly_parallel_ones_do(turn: float) -> None:
    assert judge_held(program_of(coupling((0.0, 0.0, 0.0))), Held(np.full(6, 1.0)))
    across = program_of(coupling((0.0, 0.0, 0.0)))
    force = np.full(6, 2.0 * 9.81 / (6 * np.sqrt(0.5)))
    assert "neutral" in judge_held(across, Held(force))
    assert judge_held(program_of(coupling((0.0, turn, -turn))), Held(force)) == ""


def test_forces_that_leave_a_contact_free_are_spread() -> None:
    """Of a box in a corner, tilted, four rows a face: three forces balance it, all hold it."""
    program = program_of(coupling(RADIAL))
    given = np.full(6, 2.0 * 9.81 / (6 * np.sqrt(0.5)))
    found = find_held(program, given)
    assert found is not None
    twice = program.taking(np.repeat(np.arange(6), 2))
    lean = np.tile([1.0, 0.0], 6) * np.repeat(given, 2)
    assert find_held(twice, lean) is not None
    assert find_held(program.taking(np.arange(5)), given[:5]) is None


@pytest.mark.parametrize("name", ["corner-wedges", "pit", "closed-frame", "stopped-groove"])
def test_where_nothing_is_neutral_no_gap_is_asked(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(whole, "features_of", None)
    monkeypatch.setattr(whole, "find_critical", None)
    verdict = kilter.check(scene(name))
    assert verdict.second_order is None
    counted = find_neutral(verdict.program)
    assert counted is not None
    assert counted.two_sided == counted.one_sided == 0


@pytest.mark.parametrize("bricks", [1, 105])
def test_a_wall_asks_no_gap_and_no_program(bricks: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(whole, "features_of", None)
    for module in (critical, level_rest_search):
        monkeypatch.setattr(module, "carrying_forces", None)
    second = kilter.check(wall_of(bricks)).second_order
    assert second is not None
    assert second.state == "free"


def test_what_is_held_beside_others_has_its_proof() -> None:
    row = side_by_side([coupling(RADIAL), case_of("03").build(0.0), coupling(RADIAL)])
    second = kilter.check(row).second_order
    assert second is not None
    assert [one.neutral for one in second.clusters] == [0, 5, 0]
    assert second.state == "minimum"
    assert second.rate == pytest.approx(np.sqrt(9.81 / 0.6), rel=1e-6)
    proof = kilter.check(row).proof()
    assert kilter.verify(row, proof).holds
    entry = proof["second_order"]["clusters"][0]
    for key, value in (("held", entry["held"][:-1]), ("held", [0.0] * 6), ("neutral", 1)):
        other = copy.deepcopy(proof)
        other["second_order"]["clusters"][0][key] = value
        other["digest"] = digest_of(other)
        assert not kilter.verify(row, other).holds, key


@pytest.mark.parametrize("bad", [np.nan, np.inf, -1.0])
def test_forces_that_are_none_are_refused(bad: float) -> None:
    program = program_of(coupling(RADIAL))
    forces = np.full(6, 2.0 * 9.81 / (6 * np.sqrt(0.5)))
    forces[2] = bad
    assert judge_held(program, Held(forces))


def over_the_edge(foot: float, off: float) -> Assembly:
    """A block on four points, pinned across at its centre, which is `off` within their edge."""
    parts = [
        Part("base", Box([1, 1, 1]), Pose([0, 0, -1]), grounded=True),
        Part("b", Box([1, 1, 1]), Pose([0, 0, 0.5])),
    ]
    corners = [[x, y, 0.0] for x in (off, off - foot) for y in (-0.4, 0.4)]
    given = [GivenContact(("base", "b"), [at], Z) for at in corners]
    for axis in (0, 1):
        for sense in (1.0, -1.0):
            given.append(GivenContact(("base", "b"), [[0, 0, 0.5]], sense * np.eye(3)[axis]))
    for sense in (1.0, -1.0):  # against a turn about the vertical
        given.append(GivenContact(("base", "b"), [[0.3, 0, 0.5]], [0, sense, 0]))
    return Assembly(parts, contacts=given, detect=False)


def forces_over_the_edge(program: Program, far: float) -> np.ndarray:
    """Of which the far points have this share of the weight, the near ones the rest."""
    weight = float(program.weight[1])
    pins = np.full(6, 0.1 * weight)
    return np.concatenate([np.repeat(weight * np.array([1 - far, far]) / 2, 2), pins])


@pytest.mark.parametrize("foot", [0.3, 0.05, 0.003])
@pytest.mark.parametrize("far", [1e-9, 2e-8, 1e-7, 1e-6])
def test_far_points_within_rounding_hold_nothing_that_is_over_an_edge(
    foot: float, far: float
) -> None:
    """The torque of a force at a short lever is soon within what may be out of balance."""
    program = program_of(over_the_edge(foot, 0.0))
    assert judge_held(program, Held(forces_over_the_edge(program, far)))
    off = 1e-4 * foot
    program = program_of(over_the_edge(foot, off))
    assert judge_held(program, Held(forces_over_the_edge(program, off / foot))) == ""
