"""3MF: a zip of XML models; the objects of its build, each where its items put it.

The unit is the file's own (millimetre where it states none). An object made of components
gives one solid a component. Objects may be in other models of the same zip.

References
----------
3MF Consortium, Core Specification 1.3, sections 3.4 (units), 4.1 (meshes), 4.2 (components);
Production Extension 1.1, section 2 (paths).
"""

from __future__ import annotations

import io
import zipfile
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from xml.etree import ElementTree

import numpy as np

from kilter.arrays import Array, Index
from kilter.errors import InputError
from kilter.files.accuracy import text_accuracy
from kilter.files.limits import Tally, require_few_entries, require_unfolded
from kilter.files.placed import placed, scaled
from kilter.shape.primitives import Mesh

__all__ = ["read_3mf"]


UNITS = {
    "micron": ("mm", 0.001),
    "millimeter": ("mm", 1.0),
    "centimeter": ("cm", 1.0),
    "inch": ("in", 1.0),
    "foot": ("in", 12.0),
    "meter": ("m", 1.0),
}
"""Unit of a 3MF file: the unit it is read in, and how many of those it is."""

_PATH = "{http://schemas.microsoft.com/3dmanufacturing/production/2015/06}path"
_RELATIONS = "_rels/.rels"
_DAMAGED = "export it again: it was cut short or damaged"


@dataclass(frozen=True, slots=True, eq=False)
class _Object:
    name: str
    vertices: Array
    faces: Index
    components: list[tuple[str, str, Array]]


def read_3mf(data: bytes) -> tuple[list[tuple[str | None, Mesh]], str]:
    """The solids of a 3MF file with their names, and the unit they are in.

    Raises
    ------
    InputError
        If the zip or its XML is damaged, or an item names an object that is not there.
    """
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive, np.errstate(all="ignore"):
            require_unfolded(sum(one.file_size for one in archive.infolist()), len(data))
            return _read(archive)
    except (zipfile.BadZipFile, zlib.error, EOFError, RuntimeError, OSError) as error:
        raise InputError(f"damaged 3MF: {error}"[:120], hint=_DAMAGED) from None
    except ElementTree.ParseError as error:
        raise InputError(f"damaged 3MF: its XML is wrong, {error}", hint=_DAMAGED) from None
    except LookupError as error:
        raise InputError(f"damaged 3MF: {error} is missing", hint=_DAMAGED) from None
    except (ValueError, OverflowError) as error:
        raise InputError(f"damaged 3MF: {error}"[:120], hint=_DAMAGED) from None


def _read(archive: zipfile.ZipFile) -> tuple[list[tuple[str | None, Mesh]], str]:
    root_path = _root_path(archive)
    root = _xml(archive, root_path)
    unit = root.get("unit", "millimeter")
    if unit not in UNITS:
        raise InputError(f"unit {unit!r} is not one of 3MF", hint=f"use {', '.join(UNITS)}")
    units, factor = UNITS[unit]
    models, tally = {root_path: _objects(root, root_path)}, Tally()
    found: list[tuple[str | None, Mesh]] = []
    placements: list[tuple[_Object, Array, str]] = []
    for item in _children(root, "build", "item"):
        start = (item.get(_PATH, root_path).strip("/"), item.attrib["objectid"])
        placements += _leaves(archive, models, start, _transform(item), tally)
    values = [o.vertices.reshape(-1) for model in models.values() for o in model.values()]
    accuracy = text_accuracy(np.concatenate([*values, np.empty(0)]))
    for thing, matrix, above in placements:
        name = thing.name or above or None
        try:
            mesh = Mesh(thing.vertices, thing.faces, accuracy=accuracy(thing.vertices))
        except InputError as error:
            raise error.located(part=name) from None
        found.append((name, scaled(placed(mesh, matrix), factor)))
    return found, units


def _xml(archive: zipfile.ZipFile, path: str) -> ElementTree.Element:
    """A text of the zip."""
    text = archive.read(path)
    require_few_entries(text)
    return ElementTree.fromstring(text)


def _root_path(archive: zipfile.ZipFile) -> str:
    """The model that the zip's relations name, else the usual one."""
    if _RELATIONS in archive.namelist():
        for relation in _xml(archive, _RELATIONS):
            if relation.get("Type", "").endswith("/3dmodel"):
                return relation.attrib["Target"].strip("/")
    usual = (name for name in archive.namelist() if name.lower().endswith(".model"))
    path = next(usual, None)
    if path is None:
        raise InputError("not a 3MF file: it has no model", hint=_DAMAGED)
    return path


def _leaves(
    archive: zipfile.ZipFile,
    models: dict[str, dict[str, _Object]],
    start: tuple[str, str],
    matrix: Array,
    tally: Tally,
) -> Iterator[tuple[_Object, Array, str]]:
    """Objects with a mesh under an item, where they are, and the name of the one above."""
    pending = [(start, matrix, "", frozenset[tuple[str, str]]())]
    while pending:
        (path, key), matrix, above, chain = pending.pop()
        if path not in models:
            models[path] = _objects(_xml(archive, path), path)
        if key not in models[path]:
            raise InputError(f"object {key!r} is not in {path}", hint=_DAMAGED)
        if (path, key) in chain:
            raise InputError(f"object {key!r} is made of itself", hint=_DAMAGED)
        thing = models[path][key]
        tally.add(10 + len(thing.faces))  # a place alone counts too
        if len(thing.faces):
            yield thing, matrix, above
        below = [
            ((where, child), matrix @ own, thing.name or above, chain | {(path, key)})
            for where, child, own in thing.components
        ]
        pending.extend(reversed(below))


def _children(element: ElementTree.Element, *tags: str) -> list[ElementTree.Element]:
    """Elements at the end of a path of tags, whatever their namespace."""
    found = [element]
    for tag in tags:
        found = [c for e in found for c in e if str(c.tag).rpartition("}")[2] == tag]
    return found


def _objects(root: ElementTree.Element, path: str) -> dict[str, _Object]:
    objects = {}
    for element in _children(root, "resources", "object"):
        name = element.get("name", "").strip()
        try:
            vertices, faces = _mesh(element)
        except (KeyError, ValueError) as error:
            raise InputError(
                f"damaged 3MF: its mesh has {error}"[:120],
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
    """The 4 x 4 matrix (columns) of a 3MF transform, written as 12 numbers by rows."""
    matrix = np.eye(4)
    text = element.get("transform")
    if text is not None:
        numbers = [float(token) for token in text.split()]
        if len(numbers) != 12 or not np.isfinite(numbers).all():
            raise InputError(f"damaged 3MF: transform is {text[:60]!r}", hint="give 12 numbers")
        matrix[:3] = np.array(numbers).reshape(4, 3).T
    return matrix
