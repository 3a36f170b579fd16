"""Verdicts of many files, chunk by chunk, by worker processes; a worker that dies is replaced.

Rows are judged by workers and written by this process alone, so that no row is lost or doubled
whatever is killed. A task whose worker died is tried once more, then halved, until the assembly
that kills is alone: its row says so.
"""

from __future__ import annotations

import dataclasses
import os
from collections import Counter, deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, ClassVar

from kilter.analysis.many.batch_folder import BatchFolder, open_folder
from kilter.analysis.many.batch_rows import (
    BatchQuestion,
    BatchRow,
    ClusterWorkers,
    LocalWorkers,
    Task,
    Workers,
    error_row,
)
from kilter.assembly.question import Question, question
from kilter.contact import Tolerance
from kilter.errors import InputError
from kilter.files.formats import FORMATS
from kilter.files.limits import MOST_TABLE_BYTES, is_file, is_folder, read_bytes
from kilter.files.meshes.placed import natural_key
from kilter.loading import reading_for
from kilter.tell.levels import require_level
from kilter.tell.record import Answer, Record
from kilter.validate import whole

# Input files of a batch, which a list file names or a folder contains.


READABLE = (*FORMATS, ".json")
"""Endings of files that `kilter.load` reads."""


def listed_files(source: str | Path) -> tuple[Path, list[str]]:
    """The folder to which the paths of a batch are relative, and the path of each input file.

    Raises `InputError` if it cannot be read, or names nothing.
    """
    path = Path(source)
    if path.suffix.lower() in READABLE and is_file(path):
        raise InputError(
            "is an assembly, not a list of assemblies", file=str(path),
            hint="use `kilter check`, or give its folder",
        )  # fmt: skip
    try:
        if is_folder(path):
            chosen = [e for e in path.iterdir() if _is_assembly(e)]
            base, listed = path, sorted((e.name for e in chosen), key=natural_key)
        else:
            lines = read_bytes(path, most=MOST_TABLE_BYTES).decode("utf-8").splitlines()
            words = [line.strip() for line in lines]
            base, listed = path.parent, [w for w in words if w and not w.startswith("#")]
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(
            f"cannot be read: {getattr(error, 'strerror', None) or 'it is not a text file'}",
            file=str(path),
            hint="give a folder of assemblies, or a text file with a path in each line",
        ) from None
    if not listed:
        hint = "name a file in each line"
        if is_folder(path):
            hint = "subfolders are not searched; name their files in a list, a file in each line"
        raise InputError("it contains no assembly", file=str(path), hint=hint)
    return base.resolve(), listed


def _is_assembly(entry: Path) -> bool:
    readable = entry.suffix.lower() in READABLE
    return readable and not entry.name.startswith(".") and entry.is_file()


CHUNK = 1000
"""Default number of rows of a file."""
TRIES = 2
"""Number of attempts at a task before it is halved; a task with a single assembly then fails."""
KILLED = "ended the process that checked it, in every attempt"
TOLD = 1000
"""Largest number of errors that an answer of `batch` lists."""


class BatchError(Record):
    """A file without a verdict, and the reason."""

    file: str
    """Path of the file."""
    error: str
    """The reason."""


class Batch(Answer):
    """Result of a batch of verdicts: numbers of rows, and the files that contain them."""

    answer: ClassVar[str] = "batch"

    folder: str
    """Folder of the row files."""
    files: tuple[str, ...]
    """Names of the row files, in order of the chunks."""
    rows: int
    """Number of rows."""
    counts: Mapping[str, int]
    """Number of rows of each verdict, the most frequent first; "error" is among them."""
    errors: tuple[BatchError, ...]
    """Files without a verdict, the first thousand."""
    found_there: int
    """Rows that an earlier run had written."""

    @property
    def paths(self) -> list[Path]:
        """Paths of the row files."""
        return [Path(self.folder) / name for name in self.files]


@dataclass(slots=True)
class _Tally:
    """Numbers of rows that are written, and their first errors."""

    rows: int = 0
    counts: Counter[str] = field(default_factory=Counter)
    errors: list[tuple[str, str]] = field(default_factory=list)

    def add(self, rows: Sequence[BatchRow]) -> None:
        """Count the rows of a finished chunk of the batch."""
        self.rows += len(rows)
        self.counts.update(row["verdict"] for row in rows)
        wrong = [(row["file"], row["error"] or "") for row in rows if row["verdict"] == "error"]
        self.errors += wrong[: TOLD - len(self.errors)]


@question(lacks="friction down ground floor contacts progress")
def batch(
    source: str | Path,
    output: str | Path,
    *,
    asked: Question,
    processes: int | None = None,
    chunk: int = CHUNK,
    cluster: str | None = None,
    progress: Callable[[int, int], None] | None = None,
    **reading: Any,
) -> Batch:
    """Compute the verdicts of many files, and write them to a folder as tables.

    A later run continues an interrupted one with the missing rows.

    Parameters
    ----------
    source : path
        A folder of assemblies, or a text file with a path a line.
    output : path
        A folder; ``part-000000.parquet`` and so on, CSV if pyarrow is not installed.
    processes : int, optional
        Number of worker processes on this machine; by default the number of cores.
    chunk : int
        Number of rows of a file.
    cluster : str, optional
        Address of a scheduler of Dask, in place of processes of this machine. The files are
        read where its workers run.
    progress : callable, optional
        Called with how many rows are written, and of how many.
    **reading
        How every file is read, as of `kilter.load`: `ground`, `floor`, `friction` and so on.

    Raises
    ------
    InputError
        If nothing can be read or written, another run is at work in the folder, or it has
        another batch.

    See Also
    --------
    kilter.check_many : verdicts on assemblies in memory, without files.
    kilter.check : the complete answer for one assembly.
    """
    allowed = Tolerance() if asked.tolerance is None else asked.tolerance
    allowed.require_sound()
    level = require_level(asked.require)
    given = BatchQuestion(reading_for(**reading), allowed, level, asked.effort, asked.time_limit)
    return run_batch(
        source, output, given,
        processes=processes, chunk=chunk, cluster=cluster, progress=progress,
    )  # fmt: skip


def run_batch(
    source: str | Path,
    output: str | Path,
    question: BatchQuestion,
    *,
    processes: int | None = None,
    chunk: int = CHUNK,
    cluster: str | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Batch:
    """Compute the verdicts of many files for a question with validated options.

    Otherwise as `batch`.
    """
    size = whole(chunk, "chunk")
    count = whole(_cores() if processes is None else processes, "processes")
    base, files = listed_files(source)
    if Path(output).resolve() == base and Path(source).is_dir():
        raise InputError(
            "the folder of the answers contains the files to check",
            file=str(output),
            hint="give another folder",
        )
    question = dataclasses.replace(question, base=base)
    with open_folder(Path(output), files, question, size=size) as folder:
        tally = _Tally()
        left = []
        for k in range(folder.chunks):
            rows = folder.read(k)
            if rows is None:
                left.append(k)
            else:
                tally.add(rows)
        found_there = tally.rows
        workers = _workers(cluster, min(count, max(len(left), 1)), question)
        try:
            _run(workers, folder, files, left, tally, progress or (lambda done, of: None))
        finally:
            workers.end()
        files_of_rows = [folder.file(k).name for k in range(folder.chunks)]
    return Batch(
        folder=str(folder.path),
        files=tuple(files_of_rows),
        rows=tally.rows,
        counts=dict(tally.counts.most_common()),
        errors=tuple(BatchError(file=file, error=error) for file, error in sorted(tally.errors)),
        found_there=found_there,
    )


def _workers(cluster: str | None, count: int, question: BatchQuestion) -> Workers:
    if cluster is None:
        return LocalWorkers(count, question)
    return ClusterWorkers(cluster, question)


def _run(
    workers: Workers,
    folder: BatchFolder,
    files: Sequence[str],
    left: Sequence[int],
    tally: _Tally,
    progress: Callable[[int, int], None],
) -> None:
    """Judge the chunks of a batch that are not written yet, and write their rows."""
    waiting = deque(Task(k, tuple((n, files[n]) for n in folder.places(k))) for k in left)
    rows: dict[int, dict[int, BatchRow]] = {k: {} for k in left}
    progress(tally.rows, folder.count)
    while rows:
        while waiting and workers.free:
            workers.take(waiting.popleft())
        for task, judged in workers.finished(0.2):
            if judged is None:
                judged, again = _rows_of_dead_task(task)
                waiting.extendleft(reversed(again))
            chunk_rows = rows[task.chunk]
            chunk_rows |= {row["index"]: row for row in judged}
            if len(chunk_rows) == len(folder.places(task.chunk)):
                complete = [chunk_rows[n] for n in folder.places(task.chunk)]
                folder.write(task.chunk, complete)
                del rows[task.chunk]
                tally.add(complete)
        progress(tally.rows, folder.count)


def _rows_of_dead_task(task: Task) -> tuple[list[BatchRow], list[Task]]:
    """Rows of errors, and smaller tasks to try again, for a task whose worker died."""
    if task.tries + 1 < TRIES:
        return [], [Task(task.chunk, task.files, task.tries + 1)]
    if len(task.files) == 1:
        index, file = task.files[0]
        return [error_row(index, file, KILLED)], []
    half = len(task.files) // 2
    return [], [Task(task.chunk, some) for some in (task.files[:half], task.files[half:])]


def _cores() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
