"""Tolerances of second order, relative [-] or angles [rad]."""

from __future__ import annotations

__all__ = ["CROSSING", "ROUND"]

CROSSING = 1e-3
"""Edges that cross at less than this angle have no form of the gap [rad]."""

ROUND = 1e-6
"""Surfaces whose curvatures cancel to this share of themselves touch along more than a point."""
