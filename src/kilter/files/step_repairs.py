"""Repairs of a damaged shape; the checks of the reader decide whether a repair is right.

`sewn_shape` closes shells whose edges are not shared. `with_other_sides` corrects spherical faces.
The outline of such a face divides the sphere into two regions, and its sense selects a region. If a
file contradicts itself there, OCCT may take the other region: its area is 4 pi r^2 minus the right
area, and it lies on other faces of the same sphere.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from kilter.files.file_tolerances import OTHER_SIDE, SEWN
from kilter.files.occt import inside
from kilter.files.step_faces import size_of

__all__ = ["sewn_shape", "with_other_sides"]


def sewn_shape(shape: Any) -> Any:
    """The shape with its faces sewn to a single shell by OCCT; None if that fails."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_Sewing
    from OCP.ShapeFix import ShapeFix_Shape, ShapeFix_Solid
    from OCP.TopAbs import TopAbs_ShapeEnum
    from OCP.TopoDS import TopoDS

    fixed = ShapeFix_Shape(shape)
    fixed.Perform()
    sewing = BRepBuilderAPI_Sewing(SEWN * size_of(shape))
    sewing.Add(fixed.Shape())
    sewing.Perform()
    shells = list(inside(sewing.SewedShape(), TopAbs_ShapeEnum.TopAbs_SHELL))
    if len(shells) != 1:
        return None
    return ShapeFix_Solid().SolidFromShell(TopoDS.Shell(shells[0]))


def with_other_sides(shape: Any) -> Any:
    """The shape with too large spherical faces replaced by their complements; None without any.

    A face is too large if it has more than half of its sphere.

    Whether the result is right is decided by the checks of the reader.
    """
    from OCP.BRepTools import BRepTools_ReShape
    from OCP.TopAbs import TopAbs_ShapeEnum
    from OCP.TopoDS import TopoDS

    change, count = BRepTools_ReShape(), 0
    for face in map(TopoDS.Face, inside(shape, TopAbs_ShapeEnum.TopAbs_FACE)):
        other = _other_side(face)
        if other is not None:
            change.Replace(face, other)
            count += 1
    return change.Apply(shape) if count else None


def _other_side(face: Any) -> Any:
    """The complement on the sphere of a face with more than half of it; None for other faces."""
    from OCP.BRepAdaptor import BRepAdaptor_Surface
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
    from OCP.Geom import Geom_SphericalSurface
    from OCP.GeomAbs import GeomAbs_SurfaceType
    from OCP.ShapeFix import ShapeFix_Face
    from OCP.TopoDS import TopoDS

    adaptor = BRepAdaptor_Surface(face)
    if adaptor.GetType() != GeomAbs_SurfaceType.GeomAbs_Sphere:
        return None
    sphere = adaptor.Sphere()
    whole, area = 4.0 * np.pi * sphere.Radius() ** 2, _area(face)
    outline = _outline(face)
    if outline is None or area < whole / 2.0:
        return None
    surface = Geom_SphericalSurface(sphere.Position(), sphere.Radius())
    # OCCT draws the edges in the parameters of the new surface at the first call, and keeps them
    for wire in (outline, TopoDS.Wire(outline.Reversed())):
        made = BRepBuilderAPI_MakeFace(surface, wire, False)
        if not made.IsDone():
            return None
        fix = ShapeFix_Face(made.Face())
        fix.Perform()
        other = fix.Face()
        if abs(_area(other) - (whole - area)) <= OTHER_SIDE * whole:
            return other.Oriented(face.Orientation()).Reversed()
    return None


def _outline(face: Any) -> Any:
    """The outer boundary of a face as a wire without seams; None if it is not a single wire."""
    from OCP.BRep import BRep_Tool
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeWire
    from OCP.TopAbs import TopAbs_ShapeEnum
    from OCP.TopoDS import TopoDS

    wires = list(inside(face, TopAbs_ShapeEnum.TopAbs_WIRE))
    edges = map(TopoDS.Edge, inside(face, TopAbs_ShapeEnum.TopAbs_EDGE))
    wire = BRepBuilderAPI_MakeWire()
    for edge in edges:
        if not (BRep_Tool.Degenerated_s(edge) or BRep_Tool.IsClosed_s(edge, face)):
            wire.Add(edge)
    return wire.Wire() if len(wires) == 1 and wire.IsDone() else None


def _area(shape: Any) -> float:
    """Area of the faces of a shape [length unit^2]."""
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps

    properties = GProp_GProps()
    BRepGProp.SurfaceProperties_s(shape, properties, OTHER_SIDE**2)
    return abs(float(properties.Mass()))
