"""The pictures of Figures 5, 6 and 7 of the paper, compared with a second method."""

import importlib
import re
import sys
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

import kilter
from kilter.analysis.turning.stability_map import StabilityMap, stability_map
from kilter.analysis.turning.virtual_work import VirtualWork
from kilter.scenes import SCENES, paper
from kilter.show.canvas import encode_figure

DOCS = Path(__file__).resolve().parents[2] / "docs"
PAGE = (DOCS / "paper-figures.md").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def drawing() -> Iterator[ModuleType]:
    """The script that draws the figures."""
    sys.path.insert(0, str(DOCS))
    try:
        yield importlib.import_module("draw_paper_figures")
    finally:
        sys.path.remove(str(DOCS))
        del sys.modules["draw_paper_figures"]


@pytest.fixture(scope="module")
def sets(drawing: ModuleType) -> StabilityMap:
    return stability_map(drawing.example())


@pytest.mark.slow
@pytest.mark.parametrize("name", ["5", "6", "7"])
def test_page_and_picture_have_the_numbers_of_today(drawing, name):
    """``python docs/draw_paper_figures.py`` writes them anew."""
    figure, statement = drawing.FIGURES[name]()
    assert f"](images/paper-figure-{name}.svg)\n\n{statement}\n" in PAGE
    saved = (DOCS / "images" / f"paper-figure-{name}.svg").read_text(encoding="utf-8")
    words = r">([^<>]+)</text>"
    fresh = encode_figure(figure, ".svg").decode()
    assert re.findall(words, saved) == re.findall(words, fresh)
    assert drawing.with_statement(PAGE, name, "new") != PAGE
    with pytest.raises(ValueError, match="0 pictures"):
        drawing.with_statement("", name, "new")


@pytest.mark.slow
def test_each_direction_has_the_displacement_of_its_set(drawing, sets):
    """Figure 5: the displacement program of a random direction gives the vertex of its set."""
    work = VirtualWork(drawing.example())
    for gravity in np.random.default_rng(5).normal(size=(40, 3)):
        q = work.solve(gravity).q * work.unit.mass
        vertex = sets.vertices[(sets.vertices @ gravity).argmax()]
        assert q == pytest.approx(vertex, abs=1e-9)


@pytest.mark.slow
def test_the_star_is_stable_and_a_degree_beside_it_is_not(drawing, sets):
    [star] = drawing.stable_corners(sets)
    assembly = paper.figure_8()
    assert kilter.check(assembly, down=star).first_order == "stable"
    across = np.linalg.svd(star[None])[2][1:]
    for angle in np.radians(np.arange(0, 360, 45)):
        beside = star + np.tan(np.radians(1)) * (np.array([np.cos(angle), np.sin(angle)]) @ across)
        assert kilter.check(assembly, down=beside).verdict == "unstable"


@pytest.mark.slow
def test_a_vertex_is_optimal_exactly_between_its_limits(drawing):
    """Figure 6: the limits are the slope of the chamfer, 60 deg, and the vertical."""
    program = drawing.example(planar=True)
    flat = stability_map(program)
    best = drawing.optimal_when_upright(flat)
    low, high = drawing.turns(flat, best)
    assert (low, high) == pytest.approx((0, 60), abs=1e-9)
    work = VirtualWork(program)

    def is_optimal(degrees: float) -> bool:
        """Whether the displacement program gives the vertex for this direction of gravity."""
        angle = np.radians(degrees)
        q = work.solve(np.array([np.sin(angle), 0.0, -np.cos(angle)])).q * work.unit.mass
        return bool(np.abs(q - flat.vertices[best]).max() < 1e-9)

    assert is_optimal(low + 0.1)
    assert is_optimal(high - 0.1)
    assert not is_optimal(low - 0.1)
    assert not is_optimal(high + 0.1)


@pytest.mark.slow
def test_the_walk_rises_to_the_best_direction_of_its_facet(drawing, sets):
    """Figure 7: no direction on a fine grid of the facet has a greater z than the end."""
    facet = drawing.longest_walk()
    heights = sets.z(drawing.distinct(facet))
    assert (np.diff(heights) > 0).all()
    shares = np.random.default_rng(7).dirichlet([0.5, 0.5, 0.5], 2000)
    assert sets.z(shares * facet.signs).max() <= heights[-1] + 1e-9
    areas = [drawing.share_of_facet(sets, k, np.diag(facet.signs)) for k in range(12)]
    inside = [np.linalg.det(np.vstack([a[0], b, c])) for a in areas if len(a)
              for b, c in pairwise(a[1:])]  # fmt: skip
    assert np.abs(inside).sum() == pytest.approx(1, abs=1e-9)  # the sets cover the facet


def test_each_figure_is_an_example_or_a_picture():
    shown = set(re.findall(r"`(paper-figure-[\w-]+)`", PAGE))
    assert shown <= set(SCENES)
    figures = {int(re.findall(r"\d+", name)[0]) for name in shown}
    pictures = {int(name) for name in re.findall(r"\(images/paper-figure-(\d+)\.svg\)", PAGE)}
    assert figures | pictures == set(range(1, 13))
    assert not figures & pictures
    kinds = {SCENES[name].source for name in shown}
    assert {"F3(a)", "F3(b)", "F3(c)", "F3(d)"} <= kinds
