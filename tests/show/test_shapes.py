"""Drawn shapes, round patches, colours and places of rest."""

import itertools
import re
from pathlib import Path

import numpy as np
import pytest
from lathe import turned_part
from test_page import data_of

import kilter
from kilter import Assembly, Box, Cylinder, Mesh, Part, Pose, contacts
from kilter.analysis.everything import everything
from kilter.rigid import quaternion_to_matrix
from kilter.scenes import SCENES, scene
from kilter.scenes.pieces import block, floor, tube
from kilter.shape.primitives import surface
from kilter.show.colours import part_colours
from kilter.show.page import render
from kilter.show.round_patches import _rings, round_patches
from kilter.show.shapes import feature_edges, place_shapes, shape_mesh
from kilter.show.sphere import draw_region
from kilter.tell.csv_cells import REST_SIGNS, rest_table
from kilter.tell.palette import BODIES, GROUND, PALETTE, RAMP, ROLES, as_css, rgb
from kilter.tell.region_facts import rest_words

CUBE = surface(Box([1, 1, 1]))


@pytest.mark.quick(7)
@pytest.mark.parametrize("name", list(SCENES))
def test_parts_are_drawn_where_their_geometry_is(name):
    assembly = scene(name)
    found, geometry = place_shapes(assembly), assembly.geometry
    rotation = quaternion_to_matrix(found.rotation)
    for k in range(len(assembly.parts)):
        drawn_ = found.shapes[found.shape[k]].positions @ rotation[k].T + found.position[k]
        own = geometry.vertices[geometry.vertex_start[k] : geometry.vertex_start[k + 1]]
        near = 3e-6 * geometry.size[k]
        assert np.allclose(drawn_.min(axis=0), own.min(axis=0), atol=near)
        assert np.allclose(drawn_.max(axis=0), own.max(axis=0), atol=near)


def test_a_cube_has_twelve_edges_and_a_cylinder_two_rims():
    assert len(feature_edges(*CUBE)) == 12
    vertices, triangles = surface(Cylinder(1, 2))
    edges = feature_edges(vertices, triangles)
    assert len(edges) == len(vertices)
    height = vertices[edges][:, :, 2]
    assert (height[:, 0] == height[:, 1]).all()


def test_a_sphere_has_no_edges_until_the_crease_is_as_sharp_as_its_facets():
    from kilter import Sphere

    vertices, triangles = surface(Sphere(1))
    assert len(feature_edges(vertices, triangles)) == 0
    assert len(feature_edges(vertices, triangles, crease=0.1)) > 100


def test_an_open_border_is_an_edge():
    vertices, triangles = CUBE
    assert len(feature_edges(vertices, triangles[2:])) == 12
    assert len(feature_edges(vertices, triangles[1:])) == 13


def test_copies_that_differ_by_rounding_are_one_shape():
    vertices, triangles = CUBE
    away = vertices + np.array([1e3 / 3, 0.1, -7.7])
    parts = [Part("a", Mesh(vertices, triangles)), Part("b", Mesh(away, triangles))]
    assert len(place_shapes(Assembly(parts)).shapes) == 1
    parts.append(Part("c", Mesh(vertices * [1, 1, 1.01], triangles)))
    found = place_shapes(Assembly(parts))
    assert found.shape.tolist() == [0, 0, 1]


def test_corners_listed_once_a_face_make_the_same_edges():
    vertices, triangles = CUBE
    soup = vertices[triangles].reshape(-1, 3)
    shape, middle = shape_mesh(soup, np.arange(len(soup)).reshape(-1, 3))
    assert len(shape.edges) == 12
    assert len(shape.positions) == 8
    assert np.allclose(middle, 0)


def test_a_shape_far_from_the_origin_keeps_its_digits():
    box = Part("far", Box([1, 1, 1]), Pose([1e7, 0, 0]))
    shape = place_shapes(Assembly([box])).shapes[0]
    assert np.abs(np.abs(shape.positions) - 0.5).max() == 0


def test_few_parts_have_a_hue_each_and_held_ones_are_grey():
    colours = part_colours([0, 0, 0, 0], [True, False, False, False])
    assert len({tuple(c) for c in colours.tolist()}) == 4
    assert len(set(colours[0].tolist())) <= 3
    assert np.ptp(colours[0].astype(int)) < 20


def test_many_parts_have_a_hue_a_shape():
    count = 8 * len(PALETTE)
    colours = part_colours(np.arange(count) % 2, np.zeros(count, dtype=bool)).astype(float)
    blue = colours[::2, 2] > colours[::2, 0]
    yellow = colours[1::2, 2] < colours[1::2, 0]
    assert blue.all()
    assert yellow.all()


def arc(angles: np.ndarray, lean: float, height: float) -> tuple[np.ndarray, np.ndarray]:
    """Points at radius 3 - height, with normals inclined to z."""
    around = np.column_stack([np.cos(angles), np.sin(angles), 0 * angles])
    up = np.array([0, 0, 1.0])
    return (3 - height) * around + height * up, np.cos(lean) * around + np.sin(lean) * up


def test_a_cone_has_its_circles_and_an_arc_ends_where_its_points_end():
    angles = np.radians([-40, 0, 40, 80])
    turn = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    low, high = arc(angles, 0.4, 0.0), arc(angles, 0.4, 1.0)
    points = np.vstack([low[0], high[0]]) @ turn.T + [5, 6, 7]
    rings = _rings(points, np.vstack([low[1], high[1]]) @ turn.T)
    assert len(rings) == 2
    sizes = []
    for ring in rings:
        back = (ring - [5, 6, 7]) @ turn
        size = np.hypot(back[:, 0], back[:, 1])
        assert np.allclose(size, 3 - back[:, 2])
        sizes.append(size[0])
        angle = np.degrees(np.arctan2(back[:, 1], back[:, 0]))
        assert np.allclose([angle.min(), angle.max()], [-40, 80])
    assert np.allclose(sorted(sizes), [2, 3])


def test_three_points_around_are_a_whole_circle_and_two_are_none():
    around = arc(np.radians([0, 120, 240]), 0.0, 0.0)
    [ring] = _rings(*around)
    assert np.allclose(ring[0], ring[-1])
    assert _rings(*arc(np.radians([0, 90]), 0.0, 0.0)) == []


def test_a_shaft_touches_its_bore_on_a_whole_cylinder():
    sleeve = tube("sleeve", 1.0, 2.0, 3.0, grounded=True)
    found = contacts(Assembly([sleeve, Part("shaft", Cylinder(1.0, 2.0), Pose([0, 0, 0.2]))]))
    assert found.patch_kind.tolist() == ["cylinder"]
    drawn = round_patches(found)
    assert np.allclose(np.hypot(*drawn.points[:, :2].T), 1.0)
    corners = drawn.points[drawn.triangles]
    area = np.linalg.norm(np.cross(*(corners[:, 1:] - corners[:, :1]).swapaxes(0, 1)), axis=1) / 2
    chord = 2 * len(drawn.triangles) / 2 * np.sin(np.pi / (len(drawn.triangles) / 2))
    assert np.isclose(area.sum(), chord * np.ptp(drawn.points[:, 2]))
    assert np.isclose(area.sum(), found.patch_area[0], rtol=2e-3)


def test_flat_patches_and_lines_of_contact_have_none():
    for name in ("tower", "three-cylinders"):
        assert len(round_patches(contacts(scene(name))).points) == 0


ROOT = Path(__file__).resolve().parents[2]
THEMES = ("light", "dark")
SEEN = {
    "all": np.eye(3),
    "no red": np.array(
        [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216],
         [-0.003882, -0.048116, 1.051998]]
    ),
    "no green": np.array(
        [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413],
         [-0.011820, 0.042940, 0.968881]]
    ),
    "no blue": np.array(
        [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602],
         [0.004733, 0.691367, 0.303900]]
    ),
}  # fmt: skip
"""Linear sRGB as seen with a missing kind of cone: Machado, Oliveira, Fernandes, 2009."""
APART = 10.0
"""Least distance of two signs in CIELAB; a distance of 2.3 is just noticeable."""


def linear(colour: str) -> np.ndarray:
    share = np.array(rgb(colour)) / 255
    return np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)


def lightness(colour: str) -> float:
    return float(np.array([0.2126, 0.7152, 0.0722]) @ linear(colour))


def contrast(one: str, other: str) -> float:
    low, high = sorted([lightness(one), lightness(other)])
    return (high + 0.05) / (low + 0.05)


def lab(seen: np.ndarray) -> np.ndarray:
    """CIELAB of linear sRGB, white D65."""
    xyz = np.array(
        [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]
    ) @ np.clip(seen, 0, 1) / [0.9505, 1, 1.089]  # fmt: skip
    f = np.where(xyz > 0.008856, np.cbrt(xyz), 7.787 * xyz + 16 / 116)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


def test_distances_and_contrasts_are_those_of_the_books():
    assert np.allclose(lab(linear("#ffffff")), [100, 0, 0], atol=0.02)
    assert np.allclose(lab(linear("#ff0000")), [53.24, 80.09, 67.2], atol=0.05)
    assert contrast("#000000", "#ffffff") == pytest.approx(21)
    assert contrast("#767676", "#ffffff") == pytest.approx(4.54, abs=0.01)
    # this slate and purple look equal without the cone for green
    slate, purple = (linear(c) for c in ("#5b6673", "#a3307f"))
    assert np.linalg.norm(lab(slate) - lab(purple)) > 4 * APART
    assert np.linalg.norm(lab(SEEN["no green"] @ slate) - lab(SEEN["no green"] @ purple)) < APART


@pytest.mark.parametrize("eye", SEEN)
@pytest.mark.parametrize("theme", THEMES)
def test_signs_are_told_apart(theme, eye):
    signs = {name: getattr(one, theme) for name, one in ROLES.items() if one.use == "sign"}
    places = {k: lab(SEEN[eye] @ linear(c)) for k, c in {**signs, "held": GROUND}.items()}
    for a, b in itertools.combinations(places, 2):
        assert np.linalg.norm(places[a] - places[b]) > APART, (a, b)


@pytest.mark.parametrize("eye", SEEN)
def test_bodies_are_told_apart(eye):
    places = [lab(SEEN[eye] @ linear(colour)) for colour in (*BODIES, GROUND)]
    for a, b in itertools.combinations(places, 2):
        assert np.linalg.norm(a - b) > 1.5 * APART


@pytest.mark.parametrize("theme", THEMES)
def test_words_and_signs_stand_out_from_what_is_behind_them(theme):
    of = {name: getattr(one, theme) for name, one in ROLES.items()}
    for name in ("stable", "unstable", "undecided", "ink", "soft", "link", "grip"):
        assert contrast(of[name], of["surface"]) >= 4.5, name
    signs = {name for name, one in ROLES.items() if one.use == "sign"}
    for name in signs - {"open"}:  # a ball with a rim of ink
        for ground in ("surface", "stage-top", "stage-bottom"):
            assert contrast(of[name], of[ground]) >= 3.0, (name, ground)


def test_the_ramp_gets_darker_for_every_eye():
    for eye in SEEN.values():
        levels = [lab(eye @ linear(colour))[0] for colour in RAMP]
        assert (np.diff(levels) < -APART / 2).all()


def test_signs_are_stronger_than_the_parts_they_lie_on():
    parts = [*PALETTE, *BODIES, GROUND]
    for name in ("unstable", "force", "limit", "patch"):
        assert min(contrast(ROLES[name].light, part) for part in parts) > 1.7, name


def test_the_style_has_every_role_in_light_and_dark():
    light, *dark = as_css().strip().split("\n")
    assert len(dark) == 2
    for name, one in ROLES.items():
        assert f"--{name}: {one.light};" in light
        assert all(f"--{name}: {one.dark};" in line for line in dark)


LITERAL = re.compile(
    r"#[0-9a-fA-F]{6}\b|#[0-9a-fA-F]{3}\b(?=[;'\"\s])|\brgba?\(\s*\d|\bhsla?\(\s*\d"
    r"|[\"'](?:white|black|red|green|blue|orange|yellow|purple|gr[ae]y)[\"']"
)


@pytest.mark.slow
def test_no_other_colour_is_in_the_sources():
    found = []
    folders = {"src/kilter": "py css html js", "web/src": "js", "docs": "py css js"}
    for folder, kinds in folders.items():
        for kind in kinds.split():
            for path in sorted((ROOT / folder).rglob(f"*.{kind}")):
                if path.name in ("palette.py", "page.js"):
                    continue
                for line in path.read_text(encoding="utf-8").splitlines():
                    if LITERAL.search(line.replace("#rrggbb", "")):
                        found.append(f"{path.relative_to(ROOT)}: {line.strip()[:80]}")
    assert not found
    for sign in ('"#1b2530"', "color: #fff;", "rgb(1,2,3)", 'color="white"'):
        assert LITERAL.search(sign)


def test_the_page_of_the_docs_has_the_table():
    text = (ROOT / "docs" / "contributing/colours.md").read_text(encoding="utf-8")
    rows = [f"| {name} | {one.says} | {one.light} | {one.dark} |" for name, one in ROLES.items()]
    assert "\n".join(rows) in text
    for colour in (GROUND, *PALETTE, *BODIES, *RAMP):
        assert colour in text


def corner(mu: float = 0.0) -> Assembly:
    """A cube in the corner of three walls."""
    walls = [
        block("floor", [-1, -1, -1], [2, 2, 0], grounded=True),
        block("left", [-1, -1, 0], [0, 2, 2], grounded=True),
        block("back", [0, -1, 0], [2, 0, 2], grounded=True),
    ]
    return Assembly([*walls, block("cube", [0, 0, 0], [1, 1, 1])]).with_friction(mu)


@pytest.mark.slow
def test_the_page_marks_each_place_of_rest_with_the_words_of_the_answer():
    rests = kilter.region(corner(), rests=True).to_dict()["rests"]
    page = render(everything(corner()), title="rests", command="")
    marked = data_of(page)["region"]["rests"]
    assert [one["words"] for one in marked] == [rest_words(one) for one in rests]
    assert [one["state"] for one in marked] == ["minimum", "free", "free", "free"]
    assert marked[0]["down"] == pytest.approx(rests[0]["down"])
    assert "Places of rest (4)" in page
    for row in rest_table({"rests": rests}).rows(9):
        assert all(f"<td>{cell}</td>" in page for cell in row)


@pytest.mark.slow
def test_what_it_lies_on_is_what_bears_it():
    """Along the axis of the corner three walls carry the cube, along an edge only two."""
    axis, *edges = kilter.region(corner(), rests=True).rests
    assert axis.on == ("floor", "left", "back")
    assert sorted(edge.on for edge in edges) == [("back",), ("floor",), ("left",)]


@pytest.mark.slow
def test_the_table_has_the_well_of_a_body_on_a_table():
    dome = turned_part("dome", [(0, 0), (1, 1, 0, 1), (0, 1)])
    answer = kilter.region(Assembly([floor([-4, -4], [4, 4]), dome]), rests=True).to_dict()
    [row] = rest_table(answer).rows(9)
    assert row == ["(0, 0, -1)", "floor", REST_SIGNS["free"],
                   "110.556 deg", "9102 J", "7705 N m/rad", "1.668 s"]  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("mu", [0.0, 0.3])
def test_the_figure_marks_them_where_they_were_asked(mu):
    asked = mu == 0
    figure = draw_region(kilter.region(corner(mu), rests=asked))
    said = [entry.get_text() for legend in figure.legends for entry in legend.get_texts()]
    assert ("rest: strict minimum" in said) == asked
    assert ("rest: slides or rolls freely" in said) == asked


@pytest.mark.slow
def test_with_friction_the_page_marks_none():
    page = render(everything(corner(0.3)), title="rests", command="")
    assert data_of(page)["region"]["rests"] == []
    assert "Places of rest" not in page


@pytest.mark.slow
def test_many_parts_are_not_asked():
    boxes = [Part(f"b{k}", Box([1, 1, 1]), pose=[[1, 0, 0, 2 * k], [0, 1, 0, 0], [0, 0, 1, 0.5],
                                                [0, 0, 0, 1]]) for k in range(7)]  # fmt: skip
    assembly = Assembly([floor([-2, -2], [20, 2]), *boxes])
    assert everything(assembly).region["rests"] == []
