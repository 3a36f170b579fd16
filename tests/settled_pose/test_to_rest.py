"""`kilter settle`, `kilter scene --settle`: parts fall, tip and slide until they rest or leave."""

import json
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import kilter
from kilter import Assembly, Box, Part, Pose, scene, settle
from kilter.cli import main
from kilter.errors import TimeLimitReached
from kilter.rigid import rotation_between

TABLE = Part("table", Box([4, 4, 1]), [0, 0, -0.5], grounded=True)


def box(name: str, at: list[float], size: tuple[float, ...] = (1, 1, 1), **more: float) -> Part:
    return Part(name, Box(size), at, **more)


def floating(*more: Part) -> Assembly:
    """The upper box floats by .1 above the lower one, which floats by .1 above the table."""
    return Assembly([TABLE, box("lower", [0, 0, 0.6]), box("upper", [0, 0, 1.7]), *more])


BESIDE = box("beside", [9, 0, 1.7])
"""A box with nothing below it."""


# states of all parts ----------------------------------------------------------------------------


def test_boxes_above_each_other_all_rest_after_a_single_run():
    answer = settle(floating())
    assert answer.at_rest
    assert answer.movement[1:, 2] == pytest.approx([-0.1, -0.2], abs=1e-9)
    ways = {entry.part: entry.way for entry in answer.moved}
    assert [(way.how, way.distance) for way in ways["upper"]] == [("fell", pytest.approx(0.2))]
    assert kilter.verify(answer.assembly, answer.proof()).holds


def test_a_scene_and_settle_find_the_same_pose():
    report, answer = scene(floating(), settle=True), settle(floating())
    assert report.at_rest
    assert report.level == answer.level
    for ours, theirs in zip(report.assembly, answer.assembly, strict=True):
        assert ours.pose == theirs.pose
    assert report.moved == pytest.approx({"lower": 0.1, "upper": 0.2})
    assert [way.how for way in report["upper"].way] == ["fell"]


@pytest.mark.parametrize("sunk", [2e-6, 1e-3])
def test_a_sunk_box_moves_up_without_a_question(sunk):
    drawn = Assembly([TABLE, box("a", [0, 0, 0.5 - sunk])])
    answer = settle(drawn)
    assert answer.movement[1] == pytest.approx([0, 0, sunk, 0, 0, 0], abs=1e-9)
    assert answer.sentence == f"At rest after moving at most {sunk:.3g} m: level proved."
    sentence = scene(drawn, settle=True).sentence
    assert (
        sentence == f"The free object is at rest (level proved), after moving at most {sunk:.3g} m."
    )


def test_boxes_that_overlap_sideways_move_in_inverse_proportion_to_their_masses():
    """The least sum of mass times the square of the movement opens the overlap."""
    sunk, light, heavy = 1e-4, 1.0, 9.0
    drawn = [box("light", [-0.5 + sunk / 2, 0, 0.5], mass=light),
             box("heavy", [0.5 - sunk / 2, 0, 0.5], mass=heavy)]  # fmt: skip
    answer = settle(Assembly([TABLE, *drawn], friction=0.5))
    assert answer.at_rest
    ways = sunk * np.array([-heavy, light]) / (light + heavy)
    assert answer.movement[1:, 0] == pytest.approx(ways, abs=1e-8)


def on_slope(friction: float) -> Assembly:
    """A box on a slope of tan .5, with a gap of 1e-3 across the slope."""
    turn = rotation_between([0, 0, 1], [-0.5, 0, 1])
    normal = np.array([-0.5, 0, 1]) / np.linalg.norm([-0.5, 0, 1])
    slope = Part("slope", Box([4, 4, 1]), Pose(-0.5 * normal, turn), grounded=True)
    return Assembly([slope, Part("box", Box([1, 1, 1]), Pose((0.5 + 1e-3) * normal, turn))],
                    friction=friction)  # fmt: skip


@pytest.mark.quick(1)
@pytest.mark.parametrize(("friction", "state"), [(0.51, "at-rest"), (0.49, "falls")])
def test_a_box_on_a_slope_rests_where_it_falls_or_slides_off(friction, state):
    answer = settle(on_slope(friction), require="equilibrium")
    assert answer.state == state
    if state == "at-rest":
        fall = 1e-3 / np.cos(np.arctan(0.5))
        assert answer.movement[1, :3] == pytest.approx([0, 0, -fall], abs=1e-8)
    else:
        assert answer.leaves == ("box",)
        assert "slid" in [way.how for way in answer.moved[0].way]


@pytest.mark.slow
@pytest.mark.parametrize(("overhang", "state"), [(0.499, "at-rest"), (0.501, "falls")])
def test_a_box_over_an_edge_rests_or_tips(overhang, state):
    drawn = Assembly([TABLE, box("box", [1.5 + overhang, 0, 0.5 + 1e-4])], friction=0.5)
    answer = settle(drawn, require="equilibrium")
    assert answer.state == state
    if state == "falls":
        assert answer.leaves == ("box",)
        assert "tipped" in [way.how for way in answer.moved[0].way]


@pytest.mark.slow
def test_bodies_far_from_a_long_motion_rest_exactly():
    """A plate tips over the edge of a step in long steps, beside boxes that hardly move."""
    step = box("step", [-1, 0, 0.25], (1, 1, 0.5), grounded=True)
    plate = box("plate", [-0.47, 0, 0.55], (1.2, 0.5, 0.1))
    others = [box("sunk", [0.9, -1, 0.5 - 1e-3]), box("floats", [1, 1, 0.51])]
    answer = settle(Assembly([TABLE, step, plate, *others], friction=1.0), require="equilibrium")
    assert answer.at_rest
    assert answer.movement[2, 4] > 0.2
    assert answer.movement[3] == pytest.approx([0, 0, 1e-3, 0, 0, 0], abs=1e-9)
    assert answer.movement[4] == pytest.approx([0, 0, -0.01, 0, 0, 0], abs=1e-9)


def test_a_pose_at_rest_does_not_change():
    turned = Pose([0.3, 0, 0.5], Rotation.from_rotvec([0, 0, 0.7]).as_quat()[[3, 0, 1, 2]])
    drawn = Assembly([TABLE, Part("a", Box(1, 1, 1), turned), box("b", [0.3, 0, 1.5])])
    answer = settle(drawn)
    assert answer.sentence == f"At rest as drawn: level {answer.level}."
    assert answer.assembly == drawn
    assert (answer.moved, answer.reach) == ([], None)
    assert scene(drawn, settle=True).assembly == drawn


# some parts rest, others do not -----------------------------------------------------------------


def test_parts_that_leave_are_named_and_the_others_have_their_proof():
    answer = settle(floating(BESIDE))
    assert (answer.state, answer.leaves, answer.parts) == ("partly", ("beside",), ())
    assert (answer.rests, answer.at_rest) == (2, False)
    assert answer.resting.names == ("table", "lower", "upper")
    assert kilter.verify(answer.resting, answer.proof()).holds
    alone = settle(floating())
    assert answer.level == alone.level
    assert answer.carries == alone.carries
    report = scene(floating(BESIDE), settle=True)
    assert report.counts == {"held": 1, "at-rest": 2, "falls": 1}
    assert report["beside"].words == "falls: leaves the scene"


def slot(at: float, width: float) -> list[Part]:
    """Two held walls at a distance of 1, and a block between them."""
    sides = zip(("left", "right"), (-1.0, 1.0), strict=True)
    walls = [box(f"{name} {at}", [at + x, 0, 0.5], grounded=True) for name, x in sides]
    return [*walls, box(f"block {at}", [at, 0, 0.5], (width, 1, 1))]


@pytest.mark.slow
def test_parts_beside_those_that_do_not_fit_come_to_rest():
    table = box("table", [0, 0, -0.5], (60, 60, 1), grounded=True)
    wide = [*slot(0.0, 1.001), *slot(9.0, 1.002)]
    others = [box("floats", [0, 5, 0.6]), box("sunk", [9, 5, 0.499]), *slot(20.0, 0.999)]
    above = box("above", [0, 0, 1.6], (0.5, 0.5, 1))
    answer = settle(Assembly([table, *wide, *others, above], friction=0.3))
    assert answer.state == "partly"
    blocks = {f"{name} {at}" for name in ("left", "right", "block") for at in (0.0, 9.0)}
    # no proof exists for a part on a block whose pose is invalid
    assert set(answer.parts) == {*blocks, "above"}
    assert answer.rests == 3
    assert answer.depth == pytest.approx(1e-3, rel=1e-3)  # shared by both sides
    shift = {part.name: row[2] for part, row in zip(answer.drawn, answer.movement, strict=True)}
    assert shift["floats"] == pytest.approx(-0.1, abs=1e-8)
    assert shift["sunk"] == pytest.approx(1e-3, abs=1e-8)
    assert "do not fit, and overlap by at least 0.001 m" in answer.sentence
    assert kilter.verify(answer.resting, answer.proof()).holds


def test_all_parts_leave():
    answer = settle(Assembly([TABLE, BESIDE]))
    assert (answer.state, answer.leaves, answer.resting) == ("falls", ("beside",), None)
    assert answer.sentence == "'beside' leaves the scene."
    with pytest.raises(kilter.InputError, match="not at rest"):
        answer.proof()


@pytest.mark.parametrize("late", [False, True])
def test_a_pose_that_the_verification_rejects_is_left_out(late, monkeypatch):
    """An engine that leaves a box .1 above the table, and claims that it rests.

    The time limit may end the search for another pose.
    """
    from kilter.analysis.settled_pose import settle as module

    def other_rests(*_):
        raise TimeLimitReached

    if late:
        monkeypatch.setattr(module, "other_rests", other_rests)

    drawn = Assembly([TABLE, box("low", [0, 0, 0.5]), box("high", [2, 0, 0.6])])

    def claims(bodies, contacts, **more):
        settled = run(bodies, contacts, **more)
        lifted = np.zeros((3, 6))
        lifted[2, 2] = 0.1
        return replace(settled, bodies=settled.bodies.moved(lifted), leaves=(), parts=())

    run = module.come_to_rest
    monkeypatch.setattr(module, "come_to_rest", claims)
    answer = settle(drawn)
    assert (answer.state, answer.parts, answer.rests) == ("partly", ("high",), 1)
    assert "No pose at rest was found of 'high'" in answer.sentence
    assert ("time limit" in answer.why) == late
    assert kilter.verify(answer.resting, answer.proof()).holds


@pytest.mark.parametrize(
    ("drawn", "options", "code", "rests"),
    [
        (floating(), [], 0, True),
        (floating(BESIDE), [], 1, True),
        (Assembly([TABLE, BESIDE]), [], 1, False),
        (floating(), ["--reach", ".05"], 4, False),
        (floating(), ["--nearest", "--reach", ".05"], 4, False),
    ],
    ids=["rest", "partly", "falls", "out of reach", "nearest"],
)
def test_the_exit_code_and_the_files_of_the_command(drawn, options, code, rests, tmp_path, capsys):
    file, rest, proof = (str(tmp_path / f"{n}.json") for n in ("a.kilter", "r.kilter", "p"))
    kilter.dump(drawn, file)
    assert main(["settle", file, *options, "-o", rest, "--proof", proof, "--quiet"]) == code
    shown = capsys.readouterr().out
    assert (tmp_path / "p.json").exists() == rests
    if rests:
        assert "fell 0.2 m" in shown
        assert main(["verify", rest, proof]) == 0
        assert json.loads((tmp_path / "p.json").read_text())["rest"]["gap"] > 0


def test_no_answer_proposes_the_command_that_was_given(tmp_path, capsys):
    file = str(tmp_path / "a.kilter.json")
    kilter.dump(floating(BESIDE), file)
    assert main(["scene", file]) == 1
    assert capsys.readouterr().out.count("--settle") == 1
    assert main(["scene", file, "--settle"]) == 1
    assert "next:" not in capsys.readouterr().out


def test_objects_that_are_drawn_twice_stay_and_the_others_settle():
    twice = [box("a", [0, 0, 0.6]), box("b", [0, 0, 0.6])]
    report = scene(Assembly([TABLE, *twice, box("c", [1.5, 0, 0.7])]), settle=True)
    assert report.counts == {"held": 1, "at-rest": 2, "overlaps": 1}
    assert report["c"].way[0].distance == pytest.approx(0.2)


def test_a_reach_limits_the_way_of_a_part():
    answer = settle(floating(), reach=0.15)
    assert answer.state in ("not-found", "partly")
    assert answer.parts == ("upper",)
    assert settle(floating(), reach=0.25).at_rest
    with pytest.raises(kilter.InputError, match="reach is 0"):
        settle(floating(), reach=0.0)


def test_held_parts_far_away_belong_to_the_proof():
    far = box("far", [50, 0, 0], grounded=True)
    answer = settle(floating(far))
    assert answer.resting is answer.assembly
    assert kilter.verify(answer.assembly, answer.proof()).holds
    assert settle(floating(far, BESIDE)).resting.names == ("table", "lower", "upper", "far")


def test_an_engine_that_stops_early_is_closed_up_by_the_least_motion(monkeypatch):
    """An engine that leaves a box 1e-6 above the table."""
    from kilter.analysis.settled_pose import settle as module

    run = module.come_to_rest

    def stops(bodies, contacts, **more):
        settled = run(bodies, contacts, **more)
        step = np.zeros((2, 6))
        step[1, 2] = 1e-6
        return replace(settled, bodies=settled.bodies.moved(step))

    monkeypatch.setattr(module, "come_to_rest", stops)
    drawn = Assembly([TABLE, box("a", [0, 0, 0.7])])
    answer = settle(drawn)
    assert answer.at_rest
    assert answer.movement[1, 2] == pytest.approx(-0.2, abs=1e-8)
    assert scene(drawn, settle=True).at_rest
