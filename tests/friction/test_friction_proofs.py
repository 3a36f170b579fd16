"""Proofs with friction, shares of friction that are needed, and tolerances."""

import copy
import dataclasses
import json
from itertools import pairwise

import numpy as np
import pytest
from boxes_on_deck import stack_on_deck
from judged import reloaded, verified
from scipy.optimize import linprog

import kilter
from kilter import Load, check
from kilter.analysis.verdict.friction_share import PressedPatch, friction_shares
from kilter.friction import friction_tolerances as t
from kilter.mechanics import mechanics_tolerances as judged
from kilter.mechanics.proof import digest_of
from kilter.scenes import friction, stacks
from kilter.tell.check_facts import forces_phrase
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
    # a motion that proves instability may open a contact more, or less: still a proof; and nothing
    # depends on the mass and the centre of a held part
    held = [k for k, part in enumerate(proof["parts"]) if part["grounded"]]
    free = [path for path in kept if path[0] != "parts" or path[1] not in held]
    assert all(path[0] == "motion" for path in free), kept
    assert {path[2] for path in kept if path not in free} <= {"mass", "center"}, kept


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


SIDES = 240
"""Rays of a friction cone in the linear programs; they lie inside the cone by 9e-5."""


@pytest.mark.parametrize("part", [0.3, 0.99])
def test_a_torque_needs_its_share_of_the_friction_torque(part):
    box = stack_on_deck([[0.6, 0.6, 0.4]], 0.5)
    weight = 9.81 * float(box.geometry.mass[1])
    torque = part * 0.5 * weight * 0.3 * 2**0.5
    turned = dataclasses.replace(box, loads=[Load("box-0", torque=[0, 0, torque])])
    verdict = kilter.check(turned, require="equilibrium")
    assert verdict.forces.utilisation == pytest.approx([part], abs=1e-6)
    words = forces_phrase(verdict.to_dict()["forces"])
    assert words is not None
    assert f"needs up to {100 * part:g} % of the friction" in words


def test_a_force_needs_its_share_of_the_friction_force():
    """Also a force beside the centre that turns: the pressures shift, the share stays."""
    box = stack_on_deck([[0.6, 0.6, 0.4]], 0.5)
    weight = 9.81 * float(box.geometry.mass[1])
    pushed = dataclasses.replace(box, loads=[Load("box-0", force=[0.8 * 0.5 * weight, 0, 0])])
    verdict = kilter.check(pushed, require="equilibrium")
    assert verdict.forces.utilisation == pytest.approx([0.8], abs=1e-6)


def random_patch(seed: int) -> PressedPatch:
    """Three to six points of a face, or of a bent face, with forces inside their cones."""
    rng = np.random.default_rng([7, seed])
    count = int(rng.integers(3, 7))
    normals = np.tile([0.0, 0.0, 1.0], (count, 1))
    if seed % 3 == 2:
        normals += 0.3 * rng.normal(size=(count, 3))
        normals /= np.linalg.norm(normals, axis=1)[:, None]
    points, mu = rng.normal(size=(count, 3)), float(rng.uniform(0.1, 1))
    push = rng.uniform(0, 1, count) * (rng.random(count) < 0.8) + 1e-3
    slip = np.cross(normals, rng.normal(size=(count, 3)))
    slip *= (mu * push * rng.uniform(0, 1, count) / np.linalg.norm(slip, axis=1))[:, None]
    none = np.zeros(count)
    return PressedPatch(points, normals, push[:, None] * normals + slip, mu, none, none)


def carries(patch: PressedPatch, share: float) -> bool:
    """Whether forces in cones of `share` times mu have the force and the moment of the patch."""
    columns, pushes = [], []
    for point, normal in zip(patch.points, patch.normals, strict=True):
        first = np.cross(normal, np.eye(3)[np.abs(normal).argmin()])
        first /= np.linalg.norm(first)
        second = np.cross(normal, first)
        for angle in 2 * np.pi * np.arange(SIDES) / SIDES:
            across = np.cos(angle) * first + np.sin(angle) * second
            ray = normal + share * patch.mu * across
            columns.append(np.append(ray, np.cross(point, ray)))
            pushes.append(1.0)
    wrench = np.append(patch.forces.sum(axis=0), np.cross(patch.points, patch.forces).sum(axis=0))
    most = np.einsum("ij,ij->", patch.forces, patch.normals) * (1 + 1e-7)
    found = linprog(
        np.zeros(len(columns)),
        A_ub=[pushes],
        b_ub=[most],
        A_eq=np.array(columns).T,
        b_eq=wrench,
    )
    return bool(found.status == 0)


@pytest.mark.slow
@pytest.mark.parametrize("first", range(0, 40, 10))
def test_no_smaller_share_carries_the_patch(first):
    patches = [random_patch(seed) for seed in range(first, first + 10)]
    for patch, share in zip(patches, friction_shares(patches), strict=True):
        assert 0 < share <= 1
        assert carries(patch, share * (1 + 2e-4))
        assert not carries(patch, share * (1 - 1e-4))


LADDERS = {
    "a motion, or none": [
        judged.WITNESS_POWER,
        t.COARSEST_NO_POWER,
        t.NO_POWER,
        t.OBEYED,
    ],
    "exact": [judged.WITNESS_EXACT, t.EXACTLY, t.SHARP, t.SOLVED],
    "first guesses": [t.CLEAR, t.NODE_GAP, t.SHARP],
    "sides of a mode": [t.SLOW, t.CLEAR, t.SLACK, t.SOLVED],
    "creeping": [t.CLEAR, t.CREEP, t.SLACK],
    "rounding": [t.FLAT, t.JOINT_RANK, t.CONE_ROUNDING, t.ZERO_ENTRY],
    "cones": [t.WIDEST_SECTOR, t.NARROWEST_CONE, t.POINT_AT_REST, t.CONE_ROUNDING],
    "seats": [t.BALANCED, t.GOAL],
    "converged": [t.GONE, t.STEADY, t.SHARP],
}


@pytest.mark.parametrize("name", LADDERS)
def test_each_is_below_the_one_before(name):
    ladder = LADDERS[name]
    assert all(coarse > fine for coarse, fine in pairwise(ladder))


def test_a_witness_has_a_thousand_times_the_power_that_counts_as_none():
    assert judged.WITNESS_POWER >= 1e3 * t.NO_POWER * (1 - 1e-12)


def test_a_seat_is_a_proof_of_equilibrium():
    assert t.BALANCED <= judged.TOLERANCE
