"""Random round assemblies against direct minimisation of the energy over their exact gaps.

Spins are divided out. No lower energy may be found at three radii around a minimum or around a free
state of `check`, and a lower energy must be found for every balanced state.
"""

import numpy as np
from random_rounds import Round, random_round
from scipy.optimize import minimize

import kilter
from kilter.arrays import Array
from kilter.mechanics.program import build_program
from kilter.second_order.gaps.features_of import features_of
from kilter.second_order.gaps.gap_form import formed, gap_forms
from kilter.second_order.gaps.stationary import Stationary, stationary
from kilter.second_order.proofs.paths import Path
from kilter.second_order.searches.critical import find_critical
from kilter.second_order.searches.decide import decide
from kilter.second_order.searches.energy_decision import EnergyDecision

ENTERED = 1e-4
"""Largest loss of energy for a free state, over t^2; a hundredth of it is penetration [-]."""
RADII = (0.02, 0.01, 0.005)
"""Sizes t of the motions over which the energy is minimised."""


def decided(made: Round) -> tuple[EnergyDecision, Stationary]:
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
        if entered > -ENTERED / 100 and abs(found.x @ off @ found.x - 1) < 1e-6:
            best = min(best, float(found.fun))
    return best


def compared(seed: int, radii: tuple[float, ...] = RADII) -> str:
    """The state of a random assembly; its energy is compared with it."""
    return survived(random_round(seed), seed, radii)


def survived(made: Round, seed: int, radii: tuple[float, ...]) -> str:
    """The state of an assembly; its energy is compared with it."""
    assert np.abs(made.open(np.zeros(6 * len(made.masses)))).max() < 1e-12
    decision, problem = decided(made)
    second = kilter.check(made.assembly).second_order_answer
    assert second is not None
    state: str = second.state if decision.state == "open" else decision.state
    if state == "open":
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
        if state == "balanced":
            assert least < 0, (seed, t, least)
        else:  # what rolls or slides freely is level along that
            assert least > (-ENTERED if state == "free" else 0), (seed, t, least)
    return state
