"""Verdicts of what the geometry leaves open: both sides, the set that decides, the census."""

from __future__ import annotations

import importlib.util
import json
import sys
from pathlib import Path

import numpy as np
import pytest
from judged import judged, reloaded, verified

from kilter import check
from kilter.analysis.decision.deciding_pairs import MOST
from kilter.assembly import Assembly, FrictionPair, Joint
from kilter.contact import Tolerance
from kilter.contact.contact_tolerances import GAP
from kilter.loading import load
from kilter.scenes.pieces import block, floor

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"
DATA = Path(__file__).resolve().parents[3] / "shared" / "data"
REAL = pytest.mark.skipif(not DATA.is_dir(), reason="real data is not here: ../shared/data")


def resting(gap: float, **options: object) -> Assembly:
    """A unit cube `gap` over a slab."""
    cube = block("cube", [-0.5, -0.5, gap], [0.5, 0.5, 1 + gap])
    return Assembly([floor([-2, -2], [2, 2]), cube], **options)


@pytest.mark.slow
@pytest.mark.parametrize("tolerances", [1.5, 50.0, -1.5, -50.0, -5000.0])
def test_what_is_not_quite_in_contact_is_undecided_and_decides(tolerances: float) -> None:
    verdict = judged(resting(tolerances * GAP * 3**0.5))
    assert verdict.verdict == "undecided"
    answer = verdict.to_dict()
    (pair,) = answer["open_pairs"]
    assert (pair["kind"], pair["decides"]) == ("near" if tolerances > 0 else "overlap", True)
    assert answer["if_joined"] == {
        "pairs": [pair["parts"]],
        "verdict": "stable",
        "smallest": True,
        "irreducible": True,
    }
    assert "as drawn it falls; it would hold if 'floor' and 'cube'" in verdict.sentence
    joined = verdict.assembly.with_joints([Joint(("floor", "cube"))])
    assert judged(joined).verdict == "stable"


@pytest.mark.quick(2)
@pytest.mark.parametrize("gap", [1e-4, -1e-4, -0.3])
def test_what_no_open_pair_can_hold_is_unstable_and_its_proof_names_them(gap: float) -> None:
    resting_parts = resting(gap).parts
    assembly = Assembly([*resting_parts, block("loose", [-0.5, -0.5, 3], [0.5, 0.5, 4])])
    verdict = judged(assembly)
    assert verdict.verdict == "unstable"
    proof = json.loads(json.dumps(verdict.proof()))
    kind = "near" if gap > 0 else "overlap"
    assert proof["open_pairs"] == [{"parts": ["floor", "cube"], "kind": kind}]
    answer = verified(reloaded(assembly), proof)
    assert answer.holds
    assert any("1 open pairs" in note for note in answer.notes)
    # a motion that an open pair could stop proves nothing
    proof["motion"]["cube"] = [0.0, 0, -1, 0, 0, 0]
    assert not verified(reloaded(assembly), proof).holds
    assert not any(pair["decides"] for pair in verdict.to_dict()["open_pairs"])


def test_the_smallest_set_is_found_among_many_and_the_rest_do_not_decide() -> None:
    # a tower of four over a gap between the second and the third; a wall beside all of them
    gap = 1e-4
    heights = [0.0, 1.0, 2.0 + gap, 3.0 + gap]
    tower = [block(f"c{k}", [0, 0, z], [1, 1, z + 1]) for k, z in enumerate(heights)]
    wall = block("wall", [1 + gap, 0, 0], [2, 1, 5], grounded=True)
    verdict = judged(Assembly([floor([-2, -2], [3, 3]), *tower, wall]))
    answer = verdict.to_dict()
    assert len(answer["open_pairs"]) == 5
    assert answer["if_joined"]["smallest"]
    assert len(answer["if_joined"]["pairs"]) == 1
    (pair,) = answer["if_joined"]["pairs"]
    assert set(pair) in ({"c1", "c2"}, {"c2", "wall"})


@pytest.mark.slow
@pytest.mark.parametrize("count", [MOST, MOST + 1])
def test_of_many_open_pairs_none_of_the_set_can_be_left_out(count: int) -> None:
    cubes = [block(f"c{k}", [2 * k, 0, 1e-4], [2 * k + 1, 1, 1]) for k in range(count)]
    verdict = check(Assembly([floor([-2, -2], [60, 3]), *cubes]))
    joined = verdict.to_dict()["if_joined"]
    assert joined["smallest"] == (count <= MOST)
    assert {name for pair in joined["pairs"] for name in pair} == {
        "floor",
        *(f"c{k}" for k in range(count)),
    }


def sloped(gap: float, mu: float) -> Assembly:
    """A cube on a slope of 20 degrees, its downhill end over a second support `gap` below."""
    rough = block("rough", [-1, -1, -1], [0.3, 1, 0], grounded=True)
    smooth = block("smooth", [0.3, -1, -1 - gap], [1, 1, -gap], grounded=True)
    pairs = [FrictionPair(("smooth", "cube"), mu)]
    cube = block("cube", [-0.5, -0.5, 0], [0.5, 0.5, 1])
    down = [np.sin(np.radians(20)), 0, -np.cos(np.radians(20))]
    parts = [rough, smooth, cube]
    return Assembly(parts, friction=0.5, friction_pairs=pairs).with_down(down)


@pytest.mark.slow
def test_what_friction_proves_holds_with_the_open_pairs_as_contacts_too() -> None:
    assert judged(sloped(5e-3, 0.01)).verdict == "stable"  # nothing is open
    touching = judged(sloped(0.0, 0.01))
    assert touching.guarantee == "refuted"
    for gap in (1e-4, -1e-4):
        verdict = judged(sloped(gap, 0.01))
        assert verdict.verdict == "potentially-stable"
        assert any("'smooth' and 'cube'" in text for text in verdict.warnings)


def test_a_widened_tolerance_says_what_it_rests_on() -> None:
    wide = check(resting(5e-4), tolerance=Tolerance(gap=1e-3))
    assert wide.verdict == "stable"
    assert wide.to_dict()["counted_gap"] == pytest.approx(5e-4)
    assert wide.sentence.startswith("Stable, counting gaps up to 0.0005 m as closed")
    assert "without friction" not in wide.sentence
    exact = check(resting(0.0), tolerance=Tolerance(gap=1e-3))
    assert exact.to_dict()["counted_gap"] is None
    assert "without friction" in exact.sentence


def census() -> object:
    path = BENCHMARKS / "open_pairs_census.py"
    spec = importlib.util.spec_from_file_location("open_pairs_census", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2, 5, 7, 8, 11])
def test_no_contact_set_between_contradicts_a_verdict(seed: int) -> None:
    assert census().asked(seed)[1] == []  # type: ignore[attr-defined]


@REAL
@pytest.mark.slow
def test_a_vault_as_published_names_the_pairs_that_decide() -> None:
    verdict = check(
        load(DATA / "compas_assembly" / "crossvault.json").with_friction(0.84), effort=0
    )
    assert verdict.verdict == "undecided"
    joined = verdict.to_dict()["if_joined"]
    assert joined["verdict"] in ("stable", "settles", "potentially-stable")
    kinds = {pair["kind"] for pair in verdict.to_dict()["open_pairs"] if pair["decides"]}
    assert kinds <= {"overlap", "near"}


@pytest.mark.slow
@REAL
def test_curved_joints_that_are_cut_differently_are_not_called_unstable() -> None:
    blocks = load(DATA / "compas_cra" / "curve-3-blocks.json", ground=["0"]).with_friction(0.84)
    assert check(blocks, effort=0).verdict != "unstable"
