"""Regions, orientations and margins with friction, of irregular assemblies, are one answer."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from random_turned import random_turned

import kilter
from kilter import Assembly, ContactSet
from kilter.analysis.decision.judge import judge
from kilter.analysis.margins.tilt import TiltMargin, find_tilt_margin
from kilter.analysis.regions.region import Region
from kilter.mechanics.program import Program, build_program
from sampled import sampled

CASES = sampled(4, [("arch", 1), ("pile", 4), ("wedge", 1), ("round", 5), ("arch", 3), ("arch", 5),
                    ("pile", 9), ("wedge", 4), ("round", 6), ("round", 11)])  # fmt: skip


@cache
def asked(family: str, seed: int) -> tuple[Assembly, ContactSet, Program, Region]:
    """An assembly with its contacts, its program and its region."""
    assembly = random_turned(family, seed)
    contacts = kilter.contacts(assembly)
    program = build_program(assembly, contacts)
    return assembly, contacts, program, kilter.region(assembly, contacts=contacts)


@pytest.mark.slow
@pytest.mark.parametrize(("family", "seed"), CASES)
def test_every_direction_is_judged_as_the_region_says(family: str, seed: int) -> None:
    assembly, _, program, found = asked(family, seed)
    assert found.proved
    assert (found.gap_deg or 0.0) <= 0.1
    random = np.random.default_rng(seed)
    directions = random.normal(size=(30, 3))
    points = np.array([p.vector for p in found.found[0].proofs if p.about == "ray"])
    if len(points):  # half of them near the boundary
        scatter = 0.05 * random.normal(size=(15, 3))
        directions[:15] = points[random.integers(0, len(points), size=15)] + scatter
    if assembly.planar:
        directions[:, 1] = 0.0
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    slack = found.found[0].slack + 1e-6
    for down in directions:
        if found.contains(down):
            assert judge(program.turned(down)).stable is not False
        elif not found.exact and (found.facets @ down).min(initial=1.0) < -np.sin(slack):
            assert judge(program.turned(down)).stable is not True


@pytest.mark.slow
@pytest.mark.parametrize(("family", "seed"), CASES)
def test_three_margins_are_one(family: str, seed: int) -> None:
    assembly, contacts, program, found = asked(family, seed)
    turned = kilter.orient(assembly, contacts=contacts)
    gap = (found.gap_deg or 0.0) + 1e-6
    assert (turned.verdict == "found") == (found.kind != "none")
    if found.dimension == 3 and found.half_angle_deg < 90:
        assert turned.tilt_margin_deg == pytest.approx(found.half_angle_deg, abs=gap)
    tilt = find_tilt_margin(program)
    if isinstance(tilt, TiltMargin) and tilt.limit.motion is not None:
        inner = np.degrees(found.cone.depth(program.down))
        outer = np.degrees(np.arcsin(np.clip((found.facets @ program.down).min(), -1, 1)))
        assert inner - 1e-7 <= np.degrees(tilt.angle) <= outer + 1e-6
        assert outer - inner <= 2 * gap
        for step, held in ((-1e-6, True), (1e-6, False)):
            aside = tilt.down - (tilt.down @ program.down) * program.down
            aside /= np.linalg.norm(aside)
            angle = tilt.angle + step
            there = np.cos(angle) * program.down + np.sin(angle) * aside
            assert judge(program.turned(there)).stable is not (not held)
