"""Free forms: joints and clearances with fitted normals, beside exact ones."""

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from solids import JOINTS, as_solids, blocks, exact_normals, oval_hole, oval_plug

import kilter
from kilter import Assembly, Part, Tolerance, check
from kilter.analysis.verdict.neutral import find_neutral
from kilter.analysis.verification import verify
from kilter.contact import detect
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
    assert neutral.to_dict() == exact.to_dict()
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


LEANT = [0.1, 0.05, -1.0]


def both(seed, mu):
    """An assembly on a curved joint; its detected contacts, and those with the exact normals."""
    joint, assembly, _ = made(seed)
    assembly = assembly.with_friction(mu)
    found = kilter.contacts(assembly)
    return assembly, found, with_exact_normals(found, joint, Pose())


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2])
def test_without_friction_no_direction_is_called_stable(seed):
    assembly, found, exact = both(seed, 0.0)
    region = kilter.region(assembly, contacts=found)
    assert region.kind == "none"
    assert not region.exact
    assert not region.none
    assert any("'below' and 'above'" in text for text in region.warnings)
    assert kilter.orient(assembly, contacts=found).verdict == "undecided"
    # one number flipped: normals in no doubt
    assert kilter.region(assembly, contacts=exact).kind in ("fan", "cone")
    assert kilter.orient(assembly, contacts=exact).found


@pytest.mark.slow
@pytest.mark.parametrize("seed", [2, 4])
def test_the_least_friction_is_that_of_exact_normals_and_their_doubt_more(seed):
    assembly, found, exact = both(seed, 0.0)
    leant, doubt = assembly.with_down(LEANT), float(found.patch_doubt.max())
    margin = kilter.margin(leant, contacts=found)
    assert margin.tilt_deg is None
    assert not margin.to_dict()["exact"]
    assert any("'below' and 'above'" in text for text in margin.warnings)
    true = kilter.margin(leant, contacts=exact).friction
    assert true < margin.friction < true + 2.5 * doubt
    proof = json.loads(json.dumps(margin.proof()))
    assert "friction" in {entry["about"] for entry in proof["proofs"] if entry["held"]}
    assert verify(leant, proof).holds


@pytest.mark.slow
@pytest.mark.parametrize("seed", [2, 4])
@pytest.mark.parametrize("above", [False, True])
def test_a_contact_counts_where_friction_is_above_its_doubt(seed, above):
    _, assembly, _ = made(seed)
    doubt = float(kilter.contacts(assembly).patch_doubt.max())
    assembly = assembly.with_friction(doubt * (1.01 if above else 0.99))
    found = kilter.contacts(assembly)
    assert bool(len(build_program(assembly, found).kind)) == above
    assert len(build_program(assembly, found, fitted=True).kind) == len(found.points)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3))
def test_with_friction_what_is_held_is_held_with_exact_normals(seed):
    assembly, found, exact = both(seed, 0.3)
    doubt = float(found.patch_doubt.max())
    fitted, true = (kilter.region(assembly, contacts=c) for c in (found, exact))
    assert not fitted.exact
    assert true.contains(fitted.rays, margin=-doubt).all()
    less = kilter.region(assembly, contacts=exact.with_friction(0.3 - 3 * doubt))
    assert fitted.contains(less.rays, margin=-doubt).all()
    proof = json.loads(json.dumps(fitted.proof()))
    assert verify(assembly, proof).holds


@pytest.mark.slow
@pytest.mark.skipif(not SHARED.is_dir(), reason="the real assemblies are not here")
def test_curved_blocks_of_a_library_have_no_direction_without_friction():
    """On the interfaces of their file they slide along x below mu about .051."""
    assembly = kilter.load(SHARED / "curve-3-blocks.json").with_grounded(["0"]).with_friction(0)
    found = kilter.contacts(assembly)
    assert kilter.region(assembly, contacts=found).kind == "none"
    assert kilter.orient(assembly, contacts=found).verdict == "undecided"
    margin = kilter.margin(assembly, contacts=found)
    assert margin.tilt_deg is None
    assert not margin.to_dict()["exact"]
    assert margin.friction is not None
    assert margin.friction > 0.03
    assert np.all(found.patch_doubt > 0)


PLAY = 0.05
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
