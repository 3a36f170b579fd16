"""Directions that friction can hold: closed forms, `judge` on both sides, and limits."""

import numpy as np
import pytest
from margins import program_of, small_assembly

import kilter
from kilter.analysis.decision.judge import judge
from kilter.analysis.regions.cone_cutting import friction_cone
from kilter.analysis.regions.polyhedral_cone import widest_axis
from kilter.analysis.regions.stable_cone import stable_cone
from kilter.errors import InputError
from kilter.scenes import arches, friction, stacks
from kilter.scenes.pieces import block, floor, moved, turn


def table(mu: float, **options) -> kilter.Assembly:
    """A flat block on a table."""
    parts = [floor([-5, -5], [5, 5]), block("slab", [-2, -2, 0], [2, 2, 0.5])]
    return kilter.Assembly(parts, friction=mu, **options)


def test_a_cone_narrower_than_the_gap_has_an_end():
    # no direction that bounds it is far enough from gravity for an arc
    found = friction_cone(program_of(table(0.001)))
    assert np.degrees(found.gap) <= 0.1
    assert found.cone.half_angle_deg <= np.degrees(np.arctan(0.001)) + 1e-6


@pytest.mark.slow
@pytest.mark.parametrize("mu", [0.05, 0.5, 1.5])
def test_a_block_on_a_table_has_a_circular_cone(mu):
    found = friction_cone(program_of(table(mu)))
    half = np.degrees(np.arctan(mu))
    assert not found.exact
    assert np.degrees(found.gap) <= 0.1
    assert half - 0.1 <= found.cone.half_angle_deg <= half + 1e-6
    assert found.cone.center == pytest.approx([0, 0, -1], abs=1e-3)
    # every ray inside, every facet outside the circle
    assert (-found.cone.rays[:, 2] >= np.cos(np.radians(half)) - 1e-9).all()
    sine = found.facets @ [0, 0, -1.0]
    assert (np.degrees(np.arcsin(sine)) >= half - np.degrees(found.slack) - 1e-6).all()
    assert found.proved


@pytest.mark.quick(2)
@pytest.mark.parametrize(("depth", "mu"), [(0.4, 1.5), (0.6, 0.9), (4.0, 0.3)])
def test_only_the_widest_cone_is_refined(depth, mu):
    """A panel of height 2 tips across its depth at atan(depth / 2), and slides at atan(mu)."""
    panel = [floor([-5, -5], [5, 5]), block("panel", [0, 0, 0], [4, depth, 2])]
    program = program_of(kilter.Assembly(panel, friction=mu))
    half = np.degrees(min(np.arctan(depth / 2), np.arctan(mu)))
    found, whole = friction_cone(program, widest=True), friction_cone(program)
    assert half - 0.1 <= found.cone.half_angle_deg <= half + 1e-6
    outer = np.degrees(np.arcsin((found.facets @ widest_axis(found.facets)).min()))
    assert half - 1e-6 <= outer <= found.cone.half_angle_deg + 0.1
    assert found.proved
    assert found.programs < whole.programs if depth < 1 else found.programs <= whole.programs
    # gravity that no forces hold: no arc begins there
    found = friction_cone(program.turned([0, 1, -0.01]), widest=True)
    assert half - 0.1 <= found.cone.half_angle_deg <= half + 1e-6


def test_a_recommended_direction_near_an_axis_that_is_as_good_is_the_axis():
    """The middle of a search comes to within rounding of the axis; a stack that leans does not."""
    assert kilter.region(table(0.5)).center.tolist() == [0, 0, -1]
    leaning = moved(stacks.tower(2), turn([0, 1, 0], np.degrees(5e-6)))
    assert kilter.region(leaning).center == pytest.approx([-5e-6, 0, -1], abs=1e-8)


@pytest.mark.parametrize("mu", [0.2, 0.7])
def test_in_a_plane_it_is_exact(mu):
    found = friction_cone(program_of(table(mu, planar=True)))
    assert found.exact
    assert found.gap == 0.0
    assert found.cone.kind == "fan"
    assert found.cone.half_angle_deg == pytest.approx(np.degrees(np.arctan(mu)), abs=1e-7)
    assert found.proved


def test_every_facet_of_a_planar_arch_has_its_proof():
    """A simplex leaves enough of a violation that some motions must be mended."""
    found = friction_cone(program_of(arches.arch(20, ratio=0.15, friction=0.7)))
    assert len(found.proofs) == 4
    assert found.proved


def beyond(found, directions):
    """Whether unit directions are beyond a facet, so proved not to be held."""
    if found.exact:
        return ~found.cone.contains(directions)
    return -(directions @ found.facets.T).min(axis=1, initial=np.inf) > np.sin(found.slack)


def agrees_with_judge(assembly, count, seed=0):
    """Directions all around, and near the boundary; those within the gap are left out."""
    program = program_of(assembly)
    found = friction_cone(program, gap_deg=0.3)
    size = float(np.linalg.norm(program.gravity))
    random = np.random.default_rng(seed)
    directions = random.normal(size=(count, 3))
    rays = np.array([proof.vector for proof in found.proofs if proof.about == "ray"])
    near = rays[random.integers(0, len(rays), size=count)]
    scatter = random.uniform(0, 0.2, size=(count, 1))
    directions = np.where(random.random((count, 1)) < 0.7, near + scatter * directions, directions)
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    held, excluded = found.cone.contains(directions), beyond(found, directions)
    assert not (held & excluded).any()
    for down, inside, outside in zip(directions, held, excluded, strict=True):
        if inside or outside:
            assert judge(program.with_rows(gravity=size * down)).stable is bool(inside)
    return held, excluded


SCENES = {
    "table": lambda: table(0.4),
    "tower": lambda: stacks.tower(2, friction=0.7),
    "trough": lambda: friction.trough(),
    "pile": lambda: small_assembly(4),
    "leaning-plates": lambda: friction.a_block(20.0, friction=0.3),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", SCENES)
def test_membership_agrees_with_judge(name):
    held, excluded = agrees_with_judge(SCENES[name](), 60)
    assert (held | excluded).mean() > 0.8


@pytest.mark.slow
def test_without_friction_it_is_the_polyhedral_cone_and_near_it_with_little():
    """Three boxes in a corner: a cone with a tip; friction 1e-3 widens it by about 0.057 deg."""
    from kilter.scenes import wedges

    program = program_of(wedges.corner_boxes(1))
    exact = stable_cone(program).cone
    assert friction_cone(program).cone.rays == pytest.approx(exact.rays)
    rough = program.with_rows(mu=np.full(len(program.mu), 1e-3))
    found = friction_cone(rough, gap_deg=0.02)
    assert not beyond(found, exact.rays).any()
    sine = (found.cone.rays @ exact.facets.T).min()
    assert -3e-3 < sine < 0
    assert exact.half_angle_deg < found.cone.half_angle_deg < exact.half_angle_deg + 0.2


@pytest.mark.slow
def test_kinds_wider_than_a_cone():
    """Squeezed between walls any direction is held; a free block none."""
    assert friction_cone(program_of(friction.h_block(friction=0.5))).cone.kind == "all"
    loose = kilter.Assembly(
        [
            floor([-1, -1], [1, 1]),
            block("a", [0, 0, 2], [1, 1, 3]),
            block("b", [0, 0, 3], [1, 1, 4]),
        ],
        friction=0.5,
    )
    region = kilter.region(loose)
    assert region.kind == "none"
    assert region.none
    assert kilter.orient(loose).verdict == "none"


def test_loads_are_refused():
    program = program_of(table(0.5))
    applied = program.applied.copy()
    applied[1, 0] = 1.0
    with pytest.raises(InputError, match="not a cone"):
        friction_cone(program.with_rows(applied=applied))


@pytest.mark.slow
def test_orient_takes_the_middle_and_says_what_it_promises():
    answer = kilter.orient(stacks.block_on_slope(35.0, friction=0.5))
    assert answer.found
    normal = -np.array([np.sin(np.radians(35)), 0, np.cos(np.radians(35))])
    assert answer.down == pytest.approx(normal, abs=2e-3)
    assert answer.tilt_margin_deg == pytest.approx(np.degrees(np.arctan(0.5)), abs=0.1)
    assert "Forces that hold it exist" in answer.sentence


@pytest.mark.quick(1)
@pytest.mark.parametrize("mu", [0.3, 0.8])
def test_a_line_of_contact_has_a_fan(mu):
    """A wedge on its edge: held along the edge, within the angle of friction."""
    wedge = kilter.Part("wedge", kilter.Prism([[0, 0], [1, 1], [-1, 1]], 2))
    region = kilter.region(kilter.Assembly([floor([-5, -5], [5, 5]), wedge], friction=mu))
    assert region.kind == "fan"
    assert region.proved
    assert np.abs(region.equations) == pytest.approx(np.array([[1, 0, 0]]), abs=1e-6)
    assert region.half_angle_deg == pytest.approx(np.degrees(np.arctan(mu)), abs=1e-3)
