"""Masses, inertia, friction and filters of MuJoCo models against the engine and closed forms."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import kilter
from kilter import CarrierMotion, InputError

pytest.importorskip("mujoco")

import mujoco
from engine_truth import friction_differences, mass_differences, placed, random_model, reduced

G = 9.81
FLOOR = '<geom name="floor" type="box" size="5 5 .5" pos="0 0 -.5" {}/>'
BODY = '<body name="{}" pos="{}">{}{}</body>'
SOLE = '<geom name="sole" type="box" size=".5 .5 .1" {}/>'
HAT = '<geom name="hat" type="box" size=".4 .4 .1" pos="0 0 .2" {}/>'


def model_of(world: str, rest: str = "", option: str = "") -> Any:
    return mujoco.MjModel.from_xml_string(
        f"<mujoco><option {option}/><worldbody>{world}</worldbody>{rest}</mujoco>"
    )


def on_slope(floor: str, sole: str, hat: str = "", rest: str = "", slope: float = 15.0) -> Any:
    """A body with a sole, and with a hat that touches nothing, on a floor tilted by degrees."""
    angle = np.radians(slope)
    shoe = BODY.format("shoe", "0 0 .1", "<freejoint/>", SOLE.format(sole) + HAT.format(hat))
    gravity = f'gravity="{G * np.sin(angle)} 0 {-G * np.cos(angle)}"'
    return model_of(FLOOR.format(floor) + shoe, rest, gravity)


PAIR = '<contact><pair geom1="floor" geom2="sole" friction="{0} {0}" condim="{1}"/></contact>'
MU = 'friction="{}"'.format
ROUGH = 'friction=".8"'
SLOPES = {
    # the same scene with a single number flipped is stable: tan 15 deg = .268
    "sole": ((MU(0.1), MU(0.1), MU(1)), (MU(0.1), MU(0.3), MU(1))),
    "priority": ((f'{MU(0.1)} priority="1"', ROUGH), (f'{MU(0.1)} priority="0"', ROUGH)),
    "pair": ((ROUGH, ROUGH, "", PAIR.format(0.1, 3)), (ROUGH, ROUGH, "", PAIR.format(0.3, 3))),
    "condim": (('condim="1" ' + ROUGH, 'condim="1"'), ('condim="1" ' + ROUGH, 'condim="3"')),
    "pair condim": (
        (ROUGH, ROUGH, "", PAIR.format(0.8, 1)),
        (ROUGH, ROUGH, "", PAIR.format(0.8, 3)),
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", SLOPES)
def test_a_body_slides_by_the_friction_of_the_geoms_that_touch(name):
    slides, rests = (kilter.load(on_slope(*words)) for words in SLOPES[name])
    assert kilter.check(slides).verdict == "unstable"
    assert kilter.check(rests).verdict == "stable"


def test_friction_of_geoms_is_kept_by_the_file_and_the_option_says_so(tmp_path):
    assembly = kilter.load(on_slope(MU(0.1), MU(0.1), MU(1)))
    path = tmp_path / "shoe.kilter.json"
    kilter.dump(assembly, path)
    assert kilter.contacts(kilter.load(path)).patch_mu.tolist() == [0.1]
    again = kilter.load(path, friction=0.7)
    assert any("keeps its own coefficient" in note for note in again.notes)


def test_the_torque_of_a_turning_disc_is_that_of_its_stated_inertia():
    """24 N m are needed, and friction gives mu m g r = 8.24 N m: a factor of .343."""
    inertial = '<inertial pos="0 0 0" mass="10" diaginertia="1.6 1.6 3"/>'
    disc = '<geom type="cylinder" size=".28 .05" friction=".3"/>'
    model = model_of(
        FLOOR.format('friction=".3"')
        + BODY.format("disc", "0 0 .05", "<freejoint/>" + inertial, disc)
    )
    turn = CarrierMotion(angular_acceleration=[0, 0, 8.0])
    case = kilter.transport(kilter.load(model), turn=turn, require="equilibrium").cases[0]
    assert case.level is None
    assert case.factor is not None
    assert case.factor == pytest.approx(0.3 * 10 * G * 0.28 / 24, rel=0.02)


SLICK = 'condim="1"'
EDGE = '<geom type="box" size="1 1 1" pos="-1 0 -1" condim="1"/>'


def tipping(body: str) -> float:
    """Angular acceleration of a body named b over the edge x = 0 [rad/s^2]."""
    verdict = kilter.check(kilter.load(model_of(EDGE + body)))
    assert verdict.verdict == "unstable"
    k = verdict.assembly.index_of("b")
    return float(np.linalg.norm(verdict.motion.acceleration[k, 3:]))


@pytest.mark.parametrize("inertia", [0.05, 5.0])
def test_a_plate_tips_over_an_edge_by_its_stated_inertia(inertia):
    """43.6 and 3.63 rad/s^2."""
    stated = f'<inertial pos="0 0 0" mass="10" diaginertia="{inertia} {inertia} {inertia}"/>'
    plate = BODY.format("b", ".2 0 .1", "<freejoint/>" + stated, SOLE.format(SLICK))
    wanted = 10 * G * 0.2 / (inertia + 10 * 0.2**2)
    assert tipping(plate) == pytest.approx(wanted, rel=1e-9)


def test_a_bar_with_heavy_ends_tips_by_the_masses_of_its_geoms():
    """Two cubes of 5 kg: m g d / (I + m d^2); a uniform bar would tip faster."""
    end = '<geom type="box" size=".1 .1 .1" pos="{} 0 0" mass="5" condim="1"/>'
    bar = '<geom type="box" size="1 .05 .1" mass="1e-9" condim="1"/>'
    inside = bar + end.format(-0.95) + end.format(0.95)
    inertia = 2 * 5 * (0.95**2 + 0.2**2 / 6)
    found = tipping(BODY.format("b", ".4 0 .1", "<freejoint/>", inside))
    assert found == pytest.approx(10 * G * 0.4 / (inertia + 10 * 0.4**2), rel=1e-6)


@pytest.mark.quick(2)
@pytest.mark.parametrize("seed", range(100))
def test_a_random_model_has_the_masses_and_the_friction_of_the_engine(seed):
    model = mujoco.MjModel.from_xml_string(random_model(seed))
    data, assembly = placed(model), kilter.load(model)
    assert mass_differences(model, data, assembly) == []
    assert friction_differences(model, data, assembly, complete=True)[0] == []


FILES = sorted(Path(mujoco.__file__).parent.rglob("*.xml"))


@pytest.mark.slow
def test_files_of_the_package_have_the_masses_and_the_friction_of_the_engine():
    """A file without bodies is refused; a file with height fields is compared without them."""
    compared = 0
    for path in FILES:
        model = reduced(path)
        if model.nbody == 1:
            with pytest.raises(InputError, match="no bodies"):
                kilter.load(path)
            continue
        data, assembly = placed(model), kilter.load(model)
        assert mass_differences(model, data, assembly) == []
        assert friction_differences(model, data, assembly)[0] == []
        compared += 1
    assert compared


BOX = '<geom type="box" size=".1 .1 .1" {}/>'
STATED = '<inertial pos="{} 0 0" mass="{}" diaginertia=".2 .2 .2"/>'


@pytest.mark.parametrize(
    ("inside", "parts"),
    [
        (BOX.format("") + BODY.format("c", "0 0 .2", "", BOX.format('mass="0"')), {"b"}),
        (BOX.format("") + BODY.format("c", "0 0 .2", "", STATED.format(0.3, 4)), {"b"}),
        (BODY.format("c", "0 0 .2", "", BOX.format("")), {"c"}),
        (STATED.format(0.1, 2) + BODY.format("c", "0 0 .2", "", BOX.format('mass="0"')), {"c"}),
        (BOX.format("") + BODY.format("c", "0 0 .2", "", BOX.format("")), {"b", "c"}),
    ],
    ids=["massless child", "child without geoms", "frame", "mass above", "two parts"],
)
def test_the_mass_of_every_body_belongs_to_a_part_that_moves_with_it(inside, parts):
    hinge = '<joint type="hinge" axis="0 1 0" pos="-.5 0 0"/>'
    model = model_of(BODY.format("b", "0 0 0", hinge, inside))
    assembly = kilter.load(model)
    assert set(assembly.names) == parts
    assert [joint.kind for joint in assembly.joints if "ground" in joint.parts] == ["revolute"]
    assert assembly.mass == pytest.approx(model.body_mass.sum(), rel=1e-12)
    assert mass_differences(model, placed(model), assembly) == []


@pytest.mark.parametrize(("share", "falls"), [(0.0, True), (0.99, True), (1.0, False)])
def test_gravity_compensation_relieves_the_weight(share, falls):
    """A slide that points up falls unless its whole weight is compensated."""
    slide = '<joint type="slide" axis="0 0 1"/>'
    made = BODY.format("b", "0 0 0", slide, BOX.format("")).replace(
        '"b"', f'"b" gravcomp="{share}"'
    )
    model = model_of(made)
    assembly = kilter.load(model)
    assert (kilter.check(assembly).verdict == "unstable") is falls
    assert any("gravity compensation" in note for note in assembly.notes) is (share > 0)
    data = placed(model)
    assert sum(load.force[2] for load in assembly.loads) == pytest.approx(data.qfrc_passive[0])


def test_a_held_body_needs_no_compensation_of_its_weight():
    made = BODY.format("b", "0 0 0", "<freejoint/>", BOX.format("")).replace(
        '"b"', '"b" gravcomp="1"'
    )
    assembly = kilter.load(model_of(made), ground="b")
    assert not assembly.loads
    assert "loads on held parts, without effect: 'b'" in assembly.notes


FREE = BODY.format("b", "0 0 .1", "<freejoint/>", SOLE.format("{}"))
TENDON = (
    '<worldbody><site name="s"/><body pos="0 0 9"><site name="t"/></body></worldbody>'
    '<tendon><spatial {}><site site="s"/><site site="t"/></spatial></tendon>'
)
NOTES = {
    "torsional and rolling friction is ignored: 1 pairs": ('condim="4"', "", ""),
    "ignored: 1 margins of geoms": ('margin=".01"', "", ""),
    "ignored: 1 second sliding": ("", PAIR.format(".4", 3).replace(".4 .4", ".4 .5"), ""),
    "1 tendons with limits or springs, which may hold": ("", TENDON.format('range="0 1"'), ""),
    "ignored: 1 other tendons": ("", TENDON.format(""), ""),
    "the model disables all contacts": ("", "", "contact"),
    "no objects, since nothing can touch them: 1 bodies": ('contype="0" conaffinity="0"', "", ""),
}


@pytest.mark.parametrize("note", NOTES)
def test_a_note_names_a_feature_that_kilter_does_not_have(note):
    geom, rest, flag = NOTES[note]
    flags = f'<option><flag {flag}="disable"/></option>' if flag else ""
    found = kilter.load(model_of(FLOOR.format("") + FREE.format(geom), rest + flags))
    assert sum(note in each for each in found.notes) == 1
    plain = kilter.load(model_of(FLOOR.format("") + FREE.format("")))
    assert plain.notes == ()
    if flag:
        assert len(kilter.contacts(found)) == 0


def test_a_model_without_gravity_has_that_of_the_default():
    for rest, option in (
        ('<option><flag gravity="disable"/></option>', ""),
        ("", 'gravity="0 0 0"'),
    ):
        found = kilter.load(model_of(FREE.format(""), rest, option))
        assert found.gravity.tolist() == [0.0, 0.0, -9.81]
        assert any("the model has no gravity: MuJoCo's default" in note for note in found.notes)
