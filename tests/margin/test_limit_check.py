"""Each stated value of a margin or of a transport follows from the changed assembly."""

from __future__ import annotations

import copy
import json
from collections.abc import Callable
from functools import cache
from typing import Any

import pytest

import kilter
from kilter.mechanics.proof import digest_of
from kilter.scenes import stacks

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
