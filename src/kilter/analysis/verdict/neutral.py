"""Number of neutral motions: independent motions that cost no energy to first order.

    two-sided:   dim {dp: J dp = 0, w.dp = 0}
    one-sided:   dim span {dp: J dp >= 0, w.dp = 0} - two-sided

A box on a table has 3 two-sided and 0 one-sided neutral motions: it slides and spins. An assembly
without neutral motions is strictly stable. Along neutral motions second order decides: a ball on a
ball is "stable" to first order.

The span of the cone follows from the rows that never open. All rows that can open do so in a
common motion. Therefore a single linear program, which maximises the sum of the openings, each up
to a bound, finds the rows that never open.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import csc_array, diags_array, hstack, vstack

from kilter.analysis.analysis_tolerances import RANK
from kilter.arrays import TINY, Array, Mask
from kilter.mechanics.forms import ScaledProblem, scaled_problem
from kilter.mechanics.mechanics_tolerances import ZERO_ENTRY
from kilter.mechanics.program import Program
from kilter.solvers.problem import LinearProgram
from kilter.tell.record import Record

__all__ = ["LIMIT", "Neutral", "find_neutral"]


LIMIT = 100
"""Largest number of free parts for which neutral motions are counted."""


class Neutral(Record, kw_only=False):
    """Numbers of independent neutral motions, which cost no energy to first order."""

    two_sided: int
    """Number of motions that keep all contacts."""
    one_sided: int
    """Number of further motions, which open a contact."""


def find_neutral(program: Program) -> Neutral | None:
    """Count the neutral motions of a program, without friction; None if no solver finishes.

    Returns None for more than `LIMIT` free parts, or if no solver finishes.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> from kilter.contact import contacts
    >>> from kilter.mechanics.program import build_program
    >>> assembly = scene("tower")
    >>> find_neutral(build_program(assembly, contacts(assembly))).to_dict()
    {'two_sided': 15, 'one_sided': 0}
    """
    if int(program.free.sum()) > LIMIT:
        return None
    if not program.free.any():
        return Neutral(0, 0)
    problem = scaled_problem(program)
    opening = _unit_rows(problem)
    blur = float(max(RANK, 10 * program.tolerance.max()))
    power = problem.power()
    load = power[None, :] / max(float(np.linalg.norm(power)), TINY)
    everything = np.vstack([opening, load])
    freedoms = opening.shape[1]
    two_sided = freedoms - _rank(everything, blur)
    never = _never_open(problem, opening, load, blur)
    if never is None:
        return None
    one_sided = freedoms - _rank(np.vstack([opening[never], load]), blur) - two_sided
    return Neutral(two_sided, one_sided)


def _unit_rows(problem: ScaledProblem) -> Array:
    """Unit gradients of the gaps in scaled unknowns, shape (rows, freedoms)."""
    rows = problem.openings().toarray()
    length = np.linalg.norm(rows, axis=1)
    unit: Array = rows / np.where(length > 0, length, 1.0)[:, None]
    return unit


def _rank(matrix: Array, blur: float) -> int:
    """Rank of a matrix: number of singular values above `blur` times the largest."""
    if not len(matrix):
        return 0
    if len(matrix) > matrix.shape[1]:
        # the triangular factor has the same singular values; asarray is for numpy's type stub
        matrix = np.asarray(np.linalg.qr(matrix, mode="r"))
    values = np.linalg.svd(matrix, compute_uv=False)
    return int((values > blur * max(values.max(initial=0.0), TINY)).sum())


def _never_open(problem: ScaledProblem, opening: Array, load: Array, blur: float) -> Mask | None:
    """Mask of the contacts that no neutral motion opens; None if no solver finishes."""
    from kilter.solvers.highs import find_optimum

    rows, count = opening.shape
    two_sided = problem.program.two_sided
    slack = diags_array(-np.where(two_sided, 0.0, 1.0))
    body = csc_array(np.where(np.abs(opening) < ZERO_ENTRY, 0.0, opening))
    matrix = vstack(
        [hstack([body, slack]), hstack([csc_array(load), csc_array((1, rows))])], format="csc"
    )
    # unknowns up to 1/sqrt(blur) per unit of opening: a row that opens less counts as closed
    reach = 1.0 / np.sqrt(blur)
    lp = LinearProgram(
        cost=np.concatenate([np.zeros(count), -np.ones(rows)]),
        matrix=matrix,
        row_lower=np.append(np.full(rows, 0.0) - np.where(two_sided, 0.0, blur), 0.0),
        row_upper=np.append(np.where(two_sided, 0.0, np.inf), 0.0),
        lower=np.concatenate([np.full(count, -reach), np.zeros(rows)]),
        upper=np.concatenate([np.full(count, reach), np.ones(rows)]),
    )
    answer = find_optimum(lp)
    if not answer.optimal:
        return None
    never: Mask = (answer.x[count:] < 0.5) | two_sided
    return never
