"""Random assemblies at rest: their states agree with a descent of the energy."""

from __future__ import annotations

import numpy as np
import pytest
from random_grids import elsewhere, random_grid
from random_rests import KINDS, random_rest
from rest_energy import LOWER, contradicts, least_beside

import kilter
from kilter import Assembly, Box, Part, Pose, Sphere


def test_every_kind_is_made_alike_by_its_seed() -> None:
    kinds = [random_rest(seed)[0] for seed in range(len(KINDS))]
    assert len(set(kinds)) == len(KINDS)
    one, other = (random_rest(3)[1] for _ in range(2))
    for a, b in zip(one.parts, other.parts, strict=True):
        np.testing.assert_array_equal(a.pose.position, b.pose.position)


@pytest.mark.slow
def test_a_descent_comes_lower_than_what_balances_and_no_lower_than_a_minimum() -> None:
    floor = Part("floor", Box([9, 9, 1]), Pose([0, 0, -0.5]), grounded=True)
    ball = Part("ball", Sphere(0.5), Pose([0, 0, 0.5]))
    box = Part("box", Box([1, 1, 1]), Pose([0, 0, 1.5]))
    assert least_beside(Assembly([floor, ball, box]), 0, 0.02) < -0.01
    can = Part("box below", Box([0.6, 0.6, 1]), Pose([0, 0, 0.5]))
    assert least_beside(Assembly([floor, can, box]), 0, 0.02) > -LOWER


@pytest.mark.slow
@pytest.mark.parametrize("seed", [*range(1000, 1021), "grid 0", "grid 7", "grid 11", "grid 13"])
def test_random_rests_have_no_contradiction(seed: int | str) -> None:
    grid = isinstance(seed, str)
    number = int(str(seed).split()[-1])
    assembly = random_grid(number) if grid else random_rest(number)[1]
    verdict = kilter.check(assembly)
    second = verdict.second_order_answer
    assert kilter.verify(assembly, verdict.proof()).holds
    if second is not None and second.state != "open":
        assert contradicts(assembly, second, number)[0] == ""
    for other in (Assembly(assembly.parts[::-1]), elsewhere(assembly)) if grid else ():
        there = kilter.check(other)
        assert kilter.verify(other, there.proof()).holds
        told = [one.second_order_answer.state if one.second_order_answer else one.verdict
                for one in (verdict, there)]  # fmt: skip
        assert told[0] == told[1] or "open" in told
