"""A motion that opens every contact, and what it mends: motions that are nearly admissible.

    m0:  u_n - mu |u_t| >= 1 at every contact,  J m0 = 0 at every joint,  the shortest

exists where no forces hold one another in balance without a load (Farkas): nothing is squeezed.
A motion m whose worst violation is v becomes m + v m0, which is admissible exactly. So the
motion of an interior point, good to the root of its gap, proves what an exact one does.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csc_array, diags_array, eye_array

from kilter.arrays import Array
from kilter.mechanics.certificate import part_sizes
from kilter.mechanics.coulomb_cones import Spread
from kilter.mechanics.mechanics_tolerances import OPENS_FAR, OPENS_MORE
from kilter.mechanics.program import Program
from kilter.solvers.problem import ConicProgram

__all__ = ["Opening", "find_opening"]


@dataclass(frozen=True, slots=True, eq=False)
class Opening:
    """The motion `m0`, shape (N, 6); None where there is none that is short."""

    program: Program
    m0: Array | None

    def mended(self, motion: Array) -> Array:
        """The motion made admissible; itself where that cannot be."""
        worst = -_least_opening(self.program, motion)
        if self.m0 is None or worst <= 0.0:
            return motion
        mended: Array = motion + (1 + OPENS_MORE) * worst * self.m0
        return mended


def _least_opening(program: Program, motion: Array) -> float:
    """Least u_n - mu |u_t| of the one-sided rows [length unit]."""
    openings = program.velocities(motion) * program.arm
    rows = program.rough
    openings[rows] -= program.mu[rows] * np.linalg.norm(program.slips(motion, rows), axis=1)
    return float(openings[~program.two_sided].min(initial=np.inf))


def find_opening(wide: Spread) -> Opening:
    """The shortest motion that opens every contact of a program.

    Examples
    --------
    >>> from kilter.scenes import friction, stacks
    >>> from kilter.contact import contacts
    >>> from kilter.mechanics.coulomb_cones import spread
    >>> from kilter.mechanics.program import build_program
    >>> def opening(assembly):
    ...     return find_opening(spread(build_program(assembly, contacts(assembly))))
    >>> bool(opening(stacks.block_on_slope(10.0, friction=0.5)).m0[1, 2] > 0)
    True
    >>> opening(friction.h_block()).m0 is None  # squeezed between two walls
    True
    """
    from kilter.solvers.clarabel import solve_conic

    program, problem = wide.program, wide.problem
    answer = solve_conic(_program(wide))
    if not answer.found:
        return Opening(program, None)
    motion = problem.motion(answer.x)
    least = _least_opening(program, motion)
    far = float(part_sizes(program, motion, per_radius=False).max(initial=0.0))
    if not least > 0.0 or far > OPENS_FAR * least:
        return Opening(program, None)
    return Opening(program, motion / least)


def _program(wide: Spread) -> ConicProgram:
    """Min 1/2 |m|^2 over scaled motions, every contact opening by 1. x = m."""
    program, rough = wide.program, wide.rough
    opening = wide.problem.openings().tocsr()
    across = wide.directions.shape[1]
    alone = np.flatnonzero(~program.two_sided & (program.mu <= 0))
    joined = np.flatnonzero(program.two_sided)
    count = len(program.part_a)
    slips = count + np.arange(across)[None, :] * len(rough) + np.arange(len(rough))[:, None]
    cones = np.column_stack([rough, slips])
    share = np.column_stack([np.ones(len(rough)), np.tile(program.mu[rough, None], across)])
    bound = np.column_stack([-np.ones(len(rough)), np.zeros((len(rough), across))])
    rows = np.concatenate([joined, alone, cones.ravel()])
    scale = np.concatenate([np.ones(len(joined) + len(alone)), share.ravel()])
    ends = np.concatenate([np.zeros(len(joined)), -np.ones(len(alone)), bound.ravel()])
    matrix = csc_array(diags_array(-scale) @ opening[rows])
    size = matrix.shape[1]
    return ConicProgram(
        csc_array(eye_array(size)), np.zeros(size), matrix, ends,
        len(joined), len(alone), np.full(len(rough), 1 + across),
    )  # fmt: skip
