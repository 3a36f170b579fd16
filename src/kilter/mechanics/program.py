"""The program: parts, contact rows and load of one question, with labels.

Free part i has centre of mass c_i and mass m_i, and the displacement dp_i = (dr_i, dtheta_i),
rotation about c_i. A row is (a, b, x, n): parts, position, unit direction from a to b;

    (dr_b + dtheta_b x (x - c_b) - dr_a - dtheta_a x (x - c_a)) . n >= 0     row of J dp >= 0
    w = (m_i g, 0)_i plus given loads                                        load
    J^T f + w = 0,  f >= 0                                                   equilibrium

(the paper, equations (5), (8), (9)). A contact pushes: its row is an inequality, its force
is not negative. A joint also pulls: its rows are equations, its forces have both signs. The
angular rows of a joint hold (dtheta_b - dtheta_a) . n = 0; their force is a torque.

Building a program, solving it (`kilter.solvers`) and judging the answer
(`kilter.mechanics.certificate`) are three functions; this is what passes between them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array

from kilter.arrays import Array, Index, Mask, cross
from kilter.assembly import GROUND, Assembly
from kilter.assembly.geometry import Geometry
from kilter.contact.contact_set import ContactSet
from kilter.contact.friction_coefficients import certain_friction
from kilter.mechanics.bond_rows import clamp_of
from kilter.mechanics.mechanics_tolerances import BLUR, TOLERANCE
from kilter.mechanics.rows import (
    BONDED,
    CONTACT,
    KINDS,
    ForceRows,
    bonded_rows,
    contact_rows,
    joint_rows,
    possible_rows,
    sticking_rows,
)
from kilter.rigid import unit

__all__ = ["Program", "bounding_program", "build_program"]


ROW_FIELDS = ForceRows.__slots__
"""The members of a program that are arrays of its rows."""

PLANE = np.array([0, 2, 4])
PLANE.setflags(write=False)
"""Freedoms of a planar part among the six: x, z, rotation about y."""


@dataclass(frozen=True, slots=True, eq=False)
class Program:
    """Rows, parts and load; world frame, length unit of the assembly, forces in N.

    Attributes
    ----------
    names : tuple of str
        Names of all N parts.
    free : ndarray of bool, shape (N,)
    center : ndarray, shape (N, 3)
    mass : ndarray, shape (N,)
        [kg]
    inertia : ndarray, shape (N, 3, 3)
        [kg x length unit^2], about the centre of mass, world axes.
    radius : ndarray, shape (N,)
        The one length of each part: its bounding radius.
    gravity : ndarray, shape (3,)
        [m/s^2]
    applied : ndarray, shape (N, 6)
        Given loads: force [N] and torque about the centre of mass [N x length unit].
    clamp : ndarray, shape (N, 6)
        The loads with which bonds press parts together, alike (`kilter.mechanics.bond_rows`).
    part_a, part_b, point, normal, kind, two_sided, angular : ndarray
    mu, source, doubt, pull, tied, shear : ndarray
        Of the K rows, as `kilter.mechanics.rows.ForceRows` has them.
    tolerance : ndarray, shape (N,)
        Relative tolerance of a verdict about each part [-].
    planar : bool
    units : str
    """

    names: tuple[str, ...]
    free: Mask
    center: Array
    mass: Array
    inertia: Array
    radius: Array
    gravity: Array
    applied: Array
    clamp: Array
    part_a: Index
    part_b: Index
    point: Array
    normal: Array
    kind: Index
    two_sided: Mask
    angular: Mask
    mu: Array
    source: Index
    doubt: Array
    pull: Array
    tied: Mask
    shear: Array
    tolerance: Array
    planar: bool
    units: str

    @property
    def g(self) -> float:
        """Size of gravity [m/s^2]."""
        return float(np.linalg.norm(self.gravity))

    @property
    def down(self) -> Array:
        """Unit direction of gravity, shape (3,)."""
        return unit(self.gravity)

    @property
    def load(self) -> Array:
        """Force [N] and torque [N x length unit] on each part but those of rows, (N, 6)."""
        load = self.applied + self.clamp
        load[:, :3] += self.mass[:, None] * self.gravity
        load[~self.free] = 0.0
        return load

    @property
    def weight(self) -> Array:
        """The one force of each part [N], shape (N,): its weight plus the loads on it."""
        force = np.linalg.norm(self.applied[:, :3], axis=1)
        torque = np.linalg.norm(self.applied[:, 3:], axis=1) / self.radius
        weight: Array = self.mass * self.g + force + torque
        return weight

    @property
    def arm(self) -> Array:
        """The one length of each angular row, shape (K,): the largest of its free parts' radii.

        Times a turn it is an opening, under a torque a force; 1 for the other rows. So
        nothing depends on the unit of length.
        """
        size = np.append(np.where(self.free, self.radius, 0.0), 0.0)
        return np.where(self.angular, np.maximum(size[self.part_a], size[self.part_b]), 1.0)

    @property
    def freedoms(self) -> Index:
        """Which of the six freedoms of a part count."""
        return PLANE if self.planar else np.arange(6)

    @property
    def columns(self) -> list[tuple[str, str]]:
        """Labels (part, freedom) of the columns of `jacobian`."""
        words = ("dx", "dy", "dz", "rx", "ry", "rz")
        moving = [name for name, free in zip(self.names, self.free, strict=True) if free]
        return [(name, words[k]) for name in moving for k in self.freedoms]

    @property
    def rows(self) -> list[tuple[str, str, str, int]]:
        """Labels (kind, part a, part b, patch, possible force or joint) of the rows."""
        names = (*self.names, GROUND)
        return [
            (KINDS[kind], names[a], names[b], int(source))
            for kind, a, b, source in zip(
                self.kind, self.part_a, self.part_b, self.source, strict=True
            )
        ]

    def jacobian(self) -> csr_array:
        """J, one row a row, one column a freedom of a free part, in the order of `columns`."""
        count, per = len(self.part_a), len(self.freedoms)
        column = np.full(len(self.names) + 1, -1)
        column[:-1][self.free] = np.arange(int(self.free.sum()))
        blocks, rows, cols = [], [], []
        for part, sign in ((self.part_b, 1.0), (self.part_a, -1.0)):
            k = np.flatnonzero(column[part] >= 0)
            entries = sign * self.lever(k, part[k])[:, self.freedoms]
            blocks.append(entries.reshape(-1))
            rows.append(np.repeat(k, per))
            cols.append((column[part[k]][:, None] * per + np.arange(per)).reshape(-1))
        shape = (count, per * int(self.free.sum()))
        triplets = (np.concatenate(rows), np.concatenate(cols))
        return csr_array((np.concatenate(blocks), triplets), shape=shape)

    def lever(self, rows: Index, part: Index) -> Array:
        """(n, (x - c) x n) of rows on a part, shape (k, 6); (0, n) for angular rows."""
        normal = self.normal[rows]
        moment = cross(self.point[rows] - self.center[part], normal)
        angular = self.angular[rows][:, None]
        return np.hstack([np.where(angular, 0.0, normal), np.where(angular, normal, moment)])

    @property
    def rough(self) -> Index:
        """Rows with friction, shape (R,)."""
        return np.flatnonzero(self.mu > 0)

    @property
    def cohesion(self) -> Array:
        """What each row bears across it beside friction [N], shape (K,): the limits of bonds."""
        return np.where(np.isnan(self.shear), 0.0, self.shear)

    @property
    def gripping(self) -> Index:
        """Rows with forces across them: by friction, or up to the limit of a bond; (R,)."""
        return np.flatnonzero((self.mu > 0) | (self.cohesion > 0))

    @property
    def has_strength(self) -> bool:
        """Whether bonds hold by forces, which do not grow with the load."""
        return bool(self.pull.any() or self.cohesion.any())

    @property
    def force_rows(self) -> ForceRows:
        """The rows by themselves."""
        return ForceRows(*(getattr(self, name) for name in ROW_FIELDS))

    def with_force_rows(self, rows: ForceRows) -> Program:
        """The program with these rows in place of its own."""
        return self.with_rows(**{name: getattr(rows, name) for name in ROW_FIELDS})

    def taking(self, rows: Index | Mask) -> Program:
        """The program with some of its rows, by place or mask."""
        return self.with_force_rows(self.force_rows.take(rows))

    @property
    def frictionless(self) -> Program:
        """The same with mu = 0 everywhere, as far as that is certain (`with_friction`)."""
        return self.with_friction(0.0) if self.mu.any() or self.doubt.any() else self

    def with_friction(self, mu: float) -> Program:
        """The program with one coefficient at every contact, less the doubt of its normal.

        Contacts whose normals are in doubt by more than `mu` hold nothing for certain, and are
        left out.
        """
        rubs = (self.kind == CONTACT) & ~self.tied & np.isnan(self.shear)
        less = np.where(rubs, certain_friction(mu, self.doubt), 0.0)
        changed = self.with_rows(mu=less)
        certain = changed.force_rows.certain
        return changed if certain.all() else changed.taking(certain)

    def velocities(self, motion: Array) -> Array:
        """J dp: opening of each row, shape (K,), for a motion of all parts, shape (N, 6)."""
        result = np.zeros(len(self.part_a))
        for part, sign in ((self.part_b, 1.0), (self.part_a, -1.0)):
            k = np.flatnonzero(part >= 0)
            result[k] += sign * np.einsum("ij,ij->i", self.lever(k, part[k]), motion[part[k]])
        return result

    def slips(self, motion: Array, rows: Index) -> Array:
        """u_t: velocity along the surface of some contact rows, b over a, shape (k, 3)."""
        relative = np.zeros((len(rows), 3))
        for part, sign in ((self.part_b[rows], 1.0), (self.part_a[rows], -1.0)):
            k = np.flatnonzero(part >= 0)
            arm = self.point[rows[k]] - self.center[part[k]]
            twist = motion[part[k]]
            relative[k] += sign * (twist[:, :3] + cross(twist[:, 3:], arm))
        normal = self.normal[rows]
        along = np.einsum("ij,ij->i", relative, normal)
        slip: Array = relative - along[:, None] * normal
        if self.planar:
            slip[:, 1] = 0.0
        return slip

    def power(self, motion: Array) -> float:
        """Work of the load on a motion, shape (N, 6), less what bonds take up where they slip."""
        rows = np.flatnonzero(self.cohesion > 0)
        slips = np.linalg.norm(self.slips(motion, rows), axis=1)
        return float((self.load * motion).sum() - self.cohesion[rows] @ slips)

    def wrenches(self, forces: Array, friction: Array | None = None) -> Array:
        """J^T f: force and torque of the rows on each part, shape (N, 6).

        `forces`, shape (K,): along the rows; `friction`, shape (K, 3): across them [N].
        """
        total = np.zeros((len(self.names), 6))
        for part, sign in ((self.part_b, 1.0), (self.part_a, -1.0)):
            k = np.flatnonzero((part >= 0) & (forces != 0))
            wrench = (sign * forces[k])[:, None] * self.lever(k, part[k])
            for axis in range(6):
                total[:, axis] += np.bincount(part[k], wrench[:, axis], minlength=len(total))
            if friction is not None:
                k = np.flatnonzero((part >= 0) & friction.any(axis=1))
                aside = sign * friction[k]
                moment = cross(self.point[k] - self.center[part[k]], aside)
                for axis, column in enumerate((*aside.T, *moment.T)):
                    total[:, axis] += np.bincount(part[k], column, minlength=len(total))
        return total

    def force_sums(self, forces: Array, friction: Array | None = None) -> Array:
        """Sum of the sizes of the forces of the rows on each part [N], shape (N,)."""
        total = np.zeros(len(self.names))
        size = np.abs(forces)
        if friction is not None:
            size = np.hypot(size, np.linalg.norm(friction, axis=1))
        for part in (self.part_b, self.part_a):
            k = np.flatnonzero(part >= 0)
            share = size[k] / np.where(self.angular[k], self.radius[part[k]], 1.0)
            total += np.bincount(part[k], share, minlength=len(total))
        return total

    def point_forces(self, forces: Array, friction: Array) -> Array:
        """What acts at the contact rows on their part b [N], shape (C, 3), bonds included.

        `forces`, shape (K,), and `friction`, shape (K, 3), as those of a proof.
        """
        rows = np.flatnonzero(self.kind == CONTACT)
        along = forces[rows] - self.pull[rows]
        acting: Array = along[:, None] * self.normal[rows] + friction[rows]
        tied, borne = np.flatnonzero(self.tied[rows]), np.flatnonzero(self.kind == BONDED)
        aside = forces[borne, None] * self.normal[borne]
        acting[tied] += aside.reshape(2, len(tied), 3).sum(axis=0)
        return acting

    def row_forces(self, acting: Array) -> tuple[Array, Array]:
        """Forces along the rows, shape (K,), and across them, (K, 3), of what acts at contacts.

        The other way round than `point_forces`; those of other rows are 0.
        """
        rows = np.flatnonzero(self.kind == CONTACT)
        forces, friction = np.zeros(len(self.part_a)), np.zeros((len(self.part_a), 3))
        along = np.einsum("ij,ij->i", acting, self.normal[rows])
        aside = acting - along[:, None] * self.normal[rows]
        forces[rows] = along + self.pull[rows]
        tied, borne = np.flatnonzero(self.tied[rows]), np.flatnonzero(self.kind == BONDED)
        forces[borne] = np.einsum("ij,ij->i", np.tile(aside[tied], (2, 1)), self.normal[borne])
        aside[tied] = 0.0
        friction[rows] = aside
        return forces, friction

    def full(self, columns: Array) -> Array:
        """A vector in the order of `columns` as a motion of all parts, shape (N, 6)."""
        motion = np.zeros((len(self.names), 6))
        motion[np.ix_(self.free, self.freedoms)] = columns.reshape(-1, len(self.freedoms))
        return motion

    def with_strength(self, share: float) -> Program:
        """The program with a share of the strength of every bond."""
        return self.with_rows(
            clamp=share * self.clamp, pull=share * self.pull, shear=share * self.shear
        )

    def turned(self, down: Array) -> Program:
        """The program with gravity, at its size, along `down`, shape (3,), of any length."""
        return self.with_rows(gravity=unit(down, "down") * self.g)

    def with_rows(self, **changes: object) -> Program:
        """A copy with other rows or load."""
        values = {name: getattr(self, name) for name in self.__slots__}
        return Program(**{**values, **changes})


def build_program(
    assembly: Assembly,
    contacts: ContactSet,
    *,
    possible: bool = False,
    sticking: bool = False,
    fitted: bool = False,
) -> Program:
    """The program of an assembly and its certain contacts.

    A contact whose normal a fit gave is certain only by friction above its doubt; else it is
    left out here, for every question alike.

    Parameters
    ----------
    assembly : Assembly
    contacts : ContactSet
    possible : bool
        Also with every force that contacts that are not modelled might bring. What is
        unstable then is unstable.
    sticking : bool
        Also with tangential forces of any size at contacts where mu > 0, as rows of their
        own: a bound for questions that leave Coulomb's law out.
    fitted : bool
        Also the contacts that are not certain, along their fitted normals.
    """
    geometry = assembly.geometry
    touching = contact_rows(contacts, geometry)
    touching = touching if fitted else touching.take(touching.certain)
    blocks = [touching]
    if touching.tied.any():
        blocks.append(bonded_rows(touching))
    if possible:
        blocks.append(possible_rows(contacts.possible, geometry))
    if sticking:
        blocks.append(sticking_rows(contacts, geometry))
    blocks.append(joint_rows(assembly, geometry))
    rows = ForceRows.join(blocks)
    return Program(
        names=assembly.names,
        free=~geometry.grounded,
        center=geometry.center,
        mass=geometry.mass,
        inertia=geometry.inertia,
        radius=geometry.radius,
        gravity=assembly.gravity,
        applied=_applied(assembly, geometry),
        clamp=clamp_of(geometry, rows.part_a, rows.part_b, rows.point, rows.normal, rows.pull),
        tolerance=_tolerances(contacts, geometry),
        planar=assembly.planar,
        units=assembly.units,
        **{name: getattr(rows, name) for name in ROW_FIELDS},
    )


def bounding_program(assembly: Assembly, contacts: ContactSet) -> Program:
    """Every force that there may be, as rows: a bound for questions without Coulomb's law."""
    outer = build_program(assembly, contacts, possible=True, sticking=True)
    return outer.with_rows(mu=np.zeros(len(outer.mu)))


def _applied(assembly: Assembly, geometry: Geometry) -> Array:
    """Given loads about the centres of mass, shape (N, 6)."""
    applied = np.zeros((len(assembly.parts), 6))
    for load in assembly.loads:
        k = assembly.index_of(load.part)
        arm = np.zeros(3) if load.point is None else load.point - geometry.center[k]
        applied[k, :3] += load.force
        applied[k, 3:] += load.torque + cross(arm, load.force)
    return applied


def _tolerances(contacts: ContactSet, geometry: Geometry) -> Array:
    """max(1e-9, accuracy of the coordinates over the size of the patch) of each part."""
    tolerance = np.full(len(geometry.mass), TOLERANCE)
    blur = BLUR * contacts.patch_accuracy
    np.maximum.at(tolerance, contacts.patch_parts.T, blur[None, :])
    return tolerance
