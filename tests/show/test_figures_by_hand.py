"""Lengths, places and labels of the marks in figures, in millimetres, against closed forms."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest

import kilter
from kilter import Assembly, Box, Part, Pose, Prism
from kilter.scenes.pieces import block
from kilter.show.painter import Camera

pytest.importorskip("matplotlib")

from matplotlib.collections import LineCollection
from matplotlib.patches import FancyArrowPatch
from matplotlib.text import Text

from kilter.show.figures import draw_assembly

G = 9.81
FRONT = (0.0, 0.0)
"""Azimuth and elevation of an eye that sees x to the right and z upward."""


def labels(figure: object) -> str:
    return " | ".join(t.get_text() for t in figure.findobj(Text) if t.get_text())


@pytest.mark.slow
def test_a_cube_past_an_edge_has_arrows_of_its_acceleration_and_of_its_turn() -> None:
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
def test_forces_on_a_beam_are_lines_in_proportion_at_their_ridges(at: float) -> None:
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
def test_the_boundary_of_carried_accelerations_and_its_weakest_direction() -> None:
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
def test_the_movement_to_the_pose_at_rest_is_magnified_by_the_stated_factor() -> None:
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
