"""Poses at rest by hand and by the command."""

import json
import math

import pytest

import kilter
from kilter import Assembly, Box, Part, Pose
from kilter.analysis.settled_pose.near_points import find_near_points
from kilter.analysis.settled_pose.rest_programs import RestPrograms
from kilter.analysis.settled_pose.rigid_bodies import rigid_bodies
from kilter.cli import main
from kilter.scenes.pieces import block

TABLE = block("table", [-500, -500, -10], [500, 500, 0], grounded=True)


def box(
    name: str, at: list[float], size: tuple[float, ...] = (100, 100, 100), **more: bool
) -> Part:
    return Part(name, Box(size), at, **more)


def settled(*parts: Part, **more: object) -> dict:
    return kilter.settle(Assembly([TABLE, *parts], units="mm", friction=0.3), **more).to_dict()


def test_a_box_that_hangs_and_one_that_is_sunk_move_by_their_gap():
    answer = settled(box("a", [0, 0, 50.5]), box("b", [300, 0, 49.9]))
    moved = {one["part"]: (one["distance"], one["angle_deg"]) for one in answer["moved"]}
    assert moved["a"] == pytest.approx((0.5, 0), abs=1e-6)
    assert moved["b"] == pytest.approx((0.1, 0), abs=1e-6)
    assert 0 <= answer["widest_gap"] <= answer["tolerance"]
    assert 0 <= answer["deepest_overlap"] <= answer["tolerance"]
    assert (answer["depth"], answer["rests"]) == (0, 2)


def test_a_box_falls_by_its_height_above_the_table():
    answer = settled(box("a", [0, 0, 80]))
    (moved,) = answer["moved"]
    (way,) = moved["way"]
    assert moved["distance"] == way["distance"] == pytest.approx(30, abs=1e-6)
    assert (way["how"], way["angle_deg"], answer["rests"]) == (
        "fell",
        pytest.approx(0, abs=1e-9),
        1,
    )
    scene = kilter.scene(Assembly([TABLE, box("a", [0, 0, 80])], units="mm"), settle=True)
    assert scene.to_dict()["objects"][1]["way"] == [way]


@pytest.mark.parametrize("tilt", [10, 40])
def test_a_tilted_box_turns_back_about_its_edge(tilt):
    """Its lower edge touches the table; friction 1 holds the edge."""
    angle = math.radians(tilt)
    height = 50 * (math.sin(angle) + math.cos(angle))
    pose = Pose([0, 0, height], [math.cos(angle / 2), 0, math.sin(angle / 2), 0])
    drawn = Assembly([TABLE, Part("a", Box(100, 100, 100), pose)], units="mm", friction=1.0)
    answer = kilter.settle(drawn, require="equilibrium").to_dict()
    (moved,) = answer["moved"]
    (way,) = moved["way"]
    assert (answer["state"], way["how"]) == ("at-rest", "tipped")
    assert way["angle_deg"] == pytest.approx(tilt, abs=1e-5)
    assert moved["angle_deg"] == pytest.approx(tilt, abs=1e-5)
    # the centre turns about the edge, at a distance of half a diagonal
    assert moved["distance"] == pytest.approx(100 * math.sqrt(2) * math.sin(angle / 2), abs=1e-4)
    report = kilter.scene(drawn, settle=True, require="equilibrium").to_dict()
    assert report["objects"][1]["way"] == [way]


def test_a_box_between_two_walls_that_are_closer_overlaps_each_by_half_of_the_rest():
    walls = [box(name, [x, 0, 50], grounded=True) for name, x in (("l", -100), ("r", 100))]
    answer = settled(*walls, box("wide", [0, 0, 50], (101, 100, 100)), nearest=True)
    assert answer["depth"] == pytest.approx(0.5, abs=1e-6)


@pytest.mark.slow
def test_a_bar_on_a_higher_and_a_lower_block_tilts_by_their_difference():
    """It touches the outer edge of the lower block and the inner edge of the higher one."""
    low, high = box("low", [-150, 0, 50]), box("high", [150, 0, 50.25], (100, 100, 100.5))
    answer = settled(low, high, box("bar", [0, 0, 110.5], (500, 100, 20)), nearest=True)
    (bar,) = [one for one in answer["moved"] if one["part"] == "bar"]
    turn = math.atan(0.5 / (200 + 100))
    assert bar["angle_deg"] == pytest.approx(math.degrees(turn), rel=1e-5)
    # its lower side passes through (-200, 100) and (100, 100.5), and its centre is 10 above it
    height = (100 + 200 * math.tan(turn)) + 10 / math.cos(turn)
    assert 110.5 - height <= bar["distance"] <= 110.5 - height + 0.1


@pytest.mark.slow
def test_objects_of_a_scene_state_their_height_and_their_place_below():
    turned = Pose([0, 0, 80], [math.sqrt(0.5), 0, 0, math.sqrt(0.5)])
    parts = [
        TABLE, Part("a", Box([100, 60, 100]), turned), box("b", [300, 0, 40]),
        box("c", [-300, 0, 50]),
    ]  # fmt: skip
    scene = Assembly(parts, units="mm", friction=0.3)
    answer = kilter.scene(scene).to_dict()
    found = {one["name"]: one for one in answer["objects"]}
    assert [found[name]["gap"] for name in "abc"] == [pytest.approx(30), pytest.approx(-10), None]
    assert found["a"]["move"]["position"] == pytest.approx([0, 0, 50])
    assert found["a"]["move"]["rotation"] == pytest.approx(turned.rotation)
    assert answer["counts"] == {"held": 1, "floats": 1, "overlaps": 1, "at-rest": 1}
    assert answer["geometry"] == {"as-drawn": 4}
    assert (answer["gravity"], answer["friction"]) == ([0, 0, -9.81], 0.3)
    moved = kilter.scene(scene, settle=True).to_dict()["moved"]
    assert moved == {"a": pytest.approx(30), "b": pytest.approx(10)}


def over_edge(overhang: float) -> Assembly:
    """A unit cube that overhangs the edge of a held block, drawn a little above it."""
    base = Part("base", Box(2, 2, 1), [-1, 0, -0.5], grounded=True)
    return Assembly([base, Part("cube", Box(1, 1, 1), [overhang - 0.5, 0, 0.501])], friction=0.5)


def in_slot(width: float) -> Assembly:
    """A block between two held walls that are 1 apart."""
    walls = [Part(f"wall-{x:+}", Box(1, 2, 2), [x, 0, 0], grounded=True) for x in (-1, 1)]
    floor = Part("floor", Box(3, 2, 1), [0, 0, -1.5], grounded=True)
    return Assembly([*walls, floor, Part("block", Box(width, 1, 1), [0, 0, -0.5])])


@pytest.mark.parametrize(
    ("assembly", "code", "state", "words"),
    [
        (over_edge(0.499), 0, "at-rest", "At rest"),
        (over_edge(0.501), 1, "falls", "falls"),
        (in_slot(1.001), 1, "does-not-fit", "do not fit"),
    ],
    ids=["at rest", "falls", "does not fit"],
)
def test_each_state_has_its_words_and_its_exit_code(assembly, code, state, words, tmp_path, capsys):
    file = str(tmp_path / "a.kilter.json")
    kilter.dump(assembly, file)
    assert main(["settle", file, "--nearest", "--quiet"]) == code
    assert words in capsys.readouterr().out.splitlines()[0]
    assert main(["settle", file, "--nearest", "--quiet", "--json"]) == code
    assert json.loads(capsys.readouterr().out)["state"] == state


@pytest.mark.parametrize(("weighs", "share"), [(False, 1 / 2), (True, 1 / 21)])
def test_the_heavier_of_two_cubes_moves_less_only_if_masses_weigh_the_motion(weighs, share):
    """Two cubes overlap by 1 mm; the least sum of m x^2 moves each by the other's share of mass."""
    cubes = [
        Part("light", Box([0.1, 0.1, 0.1]), [0, 0, 0], mass=1.0),
        Part("heavy", Box([0.1, 0.1, 0.1]), [0.099, 0, 0], mass=20.0),
    ]
    assembly = Assembly(cubes)
    points = find_near_points(assembly, 2e-3, 2e-3)
    bodies = rigid_bodies(assembly, ())
    inertia = bodies.mass if weighs else None
    programs = RestPrograms.of(bodies, points, 1.0, 1.0, inertia=inertia)
    light, heavy = programs.push_apart().reshape(2, 6)[:, 0]
    assert [-light, heavy] == pytest.approx([1e-3 * (1 - share), 1e-3 * share], abs=1e-9)
