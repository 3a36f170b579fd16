"""A solid that hangs together: closed, and of the volume that its triangles enclose."""

from __future__ import annotations

import numpy as np

from kilter.assembly.geometry import polyhedron_moments
from kilter.errors import InputError
from kilter.shape.closed import open_edges
from kilter.shape.solid import Solid

__all__ = ["checked"]

LEEWAY = 2.0
"""Times the sagitta that triangles may be off, on average, from the faces they stand for."""
ROUNDING = 1e-6
"""Part of the volume that integrals over the faces may be wrong by."""


def checked(solid: Solid) -> Solid:
    """The solid itself.

    Raises
    ------
    InputError
        If its triangles are not closed, or enclose another volume than it states: by more
        than their distance from the faces accounts for.
    """
    vertices, triangles = solid.vertices, solid.triangles
    if not len(triangles) or len(open_edges(vertices, triangles)):
        raise InputError("the faces of the solid do not close", hint="heal it where it was made")
    p, q, r = (vertices[triangles[:, k]] for k in range(3))
    area = float(np.linalg.norm(np.cross(q - p, r - p), axis=1).sum() / 2)
    volume = polyhedron_moments(vertices, triangles, np.array([0, len(triangles)]))[0][0]
    leeway = LEEWAY * area * (solid.sagitta + solid.accuracy) + ROUNDING * abs(volume)
    if abs(solid.volume - volume) > leeway:
        raise InputError(
            f"the solid states a volume of {solid.volume:.6g}, its triangles enclose {volume:.6g}",
            hint="heal it where it was made",
        )
    return solid
