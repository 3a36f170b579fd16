"""Parts that end together: the answer does not depend on the order of the parts."""

from __future__ import annotations

import itertools
from collections.abc import Callable

import numpy as np
import pytest

import kilter
from kilter import Assembly, Part, Pose, Prism
from kilter.mechanics.program import build_program
from kilter.second_order.answer.second_order_answer import SecondOrder
from kilter.second_order.gaps.features_of import features_of
from kilter.second_order.gaps.stationary import problem_of
from kilter.shape.primitives import Box

Build = Callable[..., list[Part]]
WIDTHS = (0.9, 1.0, 1.1)
"""Widths of the upper part, over that of the lower part [-]."""


def box_over_the_edge(width: float, off: float = 0.0) -> list[Part]:
    """A box with its centre at a given distance from the edge of the box below."""
    low = Part("low", Box([1, 1, 1]), Pose([0, 0, 0.5]), grounded=True)
    return [low, Part("high", Box([1, width, 1]), Pose([0.5 + off, 0, 1.5]))]


def leaning(width: float, off: float = 0.0) -> list[Part]:
    """A leaning block with its centre at a given distance from its own lower edge."""
    low = Part("low", Box([4, 1, 1]), Pose([0, 0, -0.5]), grounded=True)
    lean = Prism([(-1, 0), (0, 0), (1 + 2 * off, 1), (2 * off, 1)], width)
    return [low, Part("high", lean, Pose([0, 0, 0]))]


def answers(parts: list[Part]) -> list[SecondOrder]:
    """The answers for each order of the parts."""
    found = []
    for order in itertools.permutations(parts):
        assembly = Assembly(order)
        verdict = kilter.check(assembly)
        assert verdict.verdict in ("stable", "balanced")
        assert kilter.verify(assembly, verdict.proof()).holds
        assert verdict.second_order_answer is not None
        found.append(verdict.second_order_answer)
    return found


@pytest.mark.slow
@pytest.mark.parametrize("width", WIDTHS)
@pytest.mark.parametrize("build", [box_over_the_edge, leaning])
def test_what_is_over_an_edge_falls_whichever_part_is_first(build: Build, width: float) -> None:
    one, other = answers(build(width))
    assert (one.state, other.state) == ("balanced", "balanced")
    assert (one.neutral, one.free) == (other.neutral, other.free)


@pytest.mark.quick(3)
@pytest.mark.parametrize("width", WIDTHS)
@pytest.mark.parametrize("build", [box_over_the_edge, leaning])
@pytest.mark.parametrize("off", [1e-6, -1e-6])
def test_within_the_edge_it_slides_and_beyond_it_falls(
    build: Build, width: float, off: float
) -> None:
    for order in itertools.permutations(build(width, off)):
        verdict = kilter.check(Assembly(order))
        assert verdict.stable == (off < 0)
        second = verdict.second_order_answer
        assert off > 0 or (second is not None and second.state == "free")


def test_of_no_motions_none_slips() -> None:
    """So it is for a part without neutral motions of its own."""
    assembly = Assembly(box_over_the_edge(1.0))
    contacts = kilter.contacts(assembly)
    program = build_program(assembly, contacts)
    problem = problem_of(program, features_of(program, contacts))
    assert problem.slips is not None
    assert problem.sliding(np.eye(6)).shape == (2 * len(problem.rows), 6)
    assert problem.sliding(np.eye(6)[:, :0]).shape == (2 * len(problem.rows), 0)
