"""The worker process of the workbench: it does a single job at a time.

An interruption ends the job.

The process keeps the file and its contacts from job to job (`kilter.workbench.jobs`). Messages are
pickled tuples through pipes: to the worker (number, job), from the worker (number, kind, data). The
last message about a job has the kind "done", "stopped", "error" or "fault".
"""

from __future__ import annotations

import os
import signal
import threading
import traceback
from types import FrameType
from typing import Any

from kilter.errors import InputError, KilterError
from kilter.pipes import end_with_parent, receive, send


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
