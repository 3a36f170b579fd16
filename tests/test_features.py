"""Features of kilter, and missing features: each test is a row of docs/contributing/features.md."""

from pathlib import Path

import numpy as np
import pytest
import trimesh

import kilter
from kilter import Assembly, Bond, Box, Joint, Load, Part, Pose, Sphere, Strap
from kilter.agents.tool_calls import ToolCalls


def table(size: float = 4.0) -> Part:
    return Part("table", Box(size, size, 1), [0, 0, -0.5], grounded=True)


def stack(shift: float, **more: object) -> Assembly:
    """Two unit cubes on a table, the upper one shifted along x."""
    lower = Part("lower", Box(1, 1, 1), [0, 0, 0.5])
    upper = Part("upper", Box(1, 1, 1), [shift, 0, 1.5])
    return Assembly([table(), lower, upper], **more)  # type: ignore[arg-type]


def slope(tangent: float, mu: float, **more: object) -> Assembly:
    """A unit cube on a table under gravity that leans by an angle."""
    cube = Part("cube", Box(1, 1, 1), [0, 0, 0.5])
    gravity = [9.81 * tangent, 0, -9.81]
    return Assembly([table(), cube], friction=mu, gravity=gravity, **more)  # type: ignore[arg-type]


class TestVerdicts:
    def test_an_unsupported_part_falls_and_is_named(self):
        assert kilter.check(stack(0.6)).moving == ["upper"]

    def test_both_sides_of_a_limit_are_decided(self):
        found = [kilter.check(stack(x)).verdict for x in (0.499999, 0.500001)]
        assert found == ["stable", "unstable"]

    def test_each_verdict_has_a_proof_that_is_verified_without_a_solver(self):
        for assembly in (stack(0.2), stack(0.6)):
            assert kilter.verify(assembly, kilter.check(assembly).proof()).holds

    def test_friction_decides_exactly_at_its_limit(self):
        found = [kilter.check(slope(0.5, mu)).stable for mu in (0.501, 0.499)]
        assert found == [True, False]

    def test_the_first_acceleration_of_each_part_is_exact(self):
        verdict = kilter.check(slope(0.75, 0.0))
        assert verdict["cube"].acceleration[0] == pytest.approx(0.75 * 9.81)  # type: ignore[index]

    def test_second_order_decides_whether_a_small_push_makes_it_fall(self):
        balls = [Part(f"ball-{k}", Sphere(0.5), [0, 0, 0.5 + k]) for k in (0, 1)]
        assert kilter.check(Assembly([table(), *balls])).verdict == "balanced"


class TestForces:
    def test_given_loads_count(self):
        pull = Load("upper", force=[0, 0, 30_000], point=[0, 0, 2])
        assert kilter.check(stack(0, loads=[pull])).moving == ["upper"]

    def test_joints_hold_parts_together(self):
        joint = Joint(("lower", "upper"), "fixed")
        assert kilter.check(stack(0.6, joints=[joint])).stable  # their common centre is at 0.3
        assert not kilter.check(stack(0.6)).stable

    def test_bonds_hold_up_to_their_strength(self):
        def held(pull: float) -> bool:
            bonds = [Bond(("lower", "upper"), pull=pull, shear=1e6)]
            return kilter.check(stack(0.6, bonds=bonds)).stable

        # 9810 N, 0.1 beyond the edge of the contact, against points 0.4 behind the edge
        total = 9810 * 0.1 / 0.4
        points = 2  # at the far end of the contact
        assert held(1.01 * total / points)
        assert not held(0.99 * total / points)

    def test_straps_hold_parts_down(self):
        over = [("ground", [0, -2, 0]), ("cube", [0, -0.5, 1]), ("cube", [0, 0.5, 1])]
        strap = Strap(path=[*over, ("ground", [0, 2, 0])], tension=20_000)
        assert kilter.check(slope(0.5, 0.4, straps=[strap])).stable
        assert not kilter.check(slope(0.5, 0.4)).stable


class TestQuestions:
    def test_the_widest_stable_orientation_is_found(self):
        assert kilter.orient(stack(0.2, friction=0.3)).found

    def test_all_stable_directions_of_gravity_are_a_region(self):
        assert kilter.region(kilter.example("paper-figure-10")).kind == "fan"

    @pytest.mark.slow
    def test_margins_are_computed(self):
        margin = kilter.margin(stack(0.2, friction=0.5))
        tips = np.arctan(0.4 / 1.0)  # both cubes about the lower edge: their centre is at (0.1, 1)
        assert margin.tilt_deg == pytest.approx(np.degrees(tips), abs=0.01)

    def test_an_order_of_assembly_is_found(self):
        assert kilter.plan(stack(0.2)).found

    def test_the_fewest_supports_are_found_and_proved(self):
        assert len(kilter.hold(stack(0.6)).supports) == 1

    def test_carried_accelerations_are_computed(self):
        limits = kilter.transport(slope(0.0, 0.3)).to_dict()["limits"]
        assert limits[0]["acceleration"] == pytest.approx(0.3 * 9.81, rel=1e-6)

    def test_stable_places_of_a_box_are_a_map(self):
        places = kilter.place(Assembly([table(1.0)]), Part("box", Box(0.2, 0.2, 0.2), mass=1))
        assert places.stands

    def test_packing_plans_are_checked_item_by_item(self, tmp_path):
        plan = tmp_path / "plan.csv"
        rows = ["x,y,z,length,width,height,mass", "0,0,0,1,1,1,5", "0.6,0,1,1,1,1,5"]
        plan.write_text("\n".join(rows), encoding="utf-8")
        assert kilter.check_plan(plan, units="m").first == 2

    def test_parts_that_float_are_moved_to_a_pose_at_rest(self):
        floating = stack(0).with_pose("upper", Pose([0, 0, 1.51]))
        answer = kilter.settle(floating)
        assert answer.state == "at-rest"
        assert answer.movement[2, 2] == pytest.approx(-0.01, abs=1e-6)

    def test_each_object_of_a_scene_has_a_state(self):
        scene = stack(0.6) + Part("lamp", Box(1, 1, 1), [-1.4, 0, 0.6])
        report = kilter.scene(scene)
        states = {thing.name: thing.state for thing in report}
        assert states["lamp"] == "floats"
        assert states["upper"] == "falls"

    def test_agents_ask_through_a_server(self, tmp_path):
        kilter.dump(stack(0.6), tmp_path / "a.kilter.json")
        answer = ToolCalls(tmp_path).call("check", {"file": "a.kilter.json"})
        assert not answer.failed
        assert "upper" in answer.text

    def test_thousands_of_assemblies_are_checked_at_once(self):
        verdicts = kilter.check_many([stack(x) for x in (0.4, 0.6)]).verdict
        assert list(verdicts) == ["stable", "unstable"]


class TestFiles:
    @pytest.mark.parametrize("ending", ["stl", "obj", "glb", "3mf"])
    def test_stl_obj_glb_and_3mf_are_read(self, ending, tmp_path):
        path = tmp_path / f"cube.{ending}"
        trimesh.creation.box([1, 1, 1]).export(path)
        units = "m" if ending in ("stl", "obj") else None  # the others state their unit
        assert np.ptp(kilter.load(path, units=units).bounds, axis=0) == pytest.approx([1, 1, 1])

    def test_step_files_are_read(self):
        pytest.importorskip("OCP", reason="pip install 'kilter[step]'")
        clamp = Path(__file__).resolve().parents[1] / "examples/clamp.step"
        assert kilter.load(clamp).names == ("base", "arm", "bolt", "nut")

    def test_answers_travel_as_json(self):
        text = kilter.check(stack(0.2)).to_json()
        assert kilter.load_answer(text).verdict == "stable"

    def test_reports_are_offline_pages(self):
        assert "<html" in kilter.report(stack(0.2)).html

    def test_damaged_input_is_refused_in_a_sentence(self, tmp_path):
        (tmp_path / "a.json").write_text("{", encoding="utf-8")
        with pytest.raises(kilter.InputError, match=r"a\.json"):
            kilter.load(tmp_path / "a.json")


class TestMissing:
    def test_motion_over_time_is_not_computed(self):
        verdict = kilter.check(stack(0.6))
        assert np.linalg.norm(verdict["upper"].acceleration) > 1
        with pytest.raises(kilter.InputError, match="glb"):
            kilter.animate(verdict, "fall.mp4")

    def test_loads_have_no_region(self):
        pull = Load("upper", force=[0, 0, 1], point=[0, 0, 2])
        with pytest.raises(kilter.InputError, match="loads"):
            kilter.region(stack(0, loads=[pull]))

    def test_bonds_have_no_order_of_assembly(self):
        bond = Bond(("lower", "upper"), pull=1.0, shear=1.0)
        with pytest.raises(kilter.InputError, match="bond"):
            kilter.plan(stack(0, bonds=[bond]))

    def test_parts_that_overlap_are_not_moved_apart_silently(self):
        sunk = stack(0).with_pose("upper", Pose([0, 0, 1.4]))
        assert kilter.check(sunk).verdict == "undecided"
