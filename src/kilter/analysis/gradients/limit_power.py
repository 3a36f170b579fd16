"""Derivative of the power that forces and motion of a solved limit have, by the data of it.

At a limit, the forces f and the motion q have no power together: q.(J^T f + w + L d) = 0. If both
are kept, small changes of the data change this power by

    points       f.((wb - wa) x x')      x': rate of the contact point, w: angular velocity
    normals      (r x f).(vb - va)       r: rotation of the normal, v: velocity at the point
    centres      -c'.(F x w)             F: force on the part at fixed points
    masses       m' g (g0 + L e).v       e: direction of a load that grows with the masses
    friction     -mu' f_n |slip|
    loads        w'.q

so dL = -(change of the power)/(q.d). If forces or motion are not unique, this holds for the chosen
ones only (`kilter.analysis.gradients.limit_faces`).
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from kilter.analysis.gradients.contact_rates import ContactRates
from kilter.arrays import Array, Index, cross, lengths
from kilter.assembly.geometry import Geometry
from kilter.mechanics.program import Program
from kilter.mechanics.rows import CONTACT


@dataclass(frozen=True, slots=True, eq=False)
class Rates:
    """Rates of all data of an assembly, per unit of a parameter."""

    vertices: Array
    """Rates of `Geometry.vertices`, shape (V, 3)."""
    center: Array
    """Rates of the centres of mass, shape (N, 3)."""
    mass: Array
    """Rates of the masses [kg], shape (N,)."""
    mu: Array
    """Rates of the friction coefficient of each patch [-], shape (P,)."""
    applied: Array
    """Rates of the force and torque of the loads about a fixed centre of mass, shape (N, 6)."""

    def __neg__(self) -> Rates:
        return Rates(-self.vertices, -self.center, -self.mass, -self.mu, -self.applied)


@dataclass(frozen=True, slots=True, eq=False)
class SolvedLimit:
    """Forces and motion at a limit, and the load that the limit multiplies."""

    program: Program
    forces: Array
    """Along the rows [N], shape (K,)."""
    friction: Array
    """Across the rows, on part b [N], shape (K, 3)."""
    motion: Array
    """Translations and rotations of the parts, shape (N, 6)."""
    along: Array
    """Load per unit of the limit, shape (N, 6) [N]; 0 for a least friction."""
    value: float
    """The limit [-] or [N]."""
    along_mass: Array | None
    """Direction times g if `along` grows with the masses, shape (3,); else None."""
    fixed: Array
    """Forces of loads at points that do not move with the parts, shape (N, 3) [N]."""
    unit: float = 1.0
    """Derivative of the reported number by the limit: 1, or degrees by tangents."""
    load_share: float = 1.0
    """Factor of the given loads at the limit [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class PartSides:
    """Derivatives by the coordinates of parts, toward smaller and toward larger values."""

    position: Array
    """By the position of each part [1/length unit], shape (N, 3, 2)."""
    rotation: Array
    """By rotations about world axes through the centre of mass [1/rad], shape (N, 3, 2)."""


@dataclass(frozen=True, slots=True, eq=False)
class LimitPower:
    """The change of the power of forces and motion by rates of the data."""

    solved: SolvedLimit
    rates: ContactRates
    geometry: Geometry
    _at_points: Array = field(init=False)
    _at_normals: Array = field(init=False)

    def __post_init__(self) -> None:
        program, motion = self.solved.program, self.solved.motion
        force = self.solved.forces[:, None] * program.normal + self.solved.friction
        force[program.angular] = 0.0
        turned = np.append(motion[:, 3:], np.zeros((1, 3)), axis=0)  # the ground is the last
        turns = turned[program.part_b] - turned[program.part_a]
        velocity = program.relative(motion, np.arange(len(program.part_a)))
        object.__setattr__(self, "_at_points", cross(force, turns))
        object.__setattr__(self, "_at_normals", cross(force, velocity))

    @property
    def gain(self) -> float:
        """Power per unit of the limit, with the sign that makes dL = -change/gain [W]."""
        if self.solved.along.any():
            return float((self.solved.along * self.solved.motion).sum())
        return float(self.by_row_friction.sum())

    @property
    def by_row_friction(self) -> Array:
        """Change of the power by the friction coefficient of each row, shape (K,)."""
        program, change = self.solved.program, np.zeros(len(self.solved.forces))
        rows = np.flatnonzero(program.kind == CONTACT)
        slip = lengths(program.slips(self.solved.motion, rows))
        change[rows] = -self.solved.forces[rows] * slip
        return change

    @property
    def by_center(self) -> Array:
        """Change of the power by the centre of mass of each part, shape (N, 3)."""
        program, solved = self.solved.program, self.solved
        total = program.wrenches(solved.forces, solved.friction)[:, :3] + solved.fixed
        change: Array = -cross(total, solved.motion[:, 3:])
        return np.where(program.free[:, None], change, 0.0)

    @property
    def by_mass(self) -> Array:
        """Change of the power by the mass of each part, shape (N,)."""
        program, solved = self.solved.program, self.solved
        pull = program.gravity
        if solved.along_mass is not None:
            pull = pull + solved.value * solved.along_mass
        change: Array = np.where(program.free, solved.motion[:, :3] @ pull, 0.0)
        return change

    @property
    def by_force(self) -> Array:
        """Change of the power by forces and torques on each part, shape (N, 6)."""
        return np.where(self.solved.program.free[:, None], self.solved.motion, 0.0)

    def by_parts(self) -> PartSides:
        """Change of the power by position and rotation of each part, to both sides."""
        geometry, points, turns = self.geometry, self.rates.points, self.rates.turns
        count = len(geometry.mass)
        amount = np.einsum("ij,ij->i", self._at_points[points.row], points.along)
        place = np.einsum("ij,ijk->ik", points.weights, geometry.vertices[points.vertices])
        arm = place - geometry.center[points.part]
        position = _both_sides(count, points.part, amount, points.across, points.group)
        turned = cross(arm, points.across)
        rotation = _both_sides(count, points.part, amount, turned, points.group)
        position += self.by_center[:, :, None]
        edge = geometry.vertices[turns.edge[:, 1]] - geometry.vertices[turns.edge[:, 0]]
        share = np.einsum("ij,ij->i", self._at_normals[turns.row], turns.turn)
        of_turns = share[:, None] * cross(edge, self.solved.program.normal[turns.row])
        none = np.full(len(share), -1)
        rotation += _both_sides(count, turns.part, np.ones(len(share)), of_turns, none)
        return PartSides(position, rotation)

    def by_vertices(self, part: int) -> Array:
        """Change of the power by each vertex of a part, to both sides, shape (V, 3, 2).

        Mass and centre are kept.
        """
        geometry, points, turns = self.geometry, self.rates.points, self.rates.turns
        start, end = geometry.vertex_start[part : part + 2]
        mine = np.flatnonzero(points.part == part)
        amount = np.einsum("ij,ij->i", self._at_points[points.row[mine]], points.along[mine])
        total = np.zeros((end - start, 3, 2))
        for k in range(3):
            speed = points.weights[mine, k, None] * points.across[mine]
            number = points.vertices[mine, k] - start
            total += _both_sides(end - start, number, amount, speed, points.group[mine])
        mine = np.flatnonzero(turns.part == part)
        share = np.einsum("ij,ij->i", self._at_normals[turns.row[mine]], turns.turn[mine])
        pushed = share[:, None] * self.solved.program.normal[turns.row[mine]]
        for sign, column in ((1.0, 1), (-1.0, 0)):
            np.add.at(total, turns.edge[mine, column] - start, sign * pushed[:, :, None])
        return total

    def change(self, rates: Rates) -> float:
        """Change of the power per unit of a parameter, toward larger values of it."""
        row_mu = np.zeros(len(self.solved.forces))
        contact = np.flatnonzero(self.solved.program.kind == CONTACT)
        row_mu[contact] = rates.mu[self.solved.program.source[contact]]
        total = float(self.by_row_friction @ row_mu) if self.solved.along.any() else 0.0
        total += float((self.by_center * rates.center).sum())
        total += float(self.by_mass @ rates.mass)
        total += self.solved.load_share * float((self.by_force * rates.applied).sum())
        return total + self.of_points(rates.vertices) + self.of_normals(rates.vertices)

    def of_points(self, vertices: Array) -> float:
        """Change of the power by the contact points, for rates of the vertices, (V, 3)."""
        points = self.rates.points
        speed = outline_speeds(self.rates, vertices)
        amount = np.einsum("ij,ij->i", self._at_points[points.row], points.along)
        alone = points.group < 0
        total = float(amount[alone] @ speed[alone])
        order = np.flatnonzero(~alone)
        if len(order):  # the terms of a group are neighbours
            first = np.flatnonzero(np.diff(points.group[order], prepend=-1))
            slowest = np.minimum.reduceat(speed[order], first)
            total += float(amount[order[first]] @ slowest)
        return total

    def of_normals(self, vertices: Array) -> float:
        """Change of the power by the contact normals, for rates of the vertices, (V, 3)."""
        turns = self.rates.turns
        turned = turns.turn * _edge_speeds(self, vertices)[:, None]
        return float((self._at_normals[turns.row] * turned).sum())


def outline_speeds(rates: ContactRates, vertices: Array) -> Array:
    """Speed of each outline of `PointRates` for rates of the vertices, shape (E,)."""
    points = rates.points
    velocity = np.einsum("ij,ijk->ik", points.weights, vertices[points.vertices])
    speed: Array = np.einsum("ij,ij->i", velocity, points.across)
    return speed


def _edge_speeds(power: LimitPower, vertices: Array) -> Array:
    """Speed n.(v1 - v0) of each edge of `TurnRates`, shape (E,)."""
    turns = power.rates.turns
    moved = vertices[turns.edge[:, 1]] - vertices[turns.edge[:, 0]]
    speed: Array = np.einsum("ij,ij->i", moved, power.solved.program.normal[turns.row])
    return speed


def row_rates(power: LimitPower, vertices: Array) -> tuple[Array, Array]:
    """Rates of the points and rotations of the normals of all rows, shapes (K, 3)."""
    points, turns = power.rates.points, power.rates.turns
    count = len(power.solved.forces)
    moved, turned = np.zeros((count, 3)), np.zeros((count, 3))
    speed = outline_speeds(power.rates, vertices)
    order = np.flatnonzero(points.group >= 0)
    if len(order):
        first = np.flatnonzero(np.diff(points.group[order], prepend=-1))
        slowest = np.minimum.reduceat(speed[order], first)
        speed[order] = 0.0
        speed[order[first]] = slowest
    np.add.at(moved, points.row, speed[:, None] * points.along)
    np.add.at(turned, turns.row, turns.turn * _edge_speeds(power, vertices)[:, None])
    return moved, turned


def _both_sides(count: int, number: Index, amount: Array, speed: Array, group: Index) -> Array:
    """Sum of terms by part or vertex, (count, 3, 2): toward smaller and toward larger values.

    Where two outlines coincide, one that moves outwards alone changes nothing.
    """
    total = np.zeros((count, 3, 2))
    grouped = (group >= 0)[:, None]
    for side in (0, 1):
        limited = np.maximum(speed, 0.0) if side == 0 else np.minimum(speed, 0.0)
        np.add.at(total[:, :, side], number, amount[:, None] * np.where(grouped, limited, speed))
    return total
