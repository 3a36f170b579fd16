"""The film of a plan: a GLB with the time and path of each part, and marks of held parts."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from glb_reader import Film

import kilter
from kilter import Assembly, InputError
from kilter.scenes import scene
from kilter.scenes.arches import arch
from kilter.show.plan_film import LEAD, MOVES, STEP, film_of_plan


@pytest.fixture(scope="module")
def built() -> tuple[kilter.Order, Film]:
    order = kilter.plan(arch(9, ratio=0.3, friction=0.6))
    return order, Film(kilter.animate(order))


@pytest.mark.slow
def test_each_part_comes_at_its_step_along_its_way_to_its_seat(
    built: tuple[kilter.Order, Film],
) -> None:
    order, film = built
    for k, step in enumerate(order.steps):
        start = LEAD + k * STEP
        times, sizes, way = film.channel(step.part, "scale")
        assert (way, sizes.tolist()) == ("STEP", [[0] * 3, [1] * 3])
        assert times.tolist() == pytest.approx([0, start])
        times, places, _ = film.channel(step.part, "translation")
        assert times[[0, -1]].tolist() == pytest.approx([start, start + MOVES])
        rest = film.head["nodes"][film.names.index(step.part)]["translation"]
        assert np.allclose(places[-1], rest, atol=1e-5)
        away = places[:-1] - places[-1]
        along = away / np.linalg.norm(away, axis=1)[:, None]
        assert np.allclose(along, -np.array(step.direction), atol=1e-4)


@pytest.mark.slow
def test_a_mark_is_there_while_a_part_is_held(built: tuple[kilter.Order, Film]) -> None:
    order, film = built
    held = {name for step in order.steps for name in step.held}
    assert held
    for name in held:
        times, sizes, _ = film.channel(f"hold {name}", "scale")
        for k, step in enumerate(order.steps):
            now = sizes[np.searchsorted(times, LEAD + (k + 0.5) * STEP) - 1, 0]
            assert (now > 0) == (name in step.held)
        assert sizes[-1, 0] == 0 or name in order.steps[-1].held


@pytest.mark.parametrize("units", ["m", "mm"])
def test_at_rest_it_is_the_assembly_in_metres_with_y_up(units: str, tmp_path: Path) -> None:
    made = dataclasses.replace(scene("tower"), units=units)
    kilter.animate(kilter.plan(made), tmp_path / "tower.glb")
    read = kilter.load(tmp_path / "tower.glb")
    assert read.names == made.names
    metres = {"m": 1.0, "mm": 1e-3}[units]
    sizes = np.ptp(read.geometry.vertices, axis=0)[[0, 2, 1]]
    assert np.allclose(sizes, metres * np.ptp(made.geometry.vertices, axis=0), rtol=1e-5)
    rises = read.geometry.center[:, 1]
    assert (np.diff(rises) > 0).all()


def test_a_nut_turns_as_a_right_handed_thread_does_and_ends_at_rest() -> None:
    order = kilter.plan(scene("tower"))
    answer: dict[str, Any] = json.loads(json.dumps(order.to_dict()))
    answer["steps"][0]["over"] = "base"
    film = Film(film_of_plan(order.states.assembly, answer))
    times, turns, _ = film.channel("cube-1", "rotation")
    assert np.allclose(np.abs(turns[-1]), [0, 0, 0, 1], atol=1e-6)
    # the nut advances along -z, so the last quarter turn is right-handed about -z
    x, y, z, w = turns[-2]
    sign = 1.0 if w >= 0 else -1.0
    before = 2 * np.arctan2(sign * np.array([x, y, z]) @ [0, 0, -1], abs(w))
    assert before == pytest.approx(-np.pi / 2, abs=1e-5)
    assert len(times) == len(turns)


def test_without_an_order_there_is_no_film(tmp_path: Path) -> None:
    none = kilter.plan(arch(9, ratio=0.3, friction=0.6), kilter.PlanRules(hold=0))
    for write in (kilter.animate, kilter.draw):
        with pytest.raises(InputError, match="there are no steps to show"):
            write(none)
    with pytest.raises(InputError, match=r"ends in \.glb"):
        kilter.animate(none, tmp_path / "film.gltf")


@pytest.mark.slow
def test_the_same_plan_gives_the_same_bytes() -> None:
    made: Assembly = scene("paper-figure-9")
    assert kilter.animate(kilter.plan(made)) == kilter.animate(kilter.plan(made))
