"""Worker processes that judge the rows of a batch, each with a single task at a time.

A worker that dies, whatever killed it, is replaced, and its task handed back as died.
"""

from __future__ import annotations

import contextlib
import os
import selectors
import signal
import subprocess
from dataclasses import dataclass
from typing import Protocol

from kilter.analysis.many.batch_rows import BatchQuestion, BatchRow, judged_rows
from kilter.errors import KilterError
from kilter.pipes import end_process, end_with_parent, receive, send, start_process

__all__ = ["LocalWorkers", "Task", "Workers", "serve"]

STARTED = "started"
"""First message of a worker."""
STILLBORN = 10
"""Number of consecutive workers that die before their first message, at which a batch stops."""
Files = tuple[tuple[int, str], ...]


@dataclass(frozen=True, slots=True)
class Task:
    """Files for a worker to judge, with their indices in the batch, and the number of attempts."""

    chunk: int
    files: Files
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
    """Pool of `count` worker processes on this machine."""

    def __init__(self, count: int, question: BatchQuestion) -> None:
        self._count, self._question = count, question
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
        worker = start_process(__name__)
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
    """Judge tasks from the standard input of a worker process until the input ends."""
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
            send(outgoing, judged_rows(receive(incoming), question))
