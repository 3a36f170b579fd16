"""Proofs of second order in proof files hold, and every changed number is rejected."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
import pytest
from balance_cases import CASES

import kilter
from kilter import Assembly, Box, Cylinder, Joint, Part, Pose, Sphere
from kilter.mechanics.proof import digest_of
from kilter.scenes import scene
from kilter.second_order.proofs.fall_proof import STEPS

Place = tuple[str | int, ...]


def numbers(data: Any, place: Place = ()) -> list[Place]:
    """The places of all numbers of a proof."""
    if isinstance(data, dict):
        return [one for key, value in data.items() for one in numbers(value, (*place, key))]
    if isinstance(data, list):
        return [one for k, value in enumerate(data) for one in numbers(value, (*place, k))]
    return [place] if isinstance(data, float | int) and not isinstance(data, bool) else []


def changed(proof: dict[str, Any], place: Place, by: float) -> dict[str, Any]:
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


@pytest.mark.quick(2)
@pytest.mark.parametrize("number", ["03", "26", "38"])
def test_a_changed_number_of_a_minimum_is_refused(number: str) -> None:
    assembly, proof = proof_of(number)
    for place in numbers(proof["second_order"]):
        assert not kilter.verify(assembly, changed(proof, place, 0.37)).holds, place


@pytest.mark.parametrize("name", ["paper-figure-1-in-space", "paper-figure-12-in-space"])
def test_the_paths_of_the_papers_figures_are_judged_again(name: str) -> None:
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
def test_a_small_ball_in_a_hollow_beside_large_blocks_is_not_balanced() -> None:
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


def test_a_configuration_is_a_place_on_its_path_and_near_by() -> None:
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


def test_a_proof_without_its_parts_is_refused() -> None:
    assembly, proof = proof_of("26")
    for key in proof["second_order"]:
        short = copy.deepcopy(proof)
        del short["second_order"][key]
        short["digest"] = digest_of(short)
        assert not kilter.verify(assembly, short).holds, key


@pytest.mark.parametrize("word", ["nan", "inf", "1.0", True, None])
def test_words_in_the_place_of_numbers_make_no_ball_on_a_ball_a_minimum(word: Any) -> None:
    """Two motions are neutral beside the spins: cones with two sides each, and no valid weights."""
    assembly, proof = proof_of("02")
    bowl = proof_of("03")[1]["second_order"]
    one = [[word, word], [word, word]]
    forged = bowl | {"splits": [None, None], "weights": [one, one], "forces": bowl["forces"] * 2}
    assert not kilter.verify(assembly, with_second_order(proof, forged)).holds


def test_a_lift_by_next_to_nothing_makes_no_ball_in_a_bowl_balanced() -> None:
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
def test_forces_so_large_that_their_torques_are_no_numbers_balance_nothing(kind: str) -> None:
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
def test_of_what_slides_or_only_friction_holds_nothing_is_proved(mu: float, verdict: str) -> None:
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
