"""The program of proofs with friction is the same however an assembly is turned or divided."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from cases import program
from judged import random_turn
from random_friction import random_assembly
from transformations import permuted, split

from kilter.friction.canonical import canonical
from kilter.mechanics.program import Program
from kilter.scenes.stacks import tower
from kilter.scenes.transform import moved

BASES = {
    "tower": lambda: tower(3, tilt=10.0, friction=0.5),
    "stack": lambda: dataclasses.replace(random_assembly(47)[1], planar=False),
    "fence": lambda: dataclasses.replace(random_assembly(12)[1], planar=False),
}
COPIES = {
    "turned": lambda a, rng: moved(a, random_turn(rng), rng.normal(size=3)),
    "permuted": lambda a, rng: permuted(a, rng.permutation(len(a.parts))),
    "split": lambda a, rng: split(a),
}


def same(one: Program, other: Program) -> None:
    """All numbers that a proof refers to are equal up to rounding."""
    for key in ("part_a", "part_b", "source", "kind"):
        assert getattr(one, key).tolist() == getattr(other, key).tolist()
    for key in ("point", "normal", "mu", "gravity"):
        assert getattr(one, key) == pytest.approx(getattr(other, key), abs=1e-9)
    for key in ("mass", "center", "inertia"):
        mine, theirs = getattr(one, key)[one.free], getattr(other, key)[other.free]
        assert mine == pytest.approx(theirs, rel=1e-9, abs=1e-9 * np.abs(theirs).max())


@pytest.mark.parametrize("copy", [copy for copy in COPIES if copy != "split"])
@pytest.mark.parametrize("name", BASES)
def test_copies_have_the_same_program(name, copy):
    base = BASES[name]()
    expected = canonical(program(base))
    made = COPIES[copy](base, np.random.default_rng(3))
    assert not np.allclose(program(made).point[:4], program(base).point[:4])
    same(canonical(program(made)), expected)
    same(canonical(expected), expected)


def test_a_point_within_the_seam_of_two_joined_halves_counts_once():
    """The halves of a cube touch the slab below in 8 points, 4 of them on their seam."""
    base = tower(1)
    assert len(program(split(base)).part_a) == 8 + 4 + 6  # with the seam and the joint
    assert len(canonical(program(split(base))).part_a) == 6
    assert len(canonical(program(base)).part_a) == 4
