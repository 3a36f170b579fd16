"""Parts that lock one another: no order, whatever the paths and whatever is held."""

from __future__ import annotations

import numpy as np
import pytest
from read_proofs import proof_of, reasons
from scipy.optimize import linprog

import kilter
from kilter import Assembly, Part
from kilter.analysis.planning.order.locking import multipliers_of, opening, shuts
from kilter.analysis.planning.states.states import states
from kilter.scenes import scene
from kilter.scenes.pieces import block, turned_parts


def boxed(*, above: float = 1.0) -> Assembly:
    """A cube in a box whose lid is at a height."""
    walls = [
        block("west", [-1, -1, -1], [0, 2, 2]), block("east", [1, -1, -1], [2, 2, 2]),
        block("south", [0, -1, -1], [1, 0, 2]), block("north", [0, 1, -1], [1, 2, 2]),
        block("below", [0, 0, -1], [1, 1, 0]), block("above", [0, 0, above], [1, 1, 2]),
    ]  # fmt: skip
    held = [Part(p.name, p.shape, p.pose, grounded=True) for p in walls]
    return Assembly([*held, block("inside", [0, 0, 0], [1, 1, 1])])


@pytest.mark.parametrize("name", ["closed-frame", "boxed"])
def test_a_closed_box_locks(name: str) -> None:
    made = boxed() if name == "boxed" else scene(name)
    order = kilter.plan(made)
    assert (order.verdict, order.found) == ("impossible", False)
    answer = order.to_dict()
    assert answer["impossible"] == {
        "kind": "locking", "holds": None, "parts": [made.names[-1]], "motions": None
    }  # fmt: skip
    assert "cannot move" in answer["sentence"]
    assert not reasons(order, proof_of(order))


def test_a_lid_a_little_off_locks_nothing() -> None:
    order = kilter.plan(boxed(above=1.01))
    assert (order.verdict, order.locked) == ("none-found", ())


@pytest.mark.parametrize("change", ["zero", "fewer", "other"])
def test_other_multipliers_are_refused(change: str) -> None:
    order = kilter.plan(boxed())
    proof = proof_of(order)
    [entry] = proof["proofs"]
    values = entry["multipliers"]
    entry["multipliers"] = {
        "zero": [0.0 if k < 4 else one for k, one in enumerate(values)],
        "fewer": values[:-1],
        "other": [2.0 * values[0], *values[1:]],
    }[change]
    assert "the multipliers do not prove that" in reasons(order, proof)


def test_locked_wherever_it_is() -> None:
    moved = turned_parts(list(boxed()), [0.8, 0.36, -0.48, 0.0])
    assert kilter.plan(Assembly(moved)).verdict == "impossible"


@pytest.mark.slow
def test_multipliers_exist_where_no_motion_opens() -> None:
    """Against linear programs that seek a motion, on random rows."""
    random = np.random.default_rng(7)
    seen = set()
    for _ in range(60):
        rows = random.normal(size=(int(random.integers(7, 20)), 6))
        sides = np.zeros(len(rows))
        found = linprog(-rows.sum(axis=0), A_ub=-rows, b_ub=sides, bounds=[(-1, 1)] * 6)
        moves = found.fun < -1e-9
        seen.add(moves)
        multipliers = multipliers_of(rows)
        assert (multipliers is None) == moves
        if multipliers is not None:
            assert shuts(rows, multipliers)
            other = multipliers.copy()
            other[0] *= 2
            assert not shuts(rows, other)
    assert seen == {True, False}


def test_a_flat_cone_of_normals_locks_within_its_angle() -> None:
    """Rows that let y slip out but for a lean: they lock while the lean shows, in closed form."""
    axes = np.vstack([np.eye(6)[1:], -np.eye(6)[1:]])
    for lean, locks in ((1e-1, True), (1e-3, True), (1e-5, False), (0.0, False)):
        pair = np.array([[lean, 1, 0, 0, 0, 0], [-lean, 1, 0, 0, 0, 0]])
        assert (multipliers_of(np.vstack([axes, pair, -pair])) is not None) == locks


def test_rows_open_as_a_part_moves_away() -> None:
    made = states(boxed())
    program = made.of().program
    part = len(made.assembly) - 1
    rows = opening(program, part, np.ones(len(program.part_a), dtype=bool))
    away = program.normal * np.where(program.part_b == part, 1, -1)[:, None]
    assert np.allclose(rows[:, :3], away)
