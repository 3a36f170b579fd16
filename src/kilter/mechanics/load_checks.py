"""Checks of forces under several loads on the same parts, by the criteria of single proofs.

The forces f_i of the load i prove that it is carried if J^T f_i + w + more_i vanishes up to the
tolerances of `kilter.mechanics.certificate`. All loads are checked in the same array operations.
"""

from __future__ import annotations

import numpy as np

from kilter.arrays import Array
from kilter.mechanics.certificate import ForceProof, check_forces, part_sizes
from kilter.mechanics.clusters import balanced_parts
from kilter.mechanics.program import Program


def shifted_weights(program: Program, more: Array) -> Array:
    """Weight of each part (`Program.weight`) with more load on the parts [N], shape (n, N).

    `more`, shape (n, N, 6), has the wrenches of n loads that are added.
    """
    applied = program.applied + more
    force = np.sqrt((applied[..., :3] ** 2).sum(axis=-1))
    torque = np.sqrt((applied[..., 3:] ** 2).sum(axis=-1)) / program.radius
    weight: Array = program.mass * program.g + force + torque
    return weight


def check_load_forces(
    program: Program, more: Array, forces: Array, friction: Array | None = None
) -> list[ForceProof]:
    """Check forces as proofs that each of several loads is in equilibrium.

    Arguments: `more` (n, N, 6): wrenches that each load adds to the load of the program; `forces`
    (n, K): along the rows [N]; `friction` (n, K, 3): across the contact rows, on part b [N].
    """
    if friction is not None or len(program.bounded) or program.pull.any():
        across = [None] * len(more) if friction is None else list(friction)
        return [
            check_forces(program.with_rows(applied=program.applied + load), along, aside)
            for load, along, aside in zip(more, forces, across, strict=True)
        ]
    count, parts = len(more), len(program.names)
    # no row has a capacity, a bond or friction here
    forces = np.where(np.isfinite(forces), forces, 0.0)
    forces = np.where(program.two_sided, forces, np.maximum(forces, 0.0))
    wrenches, sums = np.zeros((count, parts, 6)), np.zeros((count, parts))
    each = np.arange(count)[:, None] * parts
    for part, sign in ((program.part_b, 1.0), (program.part_a, -1.0)):
        rows = np.flatnonzero(part >= 0)
        lever, along = sign * program.lever(rows, part[rows]), forces[:, rows]
        place = (each + part[rows]).ravel()
        for axis in range(6):
            total = np.bincount(place, (along * lever[:, axis]).ravel(), count * parts)
            wrenches[..., axis] += total.reshape(count, parts)
        # a torque over the radius of the part is a force
        size = np.abs(along) / np.where(program.angular[rows], program.radius[part[rows]], 1.0)
        sums += np.bincount(place, size.ravel(), count * parts).reshape(count, parts)
    weight = shifted_weights(program, more)
    load = program.load + np.where(program.free[:, None], more, 0.0)
    imbalance = part_sizes(program, wrenches + load, per_radius=True)
    relative, balanced = balanced_parts(program, imbalance, weight, sums, sums)
    none = np.zeros((len(program.part_a), 3))
    return [
        ForceProof(along, none, float(share.max(initial=0.0)), bool(holds.all()))
        for along, share, holds in zip(forces, relative, balanced, strict=True)
    ]
