"""Proofs that no motion turns what is locked between walls: as found, and number by number."""

import copy
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import kilter
from kilter import Assembly, Box, Part, Pose
from kilter.mechanics.program import build_program
from kilter.mechanics.proof import digest_of
from kilter.scenes.paper import figure_9
from kilter.second_order.gaps.features_of import features_of
from kilter.second_order.gaps.gap_form import gap_forms
from kilter.second_order.gaps.stationary import Stationary, problem_of, stationary
from kilter.second_order.proofs.minimum_proof import (
    Faces,
    LockedTurns,
    faces_of,
    judge_locked,
    shifts,
)
from kilter.second_order.searches.critical import find_critical
from kilter.second_order.searches.curved_energy import find_locked
from kilter.second_order.second_order_tolerances import ACROSS, BEARS, CURVED
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
def test_figure_9_in_space_slides_and_does_not_turn():
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


def test_what_is_locked_is_a_turn_of_all_four_about_the_normals_of_their_walls():
    _, problem, _ = asked()
    free, across = shifts(problem)
    assert (free.shape[1], across.shape[1]) == (5, 1)
    turns = across.reshape(4, 6)[:, 3:]
    walls = np.array([[0.0, 0, 1], [1, 0, 0], [0, 0, 1], [1, 0, 0]])
    sizes = np.abs(np.einsum("ij,ij->i", turns, walls))
    np.testing.assert_allclose(np.linalg.norm(turns, axis=1), sizes, atol=1e-9)
    np.testing.assert_allclose(sizes, sizes[0], rtol=1e-9)


@pytest.mark.parametrize("angle", [-0.01, 0.01])
def test_the_locked_turn_closes_gaps_in_sum(angle):
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


def test_in_the_plane_no_proof_is_of_what_is_locked():
    """With three unknowns for each part, two parts could be read as a part in space."""
    flat = kilter.Assembly(figure_9().parts, planar=True)
    rows = len(build_program(flat, kilter.contacts(flat)).kind)
    proof = kilter.check(flat).proof()
    numbers = {"locked": [1.0] * rows, "stress": [1.0] * rows}
    proof["second_order"] = {"state": "free", "neutral": 1, "free": 1, **numbers}
    proof["digest"] = digest_of(proof)
    reasons = kilter.verify(flat, proof).reasons
    assert "its second order: parts in a plane have no turns to lock" in reasons


X, Y, Z, TURN = np.eye(6)[[0, 1, 2, 5]]
JUST = (0.9, 1.1)
"""Factors of a limit, on both sides of it [-]."""
POINTS = ((-1.0, 0.0), (1.0, 0.0), (0.0, 1.0), (0.0, -1.0))


def word(
    *,
    points: Any = POINTS,
    locks: float = 1.0,
    load: Any = -Z,
    forces: Any = None,
    stress: Any = None,
    blur: float = 1e-9,
    flat: Any = None,
    size: float = 1.0,
    at: Any = None,
) -> str:
    """The word of the judge, with some numbers replaced; empty if the proof holds.

    Forces and stress are those of each pair of points, below and above; `at` replaces the places of
    the points, over the length.
    """
    places = np.array(points, dtype=float)
    below = np.column_stack([np.tile([0.0, 0, 1], (len(places), 1)), places[:, 1], -places[:, 0],
                             np.zeros(len(places))])  # fmt: skip
    rows = np.vstack([below, -below])
    form = np.zeros((len(rows), 12, 12))
    form[:, 5, 5] = -locks / len(rows)
    columns = np.tile(np.append(np.arange(6), np.full(6, -1)), (len(rows), 1))
    problem = Stationary(rows, np.array(load, dtype=float), form, columns, blur)
    count = len(places)
    share = np.repeat([1 / count, 0.0], count) if forces is None else np.array(forces, dtype=float)
    press = np.ones(2 * count) if stress is None else np.array(stress, dtype=float)
    on = np.ones(len(rows), dtype=bool) if flat is None else np.array(flat)
    said = places if at is None else np.array(at, dtype=float)
    where = np.column_stack([np.resize(said, (len(rows), 2)), np.zeros(len(rows))])
    faces = Faces(np.repeat([0, 1], count), on, where)
    return judge_locked(problem, faces, LockedTurns(share, size * press))


def test_it_holds_as_it_is():
    """Contacts may be without force, and self-stress has no scale."""
    assert word() == ""
    assert word(size=1e3) == word(size=1e-3) == ""
    assert "every turn" in word(locks=-1.0)


@pytest.mark.parametrize("over", JUST)
def test_every_turn_is_locked(over):
    assert ("every turn" in word(locks=over * CURVED)) == (over < 1)
    assert ("every turn" in word(locks=over * CURVED, size=1e3)) == (over < 1)


def test_numbers_are_those_of_the_contacts():
    eight = np.full(8, 0.125)
    assert "a finite force for each contact" in word(forces=eight[1:])
    assert "a finite force for each contact" in word(stress=eight[1:])
    for bad in (np.nan, np.inf):
        for name in ("forces", "stress"):
            assert word(**{name: [bad, *eight[1:]]}) == "its numbers are not finite"


@pytest.mark.parametrize("over", JUST)
def test_forces_push_and_balance(over):
    pull = [-0.25, -0.25, 0.75, 0.75, 0, 0, 0, 0]
    assert "do not balance" in word(forces=pull)
    for blur in (1e-9, 1e-6, 1e-12):
        off = over * max(blur, 1e-9) / 4
        forces = np.repeat([0.25 + off, 0.0], 4)
        assert ("do not balance" in word(forces=forces, blur=blur)) == (over > 1)


@pytest.mark.parametrize("size", [1.0, 1e4])
@pytest.mark.parametrize("over", JUST)
def test_self_stress_presses_on_every_contact_and_balances(over, size):
    least = np.ones(8)
    least[[0, 4]] = over * BEARS * 1e-9
    assert ("press on every" in word(stress=least, size=size)) == (over < 1)
    uneven = np.ones(8)
    uneven[:4] += over * 1e-9 / 4
    assert ("does not balance" in word(stress=uneven, size=size)) == (over > 1)


def test_limits_themselves():
    """Numbers that are exact in binary: an imbalance and a stress at their limits."""
    limit = 2.0**-20
    assert word(forces=np.repeat([0.25 + limit / 4, 0.0], 4), blur=limit) == ""
    uneven = np.repeat([1.0, 1.0 - limit / 4], 4)
    assert word(stress=uneven, blur=limit) == ""
    least = np.ones(8)
    least[[0, 4]] = BEARS * limit
    assert "press on every" in word(stress=least, blur=limit)


@pytest.mark.parametrize("lever", [0.3, 0.01])
def test_self_stress_at_short_levers_presses_by_rounding(lever):
    """Two pairs on a line hold no turn about it, and the third presses too little."""
    three = ((-1.0, 0.0), (1.0, 0.0), (0.0, lever))
    for press, holds in ((2e-8, False), (1e-3, True)):
        if press * lever > 3e-9 and not holds:
            press = 1.1 * BEARS * 1e-9 * 0.1 / lever
        stress = np.tile([1.0, 1.0, press], 2)
        found = word(points=three, stress=stress, forces=[0.5, 0.5, 0, 0, 0, 0])
        assert (found == "") == holds
        assert ("no larger than rounding" in found or "press on every" in found) != holds


@pytest.mark.parametrize("over", JUST)
@pytest.mark.parametrize("along", [X, Y, -X])
def test_shifts_cost_nothing(over, along):
    found = word(load=-Z + over * ACROSS * along, blur=2 * ACROSS)
    assert ("cost energy" in found) == (over > 1)


@pytest.mark.parametrize("over", JUST)
def test_faces_lie_on_faces_at_points_on_no_line(over):
    assert "faces" in word(flat=[True] * 7 + [False])
    least = over * np.sqrt(1e-10 / 2)
    thin = np.array([(-1.0, 0.0), (1.0, 0.0), (0.0, least), (0.0, -least)])
    assert ("faces" in word(at=thin)) == (over < 1)
    assert ("faces" in word(at=thin + 100.0)) == (over < 1)
    assert "faces" in word(at=np.zeros((4, 2)))
    assert "faces" in word(at=[*POINTS, *np.zeros((4, 2))])
    one = ((0.0, 0.0),)
    assert "faces" in word(points=one, forces=[1.0, 0.0], stress=[1.0, 1.0])


def test_where_faces_are_has_no_unit():
    found = []
    for size in (1.0, 1e3):
        parts = [Part(name, Box(size * np.ones(3)), Pose([0, 0, size * z]), grounded=z == 0)
                 for z, name in enumerate("ab")]  # fmt: skip
        assembly = Assembly(parts)
        contacts = kilter.contacts(assembly)
        program = build_program(assembly, contacts)
        problem = problem_of(program, features_of(program, contacts))
        found.append(faces_of(program, contacts, problem))
    assert found[0].flat.all()
    np.testing.assert_allclose(found[0].point, found[1].point, rtol=1e-12)
    np.testing.assert_allclose(np.ptp(found[0].point, axis=0), [1 / np.sqrt(0.75)] * 2 + [0])


def test_a_proof_is_not_written_to():
    proof = LockedTurns(np.ones(2), np.ones(2))
    with pytest.raises(ValueError, match="read-only"):
        proof.stress[0] = 2.0


def test_shifts_turn_nothing():
    rows = np.zeros((1, 12))
    rows[0, 2] = 1.0
    problem = Stationary(
        rows, np.zeros(12), np.zeros((1, 12, 12)), np.tile(np.arange(12), (1, 1)), 1e-9
    )
    free, across = shifts(problem)
    assert free.shape == (12, 5)
    assert across.shape == (12, 6)
    assert not free[[3, 4, 5, 9, 10, 11]].any()
    np.testing.assert_allclose(free.T @ across, 0.0, atol=1e-12)
    assert np.linalg.matrix_rank(across[[3, 4, 5, 9, 10, 11]]) == 6
