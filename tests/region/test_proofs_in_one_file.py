"""Proofs of regions and margins with friction in one file: written, rechecked, and caught."""

from __future__ import annotations

import copy
import json

import pytest
from random_turned import random_turned, springer_arch

import kilter
from kilter.errors import InputError
from kilter.mechanics.proof import digest_of
from kilter.scenes import rails, stacks

CASES = {
    "arch": lambda: springer_arch(4, 0.25, friction=0.7),
    "planar arch": lambda: springer_arch(5, 0.2, friction=0.6, planar=True),
    "pile": lambda: random_turned("pile", 6),
    "wedge": lambda: random_turned("wedge", 3),
    "thin": lambda: rails.railed("-x -z").with_friction(0.4),
    "stack": lambda: stacks.tower(3, friction=0.5).with_down([0.03, 0.01, -1]),
    "smooth": lambda: rails.railed("-x -z"),
}


def through_json(data):
    return json.loads(json.dumps(data, allow_nan=False))


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_a_region_is_rechecked(name: str) -> None:
    assembly = CASES[name]()
    found = kilter.region(assembly)
    data = through_json(found.proof())
    answer = kilter.verify(assembly, data)
    assert answer.holds, answer.reasons
    assert answer.verdict == "region"
    about = [entry["about"] for entry in data["proofs"]]
    assert about.count("ray") >= len(found.rays)
    assert about.count("facet") == len(found.facets)


@pytest.mark.slow
def test_one_number_flipped_is_caught() -> None:
    assembly = CASES["arch"]()
    data = through_json(kilter.region(assembly).proof())
    place = {entry["about"]: k for k, entry in enumerate(data["proofs"])}

    def broken(about, flip, *, signed=True):
        changed = copy.deepcopy(data)
        entry = changed["proofs"][place[about]]
        flip(entry)
        if signed:  # as one who knows how files are signed would
            entry["proof"]["digest"] = digest_of({**changed["common"], **entry["proof"]})
        return kilter.verify(assembly, changed)

    def turn(entry):
        entry["vector"] = [-x for x in entry["vector"]]

    def push(entry):
        entry["proof"]["forces"][3][2] += 1.0

    def still(entry):
        entry["proof"]["motion"]["v1"] = [0.0] * 6

    assert broken("ray", lambda entry: None).holds
    assert any("beyond another facet" in text for text in broken("facet", turn).reasons)
    assert not broken("ray", push).holds
    assert any("digest" in text for text in broken("ray", push, signed=False).reasons)
    assert not broken("facet", still).holds
    other = springer_arch(4, 0.24, friction=0.7)
    assert not kilter.verify(other, data).holds


def test_what_cannot_be_written_is_said() -> None:
    one = rails.railed("-x -z")
    with pytest.raises(InputError, match="several files"):
        kilter.common_region([one, one]).proof()
