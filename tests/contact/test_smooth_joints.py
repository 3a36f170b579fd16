"""Curved joints with different triangles on both sides: a patch with the normals of the face."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest
from curved_joints import JOINTS, blocks, exact_normals
from free_forms import oval_plug

import kilter
from kilter import Assembly, Part, Tolerance
from kilter.analysis.verdict.neutral import find_neutral
from kilter.contact.common.patches import PossibleContacts
from kilter.contact.smooth.smooth_faces import smooth_faces
from kilter.mechanics.program import build_program
from kilter.rigid import Pose
from kilter.scenes.pieces import turn
from sampled import sampled

SHARED = Path(__file__).resolve().parents[2].parent / "shared" / "data" / "compas_cra"
TOLERANCES = {"default": None, "gap": Tolerance(gap=2e-3), "loose": Tolerance.loose()}
EVERY = [(seed, "default") for seed in range(6)] + [
    ((seed + (tolerance == "loose")) % 6, tolerance)
    for seed in range(6)
    for tolerance in ("gap", "loose")
]
HOLDS = ("stable", "settles", "potentially-stable")


def made(seed, pose=None):
    """A random joint of the seed, its blocks, and its kind."""
    rng = np.random.default_rng(seed)
    kind = sorted(JOINTS)[seed % len(JOINTS)]
    joint = JOINTS[kind](rng)
    return joint, blocks(rng, joint, pose=pose), kind


def with_exact_normals(contacts, joint, pose):
    """The same points with the exact normals of the formula."""
    return dataclasses.replace(
        contacts,
        normals=exact_normals(joint, contacts.points, pose),
        patch_doubt=np.zeros(len(contacts)),
        patch_mu=np.full(len(contacts), contacts.assembly.friction),
        possible=PossibleContacts.none(),
        unsupported=(),
        open_pairs=(),
    )


@pytest.mark.slow
@pytest.mark.parametrize(("seed", "tolerance"), sampled(8, EVERY))
def test_one_patch_with_the_normals_of_the_face_whatever_the_tolerance(seed, tolerance):
    pose = Pose([3, 4, 5], turn([1, 2, 3], 40)) if seed % 2 else Pose()
    joint, assembly, _ = made(seed, pose)
    found = kilter.contacts(assembly, tolerance=TOLERANCES[tolerance])
    assert found.patch_kind.tolist() == ["smooth"]
    assert found.overlaps == ()
    off = np.linalg.norm(found.normals - exact_normals(joint, found.points, pose), axis=1)
    assert float(np.sqrt((off**2).mean())) <= float(found.patch_doubt[0])
    assert [one.kind for one in found.open_pairs] == ["free-form"]
    # the area of the joint: that of the upper block over the lower one
    x, y = (np.linspace(0, 1, 200)[:-1] + 0.5 / 199 for _ in range(2))
    slopes = joint.slope(*(grid.ravel() for grid in np.meshgrid(x, y)))
    exact = float(np.sqrt(1 + slopes[0] ** 2 + slopes[1] ** 2).mean())
    assert found.patch_area[0] == pytest.approx(exact, rel=0.02)


@pytest.mark.slow
@pytest.mark.parametrize("seed", sampled(3, 9))
def test_sliding_is_free_where_the_formula_says_so(seed):
    joint, assembly, kind = made(seed)
    found = kilter.contacts(assembly)
    neutral = find_neutral(build_program(assembly, found, fitted=True))
    exact = find_neutral(build_program(assembly, with_exact_normals(found, joint, Pose())))
    assert neutral == exact
    assert neutral.two_sided == (1 if joint.ruled else 0), kind


def census(seeds):
    """Verdicts with fitted and with exact normals, under randomly tilted gravity."""
    said = []
    for seed in seeds:
        joint, assembly, _ = made(seed)
        rng = np.random.default_rng(seed + 1000)
        for _ in range(3):
            mu = float(rng.choice([0.0, 0.1, 0.3]))
            lean, around = 0.6 * 10 ** rng.uniform(-3, 0), rng.uniform(0, 2 * np.pi)
            side = np.sin(lean) * np.array([np.cos(around), np.sin(around)])
            leant = assembly.with_friction(mu).with_down([*side, -np.cos(lean)])
            found = kilter.contacts(leant)
            exact = with_exact_normals(found, joint, Pose())
            pair = (kilter.check(leant, contacts=c, effort=0).verdict for c in (found, exact))
            said.append((seed, mu, lean, *pair))
    return said


def contradicts(one, other):
    return (one in HOLDS and other == "unstable") or (one == "unstable" and other in HOLDS)


@pytest.mark.slow
def test_fitted_normals_never_say_the_opposite_of_exact_ones():
    said = census(range(4))
    assert [row for row in said if contradicts(*row[-2:])] == []
    assert any(row[-2] == "unstable" for row in said)
    assert any(row[-2] in HOLDS for row in said)


@pytest.mark.slow
def test_facets_that_lie_on_each_other_stay_facets():
    """The same triangles on both sides: no surface is fitted, as a stone cutter would expect."""
    rng = np.random.default_rng(3)
    joint = JOINTS["saddle"](rng)
    assembly = blocks(rng, joint, alike=True)
    found = kilter.contacts(assembly)
    assert "smooth" not in found.patch_kind.tolist()
    assert found.patch_kind.tolist().count("plane") > 200
    assert not found.patch_doubt.any()


@pytest.mark.slow
@pytest.mark.parametrize(("lift", "touches"), [(0.0, True), (0.05, False), (-0.05, False)])
def test_faces_that_are_apart_or_enter_each_other_are_no_joint(lift, touches):
    rng = np.random.default_rng(1)
    assembly = blocks(rng, JOINTS["arc"](rng), lift=lift)
    found = kilter.contacts(assembly)
    assert ("smooth" in found.patch_kind.tolist()) == touches
    assert bool(found.overlaps) == (lift < 0)


@pytest.mark.slow
@pytest.mark.skipif(not SHARED.is_dir(), reason="the real assemblies are not here")
@pytest.mark.parametrize(
    "tolerance",
    sampled(1, [None, Tolerance.loose(), *(Tolerance(gap=gap) for gap in (1e-4, 1e-3, 5e-3))]),
    ids=["default", "loose", "1e-4", "1e-3", "5e-3"],
)
def test_curved_blocks_of_a_library_are_never_held_by_their_triangles(tolerance):
    """They slide along x below mu about .051, on the interfaces of the file."""
    assembly = kilter.load(SHARED / "curve-3-blocks.json").with_grounded(["0"])
    for mu in (0.0, 0.02, 0.03):
        verdict = kilter.check(assembly.with_friction(mu), tolerance=tolerance, effort=0)
        assert verdict.verdict in ("unstable", "undecided")
    verdict = kilter.check(assembly.with_friction(0.84), tolerance=tolerance, effort=0)
    assert verdict.verdict in HOLDS
    assert verdict.verdict != "stable"


@pytest.mark.slow
def test_recognition_ends_on_a_mesh_whose_facets_were_dropped_and_taken_in_again():
    """Seed 18: an arc of an ellipse, of which cylinders grew and shrank without end."""
    _, assembly, kind = made(18)
    assert kind == "arc"
    assert len(assembly.geometry.surfaces) == 0


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3))
def test_fitted_normals_are_off_by_less_than_their_doubt(seed):
    joint, assembly, _ = made(seed)
    for part in (0, 1):
        for face in smooth_faces(assembly.geometry, part, mesh=True):
            x, y, z = face.points.T
            if np.abs(z - joint.height(x, y)).max() > 1e-9:
                continue
            out = -1.0 if part else 1.0
            exact = out * exact_normals(joint, face.points, Pose())
            off = np.linalg.norm(face.normals - exact, axis=1)
            # at the corner of a face that one facet alone meets, too
            assert off.max() < max(face.doubt.max(), 1e-3)
            assert np.sqrt((off**2).mean()) < 0.5 * np.sqrt((face.doubt**2).mean())


@pytest.mark.parametrize("turned", [(1, 0, 0, 0), (0.5, 0.5, -0.5, 0.5), (0.8, 0.1, 0.3, 0.5)])
def test_normals_of_a_tall_prism_are_those_of_its_outline_however_it_is_turned(turned):
    plug = Part("plug", oval_plug(), Pose([1, 2, 3], np.array(turned) / np.linalg.norm(turned)))
    (face,) = smooth_faces(Assembly([plug]).geometry, 0, mesh=False)
    x, y, _ = ((face.points - plug.pose.position) @ plug.pose.matrix).T
    exact = np.column_stack([x / 2, 2 * y, 0 * x])
    exact /= np.linalg.norm(exact, axis=1)[:, None]
    off = np.linalg.norm(face.normals - exact @ plug.pose.matrix.T, axis=1)
    assert off.max() < 4e-3
    assert face.sagitta < 6e-3
