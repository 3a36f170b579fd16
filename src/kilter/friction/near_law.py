"""Quick test of how much a candidate motion violates Coulomb's law, in scaled unknowns.

A search makes thousands of candidates, and few deserve an exact check
(`kilter.mechanics.law_check`), or to be made exact (`kilter.friction.polish`). In the unknowns of
`kilter.friction.law` all scales are known already, so the same six residuals cost a tenth. No
motion that the test rejects would pass the exact check, and `check_law` checks every motion that it
accepts.

The *breach* is the gain of a candidate by violating the law,

    sum of f_n u_n + f_t.u_t + mu f_n |u_t|        0 for every motion that obeys it

which polishing must remove from the candidates of contact modes, optima of relaxations.
"""

from __future__ import annotations

import numpy as np

from kilter.arrays import TINY, Array
from kilter.friction.law import CoulombLaw
from kilter.mechanics.mechanics_tolerances import STILL, WITNESS_EXACT, WITNESS_SLIVER

__all__ = ["breach", "may_obey"]

ROUNDING = 2.0
"""Allowance for rounding: factor by which a residual may exceed the limit of the full check."""


def breach(law: CoulombLaw, x: Array, forces: Array) -> float:
    """Power that a candidate motion gains because it violates the law [-]; 0 if it obeys."""
    u = (law.matrix @ x).reshape(-1, 3)
    slip = np.linalg.norm(u[:, 1:], axis=1)
    gained = (forces * u).sum(axis=1) + law.mu * forces[:, 0] * slip
    return float(gained[~law.tied].sum())


def may_obey(law: CoulombLaw, x: Array, forces: Array) -> bool:
    """True if a candidate motion gains power and nearly obeys the law, so it deserves a check."""
    size = float(x @ x)
    if not float(law.load @ x) > 0.0:
        return False
    limit = ROUNDING * min(WITNESS_EXACT * np.sqrt(size), WITNESS_SLIVER * size)
    balance = np.linalg.norm(x - law.load - law.matrix.T @ forces.reshape(-1))
    return bool(balance <= limit) and _law_residual(law, x, forces, np.sqrt(size)) <= limit


def _law_residual(law: CoulombLaw, x: Array, forces: Array, fastest: float) -> float:
    """Largest violation of the contact law by a candidate, over the kinds of `LawProof` [-]."""
    u, tied = (law.matrix @ x).reshape(-1, 3), law.tied
    u_n, f_n, u_t, f_t = u[:, 0], forces[:, 0], u[:, 1:], forces[:, 1:]
    slip, drag = np.linalg.norm(u_t, axis=1), np.linalg.norm(f_t, axis=1)
    limit = law.mu * np.maximum(f_n, 0.0)
    rows = [
        np.where(tied, np.abs(u_n), -u_n),
        np.where(tied, drag, np.maximum(drag - limit, -f_n)),
        np.where(tied, 0.0, np.abs(u_n * f_n)),
    ]
    slides = ~tied & (slip > STILL * fastest)
    along = u_t[slides] / np.maximum(slip[slides], TINY)[:, None]
    rows += [
        np.linalg.norm(f_t[slides] + drag[slides, None] * along, axis=1),
        np.abs(drag - limit)[slides],
    ]
    return max(float(row.max(initial=0.0)) for row in rows)
