"""Degenerate input and what a region says about it."""

import dataclasses

import numpy as np
import pytest
from free_form import free_form_on_a_floor

import kilter
from kilter.analysis.regions.cone_cutting import friction_cone
from kilter.analysis.regions.stable_cone import stable_cone
from kilter.assembly import Assembly, Joint, Load, Part
from kilter.contact import detect
from kilter.errors import InputError
from kilter.mechanics.program import build_program
from kilter.rigid import Pose
from kilter.scenes import rails, stacks
from kilter.scenes import traps as rounds
from kilter.scenes.pieces import block
from kilter.shape.primitives import Box


def test_no_free_part():
    held = block("a", [0, 0, 0], [1, 1, 1], grounded=True)
    region = kilter.region(Assembly([held]))
    assert (region.kind, region.programs) == ("all", 0)
    assert region.contains([[1, 2, 3], [0, 0, 1]]).all()
    assert any("every part is held" in text for text in region.warnings)
    flat = kilter.region(Assembly([held], planar=True))
    assert flat.kind == "plane"
    assert flat.equations.tolist() == [[0.0, 1.0, 0.0]]


def test_loads_are_refused():
    assembly = dataclasses.replace(stacks.tower(2), loads=[Load("cube-1", force=[0, 0, -1])])
    with pytest.raises(InputError, match="loads are given"):
        kilter.region(assembly)


def test_loads_on_held_parts_are_refused():
    with pytest.raises(InputError, match="a load acts on a held part"):
        dataclasses.replace(stacks.tower(2), loads=[Load("base", force=[0, 0, -1])])


def test_nothing_held():
    with pytest.raises(InputError, match="nothing is held"):
        kilter.region(Assembly([Part("a", Box([1, 1, 1]))]))


def test_a_part_that_touches_nothing():
    parts = [*stacks.tower(2).parts, Part("lost", Box([1, 1, 1]), Pose([9, 9, 9]))]
    region = kilter.region(Assembly(parts))
    assert region.kind == "none"
    assert region.proved
    assert any("touches nothing" in text and "'lost'" in text for text in region.warnings)


def test_a_joint_holds_every_direction():
    base = block("base", [0, 0, 0], [1, 1, 1], grounded=True)
    arm = block("arm", [5, 0, 0], [6, 1, 1])
    region = kilter.region(Assembly([base, arm], joints=[Joint(("base", "arm"))]))
    assert region.kind == "all"
    assert region.proved
    assert not any("touches nothing" in text for text in region.warnings)


def test_a_joint_and_a_contact():
    """Two cubes joined to one, on a table under the first alone: they tip, unless held."""
    base = block("base", [0, 0, -1], [1, 1, 0], grounded=True)
    cubes = [block("on", [0, 0, 0], [1, 1, 1]), block("off", [1, 0, 0], [1.5, 1, 1])]
    region = kilter.region(Assembly([base, *cubes], joints=[Joint(("on", "off"))]))
    assert region.kind == "ray"
    assert np.allclose(region.rays, [[0, 0, -1]])


@pytest.mark.slow
def test_what_is_left_out_is_said():
    rough = stacks.tower(2, friction=0.5)
    assert any("left out: friction" in text for text in kilter.common_region([rough]).warnings)
    counted = kilter.region(rough)
    assert counted.friction
    assert not any("left out" in text for text in counted.warnings)
    piled = kilter.region(rounds.three_cylinders())
    assert not any("open pairs" in text for text in piled.warnings)
    open_pair = kilter.region(free_form_on_a_floor())
    assert any("the forces of open pairs" in text for text in open_pair.warnings)


@pytest.mark.slow
def test_a_knife_edge_says_what_to_hold():
    texts = [text for text in kilter.region(stacks.tower(2)).warnings if "knife edge" in text]
    assert len(texts) == 1
    assert "only for one direction" in texts[0]
    assert "'cube-1', 'cube-2'" in texts[0]
    assert not any("knife edge" in t for t in kilter.region(rails.railed("-x -y -z")).warnings)
    flat = kilter.region(rails.railed("-x -z", planar=True))
    assert not any("knife edge" in text for text in flat.warnings)


def test_masses_far_apart():
    """A feather under an anvil: each has its own weight."""
    parts = [
        dataclasses.replace(part, mass=10.0 ** (4 * k))
        for k, part in enumerate(rails.railed("-x -y -z", count=3).parts)
    ]
    region = kilter.region(Assembly(parts))
    assert region.kind == "cone"
    assert region.proved
    assert region.cone.half_angle_deg == pytest.approx(35.264389682754654)


def test_progress_tells_of_each_program():
    told: list[str] = []
    assembly = rails.railed("-x -z")
    program = build_program(assembly, detect.contacts(assembly))
    found = stable_cone(program, progress=told.append)
    assert len(told) == found.programs
    assert told[0].startswith("region: directions decided ")


def test_progress_of_a_region_with_friction_reports_directions_and_the_gap():
    told: list[str] = []
    block = stacks.block_on_slope(0.0, friction=0.5)
    program = build_program(block, detect.contacts(block))
    found = friction_cone(program, gap_deg=1.0, progress=told.append)
    assert told[-1].startswith(f"region: directions decided {found.programs}, gap ")
    gaps = [float(one.split("gap ")[1].split()[0]) for one in told if "gap" in one]
    assert len(gaps) > 1
    assert gaps == sorted(gaps, reverse=True)


def test_margin_and_answer():
    region = kilter.region(rails.railed("-x -y -z"))
    center = region.center
    half = np.radians(region.cone.half_angle_deg)
    assert region.contains(center, margin=0.999 * half)
    assert not region.contains(center, margin=1.001 * half)
    assert not region.contains([0, 0, 0])
    answer = region.to_dict()
    assert answer["exact"] is True
    assert answer["programs"] == region.programs
    assert answer["center"] == pytest.approx((-np.ones(3) / np.sqrt(3)).tolist())
