"""What the tests of regions share: closed forms, and directions judged one by one."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

import kilter
from kilter.analysis.decision.judge import judge
from kilter.analysis.regions.region import Region
from kilter.assembly import Assembly
from kilter.mechanics.program import build_program
from kilter.scenes import arches, paper, rails, stacks, wedges

Array = NDArray[np.float64]

X, Y, Z = np.eye(3)
D = np.sqrt(0.5)

KINDS: dict[str, tuple[str, Callable[[], Assembly], list[Array], list[Array]]] = {
    # name: kind, assembly, lines, rays
    "aside": ("none", lambda: rails.railed(""), [], []),
    "arch": ("none", lambda: arches.arch(friction=0.0), [], []),
    "tower": ("ray", stacks.tower, [], [-Z]),
    "slot": ("line", lambda: rails.railed("-x +x", count=2), [X], []),
    "corner-rail": ("fan", lambda: rails.railed("-x -z", count=3), [], [-X, -Z]),
    "channel": ("half-plane", lambda: rails.railed("-x +x -z", count=3), [X], [-Z]),
    "tube": ("plane", lambda: rails.railed("-x +x -z +z", count=2), [X, Z], []),
    "frame-9": ("plane", paper.figure_9, [X, Z], []),
    "corner": ("cone", lambda: rails.railed("-x -y -z", count=3), [], [-X, -Y, -Z]),
    "stopped-rail": ("wedge", lambda: rails.railed("-y +y -x -z"), [Y], [-X, -Z]),
    "groove": ("fan", lambda: rails.groove(45), [], [(-X - Z) * D, (X - Z) * D]),
    "stopped-groove": ("wedge", lambda: rails.groove(45, ends=2), [Y], [(-X - Z) * D, (X - Z) * D]),
    "pit": ("half-space", lambda: rails.railed("-x +x -y +y -z", count=2), [X, Y], [-Z]),
    "frame": ("all", lambda: rails.railed("-x +x -y +y -z +z", count=2), [X, Y, Z], []),
    "seats": (
        "cone",
        lambda: rails.seats(5, angle=10),
        [],
        [
            np.array([np.sin(t) * c, np.sin(t) * s, -np.cos(t)])
            for t in [np.radians(10)]
            for c, s in [(1, 0), (0, 1), (-1, 0), (0, -1)]
        ],
    ),
}

MORE = {
    "corner-wedges": wedges.corner_wedges,
    "pit-wedges": lambda: rails.pit_wedges(8),
    "keystone": wedges.keystone,
    "trapped": paper.trapped_wedge,
    "figure-12": paper.figure_12,
}


def same_rays(found: Array, wanted: list[Array], tolerance: float = 1e-9) -> bool:
    """Whether two sets of unit vectors are one, in any order."""
    if len(found) != len(wanted):
        return False
    return all(np.linalg.norm(found - ray, axis=1).min() <= tolerance for ray in wanted)


def same_span(found: Array, wanted: list[Array], tolerance: float = 1e-9) -> bool:
    """Whether two orthonormal bases span the same."""
    other = np.array(wanted).reshape(-1, 3)
    return bool(np.abs(found.T @ found - other.T @ other).max() <= tolerance)


def directions(region: Region, count: int, seed: int = 0) -> Array:
    """Unit directions: a third at random, a third in the span, a third near the boundary."""
    random = np.random.default_rng(seed)
    anywhere = random.normal(size=(count, 3))
    if region.assemblies[0].planar:
        anywhere[:, 1] = 0.0
    span = np.eye(3) - region.equations.T @ region.equations
    third = count // 3
    inside = anywhere[:third] @ span
    if len(region.facets):
        # across a facet by 2e-6 to 1 rad, either way
        q = region.facets[random.integers(len(region.facets), size=third)]
        at = anywhere[third : 2 * third] @ span
        at -= np.einsum("ij,ij->i", at, q)[:, None] * q
        if len(region.rays):
            weights = random.random((third, len(region.rays)))
            tight = (q @ region.rays.T <= 1e-9) * weights
            at = tight @ region.rays + 0.1 * (at @ region.lines.T @ region.lines)
        step = 10.0 ** random.uniform(-5.5, 0, size=third) * random.choice([-1, 1], size=third)
        anywhere[third : 2 * third] = _unit(at) + step[:, None] * q
    return _unit(np.vstack([inside, anywhere[third:]]))


def _unit(rows: Array) -> Array:
    length = np.linalg.norm(rows, axis=1, keepdims=True)
    return np.where(length > 1e-9, rows / np.maximum(length, 1e-9), [[0.0, 0.0, 1.0]])


def disagreements(region: Region, asked: Array, margin: float = 1e-6) -> list[Array]:
    """Directions farther than `margin` from the boundary that `judge` calls otherwise."""
    assembly, contacts = region.assemblies[0], region.contacts[0]
    program = build_program(assembly, contacts).frictionless
    wrong = []
    for down, inside in zip(asked, region.contains(asked), strict=True):
        # in the span an equation is met to rounding, and only the facets are a boundary
        flat = np.abs(region.equations @ down)
        near = np.concatenate([flat[flat > 1e-12], np.abs(region.facets @ down)])
        if (near < margin).any():
            continue
        stable = judge(program.with_rows(gravity=down * 9.81)).stable
        if stable is not bool(inside):
            wrong.append(down)
    return wrong


def region_of(name: str) -> Region:
    """The region of a scene by its name here."""
    build = KINDS[name][1] if name in KINDS else MORE[name]
    return kilter.region(build())


BUILDERS = {name: entry[1] for name, entry in KINDS.items()} | MORE
