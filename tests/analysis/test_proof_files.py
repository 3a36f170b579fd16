"""Changed proofs are refused, up to the tolerance of each number."""

import copy
import json
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import stranger
from builders import falling_pair, given, hanging_pair, pressed_box, rough_staircase, toppled_box
from judged import judged, reloaded, verified

import kilter
from kilter import Assembly, Bond, Box, InputError, Joint, Part, Pose
from kilter.analysis.decision.judge import judge
from kilter.analysis.verification import verify_proof
from kilter.contact import detect
from kilter.mechanics.mechanics_tolerances import AGREES, POWER_ROUNDING
from kilter.mechanics.program import build_program
from kilter.mechanics.proof import digest_of, make_proof
from kilter.mechanics.rows import JOINT
from kilter.scenes import paper, stacks
from kilter.scenes.pieces import moved

CASES = {
    "forces": rough_staircase,
    "forces-planar": lambda: paper.figure_9(planar=True),
    "forces-tilted": lambda: paper.trapped_wedge(10.0, planar=False),
    "forces-loads": pressed_box,
    "forces-joints": hanging_pair,
    "forces-given": given,
    "motion": paper.figure_8,
    "motion-planar": lambda: paper.figure_8(planar=True),
    "motion-loads": toppled_box,
    "motion-joints": falling_pair,
    "motion-slope": lambda: stacks.block_on_slope(20.0, azimuth=30.0),
}
UNREAD = {"options", "tolerance", "kilter_proof"}
"""Entries that a changed number turns into a question about another set of contacts."""


@pytest.fixture(scope="module", params=CASES)
def proven(request):
    assembly = CASES[request.param]()
    verdict = judged(assembly)
    assert verdict.verdict == ("stable" if "forces" in request.param else "unstable")
    copy_ = reloaded(assembly)
    return copy_, detect.contacts(copy_), json.loads(json.dumps(verdict.proof()))


def numbers(value, path=()):
    """Paths of all numbers of JSON data."""
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from numbers(inner, (*path, key))
    elif isinstance(value, list):
        for key, inner in enumerate(value):
            yield from numbers(inner, (*path, key))
    elif isinstance(value, int | float) and not isinstance(value, bool):
        yield path


def chosen(proof, count):
    """Paths of numbers: all, or the first and the last of each kind of entry."""
    paths = list(numbers(proof))
    if count == "all":
        return paths
    kinds = {}
    for path in paths:
        kinds.setdefault(tuple(key for key in path if isinstance(key, str)), []).append(path)
    return [path for kind in kinds.values() for path in {kind[0], kind[-1]}]


COUNTS = pytest.mark.parametrize("count", ["few", pytest.param("all", marks=pytest.mark.slow)])


def changed(proof, path, *, fit):
    """A proof with a number changed by a thousandth, with or without a fitting digest."""
    other = copy.deepcopy(proof)
    place = other
    for key in path[:-1]:
        place = place[key]
    old = place[path[-1]]
    place[path[-1]] = old * (1 + 1e-3) if abs(old) > 1e-6 else old + 1e-3
    if fit:
        other["digest"] = digest_of(other)
    return other


def test_proof_has_every_kind_of_number(proven):
    _, _, proof = proven
    kinds = {path[0] for path in numbers(proof)}
    assert {"gravity", "down", "parts", "points", "certificate", "tolerance"} <= kinds
    assert ("forces" in kinds) != ("motion" in kinds)


@pytest.mark.quick(5)
@COUNTS
def test_changed_number_is_refused_by_the_mechanics(proven, count):
    assembly, contacts, proof = proven
    accepted = []
    for path in chosen(proof, count):
        if path[0] in UNREAD:
            continue
        other = changed(proof, path, fit=True)
        if verify_proof(assembly, contacts, other).holds and not _another_proof(proof, other, path):
            accepted.append(path)
    assert accepted == []


def _another_proof(proof, other, path):
    """Whether a changed proof proves as much, for a stranger: a motion of the power it claims.

    A part that moves on, without work, opens its contacts: that motion proves as much. So does
    any that slides and turns parts on level faces, of what stands on such faces alone.
    """
    if path[:2] == ("second_order", "motion") and "level" in proof["second_order"]:
        return not np.array(list(other["second_order"]["motion"].values()))[:, 2:5].any()
    if path[0] == "parts":  # the ground carries a held part, so that its mass counts nowhere
        return proof["parts"][path[1]]["grounded"] and path[2] in ("mass", "center")
    if path[0] != "motion":
        return False
    if np.linalg.matrix_rank([rays(proof), rays(other)], tol=1e-9) == 1:
        return True
    opening, power = stranger.opening_and_power(other)
    # powers are those of motions whose fastest part moves by 1: here it is not the changed one
    claimed = proof["certificate"]["power"]
    return opening >= -1e-12 and power == pytest.approx(claimed, rel=1e-8)


def rays(proof):
    """All components of a motion, as one unit vector."""
    motion = np.concatenate(list(proof["motion"].values()))
    return motion / np.linalg.norm(motion)


FLIPS = {
    "planar": lambda p: p.update(planar=not p["planar"]),
    "units": lambda p: p.update(units="mm"),
    "verdict": lambda p: p.update(verdict="stable" if "motion" in p else "unstable"),
    "grounded": lambda p: p["parts"][0].update(grounded=False),
    "held": lambda p: p["parts"][-1].update(grounded=True),
    "part-name": lambda p: p["parts"][-1].update(name="another"),
    "point-parts": lambda p: p["points"][0]["parts"].reverse(),
    "point-lost": lambda p: p["points"].pop(),
    "point-twice": lambda p: p["points"].append(p["points"][0]),
    "load-added": lambda p: p["loads"].append(
        {"part": p["parts"][-1]["name"], "point": None, "force": [1, 0, 0], "torque": [0, 0, 0]}
    ),
    "joint-added": lambda p: p["joints"].append(
        {"parts": ["ground", p["parts"][-1]["name"]], "kind": "fixed", "point": [0, 0, 0],
         "axis": None, "wrench": [0] * 6}
    ),
}  # fmt: skip


@pytest.mark.parametrize("flip", FLIPS)
def test_changed_word_is_refused_although_the_digest_fits(proven, flip):
    assembly, contacts, proof = proven
    other = copy.deepcopy(proof)
    FLIPS[flip](other)
    other["digest"] = digest_of(other)
    assert not verify_proof(assembly, contacts, other).holds


def test_proof_of_another_assembly_is_refused():
    for one, other in ((paper.figure_8(60), paper.figure_8(61)), (given(), rough_staircase())):
        assert not verified(other, judged(one).proof()).holds


@pytest.mark.parametrize("damage", ["parts", "points", "gravity", "certificate", "tolerance"])
def test_proof_with_a_key_missing_is_refused_in_words(damage):
    assembly = paper.figure_8()
    proof = judged(assembly).proof()
    del proof[damage]
    proof["digest"] = digest_of(proof)
    with pytest.raises(InputError, match="make it anew"):
        verified(assembly, proof)


def test_proof_with_numbers_that_are_none_is_refused():
    assembly = paper.figure_8()
    proof = judged(assembly).proof()
    proof["motion"]["C2"][0] = float("nan")
    with pytest.raises(InputError, match="cannot be read"):
        verified(assembly, proof)


def test_verdict_and_proof_do_not_depend_on_the_run():
    for build in (paper.figure_8, rough_staircase):
        assert judged(build()).proof() == judged(build()).proof()


@pytest.mark.parametrize(("verb", "more"), [("check", {}), ("margin", {"pushes": True})])
def test_a_proof_in_python_lists_the_options_with_which_the_file_was_read(
    tmp_path, monkeypatch, verb, more
):
    monkeypatch.chdir(tmp_path)
    cubes = [Part(name, Box(1, 1, 1), [0, 0, z]) for name, z in (("a", 0), ("b", 1))]
    kilter.dump(Assembly(cubes), "shelf.json")
    answer = getattr(kilter, verb)("shelf.json", floor=True, **more)
    proof = answer.proof()
    assert kilter.verify("shelf.json", proof).holds
    assert kilter.verify(answer.assembly, proof).holds
    loaded = kilter.load("shelf.json", ground="a")
    assert kilter.verify("shelf.json", kilter.check(loaded).proof()).holds


Proof = dict[str, Any]
G = 9.81


def proof_of(assembly: Assembly, **options: Any) -> Proof:
    found: Proof = json.loads(json.dumps(kilter.check(assembly, **options).proof()))
    return found


def reasons(assembly: Assembly, proof: Proof, change: Callable[[Proof], object]) -> tuple[str, ...]:
    other = copy.deepcopy(proof)
    change(other)
    other["digest"] = digest_of(other)
    return kilter.verify(assembly, other).reasons


def door(kind: Any, axis: list[float], aside: float) -> Assembly:
    """A door that a joint bears, far from the origin, its weight beside the joint."""
    parts = [
        Part("frame", Box([0.1, 0.1, 0.2]), Pose([7, 3, 0]), grounded=True),
        Part("door", Box([0.5, 0.025, 1.0]), Pose([7.7, 3.1 + aside, 0.2])),
    ]
    joint = Joint(("frame", "door"), kind, point=[7.15, 3.0, 0.1], axis=axis)
    return Assembly(parts, joints=[joint])


@pytest.mark.parametrize(("off", "refused"), [(0.9, False), (1.1, True)])
@pytest.mark.parametrize("kind", ["revolute", "spherical"])
def test_a_joint_that_bears_nothing_bears_the_rounding_of_a_weights_rounding(kind, off, refused):
    """Two blocks stand on a floor, a heavy and a light one: nothing goes through their joint."""
    parts = [
        Part("floor", Box([9, 9, 1]), Pose([0, 0, -0.5]), grounded=True),
        Part("heavy", Box([1, 2, 1]), Pose([-2, 0, 0.5]), mass=50.0),
        Part("light", Box([0.5, 0.5, 0.5]), Pose([2, 0, 0.25]), mass=3.0),
    ]
    axis = None if kind == "spherical" else [0, 0, 1]
    joint = Joint(("heavy", "light"), kind, point=[0.5, 0, 0.25], axis=axis)
    assembly = Assembly(parts, joints=[joint])
    proof = proof_of(assembly)
    program = build_program(assembly, kilter.contacts(assembly))
    turning = program.angular & (program.kind == JOINT)
    size = 3.0 * G * (float(program.arm[turning].max(initial=0.0)) or float(program.radius.min()))

    def carried(other: Proof) -> None:
        other["joints"][0]["wrench"] = [0.0] * 5 + [off * AGREES**2 * size]

    beyond = f"the {kind} joint of 'heavy' and 'light' has a load that its kind cannot carry"
    assert (beyond in reasons(assembly, proof, carried)) == refused


@pytest.mark.parametrize(("off", "refused"), [(0.98, False), (1.02, True)])
@pytest.mark.parametrize("aside", [0.0, 2.0])
@pytest.mark.parametrize(
    ("kind", "axis", "place"), [("revolute", [0, 0, 1], 5), ("prismatic", [0, 1, 0], 1)]
)
def test_what_a_joint_cannot_carry_it_carries_to_rounding_only(
    kind, axis, place, aside, off, refused
):
    assembly = door(kind, axis, aside)
    proof = proof_of(assembly)
    wrench = np.array(proof["joints"][0]["wrench"])
    program = build_program(assembly, kilter.contacts(assembly))
    length = float(program.radius[1])  # of the one free part
    force, torque = np.abs(wrench[:3]).max(), np.abs(wrench[3:]).max()
    assert min(force, torque) > 1.0
    about, at = np.array(proof["joints"][0]["point"]), program.point[program.kind == JOINT][0]
    reach = length + float(np.linalg.norm(about - at))
    size = reach * force + torque if place > 2 else force + torque / length

    def change(other: Proof) -> None:
        other["joints"][0]["wrench"][place] += off * AGREES * size

    beyond = f"the {kind} joint of 'frame' and 'door' has a load that its kind cannot carry"
    assert (beyond in reasons(assembly, proof, change)) == refused


@pytest.mark.parametrize(
    ("factor", "refused"), [(0.5, True), (1 + 0.5 * AGREES, False), (1 + 1.5 * AGREES, True)]
)
def test_the_fastest_part_of_a_motion_moves_by_one(factor, refused):
    assembly = paper.figure_8()

    def change(proof: Proof) -> None:
        for six in proof["motion"].values():
            six[:] = [factor * x for x in six]

    found = reasons(assembly, proof_of(assembly), change)
    assert ("its fastest part does not move by 1" in found) == refused


@pytest.mark.parametrize(("off", "refused"), [(0.5, False), (2.0, True)])
def test_near_a_limit_the_power_agrees_to_the_rounding_of_its_terms(off, refused):
    """A rod on its hinge, its centre a millionth beside it, with gravity along no axis."""
    rod = Part("rod", Box([0.1, 0.1, 1.0]), Pose([1e-6, 0, 0.5]))
    frame = Part("frame", Box([0.1, 0.1, 0.1]), Pose([0, 5, 0]), grounded=True)
    hinge = Joint(("frame", "rod"), "revolute", point=[0, 0, 0], axis=[0, 1, 0])
    upright = Assembly([frame, rod], joints=[hinge])
    turn = np.array([0.8, 0.1, 0.5, -0.3]) / np.linalg.norm([0.8, 0.1, 0.5, -0.3])
    assembly = moved(upright, turn, np.zeros(3))
    proof = proof_of(assembly)
    program = build_program(assembly, kilter.contacts(assembly))
    terms = float(np.abs(program.load[1] * np.array(proof["motion"]["rod"])).sum())
    assert terms > 1e3 * proof["certificate"]["power"]
    claimed = proof["certificate"]["power"]
    most = AGREES * claimed + POWER_ROUNDING * terms

    def change(other: Proof) -> None:
        other["certificate"]["power"] += off * most

    found = reasons(assembly, proof, change)
    assert any(reason.startswith("its power is") for reason in found) == refused


def mixed(degrees: float) -> Assembly:
    """A glued pair beside a rough one, on a slope."""
    parts = []
    for k, name in enumerate(("glued", "rough")):
        low = Part(f"{name}-low", Box([1, 1, 1]), Pose([3.0 * k, 0, 0]), grounded=True)
        high = Part(f"{name}-high", Box([1, 1, 0.01]), Pose([3.0 * k, 0, 0.505]))
        parts += [low, high]
    glue = Bond(("glued-low", "glued-high"), pull=100.0, shear=1e5)
    turn = np.radians(degrees)
    gravity = [G * np.sin(turn), 0, -G * np.cos(turn)]
    return Assembly(parts, friction=0.5, gravity=gravity, bonds=[glue])


def test_a_pull_beyond_a_bond_beside_contacts_without_one():
    def change(proof: Proof) -> None:
        for force in proof["forces"]:
            force[2] = 200.0 * np.sign(force[2]) * -1.0

    assembly = mixed(0.0)
    assert "a force pulls more than its bond" in reasons(assembly, proof_of(assembly), change)


def test_friction_beyond_its_cone_beside_a_bond():
    def change(proof: Proof) -> None:
        for force in proof["forces"]:
            force[1] += 1e3

    assembly = mixed(10.0)
    found = reasons(assembly, proof_of(assembly), change)
    assert "a force leaves its cone: its friction exceeds mu times its normal force" in found


def test_a_motion_that_an_open_pair_may_hold_proves_nothing():
    """A beam tips over the edge of one pillar, a hair above another."""
    parts = [
        Part("pillar", Box([1, 1, 1]), Pose([-0.5, 0, -0.5]), grounded=True),
        Part("lower", Box([0.2, 1, 1]), Pose([0.7, 0, -0.5 - 1.2e-3]), grounded=True),
        Part("beam", Box([1.3, 1, 0.1]), Pose([0.35, 0, 0.05])),
    ]
    assembly = Assembly(parts)
    contacts = kilter.contacts(assembly, tolerance=kilter.Tolerance(gap=1e-3))
    verdict = kilter.check(assembly, contacts=contacts)
    assert verdict.verdict == "undecided"
    program = build_program(assembly, contacts)
    found = judge(program)
    assert found.stable is False
    proof = json.loads(json.dumps(make_proof(assembly, contacts, program, found.motion, {})))
    assert any("that proves nothing" in reason for reason in kilter.verify(assembly, proof).reasons)
