"""File formats that hold bodies, with the reader of each.

    a new format:  a function from a path to `FileBodies`, and its ending in `FORMATS`

Objects keep their names. An object without a name is named after the file, and instances of the
same object are numbered (``bolt``, ``bolt_2``). A mesh file without names is split into its
separate bodies. STL, OBJ, PLY and OFF state no unit: a file by itself is read in mm (STL), as
slicers and CAD do, or in m. GLB is in metres by its standard (y stays up); 3MF and STEP state their
unit, and FreeCAD has millimetres.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from kilter.assembly import Assembly, Part
from kilter.errors import InputError, nearest_name, some_names
from kilter.files.cad.step import read_step
from kilter.files.limits import named_path, read_bytes, require_below
from kilter.files.meshes.bodies import split_bodies
from kilter.files.meshes.glb import read_glb, read_gltf
from kilter.files.meshes.obj import read_obj
from kilter.files.meshes.off import read_off
from kilter.files.meshes.placed import FileBodies, fill_names, join_meshes
from kilter.files.meshes.rhino import read_rhino
from kilter.files.meshes.stl import read_stl
from kilter.files.meshes.threemf import read_3mf
from kilter.files.meshes.trimesh_files import read_with_trimesh
from kilter.files.reader_guard import ZIP_DAMAGE, reader_guard
from kilter.shape.primitives import Mesh
from kilter.shape.solid import Solid, move_solid, scale_solid
from kilter.units import metres_per_unit

_Objects = list[tuple[str | None, Mesh]]


def _bodies(objects: _Objects, notes: list[str], units: str | None = None) -> FileBodies:
    """Convert named meshes to `FileBodies`."""
    names, meshes = tuple(name for name, _ in objects), tuple(mesh for _, mesh in objects)
    return FileBodies(names, meshes, units=units, notes=tuple(notes))


def _obj(path: Path) -> FileBodies:
    """Read the meshes of an OBJ file."""
    return _bodies(read_obj(read_bytes(path)), [])


def _off(path: Path) -> FileBodies:
    """Read the mesh of an OFF file."""
    return _bodies(read_off(read_bytes(path)), [])


def _stl(path: Path) -> FileBodies:
    """Read the meshes of an STL file."""
    return replace(_bodies(*read_stl(read_bytes(path))), usual="mm")


def _glb(path: Path) -> FileBodies:
    """Read the meshes of a glTF file, in metres as the standard states."""
    is_text = path.suffix.lower() == ".gltf"
    objects, notes = read_gltf(path) if is_text else read_glb(read_bytes(path))
    names, meshes = tuple(name for name, _ in objects), tuple(mesh for _, mesh in objects)
    return FileBodies(names, meshes, units="m", by_standard=True, notes=tuple(notes))


def _3mf(path: Path) -> FileBodies:
    """Read the meshes of a 3MF file."""
    objects, units, notes = read_3mf(read_bytes(path))
    return _bodies(objects, notes, units)


def _trimesh(path: Path) -> FileBodies:
    """Read the meshes of a file that trimesh reads."""
    with reader_guard(path, ZIP_DAMAGE):
        return read_with_trimesh(path)


def _rhino(path: Path) -> FileBodies:
    """Read the meshes of a Rhino file."""
    with reader_guard(path):
        return read_rhino(path)


def _step(
    path: Path,
    without: Sequence[str] = (),
    progress: Callable[[str], None] | None = None,
) -> FileBodies:
    """Read the solids of a STEP file, except for the parts that `without` names."""
    # imported late: other files do not need these modules

    return read_step(path, without=without, progress=progress)


FORMATS: dict[str, Callable[[Path], FileBodies]] = {
    ".obj": _obj,
    ".stl": _stl,
    ".3mf": _3mf,
    ".glb": _glb,
    ".gltf": _glb,
    ".ply": _trimesh,
    ".off": _off,
    ".dae": _trimesh,
    ".3dm": _rhino,
    ".step": _step,
    ".stp": _step,
    ".igs": _step,
    ".iges": _step,
    ".fcstd": _step,
}
"""Reader of each file ending (lower case)."""
EXACT = (".step", ".stp", ".igs", ".iges", ".fcstd")
"""Endings of files with exact faces; the key `step` of a part accepts these."""
ZIPPED = (".3mf",)
"""Endings of zip files."""
IN_FOLDERS = tuple(ending for ending in FORMATS if ending != ".fcstd")
"""Endings of the files of a folder that is read; a FreeCAD document names those of its parts."""
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
    assumed = {}
    if source and not (bodies.units or units):
        agreed = bodies.usual
        assumed = {"units": agreed}
    only = bodies.shapes[0]
    if bodies.names == (None,) and isinstance(only, Mesh):
        pieces = tuple(split_bodies(only))
        bodies = replace(bodies, names=(None,) * len(pieces), shapes=pieces)
    names = fill_names(bodies.names, stem)
    rows = zip(names, bodies.shapes, bodies.places, bodies.stated, strict=True)
    parts = [Part(name, shape, pose, **stated) for name, shape, pose, stated in rows]
    joints = bodies.joints
    return Assembly(parts, joints=joints, units=agreed, source=source, notes=notes, assumed=assumed)


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


# Read the mesh and STEP files that the parts of a kilter file name, each once.


class NamedFiles:
    """Shapes from the mesh and STEP files that an assembly file names; each file is read once."""

    def __init__(self, folder: Path, units: str) -> None:
        self.folder = folder
        self.units = units
        self.notes: list[str] = []
        self._read: dict[str, FileBodies] = {}
        self._shapes: dict[tuple[str, str, str | None], Mesh | Solid] = {}

    def mesh(self, path: str) -> Mesh | Solid:
        """Read all objects of a mesh file, and join them to a single mesh."""
        key = ("mesh", path, None)
        if key not in self._shapes:
            bodies = self._file("mesh", path, MESHES)
            if len(bodies.shapes) > 1:
                self.notes.append(
                    f"mesh {path!r} holds {len(bodies.shapes)} objects, read as a single part"
                )
            shapes = [shape for shape, _ in bodies.in_units(self.units)]
            self._shapes[key] = join_meshes([shape for shape in shapes if isinstance(shape, Mesh)])
        return self._shapes[key]

    def step(self, path: str, name: str | None = None) -> Mesh | Solid:
        """Read a solid of a STEP file, at its position in that file."""
        key = ("step", path, name)
        if key not in self._shapes:
            bodies = self._file("step", path, EXACT)
            try:
                k = _position(bodies.names, name)
            except InputError as error:
                raise error.about(f"step {path!r}: {error.what}") from None
            solid, pose = bodies.shapes[k], bodies.places[k]
            assert isinstance(solid, Solid)
            factor = metres_per_unit(bodies.units or self.units) / metres_per_unit(self.units)
            self._shapes[key] = scale_solid(move_solid(solid, pose), factor)
        return self._shapes[key]

    def _file(self, key: str, name: str, endings: Sequence[str]) -> FileBodies:
        """The meshes or solids of a file that a part names under `key`; each file is read once."""
        if Path(name).suffix.lower() not in endings:
            raise InputError(
                f"{key} {name!r}: this file type cannot be read",
                hint=f"give one of {', '.join(endings)}",
            )
        if name not in self._read:
            try:
                bodies = read_bodies(named_path(self.folder, name))
            except InputError as error:
                what = "object" if key == "mesh" else "solid"
                inside = f" {what} {error.part!r}:" if error.part else ""
                raise InputError(f"{key} {name!r}:{inside} {error.what}", hint=error.hint) from None
            self.notes += [f"{key} {name!r}: {note}" for note in bodies.notes]
            self._read[name] = bodies
        return self._read[name]


def _position(names: Sequence[str | None], name: str | None) -> int:
    """Index of the solid with a name; without a name, 0 if there is only one solid.

    Raises `InputError` if no solid has the name, or if there are several and no name is given.
    """
    known = [str(label) for label in names]
    if name is None and len(known) > 1:
        raise InputError(
            f"it holds {len(known)} solids: {some_names(known)}",
            hint='name a solid: {"path": ..., "name": ...}',
        )
    if name is not None and name not in known:
        near = nearest_name(name, known)
        hint = f"did you mean {near!r}?" if near else f"there are: {some_names(known)}"
        raise InputError(f"it holds no solid {name!r}", hint=hint)
    return 0 if name is None else known.index(name)
