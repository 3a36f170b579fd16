"""Density, material, colour and layer of each solid of a STEP document, as the file states them.

The colour of a solid is that of the solid, else of its product, else of most of its faces.
"""

from __future__ import annotations

import re
from collections import Counter
from pathlib import Path
from typing import Any, NamedTuple

from kilter.files.occt import inside
from kilter.files.raw import read_bytes
from kilter.files.step_densities import stated_densities
from kilter.files.step_entities import StepEntities
from kilter.files.step_labels import hidden_solids, stated_layers, stated_materials

__all__ = ["UNSTATED", "Stated", "StepStatements", "text_statements"]

_SAID = re.compile(
    rb"MASS_UNIT|MATERIAL_DESIGNATION|MAKE_FROM_USAGE_OPTION|PRESENTATION_LAYER_ASSIGNMENT"
    rb"|[^A-Z_]INVISIBILITY|(?i:'material)"
)
"""Words without which the text of a file states nothing about its solids."""


class Stated(NamedTuple):
    """Statements of a file about a solid; None if the file states none."""

    density: float | None = None
    """[kg/m^3]"""
    color: str | None = None
    """"#rrggbb"."""
    material: str | None = None
    layer: str | None = None
    """Name of the material, and of the layer."""
    hidden: bool = False
    """Whether the file hides the solid."""


UNSTATED = Stated()


def text_statements(path: Path) -> dict[int, Stated]:
    """Statements in the text of a STEP file, by the position of each solid among its entities.

    The first entity has the position 1, as in the model of OCCT. Colours are left to OCCT.
    """
    data = read_bytes(path)
    if not _SAID.search(data):
        return {}
    entities = StepEntities(data)
    densities, materials = stated_densities(entities), stated_materials(entities)
    layers, hidden = stated_layers(entities), hidden_solids(entities)
    position = entities.positions()
    return {
        position[solid]: Stated(
            density=densities.get(solid),
            material=materials.get(solid),
            layer=layers.get(solid),
            hidden=solid in hidden,
        )
        for solid in {*densities, *materials, *layers, *hidden}
    }


class StepStatements:
    """Access to the statements of a STEP document after its transfer to OCCT."""

    def __init__(self, document: Any, session: Any, in_text: dict[int, Stated]) -> None:
        from OCP.XCAFDoc import XCAFDoc_DocumentTool

        self._colors = XCAFDoc_DocumentTool.ColorTool_s(document.Main())
        self._transfer = session.TransferReader()
        # the bindings give an entity of OCCT one Python object as long as it is kept
        model = self._transfer.Model()
        self._entities = [model.Value(k) for k in in_text]
        self._in_text = dict(zip(map(id, self._entities), in_text.values(), strict=True))

    def about(self, solid: Any, product: Any) -> Stated:
        """Statements about a solid (TopoDS_Solid) of a product (TDF_Label)."""
        stated = UNSTATED
        if self._in_text:
            entity = self._transfer.EntityFromShapeResult(solid, -1)
            stated = self._in_text.get(id(entity), UNSTATED)
        return stated._replace(color=self._color(solid, product))

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
