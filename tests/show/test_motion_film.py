"""The film of a motion: parts follow their screws and stop before they overlap."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest
import trimesh
from glb_reader import Film

import kilter
from kilter import Assembly, Box, InputError, Part, Pose, Sphere
from kilter.analysis.verdict.free_travel import ENTERS, REACH, free_travel
from kilter.cli import main
from kilter.rigid import matrix_to_quaternion, quaternion_to_matrix, screwed
from kilter.scenes import SCENES, scene


def gone(film: Film, name: str) -> np.ndarray:
    """Distance of a part from its start at each key."""
    _, rows, way = film.channel(name, "translation")
    assert way == "LINEAR"
    return rows - rows[0]


@pytest.mark.slow
def test_a_wedge_drives_the_other_out_by_the_slope_of_its_side() -> None:
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
def test_what_is_balanced_falls_along_its_path() -> None:
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
def test_a_block_falls_as_far_as_the_floor(gap: float) -> None:
    floor = Part("floor", Box([4, 4, 1]), Pose([0, 0, -0.5]), grounded=True)
    block = Part("block", Box([1, 1, 1]), Pose([0, 0, 0.5 + gap]))
    travel = free_travel(kilter.check(Assembly([floor, block])))
    diagonal = float(np.sqrt(3))
    assert not travel[0].any()
    assert gap - 0.03 < -travel[1, 2] <= gap + ENTERS * diagonal


def test_what_nothing_stops_goes_as_far_as_is_well_seen() -> None:
    floor = Part("floor", Box([4, 4, 1]), Pose([0, 0, -0.5]), grounded=True)
    far = Part("far", Box([1, 1, 1]), Pose([9, 0, 9]))
    travel = free_travel(kilter.check(Assembly([floor, far])))
    assert -travel[1, 2] == pytest.approx(REACH * 11.5), "from -2 to 9.5 along x"


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in SCENES if name.startswith("paper")])
def test_parts_end_no_deeper_in_each_other_than_they_begin(name: str) -> None:
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
        assert one.depth <= 1.01 * ENTERS * size[list(one.parts)].min()


@pytest.mark.slow
def test_two_that_tip_together_stay_together() -> None:
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
def test_other_programs_read_it(tmp_path: Path) -> None:
    out = tmp_path / "motion.glb"
    kilter.animate(kilter.check(scene("paper-figure-8")), out)
    read = trimesh.load(out)
    assert sorted(set(read.graph.nodes_geometry)) == ["C1", "C2", "C3"]


@pytest.mark.slow
def test_the_command_writes_it_and_refuses_what_it_cannot_show(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
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


def test_a_stable_assembly_is_refused_in_a_sentence() -> None:
    with pytest.raises(InputError, match="no part is known to move: Stable"):
        kilter.animate(kilter.check(scene("tower")))
    with pytest.raises(InputError, match="a region has no motion"):
        kilter.animate(kilter.region(scene("paper-figure-10")))
