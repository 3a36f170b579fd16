"""Straps with a capacity: limits on both sides by `kilter.check`, proofs, and wrong input."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest
from lashings import direct, least_share, random_direct

import kilter
from kilter import Assembly, Box, InputError, Part, Strap
from kilter.analysis.decision.bond_factor import BondFactor, find_bond_factor
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
    assert kilter.margin(direct(angle, least)).bond == pytest.approx(1.0, abs=2e-6)


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
    assert forward.g == pytest.approx(0.6, abs=1e-6)
    assert kilter.verify(load, answer.proof()).holds
    time = np.array([0.0, 1.0, 2.0])
    motion = np.zeros((3, 3))
    motion[1, 0] = 1.2 * G
    none = np.zeros((3, 3))
    path = CarrierPath(time, np.tile(np.eye(3), (3, 1, 1)), motion, none, none, np.zeros(3), True)
    assert kilter.transport(load, path=path).speed.factor ** 2 == pytest.approx(0.5, abs=1e-5)
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
        ({"capacity": 9, "path": [("box", [-1, 0, 0]), ("box", [0, 0, 1])]}, "connects no two"),
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


def sling(capacity: float) -> kilter.Assembly:
    """A box of 1 t in a sling of two pieces at 45 degrees."""
    path = [("ground", [-1, 0, 2]), ("box", [0, 0, 1]), ("ground", [1, 0, 2])]
    return dataclasses.replace(hung(1.0), straps=[Strap(path, capacity=capacity)])


def test_a_sling_of_two_pieces() -> None:
    """2 T sin 45 deg = m g."""
    least = WEIGHT / np.sqrt(2)
    for share, held in ((0.999, False), (1.001, True)):
        verdict = kilter.check(sling(share * least))
        assert verdict.level == ("proved" if held else None)
        assert kilter.verify(sling(share * least), verdict.proof()).holds
    proof = kilter.check(sling(1.2 * least)).proof()
    assert proof["pulls"] == pytest.approx([least], rel=1e-7)  # a single pull for both pieces


@pytest.mark.parametrize(("heavier", "held"), [(1.0, True), (1.001, False), (0.999, False)])
def test_boxes_over_a_fixed_ring_balance_only_with_equal_masses(heavier: float, held: bool) -> None:
    """The pull is the same on both sides of the ring, whatever the capacity."""
    parts = [
        block("deck", [-9, -9, -9], [9, 9, -8], grounded=True),
        block("left", [-2, -0.5, 0], [-1, 0.5, 1], mass=1000),
        block("right", [1, -0.5, 0], [2, 0.5, 1], mass=1000 * heavier),
    ]
    path = [("left", [-1.5, 0, 1]), ("ground", [-1.5, 0, 4]), ("ground", [1.5, 0, 4]),
            ("right", [1.5, 0, 1])]  # fmt: skip
    load = kilter.Assembly(parts, straps=[Strap(path, capacity=1e5)])
    verdict = kilter.check(load, require="equilibrium")
    assert (verdict.level is not None) == held
    assert kilter.verify(load, verdict.proof()).holds


def looped(capacity: float, *, braking: float = 0.8, friction: float = 0.3) -> kilter.Assembly:
    """A box of 1 t with a loop around its front at the height of its centre."""
    corners = [("box", [0.5, -0.5, 0.4]), ("box", [0.5, 0.5, 0.4])]
    ends = [("ground", [-1.5, -1.0, 0.4]), ("ground", [-1.5, 1.0, 0.4])]
    return kilter.Assembly(
        [
            block("deck", [-9, -9, -1], [9, 9, 0], grounded=True),
            block("box", [-0.5, -0.5, 0], [0.5, 0.5, 0.8], mass=1000),
        ],
        friction=friction,
        straps=[Strap([ends[0], *corners, ends[1]], capacity=capacity)],
        gravity=[9.81 * braking, 0, -9.81],
    )


def test_a_loop_around_the_front_of_a_box() -> None:
    """2 T cos(beta) = (c - mu) m g, with the angle beta from the pieces to the forward axis."""
    least = (0.8 - 0.3) * WEIGHT / (2 * 2 / np.hypot(2, 0.5))
    for share, held in ((0.999, False), (1.001, True)):
        load = looped(share * least)
        verdict = kilter.check(load, require="equilibrium")
        assert (verdict.level is not None) == held
        assert kilter.verify(load, verdict.proof()).holds
    assert kilter.margin(looped(least)).bond == pytest.approx(1.0, abs=2e-6)


def test_damaged_pulls_of_a_loop_are_found() -> None:
    load = looped(5000.0)
    proof = kilter.check(load, require="equilibrium").proof()
    assert len(proof["pulls"]) == 1
    damaged = {**proof, "pulls": [proof["pulls"][0] * 1.1]}
    damaged["digest"] = digest_of(damaged)
    assert not kilter.verify(load, damaged).holds


@pytest.mark.quick(2)
@pytest.mark.parametrize("seed", range(12))
def test_loops_agree_with_an_independent_program(seed: int) -> None:
    """The needed share of the capacities is between those with pyramids around and inside cones."""
    load = random_direct(seed, loops=True)
    if not load.straps:
        return
    touching = contacts(load)
    factor = find_bond_factor(build_program(load, touching), touching)
    inside, around = least_share(load, around=False), least_share(load, around=True)
    if not isinstance(factor, BondFactor):
        assert factor.why == "none"
        assert np.isinf(inside)
        return
    rounding = 1e-6 * max(1.0, factor.value)
    assert around - rounding <= factor.value <= inside + rounding


def test_the_data_name_each_strap_and_its_pull() -> None:
    """Without friction, level straps through the centre pull with m a in total."""
    table = Part("table", Box(4, 4, 1), [0, 0, -0.5], grounded=True)
    box = Part("box", Box(1, 1, 1), [0, 0, 0.5], mass=100)
    straps = [
        Strap([("ground", [2, 0, 0.5]), ("box", [0.5, 0, 0.5])], capacity=700, name="front"),
        Strap([("ground", [-2, 0, 0.5]), ("box", [-0.5, 0, 0.5])], capacity=900),
    ]
    assembly = Assembly([table, box], straps=straps)
    answer = kilter.transport(assembly, accelerate=[3, 0, 0], require="equilibrium").to_dict()
    front, back = answer["straps"]
    assert (front["name"], front["tension"], front["capacity"]) == ("front", None, 700)
    assert (back["name"], back["capacity"]) == ("strap 2", 900)
    # the box is carried along +x by the strap in front; equal pulls of both straps cancel
    assert front["used"] - back["used"] == pytest.approx(300)
    assert front["used"] <= 700
    again = kilter.files.from_dict(kilter.files.to_dict(assembly))
    assert [strap.name for strap in again.straps] == ["front", ""]
