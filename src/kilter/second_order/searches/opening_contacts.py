"""The search for a motion that opens contacts, by a linear program."""

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
"""Choices of normals that are tried, one of each pair."""


def opening_motion(rows: Array, work: Work | None) -> Array | None:
    """Of motions x, shape (f,), the one that opens rows (s, f) most; None where none opens all.

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
    """Some of these rows that it is enough to open: of each pair at points those of one normal.

    Of up to `MOST_CHOICES` such choices.
    """
    own = rows & (points.along >= 0)
    pairs = np.unique(points.pair[own])
    normals = [np.unique(points.along[own & (points.pair == one)]) for one in pairs]
    others = rows & ~np.isin(points.pair, pairs)
    for chosen in itertools.islice(itertools.product(*normals), MOST_CHOICES):
        yield others | (rows & np.isin(points.along, chosen))
