"""Interruption of the worker: a signal that it misses is sent again, and none after the job."""

from __future__ import annotations

import asyncio
import contextlib
import os
import signal
from typing import Any

import pytest

from kilter.workbench import worker, worker_process
from kilter.workbench.worker_process import WorkerProcess


class DeafProcess:
    """A process that misses every signal."""

    pid = 1

    def __init__(self) -> None:
        self.signals: list[int] = []

    def send_signal(self, number: int) -> None:
        """Record a signal."""
        self.signals.append(number)


@pytest.mark.skipif(os.name != "posix", reason="other systems end the process at once")
def test_a_job_that_misses_the_signal_is_interrupted_again(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(worker_process, "AGAIN", 0.01)
    process: Any = DeafProcess()

    async def counts() -> tuple[int, int, int]:
        worker = WorkerProcess(lambda number, kind, data: None)
        worker._process, worker.running = process, 7
        worker.interrupt()
        await asyncio.sleep(0.1)
        during = len(process.signals)
        worker.running = 8  # the job has ended, and another runs
        await asyncio.sleep(0.05)
        after = len(process.signals)
        await asyncio.sleep(0.1)
        assert worker._timer is not None
        worker._timer.cancel()
        return during, after, len(process.signals)

    during, after, later = asyncio.run(counts())
    assert during >= 2
    assert after == later
    assert set(process.signals) == {signal.SIGINT}


@pytest.mark.parametrize(("interrupted", "kind"), [(True, "stopped"), (False, "fault")])
def test_an_error_in_place_of_the_interruption_counts_as_a_stop(
    interrupted: bool, kind: str
) -> None:
    """NumPy replaces an interruption that comes while it compares types by a TypeError."""
    interruption = worker._Interruption()

    class Jobs:
        """Jobs that fail after an interruption was lost."""

        def run(self, job: dict[str, Any], report: Any) -> None:
            """Do a job."""
            if interrupted:
                with contextlib.suppress(KeyboardInterrupt):
                    interruption.hear(signal.SIGINT, None)
            raise TypeError("types cannot be compared")

    for number in (1, 2):
        assert worker._run(Jobs(), number, {}, None, interruption)[:2] == (number, kind)
    interrupted = False  # the interruption of a job does not concern the next job
    assert worker._run(Jobs(), 3, {}, None, interruption)[1] == "fault"
    assert not interruption.working
