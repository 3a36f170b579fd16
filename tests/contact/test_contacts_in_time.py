"""Contact search under a time limit: batches change nothing, and unexamined pairs are open."""

from __future__ import annotations

from collections.abc import Callable
from itertools import count
from operator import attrgetter

import numpy as np
import pytest

import kilter
from kilter import work
from kilter.assembly import Assembly
from kilter.contact import ContactSet, contacts, pair_findings
from kilter.errors import TimeLimitReached
from kilter.scenes import scene, stacks
from kilter.tell.record import json_value
from kilter.tell.text import text_of
from kilter.work import stop_after
from published import validator

ARRAYS = ("patch_parts", "patch_area", "patch_start", "points", "normals", "gap_counts")
RECORDS = ("rejected", "overlaps", "unsupported", "open_pairs", "fits", "warnings")


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Callable[[int], None]:
    """Function that sets the clock of time limits: the n-th batch of pairs ends late."""
    now = [0.0]
    examine = pair_findings.examine
    monkeypatch.setattr(work, "perf_counter", lambda: now[0])
    monkeypatch.setattr(pair_findings, "FIRST_BATCH", 2)
    monkeypatch.setattr(pair_findings, "GROWTH", 1.0)

    def late_from(batch: int) -> None:
        numbers = count(1)

        def timed(*arguments: object) -> object:
            findings = examine(*arguments)
            if next(numbers) == batch:
                now[0] += 100.0
            return findings

        monkeypatch.setattr(pair_findings, "examine", timed)

    return late_from


@pytest.mark.parametrize("name", ["arch", "paper-figure-3-vertices", "three-cylinders", "box-pile"])
def test_batches_change_no_contact(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    assembly = scene(name)
    whole = contacts(assembly)
    monkeypatch.setattr(pair_findings, "FIRST_BATCH", 1)
    monkeypatch.setattr(pair_findings, "GROWTH", 1.0)
    batches = contacts(assembly, time_limit=1000.0)
    for key in ARRAYS:
        assert np.array_equal(getattr(batches, key), getattr(whole, key))
    for key in RECORDS:
        assert json_value(getattr(batches, key)) == json_value(getattr(whole, key))
    for key in ("part_a", "points", "normals", "degenerate"):
        assert np.allclose(getattr(batches.possible, key), getattr(whole.possible, key))
    assert np.array_equal(batches.degenerate.normals, whole.degenerate.normals)


def cut_tower(late_from: Callable[[int], None]) -> tuple[Assembly, ContactSet]:
    """A tower of 5 cubes whose search ends after 2 of its 5 pairs."""
    tower = scene("tower")
    late_from(1)
    return tower, contacts(tower, time_limit=1.0)


def test_pairs_after_the_limit_are_open(clock: Callable[[int], None]) -> None:
    _, cut = cut_tower(clock)
    assert (cut.pairs, cut.unexamined) == (2, 3)
    assert {pair.kind for pair in cut.open_pairs} == {"unexamined"}
    assert not len(cut.alone)
    assert "the time limit was reached: the contacts of 3 pairs of parts were not examined" in (
        cut.warnings
    )
    validator("contacts")(cut.to_dict())
    assert "a longer --time-limit" in text_of(cut.to_dict())


def test_a_verdict_on_unexamined_pairs_is_undecided(clock: Callable[[int], None]) -> None:
    tower, cut = cut_tower(clock)
    verdict = kilter.check(tower, contacts=cut)
    assert verdict.sentence == (
        "Undecided: the time limit was reached; known so far: 2 pairs of parts touch, the "
        "contacts of 3 pairs of parts were not examined, 3 pairs are open, no forces of the "
        "certain contacts hold it."
    )
    validator("check")(verdict.to_dict())


def test_the_first_batch_may_be_cut(monkeypatch: pytest.MonkeyPatch) -> None:
    def late(*arguments: object) -> object:
        if len(arguments[1].pairs):  # type: ignore[attr-defined]
            raise TimeLimitReached
        return examine(*arguments)  # type: ignore[arg-type]

    examine = pair_findings.examine
    monkeypatch.setattr(pair_findings, "examine", late)
    cut = contacts(scene("tower"), time_limit=1.0)
    assert (cut.pairs, cut.unexamined) == (0, 5)


def test_a_search_inside_a_limit_of_another_computation_raises() -> None:
    # incomplete contacts that nobody requested would be taken for complete ones
    with stop_after(0.0), pytest.raises(TimeLimitReached):
        contacts(stacks.tower())


@pytest.mark.parametrize(
    ("analysis", "contacts_of"),
    [
        (kilter.check, "contact_set"),
        (kilter.states, "contacts"),
        (kilter.margin, "contacts"),
        (kilter.hold, "contacts"),
        (kilter.plan, "states.contacts"),
        (kilter.region, "contacts"),
        (kilter.orient, "region.contacts"),
    ],
)
def test_every_analysis_passes_its_limit_to_the_search(
    analysis: Callable[..., object], contacts_of: str, clock: Callable[[int], None]
) -> None:
    clock(1)
    found = attrgetter(contacts_of)(analysis(scene("tower"), time_limit=1.0))
    one = found[0] if isinstance(found, tuple) else found
    assert one.unexamined == 3
