"""Read the bytes of a file or a stream, or raise an `InputError` that states the reason."""

from __future__ import annotations

from pathlib import Path
from typing import BinaryIO

from kilter.errors import InputError, nearest_name
from kilter.files.limits import MOST_BYTES
from kilter.files.start_folder import require_below

__all__ = ["is_file", "is_folder", "read_bytes"]


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
