"""The load that each part still takes, against closed forms and the program apart of bricks."""

from __future__ import annotations

import sys
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

import kilter
from kilter import Assembly, Bond, Box, Load, Part, Pose
from kilter.analysis.margins.margin import margin
from kilter.assembly.bricks.brick_assembly import bricks_of
from kilter.tell.tables import load_table

sys.path.append(str(Path(__file__).parents[1] / "bricks"))
from bricks_apart import least_share

G = 9.81
WEIGHT = 1000 * G


def cube(name, x=0.0, z=0.0, **more):
    return Part(name, Box([1, 1, 1]), Pose([x, 0, z]), **more)


def loads_of(assembly, **more):
    return {one.part: one for one in margin(assembly, loads=True, effort=0, **more).loads}


@pytest.mark.slow
def test_a_beam_on_an_edge_takes_what_it_weighs_on_the_other_side():
    # 3 long, its middle 0.5 inside the edge of the table; the block is on what stands out
    table = Part("table", Box([2, 1, 1]), Pose([-1, 0, -1]), grounded=True)
    beam = Part("beam", Box([3, 1, 1]), Pose([-0.5, 0, 0]))
    block = cube("block", x=0.5, z=1.0, mass=1.0)
    found = loads_of(Assembly([table, beam, block]))
    assert found["beam"].load == np.inf
    assert found["beam"].to_dict(margin(Assembly([table, beam])).program)["load"] is None
    # about the edge at 0: W 0.5 = (F + m g) 0.5
    limit = 3 * WEIGHT - G
    assert found["block"].load == pytest.approx(limit, rel=1e-6)
    assert limit <= found["block"].beyond * (1 + 1e-9) <= limit * 1.001


@pytest.mark.slow
@pytest.mark.parametrize("share", [0.999, 1.001])
def test_the_load_is_the_limit_of_what_check_says(share):
    cubes = [cube("wall", grounded=True), *[cube(f"c{k}", x=k) for k in (1, 2, 3)]]
    bonds = [Bond((a.name, b.name), pull=30_000) for a, b in pairwise(cubes)]
    assembly = Assembly(cubes, bonds=bonds)
    # about the wall's lower edge: 2 points pull by T at height 1, weights and load at k
    found = loads_of(assembly)
    for k in (1, 2, 3):
        limit = (2 * 30_000 - WEIGHT * 4.5) / (k - 0.5)
        held = min((2 * 30_000 - WEIGHT * m * m / 2) / (m - (3 - k) - 0.5) for m in range(4 - k, 4))
        assert held == pytest.approx(limit)
        assert found[f"c{k}"].load == pytest.approx(limit, rel=1e-6)
        loaded = Assembly(cubes, bonds=bonds, loads=[Load(f"c{k}", force=[0, 0, -share * limit])])
        assert (kilter.check(loaded).verdict == "stable") is (share < 1)


@pytest.mark.slow
def test_loads_of_bricks_are_those_of_the_program_apart(tmp_path):
    path = tmp_path / "stair.txt"
    path.write_text("\n".join(f"4x2 ({2 * k},0,{k})" for k in range(6)))
    assembly = kilter.load(path)
    model, rules, _ = bricks_of(assembly)
    free = model.take(~model.held)
    rows = np.column_stack([free.corner // [1, 1, 3], free.size[:, :2], free.mass])
    found = loads_of(assembly, pushed=["2x4-2", "2x4-4", "2x4-6"])
    assert len(found) == 3
    for k in (1, 3, 5):
        for share in (0.999, 1.001):
            heavier = rows.copy()
            heavier[k, 5] += share * found[f"2x4-{k + 1}"].load / 9.8
            assert (least_share(heavier, pull=rules.pull) < 1) is (share < 1)


def test_what_falls_takes_no_load():
    found = margin(Assembly([cube("base", grounded=True), cube("c", x=0.6, z=1.0)]), loads=True)
    assert found.loads == ()
    assert found.missing["load on c"] == "none"
    assert any("no push and no load" in text for text in found.warnings)


def test_the_table_names_the_least_load_first():
    def one(part, load):
        mass = None if load is None else load / G
        return {"part": part, "load": load, "mass": mass, "moves": [part] * (load is not None)}

    table = load_table(
        {
            "level": "proved",
            "at_level": None,
            "loads": [one("a", None), one("b", 9.81), one("c", 0.0981)],
        }
    )
    assert [row[:3] for row in table.rows(9)] == [
        ("c", "98.1 mN", "10 g"),
        ("b", "9.81 N", "1 kg"),
        ("a", "unlimited", ""),
    ]
    assert table.rows(1)[0][3] == "then c starts to move"
