"""The fewest straps of `kilter.hold`, against the decision of every set, and their proofs."""

from __future__ import annotations

import dataclasses
import itertools
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from lashings import direct, lashed, over, random_direct

import kilter
from kilter.cli import main
from kilter.mechanics.proof import digest_of
from kilter.scenes.pieces import block

G = 9.81


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
def test_random_candidates_agree_with_enumeration(first: int) -> None:
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
def test_one_strong_strap_replaces_two() -> None:
    load, candidates = load_and_candidates()
    assert fewest(load, candidates).chosen == (2,)
    two = fewest(load, candidates[:2])
    assert (two.chosen, two.least) == ((0, 1), 2)
    assert sum(strap.pull for strap in two.straps) == pytest.approx(3201.56, abs=0.1)
    assert fewest(load, candidates[:1]).verdict == "impossible"
    alone = dataclasses.replace(load, gravity=[0, 0, -G])
    assert fewest(alone, candidates).chosen == ()


def test_a_tensioned_strap_may_do_harm() -> None:
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


@pytest.mark.quick(1)
@pytest.mark.parametrize(("share", "count"), [(0.51, 1), (0.49, 2), (0.2501, 2), (0.2499, None)])
def test_the_same_straps_hold_all_directions_of_a_code(share: float, count: int | None) -> None:
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
def test_a_proof_about_a_code_shows_each_of_its_directions() -> None:
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
def test_damaged_proofs_are_found() -> None:
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
def test_the_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
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
