"""What slides where it is not leaned on."""

from __future__ import annotations

import numpy as np

from kilter import Assembly
from kilter.scenes.pieces import block


def leaning(degrees: float, friction: float = 0.0) -> Assembly:
    """On a bed, A leans on B and B on a stop, as gravity leans by an angle towards the stop."""
    angle = np.radians(degrees)
    return Assembly(
        [
            block("bed", [-3, -2, -1], [6, 3, 0], grounded=True),
            block("stop", [2, 0, 0], [3, 1, 1], grounded=True),
            block("A", [0, 0, 0], [1, 1, 1]),
            block("B", [1, 0, 0], [2, 1, 1]),
        ],
        gravity=9.81 * np.array([np.sin(angle), 0.0, -np.cos(angle)]),
        friction=friction,
    )
