"""Values to and from a process of one's own, and its end with the one that started it."""

from __future__ import annotations

import pickle
import signal
import sys
from typing import IO, Any

__all__ = ["end_with_parent", "receive", "send"]


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
