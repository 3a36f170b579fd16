"""Is every contact one whose gap second order knows, or part of one?

Pairs that are left open, and contacts that are not modelled, may hold or push by forces without a
gap: nothing is said then. The rim of a round flat face is none of them: it is a polygon within it
that counts as contact points, and the corners of one around it are what is possible. All of the
face lies in the plane of its patch, so that the polygon within leaves the same motions neutral,
forces at its corners are forces of the face, and what keeps or opens its plane keeps or opens it.
"""

from __future__ import annotations

import numpy as np

from kilter.arrays import Mask, counted
from kilter.assembly import Assembly
from kilter.contact.contact_set import ContactSet
from kilter.contact.open_pairs import still_open
from kilter.second_order.rigid_groups import RigidGroups
from kilter.second_order.second_order_tolerances import AGREE

__all__ = ["why_unmodelled"]


def why_unmodelled(assembly: Assembly, contacts: ContactSet) -> str:
    """Why second order says nothing of these contacts; empty where it may."""
    known = _on_rims(contacts) | _within_groups(assembly, contacts)
    if still_open(contacts.open_pairs, assembly) or not known.all():
        return "pairs are left open, or their kind of contact is not modelled"
    return ""


def _within_groups(assembly: Assembly, contacts: ContactSet) -> Mask:
    """Rows of what is possible between parts that fixed joints tie, shape (k,)."""
    first = RigidGroups.of(assembly).first
    within: Mask = first[contacts.possible.part_a] == first[contacts.possible.part_b]
    return within


def _on_rims(contacts: ContactSet) -> Mask:
    """Rows of what is possible that lie in the plane of a flat patch of their pair, shape (k,)."""
    possible, count = contacts.possible, len(contacts.assembly.parts)
    flat = np.flatnonzero(contacts.patch_kind == "plane")
    parts = contacts.patch_parts[flat]
    pair = parts[:, 0] * count + parts[:, 1]
    order = np.argsort(pair, kind="stable")
    flat, pair = flat[order], pair[order]
    asked = possible.part_a * count + possible.part_b
    first, last = np.searchsorted(pair, asked, "left"), np.searchsorted(pair, asked, "right")
    row, place = counted(last - first)
    patch = flat[first[row] + place]
    normal = contacts.patch_normal[patch]
    agrees = np.einsum("ij,ij->i", normal, possible.normals[row]) > 1 - AGREE
    off = possible.points[row] - contacts.points[contacts.patch_start[patch]]
    near = np.abs(np.einsum("ij,ij->i", normal, off)) <= contacts.gap
    on = np.zeros(len(possible), dtype=bool)
    on[row[agrees & near]] = True
    return on & ~possible.two_sided & (possible.degenerate < 0)
