"""Programs of a map of places: shared columns, forces under several loads, first touches."""

from __future__ import annotations

import numpy as np
import shapely
from planks import bridge, overhang
from scipy.optimize import nnls

from kilter import Assembly, Box, Part, Pose
from kilter.analysis.placing.case_maps import case_prism
from kilter.analysis.placing.landings import Landings
from kilter.analysis.placing.place import box_to_place, place
from kilter.analysis.placing.placed_loads import PlacedLoads
from kilter.analysis.placing.upright_prisms import find_tops
from kilter.contact import detect
from kilter.mechanics.certificate import check_forces
from kilter.mechanics.forms import scaled_problem
from kilter.mechanics.load_checks import check_load_forces
from kilter.mechanics.program import build_program

AREAS = {1: shapely.box(-0.3, -0.2, -0.2, 0.3), 3: shapely.box(0.2, -0.2, 0.4, 0.3)}


def loads_on_bridge() -> PlacedLoads:
    assembly = bridge()
    prism, _ = case_prism(box_to_place([0.7, 0.5, 0.2], 1.5), "m")
    return PlacedLoads(build_program(assembly, detect.contacts(assembly)), prism, 0.0)


def test_shared_columns_are_those_of_the_whole_program() -> None:
    loads = loads_on_bridge()
    program, _ = loads.on_areas(AREAS, 0.1, np.array([0.05, 0.02]))
    whole, extended = scaled_problem(program), scaled_problem(program, loads.alone)
    assert extended.matrix.shape == whole.matrix.shape == (18, len(program.part_a))
    assert abs(extended.matrix - whole.matrix).max() < 1e-14
    assert np.abs(extended.right - whole.right).max() < 1e-14
    assert np.allclose(extended.frame, whole.frame)


def test_forces_under_several_loads_are_checked_as_one_by_one() -> None:
    """The forces of the first load balance it; under the other loads they do not."""
    loads = loads_on_bridge()
    program, wrenches = loads.on_areas(AREAS, 0.1, np.array([0.0, 0.05]))
    matrix = scaled_problem(program, loads.alone)
    forces = matrix.forces(nnls(matrix.matrix.toarray(), matrix.right)[0])
    shifts = np.array([[0.0, 0.0], [0.1, 0.0], [0.0, -1e-3]])
    more = np.tensordot(shifts, wrenches, axes=1)
    together = check_load_forces(program, more, np.tile(forces, (3, 1)))
    for load, proof in zip(more, together, strict=True):
        alone = check_forces(program.with_rows(applied=program.applied + load), forces)
        assert abs(proof.residual - alone.residual) <= 1e-12 * max(alone.residual, 1)
        assert proof.holds == alone.holds
        assert (proof.forces == alone.forces).all()
    assert [proof.holds for proof in together] == [True, False, False]


def test_places_of_a_first_touch_have_an_edge_of_the_top_in_common() -> None:
    """A part of length 1 begins to touch the top [0, 2] with its centre at -0.5."""
    base = Part("base", Box([2, 2, 1]), Pose([1, 0, -0.5]), grounded=True)
    tops = find_tops(Assembly([base]))
    prism, _ = case_prism(box_to_place([1, 1, 1], 1.0), "m")
    landings = Landings(tops, prism, 1e-6)
    low, high = np.array([-0.5, -0.1]), np.array([-0.3, 0.1])
    [area] = landings.areas(tops, low, high, any_place=False).values()
    assert np.allclose(area.bounds, [0, -0.4, 0, 0.4], atol=1e-8)
    assert not landings.areas(tops, low - [1e-3, 0], high, any_place=False)
    assert not landings.areas(tops, low - [0.4, 0], high - [0.2, 0], any_place=True)


def test_a_first_touch_of_a_support_is_decided_exactly() -> None:
    """A box over the gap of two tables stands from the first touch of the second table on.

    It touches both tables if its centre is within 0.2 of the middle, and its centre is then
    between them. Its places on a single table end at the edges of the tables.
    """
    tables = [
        Part(f"table-{k}", Box([2, 2, 1]), Pose([x, 0, -0.5]), mass=50)
        for k, x in enumerate((-1.3, 1.3))
    ]
    floor = Part("floor", Box([8, 4, 1]), Pose([0, 0, -1.5]), grounded=True)
    answer = place(Assembly([floor, *tables]), box_to_place([1, 1, 1], 1.0))
    [level] = [level for level in answer.levels if abs(level.height - answer.prism.below) < 1e-9]
    between = shapely.box(-0.2, -1, 0.2, 1)
    assert shapely.difference(between, level.stands).area < 1e-9
    beside = shapely.box(0.2, -1, 0.3, 1)
    assert shapely.difference(beside, level.falls).area < 1e-9
    assert answer.programs < 100


def test_a_pair_that_decides_is_the_reason_of_open_places() -> None:
    """A held part just above the far end of a plank may hold it down, or not touch it."""
    plank = overhang(1, 2, 0.3)
    part = box_to_place([1e-3, 1e-3, 0.1], 2.5)
    for gap, warned in ((1e-4, True), (0.05, False)):
        clamp = Part("clamp", Box([0.2, 1, 1]), Pose([-0.7, 0, 0.6 + gap]), grounded=True)
        answer = place(plank.with_parts([clamp]), part)
        text = " ".join(answer.warnings)
        assert ("'plank' and 'clamp' touch" in text) == warned
        [level] = [
            level for level in answer.levels if abs(level.height - answer.prism.below - 0.1) < 1e-9
        ]
        # without the clamp the limit is 0.16, and the end of the plank is at 0.3
        assert level.stands.bounds[2] <= 0.16 + 1e-9
        open_area = shapely.intersection(level.open, shapely.box(0.17, -0.4, 0.29, 0.4)).area
        assert (open_area > 0.09) == warned
