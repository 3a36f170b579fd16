"""False proofs of every kind, made from a seed: `verify` refuses them all."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import pytest
from forged_statements import KINDS, Forgery, forgeries

import kilter

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
def test_no_forgery_is_accepted(kind: str, first: int) -> None:
    last = min(first + BLOCKS.get(kind, 6), SEEDS[kind])
    tally = tried(kind, range(first, last))
    assert tally.attempts
    assert not tally.accepted


def test_each_kind_has_a_forger() -> None:
    assert set(SEEDS) == set(KINDS)


@pytest.mark.parametrize("kind", ["motion", "plan", "no plan"])
def test_a_few_forgeries_are_refused(kind: str) -> None:
    assert not tried(kind, [100]).accepted
