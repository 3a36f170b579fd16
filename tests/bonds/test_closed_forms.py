"""Bonds with closed forms, their needed share, and how they are shown."""

import copy
import itertools
import json
from itertools import pairwise

import numpy as np
import pytest
from judged import judged, random_turn

import kilter
from kilter import Assembly, Bond, Box, GivenContact, Part, Pose, contacts
from kilter.analysis.decision.bond_factor import find_bond_factor, unbreakable
from kilter.analysis.decision.judge import judge
from kilter.analysis.load_limit import NoLimit
from kilter.cli import main
from kilter.mechanics.program import build_program
from kilter.mechanics.proof import digest_of
from kilter.scenes.pieces import moved
from kilter.tell.tables import forces_table, tables

G, WEIGHT = 9.81, 9810.0
BOTH = pytest.mark.parametrize("share", [0.999, 1.001])


def cube(name, x=0.0, z=0.0, **more):
    return Part(name, Box([1, 1, 1]), Pose([x, 0, z]), **more)


def hung(pull, **more):
    """A cube of 1000 kg below a held cube, bonded at four points."""
    return Assembly(
        [cube("top", z=1.0, grounded=True), cube("low")],
        bonds=[Bond(("low", "top"), pull=pull, **more)],
    )


def cantilever(count, pull):
    """A row of bonded cubes beside a held cube."""
    parts = [cube("wall", grounded=True)] + [cube(f"c{k}", x=k) for k in range(1, count + 1)]
    pairs = itertools.pairwise(parts)
    return Assembly(parts, bonds=[Bond((a.name, b.name), pull=pull) for a, b in pairs])


def falls(share):
    return "unstable" if share < 1 else "stable"


@BOTH
@pytest.mark.parametrize("parts", [("low", "top"), ("top", "low")])
def test_a_cube_hangs_by_its_weight_over_its_points(share, parts):
    blocks = hung(1.0).parts
    assembly = Assembly(blocks, bonds=[Bond(parts, pull=share * WEIGHT / 4)])
    assert judged(assembly).verdict == falls(share)


@BOTH
@pytest.mark.parametrize("count", [1, 2, 5])
def test_a_cantilever_of_cubes_needs_the_moment_of_its_weight_at_the_upper_points(share, count):
    """Moment n W n / 2 about the lower edge of the root, borne by two points at height 1."""
    verdict = judged(cantilever(count, share * WEIGHT * count**2 / 4))
    assert verdict.verdict == falls(share)


@pytest.mark.quick(2)
@BOTH
@pytest.mark.parametrize("degrees", [0.0, 30.0, 90.0, 150.0])
def test_a_magnet_on_a_slope_slides_past_mu_times_what_presses_it(share, degrees):
    mu, turn = 0.4, np.radians(degrees)
    thin = Part("magnet", Box([1, 1, 0.01]), Pose([0, 0, 0.505]))
    weight = 10 * G
    needed = weight * max(np.sin(turn) / mu - np.cos(turn), -np.cos(turn))
    if needed <= 0:
        needed, share = weight, 2.0  # it is at rest without the bond
    magnet = Bond(("steel", "magnet"), pull=share * needed / 4, kind="magnet")
    slope = Assembly(
        [cube("steel", grounded=True), thin],
        friction=mu,
        gravity=[G * np.sin(turn), 0, -G * np.cos(turn)],
        bonds=[magnet],
    )
    assert (judged(slope, effort=0.1).verdict == "unstable") is (share < 1)


@pytest.mark.quick(2)
@BOTH
@pytest.mark.parametrize("mu", [0.2, 0.9])
def test_a_suction_cup_in_shear_bears_mu_times_its_suction(share, mu):
    """On a wall: W against mu p A, independently of the thickness of the cup."""
    cup = Part("cup", Box([0.01, 0.5, 0.4]), Pose([0.505, 0, 0]), mass=10.0)
    suction = Bond(("wall", "cup"), pull_per_area=share * 10 * G / (mu * 0.5 * 0.4), kind="suction")
    wall = Assembly([cube("wall", grounded=True), cup], friction=mu, bonds=[suction])
    assert (judged(wall, effort=0).verdict == "unstable") is (share < 1)


def test_shear_of_any_size_is_borne_where_none_is_said():
    wall = Assembly(
        [cube("wall", grounded=True), Part("shelf", Box([0.01, 1, 1]), Pose([0.505, 0, 0]))],
        bonds=[Bond(("wall", "shelf"), pull=WEIGHT)],
    )
    assert judged(wall).level == "proved"
    smooth = Assembly(wall.parts, bonds=[Bond(("wall", "shelf"), pull=WEIGHT, shear="mu")])
    assert judged(smooth).verdict == "unstable"


def test_points_of_a_bond_stand_for_themselves():
    """A cube hangs on a single bonded point: above its centre it is stable, beside it not."""
    for x, verdict in ((0.0, "stable"), (0.1, "unstable")):
        held = Bond(("low", "top"), pull=WEIGHT * 1.001, points=[[x, 0, 0.5]], normal=[0, 0, 1])
        parts = [cube("top", z=1.0, grounded=True), cube("low")]
        assembly = Assembly(parts, detect=False, bonds=[held])
        assert kilter.check(assembly).verdict == verdict
        assert kilter.contacts(assembly).patch_kind.tolist() == ["bond"]


def test_a_bond_of_no_strength_is_a_contact():
    given = GivenContact(("low", "top"), [[0, 0, 0.5]], [0, 0, 1])
    parts = [cube("top", z=1.0, grounded=True), cube("low")]
    for bonds in ([], [Bond(("low", "top"), pull=0.0)]):
        assert judged(Assembly(parts, contacts=[given], bonds=bonds)).verdict == "unstable"


def test_forces_are_shown_as_they_act_and_a_changed_bond_is_refused():
    assembly = hung(WEIGHT)
    verdict = kilter.check(assembly)
    assert verdict.sentence.startswith("Stable, if no bond breaks")
    proof = json.loads(json.dumps(verdict.proof()))
    total = np.sum(proof["forces"], axis=0)
    upper = [p["parts"][1] == "top" for p in proof["points"]]
    assert np.allclose(total * (1 if all(upper) else -1), [0, 0, -WEIGHT])
    assert kilter.verify(assembly, proof).holds
    assert not kilter.verify(hung(WEIGHT * 1.01), proof).holds
    assert not kilter.verify(hung(WEIGHT, kind="magnet"), proof).holds
    for key, value in (("pull", 1.01 * WEIGHT), ("tied", False)):
        changed = copy.deepcopy(proof)
        changed["points"][0][key] = value
        changed["digest"] = digest_of(changed)
        assert not kilter.verify(assembly, changed).holds
    harder = copy.deepcopy(proof)
    harder["forces"] = (np.array(proof["forces"]) * 8).tolist()
    harder["digest"] = digest_of(harder)
    assert any("pulls more" in why for why in kilter.verify(assembly, harder).reasons)


def test_what_asks_for_a_cone_of_directions_or_an_order_takes_no_bonds():
    assembly = hung(WEIGHT)
    for ask in (kilter.orient, kilter.region, kilter.plan, kilter.hold, kilter.states):
        with pytest.raises(kilter.InputError, match=r"does not support bonds, such as that of"):
            ask(assembly)


def test_bonds_are_written_and_read_back(tmp_path):
    points = [[0.0, 0.1, 0.5], [0.2, 0.0, 0.5]]
    made = Assembly(
        [cube("top", z=1.0, grounded=True), cube("low")],
        bonds=[
            Bond(("low", "top"), pull=0.1, shear=2.5, points=points, normal=[0, 0.6, 0.8]),
            Bond(("low", "top"), pull_per_area=1e5, kind="mortar"),
        ],
    )
    kilter.dump(made, tmp_path / "a.kilter.json")
    again = kilter.load(tmp_path / "a.kilter.json")
    for one, other in zip(made.bonds, again.bonds, strict=True):
        for name in Bond.__slots__:
            assert np.array_equal(getattr(one, name), getattr(other, name))


def test_wrong_bonds_are_one_sentence():
    apart = Assembly(
        [cube("top", z=2.0, grounded=True), cube("low")], bonds=[Bond(("low", "top"), pull=1.0)]
    )
    with pytest.raises(kilter.InputError, match="which do not touch"):
        kilter.check(apart)
    parts = [cube("top", z=1.0, grounded=True), cube("low")]
    twice = [Bond(("low", "top"), pull=1.0), Bond(("top", "low"), pull=2.0)]
    for wrong, why in (
        (lambda: Bond(("a", "b"), pull=-1.0), "pull of the bond"),
        (lambda: Bond(("a", "b"), pull=1.0, pull_per_area=1.0), "has both pull and pull_per_area"),
        (lambda: Bond(("a", "b"), pull=1.0, shear="my"), "shear of the bond"),
        (lambda: Bond(("a", "b"), pull=1.0, kind="morter"), "did you mean 'mortar'"),
        (lambda: Bond(("a", "b"), pull=1.0, points=[[0, 0, 0]]), "no normal"),
        (lambda: Bond(("a",), pull=1.0), "give a pair"),
        (lambda: Assembly(parts, bonds=twice), "two of them act at all contacts"),
        (lambda: Assembly(parts, bonds=[Bond(("low", "tip"), pull=1.0)]), "no part is named"),
    ):
        with pytest.raises(kilter.InputError, match=why):
            wrong()


def test_what_no_bond_holds_any_more_falls():
    """The bond bears at most half of the weight, and no point is pressed."""
    assert judged(hung(WEIGHT / 8, shear="mu")).verdict == "unstable"


def leaning(degrees, **bond):
    """A post of two cubes on a base, bonded at four points, with gravity at an angle."""
    turn = np.radians(degrees)
    parts = [
        Part("base", Box([3, 1, 1]), Pose([0, 0, -0.5]), grounded=True),
        Part("post", Box([1, 1, 2]), Pose([0, 0, 1])),
    ]
    down = [G * np.sin(turn), 0, -G * np.cos(turn)]
    return Assembly(parts, gravity=down, friction=3.0, bonds=[Bond(("base", "post"), **bond)])


def refused_once_turned(assembly):
    """Reasons for rejected proofs, for rotations of the assembly with different rounding."""
    random, why = np.random.default_rng(0), set()
    for _ in range(12):
        turned = moved(assembly, random_turn(random))
        verdict = kilter.check(turned, effort=0.1)
        assert verdict.verdict in ("stable", "settles")
        why |= set(kilter.verify(turned, json.loads(json.dumps(verdict.proof()))).reasons)
    return why


@pytest.mark.slow
def test_a_point_about_to_open_rubs_by_the_rest_of_larger_numbers():
    """At the limit W (2 sin a - cos a) / 4 per point, f_n + T is near 0 at the upper points."""
    turn = np.radians(60)
    pull = 2 * WEIGHT * (2 * np.sin(turn) - np.cos(turn)) / 4
    assert refused_once_turned(leaning(60, pull=(1 + 1e-7) * pull, shear="mu")) == set()
    assert kilter.check(leaning(60, pull=(1 - 1e-6) * pull, shear="mu")).verdict == "unstable"


def test_a_bond_that_bears_shear_alone_pulls_by_the_rounding_of_its_shear():
    assert refused_once_turned(leaning(26, pull=0.0)) == set()
    assert kilter.check(leaning(27, pull=0.0)).verdict == "unstable"  # tan a > 1 / 2


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


G_SHOWN = 9.81
WEIGHT_SHOWN = 1000 * G_SHOWN


def cube_shown(name, z=0.0, **more):
    return Part(name, Box([1, 1, 1]), Pose([0, 0, z]), **more)


def hung_shown(pull=WEIGHT_SHOWN, shift=0.0):
    """A cube below a held cube, displaced sideways by `shift`."""
    low = Part("low", Box([1, 1, 1]), Pose([shift, 0, 0]))
    return Assembly(
        [cube_shown("top", z=1.0, grounded=True), low], bonds=[Bond(("low", "top"), pull)]
    )


@pytest.mark.parametrize("shift", [0.0, 0.1])
def test_a_pull_acts_where_it_is_needed(shift):
    # at the shift d, the middle of the common face is at d / 2 and the weight at d
    found = kilter.check(hung_shown(shift=shift)).forces
    assert found.center[0][0] == pytest.approx(shift, abs=1e-6)
    assert found.center[0][2] == pytest.approx(0.5)
    assert abs(found.normal_force[0]) == pytest.approx(WEIGHT_SHOWN)
    most = 1 / 4 + (shift / 2) / (1 - shift) / 2  # half of W / 2 + moment / width
    assert found.bond_utilisation[0] == pytest.approx(most, abs=1e-6)


def test_the_table_of_forces_has_a_column_for_bonds_where_there_are_some():
    table = forces_table(kilter.check(hung_shown()).to_dict())
    assert table.head[-1] == "bond used"
    assert table.rows(9)[0][-1] == "25 %"
    assert "-" not in table.rows(9)[0][3:5]
    plain = forces_table(kilter.check(kilter.example("tower")).to_dict())
    assert plain.head[-1] == "friction needed"
    assert len(plain.rows(1)[0]) == len(plain.head)


def test_contacts_tell_what_their_bonds_hold():
    parts = [
        cube_shown("a", grounded=True),
        cube_shown("b", z=1.0),
        cube_shown("c", z=2.0),
        cube_shown("d", z=3.0),
    ]
    bonds = [Bond(("a", "b"), 5.0), Bond(("b", "c"), pull_per_area=7.0)]
    found = contacts(Assembly(parts, bonds=bonds))
    told = {tuple(patch["parts"]): patch["pull"] for patch in found.to_dict()["patches"]}
    assert told == {("a", "b"): 20.0, ("b", "c"): pytest.approx(7.0), ("c", "d"): None}
    [table] = [one for one in tables(found.to_dict()) if one.title == "Contact patches:"]
    assert table.head[-1] == "bond pulls up to"
    assert sorted(row[-1] for row in table.rows(9)) == ["-", "20 N", "7 N"]
