"""Round assemblies of exact solids have the same states as their meshes.

Balls, pegs and cups have random sizes and fineness, and are turned and moved. The state of the
exact solids is known in closed form, and also computed. That of the meshes may be open, but never
different.
"""

import sys
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

import kilter
from kilter import Assembly, Box, Part, Pose
from kilter.scenes.pieces import moved, turn

sys.path.append(str(Path(__file__).parents[1] / "contact"))

import solids

Random = np.random.Generator
X, Y, Z = np.eye(3)
LYING = turn(X, 90)
TABLE = Part("table", Box([9, 9, 1]), Pose([0, 0, -0.5]), grounded=True)


@dataclass(frozen=True)
class Pair:
    """An assembly as exact solids and as meshes, with its true state."""

    exact: Assembly
    meshes: Assembly
    state: str


def ball_in_bowl(random: Random, fine: int) -> tuple[list[Part], str]:
    r = random.uniform(0.3, 1.0)
    bowl = r * random.uniform(1.02, 3.0)
    cup = solids.socket(bowl, bowl + 1, bowl + 1, -0.1 * bowl, sides=fine, rings=fine // 4)
    return [held(cup), ball(r, fine, [0, 0, r - bowl])], "minimum"


def ball_on_ball(random: Random, fine: int) -> tuple[list[Part], str]:
    r, below = random.uniform(0.3, 1.0, size=2)
    return [held(solids.ball(below, fine, fine // 2)), ball(r, fine, [0, 0, r + below])], "balanced"


def ball_on_table(random: Random, fine: int) -> tuple[list[Part], str]:
    r = random.uniform(0.3, 1.0)
    return [TABLE, ball(r, fine, [0, 0, r])], "free"


def weeble(random: Random, fine: int) -> tuple[list[Part], str]:
    """A ball whose centre of mass is off its middle by at least .1 % of its radius."""
    r = random.uniform(0.3, 1.0)
    off = float(random.choice([-1, 1])) * r * 10 ** random.uniform(-3, -0.3)
    return [TABLE, ball(r, fine, [0, 0, r], [0, 0, off])], "balanced" if off > 0 else "free"


def ball_on_log(random: Random, fine: int) -> tuple[list[Part], str]:
    r, below = random.uniform(0.3, 1.0, size=2)
    log = solids.peg(below, sides=fine)
    return [held(log, LYING), ball(r, fine, [0, 0, r + below])], "balanced"


def ball_in_pipe(random: Random, fine: int) -> tuple[list[Part], str]:
    r = random.uniform(0.3, 1.0)
    inner = r * random.uniform(1.05, 2.5)
    pipe = solids.bore(inner, inner + 1, sides=fine)
    return [held(pipe, LYING), ball(r, fine, [0, 0, r - inner])], "free"


def crossed_pegs(random: Random, fine: int) -> tuple[list[Part], str]:
    r, below = random.uniform(0.3, 1.0, size=2)
    log = Part("b", solids.peg(r, sides=fine), Pose([0, 0, r + below], turn(Y, 90)))
    return [held(solids.peg(below, sides=fine), LYING), log], "balanced"


def lying_peg(random: Random, fine: int) -> tuple[list[Part], str]:
    r = random.uniform(0.3, 1.0)
    return [TABLE, Part("b", solids.peg(r, sides=fine), Pose([0, 0, r], LYING))], "free"


def ball_in_cone(random: Random, fine: int) -> tuple[list[Part], str]:
    half, r = random.uniform(0.4, 0.9), random.uniform(0.4, 0.6)
    cup = solids.cone_socket(half, low=0.05, sides=fine)
    return [held(cup), ball(r, fine, [0, 0, r / np.sin(half)])], "minimum"


def ball_on_three(random: Random, fine: int) -> tuple[list[Part], str]:
    r, below = random.uniform(0.5, 1.0, size=2)
    apart = below * random.uniform(1.05, 1.3)
    places = [apart * np.array([np.cos(a), np.sin(a), 0]) for a in np.arange(3) * 2 * np.pi / 3]
    feet = [
        Part(f"foot-{k}", solids.ball(below, fine, fine // 2), Pose(at), grounded=True)
        for k, at in enumerate(places)
    ]
    height = float(np.sqrt((r + below) ** 2 - apart**2))
    return [*feet, ball(r, fine, [0, 0, height])], "minimum"


KINDS: tuple[Callable[[Random, int], tuple[list[Part], str]], ...] = (
    ball_in_bowl,
    ball_on_ball,
    ball_on_table,
    weeble,
    ball_on_log,
    ball_in_pipe,
    crossed_pegs,
    lying_peg,
    ball_in_cone,
    ball_on_three,
)


def held(shape: Any, rotation: Any = (1, 0, 0, 0)) -> Part:
    return Part("a", shape, Pose([0, 0, 0], rotation), grounded=True)


def ball(r: float, fine: int, at: Any, center: Any = None) -> Part:
    return Part("b", solids.ball(r, fine, fine // 2), Pose(at), center_of_mass=center)


def as_mesh(part: Part) -> Part:
    """A part as a mesh without surfaces."""
    if isinstance(part.shape, Box):
        return part
    return replace(part, shape=solids.mesh_of(part.shape))


def random_pair(seed: int) -> Pair:
    """The assembly of a seed; the kinds alternate."""
    random = np.random.default_rng(seed)
    parts, state = KINDS[seed % len(KINDS)](random, 4 * int(random.integers(8, 25)))
    rotation, shift = random.normal(size=4), random.normal(size=3)
    both = (Assembly(parts), Assembly([as_mesh(one) for one in parts]))
    exact, meshes = (moved(one, rotation / np.linalg.norm(rotation), shift) for one in both)
    return Pair(exact, meshes, state)


def state_of(assembly: Assembly) -> str:
    verdict = kilter.check(assembly)
    return (
        verdict.verdict
        if verdict.second_order_answer is None
        else verdict.second_order_answer.state
    )
