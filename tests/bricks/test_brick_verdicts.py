"""Models of bricks: verdicts, changes, files and pages."""

import json
from dataclasses import replace
from html import escape
from pathlib import Path

import numpy as np
import pytest
from bricks_apart import PULL, least_share
from judged import reloaded, verified

import kilter
from kilter.analysis import everything as limits
from kilter.analysis.decision.bond_factor import BondFactor, find_bond_factor
from kilter.analysis.everything import everything
from kilter.analysis.margins.brick_changes import _percent
from kilter.assembly.bricks import BrickModel, StudRules, assembly_of_bricks
from kilter.assembly.bricks.brick_assembly import bricks_of
from kilter.assembly.bricks.brick_library import STABLE_LEGO
from kilter.assembly.part import BRICK_PLATES
from kilter.cli import main
from kilter.mechanics.program import build_program
from kilter.rigid import Pose
from kilter.scenes.random_bricks import random_bricks
from kilter.show.packing import unpack
from kilter.show.page import render
from kilter.show.scene import build_scene
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
        np.tile([0, 0, 4, 2], (count, 1)),
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
        np.array([*[[0, 0, 2, 2]] * 4, [0, 0, 6, 2], [0, 0, 2, 2]]),
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


def rows(assembly: kilter.Assembly) -> np.ndarray:
    model, _, _ = bricks_of(assembly)
    free = model.take(~model.held)
    corner = free.corner // [1, 1, BRICK_PLATES]
    return np.column_stack([corner, free.size[:, :2], free.mass])


@pytest.mark.slow
def test_a_stair_that_falls_needs_a_prop_or_a_step_less(tmp_path):
    path = tmp_path / "stair.txt"
    path.write_text("\n".join(f"4x2 ({2 * k},0,{k})" for k in range(7)))
    pull = 0.98 * 0.95 * least_share(rows(kilter.load(path)))
    found = kilter.margin(kilter.load(path, stud_pull=pull), improve=True)
    assert found.bond == pytest.approx(1 / 0.95, rel=1e-6)
    assert {change.what for change in found.improvements} == {"add", "remove"}
    assert found.improvements[0].limit < 1
    limits = [change.limit for change in found.improvements]
    assert np.allclose(limits, sorted(limits), atol=1e-9)
    for change in found.improvements:
        assert len(change.changed.parts) == len(found.assembly.parts) + (
            1 if change.what == "add" else -1
        )
        assert change.limit == pytest.approx(least_share(rows(change.changed), pull=pull), rel=1e-5)
        assert change.gain == pytest.approx(found.bond - change.limit)
        assert change.verdict == kilter.check(change.changed).verdict


@pytest.mark.slow
def test_a_brick_in_the_air_is_taken_away_or_reached(tmp_path):
    path = tmp_path / "air.txt"
    path.write_text("2x4 (0,0,0)\n2x4 (0,0,2)\n")
    found = kilter.margin(kilter.load(path), improve=True)
    assert (found.verdict, found.bond, found.missing["bond"]) == ("unstable", None, "none")
    best = found.improvements[0]
    assert best.what == "add"
    model, _, _ = bricks_of(best.changed)
    assert model.corner[best.changed.index_of(best.parts[0])][2] == BRICK_PLATES
    removed = {change.parts for change in found.improvements if change.what == "remove"}
    assert removed == {("2x4-2",)}
    assert best.verdict == kilter.check(best.changed).verdict == "stable"
    assert found.to_dict()["improvements"][0]["gain"] is None
    assert all("(none is enough) ->" in change.sentence for change in found.improvements)


def test_what_no_one_brick_mends_is_told(tmp_path):
    path = tmp_path / "air.txt"
    path.write_text("2x4 (0,0,0)\n" + "".join(f"1x1 ({8 * k},0,5)\n" for k in range(1, 4)))
    found = kilter.margin(kilter.load(path), improve=True)
    assert found.improvements == ()
    assert "no single change that was tried raises the limit" in " ".join(found.warnings)


@pytest.mark.slow
def test_the_command_names_the_brick_and_writes_the_model(tmp_path, capsys):
    path, better = tmp_path / "stair.txt", tmp_path / "better.kilter.json"
    path.write_text("\n".join(f"4x2 ({2 * k},0,{k})" for k in range(6)))
    words = ["margin", str(path), "--stud-pull", "0.05", "--improve"]
    assert main([*words, "--write", str(better)]) == 1  # of the given model
    told = capsys.readouterr().out
    best = kilter.margin(kilter.load(path, stud_pull=0.05), improve=True).improvements[0]
    assert best.sentence in told
    assert f"changed assembly  written to {better}" in told
    assert main(["check", str(better), "--quiet"]) == 0
    assert kilter.margin(kilter.load(better)).bond == pytest.approx(best.limit, rel=1e-6)
    capsys.readouterr()
    alone = tmp_path / "alone.txt"
    alone.write_text("2x4 (0,0,0)\n" + "".join(f"1x1 ({8 * k},0,5)\n" for k in range(1, 4)))
    before = better.read_bytes()
    main(["margin", str(alone), "--improve", "--write", str(better), "--quiet"])
    assert "changed assembly  not written" in capsys.readouterr().out
    assert better.read_bytes() == before
    assert main(["margin", str(path), "--improve", "--write", str(path)]) == 2
    assert main(["margin", str(path), "--write", str(better)]) == 2
    assert "add --improve or --make-stand" in capsys.readouterr().err


@pytest.mark.parametrize(("share", "words"), [(0.4, "40 %"), (1.00005, "100.005 %"), (0.0, "0 %")])
def test_a_share_near_all_of_the_strength_has_more_digits(share, words):
    assert _percent(share) == words


@pytest.mark.slow
def test_a_brick_off_the_grid_has_no_changes(tmp_path):
    path = tmp_path / "stair.txt"
    made = stair(path, 3)
    part = made.parts[2]
    moved = replace(part, pose=Pose(np.add(part.pose.position, [0, 0, 1e-3])))
    found = kilter.margin(
        replace(made, parts=[*made.parts[:2], moved, *made.parts[3:]]), improve=True
    )
    assert found.improvements == ()
    assert any("no changes were tried: " in warning for warning in found.warnings)


def test_the_bricks_of_an_assembly_are_those_it_was_made_of():
    model = random_bricks(20, seed=4)
    again, rules, cell = bricks_of(assembly_of_bricks(model))
    assert (rules.pull, rules.shear, rules.sides, cell) == (0.98, "unlimited", "lower-edge", 7.8)
    for name in ("corner", "size", "mass", "color", "number"):
        assert np.array_equal(getattr(again, name)[:20], getattr(model, name))
    assert again.held.tolist() == [False] * 20 + [True]


def test_a_model_written_as_a_kilter_file_is_of_the_same_bricks(tmp_path):
    model = replace(random_bricks(12, seed=2), color=np.arange(12))
    made = assembly_of_bricks(model, rules=StudRules(pull=0.5, sides="face"))
    kilter.dump(made, tmp_path / "a.kilter.json")
    again = kilter.load(tmp_path / "a.kilter.json")
    assert [part.brick for part in again.parts] == [part.brick for part in made.parts]
    (one, rules, cell), (other, same, width) = bricks_of(made), bricks_of(again)
    assert (rules, cell) == (same, width)
    assert all(np.array_equal(getattr(one, n), getattr(other, n)) for n in ("corner", "size"))


@pytest.mark.parametrize("pose", [Pose([0, 0, 1e-3]), Pose(rotation=[1, 0, 0, 1])])
def test_a_brick_off_the_grid_is_named(pose):
    made = assembly_of_bricks(random_bricks(5, seed=1))
    part = made.parts[3]
    moved = Pose(part.pose.position + pose.position, pose.rotation)
    parts = [*made.parts[:3], replace(part, pose=moved), *made.parts[4:]]
    with pytest.raises(kilter.InputError, match=f"part '{part.name}': it is not in the cells"):
        bricks_of(replace(made, parts=parts))


def test_what_is_no_brick_is_named():
    with pytest.raises(kilter.InputError, match="part 'base': it is not a brick"):
        bricks_of(kilter.example("tower"))


def stair(path: Path, steps: int, **options: object) -> kilter.Assembly:
    path.write_text("\n".join(f"4x2 ({2 * k},0,{k})" for k in range(steps)))
    return kilter.load(path, **options)


@pytest.mark.slow
def test_the_page_says_and_shows_which_brick_to_add(tmp_path):
    found = everything(stair(tmp_path / "stair.txt", 6, stud_pull=0.05))
    best = found.change
    assert best.what == "add"
    page = render(found, "stair")
    assert escape(best.sentence) in page
    assert "Show the brick to add" in page
    scene = build_scene(found)
    assert scene["change"]["part"] is None
    # the brick is at its place in the changed model
    added = best.changed.parts[best.changed.index_of(best.parts[0])]
    positions = unpack(scene["change"]["shape"]["positions"]).reshape(-1, 3)
    low = positions.min(axis=0) + scene["change"]["at"] + scene["center"]
    corner = np.array(added.pose.position) - np.array(added.shape.size) / 2
    assert np.allclose(low, corner, atol=1e-3)


@pytest.mark.slow
def test_the_page_of_what_stands_lists_what_is_still_taken(tmp_path):
    found = everything(stair(tmp_path / "stair.txt", 3))
    page = render(found, "stair")
    assert "Load capacities (3)" in page
    assert [one["part"] for one in found.margin["loads"]] == ["2x4-1", "2x4-2", "2x4-3"]


@pytest.mark.slow
def test_a_brick_to_take_away_is_the_part_of_the_page(tmp_path):
    assembly = stair(tmp_path / "stair.txt", 3)
    found = everything(assembly)
    removed = replace(found.change, what="remove", parts=assembly.names[:1])
    found = replace(found, change=removed)
    assert build_scene(found)["change"]["part"] == 0
    assert "Show the brick to remove" in render(found, "stair")


@pytest.mark.slow
def test_large_models_say_that_it_is_left_out_unless_it_is_asked_for(tmp_path, monkeypatch):
    monkeypatch.setattr(limits, "MARGIN_PARTS", 2)
    assembly = stair(tmp_path / "stair.txt", 3)
    found = everything(assembly)
    assert found.change is None
    assert any("up to 2 free parts" in note for note in found.notes)
    assert build_scene(found)["change"] is None
    assert everything(assembly, margins=True).change is not None


@pytest.mark.slow
def test_other_assemblies_have_nothing_to_change():
    found = everything(kilter.example("tower"))
    assert found.change is None
    assert not any("brick" in note for note in found.notes)
    assert "Show the brick" not in render(found, "tower")
