"""The form of proofs, files of several, and what proofs say."""

import copy
import json
import math
import warnings
from collections.abc import Callable, Iterator
from functools import cache
from typing import Any

import numpy as np
import pytest

import kilter
from kilter import Assembly, Bond, Box, InputError, Joint, Load, Part, Pose, Support, example
from kilter.analysis.verification import verify_bundle
from kilter.mechanics.bundle import (
    apply_change,
    is_bundle,
    make_bundle,
    split_bundle,
    subject_mismatch,
)
from kilter.mechanics.certificate import ForceProof, MotionProof
from kilter.mechanics.mechanics_tolerances import FOLLOWS
from kilter.mechanics.program import build_program
from kilter.mechanics.proof import Evidence, _verdict_word, digest_of, make_proof
from kilter.mechanics.proof_form import require_bundle_form, require_form
from kilter.scenes.pieces import block, floor
from kilter.validate import LARGEST


@cache
def proof_of(name: str) -> str:
    return json.dumps(kilter.check(example(name)).proof())


def forces() -> dict[str, Any]:
    found: dict[str, Any] = json.loads(proof_of("tower"))
    return found


def motion() -> dict[str, Any]:
    found: dict[str, Any] = json.loads(proof_of("paper-figure-8"))
    return found


@cache
def region() -> str:
    return json.dumps(kilter.region(example("tower")).proof())


def test_whole_ones_are_taken():
    for one in (forces(), motion()):
        require_form(one)
    require_bundle_form(json.loads(region()))


@pytest.mark.parametrize(
    ("change", "place"),
    [
        ({"motion": []}, "motion is"),
        ({"motion": {"C2": [1.0]}}, "motion.C2 is"),
        ({"motion": {"C2": ["a", 0, 0, 0, 0, 0]}}, r"motion.C2\[0\] is 'a'"),
        ({"gravity": [0.0, 0.0, 2 * LARGEST]}, r"gravity\[2\] is"),
        ({"planar": 1}, "planar is 1"),
        ({"verdict": None}, "verdict is None"),
        ({"units": True}, "units is True"),
    ],
)
def test_the_place_is_named(change, place):
    with pytest.raises(InputError, match=place):
        require_form({**motion(), **change})


def test_a_number_may_be_as_large_as_numbers_may():
    require_form({**motion(), "gravity": [0.0, 0.0, -LARGEST]})


@pytest.mark.parametrize("value", [math.nan, math.inf, {1}])
def test_a_key_that_nobody_reads_is_json_too(value):
    with pytest.raises(InputError, match="it is no JSON"):
        require_form({**forces(), "note": value})
    with pytest.raises(InputError, match="it is no JSON"):
        require_bundle_form({**json.loads(region()), "note": value})
    require_form({**forces(), "note": "x"})


def test_what_friction_says_has_a_form_too():
    for damaged in ({}, {"guarantee": 1}):
        with pytest.raises(InputError, match=r"friction\.guarantee is"):
            require_form({**forces(), "friction": damaged})
    require_form({**forces(), "friction": None})


@pytest.mark.parametrize("bundle", [[], "x", None, {}, {"kilter_proofs": 2}])
def test_another_format_of_several_proofs_is_refused(bundle):
    for asked in (bundle, {**json.loads(region()), "kilter_proofs": 2}):
        with pytest.raises(InputError, match="no file of kilter proofs of format 1"):
            require_bundle_form(asked)


def test_no_proof_at_all_is_no_file_of_proofs() -> None:
    none = {**json.loads(region()), "proofs": []}
    with pytest.raises(InputError, match="it has no proofs"):
        require_bundle_form(none)
    with pytest.raises(InputError, match="it has no proofs"):
        kilter.verify(example("tower"), none)


@pytest.mark.parametrize("proof", [[], "x", None, {}, {"kilter_proof": 2}])
def test_another_format_is_refused(proof):
    for asked in (proof, {**forces(), "kilter_proof": 2}):
        with pytest.raises(InputError, match="no kilter proof of format 1"):
            require_form(asked)


Path = tuple[Any, ...]

LEFT_OUT = object()
OTHER = (LEFT_OUT, None, "x", [], {}, [[1]], ["x", 3], -1, 0, 10**400, 1e308, True)

"""Parts that are put in the place of others."""
FEW, MANY = 25, 400
"""Exchanges that are tried of each file: always, and with the slow tests."""
MAKERS: dict[str, Callable[[Any], Any]] = {
    "plan": kilter.plan,
    "no plan": lambda assembly: kilter.plan(assembly, kilter.PlanRules(hold=0)),
    "hold": kilter.hold,
    "region": kilter.region,
    "margin": lambda assembly: kilter.margin(assembly, push=[1, 0, 0]),
}


@cache
def made(kind: str) -> tuple[Any, Any, Any]:
    """An assembly, its contacts and the proofs of an answer about it, as a file has them."""
    assembly = example("tower" if kind == "margin" else "paper-figure-9")
    proof = json.loads(json.dumps(MAKERS[kind](assembly).proof()))
    contacts = kilter.contacts(assembly)
    assert verify_bundle(assembly, contacts, proof).holds
    return assembly, contacts, proof


def places(data: Any, at: Path = ()) -> Iterator[Path]:
    """Every place in a file; for the proofs themselves only their first level."""
    for key, value in data.items() if isinstance(data, dict) else enumerate(data):
        yield (*at, key)
        if isinstance(value, dict | list) and not (at[:1] == ("proofs",) and key == "proof"):
            yield from places(value, (*at, key))


def exchanged(proof: Any, place: Path, value: Any) -> Any:
    """The file with another value in a single place, with a new digest."""
    proof = copy.deepcopy(proof)
    inner = proof
    for key in place[:-1]:
        inner = inner[key]
    if value is LEFT_OUT:
        del inner[place[-1]]
    else:
        inner[place[-1]] = value
    return {**proof, "digest": digest_of(proof)}


def wrong(assembly: Any, contacts: Any, proof: Any) -> str:
    """Reasons against a file of proofs; empty if they hold."""
    try:
        return "; ".join(verify_bundle(assembly, contacts, proof).reasons)
    except InputError as error:
        return str(error)


@pytest.mark.quick("25-plan", "25-hold")
@pytest.mark.parametrize("kind", MAKERS)
@pytest.mark.parametrize("tried", [FEW, pytest.param(MANY, marks=pytest.mark.slow)])
@pytest.mark.slow
def test_whatever_is_exchanged_it_is_no_fault(kind, tried):
    assembly, contacts, proof = made(kind)
    every = list(places(proof))
    random = np.random.default_rng(11)
    refused = 0
    for _ in range(tried):
        place, value = every[random.integers(len(every))], OTHER[random.integers(len(OTHER))]
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            refused += bool(wrong(assembly, contacts, exchanged(proof, place, value)))
    assert refused > tried / 2


FORCES = ForceProof(np.zeros(0), np.zeros((0, 3)), 0.0, True)
MOTION = MotionProof(np.zeros((1, 6)), 1.0, 0.0, 1e9, True)


@pytest.mark.parametrize(
    ("certificate", "evidence", "verdict"),
    [
        (MOTION, None, "unstable"),
        (MOTION, Evidence("proved"), "unstable"),
        (FORCES, None, "stable"),
        (FORCES, Evidence("proved"), "stable"),
        (FORCES, Evidence("open"), "potentially-stable"),
        (FORCES, Evidence("open", settles=True), "settles"),
        (FORCES, Evidence("refuted", settles=True), "potentially-stable"),
    ],
)
def test_the_verdict_is_that_of_the_evidence(certificate, evidence, verdict):
    assert _verdict_word(certificate, evidence) == verdict


def test_what_is_undecided_has_none():
    assembly = example("tower")
    contacts = kilter.contacts(assembly)
    program = build_program(assembly, contacts)
    with pytest.raises(InputError, match="an undecided verdict has no proof to write"):
        make_proof(assembly, contacts, program, None, {})


def cube(name: str, z: float, *, grounded: bool = False) -> Part:
    return Part(name, Box([1, 1, 1]), Pose([0, 0, z]), grounded=grounded)


@pytest.mark.parametrize(
    ("shear", "said"),
    [(None, {"tied": True}), ("mu", {}), (7.0, {"shear": 7.0}), (0.0, {"shear": 0.0})],
)
def test_a_bond_is_said_at_each_of_its_points(shear, said):
    bond = Bond(("low", "top"), pull=9e3, shear=shear)
    assembly = Assembly([cube("top", 1.0, grounded=True), cube("low", 0.0)], bonds=[bond])
    proof = kilter.check(assembly).proof()
    told = [{k: p[k] for k in ("pull", "tied", "shear") if k in p} for p in proof["points"]]
    assert told == [{"pull": 9e3, **said}] * 4
    plain = kilter.check(example("tower")).proof()
    assert not {"pull", "tied", "shear"} & set(plain["points"][0])


def test_a_joint_of_held_parts_carries_nothing():
    parts = [cube("a", 0.0, grounded=True), cube("b", 1.0, grounded=True), cube("c", 2.0)]
    assembly = Assembly(parts, joints=[Joint(("a", "b"))])
    proof = json.loads(json.dumps(kilter.check(assembly).proof()))
    assert proof["joints"][0]["wrench"] == [0.0] * 6
    assert kilter.verify(assembly, proof).holds


DOWN = (0.0, 0.0, -1.0)


def pile() -> Assembly:
    """Two glued blocks on a floor, with a load."""
    low, high = block("low", [0, 0, 0], [1, 1, 1]), block("high", [0, 0, 1], [1, 1, 2])
    parts = [floor([-2, -2], [3, 3]), low, high]
    loads = [Load("high", force=[0.1, 0, 0])]
    return Assembly(parts, friction=0.5, loads=loads, bonds=[Bond(("low", "high"), pull=4.0)])


def proof_of_bundles(assembly: Assembly) -> dict[str, Any]:
    return dict(kilter.check(assembly).proof())


def test_a_file_says_once_what_all_its_proofs_say():
    proof = proof_of_bundles(pile())
    other = copy.deepcopy(proof)
    other["units"] = "mm" if proof["units"] != "mm" else "m"
    made = make_bundle("hold", [({"about": "a"}, proof), ({"about": "b"}, other)], rules={"r": 1})
    assert {key: made[key] for key in ("kind", "rules")} == {"kind": "hold", "rules": {"r": 1}}
    assert made["common"]["parts"] == proof["parts"]
    assert made["digest"] == digest_of({key: made[key] for key in made if key != "digest"})
    assert not set(made["proofs"][0]["proof"]) & set(made["common"])
    assert set(made["proofs"][1]["proof"]) & set(made["common"]) == {"units"}
    assert [entry["about"] for entry in made["proofs"]] == ["a", "b"]
    with pytest.raises(InputError, match="this hold has no proof to write"):
        make_bundle("hold", [])


def test_what_is_a_file_of_several_proofs():
    assert is_bundle({"kilter_proofs": 1})
    assert not is_bundle({"kilter_proof": 1})
    assert not is_bundle(["kilter_proofs"])


def test_each_proof_of_a_file_is_the_one_that_was_put_in():
    tower = kilter.scenes.example("tower")
    found = kilter.margin(tower, push=[1, 0, 0]).proof()
    every = list(split_bundle(found))
    assert len(every) == len(found["proofs"])
    for (about, proof), entry in zip(every, found["proofs"], strict=True):
        assert about == {key: entry[key] for key in entry if key != "proof"}
        assert proof == {**found["common"], **entry["proof"]}
    broken = copy.deepcopy(dict(found))
    broken["kind"] = 7
    with pytest.raises(InputError, match="kind is 7"):
        list(split_bundle(broken))
    broken = copy.deepcopy(dict(found))
    broken["proofs"][0]["proof"]["verdict"] = 7
    with pytest.raises(InputError, match="verdict is 7"):
        list(split_bundle(broken))


def test_nothing_changed_is_the_same():
    made = pile()
    contacts = kilter.contacts(made)
    assert apply_change(made, contacts, {}) == (made, contacts)
    nothing = dict.fromkeys(("down", "mu", "loads", "strength", "supports"))
    assert apply_change(made, contacts, {**nothing, "without": [], "held": []}) == (made, contacts)


def test_each_change_changes_its_own():
    made = pile()
    contacts = kilter.contacts(made)
    turned, _ = apply_change(made, contacts, {"down": [1, 0, 0]})
    assert np.array_equal(turned.down, [1, 0, 0])
    _, rough = apply_change(made, contacts, {"mu": 0})
    assert contacts.patch_mu.all()
    assert not rough.patch_mu.any()
    _, rough = apply_change(made, contacts, {"mu": 0.25})
    assert np.array_equal(rough.patch_mu, np.full(len(contacts.patch_mu), 0.25))
    assert len(apply_change(made, contacts, {"loads": []})[0].loads) == 0
    load = {"part": "high", "force": [0, 1, 0], "torque": [0, 0, 2], "point": None, "more": 1}
    (own,) = apply_change(made, contacts, {"loads": [load]})[0].loads
    assert own.part == "high"
    assert np.array_equal([own.force, own.torque], [[0, 1, 0], [0, 0, 2]])


def test_a_share_of_their_strength_is_that_of_every_bond_and_of_the_contacts():
    made = pile()
    contacts = kilter.contacts(made)
    weak, among = apply_change(made, contacts, {"strength": 0.5})
    assert [bond.pull for bond in weak.bonds] == [2.0]
    assert np.array_equal(among.patch_pull, contacts.patch_pull / 2, equal_nan=True)
    assert np.nanmax(contacts.patch_pull) > 0
    none, _ = apply_change(made, contacts, {"strength": 0})
    assert [bond.pull for bond in none.bonds] == [0.0]


def test_parts_are_left_out_or_held():
    made = pile()
    contacts = kilter.contacts(made)
    alone, among = apply_change(made, contacts, {"without": ["high"]})
    assert list(alone.names) == ["floor", "low"]
    assert 0 < len(among.patch_parts) < len(contacts.patch_parts)
    held, among = apply_change(made, contacts, {"held": ["low"]})
    assert [part.name for part in held if part.grounded] == ["floor", "low"]
    assert np.array_equal(among.patch_parts, contacts.patch_parts)
    both, among = apply_change(made, contacts, {"without": ["high"], "held": ["low"]})
    assert [(part.name, part.grounded) for part in both] == [("floor", True), ("low", True)]
    assert len(among.patch_parts) == 1


def test_supports_stand_for_the_outside():
    made = pile()
    contacts = kilter.contacts(made)
    prop = Support("prop", "high", [0.5, 0.5, 1]).to_dict()
    given, among = apply_change(made, contacts, {"supports": [prop], "held": ["low"]})
    assert len(given) == len(made) + 1
    assert [part.name for part in given if part.grounded][:2] == ["floor", "low"]
    given, among = apply_change(made, contacts, {"supports": [prop]})
    assert len(among.patch_parts) == len(contacts.patch_parts) + 1


def part(name: str, mass: float, *, grounded: bool = False) -> dict[str, Any]:
    return {"name": name, "mass": mass, "grounded": grounded}


@pytest.mark.parametrize(("subject", "sign"), [("ray", -1), ("line", -1), ("line", 1)])
def test_forces_are_along_the_ray_or_along_the_line_of_either_sense(subject, sign):
    about = {"about": subject, "vector": [0, 0, sign]}
    assert subject_mismatch(about, {"forces": [], "down": DOWN}) == ""
    for off, why in ((0.9, ""), (1.0, ""), (1.1, "its forces are for another direction")):
        proof = {"forces": [], "down": [off * FOLLOWS, 0, -1]}
        assert subject_mismatch(about, proof) == why
    assert subject_mismatch({"about": "ray"}, {"forces": [], "down": [1, 0, 0]}) == ""
    against = {"about": "ray", "vector": [0, 0, 1]}
    assert subject_mismatch(against, {"forces": [], "down": DOWN}) != ""


def falling(*steps: tuple[float, float, float]) -> dict[str, Any]:
    """Two parts of masses 1 and 3 beside a held part, each with its step."""
    names = ("a", "b")
    motion = {name: [*step, 9.0, 9.0, 9.0] for name, step in zip(names, steps, strict=False)}
    return {"parts": [part("f", 5.0, grounded=True), part("a", 1), part("b", 3)], "motion": motion}


def test_a_motion_gains_power_beyond_its_own_facet():
    facet = {"about": "facet", "vector": [0, 0, 1]}
    another = "its motion gains power beyond another facet"
    assert subject_mismatch(facet, falling((3, 0, -3), (-1, 0, -1))) == ""
    assert subject_mismatch(facet, falling((3, 0, -3), (-2, 0, -1))) == another
    assert subject_mismatch(facet, falling((0, 0, 3), (0, 0, 1))) == another
    assert subject_mismatch(facet, falling((0, 0, 0), (0, 0, 0))) == another
    assert subject_mismatch(facet, falling((0, 0, -0.1), (0, 0, -0.1))) == ""
    for off, why in ((0.9, ""), (1.0, ""), (1.1, another)):
        beside = {"about": "facet", "vector": [off * FOLLOWS, 0, 1]}
        assert subject_mismatch(beside, falling((0, 0, -1), (0, 0, -1))) == why
    assert (
        subject_mismatch({"about": "tilt", "vector": [0, 0, 1]}, falling((0, 0, 3), (0, 0, 1)))
        == ""
    )


def test_a_motion_is_one_of_every_free_part():
    for about in ("facet", "tilt"):
        why = subject_mismatch({"about": about, "vector": [0, 0, 1]}, falling((0, 0, -1)))
        assert why == "its motion leaves 'b' out"
