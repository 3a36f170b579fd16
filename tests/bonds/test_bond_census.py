"""A slice of the census of bonds: `benchmarks/bond_census.py`."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path

import numpy as np
import pytest
from random_bonded import random_bonded

from sampled import sampled

FILE = Path(__file__).resolve().parents[2] / "benchmarks" / "bond_census.py"


@pytest.fixture(scope="module")
def census():
    spec = importlib.util.spec_from_file_location("bond_census", FILE)
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # dataclasses look up their module there
    spec.loader.exec_module(module)
    yield module
    del sys.modules[spec.name]


@pytest.mark.slow
@pytest.mark.parametrize("seed", sampled(3, 40))
def test_a_program_written_apart_agrees(census, seed):
    answer, wrong = census.asked(seed)
    assert wrong == []
    assert answer


@pytest.mark.slow
def test_that_no_share_is_enough_is_said_where_the_numbers_of_a_limit_fail(census):
    """Bonds of 4 kN and of 1 MN: the brick slides off its bond at any strength."""
    assert census.asked(1069) == ("grown, space, friction: no share is enough", [])


@pytest.mark.slow
def test_the_census_would_see_a_share_that_is_off(census):
    """With half of the strength of every bond, the share doubles."""
    made = random_bonded(1)
    share = census.least_share(made, 1.0)
    weak = census.with_share(made.assembly, 0.5)
    other = type(made)(made.family, weak, made.touches, made.turn)
    assert 0 < share < np.inf
    assert census.least_share(other, 1.0) == pytest.approx(2 * share)


def test_a_seed_has_one_assembly():
    one, other = random_bonded(5), random_bonded(5)
    assert np.array_equal(one.assembly.geometry.vertices, other.assembly.geometry.vertices)
    assert [bond.to_dict() for bond in one.assembly.bonds] == [
        bond.to_dict() for bond in other.assembly.bonds
    ]
