"""Limits of both kinds of proof, and why no assembly has forces and a motion that both pass.

Part i has the weight W_i (with the sizes of its loads) and the tolerance eps_i. The free parts of a
cluster c touch each other; M_c is their weight. Forces f in their cones leave the imbalance r_i on
part i, and S_i is the sum of their sizes on it. T_k is the pull of the bond of row k, so its force
f_k >= 0 is counted from T_k, and T_i is the sum of the pulls on part i. Forces are a proof only if

    |r_i| <= eps_i W_i + rho_i T_i + e_i,   e_i <= rho_i S_i, xi_i W_i   for every part
    sum e_i <= delta_c M_c,     sum (f_k - T_k)+ <= L M_c  for every cluster

so e_i is what rounding of the forces explains, and no squeeze excuses more. A motion q, with a
fastest part of size |q_i| = 1, closes row k by v_k = max(mu |u_t| - u_n, 0). It is a proof only if
its power P (less the power that bonds, straps and joint friction take up) exceeds

    sum |q_i| (eps_i W_i + rho_i T_i) + min(A, B),   summed over the clusters that it moves
    A = sum (delta_c + L v) M_c + sum T_k v_k
    B = sum L v' M_c + sum T_k v'_k + sum of limits times g_k

with v, v' the largest v_k, v'_k = max(v_k + g_k - max(u_n - mu |u_t|, 0), 0), and the rounding
g_k = (1 + mu) (rho_a |q_a| + rho_b |q_b|) of the row between the parts a and b.

Theorem: no assembly has forces and a motion that both pass. Proof: with J^T f + w = r,

    P <= sum |r_i| |q_i| + sum f_k v_k
      <= sum |q_i| (eps_i W_i + rho_i T_i) + sum e_i |q_i| + sum (f_k - T_k)+ v_k + sum T_k v_k

and sum e_i |q_i| <= sum delta_c M_c gives A. With e_i <= rho_i S_i instead, the same sum is at most
sum f_k g_k, and rows that open by more than g_k drop out: B. In the band between the limits of
both kinds rounding lets neither pass. Its width, for exact data, is at most 2e-9 of the weight if
the motion closes contacts by less than 1e-15, the usual case.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from kilter.arrays import TINY, Array, Index, Mask
from kilter.mechanics.clusters import cluster_labels
from kilter.mechanics.mechanics_tolerances import (
    COARSE_EXCESS,
    COARSE_EXCUSED,
    EXCESS,
    EXCUSED,
    RULED_OUT,
    TOLERANCE,
    UNITS_IN_LAST_PLACE,
)
from kilter.mechanics.program import Program

__all__ = ["PowerLimit", "balanced_parts", "power_limit", "pressing_forces"]


def balanced_parts(
    program: Program, imbalance: Array, weight: Array, sums: Array, pressed: Array
) -> tuple[Array, Mask]:
    """Apply the limits of a proof by forces to each part.

    Arguments: `imbalance`, `weight`, `sums` (..., N): imbalance |r_i|, weight W_i, and sum S_i of
    the forces on each part [N]; `pressed` (..., N): sum of the forces on each part without the pull
    of bonds [N]. Returns `relative` (..., N): imbalance over the weight; 0 for held parts [-];
    `balanced` (..., N): parts that are in balance, or held.
    """
    label, free = cluster_labels(program), program.free
    relative = np.where(free, imbalance / np.maximum(weight, TINY), 0.0)
    usual = program.tolerance * weight
    if program.pull.any():
        usual = usual + _roundings(program) * program.force_sums(program.pull)
    excess = np.where(free, np.maximum(imbalance - usual, 0.0), 0.0)
    coarse = program.tolerance > TOLERANCE
    # parts far lighter than their cluster: its share is more than their whole weight
    most = np.where(coarse, COARSE_EXCUSED, EXCUSED) * weight
    balanced = excess <= np.minimum(_roundings(program) * sums, most)
    # most forces are small: only others need the sums of their cluster
    small = excess.max(initial=0.0) == 0.0 and bool(
        (pressed <= RULED_OUT * weight)[..., free].all()
    )
    if not small:
        total = _of_cluster(weight, label)
        balanced &= _of_cluster(excess, label) <= _cluster_shares(program, label) * total
        balanced &= _of_cluster(pressed, label) <= RULED_OUT * total
    return relative, balanced | ~free


def pressing_forces(program: Program, forces: Array) -> Array:
    """Row forces, shape (..., K), less the pull of bonds: the forces that a squeeze can enlarge."""
    return np.where(program.two_sided, forces, np.maximum(forces - program.pull, 0.0))


def _roundings(program: Program) -> Array:
    """Rounding rho_i of the forces on each part, over their sum, shape (N,) [-]."""
    coarse = program.tolerance > TOLERANCE
    return np.where(coarse, program.tolerance, UNITS_IN_LAST_PLACE)


def _cluster_shares(program: Program, label: Index) -> Array:
    """Share delta_c of the weight of the cluster of each part, shape (N,) [-]."""
    coarse = program.tolerance > TOLERANCE
    most = np.zeros(len(label) + 1)
    np.maximum.at(most, label, np.where(coarse, COARSE_EXCESS * program.tolerance, EXCESS))
    shares: Array = most[label]
    return shares


def _of_cluster(values: Array, label: Index) -> Array:
    """Sum of the values, shape (..., N), over the free parts of the cluster of each part."""
    free = np.flatnonzero(label >= 0)
    total = np.zeros((*values.shape[:-1], len(label) + 1))
    place: tuple[Any, ...] = (..., label[free])
    np.add.at(total, place, values[..., free])
    summed: Array = total[..., label]
    return summed


@dataclass(frozen=True, slots=True, eq=False)
class PowerLimit:
    """Power that a motion must exceed to be a proof, as shares of weights and of strengths."""

    parts: Array
    """Tolerance times size of the motion of each part [-], shape (N,)."""
    shares: Array
    """Share of the weight of each part in A and in B [-], shape (2, N)."""
    strength: Array
    """Power of the strength of the bond, strap or joint of each row in A and in B [W], shape (2,
    K)."""

    def largest(self, weight: Array) -> float:
        """Least power of a proof [W] for every load with weights in the hull of the rows, (n, N).

        The weight of a part is a convex function of its load.
        """
        more = (weight @ self.shares.T + self.strength.sum(axis=1)).max(axis=0).min()
        return float((weight @ self.parts).max() + more)


def power_limit(
    program: Program,
    opening: Array,
    sizes: Array,
    *,
    mu: Array | None = None,
    owner: Index | None = None,
) -> PowerLimit:
    """The power that a motion of size 1 must exceed to be a proof.

    Arguments: `opening` (K,); `sizes` (N,); `mu` (K,); `owner` (N,).
    """
    mu = program.mu if mu is None else mu
    owner = np.zeros(len(sizes), dtype=int) if owner is None else owner
    label, bounded = cluster_labels(program), program.bounded
    moved = np.zeros(len(label) + 1, dtype=bool)
    moved[label[program.free & (sizes > 0)]] = True
    moves = moved[label] & program.free
    rounding = _row_rounding(program, sizes)
    closing = np.where(program.two_sided, np.abs(opening), np.maximum(-opening, 0.0))
    kept = np.where(program.two_sided, -closing, opening)
    rounded = np.maximum((1.0 + mu) * rounding - kept, 0.0)
    limits = program.cohesion
    limits[bounded] = program.capacity[bounded] / program.arm[bounded]
    closing[bounded] = rounded[bounded] = 0.0
    row_owner = owner[np.maximum(program.part_a, program.part_b)]
    most = np.zeros((2, int(owner.max(initial=0)) + 1))
    np.maximum.at(most[0], row_owner, closing)
    np.maximum.at(most[1], row_owner, rounded)
    shares = RULED_OUT * most[:, owner]
    shares[0] += _cluster_shares(program, label)
    return PowerLimit(
        np.where(program.free, program.tolerance * sizes, 0.0),
        np.where(moves, shares, 0.0),
        np.stack([np.zeros(len(limits)), limits * rounding])
        + program.pull * (np.stack([closing, rounded]) + rounding),
    )


def _row_rounding(program: Program, sizes: Array) -> Array:
    """Rounding of a unit force of each row, times the sizes of a motion of its parts, (K,)."""
    moved = np.append(np.where(program.free, _roundings(program) * sizes, 0.0), 0.0)
    # the force of an angular row is counted over its arm, and on a part over the radius
    inverse = np.append(1.0 / program.radius, 1.0)
    total = np.zeros(len(program.part_a))
    for part in (program.part_a, program.part_b):
        total += moved[part] * np.where(program.angular, program.arm * inverse[part], 1.0)
    return total
