"""File formats that hold bodies, with the reader of each.

    a new format:  a function from a path to `FileBodies`, and its ending in `FORMATS`

Objects keep their names. An object without a name is named after the file, and instances of the
same object are numbered (``bolt``, ``bolt_2``). A mesh file without names is split into its
separate bodies. STL and OBJ state no unit; GLB is in metres by its standard (y stays up); 3MF and
STEP state their unit.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from kilter.assembly import Assembly, Part
from kilter.errors import InputError
from kilter.files.bodies import split_bodies
from kilter.files.glb import read_glb
from kilter.files.naming import fill_names
from kilter.files.obj import read_obj
from kilter.files.placed import FileBodies
from kilter.files.raw import read_bytes
from kilter.files.reader_guard import reader_guard
from kilter.files.start_folder import require_below
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

_Objects = list[tuple[str | None, Mesh]]


def _bodies(objects: _Objects, notes: list[str], units: str | None = None) -> FileBodies:
    """Convert named meshes to `FileBodies`."""
    names, meshes = tuple(name for name, _ in objects), tuple(mesh for _, mesh in objects)
    return FileBodies(names, meshes, units=units, notes=tuple(notes))


def _obj(path: Path) -> FileBodies:
    """Read the meshes of an OBJ file."""
    return _bodies(read_obj(read_bytes(path)), [])


def _stl(path: Path) -> FileBodies:
    """Read the meshes of an STL file."""
    return _bodies(*read_stl(read_bytes(path)))


def _glb(path: Path) -> FileBodies:
    """Read the meshes of a GLB file, in metres as the standard states."""
    objects, notes = read_glb(read_bytes(path))
    names, meshes = tuple(name for name, _ in objects), tuple(mesh for _, mesh in objects)
    return FileBodies(names, meshes, units="m", by_standard=True, notes=tuple(notes))


def _3mf(path: Path) -> FileBodies:
    """Read the meshes of a 3MF file."""
    objects, units, notes = read_3mf(read_bytes(path))
    return _bodies(objects, notes, units)


def _step(
    path: Path,
    without: Sequence[str] = (),
    progress: Callable[[str], None] | None = None,
) -> FileBodies:
    """Read the solids of a STEP file, except for the parts that `without` names."""
    # imported late: other files do not need these modules
    from kilter.files.step import read_step

    return read_step(path, without=without, progress=progress)


FORMATS: dict[str, Callable[[Path], FileBodies]] = {
    ".obj": _obj,
    ".stl": _stl,
    ".3mf": _3mf,
    ".glb": _glb,
    ".step": _step,
    ".stp": _step,
}
"""Reader of each file ending (lower case)."""
EXACT = (".step", ".stp")
"""Endings of files with exact faces; the key `step` of a part accepts these."""
ZIPPED = (".3mf",)
"""Endings of zip files."""
ZIP_DAMAGE = frozenset({"builtins.RuntimeError", "xml.etree.ElementTree.ParseError"})
"""Further exceptions of a damaged zip of XML files: an encrypted member, invalid XML."""
MESHES = tuple(ending for ending in FORMATS if ending not in EXACT)
"""Endings of mesh files; the key `mesh` of a part accepts these."""


def read_bodies(
    path: Path,
    *,
    without: Sequence[str] = (),
    progress: Callable[[str], None] | None = None,
) -> FileBodies:
    """Read the meshes or solids of a file, in the file's own length unit.

    Arguments: `without`: names, or globs, of bodies that are left out; only the STEP reader leaves
    them out here. Raises `InputError` if the file is missing, empty, damaged, or holds no faces; it
    names the file.
    """
    require_below(path)
    suffix = path.suffix.lower()
    with reader_guard(path, ZIP_DAMAGE if suffix in ZIPPED else ()):
        bodies = _step(path, without, progress) if suffix in EXACT else FORMATS[suffix](path)
        if not bodies.left_out and not any(len(shape.triangles) for shape in bodies.shapes):
            raise InputError("no faces", hint="export solids, as triangles or polygons")
        return bodies


def load_bodies(
    path: Path,
    *,
    units: str | None = None,
    without: Sequence[str] = (),
    progress: Callable[[str], None] | None = None,
) -> tuple[Assembly, tuple[str, ...]]:
    """Read the meshes or solids of a file as the parts of an assembly.

    `without` and `progress` are those of `read_bodies`.

    Returns `left_out`: names of the bodies that the reader has left out. Raises `InputError` as
    `read_bodies`; also if `units` differ from the units that the file states.
    """
    bodies = read_bodies(path, without=without, progress=progress)
    with reader_guard(path):
        return assembly_of(bodies, units=units, stem=path.stem, source=str(path)), bodies.left_out


def assembly_of(
    bodies: FileBodies, *, units: str | None = None, stem: str = "part", source: str = ""
) -> Assembly:
    """Build an assembly with a part for each body.

    A body without a name is named after `stem`. A single mesh without a name is split into its
    separate bodies.

    Raises `InputError` if there is no body, or `units` differ from the units that are stated.
    """
    if not bodies.shapes:
        raise InputError("all parts are left out", hint="leave fewer parts out")
    notes = list(bodies.notes)
    what = "the file" if source else "the object"
    agreed = agreed_units(bodies.units, units, notes if bodies.by_standard else None, what=what)
    only = bodies.shapes[0]
    if bodies.names == (None,) and isinstance(only, Mesh):
        pieces = tuple(split_bodies(only))
        bodies = replace(bodies, names=(None,) * len(pieces), shapes=pieces)
    names = fill_names(bodies.names, stem)
    rows = zip(names, bodies.shapes, bodies.places, bodies.stated, strict=True)
    parts = [Part(name, shape, pose, **stated) for name, shape, pose, stated in rows]
    return Assembly(parts, units=agreed, source=source, notes=notes)


def agreed_units(
    stated: str | None,
    asked: str | None,
    notes: list[str] | None = None,
    *,
    what: str = "the object",
) -> str:
    """The length unit to use: the unit that the file states, else the given unit, else "m".

    Arguments: `notes`: given if the unit is only that of the standard: the user's unit then wins,
    and a note is appended. Raises `InputError` if both units are given, differ, and `notes` is
    None.
    """
    if asked is not None:
        metres_per_unit(asked)
    if stated and asked and stated != asked:
        if notes is None:
            raise InputError(
                f"{what} is in {stated}, but the units given are {asked}",
                hint="leave the units out",
            )
        notes.append(f"the units of this format are {stated}; the given units {asked} are used")
        return asked
    return stated or asked or "m"
