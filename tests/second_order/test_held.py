"""Parts that forces of equilibrium hold, and the contacts that carry."""

import copy
from dataclasses import replace

import numpy as np
import pytest
from places import case_of, side_by_side
from scipy.sparse import csr_array

import kilter
from kilter import Assembly, Box, Feature, GivenContact, Part, Pose
from kilter.analysis.verdict.neutral import find_neutral
from kilter.mechanics.program import Program, build_program
from kilter.mechanics.proof import digest_of
from kilter.scenes import scene
from kilter.scenes.walls import wall_of
from kilter.second_order.answer import whole
from kilter.second_order.gaps.stationary import Stationary
from kilter.second_order.proofs import level_rest as held_judge
from kilter.second_order.proofs.level_rest import Held, judge_held, unbalanced
from kilter.second_order.proofs.minimum_proof import all_carry, carry_beyond_doubt, carrying_rows
from kilter.second_order.searches import critical, level_rest_search
from kilter.second_order.searches.level_rest_search import find_held
from kilter.second_order.second_order_tolerances import BALANCED, BEARS

Z = np.array([0.0, 0.0, 1.0])


def coupling(turns: tuple[float, float, float]) -> Assembly:
    """Maxwell's coupling: three balls of a plate, each in a groove of right angle.

    The grooves lie at 0, 120 and 240 degrees and run in the given directions.
    """
    parts = [
        Part("base", Box([1, 1, 1]), Pose([0, 0, -2]), grounded=True),
        Part("b", Box([1, 1, 1]), Pose([0, 0, 0.3]), mass=2.0),
    ]
    contacts = []
    for k, turn in enumerate(turns):
        at = np.array([np.cos(2 * np.pi * k / 3), np.sin(2 * np.pi * k / 3), 0])
        side = np.array([-np.sin(turn), np.cos(turn), 0])
        for sense in (1, -1):
            n = (Z + sense * side) / np.sqrt(2)
            feature = (Feature("face"), Feature("face", curvature=10.0))
            contacts.append(GivenContact(("base", "b"), [at - 0.1 * n], n, feature=feature))
    return Assembly(parts, contacts=contacts, detect=False)


RADIAL = (0.0, 2 * np.pi / 3, 4 * np.pi / 3)


def program_of(assembly: Assembly) -> Program:
    return build_program(assembly, kilter.contacts(assembly)).frictionless


def test_grooves_towards_the_middle_hold_a_plate():
    """Six equal forces of m g / (6 cos 45), and no part can move."""
    program = program_of(coupling(RADIAL))
    force = 2.0 * 9.81 / (6 * np.sqrt(0.5))
    assert judge_held(program, Held(np.full(6, force))) == ""
    assert judge_held(program, Held(np.full(6, force * (1 + 1e-6))))
    second = kilter.check(coupling(RADIAL)).second_order_answer
    assert second is not None
    assert (second.state, second.neutral) == ("minimum", 0)


@pytest.mark.parametrize("turn", [1e-2, -1e-2])
def test_parallel_grooves_do_not_and_nearly_parallel_ones_do(turn):
    assert judge_held(program_of(coupling((0.0, 0.0, 0.0))), Held(np.full(6, 1.0)))
    across = program_of(coupling((0.0, 0.0, 0.0)))
    force = np.full(6, 2.0 * 9.81 / (6 * np.sqrt(0.5)))
    assert "neutral" in judge_held(across, Held(force))
    assert judge_held(program_of(coupling((0.0, turn, -turn))), Held(force)) == ""


def test_forces_that_leave_a_contact_free_are_spread():
    """A tilted box in a corner, four rows for each face: three forces balance it, all hold it."""
    program = program_of(coupling(RADIAL))
    given = np.full(6, 2.0 * 9.81 / (6 * np.sqrt(0.5)))
    found = find_held(program, given)
    assert found is not None
    twice = program.taking(np.repeat(np.arange(6), 2))
    lean = np.tile([1.0, 0.0], 6) * np.repeat(given, 2)
    assert find_held(twice, lean) is not None
    assert find_held(program.taking(np.arange(5)), given[:5]) is None


@pytest.mark.parametrize("name", ["corner-wedges", "pit", "closed-frame", "stopped-groove"])
def test_where_nothing_is_neutral_no_gap_is_asked(name, monkeypatch):
    monkeypatch.setattr(whole, "features_of", None)
    monkeypatch.setattr(whole, "find_critical", None)
    verdict = kilter.check(scene(name))
    assert verdict.second_order_answer is None
    counted = find_neutral(verdict.program)
    assert counted is not None
    assert counted.two_sided == counted.one_sided == 0


@pytest.mark.parametrize("bricks", [1, 105])
def test_a_wall_asks_no_gap_and_no_program(bricks, monkeypatch):
    monkeypatch.setattr(whole, "features_of", None)
    for module in (critical, level_rest_search):
        monkeypatch.setattr(module, "carrying_forces", None)
    second = kilter.check(wall_of(bricks)).second_order_answer
    assert second is not None
    assert second.state == "free"


def test_what_is_held_beside_others_has_its_proof():
    row = side_by_side([coupling(RADIAL), case_of("03").build(0.0), coupling(RADIAL)])
    second = kilter.check(row).second_order_answer
    assert second is not None
    assert [one.neutral for one in second.clusters] == [0, 5, 0]
    assert second.state == "minimum"
    assert second.rate == pytest.approx(np.sqrt(9.81 / 0.6), rel=1e-6)
    proof = kilter.check(row).proof()
    assert kilter.verify(row, proof).holds
    entry = proof["second_order"]["clusters"][0]
    for key, value in (("held", entry["held"][:-1]), ("held", [0.0] * 6), ("neutral", 1)):
        other = copy.deepcopy(proof)
        other["second_order"]["clusters"][0][key] = value
        other["digest"] = digest_of(other)
        assert not kilter.verify(row, other).holds, key


def over_the_edge(foot: float, off: float, *, size: float = 1.0, count: int = 1) -> Assembly:
    """Blocks on four points, pinned at their centre, which is `off` inside of their edge."""
    feet = [([x, y, 0.0], Z) for x in (off, off - foot) for y in (-0.4, 0.4)]
    pins = [([0, 0, 0.5], sense * np.eye(3)[axis]) for axis in (0, 1) for sense in (1, -1)]
    pins += [([3, 0, 0.5], [0, sense, 0]) for sense in (1, -1)]  # against a turn
    parts = [Part("base", Box(size * np.ones(3)), Pose([0, 0, -size]), grounded=True)]
    given = []
    for b in map(str, range(count)):
        parts.append(Part(b, Box(size * np.ones(3)), Pose([0, 0, size / 2]), mass=1000.0))
        given += [GivenContact(("base", b), [size * np.array(at)], n) for at, n in feet + pins]
    return Assembly(parts, contacts=given, detect=False)


def forces_over_the_edge(program: Program, far: float, pins: float = 0.1) -> np.ndarray:
    """Forces with a given share of the weight at the far points, and the rest at the near ones."""
    weight = float(program.weight[program.free][0])
    feet = np.repeat(weight * np.array([1 - far, far]) / 2, 2)
    return np.concatenate([feet, np.full(6, pins * weight)])


@pytest.mark.parametrize("foot", [0.3, 0.05, 0.003])
@pytest.mark.parametrize("far", [1e-9, 2e-8, 1e-7, 1e-6])
def test_far_points_within_rounding_hold_nothing_that_is_over_an_edge(foot, far):
    """The torque of a force at a short lever is within the tolerated imbalance."""
    program = program_of(over_the_edge(foot, 0.0))
    assert judge_held(program, Held(forces_over_the_edge(program, far)))
    off = 1e-4 * foot
    program = program_of(over_the_edge(foot, off))
    assert judge_held(program, Held(forces_over_the_edge(program, off / foot))) == ""


@pytest.mark.parametrize("size", [1.0, 1e3, 1e-3])
@pytest.mark.parametrize("count", [1, 2])
@pytest.mark.parametrize(("share", "pins"), [(1e-4, 0.1), (1e-2, 0.1), (0.3, 1e-4)])
def test_the_limit_of_what_carries_has_no_unit(size, count, share, pins):
    """The limit of too small forces at far points or pins follows from J."""
    program = program_of(over_the_edge(0.2, 0.2 * share, size=size, count=count))
    forces = np.tile(forces_over_the_edge(program, share, pins), count)
    own = np.flatnonzero(program.free)
    rows = program.jacobian().toarray()
    rows /= np.repeat([[1, r] for r in program.radius[own]], 3, axis=1).ravel()
    sums = max(program.weight[own[0]], program.force_sums(forces)[own[0]])
    gram = (rows / sums).T @ (forces[:, None] * rows / sums)
    least = np.sqrt(np.linalg.eigvalsh(gram)[0] * forces.min())
    for over in (0.9, 1.1):
        limit = least / (2 * np.sqrt(6 * count)) / over
        if limit * BEARS < forces.min() / forces.max():
            rough = replace(program, tolerance=np.full(len(program.names), limit))
            assert (judge_held(rough, Held(forces)) == "") == (over > 1)


def test_what_carries_is_above_its_limit(monkeypatch):
    """Far points with exactly an eighth of the largest force do not count at the limit."""
    program = program_of(over_the_edge(0.9, 0.1))
    program = replace(program, mass=program.mass * 18 / program.weight[1],
                      tolerance=np.array([0.0, 2.0**-29]))  # fmt: skip
    forces = np.array([8.0, 8.0, 1.0, 1.0] + [4.0] * 6)
    for bears, word in ((2.0**26, "its forces leave a motion neutral"), (2.0**25, "")):
        monkeypatch.setattr(held_judge, "BEARS", bears)
        assert judge_held(program, Held(forces)) == word


def test_what_is_out_of_balance_is_taken_part_by_part():
    """Over the weight of a part or the sum of its forces, with torques over its radius."""
    program = program_of(side_by_side([coupling(RADIAL), coupling(RADIAL)]))
    force = 2.0 * 9.81 / (6 * np.sqrt(0.5))
    assert unbalanced(program, np.full(12, force)) < 1e-12
    assert unbalanced(program, np.zeros(12)) == pytest.approx(1.0)
    for scale in (1.0, 5.0):  # then the sum of the forces is more than the weight
        for k in range(12):
            off = np.full(12, scale * force)
            off[k] += 1e-3 * force
            left = (program.wrenches(off) + program.load)[program.free]
            left[:, 3:] /= program.radius[program.free, None]
            most = np.abs(left).max(axis=1)
            most /= np.maximum(program.weight, program.force_sums(off))[program.free]
            assert unbalanced(program, off) == pytest.approx(most.max(), rel=1e-9)


def test_what_is_out_of_balance_may_be_at_its_limit(monkeypatch):
    program = program_of(coupling(RADIAL))
    exact = Held(np.full(6, 2.0 * 9.81 / (6 * np.sqrt(0.5))))
    for off, word in ((BALANCED, ""), (1.1 * BALANCED, "its forces do not balance the load")):
        monkeypatch.setattr(held_judge, "unbalanced", lambda *_, off=off: off)
        assert judge_held(program, exact) == word


@pytest.mark.parametrize("over", [0.9, 1.1])
def test_forces_balance_to_what_the_surfaces_are_known_by(over):
    program = program_of(coupling(RADIAL))
    exact = 2.0 * 9.81 / (6 * np.sqrt(0.5))
    for rough in (1e-9, 1e-7, 0.0):
        coarse = replace(program, tolerance=np.array([0.0, rough]))
        off = Held(np.full(6, exact * (1 + over * max(rough, 1e-9))))
        sums = float(program.force_sums(off.forces)[1] / program.weight[1])
        off = Held(np.full(6, exact * (1 + over * max(rough, 1e-9) * max(1.0, sums))))
        assert (judge_held(coarse, off) == "") == (over < 1)


def test_a_contact_may_carry_nothing_and_none_pulls():
    program = program_of(coupling(RADIAL))
    more = program.taking(np.append(np.arange(6), 0))
    forces = np.append(np.full(6, 2.0 * 9.81 / (6 * np.sqrt(0.5))), 0.0)
    assert judge_held(more, Held(forces)) == ""
    forces[0] += 1.0
    forces[6] = -1.0
    assert judge_held(more, Held(forces)) == "a contact force pulls"
    with pytest.raises(ValueError, match="read-only"):
        Held(forces).forces[0] = 1.0


JUST = (0.9, 1.1)
"""Factors of a limit, on both sides of it [-]."""
NOTHING = np.zeros((2, 0))


def beam(lever: float, *more: tuple[float, float]) -> np.ndarray:
    """Rows of (height, tilt): a support under the centre and a support beside it."""
    return np.array([(1.0, 0.0), (1.0, lever), *more])


@pytest.mark.parametrize("lever", [1.0, 0.1, 0.01])
@pytest.mark.parametrize("force", [1e-2, 1e-4])
@pytest.mark.parametrize("over", JUST)
def test_a_support_carries_where_its_torque_is_more_than_what_is_missing(lever, force, over):
    """For f small beside 1 the least eigenvalue is f l^2, so f m > r^2 is f l > r."""
    missing = force * lever / over
    forces = np.array([1.0, force])
    assert all_carry(csr_array(beam(lever)), forces, missing) == (over > 1.0 + force)


@pytest.mark.parametrize("seed", range(20))
def test_forces_that_balance_to_the_last_digit_push_on_all_that_carry(seed):
    random = np.random.default_rng(seed)
    rows = random.normal(size=(7, 4))
    forces = 10.0 ** random.uniform(-6, 0, 7)
    miss = random.normal(size=4)
    miss /= np.linalg.norm(miss)
    gram = rows.T @ (forces[:, None] * rows)
    change = np.abs(rows @ np.linalg.solve(gram, miss)).max()
    least = np.sqrt(forces.min() * np.linalg.eigvalsh(gram)[0])  # of what may be missing
    assert all_carry(csr_array(rows), forces, 0.99 * least)
    assert not all_carry(csr_array(rows), forces, 1.01 * least)
    assert least * change < 1


def test_what_they_do_not_hold_is_neutral_or_they_do_not_carry_it():
    row, one = csr_array(np.array([[1.0, 0.0]])), np.ones(1)
    tilt = np.array([[0.0], [1.0]])
    assert not all_carry(row, one, 1e-9)
    assert all_carry(row, one, 1e-9, tilt)
    assert not all_carry(row, one, 1e-9, tilt[::-1])
    assert not all_carry(row[:0], one[:0], 1e-9)
    assert not all_carry(row, one, 1e-9)
    for size in (1e3, 1e-3):  # what is lost in the rounding of the rest
        for lever in (0.9e-3, 1.1e-3):
            forces = size * np.array([1.0, 1e-7])
            found = all_carry(csr_array(beam(lever)), forces, 0.0)
            assert found == (lever > 1e-3)


@pytest.mark.parametrize("over", JUST)
@pytest.mark.parametrize("size", [1.0, 0.01, 100.0])
def test_of_a_problem_what_is_missing_and_what_may_be_counts(over, size):
    def carries(force: float, *, load: float = 0.0, blur: float = 1e-9) -> bool:
        rows = beam(0.5)
        forces = size * np.array([1.0, force])
        borne = -rows.T @ forces + size * load * np.eye(2)[1]
        problem = Stationary(rows, borne, np.zeros((2, 12, 12)), np.full((2, 12), -1), blur)
        every = np.ones(2, dtype=bool)
        return carry_beyond_doubt(problem, forces, every, NOTHING, problem.load)

    rounding = 1e-9 * np.sqrt(2)
    assert carries(over * 2 * rounding) == (over > 1)
    assert carries(over * 20 * rounding, blur=1e-8) == (over > 1)
    assert carries(over * 2e-3, load=1e-3) == (over > 1)


@pytest.mark.parametrize("over", JUST)
def test_a_row_carries_where_its_force_is_more_than_what_may_be_out_of_balance(over):
    for blur, size in ((1e-9, 3.0), (1e-8, 0.5), (1e-12, 1.0)):
        problem = Stationary(
            np.eye(2), np.ones(2), np.zeros((2, 12, 12)), np.full((2, 12), -1), blur
        )
        small = over * BEARS * max(blur, 1e-9) * size
        assert carrying_rows(problem, np.array([size, small])).tolist() == [True, over > 1]
    assert not carrying_rows(problem, np.zeros(2)).any()
    limit = 2.0**-20  # exact in binary
    exact = Stationary(np.eye(2), np.ones(2), np.zeros((2, 12, 12)), np.full((2, 12), -1), limit)
    assert carrying_rows(exact, np.array([1.0, BEARS * limit])).tolist() == [True, False]
