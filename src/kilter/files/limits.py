"""Bounds on the memory, time and paths that a file may demand; the error states the bound.

    bytes        size of a file, and of the contents of a zip in it, `MOST_BYTES`;
                 of a table or a list in a text file, `MOST_TABLE_BYTES`
    fold         size of the contents of a zip / size of the zip, `MOST_FOLD` (above 16 MB)
    entries      tags and attributes of an XML text, `MOST_ENTRIES`: 0.1 kB of memory for each
    values       values of a JSON text, `MOST_VALUES`
    parts        parts of a list of boxes or bricks, `MOST_LISTED`; of a scene, `MOST_PARTS`
    depth        models, nodes or components within others, `DEEPEST`
    triangles    triangles of all bodies, counted once for each instance, `MOST_TRIANGLES`

A few bytes can place a mesh a million times, so triangles are counted while they are placed. A
file that another file names must be a regular file in the folder of that file, or below.
"""

from __future__ import annotations

import json
import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple

from kilter.errors import InputError, nearest_name, shell_words

# Detect changes of the files of an assembly by their times and sizes.


Stamp = tuple[str, int, int]
"""Path, time of the last change [ns] and size [bytes] of a file."""


def fingerprint(file: str) -> tuple[Stamp, ...]:
    """Modification times and sizes of the files of an assembly, by which a change is noticed.

    The files are those in a folder, or a file and the meshes and STEP files that its JSON names.
    Missing files are left out, so that a file that reappears is a change.
    """
    path = Path(file)
    if path.is_dir():
        files = sorted(p for p in path.iterdir() if p.is_file())
    else:
        files = [path, *_named_in(path)]
    return tuple(stamp for name in files if (stamp := _stamp(name)) is not None)


def _stamp(path: Path) -> Stamp | None:
    """Path, modification time and size of a file; None if it is missing."""
    try:
        state = path.stat()
    except OSError:
        return None
    return str(path), state.st_mtime_ns, state.st_size


def _named_in(path: Path) -> list[Path]:
    """Paths of the mesh and STEP files that a JSON assembly file names."""
    if path.suffix.lower() != ".json":
        return []
    try:
        data: Any = json.loads(path.read_text(encoding="utf-8-sig"))
    except (OSError, ValueError, RecursionError):  # missing, half written, or nested too deeply
        return []
    parts = data.get("parts") if isinstance(data, dict) else None
    listed = [part for part in parts if isinstance(part, dict)] if isinstance(parts, list) else []
    named = [part.get(key) for part in listed for key in ("mesh", "step")]
    named.append(data.get("file") if isinstance(data, dict) else None)  # the file of choices
    # an inline mesh is no name
    return [path.parent / name for name in sorted({n for n in named if isinstance(n, str)})]


# Restriction of all reading to a folder, for a server that opens files on request.


SERVER = "give a file below the folder in which the server was started"
_START: ContextVar[tuple[str, str] | None] = ContextVar("start folder", default=None)


@contextmanager
def only_below(folder: str | Path, remedy: str = "") -> Iterator[None]:
    """Refuse all files outside of a folder while the context lasts, in this thread.

    Arguments: `remedy`: remedy in the error; "{folder}" in it becomes the folder above that also
    contains the file.

    Examples
    --------
    >>> with only_below("/tmp/scenes"):
    ...     require_below("/tmp/scenes/../secret.xml")
    Traceback (most recent call last):
    ...
    kilter.errors.InputError: /tmp/scenes/../secret.xml: outside of the start folder; give ...
    """
    token = _START.set((os.path.join(os.path.realpath(folder), ""), remedy))
    try:
        yield
    finally:
        _START.reset(token)


def start_folder() -> tuple[str, str] | None:
    """The folder to which reading is restricted, and the remedy; None without a restriction."""
    return _START.get()


def is_restricted() -> bool:
    """Whether only files below a start folder may be read."""
    return _START.get() is not None


def require_below(path: str | Path) -> None:
    """Raise an error if a file is outside of the start folder; without such a folder, do nothing.

    Raises `InputError` if the path, with symbolic links followed, is not below the start folder.
    """
    restriction = _START.get()
    if restriction is None:
        return
    start, remedy = restriction
    try:
        place = os.path.realpath(path)
        inside = os.path.join(place, "").startswith(start)
        above = os.path.commonpath([place, start])
    except (OSError, ValueError):  # also: another drive
        inside, above = False, os.sep
    if inside:
        return
    if not remedy:
        raise InputError("outside of the start folder", file=str(path), hint=SERVER)
    # a whole drive is never proposed
    hint = (
        "copy it" if os.path.dirname(above) == above else remedy.format(folder=shell_words([above]))
    )
    raise InputError("outside of the opened folder", file=str(path), hint=hint)


MOST_BYTES = 1_000_000_000
"""Largest size of a file that is read [bytes]."""
MOST_TABLE_BYTES = 50_000_000
"""Largest size of a table or a list in a text file [bytes]; a row needs ten times its bytes."""
MOST_FOLD = 200
"""Largest ratio of unpacked to packed size of a zip [-]: XML of meshes has 5 to 40."""
SMALL = 16_000_000
"""Unpacked size that is allowed for every zip, whatever its ratio [bytes]."""
MOST_ENTRIES = 24_000_000
"""Largest number of tags and attributes of an XML text: six million corners and triangles."""
MOST_VALUES = 20_000_000
"""Largest number of values of a JSON text: up to 0.1 kB of memory for each."""
MOST_LISTED = 100_000
"""Largest number of parts of a list of boxes or bricks, also if models are placed again."""
DEEPEST = 200
"""Largest depth of models, nodes or components within others."""
MOST_TRIANGLES = 10_000_000
"""Largest number of triangles of all bodies of a file; the analysis needs a kilobyte for each."""
MOST_PARTS = 50_000
"""Largest number of parts of a scene of a simulator, which a few bytes can multiply."""


class SceneCount(NamedTuple):
    """Number of parts and of all elements that a scene, or an element of it, makes."""

    parts: int = 0
    elements: int = 0

    def plus(self, other: SceneCount, times: int = 1) -> SceneCount:
        """The sum with another count, taken `times` times."""
        return SceneCount(self.parts + times * other.parts, self.elements + times * other.elements)


class Tally:
    """A counter that raises an error when it exceeds a limit.

    Examples
    --------
    >>> corners = Tally("corners", 10)
    >>> corners.add(7)
    >>> corners.add(7)
    Traceback (most recent call last):
    ...
    kilter.errors.InputError: the file has more than 10 corners; make it coarser, or ...
    """

    def __init__(self, what: str = "triangles", most: int = MOST_TRIANGLES) -> None:
        self.what = what
        self.most = most
        self.count = 0

    def add(self, count: int) -> None:
        """Add a number to the counter; raises an error beyond the limit.

        Raises `InputError` if the count is then above the bound.
        """
        self.count += count
        if self.count > self.most:
            raise InputError(
                f"the file has more than {self.most:,} {self.what}",
                hint="make it coarser, or read it in pieces",
            )


def require_unfolded(size: int, held: int) -> None:
    """Verify that a zip file of `held` bytes does not unpack to too many bytes (`size`).

    Raises `InputError` if the unpacked size is above the bound.
    """
    most = min(max(SMALL, MOST_FOLD * held), MOST_BYTES)
    if size > most:
        raise InputError(
            f"a zip of {held / 1e6:,.1f} MB unpacks to {size / 1e6:,.0f} MB; the limit is "
            f"{most / 1e6:,.0f} MB",
            hint="the file is damaged or malicious: export it anew",
        )


def require_few_entries(text: bytes) -> None:
    """Verify that an XML text is not too large for the reader, and has no DTD.

    Raises `InputError` if it has more tags and attributes, or a DTD.
    """
    if b"<!DOCTYPE" in text[:100_000]:
        raise InputError(
            "its XML has a document type definition (<!DOCTYPE)", hint="remove the definition"
        )
    count = text.count(b"<") + text.count(b"=")
    if count > MOST_ENTRIES:
        raise InputError(
            f"its XML has {count:,} tags and attributes; the limit is {MOST_ENTRIES:,}",
            hint="make its meshes coarser, or write them as STL",
        )


def named_path(folder: Path, name: str, top: Path | None = None) -> Path:
    """Path of a file named inside another file, after a check that it stays in the folder.

    Arguments: `top`: folder that the path may not leave, after following links; default `folder`.
    Raises `InputError` if the path leads out of `top`, or to a device or a pipe instead of a
    regular file.
    """
    path = folder / name
    require_below(path)
    try:
        inside = os.path.realpath(path).startswith(
            os.path.join(os.path.realpath(top or folder), "")
        )
    except (OSError, ValueError):  # reading the file will report the fault
        return path
    if not inside:
        raise InputError(
            f"{name!r:.80} leads out of the folder of the file",
            hint="put the named file beside it, or into a folder below",
        )
    require_regular(path)
    return path


def require_regular(path: Path) -> None:
    """Verify that a path is no device and no pipe, which may have no end; it need not exist.

    Raises `InputError` if it is a device, a pipe or a folder.
    """
    try:
        kind = path.stat().st_mode
    except (OSError, ValueError):  # reading the file will report the fault
        return
    if not stat.S_ISREG(kind):
        raise InputError(f"{path.name!r:.80} is not a regular file", hint="name a file")


def require_count(what: str, count: int, most: int) -> None:
    """Verify that a file does not make too many things; raises `InputError` beyond the limit.

    Examples
    --------
    >>> require_count("parts", 1_000_000, 50_000)
    Traceback (most recent call last):
    ...
    kilter.errors.InputError: the file would make 1,000,000 parts; the limit is 50,000
    """
    if count > most:
        number = f"{count:,}" if count < 10**15 else "more than 10^15"
        raise InputError(f"the file would make {number} {what}; the limit is {most:,}")


# Read the bytes of a file or a stream, or raise an `InputError` that states the reason.


def is_file(path: Path) -> bool:
    """Whether a path is a regular file; False if the system rejects the path."""
    try:
        return path.is_file()
    except (OSError, ValueError):  # a name of thousands of letters, or with a null
        return False


def is_folder(path: Path) -> bool:
    """Whether a path is a folder; False if the system rejects the path."""
    try:
        return path.is_dir()
    except (OSError, ValueError):
        return False


def read_bytes(path: Path, *, most: int = MOST_BYTES) -> bytes:
    """Read all bytes of a file, at most `most`; raises `InputError` if it cannot be read.

    Raises `InputError` if the path is missing, a folder, or not readable; or the file is empty or
    too large; or it is outside of the start folder.
    """
    require_below(path)
    try:
        with path.open("rb") as stream:
            data = read_bounded(stream, str(path), most)
    except FileNotFoundError:
        raise InputError("no such file", file=str(path), hint=_similar_name_hint(path)) from None
    except (OSError, ValueError) as error:
        raise InputError(
            f"cannot be read: {_why(error)}",
            file=str(path),
            hint="check the path and the permissions",
        ) from None
    if not data:
        raise InputError("the file is empty", file=str(path), hint="give a file with contents")
    return data


def read_bounded(stream: BinaryIO, file: str, most: int = MOST_BYTES) -> bytes:
    """Read a stream to its end; raises `InputError` if it has more than `most` bytes.

    Raises `InputError` if it is longer; the error names `file`.
    """
    data = stream.read(most + 1)
    if len(data) > most:
        size = f"{most / 1e9:g} GB" if most >= 1e9 else f"{most / 1e6:g} MB"
        raise InputError(
            f"larger than {size}, the largest size that is read",
            file=file,
            hint="make it coarser, or split it",
        )
    return data


def _why(error: OSError | ValueError) -> str:
    """The operating system's reason why a file cannot be read, without the path."""
    return getattr(error, "strerror", None) or str(error)


def _similar_name_hint(path: Path) -> str:
    """Hint for a missing file: the most similar file name in its folder, if any."""
    try:
        names = [entry.name for entry in path.parent.iterdir() if not entry.name.startswith(".")]
        near = nearest_name(path.name, names)
    except OSError:
        return "check the path; its folder cannot be read either"
    return f"did you mean {near!r}?" if near else "check the path"
