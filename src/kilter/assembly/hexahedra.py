"""Find the boxes among closed meshes with eight corners, for any order of the corners.

A corner p of a parallelepiped with edges u, v, w has the antipode p + u + v + w. The two corners
nearest to p are the ends of u and v for some order of the edges, since the diagonal of a rectangle
is longer than its sides; w follows. A mesh with a corner elsewhere is not a box.
"""

from __future__ import annotations

import numpy as np

from kilter.arrays import Array, Index, Mask, cross

PLACES: Index = np.array([1, 2, 4])
"""Weight of each edge direction in the index (0 to 7) of a corner of a box."""
TURNED: Index = np.array([1, 0, 2])
"""Order of the edges of a mirrored box: the first two are exchanged."""
PATTERNS = 8
"""Number of orders of faces that are examined; meshes with another order do not count as boxes."""
ROUNDINGS = 8.0
"""Largest offset of a corner of a box [multiples of the accuracy of the coordinates]."""


def closed_octets(faces: Index) -> Mask:
    """Mask of the meshes with eight vertices whose faces form a closed surface, shape (n,).

    All eight vertices must be used, and each edge must have two faces in opposite senses. Meshes of
    the same origin list their faces in the same order, so few orders are examined.

    Arguments: `faces` (n, 12, 3): indices of vertices; an index outside of 0 to 7 is not valid.

    Examples
    --------
    >>> from kilter.shape.primitives import BOX_TRIANGLES
    >>> closed_octets(np.array([BOX_TRIANGLES, BOX_TRIANGLES[::-1], BOX_TRIANGLES % 7]))
    array([ True,  True, False])
    """
    is_closed = np.zeros(len(faces), dtype=bool)
    left = np.arange(len(faces))
    for _ in range(PATTERNS):
        if not len(left):
            break
        pattern = faces[left[0]]
        same = (faces[left] == pattern).all(axis=(1, 2))
        is_closed[left[same]] = _is_closed(pattern)
        left = left[~same]
    return is_closed


def _is_closed(faces: Index) -> bool:
    """Whether the triangles of a mesh with the vertices 0 to 7 form a closed surface."""
    start, end = faces.ravel(), faces[:, [1, 2, 0]].ravel()
    edges = set(zip(start.tolist(), end.tolist(), strict=True))
    return (
        set(start.tolist()) == set(range(8))
        and len(edges) == len(start)
        and all(p != q and (q, p) in edges for p, q in edges)
    )


def box_orders(corners: Array, faces: Index, accuracy: Array) -> tuple[Index, Mask]:
    """Decide which meshes are boxes, and find the standard order of their corners.

    Arguments: `corners` (n, 8, 3); `faces` (n, 12, 3): closed surfaces; the entries are indices of
    corners; `accuracy` (n,): largest errors of the coordinates [length unit]. Returns `order` (n,
    8): ``corners[k, order[k]]`` are in the order of `kilter.shape.primitives.BOX_CORNERS` if mesh k
    is a box; `is_box` (n,).

    Examples
    --------
    >>> from kilter.shape.primitives import BOX_CORNERS, BOX_TRIANGLES
    >>> mixed = np.array([3, 1, 4, 0, 5, 2, 6, 7])
    >>> faces = np.argsort(mixed)[BOX_TRIANGLES]
    >>> order, is_box = box_orders(BOX_CORNERS[mixed][None], faces[None], np.array([1e-15]))
    >>> is_box, sorted(order[0].tolist()) == list(range(8))
    (array([ True]), True)
    """
    count = np.arange(len(corners))
    apart = corners - corners[:, :1]
    near = np.argsort(np.einsum("nci,nci->nc", apart, apart), axis=1)
    u, v = apart[count, near[:, 1]], apart[count, near[:, 2]]
    w = apart[count, near[:, 7]] - u - v
    across = np.stack([cross(v, w), cross(w, u), cross(u, v)], axis=1)
    volume = np.einsum("ni,ni->n", u, across[:, 0])
    mirrored = volume < 0
    edges = np.stack([u, v, w], axis=1)
    edges[mirrored], across[mirrored] = edges[mirrored][:, TURNED], across[mirrored][:, TURNED]
    bits = apart @ across.transpose(0, 2, 1) > (volume / 2)[:, None, None]
    bits[mirrored] = ~bits[mirrored]
    place = bits @ PLACES
    off = np.abs(bits.astype(np.float64) @ edges - apart).max(axis=(1, 2))
    is_box = off <= ROUNDINGS * accuracy
    order = np.argsort(place, axis=1)
    is_box &= (place[count[:, None], order] == np.arange(8)).all(axis=1)
    at = place[count[:, None, None], faces]
    spread = (at[..., 0] ^ at[..., 1]) | (at[..., 1] ^ at[..., 2])
    is_box &= (spread < 7).all(axis=1)  # every triangle lies in a side of the box
    result: Mask = is_box
    return order, result


def box_moments(corners: Array) -> tuple[Array, Array, Array]:
    """Volume, centre, and second moment about the centre, of boxes given by their corners.

    With the edges u, v, w the integral of x x^T is V (u u^T + v v^T + w w^T) / 12.

    Arguments: `corners` (n, 8, 3): corners in the order of `kilter.shape.primitives.BOX_CORNERS`.

    Examples
    --------
    >>> from kilter.shape.primitives import BOX_CORNERS
    >>> volume, center, second = box_moments((BOX_CORNERS * [1, 2, 3])[None])
    >>> volume, np.diag(second[0]) / volume * 12
    (array([6.]), array([1., 4., 9.]))
    """
    edges = corners[:, [1, 2, 4]] - corners[:, :1]
    volume = np.einsum("ni,ni->n", edges[:, 0], cross(edges[:, 1], edges[:, 2]))
    second = (volume / 12)[:, None, None] * (edges.transpose(0, 2, 1) @ edges)
    return volume, corners.mean(axis=1), second
