"""The parts of a pose that rest by verification, with the verdicts that prove it.

The verification uses only the points of the search, and corners of parts on a floor, whose faces
may be too thin for the search. Parts that leave the scene or have no pose are left out. If parts
overlap, or if no forces balance them, they are left out too, and the others are verified again; the
contacts of the pose are detected once.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from kilter.analysis.check import check, check_equilibrium, check_level
from kilter.analysis.chosen_parts import chosen_parts
from kilter.analysis.settled_pose.near_points import NearPoints
from kilter.analysis.settled_pose.rest import RestResult
from kilter.analysis.settled_pose.rest_proof import (
    ClosedContacts,
    closed_contacts,
    closed_gap,
    strict_contacts,
)
from kilter.analysis.verdict.verdict import Verdict
from kilter.arrays import Mask, across
from kilter.assembly import Assembly
from kilter.assembly.question import Question
from kilter.contact import ContactSet, Tolerance, detect
from kilter.contact.common.polygons import convex_hull
from kilter.contact.friction_coefficients import friction_coefficients
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
    gap: float
    """Gap that counts as closed [length unit]."""
    closed_verdict: Verdict
    """Verdict on forces at the closed points alone; its level may be None."""
    verdict: Verdict
    """Verdict on the pose: on all detected contacts if the closed points alone do not reach the
    required level, else on the closed points."""
    unproved: tuple[str, ...]
    """Parts of the search that the verification left out."""
    why: str
    """Reason why they were left out, as a clause; empty without these parts."""


def parts_without_rest(rest: RestResult) -> Mask:
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
    if len(held) and aside[held].all():
        aside[held[0]] = False  # a verdict needs a held part
    return aside


def closed_parts(
    rest: RestResult, settled: Assembly, chosen: Mask, detected: ContactSet | None, asked: Question
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
    gap = closed_gap(sub)
    points = NearPoints.join([points, _corners_on_floors(sub, gap)])
    if detected is None:
        detected = strict_contacts(sub, gap, asked.progress)
    elif not chosen.all():
        detected = contacts_among(detected, sub)
    closed = closed_contacts(sub, points, detected=detected)
    return closed, detected


def _corners_on_floors(assembly: Assembly, gap: float) -> NearPoints:
    """The outermost corners of each part that lie on a floor within `gap` [length unit]."""
    geometry, down = assembly.geometry, assembly.down
    depth, plane = geometry.vertices @ down, np.stack(across(down), axis=1)
    blocks = []
    for floor in np.flatnonzero([part.table for part in assembly.parts]).tolist():
        top = float(depth[geometry.vertex_part == floor].min())
        near = (np.abs(depth - top) <= gap) & ~geometry.grounded[geometry.vertex_part]
        for part in np.unique(geometry.vertex_part[near]).tolist():
            rows = np.flatnonzero(near & (geometry.vertex_part == part))
            flat = geometry.vertices[rows] @ plane
            away = np.linalg.norm(convex_hull(flat)[:, None] - flat[None], axis=2)
            point = geometry.vertices[rows[away.argmin(axis=1)]]
            a, b = (np.full(len(point), k) for k in (part, floor))
            mu = friction_coefficients(assembly, np.column_stack([a, b]))
            height = top - point @ down
            block = NearPoints(a, b, point, np.tile(down, (len(a), 1)), height, mu, a >= 0)
            blocks.append(block)
    return NearPoints.join(blocks)


def verify_rest(rest: RestResult, settled: Assembly, asked: Question) -> RestingParts | str:
    """Verify the parts that rest in a pose; a clause with the reason if no free part rests.

    The verdicts only say that forces exist; `with_level` decides the level.
    """
    if rest.points is None:
        return rest.why
    bodies, free = rest.bodies, ~settled.geometry.grounded
    left, aside, detected = parts_without_rest(rest), held_aside(settled), None
    unproved: list[str] = []
    fault = ""
    while (free & ~left).any():
        closed, detected = closed_parts(rest, settled, ~left & ~aside, detected, asked)
        if closed.fault:
            names = [closed.assembly.names[k] for k in closed.overlapping]
            fault = fault or closed.fault
        else:
            verdict = check_equilibrium(closed.assembly, closed.contacts)
            if verdict.level is not None:
                return _resting(settled, ~left, closed, verdict, (tuple(unproved), fault))
            names, fault = verdict.moving or list(closed.assembly.names), fault or UNBALANCED
        more = np.zeros(len(bodies.mass), dtype=bool)
        more[[bodies.body_of(name) for name in names]] = True
        more[0] = False
        now = more[bodies.of_part] & ~left
        if not now.any():
            break
        unproved += [settled.names[k] for k in np.flatnonzero(now).tolist()]
        left |= now
    return f"the search ended at rest, but {fault}" if fault else rest.why


def _resting(
    settled: Assembly,
    chosen: Mask,
    closed: ClosedContacts,
    verdict: Verdict,
    left_out: tuple[tuple[str, ...], str],
) -> RestingParts:
    """The resting parts with all held parts, and their closed points."""
    assembly = settled if chosen.all() else chosen_parts(settled, np.flatnonzero(chosen), [])
    listed = replace(assembly, contacts=closed.assembly.contacts, detect=False)
    contacts = detect.without_neighbours(listed, listed.tolerance or Tolerance())
    gap = closed_gap(closed.assembly)
    closed = replace(closed, assembly=listed, contacts=contacts)
    return RestingParts(assembly, closed, gap, verdict, verdict, *left_out)


def with_level(resting: RestingParts, asked: Question) -> RestingParts:
    """The resting parts with their level, as far as the question requires it."""
    closed = resting.closed
    verdict = check_level(asked.but(assembly=closed.assembly, contacts=closed.contacts))
    after = verdict
    if not holds(verdict.level, asked.require):
        after = check(asked.but(assembly=resting.assembly, contacts=None))
    return replace(resting, closed_verdict=verdict, verdict=after)
