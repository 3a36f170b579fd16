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

from kilter.errors import InputError, shell_words

__all__ = ["is_restricted", "only_below", "require_below", "start_folder"]

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
