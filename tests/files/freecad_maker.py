"""Write FreeCAD documents by hand: the zip, its XML, and BREP files by OCCT."""

import io
import struct
import zipfile
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any
from xml.sax.saxutils import escape, quoteattr

import numpy as np
import pytest

pytest.importorskip("OCP")

from OCP.BRepTools import BRepTools
from OCP.gp import gp_Trsf
from OCP.TopLoc import TopLoc_Location

from kilter.rigid import matrix_to_quaternion

KINDS = ("Fixed", "Revolute", "Cylindrical", "Slider", "Ball", "Distance", "Parallel")


def numbers_of(matrix: Any) -> list[float]:
    """Position and quaternion (x, y, z, w) of a 4 x 4 matrix."""
    w, x, y, z = matrix_to_quaternion(matrix[:3, :3]).tolist()
    return [*matrix[:3, 3].tolist(), x, y, z, w]


def transform(matrix: Any) -> Any:
    move = gp_Trsf()
    move.SetValues(*matrix[:3].reshape(-1).tolist())
    return move


def prop(name: str, kind: str, content: str) -> str:
    return f"<Property name={quoteattr(name)} type={quoteattr(f'App::{kind}')}>{content}</Property>"


def text(name: str, value: str) -> str:
    return prop(name, "PropertyString", f"<String value={quoteattr(value)}/>")


def flag(name: str, value: bool) -> str:
    return prop(name, "PropertyBool", f"<Bool value='{str(value).lower()}'/>")


def link(name: str, value: str) -> str:
    return prop(name, "PropertyLink", f"<Link value={quoteattr(value)}/>")


def links(name: str, values: Sequence[str]) -> str:
    rows = "".join(f"<Link value={quoteattr(value)}/>" for value in values)
    return prop(name, "PropertyLinkList", f"<LinkList count='{len(values)}'>{rows}</LinkList>")


def place(matrix: Any, name: str = "Placement") -> str:
    keys = ("Px", "Py", "Pz", "Q0", "Q1", "Q2", "Q3")
    pairs = zip(keys, numbers_of(matrix), strict=True)
    words = " ".join(f'{key}="{value!r}"' for key, value in pairs)
    return prop(name, "PropertyPlacement", f"<PropertyPlacement {words}/>")


def xlink(name: str, target: str, file: str = "", subs: Sequence[str] = ()) -> str:
    rows = "".join(f"<Sub value={quoteattr(sub)}/>" for sub in subs)
    names = f"file={quoteattr(file)} stamp='' name={quoteattr(target)}"
    return prop(name, "PropertyXLink", f"<XLink {names} count='{len(subs)}'>{rows}</XLink>")


class Maker:
    """A FreeCAD document while it is made."""

    def __init__(self) -> None:
        self.objects: dict[str, tuple[str, list[str]]] = {}
        self.files: dict[str, bytes] = {}

    def add(self, kind: str, name: str, *properties: str, label: str = "") -> str:
        self.objects[name] = kind, [text("Label", label or name), *properties]
        return name

    def shape(
        self, solid: Any, matrix: Any = None, *, located: bool = True, name: str = "Shape"
    ) -> str:
        """A stored shape with a placement; `located`: whether the file has the placement, too."""
        file, stream = f"PartShape{len(self.files)}.brp", io.BytesIO()
        if matrix is not None and located:
            solid = solid.Located(TopLoc_Location(transform(matrix)))
        BRepTools.Write_s(solid, stream)
        self.files[file] = stream.getvalue()
        stored = prop(name, "PropertyPartShape", f"<Part file='{file}'/>")
        return stored if matrix is None else stored + place(matrix)

    def rows(self, name: str, kind: str, values: Iterable[Sequence[float]]) -> str:
        """A list of rows of numbers in a binary file."""
        table, file = list(values), f"{name}{len(self.files)}"
        flat = [number for row in table for number in row]
        self.files[file] = struct.pack(f"<I{len(flat)}d", len(table), *flat)
        return prop(name, f"Property{kind}", f"<{kind} file='{file}'/>")

    def joint(
        self,
        kind: str,
        name: str,
        ends: Sequence[tuple[str, Sequence[str], Any]],
        *properties: str,
    ) -> str:
        """A joint: for each end the object, the path in it, and the frame in the part."""
        words = "".join(f"<Enum value='{word}'/>" for word in KINDS)
        index = f"<Integer value='{KINDS.index(kind)}' CustomEnum='true'/>"
        sides = [
            xlink(f"Reference{k}", target, subs=subs) + place(frame, f"Placement{k}")
            for k, (target, subs, frame) in enumerate(ends, start=1)
        ]
        chosen = prop(
            "JointType",
            "PropertyEnumeration",
            f"{index}<CustomEnumList count='{len(KINDS)}'>{words}</CustomEnumList>",
        )
        return self.add("App::FeaturePython", name, chosen, *sides, *properties)

    def held(self, name: str, target: str, *properties: str) -> str:
        return self.add("App::FeaturePython", name, link("ObjectToGround", target), *properties)

    def write(self, path: Path, *, hidden_in_view: Sequence[str] = ()) -> Path:
        listed = "".join(
            f"<Object type={quoteattr(kind)} name={quoteattr(name)}/>"
            for name, (kind, _) in self.objects.items()
        )
        data = "".join(
            f"<Object name={quoteattr(name)}><Properties>{''.join(rows)}</Properties></Object>"
            for name, (_, rows) in self.objects.items()
        )
        deps = f"<ObjectDeps Name={quoteattr(escape('x'))} Count='0'/>"
        document = (
            "<?xml version='1.0' encoding='utf-8'?><Document SchemaVersion='4' FileVersion='1'>"
            f"<Objects>{deps}{listed}</Objects><ObjectData>{data}</ObjectData></Document>"
        )
        views = "".join(
            f"<ViewProvider name={quoteattr(name)}><Properties>{flag('Visibility', False)}"
            "</Properties></ViewProvider>"
            for name in hidden_in_view
        )
        view = f"<Document><ViewProviderData>{views}</ViewProviderData></Document>"
        with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
            for name, content in {
                "Document.xml": document.encode(),
                **self.files,
                "GuiDocument.xml": view.encode(),
            }.items():
                # the time is fixed, so that equal documents are equal files
                archive.writestr(zipfile.ZipInfo(name), content)
        return path


def rigid(rng: np.random.Generator) -> Any:
    """A random turn and step as a 4 x 4 matrix."""
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    matrix = np.eye(4)
    matrix[:3, :3] = turn * np.sign(np.linalg.det(turn))
    matrix[:3, 3] = rng.uniform(-50, 50, 3)
    return matrix


def at(x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Any:
    """A step as a 4 x 4 matrix."""
    matrix = np.eye(4)
    matrix[:3, 3] = x, y, z
    return matrix
