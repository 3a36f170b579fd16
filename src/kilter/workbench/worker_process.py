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
import traceback
from collections.abc import Callable
from types import FrameType
from typing import Any

from kilter.errors import InputError, KilterError
from kilter.pipes import end_process, end_with_parent, receive, send, start_process

__all__ = ["ENDED", "LAST", "WorkerProcess", "serve"]


# The worker process of the workbench: it does a single job at a time.


class _Interruption:
    """Turns SIGINT into KeyboardInterrupt while a job runs; between jobs it is ignored.

    `heard`: the present job was interrupted.
    """

    def __init__(self) -> None:
        self.working = self.heard = False

    def hear(self, number: int, frame: FrameType | None) -> None:
        """Handle SIGINT."""
        if self.working:
            self.working = False  # a second signal must not interrupt the report about the first
            self.heard = True
            raise KeyboardInterrupt


def serve() -> None:
    """Do the jobs that arrive at standard input until it is closed."""
    interruption = _Interruption()
    signal.signal(signal.SIGINT, interruption.hear)
    incoming, outgoing = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # output printed by a solver must not mix with the answers
    end_with_parent()
    threading.Thread(target=_import_slow_packages, daemon=True).start()
    from kilter.workbench.jobs import Jobs

    jobs = Jobs()
    send(outgoing, (0, "ready", None))
    while True:
        try:
            number, job = receive(incoming)
        except EOFError:
            return
        send(outgoing, _run(jobs, number, job, outgoing, interruption))


def _import_slow_packages() -> None:
    """Import packages that answers need late, while the file is read.

    Otherwise the first answer with friction takes half a second longer. This is a thread, as a
    signal that interrupts a job must not interrupt an import.
    """
    from scipy import optimize, spatial  # noqa: F401
    from scipy.sparse import csgraph, linalg  # noqa: F401


def _run(
    jobs: Any, number: int, job: dict[str, Any], outgoing: Any, interruption: _Interruption
) -> tuple[int, str, Any]:
    """Run a job; return the last message about it."""

    def report(kind: str, data: Any) -> None:
        working, interruption.working = interruption.working, False  # a message is sent whole
        send(outgoing, (number, kind, data))
        interruption.working = working

    interruption.working, interruption.heard = True, False
    try:
        jobs.run(job, report)
    except KeyboardInterrupt:
        return number, "stopped", None
    except Exception as error:
        if interruption.heard:  # NumPy may raise an error of its own in place of the interruption
            return number, "stopped", None
        return number, *_failure(error)
    finally:
        interruption.working = False
    return number, "done", None


def _failure(error: Exception) -> tuple[str, Any]:
    """Kind and data of the last message about a job that ended by an error."""
    if isinstance(error, InputError):
        return "error", {"error": _sentence(error), "hint": error.option or error.hint}
    if isinstance(error, KilterError):
        return "error", {"error": str(error), "hint": ""}
    if isinstance(error, MemoryError):
        return "error", {"error": "the memory of this machine does not suffice", "hint": ""}
    return "fault", "".join(traceback.format_exception(error))


def _sentence(error: InputError) -> str:
    """The error as a sentence, with file and part and without the remedy."""
    return str(InputError(error.what, file=error.file, part=error.part))


LAST = ("done", "stopped", "error", "fault")
"""Kinds of the last message about a job."""
ENDED = ("killed", "lost")
"""Kinds of the message that the process itself has ended."""
GRACE = 3.0
"""Time that an interrupted job has to stop; then the process is ended [s]."""
AGAIN = 0.3
"""Time after which a job that still runs is interrupted again [s]: the worker ignores a signal that
comes before it begins the job, or while it sends a message."""
MODULE = "kilter.workbench.worker_process"

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
