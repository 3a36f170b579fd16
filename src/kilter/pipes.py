"""A process of one's own: its start, values to and from it, and its end with the one before."""

from __future__ import annotations

import contextlib
import pickle
import signal
import subprocess
import sys
from typing import IO, Any

__all__ = ["can_start", "end_with_parent", "ended", "receive", "send", "started"]

_SERVE = "import sys; sys.path[:] = {path!r}; from {module} import serve; serve()"


def can_start() -> bool:
    """Whether Python can be started anew: not in a program that it is frozen into."""
    return bool(sys.executable) and not getattr(sys, "frozen", False)


def started(module: str) -> subprocess.Popen[bytes]:
    """A process that runs the `serve` of a module, with pipes to it and from it."""
    command = [sys.executable, "-c", _SERVE.format(path=sys.path, module=module)]
    pipe = subprocess.PIPE
    return subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=subprocess.DEVNULL)


def ended(process: subprocess.Popen[bytes]) -> None:
    """End a process, whatever it is at."""
    process.kill()
    for stream in (process.stdin, process.stdout):
        with contextlib.suppress(OSError):
            if stream is not None:
                stream.close()
    process.wait()


def end_with_parent() -> None:
    """Have Linux end this process with the one that started it, also where that is killed."""
    if sys.platform != "linux":
        return
    import ctypes

    ctypes.CDLL(None).prctl(1, signal.SIGKILL)  # PR_SET_PDEATHSIG


def send(stream: IO[bytes], value: Any) -> None:
    """A value, whole."""
    data = pickle.dumps(value, protocol=pickle.HIGHEST_PROTOCOL)
    stream.write(len(data).to_bytes(8, "little") + data)
    stream.flush()


def receive(stream: IO[bytes]) -> Any:
    """The next value.

    Raises
    ------
    EOFError
        If the other end is closed.
    """
    head = stream.read(8)
    if len(head) < 8:
        raise EOFError
    length = int.from_bytes(head, "little")
    data = stream.read(length)
    if len(data) < length:
        raise EOFError
    return pickle.loads(data)
