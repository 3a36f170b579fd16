"""What to change in a model of bricks, judged by the program apart."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from bricks_apart import least_share

import kilter
from kilter.analysis.margins.brick_changes import what_to_change
from kilter.assembly.brick import BRICK_PLATES
from kilter.assembly.bricks.brick_assembly import assembly_of_bricks, bricks_of
from kilter.assembly.bricks.brick_library import brick_mass
from kilter.assembly.bricks.stud_rules import StudRules
from kilter.rigid import Pose
from kilter.scenes.random_bricks import random_bricks


def rows(assembly: kilter.Assembly) -> np.ndarray:
    model, _, _ = bricks_of(assembly)
    free = model.take(~model.held)
    corner = free.corner // [1, 1, BRICK_PLATES]
    return np.column_stack([corner, free.size[:, :2], free.mass])


def test_a_stair_that_falls_needs_a_prop_or_a_step_less(tmp_path: Path) -> None:
    path = tmp_path / "stair.txt"
    path.write_text("\n".join(f"4x2 ({2 * k},0,{k})" for k in range(7)))
    pull = 0.98 * 0.95 * least_share(rows(kilter.load(path)))
    assembly = kilter.load(path, stud_pull=pull)
    found = what_to_change(assembly)
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


def test_the_bricks_of_an_assembly_are_those_it_was_made_of() -> None:
    model = random_bricks(20, seed=4)
    again, rules, cell = bricks_of(assembly_of_bricks(model))
    assert (rules.pull, rules.shear, rules.sides, cell) == (0.98, "unlimited", "lower-edge", 7.8)
    for name in ("corner", "size", "mass", "color", "number"):
        assert np.array_equal(getattr(again, name)[:20], getattr(model, name))
    assert again.held.tolist() == [False] * 20 + [True]


def test_a_model_written_as_a_kilter_file_is_of_the_same_bricks(tmp_path: Path) -> None:
    model = replace(random_bricks(12, seed=2), color=np.arange(12))
    made = assembly_of_bricks(model, rules=StudRules(pull=0.5, sides="face"))
    kilter.dump(made, tmp_path / "a.kilter.json")
    again = kilter.load(tmp_path / "a.kilter.json")
    assert [part.brick for part in again.parts] == [part.brick for part in made.parts]
    (one, rules, cell), (other, same, width) = bricks_of(made), bricks_of(again)
    assert (rules, cell) == (same, width)
    assert all(np.array_equal(getattr(one, n), getattr(other, n)) for n in ("corner", "size"))


@pytest.mark.parametrize("pose", [Pose([0, 0, 1e-3]), Pose(rotation=[1, 0, 0, 1])])
def test_a_brick_off_the_grid_is_named(pose: Pose) -> None:
    made = assembly_of_bricks(random_bricks(5, seed=1))
    part = made.parts[3]
    moved = Pose(part.pose.position + pose.position, pose.rotation)
    parts = [*made.parts[:3], replace(part, pose=moved), *made.parts[4:]]
    with pytest.raises(kilter.InputError, match=f"part '{part.name}': it is not in the cells"):
        bricks_of(replace(made, parts=parts))


def test_what_is_no_brick_is_named() -> None:
    with pytest.raises(kilter.InputError, match="part 'base': it is no brick"):
        what_to_change(kilter.example("tower"))
