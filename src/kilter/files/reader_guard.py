"""Guard around a reader of another program's format: errors of damaged data are wrong input.

Readers meet damaged data in many places: in their own code, and in libraries that raise exceptions
of many kinds. The guard turns the exceptions of `DAMAGE` into an `InputError` with the library's
reason. All other exceptions pass, since they are faults of kilter itself.
"""

from __future__ import annotations

import contextlib
import gc
import os
import signal
import sys
import threading
from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from kilter.errors import InputError, visible
from kilter.pipes import end_process, end_with_parent, receive, send, start_process

DAMAGE = (
    ValueError,
    LookupError,
    ArithmeticError,
    EOFError,
    OSError,
    NotImplementedError,
    RecursionError,
)
"""Exceptions of Python that damaged data may cause in any reader. `TypeError`, `AttributeError`,
`AssertionError` and `RuntimeError` are absent: they are faults of kilter."""
LIBRARY_DAMAGE = frozenset(
    {
        "_csv.Error",
        "lzma.LZMAError",
        "_lzma.LZMAError",
        "scipy.spatial._qhull.QhullError",
        "shapely.errors.ShapelyError",
        "struct.error",
        "zipfile.BadZipFile",
        "zlib.error",
    }
)
"""Exceptions of libraries for damaged data, by name, since most readers do not load the library."""
ZIP_DAMAGE = frozenset({"builtins.RuntimeError", "xml.etree.ElementTree.ParseError"})
"""Further exceptions of a damaged zip of XML files: an encrypted member, invalid XML."""
LONGEST = 160
"""Largest length of a library's reason [characters]."""


@contextmanager
def reader_guard(file: str | Path, also: Collection[str] = ()) -> Iterator[None]:
    """Turn the exceptions of a damaged file into an `InputError` that names the file.

    Arguments: `also`: names of further exceptions that the reader of this format may raise, as
    "module.Class". Raises `InputError` if the reader raises it, or an exception of damaged data.

    Examples
    --------
    >>> with reader_guard("wall.csv"):
    ...     int("12a")
    Traceback (most recent call last):
    ...
    kilter.errors.InputError: wall.csv: the file is damaged: invalid literal for int() with ...
    """
    try:
        yield
    except InputError as error:
        raise error.located(file=str(file)) from None
    except BrokenPipeError:
        raise  # the reader of the answer has gone; the file is not damaged
    except Exception as error:
        if not _is_damage(error, also):
            raise
        raise InputError(
            f"the file is damaged: {reason_of(error)}", file=str(file), hint="export it anew"
        ) from error


def _is_damage(error: Exception, also: Collection[str]) -> bool:
    """Whether damaged data may raise this exception."""
    if isinstance(error, DAMAGE):
        return True
    names = {f"{kind.__module__}.{kind.__qualname__}" for kind in type(error).__mro__}
    return not names.isdisjoint(LIBRARY_DAMAGE) or not names.isdisjoint(also)


def reason_of(error: Exception) -> str:
    """The message of an exception as a clause in one line; the name of its type without a message.

    Examples
    --------
    >>> reason_of(ValueError("bad  \\x1b[2J\\n  number."))
    'bad \\\\x1b[2J number'
    >>> reason_of(KeyError())
    'KeyError'
    """
    words = getattr(error, "strerror", None) or str(error)  # without the path
    text = " ".join(words.split()).rstrip(".")
    return visible(text)[:LONGEST] or type(error).__name__


# Run a library that reads files in a separate process, which a damaged file may crash.


Request = tuple[float, tuple[Any, ...]]
"""CPU time allowed for each step of the reader [s], and the arguments of the reader."""
Answer = Callable[..., Any]
"""A reader: it is called with a progress function and the arguments of the request."""


BETWEEN = 0.05
"""Time between two measurements of the memory of a process [s]."""
PAGE = os.sysconf("SC_PAGE_SIZE") if hasattr(os, "sysconf") else 4096
"""Size of a page of memory [bytes]."""


class ReaderFault(Exception):
    """A fault of kilter itself in the process of a reader."""


class ReaderProcess:
    """A child process that reads files one after the other."""

    def __init__(self, module: str) -> None:
        self.process = start_process(module)
        self.ahead: Request | None = None
        self.too_large = False
        """Whether the process was ended since it took too much memory."""
        self._lock = threading.Lock()

    @property
    def runs(self) -> bool:
        """Whether the process has not ended."""
        return self.process.poll() is None

    def ask_ahead(self, request: Request) -> None:
        """Send in advance the request that is likely to come next."""
        assert self.process.stdin is not None
        with contextlib.suppress(OSError):  # a crash is detected by the next `ask`
            send(self.process.stdin, request)
        self.ahead = request

    def ask(
        self, request: Request, tell: Callable[..., None], most_memory: int | None = None
    ) -> Any:
        """Send a request and return the answer.

        Arguments: `most_memory`: memory above which the process is ended [bytes]. Raises `EOFError`
        if the process has ended. Raises `InputError` if the reader rejects the file. Raises
        `ReaderFault` if the reader has a fault.
        """
        with self._lock, self._watched(most_memory):
            kind, value = self._answer(request, tell)
        if kind == "refused":
            what, file, part, hint, option = value
            raise InputError(what, file=file, part=part, hint=hint, option=option)
        if kind == "fault":
            raise ReaderFault(value)
        return value

    def _answer(self, request: Request, tell: Callable[..., None]) -> tuple[str, Any]:
        """Kind of the answer to a request, and its content."""
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
        except (OSError, ValueError):  # a closed pipe
            raise EOFError from None

    @contextlib.contextmanager
    def _watched(self, most_memory: int | None) -> Iterator[None]:
        """End the process if it takes too much memory while the context lasts.

        A limit of the system would count memory that is reserved but not used.
        """
        done = threading.Event()

        def watch(most: int) -> None:
            while not done.wait(BETWEEN):
                if _resident(self.process.pid) > most:
                    self.too_large = True
                    self.process.kill()
                    return

        if most_memory is None:
            yield
            return
        watcher = threading.Thread(target=watch, args=(most_memory,), daemon=True)
        watcher.start()
        try:
            yield
        finally:
            done.set()
            watcher.join()

    def end(self) -> None:
        """End the process."""
        end_process(self.process)


def _resident(pid: int) -> int:
    """Memory of a process that is in use [bytes]; 0 if the system does not report it."""
    if sys.platform != "linux":
        return 0
    try:
        pages = int(Path(f"/proc/{pid}/statm").read_text("ascii").split()[1])
    except (OSError, ValueError, IndexError):
        return 0
    return pages * PAGE


# the other process ----------------------------------------------------------------------------


def serve_requests(load: Callable[[], Answer]) -> None:
    """Main loop of the child process: answer requests until the input closes.

    `load` imports the library and returns the reader.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    incoming = os.fdopen(os.dup(0), "rb")
    outgoing = os.fdopen(os.dup(1), "wb")
    nothing = os.open(os.devnull, os.O_RDWR)
    for stream in (0, 1):  # discard the output of the library
        os.dup2(nothing, stream)
    end_with_parent()
    with _without_collection():
        reader = load()
    while True:
        try:
            seconds, arguments = receive(incoming)
        except EOFError:
            return

        def tell(*step: Any, seconds: float = seconds) -> None:
            allow_seconds(seconds)
            send(outgoing, ("step", step))

        answer: Any
        allow_seconds(seconds)
        try:
            answer = "read", reader(tell, *arguments)
        except InputError as error:
            answer = "refused", (error.what, error.file, error.part, error.hint, error.option)
        except MemoryError:
            answer = "refused", (NO_MEMORY, None, None, NO_MEMORY_HINT, None)
        except Exception as error:
            answer = "fault", f"{type(error).__name__}: {error}{_place(error)}"
        allow_seconds(0.0)
        send(outgoing, answer)


NO_MEMORY = "reading it takes too much memory"
NO_MEMORY_HINT = "leave parts out, or use coarser meshes"


def _place(error: Exception) -> str:
    """File and line in which an exception was raised, for a report."""
    trace = error.__traceback__
    while trace is not None and trace.tb_next is not None:
        trace = trace.tb_next
    if trace is None:
        return ""
    return f" ({os.path.basename(trace.tb_frame.f_code.co_filename)}:{trace.tb_lineno})"


def allow_seconds(seconds: float) -> None:
    """Let the system end this process after a CPU time [s]; 0 removes the limit."""
    with contextlib.suppress(AttributeError):  # not every system has the timer
        signal.setitimer(signal.ITIMER_PROF, seconds)


def bound_memory(most: int) -> None:
    """Limit the address space of this process [bytes]."""
    with contextlib.suppress(ImportError, OSError, ValueError):  # not every system has the limit
        import resource

        _, hard = resource.getrlimit(resource.RLIMIT_AS)
        most = most if hard == resource.RLIM_INFINITY else min(most, hard)
        resource.setrlimit(resource.RLIMIT_AS, (most, hard))


@contextlib.contextmanager
def _without_collection() -> Iterator[None]:
    """Context manager that disables garbage collection, which slows the loading of a library."""
    gc.disable()
    try:
        yield
    finally:
        gc.freeze()
        gc.enable()
