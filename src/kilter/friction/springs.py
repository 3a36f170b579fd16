"""Elastic contacts: forces from displacements of the parts, and the imbalance they leave.

With a stiffness k along the normal, 0.7 k across it, and a gap g >= 0 at each point, a small
displacement x of the parts produces the forces

    f_n = k max(0, -(u_n + g)),   f_t = -0.7 k u_t, cut to |f_t| <= mu f_n,      u = H x
    r(x) = w + H^T f(H x)

(scaled as in `kilter.friction.law`, x being a displacement here). Each force is exactly in its
cone, so if r = 0 the forces are forces of equilibrium. The magnitude of k has no effect.

Systems (d - dr/dx) dx = y are solved by `kilter.friction.spring_matrix`.
"""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array

from kilter.arrays import TINY, Array, Index
from kilter.friction.law import CoulombLaw
from kilter.friction.spring_matrix import SpringMatrix, spring_matrix
from kilter.work import BAND_POINT, Work

ACROSS = 0.7
"""Stiffness across a contact over that along its normal: about that of two elastic bodies."""
RUN = 4
"""Number of points of a pair whose levers are multiplied together; a face has about as many
corners."""


@dataclass(slots=True)
class SpringState:
    """State of the contact springs: displacement x, point displacements, forces and imbalance r."""

    x: Array
    opening: Array
    forces: Array
    rest: Array


@dataclass(frozen=True, slots=True, eq=False)
class Slopes:
    """Derivatives -df/du of contact forces by the displacements of their points.

    With the direction e of the friction force of a sliding point,

        -df_n/du_n = normal,      -df_t/du_t = across I - sliding e e^T,
        -df_t/du_n = coupling e,  -df_n/du_t = dilation e^T
    """

    normal: Array
    across: Array
    sliding: Array
    coupling: Array
    dilation: Array
    """`dilation` is 0 for Coulomb's law, shape (K,)."""
    direction: Array
    """e; 0 for points that do not slide, shape (2, K)."""


@dataclass(frozen=True, slots=True, eq=False)
class SpringSystem:
    """Data of the spring equations that do not depend on stiffness, gap or displacement."""

    law: CoulombLaw
    transposed: csr_array
    """H^T."""
    lever: Array
    """H of the points by their two parts, of d freedoms, in runs of at most M points of a pair,
    shape (C, M, 3, 2 d); 0 for the missing points of a run."""
    points: Index
    """The rows of the points of each run, shape (C, M); K for a missing point."""
    begins: Index
    """First run of each pair, shape (P,)."""
    matrix: SpringMatrix
    """Positions of the entries of the pairs."""
    weight: Array
    """Weights of the free parts, in the scale of r."""

    def pair_blocks(self, slope: Array) -> Array:
        """Stiffness matrix of each pair of parts, shape (P, 2 d, 2 d), from slopes of the points.

        Arguments: `slope` (K + 1, 3, 3): derivative -df/du of the force of each point; 0 for the
        last, which stands for none.
        """
        runs, size = len(self.points), self.lever.shape[-1]
        lines = 3 * self.points.shape[1]
        pulls = np.matmul(slope[self.points], self.lever).reshape(runs, lines, size)
        lever = self.lever.reshape(runs, lines, size)
        blocks = np.matmul(np.swapaxes(lever, 1, 2), pulls)
        return np.add.reduceat(blocks, self.begins, axis=0) if runs else blocks


def spring_system(law: CoulombLaw) -> SpringSystem:
    """Build the shared data of the spring equations of a contact law."""
    program, per = law.program, law.root.shape[1]
    index = np.full(len(program.names) + 1, -1)  # the ground is the last
    index[:-1][program.free] = np.arange(len(law.root))
    ends = np.sort(np.column_stack([index[program.part_a], index[program.part_b]]), axis=1)
    pairs, pair = np.unique(ends, axis=0, return_inverse=True)
    points, begins = _runs_of_points(pair.reshape(-1), len(pairs))
    lever = np.concatenate([_pair_levers(law, ends, per), np.zeros((1, 3, 2 * per))])[points]
    matrix = spring_matrix(pairs, program.center[program.free], per)
    transposed = law.matrix.T.tocsr()
    return SpringSystem(law, transposed, lever, points, begins, matrix, _scaled_weights(law))


def _runs_of_points(pair: Index, pairs: int) -> tuple[Index, Index]:
    """Contact points of each pair, in groups of `RUN`, and the first group of each pair."""
    count = np.bincount(pair, minlength=pairs)
    runs = -(-count // RUN)
    begins = np.cumsum(runs) - runs
    order = np.argsort(pair, kind="stable")
    place = np.arange(len(pair)) - np.repeat(np.cumsum(count) - count, count)
    points = np.full(int(runs.sum()) * RUN, len(pair))
    points[RUN * begins[pair[order]] + place] = order
    return points.reshape(-1, RUN), begins


def _scaled_weights(law: CoulombLaw) -> Array:
    """Weights of the free parts, scaled as the imbalance r."""
    part = np.flatnonzero(law.program.free)
    weight = law.program.weight[part] / np.sqrt(law.program.mass[part]) / max(law.strength, TINY)
    least: Array = np.maximum(weight, TINY)
    return least


def _pair_levers(law: CoulombLaw, ends: Index, per: int) -> Array:
    """Lever matrices of each contact point on its two parts, shape (K, 3, 2 d)."""
    entries = law.matrix.tocoo()
    point, line = entries.row // 3, entries.row % 3
    part, freedom = entries.col // per, entries.col % per
    side = (ends[point, 1] == part).astype(np.int64)
    lever = np.zeros((len(ends), 3, 2 * per))
    lever[point, line, side * per + freedom] = entries.data
    return lever


class Springs:
    """Balance equations r(x) = 0 of parts on contact springs of given stiffnesses and gaps.

    Arguments: `stiffness` (K,); `gap` (K,): default: 0.
    """

    def __init__(self, system: SpringSystem, stiffness: Array, gap: Array | None = None) -> None:
        self.system, self.stiffness = system, stiffness
        self.opening = np.zeros((len(stiffness), 3))
        if gap is not None:
            self.opening[:, 0] = gap

    def at(self, x: Array) -> SpringState:
        """Contact forces and imbalance at a displacement x of the parts."""
        u = (self.system.law.matrix @ x).reshape(-1, 3) + self.opening
        forces = self.forces(u)
        rest = self.system.law.load + self.system.transposed @ forces.reshape(-1)
        return SpringState(x, u, forces, rest)

    def moved(self, state: SpringState) -> Springs:
        """The same springs with displacements measured from a state, which is x = 0 for them.

        The rounding error of H x, which grows with x, then becomes an error of the gaps. So parts
        that have moved far, as in a long arch, still reach an exact balance.
        """
        other = copy(self)
        other.opening = state.opening
        return other

    def forces(self, u: Array) -> Array:
        """Contact forces (n, u, v) from the displacements of the points, shape (K, 3)."""
        return _contact_forces(self.system.law, self.stiffness, u)

    def imbalance(self, state: SpringState) -> float:
        """Largest imbalance of a part, divided by the part's weight [-]."""
        weight = self.system.weight
        rest = np.linalg.norm(state.rest.reshape(len(weight), -1), axis=1)
        return float((rest / weight).max())

    def newton(
        self, state: SpringState, right: Array, drag: float, work: Work, *, exact: bool = True
    ) -> Array:
        """Newton step dx of the balance equations: (drag - dr/dx) dx = right.

        Arguments: `right` (n,). Raises `numpy.linalg.LinAlgError` if the system is singular.
        """
        system = self.system
        blocks = system.pair_blocks(self.slope_matrices(state, exact=exact))
        solve = system.matrix.solve if exact else system.matrix.solve_symmetric
        work.charge(BAND_POINT * len(system.law.mu))
        return solve(blocks, drag, right, work)

    def slopes(self, state: SpringState) -> Slopes:
        """Derivatives of the forces of the points by their displacements."""
        return _contact_slopes(self.system.law, self.stiffness, state.opening)

    def slope_matrices(self, state: SpringState, *, exact: bool) -> Array:
        """Derivative -df/du of the forces of the points, shape (K + 1, 3, 3); 0 for the last.

        If `exact` is False, the derivatives of sliding forces by normal forces, and the reverse,
        are left out. The matrices are then symmetric and positive semidefinite.
        """
        return _slope_matrices(self.slopes(state), exact)


def _contact_forces(law: CoulombLaw, stiffness: Array, u: Array) -> Array:
    """Contact forces (n, u, v) from displacements u of the points, shape (K, 3)."""
    touching = (u[:, 0] < 0) | law.tied
    forces = u * (-stiffness * touching)[:, None]
    forces[:, 1:] *= ACROSS
    limit = np.where(law.tied, 0.0, law.mu * forces[:, 0])
    drag = np.hypot(forces[:, 1], forces[:, 2])
    slides = np.flatnonzero(drag > limit)
    forces[slides, 1:] *= (limit[slides] / drag[slides])[:, None]
    return forces


def _contact_slopes(law: CoulombLaw, stiffness: Array, u: Array) -> Slopes:
    """Derivatives of the contact forces by point displacements u, shape (K, 3)."""
    touching = (u[:, 0] < 0) | law.tied
    normal = stiffness * touching
    across = ACROSS * normal
    drag = across * np.hypot(u[:, 1], u[:, 2])
    limit = np.where(law.tied, 0.0, law.mu * normal * -u[:, 0])
    slides = (drag > limit) & ~law.tied
    share = np.where(drag > limit, limit / np.maximum(drag, TINY), 1.0)
    direction = u[:, 1:].T * (-across * slides / np.maximum(drag, TINY))
    across *= share
    coupling = law.mu * normal * slides
    return Slopes(normal, across, across * slides, coupling, np.zeros(len(u)), direction)


def _slope_matrices(slopes: Slopes, exact: bool) -> Array:
    """Slopes as matrices, shape (K + 1, 3, 3); 0 for the last."""
    count = len(slopes.normal)
    matrices = np.zeros((count + 1, 3, 3))
    along = matrices[:count]
    e = slopes.direction.T
    along[:, 0, 0] = slopes.normal
    if exact:
        along[:, 1:, 0] = slopes.coupling[:, None] * e
        along[:, 0, 1:] = slopes.dilation[:, None] * e
    along[:, 1:, 1:] = -slopes.sliding[:, None, None] * e[:, :, None] * e[:, None, :]
    along[:, 1, 1] += slopes.across
    along[:, 2, 2] += slopes.across
    return matrices
