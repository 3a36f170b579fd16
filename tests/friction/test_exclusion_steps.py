"""Steps of proofs that no motion exists: written, read and repeated."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from cases import program

from kilter.friction import exclusion_file
from kilter.friction.contraction import power_bound
from kilter.friction.enclosure import rescaled
from kilter.friction.exclusion import prove_no_motion, start_proof
from kilter.friction.exclusion_bounds import no_power
from kilter.friction.exclusion_check import power_not_excluded
from kilter.friction.exclusion_file import exclusion_data, recheck_exclusion
from kilter.friction.exclusion_steps import CaseStep, PowerStep, Quantity, ShrinkStep
from kilter.friction.moment_bound import MomentStep
from kilter.friction.reduced_law import reduced_law
from kilter.scenes import stacks
from kilter.work import Work


@pytest.fixture(scope="module")
def slope():
    """A program, and the steps that exclude its motion."""
    one = program(stacks.block_on_slope(26.0, friction=0.5))
    return one, prove_no_motion(one, work=2)


def again(step):
    """The step after it was written as JSON and read."""
    return exclusion_file._read(json.loads(json.dumps(exclusion_file._step(step))))


def same(one, other):
    assert one.rows.tolist() == other.rows.tolist()
    assert one.values.tolist() == other.values.tolist()
    assert (one.tangent is None) == (other.tangent is None)
    assert one.tangent is None or one.tangent.tolist() == other.tangent.tolist()


@pytest.mark.parametrize("tangent", [None, np.array([0.5, -0.1])])
def test_steps_are_read_as_they_were_written(tangent):
    power = PowerStep(np.array([0, 7]), np.array([0.25, -3.0]), tangent)
    same(again(power), power)
    shrunk = again(ShrinkStep((Quantity(4, power),)))
    assert shrunk.quantities[0].number == 4
    same(shrunk.quantities[0].multipliers, power)
    tree = CaseStep([power], 2, -1, [CaseStep(), CaseStep([power])])
    read = again(tree)
    assert (read.point, read.patch, len(read.cases)) == (2, -1, 2)
    same(read.cases[1].powers[0], power)
    assert read.cases[0].powers == []


def test_moments_are_read_as_they_were_written(slope):
    (step,) = (one for one in slope[1].steps if isinstance(one, MomentStep))
    read = again(step)
    assert (read.scale, read.squares) == (step.scale, step.squares)
    for one, other in zip(read.multipliers.squares, step.multipliers.squares, strict=True):
        lower = np.tril_indices(len(other))
        assert one[lower].tolist() == other[lower].tolist() == one.T[lower].tolist()


POWER = {"rows": [1], "values": [0.5], "tangent": None}


@pytest.mark.parametrize(
    ("change", "why"),
    [
        ({"rows": [1, 2]}, "not one value a row"),
        ({"rows": [-1]}, "no place"),
        ({"rows": [1.5]}, "no place"),
        ({"values": [float("nan")]}, "no row of numbers"),
        ({"values": [[0.5]]}, "no row of numbers"),
        ({"rows": [1, 2], "values": [0.5, float("inf")]}, "no row of numbers"),
    ],
)
def test_what_is_no_step_is_told(change, why):
    with pytest.raises(ValueError, match=why):
        exclusion_file._read({"power": {**POWER, **change}})


def test_matrices_that_are_not_known_are_told(slope):
    data = exclusion_data(slope[1])["steps"][-1]
    own = {**data["moments"], "squares": "others"}
    with pytest.raises(ValueError, match="unknown matrices"):
        exclusion_file._read({"moments": own})


def test_what_is_assumed_is_noted(slope):
    one, answer = slope
    data = exclusion_data(answer)
    for assumes in ("", "a thing"):
        _, [note] = recheck_exclusion(one, {**data, "assumes": assumes})
        assert note.endswith(", assuming a thing") == bool(assumes)


def test_nothing_free_or_no_load_has_no_power(slope):
    one = slope[0]
    held = one.with_rows(free=np.zeros(len(one.names), dtype=bool))
    floating = one.with_rows(gravity=np.zeros(3), applied=np.zeros((len(one.names), 6)))
    for other in (held, floating):
        assert power_not_excluded(other, None, []) == (0.0, 0.0)


def test_where_the_law_cannot_be_written_nothing_is_excluded(slope):
    one, answer = slope
    pulls = one.with_rows(two_sided=np.ones(len(one.part_a), dtype=bool))
    assert power_not_excluded(pulls, answer.opening, answer.steps) == (1.0, 0.0)


def test_without_steps_all_power_is_left(slope):
    one, answer = slope
    assert power_not_excluded(one, answer.opening, []) == (1.0, no_power(one))


def test_each_power_step_leaves_what_its_search_found():
    """Repeated, so that a later step refers to motions that an earlier step has bounded."""
    one = program(stacks.tower(3, tilt=15.0, friction=0.5))
    law, whole = reduced_law(one), Work.of(2.0)
    attempt, bounds = start_proof(law, no_power(one), None, whole)
    steps, left = [], 1.0
    for _ in range(3):
        bounds, power, _, step = power_bound(attempt, bounds)
        steps.append(step)
        left = min(left, bounds.scale * power)
        again, none = power_not_excluded(one, None, steps)
        assert again == pytest.approx(left, rel=1e-6)
        bounds = rescaled(attempt.relaxation.fastest, bounds, power)
    assert none < left < 0.9


def test_moments_of_motions_that_are_not_bounded_so_are_refused(slope):
    one, answer = slope
    (step,) = (one for one in answer.steps if isinstance(one, MomentStep))
    with pytest.raises(ValueError, match="to which motions are not bounded"):
        power_not_excluded(one, answer.opening, [replace(step, scale=step.scale / 2)])


@pytest.mark.parametrize(("point", "patch"), [(-1, -1), (10**6, -1), (10**6, 10**6)])
def test_a_case_that_is_divided_nowhere_and_leaves_something_closes_nothing(slope, point, patch):
    one, answer = slope
    left, none = power_not_excluded(one, answer.opening, [CaseStep([], point, patch, [])])
    assert (left, none) == (1.0, no_power(one))


@pytest.mark.parametrize("count", [0, 1, 20])
def test_no_case_of_those_that_a_point_is_divided_into_may_be_missing(slope, count):
    one, answer = slope
    divided = CaseStep([], 0, -1, [CaseStep() for _ in range(count)])
    with pytest.raises(ValueError, match="argument 2 is"):
        power_not_excluded(one, answer.opening, [divided])
