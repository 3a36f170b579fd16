"""Reasons against a changed proof: exactly the expected reason, also near its limit."""

import copy
import json
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from builders import falling_pair, hanging_pair, pressed_box, rough_staircase
from judged import reloaded

import kilter
from kilter import InputError
from kilter.analysis.verification import (
    Verification,
    proof_tolerance,
    verify_bundle,
    verify_proof,
)
from kilter.assembly import Assembly
from kilter.cli import main
from kilter.contact import ContactSet, detect
from kilter.files.own.choices import digest
from kilter.mechanics.mechanics_tolerances import AGREES
from kilter.mechanics.proof import digest_of
from kilter.scenes import example, friction, paper, stacks

MADE: dict[str, Callable[[], Assembly]] = {
    "forces": lambda: paper.figure_9().with_friction(0.0),
    "friction": rough_staircase,
    "slope": lambda: stacks.block_on_slope(20.0, friction=0.5),
    "refuted": lambda: friction.bracket(1.1 / 1.2, pad=1e-3),
    "loads": pressed_box,
    "joints": hanging_pair,
    "motion": paper.figure_8,
    "motion with joints": falling_pair,
    "planar motion": lambda: paper.figure_8(planar=True),
}
Proof = dict[str, Any]


@cache
def made(name: str) -> tuple[Assembly, ContactSet, Proof]:
    assembly = MADE[name]()
    proof = json.loads(json.dumps(kilter.check(assembly, effort=3).proof(), allow_nan=False))
    assembly = reloaded(assembly)
    return assembly, detect.contacts(assembly), proof


def said(name: str, change: Callable[[Proof], object], *, sign: bool = True) -> tuple[str, ...]:
    """The reasons against a proof after a change, signed anew."""
    assembly, contacts, proof = made(name)
    other = copy.deepcopy(proof)
    change(other)
    if sign:
        other["digest"] = digest_of(other)
    return verify_proof(assembly, contacts, other).reasons


def in_place(*path: Any, add: float = 0.0, times: float = 1.0) -> Callable[[Proof], None]:
    def change(proof: Proof) -> None:
        inner: Any = proof
        for key in path[:-1]:
            inner = inner[key]
        inner[path[-1]] = inner[path[-1]] * times + add

    return change


def put(*path: Any, value: Any) -> Callable[[Proof], None]:
    def change(proof: Proof) -> None:
        inner: Any = proof
        for key in path[:-1]:
            inner = inner[key]
        inner[path[-1]] = value

    return change


@pytest.mark.parametrize("name", MADE)
def test_what_is_not_changed_holds(name):
    assert said(name, lambda proof: None) == ()


def test_the_digest_alone():
    [reason] = said("forces", in_place("parts", 0, "mass", times=1 + 1e-12), sign=False)
    assert "digest" in reason


LIMITS: dict[str, tuple[str, tuple[Any, ...], Callable[[Assembly], float], str]] = {
    "gravity": (
        "forces",
        ("gravity", 2),
        lambda a: float(np.linalg.norm(a.gravity)),
        "its gravity",
    ),
    "down": ("forces", ("down", 2), lambda a: 1.0, "its direction of gravity differs"),
    "mass": ("forces", ("parts", 1, "mass"), lambda a: float(a.geometry.mass[1]), "another mass"),
    "normal": ("forces", ("points", 0, "normal", 0), lambda a: 1.0, "its contact normals"),
    "mu": ("friction", ("points", 0, "mu"), lambda a: 1.0, "its friction coefficients"),
    "residual": (
        "forces",
        ("certificate", "residual"),
        lambda a: 1.0,
        "its stated residual differs",
    ),
    "violation": (
        "motion",
        ("certificate", "violation"),
        lambda a: 1.0,
        "its stated violation differs",
    ),
}


@pytest.mark.parametrize("kind", LIMITS)
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_number_agrees_up_to_its_limit(kind, sign):
    name, path, size, word = LIMITS[kind]
    most = AGREES * size(made(name)[0])
    assert said(name, in_place(*path, add=0.99 * sign * most)) == ()
    [reason] = said(name, in_place(*path, add=1.01 * sign * most))
    assert word in reason


def test_a_centre_and_a_point_agree_up_to_the_size_of_their_part():
    from kilter.mechanics.program import build_program

    assembly, contacts, _ = made("forces")
    program = build_program(assembly, contacts)
    reach = program.radius[1] + float(np.abs(program.center[1]).max())
    assert said("forces", in_place("parts", 1, "center", 0, add=0.99 * AGREES * reach)) == ()
    [reason] = said("forces", in_place("parts", 1, "center", 0, add=1.01 * AGREES * reach))
    assert "another centre of mass" in reason
    size = float(np.abs(program.point).max()) + float(program.radius.max())
    assert said("forces", in_place("points", 0, "x", 1, add=0.99 * AGREES * size)) == ()
    [reason] = said("forces", in_place("points", 0, "x", 1, add=1.01 * AGREES * size))
    assert "contact points are at other places" in reason


def test_the_power_of_a_motion_agrees_up_to_its_limit():
    for by in (0.99, -0.99):
        assert said("motion", in_place("certificate", "power", times=1 + by * AGREES)) == ()
    for by in (1.02, -1.02):
        [reason] = said("motion", in_place("certificate", "power", times=1 + by * AGREES))
        assert reason.startswith("its power is")


ONE_REASON: dict[str, tuple[str, Callable[[Proof], object], str]] = {
    "planar": ("forces", lambda p: p.update(planar=True), "differ in `planar` or in units"),
    "units": ("forces", lambda p: p.update(units="mm"), "differ in `planar` or in units"),
    "name": (
        "forces",
        put("parts", 0, "name", value="x"),
        "its parts differ from those of the file",
    ),
    "held": ("forces", put("parts", 1, "grounded", value=True), "is held in the proof"),
    "free": ("forces", put("parts", 0, "grounded", value=False), "is free in the proof"),
    "one point": ("forces", lambda p: p["points"].pop(), "contact points, the file"),
    "sides": ("forces", lambda p: p["points"][0]["parts"].reverse(), "between other parts"),
    "load": ("loads", in_place("loads", 0, "force", 0, add=1.0), "its loads differ"),
    "no load": ("loads", lambda p: p["loads"].pop(), "its loads differ"),
    "joint": ("joints", put("joints", 0, "kind", value="hinge"), "its joints differ"),
    "joint at": ("joints", in_place("joints", 0, "point", 0, add=1.0), "its joints differ"),
    "verdict": ("forces", put("verdict", value="unstable"), "carries the evidence of 'stable'"),
    "settles": ("slope", put("verdict", value="settles"), "carries the evidence of 'stable'"),
    "motion": ("motion", put("verdict", value="stable"), "carries the evidence of 'unstable'"),
    "no exclusion": ("slope", put("friction", "exclusion", value=None), "not how every motion"),
    "pairs": (
        "motion",
        lambda p: p["open_pairs"].append({"parts": ["C1", "C2"], "kind": "overlap"}),
        "its open pairs",
    ),
    "no part": ("motion", lambda p: p["motion"].pop("C2"), "does not belong to the free parts"),
    "held part": (
        "motion",
        lambda p: p["motion"].update(C1=[0] * 6),
        "does not belong to the free parts",
    ),
    "out of plane": (
        "planar motion",
        in_place("motion", "C2", 1, add=1e-12),
        "its motion leaves the plane",
    ),
    "no witness": ("refuted", put("friction", "witness", value=None), "has no witness"),
    "opened": ("refuted", put("friction", "guarantee", value="open"), "has a witness"),
    "power": ("refuted", in_place("friction", "witness", "power", add=2e-9), "power or residual"),
    "residual of a motion": (
        "refuted",
        in_place("friction", "witness", "residual", add=2e-9),
        "power or residual",
    ),
    "one push": (
        "refuted",
        lambda p: p["friction"]["witness"]["forces"].pop(),
        "its motion does not belong to",
    ),
    "others move": (
        "refuted",
        lambda p: p["friction"]["witness"]["acceleration"].clear(),
        "its motion does not belong to",
    ),
}


@pytest.mark.parametrize("kind", ONE_REASON)
def test_one_change_has_its_one_reason(kind):
    name, change, word = ONE_REASON[kind]
    [reason] = said(name, change)
    assert word in reason


def test_no_more_than_ten_parts_are_named():
    assembly = kilter.example("wall")
    proof = kilter.check(assembly).proof()
    for part in proof["parts"]:
        part["mass"] *= 2
    proof["digest"] = digest_of(proof)
    reasons = verify_proof(assembly, detect.contacts(assembly), proof).reasons
    assert len(reasons) == 10
    assert all("another mass" in one for one in reasons)


def test_forces_that_do_not_balance_and_what_else_is_wrong_with_them():
    residual = "its stated residual differs from that of its forces"
    [first, second] = said("forces", lambda p: p.update(forces=[[0.0] * 3 for _ in p["forces"]]))
    assert first == residual
    assert second == "the forces leave 1 of a part's weight unbalanced"

    def pulls(proof: Proof) -> None:
        proof["forces"] = [[-2 * x for x in one] for one in proof["forces"]]

    assert "a contact force pulls" in said("forces", pulls)
    few = said("forces", lambda p: p["forces"].pop())
    assert "the proof does not have a force for each contact point" in few
    aside = said("forces", lambda p: p["forces"].__setitem__(0, [500.0, 500.0, 500.0]))
    assert "a force leaves its cone: it is not along the normal" in aside

    def rubs(proof: Proof) -> None:
        del proof["friction"]

    reasons = said("slope", rubs)
    assert any("leaves its cone" in one for one in reasons)
    rubbing = said("refuted", lambda p: p["forces"].__setitem__(0, [1e6, 1e6, 1e6]))
    assert "a force leaves its cone: its friction exceeds mu times its normal force" in rubbing


def test_a_joint_that_carries_another_wrench():
    def other(proof: Proof) -> None:
        proof["joints"][1]["wrench"][2] *= 1.001

    residual, unbalanced = said("joints", other)
    assert residual == "its stated residual differs from that of its forces"
    assert "unbalanced" in unbalanced


def test_a_motion_backwards_gains_nothing():
    def backwards(proof: Proof) -> None:
        proof["motion"] = {name: [-x for x in six] for name, six in proof["motion"].items()}

    reasons = said("motion", backwards)
    assert any("proves nothing" in one for one in reasons)
    assert any(one.startswith("its power is") for one in reasons)
    faster = said("motion", lambda p: p.update(motion={
        name: [3 * x for x in six] for name, six in p["motion"].items()
    }))  # fmt: skip
    assert faster == ("its fastest part does not move by 1",)


def test_a_motion_that_breaks_the_law_of_friction():
    def pushed(proof: Proof) -> None:
        six = next(iter(proof["friction"]["witness"]["acceleration"].values()))
        six[0] += 1.0

    reasons = said("refuted", pushed)
    assert any("breaks Coulomb's law" in one for one in reasons)


@pytest.mark.parametrize(
    ("name", "level", "note"),
    [
        ("settles", "settles", "8 of 8 tries come to rest when repeated, and the search finds no"),
        ("refuted", "equilibrium", "a motion obeys Coulomb's law too"),
        ("squeezed", "equilibrium", "0 of 8 tries come to rest when repeated"),
    ],
)
@pytest.mark.slow
def test_a_claim_that_it_settles_is_repeated(name, level, note):
    """A claim without a motion or an exclusion, for assemblies that settle or do not settle."""
    made_of = {
        "settles": lambda: stacks.tower(2, tilt=10.0, friction=0.5),
        "refuted": lambda: friction.bracket(1.1 / 1.2, pad=1e-3),
        "squeezed": friction.h_block,
    }
    assembly = made_of[name]()
    proof = json.loads(json.dumps(kilter.check(assembly, effort=0.2).proof()))
    proof["friction"] |= {"guarantee": "open", "exclusion": None, "witness": None}
    proof["verdict"] = "settles"
    proof["digest"] = digest_of(proof)
    found = kilter.verify(assembly, proof)
    assert (found.level, found.claimed, found.reasons) == (level, "settles", ())
    assert found.holds == (level == "settles")
    assert note in found.notes[-1]
    lower = kilter.verify(assembly, proof, require="equilibrium")
    assert lower.holds
    assert lower.level == "equilibrium"


def test_a_lower_level_is_not_the_required_level():
    assembly, contacts, proof = made("refuted")
    found = verify_proof(assembly, contacts, proof, require="settles")
    assert (found.holds, found.level, found.reasons) == (False, "equilibrium", ())
    assert found.notes[-1].startswith("a motion obeys Coulomb's law too")
    assert found.residual == pytest.approx(proof["certificate"]["residual"])
    assert found.power is None
    fall = verify_proof(*made("motion"), require="equilibrium")
    assert (fall.holds, fall.level, fall.claimed, fall.reasons) == (False, None, None, ())
    with pytest.raises(kilter.InputError, match="the level 'sure' does not exist"):
        kilter.verify(assembly, proof, require="sure")


def test_a_verification_says_all_and_is_neither_true_nor_false():
    assembly, contacts, proof = made("motion")
    found = verify_proof(assembly, contacts, proof)
    assert repr(found) == "<Verification: unstable, holds>"
    other = verify_proof(assembly, contacts, {**proof, "digest": ""})
    assert repr(other) == "<Verification: unstable, does not hold>"
    assert found.residual is None
    assert found.power == proof["certificate"]["power"]
    assert found.to_dict() == {
        "holds": True,
        "verdict": "unstable",
        "level": None,
        "claimed": None,
        "require": None,
        "residual": None,
        "power": found.power,
        "reasons": [],
        "notes": [],
        "held": ["C1"],
        "gravity": assembly.gravity.tolist(),
        "units": "m",
        "options": proof["options"],
        "tolerance": proof["tolerance"],
    }
    with pytest.raises(TypeError, match=r"use \.holds"):
        bool(found)


# files ------------------------------------------------------------------------------------------


@pytest.fixture
def files(tmp_path: Path) -> tuple[Path, Path]:
    """An assembly file, and the file of a proof about it."""
    assembly, proof = tmp_path / "tower.kilter.json", tmp_path / "tower.proof.json"
    kilter.dump(example("tower"), assembly)
    proof.write_text(json.dumps(kilter.check(example("tower")).proof()), encoding="utf-8")
    return assembly, proof


def test_files_are_read_as_they_were_for_the_proof(files):
    assembly, proof = files
    stages: list[str] = []
    found = kilter.verify(assembly, proof, progress=stages.append)
    assert found.holds
    assert stages[0] == "reading"
    assert kilter.verify(str(assembly), json.loads(proof.read_text())).holds
    assert kilter.verify(example("tower"), str(proof)).holds
    assert not kilter.verify(example("staircase"), proof).holds


def test_a_fault_of_a_proof_names_its_file(files):
    assembly, proof = files
    proof.write_text('{"kilter_proof": 1}')
    with pytest.raises(InputError, match=r"tower\.proof\.json: the proof cannot be read"):
        kilter.verify(assembly, proof)
    with pytest.raises(InputError, match="no kilter proof") as refused:
        kilter.verify(assembly, {})
    assert refused.value.file is None
    with pytest.raises(InputError, match="verify"):
        kilter.verify(3, kilter.check(example("tower")).proof())  # type: ignore[arg-type]


def test_several_proofs_in_one_file(files):
    assembly, proof = files
    bundle = kilter.region(example("tower")).proof()
    proof.write_text(json.dumps(bundle), encoding="utf-8")
    found = kilter.verify(assembly, proof)
    assert found.holds
    assert found.verdict == "region"
    assert found.residual is not None
    assert found.power is not None
    again = json.loads(proof.read_text())
    whole, touching = example("tower"), detect.contacts(example("tower"))
    assert found.notes[0].startswith("a direction without a proof lies at most")
    each = [one.split(" x ") for one in found.notes[1:]]
    assert sum(int(count) for count, _ in each) == len(bundle["proofs"])
    assert {what.split(": ")[1] for _, what in each} == {"held by forces", "a motion starts"}
    held = [count for count, what in each if what.endswith("held by forces")]
    assert sum(map(int, held)) == sum("forces" in one["proof"] for one in again["proofs"])
    unsigned = {**again, "digest": "0"}
    assert verify_bundle(whole, touching, unsigned).reasons == (
        "the proof file was changed after kilter wrote it (its digest does not match)",
    )
    again["proofs"][0]["proof"]["digest"] = "0"
    again["digest"] = digest_of(again)
    found = verify_bundle(whole, touching, again)
    about = again["proofs"][0]
    assert not found.holds
    assert found.reasons[0].startswith(f"{about['about']} {about['vector']}: the file was changed")


@pytest.mark.slow
def test_the_worst_of_several_proofs_is_told():
    assembly = example("corner-wedges")
    bundle = json.loads(json.dumps(kilter.region(assembly).proof()))
    contacts = detect.contacts(assembly)
    found = verify_bundle(assembly, contacts, bundle)
    own: list[Verification] = []
    from kilter.mechanics.bundle import apply_change, split_bundle

    for about, proof in split_bundle(bundle):
        own.append(verify_proof(*apply_change(assembly, contacts, about["change"]), proof))
    residuals = [one.residual for one in own if one.residual is not None]
    assert len(set(residuals)) > 1
    assert found.residual == max(one.residual for one in own if one.residual is not None)
    powers = [one.power for one in own if one.power is not None]
    assert len(set(powers)) > 1
    assert found.power == min(powers)


def test_a_plan_that_is_none_is_refused_in_words():
    assembly = example("paper-figure-9")
    bundle = json.loads(json.dumps(kilter.plan(assembly).proof()))
    contacts = detect.contacts(assembly)
    assert verify_bundle(assembly, contacts, bundle).holds
    bundle["rules"] = 3
    bundle["digest"] = digest_of(bundle)
    with pytest.raises(InputError, match="the proof of a plan does not have the required form"):
        verify_bundle(assembly, contacts, bundle)


def test_what_is_no_proof_is_refused_whoever_is_asked():
    assembly, contacts, proof = made("forces")
    for ask in (proof_tolerance, lambda one: verify_proof(assembly, contacts, one)):
        with pytest.raises(InputError, match="no kilter proof"):
            ask({})
        with pytest.raises(InputError, match="parts is missing"):
            ask({key: value for key, value in proof.items() if key != "parts"})
        with pytest.raises(InputError, match=r"tolerance\.clearance"):
            ask({**proof, "tolerance": {**proof["tolerance"], "clearance": [0.1]}})


def test_a_proof_is_read_with_the_tolerance_that_it_was_made_with():
    given = kilter.Tolerance(gap=2e-3, relative_gap=3e-4, angle=4e-3, clearance=5e-3)
    proof = kilter.check(example("tower"), tolerance=given).proof()
    found = proof_tolerance(proof)
    for name in ("gap", "relative_gap", "angle", "clearance"):
        assert getattr(found, name) == getattr(given, name), name


def hinged_door() -> Assembly:
    """A door on a vertical hinge, whose weight the hinge bears."""
    parts = [
        kilter.Part("frame", kilter.Box([0.2, 0.2, 2.0]), grounded=True),
        kilter.Part("door", kilter.Box([1.0, 0.05, 2.0]), kilter.Pose([0.7, 0.0, 0.0])),
    ]
    hinge = kilter.Joint(("frame", "door"), "revolute", point=[0.15, 0, 0], axis=[0, 0, 1])
    return Assembly(parts, joints=[hinge])


@pytest.mark.parametrize(("place", "more"), [(5, 1.0), (2, 0.0)])
def test_a_hinge_carries_no_torque_about_its_axis(place, more):
    assembly = hinged_door()
    proof = json.loads(json.dumps(kilter.check(assembly).proof()))
    assert kilter.verify(assembly, proof).holds
    proof["joints"][0]["wrench"][place] += more
    proof["digest"] = digest_of(proof)
    reasons = kilter.verify(assembly, proof).reasons
    beyond = "the revolute joint of 'frame' and 'door' has a load that its kind cannot carry"
    assert (beyond in reasons) == (more > 0)


def test_a_proof_with_friction_has_one_force_a_contact_point_too():
    few = said("slope", lambda proof: proof["forces"].pop())
    assert "the proof does not have a force for each contact point" in few


def test_a_proof_of_saved_options_is_about_one_version_of_the_file(tmp_path):
    path, choices = tmp_path / "tower.kilter.json", tmp_path / "choices.json"
    kilter.dump(example("tower"), path)
    data = {"kilter": 1, "file": path.name, "held": ["base"], "sha256": digest(path)}
    choices.write_text(json.dumps(data), encoding="utf-8")
    proof = tmp_path / "proof.json"
    assert main(["check", str(choices), "--quiet", "--proof", str(proof)]) == 0
    for file in (path, choices):
        assert kilter.verify(file, proof).holds
    path.write_text(path.read_text(encoding="utf-8") + "\n", encoding="utf-8")
    for file in (path, choices):
        found = kilter.verify(file, proof)
        assert (found.holds, found.verdict, found.held) == (False, "stable", ("base",))
        reason = "the proof is about another version of tower.kilter.json (its sha256 differs)"
        assert found.reasons == (reason,)
