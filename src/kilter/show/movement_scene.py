"""Data of small movements for pictures: their magnification, hinges, the film of a page."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from kilter.arrays import Array
from kilter.show.packing import pack, readable
from kilter.tell.numbers import number

if TYPE_CHECKING:
    from kilter.analysis.support_movement import SupportMovement
    from kilter.assembly import Assembly


SHARE = 0.12
"""Length of the farthest movement in the figure, over the size of the picture [-]."""
MOST_TURN = 0.5
"""Largest magnified rotation [rad]."""
LINEAR_TURN = 0.2
"""Largest magnified rotation of a linear displacement [rad], which stretches a part by 2 % then."""


def magnification(movement: Array, size: float, most_turn: float = MOST_TURN) -> float:
    """Factor by which movements, shape (N, 6), are magnified in a picture of a size [length unit].

    The largest rotation becomes at most `most_turn` [rad]. The factor is 1, 2 or 5 times a power of
    ten, and at least 1.

    Examples
    --------
    >>> magnification(np.array([[0.001, 0, 0, 0, 0, 0]]), 1.0)
    100.0
    """
    shift = float(np.linalg.norm(movement[:, :3], axis=1).max(initial=0.0))
    turn = float(np.linalg.norm(movement[:, 3:], axis=1).max(initial=0.0))
    most = min(SHARE * size / max(shift, 1e-300), most_turn / max(turn, 1e-300), 1e9)
    power = 10.0 ** np.floor(np.log10(max(most, 1.0)))
    steps = [step for step in (1.0, 2.0, 5.0) if step * power <= max(most, 1.0)]
    return float(steps[-1] * power)


def movement_factor(assembly: Assembly, motion: Array) -> float:
    """Factor by which a picture of an assembly magnifies a small motion of its parts, (N, 6)."""
    corners = assembly.geometry.vertices
    free = ~assembly.geometry.grounded[assembly.geometry.vertex_part]
    size = float(np.ptp(corners[free] if free.any() else corners, axis=0).max())
    return magnification(motion, size, LINEAR_TURN)


def movement_words(found: SupportMovement, factor: float) -> str:
    """The factor of a picture in words, and whether the movement is exact."""
    return f"Movements x {number(factor)}{'' if found.exact else ', not exact'}."


def hinges_of(assembly: Assembly, found: SupportMovement) -> list[tuple[int, Array]]:
    """A part at each hinge of a movement, and the point of the hinge, shape (3,)."""
    return [
        (assembly.index_of(contact.parts[0]), np.asarray(contact.hinge))
        for contact in found.opened
        if contact.hinge is not None
    ]


def build_movement(found: SupportMovement, assembly: Assembly, center: Array) -> dict[str, Any]:
    """JSON data of the magnified movement of parts and supports, with its hinges.

    Arguments: `center` (3,): point to which positions are relative, world frame [length unit].
    """
    factor = movement_factor(assembly, found.motion)
    return {
        "words": readable(f"{found.sentence} {movement_words(found, factor)}"),
        "motion": pack(factor * found.motion),
        "hinges": [
            {"part": part, "at": (at - center).tolist()} for part, at in hinges_of(assembly, found)
        ],
    }
