"""`kilter.scene`: the state of each object, by closed forms and on both sides of each limit."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import kilter
from kilter import Assembly, Box, Cylinder, InputError, Joint, Load, Mesh, Part, Pose, Sphere
from kilter.analysis.scene_states import survey
from kilter.arrays import Array
from kilter.cli import main
from kilter.contact.contact_tolerances import GAP

TABLE = Part("table", Box([10, 10, 1]), [0, 0, -0.5], grounded=True)


def rotation_about(axis: list[float], angle: float) -> Array:
    """Rotation matrix about an axis by an angle [rad]."""
    turn: Array = Rotation.from_rotvec(angle * np.array(axis) / np.linalg.norm(axis)).as_matrix()
    return turn


def cube(name: str, x: float, z: float, y: float = 0.0) -> Part:
    """A unit cube whose underside is at height z."""
    return Part(name, Box([1, 1, 1]), [x, y, z + 0.5])


def states(*parts: Part, **options: object) -> dict[str, str]:
    report = kilter.scene(Assembly([TABLE, *parts]), **options)  # type: ignore[arg-type]
    return {entry.name: entry.state for entry in report if entry.name != "table"}


def test_one_fault_of_each_kind_does_not_hide_the_others():
    report = kilter.scene(
        Assembly(
            [
                TABLE,
                cube("rests", -4, 0),
                cube("floats", -2, 0.25),
                cube("sunk", 0, -0.25),
                cube("below", 2, 0),
                cube("overhangs", 2.6, 1),
            ]
        )
    )
    assert report.counts == {
        "at-rest": 2, "held": 1, "floats": 1, "overlaps": 1, "falls": 1,
    }  # fmt: skip
    assert (report["rests"].level, report["below"].if_held) == ("proved", ("overhangs",))
    floating = report["floats"]
    assert floating.other == "table"
    assert floating.gap == pytest.approx(0.25, abs=1e-15)
    assert floating.pose == Pose([-2, 0, 0.5])
    assert (report["sunk"].gap, report["sunk"].other) == (-0.25, "table")
    assert "tips" in report["overhangs"].motion
    assert not report.at_rest
    assert report.level is None


@pytest.mark.parametrize("shift", [1e-5, 1e-4, 1e-3, 1e-2, 1e-1])
@pytest.mark.parametrize("side", [1, -1])
def test_each_gap_above_the_tolerance_is_a_fault_of_its_size(shift, side):
    size = 2 * np.sqrt(0.75)  # of the unit cube: the smaller part
    factor = 1.2 if shift == 1e-5 else 1.0
    gap = side * factor * shift * size
    report = kilter.scene(Assembly([TABLE, cube("a", 0, gap), cube("b", 3, 0)]), assume="drawn")
    assert report["a"].state == ("floats" if side > 0 else "overlaps")
    assert report["a"].gap == pytest.approx(gap, rel=1e-9)
    assert report["b"].state == "at-rest"


@pytest.mark.parametrize(
    ("share", "aside", "state"),
    [(0, 0, "floats"), (0.99, 0, "falls"), (1, 0, "at-rest"), (1, 0.02, "falls")],
)
def test_an_object_that_only_a_load_carries_is_judged(share, aside, state):
    """A force upward of a share of the weight, through a point beside the middle."""
    drawn = Assembly([TABLE, cube("box", 0, 0.25), cube("low", 2, 0)])
    force = [0, 0, share * 9.81 * drawn.geometry.mass[1]]
    load = Load("box", force, point=[aside, 0, 0.5])
    report = kilter.scene(replace(drawn, loads=[load]))
    assert (report["box"].state, report["low"].state) == (state, "at-rest")


@pytest.mark.parametrize(("gap", "state"), [(1.9e-3, "at-rest"), (2.1e-3, "floats")])
def test_a_gap_within_the_play_of_a_large_object_is_no_fault(gap, state):
    """The play of a cube of 1 m is 2 mm, the most."""
    assert states(cube("a", 0, gap))["a"] == state


@pytest.mark.parametrize("side", [1, -1])
def test_a_gap_within_the_tolerance_is_a_contact(side):
    assert states(cube("a", 0, side * 0.8 * GAP * 1.7))["a"] == "at-rest"


def test_the_objects_of_a_floating_stack_have_the_same_height():
    report = kilter.scene(
        Assembly([TABLE, cube("a", 0, 0.5), cube("b", 0.2, 1.5), cube("c", -0.1, 2.5)])
    )
    assert [report[name].gap for name in "abc"] == [0.5] * 3
    assert {report[name].other for name in "abc"} == {"table"}
    moved = Assembly([replace(p, pose=report[p.name].pose or p.pose) for p in report.assembly])
    assert kilter.check(moved).verdict == "stable"


def test_the_height_is_that_above_the_first_part_below():
    report = kilter.scene(Assembly([TABLE, cube("a", 0, 0), cube("b", 0.9, 1.25)]))
    assert (report["b"].gap, report["b"].other) == (0.25, "a")
    beside = kilter.scene(Assembly([TABLE, cube("a", 0, 0), cube("b", 1.1, 1.25)]))
    assert (beside["b"].gap, beside["b"].other) == (1.25, "table")


def test_an_object_at_a_wall_that_touches_nothing_below_floats():
    wall = Part("wall", Box([1, 10, 10]), [-0.5, 0, 5], grounded=True)
    report = kilter.scene(Assembly([TABLE, wall, cube("a", 0.5, 0.125)]))
    assert (report["a"].state, report["a"].gap, report["a"].other) == ("floats", 0.125, "table")


def test_nothing_below_is_a_fall():
    report = kilter.scene(Assembly([TABLE, cube("a", 20, 3)]))
    assert (report["a"].state, report["a"].motion) == ("falls", "nothing is below it")


@pytest.mark.quick(2)
@pytest.mark.parametrize(
    ("shape", "low"),
    [(Sphere(0.5), 0.5), (Cylinder(0.5, 2.0), 1.0), (Cylinder(0.5, 2.0), 0.5)],
    ids=["ball", "upright", "lying"],
)
@pytest.mark.parametrize("gap", [1e-3, 0.3])
def test_the_height_of_a_round_object_is_exact(shape, low, gap):
    lying = low == 0.5 and isinstance(shape, Cylinder)
    turn = rotation_about([0.3, 1.0, 0], np.pi / 2) if lying else np.eye(3)
    pose = Pose.of(turn)
    part = Part("round", shape, Pose([0.1, 0.2, low + gap], pose.rotation))  # type: ignore[arg-type]
    report = kilter.scene(Assembly([TABLE, part, cube("b", 3, 0)]), assume="drawn")
    assert report["round"].state == "floats"
    assert report["round"].gap == pytest.approx(gap, abs=1e-11)


def test_the_height_of_a_ball_above_a_ball_is_exact():
    """Two unit balls, beside each other by 0.6: they touch at a height of 1.6 of the centres."""
    low = Part("low", Sphere(1.0), [0, 0, 1.0], grounded=True)
    high = Part("high", Sphere(1.0), [0.72, 0.96, 1.0 + 1.6 + 0.5])
    report = kilter.scene(Assembly([TABLE, low, high]))
    assert report["high"].other == "low"
    assert report["high"].gap == pytest.approx(0.5, abs=1e-9)


def test_an_overlap_of_free_objects_is_reported_once_for_the_upper_one():
    report = kilter.scene(Assembly([TABLE, cube("upper", 0.1, 0.9), cube("lower", 0, 0)]))
    assert (report["upper"].state, report["upper"].other) == ("overlaps", "lower")
    assert report["upper"].gap == pytest.approx(-0.1, rel=1e-12)
    assert report["lower"].state == "at-rest"


def test_the_same_body_twice_is_reported_once():
    found = states(cube("a", 0, 0), cube("b", 0, 0), cube("c", 3, 0))
    assert sorted(found.values()) == ["at-rest", "at-rest", "overlaps"]
    assert found["c"] == "at-rest"


def test_an_object_on_a_sunk_object_is_at_rest_if_that_stays():
    report = kilter.scene(Assembly([TABLE, cube("sunk", 0, -0.01), cube("on it", 0.2, 0.99)]))
    assert report["sunk"].state == "overlaps"
    assert (report["on it"].state, report["on it"].if_held) == ("at-rest", ("sunk",))
    assert "if sunk stays as drawn" in report["on it"].words


@pytest.mark.parametrize(("overhang", "state"), [(0.499, "at-rest"), (0.501, "falls")])
def test_an_overhang_falls_beyond_a_half(overhang, state):
    assert states(cube("a", 0, 0), cube("b", overhang, 1))["b"] == state


@pytest.mark.parametrize(("friction", "state"), [(0.51, "at-rest"), (0.49, "falls")])
def test_a_box_on_a_slope_of_one_half(friction, state):
    slope = rotation_about([0, 1, 0], np.arctan(0.5))
    held = Part("slope", Box([10, 10, 1]), Pose.of(slope), grounded=True)
    box = Part("box", Box([1, 1, 1]), Pose(slope @ [0, 0, 1.0], Pose.of(slope).rotation))
    report = kilter.scene(Assembly([held, box]), friction=friction)
    assert report["box"].state == state


@pytest.mark.parametrize(
    ("gap", "state"), [(0.0, "at-rest"), (1e-3, "open"), (1e-1, "falls")], ids=str
)
@pytest.mark.slow
def test_a_near_support_leaves_only_its_object_open(gap, state):
    """A plate that overhangs its block rests on a post, ends a little above it, or falls."""
    block = Part("block", Box([1, 1, 1]), [0, 0, 0.5], grounded=True)
    post = Part("post", Box([0.1, 1, 1]), [1.5, 0, 0.5 - gap], grounded=True)
    plate = Part("plate", Box([3, 1, 0.1]), [0.9, 0, 1.05])
    report = kilter.scene(Assembly([TABLE, block, post, plate, cube("b", -3, 0)]))
    assert report["b"].state == "at-rest"
    assert report["plate"].state == state
    if state == "open":
        assert (report["plate"].other, report["plate"].gap) == ("post", pytest.approx(gap))


def test_an_object_on_a_joint_belongs_to_the_cluster_of_its_partner():
    parts = [TABLE, cube("a", 0, 0), cube("b", 0, 2)]
    joint = Joint(("a", "b"))
    report = kilter.scene(Assembly(parts, joints=[joint]))
    assert report.counts == {"at-rest": 2, "held": 1}
    assert len(report.verdicts) == 1
    hung = kilter.scene(Assembly(parts, joints=[Joint(("b", "ground"))]))
    assert {hung["a"].state, hung["b"].state} == {"at-rest"}


@pytest.mark.quick(1)
@pytest.mark.parametrize("seed", range(30))
def test_each_state_at_rest_is_a_verdict_with_forces(seed):
    """Random piles: the states of a scene are the verdicts of `check` on each pile alone."""
    from kilter.scenes.random_bricks import box_pile

    piles = [box_pile(4, seed=10 * seed + k, cells=3, level=bool(k % 2)) for k in range(4)]
    whole = piles[0]
    for k, pile in enumerate(piles[1:], 1):
        moved = [
            replace(
                p,
                name=f"{k}/{p.name}",
                pose=Pose(p.pose.position + np.array([40.0 * k, 0, 0]), p.pose.rotation),
            )
            for p in pile
        ]
        whole = whole.with_parts(moved)
    report = kilter.scene(whole, assume="drawn")
    for k, pile in enumerate(piles):
        verdict = kilter.check(pile)
        prefix = f"{k}/" if k else ""
        found = {p.name: report[prefix + p.name] for p in pile if not p.grounded}
        if verdict.level is not None:
            assert {entry.state for entry in found.values()} == {"at-rest"}
        else:
            assert {name for name, entry in found.items() if entry.state != "at-rest"} >= set(
                verdict.moving
            )
            assert verdict.moving
    holding = [verdict for verdict in report.verdicts if verdict.level is not None]
    assert all(verdict.evidence is not None for verdict in holding)


def test_nothing_held_is_one_sentence_and_all_held_is_at_rest():
    with pytest.raises(InputError, match="nothing is held"):
        kilter.scene(Assembly([cube("a", 0, 0)]))
    report = kilter.scene(Assembly([TABLE]))
    assert report.at_rest
    assert report.to_dict()["sentence"] == "Every object is held."


def test_a_wrong_name_is_an_error_that_names_the_right_one():
    report = kilter.scene(Assembly([TABLE, cube("cup", 0, 0)]))
    with pytest.raises(InputError, match="did you mean 'cup'"):
        report["cupp"]


BALANCED = Part(
    "cone",
    Mesh(
        [[0, 0, 0], [2, 0, 2], [-1, 1.5, 2], [-1, -1.5, 2]],
        [[0, 2, 1], [0, 3, 2], [0, 1, 3], [1, 2, 3]],
    ),
    [-3, 0, 0],
)
NEAR_POST = [
    Part("block", Box([1, 1, 1]), [0, 0, 0.5], grounded=True),
    Part("post", Box([0.1, 1, 1]), [1.5, 0, 0.499], grounded=True),
    Part("plate", Box([3, 1, 0.1]), [0.9, 0, 1.05]),
]


@pytest.mark.parametrize(
    ("parts", "options", "code"),
    [
        ([cube("a", 0, 0)], [], 0),
        ([cube("a", 0, 0.5)], [], 1),
        ([BALANCED, cube("a", 3, 0)], [], 3),
        ([*NEAR_POST, cube("a", -3, 0)], [], 4),
    ],
    ids=["rest", "fault", "lower", "open"],
)
@pytest.mark.slow
def test_the_exit_code_of_the_command(parts, options, code, tmp_path, capsys):
    kilter.dump(Assembly([TABLE, *parts]), tmp_path / "s.kilter.json")
    assert main(["scene", str(tmp_path / "s.kilter.json"), *options]) == code
    lines = capsys.readouterr().out
    assert "the shapes of the file" in lines
    assert "\n  a  " in lines.replace("      ", "  ")


def test_every_object_has_a_line(tmp_path, capsys):
    parts = [cube(f"cube {k:02}", 1.2 * (k % 6) - 3, 0, 1.2 * (k // 6) - 3) for k in range(30)]
    kilter.dump(Assembly([TABLE, *parts]), tmp_path / "s.kilter.json")
    main(["scene", str(tmp_path / "s.kilter.json")])
    text = capsys.readouterr().out
    assert all(f"cube {k:02}" in text for k in range(30))
    assert text.startswith("All 30 free objects are at rest (level proved).")


# repair ---------------------------------------------------------------------------------------


@pytest.mark.slow
def test_a_repair_moves_objects_by_their_faults():
    parts = [
        cube("rests", -4, 0),
        cube("floats", -2, 0.25),
        cube("sunk", 0, -0.01),
        cube("below", 2, 0),
        cube("overhangs", 2.6, 1),
        Part("ball", Sphere(0.5), [4, 3, 0.4995]),
    ]
    report = kilter.scene(Assembly([TABLE, *parts]), settle=True)
    assert report.counts == {"at-rest": 6, "held": 1}
    assert "tipped" in [way.how for way in report["overhangs"].way]
    expected = {"floats": 0.25, "sunk": 0.01, "ball": 0.0005}
    moved = {name: far for name, far in report.moved.items() if name in expected}
    assert moved == pytest.approx(expected, rel=1e-6)
    assert report.drawn is not None
    assert kilter.scene(Assembly([TABLE, *parts]), assume="drawn").moved == {}


def test_a_scene_without_faults_stays_as_it_is():
    drawn = Assembly([TABLE, cube("a", 0, 0), cube("b", 0.1, 1)])
    report = kilter.scene(drawn, settle=True)
    assert report.at_rest
    assert report.assembly == drawn
    assert report.moved == {}


@pytest.mark.quick(1)
@pytest.mark.parametrize("ending", [".kilter.json", ".xml", ".glb"])
def test_the_repaired_scene_is_written(ending, tmp_path, capsys):
    file, out = str(tmp_path / "s.kilter.json"), tmp_path / f"out{ending}"
    kilter.dump(Assembly([TABLE, cube("a", 0, 0.5), cube("b", 3, -0.01)]), file)
    assert main(["scene", file, "--settle", "-o", str(out)]) == 0
    assert "moved     2 objects by up to 0.5 m" in capsys.readouterr().out
    if ending == ".xml":
        pytest.importorskip("mujoco", reason="mujoco is not installed")
    held = [] if ending != ".glb" else ["--ground", "table", "--up", "y"]
    assert main(["scene", str(out), *held]) == 0


@pytest.mark.slow
def test_a_repaired_usd_scene_is_a_layer(tmp_path):
    pytest.importorskip("pxr", reason="usd-core is not installed: pip install 'kilter[usd]'")
    from pxr import Usd, UsdGeom, UsdPhysics

    file = tmp_path / "s.usda"
    stage = Usd.Stage.CreateNew(str(file))
    UsdGeom.SetStageUpAxis(stage, "Z")
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    for name, height in (("floor", -1.0), ("a", 1.5), ("b", 0.99)):
        place = UsdGeom.Cube.Define(stage, f"/{name}")
        place.AddTranslateOp().Set((4.0 if name == "b" else 0.0, 0.0, height))
        UsdPhysics.CollisionAPI.Apply(place.GetPrim())
        if name == "floor":
            place.AddScaleOp().Set((9.0, 9.0, 1.0))
        else:
            UsdPhysics.RigidBodyAPI.Apply(place.GetPrim())
    stage.GetRootLayer().Save()
    before = file.read_bytes()
    out = tmp_path / "rest.usda"
    assert main(["scene", str(file)]) == 1
    assert main(["scene", str(file), "--settle", "-o", str(out)]) == 0
    assert main(["scene", str(out)]) == 0
    assert file.read_bytes() == before
    assert "subLayers" in out.read_text(encoding="utf-8")


def random_scene(seed: int) -> Assembly:
    """Stacks on a table of which some float, lean over, sink, touch each other, or carry a load."""
    random, parts = np.random.default_rng(seed), []
    for stack in range(12):
        top = float(random.choice([0.0, 0.0, 0.0, 0.3, -0.002]))
        x, y = stack % 4 + random.uniform(-0.08, 0.08), stack // 4 - 1.0
        for k in range(random.integers(1, 4)):
            size = random.uniform(0.3, 0.9, 3)
            parts.append(Part(f"{stack}-{k}", Box(size), Pose([x - 1.5, y, top + size[2] / 2])))
            x, top = x + random.uniform(-0.3, 0.3) * size[0], top + size[2]
    parts.append(Part("loaded", Box([0.5, 0.5, 0.5]), Pose([0, 3, 0.25])))
    loads = [Load("loaded", force=[0, 0, 1e5])] if seed % 2 else []
    table = Part("table", Box([9, 9, 1]), Pose([0, 0, -0.5]), grounded=True)
    return Assembly([table, *parts], friction=0.4 * (seed % 3), loads=loads)


@pytest.mark.quick(3)
@pytest.mark.parametrize("seed", range(6))
@pytest.mark.slow
def test_clusters_that_are_decided_at_once_have_the_states_of_single_ones(seed, monkeypatch):
    drawn = random_scene(seed)
    together = kilter.scene(drawn, assume="drawn")
    monkeypatch.setattr(survey, "FEWEST", 1000)
    single = kilter.scene(drawn, assume="drawn")
    assert {**together.to_dict(), "seconds": 0} == {**single.to_dict(), "seconds": 0}
    assert together.clusters == single.clusters > 4
    found = {frozenset(v.assembly.names): (v.verdict, v.level) for v in together.verdicts}
    assert found == {frozenset(v.assembly.names): (v.verdict, v.level) for v in single.verdicts}


def test_a_verdict_about_a_cluster_at_rest_is_complete_on_request():
    report = kilter.scene(Assembly([TABLE, *(cube(f"{k}", 2.0 * k - 4, 0) for k in range(5))]))
    first = report.verdicts[0]
    assert (first.verdict, first.level) == ("stable", "proved")
    assert first.assembly.names == ("table", "0")
    assert first.evidence is not None
    assert first.evidence.holds
