"""Scene of a typical CAD export: threads as cylinders, intended gaps, a misplaced part."""

from __future__ import annotations

from kilter.assembly import Assembly, Part
from kilter.rigid import Pose
from kilter.scenes.pieces import block, tube
from kilter.scenes.registry import listed
from kilter.shape.primitives import Cylinder

__all__ = ["cad_export"]


@listed(
    "cad-export",
    "a lamp exported from CAD: a thread, a gap, a pin with play, a loose switch",
    source="open pairs",
    answer="unstable",
)
def cad_export() -> Assembly:
    """A lamp as exported from CAD: base, post, shade, screw, ring, pin, and a switch beside; in mm.

    - `screw` in `post`: the screw has the radius of the thread, 2 mm, and the hole that of the
      core, 1.65 mm. They overlap, and as drawn no contact carries a force.
    - `shade` on `post`: 0.02 mm above it, more than the gap tolerance.
    - `pin` in `ring`: 0.2 mm of play; the pin stands on the base.
    - `switch`: 3 mm above the base. It touches nothing and falls, whatever the other parts do.
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
