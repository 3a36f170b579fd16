"""Search for the weights of stops in a proof that stops keep sliding parts from falling."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from scipy.sparse import csc_array, csr_array

from kilter.arrays import Array, Mask
from kilter.second_order.gaps.stationary import Stationary
from kilter.second_order.proofs.stopped import StopForms, Stopped, judge_stopped, stop_forms
from kilter.second_order.searches.counted_program import optimum
from kilter.second_order.searches.critical import carrying_forces
from kilter.second_order.searches.opening_contacts import opening_motion
from kilter.solvers.problem import LinearProgram
from kilter.work import Work

__all__ = ["find_stopped"]

SHARES = (0.1, 1e-3, 1e-5)
"""Lower bounds of the weights, over the most even weights, while curvature is maximised [-]."""
MOST_WEIGHTS = 2_000
"""Largest number of products of a stop and a level contact."""


def find_stopped(
    problem: Stationary, level: Mask, motions: Array, free: Array, *, work: Work | None = None
) -> Stopped | None:
    """Search for a proof by stops that the energy has a minimum; None without a proof.

    The arguments are those of `judge_stopped`.
    """
    stops, count = int((~level).sum()), int(level.sum())
    if not count or not stops or stops * count > MOST_WEIGHTS:
        return None
    answer = carrying_forces(csr_array(problem.rows[level]), problem.load, work=work)
    opening = opening_motion(problem.rows[~level] @ motions, work)
    if answer is None or opening is None:
        return None
    forces = np.zeros(len(level))
    forces[level] = answer[0]
    forms = stop_forms(problem, level, motions, free, forces)
    for weights in _candidate_weights(forms, work):
        proof = Stopped(forces, weights, motions @ opening)
        if not judge_stopped(problem, level, motions, free, proof):
            return proof
    return None


def _candidate_weights(forms: StopForms, work: Work | None) -> Iterator[Array]:
    """Weights for a proof by stops, (s, m): first the most even, then the most effective."""
    if not len(forms.stops_level) * len(forms.rises):
        yield np.zeros((len(forms.stops_level), len(forms.rises)))
        return
    even = _weights(forms, None, work)
    if even is None:
        return
    yield even
    for share in SHARES:
        weights = _weights(forms, share * float(even.min()), work)
        if weights is not None:
            yield weights


def _weights(forms: StopForms, least: float | None, work: Work | None) -> Array | None:
    """Weights that match the coupling terms of the energy, each at least t, (s, m); or None.

    Without `least`, t is maximised; otherwise t = `least`, and the trace of S is maximised. None if
    the program is not solved.
    """
    stops, rises = len(forms.stops_level), len(forms.rises)
    count = stops * rises
    products = np.einsum("if,jd->fdij", forms.stops_level, forms.rises).reshape(-1, count)
    above = np.hstack([np.eye(count), -np.ones((count, 1))])
    right = forms.coupling.reshape(-1)
    taken = (forms.stops_tilts @ forms.rises.T).reshape(-1)  # by each weight from the trace of S
    low, high = (0.0, np.inf) if least is None else (least, least)
    x = optimum(
        LinearProgram(
            np.append(np.zeros(count), -1.0) if least is None else np.append(taken, 0.0),
            csc_array(np.vstack([np.hstack([products, np.zeros((len(products), 1))]), above])),
            np.concatenate([right, np.zeros(count)]),
            np.concatenate([right, np.full(count, np.inf)]),
            np.append(np.zeros(count), low),
            np.append(np.full(count, np.inf), high),
        ),
        work,
    )
    return None if x is None else x[:-1].reshape(stops, rises)
