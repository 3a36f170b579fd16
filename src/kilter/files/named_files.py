"""Read the mesh and STEP files that the parts of a kilter file name, each once."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from kilter.errors import InputError, nearest_name, some_names
from kilter.files.formats import EXACT, MESHES, read_bodies
from kilter.files.limits import named_path
from kilter.files.placed import FileBodies, join_meshes
from kilter.shape.primitives import Mesh
from kilter.shape.solid import Solid, move_solid, scale_solid
from kilter.units import metres_per_unit

__all__ = ["NamedFiles"]


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
