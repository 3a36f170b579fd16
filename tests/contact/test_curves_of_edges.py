"""Points of the curves of edges: closed forms for circles, and independence of other rows."""

from __future__ import annotations

import numpy as np
import pytest
from solids import peg

from kilter import Assembly, Part, Tolerance
from kilter.contact.common.contact_search import begin_search
from kilter.contact.common.edges import part_curves
from kilter.contact.sharp.edges_with_edges import corner_rays

RADIUS, SIDES = 2.0, 40


@pytest.fixture
def rim():
    """The curves of a cylinder, and the edges of its upper rim."""
    assembly = Assembly([Part("peg", peg(RADIUS, 0.0, 1.0, sides=SIDES))])
    search = begin_search(assembly, Tolerance(), lambda stage: None)
    curves = part_curves(search, 0)
    p, q = curves.edges.ends(curves.geometry, np.arange(curves.edges.start[1]))
    upper = np.flatnonzero((p[:, 2] > 0.9) & (q[:, 2] > 0.9))
    upper = upper[curves.exact(upper)]
    assert len(upper) == SIDES
    return curves, upper


def test_the_nearest_point_of_an_arc_lies_in_the_direction_of_the_point(rim):
    """Off the plane of a rim too: the nearest point has the same angle about the axis."""
    curves, upper = rim
    rng = np.random.default_rng(1)
    share = rng.uniform(0.05, 0.95, len(upper))
    on_curve = curves.points(upper, share).at
    points = on_curve * [1.1, 1.1, 1.0]
    points[:, 2] += 0.1
    nearest = curves.points(upper, curves.nearest_share(upper, points)).at
    assert np.hypot(*nearest.T[:2]) == pytest.approx(np.full(len(upper), RADIUS), rel=1e-13)
    assert nearest == pytest.approx(on_curve, abs=1e-9)


def test_the_nearest_point_beyond_an_arc_is_its_end(rim):
    curves, upper = rim
    p, q = curves.edges.ends(curves.geometry, upper)
    assert curves.nearest_share(upper, q + 3 * (q - p)).tolist() == [1.0] * len(upper)
    assert curves.nearest_share(upper, p - 3 * (q - p)).tolist() == [0.0] * len(upper)


def test_rows_do_not_depend_on_other_rows(rim):
    """A row that needs many steps changes no digit of the others."""
    curves, upper = rim
    rng = np.random.default_rng(2)
    points = rng.normal(size=(len(upper), 3)) * 3
    together = curves.nearest_share(upper, points)
    alone = [curves.nearest_share(upper[[k]], points[[k]])[0] for k in range(len(upper))]
    np.testing.assert_allclose(together, alone, rtol=0, atol=1e-15)
    at = curves.points(upper, together).at
    each = [curves.points(upper[[k]], together[[k]]).at[0] for k in range(len(upper))]
    np.testing.assert_allclose(at, each, rtol=0, atol=1e-15)


def test_repeated_corners_and_edges_have_the_answer_of_each(rim):
    curves, upper = rim
    assert curves.sharp(upper[[3, 0, 3]]).tolist() == [True] * 3
    vertex = curves.edges.ends_of[upper[:3], 0]
    repeated = vertex[[2, 0, 2, 1]]
    owner, away, normals, unknown = corner_rays(curves, repeated)
    assert unknown.tolist() == [False] * 4
    for row, one in enumerate(repeated):
        _, single, both, _ = corner_rays(curves, np.array([one]))
        np.testing.assert_allclose(away[owner == row], single, rtol=0, atol=1e-15)
        np.testing.assert_allclose(normals[owner == row], both, rtol=0, atol=1e-15)
