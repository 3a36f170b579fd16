"""Search for motions that open contacts, by a linear program."""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import numpy as np
from scipy.sparse import csc_array

from kilter.arrays import Array, Mask
from kilter.second_order.motions.sharp_points import SharpPoints
from kilter.second_order.searches.counted_program import optimum
from kilter.solvers.problem import LinearProgram
from kilter.work import Work

__all__ = ["enough_to_open", "opening_motion"]

MOST_CHOICES = 64
"""Largest number of combinations of normals, one for each pair."""


def opening_motion(rows: Array, work: Work | None) -> Array | None:
    """Motion, (f,), that opens all given rows as widely as possible; None if none opens all.

    Max t:  rows x >= t,  |x| <= 1.
    """
    count, freedoms = rows.shape
    x = optimum(
        LinearProgram(
            np.append(np.zeros(freedoms), -1.0),
            csc_array(np.hstack([rows, -np.ones((count, 1))])),
            np.zeros(count),
            np.full(count, np.inf),
            -np.ones(freedoms + 1),
            np.ones(freedoms + 1),
        ),
        work,
    )
    return x[:-1] if x is not None and x[-1] > 0 else None


def enough_to_open(points: SharpPoints, rows: Mask) -> Iterator[Mask]:
    """Yield subsets of the given rows that, if opened, separate every pair of parts.

    For a pair with sharp points the rows of a single normal suffice. There are at most
    `MOST_CHOICES` subsets.
    """
    sharp = rows & (points.along >= 0)
    pairs = np.unique(points.pair[sharp])
    normals = [np.unique(points.along[sharp & (points.pair == pair)]) for pair in pairs]
    others = rows & ~np.isin(points.pair, pairs)
    for chosen in itertools.islice(itertools.product(*normals), MOST_CHOICES):
        yield others | (rows & np.isin(points.along, chosen))
