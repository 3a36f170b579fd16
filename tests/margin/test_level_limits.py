"""Limits of friction and of levels, with both of their sides."""

import copy
import dataclasses
import json
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import pytest
from boxes_on_deck import stack_on_deck
from margins import program_of
from random_turned import random_turned, springer_arch

import kilter
from kilter import Assembly, GivenContact, contacts
from kilter.analysis.decision.cascade import decide
from kilter.analysis.decision.cohesion import find_cohesion
from kilter.analysis.decision.judge import judge
from kilter.analysis.load_limit import Limit, find_limit, gravity_wrench, limit_sides, with_more
from kilter.analysis.margins.least_friction import find_least_friction, held_by_squeeze, squeeze
from kilter.analysis.margins.level_limits import SHARE
from kilter.analysis.margins.limit_level import DECISION, NEAR, LevelDecisions, find_level_end
from kilter.analysis.margins.tilt import across_gravity
from kilter.cli import main
from kilter.mechanics.certificate import check_forces, check_motion
from kilter.mechanics.coulomb_cones import cone_problem
from kilter.mechanics.mechanics_tolerances import RULED_OUT, TOLERANCE
from kilter.mechanics.opening import Opening
from kilter.mechanics.proof import digest_of
from kilter.scenes import friction, scene, stacks
from kilter.scenes.pieces import block, floor
from kilter.tell.levels import holds
from kilter.tell.margin_facts import margin_facts
from kilter.tell.numbers import number
from kilter.tell.text import text_of
from kilter.work import Work, units_of


@pytest.mark.slow
def test_a_wall_over_an_opening_needs_a_fifth():
    """Its closed form, and the verdict a millionth beside it."""
    opening = scene("wall-with-opening")
    assert find_least_friction(program_of(opening)).value == pytest.approx(0.2, rel=1e-7)
    for share, held in ((1 + 1e-6, True), (1 - 1e-6, False)):
        program = program_of(opening).with_friction(0.2 * share)
        cohesion = find_cohesion(cone_problem(program))
        assert (cohesion.value < 0) is held
        assert check_forces(program, cohesion.forces, cohesion.friction).holds is held


def sides_wrong(program, found, least):
    """Faults of a least friction against its closed form, and of verdicts on either side of it."""
    wrong = [] if found.lower < least <= found.value * (1 + 1e-15) else ["the truth lies outside"]
    if found.value > least * (1 + 1e-7) + TOLERANCE / 10:
        wrong.append(f"{found.value / least - 1} too much")
    if found.forces.residual > 1e-12:
        wrong.append(f"forces leave {found.forces.residual}")
    for mu, stands in ((found.lower, False), (found.value, True)):
        if judge(program.with_friction(mu)).stable is not stands:
            wrong.append(f"the verdict at {mu}")
    return wrong


@pytest.mark.quick(1)
@pytest.mark.parametrize("tangent", [1e-2, 1e-4, 1e-5, 3e-6])
def test_the_truth_lies_within_however_tiny_the_coefficient(tangent):
    """A slope: what a certificate lets forces leave is 1e-9 of the weight, 1e-4 of the last."""
    slope = program_of(stacks.block_on_slope(float(np.degrees(np.arctan(tangent)))))
    found = find_least_friction(slope)
    assert sides_wrong(slope, found, tangent) == []
    assert found.value - found.lower < 4 * TOLERANCE + 1e-7 * tangent
    off = dataclasses.replace(found, value=found.value * (1 - 2 * TOLERANCE / tangent - 2e-7))
    assert "the truth lies outside" in sides_wrong(slope, off, tangent)


def test_a_block_between_leaning_plates_that_slides_along_them():
    """Normals carry it, friction what gravity has along the trough; it leans, so that they grow."""
    program = program_of(random_turned("wedge", 72))
    across, _, up = np.abs(program.normal[0])
    _, along, down = np.abs(program.down)
    least = up * along / np.hypot(down, across * along)
    assert least < 1e-4
    assert sides_wrong(program, find_least_friction(program), least) == []


def test_both_sides_of_a_tiny_coefficient_of_three_wedges():
    """No closed form: forces that balance to rounding, a motion, and what the cohesion says."""
    program = program_of(random_turned("wedge", 60))
    found = find_least_friction(program)
    assert found.value < 1e-3
    assert check_forces(program.with_friction(found.value), found.forces.forces,
                        found.forces.friction).residual < 1e-12  # fmt: skip
    assert check_motion(program.with_friction(found.lower), found.motion.motion).holds
    above = find_cohesion(cone_problem(program.with_friction(found.value * (1 + 1e-6))))
    below = find_cohesion(cone_problem(program.with_friction(found.value * (1 - 1e-6))))
    assert above.value < 0 < below.value
    assert find_cohesion(cone_problem(program.with_friction(found.lower))).value < 2 * TOLERANCE


@pytest.mark.slow
def test_data_that_no_forces_balance_to_rounding_are_held_as_far_as_a_certificate_lets_them():
    """One point under a block, a little beside its centre: a torque is left, whatever forces do."""
    lean = np.array([np.sin(0.1), 0.0, np.cos(0.1)])
    point = GivenContact(("floor", "block"), [[3e-10, 0.0, 0.0]], lean)
    parts = [floor([-1, -1], [1, 1]), block("block", [-0.5, -0.5, 0.0], [0.5, 0.5, 1.0])]
    found = find_least_friction(program_of(Assembly(parts, contacts=[point], detect=False)))
    assert found.value == pytest.approx(np.tan(0.1), rel=1e-6)
    assert 1e-10 < found.forces.residual <= TOLERANCE
    assert found.forces.holds


@pytest.mark.parametrize("degrees", [5.0, 20.0, 40.0])
def test_the_cohesion_of_a_block_on_a_slope(degrees):
    """Its four contacts share what its weight needs along the slope beyond mu of that across."""
    angle, mu = np.radians(degrees), 0.3
    found = find_cohesion(cone_problem(program_of(stacks.block_on_slope(degrees, friction=mu))))
    needed = (np.sin(angle) - mu * np.cos(angle)) / 4
    assert found.value == pytest.approx(needed, abs=1e-8)
    assert found.slope == pytest.approx(np.cos(angle) / 4, abs=1e-6)
    assert mu + found.rise == pytest.approx(np.tan(angle), abs=1e-7)


def test_any_friction_holds_what_is_squeezed_however_indirectly():
    """The plate that presses the books slides in guides: they jam it first, then it presses."""
    books = program_of(friction.books())
    pressed = squeeze(books.frictionless) > 0
    guides = {"guide-below", "guide-above", "guide-front", "guide-back"}
    for row in np.flatnonzero(pressed):
        assert books.names[books.part_a[row]] in guides or books.names[books.part_b[row]] in guides
    found = find_least_friction(books)
    assert (found.value, found.attained) == (0.0, False)
    assert found.forces.holds
    assert all(judge(books.with_friction(mu)).stable for mu in (1e-3, 1e-2, 0.1))


@pytest.mark.slow
def test_no_squeeze_holds_what_gravity_takes_out_of_it():
    """A block between plates that lean by an angle slips out below its tangent.

    The forces grow with the inverse of the distance from this limit, up to `RULED_OUT` weights.
    """
    leaning = program_of(friction.a_block(10.0))
    assert held_by_squeeze(leaning) is None
    limit, found = np.tan(np.radians(10.0)), find_least_friction(leaning)
    assert limit < found.value < limit + 2 / RULED_OUT


def decisions(allowed: float = np.inf) -> LevelDecisions:
    return LevelDecisions("settles", 0.0, Work(allowed))


@pytest.mark.parametrize("limit", [1e-3, 0.2, 0.7, 0.9995])
def test_bisection_encloses_the_value_at_which_the_level_ends(limit):
    level_limit = find_level_end(decisions(), lambda value: value <= limit, 1.0)
    assert level_limit.inside <= limit < level_limit.outside
    assert level_limit.outside - level_limit.inside <= 2.0**-12


def test_a_gap_below_the_limit_ends_the_level():
    level_limit = find_level_end(decisions(), lambda value: not 0.4 < value < 0.6, 1.0)
    assert level_limit.inside <= 0.4 < level_limit.outside
    assert level_limit.outside - level_limit.inside <= 2.0**-11


def test_without_a_limit_of_equilibrium_values_up_to_a_hundred_sizes_are_decided():
    tried: list[float] = []

    def reaches(value: float) -> bool:
        tried.append(value)
        return value <= 50.0

    level_limit = find_level_end(decisions(), reaches, np.inf, size=2.0)
    assert tried[:3] == [2.0, 20.0, 200.0]
    assert level_limit.inside <= 50.0 < level_limit.outside < 50.1
    unlimited = find_level_end(decisions(), lambda value: True, np.inf, size=2.0)
    assert (unlimited.inside, unlimited.outside) == (200.0, np.inf)


def test_the_work_ends_the_bisection():
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
def test_a_wedge_needs_more_friction_to_settle_than_for_equilibrium():
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
def test_an_assembly_that_does_not_settle_as_drawn_has_no_such_limit(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    kilter.dump(scene("squeezed-block"), "a.kilter.json")
    typed = ["--pushes", "--require", "settles", "--json", "--quiet"]
    assert main(["margin", "a.kilter.json", *typed]) == 3
    answer = json.loads(capsys.readouterr().out)
    assert answer["level"] == "equilibrium"
    pushes = answer["at_level"]["pushes"]
    assert pushes["block"] == {"inside": None, "outside": None, "why": "none"}
    assert "as drawn it does not settle" in text_of(answer)


@pytest.mark.slow
def test_all_searches_together_take_a_fixed_amount_of_work(monkeypatch):
    spent: list[float] = []
    reach = LevelDecisions.reach

    def counted(self: LevelDecisions, *arguments) -> bool:
        before = self.work.spent
        answer = reach(self, *arguments)
        spent.append(self.work.spent - before)
        return answer

    monkeypatch.setattr(LevelDecisions, "reach", counted)
    slope = stacks.block_on_slope(20.0, friction=0.5)
    margin = kilter.margin(
        slope, require="settles", effort=0, push=[1, 0, 0], pushes=True, loads=True
    )
    assert margin.at_level is not None
    assert min(spent) >= DECISION
    # the decision during which the work ends is completed
    assert sum(spent[:-1]) <= SHARE * 100_000.0
    whys = {push.why for push in margin.at_level.pushes.values()}
    assert whys <= {"effort", "none", None}


def test_without_a_required_level_no_level_is_decided():
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
def test_omitted_questions_change_no_answer_about_a_level(assembly, level, require):
    touching = contacts(assembly)
    whole = decide(assembly, touching, second_order=False)
    only = decide(assembly, touching, require=require, second_order=False, level_only=True)
    assert whole.level == level
    assert holds(only.level, require) == holds(whole.level, require)
    if (level, require) == ("proved", "proved"):  # nothing else was examined
        assert len(whole.friction.tries) == whole.friction.settling.of
        assert not only.friction.tries


def test_every_question_of_a_decision_is_charged():
    search = LevelDecisions("settles", units_of(1), Work())
    squeezed = friction.h_block(friction=0.84)
    before = search.work.total
    search.reach(squeezed, contacts(squeezed))
    charged = search.work.spent
    # the charge itself counts in the total a second time
    assert search.work.total - before == pytest.approx(2 * charged - DECISION, rel=0.2)
    assert charged > DECISION


Bundle = dict[str, Any]


@cache
def proofs() -> dict[str, tuple[kilter.Assembly, Bundle]]:
    block = stacks.block_on_slope(5.0, friction=0.5)
    margin = kilter.margin(block).proof()
    carried = kilter.transport(block).proof()
    return {
        kind: (block, json.loads(json.dumps(proof)))
        for kind, proof in (("margin", margin), ("transport", carried))
    }


def verified(kind: str, change: Callable[[Bundle], object]) -> kilter.Verification:
    """Result for a changed copy of a proof with a fresh digest."""
    assembly, proof = proofs()[kind]
    bundle = copy.deepcopy(proof)
    change(bundle)
    bundle["digest"] = digest_of(bundle)
    return kilter.verify(assembly, bundle)


@pytest.mark.quick(1)
@pytest.mark.parametrize("kind", ["margin", "transport"])
@pytest.mark.slow
def test_each_limit_is_stated_with_both_sides(kind):
    found = verified(kind, lambda bundle: None)
    assert found.holds, found.reasons
    limits = [note for note in found.notes if "held at" in note]
    assert limits
    assert all("falls at" in note for note in limits)


def entries(kind: str) -> list[int]:
    return list(range(len(proofs()[kind][1]["proofs"])))


@pytest.mark.quick(1)
@pytest.mark.parametrize("kind", ["margin", "transport"])
@pytest.mark.parametrize(
    "change",
    [
        lambda entry: entry.update(value=1e6),
        lambda entry: entry.update(value=entry["value"] * (1 + 1e-6)),
        lambda entry: entry.update(held=not entry["held"]),
    ],
    ids=["far", "near", "flipped"],
)
def test_a_value_that_differs_from_the_change_is_refused(kind, change):
    for k in entries(kind):
        assert not verified(kind, lambda bundle, k=k: change(bundle["proofs"][k])).holds


def test_a_turn_about_an_axis_and_both_load_factors_are_in_the_proof():
    """A cube slides at mu: at atan .3 about y, and at .3 of its weight along and against x."""
    cube = stack_on_deck([[1, 1, 1]], 0.3)
    answer = kilter.margin(cube, about=[0, 1, 0], push=[1, 0, 0])
    proof = answer.proof()
    stated = {(entry["about"], entry["held"]): entry["value"] for entry in proof["proofs"]}
    for held in (True, False):
        assert stated["tilt about the axis", held] == pytest.approx(np.arctan(0.3), abs=1e-6)
        assert stated["load factor", held] == pytest.approx(0.3, abs=1e-6)
        assert stated["least load factor", held] == pytest.approx(-0.3, abs=1e-6)
    assert kilter.verify(cube, proof).holds
    facts = dict(margin_facts(answer.to_dict()))
    assert facts["about axis"].startswith("16.699")
    assert "about (0, 1, 0) by the right-hand rule" in facts["about axis"]


CASES = [("arch", 1), ("arch", 2), ("pile", 6), ("pile", 12), ("wedge", 3), ("round", 5)]


@pytest.mark.slow
@pytest.mark.parametrize(("family", "seed"), CASES)
def test_both_ways_find_one_limit_and_judge_agrees(family, seed):
    program = program_of(random_turned(family, seed))
    basis = across_gravity(program)
    for angle in (0.3, 2.0):
        aside = np.cos(angle) * basis[0] + np.sin(angle) * basis[-1]
        wrench = gravity_wrench(program, aside / np.linalg.norm(aside))
        limit = find_limit(program, wrench, most=10.0)
        sides = limit_sides(program, wrench, 10.0)
        if not isinstance(limit, Limit) or not np.isfinite(limit.value):
            assert sides.none or sides.held > 9.999 or sides.forces is None
            continue
        assert limit.forces.holds
        assert limit.motion.holds
        assert sides.held <= limit.value + limit.gap + 1e-7
        assert sides.beyond >= limit.value - 1e-7
        size = max(abs(limit.value), 1.0)
        assert judge(with_more(program, wrench, limit.value - 1e-6 * size)).stable is not False
        assert judge(with_more(program, wrench, limit.value + 1e-5 * size)).stable is not True


def test_a_plane_is_exact_in_one_round():
    program = program_of(springer_arch(7, 0.2, planar=True))
    wrench = gravity_wrench(program, np.array([1.0, 0, 0]))
    sides = limit_sides(program, wrench, 10.0)
    assert sides.closed
    assert sides.start - sides.held < 1e-12


def test_it_is_proved_that_no_share_is_held():
    program = program_of(stacks.block_on_slope(40.0, friction=0.2))
    across = gravity_wrench(program, np.array([0.0, 1.0, 0.0]))
    sides = limit_sides(program, across, 10.0)
    assert sides.none
    assert sides.forces is None


def test_a_share_up_to_the_most_is_unlimited():
    program = program_of(stacks.block_on_slope(0.0, friction=0.5))
    down = gravity_wrench(program, np.array([0.0, 0.0, -1.0]))
    assert limit_sides(program, down, 1e6).held == pytest.approx(1e6)
    assert find_limit(program, down).value == np.inf


@pytest.mark.parametrize(("family", "seed"), [("arch", 1), ("pile", 6), ("wedge", 2)])
def test_a_mended_motion_is_admissible(family, seed):
    program = program_of(random_turned(family, seed))
    opening = Opening(cone_problem(program))
    assert opening.m0 is not None
    random = np.random.default_rng(seed)
    noise = random.normal(size=opening.m0.shape) * program.free[:, None]
    assert check_motion(program, noise).violation > 1e-3
    mended = opening.mended(noise)
    assert check_motion(program, mended).violation < 1e-15
    assert (opening.mended(mended) == mended).all()


def test_a_share_that_is_held_whole_takes_no_linear_program(monkeypatch):
    """The most that is looked at is proved by one conic program; the limit beyond it is not."""

    def unasked(*_: object) -> None:
        raise AssertionError("linear programs were asked")

    monkeypatch.setattr("kilter.analysis.load_limit.limit_sides", unasked)
    program = program_of(stacks.block_on_slope(0.0, friction=0.5))
    aside = gravity_wrench(program, np.array([0.28, 0.96, 0.0]))
    for most, value in ((0.4, np.inf), (1.0, pytest.approx(0.5, abs=1e-8))):
        assert find_limit(program, aside, most=most).value == value


def unasked(*_: object, **__: object) -> None:
    raise AssertionError("another solver was asked")
