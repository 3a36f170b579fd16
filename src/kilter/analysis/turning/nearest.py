"""The direction of gravity nearest to stable, by three measures, if no direction is stable.

    diamond    the greatest z over |g|_1 = 1       the paper's; hangs on the axes and units
    sphere     the greatest z over |g|_2 = 1       exact; hangs on units
    kappa      the least instability               hangs on neither; certified to a bound

Each comes with the motion that remains there: an optimum of LP (9) of least 2-norm for the
first two, the initial accelerations for the third.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

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
from kilter.validate import frozen

if TYPE_CHECKING:
    from kilter.tell.answer_data.directions_data import (
        BoundedDirectionData,
        NearestData,
        NearestDirectionData,
    )

__all__ = ["Method", "Nearest", "NearestDirection", "nearest"]

Method = Literal["joint", "walk"]


@dataclass(frozen=True, slots=True, eq=False)
class NearestDirection:
    """The direction of gravity with the least instability by a measure, and this instability.

    Attributes
    ----------
    direction : ndarray, shape (3,)
        Unit.
    value : float
        z of LP (9) on the diamond or sphere [kg x length unit], or kappa [-].
    bound : float
        No direction is better than this; equal to `value` if the method is exact.
    motion : ndarray, shape (N, 6), or None
        Displacements [length unit, rad], or for kappa accelerations [m/s^2, rad/s^2]. None
        above the size up to which displacements are found.
    programs : int
        Solved for the direction: LPs, or for kappa QPs.
    """

    direction: Array
    value: float
    bound: float
    motion: Array | None
    programs: int

    def to_dict(self) -> NearestDirectionData:
        """The nearest direction and its value as JSON data."""
        return {
            "direction": (self.direction + 0.0).tolist(),
            "value": self.value,
            "motion": None if self.motion is None else (self.motion + 0.0).tolist(),
            "programs": self.programs,
        }


@dataclass(frozen=True, slots=True, eq=False)
class Nearest:
    """Directions nearest to stable, by three measures; `kappa` is None if not computed."""

    diamond: NearestDirection
    sphere: NearestDirection
    kappa: NearestDirection | None

    def to_dict(self) -> NearestData:
        """The three nearest directions as JSON data."""
        least = self.kappa
        kappa: BoundedDirectionData | None = (
            None if least is None else {**least.to_dict(), "bound": least.bound}
        )
        return {"diamond": self.diamond.to_dict(), "sphere": self.sphere.to_dict(), "kappa": kappa}

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
    return Nearest(on_diamond, on_sphere, _least_unstable(program))


def _least_unstable(program: Program) -> NearestDirection | None:
    """The direction of the least instability kappa, and how parts start to move there.

    None if no solver finished.
    """
    try:
        least = least_instability(program)
    except SolverError:
        return None
    motion = find_motion(program.turned(least.direction))
    return NearestDirection(
        frozen(least.direction),
        least.value,
        least.bound,
        frozen(motion.acceleration) if motion.known else None,
        least.programs,
    )


def _with_displacement(
    program: Program, direction: Array, z: float, programs: int
) -> NearestDirection:
    shift = find_displacement(program.turned(direction)).displacement
    motion = None if shift is None else frozen(shift)
    return NearestDirection(frozen(direction), z, z, motion, programs)
