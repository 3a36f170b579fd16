"""Writing of kilter files: whole or not at all."""

from __future__ import annotations

import contextlib
import json
import os
import secrets
from pathlib import Path
from typing import Any

from kilter.assembly import Assembly, require_assembly
from kilter.errors import InputError
from kilter.files.kilter_json import to_dict

__all__ = ["dump", "to_text", "write_bytes", "write_text"]


UNDER_WAY: set[str] = set()
"""Files beside those that they will replace: who ends the process at once removes them."""


def dump(assembly: Assembly, path: str | Path) -> None:
    """The assembly written as a kilter file, one part a line.

    The text goes to a file beside `path`, which then takes its place: who reads sees the
    old file or the new one, and a failure leaves the old one.

    Raises
    ------
    InputError
        If the file cannot be written, or a name is no valid text.
    """
    require_assembly(assembly, "dump")
    try:
        text = to_text(assembly)
    except InputError as error:
        raise error.located(file=str(path)) from None
    write_text(path, text)


def to_text(assembly: Assembly) -> str:
    """The text of a kilter file, one part a line.

    Raises
    ------
    InputError
        If a name is no valid text.
    """
    try:
        return _text(to_dict(assembly))
    except ValueError as error:
        raise InputError(
            f"cannot be written: {error}"[:120],
            hint="give names of valid characters and finite numbers",
        ) from None


def write_text(path: str | Path, text: str) -> None:
    """A text file written in full or not at all.

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    try:
        data = text.encode("utf-8")
    except UnicodeEncodeError as error:
        raise InputError(
            f"cannot be written: {error}"[:120],
            file=str(path),
            hint="give names of valid characters",
        ) from None
    write_bytes(path, data)


def write_bytes(path: str | Path, data: bytes) -> None:
    """A file written in full or not at all.

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    target = Path(os.path.realpath(path))  # a link stays a link to the new file
    try:
        _replace(target, data)
    except OSError as error:
        raise InputError(
            f"cannot be written: {error.strerror or error}",
            file=str(path),
            hint="check the folder and its rights",
        ) from None


def _replace(target: Path, data: bytes) -> None:
    if target.is_dir():
        raise IsADirectoryError(None, "it is a folder")
    beside = str(target.with_name(f".{target.name[:40]}.{secrets.token_hex(8)}"))
    UNDER_WAY.add(beside)  # before it is there: who is interrupted knows of it
    try:
        with open(beside, "xb", opener=_for_its_owner) as stream:
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


def _for_its_owner(path: str, flags: int) -> int:
    return os.open(path, flags, 0o600)


def _mode(target: Path) -> int:
    """Rights of the file that is replaced, else those a new file gets."""
    if target.exists():
        return target.stat().st_mode & 0o777
    mask = os.umask(0)
    os.umask(mask)
    return 0o666 & ~mask


def _text(data: dict[str, Any]) -> str:
    lines = []
    for key, value in data.items():
        text = _json(value)
        if isinstance(value, list) and value and isinstance(value[0], dict):
            text = "[\n    " + ",\n    ".join(_json(entry) for entry in value) + "\n  ]"
        lines.append(f"  {_json(key)}: {text}")
    return "{\n" + ",\n".join(lines) + "\n}\n"


def _json(value: Any) -> str:
    return json.dumps(value, ensure_ascii=False, allow_nan=False)
