"""The word of a proof without friction is derived from its second order: balanced or stable."""

from functools import cache
from typing import Any

import pytest

import kilter
from kilter import Assembly, Box, Part, Pose, Sphere
from kilter.assembly.interactions import FrictionPair
from kilter.mechanics.proof import digest_of
from kilter.scenes import scene
from kilter.second_order.proofs.push_recheck import wrong_about_push


def ball_on_ball(friction: float) -> Assembly:
    lower = Part("lower", Sphere(1.0), grounded=True)
    return Assembly([lower, Part("upper", Sphere(0.5), Pose([0, 0, 1.5]))], friction=friction)


def signed_anew(proof: dict[str, Any], **changes: Any) -> dict[str, Any]:
    """The proof with other entries, signed anew."""
    changed = {**proof, **changes}
    changed["digest"] = digest_of(changed)
    return changed


@pytest.mark.parametrize("friction", [0.0, 0.5])
def test_a_ball_on_a_ball_is_balanced_with_friction_and_without(friction):
    assembly = ball_on_ball(friction)
    verdict = kilter.check(assembly)
    assert (verdict.verdict, verdict.level, verdict.why) == ("balanced", "equilibrium", "balanced")
    assert (verdict.guarantee, verdict.first_order, verdict.stable) == ("proved", "stable", False)
    assert (verdict.seated, verdict.tries) == (None, None)
    assert kilter.check(assembly, require="equilibrium").stable
    proof = verdict.proof()
    found = kilter.verify(assembly, proof)
    assert (found.holds, found.verdict) == (True, "balanced")
    refused = kilter.verify(assembly, signed_anew(proof, verdict="stable"))
    assert (refused.holds, refused.level, refused.reasons) == (False, "equilibrium", ())
    assert "it states 'stable', but its evidence proves 'balanced'" in refused.notes


def test_a_proof_without_second_order_is_no_stronger():
    """Round parts can move, so forces alone prove equilibrium and no more."""
    for friction in (0.0, 0.5):
        assembly = ball_on_ball(friction)
        proof = kilter.check(assembly).proof()
        second = {key: value for key, value in proof["second_order"].items() if key != "rolling"}
        for fewer in (
            signed_anew(proof, second_order=second, verdict="stable"),
            signed_anew({k: v for k, v in proof.items() if k != "second_order"}, verdict="stable"),
        ):
            found = kilter.verify(assembly, fewer)
            assert (found.holds, found.level, found.claimed) == (False, "equilibrium", "proved")
            assert kilter.verify(assembly, fewer, require="equilibrium").holds


@cache
def checked(friction: float) -> tuple[Assembly, kilter.Verdict]:
    assembly = ball_on_ball(friction)
    return assembly, kilter.check(assembly)


@pytest.mark.parametrize(
    ("second", "friction", "fits"),
    [
        ({"state": "balanced"}, 0.0, "balanced"),
        ({"state": "balanced"}, 0.5, "balanced"),
        ({"state": "balanced", "rolling": "falls"}, 0.5, "balanced"),
        ({"state": "balanced", "rolling": "open"}, 0.5, "balanced"),
        ({"state": "balanced", "rolling": "holds"}, 0.5, "stable"),
        ({"state": "minimum"}, 0.0, "stable"),
        (None, 0.5, "balanced"),  # it rolls off, by rule
        (None, 0.0, "balanced"),
    ],
)
@pytest.mark.parametrize("word", ["balanced", "stable", "potentially-stable"])
@pytest.mark.slow
def test_a_word_is_compared_with_its_evidence(second, friction, fits, word):
    assembly, verdict = checked(friction)
    forces = verdict.judgement.forces
    assert forces is not None
    reasons = wrong_about_push(
        assembly, verdict.contact_set, verdict.program, forces.forces, word, second, curves=True
    )
    if word in (fits, "potentially-stable"):  # the weakest word needs no evidence
        assert reasons == []
    else:
        assert reasons[0].startswith(f"it states {word!r}, but its evidence proves {fits!r}")


@pytest.mark.parametrize("name", ["tower", "paper-figure-9"])
def test_a_stable_assembly_is_not_balanced(name):
    assembly = scene(name)
    proof = kilter.check(assembly).proof()
    assert kilter.verify(assembly, proof).verdict == "stable"
    refused = kilter.verify(assembly, signed_anew(proof, verdict="balanced"))
    assert refused.reasons == ("it states 'balanced', but its evidence proves 'stable'",)


def test_forces_without_second_order_are_stable():
    assembly = scene("tower")
    proof = kilter.check(assembly).proof()
    bare = {key: value for key, value in proof.items() if key != "second_order"}
    assert kilter.verify(assembly, signed_anew(bare)).holds
    assert not kilter.verify(assembly, signed_anew(bare, verdict="balanced")).holds


def test_second_order_belongs_to_forces_without_friction_only():
    second = kilter.check(ball_on_ball(0.0)).proof()["second_order"]
    for name in ("paper-figure-8", "squeezed-block"):  # a motion; forces by friction
        assembly = scene(name)
        proof = kilter.check(assembly, require="equilibrium").proof()
        assert kilter.verify(assembly, proof).holds
        refused = kilter.verify(assembly, signed_anew(proof, second_order=second))
        assert refused.reasons[0].startswith("its second")  # its motion has no such part, too


def test_a_verified_second_order_is_a_note():
    assembly = ball_on_ball(0.0)
    proof = kilter.check(assembly).proof()
    assert "second order: balanced" in kilter.verify(assembly, proof).notes
    damaged = kilter.verify(assembly, signed_anew(proof, second_order={"state": "minimum"}))
    assert not damaged.holds
    assert not any(note.startswith("second order") for note in damaged.notes)


def test_friction_at_other_contacts_does_not_hold_a_slippery_ball():
    """A slippery ball on a ball, beside a rough block that stands."""
    balls = ball_on_ball(0.0).parts
    floor = Part("floor", Box([2, 2, 1]), Pose([5, 0, -0.5]), grounded=True)
    block = Part("block", Box([1, 1, 1]), Pose([5, 0, 0.5]))
    pair = FrictionPair(("floor", "block"), 0.5)
    assembly = Assembly([*balls, floor, block], friction_pairs=[pair])
    verdict = kilter.check(assembly)
    assert verdict.second_order_answer is not None
    assert (verdict.verdict, verdict.second_order_answer.state) == ("balanced", "balanced")
    assert kilter.verify(assembly, verdict.proof()).holds
