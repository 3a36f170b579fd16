"""Solved limits of a carrier, for their derivatives.

An acceleration a of the carrier acts as the body force -a on each mass. So the limit along a
direction is a load factor, and the limit of the weakest horizontal direction is the least of many.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

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
from kilter.errors import InputError, some_names


class NamedLimit(Protocol):
    """The largest acceleration of a carrier along a direction."""

    @property
    def name(self) -> str:
        """Name of the direction."""

    @property
    def direction(self) -> Array:
        """Direction of the acceleration, unit, shape (3,)."""

    @property
    def g(self) -> float:
        """The limit [g]."""

    @property
    def least(self) -> bool:
        """Whether it is the weakest horizontal direction."""

    @property
    def limit(self) -> Limit:
        """Forces and motion at the limit."""


def carried_cases(known: KnownAssembly, limits: Sequence[NamedLimit], name: str) -> LimitCases:
    """The solved limit of a carrier along a named direction.

    Raises `InputError` if there is no finite limit of this name, or the assembly has bonds, straps
    or springs.
    """
    require_plain(known)
    named = {each.name: each for each in limits}
    if name not in named:
        raise InputError(
            f"the answer has no limit {name!r}",
            hint=f"name {some_names(list(named))}" if named else "ask no other question",
        )
    given, cases = named[name], None
    toward = -np.asarray(given.direction)
    if np.isfinite(given.g) and given.limit.motion is not None:
        if given.least:
            shared = SharedCones(known.program)
            cases = LeastDirection(known, shared, toward, given.g, 1.0).cases(name, given.g, "g")
        else:
            solved = body_force_limit(known, given.limit, toward)
            cases = LimitCases(name, given.g, "g", 1.0, (refined_case(solved),), False)
    if cases is None:
        raise InputError(f"the limit {name!r} is not finite", hint="request another limit")
    return cases
