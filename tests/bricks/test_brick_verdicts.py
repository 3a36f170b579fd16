"""Verdicts and load factors of brick models compared with an independent linear program."""

import json
from pathlib import Path

import numpy as np
import pytest
from bricks_apart import PULL, least_share
from judged import reloaded, verified

import kilter
from kilter.analysis.decision.bond_factor import BondFactor, find_bond_factor
from kilter.assembly.brick import BRICK_PLATES
from kilter.assembly.bricks import BrickModel, StudRules, assembly_of_bricks
from kilter.assembly.bricks.brick_library import STABLE_LEGO
from kilter.mechanics.program import build_program
from kilter.scenes.random_bricks import random_bricks
from sampled import sampled

SHARED = Path(__file__).resolve().parents[3] / "shared" / "data"
BUILT = {
    "stair_19": (True, 0.9007),
    "stair_20_good": (True, 0.9007),
    "stair_20": (False, 1.0055),
    "external_weight_good": (True, 0.6413),
    "external_weight_fail": (False, 1.1872),
}
"""Whether each model stands, and the share of .98 N per point that it needs."""
NEAR = 1e-3


def proved(assembly: kilter.Assembly) -> kilter.Verdict:
    """The verdict, after verifying its proof on an assembly that was written and read back."""
    verdict = kilter.check(assembly)
    proof = json.loads(json.dumps(verdict.proof(), allow_nan=False))
    answer = verified(reloaded(assembly), proof)
    assert answer.holds, answer.reasons
    assert answer.verdict == verdict.verdict
    return verdict


def share_of(assembly: kilter.Assembly) -> float:
    """The share of its strength that the weakest bond needs; inf if no strength suffices."""
    touching = kilter.contacts(assembly)
    found = find_bond_factor(build_program(assembly, touching), touching)
    return found.value if isinstance(found, BondFactor) else np.inf


def rows_of(model: BrickModel) -> np.ndarray:
    """The bricks as rows for the independent program."""
    corner = model.corner // [1, 1, BRICK_PLATES]
    return np.column_stack([corner, model.size[:, :2], model.mass])


@pytest.mark.slow
@pytest.mark.skipif(not SHARED.is_dir(), reason="no shared data")
@pytest.mark.parametrize("name", BUILT)
def test_models_that_were_built(name):
    path = SHARED / "stablelego" / f"{name}.json"
    stands, share = BUILT[name]
    assert (proved(kilter.load(path)).verdict == "stable") == stands
    rows = []
    for brick in json.loads(path.read_text()).values():
        across, along, mass = STABLE_LEGO[brick["brick_id"]]
        size = (along, across) if brick["ori"] else (across, along)
        rows.append((brick["x"], brick["y"], brick["z"], *size, mass))
    apart = least_share(rows)
    assert round(apart, 4) == share
    assert round(share_of(kilter.load(path)), 4) == share
    for factor, verdict in ((1 - NEAR, "unstable"), (1 + NEAR, "stable")):
        assembly = kilter.load(path, stud_pull=factor * apart * PULL)
        assert proved(assembly).verdict == verdict


@pytest.mark.slow
@pytest.mark.skipif(not SHARED.is_dir(), reason="no shared data")
def test_the_chair_stands():
    assembly = kilter.load(SHARED / "brickgpt" / "chair.txt")
    assert len(assembly) == 119
    assert proved(assembly).verdict == "stable"


@pytest.mark.quick(1)
@pytest.mark.parametrize("seed", sampled(12, 200))
def test_random_models_against_a_program_apart(seed):
    model = random_bricks(3 + seed % 23, seed=seed)
    share = least_share(rows_of(model))
    verdict = proved(assembly_of_bricks(model)).verdict
    assert share != pytest.approx(1, rel=1e-6)
    assert verdict == ("stable" if share < 1 else "unstable")
    # tolerance of the limit, as a fraction of the strength
    assert share_of(assembly_of_bricks(model)) == pytest.approx(share, rel=1e-6, abs=1e-6)
    if np.isfinite(share) and share > 0:
        for factor, word in ((1 - NEAR, "unstable"), (1 + NEAR, "stable")):
            rules = StudRules(pull=factor * share * PULL)
            assert kilter.check(assembly_of_bricks(model, rules=rules)).verdict == word


def line_of_bricks(count: int, *, layer: int = 0) -> BrickModel:
    """A stair of 2x4 bricks, each half over the brick below."""
    number = np.arange(count)
    none = np.zeros(count, dtype=np.int64)
    return BrickModel(
        np.column_stack([2 * number, none, BRICK_PLATES * (number + layer)]),
        np.tile([4, 2, BRICK_PLATES], (count, 1)),
        np.full(count, 0.00216),
        none,
        none > 0,
        number + 1,
        number + 1,
    )


def test_what_floats_falls_whatever_the_studs_hold():
    floats = line_of_bricks(2, layer=1)
    assert least_share(rows_of(floats)) == np.inf
    verdict = proved(assembly_of_bricks(floats, rules=StudRules(pull=1e3)))
    assert verdict.verdict == "unstable"
    assert verdict.moving == ["2x4-1", "2x4-2"]


def test_neighbours_push_at_the_lower_edge_or_all_over():
    model = random_bricks(30, seed=1)
    lower, over, none = (
        assembly_of_bricks(model, rules=StudRules(sides=sides)).contacts
        for sides in ("lower-edge", "face", "none")
    )
    assert len(over) == len(lower) > 0
    assert {len(one.points) for one in over} == {4}
    for edge, face in zip(lower, over, strict=True):
        assert np.array_equal(edge.points, face.points[:2])
        assert (face.points[2:, 2] > edge.points[0, 2]).all()
    assert not none


@pytest.mark.slow
def test_more_pull_never_brings_down_what_stands():
    model = random_bricks(20, seed=7)
    order = {"unstable": 0, "stable": 1}
    found = [
        order[kilter.check(assembly_of_bricks(model, rules=StudRules(pull=p))).verdict]
        for p in np.geomspace(1e-4, 10, 12)
    ]
    assert found == sorted(found)
    assert found[0] == 0
    assert found[-1] == 1


@pytest.mark.slow
def test_a_hanging_brick_needs_its_weight_over_its_points():
    """A 2x2 under the middle of a 2x6 on two towers: four studs of three points."""
    corner = [[0, 0, 0], [0, 0, 3], [4, 0, 0], [4, 0, 3], [0, 0, 6], [2, 0, 3]]
    number, none = np.arange(1, 7), np.zeros(6, dtype=np.int64)
    model = BrickModel(
        np.array(corner),
        np.array([*[[2, 2, 3]] * 4, [6, 2, 3], [2, 2, 3]]),
        np.array([*[0.00115] * 4, 0.00323, 0.00115]),
        none,
        none > 0,
        number,
        number,
    )
    least = 0.00115 * 9.8 / (4 * 3)
    assert least_share(rows_of(model)) * PULL == pytest.approx(least, rel=1e-9)
    for factor, word in ((1 - NEAR, "unstable"), (1 + NEAR, "stable")):
        verdict = proved(assembly_of_bricks(model, rules=StudRules(pull=factor * least)))
        assert verdict.verdict == word
    assert verdict.stable


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2])
def test_large_models_by_their_proofs(seed):
    """A model large enough for the large solver: forces or a motion, on both sides of the limit."""
    model = random_bricks(500, seed=seed)
    weak, strong = (
        proved(assembly_of_bricks(model, rules=StudRules(pull=pull))) for pull in (0.02, 20.0)
    )
    assert (weak.verdict, strong.verdict) == ("unstable", "stable")
    assert any("least forces of bonds" in word for word in strong.judgement.solvers)
    assert any("total imbalance" in word for word in weak.judgement.solvers)


@pytest.mark.slow
def test_many_models_at_once():
    rules = (StudRules(), StudRules(pull=0.001))
    models = [
        assembly_of_bricks(random_bricks(4 + seed, seed=seed), rules=rules[seed % 2])
        for seed in range(12)
    ]
    found = kilter.check_many(models)
    assert found.verdict.tolist() == [kilter.check(one).verdict for one in models]
    assert len(set(found.verdict.tolist())) == 2
