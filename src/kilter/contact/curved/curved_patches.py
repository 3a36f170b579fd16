"""Patches of curved contact: kept one by one as they are found, then packed into arrays."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass, field

import numpy as np

from kilter.arrays import Array, Index, Mask, Rows, cross, ratio, starts
from kilter.assembly.surfaces import KINDS
from kilter.contact.contact_search import ContactSearch
from kilter.contact.contact_set import INTERFERE, Overlap, PossibleContacts
from kilter.contact.contact_tolerances import MEAN_NORMAL, RIM_NORMAL
from kilter.contact.curved.contact_points import Spots
from kilter.contact.curved.shared_walls import shared_depth
from kilter.contact.gaps import APART, PENETRATES, Rejected
from kilter.contact.patches import Patches

__all__ = ["CurvedContacts", "Found", "Limits", "Made", "Pairs", "keep", "on_flat", "packed",
           "without_repeats"]  # fmt: skip


NAMED = ("sphere", "torus", "cone", "cylinder")
"""A patch is named after the first of these that touches in it."""


@dataclass(frozen=True, slots=True, eq=False)
class CurvedContacts:
    """Patches of curved contact, ordered by pair, and what else was found.

    Attributes
    ----------
    patches : Patches
    surface : ndarray of int, shape (P, 2)
        Curved surfaces of part a and b of each patch; -1: a flat face.
    zone : ndarray, shape (P,)
        Triangles may touch within so far of the contact [length unit].
    unknown : ndarray of int, shape (m, 3)
        Row of the pair, and curved surfaces of a and b (-1: flat faces) without a formula.
    possible : PossibleContacts
        Outer rows of the patches whose points lie inside the true cone of forces.
    rejected, overlaps, warnings
        As in `ContactSet`.
    """

    patches: Patches
    surface: Index
    zone: Array
    unknown: Index
    possible: PossibleContacts
    rejected: tuple[Rejected, ...]
    overlaps: tuple[Overlap, ...]
    warnings: tuple[str, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Pairs(Rows):
    """Candidates: row of the pair of parts, surface i, its partner, whether i is part b's."""

    pair: Index
    i: Index
    j: Index
    turned: Mask


@dataclass(frozen=True, slots=True, eq=False)
class Limits:
    """Gap tolerance, and the widest gap that counts as closed, of each candidate, shape (n,)."""

    gap: Array
    closed: Array

    def of(self, row: int) -> tuple[float, float]:
        """Those of one candidate."""
        return float(self.gap[row]), float(self.closed[row])


@dataclass(frozen=True, slots=True, eq=False)
class Found:
    """One patch as it is found.

    Attributes
    ----------
    pair : int
        Row of the pair of parts.
    names : pair of int
        The surface whose normals these are, and its partner (-1: a flat face).
    gap : pair of float
        Least and greatest [length unit].
    limit : float
        Gap tolerance [length unit].
    spots : Spots
    zone : float
        Triangles may touch within so far of the contact [length unit].
    turned : bool
        The first surface is part b's.
    closed : float
        The widest gap that counts as closed; 0: the gap tolerance [length unit].
    play : float
        The gap all around a fit wider than the tolerance; 0: not of that kind [length unit].
    inside : (points, normals) or None
        Points within the region of contact, with the normals there; None: the spots.
    """

    pair: int
    names: tuple[int, int]
    gap: tuple[float, float]
    limit: float
    spots: Spots
    zone: float
    turned: bool
    closed: float = 0.0
    play: float = 0.0
    inside: tuple[Array, Array] | None = None

    @property
    def key(self) -> tuple[int, int, int]:
        """The pair of parts and its two surfaces, in one order."""
        return self.pair, min(self.names), max(self.names)

    @property
    def surface(self) -> tuple[int, int]:
        """Surfaces of part a and of part b."""
        return self.names[::-1] if self.turned else self.names

    @property
    def sense(self) -> float:
        """1 where the normals of the points lead from a to b, else -1."""
        return -1.0 if self.turned else 1.0


@dataclass(slots=True, eq=False)
class Made:
    """What was found so far: what touches, what stands apart, what reaches into each other."""

    found: list[Found] = field(default_factory=list)
    apart: list[Found] = field(default_factory=list)
    pressed: list[tuple[Found, float]] = field(default_factory=list)
    rejected: list[Rejected] = field(default_factory=list)


def keep(search: ContactSearch, made: Made, found: Found) -> None:
    """A patch where the gap is within tolerance, else a near pair or an overlap.

    A fit with play is a patch only where a clearance closes it.
    """
    low, high = found.gap
    if found.play > 0:
        touches, high = low >= -found.limit and found.play <= found.closed, low
    else:
        touches = low <= max(found.limit, found.closed) and high >= -found.limit
    if touches:
        gap = (found.play, found.play) if found.play > 0 else found.gap
        made.found.append(dataclasses.replace(found, gap=gap))
    elif high < -found.limit:
        depth = _shared(search, found)
        if depth > found.limit:
            made.pressed.append((found, depth))
    else:
        made.apart.append(found)


def _shared(search: ContactSearch, found: Found) -> float:
    """How deep the material behind the faces is shared [length unit]."""
    s, (i, j) = search.geometry.surfaces, found.names
    points, normals = found.inside or (found.spots.points, found.spots.normals)
    depth = np.full(len(points), -found.gap[1])
    if j >= 0:
        rows = np.ones(len(points), dtype=np.int64)
        depth = -(s.distance(i * rows, points) + s.distance(j * rows, points))
    a, b = (int(k) for k in search.pairs[found.pair])
    parts = (b, a) if found.turned else (a, b)
    return shared_depth(search.geometry, parts, points, normals, depth)


def _settled(search: ContactSearch, made: Made) -> tuple[list[Rejected], list[Overlap]]:
    """Near pairs and overlaps, and what touches in `made`: two surfaces say one thing.

    A fit that was closed is no line or point as well; one that touches in a line has no play.
    """
    closed = {one.key for one in made.found if one.play > 0}
    made.found = [one for one in made.found if one.play > 0 or one.key not in closed]
    known = {one.key for one in made.found}
    known |= {one.key for one, _ in made.pressed}
    fits = {one.key for one in made.apart if one.play > 0} - known
    rejected, overlaps = list(made.rejected), []
    for one in made.apart:
        if (one.key in fits) if one.play > 0 else (one.key not in fits | closed):
            rejected.append(_near(search, one))
    for one, depth in made.pressed:
        if one.key not in closed:
            parts = _parts(search, one)
            overlaps.append(Overlap(parts, None, depth, INTERFERE))
            rejected.append(Rejected(parts, -depth, 0.0, PENETRATES))
    return rejected, overlaps


def _near(search: ContactSearch, found: Found) -> Rejected:
    hollow = search.geometry.surfaces.hollow
    i, j = found.names
    fit = found.play > 0 or (j >= 0 and bool(hollow[i] != hollow[j]))
    return Rejected(_parts(search, found), found.play or found.gap[0], 0.0, APART, fit)


def _parts(search: ContactSearch, found: Found) -> tuple[int, int]:
    a, b = (int(k) for k in search.pairs[found.pair])
    return a, b


def without_repeats(curved: CurvedContacts, flat: Patches, tolerance: Array) -> CurvedContacts:
    """Without lines and points at the rim of a flat patch of the same pair: a fillet's seam."""
    patches = curved.patches
    keep = np.ones(len(patches), dtype=bool)
    for patch in np.flatnonzero(np.isin(patches.pair, flat.pair)):
        pair, slack = int(patches.pair[patch]), 2 * tolerance[patches.pair[patch]]
        points = patches.corners(int(patch))
        normals = patches.normals[patches.start[patch] : patches.start[patch + 1]]
        for k in flat.of_pair(pair):
            alike = np.abs(normals - flat.normal[k]).max() <= RIM_NORMAL
            if alike and on_flat(points, flat.corners(k), flat.normal[k], slack).all():
                keep[patch] = False
    if keep.all():
        return curved
    rows = np.flatnonzero(keep)
    return dataclasses.replace(
        curved, patches=patches.take(rows), surface=curved.surface[rows], zone=curved.zone[rows]
    )


def on_flat(points: Array, corners: Array, normal: Array, slack: float) -> Mask:
    """Points within `slack` of a flat convex patch."""
    level = np.abs((points - corners[0]) @ normal) <= slack
    along = np.roll(corners, -1, axis=0) - corners
    side = cross(along[None], points[:, None] - corners[None]) @ normal
    side = ratio(side, np.linalg.norm(along, axis=1))
    if float((cross(along, corners.mean(axis=0) - corners) @ normal).sum()) < 0:
        side = -side  # the corners turn the other way
    inside: Mask = level & (side >= -slack).all(axis=1)
    return inside


def packed(search: ContactSearch, made: Made, unknown: Index, raised: int) -> CurvedContacts:
    """The patches as arrays, ordered by pair, normals from a to b."""
    rejected, overlaps = _settled(search, made)
    found = sorted(made.found, key=lambda one: one.pair)
    pair = np.array([one.pair for one in found], dtype=np.int64)
    parts = search.pairs[pair]
    surface = np.array([one.surface for one in found], dtype=np.int64).reshape(-1, 2)
    start = starts([len(one.spots.points) for one in found])
    normals = _stacked([one.sense * one.spots.normals for one in found])
    size = np.array([_size(search, one) for one in found])
    patches = Patches(
        pair=pair,
        parts=parts,
        kind=np.array([_name(search, row) for row in surface.tolist()], dtype="<U11"),
        normal=_means(normals, start),
        area=np.array([one.spots.area for one in found]),
        gap=np.array([one.gap for one in found]).reshape(-1, 2),
        accuracy=search.geometry.accuracy[parts].sum(axis=1) / size,
        start=start,
        points=_stacked([one.spots.points for one in found]),
        normals=normals,
    )
    outer = np.repeat(parts, [len(one.spots.outer_points) for one in found], axis=0)
    possible = PossibleContacts(
        part_a=outer[:, 0],
        part_b=outer[:, 1],
        points=_stacked([one.spots.outer_points for one in found]),
        normals=_stacked([one.sense * one.spots.outer_normals for one in found]),
        two_sided=np.zeros(len(outer), dtype=bool),
        mu=np.zeros(len(outer)),
        degenerate=np.full(len(outer), -1),
    )
    return CurvedContacts(
        patches=patches,
        surface=surface,
        zone=np.array([one.zone for one in found]),
        unknown=unknown,
        possible=possible,
        rejected=tuple(rejected),
        overlaps=tuple(overlaps),
        warnings=_warnings(raised),
    )


def _stacked(rows: list[Array]) -> Array:
    return np.concatenate([np.empty((0, 3)), *rows])


def _size(search: ContactSearch, found: Found) -> float:
    """Size of a patch, that its accuracy is relative to [length unit]."""
    radius = float(search.geometry.surfaces.radius[found.names[0]])
    size = max(radius, float(np.ptp(found.spots.points, axis=0).max()))
    return size or float(search.geometry.radius[search.pairs[found.pair]].min())


def _means(normals: Array, start: Index) -> Array:
    """Unit mean normal of each patch; the first one where they cancel."""
    if len(start) == 1:
        return np.empty((0, 3))
    total = np.add.reduceat(normals, start[:-1], axis=0)
    count = np.diff(start)[:, None]
    length = np.linalg.norm(total, axis=1)[:, None]
    mean: Array = np.where(length > MEAN_NORMAL * count, ratio(total, length), normals[start[:-1]])
    return mean


def _name(search: ContactSearch, surface: list[int]) -> str:
    kinds = {KINDS[search.geometry.surfaces.kind[k]] for k in surface if k >= 0}
    return next(name for name in NAMED if name in kinds)


def _warnings(raised: int) -> tuple[str, ...]:
    if not raised:
        return ()
    pairs = "1 pair" if raised == 1 else f"{raised} pairs"
    return (
        f"curved faces recognised in meshes: the gap tolerance of {pairs} was raised to the height "
        "of the arcs over their triangles; a clearance or interference below that is not seen",
    )
