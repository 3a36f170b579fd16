"""Read MJCF and USD scenes in a separate process, which starts early and is kept.

MuJoCo and USD print texts of their own, write logs into the current folder, and crash on some
damaged files. In the process the texts are discarded, the current folder is a temporary folder, and
CPU time and memory are limited. A crash ends the process only; it becomes an `InputError`.
"""

from __future__ import annotations

import atexit
import os
import signal
import sys
from collections.abc import Callable
from contextlib import nullcontext, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

from kilter.errors import InputError
from kilter.files.limits import only_below, start_folder
from kilter.files.reader_guard import (
    Answer,
    ReaderProcess,
    Request,
    allow_seconds,
    bound_memory,
    reader_guard,
    serve_requests,
)
from kilter.pipes import can_start
from kilter.threads import make_no_threads

if TYPE_CHECKING:
    from kilter.files.format_options import FormatOptions
    from kilter.files.objects.mujoco_snapshot import StateRows


LIBRARIES = {"mjcf": "MuJoCo", "usd": "USD", "why": "MuJoCo"}
"""Name of the library for each kind of scene."""
RAISES = {
    "mjcf": ("mujoco.FatalError", "mujoco.UnexpectedError"),
    "usd": ("pxr.Tf.ErrorException",),
    "why": ("mujoco.FatalError", "mujoco.UnexpectedError"),
}
"""Exceptions of each library for damaged files."""
MEMORY = 1_700_000_000
"""Largest memory of the process [bytes]."""
RESERVED = 16 << 30
"""Largest address space of the process [bytes], for systems that do not report its memory."""
STALLS = 12.0
"""CPU time allowed for a file, independently of its size [s]."""
STALLS_PER_MEGABYTE = 12.0
"""CPU time allowed in addition for each megabyte of a scene and its meshes [s/MB]."""

SIMULATION = 120.0
"""CPU time allowed in addition for simulations [s]."""

_kept: list[ReaderProcess] = []


def begin_early(kind: str, path: Path | None) -> None:
    """Start the process, and let it read a file, if any, ahead with the default options."""
    if not _kept and can_start():
        _begin()
        if path is not None:
            _kept[0].ask_ahead(_request(kind, path, None, None, None))


def is_mjcf(path: Path) -> bool:
    """Whether the first bytes of an XML file look like MJCF."""
    with path.open("rb") as stream:
        return b"<mujoco" in stream.read(4096)


def _begin() -> ReaderProcess:
    """The running process."""
    if _kept and not _kept[0].runs:
        _end()
    if not _kept:
        _kept.append(ReaderProcess(__name__))
        atexit.register(_end)
    return _kept[0]


def _end() -> None:
    """End the process if it runs."""
    while _kept:
        _kept.pop().end()


def _request(
    kind: str,
    path: Path,
    units: str | None,
    keyframe: str | None,
    states: StateRows | None,
    *more: Any,
) -> Request:
    """Request to the process; another state of the file is another request."""
    state = path.stat()
    changed = (state.st_mtime_ns, state.st_size)
    place = (str(path.absolute()), str(path), changed)
    seconds = _seconds(state.st_size) + (SIMULATION if kind == "why" else 0.0)
    return seconds, (kind, place, units, keyframe, states, start_folder(), *more)


def _seconds(size: int) -> float:
    """CPU time allowed for files with a number of bytes [s]."""
    return STALLS + STALLS_PER_MEGABYTE * size / 2**20


def read_scene(kind: str, path: Path, choices: FormatOptions) -> Any:
    """Read an MJCF or USD file, in a process that a crash may end.

    Returns the assembly of a USD file, or the MuJoCo model of an MJCF file. Raises `InputError` if
    the library is not installed, crashes or does not finish, or if the file is damaged.
    """
    return _ask(kind, path, choices)


def read_engine_state(path: Path, choices: FormatOptions, run: tuple[int, float]) -> Any:
    """Read the state of an MJCF file with the contacts of the engine.

    Arguments: `run`: time steps before the state is taken, and time of simulations after it [s].
    Raises `InputError` as `read_scene`, and for other files.
    """
    if path.is_file() and not is_mjcf(path):
        raise InputError(
            "this is no MJCF file, the format of MuJoCo", file=str(path), hint="give such a scene"
        )
    return _ask("why", path, choices, run)


def _ask(kind: str, path: Path, choices: FormatOptions, *more: Any) -> Any:
    """The answer of the process to a request."""
    from kilter.arrays import sealed

    try:
        request = _request(kind, path, choices.units, choices.keyframe, choices.states, *more)
    except FileNotFoundError:
        raise InputError("no such file", file=str(path), hint="check the path") from None
    except (OSError, ValueError) as error:
        raise InputError(f"cannot be read: {error}", file=str(path), hint="check it") from None
    if not can_start():
        return _read(lambda *size: None, *request[1])
    killed = False
    while True:
        if _kept and _kept[0].ahead not in (None, request):
            _end()  # the process is reading another file ahead
        process = _begin()
        try:
            value = process.ask(request, lambda: None, MEMORY)
        except EOFError:
            how = process.process.wait()
            _end()
            if process.too_large:
                raise _crash(
                    kind, path, f"takes more than {MEMORY / 1e9:g} GB of memory for it"
                ) from None
            # the end of the thread that started the process, or of the system's memory, kills it
            if how == -9 and not killed:
                killed = True
                continue
            seconds = f"does not finish within {request[0]:.0f} s"
            stalled = how == -getattr(signal, "SIGPROF", 0)
            raise _crash(kind, path, seconds if stalled else "crashes on it") from None
        except InputError:
            raise
        except BaseException:  # after an interrupt the next answer would be that of this request
            _end()
            raise
        else:
            return sealed(value)


def _crash(kind: str, path: Path, how: str) -> InputError:
    """Error for a file on which the library ended the process; `how` it ended."""
    return InputError(
        f"{LIBRARIES[kind]} {how}", file=str(path), hint="simplify it, or export it anew"
    )


# the other process ----------------------------------------------------------------------------


def serve() -> None:
    """Main function of the child process."""
    serve_requests(_load)


def _load() -> Answer:
    """Prepare the process, before a library is loaded, and return the reader."""
    make_no_threads()
    bound_memory(RESERVED)
    os.environ["MUJOCO_GL"] = "off"  # no module for drawing is loaded
    _leave_folder()
    return lambda tell, *arguments: _read(_allow_time, *arguments)


def _allow_time(size: int, more: float = 0.0) -> None:
    """Limit the CPU time of this process for files with a number of bytes."""
    allow_seconds(_seconds(size) + more)


def _leave_folder() -> None:
    """Make the current folder a new temporary folder, where libraries leave their logs."""
    import tempfile

    sys.path[:] = [os.path.abspath(place) for place in sys.path]
    folder = tempfile.mkdtemp()
    os.chdir(folder)
    with suppress(OSError):  # without the folder, no log can be written
        os.rmdir(folder)


def _read(
    allow_time: Callable[..., None],
    kind: str,
    place: tuple[str, str, tuple[int, int]],
    units: str | None,
    keyframe: str | None,
    states: StateRows | None,
    start: tuple[str, str] | None,
    *more: Any,
) -> Any:
    """Read a scene in this process.

    `allow_time` is called with the size of all files when the library is loaded. `place` has the
    absolute path, the path for messages, and the state of the file.
    """
    path, shown, _ = place
    with only_below(*start) if start else nullcontext(), reader_guard(shown, RAISES[kind]):
        if kind == "mjcf":
            from kilter.files.objects.mjcf_scenes import read_mjcf

            return read_mjcf(Path(path), keyframe, states, allow_time)
        if kind == "why":
            from kilter.files.objects.mjcf_states import read_state

            (run,) = more
            return read_state(
                Path(path), keyframe, states, run, lambda size: allow_time(size, SIMULATION)
            )
        from kilter.files.usd.usd_assembly import read_usd

        return read_usd(Path(path), shown, units, allow_time)
