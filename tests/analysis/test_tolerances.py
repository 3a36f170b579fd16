"""The order of tolerances, and changes that change no verdict."""

import dataclasses
from itertools import pairwise

import numpy as np
import pytest
from judged import judged, random_turn
from transformations import as_single, permuted, renamed, scaled, tilted

from kilter.analysis import analysis_tolerances as of
from kilter.analysis import analysis_tolerances as told
from kilter.mechanics import mechanics_tolerances
from kilter.mechanics.mechanics_tolerances import TOLERANCE
from kilter.scenes import paper, scene, stacks, walls
from kilter.scenes.pieces import moved, turn
from kilter.solvers import solver_tolerances as asked
from kilter.solvers import solver_tolerances as solvers

LADDERS = {
    "asked of HiGHS, and believed": [
        asked.WIDE,
        asked.NEAR_BOUND,
        asked.BELIEVED,
        asked.BOUNDED_FEASIBLE,
        asked.FEASIBLE,
        asked.NEGLIGIBLE_ENTRY,
        asked.EPSILON,
    ],
    "asked of Clarabel, and believed": [
        asked.BELIEVED,
        asked.QUADRATIC_GOOD,
        asked.CONIC,
        asked.CONIC_FIRST,
        asked.EPSILON,
    ],
    "exact data": [mechanics_tolerances.TOLERANCE, asked.FEASIBLE],
    "a witness": [
        mechanics_tolerances.WITNESS_SLIVER,
        mechanics_tolerances.WITNESS_POWER,
        mechanics_tolerances.WITNESS_EXACT,
        mechanics_tolerances.CONE_ROUNDING,
    ],
    "rounding": [
        mechanics_tolerances.TOLERANCE,
        mechanics_tolerances.MIRROR_ROWS,
        mechanics_tolerances.MIRROR,
        mechanics_tolerances.ZERO_ENTRY,
    ],
    "what moves": [
        told.MOVES,
        told.MOTION_ENOUGH,
        told.MOTION_ASKED,
        told.MOTION_GOOD,
        told.ZERO_MOTION,
    ],
}


@pytest.mark.parametrize("name", LADDERS)
def test_each_is_below_the_one_before(name):
    assert all(coarse > fine for coarse, fine in pairwise(LADDERS[name]))


def test_forces_and_a_motion_never_prove_both():
    # rounding of the largest forces stays below the tolerance (`test_never_both`)
    assert (
        mechanics_tolerances.UNITS_IN_LAST_PLACE * mechanics_tolerances.RULED_OUT
        < mechanics_tolerances.TOLERANCE
    )
    assert (
        mechanics_tolerances.UNITS_IN_LAST_PLACE
        < mechanics_tolerances.EXCESS
        < mechanics_tolerances.TOLERANCE
    )
    # the judges ask for no more than programs, scaled to one weight, are solved to
    assert asked.LARGEST_POINT >= mechanics_tolerances.RULED_OUT


def test_nothing_is_told_finer_than_it_is_judged():
    assert min(told.ENTERS, told.RANK, told.PRESSES) >= mechanics_tolerances.TOLERANCE
    assert mechanics_tolerances.AGREES <= mechanics_tolerances.TOLERANCE
    assert (
        mechanics_tolerances.TOLERANCE
        < mechanics_tolerances.NORMAL_ANGLE
        <= mechanics_tolerances.STILL
    )


ORDERED = [
    # rounding of a hull, optimal displacements, same optimum, beyond a facet, on the boundary
    ("HULL_ROUNDING", "OPTIMAL_FACE", "OPTIMAL", "OUTSIDE_HULL"),
    # on a plane, one ray, no projection, on a facet
    ("ON_PLANE", "SAME_RAY", "NO_PROJECTION", "RAY_BLUR", "NO_DIRECTION"),
    ("CONIC_SHARP", "TILT_AGREES", "PUSH_AGREES", "FOLLOWING_AGREES"),
    ("KAPPA_RESIDUAL", "KAPPA_GAP"),
    ("ENTRY_ROUNDING", "HULL_ROUNDING", "OPPOSITE", "SAME_POINT"),
]


@pytest.mark.parametrize("names", ORDERED)
def test_each_lies_below_the_next(names):
    values = [getattr(of, name) for name in names]
    assert values == sorted(set(values))


@pytest.mark.parametrize("name", ["PULLED_IN", "BEYOND_FACET", "BEYOND_CONE", "BEYOND_LIMIT"])
def test_steps_go_outwards(name):
    steps = getattr(of, name)
    assert list(steps) == sorted(set(steps))


def test_widths_lie_above_what_the_solvers_leave():
    assert of.BLUR_OVER_TOLERANCE * TOLERANCE > of.OUTSIDE_HULL
    assert of.CONIC_SHARP <= solvers.CONIC < of.LIMIT_AGREES < of.SIDES_APART
    # the gap that is asked for leaves room for the width of the rays and of the facets
    assert 2 * (of.RAY_BLUR + of.BEYOND_FACET[-1]) < np.radians(of.GAP_DEG)
    assert of.PULLED_IN[-1] <= of.RAY_BLUR


SCENES = {
    "figure-8": paper.figure_8,
    "figure-11": lambda: paper.figure_11("b"),
    "figure-11-off": lambda: tilted(paper.figure_11("b"), [0, 1, 0], 0.01),
    "staircase": stacks.staircase,
    "wedges": lambda: scene("corner-wedges"),
}
LENGTH = 2.0
"""About the size of a part of most of the scenes [m]."""


@pytest.fixture(scope="module")
def answers():
    """Verdict and kappa of each scene as it is built."""
    found = {name: judged(build()) for name, build in SCENES.items()}
    return {name: (v.verdict, v.motion.instability) for name, v in found.items()}


def denser(assembly, factor):
    parts = [
        dataclasses.replace(
            part,
            density=None if part.given_mass else 1000.0 * factor,
            mass=None if part.given_mass is None else part.given_mass * factor,
        )
        for part in assembly.parts
    ]
    return dataclasses.replace(assembly, parts=parts)


def turned_far(assembly):
    random = np.random.default_rng(11)
    way = random.normal(size=3)
    return moved(assembly, random_turn(random), way / np.linalg.norm(way) * 1e4 * LENGTH)


CHANGES = {
    "smaller": lambda one: scaled(one, 1e-3),
    "larger": lambda one: scaled(one, 1e3),
    "lighter": lambda one: denser(one, 1e-3),
    "denser": lambda one: denser(one, 1e3),
    "less gravity": lambda one: dataclasses.replace(one, gravity=one.gravity * 1e-3),
    "turned": lambda one: moved(one, random_turn(np.random.default_rng(7))),
    "turned and far": turned_far,
    "far": lambda one: moved(one, shift=np.array([1.0, -2.0, 0.5]) * 1e4 * LENGTH),
    "other order": lambda one: permuted(one, np.random.default_rng(3).permutation(len(one.parts))),
    "other names": lambda one: renamed(one, lambda part: f"Ω {part[::-1]} / 1"),
} | {
    f"by {degrees}": lambda one, by=degrees: moved(one, turn([1, 1, 0], by))
    for degrees in (1e-6, 45 - 1e-7, 90 - 1e-6, 180 - 1e-6)
}


@pytest.mark.quick(14)
@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("change", CHANGES)
def test_no_change_of_description_changes_a_verdict(answers, name, change):
    verdict = judged(CHANGES[change](SCENES[name]()))
    assert verdict.verdict == answers[name][0]
    off = 1e-6 if "far" in change else 1e-8
    assert verdict.motion.instability == pytest.approx(answers[name][1], abs=off)


# coordinates as a binary STL carries them -------------------------------------------------

BALANCED = {
    "tower": lambda: stacks.tower(5),
    "staircase": stacks.staircase,
    "harmonic": lambda: stacks.harmonic_stack(6, scale=1 - 1e-3),
    "figure-9": paper.figure_9,
    "wall": lambda: walls.wall(4, 4),
    "keystone": lambda: scene("keystone"),
    "wedges": lambda: scene("corner-wedges"),
}


SEEDS = pytest.mark.parametrize("seed", range(2))


def rounded(assembly, seed):
    """Turned at random, 100 sizes from the origin, rounded to float32."""
    random = np.random.default_rng(seed)
    way = random.normal(size=3)
    shift = way / np.linalg.norm(way) * 100 * LENGTH
    return as_single(moved(assembly, random_turn(random), shift))


@pytest.mark.quick(2)
@SEEDS
@pytest.mark.parametrize("name", BALANCED)
def test_balanced_scene_in_float32_is_stable_within_the_accuracy_of_its_data(name, seed):
    verdict = judged(rounded(BALANCED[name](), seed))
    assert verdict.verdict == "stable"
    assert verdict.sentence.startswith("Stable, up to the accuracy of its coordinates")
    # 10 roundings of coordinates near 100 sizes over the width of the smallest face
    assert 1e-8 < verdict.tolerance.verdict < 4e-3


TILTED = {
    "tower": lambda: stacks.tower(5),
    "staircase": stacks.staircase,
    "harmonic": lambda: stacks.harmonic_stack(6, scale=1 - 1e-3),
    "figure-11": lambda: paper.figure_11("b"),
    "wall": lambda: walls.wall(4, 4),
}


@pytest.mark.quick(1)
@SEEDS
@pytest.mark.parametrize("degrees", [0.1, -1.0])
@pytest.mark.parametrize("name", TILTED)
def test_tilted_scene_in_float32_is_unstable(name, degrees, seed):
    verdict = judged(rounded(tilted(TILTED[name](), [0, 1, 0], degrees), seed))
    if verdict.tolerance.verdict > np.sin(
        np.radians(abs(degrees))
    ):  # bricks of the wall, 0.1 degrees
        assert verdict.sentence.startswith("Stable, up to the accuracy of its coordinates")
        return
    assert verdict.verdict == "unstable"
    assert "by more than the accuracy of its coordinates" in verdict.sentence


@pytest.mark.slow
@SEEDS
@pytest.mark.parametrize("name", ["tower", "figure-9", "wall"])
def test_float32_near_the_origin_is_judged_more_sharply(name, seed):
    random = np.random.default_rng(seed)
    near = judged(as_single(moved(BALANCED[name](), random_turn(random))))
    assert near.verdict == "stable"
    assert near.tolerance.verdict < judged(rounded(BALANCED[name](), seed)).tolerance.verdict
