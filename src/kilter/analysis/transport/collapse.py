"""Collapse multipliers of shaking ground: mechanism, participating mass, spectral acceleration.

Horizontal forces of alpha times each weight act along a unit direction h. alpha0 is the largest
alpha that contact forces balance; this is the largest acceleration of the carrier along -h, in g.
The mechanism v that starts there gives each weight P_i a virtual horizontal displacement

    delta_i = v_i . h
    M* = (sum P_i delta_i)^2 / (g sum P_i delta_i^2)       participating mass
    e* = g M* / sum P_i                                    fraction of participating mass
    a0* = alpha0 g / (e* FC)                               spectral acceleration of its start

(Circolare 617/2009, C8A.4.3 and C8A.4.4; Circolare 7/2019, C8.7.1.3, C8.7.1.5 and C8.7.1.8.) FC is
the confidence factor of the user. In these formulas, sum P_i contains the weights of the mechanism.
Parts that stand still lower e* and raise a0*, so both sums are reported.

Several mechanisms may start at the same alpha0, with different M*. The largest M* belongs to the
motion with the least sum P_i delta_i^2 at a given sum P_i delta_i. A quadratic term selects it:

    max t - 1/2 |r|^2:  J^T f + w + t w_h + sum r_i c_i = 0,  f in the cones
    c_i = sqrt(rho sum P / P_i) w_h,i

The multipliers v of the balance minimise the power at the limit plus rho/2 sum P sum P_i delta_i^2,
with sum P_i delta_i = 1. In a linear program, a small rho selects among the optimal motions
exactly. The motion is checked as a proof like every other mechanism. Small changes of the weights,
along a random direction and against it, find other mechanisms if M* is not unique.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.sparse import csc_array, diags_array, hstack, vstack

from kilter.analysis.load_limit import Limit, beyond_at, gravity_wrench, motion_share, starting
from kilter.arrays import Array
from kilter.mechanics.certificate import MotionProof, part_sizes
from kilter.mechanics.coulomb_cones import ConeProblem, cone_problem
from kilter.mechanics.opening import Opening
from kilter.mechanics.program import Program
from kilter.solvers.problem import ConicProgram
from kilter.tell.record import InPython, OrNull, Record, Vector, key

CONFIDENCE_FACTOR = 1.35
"""Confidence factor FC of the lowest level of knowledge, LC1 [-]. A larger factor lowers a0*."""
SELECTION = 1e-4
"""Weight rho of the quadratic term that selects a mechanism [-]. A larger weight selects more
clearly, but prefers motions that start above alpha0."""
SAME_MULTIPLIER = 1e-6
"""Distance from alpha0, relative to max(alpha0, 1), up to which a selected mechanism starts at the
limit [-]. A larger distance admits mechanisms of larger multipliers."""
SAME_MASS = 1e-3
"""Relative difference of M* above which it is not unique [-]; above the effect of `SELECTION`."""


class CollapseMultiplier(Record):
    """Multiplier of horizontal forces at which a mechanism starts, with its participating mass.

    The mechanism is that of the largest participating mass of all that were found at the limit.
    """

    name: str
    """"+x", ..., or "least"; the direction of the forces, opposite to that of the ground."""
    direction: Vector
    """Horizontal direction of the forces, unit."""
    alpha0: OrNull
    """Largest multiplier that is proved to be carried [-]; infinite without a limit."""
    upper: OrNull
    """Multiplier proved not to be carried [-]."""
    participating_mass: OrNull
    """M* [kg]."""
    e: OrNull
    """M* over the mass of all free parts [-]."""
    a0: OrNull
    """Spectral acceleration a0* for `e` [m/s^2]."""
    e_moving: OrNull
    """M* over the mass of the moving parts [-]."""
    a0_moving: OrNull
    """Spectral acceleration a0* for `e_moving` [m/s^2]."""
    unique: bool | None
    """False: other mechanisms at `alpha0` have a smaller M*."""
    limit: InPython[Limit]
    """Forces and mechanism at `alpha0`."""

    @property
    @key
    def moves(self) -> list[str]:
        """Parts that move."""
        return self.limit.moves


def find_collapse(
    program: Program, name: str, force: Array, limit: Limit, *, fc: float = 1.0
) -> CollapseMultiplier:
    """Compute the participating mass of the mechanism at a limit of horizontal forces.

    Arguments: `force` (3,): horizontal unit direction of the forces; `fc`: confidence factor FC of
    the spectral accelerations [-].

    Examples
    --------
    >>> from kilter import Assembly, Box, Part, Pose
    >>> from kilter.analysis.transport.carried_set import CarriedSet
    >>> from kilter.contact import contacts
    >>> from kilter.mechanics.program import build_program
    >>> deck = Part("deck", Box([4, 4, 1]), Pose([0, 0, -0.5]), grounded=True)
    >>> block = Part("block", Box([0.2, 1, 1]), Pose([0, 0, 0.5]))
    >>> load = Assembly([deck, block], friction=0.9)
    >>> program = build_program(load, contacts(load))
    >>> limit = CarriedSet(program).along([-1.0, 0, 0])
    >>> collapse = find_collapse(program, "+x", np.array([1.0, 0, 0]), limit)
    >>> round(collapse.alpha0, 6), round(collapse.e, 6), collapse.unique
    (0.2, 1.0, True)
    """
    mass = fraction = moving = float("nan")
    unique = None
    if limit.motion is not None:
        wide = cone_problem(program)
        wrench = gravity_wrench(program, force)
        found = [proof for proof in _mechanisms(wide, wrench, limit) if proof is not None]
        # without a selected mechanism, that of the limit remains
        chosen, others = (found[0], found[1:]) if found else (limit.motion, [])
        mass, fraction, moving = _masses(program, force, chosen)
        least = min((_masses(program, force, other)[0] for other in others), default=mass)
        unique = bool(found) and least >= mass * (1 - SAME_MASS)
        limit = replace(limit, motion=chosen)
    return CollapseMultiplier(
        name=name,
        direction=force,
        alpha0=limit.value,
        upper=limit.value + limit.gap * max(abs(limit.value), 1.0),
        participating_mass=mass,
        e=fraction,
        a0=limit.value * program.g / (fraction * fc),
        e_moving=moving,
        a0_moving=limit.value * program.g / (moving * fc),
        unique=unique,
        limit=limit,
    )


def _masses(program: Program, force: Array, proof: MotionProof) -> tuple[float, float, float]:
    """Participating mass M* [kg], and e* over the mass of the free and of the moving parts."""
    mass = program.mass * program.free
    shift = proof.motion[:, :3] @ force
    participating = float((mass @ shift) ** 2 / (mass @ shift**2))
    names = set(starting(program, proof))
    moving = np.array([name in names for name in program.names])
    return participating, participating / float(mass.sum()), participating / float(mass @ moving)


def _mechanisms(wide: ConeProblem, wrench: Array, limit: Limit) -> list[MotionProof | None]:
    """Mechanisms at a limit: that of the largest M*, then two that random weights select.

    A mechanism is None if it is not proved to start at the limit.
    """
    program = wide.program
    opening = Opening(wide)
    weight = (program.mass * program.g)[program.free]
    spread = np.zeros((len(weight), *wrench.shape))
    spread[np.arange(len(weight)), np.flatnonzero(program.free)] = wrench[program.free]
    each = spread * np.sqrt(SELECTION * weight.sum() / weight)[:, None, None]
    random = np.random.default_rng(0).uniform(-SELECTION, SELECTION, len(weight))
    change = np.zeros_like(wrench)
    change[program.free] = random[:, None] * wrench[program.free]
    none = np.zeros((0, *wrench.shape))
    motions = [
        _selected_motion(wide, wrench, wrenches, more)
        for wrenches, more in ((each, 0.0 * change), (none, change), (none, -change))
    ]
    return [_proof_at(opening, wrench, limit, motion) for motion in motions]


def _selected_motion(
    wide: ConeProblem, wrench: Array, wrenches: Array, change: Array
) -> Array | None:
    """Mechanism that the quadratic term or a change of the load selects; None if it is not found.

    Arguments: `wrench` (N, 6): horizontal forces of one times the weights; `wrenches` (n, N, 6):
    wrenches c_i of the quadratic term; `change` (N, 6): further load.
    """
    from kilter.solvers.clarabel import solve_conic

    problem = wide.problem
    total, more = problem.matrix.shape[1], len(wrenches)
    cone_matrix, positive, sizes = wide.cone_rows()
    balance, equal = wide.balance(*[-problem.scaled_load(part) for part in (wrench, *wrenches)])
    conic = hstack([-cone_matrix, csc_array((cone_matrix.shape[0], 1 + more))])
    right = problem.right + problem.scaled_load(change)
    cost = np.zeros(total + 1 + more)
    cost[total] = -1.0
    answer = solve_conic(
        ConicProgram(
            csc_array(diags_array(np.append(np.zeros(total + 1), np.ones(more)))),
            cost,
            csc_array(vstack([balance, conic])),
            np.concatenate([right, np.zeros(equal), wide.heads]),
            balance.shape[0],
            positive,
            sizes,
        )
    )
    if not answer.found:
        return None
    return problem.motion(problem.over_weight(answer.multipliers[: len(right)]))


def _proof_at(
    opening: Opening, wrench: Array, limit: Limit, motion: Array | None
) -> MotionProof | None:
    """Proof that a motion starts at a limit; None if it starts elsewhere or is not admissible."""
    program = opening.program
    if motion is None or not part_sizes(program, motion, per_radius=False).any():
        return None
    near = SAME_MULTIPLIER * max(abs(limit.value), 1.0)
    for candidate in (motion, opening.mended(motion)):
        start = motion_share(program, wrench, candidate)
        if abs(start - limit.value) <= near:
            proof = beyond_at(program, wrench, start, candidate).motion
            if proof is not None:
                return proof
    return None
