"""Wavefront OBJ: vertices and polygons under the names of objects or groups.

Read here and not by a library, since polygons of more than three corners may be concave and
faulty lines must be named. Materials, texture coordinates and normals are passed over, so a
material library that is absent does not matter. Names come from ``o`` lines; where there are
none, from ``g`` lines, and a group that is taken up again goes on.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from kilter.errors import InputError
from kilter.files.accuracy import text_accuracy
from kilter.shape.primitives import Mesh

__all__ = ["read_obj"]


@dataclass(slots=True)
class _Reading:
    """What was read so far; faces by object, corners counted from 0."""

    vertices: list[list[float]] = field(default_factory=list)
    faces: dict[tuple[str, int], list[list[int]]] = field(default_factory=dict)
    not_finite: dict[int, int] = field(default_factory=dict)
    farthest: tuple[int, int, str] = (-1, 0, "")


def read_obj(data: bytes) -> list[tuple[str | None, Mesh]]:
    """The objects of an OBJ file that have faces, with their names.

    Raises
    ------
    InputError
        If a line cannot be read, a vertex is not finite, or a face names a vertex that is
        not there; it names the object and the line.

    Examples
    --------
    >>> text = b"o tip\\nv 0 0 0\\nv 1 0 0\\nv 0 1 0\\nv 0 0 1\\nf 1 3 2\\nf -4 -3 -1\\n"
    >>> read_obj(text + b"f 2/1/1 3/1/1 4/1/1\\nf 1//1 4//1 3//1")
    [('tip', Mesh(4 vertices, 4 triangles))]
    """
    text = _decoded(data)
    reading = _Reading()
    by_object = any(line.startswith("o ") for _, line in _lines(text))
    name, serial = "", 0
    for number, line in _lines(text):
        key, _, rest = line.partition(" ")
        if key == "v":
            _add_vertex(reading, rest.split(), number, name)
        elif key == "f":
            _add_face(reading, (name, serial), rest.split(), number)
        elif key == ("o" if by_object else "g"):
            name = rest.strip()
            serial += by_object
    return _meshes(reading)


def _decoded(data: bytes) -> str:
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("latin-1")


def _lines(text: str) -> Iterator[tuple[int, str]]:
    """Numbered lines without comments; a backslash at the end joins the next."""
    joined, start = "", 0
    for number, raw in enumerate(text.split("\n"), start=1):
        line = raw.strip().replace("\t", " ")
        if not line.startswith(("o ", "g ")):  # a name may have the sign of a comment
            line = line.split("#", 1)[0].rstrip()
        start = start or number
        if line.endswith("\\"):
            joined += line[:-1] + " "
            continue
        if joined or line:
            yield start, joined + line
        joined, start = "", 0
    if joined:
        yield start, joined


def _add_vertex(reading: _Reading, tokens: list[str], number: int, name: str) -> None:
    try:
        vertex = [float(token) for token in tokens[:3]]
    except ValueError:
        vertex = []
    if len(vertex) != 3:
        raise InputError(
            f"line {number}: vertex is {' '.join(tokens)[:60]!r}",
            part=name or None,
            hint="give three numbers",
        )
    if not all(map(math.isfinite, vertex)):
        reading.not_finite[len(reading.vertices)] = number
    reading.vertices.append(vertex)


def _add_face(reading: _Reading, key: tuple[str, int], tokens: list[str], number: int) -> None:
    count = len(reading.vertices)
    try:
        corners = [int(token.split("/", 1)[0]) for token in tokens]
    except ValueError:
        corners = []
    if len(corners) < 3:
        raise InputError(
            f"line {number}: face is {' '.join(tokens)[:60]!r}",
            part=key[0] or None,
            hint="name three or more vertices by number",
        )
    for k, corner in enumerate(corners):
        if corner == 0 or corner < -count:
            raise _no_vertex(number, corner, count, key[0])
        corners[k] = corner - 1 if corner > 0 else count + corner
    if max(corners) > reading.farthest[0]:  # vertices may follow the faces that use them
        reading.farthest = (max(corners), number, key[0])
    reading.faces.setdefault(key, []).append(corners)


def _no_vertex(number: int, corner: int, count: int, name: str) -> InputError:
    return InputError(
        f"line {number}: face names vertex {corner}, there are {count}",
        part=name or None,
        hint=f"vertices count from 1 to {count}, or back from -1",
    )


def _meshes(reading: _Reading) -> list[tuple[str | None, Mesh]]:
    corner, number, name = reading.farthest
    if corner >= len(reading.vertices):
        raise _no_vertex(number, corner + 1, len(reading.vertices), name)
    vertices = np.array(reading.vertices, dtype=np.float64).reshape(-1, 3)
    accuracy = text_accuracy(vertices)
    result: list[tuple[str | None, Mesh]] = []
    for (name, _), faces in reading.faces.items():
        used, compact = np.unique(np.concatenate([np.array(f) for f in faces]), return_inverse=True)
        _check_finite(reading, used.tolist(), name)
        ends = np.cumsum([len(face) for face in faces])[:-1]
        if len(compact) == 3 * len(faces):
            own: object = compact.reshape(-1, 3)
        else:
            own = [piece.tolist() for piece in np.split(compact, ends)]
        mesh = Mesh(vertices[used], own, accuracy=accuracy(vertices[used]))
        result.append((name or None, mesh))
    _check_finite(reading, list(reading.not_finite), "")
    return result


def _check_finite(reading: _Reading, used: list[int], name: str) -> None:
    if not reading.not_finite:
        return
    for k in used:
        if k in reading.not_finite:
            raise InputError(
                f"line {reading.not_finite[k]}: vertex {k + 1} is {reading.vertices[k]}",
                part=name or None,
                hint="give finite coordinates",
            )
