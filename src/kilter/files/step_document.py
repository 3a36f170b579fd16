"""The tree of a STEP file: which solids it holds, under which names, and where.

A product that is used in several places is one shape with several placements. A part is named
by the products above it, ``l-bracket-assembly_2/nut-bolt-assembly_1/bolt``: where a name occurs
several times among its neighbours each gets a number. A file that is one assembly leaves that
assembly's own name out. Whatever is no solid is passed over and named in a note.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from kilter.errors import InputError, some
from kilter.files.file_tolerances import RIGID
from kilter.files.naming import distinct
from kilter.rigid import Pose
from kilter.units import METRES

__all__ = ["Occurrence", "StepDocument", "numbered", "quiet", "read_document"]


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
    """

    name: str
    shape: Any
    key: int
    pose: Pose


@dataclass(frozen=True, slots=True, eq=False)
class StepDocument:
    """What a STEP file holds: solids, the unit of their lengths, notes on the rest."""

    solids: tuple[Occurrence, ...]
    units: str
    notes: tuple[str, ...]


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


@contextmanager
def quiet() -> Iterator[None]:
    """No word of OCCT on the output while this lasts."""
    from OCP.Message import Message

    messenger = Message.DefaultMessenger_s()
    printers = list(messenger.Printers())
    for printer in printers:
        messenger.RemovePrinter(printer)
    try:
        yield
    finally:
        for printer in printers:
            messenger.AddPrinter(printer)


def read_document(path: Path) -> StepDocument:
    """The solids of a STEP file.

    Raises
    ------
    InputError
        If it is damaged, names files that are missing, or holds no solid.
    """
    with quiet():
        reader, units = _opened(path)
        document = _transferred(reader, units)
        _check_external(reader)
        solids, passed = _solids(document, path.stem)
    notes = [f"passed over, no solids: {some(passed, 8)}"] if passed else []
    if not solids:
        what = f"no solid, only {some(passed)}" if passed else "no solid"
        raise InputError(what, hint="export solids, not surfaces or curves")
    return StepDocument(tuple(solids), units, tuple(notes))


def _opened(path: Path) -> tuple[Any, str]:
    """A reader with the file in it, and the unit that its lengths are to be read in."""
    from OCP.collections import Sequence_TCollection_AsciiString as Texts
    from OCP.IFSelect import IFSelect_ReturnStatus
    from OCP.STEPCAFControl import STEPCAFControl_Reader

    reader = STEPCAFControl_Reader()
    reader.SetNameMode(True)
    for mode in ("Color", "Layer", "Props", "GDT", "Mat", "View", "Meta", "SHUO"):
        getattr(reader, f"Set{mode}Mode")(False)
    if reader.ReadFile(str(path.absolute())) != IFSelect_ReturnStatus.IFSelect_RetDone:
        raise InputError("damaged STEP: its text breaks the rules of the format", hint=_DAMAGED)
    lengths, angles, solid_angles = Texts(), Texts(), Texts()
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


def _check_external(reader: Any) -> None:
    """Refuse a file that names others which are missing or cannot be read."""
    from OCP.IFSelect import IFSelect_ReturnStatus

    for external in reader.ExternFiles():
        if external.GetLoadStatus() != IFSelect_ReturnStatus.IFSelect_RetDone:
            name = external.GetName()
            raise InputError(
                f"names another file, {name.ToCString() if name else ''!r}, that cannot be read",
                hint="put it beside this one, or export all in one file",
            )


# the tree ------------------------------------------------------------------------------


def _solids(document: Any, stem: str) -> tuple[list[Occurrence], list[str]]:
    """Occurrences of solids in the order of the file, and what else there is, in words."""
    from OCP.collections import Sequence_TDF_Label
    from OCP.TopLoc import TopLoc_Location
    from OCP.XCAFDoc import XCAFDoc_DocumentTool

    roots = Sequence_TDF_Label()
    XCAFDoc_DocumentTool.ShapeTool_s(document.Main()).GetFreeShapes(roots)
    walk = _Walk()
    found = walk.below(list(roots), "", TopLoc_Location(), stem)
    names = distinct([name for name, *_ in found])
    solids = [
        Occurrence(name, shape, key, _pose(location, name))
        for name, (_, shape, key, location) in zip(names, found, strict=True)
    ]
    return solids, walk.passed


class _Walk:
    """Goes down the tree of products; keeps what each shape holds."""

    def __init__(self) -> None:
        from OCP.collections import IndexedMap_TopoDS_Shape_TopTools_ShapeMapHasher as ShapeMap

        self.shapes = ShapeMap()
        self.passed: list[str] = []

    def below(self, labels: list[Any], above: str, place: Any, stem: str) -> list[Any]:
        """(name, solid, key, location) of the solids below labels that are neighbours."""
        from OCP.TDF import TDF_Label
        from OCP.XCAFDoc import XCAFDoc_ShapeTool

        products = []
        for label in labels:
            product = TDF_Label()
            own = XCAFDoc_ShapeTool.GetReferredShape_s(label, product)
            products.append(product if own else label)
        names = numbered([_label_name(product) or stem for product in products])
        found = []
        for name, label, product in zip(names, labels, products, strict=True):
            location = place.Multiplied(XCAFDoc_ShapeTool.GetLocation_s(label))
            whole = f"{above}/{name}" if above else name
            if XCAFDoc_ShapeTool.IsAssembly_s(product):
                inner = "" if not above and len(labels) == 1 else whole
                found += self.below(_components(product), inner, location, stem)
            else:
                found += self._leaf(product, whole, location)
        return found

    def _leaf(self, product: Any, name: str, place: Any) -> list[Any]:
        """Solids of a product without components."""
        from OCP.TopLoc import TopLoc_Location
        from OCP.XCAFDoc import XCAFDoc_ShapeTool

        shape = XCAFDoc_ShapeTool.GetShape_s(product)
        if shape is None or shape.IsNull():
            return []
        solids, rest = _split(shape)
        if rest:
            self.passed.append(f"{name!r} ({rest})")
        found = []
        names = numbered([name] * len(solids))
        for own, solid in zip(names, solids, strict=True):
            bare = solid.Located(TopLoc_Location())
            key = self.shapes.Add(bare)
            found.append((own, bare, key, place.Multiplied(solid.Location())))
        return found


def _components(product: Any) -> list[Any]:
    from OCP.collections import Sequence_TDF_Label
    from OCP.XCAFDoc import XCAFDoc_ShapeTool

    labels = Sequence_TDF_Label()
    XCAFDoc_ShapeTool.GetComponents_s(product, labels)
    return list(labels)


def _label_name(label: Any) -> str:
    from OCP.TDataStd import TDataStd_Name

    attribute = TDataStd_Name()
    if not label.FindAttribute(TDataStd_Name.GetID_s(), attribute):
        return ""
    return str(attribute.Get().ToExtString()).strip()


def _split(shape: Any) -> tuple[list[Any], str]:
    """The solids of a shape, and what is beside them in words ("2 shells, 1 wire")."""
    from OCP.TopAbs import TopAbs_ShapeEnum as Kind
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopoDS import TopoDS

    def inside(kind: Any, avoid: Any) -> list[Any]:
        explorer, found = TopExp_Explorer(shape, kind, avoid), []
        while explorer.More():
            found.append(explorer.Current())
            explorer.Next()
        return found

    solids = [TopoDS.Solid(s) for s in inside(Kind.TopAbs_SOLID, Kind.TopAbs_SHAPE)]
    chain = [Kind.TopAbs_SOLID, Kind.TopAbs_SHELL, Kind.TopAbs_FACE, Kind.TopAbs_WIRE]
    chain += [Kind.TopAbs_EDGE, Kind.TopAbs_VERTEX]
    words = ("", "shell", "face", "wire", "edge", "point")
    rest = []
    for word, kind, avoid in zip(words[1:], chain[1:], chain, strict=False):
        count = len(inside(kind, avoid))
        rest += [f"{count} {word}{'s' if count > 1 else ''}"] if count else []
    return solids, ", ".join(rest)


def _pose(location: Any, name: str) -> Pose:
    move = location.Transformation()
    if move.IsNegative() or abs(abs(move.ScaleFactor()) - 1) > RIGID:
        raise InputError("its placement scales or mirrors it", part=name, hint=_DAMAGED)
    turn, step = move.GetRotation(), move.TranslationPart()
    return Pose([step.X(), step.Y(), step.Z()], [turn.W(), turn.X(), turn.Y(), turn.Z()])
