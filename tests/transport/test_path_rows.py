"""Constraints on the speed along a path: closed forms, both sides by check, and planners."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from boxes_on_deck import random_stack, stack_on_deck

import kilter
from kilter.analysis.transport.carrier import CarrierMotion, carried_assembly
from kilter.analysis.transport.carrier_path import path_from_poses, read_path
from kilter.errors import InputError

G, MU = 9.81, 0.4
ROOT = Path(__file__).parents[2]
TIME = np.linspace(0.0, 1.0, 5)


def _straight(length: float) -> np.ndarray:
    return np.column_stack([length * TIME, 0 * TIME, 0 * TIME])


def test_a_straight_path_bounds_its_acceleration_by_mu_g() -> None:
    """|u| <= mu g / length for a flat box, at every sample."""
    flat = stack_on_deck([[0.4, 0.4, 0.1]], MU)
    answer = kilter.transport(flat, path=path_from_poses(TIME, _straight(2.0)))
    limit = MU * G / 2.0
    for inner in (True, False):
        rows, bounds = answer.rows(inner=inner)
        assert rows.shape == (*bounds.shape, 2)
        for share, held in ((0.999, True), (1.001, False)):
            for sign in (-1.0, 1.0):
                inside = (rows @ [sign * share * limit, 3.0] <= bounds).all(axis=1)
                assert inside.tolist() == [held] * len(TIME)


def _turning_path(seed: int) -> kilter.CarrierPath:
    """Random poses of a carrier that also turns."""
    rng = np.random.default_rng(seed)
    angle = rng.normal(size=3) * 0.3
    half = np.linalg.norm(angle) * TIME / 2
    axis = angle / np.linalg.norm(angle)
    turning = np.column_stack([np.cos(half), np.sin(half)[:, None] * axis])
    return path_from_poses(TIME, np.cumsum(rng.normal(size=(5, 3)) * 0.3, axis=0), turning)


@pytest.mark.quick(1)
@pytest.mark.parametrize("seed", range(10))
def test_check_agrees_with_the_constraints_of_turning_paths(seed: int) -> None:
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


def test_constraints_need_velocities(tmp_path: Path) -> None:
    file = tmp_path / "path.csv"
    flat = stack_on_deck([[0.4, 0.4, 0.1]], MU)
    rows = ["0,2,0,0,0,0,0", "1,2,0,0,2,0,0", "2,2,0,0,4,0,0"]
    file.write_text("\n".join(["time,ax,ay,az,vx,vy,vz", *rows]))
    rows_of_path, bounds = kilter.transport(flat, path=read_path(file)).rows()
    # at rest in time, u does not count; with x = 1, u v + a = 2 u + 2 at the second sample
    assert (rows_of_path[1] @ [0.9 * (MU * G - 2) / 2, 1.0] <= bounds[1]).all()
    assert not (rows_of_path[1] @ [1.1 * (MU * G - 2) / 2, 1.0] <= bounds[1]).all()
    file.write_text("\n".join(["time,ax,ay,az", "0,2,0,0", "1,2,0,0"]))
    with pytest.raises(InputError, match="no velocities"):
        kilter.transport(flat, path=read_path(file)).rows()
    file.write_text("\n".join(["time,x,y,z,vx,vy,vz", *rows]))
    with pytest.raises(InputError, match="come without ax"):
        read_path(file)


@pytest.mark.slow
def test_the_example_runs_with_the_planners_that_are_installed() -> None:
    pytest.importorskip("toppra")
    done = subprocess.run(
        [sys.executable, ROOT / "examples" / "fastest_carrying.py"],
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    seconds = [float(line.split()[1]) for line in done.stdout.splitlines() if line[:6] == "toppra"]
    inner, outer = seconds
    assert outer <= inner <= 1.01 * outer
