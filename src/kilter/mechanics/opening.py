"""A motion that opens every contact, used to repair motions that slightly close some contacts.

    m0:  u_n - mu |u_t| >= 1 at every contact,  J m0 = 0 at every joint,  |m0| least

exists iff no nonzero contact forces balance one another without a load (Farkas): there is no
self-stress. If the worst violation of a motion m is v, then m + v m0 is exactly admissible. So a
motion from an interior point, accurate to the root of its gap, proves as much as an exact motion.

The same program with another objective gives the motion that bounds all contact forces best
(`kilter.friction.reduced_law`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse import csc_array, csr_array, eye_array, hstack, vstack

from kilter.arrays import Array
from kilter.mechanics.certificate import part_sizes
from kilter.mechanics.coulomb_cones import ConeProblem
from kilter.mechanics.mechanics_tolerances import OPENS_FAR, OPENS_MORE
from kilter.mechanics.program import Program
from kilter.solvers.problem import ConicProgram


@dataclass(frozen=True, eq=False)
class Opening:
    """The shortest motion `m0` that opens every contact of a program; computed at the first use.

    Examples
    --------
    >>> from kilter.scenes import friction, stacks
    >>> from kilter.contact import contacts
    >>> from kilter.mechanics.coulomb_cones import cone_problem
    >>> from kilter.mechanics.program import build_program
    >>> def opening(assembly):
    ...     return Opening(cone_problem(build_program(assembly, contacts(assembly))))
    >>> bool(opening(stacks.block_on_slope(10.0, friction=0.5)).m0[1, 2] > 0)
    True
    >>> opening(friction.h_block()).m0 is None  # squeezed between two walls
    True
    """

    wide: ConeProblem

    @property
    def program(self) -> Program:
        """The program whose contacts `m0` opens, for the current direction of gravity."""
        return self.wide.program

    @cached_property
    def m0(self) -> Array | None:
        """The shortest motion that opens every contact by 1, shape (N, 6).

        None if no such motion exists, or if it moves a part too far (`OPENS_FAR`).
        """
        from kilter.solvers.clarabel import solve_conic

        solution = solve_conic(_shortest_opening(self.wide))
        if not solution.found:
            return None
        motion = self.wide.problem.motion(solution.x)
        least = _least_opening(self.program, motion)
        reach = float(part_sizes(self.program, motion, per_radius=False).max(initial=0.0))
        if not least > 0.0 or reach > OPENS_FAR * least:
            return None
        opened: Array = motion / least
        return opened

    def turned(self, down: Array) -> Opening:
        """The same opening motion for gravity along `down`, shape (3,); `m0` does not change."""
        opening = Opening(self.wide.turned(down))
        opening.__dict__["m0"] = self.m0
        return opening

    def narrowed(self, wide: ConeProblem) -> Opening:
        """The same opening motion for narrower friction cones `wide`, which it opens as well."""
        opening = Opening(wide)
        opening.__dict__["m0"] = self.m0
        return opening

    def mended(self, motion: Array) -> Array:
        """Add a multiple of m0 to a motion so that no contact closes; unchanged without m0."""
        violation = -_least_opening(self.program, motion)
        if violation <= 0.0 or not np.isfinite(violation) or self.m0 is None:
            return motion
        mended: Array = motion + (1 + OPENS_MORE) * violation * self.m0
        return mended


def _least_opening(program: Program, motion: Array) -> float:
    """Smallest opening u_n - mu |u_t| of the one-sided rows in a motion [length unit]."""
    openings = program.velocities(motion) * program.arm
    rows = program.rough
    with np.errstate(over="ignore"):  # an infinite motion opens nothing
        openings[rows] -= program.mu[rows] * np.linalg.norm(program.slips(motion, rows), axis=1)
    openings[program.bounded] = np.inf  # a strap may lengthen, friction may yield
    return float(openings[~program.two_sided].min(initial=np.inf))


def _shortest_opening(wide: ConeProblem) -> ConicProgram:
    """Conic program for the shortest scaled motion m that opens every contact by at least 1."""
    program = wide.program
    opening, count = csr_array(wide.problem.openings()), len(program.part_a)
    rubs = np.flatnonzero(program.mu[wide.rough] > 0)
    smooth = ~program.two_sided & (program.mu <= 0) & np.isinf(program.capacity)
    rough = wide.rough[rubs]
    slips = [count + k * len(wide.rough) + rubs for k in range(wide.directions.shape[1])]
    return opening_program(
        opening[np.flatnonzero(program.two_sided & np.isinf(program.capacity))],
        opening[np.flatnonzero(smooth)],
        [opening[rows] for rows in (rough, *slips)],
        program.mu[rough],
    )


def opening_program(
    joined: csr_array,
    smooth: csr_array,
    rough: Sequence[csr_array],
    mu: Array,
    *,
    load: Array | None = None,
) -> ConicProgram:
    """Conic program for the best motion m that opens every contact by at least 1.

        min 1/2 |m|^2,  or  min (|m| - load.m) / 2:
        J m = 0 at joints,   u_n >= 1 at smooth contacts,   u_n - mu |u_t| >= 1 at rough ones

    Arguments: `joined`, `smooth`; `rough` (R, n); `mu` (R,) [-]; `load` (n,).
    """
    cone_size, count = len(rough), len(mu)
    cones = vstack([rough[0], *[row.multiply(mu[:, None]) for row in rough[1:]]], format="csr")
    order = np.arange(count)[:, None] + count * np.arange(cone_size)
    matrix = -vstack([joined, smooth, cones[order.reshape(-1)]], format="csc")
    ends = np.zeros((count, cone_size))
    ends[:, 0] = -1.0
    bound = np.concatenate([np.zeros(joined.shape[0]), -np.ones(smooth.shape[0]), ends.reshape(-1)])
    sizes, size = np.full(count, cone_size), matrix.shape[1]
    heads = (joined.shape[0], smooth.shape[0])
    if load is None:
        return ConicProgram(
            csc_array(eye_array(size)), np.zeros(size), matrix, bound, *heads, sizes
        )
    bounded = hstack([csc_array((matrix.shape[0], 1)), matrix])
    return ConicProgram(
        csc_array((size + 1, size + 1)),
        np.concatenate([[0.5], -0.5 * load]),
        csc_array(vstack([bounded, -eye_array(size + 1)])),
        np.concatenate([bound, np.zeros(size + 1)]),
        *heads,
        np.append(sizes, size + 1),
    )
