"""A plan as an animated GLB (binary glTF 2.0): each part comes in along its way.

Lengths are metres and y is up, as the standard has it. A part that is not there yet has the size
zero, since core glTF hides nothing; while a part is held, a small octahedron marks it. At rest
all is put together, so that a viewer that plays nothing shows the whole. Without normals faces
are flat, as they are.

References
----------
Khronos, glTF 2.0 specification, sections 3.7.2 (meshes), 3.11 (animations), 4.4 (GLB).
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from kilter.arrays import Array
from kilter.rigid import matrix_to_quaternion, quaternion_to_matrix, rotation_between
from kilter.show.colours import part_colours
from kilter.show.packing import readable
from kilter.show.shapes import placed
from kilter.tell.palette import ROLES, rgb
from kilter.units import metres_per_unit

if TYPE_CHECKING:
    from kilter.assembly import Assembly

__all__ = ["film_of"]

LEAD, STEP, MOVES = 0.8, 1.25, 1.0
"""Before the first step, of a step, of its motion [s]."""
KEYS = 13
"""Places along a way, one after the other in time."""
NEAR = 1.2
"""How far away a part begins at most [size of the assembly]."""
TURNS = 3
"""Of a nut on its thread, for the picture alone."""
HELD = rgb(ROLES["grip"].light)
"""Colour of what marks a held part, sRGB."""
MARK = 0.28
"""Its size [bounding radius of the part]."""
FLOAT, INDEX = 5126, 5125
VERTICES, CORNERS = 34962, 34963
"""Numbers of the standard: types of numbers, kinds of buffers."""


class _Binary:
    """The buffer of a GLB, and the accessors into it."""

    def __init__(self) -> None:
        self.data = bytearray()
        self.views: list[dict[str, Any]] = []
        self.accessors: list[dict[str, Any]] = []

    def put(self, values: ArrayLike, kind: str, target: int | None = None) -> int:
        """The number of a new accessor: values of a kind, with bounds where they are floats."""
        index = target == CORNERS
        rows = np.ascontiguousarray(values, dtype="<u4" if index else "<f4")
        view: dict[str, Any] = {
            "buffer": 0,
            "byteOffset": len(self.data),
            "byteLength": rows.nbytes,
        }
        if target is not None:
            view["target"] = target
        self.views.append(view)
        self.data += rows.tobytes()
        found: dict[str, Any] = {
            "bufferView": len(self.views) - 1,
            "componentType": INDEX if index else FLOAT,
            "count": len(rows) if kind != "SCALAR" else rows.size,
            "type": kind,
        }
        if not index:
            wide = rows.reshape(found["count"], -1)
            found |= {"min": wide.min(axis=0).tolist(), "max": wide.max(axis=0).tolist()}
        self.accessors.append(found)
        return len(self.accessors) - 1


def film_of(assembly: Assembly, answer: Mapping[str, Any]) -> bytes:
    """The steps of a plan that was found, as the bytes of a GLB file.

    Parameters
    ----------
    assembly : Assembly
    answer : mapping
        Data of the plan.
    """
    binary = _Binary()
    places, index = placed(assembly), assembly.index
    low, high = (getattr(assembly.geometry.vertices, end)(axis=0) for end in ("min", "max"))
    center, size = (low + high) / 2, float((high - low).max())
    meshes, materials, mesh_of = _meshes(assembly, binary)
    nodes = [
        {
            "name": readable(name),
            "mesh": mesh_of[k],
            "translation": (places.position[k] - center).tolist(),
            "rotation": _xyzw(places.rotation[k]),
        }
        for k, name in enumerate(assembly.names)
    ]
    channels: list[dict[str, Any]] = []
    samplers: list[dict[str, Any]] = []

    def animate(
        node: int, path: str, times: ArrayLike, values: ArrayLike, way: str = "LINEAR"
    ) -> None:
        kind = "VEC4" if path == "rotation" else "VEC3"
        samplers.append(
            {
                "input": binary.put(times, "SCALAR"),
                "output": binary.put(values, kind),
                "interpolation": way,
            }
        )
        target = {"node": node, "path": path}
        channels.append({"sampler": len(samplers) - 1, "target": target})

    for k, step in enumerate(answer["steps"]):
        start = LEAD + k * STEP
        times = start + MOVES * np.linspace(0.0, 1.0, KEYS)
        path = _way(np.array(step["path"]), NEAR * size)
        for part in (index[name] for name in step["parts"]):
            animate(part, "scale", [0.0, start], [[0.0] * 3, [1.0] * 3], "STEP")
            animate(part, "translation", times, places.position[part] - center + path)
            if step["over"] is not None:
                turning = _turning(np.array(step["direction"]), places.rotation[part])
                animate(part, "rotation", np.linspace(start, start + MOVES, len(turning)), turning)
    for name, changes in _held_times(answer["steps"]).items():
        part = index[name]
        nodes.append(
            {
                "name": f"hold {readable(name)}",
                "mesh": len(meshes) - 1,
                "translation": (assembly.geometry.center[part] - center).tolist(),
                "scale": [0.0, 0.0, 0.0],
            }
        )
        reach = MARK * float(assembly.geometry.radius[part])
        sizes = [[reach * on] * 3 for _, on in changes]
        animate(len(nodes) - 1, "scale", [at for at, _ in changes], sizes, "STEP")
    turned = _xyzw(rotation_between(assembly.down, [0.0, -1.0, 0.0]))
    metres = metres_per_unit(assembly.units)
    root = {
        "name": "assembly",
        "rotation": turned,
        "scale": [metres] * 3,
        "children": list(range(len(nodes))),
    }
    header = {
        "asset": {"version": "2.0", "generator": "kilter"},
        "scene": 0,
        "scenes": [{"nodes": [len(nodes)]}],
        "nodes": [*nodes, root],
        "meshes": meshes,
        "materials": materials,
        "animations": [{"name": "plan", "channels": channels, "samplers": samplers}],
        "accessors": binary.accessors,
        "bufferViews": binary.views,
        "buffers": [{"byteLength": len(binary.data)}],
    }
    return _glb(header, bytes(binary.data))


def _meshes(
    assembly: Assembly, binary: _Binary
) -> tuple[list[dict[str, Any]], list[dict[str, Any]], list[int]]:
    """Meshes, materials, and the mesh of each part; the last mesh marks what is held."""
    places = placed(assembly)
    colours = part_colours(places.shape, assembly.geometry.grounded)
    shapes = [
        (
            binary.put(shape.positions, "VEC3", VERTICES),
            binary.put(shape.triangles.reshape(-1), "SCALAR", CORNERS),
        )
        for shape in places.shapes
    ]
    materials: list[dict[str, Any]] = []
    meshes: list[dict[str, Any]] = []
    known: dict[tuple[int, bytes], int] = {}
    chosen = []
    for shape, colour in zip(places.shape.tolist(), colours, strict=True):
        key = shape, colour.tobytes()
        if key not in known:
            known[key] = len(meshes)
            materials.append(_material(colour / 255.0))
            meshes.append(_mesh(shapes[shape], len(materials) - 1))
        chosen.append(known[key])
    corners = np.concatenate([np.eye(3), -np.eye(3)])
    faces = [
        [0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2],
        [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5],
    ]  # fmt: skip
    materials.append(_material(np.array(HELD) / 255.0))
    mark = (
        binary.put(corners, "VEC3", VERTICES),
        binary.put(np.array(faces).reshape(-1), "SCALAR", CORNERS),
    )
    meshes.append(_mesh(mark, len(materials) - 1))
    return meshes, materials, chosen


def _mesh(surface: tuple[int, int], material: int) -> dict[str, Any]:
    """A mesh of one surface: its accessors of positions and of corners."""
    positions, corners = surface
    primitive = {"attributes": {"POSITION": positions}, "indices": corners, "material": material}
    return {"primitives": [primitive]}


def _material(colour: Array) -> dict[str, Any]:
    """A dull surface; the standard has colours in linear light."""
    linear = np.where(colour <= 0.04045, colour / 12.92, ((colour + 0.055) / 1.055) ** 2.4)
    surface = {
        "baseColorFactor": [*linear.round(6).tolist(), 1.0],
        "metallicFactor": 0.0,
        "roughnessFactor": 0.85,
    }
    return {"pbrMetallicRoughness": surface}


def _way(path: Array, reach: float) -> Array:
    """Places along a way at even times, gently at both ends, shape (KEYS, 3)."""
    first = path[0] - path[1]
    far = float(np.linalg.norm(first))
    path = np.vstack([path[1] + first * min(1.0, reach / far), path[1:]])
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))])
    t = np.linspace(0.0, 1.0, KEYS)
    at = along[-1] * t * t * (3 - 2 * t)
    return np.column_stack([np.interp(at, along, path[:, i]) for i in range(3)])


def _turning(along: Array, rest: Array) -> Array:
    """Quaternions x, y, z, w of a nut that advances along a right-handed thread to its seat."""
    angles = np.linspace(-2 * np.pi * TURNS, 0.0, 4 * TURNS + 1)
    turns = np.column_stack([np.cos(angles / 2), np.sin(angles / 2)[:, None] * along])
    turned = quaternion_to_matrix(turns) @ quaternion_to_matrix(rest)
    return np.array([_xyzw(matrix_to_quaternion(one)) for one in turned])


def _held_times(steps: list[dict[str, Any]]) -> dict[str, list[tuple[float, int]]]:
    """Of each part that is held, when it is and when no more, from the time 0 on."""
    found: dict[str, list[tuple[float, int]]] = {}
    for k, step in enumerate([*steps, {"held": []}]):
        for name in step["held"]:
            found.setdefault(name, [(0.0, 0)])
        for name, times in found.items():
            if (name in step["held"]) != bool(times[-1][1]):
                times.append((LEAD + k * STEP, int(name in step["held"])))
    return found


def _xyzw(quaternion: Array) -> list[float]:
    w, x, y, z = quaternion.tolist()
    return [x, y, z, w]


def _glb(header: dict[str, Any], data: bytes) -> bytes:
    """Header and buffer as one file, each chunk filled up to four bytes."""
    text = json.dumps(header, separators=(",", ":"), allow_nan=False).encode("ascii")
    text += b" " * (-len(text) % 4)
    data += b"\0" * (-len(data) % 4)
    chunks = b"".join(
        len(body).to_bytes(4, "little") + kind + body
        for kind, body in ((b"JSON", text), (b"BIN\0", data))
    )
    return b"glTF" + (2).to_bytes(4, "little") + (12 + len(chunks)).to_bytes(4, "little") + chunks
