"""Read a FreeCAD document (.FCStd): its objects with their properties, and its stored shapes.

The file is a zip. ``Document.xml`` lists the objects, each shape is a further file in OCCT's BREP
format, and ``GuiDocument.xml`` has the visibility of older versions. Python objects in it are
pickled; only the module and the class that they name are read.
"""

from __future__ import annotations

import io
import zipfile
from collections.abc import Iterator
from functools import cached_property
from pathlib import Path, PureWindowsPath
from typing import Any
from xml.etree import ElementTree

import numpy as np

from kilter.arrays import Array
from kilter.errors import InputError
from kilter.files.limits import (
    is_file,
    named_path,
    read_bytes,
    require_few_entries,
    require_unfolded,
)
from kilter.files.reader_guard import ZIP_DAMAGE, reader_guard
from kilter.rigid import quaternion_to_matrix

_LINKS = ("Link", "XLink", "LinkSub")
"""Elements of a property that name another object."""


class FreeCadObject:
    """An object of a FreeCAD document: its name, type, label and properties."""

    def __init__(self, document: FreeCadDocument, name: str, kind: str) -> None:
        self.document = document
        self.name = name
        self.kind = kind
        """Type, such as ``Part::Cut``."""
        self.properties: dict[str, ElementTree.Element] = {}

    @property
    def label(self) -> str:
        """The name that the user sees."""
        return self.text("Label").strip() or self.name

    def value(self, name: str, key: str = "value") -> str | None:
        """Attribute of the first element of a property; None if there is no such property."""
        content = self.properties.get(name)
        return None if content is None or not len(content) else content[0].get(key)

    def text(self, name: str) -> str:
        """The text of a property; empty if there is no such property."""
        return self.value(name) or ""

    def flag(self, name: str, default: bool = False) -> bool:
        """The value of a Boolean property."""
        stated = self.value(name)
        return default if stated is None else stated == "true"

    def choice(self, name: str) -> tuple[int, list[str]]:
        """Index of an enumeration, and the words that the file lists for it."""
        content = self.properties.get(name)
        words = [] if content is None else [e.get("value", "") for e in content.iter("Enum")]
        return int(self.value(name) or 0), words

    def links(self, name: str) -> list[FreeCadObject]:
        """Objects of the same document that a property names."""
        return [self.document.objects[key] for key in self._named(name) if key in self.document]

    def all_links(self, but: tuple[str, ...]) -> Iterator[FreeCadObject]:
        """Objects of the same document that any property names, except the properties `but`."""
        for name in self.properties:
            if name not in but:
                yield from self.links(name)

    def _named(self, name: str) -> Iterator[str]:
        """Names of objects of this document in a property."""
        content = self.properties.get(name)
        for entry in () if content is None else content.iter():
            if entry.tag in _LINKS and not entry.get("file"):
                yield entry.get("value") or entry.get("obj") or entry.get("name") or ""

    @property
    def placement(self) -> Array:
        """The 4 x 4 matrix of the placement of the object; the identity if it has none."""
        name = "LinkPlacement" if "LinkPlacement" in self.properties else "Placement"
        return self.matrix(name)

    def matrix(self, name: str) -> Array:
        """The 4 x 4 matrix of a property that is a placement."""
        content = self.properties.get(name)
        if content is None or not len(content):
            return np.eye(4)
        keys = ("Px", "Py", "Pz", "Q0", "Q1", "Q2", "Q3")
        return placement_matrix([float(content[0].get(key, "0")) for key in keys])

    @property
    def visible(self) -> bool:
        """Whether the file shows the object."""
        if "Visibility" in self.properties:
            return self.flag("Visibility", True)
        return self.name not in self.document.hidden_in_view

    @property
    def shape_file(self) -> str:
        """Name of the file in the zip with the shape of the object; empty if none is stored."""
        name = self.value("Shape", "file") or ""
        return name if self.document.size(name) else ""


def placement_matrix(numbers: list[float] | Array) -> Array:
    """The 4 x 4 matrix of a placement: position, then quaternion (x, y, z, w).

    Raises `InputError` if a number is not finite, or the quaternion is zero.
    """
    values = np.asarray(numbers, dtype=np.float64)
    length = float(np.linalg.norm(values[3:]))
    if not np.isfinite(values).all() or not np.isfinite(length) or length == 0.0:
        raise InputError(f"a placement is {values.tolist()}"[:160], hint="save the document again")
    matrix = np.eye(4)
    matrix[:3, :3] = quaternion_to_matrix(values[[6, 3, 4, 5]])
    matrix[:3, 3] = values[:3]
    return matrix


class FreeCadDocument:
    """A FreeCAD document: its objects by name, and the files of its zip.

    Raises `InputError` if the file is missing, damaged, or no FreeCAD document.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.objects: dict[str, FreeCadObject] = {}
        with reader_guard(path, ZIP_DAMAGE):
            data = read_bytes(path)
            self._archive = zipfile.ZipFile(io.BytesIO(data))
            self._sizes = {entry.filename: entry.file_size for entry in self._archive.infolist()}
            require_unfolded(sum(self._sizes.values()), len(data))
            if "Document.xml" not in self._sizes:
                raise InputError(
                    "not a FreeCAD document: the zip has no Document.xml",
                    hint="save it again in FreeCAD",
                )
            self._read(self._root("Document.xml"))

    def __contains__(self, name: str) -> bool:
        return name in self.objects

    def _root(self, name: str) -> ElementTree.Element:
        """The root element of an XML file of the zip."""
        text = self._archive.read(name)
        require_few_entries(text)
        return ElementTree.fromstring(text)

    def _read(self, root: ElementTree.Element) -> None:
        """Read the objects and their properties."""
        for entry in root.iterfind("Objects/Object"):
            name = entry.get("name", "")
            self.objects[name] = FreeCadObject(self, name, entry.get("type", ""))
        for entry in root.iterfind("ObjectData/Object"):
            known = self.objects.get(entry.get("name", ""))
            if known is not None:
                known.properties = {p.get("name", ""): p for p in entry.iterfind("Properties/*")}

    @cached_property
    def hidden_in_view(self) -> frozenset[str]:
        """Names of the objects that GuiDocument.xml hides."""
        if not self.size("GuiDocument.xml"):
            return frozenset()
        views = self._root("GuiDocument.xml").iterfind("ViewProviderData/ViewProvider")
        return frozenset(
            view.get("name", "")
            for view in views
            for entry in view.iterfind("Properties/Property[@name='Visibility']/Bool")
            if entry.get("value") == "false"
        )

    def size(self, name: str) -> int:
        """Size of a file of the zip [bytes]; 0 if there is none."""
        return self._sizes.get(name, 0)

    def content(self, name: str) -> bytes:
        """A file of the zip."""
        return self._archive.read(name)

    def rows(self, item: FreeCadObject, name: str, width: int) -> Array:
        """Rows of `width` numbers of a property that is stored in a file of the zip.

        The file has the number of rows (4 bytes), and then numbers of 8 bytes, or of 4 in older
        versions.
        """
        file = item.value(name, "file") or ""
        data = self.content(file) if self.size(file) > 4 else b"\0\0\0\0"
        count = int.from_bytes(data[:4], "little")
        kind = "<f8" if len(data) >= 4 + 8 * width * count else "<f4"
        numbers = np.frombuffer(data[4:], kind, count=width * count)
        return numbers.astype(np.float64).reshape(-1, width)

    def beside(self, name: str) -> Path:
        """Path of a document that this one names: the given path, or else a file beside this one.

        Raises `InputError` if there is no such file in the folder of this document or below.
        """
        folder = self.path.parent
        try:
            path = named_path(folder, name)
            if is_file(path):
                return path
        except InputError:
            pass
        path = named_path(folder, PureWindowsPath(name).name)
        if not is_file(path):
            raise InputError("no such file", hint="put it beside the document")
        return path


def python_class(item: FreeCadObject) -> tuple[str, str]:
    """Module and class of the Python code of an object; the pickled object is not read."""
    return item.value("Proxy", "module") or "", item.value("Proxy", "class") or ""


def stated_map(item: FreeCadObject, name: str) -> dict[str, Any]:
    """Keys and values of a property that is a map."""
    content = item.properties.get(name)
    entries = () if content is None else content.iter("Item")
    return {entry.get("key", ""): entry.get("value", "") for entry in entries}
