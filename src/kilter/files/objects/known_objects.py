"""Which reader an object of another library has, by the module that its class is from.

    a new library:  a module here with ``read(value, choices) -> Assembly``, and its name in `HOMES`

Nothing is imported for an object that is not of its library, and the library itself is there
already: its object is. Several objects are given as a list, or by name as a mapping.
"""

from __future__ import annotations

import importlib
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from kilter.assembly import Assembly, Part
from kilter.errors import InputError
from kilter.files.choices import Choices
from kilter.files.formats import assembly_of
from kilter.files.naming import distinct
from kilter.files.placed import FileBodies
from kilter.shape.primitives import Mesh

__all__ = ["HOMES", "TAKEN", "assembly_of_object", "read_object"]

HOMES = {
    "trimesh": "trimesh_objects",
    "compas": "compas_objects",
    "compas_assembly": "compas_objects",
    "build123d": "occt_objects",
    "cadquery": "occt_objects",
    "OCP": "occt_objects",
    "mujoco": "mujoco_objects",
}
"""The module here that reads the classes of a library."""
TAKEN = (
    "a path, (vertices, faces), an object of trimesh, build123d, CadQuery, compas or mujoco, a "
    "list of such, or a dict of them by name"
)
"""What is taken, in words."""


_SCENES = "mujoco_objects"
_NAMELESS = ("part", "0")
"""Names of what has none: of a body alone, of a mesh of COMPAS alone."""


def read_object(value: Any, choices: Choices) -> tuple[Assembly, bool]:
    """The assembly of an object as of `assembly_of_object`, and if it says where gravity points."""
    told = isinstance(value, Assembly) or _home(value) == _SCENES
    return assembly_of_object(value, choices), told


def assembly_of_object(value: Any, choices: Choices | None = None) -> Assembly:
    """The assembly that an object of another library is.

    Parameters
    ----------
    value : object
        An assembly, a mesh, a solid; a pair of arrays (vertices, faces); a list of such; a dict
        of them, whose keys are the names of the parts.
    choices : Choices, optional
        What is chosen where the object leaves it open, its units first.

    Raises
    ------
    InputError
        If it is nothing of that; it says what is taken.

    Examples
    --------
    >>> cube = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1.0)])
    >>> quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    >>> assembly_of_object({"low": (cube, quads), "high": (cube + [0, 0, 1], quads)}, Choices("mm"))
    <Assembly: 2 parts, 0 held, in mm>
    >>> assembly_of_object(3)
    Traceback (most recent call last):
    ...
    kilter.errors.InputError: an assembly cannot be made of int; give a path, (vertices, ...
    """
    if isinstance(value, Assembly):
        return value
    choices = choices or Choices()
    home = _home(value)
    if home is not None:
        reader = importlib.import_module(f"kilter.files.objects.{home}")
        found: Assembly = reader.read(value, choices)
        return found
    if _is_surface(value):
        return _mesh(value[0], value[1], choices)
    if hasattr(value, "vertices") and hasattr(value, "faces"):
        return _mesh(value.vertices, value.faces, choices)
    if isinstance(value, Mapping) and value:
        return _several(value, choices)
    if isinstance(value, Sequence) and not isinstance(value, str | bytes) and value:
        return _several(dict(enumerate(value)), choices)
    raise InputError(f"an assembly cannot be made of {type(value).__name__}", hint=f"give {TAKEN}")


def _home(value: Any) -> str | None:
    """The reader of a class, or of the nearest class that it derives from."""
    if isinstance(value, tuple) and value and _home(value[0]) == _SCENES:
        return _SCENES  # a model and its data
    packages = (str(kind.__module__).partition(".")[0] for kind in type(value).__mro__)
    return next((HOMES[package] for package in packages if package in HOMES), None)


def _is_surface(value: Any) -> bool:
    """A pair of arrays: corners, and faces that name them by position."""
    if not isinstance(value, tuple | list) or len(value) != 2:
        return False
    try:
        corners = np.asarray(value[0], dtype=np.float64)
    except (TypeError, ValueError):
        return False
    return corners.ndim == 2 and corners.shape[1] == 3


def _mesh(vertices: Any, faces: Any, choices: Choices) -> Assembly:
    found = Mesh(np.asarray(vertices), faces if isinstance(faces, np.ndarray) else list(faces))
    return assembly_of(FileBodies((None,), (found,)), units=choices.units)


def _several(values: Mapping[Any, Any], choices: Choices) -> Assembly:
    """Objects side by side; one that is a single part has the name that it is given by."""
    numbered = all(isinstance(key, int) for key in values)
    parts: list[Part] = []
    names: list[str] = []
    notes: list[str] = []
    kept: str | None = None
    for key, value in values.items():
        name = f"part_{key + 1}" if numbered else str(key)
        try:
            found = _bare(assembly_of_object(value, choices))
        except InputError as error:
            raise error.located(part=name) from None
        if kept not in (None, found.units):
            raise InputError(
                f"is in {found.units}, those before it in {kept}",
                part=name,
                hint="bring them to one unit",
            )
        kept = found.units
        own = [part.name for part in found.parts]
        if numbered:
            names += [name if one in _NAMELESS else one for one in own]
        else:
            names += [name] if len(own) == 1 else [f"{name}/{one}" for one in own]
        parts += found.parts
        notes += found.notes
    named = zip(distinct(names), parts, strict=True)
    return Assembly(
        [replace(part, name=name) for name, part in named], units=kept or "m", notes=notes
    )


def _bare(found: Assembly) -> Assembly:
    """Refuse what is more than its parts: joints and contacts name parts of their own."""
    if found.joints or found.contacts or found.loads or found.friction_pairs:
        raise InputError(
            "it has joints, contacts, loads or friction of its own", hint="load it by itself"
        )
    return found
