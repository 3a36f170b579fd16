"""Proposed changes of brick models, verified by the independent program."""

import json
import shlex
from dataclasses import replace

import numpy as np
import pytest
from bricks_apart import least_share

import kilter
from kilter.assembly.brick import BRICK_PLATES
from kilter.assembly.bricks.brick_assembly import assembly_of_bricks, bricks_of
from kilter.assembly.bricks.brick_library import brick_mass
from kilter.assembly.bricks.stud_rules import StudRules
from kilter.cli import main
from kilter.rigid import Pose
from kilter.scenes.random_bricks import random_bricks
from kilter.tell.improve_words import improve_sentence


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
    assembly = kilter.load(path, stud_pull=pull)
    found = kilter.improve(assembly)
    assert found.share == pytest.approx(1 / 0.95, rel=1e-6)
    assert found.weakest in (("2x4-1", "2x4-2"), ("2x4-1", "baseplate"), ("baseplate", "2x4-1"))
    assert found.best is not None
    assert found.best.share < 1
    before = {tuple(row[:5]): row for row in rows(assembly)}
    for change in found.tried:
        after = dict(before)
        key = (*change.corner[:2], change.corner[2] // BRICK_PLATES, *change.cells)
        if change.what == "remove":
            del after[key]
        else:
            after[key] = np.array([*key, brick_mass(*change.cells)])
        apart = least_share(list(after.values()), pull=pull)
        assert change.share == (np.inf if apart == np.inf else pytest.approx(apart, rel=1e-5))


@pytest.mark.slow
def test_a_brick_in_the_air_is_taken_away_or_reached(tmp_path):
    path = tmp_path / "air.txt"
    path.write_text("2x4 (0,0,0)\n2x4 (0,0,2)\n")
    found = kilter.improve(kilter.load(path))
    assert (found.verdict, found.share, found.weakest) == ("unstable", np.inf, None)
    assert found.stands
    assert found.best.what == "add"
    assert found.best.corner[2] == BRICK_PLATES
    assert {change.name for change in found.tried if change.what == "remove"} == {"2x4-2"}
    assert kilter.check(found.best.assembly).verdict == "stable"
    assert found.to_dict()["share"] is None
    assert found.sentence.startswith("It falls: no strength of its studs is enough. Add a brick")


@pytest.mark.slow
def test_the_next_step_has_the_options_of_bricks(tmp_path, capsys):
    path = tmp_path / "stair.txt"
    path.write_text("4x2 (0,0,0)\n4x2 (2,0,1)\n")
    options = ["--stud-pull", "0.5", "--stud-shear", "mu", "--brick-sides", "face"]
    assert main(["improve", str(path), *options, "--friction", "0.3", "--quiet"]) == 0
    step = capsys.readouterr().out.split("next: kilter ")[1].splitlines()[0]
    assert step.startswith("margin ")
    assert " ".join(options) in step
    assert step.endswith("--loads")
    assert main([*shlex.split(step), "--quiet"]) == 0


def test_what_no_one_brick_mends_is_told(tmp_path):
    path = tmp_path / "air.txt"
    path.write_text("2x4 (0,0,0)\n" + "".join(f"1x1 ({8 * k},0,5)\n" for k in range(1, 4)))
    found = kilter.improve(kilter.load(path))
    assert not found.stands
    assert found.best is None
    assert found.sentence.endswith("No change that was tried lowers this need.")


@pytest.mark.slow
def test_the_command_names_the_brick_and_writes_the_model(tmp_path, capsys):
    path, better = tmp_path / "stair.txt", tmp_path / "better.kilter.json"
    path.write_text("\n".join(f"4x2 ({2 * k},0,{k})" for k in range(6)))
    words = ["improve", str(path), "--stud-pull", "0.05"]
    assert main([*words, "--write", str(better)]) == 0
    told = capsys.readouterr().out
    found = kilter.improve(kilter.load(path, stud_pull=0.05))
    assert told.splitlines()[0] == found.sentence
    assert "weakest  the studs between" in told
    assert f"changed model  written to {better}" in told
    assert main(["check", str(better), "--quiet"]) == 0
    again = kilter.improve(kilter.load(better))
    assert again.share == pytest.approx(found.best.share, rel=1e-6)
    capsys.readouterr()
    assert main([*words, "--json", "--quiet"]) == 0
    assert json.loads(capsys.readouterr().out) == json.loads(json.dumps(found.to_dict()))
    alone = tmp_path / "alone.txt"
    alone.write_text("2x4 (0,0,0)\n" + "".join(f"1x1 ({8 * k},0,5)\n" for k in range(1, 4)))
    assert main(["improve", str(alone), "--write", str(better), "--quiet"]) == 1
    assert "changed model  not written" in capsys.readouterr().out
    assert main(["improve", str(path), "--write", str(path)]) == 2
    assert main(["example", "tower", "-o", str(tmp_path / "tower.json")]) == 0
    assert main(["improve", str(tmp_path / "tower.json")]) == 2
    assert "it is not a brick" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("answer", "said"),
    [
        ({"share": 0.4, "stands": True}, "It stands: its studs need 40 % of their strength."),
        ({"share": 1.00005, "stands": True}, "need 100.005 % of their strength."),
        ({"share": 0.0, "stands": True}, "its studs need not pull."),
    ],
)
def test_the_sentence_tells_what_is_needed(answer, said):
    whole = {"verdict": "stable", "best": None, **answer}
    assert said in improve_sentence(whole)
    best = {"what": "remove", "name": "2x4-3", "corner": [1, 2, 6], "layer": 2.0, "cells": [2, 4]}
    one = improve_sentence({**whole, "best": {**best, "share": 0.25}})
    assert one.endswith("Remove 2x4-3 in layer 2 at cell (1, 2): then it needs 25 %.")
    falls = {**whole, "verdict": "unstable", "stands": False, "best": {**best, "share": 1.5}}
    assert improve_sentence(falls).endswith(
        "No single brick is enough. The best change is: remove 2x4-3 in layer 2 at cell (1, 2)."
    )


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
        kilter.improve(kilter.example("tower"))
