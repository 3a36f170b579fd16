"""Solids of OCCT in memory: shapes, compounds and assemblies of build123d and CadQuery.

Their faces are exact, as those of a STEP file, and are read by the same functions. Parts are named
by the labels (build123d) or names (CadQuery) of the tree, by the shortest end of the path that
tells them apart. Both libraries count in millimetres.
"""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

from kilter.assembly import Assembly
from kilter.errors import InputError
from kilter.files.choices import Choices
from kilter.files.formats import assembly_of
from kilter.files.occt import failures, quiet, shape_map
from kilter.files.step_bodies import bodies_of
from kilter.files.step_document import FoundSolid, StepDocument, numbered, occurrences, split

__all__ = ["read"]

_NAMELESS = "part"
_UUID = re.compile(r"[0-9a-f]{8}(-[0-9a-f]{4}){3}-[0-9a-f]{12}")
"""What CadQuery names an assembly that nobody named."""
_HINT = "give a solid, a compound of solids, or an assembly of them"


def read(value: Any, choices: Choices) -> Assembly:
    """The assembly of a shape, a compound, a Workplane, a BuildPart or an assembly.

    Raises
    ------
    InputError
        If it holds no solid.
    """
    from OCP.TopLoc import TopLoc_Location

    walk = _Tree()
    try:
        with quiet():
            walk.below([_built(value)], (), TopLoc_Location())
            solids = occurrences(walk.found, shape_map())
            document = StepDocument(tuple(solids), "mm", tuple(walk.passed), ())
            bodies = bodies_of(document, (), lambda stage, solid: None)
    except failures():
        raise InputError("no solid can be made of it", hint=_HINT) from None
    return assembly_of(replace(bodies, by_standard=True), units=choices.units)


class _Tree:
    """Goes down the tree of an assembly; keeps the solids that it meets, and what else."""

    def __init__(self) -> None:
        self.found: list[FoundSolid] = []
        self.passed: list[str] = []
        self.copies = shape_map()
        self.copied: dict[int, Any] = {}

    def below(self, values: list[Any], above: tuple[str, ...], place: Any) -> None:
        """The solids below neighbours, each where `place` puts it."""
        names = numbered([_name(value) or _NAMELESS for value in values])
        for name, value in zip(names, values, strict=True):
            path = (*above, name)
            children = list(getattr(value, "children", ()))
            where = place.Multiplied(_location(value))
            if children:
                inner = () if not above and len(values) == 1 else path
                own = _shapes(value) if hasattr(value, "loc") else []
                self._leaf(own, path, where)
                self.below(children, inner, where)
            else:
                at = where if hasattr(value, "loc") else place
                self._leaf(_shapes(value), path, at)

    def _leaf(self, shapes: list[Any], path: tuple[str, ...], place: Any) -> None:
        from OCP.TopLoc import TopLoc_Location

        solids, rest = [], []
        for shape in shapes:
            inner, beside = split(shape)
            solids += inner
            rest += [beside] if beside else []
        if rest:
            self.passed.append(f"{'/'.join(path)!r} ({', '.join(rest)})")
        for name, solid in zip(numbered([path[-1]] * len(solids)), solids, strict=True):
            bare = self._copy(solid.Located(TopLoc_Location()))
            at = place.Multiplied(solid.Location())
            self.found.append(FoundSolid((*path[:-1], name), bare, at, False))

    def _copy(self, shape: Any) -> Any:
        """A copy of a solid, the same for the same: its triangles are not those of the owner."""
        from OCP.BRepBuilderAPI import BRepBuilderAPI_Copy

        key = self.copies.Add(shape)
        if key not in self.copied:
            self.copied[key] = BRepBuilderAPI_Copy(shape).Shape()
        return self.copied[key]


def _built(value: Any) -> Any:
    """What a builder of build123d has made."""
    part = getattr(value, "part", None)
    return value if part is None or hasattr(value, "wrapped") else part


def _name(value: Any) -> str:
    name = str(getattr(value, "name", None) or getattr(value, "label", None) or "").strip()
    return "" if _UUID.fullmatch(name) else name


def _location(value: Any) -> Any:
    """Where an assembly is: its `loc` (CadQuery), or the location of its shape (build123d)."""
    from OCP.TopLoc import TopLoc_Location

    if hasattr(value, "loc"):
        return value.loc.wrapped
    wrapped = getattr(value, "wrapped", None)
    return TopLoc_Location() if wrapped is None else wrapped.Location()


def _shapes(value: Any) -> list[Any]:
    """Shapes of OCCT that an object holds: itself, its stack, its own of an assembly."""
    if getattr(value, "obj", None) is not None and not hasattr(value, "wrapped"):
        return _shapes(value.obj)
    if hasattr(value, "vals"):
        return [shape for one in value.vals() for shape in _shapes(one)]
    wrapped = getattr(value, "wrapped", value)
    if wrapped is None or not hasattr(wrapped, "ShapeType"):
        return []
    return [wrapped]
