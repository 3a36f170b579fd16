"""Meshes whose faces intersect each other and enclose a negative volume."""

from __future__ import annotations

import numpy as np
import pytest

from kilter.assembly import Assembly, Part
from kilter.errors import InputError
from kilter.shape.primitives import Box, Mesh, surface


def with_lumps(turn: int, at: float) -> Mesh:
    """A cube of side 1 and two boxes of volume .3 beside it; `turn` -1: inside out."""
    side = 0.3 ** (1 / 3)
    vertices, faces = zip(*(surface(Box([size] * 3)) for size in (1.0, side, side)), strict=True)
    places = np.array([[0, 0, 0], [-at, 0, 0], [at, 0, 0]])
    corners = np.vstack([v + p for v, p in zip(vertices, places, strict=True)])
    lumps = [f[:, ::turn] + 8 * k for k, f in enumerate(faces[1:], start=1)]
    return Mesh(corners, np.vstack([faces[0], *lumps]))


def test_negative_matter_is_refused() -> None:
    with pytest.raises(InputError, match=r"part .stone.: its faces intersect .*; repair"):
        _ = Assembly([Part("stone", with_lumps(-1, 5.0))]).geometry


def test_lumps_and_holes_are_not() -> None:
    """Outward boxes are accepted; inward boxes are holes if they are inside the cube."""
    assert Assembly([Part("stone", with_lumps(1, 5.0))]).geometry.volume == pytest.approx([1.6])
    hole = with_lumps(-1, 0.1)
    assert Assembly([Part("stone", hole)]).geometry.volume == pytest.approx([0.4])
