"""Straps with a capacity: limits on both sides by `kilter.check`, proofs, and wrong input."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest
from lashings import direct

import kilter
from kilter import InputError, Strap
from kilter.analysis.transport.carrier import CarrierMotion, carried_assembly
from kilter.analysis.transport.carrier_path import CarrierPath
from kilter.cli import main
from kilter.contact import contacts
from kilter.mechanics.certificate import check_forces, check_motion
from kilter.mechanics.program import build_program
from kilter.mechanics.proof import digest_of
from kilter.scenes.pieces import block

G = 9.81
WEIGHT = 1000 * G


def hung(capacity: float, *, planar: bool = False) -> kilter.Assembly:
    """A box of 1 t on a vertical strap."""
    strap = Strap([("ground", [0, 0, 5]), ("box", [0, 0, 1])], capacity=capacity)
    deck = block("deck", [-9, -9, -9], [9, 9, -8], grounded=True)
    box = block("box", [-0.5, -0.5, 0], [0.5, 0.5, 1], mass=1000)
    return kilter.Assembly([deck, box], straps=[strap], planar=planar)


@pytest.mark.quick(2)
@pytest.mark.parametrize(("angle", "least"), [(30, 2896.58), (45, 3201.56), (60, 3873.35)])
def test_the_least_capacity_of_one_strap(angle: float, least: float) -> None:
    for share, held in ((0.999, False), (1.001, True)):
        load = direct(angle, share * least)
        verdict = kilter.check(load)
        assert verdict.level == ("equilibrium" if held else None)
        assert kilter.verify(load, verdict.proof()).holds
    assert any("straps with a capacity" in words for words in verdict.warnings)
    assert kilter.margin(direct(angle, least)).bond.value == pytest.approx(1.0, abs=2e-6)


@pytest.mark.parametrize("planar", [False, True])
def test_a_hung_box(planar: bool) -> None:
    """Without friction, equilibrium is a proof of stability."""
    assert kilter.check(hung(1.001 * WEIGHT, planar=planar)).level == "proved"
    falling = kilter.check(hung(0.999 * WEIGHT, planar=planar))
    assert falling.verdict == "unstable"
    assert falling.moving == ["box"]
    assert falling.to_dict()["z"] is None


def test_a_strap_neither_pushes_nor_exceeds_its_capacity() -> None:
    load = hung(1.5 * WEIGHT)
    program = build_program(load, contacts(load))
    assert check_forces(program, np.array([WEIGHT])).holds
    assert not check_forces(program, np.array([2 * WEIGHT])).holds
    assert not check_forces(program.turned([0, 0, 1.0]), np.array([-WEIGHT])).holds
    drop = np.zeros((2, 6))
    drop[1, 2] = -1.0
    assert not check_motion(program, drop).holds
    assert check_motion(program.with_strength(0.6), drop).holds


def test_damaged_pulls_are_found() -> None:
    load = direct(45, 4000.0)
    proof = json.loads(json.dumps(kilter.check(load, require="equilibrium").proof()))
    assert kilter.verify(load, proof).holds
    for pulls, words in (([4100.0], "more than its capacity"), ([-50.0], "a strap pushes"),
                         ([3000.0], "unbalanced"), ([], "a pull for each strap")):  # fmt: skip
        damaged = {**proof, "pulls": pulls}
        damaged["digest"] = digest_of(damaged)
        reasons = kilter.verify(load, damaged).reasons
        assert any(words in reason for reason in reasons), reasons
    weaker = dataclasses.replace(
        load, straps=[dataclasses.replace(load.straps[0], capacity=3900.0)]
    )
    assert "straps differ" in kilter.verify(weaker, proof).reasons[0]


@pytest.mark.slow
def test_transport_and_paths_know_the_capacity() -> None:
    """The least capacity at 0.6 g carries 0.6 g, and a path of twice this acceleration at 1/2."""
    load = dataclasses.replace(direct(45, 3201.5619), gravity=[0, 0, -G])
    answer = kilter.transport(load, polar=False)
    forward = next(limit for limit in answer.limits if limit.name == "+x")
    assert forward.value == pytest.approx(0.6, abs=1e-6)
    assert kilter.verify(load, answer.proof()).holds
    time = np.array([0.0, 1.0, 2.0])
    motion = np.zeros((3, 3))
    motion[1, 0] = 1.2 * G
    none = np.zeros((3, 3))
    path = CarrierPath(time, np.tile(np.eye(3), (3, 1, 1)), motion, none, none, np.zeros(3), True)
    assert kilter.transport(load, path=path).path.factor ** 2 == pytest.approx(0.5, abs=1e-5)
    for share, held in ((0.599, True), (0.601, False)):
        felt = carried_assembly(load, CarrierMotion([share * G, 0, 0]))
        assert (kilter.check(felt, require="equilibrium").level is not None) == held


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ({"capacity": 0}, "capacity .* is 0"),
        ({}, "neither of tension and capacity"),
        ({"capacity": 9, "tension": 9}, "both of tension and capacity"),
        ({"capacity": 9, "mu": 0.2}, "capacity, and friction"),
        ({"capacity": 9, "tensioned": "first"}, "capacity, and friction or a tensioned end"),
        ({"capacity": 9, "path": [("ground", [-1, 0, 0]), ("box", [0, 0, 1]),
                                  ("ground", [1, 0, 0])]}, "2 pieces"),
    ],
)  # fmt: skip
def test_wrong_straps_are_refused_in_a_sentence(more: dict[str, object], message: str) -> None:
    path = [("ground", [0, 0, 5]), ("box", [0, 0, 1])]
    with pytest.raises(InputError, match=message):
        Strap(**{"path": path, **more})


def test_a_file_keeps_the_capacity(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    load = hung(1.5 * WEIGHT)
    file = tmp_path / "hung.kilter.json"
    kilter.dump(load, file)
    assert kilter.load(file).straps == tuple(load.straps)
    assert main(["check", str(file)]) == 0
    assert main(["region", str(file)]) == 2
    assert "region does not support straps" in capsys.readouterr().err
