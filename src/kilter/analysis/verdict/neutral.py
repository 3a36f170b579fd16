"""Number of neutral motions: independent motions that cost no energy to first order.

    two-sided:   dim {dp: J dp = 0, w.dp = 0}
    one-sided:   dim span {dp: J dp >= 0, w.dp = 0} - two-sided

A box on a table has 3 two-sided and 0 one-sided neutral motions: it slides and spins. An assembly
without neutral motions is strictly stable. Along neutral motions second order decides: a ball on a
ball is "stable" to first order.

The span of the cone follows from the rows that never open. All rows that can open do so in a
common motion. Therefore a single linear program, which maximises the sum of the openings, each up
to a bound, finds the rows that never open.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import block_diag, csc_array, csr_array, diags_array, eye_array, hstack, vstack

from kilter.analysis.analysis_tolerances import RANK
from kilter.analysis.decision.motion import ImpendingMotion, motion_of, optimality, still, unknown
from kilter.arrays import TINY, Array, Mask
from kilter.mechanics.coulomb_cones import ConeProblem, cone_problem
from kilter.mechanics.forms import ScaledProblem, impending_motion, scaled_problem
from kilter.mechanics.mechanics_tolerances import ZERO_ENTRY
from kilter.mechanics.program import Program
from kilter.solvers.problem import ConicProgram, LinearProgram
from kilter.solvers.solver_tolerances import CONIC
from kilter.tell.record import Record
from kilter.units import metres_per_unit

LIMIT = 100
"""Largest number of free parts for which neutral motions are counted."""


class Neutral(Record, kw_only=False):
    """Numbers of independent neutral motions, which cost no energy to first order."""

    two_sided: int
    """Number of motions that keep all contacts."""
    one_sided: int
    """Number of further motions, which open a contact."""


def find_neutral(program: Program) -> Neutral | None:
    """Count the neutral motions of a program, without friction; None if no solver finishes.

    Returns None for more than `LIMIT` free parts, or if no solver finishes.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> from kilter.contact import contacts
    >>> from kilter.mechanics.program import build_program
    >>> assembly = scene("tower")
    >>> find_neutral(build_program(assembly, contacts(assembly))).to_dict()
    {'two_sided': 15, 'one_sided': 0}
    """
    if int(program.free.sum()) > LIMIT:
        return None
    if not program.free.any():
        return Neutral(0, 0)
    problem = scaled_problem(program)
    opening = _unit_rows(problem)
    blur = float(max(RANK, 10 * program.tolerance.max()))
    power = problem.power()
    load = power[None, :] / max(float(np.linalg.norm(power)), TINY)
    everything = np.vstack([opening, load])
    freedoms = opening.shape[1]
    two_sided = freedoms - _rank(everything, blur)
    never = _never_open(problem, opening, load, blur)
    if never is None:
        return None
    one_sided = freedoms - _rank(np.vstack([opening[never], load]), blur) - two_sided
    return Neutral(two_sided, one_sided)


def _unit_rows(problem: ScaledProblem) -> Array:
    """Unit gradients of the gaps in scaled unknowns, shape (rows, freedoms)."""
    rows = problem.openings().toarray()
    length = np.linalg.norm(rows, axis=1)
    unit: Array = rows / np.where(length > 0, length, 1.0)[:, None]
    return unit


def _rank(matrix: Array, blur: float) -> int:
    """Rank of a matrix: number of singular values above `blur` times the largest."""
    if not len(matrix):
        return 0
    if len(matrix) > matrix.shape[1]:
        # the triangular factor has the same singular values; asarray is for numpy's type stub
        matrix = np.asarray(np.linalg.qr(matrix, mode="r"))
    values = np.linalg.svd(matrix, compute_uv=False)
    return int((values > blur * max(values.max(initial=0.0), TINY)).sum())


def _never_open(problem: ScaledProblem, opening: Array, load: Array, blur: float) -> Mask | None:
    """Mask of the contacts that no neutral motion opens; None if no solver finishes."""
    from kilter.solvers.highs import find_optimum

    rows, count = opening.shape
    two_sided = problem.program.two_sided
    slack = diags_array(-np.where(two_sided, 0.0, 1.0))
    body = csc_array(np.where(np.abs(opening) < ZERO_ENTRY, 0.0, opening))
    matrix = vstack(
        [hstack([body, slack]), hstack([csc_array(load), csc_array((1, rows))])], format="csc"
    )
    # unknowns up to 1/sqrt(blur) per unit of opening: a row that opens less counts as closed
    reach = 1.0 / np.sqrt(blur)
    lp = LinearProgram(
        cost=np.concatenate([np.zeros(count), -np.ones(rows)]),
        matrix=matrix,
        row_lower=np.append(np.full(rows, 0.0) - np.where(two_sided, 0.0, blur), 0.0),
        row_upper=np.append(np.where(two_sided, 0.0, np.inf), 0.0),
        lower=np.concatenate([np.full(count, -reach), np.zeros(rows)]),
        upper=np.concatenate([np.full(count, reach), np.ones(rows)]),
    )
    answer = find_optimum(lp)
    if not answer.optimal:
        return None
    never: Mask = (answer.x[count:] < 0.5) | two_sided
    return never


# Impending motion of parts with bonds that slip and absorb power, by Gauss's principle.


def find_slipping_motion(program: Program) -> ImpendingMotion:
    """Compute the accelerations of all parts from rest, with bonds that slip.

    If the solver fails, the result is not `known`.

    Arguments: `program`: a program without friction, with bonds whose shear is limited by a force.

    Examples
    --------
    A cube slides down a wall; the glue bears half of its weight.

    >>> from kilter import Assembly, Bond, Box, Part, Pose
    >>> from kilter.contact import contacts
    >>> from kilter.mechanics.program import build_program
    >>> wall = Part("wall", Box([1, 1, 1]), Pose([1, 0, 0]), grounded=True)
    >>> glue = Bond(("block", "wall"), pull=1e5, shear=9810 / 8)
    >>> glued = Assembly([wall, Part("block", Box([1, 1, 1]))], bonds=[glue])
    >>> motion = find_slipping_motion(build_program(glued, contacts(glued)))
    >>> np.round(motion.acceleration[1, :3], 6) + 0.0
    array([ 0.   ,  0.   , -4.905])
    """
    from kilter.solvers.clarabel import solve_conic

    if not program.free.any():
        return still(program)
    wide, rows = cone_problem(program), program.two_sided
    answer = solve_conic(_slipping_program(wide), tolerance=CONIC)
    if not answer.found:
        return unknown(program)
    motion = wide.problem.motion(answer.x[: len(wide.problem.right)])
    count, heaviest = len(rows), float(program.mass[program.free].max() * program.g)
    order = np.argsort(~rows, kind="stable")
    forces = np.zeros(count)
    forces[order] = answer.multipliers[:count]
    across = answer.multipliers[count:].reshape(len(wide.rough), -1)[:, 1:]
    friction = np.zeros((count, 3))
    friction[wide.rough] = np.einsum("rd,rdi->ri", across, wide.directions)
    residual = max(
        optimality(program, motion, forces * program.arm * heaviest, friction * heaviest),
        _shear_residual(program, motion, friction * heaviest),
    )
    acceleration = motion * program.g
    acceleration[:, 3:] /= metres_per_unit(program.units)
    return motion_of(program, acceleration, residual)


def _slipping_program(wide: ConeProblem) -> ConicProgram:
    """Conic program for the motion; unknowns: scaled accelerations, and slip at each bond."""
    program, rough = wide.program, len(wide.rough)
    gauss = impending_motion(wide.problem)  # only its objective is used: masses and load
    openings = csr_array(wide.problem.openings())
    count, size = len(program.part_a), openings.shape[1]
    order = np.argsort(~program.two_sided, kind="stable")
    wide_rows = 1 + wide.directions.shape[1]
    place = np.arange(rough)
    blocks = [hstack([csr_array((rough, size)), eye_array(rough)], format="csr")]
    for k in range(wide_rows - 1):
        across = openings[count + k * rough + place]
        blocks.append(hstack([across, csr_array((rough, rough))], format="csr"))
    cones = vstack(blocks, format="csr")[
        (place[:, None] + rough * np.arange(wide_rows)).reshape(-1)
    ]
    first = hstack([openings[order], csr_array((count, rough))])
    matrix = -vstack([first, cones], format="csc")
    heaviest = float(program.mass[program.free].max() * program.g)
    equal = int(program.two_sided.sum())
    return ConicProgram(
        csc_array(block_diag([gauss.quadratic, csc_array((rough, rough))])),
        np.concatenate([gauss.cost, program.cohesion[wide.rough] / heaviest]),
        matrix,
        np.zeros(matrix.shape[0]),
        equal,
        count - equal,
        np.full(rough, wide_rows),
    )


def _shear_residual(program: Program, motion: Array, friction: Array) -> float:
    """Largest error of the shear forces at bonds, over the weight of the lighter part [-].

    The error is the excess of a shear force over its limit S, or the power that is missing because
    the force does not oppose the slip with S.
    """
    rows = program.gripping
    if not len(rows):
        return 0.0
    heavy = np.append(np.where(program.free, program.weight, np.inf), np.inf)
    weight = np.minimum(heavy[program.part_a[rows]], heavy[program.part_b[rows]])
    slips, most = program.slips(motion, rows), program.cohesion[rows]
    size = np.linalg.norm(friction[rows], axis=1)
    taken = most * np.linalg.norm(slips, axis=1) + np.einsum("ij,ij->i", friction[rows], slips)
    return float((np.maximum(size - most, np.abs(taken)) / weight).max(initial=0.0))
