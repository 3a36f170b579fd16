"""Seating: does the weight of the parts itself make the friction that holds them?

Between contacts that give a little, k along the normal and 0.7 k across it, and that neither
a gap nor a squeeze separated or pressed before, parts under load move by a small displacement
x to where

    f_n = k max(0, -u_n),  f_t = -0.7 k u_t, cut to |f_t| <= mu f_n,     u = H x
    r(x) = w + H^T f(H x) = 0

if there is such a place: *seated* (scaled as in `kilter.friction.law`, x being a displacement
here). The forces are then forces of equilibrium, each exactly in its cone. A block squeezed
between walls has such forces too, but no displacement makes them: it is not seated. The size
of k does not matter; its ratio between patches may, so that starts after the first vary it at
random, by 0.1 to 10 a patch.

The equations are solved by pseudo-transient continuation, (1/h - dr/dx) dx = r with a step h
that grows as r falls: at first the path of parts in thick oil, at last Newton's method. Where
nothing holds, x runs away, in the direction that is returned. That no start balances proves
nothing.

References
----------
C. T. Kelley, D. E. Keyes, Convergence analysis of pseudo-transient continuation, SIAM J.
Numer. Anal. 35, 1998.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import TYPE_CHECKING

import numpy as np
from scipy.sparse import bsr_array, csc_array, eye_array

from kilter.arrays import TINY, Array
from kilter.friction.friction_tolerances import BALANCED, GOAL, SOFT_SQUEEZE
from kilter.friction.law import CoulombLaw, coulomb_law
from kilter.mechanics.law_check import check_balance
from kilter.mechanics.program import Program
from kilter.threads import on_one_thread
from kilter.work import Work

if TYPE_CHECKING:
    from scipy.sparse.linalg import SuperLU

__all__ = ["Seating", "find_seating"]


# The springs. In the units of the law k = 1 gives a displacement of about 1 under the weight.
ACROSS = 0.7
"""Stiffness across a contact over that along its normal: about that of two elastic bodies."""
SPREAD = 10.0
"""In starts after the first the stiffness of a patch is up to this factor above or below 1."""
SQUEEZE = 10.0
"""Largest depth to which such a start presses patches at first; 1 makes forces of the weight."""
NUDGE = 1.0
"""Size of the random part of its first displacement, in each freedom."""

# The path in pseudo-time: steps h of (1/h - dr/dx) dx = r.
STEPS = 300
"""Newton steps after which a start is given up."""
INNER = 8
"""Newton steps within one step h."""
STEP_ERROR = 0.1
"""A step h is solved to this fraction of r at its beginning."""
FALLING = 0.9
"""A Newton step that leaves more than this fraction of the error ends the step h as failed."""
GROWTH, SLOW, LEAP, EASY = 1.5, 1.2, 10.0, 4
"""H grows by GROWTH after a step that took up to EASY Newton steps, else by SLOW; times the
factor by which r fell, up to LEAP."""
CUT = 0.2
"""What h is multiplied by where Newton's method failed."""
SHORTEST, LONGEST, EASING = 1e-6, 1e7, 1.5
"""A start is given up at an h below SHORTEST; it has run away at an h above LONGEST if r does
not even fall by EASING."""
DENSE = 90
"""Systems up to this many unknowns are solved as full matrices."""


@dataclass(frozen=True, slots=True, eq=False)
class Seating:
    """Whether the weight seats the parts.

    Attributes
    ----------
    seated : bool
    forces : ndarray, shape (K, 3)
        On part b of each row, world frame [N]; exactly in their cones; those of the start that
        balanced best.
    residual : float
        Worst imbalance of a part over its weight, of those forces [-].
    starts, iterations : int
        How many were needed.
    runaway : ndarray, shape (N, 6), or None
        The direction in which the parts ran away, as an acceleration; None where seated.
    """

    seated: bool
    forces: Array
    residual: float
    starts: int
    iterations: int
    runaway: Array | None


@on_one_thread
def find_seating(
    program: Program, *, seed: int = 0, starts: int = 6, work: Work | float = inf
) -> Seating:
    """Whether the weight of the parts seats them.

    Parameters
    ----------
    program : Program
        With the friction of its contacts.
    seed : int
        Of the stiffnesses and first displacements of all starts but the first.
    starts : int
        The first from no displacement at all, with one stiffness; the others at random.
    work : Work or float
        Or an effort (`kilter.work`); when it is spent, the search ends with what it has.

    Examples
    --------
    >>> from kilter.contact import contacts
    >>> from kilter.mechanics.program import build_program
    >>> from kilter.scenes.stacks import block_on_slope
    >>> for tilt in (26.5, 26.6):  # the limit is atan 0.5 = 26.565 degrees
    ...     block = block_on_slope(tilt, friction=0.5)
    ...     find_seating(build_program(block, contacts(block))).seated
    True
    False
    """
    law = coulomb_law(program)
    if not len(law.load) or not law.strength:
        none = np.zeros((len(program.part_a), 3))
        return Seating(True, none, check_balance(program, none), 0, 0, None)
    work = Work.of(work)
    rng = np.random.default_rng(seed)
    best: Seating | None = None
    stiffness, first = np.ones(len(law.mu)), np.zeros(len(law.load))
    iterations = 0
    for start in range(1, max(starts, 1) + 1):
        if start > 1:
            stiffness, first = _beginning(law, rng)
        state, steps = _settle(_Springs(law, stiffness), first, work)
        iterations += steps
        forces = law.forces(state.forces)
        residual = check_balance(program, forces)
        if residual <= BALANCED:
            return Seating(True, forces, residual, start, iterations, None)
        if best is None or residual < best.residual:
            away = state.x / max(float(np.linalg.norm(state.x)), TINY)
            best = Seating(False, forces, residual, start, iterations, law.acceleration(away))
        if work.over:
            break
    assert best is not None  # there is at least one start
    return Seating(False, best.forces, best.residual, start, iterations, best.runaway)


def _beginning(law: CoulombLaw, rng: np.random.Generator) -> tuple[Array, Array]:
    """A stiffness a patch, and a first displacement that squeezes what it can, and a little."""
    patches = int(law.patch.max(initial=-1)) + 1
    stiffness = SPREAD ** rng.uniform(-1.0, 1.0, patches)[law.patch]
    depth = rng.uniform(0.0, SQUEEZE, patches)[law.patch]
    normal = law.matrix[::3]
    nearest = normal.T @ normal + SOFT_SQUEEZE * eye_array(len(law.load))
    x: Array = _factor(csc_array(nearest)).solve(-(normal.T @ depth))
    return stiffness, x + rng.normal(size=len(x)) * NUDGE


@dataclass(slots=True)
class _State:
    """A displacement with what follows from it: forces (n, u, v), -df/du and r."""

    x: Array
    forces: Array
    slope: Array
    rest: Array


class _Springs:
    """The equations r(x) = 0 of one start."""

    def __init__(self, law: CoulombLaw, stiffness: Array) -> None:
        self.law, self.stiffness = law, stiffness
        self.transposed = law.matrix.T.tocsr()
        self.full = law.matrix.toarray() if len(law.load) <= DENSE else None
        part = np.flatnonzero(law.program.free)
        weight = law.program.weight[part] / np.sqrt(law.program.mass[part]) / law.strength
        self.weight = np.maximum(weight, TINY)

    def at(self, x: Array) -> _State:
        forces, slope = _response(self.law, self.stiffness, self.law.matrix @ x)
        return _State(x, forces, slope, self.law.load + self.transposed @ forces.reshape(-1))

    def imbalance(self, state: _State) -> float:
        """Worst imbalance of a part over its weight."""
        rest = np.linalg.norm(state.rest.reshape(len(self.weight), -1), axis=1)
        return float((rest / self.weight).max())

    def newton(self, state: _State, right: Array, drag: float, work: Work) -> Array:
        """The step dx of (drag - dr/dx) dx = right."""
        slope, law, count = state.slope, self.law, len(right)
        if self.full is not None:
            product = np.matmul(slope, self.full.reshape(-1, 3, count)).reshape(-1, count)
            matrix = self.full.T @ product
            matrix[range(count), range(count)] += drag
            work.dense(count)
            dense: Array = np.linalg.solve(matrix, right)
            return dense
        start = np.arange(len(slope) + 1)
        blocks = bsr_array((slope, start[:-1], start), shape=(3 * len(slope), 3 * len(slope)))
        system = self.transposed @ (blocks.tocsr() @ law.matrix) + drag * eye_array(count)
        factor = _factor(csc_array(system))
        work.sparse(count, factor.nnz)
        step: Array = factor.solve(right)
        return step

    def advance(self, state: _State, step: float, work: Work) -> tuple[_State | None, int]:
        """The state a pseudo-time `step` later, None where Newton fails; Newton steps made.

        One implicit Euler step, (x' - x) / step = r(x'), solved to a tenth of r(x).
        """
        new, right = state, state.rest
        enough, last = STEP_ERROR * float(np.linalg.norm(state.rest)), np.inf
        for count in range(1, INNER + 1):
            try:
                new = self.at(new.x + self.newton(new, right, 1.0 / step, work))
            except (RuntimeError, np.linalg.LinAlgError):  # a singular matrix
                return None, count
            right = new.rest - (new.x - state.x) / step
            error = float(np.linalg.norm(right))
            if error <= enough:
                return new, count
            if not error <= FALLING * last:
                break
            last = error
        return None, count


def _settle(springs: _Springs, x: Array, work: Work) -> tuple[_State, int]:
    """The state in which a start ends, and the steps of Newton's method it took."""
    state, step, steps = springs.at(x), 1.0, 0
    while steps < STEPS and step > SHORTEST and not work.late:
        new, count = springs.advance(state, step, work)
        steps += count
        if new is None:
            step *= CUT
            continue
        fall = float(np.linalg.norm(state.rest)) / max(float(np.linalg.norm(new.rest)), TINY)
        state = new
        if springs.imbalance(state) <= GOAL or (step > LONGEST and fall < EASING):
            break
        step *= (GROWTH if count <= EASY else SLOW) * float(np.clip(fall, 1.0, LEAP))
    return state, steps


def _factor(matrix: csc_array) -> SuperLU:
    """Sparse factors, ordered as for a symmetric matrix."""
    from scipy.sparse.linalg import splu

    return splu(matrix, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})


def _response(law: CoulombLaw, stiffness: Array, speeds: Array) -> tuple[Array, Array]:
    """Forces (n, u, v) of displacements of the points, and -df/du, shape (K, 3, 3)."""
    u = speeds.reshape(-1, 3)
    k, across = stiffness, ACROSS * stiffness
    touching = (u[:, 0] < 0) | law.tied
    f_n = np.where(touching, -k * u[:, 0], 0.0)
    pull = -across[:, None] * u[:, 1:]
    drag = np.sqrt((pull**2).sum(axis=1))
    limit = np.where(law.tied, 0.0, law.mu * f_n)
    sticks = drag <= limit
    share = np.where(sticks, 1.0, limit / np.maximum(drag, TINY))
    forces = np.empty_like(u)
    forces[:, 0], forces[:, 1:] = f_n, share[:, None] * pull
    slope = np.zeros((len(u), 3, 3))
    slope[:, 0, 0] = k * touching
    e = pull / np.maximum(drag, TINY)[:, None]
    slides = ~sticks & touching & ~law.tied
    slope[:, 1:, 0] = (law.mu * k * slides)[:, None] * e
    bend = (across * share)[:, None, None] * np.eye(2)
    bend -= np.where(slides, across * share, 0.0)[:, None, None] * e[:, :, None] * e[:, None, :]
    slope[:, 1:, 1:] = bend * touching[:, None, None]
    return forces, slope
