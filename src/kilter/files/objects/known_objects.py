"""Read objects of other libraries; the module of the object's class selects the reader.

    a new library:  a function ``read(value, choices) -> Assembly``, and its entry in `READERS`

A reader imports its library when it is called; the library is loaded already, since an object of
it exists. Several objects are given as a list, or as a mapping by name.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from kilter.assembly import Assembly, Part
from kilter.errors import InputError
from kilter.files.format_options import FormatOptions
from kilter.files.formats import assembly_of
from kilter.files.meshes.placed import FileBodies, distinct
from kilter.files.objects import compas_objects, mujoco_objects, occt_objects, trimesh_objects
from kilter.shape.primitives import Mesh

Reader = Callable[[Any, FormatOptions], Assembly]

READERS: dict[str, Reader] = {
    "trimesh": trimesh_objects.read,
    "compas": compas_objects.read,
    "compas_assembly": compas_objects.read,
    "compas_dem": compas_objects.read,
    "build123d": occt_objects.read,
    "cadquery": occt_objects.read,
    "OCP": occt_objects.read,
    "mujoco": mujoco_objects.read,
}
"""Reader of the objects of each library, by the name of its package."""
TAKEN = (
    "a path, (vertices, faces), an object of trimesh, build123d, CadQuery, compas or mujoco, a "
    "list of these, or a dict of them by name"
)
"""The accepted kinds of values, for messages."""


_NAMELESS = ("part", "0")
"""Names that readers give to an object without a name: a single body, a single COMPAS mesh."""


def read_object(value: Any, choices: FormatOptions) -> tuple[Assembly, bool]:
    """Convert an object of another library; also return whether its gravity direction is fixed.

    Returns `states_gravity`: whether the object fixes the direction of gravity.
    """
    states_gravity = isinstance(value, Assembly) or _reader(value) is mujoco_objects.read
    return assembly_of_object(value, choices), states_gravity


def assembly_of_object(value: Any, choices: FormatOptions | None = None) -> Assembly:
    """Convert an object of another library to an assembly.

    Arguments: `value`: an assembly, a mesh, a solid; a pair of arrays (vertices, faces); a list of
    these; a dict of them, whose keys are the names of the parts. Raises `InputError` if the type of
    the object is not supported; the error lists the supported types.

    Examples
    --------
    >>> cube = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1.0)])
    >>> quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    >>> meshes = {"low": (cube, quads), "high": (cube + [0, 0, 1], quads)}
    >>> assembly_of_object(meshes, FormatOptions("mm"))
    <Assembly: 2 parts, 0 held, in mm>
    >>> assembly_of_object(3)
    Traceback (most recent call last):
    ...
    kilter.errors.InputError: an assembly cannot be made of int; give a path, (vertices, ...
    """
    if isinstance(value, Assembly):
        return value
    choices = choices or FormatOptions()
    reader = _reader(value)
    if reader is not None:
        return reader(value, choices)
    if _is_surface(value):
        return _mesh(value[0], value[1], choices)
    if hasattr(value, "vertices") and hasattr(value, "faces"):
        return _mesh(value.vertices, value.faces, choices)
    if isinstance(value, Mapping) and value:
        return _several(value, choices)
    if isinstance(value, Sequence) and not isinstance(value, str | bytes) and value:
        return _several(dict(enumerate(value)), choices)
    raise InputError(f"an assembly cannot be made of {type(value).__name__}", hint=f"give {TAKEN}")


def _reader(value: Any) -> Reader | None:
    """The function that reads objects of a value's class; None for an unknown class."""
    if isinstance(value, tuple) and value and _reader(value[0]) is mujoco_objects.read:
        return mujoco_objects.read  # a pair (MjModel, MjData)
    packages = (str(kind.__module__).partition(".")[0] for kind in type(value).__mro__)
    return next((READERS[package] for package in packages if package in READERS), None)


def _is_surface(value: Any) -> bool:
    """Whether a value is a pair (vertices, faces) whose vertices are an (n, 3) array."""
    if not isinstance(value, tuple | list) or len(value) != 2:
        return False
    try:
        corners = np.asarray(value[0], dtype=np.float64)
    except (TypeError, ValueError):
        return False
    return corners.ndim == 2 and corners.shape[1] == 3


def _mesh(vertices: Any, faces: Any, choices: FormatOptions) -> Assembly:
    """Build an assembly of a single mesh without a name."""
    mesh = Mesh(np.asarray(vertices), faces if isinstance(faces, np.ndarray) else list(faces))
    return assembly_of(FileBodies((None,), (mesh,)), units=choices.units)


def _several(values: Mapping[Any, Any], choices: FormatOptions) -> Assembly:
    """Build an assembly of several objects; keys name objects that have a single part."""
    numbered = all(isinstance(key, int) for key in values)
    parts: list[Part] = []
    names: list[str] = []
    notes: list[str] = []
    units: str | None = None
    for key, value in values.items():
        name = f"part_{key + 1}" if numbered else str(key)
        try:
            assembly = _require_parts_only(assembly_of_object(value, choices))
        except InputError as error:
            raise error.located(part=name) from None
        if units not in (None, assembly.units):
            raise InputError(
                f"it is in {assembly.units}, the objects before it in {units}",
                part=name,
                hint="convert them to the same unit",
            )
        units = assembly.units
        inner = [part.name for part in assembly.parts]
        if numbered:
            names += [name if label in _NAMELESS else label for label in inner]
        else:
            names += [name] if len(inner) == 1 else [f"{name}/{label}" for label in inner]
        parts += assembly.parts
        notes += assembly.notes
    named = zip(distinct(names), parts, strict=True)
    return Assembly(
        [replace(part, name=name) for name, part in named], units=units or "m", notes=notes
    )


def _require_parts_only(assembly: Assembly) -> Assembly:
    """Return the assembly; raise `InputError` if it has joints, contacts or other entries.

    These entries name parts, whose names may change when several objects are combined.
    """
    if assembly.joints or assembly.contacts or assembly.loads or assembly.friction_pairs:
        raise InputError(
            "it has joints, contacts, loads or friction pairs", hint="load it separately"
        )
    return assembly
