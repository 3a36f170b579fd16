"""Content of a file or of standard input: the reader of each kind, before options are applied."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

from kilter.assembly import Assembly, Part
from kilter.errors import InputError, some
from kilter.files.bricks.brick_lists import (
    BRICK_TEXT,
    from_stable_lego,
    is_stable_lego,
    load_brick_text,
)
from kilter.files.bricks.ldraw import LDRAW_FILES, load_ldraw
from kilter.files.compas_files import from_compas, is_compas
from kilter.files.complaints import parse_json
from kilter.files.format_options import FormatOptions
from kilter.files.formats import FORMATS, IN_FOLDERS, load_bodies, read_bodies
from kilter.files.limits import is_folder, read_bounded, read_bytes, require_below, require_regular
from kilter.files.meshes.bodies import split_bodies
from kilter.files.meshes.placed import FileBodies, distinct, fill_names, natural_key
from kilter.files.native_formats import export_hint
from kilter.files.own.kilter_json import from_dict
from kilter.files.packing.packing_lists import CSV, is_packing_plan, load_plan, plan_of_json
from kilter.files.robots.scene_process import read_scene
from kilter.files.usd.usd_stage import USD
from kilter.hooks import hook
from kilter.shape.primitives import Mesh

# Read a folder of mesh and STEP files, one part per file.


def load_folder(path: Path, *, units: str | None = None) -> Assembly:
    """Read all mesh and STEP files of a folder as an assembly; subfolders are ignored.

    Raises `InputError` if the folder cannot be read, has no mesh or STEP file, or a file is
    damaged.
    """
    try:
        entries = sorted(path.iterdir(), key=lambda entry: natural_key(entry.name))
    except OSError as error:
        raise InputError(
            f"cannot be read: {error.strerror or error}",
            file=str(path),
            hint="check the path and the permissions",
        ) from None
    entries = [entry for entry in entries if not entry.name.startswith(".")]
    chosen = [e for e in entries if e.suffix.lower() in IN_FOLDERS and not e.is_dir()]
    if not chosen:
        raise InputError(
            "no mesh or STEP file in the folder", file=str(path), hint=_remedy(entries)
        )
    try:
        for entry in chosen:
            require_regular(entry)
    except InputError as error:
        raise error.located(file=str(path)) from None
    solids = [read_bodies(entry) for entry in chosen]
    target, assumed = _units(path, chosen, solids, units)
    notes = _ignored_note([entry for entry in entries if entry not in chosen])
    for entry, bodies in zip(chosen, solids, strict=True):
        notes += [f"{entry.name}: {note}" for note in bodies.notes]
        notes += _several_bodies(entry, bodies)
    parts = _parts(path, chosen, solids, target)
    return Assembly(parts, units=target, source=str(path), notes=notes, assumed=assumed)


def _remedy(entries: Sequence[Path]) -> str:
    """Advice to the user about a folder without mesh files: give its assembly, or add meshes."""
    files = [e.name for e in entries if e.name.lower().endswith((".json", ".fcstd"))]
    if files:
        return f"give the file itself: {files[0]!r}"
    exports = [export for entry in entries if (export := export_hint(entry))]
    if exports:
        return f"export the parts from {exports[0]}"
    return f"put files of {', '.join(IN_FOLDERS)} into it"


def _parts(path: Path, files: list[Path], solids: list[FileBodies], target: str) -> list[Part]:
    """Build the parts of all files, with lengths converted to the unit `target`."""
    stems = distinct([file.stem for file in files])
    parts = []
    for file, stem, bodies in zip(files, stems, solids, strict=True):
        several = len(bodies.names) > 1
        names = [f"{stem}/{name}" for name in fill_names(bodies.names, stem)] if several else [stem]
        try:
            rows = zip(names, bodies.in_units(target), bodies.stated, strict=True)
            parts += [Part(name, shape, pose, **stated) for name, (shape, pose), stated in rows]
        except InputError as error:
            raise error.located(file=str(file)) from None
    return parts


def _units(
    path: Path, files: list[Path], solids: list[FileBodies], units: str | None
) -> tuple[str, dict[str, str]]:
    """Length unit of the assembly: the given unit, else that of the files, else the usual unit.

    If the files state several units, or have several usual units, metres serve as the common unit.
    The second value is the unit as an option of reading if it is assumed.
    """
    stated = sorted({bodies.units for bodies in solids if bodies.units})
    if units:
        return units, {}
    silent = [file.name for file, bodies in zip(files, solids, strict=True) if not bodies.units]
    if len(stated) > 1 and silent:
        raise InputError(
            f"files are in {' and '.join(stated)}, {silent[0]!r} states no units",
            file=str(path),
            hint="give the units: load(path, units='mm')",
            option="give --units",
        )
    if stated:
        return (stated[0] if len(stated) == 1 else "m"), {}
    usual = {bodies.usual for bodies in solids}
    assumed = usual.pop() if len(usual) == 1 else "m"
    return assumed, {"units": assumed}


def _ignored_note(entries: Sequence[Path], limit: int = 8) -> list[str]:
    """A note that names up to `limit` files of other types; an empty list if there are none."""
    if not entries:
        return []
    shown = ", ".join(repr(entry.name) for entry in entries[:limit])
    more = f" and {len(entries) - limit} more" if len(entries) > limit else ""
    return [f"ignored, not mesh or STEP files: {shown}{more}"]


def _several_bodies(file: Path, bodies: FileBodies) -> list[str]:
    """A note if a file without names holds several separate bodies; else an empty list."""
    only = bodies.shapes[0]
    if bodies.names != (None,) or not isinstance(only, Mesh):
        return []
    count = len(split_bodies(only))
    return [f"{file.name}: {count} separate bodies, read as a single part"] if count > 1 else []


XML = (".xml", ".mjcf", ".urdf", ".sdf", ".world")
"""Endings of MJCF and URDF files."""
STANDARD_INPUT = "-"
STANDARD_INPUT_NAME = "standard input"
"""Name of standard input in messages."""
ENDINGS = (".json", *FORMATS, *XML, *USD, *LDRAW_FILES, *BRICK_TEXT, *CSV)
"""Endings of the files that can be read (lower case)."""


class FileContent(NamedTuple):
    """An assembly as read from its file, before the user's options are applied.

    `states_gravity`: whether the format fixes the direction of gravity; `left_out`: names of
    parts that the reader has left out already; `from_cad`: whether the densities are those of the
    materials of CAD files, which an option replaces.
    """

    assembly: Assembly
    states_gravity: bool = False
    left_out: tuple[str, ...] = ()
    from_cad: bool = False

    def without_copies(self) -> FileContent:
        """The content without the bodies that the file has twice; a note names them."""
        assembly = self.assembly
        if len(assembly) < 2 or not (found := hook("copies")(assembly)):
            return self
        names = some([f"{copy!r} (as {kept!r})" for copy, kept in found.items()])
        count = len(found)
        words = "1 body is" if count == 1 else f"{count} bodies are"
        note = (
            f"{words} in the file twice, left out: {names}; --keep-copies keeps "
            f"{'it' if count == 1 else 'them'}"
        )
        less = assembly.without(list(found))
        return self._replace(
            assembly=replace(less, notes=[*less.notes, note]), left_out=(*self.left_out, *found)
        )

    def without_held_parts(self) -> FileContent:
        """The content of a format that may hold no part: an answer then assumes a support."""
        return self._replace(assembly=replace(self.assembly, file_up=-self.assembly.down))


def read_path(
    source: str | os.PathLike[str],
    options: FormatOptions,
    *,
    without: Sequence[str] = (),
    progress: Callable[[str], None] | None = None,
) -> FileContent:
    """Read a file, a folder or standard input with the reader for its format."""
    if os.fspath(source) == STANDARD_INPUT:
        data = read_bounded(sys.stdin.buffer, STANDARD_INPUT_NAME)
        return _from_json(data, Path(), STANDARD_INPUT_NAME, options)
    path, units = Path(source), options.units
    require_below(path)
    suffix = path.suffix.lower()
    _require_options_of(path, options)
    if is_folder(path):
        # equal bodies at the same place in two files are likelier two frames than a copy
        return FileContent(load_folder(path, units=units), from_cad=True).without_held_parts()
    if suffix in FORMATS:
        assembly, left_out = load_bodies(path, units=units, without=without, progress=progress)
        content = FileContent(assembly, left_out=left_out, from_cad=True)
        content = content.without_held_parts()
        return content if options.keep_copies else content.without_copies()
    if suffix in XML or suffix == ".xacro":  # the reader of URDF says how to expand a template
        # imported late: other files do not need these modules
        from kilter.files.robots.xml_scenes import load_xml

        return FileContent(*load_xml(path, options)).without_held_parts()
    if suffix in USD:
        # imported late: other files do not need these modules

        scene = FileContent(read_scene("usd", path, options), states_gravity=True)
        return scene.without_held_parts()
    if suffix in LDRAW_FILES:
        built = load_ldraw(path, rules=options.studs, name=options.model)
        return FileContent(built, states_gravity=True)
    if suffix in BRICK_TEXT:
        return FileContent(load_brick_text(path, rules=options.studs), states_gravity=True)
    if suffix in CSV:
        return FileContent(load_plan(path, units=units).assembly(), states_gravity=True)
    data = read_bytes(path)
    if suffix == ".json":
        return _from_json(data, path.parent, str(path), options)
    if export := export_hint(path):
        raise InputError(
            f"{path.suffix} is the native format of a CAD program, which only that program reads",
            file=str(path),
            hint=f"export the file from {export}",
        )
    kinds = f"{', '.join(ENDINGS)}, or a folder of them"
    raise InputError(
        f"cannot read files of type {path.suffix or '(no ending)'}",
        file=str(path),
        hint=f"give {kinds}",
    )


def _require_options_of(path: Path, options: FormatOptions) -> None:
    """Raise an InputError if an option is for another kind of file."""
    suffix = path.suffix.lower()
    if options.states is not None and suffix not in XML:
        raise InputError(
            "states belong to an MJCF scene, and this is another file",
            file=str(path),
            hint="leave the state out",
        )
    if options.model is not None and suffix not in LDRAW_FILES:
        raise InputError(
            "a model is named, but only LDraw files (.ldr, .mpd) have several",
            file=str(path),
            hint="leave the model out",
        )


def read_json(path: Path) -> Any:
    """Read the value of a JSON file.

    Raises `InputError` if the file is missing or is not JSON; the error names the file.
    """
    data = read_bytes(path)
    try:
        return parse_json(data)
    except InputError as error:
        raise error.located(file=str(path)) from None


def _from_json(data: bytes, folder: Path, source: str, options: FormatOptions) -> FileContent:
    """The assembly in JSON data; the content shows whether it is COMPAS, StableLego or kilter."""
    try:
        content = parse_json(data)
    except InputError as error:
        raise error.located(file=source) from None
    if source == STANDARD_INPUT_NAME and isinstance(content, dict) and "file" in content:
        raise InputError(
            "these are saved choices, which are read only from a file",
            file=source,
            hint="give the path of the file of choices: the file that they name is beside it",
        )
    other = None
    if not (isinstance(content, dict) and "parts" in content):
        other = _from_other_json(content, data, folder, source, options)
    if other is not None:
        return other
    assembly = from_dict(content, folder=folder, source=source)
    _check_units(assembly, options.units)
    return FileContent(assembly, states_gravity=True)


def _from_other_json(
    content: Any, data: bytes, folder: Path, source: str, options: FormatOptions
) -> FileContent | None:
    """The assembly in JSON data of another program; None if no such format is recognised."""
    if is_compas(content):
        units, contacts = options.units, options.contacts
        blocks = from_compas(content, units=units, source=source, contacts=contacts, folder=folder)
        return FileContent(blocks).without_held_parts()
    if is_stable_lego(content):
        bricks = from_stable_lego(content, data, rules=options.studs, source=source)
        return FileContent(bricks, states_gravity=True)
    if is_packing_plan(content):
        try:
            plan = replace(plan_of_json(content), source=source)
        except InputError as error:
            raise error.located(file=source) from None
        return FileContent(plan.assembly(), states_gravity=True)
    return None


def _check_units(assembly: Assembly, units: str | None) -> None:
    """Raise `InputError` if the option `units` contradicts the unit of the file."""
    if units is not None and units != assembly.units:
        raise InputError(
            f"the file is in {assembly.units}, but the units given are {units}",
            file=assembly.source,
            hint="leave the units out",
        )
