"""Near a limit, forces and a motion never both pass, however they are forged."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import pytest
from forged_evidence import forged_forces, forged_motions
from limit_cases import LimitCase, limit_case

import kilter
from kilter.mechanics.certificate import check_forces, check_motion
from kilter.mechanics.program import build_program

BLOCK = 10
"""Cases of one test."""


@dataclass(frozen=True, slots=True, eq=False)
class Passed:
    """Whether any forces, and any motion, pass as a proof of a case."""

    case: LimitCase
    forces: bool
    motion: bool


def tried(case: LimitCase, seed: int) -> Passed:
    """Try kilter's own proof, and every forged one, of both kinds."""
    rng = np.random.default_rng(seed)
    touching = kilter.contacts(case.assembly)
    inner = build_program(case.assembly, touching)
    outer = build_program(case.assembly, touching, possible=True)
    verdict = kilter.check(case.assembly, contacts=touching, require="equilibrium").verdict
    forces = [check_forces(inner, *given).holds for given in forged_forces(inner, rng)]
    motions = [check_motion(outer, given).holds for given in forged_motions(outer, rng)]
    return Passed(
        case,
        any(forces) or verdict not in ("unstable", "undecided"),
        any(motions) or verdict == "unstable",
    )


def require_one(seeds: Iterable[int], *, exact: bool) -> None:
    """Require that at most one kind passes; print the band in which neither does."""
    band = []
    for seed in seeds:
        case = limit_case(seed, exact=exact)
        passed = tried(case, seed)
        assert not (passed.forces and passed.motion), (seed, case)
        if case.certain:
            wrong = passed.motion if case.stays else passed.forces
            assert not wrong, (seed, case)
        if not (passed.forces or passed.motion):
            band.append(case)
    width = max((abs(case.beyond) for case in band), default=0.0)
    words = f"{len(band)} cases, up to {width:.1e} of the weight from the limit: {band}"
    sys.stdout.write(f"neither kind passes: {words}\n")


@pytest.mark.slow
@pytest.mark.parametrize("first", range(0, 300, BLOCK))
def test_forces_and_a_motion_never_both_pass(first: int) -> None:
    require_one(range(first, first + BLOCK), exact=True)


@pytest.mark.slow
@pytest.mark.parametrize("first", range(0, 160, BLOCK))
def test_forces_and_a_motion_never_both_pass_for_coarse_data(first: int) -> None:
    require_one(range(first, first + BLOCK), exact=False)


def test_the_least_case_of_each_family() -> None:
    require_one([4, 6], exact=True)
