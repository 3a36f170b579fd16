"""The moment relaxation of the contact law: bounds of the power without any case.

    max E[w.b]:   E[each product of the law] = 0, >= 0, or in its cone,   E[v v^T] >= 0

over all moments E[z_i z_j]: every motion that obeys the law is a point of it, so that its
optimum bounds the power of them all; the multipliers are judged apart
(`kilter.friction.moment_bound`). The smaller the motions are known to be, the finer the bound:
with |a|^2 <= w.a it is repeated at a smaller scale until nothing is left, or it stalls. Matrices
of products are first small; where that does not do, larger.

One body, or two, on others that are held need only the motions of pairs; a stack needs what is
pushed through it as well. An arch in space is never closed: its relaxed motions pivot every
voussoir on another corner, and the bound that is left is worth saying.

References
----------
J. B. Lasserre, Global optimization with polynomials and the problem of moments, SIAM J. Optim.
11, 2001. C. Jansson, D. Chaykin, C. Keil, Rigorous error bounds for the optimal value in
semidefinite programming, SIAM J. Numer. Anal. 46, 2007.
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

__all__ = ["MomentProof", "moment_program", "moment_proof"]

DEAR: dict[Squares, float] = {"pairs": 1.0, "pushes": 1.0, "cliques": 6.0}
"""What an entry costs: large matrices are factorised as well."""
USUAL_STEPS = 20
"""Steps of an interior point, to tell beforehand whether it can be paid."""
HOPEFUL = 1e-3
"""A power below this fraction of the square of the scale is worth another step of its kind."""
NEARLY = 1e-6
"""A power below which what is left is a matter of cases, not of larger matrices."""
SMALLEST = 0.01
"""The scale falls by no more than this in one step: far below, fewer digits are left."""
STEPS = 8
"""Steps at most."""
MOST_FORMS = 700
"""Coordinates of z above which matrices over all of them are too large."""
MOST_ENTRIES = 20_000_000
"""Entries of the matrices of products above which they are not formed: memory."""


@dataclass(frozen=True, slots=True, eq=False)
class MomentProof:
    """A chain of steps, each at the scale that the last leaves.

    Attributes
    ----------
    power : float
        What is left, w.a over |w|^2.
    steps : tuple of MomentStep
    """

    power: float
    steps: tuple[MomentStep, ...]


def moment_proof(law: ReducedLaw, opening: Array, tolerance: float, *, work: Work) -> MomentProof:
    """Bound the power of all motions until it is below a tolerance, or nothing helps.

    Parameters
    ----------
    law : ReducedLaw
    opening : ndarray, shape (n,)
        A motion that bounds the forces (`kilter.friction.force_bound.opening_motion`).
    tolerance : float
        Power that counts as none.
    work : Work
    """
    forces, left = force_bound(law, opening), 1.0
    steps: list[MomentStep] = []
    # pairs of three bodies and more leave too much
    rung, scale = int(bodies_of(law) > 2), 1.0
    if not np.isfinite(forces) or width_of(law) > MOST_FORMS:
        return MomentProof(left, ())
    for _ in range(STEPS):
        if left <= tolerance or rung == len(SQUARES) or work.over:
            break
        step = _step(law, scale, SQUARES[rung], work)
        power = scale**2 if step is None else power_left(law, step, forces)
        if step is not None and power < left:
            steps, left = [*steps, step], power
        work.tell(f"motions with more than {left:.1e} of the power of free fall are excluded")
        if power > HOPEFUL * scale**2:
            rung = len(SQUARES) if left < NEARLY else rung + 1
        scale = max(float(np.sqrt(left)), SMALLEST * scale)
    return MomentProof(left, tuple(steps))


def _step(law: ReducedLaw, scale: float, squares: Squares, work: Work) -> MomentStep | None:
    """One semidefinite program; None where it cannot be paid, or its solver breaks down."""
    forms = moment_forms(law, scale)
    if _entries_of(forms, squares) > MOST_ENTRIES:
        return None
    program = moment_program(forms, squares)
    if DEAR[squares] * SEMIDEFINITE_ENTRY * USUAL_STEPS * program.entries > work.left:
        return None
    multipliers = solve_semidefinite(program, work=work)
    return None if multipliers is None else MomentStep(scale, squares, multipliers)


def _entries_of(forms: MomentForms, squares: Squares) -> int:
    """Entries of the matrices of products, before they are formed, at most."""
    length = np.diff(forms.rows.indptr)
    return sum(int(length[one].sum()) ** 2 for one in squares_of(forms, squares)) // 2


def moment_program(forms: MomentForms, squares: Squares) -> SemidefiniteProgram:
    """The relaxation over the monomials of the forms."""
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
        tuple(over_monomials(forms, _triangle(v), place) for v in squares_of(forms, squares)),
    )


def _triangle(forms: Index) -> ProductRows:
    """The upper triangle of the products of some forms, column by column."""
    column, row = np.tril_indices(len(forms))
    weight = np.where(row == column, 1.0, np.sqrt(2.0))
    return ProductRows(len(row), np.arange(len(row)), forms[row], forms[column], weight)
