"""Random assemblies with friction that are unstable by a chosen distance beyond their limit.

Each family has one number that makes its assemblies fall: the thickness of an arch, the slope of a
stack, the lean of a wall. The limit is bracketed by proofs, forces on one side and a motion on the
other. The assembly then lies beyond it by a relative distance (thickness) or by an angle [rad].
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from kilter.analysis.decision.judge import judge
from kilter.arrays import Array
from kilter.assembly import Assembly, Part
from kilter.contact import contacts
from kilter.mechanics.program import build_program
from kilter.scenes.arches import arch_with_held_ends
from kilter.scenes.pieces import block, floor, moved, turn
from kilter.scenes.walls import wall

FAMILIES = ("arch", "stack", "wall")
BRACKET = 1e-7
"""Width of the bracket of a limit, relative or [rad]: a thousandth of the least distance."""
NEAR, FAR = (1e-4, 1e-3), (1e-3, 0.3)
"""Ranges of the distance beyond the limit: of a third of the assemblies, and of the others."""


class BeyondLimit(NamedTuple):
    """An unstable assembly, with its family and its distance beyond the limit."""

    family: str
    distance: float
    assembly: Assembly


def beyond_limit(seed: int) -> BeyondLimit:
    """Build a random assembly beyond its limit; the same seed gives the same assembly."""
    random = np.random.default_rng(seed)
    family = FAMILIES[seed % len(FAMILIES)]
    low, high = NEAR if (seed // len(FAMILIES)) % 3 == 0 else FAR
    distance = float(np.exp(random.uniform(np.log(low), np.log(high))))
    if family == "arch":
        count = int(random.choice([8, 10, 12, 16, 20, 30, 40]))
        limit = thinnest_arch(count)
        return BeyondLimit(family, distance, _arch(count, limit * (1 - distance)))
    made = _stack(random) if family == "stack" else _leaning_wall(random)
    limit = _limit(made, 0.0, 1.2)
    return BeyondLimit(family, distance, made(limit + distance))


def thinnest_arch(count: int) -> float:
    """Least thickness of a semicircular arch of straight voussoirs, inner radius 5, friction 0.7.

    The fallen side of the bracket; 0.36820598 for 20 voussoirs, of which both ends are held.
    """
    return _limit(lambda thickness: _arch(count, thickness), 2.0, 0.05)


def _arch(count: int, thickness: float) -> Assembly:
    return arch_with_held_ends(count, thickness=thickness, inner=5.0, friction=0.7)


def _stack(random: np.random.Generator) -> Callable[[float], Assembly]:
    """A stack of one to five boxes on a slope of a given angle [rad], as a function of it."""
    parts: list[Part] = [floor([-9, -9], [9, 9])]
    middle, height = np.zeros(2), 0.0
    for k in range(int(random.integers(1, 6))):
        half, rise = random.uniform(0.25, 0.75, 2), float(random.uniform(0.3, 1.2))
        middle = middle + random.uniform(-0.15, 0.15, 2)
        low, high = [*(middle - half), height], [*(middle + half), height + rise]
        parts.append(block(f"box-{k}", low, high))
        height += rise
    friction, azimuth = float(random.uniform(0.2, 0.9)), float(random.uniform(0, 360))
    whole = Assembly(parts, friction=friction)

    def on_slope(angle: float) -> Assembly:
        turned = moved(whole, turn([0, 0, 1], azimuth))
        turned = moved(turned, turn([0, 1, 0], np.degrees(angle)))
        return turned.with_down(np.array([0.0, 0.0, -1.0]))

    return on_slope


def _leaning_wall(random: np.random.Generator) -> Callable[[float], Assembly]:
    """A wall of bricks that leans by a given angle [rad], as a function of it."""
    courses, bricks = (int(k) for k in random.integers(2, 6, 2))
    friction, direction = float(random.uniform(0.2, 0.9)), float(random.uniform(0, 2 * np.pi))
    whole = wall(courses, bricks, friction=friction)
    aside = np.array([np.cos(direction), np.sin(direction), 0.0])

    def leaning(angle: float) -> Assembly:
        down: Array = np.sin(angle) * aside - np.cos(angle) * np.array([0.0, 0.0, 1.0])
        return whole.with_down(down)

    return leaning


def _limit(made: Callable[[float], Assembly], held: float, fallen: float) -> float:
    """Bracket the number at which an assembly starts to fall, and return the fallen side."""
    while abs(fallen - held) > BRACKET * max(1.0, abs(held)):
        middle = (held + fallen) / 2
        assembly = made(middle)
        if judge(build_program(assembly, contacts(assembly))).stable:
            held = middle
        else:
            fallen = middle
    return fallen
