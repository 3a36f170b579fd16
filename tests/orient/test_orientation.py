"""The answer in full: the orientation with the widest margin, or the nearest to stable."""

from __future__ import annotations

import dataclasses
import json

import numpy as np
import pytest
from free_form import free_form_on_a_floor
from transformations import as_single
from turning import ALL, angle_from_down, slot_and_float

import kilter
from kilter import InputError, Load, check
from kilter.analysis.turning.orientation import orient
from kilter.rigid import quaternion_to_matrix
from kilter.scenes import paper, scene, stacks, walls, wedges
from kilter.scenes.pieces import turn
from kilter.scenes.transform import moved

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
@PLANAR
@pytest.mark.parametrize(
    ("chamfer", "mass_b", "expected"),
    [(45, 1, 45.0), (60, 1, 60.0), (45, 2, 63.43494882), (60, 2, 73.89788625)],
)
def test_two_blocks_in_an_l(planar, chamfer, mass_b, expected):
    assembly = paper.two_blocks_in_an_l(chamfer, mass_b=mass_b, planar=planar)
    answer = proved(assembly, orient(assembly))
    assert angle_from_down(answer.down) == pytest.approx(expected, abs=1e-6)
    assert answer.tilt_margin_deg == 0.0
    assert answer.warnings


def test_figure_10_planar_has_a_margin():
    assembly = paper.figure_10(planar=True)
    answer = proved(assembly, orient(assembly))
    assert angle_from_down(answer.down) == pytest.approx(45.0, abs=1e-6)
    assert answer.tilt_margin_deg == pytest.approx(45.0, abs=1e-6)


@pytest.mark.quick(1)
@PLANAR
def test_figure_1_b_is_found(planar):
    assembly = paper.figure_1(planar=planar)
    answer = proved(assembly, orient(assembly))
    assert angle_from_down(answer.down) == pytest.approx(45.0, abs=1e-6)


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
def test_the_recommended_direction_has_no_components_from_rounding() -> None:
    """A wall of symmetric courses is recommended upright, whichever way it leans as given."""
    for degrees in (3.0, 5.0):
        leaning = walls.tilted_wall(degrees, courses=3, per_course=3)
        assert kilter.orient(leaning).down.tolist() == [0.0, 0.0, -1.0]
