"""The page of a brick model: proposed changes, load capacity, and drawing of bricks."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import kilter
from kilter.analysis import everything as limits
from kilter.analysis.everything import everything
from kilter.show.packing import unpack
from kilter.show.page import render
from kilter.show.scene import build_scene


def stair(path: Path, steps: int, **options: object) -> kilter.Assembly:
    path.write_text("\n".join(f"4x2 ({2 * k},0,{k})" for k in range(steps)))
    return kilter.load(path, **options)


@pytest.mark.slow
def test_the_page_says_and_shows_which_brick_to_add(tmp_path):
    found = everything(stair(tmp_path / "stair.txt", 6, stud_pull=0.05))
    best = found.change.best
    assert best.what == "add"
    page = render(found, "stair")
    assert found.change.sentence in page
    assert "Show the brick to add" in page
    scene = build_scene(found)
    assert scene["change"]["part"] is None
    # the brick is at its place in the changed model
    added = best.assembly.parts[best.assembly.index_of(best.name)]
    positions = unpack(scene["change"]["shape"]["positions"]).reshape(-1, 3)
    low = positions.min(axis=0) + scene["change"]["at"] + scene["center"]
    corner = np.array(added.pose.position) - np.array(added.shape.size) / 2
    assert np.allclose(low, corner, atol=1e-3)


@pytest.mark.slow
def test_the_page_of_what_stands_lists_what_is_still_taken(tmp_path):
    found = everything(stair(tmp_path / "stair.txt", 3))
    page = render(found, "stair")
    assert "Load capacities (3)" in page
    assert "Changes tried" in page
    assert [one["part"] for one in found.margin["loads"]] == ["2x4-1", "2x4-2", "2x4-3"]


@pytest.mark.slow
def test_a_brick_to_take_away_is_the_part_of_the_page(tmp_path):
    assembly = stair(tmp_path / "stair.txt", 3)
    found = everything(assembly)
    removed = next(one for one in found.change.tried if one.what == "remove")
    found = replace(found, change=replace(found.change, best=removed))
    part = build_scene(found)["change"]["part"]
    assert assembly.names[part] == removed.name
    assert "Show the brick to remove" in render(found, "stair")


@pytest.mark.slow
def test_large_models_say_that_it_is_left_out_unless_it_is_asked_for(tmp_path, monkeypatch):
    monkeypatch.setattr(limits, "CHANGE_PARTS", 2)
    assembly = stair(tmp_path / "stair.txt", 3)
    found = everything(assembly)
    assert found.change is None
    assert any("up to 2 bricks" in note for note in found.notes)
    assert build_scene(found)["change"] is None
    assert everything(assembly, margins=True).change is not None


@pytest.mark.slow
def test_other_assemblies_have_nothing_to_change():
    found = everything(kilter.example("tower"))
    assert found.change is None
    assert not any("brick" in note for note in found.notes)
    assert "Recommended change" not in render(found, "tower")
