"""Limits of tilt and loads that hold for all masses and centres of mass within intervals.

The contact forces are affine functions of the masses and centres.

The forces are affine functions of the masses and moments (`kilter.mechanics.affine`). A single
linear program then gives a limit that is valid for every mass and centre: an inner bound.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from kilter.analysis.load_limit import NoLimit, gravity_wrench
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
"""Uncertain quantities (part, axis): axis 3 is the mass, 0 to 2 a coordinate of the centre."""
STEEP = 1e3
"""Largest tangent of a tilt, and largest share of a load, in the linear program [-]."""
SHOTS = 16
"""Maximum number of directions in the search for the least tilt."""
SIMPLEX = 30_000
"""Largest number of matrix entries with which simplex runs before the interior-point method."""


class FollowingForces:
    """Limits of tilt and loads for uncertain masses, by forces affine in masses and centres.

    Arguments: `mass`: least and greatest factor of a mass [-]; the masses vary independently;
    `center`: greatest deviation of each coordinate of each centre of mass [length unit].
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
        """Change of the scaled load with each uncertain quantity, for gravity along `direction`.

        Shape (K, rows).
        """
        program = self.program
        size = program.mass * program.g
        sides = []
        for part, axis in self.unknowns:
            wrench = np.zeros((len(program.names), 6))
            if axis == 3:
                wrench[part, :3] = self.spread * size[part] * direction
            else:
                wrench[part, 3:] = self.moment * size[part] * cross(np.eye(3)[axis], direction)
            sides.append(self.problem.scaled_load(wrench))
        return np.array(sides).reshape(len(sides), len(self.problem.right))

    def reach(
        self, wrench: Array | None, push: Array | None, most: float, sign: float = 1.0
    ) -> float | NoLimit:
        """Largest proved multiple of a load that holds for every mass and centre in the intervals.

        Arguments: `wrench` (N, 6) [N]; `push` (3,); `most` [-]. Returns share [-]; infinite if
        `most` exceeds `STEEP` and the share reaches it. `NoLimit` with reason "none" if the linear
        program is infeasible, else "failed".
        """
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
        return self._largest_share(load, most)

    def _largest_share(self, load: UncertainLoad, most: float) -> float | NoLimit:
        """Largest multiple of an uncertain load that any of several methods proves to be held."""
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
        """Angle [rad] by which gravity may tilt, for all masses and centres in their intervals.

        The angle is a proved inner bound; `NoLimit` with reason "failed" if no bound is found.
        """
        basis = across_gravity(self.program)

        def shoot(direction: Array) -> SupportPoint | None:
            share = self.reach(None, direction @ basis, STEEP)
            if isinstance(share, NoLimit):
                return None
            return SupportPoint(share * direction, direction, share)

        first = first_directions(len(basis))
        face = nearest_face(shoot, first, agree=FOLLOWING_AGREES, limit=SHOTS)
        return NoLimit("failed") if face is None or face.failed else float(np.arctan(face.inner))
