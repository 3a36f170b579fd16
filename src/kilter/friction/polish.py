"""Newton's method for the equations of a contact mode, which makes a candidate motion exact.

Each point of a candidate is assumed to be open, to stick, or to slide, whichever is nearest to its
speeds and forces. In that mode the law (scaled as in `kilter.friction.law`) is a system of
equations,

    x = w + sum_stick H^T f + sum_slide f_n (H_n - mu H_t^T e),     e = u_t / |u_t|
    u = 0 at sticking points,  u_n = 0 at sliding points

nonlinear only in the sliding directions e(x). If its solution contradicts the mode, the mode is
corrected: points that would pull become open, points that penetrate touch, and points whose force
leaves its cone slide. Then it is solved again. Forces that several points share are not unique; the
steps are regularised, so they stay near those of the candidate.
"""

from __future__ import annotations

from collections.abc import Iterator
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
    SLOW,
    SOFT_MODE,
    SOLVED,
)
from kilter.friction.law import CoulombLaw
from kilter.work import Work

STEPS = 40
"""Maximum number of Newton steps in a mode."""
MOST_RAYS = 1000
"""Number of rays above which forces at the limit of friction are not computed."""
HALF, PATIENCE = 0.5, 5
"""Newton's method ends after the second number of steps without a reduction of the residual to the
first fraction.
"""
MODES = 8
"""Maximum number of modes tried for a candidate."""
DENSE = 250
"""Largest number of equations that are solved as a dense matrix."""


@dataclass(frozen=True, slots=True, eq=False)
class TrialMotion:
    """Candidate motion: accelerations x, shape (n,), and forces (n, u, v), shape (K, 3), scaled.

    They obey the law approximately or exactly; `check_law` decides.
    """

    x: Array
    forces: Array


def polished(
    law: CoulombLaw, start: TrialMotion, seen: set[bytes], work: Work, *, impending: bool = False
) -> Iterator[TrialMotion]:
    """Yield motions near `start` that exactly solve the equations of a contact mode.

    Arguments: `impending`: the motion may be slow, little above the error of the solver: points
    that slide much slower than the fastest are tried as sticking first.
    """
    with np.errstate(over="ignore"):
        if not np.isfinite(start.forces**2).all():  # the squares overflow
            return
    for slow in (SLOW, 0.0) if impending else (0.0,):
        for least in (CLEAR, SLACK):
            mode = _nearest_modes(law, start, least, slow)
            yield from _follow_modes(law, mode, start, seen, work)


def _follow_modes(
    law: CoulombLaw, mode: Index, start: TrialMotion, seen: set[bytes], work: Work
) -> Iterator[TrialMotion]:
    """Solve a contact mode, change the modes that the solution contradicts, and repeat."""
    candidate = start
    for _ in range(MODES):
        if mode.tobytes() in seen or work.over:
            return
        seen.add(mode.tobytes())
        solution = _solve_mode(law, mode, candidate, work)
        if solution is None:
            return
        candidate = solution
        yield candidate
        yield from _at_the_limit(law, mode, candidate, work)
        corrected = _corrected_modes(law, mode, candidate)
        if (corrected == mode).all():
            return
        mode = corrected


def _nearest_modes(law: CoulombLaw, start: TrialMotion, least: float, slow: float) -> Index:
    """Contact mode of each row that is nearest to a motion.

    Forces below `least` count as zero, and so does sliding below `slow` of the fastest.
    """
    u, f = (law.matrix @ start.x).reshape(-1, 3), start.forces
    touches = law.tied | (f[:, 0] > np.maximum(u[:, 0], least))
    room = law.mu * f[:, 0] - np.linalg.norm(f[:, 1:], axis=1)
    slip = np.linalg.norm(u[:, 1:], axis=1)
    slides = (law.mu <= 0) | ((slip > room) & (slip >= slow * slip.max(initial=0.0)))
    return np.where(~touches, Mode.OPEN, np.where(slides & ~law.tied, Mode.SLIDING, Mode.STICKING))


def _corrected_modes(law: CoulombLaw, mode: Index, motion: TrialMotion) -> Index:
    """Change the mode of each row that a motion contradicts, such as an open row that closes."""
    u, f = (law.matrix @ motion.x).reshape(-1, 3), motion.forces
    drag = np.linalg.norm(f[:, 1:], axis=1)
    new = mode.copy()
    new[(mode == Mode.OPEN) & (u[:, 0] < -SLACK)] = Mode.SLIDING
    new[(mode == Mode.STICKING) & (drag > law.mu * np.maximum(f[:, 0], 0.0) + SLACK)] = Mode.SLIDING
    new[(mode != Mode.OPEN) & (f[:, 0] < -SLACK)] = Mode.OPEN
    new[law.tied] = Mode.STICKING
    return new


def _solve_mode(law: CoulombLaw, mode: Index, start: TrialMotion, work: Work) -> TrialMotion | None:
    """Solution of the equations of a contact mode nearest to `start`; None if they are singular."""
    slide, stick = np.flatnonzero(mode == Mode.SLIDING), np.flatnonzero(mode == Mode.STICKING)
    held = stick[~law.tied[stick]]
    rows = np.concatenate([3 * slide, 3 * stick, 3 * held + 1, 3 * held + 2])
    lines = law.matrix
    active, across = lines[rows], lines[(3 * slide[:, None] + [1, 2]).reshape(-1)]
    dense = len(rows) + len(law.load) <= DENSE
    if dense:
        active, across = active.toarray(), across.toarray()
    equations = _ModeEquations(law.load, law.mu[slide], active, across, dense)
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
    """Equations for given modes of all points: closed points stay closed, friction opposes slip."""

    load: Array
    mu: Array
    active: Any
    across: Any
    full: bool

    def solve(self, x: Array, g: Array, e: Array, work: Work) -> tuple[Array, Array, Array] | None:
        """Solve for motion x, forces g on active lines and slide directions e; None if it fails."""
        best, least_size, stalled_steps = None, np.inf, 0
        for _ in range(STEPS):
            e = _sliding_directions(self.across @ x, e)
            push = self._push(e)
            motion_residual, speed_residual = x - self.load - push.T @ g, self.active @ x
            size = max(
                float(np.abs(motion_residual).max(initial=0)),
                float(np.abs(speed_residual).max(initial=0)),
            )
            stalled_steps = 0 if size < HALF * least_size else stalled_steps + 1
            if size < least_size:
                best, least_size = (x, g, e), size
            if size <= SOLVED or stalled_steps > PATIENCE or not np.isfinite(size) or work.over:
                break
            right = np.concatenate([-motion_residual, -speed_residual])
            step = self._step(self._friction_rotation(x, g, e), push, right, work)
            if step is None:
                break
            x, g = x + step[: len(x)], g + step[len(x) :]
        return best

    def _push(self, e: Array) -> Any:
        """Matrix of the lines along which forces act: active lines, minus sliding friction."""
        drag = self._combine(self.mu[:, None] * e)
        count = len(self.mu)
        if self.full:
            push = self.active.copy()
            push[:count] -= drag
            return push
        return vstack([self.active[:count] - drag, self.active[count:]], format="csr")

    def _combine(self, weights: Array) -> Any:
        """Weighted sum of the two tangent lines of each sliding point."""
        count = len(weights)
        if self.full:
            lines = self.across.reshape(count, 2, self.across.shape[1])
            return np.einsum("si,sij->sj", weights, lines)
        rows = np.repeat(np.arange(count), 2)
        places = (rows, np.arange(2 * count))
        return csr_array((weights.reshape(-1), places), shape=(count, 2 * count)) @ self.across

    def _friction_rotation(self, x: Array, g: Array, e: Array) -> Any:
        """Derivative of the sliding friction by the motion, as the sliding directions turn."""
        limit = self.mu * np.maximum(g[: len(self.mu)], 0.0)
        size = np.linalg.norm((self.across @ x).reshape(-1, 2), axis=1)
        turn = self._combine(np.column_stack([-e[:, 1], e[:, 0]]))
        weight = np.where(size > SOLVED, limit / np.maximum(size, SOLVED), 0.0)
        if self.full:
            return turn.T @ (weight[:, None] * turn)
        return turn.T @ (diags_array(weight) @ turn)

    def _step(self, bend: Any, push: Any, right: Array, work: Work) -> Array | None:
        """Newton step of motion x and forces g; None if the equations are singular."""
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


def _at_the_limit(
    law: CoulombLaw, mode: Index, motion: TrialMotion, work: Work
) -> list[TrialMotion]:
    """The motion again, with the friction of sticking points at its limit against their sliding.

    If a stack slides as a unit, its inner joints stick with forces that just reach their cones. The
    forces of several points have that sum only if they are all parallel.
    """
    u, f = (law.matrix @ motion.x).reshape(-1, 3), motion.forces
    drag, slip = np.linalg.norm(f[:, 1:], axis=1), np.linalg.norm(u[:, 1:], axis=1)
    full, rough = law.mu * np.maximum(f[:, 0], 0.0), law.mu > 0
    fastest = float(slip.max(initial=0.0))
    at_limit = (full > NEAR_ITS_CONE) & (drag > (1 - NEAR_ITS_CONE) * full)
    creeping = (mode == Mode.SLIDING) & rough & (slip <= CREEP * fastest)
    limit = np.flatnonzero(((mode == Mode.STICKING) & at_limit) | (creeping & at_limit))
    slides = (mode == Mode.SLIDING) & ~creeping
    fast = slides & rough & (slip > NEAR_ITS_CONE * fastest)
    along = np.einsum("ki,kij->kj", u[fast, 1:] / slip[fast, None], law.basis[fast, 1:])
    if not len(limit) or not len(along):
        return []
    candidates = np.concatenate([along, -along])
    friction = -np.einsum("ki,kij->kj", f[limit, 1:], law.basis[limit, 1:])
    chosen = candidates[(friction @ candidates.T).argmax(axis=1)]
    e = _sliding_directions(u[:, 1:], -f[:, 1:])
    e[limit] = _sliding_directions(np.einsum("kj,kij->ki", chosen, law.basis[limit, 1:]), e[limit])
    ray = slides.copy()
    ray[limit] = True
    others = np.flatnonzero(((mode == Mode.STICKING) | creeping) & ~ray)
    forces = _forces_on_rays(law, np.flatnonzero(ray), e, others, motion.x, work)
    return [] if forces is None else [TrialMotion(motion.x, forces)]


def _forces_on_rays(
    law: CoulombLaw, rays: Index, e: Array, others: Index, x: Array, work: Work
) -> Array | None:
    """Forces of a motion: at the friction limit for `rays`, within the cones for `others`.

    The cones of the others are replaced by eight rays each, so the problem is a nonnegative
    least-squares problem.
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
    ray_vectors = np.column_stack([np.ones(len(rows)), law.mu[rows][:, None] * across])
    ray_vectors[len(rows) - len(tied) :] *= -1.0
    places = (np.repeat(np.arange(len(rows)), 3), (3 * rows[:, None] + np.arange(3)).reshape(-1))
    combine = csr_array((ray_vectors.reshape(-1), places), shape=(len(rows), law.matrix.shape[0]))
    work.dense(max(len(rows), len(x)))
    try:
        g, _ = nnls((combine @ law.matrix).toarray().T, x - law.load)
    except RuntimeError:  # nnls reached its iteration limit
        return None
    forces: Array = (combine.T @ g).reshape(-1, 3)
    return forces


def _sliding_directions(speeds: Array, otherwise: Array) -> Array:
    """Unit sliding direction of each point, shape (S, 2); `otherwise` for points at rest."""
    u = speeds.reshape(-1, 2)
    size = np.linalg.norm(u, axis=1)
    size_otherwise = np.linalg.norm(otherwise, axis=1)
    other = otherwise / np.maximum(size_otherwise, TINY)[:, None]
    unit: Array = np.where((size > SOLVED)[:, None], u / np.maximum(size, TINY)[:, None], other)
    return unit
