"""The stability map and the least instability of all directions."""

import numpy as np
import pytest
from turning import ALL, UNSTABLE, directions, on_facets, program_of, slot_and_float

from kilter import InputError, Load, SolverError
from kilter.analysis.regions.enclose import GrowingHull
from kilter.analysis.turning.facet_program import joint, nearest
from kilter.analysis.turning.least_instability import least_instability
from kilter.analysis.turning.reachable import nearest_on_sphere
from kilter.analysis.turning.stability_map import stability_map
from kilter.analysis.turning.virtual_work import VirtualWork
from kilter.mechanics.forms import displacement, impending_motion, scaled_problem
from kilter.scenes import paper, scene, stacks, wedges
from kilter.solvers.clarabel import solve_quadratic
from kilter.solvers.highs import solve_linear
from sampled import sampled

BIG = {"short-base-turned"}
SMALL = [name for name in ALL if name not in BIG]


def z_error(name, count):
    """Greatest difference of z between the map and LP (9), over the mass."""
    program = program_of(name)
    found, work = stability_map(program), VirtualWork(program)
    g = on_facets(program, count)
    lp = np.array([work.solve(d).z for d in g])
    assert found.dimension == 3 - len(found.equations)
    return float(np.abs(found.z(g) / found.mass - lp).max())


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", SMALL)
def test_z_from_the_map_is_that_of_lp_9(name):
    assert z_error(name, 100) <= 1e-8


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", ["paper-figure-8", "arch-7", "tower", "wedge-on-wedge"])
def test_z_is_that_of_lp_9_as_published(name):
    program = program_of(name)
    found = stability_map(program)
    for g in directions(program, 20):
        turned = program.with_rows(gravity=9.81 * g)
        z = solve_linear(displacement(turned)).objective
        assert found.z(g) == pytest.approx(z, abs=1e-8 * found.mass)


@pytest.mark.quick(2)
@pytest.mark.parametrize("name", ["paper-figure-8", "arch", "tower-turned", "wedges-4"])
def test_vertices_facets_and_partitions_fit_together(name):
    program = program_of(name)
    found = stability_map(program)
    inside = found.vertices @ found.normals.T - found.offsets
    assert inside.max() <= 1e-7 * found.mass
    for k, corners in enumerate(found.facets):
        assert len(corners) >= found.dimension
        assert np.abs(inside[corners, k]).max() <= 1e-7 * found.mass
    if found.dimension == 3:  # Euler
        edges = sum(len(corners) for corners in found.facets) // 2
        assert len(found.vertices) - edges + len(found.facets) == 2
    # inside a partition one vertex is best
    random = np.random.default_rng(0)
    for vertex in range(0, len(found.vertices), 7):
        rays = found.partition(vertex)
        g = random.dirichlet(np.ones(len(rays)), size=5) @ rays
        assert ((g @ found.vertices.T).argmax(axis=1) == vertex).all()


@pytest.mark.parametrize(
    ("assembly", "dimension"),
    [
        (paper.figure_9(planar=True), 0),  # locked in a frame
        (scene("squeezed-block"), 2),  # planar
        (stacks.tower(2), 3),
    ],
)
def test_flat_polytopes(assembly, dimension):
    found = stability_map(program_of(assembly))
    assert found.dimension == dimension
    assert found.nearest is None


def test_a_slot_makes_a_segment():
    from turning import slot_and_float

    whole = slot_and_float(True)
    import dataclasses

    slot = dataclasses.replace(whole, parts=[p for p in whole.parts if p.name != "floater"])
    found = stability_map(program_of(slot))
    assert found.dimension == 1
    assert sorted(found.vertices[:, 0]) == pytest.approx([-found.mass, found.mass])
    assert found.z([[0, 0, -1.0], [1, 0, 0], [-0.5, 0, 0.5]]) == pytest.approx(
        [0.0, -found.mass, -found.mass / 2]
    )


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", UNSTABLE)
def test_the_nearest_on_the_sphere_is_exact(name):
    program = program_of(name)
    best, found = nearest_on_sphere(program), stability_map(program)
    scale = found.mass
    assert best is not None
    assert found.nearest is not None
    assert best.z == pytest.approx(found.nearest[1], abs=1e-8 * scale)
    assert best.programs <= found.programs
    assert np.linalg.norm(best.direction) == pytest.approx(1.0, abs=1e-12)
    there = VirtualWork(program).solve(best.direction).z * scale
    assert there == pytest.approx(best.z, abs=1e-8 * scale)
    dense = found.z(directions(program, 20_000))
    assert dense.max() <= best.z + 1e-8 * scale
    near = best.direction + 1e-3 * directions(program, 500, seed=1)
    near /= np.linalg.norm(near, axis=1)[:, None]
    assert found.z(near).max() <= best.z + 1e-8 * scale


@pytest.mark.quick(2)
@pytest.mark.parametrize("name", [n for n in SMALL if n not in UNSTABLE])
def test_where_a_direction_is_stable_there_is_no_nearest(name):
    program = program_of(name)
    assert nearest_on_sphere(program) is None
    assert joint(program).z == pytest.approx(0.0, abs=1e-9 * stability_map(program).mass)


def test_a_limit_ends_a_map_that_is_too_large():
    with pytest.raises(SolverError, match="more than 50 programs"):
        stability_map(program_of(wedges.corner_wedges(6)), limit=50)


def test_nothing_is_free():
    found = stability_map(program_of(stacks.tower(2).with_grounded(["*"])))
    assert found.dimension == 0
    assert found.z([[0, 0, -1.0]]) == pytest.approx([0.0])


def test_loads_are_refused():
    import dataclasses

    loaded = dataclasses.replace(stacks.tower(2), loads=[Load("cube-1", [0, 0, -1])])
    with pytest.raises(InputError, match="cube-1"):
        stability_map(program_of(loaded))


@pytest.mark.parametrize("size", [1, 2, 3])
def test_a_growing_hull_is_that_of_all_points(size):
    from scipy.spatial import ConvexHull

    random = np.random.default_rng(size)
    points = random.normal(size=(60, size))
    hull = GrowingHull(points[: size + 1], 1e-12)
    for point in points[size + 1 :]:
        hull.add(point)
    used = {tuple(hull.points[k]) for k in np.unique(hull.facets)}
    if size == 1:
        expected = {tuple(points.min(axis=0)), tuple(points.max(axis=0))}
    else:
        expected = {tuple(points[k]) for k in ConvexHull(points).vertices}
    assert used == expected
    assert (points @ hull.normals.T <= hull.offsets + 1e-9).all()


def kappa_at(program, direction):
    """Kappa of one direction, by a program built for it alone."""
    quadratic = impending_motion(scaled_problem(program.turned(direction)))
    answer = solve_quadratic(quadratic, tolerance=1e-10)
    assert answer.residual < 1e-7
    mass = program.mass[program.free]
    return np.sqrt(answer.x @ (quadratic.quadratic @ answer.x) / (mass.sum() / mass.max()))


@pytest.mark.slow
@pytest.mark.parametrize("name", sampled(8, UNSTABLE))
def test_value_and_bound_meet_and_no_direction_is_below(name):
    program = program_of(name)
    best = least_instability(program)
    assert best.value - best.bound <= 1e-3
    assert best.bound <= best.value
    there = kappa_at(program, best.direction)
    assert there == pytest.approx(best.value, abs=1e-6)
    sample = np.vstack(
        [
            directions(program, 60),
            best.direction + 0.03 * directions(program, 20, seed=1),
        ]
    )
    kappa = [kappa_at(program, g) for g in sample]
    assert min(kappa) >= best.bound - 1e-7


@pytest.mark.parametrize("planar", [False, True])
def test_a_slider_and_a_floater_of_twice_its_mass(planar):
    # the slider falls only along x: kappa^2 = (2 + g_x^2) / 3, least on a whole circle
    assembly = slot_and_float(planar)
    best = least_instability(program_of(assembly))
    assert best.value == pytest.approx(np.sqrt(2 / 3), abs=1e-3)
    assert best.bound == pytest.approx(np.sqrt(2 / 3), abs=1e-3)
    assert abs(best.direction[0]) < 0.06


def test_where_a_direction_is_stable_it_is_0():
    best = least_instability(program_of(stacks.tower(2)))
    assert best.value == pytest.approx(0.0, abs=1e-6)
    assert best.direction == pytest.approx([0, 0, -1], abs=1e-6)


def test_nothing_is_free_least_instability():
    best = least_instability(program_of(stacks.tower(2).with_grounded(["*"])))
    assert (best.value, best.bound, best.programs) == (0.0, 0.0, 0)


def test_a_limit_leaves_a_bound_that_holds():
    program = program_of("slot-and-float")
    best = least_instability(program, gap=0.0, limit=12)
    assert best.programs <= 12
    assert best.bound <= np.sqrt(2 / 3) <= best.value + 1e-9


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", ["wedge-on-wedge", "arch", "floating-block"])
def test_the_motion_that_remains_is_the_one_of_that_direction(name):
    program = program_of(name)
    near = nearest(program)
    for sense in (near.diamond, near.sphere):
        g = sense.direction / (np.abs(sense.direction).sum() if sense is near.diamond else 1.0)
        work = -(program.mass[:, None] * sense.motion[:, :3]).sum(axis=0) @ g
        assert work == pytest.approx(sense.value, rel=1e-7)
        assert program.velocities(sense.motion).min(initial=0.0) > -1e-7
    energy = program.mass @ (near.kappa.motion[:, :3] ** 2).sum(axis=1)
    assert energy > 0
    assert near.kappa.bound <= near.kappa.value
