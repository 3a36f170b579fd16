"""More than 150 contact points: only candidates near the law are made exact; levels stay valid."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

import kilter
from kilter import Assembly, Pose
from kilter.friction.motion_search import MOST_POINTS
from kilter.mechanics.law_check import check_law
from kilter.scenes import friction

COPIES = 24
SLIPS_AT = float(np.degrees(np.arctan(0.84 / np.cos(np.radians(30.0)))))
"""Tilt of a trough of 30 deg at which its prism slips [deg]; equilibrium forces exist to 46.6."""


def troughs(tilts: list[float]) -> Assembly:
    """Separate troughs side by side; gravity leans as for the first, the others are turned."""
    parts = []
    for k, tilt in enumerate(tilts):
        half = np.radians(tilts[0] - tilt) / 2
        turn = [np.cos(half), np.sin(half), 0.0, 0.0]
        pose = Pose([5.0 * k, 0.0, 0.0], turn)
        for part in friction.trough(30.0).parts:
            placed = pose @ part.pose
            parts.append(dataclasses.replace(part, name=f"{part.name}-{k}", pose=placed))
    angle = np.radians(tilts[0])
    gravity = [0.0, 9.81 * np.sin(angle), -9.81 * np.cos(angle)]
    return Assembly(parts, gravity=gravity, friction=0.84)


@pytest.mark.quick(1)
@pytest.mark.parametrize(("which", "over"), [(0, 0.05), (13, 0.05), (5, 1.0)])
def test_one_prism_that_slips_among_many_limits_the_level(which: int, over: float) -> None:
    """Whether its motion is found or not, the verdict must not exclude it."""
    tilts = [SLIPS_AT - 2.0] * COPIES
    tilts[which] = SLIPS_AT + over
    verdict = kilter.check(troughs(tilts))
    assert len(verdict.program.part_a) > MOST_POINTS
    assert (verdict.verdict, verdict.level) == ("potentially-stable", "equilibrium")
    witness = verdict.friction.witness
    if witness is not None:
        assert check_law(verdict.program, witness.acceleration, witness.forces).holds


@pytest.mark.slow
def test_many_prisms_that_cannot_slip_are_not_refuted() -> None:
    verdict = kilter.check(troughs([SLIPS_AT - 0.05] * COPIES))
    assert len(verdict.program.part_a) > MOST_POINTS
    assert verdict.guarantee != "refuted"
    assert verdict.level in ("settles", "proved", "strict")
