"""Figures of lines of thrust and of supports that move: known answers, nothing cut, wrong input."""

import math
import re

import numpy as np
import pytest

pytest.importorskip("matplotlib")

from glb_reader import Film
from matplotlib.text import Text
from test_force_ranges import G, arch, beam_on_three, knife, slot

import kilter
from kilter import Assembly, Box, InputError, Part
from kilter.cli import main
from kilter.files import to_text
from kilter.rigid import Pose
from kilter.scenes import scene
from kilter.scenes.pieces import moved, turn
from kilter.show.support_figure import THRUST
from kilter.tell.numbers import force

SPREAD = {"right": (0.001, 0, 0), "left": (-0.001, 0, 0)}


def beam():
    return Assembly(
        [knife("a", -2), knife("b", 2), Part("beam", Box(4.4, 1, 0.5), [0, 0.5, 0.25])],
        friction=0.5,
    )


def portal():
    rows = [("left", -1.6), ("right", 1.6)]
    held = [Part(f"under-{n}", Box(1.6, 2, 0.5), [x, 0, -0.25], grounded=True) for n, x in rows]
    posts = [Part(n, Box(0.8, 1, 3), [x, 0, 1.5]) for n, x in rows]
    return Assembly([*held, *posts, Part("lintel", Box(4.6, 1, 0.7), [0, 0, 3.35])], friction=0.6)


def words(figure):
    return " | ".join(text.get_text() for text in figure.findobj(Text) if text.get_text())


def factor_of(figure):
    return float(re.search(r"Movements x (\d+)", words(figure))[1])


def marks(figure, sign):
    """Points on the page of the lines with a mark."""
    found = [line.get_xydata() for line in figure.axes[0].lines if line.get_marker() == sign]
    return np.concatenate(found) if found else np.empty((0, 2))


def corners(figure):
    """Corners on the page of all filled polygons."""
    return np.concatenate(
        [path.vertices for each in figure.axes[0].collections for path in each.get_paths()]
    )


# --- lines of thrust ---------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("count", "thickness", "least", "greatest", "touched"),
    [
        (10, 1.0, 0.161980057, 0.248119319, ({2: 5, 5: 6, 8: 5}, {0: 6, 3: 5, 7: 5, 10: 6})),
        pytest.param(
            20, 1.0, 0.161579331, 0.245949059,
            ({3: 5, 10: 6, 17: 5}, {0: 6, 6: 5, 14: 5, 20: 6}), marks=pytest.mark.slow,
        ),
    ],
)  # fmt: skip
def test_lines_of_thrust_touch_the_edges_of_known_joints(
    count, thickness, least, greatest, touched
):
    scene = arch(count, thickness)
    figure = kilter.draw(scene, what="thrust")
    weight = scene.geometry.mass[~scene.geometry.grounded].sum() * G
    legend = [text.get_text() for text in figure.legends[0].get_texts()]
    assert f"least thrust {force(least * weight)}" in legend
    assert f"greatest thrust {force(greatest * weight)}" in legend
    angles = math.pi * np.arange(count + 1) / count
    for (_, mark), known in zip(THRUST, touched, strict=True):
        points = marks(figure, mark)
        points = points[np.argsort(np.arctan2(points[:, 1], points[:, 0]))]
        radius = np.hypot(*points.T)
        # every point is in its joint, and within the thickness
        assert np.arctan2(points[:, 1], points[:, 0]) == pytest.approx(angles, abs=1e-9)
        assert (radius > 5 - 1e-9).all()
        assert (radius < 5 + thickness + 1e-9).all()
        assert radius[list(known)] == pytest.approx(list(known.values()), abs=1e-6)
        inside = np.delete(radius, list(known))
        assert (np.abs(inside - 5) > 1e-3).all()
        assert (np.abs(inside - 5 - thickness) > 1e-3).all()


@pytest.mark.slow
def test_the_figure_faces_the_arch_however_it_is_turned():
    pose = Pose([3, -2, 5], turn([0, 0, 1], 37))
    scene = arch(10, 1.0)
    turned = moved(scene, pose.rotation, pose.position)
    first, second = (kilter.draw(each, what="thrust") for each in (scene, turned))
    for _, mark in THRUST:
        spans = [np.ptp(marks(figure, mark), axis=0) for figure in (first, second)]
        assert spans[1] == pytest.approx(spans[0], abs=1e-6)
    spread = {name: pose.matrix @ way for name, way in SPREAD.items()}
    figures = (
        kilter.draw(scene, what="movement", moved=SPREAD),
        kilter.draw(turned, what="movement", moved=spread),
    )
    spans = [np.ptp(marks(figure, "o"), axis=0) for figure in figures]
    assert spans[1] == pytest.approx(spans[0], abs=1e-4)


def test_a_thrust_without_a_limit_has_no_line():
    figure = kilter.draw(kilter.check(slot(), require="equilibrium"), what="thrust")
    assert len(marks(figure, "o")) == 2
    assert not len(marks(figure, "s"))
    assert "greatest thrust without limit" in words(figure)


def test_a_single_thrust_is_a_single_line():
    """A ladder leans on a smooth wall: W x / z with its centre x before the wall, z its top."""
    ladder = scene("ladder")
    figure = kilter.draw(ladder, what="thrust")
    (foot, top) = sorted(marks(figure, "o").tolist(), key=lambda point: point[1])
    assert not len(marks(figure, "s"))
    k = ladder.index_of("ladder")
    arm = abs(foot[0] - ladder.geometry.center[k, 0])
    thrust = ladder.geometry.mass[k] * G * arm / (top[1] - foot[1])
    assert figure.texts[0].get_text() == f"Thrust {force(thrust)}."


@pytest.mark.parametrize(
    ("scene", "said"),
    [
        (beam_on_three(), "'beam' touches 3 parts: a line of thrust needs a chain of parts"),
        (arch(10, 0.3), "no contact forces are known to balance the parts: Unstable"),
    ],
)
def test_a_missing_chain_or_equilibrium_is_a_sentence(scene, said):
    with pytest.raises(InputError, match=said):
        kilter.draw(scene, what="thrust")


# --- supports that move ------------------------------------------------------------------------


def test_hinges_of_the_figure_are_those_of_the_answer():
    scene = arch(10, 1.0)
    verdict = kilter.check(scene)
    found = verdict.support_movement(SPREAD)
    figure = kilter.draw(verdict, what="movement", moved=SPREAD)
    factor = factor_of(figure)
    dots = marks(figure, "o")
    assert len(dots) == len(found.opened) == 3
    center = scene.geometry.center
    for dot, contact in zip(dots, found.opened, strict=True):
        # both parts have the hinge at the same place, also magnified
        for name in contact.parts:
            k = scene.index_of(name)
            way = found.motion[k, :3] + np.cross(found.motion[k, 3:], contact.hinge - center[k])
            assert dot == pytest.approx((contact.hinge + factor * way)[[0, 2]], abs=1e-4)
    # the parts leave cracks of the magnified width: corners of both sides are apart by it
    widest = found.opened[0]
    sides = []
    for name in widest.parts:
        k = scene.index_of(name)
        way = found.motion[k, :3] + np.cross(found.motion[k, 3:], widest.at - center[k])
        sides.append((widest.at + factor * way)[[0, 2]])
    assert np.linalg.norm(sides[1] - sides[0]) == pytest.approx(factor * widest.opening, rel=0.01)
    assert factor * widest.opening > 0.1
    for side in sides:
        assert np.linalg.norm(corners(figure) - side, axis=1).min() < 1e-6


def test_a_beam_turns_by_its_magnified_angle_about_the_support_that_stays():
    figure = kilter.draw(beam(), what="movement", moved={"b": (0, 0, -0.01)})
    factor, angle = factor_of(figure), 0.01 / 4
    for x in (-2.2, 2.2):
        expected = [x, -factor * angle * (x + 2)]
        assert np.linalg.norm(corners(figure) - expected, axis=1).min() < 1e-6
    assert "longest 0.01 m" in words(figure)
    (arrow,) = [each for each in figure.axes[0].patches if each.get_zorder() == 5]
    start, end = np.array(arrow._posA_posB)
    assert end - start == pytest.approx([0, -0.01 * factor], abs=1e-9)
    assert start == pytest.approx([2, 0], abs=1e-9)
    # the magnified movement is a readable share of the beam
    assert 0.04 * 4.4 < 0.01 * factor < 0.25 * 4.4


@pytest.mark.parametrize(
    ("scene", "options"),
    [
        (arch(10, 1.0), {"what": "thrust"}),
        (arch(10, 1.0), {"what": "movement", "moved": SPREAD}),
        (beam(), {"what": "movement", "moved": {"b": (0.02, 0, -0.02)}}),
        (portal(), {"what": "thrust"}),
        (portal(), {"what": "movement", "turned": {"under-left": (0, 1, 0, 0.2)}}),
        (portal(), {"what": "movement", "moved": {"under-left": (-0.02, 0, -0.02)}}),
    ],
)
def test_no_part_mark_or_word_is_cut(scene, options):
    figure = kilter.draw(scene, **options)
    figure.canvas.draw()
    texts = [*figure.texts, *(text for each in figure.legends for text in each.get_texts())]
    axes = figure.axes[0]
    drawn = [each for each in axes.get_children() if each is not axes.patch]
    boxes = [each.get_window_extent().get_points() for each in [*texts, *drawn]]
    boxes = [box for box in boxes if np.isfinite(box).all()]
    assert len(boxes) > 8
    for low, high in boxes:
        assert (low >= -1).all()
        assert (high <= [figure.bbox.width + 1, figure.bbox.height + 1]).all()
    low, high = axes.get_window_extent().get_points()
    shown = axes.transData.transform(corners(figure))
    assert (shown >= low).all()
    assert (shown <= high).all()


def test_names_of_parts_that_the_frame_cuts_are_whole():
    walls = [
        Part(f"a wall with a long name {x}", Box(9, 1, 2), [5 * x, 0, 0], grounded=True)
        for x in (-1, 1)
    ]
    figure = kilter.draw(
        Assembly([*walls, Part("block", Box(1, 1, 1))], friction=0.5), what="thrust"
    )
    figure.canvas.draw()
    names = [text for text in figure.axes[0].texts if text.get_text().startswith("a wall")]
    assert len(names) == 2
    for text in names:
        (low, _), (high, _) = text.get_window_extent().get_points()
        assert (low, high) == pytest.approx(np.clip([low, high], 0, figure.bbox.width), abs=1)


def test_the_film_ends_at_the_magnified_movement():
    scene = beam()
    film = Film(kilter.animate(kilter.check(scene), moved={"b": (0, 0, -0.01)}))
    factor = float(film.animation["name"].removeprefix("movement x "))
    figure = kilter.draw(scene, what="movement", moved={"b": (0, 0, -0.01)})
    assert factor == factor_of(figure) > 1
    _, places, _ = film.channel("b", "translation")
    assert places[-1] - places[0] == pytest.approx([0, 0, -0.01 * factor], abs=1e-6)
    _, places, _ = film.channel("beam", "translation")
    # its centre is 0.25 above the edge about which it turns
    turned = [0.01 / 4 * 0.25, 0, -0.005]
    assert places[-1] - places[0] == pytest.approx(np.multiply(factor, turned), abs=1e-6)
    assert not [c for c in film.animation["channels"] if film.names[c["target"]["node"]] == "a"]


def test_a_movement_that_is_not_known_is_a_sentence():
    for options in ({"what": "movement"}, {"moved": {"b": (0, 0, -0.01)}}):
        with pytest.raises(InputError, match="belong together; give both: what='movement'"):
            kilter.draw(beam(), **options)
    with pytest.raises(InputError, match=r"no movement to show: The assembly falls"):
        kilter.draw(arch(10, 0.3), what="movement", moved=SPREAD)
    with pytest.raises(InputError, match="no movement to show: The assembly falls"):
        kilter.animate(kilter.check(arch(10, 0.3)), moved=SPREAD)


@pytest.mark.slow
def test_the_command_draws_thrust_and_movement(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "beam.kilter.json").write_text(to_text(beam()), encoding="utf-8")
    draw = ["draw", "beam.kilter.json"]
    sinks = ["--what", "movement", "--move", "b=0,0,-0.01"]
    assert main([*draw, "--what", "thrust", "-o", "thrust.svg"]) == 0
    assert "greatest thrust 5.396 kN" in (tmp_path / "thrust.svg").read_text(encoding="utf-8")
    assert main([*draw, *sinks, "-o", "movement.svg"]) == 0
    assert "Movements x 50" in (tmp_path / "movement.svg").read_text(encoding="utf-8")
    assert main([*draw, *sinks, "-o", "movement.glb"]) == 0
    assert Film((tmp_path / "movement.glb").read_bytes()).animation["name"] == "movement x 50"
    capsys.readouterr()
    for more, said in (
        (["--what", "movement"], "--what movement --move NAME=DX,DY,DZ"),
        (["--move", "b=0,0,-0.01"], "--what movement --move NAME=DX,DY,DZ"),
        (["--what", "movement", "--move", "beam=0,0,1"], "'beam' is not held"),
        (["--what", "thrust", "-o", "thrust.glb"], "a thrust has no motion"),
    ):
        out = [] if "-o" in more else ["-o", "none.svg"]
        assert main([*draw, *more, *out]) == 2
        error = capsys.readouterr().err
        assert said in error
        assert error.count("\n") == 1
