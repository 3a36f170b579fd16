"""Paths of a robot's flange from joint values: closed forms, differences, and wrong input."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from boxes_on_deck import stack_on_deck

import kilter
from kilter.analysis.transport.robot_path import flange_motion, path_from_joints, read_robot_path
from kilter.cli import main
from kilter.errors import InputError
from kilter.files.urdf_chain import read_joint_chain

G, MU = 9.81, 0.4
BOX = '<collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision>'
TIME = np.linspace(0.0, 2.0, 41)


def joint(name: str, kind: str, ends: str, *, xyz: str = "0 0 0", rpy: str = "0 0 0",
          axis: str = "0 0 1", more: str = "") -> str:  # fmt: skip
    parent, child = ends.split()
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{xyz}" rpy="{rpy}"/><axis xyz="{axis}"/>{more}</joint>'
    )


def robot(folder: Path, *joints: str) -> Path:
    """A robot with links base, a, b, c, d that have a box each."""
    links = "".join(f'<link name="{name}">{BOX}</link>' for name in ("base", *"abcd"))
    file = folder / "robot.urdf"
    file.write_text(f'<robot name="r">{links}{"".join(joints)}</robot>')
    return file


def table(folder: Path, columns: dict[str, np.ndarray]) -> Path:
    file = folder / "joints.csv"
    rows = np.column_stack(list(columns.values()))
    lines = [",".join(columns), *(",".join(f"{value:.12g}" for value in row) for row in rows)]
    file.write_text("\n".join(lines))
    return file


def random_robot(folder: Path, seed: int) -> Path:
    """A chain with joints of all types, random transforms and axes."""
    rng = np.random.default_rng(seed)

    def words(scale: float) -> str:
        return " ".join(f"{value:.6f}" for value in rng.normal(size=3) * scale)

    kinds = rng.permutation(["revolute", "continuous", "prismatic", "fixed"])
    limit = '<limit lower="-9" upper="9" effort="1" velocity="1"/>'
    ends = ("base a", "a b", "b c", "c d")
    return robot(
        folder,
        *(
            joint(f"j{k}", kind, ends[k], xyz=words(0.4), rpy=words(1.0), axis=words(1.0),
                  more=limit)
            for k, kind in enumerate(kinds)
        ),
    )  # fmt: skip


@pytest.mark.quick(2)
@pytest.mark.parametrize("seed", range(20))
def test_motions_agree_with_differences_of_the_poses(seed: int, tmp_path: Path) -> None:
    chain = read_joint_chain(random_robot(tmp_path, seed), "d")
    assert len(chain.drivers) == 3
    rng = np.random.default_rng([seed, 1])
    terms = {name: rng.normal(size=4) * [1, 1, 0.5, 0.2] for name in chain.drivers}
    step = 1e-3
    time = 0.4 + step * np.arange(-2, 3)

    def at(order: int) -> dict[str, np.ndarray]:
        return {name: np.polynomial.Polynomial(c).deriv(order)(time) if order else
                np.polynomial.Polynomial(c)(time) for name, c in terms.items()}  # fmt: skip

    motion = flange_motion(chain, at(0), at(1), at(2))
    first = np.array([1, -8, 0, 8, -1]) / (12 * step)
    second = np.array([-1, 16, -30, 16, -1]) / (12 * step**2)
    assert np.allclose(motion.velocity[2], first @ motion.position, atol=1e-8, rtol=1e-8)
    assert np.allclose(motion.acceleration[2], second @ motion.position, atol=1e-6, rtol=1e-6)
    rate = np.einsum("n,nij->ij", first, motion.rotation) @ motion.rotation[2].T
    spin = [rate[2, 1], rate[0, 2], rate[1, 0]]
    assert np.allclose(motion.spin[2], spin, atol=1e-8, rtol=1e-8)
    assert np.allclose(motion.turn[2], first @ motion.spin, atol=1e-8, rtol=1e-8)
    size = np.linalg.norm(motion.rotation @ motion.rotation.transpose(0, 2, 1) - np.eye(3))
    assert size < 1e-12


@pytest.mark.parametrize("seed", range(5))
def test_the_zero_position_is_that_of_the_urdf_reader(seed: int, tmp_path: Path) -> None:
    """Another reading of the same file: the box of a link is at the origin of its frame."""
    file = random_robot(tmp_path, seed)
    assembly = kilter.load(file)
    for link in "abcd":
        chain = read_joint_chain(file, link)
        none = {name: np.zeros(1) for name in chain.drivers} or {"": np.zeros(1)}
        pose = flange_motion(chain, none, none, none)
        part = assembly.parts[assembly.names.index(link)]
        assert np.allclose(pose.position[0], part.pose.position, atol=1e-12)
        assert np.allclose(pose.rotation[0], part.pose.matrix, atol=1e-12)


def test_an_arm_that_turns_and_extends_at_the_same_time(tmp_path: Path) -> None:
    """Polar coordinates: a_r = r'' - r o^2, a_t = r al + 2 r' o."""
    file = robot(
        tmp_path,
        joint("turn", "continuous", "base a"),
        joint("reach", "prismatic", "a b", axis="1 0 0",
              more='<limit lower="0" upper="9" effort="1" velocity="1"/>'),
    )  # fmt: skip
    chain = read_joint_chain(file, "b")
    path = path_from_joints(
        chain, TIME, {"turn": 0.3 * TIME**3, "reach": 0.5 + 0.2 * TIME + 0.1 * TIME**3}
    )
    reach, rate, second = 0.5 + 0.2 * TIME + 0.1 * TIME**3, 0.2 + 0.3 * TIME**2, 0.6 * TIME
    spin, turn = 0.9 * TIME**2, 1.8 * TIME
    expected = [second - reach * spin**2, reach * turn + 2 * rate * spin, 0 * TIME]
    assert np.allclose(path.acceleration, np.column_stack(expected), atol=1e-9)
    assert np.allclose(path.velocity, np.column_stack([rate, reach * spin, 0 * TIME]), atol=1e-9)
    assert np.allclose(path.angular_acceleration[:, 2], turn, atol=1e-9)


def test_a_flange_on_a_circle_carries_a_box_as_fast_as_the_closed_form(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    speed, radius = 1.2, 0.8
    file = robot(
        tmp_path,
        joint("turn", "continuous", "base a"),
        joint("arm", "fixed", "a b", xyz=f"{radius} 0 0.5"),
        joint("grip", "revolute", "b c", more='<limit lower="0" upper="1"/>'),
    )
    joints = table(tmp_path, {"time": TIME, "turn": speed / radius * TIME, "grip": 0 * TIME})
    load = tmp_path / "box.kilter.json"
    kilter.dump(stack_on_deck([[0.4, 0.4, 0.1]], MU), load)
    path = read_robot_path(joints, file, "b")
    expected = np.sqrt(MU * G * radius) / speed
    assert kilter.transport(load, path=path).speed.factor == pytest.approx(expected, rel=1e-6)
    words = ["transport", str(load), "--path", str(joints), "--robot", str(file), "--flange", "b"]
    assert main(words) == 0
    assert "1.47648 times as fast" in capsys.readouterr().out


@pytest.mark.parametrize(("units", "per_metre"), [("m", 1.0), ("mm", 1000.0)])
def test_a_box_beside_the_flange_is_on_a_wider_circle(
    units: str, per_metre: float, tmp_path: Path
) -> None:
    """The flange is .8 m from the axis, the box .5 m farther out, in the unit of its file."""
    ends = joint("arm", "fixed", "a b", xyz="0.8 0 0.5")
    file = robot(tmp_path, joint("turn", "continuous", "base a"), ends)
    joints = table(tmp_path, {"time": TIME, "turn": 1.5 * TIME})
    size = np.array([0.4, 0.4, 0.1]) * per_metre
    deck = kilter.Part("deck", kilter.Box([2 * per_metre] * 3), [0, 0, -per_metre], grounded=True)
    box = kilter.Part("box", kilter.Box(size), [0.5 * per_metre, 0, 0.05 * per_metre])
    assembly = kilter.Assembly([deck, box], units=units, friction=MU)
    speed = kilter.transport(assembly, path=read_robot_path(joints, file, "b")).to_dict()["speed"]
    assert speed["factor"] == pytest.approx(np.sqrt(MU * G / (1.5**2 * 1.3)), rel=1e-6)


def test_a_wrist_that_tilts_a_box_to_its_angle_of_friction(tmp_path: Path) -> None:
    """At rest at 21 deg of tilt the box stays (tan 21 = .38); at 22.5 deg it slides (.414)."""
    file = robot(
        tmp_path,
        joint("wrist", "revolute", "base a", axis="0 1 0",
              more='<limit lower="-3" upper="3"/><mimic joint="motor" multiplier="0.5"/>'),
        joint("motor", "continuous", "base b"),
    )  # fmt: skip
    box = stack_on_deck([[0.4, 0.4, 0.1]], MU)
    chain = read_joint_chain(file, "a")
    assert chain.drivers == ("motor",)
    for degrees, holds in ((21.0, True), (22.5, False)):
        tilt = 2 * np.radians(degrees) * (1 - np.cos(np.pi * TIME / 2)) / 2
        answer = kilter.transport(box, path=path_from_joints(chain, 100 * TIME, {"motor": tilt}))
        assert answer.carried == holds


@pytest.mark.parametrize(
    ("columns", "flange", "words"),
    [
        ({"time": TIME, "turn": TIME}, "z", "no link 'z'"),
        ({"time": TIME, "trun": TIME}, "a", "unknown column 'trun'; did you mean turn"),
        ({"time": TIME, "lift": TIME}, "a", "no column for the joint turn"),
        ({"time": TIME, "turn": 90 * TIME}, "a", "the joint turn is at 4.5 at 0.05 s"),
        ({"time": TIME, "turn": TIME}, "base", "no joint moves the flange"),
        ({"time": TIME, "turn": TIME}, "c", "the type 'floating'"),
        ({"time": -TIME, "turn": TIME}, "a", "increasing times"),
        ({"time": TIME[:2], "turn": TIME[:2]}, "a", "has no acceleration"),
    ],
)
def test_wrong_input_is_an_error_of_one_sentence(
    columns: dict[str, np.ndarray], flange: str, words: str, tmp_path: Path
) -> None:
    file = robot(
        tmp_path,
        joint("turn", "revolute", "base a", more='<limit lower="-3" upper="3"/>'),
        joint("lift", "prismatic", "a b", more='<limit lower="-9" upper="9"/>'),
        joint("free", "floating", "b c"),
    )
    with pytest.raises(InputError, match=words):
        read_robot_path(table(tmp_path, columns), file, flange)


def test_options_of_a_robot_belong_together(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = robot(tmp_path, joint("turn", "continuous", "base a"))
    load = tmp_path / "box.kilter.json"
    kilter.dump(stack_on_deck([[0.4, 0.4, 0.1]], MU), load)
    assert main(["transport", str(load), "--robot", str(file)]) == 2
    assert "--flange is missing" in capsys.readouterr().err
    assert main(["transport", str(load), "--robot", str(file), "--flange", "a"]) == 2
    assert "--robot has no path" in capsys.readouterr().err
    joints = table(tmp_path, {"time": TIME, "turn": TIME})
    words = ["transport", str(load), "--path", str(joints), "--robot", str(load), "--flange", "a"]
    assert main(words) == 2
    assert "the XML is invalid" in capsys.readouterr().err
