"""Parts that level faces below allow to move level only, by rule, at any number of parts."""

from __future__ import annotations

import numpy as np

from kilter.arrays import Array, Mask
from kilter.mechanics.program import Program
from kilter.mechanics.rows import CONTACT
from kilter.second_order.second_order_tolerances import BENDS, SPREAD

__all__ = ["spread_over", "spread_wrench", "steady_parts"]

SHARE, ROUNDS = 1e-3, 60
"""Least force of a point of a patch, over the mean force [-], and number of rounds to reach it."""


def steady_parts(program: Program, forces: Array, flat: Mask) -> Mask:
    """Mask of free parts that level faces below allow to move level only, shape (N,).

    The points of the faces of held or steady parts below do not sink. Where they press, they do not
    rise either. So the part keeps its height and tilt if its centre of pressure is within the hull
    of all these points: their forces can be spread so that all of them press.

    Arguments: `forces` (K,): forces of an equilibrium [N]; `flat` (K,): rows of contacts that are
    not curved.
    """
    upright = np.linalg.norm(np.cross(program.normal, program.down), axis=1) < BENDS
    rows = np.flatnonzero(flat & upright & (program.kind == CONTACT))
    fixed = np.append(~program.free, True)
    lifts_b = program.normal[rows] @ program.down < 0
    upper = np.where(lifts_b, program.part_b[rows], program.part_a[rows])
    lower = np.where(lifts_b, program.part_a[rows], program.part_b[rows])
    order = np.argsort(upper, kind="stable")
    parts, start = np.unique(upper[order], return_index=True)
    at = dict(zip(parts.tolist(), np.split(order, start[1:] if len(rows) else []), strict=False))
    above: dict[int, set[int]] = {}
    for high, low in zip(upper.tolist(), lower.tolist(), strict=True):
        above.setdefault(low, set()).add(high)
    need = 2 if program.planar else 3
    todo = [part for part in at if not fixed[part]]
    while todo:
        part = todo.pop()
        mine = at[part][fixed[lower[at[part]]]]
        if fixed[part] or len(mine) < need:
            continue
        lever = program.lever(rows[mine], np.full(len(mine), part))[:, program.freedoms]
        lever = lever / np.where(program.freedoms < 3, 1.0, program.radius[part])
        values = np.linalg.svd(lever, compute_uv=False) ** 2
        wide = len(values) >= need and values[need - 1] > SPREAD * values[0]
        if wide and spread_over(lever, forces[rows[mine]]) is not None:
            fixed[part] = True
            todo += [k for k in above.get(part, ()) if not fixed[k]]
    return np.asarray(fixed[:-1] & program.free)


def spread_over(lever: Array, forces: Array) -> Array | None:
    """Forces that press at every point with the wrench of given forces, (k,); None if not found.

    `lever`, shape (k, m): wrench of a unit force at each point.
    """
    total = float(forces.sum())
    if total <= 0.0 or (forces < 0).any():
        return None
    if forces.min() > SHARE * total / len(forces):
        return forces
    return spread_wrench(lever, lever.T @ forces, total)


def spread_wrench(lever: Array, wrench: Array, total: float) -> Array | None:
    """Forces of a given total that press at every point with a given wrench, (k,); or None."""
    if total <= 0.0:
        return None
    least = SHARE * total / len(lever)
    inverse = np.linalg.pinv(lever.T, rcond=1e-9)
    spread = np.full(len(lever), total / len(lever))
    for _ in range(ROUNDS):
        spread = spread + inverse @ (wrench - lever.T @ spread)
        if spread.min() > least:
            return np.asarray(spread)
        spread = np.maximum(spread, 2 * least)
    return None
