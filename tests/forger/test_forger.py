"""False proofs from a seed are refused, and never both sides of a limit pass."""

import sys
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import pytest
from forged_evidence import forged_forces, forged_motions
from forged_statements import KINDS, Forgery, forgeries
from limit_cases import LimitCase, limit_case

import kilter
from kilter.mechanics.certificate import check_forces, check_motion
from kilter.mechanics.program import build_program

SEEDS: dict[str, int] = {
    "force": 20,
    "motion": 24,
    "settles": 12,
    "exclusion": 12,
    "second order": 14,
    "rest": 20,
    "region": 12,
    "margin": 8,
    "transport": 8,
    "plan": 12,
    "no plan": 12,
    "held plan": 12,
    "hold": 12,
    "lashing": 12,
    "lashing of a code": 8,
    "place": 12,
}
"""Number of seeds of each kind; together they make about 2,500 attempts."""
BLOCKS = {"settles": 1, "exclusion": 2, "second order": 2, "force": 5, "margin": 2, "transport": 1}
"""Seeds of one test; by default 6."""


@dataclass(frozen=True, slots=True, eq=False)
class Tally:
    """Number of attempts, and the accepted ones."""

    attempts: int
    accepted: list[Forgery]


def tried(kind: str, seeds: Iterable[int]) -> Tally:
    """Verify the forgeries of a kind; the file without the form of a proof counts as refused."""
    attempts, accepted = 0, []
    for seed in seeds:
        for forgery in forgeries(kind, seed):
            attempts += 1
            try:
                result = kilter.verify(forgery.assembly, forgery.proof, require=forgery.require)
            except kilter.InputError:
                continue
            if result.holds:
                accepted.append(forgery)
    return Tally(attempts, accepted)


CASES = [
    (kind, first) for kind, count in SEEDS.items() for first in range(0, count, BLOCKS.get(kind, 6))
]
"""Kind and first seed of each slow test."""


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "first"), CASES)
def test_no_forgery_is_accepted(kind, first):
    last = min(first + BLOCKS.get(kind, 6), SEEDS[kind])
    tally = tried(kind, range(first, last))
    assert tally.attempts
    assert not tally.accepted


def test_each_kind_has_a_forger():
    assert set(SEEDS) == set(KINDS)


@pytest.mark.parametrize("kind", ["motion", "plan", "no plan"])
def test_a_few_forgeries_are_refused(kind):
    assert not tried(kind, [100]).accepted


BLOCK = 10
"""Cases of one test."""


@dataclass(frozen=True, slots=True, eq=False)
class Passed:
    """Whether any forces, and any motion, pass as a proof of a case."""

    case: LimitCase
    forces: bool
    motion: bool


def both_tried(case: LimitCase, seed: int) -> Passed:
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
        passed = both_tried(case, seed)
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
def test_forces_and_a_motion_never_both_pass(first):
    require_one(range(first, first + BLOCK), exact=True)


@pytest.mark.slow
@pytest.mark.parametrize("first", range(0, 160, BLOCK))
def test_forces_and_a_motion_never_both_pass_for_coarse_data(first):
    require_one(range(first, first + BLOCK), exact=False)


def test_the_least_case_of_each_family():
    require_one([4, 6], exact=True)
