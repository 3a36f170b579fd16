"""Figure 9 in space: five shifts are free, the common turn of all four blocks is locked."""

from __future__ import annotations

import copy
import dataclasses

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import kilter
from kilter.mechanics.program import build_program
from kilter.mechanics.proof import digest_of
from kilter.scenes.paper import figure_9
from kilter.second_order.gaps.features_of import features_of
from kilter.second_order.gaps.gap_form import gap_forms
from kilter.second_order.gaps.stationary import Stationary, stationary
from kilter.second_order.proofs.locked import Faces, LockedTurns, faces_of, judge_locked, shifts
from kilter.second_order.searches.critical import find_critical
from kilter.second_order.searches.locking_stress import find_locked
from kilter.work import Work


def asked() -> tuple[kilter.Assembly, Stationary, Faces]:
    assembly = figure_9()
    contacts = kilter.contacts(assembly)
    program = build_program(assembly, contacts)
    problem = stationary(program, gap_forms(program, features_of(program, contacts)))
    return assembly, problem, faces_of(program, contacts, problem)


def proved(problem: Stationary, faces: Faces) -> LockedTurns:
    critical = find_critical(problem)
    assert critical is not None
    proof = find_locked(problem, faces, critical, work=Work())
    assert proof is not None
    return proof


@pytest.mark.slow
def test_figure_9_in_space_slides_and_does_not_turn() -> None:
    assembly = figure_9()
    found = kilter.check(assembly)
    second = found.second_order_answer
    assert second is not None
    assert (second.state, second.neutral, second.free, second.blocked) == ("free", 6, 5, 1)
    proof = found.proof()
    assert kilter.verify(assembly, proof).holds
    for key in ("locked", "stress"):
        for k in range(len(proof["second_order"][key])):
            other = copy.deepcopy(proof)
            other["second_order"][key][k] -= 0.37 * max(other["second_order"][key])
            other["digest"] = digest_of(other)
            assert not kilter.verify(assembly, other).holds, (key, k)
    for key, word in (("neutral", 7), ("free", 6), ("state", "minimum")):
        other = copy.deepcopy(proof)
        other["second_order"][key] = word
        other["digest"] = digest_of(other)
        assert not kilter.verify(assembly, other).holds, key


def test_what_is_locked_is_a_turn_of_all_four_about_the_normals_of_their_walls() -> None:
    _, problem, _ = asked()
    free, across = shifts(problem)
    assert (free.shape[1], across.shape[1]) == (5, 1)
    turns = across.reshape(4, 6)[:, 3:]
    walls = np.array([[0.0, 0, 1], [1, 0, 0], [0, 0, 1], [1, 0, 0]])
    sizes = np.abs(np.einsum("ij,ij->i", turns, walls))
    np.testing.assert_allclose(np.linalg.norm(turns, axis=1), sizes, atol=1e-9)
    np.testing.assert_allclose(sizes, sizes[0], rtol=1e-9)


@pytest.mark.parametrize("angle", [-0.01, 0.01])
def test_the_locked_turn_closes_gaps_in_sum(angle: float) -> None:
    """Exact heights of points of a face over the plane of the other, weighted by self-stress."""
    assembly, problem, faces = asked()
    stress = proved(problem, faces).stress
    contacts = kilter.contacts(assembly)
    program = build_program(assembly, contacts)
    _, across = shifts(problem)
    assert problem.scale is not None
    motion = program.full(across[:, 0] * problem.scale)
    motion *= angle / np.abs(motion[:, 3:]).max()
    turn = np.concatenate([Rotation.from_rotvec(motion[:, 3:]).as_matrix(), np.eye(3)[None]])
    center = np.vstack([program.center, np.zeros(3)])
    shift = np.vstack([motion[:, :3], np.zeros(3)])

    def moved(part: np.ndarray) -> np.ndarray:
        arm = program.point - center[part]
        return np.asarray(center[part] + shift[part] + np.einsum("kij,kj->ki", turn[part], arm))

    normal = np.einsum("kij,kj->ki", turn[program.part_a], program.normal)
    gaps = np.einsum("ki,ki->k", normal, moved(program.part_b) - moved(program.part_a))
    expected = -problem.curvature(stress, across)[0, 0] / 2
    size = float(np.linalg.norm(motion[program.free].reshape(-1) / problem.scale))
    total = float(stress @ gaps) / (problem.length * size**2)
    assert total == pytest.approx(expected, rel=1e-3)
    assert total < -1e-3


def test_what_does_not_lock_is_refused() -> None:
    _, problem, faces = asked()
    proof = proved(problem, faces)
    assert judge_locked(problem, faces, proof) == ""
    hollow = dataclasses.replace(problem, forms=-problem.forms)
    assert "exclude every turn" in judge_locked(hollow, faces, proof)
    some = proof.stress.copy()
    some[0] = 0.0
    assert "press" in judge_locked(problem, faces, LockedTurns(proof.forces, some))
    pulled = proof.stress * np.linspace(1.0, 1.1, len(some))
    assert "balance" in judge_locked(problem, faces, LockedTurns(proof.forces, pulled))
    on_lines = dataclasses.replace(faces, point=faces.point * [1.0, 0.0, 1.0])
    assert "faces" in judge_locked(problem, on_lines, proof)
    edges = dataclasses.replace(faces, flat=faces.patch != faces.patch[0])
    assert "faces" in judge_locked(problem, edges, proof)


def test_in_the_plane_no_proof_is_of_what_is_locked() -> None:
    """With three unknowns for each part, two parts could be read as a part in space."""
    flat = kilter.Assembly(figure_9().parts, planar=True)
    rows = len(build_program(flat, kilter.contacts(flat)).kind)
    proof = kilter.check(flat).proof()
    numbers = {"locked": [1.0] * rows, "stress": [1.0] * rows}
    proof["second_order"] = {"state": "free", "neutral": 1, "free": 1, **numbers}
    proof["digest"] = digest_of(proof)
    reasons = kilter.verify(flat, proof).reasons
    assert "its second order: parts in a plane have no turns to lock" in reasons
