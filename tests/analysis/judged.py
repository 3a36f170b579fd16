"""Every verdict of these tests is verified again: `judged` checks an assembly and its proof.

The proof is written, read back as JSON, and verified on a copy of the assembly that went through a
file: nothing of the answer but the proof itself is used.
"""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest
import stranger

from kilter import InputError, check
from kilter.analysis.decision.judge import SOLVERS, Solver, judge
from kilter.analysis.verdict.verdict import Verdict
from kilter.analysis.verification import proof_tolerance, verify_proof
from kilter.assembly import Assembly
from kilter.contact import detect
from kilter.files import from_dict, to_dict
from kilter.mechanics.certificate import check_forces, check_motion
from kilter.mechanics.program import Program, build_program


def reloaded(assembly: Assembly) -> Assembly:
    """The assembly written to the text of a file and read again."""
    return from_dict(json.loads(json.dumps(to_dict(assembly), allow_nan=False)))


def verified(assembly: Assembly, proof: dict[str, Any]) -> Any:
    """Result of `verify_proof` for a proof and an assembly, with contacts found anew."""
    contacts = detect.contacts(assembly, tolerance=proof_tolerance(proof))
    return verify_proof(assembly, contacts, proof)


def judged(assembly: Assembly, **options: Any) -> Verdict:
    """The verdict, after its proof was written, read and verified on a fresh copy."""
    verdict = check(assembly, **options)
    if verdict.verdict == "undecided":
        with pytest.raises(InputError, match="no proof"):
            verdict.proof()
        return verdict
    assert verdict.verdict in ("stable", "settles", "potentially-stable", "balanced", "unstable")
    copy = reloaded(assembly)
    proof = json.loads(json.dumps(verdict.proof(), allow_nan=False))
    answer = verified(copy, proof)
    # what settles with less work than usual, a motion that verification finds may refute
    searched = verdict.verdict == "settles" and options.get("effort", 1.0) < 1.0
    assert answer.holds or (searched and answer.level == "equilibrium"), answer.reasons
    assert answer.verdict == verdict.verdict
    _convinces_a_stranger(proof, verdict.tolerance.verdict)
    _exactly_one_holds(verdict)
    _moves_as_it_should(verdict)
    return verdict


def _convinces_a_stranger(proof: dict[str, Any], tolerance: float) -> None:
    if proof["verdict"] != "unstable":
        # arms are shorter than bounding radii, and tolerances are one a part
        assert stranger.imbalance(proof) <= 10 * tolerance
    else:
        opening, power = stranger.opening_and_power(proof)
        assert power == pytest.approx(proof["certificate"]["power"], rel=1e-9)
        assert opening >= -power / (1e5 * proof_weight(proof))


def proof_weight(proof: dict[str, Any]) -> float:
    """Least weight of a free part [N]: at most that of the moving parts."""
    size = float(np.linalg.norm(proof["gravity"]))
    return size * min(part["mass"] for part in proof["parts"] if not part["grounded"])


def _exactly_one_holds(verdict: Verdict) -> None:
    forces, motion = verdict.judgement.forces, verdict.judgement.motion
    program = verdict.program
    balanced = forces is not None and check_forces(program, forces.forces, forces.friction).holds
    unstable = motion is not None and check_motion(program, motion.motion).holds
    assert balanced == (verdict.level is not None)
    assert unstable == (verdict.verdict == "unstable")


def _moves_as_it_should(verdict: Verdict) -> None:
    """A stable assembly stays; an unstable one moves, however slowly it starts."""
    assert not (verdict.first_order == "stable" and verdict.moving)
    moves = verdict.verdict == "unstable" or verdict.guarantee == "refuted"
    assert verdict.motion.acceleration.any() == moves
    assert 0.0 <= verdict.motion.instability <= 1.0 + 1e-12 or verdict.assembly.loads
    if verdict.first_order == "stable":
        assert verdict.friction is not None or verdict.displacement.z == 0.0
        assert not verdict.motion.acceleration.any()
    if verdict.verdict in ("settles", "potentially-stable") and verdict.why != "push-open":
        assert verdict.guarantee in ("refuted", "open")
        assert verdict.seated is not None
        passed, of = verdict.tries.passed, verdict.tries.of
        assert (verdict.verdict == "settles") == (verdict.guarantee == "open" and passed == of == 8)
    assert (verdict.verdict in ("potentially-stable", "balanced")) == (verdict.why is not None)


def program_of(assembly: Assembly, *, possible: bool = False, sticking: bool = False) -> Program:
    """The program of an assembly with the contacts found in it."""
    return build_program(assembly, detect.contacts(assembly), possible=possible, sticking=sticking)


def sides(program: Program) -> dict[Solver, bool | None]:
    """Side that each solver proves by itself: stable, unstable, or none."""
    return {solver: judge(program, solver=solver).stable for solver in SOLVERS}


def random_turn(random: np.random.Generator) -> np.ndarray:
    """A unit quaternion, uniform over all turns."""
    quaternion = random.normal(size=4)
    return quaternion / np.linalg.norm(quaternion)
