"""Poses at rest by the least motion, with known answers, and the points that touch."""

import itertools
import json
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from independent_rest import balances, separation
from scipy.spatial.transform import Rotation

import kilter
from kilter import (
    Assembly,
    Bond,
    Box,
    Cylinder,
    Joint,
    Load,
    Part,
    Pose,
    Prism,
    Settled,
    Sphere,
)
from kilter.analysis.settled_pose.near_points import NearPoints, _share_material, find_near_points
from kilter.contact.overlap import inside_part
from kilter.rigid import rotation_between
from kilter.scenes.arches import arch
from kilter.scenes.pieces import tube

settle = partial(kilter.settle, nearest=True)
TABLE = Part("table", Box([4, 4, 1]), [0, 0, -0.5], grounded=True)


def box(name: str, size: list[float], at: list[float], **more: object) -> Part:
    return Part(name, Box(size), at, **more)


def confirmed(answer: Settled) -> None:
    """A second program finds no overlap and balancing forces at closed points."""
    settled, gap = answer.assembly, answer.tolerance
    for a, b in itertools.combinations(range(len(settled)), 2):
        assert separation(settled, a, b) >= -gap
    assert balances(settled, 4 * gap) < 1e-6


def test_a_box_above_a_table_moves_down():
    answer = settle(Assembly([TABLE, box("box", [1, 1, 1], [0.3, 0.2, 0.5 + 0.01])]))
    assert answer.state == "at-rest"
    assert answer.movement[1] == pytest.approx([0, 0, -0.01, 0, 0, 0], abs=1e-9)
    confirmed(answer)


@pytest.mark.quick(1)
@pytest.mark.parametrize("difference", [1e-3, 1e-2])
def test_a_bar_on_two_blocks_tilts_by_their_difference(difference):
    """Contact edges s apart: the lower block's outer edge and the higher block's inner edge."""
    left, right = box("left", [1, 1, 1], [-1, 0, 0.5]), box(
        "right", [1, 1, 1 + difference], [1, 0, (1 + difference) / 2]
    )  # fmt: skip
    bar = box("bar", [4, 1, 0.2], [0, 0, 1.1 + difference])
    drawn = Assembly([TABLE, left, right, bar], friction=0.5)
    answer = settle(drawn)
    assert answer.state == "at-rest"
    assert answer.level in ("settles", "proved")
    distance = 0.5 - -1.5  # of the edge of the left block and that of the right block
    tilt = np.linalg.norm(answer.movement[3, 3:])
    assert np.tan(tilt) == pytest.approx(difference / distance, rel=1e-6)
    confirmed(answer)
    smooth = settle(drawn.with_friction(0.0))
    assert smooth.state == "falls"
    assert "bar" in smooth.parts


@pytest.mark.quick(1)
@pytest.mark.parametrize("side", [0.05, -0.05])
def test_a_plate_on_four_posts_of_which_one_is_higher(side):
    high = 1e-3
    posts = [
        box(f"{x:+d}{y:+d}", [0.02, 0.02, 1 + high * ((x, y) == (1, -1))],
            [x, y, (1 + high * ((x, y) == (1, -1))) / 2 - 0.5], grounded=True)
        for x in (-1, 1) for y in (-1, 1)
    ]  # fmt: skip
    shape = Box([2.4, 2.4, 0.1])
    plate = Part("plate", shape, [0, 0, 0.55 + high], mass=1.0, center_of_mass=[side, side, 0])
    answer = settle(Assembly([*posts, plate], friction=0.5))
    assert answer.state == "at-rest"
    lifted = "-1-1" if side > 0 else "+1+1"
    carrying = {name for pair in answer.to_dict()["carries"] for name in pair} - {"plate"}
    assert carrying == {"-1-1", "-1+1", "+1-1", "+1+1"} - {lifted}
    # the plate touches each post at the edge or corner that lies lowest below the tilted plate. It
    # is the same edge of each post, so the edges are as far apart as the posts: 2
    normal = Rotation.from_rotvec(answer.movement[4, 3:]).as_matrix()[:, 2]
    slope = -normal[:2] / normal[2]
    assert slope == pytest.approx([0, -high / 2] if side > 0 else [high / 2, 0], abs=1e-9)
    confirmed(answer)


@pytest.mark.quick(1)
@pytest.mark.parametrize(("friction", "state"), [(0.51, "at-rest"), (0.49, "falls")])
def test_a_box_on_a_slope_rests_above_the_angle_of_friction(friction, state):
    turn = rotation_between([0, 0, 1], [-0.5, 0, 1])
    normal = np.array([-0.5, 0, 1]) / np.linalg.norm([-0.5, 0, 1])
    slope = Part("slope", Box([4, 4, 1]), Pose(-0.5 * normal, turn), grounded=True)
    on_it = Part("box", Box([1, 1, 1]), Pose((0.5 + 1e-3) * normal, turn))
    answer = settle(Assembly([slope, on_it], friction=friction))
    assert answer.state == state
    if state == "at-rest":
        assert answer.movement[1, :3] == pytest.approx(-1e-3 * normal, abs=1e-8)
        confirmed(answer)


@pytest.mark.parametrize(("overhang", "state"), [(0.499, "at-rest"), (0.501, "falls")])
def test_a_box_over_an_edge(overhang, state):
    at = [2 - 0.5 + overhang, 0, 0.5 + 1e-4]
    answer = settle(Assembly([TABLE, box("box", [1, 1, 1], at)], friction=0.5))
    assert answer.state == state
    assert answer.parts == (() if state == "at-rest" else ("box",))


def slot(width: float, sunk: float) -> Assembly:
    floor = box("floor", [6, 2, 1], [0, 0, -0.5], grounded=True)
    walls = [box(n, [1, 1, 1], [x, 0, 0.5], grounded=True) for n, x in (("l", -1), ("r", 1))]
    return Assembly([floor, *walls, box("block", [width, 1, 1], [0, 0, 0.5 - sunk])], friction=0.3)


def test_a_block_that_is_wider_than_its_slot_does_not_fit():
    answer = settle(slot(1.001, 0.0))
    assert answer.state == "does-not-fit"
    assert set(answer.parts) >= {"l", "r", "block"}
    assert answer.depth == pytest.approx(5e-4, rel=1e-3)  # shared by both sides


def test_a_block_that_is_narrower_than_its_slot_moves_up():
    answer = settle(slot(0.999, 1e-3))
    assert answer.state == "at-rest"
    assert answer.movement[3] == pytest.approx([0, 0, 1e-3, 0, 0, 0], abs=1e-8)
    confirmed(answer)


def disturbed(assembly: Assembly, size: float, seed: int) -> tuple[Assembly, float]:
    """Each free part moved at random in all six freedoms; also the largest shift."""
    from kilter.analysis.settled_pose.rigid_bodies import rigid_bodies

    bodies = rigid_bodies(assembly, ())
    steps = size * np.random.default_rng(seed).uniform(-1, 1, (len(bodies.mass), 6))
    steps[:, :3] *= bodies.size[:, None]
    steps[0] = 0.0
    return bodies.moved(steps).assembly(), float(np.linalg.norm(steps[:, :3], axis=1).max())


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("size", [1e-5, 1e-3, 1e-2])
def test_a_disturbed_arch_comes_to_rest(size, seed):
    drawn, most = disturbed(arch(9).with_friction(0.6), size, seed)
    answer = settle(drawn)
    assert answer.state == "at-rest"
    assert answer.level == "settles"
    assert answer.distance.max() < 3 * most
    assert answer.to_dict()["deepest_overlap"] <= answer.tolerance
    assert kilter.verify(answer.assembly, json.loads(json.dumps(answer.proof()))).holds


# other kinds of parts -------------------------------------------------------------------


@pytest.mark.quick(1)
@pytest.mark.parametrize("shape", [Sphere(0.5), Cylinder(0.5, 1.0)], ids=["ball", "cylinder"])
def test_curved_parts_come_to_rest(shape):
    answer = settle(Assembly([TABLE, Part("body", shape, [0, 0, 0.5 + 2e-3])], friction=0.5))
    assert answer.state == "at-rest"
    assert answer.movement[1, 2] == pytest.approx(-2e-3, abs=1e-8)


def test_a_prism_with_a_notch_rests_on_a_step():
    outline = [[0, 0], [2, 0], [2, 1], [1, 1], [1, 0.5], [0, 0.5]]
    answer = settle(
        Assembly([TABLE, Part("notched", Prism(outline, 1.0), [-1, 0, 1e-3])], friction=0.4)
    )
    assert answer.state == "at-rest"
    assert answer.level == "proved"
    assert answer.movement[1, 2] == pytest.approx(-1e-3, abs=1e-8)


def test_joined_and_bonded_parts_move_as_one_body():
    a, b = box("a", [1, 1, 1], [0, 0, 0.5 + 1e-3]), box("b", [1, 1, 1], [0, 0, 1.5 + 1e-3])
    joined = settle(Assembly([TABLE, a, b], joints=[Joint(("a", "b"), "fixed")]))
    bonded = settle(Assembly([TABLE, a, b], bonds=[Bond(("a", "b"), pull=1e4)]))
    for answer in (joined, bonded):
        assert answer.state == "at-rest"
        assert answer.movement[1] == pytest.approx(answer.movement[2], abs=1e-12)


def test_a_hinge_stays_closed():
    """A lid on a hinge falls onto a stop that is lower than drawn: it turns about its pin."""
    stop = box("stop", [0.2, 1, 1], [1.5, 0, 0.5 - 1e-3], grounded=True)
    post = box("post", [0.2, 1, 1], [-1.5, 0, 0.4], grounded=True)
    lid = box("lid", [3.2, 1, 0.1], [0, 0, 1.05])
    hinge = Joint(("post", "lid"), "revolute", point=[-1.5, 0, 1.05], axis=[0, 1, 0])
    answer = settle(Assembly([stop, post, lid], joints=[hinge], friction=0.3))
    assert answer.state == "at-rest"
    pin = answer.assembly.joints[0].point
    moved = answer.assembly["lid"].pose.apply([[-1.5, 0, 0]])[0]
    assert moved == pytest.approx(pin, abs=1e-8)
    assert np.linalg.norm(answer.movement[2, 3:]) == pytest.approx(1e-3 / 2.9, rel=0.1)


@pytest.mark.quick(1)
@pytest.mark.parametrize(("force", "state"), [(400.0, "at-rest"), (600.0, "falls")])
def test_a_load_counts(force, state):
    """A push at the height of the table edge slides the box beyond mu times its weight."""
    cube = box("box", [1, 1, 1], [0, 0, 0.5 + 1e-3], mass=100.0)
    push = Load("box", force=[force, 0, 0], point=[0, 0, 1e-3])
    answer = settle(Assembly([TABLE, cube], loads=[push], friction=0.5))
    assert answer.state == state
    if state == "at-rest":
        assert answer.assembly.loads[0].point == pytest.approx([0, 0, 0], abs=1e-8)


def test_a_planar_assembly_moves_in_its_plane():
    parts = [TABLE, box("box", [1, 1, 1], [0, 0, 0.5 + 1e-3])]
    answer = settle(Assembly(parts, planar=True))
    assert answer.state == "at-rest"
    assert answer.movement[1, [1, 3, 5]].tolist() == [0, 0, 0]


def test_a_kept_part_does_not_move_but_is_balanced():
    low, high = box("low", [1, 1, 1], [0, 0, 0.5]), box("high", [1, 1, 1], [0, 0, 1.5 + 1e-3])
    answer = settle(Assembly([TABLE, low, high]), keep="low")
    assert answer.state == "at-rest"
    assert not answer.movement[1].any()
    hanging = box("low", [1, 1, 1], [0, 0, 0.5 + 1e-3])
    assert settle(Assembly([TABLE, hanging]), keep="low").state == "not-found"


# words and refusals ---------------------------------------------------------------------


@pytest.mark.parametrize(
    ("drawn", "options", "words"),
    [
        (Assembly([TABLE, box("b", [1, 1, 1], [0, 0, 0.6])]), {"reach": 0.05}, "within reach"),
        (Assembly([TABLE, box("b", [1, 1, 1], [0, 0, 0.54]), box("c", [1, 1, 1], [0, 0, 1.6])]),
         {"reach": 0.07}, "out of reach"),
        (Assembly([TABLE, replace(TABLE, name="other")]), {}, "every part is held"),
        (slot(1.001, 0.0), {}, "do not fit"),
    ],
    ids=["apart", "out-of-reach", "all-held", "no-fit"],
)  # fmt: skip
def test_each_failure_is_a_sentence(drawn, options, words):
    answer = settle(drawn, **options)
    assert not answer.at_rest
    assert words in answer.to_dict()["sentence"]


def test_no_held_part_is_an_error():
    with pytest.raises(kilter.InputError, match="nothing is held"):
        settle(Assembly([box("b", [1, 1, 1], [0, 0, 0])]))


def test_a_changed_pose_is_no_pose_at_rest():
    """A proof of rest does not hold for a pose that is lifted by ten tolerances."""
    answer = settle(Assembly([TABLE, box("box", [1, 1, 1], [0, 0, 0.501])]))
    proof = answer.proof()
    assert kilter.verify(answer.assembly, proof).holds
    lifted = answer.assembly.with_pose("box", [0, 0, 0.5 + 10 * answer.tolerance])
    result = kilter.verify(lifted, proof)
    assert not result.holds
    assert "from their surfaces" in result.reasons[0]
    sunk = answer.assembly.with_pose("box", [0, 0, 0.5 - 10 * answer.tolerance])
    assert not kilter.verify(sunk, proof).holds


def test_outputs_have_the_same_poses(tmp_path, capsys):
    from kilter.cli import main

    file = tmp_path / "gap.kilter.json"
    drawn = Assembly([TABLE, box("a", [1, 1, 1], [0, 0, 0.501]), box("b", [1, 1, 1], [0, 0, 1.6])])
    kilter.dump(drawn, file)
    wanted = settle(drawn).assembly.geometry.vertices
    for name in ("rest.kilter.json", "rest.json", "rest.glb", "rest.xml"):
        output = tmp_path / name
        assert main(["settle", str(file), "--nearest", "-o", str(output), "--quiet"]) == 0
        if name.endswith(".xml"):
            pytest.importorskip("mujoco")
        read = kilter.load(output)
        if name.endswith(".glb"):  # single precision, y up, about its own centre
            extents = np.sort(np.ptp(read.geometry.vertices, axis=0))
            assert extents == pytest.approx(np.sort(np.ptp(wanted, axis=0)), abs=1e-6)
            continue
        corners, expected = (v[np.lexsort(v.round(9).T)] for v in (read.geometry.vertices, wanted))
        assert corners == pytest.approx(expected, abs=1e-9)
    capsys.readouterr()


def test_a_wrong_ending_is_an_error(tmp_path, capsys):
    from kilter.cli import main

    file = tmp_path / "gap.kilter.json"
    kilter.dump(Assembly([TABLE]), file)
    assert main(["settle", str(file), "-o", str(tmp_path / "x.doc")]) == 2
    assert "is no format of a pose" in capsys.readouterr().err


@pytest.mark.quick(1)
@pytest.mark.parametrize("height", [0.4995, 0.5005], ids=["overlaps", "hangs"])
def test_an_undecided_check_proposes_the_play_which_decides_it(
    height, tmp_path, monkeypatch, capsys
):
    from kilter.cli import main

    monkeypatch.chdir(tmp_path)
    file = "drawn.kilter.json"
    kilter.dump(Assembly([TABLE, box("box", [1, 1, 1], [0, 0, height])]), file)
    assert main(["check", file]) == 4
    assert "next: kilter check drawn.kilter.json --assume play\n" in capsys.readouterr().out
    assert main(["check", file, "--assume", "play", "--quiet"]) == 0
    assert capsys.readouterr().out.startswith(
        "Stable after moving at most 0.0005 m within its play: "
    )


def test_parts_at_rest_have_no_play():
    drawn = Assembly([TABLE, box("box", [1, 1, 1], [0, 0, 0.5])])
    verdict = kilter.check(drawn, assume="play")
    assert (verdict.verdict, verdict.moved) == ("stable", 0.0)


def test_a_time_limit_ends_the_search_with_a_sentence(tmp_path, capsys):
    from kilter.cli import main

    file = tmp_path / "arch.kilter.json"
    kilter.dump(disturbed(arch(20).with_friction(0.6), 1e-3, 0)[0], file)
    assert main(["settle", str(file), "--time-limit", "0", "--quiet"]) == 4
    assert "the time limit of 0 s was reached" in capsys.readouterr().out


@pytest.mark.slow
def test_levels_above_the_required_level_are_not_asked():
    drawn, _ = disturbed(arch(9).with_friction(0.6), 1e-3, 0)
    answer = settle(drawn, require="equilibrium")
    assert answer.at_rest
    assert answer.level == "equilibrium"
    assert "not-asked" in (answer.settled_verdict.why, answer.closed_verdict.why)
    higher = settle(drawn)
    assert higher.level == "settles"
    assert higher.settled_verdict is higher.closed_verdict


SPACESHIP = Path(__file__).parents[3] / "shared/data/cax-if/s1-tu-203/s1-tu-203.stp"


@pytest.mark.parametrize(("sunk", "shares"), [(0.0, False), (-0.1, False), (0.5, True)])
def test_a_shaft_shares_material_with_a_narrower_bore_only_if_it_reaches_into_it(sunk, shares):
    """A shaft of radius 1 below a tube with a bore of .8: their faces overlap by .2 as solids."""
    shaft = Part("shaft", Cylinder(1, 1), [0, 0, 0.5], grounded=True)
    assembly = Assembly([shaft, tube("tube", 0.8, 2, 1, [0, 0, 1.5 - sunk])])
    angle = np.linspace(0, 2 * np.pi, 12, endpoint=False) + 0.1
    normal = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(12)])
    point = 0.9 * normal + [0, 0, 1.0]  # the rim of the shaft
    shaft_row, tube_row = np.zeros(12, dtype=np.int64), np.ones(12, dtype=np.int64)
    bears = np.ones(12, dtype=bool)
    points = NearPoints(shaft_row, tube_row, point, normal, np.full(12, -0.2), np.zeros(12), bears)
    assert (_share_material(assembly.geometry, points) == shares).all()


def test_points_inside_a_part():
    geometry = Assembly([Part("box", Box(2, 2, 2), [1, 0, 0], grounded=True)]).geometry
    points = np.array([[1.0, 0, 0], [1.99, 0.99, -0.99], [2.01, 0, 0], [-0.01, 0, 0]])
    assert inside_part(geometry, 0, points).tolist() == [True, True, False, False]


@pytest.mark.slow
@pytest.mark.skipif(not SPACESHIP.is_file(), reason="real data is not here")
def test_half_shells_on_one_axis_have_no_penetrating_points():
    """A solid half of radius 73 and holes of 67 on its axis, over other angles: no overlap."""
    drawn = kilter.load(SPACESHIP)
    shells = [part for part in drawn.parts if not part.name.startswith("foot")]
    assembly = Assembly(shells, units=drawn.units)
    assert not kilter.contacts(assembly).overlaps
    assert find_near_points(assembly, 12.0, 12.0).gap.min() > -0.01
