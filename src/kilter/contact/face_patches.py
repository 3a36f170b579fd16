"""Patches of the faces of a search, and tests of points for lying on them.

Near an explained point no further contact of the pair is searched for.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, Mask, cross, ragged, ratio
from kilter.contact.common.contact_search import ContactSearch
from kilter.contact.common.patches import Patches
from kilter.contact.contact_tolerances import BESIDE, BESIDE_CIRCLE, NORMAL_SNAP
from kilter.contact.curved.curved_patches import CurvedContacts, on_flat
from kilter.contact.smooth.smooth_joints import SmoothJoints

__all__ = ["FacePatches", "explained", "in_patch", "on_patches"]


@dataclass(frozen=True, slots=True, eq=False)
class FacePatches:
    """A contact search with the patches of its flat, curved and smooth faces, ordered by pair."""

    search: ContactSearch
    flat: Patches
    curved: CurvedContacts
    smooth: SmoothJoints

    @property
    def has_patch(self) -> Mask:
        """Whether each pair of parts has a contact patch of any kind, shape (n,)."""
        is_covered = np.zeros(len(self.search.pairs), dtype=bool)
        is_covered[self.flat.pair] = True
        is_covered[self.curved.patches.pair] = True
        is_covered[[joint.pair for joint in self.smooth.joints]] = True
        return is_covered


def explained(face_patches: FacePatches, pair: int, points: Array, slack: float) -> Mask:
    """Mask of points, shape (n, 3), within `slack` of a flat or curved patch of a pair."""
    is_explained = np.zeros(len(points), dtype=bool)
    for patch in face_patches.curved.patches.of_pair(pair):
        is_explained |= _on_curved_patch(face_patches, patch, points, slack)
    flat = face_patches.flat
    for patch in flat.of_pair(pair):
        is_explained |= on_flat(points, flat.corners(patch), flat.normal[patch], slack)
    return is_explained


def in_patch(face_patches: FacePatches, pair: int, points: Array, slack: float) -> Mask:
    """Mask of points, shape (n, 3), on a curved face of a pair that touches over an area."""
    is_in_patch = face_patches.smooth.explains(np.full(len(points), pair), points)
    patches = face_patches.curved.patches
    for patch in patches.of_pair(pair):
        if patches.area[patch] > 0:
            is_in_patch |= _on_curved_patch(face_patches, patch, points, slack)
    return is_in_patch


def _on_curved_patch(face_patches: FacePatches, patch: int, points: Array, slack: float) -> Mask:
    """Mask of points, shape (n, 3), within `slack` of a given curved patch."""
    curved = face_patches.curved
    corners = curved.patches.corners(patch)
    zone = max(float(curved.zone[patch]), slack)
    if curved.patches.area[patch] > 0:  # an area: points of the surface near the patch
        rows = np.full(len(points), curved.surface[patch].max())
        size = float(np.ptp(corners, axis=0).max())
        low, high = corners.min(axis=0) - BESIDE * size, corners.max(axis=0) + BESIDE * size
        surfaces = face_patches.search.geometry.surfaces
        near: Mask = np.abs(surfaces.distance(rows, points)) <= slack
        near &= ((points >= low) & (points <= high)).all(axis=1)
        return near
    if len(corners) > 2:  # a circle, given by chords
        zone += BESIDE_CIRCLE * float(np.ptp(corners, axis=0).max())
    # a point, line or circle: distance from the segments between successive points
    following = np.roll(corners, -1, axis=0)
    step = following - corners
    t = np.einsum("nki,ki->nk", points[:, None] - corners, step)
    t = np.clip(ratio(t, (step**2).sum(axis=1)), 0, 1)
    foot = corners + t[..., None] * step
    beside: Mask = np.linalg.norm(points[:, None] - foot, axis=2).min(axis=1) <= zone
    return beside


def on_patches(face_patches: FacePatches, pair: Index, points: Array, normal: Array) -> Mask:
    """Mask of points on a flat patch of their pair that has the same normal, shape (n,).

    Parameters
    ----------
    face_patches : FacePatches
    pair : ndarray of int, shape (n,)
        Row of the pair of each point.
    points, normal : ndarray, shape (n, 3)
        Points with their unit normals, from a to b.
    """
    patches, limits = face_patches.flat, face_patches.search.limits
    start = np.searchsorted(patches.pair, np.arange(len(limits) + 1))
    owner, patch = ragged(start, pair)
    near = np.linalg.norm(patches.normal[patch] - normal[owner], axis=1) <= NORMAL_SNAP
    owner, patch = owner[near], patch[near]
    patch_of_corner, corner = ragged(patches.start, patch)
    following = corner + 1
    last = following == patches.start[patch + 1][patch_of_corner]
    following[last] = patches.start[patch][patch_of_corner[last]]
    tolerance = 2 * limits.gap[patches.pair[patch]]
    p = points[owner]
    level = (p - patches.points[patches.start[patch]]) * patches.normal[patch]
    inside = np.abs(level.sum(axis=1)) <= tolerance + np.abs(patches.gap[patch]).max(axis=1)
    along = patches.points[following] - patches.points[corner]
    arm = cross(along, p[patch_of_corner] - patches.points[corner])
    arm = ratio(arm, np.linalg.norm(along, axis=1)[:, None])
    side = np.einsum("ij,ij->i", arm, patches.normal[patch][patch_of_corner])
    # corners may run either way around: inside the hull all sides have the same sign
    outside = np.zeros((len(patch), 2), dtype=bool)
    for k, sign in enumerate((1.0, -1.0)):
        outside[patch_of_corner[sign * side < -tolerance[patch_of_corner]], k] = True
    is_on_patch = np.zeros(len(points), dtype=bool)
    is_on_patch[owner[inside & ~outside.all(axis=1)]] = True
    return is_on_patch
