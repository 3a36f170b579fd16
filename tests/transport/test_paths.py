"""Paths of carriers and robots, and their constraints."""

from pathlib import Path

import numpy as np
import pytest
from boxes_on_deck import random_stack, stack_on_deck

import kilter
from kilter import CarrierMotion, CarrierPath, InputError, contacts
from kilter.analysis.load_limit import NoLimit
from kilter.analysis.transport.carrier import carried_assembly
from kilter.analysis.transport.carrier_path import path_from_poses, read_path
from kilter.analysis.transport.path import find_path_limit
from kilter.analysis.transport.robot_path import flange_motion, path_from_joints, read_robot_path
from kilter.cli import main
from kilter.files.robots.urdf_chain import read_joint_chain
from kilter.mechanics.program import build_program

G, MU = 9.81, 0.4
TIME = np.linspace(0, 3, 61)


def _flat() -> kilter.Assembly:
    """A flat box that slides before it tips."""
    return stack_on_deck([[0.4, 0.4, 0.1]], MU)


def _level(acceleration: np.ndarray, time: np.ndarray = TIME, degrees: float = 0.0) -> CarrierPath:
    """A straight path with given accelerations, on a slope that rises along x."""
    angle = np.radians(degrees)
    slope = np.array(
        [[np.cos(angle), 0, -np.sin(angle)], [0, 1, 0], [np.sin(angle), 0, np.cos(angle)]]
    )
    none = np.zeros((len(time), 3))
    rotation = np.repeat(slope[None], len(time), axis=0)
    return CarrierPath(time, rotation, acceleration, none, none, np.zeros(3), True)


def _factor(path: CarrierPath, assembly: kilter.Assembly | None = None) -> float:
    answer = kilter.transport(assembly or _flat(), path=path).speed
    assert answer.lower <= answer.factor
    assert answer.lower >= answer.factor * (1 - 1e-6)
    return answer.factor


def test_trapezoid():
    along = np.where(TIME < 1, 2.0, np.where(TIME < 2, 0.0, -2.0))
    path = _level(np.column_stack([along, 0 * along, 0 * along]))
    assert _factor(path) == pytest.approx(np.sqrt(MU * G / 2), rel=1e-6)


def test_circle_at_fixed_heading_and_along_it():
    speed, radius = 1.2, 0.8
    angle = speed / radius * TIME
    inward = np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    expected = np.sqrt(MU * G * radius) / speed
    path = _level(-(speed**2) / radius * inward[:12], TIME[:12])
    assert _factor(path) == pytest.approx(expected, rel=1e-6)
    turning = np.column_stack([np.cos(angle / 2), 0 * angle, 0 * angle, np.sin(angle / 2)])
    none = np.zeros((len(TIME), 3))
    spin = np.tile([0, 0, speed / radius], (len(TIME), 1))
    ahead = np.tile([-(speed**2) / radius, 0, 0], (len(TIME), 1))
    rotation = path_from_poses(TIME, radius * inward, turning).rotation
    along = CarrierPath(TIME, rotation, ahead, spin, none, np.zeros(3), False)
    answer = kilter.transport(_flat(), path=along)
    # the box turns with the carrier about its own centre, which needs no force
    assert answer.speed.factor == pytest.approx(expected, rel=1e-6)
    assert not answer.speed.between_samples


@pytest.mark.parametrize("degrees", [8, -25])
def test_slopes(degrees):
    """Down a steep slope the box needs the acceleration, so the squared factors are an interval.

    Along the slope, |g sin + 2 lambda| is at most mu g cos.
    """
    along, down = np.sin(np.radians(degrees)), np.cos(np.radians(degrees))
    largest, least = (G * (sign * MU * down - along) / 2.0 for sign in (1, -1))
    path = _level(np.tile([2.0, 0, 0], (3, 1)), np.arange(3.0), degrees)
    answer = kilter.transport(_flat(), path=path).speed
    assert answer.factor == pytest.approx(np.sqrt(largest), rel=1e-6)
    assert answer.slowest == pytest.approx(np.sqrt(max(least, 0.0)), abs=1e-6)


@pytest.mark.quick(1)
@pytest.mark.parametrize("seed", range(20))
def test_check_agrees_on_both_sides_at_random_samples(seed):
    """The factor is the least over the samples: check holds below it at each, and not above it."""
    assembly = random_stack(seed)
    if kilter.check(assembly, require="equilibrium").level is None:
        return
    rng = np.random.default_rng(seed)
    path = _level(rng.normal(size=(5, 3)) * [1, 1, 0.4], np.arange(5.0))
    answer = kilter.transport(assembly, path=path).speed
    share = answer.factor**2

    def held(sample: int, at: float) -> bool:
        felt = carried_assembly(assembly, CarrierMotion(at * path.acceleration[sample]))
        return kilter.check(felt, require="equilibrium").level is not None

    assert all(held(sample, share * (1 - 1e-3)) for sample in range(5))
    first = int(np.flatnonzero(path.time == answer.time)[0])
    assert not held(first, share * (1 + 1e-3))


def _curve(samples: int, turns: bool) -> CarrierPath:
    """A curved path from rest to rest that also rises, and turns about a horizontal axis."""
    share = np.linspace(0, 1, samples)
    along = 10 * share**3 - 15 * share**4 + 6 * share**5
    place = np.column_stack([along, 0.2 * np.sin(2 * np.pi * along), 0.1 * along])
    angle = 0.1 * along
    turning = np.column_stack([np.cos(angle), np.sin(angle) * 0.6, 0 * angle, np.sin(angle) * 0.8])
    return path_from_poses(5 * share, place, turning if turns else None)


def _sample_of(path: CarrierPath, k: int) -> CarrierPath:
    rows = slice(k, k + 1)
    return CarrierPath(path.time[rows], path.rotation[rows], path.acceleration[rows],
                       path.angular_velocity[rows], path.angular_acceleration[rows],
                       path.about, False)  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("turns", [False, True])
def test_shared_proofs_give_the_limits_of_each_sample_by_itself(seed, turns):
    assembly = random_stack(seed)
    program = build_program(assembly, contacts(assembly))
    path = _curve(60, turns)
    found = find_path_limit(program, path, lambda stage: None)
    alone = [find_path_limit(program, _sample_of(path, k), lambda stage: None) for k in range(60)]
    if any(isinstance(limit, NoLimit) for limit in alone):
        assert isinstance(found, NoLimit)
        return
    least, slowest = min(a.factor for a in alone), max(a.slowest for a in alone)
    if slowest > least:
        assert isinstance(found, NoLimit)
        return
    assert found.factor == pytest.approx(least, rel=1e-6)
    assert found.lower <= least
    assert found.slowest == pytest.approx(slowest, abs=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("turns", [False, True])
def test_few_programs_confirm_a_thousand_samples(turns):
    assembly = stack_on_deck([[0.5, 0.4, 0.3], [0.4, 0.4, 0.3], [0.3, 0.3, 0.2]], 0.4)
    answer = kilter.transport(assembly, path=_curve(1000, turns)).speed
    assert answer.programs <= 80
    assert answer.lower >= answer.factor * (1 - 1e-6)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "is empty"),
        ("time,x,y\n0,0,0\n", "no column z"),
        ("tim,x,y,z\n0,0,0,0\n", "unknown column 'tim'"),
        ("time,x,y,z\n0,0,0,0\n1,0,0,a\n", "line 3 of the path is not a row of numbers"),
        ("time,x,y,z\n0,0,0,0\n0,0,0,0\n1,0,0,0\n", "increasing times"),
        ("time,x,y,z\n0,0,0,0\n1,0,0,0\n", "has no acceleration"),
        ("time,ax,ay,az,qw,qx,qy,qz\n0,0,0,0,2,0,0,0\n", "has the length 2"),
        ("time\n0\n", "neither x, y, z nor ax"),
    ],
)
def test_a_wrong_path_is_an_error_of_one_sentence(text, words, tmp_path):
    file = tmp_path / "path.csv"
    file.write_text(text)
    with pytest.raises(InputError, match=words):
        read_path(file)


def test_the_command_reads_a_path(tmp_path, capsys):
    kilter.dump(_flat(), tmp_path / "box.kilter.json")
    rows = [f"{k},{2.0 if k < 2 else -2.0},0,0" for k in range(4)]
    (tmp_path / "path.csv").write_text("\n".join(["time,ax,ay,az", *rows]))
    words = ["transport", str(tmp_path / "box.kilter.json"), "--path", str(tmp_path / "path.csv")]
    assert main(words) == 0
    assert "1.40071 times as fast" in capsys.readouterr().out


@pytest.mark.slow
def test_the_figure_shows_the_factor_over_time(tmp_path, capsys):
    pytest.importorskip("matplotlib")
    load, path, figure = (tmp_path / name for name in ("box.kilter.json", "p.csv", "k.svg"))
    kilter.dump(_flat(), load)
    path.write_text("time,ax,ay,az\n0,0,0,0\n1,2,0,0\n2,0,0,0\n")
    words = ["transport", str(load), "--path", str(path), "--figure", str(figure)]
    assert main(words) == 0
    assert "speed factor [-]" in figure.read_text()
    path.write_text("time,ax,ay,az\n0,0,0,0\n1,0,0,0\n2,0,0,0\n")
    capsys.readouterr()
    assert main(words) == 2
    assert "carried at every speed" in capsys.readouterr().err


G_ROWS, MU_ROWS = 9.81, 0.4
TIME_ROWS = np.linspace(0.0, 1.0, 5)


def _straight(length: float) -> np.ndarray:
    return np.column_stack([length * TIME_ROWS, 0 * TIME_ROWS, 0 * TIME_ROWS])


@pytest.mark.slow
def test_a_straight_path_bounds_its_acceleration_by_mu_g():
    """|u| <= mu g / length for a flat box, at every sample."""
    flat = stack_on_deck([[0.4, 0.4, 0.1]], MU_ROWS)
    answer = kilter.transport(flat, path=path_from_poses(TIME_ROWS, _straight(2.0)))
    limit = MU_ROWS * G_ROWS / 2.0
    for inner in (True, False):
        rows, bounds = answer.rows(inner=inner)
        assert rows.shape == (*bounds.shape, 2)
        for share, held in ((0.999, True), (1.001, False)):
            for sign in (-1.0, 1.0):
                inside = (rows @ [sign * share * limit, 3.0] <= bounds).all(axis=1)
                assert inside.tolist() == [held] * len(TIME_ROWS)


def _turning_path(seed: int) -> kilter.CarrierPath:
    """Random poses of a carrier that also turns."""
    rng = np.random.default_rng(seed)
    angle = rng.normal(size=3) * 0.3
    half = np.linalg.norm(angle) * TIME_ROWS / 2
    axis = angle / np.linalg.norm(angle)
    turning = np.column_stack([np.cos(half), np.sin(half)[:, None] * axis])
    return path_from_poses(TIME_ROWS, np.cumsum(rng.normal(size=(5, 3)) * 0.3, axis=0), turning)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(10))
def test_check_agrees_with_the_constraints_of_turning_paths(seed):
    """Check holds at (u, x) that obey the inner constraints, and not beyond the outer ones."""
    assembly = random_stack(seed)
    if kilter.check(assembly, require="equilibrium").level is None:
        return
    path = _turning_path(seed)
    answer = kilter.transport(assembly, path=path)
    if answer.speed is None:
        return
    inner, outer = answer.rows(), answer.rows(inner=False)
    rng = np.random.default_rng([seed, 1])
    counts = [0, 0]
    for u, x in np.column_stack([rng.normal(size=12), rng.uniform(0, 2, 12)]):
        sample = int(rng.integers(5))
        spin = path.angular_velocity[sample]
        motion = CarrierMotion(
            path.velocity[sample] * u + path.acceleration[sample] * x,
            spin * np.sqrt(x),
            spin * u + path.angular_acceleration[sample] * x,
            path.about,
        )
        turned = assembly.with_down(path.rotation[sample].T @ assembly.down)
        felt = carried_assembly(turned, motion)
        held = kilter.check(felt, require="equilibrium").level is not None
        suffices = (inner[0][sample] @ [u, x] <= inner[1][sample]).all()
        possible = (outer[0][sample] @ [u, x] <= outer[1][sample]).all()
        assert not (suffices and not held)
        assert not (held and not possible)
        counts[int(suffices)] += 1
    assert max(counts) > 0


def test_constraints_need_velocities(tmp_path):
    file = tmp_path / "path.csv"
    flat = stack_on_deck([[0.4, 0.4, 0.1]], MU_ROWS)
    rows = ["0,2,0,0,0,0,0", "1,2,0,0,2,0,0", "2,2,0,0,4,0,0"]
    file.write_text("\n".join(["time,ax,ay,az,vx,vy,vz", *rows]))
    rows_of_path, bounds = kilter.transport(flat, path=read_path(file)).rows()
    # at rest in time, u does not count; with x = 1, u v + a = 2 u + 2 at the second sample
    assert (rows_of_path[1] @ [0.9 * (MU_ROWS * G_ROWS - 2) / 2, 1.0] <= bounds[1]).all()
    assert not (rows_of_path[1] @ [1.1 * (MU_ROWS * G_ROWS - 2) / 2, 1.0] <= bounds[1]).all()
    file.write_text("\n".join(["time,ax,ay,az", "0,2,0,0", "1,2,0,0"]))
    with pytest.raises(InputError, match="no velocities"):
        kilter.transport(flat, path=read_path(file)).rows()
    file.write_text("\n".join(["time,x,y,z,vx,vy,vz", *rows]))
    with pytest.raises(InputError, match="come without ax"):
        read_path(file)


G_PATHS, MU_PATHS = 9.81, 0.4
BOX = '<collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision>'
TIME_PATHS = np.linspace(0.0, 2.0, 41)


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
def test_motions_agree_with_differences_of_the_poses(seed, tmp_path):
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
def test_the_zero_position_is_that_of_the_urdf_reader(seed, tmp_path):
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


def test_an_arm_that_turns_and_extends_at_the_same_time(tmp_path):
    """Polar coordinates: a_r = r'' - r o^2, a_t = r al + 2 r' o."""
    file = robot(
        tmp_path,
        joint("turn", "continuous", "base a"),
        joint("reach", "prismatic", "a b", axis="1 0 0",
              more='<limit lower="0" upper="9" effort="1" velocity="1"/>'),
    )  # fmt: skip
    chain = read_joint_chain(file, "b")
    path = path_from_joints(
        chain,
        TIME_PATHS,
        {"turn": 0.3 * TIME_PATHS**3, "reach": 0.5 + 0.2 * TIME_PATHS + 0.1 * TIME_PATHS**3},
    )
    reach, rate, second = (
        0.5 + 0.2 * TIME_PATHS + 0.1 * TIME_PATHS**3,
        0.2 + 0.3 * TIME_PATHS**2,
        0.6 * TIME_PATHS,
    )
    spin, turn = 0.9 * TIME_PATHS**2, 1.8 * TIME_PATHS
    expected = [second - reach * spin**2, reach * turn + 2 * rate * spin, 0 * TIME_PATHS]
    assert np.allclose(path.acceleration, np.column_stack(expected), atol=1e-9)
    assert np.allclose(
        path.velocity, np.column_stack([rate, reach * spin, 0 * TIME_PATHS]), atol=1e-9
    )
    assert np.allclose(path.angular_acceleration[:, 2], turn, atol=1e-9)


def test_a_flange_on_a_circle_carries_a_box_as_fast_as_the_closed_form(tmp_path, capsys):
    speed, radius = 1.2, 0.8
    file = robot(
        tmp_path,
        joint("turn", "continuous", "base a"),
        joint("arm", "fixed", "a b", xyz=f"{radius} 0 0.5"),
        joint("grip", "revolute", "b c", more='<limit lower="0" upper="1"/>'),
    )
    joints = table(
        tmp_path, {"time": TIME_PATHS, "turn": speed / radius * TIME_PATHS, "grip": 0 * TIME_PATHS}
    )
    load = tmp_path / "box.kilter.json"
    kilter.dump(stack_on_deck([[0.4, 0.4, 0.1]], MU_PATHS), load)
    path = read_robot_path(joints, file, "b")
    expected = np.sqrt(MU_PATHS * G_PATHS * radius) / speed
    assert kilter.transport(load, path=path).speed.factor == pytest.approx(expected, rel=1e-6)
    words = ["transport", str(load), "--path", str(joints), "--robot", str(file), "--flange", "b"]
    assert main(words) == 0
    assert "1.47648 times as fast" in capsys.readouterr().out


@pytest.mark.parametrize(("units", "per_metre"), [("m", 1.0), ("mm", 1000.0)])
def test_a_box_beside_the_flange_is_on_a_wider_circle(units, per_metre, tmp_path):
    """The flange is .8 m from the axis, the box .5 m farther out, in the unit of its file."""
    ends = joint("arm", "fixed", "a b", xyz="0.8 0 0.5")
    file = robot(tmp_path, joint("turn", "continuous", "base a"), ends)
    joints = table(tmp_path, {"time": TIME_PATHS, "turn": 1.5 * TIME_PATHS})
    size = np.array([0.4, 0.4, 0.1]) * per_metre
    deck = kilter.Part("deck", kilter.Box([2 * per_metre] * 3), [0, 0, -per_metre], grounded=True)
    box = kilter.Part("box", kilter.Box(size), [0.5 * per_metre, 0, 0.05 * per_metre])
    assembly = kilter.Assembly([deck, box], units=units, friction=MU_PATHS)
    speed = kilter.transport(assembly, path=read_robot_path(joints, file, "b")).to_dict()["speed"]
    assert speed["factor"] == pytest.approx(np.sqrt(MU_PATHS * G_PATHS / (1.5**2 * 1.3)), rel=1e-6)


def test_a_wrist_that_tilts_a_box_to_its_angle_of_friction(tmp_path):
    """At rest at 21 deg of tilt the box stays (tan 21 = .38); at 22.5 deg it slides (.414)."""
    file = robot(
        tmp_path,
        joint("wrist", "revolute", "base a", axis="0 1 0",
              more='<limit lower="-3" upper="3"/><mimic joint="motor" multiplier="0.5"/>'),
        joint("motor", "continuous", "base b"),
    )  # fmt: skip
    box = stack_on_deck([[0.4, 0.4, 0.1]], MU_PATHS)
    chain = read_joint_chain(file, "a")
    assert chain.drivers == ("motor",)
    for degrees, holds in ((21.0, True), (22.5, False)):
        tilt = 2 * np.radians(degrees) * (1 - np.cos(np.pi * TIME_PATHS / 2)) / 2
        answer = kilter.transport(
            box, path=path_from_joints(chain, 100 * TIME_PATHS, {"motor": tilt})
        )
        assert answer.carried == holds


@pytest.mark.parametrize(
    ("columns", "flange", "words"),
    [
        ({"time": TIME_PATHS, "turn": TIME_PATHS}, "z", "no link 'z'"),
        ({"time": TIME_PATHS, "trun": TIME_PATHS}, "a", "unknown column 'trun'; did you mean turn"),
        ({"time": TIME_PATHS, "lift": TIME_PATHS}, "a", "no column for the joint turn"),
        ({"time": TIME_PATHS, "turn": 90 * TIME_PATHS}, "a", "the joint turn is at 4.5 at 0.05 s"),
        ({"time": TIME_PATHS, "turn": TIME_PATHS}, "base", "no joint moves the flange"),
        ({"time": TIME_PATHS, "turn": TIME_PATHS}, "c", "the type 'floating'"),
        ({"time": -TIME_PATHS, "turn": TIME_PATHS}, "a", "increasing times"),
        ({"time": TIME_PATHS[:2], "turn": TIME_PATHS[:2]}, "a", "has no acceleration"),
    ],
)
def test_wrong_input_is_an_error_of_one_sentence(columns, flange, words, tmp_path):
    file = robot(
        tmp_path,
        joint("turn", "revolute", "base a", more='<limit lower="-3" upper="3"/>'),
        joint("lift", "prismatic", "a b", more='<limit lower="-9" upper="9"/>'),
        joint("free", "floating", "b c"),
    )
    with pytest.raises(InputError, match=words):
        read_robot_path(table(tmp_path, columns), file, flange)


def test_options_of_a_robot_belong_together(tmp_path, capsys):
    file = robot(tmp_path, joint("turn", "continuous", "base a"))
    load = tmp_path / "box.kilter.json"
    kilter.dump(stack_on_deck([[0.4, 0.4, 0.1]], MU_PATHS), load)
    assert main(["transport", str(load), "--robot", str(file)]) == 2
    assert "--flange is missing" in capsys.readouterr().err
    assert main(["transport", str(load), "--robot", str(file), "--flange", "a"]) == 2
    assert "--robot has no path" in capsys.readouterr().err
    joints = table(tmp_path, {"time": TIME_PATHS, "turn": TIME_PATHS})
    words = ["transport", str(load), "--path", str(joints), "--robot", str(load), "--flange", "a"]
    assert main(words) == 2
    assert "the XML is invalid" in capsys.readouterr().err
