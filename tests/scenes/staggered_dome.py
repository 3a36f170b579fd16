"""A dome of staggered rings whose blocks overlap: hundreds of open pairs with friction.

A ring is a regular polygon of voussoirs between two cones through the centre of the sphere. The
polygons of neighbouring rings are turned by half a block, so the blocks of a ring meet those of
the next ring in planes that intersect: each such pair overlaps by a few thousandths of its size.
"""

from itertools import pairwise

import numpy as np

from kilter import Assembly, Mesh, Part
from kilter.arrays import Array

RADII = (2.8, 3.2)
"""Inner and outer radius [m]."""
HIGHEST = 75.0
"""Elevation of the opening at the top [deg]."""
FACES = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
"""Faces of a block, counterclockwise from outside; vertex 4 top + 2 right + outer."""


def staggered_dome(
    seed: int = 0, rings: int = 22, per_ring: int = 24, *, staggered: bool = True
) -> Assembly:
    """A dome with `2 (rings - 1) per_ring` overlapping pairs, friction .84, lowest ring held.

    The heights of the rings and the densities are random. Rings that are not staggered have their
    joints above each other and meet in faces, without an overlap.
    """
    random = np.random.default_rng(seed)
    steps = random.uniform(0.8, 1.2, rings)
    elevation = np.radians(HIGHEST) * np.append(0.0, np.cumsum(steps) / steps.sum())
    azimuth = 2 * np.pi * np.arange(per_ring + 1) / per_ring
    parts = []
    for ring, (low, high) in enumerate(pairwise(elevation)):
        turned = azimuth + staggered * (ring % 2) * np.pi / per_ring
        for k, (left, right) in enumerate(pairwise(turned)):
            # left and right are exchanged: the azimuth runs counterclockwise seen from above
            vertices = _block(float(low), float(high), float(right), float(left))
            density = float(random.uniform(1800, 2200))
            mesh = Mesh(vertices, [face[::-1] for face in FACES])
            parts.append(Part(f"block-{ring}-{k}", mesh, grounded=ring == 0, density=density))
    return Assembly(parts, friction=0.84)


def _block(low: float, high: float, left: float, right: float) -> Array:
    """Vertices of a block between two elevations and two azimuths [rad], shape (8, 3)."""
    return np.array(
        [
            [r * np.cos(e) * np.cos(a), r * np.cos(e) * np.sin(a), r * np.sin(e)]
            for e in (low, high)
            for a in (left, right)
            for r in RADII
        ]
    )
