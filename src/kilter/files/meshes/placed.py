"""Bodies of a file, and how to place, scale and join their meshes together with their accuracy."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from kilter.arrays import Array
from kilter.assembly.interactions import Joint
from kilter.assembly.part import GROUND
from kilter.rigid import Pose
from kilter.shape.primitives import Mesh
from kilter.shape.solid import Solid, scale_solid
from kilter.units import metres_per_unit

# Estimate the error of the coordinates in a text file [length unit].


SINGLE = 2.0**-24
"""Relative rounding error of float32 [-]."""
FEWEST, MOST = 5, 9
"""Numbers of decimals that count as rounded; fewer decimals are exact, more are float64."""
SAMPLE = 10_000
"""Largest number of values with an exponent that are examined; more take longer."""


def text_accuracy(values: ArrayLike, *, exponent: bool = False) -> Callable[[Array], float | None]:
    """Estimate how coarsely the numbers of a text file are rounded, from all its coordinates.

    Returns function from the coordinates of a mesh of the file to their largest error [length
    unit]; None for float64.

    Examples
    --------
    >>> import numpy as np
    >>> for values in ([0.25249999761581421, 1.0], [0.333333, 1], [0.5, 12.25], [1 / 3, 1]):
    ...     print(text_accuracy(values)(np.array(values)))
    5.960464477539063e-08
    5e-07
    None
    None
    """
    finite: Array = np.array(values, dtype=np.float64).reshape(-1)
    finite = finite[np.isfinite(finite)]
    with np.errstate(over="ignore"):
        single = bool((finite.astype(np.float32) == finite).all())
    if single and not _is_rounded(finite, MOST):
        return lambda coordinates: SINGLE * float(np.abs(coordinates).max(initial=0.0))
    step = _mantissa_step(finite) if exponent else _decimal_step(finite)
    return lambda coordinates: step


def _decimal_step(values: Array) -> float | None:
    """Half of the last printed decimal place; None if the values are exact decimals or float64."""
    if _is_rounded(values, FEWEST - 1):
        return None
    for k in range(FEWEST, MOST + 1):
        if _is_rounded(values, k):
            return float(0.5 * 10.0**-k)
    return None


def _mantissa_step(values: Array) -> float | None:
    """Half of the last printed digit of the largest number, for numbers like ``1.2346e+01``."""
    values = np.unique(values[values != 0])
    if not len(values):
        return None
    # the shortest digits that reproduce each number, for an evenly spread sample
    chosen = values[np.unique(np.linspace(0, len(values) - 1, SAMPLE).astype(int))]
    printed = [np.format_float_scientific(value, trim="-").split("e") for value in chosen]
    step = _decimal_step(np.array([float(mantissa) for mantissa, _ in printed]))
    return None if step is None else step * 10.0 ** max(int(power) for _, power in printed)


def _is_rounded(values: Array, k: int) -> bool:
    """Whether every value is a number of at most k decimal places, as nearly as float64 can be."""
    # a float64 above 2^53 / 10^k has no digits after the k-th place
    small = values[np.abs(values) < 2.0**53 / 10.0**k]
    return bool((np.round(small, k) == small).all())


# Names of parts: make them distinct, fill in missing names, sort them by their numbers.


def distinct(names: Sequence[str]) -> list[str]:
    """Make names distinct by appending a number to every repeated name.

    The name "ground" is reserved, so it always gets a number.

    Examples
    --------
    >>> distinct(["bolt", "nut", "bolt", "bolt"])
    ['bolt', 'nut', 'bolt_2', 'bolt_3']
    >>> distinct(["bolt", "bolt", "bolt_2"])  # a number that is in use is skipped
    ['bolt', 'bolt_3', 'bolt_2']
    >>> distinct(["ground", "bolt"])
    ['ground_2', 'bolt']
    """
    taken = set(names)
    count = Counter([GROUND])
    result = []
    for name in names:
        count[name] += 1
        label = name
        if count[name] > 1:
            while (label := f"{name}_{count[name]}") in taken:
                count[name] += 1
            taken.add(label)
        result.append(label)
    return result


def tails(paths: Sequence[tuple[str, ...]]) -> list[str]:
    """Shorten paths to their last components, as far as they stay distinct, joined by "/".

    Examples
    --------
    >>> tails([("left", "nut"), ("right", "nut"), ("right", "rod"), ("plate",), ("plate",)])
    ['left/nut', 'right/nut', 'rod', 'plate', 'plate']
    >>> tails([("a", "plate"), ("plate",)])  # a whole path is kept, although others end with it
    ['a/plate', 'plate']
    """
    unique = list(dict.fromkeys(paths))
    length = {path: len(path) for path in unique}
    # paths with the same last components form a group; longer ends divide it, until it has one path
    pending = dict.fromkeys(unique, 0)
    for count in range(1, max(map(len, unique), default=0) + 1):
        ends = {
            path: (group, path[-count]) for path, group in pending.items() if len(path) >= count
        }
        sizes = Counter(ends.values())
        groups = {end: k for k, end in enumerate(sizes)}
        length |= {path: count for path, end in ends.items() if sizes[end] == 1}
        pending = {path: groups[end] for path, end in ends.items() if sizes[end] > 1}
    return ["/".join(path[len(path) - length[path] :]) for path in paths]


def fill_names(names: Sequence[str | None], stem: str) -> list[str]:
    """Distinct names for all bodies; missing names are made from `stem`, the name of the file.

    Examples
    --------
    >>> fill_names([None], "plate"), fill_names([None, "nut", None], "plate")
    (['plate'], ['plate_1', 'nut', 'plate_3'])
    """
    if len(names) == 1:
        return [names[0] or stem]
    return distinct([name or f"{stem}_{k}" for k, name in enumerate(names, start=1)])


def natural_key(name: str) -> list[tuple[int, int, str]]:
    """Key for sorting names so that "part-10" follows "part-9".

    Examples
    --------
    >>> sorted(["part10", "part2", "b", "1"], key=natural_key)
    ['1', 'b', 'part2', 'part10']
    """
    pieces = re.split(r"([0-9]+)", name)
    # a number is compared by length, then by digits: int() rejects very long numbers
    key = [
        (0, len(p.lstrip("0")), p.lstrip("0")) if p.isdecimal() else (1, 0, p.casefold())
        for p in pieces
        if p
    ]
    return [*key, (2, 0, name)]


@dataclass(frozen=True, slots=True, eq=False)
class FileBodies:
    """Meshes or solids of a file with names and poses, in the file's own length unit."""

    names: tuple[str | None, ...]
    shapes: tuple[Mesh | Solid, ...]
    """Shapes in their own frames; instances of a shape are the same object."""
    poses: tuple[Pose, ...] = ()
    """Transforms from the frame of each shape to the frame of the file; empty if the frames are
    the same."""
    units: str | None = None
    """Length unit; None if the file states none."""
    by_standard: bool = False
    """Whether the unit is fixed by the standard of the format, and not stated in the file."""
    usual: str = "m"
    """Unit that a file by itself is assumed to have if it states none."""
    notes: tuple[str, ...] = ()
    left_out: tuple[str, ...] = ()
    """Names of the bodies that the options leave out."""
    densities: tuple[float | None, ...] = ()
    """Density that the file states for each body [kg/m^3]; empty if it states none."""
    colors: tuple[str | None, ...] = ()
    """Colour of each body ("#rrggbb"); empty if the file states none."""
    materials: tuple[str | None, ...] = ()
    layers: tuple[str | None, ...] = ()
    """Names of the material and of the layer of each body; empty if the file states none."""
    held: tuple[bool, ...] = ()
    """Whether the file holds each body; empty if it holds none."""
    joints: tuple[Joint, ...] = ()
    """Joints of bodies by their names, in the length unit of the file."""

    @property
    def places(self) -> tuple[Pose, ...]:
        """Pose of each shape in the frame of the file, also if `poses` is empty."""
        return self.poses or (Pose(),) * len(self.shapes)

    @property
    def stated(self) -> list[dict[str, Any]]:
        """Density, colour, material, layer and hold of each body: keyword arguments of `Part`."""
        none, free = (None,) * len(self.shapes), (False,) * len(self.shapes)
        columns = (self.densities, self.colors, self.materials, self.layers)
        keys = ("density", "color", "material", "layer", "grounded")
        rows = zip(*(column or none for column in columns), self.held or free, strict=True)
        return [dict(zip(keys, row, strict=True)) for row in rows]

    def in_units(self, units: str) -> list[tuple[Mesh | Solid, Pose]]:
        """Shapes and poses converted to the length unit `units`."""
        factor = metres_per_unit(self.units or units) / metres_per_unit(units)
        converted = {
            id(shape): scale_mesh(shape, factor)
            if isinstance(shape, Mesh)
            else scale_solid(shape, factor)
            for shape in self.shapes
        }
        return [
            (converted[id(shape)], Pose(pose.position * factor, pose.rotation))
            for shape, pose in zip(self.shapes, self.places, strict=True)
        ]


def transform_mesh(mesh: Mesh, matrix: Array) -> Mesh:
    """The mesh after a linear transform, given as a 4 x 4 matrix for column vectors.

    A reflection also reverses the triangles, so that their normals still point outwards.

    Examples
    --------
    >>> tip = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    >>> transform_mesh(tip, np.diag([-1.0, 1, 1, 1])).triangles
    array([[2, 1, 0]])
    """
    if np.array_equal(matrix, np.eye(4)):
        return mesh
    linear, step = matrix[:3, :3], matrix[:3, 3]
    triangles = mesh.triangles[:, ::-1] if np.linalg.det(linear) < 0 else mesh.triangles
    largest = np.abs(mesh.vertices).max(axis=0, initial=0.0)
    # the error of a sum of coordinates has the relative size of the error of its terms
    relative = mesh.accuracy / (float(largest.max()) or 1.0)
    accuracy = relative * float((np.abs(linear) @ largest + np.abs(step)).max())
    corners = mesh.vertices @ linear.T + step
    return Mesh(corners, triangles, accuracy=accuracy, pieces=mesh.pieces)


def scale_mesh(mesh: Mesh, factor: float) -> Mesh:
    """The mesh with every length multiplied by a factor."""
    if factor == 1.0:
        return mesh
    return Mesh(
        mesh.vertices * factor,
        mesh.triangles,
        accuracy=mesh.accuracy * factor,
        pieces=mesh.pieces,
    )


def join_meshes(meshes: Sequence[Mesh]) -> Mesh:
    """Join meshes to a single mesh, with the largest of their coordinate errors."""
    if len(meshes) == 1:
        return meshes[0]
    start = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)])
    return Mesh(
        np.concatenate([mesh.vertices for mesh in meshes]),
        np.concatenate([m.triangles + n for m, n in zip(meshes, start[:-1], strict=True)]),
        accuracy=max(mesh.accuracy for mesh in meshes),
    )
