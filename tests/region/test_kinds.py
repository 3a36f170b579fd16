"""Regions of gravity: their kinds, cones, figures of the paper, and several at once."""

import numpy as np
import pytest
from cones import (
    BUILDERS,
    KINDS,
    MORE,
    X,
    Z,
    directions,
    disagreements,
    region_of,
    same_rays,
    same_span,
)
from hypothesis import given
from hypothesis import strategies as st
from random_voronoi import random_voronoi
from transformations import as_single

import kilter
from kilter import Assembly, GivenContact, InputError, Part, Prism, common_region
from kilter.analysis.decision.judge import judge
from kilter.analysis.regions.growth import Reach, grow
from kilter.analysis.regions.polyhedral_cone import KINDS as ALL_KINDS
from kilter.analysis.regions.polyhedral_cone import Cone, make_cone, widest_axis
from kilter.analysis.verification import verify_proof
from kilter.contact import detect
from kilter.mechanics.certificate import check_forces, check_motion
from kilter.mechanics.locked_parts import LockedParts, find_locked_parts
from kilter.mechanics.program import Program, build_program
from kilter.scenes import paper, rails, stacks, wedges
from kilter.scenes.pieces import block, moved
from sampled import sampled


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", KINDS)
def test_closed_form(name):
    kind, build, lines, rays = KINDS[name]
    region = kilter.region(build())
    assert region.kind == kind
    assert same_span(region.lines, lines)
    assert same_rays(region.rays, rays)
    assert region.proved
    assert region.dimension == 3 - len(region.equations)


def test_every_kind_is_produced():
    assert {entry[0] for entry in KINDS.values()} == set(ALL_KINDS.values())


@pytest.mark.slow
@pytest.mark.parametrize("name", [*KINDS, *MORE])
def test_directions_one_by_one(name):
    region = region_of(name)
    assert not disagreements(region, directions(region, 100))


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", [*KINDS, *MORE])
def test_the_answer_describes_itself(name):
    """Equations, facets, rays and lines of the JSON answer are one and the same cone."""
    answer = region_of(name).to_dict()
    lines, rays, equations, facets = (
        np.array(answer[key]).reshape(-1, 3) for key in ("lines", "rays", "equations", "facets")
    )
    for rows in (lines, rays, equations, facets):
        assert np.allclose(np.linalg.norm(rows, axis=1), 1.0, atol=1e-12)
    assert np.abs(equations @ np.vstack([lines, rays, facets]).T).max(initial=0.0) < 1e-8
    assert np.abs(lines @ np.vstack([rays, facets]).T).max(initial=0.0) < 1e-8
    assert (facets @ rays.T).min(initial=0.0) > -1e-8
    assert np.allclose(lines @ lines.T, np.eye(len(lines)))
    assert np.allclose(equations @ equations.T, np.eye(len(equations)))
    _center_and_angle(answer, facets)


def _center_and_angle(answer: dict, facets: np.ndarray) -> None:
    kind, half = answer["kind"], answer["half_angle_deg"]
    fixed = {"none": None, "ray": 0, "line": 0, "half-plane": 90, "half-space": 90}
    fixed |= {"plane": 180, "all": 180}
    if kind in fixed:
        assert half == fixed[kind]
    else:
        assert np.degrees(np.arcsin((facets @ answer["center"]).min())) == pytest.approx(half)
    assert (answer["center"] is None) == (kind in ("none", "line", "plane", "all"))


@pytest.mark.slow
def test_planar_kinds():
    wanted = {"": "none", "-z": "ray", "-x +x": "line", "-x -z": "fan"}
    wanted |= {"-x +x -z": "half-plane", "-x +x -z +z": "plane"}
    for sides, kind in wanted.items():
        region = kilter.region(rails.railed(sides, planar=True))
        assert region.kind == kind
        assert np.abs(region.equations[:, 1]).max() == 1.0  # y, always
        assert np.abs(region.rays[:, 1]).max(initial=0.0) == 0.0
        assert not disagreements(region, directions(region, 50))


Array = np.ndarray


class RaysOracle:
    """The support of a cone that is given by its rays."""

    dimension = 3

    def __init__(self, rays: Array) -> None:
        self.rays = rays / np.linalg.norm(rays, axis=1, keepdims=True)
        self.asked = 0

    def support(self, direction: Array) -> Reach:
        self.asked += 1
        products = self.rays @ direction
        k = int(products.argmax())
        if products[k] <= 0:
            return Reach(0.0, np.zeros(3), np.zeros(0), np.zeros(0))
        return Reach(float(products[k]), self.rays[k], np.zeros(0), np.zeros(0))

    def focus(self, axis: Array) -> None:
        self.axis = axis


def cone_of(rays: Array) -> tuple[Cone, int]:
    oracle = RaysOracle(np.asarray(rays, dtype=float))
    grown = grow(oracle, np.array([0.0, 0.0, -1.0]), 1e-9, lambda: None)
    cone = make_cone(
        np.array([e for e, _, _ in grown.equations]),
        np.array([q for q, _ in grown.facets]),
        np.array([found.point for found in grown.points]),
        1e-9,
    )
    return cone, oracle.asked


@pytest.mark.slow
@given(st.integers(0, 10**6), st.integers(1, 12), st.sampled_from([0.01, 0.3, 1.0, 3.0]))
def test_a_cone_is_found_from_its_rays(seed, count, spread):
    random = np.random.default_rng(seed)
    axis = random.normal(size=3)
    axis /= np.linalg.norm(axis)
    rays = axis + spread * random.normal(size=(count, 3))
    rays /= np.linalg.norm(rays, axis=1, keepdims=True)
    cone, asked = cone_of(rays)
    assert cone.contains(rays).all()
    mixed = random.random((50, count)) @ rays
    assert cone.contains(mixed).all()
    for facet in cone.facets if count > 1 else ():
        assert (rays @ facet).min() == pytest.approx(0.0, abs=1e-8)
        outside = cone.rays[np.abs(cone.rays @ facet) < 1e-8].sum(axis=0) - 1e-3 * facet
        assert not cone.contains(outside)
    if cone.kind == "cone":
        assert asked <= len(cone.rays) + len(cone.facets) + 12


@pytest.mark.parametrize("tilt", [0.0, 1e-4, 1e-7])
def test_wide_fans_and_half_planes(tilt):
    rays = [[1.0, -tilt, 0], [-1.0, -tilt, 0], [0, -1.0, 0]]
    cone, _ = cone_of(rays)
    assert cone.kind == ("fan" if tilt else "half-plane")
    assert cone.half_angle_deg == pytest.approx(90 - np.degrees(tilt), abs=1e-9)


def test_rays_within_the_blur_are_one():
    cone, _ = cone_of([[0, 0, -1], [1e-10, 0, -1], [0, 1e-10, -1]])
    assert cone.kind == "ray"


@given(st.integers(0, 10**6), st.integers(1, 8))
def test_the_axis_has_the_widest_margin(seed, count):
    random = np.random.default_rng(seed)
    axis = random.normal(size=3)
    facets = random.normal(size=(count, 3))
    facets *= np.sign(facets @ axis)[:, None]
    facets /= np.linalg.norm(facets, axis=1, keepdims=True)
    best = widest_axis(facets)
    others = best + random.normal(size=(500, 3)) * 10.0 ** random.uniform(-6, 0, size=(500, 1))
    others /= np.linalg.norm(others, axis=1, keepdims=True)
    assert (facets @ best).min() >= (others @ facets.T).min(axis=1).max() - 1e-12


@given(st.integers(0, 10**6), st.integers(3, 20), st.floats(0.05, 0.6))
def test_the_axis_of_facets_around_a_facet_is_its_normal(seed, count, height):
    """Facets at one angle on all sides of a normal, which is itself a facet and touches nothing."""
    angle = np.random.default_rng(seed).uniform(0, 2 * np.pi, count)
    angle = np.append(angle, angle[0] + np.pi * np.array([2 / 3, 4 / 3]))
    flat = np.cos(height) * np.column_stack([np.cos(angle), np.sin(angle)])
    around = np.column_stack([flat, np.full(len(angle), -np.sin(height))])
    best = widest_axis(np.vstack([[0.0, 0.0, -1.0], around]))
    assert best == pytest.approx([0, 0, -1], abs=1e-9)


def test_shapes_of_directions():
    cone, _ = cone_of(-np.eye(3))
    assert cone.contains([-1, -1, -1]).shape == ()
    assert cone.contains(np.full((4, 5, 3), -1.0)).shape == (4, 5)
    with pytest.raises(ValueError, match="read-only"):
        cone.rays[0, 0] = 1.0


PAIRS = [
    ("-x +x -z", "-x -z +z", "fan"),
    ("-x +x -y +y -z", "-x -y -z", "cone"),
    ("-x +x -y +y -z", "-x +x -y +y +z", "plane"),
    ("-x +x", "-z +z", "none"),
    ("-x +x -z", "-x +x +z", "line"),
    ("-x +x -y +y -z +z", "-x +x -y +y -z +z", "all"),
    ("-x -y -z", "-x +y -z", "fan"),
    ("-x -y -z", "+x +y -z", "ray"),
]


@pytest.mark.slow
@pytest.mark.parametrize(("one", "other", "kind"), PAIRS)
def test_intersections(one, other, kind):
    both = [rails.railed(one), rails.railed(other, count=2)]
    region = common_region(both)
    assert region.kind == kind
    assert common_region(both[::-1]).kind == kind


@pytest.mark.slow
def test_a_plan_without_a_common_direction():
    region = common_region([paper.figure_11(), paper.figure_12()])
    assert region.kind == "none"
    assert "no direction is stable for all assemblies" in region.warnings[-1]
    assert region.warnings[0].startswith("assembly 1: ")


@pytest.mark.slow
def test_common_proofs_verify():
    region = common_region([rails.railed("-x +x -z", count=2), rails.railed("-x -y -z")])
    proofs = region.proofs()
    assert region.kind == "fan"
    # the rays in both assemblies; facets and equations in one of them
    assert sorted(proof.about for proof in proofs) == (
        ["equation"] * 2 + ["facet"] * 2 + ["ray"] * 4
    )
    for proof in proofs:
        answer = verify_proof(proof.assembly, detect.contacts(proof.assembly), proof.data)
        assert answer.holds


@pytest.mark.slow
def test_one_is_itself():
    assembly = wedges.corner_wedges()
    assert same_rays(common_region([assembly]).rays, list(kilter.region(assembly).rays))


def test_none_given():
    with pytest.raises(InputError, match="no assembly is given"):
        common_region([])


POSES = [([0.3, -0.5, 0.2, 0.7], [3, -2, 5]), ([0.9, 0.1, -0.4, 0.2], [0, 0, 0])]


@pytest.mark.quick(1)
@pytest.mark.parametrize("pose", [None, *range(len(POSES))])
@pytest.mark.parametrize("name", BUILDERS)
def test_float32_keeps_the_kind(name, pose):
    assembly = BUILDERS[name]()
    if pose is not None and not assembly.planar:
        assembly = moved(assembly, *POSES[pose])
    exact, rounded = kilter.region(assembly), kilter.region(as_single(assembly))
    assert rounded.kind == exact.kind
    blur = rounded.cone.blur
    assert blur < 2e-3
    assert same_span(rounded.lines, list(exact.lines), blur)
    warned = any("coordinates have limited accuracy" in text for text in rounded.warnings)
    assert warned == (name != "aside")  # which touches nothing
    # rays closer than the blur are one ray
    for ray in rounded.rays:
        assert np.linalg.norm(exact.rays - ray, axis=1).min() < 5 * blur


MICRO = np.radians(1e-6)
"""1e-6 degrees."""


@pytest.mark.quick(1)
@pytest.mark.parametrize("planar", [False, True])
@pytest.mark.parametrize(
    ("angle", "mass_a", "mass_b", "from_down"),
    [(45, 1, 1, 45.0), (60, 1, 1, 60.0), (45, 1, 2, 63.43494882), (60, 1, 2, 73.89788625)],
)
def test_figures_11_and_12(angle, mass_a, mass_b, from_down, planar):
    assembly = paper.two_blocks_in_an_l(angle, mass_a=mass_a, mass_b=mass_b, planar=planar)
    region = kilter.region(assembly)
    assert region.kind == "ray"
    assert region.half_angle_deg == 0.0
    ray = region.rays[0]
    assert np.degrees(np.arctan2(-ray[0], -ray[2])) == pytest.approx(from_down, abs=1e-6)
    closed = paper.stable_direction(angle, mass_a, mass_b)
    assert np.linalg.norm(ray - closed) < MICRO


@pytest.mark.quick(1)
@pytest.mark.parametrize("planar", [False, True])
@pytest.mark.parametrize("stable", [False, True])
def test_the_l_leans_as_far_as_it_is_turned(stable, planar):
    region = kilter.region(paper.two_blocks_in_an_l(60.0, stable=stable, planar=planar))
    wanted = -Z if stable else np.array([-np.sin(np.pi / 3), 0, -0.5])
    assert np.linalg.norm(region.rays[0] - wanted) < MICRO


@pytest.mark.parametrize("planar", [False, True])
def test_figure_10_is_a_fan(planar):
    region = kilter.region(paper.figure_10(planar=planar))
    assert region.kind == "fan"
    assert region.half_angle_deg == pytest.approx(45.0, abs=1e-9)
    assert same_rays(region.rays, [-X, -Z])


@pytest.mark.quick(1)
@pytest.mark.parametrize("planar", [False, True])
@pytest.mark.parametrize(("mass_a", "mass_b"), [(1.0, 1.0), (1.0, 2.0), (2.0, 1.0)])
def test_the_trapped_wedge(mass_a, mass_b, planar):
    region = kilter.region(paper.trapped_wedge(mass_a=mass_a, mass_b=mass_b, planar=planar))
    most = np.arctan(mass_a / mass_b)
    assert region.kind == "fan"
    assert region.half_angle_deg == pytest.approx(np.degrees(most) / 2, abs=1e-6)
    assert same_rays(region.rays, [-Z, np.array([-np.sin(most), 0, -np.cos(most)])], MICRO)


def test_the_loop_of_figure_9():
    assert kilter.region(paper.figure_9(planar=True)).kind == "plane"


@pytest.mark.quick(3)
@pytest.mark.parametrize("angle", [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6])
def test_ever_thinner(angle):
    """A cube on four points whose normals lean by `angle` [rad] and meet in its middle."""
    leans = np.array([[1, 0], [0, 1], [-1, 0], [0, -1]]) * np.sin(angle)
    normals = np.column_stack([leans, np.full(4, np.cos(angle))])
    base = block("base", [-1, -1, -2], [1, 1, -1], grounded=True)
    cube = block("cube", [-0.5, -0.5, -0.5], [0.5, 0.5, 0.5])
    contacts = [GivenContact(("base", "cube"), [-0.5 * n], n) for n in normals]
    region = kilter.region(Assembly([base, cube], contacts=contacts, detect=False))
    assert region.kind == "cone"
    assert same_rays(region.rays, list(-normals), 1e-9)
    assert region.proved
    half = np.arcsin(np.tan(angle) / np.sqrt(2 + np.tan(angle) ** 2))
    assert region.half_angle_deg == pytest.approx(np.degrees(half), rel=1e-9 / angle)


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", [*KINDS, *MORE])
def test_few_programs(name):
    region = region_of(name)
    assert region.programs <= len(region.rays) + len(region.facets) + 12


CELLS, ROUGH = (8, 25), (0.5, 0.84, 1.0)


def program_of(assembly: Assembly) -> Program:
    """The program of an assembly with the contacts of its geometry."""
    return build_program(assembly, kilter.contacts(assembly))


def wedge_in_gap(slope: float, friction: float) -> Assembly:
    """A wedge between two held blocks whose faces have a slope (tangent) from the vertical."""
    low, high = 0.5, 0.5 + slope
    wedge = Prism([[-low, 0], [low, 0], [high, 1], [-high, 1]], 1.0)
    right = Prism([[low, 0], [2, 0], [2, 1], [high, 1]], 1.0)
    left = Prism([[-low, 0], [-high, 1], [-2, 1], [-2, 0]], 1.0)
    parts = [Part("left", left, grounded=True), Part("right", right, grounded=True)]
    return Assembly([*parts, Part("wedge", wedge)], friction=friction)


@pytest.mark.parametrize("slope", [0.2, 0.7])
def test_wedge_locks_if_its_slope_is_below_friction(slope):
    for factor, free in ((1.001, 0), (0.999, 1)):
        locked = find_locked_parts(program_of(wedge_in_gap(slope, factor * slope)))
        assert int(locked.program.free.sum()) == free


def test_a_block_on_a_table_is_not_locked():
    program = program_of(stacks.block_on_slope(0.0, friction=0.5))
    assert find_locked_parts(program).program is program


def directions_near(program: Program, random: np.random.Generator) -> np.ndarray:
    """Six directions near gravity and six on the whole sphere."""
    directions = random.normal(size=(12, 3))
    directions[:6] = program.down + 0.3 * directions[:6]
    unit: np.ndarray = directions / np.linalg.norm(directions, axis=1)[:, None]
    return unit


def lifted_holds(locked: LockedParts, down: np.ndarray) -> tuple[bool | None, bool]:
    """Verdict of the smaller program in a direction, and whether its proof holds for the whole."""
    whole, small = locked.whole.turned(down), locked.program
    if not small.free.any():
        none = np.zeros((len(small.part_a), 3))
        return True, check_forces(whole, *locked.forces(down, none[:, 0], none)).holds
    judged = judge(small.turned(down))
    if judged.stable:
        given = judged.forces
        assert given is not None
        return True, check_forces(whole, *locked.forces(down, given.forces, given.friction)).holds
    assert judged.motion is not None
    return judged.stable, check_motion(whole, locked.motion(judged.motion.motion)).holds


@pytest.mark.parametrize("seed", sampled(2, [22, 20, 1, 5, 8, 9, 13, 14, 16, 18, 19, 23, 26, 28]))
def test_the_same_directions_are_held_with_proofs_of_the_whole(seed):
    program = program_of(random_voronoi(seed, CELLS, ROUGH))
    locked = find_locked_parts(program)
    for down in directions_near(program, np.random.default_rng(seed)):
        stable, holds = lifted_holds(locked, down)
        assert holds
        assert stable == judge(program.turned(down)).stable
