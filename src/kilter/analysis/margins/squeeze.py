"""Decide whether arbitrarily little friction suffices, as between parts squeezed very hard.

    max sum u:  A_n s = 0,  s >= u,  0 <= u <= 1            self-stress that needs no load
    A f = b:    f free if u = 1, along and across it;  f_n >= 0, f_t = 0 elsewhere

Contacts with a self-stress may press one another as hard as desired. So with any mu
above 0 they hold forces of any direction. With those, further contacts may press one another,
and so on. If all of them and the smooth contacts carry the load, s and f make forces for
every mu > 0: f + k s, with k of the order of 1 / mu, or of its powers.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import hstack

from kilter.analysis.decision.judge import judge
from kilter.analysis.turning_tolerances import MU_SQUEEZED
from kilter.arrays import Array, Mask
from kilter.mechanics.certificate import ForceProof, check_forces
from kilter.mechanics.coulomb_cones import ConeProblem, cone_problem
from kilter.mechanics.forms import scaled_problem
from kilter.mechanics.program import Program
from kilter.solvers.problem import LinearProgram

__all__ = ["held_by_squeeze", "squeeze"]


def squeeze(program: Program) -> Array:
    """Normal forces that balance each other without a load, positive where possible, (K,) [N].

    Such forces squeeze parts between others, and can grow without limit.

    Each is at least the geometric mean of the weights, or 0: without friction.

    Examples
    --------
    >>> from kilter.scenes import friction, stacks
    >>> from kilter.contact import contacts
    >>> from kilter.mechanics.program import build_program
    >>> def pressed(assembly):
    ...     return int((squeeze(build_program(assembly, contacts(assembly))) > 0).sum())
    >>> pressed(friction.h_block()), pressed(stacks.tower(2))
    (8, 0)
    """
    from kilter.solvers.highs import find_optimum

    problem = scaled_problem(program)
    count, free = len(program.part_a), program.two_sided
    matrix = hstack([problem.matrix, problem.matrix], format="csc")
    zero, none = np.zeros(len(problem.right)), np.zeros(count)
    pressed = np.where(free, 0.0, 1.0)
    answer = find_optimum(
        LinearProgram(
            np.concatenate([-pressed, none]),
            matrix,
            zero,
            zero,
            np.concatenate([none, np.where(free, -np.inf, 0.0)]),
            np.concatenate([pressed, np.full(count, np.inf)]),
        )
    )
    if not answer.optimal:
        return none
    first, more = answer.x[:count], answer.x[count:]
    return problem.forces(np.where((first > 0.5) | free, first + more, 0.0))


def held_by_squeeze(program: Program) -> ForceProof | None:
    """Forces that hold the parts with arbitrarily little friction; None if this is not proved.

    Arguments: `program`: whatever its friction: contacts whose normals are in doubt hold nothing.
    """
    smooth = program.frictionless
    wide, stuck = _with_sticking_rows(smooth, np.zeros(len(smooth.part_a), dtype=bool))
    levels: list[_Level] = []
    while True:
        press = squeeze(stuck)
        pressed = (press > 0) & ~stuck.two_sided & ~stuck.angular
        if not pressed.any():
            break
        rows = pressed[: len(smooth.part_a)]
        levels.append(_Level(rows, *wide.gathered(press)))
        wide, stuck = _with_sticking_rows(smooth, np.any([step.rows for step in levels], axis=0))
    judged = judge(stuck) if levels else None
    if judged is None or not judged.stable or judged.forces is None:
        return None
    carried = wide.gathered(judged.forces.forces)
    for mu in MU_SQUEEZED:
        along, aside = carried
        for level in reversed(levels):
            harder = level.needed(mu, along, aside)
            along, aside = along + harder * level.along, aside + harder * level.aside
        proof = check_forces(smooth.with_friction(mu), along, aside)
        if proof.holds:
            return proof
    return None


@dataclass(frozen=True, slots=True, eq=False)
class _Level:
    """Self-balancing forces that press on the contacts `rows` and raise their friction limits."""

    rows: Mask
    along: Array
    aside: Array

    def needed(self, mu: float, along: Array, aside: Array) -> float:
        """Least multiple of these forces that, added to others, obeys the friction limits [-]."""
        rubs = np.linalg.norm(aside[self.rows], axis=1)
        missing = (rubs / mu - along[self.rows]) / self.along[self.rows]
        return float(missing.max(initial=0.0))


def _with_sticking_rows(smooth: Program, rows: Mask) -> tuple[ConeProblem, Program]:
    """Problem and program in which the contacts `rows` exert forces in any direction."""
    wide = cone_problem(smooth.with_rows(mu=np.where(rows, 1.0, 0.0)))
    spread_rows = wide.problem.program
    count = len(smooth.part_a)
    free = np.concatenate([rows, np.ones(len(spread_rows.part_a) - count, dtype=bool)])
    return wide, spread_rows.with_rows(two_sided=spread_rows.two_sided | free)
