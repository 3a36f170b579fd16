"""Places of the next part: closed forms on both sides, friction, prisms, refusals."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import shapely
from planks import overhang

import kilter
from kilter import Assembly, Box, Part, Pose
from kilter.analysis.placing.place import Places, box_to_place, place
from kilter.cli import main
from kilter.errors import InputError
from kilter.scenes import scene
from kilter.tell.text import text_of

SMALL = [1e-3, 1e-3, 0.1]
"""A box that is small, so that its centre and its contact are at the same place."""


def seesaw(weight: float, half: float) -> Assembly:
    base = Part("base", Box([2 * half, 1, 1]), Pose([0, 0, -0.5]), grounded=True)
    return Assembly([base, Part("plank", Box([2, 1, 0.1]), Pose([0, 0, 0.05]), mass=weight)])


def on_top(places: Places, height: float) -> shapely.Geometry:
    [level] = [
        level for level in places.levels if math.isclose(level.height - places.prism.below, height)
    ]
    return level.stands


@pytest.mark.parametrize(
    ("length", "weight", "beyond", "load"), [(1, 2, 0.3, 2.5), (1, 2, 0.4, 1), (1.2, 5, 0.5, 2)]
)
def test_a_load_on_an_overhanging_plank(
    length: float, weight: float, beyond: float, load: float
) -> None:
    limit = weight * (length / 2 - beyond) / load
    assembly, part = overhang(length, weight, beyond), box_to_place(SMALL, load)
    places = place(assembly, part, accuracy=1e-3)
    assert on_top(places, 0.1).bounds[2] == pytest.approx(limit, abs=1e-9)
    for side, verdict in ((-1e-6, "stable"), (1e-6, "unstable")):
        at = place(assembly, part, at=[limit + side, 0]).at
        assert at is not None
        assert at.verdict == verdict


@pytest.mark.parametrize("friction", [0.0, 0.4])
def test_no_place_on_a_held_part_stands_while_another_part_falls(friction: float) -> None:
    """A plank falls off the table unless the load on it lies far enough behind the edge."""
    falling = overhang(1, 2, 0.6).with_friction(friction)
    part = box_to_place(SMALL, 1)
    places = place(falling, part, accuracy=1e-3)
    assert [level.stands.area > 0 for level in places.levels] == [False, True]
    assert places.levels[0].open.area == 0
    assert on_top(places, 0.1).bounds[2] == pytest.approx(-2 * 0.1, abs=1e-6)
    for x, falls in ((-2, True), (-0.2 - 1e-5, False), (-0.2 + 1e-5, True)):
        at = place(falling, part, at=[x, 0], require="equilibrium").at
        assert at is not None
        assert (at.verdict == "unstable") == falls


@pytest.mark.parametrize(("x", "heaviest"), [(0.1, 4.0), (0.2, 2.0), (0.25, 1.6)])
def test_the_heaviest_load_at_a_place(x: float, heaviest: float) -> None:
    at = place(overhang(1, 2, 0.3), box_to_place(SMALL, 1.0), at=[x, 0]).at
    assert at is not None
    assert at.heaviest == pytest.approx(heaviest, rel=1e-6)


def test_order_decides_on_the_seesaw() -> None:
    """Two equal loads balance anywhere, but the first must stand alone."""
    alone, first = seesaw(2, 0.1), box_to_place([0.2, 0.2, 0.2], 8, name="first")
    assert not place(alone, first, at=[0.8, 0]).stands
    inner = place(alone, first, at=[0.1, 0]).at
    assert inner is not None
    both = place(
        inner.worst.assembly, box_to_place([0.2, 0.2, 0.2], 8, name="second"), at=[-0.7, 0]
    )
    assert not both.stands
    later = place(
        inner.worst.assembly, box_to_place([0.2, 0.2, 0.2], 1, name="light"), at=[-0.3, 0]
    )
    assert later.stands


def test_the_map_of_a_tower_is_its_top() -> None:
    places = place(scene("tower"), box_to_place([0.5, 0.5, 0.5], 1.0))
    assert places.stands
    top = shapely.box(-0.5, -0.5, 0.5, 0.5)
    assert shapely.symmetric_difference(on_top(places, 5.0), top).area < 1e-12
    assert places.best is not None
    assert (places.best.x, places.best.y, places.best.height) == pytest.approx(
        (0, 0, 5.25), abs=1e-6
    )
    data = places.to_dict()
    assert json.loads(json.dumps(data)) == data


def test_a_gripper_needs_room() -> None:
    table = Part("table", Box([4, 4, 1]), Pose([0, 0, -0.5]), grounded=True)
    tower = Part("tower", Box([1, 1, 2]), Pose([0, 0, 1]), mass=1)
    part = box_to_place([0.5, 0.5, 0.5], 1)
    free = on_top(place(Assembly([table, tower]), part), 0.0)
    clear = on_top(place(Assembly([table, tower]), part, clear=0.2), 0.0)
    assert free.covers(shapely.Point(0.8, 0))
    assert not clear.covers(shapely.Point(0.9, 0))
    assert clear.covers(shapely.Point(0.96, 0))


def test_a_part_without_a_level_top_is_left_open() -> None:
    table = Part("table", Box([4, 4, 1]), Pose([0, 0, -0.5]), grounded=True)
    ball = Part("ball", kilter.Sphere(0.5), Pose([0, 0, 0.5]), mass=1)
    places = place(Assembly([table, ball]), box_to_place([0.5, 0.5, 0.5], 1))
    assert "open" in places.warnings[0]
    level = places.levels[-1]
    assert level.stands.area == 0
    assert level.falls.area == 0
    assert level.open.area > 0


def test_places_that_are_only_open_are_undecided(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The top of a ball is left open; no light box holds a plank that falls."""
    ball = Part("ball", kilter.Sphere(1.0), Pose([0, 0, 1]), grounded=True)
    for assembly, code, said in (
        (Assembly([ball]), 4, "No place is proved"),
        (overhang(1, 2, 0.95), 1, "There is no place"),
    ):
        file = tmp_path / "file.kilter.json"
        kilter.dump(assembly, file)
        assert main(["place", str(file), "--box", "0.2x0.2x0.2", "--mass", "1"]) == code
        assert said in capsys.readouterr().out


WRONG = [
    (["--mass", "1"], "the part to put down is not given"),
    (["--box", "1x1", "--mass", "1"], "--box is '1x1'"),
    (["--box", "1x1x1"], "the mass of the box is not given"),
    (["--box", "1x1x-1", "--mass", "1"], ""),
    (["--box", "1x1x1", "--mass", "0"], ""),
    (["--box", "1x1x1", "--mass", "1", "--at", "90", "0"], "nothing is below the part"),
    (["--box", "1x1x1", "--mass", "1", "--part", "x.json"], "both given"),
    (["--box", "1x1x1", "--mass", "1", "--at", "0", "0", "--clear", "1"], "clear is a distance"),
    (["--box", "1x1x1", "--mass", "1", "--at", "0", "0", "--turn", "0", "--turn", "90"], "several"),
]


@pytest.mark.parametrize(("words", "said"), WRONG)
def test_a_wrong_question_is_refused(
    words: list[str], said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "tower.kilter.json"
    kilter.dump(scene("tower"), file)
    assert main(["place", str(file), *words]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert error.count("\n") == 1


def test_exit_codes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "plank.kilter.json"
    kilter.dump(overhang(1, 2, 0.3), file)
    part = ["--box", "0.01x0.01x0.1", "--mass", "2.5"]
    assert main(["place", str(file), *part]) == 0
    assert main(["place", str(file), *part, "--at", "0.1", "0"]) == 0
    assert main(["place", str(file), *part, "--at", "0.2", "0"]) == 1
    assert "would move" in capsys.readouterr().out


def test_gravity_must_act_downwards() -> None:
    with pytest.raises(InputError, match="gravity along -z"):
        place(scene("tower").with_down([1, 0, -1]), box_to_place(SMALL, 1))


def test_a_turned_box_has_a_turned_footprint() -> None:
    part = box_to_place([2.0, 1.0, 0.5], 1.0, turn=90)
    corners = Assembly([part]).geometry.vertices
    assert np.ptp(corners, axis=0) == pytest.approx([1.0, 2.0, 0.5])


@pytest.mark.parametrize("suffix", [".svg", ".png"])
def test_the_map_has_a_figure(suffix: str, tmp_path: Path) -> None:
    file, figure = tmp_path / "plank.kilter.json", tmp_path / f"map{suffix}"
    kilter.dump(overhang(1, 2, 0.3), file)
    part = ["--box", "0.1x0.1x0.1", "--mass", "2.5"]
    assert main(["place", str(file), *part, "--figure", str(figure)]) == 0
    assert figure.stat().st_size > 5000
    with pytest.raises(InputError, match="no map to draw"):
        kilter.draw(place(overhang(1, 2, 0.3), box_to_place(SMALL, 1), at=[0, 0]))


def test_a_given_place_has_no_figure(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "plank.kilter.json"
    kilter.dump(overhang(1, 2, 0.3), file)
    words = ["--box", "0.1x0.1x0.1", "--mass", "1", "--at", "0", "0", "--figure", "m.svg"]
    assert main(["place", str(file), *words]) == 2
    assert "a map has a figure" in capsys.readouterr().err


def density_warned(places: Places) -> bool:
    return any("kg/m^3 assumed" in warning for warning in places.warnings)


def with_plank(density: float | None, at: float, friction: float) -> Places:
    """A box of 5 kg on a plank of .05 m^3 that extends .3 m beyond its table."""
    table, plank = overhang(1, 2, 0.3).parts
    plank = replace(plank, given_mass=None, density=density)
    whole = Assembly([table, plank], friction=friction)
    return place(whole, box_to_place(SMALL, 5.0), at=[at, 0])


@pytest.mark.parametrize(
    ("at", "friction", "warned", "verdicts"),
    [
        (-0.3, 0.0, False, {"stable"}),  # over the table
        (0.1, 0.0, True, {"unstable", "stable"}),  # the plank is the counterweight
        (-0.3, 0.5, False, {"stable"}),  # friction is not needed
    ],
)
def test_the_default_density_is_a_warning_only_if_the_verdict_depends_on_it(
    at: float, friction: float, warned: bool, verdicts: set[str]
) -> None:
    assert density_warned(with_plank(None, at, friction)) == warned
    found = {with_plank(density, at, friction).at.verdict for density in (1.0, 1000.0, 1e5)}
    assert found == verdicts


def test_a_part_that_falls_at_every_density_has_no_warning() -> None:
    beside = place(scene("tower"), box_to_place([1, 1, 1], 2.0), at=[0.6, 0])
    assert not beside.stands
    assert beside.at.heaviest == 0.0
    assert "no mass is carried there" in text_of(beside.to_dict())
    assert not density_warned(beside)


def test_a_mixed_file_keeps_its_own_warning_about_density() -> None:
    base = Part("base", Box([2, 2, 1]), Pose([0, 0, -0.5]), grounded=True)
    light = Part("light", Box([1, 1, 1]), Pose([0, 0, 0.5]))
    assembly = Assembly([base, light, Part("heavy", Box([1, 1, 1]), [0, 0, 1.5], mass=3.0)])
    assert density_warned(place(assembly, box_to_place(SMALL, 1.0), at=[0, 0]))


def test_a_page_shows_the_map_and_the_part(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file, page = tmp_path / "tower.kilter.json", tmp_path / "map.html"
    kilter.dump(scene("tower"), file)
    asked = ["place", str(file), "--box", "0.5x0.5x0.5", "--mass", "1", "-o", str(page)]
    assert main(asked) == 0
    assert "page         written to" in capsys.readouterr().out
    html = page.read_text(encoding="utf-8")
    data = json.loads(html.split('type="application/json">')[1].split("</script>")[0])
    places = place(scene("tower"), box_to_place([0.5, 0.5, 0.5], 1.0))
    assert data["places"]["levels"] == places.to_dict()["levels"]
    assert data["places"]["part"]["footprint"] == places.prism.footprint.tolist()
    assert html.index('id="places"') < html.index('id="ball"')
    assert main([*asked, "--at", "0", "0"]) == 2
    assert "a page shows a map: no --at" in capsys.readouterr().err
    with pytest.raises(InputError, match="no map to show"):
        kilter.report(place(scene("tower"), box_to_place(SMALL, 1.0), at=[0, 0]))
