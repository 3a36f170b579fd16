"""Orders in which what stands is turned: fewest turns, proved at both ends of each."""

from __future__ import annotations

import numpy as np
import pytest
from read_proofs import proof_of, reasons
from slopes import leaning

import kilter
from kilter import Assembly, InputError
from kilter.analysis.planning.order.turning import common_down
from kilter.analysis.planning.states.states import states
from kilter.scenes import scene
from kilter.scenes.pieces import block

FIRST = [("A", "B")]
"""What leans comes before what it leans on."""


@pytest.mark.slow
def test_turned_once_where_it_would_slide() -> None:
    """A alone slides off; level it stands, and with B in it is turned back."""
    made = leaning(30.0)
    assert kilter.plan(made, kilter.PlanRules(before=FIRST, hold=0)).verdict == "impossible"
    order = kilter.plan(made, kilter.PlanRules(before=FIRST, turn=True))
    assert (order.verdict, order.turns, order.holds_max) == ("found", 1, 0)
    assert [step.part for step in order.steps] == ["A", "B"]
    downs = [step["down"] for step in order.to_dict()["steps"]]
    assert np.allclose(downs[1], [0, 0, -1])
    proof = proof_of(order)
    assert not reasons(order, proof)
    assert "with nothing held, turned once." in order.to_dict()["sentence"]


@pytest.mark.quick(1)
@pytest.mark.parametrize(("share", "turns"), [(1.01, 0), (0.99, 1)])
def test_no_turn_where_friction_holds(share: float, turns: int) -> None:
    made = leaning(30.0, share * np.tan(np.radians(30.0)))
    order = kilter.plan(made, kilter.PlanRules(before=FIRST, turn=True))
    assert (order.turns, order.holds_max) == (turns, 0)
    assert not reasons(order, proof_of(order))


@pytest.mark.quick(2)
@pytest.mark.parametrize("change", ["left out", "elsewhere", "forbidden"])
def test_turns_that_are_not_proved_are_refused(change: str) -> None:
    order = kilter.plan(leaning(30.0), kilter.PlanRules(before=FIRST, turn=True))
    proof = proof_of(order)
    [turned] = [one for one in proof["proofs"] if one["about"] == "turned"]
    if change == "left out":
        proof["proofs"].remove(turned)
        why = "the turned parts are not proved to hold before the turn"
    elif change == "elsewhere":
        turned["change"]["down"] = [0.0, 0.1, -1.0]
        why = "the turn starts from another direction"
    else:
        proof["rules"]["turn"] = False
        why = "it has turns, but its rules do not allow turns"
    assert why in reasons(order, proof)


def test_a_common_direction_of_two_slopes() -> None:
    """A slides by any lean; the two together by one away from the stop."""
    made = states(leaning(30.0))
    whole = made.of().program
    alone = made.of(["bed", "stop", "A"]).program
    down = common_down([whole, alone])
    assert down is not None
    assert np.allclose(down, [0, 0, -1], atol=1e-9)
    assert common_down([whole]) is not None


def test_what_needs_no_turn_has_none() -> None:
    order = kilter.plan(scene("tower"), kilter.PlanRules(turn=True))
    assert (order.turns, len(order.steps)) == (0, 5)


@pytest.mark.parametrize(("fewest", "turns", "held"), [("holds", 1, 0), ("turns", 0, 1)])
def test_a_hold_in_place_of_a_turn(fewest: str, turns: int, held: int) -> None:
    order = kilter.plan(leaning(30.0), kilter.PlanRules(before=FIRST, turn=True, fewest=fewest))
    assert (order.turns, order.holds_max, order.fewest.least) == (turns, held, "always")
    assert not reasons(order, proof_of(order))


@pytest.mark.parametrize(("degrees", "turns"), [(29.9, 0), (30.1, 1)])
def test_a_turn_from_the_angle_of_friction_on(degrees: float, turns: int) -> None:
    """On a slope a block slides where its angle is more than arctan mu."""
    made = leaning(degrees, np.tan(np.radians(30.0)))
    order = kilter.plan(made, kilter.PlanRules(before=FIRST, fewest="turns", hold=0))
    assert (order.turns, order.fewest.least) == (turns, "as-tried" if turns else "always")


@pytest.mark.slow
def test_of_two_turns_it_is_open_whether_they_are_the_fewest() -> None:
    """A asks for no lean along x; C for one of more than .4, and none along y; the whole for both.

    C lies with its middle .2 left of a pillar and leans on a wall up to .5 above its middle.
    """
    made = Assembly(
        [
            block("bed", [-3, -2, -1], [6, 4, 0], grounded=True),
            block("stop-x", [2, 0, 0], [3, 1, 1], grounded=True),
            block("wall-x", [0, 1, 0], [2, 2, 1], grounded=True),
            block("A", [0, 0, 0], [1, 1, 1]),
            block("B", [1, 0, 0], [2, 1, 1]),
            block("pillar", [0.7, -10, -1], [1, -8, 0], grounded=True),
            block("stop-y", [0, -8, 0], [1, -7, 1], grounded=True),
            block("wall-y", [1, -10, 0], [2, -8, 1], grounded=True),
            block("C", [0, -10, 0], [1, -9, 1]),
            block("D", [0, -9, 0], [1, -8, 1]),
        ],
        gravity=[4.0, 4.0, -8.0],
    )
    chain = [*FIRST, ("B", "C"), ("C", "D")]
    order = kilter.plan(made, kilter.PlanRules(before=chain, fewest="turns", hold=0))
    assert (order.turns, order.fewest.least) == (2, None)
    downs = [step["down"] for step in order.to_dict()["steps"]]
    assert downs[0][0] == pytest.approx(0, abs=1e-9)
    assert downs[3][0] > -0.4 * downs[3][2]
    assert downs[3][1] == pytest.approx(0, abs=1e-9)
    assert not reasons(order, proof_of(order))


def test_what_goes_not_with_turns() -> None:
    with pytest.raises(InputError, match="turns cannot be combined with"):
        kilter.plan(scene("tower"), kilter.PlanRules(turn=True, press=1.0))
    with pytest.raises(InputError, match="turns cannot be combined with"):
        kilter.plan(scene("tower"), kilter.PlanRules(fewest="turns", press=1.0))
