"""The support of an item of a packing plan, and the reason why the pile falls under the item."""

from __future__ import annotations

import numpy as np
import shapely

from kilter.analysis.verdict.verdict import Verdict
from kilter.arrays import Index
from kilter.contact import ContactSet
from kilter.files.packing_lists import PackedBox, PackingPlan

__all__ = ["fall_reason", "item_support"]


def item_support(contacts: ContactSet, box: PackedBox, later: Index) -> SupportShares:
    """Parts below an item, and the share of its underside on each."""
    patches, below = _patches_under(contacts, box.name)
    before = ~np.isin(below, later)
    patches, below = patches[before], below[before]
    names = contacts.assembly.names
    area = np.bincount(below, contacts.patch_area[patches], minlength=len(names))
    share = area / (box.size[0] * box.size[1])
    parts = np.unique(below)
    order = parts[np.argsort(-share[parts], kind="stable")]
    return tuple((names[k], float(share[k])) for k in order.tolist())


SupportShares = tuple[tuple[str, float], ...]
"""Names of the parts below an item, and the share of its underside on each [-]."""


def _patches_under(contacts: ContactSet, name: str) -> tuple[Index, Index]:
    """Contact patches under a part, and the part below at each; both of shape (n,)."""
    k = contacts.assembly.index_of(name)
    upward = contacts.patch_normal[:, 2]
    is_above = (contacts.patch_parts[:, 1] == k) & (upward > FLAT)
    is_above_reversed = (contacts.patch_parts[:, 0] == k) & (-upward > FLAT)
    patches = np.flatnonzero(is_above | is_above_reversed)
    return patches, contacts.patch_parts[patches, np.where(is_above[patches], 0, 1)]


FLAT = 0.999
"""Least upward component of the normal of a contact under a box [-]."""


def fall_reason(plan: PackingPlan, first: int, verdict: Verdict) -> str:
    """The reason why the pile falls when an item is put down, as a clause."""
    box = plan.boxes[first]
    patches, _ = _patches_under(verdict.contact_set, box.name)
    points = verdict.contact_set.points[np.isin(verdict.contact_set.point_patch, patches), :2]
    center = np.array(box.corner[:2]) + np.array(box.size[:2]) / 2
    if not len(points):
        return f"nothing is under {box.name!r}"
    area = shapely.convex_hull(shapely.multipoints(points))
    beside = float(shapely.distance(area, shapely.points(center)))
    if beside > 0:
        return (
            f"the centre of {box.name!r} lies {beside:.3g} {plan.units} beside the area on which "
            "it rests"
        )
    tipped = _moving_below(box, verdict)
    if tipped:
        named = " and ".join(repr(name) for name in tipped[:2])
        return f"{box.name!r} tips {named}, on which it rests"
    return f"the pile falls under {box.name!r}"


def _moving_below(box: PackedBox, verdict: Verdict) -> list[str]:
    """Parts that lie under an item and move, the fastest first."""
    low, high = verdict.assembly.geometry.part_boxes
    k = verdict.assembly.index_of(box.name)
    overlap = np.minimum(high[:, :2], high[k, :2]) - np.maximum(low[:, :2], low[k, :2])
    top = box.corner[2] + ABOVE * box.size[2]
    under = (high[:, 2] <= top) & (overlap > 0).all(axis=1)
    names = {verdict.assembly.names[j] for j in np.flatnonzero(under).tolist()}
    return [name for name in verdict.moving if name in names]


ABOVE = 1e-3
"""Height above the underside of a box up to which the top of a box below it lies [heights]."""
