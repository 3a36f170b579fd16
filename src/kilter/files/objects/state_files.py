"""Read states of a simulator from a file: a row of numbers for each state.

NumPy files (.npy, .npz with one array), pickles of an array, and archives of PyTorch such as
LIBERO's .pruned_init are known by their first bytes. A single row is one state.
"""

from __future__ import annotations

import io
import re
from pathlib import Path

import numpy as np

from kilter.arrays import Array
from kilter.errors import InputError
from kilter.files.limits import MOST_TABLE_BYTES, read_bytes, require_unfolded
from kilter.files.objects.mujoco_snapshot import StateRows
from kilter.files.objects.number_pickles import archived, unpickled
from kilter.files.reader_guard import reader_guard

NUMPY, ZIP, PICKLE = b"\x93NUMPY", b"PK\x03\x04", b"\x80"
"""First bytes of the files."""


def read_states(path: Path) -> Array:
    """The states in a file, shape (n, width).

    Raises `InputError` if the file cannot be read, is damaged, or does not hold rows of finite
    numbers; the error names the file.
    """
    data = read_bytes(path, most=MOST_TABLE_BYTES)
    with reader_guard(path):
        return as_rows(_numbers(data))


def as_rows(values: object) -> Array:
    """Numbers as rows of states, shape (n, width); a single row is one state.

    Raises `InputError` if they are no rows of finite numbers.
    """
    try:
        rows = np.asarray(values, dtype=float)
    except (TypeError, ValueError):
        rows = np.empty(0)
    if rows.ndim == 1 and len(rows):
        rows = rows[None]
    if rows.ndim != 2 or not rows.size:
        raise InputError(
            f"the states have the shape {rows.shape}", hint="give a row of numbers for each state"
        )
    bad = np.flatnonzero(~np.isfinite(rows).all(axis=1))
    if len(bad):
        raise InputError(
            f"state {bad[0]} has a number that is not finite", hint="give finite numbers"
        )
    return rows


def _numbers(data: bytes) -> Array:
    """The array in the bytes of a file."""
    if data.startswith(NUMPY):
        return _plain(data)
    if data.startswith(PICKLE):
        return unpickled(data)
    if not data.startswith(ZIP):
        raise InputError(
            "it is neither a NumPy file nor a pickle of an array nor an archive of PyTorch",
            hint="write the states by numpy.save",
        )
    import zipfile

    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        require_unfolded(sum(entry.file_size for entry in archive.infolist()), len(data))
        arrays = [name for name in archive.namelist() if name.endswith(".npy")]
        if len(arrays) > 1:
            raise InputError(f"it holds {len(arrays)} arrays", hint="write one array by numpy.save")
        if arrays:
            return _plain(archive.read(arrays[0]))
    return archived(data)


def _plain(data: bytes) -> Array:
    """The array of numbers in the bytes of a NumPy file, as floats."""
    stream = io.BytesIO(data)
    version = np.lib.format.read_magic(stream)
    read = np.lib.format.read_array_header_1_0
    if version != (1, 0):
        read = np.lib.format.read_array_header_2_0
    shape, by_columns, kind = read(stream)
    if kind.kind not in "fiu":
        raise InputError(
            f"its array holds {kind.name:.40} and no numbers", hint="give rows of numbers"
        )
    # numpy.load would reserve memory for any shape that the file states
    numbers = np.frombuffer(stream.read(), kind)
    return numbers.reshape(shape, order="F" if by_columns else "C").astype(float)


def state_row(text: str, folder: Path = Path()) -> StateRows:
    """The state that a text FILE or FILE:ROW names; the first row without a number.

    Negative rows count from the end. Raises `InputError` if there is no such row.

    Examples
    --------
    >>> state_row("none.npy:3")
    Traceback (most recent call last):
    ...
    kilter.errors.InputError: none.npy: no such file; ...
    """
    name, row = state_name(text)
    rows = read_states(folder / name)
    if not -len(rows) <= row < len(rows):
        raise InputError(
            f"there is no state {row}",
            file=str(folder / name),
            hint=f"the states are 0 to {len(rows) - 1}",
        )
    return StateRows.of(rows[row][None])


def state_name(text: str) -> tuple[str, int]:
    """The file and the row of a text FILE or FILE:ROW.

    Examples
    --------
    >>> state_name("S.npy:3"), state_name("S.npy"), state_name("C:/S.npy")
    (('S.npy', 3), ('S.npy', 0), ('C:/S.npy', 0))
    """
    match = re.fullmatch(r"(.+):(-?\d{1,9})", text)
    return (match[1], int(match[2])) if match else (text, 0)
