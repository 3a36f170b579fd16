"""Friction coefficients: of the contact itself, else of its pair, else of the assembly."""

from __future__ import annotations

import numpy as np

from kilter.arrays import Array, Index
from kilter.assembly import Assembly

__all__ = ["certain_friction", "friction_coefficients"]


def friction_coefficients(
    assembly: Assembly, parts: Index, given: Array | None = None, *, greatest: bool = False
) -> Array:
    """Friction coefficients [-] of contacts between pairs of parts, shape (n,).

    The pieces that touch are unknown here. The coefficient is the least of all pieces of the pair,
    which is certain, or the greatest.

    Parameters
    ----------
    assembly : Assembly
    parts : ndarray of int, shape (n, 2)
        Parts of each contact, by position.
    given : ndarray, shape (n,), optional
        Friction coefficient that is known for each contact; NaN: that of its pair [-].
    greatest : bool
        Whether the greatest coefficient of the pieces is returned instead of the least.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> friction_coefficients(scene("tower"), np.array([[0, 1], [1, 2]]), np.array([np.nan, 0.5]))
    array([0. , 0.5])
    """
    mu = np.full(len(parts), assembly.friction)
    if assembly.friction_pairs:
        by_pair: dict[frozenset[int], list[float]] = {}
        whole = set[frozenset[int]]()
        for entry in assembly.friction_pairs:
            pair = frozenset(assembly.index_of(name) for name in entry.parts)
            by_pair.setdefault(pair, []).append(entry.mu)
            if entry.pieces is None:
                whole.add(pair)
        of_pieces = max if greatest else min
        for pair, values in by_pair.items():
            values += [] if pair in whole else [assembly.friction]
        for k, ends in enumerate(parts.tolist()):
            values = by_pair.get(frozenset(ends), [])
            mu[k] = of_pieces(values, default=mu[k])
    return mu if given is None else np.where(np.isnan(given), mu, given)


def certain_friction(mu: Array | float, doubt: Array) -> Array:
    """Friction coefficient that remains for every normal within the error `doubt`, shape (n,).

    A force within the angle mu - doubt of the fitted normal lies within mu of the true normal.

    Examples
    --------
    >>> certain_friction(0.5, np.array([0.0, 0.125, 1.0]))
    array([0.5  , 0.375, 0.   ])
    """
    certain: Array = np.maximum(mu - doubt, 0.0)
    return certain
