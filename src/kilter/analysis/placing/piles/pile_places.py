"""Decide at many places at once whether a pile carries a further box there, without friction.

The steps, each on all places that are still open:

1. no: the centre lies beside all contacts of the box, so the box tips off alone (`pile_falls`);
2. yes: the centre is a mean of places at which the full weight is carried, on one top or several
   (`pile_carried`, with the polygons and patterns of `pile_state`);
3. no: a known motion of the pile has power although the box falls with it (`pile_falls`);
4. programs of a few open places (`pile_open_places`). Their forces are new points or patterns,
   their motions new motions, for steps 2 and 3 on the other open places.

Every yes has forces and every no a motion that `pile_question` checks independently of the solver.
Other places stay open.
"""

from __future__ import annotations

import numpy as np

from kilter.analysis.placing.piles.pile_carried import carry
from kilter.analysis.placing.piles.pile_contacts import Touching
from kilter.analysis.placing.piles.pile_falls import fall_with_pile, tip_alone
from kilter.analysis.placing.piles.pile_open_places import solve_open_places
from kilter.analysis.placing.piles.pile_question import PlaceDecision, ask_places
from kilter.analysis.placing.piles.pile_state import PileState
from kilter.arrays import Array

__all__ = ["decide_places"]


def decide_places(
    pile: PileState, size: Array, weight: float, touch: Touching, *, programs: bool = True
) -> PlaceDecision:
    """Decide the places of a box.

    Arguments: `size` (3,) [length unit]; `weight` [N].
    """
    asked = ask_places(pile, size, weight, touch)
    decision = PlaceDecision(np.zeros(len(touch.corner), dtype=np.int64))
    tip_alone(asked, decision)
    carry(asked, decision)
    fall_with_pile(asked, decision, np.arange(len(pile.motions.power)))
    if programs:
        solve_open_places(asked, decision)
    return decision
