"""The parts of a pose that rest by verification, with the verdicts that prove it.

The verification uses only the points of the search. Parts that leave the scene or have no pose are
left out. If parts overlap, or if no forces balance them, they are left out too, and the others are
verified again; the contacts of the pose are detected once.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from kilter.analysis.check import check, check_level
from kilter.analysis.chosen_parts import chosen_parts
from kilter.analysis.settled_pose.rest import Rest
from kilter.analysis.settled_pose.rest_proof import (
    ClosedContacts,
    closed_contacts,
    closed_gap,
    strict_contacts,
)
from kilter.analysis.verdict.verdict import Verdict
from kilter.arrays import Mask
from kilter.assembly import Assembly
from kilter.assembly.question import Question
from kilter.contact import ContactSet
from kilter.contact.kept_contacts import contacts_among
from kilter.tell.levels import holds

UNBALANCED = (
    "no forces at the points that the geometry shows closed are proved to balance the parts"
)


@dataclass(frozen=True, slots=True, eq=False)
class RestingParts:
    """The held parts and the parts that rest, with the proof."""

    assembly: Assembly
    """These parts in the pose."""
    closed: ClosedContacts
    """Their contacts at closed points."""
    closed_verdict: Verdict
    """Verdict on forces at the closed points alone; its level may be None."""
    verdict: Verdict
    """Verdict on the pose: on all detected contacts if the closed points alone do not reach the
    required level, else on the closed points."""
    unproved: tuple[str, ...]
    """Parts of the search that the verification left out."""
    why: str
    """Reason why they were left out, as a clause; empty without these parts."""


def parts_without_rest(rest: Rest) -> Mask:
    """Free parts that leave the scene or have no pose, with the parts of their bodies; (N,)."""
    bodies = rest.bodies
    gone = np.zeros(len(bodies.mass), dtype=bool)
    gone[[bodies.body_of(name) for name in (*rest.leaves, *rest.parts)]] = True
    gone[0] = False
    mask: Mask = gone[bodies.of_part]
    return mask


def held_aside(assembly: Assembly) -> Mask:
    """Held parts whose boxes lie apart from those of all free parts, so that none touches; (N,)."""
    geometry = assembly.geometry
    start, room = geometry.vertex_start[:-1], (geometry.slack + 1e-3 * geometry.size)[:, None]
    low = np.minimum.reduceat(geometry.vertices, start) - room
    high = np.maximum.reduceat(geometry.vertices, start) + room
    free, held = np.flatnonzero(~geometry.grounded), np.flatnonzero(geometry.grounded)
    apart = (low[held, None] > high[None, free]) | (high[held, None] < low[None, free])
    aside = np.zeros(len(geometry.grounded), dtype=bool)
    aside[held] = np.asarray(apart.any(axis=2)).all(axis=1)
    linked = [name for joint in assembly.joints for name in joint.parts]
    linked += [name for bond in assembly.bonds for name in bond.parts]
    aside[[assembly.index[name] for name in linked if name in assembly.index]] = False
    return aside


def closed_parts(
    rest: Rest, settled: Assembly, chosen: Mask, detected: ContactSet | None, asked: Question
) -> tuple[ClosedContacts, ContactSet]:
    """The closed contacts among some parts of a pose, and the contacts detected for them.

    Arguments: `settled`: the assembly in the pose; `chosen` (N,): the parts; `detected`: contacts
    of the pose, of these parts or more; None: they are detected.
    """
    assert rest.points is not None
    points = rest.points
    sub = settled if chosen.all() else chosen_parts(settled, np.flatnonzero(chosen), [])
    rank = np.cumsum(chosen) - 1
    points = points.take(chosen[points.part_a] & chosen[points.part_b])
    points = replace(points, part_a=rank[points.part_a], part_b=rank[points.part_b])
    if detected is None:
        detected = strict_contacts(sub, closed_gap(sub), asked.progress)
    elif not chosen.all():
        detected = contacts_among(detected, sub)
    closed = closed_contacts(sub, points, detected=detected)
    return closed, detected


def verify_rest(rest: Rest, settled: Assembly, asked: Question) -> RestingParts | str:
    """Verify the parts that rest in a pose; a clause with the reason if no free part rests."""
    if rest.points is None:
        return rest.why
    bodies, free = rest.bodies, ~settled.geometry.grounded
    left, detected, why = parts_without_rest(rest), None, rest.why
    left |= held_aside(settled)
    unproved: list[str] = []
    fault = ""
    while (free & ~left).any():
        closed, detected = closed_parts(rest, settled, ~left, detected, asked)
        sub = closed.assembly
        if closed.fault:
            names, fault = [sub.names[k] for k in closed.overlapping], fault or closed.fault
        else:
            verdict = check_level(asked.but(assembly=sub, contacts=closed.contacts))
            if verdict.level is not None:
                return _resting(closed, verdict, unproved, fault, asked)
            names, fault = verdict.moving or list(sub.names), fault or UNBALANCED
        more = np.zeros(len(bodies.mass), dtype=bool)
        more[[bodies.body_of(name) for name in names]] = True
        more[0] = False
        now = more[bodies.of_part] & ~left
        if not now.any():
            break
        unproved += [settled.names[k] for k in np.flatnonzero(now).tolist()]
        left |= now
    return f"the search ended at rest, but {fault}" if fault else why


def _resting(
    closed: ClosedContacts, verdict: Verdict, unproved: list[str], fault: str, asked: Question
) -> RestingParts:
    """The resting parts with the verdict on the pose."""
    assembly = replace(closed.assembly, contacts=(), detect=True)
    after = verdict
    if not holds(verdict.level, asked.require):
        after = check(asked.but(assembly=assembly, contacts=None))
    return RestingParts(assembly, closed, verdict, after, tuple(unproved), fault)
