"""Lashings at random, and the least share of their capacity by a linear program."""

import itertools
import math

import numpy as np
from scipy.optimize import linprog

import kilter
from kilter.assembly.strap_wrenches import strap_wrenches
from kilter.scenes.pieces import block

DEPTH = 1.0
"""Depth of all boxes along y."""


def over(width: float, height: float, angle: float, tension: float, **more: object) -> kilter.Strap:
    """A strap over the top of a load from -width / 2 to width / 2, at an angle to the deck.

    It runs over every box whose top edge is named "left" and "right" in `more`.
    """
    left, right = str(more.pop("left", "box-0")), str(more.pop("right", "box-0"))
    run = height / np.tan(np.radians(angle))
    path = [
        ("ground", [-width / 2 - run, 0, 0]),
        (left, [-width / 2, 0, height]),
        (right, [width / 2, 0, height]),
        ("ground", [width / 2 + run, 0, 0]),
    ]
    return kilter.Strap(path, tension, **more)  # type: ignore[arg-type]


def lashed(
    boxes: list[tuple[list[float], list[float]]],
    mass: float,
    strap: kilter.Strap,
    friction: float,
    pairs: float | None = None,
) -> kilter.Assembly:
    """Boxes, each from a low to a high corner in x and z, with a strap; `pairs`: their own mu."""
    parts = [block("deck", [-9, -9, -1], [9, 9, 0], grounded=True)]
    for k, (low, high) in enumerate(boxes):
        corners = [low[0], -DEPTH / 2, low[1]], [high[0], DEPTH / 2, high[1]]
        parts.append(block(f"box-{k}", *corners, mass=mass))
    names = [part.name for part in parts[1:]]
    own = [] if pairs is None else [
        kilter.FrictionPair(pair, pairs) for pair in itertools.pairwise(names)
    ]  # fmt: skip
    return kilter.Assembly(parts, friction=friction, friction_pairs=own, straps=[strap])


def random_lashing(seed: int) -> kilter.Assembly:
    """Two to four boxes in a row or a stack, with one to three straps of random paths and forces.

    Gravity is inclined at random, as if the carrier accelerated.
    """
    rng = np.random.default_rng([3838, seed])
    count, tall = int(rng.integers(2, 5)), bool(rng.random() < 0.5)
    sizes = rng.uniform([0.4, 0.4, 0.4], [1.2, 1.2, 1.2], (count, 3))
    width = sizes[:, 0] if not tall else np.full(count, sizes[0, 0])
    parts = [block("deck", [-9, -9, -1], [9, 9, 0], grounded=True)]
    across, up, edges = 0.0, 0.0, []
    for k, (size, wide) in enumerate(zip(sizes, width, strict=True)):
        low = np.array([0.0 if tall else across, -size[1] / 2, up if tall else 0.0])
        high = low + np.array([wide, size[1], size[2]])
        mass = float(rng.uniform(50, 800))
        parts.append(block(f"box-{k}", low, high, mass=mass))
        edges.append((low, high))
        across, up = across + wide, up + size[2]
    straps = []
    for _ in range(int(rng.integers(1, 4))):
        k = count - 1 if tall else int(rng.integers(count))
        low, high = edges[k]
        y = float(rng.uniform(low[1], high[1]))
        reach = rng.uniform(1.2, 3.0, 2)
        # along y a strap is clear of the other boxes of a row
        if tall:
            lean = float(rng.uniform(-0.5, 0.5))
            path = [("ground", [low[0] - reach[0], y + lean, 0.0]),
                    (f"box-{k}", [low[0], y, high[2]]), (f"box-{k}", [high[0], y, high[2]]),
                    ("ground", [high[0] + reach[1], y + lean, 0.0])]  # fmt: skip
        else:
            x = float(rng.uniform(low[0], high[0]))
            path = [("ground", [x, low[1] - reach[0], 0.0]),
                    (f"box-{k}", [x, low[1], high[2]]), (f"box-{k}", [x, high[1], high[2]]),
                    ("ground", [x, high[1] + reach[1], 0.0])]  # fmt: skip
        mu = float(rng.choice([0.0, 0.15, 0.3]))
        end = str(rng.choice(["first", "last"]))
        tension = float(10 ** rng.uniform(2.0, 4.0))
        straps.append(kilter.Strap(path, tension, mu=mu, tensioned=end))  # type: ignore[arg-type]
    tilt, turn = rng.uniform(0.3, 0.8), rng.uniform(0, 2 * np.pi)
    gravity = 9.81 * np.array([tilt * np.cos(turn), tilt * np.sin(turn), -1.0])
    return kilter.Assembly(
        parts, friction=float(rng.uniform(0.2, 0.7)), gravity=gravity, straps=straps
    )


def direct(angle: float, capacity: float, *, braking: float = 0.6) -> kilter.Assembly:
    """A box .8 x 2, mu .3, with a strap of known capacity from its upper corner to the deck.

    `braking` [g] inclines the gravity that the box feels away from the strap.
    """
    wide, high = 0.8, 2.0
    run = high / np.tan(np.radians(angle))
    strap = kilter.Strap(
        [("ground", [wide / 2 + run, 0, 0]), ("box-0", [wide / 2, 0, high])], capacity=capacity
    )
    load = lashed([([-wide / 2, 0], [wide / 2, high])], 1000, strap, 0.3)
    return kilter.Assembly(
        load.parts, friction=0.3, straps=[strap], gravity=[-9.81 * braking, 0, -9.81]
    )


def random_direct(seed: int, *, loops: bool = False) -> kilter.Assembly:
    """Two to four boxes with two to eight straps of known capacity, and perhaps a tensioned strap.

    The straps run from upper corners to the deck. With `loops`, half of them run on along an upper
    edge to another box or to the next corner, and back to the deck. Straps that pass through a box
    are left out.
    """
    rng = np.random.default_rng([383838, seed])
    base = random_lashing(seed)
    names = [part.name for part in base.parts if not part.grounded]
    low, high = base.geometry.part_boxes
    straps = [strap for strap in base.straps if rng.random() < 0.3]
    for _ in range(int(rng.integers(2, 9))):
        name = str(rng.choice(names))
        k = base.index_of(name)
        sign = rng.choice([-1.0, 1.0], 2)
        corner = np.where(sign > 0, high[k, :2], low[k, :2])
        # the deck point lies outside the load, so that the strap passes through no part
        out = np.where(sign > 0, high[1:, :2].max(axis=0), low[1:, :2].min(axis=0))
        foot = [*(out + sign * rng.uniform(0.2, 2.0, 2)), 0.0]
        capacity = float(10 ** rng.uniform(2.0, 4.5))
        path = [("ground", foot), (name, [*corner, high[k, 2]])]
        if loops and rng.random() < 0.5:
            other = str(rng.choice(names))
            j = base.index_of(other)
            far = np.where(sign[1] > 0, low[j, 1], high[j, 1])
            x = np.where(sign[0] > 0, high[j, 0], low[j, 0])
            end = np.where(sign[1] > 0, low[1:, 1].min(), high[1:, 1].max())
            foot = [float(foot[0]), float(end - sign[1] * rng.uniform(0.2, 2.0)), 0.0]
            path += [(other, [x, far, high[j, 2]]), ("ground", foot)]
        strap = kilter.Strap(path, capacity=capacity)
        try:
            strap_wrenches(kilter.Assembly(base.parts, straps=[strap]))
        except kilter.InputError:  # another box is in its way
            continue
        straps.append(strap)
    return kilter.Assembly(base.parts, friction=base.friction, gravity=base.gravity, straps=straps)


def strap_forces(strap: kilter.Strap) -> list[tuple[str, np.ndarray, np.ndarray]]:
    """Part, point and force at each point of a strap, by a walk from the tensioned end."""
    entries = [(name, np.asarray(point, float)) for name, point in strap.to_dict()["path"]]
    walk = entries[::-1] if strap.tensioned == "last" else entries
    pull, before, result = strap.tension, None, []
    for k, (name, point) in enumerate(walk):
        after = walk[k + 1][1] - point if k + 1 < len(walk) else None
        force = np.zeros(3)
        if before is not None:
            force = pull * (before - point) / math.dist(before, point)
        if before is not None and after is not None:
            cosine = (point - before) @ after / math.dist(before, point) / np.linalg.norm(after)
            pull *= math.exp(-strap.mu * math.acos(min(max(cosine, -1.0), 1.0)))
        if after is not None:
            force = force + pull * after / np.linalg.norm(after)
        result.append((name, point, force))
        before = point
    return result


def unit_pull(strap: kilter.Strap) -> list[tuple[str, np.ndarray, np.ndarray]]:
    """Part, point and force at the ends of each piece of a strap that pulls with 1 N."""
    path = [(name, np.asarray(p, float)) for name, p in strap.to_dict()["path"]]
    forces = []
    for (first, a), (last, b) in itertools.pairwise(path):
        along = (b - a) / math.dist(a, b)
        forces += [(first, a, along), (last, b, -along)]
    return forces


def least_share(assembly: kilter.Assembly, *, around: bool, sides: int = 48) -> float:
    """Least factor of all tensions and capacities at which forces balance; infinite for none."""
    touching = kilter.contacts(assembly)
    names = [part.name for part in assembly if not part.grounded]
    place = {name: 6 * k for k, name in enumerate(names)}
    centers = dict(zip(assembly.names, assembly.geometry.center, strict=True))
    masses = dict(zip(assembly.names, assembly.geometry.mass, strict=True))
    columns: list[np.ndarray] = []

    def column(forces: list[tuple[str, np.ndarray, np.ndarray]]) -> np.ndarray:
        """Forces and torques of some point forces on all free parts."""
        entry = np.zeros(6 * len(names))
        for name, point, force in forces:
            if name in place:
                at = place[name]
                entry[at : at + 3] += force
                entry[at + 3 : at + 6] += np.cross(point - centers[name], force)
        return entry

    angle = 2 * np.pi * np.arange(sides) / sides
    for k in range(len(touching.points)):
        patch = touching.point_patch[k]
        a, b = (assembly.names[i] for i in touching.patch_parts[patch])
        normal, mu = touching.normals[k], touching.patch_mu[patch]
        size = mu / math.cos(math.pi / sides) if around else mu
        first = np.cross(normal, np.eye(3)[np.abs(normal).argmin()])
        first /= np.linalg.norm(first)
        second = np.cross(normal, first)
        for t in angle:
            force = normal + size * (math.cos(t) * first + math.sin(t) * second)
            point = touching.points[k]
            columns.append(column([(b, point, force), (a, point, -force)]))
    tensioned = [strap for strap in assembly.straps if strap.tension is not None]
    direct = [strap for strap in assembly.straps if strap.tension is None]
    straps = sum((column(strap_forces(strap)) for strap in tensioned), np.zeros(6 * len(names)))
    weight = column([(name, centers[name], masses[name] * assembly.gravity) for name in names])
    unit = np.abs(weight).max()
    pulls = [column(unit_pull(strap)) for strap in direct]
    # s is in units of `scale`: all forces are then over the weight
    scale = unit / max([*np.abs(straps), *(strap.capacity for strap in direct)])
    matrix = np.column_stack([*columns, *pulls, straps * scale / unit])
    limits = np.zeros((len(pulls), matrix.shape[1]))  # each pull is at most s LC
    limits[:, len(columns) : -1] = np.eye(len(pulls))
    limits[:, -1] = [-strap.capacity * scale / unit for strap in direct]
    cost = np.zeros(matrix.shape[1])
    cost[-1] = 1.0
    answer = linprog(cost, limits, np.zeros(len(pulls)), matrix, -weight / unit, method="highs")
    return float(answer.fun * scale) if answer.status == 0 else math.inf
