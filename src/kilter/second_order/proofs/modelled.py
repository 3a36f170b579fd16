"""What second order says nothing of: contacts, joints, bonds and loads that it has no form of.

Pairs that are left open, and contacts that are not modelled, may hold or push by forces without a
gap: nothing is said then. Two kinds of what is possible are none of them:

The rim of a round flat face: it is a polygon within it that counts as contact points, and the
corners of one around it are what is possible. All of the face lies in the plane of its patch, so
that the polygon within leaves the same motions neutral, forces at its corners are forces of the
face, and what keeps or opens its plane keeps or opens it.

Edges and corners that have no one normal, as where four boxes meet in a line (`sharp_points`).

The force of a load acts at a point of its part. Where that is not the centre of mass, the energy
curves as the part turns, by -F.(theta x (theta x arm)) / 2, even where there is no torque: a weight
above the centre, or two hands that press on both ends. To first order nothing changes; nor does
the energy along level motions, where the force is vertical.
"""

from __future__ import annotations

import numpy as np

from kilter.arrays import Mask, counted
from kilter.assembly import Assembly
from kilter.contact.contact_set import ContactSet
from kilter.contact.open_pairs import still_open
from kilter.mechanics.program import Program
from kilter.mechanics.rows import CONTACT, POSSIBLE
from kilter.second_order.motions.sharp_points import sharp_pushes
from kilter.second_order.parts.rigid_groups import RigidGroups
from kilter.second_order.second_order_tolerances import AGREE, KEEPS

__all__ = ["OFF_CENTRE", "loads_off_centre", "why_beyond", "why_unmodelled"]

OFF_CENTRE = "loads beside a centre of mass are not looked at in second order"


def why_unmodelled(assembly: Assembly, contacts: ContactSet) -> str:
    """Why second order says nothing of these contacts; empty where it may."""
    sharp = sharp_pushes(contacts)
    known = _on_rims(contacts) | _within_groups(assembly, contacts) | sharp
    ends = np.column_stack([contacts.possible.part_a, contacts.possible.part_b])[sharp]
    pushed = {frozenset(pair) for pair in ends.tolist()}
    left = still_open(contacts.open_pairs, assembly)
    settled = all(one.kind == "degenerate" and frozenset(one.parts) in pushed for one in left)
    if not settled or not known.all():
        return "pairs are left open, or their kind of contact is not modelled"
    return ""


def why_beyond(program: Program) -> str:
    """Why nothing is said of a cluster, whatever its contacts; empty where something may be."""
    if not np.isin(program.kind, (CONTACT, POSSIBLE)).all():
        return "joints are not looked at in second order"
    if program.has_strength:
        return "bonds are not looked at in second order"
    if np.abs(program.applied[program.free, 3:]).max(initial=0.0) > 0:
        return OFF_CENTRE
    return ""


def loads_off_centre(assembly: Assembly, program: Program) -> tuple[Mask, Mask]:
    """Parts with a load off their centre of mass, and with one that is not vertical, (N,) each.

    Parameters
    ----------
    program : Program
        Of this assembly, its groups merged.
    """
    off, slanted = np.zeros((2, len(program.names)), dtype=bool)
    groups, center = RigidGroups.of(assembly), assembly.geometry.center
    for load in assembly.loads:
        part = assembly.index_of(load.part)
        own = groups.first[part]
        arm = (center[part] if load.point is None else load.point) - program.center[own]
        if np.linalg.norm(arm) > KEEPS * program.radius[own] and load.force.any():
            off[own] = True
            aside = np.linalg.norm(np.cross(load.force, program.down))
            slanted[own] |= aside > KEEPS * np.linalg.norm(load.force)
    return off, slanted


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
    return on & ~possible.two_sided
