"""Warnings of a map of places: reasons why places stay open."""

from __future__ import annotations

from collections.abc import Sequence

from kilter.analysis.placing.place_map import LevelMap
from kilter.analysis.placing.polygon_sets import polygons_of
from kilter.analysis.placing.upright_prisms import Top
from kilter.assembly import Assembly
from kilter.contact import ContactSet
from kilter.errors import some, some_names

__all__ = ["map_warnings"]


def map_warnings(
    assembly: Assembly,
    tops: Sequence[Top],
    contacts: ContactSet,
    levels: Sequence[LevelMap],
    strip: float,
) -> list[str]:
    """Warnings about parts that are no upright prisms, and about pairs that leave places open.

    Arguments: `strip`: width above which an open area is no strip between places [length unit].
    """
    warnings = []
    other = [assembly.names[top.part] for top in tops if not top.upright]
    if other:
        warnings.append(
            f"the map leaves places on {some_names(other, 3)} open: only tops of upright prisms "
            "are mapped"
        )
    wide = any(
        not piece.buffer(-strip).is_empty for level in levels for piece in polygons_of(level.open)
    )
    if wide and contacts.open_pairs:
        pairs = [
            " and ".join(repr(assembly.names[k]) for k in pair.ends) for pair in contacts.open_pairs
        ]
        warnings.append(
            f"the map leaves places open, because the geometry does not decide whether "
            f"{some(pairs, 1)} touch"
        )
    return warnings
