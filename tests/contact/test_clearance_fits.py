"""Round fits with play: open as drawn, size on size if `--clearance` closes them; walls."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from solids import (
    arc,
    bore,
    cone_frustum,
    cone_socket,
    extruded,
    line,
    peg,
    socket,
    torus,
    trough,
    with_scale,
)

from kilter import Assembly, Box, Part, Pose, Sphere, Tolerance, check
from kilter.contact import detect
from kilter.contact.curved.coaxial_faces import coaxial_fits
from kilter.contact.fits.suggestions import suggest_joints
from kilter.mechanics.program import build_program

G = 9.81
PLAY = 0.1
ALPHA = 0.4
LYING = [np.sqrt(0.5), np.sqrt(0.5), 0, 0]


def held(shape, pose=None):
    return Part("base", shape, pose or Pose(), grounded=True)


def found(*parts, clearance=None):
    return detect.contacts(Assembly(list(parts)), tolerance=Tolerance(clearance=clearance))


def motions(contacts):
    """Dimension of {J dp = 0}."""
    jacobian = build_program(contacts.assembly, contacts).jacobian().toarray()
    values = np.linalg.svd(jacobian, compute_uv=False)
    return jacobian.shape[1] - int((values > 1e-6 * values[0]).sum())


# name: base, part, the part size on size, where it stands apart, motions when closed
FITS = {
    "peg in hole": (bore(1 + PLAY), peg(), bore(1 + PLAY / 2), peg(1 + PLAY / 2), 2),
    "bar in groove": (trough(1 + PLAY), with_scale(peg(low=-0.9, high=0.9), 1.0),
                      trough(1 + PLAY / 2), peg(1 + PLAY / 2, -0.9, 0.9), 2),
    "ball in socket": (socket(1 + PLAY, rim=-0.2), Sphere(1.0),
                       socket(1 + PLAY / 2, rim=-0.2 * (1 + PLAY / 2) / (1 + PLAY)),
                       Sphere(1 + PLAY / 2), 3),
    "ball in hole": (bore(1 + PLAY), Sphere(1.0), bore(1 + PLAY / 2), Sphere(1 + PLAY / 2), 4),
    "ring in hole": (bore(2.5 + PLAY), torus(2.0, 0.5), bore(2.5), torus(2.0, 0.5), 4),
    "ring on shaft": (peg(1.5 - PLAY), torus(2.0, 0.5), peg(1.5), torus(2.0, 0.5), 4),
}  # fmt: skip


def turned(name):
    return LYING if name == "bar in groove" else (1, 0, 0, 0)


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", FITS)
def test_fit_with_play_is_open_and_says_by_how_much(name):
    base, part, *_ = FITS[name]
    contacts = found(held(base), Part("part", part, Pose([0, 0, 0], turned(name))))
    assert len(contacts) == 0
    assert contacts.overlaps == ()
    assert contacts.unsupported == ()
    (pair,) = contacts.open_pairs
    assert (pair.kind, pair.ends) == ("clearance", (0, 1))
    assert pair.gap == pytest.approx(PLAY, abs=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("name", FITS)
def test_clearance_as_wide_as_the_play_closes_the_fit_and_no_narrower_one_does(name):
    base, part, mean_base, mean_part, count = FITS[name]
    parts = held(base), Part("part", part, Pose([0, 0, 0], turned(name)))
    assert len(found(*parts, clearance=PLAY * (1 - 1e-9))) == 0
    closed = found(*parts, clearance=PLAY)
    assert len(closed) == 1
    assert closed.open_pairs == ()
    assert closed.patch_gap[0] == pytest.approx([PLAY, PLAY])
    named = [w for w in closed.warnings if "counted as closed" in w]
    assert len(named) == 1
    assert "'base' and 'part' (0.1 m)" in named[0]
    assert motions(closed) == count
    if "ring" in name:
        return  # of another mean radius
    true = found(held(mean_base), Part("part", mean_part, Pose([0, 0, 0], turned(name))))
    assert closed.patch_kind.tolist() == true.patch_kind.tolist()
    assert closed.points == pytest.approx(true.points, abs=1e-9)
    assert closed.normals == pytest.approx(true.normals, abs=1e-9)
    assert closed.patch_area == pytest.approx(true.patch_area, rel=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("free", ["peg", "base"])
def test_shaft_anywhere_in_its_hole_is_closed_about_the_axis_of_what_is_free(seed, free):
    # off by a and leaning by b over the half length 1 of the hole: inside while a + b < play
    rng = np.random.default_rng(seed)
    aside, lean = PLAY * rng.dirichlet([1, 1, 0.5])[:2] * 0.98
    way = rng.uniform(0, 2 * np.pi)
    out = np.array([np.cos(way), np.sin(way), 0])
    turn = Rotation.from_rotvec(np.arctan(lean) * np.cross([0, 0, 1], out))
    whole = Rotation.random(rng=rng)
    scale = 10.0 ** rng.uniform(-3, 3)
    shift = rng.normal(size=3) * scale
    poses = [(whole, shift), (whole * turn, shift + whole.apply(aside * scale * out))]
    shapes = [with_scale(bore(1 + PLAY), scale), with_scale(peg(), scale)]
    parts = [
        Part(name, shape, Pose(x, q.as_quat()[[3, 0, 1, 2]]), grounded=name != free)
        for name, shape, (q, x) in zip(("base", "peg"), shapes, poses, strict=True)
    ]
    rng.shuffle(parts)
    drawn = found(*parts)
    assert [p.kind for p in drawn.open_pairs] == ["clearance"]
    closed = found(*parts, clearance=PLAY * scale)
    assert closed.patch_kind.tolist() == ["cylinder"]
    assert motions(closed) == 2
    assert closed.overlaps == ()
    where, center = poses[1] if free == "peg" else poses[0]
    back = where.inv().apply(closed.points - center) / scale
    assert np.hypot(*back[:, :2].T) == pytest.approx(np.full(len(back), 1 + PLAY / 2), abs=1e-9)
    # across the axis it is held, through the centre of mass on it; along the axis it slides
    across, along = where.apply([[0.6, 0.8, 0], [0, 0, 1.0]])
    for gravity, word in ((across, "stable"), (along, "unstable")):
        verdict = check(
            Assembly(parts, gravity=G * gravity), tolerance=Tolerance(clearance=PLAY * scale)
        )
        assert verdict.verdict == word


@pytest.mark.slow
@pytest.mark.parametrize("aside", [PLAY + 1e-3, PLAY + 0.05])
def test_peg_that_cuts_into_its_hole_is_an_overlap_whatever_the_clearance(aside):
    for clearance in (None, PLAY, 2 * PLAY):
        contacts = found(
            held(bore(1 + PLAY)), Part("peg", peg(), Pose([aside, 0, 0])), clearance=clearance
        )
        assert len(contacts) == 0
        assert [p.kind for p in contacts.open_pairs] == ["overlap"]


@pytest.mark.slow
def test_peg_that_lies_in_its_hole_touches_along_a_line_and_is_not_open():
    parts = held(bore(1 + PLAY)), Part("peg", peg(), Pose([PLAY, 0, 0]))
    contacts = found(*parts)
    assert contacts.open_pairs == ()
    assert len(contacts.points) == 2
    assert motions(found(*parts, clearance=PLAY)) == 2


@pytest.mark.parametrize(("share", "kinds"), [(0.19, ["clearance"]), (0.21, [])])
def test_hole_that_is_much_wider_is_no_fit(share, kinds):
    contacts = found(held(bore(1 + share)), Part("peg", peg()))
    assert [p.kind for p in contacts.open_pairs] == kinds


# tapers and single points -------------------------------------------------------------------

APART = {
    "cone in cone": (cone_socket(ALPHA), cone_frustum(ALPHA), [0, 0, 0.1], np.sin(ALPHA), 1),
    "ball in cone": (cone_socket(ALPHA), Sphere(0.6), [0, 0, 0.6 / np.sin(ALPHA) + 0.1],
                     np.sin(ALPHA), 3),
    "ball on slab": (Box([4, 4, 1]), Sphere(1.0), [0, 0, 1.6], 1.0, 5),
    "bar on slab": (Box([4, 4, 1]), peg(), [0, 0, 1.6], 1.0, 4),
    "ball on ball": (Sphere(1.0), Sphere(0.5), [0, 0, 1.6], 1.0, 5),
}  # fmt: skip


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", APART)
def test_round_faces_that_stand_apart_are_closed_up_to_the_clearance(name):
    base, part, place, rate, count = APART[name]
    pose = Pose(place, LYING if name == "bar on slab" else (1, 0, 0, 0))
    parts = held(base), Part("part", part, pose)
    assert len(found(*parts, clearance=0.1 * rate * 0.99)) == 0
    closed = found(*parts, clearance=0.1 * rate * 1.01)
    assert len(closed) == 1
    assert motions(closed) == count
    assert any("'base' and 'part'" in w for w in closed.warnings)


# walls and angular ranges -------------------------------------------------------------------


def test_shells_on_one_axis_that_do_not_meet_do_not_interfere():
    # a shaft of radius 1 would fill the hole of .95; but the one ends at .98, the other at .97
    outer, inner = bore(0.98, outer=1.0), bore(0.95, outer=0.97)
    contacts = found(held(inner), Part("outer", outer))
    assert contacts.overlaps == ()
    assert [p.kind for p in contacts.open_pairs] == ["clearance"]


@pytest.mark.slow
@pytest.mark.parametrize("deep", [0.002, 0.01])
def test_shells_on_one_axis_that_meet_interfere_as_deep_as_both_walls_reach(deep):
    outer, inner = bore(0.98, outer=1.0), bore(0.95, outer=0.98 + deep)
    contacts = found(held(inner), Part("outer", outer))
    (overlap,) = contacts.overlaps
    assert overlap.depth == pytest.approx(deep, rel=1e-6)


def half_shell(inner, outer, *, upper):
    """Half a tube about y, above or below the plane through its axis."""
    start, end = (1.0, -1.0) if upper else (-1.0, 1.0)
    inside = arc((0, 0), (end * inner, 0), (start * inner, 0), 16, left=False)
    outside = arc((0, 0), (start * outer, 0), (end * outer, 0), 16, left=True)
    rim, far = line((start * outer, 0), (end * inner, 0))
    return extruded([inside[-1], rim, *outside, far, *inside[:-1]], 3.0)


def test_half_shells_on_either_side_of_their_axis_do_not_interfere():
    # a solid of 1.05 over a hole of 1.0: on one axis, at one height, at other angles
    parts = [
        held(half_shell(1.0, 1.2, upper=True)),
        Part("lower", half_shell(0.9, 1.05, upper=False)),
    ]
    contacts = found(*parts)
    assert set(contacts.patch_kind) == {"plane"}
    assert contacts.overlaps == ()
    assert contacts.open_pairs == ()
    assembly = contacts.assembly
    assert coaxial_fits(assembly, [(0, 1)], Tolerance()) == []
    assert suggest_joints(assembly, contacts) == []


@pytest.mark.parametrize("degrees", [1.0, 20.0])
def test_half_shells_that_are_turned_into_each_other_interfere(degrees):
    turn = Rotation.from_euler("y", degrees, degrees=True).as_quat()[[3, 0, 1, 2]]
    parts = [
        held(half_shell(1.0, 1.2, upper=True)),
        Part("lower", half_shell(0.9, 1.05, upper=False), Pose([0, 0, 0], turn)),
    ]
    contacts = found(*parts)
    assert [p.kind for p in contacts.open_pairs] == ["overlap"]
    (overlap,) = contacts.overlaps
    # a wedge of the ring between 1.0 and 1.05
    assert overlap.volume == pytest.approx(np.radians(degrees) / 2 * (1.05**2 - 1) * 3, rel=0.2)
