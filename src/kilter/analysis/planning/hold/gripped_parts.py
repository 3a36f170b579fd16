"""Parts of a large assembly whose grips hold it, from least wrenches of grips on all parts.

A cover of motions needs a judgement for nearly every candidate if no motion is proved, as for an
assembly whose open pairs might hold it. Instead, the conic program of
`kilter.analysis.decision.joining_wrenches` finds few grips whose wrenches complete the
equilibrium. Halves of these grips are left out as long as the others hold.
"""

from __future__ import annotations

import numpy as np

from kilter.analysis.decision.joining_wrenches import joining_wrenches
from kilter.analysis.planning.hold.supported import Supported
from kilter.analysis.smallest_set import irreducible_subset
from kilter.work import Work

__all__ = ["grips_that_hold"]

WRENCHES = (1e-2, 1e-4)
"""Grips with a wrench above this are tried, in multiples of the typical weight [-]. The second
value serves if the grips of the first do not hold.
"""
REDUCING = 0.25
"""Fraction of the remaining work after which no further grip is left out [-]."""


def grips_that_hold(given: Supported, work: Work, charge: float) -> frozenset[int] | None:
    """Grips that hold an assembly, none of which can be left out; None if none were found.

    The assembly does not hold without supports, and a judgement costs `charge` units of work. If a
    quarter of the work is spent, grips may be left that are not needed.
    """
    program, index = given.without_supports(), given.assembly.index
    held = np.flatnonzero(~program.free)
    grips = [k for k, support in enumerate(given.supports) if support.kind == "grip"]
    grips = [k for k in grips if program.free[index[given.supports[k].part]]]
    if not grips or not len(held):
        return None
    ends = np.array([[held[0], index[given.supports[k].part]] for k in grips])
    norms = joining_wrenches(program, ends, work=work)
    if norms is None:
        return None
    budget = work.fraction_left(REDUCING)

    def suffices(chosen: list[int]) -> bool:
        work.charge(charge)
        return given.judge(chosen, work).stable is True

    order = np.argsort(-norms, kind="stable")
    for least in WRENCHES:
        chosen = [grips[k] for k in order[norms[order] > least].tolist()]
        if chosen and suffices(chosen):
            return frozenset(irreducible_subset(chosen, suffices, lambda: budget.over))
    return None
