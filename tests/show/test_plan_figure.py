"""The sheet of a plan: a picture per step, names as text, held parts in their colour."""

from __future__ import annotations

from pathlib import Path

import pytest

import kilter
from kilter import Assembly, Box, Part, Pose
from kilter.scenes import scene
from kilter.scenes.arches import arch
from kilter.show.canvas import encode_figure

pytest.importorskip("matplotlib", reason="needs the extra kilter[figures]")


@pytest.mark.slow
def test_a_picture_a_step_and_who_is_held(tmp_path: Path) -> None:
    order = kilter.plan(arch(9, ratio=0.3, friction=0.6))
    figure = kilter.draw(order, tmp_path / "plan.svg")
    assert len(figure.axes) == len(order.steps) == 9
    svg = (tmp_path / "plan.svg").read_text(encoding="utf-8")
    for k, step in enumerate(order.steps, 1):
        assert f"{k}  {step.part}" in svg
        assert not step.held or f"hold {step.held[0]}" in svg
    assert svg.count("hold voussoir") == order.held_steps > 0


@pytest.mark.slow
def test_the_part_that_comes_stands_back_along_its_way() -> None:
    figure = kilter.draw(kilter.plan(scene("tower")), view=(0, 0))
    for axes in figure.axes:
        low, high = axes.get_ylim()
        [arrow] = [text for text in axes.texts if text.arrow_patch is not None]
        (x, y), (u, v) = arrow.xyann, arrow.xy
        assert abs(x - u) < 1e-9
        assert low < v < y < high


@pytest.mark.slow
def test_names_are_no_formulas_and_the_same_plan_gives_the_same_bytes() -> None:
    base = Part("base", Box([4, 4, 1]), Pose([0, 0, -0.5]), grounded=True)
    cube = Part("$x^2$ <b>", Box([1, 1, 1]), Pose([0, 0, 0.5]))
    pictures = [
        encode_figure(kilter.draw(kilter.plan(Assembly([base, cube]))), ".svg") for _ in range(2)
    ]
    assert pictures[0] == pictures[1]
    assert "$x^2$ &lt;b&gt;" in pictures[0].decode()
