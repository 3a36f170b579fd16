"""Products of linear forms that Coulomb's law makes zero, nonnegative or elements of a cone.

Every motion that obeys the law (`kilter.friction.reduced_law`, forms in
`kilter.friction.moment_forms`) satisfies, with m = mu N:

    fn un = 0,   un ft = 0 if the group is a single point,   ft.ut + m s = 0,   s ft + m ut = 0
    s s = |ut|^2,   ft x ut = 0,   d z = 0 for every coordinate z
    m m >= |ft|^2,   |b|^2 <= 1
    r r' >= 0,   r (m, ft) and r (s, ut) in the cone t >= |v|,     r any of 1, fn, un and s

since a product of two nonnegative numbers is nonnegative, and an element of a cone stays in it when
multiplied by a nonnegative number. A *row* is a sum of weighted products. It depends on z only
through z z^T, so it is linear in the monomials z_i z_j.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.sparse import csr_array

from kilter.arrays import Array, Index
from kilter.friction.moment_forms import MomentForms


@dataclass(frozen=True, slots=True, eq=False)
class ProductRows:
    """Sums of products of forms: each term adds weight x form x form to its row."""

    count: int
    """Number of rows."""
    row: Index
    left: Index
    right: Index
    """Row of each term, and its two forms."""
    weight: Array
    """Weight of each term."""

    def weighted(self, multipliers: Array, size: int) -> csr_array:
        """Matrix V such that form.V form is the sum of the rows times their multipliers.

        `size` is the number of forms.
        """
        places = (self.left, self.right)
        return csr_array((self.weight * multipliers[self.row], places), shape=(size, size))


@dataclass(frozen=True, slots=True, eq=False)
class Products:
    """Sums of products that the contact law makes zero, nonnegative, or vectors of a cone."""

    equal: ProductRows
    positive: ProductRows
    cones: ProductRows


class _RowBuilder:
    """Builder of product rows; rows are added in groups that are kept or dropped as a whole."""

    def __init__(self, wide: int = 1) -> None:
        self._wide = wide
        self._parts: list[tuple[Index, Index, Index, Array]] = []
        self._count = 0

    def add(self, left: ArrayLike, right: ArrayLike, weight: ArrayLike = 1.0) -> None:
        """Add rows of products; the arguments are broadcast to the shape (rows, terms)."""
        left, right, weight = np.broadcast_arrays(left, right, weight)
        row = np.repeat(self._count + np.arange(len(left)), left.shape[1])
        self._parts.append((row, left.ravel(), right.ravel(), weight.ravel().astype(float)))
        self._count += len(left)

    def within(self, forms: MomentForms, place: Index) -> ProductRows:
        """All rows so far, except groups with a monomial that `place` marks as unused (-1)."""
        row, left, right, weight = (
            np.concatenate(parts) for parts in zip(*self._parts, strict=True)
        )
        term, columns, _ = _entries(forms, left, right, place)
        missing = np.zeros(self._count, dtype=bool)
        missing[row[term[columns < 0]]] = True
        missing = np.repeat(missing.reshape(-1, self._wide).any(axis=1), self._wide)
        kept, number = ~missing[row], np.cumsum(~missing) - 1
        return ProductRows(
            int((~missing).sum()), number[row[kept]], left[kept], right[kept], weight[kept]
        )


def monomials(forms: MomentForms) -> Index:
    """Number of each used monomial z_i z_j, as a symmetric matrix; -1 for unused monomials."""
    place = np.full((forms.width, forms.width), -1, dtype=np.int64)
    for clique in forms.cliques():
        place[np.ix_(clique, clique)] = 0
    upper = np.triu(place == 0)
    place[upper] = np.arange(int(upper.sum()))
    return np.maximum(place, place.T)


def over_monomials(forms: MomentForms, rows: ProductRows, place: Index) -> csr_array:
    """Matrix from the monomials z_i z_j to the product rows."""
    term, columns, values = _entries(forms, rows.left, rows.right, place)
    values = values * rows.weight[term]
    shape = (rows.count, int(place.max(initial=-1)) + 1)
    return csr_array((values, (rows.row[term], columns)), shape=shape)


def _entries(
    forms: MomentForms, left: Index, right: Index, place: Index
) -> tuple[Index, Index, Array]:
    """Term, monomial and value of each entry when products of forms are expanded in monomials."""
    rows = forms.rows
    length = np.diff(rows.indptr)
    second_length = length[right]
    count = length[left] * second_length
    term = np.repeat(np.arange(len(left)), count)
    offset = np.arange(int(count.sum())) - np.repeat(np.cumsum(count) - count, count)
    first_entry = rows.indptr[left[term]] + offset // second_length[term]
    second_entry = rows.indptr[right[term]] + offset % second_length[term]
    columns = place[rows.indices[first_entry], rows.indices[second_entry]]
    return term, columns, rows.data[first_entry] * rows.data[second_entry]


def law_products(forms: MomentForms, place: Index) -> Products:
    """All products that the contact law determines and that use only monomials in `place`."""
    return Products(
        _zero_rows(forms).within(forms, place),
        _nonnegative_rows(forms).within(forms, place),
        _cone_rows(forms).within(forms, place),
    )


def _zero_rows(forms: MomentForms) -> _RowBuilder:
    """Products of forms, or sums of products, that the contact law makes zero."""
    law, rows = forms.law, _RowBuilder()
    ft, ut, total, slip = forms.ft, forms.ut, forms.total[:, None], forms.slip[:, None]
    rows.add(forms.fn[:, None], forms.un[:, None])
    single = _single_points(forms)
    for k in range(law.directions):
        rows.add(ft[law.group[single], k][:, None], forms.un[single][:, None])
        rows.add(np.hstack([slip, total]), np.column_stack([ft[:, k], ut[:, k]]))
    rows.add(np.hstack([ft, total]), np.hstack([ut, slip]))
    signs = np.concatenate([[1.0], -np.ones(law.directions)])
    rows.add(np.hstack([slip, ut]), np.hstack([slip, ut]), signs)
    if law.directions == 2:
        rows.add(ft, ut[:, ::-1], [1.0, -1.0])
    rows.add(np.repeat(forms.zero, forms.width)[:, None],
             np.tile(np.arange(forms.width), len(forms.zero))[:, None])  # fmt: skip
    return rows


def _nonnegative_rows(forms: MomentForms) -> _RowBuilder:
    """Products of forms that the contact law makes nonnegative."""
    rows, constant, count = _RowBuilder(), forms.one, len(forms.motion)
    total, ft = forms.total[:, None], forms.ft
    signs = np.concatenate([[1.0], -np.ones(forms.law.directions)])
    rows.add(np.hstack([total, ft]), np.hstack([total, ft]), signs)
    ball = np.concatenate([[constant], forms.motion])[None]
    rows.add(ball, ball, np.concatenate([[1.0], -np.ones(count)]))
    rays = np.concatenate([forms.fn, forms.un])
    rows.add(np.full((len(rays), 1), constant), rays[:, None])
    first, second = np.triu_indices(len(rays))
    nonzero = first + len(forms.fn) != second  # fn un is 0
    rows.add(rays[first[nonzero]][:, None], rays[second[nonzero]][:, None])
    return rows


def _cone_rows(forms: MomentForms) -> _RowBuilder:
    """Vectors that lie in friction and sliding cones, multiplied by nonnegative forms."""
    law, rows = forms.law, _RowBuilder(1 + forms.law.directions)
    force_cone = np.column_stack([forms.total, forms.ft])
    speed_cone = np.column_stack([forms.slip, forms.ut])
    single_group = np.full(len(law.group), -1)
    single_group[_single_points(forms)] = law.group[_single_points(forms)]
    groups = np.arange(len(law.mu))
    no_group = np.full(1, -1)
    for cone, excluded_groups in (
        (
            force_cone,
            [no_group, np.full(len(forms.fn), -1), single_group, np.full(len(groups), -1)],
        ),
        (speed_cone, [no_group, np.full(len(forms.fn), -1), np.full(len(forms.un), -1), groups]),
    ):
        rays = np.concatenate([[forms.one], forms.fn, forms.un, forms.slip])
        excluded = np.concatenate(
            excluded_groups
        )  # the cone with which a ray forms an equation among the zero rows
        ray, group = (grid.ravel() for grid in np.meshgrid(
            np.arange(len(rays)), groups, indexing="ij"))  # fmt: skip
        kept = excluded[ray] != group
        ray, group = ray[kept], group[kept]
        rows.add(np.repeat(rays[ray], cone.shape[1])[:, None], cone[group].ravel()[:, None])
    return rows


def _single_points(forms: MomentForms) -> Index:
    """Indices of the points with friction whose sliding velocity no other point shares."""
    group = forms.law.group
    members = np.append(np.bincount(group[group >= 0], minlength=len(forms.law.mu)), 0)
    single: Index = np.flatnonzero(members[group] == 1)
    return single
