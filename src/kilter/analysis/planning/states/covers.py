"""Smallest sets of supports that may stop every known motion of an assembly.

A motion y gains the power p while nothing of some supports P stops it, P present. Of any other
support c let a_c be 1 where it may stop y, and of a vacuum or magnet that y pulls off, opening by
u, its share F u / p. A set of supports holds no more than P and those of its members:

    sum of a_c over the set  <  1   =>   y goes on: it does not hold

So the fewest supports that hold are no fewer than those of the least set whose shares reach 1 for
every motion.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

__all__ = ["Shares", "least_cover"]

Shares = Mapping[int, float]
"""For each support, by number, the share of a motion's power that it can take, up to 1."""
ENOUGH = 1 - 1e-3
"""Sum of shares from which supports may stop a motion; the remaining power proves nothing [-]."""


def least_cover(motions: Sequence[Shares], most: int) -> frozenset[int] | None:
    """A smallest set of supports that may stop every given motion; None if more than `most`.

    Parameters
    ----------
    motions : sequence of mappings
    most : int
        Supports it may have; None where more are needed, or all together are not enough.

    Examples
    --------
    >>> sorted(least_cover([{0: 1.0, 1: 1.0}, {1: 1.0, 2: 1.0}], 2))
    [1]
    >>> sorted(least_cover([{k: 0.4 for k in range(5)}], 5))
    [0, 1, 2]
    >>> least_cover([{k: 0.4 for k in range(5)}], 2) is None, least_cover([{}], 3) is None
    (True, True)
    """
    for size in range(most + 1):
        cover = _cover(motions, size, frozenset(), frozenset())
        if cover is not None:
            return cover
    return None


def _cover(
    motions: Sequence[Shares], size: int, chosen: frozenset[int], barred: frozenset[int]
) -> frozenset[int] | None:
    """Add at most `size` supports outside `barred` to the chosen ones, so that every motion stops.

    None if that is impossible.
    """
    left = [(motion, sum(motion.get(k, 0.0) for k in sorted(chosen))) for motion in motions]
    left = [(motion, share) for motion, share in left if share < ENOUGH]
    if not left:
        return chosen
    branches = []
    for motion, share in left:
        open_to = sorted((-a, k) for k, a in motion.items() if k not in barred and k not in chosen)
        if share - sum(a for a, _ in open_to[:size]) < ENOUGH:
            return None
        branches.append([k for _, k in open_to])
    closed = barred
    for member in min(branches, key=lambda motion: (len(motion), motion)):
        cover = _cover(motions, size - 1, chosen | {member}, closed)
        if cover is not None:
            return cover
        closed = closed | {member}
    return None
