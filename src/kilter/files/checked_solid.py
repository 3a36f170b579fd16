"""Verify a solid: its triangles are closed and enclose the volume that it states."""

from __future__ import annotations

import numpy as np

from kilter.assembly.polyhedra import polyhedron_moments
from kilter.errors import InputError
from kilter.files.doubled_faces import has_doubled_faces
from kilter.files.file_tolerances import LEEWAY, VOLUME
from kilter.shape.closed import open_edges
from kilter.shape.solid import Solid

__all__ = ["checked_solid"]


def checked_solid(solid: Solid) -> Solid:
    """Return the solid unchanged; raises `InputError` if its data are inconsistent.

    The enclosed volume may differ from the stated volume by the distance of the triangles from
    the faces times their area. A solid with holes is not verified.

    Raises `InputError` if the triangles are not closed, or enclose another volume than the solid
    states, or if round faces lie on each other.
    """
    vertices, triangles = solid.vertices, solid.triangles
    if len(solid.holes) and len(triangles):
        return solid
    if not len(triangles) or len(open_edges(vertices, triangles)):
        raise InputError(
            "the faces of the solid do not close", hint="repair it in the program that made it"
        )
    p, q, r = (vertices[triangles[:, k]] for k in range(3))
    area = float(np.linalg.norm(np.cross(q - p, r - p), axis=1).sum() / 2)
    volume = polyhedron_moments(vertices, triangles, np.array([0, len(triangles)]))[0][0]
    leeway = LEEWAY * area * (solid.sagitta + solid.accuracy) + VOLUME * abs(volume)
    if abs(solid.volume - volume) > leeway:
        raise InputError(
            f"the solid states a volume of {solid.volume:.6g}, its triangles enclose {volume:.6g}",
            hint="repair it in the program that made it",
        )
    if has_doubled_faces(solid):
        raise InputError(
            "two of its round faces lie on each other", hint="repair it in the program that made it"
        )
    return solid
