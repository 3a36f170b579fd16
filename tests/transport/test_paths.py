"""Speed factors of paths: closed forms, and files that are wrong."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from boxes_on_deck import random_stack, stack_on_deck

import kilter
from kilter.analysis.load_limit import NoLimit
from kilter.analysis.transport.carrier import CarrierMotion, carried_assembly
from kilter.analysis.transport.carrier_path import CarrierPath, path_from_poses, read_path
from kilter.analysis.transport.path import find_path_limit
from kilter.cli import main
from kilter.contact import contacts
from kilter.errors import InputError
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


def test_trapezoid() -> None:
    along = np.where(TIME < 1, 2.0, np.where(TIME < 2, 0.0, -2.0))
    path = _level(np.column_stack([along, 0 * along, 0 * along]))
    assert _factor(path) == pytest.approx(np.sqrt(MU * G / 2), rel=1e-6)


def test_circle_at_fixed_heading_and_along_it() -> None:
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
def test_slopes(degrees: float) -> None:
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
def test_check_agrees_on_both_sides_at_random_samples(seed: int) -> None:
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


@pytest.mark.quick(1)
@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("turns", [False, True])
def test_shared_proofs_give_the_limits_of_each_sample_by_itself(seed: int, turns: bool) -> None:
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


@pytest.mark.quick(1)
@pytest.mark.parametrize("turns", [False, True])
def test_few_programs_confirm_a_thousand_samples(turns: bool) -> None:
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
def test_a_wrong_path_is_an_error_of_one_sentence(text: str, words: str, tmp_path: Path) -> None:
    file = tmp_path / "path.csv"
    file.write_text(text)
    with pytest.raises(InputError, match=words):
        read_path(file)


def test_the_command_reads_a_path(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    kilter.dump(_flat(), tmp_path / "box.kilter.json")
    rows = [f"{k},{2.0 if k < 2 else -2.0},0,0" for k in range(4)]
    (tmp_path / "path.csv").write_text("\n".join(["time,ax,ay,az", *rows]))
    words = ["transport", str(tmp_path / "box.kilter.json"), "--path", str(tmp_path / "path.csv")]
    assert main(words) == 0
    assert "1.40071 times as fast" in capsys.readouterr().out


@pytest.mark.quick(1)
def test_the_figure_shows_the_factor_over_time(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
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
