"""Coulomb's contact law in scaled, unitless unknowns.

With a the accelerations of the free parts, M their masses and inertias, w the loads on them, J the
relative accelerations of part b past part a at the contact points along (n, u, v) (n the normal
from a to b, u and v across it), and f the forces on b along the same:

    M a = w + J^T f                                              the parts
    u_n >= 0,  f_n >= 0,  u_n f_n = 0                            each contact point, u = J a
    |f_t| <= mu f_n,   f_t.u_t = -mu f_n |u_t|
    u_n = 0                                                      each row of a joint

M = L L^T part by part, |w| = (w.M^-1 w)^(1/2), and sigma is the size of the mobility of a point
(force in, acceleration out: `kilter.mechanics.law_check.mobilities`). In

    x = L^T a / |w|,     H = J L^-T / sigma,     g = sigma f / |w|

the first line, multiplied by L^-1 / |w|, becomes

    x = w' + H^T g,     u' = H x = J a / (sigma |w|),     |w'| = 1

The others stay unchanged, for u' and g in place of u and f, since all three lines of a point share
their sigma. So no unit is left: |x|^2 is a.M a / |w|^2, w'.x is the power, which is 1 in free fall,
and the numbers of light and heavy parts, of near and distant points, are near 1. As

    |x|^2 = w'.x + g.u' = w'.x - sum of mu g_n |u_t'|  <=  w'.x  <=  |x|

every solution has |x| <= 1.

The law is used in two forms. The search of motions (`kilter.friction.motion_search`), the polishing
and the seating use this form: a row for each point, and joints as equations, whose forces they
need. The proof that no motion exists uses `kilter.friction.reduced_law`, with joints eliminated and
points grouped that must slide alike. It bounds unknowns individually, and forces of joints have no
bounds. It also bounds sums of forces of several points, so it measures all of them in a common
unit. The check of a motion, `kilter.mechanics.law_check.check_law`, uses neither form.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array

from kilter.arrays import TINY, Array, Index, Mask, across, cross
from kilter.friction.friction_tolerances import ZERO_ENTRY
from kilter.mechanics.law_check import mobilities
from kilter.mechanics.mechanics_tolerances import STILL, WITNESS_EXACT, WITNESS_SLIVER
from kilter.mechanics.program import Program
from kilter.mechanics.rows import CONTACT, JOINT
from kilter.units import metres_per_unit


@dataclass(frozen=True, slots=True, eq=False)
class CoulombLaw:
    """Coulomb's contact law of a program, in scaled unknowns."""

    program: Program
    matrix: csr_array
    """H; lines 3 k, 3 k + 1, 3 k + 2 along n, u and v of row k. A two-sided row (of a joint) has
    only the first of them; in the plane v is across it, and its line is 0, shape (3 K, n)."""
    load: Array
    """w', of length 1 (0 without load), shape (n,)."""
    basis: Array
    """Unit vectors n, u, v of each row, world frame, shape (K, 3, 3)."""
    mu: Array
    """Friction coefficients [-], shape (K,)."""
    tied: Mask
    """Rows that are equations, shape (K,)."""
    patch: Index
    """Patch number from 0, shape (K,); the points of a contact patch, or the rows of a joint,
    share it."""
    strength: float
    """|w|, the root of w.M^-1 w."""
    sigma: Array
    """Mobility scale of each row, shape (K,)."""
    root: Array
    """L of each free part, in its d freedoms, shape (F, d, d)."""

    def acceleration(self, columns: Array) -> Array:
        """Accelerations [m/s^2], [rad/s^2] of all parts, shape (N, 6), from scaled unknowns x."""
        per = self.root.shape[1]
        scaled = columns.reshape(-1, per, 1) * self.strength
        motion = np.asarray(np.linalg.solve(np.swapaxes(self.root, 1, 2), scaled), np.float64)
        full = self.program.full(motion.reshape(-1))
        full[:, 3:] /= metres_per_unit(self.program.units)
        return full

    def columns(self, acceleration: Array) -> Array:
        """Scaled unknowns x from accelerations [m/s^2], [rad/s^2] of all parts, shape (N, 6)."""
        motion = acceleration.copy()
        motion[:, 3:] *= metres_per_unit(self.program.units)
        motion = motion[self.program.free][:, self.program.freedoms]
        scaled: Array = np.einsum("nji,nj->ni", self.root, motion).reshape(-1) / self.strength
        return scaled

    def forces(self, scaled: Array) -> Array:
        """Forces on part b [N], world frame, shape (K, 3), from scaled forces along (n, u, v)."""
        local = scaled * (self.strength / self.sigma)[:, None]
        world: Array = np.einsum("kij,ki->kj", self.basis, local)
        return world


def coulomb_law(program: Program) -> CoulombLaw:
    """Build Coulomb's contact law of a program in scaled unknowns."""
    free = np.flatnonzero(program.free)
    mass = np.zeros((len(free), 6, 6))
    mass[:, range(3), range(3)] = program.mass[free][:, None]
    mass[:, 3:, 3:] = program.inertia[free]
    mass = mass[:, program.freedoms][:, :, program.freedoms]
    root = np.asarray(np.linalg.cholesky(mass), np.float64)
    load = program.load[free][:, program.freedoms]
    load = np.asarray(np.linalg.solve(root, load[..., None]), np.float64).reshape(-1)
    strength = float(np.linalg.norm(load))
    sigma = mobilities(program)
    basis = np.concatenate([program.normal[:, None], _directions(program)], axis=1)
    return CoulombLaw(
        program=program,
        matrix=_matrix(program, basis, sigma, root),
        load=load / max(strength, TINY),
        basis=basis,
        mu=np.where(program.two_sided, 0.0, program.mu),
        tied=program.two_sided,
        patch=_patches(program),
        strength=strength,
        sigma=sigma,
        root=root,
    )


def _directions(program: Program) -> Array:
    """Unit tangents u and v of each row, (K, 2, 3); in a planar assembly u is in the plane."""
    directions = np.stack(across(program.normal), axis=1)
    if program.planar:
        n = program.normal
        u = cross(np.array([0.0, 1.0, 0.0]), n)
        size = np.linalg.norm(u, axis=1)
        within = size > 0  # 0 for a face parallel to the plane
        u = u[within] / size[within, None]
        directions[within] = np.stack([u, cross(n[within], u)], axis=1)
    return directions


def _patches(program: Program) -> Index:
    """Number of the contact patch or joint of each row; other rows get separate numbers."""
    count = len(program.source)
    if not count:
        return np.empty(0, dtype=np.int64)
    sourced = np.isin(program.kind, (CONTACT, JOINT)) & (program.source >= 0)
    alone = np.where(sourced, -1, np.arange(count))
    keys = [program.kind, program.source, program.part_a, program.part_b, alone]
    _, patch = np.unique(np.column_stack(keys), axis=0, return_inverse=True)
    return patch.reshape(-1)


def _matrix(program: Program, basis: Array, sigma: Array, root: Array) -> csr_array:
    """Matrix H from scaled unknowns to relative accelerations at the rows, shape (3 K, n)."""
    per = len(program.freedoms)
    column = np.full(len(program.names) + 1, -1)
    column[:-1][program.free] = np.arange(len(root))
    data, rows, cols = [], [], []
    for part, sign in ((program.part_b, 1.0), (program.part_a, -1.0)):
        k = np.flatnonzero(column[part] >= 0)
        owner = column[part[k]]
        arm = (program.point[k] - program.center[part[k]])[:, None]
        turning = program.angular[k][:, None, None]
        direction = basis[k]
        moment = cross(np.broadcast_to(arm, direction.shape), direction)
        straight = np.where(turning, 0.0, direction)
        lever = np.concatenate([straight, np.where(turning, direction, moment)], axis=2)
        lever = lever[:, :, program.freedoms] * (sign / sigma[k])[:, None, None]
        lever = np.linalg.solve(root[owner], np.swapaxes(lever, 1, 2)).swapaxes(1, 2)
        lever[program.two_sided[k], 1:] = 0.0
        lever[np.abs(lever) < ZERO_ENTRY] = 0.0
        row = (3 * k[:, None] + np.arange(3))[:, :, None]
        col = (owner[:, None] * per + np.arange(per))[:, None, :]
        data.append(lever.reshape(-1))
        rows.append(np.broadcast_to(row, lever.shape).reshape(-1))
        cols.append(np.broadcast_to(col, lever.shape).reshape(-1))
    values = np.concatenate(data)
    used = values != 0
    places = (np.concatenate(rows)[used], np.concatenate(cols)[used])
    return csr_array((values[used], places), shape=(3 * len(program.part_a), per * len(root)))


# Quick test of how much a candidate motion violates Coulomb's law, in scaled unknowns.


ROUNDING = 2.0
"""Allowance for rounding: factor by which a residual may exceed the limit of the full check."""


def breach(law: CoulombLaw, x: Array, forces: Array) -> float:
    """Power that a candidate motion gains because it violates the law [-]; 0 if it obeys."""
    u = (law.matrix @ x).reshape(-1, 3)
    slip = np.linalg.norm(u[:, 1:], axis=1)
    gained = (forces * u).sum(axis=1) + law.mu * forces[:, 0] * slip
    return float(gained[~law.tied].sum())


def may_obey(law: CoulombLaw, x: Array, forces: Array) -> bool:
    """True if a candidate motion gains power and nearly obeys the law, so it deserves a check."""
    size = float(x @ x)
    if not float(law.load @ x) > 0.0:
        return False
    limit = ROUNDING * min(WITNESS_EXACT * np.sqrt(size), WITNESS_SLIVER * size)
    balance = np.linalg.norm(x - law.load - law.matrix.T @ forces.reshape(-1))
    return bool(balance <= limit) and _law_residual(law, x, forces, np.sqrt(size)) <= limit


def _law_residual(law: CoulombLaw, x: Array, forces: Array, fastest: float) -> float:
    """Largest violation of the contact law by a candidate, over the kinds of `LawProof` [-]."""
    u, tied = (law.matrix @ x).reshape(-1, 3), law.tied
    u_n, f_n, u_t, f_t = u[:, 0], forces[:, 0], u[:, 1:], forces[:, 1:]
    slip, drag = np.linalg.norm(u_t, axis=1), np.linalg.norm(f_t, axis=1)
    limit = law.mu * np.maximum(f_n, 0.0)
    rows = [
        np.where(tied, np.abs(u_n), -u_n),
        np.where(tied, drag, np.maximum(drag - limit, -f_n)),
        np.where(tied, 0.0, np.abs(u_n * f_n)),
    ]
    slides = ~tied & (slip > STILL * fastest)
    along = u_t[slides] / np.maximum(slip[slides], TINY)[:, None]
    rows += [
        np.linalg.norm(f_t[slides] + drag[slides, None] * along, axis=1),
        np.abs(drag - limit)[slides],
    ]
    return max(float(row.max(initial=0.0)) for row in rows)
