"""Random assemblies in which some parts are pushed into overlap or out of contact.

A part is moved along the normal of a contact by 1.5 to 50 gap tolerances of the pair, so that a
narrow gap or a small overlap replaces the contact.
"""

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from random_friction import posts, random_assembly

from kilter.arrays import Array, Index
from kilter.assembly import Assembly, Part
from kilter.rigid import Pose
from kilter.scenes.arches import arch
from kilter.scenes.friction import a_block, h_block, trough, v_block
from kilter.scenes.pieces import block, floor
from kilter.scenes.wedges import keystone
from kilter.shape.primitives import Box

PUSHED_FAMILIES = ("stack", "bridge", "fence", "frame", "wedge", "arch", "ladder", "friction")
Touching = Callable[[Assembly], tuple[Index, Array, Array]]
PUSH = (1.5, 50.0)
"""Least and greatest displacement of a part [gap tolerance]."""


@dataclass(frozen=True, slots=True, eq=False)
class Pushed:
    """An assembly as intended and as drawn, with parts displaced.

    `moves` lists the displaced parts and their displacements [gap tolerance], positive out of
    contact.
    """

    family: str
    meant: Assembly
    drawn: Assembly
    moves: tuple[tuple[str, float], ...]


def pushed_assembly(seed: int, touching: Touching) -> Pushed:
    """Build a random assembly with one to three displaced parts.

    Parameters
    ----------
    seed : int
        The same seed gives the same assembly.
    touching : callable
        Function that returns the contacts of an assembly: parts, shape (n, 2), normals from the
        first to the second part, shape (n, 3), and gap tolerances, shape (n,).
    """
    random = np.random.default_rng(seed)
    family = PUSHED_FAMILIES[int(random.integers(len(PUSHED_FAMILIES)))]
    mu = float(random.uniform(0.05, 1.0)) * float(random.random() < 0.5)
    meant = dataclasses.replace(_build(family, random), friction=mu, friction_pairs=[])
    contacts = touching(meant)
    drawn = meant
    moves: list[tuple[str, float]] = []
    for _ in range(int(random.choice([1, 1, 1, 2, 3]))):
        drawn, name, tolerances = _pushed(drawn, contacts, random)
        moves.append((name, tolerances))
    return Pushed(family, meant, drawn, tuple(moves))


def _pushed(
    assembly: Assembly, contacts: tuple[Index, Array, Array], random: np.random.Generator
) -> tuple[Assembly, str, float]:
    """Displace a random free part along the normal of a contact in `contacts`.

    Returns the assembly, the name of the part and the displacement [gap tolerance].
    """
    parts, normals, gap = contacts
    free = ~assembly.geometry.grounded[parts]
    patch = int(random.choice(np.flatnonzero(free.any(axis=1))))
    side = int(random.choice(np.flatnonzero(free[patch])))
    tolerances = float(random.uniform(*PUSH)) * float(random.choice([-1.0, 1.0]))
    step = tolerances * float(gap[patch])
    sense = 1.0 if side else -1.0  # normals lead to the second part: positive is apart
    part = assembly.parts[int(parts[patch, side])]
    pose = Pose(part.pose.position + sense * step * normals[patch], part.pose.rotation)
    moved = dataclasses.replace(part, pose=pose)
    every = [moved if other is part else other for other in assembly.parts]
    return dataclasses.replace(assembly, parts=every), part.name, tolerances


def _build(family: str, random: np.random.Generator) -> Assembly:
    """Build a random assembly of a family, without friction and displacements."""
    angle = float(random.uniform(5.0, 24.0))
    planar = bool(random.random() < 0.3)
    if family == "stack":
        return _stack(random)
    if family == "bridge":
        return _bridge(random)
    if family == "fence":
        return _fence(random)
    if family == "frame":
        return _frame(random)
    if family == "arch":
        return arch(int(random.integers(2, 6)), ratio=float(random.uniform(0.1, 0.4)))
    if family == "ladder":
        return _ladder(random)
    if family == "friction":
        return random_assembly(int(random.integers(1 << 30)))[1]
    kinds = (
        lambda: h_block(planar=planar),
        lambda: a_block(angle, planar=planar),
        lambda: v_block(angle, planar=planar),
        lambda: keystone(angle, planar=planar),
        lambda: trough(angle, tilt=float(random.uniform(5, 60))),
    )
    return kinds[int(random.integers(len(kinds)))]()


def _stack(random: np.random.Generator) -> Assembly:
    """A stack of randomly shifted blocks, some beyond the tipping limit."""
    parts: list[Part] = [floor([-4, -4], [4, 4])]
    at, height = np.zeros(2), 0.0
    for k in range(int(random.integers(1, 5))):
        half, rise = random.uniform(0.3, 0.8, size=2), float(random.uniform(0.4, 1.5))
        at = at + random.uniform(-0.4, 0.4, size=2)
        low, high = [*(at - half), height], [*(at + half), height + rise]
        parts.append(block(f"block-{k}", low, high))
        height += rise
    return Assembly(parts)


def _bridge(random: np.random.Generator) -> Assembly:
    """A beam on two or three posts, with a wall at its end in half of the cases."""
    xs = np.cumsum(random.uniform(0.6, 1.5, size=int(random.integers(2, 4))))
    parts: list[Part] = [floor([-2, -2], [6, 2])]
    for k, x in enumerate(xs):
        parts.append(block(f"post-{k}", [x - 0.2, -0.3, 0], [x + 0.2, 0.3, 1.0]))
    start, end = xs[0] - random.uniform(0, 0.5), xs[-1] + random.uniform(-0.5, 1.0)
    parts.append(block("beam", [start, -0.3, 1.0], [end, 0.3, 1.3]))
    if random.random() < 0.5 and end >= xs[-1] + 0.2:  # not through the last post
        parts.append(block("wall", [end, -0.5, 0], [end + 0.5, 0.5, 2.0], grounded=True))
    if random.random() < 0.5:
        x = float(random.uniform(start, end))
        parts.append(block("load", [x - 0.2, -0.2, 1.3], [x + 0.2, 0.2, 1.6]))
    return Assembly(parts)


def _fence(random: np.random.Generator) -> Assembly:
    """Posts side by side on a slope, against a wall in half of the cases."""
    parts, x = posts(random)
    if random.random() < 0.5:
        parts.append(block("wall", [x, -1, 0], [x + 1, 1, 2], grounded=True))
    lean = np.radians(float(random.uniform(-20, 20)))
    return Assembly(parts).with_down([np.sin(lean), 0, -np.cos(lean)])


def _ladder(random: np.random.Generator) -> Assembly:
    """A plank that leans on a wall with an edge, and stands on an edge."""
    lean, length = np.radians(float(random.uniform(20, 70))), float(random.uniform(1.0, 3.0))
    along = np.array([np.cos(lean), 0.0, np.sin(lean)])
    across = np.array([np.sin(lean), 0.0, -np.cos(lean)])
    thick = float(random.uniform(0.05, 0.3))
    # the lowest corner of the plank is at the origin, the wall at its farthest corner
    middle = (length * along - thick * across) / 2
    half = lean / 2
    turned = Pose(middle, [np.cos(half), 0.0, -np.sin(half), 0.0])
    wall = float(length * along[0])
    return Assembly(
        [
            floor([-4, -4], [wall, 4]),
            block("wall", [wall, -4, -1], [wall + 1, 4, 5], grounded=True),
            Part("plank", Box([length, 0.5, thick]), turned),
        ]
    )


def _frame(random: np.random.Generator) -> Assembly:
    """Two blocks in a held corner, with gravity in a random direction."""
    corner = [
        block("x", [-1, -1, -1], [0, 3, 3], grounded=True),
        block("y", [0, -1, -1], [3, 0, 3], grounded=True),
        block("z", [0, 0, -1], [3, 3, 0], grounded=True),
    ]
    size = random.uniform(0.5, 1.0, size=3)
    first = block("first", [0, 0, 0], size.tolist())
    axis = int(random.integers(3))
    low = np.zeros(3)
    low[axis] = size[axis]
    high = low + random.uniform(0.5, 1.0, size=3)
    second = block("second", low.tolist(), high.tolist())
    down = random.normal(size=3) - 0.7
    return Assembly([*corner, first, second]).with_down(down)
