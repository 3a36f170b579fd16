"""Toy bricks: their library, their grid of cells, and the bonds of their studs."""

from kilter.assembly.bricks.brick_assembly import assembly_of_bricks
from kilter.assembly.bricks.brick_model import BrickModel
from kilter.assembly.bricks.stud_rules import StudRules

__all__ = ["BrickModel", "StudRules", "assembly_of_bricks"]
