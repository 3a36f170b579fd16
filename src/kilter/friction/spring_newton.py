"""Newton's method for parts on contact springs, with an approximate factorisation that is shared.

The equations r(x) = 0 of `kilter.friction.springs` are solved by inexact Newton steps. Each linear
system K dx = r, with K = -dr/dx, is solved roughly by GMRES, preconditioned by the factorisation

    P = H^T S H,   S the stiffness of each contact point

of an earlier matrix. At first all points are closed and stick: this P is the largest of all K, does
not depend on the gaps, and serves all tries. P is replaced, for one try, by the symmetric part of
its own K if that saves work. P and GMRES use single precision; r and x use double precision.

References
----------
Y. Saad, M. H. Schultz, GMRES, SIAM J. Sci. Stat. Comput. 7, 1986. R. S. Dembo, S. C. Eisenstat, T.
Steihaug, Inexact Newton methods, SIAM J. Numer. Anal. 19, 1982.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import hypot

import numpy as np
from scipy.sparse import csc_array, csr_array, diags_array, vstack

from kilter.arrays import TINY, Array, Index, Mask
from kilter.friction.friction_tolerances import BALANCED, ELASTIC_GAP
from kilter.friction.law import CoulombLaw
from kilter.friction.line_search import search_step_length
from kilter.friction.springs import (
    ACROSS,
    Slopes,
    Springs,
    SpringState,
    SpringSystem,
    spring_system,
)
from kilter.solvers.block_cholesky import BlockCholesky, NotPositive
from kilter.solvers.problem import ConicProgram
from kilter.work import CONIC_ENTRY, Work

ROUGHLY = 0.3
"""Residual of a linear system, over its right-hand side, at which GMRES ends [-]. A smaller value
costs more iterations, and in soft directions makes steps too long."""
FINELY, FINER, AS_LINEAR = 1e-2, 0.1, 3.0
"""Near balance: least value of the same; its factor from step to step; and the fall of r, over that
of the linear system, up to which the equations count as linear."""
LONGEST = 8
"""Maximum number of GMRES iterations of a Newton step."""
STALLED, DISTANT = 0.9, 0.3
"""The matrix is factorised anew after a Newton step that took all iterations, or left more than the
first fraction of the imbalance, if the imbalance is below the second number. Far from balance the
stiff factor of all points gives better directions: it lets no loose part fly away."""
SHORT = 0.1
"""Fraction of a Newton step; after a shorter one, the factor of all points is used again."""
MOST, IDLE = 150, 40
"""Number of Newton steps after which the method fails; the same without a new least imbalance."""
SOFT = 1e-7
"""Stiffness added to each freedom of P, so that P is positive definite for loose parts [-]."""
STIFFER = (SOFT, 1e-5, 1e-3, 0.1, 10.0)
"""Stiffness that is added until the matrix of closed points is positive definite; after the first,
over the largest of P. Loose parts of very different sizes need more: rounding exceeds `SOFT`."""
NARROW = 24
"""Half width of a band up to which parts form chains, such as arches and stacks. Their matrices are
cheap, but soft: rough steps do not help, and single precision does not suffice."""
SEARCHED_POINT = 1.0
"""Work of a line search for each contact point."""
NEARLY = 0.1
"""Imbalance, over that which counts as balance, at which Newton's method ends [-]."""


class SharedFactor:
    """Approximate factorisation of the stiffness of contact springs, for all tries of a program."""

    def __init__(self, system: SpringSystem) -> None:
        program = system.law.program
        self.system, self._pairs = system, system.matrix.pairs
        self._both = (self._pairs >= 0).all(axis=1)
        self._width = system.lever.shape[-1] // 2
        self._ends = [_incidence(side, len(system.weight)) for side in self._pairs.T]
        self._layout = BlockCholesky(
            program.center[program.free],
            self._pairs[self._both, 0],
            self._pairs[self._both, 1],
            self._width,
            single=not self.narrow,
        )
        self.entries = self._layout.entries
        self.matrix = csr_array(system.law.matrix.astype(np.float32))
        self.transposed = csr_array(system.transposed.astype(np.float32))
        self._closed: BlockCholesky | None = None
        self._factor = self._layout

    @property
    def narrow(self) -> bool:
        """True if the parts form chains, for which inexact Newton steps do not pay."""
        return self.system.matrix.band <= NARROW

    def close_all(self, work: Work) -> None:
        """Use the factor of the springs with all points closed and sticking, from now on."""
        if self._closed is None:
            slope = np.zeros((len(self.system.law.mu) + 1, 3, 3))
            slope[:-1, 0, 0] = 1.0
            slope[:-1, 1, 1] = slope[:-1, 2, 2] = np.where(self.system.law.mu > 0, ACROSS, 0.0)
            self._closed = self._factorised(slope, work, STIFFER)
        self._factor = self._closed

    def renew(self, slope: Array, work: Work) -> None:
        """Use the factor for symmetric slopes -df/du, shape (K + 1, 3, 3), from now on."""
        self._factor = self._factorised(slope, work)

    def _factorised(
        self, slope: Array, work: Work, stiffer: Sequence[float] = (SOFT,)
    ) -> BlockCholesky:
        """Factorise the stiffness matrix for given slopes of the contact points.

        Raises `NotPositive` if the matrix is not positive definite with any of the stiffnesses that
        are added.
        """
        blocks, width = self.system.pair_blocks(slope), self._width
        diagonal = np.zeros((len(self.system.weight), width, width))
        for side, ends in enumerate(self._ends):
            square = slice(width * side, width * (side + 1))
            own = blocks[:, square, square].reshape(len(blocks), -1)
            diagonal += (ends @ own).reshape(diagonal.shape)
        largest = max(float(diagonal.max(initial=0.0)), 1.0)
        factor = self._layout.another()
        for k, added in enumerate(stiffer):
            work.dissected(width * len(diagonal), self.entries)
            stiff = diagonal + added * (largest if k else 1.0) * np.eye(width)
            try:
                factor.factorise(stiff, blocks[self._both, :width, width:])
            except NotPositive:
                if k == len(stiffer) - 1:
                    raise
            else:
                break
        return factor

    def start(self, right: Array, work: Work) -> Array:
        """Displacement of the parts under loads `right`, with all points closed and sticking."""
        self.close_all(work)
        size = max(float(np.abs(right).max(initial=0.0)), TINY)
        return size * self.solve(right / size, work)

    def solve(self, right: Array, work: Work) -> Array:
        """Solve with the present factor, for a right-hand side of size near 1, shape (n,)."""
        work.substituted(len(right), self.entries)
        return self._factor.solve(right.reshape(-1, self._width)).reshape(-1)


def _incidence(part: Index, count: int) -> csr_array:
    """Matrix of parts by pairs, shape (count, P), that is 1 where a pair ends at a part."""
    pair = np.flatnonzero(part >= 0)
    return csr_array((np.ones(len(pair)), (part[pair], pair)), shape=(count, len(part)))


def balanced_springs(
    springs: Springs, x: Array, factor: SharedFactor, work: Work
) -> tuple[SpringState, int] | None:
    """Balance of parts on springs by Newton's method from a displacement x; None if not found.

    Arguments: `x` (n,): first displacement. Returns the state in balance, and the number of Newton
    steps.
    """
    state, behind = springs.at(x), np.zeros(len(x))
    imbalance = least = springs.imbalance(state)
    tolerance, idle, best = ROUGHLY, 0, state
    count = 0
    while NEARLY * BALANCED < imbalance < np.inf:
        if count >= MOST or idle >= IDLE or work.over:
            break
        springs, behind = springs.moved(state), behind + state.x
        state = replace(state, x=np.zeros(len(x)))
        count += 1
        move, used = _krylov_step(springs, state, factor, tolerance, work)
        new = _line_search(springs, state, move)
        work.charge(SEARCHED_POINT * len(new.forces))
        reached = springs.imbalance(new)
        if float(np.linalg.norm(new.x)) < SHORT * float(np.linalg.norm(move)):
            factor.close_all(work)
        elif (used == LONGEST or reached > STALLED * imbalance) and reached < DISTANT:
            try:
                factor.renew(springs.slope_matrices(new, exact=False), work)
            except NotPositive:
                break
        # while the points that touch change, an exact step is of no use
        ratio = float(np.linalg.norm(new.rest)) / float(np.linalg.norm(state.rest))
        tolerance = max(FINER * tolerance, FINELY) if ratio < AS_LINEAR * tolerance else ROUGHLY
        state, imbalance = new, reached
        idle = 0 if imbalance < least else idle + 1
        if imbalance < least:
            least, best = imbalance, replace(state, x=behind + state.x)
    return (best, count) if least <= NEARLY * BALANCED else None


def _krylov_step(
    springs: Springs, state: SpringState, factor: SharedFactor, tolerance: float, work: Work
) -> tuple[Array, int]:
    """Newton step dx of K dx = r by preconditioned GMRES, and the number of iterations.

    If GMRES does not find a direction along which the parts gain energy, the step is P dx = r.
    """
    slope, right = springs.slopes(state), state.rest
    rows = (slope.normal, slope.across, slope.sliding, slope.coupling, slope.dilation)
    normal, across, sliding, coupling, dilation, e0, e1 = np.vstack(
        [*rows, slope.direction]
    ).astype(np.float32)
    dilates = bool(dilation.any())

    def product(v: Array) -> Array:
        u = (factor.matrix @ v).reshape(-1, 3)
        forces = np.empty_like(u)
        along = e0 * u[:, 1] + e1 * u[:, 2]
        forces[:, 0] = normal * u[:, 0] + dilation * along if dilates else normal * u[:, 0]
        pushed = coupling * u[:, 0] - sliding * along
        forces[:, 1] = across * u[:, 1] + e0 * pushed
        forces[:, 2] = across * u[:, 2] + e1 * pushed
        wrenches: Array = factor.transposed @ forces.reshape(-1)
        return wrenches

    size = float(np.linalg.norm(right))
    coefficients, steps = _gmres(
        product, lambda v: factor.solve(v, work), (right / size).astype(np.float32), tolerance
    )
    move: Array = (coefficients @ steps) * size
    if not float(move @ right) > 0:
        move = steps[0] * size
    return move, len(coefficients)


def _gmres(
    product: Callable[[Array], Array],
    precondition: Callable[[Array], Array],
    right: Array,
    tolerance: float,
) -> tuple[Array, Array]:
    """Solve a linear system roughly by GMRES, preconditioned from the right.

    Arguments: `right` (n,): right-hand side, of length 1; `tolerance`: length of the residual at
    which GMRES ends; it ends also after `LONGEST` iterations. Returns (m,): coefficients of the
    solution, and the preconditioned directions that they multiply.
    """
    basis = np.empty((LONGEST + 1, len(right)), np.float32)
    steps = np.empty((LONGEST, len(right)), np.float32)
    basis[0] = right
    triangle, left = np.zeros((LONGEST, LONGEST)), np.zeros(LONGEST + 1)
    left[0] = 1.0
    rotations: list[tuple[float, float]] = []
    for k in range(LONGEST):
        steps[k] = precondition(basis[k])
        vector = product(steps[k])
        along = basis[: k + 1] @ vector
        vector = vector - along @ basis[: k + 1]
        column = along.tolist()
        for i, (c, s) in enumerate(rotations):
            upper, lower = column[i], column[i + 1]
            column[i], column[i + 1] = c * upper + s * lower, c * lower - s * upper
        beyond = float(np.linalg.norm(vector))
        size = max(hypot(column[k], beyond), TINY)
        c, s = column[k] / size, beyond / size
        rotations.append((c, s))
        column[k] = size
        triangle[: k + 1, k] = column
        left[k], left[k + 1] = c * left[k], -s * left[k]
        if abs(left[k + 1]) <= tolerance or beyond <= TINY:
            break
        basis[k + 1] = vector / beyond
    coefficients = np.linalg.solve(triangle[: k + 1, : k + 1], left[: k + 1])
    return np.asarray(coefficients, np.float64), steps[: k + 1].astype(np.float64)


def _line_search(springs: Springs, last: SpringState, move: Array) -> SpringState:
    """State after a Newton step of suitable length.

    A point that starts to touch adds much to the imbalance, but little to the energy. So the search
    uses the work of the imbalance along the step, which falls to 0 at the minimum of the energy.
    """
    enough = STALLED * float(np.linalg.norm(last.rest))

    def trial(part: float) -> tuple[SpringState, float, bool]:
        """State after a part of the step, the work of its imbalance, and whether it is enough."""
        new = springs.at(last.x + part * move)
        return new, float(move @ new.rest), float(np.linalg.norm(new.rest)) <= enough

    return search_step_length(trial, float(move @ last.rest))


# Equilibrium forces of least elastic energy, from which the search for a seat starts.


USUAL_STEPS = 12
"""Number of steps of the conic solver that predicts its work."""


@dataclass(frozen=True, slots=True, eq=False)
class ElasticForces:
    """Equilibrium forces (n, u, v) of least elastic energy, shape (K, 3), and a motion, (n,)."""

    forces: Array
    displacement: Array


def elastic_forces(
    law: CoulombLaw, *, work: Work, factor: SharedFactor | None = None
) -> ElasticForces | None:
    """Equilibrium forces of the least elastic energy; None if none is found."""
    factor = factor or SharedFactor(spring_system(law))
    springs = _DilatingSprings(factor.system, np.ones(len(law.mu)))
    if not factor.narrow:
        balance = balanced_springs(springs, factor.start(law.load, work), factor, work)
        if balance is not None:
            return ElasticForces(balance[0].forces, balance[0].x)
    program = _energy_program(law)
    if CONIC_ENTRY * USUAL_STEPS * program.matrix.nnz > work.left:
        return None
    from kilter.solvers.clarabel import solve_conic

    answer = solve_conic(program, tolerance=ELASTIC_GAP, work=work)
    if not answer.found or len(answer.multipliers) < len(law.load):
        return None
    return ElasticForces(answer.x.reshape(-1, 3), answer.multipliers[: len(law.load)])


class _DilatingSprings(Springs):
    """Springs of the dual program: their forces are the nearest in Coulomb's cones.

    With y = -(u_n, root(0.7) u_t) and m = mu / root(0.7), the forces (f_n, f_t / root(0.7)) are the
    projection of y to the cone |y_t| <= m y_n.
    """

    def forces(self, u: Array) -> Array:
        """Contact forces (n, u, v) from the displacements of the points, shape (K, 3)."""
        law, root = self.system.law, np.sqrt(ACROSS)
        drag, height, inside, edge = self._projected(u)
        forces = np.where((inside | law.tied)[:, None], -u, 0.0)
        forces[:, 1:] *= ACROSS
        forces[edge, 0] = height[edge]
        pull = law.mu[edge] * height[edge] / drag[edge] * root
        forces[edge, 1:] = -pull[:, None] * u[edge, 1:]
        return forces

    def slopes(self, state: SpringState) -> Slopes:
        """Derivatives of the forces of the points by their displacements."""
        law, root = self.system.law, np.sqrt(ACROSS)
        drag, height, inside, edge = self._projected(state.opening)
        steep = law.mu / root
        flat = edge / (1.0 + steep**2)
        across = ACROSS * np.where(edge, steep * height / np.maximum(drag, TINY), inside)
        coupling = root * steep * flat
        direction = state.opening[:, 1:].T * (-root * edge / np.maximum(drag, TINY))
        return Slopes(
            np.where(inside | law.tied, 1.0, flat),
            across,
            np.where(edge, across - ACROSS * steep**2 * flat, 0.0),
            coupling,
            coupling,
            direction,
        )

    def _projected(self, u: Array) -> tuple[Array, Array, Mask, Mask]:
        """|y_t|, height of the nearest point of the cone's edge; points inside and on the edge."""
        law, root = self.system.law, np.sqrt(ACROSS)
        drag, steep = root * np.hypot(u[:, 1], u[:, 2]), law.mu / root
        inside = (drag <= -steep * u[:, 0]) & (u[:, 0] < 0) & ~law.tied
        edge = (steep * drag > u[:, 0]) & ~inside & ~law.tied
        height = (steep * drag - u[:, 0]) / (1.0 + steep**2)
        return drag, height, inside, edge


def _energy_program(law: CoulombLaw) -> ConicProgram:
    """Conic program for the elastic forces: balance of parts, joint rows, friction cones."""
    count = len(law.mu)
    smooth = np.flatnonzero(~law.tied & (law.mu <= 0))
    rough = np.flatnonzero(~law.tied & (law.mu > 0))
    triples = (3 * rough[:, None] + np.arange(3)).reshape(-1)
    weights = np.ones((len(rough), 3))
    weights[:, 0] = law.mu[rough]
    places = np.concatenate([3 * smooth, triples])
    values = -np.concatenate([np.ones(len(smooth)), weights.reshape(-1)])
    cone_rows = csc_array(
        (values, (np.arange(len(places)), places)), shape=(len(places), 3 * count)
    )
    compliance = np.tile([1.0, 1.0 / ACROSS, 1.0 / ACROSS], count)
    return ConicProgram(
        csc_array(diags_array(compliance)),
        np.zeros(3 * count),
        csc_array(vstack([law.matrix.T, cone_rows], format="csc")),
        np.concatenate([-law.load, np.zeros(len(places))]),
        len(law.load),
        len(smooth),
        np.full(len(rough), 3),
    )
