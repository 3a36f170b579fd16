"""Read Wavefront OBJ: vertices and polygons under the names of objects or groups.

kilter has its own reader, since polygons of more than three corners may be concave and errors must
name the line. Materials, texture coordinates and normals are ignored, so a missing material
library does no harm. Names come from ``o`` lines; without any, from ``g`` lines, and faces of a
group may be in several places.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from kilter.errors import InputError
from kilter.files.meshes.placed import text_accuracy
from kilter.shape.primitives import Mesh


@dataclass(slots=True)
class _Content:
    """Vertices and faces of an OBJ file that have been read so far.

    `not_finite` maps the vertices that are not finite to their lines. `farthest` is the largest
    vertex that a face names, with its line and object.
    """

    vertices: list[list[float]] = field(default_factory=list)
    faces: dict[tuple[str, int], list[list[int]]] = field(default_factory=dict)
    not_finite: dict[int, int] = field(default_factory=dict)
    farthest: tuple[int, int, str] = (-1, 0, "")


def read_obj(data: bytes) -> list[tuple[str | None, Mesh]]:
    """Read the meshes of an OBJ file, with the names of its objects.

    Raises
    ------
    InputError
        If a line cannot be read, a vertex is not finite, or a face names a vertex that does
        not exist; the error names the object and the line.

    Examples
    --------
    >>> text = b"o tip\\nv 0 0 0\\nv 1 0 0\\nv 0 1 0\\nv 0 0 1\\nf 1 3 2\\nf -4 -3 -1\\n"
    >>> read_obj(text + b"f 2/1/1 3/1/1 4/1/1\\nf 1//1 4//1 3//1")
    [('tip', Mesh(4 vertices, 4 triangles))]
    """
    text = _decode(data)
    content = _Content()
    by_object = any(line.startswith("o ") for _, line in _lines(text))
    name, serial = "", 0
    for number, line in _lines(text):
        key, _, rest = line.partition(" ")
        if key == "v":
            _add_vertex(content, rest.split(), number, name)
        elif key == "f":
            _add_face(content, (name, serial), rest.split(), number)
        elif key == ("o" if by_object else "g"):
            name = rest.strip()
            serial += by_object
    return _meshes(content)


def _decode(data: bytes) -> str:
    """Decode the bytes of a file as UTF-8, or as Latin-1 if they are not UTF-8."""
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("latin-1")


def _lines(text: str) -> Iterator[tuple[int, str]]:
    """Yield numbered lines without comments; lines that end in a backslash are joined."""
    joined, start = "", 0
    for number, raw in enumerate(text.split("\n"), start=1):
        line = raw.strip().replace("\t", " ")
        if not line.startswith(("o ", "g ")):  # a name may contain #
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


def _add_vertex(content: _Content, tokens: list[str], number: int, name: str) -> None:
    """Add the vertex of line `number`; raises `InputError` if it is invalid."""
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
        content.not_finite[len(content.vertices)] = number
    content.vertices.append(vertex)


def _add_face(content: _Content, key: tuple[str, int], tokens: list[str], number: int) -> None:
    """Add the face of line `number` to an object; raises `InputError` if it is invalid."""
    count = len(content.vertices)
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
    if max(corners) > content.farthest[0]:  # vertices may follow the faces that use them
        content.farthest = (max(corners), number, key[0])
    content.faces.setdefault(key, []).append(corners)


def _no_vertex(number: int, corner: int, count: int, name: str) -> InputError:
    """Build the error for a face with the number of a vertex that does not exist."""
    return InputError(
        f"line {number}: the face names vertex {corner}, the file has {count}",
        part=name or None,
        hint=f"vertices are numbered from 1 to {count}, or backwards from -1",
    )


def _meshes(content: _Content) -> list[tuple[str | None, Mesh]]:
    """Names and meshes of all objects; raises `InputError` if a vertex is missing or invalid."""
    corner, number, name = content.farthest
    if corner >= len(content.vertices):
        raise _no_vertex(number, corner + 1, len(content.vertices), name)
    vertices = np.array(content.vertices, dtype=np.float64).reshape(-1, 3)
    accuracy = text_accuracy(vertices)
    result: list[tuple[str | None, Mesh]] = []
    for (name, _), faces in content.faces.items():
        used, compact = np.unique(np.concatenate([np.array(f) for f in faces]), return_inverse=True)
        _check_finite(content, used.tolist(), name)
        ends = np.cumsum([len(face) for face in faces])[:-1]
        if len(compact) == 3 * len(faces):
            polygons: object = compact.reshape(-1, 3)
        else:
            polygons = [piece.tolist() for piece in np.split(compact, ends)]
        mesh = Mesh(vertices[used], polygons, accuracy=accuracy(vertices[used]))
        result.append((name or None, mesh))
    _check_finite(content, list(content.not_finite), "")
    return result


def _check_finite(content: _Content, used: list[int], name: str) -> None:
    """Raise `InputError` if a vertex of a face has a coordinate that is not finite."""
    if not content.not_finite:
        return
    for k in used:
        if k in content.not_finite:
            raise InputError(
                f"line {content.not_finite[k]}: vertex {k + 1} is {content.vertices[k]}",
                part=name or None,
                hint="give finite coordinates",
            )
