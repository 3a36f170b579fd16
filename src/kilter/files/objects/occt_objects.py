"""Read OCCT shapes in memory: shapes, compounds and assemblies of build123d and CadQuery.

The functions for STEP files read them, with exact faces. Part names come from the labels
(build123d) or names (CadQuery) of the tree: the shortest end of the path that is unique. Both
libraries use millimetres.
"""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

from kilter.assembly import Assembly
from kilter.errors import InputError
from kilter.files.cad.product_tree import (
    StepDocument,
    TreeSolid,
    number_repeats,
    occurrences,
    split,
)
from kilter.files.cad.step_document import bodies_of
from kilter.files.cad.step_surfaces import failures, quiet, shape_map
from kilter.files.format_options import FormatOptions
from kilter.files.formats import assembly_of

_NAMELESS = "part"
_UUID = re.compile(r"[0-9a-f]{8}(-[0-9a-f]{4}){3}-[0-9a-f]{12}")
"""The name that CadQuery gives to an assembly without a name."""
_HINT = "give a solid, a compound of solids, or an assembly of them"


def read(value: Any, choices: FormatOptions) -> Assembly:
    """Convert a build123d, CadQuery or OCCT shape or assembly to a kilter assembly.

    Raises
    ------
    InputError
        If the object has no solid.
    """
    from OCP.TopLoc import TopLoc_Location

    walk = _ObjectWalk()
    try:
        with quiet():
            walk.below([_unwrap_builder(value)], (), TopLoc_Location())
            solids = occurrences(walk.solids, shape_map())
            document = StepDocument(tuple(solids), "mm", tuple(walk.passed))
            bodies = bodies_of(document, (), lambda stage, solid: None)
    except failures():
        raise InputError("it has no valid solid", hint=_HINT) from None
    return assembly_of(replace(bodies, by_standard=True), units=choices.units)


class _ObjectWalk:
    """A traversal of a CAD assembly that collects its solids, and describes other shapes."""

    def __init__(self) -> None:
        self.solids: list[TreeSolid] = []
        self.passed: list[str] = []
        self.copies = shape_map()
        self.copied: dict[int, Any] = {}

    def below(self, values: list[Any], above: tuple[str, ...], place: Any) -> None:
        """Collect the solids of objects and their children, relative to the location `place`."""
        names = number_repeats([_name(value) or _NAMELESS for value in values])
        for name, value in zip(names, values, strict=True):
            path = (*above, name)
            children = list(getattr(value, "children", ()))
            location = place.Multiplied(_location(value))
            if children:
                inner = () if not above and len(values) == 1 else path
                shapes = _shapes(value) if hasattr(value, "loc") else []
                self._leaf(shapes, path, location)
                self.below(children, inner, location)
            else:
                at = location if hasattr(value, "loc") else place
                self._leaf(_shapes(value), path, at)

    def _leaf(self, shapes: list[Any], path: tuple[str, ...], place: Any) -> None:
        """Collect the solids among the shapes of a single object."""
        from OCP.TopLoc import TopLoc_Location

        solids, rest = [], []
        for shape in shapes:
            inner, beside = split(shape)
            solids += inner
            rest += [beside] if beside else []
        if rest:
            self.passed.append(f"{'/'.join(path)!r} ({', '.join(rest)})")
        for name, solid in zip(number_repeats([path[-1]] * len(solids)), solids, strict=True):
            bare = self._copy(solid.Located(TopLoc_Location()))
            at = place.Multiplied(solid.Location())
            self.solids.append(TreeSolid((*path[:-1], name), bare, at, False))

    def _copy(self, shape: Any) -> Any:
        """A cached copy of a solid, so that the caller's solid stays unchanged."""
        from OCP.BRepBuilderAPI import BRepBuilderAPI_Copy

        key = self.copies.Add(shape)
        if key not in self.copied:
            self.copied[key] = BRepBuilderAPI_Copy(shape).Shape()
        return self.copied[key]


def _unwrap_builder(value: Any) -> Any:
    """The part that a build123d builder has made; other values unchanged."""
    part = getattr(value, "part", None)
    return value if part is None or hasattr(value, "wrapped") else part


def _name(value: Any) -> str:
    """The name or label of a CAD object; empty if it has none."""
    name = str(getattr(value, "name", None) or getattr(value, "label", None) or "").strip()
    return "" if _UUID.fullmatch(name) else name


def _location(value: Any) -> Any:
    """The location of a CAD object relative to its parent."""
    from OCP.TopLoc import TopLoc_Location

    if hasattr(value, "loc"):
        return value.loc.wrapped
    wrapped = getattr(value, "wrapped", None)
    return TopLoc_Location() if wrapped is None else wrapped.Location()


def _shapes(value: Any) -> list[Any]:
    """The OCCT shapes of a CadQuery or build123d object."""
    if getattr(value, "obj", None) is not None and not hasattr(value, "wrapped"):
        return _shapes(value.obj)
    if hasattr(value, "vals"):
        return [shape for item in value.vals() for shape in _shapes(item)]
    wrapped = getattr(value, "wrapped", value)
    if wrapped is None or not hasattr(wrapped, "ShapeType"):
        return []
    return [wrapped]
