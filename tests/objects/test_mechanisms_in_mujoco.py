"""Random hinges and slides with limits, friction and springs: kilter beside a simulation."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import pytest
from numpy.random import Generator
from numpy.typing import NDArray

import kilter

mujoco = pytest.importorskip("mujoco")
pytestmark = pytest.mark.slow

PUSH, STAYS, MOVES, SECONDS = 1e-3, 0.02, 0.04, 3.0


@dataclass
class Axis:
    """A body of a chain and the joint that carries it."""

    kind: str
    axis: NDArray[np.float64]
    at: NDArray[np.float64]
    turn: NDArray[np.float64]
    center: NDArray[np.float64]
    mass: float
    guide: dict[str, str] = field(default_factory=dict)


def words(values: NDArray[np.float64]) -> str:
    return " ".join(f"{value:.17g}" for value in values)


def scene(chain: list[Axis]) -> str:
    """MJCF of a chain on a base; friction and limits are as hard as the simulator permits."""
    inner = ""
    for link in reversed(chain):
        guide = " ".join(f'{key}="{value}"' for key, value in link.guide.items())
        inner = (
            f'<body pos="{words(link.at)}" quat="{words(link.turn)}"><inertial '
            f'pos="{words(link.center)}" mass="{link.mass}" diaginertia=".01 .01 .01"/>'
            f'<joint type="{link.kind}" axis="{words(link.axis)}" {guide} damping=".02" '
            'solimpfriction=".99 .999 .001" solreffriction=".004 1" solreflimit=".004 1"/>'
            f'<geom type="box" size=".03 .03 .03"/>{inner}</body>'
        )
    return (
        '<mujoco><compiler angle="radian"/><option timestep=".002" iterations="100" '
        'tolerance="1e-12"/><worldbody><geom type="box" size=".05 .05 .05"/>'
        f"{inner}</worldbody></mujoco>"
    )


def gravity_forces(chain: list[Axis], shift: float = 0.0) -> NDArray[np.float64]:
    """Force or torque of gravity along each joint, with all joints moved by `shift`."""
    model = mujoco.MjModel.from_xml_string(scene(chain))
    data = mujoco.MjData(model)
    data.qpos[:] = shift
    mujoco.mj_forward(model, data)
    return np.asarray(-data.qfrc_bias, dtype=np.float64)


def guide_of(rng: Generator, weight: float) -> dict[str, str]:
    """Limits, friction and spring of a joint that gravity drives by `weight`."""
    guide, left = {}, weight
    if rng.random() < 0.5:
        share = float(rng.choice([0.5, 0.8, 1.5, -0.5]))
        left = weight * (1 - share)
        stiffness = rng.uniform(0.5, 2.0) * abs(left)
        rest = -share * weight / stiffness
        guide |= {"stiffness": str(float(stiffness)), "springref": str(float(rest))}
    limits = rng.choice(["", "0 .6", "-.6 0", "-.6 .6"])
    if limits:
        guide |= {"range": str(limits)}
    if rng.random() < 0.6:
        guide["frictionloss"] = str(float(abs(left) * float(rng.choice([0.3, 0.7, 1.4, 3.0]))))
    return guide


def mechanism(seed: int) -> list[Axis]:
    """One to three links; a third of all are single links on a spring that balances them."""
    rng = np.random.default_rng(seed)
    balanced = seed % 3 == 0
    while True:
        chain = []
        for _ in range(1 if balanced else int(rng.integers(1, 4))):
            turn, axis = rng.normal(size=4), rng.normal(size=3)
            chain.append(
                Axis(
                    "hinge" if balanced else str(rng.choice(["hinge", "slide"])),
                    axis / np.linalg.norm(axis),
                    rng.uniform([0.3, -0.2, -0.2], [0.7, 0.2, 0.2]),
                    turn / np.linalg.norm(turn),
                    rng.uniform(-0.15, 0.15, 3),
                    float(rng.uniform(0.5, 3.0)),
                )
            )
        weight = gravity_forces(chain)
        if np.abs(weight).min() < 0.2:
            continue
        if balanced:
            slope = float((gravity_forces(chain, 1e-5) - weight)[0]) / 1e-5
            stiffness = abs(slope) * float(rng.choice([0.4, 2.0]))
            if stiffness < 0.2:
                continue
            rest = str(float(-weight[0] / stiffness))
            chain[0].guide = {"stiffness": str(float(stiffness)), "springref": rest}
            return chain
        for link, size in zip(chain, weight.tolist(), strict=True):
            link.guide = guide_of(rng, size)
        return chain


def farthest(text: str) -> float:
    """Largest position of a joint after small pushes to both sides, within the limits."""
    model = mujoco.MjModel.from_xml_string(text)
    data, reached = mujoco.MjData(model), 0.0
    for sign in (1.0, -1.0):
        mujoco.mj_resetData(model, data)
        low, high = np.where(model.jnt_limited, model.jnt_range.T, [[-1.0], [1.0]])
        data.qpos[:] = np.clip(sign * PUSH, low, high)
        while data.time < SECONDS and reached < MOVES:
            mujoco.mj_step(model, data)
            reached = max(reached, float(np.abs(data.qpos).max()))
    return reached


@pytest.mark.parametrize("block", range(6))
def test_a_mechanism_stays_in_the_simulation_exactly_if_it_is_stable(block: int) -> None:
    for seed in range(12 * block, 12 * block + 12):
        text = scene(mechanism(seed))
        assembly = kilter.load(mujoco.MjModel.from_xml_string(text))
        verdict = kilter.check(assembly)
        assert kilter.verify(assembly, verdict.proof()).holds
        assert verdict.verdict in ("stable", "balanced", "unstable")
        reached = farthest(text)
        if verdict.verdict == "stable":
            assert verdict.level == "proved"
            assert reached < STAYS, seed
        else:
            assert reached > MOVES, seed
