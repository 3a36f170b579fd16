"""Straps over loads, and the fewest of them."""

import dataclasses
import itertools
import json
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from lashings import direct, lashed, least_share, over, random_direct, random_lashing

import kilter
from kilter import CarrierMotion, InputError, Strap, contacts
from kilter.analysis.decision.bond_factor import BondFactor, find_bond_factor
from kilter.analysis.transport.carrier import carried_assembly
from kilter.cli import main
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
    mass, width, height, share, friction, angle,
    expected
):  # fmt: skip
    """The closed forms of sliding and of tipping of one rigid box under one strap."""
    sine, weight = np.sin(np.radians(angle)), mass * G
    slides = (share - friction) * weight / (2 * friction * sine)
    tips = weight * (share * height / 2 - width / 2) / (width * sine)
    assert max(slides, tips) == pytest.approx(expected, abs=NEWTON)
    box = [([-width / 2, 0.0], [width / 2, height])]
    strap = over(width, height, angle, 2 * expected)
    assert _least(lashed(box, mass, strap, friction), share) == pytest.approx(expected, abs=NEWTON)


def test_a_strap_over_the_upper_of_two_boxes():
    """The largest one-box value over all cuts: the upper box slides on the lower one."""
    boxes = [([-0.6, 0.0], [0.6, 0.6]), ([-0.6, 0.6], [0.6, 1.2])]
    strap = over(1.2, 1.2, 75, 4000.0, left="box-1", right="box-1")
    assembly = lashed(boxes, 500, strap, 0.6, pairs=0.3)
    assert _least(assembly, 0.6) == pytest.approx(2539.01, abs=NEWTON)


@pytest.mark.parametrize(
    ("count", "angle", "expected"),
    [(1, 75, 507.803), (2, 75, 1015.606), (3, 75, 1523.409), (4, 75, 2031.212), (4, 30, 5491.7)],
)
def test_a_row_of_boxes_under_one_strap(count, angle, expected):
    """Without friction between the boxes the tension grows with their number."""
    width, height, first = 0.6, 1.2, -0.3 * count
    boxes = [
        ([first + k * width, 0.0], [first + (k + 1) * width, height]) for k in range(count)
    ]  # fmt: skip
    strap = over(count * width, height, angle, 2 * expected, right=f"box-{count - 1}")
    assembly = lashed(boxes, 500, strap, 0.8, pairs=0.0)
    digits = NEWTON if angle == 75 else 0.06
    assert _least(assembly, 0.6) == pytest.approx(expected, abs=digits)


def test_friction_at_corners_takes_tension_from_the_tensioned_end_on():
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


def test_margin_names_the_share_of_tension_that_is_needed():
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
def test_wrong_straps_are_refused_in_a_sentence(path, more, message):
    def ask() -> None:
        strap = Strap(path, **{"tension": 800.0, **more})
        kilter.margin(dataclasses.replace(_stack(), straps=[strap]))

    with pytest.raises(InputError, match=message):
        ask()


@pytest.mark.quick(1)
def test_the_worse_tensioned_end_counts():
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


def test_a_plan_with_straps_is_refused():
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
def test_random_straps_agree_with_an_independent_program(make, seed):
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


def test_straps_of_the_command_line(tmp_path, capsys):
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


def fewest(assembly: kilter.Assembly, straps: list[kilter.Strap]) -> kilter.Fixture:
    return kilter.hold(assembly, straps=straps, require="equilibrium")


def by_enumeration(assembly: kilter.Assembly, straps: list[kilter.Strap]) -> int | None:
    """Least number of straps, by the decision of every set; None if no set holds."""
    touching = kilter.contacts(assembly)
    for size in range(len(straps) + 1):
        for chosen in itertools.combinations(straps, size):
            load = dataclasses.replace(assembly, straps=chosen)
            if kilter.check(load, contacts=touching.of(load), require="equilibrium").level:
                return size
    return None


@pytest.mark.slow
@pytest.mark.parametrize("first", range(3000, 3050, 10))
def test_random_candidates_agree_with_enumeration(first):
    for seed in range(first, first + 10):
        load = random_direct(seed)
        straps, bare = list(load.straps)[:5], dataclasses.replace(load, straps=())
        found = fewest(bare, straps)
        least = by_enumeration(bare, straps)
        assert found.verdict == ("impossible" if least is None else "held")
        assert least is None or (len(found.chosen or ()), found.least) == (least, least)
        assert kilter.verify(bare, found.proof()).holds


def load_and_candidates() -> tuple[kilter.Assembly, list[kilter.Strap]]:
    """A box that needs 3201.56 N at 45 degrees: two straps of 2000 N, or one of 3300 N."""
    load = direct(45, 2000.0)
    weak = load.straps[0]
    strong = dataclasses.replace(weak, capacity=3300.0)
    return dataclasses.replace(load, straps=()), [weak, weak, strong]


@pytest.mark.quick(1)
def test_one_strong_strap_replaces_two():
    load, candidates = load_and_candidates()
    assert fewest(load, candidates).chosen == (2,)
    two = fewest(load, candidates[:2])
    assert (two.chosen, two.least) == ((0, 1), 2)
    assert sum(strap.pull for strap in two.straps) == pytest.approx(3201.56, abs=0.1)
    assert fewest(load, candidates[:1]).verdict == "impossible"
    alone = dataclasses.replace(load, gravity=[0, 0, -G])
    assert fewest(alone, candidates).chosen == ()


def test_a_tensioned_strap_may_do_harm():
    """A strap that pulls the way the load slides is not used."""
    good = over(1.0, 2.0, 75, 3000.0)
    load = lashed([([-0.5, 0.0], [0.5, 2.0])], 1000, good, 0.45)
    felt = dataclasses.replace(load, straps=(), gravity=[-0.5 * G, 0, -G])
    harm = kilter.Strap([("ground", [-9, 0, 1]), ("box-0", [-0.5, 0, 1])], tension=2000)
    assert fewest(felt, [harm, good]).chosen == (1,)
    assert fewest(felt, [harm]).verdict == "impossible"


def crate(capacity: float, mu: float = 0.3) -> tuple[kilter.Assembly, list[kilter.Strap]]:
    """A low crate of 1000 kg, and level straps of one capacity: two to each end, one to each side.

    At an acceleration c g it slides unless the straps pull (c - mu) m g.
    """
    parts = [
        block("deck", [-9, -9, -1], [9, 9, 0], grounded=True),
        block("crate", [-1, -1, 0], [1, 1, 0.1], mass=1000),
    ]
    sides = [(1, 0), (1, 0), (-1, 0), (-1, 0), (0, 1), (0, -1)]
    paths = [([8 * x, 8 * y, 0.05], [x, y, 0.05]) for x, y in sides]
    straps = [
        kilter.Strap([("ground", far), ("crate", near)], capacity=capacity) for far, near in paths
    ]
    return kilter.Assembly(parts, friction=mu), straps


@pytest.mark.slow
@pytest.mark.parametrize(("share", "count"), [(0.51, 1), (0.49, 2), (0.2501, 2), (0.2499, None)])
def test_the_same_straps_hold_all_directions_of_a_code(share, count):
    """Forward .8 g needs (.8 - mu) m g = .5 m g behind; the other directions need .2 m g each."""
    load, straps = crate(share * 1000 * G)
    found = kilter.hold(load, straps=straps, code="en12195", require="equilibrium")
    if count is None:
        assert found.verdict == "impossible"
    else:
        assert found.chosen is not None
        chosen = set(found.chosen)  # an acceleration forward presses the crate backward
        assert len(chosen & {2, 3}) == count
        assert (len(chosen & {0, 1}), chosen >= {4, 5}) == (1, True)
        assert found.least == count + 3
        asked = kilter.transport(
            load.with_straps([chosen.strap for chosen in found.straps]),
            code="en12195",
            require="equilibrium",
        )
        assert asked.carried
        assert max(strap.pull for strap in found.straps) == pytest.approx(500 * G / count, rel=0.03)
    proof = json.loads(json.dumps(found.proof()))
    assert kilter.verify(load, proof).holds
    backward = kilter.hold(
        load, straps=straps, code="en12195", forward=[-2, 0, 0], require="equilibrium"
    )
    assert backward.verdict == found.verdict
    if count is not None:
        assert len(set(backward.chosen) & {0, 1}) == count


@pytest.mark.slow
def test_a_proof_about_a_code_shows_each_of_its_directions():
    load, straps = crate(0.6 * 1000 * G)
    text = json.dumps(
        kilter.hold(load, straps=straps, code="en12195", require="equilibrium").proof()
    )

    def reasons(change: Callable[[dict[str, Any]], object]) -> str:
        damaged = json.loads(text)
        change(damaged)
        damaged["digest"] = digest_of(damaged)
        return "; ".join(kilter.verify(load, damaged).reasons)

    assert "in every direction" in reasons(lambda proof: proof["proofs"].pop(0))
    assert "not that of its direction" in reasons(
        lambda proof: proof["rules"]["code"].update(name="eumos:0.4")
    )
    assert "no direction of the code" in reasons(lambda proof: proof["rules"].pop("code"))
    assert "no direction of the code" in reasons(lambda proof: proof["proofs"][0].pop("case"))
    assert "does not exist" in reasons(lambda proof: proof["rules"]["code"].update(name="x"))


@pytest.mark.quick(1)
def test_damaged_proofs_are_found():
    load, candidates = load_and_candidates()
    proof = json.loads(json.dumps(fewest(load, candidates[:2]).proof()))
    assert kilter.verify(load, proof).holds

    def reasons(**rules: object) -> str:
        damaged = {**proof, "rules": {**proof["rules"], **rules}}
        damaged["digest"] = digest_of(damaged)
        return "; ".join(kilter.verify(load, damaged).reasons)

    assert "do not exclude every set of 2" in reasons(least=3)
    assert "more than the least number" in reasons(least=1)
    strong = [strap.to_dict() for strap in candidates[1:]]
    assert "differ from the candidates" in reasons(candidates=strong)
    missing = {**proof, "proofs": proof["proofs"][:1]}
    missing["digest"] = digest_of(missing)
    assert not kilter.verify(load, missing).holds


@pytest.mark.quick(1)
def test_the_command(tmp_path, capsys):
    load, candidates = load_and_candidates()
    file, straps, proof = (tmp_path / name for name in ("box.kilter.json", "s.json", "p.json"))
    kilter.dump(load, file)
    straps.write_text(json.dumps([strap.to_dict() for strap in candidates[:2]]))
    words = ["hold", str(file), "--straps", str(straps)]
    assert main([*words, "--require", "equilibrium", "--proof", str(proof)]) == 0
    printed = capsys.readouterr().out
    assert "It holds with 2 straps of 2 candidates" in printed
    assert "fewer straps are not enough" in printed
    assert main(["verify", str(file), str(proof)]) == 0
    assert main(words) == 3
    assert main([*words, "--candidates", "grips"]) == 2
    assert main([*words, "--code", "gdv", "--accelerate", "1", "0", "0"]) == 2
    assert main(["hold", str(file), "--code", "gdv"]) == 2
    assert "--straps FILE.json" in capsys.readouterr().err
    assert main([*words, "--code", "eumos:0.1", "--json"]) == 1  # gravity of the file leans to -x
    data = json.loads(capsys.readouterr().out)
    assert (data["code"], [case["name"] for case in data["cases"]]) == (
        "eumos:0.1",
        ["forward", "backward", "left", "right"],
    )
    straps.write_text(json.dumps([candidates[0].to_dict()]))
    capsys.readouterr()
    assert main([*words, "--json"]) == 1
    data = json.loads(capsys.readouterr().out)
    assert (data["verdict"], data["least"], data["straps"]) == ("impossible", 2, [])
    assert np.isfinite(data["seconds"]["solve"])


def test_a_load_without_a_floor_is_told_to_get_one(tmp_path, capsys):
    """No strap helps in free fall, so that the next step is the missing floor."""
    load, straps = tmp_path / "load.csv", tmp_path / "straps.json"
    load.write_text("name,length,width,height,mass,x,y,z\nbox,1,1,1,50,0,0,0\n", "utf-8")
    ends = [["ground", [0.5, -0.5, 0]], ["box", [0.5, 0, 1]], ["box", [0.5, 1, 1]]]
    path = [*ends, ["ground", [0.5, 1.5, 0]]]
    straps.write_text(json.dumps([{"name": "s", "tension": 2000, "path": path}]))
    words = ["hold", str(load), "--straps", str(straps), "--code", "en12195"]
    assert main(words) == 1
    assert "--code en12195 --floor" in capsys.readouterr().out
    assert main([*words, "--floor", "--friction", "0.6"]) in (0, 3)
    assert "--floor\n" not in capsys.readouterr().out
