"""Toy bricks: their library, their grid of cells, and the bonds of their studs."""

from kilter.assembly.bricks.brick_assembly import assembly_of_bricks
from kilter.assembly.bricks.brick_library import BrickModel, StudRules

__all__ = ["BrickModel", "StudRules", "assembly_of_bricks"]
