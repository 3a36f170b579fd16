"""OCCT in a process of its own, started when first needed and kept.

Over a damaged file OCCT may end the process that it is in. Then the file is refused, or, where a
solid was at work, the file is read once more with a stand-in for that solid. A process costs a
tenth of a second once, and Python and OCCT start in it while kilter loads what it needs itself.

Requests and answers are pickled, each with its length before it. Only our own process writes them.
"""

from __future__ import annotations

import atexit
import os
import pickle
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import IO, Any

from kilter.errors import InputError
from kilter.files.placed import FileBodies
from kilter.files.step_bodies import step_bodies

__all__ = ["begin_early", "read_apart", "serve"]

_SERVE = "import sys; sys.path[:] = {path!r}; from kilter.files.step_process import serve; serve()"
BREAKDOWNS = 50
"""Solids of one file over which OCCT may break down before the file is given up."""


class _Process:
    """A process that reads STEP files, one after the other."""

    def __init__(self) -> None:
        command = [sys.executable, "-c", _SERVE.format(path=sys.path)]
        self.process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL
        )

    def ask(self, request: Any, tell: Callable[[str, int], None]) -> Any:
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
            _send(outgoing, request)
            while True:
                kind, value = _receive(incoming)
                if kind != "step":
                    return kind, value
                tell(*value)
        except OSError:
            raise EOFError from None

    def end(self) -> None:
        """End the process."""
        for pipe in (self.process.stdin, self.process.stdout):
            assert pipe is not None
            pipe.close()
        self.process.kill()
        self.process.wait()


_kept: list[_Process] = []


def begin_early() -> None:
    """Start the process, so that OCCT is there when a file is read."""
    if not _kept and _can_start():
        _kept.append(_Process())
        atexit.register(_end)


def _end() -> None:
    while _kept:
        _kept.pop().end()


def _can_start() -> bool:
    """Whether Python can be started anew: not in a program that it is frozen into."""
    return bool(sys.executable) and not getattr(sys, "frozen", False)


def read_apart(path: Path, without: tuple[str, ...], progress: Callable[[str], None]) -> FileBodies:
    """What a STEP file holds, read in the other process.

    Raises
    ------
    InputError
        If the file is damaged.
    """
    if not _can_start():
        return step_bodies(path, without, lambda stage, solid: progress(stage))
    broken: set[int] = set()
    at_work = -1

    def tell(stage: str, solid: int) -> None:
        nonlocal at_work
        at_work = solid
        progress(stage)

    while True:
        begin_early()
        try:
            kind, value = _kept[0].ask((str(path.absolute()), without, broken), tell)
        except EOFError:
            _end()
            if at_work < 0 or at_work in broken or len(broken) >= BREAKDOWNS:
                raise InputError(
                    "damaged STEP: OCCT breaks down over it", hint="export it again as STEP"
                ) from None
            broken.add(at_work)
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
    _end_with_parent()
    import OCP.STEPCAFControl  # noqa: F401  loaded while nobody waits

    while True:
        try:
            path, without, broken = _receive(incoming)
        except EOFError:
            return

        def tell(stage: str, solid: int) -> None:
            _send(outgoing, ("step", (stage, solid)))

        answer: Any
        try:
            answer = "read", step_bodies(Path(path), without, tell, broken)
        except InputError as error:
            answer = "refused", (error.what, error.part, error.hint)
        except Exception as error:
            answer = "fault", f"{type(error).__name__}: {error}"
        _send(outgoing, answer)


def _end_with_parent() -> None:
    """Have Linux end this process with the one that started it, also where that is killed."""
    if sys.platform != "linux":
        return
    import ctypes

    ctypes.CDLL(None).prctl(1, signal.SIGKILL)  # PR_SET_PDEATHSIG


def _send(stream: IO[bytes], value: Any) -> None:
    data = pickle.dumps(value, protocol=pickle.HIGHEST_PROTOCOL)
    stream.write(len(data).to_bytes(8, "little") + data)
    stream.flush()


def _receive(stream: IO[bytes]) -> Any:
    head = stream.read(8)
    if len(head) < 8:
        raise EOFError
    length = int.from_bytes(head, "little")
    data = stream.read(length)
    if len(data) < length:
        raise EOFError
    return pickle.loads(data)
