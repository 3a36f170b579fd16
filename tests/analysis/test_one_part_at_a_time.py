"""The paper's comparison (2.2): one part at a time is right on trees and wrong on loops."""

import dataclasses

import numpy as np
import pytest
from judged import judged, program_of
from one_part import one_part_at_a_time
from transformations import tilted

from kilter.assembly import Assembly
from kilter.scenes import paper, scene, stacks
from kilter.scenes.pieces import block, floor

TREES = {
    "tower": stacks.tower,
    "staircase": lambda: stacks.staircase(4, offset=0.2 * 0.98),
    "staircase-fails": lambda: stacks.staircase(4, offset=0.2 * 1.02),
    "staircase-of-9": lambda: stacks.staircase(9, offset=0.1 * (1 - 1e-5)),
    "staircase-of-9-fails": lambda: stacks.staircase(9, offset=0.1 * (1 + 1e-5)),
    "harmonic": lambda: stacks.harmonic_stack(8, scale=1 - 1e-5),
    "harmonic-fails": lambda: stacks.harmonic_stack(8, scale=1 + 1e-5),
    "slope": stacks.block_on_slope,
    "leaning-tower": lambda: stacks.tower(3, tilt=0.1),
    "three-blocks": lambda: dataclasses.replace(
        stacks.three_block_overhang(-0.01),
        parts=[p for p in stacks.three_block_overhang(-0.01).parts if p.name != "left"],
    ),
    "floating": lambda: scene("floating-block"),
}


def random_tree(seed):
    """Boxes put on one another anywhere, each on one below and clear of all others."""
    random = np.random.default_rng(seed)
    parts = [floor([-9, -9], [9, 9])]
    for column in range(2):
        x = y = 0.0
        x += 8.0 * column - 4.0
        for level in range(int(random.integers(2, 5))):
            x, y = x + random.uniform(-0.45, 0.45), y + random.uniform(-0.45, 0.45)
            low, high = [x - 0.5, y - 0.5, level], [x + 0.5, y + 0.5, level + 1]
            parts.append(block(f"box-{column}-{level}", low, high, mass=random.uniform(0.2, 3)))
    return Assembly(parts)


def lopsided_frame(name="right", mass=1.001, **options):
    """Figure 9 with one block a thousandth heavier than the others."""
    assembly = paper.figure_9(**options)
    parts = [
        dataclasses.replace(part, mass=mass) if part.name == name else part
        for part in assembly.parts
    ]
    return dataclasses.replace(assembly, parts=parts)


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", TREES)
def test_one_part_at_a_time_is_right_on_trees(name):
    verdict = judged(TREES[name]())
    found = one_part_at_a_time(verdict.program)
    assert not found.loops
    assert found.stable == (verdict.verdict == "stable")


@pytest.mark.quick(1)
@pytest.mark.parametrize("seed", range(20))
def test_one_part_at_a_time_is_right_on_random_trees(seed):
    verdict = judged(random_tree(seed))
    found = one_part_at_a_time(verdict.program)
    assert not found.loops
    assert found.stable == (verdict.verdict == "stable")


@pytest.mark.slow
def test_random_trees_are_of_both_kinds():
    words = {judged(random_tree(seed)).verdict for seed in range(20)}
    assert words == {"stable", "unstable"}


@pytest.mark.quick(1)
@pytest.mark.parametrize("planar", [True, False])
def test_loop_of_figure_9_circulates_as_soon_as_one_block_is_heavier(planar):
    verdict = judged(lopsided_frame(planar=planar))
    assert verdict.verdict == "unstable"
    assert set(verdict.moving) == {"bottom", "right", "top", "left"}
    # all four go round at one speed: 0.001 kg drives 4.001 kg
    a = verdict.motion.acceleration[1:]
    size = 9.81 * 0.001 / 4.001
    ways = {"right": [0, 0, -1], "bottom": [-1, 0, 0], "left": [0, 0, 1], "top": [1, 0, 0]}
    for name, way in ways.items():
        k = verdict.assembly.index[name] - 1
        assert np.allclose(a[k, :3], size * np.array(way), atol=1e-9)
    # one part at a time finds each held by its neighbours
    found = one_part_at_a_time(verdict.program)
    assert len(found.loops) == 4
    assert found.stable


@pytest.mark.slow
@pytest.mark.parametrize("name", ["bottom", "top", "left", "right"])
@pytest.mark.parametrize("degrees", [0.0, 200.0])
def test_loop_is_wrong_one_part_at_a_time_whichever_block_and_direction(name, degrees):
    assembly = tilted(lopsided_frame(name, 1.5, planar=True), [0, 1, 0], degrees)
    verdict = judged(assembly)
    found = one_part_at_a_time(verdict.program)
    assert found.stable
    # the heavier block slides along its own side, unless gravity is square to that side
    along = np.array([1.0, 0, 0]) if name in ("bottom", "top") else np.array([0, 0, 1.0])
    square = abs(float(assembly.down @ along)) < 1e-12
    assert verdict.verdict == ("stable" if square else "unstable")


@pytest.mark.slow
def test_loop_of_equal_blocks_is_stable_for_both():
    verdict = judged(paper.figure_9(planar=True))
    assert verdict.verdict == "stable"
    assert one_part_at_a_time(verdict.program).stable


@pytest.mark.slow
@pytest.mark.parametrize("build", [paper.figure_8, paper.figure_1, lambda: scene("wedge-on-wedge")])
def test_figures_1_and_8_are_loops_through_the_held_part(build):
    verdict = judged(build())
    assert verdict.verdict == "unstable"
    found = one_part_at_a_time(verdict.program)
    loops = {verdict.program.names[k] for k in found.loops}
    if "C2" in verdict.program.names:
        # C2 rests on C3 and the wall, C3 on the floor: each stands while the other does
        assert loops == {"C2", "C3"}
        assert found.stable
    else:
        assert not loops
        assert not found.stable


@pytest.mark.slow
def test_what_one_part_finds_unstable_is_unstable():
    for build in (lambda: stacks.inverted_triangle(3), lambda: scene("wall-with-opening")):
        program = program_of(build())
        if not one_part_at_a_time(program).stable:
            assert judged(build()).verdict == "unstable"
