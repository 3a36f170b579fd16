"""Moment relaxation of the contact law, which bounds the power without a division into cases.

    max E[w.b]:   E[each product of the law] = 0, >= 0, or in its cone,   E[v v^T] >= 0

over all moments E[z_i z_j]. Every motion that obeys the law is a feasible point, so the optimum
bounds the power of all motions; the multipliers are verified separately
(`kilter.friction.moment_bound`). The tighter the known bound of the motions, the tighter the
result: with |a|^2 <= w.a it is repeated at a smaller scale until no power is left, or it stalls.
The product matrices are small at first, and larger if that does not suffice.

A body, or two, on held parts need only the motions of pairs; a stack also needs the pushes
transmitted through it. An arch in space is never closed: its relaxed motions pivot every voussoir
on another corner. The remaining bound is still worth reporting.

References
----------
J. B. Lasserre, Global optimization with polynomials and the problem of moments, SIAM J. Optim. 11,
2001. C. Jansson, D. Chaykin, C. Keil, Rigorous error bounds for the optimal value in semidefinite
programming, SIAM J. Numer. Anal. 46, 2007.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index
from kilter.friction.force_bound import force_bound
from kilter.friction.moment_bound import SQUARES, MomentStep, Squares, power_left, squares_of
from kilter.friction.moment_forms import MomentForms, bodies_of, moment_forms, width_of
from kilter.friction.moment_products import ProductRows, law_products, monomials, over_monomials
from kilter.friction.reduced_law import ReducedLaw
from kilter.solvers.clarabel import solve_semidefinite
from kilter.solvers.semidefinite import SemidefiniteProgram
from kilter.work import SEMIDEFINITE_ENTRY, Work

__all__ = ["FORMS_OF_POINT", "MOST_FORMS", "MomentProof", "moment_program", "moment_proof"]

DEAR: dict[Squares, float] = {"pairs": 1.0, "pushes": 1.0, "cliques": 6.0}
"""Relative cost of an entry: large matrices are also factorised."""
USUAL_STEPS = 20
"""Number of interior-point steps assumed to predict the cost."""
HOPEFUL = 1e-3
"""Power over the squared scale below which another step of the same kind is worthwhile [-]."""
NEARLY = 1e-6
"""Power below which a division into cases is preferred to larger matrices [-]."""
SMALLEST = 0.01
"""Least ratio of successive scales: at a far smaller scale, fewer digits are left."""
STEPS = 8
"""Maximum number of steps."""
MOST_FORMS = 700
"""Number of coordinates of z above which matrices over all of them are too large."""
FORMS_OF_POINT = 4
"""Number of these coordinates of a point with friction in space: force and sliding speed."""
MOST_ENTRIES = 20_000_000
"""Number of entries of the product matrices above which they are not formed, because of memory."""


@dataclass(frozen=True, slots=True, eq=False)
class MomentProof:
    """Proof by moment relaxations; each step bounds the motions that the step before leaves."""

    power: float
    """Remaining power w.a over |w|^2."""
    steps: tuple[MomentStep, ...]


def moment_proof(law: ReducedLaw, opening: Array, tolerance: float, *, work: Work) -> MomentProof:
    """Bound the power of all motions by moment relaxations, until it is small or stalls.

    Arguments: `opening` (n,): a motion that bounds the forces
    (`kilter.friction.reduced_law.opening_motion`).
    """
    forces, least_power = force_bound(law, opening), 1.0
    steps: list[MomentStep] = []
    # with three or more bodies, pairs leave too much power
    size, scale = int(bodies_of(law) > 2), 1.0
    if not np.isfinite(forces) or width_of(law) > MOST_FORMS:
        return MomentProof(least_power, ())
    for _ in range(STEPS):
        if least_power <= tolerance or size == len(SQUARES) or work.over:
            break
        step = _solve_step(law, scale, SQUARES[size], work)
        power = scale**2 if step is None else power_left(law, step, forces)
        if step is not None and power < least_power:
            steps, least_power = [*steps, step], power
        work.tell(
            f"motions with more than {least_power:.1e} of the power of free fall are excluded"
        )
        if power > HOPEFUL * scale**2:
            size = len(SQUARES) if least_power < NEARLY else size + 1
        scale = max(float(np.sqrt(least_power)), SMALLEST * scale)
    return MomentProof(least_power, tuple(steps))


def _solve_step(law: ReducedLaw, scale: float, squares: Squares, work: Work) -> MomentStep | None:
    """Solve the semidefinite program of a step; None if it is too expensive or fails."""
    forms = moment_forms(law, scale)
    if _entries_of(forms, squares) > MOST_ENTRIES:
        return None
    program = moment_program(forms, squares)
    if DEAR[squares] * SEMIDEFINITE_ENTRY * USUAL_STEPS * program.entries > work.left:
        return None
    multipliers = solve_semidefinite(program, work=work)
    return None if multipliers is None else MomentStep(scale, squares, multipliers)


def _entries_of(forms: MomentForms, squares: Squares) -> int:
    """Upper bound of the number of entries of the product matrices, before they are built."""
    length = np.diff(forms.rows.indptr)
    return sum(int(length[square].sum()) ** 2 for square in squares_of(forms, squares)) // 2


def moment_program(forms: MomentForms, squares: Squares) -> SemidefiniteProgram:
    """Semidefinite relaxation of the contact law over the monomials of the forms."""
    place = monomials(forms)
    rows = law_products(forms, place)
    gain = np.zeros(int(place.max(initial=0)) + 1)
    gain[place[forms.one, forms.motion]] = forms.law.load
    return SemidefiniteProgram(
        gain,
        over_monomials(forms, rows.equal, place),
        over_monomials(forms, rows.positive, place),
        over_monomials(forms, rows.cones, place),
        1 + forms.law.directions,
        tuple(over_monomials(forms, _triangle_rows(v), place) for v in squares_of(forms, squares)),
    )


def _triangle_rows(forms: Index) -> ProductRows:
    """Products of all pairs of the given forms: the upper triangle, column by column."""
    column, row = np.tril_indices(len(forms))
    weight = np.where(row == column, 1.0, np.sqrt(2.0))
    return ProductRows(len(row), np.arange(len(row)), forms[row], forms[column], weight)
