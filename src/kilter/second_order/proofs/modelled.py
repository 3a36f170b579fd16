"""Contacts, bonds and loads that second order cannot model.

Open pairs and contacts that are not modelled may exert forces without a gap, so the answer is open.
Three kinds of possible contacts are exceptions:

The rim of a round flat face: its contact points are the corners of an inscribed polygon, and the
corners of a circumscribed polygon are possible contacts. The whole face lies in the plane of its
patch. So the inscribed polygon leaves the same motions neutral, forces at its corners are forces of
the face, and motions that keep or open the plane keep or open the face.

Edges and corners without a unique normal, as at a line in which four boxes meet (`sharp_points`).

Parts that overlap at a joint that moves: the joint states how they move against each other.

The force of a load acts at a point of its part. If that is not the centre of mass, the energy
curves as the part turns, by -F.(theta x (theta x arm)) / 2, even without a torque: a weight above
the centre, or two hands that press on both ends. It changes nothing to first order, and a vertical
force does not change the energy along level motions.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from kilter.arrays import Mask, counted
from kilter.assembly import Assembly
from kilter.contact.contact_set import ContactSet
from kilter.contact.open_pairs import still_open
from kilter.mechanics.program import Program
from kilter.mechanics.rows import CONTACT, OF_JOINTS, POSSIBLE
from kilter.second_order.motions.sharp_points import sharp_pushes
from kilter.second_order.parts.rigid_groups import RigidGroups
from kilter.second_order.second_order_tolerances import AGREE, KEEPS

__all__ = ["OFF_CENTRE", "loads_off_centre", "unmodelled_pairs", "why_beyond", "why_unmodelled"]

OFF_CENTRE = "second order does not model loads beside a centre of mass"


def unmodelled_pairs(assembly: Assembly, contacts: ContactSet) -> dict[frozenset[int], str]:
    """Pairs of parts with contacts that second order cannot model, each with the reason."""
    if not contacts.open_pairs and not len(contacts.possible):
        return {}
    sharp = sharp_pushes(contacts)
    jointed = RigidGroups.of(assembly).jointed_pairs(assembly)
    possible = _pairs(contacts)
    known = _on_rims(contacts) | _within_groups(assembly, contacts) | sharp
    pushed = {possible[k] for k in np.flatnonzero(sharp)}
    found = {}
    for pair in still_open(contacts.open_pairs, assembly):
        both = frozenset(pair.ends)
        overlaps = pair.kind == "overlap" and both in jointed
        if not (overlaps or (pair.kind == "degenerate" and both in pushed)):
            found[both] = "is open"
    for k in np.flatnonzero(~known):
        if possible[k] not in jointed:
            found.setdefault(possible[k], "is not modelled")
    return found


def why_unmodelled(
    assembly: Assembly, pairs: Mapping[frozenset[int], str], bodies: Mask | None = None
) -> str:
    """Reason why second order cannot model some bodies, with the first pair; empty if it can.

    Arguments: `bodies` (N,): first parts of the rigid groups that count; by default all.
    """
    first = RigidGroups.of(assembly).first
    mine = [
        (sorted(pair), why)
        for pair, why in pairs.items()
        if bodies is None or bodies[first[list(pair)]].any()
    ]
    if not mine:
        return ""
    (a, b), why = min(mine)
    more = f", and {len(mine) - 1} more" if len(mine) > 1 else ""
    return f"the contact of {assembly.names[a]} and {assembly.names[b]} {why}{more}"


def why_beyond(program: Program, assembly: Assembly) -> str:
    """Reason why second order cannot model a cluster's bonds, straps or loads; else empty."""
    strapped = bool(assembly.straps) and bool(program.clamp.any())
    if strapped or program.pull.any() or program.cohesion.any():
        return "second order does not model bonds and straps"
    if not np.isin(program.kind, (CONTACT, POSSIBLE, *OF_JOINTS)).all():
        return "second order does not model bonds and straps"
    if np.abs(program.applied[program.free, 3:]).max(initial=0.0) > 0:
        return OFF_CENTRE
    return ""


def loads_off_centre(assembly: Assembly, program: Program) -> tuple[Mask, Mask]:
    """Masks of parts with a load off their centre, and of those with an inclined one, (N,)."""
    off, slanted = np.zeros((2, len(program.names)), dtype=bool)
    groups, center = RigidGroups.of(assembly), assembly.geometry.center
    for load in assembly.loads:
        part = assembly.index_of(load.part)
        first = groups.first[part]
        arm = (center[part] if load.point is None else load.point) - program.center[first]
        if np.linalg.norm(arm) > KEEPS * program.radius[first] and load.force.any():
            off[first] = True
            aside = np.linalg.norm(np.cross(load.force, program.down))
            slanted[first] |= aside > KEEPS * np.linalg.norm(load.force)
    return off, slanted


def _pairs(contacts: ContactSet) -> list[frozenset[int]]:
    """The two parts of each possible contact."""
    both = zip(contacts.possible.part_a.tolist(), contacts.possible.part_b.tolist(), strict=True)
    return [frozenset(pair) for pair in both]


def _within_groups(assembly: Assembly, contacts: ContactSet) -> Mask:
    """Mask of possible contacts between parts of the same rigid group, shape (k,)."""
    first = RigidGroups.of(assembly).first
    within: Mask = first[contacts.possible.part_a] == first[contacts.possible.part_b]
    return within


def _on_rims(contacts: ContactSet) -> Mask:
    """Mask of possible contacts that lie in the plane of a flat patch of the same parts, (k,)."""
    possible, count = contacts.possible, len(contacts.assembly.parts)
    flat = np.flatnonzero(contacts.patch_kind == "plane")
    parts = contacts.patch_parts[flat]
    pair = parts[:, 0] * count + parts[:, 1]
    order = np.argsort(pair, kind="stable")
    flat, pair = flat[order], pair[order]
    wanted = possible.part_a * count + possible.part_b
    first, last = np.searchsorted(pair, wanted, "left"), np.searchsorted(pair, wanted, "right")
    row, place = counted(last - first)
    patch = flat[first[row] + place]
    normal = contacts.patch_normal[patch]
    agrees = np.einsum("ij,ij->i", normal, possible.normals[row]) > 1 - AGREE
    off = possible.points[row] - contacts.points[contacts.patch_start[patch]]
    near = np.abs(np.einsum("ij,ij->i", normal, off)) <= contacts.gap
    on = np.zeros(len(possible), dtype=bool)
    on[row[agrees & near]] = True
    return on & ~possible.two_sided
