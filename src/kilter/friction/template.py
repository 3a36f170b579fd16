"""Sparse matrix with a fixed structure and named entries whose values change.

Branch and bound solves thousands of linear programs that differ only in some numbers. The positions
of all entries are found once. A program then costs a copy of its numbers, and the basis of a
program can start the next.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike
from scipy.sparse import csc_array, sparray

from kilter.arrays import Array, Index, starts


class MatrixTemplate:
    """Structure of a sparse constraint matrix over named columns; its named entries may change.

    - `columns`: the slice of the columns of each name.
    - `width`, `height`: number of columns, and of rows so far.

    Examples
    --------
    >>> template = MatrixTemplate({"x": 2, "y": 1})
    >>> (row,) = template.rows(1, ">")  # x0 + x1 - slope y >= 0
    >>> template.put(row, template.of("x"), 1.0)
    >>> template.put(row, template.of("y"), 0.0, "slope")
    >>> template.finish()
    >>> template.matrix({"slope": -3.0}).toarray().tolist()
    [[1.0, 1.0, -3.0]]
    """

    def __init__(self, lengths: Mapping[str, int]) -> None:
        ends = starts(list(lengths.values()))
        self.columns = {
            name: slice(int(a), int(b))
            for name, a, b in zip(lengths, ends[:-1], ends[1:], strict=True)
        }
        self.width, self.height = int(ends[-1]), 0
        self._blocks: list[tuple[Index, Index, Array]] = []
        self._places: dict[str, slice] = {}
        self._lower: list[Array] = []
        self._upper: list[Array] = []
        self._filled = 0

    def of(self, name: str) -> Index:
        """Indices of the columns that have a name."""
        columns = self.columns[name]
        return np.arange(columns.start, columns.stop)

    def rows(self, count: int, kind: Literal["=", ">", "<"]) -> Index:
        """Add `count` constraint rows of a kind (= 0, >= 0, <= 0) and return their indices."""
        at = self.height + np.arange(count)
        self._lower.append(np.full(count, -np.inf if kind == "<" else 0.0))
        self._upper.append(np.full(count, np.inf if kind == ">" else 0.0))
        self.height += count
        return at

    def put(self, rows: ArrayLike, columns: ArrayLike, values: ArrayLike, name: str = "") -> None:
        """Add entries to the matrix; entries with a name get new values in each later matrix."""
        at, across = np.broadcast_arrays(np.asarray(rows), np.asarray(columns))
        data = np.broadcast_to(np.asarray(values, dtype=np.float64), at.shape)
        self._blocks.append((at.ravel(), across.ravel(), data.ravel()))
        if name:
            self._places[name] = slice(self._filled, self._filled + at.size)
        self._filled += at.size

    def put_matrix(self, rows: Index, columns: str, matrix: sparray, sign: float) -> None:
        """Add a given matrix, times a sign, to rows and to the columns with a name."""
        coo = matrix.tocoo()
        self.put(rows[coo.row], self.columns[columns].start + coo.col, sign * coo.data)

    def finish(self) -> None:
        """Sort the entries of the matrix by columns; no rows can be added afterwards."""
        row, column, self._data = (
            np.concatenate([block[k] for block in self._blocks]) for k in range(3)
        )
        self._blocks = []
        self._order = np.lexsort((row, column))
        self._index = row[self._order].astype(np.int32)
        self._start = starts(np.bincount(column, minlength=self.width)).astype(np.int32)
        self.lower, self.upper = np.concatenate(self._lower), np.concatenate(self._upper)

    def matrix(self, values: Mapping[str, ArrayLike]) -> csc_array:
        """The matrix with the given values in its named entries; other named entries are 0."""
        data = self._data.copy()
        for name, value in values.items():
            data[self._places[name]] = np.ravel(np.asarray(value))
        entries = (data[self._order], self._index, self._start)
        return csc_array(entries, shape=(self.height, self.width))
