"""Branch and bound over contact modes, in search of motions that repel De Saxce's iteration.

A node asks for the most power in a convex relaxation of the law,

    max w.x:   x = w + H^T f,  u_n >= 0,  f in Coulomb's cone,  |x - w/2| <= 1/2

with some points decided: parting (f = 0), sticking (u = 0) or sliding, u_t in a sector, f_t
against it, beyond the chord of the sector. (Any solution of the law has |x|^2 <= w.x, and so
is in the ball.) It splits at the point that breaks the law most, by the power
f_n u_n + f_t.u_t + mu f_n |u_t| that the law wants to be 0; sectors are halved. The
relaxation's optimum is a candidate to be made exact. A node without power is left: for the
search alone, it is no proof.
"""

from __future__ import annotations

import heapq
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csc_array

from kilter.arrays import Array, Index, Mask
from kilter.friction.frictional import Frictional
from kilter.friction.polish import Candidate
from kilter.mechanics.law_check import POWER
from kilter.solvers.problem import ConicProgram

__all__ = ["by_modes"]


OPEN, PART, STICK, SLIDE = 0, 1, 2, 3
"""What is decided of a point."""
OBEYED = 1e-9
"""Power by which no point breaks the law."""
NARROW = 0.1
"""Half a sector of a planar point, whose only tangent is in its middle [rad]."""
DEPTH_BONUS = 0.9
"""What a node's power counts for a level further up: deep nodes first where powers are equal."""


@dataclass(frozen=True, slots=True, eq=False)
class _Node:
    """What is decided: mode of each row, and the sector of those that slide [rad]."""

    mode: Index
    middle: Array
    half: Array
    depth: int


def by_modes(law: Frictional, *, nodes: int, seconds: float) -> Iterator[Candidate]:
    """Candidates of at most `nodes` relaxations, the most promising first.

    Parameters
    ----------
    law : Frictional
    nodes : int
    seconds : float
        Time limit of one relaxation.
    """
    count, lines = len(law.mu), law.matrix.toarray()
    start = _Node(np.full(count, OPEN), np.zeros(count), np.zeros(count), 0)
    heap: list[tuple[float, int, _Node, Candidate]] = []
    asked = 0
    ready: list[_Node] = [start]
    while ready or heap:
        for node in ready:
            if asked >= nodes:
                return
            asked += 1
            candidate = _relaxed(law, lines, node, seconds)
            power = float(law.load @ candidate.x) if candidate else 0.0
            if candidate is None or power < POWER:
                continue
            yield candidate
            rank = -power * DEPTH_BONUS**-node.depth
            heapq.heappush(heap, (rank, asked, node, candidate))
        if not heap:
            return
        _, _, node, candidate = heapq.heappop(heap)
        ready = _children(law, node, candidate)


def _children(law: Frictional, node: _Node, now: Candidate) -> list[_Node]:
    """The node split at the point that breaks the law most."""
    u, f = (law.matrix @ now.x).reshape(-1, 3), now.forces
    slip = np.linalg.norm(u[:, 1:], axis=1)
    broken = f[:, 0] * u[:, 0] + (f[:, 1:] * u[:, 1:]).sum(axis=1) + law.mu * f[:, 0] * slip
    broken = np.where(law.tied | (node.mode == PART) | (node.mode == STICK), 0.0, broken)
    p = int(broken.argmax()) if len(broken) else 0
    if not len(broken) or broken[p] < OBEYED:
        return []
    if node.mode[p] == SLIDE:
        half = node.half[p] / 2
        return [_decided(node, p, SLIDE, node.middle[p] + s * half, half) for s in (-1, 1)]
    first = float(np.arctan2(u[p, 2], u[p, 1]))
    children = [_decided(node, p, PART), _decided(node, p, STICK)]
    if law.mu[p] <= 0:
        return [children[0], _decided(node, p, SLIDE, 0.0, np.pi)]
    if law.program.planar:
        axis = float(np.arctan2(*np.abs(law.basis[p, [2, 1]][:, [0, 2]]).max(axis=1).round()))
        return children + [_decided(node, p, SLIDE, axis + k * np.pi, NARROW) for k in range(2)]
    quarter = np.pi / 4
    sectors = (first + 2 * k * quarter for k in range(4))
    return children + [_decided(node, p, SLIDE, angle, quarter) for angle in sectors]


def _decided(node: _Node, p: int, mode: int, middle: float = 0.0, half: float = 0.0) -> _Node:
    modes, middles, halves = node.mode.copy(), node.middle.copy(), node.half.copy()
    modes[p], middles[p], halves[p] = mode, middle, half
    return replace(node, mode=modes, middle=middles, half=halves, depth=node.depth + 1)


def _relaxed(law: Frictional, lines: Array, node: _Node, seconds: float) -> Candidate | None:
    """The optimum of a node's relaxation; None where it is empty or the solver broke down."""
    from kilter.solvers.conic import solve_conic

    answer = solve_conic(_relaxation(law, lines, node), tolerance=1e-8, seconds=seconds)
    if answer.outcome == "infeasible" or not np.isfinite(answer.x).all():
        return None
    count = len(law.load)
    return Candidate(answer.x[:count], answer.x[count:].reshape(-1, 3))


def _relaxation(law: Frictional, lines: Array, node: _Node) -> ConicProgram:
    """The convex program of a node, in (x, f); `lines` is H in full."""
    count, total = len(law.load), len(law.load) + 3 * len(law.mu)
    slide, stick = node.mode == SLIDE, (node.mode == STICK) & ~law.tied
    part, free = node.mode == PART, ~law.tied
    idle = np.flatnonzero(law.mu <= 0)
    still = np.concatenate([_points(stick), 3 * np.flatnonzero(slide | law.tied)])
    none = np.concatenate([_points(part), 3 * idle + 1, 3 * idle + 2])
    above = 3 * np.flatnonzero(free & ~stick & ~slide)
    pushing = 3 * np.flatnonzero(free & (law.mu <= 0) & ~part)
    rough = _points(free & (law.mu > 0) & ~part)
    sector_u, sector_f = _sectors(law, node, np.flatnonzero(slide & (law.mu > 0)))
    weights = np.where(rough % 3 == 0, law.mu[rough // 3], 1.0)
    forces = np.eye(total - count)
    blocks = [
        (np.eye(count), -lines.T),
        (lines[still], None),
        (None, forces[none]),
        (-lines[above], None),
        (None, -forces[pushing]),
        (-(sector_u @ lines), None),
        (None, -sector_f),
        (None, -weights[:, None] * forces[rough]),
        (np.vstack([np.zeros(count), -np.eye(count)]), None),
    ]
    heights = [next(len(side) for side in pair if side is not None) for pair in blocks]
    full, row = np.zeros((sum(heights), total)), 0
    for (of_x, of_f), height in zip(blocks, heights, strict=True):
        if of_x is not None:
            full[row : row + height, :count] = of_x
        if of_f is not None:
            full[row : row + height, count:] = of_f
        row += height
    bound = np.zeros(len(full))
    bound[:count] = law.load
    bound[-count - 1 :] = 0.5 * np.concatenate([[1.0], -law.load])
    return ConicProgram(
        csc_array((total, total)),
        np.concatenate([-law.load, np.zeros(total - count)]),
        csc_array(full),
        bound,
        count + len(still) + len(none),
        len(above) + len(pushing) + len(sector_u) + len(sector_f),
        np.concatenate([np.full(len(rough) // 3, 3), [count + 1]]),
    )


def _points(chosen: Mask) -> Index:
    """The three lines of every chosen row."""
    rows: Index = (3 * np.flatnonzero(chosen)[:, None] + np.arange(3)).reshape(-1)
    return rows


def _sectors(law: Frictional, node: _Node, rows: Index) -> tuple[Array, Array]:
    """Lines that are not negative: of speeds in their sectors, of forces against them."""
    total, low = 3 * len(law.mu), node.middle[rows] - node.half[rows]
    high, middle = node.middle[rows] + node.half[rows], node.middle[rows]
    # a direction e is in the sector where low x e >= 0 and e x high >= 0
    sides = np.concatenate([
        np.column_stack([-np.sin(low), np.cos(low)]),
        np.column_stack([np.sin(high), -np.cos(high)]),
    ])  # fmt: skip
    both = np.concatenate([rows, rows])
    speeds = _lines(both, np.column_stack([np.zeros(len(both)), sides]), total)
    chord = np.column_stack([
        -law.mu[rows] * np.cos(node.half[rows]), -np.cos(middle), -np.sin(middle)
    ])  # fmt: skip
    against = np.column_stack([np.zeros(len(both)), -sides])
    forces = _lines(np.concatenate([both, rows]), np.concatenate([against, chord]), total)
    return speeds, forces


def _lines(rows: Index, values: Array, total: int) -> Array:
    """Lines with three values each, at the columns of a row's point."""
    lines = np.zeros((len(rows), total))
    lines[np.arange(len(rows))[:, None], 3 * rows[:, None] + np.arange(3)] = values
    return lines
