"""Curved faces that touch in ways without a formula: listed, and bounded, not guessed.

An edge or corner on a curved face (a ball on the rim of a hole), a rim on a flat face, free
forms, tori beside tori: such pairs are listed as unsupported. A frictionless sphere is pushed
through its centre, the side of a cylinder across its axis; of others any force and torque is
thought possible. Rims of flat faces are given as inscribed polygons, whose circumscribed ones
bound the answer from the other side (`kilter.contact.curved.rims`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, Mask, cross
from kilter.assembly.geometry import Geometry
from kilter.assembly.surfaces import CYLINDER, FREE, SPHERE
from kilter.contact.broad import Boxes
from kilter.contact.contact_set import PossibleContacts, Unsupported
from kilter.contact.curved.curved_patches import CurvedContacts, on_flat
from kilter.contact.curved.edges_on_curves import edges_on_faces
from kilter.contact.curved.free_forms import free_touch
from kilter.contact.curved.rims import Force, possible_forces
from kilter.contact.patches import Patches
from kilter.contact.planar.facets import Facets
from kilter.contact.sharp.edges import Edges

__all__ = [
    "RoundContacts", "beside_curved", "explained", "in_patch", "no_round_contacts",
    "round_contacts",
]  # fmt: skip


@dataclass(frozen=True, slots=True, eq=False)
class RoundContacts:
    """Pairs that touch at a curved surface, and the forces that they could bring."""

    unsupported: tuple[Unsupported, ...]
    possible: PossibleContacts


def no_round_contacts() -> RoundContacts:
    """Nothing."""
    return RoundContacts((), possible_forces([], two_sided=True))


def beside_curved(geometry: Geometry, parts: Index, points: Array, slack: Array) -> Mask:
    """Points, shape (n, 3), within `slack` of a curved surface of one of their parts (n, 2)."""
    s = geometry.surfaces
    found = np.zeros(len(points), dtype=bool)
    for side in parts.T:
        count = np.diff(s.start)[side]
        owner = np.repeat(np.arange(len(side)), count)
        row = np.arange(len(owner)) + np.repeat(s.start[side] - (np.cumsum(count) - count), count)
        off = np.abs(s.distance(row, points[owner]))
        near = (off <= slack[owner]) | (s.kind[row] == FREE)
        found[owner[near]] = True
    return found


# what a patch explains ----------------------------------------------------------------


def explained(
    geometry: Geometry,
    curved: CurvedContacts,
    patches: Patches,
    pair: int,
    points: Array,
    slack: float,
) -> Mask:
    """Points, shape (n, 3), where patches of the pair say what touches."""
    held = np.zeros(len(points), dtype=bool)
    first, last = np.searchsorted(curved.pair, [pair, pair + 1])
    for patch in range(int(first), int(last)):
        held |= _on_curved(geometry, curved, patch, points, slack)
    first, last = np.searchsorted(patches.pair, [pair, pair + 1])
    for patch in range(int(first), int(last)):
        corners = patches.points[patches.start[patch] : patches.start[patch + 1]]
        held |= on_flat(points, corners, patches.normal[patch], slack)
    return held


def in_patch(
    geometry: Geometry, curved: CurvedContacts, pair: int, points: Array, slack: float
) -> Mask:
    """Points, shape (n, 3), on a curved face that touches all over."""
    held = np.zeros(len(points), dtype=bool)
    first, last = np.searchsorted(curved.pair, [pair, pair + 1])
    for patch in range(int(first), int(last)):
        if curved.area[patch] > 0:
            held |= _on_curved(geometry, curved, patch, points, slack)
    return held


def _on_curved(
    geometry: Geometry, curved: CurvedContacts, patch: int, points: Array, slack: float
) -> Mask:
    corners = curved.points[curved.start[patch] : curved.start[patch + 1]]
    zone = max(float(curved.zone[patch]), slack)
    if curved.area[patch] > 0:
        rows = np.full(len(points), curved.surface[patch].max())
        size = float(np.ptp(corners, axis=0).max())
        low, high = corners.min(axis=0) - 0.1 * size, corners.max(axis=0) + 0.1 * size
        near: Mask = np.abs(geometry.surfaces.distance(rows, points)) <= slack
        near &= ((points >= low) & (points <= high)).all(axis=1)
        return near
    if len(corners) > 2:  # a circle
        zone += 0.05 * float(np.ptp(corners, axis=0).max())
    following = np.roll(corners, -1, axis=0)
    step = following - corners
    t = np.einsum("nki,ki->nk", points[:, None] - corners, step)
    t = np.clip(t / np.maximum((step**2).sum(axis=1), 1e-300), 0, 1)
    foot = corners + t[..., None] * step
    beside: Mask = np.linalg.norm(points[:, None] - foot, axis=2).min(axis=1) <= zone
    return beside


# what touches without a formula -------------------------------------------------------


def round_contacts(
    geometry: Geometry,
    facets: Facets,
    boxes: Boxes,
    edges: Edges,
    pairs: Index,
    tolerance: Array,
    rows: Index,
    rims: tuple[Index, Array],
    curved: CurvedContacts,
    patches: Patches,
) -> RoundContacts:
    """Which of the pairs `rows` touch at a curved surface without a patch that says how.

    Parameters
    ----------
    edges : Edges
        Of all parts of these pairs.
    rims : (pair, point)
        Where corners and edges beside curved faces touch the other part.
    """
    found: dict[int, list[tuple[Array, int]]] = {}

    def note(pair: Index, point: Array, surface: Index) -> None:
        for name in np.unique(pair).tolist():
            mine = np.flatnonzero(pair == name)
            both = pairs[name]
            slack = float(tolerance[name] + 2 * geometry.slack[both].max())
            free = ~explained(geometry, curved, patches, name, point[mine], slack)
            found.setdefault(name, []).extend((point[k], int(surface[k])) for k in mine[free])

    note(rims[0], rims[1], np.full(len(rims[0]), -1))
    for turn in (False, True):
        note(*edges_on_faces(geometry, facets, boxes, edges, pairs, tolerance, rows, curved, turn))
    chosen = curved.unknown[np.isin(curved.unknown[:, 0], rows)]
    known = {(int(k), *s) for k, s in zip(curved.pair, curved.surface.tolist(), strict=True)}
    chosen = chosen[[tuple(row) not in known for row in chosen.tolist()]]
    for pair, i, j in chosen.tolist():
        point = free_touch(geometry, pairs[pair], (i, j), float(tolerance[pair]))
        note(np.full(len(point), pair), point, np.full(len(point), -1))
    return _listed(geometry, pairs, found)


def _listed(
    geometry: Geometry, pairs: Index, found: dict[int, list[tuple[Array, int]]]
) -> RoundContacts:
    unsupported = []
    forces: list[Force] = []
    for pair in sorted(found):
        if not found[pair]:
            continue
        a, b = (int(k) for k in pairs[pair])
        point, _ = found[pair][0]
        x, y, z = point.tolist()
        unsupported.append(Unsupported((a, b), "curved", (x, y, z)))
        surfaces = {surface for _, surface in found[pair]}
        if all(geometry.surfaces.kind[k] in (SPHERE, CYLINDER) for k in surfaces if k >= 0) and (
            min(surfaces) >= 0
        ):
            held = [force for k in sorted(surfaces) for force in _forces(geometry, k)]
        else:
            held = _any_wrench(point, float(geometry.radius[[a, b]].min()))
        forces.extend((a, b, at, normal) for at, normal in held)
    return RoundContacts(tuple(unsupported), possible_forces(forces, two_sided=True))


def _any_wrench(point: Array, arm: float) -> list[tuple[Array, Array]]:
    """Points and directions of forces that add up to any force and torque."""
    x, y, z = np.eye(3)
    at = [(point, x), (point, y), (point, z)]
    return [*at, (point + arm * x, y), (point + arm * x, z), (point + arm * y, z)]


def _forces(geometry: Geometry, surface: int) -> list[tuple[Array, Array]]:
    """Points and directions of all forces that a sphere or cylinder can take, both senses."""
    s = geometry.surfaces
    center, axis = s.point[surface], s.axis[surface]
    if s.kind[surface] == SPHERE:
        return [(center, direction) for direction in np.eye(3)]
    u = cross(np.eye(3)[np.abs(axis).argmin()], axis)
    u /= np.linalg.norm(u)
    corners = geometry.vertices[geometry.triangles[s.triangles_of(surface)]].reshape(-1, 3)
    along = (corners - center) @ axis
    ends = (center + along.min() * axis, center + along.max() * axis)
    return [(end, d) for end in ends for d in (u, cross(axis, u))]
