"""Second-order answer that includes the rules about small pushes (`small_push`)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from kilter.mechanics.program import Program
from kilter.second_order.answer.second_order_answer import SecondOrder, open_answer
from kilter.second_order.answer.whole import NEEDS_FRICTION
from kilter.second_order.motions.small_push import ABOVE_EDGE, SmallPush


def pushed_answer(program: Program, push: SmallPush, known: SecondOrder | None) -> SecondOrder:
    """Answer with the result of a small push that makes parts fall, or may make them fall.

    Arguments: `known`: answer without friction; None if friction is needed to hold the parts.
    """
    why = push.rolling.why if push.rolling is not None else ""
    answer = known or open_answer(why or NEEDS_FRICTION, program)
    parts = np.flatnonzero(push.parts)
    if push.state != "falls":
        known_why = "" if why == ABOVE_EDGE else answer.why
        return replace(answer, bending=parts, why=known_why or why or NEEDS_FRICTION)
    motion = push.rolling.motion if push.rolling is not None else None
    if answer.state == "open":  # its path, if any, is no proof
        answer = replace(answer, decision=None)
    rolling = push.rolling if push.rough else None
    return replace(answer, state="balanced", rolling=rolling, motion=motion, moving=parts)
