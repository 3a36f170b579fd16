"""The formats of files that hold bodies, and what each is read by.

    a new format:  a function from a path to `FileBodies`, and its ending in `FORMATS`

Objects keep their names; those without take the name of the file, and instances of one
object are numbered (``bolt``, ``bolt_2``). A mesh file that names nothing and holds several
bodies is taken apart into them. STL and OBJ state no unit; GLB is in metres by its standard
(y stays up); 3MF and STEP state theirs.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from kilter.assembly import Assembly, Part
from kilter.errors import InputError
from kilter.files.bodies import split_bodies
from kilter.files.glb import read_glb
from kilter.files.naming import filled
from kilter.files.obj import read_obj
from kilter.files.placed import FileBodies
from kilter.files.raw import read_bytes
from kilter.files.step import read_step
from kilter.files.stl import read_stl
from kilter.files.threemf import read_3mf
from kilter.shape.primitives import Mesh
from kilter.units import metres_per_unit

__all__ = [
    "EXACT",
    "FORMATS",
    "MESHES",
    "agreed_units",
    "assembly_of",
    "load_bodies",
    "read_bodies",
]

_Named = list[tuple[str | None, Mesh]]


def _bodies(found: _Named, notes: list[str], units: str | None = None) -> FileBodies:
    names, meshes = tuple(name for name, _ in found), tuple(mesh for _, mesh in found)
    return FileBodies(names, meshes, units=units, notes=tuple(notes))


def _obj(path: Path) -> FileBodies:
    return _bodies(read_obj(read_bytes(path)), [])


def _stl(path: Path) -> FileBodies:
    return _bodies(*read_stl(read_bytes(path)))


def _glb(path: Path) -> FileBodies:
    found, notes = read_glb(read_bytes(path))
    names, meshes = tuple(name for name, _ in found), tuple(mesh for _, mesh in found)
    return FileBodies(names, meshes, units="m", by_standard=True, notes=tuple(notes))


def _3mf(path: Path) -> FileBodies:
    found, units = read_3mf(read_bytes(path))
    return _bodies(found, [], units)


FORMATS: dict[str, Callable[[Path], FileBodies]] = {
    ".obj": _obj,
    ".stl": _stl,
    ".3mf": _3mf,
    ".glb": _glb,
    ".step": read_step,
    ".stp": read_step,
}
"""What reads files of each ending, lower case."""
EXACT = (".step", ".stp")
"""Endings of files whose faces are exact: what a part's `step` may name."""
MESHES = tuple(ending for ending in FORMATS if ending not in EXACT)
"""Endings of mesh files: what a part's `mesh` may name."""


def read_bodies(
    path: Path,
    *,
    without: Sequence[str] = (),
    progress: Callable[[str], None] | None = None,
) -> FileBodies:
    """The bodies of a file, in the file's own unit.

    Parameters
    ----------
    without : sequence of str
        Names, or globs, of bodies that need not be read where that saves work (STEP).
    progress : callable, optional
        Called with a word at each stage (STEP).

    Raises
    ------
    InputError
        If the file is missing, empty, damaged, or holds no faces; it names the file.
    """
    try:
        suffix = path.suffix.lower()
        if suffix in EXACT:
            found = read_step(path, without=without, progress=progress)
        else:
            found = FORMATS[suffix](path)
        if not found.left_out and not any(len(shape.triangles) for shape in found.shapes):
            raise InputError("no faces", hint="export solids, as triangles or polygons")
        return found
    except InputError as error:
        raise error.located(file=str(path)) from None


def load_bodies(
    path: Path,
    *,
    units: str | None = None,
    without: Sequence[str] = (),
    progress: Callable[[str], None] | None = None,
) -> tuple[Assembly, tuple[str, ...]]:
    """An assembly of the bodies of one file, and the names of those left out already.

    `without`, `progress`: as of `read_bodies`.

    Raises
    ------
    InputError
        As `read_bodies`; and if `units` differ from those that the file states.
    """
    found = read_bodies(path, without=without, progress=progress)
    try:
        return assembly_of(found, units=units, stem=path.stem, source=str(path)), found.left_out
    except InputError as error:
        raise error.located(file=str(path)) from None


def assembly_of(
    found: FileBodies, *, units: str | None = None, stem: str = "part", source: str = ""
) -> Assembly:
    """An assembly of bodies; those without a name are named by the stem, one that is several cut.

    Raises
    ------
    InputError
        If none is left, or `units` differ from those that are stated.
    """
    if not found.shapes:
        raise InputError("no part is left", hint="leave fewer parts out")
    notes = list(found.notes)
    what = "the file" if source else "the object"
    agreed = agreed_units(found.units, units, notes if found.by_standard else None, what=what)
    alone = found.shapes[0]
    if found.names == (None,) and isinstance(alone, Mesh):
        apart = tuple(split_bodies(alone))
        found = replace(found, names=(None,) * len(apart), shapes=apart)
    rows = zip(filled(found.names, stem), found.shapes, found.places, strict=True)
    parts = [Part(name, shape, pose) for name, shape, pose in rows]
    return Assembly(parts, units=agreed, source=source, notes=notes)


def agreed_units(
    stated: str | None,
    asked: str | None,
    notes: list[str] | None = None,
    *,
    what: str = "the object",
) -> str:
    """The units to read in: those that are stated, else those asked for, else metres.

    Of a format that is in its units by its standard others may be asked for: `notes` says so.

    Raises
    ------
    InputError
        If they differ.
    """
    if asked is not None:
        metres_per_unit(asked)
    if stated and asked and stated != asked:
        if notes is None:
            raise InputError(
                f"{what} is in {stated}, {asked} were asked for", hint="leave the units out"
            )
        notes.append(f"this format is in {stated} by its standard; read as {asked} as asked")
        return asked
    return stated or asked or "m"
