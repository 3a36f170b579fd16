"""Read OFF files (.off) as OBJ: the same corners and polygons in another order of words.

trimesh rejects polygons with more than four corners. The reader of OBJ cuts every polygon.
"""

from __future__ import annotations

from kilter.errors import InputError
from kilter.files.meshes.obj import read_obj
from kilter.shape.primitives import Mesh


def read_off(data: bytes) -> list[tuple[str | None, Mesh]]:
    """Read the mesh of an OFF file in its text form; colours and normals are ignored.

    Raises `InputError` if the file is no OFF, or damaged.
    """
    rows = [words for line in data.splitlines() if (words := line.partition(b"#")[0].split())]
    if not rows or not rows[0][0].endswith(b"OFF") or b"BINARY" in rows[0]:
        raise InputError("not a text in OFF format", hint="export it as OBJ or PLY")
    head = rows.pop(0)[1:] or (rows.pop(0) if rows else [])
    corners, faces = (int(word) for word in head[:2])
    if corners < 0 or faces < 0 or corners + faces > len(rows):
        raise InputError(
            f"damaged OFF: it states {corners} corners and {faces} faces in {len(rows)} lines",
            hint="export it anew",
        )
    lines = [b"v " + b" ".join(row[:3]) for row in rows[:corners]]
    for row in rows[corners : corners + faces]:
        listed = [int(word) for word in row[1 : 1 + int(row[0])]]
        if len(listed) != int(row[0]) or min(listed, default=0) < 0:
            raise InputError("damaged OFF: a face has other corners", hint="export it anew")
        lines.append(b"f " + b" ".join(b"%d" % (k + 1) for k in listed))
    return read_obj(b"\n".join(lines) + b"\n")
