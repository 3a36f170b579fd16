"""Parts that fixed joints tie to one another move as one: to second order they are one body.

A group is told by its first part. Its centre of mass C, mass, inertia and loads are those of all
its parts, and contacts within it are left out. With its motion (r, theta), a part of it with its
centre at c has moved by r + (exp(theta) - 1) (c - C), and turned by theta.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from kilter.arrays import Array, Index, Mask, cross, group_sums, read_only
from kilter.assembly import Assembly
from kilter.contact.contact_set import ContactSet
from kilter.contact.open_pairs import rigid_groups
from kilter.mechanics.program import Program
from kilter.mechanics.rows import JOINT
from kilter.second_order.parts.separation import turn_of

__all__ = ["RigidGroups"]


@dataclass(frozen=True, slots=True, eq=False)
class RigidGroups:
    """The groups of N parts.

    Attributes
    ----------
    first : ndarray of int, shape (N,)
        The first part of the group of each.
    arms : ndarray, shape (N, 3)
        From the centre of mass of its group to its own [length unit].
    held : ndarray of bool, shape (N,)
        Whether its group is.
    """

    first: Index
    arms: Array
    held: Mask

    def __post_init__(self) -> None:
        read_only(self)

    @classmethod
    def of(cls, assembly: Assembly) -> RigidGroups:
        """The groups of an assembly; those of a held part, or tied to the ground, are held."""
        count, geometry = len(assembly.parts), assembly.geometry
        own, index = np.arange(count), assembly.index
        fixed = [one.parts for one in assembly.joints if one.kind == "fixed"]
        if not fixed:
            return cls(own, np.zeros((count, 3)), geometry.grounded)
        label = rigid_groups(assembly)
        _, at, place = np.unique(label, return_index=True, return_inverse=True)
        first = at[place]
        mass = geometry.mass[:, None]
        center = _sums(first, mass * geometry.center)[first] / _sums(first, mass)[first]
        held = geometry.grounded.copy()
        for ends in fixed:
            if not set(ends) <= set(index):
                held[[index[one] for one in ends if one in index]] = True
        return cls(first, geometry.center - center, np.isin(first, first[held]))

    @property
    def tied(self) -> bool:
        """Whether any part is of a group with another."""
        return bool((self.first != np.arange(len(self.first))).any())

    def merged(self, program: Program, assembly: Assembly) -> Program:
        """The program of the groups, each as its first part; its rows are those between groups."""
        if not self.tied:
            return program
        first, arms = self.first, self.arms
        own = first == np.arange(len(first))
        size = np.sum(arms**2, axis=1)[:, None, None] * np.eye(3)
        spread = program.mass[:, None, None] * (size - arms[:, :, None] * arms[:, None, :])
        applied = program.applied.copy()
        applied[:, 3:] += cross(arms, applied[:, :3])
        radius, tolerance = np.zeros(len(first)), np.zeros(len(first))
        np.maximum.at(radius, first, program.radius + np.linalg.norm(arms, axis=1))
        np.maximum.at(tolerance, first, program.tolerance)
        whole = replace(
            program,
            free=own & ~self.held,
            center=program.center - arms,
            mass=np.where(own, _sums(first, program.mass[:, None])[:, 0], program.mass),
            inertia=_sums(first, program.inertia + spread),
            radius=np.where(own, radius, program.radius),
            applied=_sums(first, applied),
            clamp=_sums(first, program.clamp),
            tolerance=np.where(own, tolerance, program.tolerance),
            part_a=self.of_rows(program.part_a),
            part_b=self.of_rows(program.part_b),
        )
        return whole.taking(self.between(program, assembly))

    def of_rows(self, part: Index) -> Index:
        """The first parts of the groups of some; -1 stays the ground."""
        return np.where(part >= 0, self.first[part], part)

    def between(self, program: Program, assembly: Assembly) -> Mask:
        """Rows of the parts' own program that are not within a group, shape (K,)."""
        free = np.append(~self.held, False)
        joint = program.kind == JOINT
        fixed = np.array([one.kind == "fixed" for one in assembly.joints] or [False])
        tie = joint & fixed[np.where(joint, program.source, 0)]
        apart = self.of_rows(program.part_a) != self.of_rows(program.part_b)
        between: Mask = apart & (free[program.part_a] | free[program.part_b]) & ~tie
        return between

    def apart(self, program: Program, assembly: Assembly, contacts: ContactSet) -> Program:
        """A merged program of contacts with the parts themselves in place of their groups."""
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
        """Velocities of all parts from those of their groups, shape (..., N, 6)."""
        all_ = motions[..., self.first, :].copy()
        all_[..., :3] += np.cross(all_[..., 3:], self.arms)
        return all_

    def placed(self, motion: Array) -> Array:
        """Where all parts are from where their groups are, shape (N, 6)."""
        all_ = motion[self.first].copy()
        for k in np.flatnonzero(np.abs(self.arms).max(axis=1) > 0):
            all_[k, :3] += (turn_of(all_[k, 3:]) - np.eye(3)) @ self.arms[k]
        return all_


def _sums(first: Index, values: Array) -> Array:
    """Sums by group, at the place of its first part; 0 elsewhere."""
    return group_sums(first, values, len(values))
