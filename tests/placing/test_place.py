"""Places of a part: by hand, by rules and by programs."""

import importlib.util
import json
import math
import re
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
import shapely
from planks import bridge, overhang
from scipy.optimize import nnls

import kilter
from kilter import Assembly, Box, InputError, Part, Places, Pose, box_to_place, place
from kilter.analysis.placing.place_proofs import case_prism
from kilter.analysis.placing.upright_prisms import Landings, PlacedLoads, find_tops
from kilter.cli import main
from kilter.contact import detect
from kilter.mechanics.certificate import check_forces
from kilter.mechanics.forms import scaled_problem
from kilter.mechanics.load_checks import check_load_forces
from kilter.mechanics.program import build_program
from kilter.scenes import scene
from kilter.scenes.pieces import block
from kilter.tell.text import text_of

SMALL = [1e-3, 1e-3, 0.1]
"""A box that is small, so that its centre and its contact are at the same place."""


def test_supports_far_aside_do_not_divide_the_places_on_others():
    table = Part("table", Box(60, 60, 1), [0, 0, -0.5], grounded=True)

    def places(pairs):
        posts = [
            Part(f"post {k} {x}", Box(0.5, 0.5, 1), [10.0 * k + x, 0.07 * k, 0.5])
            for k in range(pairs)
            for x in (-0.6, 0.6)
        ]
        plank = Part("plank", Box(1.5, 0.4, 0.3))
        found = place(Assembly([table, *posts], friction=0.5), plank, mass=1.0)
        [level] = [level for level in found.levels if level.height > 1]
        return found.programs, level.stands.area

    programs, area = places(1)
    more, wide = places(3)
    assert wide == pytest.approx(3 * area, rel=1e-3)
    assert more <= 3 * programs


def test_no_top_is_searched_on_an_assembly_that_falls_without_the_load():
    table = Part("table", Box(20, 4, 1), [0, 0, -0.5], grounded=True)
    posts = [Part(f"post {k}", Box(0.5, 0.5, 1), [2.0 * k, 0, 0.5]) for k in range(-4, 5)]
    loose = Part("loose", Box(0.5, 0.5, 0.5), [2, 1.5, 2.0])
    falls = place(Assembly([table, *posts, loose], friction=0.0), box_to_place(SMALL, 1.0))
    stands = place(Assembly([table, *posts], friction=0.0), box_to_place(SMALL, 1.0))
    assert falls.programs <= 2 < 9 <= stands.programs
    assert all(level.stands.is_empty for level in falls.levels)
    assert not all(level.stands.is_empty for level in stands.levels)


def seesaw(weight: float, half: float) -> Assembly:
    base = Part("base", Box([2 * half, 1, 1]), Pose([0, 0, -0.5]), grounded=True)
    return Assembly([base, Part("plank", Box([2, 1, 0.1]), Pose([0, 0, 0.05]), mass=weight)])


def on_top(places: Places, height: float) -> shapely.Geometry:
    [level] = [
        level for level in places.levels if math.isclose(level.height - places.prism.below, height)
    ]
    return level.stands


@pytest.mark.parametrize(
    ("length", "weight", "beyond", "load"), [(1, 2, 0.3, 2.5), (1, 2, 0.4, 1), (1.2, 5, 0.5, 2)]
)
def test_a_load_on_an_overhanging_plank(length, weight, beyond, load):
    limit = weight * (length / 2 - beyond) / load
    assembly, part = overhang(length, weight, beyond), box_to_place(SMALL, load)
    places = place(assembly, part, accuracy=1e-3)
    assert on_top(places, 0.1).bounds[2] == pytest.approx(limit, abs=1e-9)
    for side, verdict in ((-1e-6, "stable"), (1e-6, "unstable")):
        at = place(assembly, part, at=[limit + side, 0]).at
        assert at is not None
        assert at.verdict == verdict


@pytest.mark.parametrize("friction", [0.0, 0.4])
def test_no_place_on_a_held_part_stands_while_another_part_falls(friction):
    """A plank falls off the table unless the load on it lies far enough behind the edge."""
    falling = overhang(1, 2, 0.6).with_friction(friction)
    part = box_to_place(SMALL, 1)
    places = place(falling, part, accuracy=1e-3)
    assert [level.stands.area > 0 for level in places.levels] == [False, True]
    assert places.levels[0].open.area == 0
    assert on_top(places, 0.1).bounds[2] == pytest.approx(-2 * 0.1, abs=1e-6)
    for x, falls in ((-2, True), (-0.2 - 1e-5, False), (-0.2 + 1e-5, True)):
        at = place(falling, part, at=[x, 0], require="equilibrium").at
        assert at is not None
        assert (at.verdict == "unstable") == falls


@pytest.mark.parametrize(("x", "heaviest"), [(0.1, 4.0), (0.2, 2.0), (0.25, 1.6)])
def test_the_heaviest_load_at_a_place(x, heaviest):
    at = place(overhang(1, 2, 0.3), box_to_place(SMALL, 1.0), at=[x, 0]).at
    assert at is not None
    assert at.heaviest == pytest.approx(heaviest, rel=1e-6)


def test_order_decides_on_the_seesaw():
    """Two equal loads balance anywhere, but the first must stand alone."""
    alone, first = seesaw(2, 0.1), box_to_place([0.2, 0.2, 0.2], 8, name="first")
    assert not place(alone, first, at=[0.8, 0]).stands
    inner = place(alone, first, at=[0.1, 0]).at
    assert inner is not None
    both = place(
        inner.worst.assembly, box_to_place([0.2, 0.2, 0.2], 8, name="second"), at=[-0.7, 0]
    )
    assert not both.stands
    later = place(
        inner.worst.assembly, box_to_place([0.2, 0.2, 0.2], 1, name="light"), at=[-0.3, 0]
    )
    assert later.stands


def test_the_map_of_a_tower_is_its_top():
    places = place(scene("tower"), box_to_place([0.5, 0.5, 0.5], 1.0))
    assert places.stands
    top = shapely.box(-0.5, -0.5, 0.5, 0.5)
    assert shapely.symmetric_difference(on_top(places, 5.0), top).area < 1e-12
    assert places.best is not None
    assert (places.best.x, places.best.y, places.best.height) == pytest.approx(
        (0, 0, 5.25), abs=1e-6
    )
    data = places.to_dict()
    assert json.loads(json.dumps(data)) == data


def test_a_gripper_needs_room():
    table = Part("table", Box([4, 4, 1]), Pose([0, 0, -0.5]), grounded=True)
    tower = Part("tower", Box([1, 1, 2]), Pose([0, 0, 1]), mass=1)
    part = box_to_place([0.5, 0.5, 0.5], 1)
    free = on_top(place(Assembly([table, tower]), part), 0.0)
    clear = on_top(place(Assembly([table, tower]), part, clear=0.2), 0.0)
    assert free.covers(shapely.Point(0.8, 0))
    assert not clear.covers(shapely.Point(0.9, 0))
    assert clear.covers(shapely.Point(0.96, 0))


def test_a_part_without_a_level_top_is_left_open():
    table = Part("table", Box([4, 4, 1]), Pose([0, 0, -0.5]), grounded=True)
    ball = Part("ball", kilter.Sphere(0.5), Pose([0, 0, 0.5]), mass=1)
    places = place(Assembly([table, ball]), box_to_place([0.5, 0.5, 0.5], 1))
    assert "open" in places.warnings[0]
    level = places.levels[-1]
    assert level.stands.area == 0
    assert level.falls.area == 0
    assert level.open.area > 0


def test_places_that_are_only_open_are_undecided(tmp_path, capsys):
    """The top of a ball is left open; no light box holds a plank that falls."""
    ball = Part("ball", kilter.Sphere(1.0), Pose([0, 0, 1]), grounded=True)
    for assembly, code, said in (
        (Assembly([ball]), 4, "No place is proved"),
        (overhang(1, 2, 0.95), 1, "There is no place"),
    ):
        file = tmp_path / "file.kilter.json"
        kilter.dump(assembly, file)
        assert main(["place", str(file), "--box", "0.2x0.2x0.2", "--mass", "1"]) == code
        assert said in capsys.readouterr().out


WRONG = [
    (["--mass", "1"], "the part to put down is not given"),
    (["--box", "1x1", "--mass", "1"], "--box is '1x1'"),
    (["--box", "1x1x1"], "the mass of the box is not given"),
    (["--box", "1x1x-1", "--mass", "1"], ""),
    (["--box", "1x1x1", "--mass", "0"], ""),
    (["--box", "1x1x1", "--mass", "1", "--at", "90", "0"], "nothing is below the part"),
    (["--box", "1x1x1", "--mass", "1", "--part", "x.json"], "both given"),
    (["--box", "1x1x1", "--mass", "1", "--at", "0", "0", "--clear", "1"], "clear is a distance"),
    (["--box", "1x1x1", "--mass", "1", "--at", "0", "0", "--turn", "0", "--turn", "90"], "several"),
]


@pytest.mark.parametrize(("words", "said"), WRONG)
def test_a_wrong_question_is_refused(words, said, tmp_path, capsys):
    file = tmp_path / "tower.kilter.json"
    kilter.dump(scene("tower"), file)
    assert main(["place", str(file), *words]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert error.count("\n") == 1


def test_exit_codes(tmp_path, capsys):
    file = tmp_path / "plank.kilter.json"
    kilter.dump(overhang(1, 2, 0.3), file)
    part = ["--box", "0.01x0.01x0.1", "--mass", "2.5"]
    assert main(["place", str(file), *part]) == 0
    assert main(["place", str(file), *part, "--at", "0.1", "0"]) == 0
    assert main(["place", str(file), *part, "--at", "0.2", "0"]) == 1
    assert "would move" in capsys.readouterr().out


def test_gravity_must_act_downwards():
    with pytest.raises(InputError, match="gravity along -z"):
        place(scene("tower").with_down([1, 0, -1]), box_to_place(SMALL, 1))


def test_a_turned_box_has_a_turned_footprint():
    part = box_to_place([2.0, 1.0, 0.5], 1.0, turn=90)
    corners = Assembly([part]).geometry.vertices
    assert np.ptp(corners, axis=0) == pytest.approx([1.0, 2.0, 0.5])


@pytest.mark.parametrize("suffix", [".svg", ".png"])
@pytest.mark.slow
def test_the_map_has_a_figure(suffix, tmp_path):
    file, figure = tmp_path / "plank.kilter.json", tmp_path / f"map{suffix}"
    kilter.dump(overhang(1, 2, 0.3), file)
    part = ["--box", "0.1x0.1x0.1", "--mass", "2.5"]
    assert main(["place", str(file), *part, "--figure", str(figure)]) == 0
    assert figure.stat().st_size > 5000
    with pytest.raises(InputError, match="no map to draw"):
        kilter.draw(place(overhang(1, 2, 0.3), box_to_place(SMALL, 1), at=[0, 0]))


def test_a_given_place_has_no_figure(tmp_path, capsys):
    file = tmp_path / "plank.kilter.json"
    kilter.dump(overhang(1, 2, 0.3), file)
    words = ["--box", "0.1x0.1x0.1", "--mass", "1", "--at", "0", "0", "--figure", "m.svg"]
    assert main(["place", str(file), *words]) == 2
    assert "a map has a figure" in capsys.readouterr().err


def density_warned(places: Places) -> bool:
    return any("kg/m^3 assumed" in warning for warning in places.warnings)


def with_plank(density: float | None, at: float, friction: float) -> Places:
    """A box of 5 kg on a plank of .05 m^3 that extends .3 m beyond its table."""
    table, plank = overhang(1, 2, 0.3).parts
    plank = replace(plank, given_mass=None, density=density)
    whole = Assembly([table, plank], friction=friction)
    return place(whole, box_to_place(SMALL, 5.0), at=[at, 0])


@pytest.mark.parametrize(
    ("at", "friction", "warned", "verdicts"),
    [
        (-0.3, 0.0, False, {"stable"}),  # over the table
        (0.1, 0.0, True, {"unstable", "stable"}),  # the plank is the counterweight
        (-0.3, 0.5, False, {"stable"}),  # friction is not needed
    ],
)
def test_the_default_density_is_a_warning_only_if_the_verdict_depends_on_it(
    at, friction, warned, verdicts
):
    assert density_warned(with_plank(None, at, friction)) == warned
    found = {with_plank(density, at, friction).at.verdict for density in (1.0, 1000.0, 1e5)}
    assert found == verdicts


def test_a_part_that_falls_at_every_density_has_no_warning():
    beside = place(scene("tower"), box_to_place([1, 1, 1], 2.0), at=[0.6, 0])
    assert not beside.stands
    assert beside.at.heaviest == 0.0
    assert "no mass is carried there" in text_of(beside.to_dict())
    assert not density_warned(beside)


def test_a_mixed_file_keeps_its_own_warning_about_density():
    base = Part("base", Box([2, 2, 1]), Pose([0, 0, -0.5]), grounded=True)
    light = Part("light", Box([1, 1, 1]), Pose([0, 0, 0.5]))
    assembly = Assembly([base, light, Part("heavy", Box([1, 1, 1]), [0, 0, 1.5], mass=3.0)])
    assert density_warned(place(assembly, box_to_place(SMALL, 1.0), at=[0, 0]))


@pytest.mark.slow
def test_a_page_shows_the_map_and_the_part(tmp_path, capsys):
    file, page = tmp_path / "tower.kilter.json", tmp_path / "map.html"
    kilter.dump(scene("tower"), file)
    asked = ["place", str(file), "--box", "0.5x0.5x0.5", "--mass", "1", "-o", str(page)]
    assert main(asked) == 0
    assert "page         written to" in capsys.readouterr().out
    html = page.read_text(encoding="utf-8")
    data = json.loads(html.split('type="application/json">')[1].split("</script>")[0])
    places = place(scene("tower"), box_to_place([0.5, 0.5, 0.5], 1.0))
    assert data["places"]["levels"] == places.to_dict()["levels"]
    assert data["places"]["part"]["footprint"] == places.prism.footprint.tolist()
    assert html.index('id="places"') < html.index('id="ball"')
    assert main([*asked, "--at", "0", "0"]) == 2
    assert "a page shows a map: no --at" in capsys.readouterr().err
    with pytest.raises(InputError, match="no map to show"):
        kilter.report(place(scene("tower"), box_to_place(SMALL, 1.0), at=[0, 0]))


ROOT = Path(__file__).resolve().parents[2]
FILE = ROOT / "benchmarks" / "place_rules.py"
PAGE = ROOT / "docs" / "explanation/placing.md"
PICTURE = ROOT / "docs" / "images" / "place-rules.svg"


@pytest.fixture(scope="module")
def benchmark() -> Iterator[ModuleType]:
    spec = importlib.util.spec_from_file_location("place_rules", FILE)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # dataclasses look up their module there
    spec.loader.exec_module(module)
    yield module
    del sys.modules[spec.name]


def counts_of_page(benchmark: ModuleType):
    """The counts in the table of the page."""
    text = PAGE.read_text(encoding="utf-8")
    counts = benchmark.RuleCounts()
    [(stands, total)] = re.findall(r"stands at ([\d,]+) of ([\d,]+) places", text)
    counts.stands = int(stands.replace(",", ""))
    counts.falls = int(total.replace(",", "")) - counts.stands
    for rule in benchmark.RULES:
        row = rf"^\| {re.escape(rule)} \| ([\d,]+) \| \d+ % \| ([\d,]+) \| \d+ % \|$"
        [(falls, rejected)] = re.findall(row, text, flags=re.M)
        counts.accepted_falls[rule] = int(falls.replace(",", ""))
        counts.rejected_stands[rule] = int(rejected.replace(",", ""))
    return counts


def test_rules_and_program_on_a_counterbalanced_plank(benchmark):
    """A load x beyond the edge stands up to W (L / 2 - e) / w = 0.16; LBCP ends at the edge."""
    block, plank = [0, 0, 0, 1, 1, 0.5], [0.3, 0, 0.5, 1, 1, 0.125]
    for beyond, stands, bearing in (
        (-0.01, True, True),
        (0.159, True, False),
        (0.161, False, False),
    ):
        load = [1 + beyond - 0.0005, 0.4995, 0.625, 0.001, 0.001, 0.125]
        boxes = np.array([block, plank, load])
        assert benchmark.balanced(boxes, np.array([5, 2, 2.5])) is stands
        answer = benchmark.answers(boxes, benchmark.load_bearing(boxes[:2]))
        assert answer["LBCP"] is bearing
        assert answer["full support"]


def test_the_table_and_picture_of_the_page_are_those_of_the_command(benchmark):
    counts = counts_of_page(benchmark)
    assert counts.stands + counts.falls <= 60 * benchmark.PLACES
    assert benchmark.table(counts) in PAGE.read_text(encoding="utf-8")
    assert benchmark.figure(counts) == PICTURE.read_text(encoding="utf-8")


def test_undecided_places_have_a_reason(benchmark):
    counts = benchmark.RuleCounts(undecided=2, gaps=[1.3e-4, 4e-4])
    assert benchmark.undecided_words(counts).startswith("2 places undecided (the pile holds only")
    assert "0.13 to 0.40 mm apart" in benchmark.undecided_words(counts)
    assert benchmark.undecided_words(benchmark.RuleCounts()) == "0 places undecided"


AREAS = {1: shapely.box(-0.3, -0.2, -0.2, 0.3), 3: shapely.box(0.2, -0.2, 0.4, 0.3)}


def loads_on_bridge() -> PlacedLoads:
    assembly = bridge()
    prism, _ = case_prism(box_to_place([0.7, 0.5, 0.2], 1.5), "m")
    return PlacedLoads(build_program(assembly, detect.contacts(assembly)), prism, 0.0)


def test_shared_columns_are_those_of_the_whole_program():
    loads = loads_on_bridge()
    program, _ = loads.on_areas(AREAS, 0.1, np.array([0.05, 0.02]))
    whole, extended = scaled_problem(program), scaled_problem(program, loads.alone)
    assert extended.matrix.shape == whole.matrix.shape == (18, len(program.part_a))
    assert abs(extended.matrix - whole.matrix).max() < 1e-14
    assert np.abs(extended.right - whole.right).max() < 1e-14
    assert np.allclose(extended.frame, whole.frame)


def test_forces_under_several_loads_are_checked_as_one_by_one():
    """The forces of the first load balance it; under the other loads they do not."""
    loads = loads_on_bridge()
    program, wrenches = loads.on_areas(AREAS, 0.1, np.array([0.0, 0.05]))
    matrix = scaled_problem(program, loads.alone)
    forces = matrix.forces(nnls(matrix.matrix.toarray(), matrix.right)[0])
    shifts = np.array([[0.0, 0.0], [0.1, 0.0], [0.0, -1e-3]])
    more = np.tensordot(shifts, wrenches, axes=1)
    together = check_load_forces(program, more, np.tile(forces, (3, 1)))
    for load, proof in zip(more, together, strict=True):
        alone = check_forces(program.with_rows(applied=program.applied + load), forces)
        assert abs(proof.residual - alone.residual) <= 1e-12 * max(alone.residual, 1)
        assert proof.holds == alone.holds
        assert (proof.forces == alone.forces).all()
    assert [proof.holds for proof in together] == [True, False, False]


def test_friction_under_several_loads_is_checked_as_one_by_one():
    """Friction at random, in part beyond its cones and with numbers that are not finite."""
    program, wrenches = loads_on_bridge().on_areas(AREAS, 0.1, np.array([0.0, 0.05]))
    rng, count = np.random.default_rng(5), len(program.part_a)
    program = program.with_rows(mu=np.where(np.arange(count) % 3, 0.6, 0.0))
    forces, friction = rng.normal(size=(4, count)), rng.normal(size=(4, count, 3))
    friction[1, 2, 0], forces[2, 3] = np.nan, np.inf
    more = np.tensordot(rng.normal(size=(4, 2)), wrenches, axes=1)
    together = check_load_forces(program, more, forces, friction)
    for load, along, across, proof in zip(more, forces, friction, together, strict=True):
        loaded = program.with_rows(applied=program.applied + load)
        alone = check_forces(loaded, along, across)
        assert proof.residual == pytest.approx(alone.residual, rel=1e-12)
        assert np.allclose(proof.forces, alone.forces, rtol=1e-12)
        assert np.allclose(proof.friction, alone.friction, rtol=1e-12, atol=1e-15)


def test_places_of_a_first_touch_have_an_edge_of_the_top_in_common():
    """A part of length 1 begins to touch the top [0, 2] with its centre at -0.5."""
    base = Part("base", Box([2, 2, 1]), Pose([1, 0, -0.5]), grounded=True)
    tops = find_tops(Assembly([base]))
    prism, _ = case_prism(box_to_place([1, 1, 1], 1.0), "m")
    landings = Landings(tops, prism, 1e-6)
    low, high = np.array([-0.5, -0.1]), np.array([-0.3, 0.1])
    [area] = landings.areas(tops, low, high, any_place=False).values()
    assert np.allclose(area.bounds, [0, -0.4, 0, 0.4], atol=1e-8)
    assert not landings.areas(tops, low - [1e-3, 0], high, any_place=False)
    assert not landings.areas(tops, low - [0.4, 0], high - [0.2, 0], any_place=True)


def test_a_first_touch_of_a_support_is_decided_exactly():
    """A box over the gap of two tables stands from the first touch of the second table on.

    It touches both tables if its centre is within 0.2 of the middle, and its centre is then
    between them. Its places on a single table end at the edges of the tables.
    """
    tables = [
        Part(f"table-{k}", Box([2, 2, 1]), Pose([x, 0, -0.5]), mass=50)
        for k, x in enumerate((-1.3, 1.3))
    ]
    floor = Part("floor", Box([8, 4, 1]), Pose([0, 0, -1.5]), grounded=True)
    answer = place(Assembly([floor, *tables]), box_to_place([1, 1, 1], 1.0))
    [level] = [level for level in answer.levels if abs(level.height - answer.prism.below) < 1e-9]
    between = shapely.box(-0.2, -1, 0.2, 1)
    assert shapely.difference(between, level.stands).area < 1e-9
    beside = shapely.box(0.2, -1, 0.3, 1)
    assert shapely.difference(beside, level.falls).area < 1e-9
    assert answer.programs < 100


def test_a_pair_that_decides_is_the_reason_of_open_places():
    """A held part just above the far end of a plank may hold it down, or not touch it."""
    plank = overhang(1, 2, 0.3)
    part = box_to_place([1e-3, 1e-3, 0.1], 2.5)
    for gap, warned in ((1e-4, True), (0.05, False)):
        clamp = Part("clamp", Box([0.2, 1, 1]), Pose([-0.7, 0, 0.6 + gap]), grounded=True)
        answer = place(plank.with_parts([clamp]), part)
        text = " ".join(answer.warnings)
        assert ("'plank' and 'clamp' touch" in text) == warned
        [level] = [
            level for level in answer.levels if abs(level.height - answer.prism.below - 0.1) < 1e-9
        ]
        # without the clamp the limit is 0.16, and the end of the plank is at 0.3
        assert level.stands.bounds[2] <= 0.16 + 1e-9
        open_area = shapely.intersection(level.open, shapely.box(0.17, -0.4, 0.29, 0.4)).area
        assert (open_area > 0.09) == warned


BASE = block("base", [-500, -500, -10], [0, 500, 0], grounded=True)
PLANK = Part("plank", Box([600, 200, 20]), [-100, 0, 10], density=500.0)
"""A plank of 1.2 kg from x = -400 to 200, which reaches 200 mm beyond its base."""
ASSEMBLY = Assembly([BASE, PLANK], units="mm")
LOAD = Part("load", Box([100, 100, 100]), mass=1.0)


def area(polygons: list) -> shapely.Geometry:
    return shapely.union_all([shapely.Polygon(outline, holes) for outline, *holes in polygons])


def test_the_places_of_a_load_on_a_base_and_on_a_plank_beyond_its_edge():
    """On the plank it may stand up to x = 1.2 kg x 100 mm / 1 kg beyond the edge of the base."""
    answer = kilter.place(ASSEMBLY, LOAD, mass=1.0).to_dict()
    assert (answer["mass"], answer["center_within"]) == ([1.0, 1.0], 0.0)
    low, high = answer["levels"]
    assert (low["height"], high["height"]) == (50, 70)
    # the load of 100 x 100 has its centre 50 from each side of the plank, or farther
    on_base = shapely.box(-500, -500, 0, 500) - shapely.box(-450, -150, 250, 150)
    on_plank = shapely.box(-400, -100, 120, 100)
    for level, stands in ((low, on_base), (high, on_plank)):
        assert shapely.symmetric_difference(area(level["stands"]), stands).area < 1
        assert level["area"] == pytest.approx(stands.area, rel=1e-6)
        assert level["open_strip"] == pytest.approx(area(level["open"]).area, abs=1e-6)
        assert level["open_strip"] < 1
        assert area(level["stands"]).intersection(area(level["falls"])).area < 1e-6
    reach = shapely.box(-450, -150, 250, 150)  # of a load that touches the plank
    assert shapely.symmetric_difference(area(high["falls"]), reach - on_plank).area < 1
    # the largest circle of places: in the strip beside the plank, or between its end and the edge
    best = answer["best"]
    assert best["margin"] == pytest.approx(350 / 2, abs=answer["accuracy"])
    assert (abs(best["y"]), best["height"]) == (pytest.approx(325, abs=answer["accuracy"]), 50)
    edge = on_base.boundary.distance(shapely.Point(best["x"], best["y"]))
    assert best["margin"] == pytest.approx(edge, abs=1e-3)


@pytest.mark.parametrize("x", [80, 150])
def test_the_heaviest_load_at_a_place_on_the_plank(x):
    answer = kilter.place(ASSEMBLY, LOAD, at=[x, 10]).to_dict()
    at = answer["at"]
    assert (at["x"], at["y"], at["height"]) == (x, 10, 70)
    assert at["heaviest"] == pytest.approx(1.2 * 100 / x, rel=1e-6)
    assert answer["heaviest"] == at["heaviest"]
    assert (at["verdict"] == "stable") is (x < 120)


HEADER = "name,length/mm,width/mm,height/mm,mass/kg,x/mm,y/mm,z/mm,max_load/kg\n"


@pytest.mark.slow
def test_a_plan_whose_third_box_has_its_centre_beside_the_second(tmp_path):
    """Boxes of 400 mm: b on three fifths of a, c on a tenth of b and on nothing else."""
    plan = tmp_path / "plan.csv"
    rows = ["a,400,400,400,4,0,0,0,9", "b,400,400,400,3,160,0,400,", "c,400,400,400,2,520,0,800,"]
    plan.write_text(HEADER + "\n".join(rows))
    answer = kilter.check_plan(plan, friction=0.4).to_dict()
    a, b, c = answer["items"]
    assert [one["line"] for one in (a, b, c)] == [2, 3, 4]
    assert [one["mass"] for one in (a, b, c)] == [4, 3, 2]
    assert [one["share"] for one in b["support"]] == [pytest.approx(0.6)]
    assert [one["share"] for one in c["support"]] == [pytest.approx(0.1)]
    assert (a["max_load"], answer["first"], answer["friction"]) == (9, 3, 0.4)
    assert answer["walls"]["inner_size"] == [520 + 400, 400]
    # d keeps the walls away from c, which falls between them
    plan.write_text(HEADER + "\n".join([*rows, "d,400,400,400,9,1600,0,0,"]))
    walls = kilter.check_plan(plan, friction=0.4).to_dict()["walls"]
    assert (walls["inner_size"], walls["first"]) == ([2000, 400], 3)


@pytest.mark.slow
def test_a_pile_of_two_boxes_tips_about_the_foot_of_the_lower_one(tmp_path):
    """4 kg at (200, 200) and 3 kg at (250, 600) stand on a foot from x = 0 to 400."""
    plan = tmp_path / "plan.csv"
    plan.write_text(HEADER + "a,400,400,400,4,0,0,0,\nb,400,400,400,3,50,0,400,\n")
    answer = kilter.check_plan(plan, friction=0.6, carried=True).to_dict()
    x, z = (4 * 200 + 3 * 250) / 7, (4 * 200 + 3 * 600) / 7
    expected = {"+x": x / z, "-x": (400 - x) / z, "+y": 200 / z, "-y": 200 / z}
    found = {one["direction"]: one["g"] for one in answer["carried"]}
    assert found == pytest.approx({**expected, "least": min(expected.values())}, rel=1e-6)
