"""The limit of a parameter: known values, several changes, wrong input."""

import math

import pytest

import kilter
from kilter import Assembly, Box, Part
from kilter.errors import InputError
from kilter.scenes import arches, stacks


def overhang(x: float) -> Assembly:
    bench = Part("bench", Box(4, 1, 1), [-2, 0, -0.5], grounded=True)
    return Assembly([bench, Part("block", Box(1, 1, 0.2), [x - 0.5, 0, 0.1])], friction=0.5)


def test_the_largest_overhang_is_half_of_the_length():
    lines: list[str] = []
    found = kilter.limit(overhang, 0, 1, progress=lines.append)
    assert found.inside <= 0.5 + 1e-9
    assert found.outside - found.inside <= 1e-4
    assert found.outside >= 0.5
    assert found.proved
    assert len(lines) == len(found.values) == len(found.table.splitlines())
    assert found.within.proof()
    assert "both proved" in found.sentence


def test_a_least_value_has_its_inner_side_above():
    """A block on a slope of 20 degrees needs mu = tan 20."""
    found = kilter.limit(lambda mu: stacks.block_on_slope(20.0, friction=mu), 0.1, 0.7)
    least = math.tan(math.radians(20))
    assert found.outside <= least <= found.inside
    assert found.inside - found.outside <= 1e-4 * 0.6


@pytest.mark.slow
def test_the_least_thickness_of_an_arch():
    """Published: .10735 of the radius for 20 voussoirs."""
    found = kilter.limit(lambda ratio: arches.arch(ratio=ratio), 0.1, 0.12, accuracy=5e-3)
    assert found.outside < 0.10735 < found.inside + 1e-4
    assert found.proved


def test_all_or_no_values_reach_the_level():
    every = kilter.limit(overhang, 0, 0.4)
    assert every.inside == 0.4
    assert math.isnan(every.outside)
    assert "All decided values" in every.sentence
    none = kilter.limit(overhang, 0.6, 0.9)
    assert math.isnan(none.inside)
    assert "No decided value" in none.sentence


def test_several_changes_are_counted():
    """A block that moves along a bench with two ends."""

    def along(x: float) -> Assembly:
        bench = Part("bench", Box(1, 1, 1), [0, 0, -0.5], grounded=True)
        return Assembly([bench, Part("block", Box(1, 1, 0.2), [x, 0, 0.1])], friction=0.5)

    found = kilter.limit(along, -0.9, 0.9)
    assert found.changes == 2
    assert found.outside < -0.5 <= found.inside + 1e-9
    assert "changes 2 times" in found.sentence


def test_a_plot_shows_every_decided_value():
    pytest.importorskip("matplotlib")
    found = kilter.limit(overhang, 0, 1, accuracy=0.1)
    [axes] = found.plot().axes
    drawn = sum(len(line.get_xdata()) for line in axes.get_lines()[:2])
    assert drawn == len(found.values)


@pytest.mark.parametrize(
    ("low", "high", "options", "words"),
    [
        (1, 0, {}, "the interval from 1 to 0 is empty"),
        (0, 1, {"accuracy": 0}, "accuracy"),
        (0, 1, {"accuracy": 2}, "accuracy is 2"),
        (0, 1, {"require": "certain"}, "certain"),
    ],
)
def test_wrong_arguments_are_errors(low, high, options, words):
    with pytest.raises(InputError, match=words):
        kilter.limit(overhang, low, high, **options)


def test_a_function_must_return_an_assembly():
    with pytest.raises(InputError):
        kilter.limit(lambda x: x, 0, 1)
