"""What the gap tolerance and a designed clearance close, in words.

A gap tolerance that falls inside a cluster of gaps parts what belongs together: then there
are patches in its upper third, and near pairs within three times of it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from kilter.arrays import Array
from kilter.contact.contact_set import Rejected
from kilter.contact.patches import Patches
from kilter.errors import some

if TYPE_CHECKING:
    from kilter.assembly import Assembly
    from kilter.contact.sharp.sharp_contacts import Touching

__all__ = ["CLUSTER", "closed_by_clearance", "tolerance_warnings"]


CLUSTER = 3.0
"""Gaps within this factor of the tolerance, on both sides, are one cluster."""


def tolerance_warnings(
    patches: Patches, rejected: list[Rejected], gap: Array, closed: Array
) -> list[str]:
    """A word where the tolerance cuts through gaps that belong together.

    Parameters
    ----------
    gap, closed : ndarray, shape (number of pairs,)
        Gap tolerance of each pair, and largest gap that counts as closed [length unit].
    """
    near = _nearest(patches)
    # a gap is held against the clearance, a penetration against the tolerance
    limit = np.where(near >= 0, closed[patches.pair], gap[patches.pair])
    below = int((np.abs(near) > limit / CLUSTER).sum())
    # of the kinds of limit, the one that the rejected piece fell to
    open_edge = CLUSTER * float(closed.max(initial=0.0))
    deep_edge = CLUSTER * float(gap.max(initial=0.0))
    above = sum(r.gap < open_edge for r in rejected if r.why.startswith("gap"))
    above += sum(-r.gap < deep_edge for r in rejected if r.why.startswith("penetrates"))
    if not (below and above):
        return []
    option = "--clearance" if (closed > gap).any() else "--gap"
    return [
        f"the gap tolerance falls inside a cluster of gaps: {below} patches just below it, "
        f"{above} near pairs just above; see the histogram and set {option}"
    ]


def closed_by_clearance(assembly: Assembly, touching: Touching, gap: Array) -> list[str]:
    """Which pairs stand apart, and touch because a clearance was closed."""
    patches = touching.patches
    apart = _nearest(patches)
    rows = np.flatnonzero(apart > gap[patches.pair])
    if not len(rows):
        return []
    widest: dict[tuple[int, int], float] = {}
    for row in rows[np.argsort(-apart[rows], kind="stable")]:
        a, b = touching.pairs[patches.pair[row]]
        widest.setdefault((int(a), int(b)), float(apart[row]))
    names, unit = assembly.names, assembly.units
    pairs = [f"{names[a]!r} and {names[b]!r} ({g:.3g} {unit})" for (a, b), g in widest.items()]
    return [
        f"clearances taken as closed in {len(rows)} patches, {len(pairs)} pairs that stand apart: "
        f"{some(pairs)}; the answer is that of parts moved together there"
    ]


def _nearest(patches: Patches) -> Array:
    """The gap nearest to zero over each patch; 0 where it changes sign."""
    if not len(patches.pair):
        return np.empty(0)
    low, high = patches.gap.T
    nearest: Array = np.where(low > 0, low, np.minimum(high, 0.0))
    return nearest
