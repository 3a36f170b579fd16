"""The share of their strength that bonds need: closed forms, bounds on both sides, the command."""

from __future__ import annotations

import json
from itertools import pairwise

import pytest
from test_closed_forms import WEIGHT, cantilever, cube, hung

import kilter
from kilter import Assembly, Bond
from kilter.analysis.decision.bond_factor import find_bond_factor, unbreakable
from kilter.analysis.decision.judge import judge
from kilter.analysis.load_limit import NoLimit
from kilter.cli import main
from kilter.contact import contacts
from kilter.mechanics.program import build_program


@pytest.mark.quick(1)
@pytest.mark.parametrize("strength", [0.4, 1.0, 40.0])
@pytest.mark.parametrize("count", [1, 3])
def test_the_root_of_a_cantilever_needs_its_moment_and_gives_way_first(count, strength):
    """The moment N W n / 2 is borne by two points at height 1; the verdict at each strength."""
    needed = WEIGHT * count**2 / 4
    assembly = cantilever(count, strength * needed)
    margin = kilter.margin(assembly, pushed=[])
    assert margin.bond == pytest.approx(1 / strength, rel=1e-8)
    [first] = margin.bond_limit.opens
    assert first.parts == assembly.bonds[0].parts
    assert first.share == pytest.approx(1.0)
    proof = json.loads(json.dumps(margin.proof()))
    assert {p["held"] for p in proof["proofs"] if p["about"] == "bond"} == {True, False}
    assert kilter.verify(assembly, proof).holds
    for one in proof["proofs"]:
        one["change"] = {"strength": 0.99 * one["value"]} if one["held"] else one["change"]
    assert not kilter.verify(assembly, proof).holds


@pytest.mark.quick(1, "1000000000.0")
@pytest.mark.parametrize("strength", [1e3, 1e6, 1e9])
def test_a_bond_far_stronger_than_needed_is_needed_still(strength):
    assembly = hung(strength * WEIGHT / 4)
    margin = kilter.margin(assembly, pushed=[])
    assert margin.bond == pytest.approx(1 / strength, rel=1e-7)
    assert [bond.share for bond in margin.bond_limit.opens] == [pytest.approx(1.0)]
    assert kilter.verify(assembly, json.loads(json.dumps(margin.proof()))).holds


@pytest.mark.slow
def test_bonds_that_nothing_needs_are_null_and_those_that_never_suffice_are_said():
    stands = Assembly(
        [cube("top", z=1.0), cube("low", grounded=True)], bonds=[Bond(("low", "top"), pull=1.0)]
    )
    answer = kilter.margin(stands).to_dict()
    assert answer["bond"] is None
    assert answer["missing"] == {}
    slides = hung(WEIGHT, shear="mu")
    slides = Assembly(slides.parts, gravity=[9.81, 0, 0], bonds=slides.bonds)
    answer = kilter.margin(slides, pushed=[]).to_dict()
    assert answer["bond"] is None
    assert answer["missing"]["bond"] == "none"


@pytest.mark.parametrize(("mu", "holds"), [(0.0, False), (1e-3, True)])
def test_bonds_that_never_break_hold_what_some_strength_holds(mu, holds):
    """A cube hung sideways: any friction suffices if the bond is strong enough."""
    bond = Bond(("low", "top"), pull=WEIGHT, shear="mu")
    aside = Assembly(hung(WEIGHT).parts, gravity=[9.81, 0, 0], friction=mu, bonds=[bond])
    contacts = kilter.contacts(aside)
    program = build_program(aside, contacts)
    assert judge(unbreakable(program)).stable is holds
    found = find_bond_factor(program, contacts)
    assert isinstance(found, NoLimit) is not holds
    if holds:
        assert found.value == pytest.approx(1 / (4 * mu), rel=1e-6)


@pytest.mark.slow
def test_a_bond_on_the_command_line_is_kept_in_the_proof(tmp_path, capsys, monkeypatch):
    """An arm beside a post: 200 N at .5, borne by two points at height 1 with 50 N each."""
    monkeypatch.chdir(tmp_path)
    parts = [cube("post", grounded=True), cube("arm-1", x=1.0, mass=200.0 / 9.81)]
    kilter.dump(Assembly(parts), "a.kilter.json")
    for pull, code in ((49.9, 1), (50.1, 0)):
        words = ["a.kilter.json", "--bond", "arm*", "post", str(pull)]
        assert main(["check", *words, "--proof", f"{pull}.json", "--quiet"]) == code
        assert main(["verify", "a.kilter.json", f"{pull}.json"]) == 0
    capsys.readouterr()
    assert main(["margin", *words]) == 0
    assert "times their strength is needed; arm-1 on post fails first" in capsys.readouterr().out
    for wrong, why in (
        (["--bond", "arm*", "post"], "--bond needs NAME NAME T"),
        (["--bond", "arm*", "post", "much"], "write --bond NAME NAME T"),
        (["--bond", "arm*", "pst", "1"], "did you mean 'post'"),
    ):
        assert main(["check", "a.kilter.json", *wrong]) == 2
        assert why in capsys.readouterr().err


@pytest.mark.quick(2)
@pytest.mark.parametrize("share", [0.5, 0.05, 0.005, 0.0005])
def test_a_small_share_is_told_as_near_as_a_large_one(share):
    cubes = [cube("wall", grounded=True), *[cube(f"c{k}", x=k) for k in range(1, 40)]]
    strength = (len(cubes) - 1) ** 2 * WEIGHT / 4 / share
    bonds = [Bond((a.name, b.name), pull=strength) for a, b in pairwise(cubes)]
    assembly = Assembly(cubes, bonds=bonds)
    touching = contacts(assembly)
    found = find_bond_factor(build_program(assembly, touching), touching)
    assert found.value == pytest.approx(share, rel=1e-6)
    assert found.limit.gap <= 1e-4 * share
