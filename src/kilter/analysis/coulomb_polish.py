"""From nearly to exactly: the equations of a contact mode, solved by Newton's method.

Each point of a candidate is taken to part, to stick, or to slide, whichever its speeds and
forces are nearest to. In that mode the law is a system of equations,

    x = w + sum_stick H^T f + sum_slide f_n (H_n - mu H_t^T e),     e = u_t / |u_t|
    u = 0 where points stick,  u_n = 0 where they slide

nonlinear in the directions of sliding e(x) only. Points whose force turns out to pull part,
points that enter each other touch, points beyond their cone slide: then again. Forces that
several points share have no unique solution; the steps are regularised, so that they stay
near those of the candidate.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import block_array, coo_array, csc_array, csr_array, diags_array, eye_array

from kilter.mechanics.frictional import Frictional

__all__ = ["Candidate", "polished"]

Array = NDArray[np.float64]
Index = NDArray[np.int64]

PART, SLIDE, STICK = 0, 1, 2
"""Modes of a point."""
SOFT = 1e-9
"""Regularisation of the equations, whose terms are near 1."""
STEPS = 40
"""Newton steps in one mode."""
MODES = 8
"""Modes tried for one candidate."""
DONE = 1e-14
"""Residual at which a mode is solved."""
SLACK = 1e-9
"""Speeds and forces beyond their side by more than this change the mode."""
DENSE = 250
"""Systems up to this many equations are solved as full matrices."""


@dataclass(frozen=True, slots=True, eq=False)
class Candidate:
    """Scaled accelerations x, shape (n,), and forces (n, u, v), shape (K, 3)."""

    x: Array
    forces: Array


def polished(law: Frictional, start: Candidate) -> list[Candidate]:
    """Candidates that solve the equations of modes near `start`, the last the most so."""
    mode = _modes(law, start)
    found: list[Candidate] = []
    seen = set()
    candidate = start
    for _ in range(MODES):
        if mode.tobytes() in seen:
            break
        seen.add(mode.tobytes())
        solved = _solve(law, mode, candidate)
        if solved is None:
            break
        candidate = solved
        found.append(candidate)
        changed = _changed(law, mode, candidate)
        if (changed == mode).all():
            break
        mode = changed
    return found


def _modes(law: Frictional, start: Candidate) -> Index:
    """The mode of each row that speeds and forces are nearest to."""
    u, f = (law.matrix @ start.x).reshape(-1, 3), start.forces
    touches = law.tied | (f[:, 0] > np.maximum(u[:, 0], SLACK))
    room = law.mu * f[:, 0] - np.linalg.norm(f[:, 1:], axis=1)
    slides = (law.mu <= 0) | (np.linalg.norm(u[:, 1:], axis=1) > room)
    return np.where(~touches, PART, np.where(slides & ~law.tied, SLIDE, STICK))


def _changed(law: Frictional, mode: Index, now: Candidate) -> Index:
    """The mode without its worst contradictions."""
    u, f = (law.matrix @ now.x).reshape(-1, 3), now.forces
    drag = np.linalg.norm(f[:, 1:], axis=1)
    new = mode.copy()
    new[(mode == PART) & (u[:, 0] < -SLACK)] = SLIDE
    new[(mode == STICK) & (drag > law.mu * np.maximum(f[:, 0], 0.0) + SLACK)] = SLIDE
    new[(mode != PART) & (f[:, 0] < -SLACK)] = PART
    new[law.tied] = STICK
    return new


def _solve(law: Frictional, mode: Index, start: Candidate) -> Candidate | None:
    """The solution of the equations of a mode nearest to `start`; None where they break down."""
    slide, stick = np.flatnonzero(mode == SLIDE), np.flatnonzero(mode == STICK)
    held = stick[~law.tied[stick]]
    rows = np.concatenate([3 * slide, 3 * stick, 3 * held + 1, 3 * held + 2])
    active = csr_array(law.matrix[rows])
    across = csr_array(law.matrix[(3 * slide[:, None] + [1, 2]).reshape(-1)])
    mu = law.mu[slide]
    x = start.x.copy()
    flat = start.forces.reshape(-1)
    g = np.concatenate([np.maximum(flat[3 * slide], 0.0), flat[rows[len(slide) :]]])
    e = _directions(across @ x, -start.forces[slide, 1:])
    best, least = None, np.inf
    for _ in range(STEPS):
        e = _directions(across @ x, e)
        drag = csr_array(_spread(mu[:, None] * e) @ across)
        push = active - _padded(drag, active.shape[0])
        first = x - law.load - push.T @ g
        second = active @ x
        size = max(float(np.abs(first).max(initial=0)), float(np.abs(second).max(initial=0)))
        if size < least:
            best, least = (x.copy(), g.copy(), e.copy()), size
        if size <= DONE or not np.isfinite(size):
            break
        bend = _bending(across, mu * np.maximum(g[: len(slide)], 0.0), e, across @ x)
        step = _step(bend, push, active, np.concatenate([-first, -second]))
        if step is None:
            break
        x, g = x + step[: len(x)], g + step[len(x) :]
    if best is None:
        return None
    x, g, e = best
    forces = np.zeros(len(flat))
    forces[rows] = g
    full = forces.reshape(-1, 3)
    full[slide, 1:] = -(mu * g[: len(slide)])[:, None] * e
    return Candidate(x, full)


def _directions(speeds: Array, otherwise: Array) -> Array:
    """Unit directions of sliding, shape (S, 2); `otherwise` where a point does not."""
    u = speeds.reshape(-1, 2)
    size = np.linalg.norm(u, axis=1)
    size_otherwise = np.linalg.norm(otherwise, axis=1)
    other = otherwise / np.maximum(size_otherwise, 1e-300)[:, None]
    return np.where((size > DONE)[:, None], u / np.maximum(size, 1e-300)[:, None], other)


def _spread(values: Array) -> csr_array:
    """A matrix with row p holding values[p] in columns 2 p and 2 p + 1."""
    count = len(values)
    rows = np.repeat(np.arange(count), 2)
    return csr_array((values.reshape(-1), (rows, np.arange(2 * count))), shape=(count, 2 * count))


def _padded(top: csr_array, rows: int) -> csr_array:
    """`top` with rows of zeros below."""
    full = coo_array(top)
    return csr_array((full.data, (full.row, full.col)), shape=(rows, top.shape[1]))


def _bending(across: csr_array, limit: Array, e: Array, speeds: Array) -> csr_array:
    """Sum of mu f_n H_t^T (1 - e e^T) H_t / |u_t|: how x turns the friction."""
    size = np.linalg.norm(speeds.reshape(-1, 2), axis=1)
    turn = _spread(np.column_stack([-e[:, 1], e[:, 0]])) @ across
    weight = np.where(size > DONE, limit / np.maximum(size, DONE), 0.0)
    return csr_array(turn.T @ (diags_array(weight) @ turn))


def _step(bend: csr_array, push: csr_array, active: csr_array, right: Array) -> Array | None:
    """The Newton step of (x, g)."""
    from scipy.sparse.linalg import splu

    count, held = bend.shape[0], active.shape[0]
    top = bend + eye_array(count)
    if not held:
        system = csc_array(top)
    else:
        system = block_array([[top, -push.T], [active, SOFT * eye_array(held)]], format="csc")
    try:
        if len(right) <= DENSE:
            step = np.linalg.solve(system.toarray(), right)
        else:
            step = splu(system).solve(right)
    except (RuntimeError, np.linalg.LinAlgError):  # singular
        return None
    return step if np.isfinite(step).all() else None
