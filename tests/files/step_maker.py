"""Write STEP files with OCCT, without output."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("OCP")

from OCP.BRepBuilderAPI import BRepBuilderAPI_NurbsConvert, BRepBuilderAPI_Transform
from OCP.gp import gp_Quaternion, gp_Trsf, gp_Vec
from OCP.Interface import Interface_Static
from OCP.Quantity import Quantity_Color, Quantity_TypeOfColor
from OCP.STEPCAFControl import STEPCAFControl_Writer
from OCP.STEPControl import STEPControl_StepModelType
from OCP.TCollection import TCollection_ExtendedString, TCollection_HAsciiString
from OCP.TDataStd import TDataStd_Name
from OCP.TDF import TDF_Label
from OCP.TDocStd import TDocStd_Document
from OCP.TopLoc import TopLoc_Location
from OCP.XCAFDoc import XCAFDoc_ColorType, XCAFDoc_DocumentTool

from kilter.files.cad.step_surfaces import quiet
from kilter.units import metres_per_unit

# (name, shape or list of shapes, placement or None)
Node = tuple[str, Any, Any]


def placement(
    position: Sequence[float] = (0, 0, 0), rotation: Sequence[float] = (1, 0, 0, 0)
) -> Any:
    move = gp_Trsf()
    w, x, y, z = rotation
    move.SetRotation(gp_Quaternion(x, y, z, w))
    move.SetTranslationPart(gp_Vec(*position))
    return move


def as_splines(shape: Any) -> Any:
    """The shape with every face stored as a B-spline."""
    return BRepBuilderAPI_NurbsConvert(shape, True).Shape()


def compound(shapes: Sequence[Any]) -> Any:
    from OCP.BRep import BRep_Builder
    from OCP.TopoDS import TopoDS_Compound

    made, builder = TopoDS_Compound(), BRep_Builder()
    builder.MakeCompound(made)
    for shape in shapes:
        builder.Add(made, shape)
    return made


def moved(shape: Any, move: Any) -> Any:
    return BRepBuilderAPI_Transform(shape, move, True).Shape()


def write_step(
    path: Path,
    roots: Sequence[Node],
    units: str = "mm",
    apart: str = "",
    *,
    colors: Mapping[str, tuple[float, float, float]] | None = None,
    densities: Mapping[str, float] | None = None,
    layers: Mapping[str, str] | None = None,
    hidden_layers: Sequence[str] = (),
    hidden: Sequence[str] = (),
) -> Path:
    """Write a STEP file; equal shape objects are shared products. `apart`: prefix of part files.

    `colors` (linear red, green and blue) and `densities` (g/cm^3) are those of named products,
    as are `layers` and `hidden`.
    """
    document = TDocStd_Document(TCollection_ExtendedString("MDTV-XCAF"))
    XCAFDoc_DocumentTool.SetLengthUnit_s(document, metres_per_unit(units))
    tool = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    color_tool = XCAFDoc_DocumentTool.ColorTool_s(document.Main())
    material_tool = XCAFDoc_DocumentTool.MaterialTool_s(document.Main())
    layer_tool = XCAFDoc_DocumentTool.LayerTool_s(document.Main())
    known: dict[int, Any] = {}

    def label(node: Node) -> Any:
        name, content, _ = node
        if id(content) in known:
            return known[id(content)]
        if isinstance(content, list):
            made = tool.NewShape()
            for child in content:
                move = TopLoc_Location(child[2]) if child[2] is not None else TopLoc_Location()
                tool.AddComponent(made, label(child), move)
        else:
            made = tool.AddShape(content, False)
        TDataStd_Name.Set_s(made, TCollection_ExtendedString(name, True))
        if name in (colors or {}):
            color = Quantity_Color(*colors[name], Quantity_TypeOfColor.Quantity_TOC_RGB)
            color_tool.SetColor(made, color, XCAFDoc_ColorType.XCAFDoc_ColorSurf)
        if name in hidden:
            color_tool.SetVisibility(made, False)
        if layers is not None and name in layers:
            layer_tool.SetLayer(made, TCollection_ExtendedString(layers[name], True), False)
        if name in (densities or {}):
            words = (f"material of {name}", "", "density measure", "POSITIVE_RATIO_MEASURE")
            title, about, measure, kind = (TCollection_HAsciiString(word) for word in words)
            material_tool.SetMaterial(made, title, about, densities[name], measure, kind)
        known[id(content)] = made
        return made

    with quiet():
        STEPCAFControl_Writer()  # creates the setting that the next line changes
        Interface_Static.SetCVal_s("write.step.unit", {"in": "INCH"}.get(units, units.upper()))
        for root in roots:
            label(root)
        tool.UpdateAssemblies()
        for layer in hidden_layers:
            found = TDF_Label()
            assert layer_tool.FindLayer(TCollection_ExtendedString(layer, True), found)
            layer_tool.SetVisibility(found, False)
        writer = STEPCAFControl_Writer()
        writer.SetNameMode(True)
        writer.SetColorMode(True)
        writer.SetMaterialMode(True)
        writer.SetLayerMode(True)
        kind = STEPControl_StepModelType.STEPControl_AsIs
        done = writer.Transfer(document, kind, apart) if apart else writer.Transfer(document, kind)
        assert done
        writer.Write(str(path))
    return path
