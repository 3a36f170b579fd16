"""The file of a region proves it only if its rays and facets enclose it."""

from __future__ import annotations

import copy
import json
from collections.abc import Callable
from functools import cache
from typing import Any

import pytest

import kilter
from kilter.mechanics.proof import digest_of
from kilter.scenes import scene, stacks

Bundle = dict[str, Any]
SCENES: dict[str, Callable[[], kilter.Assembly]] = {
    "ray": lambda: scene("tower"),
    "cone": lambda: scene("corner-wedges"),
    "fan": lambda: scene("paper-figure-10"),
    "friction": lambda: stacks.block_on_slope(0.0, friction=0.5),
}


@cache
def proof_of(name: str) -> Bundle:
    bundle: Bundle = json.loads(json.dumps(kilter.region(SCENES[name]()).proof()))
    return bundle


def verified(name: str, change: Callable[[Bundle], object]) -> kilter.Verification:
    """Result for a changed copy of a proof with a fresh digest."""
    bundle = copy.deepcopy(proof_of(name))
    change(bundle)
    bundle["digest"] = digest_of(bundle)
    return kilter.verify(SCENES[name](), bundle)


@pytest.mark.quick("cone")
@pytest.mark.parametrize("name", SCENES)
def test_a_whole_region_holds_and_states_its_gap(name: str) -> None:
    found = verified(name, lambda bundle: None)
    assert found.holds, found.reasons
    assert found.notes[0].startswith("a direction without a proof lies at most")


@pytest.mark.quick("ray-ray", "facet-cone", "equation-ray")
@pytest.mark.parametrize("name", ["ray", "cone", "friction"])
@pytest.mark.parametrize("subject", ["ray", "facet", "equation"])
def test_a_region_without_some_of_its_proofs_is_not_closed(name: str, subject: str) -> None:
    left = [entry for entry in proof_of(name)["proofs"] if entry["about"] == subject]
    if not left:
        pytest.skip("this region has none")
    if name == "friction":  # of a round boundary a single facet is within the stated gap
        left = left[: len(left) // 2]

    def without(bundle: Bundle) -> None:
        bundle["proofs"] = [entry for entry in bundle["proofs"] if entry not in left]

    found = verified(name, without)
    assert not found.holds
    assert any("rays and facets differ by" in reason for reason in found.reasons)


def test_a_motion_of_an_unknown_part_is_a_reason() -> None:
    def other(bundle: Bundle) -> None:
        entry = next(entry for entry in bundle["proofs"] if entry["about"] == "facet")
        entry["proof"]["motion"]["nobody"] = [0.0] * 6

    assert not verified("cone", other).holds
