"""Decide whether an equilibrium is a strict energy minimum or a path leads down from it.

1  find the critical motions C (`critical`)
2  divide out the motions that are proved free; motions that no contact curves stay undecided
3  remove motions that self-stress blocks by its curvature (`curved_energy`)
4  forces that curve the energy upward on the rest: minimum
5  else a path that leads down, from the multiplier of 4 (`paths`), or of a single part: balanced
6  else, up to dimension 4, cones with separate forces (copositive matrices of this size are sums of
   an entrywise positive and a semidefinite matrix): minimum, or a path down
7  else open, with the reason

Every decision but "open" has a proof, judged independently of the solver.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable
from typing import Literal

import numpy as np

from kilter.arrays import TINY, Array
from kilter.mechanics.nonnegative import nonnegative
from kilter.second_order.gaps.stationary import Stationary
from kilter.second_order.motions.null_space import null_space
from kilter.second_order.proofs.minimum_proof import (
    Leaf,
    MinimumProof,
    judge_minimum,
    orthants,
    sides_of_cone,
    split,
)
from kilter.second_order.proofs.paths import Path
from kilter.second_order.searches.critical import Critical, find_critical
from kilter.second_order.searches.curved_energy import best_curvature, blocking_stress
from kilter.second_order.searches.energy_decision import EnergyDecision
from kilter.second_order.searches.path_search import find_path
from kilter.second_order.second_order_tolerances import CURVED, FLAT, LEVEL, SPLITS
from kilter.work import Work

EXACT_DIMENSION = 4
"""Largest dimension in which motions are split into cones."""
NARROW = 1e-3
"""Cones are not split below this largest distance of their unit rays [-]."""
MOST_MOTIONS = 24
"""Largest number of neutral motions that are not free, for a decision."""
EXACT = 1e-12
"""Largest imbalance of forces, over the load, at which they exclude falling paths [-]."""
ROUNDS = 4
"""Largest number of searches for self-stress."""


def decide(
    problem: Stationary,
    free: Array | None = None,
    *,
    critical: Critical | None = None,
    only_if_stays: bool = False,
    work: Work | None = None,
) -> EnergyDecision:
    """Decide whether an equilibrium is an energy minimum, is balanced (can fall) or stays open.

    Parameters
    ----------
    problem : Stationary
    free : ndarray, shape (n, f), optional
        Linearly independent motions that are proved to keep every gap and the energy.
    critical : Critical, optional
        Critical motions of this problem, if they are known already.
    only_if_stays : bool
        Whether a single path that leads down is enough, however flat.
    """
    work = work or Work()
    critical = critical or find_critical(problem, work=work)
    if critical is None:
        return EnergyDecision("open", 0, 0, 0, 0, why="no forces of equilibrium were found")
    free = np.zeros((len(problem.load), 0)) if free is None else _even(problem, critical, free)
    across = critical.basis @ null_space(free.T @ critical.basis, problem.blur)
    return _Question(problem, critical, free, across, only_if_stays, work).answer()


def _even(problem: Stationary, critical: Critical, free: Array) -> Array:
    """Free motions whose energy is also constant to second order, shape (n, f').

    This excludes sliding past the edge of a table. The energy must stay level both if flush corners
    stay on their edges and if they slip off.
    """
    both = np.hstack([critical.basis, free])
    curvature = problem.curvature(critical.forces, both)
    curvature = np.vstack([curvature, curvature + problem.slipped(critical.forces, both)])
    size = LEVEL * max(1.0, float(np.abs(curvature).max(initial=0.0)))
    uneven = curvature[:, critical.basis.shape[1] :]
    if np.abs(uneven).max(initial=0.0) <= size:
        return free
    return free @ null_space(np.where(np.abs(uneven) <= size, 0.0, uneven), FLAT)


class _Question:
    """An equilibrium to decide, with its critical motions orthogonal to the free motions."""

    def __init__(
        self,
        problem: Stationary,
        critical: Critical,
        free: Array,
        across: Array,
        only_if_stays: bool,
        work: Work,
    ) -> None:
        self.problem, self.critical, self.work = problem, critical, work
        self.only_if_stays = only_if_stays
        self.balancing = np.zeros((0, len(problem.rows)))
        self.carrying = problem.taking(critical.carries)
        self.free, self.across = free, across
        self.sides = critical.sides @ (critical.basis.T @ across)
        self.neutral = critical.basis.shape[1]
        self.flat = 0

    def answer(self) -> EnergyDecision:
        """Decide from the critical motions: minimum, balanced with a falling path, or open."""
        if not self.across.shape[1]:
            return self._minimum((), (Leaf(self.critical.forces, self._no_weights()),))
        if self.across.shape[1] > MOST_MOTIONS:
            why = f"more than {MOST_MOTIONS} neutral motions are not proved free"
            rest = self.across.shape[1]
            return EnergyDecision("open", self.neutral, self.free.shape[1], 0, rest, why=why)
        if len(self.sides):
            return self._decide_on_basis(self.across, np.zeros(len(self.carrying.rows)))
        curved = self._without_flat()
        self.flat = self.across.shape[1] - curved.shape[1]
        rest, stress = self._without_blocked(curved)
        if rest.shape[1]:
            return self._decide_on_basis(rest, stress)
        forces = self.critical.forces[self.critical.carries]
        return self._strengthened_minimum(forces, stress) or self._open(
            "numerical errors prevent a proof"
        )

    def _no_weights(self) -> Array:
        """Zero matrix of weights, for the inequalities of the critical motions."""
        return np.zeros((len(self.sides), len(self.sides)))

    def _without_flat(self) -> Array:
        """Basis of the critical motions without those for which no contact has curvature.

        Springs curve the energy as contacts do.
        """
        springs = self.carrying.spring_curvature(self.across)[None]
        forms = np.concatenate([self.carrying.restricted(self.across), springs])
        stacked = forms.reshape(-1, forms.shape[2])
        size = float(np.abs(forms).max(initial=0.0))
        if size < FLAT:
            return self.across[:, :0]
        return self.across @ null_space(null_space(stacked, FLAT).T, FLAT)

    def _without_blocked(self, basis: Array) -> tuple[Array, Array]:
        """Basis of the motions that no self-stress excludes, and the self-stress for the others."""
        total = np.zeros(len(self.carrying.rows))
        for _ in range(ROUNDS):
            if not basis.shape[1]:
                break
            stress = blocking_stress(self.carrying, basis, work=self.work)
            if stress is None:
                break
            curvature = self.carrying.stress_curvature(stress, basis)
            values, vectors = np.linalg.eigh(curvature)
            blocked = values > 1e-4 * max(1e-2, values.max(initial=0.0))
            size = float(np.abs(self.carrying.rows.T @ stress).max(initial=0.0))
            if not blocked.any() or size > 1e-6 or values.min() < -1e-6:
                break
            total = total + stress
            basis = basis @ vectors[:, ~blocked]
        return basis, total

    def _decide_on_basis(self, basis: Array, stress: Array) -> EnergyDecision:
        """Look for a minimum or a falling path within a span of motions, given a self-stress."""
        if self._only_forces():
            forces = self.critical.forces[self.critical.carries]
            proved = self._strengthened_minimum(forces, stress)
            if proved is not None:
                return proved
        self._note(self.critical.forces[self.critical.carries])
        best = best_curvature(self.carrying, basis, self.sides_of(basis), work=self.work)
        candidates = list(self._from_forces(basis))
        if best is not None:
            self._note(best.forces)
            proved = self._strengthened_minimum(best.forces, stress, best.sides)
            if proved is not None:
                return proved
            candidates += self._from_multiplier(basis, best.motions)
        paths = self._paths(candidates)
        if not paths or self.carrying.slips is not None:  # at flush corners a tilt is simplest
            paths += self._paths_alone()
        if paths:
            return self._decision("balanced", *paths)
        if basis.shape[1] == self.across.shape[1] <= EXACT_DIMENSION:
            return self._by_cones(basis)
        return self._open("neither forces that prove a minimum nor a path down were found")

    def _only_forces(self) -> bool:
        """True if the equilibrium forces are unique and the inequalities need no weights."""
        rows = self.carrying.rows
        rank = int(np.linalg.matrix_rank(rows, tol=self.problem.blur))
        return not len(self.sides) and rank == len(rows)

    def sides_of(self, basis: Array) -> Array:
        """Matrix of the inequalities of the critical motions, in coordinates of a basis."""
        return self.sides @ (self.across.T @ basis)

    def _from_forces(self, basis: Array) -> list[Array]:
        """The two motions along which the known forces curve the energy least."""
        forces = self.critical.forces[self.critical.carries]
        _, vectors = np.linalg.eigh(self.carrying.curvature(forces, basis))
        return [basis @ vectors[:, k] for k in range(min(2, vectors.shape[1]))]

    def _from_multiplier(self, basis: Array, motions: Array) -> list[Array]:
        """Candidate motions: the main axes of a multiplier matrix, and sums of them."""
        values, vectors = np.linalg.eigh(motions)
        axes = (vectors * np.sqrt(np.maximum(values, 0.0)))[:, ::-1]
        single = [basis @ axes[:, k] for k in range(min(6, axes.shape[1]))]
        most = min(4, axes.shape[1])
        signs = itertools.product((1.0, -1.0), repeat=most - 1)
        return single + [basis @ (axes[:, :most] @ np.array([1.0, *rest])) for rest in signs]

    def _paths(self, candidates: list[Array]) -> list[Path]:
        """Falling paths near the candidate motions, the steepest first."""
        paths = []
        about = self._about_edges(np.hstack([self.across, self.free]))
        for motion in candidates:
            senses = (motion, -motion) if len(self.sides) else (motion,)
            nearest = [self._critical(sense) for sense in senses]
            for critical in (*self._pivots(about, nearest), *nearest):
                path = None if critical is None else self._path(critical)
                if path is not None and path.falls:
                    paths.append(path)
                    if self.only_if_stays:
                        return paths
        return self._steepest(paths)

    def _path(self, critical: Array) -> Path | None:
        """Path along a critical motion; None if there is none, or known forces exclude it."""
        return find_path(self.problem, critical, balancing=self.balancing, work=self.work)

    def _note(self, forces: Array) -> None:
        """Store forces that balance, because such forces exclude falling paths."""
        forces = self._nearest_balanced_forces(forces)
        if self.carrying.imbalance(forces) < EXACT:
            self.balancing = np.vstack([self.balancing, self._spread(forces)])

    def _paths_alone(self) -> list[Path]:
        """Falling paths on which a single part moves, the steepest path first."""
        paths = []
        for motion in self._motions_of_part():
            path = self._path(motion)
            if path is not None and path.falls:
                paths.append(path)
                if self.only_if_stays:
                    break
        return self._steepest(paths)

    def _steepest(self, paths: Iterable[Path]) -> list[Path]:
        """Sort paths by steepness, the steepest first."""
        return sorted(paths, key=lambda path: -min(path.opens, path.power))

    def _motions_of_part(self) -> list[Array]:
        """For each part, critical motions of it alone along which the energy curves least."""
        whole = np.hstack([self.across, self.free])
        columns = self.problem.columns.reshape(-1, 6)
        motions: list[Array | None] = []
        for places in np.unique(columns[(columns >= 0).any(axis=1)], axis=0):
            still = np.ones(len(whole), dtype=bool)
            still[places[places >= 0]] = False
            basis = whole @ null_space(whole[still], self.problem.blur)
            basis[still] = 0.0
            basis, _ = np.linalg.qr(basis)
            for within in (basis, self._about_edges(basis)):
                least = self._from_forces(within) if within.shape[1] else []
                senses = [sense * motion for motion in least for sense in (1.0, -1.0)]
                motions += [self._critical(motion, within) for motion in senses]
        return [motion for motion in motions if motion is not None]

    def _about_edges(self, basis: Array) -> Array:
        """Motions within a basis in which no loaded corner slips off the end of a face."""
        if self.carrying.slips is None:
            return basis[:, :0]
        return basis @ null_space(self.carrying.sliding(basis), self.problem.blur)

    def _pivots(self, about: Array, critical: list[Array | None]) -> list[Array]:
        """Critical motions near given motions in which no corner slips off the end of a face."""
        if not about.shape[1]:
            return []
        near = [about @ (about.T @ motion) for motion in critical if motion is not None]
        opens = [self.sides @ (self.across.T @ motion) for motion in near]
        return [
            motion / np.linalg.norm(motion)
            for motion, sides in zip(near, opens, strict=True)
            if np.linalg.norm(motion) > NARROW and (sides > -FLAT).all()
        ]

    def _critical(self, motion: Array, basis: Array | None = None) -> Array | None:
        """Nearest critical motion of length 1 within a basis; None if it is zero."""
        basis = self.across if basis is None else basis
        y, sides = basis.T @ motion, self.sides_of(basis)
        sides = sides[np.linalg.norm(sides, axis=1) > FLAT]  # the basis does not open the others
        if len(sides):
            push, _ = nonnegative(sides, -y)
            y = y + sides.T @ push
        size = float(np.linalg.norm(y))
        return basis @ (y / size) if size > 1e-6 else None

    def _strengthened_minimum(
        self, forces: Array, stress: Array, weights: Array | None = None
    ) -> EnergyDecision | None:
        """Prove a minimum by forces plus a multiple of a self-stress; None if none is enough."""
        forces = self._nearest_balanced_forces(forces)
        weights = self._no_weights() if weights is None else weights
        for share in (0.0, *np.geomspace(1.0, 1e6, 13)) if stress.any() else (0.0,):
            leaf = Leaf(
                self._spread(self._nearest_balanced_forces(forces + share * stress)), weights
            )
            decision = self._minimum((), (leaf,))
            if decision.state == "minimum":
                return decision
        return None

    def _nearest_balanced_forces(self, forces: Array) -> Array:
        """Nearest forces that balance the load, after negative forces were set to 0."""
        rows = self.carrying.rows
        miss = rows.T @ forces + self.carrying.load
        nearest = np.linalg.lstsq(rows.T, miss, rcond=None)[0]
        return self.carrying.pushes(forces - nearest)

    def _spread(self, forces: Array) -> Array:
        """Forces of the carrying rows as an array over all rows, shape (K,)."""
        total = np.zeros(len(self.problem.rows))
        total[self.critical.carries] = forces
        return total

    def _by_cones(self, basis: Array) -> EnergyDecision:
        """Split the critical motions into cones, and prove each by other forces, or find a path."""
        dimension, sides = basis.shape[1], self.sides_of(basis)
        todo = orthants(dimension, half=not len(sides))[::-1]
        splits: list[tuple[int, int] | None] = []
        leaves: list[Leaf] = []
        tried: set[bytes] = set()
        while todo and len(splits) < SPLITS and not self.work.over:
            rays = todo.pop()
            bounds = np.vstack([sides_of_cone(rays), sides])
            best = best_curvature(self.carrying, basis, bounds, work=self.work)
            if best is not None:
                self._note(best.forces)
            if best is not None and self._curves(basis, best.forces, bounds, best.sides):
                splits.append(None)
                leaves.append(
                    Leaf(self._spread(self._nearest_balanced_forces(best.forces)), best.sides)
                )
                continue
            motions = [*(basis @ rays).T, basis @ rays.sum(axis=1)]
            new = [motion for motion in motions if motion.tobytes() not in tried]
            tried.update(motion.tobytes() for motion in new)  # cones share their rays
            paths = self._paths(new)
            if paths:
                return self._decision("balanced", *paths)
            apart, longest = max(
                (float(np.linalg.norm(rays[:, i] - rays[:, j])), (i, j))
                for i, j in [*itertools.combinations(range(dimension), 2), (0, 0)]
            )
            if apart < NARROW:
                break
            splits.append(longest)
            todo += split(rays, *longest)[::-1]
        else:
            if not todo:
                return self._minimum(tuple(splits), tuple(leaves))
        return self._open("it is too close to the boundary of two answers, or needs a higher order")

    def _curves(self, basis: Array, forces: Array, sides: Array, weights: Array) -> bool:
        """True if forces curve the energy upward by more than the weighted inequalities."""
        matrix = (
            self.carrying.curvature(self._nearest_balanced_forces(forces), basis)
            - sides.T @ weights @ sides
        )
        size = max(1.0, float(np.abs(matrix).max(initial=0.0)))
        return bool(np.linalg.eigvalsh(matrix).min(initial=np.inf) > 2 * CURVED * size)

    def _minimum(
        self, splits: tuple[tuple[int, int] | None, ...], leaves: tuple[Leaf, ...]
    ) -> EnergyDecision:
        """The decision "minimum" by the forces of all cones; "open" if its verification fails."""
        proof = MinimumProof(self.across, self.sides, self.free, splits, leaves)
        wrong = judge_minimum(self.problem, proof)
        return self._open(wrong) if wrong else self._decision("minimum", proof)

    def _decision(
        self, state: Literal["minimum", "balanced"], proof: MinimumProof | Path, *others: Path
    ) -> EnergyDecision:
        """A proved decision, with the numbers of neutral, free and blocked motions."""
        free = self.free.shape[1]
        blocked = self.neutral - free - self.flat
        return EnergyDecision(state, self.neutral, free, blocked, self.flat, proof, others=others)

    def _open(self, why: str) -> EnergyDecision:
        """The decision "open"; motions along which known forces curve the energy up are blocked."""
        free = self.free.shape[1]
        forces = self._nearest_balanced_forces(self.critical.forces[self.critical.carries])
        values = np.linalg.eigvalsh(self.carrying.curvature(forces, self.across))
        size = max(1.0, float(np.abs(values).max(initial=TINY)))
        curved = int((values > CURVED * size).sum())
        undecided = self.across.shape[1] - curved
        return EnergyDecision("open", self.neutral, free, curved, undecided, why=why)
