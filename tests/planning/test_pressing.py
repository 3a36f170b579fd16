"""Parts that are pressed in: what stands has to take the force, in closed form on both sides."""

from __future__ import annotations

import numpy as np
import pytest
from read_proofs import proof_of, reasons

import kilter
from kilter import Assembly, InputError
from kilter.scenes import scene
from kilter.scenes.pieces import block

REACH, OUT = 3.0, 2.25
"""The plank reaches from -3 to 3 over an edge at 1; the weight stands at 2.25, over the void."""


def plank(*, weight: float = 1.0) -> Assembly:
    """A plank of 10 kg over an edge, and a weight on its free end."""
    return Assembly(
        [
            block("table", [-4, -1, -1], [1, 1, 0], grounded=True),
            block("plank", [-REACH, -1, 0], [REACH, 1, 0.5], mass=10.0),
            block("weight", [OUT - 0.25, -0.25, 0.5], [OUT + 0.25, 0.25, 1], mass=weight),
        ]
    )


def tipping() -> float:
    """The force on the weight at which the plank tips about the edge [N]."""
    g = float(np.linalg.norm(plank().gravity))
    return (10.0 * g * 1.0) / (OUT - 1.0) - 1.0 * g


@pytest.mark.parametrize("share", [0.99, 1.01])
def test_a_plank_tips_beyond_a_force(share: float) -> None:
    order = kilter.plan(
        plank(), kilter.PlanRules(press=share * tipping(), hold=0, directions=[[0, 0, 1]])
    )
    assert order.found == (share < 1)
    if order.found:
        assert not reasons(order, proof_of(order))


def test_a_hold_takes_what_the_plank_does_not() -> None:
    order = kilter.plan(plank(), kilter.PlanRules(press=1.01 * tipping(), directions=[[0, 0, 1]]))
    assert [step.held for step in order.steps] == [(), ("plank",)]
    proof = proof_of(order)
    assert not reasons(order, proof)
    [pressed] = [one for one in proof["proofs"] if one["about"] == "pressed" and one["step"] == 2]
    pressed["change"]["loads"][-1]["force"][2] *= 0.5
    assert "step 2: the proof has another pressing force" in reasons(order, proof)


@pytest.mark.slow
def test_a_proof_without_its_pressed_states_is_refused() -> None:
    order = kilter.plan(scene("tower"), kilter.PlanRules(press=5.0))
    proof = proof_of(order)
    assert not reasons(order, proof)
    proof["proofs"] = [one for one in proof["proofs"] if one["about"] != "pressed"]
    assert "not every step has a proof with the pressing force" in reasons(order, proof)


def test_a_sequence_says_where_it_cannot_be_pressed() -> None:
    order = kilter.plan(
        plank(),
        kilter.PlanRules(
            press=1.01 * tipping(), hold=0, directions=[[0, 0, 1]], sequence=["plank", "weight"]
        ),
    )
    assert [step.fails for step in order.steps] == [
        (), ("the standing parts do not withstand the pressing force",)
    ]  # fmt: skip


def test_no_force_is_none() -> None:
    assert all(step.pressed is None for step in kilter.plan(scene("tower")).steps)
    with pytest.raises(InputError, match="press"):
        kilter.plan(scene("tower"), kilter.PlanRules(press=-1.0))
