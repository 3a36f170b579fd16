"""From an assembly to its contacts: broad phase, overlay of faces, patches, near pairs."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, Mask
from kilter.assembly import Assembly, require_assembly
from kilter.assembly.geometry import Geometry
from kilter.contact.broad import Boxes, facet_pairs, make_boxes, part_pairs
from kilter.contact.closing import CLUSTER, closed_by_clearance, tolerance_warnings
from kilter.contact.contact_set import (
    ContactSet,
    Overlap,
    PossibleContacts,
    Rejected,
    Tolerance,
)
from kilter.contact.curved.curved_contacts import find_curved
from kilter.contact.curved.curved_patches import CurvedContacts, without_repeats
from kilter.contact.curved.rims import rim_contacts
from kilter.contact.fits.overlap import find_overlaps
from kilter.contact.patches import merge
from kilter.contact.planar.facets import Facets, find_facets
from kilter.contact.planar.opposing import FacetFrame, Pieces, facet_frames, overlaps_of
from kilter.contact.sharp.sharp_contacts import NearContacts, Touching, near_contacts
from kilter.errors import InputError

__all__ = ["contacts"]


NEAR = 100.0
"""Gaps up to this many tolerances are looked at, for the histogram and the rejected pairs."""
NEAR_ANGLE = 0.05
"""Angles up to this are looked at [rad]."""
THICKNESS = 0.1
"""The gap tolerance is at most this part of the thickness of the thinner part."""
DECADES: Array = np.power(10.0, np.arange(-12, -1))
GAP_EDGES: Array = np.concatenate([[-np.inf], -DECADES[::-1], [0.0], DECADES, [np.inf]])
"""Edges of the histogram of gaps, over the size of the smaller part [-]."""
LISTED = 1000
"""Rejected pairs kept, nearest first."""


def contacts(
    assembly: Assembly,
    *,
    tolerance: Tolerance | None = None,
    progress: Callable[[str], None] | None = None,
) -> ContactSet:
    """What touches in an assembly.

    Parameters
    ----------
    assembly : Assembly
    tolerance : Tolerance, optional
        When faces count as touching.
    progress : callable, optional
        Called with a word at each stage.

    Returns
    -------
    ContactSet
        Patches of detected planar contact, given contacts, and what came near.

    Raises
    ------
    InputError
        If the tolerance is not above zero.

    Examples
    --------
    >>> from kilter.shape.primitives import Box
    >>> from kilter.assembly import Part
    >>> from kilter.rigid import Pose
    >>> table = Part("table", Box([4, 4, 1]), Pose([0, 0, -0.5]), grounded=True)
    >>> found = contacts(Assembly([table, Part("cube", Box([1, 1, 1]), Pose([0, 0, 0.5]))]))
    >>> found
    <ContactSet: patches 1, points 4, pairs 1>
    >>> found.patch_area, found.patch_normal.tolist()
    (array([1.]), [[0.0, 0.0, 1.0]])
    """
    require_assembly(assembly, "contacts")
    tolerance = Tolerance() if tolerance is None else tolerance
    _check(tolerance)
    tell = progress or (lambda stage: None)
    geometry = assembly.geometry
    tell("facets")
    facets = find_facets(geometry)
    tell("near pairs")
    boxes = make_boxes(geometry, facets)
    pairs = _pairs_to_detect(assembly, boxes, tolerance)
    limits = _limits(geometry, facets, pairs, tolerance)
    tell("faces")
    curved = find_curved(geometry, facets, boxes, pairs, limits.gap, limits.margin, tolerance.angle)
    found = _planar(geometry, facets, boxes, pairs, limits, tolerance, curved)
    tell("edges and corners")
    near = near_contacts(geometry, facets, boxes, found.touching)
    overlaps, warnings = find_overlaps(assembly, geometry, facets, boxes, found.touching, tolerance)
    return _contact_set(assembly, found, limits, near, overlaps, warnings, tolerance)


@dataclass(frozen=True, slots=True, eq=False)
class _Limits:
    """Arrays, one row a pair: gap tolerance, clearance, margin looked at, rounding [length unit].

    `closed`: gaps up to this count as closed; the tolerance, or the designed clearance.
    """

    gap: Array
    closed: Array
    margin: Array
    blur: Array
    coarse: Mask


@dataclass(frozen=True, slots=True, eq=False)
class _Found:
    """What the overlay of faces gave."""

    touching: Touching
    frames: FacetFrame
    facets: Facets
    rejected: list[Rejected]
    counts: Index
    warnings: list[str]


def _check(tolerance: Tolerance) -> None:
    if not isinstance(tolerance, Tolerance):
        raise InputError(
            f"the tolerance is {tolerance!r:.60}", hint="give kilter.Tolerance(gap=...)"
        )
    named = ("gap", tolerance.gap), ("angle", tolerance.angle), ("clearance", tolerance.clearance)
    for name, value in named:
        if value is not None and not (np.isfinite(value) and value > 0):
            what = name if name == "clearance" else f"{name} tolerance"
            raise InputError(f"the {what} is {value}", hint="give a number above zero")


def _pairs_to_detect(assembly: Assembly, boxes: Boxes, tolerance: Tolerance) -> Index:
    """Pairs of parts that come near, without those whose contacts are given."""
    geometry = assembly.geometry
    if not assembly.detect:
        return np.empty((0, 2), dtype=np.int64)
    rough = np.maximum(tolerance.relative_gap * geometry.size, 4 * geometry.accuracy)
    if tolerance.gap is not None:
        rough = np.full(len(rough), tolerance.gap)
    reach = np.maximum(NEAR * rough / 2, CLUSTER * (tolerance.clearance or 0.0))
    pairs = part_pairs(boxes, geometry.grounded, reach)
    given = {
        frozenset(assembly.index_of(n) for n in contact.parts) for contact in assembly.contacts
    }
    if given:
        keep = [frozenset(pair) not in given for pair in pairs.tolist()]
        pairs = pairs[np.array(keep, dtype=bool)]
    return pairs


def _limits(geometry: Geometry, facets: Facets, pairs: Index, tolerance: Tolerance) -> _Limits:
    a, b = pairs.T
    surface = np.bincount(facets.part, weights=facets.area, minlength=len(geometry.mass))
    thickness = 2 * geometry.volume / surface
    blur = 2 * (geometry.accuracy[a] + geometry.accuracy[b])
    if tolerance.gap is not None:
        gap = np.full(len(pairs), tolerance.gap)
        wanted = gap
    else:
        wanted = tolerance.relative_gap * np.minimum(geometry.size[a], geometry.size[b])
        gap = np.minimum(wanted, THICKNESS * np.minimum(thickness[a], thickness[b]))
        gap = np.maximum(gap, blur)
    closed = np.maximum(gap, tolerance.clearance or 0.0)
    return _Limits(
        gap=gap,
        closed=closed,
        margin=np.maximum(NEAR * wanted, np.maximum(gap, CLUSTER * (tolerance.clearance or 0.0))),
        blur=blur,
        coarse=blur > THICKNESS * np.minimum(thickness[a], thickness[b]),
    )


def _planar(
    geometry: Geometry,
    facets: Facets,
    boxes: Boxes,
    pairs: Index,
    limits: _Limits,
    tolerance: Tolerance,
    curved: CurvedContacts,
) -> _Found:
    """Patches of the faces that touch, and what came near."""
    widest = max(NEAR_ANGLE, 2 * tolerance.angle)
    pair, i, j = facet_pairs(facets, boxes, pairs, limits.margin, float(np.cos(widest)))
    flat = ~(facets.curved[i] | facets.curved[j])
    pair, i, j = pair[flat], i[flat], j[flat]
    frames = facet_frames(facets, pair, i, j, limits.margin[pair])
    blocks = overlaps_of(geometry, facets, frames)
    angle = tolerance.angle + _angle_blur(geometry, facets, frames)
    accepted, refused, counts = [], [], np.zeros(len(GAP_EDGES) - 1, dtype=np.int64)
    for block in blocks:
        pair_of = frames.pair[block.frame]
        limit = limits.gap[pair_of]
        opposed = frames.angle[block.frame] <= angle[block.frame]
        touch = opposed & (block.gap[:, 0] <= limits.closed[pair_of])
        touch &= block.gap[:, 1] >= -limit
        accepted.append(block.take(np.flatnonzero(touch)))
        refused.append(block.take(np.flatnonzero(~touch)))
        size = np.minimum(
            geometry.size[facets.part[frames.i]], geometry.size[facets.part[frames.j]]
        )
        # gap nearest to zero over the piece; a cut of no width has none
        nearest = np.where(block.gap[:, 0] > 0, block.gap[:, 0], np.minimum(block.gap[:, 1], 0))
        wide = block.area > limit * np.sqrt(block.area)
        relative = (nearest / size[block.frame])[wide & opposed]
        counts += np.histogram(relative, bins=GAP_EDGES)[0]
    patches, thin = merge(frames, accepted, limits.gap, limits.blur)
    rejected = _rejected(facets, frames, refused, limits, angle, "")
    rejected += _rejected(
        facets, frames, thin, limits, angle, "thinner than twice the gap tolerance"
    )
    rejected += curved.rejected
    rejected.sort(key=lambda r: (abs(r.gap), r.angle))
    return _Found(
        touching=Touching(pairs, limits.gap, patches, without_repeats(curved, patches, limits.gap)),
        frames=frames,
        facets=facets,
        rejected=rejected[:LISTED],
        counts=counts,
        warnings=[
            *tolerance_warnings(patches, rejected, limits.gap, limits.closed),
            *_coarse(limits),
            *curved.warnings,
        ],
    )


def _angle_blur(geometry: Geometry, facets: Facets, frames: FacetFrame) -> Array:
    """Error of the angle between two facets that rounding of the coordinates explains [rad]."""
    blur = np.zeros(len(frames.i))
    for facet in (frames.i, frames.j):
        part = facets.part[facet]
        width = facets.area[facet] / facets.reach[facet]
        blur += np.where(geometry.single[part], 4 * geometry.accuracy[part] / width, 0.0)
    return np.minimum(blur, 0.05)


def _rejected(
    facets: Facets,
    frames: FacetFrame,
    blocks: list[Pieces],
    limits: _Limits,
    angle: Array,
    why: str,
) -> list[Rejected]:
    """The nearest rejected piece of each pair of parts and reason."""
    nearest: dict[tuple[int, str], Rejected] = {}
    for block in blocks:
        row = block.frame
        pair = frames.pair[row]
        gap = np.where(block.gap[:, 0] > 0, block.gap[:, 0], np.minimum(block.gap[:, 1], 0))
        wide = (block.area > (2 * limits.gap[pair]) ** 2) & (np.abs(gap) <= limits.margin[pair])
        for k in np.flatnonzero(wide | bool(why)):
            tilted = frames.angle[row[k]] > angle[row[k]]
            reason = why or (
                "tilted by more than the angle tolerance"
                if tilted
                else "gap above the tolerance"
                if gap[k] > 0
                else "penetrates by more than the gap tolerance"
            )
            a, b = facets.part[frames.i[row[k]]], facets.part[frames.j[row[k]]]
            entry = Rejected((int(a), int(b)), float(gap[k]), float(frames.angle[row[k]]), reason)
            key = (int(pair[k]), reason)
            if key not in nearest or abs(entry.gap) < abs(nearest[key].gap):
                nearest[key] = entry
    return list(nearest.values())


def _coarse(limits: _Limits) -> list[str]:
    """A word where rounding is not small against a part's thickness."""
    if not limits.coarse.any():
        return []
    return [
        "coordinates are too coarse for the thinnest parts: "
        f"{int(limits.coarse.sum())} pairs have rounding above a tenth of a part's thickness"
    ]


def _contact_set(
    assembly: Assembly,
    found: _Found,
    limits: _Limits,
    near: NearContacts,
    overlaps: tuple[Overlap, ...],
    warnings: list[str],
    tolerance: Tolerance,
) -> ContactSet:
    """Detected and given contacts as one, with their friction."""
    geometry, patches = assembly.geometry, found.touching.patches
    touching, curved = found.touching, found.touching.curved
    facets, frames = found.facets, found.frames
    facet = np.column_stack([frames.i, frames.j])[patches.frame]
    parts = facets.part[facet]
    width = (facets.area[facet] / facets.reach[facet]).min(axis=1)
    accuracy = geometry.accuracy[parts].sum(axis=1) / width if len(parts) else np.empty(0)
    rims = rim_contacts(geometry, parts, patches.normal, patches.start, patches.points)
    given, touches = assembly.contacts, near.touches
    given_parts = np.array([[assembly.index_of(n) for n in c.parts] for c in given], dtype=np.int64)
    counts = [np.diff(found.start) for found in (patches, curved, touches)]
    counts.append(np.array([len(c.points) for c in given], dtype=np.int64))
    parts = np.concatenate(
        [
            parts,
            touching.pairs[curved.pair],
            touching.pairs[touches.pair],
            given_parts.reshape(-1, 2),
        ]
    )
    given_normal = np.array([c.normal for c in given]).reshape(-1, 3)
    first = np.repeat(patches.normal, counts[0], axis=0)
    last = np.repeat(given_normal, counts[3], axis=0)
    none = np.zeros(len(given))
    kinds = [
        *(["plane"] * len(patches.pair)),
        *curved.kind.tolist(),
        *touches.kind.tolist(),
        *(["given"] * len(given)),
    ]
    return ContactSet(
        assembly=assembly,
        patch_parts=parts,
        patch_normal=np.concatenate(
            [patches.normal, curved.normal, touches.normals[touches.start[:-1]], given_normal]
        ),
        patch_area=np.concatenate([patches.area, curved.area, np.zeros(len(touches.pair)), none]),
        patch_gap=np.concatenate([patches.gap, curved.gap, touches.gap, np.zeros((len(given), 2))]),
        patch_mu=_friction(assembly, parts, [c.mu for c in given]),
        patch_kind=np.array(kinds, dtype="<U11"),
        patch_accuracy=np.concatenate([accuracy, curved.accuracy, touches.accuracy, none]),
        patch_start=np.concatenate([[0], np.cumsum(np.concatenate(counts))]),
        points=np.concatenate(
            [patches.points, curved.points, touches.points, *(c.points for c in given)]
        ),
        normals=np.concatenate([first, curved.normals, touches.normals, last]),
        unsupported=near.unsupported,
        possible=_with_friction(
            assembly, PossibleContacts.join([near.possible, rims, curved.possible])
        ),
        rejected=tuple(found.rejected),
        overlaps=overlaps,
        gap_edges=GAP_EDGES,
        gap_counts=found.counts,
        tolerance=tolerance,
        gap=float(limits.gap.max(initial=0.0)),
        warnings=(
            *found.warnings,
            *closed_by_clearance(assembly, found.touching, limits.gap),
            *warnings,
        ),
        degenerate=near.degenerate,
    )


def _with_friction(assembly: Assembly, possible: PossibleContacts) -> PossibleContacts:
    """The possible contacts with the friction coefficients of their pairs."""
    parts = np.column_stack([possible.part_a, possible.part_b])
    return dataclasses.replace(possible, mu=_friction(assembly, parts, []))


def _friction(assembly: Assembly, parts: Index, own: list[float | None]) -> Array:
    """Friction coefficient of each patch: its own, else the pair's, else the assembly's."""
    mu = np.full(len(parts), assembly.friction)
    if assembly.friction_pairs:
        by_pair = {
            frozenset(assembly.index_of(n) for n in entry.parts): entry.mu
            for entry in assembly.friction_pairs
        }
        for k, pair in enumerate(parts.tolist()):
            mu[k] = by_pair.get(frozenset(pair), mu[k])
    for k, value in enumerate(own, start=len(parts) - len(own)):
        if value is not None:
            mu[k] = value
    return mu
