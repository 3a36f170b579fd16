"""What to change in a model of bricks, judged by the program apart."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from bricks_apart import least_share

import kilter
from kilter.analysis.margins.brick_changes import what_to_change
from kilter.assembly.bricks.brick_assembly import assembly_of_bricks, bricks_of
from kilter.assembly.bricks.brick_library import BRICK_PLATES, brick_mass
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


def test_what_is_no_brick_is_named() -> None:
    with pytest.raises(kilter.InputError, match="part 'base': it is no brick"):
        what_to_change(kilter.example("tower"))
