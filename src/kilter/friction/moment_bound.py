"""A bound of the power of all motions, recomputed from multipliers: no solver is believed.

Given multipliers of the products of the law (`kilter.friction.moment_products`), not negative
where the products are not, and matrices Y >= 0 for forms v, the power w.b is

    w.b = P - (sum of multipliers times products) - (sum of v.Y v) + z.R z  <=  P + |z.R z|

for every motion of size |a| <= e that obeys the law. P is what is left at 1, and R whatever the
multipliers do not account for: rounding, and that an interior point ends before its optimum. R
is computed, and bounded by what z can be: |b| <= 1, s <= |Jt| |b|, and the sum of all fn below
the bound of `kilter.friction.force_bound`, which also bounds |ft| <= mu N. Where power and size
are bounded anew, e falls, until nothing is left.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.sparse import csr_array

from kilter.arrays import Array, Index
from kilter.friction.moment_forms import MomentForms, moment_forms
from kilter.friction.moment_products import law_products, monomials
from kilter.friction.reduced_law import ReducedLaw
from kilter.solvers.semidefinite import Multipliers

__all__ = ["SQUARES", "MomentStep", "Squares", "power_left", "squares_of"]

Squares = Literal["pairs", "pushes", "cliques"]
"""Which matrices of products are held positive: of the motions of the bodies of a patch; of
the motion of a body and the pushes on it as well; of all that is thought of."""
SQUARES: tuple[Squares, ...] = ("pairs", "pushes", "cliques")
"""The cheapest first."""
ROUNDING = 1e-13
"""Rounding of the sums of R, over the sums of their terms' sizes: a few hundred of 1e-16."""


@dataclass(frozen=True, slots=True, eq=False)
class MomentStep:
    """Multipliers that bound the power of all motions of size at most `scale`."""

    scale: float
    squares: Squares
    multipliers: Multipliers


def squares_of(forms: MomentForms, squares: Squares) -> list[Index]:
    """The forms of each matrix of products that is held positive."""
    if squares == "cliques":
        return forms.cliques()
    found = [forms.pair_of(patch) for patch in range(len(forms.touching))]
    if squares == "pushes":
        found += [forms.pushes_on(body) for body in range(len(forms.bodies))]
    return list({tuple(one.tolist()): one for one in found}.values())


def power_left(law: ReducedLaw, step: MomentStep, forces: float) -> float:
    """The greatest power w.a, over |w|^2, that a step leaves to motions of its size.

    Parameters
    ----------
    law : ReducedLaw
    step : MomentStep
    forces : float
        The sum of all normal forces is at most this.

    Returns
    -------
    float
        At most scale^2, which is known anyway; just that where the multipliers do not fit.
    """
    known = step.scale**2
    forms = moment_forms(law, step.scale)
    rest = _unaccounted(forms, step)
    if rest is None or not np.isfinite(forces):
        return known
    values, rounding = rest
    power = float(rounding[0, 0] - values[0, 0]) + _largest(forms, values, rounding, forces)
    return min(step.scale * max(power, 0.0), known) if np.isfinite(power) else known


def _unaccounted(forms: MomentForms, step: MomentStep) -> tuple[Array, Array] | None:
    """R, less P at 1, and its rounding; None where the multipliers do not fit.

    It is minus w.b and all products with their multipliers.
    """
    given, place = step.multipliers, monomials(forms)
    rows = law_products(forms, place)
    squares = squares_of(forms, step.squares)
    fits = (
        given.equal.shape == (rows.equal.count,)
        and given.positive.shape == (rows.positive.count,)
        and given.cones.shape == (rows.cones.count,)
        and [one.shape for one in given.squares] == [(len(v), len(v)) for v in squares]
    )
    if not fits or not all(np.isfinite(one).all() for one in (
        given.equal, given.positive, given.cones, *given.squares)):  # fmt: skip
        return None
    size = forms.rows.shape[0]
    # a multiplier that is negative by rounding is no multiplier; the rest pays for it
    cones = given.cones.reshape(-1, 1 + forms.law.directions).copy()
    cones[:, 0] = np.maximum(cones[:, 0], np.linalg.norm(cones[:, 1:], axis=1) * (1 + ROUNDING))
    parts = [
        rows.positive.weighted(np.maximum(given.positive, 0.0), size),
        rows.cones.weighted(cones.ravel(), size),
        rows.equal.weighted(-given.equal, size),
    ]
    for forms_of, matrix in zip(squares, given.squares, strict=True):
        places = (np.repeat(forms_of, len(forms_of)), np.tile(forms_of, len(forms_of)))
        parts.append(csr_array((_positive(matrix).ravel(), places), shape=(size, size)))
    left, over = forms.rows, abs(forms.rows)
    total = sum((left.T @ one @ left).toarray() for one in parts)
    sizes = sum((over.T @ abs(one) @ over).toarray() for one in parts)
    total[0, forms.motion] += forms.law.load
    rest: Array = -(total + total.T) / 2
    rounding: Array = ROUNDING * (sizes + sizes.T + 1.0)
    return rest, rounding


def _positive(matrix: Array) -> Array:
    """A positive semidefinite matrix near a symmetric one: M M^T, so that it is one exactly."""
    values, vectors = np.linalg.eigh((matrix + matrix.T) / 2)
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    nearest: Array = root @ root.T
    return nearest


def _largest(forms: MomentForms, rest: Array, rounding: Array, forces: float) -> float:
    """The largest |z.R z| of a motion that obeys the law, but for R at 1 alone."""
    law, size = forms.law, np.abs(rest) + rounding
    moves = np.concatenate([forms.motion, forms.slip])
    fastest = float(np.sqrt(1.0 + np.linalg.norm(law.tangent.toarray(), 2) ** 2))  # of |(b, s)|
    pushes = np.concatenate([forms.fn, forms.ft.ravel()])
    shares = _shares(forms)
    motions = float(np.linalg.norm(rest[np.ix_(moves, moves)], 2))
    motions += float(np.linalg.norm(rounding[np.ix_(moves, moves)]))
    between = shares.T @ size[np.ix_(pushes, pushes)] @ shares
    mixed = shares.T @ np.linalg.norm(size[np.ix_(pushes, moves)], axis=1)
    alone = shares.T @ size[pushes, 0]
    parts = (
        2.0 * float(np.linalg.norm(size[0, moves])) * fastest,
        motions * fastest**2,
        2.0 * float(alone.max(initial=0.0)) * forces,
        float(between.max(initial=0.0)) * forces**2,
        2.0 * float(mixed.max(initial=0.0)) * forces * fastest,
    )
    return sum(parts) * (1.0 + ROUNDING)


def _shares(forms: MomentForms) -> Array:
    """Of each force, what of each normal force bounds its size, shape (K + G T, K).

    |fn_k| <= fn_k and |ft_g| <= mu (sum of fn_k of the group).
    """
    law, points = forms.law, len(forms.law.group)
    member = (law.group[None] == np.arange(len(law.mu))[:, None]) * law.mu[:, None]
    shares: Array = np.vstack([np.eye(points), np.repeat(member, law.directions, axis=0)])
    return shares
