"""Arrays, and the idioms of arrays of rows that every room needs; no physics.

    across:  u = e x n / |e x n|,   v = n x u,   e = the axis on which |n| is least
    ragged:  rows start[w] ... start[w + 1] - 1 of each w, one after the other

Row k of every field of a `Rows` speaks of the same thing: a contact, a pair, a facet.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import field, fields, is_dataclass
from typing import Any, Self, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = [
    "TINY",
    "Array",
    "Index",
    "Labels",
    "Mask",
    "Rows",
    "across",
    "columns",
    "connected",
    "counted",
    "cross",
    "distinct_rows",
    "nearest",
    "ragged",
    "ratio",
    "read_only",
    "sealed",
    "starts",
    "unit_rows",
]

Array = NDArray[np.float64]
Index = NDArray[np.int64]
Mask = NDArray[np.bool_]
Labels = NDArray[np.str_]

TINY = 1e-300
"""Below every size that is read [any unit]: keeps a division by nothing finite."""


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


def ratio(a: ArrayLike, b: ArrayLike) -> Array:
    """``a / b`` for sizes b >= 0; finite where b is 0.

    Examples
    --------
    >>> ratio([0.0, 1.0], [0.0, 2.0])
    array([0. , 0.5])
    """
    result: Array = np.asarray(a, dtype=np.float64) / np.maximum(b, TINY)
    return result


def unit_rows(v: Array) -> Array:
    """The unit vectors along vectors, shape (..., m); 0 stays 0.

    Examples
    --------
    >>> unit_rows(np.array([[0.0, 0.0, 2.0], [0.0, 0.0, 0.0]]))
    array([[0., 0., 1.],
           [0., 0., 0.]])
    """
    return ratio(v, np.linalg.norm(v, axis=-1)[..., None])


def across(n: Array) -> tuple[Array, Array]:
    """Two unit directions u, v across unit vectors, each of shape (..., 3).

    (u, v, n) turn right: u x v = n.

    Examples
    --------
    >>> u, v = across(np.array([0.0, 0.0, 1.0]))
    >>> (u + 0.0).tolist(), (v + 0.0).tolist()
    ([0.0, -1.0, 0.0], [1.0, 0.0, 0.0])
    """
    u = unit_rows(cross(np.eye(3)[np.abs(n).argmin(axis=-1)], n))
    return u, cross(n, u)


def starts(count: ArrayLike) -> Index:
    """First row of each run of `count` rows, and the number of all rows; shape (n + 1,).

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
    """Of runs of `count` rows: the run of each row, and its place in that run.

    Examples
    --------
    >>> counted([2, 0, 1])
    (array([0, 0, 2]), array([0, 1, 0]))
    """
    count = np.asarray(count, dtype=np.int64)
    owner: Index = np.repeat(np.arange(len(count)), count)
    return owner, np.arange(len(owner)) - np.repeat(np.cumsum(count) - count, count)


def ragged(start: Index, which: Index) -> tuple[Index, Index]:
    """Rows ``start[w]`` up to ``start[w + 1]`` of each w of `which`: (place in `which`, row).

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
"""Pairs up to which neither sparse matrices nor trees are needed: they take longer to load."""


def nearest(among: Array, points: Array, count: int = 1) -> tuple[Array, Index]:
    """The `count` nearest of some points, of each point: distances and rows, the nearest first.

    Parameters
    ----------
    among : ndarray, shape (m, d)
        At least `count`.
    points : ndarray, shape (n, d)
    count : int

    Returns
    -------
    distance, row : ndarray, shape (n, count)

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


def connected(count: int, first: Index, second: Index) -> Index:
    """A number for each of `count` things, the same for those that pairs of them connect.

    They are numbered by the first of each.

    Examples
    --------
    >>> connected(4, np.array([0, 3]), np.array([3, 2]))
    array([0, 1, 0, 0])
    """
    if len(first) <= FEW:
        return _joined_to_least(count, first, second)
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    graph = coo_array((np.ones(len(first)), (first, second)), shape=(count, count))
    label: Index = connected_components(graph, directed=False)[1].astype(np.int64)
    return label


def _joined_to_least(count: int, first: Index, second: Index) -> Index:
    """`connected`, each group joined to the least that it meets until none meets another."""
    least: Index = np.arange(count)
    while True:
        one, other = least[first], least[second]
        apart = one != other
        if not apart.any():
            return np.unique(least, return_inverse=True)[1].reshape(-1).astype(np.int64)
        first, second, one, other = first[apart], second[apart], one[apart], other[apart]
        np.minimum.at(least, np.maximum(one, other), np.minimum(one, other))
        while ((nearer := least[least]) != least).any():
            least = nearer


def read_only(arrays: Any) -> None:
    """Every array among the fields of a frozen dataclass, as a view that nobody can write to."""
    for f in fields(arrays):
        value = getattr(arrays, f.name)
        if isinstance(value, np.ndarray) and value.flags.writeable:
            view = value.view()
            view.flags.writeable = False
            object.__setattr__(arrays, f.name, view)


Held = TypeVar("Held")
SCALAR = str | int | float


def sealed(value: Held) -> Held:
    """The value itself, every array that it holds read-only: of dataclasses, tuples and lists.

    Examples
    --------
    >>> sealed((np.zeros(2), 1))[0].flags.writeable
    False
    """
    waiting: list[Any] = [value]
    seen: set[int] = set()
    while waiting:
        one = waiting.pop()
        if id(one) in seen:
            continue
        seen.add(id(one))
        if isinstance(one, np.ndarray):
            one.flags.writeable = False
        elif isinstance(one, tuple | list):
            plain = one and isinstance(one[0], SCALAR) and isinstance(one[-1], SCALAR)
            waiting += [] if plain else one
        elif is_dataclass(one):
            waiting += [getattr(one, f.name) for f in fields(one)]
    return value


_KINDS: dict[Any, type | str] = {
    "Array": np.float64,
    "Index": np.int64,
    "Labels": "<U11",
    "Mask": np.bool_,
}
"""Types of the rows by the annotation of their field, which is a string here."""


def columns(*shape: int) -> Any:
    """A field of `Rows` whose rows have this shape; `columns()`: one number."""
    return field(metadata={"row": shape})


def distinct_rows(rows: NDArray[Any]) -> tuple[NDArray[Any], Index]:
    """Each different row, once, in order, and which of them each row is.

    As `numpy.unique` by rows, several times faster.

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
    """Arrays of equal length: a base for frozen dataclasses whose fields are all such arrays.

    A field is annotated `Array`, `Index`, `Labels` or `Mask`; ``= columns(3)`` says that its
    rows have three numbers. Nothing, or ``columns()``: one number a row.

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
        """These rows alone: places, a mask, or a slice."""
        return type(self)(*(getattr(self, name)[rows] for name in _names(type(self))))

    @classmethod
    def join(cls, blocks: Iterable[Self]) -> Self:
        """The rows of all blocks, in their order; no blocks: no rows."""
        blocks = list(blocks)
        if not blocks:
            return cls.none()
        return cls(
            *(np.concatenate([getattr(block, name) for block in blocks]) for name in _names(cls))
        )

    @classmethod
    def none(cls) -> Self:
        """No rows."""
        return cls(
            *(
                np.empty((0, *f.metadata.get("row", ())), dtype=_KINDS[f.type])
                for f in fields(cls)  # type: ignore[arg-type]
            )
        )


def _names(kind: type[Rows]) -> tuple[str, ...]:
    return tuple(f.name for f in fields(kind))  # type: ignore[arg-type]
