"""No order whatever the paths, by the states that every one would have to pass."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise, permutations

import numpy as np
import pytest
from read_proofs import Proof, proof_of, reasons, signed
from slopes import leaning

import kilter
from kilter import Order
from kilter.analysis.planning.order.exhaustion import MOST_SETS, leads_nowhere
from kilter.scenes.arches import arch

SLIDES = float(np.tan(np.radians(30.0)))
"""Friction with which what is not leaned on slides above 30 degrees [-]."""


def wrong(order: Order, change: Callable[[Proof], object] = lambda proof: None) -> str:
    """Why the proof does not hold once it is changed and signed anew."""
    proof = proof_of(order)
    change(proof)
    return reasons(order, signed(proof))


def from_both_sides(hold: int) -> Order:
    """An arch of nine of which left and right take turns: at most two must be held."""
    order = sorted(range(9), key=lambda k: min(k, 8 - k))
    chain = [(f"voussoir-{a}", f"voussoir-{b}") for a, b in pairwise(order)]
    return kilter.plan(arch(9, ratio=0.3, friction=0.6), kilter.PlanRules(before=chain, hold=hold))


@pytest.mark.slow
def test_an_arch_from_both_sides_needs_two() -> None:
    one = from_both_sides(1)
    assert (one.verdict, one.to_dict()["impossible"]["kind"]) == ("impossible", "exhaustion")
    assert not wrong(one)
    assert "with up to 1 part held no order exists" in one.to_dict()["sentence"]
    assert from_both_sides(2).verdict == "found"


@pytest.mark.parametrize(("degrees", "verdict"), [(29.9, "found"), (30.1, "impossible")])
def test_what_comes_first_slides_above_the_angle_of_friction(degrees: float, verdict: str) -> None:
    order = kilter.plan(leaning(degrees, SLIDES), kilter.PlanRules(before=[("A", "B")], hold=0))
    assert order.verdict == verdict
    assert not wrong(order)


def test_of_too_many_sets_nothing_is_said() -> None:
    most = MOST_SETS.bit_length() - 1
    assert leads_nowhere((1 << most) - 1, 0, lambda _, rest: rest != 0)
    assert not leads_nowhere((2 << most) - 1, 0, lambda _, rest: rest != 0)
    assert not leads_nowhere(0b11, 0, lambda _, rest: rest != 0b10)


@pytest.mark.parametrize("seed", range(20))
def test_chains_by_all_permutations(seed: int) -> None:
    count, whole = 5, 0b11111
    random = np.random.default_rng(seed)
    may = random.random(1 << count) < random.uniform(0.2, 0.7)
    may[0] = True
    chains = (
        all(may[whole & ~sum(1 << k for k in order[: n + 1])] for n in range(count))
        for order in permutations(range(count))
    )
    assert leads_nowhere(whole, 0, lambda _, rest: bool(may[rest])) != any(chains)


@pytest.mark.quick("precedence", "free", "turn")
@pytest.mark.parametrize("change", ["left out", "free", "held more", "precedence", "turn"])
def test_a_proof_that_is_changed_is_refused(change: str) -> None:
    def changed(proof: Proof) -> None:
        if change == "left out":
            proof["proofs"].pop()
        elif change == "free":
            next(one for one in proof["proofs"] if one["about"] == "refused")["parts"] = []
        elif change == "held more":
            proof["rules"]["hold"] = 2
        elif change == "turn":
            proof["rules"]["turn"] = True
        else:
            proof["rules"]["precedence"] = []

    why = {
        "free": "other parts are free in the proof",
        "turn": "valid only if parts move one at a time",
    }
    assert why.get(change, "do not exclude every order") in wrong(from_both_sides(1), changed)
