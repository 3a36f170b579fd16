"""What a file may ask for: memory, time and places of reading are bounded, and the bound is said.

    bytes        of a file, and of what a zip in it unfolds to, `MOST_BYTES`
    fold         bytes out of a zip over bytes in it, `MOST_FOLD` (above 16 MB)
    entries      tags and attributes of an XML, `MOST_ENTRIES`: 0.1 kB of memory for each
    triangles    of all bodies, each as often as it stands somewhere, `MOST_TRIANGLES`

A few bytes can name one mesh a million times, so triangles are counted while they are placed. A
file that is named in another is a plain one, in the folder of that one.
"""

from __future__ import annotations

import os
import stat
from pathlib import Path

from kilter.errors import InputError

__all__ = [
    "MOST_BYTES",
    "MOST_ENTRIES",
    "MOST_FOLD",
    "MOST_TRIANGLES",
    "Tally",
    "named_path",
    "require_few_entries",
    "require_unfolded",
]

MOST_BYTES = 1_000_000_000
"""Bytes of one file."""
MOST_FOLD = 200
"""Bytes that come out of a zip for each that is in it: XML of meshes has 5 to 40."""
SMALL = 16_000_000
"""Bytes that may come out of any zip."""
MOST_ENTRIES = 24_000_000
"""Tags and attributes of an XML text: six million corners and triangles."""
MOST_TRIANGLES = 10_000_000
"""Triangles of all bodies of a file; what is asked of them takes a kilobyte for each."""


class Tally:
    """A count that stops where it is beyond a bound.

    Examples
    --------
    >>> corners = Tally("corners", 10)
    >>> corners.add(7)
    >>> corners.add(7)
    Traceback (most recent call last):
    ...
    kilter.errors.InputError: it asks for more than 10 corners; make it coarser, or ...
    """

    def __init__(self, what: str = "triangles", most: int = MOST_TRIANGLES) -> None:
        self.what = what
        self.most = most
        self.count = 0

    def add(self, count: int) -> None:
        """Count so many more.

        Raises
        ------
        InputError
            If they are too many.
        """
        self.count += count
        if self.count > self.most:
            raise InputError(
                f"it asks for more than {self.most:,} {self.what}",
                hint="make it coarser, or read it in pieces",
            )


def require_unfolded(size: int, held: int) -> None:
    """Refuse a zip of `held` bytes from which `size` bytes would come.

    Raises
    ------
    InputError
        If that is too much.
    """
    most = min(max(SMALL, MOST_FOLD * held), MOST_BYTES)
    if size > most:
        raise InputError(
            f"{size / 1e6:,.0f} MB would come out of a zip of {held / 1e6:,.1f} MB, up to "
            f"{most / 1e6:,.0f} MB are read",
            hint="a file of such a ratio is damaged or made to do harm",
        )


def require_few_entries(text: bytes) -> None:
    """Refuse an XML text of more tags and attributes than are read, or with a DTD.

    Raises
    ------
    InputError
        If it is one.
    """
    if b"<!DOCTYPE" in text[:100_000]:
        raise InputError(
            "its XML defines entities (<!DOCTYPE)", hint="take the definition of a document out"
        )
    count = text.count(b"<") + text.count(b"=")
    if count > MOST_ENTRIES:
        raise InputError(
            f"its XML has {count:,} tags and attributes, up to {MOST_ENTRIES:,} are read",
            hint="make its meshes coarser, or write them as STL",
        )


def named_path(folder: Path, name: str, top: Path | None = None) -> Path:
    """The path of a file that another file names, which stands in `folder`.

    Parameters
    ----------
    top : Path, optional
        The folder that it may not leave, links followed; `folder` where not given.

    Raises
    ------
    InputError
        If the path leads out, or to what is no plain file: a device, a pipe.
    """
    path = folder / name
    try:
        inside = os.path.realpath(path).startswith(
            os.path.join(os.path.realpath(top or folder), "")
        )
        kind = path.stat().st_mode if inside and path.exists() else stat.S_IFREG
    except (OSError, ValueError):  # what is wrong with it is said when it is read
        return path
    if not inside:
        raise InputError(
            f"{name!r:.80} leads out of the folder of the file",
            hint="put the file that is named beside it, or in a folder below",
        )
    if not stat.S_ISREG(kind):
        raise InputError(f"{name!r:.80} is no plain file", hint="name a file")
    return path
