"""The header of a GLB file as pydantic models: of glTF 2.0, what a mesh and its place need.

Keys that are not named here (materials, cameras, animations) are passed over.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, Field

__all__ = ["Accessor", "Gltf", "Node", "Primitive", "Sparse"]

Count = Annotated[int, Field(strict=True, ge=0)]
Number = Annotated[float, Field(strict=True)]
Vector = Annotated[list[Number], Field(min_length=3, max_length=3)]
Component = Literal[5120, 5121, 5122, 5123, 5125, 5126]


class View(BaseModel):
    """A run of bytes."""

    byteOffset: Count = 0
    byteStride: Annotated[int, Field(strict=True, gt=0)] | None = None


class SparsePart(BaseModel):
    """Where numbers that stand apart are."""

    bufferView: Count
    byteOffset: Count = 0


class SparseIndices(SparsePart):
    """Which rows they are of."""

    componentType: Literal[5121, 5123, 5125]


class Sparse(BaseModel):
    """Rows that differ from the others."""

    count: Count
    indices: SparseIndices
    values: SparsePart


class Accessor(BaseModel):
    """Rows of numbers."""

    componentType: Component
    count: Count
    type: str
    bufferView: Count | None = None
    byteOffset: Count = 0
    normalized: bool = False
    sparse: Sparse | None = None


class Primitive(BaseModel):
    """Triangles of one material."""

    attributes: dict[str, Count]
    indices: Count | None = None
    mode: int = 4
    extensions: dict[str, Any] = {}


class GltfMesh(BaseModel):
    """Primitives under one name."""

    name: str | None = None
    primitives: list[Primitive]


class Node(BaseModel):
    """A mesh, or other nodes, in a place."""

    name: str | None = None
    mesh: Count | None = None
    children: list[Count] = []
    matrix: Annotated[list[Number], Field(min_length=16, max_length=16)] | None = None
    rotation: Annotated[list[Number], Field(min_length=4, max_length=4)] = [0.0, 0.0, 0.0, 1.0]
    scale: Vector = [1.0, 1.0, 1.0]
    translation: Vector = [0.0, 0.0, 0.0]


class Scene(BaseModel):
    """The nodes at the top."""

    nodes: list[Count] = []


class Buffer(BaseModel):
    """Bytes, here or in another file."""

    uri: str | None = None


class Gltf(BaseModel):
    """The header."""

    accessors: list[Accessor] = []
    bufferViews: list[View] = []
    buffers: list[Buffer] = []
    meshes: list[GltfMesh] = []
    nodes: list[Node] = []
    scenes: list[Scene] = []
    scene: Count = 0
    extensionsRequired: list[str] = []
