"""Numbers of the answers of `kilter.place` and `kilter.check_plan` against closed forms."""

from __future__ import annotations

from pathlib import Path

import pytest
import shapely

import kilter
from kilter import Assembly, Box, Part
from kilter.scenes.pieces import block

BASE = block("base", [-500, -500, -10], [0, 500, 0], grounded=True)
PLANK = Part("plank", Box([600, 200, 20]), [-100, 0, 10], density=500.0)
"""A plank of 1.2 kg from x = -400 to 200, which reaches 200 mm beyond its base."""
ASSEMBLY = Assembly([BASE, PLANK], units="mm")
LOAD = Part("load", Box([100, 100, 100]), mass=1.0)


def area(polygons: list) -> shapely.Geometry:
    return shapely.union_all([shapely.Polygon(outline, holes) for outline, *holes in polygons])


def test_the_places_of_a_load_on_a_base_and_on_a_plank_beyond_its_edge() -> None:
    """On the plank it may stand up to x = 1.2 kg x 100 mm / 1 kg beyond the edge of the base."""
    answer = kilter.place(ASSEMBLY, LOAD, mass=1.0).to_dict()
    assert (answer["mass"], answer["center_within"]) == ([1.0, 1.0], 0.0)
    low, high = answer["levels"]
    assert (low["height"], high["height"]) == (50, 70)
    # the load of 100 x 100 has its centre 50 from each side of the plank, or farther
    on_base = shapely.box(-500, -500, 0, 500) - shapely.box(-450, -150, 250, 150)
    on_plank = shapely.box(-400, -100, 120, 100)
    for level, stands in ((low, on_base), (high, on_plank)):
        assert shapely.symmetric_difference(area(level["stands"]), stands).area < 1
        assert level["area"] == pytest.approx(stands.area, rel=1e-6)
        assert level["open_strip"] == pytest.approx(area(level["open"]).area, abs=1e-6)
        assert level["open_strip"] < 1
        assert area(level["stands"]).intersection(area(level["falls"])).area < 1e-6
    reach = shapely.box(-450, -150, 250, 150)  # of a load that touches the plank
    assert shapely.symmetric_difference(area(high["falls"]), reach - on_plank).area < 1
    # the largest circle of places: in the strip beside the plank, or between its end and the edge
    best = answer["best"]
    assert best["margin"] == pytest.approx(350 / 2, abs=answer["accuracy"])
    assert (abs(best["y"]), best["height"]) == (pytest.approx(325, abs=answer["accuracy"]), 50)
    edge = on_base.boundary.distance(shapely.Point(best["x"], best["y"]))
    assert best["margin"] == pytest.approx(edge, abs=1e-3)


@pytest.mark.parametrize("x", [80, 150])
def test_the_heaviest_load_at_a_place_on_the_plank(x: float) -> None:
    answer = kilter.place(ASSEMBLY, LOAD, at=[x, 10]).to_dict()
    at = answer["at"]
    assert (at["x"], at["y"], at["height"]) == (x, 10, 70)
    assert at["heaviest"] == pytest.approx(1.2 * 100 / x, rel=1e-6)
    assert answer["heaviest"] == at["heaviest"]
    assert (at["verdict"] == "stable") is (x < 120)


HEADER = "name,length/mm,width/mm,height/mm,mass/kg,x/mm,y/mm,z/mm,max_load/kg\n"


@pytest.mark.slow
def test_a_plan_whose_third_box_has_its_centre_beside_the_second(tmp_path: Path) -> None:
    """Boxes of 400 mm: b on three fifths of a, c on a tenth of b and on nothing else."""
    plan = tmp_path / "plan.csv"
    rows = ["a,400,400,400,4,0,0,0,9", "b,400,400,400,3,160,0,400,", "c,400,400,400,2,520,0,800,"]
    plan.write_text(HEADER + "\n".join(rows))
    answer = kilter.check_plan(plan, friction=0.4).to_dict()
    a, b, c = answer["items"]
    assert [one["line"] for one in (a, b, c)] == [2, 3, 4]
    assert [one["mass"] for one in (a, b, c)] == [4, 3, 2]
    assert [one["share"] for one in b["support"]] == [pytest.approx(0.6)]
    assert [one["share"] for one in c["support"]] == [pytest.approx(0.1)]
    assert (a["max_load"], answer["first"], answer["friction"]) == (9, 3, 0.4)
    assert answer["walls"]["inner_size"] == [520 + 400, 400]
    # d keeps the walls away from c, which falls between them
    plan.write_text(HEADER + "\n".join([*rows, "d,400,400,400,9,1600,0,0,"]))
    walls = kilter.check_plan(plan, friction=0.4).to_dict()["walls"]
    assert (walls["inner_size"], walls["first"]) == ([2000, 400], 3)


@pytest.mark.slow
def test_a_pile_of_two_boxes_tips_about_the_foot_of_the_lower_one(tmp_path: Path) -> None:
    """4 kg at (200, 200) and 3 kg at (250, 600) stand on a foot from x = 0 to 400."""
    plan = tmp_path / "plan.csv"
    plan.write_text(HEADER + "a,400,400,400,4,0,0,0,\nb,400,400,400,3,50,0,400,\n")
    answer = kilter.check_plan(plan, friction=0.6, carried=True).to_dict()
    x, z = (4 * 200 + 3 * 250) / 7, (4 * 200 + 3 * 600) / 7
    expected = {"+x": x / z, "-x": (400 - x) / z, "+y": 200 / z, "-y": 200 / z}
    found = {one["direction"]: one["g"] for one in answer["carried"]}
    assert found == pytest.approx({**expected, "least": min(expected.values())}, rel=1e-6)
