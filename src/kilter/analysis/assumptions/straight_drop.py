"""Joined bodies that fall straight within their play, without a search.

On the rung "joined" bodies touch floors and held parts only. So a body without a support falls
straight down until it meets another body: this needs no search. A body whose way exceeds its play
falls. If forces hold the others where they land, their pose is at rest.

All bodies together tip over if no point that may reach the floor is below their common centre of
mass.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from kilter.analysis.assumptions.joined_bodies import beyond_feet, on_floor
from kilter.analysis.assumptions.joining import tables
from kilter.analysis.chosen_parts import chosen_parts
from kilter.analysis.planning.order.sweeps import Sweeps
from kilter.analysis.settled_pose.rigid_bodies import RigidBodies
from kilter.analysis.settled_pose.straight_falls import straight_falls
from kilter.arrays import Array, Index, Mask
from kilter.assembly import Assembly, Feature, GivenContact
from kilter.assembly.changed_copies import with_fields
from kilter.contact import ContactSet, detect

FLAT = Feature("face")
"""A flat face at a contact."""


@dataclass(frozen=True, slots=True, eq=False)
class Dropped:
    """Bodies after a straight fall."""

    bodies: RigidBodies
    """The bodies where they landed; those that are gone stay as drawn."""
    supported: Mask
    """Bodies that touch a floor or a held part as drawn, or are held, shape (B,)."""
    gone: Mask
    """Bodies that fall further than their play, shape (B,)."""

    @property
    def lands(self) -> Mask:
        """Bodies that fall within their play, shape (B,)."""
        mask: Mask = ~self.supported & ~self.gone
        return mask


def drop_straight(
    bodies: RigidBodies, contacts: ContactSet, play: Array, *, on_surfaces: bool = True
) -> Dropped | None:
    """Let all bodies without support fall straight at the same time, within their play.

    None if loads, bonds or joints other than fixed joints may hold a body.

    Arguments: `contacts`: those of the drawn pose; `play` (B,): play of each body [length unit]; a
    body above k contacts may move k times as far; `on_surfaces`: whether falls end on the exact
    curved surfaces. On their triangles a fall may be too long by the slack of both parts: only a
    longer one is certain.
    """
    assembly, count = bodies.drawn, len(bodies.mass)
    guided = any(joint.kind != "fixed" for joint in assembly.joints)
    if guided or assembly.loads or assembly.bonds or contacts.unexamined:
        return None
    if not on_surfaces:
        play = play + 2 * float(assembly.geometry.slack.max(initial=0.0))
    supported = ~bodies.moves
    supported[bodies.of_part[on_floor(assembly, contacts)]] = True
    group = np.where(supported, 0, np.cumsum(~supported))
    gone = np.zeros(count, dtype=bool)
    sweeps = Sweeps.of(contacts)
    for _ in range(count):
        among = np.where(gone, -1, group)[bodies.of_part]
        every = np.full(len(assembly), on_surfaces)
        fall, onto = straight_falls(sweeps, assembly, among, on_surfaces=every)
        fall = np.append(fall, np.full(count, np.inf))  # of the groups that are gone
        depth = _contacts_below(fall, onto)
        far = ~supported & ~gone & (fall[group] > play * depth[group])
        if not far.any():
            break
        gone |= far
    way = np.where(supported | gone, 0.0, fall[group])
    landed = replace(bodies, center=bodies.center + way[:, None] * assembly.down)
    return Dropped(landed, supported, gone)


def _contacts_below(fall: Array, onto: Index) -> Array:
    """Number of contacts of each group down to a held part, if supported bodies have one.

    Arguments: as `straight_falls` returns; `fall` may have more groups.
    """
    depth = np.ones(len(fall))
    for g in np.argsort(fall[: len(onto)], kind="stable").tolist():
        if onto[g] >= 0:
            depth[g] = depth[onto[g]] + 1
    return depth


def with_listed_contacts(dropped: Dropped, contacts: ContactSet) -> Assembly | None:
    """The assembly where its bodies landed, with its contacts between bodies as given contacts.

    These are the drawn contacts of the supported bodies with floors and held parts, and those of
    the landed bodies. None if bodies overlap there.
    """
    bodies, label = dropped.bodies, dropped.bodies.of_part
    assembly = bodies.assembly()
    found = _patches(contacts, (dropped.supported & ~dropped.gone)[label], label)
    landed = np.flatnonzero(~dropped.gone[label])
    if dropped.lands.any():
        still = np.flatnonzero(dropped.supported[label]).tolist()
        there = detect.contacts(chosen_parts(assembly, landed, still))
        if any(label[landed[o.ends[0]]] != label[landed[o.ends[1]]] for o in there.overlaps):
            return None
        found += _patches(there, np.ones(len(landed), dtype=bool), label[landed])
    return with_fields(assembly, contacts=found, detect=False)


def _patches(contacts: ContactSet, chosen: Mask, label: Index) -> list[GivenContact]:
    """Patches between different bodies of the chosen parts (N,), as given contacts.

    Flat faces on a floor, which has no edges, are flat there.
    """
    names, parts = contacts.assembly.names, contacts.patch_parts
    flat = (contacts.patch_kind == "plane") & tables(contacts.assembly)[parts].any(axis=1)
    kept = chosen[parts].all(axis=1) & (label[parts[:, 0]] != label[parts[:, 1]])
    rows = np.flatnonzero(kept[contacts.point_patch])
    patch = contacts.point_patch[rows]
    ends = zip(rows.tolist(), patch.tolist(), parts[patch].tolist(), strict=True)
    return [
        GivenContact(
            (names[a], names[b]), [contacts.points[row]], contacts.normals[row],
            mu=float(contacts.patch_mu[k]), feature=(FLAT, FLAT) if flat[k] else None,
        )
        for row, k, (a, b) in ends
    ]  # fmt: skip


def tips(dropped: Dropped, reach: float) -> bool:
    """Whether the bodies together tip over on the floor, whatever forces act between them.

    Arguments: `reach`: largest way of a part [length unit].
    """
    bodies = dropped.bodies
    there = (bodies.free & ~dropped.gone)[bodies.of_part]
    return beyond_feet(bodies.drawn, np.flatnonzero(there), reach)
