"""Pydantic models of a GLB header: the subset of glTF 2.0 that describes meshes and placements.

Other keys (materials, cameras, animations) are ignored.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, Field

Count = Annotated[int, Field(strict=True, ge=0)]
Number = Annotated[float, Field(strict=True)]
Vector = Annotated[list[Number], Field(min_length=3, max_length=3)]
Component = Literal[5120, 5121, 5122, 5123, 5125, 5126]


class View(BaseModel):
    """A range of bytes of the binary chunk."""

    buffer: Count = 0
    byteOffset: Count = 0
    byteStride: Annotated[int, Field(strict=True, gt=0)] | None = None


class SparsePart(BaseModel):
    """Place in the binary chunk of the numbers that overwrite rows of an accessor."""

    bufferView: Count
    byteOffset: Count = 0


class SparseIndices(SparsePart):
    """Place in the binary chunk of the indices of the overwritten rows of an accessor."""

    componentType: Literal[5121, 5123, 5125]


class Sparse(BaseModel):
    """Section of an accessor that overwrites some of its rows with separately stored numbers."""

    count: Count
    indices: SparseIndices
    values: SparsePart


class Accessor(BaseModel):
    """Description of an array of numbers: type, length, and place in the binary chunk."""

    componentType: Component
    count: Count
    type: str
    bufferView: Count | None = None
    byteOffset: Count = 0
    normalized: bool = False
    sparse: Sparse | None = None


class Primitive(BaseModel):
    """Triangles of a mesh that have the same material."""

    attributes: dict[str, Count]
    indices: Count | None = None
    mode: int = 4
    extensions: dict[str, Any] = {}


class GltfMesh(BaseModel):
    """A mesh: its name and its primitives."""

    name: str | None = None
    primitives: list[Primitive]


class Node(BaseModel):
    """A node of the scene: a transform with a mesh, or with child nodes."""

    name: str | None = None
    mesh: Count | None = None
    children: list[Count] = []
    matrix: Annotated[list[Number], Field(min_length=16, max_length=16)] | None = None
    rotation: Annotated[list[Number], Field(min_length=4, max_length=4)] = [0.0, 0.0, 0.0, 1.0]
    scale: Vector = [1.0, 1.0, 1.0]
    translation: Vector = [0.0, 0.0, 0.0]


class Scene(BaseModel):
    """A scene: its root nodes."""

    nodes: list[Count] = []


class Buffer(BaseModel):
    """A block of bytes, in the file itself or in another file (`uri`)."""

    uri: str | None = None


class Gltf(BaseModel):
    """The JSON header of a GLB file."""

    accessors: list[Accessor] = []
    bufferViews: list[View] = []
    buffers: list[Buffer] = []
    meshes: list[GltfMesh] = []
    nodes: list[Node] = []
    scenes: list[Scene] = []
    scene: Count = 0
    extensionsRequired: list[str] = []
