"""Random assemblies of boxes, cans, logs and balls at rest, like those of users.

Parts are real shapes, and kilter detects their contacts: stacks, planks on supports, parts in
grooves, on balls, beside walls and over edges. Then the whole is turned, moved and scaled.
"""

from collections.abc import Callable

import numpy as np
from transformations import scaled

from kilter import Assembly, Box, Cylinder, Part, Pose, Sphere
from kilter.arrays import Array
from kilter.scenes.pieces import moved

Random = np.random.Generator
Made = list[Part]

FLOOR = Part("floor", Box([40, 40, 1]), Pose([0, 0, -0.5]), grounded=True)


def about(axis: int, angle: float) -> Array:
    """The quaternion of a turn about a coordinate axis [rad]."""
    turn = np.zeros(4)
    turn[0], turn[1 + axis] = np.cos(angle / 2), np.sin(angle / 2)
    return turn


def times(p: Array, q: Array) -> Array:
    """The quaternion of two turns; the second is applied first."""
    return np.append(
        p[0] * q[0] - p[1:] @ q[1:], p[0] * q[1:] + q[0] * p[1:] + np.cross(p[1:], q[1:])
    )


def lying(yaw: float) -> Array:
    """A cylinder's axis across gravity, at an angle to y."""
    return times(about(2, yaw), about(0, np.pi / 2))


def stack(random: Random, at: Array, z: float = 0.0, levels: int = 3) -> Made:
    """A stack: on the axis above a ball or a log, otherwise a little aside."""
    parts: Made = []
    where, flat = at.copy(), True
    for level in range(int(random.integers(1, levels + 1))):
        kind = random.choice(["box", "can", "ball", "log"])
        where = where + (random.uniform(-0.15, 0.15, 2) if flat else 0.0)
        name, height, turn = (
            f"{kind} {level}",
            random.uniform(0.3, 1.0),
            about(2, random.uniform(0, 3)),
        )
        shape: Box | Cylinder | Sphere = Box([2, 2, height])
        if kind == "can":
            shape = Cylinder(random.uniform(0.8, 1.0), height)
        elif kind == "ball":
            shape, height = Sphere(height / 2), height
        elif kind == "log":
            shape, turn = (
                Cylinder(height / 2, random.uniform(1.0, 2.0)),
                lying(random.uniform(0, 3)),
            )
        parts.append(Part(name, shape, Pose([*where, z + height / 2], turn)))
        z, flat = z + height, kind in ("box", "can")
    return parts


def stacks(random: Random) -> Made:
    parts = [FLOOR]
    for k in range(int(random.integers(1, 3))):
        own = stack(random, np.array([6.0 * k, 0.0]))
        parts += [Part(f"{one.name} of {k}", one.shape, one.pose) for one in own]
    return parts


def plank(random: Random) -> Made:
    """A box on two supports, held or free, with its centre between them or over a support."""
    gap, r = random.uniform(1.0, 2.0), random.uniform(0.3, 0.6)
    parts = [FLOOR]
    for name, side in (("left", -1), ("right", 1)):
        kind = random.choice(["ball", "log", "can", "box"])
        shape, turn = {
            "ball": (Sphere(r), about(2, 0)),
            "log": (Cylinder(r, random.uniform(0.5, 1.5)), lying(0)),
            "can": (Cylinder(0.4, 2 * r), about(2, 0)),
            "box": (Box([0.6, 0.8, 2 * r]), about(2, 0)),
        }[str(kind)]
        held = bool(random.integers(2))
        parts.append(Part(f"{name} {kind}", shape, Pose([side * gap, 0, r], turn), grounded=held))
    shift = random.uniform(-0.5, 0.5) * gap
    height = random.uniform(0.2, 0.6)
    box = Box([2 * gap + 2 + 2 * abs(shift), random.uniform(0.5, 1.5), height])
    return [*parts, Part("plank", box, Pose([shift, 0, 2 * r + height / 2]))]


def groove(random: Random) -> Made:
    """One or two round parts in a groove of two slopes."""
    slope = random.uniform(0.3, 1.2)
    parts: Made = []
    for name, sign in (("left", 1), ("right", -1)):
        normal = np.array([sign * np.sin(slope), 0, np.cos(slope)])
        along = np.array([-sign * np.cos(slope), 0, np.sin(slope)])
        wall = Pose(1.5 * along - 0.5 * normal, about(1, sign * slope))
        parts.append(Part(name, Box([3, 8, 1]), wall, grounded=True))
    r = random.uniform(0.3, 0.7)
    for k in range(int(random.integers(1, 3))):
        place = Pose([0, 2 * r * k, r / np.cos(slope)], lying(0))
        shape = Sphere(r) if random.integers(2) else Cylinder(r, 2 * r)
        parts.append(Part(f"in the groove {k}", shape, place))
    return parts


def on_balls(random: Random) -> Made:
    """A ball, or a box, on three balls."""
    R, r = 0.5, random.uniform(0.3, 0.8)
    angles = np.cumsum(random.uniform(1.7, 2.4, 3))
    ring = random.uniform(0.6, 0.95) * (R + r)
    held = bool(random.integers(2))
    parts = [FLOOR]
    for k, angle in enumerate(angles):
        at = [ring * np.cos(angle), ring * np.sin(angle), R]
        parts.append(Part(f"ball {k}", Sphere(R), Pose(at), grounded=held or None is None))
    if random.integers(2):
        height = R + np.sqrt((R + r) ** 2 - ring**2)
        return [*parts, Part("top", Sphere(r), Pose([0, 0, height]))]
    parts = [Part(one.name, one.shape, one.pose, grounded=held or one is FLOOR) for one in parts]
    return [*parts, Part("top", Box([4, 4, 0.4]), Pose([0, 0, 2 * R + 0.2], about(2, 1.0)))]


def beside(random: Random) -> Made:
    """Parts on a floor that touch a wall, a corner or each other."""
    parts = [FLOOR, Part("wall", Box([1, 20, 4]), Pose([-0.5, 0, 2]), grounded=True)]
    if random.integers(2):
        parts.append(Part("other wall", Box([20, 1, 4]), Pose([0, -0.5, 2]), grounded=True))
    x = 0.0
    for k in range(int(random.integers(1, 4))):
        r = random.uniform(0.3, 0.8)
        kind = random.choice(["ball", "can", "box", "log"])
        shape: Box | Cylinder | Sphere = Sphere(r)
        turn = about(2, 0)
        if kind == "can":
            shape = Cylinder(r, 2 * r)
        elif kind == "box":
            shape = Box([2 * r] * 3)
        elif kind == "log":
            shape, turn = Cylinder(r, 2 * r), lying(0)
        parts.append(Part(f"{kind} {k}", shape, Pose([x + r, r, r], turn)))
        x += 2 * r
        if kind == "ball" and k:
            break
    return parts


def rolls(random: Random) -> Made:
    """A ball, a log or a box on a log or a ball, which is held or not."""
    R, r = random.uniform(0.4, 1.0), random.uniform(0.2, 1.0)
    held = bool(random.integers(2))
    low: Cylinder | Sphere = Cylinder(R, 3.0) if random.integers(2) else Sphere(R)
    shape, turn = [
        (Sphere(r), about(2, 0)),
        (Cylinder(r, random.uniform(0.5, 4.0)), lying(random.choice([0.0, 0.7, np.pi / 2]))),
        (Box([1.5, 1.0, 2 * r]), about(2, random.choice([0.0, 0.4]))),
    ][int(random.integers(3))]
    parts = [FLOOR, Part("low", low, Pose([0, 0, R], lying(0)), grounded=held)]
    return [*parts, Part("high", shape, Pose([0, 0, 2 * R + r], turn))]


def edge(random: Random) -> Made:
    """A box over the edge of a table with its centre above it, stopped or not."""
    height, rise = random.uniform(0.5, 1.5), random.uniform(-0.3, 0.3)
    table = Part("table", Box([4, 4, 1]), Pose([-2, 0, -0.5]), grounded=True)
    box = Part("box", Box([2, 1, height]), Pose([0, 0, height / 2]), mass=1.0,
               center_of_mass=[0, 0, rise * height])  # fmt: skip
    stop = random.uniform(0.05, height)
    wall = Part("stop", Box([1, 3, 2]), Pose([1.5, 0, stop - 1]), grounded=True)
    return [table, box, *([wall] if random.integers(2) else [])]


KINDS: tuple[Callable[[Random], Made], ...] = (
    stacks, plank, groove, on_balls, beside, rolls, edge,
)  # fmt: skip


def random_rest(seed: int) -> tuple[str, Assembly]:
    """The kind and the assembly of a seed, with random units and pose."""
    random = np.random.default_rng(seed)
    make = KINDS[seed % len(KINDS)]
    assembly = Assembly(make(random))
    turn = random.normal(size=4)
    there = moved(assembly, turn / np.linalg.norm(turn), random.uniform(-50, 50, 3))
    return make.__name__, scaled(there, 10 ** random.uniform(-2, 2))
