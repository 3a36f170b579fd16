"""Limits that hold for all masses and centres within intervals: forces that follow them.

The forces are affine in the masses and the moments (`kilter.mechanics.affine`), so one linear
program bounds the values that all of them hold: an inner limit.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from kilter.analysis.margins.load_limit import NoLimit, gravity_wrench
from kilter.analysis.margins.tilt import across_gravity, first_directions
from kilter.analysis.regions.enclose import SupportPoint, nearest_face
from kilter.analysis.turning_tolerances import BALANCED, FOLLOWING_AGREES
from kilter.arrays import Array, cross
from kilter.mechanics.affine import UncertainLoad, affine_forces, affine_imbalance
from kilter.mechanics.forms import ScaledProblem
from kilter.mechanics.program import Program

if TYPE_CHECKING:
    from kilter.solvers.highs import Method

__all__ = ["FollowingForces", "Unknowns"]

Unknowns = list[tuple[int, int]]
"""What varies, (part, what): 3 for its mass, else the axis of its centre."""
STEEP = 1e3
"""Tangents of a tilt, and shares of a load, above which forces that follow are not sought."""
SHOTS = 16
"""Directions looked at for the least tilt where forces follow."""
SIMPLEX = 30_000
"""Entries of the linear program up to which simplex is tried first, else interior point."""


class FollowingForces:
    """Limits with forces that follow masses and centres in proportion.

    Parameters
    ----------
    program : Program
        In pyramids: a row a ray.
    problem : ScaledProblem
        Of the program.
    unknowns : list of (int, int)
    mass : (float, float)
        Factors of every free part by itself [-].
    center : float
        Every coordinate of every centre of mass, plus or minus [length unit].
    """

    def __init__(
        self,
        program: Program,
        problem: ScaledProblem,
        unknowns: Unknowns,
        *,
        mass: tuple[float, float],
        center: float,
    ) -> None:
        self.program, self.problem, self.unknowns = program, problem, unknowns
        self.middle = 0.5 * (mass[0] + mass[1])
        self.spread = 0.5 * (mass[1] - mass[0])
        self.moment = center * mass[1]

    def _sides(self, direction: Array) -> Array:
        """Contribution of each unknown to the load of a body force along a direction, (K, rows)."""
        program = self.program
        size = program.mass * program.g
        sides = []
        for part, what in self.unknowns:
            wrench = np.zeros((len(program.names), 6))
            if what == 3:
                wrench[part, :3] = self.spread * size[part] * direction
            else:
                wrench[part, 3:] = self.moment * size[part] * cross(np.eye(3)[what], direction)
            sides.append(self.problem.scaled_load(wrench))
        return np.array(sides).reshape(len(sides), len(self.problem.right))

    def reach(
        self, wrench: Array | None, push: Array | None, most: float, sign: float = 1.0
    ) -> float | NoLimit:
        """The largest share of given wrenches, or of a body force, that is held for all."""
        program = self.program
        down = program.down
        base = self.middle * gravity_wrench(program, down)
        if wrench is None or not program.applied.any():
            base = base + program.applied
        if push is not None:
            given = self.middle * sign * gravity_wrench(program, push)
            turns = sign * self._sides(push)
        else:
            assert wrench is not None
            given, turns = sign * wrench, np.zeros((len(self.unknowns), len(self.problem.right)))
        load = UncertainLoad(
            self.problem.scaled_load(base),
            self.problem.scaled_load(given),
            self._sides(down),
            turns,
        )
        return self._solved(load, most)

    def _solved(self, load: UncertainLoad, most: float) -> float | NoLimit:
        from kilter.solvers.highs import solve_linear

        program = affine_forces(self.problem, load, min(most, STEEP))
        methods: tuple[Method, ...] = ("simplex", "interior")
        if program.matrix.nnz > SIMPLEX:
            methods = ("interior", "simplex")
        for method in methods:
            answer = solve_linear(program, method=method)
            if answer.outcome == "infeasible":
                return NoLimit("none")
            if not answer.optimal:
                continue
            if affine_imbalance(self.problem, load, answer.x) <= BALANCED:
                share = float(answer.x[0])
                return np.inf if most > STEEP and share >= STEEP * (1 - FOLLOWING_AGREES) else share
        return NoLimit("failed")

    def tilt(self) -> float | NoLimit:
        """A turn of gravity [rad] up to which every direction is held for all."""
        basis = across_gravity(self.program)

        def shoot(direction: Array) -> SupportPoint | None:
            share = self.reach(None, direction @ basis, STEEP)
            if isinstance(share, NoLimit):
                return None
            return SupportPoint(share * direction, direction, share)

        first = first_directions(len(basis))
        face = nearest_face(shoot, first, agree=FOLLOWING_AGREES, limit=SHOTS)
        return NoLimit("failed") if face is None or face.failed else float(np.arctan(face.inner))
