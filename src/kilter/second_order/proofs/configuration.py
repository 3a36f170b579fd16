"""A place on a path that leads down, exact and lower, which needs no theory.

All parts are apart there. Those that touched at a plane may also have shifted along it, all that
is on its one side, and all on the other, as far from it as they were.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import TINY, Array
from kilter.assembly import Assembly
from kilter.contact.contact_set import ContactSet
from kilter.mechanics.program import Program
from kilter.second_order.gaps.stationary import Stationary
from kilter.second_order.parts.rigid_groups import RigidGroups
from kilter.second_order.parts.separation import least_separation
from kilter.second_order.proofs.paths import Path
from kilter.second_order.second_order_tolerances import ACROSS, APART, KEEPS

__all__ = ["Configuration", "find_configuration", "is_on", "separation_at"]

STEPS = (0.004, 0.002, 0.001, 0.01, 0.02, 0.05)
"""How far along a path of length 1 an exact configuration is sought: near by first."""
BENT = 0.5
"""Second-order part of a step over its first, above which it is no neighbour of the start."""


@dataclass(frozen=True, slots=True, eq=False)
class Configuration:
    """Parts elsewhere: all lower, and apart, but for those that have only shifted along a plane.

    Attributes
    ----------
    motion : ndarray, shape (N, 6)
        Shift of each centre of mass [length unit] and rotation vector [rad]; of parts that fixed
        joints tie that of all of them, as the motion of the first.
    apart : float
        Least separation of two other parts [length unit].
    energy : float
        Of the loads, less than that at the start [N x length unit].
    """

    motion: Array
    apart: float
    energy: float


def separation_at(
    assembly: Assembly, contacts: ContactSet, program: Program, problem: Stationary, motion: Array
) -> float | None:
    """The least separation where parts have moved, shape (N, 6), groups as their first parts.

    Of parts that stay near; None where their surfaces cannot be held apart exactly.
    """
    groups = RigidGroups.of(assembly)
    return least_separation(
        assembly,
        groups.apart(program, assembly, contacts),
        groups.placed(motion),
        beyond=0.01 * problem.length,
        planes=problem.on_plane,
        tied=groups.first,
    )


def is_on(path: Path, columns: Array) -> bool:
    """Whether a place, shape (n,) scaled unknowns, is on a path, near its start."""
    along, bend = columns @ path.first, path.second @ path.first
    if not (along > 0 and 1 + 2 * along * bend >= 0):
        return False
    step = 2 * along / (1 + np.sqrt(1 + 2 * along * bend))  # along = step + bend step^2 / 2
    bent = step**2 * path.second / 2
    near = min(max(STEPS), 2 * BENT / max(float(np.linalg.norm(path.second)), TINY))
    off = np.abs(columns - step * path.first - bent).max()
    return bool(step <= near * (1 + ACROSS) and off <= KEEPS * step)


def find_configuration(
    assembly: Assembly, contacts: ContactSet, program: Program, problem: Stationary, path: Path
) -> tuple[Configuration | None, str]:
    """A place on a path where all parts are apart and lower, or why none is known."""
    assert problem.scale is not None
    for step in STEPS:
        bent = step**2 * path.second / 2
        if np.linalg.norm(bent) > BENT * step:
            continue
        columns = step * path.first + bent
        motion = program.full(columns * problem.scale)
        energy = -float(problem.load @ columns)
        apart = separation_at(assembly, contacts, program, problem, motion)
        if apart is None:
            return None, "a path leads down, but its surfaces cannot be held apart exactly"
        if apart > APART * problem.length and energy < -APART:
            return Configuration(motion, apart, energy * problem.weight * problem.length), ""
    return None, "a path leads down, but no exact configuration on it was found to be apart"
