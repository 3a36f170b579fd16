"""Content of a file or of standard input: the reader of each kind, before options are applied."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

from kilter.assembly import Assembly
from kilter.errors import InputError
from kilter.files.brick_text import BRICK_TEXT, load_brick_text
from kilter.files.compas import from_compas, is_compas
from kilter.files.folder import load_folder
from kilter.files.format_options import FormatOptions
from kilter.files.formats import FORMATS, load_bodies
from kilter.files.kilter_json import from_dict
from kilter.files.ldraw import LDRAW_FILES, load_ldraw
from kilter.files.packing_lists import CSV, is_packing_plan, load_plan, plan_of_json
from kilter.files.raw import is_folder, read_bounded, read_bytes
from kilter.files.stable_lego import from_stable_lego, is_stable_lego
from kilter.files.start_folder import require_below
from kilter.files.strict_json import parse_json
from kilter.files.usd.usd_stage import USD

__all__ = ["ENDINGS", "FileContent", "read_json", "read_path"]

XML = (".xml", ".mjcf", ".urdf")
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
    if is_folder(path):
        return FileContent(load_folder(path, units=units), from_cad=True)
    if suffix in FORMATS:
        assembly, left_out = load_bodies(path, units=units, without=without, progress=progress)
        return FileContent(assembly, left_out=left_out, from_cad=True)
    if suffix in XML:
        # imported late: other files do not need these modules
        from kilter.files.xml_scenes import load_xml

        return FileContent(*load_xml(path, options))
    if suffix in USD:
        # imported late: other files do not need these modules
        from kilter.files.scene_process import read_scene

        return FileContent(read_scene("usd", path, options), states_gravity=True)
    if suffix in LDRAW_FILES:
        return FileContent(load_ldraw(path, rules=options.studs), states_gravity=True)
    if suffix in BRICK_TEXT:
        return FileContent(load_brick_text(path, rules=options.studs), states_gravity=True)
    if suffix in CSV:
        return FileContent(load_plan(path, units=units).assembly(), states_gravity=True)
    data = read_bytes(path)
    if suffix == ".json":
        return _from_json(data, path.parent, str(path), options)
    kinds = f"{', '.join(ENDINGS)}, or a folder of them"
    raise InputError(
        f"cannot read files of type {path.suffix or '(no ending)'}",
        file=str(path),
        hint=f"give {kinds}",
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
        other = _from_other_json(content, data, source, options)
    if other is not None:
        return other
    assembly = from_dict(content, folder=folder, source=source)
    _check_units(assembly, options.units)
    return FileContent(assembly, states_gravity=True)


def _from_other_json(
    content: Any, data: bytes, source: str, options: FormatOptions
) -> FileContent | None:
    """The assembly in JSON data of another program; None if no such format is recognised."""
    if is_compas(content):
        units, contacts = options.units, options.contacts
        return FileContent(from_compas(content, units=units, source=source, contacts=contacts))
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
