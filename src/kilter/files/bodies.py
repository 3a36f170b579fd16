"""The separate bodies of one mesh: what a file without names holds.

Two faces belong to one body where they meet at an edge. Bodies that touch share edges in
space, so at an edge of more than two faces each is paired with the next one *through the
material between them*, found by going around the edge. A closed shell turned inwards is a
hole of the body around it. Pieces that are open and share a corner stay together.
"""

from __future__ import annotations

import numpy as np

from kilter.arrays import Array, Index, Mask, connected
from kilter.files.file_tolerances import SAME_ANGLE
from kilter.shape.closed import contains
from kilter.shape.primitives import Mesh

__all__ = ["split_bodies"]


def split_bodies(mesh: Mesh) -> list[Mesh]:
    """The bodies of a mesh, in the order of their first face.

    Examples
    --------
    >>> from kilter.shape.primitives import Box, surface
    >>> vertices, faces = surface(Box([1, 1, 1]))
    >>> stacked = Mesh([*vertices, *(vertices + [0, 0, 1])], [*faces, *(faces + 8)])
    >>> [len(body.triangles) for body in split_bodies(stacked)]
    [12, 12]
    """
    places, inverse = np.unique(mesh.vertices + 0.0, axis=0, return_inverse=True)
    faces: Index = inverse.reshape(-1)[mesh.triangles].astype(np.int64)
    proper = (faces != np.roll(faces, 1, axis=1)).all(axis=1)
    if not proper.any():
        return [mesh]
    if not proper.all():  # a face of two corners hangs together with nothing
        rows = mesh.triangles[proper]
        return split_bodies(Mesh(mesh.vertices, rows, accuracy=mesh.accuracy))
    with np.errstate(all="ignore"):
        label = _labels(places, faces)
        if label.max() == 0:
            return [mesh]
        label = _with_holes(places, faces, label)
    _, first = np.unique(label, return_index=True)
    return [_piece(mesh, mesh.triangles[label == label[k]]) for k in np.sort(first)]


def _piece(mesh: Mesh, triangles: Index) -> Mesh:
    used, compact = np.unique(triangles, return_inverse=True)
    return Mesh(mesh.vertices[used], compact.reshape(-1, 3), accuracy=mesh.accuracy)


def _labels(places: Array, faces: Index) -> Index:
    """Body of each face, shape (m,), holes apart."""
    sign = 1 if _volume(places, faces) >= 0 else -1
    face, key, turn, (low, high) = _edges(faces)
    order = np.argsort(key, kind="stable")
    first = np.flatnonzero(np.concatenate([[True], np.diff(key[order]) != 0]))
    count = np.diff(np.append(first, len(order)))
    balanced = np.add.reduceat(turn[order], first) == 0
    simple = (count == 2) | ~balanced
    # within a group that needs no care, each face is joined to the one before
    rank = np.arange(len(order)) - np.repeat(first, count)
    chained = np.flatnonzero((rank > 0) & np.repeat(simple, count))
    pairs = [np.column_stack([face[order[chained]], face[order[chained - 1]]])]
    for start, size in zip(first[~simple], count[~simple], strict=True):
        rows = order[start : start + size]
        edge = (places[low[rows[0]]], places[high[rows[0]]])
        opposite = places[_third(faces[face[rows]], low[rows[0]], high[rows[0]])]
        pairs.append(face[rows][_around(edge, opposite, sign * turn[rows])])
    label = connected(len(faces), *np.concatenate(pairs).T)
    loose = np.unique(face[order[np.repeat(~balanced, count)]])
    if len(loose):
        label = _joined_at_corners(faces, label, np.isin(label, label[loose]))
    return label


def _edges(faces: Index) -> tuple[Index, Index, Index, tuple[Index, Index]]:
    """Of every edge of every face: the face, a key, its turn (+1 from low to high), its ends."""
    ends = faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    face = np.repeat(np.arange(len(faces)), 3)
    proper = ends[:, 0] != ends[:, 1]
    ends, face = ends[proper], face[proper]
    low, high = ends.min(axis=1), ends.max(axis=1)
    turn = np.where(ends[:, 0] == low, 1, -1)
    return face, low * (int(faces.max()) + 1) + high, turn, (low, high)


def _third(faces: Index, low: int, high: int) -> Index:
    """The corner of each face that is not on the edge (its first one, of a face of no area)."""
    off = (faces != low) & (faces != high)
    third: Index = faces[np.arange(len(faces)), off.argmax(axis=1)]
    return third


def _around(edge: tuple[Array, Array], opposite: Array, turn: Index) -> Index:
    """Pairs (opening face, closing face) with material between, going around an edge.

    A face that runs along the edge has its outside at larger angles: it closes material;
    one that runs against it opens. Of faces that lie on each other the closing come first.
    """
    axis = edge[1] - edge[0]
    arm = opposite - edge[0]
    arm = arm - np.outer(arm @ axis, axis) / (axis @ axis)
    u = arm[0] / (np.linalg.norm(arm[0]) or 1.0)
    v = np.cross(axis, u) / np.linalg.norm(axis)
    angle = np.mod(np.arctan2(arm @ v, arm @ u) + SAME_ANGLE, 2 * np.pi)
    by_angle = np.argsort(angle, kind="stable")
    step = np.diff(angle[by_angle]) > SAME_ANGLE
    cluster = np.empty(len(angle), dtype=np.int64)
    cluster[by_angle] = np.concatenate([[0], np.cumsum(step)])
    order = np.lexsort((-turn, cluster)).tolist()
    pairs, waiting = [], []
    for k in [*order, *order]:  # twice around: material may lie across the start
        if turn[k] < 0:
            waiting.append(k)
        elif waiting:
            pairs.append((waiting.pop(), k))
        if len(pairs) == len(order):
            break
    return np.array(pairs, dtype=np.int64).reshape(-1, 2)


def _joined_at_corners(faces: Index, label: Index, chosen: Mask) -> Index:
    """Labels after the chosen faces' pieces are joined where they share a corner."""
    count = int(label.max()) + 1
    corners = faces[chosen].reshape(-1)
    piece = np.repeat(label[chosen], 3)
    joined = connected(count + int(faces.max()) + 1, piece, count + corners)
    result: Index = joined[label]
    return result


def _with_holes(places: Array, faces: Index, label: Index) -> Index:
    """Labels after each shell that is turned inwards is given to the body around it."""
    names = np.unique(label)
    shells = {int(k): faces[label == k] for k in names}
    volume = {k: _volume(places, shell) for k, shell in shells.items()}
    sign = 1 if sum(volume.values()) >= 0 else -1
    label = label.copy()
    bodies = sorted((k for k in shells if sign * volume[k] > 0), key=lambda k: abs(volume[k]))
    for k, shell in shells.items():
        if sign * volume[k] >= 0:
            continue
        point = places[shell[0, 0]]
        around = (b for b in bodies if contains(places, shells[b], point))
        label[label == k] = next(around, k)
    return label


def _volume(places: Array, faces: Index) -> float:
    p, q, r = (places[faces[:, k]] - places[faces[0, 0]] for k in range(3))
    return float(np.einsum("ij,ij->", p, np.cross(q, r)) / 6)
