"""Read the product tree of a STEP file: its solids with their names and poses.

A product that is used in several places is a shape with several placements. Neighbours with the
same name are numbered. The name of a part has as many products above it as needed to make it
unique: ``rod``, ``l-bracket-assembly_2/l-bracket``. Shapes that are not solids are ignored and
listed in a note.
"""

from __future__ import annotations

import dataclasses
import fnmatch
import re
from collections import Counter
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

from kilter.errors import InputError, some, some_names
from kilter.files.cad.step_solids import ReadSolid, read_solid, stand_in
from kilter.files.cad.step_statements import (
    UNSTATED,
    Stated,
    StepStatements,
    stated_accuracy,
    text_statements,
)
from kilter.files.cad.step_surfaces import asciis, failures, inside, labels, quiet, shape_map
from kilter.files.file_tolerances import RIGID
from kilter.files.meshes.placed import FileBodies, distinct, tails
from kilter.rigid import Pose
from kilter.units import METRES

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
"""STEP units that kilter keeps; lengths in other units are converted to metres."""
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
    files: tuple[Path, ...]
    """The file, and the files that it names."""


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


def read_document(path: Path) -> StepDocument:
    """Read the product tree of a STEP file.

    Raises `InputError` if the file is damaged, or names files that are missing.
    """
    with quiet():
        reader, units = _open_reader(path)
        document = _transfer(reader, units)
        files = [path, *(path.parent / name for name in _external(reader))]
        session = reader.ChangeReader().WS()
        stated = StepStatements(document, session, text_statements(path))
        solids, passed = _solids(document, session.TransferReader(), path.stem, stated)
    return StepDocument(tuple(solids), units, tuple(passed), tuple(files))


def _open_reader(path: Path) -> tuple[Any, str]:
    """An OCCT reader after it has read a STEP file, and the length unit for the shapes."""
    from OCP.IFSelect import IFSelect_ReturnStatus
    from OCP.STEPCAFControl import STEPCAFControl_Reader

    reader = STEPCAFControl_Reader()
    reader.SetNameMode(True)
    reader.SetColorMode(True)
    for mode in ("Layer", "Props", "GDT", "Mat", "View", "Meta", "SHUO"):
        getattr(reader, f"Set{mode}Mode")(False)
    if reader.ReadFile(str(path.absolute())) != IFSelect_ReturnStatus.IFSelect_RetDone:
        raise InputError("damaged STEP: its text violates the format", hint=_DAMAGED)
    lengths, angles, solid_angles = asciis(), asciis(), asciis()
    reader.ChangeReader().FileUnits(lengths, angles, solid_angles)
    named = [text.ToCString().lower() for text in lengths]
    return reader, _UNITS.get(named[0], "m") if named else "mm"


def _transfer(reader: Any, units: str) -> Any:
    """Transfer the product tree of a reader to an OCCT document."""
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDocStd import TDocStd_Document
    from OCP.XCAFDoc import XCAFDoc_DocumentTool

    document = TDocStd_Document(TCollection_ExtendedString("MDTV-XCAF"))
    XCAFDoc_DocumentTool.SetLengthUnit_s(document, METRES[units])
    if not reader.Transfer(document):
        raise InputError("it gives no shape", hint=_DAMAGED)
    return document


def _external(reader: Any) -> list[str]:
    """Paths of other files that a STEP file names; raises `InputError` if one is unreadable."""
    from OCP.IFSelect import IFSelect_ReturnStatus

    names: list[str] = []
    try:
        externals = reader.ExternFiles()
    except TypeError:  # the bindings of OCCT 7 cannot list them
        return names
    for external in externals:
        name = external.GetName()
        names.append(name.ToCString() if name else "")
        if external.GetLoadStatus() != IFSelect_ReturnStatus.IFSelect_RetDone:
            raise InputError(
                f"it names the file {names[-1]!r}, which cannot be read",
                hint="put it beside this file, or export all in a single file",
            )
    return names


# the tree ------------------------------------------------------------------------------


def _solids(
    document: Any, transfer: Any, stem: str, stated: StepStatements
) -> tuple[list[Occurrence], list[str]]:
    """Placed solids in the order of the file, and descriptions of shapes that are no solids."""
    from OCP.TopLoc import TopLoc_Location
    from OCP.XCAFDoc import XCAFDoc_DocumentTool

    roots = labels()
    XCAFDoc_DocumentTool.ShapeTool_s(document.Main()).GetFreeShapes(roots)
    walk = _TreeWalk(transfer, stated)
    leaves = walk.below(list(roots), (), TopLoc_Location(), stem)
    return occurrences(leaves, walk.shapes), walk.passed


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


class _TreeWalk:
    """A traversal of a STEP product tree that collects solids and describes other shapes.

    - `shapes`: numbers of the shapes met.
    - `skins`: the solid made of each shell, by number.
    - `passed`: descriptions of shapes that are not solids.
    """

    def __init__(self, transfer: Any, stated: StepStatements) -> None:
        self.transfer = transfer
        self.stated = stated
        self.shapes = shape_map()
        self.skins: dict[int, Any] = {}
        self.passed: list[str] = []

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
        names = number_repeats([_label_name(product) or stem for product in products])
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
        if rest and not shells:
            self.passed.append(f"{'/'.join(path)!r} ({rest})")
        pairs = [(solid.Located(TopLoc_Location()), solid.Location()) for solid in solids]
        pairs += [(self._solid_of([shell], True), shell.Location()) for shell in closed]
        skin = bool(shells) and not closed
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


# Read the solids of a STEP document as bodies; a shared solid is read once.


def step_bodies(
    path: Path,
    without: Sequence[str],
    tell: Callable[[str, int], None],
    broken: Collection[int] = (),
) -> FileBodies:
    """Read the solids of a STEP file as bodies with names and poses.

    Arguments: `tell`: called before each step with its description and the key of the current
    solid, or -1. Raises `InputError` if the file is damaged, or has no solid with a volume.
    """
    try:
        with quiet():
            tell("reading STEP", -1)
            return bodies_of(read_document(path), without, tell, broken)
    except failures():
        raise InputError(
            "damaged STEP: it gives no shape", hint="export it again as STEP"
        ) from None


def bodies_of(
    document: StepDocument,
    without: Sequence[str],
    tell: Callable[[str, int], None],
    broken: Collection[int] = (),
) -> FileBodies:
    """Convert the solids of a STEP document, from a file or from memory, to bodies.

    The other parameters are those of `step_bodies`.
    """
    kept = [row for row in document.solids if not _matches(row.name, without)]
    read = _read(kept, tell, broken)
    bodies, passed, empty = [], list(document.passed), []
    for row in kept:
        solid = read[row.key].solid
        if solid is not None and not (row.skin and (len(solid.holes) or solid.stand_in)):
            bodies.append((row, solid))
        elif row.skin:
            passed.append(f"{row.name!r} (1 shell)")
        else:
            empty.append(row.name)
    if not bodies and len(kept) == len(document.solids):
        raise _no_solid(passed, empty)
    accuracy = stated_accuracy(document.files, document.units)
    solids = {row.key: dataclasses.replace(solid, uncertainty=accuracy) for row, solid in bodies}
    notes = [f"ignored, not solids: {some(passed, 8)}"] if passed else []
    notes += [f"left out, without volume: {some_names(empty, 8)}"] if empty else []
    hidden = [row.name for row, _ in bodies if row.stated.hidden]
    if hidden:
        notes.append(
            f"hidden in the file: {some_names(hidden, 8)}; leave out hidden variants with --without"
        )
    notes += _notes([row for row, _ in bodies], read)
    return FileBodies(
        names=tuple(row.name for row, _ in bodies),
        shapes=tuple(solids[row.key] for row, _ in bodies),
        poses=tuple(row.pose for row, _ in bodies),
        densities=tuple(row.stated.density for row, _ in bodies),
        colors=tuple(row.stated.color for row, _ in bodies),
        materials=tuple(row.stated.material for row, _ in bodies),
        layers=tuple(row.stated.layer for row, _ in bodies),
        units=document.units,
        notes=tuple(notes),
        left_out=tuple(row.name for row in document.solids if _matches(row.name, without)),
    )


def _no_solid(passed: list[str], empty: list[str]) -> InputError:
    """Build the error for a document without solids; it lists the other shapes."""
    what = "no solid"
    if passed:
        what += f", only {some(passed)}"
    elif empty:
        what += f" with a volume, only {some_names(empty)}"
    return InputError(what, hint="export solids, not surfaces or curves")


def _matches(name: str, patterns: Sequence[str]) -> bool:
    """Whether a name equals a pattern or matches it as a wildcard."""
    return any(name == pattern or fnmatch.fnmatchcase(name, pattern) for pattern in patterns)


def _read(
    solids: list[Occurrence], tell: Callable[[str, int], None], broken: Collection[int]
) -> dict[int, ReadSolid]:
    """Read each distinct solid of a STEP document once; return the solids by their keys."""
    first: dict[int, Occurrence] = {}
    for row in solids:
        first.setdefault(row.key, row)
    read = {}
    for number, row in enumerate(first.values(), start=1):
        tell(f"cutting faces of solid {number} of {len(first)}", row.key)
        read[row.key] = (stand_in if row.key in broken else read_solid)(row.shape)
    return read


def _notes(solids: list[Occurrence], read: dict[int, ReadSolid]) -> list[str]:
    """Notes on solids that were read with changes; parts with the same solid share a note."""
    alike: dict[int, list[str]] = {}
    for row in solids:
        alike.setdefault(row.key, []).append(row.name)
    return [
        f"{some_names(names)}: {read[key].note}" for key, names in alike.items() if read[key].note
    ]
