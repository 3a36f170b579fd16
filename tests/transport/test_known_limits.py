"""Closed forms of carried accelerations, on both sides by `kilter.check`."""

from __future__ import annotations

import numpy as np
import pytest
from boxes_on_deck import portal, random_stack, stack_on_deck

import kilter
from kilter.analysis.load_limit import Limit
from kilter.analysis.transport.carried_set import CarriedSet
from kilter.analysis.transport.carrier import CarrierMotion, carried_assembly
from kilter.contact import contacts
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
def test_straight_acceleration(assembly: kilter.Assembly, expected: float) -> None:
    assert _limit(assembly, CarrierMotion([1.0, 0, 0])) == pytest.approx(expected, rel=1e-7)


@pytest.mark.parametrize("friction", [0.6, 0.2])
def test_turntable_at_constant_speed(friction: float) -> None:
    assembly = stack_on_deck([[0.06, 0.06, 0.2]], friction, at=(0.5, 0))
    limit = _limit(assembly, CarrierMotion(angular_velocity=[0, 0, 1.0]))
    assert limit == pytest.approx(G * min(friction, 0.3) / 0.5, rel=1e-7)


@pytest.mark.parametrize(
    ("side", "expected"), [(0.2, 3.916757), (0.1, 3.922185), (0.05, 3.923546), (0.01, 3.923982)]
)
def test_turntable_that_speeds_up(side: float, expected: float) -> None:
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
def test_rolling_carrier_tips_a_box_at_its_turning_point(
    axis_below: float, degrees: float, expected: float
) -> None:
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


def test_rolling_carrier_lets_a_flat_box_slide() -> None:
    assembly = stack_on_deck([[0.4, 0.4, 0.2]], 0.3)
    angle = np.radians(8)
    tilted = assembly.with_down([np.sin(angle), 0, -np.cos(angle)])
    motion = CarrierMotion(angular_acceleration=[0, -1.0, 0], about=[0, 0, -2.0])
    closed = G * (0.3 * np.cos(angle) - np.sin(angle)) / 2.1
    assert closed == pytest.approx(0.737653, abs=1e-6)
    assert _limit(tilted, motion) == pytest.approx(closed, rel=1e-6)


def test_middle_of_a_roll_beside_a_sideways_acceleration() -> None:
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
def test_arches(assembly: kilter.Assembly, expected: float) -> None:
    assert _limit(assembly, CarrierMotion([G, 0, 0])) == pytest.approx(expected, abs=2e-6)


@pytest.mark.quick(1)
@pytest.mark.parametrize("seed", range(12))
def test_a_slice_lies_between_its_polygon_and_its_lines(seed: int) -> None:
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


def test_rest_that_is_not_held_carries_nothing() -> None:
    answer = kilter.transport(block_on_slope(30.0, friction=0.2))
    assert answer.least is None
    assert answer.limits == ()
    assert answer.to_dict()["sentence"].startswith("It falls at rest")


@pytest.mark.slow
def test_the_least_friction_of_a_range_is_the_worst_case() -> None:
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
