"""Models of MuJoCo, and mechanisms beside its simulation."""

import pytest

pytest.importorskip("mujoco")

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass, field

import mujoco
import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray
from tilted_scenes import outcome

import kilter
from kilter import InputError
from kilter.scenes import scene
from kilter.scenes.stacks import block_on_slope

Agree = Callable[..., kilter.Assembly]


def text(world: str, rest: str = "") -> str:
    return f"<mujoco>{rest}<worldbody>{world}</worldbody></mujoco>"


def body(name: str, at: str, geom: str, joint: str = "<freejoint/>", rest: str = "") -> str:
    return f'<body name="{name}" pos="{at}">{joint}<geom {geom}/>{rest}</body>'


FLOOR = '<geom name="floor" type="plane" size="0 0 1"/>'
BOX = 'type="box" size=".5 .5 .5"'
SCENES = {
    "a box on a plane": (text(FLOOR + body("box", "0 0 .5", BOX)), "stable"),
    "in the air": (text(FLOOR + body("box", "0 0 .6", BOX)), "unstable"),
    "a cylinder and a ball": (
        text(
            FLOOR
            + body("post", "0 0 1", 'type="cylinder" size=".3 1" mass="7"')
            + body("ball", "0 0 2.2", 'type="sphere" size=".2"')
        ),
        "stable",
    ),
    "an arm that swings": (
        text(body("arm", "0 0 0", 'type="box" size=".5 .1 .1" pos=".5 0 0"',
                  '<joint type="hinge" axis="0 1 0"/>')),
        "unstable",
    ),
    "an arm that hangs": (
        text(body("arm", "0 0 0", 'type="box" size=".1 .1 .5" pos="0 0 -.5"',
                  '<joint type="hinge" axis="0 1 0"/>')),
        "stable",
    ),
    "a table of five geoms": (
        text(
            FLOOR
            + body(
                "table",
                "0 0 0",
                'type="box" size="1 1 .1" pos="0 0 .9"',
                rest="".join(
                    f'<geom type="box" size=".1 .1 .4" pos="{x} {y} .4"/>'
                    for x in (-0.8, 0.8)
                    for y in (-0.8, 0.8)
                ),
            )
        ),
        "stable",
    ),
}  # fmt: skip


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", SCENES)
def test_a_model_and_its_file_give_the_same_answer(agree, name):
    made, verdict = SCENES[name]
    model = mujoco.MjModel.from_xml_string(made)
    found = agree(model, lambda path: path.write_text(made), "scene.xml", verdict)
    for part in found.parts:
        if not part.grounded:
            k = found.index_of(part.name)
            assert found.geometry.mass[k] == pytest.approx(model.body(part.name).mass[0])
            data = mujoco.MjData(model)
            mujoco.mj_forward(model, data)
            assert np.allclose(found.geometry.center[k], data.body(part.name).xipos)


@pytest.mark.quick(1)
@pytest.mark.parametrize(("slope", "verdict"), [(0.29, True), (0.31, False)])
def test_two_geoms_rub_with_the_greater_of_their_coefficients(slope, verdict):
    made = text(
        '<geom type="box" size="2 2 .5" pos="0 0 -.5" friction=".1"/>'
        + body("block", "0 0 .5", f'{BOX} friction=".3"'),
        f'<option gravity="{np.sin(np.arctan(slope))} 0 {-np.cos(np.arctan(slope))}"/>',
    )
    found = kilter.load(mujoco.MjModel.from_xml_string(made))
    assert found.friction == 0.3
    assert kilter.check(found).stable is verdict
    slick = made.replace('friction=".3"', 'friction=".3" condim="1"')
    slick = slick.replace('friction=".1"', 'friction=".1" condim="1"')
    assert kilter.load(mujoco.MjModel.from_xml_string(slick)).friction == 0


def test_the_pose_is_that_of_a_keyframe_or_of_the_data():
    keys = '<keyframe><key name="down" qpos="0 0 .5 1 0 0 0"/><key name="up" qpos="0 0 3 1 0 0 0"/>'
    made = text(FLOOR + body("box", "0 0 9", BOX), keys + "</keyframe>")
    model = mujoco.MjModel.from_xml_string(made)
    for options, height in (({}, 0.5), ({"keyframe": "up"}, 3.0)):
        found = kilter.load(model, **options)
        assert found.geometry.center[found.index_of("box"), 2] == pytest.approx(height)
    assert "first keyframe, 'down'" in kilter.load(model).notes[0]
    data = mujoco.MjData(model)
    data.qpos[2] = 0.7
    assert kilter.load((model, data))["box"].pose.position[2] == pytest.approx(0.7)
    with pytest.raises(InputError, match="there is no keyframe 'dwn'; did you mean 'down'"):
        kilter.load(model, keyframe="dwn")


def test_what_is_not_counted_is_said():
    made = text(
        body("arm", "0 0 0", 'type="box" size=".5 .1 .1"',
             '<joint name="j" axis="0 1 0" stiffness="3" range="-1 1" limited="true"/>'),
        '<compiler angle="radian"/><actuator><motor joint="j"/></actuator>',
    )  # fmt: skip
    model = mujoco.MjModel.from_xml_string(made)
    held = kilter.load(model)
    assert held.notes == ("held: robot of 1 body with motors; --loose-robots frees it",)
    assert held["arm"].grounded
    assert not held.joints
    found = kilter.load(model, loose_robots=True)
    assert found.notes == ("ignored: 1 motors",)
    assert found.joints[0].guide == {"limits": [-1.0, 1.0], "stiffness": 3.0, "rest": 0.0}


@pytest.mark.parametrize(
    ("value", "words"),
    [
        (lambda: mujoco.MjOption(), "a mujoco MjOption is not a model; give an MjModel"),
    ],
)
def test_what_is_no_model_or_has_no_likeness_is_refused(value, words):
    with pytest.raises(InputError, match=words):
        kilter.load(value())


def test_a_file_that_mujoco_refuses_is_refused(tmp_path):
    path = tmp_path / "bad.xml"
    path.write_text("<mujoco><worldbody><geom size='-1'/></worldbody></mujoco>")
    with pytest.raises(InputError, match=r"bad\.xml: MuJoCo rejects it: "):
        kilter.load(path)


# out ------------------------------------------------------------------------------------


def simulated(assembly: kilter.Assembly, seconds: float = 1.0) -> np.ndarray:
    """Displacement of each free part in a MuJoCo simulation [m]."""
    model = mujoco.MjModel.from_xml_string(assembly.to_mjcf())
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    start = data.xipos.copy()
    while data.time < seconds:
        mujoco.mj_step(model, data)
    free = [model.body(part.name).id for part in assembly.parts if not part.grounded]
    return np.linalg.norm(data.xipos - start, axis=1)[free]


@pytest.mark.parametrize("name", ["tower", "box-pile", "paper-figure-8", "arch"])
def test_masses_poses_and_inertia_are_those_of_the_assembly(name):
    made = dataclasses.replace(scene(name), units="cm")
    model = mujoco.MjModel.from_xml_string(made.to_mjcf())
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    for k, part in enumerate(made.parts):
        own = model.body(part.name)
        assert own.mass[0] == pytest.approx(made.geometry.mass[k], rel=1e-12)
        assert np.allclose(data.body(part.name).xipos, made.geometry.center[k] / 100, atol=1e-12)
        turn = data.body(part.name).ximat.reshape(3, 3)
        inertia = turn @ np.diag(own.inertia) @ turn.T
        size = np.abs(made.geometry.inertia[k]).max() * 1e-4
        assert np.allclose(inertia, made.geometry.inertia[k] * 1e-4, atol=1e-9 * size)
    again = kilter.load(model)
    assert again.names == made.names
    assert np.allclose(again.geometry.center * 100, made.geometry.center, rtol=0, atol=1e-4)


def test_what_stands_stands_and_what_falls_falls():
    assert kilter.check(scene("tower")).stable
    assert simulated(scene("tower")).max() < 5e-3  # sinking of cubes of 1 m in soft contacts
    falls = scene("inverted-triangle")
    assert not kilter.check(falls).stable
    assert simulated(falls).max() > 10 * simulated(scene("tower")).max()


@pytest.mark.parametrize(("friction", "stands"), [(0.45, False), (0.55, True)])
def test_a_block_on_a_slope_slides_below_its_friction_alone(friction, stands):
    made = block_on_slope(np.degrees(np.arctan(0.5)), friction=friction)
    assert kilter.check(made).stable is stands
    assert bool(simulated(made).max() < 0.05) is stands


def test_joints_hold_as_they_do_here():
    arm = kilter.Part("arm", kilter.Box([1, 0.2, 0.2]), kilter.Pose([0.5, 0, 0]))
    for joint, stands in (
        (kilter.Joint(("arm", "ground")), True),
        (kilter.Joint(("arm", "ground"), "revolute", point=[0, 0, 0], axis=[0, 1, 0]), False),
        (kilter.Joint(("arm", "ground"), "revolute", point=[0, 0, 0], axis=[0, 0, 1]), True),
        (kilter.Joint(("arm", "ground"), "spherical", point=[0, 0, 0]), False),
    ):
        made = kilter.Assembly([arm], joints=[joint])
        assert kilter.check(made).stable is stands
        assert bool(simulated(made, 0.5).max() < 0.02) is stands
        again = kilter.load(mujoco.MjModel.from_xml_string(made.to_mjcf()))
        kinds = {"fixed": 1, "revolute": 2, "spherical": 1}
        assert len(again.joints) == kinds[joint.kind]
        assert kilter.check(again).stable is stands


def test_what_mjcf_has_no_word_for_is_refused():
    with pytest.raises(InputError, match="no loads and no straps of known tension; remove them"):
        scene("books").to_mjcf()
    box = kilter.Part("box", kilter.Box([1, 1, 1]))
    slide = kilter.Joint(("box", "ground"), "prismatic", axis=[1, 0, 0])
    with pytest.raises(InputError, match="MJCF has no prismatic joint"):
        kilter.Assembly([box], joints=[slide]).to_mjcf()


FILTERED = """
<mujoco>
  <worldbody>
    <geom name="floor" type="plane" size="5 5 .1"/>
    <body name="base" pos="0 0 .5"><freejoint/>
      <geom type="box" size=".5 .5 .5"/>
      <body name="arm" pos="0 0 .9"><joint type="hinge" axis="0 1 0"/>
        <geom type="box" size=".2 .2 .5"/></body>
    </body>
    <body name="ghost" pos="3 0 .4"><freejoint/>
      <geom type="box" size=".5 .5 .5" contype="2" conaffinity="2"/></body>
    <body name="a" pos="-3 0 .5"><freejoint/><geom type="box" size=".5 .5 .5"/></body>
    <body name="b" pos="-3 0 1.4"><freejoint/><geom type="box" size=".5 .5 .5"/></body>
  </worldbody>
  <contact><exclude body1="a" body2="b"/></contact>
</mujoco>
"""


def test_pairs_that_the_model_filters_do_not_touch():
    """The pairs of `mj_collision`: child and parent, bits of geoms, and excluded pairs are none."""
    model = mujoco.MjModel.from_xml_string(FILTERED)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    bodies = model.geom_bodyid[data.contact.geom]
    names = {0: "floor"} | {k: model.body(k).name for k in range(1, model.nbody)}
    expected = {frozenset((names[int(a)], names[int(b)])) for a, b in bodies}
    assembly = kilter.load(model)
    contacts = kilter.contacts(assembly)
    touching = {frozenset(patch.parts) for patch in contacts}
    overlapping = {frozenset(assembly.names[k] for k in pair.ends) for pair in contacts.overlaps}
    assert touching | overlapping == expected
    assert expected == {frozenset(("base", "floor")), frozenset(("a", "floor"))}
    assert any("filters: " in note for note in assembly.notes)
    everything = kilter.contacts(kilter.load(model, contacts="geometry"))
    assert {"arm", "ghost", "b"} <= {name for p in everything.overlaps for name in p.parts}


def test_a_filtered_floor_carries_nothing():
    report = kilter.scene(kilter.load(mujoco.MjModel.from_xml_string(FILTERED)))
    assert (report["ghost"].state, report["ghost"].motion) == ("falls", "nothing is below it")
    assert (report["b"].state, report["b"].other) == ("floats", "floor")


PUSH, STAYS, MOVES, SECONDS = 1e-3, 0.02, 0.04, 3.0


@dataclass
class Axis:
    """A body of a chain and the joint that carries it."""

    kind: str
    axis: NDArray[np.float64]
    at: NDArray[np.float64]
    turn: NDArray[np.float64]
    center: NDArray[np.float64]
    mass: float
    guide: dict[str, str] = field(default_factory=dict)


def words(values: NDArray[np.float64]) -> str:
    return " ".join(f"{value:.17g}" for value in values)


def scene_mujoco(chain: list[Axis]) -> str:
    """MJCF of a chain on a base; friction and limits are as hard as the simulator permits."""
    inner = ""
    for link in reversed(chain):
        guide = " ".join(f'{key}="{value}"' for key, value in link.guide.items())
        inner = (
            f'<body pos="{words(link.at)}" quat="{words(link.turn)}"><inertial '
            f'pos="{words(link.center)}" mass="{link.mass}" diaginertia=".01 .01 .01"/>'
            f'<joint type="{link.kind}" axis="{words(link.axis)}" {guide} damping=".02" '
            'solimpfriction=".99 .999 .001" solreffriction=".004 1" solreflimit=".004 1"/>'
            f'<geom type="box" size=".03 .03 .03"/>{inner}</body>'
        )
    return (
        '<mujoco><compiler angle="radian"/><option timestep=".002" iterations="100" '
        'tolerance="1e-12"/><worldbody><geom type="box" size=".05 .05 .05"/>'
        f"{inner}</worldbody></mujoco>"
    )


def gravity_forces(chain: list[Axis], shift: float = 0.0) -> NDArray[np.float64]:
    """Force or torque of gravity along each joint, with all joints moved by `shift`."""
    model = mujoco.MjModel.from_xml_string(scene_mujoco(chain))
    data = mujoco.MjData(model)
    data.qpos[:] = shift
    mujoco.mj_forward(model, data)
    return np.asarray(-data.qfrc_bias, dtype=np.float64)


def guide_of(rng: Generator, weight: float) -> dict[str, str]:
    """Limits, friction and spring of a joint that gravity drives by `weight`."""
    guide, left = {}, weight
    if rng.random() < 0.5:
        share = float(rng.choice([0.5, 0.8, 1.5, -0.5]))
        left = weight * (1 - share)
        stiffness = rng.uniform(0.5, 2.0) * abs(left)
        rest = -share * weight / stiffness
        guide |= {"stiffness": str(float(stiffness)), "springref": str(float(rest))}
    limits = rng.choice(["", "0 .6", "-.6 0", "-.6 .6"])
    if limits:
        guide |= {"range": str(limits)}
    if rng.random() < 0.6:
        guide["frictionloss"] = str(float(abs(left) * float(rng.choice([0.3, 0.7, 1.4, 3.0]))))
    return guide


def mechanism(seed: int) -> list[Axis]:
    """One to three links; a third of all are single links on a spring that balances them."""
    rng = np.random.default_rng(seed)
    balanced = seed % 3 == 0
    while True:
        chain = []
        for _ in range(1 if balanced else int(rng.integers(1, 4))):
            turn, axis = rng.normal(size=4), rng.normal(size=3)
            chain.append(
                Axis(
                    "hinge" if balanced else str(rng.choice(["hinge", "slide"])),
                    axis / np.linalg.norm(axis),
                    rng.uniform([0.3, -0.2, -0.2], [0.7, 0.2, 0.2]),
                    turn / np.linalg.norm(turn),
                    rng.uniform(-0.15, 0.15, 3),
                    float(rng.uniform(0.5, 3.0)),
                )
            )
        weight = gravity_forces(chain)
        if np.abs(weight).min() < 0.2:
            continue
        if balanced:
            slope = float((gravity_forces(chain, 1e-5) - weight)[0]) / 1e-5
            stiffness = abs(slope) * float(rng.choice([0.4, 2.0]))
            if stiffness < 0.2:
                continue
            rest = str(float(-weight[0] / stiffness))
            chain[0].guide = {"stiffness": str(float(stiffness)), "springref": rest}
            return chain
        for link, size in zip(chain, weight.tolist(), strict=True):
            link.guide = guide_of(rng, size)
        return chain


def farthest(text: str) -> float:
    """Largest position of a joint after small pushes to both sides, within the limits."""
    model = mujoco.MjModel.from_xml_string(text)
    data, reached = mujoco.MjData(model), 0.0
    for sign in (1.0, -1.0):
        mujoco.mj_resetData(model, data)
        low, high = np.where(model.jnt_limited, model.jnt_range.T, [[-1.0], [1.0]])
        data.qpos[:] = np.clip(sign * PUSH, low, high)
        while data.time < SECONDS and reached < MOVES:
            mujoco.mj_step(model, data)
            reached = max(reached, float(np.abs(data.qpos).max()))
    return reached


@pytest.mark.slow
@pytest.mark.parametrize("block", range(6))
def test_a_mechanism_stays_in_the_simulation_exactly_if_it_is_stable(block):
    for seed in range(12 * block, 12 * block + 12):
        text = scene_mujoco(mechanism(seed))
        assembly = kilter.load(mujoco.MjModel.from_xml_string(text))
        verdict = kilter.check(assembly)
        assert kilter.verify(assembly, verdict.proof()).holds
        assert verdict.verdict in ("stable", "balanced", "unstable")
        reached = farthest(text)
        if verdict.verdict == "stable":
            assert verdict.level == "proved"
            assert reached < STAYS, seed
        else:
            assert reached > MOVES, seed


JUDGED = {0: "stable", 3: "stable", 6: "stable", 15: "stable", 11: "unstable", 13: "unstable"}
"""Scenes with a proved verdict; `benchmarks/tilted_in_mujoco.py` has 200 scenes."""
OPEN = (5, 12)
"""Scenes without a proved verdict."""


@pytest.mark.slow
@pytest.mark.parametrize("seed", [*JUDGED, *OPEN])
def test_a_proved_verdict_is_that_of_the_simulation(seed):
    found = outcome(seed)
    assert not found.wrong
    assert found.verdict == JUDGED.get(seed, "potentially-stable")
