"""Proofs of second order: true ones hold, damaged and forged ones do not."""

import copy
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from balance_cases import CASES
from proofs import BUILD, proved
from test_recognised import doubt, weeble

import kilter
from kilter import Assembly, Box, Cylinder, Joint, Part, Pose, Sphere
from kilter.mechanics.program import build_program
from kilter.mechanics.proof import digest_of
from kilter.scenes import scene
from kilter.second_order.gaps.features_of import features_of
from kilter.second_order.gaps.stationary import problem_of
from kilter.second_order.gaps.touched_surfaces import touched_surfaces
from kilter.second_order.motions.free_motions import find_free_motions, free_span
from kilter.second_order.motions.null_space import null_space
from kilter.second_order.proofs.fall_proof import STEPS
from kilter.second_order.proofs.minimum_proof import MinimumProof, by_part
from kilter.second_order.searches.decide import decide


@pytest.mark.quick(12)
@pytest.mark.parametrize("kind", [kind for kind in BUILD if kind != "flat"])
def test_a_true_proof_holds(kind):
    judge, data = proved(kind)
    assert judge(data) == []


def changed(data: dict[str, Any], where: str, value: Any) -> dict[str, Any]:
    """The data with an entry replaced or computed from the old; "clusters.0.state" is nested."""
    other = at = copy.deepcopy(data)
    *keys, last = (int(key) if key.isdigit() else key for key in where.split("."))
    for key in keys:
        at = at[key]
    if value is None and last != "configuration" and not isinstance(last, int):
        del at[last]
    else:
        at[last] = value(at[last]) if callable(value) else value
    return other


def scaled(by: float) -> Callable[[Any], Any]:
    """A function that multiplies a motion or numbers by a factor."""

    def made(old: Any) -> Any:
        if isinstance(old, dict):
            return {name: [by * x for x in six] for name, six in old.items()}
        return [by * x for x in old]

    return made


FORM = "do not have the required form"
OWN = "its stated result or counts differ"
DAMAGES = [
    ("held", "state", "free", OWN),
    ("held", "neutral", 1, OWN),
    ("held", "free", 1, OWN),
    ("held", "held", scaled(1.1), "do not balance"),
    ("held", "held", scaled(-1.0), "pulls"),
    ("held", "held", lambda old: old[:-1], "a finite force for each contact"),
    ("held", "held", lambda old: [[one] for one in old], FORM),
    ("held", "held", ["nan"] * 6, FORM),
    ("held", "held", lambda old: [str(one) for one in old], FORM),
    ("mixed", "clusters.0.held", scaled(1.1), "do not balance"),
    ("plane", "neutral", 3, OWN),
    ("plane", "free", 3, OWN),
    ("plane", "motion", {"block": [1, 1e-9, 0, 0, 0, 0]}, "leaves the plane"),
    ("level", "motion", {"block": [0, 1, 0, 0, 0, 0], "floor": [0] * 6}, "to the free parts"),
    ("level", "state", "minimum", OWN),
    ("level", "neutral", 2, OWN),
    ("level", "free", 2, OWN),
    ("level", "level", scaled(1.1), "do not balance"),
    ("level", "motion", {"block": [0, 0, 1, 0, 0, 0]}, "not a horizontal shift"),
    ("level", "motion", {"floor": [1, 0, 0, 0, 0, 0]}, FORM),
    ("level", "motion", {}, FORM),
    ("level", "motion", None, FORM),
    ("locked", "state", "minimum", OWN),
    ("locked", "neutral", 5, OWN),
    ("locked", "free", 6, OWN),
    ("locked", "locked", scaled(1.1), "do not balance"),
    ("locked", "stress", scaled(-1.0), "does not press"),
    ("stopped", "state", "minimum", OWN),
    ("stopped", "neutral", 3, OWN),
    ("stopped", "free", 4, OWN),
    ("stopped", "stopped", scaled(1.1), "do not balance"),
    ("stopped", "weights", lambda old: [scaled(2.0)(one) for one in old], "stops do not keep"),
    ("stopped", "motion", {}, FORM),
    ("stopped", "motion", scaled(-1.0), "does not open every stop"),
    ("minimum", "state", "free", OWN),
    ("minimum", "state", "balanced", OWN),
    ("minimum", "neutral", 4, OWN),
    ("minimum", "free", 5, OWN),
    ("minimum", "basis", lambda old: old[:1], "leave other motions neutral"),
    ("minimum", "across", lambda old: old[:1], "leave other motions neutral"),
    ("minimum", "forces", lambda old: [scaled(1.1)(old[0])], "do not balance"),
    ("minimum", "forces", [], FORM),
    ("minimum", "weights", [[[1.0]]], "weights of its sides"),
    ("minimum", "weights", [[[1.0, 2.0]]], FORM),
    ("minimum", "sides", [[1.0, 0.0]], "not belong to a contact"),
    ("minimum", "rolling", "holds", "only a balanced cluster"),
    ("cones", "splits", lambda old: old[:3], "fewer cones than orthants"),
    ("cones", "splits", lambda old: old[:4], "do not form a tree"),
    ("cones", "splits.0", [0, 3], "do not form a tree"),
    ("cones", "splits.0", [2, 1.5], ""),
    ("cones", "weights.0", lambda old: [scaled(-1.0)(one) for one in old], "weights of its sides"),
    ("rolls", "state", "minimum", OWN),
    ("rolls", "free", 4, OWN),
    ("idle", "idle", [], "only of a proof of a minimum"),
    ("idle", "idle", [0], "do not balance"),
    ("idle", "idle", [0, 1], "a finite force for each contact"),
    ("idle", "idle", [2], FORM),
    ("idle", "state", "minimum", OWN),
    ("idle", "state", "balanced", OWN),
    ("idle", "basis", None, FORM),
    ("idle", "motion", scaled(-1.0), "does not open the contacts"),
    ("idle", "motion", scaled(0.0), "does not open the contacts"),
    ("idle", "motion", {"ball": [1, 0, 0.1, 0, 0, 0]}, "not one of its free motions"),
    ("idle", "motion", {"ball": [0, 0, 0, 0, 0, 1]}, "does not open the contacts"),
    ("corner", "motion", {"ball": [1, 0, 0, 0, 0, 0]}, "does not open the contacts"),
    ("odd", "motion", {"ball": [0, 0, 0, 0, 0, 1]}, "only spins parts"),
    ("odd", "motion", {"ball": [0, 0, 0, 0, 0, -1]}, "does not open the contacts"),
    ("pair", "motion", {"ball": [0] * 6, "other": [1, 0, 0, 0, 0, 0]}, "does not open"),
    ("unknown", "idle", None, "free although the curvature at some contacts is unknown"),
    ("unknown", "idle", [0], "free although the curvature at some contacts is unknown"),
    ("unknown", "state", "free", OWN),
    ("path", "state", "minimum", OWN),
    ("path", "first", scaled(1.0 + 1e-6), "not decrease along its path"),
    ("path", "first", scaled(0.0), "not decrease along its path"),
    ("path", "second", scaled(-1.0), "not decrease along its path"),
    ("path", "second", None, FORM),
    ("path", "neutral", 5, OWN),
    ("path", "free", 3, OWN),
    ("path", "rolling", "holds", "claim about rolling is wrong"),
    ("path", "rolling", "falls", "claim about rolling is wrong"),
    ("path", "configuration", {"b": [0, 0, -1, 0, 0, 0]}, "not on its path"),
    ("place", "configuration", None, "no configuration"),
    ("place", "configuration", scaled(-1.0), "not on its path"),
    ("beside", "configuration", None, "no configuration"),
    ("mesh", "second", scaled(-1.0), "not decrease along its path"),
    ("joined", "state", "free", OWN),
    ("joined", "state", "open", OWN),
    ("joined", "neutral", 5, OWN),
    ("joined", "free", 3, OWN),
    ("joined", "neutral", None, OWN),
    ("joined", "clusters", lambda old: old[:1], "not have a proof for each cluster"),
    ("joined", "clusters", lambda old: old[::-1], FORM),
    ("joined", "clusters", [None, None], OWN),
    ("joined", "clusters.1", lambda old: None, OWN),
    ("joined", "clusters.0.neutral", 4, OWN),
    ("worst", "clusters.0", lambda old: None, OWN),
    ("worst", "neutral", 5, OWN),
    ("board", "rolling", "falls", "claim about rolling is wrong"),
    ("boards", "rolling", "holds", "claim about rolling is wrong"),
    ("boards", "rolling", None, "claim about rolling is wrong"),
    ("boards", "clusters.0.rolling", "falls", "claim about rolling is wrong"),
    ("boards", "clusters.1.rolling", None, "claim about rolling is wrong"),
    ("boards", "clusters.2.rolling", "holds", "only a balanced cluster can roll"),
]  # fmt: skip


@pytest.mark.parametrize(("kind", "where", "value", "reason"), DAMAGES)
def test_what_is_damaged_is_refused(kind, where, value, reason):
    judge, data = proved(kind)
    reasons = judge(changed(data, where, value))
    assert reasons
    assert any(reason in one for one in reasons), reasons


def test_beside_what_falls_nothing_else_is_to_be_known():
    for kind, rest in (("worst", "clusters.1"), ("boards", "clusters.2")):
        judge, data = proved(kind)
        assert judge(changed(data, rest, lambda old: None)) == []


@pytest.mark.parametrize(
    ("kind", "of", "more", "reason"),
    [
        ("mesh", "locked", {}, "not known exactly enough"),
        ("mesh", "stopped", {}, "not known exactly enough"),
        ("doubtful", "rolls", {}, "not known exactly enough"),
        ("unknown", "path", {}, "the curvature is not known at every contact"),
        ("sharp", "rolls", {}, "edges and corners without a unique normal"),
    ],
)
def test_a_proof_of_another_kind_is_refused(kind, of, more, reason):
    (judge, _), (_, data) = proved(kind), proved(of)
    assert any(reason in one for one in judge(data | more))


def proof_of_the_middle(assembly: Assembly) -> dict[str, Any]:
    """The proof of a minimum with the surfaces as recognised, without their doubt."""
    contacts = kilter.contacts(assembly)
    program = build_program(assembly, contacts).frictionless
    features = features_of(program, contacts, recognised=True)
    touched = touched_surfaces(program, features, contacts)
    free = find_free_motions(program, features, touched).symmetries
    problem = problem_of(program, features)
    decision = decide(problem, free_span(program, problem, free))
    proof = decision.proof
    assert isinstance(proof, MinimumProof)
    return {
        "state": "free",
        "neutral": decision.neutral,
        "free": decision.free,
        "basis": [by_part(program, problem, one) for one in proof.basis.T],
        "across": [by_part(program, problem, one) for one in proof.free.T],
        "sides": [],
        "splits": [],
        "forces": [(leaf.forces * problem.weight).tolist() for leaf in proof.leaves],
        "weights": [leaf.weights.tolist() for leaf in proof.leaves],
    }


@pytest.mark.parametrize(("doubts", "reason"), [(-4.2, ""), (-3.8, "does not curve upward")])
def test_a_minimum_of_a_mesh_is_one_of_every_surface_it_may_stand_for(doubts, reason):
    assembly = weeble(doubts * doubt())
    proof = kilter.check(assembly).proof() | {"second_order": proof_of_the_middle(assembly)}
    proof["digest"] = digest_of(proof)
    found = kilter.verify(assembly, proof)
    assert found.holds == (not reason)
    assert any(reason in one for one in found.reasons) or not reason


def test_a_path_on_a_mesh_is_one_on_every_surface_it_may_stand_for():
    true, other = weeble(4.6 * doubt()), weeble(3.8 * doubt())
    proof, near = kilter.check(true).proof(), kilter.check(other).proof()
    assert kilter.verify(true, proof).holds
    near["second_order"] = proof["second_order"]
    near["digest"] = digest_of(near)
    assert any("not decrease along its path" in one for one in kilter.verify(other, near).reasons)


def test_what_is_level_to_second_order_is_not_free_for_that():
    judge, none = proved("flat")
    assert none is None
    assembly = BUILD["flat"]()
    contacts = kilter.contacts(assembly)
    program = build_program(assembly, contacts).frictionless
    problem = problem_of(program, features_of(program, contacts))
    neutral = null_space(problem.rows, problem.blur)
    forces = np.ones(1)
    values, axes = np.linalg.eigh(problem.curvature(forces, neutral))
    assert values[:3] == pytest.approx([0, 0, 0], abs=1e-12)
    assert (values[3:] > 0.1).all()
    named = [by_part(program, problem, one) for one in (neutral @ axes).T]
    forged = {"state": "free", "neutral": 5, "free": 3, "basis": named[3:], "across": named[:3]}
    forged |= {"sides": [], "splits": [], "weights": [[]]}
    forged |= {"forces": [[float(program.weight[1])]]}
    assert judge(forged) == ["its second order: a motion that it calls free is not proved to be"]


def test_far_enough_out_of_a_corner_any_way_will_do():
    for kind, ways in (
        ("idle", ([1, 0, 0, 0, 0, 0], [2, 0, 0, 0, 0, 0], [1, 5, 0, 0, 0, 3])),
        ("corner", ([1, 0.1, 0, 0, 0, 0], [1e-6, 1e-6, 0, 0, 0, 0])),
        ("odd", ([1, 0, 0, 0, 0, 0],)),
    ):
        judge, data = proved(kind)
        for way in ways:
            assert judge(data | {"motion": {"ball": way}}) == []


@pytest.mark.parametrize(
    ("other", "holds"),
    [
        ({}, True),
        ({"ball": [1, 1e-13, 0, 0, 0, 0]}, True),
        ({"ball": [1, 1e-11, 0, 0, 0, 0]}, False),
        ({"ball": [1, 0, 0, 0, 0, 1e-11]}, False),
        ({"ball": [1, 0, 0, 1e-11, 0, 0]}, False),
        ({"wall 0": [1 + 1e-11, 0, 0, 0, 0, 0]}, False),
        ({"wall 3": [1, 0, 0, 0, 0, 1e-11]}, False),
        ({"wall 3": [1, 0, 0, 0, 0, 1e-13]}, True),
        ({"wall 0": [1, 0, 0, 0, 0, 0.8e-12]}, False),  # its corners are 1.6 from its middle
    ],
)
def test_what_goes_along_is_shifted_alike_and_not_turned(other, holds):
    """A ball in a box of walls that touch it: together they slide."""
    judge, data = proved("together")
    motion = {name: [1.0, 0, 0, 0, 0, 0] for name in data["motion"]}
    motion |= other
    for size in (1.0, 1e-6):
        given = {name: (size * np.array(six)).tolist() for name, six in motion.items()}
        assert (judge(data | {"motion": given}) == []) == holds


def test_they_do_not_turn_as_one():
    judge, data = proved("together")
    parts = {one.name: one.pose.position for one in BUILD["together"]().parts}
    about = {name: [-parts[name][1], parts[name][0], 0, 0, 0, 1] for name in data["motion"]}
    assert judge(data | {"motion": about}) != []


def down_a_ball(step: float, opens: float) -> dict[str, Any]:
    """A path of the upper ball to the left with a given opening of its gap, and a place on it."""
    first = [-0.5, 0, 0, 0, 0, 0]
    second = [0, 0, 0.5 * (opens - 0.5), 0, 0, 0]
    place = step * np.array(first) + step**2 / 2 * np.array(second)
    named = {"first": first, "second": second, "configuration": place.tolist()}
    return {"state": "balanced"} | {key: {"top": value} for key, value in named.items()}


@pytest.mark.parametrize(
    ("kind", "step", "opens", "reasons"),
    [
        ("place", 0.01, 0.25, []),
        ("place", 0.05, 0.25, []),
        ("near", 0.005, 0.25, []),
        ("near", 0.02, 0.25, ["its second order: parts penetrate each other in its configuration"]),
        # apart by opens step^2 / 2, lower by (1/2 - opens) step^2 / 2
        ("place", 2.2e-6, 0.45, ["its second order: the energy of its configuration is not lower"]),
        (
            "place",
            2.2e-6,
            0.05,
            ["its second order: parts penetrate each other in its configuration"],
        ),
        ("place", 3.5e-6, 0.25, []),
        (
            "place",
            1e-3,
            1.1e-6,
            ["its second order: parts penetrate each other in its configuration"],
        ),
        ("place", 2e-3, 1.1e-6, []),
    ],
)
def test_a_place_is_apart_and_lower_by_more_than_rounding(kind, step, opens, reasons):
    judge, _ = proved(kind)
    assert judge(down_a_ball(step, opens)) == reasons


def test_cones_are_counted_before_they_are_made():
    """Five motions have 16 orthants, up to sign."""
    judge, data = proved("rolls")
    forged = data | {"basis": data["across"], "across": [], "free": 0}
    for count, reason in ((15, "fewer cones than orthants"), (16, "")):
        reasons = judge(forged | {"splits": [None] * count})
        assert any(reason in one for one in reasons)
        assert any("orthants" in one for one in reasons) == bool(reason)


def test_of_rolling_nothing_need_be_said():
    judge, data = proved("board")
    assert judge(changed(data, "rolling", None)) == []


@pytest.mark.parametrize("data", [None, [], 3, "held", {"clusters": 3}, {"clusters": {}}, {}])
def test_what_is_no_proof_is_refused(data):
    judge, _ = proved("minimum")
    assert judge(data)


Place = tuple[str | int, ...]


def numbers(data: Any, place: Place = ()) -> list[Place]:
    """The places of all numbers of a proof."""
    if isinstance(data, dict):
        return [one for key, value in data.items() for one in numbers(value, (*place, key))]
    if isinstance(data, list):
        return [one for k, value in enumerate(data) for one in numbers(value, (*place, k))]
    return [place] if isinstance(data, float | int) and not isinstance(data, bool) else []


def changed_file(proof: dict[str, Any], place: Place, by: float) -> dict[str, Any]:
    """The proof with a changed number in its second order, and a matching digest."""
    other = copy.deepcopy(proof)
    at = other["second_order"]
    for key in place[:-1]:
        at = at[key]
    at[place[-1]] += by
    other["digest"] = digest_of(other)
    return other


def proof_of(number: str) -> tuple[kilter.Assembly, dict[str, Any]]:
    case = next(case for case in CASES if case.number == number)
    assembly = case.build(0.0 if case.limit is None else case.limit - 0.05)
    return assembly, kilter.check(assembly).proof()


@pytest.mark.quick(1)
@pytest.mark.parametrize("number", ["03", "26", "38"])
def test_a_changed_number_of_a_minimum_is_refused(number):
    assembly, proof = proof_of(number)
    for place in numbers(proof["second_order"]):
        assert not kilter.verify(assembly, changed_file(proof, place, 0.37)).holds, place


@pytest.mark.parametrize("name", ["paper-figure-1-in-space", "paper-figure-12-in-space"])
def test_the_paths_of_the_papers_figures_are_judged_again(name):
    assembly = scene(name)
    verdict = kilter.check(assembly)
    proof = verdict.proof()
    assert proof["second_order"]["state"] == "balanced"
    assert proof["second_order"]["configuration"] is not None
    assert kilter.verify(assembly, proof).holds
    lifted = copy.deepcopy(proof)
    place = lifted["second_order"]["configuration"]
    for six in place.values():
        six[:3] = (-x for x in six[:3])
    lifted["digest"] = digest_of(lifted)
    assert not kilter.verify(assembly, lifted).holds
    nowhere = copy.deepcopy(proof)
    nowhere["second_order"]["configuration"] = None
    nowhere["digest"] = digest_of(nowhere)
    assert not kilter.verify(assembly, nowhere).holds


def in_a_hollow(slope: float, count: int) -> kilter.Assembly:
    """A ball of 1 mm on three smaller ones on a tower of blocks of 1 m; it rises by `slope`."""
    parts = [Part("floor", Box([20, 20, 1]), Pose([0, 0, -0.5]), grounded=True)]
    parts += [Part(f"{k}", Box([1, 1, 1]), Pose([0, 0, k + 0.5]), mass=1.0) for k in range(count)]
    large = 1e-3
    small = 0.75 * slope * large
    aside = slope * (large + small)
    for k, angle in enumerate(2 * np.pi / 3 * np.arange(3)):
        at = [aside * np.cos(angle), aside * np.sin(angle), count + small / 2]
        parts.append(Part(f"s{k}", Sphere(small), Pose(at), mass=1e-9))
    high = count + small / 2 + np.sqrt((large + small) ** 2 - aside**2)
    parts.append(Part("ball", Sphere(large), Pose([0, 0, high]), mass=1.0))
    return Assembly(parts, joints=[Joint((f"{count - 1}", f"s{k}"), "fixed") for k in range(3)])


@pytest.mark.slow
def test_a_small_ball_in_a_hollow_beside_large_blocks_is_not_balanced():
    """Relative to the blocks its gaps curve strongly, and far from it there is room below."""
    assembly = in_a_hollow(0.01, 5)
    verdict = kilter.check(assembly)
    proof, second = verdict.proof(), verdict.second_order_answer
    assert second is not None
    assert second.problem is not None
    assert second.state == "free"
    still = {name: [0.0] * 6 for name in ("0", "1", "2", "3", "4")}
    length = second.problem.length
    for far in (100.0, 135.0, 200.0):
        forged = {
            "state": "balanced",
            "first": still | {"ball": [-length, 0, 0, 0, 0, 0]},
            "second": still | {"ball": [0, 0, -far * length, 0, 0, 0]},
            "configuration": still | {"ball": [5.0, 0, -1, 0, 0, 0]},
        }
        found = kilter.verify(assembly, with_second_order(proof, forged))
        assert found.reasons == (
            "its second order: the energy does not decrease along its path; "
            "its configuration is not on its path",
        )


def test_a_configuration_is_a_place_on_its_path_and_near_by():
    assembly = scene("paper-figure-1-in-space")
    proof = kilter.check(assembly).proof()
    path = proof["second_order"]
    first, second, place = (path[key] for key in ("first", "second", "configuration"))

    def asked(motion: dict[str, list[float]]) -> tuple[str, ...]:
        data = path | {"configuration": motion}
        return kilter.verify(assembly, with_second_order(proof, data)).reasons

    def at(step: float) -> dict[str, list[float]]:
        return {
            name: (step * np.array(first[name]) + step**2 / 2 * np.array(second[name])).tolist()
            for name in first
        }

    assert not asked(place)
    assert not asked(at(0.002))
    off_it = ("its second order: its configuration is not on its path",)
    assert asked(at(-0.002)) == asked(at(1.01 * max(STEPS))) == off_it
    for name in place:
        for k in range(6):
            other = copy.deepcopy(place)
            other[name][k] += 1e-9
            assert asked(other) == off_it


def test_a_proof_without_its_parts_is_refused():
    assembly, proof = proof_of("26")
    for key in proof["second_order"]:
        short = copy.deepcopy(proof)
        del short["second_order"][key]
        short["digest"] = digest_of(short)
        assert not kilter.verify(assembly, short).holds, key


@pytest.mark.parametrize("word", ["nan", "inf", "1.0", True, None])
def test_words_in_the_place_of_numbers_make_no_ball_on_a_ball_a_minimum(word):
    """Two motions are neutral beside the spins: cones with two sides each, and no valid weights."""
    assembly, proof = proof_of("02")
    bowl = proof_of("03")[1]["second_order"]
    one = [[word, word], [word, word]]
    forged = bowl | {"splits": [None, None], "weights": [one, one], "forces": bowl["forces"] * 2}
    assert not kilter.verify(assembly, with_second_order(proof, forged)).holds


def test_a_lift_by_next_to_nothing_makes_no_ball_in_a_bowl_balanced():
    assembly, proof = proof_of("03")
    first = [0.7, 0, 0.7e-7, 0, 0, 0]
    for lift in ([0, 0, -0.7, 0, 0, 0], [0, 0, -7, 0, 0, 0]):
        forged = {"state": "balanced", "configuration": None}
        forged |= {"first": {"b": first}, "second": {"b": lift}}
        assert not kilter.verify(assembly, with_second_order(proof, forged)).holds


def with_second_order(proof: dict[str, Any], data: Any) -> dict[str, Any]:
    """The proof with given data of second order, and a matching digest."""
    other = copy.deepcopy(proof) | {"second_order": data}
    other["digest"] = digest_of(other)
    return other


@pytest.mark.parametrize("kind", ["stopped", "locked"])
def test_forces_so_large_that_their_torques_are_no_numbers_balance_nothing(kind):
    """A can with its centre over an edge; its sums of torques would be less than infinity."""
    low = Part("low", Box([1, 6, 1]), Pose([0, 0, 0.5]), grounded=True)
    can = Part("can", Cylinder(1.0, 0.1), Pose([0.5, 0, 1.05]), mass=0.05)
    assembly = Assembly([low, can])
    proof = kilter.check(assembly).proof()
    assert proof["second_order"]["state"] == "balanced"
    count = len(proof["forces"])
    rest = {"stress": [1.0] * count, "weights": [], "motion": {"can": [1, 0, 0, 0, 0, 0]}}
    for force in (1e100, 1.01e100, 6e307):
        forged = {"state": "free", "neutral": 3, "free": 3, kind: [force] * count} | rest
        (reason,) = kilter.verify(assembly, with_second_order(proof, forged)).reasons
        assert ("do not have the required form" in reason) == (force > 1e100)


@pytest.mark.parametrize(("mu", "verdict"), [(0.0, "unstable"), (0.5, "stable")])
def test_of_what_slides_or_only_friction_holds_nothing_is_proved(mu, verdict):
    """A block on a slope: the path along the slope leads down, but it is not balanced."""
    floor = Part("floor", Box([20, 20, 1]), Pose([0, 0, -0.5]), grounded=True)
    parts = [floor, Part("block", Box([1, 1, 1]), Pose([0, 0, 0.5]))]
    assembly = Assembly(parts, friction=mu).with_down([0.2, 0, -0.98])
    proof = kilter.check(assembly).proof()
    assert proof["verdict"] == verdict
    radius = float(assembly.geometry.radius[1])
    level, down = radius * np.eye(6)[1], 0.1 * radius * np.eye(6)[0]
    path = {"first": level, "second": down, "configuration": 0.01 * level + 0.00005 * down}
    forged = {"state": "balanced"} | {key: {"block": one.tolist()} for key, one in path.items()}
    found = kilter.verify(assembly, with_second_order(proof, forged))
    assert found.reasons == ("its second order needs a proof by forces without friction",)
