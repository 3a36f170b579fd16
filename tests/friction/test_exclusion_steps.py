"""Steps of proofs that no motion exists: written, read and repeated."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from cases import program

from kilter.friction import exclusion_check, exclusion_file
from kilter.friction.canonical import canonical
from kilter.friction.contraction import power_bound
from kilter.friction.enclosure import AT_REST, rescaled
from kilter.friction.exclusion import prove_no_motion, start_proof
from kilter.friction.exclusion_bounds import no_power
from kilter.friction.exclusion_check import power_not_excluded
from kilter.friction.exclusion_file import exclusion_data, recheck_exclusion
from kilter.friction.exclusion_steps import CaseStep, PowerStep, Quantity, ShrinkStep
from kilter.friction.friction_tolerances import NARROWEST_CONE
from kilter.friction.moment_bound import MomentStep
from kilter.friction.reduced_law import reduced_law
from kilter.mechanics.proof_form import MalformedProof
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
    step = next(one for one in slope[1].steps if isinstance(one, MomentStep))
    read = again(step)
    assert (read.scale, read.squares) == (step.scale, step.squares)
    for one, other in zip(read.multipliers.squares, step.multipliers.squares, strict=True):
        lower = np.tril_indices(len(other))
        assert one[lower].tolist() == other[lower].tolist() == one.T[lower].tolist()


POWER = {"rows": [1], "values": [0.5], "tangent": None}


@pytest.mark.parametrize(
    ("change", "why"),
    [
        ({"rows": [1, 2]}, "rows and values differ in number"),
        ({"rows": [-1]}, r"power.rows\[0\] is -1"),
        ({"rows": [1.5]}, r"power.rows\[0\] is 1.5"),
        ({"values": [float("nan")]}, r"power.values\[0\] is nan"),
        ({"values": [[0.5]]}, r"power.values\[0\] is \[0.5\]"),
        ({"rows": [1, 2], "values": [0.5, float("inf")]}, r"power.values\[1\] is inf"),
    ],
)
def test_what_is_no_step_is_told(change, why):
    with pytest.raises(MalformedProof, match=why):
        exclusion_file._read({"power": {**POWER, **change}})


def test_matrices_that_are_not_known_are_told(slope):
    data = exclusion_data(slope[1])["steps"][-1]
    own = {**data["moments"], "squares": "others"}
    with pytest.raises(MalformedProof, match=r"moments\.squares is 'others'"):
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
    one = canonical(program(stacks.tower(3, tilt=15.0, friction=0.5)))
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
    step = next(one for one in answer.steps if isinstance(one, MomentStep))
    with pytest.raises(MalformedProof, match="to which motions are not bounded"):
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
    with pytest.raises(MalformedProof, match="a case is divided into"):
        power_not_excluded(one, answer.opening, [divided])


@pytest.mark.parametrize(
    ("step", "why"),
    [
        (PowerStep(np.array([10**6]), np.ones(1), None), "a row does not exist"),
        (PowerStep(np.zeros(0, dtype=int), np.zeros(0), np.ones(1)), "number of freedoms"),
        (
            ShrinkStep((Quantity(10**6, PowerStep(np.zeros(0, dtype=int), np.zeros(0), None)),)),
            "a quantity does not exist",
        ),
    ],
)
def test_rows_quantities_and_tangents_that_do_not_exist_are_malformed(slope, step, why):
    one, answer = slope
    with pytest.raises(MalformedProof, match=why):
        power_not_excluded(one, answer.opening, [step])


def test_a_cone_is_halved_only_if_it_is_wide_enough(slope):
    one, answer = slope
    law = reduced_law(one)
    state = exclusion_check._ProofState(law, answer.opening, no_power(one))
    step = CaseStep([], -1, 0, [])
    narrow = np.array([[1.0, 1.0, 0.0], [0.0, NARROWEST_CONE / 2, 0.0], [0.0, 0.0, 1.0]])[:, :2]
    for cone, divisible in ((None, True), (AT_REST, False), (narrow, False), (np.eye(3), True)):
        bounds = replace(state.bounds, cones=(cone,))
        assert state._divisible(bounds, step) is divisible


def test_numbers_near_the_largest_leave_all_power(slope):
    one, answer = slope
    step = next(one for one in answer.steps if isinstance(one, MomentStep))
    huge = replace(
        step.multipliers, squares=tuple(1e150 * np.sign(m) for m in step.multipliers.squares)
    )
    with np.errstate(all="ignore"):
        left, _ = power_not_excluded(
            one, answer.opening, [replace(step, scale=1e150, multipliers=huge)]
        )
    assert left == 1.0


@pytest.mark.parametrize(
    "data",
    [{}, {"power": {}, "cases": []}, {"cases": [{"powers": [], "point": 0, "patch": 0}]}],
)
def test_data_without_the_form_of_a_step_are_malformed(data):
    with pytest.raises(MalformedProof):
        exclusion_file._read(data)


@pytest.mark.parametrize("counts", [[], [2, 0], [0, 0], [1], [10**30]])
def test_a_tree_has_as_many_cases_as_it_states(counts):
    cases = [{"powers": [], "point": 0, "patch": -1, "cases": count} for count in counts]
    with pytest.raises(MalformedProof, match="cases"):
        exclusion_file._read({"cases": cases})


@pytest.mark.parametrize("fault", [KeyError, TypeError, IndexError, ValueError, OverflowError])
def test_a_fault_of_kilter_is_no_objection_to_a_proof(slope, fault, monkeypatch):
    one, answer = slope

    def fails(*_):
        raise fault("a fault of kilter")

    monkeypatch.setattr(exclusion_file, "power_not_excluded", fails)
    with pytest.raises(fault, match="a fault of kilter"):
        recheck_exclusion(one, exclusion_data(answer))
