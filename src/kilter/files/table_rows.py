"""Rows of a table of comma-separated values, with each fault of the text as an `InputError`.

Lines end with LF, CR LF or CR. The `csv` module limits the length of a cell.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator

from kilter.errors import InputError

__all__ = ["decoded_table", "table_rows"]


def decoded_table(data: bytes) -> str:
    """The text of a table; raises `InputError` if it is not UTF-8."""
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(
            f"not UTF-8 at byte {error.start}", hint="save the table as UTF-8"
        ) from None


def table_rows(text: str, separator: str = ",") -> Iterator[tuple[int, list[str]]]:
    """Yield the number of the last line and the cells of each row that is not empty.

    Raises
    ------
    InputError
        If a row is no row of a table, for instance because a cell is too long.

    Examples
    --------
    >>> list(table_rows("a,b\\r1,2\\r"))
    [(1, ['a', 'b']), (2, ['1', '2'])]
    """
    rows = csv.reader(io.StringIO(text, newline=None), delimiter=separator)
    try:
        for row in rows:
            if row:
                yield rows.line_num, row
    except csv.Error as error:
        raise InputError(
            f"line {rows.line_num}: {error}", hint="correct the quotes and cells of this line"
        ) from None
