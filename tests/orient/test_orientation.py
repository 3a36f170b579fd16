"""Orientations that are found, and worked by hand."""

import dataclasses
import json
import math

import numpy as np
import pytest
from free_form import free_form_on_a_floor
from scipy.spatial.transform import Rotation
from transformations import as_single
from turning import ALL, program_of, slot_and_float

import kilter
from kilter import Assembly, InputError, Load, Part, check, orient
from kilter.analysis.turning.least_instability import LIMIT, least_instability
from kilter.rigid import quaternion_to_matrix
from kilter.scenes import paper, scene, stacks, walls, wedges
from kilter.scenes.pieces import block, moved, turn

PLANAR = pytest.mark.parametrize("planar", [False, True])


def proved(assembly, answer):
    """The answer holds: `down` is stable, and the rotation takes it to the file's gravity."""
    assert answer.verdict == "found"
    assert answer.judgement.forces.holds
    assert check(assembly.with_down(answer.down)).first_order == "stable"
    turned_to = quaternion_to_matrix(answer.rotation) @ answer.down
    assert turned_to == pytest.approx(assembly.down, abs=1e-12)
    assert (answer.z, answer.instability, answer.nearest, answer.check) == (0.0, 0.0, None, None)
    if assembly.planar:
        assert answer.rotation[[1, 3]] == pytest.approx([0.0, 0.0], abs=1e-15)
    return answer


@pytest.mark.slow
def test_a_cone_has_its_widest_margin():
    assembly = wedges.corner_boxes(2)
    answer = proved(assembly, orient(assembly))
    assert answer.down == pytest.approx(-np.ones(3) / np.sqrt(3), abs=1e-9)
    # to a face of the octant
    assert answer.tilt_margin_deg == pytest.approx(np.degrees(np.arcsin(1 / np.sqrt(3))), abs=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("method", ["joint", "walk"])
@pytest.mark.parametrize("name", ["wedge-on-wedge", "pile-turned", "floating-block"])
def test_none_is_stable(name, method):
    assembly = ALL[name]()
    answer = orient(assembly, method=method)
    assert answer.verdict == "none"
    assert not answer.found
    assert answer.judgement.motion.holds
    assert answer.down == pytest.approx(answer.nearest.diamond.direction)
    there = check(assembly.with_down(answer.down))
    assert there.verdict == "unstable"
    assert answer.z == pytest.approx(there.displacement.z, rel=1e-9)
    assert answer.instability == pytest.approx(there.motion.instability, rel=1e-6)
    data = answer.to_dict()
    assert data["parts"] == there.to_dict()["parts"]
    assert any(part["moves"] for part in data["parts"])
    near = data["nearest"]
    # gravity on the diamond is shorter than 1, so z there is nearer to 0
    length = np.abs(answer.down).sum()
    assert near["diamond"]["value"] * length == pytest.approx(answer.z, rel=1e-7)
    assert near["sphere"]["value"] >= answer.z - 1e-9 * abs(answer.z)
    assert near["kappa"]["value"] <= answer.instability + 1e-6
    assert near["kappa"]["bound"] <= near["kappa"]["value"]
    json.dumps(data, allow_nan=False)


@pytest.mark.slow
def test_a_part_that_touches_nothing_is_named():
    answer = orient(scene("floating-block"))
    assert answer.verdict == "none"
    assert any("touches nothing" in text for text in answer.warnings)


@pytest.mark.slow
def test_what_is_not_modelled_and_could_hold_it_leaves_it_undecided():
    """A free form on a floor: the contact is not modelled."""
    answer = orient(free_form_on_a_floor())
    assert answer.verdict == "undecided"
    assert answer.sentence.startswith("Undecided: ")
    assert answer.nearest is not None


@pytest.mark.slow
def test_a_direction_found_without_friction_holds_with_it():
    smooth, rough = (orient(stacks.tower(2).with_friction(mu)) for mu in (0.0, 0.4))
    assert smooth.found
    assert rough.found
    assert rough.friction
    assert rough.stable_region.contains(smooth.down)
    assert rough.tilt_margin_deg > smooth.tilt_margin_deg


@pytest.mark.slow
def test_locked_in_the_plane_it_stays_as_it_is():
    assembly = paper.figure_9(planar=True)
    answer = proved(assembly, orient(assembly))
    assert answer.down == pytest.approx(assembly.down)
    assert answer.rotation == pytest.approx([1, 0, 0, 0])
    assert answer.tilt_margin_deg == 180.0


@PLANAR
def test_a_slot_is_stable_across_it_and_turned_as_little_as_can_be(planar):
    whole = slot_and_float(planar)
    slot = dataclasses.replace(whole, parts=[p for p in whole.parts if p.name != "floater"])
    assembly = slot.with_down([0.3, 0, 1.0])
    answer = proved(assembly, orient(assembly))
    assert answer.down == pytest.approx([0, 0, 1], abs=1e-9)
    assert answer.tilt_margin_deg == 0.0


@PLANAR
def test_upside_down_is_a_half_turn(planar):
    assembly = dataclasses.replace(stacks.tower(2), planar=planar).with_down([0, 0, 1])
    answer = proved(assembly, orient(assembly))
    about = [0, 0, 1, 0] if planar else [0, 1, 0, 0]
    assert np.abs(answer.rotation) == pytest.approx(about, abs=1e-12)


@pytest.mark.slow
def test_a_tower_of_rounded_coordinates_is_found():
    assembly = as_single(moved(stacks.tower(3), turn([1, 2, 3], 40), [5, 6, 7]))
    answer = orient(assembly)
    assert answer.verdict == "found"


def test_nothing_is_free():
    assembly = stacks.tower(2).with_grounded(["*"])
    answer = orient(assembly)
    assert answer.found
    assert answer.down == pytest.approx(assembly.down)
    assert any("every part is held" in text for text in answer.warnings)


def test_wrong_input_is_refused():
    loaded = dataclasses.replace(stacks.tower(2), loads=[Load("cube-1", [0, 0, -1])])
    with pytest.raises(InputError, match=r"cube-1.*does not turn"):
        orient(loaded)
    parts = [dataclasses.replace(part, grounded=False) for part in stacks.tower(2).parts]
    with pytest.raises(InputError, match="held"):
        orient(dataclasses.replace(stacks.tower(2), parts=parts))
    with pytest.raises(InputError, match="'newton'"):
        orient(stacks.tower(2), method="newton")


@pytest.mark.slow
def test_the_recommended_direction_has_no_components_from_rounding():
    """A wall of symmetric courses is recommended upright, whichever way it leans as given."""
    for degrees in (3.0, 5.0):
        leaning = walls.tilted_wall(degrees, courses=3, per_course=3)
        assert kilter.orient(leaning).down.tolist() == [0.0, 0.0, -1.0]


WALLS = [
    block("floor", [-100, -100, -100], [200, 200, 0], grounded=True),
    block("left", [-100, -100, 0], [0, 200, 200], grounded=True),
    block("back", [0, -100, 0], [200, 0, 200], grounded=True),
]
CUBE = block("cube", [0, 0, 0], [100, 100, 100], density=2000.0)
HALF = math.degrees(math.asin(1 / math.sqrt(3)))
"""Angle between the axis of the corner and its walls."""


def found(*parts: Part, ask=kilter.orient) -> dict:
    return ask(Assembly([*WALLS, *parts], units="mm")).to_dict()


def test_a_cube_rests_in_a_corner_with_its_axis_along_gravity():
    answer = found(CUBE)
    assert answer["down"] == pytest.approx([-1 / math.sqrt(3)] * 3, abs=1e-9)
    assert answer["tilt_margin_deg"] == pytest.approx(HALF, abs=1e-6)
    assert answer["region"]["half_angle_deg"] == pytest.approx(HALF, abs=1e-6)
    w, *xyz = answer["rotation"]
    turn = Rotation.from_quat([*xyz, w])
    assert turn.apply(answer["down"]) == pytest.approx([0, 0, -1])
    # the least turn: about an axis across both directions, by the angle between them
    assert turn.magnitude() == pytest.approx(math.acos(1 / math.sqrt(3)))
    assert (answer["z"], answer["instability"]) == (0, 0)
    assert answer["residual"] <= 1e-9


@pytest.mark.slow
def test_a_cube_that_floats_beside_it_falls_in_every_direction():
    """A load of 2 kg beside 2 kg in the corner: z = -2 |g| by the 1-norm, kappa^2 = 2 / 4."""
    floating = block("floater", [120, 120, 120], [220, 220, 220], density=2000.0)
    answer = found(CUBE, floating)
    nearest = answer["nearest"]
    # per freedom at most 1 mm: the load of the floater is -z = 2 kg (|gx| + |gy| + |gz|)
    assert nearest["diamond"]["value"] == pytest.approx(-2)
    assert np.abs(nearest["diamond"]["direction"]).sum() == pytest.approx(1)
    for name in ("sphere", "diamond"):
        motion = np.array(nearest[name]["motion"])
        assert np.abs(motion).max() <= 1 + 1e-9
        gained = 2 * (motion[3:, :3] @ nearest[name]["direction"]).sum()
        assert gained == pytest.approx(-nearest[name]["value"])
    # the 1-norm is least on the sphere along an axis
    assert nearest["sphere"]["value"] == pytest.approx(-2)
    assert np.linalg.norm(nearest["sphere"]["direction"]) == pytest.approx(1)
    kappa = nearest["kappa"]
    assert kappa["value"] == pytest.approx(math.sqrt(0.5), abs=1e-6)
    # kappa is the same in the whole octant, so the search ends at its limit of programs, with a
    # bound that depends on the order of the corners; with twice as many the gap is below 1e-3
    program = program_of(Assembly([*WALLS, CUBE, floating], units="mm"))
    assert kappa["bound"] == pytest.approx(least_instability(program).bound, abs=1e-9)
    finer = least_instability(program, limit=2 * LIMIT).bound
    assert kappa["bound"] <= finer <= math.sqrt(0.5)
    assert math.sqrt(0.5) - 1e-3 <= finer
    fallen = np.array(kappa["motion"])
    assert fallen[4, :3] == pytest.approx(9.81 * np.array(kappa["direction"]), abs=1e-6)
    assert fallen[3] == pytest.approx([0] * 6, abs=1e-6)
    assert answer["instability"] == pytest.approx(math.sqrt(0.5))
    # at the named orientation only the floater falls, at g
    cube, floater = answer["parts"][3:]
    assert floater["acceleration"] == pytest.approx([*(9.81 * np.array(answer["down"])), 0, 0, 0])
    assert (floater["mass"], floater["relative"]) == (2, pytest.approx([1, 0]))
    assert cube["acceleration"] == pytest.approx([0] * 6, abs=1e-9)
    assert floater["displacement"][:3] == pytest.approx(answer["down"], abs=1e-9)
    assert answer["z"] == pytest.approx(-2)


def test_a_second_cube_at_a_gap_has_the_region_of_the_corner_if_it_is_joined():
    near = block("near", [100.01, 0, 0], [200.01, 100, 100])
    answer = found(CUBE, near, ask=kilter.region)
    (pair,) = answer["open_pairs"]
    assert pair["gap"] == pytest.approx(1e-2)
    joined = answer["if_joined"]
    for key in ("rays", "facets"):
        assert np.array(sorted(joined[key])) == pytest.approx(-np.eye(3), abs=1e-6)
    assert (joined["lines"], joined["equations"]) == ([], [])
    assert joined["half_angle_deg"] == pytest.approx(HALF, abs=1e-6)


def test_a_second_cube_in_a_channel_has_the_region_of_the_channel_if_it_is_joined():
    """Walls on both sides along x: gravity lies in the plane of x and z, not upward."""
    right = block("right", [100, -100, 0], [200, 300, 200], grounded=True)
    parts = [WALLS[0], WALLS[1], right, CUBE, block("near", [0, 100.01, 0], [100, 200.01, 100])]
    joined = kilter.region(Assembly(parts, units="mm")).to_dict()["if_joined"]
    assert np.abs(joined["lines"]) == pytest.approx(np.array([[1, 0, 0]]), abs=1e-9)
    assert np.abs(joined["equations"]) == pytest.approx(np.array([[0, 1, 0]]), abs=1e-9)
    for key in ("rays", "facets"):
        assert np.array(joined[key]) == pytest.approx(np.array([[0, 0, -1]]), abs=1e-9)
