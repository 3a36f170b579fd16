"""Animated GLB files (binary glTF 2.0) of an assembly: a node for each part, moved by tracks.

Lengths are metres and y is up, as the standard requires. The meshes have no normals, so that
viewers shade the faces flat.

References
----------
Khronos, glTF 2.0 specification, sections 3.7.2 (meshes), 3.11 (animations), 4.4 (GLB).
"""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from kilter.arrays import Array
from kilter.rigid import matrix_to_quaternion, quaternion_to_matrix, rotation_between, screwed
from kilter.show.colours import assembly_colours
from kilter.show.packing import readable
from kilter.show.shapes import place_shapes
from kilter.tell.palette import ROLES, rgb
from kilter.units import metres_per_unit

if TYPE_CHECKING:
    from kilter.assembly import Assembly


HELD = rgb(ROLES["grip"].light)
"""Colour of the mark of a held part, sRGB from 0 to 255."""
FLOAT, INDEX = 5126, 5125
"""Component types of the standard: float32, uint32."""
VERTICES, CORNERS = 34962, 34963
"""Buffer targets of the standard: vertex attributes, corner indices."""


class _BufferBuilder:
    """Binary buffer of a GLB file, with its views and accessors."""

    def __init__(self) -> None:
        self.data = bytearray()
        self.views: list[dict[str, Any]] = []
        self.accessors: list[dict[str, Any]] = []

    def put(self, values: ArrayLike, kind: str, target: int | None = None) -> int:
        """Append values to the buffer and return the index of their accessor.

        `kind` is the element type, as "VEC3". Accessors of floats get the bounds of their values.
        """
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
        accessor: dict[str, Any] = {
            "bufferView": len(self.views) - 1,
            "componentType": INDEX if index else FLOAT,
            "count": len(rows) if kind != "SCALAR" else rows.size,
            "type": kind,
        }
        if not index:
            wide = rows.reshape(accessor["count"], -1)
            accessor |= {"min": wide.min(axis=0).tolist(), "max": wide.max(axis=0).tolist()}
        self.accessors.append(accessor)
        return len(self.accessors) - 1


class Film:
    """Animated GLB file of an assembly: its parts at rest as nodes, with animation tracks.

    - `center` (3,): middle of the assembly, the origin of the picture [length unit].
    - `size`: largest extent of the assembly [length unit].
    - `places`: shape and pose of each part at rest.
    """

    def __init__(self, assembly: Assembly) -> None:
        self._assembly, self._binary = assembly, _BufferBuilder()
        self.places = place_shapes(assembly)
        low, high = (getattr(assembly.geometry.vertices, end)(axis=0) for end in ("min", "max"))
        self.center, self.size = (low + high) / 2, float((high - low).max())
        self._meshes, self._materials, mesh_of = _meshes(assembly, self._binary)
        self._nodes: list[dict[str, Any]] = [
            {
                "name": readable(name),
                "mesh": mesh_of[k],
                "translation": (self.places.position[k] - self.center).tolist(),
                "rotation": xyzw(self.places.rotation[k]),
            }
            for k, name in enumerate(assembly.names)
        ]
        self._channels: list[dict[str, Any]] = []
        self._samplers: list[dict[str, Any]] = []

    def add_mark(self, name: str, at: Array) -> int:
        """Add a marker of size zero at a point in the world, and return its node.

        An animation scales it up.
        """
        self._nodes.append(
            {
                "name": readable(name),
                "mesh": len(self._meshes) - 1,
                "translation": (at - self.center).tolist(),
                "scale": [0.0, 0.0, 0.0],
            }
        )
        return len(self._nodes) - 1

    def animate(
        self, node: int, path: str, times: ArrayLike, values: ArrayLike, way: str = "LINEAR"
    ) -> None:
        """Add an animation track to a node, for its position, rotation or scale.

        Arguments: `times` (k,): times of the keys [s]; `values` (k, 3): values at the keys;
        quaternions as x, y, z, w.
        """
        kind = "VEC4" if path == "rotation" else "VEC3"
        self._samplers.append(
            {
                "input": self._binary.put(times, "SCALAR"),
                "output": self._binary.put(values, kind),
                "interpolation": way,
            }
        )
        target = {"node": node, "path": path}
        self._channels.append({"sampler": len(self._samplers) - 1, "target": target})

    def to_bytes(self, name: str) -> bytes:
        """Encode the film as a GLB file; `name` is the name of its animation."""
        assembly = self._assembly
        root = {
            "name": "assembly",
            "rotation": xyzw(rotation_between(assembly.down, [0.0, -1.0, 0.0])),
            "scale": [metres_per_unit(assembly.units)] * 3,
            "children": list(range(len(self._nodes))),
        }
        header: dict[str, Any] = {
            "asset": {"version": "2.0", "generator": "kilter"},
            "scene": 0,
            "scenes": [{"nodes": [len(self._nodes)]}],
            "nodes": [*self._nodes, root],
            "meshes": self._meshes,
            "materials": self._materials,
            "accessors": self._binary.accessors,
            "bufferViews": self._binary.views,
            "buffers": [{"byteLength": len(self._binary.data)}],
        }
        if self._channels:
            moving = {"name": name, "channels": self._channels, "samplers": self._samplers}
            header["animations"] = [moving]
        return _glb(header, bytes(self._binary.data))


def _meshes(
    assembly: Assembly, binary: _BufferBuilder
) -> tuple[list[dict[str, Any]], list[dict[str, Any]], list[int]]:
    """Meshes, materials, and the mesh index of each part; the last mesh marks held parts.

    Parts with equal shape and colour share a mesh.
    """
    places = place_shapes(assembly)
    colours = assembly_colours(assembly, places.shape)
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
    """Mesh entry of a glTF file with a single surface.

    `surface` holds its accessors of positions and of corners.
    """
    positions, corners = surface
    primitive = {"attributes": {"POSITION": positions}, "indices": corners, "material": material}
    return {"primitives": [primitive]}


def _material(colour: Array) -> dict[str, Any]:
    """Matt glTF material; converts an sRGB colour, 0 to 1, to the linear values of glTF."""
    linear = np.where(colour <= 0.04045, colour / 12.92, ((colour + 0.055) / 1.055) ** 2.4)
    surface = {
        "baseColorFactor": [*linear.round(6).tolist(), 1.0],
        "metallicFactor": 0.0,
        "roughnessFactor": 0.85,
    }
    return {"pbrMetallicRoughness": surface}


def xyzw(quaternion: Array) -> list[float]:
    """Reorder a quaternion w, x, y, z to x, y, z, w, the order of glTF."""
    w, x, y, z = quaternion.tolist()
    return [x, y, z, w]


def _glb(header: dict[str, Any], data: bytes) -> bytes:
    """Join the JSON header and the buffer into a GLB file; chunks are padded to four bytes."""
    text = json.dumps(header, separators=(",", ":"), allow_nan=False).encode("ascii")
    text += b" " * (-len(text) % 4)
    data += b"\0" * (-len(data) % 4)
    chunks = b"".join(
        len(body).to_bytes(4, "little") + kind + body
        for kind, body in ((b"JSON", text), (b"BIN\0", data))
    )
    return b"glTF" + (2).to_bytes(4, "little") + (12 + len(chunks)).to_bytes(4, "little") + chunks


# The impending motion of an assembly, or its fall, as an animated GLB.


MOVES, RESTS = 2.0, 1.0
"""Duration of the motion, and of the pause before it is shown again [s]."""
KEYS = 25
"""Number of key frames of a track along the motion."""


def film_of_motion(assembly: Assembly, travel: Array) -> bytes:
    """Encode the start of a motion as a GLB film: the parts accelerate, then pause.

    Arguments: `travel` (N, 6): finite screw motion of each part (`kilter.rigid.screwed`): shift
    [length unit] and rotation vector [rad].
    """
    film, share = Film(assembly), np.linspace(0.0, 1.0, KEYS)
    times, amounts = np.append(MOVES * share, MOVES + RESTS), np.append(share**2, 1.0)
    for part in np.flatnonzero(travel.any(axis=1)).tolist():
        _move(film, assembly, part, times, *screwed(travel[part], amounts))
    return film.to_bytes("motion")


def film_of_movement(assembly: Assembly, movement: Array, name: str) -> bytes:
    """Encode a small movement of the parts, shape (N, 6), as a GLB film with a named animation.

    The centres of mass move on straight lines, so parts that meet stay near each other.
    """
    share = np.linspace(0.0, 1.0, KEYS)
    return film_of_fall(assembly, share[:, None, None] * movement, share, name)


def film_of_fall(assembly: Assembly, motions: Array, lengths: Array, name: str = "fall") -> bytes:
    """Encode the fall of parts along a path as a GLB film: the parts accelerate, then pause.

    Arguments: `motions` (k, N, 6): shifts of the centres of mass [length unit] and rotation vectors
    [rad]; the first row is the rest position; `lengths` (k,): length of the path up to each row
    [length unit]; `name`: name of the animation.
    """
    from scipy.spatial.transform import Rotation

    film, share = Film(assembly), np.sqrt(lengths / lengths[-1])
    times, path = np.append(MOVES * share, MOVES + RESTS), np.append(motions, motions[-1:], axis=0)
    for part in np.flatnonzero(motions.any(axis=(0, 2))).tolist():
        turns = Rotation.from_rotvec(path[:, part, 3:]).as_matrix()
        _move(film, assembly, part, times, turns, path[:, part, :3])
    return film.to_bytes(name)


def _move(
    film: Film, assembly: Assembly, part: int, times: Array, turns: Array, shifts: Array
) -> None:
    """Add tracks of rotation and position to the node of a part.

    `turns`, shape (k, 3, 3), rotate about the centre of mass; `shifts`, shape (k, 3), move it.
    """
    center, places = assembly.geometry.center[part], film.places
    arm, rest = places.position[part] - center, quaternion_to_matrix(places.rotation[part])
    film.animate(part, "translation", times, center - film.center + turns @ arm + shifts)
    quaternions = [xyzw(matrix_to_quaternion(turn @ rest)) for turn in turns]
    film.animate(part, "rotation", times, _continuous(np.array(quaternions)))


def _continuous(quaternions: Array) -> Array:
    """Choose the signs of quaternions, (k, 4), so that interpolation takes the shorter rotation."""
    agree = np.einsum("ij,ij->i", quaternions[1:], quaternions[:-1])
    signs = np.cumprod(np.append(1.0, np.where(agree < 0, -1.0, 1.0)))
    return quaternions * signs[:, None]
