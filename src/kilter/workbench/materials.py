"""Densities of common materials that the workbench offers, with their sources [kg/m^3]."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["MATERIALS", "Material"]


@dataclass(frozen=True, slots=True)
class Material:
    """A material with its density [kg/m^3] and the source of this number."""

    name: str
    density: float
    source: str


USUAL = "usual value of data sheets"

MATERIALS = (
    Material("steel", 7850, "EN 1993-1-2, 3.2.2"),
    Material("stainless steel", 7900, "EN 10088-1, steel 1.4301"),
    Material("cast iron", 7200, USUAL),
    Material("aluminium", 2700, "EN 1999-1-1, 3.2.5"),
    Material("brass", 8500, USUAL),
    Material("copper", 8900, USUAL),
    Material("concrete", 2400, USUAL),
    Material("granite", 2700, USUAL),
    Material("limestone", 2300, USUAL),
    Material("brick", 1800, USUAL),
    Material("oak", 700, USUAL),
    Material("spruce", 420, "EN 338, class C24, mean density"),
    Material("glass", 2500, "EN 572-1"),
    Material("ABS", 1040, USUAL),
    Material("PLA", 1240, USUAL),
    Material("nylon", 1140, USUAL),
    Material("rubber", 1200, USUAL),
)
"""Materials in the order of the list that the page shows."""
