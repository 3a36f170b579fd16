"""Random assemblies near the limits of friction: stacks, arches, ladders, fences."""

import dataclasses

import numpy as np
from transformations import tilted

from kilter.assembly import Assembly, Part
from kilter.scenes.arches import arch
from kilter.scenes.friction import a_block, bracket, h_block, ladder, trough, v_block
from kilter.scenes.pieces import block, floor
from kilter.scenes.wedges import keystone

FAMILIES = ("stack", "keystone", "arch", "ladder", "fence", "squeezed", "trough", "bracket")


def posts(random: np.random.Generator) -> tuple[list[Part], float]:
    """A floor with two to four random posts side by side along x, and the end of the last in x."""
    parts: list[Part] = [floor([-4, -4], [8, 4])]
    x = 0.0
    for k in range(int(random.integers(2, 5))):
        width, rise = float(random.uniform(0.2, 0.8)), float(random.uniform(0.5, 2.0))
        parts.append(block(f"post-{k}", [x, -0.5, 0], [x + width, 0.5, rise]))
        x += width
    return parts, x


def random_assembly(seed: int) -> tuple[str, Assembly]:
    """A random family and an assembly of it; about half of the assemblies are near a limit.

    Parameters
    ----------
    seed : int
        The same seed gives the same assembly.
    """
    random = np.random.default_rng(seed)
    family = FAMILIES[int(random.integers(len(FAMILIES)))]
    mu = float(random.uniform(0.05, 1.0))
    planar = bool(random.random() < 0.6)
    angle = float(random.uniform(5.0, 24.0))
    if family == "stack":
        return family, _stack(random, mu, planar)
    if family == "keystone":
        made = keystone(angle, friction=mu, planar=planar)
        return family, tilted(made, [0, 1, 0], float(random.uniform(-20, 20)))
    if family == "arch":
        count = int(random.integers(3, 8))
        return family, arch(count, ratio=float(random.uniform(0.1, 0.4)), friction=mu)
    if family == "ladder":
        wall = float(random.uniform(0, 0.5)) * float(random.random() < 0.5)
        lean = float(random.uniform(30, 75))
        return family, ladder(lean, friction_floor=mu, friction_wall=wall, planar=planar)
    if family == "fence":
        return family, _fence(random, mu, planar)
    if family == "squeezed":
        kinds = (
            lambda: h_block(friction=mu, planar=planar),
            lambda: a_block(angle, friction=mu, planar=planar),
            lambda: v_block(angle, friction=mu, planar=planar),
        )
        return family, kinds[int(random.integers(3))]()
    if family == "trough":
        return family, trough(angle, tilt=float(random.uniform(5, 60)), friction=mu)
    return family, bracket(float(random.uniform(0.3, 2.0)), friction=mu, pad=0.01)


def _stack(random: np.random.Generator, mu: float, planar: bool) -> Assembly:
    """A tilted stack of randomly shifted blocks."""
    parts: list[Part] = [floor([-4, -4], [4, 4])]
    x, height = 0.0, 0.0
    for k in range(int(random.integers(1, 5))):
        width, rise = (float(value) for value in random.uniform(0.5, 1.5, size=2))
        x += float(random.uniform(-0.2, 0.2))
        low, high = [x - width / 2, -0.5, height], [x + width / 2, 0.5, height + rise]
        parts.append(block(f"block-{k}", low, high))
        height += rise
    made = tilted(Assembly(parts, friction=mu), [0, 1, 0], float(random.uniform(-25, 25)))
    return dataclasses.replace(made, planar=planar)


def _fence(random: np.random.Generator, mu: float, planar: bool) -> Assembly:
    """Touching posts side by side on a tilted floor."""
    parts, _ = posts(random)
    made = tilted(Assembly(parts, friction=mu), [0, 1, 0], float(random.uniform(-25, 25)))
    return dataclasses.replace(made, planar=planar)
