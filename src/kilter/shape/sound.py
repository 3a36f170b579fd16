"""Weld the valid meshes of a file all at once.

A mesh is valid if every directed edge p -> q occurs once, together with its reverse q -> p, all
faces have an area, and all vertices are used. Only equal vertices have to be merged then. Most
meshes of a file with many blocks are valid. Welding them one by one would take most of the time of
reading the file.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from kilter.arrays import Array, Index, Mask, distinct_rows, starts
from kilter.shape.closed import flat_faces

__all__ = ["weld_valid_meshes"]

Corners = tuple[Array, Index]
"""A mesh: vertices, shape (n, 3), and triangles, shape (m, 3)."""
BATCH = 500_000
"""Number of triangles that are processed at once; more need more memory."""


def weld_valid_meshes(meshes: Sequence[Corners]) -> list[Corners | None]:
    """Merge equal vertices of all valid meshes at once; None for each mesh that needs repair.

    Examples
    --------
    >>> corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, -0.0]])
    >>> faces = np.array([[0, 2, 1], [4, 1, 3], [1, 2, 3], [0, 3, 2]])
    >>> closed, opened = weld_valid_meshes([(corners, faces), (corners, faces[:3])])
    >>> len(closed[0]), opened is None
    (4, True)
    """
    welded: list[Corners | None] = []
    for batch in _batches(meshes):
        welded += _weld_batch(batch)
    return welded


def _batches(meshes: Sequence[Corners]) -> Iterator[Sequence[Corners]]:
    """Yield the meshes in order, in groups of about `BATCH` triangles."""
    begin = total = 0
    for end, (_, triangles) in enumerate(meshes, start=1):
        total += len(triangles)
        if total >= BATCH or end == len(meshes):
            yield meshes[begin:end]
            begin, total = end, 0


def _weld_batch(meshes: Sequence[Corners]) -> list[Corners | None]:
    """Merge equal vertices of the meshes of a group; None for each mesh that needs repair."""
    count = [len(vertices) for vertices, _ in meshes]
    first = starts(count)
    first_face = starts([len(triangles) for _, triangles in meshes])
    vertices = np.concatenate([vertices for vertices, _ in meshes]) + 0.0
    owner = np.repeat(np.arange(len(meshes)), count)
    # the mesh as the first column keeps equal vertices of different meshes apart
    rows, inverse = distinct_rows(np.column_stack([owner, vertices]))
    distinct: Array = np.ascontiguousarray(rows[:, 1:])
    faces = np.concatenate([triangles for _, triangles in meshes])
    faces = inverse[faces + np.repeat(first[:-1], np.diff(first_face))[:, None]]
    kept = np.searchsorted(rows[:, 0], np.arange(len(meshes) + 1))
    valid = _is_valid(distinct, faces, kept, first_face)
    return [
        (distinct[a:b], faces[p:q] - a) if fine else None
        for fine, a, b, p, q in zip(valid, kept, kept[1:], first_face, first_face[1:], strict=False)
    ]


def _is_valid(vertices: Array, faces: Index, first: Index, first_face: Index) -> Mask:
    """Mask of merged meshes that are closed and need no repair, shape (number of meshes,).

    `first` and `first_face`: first vertex and first face of each mesh, and the total number.
    """
    valid = np.ones(len(first) - 1, dtype=bool)
    used = np.bincount(faces.reshape(-1), minlength=len(vertices)) > 0
    valid[np.searchsorted(first, np.flatnonzero(~used), side="right") - 1] = False
    flat = np.flatnonzero(flat_faces(vertices, faces))
    begin, end = faces.reshape(-1), faces[:, [1, 2, 0]].reshape(-1)
    # the vertices of a mesh are consecutive, so its keys are consecutive after sorting
    forth, back = np.sort(begin * len(vertices) + end), np.sort(end * len(vertices) + begin)
    wrong = forth != back
    wrong[1:] |= forth[1:] == forth[:-1]
    for face in (flat, np.flatnonzero(wrong) // 3):
        valid[np.searchsorted(first_face, face, side="right") - 1] = False
    return valid
