"""The level of a tilt limit: the verdict just outside it, and the limit of a higher level.

A tilt margin is a limit of equilibrium: up to it forces that hold the assembly exist. Friction
guarantees less, so a higher level may end earlier. `find_level_tilt` finds the tilt up to which
the decision of `kilter.check` reaches that level, along the great circle to the tilt limit, by
bisection. Both ends of the bracket are decided.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from kilter.analysis.decision.cascade import decide
from kilter.analysis.decision.decision import Decision
from kilter.arrays import Array
from kilter.assembly import Assembly
from kilter.contact import ContactSet
from kilter.tell.levels import holds
from kilter.work import Work

__all__ = ["LevelTilt", "find_level_tilt", "verdict_outside"]

OUTSIDE = 1e-4
"""Turn beyond a tilt limit at which the verdict is decided [rad]; a larger turn may miss a thin
sector of another verdict."""
BELOW = (0.5, 0.75, 0.9, 0.97, 0.99, 0.999)
"""Shares of a limit at which its level is decided again; more shares find more gaps [-]."""
ROUNDS = 3
"""Largest number of bisections, each below the tilt at which the level was missed."""
STEPS = 12
"""Bisections of a tilt; each further one halves the bracket and costs one decision."""


@dataclass(frozen=True, slots=True, eq=False)
class LevelTilt:
    """The tilt up to which a level is reached.

    Attributes
    ----------
    level : str
        "settles" or "proved".
    lower, upper : float
        Of the tilts that were decided, the greatest that reaches the level and the least that does
        not [deg]. Both equal the tilt limit if every tilt that was decided reaches the level.
    """

    level: str
    lower: float
    upper: float

    def to_dict(self) -> dict[str, Any]:
        """The level and both tilts as JSON data."""
        return {"level": self.level, "tilt_deg": self.lower, "tilt_upper_deg": self.upper}


def verdict_outside(
    assembly: Assembly, contacts: ContactSet, angle: float, toward: Array, work: Work
) -> str:
    """The verdict of `kilter.check` just beyond a tilt limit.

    Parameters
    ----------
    assembly : Assembly
    contacts : ContactSet
    angle : float
        The limit [rad].
    toward : ndarray, shape (3,)
        Horizontal direction of the tilt, unit, world frame.
    work : Work
        Work whose time limit is kept.
    """
    beyond = _toward(assembly.down, toward, angle + OUTSIDE)
    return _decision(assembly, contacts, beyond, "equilibrium", work).verdict


def find_level_tilt(
    assembly: Assembly, contacts: ContactSet, down: Array, level: str, work: Work
) -> LevelTilt | None:
    """Find the tilt toward `down` up to which a level is reached; None if it fails without tilt.

    Parameters
    ----------
    assembly : Assembly
    contacts : ContactSet
    down : ndarray, shape (3,)
        Direction of gravity at the limit of equilibrium, unit, world frame.
    level : {"settles", "proved"}
    work : Work
        Work allowed for each decision; its time limit ends the bisection.
    """
    lower, upper = 0.0, _angle(assembly.down, down)

    def reaches(angle: float) -> bool:
        turned = _toward(assembly.down, down, angle)
        return holds(_decision(assembly, contacts, turned, level, work).level, level)

    if not reaches(lower):
        return None
    limit = upper
    if upper <= OUTSIDE or (reaches(upper - OUTSIDE) and _first_miss(reaches, upper) is None):
        return LevelTilt(level, float(np.degrees(limit)), float(np.degrees(limit)))
    for _ in range(ROUNDS):  # again below every miss that the samples find
        for _ in range(STEPS):
            if work.late:
                break
            middle = 0.5 * (lower + upper)
            lower, upper = (middle, upper) if reaches(middle) else (lower, middle)
        miss = None if work.late else _first_miss(reaches, lower)
        if miss is None:
            break
        lower, upper = 0.0, miss
    return LevelTilt(level, float(np.degrees(lower)), float(np.degrees(upper)))


def _first_miss(reaches: Callable[[float], bool], angle: float) -> float | None:
    """Least sampled angle below a limit at which the level is not reached [rad], or None.

    A motion that refutes the level may be found at a smaller tilt although it was not found at a
    larger tilt: the search for motions is not exhaustive.
    """
    missed = [share * angle for share in BELOW if not reaches(share * angle)]
    return missed[0] if missed else None


def _decision(
    assembly: Assembly, contacts: ContactSet, down: Array, require: str, work: Work
) -> Decision:
    """First-order decision under another direction of gravity, with its own share of work."""
    turned = assembly.with_down(down)
    part = work.beside(work.allowed)
    return decide(
        turned,
        contacts.of(turned),
        require=require,
        work=part,
        second_order=False,
        question=False,
    )


def _angle(first: Array, second: Array) -> float:
    """Angle between two unit vectors [rad], also exact if they are nearly parallel."""
    return float(2.0 * np.arctan2(np.linalg.norm(first - second), np.linalg.norm(first + second)))


def _toward(start: Array, end: Array, angle: float) -> Array:
    """The unit vector `start` turned toward the unit vector `end` by an angle [rad]."""
    across = end - (end @ start) * start
    size = float(np.linalg.norm(across))
    if size == 0.0:
        return start
    turned: Array = np.cos(angle) * start + np.sin(angle) * across / size
    return turned
