"""Files of several proofs, by hand: common data, changes, and subjects of proofs."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
import pytest

import kilter
from kilter import Assembly, Bond, InputError, Load, Support
from kilter.mechanics.bundle import (
    apply_change,
    is_bundle,
    make_bundle,
    split_bundle,
    subject_mismatch,
)
from kilter.mechanics.mechanics_tolerances import FOLLOWS
from kilter.mechanics.proof import digest_of
from kilter.scenes.pieces import block, floor

DOWN = (0.0, 0.0, -1.0)


def pile() -> Assembly:
    """Two glued blocks on a floor, with a load."""
    low, high = block("low", [0, 0, 0], [1, 1, 1]), block("high", [0, 0, 1], [1, 1, 2])
    parts = [floor([-2, -2], [3, 3]), low, high]
    loads = [Load("high", force=[0.1, 0, 0])]
    return Assembly(parts, friction=0.5, loads=loads, bonds=[Bond(("low", "high"), pull=4.0)])


def proof_of(assembly: Assembly) -> dict[str, Any]:
    return dict(kilter.check(assembly).proof())


def test_a_file_says_once_what_all_its_proofs_say() -> None:
    proof = proof_of(pile())
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


def test_what_is_a_file_of_several_proofs() -> None:
    assert is_bundle({"kilter_proofs": 1})
    assert not is_bundle({"kilter_proof": 1})
    assert not is_bundle(["kilter_proofs"])


def test_each_proof_of_a_file_is_the_one_that_was_put_in() -> None:
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


def test_nothing_changed_is_the_same() -> None:
    made = pile()
    contacts = kilter.contacts(made)
    assert apply_change(made, contacts, {}) == (made, contacts)
    nothing = dict.fromkeys(("down", "mu", "loads", "strength", "supports"))
    assert apply_change(made, contacts, {**nothing, "without": [], "held": []}) == (made, contacts)


def test_each_change_changes_its_own() -> None:
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


def test_a_share_of_their_strength_is_that_of_every_bond_and_of_the_contacts() -> None:
    made = pile()
    contacts = kilter.contacts(made)
    weak, among = apply_change(made, contacts, {"strength": 0.5})
    assert [bond.pull for bond in weak.bonds] == [2.0]
    assert np.array_equal(among.patch_pull, contacts.patch_pull / 2, equal_nan=True)
    assert np.nanmax(contacts.patch_pull) > 0
    none, _ = apply_change(made, contacts, {"strength": 0})
    assert [bond.pull for bond in none.bonds] == [0.0]


def test_parts_are_left_out_or_held() -> None:
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


def test_supports_stand_for_the_outside() -> None:
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
def test_forces_are_along_the_ray_or_along_the_line_of_either_sense(
    subject: str, sign: int
) -> None:
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


def test_a_motion_gains_power_beyond_its_own_facet() -> None:
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


def test_a_motion_is_one_of_every_free_part() -> None:
    for about in ("facet", "tilt"):
        why = subject_mismatch({"about": about, "vector": [0, 0, 1]}, falling((0, 0, -1)))
        assert why == "its motion leaves 'b' out"
