"""Array types and operations on rows of arrays, used by all packages; no physics.

    across:  u = e x n / |e x n|,   v = n x u,   e = the axis on which |n| is least
    ragged:  rows start[w] ... start[w + 1] - 1 of each w, one after the other

Row k of every field of a `Rows` describes the same item: a contact, a pair, a facet.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import field, fields, is_dataclass
from functools import reduce
from typing import Any, Self, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
Index = NDArray[np.int64]
Mask = NDArray[np.bool_]
Labels = NDArray[np.str_]

TINY = 1e-300
"""Smaller than every size that is accepted as input; avoids division by zero [any unit]."""


def cross(a: Array, b: Array) -> Array:
    """Cross products of rows, shape (..., 3); several times faster than `numpy.cross`.

    Examples
    --------
    >>> cross(np.array([[1.0, 0, 0]]), np.array([[0, 1.0, 0]]))
    array([[0., 0., 1.]])
    """
    a0, a1, a2 = a[..., 0], a[..., 1], a[..., 2]
    b0, b1, b2 = b[..., 0], b[..., 1], b[..., 2]
    result = np.empty(np.broadcast_shapes(a.shape, b.shape))
    result[..., 0] = a1 * b2 - a2 * b1
    result[..., 1] = a2 * b0 - a0 * b2
    result[..., 2] = a0 * b1 - a1 * b0
    return result


def squares(rows: Array) -> Array:
    """Squared length of each row, shape (..., 3); faster than a sum along the short axis.

    Examples
    --------
    >>> squares(np.array([[1.0, 2.0, 2.0]]))
    array([9.])
    """
    x, y, z = rows[..., 0], rows[..., 1], rows[..., 2]
    result: Array = x * x + y * y + z * z
    return result


def lengths(rows: Array) -> Array:
    """Length of each row, shape (..., 3); equal to `numpy.linalg.norm`, but many times faster.

    Examples
    --------
    >>> lengths(np.array([[1.0, 2.0, 2.0]]))
    array([3.])
    """
    result: Array = np.sqrt(squares(rows))
    return result


def extents(groups: Array) -> tuple[Array, Array]:
    """Least and greatest entries along the second axis, which is short, shape (n, ...) each.

    Comparisons of whole columns are several times faster than those along a short axis.

    Examples
    --------
    >>> extents(np.array([[[0.0, 5], [2, 3], [1, 9]]]))
    (array([[0., 3.]]), array([[2., 9.]]))
    """
    columns = [groups[:, k] for k in range(groups.shape[1])]
    return reduce(np.minimum, columns), reduce(np.maximum, columns)


def largest_entries(rows: Array) -> Array:
    """Largest absolute value of each row, shape (n, 3); faster than a maximum along the short axis.

    Examples
    --------
    >>> largest_entries(np.array([[1.0, -3.0, 2.0]]))
    array([3.])
    """
    x, y, z = np.abs(rows).T
    result: Array = np.maximum(np.maximum(x, y), z)
    return result


def angle_between(a: Array, b: Array) -> Array:
    """Angles between rows of vectors, shape (..., 3), of any length [rad].

    The arc tangent of both products is accurate for small angles, unlike the arc cosine.

    Examples
    --------
    >>> angle_between(np.array([[1.0, 0, 0]]), np.array([[2.0, 2e-9, 0]]))
    array([1.e-09])
    """
    sine = np.linalg.norm(cross(a, b), axis=-1)
    angle: Array = np.arctan2(sine, np.einsum("...i,...i->...", a, b))
    return angle


def ratio(a: ArrayLike, b: ArrayLike) -> Array:
    """Quotient ``a / b`` for b >= 0; finite if b is 0.

    Examples
    --------
    >>> ratio([0.0, 1.0], [0.0, 2.0])
    array([0. , 0.5])
    """
    result: Array = np.asarray(a, dtype=np.float64) / np.maximum(b, TINY)
    return result


def unit_rows(v: Array) -> Array:
    """Normalise vectors, shape (..., m), to length 1; a zero vector stays zero.

    Examples
    --------
    >>> unit_rows(np.array([[0.0, 0.0, 2.0], [0.0, 0.0, 0.0]]))
    array([[0., 0., 1.],
           [0., 0., 0.]])
    """
    length = lengths(v) if v.shape[-1] == 3 else np.linalg.norm(v, axis=-1)
    return ratio(v, length[..., None])


def across(n: Array) -> tuple[Array, Array]:
    """Two unit vectors u, v perpendicular to unit vectors n, each of shape (..., 3).

    (u, v, n) is right-handed: u x v = n.

    Examples
    --------
    >>> u, v = across(np.array([0.0, 0.0, 1.0]))
    >>> (u + 0.0).tolist(), (v + 0.0).tolist()
    ([0.0, -1.0, 0.0], [1.0, 0.0, 0.0])
    """
    if n.ndim == 1:  # plain numbers: ten times faster than arrays for a single vector
        return _across_one(*n.tolist())
    u = unit_rows(cross(np.eye(3)[np.abs(n).argmin(axis=-1)], n))
    return u, cross(n, u)


def _across_one(x: float, y: float, z: float) -> tuple[Array, Array]:
    """Result of `across` for the single vector (x, y, z)."""
    size = abs(x), abs(y), abs(z)
    least = size.index(min(size))
    u = [(0.0, -z, y), (z, 0.0, -x), (-y, x, 0.0)][least]
    length = max(math.hypot(*u), TINY)
    p, q, r = (value / length for value in u)
    return np.array([p, q, r]), np.array([y * r - z * q, z * p - x * r, x * q - y * p])


def starts(count: ArrayLike) -> Index:
    """Index of the first row of each group, for groups of `count` rows; then the total number.

    Examples
    --------
    >>> starts([2, 0, 1])
    array([0, 2, 2, 3])
    """
    count = np.asarray(count, dtype=np.int64)
    result = np.zeros(len(count) + 1, dtype=np.int64)
    np.cumsum(count, out=result[1:])
    return result


def counted(count: ArrayLike) -> tuple[Index, Index]:
    """For each row, its group and its position in that group; group k has ``count[k]`` rows.

    Examples
    --------
    >>> counted([2, 0, 1])
    (array([0, 0, 2]), array([0, 1, 0]))
    """
    count = np.asarray(count, dtype=np.int64)
    owner: Index = np.repeat(np.arange(len(count)), count)
    return owner, np.arange(len(owner)) - np.repeat(np.cumsum(count) - count, count)


def group_sums(group: Index, values: Array, count: int) -> Array:
    """Sums of the rows of `values`, shape (n, ...), by group, shape (count, ...).

    Arguments: `group` (n,): group of each row, less than `count`; `values` (n, ...).

    Examples
    --------
    >>> group_sums(np.array([1, 0, 1]), np.array([[1.0], [2.0], [4.0]]), 3).tolist()
    [[2.0], [5.0], [0.0]]
    """
    flat = values.reshape(len(group), math.prod(values.shape[1:]))
    sums = np.stack([np.bincount(group, column, minlength=count) for column in flat.T], axis=1)
    return sums.reshape(count, *values.shape[1:]).astype(np.float64)


def ragged(start: Index, which: Index) -> tuple[Index, Index]:
    """Rows of the chosen groups: for each row its position in `which`, and its row number.

    Examples
    --------
    >>> ragged(np.array([0, 2, 3]), np.array([1, 0]))
    (array([0, 1, 1]), array([2, 0, 1]))
    """
    first = start[which]
    count = start[which + 1] - first
    owner: Index = np.repeat(np.arange(len(which)), count)
    return owner, np.arange(len(owner)) + np.repeat(first - (np.cumsum(count) - count), count)


FEW = 50_000
"""Largest number of pairs for dense code; importing sparse matrices or trees takes longer."""


def nearest(among: Array, points: Array, count: int = 1) -> tuple[Array, Index]:
    """Find the `count` nearest of the points `among` to each point: distances and indices.

    Parameters
    ----------
    among : ndarray, shape (m, d)
        Candidates; m is at least `count`.
    points : ndarray, shape (n, d)
    count : int

    Returns
    -------
    distance, row : ndarray, shape (n, count)
        Distances, and rows of `among`.

    Examples
    --------
    >>> nearest(np.array([[0.0, 0], [3, 0], [9, 0]]), np.array([[4.0, 0]]), 2)
    (array([[1., 4.]]), array([[1, 0]]))
    """
    if len(points) * len(among) <= FEW:
        off = np.linalg.norm(points[:, None] - among, axis=2)
        row: Index = np.argsort(off, axis=1, kind="stable")[:, :count]
        return np.take_along_axis(off, row, axis=1), row
    from scipy.spatial import cKDTree

    distance, row = cKDTree(among).query(points, k=np.arange(1, count + 1))
    return distance, row


def members_by_label(label: Index) -> list[Index]:
    """Indices of the members of each label from 0 on, in the order of the first members.

    Examples
    --------
    >>> members_by_label(np.array([2, -1, 0, 2]))
    [array([0, 3]), array([2])]
    """
    member = np.flatnonzero(label >= 0)
    member = member[np.argsort(label[member], kind="stable")]
    ends = np.flatnonzero(np.diff(label[member])) + 1
    return sorted(np.split(member, ends), key=lambda group: int(group[0])) if len(member) else []


def connected(count: int, first: Index, second: Index) -> Index:
    """Label the connected components of a graph of `count` nodes with edges (first, second).

    Returns the label of each node, shape (count,). Labels are in the order of the first nodes.

    Examples
    --------
    >>> connected(4, np.array([0, 3]), np.array([3, 2]))
    array([0, 1, 0, 0])
    """
    if len(first) <= FEW:
        return _components_by_least(count, first, second)
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    graph = coo_array((np.ones(len(first)), (first, second)), shape=(count, count))
    label: Index = connected_components(graph, directed=False)[1].astype(np.int64)
    return label


def _components_by_least(count: int, first: Index, second: Index) -> Index:
    """Component labels as in `connected`, found by propagating the least node number."""
    least: Index = np.arange(count)
    while True:
        a, b = least[first], least[second]
        apart = a != b
        if not apart.any():
            return np.unique(least, return_inverse=True)[1].reshape(-1).astype(np.int64)
        first, second, a, b = first[apart], second[apart], a[apart], b[apart]
        np.minimum.at(least, np.maximum(a, b), np.minimum(a, b))
        while ((nearer := least[least]) != least).any():
            least = nearer


def read_only(arrays: Any) -> None:
    """Replace the array fields of a frozen dataclass by read-only views of the arrays."""
    for f in fields(arrays):
        value = getattr(arrays, f.name)
        if isinstance(value, np.ndarray) and value.flags.writeable:
            view = value.view()
            view.flags.writeable = False
            object.__setattr__(arrays, f.name, view)


Held = TypeVar("Held")
SCALAR = str | int | float


def sealed(value: Held) -> Held:
    """Make all arrays inside a value read-only, and return the value.

    Arrays in nested dataclasses, tuples and lists are included.

    Examples
    --------
    >>> sealed((np.zeros(2), 1))[0].flags.writeable
    False
    """
    waiting: list[Any] = [value]
    seen: set[int] = set()
    while waiting:
        item = waiting.pop()
        if id(item) in seen:
            continue
        seen.add(id(item))
        if isinstance(item, np.ndarray):
            item.flags.writeable = False
        elif isinstance(item, tuple | list):
            plain = item and isinstance(item[0], SCALAR) and isinstance(item[-1], SCALAR)
            waiting += [] if plain else item
        elif is_dataclass(item):
            waiting += [getattr(item, f.name) for f in fields(item)]
    return value


_KINDS: dict[Any, type | str] = {
    "Array": np.float64,
    "Index": np.int64,
    "Labels": "<U11",
    "Mask": np.bool_,
}
"""Data types of the rows by the annotation of their field, which is a string here."""


def columns(*shape: int) -> Any:
    """Declare a field of a `Rows` class with the shape of a row; without arguments, a number."""
    return field(metadata={"row": shape})


def distinct_rows(rows: NDArray[Any]) -> tuple[NDArray[Any], Index]:
    """The distinct rows in lexicographic order, and the index of each row among them.

    Equivalent to `numpy.unique` along rows, but several times faster.

    Examples
    --------
    >>> distinct_rows(np.array([[2, 1], [1, 3], [2, 1]]))
    (array([[1, 3],
           [2, 1]]), array([1, 0, 1]))
    """
    order = np.lexsort(rows.T[::-1])
    ordered = rows[order]
    fresh = np.ones(len(rows), dtype=bool)
    fresh[1:] = (ordered[1:] != ordered[:-1]).any(axis=1)
    inverse = np.empty(len(rows), dtype=np.int64)
    inverse[order] = np.cumsum(fresh) - 1
    return ordered[fresh], inverse


class Rows:
    """Base class for frozen dataclasses whose fields are arrays of equal length.

    A field is annotated `Array`, `Index`, `Labels` or `Mask`. The default ``columns(3)`` declares
    three numbers per row; no default, or ``columns()``, declares one number per row.

    Examples
    --------
    >>> from dataclasses import dataclass
    >>> @dataclass(frozen=True, slots=True, eq=False)
    ... class Spheres(Rows):
    ...     center: Array = columns(3)
    ...     radius: Array = columns()
    >>> two = Spheres(np.zeros((2, 3)), np.array([1.0, 2.0]))
    >>> two.take([1]).radius, len(Spheres.join([two, two])), Spheres.none().center.shape
    (array([2.]), 4, (0, 3))
    """

    __slots__ = ()

    def __len__(self) -> int:
        return len(getattr(self, _names(type(self))[0]))

    def take(self, rows: Any) -> Self:
        """Copy with only the rows of an index array, mask or slice."""
        return type(self)(*(getattr(self, name)[rows] for name in _names(type(self))))

    @classmethod
    def join(cls, blocks: Iterable[Self]) -> Self:
        """Concatenate instances of a `Rows` class in order; without blocks, there are no rows."""
        blocks = list(blocks)
        if not blocks:
            return cls.none()
        return cls(
            *(np.concatenate([getattr(block, name) for block in blocks]) for name in _names(cls))
        )

    @classmethod
    def none(cls) -> Self:
        """An instance of the class without rows."""
        return cls(
            *(
                np.empty((0, *f.metadata.get("row", ())), dtype=_KINDS[f.type])
                for f in fields(cls)  # type: ignore[arg-type]
            )
        )


def _names(kind: type[Rows]) -> tuple[str, ...]:
    return tuple(f.name for f in fields(kind))  # type: ignore[arg-type]
