"""Packing plans: their states, loads on top, and the environment of learners."""

import importlib.util
import json
import math
from collections.abc import Iterable
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

import kilter
from kilter import InputError, check_plan, contacts
from kilter.analysis.placing import plan_states as states
from kilter.assembly.question import Question
from kilter.cli import main
from kilter.files.packing.packing_lists import PackedBox, PackingPlan, load_plan

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


def test_a_centre_beside_its_support_falls():
    plan = plan_of(("a", (1, 1, 1), 1, (0, 0, 0)), ("b", (1, 1, 1), 1, (0.6, 0, 1)))
    checked = check_plan(plan)
    assert checked.first == 2
    assert checked.why == "the centre of 'b' lies 0.1 m beside the area on which it rests"
    assert checked.items[0].verdict == "stable"
    assert [support.to_dict()["support"] for support in checked.items][1][0]["part"] == "a"


def test_an_item_that_tips_the_item_below_it():
    plan = plan_of(
        ("base", (1, 1, 1), 1, (0, 0, 0)),
        ("plank", (2, 1, 0.1), 1, (-0.6, 0, 1)),
        ("load", (0.2, 0.2, 0.2), 9, (-0.6, 0.4, 1.1)),
    )
    checked = check_plan(plan)
    assert checked.first == 3
    assert checked.why == "'load' tips 'plank', on which it rests"


def test_a_pallet_ends():
    plan = plan_of(("a", (1, 1, 1), 1, (0.6, 0, 0)))
    assert check_plan(plan).first is None
    assert check_plan(plan, pallet=(1.0, 1.0)).first == 1


def test_held_parts_are_walls(tmp_path):
    """A wall under the overhanging half of a box holds it."""
    plan = plan_of(("a", (1, 1, 1), 1, (0, 0, 0)), ("b", (1, 1, 1), 1, (0.6, 0, 1)))
    post = kilter.Part("post", kilter.Box([0.5, 1, 1]), kilter.Pose([1.4, 0.5, 0.5]), grounded=True)
    held = kilter.Assembly([post])
    assert check_plan(plan, held=held).first is None


def test_the_units_of_a_table(tmp_path):
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
def test_a_faulty_list_is_a_sentence(text, said, tmp_path, capsys):
    assert main(["check-plan", str(written(tmp_path, text))]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert error.count("\n") == 1


@pytest.mark.parametrize("data", [{}, {"a": []}, {"a": [{"item": {}}]}, [], 3])
def test_other_json_is_no_plan(data, tmp_path):
    with pytest.raises(InputError):
        load_plan(written(tmp_path, json.dumps(data), "plan.json"))


def test_exit_codes_and_json(tmp_path, capsys):
    good = written(tmp_path, HEADER + "a,600,400,200,5,0,0,0,0\n")
    assert main(["check-plan", str(good), "--transport", "--friction", "0.4", "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert [round(entry["g"], 6) for entry in answer["carried"]] == [0.4] * 5
    bad = written(tmp_path, HEADER + "a,600,400,200,5,0,0,0,0\nb,600,400,200,5,350,0,200,0\n")
    assert main(["check-plan", str(bad)]) == 1
    out = capsys.readouterr().out
    assert out.startswith("Item 2, 'b', falls: the centre of 'b' lies 50 mm beside")
    assert "the plan names no walls" in out


def test_a_level_below_the_required_level_is_named():
    """The centre of the upper box lies above the edge of the lower: forces hold it, just."""
    plan = plan_of(("low", (1, 1, 1), 1, (0, 0, 0)), ("high", (1, 1, 1), 1, (0.5, 0, 1)))
    answer = check_plan(plan, require="strict").to_dict()
    assert not answer["stands"]
    assert answer["first"] is None
    assert answer["sentence"].endswith("the level strict is required.")


LEANING = ("a", (1, 1, 1), 1, (0.05, 0.1, 0)), ("b", (1, 1, 1), 1, (0.65, 0.1, 1))
"""A box whose centre lies 0.1 beside the box below it."""


def test_given_walls_hold_a_pile_that_leans_on_them():
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
def test_wrong_walls_are_a_sentence(walls, said, tmp_path, capsys):
    text = "name,length,width,height,mass,x,y,z\na,1,1,1,1,0,0,0\nb,1,1,1,1,0.6,0,1\n"
    assert main(["check-plan", str(written(tmp_path, text)), "--walls", *walls]) == 2
    error = capsys.readouterr().err
    assert said.replace("item 2", "line 3") in error
    assert error.count("\n") == 1


@pytest.mark.parametrize("walls", [True, 3.0, (1,), ("a", "b"), (0, 1), (math.inf, 1)])
def test_walls_of_another_form_are_a_sentence(walls):
    plan = PackingPlan((PackedBox("a", (1, 1, 1), 1, (0, 0, 0), 1),), "m")
    with pytest.raises(InputError, match="the walls"):
        check_plan(plan, walls=walls)


def test_a_box_list_is_planned_from_above(tmp_path):
    """Boxes in the reverse order of their heights, each with its centre over the box below."""
    rows = [f"b{k},1,1,1,1,{0.1 * (k % 2)},0,{k}\n" for k in reversed(range(8))]
    path = written(tmp_path, "name,length,width,height,mass,x,y,z\n" + "".join(rows))
    order = kilter.plan(
        kilter.load(path, floor=True), rules=kilter.PlanRules(directions=[(0, 0, 1)])
    )
    assert order.found
    assert [step.parts for step in order.steps] == [(f"b{k}",) for k in range(8)]


@pytest.mark.slow
def test_a_roll_container_stands_between_its_walls():
    """Known answers of the roll containers of BED-BPP with walls at their extents."""
    if not DATA.exists():
        pytest.skip("../shared/data is not here")
    plan = load_plan(DATA, order="00100003")
    walls = tuple(float(size) for size in (plan.high - plan.low)[:2])
    assert check_plan(plan, friction=0.5, require="equilibrium").first == 17
    held = check_plan(plan, friction=0.5, walls=walls, require="equilibrium")
    assert held.first is None
    assert held.stands


STEP = 0.1
POST = kilter.Part("post", kilter.Box([0.5, 2, 0.2]), kilter.Pose([1.4, 1, 0.1]), grounded=True)
LOOSE = kilter.Part("loose", kilter.Box([0.2, 0.2, 0.2]), kilter.Pose([-2, 0, 0.1]), mass=1)
PIN = kilter.Part("pin", kilter.Cylinder(0.1, 1), kilter.Pose([-0.1, 0.2, 0.5]), grounded=True)
ARGUMENTS: list[dict[str, Any]] = [
    {},
    {"friction": 0.3},
    {"walls": (1.2, 1.2)},
    {"held": kilter.Assembly([POST])},
    {"held": kilter.Assembly([LOOSE])},
    {"held": kilter.Assembly([PIN])},
    {"pallet": (1.0, 1.0), "friction": 0.3, "require": "equilibrium"},
    {"require": "strict"},
]


def dropped(seed: int, count: int = 7) -> PackingPlan:
    """Boxes at the lowest of a few random places, on the highest box under them; some fall."""
    random = np.random.default_rng(seed)
    boxes: list[PackedBox] = []
    for k in range(count):
        sides = random.integers([2, 2, 1], [8, 8, 3])
        corners = random.integers(0, [12, 12] - sides[:2] + 1, size=(8, 2))
        places = [(_height_under(boxes, corner, sides), *corner.tolist()) for corner in corners]
        z, x, y = min(places)
        limit = float(random.choice([1, 20])) if seed % 2 and k % 3 == 0 else None
        length, width, height = (STEP * sides).tolist()
        mass, corner = float(random.choice([1, 5, 20])), (STEP * x, STEP * y, STEP * z)
        boxes.append(PackedBox(f"b{k}", (length, width, height), mass, corner, k + 1, limit))
    return PackingPlan(tuple(boxes), "m")


def _height_under(boxes: list[PackedBox], corner: Any, sides: Any) -> int:
    """Height of the highest box under a place [steps]."""
    height = 0
    for box in boxes:
        low, size = (np.rint(np.divide(x, STEP)).astype(int) for x in (box.corner, box.size))
        if (corner < (low + size)[:2]).all() and (corner + sides[:2] > low[:2]).all():
            height = max(height, int(low[2] + size[2]))
    return height


def grid(*counts: int) -> PackingPlan:
    """Boxes that touch their neighbours on all sides, layer by layer."""
    places = [(x, y, z) for z, y, x in np.ndindex(*reversed(counts))]
    return PackingPlan(
        tuple(
            PackedBox(f"b{k}", (0.3, 0.3, 0.2), 5, (0.3 * x, 0.3 * y, 0.2 * z), k + 1)
            for k, (x, y, z) in enumerate(places)
        ),
        "m",
    )


def data_of(plan: PackingPlan, arguments: dict[str, Any]) -> dict[str, Any]:
    return {**check_plan(plan, **arguments).to_dict(), "seconds": None}


def by_stacks(plan: PackingPlan) -> list[bool]:
    """Whether the stacks decide each state."""
    whole = plan.assembly().with_floor()
    found = states.plan_states(Question(assembly=whole, contacts=contacts(whole)), len(plan.boxes))
    return [state.verdict is None for state in found]


def compare(seeds: Iterable[int], monkeypatch: pytest.MonkeyPatch) -> None:
    cases = [(dropped(seed), ARGUMENTS[seed % len(ARGUMENTS)]) for seed in seeds]
    by_forces = [data_of(*case) for case in cases]
    monkeypatch.setattr(states, "_has_stacks", lambda *_: False)
    assert by_forces == [data_of(*case) for case in cases]
    assert {data["first"] is None for data in by_forces} == {True, False}


def test_stacks_and_checks_agree(monkeypatch):
    compare((1, 8), monkeypatch)


def test_a_tipping_box_ends_the_proofs_by_stacks():
    """The centre of 'c' lies beside 'a'; the later box 'd' is a counterweight on its other end."""
    base, size = PackedBox("a", (1, 1, 1), 9, (0, 0, 0), 1), (1.0, 1.0, 1.0)
    other = PackedBox("b", size, 1, (3, 0, 0), 2)
    tips = PackedBox("c", (2.2, 1, 1), 1, (0, 0, 1), 3)
    holds = PackedBox("d", size, 5, (0, 0, 2), 4)
    plan = PackingPlan((base, other, tips, holds), "m")
    assert by_stacks(plan) == [True, True, False, True]
    assert [item.verdict for item in check_plan(plan).items] == [
        *["stable"] * 2,
        "unstable",
        "stable",
    ]


def test_wrong_forces_of_a_stack_prove_nothing(monkeypatch):
    plan = grid(1, 1, 3)
    assert by_stacks(plan) == [True] * 3
    right = states.resting_forces
    monkeypatch.setattr(states, "resting_forces", lambda *given: 1.001 * right(*given))
    assert by_stacks(plan) == [False] * 3


HEADER_LOADS = "name,length,width,height,mass,x,y,z,max_load/kg\n"
COLUMN = "a,1,1,1,9,0,0,0,{}\nb,1,1,1,2,0,0,1,\nc,1,1,1,3,0,0,2,\n"
BRIDGE = "a,1,1,1,9,0,0,0,{}\nb,1,1,1,9,2,0,0,\nc,3,1,1,4,0,0,1,\n"
NARROW = "a,0.02,1,1,9,0,0,0,{}\nb,0.02,1,1,9,2.98,0,0,\nc,3,1,1,4,0,0,1,\nd,0.1,1,1,6,0.7,0,2,\n"
NEAR = 1e-6


def written_loads(folder: Path, rows: str, limit: object) -> Path:
    path = folder / "plan.csv"
    path.write_text(HEADER_LOADS + rows.format(limit), encoding="utf-8")
    return path


@pytest.mark.parametrize("friction", [0.0, 0.4])
def test_boxes_in_a_column(tmp_path, friction):
    """All of the weight above rests on the lowest top: 2 + 3 kg."""
    below = check_plan(written_loads(tmp_path, COLUMN, 5 * (1 - NEAR)), friction=friction)
    assert below.overload is not None
    assert below.first is None
    assert (below.overload.item, below.overload.after) == ("a", 3)
    assert below.overload.load == pytest.approx(5, rel=1e-9)
    above = check_plan(written_loads(tmp_path, COLUMN, 5 * (1 + NEAR)), friction=friction)
    assert above.overload is None
    assert above.items[0].top_load == pytest.approx(5, rel=1e-9)
    assert above.items[1].top_load is None


def test_a_bridge_on_two_wide_boxes(tmp_path):
    """The lever rule with the force on 'a' at its outer end, x = 0, and on 'b' at its inner end.

    About x = 2: load 2 = 4 (2 - 1.5), so the least load is 1 kg, not half of the weight.
    """
    assert check_plan(written_loads(tmp_path, BRIDGE, 1 - NEAR)).overload is not None
    assert check_plan(written_loads(tmp_path, BRIDGE, 1 + NEAR)).overload is None


def test_a_loaded_bridge_on_two_narrow_boxes(tmp_path):
    """Forces at x = 0 and x = 2.98: load 2.98 = 4 (2.98 - 1.5) + 6 (2.98 - 0.75)."""
    load = (4 * 1.48 + 6 * 2.23) / 2.98
    over = check_plan(written_loads(tmp_path, NARROW, load * (1 - NEAR))).overload
    assert over is not None
    assert over.after == 4
    assert check_plan(written_loads(tmp_path, NARROW, load * (1 + NEAR))).overload is None


def test_the_command(tmp_path, capsys):
    path = str(written_loads(tmp_path, COLUMN, 4))
    assert main(["check-plan", path, "--quiet"]) == 1
    words = "Item 3, 'c', overloads 'a': its top must carry 5 kg, and its limit is 4 kg."
    assert words in " ".join(capsys.readouterr().out.split())
    assert main(["check-plan", path, "--json", "--quiet"]) == 1
    assert json.loads(capsys.readouterr().out)["overload"]["max_load"] == 4
    assert main(["check-plan", str(written_loads(tmp_path, COLUMN, 6)), "--quiet"]) == 0


def test_an_invalid_limit(tmp_path):
    with pytest.raises(InputError, match="line 2: max_load is -1"):
        load_plan(written_loads(tmp_path, COLUMN, -1))
    with pytest.raises(InputError, match="line 2: max_load is 'heavy'"):
        load_plan(written_loads(tmp_path, COLUMN, "heavy"))
    path = tmp_path / "newton.csv"
    path.write_text(HEADER_LOADS.replace("/kg", "/N") + COLUMN.format(1), encoding="utf-8")
    with pytest.raises(InputError, match="line 1: max_load in 'N'"):
        load_plan(path)


EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "packing_env.py"


def example() -> ModuleType:
    pytest.importorskip("gymnasium", reason="gymnasium is not installed: pip install gymnasium")
    spec = importlib.util.spec_from_file_location("packing_env", EXAMPLE)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_environment_keeps_the_rules_of_gymnasium():
    module = example()
    from gymnasium.utils.env_checker import check_env

    check_env(module.PackingEnv(), skip_render_check=True)


def test_allowed_actions_keep_the_pile_standing():
    env = example().PackingEnv()
    _, info = env.reset(seed=4)
    rng = np.random.default_rng(4)
    for _ in range(8):
        allowed = np.flatnonzero(info["action_mask"])
        _, reward, ended, _, info = env.step(int(rng.choice(allowed)))
        assert reward > 0
        assert env.pile.stands
        assert ended == (not info["action_mask"].any())
    forbidden = int(np.flatnonzero(info["action_mask"] == 0)[0])
    _, reward, ended, _, _ = env.step(forbidden)
    assert (reward, ended, len(env.pile)) == (-1.0, True, 8)
