"""Contents of written proofs: verdict, bonds, and joints between held parts."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

import kilter
from kilter import Assembly, Bond, Box, InputError, Joint, Part, Pose
from kilter.mechanics.certificate import ForceProof, MotionProof
from kilter.mechanics.program import build_program
from kilter.mechanics.proof import Evidence, _verdict_word, make_proof
from kilter.scenes import example

FORCES = ForceProof(np.zeros(0), np.zeros((0, 3)), 0.0, True)
MOTION = MotionProof(np.zeros((1, 6)), 1.0, 0.0, 1e9, True)


@pytest.mark.parametrize(
    ("certificate", "evidence", "verdict"),
    [
        (MOTION, None, "unstable"),
        (MOTION, Evidence("proved"), "unstable"),
        (FORCES, None, "stable"),
        (FORCES, Evidence("proved"), "stable"),
        (FORCES, Evidence("open"), "potentially-stable"),
        (FORCES, Evidence("open", settles=True), "settles"),
        (FORCES, Evidence("refuted", settles=True), "potentially-stable"),
    ],
)
def test_the_verdict_is_that_of_the_evidence(
    certificate: Any, evidence: Evidence | None, verdict: str
) -> None:
    assert _verdict_word(certificate, evidence) == verdict


def test_what_is_undecided_has_none() -> None:
    assembly = example("tower")
    contacts = kilter.contacts(assembly)
    program = build_program(assembly, contacts)
    with pytest.raises(InputError, match="an undecided verdict has no proof to write"):
        make_proof(assembly, contacts, program, None, {})


def cube(name: str, z: float, *, grounded: bool = False) -> Part:
    return Part(name, Box([1, 1, 1]), Pose([0, 0, z]), grounded=grounded)


@pytest.mark.parametrize(
    ("shear", "said"),
    [(None, {"tied": True}), ("mu", {}), (7.0, {"shear": 7.0}), (0.0, {"shear": 0.0})],
)
def test_a_bond_is_said_at_each_of_its_points(shear: Any, said: dict[str, Any]) -> None:
    bond = Bond(("low", "top"), pull=9e3, shear=shear)
    assembly = Assembly([cube("top", 1.0, grounded=True), cube("low", 0.0)], bonds=[bond])
    proof = kilter.check(assembly).proof()
    told = [{k: p[k] for k in ("pull", "tied", "shear") if k in p} for p in proof["points"]]
    assert told == [{"pull": 9e3, **said}] * 4
    plain = kilter.check(example("tower")).proof()
    assert not {"pull", "tied", "shear"} & set(plain["points"][0])


def test_a_joint_of_held_parts_carries_nothing() -> None:
    parts = [cube("a", 0.0, grounded=True), cube("b", 1.0, grounded=True), cube("c", 2.0)]
    assembly = Assembly(parts, joints=[Joint(("a", "b"))])
    proof = json.loads(json.dumps(kilter.check(assembly).proof()))
    assert proof["joints"][0]["wrench"] == [0.0] * 6
    assert kilter.verify(assembly, proof).holds
