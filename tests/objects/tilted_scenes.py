"""Random bodies with several geoms on a tilted floor: verdicts beside a simulation.

A body stands on three or four feet with random friction, priority and contact pairs; on some
bodies stands a second body. The slope is at random. A verdict counts if it is the same 3 % below
and above the slope, so that the limit is not near.
"""

from typing import Any, NamedTuple

import mujoco
import numpy as np

import kilter

G = 9.81
SECONDS = 2.0
"""Simulated time [s]."""
MOVED = 1e-3
"""Displacement of a body that counts as sliding [m]."""
NEAR = 0.03
"""Relative distance of the slope from a limit, below which a scene is not judged [-]."""
STEP = 0.002
"""Time step [s]; the time constant of the contacts is twice as long, the least possible."""


class Outcome(NamedTuple):
    """The verdict of a scene, "near" if it changes within 3 %, and the largest displacement [m]."""

    verdict: str
    moved: float

    @property
    def wrong(self) -> bool:
        """Whether a proved verdict contradicts the simulation."""
        if self.verdict == "stable":
            return self.moved > MOVED
        return self.verdict == "unstable" and self.moved <= MOVED


def tilted_model(seed: int) -> tuple[Any, Any]:
    """A model without a slope, and the direction of its slope times tan of its angle, (x, y)."""
    rng = np.random.default_rng(seed)

    def rule() -> str:
        rank = rng.choice([0, 0, 0, 1, 2])
        condim = rng.choice([1, 3, 3, 3, 3, 3])
        return f'friction="{rng.uniform(0.05, 0.9):.3f}" priority="{rank}" condim="{condim}"'

    feet = [(-0.4, -0.3), (-0.4, 0.3), (0.4, -0.3), (0.4, 0.3)]
    if rng.random() < 0.3:
        feet = [(-0.4, -0.3), (-0.4, 0.3), (0.4, 0.0)]
    inside = f'<geom name="plate" type="box" size=".5 .4 .05" pos="0 0 .1" {rule()}/>'
    common, mixed = rule(), rng.random() < 0.5
    for k, (x, y) in enumerate(feet):
        own = rule() if mixed and rng.random() < 0.5 else common
        inside += f'<geom name="foot{k}" type="box" size=".1 .1 .05" pos="{x} {y} 0" {own}/>'
    bodies = f'<body name="desk" pos="0 0 .05"><freejoint/>{inside}</body>'
    names = [f"foot{k}" for k in range(len(feet))]
    if rng.random() < 0.4:
        ends = "".join(
            f'<geom name="end{k}" type="box" size=".1 .2 .05" pos="{x} 0 0" {rule()}/>'
            for k, x in enumerate((-0.1, 0.1))
        )
        bodies += f'<body name="load" pos=".05 .05 .25"><freejoint/>{ends}</body>'
    pairs = "".join(
        f'<pair geom1="floor" geom2="{name}" condim="3" friction="{mu:.3f} {mu:.3f}"/>'
        for name, mu in zip(names, rng.uniform(0.05, 0.9, len(names)), strict=True)
        if rng.random() < 0.2
    )
    model = mujoco.MjModel.from_xml_string(
        '<mujoco><option cone="elliptic"/><worldbody>'
        f'<geom name="floor" type="box" size="9 9 .5" pos="0 0 -.5" {rule()}/>{bodies}'
        f"</worldbody><contact>{pairs}</contact></mujoco>"
    )
    angle = rng.uniform(0, 2 * np.pi)
    return model, rng.uniform(0.02, 0.5) * np.array([np.cos(angle), np.sin(angle)])


def gravity(slope: Any) -> Any:
    """Gravity on a floor with a slope [m/s^2]."""
    down = np.array([*slope, -1.0])
    return G * down / np.linalg.norm(down)


def simulated(model: Any) -> float:
    """Largest displacement of a body along the floor in the simulation [m]."""
    model.opt.timestep = STEP
    model.opt.tolerance, model.opt.iterations = 1e-10, 200
    model.opt.impratio, model.opt.noslip_iterations = 100.0, 20
    model.geom_solref[:] = model.pair_solref[:] = [2 * STEP, 1.0]
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    begin = data.xipos.copy()
    while data.time < SECONDS:
        mujoco.mj_step(model, data)
    return float(np.linalg.norm((data.xipos - begin)[:, :2], axis=1).max())


def outcome(seed: int) -> Outcome:
    """The verdict and the simulation of a scene."""
    model, slope = tilted_model(seed)
    verdicts = set()
    for factor in (1 - NEAR, 1 + NEAR):
        model.opt.gravity[:] = gravity(factor * slope)
        verdicts.add(kilter.check(kilter.load(model), require="proved").verdict)
    verdict = verdicts.pop() if len(verdicts) == 1 else "near"
    model.opt.gravity[:] = gravity(slope)
    return Outcome(verdict, simulated(model))
