"""Read the parts of a FreeCAD document with OCCT: solids, held parts, joints and notes.

Each solid of a shape is a part, as in a STEP file; the further steps are those of STEP.
"""

from __future__ import annotations

import io
from collections.abc import Callable, Collection, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from kilter.arrays import Array
from kilter.assembly.interactions import Joint
from kilter.errors import InputError, some, some_names
from kilter.files.cad.freecad_document import FreeCadDocument, FreeCadObject
from kilter.files.cad.freecad_joints import JointEnd, StatedJoints, stated_joints
from kilter.files.cad.freecad_tree import FreeCadTree, PlacedShape, relations
from kilter.files.cad.product_tree import (
    StepDocument,
    TreeSolid,
    number_repeats,
    occurrences,
    sewn_note,
    split,
)
from kilter.files.cad.sewn_solids import sewn_solids
from kilter.files.cad.step_document import bodies_of
from kilter.files.cad.step_statements import Stated
from kilter.files.cad.step_surfaces import failures, inside, quiet, shape_map
from kilter.files.file_tolerances import STRAIGHT_AXES
from kilter.files.meshes.placed import FileBodies
from kilter.files.reader_guard import ZIP_DAMAGE, reader_guard

_BREP = (b"DBRep_DrawableShape", b"CASCADE Topology")
"""Begins of the text of a shape."""
STORED = 1_000_000_000
"""Number of the first stored shape; a shape that crashes OCCT is left out. Solids have less."""


def freecad_bodies(
    path: Path,
    without: Sequence[str],
    tell: Callable[[str, int], None],
    broken: Collection[int] = (),
) -> FileBodies:
    """Read the parts of a FreeCAD document.

    The arguments are those of `step_bodies`. Raises `InputError` if the document is damaged, or has
    no solid with a volume.
    """
    tell("reading FreeCAD", -1)
    try:
        with quiet(), reader_guard(path, ZIP_DAMAGE):
            tree = FreeCadTree(FreeCadDocument(path))
            return _Bodies(tree, tell, broken).read(stated_joints(tree), without)
    except failures():
        raise InputError(
            "damaged FreeCAD document: OCCT rejects a shape", hint="save it again in FreeCAD"
        ) from None


class _Bodies:
    """The solids of the shapes that a document shows."""

    def __init__(
        self, tree: FreeCadTree, tell: Callable[[str, int], None], broken: Collection[int]
    ) -> None:
        self.tree = tree
        self.tell = tell
        self.broken = broken
        self.stored: dict[int, Any] = {}
        """Shape of each object in the frame of the object, by the identity of the object."""
        self.passed: list[str] = []
        self.damaged: list[str] = []
        self.sewn: list[str] = []
        """Sentences about faces that are sewn to solids."""

    def read(self, stated: StatedJoints, without: Sequence[str]) -> FileBodies:
        """Convert the shapes to bodies with held parts, joints and notes."""
        leaves: list[TreeSolid] = []
        rows: list[tuple[int, ...]] = []
        for placed in self.tree.shapes:
            solids = self._solids(placed)
            rows.append(tuple(range(len(leaves), len(leaves) + len(solids))))
            leaves += solids
        if not leaves:
            raise self._no_part()
        placed_solids = occurrences(leaves, shape_map())
        document = StepDocument(tuple(placed_solids), "mm", tuple(self.passed))
        bodies = bodies_of(document, without, self.tell, self.broken)
        names = [row.name for row in placed_solids]
        of_shape = {
            id(placed): [names[k] for k in row]
            for placed, row in zip(self.tree.shapes, rows, strict=True)
        }
        held = {name for key in stated.held for name in of_shape[key]}
        joints = self._joints(stated, of_shape)
        known = set(bodies.names)
        return replace(
            bodies,
            held=tuple(name in held for name in bodies.names),
            joints=tuple(joint for joint in joints if known.issuperset(joint.parts)),
            notes=(*self._notes(stated), *bodies.notes),
        )

    def _solids(self, placed: PlacedShape) -> list[TreeSolid]:
        """The solids of a placed shape."""
        from OCP.TopAbs import TopAbs_ShapeEnum
        from OCP.TopLoc import TopLoc_Location

        path, place = placed.place.path, placed.place
        shape = self._stored(placed.shape)
        if shape is None:
            return []
        solids, rest = split(shape)
        if not solids and (sewn := sewn_solids([shape])):
            faces = len(list(inside(shape, TopAbs_ShapeEnum.TopAbs_FACE)))
            self.sewn.append(sewn_note("/".join(path), faces, len(sewn)))
            solids = sewn
        elif rest:
            self.passed.append(f"{'/'.join(path)!r} ({rest})")
        stated = Stated(density=place.density, material=place.material, hidden=place.hidden)
        names = number_repeats([path[-1]] * len(solids))
        found = []
        for name, solid in zip(names, solids, strict=True):
            bare, at = solid.Located(TopLoc_Location()), solid.Location()
            matrix = place.matrix @ placed.inner
            if _is_similar(matrix):
                location = TopLoc_Location(_transform(matrix)).Multiplied(at)
            else:
                bare, location = _stretched(solid, matrix), TopLoc_Location()
            found.append(TreeSolid((*path[:-1], name), bare, location, False, stated))
        return found

    def _stored(self, item: FreeCadObject) -> Any:
        """The shape of an object without its location, which the placement states; None if damaged.

        Each shape is read once.
        """
        from OCP.BinTools import BinTools
        from OCP.BRep import BRep_Builder
        from OCP.BRepTools import BRepTools
        from OCP.TopLoc import TopLoc_Location
        from OCP.TopoDS import TopoDS_Shape

        key = id(item)
        if key not in self.stored:
            number = STORED + len(self.stored)
            self.tell(f"reading the shape of {item.label}", number)
            data, shape = item.document.content(item.shape_file), TopoDS_Shape()
            with suppress(*failures()):
                if number in self.broken:
                    pass
                elif any(begin in data[:200] for begin in _BREP):
                    BRepTools.Read_s(shape, io.BytesIO(data), BRep_Builder())
                elif item.shape_file.endswith(".bin"):
                    BinTools.Read_s(shape, io.BytesIO(data))
            if shape.IsNull():
                self.damaged.append(item.label)
            self.stored[key] = None if shape.IsNull() else shape.Located(TopLoc_Location())
        return self.stored[key]

    def _joints(self, stated: StatedJoints, of_shape: dict[int, list[str]]) -> list[Joint]:
        """The joints between named parts; joints of a part with itself are left out."""
        joints = []
        for joint in stated.joints:
            names = [self._part(end, of_shape[id(end.shape)]) for end in joint.ends]
            if names[0] is None or names[1] is None:
                stated.without_part.append(joint.label)
            elif names[0] != names[1]:
                joints.append(joint.between(names[0], names[1]))
        return joints

    def _part(self, end: JointEnd, names: list[str]) -> str | None:
        """Name of the solid that one side of a joint names; None if it is unknown."""
        from OCP.TopAbs import TopAbs_ShapeEnum
        from OCP.TopExp import TopExp

        if len(names) < 2:
            return names[0] if names else None
        shape, known = self._stored(end.shape.shape), shape_map()
        if end.sub_shape is None:
            return None
        word, number = end.sub_shape
        kind = getattr(TopAbs_ShapeEnum, f"TopAbs_{word.upper()}")
        TopExp.MapShapes_s(shape, kind, known)
        if not 0 < number <= known.Extent():
            return None
        part = known.FindKey(number)
        for name, solid in zip(names, split(shape)[0], strict=True):
            if any(each.IsSame(part) for each in inside(solid, kind)):
                return name
        return None

    def _notes(self, stated: StatedJoints) -> list[str]:
        """Notes on what the document states and what does not count."""
        tree = self.tree
        notes = self.sewn + [
            f"the linked document {file!r:.120} is absent: {some_names(labels, 8)} cannot be read"
            for file, labels in tree.missing.items()
        ]
        if self.damaged:
            notes.append(f"damaged shapes are left out: {some_names(self.damaged, 8)}")
        if tree.meshes:
            notes.append(f"meshes are left out: {some_names(tree.meshes, 8)}")
        if tree.sources:
            sources = list(dict.fromkeys(tree.sources))
            notes.append(f"shown only by links, so no parts themselves: {some_names(sources, 8)}")
        if stated.others:
            notes.append(f"joints of FreeCAD that do not count: {some(stated.others, 8)}")
        if stated.without_part:
            absent = some_names(stated.without_part, 8)
            notes.append(f"joints with an absent or unknown part do not count: {absent}")
        if stated.limited:
            notes.append(f"the limits of joints do not count: {some_names(stated.limited, 8)}")
        moved = [joint.label for joint in stated.joints if not joint.is_solved]
        if moved:
            notes.append(
                f"the assembly is not solved: the two frames of {some_names(moved, 8)} differ, and "
                "that of the first part counts"
            )
        count = relations(tree.document)
        if count:
            notes.append(
                f"constraints of A2plus are relations of faces and no joints: {count} do not count"
            )
        return notes

    def _no_part(self) -> InputError:
        """The error for a document without solids; it lists what else the document has."""
        why = "; ".join(self._notes(StatedJoints(set(), [], [], [], [])))
        what = f"no solid, only {some(self.passed)}" if self.passed else "no solid"
        return InputError(f"{what}; {why}" if why else what, hint="save it with its solids")


def _is_similar(matrix: Array) -> bool:
    """Whether a 4 x 4 matrix turns, scales alike in all directions and moves, or mirrors so."""
    square = matrix[:3, :3].T @ matrix[:3, :3]
    size = np.trace(square) / 3
    return bool(np.abs(square - size * np.eye(3)).max() <= STRAIGHT_AXES * size)


def _transform(matrix: Array) -> Any:
    """The OCCT transform of a 4 x 4 matrix that turns, scales alike and moves."""
    from OCP.gp import gp_Trsf

    move = gp_Trsf()
    move.SetValues(*matrix[:3].reshape(-1).tolist())
    return move


def _stretched(shape: Any, matrix: Array) -> Any:
    """A copy of a shape after a linear transform that scales differently along its axes."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_GTransform
    from OCP.gp import gp_GTrsf

    stretch = gp_GTrsf()
    for (row, column), value in np.ndenumerate(matrix[:3]):
        stretch.SetValue(row + 1, column + 1, float(value))
    return BRepBuilderAPI_GTransform(shape, stretch, True).Shape()
