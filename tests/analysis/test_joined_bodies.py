"""Bodies of parts that touch: support, tilt, nearest part and fall, from closed forms."""

import math
from dataclasses import replace

import numpy as np
import pytest

import kilter
from kilter import Assembly, Box, Cylinder, Joint, Part, Pose, Sphere, contacts
from kilter.analysis.assumptions.assume import assume, falls_surely, judged
from kilter.analysis.assumptions.joined_bodies import beyond_feet, bodies_of
from kilter.analysis.assumptions.joining import joined
from kilter.analysis.assumptions.tipping_over import rest_after_tipping
from kilter.analysis.check import check_level
from kilter.analysis.settled_pose import straight_falls
from kilter.assembly.assumption import Body
from kilter.assembly.question import Question
from kilter.scenes.pieces import block
from kilter.tell.text import text_of


def bodies(assembly: Assembly) -> tuple[Body, ...]:
    return bodies_of(assembly, contacts(assembly))


def shelf() -> list[Part]:
    """Six boards that touch in faces: a bottom, two sides, a middle, a top, and a long back."""
    return [
        block("bottom", [0, 0, 0], [0.8, 0.3, 0.02]),
        block("left", [0, 0, 0.02], [0.02, 0.3, 1.0]),
        block("right", [0.78, 0, 0.02], [0.8, 0.3, 1.0]),
        block("middle", [0.02, 0, 0.5], [0.78, 0.3, 0.52]),
        block("top", [0, 0, 1.0], [0.8, 0.3, 1.02]),
        block("back", [0, 0.3, 0.1], [0.8, 0.31, 0.9]),
    ]


def center_of(parts: list[Part]) -> np.ndarray:
    geometry = Assembly(parts).geometry
    return geometry.mass @ geometry.center / geometry.mass.sum()


def test_six_boards_are_one_body_that_tips_at_the_known_tilt():
    parts = shelf()
    [body] = bodies(Assembly(parts).with_floor())
    x, y, z = center_of(parts)
    limits = {(0, 1): math.atan((0.3 - y) / z), (0, -1): math.atan(y / z),
              (1, 0): math.atan((0.8 - x) / z), (-1, 0): math.atan(x / z)}  # fmt: skip
    way, least = min(limits.items(), key=lambda item: item[1])
    assert (body.name, len(body.parts), body.on_floor) == ("back", 6, True)
    assert body.parts[0] == "back"
    assert (body.nearest, body.below, body.fall) == (None, None, None)
    assert body.mass == pytest.approx(sum(Assembly(parts).geometry.mass))
    assert body.tilt_deg == pytest.approx(math.degrees(least), abs=1e-9)
    turned = [way[0] * math.sin(least), way[1] * math.sin(least), -math.cos(least)]
    assert body.tilt_down == pytest.approx(turned, abs=1e-12)


@pytest.mark.parametrize(("share", "holds"), [(0.999, True), (1.001, False)])
def test_the_joined_assembly_holds_below_the_tilt_and_falls_above_it(share, holds):
    assembly = Assembly(shelf(), friction=5.0).with_floor()
    found = contacts(assembly)
    [body] = bodies_of(assembly, found)
    angle = share * math.radians(body.tilt_deg)
    level = body.tilt_down - (body.tilt_down @ assembly.down) * assembly.down
    down = math.cos(angle) * assembly.down + math.sin(angle) * level / np.linalg.norm(level)
    tilted = joined(assembly, found).with_down(down)
    assert (kilter.check(tilted, effort=0).level is not None) is holds


@pytest.mark.parametrize("down", [[0.1, -0.05, -1], [0.2, 0.1, -1]])
def test_the_tilt_is_measured_from_the_given_direction_of_gravity(down):
    assembly = Assembly([block("box", [0, 0, 0], [1, 1, 1])]).with_floor().with_down(down)
    [body] = bodies(assembly)
    faces = np.array([[1, 0, 1], [-1, 0, 1], [0, 1, 1], [0, -1, 1]]) / math.sqrt(2)
    # the planes through the centre and the lower edges: the box holds while it lies above them
    assert body.tilt_deg == pytest.approx(
        math.degrees(min(np.arcsin(-faces @ assembly.down))), abs=1e-9
    )
    assert min(np.abs(faces @ body.tilt_down)) == pytest.approx(0, abs=1e-12)


@pytest.mark.parametrize(
    ("shift", "degrees"), [(0.499, math.degrees(math.atan(0.001))), (0.5, 0.0), (0.6, 0.0)]
)
def test_a_body_whose_centre_is_not_above_its_support_tips_at_once(shift, degrees):
    post = Part("post", Box([1, 1, 0.5]), Pose([0, 0, 0.25]), mass=1e-9)
    top = Part(
        "top", Box([1, 1, 1.5]), Pose([shift, 0, 1.25]), mass=1.0, center_of_mass=[0, 0, -0.25]
    )
    [body] = bodies(Assembly([post, top]).with_floor())
    assert body.tilt_deg == pytest.approx(degrees, abs=1e-6)


def test_held_bodies_come_first_and_have_no_tilt():
    base = block("base", [0, 0, 0], [1, 1, 1], grounded=True)
    cube = block("cube", [0, 0, 1], [1, 1, 2])
    far = Part("far", Box([3, 3, 3]), Pose([9, 0, 0]))
    first, second = bodies(Assembly([far, cube, base]))
    assert (first.parts, first.on_floor, first.tilt_deg) == (("cube", "base"), True, None)
    assert (second.name, second.on_floor, second.nearest) == ("far", False, "cube")
    assert second.distance == pytest.approx(6.5)
    hung = Assembly([far, cube], joints=[Joint(("ground", "cube"), point=[0, 0, 5])])
    assert [(body.name, body.on_floor) for body in bodies(hung)] == [("cube", True), ("far", False)]


def test_two_bodies_on_a_floor_are_not_one_body_and_each_has_its_tilt():
    heavy, light = block("heavy", [0, 0, 0], [2, 2, 2]), block("light", [3, 0, 0], [4, 1, 0.5])
    found = bodies(Assembly([light, heavy]).with_floor())
    assert [(body.name, body.on_floor) for body in found] == [("heavy", True), ("light", True)]
    tilts = [45.0, math.degrees(math.atan(2))]
    assert [body.tilt_deg for body in found] == pytest.approx(tilts, abs=1e-9)


def keypad() -> Assembly:
    """A board on a floor, lamps .035 above it, and a bridge of two parts 2 above it [mm]."""
    lamps = [Part(f"LED_{k}", Box(1, 1, 1), Pose([3 * k, 0, 1.535])) for k in range(5)]
    board = block("board", [-5, -5, 0], [20, 5, 1])
    bridge = [block("span", [-5, 2, 3], [20, 3, 4]), block("stub", [0, 2, 4], [1, 3, 5])]
    return Assembly([*lamps, *bridge, board], units="mm").with_floor()


def test_loose_bodies_have_their_nearest_part_and_their_fall():
    board, span, *lamps = bodies(keypad())
    assert board.on_floor
    assert (span.parts, span.nearest, span.below) == (("span", "stub"), "LED_0", "board")
    assert span.distance == pytest.approx(math.hypot(1.5, 3 - 2.035))
    assert span.fall == pytest.approx(2)
    for lamp in lamps:
        assert (lamp.nearest, lamp.below) == ("board", "board")
        assert (lamp.distance, lamp.fall) == (pytest.approx(0.035), pytest.approx(0.035))


@pytest.mark.parametrize("order", [1, -1])
def test_a_body_beside_all_others_falls_onto_the_floor_or_onto_nothing(order):
    aside = block("aside", [5, 0, 2], [6, 1, 3])
    alone = Assembly([block("cube", [0, 0, 0], [1, 1, 1]), aside][::order])
    second = {body.name: body for body in bodies(alone)}["aside"]
    assert (second.nearest, second.below, second.fall) == ("cube", None, None)
    assert second.distance == pytest.approx(math.hypot(4, 1))
    second = bodies(alone.with_floor())[1]
    assert (second.nearest, second.distance) == ("floor", pytest.approx(2))
    assert (second.below, second.fall) == ("floor", pytest.approx(2))


@pytest.mark.parametrize("sideways", [0.0, 0.3])
def test_a_ball_falls_onto_exact_surfaces(sideways):
    """Ball of radius 1 above a held ball of radius 1: the centres meet at a distance of 2."""
    low = Part("low", Sphere(1.0), Pose([0, 0, 0]), grounded=True)
    high = Part("high", Sphere(1.0), Pose([sideways, 0, 3]))
    [ball] = bodies(Assembly([low, high]))
    assert ball.fall == pytest.approx(3 - math.sqrt(4 - sideways**2), abs=1e-9)


def test_a_pin_in_a_wide_hole_falls_onto_the_bottom_line():
    """Known answer 10: a ring of inner diameter 2 around a bar of diameter 1.6 drops .2."""
    bar = Part("bar", Cylinder(0.8, 6.0), Pose([0, 0, 0], [math.sqrt(0.5), math.sqrt(0.5), 0, 0]))
    ring = kilter.scenes.pieces.tube("ring", 1.0, 1.5, 2.0)
    ring = replace(ring, pose=Pose([0, 0, 0], [math.sqrt(0.5), math.sqrt(0.5), 0, 0]))
    [loose] = bodies(Assembly([replace(bar, grounded=True), ring]))
    assert (loose.name, loose.below) == ("ring", "bar")
    assert loose.fall == pytest.approx(0.2, abs=1e-6)


@pytest.mark.parametrize(("clearance", "exact"), [(0.01, True), (0.2, False)])
def test_the_distance_of_a_coaxial_pin_is_its_clearance(clearance, exact):
    """Exact for a small clearance; a large one is that of the triangles, within their accuracy."""
    pin = Part("pin", Cylinder(1.0 - clearance, 2.0), Pose([0, 0, 0]), grounded=True)
    found = contacts(Assembly([pin, kilter.scenes.pieces.tube("ring", 1.0, 1.5, 2.0)]))
    [ring] = found.bodies
    assert (ring.nearest, ring.below) == ("pin", None)
    assert (abs(ring.distance - clearance) < 1e-12) is exact
    assert abs(ring.distance - clearance) <= found.nearest[0].accuracy


def test_the_answer_of_contacts_lists_the_bodies_in_words_and_data():
    found = contacts(keypad())
    answer = found.to_dict()
    assert [body["name"] for body in answer["bodies"]][:2] == ["board", "span"]
    assert found.bodies[2].to_dict() == answer["bodies"][2]
    text = text_of(answer)
    assert "Bodies of parts that touch or overlap: 7, of which 6 are loose.\n" in text
    tips = f"tips at {found.bodies[0].tilt_deg:.3g} deg"
    assert f"board (1 part): on a floor or held, {tips}\n" in text
    assert "LED_* (5 bodies): 0.035 mm above board\n" in text
    assert "falls 2 mm onto board" in text


def test_without_a_floor_all_bodies_but_the_heaviest_are_loose():
    parts = keypad().without("floor")
    text = text_of(contacts(parts).to_dict())
    assert "board (1 part): the heaviest\n" in text
    assert "of which 6 are loose" in text
    [cube] = contacts(Assembly([block("cube", [0, 0, 0], [1, 1, 1])])).bodies
    assert (cube.on_floor, cube.nearest, cube.tilt_deg) == (False, None, None)


def test_held_parts_alone_are_no_body():
    assert bodies(Assembly([block("base", [0, 0, 0], [1, 1, 1], grounded=True)])) == ()


def folder_of(parts: list[Part], path) -> None:
    """Write each part as an STL file in mm."""
    for part in parts:
        part = replace(part, grounded=False)
        geometry = Assembly([part]).geometry
        corners = 1e3 * geometry.vertices[geometry.triangles]
        rows = ["solid s"]
        for triangle in corners:
            rows += ["facet normal 0 0 0", "outer loop"]
            rows += [f"vertex {' '.join(map(str, point))}" for point in triangle.tolist()]
            rows += ["endloop", "endfacet"]
        (path / f"{part.name}.stl").write_text("\n".join([*rows, "endsolid s"]))


def test_a_folder_of_files_in_frames_of_their_own_is_refused(tmp_path):
    boxes = {"arm": [0.03, 0.16, 0.02], "hand": [0.15, 0.04, 0.03], "finger": [0.012, 0.02, 0.2]}
    folder_of([block(name, [0, 0, 0], size) for name, size in boxes.items()], tmp_path)
    with pytest.raises(kilter.InputError, match="each file seems to be in a frame of its own"):
        kilter.check(str(tmp_path))


def test_a_folder_of_bolts_without_holes_is_answered(tmp_path):
    plate = block("plate", [0, 0, 0], [0.1, 0.1, 0.01])
    bolts = [block(f"bolt_{k}", [x, x, 0.002], [x + 0.01, x + 0.01, 0.03])
             for k, x in enumerate((0.01, 0.04, 0.07))]  # fmt: skip
    folder_of([plate, *bolts], tmp_path)
    assert kilter.check(str(tmp_path)).ladder[-1].level is not None


@pytest.mark.parametrize(
    ("gap", "beside", "level", "falls"),
    [
        (5e-5, 0.0, "proved", ()),  # within the play of the chip: it lands on the board
        (3e-4, 0.0, "proved", ()),
        (3e-4, 0.049, "proved", ()),  # its centre is above the board
        (3e-4, 0.051, None, ("chip",)),  # it tips over the edge of the board
        (0.01, 0.0, None, ("chip",)),  # beyond its play
    ],
)
@pytest.mark.slow
def test_bodies_that_fall_straight_have_the_verdict_of_the_search(gap, beside, level, falls):
    low, high = [0.04 + beside, 0.04, 0.002 + gap], [0.06 + beside, 0.06, 0.006 + gap]
    assembly = Assembly([
        block("board", [0, 0, 0], [0.1, 0.1, 0.002]), block("chip", low, high)
    ]).with_floor()  # fmt: skip
    asked = Question(assembly=assembly, contacts=contacts(assembly))
    straight, searched = (assume(asked, "joined", searches=s) for s in (False, True))
    if beside == 0.051:  # the chip lands on the edge, so that only a search shows its fall
        assert not straight.ended
        straight = searched
    for found in (straight, searched):
        verdict = judged(asked, found, check_level)
        assert (verdict.level, tuple(verdict.moving)) == (level, falls)
        assert not level or found.moved == pytest.approx(gap, abs=1e-12)


def test_listed_contacts_of_faces_on_a_floor_are_flat_and_others_are_open():
    """A chip may slide over the edge of its board; a floor has no edge."""
    assembly = Assembly([
        block("board", [0, 0, 0], [0.1, 0.1, 0.002]),
        block("chip", [0.04, 0.04, 0.00205], [0.06, 0.06, 0.006]),
    ]).with_floor()  # fmt: skip
    asked = Question(assembly=assembly, contacts=contacts(assembly))
    listed = assume(asked, "joined", searches=False).assembly.contacts
    assert {frozenset(contact.parts): contact.feature is None for contact in listed} == {
        frozenset(("board", "floor")): False,
        frozenset(("chip", "board")): True,
    }


def test_a_body_beyond_its_play_falls_whatever_a_search_finds_for_others():
    assembly = Assembly([
        block("board", [0, 0, 0], [0.1, 0.1, 0.002]),
        block("chip", [0.01, 0.01, 0.00205], [0.03, 0.03, 0.006]),
        block("far", [0.06, 0.06, 0.03], [0.08, 0.08, 0.04]),
    ]).with_floor()  # fmt: skip
    asked = Question(assembly=assembly, contacts=contacts(assembly))
    assert assume(asked, "joined", searches=False).surely_fall == ("far",)
    assert judged(asked, assume(asked, "joined"), check_level).moving == ["far"]


@pytest.mark.parametrize(("length", "surely"), [(0.3, True), (0.04, False)])
def test_a_body_whose_centre_is_beyond_all_its_feet_tips_without_a_search(length, surely):
    """With length .04 the centre, at .0141, is within the longest way of a part from the foot."""
    assembly = Assembly([
        block("foot", [0, 0, 0], [0.01, 0.02, 0.1]),
        block("bar", [0, 0, 0.1], [length, 0.02, 0.12]),
        block("chip", [0.02, 0, 0.12005], [0.03, 0.02, 0.13]),
    ]).with_floor()  # fmt: skip
    asked = Question(assembly=assembly, contacts=contacts(assembly))
    found = assume(asked, "joined", searches=False)
    assert found.ended is surely
    if surely:
        assert {"foot", "bar"} <= set(judged(asked, found, check_level).moving)


def board_on_two_screws(far: float = 0.005) -> Assembly:
    """A board .24 long whose two screws, with ends up to `far`, stick out .002 below it."""
    screws = [
        block(f"screw_{k}", [0.002, 0.02 + 0.05 * k, 0], [far, 0.03 + 0.05 * k, 0.002])
        for k in range(2)
    ]
    return Assembly([block("board", [0, 0, 0.002], [0.24, 0.1, 0.02]), *screws]).with_floor()


def test_a_board_on_two_screws_at_one_end_tips_and_rests_on_its_far_edge():
    [body] = bodies(board_on_two_screws())
    assert body.tilt_deg == 0.0
    assert body.rest_deg == pytest.approx(math.degrees(math.atan(0.002 / (0.24 - 0.005))), abs=1e-9)
    assert body.rests_on == ("board", "screw_0", "screw_1")


def test_bodies_beside_each_other_tip_or_stand_by_themselves():
    tipping, standing = board_on_two_screws(), board_on_two_screws(far=0.13)
    aside = [
        replace(part, name=f"far {part.name}", pose=Pose(part.pose.position + np.array([1, 0, 0])))
        for part in standing.without("floor").parts
    ]
    assembly = Assembly([*tipping.without("floor").parts, *aside]).with_floor()
    found = {body.name: body for body in bodies(assembly)}
    [alone], [still] = bodies(tipping), bodies(standing)
    assert found["board"].rest_deg == pytest.approx(alone.rest_deg, abs=1e-9)
    assert (found["board"].tilt_deg, found["board"].rests_on) == (0.0, alone.rests_on)
    assert found["far board"].tilt_deg == pytest.approx(still.tilt_deg, abs=1e-9)
    assert found["far board"].rest_deg is None


@pytest.mark.parametrize("heavy", [0.0, 0.45])
def test_a_ball_does_not_tip_onto_its_triangles_but_its_heavy_side_sinks(heavy):
    ball = Part("ball", Sphere(0.5), Pose([0.0, 0, 1.0], [0.8, 0.6, 0, 0]), mass=1.0,
                center_of_mass=[heavy, 0, 0])  # fmt: skip
    post = block("post", [1, 0, 0], [1.1, 0.1, 0.1])
    found = {body.name: body for body in bodies(Assembly([ball, post]).with_floor(0.0))}
    assert found["ball"].fall == pytest.approx(0.5)
    if heavy:
        assert found["ball"].rest_deg == pytest.approx(90.0, abs=10.0)  # a facet of the triangles
    else:
        assert found["ball"].rest_deg is None


@pytest.mark.parametrize("high", [0.05, 0.0])
def test_a_body_above_a_floor_falls_and_then_tips_like_one_on_it(high):
    lifted = [
        replace(part, pose=Pose(part.pose.position + np.array([0, 0, high])))
        for part in board_on_two_screws().without("floor").parts
    ]
    post = block("post", [1, 0, 0], [1.1, 0.1, 0.1])
    found = {body.name: body for body in bodies(Assembly([*lifted, post]).with_floor(0.0))}
    [alone] = bodies(board_on_two_screws())
    assert (found["board"].on_floor, found["board"].rests_on) == (high == 0, alone.rests_on)
    assert found["board"].rest_deg == pytest.approx(alone.rest_deg, abs=1e-9)
    if high:
        assert (found["board"].below, found["board"].fall) == ("floor", pytest.approx(high))


def test_a_board_on_screws_below_its_middle_stands():
    [body] = bodies(board_on_two_screws(far=0.13))
    assert body.tilt_deg > 0
    assert (body.rest_deg, body.rests_on) == (None, ())


def test_a_rounded_body_rolls_over_all_its_edges_to_its_rest():
    # a half disc as a polygon, heavy at one end of its flat top: it rolls until this end is below
    turn = np.linspace(np.pi, 2 * np.pi, 181)
    rim = np.column_stack([np.cos(turn), 0 * turn, np.sin(turn)])
    points = np.concatenate([rim, rim + np.array([0, 1, 0])])
    center = np.array([0.5 * np.cos(np.radians(-40)), 0.5, 0.5 * np.sin(np.radians(-40))])
    angle, feet = rest_after_tipping(points, center, np.array([0, 0, -1.0]))
    assert np.degrees(angle) == pytest.approx(50.0, abs=0.51)  # half a side of the polygon
    assert np.isin(rim[:, 0][feet % 181], rim[[139, 140, 141], 0]).all()
    upright = rest_after_tipping(points, np.array([0, 0.5, -0.4]), np.array([0, 0, -1.0]))
    assert upright is not None
    assert upright[0] == 0.0


@pytest.mark.parametrize("reach", [0.0, 0.02])
@pytest.mark.parametrize("more", [-1e-3, 1e-3])
def test_parts_whose_common_centre_is_beyond_all_points_that_may_reach_the_floor_tip(reach, more):
    # the centre of a foot of length a and a beam of length b on it is beyond c from this length on
    a, c = 0.1, 0.1 + 2 * reach
    b = c + math.sqrt(c**2 + 2 * a * c - a**2) + more
    parts = [block("foot", [0, 0, 0], [a, 0.1, 0.1]), block("beam", [0, 0, 0.1], [b, 0.1, 0.2])]
    assembly = Assembly(parts).with_floor()
    assert beyond_feet(assembly, np.array([0, 1]), reach) is (more > 0)
    held = replace(assembly, parts=[replace(parts[0], grounded=True), *assembly.parts[1:]])
    assert not beyond_feet(held, np.array([1]), reach)


@pytest.mark.parametrize(("fall", "falls"), [(0.0039, ()), (0.0041, ("high",))])
def test_a_body_falls_surely_if_its_fall_exceeds_its_play(fall, falls):
    # a large part has a play of .002, and this one is above two contacts
    parts = [block("low", [0, 0, 0], [0.1, 0.1, 0.1])]
    parts.append(block("high", [0, 0, 0.1 + fall], [0.1, 0.1, 0.2 + fall]))
    assert falls_surely(Question(assembly=Assembly(parts).with_floor())) == (False, falls)


def test_a_ball_falls_surely_only_if_its_triangles_could_not_end_the_fall():
    """The triangles of a ball lie inside of it, so their fall is longer than its own."""
    parts = [block("low", [0, 0, 0], [0.1, 0.1, 0.1])]
    found = []
    for fall in (0.00399, 0.01):
        ball = Part("ball", Sphere(0.05), [0.05, 0.05, 0.15 + fall])
        assembly = Assembly([*parts, ball]).with_floor()
        found.append(falls_surely(Question(assembly=assembly))[1])
    assert 0.00399 + assembly.geometry.slack.max() > 0.004
    assert found == [(), ("ball",)]


def test_a_fall_onto_many_curved_faces_is_that_of_their_triangles(monkeypatch):
    c, s = math.sqrt(0.5) * math.cos(0.02), math.sqrt(0.5) * math.sin(0.02)
    lying = Pose([0.05, 0.05, 0.2], [c, s, c, s])  # turned about its axis: no corner is lowest
    parts = [block("low", [0, 0, 0], [0.1, 0.1, 0.1]), Part("rod", Cylinder(0.03, 0.08), lying)]
    assembly = Assembly(parts).with_floor()
    falls = []
    for most in (1, 0):  # the rod has a single curved face
        monkeypatch.setattr(straight_falls, "MOST_CURVED", most)
        falls.append(bodies(assembly)[1].fall)
    assert falls[0] == pytest.approx(0.07, abs=1e-12)
    slack = assembly.geometry.slack.max()
    assert 0 <= falls[1] - 0.07 <= slack * (1 + 1e-9)
    assert falls[1] != falls[0]
