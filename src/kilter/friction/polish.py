"""From nearly to exactly: the equations of a contact mode, solved by Newton's method.

Each point of a candidate is taken to be open, to stick, or to slide, whichever its speeds and
forces are nearest to. In that mode the law (scaled as in `kilter.friction.law`) is a system of
equations,

    x = w + sum_stick H^T f + sum_slide f_n (H_n - mu H_t^T e),     e = u_t / |u_t|
    u = 0 where points stick,  u_n = 0 where they slide

nonlinear in the directions of sliding e(x) only. The mode is then corrected where its solution
contradicts it: points whose force turns out to pull open, points that enter each other touch,
points whose force leaves its cone slide; and it is solved again. Forces that several points
share have no unique solution; the steps are regularised, so that they stay near those of the
candidate.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.sparse import block_array, csr_array, diags_array, eye_array, vstack

from kilter.arrays import TINY, Array, Index
from kilter.friction.branching import Mode
from kilter.friction.friction_tolerances import (
    CLEAR,
    CREEP,
    NEAR_ITS_CONE,
    SLACK,
    SOFT_MODE,
    SOLVED,
)
from kilter.friction.law import CoulombLaw
from kilter.work import Work

__all__ = ["TrialMotion", "polished"]

STEPS = 40
"""Newton steps in one mode."""
MOST_RAYS = 1000
"""Rays above which forces at the limit of friction are not sought."""
HALF, PATIENCE = 0.5, 5
"""Newton steps that may pass without the residual halving."""
MODES = 8
"""Modes tried for one candidate."""
DENSE = 250
"""Systems up to this many equations are solved as full matrices."""


@dataclass(frozen=True, slots=True, eq=False)
class TrialMotion:
    """Accelerations x, shape (n,), and forces (n, u, v), shape (K, 3), scaled as the law is.

    They obey the law nearly, or exactly: that is for `check_law` to say.
    """

    x: Array
    forces: Array


def polished(
    law: CoulombLaw, start: TrialMotion, seen: set[bytes], work: Work
) -> list[TrialMotion]:
    """TrialMotions that solve the equations of modes near `start`.

    Parameters
    ----------
    law : CoulombLaw
    start : TrialMotion
    seen : set of bytes
        Modes that are not to be solved again; those solved are added.
    work : Work
        When it is spent, what was found is all.
    """
    found: list[TrialMotion] = []
    with np.errstate(over="ignore"):
        if not np.isfinite(start.forces**2).all():  # beyond the squares of numbers
            return found
    for least in (CLEAR, SLACK):
        found += _followed(law, _modes(law, start, least), start, seen, work)
    return found


def _followed(
    law: CoulombLaw, mode: Index, start: TrialMotion, seen: set[bytes], work: Work
) -> list[TrialMotion]:
    """Solutions of a mode and of those it leads to."""
    found: list[TrialMotion] = []
    candidate = start
    for _ in range(MODES):
        if mode.tobytes() in seen or work.over:
            break
        seen.add(mode.tobytes())
        solved = _solve(law, mode, candidate, work)
        if solved is None:
            break
        candidate = solved
        found += [candidate, *_at_the_limit(law, mode, candidate, work)]
        changed = _changed(law, mode, candidate)
        if (changed == mode).all():
            break
        mode = changed
    return found


def _modes(law: CoulombLaw, start: TrialMotion, least: float) -> Index:
    """The mode of each row that speeds and forces are nearest to; below `least` none push."""
    u, f = (law.matrix @ start.x).reshape(-1, 3), start.forces
    touches = law.tied | (f[:, 0] > np.maximum(u[:, 0], least))
    room = law.mu * f[:, 0] - np.linalg.norm(f[:, 1:], axis=1)
    slides = (law.mu <= 0) | (np.linalg.norm(u[:, 1:], axis=1) > room)
    return np.where(~touches, Mode.OPEN, np.where(slides & ~law.tied, Mode.SLIDING, Mode.STICKING))


def _changed(law: CoulombLaw, mode: Index, now: TrialMotion) -> Index:
    """The mode without its worst contradictions."""
    u, f = (law.matrix @ now.x).reshape(-1, 3), now.forces
    drag = np.linalg.norm(f[:, 1:], axis=1)
    new = mode.copy()
    new[(mode == Mode.OPEN) & (u[:, 0] < -SLACK)] = Mode.SLIDING
    new[(mode == Mode.STICKING) & (drag > law.mu * np.maximum(f[:, 0], 0.0) + SLACK)] = Mode.SLIDING
    new[(mode != Mode.OPEN) & (f[:, 0] < -SLACK)] = Mode.OPEN
    new[law.tied] = Mode.STICKING
    return new


def _solve(law: CoulombLaw, mode: Index, start: TrialMotion, work: Work) -> TrialMotion | None:
    """The solution of the equations of a mode nearest to `start`; None where they break down."""
    slide, stick = np.flatnonzero(mode == Mode.SLIDING), np.flatnonzero(mode == Mode.STICKING)
    held = stick[~law.tied[stick]]
    rows = np.concatenate([3 * slide, 3 * stick, 3 * held + 1, 3 * held + 2])
    lines = law.matrix
    active, across = lines[rows], lines[(3 * slide[:, None] + [1, 2]).reshape(-1)]
    full = len(rows) + len(law.load) <= DENSE
    if full:
        active, across = active.toarray(), across.toarray()
    equations = _ModeEquations(law.load, law.mu[slide], active, across, full)
    flat = start.forces.reshape(-1)
    g = np.concatenate([np.maximum(flat[3 * slide], 0.0), flat[rows[len(slide) :]]])
    best = equations.solve(start.x, g, -start.forces[slide, 1:], work)
    if best is None:
        return None
    x, g, e = best
    forces = np.zeros(len(flat))
    forces[rows] = g
    points = forces.reshape(-1, 3)
    points[slide, 1:] = -(law.mu[slide] * g[: len(slide)])[:, None] * e
    return TrialMotion(x, points)


@dataclass(frozen=True, slots=True, eq=False)
class _ModeEquations:
    """The equations of one mode: lines of H whose speed is 0, and across which points slide."""

    load: Array
    mu: Array
    active: Any
    across: Any
    full: bool

    def solve(self, x: Array, g: Array, e: Array, work: Work) -> tuple[Array, Array, Array] | None:
        """Unknowns x, forces g along the active lines and directions e, by Newton's method."""
        best, least, since = None, np.inf, 0
        for _ in range(STEPS):
            e = _directions(self.across @ x, e)
            push = self._push(e)
            first, second = x - self.load - push.T @ g, self.active @ x
            size = max(float(np.abs(first).max(initial=0)), float(np.abs(second).max(initial=0)))
            since = 0 if size < HALF * least else since + 1
            if size < least:
                best, least = (x, g, e), size
            if size <= SOLVED or since > PATIENCE or not np.isfinite(size) or work.over:
                break
            right = np.concatenate([-first, -second])
            step = self._step(self._bending(x, g, e), push, right, work)
            if step is None:
                break
            x, g = x + step[: len(x)], g + step[len(x) :]
        return best

    def _push(self, e: Array) -> Any:
        """What the forces g push along: the active lines, less friction where points slide."""
        drag = self._combined(self.mu[:, None] * e)
        count = len(self.mu)
        if self.full:
            push = self.active.copy()
            push[:count] -= drag
            return push
        return vstack([self.active[:count] - drag, self.active[count:]], format="csr")

    def _combined(self, weights: Array) -> Any:
        """One line a sliding point: the two lines across it with weights, shape (S, 2)."""
        count = len(weights)
        if self.full:
            lines = self.across.reshape(count, 2, self.across.shape[1])
            return np.einsum("si,sij->sj", weights, lines)
        rows = np.repeat(np.arange(count), 2)
        places = (rows, np.arange(2 * count))
        return csr_array((weights.reshape(-1), places), shape=(count, 2 * count)) @ self.across

    def _bending(self, x: Array, g: Array, e: Array) -> Any:
        """Sum of mu f_n H_t^T (1 - e e^T) H_t / |u_t|: how x turns the friction."""
        limit = self.mu * np.maximum(g[: len(self.mu)], 0.0)
        size = np.linalg.norm((self.across @ x).reshape(-1, 2), axis=1)
        turn = self._combined(np.column_stack([-e[:, 1], e[:, 0]]))
        weight = np.where(size > SOLVED, limit / np.maximum(size, SOLVED), 0.0)
        if self.full:
            return turn.T @ (weight[:, None] * turn)
        return turn.T @ (diags_array(weight) @ turn)

    def _step(self, bend: Any, push: Any, right: Array, work: Work) -> Array | None:
        """The Newton step of (x, g)."""
        from scipy.sparse.linalg import splu

        count, held = len(self.load), self.active.shape[0]
        step: Array
        try:
            if self.full:
                system = np.zeros((count + held, count + held))
                system[:count, :count] = bend + np.eye(count)
                system[:count, count:] = -push.T
                system[count:, :count] = self.active
                system[range(count, count + held), range(count, count + held)] = SOFT_MODE
                work.dense(count + held)
                step = np.asarray(np.linalg.solve(system, right), np.float64)
            else:
                top = [bend + eye_array(count), -push.T]
                blocks = [top, [self.active, SOFT_MODE * eye_array(held)]]
                factor = splu(block_array(blocks, format="csc"))
                work.sparse(count + held, factor.nnz)
                step = factor.solve(right)
        except (RuntimeError, np.linalg.LinAlgError):  # singular
            return None
        return step if np.isfinite(step).all() else None


def _at_the_limit(law: CoulombLaw, mode: Index, now: TrialMotion, work: Work) -> list[TrialMotion]:
    """The same motion where points that stick at the limit of friction push along its slides.

    Where a stack slides as one, its inner joints stick with forces that just reach their
    cones; the forces of several points sum up to that only if they are all parallel.
    """
    u, f = (law.matrix @ now.x).reshape(-1, 3), now.forces
    drag, slip = np.linalg.norm(f[:, 1:], axis=1), np.linalg.norm(u[:, 1:], axis=1)
    full, rough = law.mu * np.maximum(f[:, 0], 0.0), law.mu > 0
    held = (full > NEAR_ITS_CONE) & (drag > (1 - NEAR_ITS_CONE) * full)
    creeps = (mode == Mode.SLIDING) & rough & (slip <= CREEP)
    limit = np.flatnonzero(((mode == Mode.STICKING) & held) | (creeps & held))
    slides = (mode == Mode.SLIDING) & ~creeps
    fast = slides & rough & (slip > NEAR_ITS_CONE)
    along = np.einsum("ki,kij->kj", u[fast, 1:] / slip[fast, None], law.basis[fast, 1:])
    if not len(limit) or not len(along):
        return []
    signs = np.concatenate([along, -along])
    own = -np.einsum("ki,kij->kj", f[limit, 1:], law.basis[limit, 1:])
    chosen = signs[(own @ signs.T).argmax(axis=1)]
    e = _directions(u[:, 1:], -f[:, 1:])
    e[limit] = _directions(np.einsum("kj,kij->ki", chosen, law.basis[limit, 1:]), e[limit])
    ray = slides.copy()
    ray[limit] = True
    others = np.flatnonzero(((mode == Mode.STICKING) | creeps) & ~ray)
    forces = _on_rays(law, np.flatnonzero(ray), e, others, now.x, work)
    return [] if forces is None else [TrialMotion(now.x, forces)]


def _on_rays(
    law: CoulombLaw, rays: Index, e: Array, others: Index, x: Array, work: Work
) -> Array | None:
    """Forces (n, u, v) of the motion x: along -e on the cones of `rays`, within those of others.

    The cones of the others by eight rays each, so that all is nonnegative least squares.
    """
    from scipy.optimize import nnls

    count, tied, rough = len(rays), others[law.tied[others]], others[~law.tied[others]]
    if count + 8 * len(others) > MOST_RAYS:
        return None
    angle = np.arange(8) * np.pi / 4
    around = np.column_stack([np.cos(angle), np.sin(angle)])
    rows = np.concatenate([rays, np.repeat(rough, 8), tied, tied])
    across = np.concatenate(
        [-e[rays], np.tile(around, (len(rough), 1)), np.zeros((2 * len(tied), 2))]
    )
    ways = np.column_stack([np.ones(len(rows)), law.mu[rows][:, None] * across])
    ways[len(rows) - len(tied) :] *= -1.0
    where = (np.repeat(np.arange(len(rows)), 3), (3 * rows[:, None] + np.arange(3)).reshape(-1))
    combine = csr_array((ways.reshape(-1), where), shape=(len(rows), law.matrix.shape[0]))
    work.dense(max(len(rows), len(x)))
    try:
        g, _ = nnls((combine @ law.matrix).toarray().T, x - law.load)
    except RuntimeError:  # too many steps
        return None
    forces: Array = (combine.T @ g).reshape(-1, 3)
    return forces


def _directions(speeds: Array, otherwise: Array) -> Array:
    """Unit directions of sliding, shape (S, 2); `otherwise` where a point does not."""
    u = speeds.reshape(-1, 2)
    size = np.linalg.norm(u, axis=1)
    size_otherwise = np.linalg.norm(otherwise, axis=1)
    other = otherwise / np.maximum(size_otherwise, TINY)[:, None]
    unit: Array = np.where((size > SOLVED)[:, None], u / np.maximum(size, TINY)[:, None], other)
    return unit
