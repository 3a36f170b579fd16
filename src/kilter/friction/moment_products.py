"""Products of linear forms that the contact law makes 0, not negative, or one of a cone.

Every motion that obeys the law (`kilter.friction.reduced_law`, forms in `kilter.friction.
moment_forms`) satisfies, with m = mu N:

    fn un = 0,   un ft = 0 where a group is one point,   ft.ut + m s = 0,   s ft + m ut = 0
    s s = |ut|^2,   ft x ut = 0,   d z = 0 for every coordinate z
    m m >= |ft|^2,   |b|^2 <= 1
    r r' >= 0,   r (m, ft) and r (s, ut) in the cone t >= |v|,     r any of 1, fn, un and s

since a product of two numbers that are not negative is none, and a cone is one still when its
vector is multiplied by such a number. A *row* is a sum of weighted products; z enters by z z^T
alone, so that each row is linear in the monomials z_i z_j.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.sparse import csr_array

from kilter.arrays import Array, Index
from kilter.friction.moment_forms import MomentForms

__all__ = ["ProductRows", "Products", "law_products", "monomials", "over_monomials"]


@dataclass(frozen=True, slots=True, eq=False)
class ProductRows:
    """Rows of products: term t adds weight[t] form[left[t]] form[right[t]] to row[t].

    Attributes
    ----------
    count : int
        Rows.
    row, left, right : ndarray of int
    weight : ndarray
    """

    count: int
    row: Index
    left: Index
    right: Index
    weight: Array

    def weighted(self, multipliers: Array, size: int) -> csr_array:
        """The matrix V, of so many forms, for which form.V form is the sum of weighted rows."""
        places = (self.left, self.right)
        return csr_array((self.weight * multipliers[self.row], places), shape=(size, size))


@dataclass(frozen=True, slots=True, eq=False)
class Products:
    """The rows of a law: those that are 0, not negative, and in turn of cones (t, v)."""

    equal: ProductRows
    positive: ProductRows
    cones: ProductRows


class _Rows:
    """Rows as they are added, `wide` at a time."""

    def __init__(self, wide: int = 1) -> None:
        self._wide = wide
        self._parts: list[tuple[Index, Index, Index, Array]] = []
        self._count = 0

    def add(self, left: ArrayLike, right: ArrayLike, weight: ArrayLike = 1.0) -> None:
        """One row a line of terms; shapes (rows, terms), broadcast."""
        left, right, weight = np.broadcast_arrays(left, right, weight)
        row = np.repeat(self._count + np.arange(len(left)), left.shape[1])
        self._parts.append((row, left.ravel(), right.ravel(), weight.ravel().astype(float)))
        self._count += len(left)

    def within(self, forms: MomentForms, place: Index) -> ProductRows:
        """The rows whose products have monomials that are thought of."""
        row, left, right, weight = (
            np.concatenate(parts) for parts in zip(*self._parts, strict=True)
        )
        term, columns, _ = _entries(forms, left, right, place)
        missing = np.zeros(self._count, dtype=bool)
        missing[row[term[columns < 0]]] = True
        missing = np.repeat(missing.reshape(-1, self._wide).any(axis=1), self._wide)
        keep, number = ~missing[row], np.cumsum(~missing) - 1
        return ProductRows(
            int((~missing).sum()), number[row[keep]], left[keep], right[keep], weight[keep]
        )


def monomials(forms: MomentForms) -> Index:
    """The number of each monomial z_i z_j of the cliques, symmetric; -1 of others."""
    place = np.full((forms.width, forms.width), -1, dtype=np.int64)
    for clique in forms.cliques():
        place[np.ix_(clique, clique)] = 0
    upper = np.triu(place == 0)
    place[upper] = np.arange(int(upper.sum()))
    return np.maximum(place, place.T)


def over_monomials(forms: MomentForms, rows: ProductRows, place: Index) -> csr_array:
    """The rows as linear functions of the monomials."""
    term, columns, values = _entries(forms, rows.left, rows.right, place)
    values = values * rows.weight[term]
    shape = (rows.count, int(place.max(initial=-1)) + 1)
    return csr_array((values, (rows.row[term], columns)), shape=shape)


def _entries(
    forms: MomentForms, left: Index, right: Index, place: Index
) -> tuple[Index, Index, Array]:
    """Of products of forms: the term, the monomial and the value of each entry."""
    rows = forms.rows
    length = np.diff(rows.indptr)
    second = length[right]
    count = length[left] * second
    term = np.repeat(np.arange(len(left)), count)
    within = np.arange(int(count.sum())) - np.repeat(np.cumsum(count) - count, count)
    one = rows.indptr[left[term]] + within // second[term]
    other = rows.indptr[right[term]] + within % second[term]
    columns = place[rows.indices[one], rows.indices[other]]
    return term, columns, rows.data[one] * rows.data[other]


def law_products(forms: MomentForms, place: Index) -> Products:
    """All rows of a law whose monomials are thought of."""
    return Products(
        _zeros(forms).within(forms, place),
        _signs(forms).within(forms, place),
        _cones(forms).within(forms, place),
    )


def _zeros(forms: MomentForms) -> _Rows:
    """Products that are 0, or sums of products."""
    law, rows = forms.law, _Rows()
    ft, ut, total, slip = forms.ft, forms.ut, forms.total[:, None], forms.slip[:, None]
    rows.add(forms.fn[:, None], forms.un[:, None])
    alone = _alone(forms)
    for k in range(law.directions):
        rows.add(ft[law.group[alone], k][:, None], forms.un[alone][:, None])
        rows.add(np.hstack([slip, total]), np.column_stack([ft[:, k], ut[:, k]]))
    rows.add(np.hstack([ft, total]), np.hstack([ut, slip]))
    minus = np.concatenate([[1.0], -np.ones(law.directions)])
    rows.add(np.hstack([slip, ut]), np.hstack([slip, ut]), minus)
    if law.directions == 2:
        rows.add(ft, ut[:, ::-1], [1.0, -1.0])
    rows.add(np.repeat(forms.zero, forms.width)[:, None],
             np.tile(np.arange(forms.width), len(forms.zero))[:, None])  # fmt: skip
    return rows


def _signs(forms: MomentForms) -> _Rows:
    """Products that are not negative."""
    rows, one, count = _Rows(), forms.one, len(forms.motion)
    total, ft = forms.total[:, None], forms.ft
    minus = np.concatenate([[1.0], -np.ones(forms.law.directions)])
    rows.add(np.hstack([total, ft]), np.hstack([total, ft]), minus)
    ball = np.concatenate([[one], forms.motion])[None]
    rows.add(ball, ball, np.concatenate([[1.0], -np.ones(count)]))
    rays = np.concatenate([forms.fn, forms.un])
    rows.add(np.full((len(rays), 1), one), rays[:, None])
    first, second = np.triu_indices(len(rays))
    other = first + len(forms.fn) != second  # fn un is 0
    rows.add(rays[first[other]][:, None], rays[second[other]][:, None])
    return rows


def _cones(forms: MomentForms) -> _Rows:
    """Vectors of cones, multiplied by what is not negative."""
    law, rows = forms.law, _Rows(1 + forms.law.directions)
    push = np.column_stack([forms.total, forms.ft])
    slide = np.column_stack([forms.slip, forms.ut])
    alone = np.full(len(law.group), -1)
    alone[_alone(forms)] = law.group[_alone(forms)]
    groups = np.arange(len(law.mu))
    none = np.full(1, -1)
    for cone, left_out in (
        (push, [none, np.full(len(forms.fn), -1), alone, np.full(len(groups), -1)]),
        (slide, [none, np.full(len(forms.fn), -1), np.full(len(forms.un), -1), groups]),
    ):
        rays = np.concatenate([[forms.one], forms.fn, forms.un, forms.slip])
        own = np.concatenate(left_out)  # the cone with which a ray makes an equation above
        ray, group = (one.ravel() for one in np.meshgrid(
            np.arange(len(rays)), groups, indexing="ij"))  # fmt: skip
        kept = own[ray] != group
        ray, group = ray[kept], group[kept]
        rows.add(np.repeat(rays[ray], cone.shape[1])[:, None], cone[group].ravel()[:, None])
    return rows


def _alone(forms: MomentForms) -> Index:
    """Points that are the only one of their group."""
    group = forms.law.group
    members = np.append(np.bincount(group[group >= 0], minlength=len(forms.law.mu)), 0)
    found: Index = np.flatnonzero(members[group] == 1)
    return found
