"""Contact gaps to second order and the constant load near a configuration, in scaled unknowns.

Part i moves by x -> c + r + exp(theta)(x - c). The energy is linear in these coordinates, and the
gap of contact k is

    phi_k(z) = J_k z + 1/2 z.H_k z + O(3),      E(z) = -w.z,

so that all curvature is that of the gaps. Springs of joints add z.S z / 2 to E. A contact needs
phi_k >= 0. The row of a joint is two-sided: it needs phi_k = 0, and its force has either sign. The
unknowns are (r, rho theta) over the length L. Forces are over the weight W, and energies over W L:
no number here has a unit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from kilter.arrays import TINY, Array, Index, Mask, read_only
from kilter.assembly import Joint
from kilter.mechanics.program import Program
from kilter.second_order.gaps.features import Features
from kilter.second_order.gaps.gap_form import corner_slips, formed, gap_forms
from kilter.second_order.gaps.joint_forms import joint_forms, of_joints, on_joints, spring_form
from kilter.second_order.second_order_tolerances import ACROSS


@dataclass(frozen=True, slots=True, eq=False)
class Stationary:
    """Contact gaps and load to second order, for n scaled unknowns and K contact rows."""

    rows: Array
    """First derivatives J of the gaps, shape (K, n)."""
    load: Array
    """The load w, shape (n,)."""
    forms: Array
    """Second derivatives H_k of the gaps, in the unknowns of both parts, shape (K, 12, 12)."""
    columns: Index
    """Indices of these among the n unknowns, shape (K, 12); -1 for held parts."""
    blur: float = 1e-9
    """Numbers below this fraction of the largest are rounding of the data."""
    length: float = 1.0
    weight: float = 1.0
    """L [length unit] and W [N]."""
    scale: Array | None = None
    """Displacement for a unit of each unknown [length unit, rad], shape (n,)."""
    on_plane: Mask | None = None
    """Rows in which at least one part touches with a plane, which is exact to all orders, shape
    (K,)."""
    slips: Array | None = None
    """Turn and slip at flush corners (`corner_slips`); 0 for other rows, shape (K, 4, 12)."""
    joined: Mask | None = None
    """Two-sided rows, which belong to joints, shape (K,); None if there are none."""
    limits: Array | None = None
    """Largest force of each row, over the weight [-], shape (K,): that of joint friction."""
    springs: Array | None = None
    """Second derivative S of the energy of springs, shape (n, n)."""

    def __post_init__(self) -> None:
        read_only(self)

    def taking(self, rows: Index | Mask) -> Stationary:
        """The same problem with a subset of its contact rows."""
        return Stationary(
            self.rows[rows],
            self.load,
            self.forms[rows],
            self.columns[rows],
            self.blur,
            self.length,
            self.weight,
            self.scale,
            None if self.on_plane is None else self.on_plane[rows],
            None if self.slips is None else self.slips[rows],
            None if self.joined is None else self.joined[rows],
            None if self.limits is None else self.limits[rows],
            self.springs,
        )

    @property
    def two_sided(self) -> Mask:
        """Mask of the rows of joints, whose gap stays 0 and whose force has either sign, (K,)."""
        return np.zeros(len(self.rows), dtype=bool) if self.joined is None else self.joined

    def pushes(self, forces: Array) -> Array:
        """Copy of forces, (K,), in which contacts that would pull have the force 0."""
        return np.where(self.two_sided, forces, np.maximum(forces, 0.0))

    @property
    def planes(self) -> Mask:
        """Mask of rows at which at least one of both features is a plane, shape (K,)."""
        if self.on_plane is None:
            return np.zeros(len(self.rows), dtype=bool)
        return self.on_plane

    def _spread(self, vectors: Array) -> Array:
        """Rows of vectors (n, d) that belong to the two parts of each contact, shape (K, 12, d)."""
        padded = np.vstack([vectors, np.zeros((1, vectors.shape[1]))])
        return padded[self.columns]

    def restricted(self, basis: Array) -> Array:
        """Second derivatives Z^T H_k Z of the gaps in a basis Z, (n, d); shape (K, d, d)."""
        spread = self._spread(basis)
        return np.asarray(np.swapaxes(spread, 1, 2) @ self.forms @ spread)

    def bends(self, motion: Array) -> Array:
        """Second derivatives z.H_k z of the gaps along a motion z, shape (n,); result (K,)."""
        spread = self._spread(motion[:, None])[:, :, 0]
        return np.asarray(np.einsum("ki,kij,kj->k", spread, self.forms, spread))

    def sliding(self, motions: Array) -> Array:
        """Slips of corners at which both faces end, along motions (n, d), shape (2 K, d)."""
        if self.slips is None:
            return np.zeros((0, motions.shape[1]))
        slips = self.slips[:, 2:] @ self._spread(motions)
        return np.asarray(slips.reshape(2 * len(slips), motions.shape[1]))

    def slipped(self, forces: Array, basis: Array) -> Array:
        """Change of the energy's curvature, (d, d), if corners where two faces end slip off."""
        if self.slips is None:
            return np.zeros((basis.shape[1],) * 2)
        turn, slip = np.split(self.slips @ self._spread(basis), 2, axis=1)
        more = np.einsum("k,kia,kib->ab", forces, turn, slip)
        return np.asarray(more + more.T)

    def one_form(self, motions: Array) -> Mask:
        """Mask of rows, (K,), at which no corner slips off the end of a face along motions (n, d).

        The motions do not turn the parts there, or do not slip.
        """
        if self.slips is None:
            return np.ones(len(self.rows), dtype=bool)
        moved = np.abs(self.slips @ self._spread(motions)).max(axis=2, initial=0.0)
        stays: Mask = np.minimum(moved[:, :2].max(axis=1), moved[:, 2:].max(axis=1)) < ACROSS
        return stays

    def stress_curvature(self, forces: Array, basis: Array) -> Array:
        """Second derivative of the energy by self-stress, in a basis Z, shape (d, d)."""
        weighted = np.tensordot(forces, self.restricted(basis), axes=1)
        return -(weighted + weighted.T) / 2

    def spring_curvature(self, basis: Array) -> Array:
        """Second derivative of the energy of springs, in a basis Z, shape (d, d)."""
        if self.springs is None:
            return np.zeros((basis.shape[1],) * 2)
        return np.asarray(basis.T @ self.springs @ basis)

    def curvature(self, forces: Array, basis: Array) -> Array:
        """Second derivative of the energy under contact forces, in a basis Z, shape (d, d)."""
        return self.stress_curvature(forces, basis) + self.spring_curvature(basis)

    def spring_cost(self, motion: Array) -> float:
        """Second derivative of the energy of springs along a motion, shape (n,)."""
        return float(self.spring_curvature(motion[:, None])[0, 0])

    def imbalance(self, forces: Array) -> float:
        """Largest imbalance of contact forces, over the largest entry of the load [-].

        It is not relative to the forces: beside large forces the load would pass for rounding.
        """
        left = np.abs(self.rows.T @ forces + self.load).max(initial=0.0)
        return float(left / max(np.abs(self.load).max(initial=0.0), TINY))


def problem_of(program: Program, features: Features, joints: Sequence[Joint] = ()) -> Stationary:
    """Build the gaps and the load of a program to second order, without friction."""
    forms = np.nan_to_num(gap_forms(program, features)) + joint_forms(program, joints)
    slips = corner_slips(program, features) if features.flush.any() else None
    problem, springs = stationary(program, forms, slips), spring_form(program, joints)
    if springs is None or problem.scale is None:
        return problem
    units = np.outer(problem.scale, problem.scale) / (problem.weight * problem.length)
    return replace(problem, springs=springs * units)


def stationary(program: Program, forms: Array, slips: Array | None = None) -> Stationary:
    """Scale a second-order problem whose gap derivatives are given in physical units.

    Arguments: `forms` (K, 12, 12); `slips` (K, 4, 12) [rad].
    """
    free, per = np.flatnonzero(program.free), len(program.freedoms)
    length = float(np.exp(np.log(program.radius[free]).mean()))
    weight = float(np.exp(np.log(program.weight[free]).mean()))
    six = np.ones((len(program.names) + 1, 6))
    six[:, :3] = length
    six[:-1, 3:] = (length / program.radius)[:, None]
    place = np.full((len(program.names) + 1, 6), -1)
    place[np.ix_(free, program.freedoms)] = np.arange(per * len(free)).reshape(-1, per)
    both = np.stack([program.part_a, program.part_b], axis=1)
    twelve = six[both].reshape(-1, 12)
    scale = six[np.ix_(free, program.freedoms)].reshape(-1)
    if slips is not None:
        slips = slips * twelve[:, None] / np.array([1, 1, length, length])[:, None]
    load, joined = program.load[np.ix_(free, program.freedoms)].reshape(-1), on_joints(program)
    return Stationary(
        program.jacobian().toarray() * program.arm[:, None] * scale / length,
        load * scale / (weight * length),
        forms * twelve[:, :, None] * twelve[:, None, :] / length,
        place[both].reshape(-1, 12),
        float(max(1e-9, 10 * program.tolerance.max(initial=0.0))),
        length,
        weight,
        scale,
        slips=slips,
        joined=joined if joined.any() else None,
        limits=program.capacity / (program.arm * weight) if len(program.bounded) else None,
    )


# Second derivatives of gaps that are valid for every surface that a mesh may represent.


def formed_for_all(program: Program, features: Features) -> Mask:
    """Mask of rows whose gap has a second derivative whatever the true surfaces are, (K,)."""
    rows = formed(program, features)
    if features.doubted:
        rows &= formed(program, _bent(features, program.normal, -1.0))
    return rows | of_joints(program)


def bounded(
    program: Program, features: Features, sense: float, joints: Sequence[Joint] = ()
) -> Stationary:
    """Gaps and load to second order, at the upper (1) or lower (-1) bounds of curvature."""
    bent = _bent(features, program.normal, sense)
    return problem_of(program, bent, joints)


def _bent(features: Features, normal: Array, sense: float) -> Features:
    """Copy of the features with each curvature moved to its upper or lower bound."""
    plane = np.eye(3) - normal[:, :, None] * normal[:, None, :]
    return replace(
        features,
        curvature_a=features.curvature_a + sense * features.doubt_a[:, None, None] * plane,
        curvature_b=features.curvature_b + sense * features.doubt_b[:, None, None] * plane,
    )
