"""Masses and centres within limits: closed forms, and check at random masses and centres."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import shapely
from planks import bridge, overhang

import kilter
from kilter import Assembly, Places
from kilter.analysis.placing.place import box_to_place, place
from kilter.analysis.placing.uncertain_part import part_cases
from kilter.cli import main
from kilter.errors import InputError

LENGTH, WEIGHT, BEYOND = 1.0, 2.0, 0.3
PLANK = overhang(LENGTH, WEIGHT, BEYOND)


@pytest.mark.quick(1)
@pytest.mark.parametrize(("mass", "share"), [((2, 5), 0.0), ((4, 4), 0.1), ((2, 5), 0.1)])
def test_the_worst_mass_and_centre_limit_a_load_on_a_plank(
    mass: tuple[float, float], share: float
) -> None:
    """The heaviest load with its centre farthest out: x + share size = W (L/2 - e) / w."""
    size = 0.2
    limit = WEIGHT * (LENGTH / 2 - BEYOND) / max(mass) - share * size
    part = box_to_place([size, size, 0.1], 1.0)
    places = place(PLANK, part, mass=mass, center_within=share, accuracy=1e-3)
    level = places.levels[-1]
    assert level.stands.bounds[2] == pytest.approx(limit, abs=1e-9)
    # falls: with some mass and centre within the limits
    assert level.falls.covers(shapely.Point(limit + 1e-3, 0))
    for side in (-1e-6, 1e-6):
        at = place(
            PLANK,
            part,
            at=[limit + side, 0],
            mass=mass,
            center_within=share,
        ).at
        assert at is not None
        assert (at.verdict == "unstable") == (side > 0)
        assert at.level == (None if side > 0 else "proved")


def test_the_heaviest_mass_has_every_centre() -> None:
    """With the centre up to .02 beyond x = .1, the heaviest load is W (L/2 - e) / .12."""
    at = place(
        PLANK,
        box_to_place([0.2, 0.2, 0.1], 1.0),
        at=[0.1, 0],
        center_within=0.1,
    ).at
    assert at is not None
    assert at.heaviest == pytest.approx(0.4 / 0.12, rel=1e-6)


def test_shifts_follow_the_axes_of_a_turned_box() -> None:
    part = box_to_place([4, 2, 1], 5.0, turn=90)
    shifts = [Assembly([case]).geometry.center[0] for case in part_cases(part, (5, 5), 0.1)]
    assert np.ptp(shifts, axis=0) == pytest.approx([0.4, 0.8, 0], abs=1e-12)


def test_with_friction_corners_prove_equilibrium_alone() -> None:
    part = box_to_place([0.2, 0.2, 0.1], 1.0)
    answer = place(
        PLANK.with_friction(0.5),
        part,
        at=[-0.2, 0],
        mass=(1, 2),
        require="equilibrium",
    )
    assert answer.stands
    assert answer.level == "equilibrium"


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
def test_check_agrees_at_masses_and_centres_inside_the_limits(seed: int) -> None:
    rng = np.random.default_rng(seed)
    stack, part, mass, share = bridge(), LOAD, (2.0, 3.5), 0.04
    places = mapped(mass, share)
    [level] = [
        level
        for level in places.levels
        if level.stands.area > 0 and level.height > places.prism.below
    ]
    low, high = np.array(level.stands.bounds).reshape(2, 2)
    points = rng.uniform(low, high, (2000, 2))
    inside = points[shapely.contains_xy(level.stands, points)][:8]
    assert len(inside) == 8
    for point in inside:
        shift = rng.uniform(-share, share, 2) * [0.7, 0.5]
        case = replace(part, given_mass=float(rng.uniform(*mass)), center_of_mass=[*shift, 0.0])
        at = place(stack, case, at=point + shift, require="equilibrium").at
        assert at is not None
        assert at.verdict != "unstable"


LOAD = box_to_place([0.7, 0.5, 0.2], 3.0, name="load")


@cache
def mapped(mass: tuple[float, float], share: float) -> Places:
    return place(bridge(), LOAD, mass=mass, center_within=share, accuracy=0.08)


@pytest.mark.parametrize("mass", [0, -1, (5, 2), (0, 1), (1, 2, 3), "heavy", (1, np.inf)])
def test_a_wrong_mass_is_refused(mass: object) -> None:
    with pytest.raises(InputError, match="mass"):
        place(PLANK, box_to_place([0.1, 0.1, 0.1], 1), mass=mass)  # type: ignore[arg-type]


@pytest.mark.parametrize("share", [-0.1, 0.5, np.nan])
def test_a_wrong_share_is_refused(share: float) -> None:
    with pytest.raises(InputError, match="cent"):
        place(PLANK, box_to_place([0.1, 0.1, 0.1], 1), center_within=share)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--mass", "8..5"], "--mass is '8..5'"),
        (["--mass", "5..6..7"], "--mass is '5..6..7'"),
        (["--mass", "5", "--centre-within", "60%"], "--centre-within is '60%'"),
        (["--mass", "5", "--centre-within", "some"], "--centre-within is 'some'"),
    ],
)
def test_wrong_limits_are_refused(
    words: list[str], said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "plank.kilter.json"
    kilter.dump(PLANK, file)
    assert main(["place", str(file), "--box", "1x1x1", *words]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert error.count("\n") == 1


def test_the_answer_names_its_limits(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "plank.kilter.json"
    kilter.dump(PLANK, file)
    box = ["--box", "0.2x0.2x0.1", "--mass", "5..8", "--centre-within", "10%"]
    assert main(["place", str(file), *box, "--at", "-0.3", "0"]) == 0
    said = capsys.readouterr().out
    assert "every mass of 5 to 8 kg and every centre within 10 % of the middle" in said
