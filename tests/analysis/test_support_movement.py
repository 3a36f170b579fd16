"""Supports that move: known answers, duality with the ranges of forces, wrong input."""

import json
import math

import numpy as np
import pytest
from test_force_ranges import G, arch, beam_on_three, knife, slot
from transformations import scaled

import kilter
from kilter import Assembly, Box, InputError, Part
from kilter.cli import main
from kilter.mechanics.program import build_program
from kilter.rigid import Pose
from kilter.scenes.pieces import moved, turn

SMALL = 1e-3


def weight_of(assembly):
    return assembly.geometry.mass[~assembly.geometry.grounded].sum() * G


def spread(assembly, by=SMALL):
    moved = {"right": (by / 2, 0, 0), "left": (-by / 2, 0, 0)}
    return kilter.check(assembly).support_movement(moved)


@pytest.mark.parametrize(
    ("count", "thickness", "thrust", "drop", "opened"),
    [
        (10, 1.0, 0.161980057, 0.521540, {2: 6, 5: 5, 8: 6}),
        *(
            pytest.param(*row, marks=pytest.mark.slow)
            for row in (
                (20, 1.0, 0.161579331, 0.539357, {3: 6, 10: 5, 17: 6}),
                (20, 0.75, 0.180916505, 0.644591, {4: 5.75, 10: 5, 16: 5.75}),
                (20, 1.5, 0.131513909, 0.473131, {3: 6.5, 10: 5, 17: 6.5}),
            )
        ),
    ],
)
def test_an_arch_on_spreading_supports(count, thickness, thrust, drop, opened):
    scene = arch(count, thickness)
    found = spread(scene)
    assert (found.outcome, found.exact) == ("cracks", True)
    assert found.least_work.value / weight_of(scene) / SMALL == pytest.approx(thrust, abs=1e-8)
    crown = scene.index_of(f"v{count // 2}")
    assert -found.motion[crown, 2] / SMALL == pytest.approx(drop, abs=1e-6)
    assert len(found.opened) == 3
    for contact in found.opened:
        joint = int(contact.parts[1][1:])
        assert contact.parts[0] == f"v{joint - 1}"
        # the widest point is at the radius of the known answer, the hinge on the other side
        assert np.hypot(*contact.at[[0, 2]]) == pytest.approx(opened[joint])
        assert np.hypot(*contact.hinge[[0, 2]]) == pytest.approx(10 + thickness - opened[joint])
        assert contact.opening == pytest.approx(thickness * math.radians(contact.angle), rel=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("size", [1e-2, 1e2])
def test_movements_turn_and_grow_with_the_assembly(size):
    pose = Pose([3, -2, 5], turn([1, 2, -1], 37))
    for scene, name, way in (
        (arch(10, 1.0), "left", [-SMALL, 0, 0.0]),
        (beam_on_three().with_friction(0.5), "knife-1", [0, 0, -SMALL]),
    ):
        first = kilter.check(scene).support_movement({name: way})
        turned = moved(scaled(scene, size), pose.rotation, pose.position)
        second = kilter.check(turned).support_movement({name: size * (pose.matrix @ way)})
        assert (second.outcome, second.exact) == (first.outcome, first.exact)
        assert len(second.opened) == len(first.opened)
        rotated = np.column_stack(
            [size * first.motion[:, :3] @ pose.matrix.T, first.motion[:, 3:] @ pose.matrix.T]
        )
        assert second.motion[:, :3] == pytest.approx(rotated[:, :3], abs=1e-6 * size * SMALL)
        assert second.motion[:, 3:] == pytest.approx(rotated[:, 3:], abs=1e-6 * SMALL)
        most = abs(first.greatest_work.value)
        works = second.least_work.value, second.greatest_work.value
        expected = first.least_work.value, first.greatest_work.value
        assert np.array(works) / size**4 == pytest.approx(expected, abs=1e-8 * most)


def test_a_beam_follows_a_support_that_sinks():
    length, sinks = 4.0, 0.01
    scene = Assembly(
        [knife("a", -2), knife("b", 2), Part("beam", Box(4.4, 1, 0.5), [0, 0.5, 0.25])]
    )
    found = kilter.check(scene).support_movement({"b": (0, 0, -sinks)})
    assert (found.outcome, found.exact, found.opened) == ("follows", True, ())
    (beam,) = found.moves
    assert beam.translation == pytest.approx((0, 0, -sinks / 2), abs=1e-9)
    assert np.radians(beam.rotation) == pytest.approx((0, sinks / length, 0), abs=1e-9)
    half = 0.5 * weight_of(scene)
    assert found.least_work.value == pytest.approx(half * sinks, rel=1e-9)
    assert found.greatest_work.value == pytest.approx(half * sinks, rel=1e-9)


def test_the_middle_one_of_three_supports_opens():
    knives = [knife(f"knife-{k}", x) for k, x in enumerate((-2, 0, 2))]
    scene = Assembly([*knives, Part("beam", Box(4.4, 1, 0.5), [0, 0.5, 0.25])])
    verdict = kilter.check(scene)
    found = verdict.support_movement({"knife-1": (0, 0, -0.01)})
    assert (found.outcome, found.exact) == ("cracks", True)
    assert [(c.parts, c.hinge) for c in found.opened] == [(("knife-1", "beam"), None)]
    assert found.opened[0].opening == pytest.approx(0.01, rel=1e-6)
    assert found.least_work.value == pytest.approx(0.0, abs=1e-9)
    assert found.greatest_work.value == pytest.approx(0.01 * weight_of(scene), rel=1e-9)
    program = build_program(scene, verdict.contact_set)
    forces = found.forces[0]
    for name, share in (("knife-0", 0.5), ("knife-1", 0.0), ("knife-2", 0.5)):
        carried = forces[program.part_a == scene.index_of(name)].sum()
        assert carried == pytest.approx(share * weight_of(scene), rel=1e-9, abs=1e-6)
    # a support that rises takes the whole beam
    risen = verdict.support_movement({"knife-1": (0, 0, 0.01)})
    assert risen.least_work.value == pytest.approx(-0.01 * weight_of(scene), rel=1e-9)
    assert risen.outcome == "cracks"


@pytest.mark.slow
def test_two_leaves_that_lean_on_each_other():
    half, height, by = 2.0, 1.5, 1e-3
    feet = [
        Part(name, Box(1, 3, 1), [x, 0, -0.5], grounded=True)
        for name, x in (("left", -half), ("right", half))
    ]
    leaves = [
        Part(name, Box(1, 1, 1), [x, 0, height / 2])
        for name, x in (("first", -half / 2), ("second", half / 2))
    ]
    rows = [("left", "first", -half, 0.0, [0, 0, 1]), ("right", "second", half, 0.0, [0, 0, 1])]
    rows.append(("first", "second", 0.0, height, [1, 0, 0]))
    hinges = [
        kilter.GivenContact((a, b), [[x, y, z] for y in (-1, 1)], normal)
        for a, b, x, z, normal in rows
    ]
    scene = Assembly([*feet, *leaves], contacts=hinges, detect=False, friction=3.0)
    found = spread(scene, 2 * by)
    assert (found.outcome, found.exact) == ("follows", True)
    thrust = 1000 * G * (half / 2) / height
    assert found.least_work.value == pytest.approx(2 * by * thrust, rel=1e-8)
    for name, side in (("first", 1), ("second", -1)):
        k = scene.index_of(name)
        at = np.array([0, 0, height]) - scene.geometry.center[k]
        apex = found.motion[k, :3] + np.cross(found.motion[k, 3:], at)
        assert apex == pytest.approx((0, 0, -half * by / height), abs=1e-9)
        assert side * found.motion[k, 0] < 0


@pytest.mark.slow
def test_all_supports_that_sink_take_the_assembly_along():
    scene = arch(10, 1.0)
    down = dict.fromkeys(("left", "right"), (0, 0, -0.01))
    found = kilter.check(scene).support_movement(down)
    assert (found.outcome, found.exact, found.opened) == ("follows", True, ())
    assert found.least_work.value == pytest.approx(0.01 * weight_of(scene), rel=1e-8)
    assert all(part.translation == pytest.approx((0, 0, -0.01), abs=1e-8) for part in found.moves)


def test_a_wall_that_is_pressed_into_a_slot_squeezes():
    found = kilter.check(slot(), require="equilibrium").support_movement({"left": (0.01, 0, 0)})
    assert (found.outcome, found.exact) == ("squeezed", False)
    assert found.least_work.value is None
    assert "as long as friction holds" in found.sentence


def test_a_block_on_a_floor_that_turns():
    held = Part("floor", Box(4, 4, 1), [0, 0, -0.5], grounded=True)
    scene = Assembly([held, Part("box", Box(1, 1, 1), [0.5, 0, 0.5])], friction=0.5)
    found = kilter.check(scene).support_movement(turned={"floor": (0, 1, 0, 0.1)})
    angle = math.radians(0.1)
    assert (found.outcome, found.exact) == ("follows", True)
    # about the floor's centre, .5 below its top: x = angle * 1, z = -angle * .5
    assert found.moves[0].translation == pytest.approx((angle, 0, -angle * 0.5), abs=1e-10)
    assert found.moves[0].rotation == pytest.approx((0, 0.1, 0), abs=1e-9)


def test_an_assembly_that_falls_falls_however_little_its_supports_move():
    found = spread(arch(10, 0.3))
    assert (found.outcome, found.exact, found.moves) == ("falls", False, ())


def test_the_movement_of_an_undecided_assembly_is_unknown():
    round_floor = Part("floor", kilter.Sphere(1.0), grounded=True)
    scene = Assembly([round_floor, Part("ball", kilter.Sphere(0.5), [0, 0, 1.4])])
    verdict = kilter.check(scene)
    assert (verdict.verdict, verdict.level) == ("undecided", None)
    found = verdict.support_movement({"floor": (0.01, 0, 0)})
    assert (found.outcome, found.exact) == ("unknown", False)


@pytest.mark.parametrize("seed", range(6))
def test_released_energy_and_least_work_agree_in_irregular_piles(seed):
    rng = np.random.default_rng(seed)
    supports = [
        Part(f"s{k}", Box(1.2, 2, 1), [x, 0, -0.5], grounded=True) for k, x in enumerate((-2, 0, 2))
    ]
    beams = [
        Part("low", Box(5.2, 1, 0.4), [rng.uniform(-0.2, 0.2), 0, 0.2]),
        Part("left", Box(2.2, 1, 0.4), [rng.uniform(-1.4, -1.2), 0, 0.6]),
        Part("right", Box(2.2, 1, 0.4), [rng.uniform(1.2, 1.4), 0, 0.6]),
        Part("top", Box(3.0, 1, 0.4), [rng.uniform(-0.3, 0.3), 0, 1.0]),
    ]
    scene = Assembly([*supports, *beams], friction=0.6)
    verdict = kilter.check(scene)
    moved = {f"s{k}": rng.normal(size=3) * [2e-4, 2e-4, 3e-3] for k in range(3)}
    found = verdict.support_movement(moved)
    program = build_program(scene, verdict.contact_set)
    released = float((program.load * found.motion)[program.free].sum())
    scale = 3e-3 * weight_of(scene)
    assert found.least_work.proved
    assert released == pytest.approx(found.least_work.value, abs=1e-7 * scale)
    assert found.least_work.value <= found.greatest_work.value + 1e-9 * scale
    along = found.forces[0]
    opening = program.velocities(found.motion)
    assert (opening >= -1e-7 * 3e-3).all()
    if found.exact:  # a contact never opens and carries
        assert (np.minimum(opening / 3e-3, along / weight_of(scene)) <= 1e-6).all()


def test_wrong_movements_are_sentences():
    verdict = kilter.check(arch(10, 1.0))
    with pytest.raises(InputError, match="'v1' is not held"):
        verdict.support_movement({"v1": (0, 0, 0.01)})
    with pytest.raises(InputError, match="no part is named 'w'"):
        verdict.support_movement({"w": (0, 0, 0.01)})
    with pytest.raises(InputError, match="more than a tenth of the size"):
        verdict.support_movement({"left": (1, 0, 0)})


@pytest.mark.slow
def test_the_command_moves_supports(tmp_path, capsys):
    path = str(tmp_path / "arch.kilter.json")
    assert main(["example", "arch", "-o", path, "--force"]) == 0
    supports = [part.name for part in kilter.load(path).parts if part.grounded]
    capsys.readouterr()
    words = ["--move", f"{supports[0]}=0,0,-0.001"]
    assert main(["check", path, *words]) == 0
    assert "The assembly cracks: " in capsys.readouterr().out
    assert main(["check", path, *words, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)["movement"]
    assert found["outcome"] == "cracks"
    assert main(["check", path, "--move", "nothing"]) == 2
    assert "write --move base=0,0,-0.01" in capsys.readouterr().err
