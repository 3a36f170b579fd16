"""The search for forces of equilibrium that leave nothing neutral."""

from __future__ import annotations

import numpy as np

from kilter.arrays import Array
from kilter.mechanics.program import Program
from kilter.second_order.proofs.held import Held, judge_held, scaled_rows

__all__ = ["find_held"]

FULL = 1e-12
"""Least eigenvalue of J^T J over its largest entry, where rows of full rank are told."""
ROUNDS = 50
"""Of spreading, ..."""
SHARE = 0.02
"""... until every contact carries this share of the mean force, or half of it."""


def find_held(program: Program, forces: Array) -> Held | None:
    """A proof from forces of equilibrium, shape (K,) [N]; None where none was found."""
    if not judge_held(program, Held(forces)):
        return Held(forces)
    if not forces.any():
        return None
    spread = _spread_out(program, forces)
    return None if spread is None or judge_held(program, Held(spread)) else Held(spread)


def _spread_out(program: Program, forces: Array) -> Array | None:
    """Forces of equilibrium on every contact, near to some: projected and cut in turn."""
    rows = scaled_rows(program)
    gram = (rows.T @ rows).toarray()
    try:
        np.linalg.cholesky(gram - FULL * gram.diagonal().max(initial=0.0) * np.eye(len(gram)))
    except np.linalg.LinAlgError:
        return None  # a motion opens nothing
    inverse = np.linalg.inv(gram)
    least = SHARE * float(forces.mean())
    found = forces
    for _ in range(ROUNDS):
        change = np.maximum(found, least) - forces
        found = forces + change - rows @ (inverse @ (rows.T @ change))
        if found.min() > least / 2:
            return np.asarray(found)
    return None
