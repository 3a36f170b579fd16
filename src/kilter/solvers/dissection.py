"""Nested dissection: in what order the blocks of a sparse matrix are eliminated.

Blocks have a place in space, and only near ones are linked. Half of them, along the longest side
of what they fill, is separated from the other half by those of the first half that are linked
to the second; the halves are eliminated first, each in this way, and what separates them last.

Each set that is eliminated at once is a *front*: its own blocks, and its border, later blocks
that it is linked to, directly or through what was eliminated before.

References
----------
A. George, Nested dissection of a regular finite element mesh, 1973. J. W. H. Liu, The
multifrontal method for sparse matrix solution: theory and practice, 1992.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array

from kilter.arrays import Array, Index, Mask, ragged

__all__ = ["Front", "fronts"]

LEAF = 72
"""Unknowns up to which a set of blocks is not divided."""


@dataclass(frozen=True, slots=True, eq=False)
class Front:
    """Blocks that are eliminated at once.

    Attributes
    ----------
    own : ndarray of int
        Numbers of the blocks, in the order of elimination.
    border : ndarray of int
        Later blocks that they are linked to, in the order of elimination.
    links : ndarray of int
        Links whose earlier end is among `own`.
    children : tuple of int
        Fronts, earlier ones, whose borders begin in this one.
    """

    own: Index
    border: Index
    links: Index
    children: tuple[int, ...]


def fronts(place: Array, one: Index, other: Index, width: int) -> list[Front]:
    """The fronts of a matrix of blocks, children before parents.

    Parameters
    ----------
    place : ndarray, shape (N, 3)
        Of each block.
    one, other : ndarray of int, shape (L,)
        Ends of the links, each pair once.
    width : int
        Unknowns of a block.

    Examples
    --------
    >>> row = np.arange(40)  # a chain
    >>> found = fronts(np.column_stack([row, 0 * row, 0 * row]), row[:-1], row[1:], 6)
    >>> sum(len(front.own) for front in found), len(found[-1].border)
    (40, 0)
    """
    count = len(place)
    ends = (np.concatenate([one, other]), np.concatenate([other, one]))
    graph = csr_array((np.ones(len(ends[0])), ends), shape=(count, count))
    sets = _divided(place, graph, LEAF // width)
    owner, rank = np.empty(count, dtype=np.int64), np.empty(count, dtype=np.int64)
    order = np.concatenate([own for own, _ in sets])
    rank[order] = np.arange(count)
    owner[order] = np.repeat(np.arange(len(sets)), [len(own) for own, _ in sets])
    first = np.minimum(owner[one], owner[other])
    sorted_links = np.argsort(first, kind="stable")
    bounds = np.searchsorted(first[sorted_links], np.arange(len(sets) + 1))
    found: list[Front] = []
    for k, (own, children) in enumerate(sets):
        links = sorted_links[bounds[k] : bounds[k + 1]]
        near = [one[links], other[links], *(found[child].border for child in children)]
        touched = np.unique(rank[np.concatenate(near)])
        border = order[touched]
        found.append(Front(own, border[owner[border] != k], links, children))
    return found


def _divided(place: Array, graph: csr_array, leaf: int) -> list[tuple[Index, tuple[int, ...]]]:
    """Sets of blocks and the numbers of those that they separate, children first."""
    sets: list[tuple[Index, tuple[int, ...]]] = []
    right_side = np.zeros(len(place), dtype=bool)

    def divide(which: Index) -> int:
        if len(which) <= leaf:
            sets.append((_along(place, which), ()))
            return len(sets) - 1
        at = place[which]
        axis = int(np.argmax(np.ptp(at, axis=0)))
        order = np.argsort(at[:, axis], kind="stable")
        left, right = which[order[: len(which) // 2]], which[order[len(which) // 2 :]]
        right_side[right] = True
        touching = _linked(graph, left, right_side)
        right_side[right] = False
        parts = [part for part in (left[~touching], right) if len(part)]
        children = tuple(divide(part) for part in parts)
        sets.append((_along(place, left[touching]), children))
        return len(sets) - 1

    if len(place):
        divide(np.arange(len(place)))
    return sets


def _along(place: Array, which: Index) -> Index:
    """Blocks in their order along what they fill, so that a border is a few runs of them."""
    at = place[which]
    axes = np.argsort(np.ptp(at, axis=0), kind="stable") if len(which) else np.arange(3)
    ordered: Index = which[np.lexsort(at[:, axes].T)]
    return ordered


def _linked(graph: csr_array, which: Index, marked: Mask) -> Mask:
    """Which of some blocks are linked to a marked one."""
    owner, entry = ragged(graph.indptr.astype(np.int64), which)
    hits = np.bincount(owner[marked[graph.indices[entry]]], minlength=len(which))
    linked: Mask = hits > 0
    return linked
