"""Proof files with friction: verified on a fresh copy, and refused if a number is changed."""

from __future__ import annotations

import copy
import json

import pytest
from judged import reloaded, verified

from kilter import check
from kilter.mechanics.proof import digest_of
from kilter.scenes import friction, stacks
from sampled import sampled

CASES = {
    "proved": lambda: stacks.block_on_slope(20.0, friction=0.5),
    "refuted and seated": lambda: friction.bracket(1.1 / 1.2, pad=1e-3),
    "held by squeeze": lambda: friction.h_block(),
    "no equilibrium": lambda: stacks.block_on_slope(30.0, friction=0.5),
}


@pytest.fixture(scope="module", params=CASES)
def proven(request):
    assembly = CASES[request.param]()
    proof = json.loads(json.dumps(check(assembly, effort=3).proof(), allow_nan=False))
    return reloaded(assembly), proof


def numbers(value, path=()):
    """Paths of all numbers in the data except those of the certificate and the options."""
    if isinstance(value, dict):
        for key, entry in value.items():
            if key not in ("options", "digest", "kilter_proof", "exclusion", "tolerance"):
                yield from numbers(entry, (*path, key))
    elif isinstance(value, list):
        for k, entry in enumerate(value):
            yield from numbers(entry, (*path, k))
    elif isinstance(value, float | int) and not isinstance(value, bool):
        yield path


def changed(proof, path, by):
    other = copy.deepcopy(proof)
    entry = other
    for key in path[:-1]:
        entry = entry[key]
    entry[path[-1]] += by
    other["digest"] = digest_of(other)
    return other


def scale(proof, path):
    """A change that matters for the number: a thousandth of the largest of its kind."""
    entry = proof
    for key in path[:-1]:
        entry = entry[key]
    values = entry.values() if isinstance(entry, dict) else entry
    sizes = [abs(v) for v in values if isinstance(v, float | int) and not isinstance(v, bool)]
    return 1e-3 * max([1.0, *sizes])


@pytest.mark.quick(1)
def test_proof_holds_on_a_fresh_copy(proven):
    assembly, proof = proven
    answer = verified(assembly, proof)
    assert answer.holds, answer.reasons


@pytest.mark.slow
@pytest.mark.parametrize("share", sampled(1, 3))
def test_every_number_changed_is_refused_although_the_digest_fits(proven, share):
    assembly, proof = proven
    kept = []
    for path in list(numbers(proof))[share::3]:
        other = changed(proof, path, scale(proof, path))
        if verified(assembly, other).holds:
            kept.append(path)
    # a motion that proves instability may open a contact more, or less: still a proof
    assert all(path[0] == "motion" for path in kept), kept


@pytest.mark.quick(5)
@pytest.mark.parametrize("word", ["stable", "potentially-stable", "unstable", "sure"])
def test_another_verdict_is_refused(proven, word):
    assembly, proof = proven
    if word != proof["verdict"]:
        other = {**proof, "verdict": word}
        other["digest"] = digest_of(other)
        found = verified(assembly, other)
        weaker = proof["verdict"] == "stable" and word == "potentially-stable"
        assert found.holds == weaker
        assert found.level == ("equilibrium" if weaker else None)


def test_friction_left_out_of_a_proof_is_missed(proven):
    assembly, proof = proven
    if "friction" in proof:
        other = {key: value for key, value in proof.items() if key != "friction"}
        other["verdict"] = "stable"
        other["digest"] = digest_of(other)
        answer = verified(assembly, other)
        assert not answer.holds
        assert any("cone" in reason for reason in answer.reasons)


@pytest.mark.parametrize("key", ["witness", "exclusion"])
def test_guarantee_without_its_evidence_is_refused(proven, key):
    assembly, proof = proven
    if "friction" in proof and proof["friction"][key] is not None:
        other = copy.deepcopy(proof)
        other["friction"][key] = None
        other["digest"] = digest_of(other)
        assert not verified(assembly, other).holds
