"""Upper bound of the power of all motions, recomputed from multipliers, without a solver.

Given multipliers of the products of the law (`kilter.friction.moment_products`), nonnegative for
nonnegative products, and matrices Y >= 0 for forms v, the power w.b is

    w.b = P - (sum of multipliers times products) - (sum of v.Y v) + z.R z  <=  P + |z.R z|

for every motion of size |a| <= e that obeys the law. P is the constant term, and R the part that
the multipliers do not cancel, because of rounding and because an interior point ends before its
optimum. R is computed, and z.R z is bounded by the possible values of z: |b| <= 1, s <= |Jt| |b|,
and the sum of all fn below the bound of `kilter.friction.reduced_law`, which also bounds |ft| <= mu
N. When power and size are bounded more tightly, e decreases, until no power is left.
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
"""Sets of product matrices that are constrained to be positive semidefinite: those of the motions
of the bodies of a patch; also those of the motion of a body and the pushes on it; those of all
cliques.
"""
SQUARES: tuple[Squares, ...] = ("pairs", "pushes", "cliques")
"""The sets, the cheapest first."""
ROUNDING = 1e-13
"""Rounding of the sums of R, over the sums of the absolute values of their terms: a few hundred
times 1e-16.
"""


@dataclass(frozen=True, slots=True, eq=False)
class MomentStep:
    """Multipliers that prove a bound of the power of all motions of size at most `scale`."""

    scale: float
    squares: Squares
    multipliers: Multipliers


def squares_of(forms: MomentForms, squares: Squares) -> list[Index]:
    """For each matrix of products that must be positive semidefinite, its linear forms."""
    if squares == "cliques":
        return forms.cliques()
    forms_of_squares = [forms.pair_of(patch) for patch in range(len(forms.touching))]
    if squares == "pushes":
        forms_of_squares += [forms.pushes_on(body) for body in range(len(forms.bodies))]
    return list({tuple(square.tolist()): square for square in forms_of_squares}.values())


def power_left(law: ReducedLaw, step: MomentStep, forces: float) -> float:
    """Largest scaled power of the load that the multipliers of a step do not exclude.

    Returns at most scale^2, which is known a priori; equal to it if the multipliers do not fit.
    """
    a_priori = step.scale**2
    forms = moment_forms(law, step.scale)
    remainder = _remainder(forms, step)
    if remainder is None or not np.isfinite(forces):
        return a_priori
    values, rounding = remainder
    power = float(rounding[0, 0] - values[0, 0]) + _largest_remainder(
        forms, values, rounding, forces
    )
    return min(step.scale * max(power, 0.0), a_priori) if np.isfinite(power) else a_priori


def _remainder(forms: MomentForms, step: MomentStep) -> tuple[Array, Array] | None:
    """Error matrix R of the identity that the multipliers prove, and its rounding; or None.

    R is minus w.b minus all products with their multipliers.
    """
    given, place = step.multipliers, monomials(forms)
    rows = law_products(forms, place)
    squares = squares_of(forms, step.squares)
    fits = (
        given.equal.shape == (rows.equal.count,)
        and given.positive.shape == (rows.positive.count,)
        and given.cones.shape == (rows.cones.count,)
        and [square.shape for square in given.squares] == [(len(v), len(v)) for v in squares]
    )
    if not fits or not all(np.isfinite(values).all() for values in (
        given.equal, given.positive, given.cones, *given.squares)):  # fmt: skip
        return None
    size = forms.rows.shape[0]
    # negative multipliers, by rounding, are set to 0; the remainder grows by the difference
    cones = given.cones.reshape(-1, 1 + forms.law.directions).copy()
    cones[:, 0] = np.maximum(cones[:, 0], np.linalg.norm(cones[:, 1:], axis=1) * (1 + ROUNDING))
    parts = [
        rows.positive.weighted(np.maximum(given.positive, 0.0), size),
        rows.cones.weighted(cones.ravel(), size),
        rows.equal.weighted(-given.equal, size),
    ]
    for forms_of, matrix in zip(squares, given.squares, strict=True):
        places = (np.repeat(forms_of, len(forms_of)), np.tile(forms_of, len(forms_of)))
        parts.append(csr_array((_nearest_positive(matrix).ravel(), places), shape=(size, size)))
    left, over = forms.rows, abs(forms.rows)
    total = sum((left.T @ part @ left).toarray() for part in parts)
    sizes = sum((over.T @ abs(part) @ over).toarray() for part in parts)
    total[0, forms.motion] += forms.law.load
    rest: Array = -(total + total.T) / 2
    rounding: Array = ROUNDING * (sizes + sizes.T + 1.0)
    # multipliers near the largest number overflow in the products
    return (rest, rounding) if np.isfinite(rest).all() and np.isfinite(rounding).all() else None


def _nearest_positive(matrix: Array) -> Array:
    """A positive semidefinite matrix M M^T near a symmetric matrix."""
    values, vectors = np.linalg.eigh((matrix + matrix.T) / 2)
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    nearest: Array = root @ root.T
    return nearest


def _largest_remainder(forms: MomentForms, rest: Array, rounding: Array, forces: float) -> float:
    """Upper bound of the error |z.R z| over all motions z that obey the contact law."""
    law, size = forms.law, np.abs(rest) + rounding
    moves = np.concatenate([forms.motion, forms.slip])
    fastest = float(np.sqrt(1.0 + np.linalg.norm(law.tangent.toarray(), 2) ** 2))  # of |(b, s)|
    pushes = np.concatenate([forms.fn, forms.ft.ravel()])
    shares = _force_shares(forms)
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


def _force_shares(forms: MomentForms) -> Array:
    """For each force component, the weights of normal forces that bound it, (K + G T, K).

    |fn_k| <= fn_k and |ft_g| <= mu (sum of fn_k of the group).
    """
    law, points = forms.law, len(forms.law.group)
    member = (law.group[None] == np.arange(len(law.mu))[:, None]) * law.mu[:, None]
    shares: Array = np.vstack([np.eye(points), np.repeat(member, law.directions, axis=0)])
    return shares
