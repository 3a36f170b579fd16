"""Restriction of all reading to a folder, for a server that opens files on request.

Inside ``with only_below(folder):`` every reader refuses a file that is not below the folder after
symbolic links are followed. This includes the files that a file names: meshes, included scenes,
and the layers of USD.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path

from kilter.errors import InputError

__all__ = ["is_restricted", "only_below", "require_below", "start_folder"]

_START: ContextVar[str | None] = ContextVar("start folder", default=None)


@contextmanager
def only_below(folder: str | Path) -> Iterator[None]:
    """Refuse all files outside of a folder while the context lasts, in this thread.

    Examples
    --------
    >>> with only_below("/tmp/scenes"):
    ...     require_below("/tmp/scenes/../secret.xml")
    Traceback (most recent call last):
    ...
    kilter.errors.InputError: /tmp/scenes/../secret.xml: outside of the start folder; give ...
    """
    token = _START.set(os.path.join(os.path.realpath(folder), ""))
    try:
        yield
    finally:
        _START.reset(token)


def start_folder() -> str | None:
    """The folder to which reading is restricted; None without a restriction."""
    return _START.get()


def is_restricted() -> bool:
    """Whether only files below a start folder may be read."""
    return _START.get() is not None


def require_below(path: str | Path) -> None:
    """Raise an error if a file is outside of the start folder; without such a folder, do nothing.

    Raises
    ------
    InputError
        If the path, with symbolic links followed, is not below the start folder.
    """
    start = _START.get()
    if start is None:
        return
    try:
        inside = os.path.join(os.path.realpath(path), "").startswith(start)
    except (OSError, ValueError):
        inside = False
    if not inside:
        raise InputError(
            "outside of the start folder",
            file=str(path),
            hint="give a file below the folder in which the server was started",
        )
