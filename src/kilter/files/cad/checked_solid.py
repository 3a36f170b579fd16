"""Verify a solid: its triangles are closed and enclose the volume that it states."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from kilter.arrays import Array
from kilter.assembly.mesh_surface import polyhedron_moments
from kilter.errors import InputError
from kilter.files.file_tolerances import DOUBLED, LEEWAY, SAME_FACE, VOLUME
from kilter.shape.closed import open_edges
from kilter.shape.solid import Solid, same_surface

# Find faces of a solid that lie on each other, so that the solid has no thickness there.


MOST_SAMPLES = 200
"""Largest number of triangles of a surface whose centroids are compared with another surface."""


def has_doubled_faces(solid: Solid) -> bool:
    """Whether two coincident round faces of a solid overlap with material on opposite sides.

    The halves of a sphere do not overlap. If the reader took the wrong side of the outline of a
    face, this face covers the other faces on its sphere, and volume and area show no error.
    """
    size = float(np.ptp(solid.vertices, axis=0).max(initial=0.0))
    curved = [k for k, surface in enumerate(solid.surfaces) if surface.kind != "plane"]
    for a in curved:
        facing = replace(solid.surfaces[a], hollow=not solid.surfaces[a].hollow)
        for b in curved:
            if not solid.surfaces[a].hollow or not same_surface(
                facing, solid.surfaces[b], length=SAME_FACE * size, angle=SAME_FACE
            ):
                continue
            corners_a, corners_b = (
                solid.vertices[solid.triangles[solid.triangle_surface == k]] for k in (a, b)
            )
            reach = 2.0 * solid.sagitta + solid.accuracy
            shares = (_covered(corners_a, corners_b, reach), _covered(corners_b, corners_a, reach))
            if max(shares) > DOUBLED:
                return True
    return False


def _covered(corners: Array, others: Array, reach: float) -> float:
    """Fraction of the area of triangles whose centroids lie on other triangles [-].

    Arguments: `corners`, `others` (n, 3, 3): corners of triangles; `reach`: largest distance of a
    centroid from the plane of the other triangle [length unit].
    """
    step = -(-len(corners) // MOST_SAMPLES) or 1
    corners = corners[::step]
    edges = others[:, [1, 2]] - others[:, :1]
    normal = np.cross(edges[:, 0], edges[:, 1])
    square = np.einsum("mk,mk->m", normal, normal)
    others, edges, normal, square = (x[square > 0] for x in (others, edges, normal, square))
    arm = corners.mean(axis=1)[:, None] - others[:, 0]
    height = np.abs(np.einsum("nmk,mk->nm", arm, normal)) / np.sqrt(square)
    across = np.cross(normal, edges[:, 0]), np.cross(edges[:, 1], normal)
    second = np.einsum("nmk,mk->nm", arm, across[0]) / square
    first = np.einsum("nmk,mk->nm", arm, across[1]) / square
    on = (first >= 0) & (second >= 0) & (first + second <= 1) & (height <= reach)
    area = np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    return float(area @ on.any(axis=1) / max(area.sum(), np.finfo(float).tiny))


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
