"""GLB (binary glTF 2.0): the meshes of its scene, each where its nodes put it.

The primitives of one mesh make one solid (they differ in material only). Names are those of
the nodes, else of the meshes. The standard says metres and y up; both stay as they are: give
a direction of gravity along -y. Coordinates are float32. Compressed meshes are refused.

References
----------
Khronos, glTF 2.0 specification, sections 3.5 (nodes), 3.6 (buffers), 4.4 (GLB).
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from kilter.arrays import Array
from kilter.errors import InputError
from kilter.files.accuracy import SINGLE
from kilter.files.placed import joined, placed
from kilter.files.strict_json import parse_json
from kilter.rigid import quaternion_to_matrix
from kilter.shape.primitives import Mesh

__all__ = ["read_glb"]


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
    try:
        header, binary = _chunks(data)
        _refuse_unread(header)
        with np.errstate(all="ignore"):  # what is not finite is refused by name
            return _solids(header, binary)
    except (KeyError, IndexError, TypeError, ValueError, AttributeError, OverflowError) as error:
        what = f"damaged GLB: {type(error).__name__} {error}"
        raise InputError(what[:120], hint=_DAMAGED) from None


def _chunks(data: bytes) -> tuple[dict[str, Any], bytes]:
    """The JSON and the binary chunk."""
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
    return header, chunks.get(b"BIN\0", b"")


def _refuse_unread(header: dict[str, Any]) -> None:
    primitives = [p for mesh in header.get("meshes", []) for p in mesh["primitives"]]
    used = {*header.get("extensionsRequired", [])}
    used |= {name for p in primitives for name in p.get("extensions", {})}
    packed = sorted(name for name in used if "compression" in name)
    if packed:
        raise InputError(f"meshes are packed with {packed[0]}", hint="export without compression")
    if any("uri" in buffer for buffer in header.get("buffers", [])):
        raise InputError("meshes are in other files", hint="export as one binary GLB")


def _solids(
    header: dict[str, Any], binary: bytes
) -> tuple[list[tuple[str | None, Mesh]], list[str]]:
    nodes, meshes = header.get("nodes", []), header.get("meshes", [])
    read: dict[int, Mesh | None] = {}
    solids: list[tuple[str | None, Mesh]] = []
    seen: set[int] = set()
    skipped = 0
    pending = [(k, np.eye(4)) for k in reversed(_roots(header))]
    while pending:
        k, above = pending.pop()
        if k in seen:
            raise InputError(f"node {k} of the GLB stands under two nodes", hint=_DAMAGED)
        seen.add(k)
        node, matrix = nodes[k], above @ _matrix(nodes[k])
        if not np.isfinite(matrix).all():
            raise InputError(f"node {k} of the GLB has no finite place", hint=_DAMAGED)
        pending.extend((child, matrix) for child in reversed(node.get("children", [])))
        if "mesh" not in node:
            continue
        source = meshes[node["mesh"]]
        name = str(node.get("name") or source.get("name") or "").strip() or None
        if node["mesh"] not in read:
            read[node["mesh"]] = _named_mesh(header, binary, source, name)
        mesh = read[node["mesh"]]
        skipped += mesh is None
        solids += [] if mesh is None else [(name, placed(mesh, matrix))]
    notes = [f"{skipped} objects without triangles are passed over"] if skipped else []
    return solids, notes


def _roots(header: dict[str, Any]) -> list[int]:
    if header.get("scenes"):
        return list(header["scenes"][header.get("scene", 0)].get("nodes", []))
    nodes = header.get("nodes", [])
    below = {child for node in nodes for child in node.get("children", [])}
    return [k for k in range(len(nodes)) if k not in below]


def _matrix(node: dict[str, Any]) -> Array:
    """The node's own transform, shape (4, 4): a matrix, or turn after scale, then step."""
    if "matrix" in node:
        return np.array(node["matrix"], dtype=np.float64).reshape(4, 4).T
    matrix = np.eye(4)
    x, y, z, w = node.get("rotation", [0, 0, 0, 1])
    matrix[:3, :3] = quaternion_to_matrix([w, x, y, z]) * np.array(node.get("scale", [1, 1, 1]))
    matrix[:3, 3] = node.get("translation", [0, 0, 0])
    return matrix


def _named_mesh(
    header: dict[str, Any], binary: bytes, source: dict[str, Any], name: str | None
) -> Mesh | None:
    try:
        pieces = [_primitive(header, binary, p) for p in source["primitives"]]
        kept = [piece for piece in pieces if piece is not None]
        return joined(kept) if kept else None
    except InputError as error:
        raise error.located(part=name) from None


def _primitive(header: dict[str, Any], binary: bytes, primitive: dict[str, Any]) -> Mesh | None:
    mode = primitive.get("mode", TRIANGLES)
    if mode not in (TRIANGLES, STRIP, FAN) or "POSITION" not in primitive["attributes"]:
        return None
    vertices = _accessor(header, binary, primitive["attributes"]["POSITION"])
    if "indices" in primitive:
        indices = _accessor(header, binary, primitive["indices"])
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


def _accessor(header: dict[str, Any], binary: bytes, index: int) -> NDArray[Any]:
    """Rows of numbers, shape (n, width), as the accessor describes them."""
    accessor = header["accessors"][index]
    count, width = int(accessor["count"]), WIDTHS[accessor["type"]]
    kind = np.dtype(COMPONENTS[accessor["componentType"]])
    if "bufferView" in accessor:
        rows = _view(header, binary, accessor, kind, (count, width))
    else:
        _check_count(count * width * kind.itemsize, len(binary) * 64)
        rows = np.zeros((count, width), dtype=kind)
    if "sparse" in accessor:
        sparse = accessor["sparse"]
        n, where = int(sparse["count"]), sparse["indices"]
        at = _view(header, binary, where, np.dtype(COMPONENTS[where["componentType"]]), (n, 1))
        rows = rows.copy()
        rows[at[:, 0]] = _view(header, binary, sparse["values"], kind, (n, width))
    if accessor.get("normalized"):
        return np.maximum(rows / np.iinfo(kind).max, -1.0)
    return rows


def _view(
    header: dict[str, Any],
    binary: bytes,
    place: dict[str, Any],
    kind: np.dtype[Any],
    shape: tuple[int, int],
) -> NDArray[Any]:
    view = header["bufferViews"][place["bufferView"]]
    start = int(view.get("byteOffset", 0)) + int(place.get("byteOffset", 0))
    row = shape[1] * kind.itemsize
    stride = int(view.get("byteStride", row))
    _check_count(start + stride * (shape[0] - 1) + row if shape[0] else 0, len(binary))
    return np.ndarray(shape, kind, binary, start, (stride, kind.itemsize))


def _check_count(needed: int, held: int) -> None:
    if needed < 0 or needed > held:
        raise InputError(f"numbers end at byte {needed} of {held}", hint=_DAMAGED)
