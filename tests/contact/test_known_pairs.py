"""Pairs in equal relative poses share their findings; plates with many holes are cut by a few."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from solids import bore, peg

import kilter
from kilter import Assembly, Box, Part, Pose
from kilter.contact import pair_findings
from kilter.contact.common.facets import find_facets
from kilter.contact.common.known_pairs import forget_pairs
from kilter.contact.common.polygons import NearTriangles, facet_frames
from kilter.shape.primitives import Mesh

HOLE, PEG, BLOCK = bore(1.0), peg(1.0), Box(1, 1, 1)


def _cells(count, shift=0.0):
    """Turned copies of a cell: a block with a hole, a peg in it, and a box that overlaps both.

    `shift`: movement of the last box along the axis of its hole.
    """
    parts = []
    for k in range(count):
        w, *xyz = np.roll(Rotation.from_rotvec([0.3 * k, 0.7 * k, -0.2 * k]).as_quat(), 1)
        place = Pose([9.0 * k, 4.0 * k, -3.0 * k], [w, *xyz])
        up = shift if k == count - 1 else 0.0
        parts += [
            Part(f"hole-{k}", HOLE, place),
            Part(f"peg-{k}", PEG, place),
            Part(f"box-{k}", BLOCK, place @ Pose([1.0, 0.1, 0.2 + up])),
        ]
    return Assembly(parts)


def _searched(monkeypatch, assembly):
    """The contacts of an assembly, and the numbers of pairs that were examined one by one."""
    seen, each = [], pair_findings._examine_each

    def counted(assembly, search, tolerance):
        seen.append(len(search.pairs))
        return each(assembly, search, tolerance)

    with monkeypatch.context() as patch:
        patch.setattr(pair_findings, "_examine_each", counted)
        return kilter.contacts(assembly), seen


def _alone(monkeypatch, assembly):
    """The contacts of an assembly in which every pair is examined."""
    with monkeypatch.context() as patch:
        patch.setattr(
            pair_findings, "may_repeat", lambda search: np.zeros(len(search.pairs), dtype=bool)
        )
        return kilter.contacts(assembly)


def _require_equal(found, expected):
    """The contacts are equal, except for the angle at which points around a round face begin."""
    assert (found.patch_parts == expected.patch_parts).all()
    assert (found.patch_kind == expected.patch_kind).all()
    assert found.patch_area == pytest.approx(expected.patch_area, rel=1e-9, abs=1e-12)
    assert found.patch_gap == pytest.approx(expected.patch_gap, abs=1e-10)
    assert (found.patch_start == expected.patch_start).all()
    middles = [
        np.add.reduceat(each.points, each.patch_start[:-1]) / np.diff(each.patch_start)[:, None]
        for each in (found, expected)
    ]
    assert middles[0] == pytest.approx(middles[1], abs=1e-9)
    for name in ("overlaps", "open_pairs", "unsupported", "near"):
        ends = [[pair.ends for pair in getattr(each, name)] for each in (found, expected)]
        assert ends[0] == ends[1]
    for one, other in zip(found.overlaps, expected.overlaps, strict=True):
        assert one.depth == pytest.approx(other.depth, rel=1e-9)
        # the triangles in a box along the axes are refined: volumes depend on the pose by 1e-4
        assert one.volume == pytest.approx(other.volume, rel=5e-4)
    assert len(found.possible) == len(expected.possible)


@pytest.mark.slow
def test_copies_are_examined_once(monkeypatch):
    expected = _alone(monkeypatch, _cells(5))
    forget_pairs()
    found, seen = _searched(monkeypatch, _cells(5))
    assert seen == [3]
    assert len(found.overlaps) >= 5
    assert (found.patch_kind == "cylinder").sum() == 5
    _require_equal(found, expected)


def test_a_moved_part_leaves_the_other_pairs_known(monkeypatch):
    forget_pairs()
    kilter.contacts(_cells(4))
    found, seen = _searched(monkeypatch, _cells(4, shift=0.05))
    assert seen == [2]  # the box with the block, and with the peg
    _require_equal(found, _alone(monkeypatch, _cells(4, shift=0.05)))


def test_held_parts_and_other_tolerances_are_other_pairs(monkeypatch):
    forget_pairs()
    kilter.contacts(_cells(2))
    assert _searched(monkeypatch, _cells(2).with_grounded(["hole-1"]))[1] == [2]
    with monkeypatch.context() as patch:
        seen, each = [], pair_findings._examine_each
        patch.setattr(
            pair_findings,
            "_examine_each",
            lambda *given: seen.append(len(given[1].pairs)) or each(*given),
        )
        kilter.contacts(_cells(2), tolerance=kilter.Tolerance(gap=1e-3))
    assert seen == [3]


def _plate(holes):
    """A plate in the plane z = 0 to 1 with a row of square holes."""
    import shapely

    cuts = [shapely.box(4 * k + 1, 1, 4 * k + 3, 3) for k in range(holes)]
    region = shapely.box(0, 0, 4 * holes, 4).difference(shapely.union_all(cuts))
    pieces = shapely.get_parts(shapely.constrained_delaunay_triangles(region))
    rings = np.array([shapely.get_coordinates(shapely.orient_polygons(p))[:3] for p in pieces])
    corners, index = np.unique(rings.reshape(-1, 2), axis=0, return_inverse=True)
    top = index.reshape(-1, 3)
    sides = {(a, b) for t in top.tolist() for a, b in zip(t, t[1:] + t[:1], strict=True)}
    n, outer = len(corners), [(a, b) for a, b in sides if (b, a) not in sides]
    walls = [t for a, b in outer for t in ((a, b + n, b), (a, a + n, b + n))]
    vertices = np.array([(*xy, z) for z in (1.0, 0.0) for xy in corners.tolist()])
    return Mesh(vertices, np.concatenate([top, top[:, ::-1] + n, walls]))


@pytest.mark.parametrize("at", [0.5, 2.0, 41.0, 118.5])
def test_only_near_triangles_of_a_plate_are_cut(at):
    plate = _plate(30)
    parts = [Part("plate", plate, grounded=True), Part("lid", Box(3, 3, 1), Pose([at, 2, 1.5]))]
    assembly = Assembly(parts)
    low, high = max(at - 1.5, 0.0), min(at + 1.5, 120.0)
    holes = 4 * np.arange(30) + 1.0
    open_width = (np.minimum(holes + 2, high) - np.maximum(holes, low)).clip(0).sum()
    area = 3 * (high - low) - 2 * open_width
    found = kilter.contacts(assembly)
    assert found.patch_area.sum() == pytest.approx(area, rel=1e-12)
    facets = find_facets(assembly.geometry)
    top = np.flatnonzero((facets.part == 0) & (facets.normal[:, 2] > 0.5))
    under = np.flatnonzero((facets.part == 1) & (facets.normal[:, 2] < -0.5))
    frames = facet_frames(facets, np.zeros(1, dtype=int), top, under, np.ones(1))
    index = NearTriangles(assembly.geometry, facets)
    assert len(index.corners(int(top[0]))) == 182
    assert len(index.between(frames, 0)[0]) < 70
