"""Proofs are refused if any of their numbers is changed, whether or not the digest fits."""

import copy
import json

import numpy as np
import pytest
import stranger
from builders import (
    falling_pair,
    given,
    hanging_pair,
    pressed_box,
    rough_staircase,
    toppled_box,
)
from judged import judged, reloaded, verified

import kilter
from kilter import Assembly, Box, InputError, Part
from kilter.analysis.verification import verify_proof
from kilter.contact import detect
from kilter.mechanics.proof import digest_of
from kilter.scenes import paper, stacks

CASES = {
    "forces": rough_staircase,
    "forces-planar": lambda: paper.figure_9(planar=True),
    "forces-tilted": lambda: paper.trapped_wedge(10.0, planar=False),
    "forces-loads": pressed_box,
    "forces-joints": hanging_pair,
    "forces-given": given,
    "motion": paper.figure_8,
    "motion-planar": lambda: paper.figure_8(planar=True),
    "motion-loads": toppled_box,
    "motion-joints": falling_pair,
    "motion-slope": lambda: stacks.block_on_slope(20.0, azimuth=30.0),
}
UNREAD = {"options", "tolerance", "kilter_proof"}
"""Entries that a changed number turns into a question about another set of contacts."""


@pytest.fixture(scope="module", params=CASES)
def proven(request):
    assembly = CASES[request.param]()
    verdict = judged(assembly)
    assert verdict.verdict == ("stable" if "forces" in request.param else "unstable")
    copy_ = reloaded(assembly)
    return copy_, detect.contacts(copy_), json.loads(json.dumps(verdict.proof()))


def numbers(value, path=()):
    """Paths of all numbers of JSON data."""
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from numbers(inner, (*path, key))
    elif isinstance(value, list):
        for key, inner in enumerate(value):
            yield from numbers(inner, (*path, key))
    elif isinstance(value, int | float) and not isinstance(value, bool):
        yield path


def chosen(proof, count):
    """Paths of numbers: all, or the first and the last of each kind of entry."""
    paths = list(numbers(proof))
    if count == "all":
        return paths
    kinds = {}
    for path in paths:
        kinds.setdefault(tuple(key for key in path if isinstance(key, str)), []).append(path)
    return [path for kind in kinds.values() for path in {kind[0], kind[-1]}]


COUNTS = pytest.mark.parametrize("count", ["few", pytest.param("all", marks=pytest.mark.slow)])


def changed(proof, path, *, fit):
    """A proof with a number changed by a thousandth, with or without a fitting digest."""
    other = copy.deepcopy(proof)
    place = other
    for key in path[:-1]:
        place = place[key]
    old = place[path[-1]]
    place[path[-1]] = old * (1 + 1e-3) if abs(old) > 1e-6 else old + 1e-3
    if fit:
        other["digest"] = digest_of(other)
    return other


def test_proof_has_every_kind_of_number(proven):
    _, _, proof = proven
    kinds = {path[0] for path in numbers(proof)}
    assert {"gravity", "down", "parts", "points", "certificate", "tolerance"} <= kinds
    assert ("forces" in kinds) != ("motion" in kinds)


@pytest.mark.quick(5)
@COUNTS
def test_changed_number_is_refused_by_the_mechanics(proven, count):
    assembly, contacts, proof = proven
    accepted = []
    for path in chosen(proof, count):
        if path[0] in UNREAD:
            continue
        other = changed(proof, path, fit=True)
        if verify_proof(assembly, contacts, other).holds and not _another_proof(proof, other, path):
            accepted.append(path)
    assert accepted == []


def _another_proof(proof, other, path):
    """Whether a changed motion is itself a proof, of the power it claims, for a stranger.

    A part that moves on, without work, opens its contacts: that motion proves as much. So does
    any that slides and turns parts on level faces, of what stands on such faces alone.
    """
    if path[:2] == ("second_order", "motion") and "level" in proof["second_order"]:
        return not np.array(list(other["second_order"]["motion"].values()))[:, 2:5].any()
    if path[0] != "motion":
        return False
    if np.linalg.matrix_rank([rays(proof), rays(other)], tol=1e-9) == 1:
        return True
    opening, power = stranger.opening_and_power(other)
    # powers are those of motions whose fastest part moves by 1: here it is not the changed one
    claimed = proof["certificate"]["power"]
    return opening >= -1e-12 and power == pytest.approx(claimed, rel=1e-8)


def rays(proof):
    """All components of a motion, as one unit vector."""
    motion = np.concatenate(list(proof["motion"].values()))
    return motion / np.linalg.norm(motion)


FLIPS = {
    "planar": lambda p: p.update(planar=not p["planar"]),
    "units": lambda p: p.update(units="mm"),
    "verdict": lambda p: p.update(verdict="stable" if "motion" in p else "unstable"),
    "grounded": lambda p: p["parts"][0].update(grounded=False),
    "held": lambda p: p["parts"][-1].update(grounded=True),
    "part-name": lambda p: p["parts"][-1].update(name="another"),
    "point-parts": lambda p: p["points"][0]["parts"].reverse(),
    "point-lost": lambda p: p["points"].pop(),
    "point-twice": lambda p: p["points"].append(p["points"][0]),
    "load-added": lambda p: p["loads"].append(
        {"part": p["parts"][-1]["name"], "point": None, "force": [1, 0, 0], "torque": [0, 0, 0]}
    ),
    "joint-added": lambda p: p["joints"].append(
        {"parts": ["ground", p["parts"][-1]["name"]], "kind": "fixed", "point": [0, 0, 0],
         "axis": None, "wrench": [0] * 6}
    ),
}  # fmt: skip


@pytest.mark.parametrize("flip", FLIPS)
def test_changed_word_is_refused_although_the_digest_fits(proven, flip):
    assembly, contacts, proof = proven
    other = copy.deepcopy(proof)
    FLIPS[flip](other)
    other["digest"] = digest_of(other)
    assert not verify_proof(assembly, contacts, other).holds


def test_proof_of_another_assembly_is_refused():
    for one, other in ((paper.figure_8(60), paper.figure_8(61)), (given(), rough_staircase())):
        assert not verified(other, judged(one).proof()).holds


@pytest.mark.parametrize("damage", ["parts", "points", "gravity", "certificate", "tolerance"])
def test_proof_with_a_key_missing_is_refused_in_words(damage):
    assembly = paper.figure_8()
    proof = judged(assembly).proof()
    del proof[damage]
    proof["digest"] = digest_of(proof)
    with pytest.raises(InputError, match="make it anew"):
        verified(assembly, proof)


def test_proof_with_numbers_that_are_none_is_refused():
    assembly = paper.figure_8()
    proof = judged(assembly).proof()
    proof["motion"]["C2"][0] = float("nan")
    with pytest.raises(InputError, match="cannot be read"):
        verified(assembly, proof)


def test_verdict_and_proof_do_not_depend_on_the_run():
    for build in (paper.figure_8, rough_staircase):
        assert judged(build()).proof() == judged(build()).proof()


@pytest.mark.parametrize("verb", ["check", "margin"])
def test_a_proof_in_python_lists_the_options_with_which_the_file_was_read(
    tmp_path, monkeypatch, verb
):
    monkeypatch.chdir(tmp_path)
    cubes = [Part(name, Box(1, 1, 1), [0, 0, z]) for name, z in (("a", 0), ("b", 1))]
    kilter.dump(Assembly(cubes), "shelf.json")
    answer = getattr(kilter, verb)("shelf.json", floor=True)
    proof = answer.proof()
    assert kilter.verify("shelf.json", proof).holds
    assert kilter.verify(answer.assembly, proof).holds
    loaded = kilter.load("shelf.json", ground="a")
    assert kilter.verify("shelf.json", kilter.check(loaded).proof()).holds
