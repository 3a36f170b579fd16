"""Search for equilibrium forces that exclude every neutral motion."""

from __future__ import annotations

import numpy as np

from kilter.arrays import Array
from kilter.mechanics.program import Program
from kilter.second_order.gaps.joint_forms import on_joints
from kilter.second_order.proofs.held import Held, judge_held, scaled_rows

__all__ = ["find_held"]

FULL = 1e-12
"""J has full rank if the least eigenvalue of J^T J over its largest entry is above this [-]."""
ROUNDS = 50
"""Largest number of rounds in which forces are redistributed over the contacts."""
SHARE = 0.02
"""Least force of a contact at which redistribution aims, over the mean force; half is enough."""


def find_held(program: Program, forces: Array) -> Held | None:
    """Make a proof of held parts from equilibrium forces, (K,) [N]; None if it would fail."""
    if len(forces) < int(program.free.sum()) * len(program.freedoms):
        return None  # fewer rows than freedoms: a motion opens no contact, whatever the forces
    if not judge_held(program, Held(forces)):
        return Held(forces)
    if not forces.any():
        return None
    spread = _spread_out(program, forces)
    return None if spread is None or judge_held(program, Held(spread)) else Held(spread)


def _spread_out(program: Program, forces: Array) -> Array | None:
    """Equilibrium forces near the given forces that push at every contact; None if not found."""
    if on_joints(program).any():
        return None  # the forces of joints are not to be made positive
    rows = scaled_rows(program)
    gram = (rows.T @ rows).toarray()
    try:
        np.linalg.cholesky(gram - FULL * gram.diagonal().max(initial=0.0) * np.eye(len(gram)))
    except np.linalg.LinAlgError:
        return None  # some motion opens no contact: it stays neutral under all forces
    inverse = np.linalg.inv(gram)
    least = SHARE * float(forces.mean())
    spread = forces
    for _ in range(ROUNDS):
        change = np.maximum(spread, least) - forces
        spread = forces + change - rows @ (inverse @ (rows.T @ change))
        if spread.min() > least / 2:
            return np.asarray(spread)
    return None
