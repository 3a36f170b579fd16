"""Loads of a carrier: B y against differences of Newton and Euler along random motions."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from boxes_on_deck import stack_on_deck
from scipy.spatial.transform import Rotation

import kilter
from kilter.analysis.transport.carrier import (
    PAIRS,
    CarrierMotion,
    carried_assembly,
    carrier_wrench,
    load_matrix,
)
from kilter.contact import contacts
from kilter.errors import InputError
from kilter.mechanics.program import build_program


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
def test_loads_are_those_of_newton_and_euler(seed: int) -> None:
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
def test_the_matrix_gives_the_same_loads_in_every_unit(units: str) -> None:
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


def test_free_fall_is_an_input_error() -> None:
    assembly = stack_on_deck([[1, 1, 1]], 0.5)
    with pytest.raises(InputError, match="falls freely"):
        carried_assembly(assembly, CarrierMotion(assembly.gravity))
