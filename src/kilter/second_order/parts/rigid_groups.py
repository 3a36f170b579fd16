"""Rigid groups: parts tied by fixed joints, each group treated as a single body.

The first part of a group represents it. Centre of mass C, mass, inertia and loads of the group are
those of all its parts, and contacts within it are removed. If the group moves by (r, theta), a part
of it with its centre at c shifts by r + (exp(theta) - 1) (c - C) and turns by theta.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass, replace

import numpy as np

from kilter.arrays import Array, Index, Mask, cross, group_sums, read_only
from kilter.assembly import Assembly
from kilter.contact.contact_set import ContactSet
from kilter.contact.open_pairs import rigid_groups
from kilter.mechanics.program import Program
from kilter.mechanics.rows import JOINT
from kilter.rigid import turn_of


@dataclass(frozen=True, slots=True, eq=False)
class RigidGroups:
    """Rigid bodies formed by parts that fixed joints connect; a lone part is a group, too."""

    first: Index
    """First part of the group of each part, shape (N,)."""
    arms: Array
    """Vector from the centre of mass of the group to that of the part [length unit], shape (N,
    3)."""
    held: Mask
    """Whether the group of each part is held, shape (N,)."""

    def __post_init__(self) -> None:
        read_only(self)

    @classmethod
    def of(cls, assembly: Assembly) -> RigidGroups:
        """Rigid groups of an assembly: parts that fixed joints connect.

        A group is held if a part of it is held or tied to the ground.
        """
        count, geometry = len(assembly.parts), assembly.geometry
        index = assembly.index
        fixed = [joint.parts for joint in assembly.joints if joint.kind == "fixed"]
        if not fixed:
            return cls(np.arange(count), np.zeros((count, 3)), geometry.grounded)
        label = rigid_groups(assembly)
        _, at, place = np.unique(label, return_index=True, return_inverse=True)
        first = at[place]
        mass = geometry.mass[:, None]
        center = _sums(first, mass * geometry.center)[first] / _sums(first, mass)[first]
        held = geometry.grounded.copy()
        for ends in fixed:
            if not set(ends) <= set(index):
                held[[index[name] for name in ends if name in index]] = True
        return cls(first, geometry.center - center, np.isin(first, first[held]))

    @property
    def tied(self) -> bool:
        """True if any rigid group has more than one part."""
        return bool((self.first != np.arange(len(self.first))).any())

    def merged(self, program: Program, assembly: Assembly) -> Program:
        """Program in which the first part of each rigid group stands for the group.

        The radius of a body, which scales its turns, reaches at least to its joints.
        """
        if not self.tied:
            return _reaching_joints(program)
        first, arms = self.first, self.arms
        is_first = first == np.arange(len(first))
        size = np.sum(arms**2, axis=1)[:, None, None] * np.eye(3)
        spread = program.mass[:, None, None] * (size - arms[:, :, None] * arms[:, None, :])
        applied = program.applied.copy()
        applied[:, 3:] += cross(arms, applied[:, :3])
        radius, tolerance = np.zeros(len(first)), np.zeros(len(first))
        np.maximum.at(radius, first, program.radius + np.linalg.norm(arms, axis=1))
        np.maximum.at(tolerance, first, program.tolerance)
        whole = replace(
            program,
            free=is_first & ~self.held,
            center=program.center - arms,
            mass=np.where(is_first, _sums(first, program.mass[:, None])[:, 0], program.mass),
            inertia=_sums(first, program.inertia + spread),
            radius=np.where(is_first, radius, program.radius),
            applied=_sums(first, applied),
            clamp=_sums(first, program.clamp),
            tolerance=np.where(is_first, tolerance, program.tolerance),
            part_a=self.of_rows(program.part_a),
            part_b=self.of_rows(program.part_b),
        )
        return _reaching_joints(whole.taking(self.between(program, assembly)))

    def jointed_pairs(self, assembly: Assembly) -> set[frozenset[int]]:
        """Pairs of parts whose rigid groups a joint that moves connects."""
        index = assembly.index
        of_group: dict[int, list[int]] = {}
        for part, first in enumerate(self.first.tolist()):
            of_group.setdefault(first, []).append(part)
        pairs = set()
        for joint in assembly.joints:
            ends = [int(self.first[index[name]]) for name in joint.parts if name in index]
            if joint.kind != "fixed" and len(ends) == 2:
                both = itertools.product(*(of_group[end] for end in ends))
                pairs |= {frozenset(pair) for pair in both}
        return pairs

    def of_rows(self, part: Index) -> Index:
        """Replace each part by the first part of its rigid group; -1 (the ground) is kept."""
        return np.where(part >= 0, self.first[part], part)

    def between(self, program: Program, assembly: Assembly) -> Mask:
        """Mask of the rows between two different rigid groups, shape (K,)."""
        free = np.append(~self.held, False)
        joint = program.kind == JOINT
        fixed = np.array([joint.kind == "fixed" for joint in assembly.joints] or [False])
        tie = joint & fixed[np.where(joint, program.source, 0)]
        apart = self.of_rows(program.part_a) != self.of_rows(program.part_b)
        between: Mask = apart & (free[program.part_a] | free[program.part_b]) & ~tie
        return between

    def apart(self, program: Program, assembly: Assembly, contacts: ContactSet) -> Program:
        """The opposite of `merged`: contact rows between single parts instead of rigid groups."""
        parts, geometry = contacts.patch_parts[program.source], assembly.geometry
        return replace(
            program,
            free=program.free[self.first],
            center=geometry.center,
            radius=geometry.radius,
            part_a=parts[:, 0],
            part_b=parts[:, 1],
        )

    def spread(self, motions: Array) -> Array:
        """Velocities of all parts from the velocities of their rigid groups, (..., N, 6)."""
        velocities = motions[..., self.first, :].copy()
        velocities[..., :3] += np.cross(velocities[..., 3:], self.arms)
        return velocities

    def placed(self, motion: Array) -> Array:
        """Displacements of all parts from the displacements of their rigid groups, (N, 6)."""
        displacements = motion[self.first].copy()
        for k in np.flatnonzero(np.abs(self.arms).max(axis=1) > 0):
            displacements[k, :3] += (turn_of(displacements[k, 3:]) - np.eye(3)) @ self.arms[k]
        return displacements


def _reaching_joints(program: Program) -> Program:
    """Copy of a program in which the radius of each part is at least the distance to its joints."""
    rows = np.flatnonzero(program.kind == JOINT)
    if not len(rows):
        return program
    radius = program.radius.copy()
    for part in (program.part_a[rows], program.part_b[rows]):
        mine = part >= 0
        off = program.point[rows[mine]] - program.center[part[mine]]
        np.maximum.at(radius, part[mine], np.linalg.norm(off, axis=1))
    return replace(program, radius=radius)


def _sums(first: Index, values: Array) -> Array:
    """Sum of the values of each group, in the row of its first part; 0 in other rows."""
    return group_sums(first, values, len(values))
