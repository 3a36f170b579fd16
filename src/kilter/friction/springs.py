"""Contacts that give a little: forces from a displacement, and the balance of the parts.

With a stiffness k along the normal, 0.7 k across it, and a gap g >= 0 at each point, a small
displacement x of the parts produces the forces

    f_n = k max(0, -(u_n + g)),   f_t = -0.7 k u_t, cut to |f_t| <= mu f_n,      u = H x
    r(x) = w + H^T f(H x)

(scaled as in `kilter.friction.law`, x being a displacement here). Each force is exactly in its
cone, so if r = 0 the forces are forces of equilibrium. The magnitude of k has no effect.

Systems (d - dr/dx) dx = y are solved by a band matrix, with parts in reverse Cuthill-McKee order,
or by a sparse matrix if the band is wide.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csc_array, csr_array

from kilter.arrays import TINY, Array, Index
from kilter.friction.law import CoulombLaw
from kilter.work import Work

__all__ = ["ACROSS", "SpringState", "SpringSystem", "Springs", "spring_system"]

ACROSS = 0.7
"""Stiffness across a contact over that along its normal: about that of two elastic bodies."""
WIDEST_BAND = 400
"""Half width of a band above which systems are solved as sparse systems."""


@dataclass(slots=True)
class SpringState:
    """A displacement x and its consequences: u with gaps, forces (n, u, v), and the imbalance r."""

    x: Array
    opening: Array
    forces: Array
    rest: Array


@dataclass(frozen=True, slots=True, eq=False)
class SpringSystem:
    """Positions of the entries of -dr/dx, equal for all stiffnesses, gaps and displacements.

    Attributes
    ----------
    law : CoulombLaw
    transposed : csr_array
        H^T.
    lever : ndarray, shape (K, 3, 2 d)
        H of each point by its two parts, of d freedoms; points of a pair are consecutive.
    points : ndarray of int, shape (K,)
        The rows in that order.
    pair : ndarray of int, shape (K,)
        The pair of each point in it.
    place : ndarray of int, shape (pairs, 2 d x 2 d)
        Position of each entry of a pair: in the band, or among the stored entries.
    band : int
        Half width of the band; 0 for a sparse system.
    order : ndarray of int, shape (n,)
        Position of each unknown in the system.
    row, start : ndarray of int
        Row indices and column starts of a sparse system, as in a csc_array; else empty.
    weight : ndarray
        Weights of the free parts, in the scale of r.
    """

    law: CoulombLaw
    transposed: csr_array
    lever: Array
    points: Index
    pair: Index
    place: Index
    band: int
    order: Index
    row: Index
    start: Index
    weight: Array


def spring_system(law: CoulombLaw) -> SpringSystem:
    """The positions of the entries of a law's systems."""
    program, per = law.program, law.root.shape[1]
    index = np.full(len(program.names), -1)
    index[program.free] = np.arange(len(law.root))
    ends = np.column_stack([index[program.part_a], index[program.part_b]])
    points = np.lexsort((ends[:, 1], ends[:, 0]))
    pairs, pair = np.unique(ends[points], axis=0, return_inverse=True)
    lever = _pair_levers(law, ends, per)[points]
    rank = _elimination_ranks(pairs, len(law.root))
    order = (per * rank[:, None] + np.arange(per)).reshape(-1)
    held = pairs < 0
    unknown = per * rank[np.where(held, 0, pairs)][:, :, None] + np.arange(per)
    unknown = np.where(held[:, :, None], -1, unknown).reshape(len(pairs), 2 * per)
    i = np.broadcast_to(unknown[:, :, None], (len(pairs), 2 * per, 2 * per)).reshape(-1)
    j = np.broadcast_to(unknown[:, None, :], (len(pairs), 2 * per, 2 * per)).reshape(-1)
    used = (i >= 0) & (j >= 0)
    band = max(int(np.abs(i - j)[used].max(initial=0)), 1)
    row = start = np.empty(0, dtype=np.int64)
    if band <= WIDEST_BAND:
        count = (3 * band + 1) * len(law.load)
        place = np.where(used, (2 * band + i - j) * len(law.load) + j, count)
    else:
        place, row, start = _sparse_positions(i, j, used, len(law.load))
        band = 0
    return SpringSystem(
        law, law.matrix.T.tocsr(), lever, points, pair.reshape(-1),
        place.reshape(len(pairs), 4 * per * per), band, order, row, start, _scaled_weights(law),
    )  # fmt: skip


def _scaled_weights(law: CoulombLaw) -> Array:
    """Weights of the free parts, in the scale of r."""
    part = np.flatnonzero(law.program.free)
    weight = law.program.weight[part] / np.sqrt(law.program.mass[part]) / max(law.strength, TINY)
    least: Array = np.maximum(weight, TINY)
    return least


def _pair_levers(law: CoulombLaw, ends: Index, per: int) -> Array:
    """H of each point by its first and second part, shape (K, 3, 2 d)."""
    entries = law.matrix.tocoo()
    point, line = entries.row // 3, entries.row % 3
    part, freedom = entries.col // per, entries.col % per
    side = (ends[point, 1] == part).astype(np.int64)
    lever = np.zeros((len(ends), 3, 2 * per))
    lever[point, line, side * per + freedom] = entries.data
    return lever


def _elimination_ranks(pairs: Index, count: int) -> Index:
    """Position of each part in an order that keeps touching parts close."""
    from scipy.sparse.csgraph import reverse_cuthill_mckee  # slow to import

    both = pairs[(pairs >= 0).all(axis=1)]
    ones = np.ones(2 * len(both))
    graph = csr_array((ones, (both.T.reshape(-1), both[:, ::-1].T.reshape(-1))), (count, count))
    rank = np.empty(count, dtype=np.int64)
    rank[reverse_cuthill_mckee(graph, symmetric_mode=True)] = np.arange(count)
    return rank


def _sparse_positions(
    i: Index, j: Index, used: np.ndarray, count: int
) -> tuple[Index, Index, Index]:
    """Positions of entries in a csc_array with a full diagonal; its rows and column starts."""
    diagonal = np.arange(count) * (count + 1)
    keys, inverse = np.unique(np.concatenate([j[used] * count + i[used], diagonal]),
                              return_inverse=True)  # fmt: skip
    place = np.full(len(i), len(keys))
    place[used] = inverse.reshape(-1)[: int(used.sum())]
    start = np.searchsorted(keys, np.arange(count + 1) * count)
    return place, keys % count, start


class Springs:
    """The equations r(x) = 0 for given stiffnesses and gaps of the points.

    Parameters
    ----------
    system : SpringSystem
    stiffness : ndarray, shape (K,)
    gap : ndarray, shape (K,), optional
        Default: 0.
    """

    def __init__(self, system: SpringSystem, stiffness: Array, gap: Array | None = None) -> None:
        self.system, self.stiffness = system, stiffness
        self.gap = np.zeros(len(stiffness)) if gap is None else gap

    def at(self, x: Array) -> SpringState:
        """Forces and imbalance at a displacement x of the parts."""
        law = self.system.law
        u = (law.matrix @ x).reshape(-1, 3)
        u[:, 0] += self.gap
        forces = _contact_forces(law, self.stiffness, u)
        return SpringState(x, u, forces, law.load + self.system.transposed @ forces.reshape(-1))

    def imbalance(self, state: SpringState) -> float:
        """Worst imbalance of a part over its weight."""
        weight = self.system.weight
        rest = np.linalg.norm(state.rest.reshape(len(weight), -1), axis=1)
        return float((rest / weight).max())

    def newton(self, state: SpringState, right: Array, drag: float, work: Work) -> Array:
        """The step dx of (drag - dr/dx) dx = right.

        Raises
        ------
        numpy.linalg.LinAlgError
            If the system is singular.
        """
        system, count = self.system, len(right)
        place, blocks = self._pair_blocks(state)
        if system.band:
            return self._solve_band(place, blocks, right, drag, work)
        values = _sum_entries(place, blocks, len(system.row))
        matrix = csc_array((values, system.row, system.start), shape=(count, count))
        matrix.setdiag(matrix.diagonal() + drag)
        return _solve_sparse(matrix, right[np.argsort(system.order)], work)[system.order]

    def _pair_blocks(self, state: SpringState) -> tuple[Index, Array]:
        """Positions and entries of -dr/dx of the touching pairs."""
        system, law = self.system, self.system.law
        touching = (state.opening[:, 0] < 0) | law.tied
        used = np.flatnonzero(touching[system.points])
        points, pair, lever = system.points[used], system.pair[used], system.lever[used]
        slope = _contact_slopes(law, self.stiffness, state.opening, points)
        blocks = np.matmul(np.swapaxes(lever, 1, 2), np.matmul(slope, lever))
        begins = np.flatnonzero(np.diff(pair, prepend=-1))
        if len(begins):
            blocks = np.add.reduceat(blocks, begins, axis=0)
        return system.place[pair[begins]], blocks

    def _solve_band(
        self, place: Index, blocks: Array, right: Array, drag: float, work: Work
    ) -> Array:
        """Solve the system as a band matrix."""
        from scipy.linalg.lapack import dgbsv

        system, count, band = self.system, len(right), self.system.band
        size = (3 * band + 1) * count
        values = _sum_entries(place, blocks, size)
        matrix = values.reshape(3 * band + 1, count)
        matrix[2 * band] += drag
        work.band(count, band, len(system.points))
        ordered = np.empty(count)
        ordered[system.order] = right
        _, _, step, failed = dgbsv(band, band, matrix, ordered, overwrite_ab=True)
        if failed:
            raise np.linalg.LinAlgError("the band matrix is singular")
        back: Array = step[system.order]
        return back


def _sum_entries(place: Index, blocks: Array, count: int) -> Array:
    """Entries summed by their positions; entries without a position are dropped."""
    sums = np.bincount(place.reshape(-1), blocks.reshape(-1), minlength=count + 1)[:count]
    return np.asarray(sums, dtype=np.float64)


def _solve_sparse(matrix: csc_array, right: Array, work: Work) -> Array:
    """Solve a sparse system."""
    from scipy.sparse.linalg import splu

    try:
        factor = splu(matrix, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})
    except RuntimeError as error:
        raise np.linalg.LinAlgError(str(error)) from None
    work.sparse(len(right), factor.nnz)
    step: Array = factor.solve(right)
    return step


def _contact_forces(law: CoulombLaw, stiffness: Array, u: Array) -> Array:
    """Forces (n, u, v) from displacements of the points, shape (K, 3)."""
    touching = (u[:, 0] < 0) | law.tied
    forces = u * (-stiffness * touching)[:, None]
    forces[:, 1:] *= ACROSS
    limit = np.where(law.tied, 0.0, law.mu * forces[:, 0])
    drag = np.hypot(forces[:, 1], forces[:, 2])
    slides = np.flatnonzero(drag > limit)
    forces[slides, 1:] *= (limit[slides] / drag[slides])[:, None]
    return forces


def _contact_slopes(law: CoulombLaw, stiffness: Array, u: Array, points: Index) -> Array:
    """Derivative -df/du of touching points, shape (n, 3, 3)."""
    k, tied, mu = stiffness[points], law.tied[points], law.mu[points]
    u, across = u[points], ACROSS * k
    pull = -across[:, None] * u[:, 1:]
    drag = np.hypot(pull[:, 0], pull[:, 1])
    limit = np.where(tied, 0.0, -mu * k * u[:, 0])
    slides = (drag > limit) & ~tied
    tangential_stiffness = np.where(drag > limit, limit / np.maximum(drag, TINY), 1.0) * across
    e = pull / np.maximum(drag, TINY)[:, None]
    slope = np.zeros((len(u), 3, 3))
    slope[:, 0, 0] = k
    slope[:, 1:, 0] = (mu * k * slides)[:, None] * e
    slope[:, 1:, 1:] = tangential_stiffness[:, None, None] * np.eye(2)
    slope[:, 1:, 1:] -= (
        (tangential_stiffness * slides)[:, None, None] * e[:, :, None] * e[:, None, :]
    )
    return slope
