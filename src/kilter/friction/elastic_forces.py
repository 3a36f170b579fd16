"""Equilibrium forces of least elastic energy, from which the search for a seat starts.

    min 1/2 f.C f,    w + H^T f = 0,    f in Coulomb's cones

with C = 1/k along the normal of a contact and 1/(0.7 k) across it (scaled as in
`kilter.friction.law`, k = 1). The multipliers of the balance are a displacement x. At sticking
points it is that of contacts that give a little (`kilter.friction.springs`). At sliding points it
opens the contact, unlike such contacts. So it is only a starting point.

Its dual is the balance of parts on springs whose forces are the nearest ones in the cones, so that
a sliding contact dilates. Newton's method solves it (`kilter.friction.spring_newton`), else a conic
solver.

The program has no memory of a path: a block between two walls is squeezed at once.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csc_array, diags_array, vstack

from kilter.arrays import TINY, Array, Mask
from kilter.friction.friction_tolerances import ELASTIC_GAP
from kilter.friction.law import CoulombLaw
from kilter.friction.spring_newton import SharedFactor, balanced_springs
from kilter.friction.springs import ACROSS, Slopes, Springs, SpringState, spring_system
from kilter.solvers.problem import ConicProgram
from kilter.work import CONIC_ENTRY, Work

__all__ = ["ElasticForces", "elastic_forces"]

USUAL_STEPS = 12
"""Number of steps of the conic solver that predicts its work."""


@dataclass(frozen=True, slots=True, eq=False)
class ElasticForces:
    """Equilibrium forces (n, u, v) of least elastic energy, shape (K, 3), and a motion, (n,)."""

    forces: Array
    displacement: Array


def elastic_forces(
    law: CoulombLaw, *, work: Work, factor: SharedFactor | None = None
) -> ElasticForces | None:
    """Equilibrium forces of the least elastic energy; None if none is found."""
    factor = factor or SharedFactor(spring_system(law))
    springs = _DilatingSprings(factor.system, np.ones(len(law.mu)))
    if not factor.narrow:
        balance = balanced_springs(springs, factor.start(law.load, work), factor, work)
        if balance is not None:
            return ElasticForces(balance[0].forces, balance[0].x)
    program = _energy_program(law)
    if CONIC_ENTRY * USUAL_STEPS * program.matrix.nnz > work.left:
        return None
    from kilter.solvers.clarabel import solve_conic

    answer = solve_conic(program, tolerance=ELASTIC_GAP, work=work)
    if not answer.found or len(answer.multipliers) < len(law.load):
        return None
    return ElasticForces(answer.x.reshape(-1, 3), answer.multipliers[: len(law.load)])


class _DilatingSprings(Springs):
    """Springs of the dual program: their forces are the nearest in Coulomb's cones.

    With y = -(u_n, root(0.7) u_t) and m = mu / root(0.7), the forces (f_n, f_t / root(0.7)) are the
    projection of y to the cone |y_t| <= m y_n.
    """

    def forces(self, u: Array) -> Array:
        """Contact forces (n, u, v) from the displacements of the points, shape (K, 3)."""
        law, root = self.system.law, np.sqrt(ACROSS)
        drag, height, inside, edge = self._projected(u)
        forces = np.where((inside | law.tied)[:, None], -u, 0.0)
        forces[:, 1:] *= ACROSS
        forces[edge, 0] = height[edge]
        pull = law.mu[edge] * height[edge] / drag[edge] * root
        forces[edge, 1:] = -pull[:, None] * u[edge, 1:]
        return forces

    def slopes(self, state: SpringState) -> Slopes:
        """Derivatives of the forces of the points by their displacements."""
        law, root = self.system.law, np.sqrt(ACROSS)
        drag, height, inside, edge = self._projected(state.opening)
        steep = law.mu / root
        flat = edge / (1.0 + steep**2)
        across = ACROSS * np.where(edge, steep * height / np.maximum(drag, TINY), inside)
        coupling = root * steep * flat
        direction = state.opening[:, 1:].T * (-root * edge / np.maximum(drag, TINY))
        return Slopes(
            np.where(inside | law.tied, 1.0, flat),
            across,
            np.where(edge, across - ACROSS * steep**2 * flat, 0.0),
            coupling,
            coupling,
            direction,
        )

    def _projected(self, u: Array) -> tuple[Array, Array, Mask, Mask]:
        """|y_t|, height of the nearest point of the cone's edge; points inside and on the edge."""
        law, root = self.system.law, np.sqrt(ACROSS)
        drag, steep = root * np.hypot(u[:, 1], u[:, 2]), law.mu / root
        inside = (drag <= -steep * u[:, 0]) & (u[:, 0] < 0) & ~law.tied
        edge = (steep * drag > u[:, 0]) & ~inside & ~law.tied
        height = (steep * drag - u[:, 0]) / (1.0 + steep**2)
        return drag, height, inside, edge


def _energy_program(law: CoulombLaw) -> ConicProgram:
    """Conic program for the elastic forces: balance of parts, joint rows, friction cones."""
    count = len(law.mu)
    smooth = np.flatnonzero(~law.tied & (law.mu <= 0))
    rough = np.flatnonzero(~law.tied & (law.mu > 0))
    triples = (3 * rough[:, None] + np.arange(3)).reshape(-1)
    weights = np.ones((len(rough), 3))
    weights[:, 0] = law.mu[rough]
    places = np.concatenate([3 * smooth, triples])
    values = -np.concatenate([np.ones(len(smooth)), weights.reshape(-1)])
    cone_rows = csc_array(
        (values, (np.arange(len(places)), places)), shape=(len(places), 3 * count)
    )
    compliance = np.tile([1.0, 1.0 / ACROSS, 1.0 / ACROSS], count)
    return ConicProgram(
        csc_array(diags_array(compliance)),
        np.zeros(3 * count),
        csc_array(vstack([law.matrix.T, cone_rows], format="csc")),
        np.concatenate([-law.load, np.zeros(len(places))]),
        len(law.load),
        len(smooth),
        np.full(len(rough), 3),
    )
