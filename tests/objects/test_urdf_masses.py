"""Mass, centre and inertia of URDF links: against MuJoCo's reader, and in the answers."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from judged import random_turn

import kilter
from kilter.contact import contacts
from kilter.mechanics.merged_parts import merge_parts
from kilter.mechanics.program import build_program
from kilter.rigid import Pose

BOX = '<collision><geometry><box size="{size}"/></geometry></collision>'


def words(values: object) -> str:
    return " ".join(f"{value:.17g}" for value in np.ravel(np.asarray(values, dtype=float)))


def origin(rng: np.random.Generator) -> str:
    return f'<origin xyz="{words(rng.normal(size=3))}" rpy="{words(rng.uniform(-1.5, 1.5, 3))}"/>'


def inertial(rng: np.random.Generator) -> str:
    """A random mass at a random place, with the inertia of a random body."""
    mass, second = rng.uniform(0.1, 20), np.diag(rng.uniform(0.01, 1, 3))
    turn = Pose([0, 0, 0], random_turn(rng)).matrix
    i = turn @ (np.trace(second) * np.eye(3) - second) @ turn.T
    six = {"ixx": i[0, 0], "ixy": i[0, 1], "ixz": i[0, 2], "iyy": i[1, 1], "iyz": i[1, 2],
           "izz": i[2, 2]}  # fmt: skip
    tensor = " ".join(f'{key}="{value:.17g}"' for key, value in six.items())
    return f'<inertial>{origin(rng)}<mass value="{mass:.17g}"/><inertia {tensor}/></inertial>'


def random_robot(seed: int) -> tuple[str, dict[str, str]]:
    """A robot that floats, and the top link of the group under fixed joints of each link."""
    rng = np.random.default_rng(seed)
    top = {"base": "base"}
    text = ['<link name="world"/>']
    text.append(
        '<joint name="j" type="floating"><parent link="world"/><child link="base"/></joint>'
    )
    for k in range(7):
        name = f"link-{k}" if k else "base"
        kind = str(rng.choice(["fixed", "fixed", "revolute", "prismatic"]))
        parent = str(rng.choice(list(top)))
        shape = BOX.format(size=words(rng.uniform(0.1, 1, 3)))
        bare = k > 0 and kind == "fixed" and rng.random() < 0.5
        text.append(f'<link name="{name}">{inertial(rng)}{"" if bare else shape}</link>')
        if k:
            text.append(
                f'<joint name="j{k}" type="{kind}"><parent link="{parent}"/><child link="{name}"/>'
                f'{origin(rng)}<axis xyz="0 0 1"/><limit lower="-1" upper="1"/></joint>'
            )
            top[name] = top[parent] if kind == "fixed" else name
    return f'<robot name="r">{"".join(text)}</robot>', top


@pytest.mark.quick(2)
@pytest.mark.parametrize("seed", range(30))
def test_bodies_have_the_masses_that_mujoco_reads(seed: int, tmp_path: Path) -> None:
    """Links joined by fixed joints are one body of MuJoCo: mass, centre and inertia to 1e-9."""
    mujoco = pytest.importorskip("mujoco")
    text, top = random_robot(seed)
    (tmp_path / "r.urdf").write_text(text)
    assembly = kilter.load(tmp_path / "r.urdf", base="floating")
    tops = sorted(set(top.values()))
    program = build_program(assembly, contacts(assembly))
    groups = [tops.index(top[name]) for name in assembly.names]
    merged = merge_parts(program, np.array(groups))
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    assert model.nbody == len(tops) + 1
    for k, name in enumerate(tops):
        body = model.body(name).id
        axes = data.ximat[body].reshape(3, 3)
        inertia = axes @ np.diag(model.body_inertia[body]) @ axes.T
        assert merged.mass[k] == pytest.approx(model.body_mass[body], rel=1e-9)
        assert np.allclose(merged.center[k], data.xipos[body], rtol=0, atol=1e-9)
        assert np.allclose(merged.inertia[k], inertia, rtol=0, atol=1e-9 * np.abs(inertia).max())


JOINT = (
    '<joint name="{child}" type="{kind}"><parent link="{parent}"/><child link="{child}"/></joint>'
)
MASS = '<inertial><mass value="2"/>{}</inertial>'


@pytest.mark.parametrize(
    ("inertia", "words"),
    [
        ('<inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/>', []),
        ('<inertia ixx="1" iyy="1" izz="3"/>', ["no body has the inertia of 'a', so that of its"]),
        ('<inertia ixx="-1" iyy="1" izz="1"/>', ["no body has the inertia of 'a', so that of its"]),
    ],
)
def test_an_inertia_that_no_body_has_is_replaced_by_that_of_the_shape(
    tmp_path: Path, inertia: str, words: list[str]
) -> None:
    path = tmp_path / "r.urdf"
    path.write_text(
        f'<robot><link name="a">{MASS.format(inertia)}{BOX.format(size="1 1 1")}</link></robot>'
    )
    found = kilter.load(path, base="floating")
    assert np.allclose(found.geometry.inertia[0], np.eye(3) / 3)
    assert [note[: len(word)] for note, word in zip(found.notes, words, strict=True)] == words


def test_links_fixed_to_a_frame_without_a_shape_are_one_body(tmp_path: Path) -> None:
    """Two boxes and a mass on a frame that floats; a mass that turns without a shape is named."""
    box = BOX.format(size="1 1 1")
    path = tmp_path / "r.urdf"
    path.write_text(
        "<robot>"
        + '<link name="frame"/>'
        + "".join(f'<link name="{name}">{MASS.format("")}{box}</link>' for name in "ab")
        + "".join(f'<link name="{name}">{MASS.format("")}</link>' for name in ("load", "rotor"))
        + "".join(JOINT.format(child=n, kind="fixed", parent="frame") for n in ("a", "b", "load"))
        + JOINT.format(child="rotor", kind="continuous", parent="a")
        + "</robot>"
    )
    floating = kilter.load(path, base="floating")
    assert [joint.parts for joint in floating.joints] == [("b", "a")]
    assert [part.mass for part in floating] == [4.0, 2.0]
    assert floating.notes == ("no shape moves with these links, so their mass is ignored: 'rotor'",)
    held = kilter.load(path)
    assert [joint.parts for joint in held.joints] == [("a", "ground"), ("b", "ground")]
    assert [part.mass for part in held] == [2.0, 2.0]
