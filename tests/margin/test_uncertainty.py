"""Uncertain data, and loads on parts."""

import dataclasses
import sys
from pathlib import Path

import numpy as np
import pytest
from margins import program_of, small_assembly

import kilter
from kilter import Assembly, Box, Load, Part, Pose, margin
from kilter.analysis.decision.judge import judge
from kilter.analysis.load_limit import NoLimit, gravity_wrench
from kilter.analysis.margins import tilt as following_forces
from kilter.analysis.margins import uncertainty
from kilter.analysis.margins.tilt import find_tilt_margin
from kilter.analysis.margins.uncertainty import (
    Ranges,
    _by_corners,
    _by_following,
    corner,
    find_uncertainty,
)
from kilter.arrays import cross
from kilter.assembly.bricks.brick_assembly import bricks_of
from kilter.mechanics.program import build_program
from kilter.mechanics.rows import CONTACT
from kilter.scenes import stacks, walls
from kilter.tell.facts import facts
from kilter.tell.tables import load_table

sys.path.append(str(Path(__file__).parents[1] / "bricks"))
from bricks_apart import least_share

X = np.array([1.0, 0.0, 0.0])


def planar(assembly):
    return dataclasses.replace(assembly, planar=True)


def sampled(program, ranges, random):
    """A program within the intervals."""
    count = len(program.names)
    free = program.free
    mass = np.where(free, random.uniform(*ranges.mass, size=count), 1.0)
    shift = random.uniform(-ranges.center, ranges.center, size=(count, 3)) * free[:, None]
    if program.planar:
        shift[:, 1] = 0.0
    other = corner(program, mass, shift)
    mu = program.mu * random.uniform(*ranges.mu, size=len(program.mu))
    turn = random.normal(size=(len(program.mu), 3))
    if program.planar:
        turn *= [0, 1, 0]
    turn /= np.linalg.norm(turn, axis=1)[:, None]
    aside = cross(turn, program.normal)
    aside /= np.maximum(np.linalg.norm(aside, axis=1), 1e-12)[:, None]
    angle = np.radians(ranges.normal_deg) * random.uniform(0, 1, size=(len(program.mu), 1))
    normal = np.cos(angle) * program.normal + np.sin(angle) * aside
    normal = np.where((program.kind == CONTACT)[:, None], normal, program.normal)
    return other.with_rows(mu=mu, normal=normal)


def is_at_least_as_safe(program, ranges, worst, random):
    """One sample, at a random turn as far as the worst case allows, and a random load factor."""
    other = sampled(program, ranges, random)
    angle = random.uniform(0, 2 * np.pi)
    aside = np.array([np.cos(angle), 0.0 if program.planar else np.sin(angle), 0.0])
    aside /= np.linalg.norm(aside)
    tilt = np.radians(worst.tilt_deg) * (1 - 1e-6)
    size = float(np.linalg.norm(program.gravity))
    down = size * (np.cos(tilt) * np.array([0, 0, -1.0]) + np.sin(tilt) * aside)
    assert judge(other.with_rows(gravity=down)).stable is True
    for end in worst.load_factor:
        share = np.clip(end, -9, 9) * (1 - 1e-6)
        more = other.applied + share * gravity_wrench(other, X)
        assert judge(other.with_rows(applied=more)).stable is True


CASES = {
    "masses": (lambda: stacks.tower(3, friction=0.3), Ranges(mass=(0.7, 1.2))),
    "one-block": (
        lambda: stacks.block_on_slope(0.0, friction=0.9),
        Ranges(mass=(0.9, 1.1), center=0.1, mu=(0.7, 1.3)),
    ),
    "planar": (
        lambda: planar(stacks.tower(2, friction=0.4)),
        Ranges(mass=(0.8, 1.2), center=0.05, mu=(0.9, 1.1)),
    ),
    "normals": (
        lambda: planar(small_assembly(3)),
        Ranges(mass=(0.9, 1.1), center=0.02, mu=(0.9, 1.0), normal_deg=2.0),
    ),
    "many": (
        lambda: planar(walls.wall(3, 2, friction=0.6)),
        Ranges(mass=(0.8, 1.2), center=0.003, mu=(0.8, 1.0)),
    ),
    "in-space": (
        lambda: stacks.tower(2, friction=0.8),
        Ranges(mass=(0.9, 1.1), center=0.03, normal_deg=1.0),
    ),
}


def all_are_safe(name, count):
    make, ranges = CASES[name]
    program = program_of(make())
    worst = find_uncertainty(program, ranges, push=X)
    assert worst.held
    random = np.random.default_rng(7)
    for _ in range(count):
        is_at_least_as_safe(program, ranges, worst, random)


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_samples_within_the_intervals_are_at_least_as_safe(name):
    all_are_safe(name, 120 // len(CASES) + 1)


@pytest.mark.slow
def test_an_exact_worst_case_is_the_margin_of_the_assembly_it_names():
    program = program_of(planar(stacks.tower(2, friction=2.0)))
    ranges = Ranges(mass=(0.8, 1.2))
    worst = find_uncertainty(program, ranges, push=X)
    assert worst.kind == "exact"
    mass, shift = np.ones(len(program.names)), np.zeros((len(program.names), 3))
    for name, at in worst.worst.items():
        k = program.names.index(name)
        mass[k], shift[k] = at.mass_factor, at.shift
    one = corner(program, mass, shift)
    assert np.degrees(find_tilt_margin(one).angle) == pytest.approx(worst.tilt_deg, abs=1e-9)
    # light below, heavy above: arm .5 of the pile over the height of its centre of mass
    height = (0.8 * 0.5 + 1.2 * 1.5) / 2.0
    assert np.tan(np.radians(worst.tilt_deg)) == pytest.approx(0.5 / height, rel=1e-8)
    assert worst.load_factor[1] == pytest.approx(0.5 / height, rel=1e-8)


def test_a_shifted_centre_of_mass_of_one_block():
    program = program_of(planar(stacks.block_on_slope(0.0, friction=2.0)))
    worst = find_uncertainty(program, Ranges(center=0.1))
    assert (worst.kind, worst.corners) == ("exact", 4)
    assert np.tan(np.radians(worst.tilt_deg)) == pytest.approx(0.4 / 0.6, rel=1e-8)


@pytest.mark.slow
def test_normals_take_their_angle_from_that_of_friction():
    program = program_of(stacks.block_on_slope(0.0, friction=0.5))
    worst = find_uncertainty(program, Ranges(normal_deg=3.0))
    assert worst.kind == "inner"
    assert worst.tilt_deg == pytest.approx(np.degrees(np.arctan(0.5)) - 3.0, abs=1e-6)
    smooth = program_of(stacks.block_on_slope(0.0))
    assert not find_uncertainty(smooth, Ranges(normal_deg=3.0)).held


def test_intervals_too_wide_are_not_held():
    program = program_of(planar(stacks.block_on_slope(0.0, friction=2.0)))
    worst = find_uncertainty(program, Ranges(center=0.6))
    assert (worst.held, worst.tilt_deg) == (False, None)
    assert worst.missing == {"held": "none", "tilt": "none"}


@pytest.mark.parametrize("corners", [0, uncertainty.CORNERS])
def test_a_failure_is_not_taken_for_what_is_not_held(monkeypatch, corners):
    def failed(*_, **__):
        return NoLimit("failed")

    monkeypatch.setattr(uncertainty, "CORNERS", corners)
    monkeypatch.setattr(uncertainty, "find_limit", failed)
    monkeypatch.setattr(uncertainty, "find_tilt_margin", failed)
    monkeypatch.setattr(following_forces, "BALANCED", -1.0)
    block = planar(stacks.block_on_slope(0.0, friction=0.5))
    answer = kilter.margin(block, push=X, ranges=Ranges(mass=(0.9, 1.1)), effort=0)
    worst = answer.uncertainty
    assert worst.kind == "inner"
    assert worst.missing == {"held": "failed", "tilt": "failed", "load_factor": "failed"}
    assert (worst.held, worst.tilt_deg, worst.load_factor) == (False, None, None)
    said = dict(facts(answer.to_dict()))
    assert said["worst case"] == "not known: the solver failed"


@pytest.mark.quick(2)
@pytest.mark.parametrize(("share", "held"), [(0.3, True), (0.4, True), (0.5, False), (1.0, False)])
def test_a_block_under_a_side_load_is_held_up_to_its_friction(share, held):
    """Mu .5, masses down to .9 of the given: held while the load is below .45 of the weight."""
    table = Part("table", Box([9, 9, 1]), Pose([0, 0, -0.5]), grounded=True)
    block = Part("block", Box([2, 2, 0.2]), Pose([0, 0, 0.1]), mass=10.0)
    load = Load("block", [share * 10.0 * 9.81, 0, 0])
    assembly = Assembly([table, block], friction=0.5, loads=[load])
    program = build_program(assembly, kilter.contacts(assembly))
    ranges = Ranges(mass=(0.9, 1.1))
    corners = _by_corners(program, ranges, None, "exact")
    following = _by_following(program, ranges, None)
    assert following is not None
    assert (corners.held, following.held) == (held, held)


G = 9.81
WEIGHT = 1000 * G


def cube(name, x=0.0, z=0.0, **more):
    return Part(name, Box([1, 1, 1]), Pose([x, 0, z]), **more)


def loads_of(assembly, **more):
    return {one.part: one for one in margin(assembly, loads=True, effort=0, **more).loads}


@pytest.mark.slow
def test_a_beam_on_an_edge_takes_what_it_weighs_on_the_other_side():
    # 3 long, its middle 0.5 inside the edge of the table; the block is on what stands out
    table = Part("table", Box([2, 1, 1]), Pose([-1, 0, -1]), grounded=True)
    beam = Part("beam", Box([3, 1, 1]), Pose([-0.5, 0, 0]))
    block = cube("block", x=0.5, z=1.0, mass=1.0)
    found = loads_of(Assembly([table, beam, block]))
    assert found["beam"].load == np.inf
    assert found["beam"].to_dict()["load"] is None
    # about the edge at 0: W 0.5 = (F + m g) 0.5
    limit = 3 * WEIGHT - G
    assert found["block"].load == pytest.approx(limit, rel=1e-6)
    assert limit <= found["block"].beyond * (1 + 1e-9) <= limit * 1.001


@pytest.mark.slow
def test_loads_of_bricks_are_those_of_the_program_apart(tmp_path):
    path = tmp_path / "stair.txt"
    path.write_text("\n".join(f"4x2 ({2 * k},0,{k})" for k in range(6)))
    assembly = kilter.load(path)
    model, rules, _ = bricks_of(assembly)
    free = model.take(~model.held)
    rows = np.column_stack([free.corner // [1, 1, 3], free.size[:, :2], free.mass])
    found = loads_of(assembly, pushed=["2x4-2", "2x4-4", "2x4-6"])
    assert len(found) == 3
    for k in (1, 3, 5):
        for share in (0.999, 1.001):
            heavier = rows.copy()
            heavier[k, 5] += share * found[f"2x4-{k + 1}"].load / 9.8
            assert (least_share(heavier, pull=rules.pull) < 1) is (share < 1)


def test_what_falls_takes_no_load():
    found = margin(Assembly([cube("base", grounded=True), cube("c", x=0.6, z=1.0)]), loads=True)
    assert found.loads == ()
    assert found.missing["load on c"] == "none"
    assert any("no push and no load" in text for text in found.warnings)


def test_the_table_names_the_least_load_first():
    def one(part, load):
        mass = None if load is None else load / G
        return {"part": part, "load": load, "mass": mass, "moves": [part] * (load is not None)}

    table = load_table(
        {
            "level": "proved",
            "at_level": None,
            "loads": [one("a", None), one("b", 9.81), one("c", 0.0981)],
        }
    )
    assert [row[:3] for row in table.rows(9)] == [
        ("c", "98.1 mN", "10 g"),
        ("b", "9.81 N", "1 kg"),
        ("a", "unlimited", ""),
    ]
    assert table.rows(1)[0][3] == "then c starts to move"
