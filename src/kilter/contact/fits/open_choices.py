"""Decisions of a user about pairs of parts: joined, touching or apart.

joined     a fixed joint, whether or not the parts touch
touching   the contacts of the nearest faces, as if the gap and the angle were tolerated
apart      no contact: a given contact without points
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from kilter.assembly import Assembly, GivenContact, Joint
from kilter.contact import detect
from kilter.contact.common.gaps import Tolerance
from kilter.contact.contact_set import ContactSet
from kilter.contact.contact_tolerances import DECIDED, LOOKED_AT_ANGLE, LOOSE_ANGLE
from kilter.errors import InputError

__all__ = ["with_decided_pairs"]


def with_decided_pairs(
    assembly: Assembly,
    decisions: Iterable[Mapping[str, Any]],
    *,
    tolerance: Tolerance | None = None,
) -> Assembly:
    """The assembly with the user's decisions on pairs of parts: joined, touching or apart.

    Raises `InputError` if a part does not exist, or no faces of a pair that is said to touch come
    near.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> tower = scene("tower")
    >>> apart = with_decided_pairs(tower, [{"parts": ["cube-1", "cube-2"], "as": "apart"}])
    >>> len(detect.contacts(tower)) - len(detect.contacts(apart))
    1
    """
    tolerance = tolerance or assembly.tolerance or Tolerance()
    joints: list[Joint] = []
    contacts: list[GivenContact] = []
    for decision in decisions:
        first, second = decision["parts"]
        assembly.index_of(first), assembly.index_of(second)
        if decision["as"] == "joined":
            joints.append(Joint((first, second)))
        elif decision["as"] == "apart":
            contacts.append(GivenContact((first, second), [], [0, 0, 1]))
        else:
            contacts += _touching(assembly, (first, second), tolerance)
    decided = {frozenset(contact.parts) for contact in contacts}
    others = [c for c in assembly.contacts if frozenset(c.parts) not in decided]
    return replace(assembly, joints=[*assembly.joints, *joints], contacts=[*others, *contacts])


def _touching(
    assembly: Assembly, pair: tuple[str, str], tolerance: Tolerance
) -> list[GivenContact]:
    """Contacts between the nearest faces of two parts; empty if detection finds some already."""
    free = [replace(assembly[name], grounded=False) for name in pair]
    two = Assembly(free, units=assembly.units, gravity=assembly.gravity)
    if len(detect.contacts(two, tolerance=tolerance)):
        return []
    for gap, angle in _nearest(detect.contacts(two, tolerance=Tolerance.loose())):
        wide = replace(
            tolerance, gap=gap * DECIDED, clearance=gap * DECIDED, angle=max(tolerance.angle, angle)
        )
        contacts = detect.contacts(two, tolerance=wide)
        if len(contacts):
            return _given(contacts)
    raise InputError(
        f"no faces of {pair[0]!r} and {pair[1]!r} come near enough to touch",
        file=assembly.source or None,
        hint="decide that the pair is joined or apart",
    )


def _nearest(contacts: ContactSet) -> list[tuple[float, float]]:
    """Gaps [length unit] and angles [rad] between near faces of two parts, the closest first."""
    touching = [(float(np.abs(gap).max()), LOOSE_ANGLE) for gap in contacts.patch_gap]
    near = [(abs(pair.gap), min(pair.angle * DECIDED, LOOKED_AT_ANGLE)) for pair in contacts.near]
    deep = [(o.depth, 0.0) for o in contacts.overlaps if o.depth is not None]
    return [(gap, angle) for gap, angle in [*touching, *near, *deep] if gap > 0]


def _given(contacts: ContactSet) -> list[GivenContact]:
    """Convert detected patches to given contacts; a curved patch gives one for each point."""
    names, given = contacts.assembly.names, []
    for k, (low, high) in enumerate(
        zip(contacts.patch_start[:-1].tolist(), contacts.patch_start[1:].tolist(), strict=True)
    ):
        parts = (names[contacts.patch_parts[k, 0]], names[contacts.patch_parts[k, 1]])
        points, normals = contacts.points[low:high], contacts.normals[low:high]
        if np.ptp(normals, axis=0).any():
            given += [GivenContact(parts, x[None], n) for x, n in zip(points, normals, strict=True)]
        else:
            given.append(GivenContact(parts, points, normals[0]))
    return given
