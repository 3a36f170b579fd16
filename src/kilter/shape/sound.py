"""Meshes that are closed as they are, found many at once.

Of a mesh whose edges p -> q and their reverses q -> p are the same, each once, whose faces have an
area and whose vertices are all used, nothing is left to weld but vertices in one place. A file of
many blocks has hardly any others, and asked one by one they take most of the time of reading it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from kilter.arrays import Array, Index, Mask, starts
from kilter.shape.closed import flat_faces

__all__ = ["welded_if_sound"]

Corners = tuple[Array, Index]
"""Vertices, shape (n, 3), and triangles, shape (m, 3)."""
BATCH = 500_000
"""Triangles that are looked at in one go."""


def welded_if_sound(meshes: Sequence[Corners]) -> list[Corners | None]:
    """Each mesh as `kilter.shape.closed.welded` gives it; None of those that need more than that.

    Examples
    --------
    >>> corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, -0.0]])
    >>> faces = np.array([[0, 2, 1], [4, 1, 3], [1, 2, 3], [0, 3, 2]])
    >>> closed, opened = welded_if_sound([(corners, faces), (corners, faces[:3])])
    >>> len(closed[0]), opened is None
    (4, True)
    """
    found: list[Corners | None] = []
    for batch in _batches(meshes):
        found += _welded(batch)
    return found


def _batches(meshes: Sequence[Corners]) -> Iterator[Sequence[Corners]]:
    """The meshes in their order, about `BATCH` triangles at a time."""
    begin = total = 0
    for end, (_, triangles) in enumerate(meshes, start=1):
        total += len(triangles)
        if total >= BATCH or end == len(meshes):
            yield meshes[begin:end]
            begin, total = end, 0


def _welded(meshes: Sequence[Corners]) -> list[Corners | None]:
    first = starts([len(vertices) for vertices, _ in meshes])
    first_face = starts([len(triangles) for _, triangles in meshes])
    vertices = np.concatenate([vertices for vertices, _ in meshes]) + 0.0
    owner = np.repeat(np.arange(len(meshes)), np.diff(first))
    order = np.lexsort((*vertices.T[::-1], owner))
    ordered, owner = vertices[order], owner[order]
    fresh = np.ones(len(order), dtype=bool)
    fresh[1:] = (ordered[1:] != ordered[:-1]).any(axis=1) | (owner[1:] != owner[:-1])
    place = np.cumsum(fresh) - 1
    distinct, inverse = ordered[fresh], np.empty(len(order), dtype=np.int64)
    inverse[order] = place
    faces = np.concatenate([triangles for _, triangles in meshes])
    faces = inverse[faces + np.repeat(first[:-1], np.diff(first_face))[:, None]]
    kept = np.append(place[first[:-1]], len(distinct))
    sound = _sound(distinct, faces, kept, first_face)
    return [
        (distinct[a:b], faces[p:q] - a) if fine else None
        for fine, a, b, p, q in zip(sound, kept, kept[1:], first_face, first_face[1:], strict=False)
    ]


def _sound(vertices: Array, faces: Index, first: Index, first_face: Index) -> Mask:
    """Which meshes need nothing more; their vertices and faces from `first` and `first_face` on."""
    sound = np.ones(len(first) - 1, dtype=bool)
    used = np.bincount(faces.reshape(-1), minlength=len(vertices)) > 0
    sound[np.searchsorted(first, np.flatnonzero(~used), side="right") - 1] = False
    flat = np.flatnonzero(flat_faces(vertices, faces))
    begin, end = faces.reshape(-1), faces[:, [1, 2, 0]].reshape(-1)
    # of each mesh the keys are in one place, since its vertices are
    forth, back = np.sort(begin * len(vertices) + end), np.sort(end * len(vertices) + begin)
    wrong = forth != back
    wrong[1:] |= forth[1:] == forth[:-1]
    for face in (flat, np.flatnonzero(wrong) // 3):
        sound[np.searchsorted(first_face, face, side="right") - 1] = False
    return sound
