"""Patches of curved contact, as they are found and as arrays."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from kilter.arrays import Array, Index, Mask, cross
from kilter.assembly.geometry import Geometry
from kilter.assembly.surfaces import KINDS
from kilter.contact.broad import Boxes
from kilter.contact.contact_set import Overlap, PossibleContacts, Rejected
from kilter.contact.curved.contact_points import Spots
from kilter.contact.patches import Patches
from kilter.contact.planar.facets import Facets

__all__ = ["CurvedContacts", "Made", "Pairs", "Scene", "keep", "on_flat", "packed",
           "without_repeats"]  # fmt: skip


ALIKE = 1e-3
"""A line at the rim of a flat patch belongs to it where their normals differ by less."""
NAMED = ("sphere", "torus", "cone", "cylinder")
"""A patch is named after the first of these that touches in it."""


@dataclass(frozen=True, slots=True, eq=False)
class CurvedContacts:
    """Patches of curved contact, struct of arrays as in `ContactSet`.

    Attributes
    ----------
    pair : ndarray of int, shape (P,)
        Row of the pair of parts.
    surface : ndarray of int, shape (P, 2)
        Curved surfaces of part a and b; -1: a flat face.
    normal, area, gap, kind, accuracy, start, points, normals
        As in `ContactSet`.
    zone : ndarray, shape (P,)
        Triangles may touch within so far of the contact [length unit].
    unknown : ndarray of int, shape (m, 3)
        Row of the pair, and curved surfaces of a and b (-1: flat faces) without a formula.
    possible : PossibleContacts
        Outer rows of the patches whose points lie inside the true cone of forces.
    rejected, overlaps, warnings
        As in `ContactSet`.
    """

    pair: Index
    surface: Index
    normal: Array
    area: Array
    gap: Array
    kind: NDArray[np.str_]
    accuracy: Array
    zone: Array
    start: Index
    points: Array
    normals: Array
    unknown: Index
    possible: PossibleContacts
    rejected: tuple[Rejected, ...]
    overlaps: tuple[Overlap, ...]
    warnings: tuple[str, ...]

    def __len__(self) -> int:
        return len(self.pair)


@dataclass(frozen=True, slots=True, eq=False)
class Pairs:
    """Candidates: row of the pair of parts, surface i, its partner, whether i is part b's."""

    pair: Index
    i: Index
    j: Index
    turned: Mask

    def take(self, rows: Index | Mask) -> Pairs:
        """The rows chosen."""
        return Pairs(*(getattr(self, name)[rows] for name in self.__slots__))


@dataclass(slots=True, eq=False)
class Made:
    """Patches as they are found: one row each, points in blocks."""

    pair: list[int] = field(default_factory=list)
    surface: list[tuple[int, int]] = field(default_factory=list)
    area: list[float] = field(default_factory=list)
    gap: list[tuple[float, float]] = field(default_factory=list)
    zone: list[float] = field(default_factory=list)
    size: list[float] = field(default_factory=list)
    spots: list[Spots] = field(default_factory=list)
    turned: list[bool] = field(default_factory=list)
    rejected: list[Rejected] = field(default_factory=list)
    overlaps: list[Overlap] = field(default_factory=list)


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """What all steps need."""

    geometry: Geometry
    facets: Facets
    boxes: Boxes
    pairs: Index
    gap: Array
    margin: Array
    angle: float

    def face(self, row: int) -> Array:
        """Triangles of a curved surface, shape (m, 3, 3)."""
        geometry = self.geometry
        return geometry.vertices[geometry.triangles[geometry.surfaces.triangles_of(row)]]

    def flat(self, facet: int) -> Array:
        """Triangles of a flat face, shape (m, 3, 3)."""
        facets = self.facets
        corners = facets.corners[facets.corner_start[facet] : facets.corner_start[facet + 1]]
        points = self.geometry.vertices[corners]
        if not facets.convex[facet]:
            return points.reshape(-1, 3, 3)
        count = len(points)
        k = np.arange(1, count - 1)
        return points[np.column_stack([0 * k, k, k + 1])]


def keep(
    scene: Scene,
    made: Made,
    pair: int,
    names: tuple[int, int],
    gap: tuple[float, float],
    limit: float,
    spots: Spots,
    zone: float,
    turned: bool,
) -> None:
    """A patch where the gap is within tolerance, else a near pair or an overlap."""
    low, high = gap
    a, b = (int(k) for k in scene.pairs[pair])
    if low <= limit and high >= -limit:
        made.pair.append(pair)
        made.surface.append(names[::-1] if turned else names)
        made.area.append(spots.area)
        made.gap.append(gap)
        made.zone.append(zone)
        radius = float(scene.geometry.surfaces.radius[names[0]])
        size = max(radius, float(np.ptp(spots.points, axis=0).max()))
        made.size.append(size or float(scene.geometry.radius[[a, b]].min()))
        made.spots.append(spots)
        made.turned.append(turned)
    elif low > 0:
        made.rejected.append(Rejected((a, b), low, 0.0, "gap above the tolerance"))
    elif high < 0:
        depth = -high
        made.overlaps.append(Overlap((a, b), None, depth, "interfere"))
        made.rejected.append(
            Rejected((a, b), high, 0.0, "penetrates by more than the gap tolerance")
        )


def without_repeats(curved: CurvedContacts, patches: Patches, tolerance: Array) -> CurvedContacts:
    """Without lines and points at the rim of a flat patch of the same pair: a fillet's seam."""
    keep = np.ones(len(curved), dtype=bool)
    for patch in np.flatnonzero(np.isin(curved.pair, patches.pair)):
        pair = int(curved.pair[patch])
        span = slice(curved.start[patch], curved.start[patch + 1])
        points, normals = curved.points[span], curved.normals[span]
        first, last = np.searchsorted(patches.pair, [pair, pair + 1])
        for flat in range(int(first), int(last)):
            corners = patches.points[patches.start[flat] : patches.start[flat + 1]]
            alike = np.abs(normals - patches.normal[flat]).max() <= ALIKE
            if alike and on_flat(points, corners, patches.normal[flat], 2 * tolerance[pair]).all():
                keep[patch] = False
    return curved if keep.all() else _chosen(curved, np.flatnonzero(keep))


def _chosen(curved: CurvedContacts, rows: Index) -> CurvedContacts:
    """Some of the patches."""
    count = np.diff(curved.start)[rows]
    start = np.concatenate([[0], np.cumsum(count)])
    points = np.repeat(curved.start[rows] - start[:-1], count) + np.arange(int(start[-1]))
    by_patch = ("pair", "surface", "normal", "area", "gap", "kind", "accuracy", "zone")
    changed = {name: getattr(curved, name)[rows] for name in by_patch}
    by_point = {name: getattr(curved, name)[points] for name in ("points", "normals")}
    return dataclasses.replace(curved, **changed, **by_point, start=start)


def on_flat(points: Array, corners: Array, normal: Array, slack: float) -> Mask:
    """Points within `slack` of a flat convex patch."""
    level = np.abs((points - corners[0]) @ normal) <= slack
    along = np.roll(corners, -1, axis=0) - corners
    length = np.maximum(np.linalg.norm(along, axis=1), np.finfo(float).tiny)
    side = cross(along[None], points[:, None] - corners[None]) @ normal / length
    if float((cross(along, corners.mean(axis=0) - corners) @ normal).sum()) < 0:
        side = -side  # the corners turn the other way
    inside: Mask = level & (side >= -slack).all(axis=1)
    return inside


def packed(scene: Scene, made: Made, unknown: Index, raised: int) -> CurvedContacts:
    """The patches as arrays, ordered by pair, normals from a to b."""
    order = np.argsort(np.array(made.pair, dtype=np.int64), kind="stable")
    pair = np.array(made.pair, dtype=np.int64)[order]
    spots = [made.spots[k] for k in order]
    sign = [-1.0 if made.turned[k] else 1.0 for k in order]
    none = [np.empty((0, 3))]
    count = np.array([len(s.points) for s in spots], dtype=np.int64)
    normals = np.concatenate([*(t * s.normals for s, t in zip(spots, sign, strict=True)), *none])
    start = np.concatenate([[0], np.cumsum(count)]).astype(np.int64)
    surface = np.array(made.surface, dtype=np.int64).reshape(-1, 2)[order]
    accuracy = scene.geometry.accuracy[scene.pairs[pair]].sum(axis=1)
    size = np.array(made.size)[order] if made.size else np.empty(0)
    outer = np.array([len(s.outer_points) for s in spots], dtype=np.int64)
    parts = np.repeat(scene.pairs[pair], outer, axis=0)
    possible = PossibleContacts(
        part_a=parts[:, 0],
        part_b=parts[:, 1],
        points=np.concatenate([*(s.outer_points for s in spots), *none]),
        normals=np.concatenate(
            [*(t * s.outer_normals for s, t in zip(spots, sign, strict=True)), *none]
        ),
        two_sided=np.zeros(len(parts), dtype=bool),
        mu=np.zeros(len(parts)),
    )
    return CurvedContacts(
        pair=pair,
        surface=surface,
        normal=_means(normals, start),
        area=np.array(made.area)[order] if made.area else np.empty(0),
        gap=np.array(made.gap).reshape(-1, 2)[order],
        kind=np.array([_name(scene, row) for row in surface.tolist()], dtype="<U11"),
        accuracy=accuracy / size if len(size) else np.empty(0),
        zone=np.array(made.zone)[order] if made.zone else np.empty(0),
        start=start,
        points=np.concatenate([*(s.points for s in spots), *none]),
        normals=normals,
        unknown=unknown,
        possible=possible,
        rejected=tuple(made.rejected),
        overlaps=tuple(made.overlaps),
        warnings=_warnings(raised),
    )


def _means(normals: Array, start: Index) -> Array:
    """Unit mean normal of each patch; the first one where they cancel."""
    if len(start) == 1:
        return np.empty((0, 3))
    total = np.add.reduceat(normals, start[:-1], axis=0)
    count = np.diff(start)[:, None]
    length = np.linalg.norm(total, axis=1)[:, None]
    mean: Array = np.where(
        length > 1e-9 * count, total / np.maximum(length, 1e-300), normals[start[:-1]]
    )
    return mean


def _name(scene: Scene, surface: list[int]) -> str:
    kinds = {KINDS[scene.geometry.surfaces.kind[k]] for k in surface if k >= 0}
    return next(name for name in NAMED if name in kinds)


def _warnings(raised: int) -> tuple[str, ...]:
    if not raised:
        return ()
    pairs = "1 pair" if raised == 1 else f"{raised} pairs"
    return (
        f"curved faces recognised in meshes: the gap tolerance of {pairs} was raised to the height "
        "of the arcs over their triangles; a clearance or interference below that is not seen",
    )
