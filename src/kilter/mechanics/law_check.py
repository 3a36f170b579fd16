"""Check, without a solver, that a motion from rest obeys Coulomb's law at every contact.

Accelerations a of the free parts and contact forces f on the second part of each contact start a
motion if, with u = J a the acceleration of b relative to a at the point, and n from a to b,

    M a = w + J^T f                                          the parts are in balance
    u_n >= 0,  f_n >= 0,  u_n f_n = 0                        no penetration, no tension
    |f_t| <= mu f_n,   f_t = -mu f_n u_t / |u_t| if u_t is not 0

A joint has u = 0 along its row, and its force (or torque) along the row has any sign. For parts at
rest, a = 0 with forces of equilibrium is a solution of the law. Another solution, a motion of power
w.a > 0, shows that equilibrium alone does not guarantee that the assembly stays.

Sizes are measured in a common metric: |a|^2 = a.M a, |w|^2 = w.M^-1 w. All residuals are divided by
|w|. The speed u of a point is divided by sigma, and its force multiplied by it, where sigma^2 = tr
W / 3 and W is the mobility of the point (force in, acceleration out): the numbers have no units and
are near 1 for light and heavy parts. With A = |a| / |w| every residual must stay below 1e-3 A^2,
since a vanishing motion proves nothing, and below 1e-8 A: stacks of blocks for which only rest is
possible have motions with residuals of 3e-5. The power must exceed 1e-5 of |w|^2 of the moving
parts.

References
----------
G. De Saxce, Z.-Q. Feng, The bipotential method, Math. Comput. Modelling 28, 1998.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import TINY, Array, cross
from kilter.mechanics.certificate import part_sizes
from kilter.mechanics.mechanics_tolerances import (
    CONE_ROUNDING,
    STILL,
    WITNESS_EXACT,
    WITNESS_POWER,
    WITNESS_SLIVER,
)
from kilter.mechanics.program import Program
from kilter.units import metres_per_unit


@dataclass(frozen=True, slots=True, eq=False)
class LawProof:
    """Residuals of a motion from rest, checked against Coulomb's contact law [-]."""

    acceleration: Array
    """Linear [m/s^2], angular [rad/s^2], shape (N, 6)."""
    forces: Array
    """Force on the second part of each row, world frame [N], shape (K, 3); torque of an angular
    row [N x length unit]."""
    power: float
    """w.a / |w|^2 of the moving parts."""
    size: float
    """|a|^2 / |w|^2."""
    balance: float
    """|a - M^-1 w - M^-1 J^T f|."""
    opening: float
    """Largest penetration of a contact, or opening of a joint."""
    cone: float
    """Largest distance of a force outside its cone."""
    normal: float
    """Largest |u_n f_n|."""
    angle: float
    stretch: float
    """Largest |f_t + |f_t| u_t / |u_t|| and ||f_t| - mu f_n| of sliding points."""
    holds: bool
    """The motion obeys the law."""

    @property
    def residual(self) -> float:
        """The largest of the six relative residuals of the contact law [-]."""
        return max(self.balance, self.opening, self.cone, self.normal, self.angle, self.stretch)

    @property
    def obeyed(self) -> bool:
        """Whether the motion obeys the law, however slow it is.

        If equilibrium forces exist, a slow motion that nearly obeys the law proves nothing
        (`holds`). If none exist, the parts must move, and near a limit they move slowly.
        """
        return self.size > 0.0 and self.residual <= WITNESS_EXACT * float(np.sqrt(self.size))


def check_law(program: Program, acceleration: Array, forces: Array) -> LawProof:
    """Check whether accelerations and forces form a motion that obeys Coulomb's contact law.

    Arguments: `acceleration` (N, 6): linear [m/s^2] and angular [rad/s^2] accelerations of all
    parts; `forces` (K, 3): force of every row on its second part, world frame [N]; torque along an
    angular row [N x length unit].
    """
    given = np.asarray(acceleration, dtype=np.float64).reshape(-1, 6)
    given_forces = np.asarray(forces, dtype=np.float64).reshape(-1, 3)
    finite = bool(np.isfinite(given).all() and np.isfinite(given_forces).all())
    fits = given.shape == (len(program.names), 6) and len(given_forces) == len(program.part_a)
    if not (finite and fits):
        bad = float("inf")
        return LawProof(given, given_forces, 0.0, 0.0, bad, bad, bad, bad, bad, bad, False)
    # arms are in length units: angular accelerations are scaled so that their products with arms
    # are in m/s^2
    motion = given * np.repeat([1.0, metres_per_unit(program.units)], 3)
    motion, rest, shares = _balance_residual(program, motion, given_forces)
    total = float(np.sqrt(max(shares.sum(), TINY)))
    energy = _energies(program, motion)
    speeds, pushes = _in_units_of_load(program, motion, given_forces, total)
    size = float(energy.sum()) / total**2
    residuals = (rest / total, *_law_residuals(program, speeds, pushes, np.sqrt(size)))
    pace = (
        energy * np.where(program.free, program.mass, 1.0) / np.maximum(program.weight, TINY) ** 2
    )
    moving = program.free & (pace > STILL**2 * pace.max(initial=0.0))
    power = float((program.load * motion).sum()) / max(float(shares[moving].sum()), TINY)
    power = power if moving.any() else 0.0
    holds = power > WITNESS_POWER and max(residuals) <= min(
        WITNESS_EXACT * np.sqrt(size), WITNESS_SLIVER * size
    )
    return LawProof(given, given_forces, power, size, *residuals, bool(holds))


def check_balance(program: Program, forces: Array) -> float:
    """Largest imbalance of a part over its weight [-]; infinity if a force leaves its cone.

    Arguments: `forces` (K, 3): force on part b of each row, world frame [N].
    """
    along = np.einsum("ki,ki->k", program.normal, forces)
    across = np.linalg.norm(forces - along[:, None] * program.normal, axis=1)
    limit = np.where(program.two_sided, 0.0, program.mu * along)
    rounding = CONE_ROUNDING * np.linalg.norm(forces, axis=1)
    if (across > limit + rounding).any() or (along[~program.two_sided] < 0).any():
        return float("inf")
    imbalance = point_wrenches(program, forces) + program.load
    relative = part_sizes(program, imbalance, per_radius=True) / np.maximum(program.weight, TINY)
    return float(relative[program.free].max(initial=0.0))


def _balance_residual(program: Program, motion: Array, forces: Array) -> tuple[Array, float, Array]:
    """Motion in the free directions, residual |M a - w - J^T f|, and |w|^2 of each part."""
    count = np.zeros((len(program.names), 6))
    count[np.ix_(program.free, program.freedoms)] = 1.0
    motion = motion * count
    load = program.load * count
    rest = (
        _inertia_forces(program, motion) - program.load - point_wrenches(program, forces)
    ) * count
    return (
        motion,
        float(np.sqrt(_squared_sizes(program, rest).sum())),
        _squared_sizes(program, load),
    )


def _inertia_forces(program: Program, motion: Array) -> Array:
    """Inertia forces M a of an acceleration, as a wrench on each part, shape (N, 6)."""
    turning = np.einsum("nij,nj->ni", program.inertia, motion[:, 3:])
    return np.hstack([program.mass[:, None] * motion[:, :3], turning])


def _energies(program: Program, motion: Array) -> Array:
    """Quadratic form a.M a (M: inertia) of each part's acceleration a, shape (N,)."""
    energies: Array = (motion * _inertia_forces(program, motion)).sum(axis=1)
    return energies


def _squared_sizes(program: Program, wrench: Array) -> Array:
    """Square w.M^-1 w of each part's wrench w, shape (N,); entries out of the plane must be 0."""
    turning = np.zeros((len(wrench), 3))
    axes = np.array([1] if program.planar else [0, 1, 2])
    inertia = program.inertia[program.free][:, axes][:, :, axes]
    torque = wrench[program.free][:, 3:][:, axes]
    turning[np.ix_(program.free, axes)] = np.linalg.solve(inertia, torque[..., None])[..., 0]
    straight = (wrench[:, :3] ** 2).sum(axis=1) / np.where(program.free, program.mass, 1.0)
    squares: Array = straight + (wrench[:, 3:] * turning).sum(axis=1)
    return squares


def point_speeds(program: Program, motion: Array) -> Array:
    """Velocity of part b relative to part a at the point of each row, world frame, shape (K, 3)."""
    speeds = np.zeros((len(program.part_a), 3))
    for part, sign in ((program.part_b, 1.0), (program.part_a, -1.0)):
        k = np.flatnonzero(part >= 0)
        twist, arm = motion[part[k]], program.point[k] - program.center[part[k]]
        straight = twist[:, :3] + cross(twist[:, 3:], arm)
        speeds[k] += sign * np.where(program.angular[k][:, None], twist[:, 3:], straight)
    return speeds


def point_wrenches(program: Program, forces: Array) -> Array:
    """Force and torque on each part, shape (N, 6), from the force vectors of the rows."""
    total = np.zeros((len(program.names), 6))
    for part, sign in ((program.part_b, 1.0), (program.part_a, -1.0)):
        k = np.flatnonzero(part >= 0)
        turns = program.angular[k][:, None]
        push = np.where(turns, 0.0, forces[k])
        arm = program.point[k] - program.center[part[k]]
        torque = np.where(turns, forces[k], cross(arm, push))
        np.add.at(total, part[k], sign * np.hstack([push, torque]))
    return total


def mobilities(program: Program) -> Array:
    """Scale of the mobility (inverse effective mass) at each row: root of its trace / 3, (K,)."""
    square = np.zeros(len(program.part_a))
    free = np.flatnonzero(program.free)
    inverse = np.zeros((len(program.names), 3, 3))
    inverse[free] = np.linalg.inv(program.inertia[free])
    for part in (program.part_b, program.part_a):
        k = np.flatnonzero((part >= 0) & program.free[part])
        arm, turn = program.point[k] - program.center[part[k]], inverse[part[k]]
        # tr(S I^-1 S^T) of the matrix S of (arm x) is |arm|^2 tr I^-1 - arm.I^-1 arm
        trace = np.einsum("kii->k", turn)
        lever = (arm**2).sum(axis=1) * trace - np.einsum("ki,kij,kj->k", arm, turn, arm)
        square[k] += np.where(program.angular[k], trace, 3.0 / program.mass[part[k]] + lever)
    return np.sqrt(np.where(square > 0, square / 3.0, 1.0))


def _in_units_of_load(
    program: Program, motion: Array, forces: Array, total: float
) -> tuple[Array, Array]:
    """Relative velocities and forces of the rows, scaled by the load |w| and the row mobilities."""
    sigma = mobilities(program)[:, None]
    speeds, pushes = point_speeds(program, motion), forces
    if program.planar:
        plane = np.where(program.angular[:, None], [0.0, 1.0, 0.0], [1.0, 0.0, 1.0])
        speeds, pushes = speeds * plane, pushes * plane
    return speeds / sigma / total, pushes * sigma / total


def _law_residuals(
    program: Program, speeds: Array, pushes: Array, fastest: float
) -> tuple[float, float, float, float, float]:
    """Largest violations of the contact law [-]: opening, cone, normal, angle, stretch."""
    normal, mu, tied = program.normal, program.mu, program.two_sided
    u_n, f_n = (np.einsum("ki,ki->k", normal, vector) for vector in (speeds, pushes))
    u_t = speeds - u_n[:, None] * normal
    f_t = pushes - f_n[:, None] * normal
    if program.planar:
        u_t, f_t = u_t * [1.0, 0.0, 1.0], f_t * [1.0, 0.0, 1.0]
    slip, drag = np.linalg.norm(u_t, axis=1), np.linalg.norm(f_t, axis=1)
    limit = mu * np.maximum(f_n, 0.0)
    opening = np.where(tied, np.abs(u_n), np.maximum(-u_n, 0.0))
    cone = np.where(tied, drag, np.maximum(drag - limit, -f_n))
    slides = ~tied & (slip > STILL * fastest)
    e = u_t / np.maximum(slip, TINY)[:, None]
    angle = np.linalg.norm(f_t + drag[:, None] * e, axis=1) * slides
    stretch = np.abs(drag - limit) * slides
    normal_power = np.where(tied, 0.0, np.abs(u_n * f_n))
    rows = (opening, cone, normal_power, angle, stretch)
    first, second, third, fourth, fifth = (float(row.max(initial=0.0)) for row in rows)
    return first, second, third, fourth, fifth
