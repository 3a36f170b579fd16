"""The least collapse multiplier over all directions, against closed forms.

In a column of boxes the forces between two boxes balance all boxes above. So the acceleration a is
carried if and only if, at each joint, |a| <= mu g and the resultant c - h a / g meets both faces;
c is the centre of mass of the boxes above, seen from above, and h its height over the joint.
Friction along a in proportion to the pressure has no moment about the resultant.
"""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
import pytest
from boxes_on_deck import random_stack, stack_on_deck

import kilter
from kilter.analysis.load_limit import NoLimit
from kilter.analysis.transport.carried_set import CarriedSet, LeastAcceleration
from kilter.contact import contacts
from kilter.mechanics.program import build_program
from kilter.mechanics.proof import digest_of

SWEEP = 2 * np.pi * np.arange(720) / 720
"""Directions of the sweep [rad]."""


def bounds(stack: kilter.Assembly) -> tuple[np.ndarray, np.ndarray]:
    """Lines n.a <= d [g] that no resultant crosses at the edge of a face, (m, 2) and (m,)."""
    mass, center = stack.geometry.mass, stack.geometry.center
    normals, reach = [], []
    for k in range(1, len(stack.parts)):
        above = (mass[k:] @ center[k:]) / mass[k:].sum()
        height = above[2] - stack.parts[k].pose.position[2] + stack.parts[k].shape.size[2] / 2
        for part in stack.parts[k - 1 : k + 1]:
            for axis in (*np.eye(3)[:2], *-np.eye(3)[:2]):
                outward = part.pose.apply(axis) - part.pose.position
                edge = part.pose.apply(axis * part.shape.size / 2)
                normals.append(-outward[:2])
                reach.append((edge - above) @ outward / height)
    return np.array(normals), np.array(reach)


@pytest.mark.slow
@pytest.mark.parametrize("first", range(0, 220, 10))
def test_the_least_of_random_stacks_is_that_of_closed_forms(first: int) -> None:
    """It is also the least of a sweep of directions, within the step of the sweep."""
    for seed in range(first, first + 10):
        stack = random_stack(seed)
        [mu] = {stack.friction}
        normals, reach = bounds(stack)
        found = CarriedSet(build_program(stack, contacts(stack))).least()
        if reach.min() < 0:
            assert isinstance(found, NoLimit)
            continue
        assert isinstance(found, LeastAcceleration)
        assert found.value == pytest.approx(min(mu, reach.min()), abs=1e-6)
        assert found.lower <= found.value
        slopes = np.column_stack([np.cos(SWEEP), np.sin(SWEEP)]) @ normals.T
        along = np.where(slopes > 0, reach / np.where(slopes > 0, slopes, 1.0), np.inf)
        swept = np.minimum(along.min(axis=1), mu).min()
        assert found.value - 1e-6 <= swept <= found.value / np.cos(np.pi / 720) + 1e-6


def multipliers(assembly: kilter.Assembly) -> dict[str, dict[str, Any]]:
    answer = kilter.transport(assembly, polar=False, collapse=True).to_dict()
    return {entry["name"]: dict(entry) for entry in answer["alpha"]}


@pytest.mark.parametrize(
    ("width", "depth", "height", "mu"),
    [(0.386, 1.14, 0.932, 0.764), (1.14, 0.386, 0.932, 0.764), (1.0, 1.0, 0.5, 0.3)],
    ids=["tips about y", "tips about x", "slides"],
)
@pytest.mark.quick("tips about y")
def test_a_block_tips_over_its_nearest_edge_or_slides(
    width: float, depth: float, height: float, mu: float
) -> None:
    found = multipliers(stack_on_deck([[width, depth, height]], mu))
    assert found["+x"]["alpha0"] == pytest.approx(min(width / height, mu), abs=1e-7)
    assert found["-y"]["alpha0"] == pytest.approx(min(depth / height, mu), abs=1e-7)
    assert found["least"]["alpha0"] == pytest.approx(min(width, depth, mu * height) / height)
    assert found["least"]["upper"] >= found["least"]["alpha0"] * (1 - 1e-9)


def test_the_multipliers_are_proved_in_the_file_and_their_mass_is_recomputed() -> None:
    """M* of a block that tips is its mass; a shift of the statement is refused."""
    block = stack_on_deck([[0.4, 1.0, 1.0]], 0.9)
    proof = kilter.transport(block, polar=False, collapse=True).proof()
    stated = [entry for entry in proof["proofs"] if entry["about"] == "alpha least"]
    assert sorted(entry["held"] for entry in stated) == [False, True]
    for entry in stated:
        assert entry["value"] == pytest.approx(0.4, abs=1e-6)
    [falls] = [entry for entry in stated if not entry["held"]]
    assert falls["participating_mass"] == pytest.approx(block.geometry.mass[1], rel=1e-6)
    assert kilter.verify(block, copy.deepcopy(proof)).holds
    for key, lie in (("participating_mass", 1.001), ("value", 1.001)):
        forged = copy.deepcopy(proof)
        [entry] = [
            entry
            for entry in forged["proofs"]
            if entry["about"] == "alpha least" and not entry["held"]
        ]
        entry[key] *= lie
        forged["digest"] = digest_of(forged)
        assert not kilter.verify(block, forged).holds
