"""Equilibrium forces of least elastic energy, from which the search for a seat starts.

    min 1/2 f.C f,    w + H^T f = 0,    f in Coulomb's cones

with C = 1/k along the normal of a contact and 1/(0.7 k) across it (scaled as in
`kilter.friction.law`, k = 1). The multipliers of the balance are a displacement x. At sticking
points it is that of contacts that give a little (`kilter.friction.springs`). At sliding points it
opens the contact, unlike such contacts. So it is only a starting point.

The program has no memory of a path: a block between two walls is squeezed at once.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csc_array, diags_array, vstack

from kilter.arrays import Array
from kilter.friction.friction_tolerances import ELASTIC_GAP
from kilter.friction.law import CoulombLaw
from kilter.friction.springs import ACROSS
from kilter.solvers.problem import ConicProgram
from kilter.work import Work

__all__ = ["ElasticForces", "elastic_forces"]


@dataclass(frozen=True, slots=True, eq=False)
class ElasticForces:
    """Equilibrium forces (n, u, v) of least elastic energy, shape (K, 3), and a motion, (n,)."""

    forces: Array
    displacement: Array


def elastic_forces(law: CoulombLaw, *, work: Work) -> ElasticForces | None:
    """Equilibrium forces of the least elastic energy; None if the solver finds none."""
    from kilter.solvers.clarabel import solve_conic

    answer = solve_conic(_energy_program(law), tolerance=ELASTIC_GAP, work=work)
    if not answer.found or len(answer.multipliers) < len(law.load):
        return None
    return ElasticForces(answer.x.reshape(-1, 3), answer.multipliers[: len(law.load)])


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
