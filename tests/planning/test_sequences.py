"""Given orders, judged step by step: what fails and why; read from files."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from read_proofs import proof_of, reasons

import kilter
from kilter import Assembly, InputError, Pose
from kilter.files.sequence import read_sequence
from kilter.scenes import scene
from kilter.scenes.arches import arch
from kilter.scenes.pieces import block, floor

CUBES = [f"cube-{k}" for k in range(1, 6)]


@pytest.mark.slow
def test_the_order_of_a_plan_is_confirmed() -> None:
    made = arch(9, ratio=0.3, friction=0.6)
    plan = kilter.plan(made)
    order = kilter.plan(made, kilter.PlanRules(sequence=[step.parts for step in plan.steps]))
    assert [step.held for step in order.steps] == [step.held for step in plan.steps]
    assert (order.verdict, order.level) == ("found", plan.level)
    assert order.to_dict()["sentence"].startswith("It can be put together in this order, in 9")
    assert not reasons(order, proof_of(order))


def test_an_order_the_other_way_round_fails_at_each_step() -> None:
    """Cubes from the top: nothing to stand on, until the lowest is put under the others."""
    order = kilter.plan(scene("tower"), kilter.PlanRules(sequence=CUBES[::-1], hold=0))
    assert order.verdict == "fails"
    first, second, *_, last = order.steps
    assert first.fails == ("it touches no standing part",)
    assert second.fails == ("'cube-5' would fall before it is in place",)
    assert second.level is None
    assert "no free path was found along the directions that were tried" not in last.fails
    words = order.to_dict()["sentence"]
    assert words.startswith("This order fails at step 1, 'cube-5': it touches no standing part")
    assert words.endswith("4 further steps fail.")
    with pytest.raises(InputError, match="nothing is proved"):
        order.proof()


@pytest.mark.slow
def test_holds_that_are_needed_are_told() -> None:
    made = arch(9, ratio=0.3, friction=0.6)
    one_side = [f"voussoir-{k}" for k in range(9)]
    order = kilter.plan(made, kilter.PlanRules(sequence=one_side))
    assert (order.found, order.holds_max) == (True, 1)
    assert kilter.plan(made, kilter.PlanRules(sequence=one_side, hold=0)).verdict == "fails"


def test_a_step_without_a_way_proves_nothing() -> None:
    """A lid over a box before what comes into it."""
    walls = [
        block("west", [-1, -1, 0], [0, 2, 1]), block("east", [1, -1, 0], [2, 2, 1]),
        block("south", [0, -1, 0], [1, 0, 1]), block("north", [0, 1, 0], [1, 2, 1]),
    ]  # fmt: skip
    made = Assembly(
        [
            floor([-3, -3], [3, 3]),
            *(kilter.Part(p.name, p.shape, p.pose, grounded=True) for p in walls),
            kilter.Part("inside", kilter.Box([1, 1, 0.9]), Pose([0.5, 0.5, 0.45])),
            block("lid", [-1, -1, 1], [2, 2, 1.5]),
        ]
    )
    assert kilter.plan(made, kilter.PlanRules(sequence=["inside", "lid"])).found
    order = kilter.plan(made, kilter.PlanRules(sequence=["lid", "inside"]))
    assert [step.fails for step in order.steps] == [
        (), ("no free path was found along the directions that were tried",)
    ]  # fmt: skip
    assert (order.verdict, order.steps[1].direction) == ("none-found", None)
    assert order.to_dict()["steps"][1]["path"] == [[0.0, 0.0, 0.0]]
    assert "was not confirmed" in order.to_dict()["sentence"]


def test_parts_that_come_too_early() -> None:
    order = kilter.plan(
        scene("tower"), kilter.PlanRules(sequence=CUBES, before=[("cube-5", "cube-2")])
    )
    assert [step.part for step in order.steps if step.fails] == ["cube-5"]
    assert order.steps[-1].fails == ("it must come before 'cube-2'",)


def test_sequences_from_files(tmp_path: Path) -> None:
    order = kilter.plan(scene("tower"), kilter.PlanRules(groups=["cube-[23]"]))
    wanted = [["cube-1"], ["cube-2", "cube-3"], ["cube-4"], ["cube-5"]]
    texts = {
        "a.csv": order.table(),
        "a.json": json.dumps(order.to_dict()),
        "b.json": json.dumps(["cube-1", ["cube-2", "cube-3"], "cube-4", "cube-5"]),
    }
    for name, text in texts.items():
        (tmp_path / name).write_text(text)
        assert read_sequence(tmp_path / name) == wanted
    (tmp_path / "a.txt").write_text("# upwards\ncube-1\n\n cube-2 \n")
    assert read_sequence(tmp_path / "a.txt") == [["cube-1"], ["cube-2"]]


@pytest.mark.parametrize(
    ("name", "text", "why"),
    [
        ("a.csv", "name,x\na,1\n", "no column 'part'"),
        ("a.json", "{}", "no sequence"),
        ("b.json", "[[1]]", "a step is"),
        ("c.json", "[", "not JSON"),
    ],
)
def test_files_that_are_no_sequence(tmp_path: Path, name: str, text: str, why: str) -> None:
    (tmp_path / name).write_text(text)
    with pytest.raises(InputError, match=why):
        read_sequence(tmp_path / name)


@pytest.mark.parametrize(
    ("sequence", "why"),
    [
        (["cube-1"], "leaves out 'cube-2'"),
        ([*CUBES, "cube-1"], "'cube-1' comes twice"),
        (["base", *CUBES], "'base' is grounded, so it stands from the start"),
        (["nobody"], "nobody"),
        ([], "leaves out"),
        ([[]], "a step of the sequence names no part"),
    ],
)
def test_sequences_that_make_no_sense(sequence: list[str], why: str) -> None:
    with pytest.raises(InputError, match=why):
        kilter.plan(scene("tower"), kilter.PlanRules(sequence=sequence))
