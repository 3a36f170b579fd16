"""Read STL, binary and ASCII: triangles without shared vertices.

A file is binary if its length agrees with the count in its header. Otherwise it is ASCII if it
begins with ``solid`` and has facets. An ASCII file may hold several solids with names.
"""

from __future__ import annotations

import re

import numpy as np
from numpy.typing import NDArray

from kilter.arrays import distinct_rows
from kilter.errors import InputError
from kilter.files.meshes.placed import text_accuracy
from kilter.shape.primitives import Mesh

HEADER = 84
"""Length of the header of a binary file, with the number of triangles [bytes]."""
TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("extra", "<u2")])

_TRUNCATED = "export it again: it is incomplete or damaged"


def read_stl(data: bytes) -> tuple[list[tuple[str | None, Mesh]], list[str]]:
    """Read the meshes of an STL file, with the names of its solids, and notes.

    Returns `solids`: name and mesh; a single solid has the name None. Raises `InputError` if the
    file is incomplete, or neither binary nor ASCII STL.

    Examples
    --------
    >>> read_stl(bytes(80) + (2**32 - 1).to_bytes(4, "little") + bytes(50))
    Traceback (most recent call last):
    ...
    kilter.errors.InputError: the header states 4294967295 triangles, the file has 1; ...
    """
    count = int.from_bytes(data[80:HEADER], "little") if len(data) >= HEADER else -1
    exact = len(data) == HEADER + TRIANGLE.itemsize * count
    if not exact and re.match(rb"(?i)\s*solid\b", data) and b"facet" in data[:2000].lower():
        return _ascii_solids(data.decode("utf-8", "replace")), []
    if count < 0:
        raise InputError("not an STL file: too short", hint=_TRUNCATED)
    held = (len(data) - HEADER) // TRIANGLE.itemsize
    if held < count:
        raise InputError(
            f"the header states {count} triangles, the file has {held}", hint=_TRUNCATED
        )
    notes = [] if exact else ["bytes after the last triangle are ignored"]
    rows = np.frombuffer(data, dtype=TRIANGLE, count=count, offset=HEADER)
    return [(None, _merge_corners(rows["corners"].reshape(-1, 3), None))], notes


def _merge_corners(corners: NDArray[np.floating], accuracy: float | None) -> Mesh:
    """Build a mesh from triangles with three corners each; equal corners are merged.

    The corners keep their dtype while they are compared, so that float32 values stay equal.

    Arguments: `corners` (3 n, 3); `accuracy`: largest error of a coordinate [length unit].
    """
    if not np.isfinite(corners).all():
        row = int(np.flatnonzero(~np.isfinite(corners).all(axis=1))[0])
        raise InputError(
            f"triangle {row // 3} has the corner {corners[row].tolist()}",
            hint="give finite coordinates",
        )
    places, inverse = distinct_rows(corners + corners.dtype.type(0))
    return Mesh(places, inverse.reshape(-1, 3), accuracy=accuracy)


def _ascii_solids(text: str) -> list[tuple[str | None, Mesh]]:
    """Read the named meshes of an STL file in text form."""
    solids: list[tuple[str, list[str]]] = []
    loop: int | None = None  # count of numbers of the solid at the start of the facet
    inside = False
    for number, line in enumerate(text.split("\n"), start=1):
        word, _, rest = line.strip().partition(" ")
        word = word.lower()
        if word == "solid":
            solids.append((rest.strip(), []))
            inside = True
        elif word == "endsolid":
            inside = False
        elif word == "vertex" and solids:
            solids[-1][1].extend(_vertex(rest, number, solids[-1][0]))
        elif word in ("outer", "endloop") and solids:
            length = len(solids[-1][1])
            if word == "endloop" and loop is not None and length - loop != 9:
                raise InputError(
                    f"line {number}: a facet has {(length - loop) // 3} corners",
                    part=solids[-1][0] or None,
                    hint="STL facets have three corners",
                )
            loop = length if word == "outer" else None
    if inside:
        raise InputError(
            "the last solid has no 'endsolid'", part=solids[-1][0] or None, hint=_TRUNCATED
        )
    for name, numbers in solids:
        if len(numbers) % 9:
            raise InputError(
                f"{len(numbers) // 3} corners are not a multiple of 3", part=name or None,
                hint="STL facets have three corners",
            )  # fmt: skip
    return _named_meshes([solid for solid in solids if solid[1]])


def _vertex(rest: str, number: int, name: str) -> list[str]:
    """The three coordinates in a vertex line, as text; raises `InputError` if it is invalid."""
    tokens = rest.split()
    try:
        [float(token) for token in tokens]
    except ValueError:
        tokens = []
    if len(tokens) != 3:
        raise InputError(
            f"line {number}: vertex is {rest.strip()[:60]!r}",
            part=name or None,
            hint="give three numbers",
        )
    return tokens


def _named_meshes(solids: list[tuple[str, list[str]]]) -> list[tuple[str | None, Mesh]]:
    """Names and meshes of solids, from the coordinates of each as text."""
    values = [np.array(numbers, dtype=np.float64).reshape(-1, 3) for _, numbers in solids]
    if not values:
        return []
    exponent = sum("e" in token.lower() for token in solids[0][1]) * 2 > len(solids[0][1])
    accuracy = text_accuracy(np.concatenate(values), exponent=exponent)
    meshes: list[tuple[str | None, Mesh]] = []
    for (name, _), corners in zip(solids, values, strict=True):
        try:
            mesh = _merge_corners(corners, accuracy(corners))
        except InputError as error:
            raise error.located(part=name or None) from None
        meshes.append((name or None, mesh))
    return meshes if len(meshes) > 1 else [(None, meshes[0][1])]
