"""Worker pool that judges the rows of a batch on a Dask cluster (extra `kilter[cluster]`).

The scheduler hands the tasks of a worker that died to others. If a task has killed several
workers, the scheduler gives up, and the task is returned as died.
"""

from __future__ import annotations

import queue
from typing import Any

from kilter.analysis.many.batch_rows import BatchQuestion, BatchRow, judged_rows
from kilter.analysis.many.batch_workers import Task
from kilter.errors import InputError

__all__ = ["ClusterWorkers"]

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
