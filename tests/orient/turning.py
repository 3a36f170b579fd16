"""Scenes and directions that the tests of orientations share."""

from collections.abc import Callable

import numpy as np
from transformations import scaled

from kilter.assembly import Assembly
from kilter.contact import detect
from kilter.mechanics.program import Program, build_program
from kilter.scenes import SCENES, arches, paper, scene, stacks, walls, wedges
from kilter.scenes.pieces import block, moved, turn

OBLIQUE = turn([1.0, 2.0, -0.5], 37.0)


def slot_and_float(planar: bool) -> Assembly:
    """A block that slides between two plates along x, and one that floats."""
    parts = [
        block("plate-low", [-2, -1, -1], [2, 1, 0], grounded=True),
        block("plate-high", [-2, -1, 1], [2, 1, 2], grounded=True),
        block("slider", [-0.5, -0.5, 0], [0.5, 0.5, 1]),
        block("floater", [5, 0, 5], [7, 1, 6]),
    ]
    return Assembly(parts, planar=planar)


def pile_on_short_base() -> Assembly:
    """Boxes half over the edge of their base, with one that leans on nothing."""
    parts = [block("base", [0, 0, -1], [1, 2, 0], grounded=True)]
    for k in range(4):
        parts.append(block(f"box-{k}", [0.7 * k - 0.2, 0, k], [0.7 * k + 0.9, 2, k + 1]))
    return Assembly(parts)


_SCENES = (
    "paper-figure-8", "paper-figure-9", "paper-figure-10", "wedge-on-wedge", "inverted-triangle",
    "tower", "keystone", "hanging-brick", "arch", "bracket", "slot", "floating-block",
)  # fmt: skip

_MORE: dict[str, Callable[[], Assembly]] = {
    "arch-7": lambda: arches.oppenheim_arch(7),
    "arch-turned": lambda: moved(arches.arch_with_held_ends(6), OBLIQUE),
    "figure-12-planar": lambda: paper.figure_12(planar=True),
    "tower-turned": lambda: moved(stacks.tower(4), OBLIQUE),
    "short-base-turned": lambda: moved(walls.short_base(4, 4, held=1.8), OBLIQUE),
    "short-base-large": lambda: scaled(walls.short_base(4, 4, held=1.8), 1000.0),
    "short-base-small": lambda: scaled(walls.short_base(4, 4, held=1.8), 0.001),
    "pile-turned": lambda: moved(pile_on_short_base(), OBLIQUE),
    "slot-and-float": lambda: slot_and_float(False),
    "slot-and-float-planar": lambda: slot_and_float(True),
    "wedges-4": lambda: wedges.corner_wedges(4, seed=3),
}

ALL: dict[str, Callable[[], Assembly]] = {
    **{name: SCENES[name].build for name in _SCENES},
    **_MORE,
}
"""Assemblies without loads and bonds, by name."""

UNSTABLE = (
    "wedge-on-wedge", "inverted-triangle", "hanging-brick", "arch", "bracket", "floating-block",
    "arch-7", "arch-turned", "short-base-turned", "short-base-large", "short-base-small",
    "pile-turned", "slot-and-float", "slot-and-float-planar",
)  # fmt: skip
"""Those for which no direction is stable."""


def program_of(name: str | Assembly) -> Program:
    """The program of a scene without friction."""
    assembly = ALL[name]() if isinstance(name, str) and name in ALL else name
    if isinstance(assembly, str):
        assembly = scene(assembly)
    return build_program(assembly, detect.contacts(assembly)).frictionless


def directions(program: Program, count: int, seed: int = 0) -> np.ndarray:
    """Unit directions, evenly spread, in the plane if planar, shape (count, 3)."""
    g = np.random.default_rng(seed).normal(size=(count, 3))
    if program.planar:
        g[:, 1] = 0.0
    return g / np.linalg.norm(g, axis=1)[:, None]


def on_facets(program: Program, count: int, seed: int = 0) -> np.ndarray:
    """Directions on the diamond |g|_1 = 1, shape (count, 3)."""
    g = directions(program, count, seed)
    return g / np.abs(g).sum(axis=1)[:, None]


def angle_from_down(gravity: np.ndarray) -> float:
    """Angle of gravity from -z toward -x [deg]."""
    return float(np.degrees(np.arctan2(-gravity[0], -gravity[2])))
