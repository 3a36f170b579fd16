"""The output folder of a batch: a file for each chunk of rows, complete or absent.

A chunk is written beside its place, flushed to the disk and renamed, so that a listing of the
folder shows the finished chunks; no other state is kept. `batch.json` identifies the batch; a lock
that ends with its process keeps a second run out.
"""

from __future__ import annotations

import contextlib
import csv
import hashlib
import importlib.util
import json
import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from kilter.analysis.many.batch_rows import COLUMNS, BatchQuestion, BatchRow
from kilter.errors import InputError, visible
from kilter.files.complaints import parse_json
from kilter.files.limits import MOST_TABLE_BYTES, read_bytes
from kilter.files.writing import write_bytes, write_text
from kilter.tell.csv_cells import csv_text, name_of_cell

FORMAT = 1
MANIFEST, LOCK = "batch.json", ".batch.lock"
FORMS = ("parquet", "csv")
"""Formats of the tables."""


@dataclass(frozen=True, slots=True)
class BatchFolder:
    """Output folder of a batch: files for `count` rows in chunks of `size` rows."""

    path: Path
    count: int
    size: int
    form: str

    @property
    def chunks(self) -> int:
        """Number of chunks of the batch."""
        return -(-self.count // self.size)

    def places(self, chunk: int) -> range:
        """Indices, within the batch, of the rows of a chunk."""
        return range(chunk * self.size, min((chunk + 1) * self.size, self.count))

    def file(self, chunk: int) -> Path:
        """Path of the file that contains the rows of a chunk."""
        return self.path / f"part-{chunk:06d}.{self.form}"

    def write(self, chunk: int, rows: Sequence[BatchRow]) -> None:
        """Write the rows of a chunk to its file, all rows or none.

        Raises `InputError` if it cannot be written.
        """
        data = _parquet(rows) if self.form == "parquet" else _csv(rows)
        write_bytes(self.file(chunk), data)
        _flush(self.path)

    def read(self, chunk: int) -> list[BatchRow] | None:
        """Read the rows of a chunk; None if its file does not exist.

        Raises `InputError` if it is damaged.
        """
        path = self.file(chunk)
        if not path.exists():
            return None
        try:
            rows = _from_parquet(path) if self.form == "parquet" else _from_csv(path)
            if [row["index"] for row in rows] == list(self.places(chunk)):
                return rows
        except (OSError, ValueError, KeyError, TypeError, csv.Error):
            pass
        raise InputError("holds other rows", file=str(path), hint="remove it, and run again")


@contextlib.contextmanager
def open_folder(
    path: Path, files: Sequence[str], question: BatchQuestion, *, size: int
) -> Iterator[BatchFolder]:
    """Open the output folder of a batch, and lock it against other runs.

    Raises `InputError` if it cannot be made, another run is writing to it, or it has another batch.
    """
    try:
        path.mkdir(parents=True, exist_ok=True)
    except (OSError, ValueError) as error:
        raise InputError(
            f"cannot be made: {getattr(error, 'strerror', None) or error}",
            file=str(path),
            hint="give another folder",
        ) from None
    listed = "\n".join(files).encode("utf-8", "backslashreplace")
    asked = {
        "kilter_batch": FORMAT,
        "files": len(files),
        "listed": hashlib.sha256(listed).hexdigest(),
        "question": _as_data(question),
    }
    manifest = path / MANIFEST
    _written_form(manifest, asked)  # a folder that is refused gets no lock file
    with _locked_folder(path):
        for left in path.glob(".part-*"):  # of a run that was killed
            left.unlink()
        written = _written_form(manifest, asked)
        if written is not None:
            form, size = written
        else:
            form = "parquet" if importlib.util.find_spec("pyarrow") else "csv"
            write_text(manifest, json.dumps({**asked, "rows": size, "form": form}, indent=2) + "\n")
        yield BatchFolder(path, len(files), size, form)


def _written_form(manifest: Path, asked: dict[str, Any]) -> tuple[str, int] | None:
    """File format and chunk size of the batch already in a folder; None in a new folder.

    Raises InputError if it is a different batch, or has tables without a manifest.
    """
    if not manifest.exists():
        if any(manifest.parent.glob("part-*")):
            raise InputError(
                "has table files, but no batch.json",
                file=str(manifest.parent),
                hint="give another folder",
            )
        return None
    try:
        written = parse_json(read_bytes(manifest, most=MOST_TABLE_BYTES))
    except InputError:
        written = None
    form, size = "", 0
    if isinstance(written, dict):
        form, size = written.pop("form", ""), written.pop("rows", 0)
    if written != asked or form not in FORMS or type(size) is not int or size < 1:
        raise InputError(
            "has another batch: other files, or other options",
            file=str(manifest.parent),
            hint="give another folder",
        )
    if form == "parquet" and importlib.util.find_spec("pyarrow") is None:
        raise InputError(
            "has parquet files, and pyarrow is not installed",
            file=str(manifest.parent),
            hint="pip install 'kilter[batch]'",
        )
    return form, size


def _as_data(question: BatchQuestion) -> dict[str, Any]:
    """Options of a batch as JSON data, to compare them with the options stored in a folder."""
    tolerance = question.tolerance
    return {
        "reading": question.reading.options(),
        "tolerance": [tolerance.gap, tolerance.relative_gap, tolerance.angle, tolerance.clearance],
        "require": question.require,
        "effort": question.effort,
        "time_limit": question.time_limit,
    }


@contextlib.contextmanager
def _locked_folder(path: Path) -> Iterator[None]:
    """Keep other runs out of a folder within this context; a killed run also releases it."""
    try:
        handle = os.open(path / LOCK, os.O_RDWR | os.O_CREAT, 0o666)
    except OSError as error:  # no rights, or no room for one more name
        raise InputError(
            f"cannot be written: {error.strerror}",
            file=str(path),
            hint="check the folder and its rights",
        ) from None
    try:
        try:
            lock_file(handle)
        except OSError:
            raise InputError(
                "another run is writing to this folder",
                file=str(path),
                hint="wait, or give another folder",
            ) from None
        yield
    finally:
        os.close(handle)


def lock_file(handle: int) -> None:
    """Lock an open file for this process; OSError if another process has locked it."""
    if os.name == "nt":
        import msvcrt

        msvcrt.locking(handle, msvcrt.LK_NBLCK, 1)  # type: ignore[attr-defined,unused-ignore]
    else:
        import fcntl

        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)


def _flush(folder: Path) -> None:
    """Flush a folder to disk, so that a renamed file in it survives a crash of the machine."""
    if os.name == "nt":
        return
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


# forms ----------------------------------------------------------------------------------------


def _csv(rows: Sequence[BatchRow]) -> bytes:
    text = csv_text([list(COLUMNS), *([row[name] for name in COLUMNS] for row in rows)])
    return text.encode("utf-8")


def _from_csv(path: Path) -> list[BatchRow]:
    with open(path, encoding="utf-8", newline="") as stream:
        return [
            {name: _value(kind, row[name]) for name, kind in COLUMNS.items()}
            for row in csv.DictReader(stream)
        ]


def _value(kind: type, text: str) -> Any:
    if text == "":
        return None
    if kind is str:
        return name_of_cell(text)
    return text == "True" if kind is bool else kind(text)


def _parquet(rows: Sequence[BatchRow]) -> bytes:
    """A table of batch rows as the bytes of a Parquet file, with fixed column types."""
    import pyarrow
    import pyarrow.parquet

    kinds = {
        int: pyarrow.int64(), str: pyarrow.string(), bool: pyarrow.bool_(), float: pyarrow.float64()
    }  # fmt: skip
    schema = pyarrow.schema([(name, kinds[kind]) for name, kind in COLUMNS.items()])
    rows = [  # a file name with invalid characters could not be encoded
        {k: visible(value) if isinstance(value, str) else value for k, value in row.items()}
        for row in rows
    ]
    stream = pyarrow.BufferOutputStream()
    pyarrow.parquet.write_table(pyarrow.Table.from_pylist(rows, schema=schema), stream)
    data: bytes = stream.getvalue().to_pybytes()
    return data


def _from_parquet(path: Path) -> list[BatchRow]:
    import pyarrow.parquet

    with open(path, "rb") as stream:
        rows: list[BatchRow] = pyarrow.parquet.read_table(stream).to_pylist()
    return rows
