"""The displacement program (LP (9) of the paper) for many directions of gravity.

    z(g) = min over dp in A of -(sum_i m_i dr_i) . g,    A: J dp >= 0, |dr|, |dtheta| <= 1

in the units of the file. A does not depend on g, and only q = sum_i m_i dr_i, a vector of
R^3, meets it: a single kept program serves every direction, its cost is linear in g, and so are
its reduced costs, which is equation (11).

Inside, q and z are divided by the mass of the free parts, so that they lie in [-1, 1] on the
paper's diamond |g|_1 = 1; rows have length 1, and columns are dr and radius x dtheta.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np
from scipy.sparse import csc_array, diags_array

from kilter.analysis.analysis_tolerances import (
    ENTRY_ROUNDING,
)
from kilter.arrays import Array, Index
from kilter.errors import InputError
from kilter.mechanics.program import Program
from kilter.solvers.highs import KeptProgram
from kilter.solvers.problem import LinearProgram


@dataclass(frozen=True, slots=True, eq=False)
class Optimum:
    """Optimum of the displacement program for a direction of gravity, per unit of mass.

    `z` is the optimum, `q` (3,) the weighted displacement of all parts, `x` the unknowns.
    """

    z: float
    q: Array
    x: Array


@dataclass(frozen=True, slots=True, eq=False)
class UnitProgram:
    """Constraints of the displacement program, which do not depend on the direction of gravity.

    LP (9) without a cost.

    `axes`: those that gravity may have, all three or x and z. `length` (n,): x over it is dp.
    """

    lp: LinearProgram
    pull: Array
    mass: float
    axes: Index
    length: Array


def unit_program(program: Program) -> UnitProgram:
    """Scaled constraints of the displacement program of an assembly.

    Raises `InputError` if loads are given: they do not turn with gravity.
    """
    if program.applied.any():
        names = [n for n, w in zip(program.names, program.applied, strict=True) if w.any()]
        raise InputError(
            "a load is fixed in the world and does not turn with the assembly",
            part=names[0],
            hint="leave the loads out to look for an orientation",
        )
    freedoms, free = program.freedoms, program.free
    length = np.ones((int(free.sum()), 6))
    length[:, 3:] = program.radius[free, None]
    reach: Array = length[:, freedoms].reshape(-1)
    jacobian = csc_array(program.jacobian() @ diags_array(1 / reach))
    size = np.sqrt(np.asarray(jacobian.multiply(jacobian).sum(axis=1)).reshape(-1))
    matrix = csc_array(diags_array(1 / np.maximum(size, 1e-300)) @ jacobian)
    matrix.data[np.abs(matrix.data) < ENTRY_ROUNDING] = 0.0
    matrix.eliminate_zeros()
    mass = float(program.mass[free].sum())
    pull = np.zeros((3, int(free.sum()), 6))
    for axis in range(3):
        pull[axis, :, axis] = program.mass[free] / max(mass, 1e-300)
    lp = LinearProgram(
        np.zeros(len(reach)),
        matrix,
        np.zeros(len(size)),
        np.where(program.two_sided, 0.0, np.inf),
        -reach,
        reach,
    )
    axes = np.array([0, 2]) if program.planar else np.arange(3)
    return UnitProgram(lp, pull[:, :, freedoms].reshape(3, -1), mass, axes, reach)


class VirtualWork:
    """The displacement program, solved for successive directions of gravity.

    - `programs`: LPs solved.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> from kilter.contact import contacts
    >>> from kilter.mechanics.program import build_program
    >>> assembly = scene("paper-figure-4")
    >>> work = VirtualWork(build_program(assembly, contacts(assembly)))
    >>> [round(work.solve(np.array(g)).z * work.unit.mass, 6) + 0.0
    ...  for g in ([0, 0, 1.0], [-1.0, 0, 0], [-0.5, 0, -0.5])]
    [-5.0, -2.5, 0.0]
    """

    def __init__(self, program: Program) -> None:
        self.unit = unit_program(program)
        self._model = KeptProgram(self.unit.lp, warm="dual", goal="point")

    @property
    def programs(self) -> int:
        """Number of linear programs that were solved."""
        return self._model.solves

    def solve(self, gravity: Array) -> Optimum:
        """Solve the displacement program for a gravity vector of any length, shape (3,)."""
        cost = -(gravity @ self.unit.pull)
        x = self._model.solve(cost).required("the virtual work").x
        q = self.unit.pull @ x
        return Optimum(min(-float(q @ gravity), 0.0), q, x)

    def partition(self) -> Array:
        """Unit rows p, (k, 3); the last solution stays optimal for gravity g if p . g >= 0.

        Equation (11) of the paper. Reduced costs that no direction changes are left out.
        """
        rows = self._model.sensitivity(-self.unit.pull)
        size = np.linalg.norm(rows[:, self.unit.axes], axis=1)
        # against the size of the cost itself: what is smaller is rounding
        moved = size > 1e-10 * float(np.abs(self.unit.pull).max(initial=0.0))
        result: Array = rows[moved] / size[moved, None]
        return result


def facets_of_diamond(program: Program) -> list[Array]:
    """Signs, shape (3,), of each facet of the diamond |g|_1 = 1: eight facets, four if planar.

    Ordered by how near they lie to the program's own gravity.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> from kilter.contact import contacts
    >>> from kilter.mechanics.program import build_program
    >>> assembly = scene("trapped-wedge")
    >>> facets_of_diamond(build_program(assembly, contacts(assembly)))[0]
    array([-1.,  0., -1.])
    """
    middle = (0.0,) if program.planar else (1.0, -1.0)
    signs = [np.array(s) for s in product((1.0, -1.0), middle, (1.0, -1.0))]
    return sorted(signs, key=lambda s: -float(s @ program.gravity))
