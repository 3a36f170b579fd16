"""Checks of forces under several loads on the same parts, by the criteria of single proofs.

The forces f_i of the load i prove that it is carried if J^T f_i + w + more_i vanishes up to the
tolerances of `kilter.mechanics.certificate`. All loads are checked in the same array operations.
"""

from __future__ import annotations

import numpy as np

from kilter.arrays import Array, Index, cross
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
    if program.has_limits or program.pull.any() or program.planar:
        aside = [None] * len(more) if friction is None else list(friction)
        return [
            check_forces(program.with_rows(applied=program.applied + load), along, friction_of)
            for load, along, friction_of in zip(more, forces, aside, strict=True)
        ]
    # no row has a capacity or a bond here
    forces = np.where(np.isfinite(forces), forces, 0.0)
    forces = np.where(program.two_sided, forces, np.maximum(forces, 0.0))
    across = np.zeros((*forces.shape, 3))
    if friction is not None and len(program.rough):
        across[:, program.rough] = _within_cones(program, forces, friction)
    wrenches, sums = _sums_on_parts(program, forces, across)
    weight = shifted_weights(program, more)
    load = program.load + np.where(program.free[:, None], more, 0.0)
    imbalance = part_sizes(program, wrenches + load, per_radius=True)
    relative, balanced = balanced_parts(program, imbalance, weight, sums, sums)
    return [
        ForceProof(along, aside, float(share.max(initial=0.0)), bool(holds.all()))
        for along, aside, share, holds in zip(forces, across, relative, balanced, strict=True)
    ]


def _within_cones(program: Program, forces: Array, friction: Array) -> Array:
    """Friction at the rough rows, moved into Coulomb's cones, shape (n, R, 3)."""
    rough = program.rough
    across = np.where(np.isfinite(friction[:, rough]), friction[:, rough], 0.0)
    normal = program.normal[rough]
    across = across - np.einsum("nij,ij->ni", across, normal)[..., None] * normal
    length = np.linalg.norm(across, axis=2)
    limit = program.mu[rough] * forces[:, rough]
    # the factor is exactly 1 inside the cone
    shrink = limit / np.maximum(np.maximum(length, limit), np.finfo(float).tiny)
    clipped: Array = across * shrink[..., None]
    return clipped


def _sums_on_parts(program: Program, forces: Array, across: Array) -> tuple[Array, Array]:
    """Wrenches of row forces on each part, (n, N, 6), and sums of their sizes, (n, N) [N]."""
    count, parts = len(forces), len(program.names)
    wrenches, sums = np.zeros((count, parts, 6)), np.zeros((count, parts))
    each, rubbing = np.arange(count)[:, None] * parts, across.any(axis=(0, 2))
    size = np.hypot(np.abs(forces), np.linalg.norm(across, axis=2))

    def add(total: Array, place: Index, values: Array) -> None:
        total += np.bincount(place.ravel(), values.ravel(), count * parts).reshape(count, parts)

    for part, sign in ((program.part_b, 1.0), (program.part_a, -1.0)):
        rows = np.flatnonzero(part >= 0)
        lever, along = sign * program.lever(rows, part[rows]), forces[:, rows]
        rubs = np.flatnonzero((part >= 0) & rubbing)
        aside = sign * across[:, rubs]
        moment = cross(program.point[rubs] - program.center[part[rubs]], aside)
        for axis in range(6):
            add(wrenches[..., axis], each + part[rows], along * lever[:, axis])
            if len(rubs):
                values = aside[..., axis] if axis < 3 else moment[..., axis - 3]
                add(wrenches[..., axis], each + part[rubs], values)
        # a torque over the radius of the part is a force
        arm = np.where(program.angular[rows], program.radius[part[rows]], 1.0)
        add(sums, each + part[rows], size[:, rows] / arm)
    return wrenches, sums
