"""Collapse multipliers, participating masses and spectral accelerations, against closed forms."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from boxes_on_deck import stack_on_deck

import kilter
from kilter.analysis.transport.carrier import CarrierMotion, carried_assembly
from kilter.cli import main
from kilter.scenes.arches import arch, oppenheim_arch
from kilter.scenes.pieces import block

G = 9.81
CUBES = stack_on_deck([[1, 1, 1]] * 3, 0.9)


def portal_of_equal_masses() -> kilter.Assembly:
    """Two posts .038 x .103 and a lintel of the same mass."""
    wide, high = 0.038, 0.103
    return kilter.Assembly(
        [
            block("deck", [-1, -1, -1], [2, 1, 0], grounded=True),
            block("left", [0, 0, 0], [wide, wide, high], mass=1.0),
            block("right", [0.2, 0, 0], [0.2 + wide, wide, high], mass=1.0),
            block("lintel", [0, 0, high], [0.2 + wide, wide, high + wide], mass=1.0),
        ],
        friction=0.9,
    )


def brick_wall(friction: float) -> kilter.Assembly:
    """Three courses of three bricks in running bond."""
    long, wide, high = 0.25, 0.12, 0.065
    parts = [block("deck", [-2, -2, -1], [2, 2, 0], grounded=True)]
    for course in range(3):
        for k in range(3):
            low = np.array([(k + 0.5 * (course % 2)) * long, 0, course * high])
            parts.append(block(f"brick-{course}-{k}", low, low + np.array([long, wide, high])))
    return kilter.Assembly(parts, friction=friction)


def entry_of(assembly: kilter.Assembly, name: str) -> dict[str, object]:
    answer = kilter.transport(assembly, polar=False, collapse=True)
    return next(dict(entry) for entry in answer.to_dict()["alpha"] if entry["name"] == name)


@pytest.mark.parametrize(
    ("assembly", "name", "alpha0", "e", "a0"),
    [
        (stack_on_deck([[0.2, 1, 1]], 0.9), "+x", 0.2, 1.0, 1.453333),
        (portal_of_equal_masses(), "+x", 0.368932, 8 / 9, 3.016019),
        (CUBES, "+x", 1 / 3, 27 / 35, 3.139918),
        (brick_wall(0.7), "+y", 0.615385, 27 / 35, 5.796771),
        (arch(20), "+x", 0.149350, 0.660600, 1.642867),
        (oppenheim_arch(), "+x", 0.373612, 0.771787, 3.517697),
    ],
    ids=["block", "portal", "3 cubes", "wall", "arch", "Oppenheim"],
)
@pytest.mark.slow
def test_known_mechanisms(
    assembly: kilter.Assembly, name: str, alpha0: float, e: float, a0: float
) -> None:
    entry = entry_of(assembly, name)
    assert [entry[key] for key in ("alpha0", "e", "a0")] == pytest.approx([alpha0, e, a0], abs=2e-6)
    assert entry["unique"]
    mass = float(assembly.geometry.mass[~assembly.geometry.grounded].sum())
    assert entry["participating_mass"] == pytest.approx(e * mass, rel=2e-6)
    ground = -G * alpha0 * np.array(entry["direction"])
    for share, held in ((0.999, True), (1.001, False)):
        felt = carried_assembly(assembly, CarrierMotion(share * ground))
        assert (kilter.check(felt, require="equilibrium").level is not None) == held


def test_a_stack_of_three_cubes() -> None:
    entry = entry_of(CUBES, "least")
    assert entry["alpha0"] == pytest.approx(1 / 3, abs=1e-6)
    assert entry["e"] == entry["e_moving"] == pytest.approx(27 / 35, abs=1e-6)
    assert entry["alpha0"] <= entry["upper"] <= entry["alpha0"] + 1e-5  # type: ignore[operator]


def test_parts_that_stand_still_raise_the_first_spectral_acceleration_only() -> None:
    """A wide plinth under a narrow block does not move."""
    plinth = stack_on_deck([[4, 4, 1], [0.2, 1, 1]], 0.9)
    entry = entry_of(plinth, "+x")
    assert entry["moves"] == ["box-1"]
    assert entry["e_moving"] == pytest.approx(1.0, abs=1e-6)
    assert entry["a0_moving"] == pytest.approx(0.2 * G / 1.35, abs=1e-5)
    assert entry["e"] == pytest.approx(0.2 / 16.2, rel=1e-5)


@pytest.mark.slow
def test_the_largest_mass_of_several_mechanisms() -> None:
    """A wall that slides course by course at mu: all of it moves in the chosen mechanism."""
    entry = entry_of(brick_wall(0.5), "+y")
    assert entry["unique"] is False
    assert entry["e"] == pytest.approx(1.0, abs=1e-5)


@pytest.mark.quick(1)
def test_the_confidence_factor_divides_the_spectral_acceleration(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "block.kilter.json"
    kilter.dump(stack_on_deck([[0.2, 1, 1]], 0.9), file)
    assert main(["transport", str(file), "--collapse", "--fc", "1"]) == 0
    assert "a0* 1.962 m/s^2 at FC 1" in capsys.readouterr().out
    assert main(["transport", str(file), "--collapse", "--fc", "0.9"]) == 2
    assert "at least 1" in capsys.readouterr().err
    assert main(["transport", str(file), "--collapse", "--code", "gdv"]) == 2
    assert "without another question" in capsys.readouterr().err
