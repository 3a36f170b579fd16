"""The direction of gravity nearest to stable, by three measures, if no direction is stable.

    diamond    the greatest z over |g|_1 = 1       the paper's; hangs on the axes and units
    sphere     the greatest z over |g|_2 = 1       exact; hangs on units
    kappa      the least instability               hangs on neither; certified to a bound

Each comes with the motion that remains there: an optimum of LP (9) of least 2-norm for the
first two, the initial accelerations for the third.
"""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np

from kilter.analysis.decision.motion import find_motion
from kilter.analysis.turning.facet_program import DiamondOptimum, joint
from kilter.analysis.turning.least_instability import least_instability
from kilter.analysis.turning.reachable import nearest_on_sphere
from kilter.analysis.turning.walk import walk
from kilter.analysis.verdict.displacement import find_displacement
from kilter.arrays import Array
from kilter.errors import SolverError
from kilter.mechanics.program import Program
from kilter.tell.record import Record, Shape, Vector
from kilter.validate import frozen

__all__ = ["Method", "Nearest", "NearestDirection", "nearest"]

Method = Literal["joint", "walk"]


class NearestDirection(Record):
    """A direction of gravity nearest to stable by a measure, and the measured value."""

    direction: Vector
    """Direction of gravity, unit."""
    value: float
    """z of LP (9) on the diamond or sphere [kg x length unit], or kappa [-]."""
    motion: Annotated[Array, Shape(None, 6)] | None
    """Displacements [length unit, rad], or for kappa accelerations [m/s^2, rad/s^2]. None above the
    size up to which displacements are found."""
    programs: int
    """Number of programs solved for the direction: LPs, or for kappa QPs."""


class BoundedDirection(NearestDirection):
    """A nearest direction, with a proved bound of its value."""

    bound: float
    """No direction is better than this."""


class Nearest(Record):
    """Directions of gravity that are nearest to stable, by three measures."""

    diamond: NearestDirection
    """On the paper's diamond, by the displacement program."""
    sphere: NearestDirection
    """On the unit sphere, by the displacement program."""
    kappa: BoundedDirection | None
    """By the instability kappa; None if it was not computed."""

    @property
    def programs(self) -> int:
        """Number of programs that were solved for all three directions."""
        ways = (self.diamond, self.sphere, self.kappa)
        return sum(way.programs for way in ways if way is not None)


def nearest(
    program: Program, *, method: Method = "joint", solved: DiamondOptimum | None = None
) -> Nearest:
    """Find the directions of gravity nearest to stable, by three measures.

    The values of the measures are 0 if some direction is stable.

    Parameters
    ----------
    program : Program
    method : {"joint", "walk"}
        For the diamond.
    solved : DiamondOptimum, optional
        Result of `joint`, if the caller has it.

    Raises
    ------
    InputError
        If loads are given.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> from kilter.contact import contacts
    >>> from kilter.mechanics.program import build_program
    >>> assembly = scene("wedge-on-wedge")
    >>> found = nearest(build_program(assembly, contacts(assembly)))
    >>> np.round(found.sphere.direction, 6) + 0.0, round(found.sphere.value, 6)
    (array([ 0.27735 ,  0.      , -0.960769]), -0.83205)
    >>> round(found.kappa.value, 6)
    0.333333
    """
    optimum = walk(program) if method == "walk" else solved or joint(program)
    length = float(np.linalg.norm(optimum.gravity))
    on_diamond = _with_displacement(program, optimum.gravity / length, optimum.z, optimum.programs)
    sphere = nearest_on_sphere(program)
    if sphere is None:  # a direction is stable: the diamond has found it
        on_sphere = on_diamond
    else:
        on_sphere = _with_displacement(program, sphere.direction, sphere.z, sphere.programs)
    return Nearest(diamond=on_diamond, sphere=on_sphere, kappa=_least_unstable(program))


def _least_unstable(program: Program) -> BoundedDirection | None:
    """The direction of the least instability kappa, and how parts start to move there.

    None if no solver finished.
    """
    try:
        least = least_instability(program)
    except SolverError:
        return None
    motion = find_motion(program.turned(least.direction))
    return BoundedDirection(
        direction=frozen(least.direction),
        value=least.value,
        bound=least.bound,
        motion=frozen(motion.acceleration) if motion.known else None,
        programs=least.programs,
    )


def _with_displacement(
    program: Program, direction: Array, z: float, programs: int
) -> NearestDirection:
    shift = find_displacement(program.turned(direction)).displacement
    motion = None if shift is None else frozen(shift)
    return NearestDirection(direction=frozen(direction), value=z, motion=motion, programs=programs)
