"""Write kilter files and other files atomically: completely, or not at all.

A device, a pipe or a socket cannot be replaced: the text is written into it.
"""

from __future__ import annotations

import contextlib
import errno
import io
import json
import os
import secrets
import stat
from pathlib import Path
from typing import Any

import numpy as np

from kilter.arrays import Array
from kilter.assembly import Assembly, require_assembly
from kilter.errors import InputError
from kilter.files.own.kilter_json import to_dict
from kilter.values.guesses import guarded

UNDER_WAY: set[str] = set()
"""Paths of temporary files that are being written; an exit without cleanup has to remove them."""


@guarded
def dump(assembly: Assembly, path: str | Path) -> None:
    """Write an assembly to a kilter file (JSON), one part per line.

    A temporary file beside `path` is written first and then replaces it. A reader sees either the
    old file or the new file, and a failure leaves the old file.

    Raises
    ------
    InputError
        If the file cannot be written, or a name cannot be encoded.

    See Also
    --------
    kilter.save : the options with which a file is read.
    kilter.load : reads the written file.
    """
    require_assembly(assembly, "dump")
    try:
        text = to_text(assembly)
    except InputError as error:
        raise error.located(file=str(path)) from None
    write_text(path, text)


def to_text(assembly: Assembly) -> str:
    """The text of the kilter file of an assembly, one part per line.

    Raises `InputError` if a name cannot be encoded, or a number is not finite.
    """
    try:
        return json_lines(to_dict(assembly))
    except ValueError as error:
        raise InputError(
            f"cannot be written: {error}"[:120],
            hint="give names of valid characters and finite numbers",
        ) from None


def write_text(path: str | Path, text: str, *, links: bool = True) -> None:
    """Write a text file in UTF-8, completely or not at all; `links` as in `write_bytes`.

    Raises `InputError` if the file cannot be written.
    """
    try:
        data = text.encode("utf-8")
    except UnicodeEncodeError as error:
        raise InputError(
            f"cannot be written: {error}"[:120],
            file=str(path),
            hint="give names of valid characters",
        ) from None
    write_bytes(path, data, links=links)


def write_array(path: str | Path, values: Array) -> None:
    """Write an array to a NumPy file, completely or not at all.

    Raises `InputError` if the file cannot be written.
    """
    stream = io.BytesIO()
    np.save(stream, values, allow_pickle=False)
    write_bytes(path, stream.getvalue())


def write_bytes(path: str | Path, data: bytes, *, links: bool = True) -> None:
    """Write a binary file, completely or not at all.

    Raises `InputError` if the file cannot be written.
    """
    try:
        if not links:
            _require_plain(path)
            _replace(Path(path), data)  # a link that appears now is replaced, never followed
        elif _is_special(path):
            _write_into(path, data)
        else:
            target = Path(os.path.realpath(path))
            if target.is_symlink():
                raise OSError(errno.ELOOP, os.strerror(errno.ELOOP))
            _replace(target, data)
    except (OSError, ValueError) as error:  # ValueError: a null character in the name
        raise InputError(
            f"cannot be written: {getattr(error, 'strerror', None) or error}",
            file=str(path),
            hint="check the folder and its permissions",
        ) from None


def _is_special(path: str | Path) -> bool:
    """Whether a path leads to a device, a pipe or a socket."""
    try:
        mode = os.stat(path).st_mode
    except OSError:
        return False
    return not (stat.S_ISREG(mode) or stat.S_ISDIR(mode))


def _require_plain(path: str | Path) -> None:
    """Raise `InputError` if the path itself is a link, a device, a pipe or a socket."""
    try:
        mode = os.lstat(path).st_mode
    except FileNotFoundError:
        return
    if not (stat.S_ISREG(mode) or stat.S_ISDIR(mode)):
        kind = "a link, which is not followed" if stat.S_ISLNK(mode) else "no regular file"
        raise InputError(f"is {kind}", file=str(path), hint="remove it")


def _write_into(path: str | Path, data: bytes) -> None:
    """Write to a device or a pipe; an error follows if no program reads the pipe."""
    # without this flag, the opening of a pipe would wait for a reader without end
    handle = os.open(path, os.O_WRONLY | getattr(os, "O_NONBLOCK", 0))
    if hasattr(os, "set_blocking"):
        os.set_blocking(handle, True)
    with open(handle, "wb") as stream:
        stream.write(data)


def _replace(target: Path, data: bytes) -> None:
    """Replace a file by way of a temporary file, so that a failure leaves it intact."""
    if target.is_dir():
        raise IsADirectoryError(None, "it is a folder")
    beside = str(target.with_name(f".{target.name[:40]}.{secrets.token_hex(8)}"))
    UNDER_WAY.add(beside)  # before the file exists, so that an interrupt removes it
    try:
        with open(beside, "xb", opener=_open_private) as stream:
            stream.write(data)
            stream.flush()
            os.fsync(stream.fileno())
        os.chmod(beside, _mode(target))
        os.replace(beside, target)
    except BaseException:
        with contextlib.suppress(OSError):
            os.unlink(beside)
        raise
    finally:
        UNDER_WAY.discard(beside)


def _open_private(path: str, flags: int) -> int:
    """Open a file with the permission to read and write for its owner only."""
    return os.open(path, flags, 0o600)


def _mode(target: Path) -> int:
    """Permission bits for a written file: those of the replaced file, else the default."""
    if target.exists():
        return target.stat().st_mode & 0o777
    mask = os.umask(0)
    os.umask(mask)
    return 0o666 & ~mask


def json_lines(data: dict[str, Any]) -> str:
    """JSON text with one line for each key, and for each object of a list."""
    lines = []
    for key, value in data.items():
        text = _json(value)
        if isinstance(value, list) and value and isinstance(value[0], dict):
            text = "[\n    " + ",\n    ".join(_json(entry) for entry in value) + "\n  ]"
        lines.append(f"  {_json(key)}: {text}")
    return "{\n" + ",\n".join(lines) + "\n}\n"


def _json(value: Any) -> str:
    """JSON text of a value in a single line; raises `ValueError` for infinity or NaN."""
    return json.dumps(value, ensure_ascii=False, allow_nan=False)
