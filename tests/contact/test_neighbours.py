"""The nearest part of a part that touches nothing, against closed forms; parts on one another."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from transformations import scaled
from tubes import pin, tube

from kilter import InputError, check, contacts, dump, fastened, margin, orient, region
from kilter.assembly import Assembly, Part
from kilter.cli import main
from kilter.contact.fits.suggestions import coincident_remarks, parts_to_leave_out
from kilter.rigid import Pose
from kilter.scenes.pieces import block, turn
from kilter.scenes.transform import moved
from kilter.shape.primitives import Box, Sphere

BASE = block("base", [-5, -5, -1], [5, 5, 0], grounded=True)


def only(assembly: Assembly) -> dict:
    (one,) = [one for one in contacts(assembly).nearest if not one.grounded]
    return one.to_dict()


# nearest parts ----------------------------------------------------------------------------


@pytest.mark.quick(1)
@pytest.mark.parametrize("factor", [1e-3, 1.0, 1e3])
def test_a_gap_between_faces_edges_and_corners_is_their_distance(factor: float) -> None:
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
        assembly = Assembly([BASE, Part("top", Box([1, 1, 1]), pose)])
        for one in (assembly, moved(assembly, turn([1, 2, 3], 77), [3, -1, 4])):
            found = only(scaled(one, factor))
            assert found["part"] == "top"
            assert found["nearest"] == "base"
            assert found["gap"] == pytest.approx(gap * factor, rel=1e-9)
            assert found["accuracy"] < 1e-9 * factor


def test_a_play_below_a_floating_part_is_a_remedy_and_a_wide_gap_is_none() -> None:
    for gap, options in ((0.03, ["--gap 0.0303"]), (0.3, [])):
        hook = block("hook", [-1, -1, gap], [1, 1, 1 + gap])
        remedies = check(Assembly([BASE, hook])).remedies
        assert [remedy.option for remedy in remedies] == options
        assert all(remedy.leads_to == "stable" for remedy in remedies)


@pytest.mark.parametrize("sunk", [0.02, 0.04])
def test_a_play_is_closed_together_with_joints_of_parts_that_overlap_by_less(sunk: float) -> None:
    """An arm is sunk into a post sideways: a tolerance above `sunk` finds no overlap there."""
    hook = block("hook", [-1, -1, 0.03], [1, 1, 1.03])
    post = block("post", [2, -1, 0], [3, 1, 4], grounded=True)
    arm = block("arm", [3 - sunk, -0.5, 2], [4, 0.5, 3])
    (remedy,) = check(Assembly([BASE, hook, post, arm])).remedies
    joined = "--fasten-suggested" if sunk > 0.03 else "--fasten post arm --fasten-suggested"
    assert (remedy.option, remedy.level) == (f"{joined} --gap 0.0303", "proved")


def test_the_play_of_one_part_asks_the_next_question_about_another() -> None:
    hook = block("hook", [-1, -1, 0.03], [1, 1, 1.03])
    ring = tube("ring", 1.1, 2.0, 4.0, [0, 9, 5], grounded=True)
    shaft = pin("shaft", 1.0, 4.0, [0, 9, 5])  # a play too wide for this gap tolerance
    (remedy,) = check(Assembly([BASE, hook, ring, shaft])).remedies
    assert (remedy.option, remedy.leads_to) == ("--gap 0.0303", "undecided")


def test_a_gap_of_round_faces_is_right_within_what_is_told() -> None:
    ball = Part("ball", Sphere(2.0), Pose([0, 0, 2.75]))
    found = only(Assembly([BASE, ball]))
    assert abs(found["gap"] - 0.75) <= found["accuracy"] < 0.1
    # within a bore, where boxes enclose each other
    rod = pin("rod", 0.5, 3.0, [0, 0.2, 0])
    held = tube("ring", 1.0, 2.0, 4.0, grounded=True)
    found = contacts(Assembly([held, rod])).nearest
    assert [one.part for one in found] == ["ring", "rod"]
    assert found[0].gap == found[1].gap
    assert abs(found[0].gap - 0.3) <= found[0].accuracy < 0.01


def test_of_several_the_nearest_is_named_though_its_box_is_not() -> None:
    """A long diagonal beam has the nearer box, a small block the nearer surface."""
    beam = Part("beam", Box([12, 0.2, 0.2]), Pose([0, 6, 6], turn([0, 1, 1], 90)))
    near = block("near", [1.2, 0.0, 6.0], [2.2, 1.0, 7.0])
    assembly = Assembly([BASE, beam, near, block("top", [-1, 0, 6], [0, 1, 7])])
    found = {one.part: one for one in contacts(assembly).nearest}
    gaps = []
    for other in ("base", "beam", "near"):
        two = Assembly([assembly[other], assembly["top"]])
        gaps.append((next(o for o in contacts(two).nearest if o.part == "top").gap, other))
    assert (found["top"].gap, found["top"].nearest) == min(gaps)


def test_what_touches_overlaps_or_is_joined_is_not_alone() -> None:
    cube = block("cube", [0, 0, 0], [1, 1, 1])
    sunk = block("sunk", [0, 0, 0.9], [1, 1, 2])
    assert contacts(Assembly([BASE, cube, sunk])).nearest == ()
    aside = Assembly([BASE, cube, block("aside", [3, 0, 0.5], [4, 1, 1])])
    assert [one.part for one in contacts(aside).nearest] == ["aside"]
    alone = Assembly([block("cube", [0, 0, 0], [1, 1, 1], grounded=True)])
    assert [one.to_dict() for one in contacts(alone).nearest] == [
        {"part": "cube", "nearest": None, "gap": None, "accuracy": None, "grounded": True}
    ]


@pytest.mark.slow
def test_check_and_contacts_name_the_nearest_in_words_and_data(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = str(tmp_path / "a.kilter.json")
    dump(Assembly([BASE, block("top", [0, 0, 0.25], [1, 1, 1])], units="mm"), file)
    for command in ("check", "contacts"):
        main([command, file, "--json"])
        answer = json.loads(capsys.readouterr().out)
        names = [(one["part"], one["nearest"], one["gap"]) for one in answer["nearest"]]
        assert names == [("base", "top", 0.25), ("top", "base", 0.25)]
    main(["check", file])
    assert "touches nothing: 'top' (0.25 mm from 'base')" in capsys.readouterr().err
    main(["contacts", file])
    out = capsys.readouterr().out
    assert "Touching nothing: 2 parts." in out
    assert "  top   0.25 mm  base\n" in out


# parts on one another ---------------------------------------------------------------------


def lying(share: float, *, grounded: bool = False) -> Assembly:
    """Two cubes that share a fraction of each other."""
    first = block("a", [0, 0, 0], [1, 1, 1], grounded=True)
    return Assembly([first, block("b", [1 - share, 0, 0], [2 - share, 1, 1], grounded=grounded)])


@pytest.mark.slow
@pytest.mark.parametrize("judge", [check, orient, region, margin])
def test_parts_that_share_more_than_half_are_open(judge) -> None:  # type: ignore[no-untyped-def]
    remark = "'a' and 'b' share 51 % of 'b': misplaced, or drawn"
    assert coincident_remarks(contacts(lying(0.51)))[0].startswith(remark)
    assert coincident_remarks(contacts(lying(0.49))) == []
    judge(lying(0.51))
    judge(lying(0.49))
    judge(fastened(lying(0.51), [("a", "b")]))
    judge(Assembly([*lying(0.51, grounded=True).parts, block("c", [3, 0, 0], [4, 1, 1])]))


@pytest.mark.slow
def test_the_likely_reason_is_told() -> None:
    frames = [block(f"part-{k}", [-k - 1, -1, -1], [k + 1, 1, 1]) for k in range(3)]
    with pytest.raises(InputError, match="each file seems to be in a frame of its own; export"):
        check(Assembly([block("g", [-9, -9, -9], [9, 9, -8], grounded=True), *frames]))
    twice = [block("one", [0, 0, 0], [1, 1, 1], grounded=True), block("two", [0, 0, 0], [1, 1, 1])]
    answer = check(Assembly(twice))
    assert any(
        w.startswith("'one' and 'two' are the same body twice: a copy") for w in answer.warnings
    )
    assert answer.verdict == "undecided"
    assert "--without two" in [remedy.option for remedy in answer.remedies]
    inside = [tube("body", 1, 4, 4, grounded=True), pin("insert", 0.5, 2, [2.5, 0, 0])]
    answer = check(Assembly(inside))
    reason = "'insert' lies inside 'body': misplaced, or drawn with"
    assert any(w.startswith(reason) for w in answer.warnings)
    assert check(fastened(Assembly(inside), suggested=True)).verdict == "stable"
    low = [block("post", [0, 0, 0], [1, 1, 10]), block("plate", [3, 0, 0], [5, 1, 0.5])]
    with pytest.raises(InputError, match="'plate' lies inside 'floor': the table is too high"):
        check(Assembly(low).with_floor(1.0))


@pytest.mark.parametrize("count", [2, 3])
def test_a_whole_beside_its_parts_is_named_and_left_out(count: int) -> None:
    """The whole is a bar of unit cubes; with one cube in a longer bar it is only misplaced."""
    cubes = [block(f"cube-{k}", [k, 0, 0], [k + 1, 1, 1]) for k in range(count)]
    table = block("table", [-1, -1, -1], [9, 2, 0], grounded=True)
    whole = block("all", [0, 0, 0], [count, 1, 1])
    assembly = Assembly([table, whole, *cubes])
    (remark,) = coincident_remarks(contacts(assembly))
    assert "'all' is the whole beside its parts; leave the whole out with --without all" in remark
    assert remark in check(assembly).warnings
    assert parts_to_leave_out(contacts(assembly)) == ("all",)
    assert check(assembly.without("all")).verdict == "stable"
    longer = block("all", [0, 0, 0], [2 * count + 1, 1, 1])
    assert "whole beside" not in str(
        coincident_remarks(contacts(Assembly([table, longer, *cubes])))
    )


def test_frames_of_files_are_mentioned_only_for_several_files() -> None:
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
def test_a_nut_without_its_hole_is_no_part_in_the_wrong_place() -> None:
    """M8: a hexagon of 13 mm as a round of as much area, on a shank of 8 mm."""
    nut = pin("nut", 6.83, 6.5, grounded=True)
    found = check(Assembly([nut, pin("bolt", 4, 40)], units="mm"))
    assert found.verdict != "stable"
    (overlap,) = found.contact_set.overlaps
    assert overlap.share == pytest.approx((4 / 6.83) ** 2, rel=0.01)


@pytest.mark.slow
def test_a_raw_folder_is_refused_in_a_sentence_and_contacts_lists_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
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
    return Assembly([BASE, *feet, Part("peg", Box([1, 1, 1]), Pose([4, 4, 0.3]))])


def test_a_copy_that_overlaps_where_the_others_do_not_is_asked_about() -> None:
    told = [w for w in contacts(table_with((0, 0, 1), (3, 0, 0.9))).warnings if "right place" in w]
    assert told == [
        "is 'foot_1' in the right place? it overlaps 'base', but its copy 'foot_0' overlaps nothing"
    ]
    assert told[0] in check(table_with((0, 0, 1), (3, 0, 0.9))).warnings


@pytest.mark.parametrize("places", [[(0, 0, 1), (3, 0, 1)], [(0, 0, 0.9), (3, 0, 0.8)]])
def test_copies_that_all_overlap_or_none_are_not_asked_about(places) -> None:  # type: ignore[no-untyped-def]
    assert not any("placed" in w for w in contacts(table_with(*places)).warnings)


def test_a_copy_that_is_fastened_is_meant_so() -> None:
    assembly = table_with((0, 0, 1), (3, 0, 0.9))
    joined = fastened(assembly, [("base", "foot_1")])
    assert not any("placed" in w for w in check(joined).warnings)
