"""Standard streams: replace closed streams by empty ones, and recognise full ones."""

from __future__ import annotations

import errno
import os
import sys

__all__ = ["is_full", "open_closed_streams"]

FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO, errno.EBADF)
"""Error numbers of the system if a stream accepts no more data."""


def open_closed_streams() -> None:
    """Replace standard streams that are closed at the start of the process by empty streams.

    Otherwise the first opened file would get the number of a closed stream, and the output of
    libraries.
    """
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, mode, encoding="utf-8"))  # noqa: SIM115


def is_full(error: OSError) -> bool:
    """Whether an error comes from a full disk or another stream that accepts no more data.

    Such an error names no file.
    """
    return error.filename is None and error.errno in FULL
