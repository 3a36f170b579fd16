"""Figures: drawings, numbers by hand, plans."""

import pytest

pytest.importorskip("matplotlib")


import dataclasses
import math
import re
import subprocess
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.patches import FancyArrowPatch
from matplotlib.text import Text

import kilter
from kilter import Assembly, Box, Part, Pose, Prism, Sphere
from kilter.cli import main
from kilter.files import to_text
from kilter.scenes import scene
from kilter.scenes.arches import arch
from kilter.scenes.pieces import block
from kilter.show.canvas import encode_figure, label
from kilter.show.figures import draw_assembly, draw_region
from kilter.show.painter import Camera, Polygon, back_to_front, visible_triangles
from kilter.show.scene import build_things
from sampled import sampled

HOSTILE = [
    "<script>alert(1)</script>",
    "a\"b'c&d",
    "x" * 10_000,
    "\u202egnp.exe",
    "اسم القطعة",
    "$\\frac{1}{0}$ $",
    "line\nbreak\x00",
    "日本語",
]


def words(figure: object) -> list[str]:
    from matplotlib.text import Text

    return [t.get_text() for t in figure.findobj(Text) if t.get_text()]  # type: ignore[attr-defined]


def lines(figure: object, kind: str) -> list[object]:
    return [a for a in figure.axes[0].get_children() if type(a).__name__ == kind]  # type: ignore[attr-defined]


def named(names: list[str]) -> Assembly:
    table = Part("table", Box([30, 4, 1]), Pose([0, 0, -0.5]), grounded=True)
    row = [Part(n, Box([1, 1, 1]), Pose([2.0 * k - 8, 0, 0.5])) for k, n in enumerate(names)]
    return Assembly([table, *row])


# --- order of painting ---------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("name", ["tower", "paper-figure-8", "keystone", "ladder"])
@pytest.mark.parametrize("angles", [(-32, 22), (140, 60), (75, -35)])
def test_nothing_is_painted_over_what_lies_in_front_of_it(name, angles):
    # independent method: rays from the eye, and the depths of all triangles that they meet
    geometry, camera = scene(name).geometry, Camera.at(*angles)
    polygons: list[Polygon] = []
    starts = geometry.triangle_start
    for k in range(len(geometry.mass)):
        own = geometry.triangles[starts[k] : starts[k + 1]]
        polygons += visible_triangles(geometry.vertices, own, np.zeros((0, 2), int), k)
    ordered = back_to_front(polygons, camera)
    flat = camera.flat(geometry.vertices)
    size = float(np.ptp(flat, axis=0).max())
    rng = np.random.default_rng(3)
    met = 0
    for point in rng.uniform(flat.min(axis=0), flat.max(axis=0), (60, 2)):
        depths = [d for p in polygons if (d := depth(p, point, camera)) is not None]
        painted = [d for p in ordered if (d := depth(p, point, camera)) is not None]
        if depths and painted:
            met += 1
            assert painted[-1] == pytest.approx(max(depths), abs=1e-6 * size)
    assert met > 5


def depth(polygon: Polygon, point: np.ndarray, camera: Camera) -> float | None:
    """Depth of a polygon at a point of the page, towards the eye; None outside the polygon."""
    facing = float(polygon.normal @ camera.towards)
    if facing <= 1e-6:
        return None
    corners = camera.flat(polygon.corners)
    side, to = np.roll(corners, -1, axis=0) - corners, point - corners
    if (side[:, 0] * to[:, 1] - side[:, 1] * to[:, 0] < 0).any():
        return None
    ray = point[0] * camera.right + point[1] * camera.up
    return float((polygon.corners[0] - ray) @ polygon.normal) / facing


def test_polygons_that_cross_each_other_are_cut():
    def square(tilt: float) -> np.ndarray:
        return np.array([[-1, -1, -tilt], [1, -1, tilt], [1, 1, tilt], [-1, 1, -tilt]], float)

    def polygon(tilt: float, part: int) -> Polygon:
        normal = np.array([-tilt, 0.0, 1.0]) / np.hypot(tilt, 1.0)
        return Polygon(square(tilt), normal, np.ones(4, dtype=bool), part)

    camera = Camera.at(0, 90)
    ordered = back_to_front([polygon(0.5, 0), polygon(-0.5, 1)], camera)
    assert len(ordered) == 3
    for x, wanted in ((-0.5, 1), (0.5, 0)):
        at = [p.part for p in ordered if depth(p, np.array([x, 0.1]), camera) is not None]
        assert at[-1] == wanted
    # cuts are not drawn as edges
    assert sum(int(p.drawn.sum()) for p in ordered) == 4 + 4 + 2


# --- content of figures --------------------------------------------------------------------


@pytest.mark.slow
def test_arrows_are_the_accelerations_of_the_answer():
    verdict = kilter.check(scene("paper-figure-8"))
    figure = draw_assembly(verdict, view=(0.0, 0.0))
    arrows = [a for a in lines(figure, "FancyArrowPatch") if a.get_zorder() == 5]
    assert len(arrows) == len(verdict.moving) == 2
    ends = np.array([a._posA_posB for a in arrows])
    drawn = ends[:, 1] - ends[:, 0]
    moves = np.flatnonzero(verdict.motion.moves)
    told = verdict.motion.acceleration[moves][:, [0, 2]]
    told = told[np.argsort(-np.linalg.norm(told, axis=1))]
    scale = np.linalg.norm(drawn[0]) / np.linalg.norm(told[0])
    assert drawn == pytest.approx(scale * told, abs=1e-9)
    assert any("0.75 g" in text for text in words(figure))


@pytest.mark.slow
def test_arrows_and_displaced_parts_are_whole():
    """The springers of an arch with little friction move out of the picture of the parts alone."""
    figure = draw_assembly(kilter.check(scene("arch"), friction=0.3))
    [axes] = [axes for axes in figure.axes if axes.collections]
    frame = axes.get_window_extent()
    drawn = [*lines(figure, "FancyArrowPatch"), *lines(figure, "LineCollection")]
    boxes = [each.get_window_extent() for each in drawn if each.axes is axes]
    boxes = [box for box in boxes if np.isfinite(box.get_points()).all()]
    assert len(boxes) > 20
    for box in boxes:
        assert (box.min >= frame.min).all()
        assert (box.max <= frame.max).all()


def random_pile(seed: int) -> Assembly:
    """Blocks of random sizes on each other on a table, centred or over its edge."""
    rng = np.random.default_rng(seed)
    table = Box([*rng.uniform(2, 12, 2), 0.3])
    parts = [Part("table", table, Pose([0, 0, -0.15]), grounded=True)]
    top = 0.0
    for k in range(rng.integers(2, 9)):
        size = rng.uniform(0.2, 2.5, 3)
        at = [*rng.normal(scale=0.4 * (1 + seed % 4), size=2), top + size[2] / 2]
        parts.append(Part(f"block number {k} of a pile, with a long name", Box(size), Pose(at)))
        top += float(size[2])
    return Assembly(parts, friction=float(rng.uniform(0, 0.8)))


@pytest.mark.parametrize("seed", sampled(2, 40))
def test_no_mark_or_word_is_cut_at_the_frame(seed):
    figure = draw_assembly(kilter.check(random_pile(seed)))
    figure.canvas.draw()
    frame = figure.bbox
    words_ = [*figure.texts, *(text for each in figure.legends for text in each.get_texts())]
    # held parts may go on beyond the picture, all other marks are whole
    marks = [
        each
        for axes in figure.axes
        for each in axes.get_children()
        if each is not axes.patch and not isinstance(each, PolyCollection)
    ]
    boxes = [each.get_window_extent().get_points() for each in [*words_, *marks]]
    boxes = [box for box in boxes if np.isfinite(box).all()]
    assert len(boxes) > 5
    for low, high in boxes:
        assert (low >= -1).all()
        assert (high <= [frame.width + 1, frame.height + 1]).all()


@pytest.mark.slow
def test_drawing_ends_without_words_of_native_libraries(tmp_path):
    (tmp_path / "pile.kilter.json").write_text(to_text(random_pile(3)))
    command = [
        sys.executable,
        "-m",
        "kilter",
        "draw",
        "pile.kilter.json",
        "-o",
        "pile.png",
        "--quiet",
    ]
    ended = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=120)
    assert (ended.stdout, ended.stderr) == ("", "")
    assert (tmp_path / "pile.png").stat().st_size > 1000


@pytest.mark.slow
def test_a_stable_assembly_has_forces_and_no_motion():
    verdict = kilter.check(scene("tower"))
    figure = draw_assembly(verdict)
    assert not [a for a in lines(figure, "FancyArrowPatch") if a.get_zorder() == 5]
    greatest = np.linalg.norm(verdict.forces.resultant, axis=1).max()
    assert any(f"{greatest / 1e3:.4g} kN" in text for text in words(figure))


@pytest.mark.slow
def test_a_ball_that_falls_is_outlined_where_it_comes_to():
    base = Part("base", Sphere(1.0), grounded=True)
    verdict = kilter.check(Assembly([base, Part("ball", Sphere(0.5), Pose([0, 0, 1.5]))]))
    end = np.zeros((2, 6))
    end[1, :3] = [0.9, 0.0, -0.3]
    figure = draw_assembly(verdict, view=(0.0, 0.0), fall=end)
    (drawn,) = [
        one for one in lines(figure, "LineCollection") if one.get_linestyle() != [(0, None)]
    ]
    off = np.concatenate(drawn.get_segments()) - [0.9, 1.2]
    assert np.linalg.norm(off, axis=1) == pytest.approx(0.5, abs=0.01)
    assert "after a small push, without friction" in words(figure)
    assert "after a small push, without friction" in words(kilter.draw(verdict))
    assert "after a small push, without friction" not in words(draw_assembly(verdict))


@pytest.mark.quick(1)
@pytest.mark.parametrize("down", [[0, 0, 1], [1, 0, 0], [0.3, -0.5, 0.2]])
def test_gravity_points_down_on_the_page(down):
    block = Part("held", Box([1, 1, 1]), Pose([0, 0, 5]), grounded=True)
    falling = Part("falling", Box([1, 1, 1]))
    verdict = kilter.check(Assembly([block, falling]).with_down(down))
    [arrow] = [a for a in lines(draw_assembly(verdict), "FancyArrowPatch") if a.get_zorder() == 5]
    (x0, y0), (x1, y1) = arrow._posA_posB
    assert y1 < y0
    assert x1 == pytest.approx(x0, abs=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["floating-block", "closed-frame", "corner-wedges", "channel",
                                  "paper-figure-10", "paper-figure-11", "tower"])  # fmt: skip
def test_the_region_on_the_sphere_is_the_region(name):
    region = kilter.region(scene(name))
    figure = draw_region(region)
    for axes, k in zip(figure.axes, (0, 1), strict=True):
        assert axes.get_xlim()[0] < -1, k
    if region.dimension in (2, 3) and len(region.facets):
        from kilter.show.sphere import _arc

        for normal in region.facets if region.dimension == 3 else region.equations:
            arc = _arc(normal, region.facets)
            arc = arc[np.isfinite(arc[:, 0])]
            assert region.contains(arc).all()
            # both ends are extreme rays (or senses of a line)
            corners = np.vstack([region.rays, region.lines, -region.lines])
            for end in (arc[0], arc[-1]):
                near = float((corners @ end).max())
                assert near > 1 - 1e-9 or np.allclose(arc[0], arc[-1]) or len(arc) > 600
    assert encode_figure(figure, ".png").startswith(b"\x89PNG")


# --- names ---------------------------------------------------------------------------------


@pytest.mark.slow
def test_hostile_names_are_text(recwarn):
    verdict = kilter.check(named(HOSTILE))
    figure = draw_assembly(verdict)
    svg = encode_figure(figure, ".svg").decode("utf-8")
    root = ET.fromstring(svg)
    assert not [e for e in root.iter() if e.tag.rsplit("}")[-1] in ("script", "foreignObject")]
    assert not re.search(r"<script|onload|xlink:href=\"http", svg)
    shown = "".join(root.itertext())
    assert "<script>alert(1)</" in shown
    assert "a\"b'c&d" in shown
    assert "\u202e" not in shown
    assert "x" * 40 not in shown
    assert "اسم القطعة" in shown
    assert "$\\frac{1}{0}$ $" in shown
    for suffix in (".png", ".pdf"):
        assert len(encode_figure(figure, suffix)) > 1000
    assert not recwarn.list


def test_a_notebook_shows_hostile_names_as_text():
    verdict = kilter.check(named(HOSTILE).with_down([1, 0, -1]))
    text = verdict._repr_html_()
    assert "<script" not in text
    assert "&lt;script&gt;" in text
    assert "\u202e" not in text
    assert len(text) < 8000
    told = dataclasses.replace(verdict, own_sentence="<img src=x onerror=alert(1)>", notes=("<b>",))
    assert "<img" not in told._repr_html_()
    assert "<b>" not in told._repr_html_()


@pytest.mark.slow
def test_answers_show_themselves_in_a_notebook():
    region = kilter.region(scene("paper-figure-10"))
    assert "fan" in region._repr_html_()
    assert "45 deg" in region._repr_html_()
    answer = kilter.orient(scene("paper-figure-11"))
    assert f"{answer.tilt_margin_deg:.6g} deg" in answer._repr_html_()
    for text in (region._repr_html_(), answer._repr_html_()):
        ET.fromstring(text)
    figure = kilter.draw(region)
    assert figure._repr_png_().startswith(b"\x89PNG")


def test_a_label_is_short():
    assert len(label("x" * 10_000)) <= 24
    assert label("a\tb") == "a\ufffdb"


@pytest.mark.slow
def test_import_stays_light_and_pyplot_is_never_touched():
    code = (
        "import sys, kilter; assert 'matplotlib' not in sys.modules\n"
        "v = kilter.check(kilter.example('tower')); v._repr_html_()\n"
        "assert 'matplotlib' not in sys.modules and 'kilter.show' not in sys.modules\n"
        "kilter.draw(v); assert 'matplotlib.pyplot' not in sys.modules\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True, timeout=120)


# --- the command ---------------------------------------------------------------------------


@pytest.fixture
def wall(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "tower.kilter.json"
    path.write_text(to_text(scene("tower")), encoding="utf-8")
    return path


@pytest.mark.slow
@pytest.mark.parametrize(
    ("suffix", "start"), [("svg", b"<?xml"), ("png", b"\x89PNG"), ("PDF", b"%PDF")]
)
def test_draw_writes_each_kind_of_figure(wall, suffix, start, capsys):
    out = wall.parent / f"f.{suffix}"
    assert main(["draw", str(wall), "-o", str(out)]) == 0
    assert out.read_bytes().startswith(start)
    captured = capsys.readouterr()
    assert captured.out == ""
    assert "stable" in captured.err
    first = out.read_bytes()
    assert main(["draw", str(wall), "-o", str(out), "--quiet"]) == 0
    assert out.read_bytes() == first


@pytest.mark.slow
def test_draw_what_region(wall):
    assert main(["draw", str(wall), "--what", "region", "-o", "r.svg", "--quiet"]) == 0
    assert "One direction of gravity is stable" in Path("r.svg").read_text(encoding="utf-8")


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    ("options", "said"),
    [
        ([], "the name of the figure is missing"),
        (["-o", "f.jpg"], "not a file name for a figure"),
        (["-o", "tower.kilter.json"], "not a file name for a figure"),
        (["-o", "f.png", "--view", "nan", "0"], "--view"),
        (["-o", "no/such/folder/f.png"], "cannot be written"),
        (["-o", "f.png", "--what", "sphere"], "sphere"),
    ],
)
def test_draw_refuses(wall, options, said, capsys):
    before = wall.read_bytes()
    assert main(["draw", str(wall), *options]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert error.count("\n") == 1
    assert wall.read_bytes() == before


def test_an_input_is_never_written_over(wall, capsys):
    odd = wall.rename(wall.with_name("input.svg"))
    before = odd.read_bytes()
    assert main(["draw", str(odd), "-o", "./input.svg"]) == 2
    assert "overwritten" in capsys.readouterr().err
    assert odd.read_bytes() == before


def test_draw_says_what_to_install(wall, monkeypatch, capsys):
    from kilter.show import canvas

    monkeypatch.setattr(canvas.importlib.util, "find_spec", lambda name: None)
    assert main(["draw", str(wall), "-o", "f.png"]) == 2
    assert "pip install 'kilter[figures]'" in capsys.readouterr().err


def test_straps_are_lines_in_the_figure_and_in_the_page():
    deck = Part("deck", Box([4, 4, 1]), Pose([0, 0, -0.5]), grounded=True)
    crate = Part("crate", Box([1, 1, 1]), Pose([0, 0, 0.5]))
    path = [("ground", [2, 0, 0]), ("crate", [0.5, 0, 1])]
    load = Assembly([deck, crate], straps=[kilter.Strap(path, capacity=100)])
    verdict = kilter.check(load)
    words = [text.get_text() for text in draw_assembly(verdict).legends[0].get_texts()]
    assert "1 strap" in words
    things = build_things(load, verdict.contact_set)
    line = np.array(things["straps"][0]) + things["center"]
    assert np.allclose(line, [[2, 0, 0], [0.5, 0, 1]])


G = 9.81
FRONT = (0.0, 0.0)
"""Azimuth and elevation of an eye that sees x to the right and z upward."""


def labels(figure: object) -> str:
    return " | ".join(t.get_text() for t in figure.findobj(Text) if t.get_text())


@pytest.mark.slow
def test_a_cube_past_an_edge_has_arrows_of_its_acceleration_and_of_its_turn():
    table = block("table", [-3000, -1000, -1000], [0, 1000, 0], grounded=True)
    past = block("past", [-400, -500, 0], [600, 500, 1000], density=500.0)
    verdict = kilter.check(Assembly([table, past], units="mm"))
    figure = draw_assembly(verdict, view=FRONT)
    turn = G * 0.1 / (1 / 6 + 0.1**2)
    assert f"longest {0.1 * turn / G:.3g} g" in labels(figure)
    assert f"fastest {turn:.3g} rad/s²" in labels(figure)
    drawn = [one for one in figure.axes[0].findobj(FancyArrowPatch) if one.get_zorder() == 5]
    straight, round_ = sorted(drawn, key=lambda one: len(one.get_path().vertices))[:2]
    if straight._posA_posB is None:
        straight, round_ = round_, straight
    start, end = np.array(straight._posA_posB)
    middle = Camera.at(*FRONT).flat(np.array([[100.0, 0, 500]]))[0]
    assert start == pytest.approx(middle)
    # the centre drops vertically
    assert (end - start)[0] == pytest.approx(0, abs=1e-9)
    assert (end - start)[1] < 0
    # about +y, away from the eye: clockwise, three quarters of a circle about the centre
    around = round_._path_original.vertices - middle
    radius = np.linalg.norm(around, axis=1)
    assert radius == pytest.approx(np.full(len(radius), radius[0]), rel=1e-6)
    angle = np.unwrap(np.arctan2(around[:, 1], around[:, 0]))
    assert (np.diff(angle) < 0).all()
    assert angle[0] - angle[-1] == pytest.approx(1.5 * math.pi, rel=1e-6)


@pytest.mark.parametrize("at", [-300, 300])
def test_forces_on_a_beam_are_lines_in_proportion_at_their_ridges(at):
    triangle = [[-100, -100], [100, -100], [0, 0]]
    left, right = (
        Part(name, Prism(triangle, 400.0), Pose([x, 0, 0]), grounded=True)
        for name, x in (("left", -1000), ("right", 2000))
    )
    beam = Part("beam", Box([5000, 200, 200]), [at, 0, 100], density=500.0)
    verdict = kilter.check(Assembly([left, right, beam], units="mm", friction=0.4))
    figure = draw_assembly(verdict, view=FRONT)
    shares = sorted([(2000 - at) / 3000, (at + 1000) / 3000])
    assert f"largest {shares[1] * 100 * G:.4g} N" in labels(figure)
    found = [
        one.get_segments()
        for one in figure.axes[0].findobj(LineCollection)
        if one.get_zorder() == 5
    ]
    [segments] = [np.array(one) for one in found if len(one) == 2]
    lengths = np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1)
    middles = segments.mean(axis=1)
    assert lengths[1] / lengths[0] == pytest.approx(shares[0] / shares[1], rel=1e-6)
    stronger = -1000 if at < 500 else 2000
    flat = Camera.at(*FRONT).flat(np.array([[stronger, 0, 0], [1000 - stronger, 0, 0]], float))
    assert middles == pytest.approx(flat, abs=1e-6)


@pytest.mark.slow
def test_the_boundary_of_carried_accelerations_and_its_weakest_direction():
    base = block("base", [-500, -500, -10], [500, 500, 0], grounded=True)
    box = Part("box", Box([100, 200, 300]), [0, 0, 150])
    answer = kilter.transport(Assembly([base, box], units="mm", friction=0.8))
    axes = kilter.draw(answer).axes[0]
    boundary = max(
        (line.get_xydata() for line in axes.lines if line.get_linewidth() == 1.6), key=len
    )
    tips = np.array([50, 100]) / 150  # along x and along y [g]
    slides = np.linalg.norm(boundary, axis=1) / 0.8
    assert np.maximum(np.abs(boundary / tips).max(axis=1), slides) == pytest.approx(
        np.ones(len(boundary)), rel=1e-6
    )
    [arrow] = [one for one in axes.texts if getattr(one, "arrow_patch", None)]
    assert np.abs(arrow.xy) == pytest.approx([tips[0], 0], abs=1e-6)
    assert (axes.get_xlabel(), axes.get_ylabel()) == (
        "acceleration along x [g]", "acceleration along y [g]",
    )  # fmt: skip
    rings = [line.get_xydata() for line in axes.lines if line.get_linewidth() == 0.8]
    radii = [np.unique(np.linalg.norm(ring, axis=1).round(9)) for ring in rings]
    ticks = np.concatenate(radii)
    assert np.diff(ticks) == pytest.approx(np.full(len(ticks) - 1, ticks[0]))


@pytest.mark.slow
def test_the_movement_to_the_pose_at_rest_is_magnified_by_the_stated_factor():
    table = block("table", [-500, -500, -10], [500, 500, 0], grounded=True)
    hangs = Part("hangs", Box([100, 100, 100]), [0, 0, 50.5])
    figure = kilter.draw(kilter.settle(Assembly([table, hangs], units="mm")), view=FRONT)
    [factor] = re.findall(r"movements x (\d+)", labels(figure))
    [outline] = [
        one for one in figure.axes[0].findobj(LineCollection) if one.get_linestyle() != [(0, None)]
    ]
    corners = np.concatenate(outline.get_segments())
    # drawn at 0.5 above the table, it moves down by half a millimetre
    assert corners[:, 1].min() == pytest.approx(0.5 - 0.5 * float(factor), abs=1e-6)
    assert np.ptp(corners, axis=0) == pytest.approx([100, 100], abs=1e-3)


@pytest.mark.slow
def test_a_picture_a_step_and_who_is_held(tmp_path):
    order = kilter.plan(arch(9, ratio=0.3, friction=0.6))
    figure = kilter.draw(order, tmp_path / "plan.svg")
    assert len(figure.axes) == len(order.steps) == 9
    svg = (tmp_path / "plan.svg").read_text(encoding="utf-8")
    for k, step in enumerate(order.steps, 1):
        assert f"{k}  {step.part}" in svg
        assert not step.held or f"hold {step.held[0]}" in svg
    assert svg.count("hold voussoir") == order.held_steps > 0


@pytest.mark.slow
def test_the_part_that_comes_stands_back_along_its_way():
    figure = kilter.draw(kilter.plan(scene("tower")), view=(0, 0))
    for axes in figure.axes:
        low, high = axes.get_ylim()
        [arrow] = [text for text in axes.texts if text.arrow_patch is not None]
        (x, y), (u, v) = arrow.xyann, arrow.xy
        assert abs(x - u) < 1e-9
        assert low < v < y < high


@pytest.mark.slow
def test_names_are_no_formulas_and_the_same_plan_gives_the_same_bytes():
    base = Part("base", Box([4, 4, 1]), Pose([0, 0, -0.5]), grounded=True)
    cube = Part("$x^2$ <b>", Box([1, 1, 1]), Pose([0, 0, 0.5]))
    pictures = [
        encode_figure(kilter.draw(kilter.plan(Assembly([base, cube]))), ".svg") for _ in range(2)
    ]
    assert pictures[0] == pictures[1]
    assert "$x^2$ &lt;b&gt;" in pictures[0].decode()
