"""AssemblyArrays: many assemblies of meshes as arrays, for planners and generators of data sets.

The geometry of boxes and other small closed meshes is computed for all at once. An assembly is
read by itself if one of its parts needs repair: it is open, its faces point inwards, vertices
coincide, or it has so many faces that it may represent a curved surface.
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


@dataclass(frozen=True, eq=False)
class AssemblyArrays:
    """A batch of M assemblies with N parts in total, all closed meshes, as arrays.

    Parameters
    ----------
    vertices : array_like, shape (V, 3)
        Vertices of all parts [length unit]; a float32 array has the accuracy of float32.
    faces : array_like of int, shape (F, 3)
        Triangles as rows of `vertices`, counterclockwise seen from outside.
    vertex_start, face_start : array_like of int, shape (N + 1,)
        First vertex and first face of each part, followed by the total number.
    part_start : array_like of int, shape (M + 1,)
        First part of each assembly, followed by the total number.
    held : array_like of bool, shape (N,)
        Whether each part is held.
    gravity : array_like, shape (3,) or (M, 3)
        Acceleration of gravity, for all or for each assembly [m/s^2].
    density : array_like, shape (N,), optional
        Densities [kg/m^3]; default 1000.
    friction : float
        Friction coefficient of every contact [-].
    units : {"m", "cm", "mm", "in"}
        Length unit.

    Raises
    ------
    InputError
        If the shapes of the arrays, or the starts, are inconsistent.

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
            raise InputError(
                "gravity is not a vector",
                hint="give a vector, or a vector for each assembly, in m/s^2",
            )
        self._set("gravity", np.broadcast_to(gravity, (len(self), 3)).copy())
        if self.density is not None:
            self._set("density", _array(self.density, np.float64, (count,), "density"))
        read_only(self)

    def _set(self, name: str, value: Any) -> None:
        """Set a field of the frozen value."""
        object.__setattr__(self, name, value)

    def __len__(self) -> int:
        return len(self.part_start) - 1

    def __iter__(self) -> Iterator[Assembly]:
        return (self[k] for k in range(len(self)))

    def __getitem__(self, k: int) -> Assembly:
        """The assembly with index k of the batch; its parts are named 0, 1, ...

        Raises `InputError` if one of its meshes is invalid.
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
        """Build the part with index n (counted through the batch), with the given name."""
        low, high = self.vertex_start[n : n + 2].tolist()
        faces = self.faces[self.face_start[n] : self.face_start[n + 1]] - low
        density = None if self.density is None else float(self.density[n])
        try:
            mesh = Mesh(self.vertices[low:high], faces)
        except InputError as error:
            raise error.located(part=name) from None
        return Part(name, mesh, grounded=bool(self.held[n]), density=density)

    def among(self, which: Index) -> AssemblyArrays:
        """The assemblies with the indices `which`, in that order, as a batch."""
        _, parts = ragged(self.part_start, which)
        _, vertices = ragged(self.vertex_start, parts)
        owner, faces = ragged(self.face_start, parts)
        vertex_start = starts(np.diff(self.vertex_start)[parts])
        moved = vertex_start[:-1] - self.vertex_start[parts]
        return AssemblyArrays(
            self.vertices[vertices],
            self.faces[faces] + moved[owner][:, None],
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
    """A copy of values as an array of the given type and shape (-1: any length).

    Raises `InputError` for other shapes.
    """
    try:
        array = np.array(values)
        if array.dtype.kind not in "biuf" or (kind is np.int64 and array.dtype.kind not in "iu"):
            raise ValueError
        array = array.astype(kind)
    except ValueError:
        hint = "give integers" if kind is np.int64 else "give numbers"
        raise InputError(f"{what} is {values!r:.60}", hint=hint) from None
    fits = len(array.shape) == len(shape)
    if not fits or any(n not in (-1, m) for n, m in zip(shape, array.shape, strict=True)):
        wanted = " x ".join("n" if n == -1 else str(n) for n in shape)
        raise InputError(f"{what} has shape {array.shape}", hint=f"give {wanted}")
    return array


def _require_starts(start: Index, what: str, runs: int | None, rows: int) -> None:
    """Verify that `start` divides `rows` rows into runs without an empty run.

    Raises `InputError` if it does not; `what` is the name of the array for the message.
    """
    valid = len(start) > 1 and start[0] == 0 and start[-1] == rows and (np.diff(start) > 0).all()
    if not valid or (runs is not None and len(start) != runs + 1):
        raise InputError(
            f"{what} does not divide {rows} rows" + ("" if runs is None else f" into {runs}"),
            hint="give the first row of each run, rising from 0, and the number of all rows",
        )
