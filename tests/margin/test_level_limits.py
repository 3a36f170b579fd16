"""Limits at a level above equilibrium: bisection, bounded work, and the words of each limit."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import kilter
from kilter import Assembly
from kilter.analysis.decision.cascade import decide
from kilter.analysis.margins.level_limits import SHARE
from kilter.analysis.margins.limit_level import (
    DECISION,
    NEAR,
    LevelDecisions,
    find_level_end,
)
from kilter.cli import main
from kilter.contact import contacts
from kilter.scenes import friction, scene, stacks
from kilter.tell.levels import holds
from kilter.tell.numbers import number
from kilter.tell.text import text_of
from kilter.work import Work, units_of


def decisions(allowed: float = np.inf) -> LevelDecisions:
    return LevelDecisions("settles", 0.0, Work(allowed))


@pytest.mark.parametrize("limit", [1e-3, 0.2, 0.7, 0.9995])
def test_bisection_encloses_the_value_at_which_the_level_ends(limit: float) -> None:
    level_limit = find_level_end(decisions(), lambda value: value <= limit, 1.0)
    assert level_limit.inside <= limit < level_limit.outside
    assert level_limit.outside - level_limit.inside <= 2.0**-12


def test_a_gap_below_the_limit_ends_the_level() -> None:
    level_limit = find_level_end(decisions(), lambda value: not 0.4 < value < 0.6, 1.0)
    assert level_limit.inside <= 0.4 < level_limit.outside
    assert level_limit.outside - level_limit.inside <= 2.0**-11


def test_without_a_limit_of_equilibrium_values_up_to_a_hundred_sizes_are_decided() -> None:
    tried: list[float] = []

    def reaches(value: float) -> bool:
        tried.append(value)
        return value <= 50.0

    level_limit = find_level_end(decisions(), reaches, np.inf, size=2.0)
    assert tried[:3] == [2.0, 20.0, 200.0]
    assert level_limit.inside <= 50.0 < level_limit.outside < 50.1
    unlimited = find_level_end(decisions(), lambda value: True, np.inf, size=2.0)
    assert (unlimited.inside, unlimited.outside) == (200.0, np.inf)


def test_the_work_ends_the_bisection() -> None:
    budget = decisions(2.5)
    count = []

    def reaches(value: float) -> bool:
        count.append(value)
        budget.work.charge(1.0)
        return value <= 0.3

    level_limit = find_level_end(budget, reaches, 1.0)
    assert count == [1 - NEAR, 0.5, 0.25]
    assert (level_limit.inside, level_limit.outside) == (0.25, 0.5)


@pytest.mark.slow
def test_a_wedge_needs_more_friction_to_settle_than_for_equilibrium() -> None:
    groove = friction.v_block(friction=0.84).with_down([0, 0.3, -1])
    margin = kilter.margin(groove, require="settles", pushed=[])
    assert margin.at_level is not None
    limit = margin.at_level.friction
    assert limit is not None
    assert margin.friction < limit.outside < limit.inside < 1.1 * margin.friction
    levels = [
        kilter.check(groove.with_friction(mu)).level
        for mu in (limit.inside * 1.001, limit.outside * 0.999)
    ]
    assert holds(levels[0], "settles")
    assert levels[1] == "equilibrium"
    assert f"it settles at mu = {number(limit.inside)}" in text_of(margin.to_dict())


@pytest.mark.slow
def test_an_assembly_that_does_not_settle_as_drawn_has_no_such_limit(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    kilter.dump(scene("squeezed-block"), "a.kilter.json")
    assert main(["margin", "a.kilter.json", "--require", "settles", "--json", "--quiet"]) == 3
    answer = json.loads(capsys.readouterr().out)
    assert answer["level"] == "equilibrium"
    pushes = answer["at_level"]["pushes"]
    assert pushes["block"] == {"inside": None, "outside": None, "why": "none"}
    assert "as drawn it does not settle" in text_of(answer)


def test_all_searches_together_take_a_fixed_amount_of_work(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    spent: list[float] = []
    reach = LevelDecisions.reach

    def counted(self: LevelDecisions, *arguments) -> bool:
        before = self.work.spent
        answer = reach(self, *arguments)
        spent.append(self.work.spent - before)
        return answer

    monkeypatch.setattr(LevelDecisions, "reach", counted)
    slope = stacks.block_on_slope(20.0, friction=0.5)
    margin = kilter.margin(slope, require="settles", effort=0, push=[1, 0, 0], loads=True)
    assert margin.at_level is not None
    assert min(spent) >= DECISION
    # the decision during which the work ends is completed
    assert sum(spent[:-1]) <= SHARE * 100_000.0
    whys = {push.why for push in margin.at_level.pushes.values()}
    assert whys <= {"effort", "none", None}


def test_without_a_required_level_no_level_is_decided() -> None:
    margin = kilter.margin(stacks.block_on_slope(20.0, friction=0.5), pushed=[])
    assert margin.at_level is None
    assert margin.to_dict()["at_level"] is None


@pytest.mark.quick("refuted-settles", "refuted-proved")
@pytest.mark.parametrize("require", ["settles", "proved"])
@pytest.mark.parametrize(
    ("assembly", "level"),
    [
        (stacks.block_on_slope(20.0, friction=0.5), "proved"),
        (friction.h_block(friction=0.84), "equilibrium"),
        (stacks.block_on_slope(20.0, friction=0.3), None),
    ],
    ids=["proved", "refuted", "unstable"],
)
def test_omitted_questions_change_no_answer_about_a_level(
    assembly: Assembly, level: str, require: str
) -> None:
    touching = contacts(assembly)
    whole = decide(assembly, touching, second_order=False)
    only = decide(assembly, touching, require=require, second_order=False, level_only=True)
    assert whole.level == level
    assert holds(only.level, require) == holds(whole.level, require)
    if (level, require) == ("proved", "proved"):  # nothing else was examined
        assert len(whole.friction.tries) == whole.friction.settling.of
        assert not only.friction.tries


def test_every_question_of_a_decision_is_charged() -> None:
    search = LevelDecisions("settles", units_of(1), Work())
    squeezed = friction.h_block(friction=0.84)
    before = search.work.total
    search.reach(squeezed, contacts(squeezed))
    charged = search.work.spent
    # the charge itself counts in the total a second time
    assert search.work.total - before == pytest.approx(2 * charged - DECISION, rel=0.2)
    assert charged > DECISION
