"""Files that the parts of a kilter file name: meshes and STEP, each read once."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from kilter.errors import InputError, nearest_name, some_names
from kilter.files.formats import EXACT, MESHES, read_bodies
from kilter.files.limits import named_path
from kilter.files.placed import FileBodies, joined
from kilter.shape.primitives import Mesh
from kilter.shape.solid import Solid, moved_solid, scaled_solid
from kilter.units import metres_per_unit

__all__ = ["NamedFiles"]


class NamedFiles:
    """Mesh and STEP files named by parts, each read once; in the units of the assembly.

    Parameters
    ----------
    folder : Path
        What paths are relative to.
    units : str
        Of the assembly.
    """

    def __init__(self, folder: Path, units: str) -> None:
        self.folder = folder
        self.units = units
        self.notes: list[str] = []
        self._read: dict[str, FileBodies] = {}
        self._shapes: dict[tuple[str, str, str | None], Mesh | Solid] = {}

    def mesh(self, path: str) -> Mesh | Solid:
        """All objects of a mesh file as one mesh."""
        key = ("mesh", path, None)
        if key not in self._shapes:
            found = self._file("mesh", path, MESHES)
            if len(found.shapes) > 1:
                self.notes.append(
                    f"mesh {path!r} holds {len(found.shapes)} objects, taken as one part"
                )
            shapes = [shape for shape, _ in found.in_units(self.units)]
            self._shapes[key] = joined([shape for shape in shapes if isinstance(shape, Mesh)])
        return self._shapes[key]

    def step(self, path: str, name: str | None = None) -> Mesh | Solid:
        """A solid of a STEP file, where that file has it."""
        key = ("step", path, name)
        if key not in self._shapes:
            found = self._file("step", path, EXACT)
            try:
                k = _position(found.names, name)
            except InputError as error:
                raise error.about(f"step {path!r}: {error.what}") from None
            solid, pose = found.shapes[k], found.places[k]
            assert isinstance(solid, Solid)
            factor = metres_per_unit(found.units or self.units) / metres_per_unit(self.units)
            self._shapes[key] = scaled_solid(moved_solid(solid, pose), factor)
        return self._shapes[key]

    def _file(self, key: str, name: str, endings: Sequence[str]) -> FileBodies:
        """A file that is named under a key, read once."""
        if Path(name).suffix.lower() not in endings:
            raise InputError(
                f"{key} {name!r} is of no kind that is read",
                hint=f"give one of {', '.join(endings)}",
            )
        if name not in self._read:
            try:
                found = read_bodies(named_path(self.folder, name))
            except InputError as error:
                what = "object" if key == "mesh" else "solid"
                inside = f" {what} {error.part!r}:" if error.part else ""
                raise InputError(f"{key} {name!r}:{inside} {error.what}", hint=error.hint) from None
            self.notes += [f"{key} {name!r}: {note}" for note in found.notes]
            self._read[name] = found
        return self._read[name]


def _position(names: Sequence[str | None], name: str | None) -> int:
    """Where a solid stands; its name may be left out where there is one.

    Raises
    ------
    InputError
        If there is none of that name, or several and no name was given.
    """
    known = [str(one) for one in names]
    if name is None and len(known) > 1:
        raise InputError(
            f"it holds {len(known)} solids: {some_names(known)}",
            hint='name one: {"path": ..., "name": ...}',
        )
    if name is not None and name not in known:
        near = nearest_name(name, known)
        hint = f"did you mean {near!r}?" if near else f"there are: {some_names(known)}"
        raise InputError(f"it holds no solid {name!r}", hint=hint)
    return 0 if name is None else known.index(name)
