"""Bytes of a file or a stream, or one error that says why not."""

from __future__ import annotations

from pathlib import Path
from typing import BinaryIO

from kilter.errors import InputError, nearest_name
from kilter.files.limits import MOST_BYTES

__all__ = ["read_bytes"]


def read_bytes(path: Path) -> bytes:
    """The contents of a file.

    Raises
    ------
    InputError
        If it is missing, a folder, not readable, empty, or larger than is read.
    """
    try:
        with path.open("rb") as stream:
            data = bounded(stream, str(path))
    except FileNotFoundError:
        raise InputError("no such file", file=str(path), hint=_near(path)) from None
    except (OSError, ValueError) as error:
        raise InputError(
            f"cannot be read: {_why(error)}", file=str(path), hint="check the path and its rights"
        ) from None
    if not data:
        raise InputError("the file is empty", file=str(path), hint="give a file with contents")
    return data


def bounded(stream: BinaryIO, file: str) -> bytes:
    """All that a stream gives.

    Raises
    ------
    InputError
        If that is more than is read; it names the file.
    """
    data = stream.read(MOST_BYTES + 1)
    if len(data) > MOST_BYTES:
        raise InputError(
            f"larger than {MOST_BYTES / 1e9:g} GB, which is the most that is read",
            file=file,
            hint="make it coarser, or give it in pieces",
        )
    return data


def _why(error: OSError | ValueError) -> str:
    return getattr(error, "strerror", None) or str(error)


def _near(path: Path) -> str:
    """The file of the folder whose name is most like the missing one's, as a hint."""
    try:
        names = [entry.name for entry in path.parent.iterdir() if not entry.name.startswith(".")]
        near = nearest_name(path.name, names)
    except OSError:
        return "check the path; its folder cannot be read either"
    return f"did you mean {near!r}?" if near else "check the path"
