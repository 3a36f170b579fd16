"""Patches that a search has found, and which points they explain: nothing else touches there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, Mask, cross, ragged, ratio
from kilter.contact.contact_search import ContactSearch
from kilter.contact.contact_tolerances import BESIDE, BESIDE_CIRCLE, NORMAL_SNAP
from kilter.contact.curved.curved_patches import CurvedContacts, on_flat
from kilter.contact.patches import Patches
from kilter.contact.smooth.smooth_joints import SmoothJoints

__all__ = ["Touching", "explained", "in_patch", "on_patches"]


@dataclass(frozen=True, slots=True, eq=False)
class Touching:
    """A search with its smooth joints, and patches of flat and of curved faces by pair."""

    search: ContactSearch
    flat: Patches
    curved: CurvedContacts
    smooth: SmoothJoints

    @property
    def has_patch(self) -> Mask:
        """Whether each pair has a patch, flat or curved, shape (n,)."""
        found = np.zeros(len(self.search.pairs), dtype=bool)
        found[self.flat.pair] = True
        found[self.curved.patches.pair] = True
        found[[joint.pair for joint in self.smooth.joints]] = True
        return found


def explained(touching: Touching, pair: int, points: Array, slack: float) -> Mask:
    """Points, shape (n, 3), where patches of a pair, to within `slack`, say what touches."""
    held = np.zeros(len(points), dtype=bool)
    for patch in touching.curved.patches.of_pair(pair):
        held |= _on_curved(touching, patch, points, slack)
    flat = touching.flat
    for patch in flat.of_pair(pair):
        held |= on_flat(points, flat.corners(patch), flat.normal[patch], slack)
    return held


def in_patch(touching: Touching, pair: int, points: Array, slack: float) -> Mask:
    """Points, shape (n, 3), on a curved face of a pair that touches all over."""
    held = touching.smooth.explains(np.full(len(points), pair), points)
    patches = touching.curved.patches
    for patch in patches.of_pair(pair):
        if patches.area[patch] > 0:
            held |= _on_curved(touching, patch, points, slack)
    return held


def _on_curved(touching: Touching, patch: int, points: Array, slack: float) -> Mask:
    curved = touching.curved
    corners = curved.patches.corners(patch)
    zone = max(float(curved.zone[patch]), slack)
    if curved.patches.area[patch] > 0:
        rows = np.full(len(points), curved.surface[patch].max())
        size = float(np.ptp(corners, axis=0).max())
        low, high = corners.min(axis=0) - BESIDE * size, corners.max(axis=0) + BESIDE * size
        surfaces = touching.search.geometry.surfaces
        near: Mask = np.abs(surfaces.distance(rows, points)) <= slack
        near &= ((points >= low) & (points <= high)).all(axis=1)
        return near
    if len(corners) > 2:  # a circle
        zone += BESIDE_CIRCLE * float(np.ptp(corners, axis=0).max())
    following = np.roll(corners, -1, axis=0)
    step = following - corners
    t = np.einsum("nki,ki->nk", points[:, None] - corners, step)
    t = np.clip(ratio(t, (step**2).sum(axis=1)), 0, 1)
    foot = corners + t[..., None] * step
    beside: Mask = np.linalg.norm(points[:, None] - foot, axis=2).min(axis=1) <= zone
    return beside


def on_patches(touching: Touching, pair: Index, points: Array, normal: Array) -> Mask:
    """Which points with a normal lie on a flat patch of their pair with that normal."""
    patches, limits = touching.flat, touching.search.limits
    start = np.searchsorted(patches.pair, np.arange(len(limits) + 1))
    owner, patch = ragged(start, pair)
    near = np.linalg.norm(patches.normal[patch] - normal[owner], axis=1) <= NORMAL_SNAP
    owner, patch = owner[near], patch[near]
    which, corner = ragged(patches.start, patch)
    following = corner + 1
    last = following == patches.start[patch + 1][which]
    following[last] = patches.start[patch][which[last]]
    tolerance = 2 * limits.gap[patches.pair[patch]]
    p = points[owner]
    level = (p - patches.points[patches.start[patch]]) * patches.normal[patch]
    inside = np.abs(level.sum(axis=1)) <= tolerance + np.abs(patches.gap[patch]).max(axis=1)
    along = patches.points[following] - patches.points[corner]
    arm = cross(along, p[which] - patches.points[corner])
    arm = ratio(arm, np.linalg.norm(along, axis=1)[:, None])
    side = np.einsum("ij,ij->i", arm, patches.normal[patch][which])
    # corners may turn either way: within the hull all sides have one sign
    outside = np.zeros((len(patch), 2), dtype=bool)
    for k, sign in enumerate((1.0, -1.0)):
        outside[which[sign * side < -tolerance[which]], k] = True
    held = np.zeros(len(points), dtype=bool)
    held[owner[inside & ~outside.all(axis=1)]] = True
    return held
