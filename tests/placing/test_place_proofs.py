"""Proofs of places: they hold for their file, and each change of a statement or number is found."""

from __future__ import annotations

import copy
import json
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from planks import bridge

import kilter
from kilter import Assembly, Box, Part, Pose
from kilter.analysis.placing.place import box_to_place, place
from kilter.cli import main
from kilter.errors import InputError
from kilter.mechanics.proof import digest_of

BOX = box_to_place([0.7, 0.5, 0.2], 3)


@cache
def proof_text(friction: float = 0.0) -> str:
    return json.dumps(place(bridge(friction), BOX, accuracy=0.05).proof())


def proof(friction: float = 0.0) -> dict[str, Any]:
    data: dict[str, Any] = json.loads(proof_text(friction))
    return data


def signed(data: dict[str, Any]) -> dict[str, Any]:
    """The data with a digest that fits, as a writer who wants to deceive would leave them."""
    data["digest"] = digest_of(data)
    return data


def findings(data: dict[str, Any]) -> list[dict[str, Any]]:
    return [f for level in data["map"]["cases"][0] for f in level["findings"]]


@pytest.mark.quick(1)
@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_the_proof_of_a_map_holds_for_its_assembly_alone(friction: float) -> None:
    assert kilter.verify(bridge(friction), proof(friction)).holds
    other = bridge(friction).without(["plank-1"])
    assert not kilter.verify(other, proof(friction)).holds


def test_a_changed_file_is_found() -> None:
    data = proof()
    data["map"]["clear"] = 0.1
    result = kilter.verify(bridge(), data)
    assert any("digest" in reason for reason in result.reasons)


def wider(data: dict[str, Any], name: str) -> None:
    """A stated polygon that extends to a further place."""
    level = next(level for level in reversed(data["map"]["levels"]) if level[name])
    ring = level[name][0][0]
    k = int(np.argmax([y for _, y in ring]))
    ring[k][1] += 1e-3
    if k == 0:
        ring[-1] = ring[0]


def heavier(data: dict[str, Any]) -> None:
    data["map"]["mass"] = [3, 3.5]


def another_part(data: dict[str, Any]) -> None:
    data["map"]["part"]["parts"][0]["mass"] = 6
    data["map"]["mass"] = [6, 6]


def taller_footprint(data: dict[str, Any]) -> None:
    data["map"]["part"]["parts"][0]["box"] = [0.6, 0.5, 0.2]


def unsure_centre(data: dict[str, Any]) -> None:
    data["map"]["center_within"] = 0.05


def without_motions(data: dict[str, Any]) -> None:
    for finding in findings(data):
        finding["motions"] = []


def without_places(data: dict[str, Any]) -> None:
    for finding in findings(data):
        finding["places"] = []


def larger_rectangle(data: dict[str, Any]) -> None:
    for finding in findings(data):
        if finding["top"] is None:
            finding["low"][0] -= 0.02
            finding["high"][0] += 0.02


def other_force(data: dict[str, Any]) -> None:
    for finding in findings(data):
        for given in finding["places"]:
            given["forces"][int(np.argmax(given["forces"]))] *= 1.001


def turned_motions(data: dict[str, Any]) -> None:
    for finding in findings(data):
        finding["motions"] = [(-np.array(m)).tolist() for m in finding["motions"]]


def no_assembly(data: dict[str, Any]) -> None:
    data["proofs"][0]["change"] = {"mu": 0.9}


def other_shares(data: dict[str, Any]) -> None:
    for finding in findings(data):
        for name in finding.get("shares", {}):
            finding["shares"][name] += 0.3


def without_shares(data: dict[str, Any]) -> None:
    for finding in findings(data):
        finding.pop("shares", None)


LIES: list[Callable[[dict[str, Any]], None]] = [
    heavier, another_part, taller_footprint, unsure_centre, without_motions, without_places,
    larger_rectangle, other_force, turned_motions, no_assembly, other_shares, without_shares,
]  # fmt: skip


@pytest.mark.quick(3)
@pytest.mark.parametrize("lie", LIES)
def test_a_proof_with_a_lie_does_not_hold(lie: Callable[[dict[str, Any]], None]) -> None:
    data = proof()
    lie(data)
    assert not kilter.verify(bridge(), signed(data)).holds


@pytest.mark.parametrize("name", ["stands", "falls"])
def test_a_polygon_is_stated_no_larger_than_proved(name: str) -> None:
    data = proof()
    wider(data, name)
    result = kilter.verify(bridge(), signed(data))
    assert not result.holds
    assert all("by statement" in reason for reason in result.reasons)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3))
def test_a_force_or_motion_that_is_needed_is_not_exchanged(seed: int) -> None:
    """Each finding of several tops without one of its places, or with another number in it."""
    rng = np.random.default_rng(seed)
    whole = proof()
    candidates = [k for k, f in enumerate(findings(whole)) if len(f["places"]) > 2]
    found = 0
    for k in rng.choice(candidates, min(8, len(candidates)), replace=False):
        data = copy.deepcopy(whole)
        given = findings(data)[k]["places"]
        forces = given[int(rng.integers(len(given)))]["forces"]
        forces[int(np.argmax(forces))] *= 1.1
        found += not kilter.verify(bridge(), signed(data)).holds
    assert found  # a place may be needless where cells overlap, but not each of them


MALFORMED: list[tuple[str, Any]] = [
    ("mass", 3), ("levels", [{"height": 1}]), ("cases", [[{"height": 0, "findings": [{}]}]]),
    ("cases", [[{"height": 0, "findings": [{"top": None, "low": [0, 0], "high": [1, 1],
                                            "places": [], "motions": [], "shares": {"a": "b"}}]}]]),
    ("part", {}), ("part", {"kilter": 1, "parts": []}), ("domain", [0, 1]), ("clear", None),
]  # fmt: skip


@pytest.mark.parametrize(("key", "value"), MALFORMED)
def test_data_of_another_form_are_refused(key: str, value: Any) -> None:
    data = proof()
    data["map"][key] = value
    with pytest.raises(InputError, match=r"form|part"):
        kilter.verify(bridge(), signed(data))


def test_an_unknown_top_proves_nothing() -> None:
    data = proof()
    for finding in findings(data):
        finding["top"] = finding["top"] and "ladder"
    assert not kilter.verify(bridge(), signed(data)).holds


@pytest.mark.quick(2)
@pytest.mark.parametrize(("x", "stands"), [(0.02, True), (0.1, False)])
@pytest.mark.parametrize("unsure", [False, True])
def test_the_proof_at_a_place_is_that_of_check(x: float, stands: bool, unsure: bool) -> None:
    more: dict[str, Any] = {"mass": (2.9, 3), "center_within": 0.01} if unsure else {}
    at = place(bridge(), BOX, at=[x, 0.1], **more)
    data = json.loads(json.dumps(at.proof()))
    assert kilter.verify(bridge(), data).holds
    assert len(data["proofs"]) == (8 if unsure and stands else 1)
    assert ("forces" in data["proofs"][0]["proof"]) is stands
    data["place"]["mass"] = [2.8, 2.95]
    assert not kilter.verify(bridge(), signed(data)).holds


@pytest.mark.slow
def test_the_command_writes_a_proof(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file, written = tmp_path / "bridge.kilter.json", tmp_path / "P.json"
    kilter.dump(bridge(), file)
    part = ["--box", "0.7x0.5x0.2", "--mass", "3"]
    for more in (["--accuracy", "0.1"], ["--at", "0", "0"]):
        assert main(["place", str(file), *part, *more, "--proof", str(written)]) == 0
        assert main(["verify", str(file), str(written)]) == 0
    assert "held by forces" in capsys.readouterr().out


def test_an_assembly_that_falls_alone_has_a_proof_of_its_places() -> None:
    """A plank falls off a table unless a load lies far enough behind the edge."""
    table = Part("table", Box([4, 1, 1]), Pose([-2, 0, -0.5]), grounded=True)
    plank = Part("plank", Box([1, 1, 0.1]), Pose([0.1, 0, 0.05]), mass=2)
    falling = Assembly([table, plank])
    places = place(falling, box_to_place([1e-3, 1e-3, 0.1], 1))
    data = json.loads(json.dumps(places.proof()))
    assert data["proofs"][0]["proof"]["verdict"] == "unstable"
    assert kilter.verify(falling, data).holds
    table_level = data["map"]["levels"][0]
    table_level["stands"] = table_level["falls"]
    assert not kilter.verify(falling, signed(data)).holds
