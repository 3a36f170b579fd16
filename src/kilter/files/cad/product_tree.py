"""Walk the product tree of an OCCT document: its solids with their names and places.

A product that is used in several places is a shape with several placements. Neighbours with the
same name are numbered. The name of a part has as many products above it as needed to make it
unique: ``rod``, ``l-bracket-assembly_2/l-bracket``. Shapes that are not solids are sewn to solids
if they close, and are listed otherwise.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

from kilter.files.cad.sewn_solids import sewn_solids
from kilter.files.cad.step_statements import UNSTATED, Stated, StepStatements
from kilter.files.cad.step_surfaces import inside, labels, shape_map
from kilter.files.file_tolerances import RIGID
from kilter.files.meshes.placed import distinct, tails
from kilter.rigid import Pose

NUMBERED = re.compile(r"Open CASCADE STEP translator [\d.]+( [\d.]+)?")
"""Names that an exporter gives to products without a name."""


@dataclass(frozen=True, slots=True, eq=False)
class Occurrence:
    """A placed copy of a solid in the product tree of a STEP file."""

    name: str
    shape: Any
    """Shape in its own frame."""
    key: int
    """Number of the solid, equal for all its occurrences."""
    pose: Pose
    """Transform from the frame of the solid to that of the file."""
    skin: bool = False
    """Whether the file has a shell instead of a solid; it counts only if it closes."""
    stated: Stated = UNSTATED
    """Statements of the file about the solid."""


@dataclass(frozen=True, slots=True, eq=False)
class StepDocument:
    """The contents of a STEP file: placed solids, length unit, and other shapes."""

    solids: tuple[Occurrence, ...]
    units: str
    """Length unit of the solids."""
    passed: tuple[str, ...]
    """Description of each shape that is not a solid."""
    files: tuple[Path, ...] = ()
    """The file, and the files that it names."""
    notes: tuple[str, ...] = ()


def number_repeats(names: Sequence[str]) -> list[str]:
    """The names of siblings in a tree, with a number appended to each repeated name.

    Examples
    --------
    >>> number_repeats(["nut", "rod", "nut"])
    ['nut_1', 'rod', 'nut_2']
    >>> number_repeats(["nut", "nut_1", "nut"])  # a number that is in use is skipped
    ['nut_2', 'nut_1', 'nut_3']
    """
    taken, count, last = set(names), Counter(names), Counter[str]()
    result = []
    for name in names:
        label = name
        while count[name] > 1 and label in taken:
            last[name] += 1
            label = f"{name}_{last[name]}"
        taken.add(label)
        result.append(label)
    return result


def occurrences(leaves: Sequence[TreeSolid], shapes: Any) -> list[Occurrence]:
    """Convert solids of the product tree to placed solids with distinct names."""
    names = distinct(tails([leaf.path for leaf in leaves]))
    return [_occurrence(name, leaf, shapes) for name, leaf in zip(names, leaves, strict=True)]


class TreeSolid(NamedTuple):
    """A solid in the product tree: names, shape, place, stated properties.

    `skin`: whether its shells are open.
    """

    path: tuple[str, ...]
    shape: Any
    location: Any
    skin: bool
    stated: Stated = UNSTATED


class ProductTree:
    """A traversal of a STEP product tree that collects solids and describes other shapes.

    - `nameless`: names that OCCT gives to products without a name.
    - `shapes`: numbers of the shapes met.
    - `skins`: the solid made of each shell, by number.
    - `sewn`: the solids sewn of the faces of each product, by its number.
    - `open`: products whose faces do not close, at their places, with their names.
    - `passed`: descriptions of shapes that are not solids.
    - `notes`: sentences about sewn faces.
    """

    def __init__(
        self, transfer: Any, stated: StepStatements, nameless: frozenset[str] = frozenset()
    ) -> None:
        self.transfer = transfer
        self.stated = stated
        self.nameless = nameless
        self.shapes = shape_map()
        self.skins: dict[int, Any] = {}
        self.sewn: dict[int, list[Any]] = {}
        self.open: list[tuple[Any, str]] = []
        self.passed: list[str] = []
        self.notes: list[str] = []

    def solids(self, document: Any, stem: str) -> list[Occurrence]:
        """Placed solids of an OCCT document in the order of the file."""
        from OCP.TopLoc import TopLoc_Location
        from OCP.XCAFDoc import XCAFDoc_DocumentTool

        roots = labels()
        XCAFDoc_DocumentTool.ShapeTool_s(document.Main()).GetFreeShapes(roots)
        leaves = self.below(list(roots), (), TopLoc_Location(), stem)
        return occurrences(self.joined(leaves, stem), self.shapes)

    def below(
        self, neighbours: list[Any], above: tuple[str, ...], place: Any, stem: str
    ) -> list[TreeSolid]:
        """Collect the solids below labels that are siblings in the product tree."""
        from OCP.TDF import TDF_Label
        from OCP.XCAFDoc import XCAFDoc_ShapeTool

        products = []
        for label in neighbours:
            product = TDF_Label()
            is_reference = XCAFDoc_ShapeTool.GetReferredShape_s(label, product)
            products.append(product if is_reference else label)
        given = [_label_name(product) for product in products]
        names = number_repeats([stem if n in self.nameless else n or stem for n in given])
        solids: list[TreeSolid] = []
        for name, label, product in zip(names, neighbours, products, strict=True):
            location = place.Multiplied(XCAFDoc_ShapeTool.GetLocation_s(label))
            whole = (*above, name)
            if XCAFDoc_ShapeTool.IsAssembly_s(product):
                inner = () if not above and len(neighbours) == 1 else whole
                solids += self.below(_components(product), inner, location, stem)
            else:
                solids += self._leaf(product, whole, location)
        return solids

    def _leaf(self, product: Any, path: tuple[str, ...], place: Any) -> list[TreeSolid]:
        """Collect the solids of a product without components, and those inside its shells."""
        from OCP.TopAbs import TopAbs_ShapeEnum
        from OCP.TopLoc import TopLoc_Location
        from OCP.XCAFDoc import XCAFDoc_ShapeTool

        shape = XCAFDoc_ShapeTool.GetShape_s(product)
        if shape is None or shape.IsNull():
            return []
        solids, rest = split(shape)
        shells = [] if solids else list(inside(shape, TopAbs_ShapeEnum.TopAbs_SHELL))
        closed = [shell for shell in shells if self._is_closed(shell)]
        sewn = [] if solids or closed else self._sewn(shape, shells, path, place)
        pairs = [(solid.Located(TopLoc_Location()), solid.Location()) for solid in solids + sewn]
        pairs += [(self._solid_of([shell], True), shell.Location()) for shell in closed]
        skin = bool(shells) and not closed and not sewn
        if rest and not shells and not sewn:
            self.passed.append(f"{'/'.join(path)!r} ({rest})")
        if skin:
            pairs.append((self._solid_of(shells, False), TopLoc_Location()))
        names = number_repeats([path[-1]] * len(pairs))
        return [
            TreeSolid(
                (*path[:-1], name),
                solid,
                place.Multiplied(location),
                skin,
                self.stated.about(solid, product),
            )
            for name, (solid, location) in zip(names, pairs, strict=True)
        ]

    def _sewn(self, shape: Any, shells: list[Any], path: tuple[str, ...], place: Any) -> list[Any]:
        """Solids to which the separate faces of a product sew; a note counts them.

        Shells that make a single solid are left to the reader of solids, which sews them, too.
        """
        from OCP.TopAbs import TopAbs_ShapeEnum

        faces = len(list(inside(shape, TopAbs_ShapeEnum.TopAbs_FACE)))
        key = self.shapes.Add(shape)
        if key not in self.sewn:
            self.sewn[key] = sewn_solids([shape]) if faces else []
        solids = self.sewn[key]
        if faces and not solids:
            self.open.append((shape.Moved(place), "/".join(path)))
        if len(solids) < (2 if shells else 1):
            return []
        self.notes.append(sewn_note("/".join(path), faces, len(solids)))
        return solids

    def joined(self, solids: list[TreeSolid], stem: str) -> list[TreeSolid]:
        """The solids, with those to which the open faces of several products sew together."""
        from OCP.TopLoc import TopLoc_Location

        made = sewn_solids([shape for shape, _ in self.open]) if len(self.open) > 1 else []
        if not made:
            return solids
        marks = tuple(f"{name!r} (" for _, name in self.open)
        self.passed = [text for text in self.passed if not text.startswith(marks)]
        self.notes.append(sewn_note(stem, len(self.open), len(made), "products"))
        here = TopLoc_Location()
        names = number_repeats([stem] * len(made))
        open_names = {name for _, name in self.open}
        kept = [row for row in solids if not (row.skin and "/".join(row.path) in open_names)]
        return kept + [
            TreeSolid((name,), solid, here, False) for name, solid in zip(names, made, strict=True)
        ]

    def _is_closed(self, shell: Any) -> bool:
        """Whether the file states that a shell (connected faces) is closed."""
        from OCP.TopLoc import TopLoc_Location

        bare = shell.Located(TopLoc_Location())
        entity = self.transfer.EntityFromShapeResult(bare, -1)
        return entity is not None and entity.DynamicType().Name() == "StepShape_ClosedShell"

    def _solid_of(self, shells: list[Any], bare: bool) -> Any:
        """Build a solid, perhaps an open one, from the faces of shells; the result is cached.

        `bare`: whether to remove the locations of the shells first.
        """
        from OCP.BRep import BRep_Builder
        from OCP.TopAbs import TopAbs_ShapeEnum
        from OCP.TopLoc import TopLoc_Location
        from OCP.TopoDS import TopoDS_Shell, TopoDS_Solid

        if bare:
            shells = [shell.Located(TopLoc_Location()) for shell in shells]
        key = self.shapes.Add(shells[0])
        if key not in self.skins:
            solid, whole, builder = TopoDS_Solid(), TopoDS_Shell(), BRep_Builder()
            builder.MakeShell(whole)
            for face in (f for s in shells for f in inside(s, TopAbs_ShapeEnum.TopAbs_FACE)):
                builder.Add(whole, face)
            builder.MakeSolid(solid)
            builder.Add(solid, whole)
            self.skins[key] = solid
        return self.skins[key]


def sewn_note(name: str, faces: int, solids: int, what: str = "faces") -> str:
    """A note about separate faces that were sewn."""
    many = "1 closed solid" if solids == 1 else f"{solids} closed solids"
    return f"{name!r}: {faces} separate {what} are sewn to {many}"


def _occurrence(name: str, leaf: TreeSolid, shapes: Any) -> Occurrence:
    """Convert a solid of the product tree to a placed solid; mirrored solids become new shapes."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_Transform

    move, shape = leaf.location.Transformation(), leaf.shape
    pose = Pose()
    if move.IsNegative() or abs(abs(move.ScaleFactor()) - 1) > RIGID:
        shape = BRepBuilderAPI_Transform(shape, move, True).Shape()
    else:
        turn, step = move.GetRotation(), move.TranslationPart()
        pose = Pose([step.X(), step.Y(), step.Z()], [turn.W(), turn.X(), turn.Y(), turn.Z()])
    return Occurrence(name, shape, shapes.Add(shape), pose, leaf.skin, leaf.stated)


def _components(product: Any) -> list[Any]:
    """Labels of the components directly below a product."""
    from OCP.XCAFDoc import XCAFDoc_ShapeTool

    components = labels()
    XCAFDoc_ShapeTool.GetComponents_s(product, components)
    return list(components)


def _label_name(label: Any) -> str:
    """The name that a label has in the document; empty if it has none, or that of an exporter."""
    from OCP.TDataStd import TDataStd_Name

    attribute = TDataStd_Name()
    if not label.FindAttribute(TDataStd_Name.GetID_s(), attribute):
        return ""
    name = str(attribute.Get().ToExtString()).strip()
    return "" if NUMBERED.fullmatch(name) else name


def split(shape: Any) -> tuple[list[Any], str]:
    """Separate a shape into its solids, and a description of the rest ("2 shells, 1 wire")."""
    from OCP.TopAbs import TopAbs_ShapeEnum as Kind
    from OCP.TopoDS import TopoDS

    solids = [TopoDS.Solid(s) for s in inside(shape, Kind.TopAbs_SOLID)]
    chain = [Kind.TopAbs_SOLID, Kind.TopAbs_SHELL, Kind.TopAbs_FACE, Kind.TopAbs_WIRE]
    chain += [Kind.TopAbs_EDGE, Kind.TopAbs_VERTEX]
    words = ("", "shell", "face", "wire", "edge", "point")
    rest = []
    for word, kind, avoid in zip(words[1:], chain[1:], chain, strict=False):
        count = len(list(inside(shape, kind, avoid)))
        rest += [f"{count} {word}{'s' if count > 1 else ''}"] if count else []
    return solids, ", ".join(rest)
