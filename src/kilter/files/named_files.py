"""Files that the parts of a kilter file name: meshes and STEP, each read once."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from kilter.errors import InputError
from kilter.files.placed import joined, scaled
from kilter.shape.primitives import Mesh
from kilter.shape.solid import Solid, scaled_solid
from kilter.units import metres_per_unit

if TYPE_CHECKING:
    from kilter.files.step import StepSolids

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
        self._meshes: dict[str, Mesh] = {}
        self._steps: dict[str, StepSolids] = {}
        self._solids: dict[tuple[str, str | None], Solid] = {}

    def mesh(self, path: str) -> Mesh:
        """All objects of a mesh file as one mesh."""
        if path not in self._meshes:
            self._meshes[path] = self._read_mesh(path)
        return self._meshes[path]

    def step(self, path: str, name: str | None = None) -> Solid:
        """A solid of a STEP file, where that file has it."""
        if (path, name) not in self._solids:
            if path not in self._steps:
                self._steps[path] = self._read_step(path)
            found = self._steps[path]
            try:
                solid = found.named(name)
            except InputError as error:
                raise InputError(f"step {path!r}: {error.what}", hint=error.hint) from None
            self._solids[path, name] = scaled_solid(solid, self._factor(found.units))
        return self._solids[path, name]

    def _factor(self, units: str | None) -> float:
        return metres_per_unit(units or self.units) / metres_per_unit(self.units)

    def _read_mesh(self, name: str) -> Mesh:
        from kilter.files.meshes import SUFFIXES, read_solids

        path = self.folder / name
        _check_kind("mesh", name, SUFFIXES)
        try:
            solids = read_solids(path)
        except InputError as error:
            inside = f" object {error.part!r}:" if error.part else ""
            raise InputError(f"mesh {name!r}:{inside} {error.what}", hint=error.hint) from None
        self.notes += [f"mesh {name!r}: {note}" for note in solids.notes]
        if len(solids.meshes) > 1:
            self.notes.append(
                f"mesh {name!r} holds {len(solids.meshes)} objects, taken as one part"
            )
        return scaled(joined(solids.meshes), self._factor(solids.units))

    def _read_step(self, name: str) -> StepSolids:
        from kilter.files.step import SUFFIXES, read_step

        _check_kind("step", name, SUFFIXES)
        try:
            found = read_step(self.folder / name)
        except InputError as error:
            inside = f" solid {error.part!r}:" if error.part else ""
            raise InputError(f"step {name!r}:{inside} {error.what}", hint=error.hint) from None
        self.notes += [f"step {name!r}: {note}" for note in found.notes]
        return found


def _check_kind(key: str, name: str, suffixes: Sequence[str]) -> None:
    if Path(name).suffix.lower() not in suffixes:
        raise InputError(
            f"{key} {name!r} is of no kind that is read", hint=f"give one of {', '.join(suffixes)}"
        )
