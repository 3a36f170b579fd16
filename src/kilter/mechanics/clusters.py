"""Clusters of an assembly: sets of free parts that touch each other.

Parts of different clusters do not touch, so clusters move independently of each other: forces
balance the assembly iff they balance each cluster, and a motion of a cluster is a motion of the
assembly.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from kilter.arrays import TINY, Array, Index, Mask, cross, starts
from kilter.mechanics.mechanics_tolerances import (
    ASIDE,
    COARSE_EXCESS,
    COARSE_EXCUSED,
    EXCESS,
    EXCUSED,
    RULED_OUT,
    SHIFT_DIGITS,
    TOLERANCE,
    UNITS_IN_LAST_PLACE,
)
from kilter.mechanics.program import ROW_FIELDS, Program
from kilter.rigid import unit

PARTED = 1500
"""Programs with more freedoms than this are solved cluster by cluster."""
GROUP = 300
"""Clusters are solved together up to this many freedoms: a solver run has a fixed cost."""
PART_FIELDS = ("mass", "inertia", "radius", "applied", "clamp", "tolerance")
"""Names of the members of a program that have an entry for each part, without the centres."""


@dataclass(frozen=True, slots=True, eq=False)
class Cluster:
    """Program in which only the parts of a cluster are free, and the indices of its rows.

    `rows`, shape (k,): indices of its rows in the program of the assembly.
    """

    program: Program
    rows: Index


def clusters(program: Program) -> list[Cluster]:
    """Divide a program into clusters (sets of free parts that touch), ordered by first part.

    Rows between held parts belong to no cluster.
    """
    return _divided(program, program.clusters)


def cluster_groups(program: Program) -> list[Cluster]:
    """Divide a large program into groups of clusters that are solved one after the other.

    The time of a solver grows faster than the size of a program, so the groups are as small as
    the fixed cost of a solver run permits (`GROUP`). A program of at most `PARTED` freedoms, or
    with straps of a capacity, whose pieces pull equally, is a single group.
    """
    per = len(program.freedoms)
    if per * int(program.free.sum()) <= PARTED or program.has_limits:
        return [Cluster(program, np.arange(len(program.part_a)))]
    label = program.clusters
    numbers, count = np.unique(label[program.free], return_counts=True)
    group_of = np.full(len(label), -1)
    group, size = -1, GROUP
    for number, freedoms in zip(numbers.tolist(), (per * count).tolist(), strict=True):
        if size + freedoms > GROUP:
            group, size = group + 1, 0
        group_of[number] = group
        size += freedoms
    return _divided(program, np.where(label >= 0, group_of[label], -1))


def different_clusters(parted: list[Cluster], frames: Array | None = None) -> Index:
    """Position of the first cluster that is equal to each cluster up to a shift, shape (n,).

    Equal clusters have the same masses, loads and rows in the same order, so they have the same
    limits. With `frames`, shape (n, 3, 3), clusters are compared in these frames, whatever the
    order of their rows.
    """
    first: dict[bytes, int] = {}
    each = [None] * len(parted) if frames is None else frames
    keys = (_shifted(c.program, frame) for c, frame in zip(parted, each, strict=True))
    return np.array([first.setdefault(key, k) for k, key in enumerate(keys)])


def upright_frames(parted: list[Cluster]) -> Array:
    """The frame of each cluster, shape (n, 3, 3), from its form: the last row is down.

    Clusters that are equal up to a shift and a turn about the vertical are equal in these frames.
    """
    return np.array([_upright_frame(cluster.program) for cluster in parted])


def _upright_frame(program: Program) -> Array:
    """Rotation matrix: its last row is down, its first row is towards the first point aside."""
    free, down = np.flatnonzero(program.free), program.down
    arm = np.concatenate([program.center[free], program.point]) - program.center[free[0]]
    aside = arm - np.outer(arm @ down, down)
    far = np.flatnonzero(np.linalg.norm(aside, axis=1) > ASIDE * program.radius[free].max())
    if program.planar or not len(far):
        return np.eye(3)
    along = unit(aside[far[0]])
    return np.array([along, cross(down, along), down])


def first_groups(program: Program, parted: list[Cluster], first: Index) -> list[Program]:
    """Programs of groups (`cluster_groups`) of the clusters that come first among equal ones."""
    if len(parted) > 1:
        used = [parted[k] for k in np.unique(first).tolist()]
        free = np.any([cluster.program.free for cluster in used], axis=0)
        rows = np.sort(np.concatenate([cluster.rows for cluster in used]))
        program = replace(program, free=free).taking(rows)
    return [group.program for group in cluster_groups(program)]


def limit_groups(program: Program) -> list[Program]:
    """Programs whose limits together are those of a program: the least limit is that of all.

    Of clusters that are equal up to a shift and a turn about the vertical, the groups contain the
    first.
    """
    parted = [] if program.has_limits else clusters(program)
    return first_groups(program, parted, different_clusters(parted, upright_frames(parted)))


def _shifted(program: Program, frame: Array | None) -> bytes:
    """Rows, masses and loads of the free parts, relative to the first of them, as a key.

    With a `frame`, shape (3, 3), vectors are turned into it, and the rows are sorted.
    """
    free = np.flatnonzero(program.free)
    number = np.full(len(program.names) + 1, -1)
    number[free] = np.arange(len(free))
    origin, size = program.center[free[0]], float(program.radius[free].max())
    turn = np.eye(3) if frame is None else frame.T
    rows = {name: getattr(program, name) for name in ROW_FIELDS}
    rows |= {name: number[rows[name]] for name in ("part_a", "part_b")}
    rows |= {"point": (program.point - origin) @ turn / size, "normal": program.normal @ turn}
    if frame is not None:
        places = np.round(np.hstack([rows["point"], rows["normal"]]), SHIFT_DIGITS) + 0.0
        order = np.lexsort([*places.T, rows["kind"], rows["part_b"], rows["part_a"]])
        rows = {name: values[order] for name, values in rows.items()}
    _, seen, source = np.unique(rows["source"], return_index=True, return_inverse=True)
    rows["source"] = seen[source]
    parts = {name: getattr(program, name)[free] for name in PART_FIELDS}
    parts["inertia"] = turn.T @ parts["inertia"] @ turn
    for name in ("applied", "clamp"):
        parts[name] = (parts[name].reshape(-1, 2, 3) @ turn).reshape(-1, 6)
    data = [*rows.values(), *parts.values(), (program.center[free] - origin) @ turn / size]
    return b"".join(_rounded_bytes(values) for values in data)


def _rounded_bytes(values: Any) -> bytes:
    """Entries of an array, rounded relative to the power of 2 above the largest, as a key."""
    if values.dtype.kind != "f":
        return np.ascontiguousarray(values).tobytes()
    finite = np.abs(values[np.isfinite(values)])
    exponent = int(np.frexp(finite.max(initial=0.0))[1])
    rounded = np.round(np.ldexp(values, -exponent), SHIFT_DIGITS) + 0.0
    return bytes(str(exponent), "ascii") + np.ascontiguousarray(rounded).tobytes()


def _divided(program: Program, label: Index) -> list[Cluster]:
    """Divide a program by the label of each free part; no row joins parts of different labels."""
    count = len(label)
    label = np.append(label, -1)
    of_row = np.maximum(label[program.part_a], label[program.part_b])
    numbers = np.unique(label[:-1][program.free])
    if len(numbers) == 1 and (of_row >= 0).all():
        return [Cluster(program, np.arange(len(of_row)))]
    order = np.argsort(of_row, kind="stable")[int((of_row < 0).sum()) :]
    start = starts(np.bincount(of_row[of_row >= 0], minlength=count))
    parted = []
    for number in numbers.tolist():
        rows = order[start[number] : start[number + 1]]
        parted.append(Cluster(replace(program, free=label[:-1] == number).taking(rows), rows))
    return parted


# Limits of both kinds of proof, and why no assembly has forces and a motion that both pass.


def balanced_parts(
    program: Program, imbalance: Array, weight: Array, sums: Array, pressed: Array
) -> tuple[Array, Mask]:
    """Apply the limits of a proof by forces to each part.

    Arguments: `imbalance`, `weight`, `sums` (..., N): imbalance |r_i|, weight W_i, and sum S_i of
    the forces on each part [N]; `pressed` (..., N): sum of the forces on each part without the pull
    of bonds [N]. Returns `relative` (..., N): imbalance over the weight; 0 for held parts [-];
    `balanced` (..., N): parts that are in balance, or held.
    """
    label, free = program.clusters, program.free
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
    label, bounded = program.clusters, program.bounded
    moved = np.zeros(len(label) + 1, dtype=bool)
    moved[label[program.free & (sizes > 0)]] = True
    moves = moved[label] & program.free
    rounding = _row_rounding(program, sizes)
    closing = np.where(program.two_sided, np.abs(opening), np.maximum(-opening, 0.0))
    kept = np.where(program.two_sided, -closing, opening)
    rounded = np.maximum((1.0 + mu) * rounding - kept, 0.0)
    limits = program.cohesion.copy()
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
