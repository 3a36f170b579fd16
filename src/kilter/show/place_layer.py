"""The map of places of the next part on a page: data of the layer, and its card."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from kilter.show.sections import facts_html, text
from kilter.tell.facts import facts

if TYPE_CHECKING:
    from kilter.analysis.placing.place import Places
    from kilter.analysis.placing.upright_prisms import PlacedPrism

__all__ = ["build_place_layer", "place_card", "placed_part"]

KEYS = (
    ("stable", "the centre here: everything stands"),
    ("falls", "something falls"),
    ("undecided", "open"),
)
"""Swatches and words of the key of the map."""


def placed_part(prism: PlacedPrism) -> dict[str, Any]:
    """The part of a map of places for the picture: corners of its underside, and its heights."""
    return {
        "footprint": prism.footprint.tolist(),
        "below": prism.below,
        "above": prism.above,
    }


def build_place_layer(places: Places) -> dict[str, Any]:
    """JSON data of the map: its polygons by height, and the part."""
    assert places.prism is not None
    return {"levels": places.to_dict()["levels"], "part": placed_part(places.prism)}


def place_card(places: Places) -> str:
    """HTML card of the map: its sentence, the state at the pointer, a key, and facts."""
    answer = places.to_dict()
    keys = " ".join(
        f'<span><i class="swatch {name}"></i> {text(words)}</span>' for name, words in KEYS
    )
    rows = facts_html((term, text(words)) for term, words in facts(answer) if term != "seconds")
    return (
        '<section class="card" id="places" aria-labelledby="places-title">'
        f'<h2 id="places-title">Places of the next part</h2><p>{text(answer["sentence"])}</p>'
        '<p id="place-state" role="status">move the pointer over the map</p>'
        f'<p class="key">{keys}</p>{rows}</section>\n'
    )
