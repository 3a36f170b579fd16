"""Limits of transport with closed forms: accelerations, turning carriers, least directions."""

import copy
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from boxes_on_deck import portal, random_stack, stack_on_deck
from scipy.spatial.transform import Rotation

import kilter
from kilter import Box, CarrierMotion, Cylinder, InputError, Part, contacts
from kilter.analysis.load_limit import Limit, NoLimit, find_limit
from kilter.analysis.margins import tilt
from kilter.analysis.transport.carried_set import CarriedSet, LeastAcceleration
from kilter.analysis.transport.carrier import PAIRS, carried_assembly, carrier_wrench, load_matrix
from kilter.mechanics.certificate import check_forces, check_motion
from kilter.mechanics.program import build_program
from kilter.mechanics.proof import digest_of
from kilter.scenes.arches import arch, oppenheim_arch
from kilter.scenes.stacks import block_on_slope

G = 9.81
SIDE = 1e-3
"""Distance of the tests from a limit, relative."""


def _holds(assembly: kilter.Assembly, motion: CarrierMotion) -> bool:
    """Whether forces that hold the assembly exist under a motion of its carrier."""
    return kilter.check(carried_assembly(assembly, motion), require="equilibrium").level is not None


def _limit(assembly: kilter.Assembly, motion: CarrierMotion) -> float:
    """Largest factor of a motion; check agrees on both sides of it."""
    limit = CarriedSet(build_program(assembly, contacts(assembly))).share(motion)
    assert isinstance(limit, Limit)
    for share, held in ((limit.value * (1 - SIDE), True), (limit.value * (1 + SIDE), False)):
        part = CarrierMotion(
            share * np.asarray(motion.acceleration),
            np.sqrt(share) * np.asarray(motion.angular_velocity),
            share * np.asarray(motion.angular_acceleration),
            motion.about,
        )
        assert _holds(assembly, part) == held
    return limit.value


def test_directions_without_any_limit_above_0_are_solved_once(monkeypatch):
    solved = []

    def counted(*arguments, **options):
        solved.append(arguments)
        return find_limit(*arguments, **options)

    monkeypatch.setattr(tilt, "find_limit", counted)
    program = build_program(smooth := stack_on_deck([[1, 1, 1]] * 3, 0.0), contacts(smooth))
    carried = CarriedSet(program)
    for angle in np.radians([0, 120, 240, 37, 61, 170, 301]):
        limit = carried.along([np.cos(angle), np.sin(angle), 0])
        assert limit.value == 0
        pushed = program.with_rows(
            applied=1e-3 * carrier_wrench(program, CarrierMotion([np.cos(angle), np.sin(angle), 0]))
        )
        assert check_motion(pushed, limit.motion.motion).holds
        assert check_forces(program, limit.forces.forces, limit.forces.friction).holds
    assert 1 <= len(solved) <= 3


@pytest.mark.quick(2)
@pytest.mark.parametrize(
    ("assembly", "expected"),
    [
        (stack_on_deck([[0.1, 0.1, 0.2]], 0.3), 0.3 * G),
        (stack_on_deck([[0.1, 0.1, 0.2]], 0.6), 0.5 * G),
        (stack_on_deck([[1, 1, 1]] * 3, 0.5), G / 3),
        (stack_on_deck([[1, 1, 1]] * 5, 0.6), G / 5),
        (portal([0.038, 0.103], friction=0.5), G * 0.038 / 0.103),
    ],
    ids=["slides", "tips", "3 cubes", "5 cubes", "portal"],
)
def test_straight_acceleration(assembly, expected):
    assert _limit(assembly, CarrierMotion([1.0, 0, 0])) == pytest.approx(expected, rel=1e-7)


@pytest.mark.parametrize("friction", [0.6, 0.2])
def test_turntable_at_constant_speed(friction):
    assembly = stack_on_deck([[0.06, 0.06, 0.2]], friction, at=(0.5, 0))
    limit = _limit(assembly, CarrierMotion(angular_velocity=[0, 0, 1.0]))
    assert limit == pytest.approx(G * min(friction, 0.3) / 0.5, rel=1e-7)


@pytest.mark.parametrize(
    ("side", "expected"), [(0.2, 3.916757), (0.1, 3.922185), (0.05, 3.923546), (0.01, 3.923982)]
)
def test_turntable_that_speeds_up(side, expected):
    """The torque of the angular acceleration needs friction, too: less for a smaller box."""
    assembly = stack_on_deck([[side, side, side / 50]], 0.4, at=(0.5, 0))
    angle = np.radians(40)  # of the acceleration of the centre from the inward radius
    motion = CarrierMotion(
        angular_velocity=[0, 0, np.sqrt(np.cos(angle) / 0.5)],
        angular_acceleration=[0, 0, np.sin(angle) / 0.5],
    )
    assert _limit(assembly, motion) == pytest.approx(expected, abs=6e-4)


@pytest.mark.parametrize(
    ("axis_below", "degrees", "expected"),
    [(1.5, 10, 1.624412), (1.5, 20, 0.651415), (0.0, 10, 7.357632)],
)
def test_rolling_carrier_tips_a_box_at_its_turning_point(axis_below, degrees, expected):
    wide, high = 0.3, 0.6
    assembly = stack_on_deck([[wide, wide, high]], 0.8)
    angle = np.radians(degrees)
    tilted = assembly.with_down([np.sin(angle), 0, -np.cos(angle)])
    motion = CarrierMotion(angular_acceleration=[0, -1.0, 0], about=[0, 0, -axis_below])
    arm = axis_below + high / 2
    closed = G * (wide * np.cos(angle) - high * np.sin(angle)) / 2
    closed /= arm * high / 2 + (wide**2 + high**2) / 12
    assert closed == pytest.approx(expected, abs=1e-6)
    assert _limit(tilted, motion) == pytest.approx(closed, rel=1e-6)


def test_rolling_carrier_lets_a_flat_box_slide():
    assembly = stack_on_deck([[0.4, 0.4, 0.2]], 0.3)
    angle = np.radians(8)
    tilted = assembly.with_down([np.sin(angle), 0, -np.cos(angle)])
    motion = CarrierMotion(angular_acceleration=[0, -1.0, 0], about=[0, 0, -2.0])
    closed = G * (0.3 * np.cos(angle) - np.sin(angle)) / 2.1
    assert closed == pytest.approx(0.737653, abs=1e-6)
    assert _limit(tilted, motion) == pytest.approx(closed, rel=1e-6)


def test_middle_of_a_roll_beside_a_sideways_acceleration():
    """o^2 = (g - a0 h / b) / z: the box tips, since its spin takes weight from it."""
    wide, high, sideways = 0.3, 0.6, 2.0
    assembly = stack_on_deck([[wide, wide, high]], 0.8)
    squared = (G - sideways * high / wide) / (1.5 + high / 2)
    assert squared == pytest.approx(3.227778, abs=1e-6)
    for share, held in ((1 - SIDE, True), (1 + SIDE, False)):
        motion = CarrierMotion(
            [-sideways, 0, 0], [0, np.sqrt(share * squared), 0], about=[0, 0, -1.5]
        )
        assert _holds(assembly, motion) == held


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    ("assembly", "expected"),
    [(arch(20), 0.149350), (oppenheim_arch(), 0.373612), (oppenheim_arch(sectors=True), 0.370010)],
    ids=["arch", "Oppenheim", "Oppenheim sectors"],
)
def test_arches(assembly, expected):
    assert _limit(assembly, CarrierMotion([G, 0, 0])) == pytest.approx(expected, abs=2e-6)


@pytest.mark.quick(1)
@pytest.mark.parametrize("seed", range(12))
def test_a_slice_lies_between_its_polygon_and_its_lines(seed):
    """Check holds just inside each corner of the polygon and not just beyond each proved line."""
    assembly = random_stack(seed)
    program = build_program(assembly, contacts(assembly))
    section = CarriedSet(program).slice(np.eye(3)[:2], accuracy=0.02)
    if not hasattr(section, "points"):
        assert kilter.check(assembly, require="equilibrium").level is None
        return
    beyond = section.points @ section.normals[section.proved].T - section.reach[section.proved]
    assert beyond.max() <= 1e-7
    for point in section.points[:: max(1, len(section.points) // 6)]:
        along = np.array([*point, 0.0]) * program.g
        assert _holds(assembly, CarrierMotion((1 - SIDE) * along))
        assert not _holds(assembly, CarrierMotion((1 + SIDE) * along))


def test_rest_that_is_not_held_carries_nothing():
    answer = kilter.transport(block_on_slope(30.0, friction=0.2))
    assert answer.least is None
    assert answer.limits == ()
    assert answer.to_dict()["sentence"].startswith("It falls at rest")


@pytest.mark.slow
def test_the_least_friction_of_a_range_is_the_worst_case():
    """A flat box slides at LOW mu g; check with this coefficient agrees on both sides."""
    box = stack_on_deck([[1, 1, 0.2]], 0.5)
    answer = kilter.transport(box, polar=False, mu_range=(0.8, 1.2))
    assert [limit.g for limit in answer.limits[:4]] == pytest.approx([0.4] * 4, rel=1e-7)
    weak = stack_on_deck([[1, 1, 0.2]], 0.4)
    for share, held in ((0.4 * (1 - SIDE), True), (0.4 * (1 + SIDE), False)):
        motion = CarrierMotion([share * G, 0, 0])
        assert _holds(weak, motion) == held
        asked = kilter.transport(box, turn=motion, mu_range=(0.8, 1.2), require="equilibrium")
        assert asked.carried == held
    proof = answer.proof()
    assert kilter.verify(box, proof).holds
    proof["proofs"][0]["change"]["mu_share"] = 0.9
    proof["digest"] = digest_of(proof)
    assert not kilter.verify(box, proof).holds


def _bodies(count: int, seed: int) -> kilter.Assembly:
    """Free convex bodies with full inertia tensors, far apart, beside a held box."""
    rng = np.random.default_rng(seed)
    parts = [kilter.Part("base", kilter.Box([1, 1, 1]), grounded=True)]
    for k in range(count):
        turn = Rotation.random(random_state=seed + k).as_quat()[[3, 0, 1, 2]]
        pose = kilter.Pose(rng.uniform(-3, 3, 3) + np.array([10.0 * k, 0, 0]), turn)
        size = rng.uniform(0.2, 1.5, 3)
        parts.append(kilter.Part(f"b{k}", kilter.Box(size), pose, density=rng.uniform(100, 3000)))
    return kilter.Assembly(parts)


STEP = 2e-3
"""Step of the differences, whose errors are of its fourth power [s]."""


def _first(value: Callable[[float], np.ndarray], time: float) -> np.ndarray:
    """First derivative by central differences of the fourth order."""
    near = value(time + STEP) - value(time - STEP)
    far = value(time + 2 * STEP) - value(time - 2 * STEP)
    return (8 * near - far) / (12 * STEP)


def _second(value: Callable[[float], np.ndarray], time: float) -> np.ndarray:
    """Second derivative by central differences of the fourth order."""
    near = value(time + STEP) + value(time - STEP)
    far = value(time + 2 * STEP) + value(time - 2 * STEP)
    return (16 * near - far - 30 * value(time)) / (12 * STEP**2)


@pytest.mark.quick(2)
@pytest.mark.parametrize("seed", range(10))
def test_loads_are_those_of_newton_and_euler(seed):
    """Minus the rates of momentum and of angular momentum, seen in the carrier: 200 bodies."""
    assembly = _bodies(20, seed)
    program = build_program(assembly, contacts(assembly))
    rng = np.random.default_rng([seed, 1])
    shift, turn = rng.normal(size=(3, 4)), 0.4 * rng.normal(size=(3, 4))
    about = rng.normal(size=3)

    def place(time: float) -> np.ndarray:
        return shift @ time ** np.arange(4)

    def rotation(time: float) -> np.ndarray:
        return Rotation.from_rotvec(turn @ time ** np.arange(4)).as_matrix()

    def spin(time: float) -> np.ndarray:
        rate = _first(rotation, time) @ rotation(time).T
        return np.array([rate[2, 1], rate[0, 2], rate[1, 0]])

    now = 0.3
    frame = rotation(now).T
    motion = CarrierMotion(
        frame @ _second(place, now), frame @ spin(now), frame @ _first(spin, now), about
    )
    wrench = carrier_wrench(program, motion)
    for k in np.flatnonzero(program.free):
        arm, mass, inertia = program.center[k] - about, program.mass[k], program.inertia[k]

        def at(time: float, arm: np.ndarray = arm) -> np.ndarray:
            return place(time) + rotation(time) @ arm

        def momentum(time: float, inertia: np.ndarray = inertia) -> np.ndarray:
            body = rotation(time)
            return body @ inertia @ body.T @ spin(time)

        force, torque = -mass * frame @ _second(at, now), -frame @ _first(momentum, now)
        assert np.abs(wrench[k, :3] - force).max() <= 1e-6 * np.linalg.norm(force)
        assert np.abs(wrench[k, 3:] - torque).max() <= 1e-6 * np.linalg.norm(torque)


@pytest.mark.parametrize("units", ["m", "mm"])
def test_the_matrix_gives_the_same_loads_in_every_unit(units):
    scale = {"m": 1.0, "mm": 1000.0}[units]
    parts = [
        kilter.Part("base", kilter.Box([scale] * 3), grounded=True),
        kilter.Part("top", kilter.Box([scale] * 3), kilter.Pose([0.1 * scale, 0, scale])),
    ]
    assembly = kilter.Assembly(parts, units=units)
    program = build_program(assembly, contacts(assembly))
    motion = CarrierMotion([1, 2, 3], [0.4, -0.5, 0.6], [0.7, 0.8, -0.9], [0, scale, 0])
    spin = np.asarray(motion.angular_velocity)
    y = [*-np.asarray(motion.acceleration), 0.7, 0.8, -0.9, *(spin[i] * spin[j] for i, j in PAIRS)]
    wrench = carrier_wrench(program, motion)
    assert np.allclose(load_matrix(program, np.asarray(motion.about)) @ y, wrench)
    in_metres = wrench[1] / [1, 1, 1, scale, scale, scale]
    assert in_metres[:3] == pytest.approx([-1000 * c for c in _felt(motion, scale)], rel=1e-9)


def _felt(motion: CarrierMotion, scale: float) -> np.ndarray:
    """Acceleration of the upper cube's centre, in metres."""
    arm = np.array([0.1, -1.0, 1.0])
    spin, turn = np.asarray(motion.angular_velocity), np.asarray(motion.angular_acceleration)
    return motion.acceleration + np.cross(turn, arm) + np.cross(spin, np.cross(spin, arm))


def test_free_fall_is_an_input_error():
    assembly = stack_on_deck([[1, 1, 1]], 0.5)
    with pytest.raises(InputError, match="falls freely"):
        carried_assembly(assembly, CarrierMotion(assembly.gravity))


ROUND = 0.02
"""Largest share of the friction of a round patch that its polygon may lack [-]."""


def carrier(seed: int) -> tuple[kilter.Assembly, float]:
    """A part at rest on a deck, at random, and its largest angular acceleration [rad/s^2]."""
    rng = np.random.default_rng(seed)
    metres = {"m": 1.0, "mm": 1e-3}[units := ("m", "mm")[seed % 2]]
    m, mu = rng.uniform(0.5, 50), rng.uniform(0.1, 1.2)
    x, y, z = rng.uniform(0.1, 1.0, 3)
    shape = Cylinder(x / metres, z / metres) if seed % 4 < 2 else Box(*np.array([x, y, z]) / metres)
    r = x if seed % 4 < 2 else np.hypot(x, y) / 2
    about = m * rng.uniform(0.02, 2.0, 3)
    about[2] = rng.uniform(abs(about[0] - about[1]), about[0] + about[1])
    part = Part("part", shape, [0, 0, z / 2 / metres], mass=m,
                inertia=[*about / metres**2, 0, 0, 0])  # fmt: skip
    deck = Part("deck", Box(np.array([4, 4, 1]) / metres), [0, 0, -0.5 / metres], grounded=True)
    return kilter.Assembly([deck, part], units=units, friction=mu), mu * m * G * r / about[2]


@pytest.mark.quick(4)
@pytest.mark.parametrize("seed", range(100))
def test_a_part_turns_with_its_carrier_up_to_the_torque_of_friction(seed):
    """Asked at 0.8 times the limit it is carried, at 1.01 times it is not, and the factor fits."""
    assembly, limit = carrier(seed)
    for share, carried in ((0.8, True), (1.01, False)):
        motion = CarrierMotion(angular_acceleration=[0, 0, share * limit])
        case = kilter.transport(assembly, turn=motion, require="equilibrium").cases[0]
        assert (case.level is not None) == carried
        assert case.factor is not None
        assert (1 - ROUND) / share <= case.factor <= (1 + 1e-6) / share


SWEEP = 2 * np.pi * np.arange(720) / 720
"""Directions of the sweep [rad]."""


def bounds(stack: kilter.Assembly) -> tuple[np.ndarray, np.ndarray]:
    """Lines n.a <= d [g] that no resultant crosses at the edge of a face, (m, 2) and (m,)."""
    mass, center = stack.geometry.mass, stack.geometry.center
    normals, reach = [], []
    for k in range(1, len(stack.parts)):
        above = (mass[k:] @ center[k:]) / mass[k:].sum()
        height = above[2] - stack.parts[k].pose.position[2] + stack.parts[k].shape.size[2] / 2
        for part in stack.parts[k - 1 : k + 1]:
            for axis in (*np.eye(3)[:2], *-np.eye(3)[:2]):
                outward = part.pose.apply(axis) - part.pose.position
                edge = part.pose.apply(axis * part.shape.size / 2)
                normals.append(-outward[:2])
                reach.append((edge - above) @ outward / height)
    return np.array(normals), np.array(reach)


@pytest.mark.slow
@pytest.mark.parametrize("first", range(0, 220, 10))
def test_the_least_of_random_stacks_is_that_of_closed_forms(first):
    """It is also the least of a sweep of directions, within the step of the sweep."""
    for seed in range(first, first + 10):
        stack = random_stack(seed)
        [mu] = {stack.friction}
        normals, reach = bounds(stack)
        found = CarriedSet(build_program(stack, contacts(stack))).least()
        if reach.min() < 0:
            assert isinstance(found, NoLimit)
            continue
        assert isinstance(found, LeastAcceleration)
        assert found.value == pytest.approx(min(mu, reach.min()), abs=1e-6)
        assert found.lower <= found.value
        slopes = np.column_stack([np.cos(SWEEP), np.sin(SWEEP)]) @ normals.T
        along = np.where(slopes > 0, reach / np.where(slopes > 0, slopes, 1.0), np.inf)
        swept = np.minimum(along.min(axis=1), mu).min()
        assert found.value - 1e-6 <= swept <= found.value / np.cos(np.pi / 720) + 1e-6


def multipliers(assembly: kilter.Assembly) -> dict[str, dict[str, Any]]:
    answer = kilter.transport(assembly, polar=False, collapse=True).to_dict()
    return {entry["name"]: dict(entry) for entry in answer["alpha"]}


@pytest.mark.parametrize(
    ("width", "depth", "height", "mu"),
    [(0.386, 1.14, 0.932, 0.764), (1.14, 0.386, 0.932, 0.764), (1.0, 1.0, 0.5, 0.3)],
    ids=["tips about y", "tips about x", "slides"],
)
@pytest.mark.quick("tips about y")
def test_a_block_tips_over_its_nearest_edge_or_slides(width, depth, height, mu):
    found = multipliers(stack_on_deck([[width, depth, height]], mu))
    assert found["+x"]["alpha0"] == pytest.approx(min(width / height, mu), abs=1e-7)
    assert found["-y"]["alpha0"] == pytest.approx(min(depth / height, mu), abs=1e-7)
    assert found["least"]["alpha0"] == pytest.approx(min(width, depth, mu * height) / height)
    assert found["least"]["upper"] >= found["least"]["alpha0"] * (1 - 1e-9)


@pytest.mark.slow
def test_the_multipliers_are_proved_in_the_file_and_their_mass_is_recomputed():
    """M* of a block that tips is its mass; a shift of the statement is refused."""
    block = stack_on_deck([[0.4, 1.0, 1.0]], 0.9)
    proof = kilter.transport(block, polar=False, collapse=True).proof()
    stated = [entry for entry in proof["proofs"] if entry["about"] == "alpha least"]
    assert sorted(entry["held"] for entry in stated) == [False, True]
    for entry in stated:
        assert entry["value"] == pytest.approx(0.4, abs=1e-6)
    [falls] = [entry for entry in stated if not entry["held"]]
    assert falls["participating_mass"] == pytest.approx(block.geometry.mass[1], rel=1e-6)
    assert kilter.verify(block, copy.deepcopy(proof)).holds
    for key, lie in (("participating_mass", 1.001), ("value", 1.001)):
        forged = copy.deepcopy(proof)
        [entry] = [
            entry
            for entry in forged["proofs"]
            if entry["about"] == "alpha least" and not entry["held"]
        ]
        entry[key] *= lie
        forged["digest"] = digest_of(forged)
        assert not kilter.verify(block, forged).holds
