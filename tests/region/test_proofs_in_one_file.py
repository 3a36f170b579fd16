"""Proofs of regions and margins with friction in one file: written, rechecked, and caught."""

from __future__ import annotations

import copy
import json
from pathlib import Path

import numpy as np
import pytest
from random_turned import random_turned, springer_arch

import kilter
from kilter.cli import main
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
@pytest.mark.parametrize("name", ["arch", "planar arch", "stack"])
def test_a_margin_is_rechecked(name: str) -> None:
    assembly = CASES[name]()
    found = kilter.margin(assembly, push=[1, 0, 0], effort=0)
    data = through_json(found.proof())
    answer = kilter.verify(assembly, data)
    assert answer.holds, answer.reasons
    sides: dict[str, dict[bool, float]] = {}
    for entry in data["proofs"]:
        sides.setdefault(entry["about"], {})[entry["held"]] = entry["value"]
    limits = {"tilt": np.radians(found.tilt_deg), "friction": found.friction}
    for what, value in limits.items():
        assert {abs(side - value) < 1e-5 for side in sides[what].values()} == {True}
    for what, side in sides.items():
        # at least so much friction, at least so much of a load against the push
        assert (side[True] < side[False]) == (what not in ("friction", "least load factor"))
    assert len(sides) == 4 + sum(np.isfinite(push.force) for push in found.pushes)


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


@pytest.mark.slow
def test_commands_write_and_recheck(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file, proof = str(tmp_path / "a.kilter.json"), str(tmp_path / "p.json")
    kilter.dump(stacks.block_on_slope(10.0, friction=0.5), file)
    for command in (["region"], ["margin", "--down", "0.1", "0", "-1", "--effort", "0"]):
        assert main([*command[:1], file, *command[1:], "--proof", proof, "--quiet"]) == 0
        assert "written to" in capsys.readouterr().out
        assert main(["verify", file, proof, "--quiet"]) == 0
        capsys.readouterr()
    Path(proof).write_text(json.dumps({"kilter_proofs": 1, "kind": "region", "proofs": []}))
    assert main(["verify", file, proof, "--quiet"]) == 2


def test_what_cannot_be_written_is_said() -> None:
    one = rails.railed("-x -z")
    with pytest.raises(InputError, match="several files"):
        kilter.common_region([one, one]).proof()
