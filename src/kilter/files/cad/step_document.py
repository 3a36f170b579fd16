"""Read a STEP or IGES file with OCCT: its product tree, and its solids as bodies."""

from __future__ import annotations

import dataclasses
import fnmatch
from collections.abc import Callable, Collection, Sequence
from pathlib import Path
from typing import Any

from kilter.errors import InputError, some, some_names
from kilter.files.cad.product_tree import Occurrence, ProductTree, StepDocument
from kilter.files.cad.step_solids import ReadSolid, read_solid, stand_in
from kilter.files.cad.step_statements import StepStatements, stated_accuracy, text_statements
from kilter.files.cad.step_surfaces import asciis, failures, quiet
from kilter.files.file_tolerances import SAME_UNIT
from kilter.files.meshes.placed import FileBodies
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


IGES = (".igs", ".iges")
"""Endings of IGES files (lower case)."""
BODIES = (143, 144, 186, 514)
"""Numbers of the entities of IGES that are faces, solids and shells."""
UNNAMED = frozenset({"COMPOUND", "COMPSOLID", "SOLID", "SHELL", "FACE"})
"""Names that OCCT gives to the entities of an IGES file without a name."""


def read_document(path: Path) -> StepDocument:
    """Read the product tree of a STEP or IGES file.

    Raises `InputError` if the file is damaged, or names files that are missing.
    """
    with quiet():
        if path.suffix.lower() in IGES:
            reader, units = _open_iges(path)
            document, files = _transfer(reader, units), []
            session, in_text, nameless = reader.WS(), {}, UNNAMED
            lost = _lost(reader)
        else:
            reader, units = _open_reader(path)
            document = _transfer(reader, units)
            files = [path, *(path.parent / name for name in _external(reader))]
            session, in_text = reader.ChangeReader().WS(), text_statements(path)
            nameless, lost = frozenset(), []
        stated = StepStatements(document, session, in_text)
        tree = ProductTree(session.TransferReader(), stated, nameless)
        solids = tree.solids(document, path.stem)
    notes = (*lost, *tree.notes)
    return StepDocument(tuple(solids), units, tuple(tree.passed), tuple(files), notes)


def _open_iges(path: Path) -> tuple[Any, str]:
    """An OCCT reader after it has read an IGES file, and the length unit for the shapes."""
    from OCP.IFSelect import IFSelect_ReturnStatus
    from OCP.IGESCAFControl import IGESCAFControl_Reader

    reader = IGESCAFControl_Reader()
    reader.SetNameMode(True)
    reader.SetColorMode(True)
    reader.SetLayerMode(False)
    if reader.ReadFile(str(path.absolute())) != IFSelect_ReturnStatus.IFSelect_RetDone:
        raise InputError("damaged IGES: its text violates the format", hint=_DAMAGED)
    metres = reader.IGESModel().GlobalSection().UnitValue() / 1000.0
    kept = ("in", "cm")  # OCCT sews faces with the accuracy of millimetres
    same = [unit for unit in kept if abs(metres / METRES[unit] - 1) <= SAME_UNIT]
    return reader, same[0] if same else "mm"


def _lost(reader: Any) -> list[str]:
    """A note on the solids and faces of an IGES file from which OCCT makes no shape."""
    roots = [reader.RootForTransfer(k + 1) for k in range(reader.NbRootsForTransfer())]
    count = sum(root.TypeNumber() in BODIES for root in roots) - reader.NbShapes()
    return [f"damaged: {count} solids or faces of the file give no shape"] if count > 0 else []


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
    notes = list(document.notes)
    notes += [f"ignored, not solids: {some(passed, 8)}"] if passed else []
    notes += [f"left out, without volume: {some_names(empty, 8)}"] if empty else []
    hidden = [row.name for row, _ in bodies if row.stated.hidden]
    if 0 < len(hidden) < len(bodies):
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
