"""GLB (binary glTF 2.0): the meshes of its scene, each where its nodes put it.

The primitives of one mesh make one solid (they differ in material only). Names are those of
the nodes, else of the meshes, with as many of the nodes above as tell them apart. The standard
says metres and y up; both stay as they are: give a direction of gravity along -y. Coordinates
are float32. Compressed meshes are refused.

References
----------
Khronos, glTF 2.0 specification, sections 3.5 (nodes), 3.6 (buffers), 4.4 (GLB).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from kilter.arrays import Array
from kilter.errors import InputError
from kilter.files.accuracy import SINGLE
from kilter.files.limits import Tally
from kilter.files.naming import tails
from kilter.files.placed import joined, placed
from kilter.files.strict_json import parse_json
from kilter.rigid import quaternion_to_matrix
from kilter.shape.primitives import Mesh

if TYPE_CHECKING:
    from kilter.files.gltf_models import Gltf, Node, Primitive, Sparse

__all__ = ["read_glb"]

_Row = TypeVar("_Row")


COMPONENTS = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
WIDTHS = {"SCALAR": 1, "VEC3": 3}
TRIANGLES, STRIP, FAN = 4, 5, 6

_DAMAGED = "export it again: it was cut short or damaged"


def read_glb(data: bytes) -> tuple[list[tuple[str | None, Mesh]], list[str]]:
    """The solids of a GLB file with their names, and notes.

    Raises
    ------
    InputError
        If the file is damaged, compressed, or refers to other files.
    """
    header, binary = _chunks(data)
    _refuse_unread(header)
    with np.errstate(all="ignore"):  # what is not finite is refused by name
        return _solids(header, binary)


def _at(rows: list[_Row], k: int, what: str) -> _Row:
    """Entry k of a list of the header.

    Raises
    ------
    InputError
        If it is not there.
    """
    if k >= len(rows):
        raise InputError(f"damaged GLB: {what} {k} of {len(rows)} is not there", hint=_DAMAGED)
    return rows[k]


def _chunks(data: bytes) -> tuple[Gltf, bytes]:
    """The header and the binary chunk."""
    if data[:4] != b"glTF":
        raise InputError("not a GLB file: it does not begin with 'glTF'", hint=_DAMAGED)
    version, length = (int.from_bytes(data[k : k + 4], "little") for k in (4, 8))
    if version != 2:
        raise InputError(f"GLB version {version}", hint="export it as glTF 2.0")
    if length > len(data):
        raise InputError(f"GLB says {length} bytes, the file has {len(data)}", hint=_DAMAGED)
    chunks: dict[bytes, bytes] = {}
    at = 12
    while at + 8 <= length:
        size = int.from_bytes(data[at : at + 4], "little")
        if at + 8 + size > length:
            raise InputError("a chunk of the GLB ends past the file", hint=_DAMAGED)
        chunks.setdefault(data[at + 4 : at + 8], data[at + 8 : at + 8 + size])
        at += 8 + size
    header = parse_json(chunks.get(b"JSON", b""))
    if not isinstance(header, dict):
        raise InputError("the GLB has no header", hint=_DAMAGED)
    return _checked(header), chunks.get(b"BIN\0", b"")


def _checked(header: dict[str, Any]) -> Gltf:
    from pydantic import ValidationError

    from kilter.files.gltf_models import Gltf

    try:
        return Gltf.model_validate(header)
    except ValidationError as error:
        fault = error.errors(include_url=False)[0]
        place = ".".join(str(step) for step in fault["loc"])
        what = f"damaged GLB: {place}: {fault['msg'].lower()}"
        raise InputError(what[:120], hint=_DAMAGED) from None


def _refuse_unread(header: Gltf) -> None:
    used = {*header.extensionsRequired}
    used |= {name for mesh in header.meshes for p in mesh.primitives for name in p.extensions}
    packed = sorted(name for name in used if "compression" in name)
    if packed:
        raise InputError(f"meshes are packed with {packed[0]}", hint="export without compression")
    if any(buffer.uri is not None for buffer in header.buffers):
        raise InputError("meshes are in other files", hint="export as one binary GLB")


def _solids(header: Gltf, binary: bytes) -> tuple[list[tuple[str | None, Mesh]], list[str]]:
    read: dict[int, Mesh | None] = {}
    solids: list[tuple[tuple[str, ...], Mesh]] = []
    seen: set[int] = set()
    skipped = 0
    start: tuple[str, ...] = ()
    tally = Tally()
    pending = [(k, np.eye(4), start) for k in reversed(_roots(header))]
    while pending:
        k, above, path = pending.pop()
        node = _at(header.nodes, k, "node")
        if k in seen:
            raise InputError(f"node {k} of the GLB stands under two nodes", hint=_DAMAGED)
        seen.add(k)
        matrix = above @ _matrix(node)
        if not np.isfinite(matrix).all():
            raise InputError(f"node {k} of the GLB has no finite place", hint=_DAMAGED)
        own = (node.name or "").strip()
        below = (*path, own) if own else path
        pending.extend((child, matrix, below) for child in reversed(node.children))
        if node.mesh is None:
            continue
        source = _at(header.meshes, node.mesh, "mesh")
        name = own or (source.name or "").strip() or None
        if node.mesh not in read:
            tally.add(_triangles(header, source.primitives))
            read[node.mesh] = _named_mesh(header, binary, source.primitives, name)
        mesh = read[node.mesh]
        skipped += mesh is None
        tally.add(0 if mesh is None else len(mesh.triangles))
        solids += [] if mesh is None else [((*path, name or ""), placed(mesh, matrix))]
    named = [row for row, (whole, _) in enumerate(solids) if whole[-1]]
    names = dict(zip(named, tails([solids[row][0] for row in named]), strict=True))
    found = [(names.get(row), mesh) for row, (_, mesh) in enumerate(solids)]
    notes = [f"{skipped} objects without triangles are passed over"] if skipped else []
    return found, notes


def _roots(header: Gltf) -> list[int]:
    if header.scenes:
        return _at(header.scenes, header.scene, "scene").nodes
    below = {child for node in header.nodes for child in node.children}
    return [k for k in range(len(header.nodes)) if k not in below]


def _matrix(node: Node) -> Array:
    """The node's own transform, shape (4, 4): a matrix, or turn after scale, then step."""
    if node.matrix is not None:
        return np.array(node.matrix).reshape(4, 4).T
    matrix = np.eye(4)
    x, y, z, w = node.rotation
    matrix[:3, :3] = quaternion_to_matrix([w, x, y, z]) * np.array(node.scale)
    matrix[:3, 3] = node.translation
    return matrix


def _triangles(header: Gltf, primitives: list[Primitive]) -> int:
    """About how many triangles primitives say that they have."""
    given = (
        one.attributes.get("POSITION") if one.indices is None else one.indices for one in primitives
    )
    return sum(_at(header.accessors, k, "accessor").count // 3 for k in given if k is not None)


def _named_mesh(
    header: Gltf, binary: bytes, primitives: list[Primitive], name: str | None
) -> Mesh | None:
    try:
        pieces = [_primitive(header, binary, primitive) for primitive in primitives]
        kept = [piece for piece in pieces if piece is not None]
        return joined(kept) if kept else None
    except InputError as error:
        raise error.located(part=name) from None


def _primitive(header: Gltf, binary: bytes, primitive: Primitive) -> Mesh | None:
    mode = primitive.mode
    if mode not in (TRIANGLES, STRIP, FAN) or "POSITION" not in primitive.attributes:
        return None
    vertices = _accessor(header, binary, primitive.attributes["POSITION"], "VEC3")
    if primitive.indices is not None:
        indices = _accessor(header, binary, primitive.indices, "SCALAR")
        if indices.dtype.kind != "u":
            raise InputError("corners of the GLB are not whole numbers", hint=_DAMAGED)
        corners = indices.reshape(-1).astype(np.int64)
    else:
        corners = np.arange(len(vertices))
    k = np.arange(max(len(corners) - 2, 0))
    if mode == TRIANGLES:
        if len(corners) % 3:
            raise InputError(f"{len(corners)} corners do not make triangles", hint=_DAMAGED)
        faces = corners.reshape(-1, 3)
    elif mode == STRIP:  # every other triangle of a strip turns the other way
        faces = np.column_stack([corners[k], corners[k + 1 + k % 2], corners[k + 2 - k % 2]])
    else:
        faces = np.column_stack([corners[0 * k], corners[k + 1], corners[k + 2]])
    accuracy = SINGLE * float(np.abs(vertices).max(initial=0.0))
    return Mesh(vertices, faces, accuracy=accuracy)


def _accessor(header: Gltf, binary: bytes, index: int, wanted: str) -> NDArray[Any]:
    """Rows of numbers, shape (n, width), as the accessor describes them."""
    accessor = _at(header.accessors, index, "accessor")
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
    """The rows with those that stand apart in their places."""
    where, values, n = sparse.indices, sparse.values, sparse.count
    kind = np.dtype(COMPONENTS[where.componentType])
    at = _view(header, binary, (where.bufferView, where.byteOffset), kind, (n, 1))[:, 0]
    if n and int(at.max()) >= len(rows):
        raise InputError(f"damaged GLB: row {at.max()} of {len(rows)} is not there", hint=_DAMAGED)
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
    """Rows at a place: the number of a view, and the byte in it where they begin."""
    view = _at(header.bufferViews, place[0], "buffer view")
    start = view.byteOffset + place[1]
    row = shape[1] * kind.itemsize
    stride = view.byteStride or row
    _check_count(start + stride * (shape[0] - 1) + row if shape[0] else 0, len(binary))
    if not shape[0]:
        return np.empty(shape, dtype=kind)
    return np.ndarray(shape, kind, binary, start, (stride, kind.itemsize))


def _check_count(needed: int, held: int) -> None:
    if needed < 0 or needed > held:
        raise InputError(f"numbers end at byte {needed} of {held}", hint=_DAMAGED)
