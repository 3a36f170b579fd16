"""Rows of a batch: the verdict of each assembly as a row, the same from every process."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from kilter.analysis.many.check_many import check_many
from kilter.analysis.many.verdicts import Verdicts
from kilter.assembly import Assembly
from kilter.contact import Tolerance
from kilter.contact.fits.fastening import fasten_as_read
from kilter.errors import InputError, KilterError, visible
from kilter.files.choices import find_choices
from kilter.files.reading import Reading
from kilter.loading import read_chosen
from kilter.tell.levels import REQUIRE
from kilter.work import EFFORT

__all__ = ["COLUMNS", "BatchQuestion", "error_row", "judged_rows"]

COLUMNS: dict[str, type] = {
    "index": int,
    "file": str,
    "verdict": str,
    "level": str,
    "stable": bool,
    "parts": int,
    "residual": float,
    "power": float,
    "violation": float,
    "error": str,
}
"""Columns of a table of verdicts with their types; a cell without a value is None."""
BatchRow = dict[str, Any]


@dataclass(frozen=True, slots=True)
class BatchQuestion:
    """Options of a batch, the same for every assembly: options of `check` and of the file reader.

    `base`: the folder that their paths start from.
    """

    reading: Reading = field(default_factory=Reading)
    tolerance: Tolerance = field(default_factory=Tolerance)
    require: str = REQUIRE
    effort: float = EFFORT
    time_limit: float | None = None
    base: Path = field(default_factory=Path)

    @property
    def options(self) -> dict[str, Any]:
        """Options of the batch that `check` accepts, as keyword arguments."""
        return {
            # an assembly of choices has a tolerance of its own
            "tolerance": None if self.tolerance == Tolerance() else self.tolerance,
            "require": self.require,
            "effort": self.effort,
            "time_limit": self.time_limit,
        }


def judged_rows(files: Sequence[tuple[int, str]], question: BatchQuestion) -> list[BatchRow]:
    """Read and judge files, given with their indices in the batch; return a row for each."""
    rows: dict[int, BatchRow] = {}
    read: dict[int, Assembly] = {}
    for index, file in files:
        try:
            read[index] = _read(file, question)
        except Exception as error:
            rows[index] = error_row(index, file, _words(error))
    given, names = list(read.values()), dict(files)
    try:
        verdict_sets = [check_many(given, **question.options)]
    except Exception:  # a fault in one assembly must not lose the other rows
        verdict_sets = []
    for place, index in enumerate(read):
        if verdict_sets:
            rows[index] = _row(index, names[index], given[place], verdict_sets[0], place)
            continue
        try:
            single = check_many([given[place]], **question.options)
            rows[index] = _row(index, names[index], given[place], single, 0)
        except Exception as error:
            rows[index] = error_row(index, names[index], _words(error))
    return [rows[index] for index, _ in files]


def _read(file: str, question: BatchQuestion) -> Assembly:
    choices = find_choices(question.base / file)
    if choices is not None:
        return read_chosen(choices, question.reading, tolerance=question.tolerance)
    assembly = question.reading.read(question.base / file)
    if not question.reading.fastens:
        return assembly
    return fasten_as_read(assembly, question.reading, tolerance=question.tolerance)[0]


def _row(index: int, file: str, assembly: Assembly, verdicts: Verdicts, k: int) -> BatchRow:
    """Row of the k-th assembly: its verdict, or the error that prevented a verdict."""
    if k in verdicts.errors:
        return error_row(index, file, _words(verdicts.errors[k]), parts=len(assembly))
    return {
        "index": index,
        "file": file,
        "verdict": str(verdicts.verdict[k]),
        "level": verdicts.level[k],
        "stable": bool(verdicts.stable[k]),
        "parts": len(assembly),
        "residual": _number(verdicts.residual[k]),
        "power": _number(verdicts.power[k]),
        "violation": _number(verdicts.violation[k]),
        "error": None,
    }


def error_row(index: int, file: str, error: str, *, parts: int | None = None) -> BatchRow:
    """Row of a file for which an error prevented a verdict."""
    row = dict.fromkeys(COLUMNS)
    return row | {
        "index": index, "file": file, "verdict": "error", "stable": False, "parts": parts,
        "error": visible(error),
    }  # fmt: skip


def _number(value: float) -> float | None:
    return None if math.isnan(value) else float(value)


def _words(error: Exception) -> str:
    if isinstance(error, InputError):  # the file has a column of its own
        where = {"part": error.part, "hint": error.hint, "option": error.option}
        return InputError(error.what, **where).for_command
    if isinstance(error, KilterError):
        return str(error)
    return f"a fault of kilter itself: {type(error).__name__}: {error}"
