"""Margin, region, orient and plan share the open pairs that the first question found to decide."""

from __future__ import annotations

from math import inf

import numpy as np
import pytest
from margins import program_of
from staggered_dome import staggered_dome

import kilter
from kilter import Assembly, Box, Part, Pose
from kilter.analysis.margins import margin_steps
from kilter.analysis.margins.least_friction import Failing, LeastFriction, find_least_friction
from kilter.analysis.planning.states import states as states_module
from kilter.analysis.regions import region as region_module
from kilter.mechanics.certificate import check_forces, check_motion
from kilter.scenes import stacks
from kilter.tell.text import text_of

TANGENT = float(np.tan(np.radians(20.0)))
"""Least friction of a block on a slope of 20 deg."""


def sunk() -> Assembly:
    """A cube that overlaps its table by a twentieth of its size: this pair decides."""
    table = Part("table", Box([4, 4, 1]), Pose([0, 0, -0.5]), grounded=True)
    return Assembly([table, Part("cube", Box([1, 1, 1]), Pose([0, 0, 0.45]))])


@pytest.mark.parametrize("most", [1, 3])
def test_the_least_friction_of_a_short_search_lies_between_its_proofs(most: int) -> None:
    slope = program_of(stacks.block_on_slope(20.0))
    found = find_least_friction(slope, programs=most)
    assert isinstance(found, LeastFriction)
    assert found.lower < TANGENT <= found.value * (1 + 1e-9)
    held = slope.with_friction(found.value)
    assert check_forces(held, found.forces.forces, found.forces.friction).holds
    assert found.motion is not None
    assert check_motion(slope.with_friction(found.lower), found.motion.motion).holds
    assert found.programs == 4 + most


def test_a_known_coefficient_that_fails_is_where_the_search_begins() -> None:
    slope = program_of(stacks.block_on_slope(20.0))
    whole = find_least_friction(slope)
    assert isinstance(whole, LeastFriction)
    assert whole.motion is not None
    known = Failing(whole.lower, whole.motion)
    none = find_least_friction(slope, failing=known, programs=0)
    assert isinstance(none, LeastFriction)
    assert (none.lower, none.programs) == (whole.lower, 5)
    again = find_least_friction(slope, failing=known, programs=inf)
    assert isinstance(again, LeastFriction)
    assert again.value == pytest.approx(TANGENT, rel=1e-7)


def test_the_margin_of_a_large_drawing_that_falls_uses_the_motion_of_the_verdict(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    slope = stacks.block_on_slope(20.0, friction=0.3)
    usual = kilter.margin(slope)
    monkeypatch.setattr(margin_steps, "LARGE", 0)

    def not_called(*arguments: object) -> None:
        raise AssertionError("the verdict has decided that no tilt margin exists")

    monkeypatch.setattr(margin_steps, "find_tilt_margin", not_called)
    large = kilter.margin(slope)
    assert large.tilt_deg == usual.tilt_deg
    assert large.tilt_deg is not None
    assert large.friction is not None
    assert large.friction_limit.lower >= 0.3
    assert large.friction == pytest.approx(TANGENT, rel=1e-7)


def test_a_large_region_is_undecided_by_one_joined_direction(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    whole = kilter.region(sunk())
    assert whole.if_joined is not None
    assert whole.pairs_decide
    monkeypatch.setattr(region_module, "LARGE", -1)
    large = kilter.region(sunk())
    assert (large.if_joined, large.joined_holds, large.pairs_decide) == (None, True, True)
    assert "forces that hold it exist for gravity as given" in text_of(large.to_dict())
    answer = kilter.orient(sunk())
    assert (answer.verdict, answer.nearest, answer.check) == ("undecided", None, None)
    assert "'table' and 'cube'" in answer.sentence
    assert "quaternion" in text_of(answer.to_dict())


def test_a_large_region_that_joined_pairs_do_not_hold_is_computed_in_full(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Beside the sunk cube another cube falls freely, whatever is joined."""
    alone = Part("alone", Box([1, 1, 1]), Pose([0, 0, 3.0]))
    assembly = Assembly([*sunk().parts, alone])
    monkeypatch.setattr(region_module, "LARGE", -1)
    large = kilter.region(assembly)
    assert large.if_joined is not None
    assert not large.joined_holds
    assert not large.pairs_decide


def test_a_plan_asks_once_which_pairs_decide(monkeypatch: pytest.MonkeyPatch) -> None:
    calls = []
    decide = states_module.decide

    def counted(*arguments: object, **options: object) -> object:
        calls.append(options["question"])
        return decide(*arguments, **options)

    monkeypatch.setattr(states_module, "decide", counted)
    order = kilter.plan(staggered_dome(2, rings=2, per_ring=8))
    assert calls == [True]
    assert order.verdict == "undecided"
    assert order.decision.question is not None
