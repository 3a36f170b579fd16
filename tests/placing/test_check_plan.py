"""Packing plans: the first item that falls, its reason, lists with faults."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import pytest

import kilter
from kilter.analysis.placing.check_plan import check_plan
from kilter.cli import main
from kilter.errors import InputError
from kilter.files.packing_lists import PackedBox, PackingPlan, load_plan

DATA = Path(__file__).resolve().parents[3] / "shared" / "data" / "packing" / "bed_bpp_plans.json"
HEADER = "name,length/mm,width/mm,height/mm,mass/kg,x/mm,y/mm,z/mm,turned\n"


def written(folder: Path, text: str, name: str = "plan.csv") -> Path:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def plan_of(*boxes: tuple[str, tuple, float, tuple]) -> PackingPlan:
    return PackingPlan(
        tuple(PackedBox(*box, line) for line, box in enumerate(boxes, 1)),
        "m",
    )


def test_a_centre_beside_its_support_falls() -> None:
    plan = plan_of(("a", (1, 1, 1), 1, (0, 0, 0)), ("b", (1, 1, 1), 1, (0.6, 0, 1)))
    checked = check_plan(plan)
    assert checked.first == 2
    assert checked.why == "the centre of 'b' lies 0.1 m beside the area on which it rests"
    assert checked.items[0].verdict == "stable"
    assert [support.to_dict()["support"] for support in checked.items][1][0]["part"] == "a"


def test_an_item_that_tips_the_item_below_it() -> None:
    plan = plan_of(
        ("base", (1, 1, 1), 1, (0, 0, 0)),
        ("plank", (2, 1, 0.1), 1, (-0.6, 0, 1)),
        ("load", (0.2, 0.2, 0.2), 9, (-0.6, 0.4, 1.1)),
    )
    checked = check_plan(plan)
    assert checked.first == 3
    assert checked.why == "'load' tips 'plank', on which it rests"


def test_a_pallet_ends() -> None:
    plan = plan_of(("a", (1, 1, 1), 1, (0.6, 0, 0)))
    assert check_plan(plan).first is None
    assert check_plan(plan, pallet=(1.0, 1.0)).first == 1


def test_held_parts_are_walls(tmp_path: Path) -> None:
    """A wall under the overhanging half of a box holds it."""
    plan = plan_of(("a", (1, 1, 1), 1, (0, 0, 0)), ("b", (1, 1, 1), 1, (0.6, 0, 1)))
    post = kilter.Part("post", kilter.Box([0.5, 1, 1]), kilter.Pose([1.4, 0.5, 0.5]), grounded=True)
    held = kilter.Assembly([post])
    assert check_plan(plan, held=held).first is None


def test_the_units_of_a_table(tmp_path: Path) -> None:
    text = "length [cm];width [cm];height [cm];weight [kg];x;y;z\n60;40;20;5;0;0;0\n"
    plan = load_plan(written(tmp_path, text))
    assert (plan.units, plan.boxes[0].size, plan.boxes[0].name) == ("cm", (60, 40, 20), "box 1")
    plain = "length,width,height,mass,x,y,z\n1,1,1,1,0,0,0\n"
    assert load_plan(written(tmp_path, plain)).units == "m"
    assert load_plan(written(tmp_path, plain), units="in").units == "in"
    with pytest.raises(InputError, match="the table is in cm"):
        load_plan(written(tmp_path, text), units="mm")


FAULTS = [
    ("name,length\n", "line 1: no column for width"),
    ("lenght,width,height,mass,x,y,z\n", "did you mean 'length'"),
    ("length/mm,width/cm,height,mass,x,y,z\n", "two length units, cm and mm"),
    ("length/ft,width,height,mass,x,y,z\n", "unknown unit 'ft'"),
    ("length,length,width,height,mass,x,y,z\n", "two columns for length"),
    ("length,width,height,mass/g,x,y,z\n", "mass in 'g'"),
    ("length,width,height,mass,x,y,z\n", "the table has no boxes"),
    ("length,width,height,mass,x,y,z\n1,1,-1,1,0,0,0\n", "line 2: height is -1"),
    ("length,width,height,mass,x,y,z\n1,1,1,0,0,0,0\n", "line 2: mass is 0"),
    ("length,width,height,mass,x,y,z\n1,a,1,1,0,0,0\n", "line 2: width is 'a'"),
    ("length,width,height,mass,x,y,z\n1,1,1,1,0,0\n", "line 2: z is ''"),
    ("length,width,height,mass,x,y,z\n1,1,1,1,0,0,inf\n", "line 2: the place is not finite"),
    (HEADER + "a,1,1,1,1,0,0,0,45\n", "line 2: turned is '45'"),
    (HEADER + "a,9,9,9,1,0,0,0,0\nb,2,2,2,1,1,1,1,0\n", "line 3: 'b' lies inside 'a' (line 2)"),
]


@pytest.mark.parametrize(("text", "said"), FAULTS)
def test_a_faulty_list_is_a_sentence(
    text: str, said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["check-plan", str(written(tmp_path, text))]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert error.count("\n") == 1


@pytest.mark.parametrize("data", [{}, {"a": []}, {"a": [{"item": {}}]}, [], 3])
def test_other_json_is_no_plan(data: object, tmp_path: Path) -> None:
    with pytest.raises(InputError):
        load_plan(written(tmp_path, json.dumps(data), "plan.json"))


def test_exit_codes_and_json(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    good = written(tmp_path, HEADER + "a,600,400,200,5,0,0,0,0\n")
    assert main(["check-plan", str(good), "--transport", "--friction", "0.4", "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert [round(entry["g"], 6) for entry in answer["carried"]] == [0.4] * 5
    bad = written(tmp_path, HEADER + "a,600,400,200,5,0,0,0,0\nb,600,400,200,5,350,0,200,0\n")
    assert main(["check-plan", str(bad)]) == 1
    out = capsys.readouterr().out
    assert out.startswith("Item 2, 'b', falls: the centre of 'b' lies 50 mm beside")
    assert "the plan names no walls" in out


def test_a_level_below_the_required_level_is_named() -> None:
    """The centre of the upper box lies above the edge of the lower: forces hold it, just."""
    plan = plan_of(("low", (1, 1, 1), 1, (0, 0, 0)), ("high", (1, 1, 1), 1, (0.5, 0, 1)))
    answer = check_plan(plan, require="strict").to_dict()
    assert not answer["stands"]
    assert answer["first"] is None
    assert answer["sentence"].endswith("the level strict is required.")


LEANING = ("a", (1, 1, 1), 1, (0.05, 0.1, 0)), ("b", (1, 1, 1), 1, (0.65, 0.1, 1))
"""A box whose centre lies 0.1 beside the box below it."""


def test_given_walls_hold_a_pile_that_leans_on_them() -> None:
    """With friction at a flush wall the upper box stands, without the wall it falls."""
    plan = plan_of(*LEANING)
    assert check_plan(plan, friction=0.5, require="equilibrium").first == 2
    flush = check_plan(plan, friction=0.5, walls=(1.65, 1.2), require="equilibrium")
    assert flush.first is None
    assert flush.walls is None
    assert check_plan(plan, friction=0.5, walls=(1.75, 1.2), require="equilibrium").first == 2
    walls = [part for part in flush.assembly.parts if part.name.startswith("wall")]
    assert len(walls) == 4
    assert all(part.grounded for part in walls)


@pytest.mark.parametrize(
    ("walls", "said"),
    [
        (("1.5", "1"), "item 2: 'b' lies beyond the walls, which are 1.5 x 1 m inside"),
        (("0", "1"), "give an inner length and width above 0"),
    ],
)
def test_wrong_walls_are_a_sentence(
    walls: tuple[str, str], said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = "name,length,width,height,mass,x,y,z\na,1,1,1,1,0,0,0\nb,1,1,1,1,0.6,0,1\n"
    assert main(["check-plan", str(written(tmp_path, text)), "--walls", *walls]) == 2
    error = capsys.readouterr().err
    assert said.replace("item 2", "line 3") in error
    assert error.count("\n") == 1


@pytest.mark.parametrize("walls", [True, 3.0, (1,), ("a", "b"), (0, 1), (math.inf, 1)])
def test_walls_of_another_form_are_a_sentence(walls: Any) -> None:
    plan = PackingPlan((PackedBox("a", (1, 1, 1), 1, (0, 0, 0), 1),), "m")
    with pytest.raises(InputError, match="the walls"):
        check_plan(plan, walls=walls)


def test_a_box_list_is_planned_from_above(tmp_path: Path) -> None:
    """Boxes in the reverse order of their heights, each with its centre over the box below."""
    rows = [f"b{k},1,1,1,1,{0.1 * (k % 2)},0,{k}\n" for k in reversed(range(8))]
    path = written(tmp_path, "name,length,width,height,mass,x,y,z\n" + "".join(rows))
    order = kilter.plan(
        kilter.load(path, floor=True), rules=kilter.PlanRules(directions=[(0, 0, 1)])
    )
    assert order.found
    assert [step.parts for step in order.steps] == [(f"b{k}",) for k in range(8)]


@pytest.mark.slow
def test_a_roll_container_stands_between_its_walls() -> None:
    """Known answers of the roll containers of BED-BPP with walls at their extents."""
    if not DATA.exists():
        pytest.skip("../shared/data is not here")
    plan = load_plan(DATA, order="00100003")
    walls = tuple(float(size) for size in (plan.high - plan.low)[:2])
    assert check_plan(plan, friction=0.5, require="equilibrium").first == 17
    held = check_plan(plan, friction=0.5, walls=walls, require="equilibrium")
    assert held.first is None
    assert held.stands
