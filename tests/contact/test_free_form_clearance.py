"""Free forms that stand apart: open as drawn, closed by a clearance with the faces' normals."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from curved_joints import JOINTS, blocks, exact_normals
from free_forms import as_solids, oval_hole, oval_plug
from scipy.spatial.transform import Rotation

from kilter import Assembly, Part, Pose, Tolerance, check
from kilter.contact import detect
from kilter.contact.common.patches import PossibleContacts

PLAY = 0.05
HOLDS = ("stable", "settles", "potentially-stable")
WIDE = Tolerance(clearance=1.02 * PLAY)


def fit(pose=None, at=(0.0, 0.0, 0.0), *, sides=(60, 48)):
    """An oval plug in a hole that is wider by the play all around."""
    pose = pose or Pose()
    moved = Pose(pose.apply([at])[0], pose.rotation)
    hole = oval_hole(sides[0], out=PLAY)
    return Assembly(
        [
            Part("hole", hole, pose, grounded=True),
            Part("plug", oval_plug(sides[1], phase=0.03), moved),
        ]
    )


def oval_normals(points, pose):
    """Unit normals of the ellipse half-way between plug and hole, from the hole to the plug."""
    x, y = ((points - pose.position) @ pose.matrix)[:, :2].T
    around = np.arctan2(y / 1.0, x / 2.0)
    for _ in range(50):  # the foot of the point on the ellipse, by Newton
        c, s = np.cos(around), np.sin(around)
        slope = (2 * c - x) * -2 * s + (s - y) * c
        bend = 4 * s * s - (2 * c - x) * 2 * c + c * c - (s - y) * s
        around = around - slope / bend
    normal = np.column_stack([np.cos(around), 2 * np.sin(around), 0 * around])
    return -(normal / np.linalg.norm(normal, axis=1)[:, None]) @ pose.matrix.T


def with_normals(contacts, normals):
    """The same points with exact normals."""
    return dataclasses.replace(
        contacts,
        normals=normals,
        patch_doubt=np.zeros(len(contacts)),
        patch_mu=np.full(len(contacts), contacts.assembly.friction),
        possible=PossibleContacts.none(),
        unsupported=(),
        open_pairs=(),
    )


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(2))
def test_plug_in_a_wider_oval_is_closed_by_the_clearance_and_by_no_narrower_one(seed):
    rng = np.random.default_rng(seed)
    turn = Rotation.random(rng=rng).as_quat()[[3, 0, 1, 2]] if seed else [1, 0, 0, 0]
    pose = Pose(rng.normal(size=3) * bool(seed), turn)
    drawn = detect.contacts(fit(pose))
    assert (len(drawn), drawn.overlaps) == (0, ())
    narrow = detect.contacts(fit(pose), tolerance=Tolerance(clearance=0.8 * PLAY))
    assert len(narrow) == 0
    assert [pair.kind for pair in narrow.open_pairs] == ["free-form"]
    closed = detect.contacts(fit(pose), tolerance=WIDE)
    assert closed.patch_kind.tolist() == ["smooth"]
    assert closed.overlaps == ()
    low, high = closed.patch_gap[0]
    assert PLAY * 0.98 < low <= high < PLAY * 1.02
    off = np.linalg.norm(closed.normals - oval_normals(closed.points, pose), axis=1)
    assert float(np.sqrt((off**2).mean())) <= float(closed.patch_doubt[0])
    # the common side of both: that of the ellipse half-way, and the height of the plug
    t = np.linspace(0, 2 * np.pi, 4000, endpoint=False)
    outline = np.hypot(2 * np.sin(t), np.cos(t)).mean() * 2 * np.pi + np.pi * PLAY
    assert closed.patch_area[0] == pytest.approx(2 * outline, rel=0.01)
    (told,) = (word for word in closed.warnings if "counted as closed" in word)
    assert "'hole' and 'plug'" in told


@pytest.mark.slow
@pytest.mark.parametrize("across", [(0.3, 0.8)])
def test_what_pushes_across_a_closed_oval_is_held_as_the_exact_normals_hold_it(across):
    pulled = dataclasses.replace(fit(), gravity=9.81 * np.array([*across, 0.0]))
    assert check(pulled.with_friction(0.3)).verdict == "unstable"
    for mu, fitted in ((0.0, "undecided"), (0.3, "potentially-stable")):
        leant = pulled.with_friction(mu)
        found = detect.contacts(leant, tolerance=WIDE)
        assert check(leant, contacts=found, effort=0).verdict == fitted
        exact = with_normals(found, oval_normals(found.points, Pose()))
        assert check(leant, contacts=exact, effort=0).verdict in HOLDS
    assert "friction above" in check(pulled, tolerance=WIDE).sentence


@pytest.mark.slow
@pytest.mark.parametrize("kind", JOINTS)
def test_closed_joints_never_say_the_opposite_of_exact_normals(kind):
    said = []
    for seed in range(2):
        rng = np.random.default_rng(seed)
        joint = JOINTS[kind](rng)
        assembly = as_solids(blocks(rng, joint, lift=PLAY), sagitta=5e-3)
        assert len(detect.contacts(assembly)) == 0
        for lean in (0.02, 0.3, 0.8):
            down = [np.sin(lean), 0.3 * np.sin(lean), -np.cos(lean)]
            leant = assembly.with_friction(0.1).with_down(down)
            found = detect.contacts(leant, tolerance=WIDE)
            assert found.patch_kind.tolist() == ["smooth"]
            exact = with_normals(found, exact_normals(joint, found.points, Pose()))
            said.append([check(leant, contacts=c, effort=0).verdict for c in (found, exact)])
    assert not any(
        (one in HOLDS and other == "unstable") or (one == "unstable" and other in HOLDS)
        for one, other in said
    )
    assert {"unstable", "potentially-stable"} <= {one for one, _ in said}


@pytest.mark.slow
def test_faces_that_enter_each_other_are_closed_by_no_clearance():
    rng = np.random.default_rng(1)
    assembly = as_solids(blocks(rng, JOINTS["arc"](rng), lift=-PLAY), sagitta=5e-3)
    found = detect.contacts(assembly, tolerance=WIDE)
    assert "smooth" not in found.patch_kind.tolist()
    assert [pair.kind for pair in found.open_pairs] == ["overlap"]
