"""Plans whose states carry an acceleration of their carrier: closed forms, checks of each state."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from read_proofs import proof_of, reasons, signed

import kilter
from kilter import Assembly, InputError, PlanRules
from kilter.analysis.planning.order.carried_accelerations import SIDES, extreme_accelerations
from kilter.cli import main
from kilter.scenes.pieces import block

G = 9.81
WIDTH, HEIGHT = 0.2, 0.8
"""The post alone tips at WIDTH / HEIGHT = 0.25 g."""


def stack(count: int = 3) -> Assembly:
    """A tower of cubes on a deck, which tips at g / count along an axis."""
    cubes = [block(f"cube-{k}", [0, 0, k], [1, 1, k + 1]) for k in range(count)]
    deck = block("deck", [-3, -3, -1], [4, 4, 0], grounded=True)
    return Assembly([deck, *cubes], friction=0.9)


def post_in_a_vice() -> Assembly:
    """A post that tips at 0.25 g along x alone, between two blocks that keep it upright."""
    return Assembly(
        [
            block("deck", [-2, -2, -1], [2, 2, 0], grounded=True),
            block("post", [-WIDTH / 2, -0.4, 0], [WIDTH / 2, 0.4, HEIGHT], mass=10.0),
            block("left", [-1, -0.4, 0], [-WIDTH / 2, 0.4, 0.6], mass=100.0),
            block("right", [WIDTH / 2, -0.4, 0], [1, 0.4, 0.6], mass=100.0),
        ],
        friction=0.9,
    )


@pytest.mark.quick(2)
@pytest.mark.parametrize("share", [0.999, 1.001])
def test_a_tower_carries_its_closed_form_as_a_vector(share: float) -> None:
    order = kilter.plan(stack(), PlanRules(carried=[share * G / 3, 0, 0], hold=0))
    assert order.verdict == ("found" if share < 1 else "impossible")
    proof = proof_of(order)
    assert not reasons(order, proof)
    if share > 1:
        assert "at a required acceleration" in order.to_dict()["sentence"]


def test_every_horizontal_direction_is_covered_by_the_corners() -> None:
    corners = extreme_accelerations(stack(), 2.0)
    angle = np.linspace(0, 2 * np.pi, 721)
    circle = 2.0 * np.column_stack([np.cos(angle), np.sin(angle)])
    edges = np.roll(corners[:, :2], -1, axis=0) - corners[:, :2]
    outward = np.column_stack([edges[:, 1], -edges[:, 0]])
    outward *= np.sign(np.einsum("ij,ij->i", outward, corners[:, :2]))[:, None]
    reach = np.einsum("ij,ij->i", outward, corners[:, :2])
    assert (circle @ outward.T <= reach + 1e-12).all()
    assert len(corners) == SIDES


def test_a_post_is_held_until_its_blocks_stand() -> None:
    """Between its blocks the post carries 0.3 g, alone only 0.25 g, so it is held before."""
    assembly = post_in_a_vice()
    rules = {"before": [("post", "left"), ("post", "right")], "directions": [[0, 0, 1]]}
    still = kilter.plan(assembly, PlanRules(**rules))  # type: ignore[arg-type]
    assert still.holds_max == 0
    order = kilter.plan(assembly, PlanRules(carried=[0.3 * G, 0, 0], **rules))  # type: ignore[arg-type]
    assert order.found
    assert [step.held for step in order.steps[1:]] in ([("post",), ()], [("post",), ("post",)])
    proof = proof_of(order)
    assert not reasons(order, proof)
    assert any(entry["about"] == "not fewer" for entry in proof["proofs"])
    without = {**proof, "proofs": [e for e in proof["proofs"] if e["about"] != "carried"]}
    wrong = reasons(order, signed(without))
    assert "step 2 is not proved at every required acceleration" in wrong
    other = proof_of(order)
    other["rules"]["carried"] = [[0.4 * G, 0, 0]]
    wrong = reasons(order, signed(other))
    assert "at an acceleration that the rules do not require" in wrong


def test_the_command_states_what_is_carried(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, proof = tmp_path / "stack.kilter.json", tmp_path / "p.json"
    kilter.dump(stack(2), path)
    words = ["plan", str(path), "--carried", "0.4g,0,0", "--proof", str(proof)]
    assert main(words) == 0
    assert "(3.924, 0, 0) m/s^2" in capsys.readouterr().out
    assert main(["verify", str(path), str(proof)]) == 0
    assert main(["plan", str(path), "--carried", "0.6g,0,0"]) == 1


@pytest.mark.parametrize(
    ("value", "message"),
    [(-1.0, "carried"), ([0, 0, -G], "falls freely"), ([0, np.inf, 0], "finite")],
)
def test_wrong_accelerations_are_refused(value: object, message: str) -> None:
    with pytest.raises(InputError, match=message):
        kilter.plan(stack(), PlanRules(carried=value))  # type: ignore[arg-type]


def test_turns_are_not_combined_with_accelerations() -> None:
    with pytest.raises(InputError, match="turns cannot be combined"):
        PlanRules(carried=1.0, turn=True)
