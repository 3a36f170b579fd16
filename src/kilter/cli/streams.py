"""The streams of a process: closed ones give and take nothing, and one that is full is said."""

from __future__ import annotations

import errno
import os
import sys

__all__ = ["is_full", "open_closed_streams"]

FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO, errno.EBADF)
"""How writing ends that finds no room."""


def open_closed_streams() -> None:
    """Streams that were closed before the process began, opened on nothing.

    Else the first file that is opened would take their place, and get what a library prints.
    """
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, mode, encoding="utf-8"))  # noqa: SIM115


def is_full(error: OSError) -> bool:
    """Whether a stream, which has no name, took no more."""
    return error.filename is None and error.errno in FULL
