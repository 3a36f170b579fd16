"""Reduction of a set that suffices to a subset from which no member can be left out, by halves.

First the second half is reduced with the whole first half in the base. Then the first half is
reduced with the rest of the second. This needs few tests if few members are needed, and keeps the
first members if it can.

References
----------
U. Junker, QuickXplain: preferred explanations and relaxations for over-constrained problems, 2004.
"""

from __future__ import annotations

from collections.abc import Callable

__all__ = ["irreducible_subset"]


def irreducible_subset(
    candidates: list[int], suffices: Callable[[list[int]], bool], ended: Callable[[], bool]
) -> list[int]:
    """Reduce a sufficient set to a sufficient subset of which no member can be left out.

    Parameters
    ----------
    candidates : list of int
        The set. The empty set does not suffice.
    suffices : callable
        Whether a set suffices. Every superset of a set that suffices must suffice.
    ended : callable
        Whether no further set may be tested: then members may be left that are not needed.

    Examples
    --------
    >>> irreducible_subset(list(range(9)), lambda chosen: {2, 5} <= set(chosen), lambda: False)
    [2, 5]
    >>> irreducible_subset([4, 7], lambda chosen: bool(chosen), lambda: True)
    [4, 7]
    """

    def reduced(base: list[int], members: list[int], base_changed: bool) -> list[int]:
        """Members needed beside `base`; an unchanged `base` was found insufficient before."""
        if ended():
            return members
        if base_changed and suffices(base):
            return []
        if len(members) == 1:
            return members
        half = (len(members) + 1) // 2
        first, second = members[:half], members[half:]
        later = reduced([*base, *first], second, bool(first))
        return reduced([*base, *later], first, bool(later)) + later

    return reduced([], candidates, False)
