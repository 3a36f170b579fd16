"""Programs of many assemblies in shared arrays: scaled, solved and checked together.

The equations are those of `kilter.mechanics.forms` and the proofs those of
`kilter.mechanics.certificate`, with the gravity, common frame and unit of force of each assembly.
Results are identical to those of single programs: `ProgramBlocks.program` returns a single program
to verify it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.sparse import csc_array

from kilter.arrays import Array, Index, Mask, across, ragged, starts
from kilter.contact.contact_set import ContactSet
from kilter.mechanics.certificate import part_sizes
from kilter.mechanics.clusters import balanced_parts, power_limit
from kilter.mechanics.mechanics_tolerances import ZERO_ENTRY
from kilter.mechanics.program import Program, build_program
from kilter.mechanics.stacked_parts import stack_answers
from kilter.rigid import common_frames
from kilter.solvers.highs import BlockAnswers, Blocks

if TYPE_CHECKING:
    from kilter.assembly.array_geometry import SideBySide


@dataclass(frozen=True, slots=True, eq=False)
class BlockProofs:
    """Checked forces and a checked motion for each of M programs."""

    stable: Mask
    unstable: Mask
    """Exactly one proof holds, shape (M,): the forces, or the motion."""
    residual: Array
    """Worst relative imbalance of the forces [-], shape (M,)."""
    power: Array
    violation: Array
    """Power [W at 1 m/s] and violation [-] of the motion, as in `MotionProof`, shape (M,)."""
    forces: Array
    """Forces of the rows [N], shape (K,)."""
    motion: Array
    """Motion of all parts, shape (N, 6); the fastest part of each program moves by 1."""


@dataclass(frozen=True)
class ProgramBlocks:
    """Programs of M frictionless assemblies without joints, in shared arrays."""

    whole: Program
    """All parts, and all rows in the order of the programs; its gravity is unused."""
    start: Index
    """First part of each program, shape (M + 1,)."""
    row_start: Index
    """First row of each program, shape (M + 1,)."""
    gravity: Array
    """Gravity of each program [m/s^2], shape (M, 3)."""
    mu: Array
    """Friction coefficient of each program that a motion must overcome [-], shape (M,)."""

    @cached_property
    def owner(self) -> Index:
        """Index of the program to which each part belongs, shape (N,)."""
        return np.repeat(np.arange(len(self.gravity)), np.diff(self.start))

    @cached_property
    def row_owner(self) -> Index:
        """Index of the program to which each row belongs, shape (K,)."""
        return np.repeat(np.arange(len(self.gravity)), np.diff(self.row_start))

    @cached_property
    def level_frames(self) -> Array:
        """Rows of two horizontal unit vectors and the upward one of each program, (M, 3, 3)."""
        up = -self.gravity / np.linalg.norm(self.gravity, axis=1)[:, None]
        return np.stack([*across(up), up], axis=1)

    @cached_property
    def load(self) -> Array:
        """Weight of each part as force and torque, shape (N, 6)."""
        load = np.zeros((len(self.owner), 6))
        load[:, :3] = self.whole.mass[:, None] * self.gravity[self.owner]
        load[~self.whole.free] = 0.0
        return load

    @cached_property
    def weight(self) -> Array:
        """Weight of each part [N], shape (N,)."""
        weight: Array = self.whole.mass * np.linalg.norm(self.gravity, axis=1)[self.owner]
        return weight

    @cached_property
    def frames(self) -> Array:
        """Rotation of each program's frame, in which its wrenches are scaled, (M, 3, 3)."""
        if self.whole.planar:
            return np.tile(np.eye(3), (len(self.gravity), 1, 1))
        normal = self.whole.normal
        return common_frames(normal, np.ones(len(normal)), self.row_start)

    @cached_property
    def unit(self) -> Array:
        """Unit of force of each program, the geometric mean of its weights [N], shape (M,)."""
        free = self.whole.free
        total = np.bincount(
            self.owner[free], np.log(self.weight[free]), minlength=len(self.gravity)
        )
        count = np.bincount(self.owner[free], minlength=len(self.gravity))
        unit: Array = np.exp(total / np.maximum(count, 1))
        return unit

    def program(self, k: int) -> Program:
        """The program of the assembly with index k."""
        return self.union(np.array([k]))

    def rows(self, which: Index) -> Index:
        """Indices of the rows that belong to the assemblies `which`."""
        return ragged(self.row_start, which)[1]

    def union(self, which: Index) -> Program:
        """A single program of the assemblies `which` (ascending, equal gravity), side by side."""
        return self.among(which).whole.with_rows(gravity=self.gravity[which[0]])

    def among(self, which: Index) -> ProgramBlocks:
        """The programs of the assemblies `which` (ascending) alone."""
        if len(which) == len(self.gravity):
            return self
        whole, parts = self.whole, ragged(self.start, which)[1]
        chosen = whole.taking(self.rows(which))
        number = np.full(len(whole.names) + 1, -1)
        number[parts] = np.arange(len(parts))
        program = chosen.of_parts(parts).with_rows(
            part_a=number[chosen.part_a], part_b=number[chosen.part_b]
        )
        part_start, row_start = (starts(np.diff(s)[which]) for s in (self.start, self.row_start))
        return ProgramBlocks(program, part_start, row_start, self.gravity[which], self.mu[which])

    def upright(self, which: Index) -> Program:
        """A single program of the assemblies `which`, each turned so that its gravity is -z.

        The gravity is 1, and the mass of each part is its weight.
        """
        few = self.among(which)
        program, frames = few.whole, few.level_frames
        of_part, of_row = frames[few.owner], frames[few.row_owner]
        return program.with_rows(
            gravity=np.array([0.0, 0.0, -1.0]),
            mass=few.weight,
            center=(of_part * program.center[:, None]).sum(axis=2),
            point=(of_row * program.point[:, None]).sum(axis=2),
            normal=(of_row * program.normal[:, None]).sum(axis=2),
        )

    def parts(self, which: Index) -> Index:
        """Indices of the parts of the assemblies `which`."""
        return ragged(self.start, which)[1]

    @cached_property
    def scaled(self) -> Blocks:
        """Scaled equilibria of all programs, as in `kilter.mechanics.forms.scaled_problem`."""
        program = self.whole
        per = len(program.freedoms)
        column = np.full(len(program.names) + 1, -1)
        column[:-1][program.free] = np.arange(int(program.free.sum()))
        data = np.zeros((len(program.part_a), 2, per))
        index = np.zeros((len(program.part_a), 2, per), dtype=np.int32)
        for side, (part, sign) in enumerate(((program.part_a, -1.0), (program.part_b, 1.0))):
            rows = np.flatnonzero(column[part] >= 0)
            owner = part[rows]
            entries = self._in_frames(program.lever(rows, owner), owner)
            entries[np.abs(entries) < ZERO_ENTRY] = 0.0
            scale = self.unit[self.owner[owner]] / self.weight[owner]
            data[rows, side] = sign * entries * scale[:, None]
            index[rows, side] = column[owner][:, None] * per + np.arange(per)
        flat_data, flat_index = data.reshape(-1, 2 * per), index.reshape(-1, 2 * per)
        used = flat_data != 0
        number = int(program.free.sum())
        matrix = csc_array(
            (flat_data[used], flat_index[used], starts(used.sum(axis=1)).astype(np.int32)),
            shape=(per * number, len(data)),
        )
        free = np.flatnonzero(program.free)
        right = -self._in_frames(self.load[free], free) / self.weight[free][:, None]
        row_start = per * np.searchsorted(free, self.start)
        return Blocks(matrix, right.reshape(-1), program.two_sided, row_start, self.row_start)

    def _in_frames(self, wrenches: Array, part: Index) -> Array:
        """Wrenches on parts in the frame of their program; torques are over the radius."""
        frames = self.frames[self.owner[part]]
        turned = np.einsum("kij,kaj->kai", frames, wrenches.reshape(-1, 2, 3))
        turned[:, 1] /= self.whole.radius[part][:, None]
        counted: Array = turned.reshape(-1, 6)[:, self.whole.freedoms]
        return counted

    def stacked(self, which: Mask) -> BlockProofs:
        """Proofs of the programs in the mask `which` whose parts are stacked on level faces."""
        if self.whole.planar:
            which = np.zeros_like(which)
        answers = stack_answers(self.whole, self.start, self.level_frames, self.weight, which)
        return self.checked(answers.forces, answers.motion, answers.carried, answers.tips)

    def judged(self, answers: BlockAnswers) -> BlockProofs:
        """Check solved forces and motions by the criteria that apply to single proofs."""
        forces = answers.forces * self.unit[self.row_owner]
        forces = np.where(np.isfinite(forces), forces, 0.0)
        motion = self._motion_of(answers.multipliers)
        return self.checked(forces, motion, answers.factor > 0.5, answers.factor < 0.5)

    def checked(self, forces: Array, motion: Array, holds: Mask, falls: Mask) -> BlockProofs:
        """Check forces and motions by the criteria that apply to single proofs.

        Arguments: `forces` (K,): forces of all rows [N]; `motion` (N, 6): motion of all parts, of
        any size; `holds`, `falls` (M,): programs of which the forces, or the motion, are a
        candidate of a proof.
        """
        whole = self.whole
        forces = np.where(whole.two_sided, forces, np.maximum(forces, 0.0))
        imbalance = part_sizes(whole, whole.wrenches(forces) + self.load, per_radius=True)
        sums = whole.force_sums(forces)
        relative, in_balance = balanced_parts(whole, imbalance, self.weight, sums, sums)
        balanced = self._reduce_parts(np.logical_and, in_balance)
        motion, power, violation, moves = self._check_motions(motion)
        return BlockProofs(
            stable=balanced & holds,
            unstable=moves & falls,
            residual=self._reduce_parts(np.maximum, relative),
            power=power,
            violation=violation,
            forces=forces,
            motion=motion,
        )

    def _motion_of(self, multipliers: Array) -> Array:
        """Motion of all parts from the multipliers of the solved programs, shape (N, 6)."""
        whole, owner, per = self.whole, self.owner, len(self.whole.freedoms)
        free = np.flatnonzero(whole.free)
        columns = -multipliers.reshape(-1, per) / self.weight[free][:, None]
        motion = np.zeros((len(owner), 6))
        motion[np.ix_(free, whole.freedoms)] = np.where(np.isfinite(columns), columns, 0.0)
        motion[:, 3:] /= whole.radius[:, None]
        turned = np.einsum("nji,naj->nai", self.frames[owner], motion.reshape(-1, 2, 3))
        motion = turned.reshape(-1, 6)
        planar: Array = motion * np.array([1.0, 0, 1, 0, 1, 0])
        return planar if whole.planar else motion

    def _check_motions(self, motion: Array) -> tuple[Array, Array, Array, Mask]:
        """Motions of size 1, their power and violation, and a mask of valid proofs."""
        whole, owner = self.whole, self.owner
        sizes = part_sizes(whole, motion, per_radius=False)
        largest = self._reduce_parts(np.maximum, sizes)
        length = np.where(largest > 0, largest, 1.0)[owner]
        motion, sizes = motion / length[:, None], sizes / length
        power = self._reduce_parts(np.add, (self.load * motion).sum(axis=1))
        opening = whole.velocities(motion)
        rows = np.flatnonzero(self.mu[self.row_owner] > 0)
        if len(rows):
            slip = np.linalg.norm(whole.slips(motion, rows), axis=1)
            opening[rows] -= self.mu[self.row_owner[rows]] * slip
        violation = np.zeros(len(self.gravity))
        closing = np.where(whole.two_sided, np.abs(opening), np.maximum(-opening, 0.0))
        np.maximum.at(violation, self.row_owner, closing)
        mu = self.mu[self.row_owner]
        limit = power_limit(whole, opening, sizes, mu=mu, owner=owner)
        more = [self._reduce_parts(np.add, shares * self.weight) for shares in limit.shares]
        needed = self._reduce_parts(np.add, limit.parts * self.weight) + np.minimum(*more)
        holds = (largest > 0) & (power > needed)
        return motion, power, violation, holds

    def _reduce_parts(self, reduce: np.ufunc, values: Array | Mask) -> Any:
        """Reduce values of the parts by a ufunc to one value for each assembly, shape (M,)."""
        return reduce.reduceat(values, self.start[:-1])


def program_blocks(
    apart: SideBySide, contacts: ContactSet, mu: Array | None = None, *, possible: bool = False
) -> ProgramBlocks:
    """Build the programs of many assemblies in shared arrays; their forces have no friction.

    Motions are checked with friction `mu`, shape (M,). If `possible` is true, include every force
    that contacts outside the model could transmit.
    """
    mu = np.zeros(len(apart)) if mu is None else mu
    whole = build_program(apart.whole, contacts, possible=possible)
    owner = apart.owner[np.maximum(whole.part_a, whole.part_b)]
    if (np.diff(owner) < 0).any():
        order = np.argsort(owner, kind="stable")
        whole, owner = whole.taking(order), owner[order]
    row_start = np.searchsorted(owner, np.arange(len(apart) + 1))
    return ProgramBlocks(whole, apart.start, row_start, apart.gravity, mu)


def cluster_blocks(program: Program, label: Index) -> ProgramBlocks:
    """Build the programs of clusters of an assembly in shared arrays, without friction.

    Each cluster has its own copies of the parts that it touches, which are held.

    Arguments: `label` (N,): cluster of each free part, 0 to M - 1, or -1 for parts of no cluster;
    no row has ends in two clusters.
    """
    count = len(label)
    owned = np.append(label, -1)
    row_owner = np.maximum(owned[program.part_a], owned[program.part_b])
    order = np.argsort(row_owner, kind="stable")
    rows = order[int((row_owner < 0).sum()) :]
    owner, clusters = row_owner[rows], int(label.max(initial=-1)) + 1
    own = np.flatnonzero(label >= 0)
    ends = [
        owner * (count + 1) + part[rows] % (count + 1) for part in (program.part_a, program.part_b)
    ]
    keys = np.unique(np.concatenate([label[own] * (count + 1) + own, *ends]))
    keys = keys[keys % (count + 1) < count]  # the ground is no part
    parts, of_part = keys % (count + 1), keys // (count + 1)
    number_a, number_b = (
        np.where(end % (count + 1) < count, np.searchsorted(keys, end), -1) for end in ends
    )
    whole = (
        program.taking(rows)
        .of_parts(parts)
        .with_rows(
            free=label[parts] == of_part, part_a=number_a, part_b=number_b, mu=np.zeros(len(rows))
        )
    )
    edges = np.arange(clusters + 1)
    gravity = np.tile(program.gravity, (clusters, 1))
    start, row_start = np.searchsorted(of_part, edges), np.searchsorted(owner, edges)
    return ProgramBlocks(whole, start, row_start, gravity, np.zeros(clusters))
