"""Precedence in a plan: pairs of parts of which the first must be inserted before the second."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from kilter.analysis.planning.order.removal import Screw
from kilter.analysis.planning.states.part_sets import bits_of
from kilter.assembly import Assembly
from kilter.errors import InputError, some_names

__all__ = ["later_parts", "precedence_pairs"]


def later_parts(assembly: Assembly, before: Iterable[tuple[str, str]]) -> list[int]:
    """For each part, the parts that must be inserted later by the given pairs, as a bit set."""
    later = [0] * len(assembly)
    for pair in before:
        if isinstance(pair, str) or len(pair) != 2:
            raise InputError(f"before has {pair!r:.60}", hint="give pairs of names")
        first, second = (sorted(assembly.matching(pattern)) for pattern in pair)
        for name in first:
            for other in second:
                if assembly[other].grounded and not assembly[name].grounded:
                    raise InputError(
                        f"{name!r} must come before {other!r}, which is held from the start",
                        hint="leave that pair out",
                    )
                later[assembly.index[name]] |= 1 << assembly.index[other]
    _require_no_circle(assembly, later)
    return later


def _require_no_circle(assembly: Assembly, later: list[int]) -> None:
    """Reject a precedence in which a part would have to come before itself."""
    left = bits_of(np.ones(len(later), dtype=bool))
    while True:
        last = [k for k in range(len(later)) if left >> k & 1 and not later[k] & left]
        if not last:
            break
        for k in last:
            left &= ~(1 << k)
    if left:
        names = [name for k, name in enumerate(assembly.names) if left >> k & 1]
        raise InputError(
            f"the precedence has a cycle: {some_names(names)}",
            hint="leave a pair out",
        )


def precedence_pairs(
    assembly: Assembly, later: list[int], screws: Sequence[Screw]
) -> tuple[tuple[str, str], ...]:
    """Required precedence as pairs of names; the bolt of each screw comes before its nut."""
    names = assembly.names
    asked = [
        (names[k], names[other])
        for k in range(len(names))
        for other in range(len(names))
        if later[k] >> other & 1
    ]
    return (*asked, *((names[screw.bolt], names[screw.nut]) for screw in screws))
