"""Reading of whatever describes an assembly: the kind is told by suffix and content."""

from __future__ import annotations

import dataclasses
import os
import sys
from pathlib import Path
from typing import Any

from kilter.assembly import Assembly, Part
from kilter.errors import InputError
from kilter.files.strict_json import parse_json
from kilter.units import metres_per_unit

__all__ = ["load"]

STANDARD_INPUT = "-"


def load(source: str | Path, *, units: str | None = None, density: float | None = None) -> Assembly:
    """The assembly that a file, a folder, or standard input (``-``) describes.

    Parameters
    ----------
    source : path
        A kilter file or COMPAS assembly (.json), a mesh file (.obj, .stl, .3mf, .glb), a
        STEP file (.step, .stp), a folder of them, or ``-`` for JSON on standard input.
    units : {"m", "cm", "mm", "in"}, optional
        For formats without units; metres where it is not given.
    density : float, optional
        Of parts without density and mass [kg/m^3].

    Raises
    ------
    InputError
        If it cannot be read; it says what is wrong, where, and what to do.
    """
    if units is not None:
        metres_per_unit(units)
    if not isinstance(source, str | os.PathLike) or not os.fspath(source):
        raise InputError(f"a file's path is {source!r:.60}", hint="give a path, or '-'")
    assembly = _read(source, units)
    return assembly if density is None else _with_density(assembly, density)


def _read(source: str | Path, units: str | None) -> Assembly:
    if os.fspath(source) == STANDARD_INPUT:
        return _from_json(sys.stdin.buffer.read(), Path(), "standard input", units)
    path = Path(source)
    suffix = path.suffix.lower()
    if _is_folder(path):
        from kilter.files.folder import load_folder

        return load_folder(path, units=units)
    from kilter.files.meshes import SUFFIXES, load_meshes
    from kilter.files.raw import read_bytes
    from kilter.files.step import SUFFIXES as STEP
    from kilter.files.step import load_step

    if suffix in SUFFIXES:
        return load_meshes(path, units=units)
    if suffix in STEP:
        return load_step(path, units=units)
    data = read_bytes(path)
    if suffix == ".json":
        return _from_json(data, path.parent, str(path), units)
    kinds = f".json, {', '.join([*SUFFIXES, *STEP])}, or a folder of them"
    raise InputError(
        f"files of {path.suffix or 'no ending'} are not read", file=str(path), hint=f"give {kinds}"
    )


def _is_folder(path: Path) -> bool:
    try:
        return path.is_dir()
    except (OSError, ValueError):
        return False


def _from_json(data: bytes, folder: Path, source: str, units: str | None) -> Assembly:
    from kilter.files.compas import from_compas, is_compas
    from kilter.files.kilter_json import from_dict

    try:
        content = parse_json(data)
    except InputError as error:
        raise error.located(file=source) from None
    if is_compas(content):
        return from_compas(content, units=units, source=source)
    assembly = from_dict(content, folder=folder, source=source)
    _check_units(assembly, units)
    return assembly


def _check_units(assembly: Assembly, units: str | None) -> None:
    if units is not None and units != assembly.units:
        raise InputError(
            f"the file is in {assembly.units}, {units} were asked for",
            file=assembly.source,
            hint="leave the units out, the file states them",
        )


def _with_density(assembly: Assembly, density: float) -> Assembly:
    def filled(part: Part) -> Any:
        if part.density is not None or part.mass is not None:
            return part
        return dataclasses.replace(part, density=density)

    try:
        return dataclasses.replace(assembly, parts=[filled(part) for part in assembly.parts])
    except InputError as error:
        raise InputError(error.what, hint=error.hint) from None
