"""Length of a step of parts on springs, by the work of their imbalance along the step.

The work falls from its value at the start to 0 at the minimum of the energy. A bracket of its sign
change is kept, and the next length is the zero of the chord through its ends (regula falsi).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

LEFT, SEARCHED, EDGE = 0.2, 8, 0.1
"""The work of the imbalance falls to the first fraction; largest number of lengths that are tried;
least distance of a length from the ends of the bracket, as a fraction of the bracket."""

State = TypeVar("State")


def search_step_length(
    trial: Callable[[float], tuple[State, float, bool]], work_at_start: float
) -> State:
    """State after a step of suitable length; the whole step is tried first.

    Arguments: `trial`: from a fraction of the step to the state there, the work of its imbalance
    along the step, and whether that state is good enough for any work.
    """
    low, high = (0.0, work_at_start), (1.0, 0.0)
    limit, part = LEFT * work_at_start, 1.0
    for _ in range(SEARCHED):
        state, gain, enough = trial(part)
        if enough or (gain >= -limit and (part == 1.0 or gain <= limit)):
            break
        if gain > 0:
            low = (part, gain)
        else:
            high = (part, gain)
        interpolated = low[0] + (high[0] - low[0]) * low[1] / (low[1] - high[1])
        edge = EDGE * (high[0] - low[0])
        part = min(max(interpolated, low[0] + edge), high[0] - edge)
    return state
