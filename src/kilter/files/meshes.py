"""Files of meshes: OBJ, STL, 3MF, GLB, each of one or several objects.

Objects keep their names; those without take the name of the file, and instances of one
object are numbered (``bolt``, ``bolt_2``). A file that names nothing and holds several
bodies is taken apart into them. STL and OBJ state no unit; GLB is in metres by its standard
(y stays up); 3MF states its unit.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

from kilter.assembly import Assembly, Part
from kilter.errors import InputError
from kilter.files.bodies import split_bodies
from kilter.files.glb import read_glb
from kilter.files.naming import filled
from kilter.files.obj import read_obj
from kilter.files.raw import read_bytes
from kilter.files.stl import read_stl
from kilter.files.threemf import read_3mf
from kilter.shape.primitives import Mesh

__all__ = ["SUFFIXES", "Solids", "load_meshes", "read_solids"]


@dataclass(frozen=True, slots=True, eq=False)
class Solids:
    """What a file of meshes holds.

    Attributes
    ----------
    names : tuple of str or None
    meshes : tuple of Mesh
    units : str or None
        None where the file states no unit.
    by_standard : bool
        The unit is that of the format, not one that the file states.
    notes : tuple of str
    """

    names: tuple[str | None, ...]
    meshes: tuple[Mesh, ...]
    units: str | None = None
    by_standard: bool = False
    notes: tuple[str, ...] = ()


_Named = list[tuple[str | None, Mesh]]


def _solids(found: _Named, notes: list[str], units: str | None = None) -> Solids:
    names, meshes = tuple(name for name, _ in found), tuple(mesh for _, mesh in found)
    return Solids(names, meshes, units=units, notes=tuple(notes))


def _obj(data: bytes) -> Solids:
    return _solids(read_obj(data), [])


def _stl(data: bytes) -> Solids:
    return _solids(*read_stl(data))


def _glb(data: bytes) -> Solids:
    return replace(_solids(*read_glb(data), units="m"), by_standard=True)


def _3mf(data: bytes) -> Solids:
    found, units = read_3mf(data)
    return _solids(found, [], units)


_READERS: dict[str, Callable[[bytes], Solids]] = {
    ".obj": _obj,
    ".stl": _stl,
    ".3mf": _3mf,
    ".glb": _glb,
}
SUFFIXES = tuple(_READERS)
"""Endings of mesh files that are read, lower case."""


def read_solids(path: Path) -> Solids:
    """The objects of a mesh file, in the file's own unit.

    Raises
    ------
    InputError
        If the file is missing, empty, damaged, or holds no triangles; it names the file.
    """
    data = read_bytes(path)
    try:
        solids = _READERS[path.suffix.lower()](data)
        if not any(len(mesh.triangles) for mesh in solids.meshes):
            raise InputError("no faces", hint="export solids, as triangles or polygons")
        return solids
    except InputError as error:
        raise error.located(file=str(path)) from None


def load_meshes(path: Path, *, units: str | None = None) -> Assembly:
    """An assembly of the objects of one mesh file.

    Raises
    ------
    InputError
        As `read_solids`; and if `units` differ from those that the file states.
    """
    solids = read_solids(path)
    names, meshes = solids.names, solids.meshes
    if names == (None,):
        meshes = tuple(split_bodies(meshes[0]))
        names = (None,) * len(meshes)
    notes = list(solids.notes)
    if solids.units and units and units != solids.units:
        if not solids.by_standard:
            raise InputError(
                f"the file is in {solids.units}, {units} were asked for",
                file=str(path),
                hint="leave the units out",
            )
        notes.append(f"this format is in {solids.units} by its standard; read as {units} as asked")
    named = zip(filled(names, path.stem), meshes, strict=True)
    try:
        parts = [Part(name, mesh) for name, mesh in named]
    except InputError as error:
        raise error.located(file=str(path)) from None
    return Assembly(parts, units=units or solids.units or "m", source=str(path), notes=notes)
