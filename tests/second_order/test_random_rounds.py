"""Random round assemblies against direct minimisation of the energy over their exact gaps."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
from random_rounds import Round, beside, random_round
from scipy.optimize import minimize

import kilter
from kilter.arrays import Array
from kilter.mechanics.program import build_program
from kilter.second_order.clusters import joined_state
from kilter.second_order.critical import find_critical
from kilter.second_order.decide import Decision, decide
from kilter.second_order.features_of import features_of
from kilter.second_order.gap_form import formed, gap_forms
from kilter.second_order.paths import Path
from kilter.second_order.stationary import Stationary, stationary

RADII = (0.02, 0.01, 0.005)
"""Sizes of the motions over which the least energy is sought."""


def decided(made: Round) -> tuple[Decision, Stationary]:
    contacts = kilter.contacts(made.assembly)
    program = build_program(made.assembly, contacts)
    features = features_of(program, contacts)
    assert formed(program, features).all()
    problem = stationary(program, gap_forms(program, features))
    assert problem.scale is not None
    spins = np.array(made.spins).reshape(-1, len(problem.load)).T / problem.scale[:, None]
    return decide(problem, spins), problem


def least_energy(made: Round, problem: Stationary, starts: Array, t: float) -> float:
    """Least energy over t^2 of motions of size t across the spins, all gaps open or closed.

    Local minima from the given starts: an upper bound on the least.
    """
    assert problem.scale is not None
    spins = np.array(made.spins).reshape(-1, len(problem.load)).T
    off = np.eye(len(problem.load))
    if spins.size:
        q, _ = np.linalg.qr(spins)
        off = off - q @ q.T
    up, best = made.weights(), np.inf
    closed = {"type": "ineq", "fun": lambda z: made.open(t * z) / t**2}
    sphere = {"type": "eq", "fun": lambda z: z @ off @ z - 1, "jac": lambda z: 2 * off @ z}
    for start in starts:
        z0 = off @ start
        z0 = z0 / np.linalg.norm(z0)
        found = minimize(
            lambda z: up @ z / t, z0, jac=lambda z: up / t, method="SLSQP",
            constraints=[closed, sphere], options={"maxiter": 200, "ftol": 1e-10},
        )  # fmt: skip
        entered = made.open(t * found.x).min() / t**2
        if entered > -1e-6 and abs(found.x @ off @ found.x - 1) < 1e-6:
            best = min(best, float(found.fun))
    return best


def compared(seed: int, radii: tuple[float, ...] = RADII) -> str:
    """The state of a random assembly, after its energy has been looked at directly."""
    return survived(random_round(seed), seed, radii)


def survived(made: Round, seed: int, radii: tuple[float, ...]) -> str:
    """The state of an assembly, after its energy has been looked at directly."""
    assert np.abs(made.open(np.zeros(6 * len(made.masses)))).max() < 1e-12
    decision, problem = decided(made)
    if decision.state == "open":
        return "open"
    random = np.random.default_rng(seed)
    critical = find_critical(problem)
    assert critical is not None
    assert problem.scale is not None
    basis = critical.basis * problem.scale[:, None]
    starts = (basis @ random.normal(size=(basis.shape[1], 5))).T
    if isinstance(decision.proof, Path):
        starts = np.vstack([decision.proof.first * problem.scale, starts])
    if not basis.shape[1]:
        starts = random.normal(size=(5, len(problem.load)))
    for t in radii:
        least = least_energy(made, problem, starts, t)
        if not np.isfinite(least):  # no start came to an end
            more = (basis @ random.normal(size=(basis.shape[1], 20))).T
            least = least_energy(made, problem, more, t)
        assert np.isfinite(least), (seed, t)
        if decision.state == "balanced":
            assert least < 0, (seed, t, least)
        else:
            assert least > 0, (seed, t, least)
    return decision.state


def test_minima_rise_and_balanced_ones_fall() -> None:
    states = Counter(compared(seed, RADII[1:2]) for seed in (0, 4, 5, 6))
    assert states == {"minimum": 2, "balanced": 2}


@pytest.mark.parametrize("seeds", [(4, 5), (6, 4)])
def test_clusters_rise_and_fall_as_their_energy_does_together(seeds: tuple[int, int]) -> None:
    """Both are asked as one problem, and directly; and each by itself."""
    made = [random_round(seed) for seed in seeds]
    together = beside(*made)
    alone = [decided(one)[0].state for one in made]
    second = kilter.check(together.assembly).second_order
    assert second is not None
    assert [one.state for one in second.clusters] == alone
    assert second.state == joined_state(alone) == survived(together, 0, RADII[1:2])


@pytest.mark.slow
@pytest.mark.parametrize("block", range(10))
def test_five_hundred_without_a_contradiction(block: int) -> None:
    states = Counter(compared(seed) for seed in range(100 + 49 * block, 100 + 49 * (block + 1)))
    assert min(states["minimum"], states["balanced"]) >= 5
    assert states["open"] <= 20
