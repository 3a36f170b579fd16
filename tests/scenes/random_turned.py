"""Random assemblies with friction for tests of regions: arches, piles, wedges, rounds.

Sizes, angles and coefficients are irregular, so that no limit lies on an axis.
"""

from collections.abc import Callable
from itertools import combinations

import numpy as np

from kilter.arrays import Array
from kilter.assembly import Assembly, FrictionPair, Part
from kilter.rigid import Pose
from kilter.scenes.friction import a_block, bracket, h_block, trough, v_block
from kilter.scenes.pieces import block, floor, prism, turn
from kilter.scenes.wedges import corner_wedges, keystone
from kilter.shape.primitives import Cylinder, Sphere

Random = np.random.Generator


def random_turned(family: str, seed: int) -> Assembly:
    """Build a random assembly of a family of `TURNED`; equal seeds give equal assemblies.

    Examples
    --------
    >>> random_turned("arch", 3).names == random_turned("arch", 3).names
    True
    """
    return TURNED[family](np.random.default_rng([seed, sorted(TURNED).index(family)]))


def springer_arch(
    count: int, thickness: float, *, depth: float = 0.3, friction: float = 0.7, planar: bool = False
) -> Assembly:
    """A semicircular arch of radius 1 m with wedge-shaped voussoirs on two held springers.

    Parameters
    ----------
    count : int
        Number of voussoirs.
    thickness, depth : float
        Size across the circle, and along y [m].
    friction : float
        Friction coefficient [-].
    planar : bool
        Motions in the x-z plane only.
    """
    angles = np.pi - np.pi * np.arange(count + 1) / count
    spoke = np.column_stack([np.cos(angles), np.sin(angles)])
    inner, outer = 1 - thickness / 2, 1 + thickness / 2
    parts = [
        prism(
            f"v{k}",
            [inner * spoke[k], inner * spoke[k + 1], outer * spoke[k + 1], outer * spoke[k]],
            depth,
        )
        for k in range(count)
    ]
    for name, side in (("left", -1.0), ("right", 1.0)):
        low, high = sorted([side * inner, side * outer])
        foot = [[low, -0.2], [high, -0.2], [high, 0.0], [low, 0.0]]
        parts.append(prism(name, foot, depth, grounded=True))
    return Assembly(parts, friction=friction, planar=planar)


def _arch(random: Random) -> Assembly:
    """An arch of 3 to 20 voussoirs, thickness 0.05 to 0.35 of the radius, friction 0.2 to 1.2."""
    return springer_arch(
        int(random.integers(3, 21)),
        float(random.uniform(0.05, 0.35)),
        friction=float(random.uniform(0.2, 1.2)),
        planar=bool(random.random() < 1 / 3),
    )


def _leaning(random: Random, degrees: float) -> Array:
    """A random unit direction of gravity within an angle of -z [deg]."""
    angle, way = np.radians(random.uniform(0, degrees)), random.uniform(0, 2 * np.pi)
    return np.array([np.sin(angle) * np.cos(way), np.sin(angle) * np.sin(way), -np.cos(angle)])


def _pairs(random: Random, names: list[str]) -> list[FrictionPair]:
    """Random friction coefficients for half of the pairs, in a third of the assemblies."""
    if random.random() > 1 / 3:
        return []
    chosen = [pair for pair in combinations(names, 2) if random.random() < 0.5]
    return [FrictionPair(pair, float(random.uniform(0.1, 1.2))) for pair in chosen]


def _pile(random: Random) -> Assembly:
    """1 to 8 boxes on a floor, each lowered onto the highest box below it."""
    boxes: list[tuple[Array, Array]] = []
    scatter = float(random.uniform(0.05, 0.8))
    for _ in range(int(random.integers(1, 9))):
        size = random.uniform(0.6, 1.6, size=3)
        middle = random.uniform(-scatter, scatter, size=2)
        low, high = middle - size[:2] / 2, middle + size[:2] / 2
        below = [b for a, b in boxes if (a[:2] < high).all() and (b[:2] > low).all()]
        base = max((float(top[2]) for top in below), default=0.0)
        boxes.append((np.array([*low, base]), np.array([*high, base + size[2]])))
    names = [f"box-{k}" for k in range(len(boxes))]
    parts = [floor([-4, -4], [4, 4])]
    for name, (low, high) in zip(names, boxes, strict=True):
        parts.append(block(name, low, high, density=float(random.uniform(500, 3000))))
    made = Assembly(
        parts,
        friction=float(random.uniform(0.1, 1.2)),
        friction_pairs=_pairs(random, ["floor", *names]),
    )
    return made.with_down(_leaning(random, 12.0))


def _wedge(random: Random) -> Assembly:
    """A wedge, block or prism between held plates, in a corner or in a trough."""
    mu, angle = float(random.uniform(0.1, 1.2)), float(random.uniform(5.0, 24.0))
    planar = bool(random.random() < 0.3)
    makers: list[Callable[[], Assembly]] = [
        lambda: trough(angle, tilt=float(random.uniform(0, 40)), friction=mu),
        lambda: keystone(angle, friction=mu, planar=planar),
        lambda: v_block(angle, friction=mu, planar=planar),
        lambda: a_block(angle, friction=mu, planar=planar),
        lambda: h_block(friction=mu, planar=planar),
        lambda: bracket(float(random.uniform(0.3, 2.0)), friction=mu),
        lambda: corner_wedges(int(random.integers(2, 8)), seed=int(random.integers(1000))),
    ]
    made = makers[int(random.integers(len(makers)))]()
    made = made.with_friction(mu)
    return made if made.planar else made.with_down(_leaning(random, 12.0))


def _rounds(random: Random) -> Assembly:
    """Cylinders or spheres on a floor or between walls."""
    makers = (_cylinders, _spheres, _between_walls)
    parts = makers[int(random.integers(len(makers)))](random)
    free = [part.name for part in parts if not part.grounded]
    made = Assembly(
        parts,
        friction=float(random.uniform(0.1, 1.2)),
        friction_pairs=_pairs(random, ["floor", *free]),
    )
    return made.with_down(_leaning(random, 8.0))


def _cylinders(random: Random) -> list[Part]:
    """A floor and two cylinders along y, with or without a gap, and mostly a third on top."""
    lying = turn([1, 0, 0], 90)
    left, right, top = (float(radius) for radius in random.uniform(0.6, 1.4, size=3))
    apart = 2 * np.sqrt(left * right) * (1.0 if random.random() < 0.5 else 1.2)
    middles = [(0.0, left), (apart, right)]
    radii = [left, right]
    if random.random() < 0.8:
        way = np.array(middles[1]) - np.array(middles[0])
        reach, a, b = float(np.linalg.norm(way)), left + top, right + top
        along = (a * a - b * b + reach * reach) / (2 * reach)
        up = np.array([-way[1], way[0]]) / reach
        place = along * way / reach + np.sqrt(a * a - along * along) * up
        middles.append((float(place[0]), left + float(place[1])))
        radii.append(top)
    parts = [floor([-8, -8], [8, 8])]
    for k, ((x, z), radius) in enumerate(zip(middles, radii, strict=True)):
        length = float(random.uniform(1.5, 3.0))
        parts.append(Part(f"cylinder-{k}", Cylinder(radius, length), Pose([x, 0, z], lying)))
    return parts


def _spheres(random: Random) -> list[Part]:
    """A floor, three equal spheres in a triangle, and a fourth sphere on top."""
    radius, top = (float(value) for value in random.uniform(0.7, 1.3, size=2))
    side = 2 * radius * float(1.0 if random.random() < 0.5 else random.uniform(1.0, 1.15))
    angles = np.radians([90, 210, 330]) + random.uniform(0, 2)
    centers = [side / np.sqrt(3) * np.array([np.cos(a), np.sin(a), 0.0]) for a in angles]
    rise = np.sqrt((radius + top) ** 2 - side**2 / 3)
    parts = [floor([-8, -8], [8, 8])]
    for k, center in enumerate(centers):
        parts.append(Part(f"sphere-{k}", Sphere(radius), Pose(center + np.array([0, 0, radius]))))
    return [*parts, Part("sphere-3", Sphere(top), Pose([0, 0, radius + rise]))]


def _between_walls(random: Random) -> list[Part]:
    """A sphere or a cylinder on a floor, against one or two walls."""
    radius = float(random.uniform(0.6, 1.4))
    parts = [
        floor([-8, -8], [8, 8]),
        block("wall-x", [-radius - 1, -4, 0], [-radius, 4, 4], grounded=True),
    ]
    if random.random() < 0.5:
        parts.append(block("wall-y", [-radius, radius, 0], [4, radius + 1, 4], grounded=True))
        return [*parts, Part("sphere", Sphere(radius), Pose([0, 0, radius]))]
    if random.random() < 0.5:
        parts.append(block("other", [radius, -4, 0], [radius + 1, 4, 4], grounded=True))
    lying = Pose([0, 0, radius], turn([1, 0, 0], 90))
    return [*parts, Part("cylinder", Cylinder(radius, 2.0), lying)]


TURNED: dict[str, Callable[[Random], Assembly]] = {
    "arch": _arch,
    "pile": _pile,
    "wedge": _wedge,
    "round": _rounds,
}
"""Functions that build an assembly, by family."""
