"""Read the names of materials, the layers and the hidden solids that a STEP file states.

Names of materials (AP203 edition 2, AP214, AP242):

    product definition <- PROPERTY_DEFINITION 'material property' <- DESCRIPTIVE_REPRESENTATION_ITEM
    product definition <- MATERIAL_DESIGNATION
    product definition <- MAKE_FROM_USAGE_OPTION -> the product of a raw material

Layers are PRESENTATION_LAYER_ASSIGNMENT. A solid is hidden if INVISIBILITY names it, its style, its
representation or its layer.
"""

from __future__ import annotations

from collections.abc import Iterator

from kilter.files.step_entities import StepEntities

__all__ = ["hidden_solids", "stated_layers", "stated_materials"]

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
