"""Proof that no order of assembly without held parts exists, whatever the paths.

The parts that can stand alone, one after the other, do not reach the whole assembly.

Let R be the grounded parts, and add to R every part that holds by itself with all of R held:

    R = G;   while some p has forces with (R + p, R held):  R = R + p

If an order without holds puts p on the standing parts T, T + p holds by forces on p from parts of
T. So if T is in R, p is added to R: R contains every part that such an order reaches. A part
outside the final R falls even with all of R held, by a motion of this part alone. So no order
without holds exists, along any paths.

The proof covers orders that insert single parts under a fixed direction of gravity.
"""

from __future__ import annotations

import numpy as np

from kilter.analysis.planning.states.state import State
from kilter.analysis.planning.states.states import States
from kilter.arrays import Mask

__all__ = ["find_unreachable"]


def find_unreachable(states: States) -> tuple[Mask, list[State]]:
    """Find the parts that can stand without hands, and proofs that each of the other parts falls.

    Returns
    -------
    reached : ndarray of bool, shape (N,)
        Mask of the parts that an order may reach.
    falling : list of State
        States of the other parts, each alone free on the reached parts; the part falls. Empty if
        all parts are reached; then nothing is proved.

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
            if _state_of_part(states, reached, part).stable is not False:
                reached[part] = grown = True
    return reached, [
        _state_of_part(states, reached, part) for part in np.flatnonzero(~reached).tolist()
    ]


def _state_of_part(states: States, standing: Mask, part: int) -> State:
    """Judge the state in which only `part` is free and all `standing` parts are held."""
    present = standing.copy()
    present[part] = True
    return states.judge(present, standing)
