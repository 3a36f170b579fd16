"""Is there an equilibrium with Coulomb friction? Exact cones, then pyramids.

An order that ends where exactly one certificate passes (`kilter.analysis.judge`):

1. planar: the cone has two rays, so the program is linear and is judged as one;
2. large: an inner pyramid, linear, whose forces are forces of equilibrium;
3. the load factor in exact cones, by interior point;
4. pyramids of more and more sides, the inner ones for forces, the outer ones for a motion:
   by simplex, which is exact where the set of equilibria has no inside.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from kilter.analysis.candidates import Candidate
from kilter.mechanics.coulomb_cones import Spread, gathered, load_factor_in_cones, pyramid, spread
from kilter.mechanics.program import Program

__all__ = ["in_cones"]


LARGE = 12_000
"""Programs with more freedoms than this try a pyramid first."""
SIDES = (4, 16, 64)
"""Sides of the pyramids, in turn."""
LARGEST_PYRAMID = 20_000
"""Rays above which finer pyramids are left out."""


def in_cones(program: Program) -> Iterator[Candidate]:
    """Candidates for a program with friction, the cheapest way first."""
    if program.planar:
        yield from by_pyramid(program, 2)
        return
    large = int(program.free.sum()) * len(program.freedoms) > LARGE
    if large:
        yield from by_pyramid(program, SIDES[0])
    wide = spread(program)
    yield from _by_load_factor(wide)
    for sides in SIDES:
        if sides * len(program.rough) > LARGEST_PYRAMID:
            return
        yield from by_pyramid(program, sides)
        yield from by_pyramid(program, sides, outer=True)


def by_pyramid(program: Program, sides: int, *, outer: bool = False) -> Iterator[Candidate]:
    """The proof that a pyramid carries: forces of an inner one, a motion of an outer one.

    A planar pyramid is the cone itself and is both.
    """
    from kilter.analysis.judge import judge

    rays = pyramid(program, sides, outer=outer)
    judged = judge(rays)
    word = f"{'outer' if outer else 'inner'} pyramid of {sides} sides"
    words = "; ".join((word, *judged.solvers))
    both = program.planar
    forces = friction = None
    if judged.forces is not None and (both or not outer):
        forces, friction = gathered(program, rays, judged.forces.forces)
    motion = judged.motion.motion if judged.motion is not None and (both or outer) else None
    yield Candidate(words, forces, friction, motion)


def _by_load_factor(wide: Spread) -> Iterator[Candidate]:
    from kilter.solvers.conic import solve_conic

    problem = wide.problem
    answer = solve_conic(load_factor_in_cones(wide))
    factor = float(answer.x[-1])
    word = f"load factor in cones: clarabel, {answer.iterations} iterations, {answer.outcome}"
    if not np.isfinite(factor):
        return
    if factor > 0.5:
        forces, friction = wide.decoded(answer.x[:-1] / factor)
        yield Candidate(word, forces, friction)
        return
    rows = len(problem.right)
    motion = problem.motion(problem.over_weight(answer.multipliers[:rows]))
    yield Candidate(word, motion=motion)
