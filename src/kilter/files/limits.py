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

import os
import stat
from pathlib import Path
from typing import NamedTuple

from kilter.errors import InputError
from kilter.files.start_folder import require_below

__all__ = [
    "DEEPEST",
    "MOST_BYTES",
    "MOST_ENTRIES",
    "MOST_FOLD",
    "MOST_LISTED",
    "MOST_PARTS",
    "MOST_TABLE_BYTES",
    "MOST_TRIANGLES",
    "MOST_VALUES",
    "SceneCount",
    "Tally",
    "named_path",
    "require_count",
    "require_few_entries",
    "require_regular",
    "require_unfolded",
]

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
