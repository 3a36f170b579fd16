"""Search for a falling path along a critical motion, by choice of its second derivative.

    max m:   J_k d2 + dp.H_k dp >= m for rows with J_k dp = 0
             w.d2 - dp.S dp >= m,   |d2| <= reach,   with S of springs
             J_k d2 + dp.H_k dp  = 0 for rows of joints

By duality a d2 with m = 0 exists iff no forces of equilibrium curve the energy upward along dp.
Parts that are pressed between planes keep these contacts: then d2 shifts them along the planes.
`paths` has the theory.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from scipy.sparse import csc_array

from kilter.arrays import TINY, Array, Index, Mask
from kilter.contact.contact_set import ContactSet
from kilter.mechanics.program import Program
from kilter.second_order.gaps.stationary import Stationary
from kilter.second_order.motions.free_motions import scaled_columns
from kilter.second_order.motions.null_space import null_space
from kilter.second_order.motions.sharp_points import sharp_points
from kilter.second_order.parts.bearing import level_axes
from kilter.second_order.proofs.cluster_facts import ClusterFacts
from kilter.second_order.proofs.level_rest import level_rows
from kilter.second_order.proofs.minimum_proof import MinimumProof, judge_minimum
from kilter.second_order.proofs.paths import Path, judge_path
from kilter.second_order.searches.counted_program import optimum
from kilter.second_order.searches.energy_decision import EnergyDecision
from kilter.second_order.searches.level_rest_search import find_parting
from kilter.second_order.second_order_tolerances import ACROSS, DROPS, REACHES
from kilter.solvers.problem import LinearProgram
from kilter.work import Work

TURNS = [3, 4, 5, 9, 10, 11]
"""Indices of the turns among the 12 unknowns of a contact."""


def find_path(
    problem: Stationary,
    motion: Array,
    *,
    balancing: Array | None = None,
    work: Work | None = None,
) -> Path | None:
    """Falling path along a critical motion, (n,); None if the linear program is not solved.

    Arguments: `balancing` (m, K).
    """
    first = motion / max(float(np.linalg.norm(motion)), TINY)
    path = None
    for reach in () if _held_up(problem, first, balancing) else REACHES:
        second = _second_derivative(problem, first, reach, work)
        path = None if second is None else judge_path(problem, first, second)
        if path is not None and path.falls:
            return path
    return _along_planes(problem, first, balancing, work) or path


def _held_up(problem: Stationary, motion: Array, balancing: Array | None) -> bool:
    """True if known equilibrium forces exclude a falling path along a motion, shape (n,).

    w.d2 = -f.J d2 <= sum of f_k z.H_k z: the power is at most the curvature of the energy, negated,
    and springs take up z.S z.
    """
    if balancing is None or not len(balancing):
        return False
    released = balancing @ problem.bends(motion) - problem.spring_cost(motion)
    return bool(released.min() < DROPS)


def _along_planes(
    problem: Stationary, motion: Array, balancing: Array | None, work: Work | None
) -> Path | None:
    """Path on which parts stay on the planes along which they shift; None without one."""
    turned = np.append(np.abs(motion), 0.0)[problem.columns[:, TURNS]].max(axis=1, initial=0.0)
    keep = problem.planes & (np.abs(problem.rows @ motion) < ACROSS) & (turned < ACROSS)
    if not keep.any():
        return None
    fixed = _turns_of(problem, keep)
    conditions = np.vstack([problem.rows[keep], np.eye(len(motion))[fixed]])
    within = null_space(conditions, problem.blur)
    first = within @ (within.T @ motion)
    first[fixed] = 0.0
    size = float(np.linalg.norm(first))
    if size < 0.5:
        return None
    first = first / size
    if _held_up(problem, first, balancing):
        return None
    loose = replace(
        problem.taking(~keep),
        rows=problem.rows[~keep] @ within,
        load=problem.load @ within,
        springs=None if problem.springs is None else problem.spring_curvature(within),
    )
    path = None
    for reach in REACHES:
        second = _second_derivative(
            loose, within.T @ first, reach, work, problem.bends(first)[~keep]
        )
        if second is None:
            return None
        bent = within @ second
        bent[fixed] = 0.0
        path = judge_path(problem, first, bent)
        if path.falls:
            break
    return path


def _on_joints(problem: Stationary, second: Array, rows: Array, bends: Array) -> Array:
    """Nearest second derivative that keeps joints closed beyond the tolerance of the program."""
    if not len(rows):
        return second
    error = rows @ second + bends
    return second - np.asarray(np.linalg.lstsq(rows, error, rcond=problem.blur)[0])


def _turns_of(problem: Stationary, rows: Mask) -> Index:
    """Indices of the unknowns for turns of the parts at given rows, shape (K,)."""
    places = np.unique(problem.columns[rows][:, TURNS])
    return np.asarray(places[places >= 0], dtype=np.int64)


def _second_derivative(
    problem: Stationary,
    first: Array,
    reach: float,
    work: Work | None,
    bends: Array | None = None,
) -> Array | None:
    """Second derivative of a path that opens and falls as fast as possible, (n,); or None.

    J d2 + dp.H dp >= m for rows that dp keeps closed,  w.d2 - dp.S dp >= m,  |d2| <= reach.
    """
    closed = (problem.rows @ first <= DROPS) | problem.two_sided
    rows = problem.rows[closed]
    bends = (problem.bends(first) if bends is None else bends)[closed]
    freedoms = len(first)
    joined = problem.two_sided[closed]
    matrix = np.vstack(
        [
            np.hstack([rows, np.where(joined, 0.0, -1.0)[:, None]]),
            np.append(problem.load, -1.0)[None],
        ]
    )
    bound = np.append(np.full(freedoms, reach), 1.0)
    x = optimum(
        LinearProgram(
            np.append(np.zeros(freedoms), -1.0),
            csc_array(matrix),
            np.append(-bends, problem.spring_cost(first)),
            np.append(np.where(joined, -bends, np.inf), np.inf),
            -bound,
            bound,
        ),
        work,
    )
    return None if x is None else _on_joints(problem, x[:-1], rows[joined], bends[joined])


# Decisions that are valid for every surface that a mesh may represent.


TOO_NEAR = "the surfaces recognised in meshes are not known exactly enough to decide"


def decided_for_all(
    facts: ClusterFacts,
    problem: Stationary,
    decision: EnergyDecision,
    work: Work,
) -> tuple[Stationary, EnergyDecision]:
    """Return a decision only if it holds for all surfaces within their doubt; else "open".

    Returns the problem at the worst bounds, which the proof is about.
    """
    proof = decision.proof
    if isinstance(proof, MinimumProof):
        worst = facts.bounded(1.0)
        if not judge_minimum(problem, proof, worst):
            return worst, decision
    elif isinstance(proof, Path):
        worst = facts.bounded(-1.0)
        for candidate in (proof, *decision.others):
            path = find_path(worst, candidate.first, work=work)
            if path is not None and path.falls:
                return worst, replace(decision, proof=path, others=())
    else:
        return problem, decision
    left = decision.neutral - decision.free
    return problem, replace(
        decision, state="open", blocked=0, undecided=left, proof=None, why=TOO_NEAR, others=()
    )


# Falling paths along which the falling parts also separate from their neighbours.


SHARES = (0.3, 1.0, 3.0)
"""Lengths of the added horizontal motion, over the length of the path [-]."""
MOST = 4
"""Largest number of paths that are tried; paths of few parts come first."""


def parted_paths(
    program: Program,
    contacts: ContactSet,
    problem: Stationary,
    paths: tuple[Path, ...],
    work: Work,
) -> Iterator[Path]:
    """Yield falling paths near given ones, with added shifts that open other contacts."""

    def moved(path: Path) -> int:
        by_part = path.first.reshape(-1, len(program.freedoms))
        return int((np.abs(by_part).max(axis=1) > ACROSS).sum())

    shifts = _level_shifts(program, contacts, problem, work)
    for path in sorted(paths, key=moved)[:MOST]:
        for away in shifts:
            for share in SHARES:
                parted = find_path(problem, path.first + share * away, work=work)
                if parted is not None and parted.falls:
                    yield parted


def _level_shifts(
    program: Program, contacts: ContactSet, problem: Stationary, work: Work
) -> list[Array]:
    """Horizontal motions, (n,): parts away from a common point, and all parts alike."""
    points = sharp_points(program, contacts)
    parting = find_parting(program, level_rows(program, contacts), points, work)
    motions = [] if parting is None else [parting]
    for axis in level_axes(program):
        for sense in (1.0, -1.0):
            motion = np.zeros((len(program.names), 6))
            motion[program.free, :3] = sense * axis
            motions.append(motion)
    columns = scaled_columns(program, problem, np.array(motions))
    return list((columns / np.linalg.norm(columns, axis=0)).T)
