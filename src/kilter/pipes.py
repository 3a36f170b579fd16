"""Worker processes: their start, values through pipes, and their end with the parent process."""

from __future__ import annotations

import contextlib
import pickle
import signal
import subprocess
import sys
from typing import IO, Any

_SERVE = "import sys; sys.path[:] = {path!r}; from {module} import serve; serve()"


def can_start() -> bool:
    """True if a Python process can be started; False inside a frozen program."""
    return bool(sys.executable) and not getattr(sys, "frozen", False)


def start_process(module: str) -> subprocess.Popen[bytes]:
    """Start a Python process that runs `serve` of a module, connected by pipes."""
    command = [sys.executable, "-c", _SERVE.format(path=sys.path, module=module)]
    pipe = subprocess.PIPE
    return subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=subprocess.DEVNULL)


def end_process(process: subprocess.Popen[bytes]) -> None:
    """Kill a worker process, close its pipes and wait for its end."""
    process.kill()
    for stream in (process.stdin, process.stdout):
        with contextlib.suppress(OSError):
            if stream is not None:
                stream.close()
    process.wait()


def end_with_parent() -> None:
    """On Linux, have this process killed when its parent ends, even if the parent is killed."""
    if sys.platform != "linux":
        return
    import ctypes

    ctypes.CDLL(None).prctl(1, signal.SIGKILL)  # PR_SET_PDEATHSIG


def send(stream: IO[bytes], value: Any) -> None:
    """Write a pickled value with its length to a pipe."""
    data = pickle.dumps(value, protocol=pickle.HIGHEST_PROTOCOL)
    stream.write(len(data).to_bytes(8, "little") + data)
    stream.flush()


def receive(stream: IO[bytes]) -> Any:
    """Read the next pickled value from a pipe.

    Raises `EOFError` if the other end is closed.
    """
    head = stream.read(8)
    if len(head) < 8:
        raise EOFError
    length = int.from_bytes(head, "little")
    data = stream.read(length)
    if len(data) < length:
        raise EOFError
    return pickle.loads(data)
