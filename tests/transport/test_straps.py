"""Straps: least tensions of lashed loads, on both sides by `kilter.check`, and wrong input."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from lashings import lashed, least_share, over, random_direct, random_lashing

import kilter
from kilter import Assembly, InputError, Strap
from kilter.analysis.decision.bond_factor import BondFactor, find_bond_factor
from kilter.analysis.transport.carrier import CarrierMotion, carried_assembly
from kilter.cli import main
from kilter.contact import contacts
from kilter.mechanics.program import build_program
from kilter.mechanics.proof import digest_of
from kilter.scenes.pieces import block, floor

G = 9.81
NEWTON = 0.01
"""Distance of the tests from a least tension [N]."""


def _holds(assembly: kilter.Assembly, tension: float, share: float) -> bool:
    """Whether forces hold the load with this tension at an acceleration of `share` g."""
    strap = dataclasses.replace(assembly.straps[0], tension=tension)
    strapped = dataclasses.replace(assembly, straps=[strap])
    felt = carried_assembly(strapped, CarrierMotion([-share * G, 0, 0]))
    return kilter.check(felt, require="equilibrium").level is not None


def _least(assembly: kilter.Assembly, share: float) -> float:
    """Least tension of the strap; `check` agrees on both sides of it."""
    felt = carried_assembly(assembly, CarrierMotion([-share * G, 0, 0]))
    touching = contacts(felt)
    factor = find_bond_factor(build_program(felt, touching), touching)
    assert isinstance(factor, BondFactor)
    least = factor.value * assembly.straps[0].tension
    assert _holds(assembly, least + NEWTON, share)
    assert not _holds(assembly, least - NEWTON, share)
    return least


@pytest.mark.quick(3)
@pytest.mark.parametrize(
    ("mass", "width", "height", "share", "friction", "angle", "expected"),
    [
        (500, 1.0, 1.2, 1.0, 10.0, 65, 541.21),
        (1000, 1.0, 2.0, 0.5, 0.45, 75, 564.23),
        (1000, 1.0, 2.0, 0.6, 0.45, 75, 1692.68),
        (2000, 1.2, 2.4, 0.5, 0.3, 83, 6589.11),
        (1000, 0.8, 2.0, 0.5, 0.45, 60, 1415.95),
        (2000, 2.0, 1.0, 0.8, 0.4, 80, 9961.34),
    ],
)
def test_a_box_under_a_strap(
    mass: float, width: float, height: float, share: float, friction: float, angle: float,
    expected: float,
) -> None:  # fmt: skip
    """The closed forms of sliding and of tipping of one rigid box under one strap."""
    sine, weight = np.sin(np.radians(angle)), mass * G
    slides = (share - friction) * weight / (2 * friction * sine)
    tips = weight * (share * height / 2 - width / 2) / (width * sine)
    assert max(slides, tips) == pytest.approx(expected, abs=NEWTON)
    box = [([-width / 2, 0.0], [width / 2, height])]
    strap = over(width, height, angle, 2 * expected)
    assert _least(lashed(box, mass, strap, friction), share) == pytest.approx(expected, abs=NEWTON)


def test_a_strap_over_the_upper_of_two_boxes() -> None:
    """The largest one-box value over all cuts: the upper box slides on the lower one."""
    boxes = [([-0.6, 0.0], [0.6, 0.6]), ([-0.6, 0.6], [0.6, 1.2])]
    strap = over(1.2, 1.2, 75, 4000.0, left="box-1", right="box-1")
    assembly = lashed(boxes, 500, strap, 0.6, pairs=0.3)
    assert _least(assembly, 0.6) == pytest.approx(2539.01, abs=NEWTON)


@pytest.mark.parametrize(
    ("count", "angle", "expected"),
    [(1, 75, 507.803), (2, 75, 1015.606), (3, 75, 1523.409), (4, 75, 2031.212), (4, 30, 5491.7)],
)
def test_a_row_of_boxes_under_one_strap(count: int, angle: float, expected: float) -> None:
    """Without friction between the boxes the tension grows with their number."""
    width, height, first = 0.6, 1.2, -0.3 * count
    boxes = [
        ([first + k * width, 0.0], [first + (k + 1) * width, height]) for k in range(count)
    ]  # fmt: skip
    strap = over(count * width, height, angle, 2 * expected, right=f"box-{count - 1}")
    assembly = lashed(boxes, 500, strap, 0.8, pairs=0.0)
    digits = NEWTON if angle == 75 else 0.06
    assert _least(assembly, 0.6) == pytest.approx(expected, abs=digits)


def test_friction_at_corners_takes_tension_from_the_tensioned_end_on() -> None:
    """exp(-mu angle) at each corner; the forces of a strap have no sum and no moment."""
    strap = over(1.0, 1.0, 60, 1000.0, mu=0.3, tensioned="first")
    turn = np.radians(60)
    fall = np.exp(-0.3 * turn)
    assert strap.tensions == pytest.approx([1000, 1000 * fall, 1000 * fall**2])
    other = dataclasses.replace(strap, tensioned="last")
    assert other.tensions == pytest.approx([1000 * fall**2, 1000 * fall, 1000])
    assert strap.forces.sum(axis=0) == pytest.approx(np.zeros(3), abs=1e-9)
    moment = np.cross(strap.points, strap.forces).sum(axis=0)
    assert moment == pytest.approx(np.zeros(3), abs=1e-9)


def _stack(tension: float = 800.0) -> kilter.Assembly:
    """A box that does not stay at 0.5 g without its strap of at least 564.23 N."""
    strap = over(1.0, 2.0, 75, tension)
    return lashed([([-0.5, 0.0], [0.5, 2.0])], 1000, strap, 0.45)


def test_margin_names_the_share_of_tension_that_is_needed() -> None:
    felt = carried_assembly(_stack(), CarrierMotion([-0.5 * G, 0, 0]))
    answer = kilter.margin(felt)
    assert answer.bond is not None
    assert answer.bond == pytest.approx(564.23 / 800, abs=NEWTON / 800)
    assert answer.to_dict()["clamped_by"] == ["straps"]
    proof = answer.proof()
    assert {"bond"} <= {entry["about"] for entry in proof["proofs"]}
    assert kilter.verify(felt, proof).holds
    for entry in proof["proofs"]:
        del entry["proof"]["straps"]
        entry["proof"]["digest"] = digest_of({**proof["common"], **entry["proof"]})
    proof["digest"] = digest_of(proof)
    assert "its straps differ from those of the file" in kilter.verify(felt, proof).reasons[0]


@pytest.mark.parametrize(
    ("path", "more", "message"),
    [
        ([("ground", [-1, 0, 0]), ("ground", [1, 0, 2])], {}, "passes through this part"),
        ([("ground", [-1, 0, 0]), ("box-0", [0, 0, 3])], {}, "which is not there"),
        ([("ground", [-1, 0, 0]), ("bag", [0, 0, 2])], {}, "bag"),
        ([("ground", [-1, 0, 0])], {}, "two or more points"),
        ([("ground", [1, 0, 0]), ("box-0", [1, 0, 0])], {}, "are equal"),
        ([("ground", [-1, 0, 0]), ("box-0", [0, 0, 2])], {"tension": 0}, "tension .* is 0"),
        (
            [("ground", [-1, 0, 0]), ("box-0", [-0.5, 0, 2]), ("ground", [-1, 5, 2])],
            {"mu": 0.2},
            "tensioned end is not named",
        ),
    ],
)
def test_wrong_straps_are_refused_in_a_sentence(
    path: list[object], more: dict[str, float], message: str
) -> None:
    def ask() -> None:
        strap = Strap(path, **{"tension": 800.0, **more})
        kilter.margin(dataclasses.replace(_stack(), straps=[strap]))

    with pytest.raises(InputError, match=message):
        ask()


@pytest.mark.quick(1)
def test_the_worse_tensioned_end_counts() -> None:
    """1 t, mu .3, .5 g: the strap helps more if its pull is larger on the side of the load."""
    ends: dict[str | None, kilter.Verdict] = {}
    for end in ("first", "last", None):
        strap = over(1.0, 2.0, 60, 1000.0, mu=0.3, tensioned=end)
        load = lashed([([-0.5, 0.0], [0.5, 2.0])], 1000, strap, 0.8)
        felt = dataclasses.replace(load, gravity=[-0.53 * G, 0, -G])
        ends[end] = kilter.check(felt, require="equilibrium")
        assert kilter.verify(felt, ends[end].proof()).holds
    better, worse = sorted(("first", "last"), key=lambda end: ends[end].verdict == "unstable")
    assert ends[better].verdict != "unstable"
    assert ends[worse].verdict == ends[None].verdict == "unstable"
    assert f"tensioned at its {worse} end; another" in ends[None].warnings[-1]
    with pytest.raises(InputError, match="only check tries both ends"):
        kilter.transport(felt)


def test_a_plan_with_straps_is_refused() -> None:
    with pytest.raises(InputError, match="plan does not support straps"):
        kilter.plan(_stack())


@pytest.mark.slow
@pytest.mark.parametrize(
    ("make", "seed"),
    [
        *((random_lashing, seed) for seed in range(1000, 1020)),
        *((random_direct, seed) for seed in range(2000, 2020)),
    ],
)
def test_random_straps_agree_with_an_independent_program(
    make: Callable[[int], Assembly], seed: int
) -> None:
    """A sample of `benchmarks/straps_census.py`: bounds on both sides by linear programs."""
    assembly = make(seed)
    touching = contacts(assembly)
    inside = least_share(assembly, around=False)
    factor = find_bond_factor(build_program(assembly, touching), touching)
    if isinstance(factor, BondFactor):
        rounding = 1e-6 * max(1.0, factor.value)
        around = least_share(assembly, around=True)
        assert around - rounding <= factor.value <= inside + rounding
    else:
        assert factor.why == "none"
        assert np.isinf(inside)


def test_straps_of_the_command_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    whole = _stack()
    path, straps, proof = (tmp_path / name for name in ("box.kilter.json", "s.json", "p.json"))
    kilter.dump(dataclasses.replace(whole, straps=()), path)
    straps.write_text(json.dumps([strap.to_dict() for strap in whole.straps]))
    words = ["transport", str(path), "--accelerate", "-0.5g", "0", "0", "--require", "equilibrium"]
    assert main(words) == 1
    assert main([*words, "--straps", str(straps), "--proof", str(proof)]) == 0
    assert main(["verify", str(path), str(proof)]) == 0
    saved = str(tmp_path / "c.json")
    assert main(["save", str(path), "--straps", str(straps), "-o", saved]) == 0
    assert kilter.load(saved).straps == tuple(whole.straps)
    capsys.readouterr()
    for text, message in (
        ("{}", "no list of straps"),
        ('[{"path": [["ground", [0, 0, 0]], ["box-0", [0, 0, 2]]], "tension": 0}]', "tension"),
        ('[{"path": [["ground", [-1, 0, 0]], ["ground", [1, 0, 2]]], "tension": 9}]', "through"),
    ):
        straps.write_text(text)
        assert main([*words, "--straps", str(straps)]) == 2
        error = capsys.readouterr().err
        assert message in error
        assert "Traceback" not in error
    straps.write_text('[{"path": [["ground", [0, 0, 0]], ["bag", [0, 0, 2]]], "tension": 9}]')
    assert main([*words, "--straps", str(straps)]) in (1, 2)
    assert "bag" in "".join(capsys.readouterr())


@pytest.mark.parametrize("gap", [0.005, 0.0])
def test_a_strap_that_pulls_a_gap_together_is_named_with_the_clearance_that_closes_it(gap):
    bed = floor([-5, -2], [5, 2], name="bed")
    boxes = [
        block(name, [x, -0.5, 0], [x + 1, 0.5, 1], mass=500)
        for name, x in (("left", -1.0), ("right", gap))
    ]
    strap = kilter.Strap([("left", [-1, 0, 1]), ("right", [1 + gap, 0, 1])], tension=20000)
    load = kilter.Assembly([bed, *boxes], friction=0.3, straps=[strap])
    verdict = kilter.check(load)
    texts = [text for text in verdict.warnings if "pulls 'left' and 'right' together" in text]
    assert (verdict.verdict == "unstable") == bool(texts) == (gap > 0)
    for text in texts:
        clearance = float(text.split("--clearance ")[1].split()[0])
        closed = kilter.check(load, tolerance=kilter.Tolerance(clearance=clearance))
        assert closed.level is not None
