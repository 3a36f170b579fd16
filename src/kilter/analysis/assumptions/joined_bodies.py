"""Bodies of the rung "joined": their support, the tilt at which they tip, their fall if loose.

A body that stands on a floor tips over an edge of its support polygon, the convex hull of its
contact points with the floor. The plane through the edge and the centre of mass makes an angle
with gravity, whose least value over all edges is the tilt. On a level floor it is

    tilt = min over the edges of  atan(b / h)

with b the horizontal distance of the centre of mass from the edge, and h its height.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely

from kilter.analysis.analysis_tolerances import ALONG
from kilter.analysis.assumptions.joining import adjoining, body_labels, tables
from kilter.analysis.assumptions.tipping_over import rest_after_tipping
from kilter.analysis.planning.order.sweeps import Sweeps
from kilter.analysis.settled_pose.straight_falls import (
    StraightFall,
    falling_distance,
    touching_gap,
)
from kilter.arrays import Array, Index, Mask, across, cross, members_by_label, unit_rows
from kilter.assembly import Assembly
from kilter.assembly.assumption import Body
from kilter.assembly.geometry import Geometry
from kilter.assembly.part import GROUND
from kilter.contact import ContactSet
from kilter.contact.common.distances import MOST_PARTS, PartSolids, nearest_to_group
from kilter.contact.common.polygons import convex_hull


def bodies_of(assembly: Assembly, contacts: ContactSet) -> tuple[Body, ...]:
    """The bodies of an assembly in which parts that touch or overlap are joined.

    Floors, and groups of parts that are all held, are no bodies. Of more than `MOST_PARTS` loose
    bodies, the later ones have neither a nearest part nor a fall.

    Arguments: `contacts`: those of the assembly. Returns bodies on a floor or held first, then by
    mass.
    """
    loose = _LooseBodies(assembly, contacts)
    groups = body_groups(assembly, contacts)
    carried = on_floor(assembly, contacts)
    mass = assembly.geometry.mass
    groups.sort(key=lambda group: (not carried[group].any(), -mass[group].sum()))
    standing = [group for group in groups if carried[group].any()]
    bodies = [
        _body(assembly, group, on_floor=True, **_tilt_keys(assembly, contacts, group))
        for group in standing
    ]
    hanging = groups[len(standing) :]
    falls = loose.falls(hanging[:MOST_PARTS])
    for number, group in enumerate(hanging):
        found = loose.found(group, falls[number]) if number < MOST_PARTS else {}
        bodies.append(_body(assembly, group, on_floor=False, **found))
    return tuple(bodies)


def _tilt_keys(assembly: Assembly, contacts: ContactSet, group: Index) -> dict[str, Any]:
    """The keys of a body on a floor about its tilt, and about its rest if it tips over.

    Bodies beside each other do not touch, so each stands or tips over by itself.
    """
    limit = tipping(assembly, contacts, group)
    if limit is None and not beyond_feet(assembly, group, 0.0):
        return {}
    angle, over = limit or (0.0, assembly.down)
    found: dict[str, Any] = {"tilt_deg": float(np.degrees(angle)), "tilt_down": over}
    return found if angle else found | _rest_keys(assembly, group)


def _rest_keys(assembly: Assembly, group: Index) -> dict[str, Any]:
    """The keys about the rest of a body that tips over on a level floor; none if it stands."""
    geometry = assembly.geometry
    rows = np.flatnonzero(np.isin(geometry.vertex_part, group))
    center = _common_center(geometry, group)
    slack = float(geometry.slack[group].max())
    rest = rest_after_tipping(geometry.vertices[rows], center, assembly.down, slack)
    if rest is None or rest[0] <= 0.0:
        return {}
    feet = np.unique(geometry.vertex_part[rows[rest[1]]])
    return {
        "rest_deg": float(np.degrees(rest[0])),
        "rests_on": tuple(assembly.names[k] for k in feet.tolist()),
    }


def _common_center(geometry: Geometry, parts: Index) -> Array:
    """Common centre of mass of parts (n,), shape (3,) [length unit]."""
    center: Array = geometry.mass[parts] @ geometry.center[parts] / geometry.mass[parts].sum()
    return center


def beyond_feet(assembly: Assembly, parts: Index, reach: float) -> bool:
    """Whether parts together tip over on their floor, whatever forces act between them.

    Their common centre of mass is then not above any of their points that may reach the floor.

    Arguments: `parts` (n,): the free parts that do not fall; `reach`: largest way of a part [length
    unit]. False if a part is held by name, or joined to the ground.
    """
    geometry, down = assembly.geometry, assembly.down
    held = geometry.grounded & ~tables(assembly)
    if held.any() or any(GROUND in joint.parts for joint in assembly.joints) or not len(parts):
        return False
    points = geometry.vertices[np.isin(geometry.vertex_part, parts)]
    depth, plane = points @ down, np.stack(across(down), axis=1)
    room = reach + 2 * float(geometry.slack.max())
    hull = shapely.convex_hull(shapely.multipoints(points[depth >= depth.max() - room] @ plane))
    center = _common_center(geometry, parts)
    return bool(shapely.distance(hull, shapely.points(center @ plane)) > 2 * room)


def body_groups(assembly: Assembly, contacts: ContactSet) -> list[Index]:
    """Parts of each body that has a free part; floors belong to no body."""
    label = np.where(tables(assembly), -1, body_labels(assembly, contacts))
    held = assembly.geometry.grounded
    return [group for group in members_by_label(label) if not held[group].all()]


def on_floor(assembly: Assembly, contacts: ContactSet) -> Mask:
    """Mask of the parts that are held, are joined to the ground, or touch a floor, shape (N,)."""
    carried = assembly.geometry.grounded.copy()
    pairs = adjoining(assembly, contacts)
    carried[pairs[tables(assembly)[pairs].any(axis=1)]] = True
    joined = [name for joint in assembly.joints if GROUND in joint.parts for name in joint.parts]
    carried[[assembly.index[name] for name in joined if name != GROUND]] = True
    return carried


def tipping(assembly: Assembly, contacts: ContactSet, group: Index) -> tuple[float, Array] | None:
    """Tilt at which a body tips over [rad], and the direction of gravity at this tilt, shape (3,).

    The tilt is 0 if the centre of mass is not above the inside of the support polygon. None if the
    body is held, if it touches a floor in a way that is not modelled, or if its contacts with
    floors have several normals.

    Arguments: `group` (n,): parts of the body.
    """
    table, down = tables(assembly), assembly.down
    pairs = adjoining(assembly, contacts)
    floors = {(a, b) for a, b in pairs[table[pairs].any(axis=1)].tolist() if {a, b} & {*group}}
    modelled = {(min(a, b), max(a, b)) for a, b in contacts.patch_parts.tolist()}
    fixed = {name for joint in assembly.joints if GROUND in joint.parts for name in joint.parts}
    names = {assembly.names[k] for k in group.tolist()}
    if assembly.geometry.grounded[group].any() or fixed & names or not floors <= modelled:
        return None
    below, above = contacts.patch_parts.T
    turned = table[above]
    below, above = np.where(turned, above, below), np.where(turned, below, above)
    chosen = table[below] & np.isin(above, group)
    normals = np.where(turned, -1.0, 1.0)[chosen, None] * contacts.patch_normal[chosen]
    if not chosen.any() or (np.linalg.norm(normals - normals[0], axis=1) > ALONG).any():
        return None
    geometry = assembly.geometry
    center = _common_center(geometry, group)
    feet = contacts.points[chosen[contacts.point_patch]] - center
    return _tilt_of_polygon(feet, normals[0], down) if normals[0] @ down < 0 else None


def _tilt_of_polygon(feet: Array, up: Array, down: Array) -> tuple[float, Array]:
    """Tilt [rad] to the nearest edge of the support polygon, and gravity there; else 0.

    Arguments: `feet` (n, 3): contact points relative to the centre of mass [length unit].
    """
    flat = feet @ np.stack(across(up), axis=1)
    corners = convex_hull(flat)
    if len(corners) < 3:
        return 0.0, down
    nearest = np.linalg.norm(corners[:, None] - flat[None], axis=2).argmin(axis=1)
    first = feet[nearest]
    inward = unit_rows(cross(np.roll(first, -1, axis=0), first))
    sine = inward @ down
    edge = int(sine.argmin())
    if sine[edge] <= 0.0:
        return 0.0, down
    over = down - sine[edge] * inward[edge]
    return float(np.arcsin(min(sine[edge], 1.0))), over / np.linalg.norm(over)


class _LooseBodies:
    """Search for the nearest part, and for the fall, of each loose body of an assembly."""

    def __init__(self, assembly: Assembly, contacts: ContactSet) -> None:
        self._assembly = assembly
        self._contacts = contacts
        self._tables = tables(assembly)
        self._sweeps = Sweeps.of(contacts)
        self._solids = PartSolids(assembly.geometry)
        self._boxes = assembly.geometry.part_boxes
        self._known = {neighbour.part: neighbour for neighbour in contacts.neighbours}
        self._on_surfaces: dict[frozenset[int], float] = {}
        for pair in contacts.near:  # the nearest first
            self._on_surfaces.setdefault(frozenset(pair.ends), pair.gap)

    def falls(self, groups: list[Index]) -> list[StraightFall | None]:
        """The fall of each loose body.

        Bodies may lie within each other, as a shaft in its bearing: each falls onto the other. They
        fall together then, and the body that meets a part of another body first has this fall.
        """
        owner = np.full(len(self._assembly.parts), -1)
        for number, group in enumerate(groups):
            owner[group] = number
        falls = [self._fall(group) for group in groups]
        cluster, lowest = np.arange(len(groups)), list(falls)
        while circle := _circle([_of(cluster, owner, fall) for fall in lowest]):
            together = np.isin(cluster, circle)
            cluster[together] = circle[0]
            fall = self._fall(np.flatnonzero(np.isin(owner, np.flatnonzero(together))))
            for number in circle:
                lowest[number] = None
            lowest[circle[0]] = fall
            if fall is not None:
                falls[owner[fall.part]] = fall
        return falls

    def _fall(self, group: Index) -> StraightFall | None:
        """The straight fall of parts that move together."""
        return falling_distance(self._assembly, self._sweeps, group, self._assembly.down)

    def found(self, group: Index, fall: StraightFall | None) -> dict[str, Any]:
        """The keys of a loose body about its nearest part, its fall, and its rest on a floor.

        A fall within the gap of parts that touch has the length 0.
        """
        names = self._assembly.names
        if len(group) == len(names):
            return {}
        near = self._known.get(int(group[0])) if len(group) == 1 else None
        if near is None:
            near = nearest_to_group(self._solids, group, self._boxes)
        exact = self._on_surfaces.get(frozenset((near.part, near.other)), np.inf)
        distance = exact if abs(exact - near.gap) <= near.accuracy else near.gap
        found: dict[str, Any] = {"nearest": names[near.other], "distance": distance}
        if fall is not None:
            touches = fall.distance <= touching_gap(self._assembly, self._contacts, fall)
            found |= {"below": names[fall.other], "fall": 0.0 if touches else fall.distance}
            if self._tables[fall.other]:
                found |= _rest_keys(self._assembly, group)
        return found


def _of(cluster: Index, owner: Index, fall: StraightFall | None) -> int:
    """Cluster of the loose body onto which a fall leads; -1 if it leads onto none."""
    return -1 if fall is None or owner[fall.other] < 0 else int(cluster[owner[fall.other]])


def _circle(following: list[int]) -> list[int]:
    """Numbers that follow each other in a circle; empty without a circle. -1: none follows."""
    for start in range(len(following)):
        path, at = [], start
        while at >= 0 and at not in path:
            path.append(at)
            at = following[at]
        if at >= 0:
            return path[path.index(at) :]
    return []


def _body(assembly: Assembly, group: Index, **found: Any) -> Body:
    """The record of a body from its parts, with the given further keys."""
    geometry, names = assembly.geometry, assembly.names
    parts = [names[k] for k in group[np.argsort(-geometry.volume[group], kind="stable")]]
    mass = float(geometry.mass[group].sum())
    return Body(parts=tuple(parts), name=parts[0], mass=mass, **found)
