"""Boxes among closed meshes of eight corners, whatever the order of their corners.

A corner p of a parallelepiped with edges u, v, w has the antipode p + u + v + w. The two corners
nearest to p end u and v of some order of its edges, since a diagonal of a face is longer than both
of its sides where these are square to each other; w follows. What is no such corner is no box.
"""

from __future__ import annotations

import numpy as np

from kilter.arrays import Array, Index, Mask
from kilter.shape.primitives import BOX_CORNERS

__all__ = ["box_orders"]

BITS: Array = BOX_CORNERS + 0.5
ROUNDINGS = 8.0
"""Corners are where the edges say to so many times the accuracy of the coordinates."""


def box_orders(corners: Array, faces: Index, accuracy: Array) -> tuple[Index, Mask]:
    """The order of the corners of boxes, and which meshes are boxes.

    Parameters
    ----------
    corners : ndarray, shape (n, 8, 3)
    faces : ndarray of int, shape (n, 12, 3)
        Closed surfaces, by place of the corner.
    accuracy : ndarray, shape (n,)
        Of the coordinates [length unit].

    Returns
    -------
    order : ndarray of int, shape (n, 8)
        ``corners[k, order[k]]`` are those of a box as `kilter.shape.primitives.BOX_CORNERS` has
        them.
    is_box : ndarray of bool, shape (n,)

    Examples
    --------
    >>> from kilter.shape.primitives import BOX_TRIANGLES
    >>> mixed = np.array([3, 1, 4, 0, 5, 2, 6, 7])
    >>> faces = np.argsort(mixed)[BOX_TRIANGLES]
    >>> order, is_box = box_orders(BOX_CORNERS[mixed][None], faces[None], np.array([1e-15]))
    >>> is_box, sorted(order[0].tolist()) == list(range(8))
    (array([ True]), True)
    """
    count = np.arange(len(corners))
    apart = corners - corners[:, :1]
    near = np.argsort((apart**2).sum(axis=2), axis=1)
    u, v = apart[count, near[:, 1]], apart[count, near[:, 2]]
    w = apart[count, near[:, 7]] - u - v
    left = np.einsum("ij,ij->i", np.cross(u, v), w) < 0
    u[left], v[left] = v[left], u[left].copy()
    wanted = np.einsum("cb,nbi->nci", BITS, np.stack([u, v, w], axis=1))
    off = np.linalg.norm(wanted[:, :, None] - apart[:, None], axis=3)
    order = off.argmin(axis=2)
    is_box = off.min(axis=2).max(axis=1) <= ROUNDINGS * accuracy
    is_box &= (np.sort(order, axis=1) == np.arange(8)).all(axis=1)
    place = np.argsort(order, axis=1)[count[:, None, None], faces]
    spread = (place[..., 0] ^ place[..., 1]) | (place[..., 1] ^ place[..., 2])
    is_box &= (spread < 7).all(axis=1)  # every face lies in a side of the box
    result: Mask = is_box
    return order, result
