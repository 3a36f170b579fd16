"""Cones at corners of three facets, against the general way that cuts the neighbourhood."""

from types import SimpleNamespace

import numpy as np
import pytest

from kilter.arrays import cross, unit_rows
from kilter.contact.common.edges import Rays
from kilter.contact.contact_tolerances import CONE_ANGLE
from kilter.contact.sharp import local_cones


def corner(rng, turn, least=2e-3):
    """Facets and rays of a random corner of three facets; None if its facets do not close."""
    normals = unit_rows(rng.normal(size=(3, 3)))
    if turn is not None:  # an upright edge of an extruded outline
        at = rng.uniform(0, 2 * np.pi) + np.array([0, turn])
        normals = np.array([[0, 0, 1], *np.column_stack([np.cos(at), np.sin(at), 0 * at])])
    following, before = np.roll(normals, -1, axis=0), np.roll(normals, 1, axis=0)
    direction = unit_rows(cross(following, before)) * rng.choice([-1, 1], (3, 1))
    left, right = (np.arange(3) + 1) % 3, (np.arange(3) + 2) % 3
    if rng.random() < 0.5:
        left, right = right, left
    rays = Rays(np.zeros(3, int), np.arange(3), direction, left, right)
    facets = SimpleNamespace(normal=normals, part=np.zeros(3, int))
    behind = np.einsum("ij,ij->i", direction, normals) < 0
    into = cross(normals[left], direction)
    reflex = np.einsum("ij,ij->i", into, normals[right]) > 0
    closes = (reflex == (behind | ~behind.any())).all() and not behind.all()
    return (facets, rays) if closes and abs(np.linalg.det(normals)) > least else None


@pytest.mark.parametrize("turn", [None, 0.02, 0.4, 1.0, 2.5, 3.1])
def test_corners_of_three_facets_have_the_cones_of_the_general_way(turn):
    rng = np.random.default_rng(1)
    across = unit_rows(rng.normal(size=(300, 3)))
    seen = set()
    for _ in range(200):
        made = corner(rng, turn)
        if made is None:
            continue
        rows, found = local_cones._three_facet_cones(*made, np.array([7]), np.array([0]))
        assert found.tolist() == [0]
        assert (rows.owner == 7).all()
        quick = [rows.ray[rows.piece == piece] for piece in np.unique(rows.piece)]
        general = local_cones.convex_pieces(local_cones._sectors_around(*made, np.arange(3)))
        # a cone is known by the directions with which all its rays make an obtuse angle
        polar = [
            [((c @ across.T) < 0).all(axis=0).tolist() for c in kind] for kind in (quick, general)
        ]
        assert sorted(polar[0]) == sorted(polar[1])
        seen.add(len(quick))
    assert seen == {2, 3}


def test_a_nearly_flat_corner_is_left_to_the_general_way():
    rng, first = np.random.default_rng(1), np.array([0])
    made = [corner(rng, turn, least=0.0) for turn in (5e-4, 2e-3) for _ in range(60)]
    for near, some in ((5e-4, made[:60]), (2e-3, made[60:])):
        found = [len(local_cones._three_facet_cones(*m, first, first)[1]) for m in some if m]
        assert set(found) == {int(near > CONE_ANGLE)}
