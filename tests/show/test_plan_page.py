"""The page of a plan: data, words, graph, and names as text."""

from __future__ import annotations

import re
from xml.etree import ElementTree

import numpy as np
import pytest
from test_page import HOSTILE, Tags, data_of

import kilter
from kilter import Assembly, Box, Part, Pose
from kilter.analysis.planning.order.explained import explain
from kilter.scenes import scene
from kilter.scenes.arches import arch
from kilter.show.packing import unpack
from kilter.show.page import render_plan
from kilter.show.plan_scene import pulled_apart
from kilter.show.precedence import graph_svg


def page_of(order: kilter.Order) -> str:
    return render_plan(order, explain(order), "a plan")


@pytest.fixture(scope="module")
def built() -> tuple[kilter.Order, str]:
    order = kilter.plan(arch(9, ratio=0.3, friction=0.6))
    return order, page_of(order)


@pytest.mark.slow
def test_the_data_are_those_of_the_plan(built: tuple[kilter.Order, str]) -> None:
    order, page = built
    data, told = data_of(page), order.to_dict()
    names = data["parts"]["names"]
    assert [names[k] for k in data["plan"]["base"]] == told["base"]
    assert len(data["plan"]["steps"]) == len(told["steps"])
    for drawn, step, one in zip(data["plan"]["steps"], told["steps"], order.steps, strict=True):
        assert [names[k] for k in drawn["parts"]] == step["parts"]
        assert [names[k] for k in drawn["held"]] == step["held"]
        assert drawn["path"] == step["path"]
        assert [names[hand["part"]] for hand in drawn["hands"]] == list(one.held)
        points = unpack(drawn["support"]["points"]).reshape(-1, 3)
        forces = unpack(drawn["support"]["forces"]).reshape(-1, 3)
        assert points.shape == forces.shape
        assert len(points) > 0 or not one.state.free.any()
    assert told["sentence"] in data["plan"]["sentence"]


def test_every_step_is_in_words_without_any_program(built: tuple[kilter.Order, str]) -> None:
    order, page = built
    text = Tags(page).text
    for step in order.steps:
        assert step.part in text
        assert not step.held or f"hold '{step.held[0]}'" in text
    assert data_of(page)["plan"]["steps"][3]["facts"][-1][0] == "standing parts"


def test_the_graph_has_every_step_once_and_leads_downwards(
    built: tuple[kilter.Order, str],
) -> None:
    order, page = built
    [svg] = re.findall(r'id="graph".*?(<svg.*?</svg>)', page, re.S)
    tree = ElementTree.fromstring(svg)
    nodes = {g.get("data-step"): float(g.find("rect").get("y")) for g in tree.iter("g")}  # type: ignore[union-attr, arg-type]
    assert set(nodes) == {None, *(str(k) for k in range(len(order.steps)))}
    index = {step.part: k for k, step in enumerate(order.steps)}
    for need in explain(order).needs:
        assert nodes[str(index[need.before])] < nodes[str(index[need.after])]


def test_arrows_that_others_imply_are_left_out() -> None:
    order = kilter.plan(scene("tower"))
    needs = [(one.before, one.after) for one in explain(order).needs]
    assert len(needs) == 10
    svg = graph_svg(order.to_dict(), needs)
    assert svg.count('class="must"') == 4
    assert svg.count('class="touch"') == 1  # the first cube on the base


def test_a_tower_is_pulled_apart_upwards_each_above_the_one_below() -> None:
    order = kilter.plan(scene("tower"))
    assembly = order.states.assembly
    apart = pulled_apart(assembly, order.to_dict()["steps"])
    assert np.array_equal(apart[:, :2], np.zeros((6, 2)))
    rises = np.diff(apart[:, 2])
    assert apart[0, 2] == 0
    assert (rises > 0.5).all()


@pytest.mark.slow
def test_an_impossibility_shows_how_each_part_falls() -> None:
    order = kilter.plan(arch(9, ratio=0.3, friction=0.6), kilter.PlanRules(hold=0))
    data = data_of(page_of(order))["plan"]
    assert (data["verdict"], data["steps"]) == ("impossible", [])
    names = [order.states.assembly.names[one["part"]] for one in data["falls"]]
    assert names == order.to_dict()["impossible"]["parts"]
    assert all(unpack(one["motion"]).any() for one in data["falls"])


@pytest.mark.slow
def test_names_are_text_in_the_strip_the_table_and_the_graph() -> None:
    base = Part("base", Box([40, 4, 1]), Pose([0, 0, -0.5]), grounded=True)
    cubes = [
        Part(name, Box([1, 1, 1]), Pose([2 * k - 10, 0, 0.5])) for k, name in enumerate(HOSTILE)
    ]
    tags = Tags(page_of(kilter.plan(Assembly([base, *cubes]))))
    plain = Tags(page_of(kilter.plan(scene("tower"))))
    assert {tag for tag, _ in tags.found} <= {tag for tag, _ in plain.found} | {"ul", "li"}
    for tag, attrs in tags.found:
        assert not any(key.startswith("on") or key == "style" for key in attrs), (tag, attrs)
        assert not {"src", "href", "srcset", "action", "data"} & set(attrs), tag
    assert HOSTILE[0] in tags.text


@pytest.mark.slow
def test_the_page_is_the_same_each_time_but_for_the_seconds() -> None:
    first, second = (page_of(kilter.plan(scene("paper-figure-9"))) for _ in range(2))
    assert first == second


def test_the_page_of_a_plan_is_written_by_report(tmp_path: object) -> None:
    made = kilter.report(kilter.plan(scene("tower")))
    assert made.verdict == "found"
    assert 'id="strip"' in made.html
    assert 'id="ball"' not in made.html


def test_a_given_order_that_fails_says_where() -> None:
    names = [f"cube-{k}" for k in (2, 1, 3, 4, 5)]
    order = kilter.plan(scene("tower"), kilter.PlanRules(sequence=names))
    assert order.verdict == "fails"
    data = data_of(page_of(order))["plan"]
    assert (data["word"], len(data["steps"]), data["falls"]) == ("This order fails", 5, [])
    for step, told in zip(data["steps"], order.to_dict()["steps"], strict=True):
        last = step["facts"][-1]
        assert last == (["fails", "; ".join(told["fails"])] if told["fails"] else last)
        assert len(step["path"]) >= 2
    assert any(step["facts"][-1][0] == "fails" for step in data["steps"])


def test_parts_that_lock_one_another_have_a_page() -> None:
    order = kilter.plan(scene("closed-frame"))
    assert (order.verdict, data_of(page_of(order))["plan"]["steps"]) == ("impossible", [])
