"""Rows of a batch: the verdict of each assembly as a row, the same from every process."""

from __future__ import annotations

import contextlib
import math
import os
import queue
import selectors
import signal
import subprocess
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol

from kilter.analysis.many.check_many import check_many
from kilter.analysis.many.verdicts import Verdicts
from kilter.assembly import Assembly
from kilter.contact import Tolerance
from kilter.contact.fits.fastening import fasten_as_read
from kilter.errors import InputError, KilterError, visible
from kilter.files.own.choices import find_choices
from kilter.files.reading import Reading
from kilter.loading import read_chosen
from kilter.pipes import end_process, end_with_parent, receive, send, start_process
from kilter.tell.levels import REQUIRE
from kilter.work import EFFORT

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
            rows[index] = error_row(index, file, words_of(error))
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
            rows[index] = error_row(index, names[index], words_of(error))
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
        return error_row(index, file, words_of(verdicts.errors[k]), parts=len(assembly))
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


def words_of(error: Exception) -> str:
    """The words of an error in a row."""
    if isinstance(error, InputError):  # the file has a column of its own
        where = {"part": error.part, "hint": error.hint, "option": error.option}
        return InputError(error.what, **where).for_command
    if isinstance(error, KilterError):
        return str(error)
    return f"a fault of kilter itself: {type(error).__name__}: {error}"


# Worker processes that judge the rows of a batch, each with a single task at a time.


STARTED = "started"
"""First message of a worker."""
STILLBORN = 10
"""Number of consecutive workers that die before their first message, at which a batch stops."""


@dataclass(frozen=True, slots=True)
class Task:
    """Files for a worker to judge, with their indices in the batch, and the number of attempts.

    In other pools, `files` has other contents of a task.
    """

    chunk: int
    files: Any
    tries: int = 0


class Workers(Protocol):
    """Interface of a pool of worker processes, which judges tasks and returns their rows."""

    @property
    def free(self) -> int:
        """Number of tasks that the workers can start now."""

    def take(self, task: Task) -> None:
        """Start a task on a free worker."""

    def finished(self, seconds: float) -> list[tuple[Task, list[BatchRow] | None]]:
        """Tasks that end within a time [s]; None in place of rows if their worker died."""

    def end(self) -> None:
        """End all workers."""


class LocalWorkers:
    """Pool of `count` worker processes on this machine, which run `serve` of a module."""

    def __init__(self, count: int, question: Any, module: str = __name__) -> None:
        self._count, self._question, self._module = count, question, module
        self._busy: dict[subprocess.Popen[bytes], Task] = {}
        self._idle: list[subprocess.Popen[bytes]] = []
        self._ready = selectors.DefaultSelector()
        self._stillborn = 0

    @property
    def free(self) -> int:
        """Number of tasks that the workers can start now."""
        return self._count - len(self._busy)

    def take(self, task: Task) -> None:
        """Start a task on a free worker process."""
        worker = self._idle.pop() if self._idle else self._start_worker()
        assert worker.stdin is not None
        self._busy[worker] = task
        with contextlib.suppress(OSError):  # it died: that is seen where it is waited for
            send(worker.stdin, task.files)

    def _start_worker(self) -> subprocess.Popen[bytes]:
        worker = start_process(self._module)
        assert worker.stdin is not None
        assert worker.stdout is not None
        self._ready.register(worker.stdout, selectors.EVENT_READ, worker)
        with contextlib.suppress(OSError):
            send(worker.stdin, self._question)
        return worker

    def finished(self, seconds: float) -> list[tuple[Task, list[BatchRow] | None]]:
        """Tasks that end within a time [s]; None in place of rows if their worker died."""
        done_tasks = []
        for key, _ in self._ready.select(seconds):
            worker: subprocess.Popen[bytes] = key.data
            assert worker.stdout is not None
            try:
                rows = receive(worker.stdout)
                self._stillborn = 0
            except (EOFError, OSError):
                rows = None
                self._ready.unregister(worker.stdout)
                end_process(worker)
                self._stillborn += 1
                if self._stillborn == STILLBORN:
                    raise KilterError("no worker process starts") from None
            if rows == STARTED:
                continue
            task = self._busy.pop(worker, None)
            if rows is not None:
                self._idle.append(worker)
            elif worker in self._idle:
                self._idle.remove(worker)
            if task is not None:
                done_tasks.append((task, rows))
        return done_tasks

    def end(self) -> None:
        """Terminate all worker processes, with their unfinished tasks."""
        for worker in [*self._busy, *self._idle]:
            end_process(worker)
        self._ready.close()


def serve() -> None:
    """Main function of a worker process: it judges files."""
    serve_tasks(judged_rows)


def serve_tasks(judge: Callable[[Any, Any], list[BatchRow]]) -> None:
    """Judge tasks from the standard input of a worker process until the input ends.

    Arguments: `judge`: function of the content of a task and of the question; it returns rows.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    incoming = os.fdopen(os.dup(0), "rb")
    outgoing = os.fdopen(os.dup(1), "wb")
    nothing = os.open(os.devnull, os.O_RDWR)
    for stream in (0, 1):
        os.dup2(nothing, stream)
    end_with_parent()
    with contextlib.suppress(EOFError, BrokenPipeError):
        question = receive(incoming)
        send(outgoing, STARTED)
        while True:
            send(outgoing, judge(receive(incoming), question))


# Worker pool that judges the rows of a batch on a Dask cluster (extra `kilter[cluster]`).


AHEAD = 2
"""Number of tasks that are queued for each thread of the cluster."""


class ClusterWorkers:
    """The pool of workers of the Dask scheduler at an address."""

    def __init__(self, address: str, question: BatchQuestion) -> None:
        try:
            import distributed
        except ImportError:
            raise InputError(
                "a cluster needs Dask, which is not installed", hint="pip install 'kilter[cluster]'"
            ) from None
        try:
            self._client: Any = distributed.Client(address, timeout=20)
        except (OSError, ValueError, TimeoutError):
            raise InputError(
                f"no Dask scheduler answers at {address!r:.80}", hint="give it as tcp://HOST:8786"
            ) from None
        self._question, self._killed = question, distributed.KilledWorker
        self._tasks: dict[Any, Task] = {}
        self._done: queue.SimpleQueue[Any] = queue.SimpleQueue()

    @property
    def free(self) -> int:
        """Number of further tasks that may be submitted to the Dask workers now."""
        threads: int = sum(self._client.nthreads().values())
        return max(AHEAD * threads, 1) - len(self._tasks)

    def take(self, task: Task) -> None:
        """Submit a task to the Dask scheduler."""
        future = self._client.submit(judged_rows, task.files, self._question, pure=False)
        self._tasks[future] = task
        future.add_done_callback(self._done.put)

    def finished(self, seconds: float) -> list[tuple[Task, list[BatchRow] | None]]:
        """Tasks that end within a time [s], with their rows; None for rows if a worker died."""
        try:
            future = self._done.get(timeout=seconds)
        except queue.Empty:
            return []
        task = self._tasks.pop(future)
        try:
            return [(task, future.result())]
        except self._killed:
            return [(task, None)]

    def end(self) -> None:
        """Cancel all tasks, and close the connection to the Dask scheduler."""
        for future in self._tasks:
            future.cancel()
        self._client.close()
