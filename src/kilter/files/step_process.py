"""Run OCCT in a separate process, which starts early and is kept.

A damaged file may crash OCCT, or let it run without end. The process ends itself after more CPU
time than any valid file needs. The file is then read again. If OCCT was working on a solid, a
stand-in replaces that solid; otherwise a second failure rejects the file. Python and OCCT start in
the process, and the file is read ahead, while kilter loads its own modules. Therefore this module
imports nothing slow.

Requests and answers are pickled, each with its length before it. Only kilter's own process writes
them.
"""

from __future__ import annotations

import atexit
import contextlib
import gc
import os
import signal
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from kilter.errors import InputError
from kilter.pipes import can_start, end_process, end_with_parent, receive, send, start_process

if TYPE_CHECKING:
    from kilter.files.placed import FileBodies

__all__ = ["begin_early", "read_apart", "serve"]

Request = tuple[str, tuple[int, int], tuple[str, ...], set[int], float]
"""Path; its time of change and size; names to leave out; keys of the solids that crash OCCT; CPU
time allowed for a solid [s]."""
MEMORY = 16 << 30
"""Largest address space of the process [bytes]; a damaged file may demand more."""
BREAKDOWNS = 50
"""Number of solids of a file that may crash OCCT before the file is rejected."""


STALLS = 12.0
"""CPU time allowed for a solid, or for reading the file, independently of its size [s]."""
STALLS_PER_MEGABYTE = 12.0
"""CPU time allowed in addition for each megabyte [s/MB]; valid files need at most a fifth."""


class _Process:
    """A child process that reads STEP files one after the other."""

    def __init__(self) -> None:
        self.process = start_process(__name__)
        self.ahead: Request | None = None

    def ask_ahead(self, request: Request) -> None:
        """Send in advance the request that is likely to come next."""
        assert self.process.stdin is not None
        with contextlib.suppress(OSError):  # a crash is detected by the next `ask`
            send(self.process.stdin, request)
        self.ahead = request

    def ask(self, request: Request, tell: Callable[[str, int], None]) -> Any:
        """Send a request and return the answer; `tell` is called with each progress message.

        Raises
        ------
        EOFError
            If the process has ended.
        """
        incoming, outgoing = self.process.stdout, self.process.stdin
        assert incoming is not None
        assert outgoing is not None
        try:
            if request != self.ahead:
                send(outgoing, request)
            self.ahead = None
            while True:
                kind, value = receive(incoming)
                if kind != "step":
                    return kind, value
                tell(*value)
        except OSError:
            raise EOFError from None


_kept: list[_Process] = []


def begin_early(ahead: Path | None = None) -> None:
    """Start the child process early, and let it read the file `ahead` in advance."""
    if not _kept and can_start():
        _kept.append(_Process())
        atexit.register(_end)
        if ahead is not None:
            _kept[0].ask_ahead(_request(ahead, (), set()))


def _request(path: Path, without: tuple[str, ...], broken: set[int]) -> Request:
    """Request to the child process: read a STEP file, except the solids `without` and `broken`."""
    state = path.stat()
    most = STALLS + STALLS_PER_MEGABYTE * state.st_size / 2**20
    return str(path.absolute()), (state.st_mtime_ns, state.st_size), without, broken, most


def _end() -> None:
    """End the child process if it runs."""
    while _kept:
        end_process(_kept.pop().process)


def read_apart(path: Path, without: tuple[str, ...], progress: Callable[[str], None]) -> FileBodies:
    """Read the solids of a STEP file in a child process, which a crash of OCCT may end.

    Parameters
    ----------
    path : Path
    without : tuple of str
        Names, or globs, of solids that are left out.
    progress : callable
        Called with a description of each step.

    Raises
    ------
    InputError
        If the file is damaged.
    """
    if not can_start():
        from kilter.files.step_bodies import step_bodies

        return step_bodies(path, without, lambda stage, solid: progress(stage))
    broken: set[int] = set()
    at_work, again = -1, False

    def tell(stage: str, solid: int) -> None:
        nonlocal at_work
        at_work = solid
        progress(stage)

    while True:
        request = _request(path, without, broken)
        if _kept and _kept[0].ahead not in (None, request):
            _end()  # the process is reading another file ahead
        begin_early()
        try:
            kind, value = _kept[0].ask(request, tell)
        except EOFError:
            _end()
            if (at_work < 0 and again) or at_work in broken or len(broken) >= BREAKDOWNS:
                raise InputError(
                    "damaged STEP: OCCT crashes on it, or does not finish",
                    hint="export it again as STEP",
                ) from None
            if at_work >= 0:
                broken.add(at_work)
            at_work, again = -1, at_work < 0
            continue
        except BaseException:  # after an interrupt the next answer would be that of this request
            _end()
            raise
        if kind == "refused":
            what, part, hint = value
            raise InputError(what, part=part, hint=hint)
        if kind == "fault":
            raise RuntimeError(value)
        return value.make_read_only()  # type: ignore[no-any-return]


# the other process ----------------------------------------------------------------------------


def serve() -> None:
    """Main loop of the child process: answer requests until the input closes."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    incoming = os.fdopen(os.dup(0), "rb")
    outgoing = os.fdopen(os.dup(1), "wb")
    nothing = os.open(os.devnull, os.O_RDWR)
    for stream in (0, 1):  # discard the output of OCCT
        os.dup2(nothing, stream)
    end_with_parent()
    _bound_memory()
    with _without_collection():
        import OCP.STEPCAFControl  # noqa: F401  loaded before the first request

        from kilter.files.step_bodies import step_bodies

    while True:
        try:
            path, _, without, broken, most = receive(incoming)
        except EOFError:
            return

        def tell(stage: str, solid: int, most: float = most) -> None:
            _end_after(most)
            send(outgoing, ("step", (stage, solid)))

        answer: Any
        _end_after(most)
        try:
            answer = "read", step_bodies(Path(path), without, tell, broken)
        except InputError as error:
            answer = "refused", (error.what, error.part, error.hint)
        except Exception as error:
            answer = "fault", f"{type(error).__name__}: {error}"
        _end_after(0.0)
        send(outgoing, answer)


def _end_after(seconds: float) -> None:
    """Let the system end this process after a CPU time [s]; 0 removes the limit."""
    with contextlib.suppress(AttributeError):  # not every system has the timer
        signal.setitimer(signal.ITIMER_PROF, seconds)


def _bound_memory() -> None:
    """Limit the memory of this process to `MEMORY`."""
    with contextlib.suppress(ImportError, OSError, ValueError):  # not every system has the limit
        import resource

        limit, most = resource.getrlimit(resource.RLIMIT_AS)
        if limit == resource.RLIM_INFINITY or limit > MEMORY:
            resource.setrlimit(resource.RLIMIT_AS, (MEMORY, most))


@contextlib.contextmanager
def _without_collection() -> Iterator[None]:
    """Context manager that disables garbage collection, which slows the loading of OCCT."""
    gc.disable()
    try:
        yield
    finally:
        gc.freeze()
        gc.enable()
