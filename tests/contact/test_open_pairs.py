"""Open pairs, gaps and depths by hand, and the nearest part of a part that touches nothing."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from solids import pin
from transformations import scaled

import kilter
from kilter import Bond, InputError, check, dump, fastened, margin, orient, region
from kilter.assembly import Assembly, Joint, Part
from kilter.cli import main
from kilter.contact import ContactSet, Tolerance, contacts
from kilter.contact.contact_tolerances import GAP, LOOSE_ANGLE, LOOSE_GAP
from kilter.contact.fits.suggestions import coincident_remarks
from kilter.rigid import Pose
from kilter.scenes import scene
from kilter.scenes.pieces import block, moved, tube, turn
from kilter.shape.primitives import Box, Prism, Sphere


def stacked(gap: float, *, tilt: float = 0.0, **options: object) -> Assembly:
    """A unit cube `gap` over the middle of a held slab, tilted about y [rad]."""
    slab = block("slab", [-2, -2, -1], [2, 2, 0], grounded=True)
    turn = [np.cos(tilt / 2), 0.0, np.sin(tilt / 2), 0.0]
    # the lowest edge is `gap` over the slab
    height = gap + (np.cos(tilt) + abs(np.sin(tilt))) / 2
    return Assembly([slab, Part("cube", Box([1, 1, 1]), Pose([0, 0, height], turn))], **options)


def kinds(assembly: Assembly, **options: object) -> list[str]:
    found: ContactSet = contacts(assembly, **options)  # type: ignore[arg-type]
    return [one.kind for one in found.open_pairs]


@pytest.mark.quick(3)
@pytest.mark.parametrize(
    ("gap", "kind"),
    [
        (0.0, []),
        (0.9 * GAP, []),
        (1.5 * GAP, ["near"]),
        (50 * GAP, ["near"]),
        (0.99 * LOOSE_GAP, ["near"]),
        (1.01 * LOOSE_GAP, []),
        (-0.9 * GAP, []),
        (-1.5 * GAP, ["overlap"]),
        (-50 * GAP, ["overlap"]),
        (-0.3, ["overlap"]),
    ],
)
def test_a_cube_over_a_slab_by_its_gap(gap, kind):
    size = float(contacts(stacked(0.0)).assembly.geometry.size[1])
    assert kinds(stacked(gap * size)) == kind


@pytest.mark.parametrize(("share", "kind"), [(0.99, ["near"]), (1.01, [])])
def test_a_tilted_cube_by_its_angle(share, kind):
    assert kinds(stacked(0.0, tilt=share * LOOSE_ANGLE)) == kind


def test_what_is_known_of_it_is_said():
    found = contacts(stacked(-0.25))
    (one,) = found.open_pairs
    assert (one.ends, one.kind, one.depth) == ((0, 1), "overlap", pytest.approx(0.25))
    assert one.volume == pytest.approx(0.25)
    entry = found.to_dict()["open_pairs"][0]
    assert entry["parts"] == ["slab", "cube"]
    assert set(entry) == {"parts", "kind", "gap", "depth", "volume", "why"}
    (one,) = contacts(stacked(1e-4)).open_pairs
    assert (one.kind, one.gap, one.depth) == ("near", pytest.approx(1e-4), None)


@pytest.mark.parametrize("depth", [1e-3, -1e-4])
def test_what_is_joined_or_held_is_not_open(depth):
    assembly = stacked(-depth)
    assert len(kinds(assembly)) == 1
    assert kinds(assembly.with_joints([Joint(("cube", "slab"))])) == []
    assert kinds(assembly.with_joints([Joint(("cube", "ground"))])) == []
    assert (
        len(kinds(assembly.with_joints([Joint(("cube", "slab"), "prismatic", axis=[1, 0, 0])])))
        == 1
    )


def test_a_wider_tolerance_closes_a_gap():
    assembly = stacked(1e-4)
    assert kinds(assembly) == ["near"]
    assert kinds(assembly, tolerance=Tolerance(gap=2e-4)) == []
    assert kinds(assembly, tolerance=Tolerance.loose()) == []
    assert kinds(assembly, tolerance=Tolerance(clearance=2e-4)) == []


@pytest.mark.quick(1)
@pytest.mark.parametrize(("radius", "kind"), [(0.999, ["clearance"]), (1.001, ["overlap"])])
def test_a_round_fit_with_clearance_or_interference(radius, kind):
    found = Assembly([tube("tube", 1.0, 2.0, 1.0, grounded=True), pin("pin", radius, 4.0)])
    assert kinds(found) == kind


def test_the_depth_of_two_corners_is_at_most_the_way_in():
    # no facet is nearly across the way, so the planes of the facets alone give a depth of .2
    upper, lower = scene("paper-figure-3-vertices").parts[::-1]
    sunk = replace(upper, pose=Pose([0, 0, -0.01]))
    [overlap] = contacts(Assembly([replace(lower, grounded=True), sunk])).overlaps
    assert 0.005 < overlap.depth <= 0.01


def test_the_depth_of_crossing_ridges_is_measured_across_both():
    lower = Part("lower", Prism([[-1, -1], [1, -1], [0, 0]], 2.0), grounded=True)
    turned = Pose([0, 0, -0.02], [np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5)])
    upper = Part("upper", Prism([[-1, 1], [1, 1], [0, 0]], 2.0), turned)
    [overlap] = contacts(Assembly([lower, upper])).overlaps
    assert overlap.depth == pytest.approx(0.02, rel=1e-6)


BASE = block("base", [-50, -50, -10], [50, 50, 0], grounded=True)


def answered(*parts: Part, **more: object) -> dict:
    return kilter.contacts(Assembly(list(parts), units="mm", **more)).to_dict()


@pytest.mark.parametrize("gap", [0.0, 1e-4, -2e-4])
def test_a_patch_under_a_plate(gap):
    """A plate of 20 x 30 x 10, `gap` above its base, glued by 0.5 N/mm^2."""
    plate = block("plate", [0, 0, gap], [20, 30, 10 + gap])
    answer = answered(
        BASE, plate, friction=0.25, bonds=[Bond(("base", "plate"), pull_per_area=0.5)]
    )
    (patch,) = answer["patches"]
    assert patch["area"] == pytest.approx(20 * 30, rel=1e-12)
    assert [patch["gap"], *patch["gap_range"]] == pytest.approx([gap] * 3, abs=1e-12)
    assert patch["normal"] == pytest.approx([0, 0, 1], abs=1e-12)
    assert (patch["mu"], patch["pull"]) == (0.25, pytest.approx(0.5 * 600))
    corners = sorted([x, y, gap / 2] for x in (0, 20) for y in (0, 30))
    assert np.array(sorted(patch["points"])) == pytest.approx(np.array(corners), abs=1e-9)
    size = math.hypot(20, 30, 10)
    assert answer["sizes"] == pytest.approx([size, math.hypot(100, 100, 10)])
    edges = [math.nan if edge is None else edge for edge in answer["histogram"]["edges"]]
    (bin_,) = np.flatnonzero(answer["histogram"]["counts"])
    assert not gap / size < edges[bin_] - 1e-15
    assert not gap / size > edges[bin_ + 1] + 1e-15


def test_a_patch_under_a_tilted_plate_states_its_least_and_its_largest_gap():
    turn, low = math.radians(0.02), 1e-5
    height = low + 5 * (math.cos(turn) + math.sin(turn))
    quaternion = [math.cos(turn / 2), 0, math.sin(turn / 2), 0]
    (patch,) = answered(BASE, Part("plate", Box([10] * 3), Pose([0, 0, height], quaternion)))[
        "patches"
    ]
    expected = [low, low + 10 * math.sin(turn)]
    assert patch["gap_range"] == pytest.approx(expected, abs=1e-9)
    assert patch["gap"] == pytest.approx(expected[1], abs=1e-9)


@pytest.mark.parametrize(("degrees", "gap"), [(0.0, 1e-3), (0.5, 2e-3)])
def test_a_pair_that_is_rejected_states_its_gap_and_its_angle(degrees, gap):
    turn = math.radians(degrees)
    height = gap + 5 * (math.cos(turn) + math.sin(turn))
    quaternion = [math.cos(turn / 2), 0, math.sin(turn / 2), 0]
    answer = answered(BASE, Part("cube", Box([10] * 3), Pose([0, 0, height], quaternion)))
    (rejected,), (pair,) = answer["rejected"], answer["open_pairs"]
    assert rejected["angle_deg"] == pytest.approx(degrees, abs=1e-9)
    # the gap of a tilted face is measured across both faces
    assert rejected["gap"] == pytest.approx(gap, rel=1e-4)
    assert pair["gap"] == pytest.approx(gap, rel=1e-4)


def test_a_cube_that_is_sunk_into_its_base_and_one_above_it():
    sunk = block("sunk", [-40, -40, -2], [-20, -30, 8])
    above = block("above", [0, 0, 3], [10, 10, 10])
    answer = answered(BASE, sunk, above)
    (overlap,), (pair,) = answer["overlaps"], answer["open_pairs"]
    assert overlap["volume"] == pytest.approx(20 * 10 * 2)
    assert overlap["share"] == pytest.approx(2 / 10)
    assert overlap["depth"] == pytest.approx(2)
    assert (pair["volume"], pair["depth"]) == (overlap["volume"], overlap["depth"])
    (alone,) = answer["nearest"]
    assert alone["gap"] == pytest.approx(3)
    assert 0 <= abs(alone["gap"] - 3) <= alone["accuracy"] < 1e-9


def test_a_pin_in_a_ring_has_its_radius_its_clearance_and_the_length_of_the_ring():
    ring = tube("ring", 5.0, 10.0, 20.0, [3, 0, 10], grounded=True)
    answer = answered(ring, pin("pin", 4.9, 40.0, [3, 0, 15]))
    (fit,) = answer["fits"]
    assert (fit["radius"], fit["clearance"], fit["length"]) == pytest.approx((4.9, 0.1, 20))
    assert np.abs(fit["axis"]) == pytest.approx([0, 0, 1])
    assert np.cross(np.subtract(fit["point"], [3, 0, 0]), [0, 0, 1]) == pytest.approx([0] * 3)
    (alone,) = [one for one in answer["nearest"] if one["part"] == "pin"]
    assert abs(alone["gap"] - 0.1) <= alone["accuracy"] < 0.05


def test_ridges_that_cross_at_a_point_are_named_with_it():
    lower = Part("lower", Prism([[-1, -1], [1, -1], [0, 0]], 2.0), Pose([7, 5, 1]), grounded=True)
    turned = Pose([7, 5.5, 1], [math.sqrt(0.5), 0, 0, math.sqrt(0.5)])
    upper = Part("upper", Prism([[-1, 1], [1, 1], [0, 0]], 2.0), turned)
    verdict = kilter.check(Assembly([lower, upper], units="mm")).to_dict()
    patches = answered(lower, upper)["patches"]
    assert patches[0]["points"] == [pytest.approx([7, 5.5, 1])]
    assert patches[0]["normal"] == pytest.approx([0, 0, 1])
    assert verdict["contacts"] == {"pairs": 1, "patches": 1, "points": 1}
    beside = answered(lower, Part("upper", Prism([[-1, 1], [1, 1], [0, 0]], 2.0), Pose([7, 5, 1])))
    (odd,) = beside["unsupported"]
    assert odd["point"][::2] == pytest.approx([7, 1])
    assert 4 <= odd["point"][1] <= 6


GROUND = block("base", [-5, -5, -1], [5, 5, 0], grounded=True)


def only(assembly: Assembly) -> dict:
    (one,) = [one for one in contacts(assembly).nearest if not one.grounded]
    return one.to_dict()


# nearest parts ----------------------------------------------------------------------------


@pytest.mark.quick(1)
@pytest.mark.parametrize("factor", [1e-3, 1.0, 1e3])
def test_a_gap_between_faces_edges_and_corners_is_their_distance(factor):
    cases = [
        (Pose([0, 0, 0.75]), 0.25),  # face over face
        (Pose([5.7, 0, 1.1]), np.hypot(0.2, 0.6)),  # edge beside edge
        (Pose([5.7, 5.8, 1.1]), np.sqrt(0.2**2 + 0.3**2 + 0.6**2)),  # corner off corner
        # an edge on its side over a face: half a diagonal below the centre
        (Pose([0, 0, 1], turn([1, 0, 0], 45)), 1 - np.sqrt(0.5)),
        # crossed edges, of a beam on its edge over the rim of the base
        (Pose([5, 0, 1], turn([0, 1, 0], 45)), 1 - np.sqrt(0.5)),
    ]
    for pose, gap in cases:
        assembly = Assembly([GROUND, Part("top", Box([1, 1, 1]), pose)])
        for one in (assembly, moved(assembly, turn([1, 2, 3], 77), [3, -1, 4])):
            found = only(scaled(one, factor))
            assert found["part"] == "top"
            assert found["nearest"] == "base"
            assert found["gap"] == pytest.approx(gap * factor, rel=1e-9)
            assert found["accuracy"] < 1e-9 * factor


def test_a_play_below_a_floating_part_is_closed_and_a_wide_gap_is_not():
    """The play of the part is 2 mm, the most."""
    for gap, verdict in ((1.9e-3, "stable"), (2.1e-3, "unstable")):
        hook = block("hook", [-1, -1, gap], [1, 1, 1 + gap])
        assert check(Assembly([GROUND, hook]), assume="play").verdict == verdict


def test_a_play_is_closed_together_with_joints_of_parts_that_overlap():
    """An arm is sunk into a post sideways: without friction only a joint holds it."""
    hook = block("hook", [-1, -1, 1e-3], [1, 1, 1.001])
    post = block("post", [2, -1, 0], [3, 1, 4], grounded=True)
    drawn = Assembly([GROUND, hook, post, block("arm", [2.999, -0.5, 2], [4, 0.5, 3])])
    for rung in ("play", "fits"):
        assert check(drawn, assume=rung).moving == ["arm"]
    joined = check(drawn, assume="joined")
    assert (joined.verdict, joined.level) == ("stable", "proved")
    assert "only if its touching parts are joined (1 joint)" in joined.sentence


def test_a_gap_of_round_faces_is_right_within_what_is_told():
    ball = Part("ball", Sphere(2.0), Pose([0, 0, 2.75]))
    found = only(Assembly([GROUND, ball]))
    assert abs(found["gap"] - 0.75) <= found["accuracy"] < 0.1
    # within a bore, where boxes enclose each other
    rod = pin("rod", 0.5, 3.0, [0, 0.2, 0])
    held = tube("ring", 1.0, 2.0, 4.0, grounded=True)
    found = contacts(Assembly([held, rod])).nearest
    assert [one.part for one in found] == ["ring", "rod"]
    assert found[0].gap == found[1].gap
    assert abs(found[0].gap - 0.3) <= found[0].accuracy < 0.01


def test_of_several_the_nearest_is_named_though_its_box_is_not():
    """A long diagonal beam has the nearer box, a small block the nearer surface."""
    beam = Part("beam", Box([12, 0.2, 0.2]), Pose([0, 6, 6], turn([0, 1, 1], 90)))
    near = block("near", [1.2, 0.0, 6.0], [2.2, 1.0, 7.0])
    assembly = Assembly([GROUND, beam, near, block("top", [-1, 0, 6], [0, 1, 7])])
    found = {one.part: one for one in contacts(assembly).nearest}
    gaps = []
    for other in ("base", "beam", "near"):
        two = Assembly([assembly[other], assembly["top"]])
        gaps.append((next(o for o in contacts(two).nearest if o.part == "top").gap, other))
    assert (found["top"].gap, found["top"].nearest) == min(gaps)


def test_what_touches_overlaps_or_is_joined_is_not_alone():
    cube = block("cube", [0, 0, 0], [1, 1, 1])
    sunk = block("sunk", [0, 0, 0.9], [1, 1, 2])
    assert contacts(Assembly([GROUND, cube, sunk])).nearest == ()
    aside = Assembly([GROUND, cube, block("aside", [3, 0, 0.5], [4, 1, 1])])
    assert [one.part for one in contacts(aside).nearest] == ["aside"]
    alone = Assembly([block("cube", [0, 0, 0], [1, 1, 1], grounded=True)])
    assert [one.to_dict() for one in contacts(alone).nearest] == [
        {"part": "cube", "nearest": None, "gap": None, "accuracy": None, "grounded": True}
    ]


@pytest.mark.slow
def test_check_and_contacts_name_the_nearest_in_words_and_data(tmp_path, capsys):
    file = str(tmp_path / "a.kilter.json")
    dump(Assembly([GROUND, block("top", [0, 0, 0.25], [1, 1, 1])], units="mm"), file)
    for command in ("check", "contacts"):
        main([command, file, "--json"])
        answer = json.loads(capsys.readouterr().out)
        names = [(one["part"], one["nearest"], one["gap"]) for one in answer["nearest"]]
        assert names == [("base", "top", 0.25), ("top", "base", 0.25)]
    main(["check", file])
    assert "touches nothing: 'top' (0.25 mm from 'base')" in capsys.readouterr().err
    main(["contacts", file])
    out = capsys.readouterr().out
    assert (
        "Held, but touching nothing:\n  part  gap      nearest part\n  base  0.25 mm  top\n" in out
    )
    assert "top (1 part): 0.25 mm above base" in out


# parts on one another ---------------------------------------------------------------------


def lying(share: float, *, grounded: bool = False) -> Assembly:
    """Two cubes that share a fraction of each other."""
    first = block("a", [0, 0, 0], [1, 1, 1], grounded=True)
    return Assembly([first, block("b", [1 - share, 0, 0], [2 - share, 1, 1], grounded=grounded)])


@pytest.mark.slow
@pytest.mark.parametrize("judge", [check, orient, region, margin])
def test_parts_that_share_more_than_half_are_open(judge):  # type: ignore[no-untyped-def]
    remark = "'a' and 'b' share 51 % of 'b': misplaced, or drawn"
    assert coincident_remarks(contacts(lying(0.51)))[0].startswith(remark)
    assert coincident_remarks(contacts(lying(0.49))) == []
    judge(lying(0.51))
    judge(lying(0.49))
    judge(fastened(lying(0.51), [("a", "b")]))
    judge(Assembly([*lying(0.51, grounded=True).parts, block("c", [3, 0, 0], [4, 1, 1])]))


@pytest.mark.slow
def test_the_likely_reason_is_told():
    frames = [block(f"part-{k}", [-k - 1, -1, -1], [k + 1, 1, 1]) for k in range(3)]
    with pytest.raises(InputError, match="each file seems to be in a frame of its own; export"):
        check(Assembly([block("g", [-9, -9, -9], [9, 9, -8], grounded=True), *frames]))
    twice = [block("one", [0, 0, 0], [1, 1, 1], grounded=True), block("two", [0, 0, 0], [1, 1, 1])]
    answer = check(Assembly(twice))
    assert any(
        w.startswith("'one' and 'two' are the same body twice: a copy") for w in answer.warnings
    )
    assert answer.verdict == "undecided"
    inside = [tube("body", 1, 4, 4, grounded=True), pin("insert", 0.5, 2, [2.5, 0, 0])]
    answer = check(Assembly(inside))
    reason = "'insert' lies inside 'body': misplaced, or drawn with"
    assert any(w.startswith(reason) for w in answer.warnings)
    assert check(fastened(Assembly(inside), suggested=True)).verdict == "stable"
    low = [block("post", [0, 0, 0], [1, 1, 10]), block("plate", [3, 0, 0], [5, 1, 0.5])]
    with pytest.raises(InputError, match="'plate' lies inside 'floor': the table is too high"):
        check(Assembly(low).with_floor(1.0))


@pytest.mark.parametrize("count", [2, 3])
def test_a_whole_beside_its_parts_is_named(count):
    """The whole is a bar of unit cubes; with one cube in a longer bar it is only misplaced."""
    cubes = [block(f"cube-{k}", [k, 0, 0], [k + 1, 1, 1]) for k in range(count)]
    table = block("table", [-1, -1, -1], [9, 2, 0], grounded=True)
    whole = block("all", [0, 0, 0], [count, 1, 1])
    assembly = Assembly([table, whole, *cubes])
    (remark,) = coincident_remarks(contacts(assembly))
    assert "'all' is the whole beside its parts; leave the whole out with --without all" in remark
    assert remark in check(assembly).warnings
    assert check(assembly.without("all")).verdict == "stable"
    longer = block("all", [0, 0, 0], [2 * count + 1, 1, 1])
    assert "whole beside" not in str(
        coincident_remarks(contacts(Assembly([table, longer, *cubes])))
    )


def test_frames_of_files_are_mentioned_only_for_several_files():
    nested = [block(f"part-{k}", [-k - 1, -1, -1], [k + 1, 1, 1]) for k in range(3)]
    parts = [block("g", [-9, -9, -9], [9, 9, -8], grounded=True), *nested]
    answer = check(Assembly(parts, source="model.step"))
    (remark,) = [text for text in answer.warnings if "variants drawn over each other" in text]
    assert "--without part-0 --without part-1;" in remark
    left_out = check(Assembly(parts, source="m.step").without(["part-0", "part-1"]))
    assert left_out.verdict == "unstable"
    with pytest.raises(InputError, match="in a frame of its own"):
        check(Assembly(parts, source="folder"))


@pytest.mark.slow
def test_a_nut_without_its_hole_is_no_part_in_the_wrong_place():
    """M8: a hexagon of 13 mm as a round of as much area, on a shank of 8 mm."""
    nut = pin("nut", 6.83, 6.5, grounded=True)
    found = check(Assembly([nut, pin("bolt", 4, 40)], units="mm"))
    assert found.verdict != "stable"
    (overlap,) = found.contact_set.overlaps
    assert overlap.share == pytest.approx((4 / 6.83) ** 2, rel=0.01)


@pytest.mark.slow
def test_a_raw_folder_is_refused_in_a_sentence_and_contacts_lists_it(tmp_path, capsys):
    from kilter.shape.primitives import surface

    for k in range(3):
        vertices, faces = surface(Box([3 + k, 2, 2]))
        lines = [f"v {x} {y} {z}" for x, y, z in vertices.tolist()]
        lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in faces.tolist()]
        (tmp_path / f"p{k}.obj").write_text("\n".join(lines))
    assert main(["check", str(tmp_path), "--ground", "p0"]) == 2
    out, error = capsys.readouterr()
    assert out == ""
    assert error.count("\n") == 1
    assert "lies inside" in error
    assert "frame of its own" in error
    assert "--fasten-overlaps" in error
    assert main(["contacts", str(tmp_path)]) == 0
    assert main(["check", str(tmp_path), "--ground", "p0", "--fasten-overlaps"]) == 0


# copies ------------------------------------------------------------------------------------


def table_with(*places: tuple[float, float, float]) -> Assembly:
    """Feet on a base, and a foot of another shape that enters it."""
    feet = [Part(f"foot_{k}", Box([1, 1, 2]), Pose(at)) for k, at in enumerate(places)]
    return Assembly([GROUND, *feet, Part("peg", Box([1, 1, 1]), Pose([4, 4, 0.3]))])


def test_a_copy_that_overlaps_where_the_others_do_not_is_asked_about():
    told = [w for w in contacts(table_with((0, 0, 1), (3, 0, 0.9))).warnings if "right place" in w]
    assert told == [
        "is 'foot_1' in the right place? it overlaps 'base', but its copy 'foot_0' overlaps nothing"
    ]
    assert told[0] in check(table_with((0, 0, 1), (3, 0, 0.9))).warnings


@pytest.mark.parametrize("places", [[(0, 0, 1), (3, 0, 1)], [(0, 0, 0.9), (3, 0, 0.8)]])
def test_copies_that_all_overlap_or_none_are_not_asked_about(places):  # type: ignore[no-untyped-def]
    assert not any("placed" in w for w in contacts(table_with(*places)).warnings)


def test_a_copy_that_is_fastened_is_meant_so():
    assembly = table_with((0, 0, 1), (3, 0, 0.9))
    joined = fastened(assembly, [("base", "foot_1")])
    assert not any("placed" in w for w in check(joined).warnings)
