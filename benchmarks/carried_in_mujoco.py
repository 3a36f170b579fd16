"""Limits of transport beside MuJoCo: stacks on a moving body, just below and beyond each limit.

    pip install -e ".[mujoco]"
    python benchmarks/carried_in_mujoco.py             30 stacks
    python benchmarks/carried_in_mujoco.py 5 --first 7 seeds 7 to 11
    python benchmarks/carried_in_mujoco.py --causes    also with other settings, for the causes

The deck is a body on two slides, 1e6 times as heavy as its load. It stands still for `REST`, then
its acceleration grows within `RAMP` to a share of kilter's limit in a random horizontal direction,
and stays for `HOLD`. A part that moves by more than `MOVED` of its size, seen from the deck, falls.
The shares are 0.95, at which kilter has forces that hold the stack, and 1.05, at which a motion
proves that none exist.

Settings as in `benchmarks/peers`: elliptic cones, Newton with a small tolerance, the Noslip solver,
and contacts as stiff as two time steps allow. `--causes` repeats all stacks with other values of
single settings. The drift is the mean speed of the part that moves most during the second half of
the constant acceleration. Drift that follows a setting is a property of the soft contacts.
"""

from __future__ import annotations

import argparse
import sys
import time
from dataclasses import dataclass
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parents[1] / "tests" / "scenes"))

import mujoco
import numpy as np
from boxes_on_deck import random_stack

import kilter
from kilter.analysis.load_limit import Limit
from kilter.analysis.transport.carried_set import CarriedSet
from kilter.analysis.transport.carrier import CarrierMotion, carried_assembly, first_motions
from kilter.contact import contacts
from kilter.mechanics.program import build_program

REST, RAMP, HOLD = 1.0, 0.5, 4.0
"""Times at rest, of the growing acceleration and of the constant acceleration [s]."""
MOVED = 0.05
"""Displacement at which a part counts as moved [size of the part]."""
HEAVY = 1e6
"""Mass of the deck over that of its load [-]."""
SHARES = (0.95, 1.05)
"""Shares of the limit that are simulated."""


@dataclass(frozen=True)
class Settings:
    """Settings of MuJoCo that change the softness and the slip of contacts.

    Attributes
    ----------
    step : float
        Time step [s].
    impratio : float
        Impedance of friction over that of the normal force [-].
    noslip : int
        Iterations of the Noslip solver.
    steps : float
        Time constant of the contacts, in time steps; 2 is the least that MuJoCo permits.
    cone : str
        "elliptic" or "pyramidal".
    hold : float
        Time of constant acceleration [s].
    """

    step: float = 0.002
    impratio: float = 100.0
    noslip: int = 20
    steps: float = 2.0
    cone: str = "elliptic"
    hold: float = HOLD


CAUSES = {
    "as in benchmarks/peers": Settings(),
    "without Noslip, impratio 1": Settings(noslip=0, impratio=1.0),
    "without Noslip, impratio 10": Settings(noslip=0, impratio=10.0),
    "without Noslip, impratio 100": Settings(noslip=0),
    "without Noslip, impratio 1000": Settings(noslip=0, impratio=1e3),
    "impratio 1": Settings(impratio=1.0),
    "Noslip 200": Settings(noslip=200),
    "step 0.5 ms": Settings(step=0.0005),
    "contacts 5 times as slow": Settings(steps=10.0),
    "pyramidal cone": Settings(cone="pyramidal"),
    "held for 16 s": Settings(hold=16.0),
}
"""Settings of `--causes`."""


def model_of(assembly: kilter.Assembly, settings: Settings) -> mujoco.MjModel:
    """The stack on a deck that slides along x and y."""
    geometry = assembly.geometry
    shape = (
        f'type="box" friction="{assembly.friction} 0 0" condim="3" '
        f'solref="{settings.steps * settings.step} 1"'
    )
    bodies = []
    for k, part in enumerate(assembly.parts):
        size = " ".join(f"{length / 2:.17g}" for length in np.asarray(part.shape.size))
        place = " ".join(f"{value:.17g}" for value in part.pose.position)
        turn = " ".join(f"{value:.17g}" for value in part.pose.rotation)
        heavy = HEAVY * float(geometry.mass[~geometry.grounded].sum())
        joints = "<freejoint/>"
        if part.grounded:
            joints = '<joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/>'
        mass = heavy if part.grounded else float(geometry.mass[k])
        bodies.append(
            f'<body name="{part.name}" pos="{place}" quat="{turn}">{joints}'
            f'<geom {shape} size="{size}" mass="{mass:.17g}"/></body>'
        )
    gravity = " ".join(f"{value:.17g}" for value in assembly.gravity)
    return mujoco.MjModel.from_xml_string(
        f'<mujoco><option timestep="{settings.step}" cone="{settings.cone}" '
        f'impratio="{settings.impratio}" solver="Newton" iterations="100" tolerance="1e-10" '
        f'noslip_iterations="{settings.noslip}" gravity="{gravity}"/>'
        f'<size memory="200M"/><worldbody>{"".join(bodies)}</worldbody></mujoco>'
    )


@dataclass(frozen=True)
class Drift:
    """Motion of the stack relative to its deck.

    Attributes
    ----------
    moved : float
        Largest displacement or turn [size of the part].
    at : float
        Time of constant acceleration after which `MOVED` is reached; infinite if it is not [s].
    speed : float
        Mean speed in the second half of the constant acceleration [sizes/s].
    """

    moved: float
    at: float
    speed: float

    @property
    def falls(self) -> bool:
        return self.moved >= MOVED


def simulate(assembly: kilter.Assembly, acceleration: np.ndarray, settings: Settings) -> Drift:
    """Move the deck with an acceleration, and measure the parts relative to it."""
    model = model_of(assembly, settings)
    data = mujoco.MjData(model)
    geometry = assembly.geometry
    free = np.flatnonzero(~geometry.grounded)
    deck = int(np.flatnonzero(geometry.grounded)[0])
    bodies, size = free + 1, geometry.size[free]
    mass = model.body_mass[deck + 1]

    def places() -> tuple[np.ndarray, np.ndarray]:
        return data.xpos[bodies] - data.xpos[deck + 1], data.xmat[bodies].copy()

    def moved() -> float:
        place, frame = places()
        shift = np.linalg.norm(place - start[0], axis=1) / size
        turn = np.linalg.norm(frame - start[1], axis=1) / 8**0.5
        return float(np.maximum(shift, turn).max())

    while data.time < REST:
        mujoco.mj_step(model, data)
    start = places()
    began = data.time
    track = [(-RAMP, 0.0)]
    while data.time < began + RAMP + settings.hold:
        share = min((data.time - began) / RAMP, 1.0)
        data.xfrc_applied[deck + 1, :3] = share * mass * acceleration
        mujoco.mj_step(model, data)
        track.append((data.time - began - RAMP, moved()))
        if track[-1][1] >= MOVED:
            break
    times, drifts = np.array(track).T
    reached = float(times[-1]) if drifts[-1] >= MOVED else np.inf
    middle, end = np.interp([times[-1] / 2, times[-1]], times, drifts)
    half = max(times[-1] / 2, settings.step)
    return Drift(float(drifts.max()), reached, float((end - middle) / half))


@dataclass(frozen=True)
class Stack:
    """A stack with its limit in a random horizontal direction."""

    seed: int
    assembly: kilter.Assembly
    direction: np.ndarray
    limit: float
    motion: str

    def acceleration(self, share: float) -> np.ndarray:
        """Acceleration of the carrier at a share of the limit [m/s^2]."""
        size = float(np.linalg.norm(self.assembly.gravity))
        return share * self.limit * size * self.direction


def stack_of(seed: int) -> Stack | None:
    """The random stack of a seed; None if it does not stand at rest."""
    assembly = random_stack(seed)
    touching = contacts(assembly)
    if kilter.check(assembly, contacts=touching, require="equilibrium").level is None:
        return None
    angle = np.random.default_rng([seed, 2]).uniform(0, 2 * np.pi)
    direction = np.array([np.cos(angle), np.sin(angle), 0.0])
    program = build_program(assembly, touching)
    limit = CarriedSet(program).along(direction)
    if not isinstance(limit, Limit) or not np.isfinite(limit.value):
        return None
    first = first_motions(assembly, limit, CarrierMotion(program.g * direction))
    words = ", ".join(f"{motion.part} {motion.words}" for motion in first[:2])
    return Stack(seed, assembly, direction, limit.value, words)


def told(drift: Drift) -> str:
    """A drift in words."""
    word = f"falls after {drift.at:.2f} s" if drift.falls else "holds"
    return f"{word}, moved {drift.moved:.1e}, drifts at {drift.speed:.1e} sizes/s"


def compare(stacks: list[Stack], settings: Settings) -> dict[float, list[Drift]]:
    """Drift of each stack at each share of its limit."""
    return {
        share: [simulate(stack.assembly, stack.acceleration(share), settings) for stack in stacks]
        for share in SHARES
    }


def main() -> None:
    """Compare all stacks with each setting, and print the disagreements."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("count", type=int, nargs="?", default=30)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--causes", action="store_true", help="also with other settings")
    given = parser.parse_args()
    started, seed = time.process_time(), given.first
    stacks: list[Stack] = []
    while len(stacks) < given.count:
        stack, seed = stack_of(seed), seed + 1
        stacks += [] if stack is None else [stack]
    below, beyond = SHARES
    for name, settings in CAUSES.items() if given.causes else [next(iter(CAUSES.items()))]:
        drifts = compare(stacks, settings)
        agree = [sum(d.falls == (share > 1) for d in drifts[share]) for share in SHARES]
        speeds = np.array([drift.speed for drift in drifts[below]])
        print(
            f"{name:30s} agree {agree[0]:3d} of {len(stacks)} at {below}, {agree[1]:3d} of "
            f"{len(stacks)} at {beyond}; drift at {below}: median {np.median(speeds):.1e}, largest "
            f"{speeds.max():.1e} sizes/s",
            flush=True,
        )
        for share in SHARES:
            for stack, drift in zip(stacks, drifts[share], strict=True):
                if drift.falls != (share > 1):
                    felt = carried_assembly(
                        stack.assembly, CarrierMotion(stack.acceleration(share))
                    )
                    print(
                        f"    seed {stack.seed} at {share} of {stack.limit:.4f} g ({stack.motion}):"
                        f" kilter {kilter.check(felt).level}, MuJoCo {told(drift)}",
                        flush=True,
                    )
    print(f"{time.process_time() - started:.0f} CPU s")


if __name__ == "__main__":
    main()
