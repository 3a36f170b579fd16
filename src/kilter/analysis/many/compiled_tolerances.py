"""Tolerances of the compiled verdicts: how clear an assembly must be, else `check` decides.

All are relative [-]. Each is stricter than the limit of a proof or of the contact search that it
replaces, so that a larger margin only leaves more assemblies to the general computation:

    LEVEL_CORNERS / RESOLVED_SHARE < the angle of a level contact
    PART_OF_GAP < 1,   CLEAR > the reach of the search for near faces, edges and corners
    RESIDUAL < the tolerance of a balance,   RULED_OUT * VIOLATION < LEAST_POWER
"""

from __future__ import annotations

LEVEL_CORNERS = 2e-15
"""Largest difference of corners that lie on one level, or above each other, over the largest
coordinate. A larger value reads less exact prisms."""
RESOLVED_SHARE = 1e-4
"""Least thickness of a prism over its radius and over its largest coordinate. A larger value leaves
thin parts, and parts far from the origin, to the general computation."""
CONVEX = 1e-5
"""Least area of an outline, and of the turn at each corner, over the square of its length."""
PART_OF_GAP = 0.5
"""Largest gap of two touching faces, over the gap tolerance of the pair."""
CLEAR = 0.0025
"""Least distance of parts that do not touch, and least width of a contact, over the size of the
smaller part."""
INSIDE = 1e-6
"""A load this far within the hull of its supports is carried, and a load this far outside tips its
part, over the radius of the part."""
STEADY = 1e-6
"""Least eigenvalue of the second moments of the supporting forces, over their trace."""
CHANGED = 0.1
"""Largest relative change of a force by the correction that balances the load exactly."""
CARRIES = 1e-8
"""Fraction of the largest force above which a support counts."""
RESIDUAL = 1e-11
"""Largest imbalance of a part, over its weight."""
PRESSED = 1e5
"""Largest sum of the forces on a part, over its weight."""
VIOLATION = 1e-12
"""Largest closing speed of a contact, over the speed of the fastest part."""
LEAST_POWER = 1e-5
"""Least power of a motion, over the weight of all free parts and the speed of the fastest."""

LEFT, STABLE, UNSTABLE = 0, 1, 2
"""Codes of the answers: not decided, proved stable, proved unstable."""
