"""Places of rest on the page and in the figure of a region agree with the answer."""

from __future__ import annotations

import pytest
from lathe import turned_part
from test_page import data_of

import kilter
from kilter import Assembly, Box, Part
from kilter.analysis.everything import everything
from kilter.scenes.pieces import block, floor
from kilter.show.page import render
from kilter.show.sphere import draw_region
from kilter.tell.region_facts import rest_words
from kilter.tell.rest_table import REST_SIGNS, rest_table


def corner(mu: float = 0.0) -> Assembly:
    """A cube in the corner of three walls."""
    walls = [
        block("floor", [-1, -1, -1], [2, 2, 0], grounded=True),
        block("left", [-1, -1, 0], [0, 2, 2], grounded=True),
        block("back", [0, -1, 0], [2, 0, 2], grounded=True),
    ]
    return Assembly([*walls, block("cube", [0, 0, 0], [1, 1, 1])]).with_friction(mu)


@pytest.mark.slow
def test_the_page_marks_each_place_of_rest_with_the_words_of_the_answer() -> None:
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
def test_what_it_lies_on_is_what_bears_it() -> None:
    """Along the axis of the corner three walls carry the cube, along an edge only two."""
    axis, *edges = kilter.region(corner(), rests=True).rests
    assert axis.on == ("floor", "left", "back")
    assert sorted(edge.on for edge in edges) == [("back",), ("floor",), ("left",)]


@pytest.mark.slow
def test_the_table_has_the_well_of_a_body_on_a_table() -> None:
    dome = turned_part("dome", [(0, 0), (1, 1, 0, 1), (0, 1)])
    answer = kilter.region(Assembly([floor([-4, -4], [4, 4]), dome]), rests=True).to_dict()
    [row] = rest_table(answer).rows(9)
    assert row == ["(0, 0, -1)", "floor", REST_SIGNS["free"],
                   "110.556 deg", "9102 J", "7705 N m/rad", "1.668 s"]  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("mu", [0.0, 0.3])
def test_the_figure_marks_them_where_they_were_asked(mu: float) -> None:
    asked = mu == 0
    figure = draw_region(kilter.region(corner(mu), rests=asked))
    said = [entry.get_text() for legend in figure.legends for entry in legend.get_texts()]
    assert ("rest: strict minimum" in said) == asked
    assert ("rest: slides or rolls freely" in said) == asked


@pytest.mark.slow
def test_with_friction_the_page_marks_none() -> None:
    page = render(everything(corner(0.3)), title="rests", command="")
    assert data_of(page)["region"]["rests"] == []
    assert "Places of rest" not in page


@pytest.mark.slow
def test_many_parts_are_not_asked() -> None:
    boxes = [Part(f"b{k}", Box([1, 1, 1]), pose=[[1, 0, 0, 2 * k], [0, 1, 0, 0], [0, 0, 1, 0.5],
                                                [0, 0, 0, 1]]) for k in range(7)]  # fmt: skip
    assembly = Assembly([floor([-2, -2], [20, 2]), *boxes])
    assert everything(assembly).region["rests"] == []
