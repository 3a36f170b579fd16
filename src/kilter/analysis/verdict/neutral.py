"""Neutral motions: motions that cost no energy to first order.

    two-sided:   dim {dp: J dp = 0, w.dp = 0}
    one-sided:   dim span {dp: J dp >= 0, w.dp = 0}, minus the above

A box on a table has 3 and 0 (it slides and spins); an assembly with 0 and 0 is strictly
held. Second order decides neutral motions: a ball on a ball is "stable" to first
order. Friction is left out.

The span of the cone: every row that can open in it opens in a common motion, so an LP
that maximises the sum of openings, each cut off at a bound, finds the rows that never open.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csc_array, diags_array, hstack, vstack

from kilter.analysis.analysis_tolerances import RANK
from kilter.arrays import TINY, Array, Mask
from kilter.mechanics.forms import ScaledProblem, scaled_problem
from kilter.mechanics.mechanics_tolerances import ZERO_ENTRY
from kilter.mechanics.program import Program
from kilter.solvers.problem import LinearProgram

__all__ = ["LIMIT", "Neutral", "find_neutral"]


LIMIT = 100
"""Neutral motions are counted for up to this many free parts."""


@dataclass(frozen=True, slots=True)
class Neutral:
    """Dimensions of the neutral motions."""

    two_sided: int
    one_sided: int


def find_neutral(program: Program) -> Neutral | None:
    """Count the neutral motions; None above the limit, or if no solver finished.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> from kilter.contact import contacts
    >>> from kilter.mechanics.program import build_program
    >>> assembly = scene("tower")
    >>> find_neutral(build_program(assembly, contacts(assembly)))
    Neutral(two_sided=15, one_sided=0)
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
    """Distinct rows of J in scaled unknowns, each of length 1; dense."""
    rows = problem.openings().toarray()
    length = np.linalg.norm(rows, axis=1)
    unit: Array = rows / np.where(length > 0, length, 1.0)[:, None]
    return unit


def _rank(matrix: Array, blur: float) -> int:
    if not len(matrix):
        return 0
    if len(matrix) > matrix.shape[1]:
        # an array already; the stub of numpy knows no mode "r"
        matrix = np.asarray(np.linalg.qr(matrix, mode="r"))
    values = np.linalg.svd(matrix, compute_uv=False)
    return int((values > blur * max(values.max(initial=0.0), TINY)).sum())


def _never_open(problem: ScaledProblem, opening: Array, load: Array, blur: float) -> Mask | None:
    """Rows that no motion of the cone opens; None if no solver finished the program."""
    from kilter.solvers.highs import find_optimum

    rows, count = opening.shape
    two_sided = problem.program.two_sided
    slack = diags_array(-np.where(two_sided, 0.0, 1.0))
    body = csc_array(np.where(np.abs(opening) < ZERO_ENTRY, 0.0, opening))
    matrix = vstack(
        [hstack([body, slack]), hstack([csc_array(load), csc_array((1, rows))])], format="csc"
    )
    # motions up to 1/blur times the openings asked for: what opens less than that never does
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
