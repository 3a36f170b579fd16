"""Read 3MF: a zip of XML models, whose build items place objects.

The unit is that of the file (default millimetre). An object made of components gives one solid
per component. Objects may be in other models of the same zip.

References
----------
3MF Consortium, Core Specification 1.3, sections 3.4 (units), 4.1 (meshes), 4.2 (components);
Production Extension 1.1, section 2 (paths).
"""

from __future__ import annotations

import io
import zipfile
from collections.abc import Iterator
from dataclasses import dataclass
from xml.etree import ElementTree

import numpy as np

from kilter.arrays import Array, Index
from kilter.errors import InputError
from kilter.files.limits import DEEPEST, Tally, require_few_entries, require_unfolded
from kilter.files.meshes.placed import scale_mesh, text_accuracy, transform_mesh
from kilter.shape.primitives import Mesh

UNITS = {
    "micron": ("mm", 0.001),
    "millimeter": ("mm", 1.0),
    "centimeter": ("cm", 1.0),
    "inch": ("in", 1.0),
    "foot": ("in", 12.0),
    "meter": ("m", 1.0),
}
"""kilter's unit for each unit of 3MF, and the length of the 3MF unit in it."""

_PATH = "{http://schemas.microsoft.com/3dmanufacturing/production/2015/06}path"
_RELATIONS = "_rels/.rels"
_DAMAGED = "export it again: it is incomplete or damaged"


@dataclass(frozen=True, slots=True, eq=False)
class _Object:
    """An object of a 3MF model: a mesh, or components that place other objects."""

    name: str
    vertices: Array
    faces: Index
    components: list[tuple[str, str, Array]]


def read_3mf(data: bytes) -> tuple[list[tuple[str | None, Mesh]], str, list[str]]:
    """Read the meshes of a 3MF file with their names, and its length unit.

    Returns `solids`: name and mesh, at its place; `units`: length unit of the meshes. Raises
    `InputError` if an item names an object that does not exist, or a value is invalid. A damaged
    zip or XML raises the exceptions of the libraries, which the caller's guard converts.
    """
    with zipfile.ZipFile(io.BytesIO(data)) as archive, np.errstate(all="ignore"):
        require_unfolded(sum(entry.file_size for entry in archive.infolist()), len(data))
        return _read(archive)


def _read(archive: zipfile.ZipFile) -> tuple[list[tuple[str | None, Mesh]], str, list[str]]:
    """Meshes in the build section of an opened 3MF file, its length unit, and notes."""
    root_path = _root_path(archive)
    root = _xml(archive, root_path)
    unit = root.get("unit", "millimeter")
    if unit not in UNITS:
        raise InputError(f"unit {unit!r:.80} is not a unit of 3MF", hint=f"use {', '.join(UNITS)}")
    units, factor = UNITS[unit]
    models, tally = {root_path: _objects(root, root_path)}, Tally()
    solids: list[tuple[str | None, Mesh]] = []
    placements: list[tuple[_Object, Array, str]] = []
    for item in _children(root, "build", "item"):
        start = (item.get(_PATH, root_path).strip("/"), item.attrib["objectid"])
        placements += _leaves(archive, models, start, _transform(item), tally)
    values = [o.vertices.reshape(-1) for model in models.values() for o in model.values()]
    accuracy = text_accuracy(np.concatenate([*values, np.empty(0)]))
    empty = sum(not len(item_object.faces) for item_object, _, _ in placements)
    for item_object, matrix, above in placements:
        if not len(item_object.faces):
            continue
        name = item_object.name or above or None
        vertices = item_object.vertices
        try:
            mesh = Mesh(vertices, item_object.faces, accuracy=accuracy(vertices))
        except InputError as error:
            raise error.located(part=name) from None
        solids.append((name, scale_mesh(transform_mesh(mesh, matrix), factor)))
    notes = [f"{empty} objects without triangles are ignored"] if empty else []
    return solids, units, notes


def _xml(archive: zipfile.ZipFile, path: str) -> ElementTree.Element:
    """The root element of an XML file of the zip."""
    text = archive.read(path)
    require_few_entries(text)
    return ElementTree.fromstring(text)


def _root_path(archive: zipfile.ZipFile) -> str:
    """Path inside the zip of the main model: the one that its relations name, else the first."""
    if _RELATIONS in archive.namelist():
        for relation in _xml(archive, _RELATIONS):
            if relation.get("Type", "").endswith("/3dmodel"):
                return relation.attrib["Target"].strip("/")
    usual = (name for name in archive.namelist() if name.lower().endswith(".model"))
    path = next(usual, None)
    if path is None:
        raise InputError("not a 3MF file: the zip has no model", hint=_DAMAGED)
    return path


def _leaves(
    archive: zipfile.ZipFile,
    models: dict[str, dict[str, _Object]],
    start: tuple[str, str],
    matrix: Array,
    tally: Tally,
) -> Iterator[tuple[_Object, Array, str]]:
    """Yield the meshes in the component tree below an object, with their matrices.

    Arguments: `models`: objects of each model by path and id; models of other paths are added when
    needed; `matrix` (4, 4): placement of that object. Yields object, its placement, and the nearest
    name above it.
    """
    pending = [(start, matrix, "", frozenset[tuple[str, str]]())]
    while pending:
        (path, key), matrix, above, chain = pending.pop()
        if path not in models:
            models[path] = _objects(_xml(archive, path), path)
        if key not in models[path]:
            raise InputError(f"object {key!r:.80} is not in {path:.80}", hint=_DAMAGED)
        if (path, key) in chain:
            raise InputError(f"object {key!r:.80} contains itself", hint=_DAMAGED)
        if len(chain) > DEEPEST:
            raise InputError(f"components are nested deeper than {DEEPEST}", hint=_DAMAGED)
        node = models[path][key]
        tally.add(10 + len(node.faces))  # empty objects cost time too
        if len(node.faces) or not node.components:
            yield node, matrix, above
        below = [
            ((model, child), matrix @ step, node.name or above, chain | {(path, key)})
            for model, child, step in node.components
        ]
        pending.extend(reversed(below))


def _children(element: ElementTree.Element, *tags: str) -> list[ElementTree.Element]:
    """XML elements at the end of a path of tags below an element, in any namespace."""
    elements = [element]
    for tag in tags:
        elements = [c for e in elements for c in e if str(c.tag).rpartition("}")[2] == tag]
    return elements


def _objects(root: ElementTree.Element, path: str) -> dict[str, _Object]:
    """All objects of a 3MF model file by their id."""
    objects = {}
    for element in _children(root, "resources", "object"):
        name = element.get("name", "").strip()
        try:
            vertices, faces = _mesh(element)
        except (KeyError, ValueError) as error:
            raise InputError(
                f"damaged 3MF: the mesh has {error}"[:120],
                part=name or element.get("id"),
                hint=_DAMAGED,
            ) from None
        components = [
            (c.get(_PATH, path).strip("/"), c.attrib["objectid"], _transform(c))
            for c in _children(element, "components", "component")
        ]
        objects[element.attrib["id"]] = _Object(name, vertices, faces, components)
    return objects


def _mesh(element: ElementTree.Element) -> tuple[Array, Index]:
    """Vertices, shape (n, 3), and triangles, shape (m, 3), of an object element."""
    corners = [
        (float(v.attrib["x"]), float(v.attrib["y"]), float(v.attrib["z"]))
        for v in _children(element, "mesh", "vertices", "vertex")
    ]
    faces = [
        (int(t.attrib["v1"]), int(t.attrib["v2"]), int(t.attrib["v3"]))
        for t in _children(element, "mesh", "triangles", "triangle")
    ]
    return (
        np.array(corners, dtype=np.float64).reshape(-1, 3),
        np.array(faces, dtype=np.int64).reshape(-1, 3),
    )


def _transform(element: ElementTree.Element) -> Array:
    """The 4 x 4 matrix, for column vectors, of a 3MF `transform` attribute; default identity."""
    matrix = np.eye(4)
    text = element.get("transform")
    if text is not None:
        numbers = [float(token) for token in text.split()]
        if len(numbers) != 12 or not np.isfinite(numbers).all():
            raise InputError(f"damaged 3MF: transform is {text[:60]!r}", hint="give 12 numbers")
        matrix[:3] = np.array(numbers).reshape(4, 3).T
    return matrix
