"""The jobs of a session: a single job runs, the others wait.

A new answer replaces answers and tabs of older states. If the worker process was ended, its
successor first reads the open file again.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from kilter.errors import InputError
from kilter.workbench.worker_process import ENDED, LAST, WorkerProcess

__all__ = ["JobQueue", "QueuedJob"]

STOPPED = "the computation was stopped"
FAULT = "kilter failed in this computation"
"""Sentence about a fault of kilter itself."""


@dataclass(slots=True, eq=False)
class QueuedJob:
    """A job of the worker process."""

    number: int
    state: int
    """Number of the state of the session to which the job belongs."""
    job: dict[str, Any]
    """The job, as `kilter.workbench.jobs` does it."""
    waiter: asyncio.Future[Any] | None = None
    """Future of a caller that waits for the result; None: the result goes to the pages."""
    tab: str = ""
    """Name of the tab that the job computes; empty for other jobs."""

    @property
    def about(self) -> str:
        """Name of the tab, or kind of the job."""
        return self.tab or str(self.job["job"])


class JobQueue:
    """The running job and the waiting jobs of a session.

    Arguments: `progress`: called with the running job, or None, and the words of its present stage.
    """

    def __init__(
        self,
        reopening: Callable[[], dict[str, Any]],
        result: Callable[[QueuedJob, str, Any], None],
        failed: Callable[[QueuedJob, InputError], None],
        progress: Callable[[QueuedJob | None, str], None],
    ) -> None:
        self.worker = WorkerProcess(self._hear)
        self._reopening, self._result = reopening, result
        self._failed, self._progress = failed, progress
        self._numbers = 0
        self._running: QueuedJob | None = None
        self._waiting: list[QueuedJob] = []
        self._has_file = False

    @property
    def is_idle(self) -> bool:
        """Whether no job runs."""
        return self._running is None

    def add(self, state: int, job: dict[str, Any], *, tab: str = "") -> None:
        """Queue a job whose result goes to the pages."""
        if job["job"] == "answer":
            self._drop(lambda waiting: waiting.waiter is None)
            if self._running is not None and self._running.waiter is None:
                self.worker.interrupt()
        else:
            self._drop(lambda waiting: waiting.tab == tab)
        self._queue(QueuedJob(0, state, job, tab=tab))

    async def result_of(self, state: int, job: dict[str, Any]) -> Any:
        """Queue a job and wait for its result.

        Raises `InputError` if the job fails or is stopped.
        """
        waiter: asyncio.Future[Any] = asyncio.get_running_loop().create_future()
        self._queue(QueuedJob(0, state, job, waiter))
        return await waiter

    def stop(self) -> None:
        """End the running job, and drop the waiting jobs."""
        self._drop(lambda waiting: True)
        self.worker.interrupt()

    def _drop(self, unwanted: Callable[[QueuedJob], bool]) -> None:
        """Remove waiting jobs; their callers get an error."""
        for job in self._waiting:
            if unwanted(job) and job.waiter is not None and not job.waiter.done():
                job.waiter.set_exception(InputError(STOPPED))
        self._waiting = [job for job in self._waiting if not unwanted(job)]

    def _queue(self, job: QueuedJob) -> None:
        self._waiting.append(job)
        self._next()

    def _next(self) -> None:
        """Start the next job if none runs."""
        if self._running is not None or not self._waiting:
            return
        if not self._has_file and self._waiting[0].job["job"] != "open":
            self._waiting.insert(0, QueuedJob(0, self._waiting[0].state, self._reopening()))
        job = self._running = self._waiting.pop(0)
        self._numbers += 1
        job.number = self._numbers
        self._progress(job, "reading" if job.job["job"] == "open" else "")
        self.worker.start(job.number, job.job)

    def _hear(self, number: int, kind: str, data: Any) -> None:
        """Take a message of the worker process."""
        if kind in ENDED:
            self._has_file = False
        job = self._running
        if job is None or number != job.number:
            return
        if kind == "progress":
            self._progress(job, data)
        elif kind in (*LAST, *ENDED):
            self._finish(job, kind, data)
        else:
            self._has_file = self._has_file or kind == "opened"
            if job.waiter is None:
                self._result(job, kind, data)
            elif not job.waiter.done():
                job.waiter.set_result(data)

    def _finish(self, job: QueuedJob, kind: str, data: Any) -> None:
        """End a job: report a failure to its caller or to the pages, and start the next job."""
        self._running = None
        self._progress(None, "")
        error = _failure(kind, data)
        if job.waiter is None:
            if error is not None:
                self._failed(job, error)
        elif not job.waiter.done():
            job.waiter.set_exception(error or InputError(STOPPED))
        self._next()


def _failure(kind: str, data: Any) -> InputError | None:
    """The error that ended a job; None if it ended without an error."""
    if kind == "error":
        return InputError(data["error"], hint=data["hint"])
    if kind == "fault":
        last = str(data).strip().splitlines()[-1] if data else ""
        return InputError(f"{FAULT}: {last}"[:300], hint="run 'kilter check' on the saved choices")
    if kind == "lost":
        return InputError(
            "the computing process ended unexpectedly; it was started again", hint="try again"
        )
    if kind in ("stopped", "killed"):
        return InputError(STOPPED, hint="change something, or start it again")
    return None
