"""Rates of contact points and normals, if the vertices of the parts move.

A corner x of a contact polygon lies on outlines of both faces. With the outward normals m1, m2 of
two of these outlines in the plane of contact, whose parts move there at v1, v2,

    m1.x' = m1.v1,    m2.x' = m2.v2,    n.x' = n.(va + vb)/2

A vertex of a face lies on two outlines of this face, so it moves with its part. If outlines of both
faces coincide, that outline bounds the polygon which moves inwards: the rates to both sides differ.
The normal is the mean of those of both faces, or that of the only face. It stays across two edges:
  n'.e = -n.e'.

The rates are exact for movements that keep the faces together; for others the mean of both faces
is a convention. Contact points that the file lists do not move. Round contacts have no rates.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from kilter.analysis.analysis_tolerances import CORNER, OUTLINE_ANGLE
from kilter.arrays import TINY, Array, Index, Mask, across, cross, lengths, unit_rows
from kilter.assembly.geometry import Geometry
from kilter.contact import ContactSet
from kilter.mechanics.program import Program
from kilter.mechanics.rows import CONTACT

FLAT = ("plane", "edge-edge", "edge-face", "vertex-face")
"""Kinds of patches with rates."""
FACING = 1e-4
"""A triangle lies in the plane of a patch up to this 1 - cosine of their normals [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class PointRates:
    """Terms of the rates of points: x' of a row grows by `along` times across.v of a part.

    The velocity v of the part at the point is that of three vertices with the given weights.
    """

    row: Index
    """Row of the program, shape (E,)."""
    part: Index
    """Part that moves, shape (E,)."""
    vertices: Index
    """Rows of `Geometry.vertices`, shape (E, 3)."""
    weights: Array
    """Barycentric weights of these vertices [-], shape (E, 3)."""
    across: Array
    """Direction whose velocity counts, outwards [-], shape (E, 3)."""
    along: Array
    """Rate of the point per unit of this velocity [-], shape (E, 3)."""
    group: Index
    """Terms of a group belong to coinciding outlines, of which the slowest counts; -1: no group,
    shape (E,)."""


@dataclass(frozen=True, slots=True, eq=False)
class TurnRates:
    """Terms of the rotation of normals: that of a row grows by `turn` times n.(v1 - v0)."""

    row: Index
    """Row of the program, shape (E,)."""
    part: Index
    """Part that moves, shape (E,)."""
    edge: Index
    """Rows v0 and v1 of `Geometry.vertices`, shape (E, 2)."""
    turn: Array
    """Rotation of the normal per unit [rad / length unit], shape (E, 3)."""


@dataclass(frozen=True, slots=True, eq=False)
class Outlines:
    """Edges of the faces of a patch, for the distance after which other features touch."""

    rows: Index
    """Rows of the program at the patch."""
    part: Index
    """Part of each edge, shape (L,)."""
    edge: Index
    """Rows of `Geometry.vertices`, shape (L, 2)."""
    across: Array
    """Outward normal in the plane of contact, shape (L, 3)."""


@dataclass(frozen=True, slots=True, eq=False)
class ContactRates:
    """The rates of all contact rows of a program."""

    points: PointRates
    turns: TurnRates
    outlines: tuple[Outlines, ...]
    round: Mask
    """Rows without rates, since their contact is round or its features are unknown, shape (K,)."""
    crowded: Mask
    """Rows at which more than two outlines meet: their rates hold to one side only, shape (K,)."""


def contact_rates(program: Program, contacts: ContactSet) -> ContactRates:
    """Find the features of the parts at each contact row, and the rates that these give it."""
    builder = _Builder(program, contacts)
    rows = np.flatnonzero(program.kind == CONTACT)
    kinds = contacts.patch_kind
    for patch in np.unique(program.source[rows]).tolist():
        of_patch = rows[program.source[rows] == patch]
        kind = str(kinds[patch])
        if kind in FLAT:
            builder.add(patch, of_patch)
        elif kind != "given":
            builder.round[of_patch] = True
    return builder.rates()


@dataclass(frozen=True, slots=True, eq=False)
class _Side:
    """The features of a part in the plane of a patch: triangles, and edges with outward normals."""

    part: int
    triangles: Index
    """Rows of `Geometry.vertices` of the triangles of the face, shape (t, 3); empty without."""
    edges: Index
    """Outlines of the face, or without a face the edges in the plane, shape (e, 2)."""
    out: Array
    """Outward normals of the outlines in the plane, shape (e, 3)."""
    slack: float
    """Largest distance of a point from the outline on which it counts [length unit]."""
    sagitta: float
    """Distance of the outline from a round rim [length unit]; 0 for straight outlines."""


class _Builder:
    """Collects the terms of all rows."""

    def __init__(self, program: Program, contacts: ContactSet) -> None:
        self.program, self.geometry = program, contacts.assembly.geometry
        self.contacts = contacts
        count = len(program.part_a)
        self.round, self.crowded = np.zeros(count, dtype=bool), np.zeros(count, dtype=bool)
        self._points: list[tuple[int, int, Index, Array, Array, Array, int]] = []
        self._turns: list[tuple[int, int, Index, Array]] = []
        self._outlines: list[Outlines] = []
        self._groups = 0
        self._normals: dict[int, tuple[Index, Array]] = {}

    def rates(self) -> ContactRates:
        """The terms that were added."""
        ids = [np.array([term[k] for term in self._points], dtype=np.int64) for k in (0, 1, 6)]
        arrays = [np.array([term[k] for term in self._points]).reshape(-1, 3) for k in (2, 3, 4, 5)]
        points = PointRates(
            ids[0], ids[1], arrays[0].astype(np.int64), arrays[1], arrays[2], arrays[3], ids[2]
        )
        turns = TurnRates(
            np.array([term[0] for term in self._turns], dtype=np.int64),
            np.array([term[1] for term in self._turns], dtype=np.int64),
            np.array([term[2] for term in self._turns], dtype=np.int64).reshape(-1, 2),
            np.array([term[3] for term in self._turns]).reshape(-1, 3),
        )
        return ContactRates(points, turns, tuple(self._outlines), self.round, self.crowded)

    def add(self, patch: int, rows: Index) -> None:
        """Add the terms of the rows of a flat patch."""
        program = self.program
        normal = program.normal[rows[0]]
        parts = int(program.part_a[rows[0]]), int(program.part_b[rows[0]])
        points = program.point[rows]
        gap = float(np.abs(self.contacts.patch_gap[patch]).max())
        sides = [self._side(part, normal, points, gap) for part in parts]
        self._outlines.append(_outlines(rows, [side for side in sides if len(side.triangles)]))
        edges: list[list[Index]] = [[], []]
        for row, x in zip(rows.tolist(), points, strict=True):
            self._add_point(row, x, normal, sides, edges)
        self._add_turns(rows, normal, sides, edges)

    def _side(self, part: int, normal: Array, points: Array, gap: float) -> _Side:
        """Find the features of a part that lie in the plane of a patch."""
        geometry = self.geometry
        triangles, normals = self._triangles(part)
        vertices = geometry.vertices
        size = float(geometry.size[part])
        slack = max(CORNER * size, 8 * float(geometry.accuracy[part]), 2 * gap)
        level = vertices[triangles[:, 0]] - points[0]
        flat = np.abs(normals @ normal) > 1 - FACING
        flat &= np.abs(np.einsum("ij,ij->i", level, normals)) <= slack
        face = triangles[flat]
        if not len(face):
            edges = _all_edges(triangles)
            along = vertices[edges[:, 1]] - vertices[edges[:, 0]]
            level_of = np.abs((vertices[edges] - points[0]) @ normal).max(axis=1)
            inside = (np.abs(unit_rows(along) @ normal) < OUTLINE_ANGLE) & (level_of <= slack)
            edges = edges[inside]
            out = unit_rows(cross(vertices[edges[:, 1]] - vertices[edges[:, 0]], normal[None]))
            return _Side(part, face, edges, out, slack, 0.0)
        edges = _outline(face)
        outward = normals[flat][0]
        out = unit_rows(cross(vertices[edges[:, 1]] - vertices[edges[:, 0]], outward[None]))
        return _Side(part, face, edges, out, slack, float(geometry.slack[part]))

    def _triangles(self, part: int) -> tuple[Index, Array]:
        """Triangles of a part, with equal vertices merged, and their unit normals; kept."""
        if part not in self._normals:
            geometry = self.geometry
            span = slice(geometry.triangle_start[part], geometry.triangle_start[part + 1])
            triangles = _merged(geometry, part)[geometry.triangles[span]]
            corners = geometry.vertices[triangles]
            normals = cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
            self._normals[part] = triangles, unit_rows(normals)
        return self._normals[part]

    def _add_point(
        self, row: int, x: Array, normal: Array, sides: list[_Side], edges: list[list[Index]]
    ) -> None:
        """Add the terms of a contact point; note in `edges` the edges on which it lies."""
        lines: list[tuple[int, Array]] = []
        supports = []
        for k, side in enumerate(sides):
            support = self._support(side, x)
            if support is None:
                self.round[row] = True
                return
            supports.append(support)
            directions, on = self._directions(side, x, normal)
            edges[k].extend(on)
            lines += [(k, direction) for direction in directions]
        for k, side in enumerate(sides):  # the plane of contact
            self._point(row, side.part, supports[k], normal, normal / 2)
        merged = _merge(lines)
        chosen = _corner(merged)
        self.crowded[row] |= len(merged) > 2
        if len(chosen) == 2:
            (m1, _), (m2, _) = chosen
            cosine = float(m1 @ m2)
            sine = 1 - cosine * cosine
            along = [(m1 - cosine * m2) / sine, (m2 - cosine * m1) / sine]
        elif len(chosen) == 1:
            along = [chosen[0][0]]
            other, owners = cross(normal, chosen[0][0]), chosen[0][1]
            for k in owners:
                self._point(row, sides[k].part, supports[k], other, other / len(owners))
        else:
            along = []
            for direction in across(normal):
                for k, side in enumerate(sides):
                    self._point(row, side.part, supports[k], direction, direction / 2)
        for (m, owners), u in zip(chosen, along, strict=True):
            group = -1
            if len(owners) > 1:
                group, self._groups = self._groups, self._groups + 1
            for k in owners:
                self._point(row, sides[k].part, supports[k], m, u, group)

    def _point(
        self, row: int, part: int, support: tuple[Index, Array], m: Array, u: Array, group: int = -1
    ) -> None:
        self._points.append((row, part, *support, m, u, group))

    def _support(self, side: _Side, x: Array) -> tuple[Index, Array] | None:
        """Three vertices of a part, and weights, whose velocities give that of the point x."""
        vertices = self.geometry.vertices
        if len(side.triangles):
            weights = _barycentric(vertices[side.triangles], x)
            best = int(weights.min(axis=1).argmax())
            return side.triangles[best], weights[best]
        if not len(side.edges):
            triangles, _ = self._triangles(side.part)
            corners = np.unique(triangles)
            near = corners[np.argmin(lengths(vertices[corners] - x))]
            if np.linalg.norm(vertices[near] - x) > side.slack:
                return None
            return np.full(3, near), np.array([1.0, 0.0, 0.0])
        ends = vertices[side.edges]
        share, distance = _on_edges(ends, x)
        best = int(distance.argmin())
        if distance[best] > side.slack:
            return None
        first, last = side.edges[best]
        return np.array([first, last, last]), np.array([1 - share[best], share[best], 0.0])

    def _directions(self, side: _Side, x: Array, normal: Array) -> tuple[list[Array], list[Index]]:
        """Outward normals of the outlines of a part at x, and the edges without a face at x."""
        ends = self.geometry.vertices[side.edges]
        share, distance = _on_edges(ends, x)
        at = np.flatnonzero(distance <= side.slack)
        if not len(side.triangles):
            if not len(at):  # a vertex without edges in the plane
                return list(across(normal)), []
            span = lengths(ends[at, 1] - ends[at, 0])
            end = np.minimum(share[at], 1 - share[at]) * span <= side.slack
            if len(at) == 1 and not end[0]:
                return [side.out[at[0]]], [side.edges[at[0]]]
            first = side.out[at[0]]
            return [first, cross(normal, first)], [side.edges[at[0]]]
        if not len(at) and side.sagitta > 0.0 and distance.min() <= 2 * side.sagitta:
            # a round rim: the point moves with its part
            middle = ends[:, 0].mean(axis=0)
            radial = x - middle - ((x - middle) @ normal) * normal
            radial = radial / max(float(np.linalg.norm(radial)), TINY)
            return [radial, cross(normal, radial)], []
        return [side.out[k] for k in at], []

    def _add_turns(
        self, rows: Index, normal: Array, sides: list[_Side], edges: list[list[Index]]
    ) -> None:
        """Add the terms of the normal of a patch: of its faces, or of two edges."""
        faces = [side for side in sides if len(side.triangles)]
        vertices = self.geometry.vertices
        for side in faces:
            corners = vertices[side.triangles]
            area = lengths(cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))
            first, second, third = side.triangles[int(area.argmax())]
            pairs = np.array([[first, second], [first, third]])
            self._add_turn(rows, normal, pairs, [side.part] * 2, 1 / len(faces))
        if not faces and all(edges):
            pairs = np.array([edges[0][0], edges[1][0]])
            self._add_turn(rows, normal, pairs, [side.part for side in sides], 1.0)

    def _add_turn(
        self, rows: Index, normal: Array, pairs: Index, parts: list[int], share: float
    ) -> None:
        """Add the rotation that keeps a normal across two edges."""
        along = self.geometry.vertices[pairs[:, 1]] - self.geometry.vertices[pairs[:, 0]]
        basis = np.column_stack([along[0], along[1], normal])
        dual = np.linalg.inv(basis)[:2]
        for part, pair, of_edge in zip(parts, pairs, dual, strict=True):
            turn = -share * cross(normal, of_edge)
            self._turns += [(row, part, pair, turn) for row in rows.tolist()]


def _merged(geometry: Geometry, part: int) -> Index:
    """Row of the first vertex at the same place, for all rows of vertices; others stay."""
    start, end = geometry.vertex_start[part : part + 2]
    number = np.arange(len(geometry.vertices))
    unit = max(CORNER * float(geometry.size[part]), TINY)
    cells = np.round((geometry.vertices[start:end] - geometry.vertices[start]) / unit)
    _, first, inverse = np.unique(cells, axis=0, return_index=True, return_inverse=True)
    number[start:end] = start + first[inverse.ravel()]
    return number


def _all_edges(triangles: Index) -> Index:
    """Edges of triangles, each once, shape (e, 2)."""
    pairs = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    return np.unique(pairs, axis=0)


def _outline(triangles: Index) -> Index:
    """Edges of a set of triangles that belong to only one of them, in their sense, shape (e, 2)."""
    pairs = triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    _, inverse, count = np.unique(
        np.sort(pairs, axis=1), axis=0, return_inverse=True, return_counts=True
    )
    alone: Index = pairs[count[inverse.ravel()] == 1]
    return alone


def _outlines(rows: Index, sides: list[_Side]) -> Outlines:
    """The outlines of the faces of a patch."""
    return Outlines(
        rows,
        np.concatenate([[], *(np.full(len(s.edges), s.part) for s in sides)]).astype(np.int64),
        np.concatenate([np.zeros((0, 2), dtype=np.int64), *(s.edges for s in sides)]),
        np.concatenate([np.zeros((0, 3)), *(s.out for s in sides)]),
    )


def _barycentric(corners: Array, x: Array) -> Array:
    """Barycentric weights of the point nearest to x in the plane of each triangle, shape (t, 3)."""
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    normal = cross(first, second)
    size = np.maximum(np.einsum("ij,ij->i", normal, normal), TINY)
    arm = x - corners[:, 0]
    v = np.einsum("ij,ij->i", cross(arm, second), normal) / size
    w = np.einsum("ij,ij->i", cross(first, arm), normal) / size
    return np.column_stack([1 - v - w, v, w])


def _on_edges(ends: Array, x: Array) -> tuple[Array, Array]:
    """Share of each edge at which it is nearest to x [-], and the distance, shapes (e,)."""
    along = ends[:, 1] - ends[:, 0]
    size = np.maximum(np.einsum("ij,ij->i", along, along), TINY)
    share = np.clip(np.einsum("ij,ij->i", x - ends[:, 0], along) / size, 0.0, 1.0)
    return share, lengths(ends[:, 0] + share[:, None] * along - x)


def _merge(lines: list[tuple[int, Array]]) -> list[tuple[Array, list[int]]]:
    """Different outward normals at a point, each with the sides that have it."""
    merged: list[tuple[Array, list[int]]] = []
    for side, direction in lines:
        for other, owners in merged:
            if np.linalg.norm(direction - other) < OUTLINE_ANGLE:
                if side not in owners:
                    owners.append(side)
                break
        else:
            merged.append((direction, [side]))
    return merged


def _corner(merged: list[tuple[Array, list[int]]]) -> list[tuple[Array, list[int]]]:
    """The two outlines that bound the polygon at its corner; fewer if the others are parallel."""
    if len(merged) < 2:
        return merged
    pairs = list(_pairs(merged))
    if not pairs:
        return merged[:1]
    # the narrowest corner: its normals are farthest apart
    first, second = min(pairs, key=lambda pair: float(pair[0][0] @ pair[1][0]))
    return [first, second]


def _pairs(
    merged: list[tuple[Array, list[int]]],
) -> Iterator[tuple[tuple[Array, list[int]], tuple[Array, list[int]]]]:
    """Pairs of outlines that are not parallel."""
    for k, first in enumerate(merged):
        for second in merged[k + 1 :]:
            if np.linalg.norm(cross(first[0], second[0])) > OUTLINE_ANGLE:
                yield first, second
