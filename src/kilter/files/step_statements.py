"""Density and colour of each solid of a STEP document, as the file states them.

The colour of a solid is that of the solid, else of its product, else of most of its faces.
"""

from __future__ import annotations

from collections import Counter
from typing import Any, NamedTuple

from kilter.files.occt import inside

__all__ = ["UNSTATED", "Stated", "StepStatements"]


class Stated(NamedTuple):
    """Density [kg/m^3] and colour ("#rrggbb") of a solid; None if the file states none."""

    density: float | None = None
    color: str | None = None


UNSTATED = Stated()


class StepStatements:
    """Access to the densities and colours of a STEP document after its transfer to OCCT.

    Parameters
    ----------
    document : TDocStd_Document
    session : XSControl_WorkSession
    densities : dict of int to float
        Densities by the position of each solid among the entities of the file [kg/m^3].
    """

    def __init__(self, document: Any, session: Any, densities: dict[int, float]) -> None:
        from OCP.XCAFDoc import XCAFDoc_DocumentTool

        self._colors = XCAFDoc_DocumentTool.ColorTool_s(document.Main())
        self._transfer = session.TransferReader()
        # the bindings give an entity of OCCT one Python object as long as it is kept
        entities = self._transfer.Model()
        self._densities = [(entities.Value(k), value) for k, value in densities.items()]

    def about(self, solid: Any, product: Any) -> Stated:
        """Density and colour of a solid (TopoDS_Solid) of a product (TDF_Label)."""
        return Stated(self._density(solid), self._color(solid, product))

    def _density(self, solid: Any) -> float | None:
        """Density of a solid [kg/m^3]; None if the file states none."""
        if not self._densities:
            return None
        entity = self._transfer.EntityFromShapeResult(solid, -1)
        return next((value for known, value in self._densities if known is entity), None)

    def _color(self, solid: Any, product: Any) -> str | None:
        """Colour of a solid, of its product, or of most of its faces; None without a colour."""
        from OCP.TopAbs import TopAbs_ShapeEnum
        from OCP.XCAFDoc import XCAFDoc_ShapeTool

        own = self._color_of(solid) or self._color_of(XCAFDoc_ShapeTool.GetShape_s(product))
        if own is not None:
            return own
        faces = inside(solid, TopAbs_ShapeEnum.TopAbs_FACE)
        count = Counter(color for color in map(self._color_of, faces) if color is not None)
        return count.most_common(1)[0][0] if count else None

    def _color_of(self, shape: Any) -> str | None:
        """Colour of a shape; None if it has none of its own."""
        from OCP.Quantity import Quantity_Color, Quantity_TypeOfColor
        from OCP.XCAFDoc import XCAFDoc_ColorType

        color = Quantity_Color()
        for kind in (XCAFDoc_ColorType.XCAFDoc_ColorSurf, XCAFDoc_ColorType.XCAFDoc_ColorGen):
            if self._colors.GetColor(shape, kind, color):
                values = color.Values(Quantity_TypeOfColor.Quantity_TOC_sRGB)
                return "#" + "".join(f"{round(255 * min(max(x, 0.0), 1.0)):02x}" for x in values)
        return None
