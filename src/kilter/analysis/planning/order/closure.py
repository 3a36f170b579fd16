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

from kilter.analysis.planning.order.search import FEW, PROGRAM
from kilter.analysis.planning.states.state import State
from kilter.analysis.planning.states.states import States
from kilter.arrays import Mask
from kilter.work import Work

__all__ = ["find_unreachable"]


def find_unreachable(states: States, work: Work | None = None) -> tuple[Mask, list[State]]:
    """Find the parts that can stand without hands, and proofs that each of the other parts falls.

    Returns `reached` (N,): mask of the parts that an order may reach; `falling`: states of the
    other parts, each alone free on the reached parts; the part falls. Empty if all parts are
    reached, or if the budget is exhausted; then nothing is proved.

    Examples
    --------
    >>> from kilter.analysis.planning.states.states import states
    >>> from kilter.scenes.arches import arch
    >>> reached, falling = find_unreachable(states(arch(9, ratio=0.3, friction=0.6)))
    >>> int(reached.sum()), len(falling)
    (6, 5)
    """
    work = Work() if work is None else work
    reached = states.assembly.geometry.grounded.copy()
    grown = True
    while grown:
        grown = False
        for part in np.flatnonzero(~reached).tolist():
            if work.over:
                return reached, []
            if _state_of_part(states, reached, part, work).stable is not False:
                reached[part] = grown = True
    falling = np.flatnonzero(~reached).tolist()
    return reached, [_state_of_part(states, reached, part, work) for part in falling]


def _state_of_part(states: States, standing: Mask, part: int, work: Work) -> State:
    """Judge the state in which only `part` is free and all `standing` parts are held."""
    present = standing.copy()
    present[part] = True
    before = states.units
    state = states.judge(present, standing)
    work.charge(states.units - before + PROGRAM * (FEW + 1))
    return state
