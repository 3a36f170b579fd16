"""Many assemblies of meshes as arrays: what planners and makers of data sets have at hand.

Most are boxes and other small closed meshes, whose geometry follows in arrays. A part that has to
be looked at (open, wound inwards, with vertices in one place or so many faces that it might stand
for something round) leaves its assembly to be read by itself.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from kilter.arrays import Index, ragged, read_only, starts
from kilter.assembly.assembly import Assembly
from kilter.assembly.part import Part
from kilter.errors import InputError
from kilter.shape.primitives import Mesh
from kilter.units import metres_per_unit
from kilter.validate import number

__all__ = ["AssemblyArrays"]


@dataclass(frozen=True, eq=False)
class AssemblyArrays:
    """M assemblies of N closed meshes in all, world frame.

    Parameters
    ----------
    vertices : array_like, shape (V, 3)
        Corners of all parts [length unit]; float32 counts as rounded to that.
    faces : array_like of int, shape (F, 3)
        Triangles by row of `vertices`, turning left seen from outside.
    vertex_start, face_start : array_like of int, shape (N + 1,)
        First vertex and first face of each part, and the number of all.
    part_start : array_like of int, shape (M + 1,)
        First part of each assembly, and the number of all.
    held : array_like of bool, shape (N,)
    gravity : array_like, shape (3,) or (M, 3)
        [m/s^2]
    density : array_like, shape (N,), optional
        [kg/m^3]; 1000 where not given.
    friction : float
        Of every contact [-].
    units : {"m", "cm", "mm", "in"}

    Raises
    ------
    InputError
        If shapes or starts do not fit each other.

    Examples
    --------
    >>> from kilter.shape.primitives import Box, surface
    >>> corners, faces = surface(Box([1, 1, 1]))
    >>> vertices = np.vstack([corners, corners + [0, 0, 1]])
    >>> two = AssemblyArrays(vertices, np.vstack([faces, faces + 8]), [0, 8, 16], [0, 12, 24],
    ...                      [0, 2], [True, False])
    >>> len(two), two[0]
    (1, <Assembly: 2 parts, 1 held, in m>)
    """

    vertices: Any
    faces: Any
    vertex_start: Any
    face_start: Any
    part_start: Any
    held: Any
    gravity: Any = (0.0, 0.0, -9.81)
    density: Any = None
    friction: float = 0.0
    units: str = "m"

    def __post_init__(self) -> None:
        metres_per_unit(self.units)
        number(self.friction, "friction", lowest=0)
        single = getattr(self.vertices, "dtype", None) == np.float32
        kinds = dict.fromkeys(("faces", "vertex_start", "face_start", "part_start"), np.int64)
        for name, kind in {"vertices": np.float32 if single else np.float64, **kinds}.items():
            wide = name in ("vertices", "faces")
            self._set(name, _array(getattr(self, name), kind, (-1, 3) if wide else (-1,), name))
        self._set("held", _array(self.held, np.bool_, (-1,), "held"))
        count = len(self.held)
        _require_starts(self.part_start, "part_start", None, count)
        _require_starts(self.vertex_start, "vertex_start", count, len(self.vertices))
        _require_starts(self.face_start, "face_start", count, len(self.faces))
        gravity = _array(self.gravity, np.float64, (-1,) if np.ndim(self.gravity) == 1 else (-1, 3))
        if gravity.shape not in ((3,), (len(self), 3)):
            raise InputError("gravity is no vector", hint="give one, or one an assembly, in m/s^2")
        self._set("gravity", np.broadcast_to(gravity, (len(self), 3)).copy())
        if self.density is not None:
            self._set("density", _array(self.density, np.float64, (count,), "density"))
        read_only(self)

    def _set(self, name: str, value: Any) -> None:
        object.__setattr__(self, name, value)

    def __len__(self) -> int:
        return len(self.part_start) - 1

    def __iter__(self) -> Iterator[Assembly]:
        return (self[k] for k in range(len(self)))

    def __getitem__(self, k: int) -> Assembly:
        """Assembly k; its parts are named 0, 1, ...

        Raises
        ------
        InputError
            If a mesh of it is none.
        """
        k = range(len(self))[k]
        first, last = self.part_start[k : k + 2].tolist()
        return Assembly(
            [self._part(n, str(n - first)) for n in range(first, last)],
            units=self.units,
            gravity=self.gravity[k],
            friction=self.friction,
        )

    def _part(self, n: int, name: str) -> Part:
        low, high = self.vertex_start[n : n + 2].tolist()
        faces = self.faces[self.face_start[n] : self.face_start[n + 1]] - low
        density = None if self.density is None else float(self.density[n])
        try:
            mesh = Mesh(self.vertices[low:high], faces)
        except InputError as error:
            raise error.located(part=name) from None
        return Part(name, mesh, grounded=bool(self.held[n]), density=density)

    def among(self, which: Index) -> AssemblyArrays:
        """Some of the assemblies, in the order of `which`."""
        _, parts = ragged(self.part_start, which)
        _, vertices = ragged(self.vertex_start, parts)
        own, faces = ragged(self.face_start, parts)
        vertex_start = starts(np.diff(self.vertex_start)[parts])
        moved = vertex_start[:-1] - self.vertex_start[parts]
        return AssemblyArrays(
            self.vertices[vertices],
            self.faces[faces] + moved[own][:, None],
            vertex_start,
            starts(np.diff(self.face_start)[parts]),
            starts(np.diff(self.part_start)[which]),
            self.held[parts],
            self.gravity[which],
            None if self.density is None else self.density[parts],
            self.friction,
            self.units,
        )


def _array(values: Any, kind: type, shape: tuple[int, ...], what: str = "gravity") -> Any:
    """A copy of values, of that kind and shape (-1: any length)."""
    try:
        array = np.array(values)
        if array.dtype.kind not in "biuf" or (kind is np.int64 and array.dtype.kind not in "iu"):
            raise ValueError
        array = array.astype(kind)
    except ValueError:
        hint = "give whole numbers" if kind is np.int64 else "give numbers"
        raise InputError(f"{what} is {values!r:.60}", hint=hint) from None
    fits = len(array.shape) == len(shape)
    if not fits or any(n not in (-1, m) for n, m in zip(shape, array.shape, strict=True)):
        wanted = " x ".join("n" if n == -1 else str(n) for n in shape)
        raise InputError(f"{what} has shape {array.shape}", hint=f"give {wanted}")
    return array


def _require_starts(start: Index, what: str, runs: int | None, rows: int) -> None:
    """Refuse what is no first row of each of `runs` runs of one row or more."""
    whole = len(start) > 1 and start[0] == 0 and start[-1] == rows and (np.diff(start) > 0).all()
    if not whole or (runs is not None and len(start) != runs + 1):
        raise InputError(
            f"{what} does not cut {rows} rows" + ("" if runs is None else f" in {runs}"),
            hint="give the first row of each run, rising from 0, and the number of all rows",
        )
