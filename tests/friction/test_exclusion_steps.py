"""The steps that exclude motion, read and repeated; damaged ones are refused."""

import copy
import dataclasses
import json
from dataclasses import replace

import clarabel
import highspy
import numpy as np
import pytest
from cases import planar, program
from judged import reloaded, verified

from kilter import check
from kilter.friction import exclusion_file
from kilter.friction import exclusion_file as exclusion_check
from kilter.friction.canonical import canonical
from kilter.friction.contraction import power_bound
from kilter.friction.enclosure import AT_REST, rescaled
from kilter.friction.exclusion import prove_no_motion, start_proof
from kilter.friction.exclusion_bounds import CaseStep, PowerStep, Quantity, ShrinkStep, no_power
from kilter.friction.exclusion_file import exclusion_data, power_not_excluded, recheck_exclusion
from kilter.friction.friction_tolerances import NARROWEST_CONE
from kilter.friction.moment_bound import MomentStep
from kilter.friction.reduced_law import reduced_law
from kilter.mechanics.proof import digest_of
from kilter.mechanics.proof_form import MalformedProof
from kilter.scenes import arches, friction, stacks
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


def with_light_part(assembly, name, mass):
    """The assembly with another mass of a part [kg]."""
    parts = [dataclasses.replace(p, mass=mass) if p.name == name else p for p in assembly.parts]
    return dataclasses.replace(assembly, parts=tuple(parts))


CASES = {
    "slope": (lambda: stacks.block_on_slope(26.0, friction=0.5), "moments"),
    "trough": (lambda: friction.trough(30.0, tilt=44.0), "moments"),
    "three cubes": (lambda: stacks.tower(3, tilt=15.0, friction=0.5), "sectors"),
    "arch": (lambda: arches.arch(7), "modes"),
    # its last cases have powers near the tolerances of a solver
    "arch with a light part": (
        lambda: with_light_part(arches.arch(5, ratio=0.2), "voussoir-3", 2.0),
        None,
    ),
    "ladder": (lambda: friction.ladder(55.0), None),
    "slope in the plane": (lambda: planar(stacks.block_on_slope(26.0, friction=0.5)), None),
}


@pytest.fixture(scope="module", params=CASES)
def proven(request):
    build, kind = CASES[request.param]
    one = program(build())
    answer = prove_no_motion(one, work=2)
    assert answer.proved
    assert kind in (answer.kind, None)
    return one, json.loads(json.dumps(exclusion_data(answer), allow_nan=False))


def refused(one, data):
    reasons, notes = recheck_exclusion(one, data)
    assert bool(reasons) != bool(notes)
    return bool(reasons)


@pytest.mark.quick(2)
def test_repeated_without_a_solver(proven, monkeypatch):
    def none(*_, **__):
        raise AssertionError("a solver was asked")

    monkeypatch.setattr(clarabel, "DefaultSolver", none)
    monkeypatch.setattr(highspy, "Highs", none)
    one, data = proven
    reasons, notes = recheck_exclusion(one, data)
    assert not reasons
    assert "repeated" in notes[0]


def lists(value, path=()):
    """Paths of all lists of numbers that are multipliers."""
    if isinstance(value, dict):
        for key, entry in value.items():
            if key not in ("rows", "tangent", "opening"):
                yield from lists(entry, (*path, key))
    elif isinstance(value, list) and value and isinstance(value[0], float):
        yield path
    elif isinstance(value, list):
        for k, entry in enumerate(value):
            yield from lists(entry, (*path, k))


def at(data, path):
    for key in path:
        data = data[key]
    return data


def last_powers(step):
    """Paths of the programs that close the cases of a step."""
    for k, case in enumerate(step.get("cases", ())):
        if not case["cases"]:
            yield ("cases", k, "powers", len(case["powers"]) - 1)


@pytest.mark.quick("slope", "trough")
@pytest.mark.slow
def test_the_greatest_multiplier_of_each_kind_matters(proven):
    one, data = proven
    last = len(data["steps"]) - 1
    if "moments" not in data["steps"][last]:
        pytest.skip("cases: below")
    for path in lists(data["steps"][last], ("steps", last)):
        other = copy.deepcopy(data)
        values = at(other, path)
        most = max(range(len(values)), key=lambda k: abs(values[k]))
        values[most] *= 1.01
        if abs(values[most]) > 1e-3:
            assert refused(one, other), path


@pytest.mark.quick(2)
def test_every_closed_case_matters(proven):
    one, data = proven
    last = len(data["steps"]) - 1
    paths = list(last_powers(data["steps"][last]))
    if not paths:
        pytest.skip("moments: above")
    for path in paths:
        other = copy.deepcopy(data)
        power = at(other, ("steps", last, *path))
        power["values"] = [-value for value in power["values"]]
        assert refused(one, other)


@pytest.mark.quick(
    "slope", "trough", "arch", "arch with a light part", "ladder", "slope in the plane"
)
def test_what_is_missing_or_foreign_is_refused(proven):
    one, data = proven
    for spoil in (
        lambda own: own["steps"].pop(),
        lambda own: own["steps"].append({"other": []}),
        lambda own: own["steps"].insert(0, {"cases": []}),
        lambda own: own.pop("opening"),
        lambda own: own.update(steps=[]),
    ):
        other = copy.deepcopy(data)
        spoil(other)
        assert refused(one, other)
    for other in (stacks.block_on_slope(27.0, friction=0.5), friction.h_block()):
        assert refused(program(other), data)


def test_bounds_of_forces_matter():
    one = program(CASES["slope"][0]())
    data = exclusion_data(prove_no_motion(one, work=2))
    for opening in (None, [-x for x in data["opening"]], [0.0 for _ in data["opening"]]):
        assert refused(one, {**data, "opening": opening})


@pytest.mark.quick(2)
def test_the_steps_leave_what_the_answer_says(proven):
    one, _ = proven
    answer = prove_no_motion(one, work=2)
    left, none = power_not_excluded(one, answer.opening, answer.steps)
    assert left <= none == no_power(one)
    assert left == pytest.approx(answer.bound, rel=1e-9)


def test_a_changed_number_is_refused_by_verify():
    assembly = stacks.block_on_slope(26.0, friction=0.5)
    proof = json.loads(json.dumps(check(assembly, effort=1).proof()))
    answer = verified(reloaded(assembly), proof)
    assert answer.holds
    assert any("repeated" in note for note in answer.notes)
    values = proof["friction"]["exclusion"]["steps"][-1]["moments"]["positive"]
    values[values.index(max(values))] *= 1.01
    proof["digest"] = digest_of(proof)
    assert not verified(reloaded(assembly), proof).holds
