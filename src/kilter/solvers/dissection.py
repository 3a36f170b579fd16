"""Nested dissection: an order of elimination for the blocks of a sparse matrix.

Blocks have positions in space, and only neighbours are linked. A set of blocks is halved along the
longest side of its bounding box. Those blocks of the first half that are linked to the second
separate the halves. The halves are eliminated first, recursively, and the separator last.

Each set of blocks that is eliminated together is a *front*. Its border consists of the later blocks
that are linked to it, directly or through earlier eliminations.

References
----------
A. George, Nested dissection of a regular finite element mesh, 1973. J. W. H. Liu, The multifrontal
method for sparse matrix solution: theory and practice, 1992.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array

from kilter.arrays import Array, Index, Mask, ragged

__all__ = ["Front", "fronts"]

LEAF = 72
"""Default of `leaf`, for factorisations that solve a few right-hand sides each."""


@dataclass(frozen=True, slots=True, eq=False)
class Front:
    """Blocks of a matrix that are eliminated together, and the later blocks that they affect."""

    own: Index
    """Indices of the blocks, in the order of elimination."""
    border: Index
    """Later blocks that are linked to them, in the order of elimination."""
    links: Index
    """Links whose earlier end is among `own`."""
    children: tuple[int, ...]
    """Earlier fronts whose borders begin in this front."""


def fronts(place: Array, first: Index, second: Index, width: int, leaf: int = LEAF) -> list[Front]:
    """Divide a block matrix into fronts, in the order of elimination: children before parents.

    Arguments: `place` (N, 3); `first`, `second` (L,).

    Examples
    --------
    >>> row = np.arange(40)  # a chain
    >>> chain = fronts(np.column_stack([row, 0 * row, 0 * row]), row[:-1], row[1:], 6)
    >>> sum(len(front.own) for front in chain), len(chain[-1].border)
    (40, 0)
    """
    count = len(place)
    ends = (np.concatenate([first, second]), np.concatenate([second, first]))
    graph = csr_array((np.ones(len(ends[0])), ends), shape=(count, count))
    sets = _dissect(place, graph, leaf // width)
    owner, rank = np.empty(count, dtype=np.int64), np.empty(count, dtype=np.int64)
    order = np.concatenate([members for members, _ in sets])
    rank[order] = np.arange(count)
    owner[order] = np.repeat(np.arange(len(sets)), [len(members) for members, _ in sets])
    earliest = np.minimum(owner[first], owner[second])
    sorted_links = np.argsort(earliest, kind="stable")
    bounds = np.searchsorted(earliest[sorted_links], np.arange(len(sets) + 1))
    result: list[Front] = []
    for k, (members, children) in enumerate(sets):
        links = sorted_links[bounds[k] : bounds[k + 1]]
        # the border: later blocks that are linked to a member, or to a block eliminated before
        adjacent = [first[links], second[links], *(result[child].border for child in children)]
        touched = np.unique(rank[np.concatenate(adjacent)])
        border = order[touched]
        result.append(Front(members, border[owner[border] != k], links, children))
    return result


def _dissect(place: Array, graph: csr_array, leaf: int) -> list[tuple[Index, tuple[int, ...]]]:
    """Halve the blocks recursively; return the separators, each with the two sets it separates.

    Children come before their parents. A set of at most `leaf` blocks is not divided.
    """
    sets: list[tuple[Index, tuple[int, ...]]] = []
    right_side = np.zeros(len(place), dtype=bool)

    def divide(which: Index) -> int:
        """Halve a set of blocks recursively; return the index of its separator or leaf."""
        if len(which) <= leaf:
            sets.append((_sorted_along(place, which), ()))
            return len(sets) - 1
        points = place[which]
        axis = int(np.argmax(np.ptp(points, axis=0)))
        order = np.argsort(points[:, axis], kind="stable")
        left, right = which[order[: len(which) // 2]], which[order[len(which) // 2 :]]
        right_side[right] = True
        # these blocks separate the rest of the left half from the right half
        touching = _linked_blocks(graph, left, right_side)
        right_side[right] = False
        parts = [part for part in (left[~touching], right) if len(part)]
        children = tuple(divide(part) for part in parts)
        sets.append((_sorted_along(place, left[touching]), children))
        return len(sets) - 1

    if len(place):
        divide(np.arange(len(place)))
    return sets


def _sorted_along(place: Array, which: Index) -> Index:
    """Sort blocks by position along the axis of greatest extent; neighbours stay close."""
    points = place[which]
    axes = np.argsort(np.ptp(points, axis=0), kind="stable") if len(which) else np.arange(3)
    ordered: Index = which[np.lexsort(points[:, axes].T)]
    return ordered


def _linked_blocks(graph: csr_array, which: Index, marked: Mask) -> Mask:
    """Mask of the blocks in `which` that are linked to a marked block."""
    owner, entry = ragged(graph.indptr.astype(np.int64), which)
    hits = np.bincount(owner[marked[graph.indices[entry]]], minlength=len(which))
    linked: Mask = hits > 0
    return linked
