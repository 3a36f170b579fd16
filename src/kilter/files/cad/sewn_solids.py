"""Sew separate faces and open shells to closed solids.

Programs with surfaces only, and many IGES files, write each face by itself. Faces whose edges agree
are sewn. A closed shell inside another one is a hollow of it, and a shell inside a hollow is matter
again. Shells that stay open are no solids.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from kilter.files.cad.step_faces import size_of
from kilter.files.cad.step_surfaces import failures, inside
from kilter.files.file_tolerances import SEWN


def sewn_solids(shapes: Iterable[Any]) -> list[Any]:
    """Closed solids to which all faces of the shapes sew; empty if a face stays outside of them."""
    from OCP.BRep import BRep_Tool
    from OCP.BRepBuilderAPI import BRepBuilderAPI_Sewing
    from OCP.ShapeFix import ShapeFix_Solid
    from OCP.TopAbs import TopAbs_ShapeEnum as Kind
    from OCP.TopoDS import TopoDS

    listed = list(shapes)
    try:
        sewing = BRepBuilderAPI_Sewing(SEWN * max(map(size_of, listed), default=0.0))
        for shape in listed:
            sewing.Add(shape)
        sewing.Perform()
        whole = sewing.SewedShape()
        if whole is None or whole.IsNull():
            return []
        shells = [TopoDS.Shell(shell) for shell in inside(whole, Kind.TopAbs_SHELL)]
        loose = list(inside(whole, Kind.TopAbs_FACE, Kind.TopAbs_SHELL))
        if loose or not all(BRep_Tool.IsClosed_s(shell) for shell in shells):
            return []
        return _with_hollows([ShapeFix_Solid().SolidFromShell(shell) for shell in shells])
    except failures():
        return []


def _with_hollows(solids: Sequence[Any]) -> list[Any]:
    """The outermost of the solids, each with the solids directly inside it as its hollows."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeSolid
    from OCP.TopAbs import TopAbs_ShapeEnum as Kind
    from OCP.TopoDS import TopoDS

    around = [
        {k for k, outer in enumerate(solids) if outer is not inner and _contains(outer, inner)}
        for inner in solids
    ]
    found = []
    for k, solid in enumerate(solids):
        if len(around[k]) % 2:
            continue
        maker = BRepBuilderAPI_MakeSolid(TopoDS.Solid(solid))
        for j, hollow in enumerate(solids):
            if around[j] == {*around[k], k}:
                for shell in inside(hollow, Kind.TopAbs_SHELL):
                    maker.Add(TopoDS.Shell(shell.Reversed()))
        found.append(maker.Solid())
    return found


def _contains(outer: Any, inner: Any) -> bool:
    """Whether a solid contains a vertex of another solid, whose shell does not cross its own."""
    from OCP.BRep import BRep_Tool
    from OCP.BRepClass3d import BRepClass3d_SolidClassifier
    from OCP.TopAbs import TopAbs_ShapeEnum, TopAbs_State
    from OCP.TopoDS import TopoDS

    for vertex in inside(inner, TopAbs_ShapeEnum.TopAbs_VERTEX):
        point = BRep_Tool.Pnt_s(TopoDS.Vertex(vertex))
        state = BRepClass3d_SolidClassifier(outer, point, SEWN * size_of(outer)).State()
        if state != TopAbs_State.TopAbs_ON:
            return bool(state == TopAbs_State.TopAbs_IN)
    return False
