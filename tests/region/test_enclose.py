"""Hulls that enclose a region, and rays to its boundary."""

from itertools import cycle, islice

import numpy as np
import pytest
from random_voronoi import random_voronoi
from scipy.optimize import nnls
from scipy.spatial import ConvexHull

import kilter
from kilter.analysis.decision.judge import judge
from kilter.analysis.load_limit import Limit, find_limit, gravity_wrench
from kilter.analysis.regions import cone_cutting as boundary_rays
from kilter.analysis.regions.cone_cutting import friction_cone
from kilter.analysis.regions.cone_hull import inner_hull
from kilter.analysis.regions.enclose import GrowingHull, KnownSet, SupportPoint, nearest_face
from kilter.arrays import unit_rows
from kilter.errors import TimeLimitReached
from kilter.mechanics.balance_in_cones import ConeBalance, balance_in_cones
from kilter.mechanics.program import Program, build_program
from kilter.scenes import stacks
from kilter.solvers.lorentz import Scaling
from kilter.solvers.many_shares import first_point, many_shares
from sampled import sampled

KINDS = ("scattered", "on a box", "on a sphere", "on a long box")


def points_of(kind: str, dimension: int, seed: int) -> np.ndarray:
    """Points whose hull has facets in general position, or many of them nearly in a plane."""
    random = np.random.default_rng(seed)
    points = random.normal(size=(40, dimension))
    if kind == "on a sphere":
        points /= np.linalg.norm(points, axis=1)[:, None]
    elif kind != "scattered":
        points /= np.abs(points).max(axis=1)[:, None]
        points *= 1 + 1e-8 * random.normal(size=(40, 1))
    if kind == "on a long box":
        points[:, 0] *= 1e6
    return points


@pytest.mark.quick(1)
@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("kind", KINDS)
def test_the_hull_is_that_of_qhull(kind, dimension):
    for seed in range(10):
        points = points_of(kind, dimension, seed)
        hull, other = GrowingHull.of(points, 1e-10), ConvexHull(points)
        assert hull is not None
        nearest = -float(other.equations[:, -1].max())
        assert hull.offsets.min() == pytest.approx(nearest, rel=1e-7, abs=1e-9)
        beyond = (points @ hull.normals.T - hull.offsets).max()
        assert beyond <= 1e-9 * np.abs(points).max()


@pytest.mark.parametrize("dimension", [1, 2, 3])
def test_flat_points_have_no_hull(dimension):
    flat = np.zeros((5, dimension))
    flat[:, : dimension - 1] = np.random.default_rng(0).normal(size=(5, dimension - 1))
    assert GrowingHull.of(flat, 1e-9) is None
    assert GrowingHull.of(np.empty((0, dimension)), 1e-9) is None


def ellipsoid(axes: np.ndarray, failing: int = -1):
    """The oracle of an ellipsoid around 0; it fails at one question."""
    asked = [0]

    def oracle(direction: np.ndarray) -> SupportPoint | None:
        asked[0] += 1
        if asked[0] == failing + 1:
            return None
        point = direction / np.linalg.norm(direction / axes)
        normal = point / axes**2
        normal /= np.linalg.norm(normal)
        return SupportPoint(point, normal, float(normal @ point))

    return oracle


def axes_and_back(dimension: int) -> np.ndarray:
    return np.vstack([np.eye(dimension), -np.eye(dimension)])


@pytest.mark.parametrize("dimension", [1, 2, 3])
def test_the_nearest_boundary_from_both_sides(dimension):
    axes = np.array([1.5, 1.0, 4.0])[:dimension]
    turn = np.linalg.qr(np.random.default_rng(1).normal(size=(dimension, dimension)))[0]
    inside = ellipsoid(axes)

    def turned(direction: np.ndarray) -> SupportPoint:
        found = inside(turn.T @ direction)
        return SupportPoint(turn @ found.point, turn @ found.normal, found.reach)

    face = nearest_face(turned, axes_and_back(dimension), agree=1e-4, limit=500)
    least = axes.min()
    assert face.inner <= least + 1e-12
    assert face.outer >= least - 1e-12
    assert face.inner >= face.outer * (1 - 1e-4)
    assert not face.failed


@pytest.mark.parametrize("failing", [0, 3, 8])
def test_a_failed_answer_is_said_and_nothing_breaks(failing):
    oracle = ellipsoid(np.array([1.5, 1.0, 4.0]), failing)
    face = nearest_face(oracle, axes_and_back(3), agree=1e-4, limit=200)
    if failing == 0:
        assert face is None
    else:
        assert face.failed
        assert face.inner <= 1.0 + 1e-12 <= face.outer + 2e-12


def test_a_set_that_is_flat_has_its_boundary_at_0():
    def segment(direction: np.ndarray) -> SupportPoint:
        along = abs(float(direction[0])) > 1 - 1e-12
        if along:
            return SupportPoint(direction, direction, 1.0)
        return SupportPoint(np.zeros(2), np.array([0.0, np.sign(direction[1])]), 0.0)

    face = nearest_face(segment, axes_and_back(2), agree=1e-6, limit=50)
    assert (face.inner, face.outer) == (0.0, 0.0)


def test_a_difference_that_counts_as_none_ends_it_sooner():
    oracle = ellipsoid(np.array([1.5, 1.0, 4.0]))
    near, exact = (
        nearest_face(oracle, axes_and_back(3), agree=1e-6, limit=500, within=within)
        for within in (1e-2, 0.0)
    )
    assert near.asked < exact.asked
    assert near.outer - 1e-2 <= near.inner <= 1.0 + 1e-12 <= near.outer + 2e-12


def test_every_facet_of_a_polytope_is_settled():
    corners = np.random.default_rng(4).normal(size=(30, 3))

    def support(direction: np.ndarray) -> SupportPoint:
        far = int((corners @ direction).argmax())
        return SupportPoint(corners[far], direction, float(corners[far] @ direction))

    known = KnownSet(support, GrowingHull.of(corners[:8], 1e-12))
    while not known.hull.done.all():
        known.settle(int(known.hull.done.argmin()))
    assert len(known.hull.facets) == len(ConvexHull(corners).simplices)


CELLS, ROUGH = (8, 25), (0.5, 0.7, 0.84, 1.0)


def program_of(seed: int) -> Program:
    """The program of random cells with friction."""
    assembly = random_voronoi(seed, CELLS, ROUGH)
    return build_program(assembly, kilter.contacts(assembly))


def pulled(program: Program, count: int, seed: int) -> tuple[ConeBalance, list[np.ndarray]]:
    """Balance of the weight, and pulls of a tenth of the weights in random directions."""
    ways = unit_rows(np.random.default_rng(seed).normal(size=(count, 3)))
    wrenches = [0.1 * gravity_wrench(program, way) for way in ways]
    return balance_in_cones(program, program.load, wrenches[0], 1.0), wrenches


def test_arrays_of_several_loads_are_those_of_each():
    cones = pulled(program_of(12), 1, 0)[0].cones
    random = np.random.default_rng(1)
    x = random.normal(size=(3, 4, cones.columns.shape[2]))
    y = random.normal(size=(4, *cones.right.shape))
    x[0] = 1.0 + np.linalg.norm(x[1:], axis=0)
    scaling = Scaling.of(x, np.abs(x))
    diagonal, links = cones.normal_matrix(scaling)
    for k in range(4):
        assert np.allclose(cones.balance(x)[k], cones.balance(x[:, k]), atol=1e-12)
        assert np.allclose(cones.openings(y)[:, k], cones.openings(y[k]), atol=1e-12)
        single = cones.normal_matrix(Scaling(scaling.w[:, k], scaling.eta[k]))
        assert np.allclose(diagonal[k], single[0], rtol=1e-12)
        assert np.allclose(links[k], single[1], rtol=1e-12)


@pytest.mark.parametrize(
    ("seed", "failures"), sampled(1, [(12, 0), (17, 1), (10, 0), (3, 0), (28, 5)])
)
def test_shares_side_by_side_are_the_limits_of_each_load(seed, failures):
    """A search may fail, as its function states; of these assemblies no more than were known."""
    program = program_of(seed)
    if judge(program).stable is not True:
        pytest.skip("the cells do not stand as drawn")
    balance, wrenches = pulled(program, 6, seed)
    along = np.array([balance.with_more(wrench, 1.0).cones.along for wrench in wrenches])
    starts = [first_point(balance.cones)] * 6
    shares = many_shares(balance.cones, balance.cones.right, along, starts, agree=1e-6)
    assert shares.count(None) <= failures
    for wrench, share in zip(wrenches, shares, strict=True):
        limit = find_limit(program, wrench)
        assert isinstance(limit, Limit)
        if share is not None:
            assert share.share - 1e-5 <= limit.value <= share.bound + 1e-5
            assert share.bound - share.share <= 1e-3 * max(share.share, 1.0)
    middles = [share.middle for share in shares if share is not None]
    ends = list(islice(cycle(middles[::-1]), len(shares)))
    again = many_shares(balance.cones, balance.cones.right, along, ends, agree=1e-6)
    for first, second in zip(shares, again, strict=True):
        if first is not None and second is not None:
            assert second.share - 1e-5 <= first.bound
            assert first.share - 1e-5 <= second.bound
    assert again.count(None) <= failures


def test_distances_to_a_hull_are_those_of_nonnegative_sums():
    random = np.random.default_rng(3)
    for wide in (0.2, 1.0, 3.0):
        rays = unit_rows(np.array([0, 0, 1]) + np.column_stack([wide * random.normal(size=(9, 2)),
                                                                np.zeros(9)]))  # fmt: skip
        hull = inner_hull(rays, np.array([0.0, 0.0, 1.0]))
        assert hull is not None
        directions = unit_rows(random.normal(size=(40, 3)))
        for direction, angle in zip(directions, hull.distances(directions), strict=True):
            rest = nnls(rays.T, direction)[1]
            exact = np.arcsin(min(rest, 1.0))
            # a direction over a right angle away is nearest to the tip
            assert angle == pytest.approx(exact, abs=1e-7) or angle > np.pi / 2 - 1e-7


def test_flat_rays_have_no_hull():
    flat = unit_rows(np.array([[1.0, 0, 1], [0, 0, 1], [-1, 0, 1]]))
    assert inner_hull(flat, np.array([0.0, 0.0, 1.0])) is None


@pytest.mark.slow
@pytest.mark.parametrize("seed", sampled(1, [20, *range(20), *range(21, 30)]))
def test_directions_on_both_sides_of_a_region_of_cells(seed):
    program = program_of(seed)
    found = friction_cone(program)
    assert found.proved
    assert np.degrees(found.gap) <= 0.1
    random = np.random.default_rng(seed)
    directions = random.normal(size=(20, 3))
    rays = np.array([proof.vector for proof in found.proofs if proof.about == "ray"])
    if len(rays):
        directions[:15] = rays[random.integers(0, len(rays), 15)] + 0.02 * directions[:15]
    for down in unit_rows(directions):
        beyond = (found.facets @ down).min(initial=1.0) < -np.sin(found.slack + 1e-6)
        if found.cone.contains(down):
            assert judge(program.turned(down)).stable is not False
        elif beyond:
            assert judge(program.turned(down)).stable is not True


def stopping(after: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the time limit be reached after a number of searches side by side."""
    calls = []
    search = boundary_rays.many_shares

    def limited(*given: object, **named: object) -> object:
        calls.append(1)
        if len(calls) > after:
            raise TimeLimitReached
        return search(*given, **named)  # type: ignore[arg-type]

    monkeypatch.setattr(boundary_rays, "many_shares", limited)


@pytest.mark.parametrize(("after", "least"), sampled(1, [(1, 5.0), (2, 0.5), (3, 0.1)]))
def test_a_time_limit_leaves_a_coarse_region_with_its_gap(after, least, monkeypatch):
    stopping(after, monkeypatch)
    coarse = kilter.region(stacks.block_on_slope(0.0, friction=0.5))
    half = np.degrees(np.arctan(0.5))
    assert coarse.proved
    assert coarse.gap_deg is not None
    assert coarse.half_angle_deg is not None
    assert coarse.gap_deg > least
    assert coarse.half_angle_deg <= half <= coarse.half_angle_deg + coarse.gap_deg + 1e-6
    assert any("the time limit ended the search" in text for text in coarse.warnings)


def test_a_time_limit_of_nothing_tells_the_given_direction():
    with pytest.raises(TimeLimitReached, match="With gravity as given"):
        kilter.region(stacks.block_on_slope(0.0, friction=0.5), time_limit=0.0)
