"""Solved limits of a carrier, for their derivatives.

An acceleration a of the carrier acts as the body force -a on each mass. So the limit along a
direction is a load factor, and the limit of the weakest horizontal direction is the least of many.
"""

from __future__ import annotations

import numpy as np

from kilter.analysis.gradients.limit_case import LimitCases, refined_case
from kilter.analysis.load_limit import Limit, SharedCones
from kilter.analysis.margins.solved_limits import (
    KnownAssembly,
    LeastDirection,
    body_force_limit,
    require_plain,
)
from kilter.arrays import Array
from kilter.errors import InputError


def carried_cases(
    known: KnownAssembly, name: str, limit: Limit, direction: Array, g: float, *, least: bool
) -> LimitCases:
    """The solved limit `g` [g] of a carrier along a direction, unit, shape (3,).

    Arguments: `least`: whether it is the limit of the weakest horizontal direction. Raises
    `InputError` if the limit is not finite, or the assembly has bonds, straps or springs.
    """
    require_plain(known.program)
    cases = None
    if np.isfinite(g) and limit.motion is not None:
        if least:
            shared = SharedCones(known.program)
            cases = LeastDirection(known, shared, -direction, g, 1.0).cases(name, g, "g")
        else:
            solved = body_force_limit(known, limit, -direction)
            cases = LimitCases(name, g, "g", 1.0, (refined_case(solved),), False)
    if cases is None:
        raise InputError(f"the limit {name!r} is not finite", hint="request another limit")
    return cases
