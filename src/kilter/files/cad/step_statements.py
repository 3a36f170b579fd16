"""Density, material, colour and layer of each solid of a STEP document, as the file states them.

The colour of a solid is that of the solid, else of its product, else of most of its faces.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from kilter.files.cad.step_densities import StepEntities, stated_densities
from kilter.files.cad.step_surfaces import inside
from kilter.files.limits import read_bytes
from kilter.units import METRES

# Read the coordinate accuracy that a STEP file states.


_STATED = re.compile(
    r"UNCERTAINTY_MEASURE_WITH_UNIT\s*\(\s*LENGTH_MEASURE\s*\(\s*([^()\s]+)\s*\)\s*,\s*#(\d+)"
)
_PREFIX = {"MILLI": 1e-3, "CENTI": 1e-2, "DECI": 1e-1, "MICRO": 1e-6, "KILO": 1e3}
_SI = re.compile(r"SI_UNIT\s*\(\s*(?:\$|\.(\w+)\.)\s*,\s*\.METRE\.")
_CONVERTED = re.compile(r"CONVERSION_BASED_UNIT\s*\(\s*'([^']*)'", re.IGNORECASE)
_NAMED = {"INCH": 0.0254, "FOOT": 0.3048, "MILLIMETRE": 1e-3, "MILLIMETER": 1e-3}


def stated_accuracy(paths: Iterable[Path], units: str) -> float:
    """Largest coordinate error that STEP files state, in the unit `units`; 0 if none is stated."""
    largest = 0.0
    for path in paths:
        try:
            text = path.read_bytes().decode("latin-1")
        except OSError:
            continue
        for number, unit in set(_STATED.findall(text)):
            metres = _metres(text, unit)
            if metres is not None:
                largest = max(largest, _number(number) * metres / METRES[units])
    return largest


def _number(word: str) -> float:
    """The value of a word that is a positive finite number; 0 for other words."""
    try:
        value = float(word)
    except ValueError:
        return 0.0
    return value if 0 < value < np.inf else 0.0


def _metres(text: str, unit: str) -> float | None:
    """Size in metres of the length unit with an entity number; None if it cannot be read."""
    defined = re.search(rf"#{unit}\s*=([^;]*);", text)
    if defined is None:
        return None
    converted = _CONVERTED.search(defined[1])
    if converted is not None:
        return _NAMED.get(converted[1].strip().upper())
    si = _SI.search(defined[1])
    return None if si is None else _PREFIX.get(si[1] or "", None if si[1] else 1.0)


# Read the names of materials, the layers and the hidden solids that a STEP file states.


_LEVELS = 4
"""Largest number of references from a layer or a style to a solid."""
_LEADING = ("REPRESENTATION(", "STYLED_ITEM(", "LAYER_ASSIGNMENT(")
"""Ends of the types through which a layer or a style refers to solids."""


def stated_materials(entities: StepEntities) -> dict[str, str]:
    """Name of the material of each solid, by its number."""
    named = dict(_materials_of_products(entities))
    return {solid: named[product] for product, solid in entities.solids() if product in named}


def stated_layers(entities: StepEntities) -> dict[str, str]:
    """Name of the layer of each solid, by its number; the first layer of several."""
    solids = {solid for _, solid in entities.solids()}
    layers: dict[str, str] = {}
    for number in entities.of_type["PRESENTATION_LAYER_ASSIGNMENT"]:
        name = next(iter(entities.strings(number)), "")
        for solid in _solids_below(entities, number, solids):
            if name:
                layers.setdefault(solid, name)
    return layers


def hidden_solids(entities: StepEntities) -> set[str]:
    """Numbers of the solids that the file hides."""
    solids = {solid for _, solid in entities.solids()}
    hiding = entities.of_type["INVISIBILITY"]
    return {solid for number in hiding for solid in _solids_below(entities, number, solids)}


def _solids_below(
    entities: StepEntities, number: str, solids: set[str], level: int = 0
) -> Iterator[str]:
    """Yield the solids to which an entity refers, also by a representation, a style or a layer."""
    for item in entities.references(number):
        kind = entities.text.get(item, "").lstrip().partition("(")[0].strip() + "("
        if item in solids:
            yield item
        elif kind.endswith(_LEADING) and level < _LEVELS:
            yield from _solids_below(entities, item, solids, level + 1)


def _materials_of_products(entities: StepEntities) -> Iterator[tuple[str, str]]:
    """Yield product definitions and the names of their materials, the most certain last."""
    for product, material in entities.raw_materials():
        name = _product_name(entities, material)
        if name:
            yield product, name
    for number in entities.of_type["PROPERTY_DEFINITION_REPRESENTATION"]:
        owner, representation = (*entities.references(number), "", "")[:2]
        said = " ".join((*entities.strings(owner), *entities.strings(representation))).lower()
        if "material" not in said:
            continue
        for item in entities.references(representation):
            if entities.text.get(item, "").startswith("DESCRIPTIVE_REPRESENTATION_ITEM"):
                name = next(filter(None, entities.strings(item)), "")
                if name:
                    yield from ((entities.product(k), name) for k in entities.references(owner))
    for number in entities.of_type["MATERIAL_DESIGNATION"]:
        name = next(iter(entities.strings(number)), "")
        if name:
            yield from ((entities.product(k), name) for k in entities.references(number))


def _product_name(entities: StepEntities, definition: str) -> str:
    """Identifier and name of the product of a product definition."""
    for formation in entities.references(definition)[:1]:
        for product in entities.references(formation)[:1]:
            return " ".join(dict.fromkeys(filter(None, entities.strings(product)[:2])))
    return ""


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
