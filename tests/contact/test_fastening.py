"""Fastening of touching parts, fits of shafts in holes, closed clearances, overlap volumes."""

import dataclasses
import json
import shlex

import numpy as np
import pytest
from solids import pin
from transformations import scaled

from kilter import InputError, Tolerance, check, fastened
from kilter.analysis.verification import proof_tolerance, verify_proof
from kilter.assembly import Assembly, Joint, Part
from kilter.cli import main
from kilter.contact import detect
from kilter.contact.common.distances import PartSolids
from kilter.contact.curved.coaxial_faces import coaxial_fits
from kilter.contact.fits.suggestions import suggest_joints
from kilter.contact.overlap import shared_body
from kilter.files import dump, from_dict, to_dict
from kilter.mechanics.proof import digest_of
from kilter.rigid import Pose
from kilter.scenes.pieces import block, floor, moved, tube, turn
from kilter.shape.primitives import Box, Cylinder, Mesh, Prism, Sphere, surface
from round_meshes import revolved

FLOOR = floor([-5, -5], [5, 5])


def stack(gap=0.0, **options):
    """A post on the floor, an arm that reaches out to its side, `gap` from its face."""
    post = block("post", [-1, -1, 0], [1, 1, 4], mass=10.0)
    arm = block("arm-1", [1 + gap, -0.5, 3], [3 + gap, 0.5, 4], mass=1.0)
    far = block("arm-2", [4, -0.5, 3], [4.9, 0.5, 4], mass=1.0)
    return Assembly([FLOOR, post, arm, far], **options)


# fastening --------------------------------------------------------------------------------


def test_matching_parts_that_touch_are_fixed_and_no_others():
    joined = fastened(stack(), [("post", "arm-*")])
    assert [(j.parts, j.kind) for j in joined.joints] == [(("post", "arm-1"), "fixed")]
    verdict = check(joined)
    assert verdict.moving == ["arm-2"]
    assert check(stack()).moving == ["arm-1", "arm-2"]


def test_globs_match_no_held_part_and_names_in_full_do():
    every = fastened(stack(), [("*", "*")])
    assert [set(j.parts) for j in every.joints] == [{"post", "arm-1"}]
    assert every.notes == (
        "wildcards match no held part: nothing is fastened to 'floor'; name it in full where it "
        "should be",
    )
    named = fastened(stack(), [("floor", "*")])
    assert [j.parts for j in named.joints] == [("floor", "post")]
    assert named.notes == ()
    with pytest.raises(InputError, match="'f\\*r' matches only held parts: 'floor'; name"):
        fastened(stack(), [("f*r", "post")])


@pytest.mark.parametrize("given", [None, 0.0])
def test_a_body_whose_centre_is_beyond_its_foot_falls_whatever_globs_join(given):
    """A foot and an arm whose centre of mass is beside the foot, on a table put under them."""
    foot = block("foot", [0, 0, 0], [1, 1, 1])
    arm = block("arm", [0, 0, 1], [9, 1, 2])
    both = Assembly([foot, arm]).with_floor(given)
    assert both.parts[-1].table
    joined = fastened(both, [("*", "*")])
    assert [j.parts for j in joined.joints] == [("foot", "arm")]
    assert joined.notes == ()
    assert check(joined).verdict == "unstable"
    over = fastened(
        Assembly([foot, block("arm", [0, 0, 1], [1.9, 1, 2])]).with_floor(), [("*", "*")]
    )
    assert check(over).verdict == "stable"
    # who means it says it
    assert check(fastened(joined, [("foot", "floor")])).verdict == "stable"


def test_order_and_repetition_change_nothing():
    first = fastened(stack(), [("post", "arm-1"), ("arm-1", "post"), ("arm-?", "p*")])
    assert [j.parts for j in first.joints] == [("post", "arm-1")]
    assert fastened(stack(), [("arm-1", "post")]).joints[0].parts == ("arm-1", "post")
    again = fastened(first, [("post", "arm-1")])
    assert len(again.joints) == 1
    hinge = stack(joints=[Joint(("post", "arm-1"), "spherical", [1, 0, 3.5])])
    assert len(fastened(hinge, [("post", "arm-1")]).joints) == 2


def test_nothing_that_touches_is_said_with_how_near_it_comes():
    with pytest.raises(InputError, match=r"'post' 'arm-2'.*none touches any of 'arm-2'; see"):
        fastened(stack(), [("post", "arm-2")])
    with pytest.raises(
        InputError, match=r"come within 0\.0001 m; give a tolerance of more gap or clearance"
    ):
        fastened(stack(1e-4), [("post", "arm-1")])
    near = fastened(stack(1e-4), [("post", "arm-1")], tolerance=Tolerance(clearance=2e-4))
    assert len(near.joints) == 1


def test_glob_that_matches_nothing_names_the_nearest():
    with pytest.raises(InputError, match="no part is named 'pots'; did you mean 'post'"):
        fastened(stack(), [("pots", "arm-*")])
    with pytest.raises(InputError, match="no part is named 'arms-"):
        fastened(stack(), [("post", "arms-*")])
    with pytest.raises(InputError, match="does not have two names"):
        fastened(stack(), [("post",)])


def test_overlapping_parts_can_be_fastened():
    inside = Assembly([FLOOR, *stack().parts[1:2], block("key", [0.5, -0.2, 1], [1.5, 0.2, 2])])
    assert [j.parts for j in fastened(inside, [("key", "post")]).joints] == [("key", "post")]


# fits of shafts in holes ------------------------------------------------------------------


def bolted(radius, *, turned=False, name="sleeve"):
    """A pin of a radius in a bore of 1, whose tube stands on the floor."""
    parts = [
        block("table", [-9, -9, -3], [9, 9, -2], grounded=True),
        tube(name, 1.0, 2.0, 4.0),
        pin("bolt", radius, 6.0, [0, 0, 3]),
    ]
    assembly = Assembly(parts)
    if turned:
        assembly = moved(assembly, turn([1, 2, 3], 77), [3, 1, 4])
    return assembly


@pytest.mark.slow
@pytest.mark.parametrize("turned", [False, True])
def test_thicker_shaft_is_an_interference_fit(turned):
    assembly = bolted(1.02, turned=turned)
    fits = coaxial_fits(assembly, [(1, 2)], Tolerance())
    assert len(fits) == 1
    fit = fits[0]
    assert fit.ends == (2, 1)
    assert fit.tight
    assert fit.interference == pytest.approx(0.02, rel=1e-9)
    assert fit.length == pytest.approx(2.0, rel=1e-9)
    found = detect.contacts(assembly)
    named = [overlap for overlap in found.overlaps if set(overlap.ends) == {1, 2}]
    assert [overlap.why for overlap in named] == ["interfere"]
    assert any("interfere" in text for text in found.warnings)
    suggestion = suggest_joints(assembly, found)[0]
    assert suggestion.parts == ("bolt", "sleeve")
    assert suggestion.option == "--fasten bolt sleeve"
    assert suggestion.joint == {"parts": ["bolt", "sleeve"], "kind": "fixed"}
    joined = fastened(assembly, [("bolt", "sleeve")], contacts=found)
    assert suggest_joints(joined, found) == []
    assert not any("interfere" in text for text in found.of(joined).warnings)


@pytest.mark.parametrize("turned", [False, True])
def test_shaft_as_thick_as_its_hole_turns_and_slides(turned):
    assembly = bolted(1.0, turned=turned)
    suggestions = suggest_joints(assembly, detect.contacts(assembly))
    assert [one.parts for one in suggestions] == [("bolt", "sleeve")]
    entry = suggestions[0].joint
    assert entry["kind"] == "cylindrical"
    bolt = assembly.parts[2].pose
    assert np.allclose(np.abs(np.array(entry["axis"]) @ bolt.matrix[:, 2]), 1.0)
    # the joint can be pasted
    data = to_dict(assembly)
    pasted = dataclasses.replace(assembly, joints=[Joint(**entry)])
    assert pasted.joints[0].kind == "cylindrical"
    assert data["parts"][0]["name"] == "table"


@pytest.mark.parametrize(
    ("radius", "tolerance", "fits"),
    [
        (1.0 - 1e-5, Tolerance(gap=2e-5), True),
        (1.0 - 1e-5, Tolerance(gap=0.5e-5), False),
        (0.9, Tolerance(gap=1e-5), False),
        (0.9, Tolerance(gap=1e-5, clearance=0.11), True),
        (1.09, Tolerance(), True),
        (1.2, Tolerance(), False),
    ],
)
def test_fits_on_both_sides_of_their_limits(radius, tolerance, fits):
    assert bool(coaxial_fits(bolted(radius), [(1, 2)], tolerance)) == fits


def test_shafts_beside_askew_or_short_of_a_hole_are_no_fits():
    nut = tube("nut", 1.0, 2.0, 4.0, grounded=True)
    for at, rotation in (([0.01, 0, 0], [1, 0, 0, 0]), ([0, 0, 0], turn([1, 0, 0], 1.0))):
        bolt = Part("bolt", pin("x", 1.0, 6.0).shape, Pose(at, rotation))
        assert coaxial_fits(Assembly([nut, bolt]), [(0, 1)], Tolerance()) == []
    above = pin("bolt", 1.0, 6.0, [0, 0, 5.0])
    assert coaxial_fits(Assembly([nut, above]), [(0, 1)], Tolerance()) == []


# clearances -------------------------------------------------------------------------------


def resting(height, units="m"):
    return Assembly([FLOOR, block("box", [0, 0, height], [1, 1, 1 + height])], units=units)


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    ("height", "word"),
    [(0.0, "stable"), (0.9e-3, "stable"), (1.1e-3, "undecided"), (-0.9e-3, "undecided")],
)
def test_clearance_closes_gaps_up_to_it_and_no_penetration(height, word):
    tolerance = Tolerance(clearance=1e-3)
    assert check(resting(height), tolerance=tolerance).verdict == word
    # without it, only what touches
    plain = "stable" if height == 0 else "undecided"
    assert check(resting(height)).verdict == plain


def test_closed_pairs_are_named_with_their_gaps():
    found = detect.contacts(resting(0.9e-3), tolerance=Tolerance(clearance=1e-3))
    closing = [text for text in found.warnings if "clearances counted as closed" in text]
    assert len(closing) == 1
    assert "'floor' and 'box' (0.0009 m)" in closing[0]
    touching = detect.contacts(resting(0.0), tolerance=Tolerance(clearance=1e-3))
    assert not any("clearances" in text for text in touching.warnings)
    for bad in (0.0, -1.0, float("nan")):
        with pytest.raises(InputError, match="clearance"):
            detect.contacts(resting(0.0), tolerance=Tolerance(clearance=bad))


def test_clearance_wider_than_what_is_looked_at_is_found():
    assembly = resting(0.3)
    assert check(assembly, tolerance=Tolerance(clearance=0.31)).verdict == "stable"
    assert check(assembly, tolerance=Tolerance(clearance=0.29)).verdict == "unstable"
    for factor in (1e-3, 1e3):
        tolerance = Tolerance(clearance=0.31 * factor)
        turned = moved(scaled(assembly, factor), turn([1, 2, 3], 50), [1, 2, 3])
        assert check(turned, tolerance=tolerance).verdict == "stable"


@pytest.mark.slow
def test_clearance_is_part_of_the_proof():
    verdict = check(resting(0.9e-3), tolerance=Tolerance(clearance=1e-3))
    proof = verdict.proof()
    tolerance = proof_tolerance(proof)
    assert tolerance.clearance == 1e-3
    copy = from_dict(to_dict(resting(0.9e-3)))
    assert verify_proof(copy, detect.contacts(copy, tolerance=tolerance), proof).holds
    for other in (None, 0.5e-3):
        proof["tolerance"]["clearance"] = other
        proof["digest"] = digest_of(proof)
        changed = proof_tolerance(proof)
        assert not verify_proof(copy, detect.contacts(copy, tolerance=changed), proof).holds


# clusters of gaps -------------------------------------------------------------------------


@pytest.mark.quick(6)
@pytest.mark.parametrize(
    ("gaps", "warned"),
    [
        ((0.5e-3, 2e-3), True),  # on both sides of 1e-3, near it
        ((0.9e-3, 0.95e-3), False),  # all below
        ((1.1e-3, 2e-3), False),  # all above
        ((0.1e-3, 2e-3), False),  # the lower one far below
        ((0.5e-3, 4e-3), False),  # the upper one far above
        ((-0.5e-3, -2e-3), True),  # penetrations are gaps too
        ((-0.1e-3, -2e-3), False),
    ],
)
def test_warning_where_the_tolerance_falls_inside_a_cluster(gaps, warned):
    boxes = [
        block(f"box-{k}", [2.0 * k, 0, gap], [2.0 * k + 1, 1, 1 + gap])
        for k, gap in enumerate(gaps)
    ]
    found = detect.contacts(Assembly([FLOOR, *boxes]), tolerance=Tolerance(gap=1e-3))
    assert any("falls inside a cluster" in text for text in found.warnings) == warned


@pytest.mark.parametrize(("upper", "warned"), [(2e-2, True), (4e-2, False)])
def test_cluster_at_a_clearance_is_named_after_it(upper, warned):
    boxes = [
        block(f"box-{k}", [2.0 * k, 0, gap], [2.0 * k + 1, 1, 1 + gap])
        for k, gap in enumerate((0.5e-2, upper))
    ]
    found = detect.contacts(Assembly([FLOOR, *boxes]), tolerance=Tolerance(clearance=1e-2))
    told = [text for text in found.warnings if "falls inside a cluster" in text]
    assert bool(told) == warned
    assert all("set the clearance" in text for text in told)


# volumes ----------------------------------------------------------------------------------


def volume_of(one, other):
    return shared_body(PartSolids(Assembly([one, other]).geometry), 0, 1).volume


@pytest.mark.parametrize("factor", [1e-3, 1.0, 1e3])
def test_volume_of_two_boxes_in_any_pose(factor):
    shift = np.array([0.5, 0.25, -0.1]) * factor
    exact = 0.5 * 0.75 * 0.9 * factor**3
    for pose in (Pose(), Pose([100 * factor, 2, 3], turn([1, 2, 3], 50))):
        one = Part("a", Box([factor] * 3), pose)
        other = Part("b", Box([factor] * 3), Pose(pose.apply([shift])[0], pose.rotation))
        assert volume_of(one, other) == pytest.approx(exact, rel=1e-9)
        assert volume_of(other, one) == pytest.approx(exact, rel=1e-9)
    away = Part("b", Box([factor] * 3), Pose([5 * factor, 0, 0]))
    assert volume_of(Part("a", Box([factor] * 3)), away) == 0.0


@pytest.mark.slow
def test_volume_of_a_bolt_in_its_nut_is_that_of_the_ring():
    assembly = bolted(1.05)
    found = detect.contacts(assembly)
    (overlap,) = [o for o in found.overlaps if set(o.ends) == {1, 2}]
    # the triangles of the bolt reach beyond the ring, where their sides are not refined
    exact = np.pi * (1.05**2 - 1) * 2.0
    assert overlap.volume == pytest.approx(exact, rel=5e-4)
    assert overlap.share == overlap.volume / assembly.geometry.volume[[1, 2]].min()


@pytest.mark.slow
@pytest.mark.parametrize("shape", ["balls", "cylinders", "a cylinder in a slab"])
def test_volume_of_round_parts_is_that_of_their_surfaces(shape):
    big, small, apart = 0.7, 0.5, 0.6
    if shape == "balls":
        pair = [Part("a", Sphere(big)), Part("b", Sphere(small), [apart, 0, 0])]
        cap = apart**2 + 2 * apart * (small + big) - 3 * (small - big) ** 2
        exact = np.pi * (big + small - apart) ** 2 * cap / (12 * apart)
    elif shape == "cylinders":
        pair = [Part("a", Cylinder(big, 1.0)), Part("b", Cylinder(small, 1.0), [apart, 0, 0])]
        at = (apart**2 + big**2 - small**2) / (2 * apart)

        def segment(radius, distance):
            side = np.sqrt(radius**2 - distance**2)
            return radius**2 * np.arccos(distance / radius) - distance * side

        exact = segment(big, at) + segment(small, apart - at)
    else:
        pair = [block("a", [-2, -2, -1], [2, 2, 0]), Part("b", Cylinder(small, 1.0), [0, 0, 0.4])]
        exact = np.pi * small**2 * 0.1
    (overlap,) = detect.contacts(Assembly(pair)).overlaps
    assert overlap.volume == pytest.approx(exact, rel=1e-5)


@pytest.mark.parametrize("turned", [False, True])
def test_area_of_whole_round_faces_is_that_of_their_circles(turned):
    """A disc and a ring on a slab, and a disc within a larger disc."""
    slab = block("slab", [-9, -9, -1], [9, 9, 0], grounded=True)
    post = Part("post", Cylinder(3.0, 1.0), Pose([0, 0, -0.5]), grounded=True)
    cases = [
        (slab, pin("disc", 0.7, 2.0, [1, 2, 1]), np.pi * 0.49),
        (slab, tube("ring", 1.0, 2.0, 4.0, [0, 0, 2]), np.pi * 3.0),
        (post, pin("disc", 0.7, 2.0, [0.5, 1.0, 1]), np.pi * 0.49),
    ]
    for base, part, exact in cases:
        pair = Assembly([base, part])
        found = detect.contacts(moved(pair, turn([1, 2, 3], 50), [3, 1, 4]) if turned else pair)
        assert found.patch_area == pytest.approx([exact], rel=1e-9)


def crossed(turned):
    """A thin bar right through a slab: no corner of either lies in the other."""
    pose = Pose([7, 8, 9], turn([1, 2, 3], 50)) if turned else Pose()
    bar, slab = Box([0.2, 3, 0.2]), notched()
    return Assembly([Part("bar", bar, pose), Part("slab", slab, pose)])


def notched():
    """A slab of 2 x 1 x 2 with a notch in its side: not convex."""
    outline = [(-1, -1), (1, -1), (1, -0.5), (0.9, 0), (1, 0.5), (1, 1), (-1, 1)]
    return Prism(outline, 1.0)


@pytest.mark.parametrize("turned", [False, True])
def test_bar_through_a_slab_overlaps_it_although_no_corner_is_inside(turned):
    (overlap,) = detect.contacts(crossed(turned)).overlaps
    assert overlap.volume == pytest.approx(0.2 * 0.2 * 1.0, rel=1e-9)
    assert overlap.share == pytest.approx(1 / 3, rel=1e-9)
    assert overlap.depth == pytest.approx(0.5, rel=1e-9)  # the middle of its sides, from the faces


@pytest.mark.parametrize(("depth", "overlaps"), [(0.99e-3, False), (1.01e-3, True)])
def test_overlap_is_told_from_the_gap_tolerance_on(depth, overlaps):
    slab = Part("slab", notched())
    box = Part("box", Box([0.5, 0.5, 0.5]), Pose([0, 0.75 - depth, 0]))
    found = detect.contacts(Assembly([slab, box]), tolerance=Tolerance(gap=1e-3))
    assert bool(found.overlaps) == overlaps
    assert bool(len(found)) != overlaps
    if overlaps:
        assert found.overlaps[0].depth == pytest.approx(depth, rel=1e-9)
        assert found.overlaps[0].volume == pytest.approx(0.25 * depth, rel=1e-9)


def test_triangles_that_bound_no_body_have_a_depth_and_no_volume():
    """A corner on the middle of an edge; an odd number of triangles ends the kernel's process."""
    corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (0.5, 0, 0)]
    faces = [(0, 2, 1), (0, 4, 3), (4, 1, 3), (0, 3, 2), (1, 2, 3)]
    slab = Part("slab", notched(), Pose([0.2, -0.4, 0.2]))
    split = Part("split", Mesh(np.array(corners, dtype=float), np.array(faces)))
    (overlap,) = detect.contacts(Assembly([split, slab])).overlaps
    assert (overlap.volume, overlap.share) == (None, None)
    assert overlap.depth == pytest.approx(0.1, rel=1e-9)
    faces = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
    whole = Part("whole", Mesh(np.array(corners[:4], dtype=float), np.array(faces)))
    (overlap,) = detect.contacts(Assembly([whole, slab])).overlaps
    assert overlap.depth == pytest.approx(0.1, rel=1e-9)
    assert overlap.volume == pytest.approx((1 - 0.9**3) / 6, rel=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize(("radius", "kind"), [(1.02, "fixed"), (1.0, "cylindrical")])
def test_suggestion_is_pasted_from_the_command_and_holds(radius, kind, tmp_path, capsys):
    file, proof = str(tmp_path / "a.kilter.json"), str(tmp_path / "p.json")
    dump(bolted(radius, turned=True), file)
    held = ["--ground", "sleeve"]
    main(["check", file, *held, "--suggest-joints", "--json"])
    (suggestion,) = json.loads(capsys.readouterr().out)["suggested_joints"]
    assert suggestion["joint"]["kind"] == kind
    words = shlex.split(suggestion["option"])
    assert main(["check", file, *held, *words, "--proof", proof]) == 0
    assert main(["verify", file, proof]) == 0
    assert main(["check", file, *held, "--suggest-joints"]) in (0, 1, 4)
    out = capsys.readouterr().out
    assert suggestion["option"] in out
    assert json.dumps(suggestion["joint"]) in out
    # the joint in the file: the bolt slides out of a bore that leans, a fixed one does not
    data = json.loads((tmp_path / "a.kilter.json").read_text())
    data["joints"] = [suggestion["joint"]]
    joined = Assembly(
        from_dict(data).with_grounded(["sleeve"]).parts,
        joints=from_dict(data).joints,
        gravity=from_dict(data).gravity,
        detect=False,
    )
    assert check(joined).verdict == ("stable" if kind == "fixed" else "unstable")


@pytest.mark.slow
def test_fits_are_recognised_in_meshes_too():
    exact = bolted(1.05)
    parts = [
        Part(part.name, Mesh(*surface(part.shape)), part.pose, grounded=part.grounded)
        for part in exact.parts
    ]
    assembly = Assembly(parts)
    found = detect.contacts(assembly)
    assert [one.parts for one in suggest_joints(assembly, found)] == [("bolt", "sleeve")]


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    ("name", "kind"),
    [("nut", "fixed"), ("M4 Nut_2", "fixed"), ("nuts/spacer", "cylindrical"),
     ("donut", "cylindrical"), ("nutcracker", "cylindrical")],
)  # fmt: skip
def test_part_named_a_nut_is_taken_for_threaded(name, kind):
    assembly = bolted(1.0, name=name)
    (suggestion,) = suggest_joints(assembly, detect.contacts(assembly))
    assert suggestion.joint["kind"] == kind
    assert ("by its name a nut" in suggestion.why) == (kind == "fixed")


# suggestions, and what joins them ---------------------------------------------------------


def pairs_of(assembly):
    return {(one.parts, one.kind) for one in suggest_joints(assembly, detect.contacts(assembly))}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("radius", "name", "kind"),
    [
        (1.019, "sleeve", "press fit"),
        (1.021, "sleeve", "thread"),
        (1.33, "sleeve", "thread"),  # M2 in the hole for its tap: .25 of the radius
        (1.35, "sleeve", "overlap"),
        (1.005, "nut", "thread"),
        (1.0, "sleeve", "size on size"),
    ],
)
def test_a_shaft_in_a_hole_is_told_by_how_much_thicker_it_is(radius, name, kind):
    assembly = bolted(radius, name=name).without("table")
    pin_first = dataclasses.replace(assembly.parts[1], name="shaft")
    assembly = Assembly([assembly.parts[0], pin_first])
    ((parts, found),) = pairs_of(assembly)
    assert found == kind
    assert set(parts) == {"shaft", name}


def test_names_tell_a_thread_and_an_insert():
    def named(one, other):
        low, high = block(one, [0, 0, 0], [1, 1, 1]), block(other, [0, 0, 0.9], [1, 1, 2])
        ((parts, kind),) = pairs_of(Assembly([low, high]))
        return parts, kind

    assert named("case", "M3 screw") == (("M3 screw", "case"), "thread")
    assert named("heat-set insert", "case") == (("heat-set insert", "case"), "insert")
    assert named("case", "screwdriver") == (("case", "screwdriver"), "overlap")


@pytest.mark.slow
def test_a_hollow_shaft_that_interferes_is_an_insert():
    parts = [tube("body", 1.0, 2.0, 4.0), tube("ring", 0.5, 1.01, 4.0)]
    assert pairs_of(Assembly(parts)) == {(("ring", "body"), "insert")}


def test_the_same_body_twice_is_to_be_left_out_not_joined():
    twice = Assembly([block("one", [0, 0, 0], [1, 1, 1]), block("two", [0, 0, 0], [1, 1, 1])])
    (found,) = suggest_joints(twice, detect.contacts(twice))
    assert (found.kind, found.option, found.joint) == ("same body", "--without two", None)
    assert fastened(twice, suggested=True, overlaps=True).joints == ()


def test_nothing_is_suggested_to_the_table_nor_between_held_parts():
    held = [block("a", [0, 0, 0], [1, 1, 1], grounded=True)]
    held.append(block("b", [0.9, 0, 0], [2, 1, 1], grounded=True))
    assert pairs_of(Assembly(held)) == set()
    free = Assembly([block("a", [0, 0, 0], [1, 1, 1])])
    sunk = free.with_floor(0.1)
    assert len(detect.contacts(sunk).overlaps) == 1
    assert pairs_of(sunk) == set()
    assert fastened(sunk, suggested=True, overlaps=True).joints == ()
    # a held part of the file is no table
    assert len(pairs_of(Assembly([*free.parts, block("floor", [-5, -5, -1], [5, 5, 0.1],
                                                     grounded=True)]))) == 1  # fmt: skip


@pytest.mark.slow
def test_suggested_and_overlaps_join_and_say_what():
    lid = block("lid", [5, 5, 3.9], [6, 6, 5])
    leg = block("leg", [5, 5, 0], [6, 6, 4])
    nut = tube("nut", 1.0, 2.0, 4.0, grounded=True)
    loose = Assembly([nut, pin("bolt", 1.0, 6.0), leg, lid])
    joined = fastened(loose, suggested=True)
    assert [(j.parts, j.why) for j in joined.joints] == [
        (("bolt", "nut"), "thread"),
        (("leg", "lid"), "overlap"),
    ]
    assert joined.notes == ()  # an effect that the user requested is no warning
    over = fastened(loose, overlaps=True)
    assert [j.parts for j in over.joints] == [("leg", "lid")]
    assert over.notes == ()
    both = fastened(loose, [("lid", "leg")], suggested=True, overlaps=True)
    assert [(j.parts, j.why) for j in both.joints] == [
        (("lid", "leg"), ""),
        (("bolt", "nut"), "thread"),
    ]
    assert both.notes[-1] == (
        "nothing is fastened as they overlap: no overlapping pair can be joined"
    )
    again = fastened(joined, suggested=True)
    assert len(again.joints) == 2
    assert again.notes[-1].startswith("nothing is fastened as suggested")


def clamped_plates(*, nut_gap: float = 0.0) -> Assembly:
    """Two plates with wide holes, a bolt from below, and a nut `nut_gap` above the upper plate."""
    shaft = Mesh(*revolved([(0, -1), (2, -1), (2, 0), (1, 0), (1, 5), (0, 5)], 64))
    plate = Mesh(*revolved([(1.2, 0), (4, 0), (4, 1), (1.2, 1)], 64))
    ring = Mesh(*revolved([(3, -3), (4, -3), (4, 0), (3, 0)], 64))
    nut = Mesh(*revolved([(1, 0), (2, 0), (2, 1), (1, 1)], 64))
    parts = [
        Part("a", shaft),
        Part("b", plate),
        Part("c", plate, Pose([0, 0, 1])),
        Part("d", nut, Pose([0, 0, 2 + nut_gap])),
        Part("e", ring, grounded=True),
    ]
    return Assembly(parts)


def test_a_shaft_and_a_ring_that_clamp_plates_are_a_bolt_and_its_nut():
    assembly = clamped_plates()
    contacts = detect.contacts(assembly)
    (joined,) = [s for s in suggest_joints(assembly, contacts) if s.fixed]
    assert (joined.parts, joined.kind) == (("a", "d"), "thread")
    assert "they clamp 'b' between them" in joined.why
    assert check(assembly).verdict != "stable"
    assert check(fastened(assembly, suggested=True)).verdict == "stable"


def test_a_ring_that_presses_no_part_is_no_nut():
    assembly = clamped_plates(nut_gap=0.5)
    assert not [s for s in suggest_joints(assembly, detect.contacts(assembly)) if s.fixed]


def test_full_names_join_a_pin_with_play_and_wildcards_do_not():
    loose = Assembly([tube("plate", 1.1, 3.0, 1.0, [0, 0, 0]), pin("pin", 1.0, 3.0, [0, 0, 0])])
    assert [j.parts for j in fastened(loose, [("pin", "plate")]).joints] == [("pin", "plate")]
    with pytest.raises(InputError, match="nothing to fasten"):
        fastened(loose, [("p?n", "plate")])


def test_full_names_join_a_ring_that_overlaps_its_pin_by_less_than_the_gap_tolerance():
    """A ring drawn undeformed: its inner face lies 0.05 inside the pin that it hangs on."""
    loose = Assembly([pin("pin", 1.0, 6.0), tube("seal", 0.95, 2.0, 1.0)])
    wide = Tolerance(gap=0.1)
    assert [j.parts for j in fastened(loose, [("pin", "seal")], tolerance=wide).joints] == [
        ("pin", "seal")
    ]
    apart = Assembly([pin("pin", 1.0, 6.0), tube("seal", 0.95, 2.0, 1.0, [4, 0, 0])])
    with pytest.raises(InputError, match="nothing to fasten"):
        fastened(apart, [("pin", "seal")], tolerance=wide)


def test_a_wide_gap_tolerance_keeps_a_press_fit_and_makes_no_thread_of_a_clearance():
    ring = tube("ring", 1.0, 2.0, 4.0, grounded=True)
    wide = Tolerance(gap=0.2)
    for radius, kinds in ((1.01, ["press fit"]), (0.9, [])):
        assembly = Assembly([ring, pin("pin", radius, 6.0)])
        contacts = detect.contacts(assembly, tolerance=wide)
        assert [s.kind for s in suggest_joints(assembly, contacts)] == kinds


def test_copies_of_an_overlapping_pair_share_its_depth_and_volume():
    corner = Prism([[0, 0], [3, 0], [3, 1], [1, 1], [1, 3], [0, 3]], 2.0)
    shapes = {"corner": corner, "sunk": Box([1.5, 1.5, 1.5])}
    inside = Pose([1.55, 1.55, 0])  # the box reaches 0.2 into both arms of the corner
    places = [Pose([7.0 * k, 3.0 * k, k], turn([1, 2, 3], 25 * k)) for k in range(3)]
    parts = [
        Part(f"{name}-{k}", shape, place if name == "corner" else place @ inside)
        for k, place in enumerate(places)
        for name, shape in shapes.items()
    ]
    overlaps = detect.contacts(Assembly(parts)).overlaps
    (single,) = detect.contacts(Assembly(parts[:2])).overlaps
    assert [overlap.ends for overlap in overlaps] == [(0, 1), (2, 3), (4, 5)]
    for overlap in overlaps:
        assert overlap.depth == pytest.approx(single.depth, rel=1e-9)
        assert overlap.volume == pytest.approx(single.volume, rel=1e-9)
