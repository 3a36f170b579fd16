"""Second derivatives of stops, friction and springs of joints beside differences of exact gaps."""

from __future__ import annotations

import numpy as np
import pytest

import kilter
from kilter import Assembly, Box, Joint, Part, Pose
from kilter.arrays import Array
from kilter.mechanics.program import Program, build_program
from kilter.mechanics.rows import DRAG, STOP
from kilter.second_order.gaps.joint_forms import joint_errors, joint_forms, of_joints
from kilter.second_order.gaps.joint_springs import spring_excess, spring_form

STEP = 1e-4


def linked(seed: int, kind: str) -> tuple[Assembly, Program]:
    """Two free parts in random poses with a joint that has stops, friction and a spring."""
    rng = np.random.default_rng(seed)
    parts = [
        Part(name, Box(rng.uniform(0.5, 2, 3)), Pose(rng.normal(size=3), rng.normal(size=4)))
        for name in ("a", "b")
    ]
    joint = Joint(
        ("a", "b"), kind, rng.normal(size=3), rng.normal(size=3), limits=(0.0, 0.0), friction=2.0,
        stiffness=float(rng.uniform(1, 5)), rest=float(rng.normal()),
    )  # type: ignore[arg-type]  # fmt: skip
    assembly = Assembly(
        parts, joints=[joint], contacts=[kilter.GivenContact(("a", "b"), [], [1, 0, 0])]
    )
    return assembly, build_program(assembly, kilter.contacts(assembly))


def second_difference(value: object, along: Array) -> Array:
    """Second derivative of a function of motions, (2, 6), along one of them."""
    assert callable(value)
    sides = value(STEP * along), value(0 * along), value(-STEP * along)
    return np.asarray((sides[0] - 2 * sides[1] + sides[2]) / STEP**2)


@pytest.mark.parametrize("kind", ["revolute", "prismatic"])
@pytest.mark.parametrize("seed", range(4))
def test_forms_are_the_second_derivatives_of_exact_gaps_and_energies(seed: int, kind: str) -> None:
    assembly, program = linked(seed, kind)
    joints = assembly.joints
    assert [int((program.kind == of).sum()) for of in (STOP, DRAG)] == [2, 1]
    forms, energy = joint_forms(program, joints), spring_form(program, joints)
    assert energy is not None
    rng = np.random.default_rng(seed + 100)
    for _ in range(3):
        motion = rng.normal(size=(2, 6))
        motion /= np.abs(motion).max()
        flat = motion.reshape(-1)
        gaps = second_difference(lambda z: joint_errors(program, joints, z), motion)
        assert of_joints(program).all()
        assert gaps == pytest.approx(np.einsum("i,kij,j->k", flat, forms, flat), abs=1e-5)
        cost = second_difference(lambda z: np.array(spring_excess(program, joints, z)), motion)
        assert cost == pytest.approx(flat @ energy @ flat, rel=1e-5, abs=1e-5)


def test_a_spring_is_a_load_in_the_drawn_pose() -> None:
    """The first derivative of its energy k (g + rest)^2 / 2, g the motion of b past a."""
    for kind in ("revolute", "prismatic"):
        assembly, program = linked(1, kind)
        joint, row = assembly.joints[0], int(np.flatnonzero(program.kind == DRAG)[0])
        motion = np.random.default_rng(3).normal(size=(2, 6))
        speed = -float(program.velocities(motion)[row])  # the row is along minus the axis
        power = float((program.clamp * motion).sum())
        assert power == pytest.approx(-joint.stiffness * joint.rest * speed)
