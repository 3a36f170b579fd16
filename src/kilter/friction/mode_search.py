"""Search for motions by branch and bound over contact modes, if De Saxce's iteration fails.

A node maximises the power in a convex relaxation of the law (scaled as in `kilter.friction.law`),

    max w.x:   x = w + H^T f,  u_n >= 0,  f in Coulomb's cone,  |x - w/2| <= 1/2

with the modes of some points decided: open (f = 0), sticking (u = 0), or sliding with u_t in a
sector of directions, f_t opposite to it and beyond the chord of the sector. (Any solution of the
law has |x|^2 <= w.x, and so lies in the ball.) A node is divided at the point that violates the law
most, measured by the power f_n u_n + f_t.u_t + mu f_n |u_t|, which is 0 by the law; sectors are
halved. The optimum of each relaxation is a candidate for `kilter.friction.polish`. A node without
power is dropped without verifying the solver's answer, which suffices for a search, but not for a
proof.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csc_array

from kilter.arrays import Array, Index, Mask
from kilter.friction.branching import CaseTree, Mode
from kilter.friction.friction_tolerances import NODE_GAP, OBEYED
from kilter.friction.law import CoulombLaw
from kilter.friction.polish import TrialMotion
from kilter.mechanics.mechanics_tolerances import WITNESS_POWER
from kilter.solvers.problem import ConicProgram
from kilter.work import Work

PLANAR_SECTOR = 0.1
"""Half width of the sector that stands for a sliding direction in the plane [rad]."""
DEPTH_BONUS = 0.9
"""Weight of a node's power for each level nearer to the root: among equal powers, deep nodes come
first.
"""


@dataclass(frozen=True, slots=True, eq=False)
class _Decisions:
    """Contact modes chosen in a node of the search, with the sectors of the sliding rows."""

    mode: Index
    middle: Array
    half: Array
    depth: int

    def with_mode(self, p: int, mode: Mode, middle: float = 0.0, half: float = 0.0) -> _Decisions:
        """Copy of these choices in which point p has a mode and, if it slides, a sector."""
        modes, middles, halves = self.mode.copy(), self.middle.copy(), self.half.copy()
        modes[p], middles[p], halves[p] = mode, middle, half
        return replace(self, mode=modes, middle=middles, half=halves, depth=self.depth + 1)


@dataclass(frozen=True, slots=True, eq=False)
class _Node:
    """Node of the branch and bound: its choices, the optimum of its relaxation, and the power."""

    decided: _Decisions
    optimum: TrialMotion
    power: float


def by_modes(law: CoulombLaw, *, nodes: int, work: Work) -> Iterator[TrialMotion]:
    """Yield candidate motions: the optima of up to `nodes` relaxations, best node first."""
    count, lines = len(law.mu), law.matrix.toarray()

    def bound(decided: _Decisions, _: _Node | None) -> _Node | None:
        optimum = _solve_relaxation(law, lines, decided, work)
        power = float(law.load @ optimum.x) if optimum else 0.0
        return None if optimum is None or power < WITNESS_POWER else _Node(decided, optimum, power)

    tree = CaseTree(
        bound,
        lambda node: _children(law, node.decided, node.optimum),
        lambda node: node.power * DEPTH_BONUS**-node.decided.depth,
    )
    root = _Decisions(np.full(count, Mode.UNDECIDED), np.zeros(count), np.zeros(count), 0)
    for node in tree.explore(root, most=nodes):
        yield node.optimum


def _children(law: CoulombLaw, node: _Decisions, optimum: TrialMotion) -> list[_Decisions]:
    """Divide a node by the modes of the row that violates the law most; empty if none does."""
    u, f = (law.matrix @ optimum.x).reshape(-1, 3), optimum.forces
    slip = np.linalg.norm(u[:, 1:], axis=1)
    gain = f[:, 0] * u[:, 0] + (f[:, 1:] * u[:, 1:]).sum(axis=1) + law.mu * f[:, 0] * slip
    decided = law.tied | (node.mode == Mode.OPEN) | (node.mode == Mode.STICKING)
    gain = np.where(decided, 0.0, gain)
    p = int(gain.argmax()) if len(gain) else 0
    if not len(gain) or gain[p] < OBEYED:
        return []
    if node.mode[p] == Mode.SLIDING:
        half = node.half[p] / 2
        return [node.with_mode(p, Mode.SLIDING, node.middle[p] + s * half, half) for s in (-1, 1)]
    children = [node.with_mode(p, Mode.OPEN), node.with_mode(p, Mode.STICKING)]
    if law.mu[p] <= 0:
        return [children[0], node.with_mode(p, Mode.SLIDING, 0.0, np.pi)]
    if law.program.planar:
        angles, half = [0.0, np.pi], PLANAR_SECTOR  # along u, or against it
    else:
        first, half = float(np.arctan2(u[p, 2], u[p, 1])), np.pi / 4
        angles = [first + 2 * k * half for k in range(4)]
    return children + [node.with_mode(p, Mode.SLIDING, angle, half) for angle in angles]


def _solve_relaxation(
    law: CoulombLaw, lines: Array, node: _Decisions, work: Work
) -> TrialMotion | None:
    """Solve the convex relaxation of a node; None if it is infeasible or the solver fails."""
    from kilter.solvers.clarabel import solve_conic

    answer = solve_conic(_relaxation_program(law, lines, node), tolerance=NODE_GAP, work=work)
    if not answer.found:
        return None
    count = len(law.load)
    return TrialMotion(answer.x[:count], answer.x[count:].reshape(-1, 3))


def _relaxation_program(law: CoulombLaw, lines: Array, node: _Decisions) -> ConicProgram:
    """Convex program of a node, with unknown motion and forces; `lines` is the law's matrix."""
    count, total = len(law.load), len(law.load) + 3 * len(law.mu)
    slides, free = node.mode == Mode.SLIDING, ~law.tied
    sticks, is_open = (node.mode == Mode.STICKING) & free, node.mode == Mode.OPEN
    smooth = np.flatnonzero(law.mu <= 0)
    speedless = np.concatenate([_point_lines(sticks), 3 * np.flatnonzero(slides | law.tied)])
    forceless = np.concatenate([_point_lines(is_open), 3 * smooth + 1, 3 * smooth + 2])
    nonnegative = 3 * np.flatnonzero(free & ~sticks & ~slides)
    pushing = 3 * np.flatnonzero(free & (law.mu <= 0) & ~is_open)
    rough = _point_lines(free & (law.mu > 0) & ~is_open)
    sector_u, sector_f = _sectors(law, node, np.flatnonzero(slides & (law.mu > 0)))
    weights = np.where(rough % 3 == 0, law.mu[rough // 3], 1.0)
    forces = np.eye(total - count)
    blocks: list[tuple[Array | None, Array | None]] = [
        (np.eye(count), -lines.T),  # x = w + H^T f
        (
            lines[speedless],
            None,
        ),  # no speed at sticking points, and none along the normal of sliding points
        (
            None,
            forces[forceless],
        ),  # no force at open points, and none across points without friction
        (-lines[nonnegative], None),  # u_n >= 0
        (None, -forces[pushing]),  # f_n >= 0 without friction
        (-(sector_u @ lines), None),
        (None, -sector_f),
        (None, -weights[:, None] * forces[rough]),  # Coulomb's cones
        (np.vstack([np.zeros(count), -np.eye(count)]), None),  # the ball
    ]
    full = _stack(blocks, count, total)
    bound = np.zeros(len(full))
    bound[:count] = law.load
    bound[-count - 1 :] = 0.5 * np.concatenate([[1.0], -law.load])
    return ConicProgram(
        csc_array((total, total)),
        np.concatenate([-law.load, np.zeros(total - count)]),
        csc_array(full),
        bound,
        count + len(speedless) + len(forceless),
        len(nonnegative) + len(pushing) + len(sector_u) + len(sector_f),
        np.concatenate([np.full(len(rough) // 3, 3), [count + 1]]),
    )


def _stack(blocks: list[tuple[Array | None, Array | None]], count: int, total: int) -> Array:
    """Stack row blocks, each a pair of matrices over x and over f; None stands for zero."""
    rows = []
    for of_x, of_f in blocks:
        height = len(of_x) if of_x is not None else len(of_f) if of_f is not None else 0
        block = np.zeros((height, total))
        if of_x is not None:
            block[:, :count] = of_x
        if of_f is not None:
            block[:, count:] = of_f
        rows.append(block)
    return np.vstack(rows)


def _point_lines(chosen: Mask) -> Index:
    """Indices of the matrix lines (normal n, tangents u, v) of every chosen row."""
    rows: Index = (3 * np.flatnonzero(chosen)[:, None] + np.arange(3)).reshape(-1)
    return rows


def _sectors(law: CoulombLaw, node: _Decisions, rows: Index) -> tuple[Array, Array]:
    """Constraint rows that keep sliding directions in their sectors, with opposite friction."""
    total, low = 3 * len(law.mu), node.middle[rows] - node.half[rows]
    high, middle = node.middle[rows] + node.half[rows], node.middle[rows]
    # a direction e is in the sector if low x e >= 0 and e x high >= 0
    sides = np.concatenate([
        np.column_stack([-np.sin(low), np.cos(low)]),
        np.column_stack([np.sin(high), -np.cos(high)]),
    ])  # fmt: skip
    both = np.concatenate([rows, rows])
    speeds = _sparse_lines(both, np.column_stack([np.zeros(len(both)), sides]), total)
    chord = np.column_stack([
        -law.mu[rows] * np.cos(node.half[rows]), -np.cos(middle), -np.sin(middle)
    ])  # fmt: skip
    against = np.column_stack([np.zeros(len(both)), -sides])
    forces = _sparse_lines(np.concatenate([both, rows]), np.concatenate([against, chord]), total)
    return speeds, forces


def _sparse_lines(rows: Index, values: Array, total: int) -> Array:
    """Matrix rows with three values each, in the columns of the given contact rows."""
    lines = np.zeros((len(rows), total))
    lines[np.arange(len(rows))[:, None], 3 * rows[:, None] + np.arange(3)] = values
    return lines
