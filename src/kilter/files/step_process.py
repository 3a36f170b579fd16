"""OCCT in a process of its own, started as early as a STEP file is known of, and kept.

Over a damaged file OCCT may end the process that it is in, or now and then come to no end: past a
time of computing that no sound file takes the process ends itself. Then the file is read once more,
where a solid was at work with a stand-in for that solid, and else refused the second time. Python
and OCCT start in it, and the file is read ahead, while kilter loads what it needs itself: so this
module imports nothing that takes time.

Requests and answers are pickled, each with its length before it. Only our own process writes them.
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
from kilter.pipes import can_start, end_with_parent, ended, receive, send, started

if TYPE_CHECKING:
    from kilter.files.placed import FileBodies

__all__ = ["begin_early", "read_apart", "serve"]

Request = tuple[str, tuple[int, int], tuple[str, ...], set[int], float]
"""Path, when it was written and its size, names that are left out, solids that break OCCT down,
time of computing that one solid may take [s]."""
MEMORY = 16 << 30
"""Address space of the process, whatever a damaged file asks for [bytes]."""
BREAKDOWNS = 50
"""Solids of one file over which OCCT may break down before the file is given up."""


STALLS = 12.0
"""Time of computing that one solid, or what is read before them, may take at least [s]..."""
STALLS_PER_MEGABYTE = 12.0
"""... and for each megabyte of the file; sound files take a fifth of this at most [s]."""


class _Process:
    """A process that reads STEP files, one after the other."""

    def __init__(self) -> None:
        self.process = started(__name__)
        self.ahead: Request | None = None

    def ask_ahead(self, request: Request) -> None:
        """Have what is likely to be asked next under way."""
        assert self.process.stdin is not None
        with contextlib.suppress(OSError):  # broken down: that is seen when it is asked
            send(self.process.stdin, request)
        self.ahead = request

    def ask(self, request: Request, tell: Callable[[str, int], None]) -> Any:
        """The answer to a request.

        Raises
        ------
        EOFError
            If the process broke down.
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
    """Start the process, so that OCCT is there when a file is read, and read `ahead` at once."""
    if not _kept and can_start():
        _kept.append(_Process())
        atexit.register(_end)
        if ahead is not None:
            _kept[0].ask_ahead(_request(ahead, (), set()))


def _request(path: Path, without: tuple[str, ...], broken: set[int]) -> Request:
    state = path.stat()
    most = STALLS + STALLS_PER_MEGABYTE * state.st_size / 2**20
    return str(path.absolute()), (state.st_mtime_ns, state.st_size), without, broken, most


def _end() -> None:
    while _kept:
        ended(_kept.pop().process)


def read_apart(path: Path, without: tuple[str, ...], progress: Callable[[str], None]) -> FileBodies:
    """What a STEP file holds, read in the other process.

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
            _end()  # another file is being read
        begin_early()
        try:
            kind, value = _kept[0].ask(request, tell)
        except EOFError:
            _end()
            if (at_work < 0 and again) or at_work in broken or len(broken) >= BREAKDOWNS:
                raise InputError(
                    "damaged STEP: OCCT breaks down over it, or comes to no end",
                    hint="export it again as STEP",
                ) from None
            if at_work >= 0:
                broken.add(at_work)
            at_work, again = -1, at_work < 0
            continue
        except BaseException:  # interrupted half-way: what it would answer next is not asked
            _end()
            raise
        if kind == "refused":
            what, part, hint = value
            raise InputError(what, part=part, hint=hint)
        if kind == "fault":
            raise RuntimeError(value)
        return value.sealed()  # type: ignore[no-any-return]


# the other process ----------------------------------------------------------------------------


def serve() -> None:
    """Read files as they are asked for, until nobody asks any more."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    incoming = os.fdopen(os.dup(0), "rb")
    outgoing = os.fdopen(os.dup(1), "wb")
    nothing = os.open(os.devnull, os.O_RDWR)
    for stream in (0, 1):  # what OCCT prints goes nowhere
        os.dup2(nothing, stream)
    end_with_parent()
    _bound_memory()
    with _uncollected():
        import OCP.STEPCAFControl  # noqa: F401  loaded while nobody waits

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
    """Have the system end this process after so long a time of computing; 0: no more."""
    with contextlib.suppress(AttributeError):  # where there is no such limit
        signal.setitimer(signal.ITIMER_PROF, seconds)


def _bound_memory() -> None:
    """Have the system refuse this process more memory than any file may ask for."""
    with contextlib.suppress(ImportError, OSError, ValueError):  # where there is no such limit
        import resource

        limit, most = resource.getrlimit(resource.RLIMIT_AS)
        if limit == resource.RLIM_INFINITY or limit > MEMORY:
            resource.setrlimit(resource.RLIMIT_AS, (MEMORY, most))


@contextlib.contextmanager
def _uncollected() -> Iterator[None]:
    """No search for garbage among the many classes that are made while this lasts."""
    gc.disable()
    try:
        yield
    finally:
        gc.freeze()
        gc.enable()
