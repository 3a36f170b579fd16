"""A motion that opens every contact, and what it mends: motions that are nearly admissible.

    m0:  u_n - mu |u_t| >= 1 at every contact,  J m0 = 0 at every joint,  the shortest

exists where no forces hold one another in balance without a load (Farkas): nothing is squeezed.
A motion m whose worst violation is v becomes m + v m0, which is admissible exactly. So the
motion of an interior point, good to the root of its gap, proves what an exact one does.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse import csc_array, diags_array, eye_array

from kilter.arrays import Array
from kilter.mechanics.certificate import part_sizes
from kilter.mechanics.coulomb_cones import Spread
from kilter.mechanics.mechanics_tolerances import OPENS_FAR, OPENS_MORE
from kilter.mechanics.program import Program
from kilter.solvers.problem import ConicProgram

__all__ = ["Opening"]


@dataclass(frozen=True, eq=False)
class Opening:
    """The motion `m0` of a program whose rows are spread; sought when it is first needed.

    Attributes
    ----------
    wide : Spread

    Examples
    --------
    >>> from kilter.scenes import friction, stacks
    >>> from kilter.contact import contacts
    >>> from kilter.mechanics.coulomb_cones import spread
    >>> from kilter.mechanics.program import build_program
    >>> def opening(assembly):
    ...     return Opening(spread(build_program(assembly, contacts(assembly))))
    >>> bool(opening(stacks.block_on_slope(10.0, friction=0.5)).m0[1, 2] > 0)
    True
    >>> opening(friction.h_block()).m0 is None  # squeezed between two walls
    True
    """

    wide: Spread

    @property
    def program(self) -> Program:
        """The program, with gravity as it is asked about."""
        return self.wide.program

    @cached_property
    def m0(self) -> Array | None:
        """The shortest motion that opens every contact by 1, shape (N, 6); None: none is short."""
        from kilter.solvers.clarabel import solve_conic

        answer = solve_conic(_program(self.wide))
        if not answer.found:
            return None
        motion = self.wide.problem.motion(answer.x)
        least = _least_opening(self.program, motion)
        far = float(part_sizes(self.program, motion, per_radius=False).max(initial=0.0))
        if not least > 0.0 or far > OPENS_FAR * least:
            return None
        opened: Array = motion / least
        return opened

    def turned(self, down: Array) -> Opening:
        """The same with gravity along `down`, shape (3,): it counts in no row."""
        other = Opening(self.wide.turned(down))
        other.__dict__["m0"] = self.m0
        return other

    def mended(self, motion: Array) -> Array:
        """The motion made admissible; itself where that cannot be."""
        worst = -_least_opening(self.program, motion)
        if worst <= 0.0 or self.m0 is None:
            return motion
        mended: Array = motion + (1 + OPENS_MORE) * worst * self.m0
        return mended


def _least_opening(program: Program, motion: Array) -> float:
    """Least u_n - mu |u_t| of the one-sided rows [length unit]."""
    openings = program.velocities(motion) * program.arm
    rows = program.rough
    openings[rows] -= program.mu[rows] * np.linalg.norm(program.slips(motion, rows), axis=1)
    return float(openings[~program.two_sided].min(initial=np.inf))


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
