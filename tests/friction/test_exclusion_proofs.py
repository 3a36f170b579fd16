"""Proofs that no motion can start: repeated without a solver, refused after a changed number."""

import copy
import dataclasses
import json

import clarabel
import highspy
import pytest
from cases import planar, program
from judged import reloaded, verified

from kilter import check
from kilter.friction.exclusion import prove_no_motion
from kilter.friction.exclusion_bounds import no_power
from kilter.friction.exclusion_check import power_not_excluded
from kilter.friction.exclusion_file import exclusion_data, recheck_exclusion
from kilter.mechanics.proof import digest_of
from kilter.scenes import arches, friction, stacks


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
