"""Each stated value of a margin or of a transport follows from the changed assembly."""

from __future__ import annotations

import copy
import json
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import pytest
from boxes_on_deck import stack_on_deck

import kilter
from kilter.mechanics.proof import digest_of
from kilter.scenes import stacks
from kilter.tell.margin_facts import margin_facts

Bundle = dict[str, Any]


@cache
def proofs() -> dict[str, tuple[kilter.Assembly, Bundle]]:
    block = stacks.block_on_slope(5.0, friction=0.5)
    margin = kilter.margin(block).proof()
    carried = kilter.transport(block).proof()
    return {
        kind: (block, json.loads(json.dumps(proof)))
        for kind, proof in (("margin", margin), ("transport", carried))
    }


def verified(kind: str, change: Callable[[Bundle], object]) -> kilter.Verification:
    """Result for a changed copy of a proof with a fresh digest."""
    assembly, proof = proofs()[kind]
    bundle = copy.deepcopy(proof)
    change(bundle)
    bundle["digest"] = digest_of(bundle)
    return kilter.verify(assembly, bundle)


@pytest.mark.parametrize("kind", ["margin", "transport"])
def test_each_limit_is_stated_with_both_sides(kind: str) -> None:
    found = verified(kind, lambda bundle: None)
    assert found.holds, found.reasons
    limits = [note for note in found.notes if "held at" in note]
    assert limits
    assert all("falls at" in note for note in limits)


def entries(kind: str) -> list[int]:
    return list(range(len(proofs()[kind][1]["proofs"])))


@pytest.mark.quick("far-margin", "flipped-margin", "near-margin", "near-transport")
@pytest.mark.parametrize("kind", ["margin", "transport"])
@pytest.mark.parametrize(
    "change",
    [
        lambda entry: entry.update(value=1e6),
        lambda entry: entry.update(value=entry["value"] * (1 + 1e-6)),
        lambda entry: entry.update(held=not entry["held"]),
    ],
    ids=["far", "near", "flipped"],
)
def test_a_value_that_differs_from_the_change_is_refused(
    kind: str, change: Callable[[Bundle], object]
) -> None:
    for k in entries(kind):
        assert not verified(kind, lambda bundle, k=k: change(bundle["proofs"][k])).holds


def test_a_turn_about_an_axis_and_both_load_factors_are_in_the_proof() -> None:
    """A cube slides at mu: at atan .3 about y, and at .3 of its weight along and against x."""
    cube = stack_on_deck([[1, 1, 1]], 0.3)
    answer = kilter.margin(cube, about=[0, 1, 0], push=[1, 0, 0])
    proof = answer.proof()
    stated = {(entry["about"], entry["held"]): entry["value"] for entry in proof["proofs"]}
    for held in (True, False):
        assert stated["tilt about the axis", held] == pytest.approx(np.arctan(0.3), abs=1e-6)
        assert stated["load factor", held] == pytest.approx(0.3, abs=1e-6)
        assert stated["least load factor", held] == pytest.approx(-0.3, abs=1e-6)
    assert kilter.verify(cube, proof).holds
    facts = dict(margin_facts(answer.to_dict()))
    assert facts["about axis"].startswith("16.699")
    assert "about (0, 1, 0) by the right-hand rule" in facts["about axis"]
