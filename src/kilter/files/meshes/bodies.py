"""Split a mesh without names into its separate bodies.

Two faces that meet at an edge belong to the same body. Bodies that touch share edges in space.
Therefore, at an edge of more than two faces, each face is paired with the next face *across the
material between them*, in the order of their angles about the edge. A closed shell turned inwards
is a hole of the body around it. Open pieces that share a corner stay together.
"""

from __future__ import annotations

import numpy as np

from kilter.arrays import Array, Index, Mask, connected, cross, distinct_rows, unit_rows
from kilter.files.file_tolerances import SAME_ANGLE
from kilter.shape.closed import contains, signed_volume
from kilter.shape.primitives import Mesh


def split_bodies(mesh: Mesh) -> list[Mesh]:
    """Split a mesh into its separate bodies, in the order of their first face.

    Examples
    --------
    >>> from kilter.shape.primitives import Box, surface
    >>> vertices, faces = surface(Box([1, 1, 1]))
    >>> stacked = Mesh([*vertices, *(vertices + [0, 0, 1])], [*faces, *(faces + 8)])
    >>> [len(body.triangles) for body in split_bodies(stacked)]
    [12, 12]
    """
    places, inverse = distinct_rows(mesh.vertices + 0.0)
    faces: Index = inverse[mesh.triangles]
    proper = (faces != np.roll(faces, 1, axis=1)).all(axis=1)
    if not proper.any():
        return [mesh]
    if not proper.all():  # a face with a repeated corner has no area and connects no faces
        rows = mesh.triangles[proper]
        return split_bodies(Mesh(mesh.vertices, rows, accuracy=mesh.accuracy))
    with np.errstate(all="ignore"):
        label = _labels(places, faces)
        if label.max() == 0:
            return [mesh]
        label = _with_holes(places, faces, label)
    _, rows = _by_label(label)
    return [_piece(mesh, mesh.triangles[k]) for k in sorted(rows, key=lambda k: int(k[0]))]


def _by_label(label: Index) -> tuple[Index, list[Index]]:
    """The distinct labels in ascending order, and for each the rows that have it."""
    order = np.argsort(label, kind="stable")
    first = np.flatnonzero(np.diff(label[order], prepend=-1))
    return label[order[first]], np.split(order, first[1:])


def _piece(mesh: Mesh, triangles: Index) -> Mesh:
    """Part of a mesh: the triangles with the given indices, without unused vertices."""
    used, compact = np.unique(triangles, return_inverse=True)
    return Mesh(mesh.vertices[used], compact.reshape(-1, 3), accuracy=mesh.accuracy)


def _labels(places: Array, faces: Index) -> Index:
    """A number for each face, shape (m,), equal for the faces of the same connected shell.

    A hole is a shell of its own.

    Arguments: `places` (n, 3): distinct vertices; `faces` (m, 3).
    """
    sign = 1 if signed_volume(places, faces) >= 0 else -1
    face, key, turn, (low, high) = _edges(faces)
    order = np.argsort(key, kind="stable")
    first = np.flatnonzero(np.concatenate([[True], np.diff(key[order]) != 0]))
    count = np.diff(np.append(first, len(order)))
    balanced = np.add.reduceat(turn[order], first) == 0
    simple = (count == 2) | ~balanced
    # at an edge of two faces, or of an open piece, every face is joined to the previous face
    rank = np.arange(len(order)) - np.repeat(first, count)
    chained = np.flatnonzero((rank > 0) & np.repeat(simple, count))
    pairs = [np.column_stack([face[order[chained]], face[order[chained - 1]]])]
    for size in np.unique(count[~simple]):  # all edges with the same number of faces at once
        rows = order[first[~simple & (count == size)][:, None] + np.arange(size)]
        ends = low[rows[:, :1]], high[rows[:, :1]]
        opposite = places[_third(faces[face[rows]], *ends)]
        edge = places[ends[0][:, 0]], places[ends[1][:, 0]]
        group, opening, closing = _pair_about_edge(edge, opposite, sign * turn[rows])
        pairs.append(np.column_stack([face[rows[group, opening]], face[rows[group, closing]]]))
    label = connected(len(faces), *np.concatenate(pairs).T)
    loose = np.unique(face[order[np.repeat(~balanced, count)]])
    if len(loose):
        label = _joined_at_corners(faces, label, np.isin(label, label[loose]))
    return label


def _edges(faces: Index) -> tuple[Index, Index, Index, tuple[Index, Index]]:
    """All edges of all faces: the face, a key, the sense (+1 from the lower vertex), and both ends.

    The key is the same for edges with the same ends. Edges of no length are left out.
    """
    ends = faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    face = np.repeat(np.arange(len(faces)), 3)
    proper = ends[:, 0] != ends[:, 1]
    ends, face = ends[proper], face[proper]
    low, high = ends.min(axis=1), ends.max(axis=1)
    turn = np.where(ends[:, 0] == low, 1, -1)
    return face, low * (int(faces.max()) + 1) + high, turn, (low, high)


def _third(faces: Index, low: Index, high: Index) -> Index:
    """The corner of each face that is not on the given edge; the first corner if the area is 0.

    Arguments: `faces` (n, s, 3): the s faces at each of n edges; `low`, `high` (n, 1): ends of the
    edges. Returns (n, s).
    """
    off = (faces != low[:, :, None]) & (faces != high[:, :, None])
    third: Index = np.take_along_axis(faces, off.argmax(axis=2)[:, :, None], axis=2)[:, :, 0]
    return third


def _pair_about_edge(
    edge: tuple[Array, Array], opposite: Array, turn: Index
) -> tuple[Index, Index, Index]:
    """Pair the faces about each edge so that material lies between the two faces of a pair.

    Faces are sorted by their angle about the edge. A face that runs along the edge has its
    outside at larger angles, so the material ends there: it closes. A face that runs against the
    edge opens. Among faces that lie on each other, the closing faces come first.

    Arguments: `edge` (n, 3): ends of the edges; `opposite` (n, s, 3): third corner of each of the s
    faces at an edge; `turn` (n, s): 1 if a face runs along the edge, -1 if it runs against it.
    Returns `edge, opening, closing` (m,): index of the edge, and indices of the two faces among the
    s faces at that edge.
    """
    axis = edge[1] - edge[0]
    arm = opposite - edge[0][:, None]
    along = np.einsum("nsi,ni->ns", arm, axis) / np.einsum("ni,ni->n", axis, axis)[:, None]
    arm = arm - along[:, :, None] * axis[:, None]
    u = unit_rows(arm[:, 0])
    v = unit_rows(cross(axis, u))
    angle = np.arctan2(np.einsum("nsi,ni->ns", arm, v), np.einsum("nsi,ni->ns", arm, u))
    angle = np.mod(angle + SAME_ANGLE, 2 * np.pi)
    by_angle = np.argsort(angle, axis=1, kind="stable")
    step = np.diff(np.take_along_axis(angle, by_angle, axis=1), axis=1) > SAME_ANGLE
    cluster = np.zeros(angle.shape, dtype=np.int64)
    np.put_along_axis(cluster, by_angle[:, 1:], np.cumsum(step, axis=1), axis=1)
    return _match_brackets(np.argsort(4 * cluster - turn, axis=1, kind="stable"), turn)


def _match_brackets(order: Index, turn: Index) -> tuple[Index, Index, Index]:
    """Pair each closing face with the last unpaired opening face, as brackets, for n edges at once.

    Arguments: `order` (n, s): faces at each edge in the order of their angles; `turn` (n, s): 1 if
    a face closes, -1 if it opens.
    """
    every, size = np.arange(len(order)), order.shape[1]
    waiting, height = np.empty((len(order), 2 * size), dtype=np.int64), np.zeros_like(every)
    paired = np.zeros_like(every)
    pairs = []
    for k in (*order.T, *order.T):  # two rounds, since material may lie across angle 0
        opens = turn[every, k] < 0
        closes = np.flatnonzero(~opens & (height > 0) & (paired < size))
        height[closes] -= 1
        paired[closes] += 1
        pairs.append((closes, waiting[closes, height[closes]], k[closes]))
        waiting[opens, height[opens]] = k[opens]
        height[opens] += 1
    edge, opening, closing = (np.concatenate([pair[k] for pair in pairs]) for k in range(3))
    return edge, opening, closing


def _joined_at_corners(faces: Index, label: Index, chosen: Mask) -> Index:
    """Labels of the faces, made equal where pieces of the chosen faces share a corner."""
    count = int(label.max()) + 1
    corners = faces[chosen].reshape(-1)
    piece = np.repeat(label[chosen], 3)
    joined = connected(count + int(faces.max()) + 1, piece, count + corners)
    result: Index = joined[label]
    return result


def _with_holes(places: Array, faces: Index, label: Index) -> Index:
    """Labels in which each inward shell (a hole) has the label of the body around it."""
    names, rows = _by_label(label)
    volume = np.array([signed_volume(places, faces[k]) for k in rows])
    sign = 1 if volume.sum() >= 0 else -1
    inwards = np.flatnonzero(sign * volume < 0)
    if not len(inwards):
        return label
    bodies = np.flatnonzero(sign * volume > 0)
    bodies = bodies[np.argsort(np.abs(volume[bodies]), kind="stable")]
    corners = [places[faces[rows[k]]].reshape(-1, 3) for k in bodies]
    low = np.array([points.min(axis=0) for points in corners])
    high = np.array([points.max(axis=0) for points in corners])
    label = label.copy()
    for k in inwards:
        point = places[faces[rows[k][0], 0]]
        near = bodies[((low <= point) & (point <= high)).all(axis=1)]
        around = (names[b] for b in near if contains(places, faces[rows[b]], point))
        label[rows[k]] = next(around, names[k])
    return label
