"""The tree of a STEP file: which solids it holds, under which names, and where.

A product that is used in several places is one shape with several placements. Where a name occurs
several times among its neighbours each gets a number, and a part is named by as many of the
products above it as tell it from all others: ``rod``, ``l-bracket-assembly_2/l-bracket``. Whatever
is no solid is passed over and named in a note.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

from kilter.errors import InputError
from kilter.files.file_tolerances import RIGID
from kilter.files.naming import distinct, tails
from kilter.files.occt import asciis, inside, labels, quiet, shape_map
from kilter.rigid import Pose
from kilter.units import METRES

__all__ = [
    "FoundSolid",
    "Occurrence",
    "StepDocument",
    "numbered",
    "occurrences",
    "read_document",
    "split",
]


_DAMAGED = "export it again as STEP (AP214 or AP242)"
_UNITS = {
    "metre": "m",
    "centimetre": "cm",
    "millimetre": "mm",
    "inch": "in",
    "meter": "m",
    "centimeter": "cm",
    "millimeter": "mm",
}
"""Units of STEP that kilter keeps; lengths in others are turned into metres."""


@dataclass(frozen=True, slots=True, eq=False)
class Occurrence:
    """A solid somewhere in the tree.

    Attributes
    ----------
    name : str
    shape : TopoDS_Solid
        In its own frame.
    key : int
        The same for occurrences of one solid.
    pose : Pose
        From the solid's frame to that of the file.
    skin : bool
        The file has it as a shell: a solid only if it closes.
    """

    name: str
    shape: Any
    key: int
    pose: Pose
    skin: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class StepDocument:
    """What a STEP file holds.

    Attributes
    ----------
    solids : tuple of Occurrence
    units : str
        Of their lengths.
    passed : tuple of str
        What is no solid, in words.
    files : tuple of Path
        The file, and those that it names.
    """

    solids: tuple[Occurrence, ...]
    units: str
    passed: tuple[str, ...]
    files: tuple[Path, ...]


def numbered(names: Sequence[str]) -> list[str]:
    """Names among neighbours: those that occur several times get a number each.

    Examples
    --------
    >>> numbered(["nut", "rod", "nut"])
    ['nut_1', 'rod', 'nut_2']
    >>> numbered(["nut", "nut_1", "nut"])  # a name that is there already is not taken
    ['nut_2', 'nut_1', 'nut_3']
    """
    taken, count, last = set(names), Counter(names), Counter[str]()
    result = []
    for name in names:
        own = name
        while count[name] > 1 and own in taken:
            last[name] += 1
            own = f"{name}_{last[name]}"
        taken.add(own)
        result.append(own)
    return result


def read_document(path: Path) -> StepDocument:
    """The solids of a STEP file.

    Raises
    ------
    InputError
        If it is damaged, or names files that are missing.
    """
    with quiet():
        reader, units = _opened(path)
        document = _transferred(reader, units)
        files = [path, *(path.parent / name for name in _external(reader))]
        solids, passed = _solids(document, reader.ChangeReader().WS().TransferReader(), path.stem)
    return StepDocument(tuple(solids), units, tuple(passed), tuple(files))


def _opened(path: Path) -> tuple[Any, str]:
    """A reader with the file in it, and the unit that its lengths are to be read in."""
    from OCP.IFSelect import IFSelect_ReturnStatus
    from OCP.STEPCAFControl import STEPCAFControl_Reader

    reader = STEPCAFControl_Reader()
    reader.SetNameMode(True)
    for mode in ("Color", "Layer", "Props", "GDT", "Mat", "View", "Meta", "SHUO"):
        getattr(reader, f"Set{mode}Mode")(False)
    if reader.ReadFile(str(path.absolute())) != IFSelect_ReturnStatus.IFSelect_RetDone:
        raise InputError("damaged STEP: its text breaks the rules of the format", hint=_DAMAGED)
    lengths, angles, solid_angles = asciis(), asciis(), asciis()
    reader.ChangeReader().FileUnits(lengths, angles, solid_angles)
    named = [text.ToCString().lower() for text in lengths]
    return reader, _UNITS.get(named[0], "m") if named else "mm"


def _transferred(reader: Any, units: str) -> Any:
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDocStd import TDocStd_Document
    from OCP.XCAFDoc import XCAFDoc_DocumentTool

    document = TDocStd_Document(TCollection_ExtendedString("MDTV-XCAF"))
    XCAFDoc_DocumentTool.SetLengthUnit_s(document, METRES[units])
    if not reader.Transfer(document):
        raise InputError("no shape can be made of it", hint=_DAMAGED)
    return document


def _external(reader: Any) -> list[str]:
    """The files that a file names; refused where one is missing or cannot be read."""
    from OCP.IFSelect import IFSelect_ReturnStatus

    found: list[str] = []
    try:
        externals = reader.ExternFiles()
    except TypeError:  # the bindings of OCCT 7 cannot say
        return found
    for external in externals:
        name = external.GetName()
        found.append(name.ToCString() if name else "")
        if external.GetLoadStatus() != IFSelect_ReturnStatus.IFSelect_RetDone:
            raise InputError(
                f"names another file, {found[-1]!r}, that cannot be read",
                hint="put it beside this one, or export all in one file",
            )
    return found


# the tree ------------------------------------------------------------------------------


def _solids(document: Any, transfer: Any, stem: str) -> tuple[list[Occurrence], list[str]]:
    """Occurrences of solids in the order of the file, and what else there is, in words."""
    from OCP.TopLoc import TopLoc_Location
    from OCP.XCAFDoc import XCAFDoc_DocumentTool

    roots = labels()
    XCAFDoc_DocumentTool.ShapeTool_s(document.Main()).GetFreeShapes(roots)
    walk = _Walk(transfer)
    found = walk.below(list(roots), (), TopLoc_Location(), stem)
    return occurrences(found, walk.shapes), walk.passed


def occurrences(found: Sequence[FoundSolid], shapes: Any) -> list[Occurrence]:
    """Solids under distinct names, where they are; `shapes`: the map that tells them apart."""
    names = distinct(tails([one.path for one in found]))
    return [_placed(name, one, shapes) for name, one in zip(names, found, strict=True)]


class FoundSolid(NamedTuple):
    """A solid below the names of the products above it, before it is placed."""

    path: tuple[str, ...]
    shape: Any
    location: Any
    skin: bool


class _Walk:
    """Goes down the tree of products; keeps what each shape holds."""

    def __init__(self, transfer: Any) -> None:
        self.transfer = transfer
        self.shapes = shape_map()
        self.skins: dict[int, Any] = {}
        self.passed: list[str] = []

    def below(
        self, neighbours: list[Any], above: tuple[str, ...], place: Any, stem: str
    ) -> list[FoundSolid]:
        """The solids below labels that are neighbours."""
        from OCP.TDF import TDF_Label
        from OCP.XCAFDoc import XCAFDoc_ShapeTool

        products = []
        for label in neighbours:
            product = TDF_Label()
            own = XCAFDoc_ShapeTool.GetReferredShape_s(label, product)
            products.append(product if own else label)
        names = numbered([_label_name(product) or stem for product in products])
        found: list[FoundSolid] = []
        for name, label, product in zip(names, neighbours, products, strict=True):
            location = place.Multiplied(XCAFDoc_ShapeTool.GetLocation_s(label))
            whole = (*above, name)
            if XCAFDoc_ShapeTool.IsAssembly_s(product):
                inner = () if not above and len(neighbours) == 1 else whole
                found += self.below(_components(product), inner, location, stem)
            else:
                found += self._leaf(product, whole, location)
        return found

    def _leaf(self, product: Any, path: tuple[str, ...], place: Any) -> list[FoundSolid]:
        """Solids of a product without components."""
        from OCP.TopAbs import TopAbs_ShapeEnum
        from OCP.TopLoc import TopLoc_Location
        from OCP.XCAFDoc import XCAFDoc_ShapeTool

        shape = XCAFDoc_ShapeTool.GetShape_s(product)
        if shape is None or shape.IsNull():
            return []
        solids, rest = split(shape)
        shells = [] if solids else list(inside(shape, TopAbs_ShapeEnum.TopAbs_SHELL))
        closed = [shell for shell in shells if self._is_closed(shell)]
        if rest and not shells:
            self.passed.append(f"{'/'.join(path)!r} ({rest})")
        found = [(solid.Located(TopLoc_Location()), solid.Location()) for solid in solids]
        found += [(self._filled([shell], True), shell.Location()) for shell in closed]
        skin = bool(shells) and not closed
        if skin:
            found.append((self._filled(shells, False), TopLoc_Location()))
        names = numbered([path[-1]] * len(found))
        return [
            FoundSolid((*path[:-1], name), solid, place.Multiplied(where), skin)
            for name, (solid, where) in zip(names, found, strict=True)
        ]

    def _is_closed(self, shell: Any) -> bool:
        """Whether the file says that a shell is closed: the skin of a solid that lost a face."""
        from OCP.TopLoc import TopLoc_Location

        bare = shell.Located(TopLoc_Location())
        entity = self.transfer.EntityFromShapeResult(bare, -1)
        return entity is not None and entity.DynamicType().Name() == "StepShape_ClosedShell"

    def _filled(self, shells: list[Any], bare: bool) -> Any:
        """The faces of shells as one solid, which may not close; the same for the same shells."""
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


def _placed(name: str, found: FoundSolid, shapes: Any) -> Occurrence:
    """A solid where it is; one that is scaled or mirrored there is a solid of its own."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_Transform

    move, shape = found.location.Transformation(), found.shape
    pose = Pose()
    if move.IsNegative() or abs(abs(move.ScaleFactor()) - 1) > RIGID:
        shape = BRepBuilderAPI_Transform(shape, move, True).Shape()
    else:
        turn, step = move.GetRotation(), move.TranslationPart()
        pose = Pose([step.X(), step.Y(), step.Z()], [turn.W(), turn.X(), turn.Y(), turn.Z()])
    return Occurrence(name, shape, shapes.Add(shape), pose, found.skin)


def _components(product: Any) -> list[Any]:
    from OCP.XCAFDoc import XCAFDoc_ShapeTool

    found = labels()
    XCAFDoc_ShapeTool.GetComponents_s(product, found)
    return list(found)


def _label_name(label: Any) -> str:
    from OCP.TDataStd import TDataStd_Name

    attribute = TDataStd_Name()
    if not label.FindAttribute(TDataStd_Name.GetID_s(), attribute):
        return ""
    return str(attribute.Get().ToExtString()).strip()


def split(shape: Any) -> tuple[list[Any], str]:
    """The solids of a shape, and what is beside them in words ("2 shells, 1 wire")."""
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
