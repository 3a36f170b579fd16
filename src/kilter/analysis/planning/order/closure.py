"""No order without holds, whatever the paths: what can stand on what stands.

Let R be the grounded parts, and add to R every part that holds by itself with all of R held:

    R = G;   while some p has forces with (R + p, R held):  R = R + p

If an order without holds puts p on the standing parts T, T + p holds by forces on p from parts of
T. So if T is in R, p is added to R: all that any such order reaches is in R. A part that is not
in R in the end falls even with all of R held, by a motion of it alone: no order without holds
exists, along whatever paths.

It speaks of single parts, put in one by one, under one gravity.
"""

from __future__ import annotations

import numpy as np

from kilter.analysis.planning.states.state import State
from kilter.analysis.planning.states.states import States
from kilter.arrays import Mask

__all__ = ["find_unreachable"]


def find_unreachable(states: States) -> tuple[Mask, list[State]]:
    """Parts that an order without holds may reach, and the motion of each of the others.

    Returns
    -------
    reached : ndarray of bool, shape (N,)
    falling : list of State
        Of each part that is not reached, alone free on all that are: it falls. Empty where all
        are reached; then nothing is said.

    Examples
    --------
    >>> from kilter.analysis.planning.states.states import states
    >>> from kilter.scenes.arches import arch
    >>> reached, falling = find_unreachable(states(arch(9, ratio=0.3, friction=0.6)))
    >>> int(reached.sum()), len(falling)
    (6, 5)
    """
    reached = states.assembly.geometry.grounded.copy()
    grown = True
    while grown:
        grown = False
        for part in np.flatnonzero(~reached).tolist():
            if _alone(states, reached, part).stable is not False:
                reached[part] = grown = True
    return reached, [_alone(states, reached, part) for part in np.flatnonzero(~reached).tolist()]


def _alone(states: States, standing: Mask, part: int) -> State:
    present = standing.copy()
    present[part] = True
    return states.judge(present, standing)
