"""The program of an assembly: its parts, contact and joint rows, and load, with labels.

Free part i has centre of mass c_i and mass m_i, and the displacement dp_i = (dr_i, dtheta_i),
rotation about c_i. A row is (a, b, x, n): parts, position, unit direction from a to b;

    (dr_b + dtheta_b x (x - c_b) - dr_a - dtheta_a x (x - c_a)) . n >= 0     row of J dp >= 0
    w = (m_i g, 0)_i plus given loads                                        load
    J^T f + w = 0,  f >= 0                                                   equilibrium

(the paper, equations (5), (8), (9)). A contact pushes: its row is an inequality, and its force is
not negative. A joint also pulls: its rows are equations, and its forces have both signs. The
angular rows of a joint require (dtheta_b - dtheta_a) . n = 0; their force is a torque.

Building a program, solving it (`kilter.solvers`) and checking the solution
(`kilter.mechanics.certificate`) are three separate steps that communicate through this class.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any

import numpy as np
from scipy.sparse import csr_array

from kilter.arrays import Array, Index, Mask, connected, cross, sealed
from kilter.assembly import Assembly
from kilter.assembly.geometry import Geometry
from kilter.assembly.strap_wrenches import strap_wrenches
from kilter.contact.contact_set import ContactSet
from kilter.contact.friction_coefficients import certain_friction
from kilter.mechanics.joints import spring_wrenches
from kilter.mechanics.mechanics_tolerances import BLUR, TOLERANCE
from kilter.mechanics.rows import (
    BONDED,
    CONTACT,
    DRAG,
    STOP,
    STRAP,
    ForceRows,
    RowArrays,
    bonded_rows,
    clamp_of,
    contact_rows,
    joint_rows,
    possible_rows,
    sticking_rows,
    strap_rows,
)
from kilter.rigid import unit
from kilter.validate import frozen

ROW_FIELDS = tuple(field.name for field in fields(ForceRows))
"""Names of the members of a program that have an entry for each row."""

LOADS = frozenset(("gravity", "applied", "clamp"))
"""Names of the arrays that change the load, but neither parts nor rows."""
OF_ROWS = ("clusters", "levers", "arm", "rough", "cohesion", "gripping", "bounded")
"""Names of the cached values that do not depend on the load."""

PLANE = np.array([0, 2, 4])
PLANE.setflags(write=False)
"""Freedoms of a part in the plane: x, z, and rotation about y."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Program(RowArrays):
    """Parts, K rows (possible contact and joint forces) and load of an assembly, as arrays."""

    names: tuple[str, ...]
    """Names of all N parts."""
    free: Mask
    """False for held parts, shape (N,)."""
    center: Array
    """Centres of mass, shape (N, 3)."""
    mass: Array
    """[kg], shape (N,)."""
    inertia: Array
    """Inertia about the centre of mass, world axes [kg x length unit^2], shape (N, 3, 3)."""
    radius: Array
    """Characteristic length of each part, shape (N,): its bounding radius."""
    gravity: Array
    """[m/s^2], shape (3,)."""
    applied: Array
    """Given loads, shape (N, 6): force [N] and torque about the centre of mass [N x length
    unit]."""
    clamp: Array
    """Clamping loads of the bonds (`kilter.mechanics.rows`) and straps, and the loads of
    springs of joints, in the same form, shape (N, 6)."""
    tolerance: Array
    """Relative tolerance of a verdict for each part [-], shape (N,)."""
    planar: bool
    """True if parts move only in the x-z plane."""
    units: str
    """Name of the length unit."""

    @property
    def g(self) -> float:
        """Magnitude of gravity [m/s^2]."""
        return float(np.linalg.norm(self.gravity))

    @property
    def down(self) -> Array:
        """Unit direction of gravity, shape (3,)."""
        return unit(self.gravity)

    @cached_property
    def load(self) -> Array:
        """Load on each part besides contact forces: force [N], torque [N x length unit], (N, 6)."""
        load = self.applied + self.clamp
        load[:, :3] += self.mass[:, None] * self.gravity
        load[~self.free] = 0.0
        return frozen(load)

    @cached_property
    def weight(self) -> Array:
        """Weight of each part plus the sizes of the loads on it [N], shape (N,)."""
        force = np.linalg.norm(self.applied[:, :3], axis=1)
        torque = np.linalg.norm(self.applied[:, 3:], axis=1) / self.radius
        return frozen(self.mass * self.g + force + torque)

    @cached_property
    def arm(self) -> Array:
        """Lever length of each angular row, shape (K,); 1 for the other rows.

        Held parts do not count. A rotation times this length is an opening, and a torque over it is
        a force, so no result depends on the unit of length. The value of the other rows is 1.
        """
        size = np.append(np.where(self.free, self.radius, 0.0), 0.0)
        arm = np.maximum(size[self.part_a], size[self.part_b])
        return frozen(np.where(self.angular, arm, 1.0))

    @cached_property
    def clusters(self) -> Index:
        """Number of the cluster of each free part, in order of first part, shape (N,); else -1.

        A cluster is a set of free parts that touch each other (`kilter.mechanics.clusters`).
        """
        free = np.append(self.free, False)
        inner = free[self.part_a] & free[self.part_b]
        label = connected(len(self.names), self.part_a[inner], self.part_b[inner])
        clusters = np.where(self.free, label, -1)
        clusters.setflags(write=False)
        return clusters

    @property
    def freedoms(self) -> Index:
        """Indices of the freedoms that a part has: all six, or three in the plane."""
        return PLANE if self.planar else np.arange(6)

    @property
    def columns(self) -> list[tuple[str, str]]:
        """Labels (part, freedom) of the columns of `jacobian`."""
        labels = ("dx", "dy", "dz", "rx", "ry", "rz")
        moving = [name for name, free in zip(self.names, self.free, strict=True) if free]
        return [(name, labels[k]) for name in moving for k in self.freedoms]

    def jacobian(self) -> csr_array:
        """Matrix J from motions of the free parts to opening speeds, shape (K, freedoms)."""
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
        """Wrench that a unit force of each row exerts on a part, shape (k, 6)."""
        normal, angular = self.normal[rows], self.angular[rows]
        wrench = np.empty((len(rows), 6))
        wrench[:, :3] = normal
        wrench[:, 3:] = cross(self.point[rows] - self.center[part], normal)
        if angular.any():
            wrench[angular, :3], wrench[angular, 3:] = 0.0, normal[angular]
        return wrench

    @cached_property
    def rough(self) -> Index:
        """Indices of the rows with friction, shape (R,)."""
        return sealed(np.flatnonzero(self.mu > 0))

    @cached_property
    def cohesion(self) -> Array:
        """Shear strength of the bond of each row, beside friction [N], shape (K,); or 0."""
        return frozen(np.where(np.isnan(self.shear), 0.0, self.shear))

    @cached_property
    def gripping(self) -> Index:
        """Indices of the rows with a tangential force, from friction or bond shear, shape (R,)."""
        return sealed(np.flatnonzero((self.mu > 0) | (self.cohesion > 0)))

    @property
    def has_strength(self) -> bool:
        """True if the program has bonds, straps, joint friction or springs.

        Their strength does not grow with the load.
        """
        return bool(self.pull.any() or self.clamp.any() or self.has_limits)

    @cached_property
    def bounded(self) -> Index:
        """Indices of the rows whose force is at most a capacity, of straps and of joint friction.

        The force of a row that is two-sided is at least minus the capacity.
        """
        return sealed(np.flatnonzero(np.isfinite(self.capacity)))

    @property
    def strap_pieces(self) -> Index:
        """Indices of the rows of straps with a capacity, shape (S,)."""
        return np.flatnonzero(self.kind == STRAP)

    @property
    def bounded_straps(self) -> tuple[Index, Index]:
        """First row of each strap with a capacity, (n,), and the strap of each piece, (S,).

        The pieces of a strap have the same pull, since its corners have no friction.
        """
        rows = self.strap_pieces
        _, first, strap = np.unique(self.source[rows], return_index=True, return_inverse=True)
        return rows[first], strap

    def equal_pulls(self, forces: Array) -> Array:
        """Copy of row forces, shape (K,), with the mean pull in every piece of a strap."""
        first, strap = self.bounded_straps
        equal = forces.copy()
        if len(first) < len(strap):
            pieces = self.strap_pieces
            mean = np.bincount(strap, forces[pieces]) / np.bincount(strap)
            equal[pieces] = mean[strap]
        return equal

    def by_stops(self, forces: Array) -> Array:
        """Copy of row forces, shape (K,), in which stops carry as much as friction would beside.

        The sum along the free motion of each joint stays, but for what exceeds the limits.
        """
        rows = np.flatnonzero((self.kind == STOP) | (self.kind == DRAG))
        if not len(rows):
            return forces
        shared = forces.copy()
        for joint in np.unique(self.source[rows]):
            mine = rows[self.source[rows] == joint]
            senses = self.normal[mine] @ self.normal[mine[0]]
            left = float(senses @ forces[mine])
            for row, sense in zip(mine, senses, strict=True):  # the stops come first
                least = -self.capacity[row] if self.two_sided[row] else 0.0
                shared[row] = min(max(sense * left, least), self.capacity[row])
                left -= sense * shared[row]
        return shared

    @property
    def has_limits(self) -> bool:
        """True if a force has a limit of its own: shear of a bond, pull of a strap, joint friction.

        Only conic programs model these limits.
        """
        return bool(self.cohesion.any() or len(self.bounded))

    @property
    def strength(self) -> float:
        """Sum of all limits of bonds, straps with a capacity, and joint friction [N]."""
        rows = self.bounded
        limits = self.pull.sum() + self.cohesion.sum()
        limits += (self.capacity[rows] / self.arm[rows]).sum()
        return float(limits)

    @property
    def force_rows(self) -> ForceRows:
        """The rows (possible forces) of the program, without its parts and load."""
        return ForceRows(*(getattr(self, name) for name in ROW_FIELDS))

    def with_force_rows(self, rows: ForceRows) -> Program:
        """Copy of the program with other force rows."""
        return self.with_rows(**{name: getattr(rows, name) for name in ROW_FIELDS})

    def taking(self, rows: Index | Mask) -> Program:
        """Copy of the program with only the given rows (index array or mask)."""
        return self.with_force_rows(self.force_rows.take(rows))

    @property
    def frictionless(self) -> Program:
        """The program without friction (mu = 0); rows of fitted normals are dropped."""
        return self.with_friction(0.0) if self.mu.any() or self.doubt.any() else self

    def with_friction(self, mu: float) -> Program:
        """Copy of the program with friction `mu` at all contacts, less the uncertainty of normals.

        Contacts whose normals are uncertain by more than `mu` have no certain force and are
        removed.
        """
        has_friction = (self.kind == CONTACT) & ~self.tied & np.isnan(self.shear)
        reduced = np.where(has_friction, certain_friction(mu, self.doubt), 0.0)
        changed = self.with_rows(mu=reduced)
        certain = changed.force_rows.certain
        return changed if certain.all() else changed.taking(certain)

    @cached_property
    def levers(self) -> tuple[tuple[Index, Index, Array], ...]:
        """Rows, parts, and the wrench of a unit force of each row on its part, for b and for a."""
        return sealed(self._levers_of(np.ones(len(self.part_a), dtype=bool)))

    def _levers_of(self, chosen: Mask) -> tuple[tuple[Index, Index, Array], ...]:
        """As `levers`, of the chosen rows, (K,)."""
        sides = []
        for part, sign in ((self.part_b, 1.0), (self.part_a, -1.0)):
            k = np.flatnonzero(chosen & (part >= 0))
            sides.append((k, part[k], sign * self.lever(k, part[k])))
        return tuple(sides)

    def of_parts(self, parts: Index) -> Program:
        """Copy of the program with the parts `parts`; the rows still have the old numbers."""
        names = ("free", "center", "mass", "inertia", "radius", "applied", "clamp", "tolerance")
        return self.with_rows(
            names=tuple(self.names[part] for part in parts.tolist()),
            **{name: getattr(self, name)[parts] for name in names},
        )

    def excerpt(self, parts: Index, rows: Index) -> Program:
        """Copy of the program with only some parts and rows; every row ends at these parts."""
        number = np.full(len(self.names) + 1, -1)  # the ground is the last
        number[parts] = np.arange(len(parts))
        few = self.of_parts(parts).taking(rows)
        return few.with_rows(part_a=number[few.part_a], part_b=number[few.part_b])

    def velocities(self, motion: Array) -> Array:
        """Speed at which a motion, shape (N, 6), opens the gap of each row, shape (K,)."""
        result = np.zeros(len(self.part_a))
        for k, part, lever in self.levers:
            result[k] += np.einsum("ij,ij->i", lever, motion[part])
        return result

    def relative(self, motion: Array, rows: Index) -> Array:
        """Velocity of part b relative to part a at the points of linear rows, shape (k, 3)."""
        relative = np.zeros((len(rows), 3))
        for part, sign in ((self.part_b[rows], 1.0), (self.part_a[rows], -1.0)):
            k = np.flatnonzero(part >= 0)
            arm = self.point[rows[k]] - self.center[part[k]]
            twist = motion[part[k]]
            relative[k] += sign * (twist[:, :3] + cross(twist[:, 3:], arm))
        return relative

    def slips(self, motion: Array, rows: Index) -> Array:
        """Sliding velocity of part b relative to part a at the contact rows, shape (k, 3)."""
        relative = self.relative(motion, rows)
        normal = self.normal[rows]
        along = np.einsum("ij,ij->i", relative, normal)
        slip: Array = relative - along[:, None] * normal
        if self.planar:
            slip[:, 1] = 0.0
        return slip

    def power(self, motion: Array) -> float:
        """Power of the load in a motion, shape (N, 6), minus that of bonds, straps and joints.

        Bonds that slip, straps that lengthen, and joints with friction that move take up the most
        that their limits permit.
        """
        taken = 0.0
        rows = np.flatnonzero(self.shear > 0)
        if len(rows):
            slips = np.linalg.norm(self.slips(motion, rows), axis=1)
            taken = float(self.shear[rows] @ slips)
        if len(self.bounded):
            speed, rubs = self.velocities(motion), np.flatnonzero(self.kind == DRAG)
            taken += float(self.capacity[rubs] @ np.abs(speed[rubs]))
            first, strap = self.bounded_straps
            lengthening = np.bincount(strap, -speed[self.strap_pieces])
            taken += float(self.capacity[first] @ np.maximum(lengthening, 0.0))
        return float((self.load * motion).sum()) - taken

    def wrenches(self, forces: Array, friction: Array | None = None) -> Array:
        """Total wrench of all row forces on each part, shape (N, 6).

        Arguments: `forces` (K,): along the rows [N]; `friction` (K, 3): across the rows, on part b
        [N].
        """
        total = np.zeros((len(self.names), 6))
        known = "levers" in self.__dict__
        for (rows, of, lever), (part, sign) in zip(
            self.levers if known else self._levers_of(forces != 0),
            ((self.part_b, 1.0), (self.part_a, -1.0)),
            strict=True,
        ):
            wrench = forces[rows, None] * lever
            for axis in range(6):
                total[:, axis] += np.bincount(of, wrench[:, axis], minlength=len(total))
            if friction is not None:
                k = np.flatnonzero((part >= 0) & friction.any(axis=1))
                across = sign * friction[k]
                moment = cross(self.point[k] - self.center[part[k]], across)
                for axis, column in enumerate((*across.T, *moment.T)):
                    total[:, axis] += np.bincount(part[k], column, minlength=len(total))
        return total

    def force_sums(self, forces: Array, friction: Array | None = None) -> Array:
        """Sum of the magnitudes of the row forces on each part [N], shape (N,)."""
        total = np.zeros(len(self.names))
        size = np.abs(forces)
        if friction is not None:
            size = np.hypot(size, np.linalg.norm(friction, axis=1))
        for part in (self.part_b, self.part_a):
            k = np.flatnonzero(part >= 0)
            # a torque over the radius of the part is a force
            share = size[k] / np.where(self.angular[k], self.radius[part[k]], 1.0)
            total += np.bincount(part[k], share, minlength=len(total))
        return total

    def point_forces(self, forces: Array, friction: Array) -> Array:
        """Force vector on part b at each contact row [N], shape (C, 3), with the forces of bonds.

        `forces`, shape (K,), and `friction`, shape (K, 3), are those of a `ForceProof`.
        """
        rows = np.flatnonzero(self.kind == CONTACT)
        along = forces[rows] - self.pull[rows]
        acting: Array = along[:, None] * self.normal[rows] + friction[rows]
        tied, bonded = np.flatnonzero(self.tied[rows]), np.flatnonzero(self.kind == BONDED)
        shear = forces[bonded, None] * self.normal[bonded]
        # the rows of a bond without a shear limit are listed along all u, then along all v
        acting[tied] += shear.reshape(2, len(tied), 3).sum(axis=0)
        return acting

    def row_forces(self, acting: Array) -> tuple[Array, Array]:
        """Normal forces, (K,), and friction, (K, 3), of the rows from forces at contacts.

        The inverse of `point_forces`; the forces of other rows are 0.
        """
        rows = np.flatnonzero(self.kind == CONTACT)
        forces, friction = np.zeros(len(self.part_a)), np.zeros((len(self.part_a), 3))
        along = np.einsum("ij,ij->i", acting, self.normal[rows])
        across = acting - along[:, None] * self.normal[rows]
        forces[rows] = along + self.pull[rows]
        tied, bonded = np.flatnonzero(self.tied[rows]), np.flatnonzero(self.kind == BONDED)
        forces[bonded] = np.einsum("ij,ij->i", np.tile(across[tied], (2, 1)), self.normal[bonded])
        across[tied] = 0.0
        friction[rows] = across
        return forces, friction

    def full(self, columns: Array) -> Array:
        """Motion of all parts, shape (N, 6), from a vector over the freedoms of the free parts."""
        motion = np.zeros((len(self.names), 6))
        motion[np.ix_(self.free, self.freedoms)] = columns.reshape(-1, len(self.freedoms))
        return motion

    def with_strength(self, share: float) -> Program:
        """The program with the strength of every bond and strap multiplied by `share`."""
        capacity = self.capacity.copy()
        capacity[self.bounded] *= share  # a share of 0 times infinity is no number
        return self.with_rows(
            clamp=share * self.clamp,
            pull=share * self.pull,
            shear=share * self.shear,
            capacity=capacity,
        )

    def turned(self, down: Array) -> Program:
        """The program with gravity along `down`, shape (3,) of any length; same magnitude."""
        return self.with_rows(gravity=unit(down, "down") * self.g)

    def with_rows(self, **changes: Any) -> Program:
        """A copy of the program with new values of the named arrays."""
        copy = replace(self, **changes)
        if changes.keys() <= LOADS:
            copy.__dict__.update({name: getattr(self, name) for name in OF_ROWS})
        return copy


def build_program(
    assembly: Assembly,
    contacts: ContactSet,
    *,
    possible: bool = False,
    sticking: bool = False,
    fitted: bool = False,
) -> Program:
    """Build the program of an assembly: a row for each force that its contacts and joints exert.

    A contact with a fitted normal is certain only if its friction exceeds the uncertainty of the
    normal; otherwise it is omitted, for every question alike.
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
    clamp = np.zeros((len(assembly.parts), 6))
    if assembly.joints:
        blocks.append(joint_rows(assembly, geometry, contacts.searched))
        clamp += spring_wrenches(assembly)
    if assembly.straps:
        blocks.append(strap_rows(assembly, geometry))
        clamp += strap_wrenches(assembly)
    rows = ForceRows.join(blocks)
    if assembly.bonds:
        clamp += clamp_of(geometry, rows.part_a, rows.part_b, rows.point, rows.normal, rows.pull)
    return Program(
        names=assembly.names,
        free=~geometry.grounded,
        center=geometry.center,
        mass=geometry.mass,
        inertia=geometry.inertia,
        radius=geometry.radius,
        gravity=assembly.gravity,
        applied=loads_about(assembly, geometry.center),
        clamp=clamp,
        tolerance=_part_tolerances(contacts, geometry),
        planar=assembly.planar,
        units=assembly.units,
        **{name: getattr(rows, name) for name in ROW_FIELDS},
    )


def bounding_program(assembly: Assembly, contacts: ContactSet) -> Program:
    """Program with a row for every conceivable contact force, as an outer bound."""
    program = build_program(assembly, contacts, possible=True, sticking=True)
    return program.with_rows(mu=np.zeros(len(program.mu)))


def loads_about(assembly: Assembly, center: Array) -> Array:
    """Loads stated in the assembly, as force and torque about the given centres, shape (N, 6).

    A load without a point acts at the centre. Arguments: `center` (N, 3).
    """
    applied = np.zeros((len(assembly.parts), 6))
    for load in assembly.loads:
        k = assembly.index_of(load.part)
        arm = np.zeros(3) if load.point is None else load.point - center[k]
        applied[k, :3] += load.force
        applied[k, 3:] += load.torque + cross(arm, load.force)
    return applied


def _part_tolerances(contacts: ContactSet, geometry: Geometry) -> Array:
    """Relative tolerance of each part [-]: at least 1e-9, more for coordinates of low accuracy."""
    tolerance = np.full(len(geometry.mass), TOLERANCE)
    blur = BLUR * contacts.patch_accuracy
    np.maximum.at(tolerance, contacts.patch_parts.T, blur[None, :])
    return tolerance
