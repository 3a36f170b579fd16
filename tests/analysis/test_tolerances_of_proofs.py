"""Numbers of proofs on both sides of the rounding that they may be off by, and notes on them."""

from __future__ import annotations

import copy
import json
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import kilter
from kilter import Assembly, Bond, Box, Joint, Part, Pose
from kilter.mechanics.mechanics_tolerances import AGREES, POWER_ROUNDING
from kilter.mechanics.program import build_program
from kilter.mechanics.proof import digest_of
from kilter.scenes import paper, stacks

Proof = dict[str, Any]
G = 9.81


def proof_of(assembly: Assembly, **options: Any) -> Proof:
    found: Proof = json.loads(json.dumps(kilter.check(assembly, **options).proof()))
    return found


def reasons(assembly: Assembly, proof: Proof, change: Callable[[Proof], object]) -> tuple[str, ...]:
    other = copy.deepcopy(proof)
    change(other)
    other["digest"] = digest_of(other)
    return kilter.verify(assembly, other).reasons


def door(kind: Any, axis: list[float]) -> Assembly:
    """A door that a joint bears, far from the origin, its weight beside the joint."""
    parts = [
        Part("frame", Box([0.2, 0.2, 2.0]), Pose([7, 3, 0]), grounded=True),
        Part("door", Box([1.0, 0.05, 2.0]), Pose([7.7, 3.1, 0.2])),
    ]
    joint = Joint(("frame", "door"), kind, point=[7.15, 3.0, 0.1], axis=axis)
    return Assembly(parts, joints=[joint])


@pytest.mark.parametrize(("off", "refused"), [(0.5, False), (2.0, True)])
@pytest.mark.parametrize(
    ("kind", "axis", "place"), [("revolute", [0, 0, 1], 5), ("prismatic", [0, 1, 0], 1)]
)
def test_what_a_joint_cannot_carry_it_carries_to_rounding_only(
    kind: str, axis: list[float], place: int, off: float, refused: bool
) -> None:
    assembly = door(kind, axis)
    proof = proof_of(assembly)
    wrench = np.array(proof["joints"][0]["wrench"])
    program = build_program(assembly, kilter.contacts(assembly))
    length = float(program.radius[1])  # of the one free part
    force, torque = np.abs(wrench[:3]).max(), np.abs(wrench[3:]).max()
    assert min(force, torque) > 1.0
    size = length * force + torque if place > 2 else force + torque / length

    def change(other: Proof) -> None:
        other["joints"][0]["wrench"][place] += off * AGREES * size

    beyond = f"the {kind} joint of 'frame' and 'door' carries what its kind cannot"
    assert (beyond in reasons(assembly, proof, change)) == refused


@pytest.mark.parametrize(
    ("factor", "refused"), [(0.5, True), (1 + 0.5 * AGREES, False), (1 + 1.5 * AGREES, True)]
)
def test_the_fastest_part_of_a_motion_moves_by_one(factor: float, refused: bool) -> None:
    assembly = paper.figure_8()

    def change(proof: Proof) -> None:
        for six in proof["motion"].values():
            six[:] = [factor * x for x in six]

    found = reasons(assembly, proof_of(assembly), change)
    assert ("its fastest part does not move by 1" in found) == refused


@pytest.mark.parametrize(("off", "refused"), [(0.5, False), (2.0, True)])
def test_near_a_limit_the_power_agrees_to_the_rounding_of_its_terms(
    off: float, refused: bool
) -> None:
    """Of a hung cube a bond bears all but a part in a million."""
    parts = [
        Part("top", Box([1, 1, 1]), Pose([0, 0, 1]), grounded=True),
        Part("low", Box([1, 1, 1])),
    ]
    bond = Bond(("low", "top"), pull=(1 - 1e-6) * 1000 * G / 4)
    assembly = Assembly(parts, bonds=[bond])
    proof = proof_of(assembly)
    program = build_program(assembly, kilter.contacts(assembly))
    terms = float(np.abs(program.load[1] * np.array(proof["motion"]["low"])).sum())
    claimed = proof["certificate"]["power"]
    most = AGREES * claimed + POWER_ROUNDING * terms

    def change(other: Proof) -> None:
        other["certificate"]["power"] += off * most

    found = reasons(assembly, proof, change)
    assert any(reason.startswith("its power is") for reason in found) == refused


def test_tries_are_noted_with_the_worst_of_their_residuals() -> None:
    assembly = stacks.tower(2, tilt=10.0, friction=0.5)
    proof = proof_of(assembly, effort=0.0)
    forces = proof["friction"]["tries"]["forces"]
    assert len(forces) > 1
    worst = max(one["residual"] for one in forces)
    notes = kilter.verify(assembly, proof).notes
    assert any(f"balance to {worst:.1e} of a weight; the way there" in note for note in notes)


def mixed(degrees: float) -> Assembly:
    """A glued pair beside a rough one, on a slope."""
    parts = []
    for k, name in enumerate(("glued", "rough")):
        low = Part(f"{name}-low", Box([1, 1, 1]), Pose([3.0 * k, 0, 0]), grounded=True)
        high = Part(f"{name}-high", Box([1, 1, 0.01]), Pose([3.0 * k, 0, 0.505]))
        parts += [low, high]
    glue = Bond(("glued-low", "glued-high"), pull=100.0, shear=1e5)
    turn = np.radians(degrees)
    gravity = [G * np.sin(turn), 0, -G * np.cos(turn)]
    return Assembly(parts, friction=0.5, gravity=gravity, bonds=[glue])


def test_a_pull_beyond_a_bond_beside_contacts_without_one() -> None:
    def change(proof: Proof) -> None:
        for force in proof["forces"]:
            force[2] = 200.0 * np.sign(force[2]) * -1.0

    assembly = mixed(0.0)
    assert "a force pulls more than its bond" in reasons(assembly, proof_of(assembly), change)


def test_friction_beyond_its_cone_beside_a_bond() -> None:
    def change(proof: Proof) -> None:
        for force in proof["forces"]:
            force[1] += 1e3

    assembly = mixed(10.0)
    found = reasons(assembly, proof_of(assembly), change)
    assert "a force leaves its cone: its friction is above mu times its push" in found
