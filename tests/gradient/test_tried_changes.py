"""Changes that help, each tried: gains worked by hand, and no change that gains nothing."""

import json
import time
from dataclasses import replace

import numpy as np
import pytest

import kilter
from kilter import Assembly, Box, FrictionPair, Load, Part, Sphere
from kilter.cli import main
from kilter.scenes import arches, stacks
from kilter.scenes.pieces import block


def floor(low: list[float], high: list[float]) -> Part:
    size = np.subtract(high, low)
    middle = np.add(low, high) / 2
    return Part("floor", Box(*size, 1), [*middle, -0.5], grounded=True)


def offset_pair(mu: tuple[float, float] = (0.35, 0.3), above: float = 700.0) -> Assembly:
    """A light block on a heavy one, with two coefficients of friction, not symmetric."""
    parts = [
        floor([-3, -3], [3, 3]),
        block("low", [-0.5, -0.7, 0], [0.6, 0.7, 0.5], density=1500.0),
        block("high", [-0.4, -0.5, 0.5], [0.35, 0.5, 1.5], density=above),
    ]
    pairs = [FrictionPair(("floor", "low"), mu[0]), FrictionPair(("low", "high"), mu[1])]
    return Assembly(parts, friction_pairs=pairs)


def changes(assembly: Assembly, what: str, **options: object) -> list:
    answer = kilter.margin(assembly, improve=True, **options)
    return [change for change in answer.improvements if change.what == what]


def test_more_friction_helps_where_it_slides():
    """The upper block slides at atan mu until the lower one does."""
    (found,) = changes(offset_pair(), "friction")
    assert found.parts == ("low", "high")
    gain = np.degrees(np.arctan(0.35) - np.arctan(0.3))
    assert found.gain == pytest.approx(gain, rel=1e-5)


def test_a_heavier_part_below_moves_the_centre():
    """The pair topples together over x = -0.5: tan is the lever over the height of the centre."""
    found = changes(offset_pair(mu=(2.0, 2.0), above=7000.0), "mass")
    by_part = {change.parts[0]: change for change in found}
    change = by_part["low"]
    low, high = 1500 * 1.1 * 1.4 * 0.5, 7000 * 0.75 * 1.0 * 1.0

    def tilt(below: float) -> float:
        moment = below * np.array([0.05, 0.25]) + high * np.array([-0.025, 1.0])
        center = moment / (below + high)
        return float(np.degrees(np.arctan((center[0] + 0.5) / center[1])))

    assert change.limit == pytest.approx(tilt(low + change.by), rel=1e-6)
    assert change.gain == pytest.approx(tilt(low + change.by) - tilt(low), rel=1e-4)


def test_a_part_moves_away_from_the_edge():
    """The pair tips over x = -0.5: its centre or its edge moves away, as far as it was tried."""
    given = offset_pair(mu=(2.0, 2.0), above=7000.0)
    found = changes(given, "move")
    assert {change.parts: np.sign(change.along[0]) for change in found} == {
        ("low",): -1, ("high",): 1
    }  # fmt: skip
    for change in found:
        place = given[change.parts[0]].pose.position + change.by * change.along
        moved = given.with_pose(change.parts[0], place)
        assert kilter.margin(moved).tilt_deg == pytest.approx(change.limit, rel=1e-6)


def test_a_block_under_a_given_load():
    """A load at the middle of a block that slides: its mass and its friction help alike."""
    given = stacks.block_on_slope(0.0, friction=0.4)
    given = replace(given, loads=[Load("block", force=[100.0, 0, 0])])
    answer = kilter.margin(given, improve=True)
    by_kind = {change.what: change for change in answer.improvements}
    weight = 9810.0
    assert by_kind["friction"].gain == pytest.approx(0.05 * weight / 100, rel=1e-6)
    assert by_kind["mass"].gain == pytest.approx(0.1 * 0.4 * weight / 100, rel=1e-6)
    assert np.isinf(by_kind["hold"].gain)


def test_a_change_of_one_of_two_equal_slabs_is_not_listed():
    parts = [floor([-5, -5], [5, 5])]
    parts += [block(f"slab-{k}", [3 * k, 0, 0], [3 * k + 1, 1, 0.2]) for k in range(2)]
    answer = kilter.margin(Assembly(parts, friction=0.3), improve=True)
    assert not answer.improvements
    assert any("no single change" in warning for warning in answer.warnings)


def test_changes_are_ranked_and_each_gain_is_that_of_the_changed_assembly():
    """The arch of 20: ranked gains, within 3 CPU s; the mass change is computed again."""
    begun = time.process_time()
    answer = kilter.margin(arches.arch(), improve=True)
    assert time.process_time() - begun < 3
    gains = [change.gain for change in answer.improvements]
    assert gains == sorted(gains, reverse=True)
    assert min(gains) > 0
    change = next(change for change in answer.improvements if change.what == "mass")
    parts = [
        replace(part, mass=part.mass + change.by) if part.name == change.parts[0] else part
        for part in arches.arch().parts
    ]
    again = kilter.margin(replace(arches.arch(), parts=parts)).tilt_deg
    assert again == pytest.approx(change.limit, rel=1e-6)


def test_the_command_lists_changes_in_words(tmp_path, capsys):
    path = tmp_path / "pair.kilter.json"
    kilter.dump(offset_pair(), path)
    assert main(["margin", str(path), "--improve", "--quiet"]) == 0
    assert "increase mu between 'low' and 'high' by 0.05: tilt" in capsys.readouterr().out
    assert main(["margin", str(path), "--improve", "--json", "--quiet"]) == 0
    listed = json.loads(capsys.readouterr().out)["improvements"]
    assert listed[0]["gain"] > 0


def test_bonds_have_no_changes_but_a_reason():
    glued = replace(
        stacks.tower(2, friction=0.8), bonds=[kilter.Bond(("cube-1", "cube-2"), pull=1e3)]
    )
    answer = kilter.margin(glued, improve=True)
    assert not answer.improvements
    assert any("not computed for bonds" in warning for warning in answer.warnings)


def test_a_ball_is_not_made_larger_where_it_rests():
    """A larger ball at the same centre would enter the block below it."""
    base = Part("base", Box([2, 2, 1]), [0, 0, -0.5], grounded=True)
    assembly = Assembly([base, Part("ball", Sphere(0.5), [0.2, 0, 0.5])], friction=0.5)
    for change in kilter.margin(assembly, improve=True).improvements:
        assert (change.what, change.parts) != ("size", ("ball",))
