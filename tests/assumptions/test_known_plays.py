"""Known answers of play and of glue, through `kilter.check` with an assumption.

The scenes are those of `play_scenes`, with gaps within the play of a part of their size. The poses
agree with the closed forms to 1e-6 of the size.
"""

import json
import math
from functools import partial

import numpy as np
import pytest
from play_scenes import (
    KnownRest,
    ball_in_groove,
    button,
    cabinet,
    cylinder_in_channel,
    drawer,
    key_in_slot,
    lid,
    pin_in_blind_hole,
    pin_in_hole,
    pin_in_through_hole,
    ring_on_bar,
    side_by_side,
    stack_with_gaps,
    sunk_stack,
)

import kilter
from kilter.cli import main
from kilter.scenes.pieces import block, cells

CLOSE = 1e-6
"""Largest error of a position over the size of the assembly [-], and of an angle [rad]."""
RESTS = {
    "pin in a hole": pin_in_hole,
    "pin in a blind hole": partial(pin_in_blind_hole, h=3e-4),
    "button": button,
    "square button": partial(button, square=True),
    "drawer": drawer,
    "lid": lid,
    "lid around its box": partial(lid, inside=False),
    "stack with gaps": partial(stack_with_gaps, (1e-3, 5e-4, 2e-4)),
    "stack in another order": partial(stack_with_gaps, (1e-3, 5e-4, 2e-4), order=(2, 0, 1)),
    "sunk box": partial(sunk_stack, 1),
    "sunk stack": sunk_stack,
    "side by side": side_by_side,
    "ball in a groove": partial(ball_in_groove, h=3e-4),
    "cylinder in a channel": partial(cylinder_in_channel, h=3e-4),
    "key in a slot": key_in_slot,
    "ring on a bar": partial(ring_on_bar, D=0.0104),
}
FALLS = {
    "pin in a through hole": pin_in_through_hole,
    "button without a flange": partial(button, flanged=False),
    "drawer without rails": partial(drawer, rails=False),
    "boards without glue": cabinet,
}


def movement(
    verdict: kilter.Verdict, drawn: kilter.Assembly, name: str
) -> tuple[list[float], float]:
    """The shift of a part from its drawn pose, and the angle of its rotation [rad]."""
    place = drawn.index[name]
    shift = verdict.assembly.geometry.center[place] - drawn.geometry.center[place]
    turn = verdict.assembly[name].pose.matrix @ drawn[name].pose.matrix.T
    # half the size of the antisymmetric part is the sine of the angle
    sine = 0.5 * np.linalg.norm([turn[i, j] - turn[j, i] for i, j in ((2, 1), (0, 2), (1, 0))])
    return shift.tolist(), math.atan2(float(sine), (float(np.trace(turn)) - 1) / 2)


@pytest.mark.slow
@pytest.mark.parametrize("rung", ["play", "fits"])
@pytest.mark.parametrize("build", RESTS.values(), ids=list(RESTS))
def test_parts_that_have_play_are_held_where_geometry_says(build, rung):
    known: KnownRest = build()
    drawn = known.assembly
    verdict = kilter.check(drawn, assume=rung, require="equilibrium")
    assert verdict.assume == rung
    assert verdict.level is not None
    size = float(np.linalg.norm(np.ptp(drawn.geometry.vertices, axis=0)))
    for name, expected in known.shift.items():
        shift, angle = movement(verdict, drawn, name)
        assert shift == pytest.approx(expected, abs=CLOSE * size)
        assert angle == pytest.approx(known.angle.get(name, 0.0), abs=CLOSE)
    assert kilter.verify(verdict.assembly, verdict.proof()).holds


@pytest.mark.slow
@pytest.mark.parametrize("build", FALLS.values(), ids=list(FALLS))
def test_parts_that_fall_further_than_their_play_fall(build):
    known: KnownRest = build()
    verdict = kilter.check(known.assembly, assume="play", require="equilibrium")
    assert verdict.level is None
    assert set(verdict.moving) == {*known.leaves, *(n for n, by in known.shift.items() if any(by))}


@pytest.mark.slow
@pytest.mark.parametrize("play", [0.9, 1.1])
def test_a_pin_falls_from_a_hole_that_is_wider_than_its_play(play):
    """The limit of the play of a part decides between a row that holds and one that falls."""
    length = 0.05
    least = 0.02 * length * play  # two per cent of the size
    known = pin_in_blind_hole(0.02, 0.0206, length, least)
    verdict = kilter.check(known.assembly, assume="play", require="equilibrium")
    assert (verdict.level is not None) == (play < 1)


def rim_of(parts: list[kilter.Part]) -> tuple[float, float, np.ndarray]:
    """Least distance of the centre of mass of boxes from an edge of their foot, its height, down.

    The foot is a rectangle along x and y; `down` is the outward normal of the nearest edge.
    """
    low = np.array([part.pose.position - part.shape.size / 2 for part in parts])
    high = np.array([part.pose.position + part.shape.size / 2 for part in parts])
    volume = np.prod(high - low, axis=1)
    middle = (volume @ (low + high)) / (2 * volume.sum())
    foot = low[:, 2] < 1e-9
    left, right = low[foot].min(axis=0)[:2], high[foot].max(axis=0)[:2]
    arms = [*(middle[:2] - left), *(right - middle[:2])]
    nearest = int(np.argmin(arms))
    down = np.zeros(3)
    down[nearest % 2] = -1.0 if nearest < 2 else 1.0
    return float(arms[nearest]), float(middle[2]), down


@pytest.mark.slow
@pytest.mark.parametrize("size", [(0.6, 0.3, 0.8), (0.3, 0.5, 1.4)])
def test_joined_boards_are_a_body_that_tips_at_a_known_angle(size):
    """Answer 11: six boards without glue; the tilt is atan(b / h)."""
    boards = [part for part in cabinet(size, 0.02, 0.4).assembly.parts if part.name != "floor"]
    drawn = kilter.Assembly(boards, friction=0.4)
    assert kilter.check(drawn, floor=True).moving == ["shelf"]
    verdict = kilter.check(drawn, floor=True, assume="joined", require="equilibrium")
    assert verdict.level is not None
    assert "touching parts are joined" in verdict.sentence
    (body,) = verdict.bodies
    assert (len(body.parts), body.on_floor) == (len(boards), True)
    arm, height, outward = rim_of(boards)
    assert body.tilt_deg == pytest.approx(math.degrees(math.atan2(arm, height)), abs=1e-6)
    angle = math.radians(body.tilt_deg)
    down = math.sin(angle) * outward - [0, 0, math.cos(angle)]
    assert list(body.tilt_down) == pytest.approx(down, abs=1e-6)


@pytest.mark.slow
def test_the_proof_of_a_pose_within_the_play_contains_the_pose(tmp_path, capsys):
    """The proof is verified with the drawn file, whose parts hover."""
    path = tmp_path / "lid.kilter.json"
    kilter.dump(lid().assembly, path)
    proof = tmp_path / "lid.proof.json"
    assert main(["check", str(path), "--assume", "play", "--proof", str(proof)]) == 0
    assert main(["verify", str(path), str(proof)]) == 0
    data = json.loads(proof.read_text(encoding="utf-8"))
    poses = data["options"]["entries"]["poses"]
    poses["lid"]["position"][2] += 1e-3  # as drawn
    proof.write_text(json.dumps(data), encoding="utf-8")
    assert main(["verify", str(path), str(proof)]) != 0
    capsys.readouterr()


def test_bodies_within_each_other_fall_together():
    """A bar in a ring: each falls onto the other; together they fall until the ring is down."""
    across = [-0.05, -0.02, 0.02, 0.05]
    solid = np.ones((3, 1, 3), dtype=bool)
    solid[1, 0, 1] = False
    ring = kilter.Part("ring", cells(across, [-0.05, 0.05], across, solid), [0, 0, 0.15])
    bar = block("bar", [-0.01, -0.2, 0.14], [0.01, 0.2, 0.16])
    verdict = kilter.check(kilter.Assembly([ring, bar]), floor=0.0, assume="joined")
    falls = {body.name: (body.below, body.fall) for body in verdict.bodies}
    assert falls["ring"] == ("floor", pytest.approx(0.1))
    assert falls["bar"] == ("ring", pytest.approx(0.01))
