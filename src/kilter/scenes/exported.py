"""What a CAD system exports: threads as cylinders, gaps that were meant, a part out of place."""

from __future__ import annotations

from kilter.assembly import Assembly, Part
from kilter.rigid import Pose
from kilter.scenes.pieces import block, tube
from kilter.scenes.registry import listed
from kilter.shape.primitives import Cylinder

__all__ = ["cad_export"]


@listed(
    "cad-export",
    "a lamp as it came from CAD: a thread, a gap, a pin with play, a loose switch",
    source="open pairs",
    answer="unstable",
)
def cad_export() -> Assembly:
    """A base with a post, on it a shade; a screw, a foot and a pin; a switch beside them; mm.

    - `screw` in `post`: its radius is that of the thread, 2 mm, the hole is drawn at its core,
      1.65 mm. They overlap, and carry nothing as drawn.
    - `shade` on `post`: .02 mm above it, more than the gap tolerance.
    - `pin` in `ring`: .2 mm of play; it stands on the base.
    - `switch`: 3 mm above the base. It touches nothing, so it falls whatever the rest does.
    """
    parts = [
        block("base", [-40, -30, -10], [40, 30, 0], grounded=True),
        tube("post", 1.65, 6, 30, [0, 0, 15], density=7850.0),
        block("shade", [-20, -15, 30.02], [20, 15, 34], density=2700.0),
        Part("screw", Cylinder(2, 10), Pose([0, 0, 24.5]), density=7850.0),
        tube("ring", 4.2, 7, 4, [-28, 0, 2], density=7850.0),
        Part("pin", Cylinder(4, 14), Pose([-28, 0, 7]), density=7850.0),
        block("switch", [24, -5, 3], [34, 5, 9], density=1200.0),
    ]
    return Assembly(parts, units="mm")
