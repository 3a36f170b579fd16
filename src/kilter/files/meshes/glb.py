"""Read glTF 2.0: the meshes of its scene, placed by its nodes.

GLB is its binary form; a .gltf file has its numbers in files beside it, or as text in itself.

The primitives of a mesh form a single solid (they differ in material only). A solid is named after
its node, else after its mesh, with as many parent nodes as needed to make names distinct. The
standard fixes metres and y up. The reader does not turn the coordinates; gravity along -y is an
option of `kilter.load`. Coordinates are float32. Compressed meshes are rejected.

References
----------
Khronos, glTF 2.0 specification, sections 3.5 (nodes), 3.6 (buffers), 4.4 (GLB).
"""

from __future__ import annotations

import base64
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar
from urllib.parse import unquote

import numpy as np
from numpy.typing import NDArray

from kilter.arrays import Array
from kilter.errors import InputError
from kilter.files.complaints import parse_json
from kilter.files.limits import DEEPEST, MOST_BYTES, Tally, named_path, read_bytes
from kilter.files.meshes.placed import SINGLE, join_meshes, tails, transform_mesh
from kilter.rigid import quaternion_to_matrix
from kilter.shape.primitives import Mesh

if TYPE_CHECKING:
    from kilter.files.meshes.gltf_models import Gltf, Node, Primitive, Sparse


_Row = TypeVar("_Row")


COMPONENTS = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
"""Number type of each component type of an accessor."""
WIDTHS = {"SCALAR": 1, "VEC3": 3}
"""Numbers per row of each accessor type that is read."""
TRIANGLES, STRIP, FAN = 4, 5, 6
"""Modes of the primitives that are read."""

_DAMAGED = "export it again: it is incomplete or damaged"
_DEEP = "export it again, with its objects in fewer groups"


def read_glb(data: bytes) -> tuple[list[tuple[str | None, Mesh]], list[str]]:
    """Read the meshes of a GLB file, with their names.

    Returns `solids`: name and mesh, at its place. Raises `InputError` if the file is damaged,
    compressed, or refers to other files.
    """
    header, binary = _chunks(data)
    _require_readable(header)
    with np.errstate(all="ignore"):  # numbers that are not finite raise an InputError later
        return _solids(header, binary)


def read_gltf(path: Path) -> tuple[list[tuple[str | None, Mesh]], list[str]]:
    """Read the meshes of a .gltf file, with their names.

    Its buffers are joined to one, as in a GLB file. Raises `InputError` if the file is damaged,
    compressed, or names files that cannot be read or lie outside of its folder.
    """
    content = parse_json(read_bytes(path))
    if not isinstance(content, dict):
        raise InputError("the glTF has no header", hint=_DAMAGED)
    header = _validate(content)
    size, pieces = Tally("bytes", MOST_BYTES), list[bytes]()
    start_of: dict[str, int] = {}
    for k, buffer in enumerate(header.buffers):
        if buffer.uri is None:
            raise InputError(f"buffer {k} of the glTF has no content", hint=_DAMAGED)
        if buffer.uri not in start_of:
            start_of[buffer.uri] = size.count
            pieces.append(_buffer(path.parent, buffer.uri))
            size.add(len(pieces[-1]))
    views = []
    for view in header.bufferViews:
        uri = _header_entry(header.buffers, view.buffer, "buffer").uri or ""
        views.append(view.model_copy(update={"byteOffset": view.byteOffset + start_of[uri]}))
    header = header.model_copy(update={"bufferViews": views, "buffers": []})
    _require_readable(header)
    with np.errstate(all="ignore"):
        return _solids(header, b"".join(pieces))


def _buffer(folder: Path, uri: str) -> bytes:
    """The content of a buffer: text in base 64, or a file."""
    if uri.startswith("data:"):
        return base64.b64decode(uri.partition(",")[2])
    try:
        return read_bytes(named_path(folder, unquote(uri)))
    except InputError as error:
        raise InputError(f"buffer {uri!r:.80}: {error.what}", hint=error.hint) from None


def _header_entry(rows: list[_Row], k: int, what: str) -> _Row:
    """Entry k of a list in the header, checked; `what` is the noun for the error message.

    Raises `InputError` if k is out of range.
    """
    if k >= len(rows):
        raise InputError(f"damaged GLB: {what} {k} of {len(rows)} is missing", hint=_DAMAGED)
    return rows[k]


def _chunks(data: bytes) -> tuple[Gltf, bytes]:
    """Split the bytes of a GLB file into the parsed header and the binary chunk."""
    if data[:4] != b"glTF":
        raise InputError("not a GLB file: it does not begin with 'glTF'", hint=_DAMAGED)
    version, length = (int.from_bytes(data[k : k + 4], "little") for k in (4, 8))
    if version != 2:
        raise InputError(f"the GLB version is {version}", hint="export it as glTF 2.0")
    if length > len(data):
        raise InputError(f"GLB states {length} bytes, the file has {len(data)}", hint=_DAMAGED)
    chunks: dict[bytes, bytes] = {}
    at = 12
    while at + 8 <= length:
        size = int.from_bytes(data[at : at + 4], "little")
        if at + 8 + size > length:
            raise InputError("a chunk of the GLB ends after the end of the file", hint=_DAMAGED)
        chunks.setdefault(data[at + 4 : at + 8], data[at + 8 : at + 8 + size])
        at += 8 + size
    header = parse_json(chunks.get(b"JSON", b""))
    if not isinstance(header, dict):
        raise InputError("the GLB has no header", hint=_DAMAGED)
    return _validate(header), chunks.get(b"BIN\0", b"")


def _validate(header: dict[str, Any]) -> Gltf:
    """Parse the JSON header of a GLB file; raises `InputError` if it is invalid."""
    from pydantic import ValidationError

    from kilter.files.meshes.gltf_models import Gltf

    try:
        return Gltf.model_validate(header)
    except ValidationError as error:
        fault = error.errors(include_url=False)[0]
        place = ".".join(str(step) for step in fault["loc"])
        what = f"damaged GLB: {place}: {fault['msg'].lower()}"
        raise InputError(what[:120], hint=_DAMAGED) from None


def _require_readable(header: Gltf) -> None:
    """Raise `InputError` if the meshes are compressed or stored in other files."""
    used = {*header.extensionsRequired}
    used |= {name for mesh in header.meshes for p in mesh.primitives for name in p.extensions}
    packed = sorted(name for name in used if "compression" in name)
    if packed:
        raise InputError(
            f"meshes are compressed with {packed[0]}", hint="export without compression"
        )
    if any(buffer.uri is not None for buffer in header.buffers):
        raise InputError("meshes are in other files", hint="export as a binary GLB")


def _solids(header: Gltf, binary: bytes) -> tuple[list[tuple[str | None, Mesh]], list[str]]:
    """Names and placed meshes of the scene, in the order of its nodes, and notes."""
    read: dict[int, Mesh | None] = {}
    solids: list[tuple[tuple[str, ...], Mesh]] = []
    skipped = 0
    tally = Tally()
    for node, matrix, path in _placed_nodes(header):
        if node.mesh is None:
            continue
        source = _header_entry(header.meshes, node.mesh, "mesh")
        name = _stripped_name(node) or (source.name or "").strip() or None
        if node.mesh not in read:
            tally.add(_triangles(header, source.primitives))
            read[node.mesh] = _named_mesh(header, binary, source.primitives, name)
        mesh = read[node.mesh]
        skipped += mesh is None
        tally.add(0 if mesh is None else len(mesh.triangles))
        above = (part for part in path if part)
        solids += [] if mesh is None else [((*above, name or ""), transform_mesh(mesh, matrix))]
    named = [row for row, (whole, _) in enumerate(solids) if whole[-1]]
    names = dict(zip(named, tails([solids[row][0] for row in named]), strict=True))
    result = [(names.get(row), mesh) for row, (_, mesh) in enumerate(solids)]
    notes = [f"{skipped} objects without triangles are ignored"] if skipped else []
    return result, notes


def _placed_nodes(header: Gltf) -> Iterator[tuple[Node, Array, tuple[str, ...]]]:
    """Nodes of the scene, their transforms to its frame (4, 4), and the names of nodes above them.

    Raises `InputError` if a node has two parent nodes, a transform that is not finite, or too many
    nodes above it.
    """
    seen: set[int] = set()
    start: tuple[str, ...] = ()
    pending = [(k, np.eye(4), start) for k in reversed(_roots(header))]
    while pending:
        k, above, path = pending.pop()
        node = _header_entry(header.nodes, k, "node")
        if k in seen:
            raise InputError(f"node {k} of the GLB has two parent nodes", hint=_DAMAGED)
        seen.add(k)
        if len(path) > DEEPEST:
            raise InputError(f"nodes of the GLB are nested deeper than {DEEPEST}", hint=_DEEP)
        matrix = above @ _matrix(node)
        if not np.isfinite(matrix).all():
            raise InputError(f"the transform of node {k} is not finite", hint=_DAMAGED)
        below = (*path, _stripped_name(node))
        pending.extend((child, matrix, below) for child in reversed(node.children))
        yield node, matrix, path


def _stripped_name(node: Node) -> str:
    """Name of a node without spaces at its ends; empty if it has none."""
    return (node.name or "").strip()


def _roots(header: Gltf) -> list[int]:
    """Indices of the root nodes of the scene; without a scene, of the nodes without parents."""
    if header.scenes:
        return _header_entry(header.scenes, header.scene, "scene").nodes
    below = {child for node in header.nodes for child in node.children}
    return [k for k in range(len(header.nodes)) if k not in below]


def _matrix(node: Node) -> Array:
    """Transform from a node's frame to its parent's frame, shape (4, 4).

    It is a matrix, or a scaling, then a rotation, then a translation.
    """
    if node.matrix is not None:
        return np.array(node.matrix).reshape(4, 4).T
    matrix = np.eye(4)
    x, y, z, w = node.rotation
    matrix[:3, :3] = quaternion_to_matrix([w, x, y, z]) * np.array(node.scale)
    matrix[:3, 3] = node.translation
    return matrix


def _triangles(header: Gltf, primitives: list[Primitive]) -> int:
    """Number of triangles that the header states for primitives, at least."""
    given = (p.attributes.get("POSITION") if p.indices is None else p.indices for p in primitives)
    return sum(
        _header_entry(header.accessors, k, "accessor").count // 3 for k in given if k is not None
    )


def _named_mesh(
    header: Gltf, binary: bytes, primitives: list[Primitive], name: str | None
) -> Mesh | None:
    """Join the triangles of all primitives to a mesh; None without triangles."""
    try:
        pieces = [_primitive(header, binary, primitive) for primitive in primitives]
        kept = [piece for piece in pieces if piece is not None]
        return join_meshes(kept) if kept else None
    except InputError as error:
        raise error.located(part=name) from None


def _primitive(header: Gltf, binary: bytes, primitive: Primitive) -> Mesh | None:
    """The triangles of a primitive (a piece of a mesh); None if it consists of points or lines."""
    mode = primitive.mode
    if mode not in (TRIANGLES, STRIP, FAN) or "POSITION" not in primitive.attributes:
        return None
    vertices = _accessor(header, binary, primitive.attributes["POSITION"], "VEC3")
    if primitive.indices is not None:
        indices = _accessor(header, binary, primitive.indices, "SCALAR")
        if indices.dtype.kind != "u":
            raise InputError("the vertex indices of the GLB are not integers", hint=_DAMAGED)
        corners = indices.reshape(-1).astype(np.int64)
    else:
        corners = np.arange(len(vertices))
    k = np.arange(max(len(corners) - 2, 0))
    if mode == TRIANGLES:
        if len(corners) % 3:
            raise InputError(f"{len(corners)} corners are not a multiple of 3", hint=_DAMAGED)
        faces = corners.reshape(-1, 3)
    elif mode == STRIP:  # every second triangle of a strip has the opposite orientation
        faces = np.column_stack([corners[k], corners[k + 1 + k % 2], corners[k + 2 - k % 2]])
    else:
        faces = np.column_stack([corners[0 * k], corners[k + 1], corners[k + 2]])
    accuracy = SINGLE * float(np.abs(vertices).max(initial=0.0))
    return Mesh(vertices, faces, accuracy=accuracy)


def _accessor(header: Gltf, binary: bytes, index: int, wanted: str) -> NDArray[Any]:
    """The rows of numbers that an accessor of the header describes, shape (n, width).

    Raises `InputError` if the type of the accessor is not `wanted` ("SCALAR" or "VEC3"), or bytes
    are missing.
    """
    accessor = _header_entry(header.accessors, index, "accessor")
    if accessor.type != wanted:
        what = f"damaged GLB: accessor {index} is of type {accessor.type!r:.20}, not {wanted}"
        raise InputError(what, hint=_DAMAGED)
    count, width, kind = (
        accessor.count,
        WIDTHS[wanted],
        np.dtype(COMPONENTS[accessor.componentType]),
    )
    if accessor.bufferView is not None:
        place = accessor.bufferView, accessor.byteOffset
        rows = _view(header, binary, place, kind, (count, width))
    else:
        _check_count(count * width * kind.itemsize, len(binary) * 64)
        rows = np.zeros((count, width), dtype=kind)
    if accessor.sparse is not None:
        rows = _with_sparse(header, binary, accessor.sparse, rows)
    if accessor.normalized and kind.kind in "iu":
        return np.maximum(rows / np.iinfo(kind).max, -1.0)
    return rows


def _with_sparse(header: Gltf, binary: bytes, sparse: Sparse, rows: NDArray[Any]) -> NDArray[Any]:
    """Rows of numbers of an accessor, after its sparse section has overwritten some of them."""
    indices, values, n = sparse.indices, sparse.values, sparse.count
    kind = np.dtype(COMPONENTS[indices.componentType])
    at = _view(header, binary, (indices.bufferView, indices.byteOffset), kind, (n, 1))[:, 0]
    if n and int(at.max()) >= len(rows):
        raise InputError(f"damaged GLB: row {at.max()} of {len(rows)} is missing", hint=_DAMAGED)
    rows = rows.copy()
    shape = n, rows.shape[1]
    rows[at] = _view(header, binary, (values.bufferView, values.byteOffset), rows.dtype, shape)
    return rows


def _view(
    header: Gltf,
    binary: bytes,
    place: tuple[int, int],
    kind: np.dtype[Any],
    shape: tuple[int, int],
) -> NDArray[Any]:
    """Read rows of numbers from a place in the binary chunk."""
    view = _header_entry(header.bufferViews, place[0], "buffer view")
    start = view.byteOffset + place[1]
    row = shape[1] * kind.itemsize
    stride = view.byteStride or row
    _check_count(start + stride * (shape[0] - 1) + row if shape[0] else 0, len(binary))
    if not shape[0]:
        return np.empty(shape, dtype=kind)
    return np.ndarray(shape, kind, binary, start, (stride, kind.itemsize))


def _check_count(needed: int, held: int) -> None:
    """Raise `InputError` if `needed` bytes are more than the `held` bytes of the file."""
    if needed < 0 or needed > held:
        raise InputError(f"numbers end at byte {needed} of {held}", hint=_DAMAGED)
