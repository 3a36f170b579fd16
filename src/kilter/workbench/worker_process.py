"""The worker process as the session sees it: send a job, hear its messages, end it.

A thread reads the messages of the process and passes them to the event loop.
"""

from __future__ import annotations

import asyncio
import contextlib
import os
import signal
import subprocess
import threading
from collections.abc import Callable
from typing import Any

from kilter.pipes import end_process, receive, send, start_process

LAST = ("done", "stopped", "error", "fault")
"""Kinds of the last message about a job."""
ENDED = ("killed", "lost")
"""Kinds of the message that the process itself has ended."""
GRACE = 3.0
"""Time that an interrupted job has to stop; then the process is ended [s]."""
AGAIN = 0.3
"""Time after which a job that still runs is interrupted again [s]: the worker ignores a signal that
comes before it begins the job, or while it sends a message."""
MODULE = "kilter.workbench.worker"

Hear = Callable[[int, str, Any], None]


class WorkerProcess:
    """A process that does a single job at a time."""

    def __init__(self, hear: Hear) -> None:
        self._hear = hear
        self._loop = asyncio.get_running_loop()
        self._process: subprocess.Popen[bytes] | None = None
        self._timer: asyncio.TimerHandle | None = None
        self.running = 0
        """Number of the job that runs; 0 without a job."""

    @property
    def pid(self) -> int:
        """Process number; 0 before the first job and after the end."""
        return 0 if self._process is None else self._process.pid

    def start(self, number: int, job: dict[str, Any]) -> None:
        """Send a job; no other job may run."""
        assert not self.running
        if self._process is None:
            self._process = start_process(MODULE)
            threading.Thread(target=self._listen, args=(self._process,), daemon=True).start()
        self.running = number
        assert self._process.stdin is not None
        with contextlib.suppress(OSError):  # the listening thread reports a lost process
            send(self._process.stdin, (number, job))

    def interrupt(self) -> None:
        """Ask the running job to stop; after `GRACE` the process is ended."""
        if not self.running or self._process is None or self._timer is not None:
            return
        grace = GRACE if os.name == "posix" else 0.0  # elsewhere no signal can be sent
        self._timer = self._loop.call_later(grace, self._give_up)
        self._signal(self.running)

    def _signal(self, number: int) -> None:
        """Interrupt a job now, and again as long as it runs."""
        if os.name != "posix" or self._process is None:
            return
        if self._timer is not None and self.running == number:
            self._process.send_signal(signal.SIGINT)
            self._loop.call_later(AGAIN, self._signal, number)

    def end(self) -> None:
        """End the process, whatever it does."""
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None
        process, self._process, self.running = self._process, None, 0
        if process is not None:
            end_process(process)

    def _give_up(self) -> None:
        """End the process because its job did not stop, and report the job as stopped."""
        self._timer = None
        number = self.running
        self.end()
        if number:
            self._hear(number, "killed", None)

    def _listen(self, process: subprocess.Popen[bytes]) -> None:
        """Pass the messages of a process to the event loop until the process ends."""
        assert process.stdout is not None
        while True:
            try:
                message = receive(process.stdout)
            except (EOFError, OSError, ValueError):
                break
            self._call(self._take, process, message)
        self._call(self._gone, process)

    def _call(self, function: Callable[..., None], *given: Any) -> None:
        with contextlib.suppress(RuntimeError):  # the event loop has ended
            self._loop.call_soon_threadsafe(function, *given)

    def _take(self, process: subprocess.Popen[bytes], message: tuple[int, str, Any]) -> None:
        if process is not self._process:
            return
        number, kind, data = message
        if number == self.running and kind in LAST:
            self.running = 0
            if self._timer is not None:
                self._timer.cancel()
                self._timer = None
        self._hear(number, kind, data)

    def _gone(self, process: subprocess.Popen[bytes]) -> None:
        if process is not self._process:
            return  # it was ended on purpose
        number = self.running
        self.end()
        self._hear(number, "lost", None)
