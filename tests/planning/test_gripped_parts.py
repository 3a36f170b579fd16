"""Grips that hold a large assembly, from least wrenches: each is needed, and fewer are proved."""

from __future__ import annotations

import pytest
from staggered_dome import staggered_dome

import kilter
from kilter.analysis.planning.hold import least_supports
from kilter.analysis.planning.hold.gripped_parts import grips_that_hold
from kilter.analysis.planning.hold.support_candidates import candidates_of
from kilter.analysis.planning.hold.supported import Supported
from kilter.contact import contacts
from kilter.scenes.arches import arch
from kilter.work import Work


@pytest.mark.slow
def test_the_fewest_grips_of_an_arch_are_the_same_with_known_grips(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    half = arch(9, ratio=0.3, friction=0.6).without("voussoir-4")
    usual = kilter.hold(half)
    monkeypatch.setattr(least_supports, "LARGE", 0)
    large = kilter.hold(half)
    assert usual.fewest
    assert large.fewest
    assert len(large.supports) == len(usual.supports) == 2
    assert (large.level, large.least) == (usual.level, usual.least)


def test_no_known_grip_can_be_left_out_and_open_pairs_do_not_hide_them() -> None:
    dome = staggered_dome(2, rings=3, per_ring=8)
    touching = contacts(dome)
    given = Supported(dome, touching, candidates_of(dome, touching, ["grips"]))
    assert given.judge((), Work()).stable is None
    grips = grips_that_hold(given, Work(), 0.0)
    assert grips
    assert given.judge(grips, Work()).stable
    for grip in grips:
        assert given.judge(grips - {grip}, Work()).stable is not True


def test_without_work_the_grips_still_hold() -> None:
    dome = staggered_dome(2, rings=3, per_ring=8)
    touching = contacts(dome)
    given = Supported(dome, touching, candidates_of(dome, touching, ["grips"]))
    few, many = grips_that_hold(given, Work(), 0.0), grips_that_hold(given, Work(0.0), 0.0)
    assert few
    assert many
    assert few <= many
    assert given.judge(many, Work()).stable


def test_without_grips_among_the_candidates_none_are_known() -> None:
    half = arch(9, ratio=0.3, friction=0.6).without("voussoir-4")
    touching = contacts(half)
    given = Supported(half, touching, candidates_of(half, touching, ["props"]))
    assert grips_that_hold(given, Work(), 0.0) is None


@pytest.mark.slow
def test_hold_of_a_dome_of_open_pairs_answers_with_grips() -> None:
    fixture = kilter.hold(staggered_dome(1, rings=6, per_ring=14))
    assert fixture.supports
    held = staggered_dome(1, rings=6, per_ring=14).with_grips([s.part for s in fixture.supports])
    assert kilter.check(held, require="equilibrium").stable
