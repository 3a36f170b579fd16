"""Films of motions, falls and plans."""

import dataclasses
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from glb_reader import Film

import kilter
from kilter import Assembly, Box, Cylinder, InputError, Part, Pose, Sphere
from kilter.analysis.everything import everything
from kilter.analysis.verdict.free_travel import ENTERS, REACH, free_travel
from kilter.arrays import Array
from kilter.cli import main
from kilter.rigid import matrix_to_quaternion, quaternion_to_matrix, screwed
from kilter.scenes import SCENES, scene
from kilter.scenes.arches import arch
from kilter.show.packing import unpack
from kilter.show.plan_scene import LEAD, MOVES, STEP, film_of_plan
from kilter.show.scene import build_scene


def gone(film: Film, name: str) -> np.ndarray:
    """Distance of a part from its start at each key."""
    _, rows, way = film.channel(name, "translation")
    assert way == "LINEAR"
    return rows - rows[0]


@pytest.mark.slow
def test_a_wedge_drives_the_other_out_by_the_slope_of_its_side():
    verdict = kilter.check(scene("paper-figure-8"))
    film = Film(kilter.animate(verdict))
    assert film.animation["name"] == "motion"
    assert "C1" not in [film.names[c["target"]["node"]] for c in film.animation["channels"]]
    sinks, slides = gone(film, "C2"), gone(film, "C3")
    assert sinks[-1, 2] < -0.05
    assert slides[:, 0] == pytest.approx(-sinks[:, 2] / np.tan(np.radians(60)), abs=1e-6)
    speed = np.diff(np.linalg.norm(sinks, axis=1))[:-1]
    assert (np.diff(speed) > 0).all(), "ever faster, as what falls"


@pytest.mark.slow
def test_what_is_balanced_falls_along_its_path():
    base = Part("base", Sphere(1.0), grounded=True)
    film = Film(
        kilter.animate(kilter.check(Assembly([base, Part("ball", Sphere(0.5), Pose([0, 0, 1.5]))])))
    )
    assert film.animation["name"] == "fall"
    assert [film.names[c["target"]["node"]] for c in film.animation["channels"]] == ["ball"] * 2
    way = gone(film, "ball") + np.array([0, 0, 1.5])
    assert np.linalg.norm(way, axis=1) == pytest.approx(1.5, abs=1e-4)
    assert (np.diff(way[:-1, 2]) < 0).all()
    times, _, _ = film.channel("ball", "translation")
    assert (np.diff(times) > 0).all()


@pytest.mark.quick(1)
@pytest.mark.parametrize("gap", [0.1, 0.2])
def test_a_block_falls_as_far_as_the_floor(gap):
    floor = Part("floor", Box([4, 4, 1]), Pose([0, 0, -0.5]), grounded=True)
    block = Part("block", Box([1, 1, 1]), Pose([0, 0, 0.5 + gap]))
    travel = free_travel(kilter.check(Assembly([floor, block])))
    diagonal = float(np.sqrt(3))
    assert not travel[0].any()
    assert gap - 0.03 < -travel[1, 2] <= gap + ENTERS * diagonal


def test_what_nothing_stops_goes_as_far_as_is_well_seen():
    floor = Part("floor", Box([4, 4, 1]), Pose([0, 0, -0.5]), grounded=True)
    far = Part("far", Box([1, 1, 1]), Pose([9, 0, 9]))
    travel = free_travel(kilter.check(Assembly([floor, far])))
    assert -travel[1, 2] == pytest.approx(REACH * 11.5), "from -2 to 9.5 along x"


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in SCENES if name.startswith("paper")])
def test_parts_end_no_deeper_in_each_other_than_they_begin(name):
    verdict = kilter.check(scene(name))
    if not verdict.moving:
        pytest.skip("nothing moves")
    assembly, film = verdict.assembly, Film(kilter.animate(verdict))
    assert max(np.linalg.norm(gone(film, part)[-1]) for part in verdict.moving) > 1e-3
    parts = []
    for part, screw, center in zip(
        assembly.parts, free_travel(verdict), assembly.geometry.center, strict=True
    ):
        turns, shifts = screwed(screw, [1.0])
        at = center + turns[0] @ (part.pose.position - center) + shifts[0]
        turned = matrix_to_quaternion(turns[0] @ quaternion_to_matrix(part.pose.rotation))
        parts.append(dataclasses.replace(part, pose=Pose(at, turned)))
    moved = Assembly(parts, units=assembly.units)
    size = moved.geometry.size
    for one in kilter.contacts(moved).overlaps:
        assert one.depth <= 1.01 * ENTERS * size[list(one.ends)].min()


@pytest.mark.slow
def test_two_that_tip_together_stay_together():
    floor = Part("floor", Box([4, 4, 1]), Pose([0, 0, -0.5]), grounded=True)
    lower = Part("lower", Box([2, 1, 1]), Pose([2.2, 0, 0.5]))
    upper = Part("upper", Box([1, 1, 1]), Pose([2.2, 0, 1.5]))
    verdict = kilter.check(Assembly([floor, lower, upper], friction=0.9))
    assert verdict.moving == ["lower", "upper"]
    film = Film(kilter.animate(verdict))
    apart = []
    for name in ("lower", "upper"):
        _, places, _ = film.channel(name, "translation")
        _, turns, _ = film.channel(name, "rotation")
        frames = quaternion_to_matrix(turns[:, [3, 0, 1, 2]])
        corner = np.array([0.5, 0.5, 0.5 if name == "lower" else -0.5])
        apart.append(places + frames @ corner)
    assert np.linalg.norm(np.diff(apart[0], axis=0)) > 0.1
    assert apart[0] == pytest.approx(apart[1], abs=0.02)


@pytest.mark.slow
def test_other_programs_read_it(tmp_path):
    out = tmp_path / "motion.glb"
    kilter.animate(kilter.check(scene("paper-figure-8")), out)
    read = trimesh.load(out)
    assert sorted(set(read.graph.nodes_geometry)) == ["C1", "C2", "C3"]


@pytest.mark.slow
def test_the_command_writes_it_and_refuses_what_it_cannot_show(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    for name in ("paper-figure-8", "tower"):
        main(["example", name])
    capsys.readouterr()
    assert main(["draw", "paper-figure-8.kilter.json", "-o", "motion.glb", "--quiet"]) == 0
    assert Path("motion.glb").read_bytes()[:4] == b"glTF"
    for words, said in (
        (["tower.kilter.json"], "no part is known to move"),
        (["paper-figure-8.kilter.json", "--what", "region"], "a region has no motion"),
        (["paper-figure-8.kilter.json", "--view", "0", "0"], "a film has no view"),
    ):
        assert main(["draw", *words, "-o", "none.glb"]) == 2
        error = capsys.readouterr().err
        assert said in error
        assert error.count("\n") == 1
        assert not Path("none.glb").exists()


def test_a_stable_assembly_is_refused_in_a_sentence():
    with pytest.raises(InputError, match="no part is known to move: Stable"):
        kilter.animate(kilter.check(scene("tower")))
    with pytest.raises(InputError, match="a region has no motion"):
        kilter.animate(kilter.region(scene("paper-figure-10")))


@pytest.fixture(scope="module")
def built() -> tuple[kilter.Order, Film]:
    order = kilter.plan(arch(9, ratio=0.3, friction=0.6))
    return order, Film(kilter.animate(order))


@pytest.mark.slow
def test_each_part_comes_at_its_step_along_its_way_to_its_seat(built):
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
def test_a_mark_is_there_while_a_part_is_held(built):
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
def test_at_rest_it_is_the_assembly_in_metres_with_y_up(units, tmp_path):
    made = dataclasses.replace(scene("tower"), units=units)
    kilter.animate(kilter.plan(made), tmp_path / "tower.glb")
    read = kilter.load(tmp_path / "tower.glb")
    assert read.names == made.names
    metres = {"m": 1.0, "mm": 1e-3}[units]
    sizes = np.ptp(read.geometry.vertices, axis=0)[[0, 2, 1]]
    assert np.allclose(sizes, metres * np.ptp(made.geometry.vertices, axis=0), rtol=1e-5)
    rises = read.geometry.center[:, 1]
    assert (np.diff(rises) > 0).all()


def test_a_nut_turns_as_a_right_handed_thread_does_and_ends_at_rest():
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


def test_without_an_order_there_is_no_film(tmp_path):
    none = kilter.plan(arch(9, ratio=0.3, friction=0.6), kilter.PlanRules(hold=0))
    for write in (kilter.animate, kilter.draw):
        with pytest.raises(InputError, match="there are no steps to show"):
            write(none)
    with pytest.raises(InputError, match=r"ends in \.glb"):
        kilter.animate(none, tmp_path / "film.gltf")


@pytest.mark.slow
def test_the_same_plan_gives_the_same_bytes():
    made: Assembly = scene("paper-figure-9")
    assert kilter.animate(kilter.plan(made)) == kilter.animate(kilter.plan(made))


def array(packed: dict[str, str]) -> Array:
    return unpack(packed).astype(float)


def fall_of(assembly: Assembly) -> dict[str, Any] | None:
    found: dict[str, Any] | None = build_scene(everything(assembly))["given"]["fall"]
    return found


@pytest.mark.slow
def test_its_energy_is_in_joules_whatever_the_unit_of_length():
    base = Part("base", Sphere(100.0), grounded=True)
    aside = Part("aside", Sphere(10.0), Pose([900, 0, 0]), grounded=True)
    ball = Part("ball", Sphere(50.0), Pose([0, 0, 150]), mass=2.0)
    fall = fall_of(Assembly([base, aside, ball], units="mm"))
    assert fall is not None
    assert fall["parts"] == [2]
    places = fall["places"]
    heights = array(places["motions"]).reshape(-1, 1, 6)[:, 0, 2]
    energies = array(places["energies"])
    assert heights[-1] < -20
    np.testing.assert_allclose(energies, 2.0 * 9.81 * heights / 1000, rtol=1e-5, atol=1e-9)
    assert array(places["lengths"])[-1] > 90
    assert fall["words"].startswith("balanced: the slightest push makes ball fall")


@pytest.mark.slow
@pytest.mark.parametrize(("thick", "friction"), [(0.6, "holds"), (1.4, "falls")])
def test_it_says_what_friction_makes_of_it(thick, friction):
    """A board on a roller rolls back if its centre is at most the radius above the roller."""
    lying = Pose.of([[1, 0, 0], [0, 0, -1], [0, 1, 0]]).rotation
    roller = Part("roller", Cylinder(0.5, 2.0), Pose([0, 0, 0], lying), grounded=True)
    board = Part("board", Box([3, 1, thick]), Pose([0, 0, 0.5 + thick / 2]))
    fall = fall_of(Assembly([roller, board], friction=0.8))
    assert fall is not None
    assert fall["friction"] == friction
    assert fall["places"] is not None


@pytest.mark.slow
def test_what_is_not_balanced_has_none():
    assert fall_of(scene("tower")) is None
