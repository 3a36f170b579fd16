"""Curved faces that touch in ways without a formula: listed, and bounded, not guessed.

An edge or corner on a curved face (a ball on the rim of a hole), a rim that is no circle across
its axis on a flat face, free forms, tori beside tori: such pairs are listed as unsupported. A
frictionless sphere is pushed through its centre, the side of a cylinder across its axis; of
others any force and torque is thought possible. Rims of flat faces are given as inscribed
polygons, whose circumscribed ones bound the answer from the other side
(`kilter.contact.curved.rims`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, Mask, across, ragged
from kilter.assembly.geometry import Geometry
from kilter.assembly.surfaces import CYLINDER, FREE, SPHERE
from kilter.contact.broad import joins
from kilter.contact.contact_set import PossibleContacts, Unsupported
from kilter.contact.curved.edges_on_curves import edges_on_faces
from kilter.contact.curved.rims import Force, possible_forces
from kilter.contact.sharp.edges import Edges
from kilter.contact.touching import Touching, explained
from kilter.contact.triangle_distance import near_triangles

__all__ = ["RoundContacts", "beside_curved", "no_round_contacts", "round_contacts"]


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
        owner, row = ragged(s.start, side)
        off = np.abs(s.distance(row, points[owner]))
        near = (off <= slack[owner]) | (s.kind[row] == FREE)
        found[owner[near]] = True
    return found


def round_contacts(
    touching: Touching, edges: Edges, rows: Index, rims: tuple[Index, Array], reach: Array
) -> RoundContacts:
    """Which of the pairs `rows` touch at a curved surface without a patch that says how.

    Parameters
    ----------
    touching : Touching
    edges : Edges
        Of all parts of these pairs.
    rows : ndarray of int, shape (n,)
    rims : (pair, point)
        Where corners and edges beside curved faces touch the other part.
    reach : ndarray, shape (number of pairs,)
        Up to this distance they touch, or might [length unit].
    """
    search, curved = touching.search, touching.curved
    geometry, pairs = search.geometry, search.pairs
    found: dict[int, list[tuple[Array, int]]] = {}

    def note(pair: Index, point: Array, surface: Index) -> None:
        for name in np.unique(pair).tolist():
            mine = np.flatnonzero(pair == name)
            slack = float(reach[name] + 2 * geometry.slack[pairs[name]].max())
            free = ~explained(touching, name, point[mine], slack)
            free &= ~touching.smooth.explains(pair[mine], point[mine])
            found.setdefault(name, []).extend((point[k], int(surface[k])) for k in mine[free])

    note(rims[0], rims[1], np.full(len(rims[0]), -1))
    for turn in (False, True):
        note(*edges_on_faces(touching, edges, rows, reach, turn=turn))
    chosen = curved.unknown[np.isin(curved.unknown[:, 0], rows)]
    known = np.column_stack([curved.patches.pair, curved.surface]).tolist()
    known = {tuple(row) for row in known}
    chosen = chosen[[tuple(row) not in known for row in chosen.tolist()]]
    for pair, i, j in chosen.tolist():
        point = _free_touch(geometry, pairs[pair], (i, j), float(reach[pair]))
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
    corners = geometry.vertices[geometry.triangles[s.triangles_of(surface)]].reshape(-1, 3)
    along = (corners - center) @ axis
    ends = (center + along.min() * axis, center + along.max() * axis)
    return [(end, d) for end in ends for d in across(axis)]


# faces without a formula: where their triangles come near each other --------------------


def _free_touch(
    geometry: Geometry, parts: Index, names: tuple[int, int], tolerance: float
) -> Array:
    """Points where triangles of two faces come within tolerance and both sagittas, (n, 3)."""
    s = geometry.surfaces
    sides = []
    for part, name in zip(parts.tolist(), names, strict=True):
        if name >= 0:
            chosen = s.triangles_of(name)
        else:
            span = np.arange(geometry.triangle_start[part], geometry.triangle_start[part + 1])
            chosen = span[geometry.triangle_surface[span] < 0]
        sides.append(geometry.vertices[geometry.triangles[chosen]])
    grow = tolerance + float(sum(s.sagitta[k] for k in names if k >= 0))
    boxes = [(side.min(axis=1), side.max(axis=1)) for side in sides]
    owners = [np.zeros(len(side), dtype=np.int64) for side in sides]
    found = [np.empty((0, 3))]
    for _, i, j in joins(owners[0], boxes[0], owners[1], boxes[1], np.array([grow])):
        found.append(near_triangles(sides[0][i], sides[1][j], grow))
    return np.concatenate(found)
