"""Impending motion of parts with bonds that slip and absorb power, by Gauss's principle.

    min 1/2 (a - M^-1 w)^T M (a - M^-1 w) + sum S |a_t|,   J a >= 0

A bond that slips resists with its shear strength S against the slip, independently of the normal
force. The motion is unique, as without such bonds. Its residual in the optimality conditions is
computed independently of the solver.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import block_diag, csc_array, csr_array, eye_array, hstack, vstack

from kilter.analysis.decision.motion import ImpendingMotion, motion_of, optimality, still, unknown
from kilter.arrays import Array
from kilter.mechanics.coulomb_cones import ConeProblem, cone_problem
from kilter.mechanics.forms import impending_motion
from kilter.mechanics.program import Program
from kilter.solvers.problem import ConicProgram
from kilter.solvers.solver_tolerances import CONIC
from kilter.units import metres_per_unit

__all__ = ["find_slipping_motion"]


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
