"""ContactSet: what touches, as arrays, one row a patch and one row a contact point.

A contact point p is (a, b, x, n, mu): parts a and b, position x, unit normal n from a to b.
The points of a patch are the corners of the convex hull of the area of contact in its
plane: every pressure inside the patch is a sum of forces at those corners (the paper,
section 2.1 and Figure 3), so nothing is lost for the equilibrium of rigid parts.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from kilter.arrays import (
    TINY,
    Array,
    Index,
    Labels,
    Mask,
    across,
    read_only,
    unit_rows,
)
from kilter.assembly import Assembly
from kilter.contact.contact_tolerances import MEAN_NORMAL
from kilter.contact.fits.coaxial import Fit
from kilter.contact.fits.copies import odd_copies
from kilter.contact.friction_coefficients import certain_friction
from kilter.contact.gaps import Rejected, Tolerance, nearest_gap
from kilter.contact.left_out import INTERFERE, SAME_BODY, Overlap, PossibleContacts, Unsupported
from kilter.contact.neighbours import Neighbour
from kilter.contact.open_pairs import OpenPair, still_open
from kilter.tell.contact_words import copy_warnings, overlap_warnings

__all__ = [
    "INTERFERE",
    "SAME_BODY",
    "ContactSet",
    "Degenerate",
    "Overlap",
    "PossibleContacts",
    "Unsupported",
]


LISTED = 1000
"""Rejected pairs that an answer lists, nearest first."""


@dataclass(frozen=True, slots=True, eq=False)
class Degenerate:
    """Points of contact without one normal: a ridge on a ridge, a corner on an edge.

    A motion is allowed at point k where its opening along at least one of the point's
    normals is not below zero.

    Attributes
    ----------
    part_a, part_b : ndarray of int, shape (n,)
    points : ndarray, shape (n, 3)
    start, normals : ndarray, shape (n + 1,) and (m, 3)
        Extreme normals of the cone of planes that separate the parts at point k, unit, from
        a to b: rows ``start[k]`` to ``start[k + 1]``.
    exact : ndarray of bool, shape (n,)
        False where the parts meet like this only within tolerance: coordinates taken at
        their word might give a normal.
    held_parts, held_points, held_normals : ndarray, shape (h, 2), (h, 3) and (h, 3)
        Points of the same pairs of parts that have a normal, also those that a patch holds:
        lines of degenerate points may end there.
    """

    part_a: Index
    part_b: Index
    points: Array
    start: Index
    normals: Array
    exact: Mask
    held_parts: Index
    held_points: Array
    held_normals: Array

    def __post_init__(self) -> None:
        read_only(self)

    def __len__(self) -> int:
        return len(self.part_a)

    @classmethod
    def none(cls) -> Degenerate:
        """No such point."""
        empty, index = np.empty((0, 3)), np.empty(0, dtype=np.int64)
        no, pairs = np.empty(0, dtype=bool), np.empty((0, 2), dtype=np.int64)
        return cls(index, index, empty, np.zeros(1, np.int64), empty, no, pairs, empty, empty)

    @property
    def owner(self) -> Index:
        """The point of each normal, shape (m,)."""
        return np.repeat(np.arange(len(self)), np.diff(self.start))

    @property
    def centers(self) -> Array:
        """The centre of each point's cone of normals: the paper's planar approximation, (n, 3).

        The bisector of two; of more, the centroid of the polygon that they span on the
        sphere, sum of angle(m, n) (m x n) / |m x n| / 2 over its sides.

        References
        ----------
        The paper, section 2.1, Figure 3 (d).
        """
        centers = np.zeros((len(self), 3))
        for k in range(len(self)):
            centers[k] = _center(self.normals[self.start[k] : self.start[k + 1]])
        return centers

    def pushes(self) -> PossibleContacts:
        """A push along every normal."""
        owner = self.owner
        none = np.zeros(len(owner))
        return PossibleContacts(
            self.part_a[owner],
            self.part_b[owner],
            self.points[owner],
            self.normals,
            none > 0,
            none,
            owner,
        )


def _center(normals: Array) -> Array:
    """The centre of the convex cone that unit normals span, unit."""
    mean = unit_rows(normals.sum(axis=0))
    if len(normals) > 2:
        u, v = across(mean)
        order = np.argsort(np.arctan2(normals @ v, normals @ u))
        around = normals[order]
        following = np.roll(around, -1, axis=0)
        turns = np.cross(around, following)
        sine = np.linalg.norm(turns, axis=1)
        angle = np.arctan2(sine, np.einsum("ij,ij->i", around, following))
        total = (angle / np.maximum(sine, TINY)) @ turns
        size = float(np.linalg.norm(total))
        if size > MEAN_NORMAL:
            mean = total / size
    return mean


@dataclass(frozen=True, slots=True, eq=False)
class ContactSet:
    """Contact patches between parts, struct of arrays; world frame, length unit of the file.

    All arrays are read-only.

    Attributes
    ----------
    assembly : Assembly
        Of which these are the contacts: its names and units.
    patch_parts : ndarray of int, shape (P, 2)
        Parts a and b of each patch, by position in the assembly.
    patch_normal : ndarray, shape (P, 3)
        Unit normal from a to b; of a curved patch, the mean of those of its points.
    patch_area : ndarray, shape (P,)
        Area of contact [length unit^2] (not of its hull); 0 for edges, corners and given
        contacts.
    patch_gap : ndarray, shape (P, 2)
        Least and greatest gap over the patch [length unit]; negative = penetration.
    patch_mu : ndarray, shape (P,)
        Friction coefficient [-]; less `patch_doubt`, so that its forces are certain.
    patch_kind : ndarray of str, shape (P,)
        "plane", "edge-edge", "edge-face", "vertex-face", "cylinder", "sphere", "cone", "torus",
        "smooth" (fitted faces of meshes), "given" for contacts listed in the file, or "bond" for
        points of a bond.
    patch_accuracy : ndarray, shape (P,)
        Accuracy of the coordinates over the size of the patch [-].
    patch_doubt : ndarray, shape (P,)
        How far the normals may be off that a fit gave; 0 for those of faces [rad].
    patch_start : ndarray of int, shape (P + 1,)
        The points of patch p are rows ``patch_start[p]`` to ``patch_start[p + 1]``.
    points : ndarray, shape (K, 3)
        Contact points [length unit].
    normals : ndarray, shape (K, 3)
        Unit normal from a to b at each point; that of its patch where the patch is flat.
    unsupported : tuple of Unsupported
    possible : PossibleContacts
        Also the normals of `degenerate`, by number of their point.
    rejected : tuple of Rejected
    overlaps : tuple of Overlap
    gap_edges, gap_counts : ndarray, shape (n + 1,) and (n,)
        Histogram of the gaps of opposing faces over the size of the smaller part.
    tolerance : Tolerance
    gap : float
        The largest gap tolerance that was applied to a pair [length unit].
    warnings : tuple of str
    degenerate : Degenerate
        Points of contact without one normal; also listed in `unsupported`.
    open_pairs : tuple of OpenPair
        Pairs that the geometry leaves open; what they could bring is in `possible`.
    neighbours : tuple of Neighbour
        What comes nearest to parts that touch nothing.
    fits : tuple of Fit
        Shafts in holes: tight, size on size, or with a clearance.
    """

    assembly: Assembly
    patch_parts: Index
    patch_normal: Array
    patch_area: Array
    patch_gap: Array
    patch_mu: Array
    patch_kind: Labels
    patch_accuracy: Array
    patch_doubt: Array
    patch_start: Index
    points: Array
    normals: Array
    unsupported: tuple[Unsupported, ...]
    possible: PossibleContacts
    rejected: tuple[Rejected, ...]
    overlaps: tuple[Overlap, ...]
    gap_edges: Array
    gap_counts: Index
    tolerance: Tolerance
    gap: float
    warnings: tuple[str, ...]
    degenerate: Degenerate = field(default_factory=Degenerate.none)
    open_pairs: tuple[OpenPair, ...] = ()
    neighbours: tuple[Neighbour, ...] = ()
    fits: tuple[Fit, ...] = ()

    def __post_init__(self) -> None:
        read_only(self)
        left = still_open(self.open_pairs, self.assembly)
        if len(left) < len(self.open_pairs):  # parts were joined since
            gone = {frozenset(one.parts) for one in self.open_pairs if one not in left}
            object.__setattr__(self, "possible", self.possible.without_wrenches(gone))
            object.__setattr__(self, "open_pairs", left)

    def __len__(self) -> int:
        return len(self.patch_area)

    def __repr__(self) -> str:
        counts = {
            "patches": len(self),
            "points": len(self.points),
            "pairs": self.pairs,
            "not modelled": len(self.unsupported),
            "overlapping": len(self.overlaps),
            "left open": len(self.open_pairs),
        }
        words = ", ".join(f"{what} {count}" for what, count in counts.items() if count)
        return f"<ContactSet: {words or 'nothing touches'}>"

    @property
    def approximate(self) -> PossibleContacts:
        """The paper's planar approximation: a push at each degenerate point.

        It is along the centre of the cone of normals there (section 2.1, Figure 3 (d)).
        """
        points = self.degenerate
        none = np.zeros(len(points))
        return PossibleContacts(
            points.part_a, points.part_b, points.points, points.centers, none > 0, none,
            np.arange(len(points)),
        )  # fmt: skip

    @property
    def point_patch(self) -> Index:
        """The patch of each point, shape (K,)."""
        return np.repeat(np.arange(len(self)), np.diff(self.patch_start))

    @property
    def patch_bond(self) -> Index:
        """The bond that holds each patch, by position in the assembly; -1 for none, shape (P,)."""
        bonds = self.assembly.bonds
        if not bonds:
            return np.full(len(self), -1)
        own = self.patch_kind == "bond"
        index = self.assembly.index
        of_pair = {
            frozenset(index[name] for name in bond.parts): k
            for k, bond in enumerate(bonds)
            if bond.points is None
        }
        pairs = self.patch_parts.tolist()
        found = np.array([of_pair.get(frozenset(pair), -1) for pair in pairs], dtype=np.int64)
        found[own] = [k for k, bond in enumerate(bonds) if bond.points is not None]
        return found

    @property
    def patch_pull(self) -> Array:
        """The pull that each patch's bond takes in all its points [N], shape (P,); NaN of none."""
        bonds, bond = self.assembly.bonds, self.patch_bond
        pull = np.array([one.pull or 0.0 for one in bonds] + [np.nan])[bond]
        stress = np.array([one.pull_per_area or 0.0 for one in bonds] + [np.nan])[bond]
        return pull * np.diff(self.patch_start) + stress * self.patch_area

    @property
    def counted_gap(self) -> float | None:
        """The widest gap of a patch that only a widened tolerance takes for contact.

        None where every patch would count by the default tolerance too.
        """
        given, usual = self.tolerance, Tolerance()
        if given == usual or not len(self):
            return None
        geometry = self.assembly.geometry
        parts = self.patch_parts
        limit = usual.gap_of(geometry.size[parts].min(axis=1))
        limit = np.maximum(limit, 2 * geometry.accuracy[parts].sum(axis=1))
        spread = self.patch_gap[:, 1] - self.patch_gap[:, 0]
        tilted = spread > 2 * usual.angle * np.sqrt(self.patch_area) + limit
        wide = (np.abs(nearest_gap(self.patch_gap)) > limit) | tilted
        return float(np.abs(self.patch_gap[wide]).max()) if wide.any() else None

    @property
    def pairs(self) -> int:
        """How many pairs of parts touch."""
        if not len(self):
            return 0
        return len(np.unique(np.sort(self.patch_parts, axis=1), axis=0))

    def of(self, assembly: Assembly) -> ContactSet:
        """The same contacts of an assembly of the same parts, joined or held in another way."""
        return self if assembly is self.assembly else replace(self, assembly=assembly)

    def with_friction(self, mu: float) -> ContactSet:
        """The same contacts with one friction coefficient, less the doubt of their normals."""
        return replace(self, patch_mu=certain_friction(mu, self.patch_doubt))

    @property
    def alone(self) -> Index:
        """Parts that touch nothing, overlap nothing and are joined to nothing."""
        index = self.assembly.index
        touched = np.zeros(len(self.assembly.parts), dtype=bool)
        touched[self.patch_parts.ravel()] = True
        pairs = [one.parts for one in self.unsupported] + [one.parts for one in self.overlaps]
        touched[np.array(pairs, dtype=np.int64).ravel()] = True
        joined = [name for joint in self.assembly.joints for name in joint.parts]
        touched[[index[name] for name in joined if name in index]] = True
        return np.flatnonzero(~touched)

    def nearest(self) -> list[dict[str, Any]]:
        """What comes nearest to each part that touches nothing, as JSON data of an answer."""
        known = {one.part: one for one in self.neighbours}
        names, held = self.assembly.names, self.assembly.geometry.grounded
        none = {"nearest": None, "gap": None, "accuracy": None}
        return [
            (known[k].to_dict(names) if k in known else {"part": names[k], **none})
            | {"grounded": bool(held[k])}
            for k in self.alone.tolist()
        ]

    def to_dict(self) -> dict[str, Any]:
        """As JSON data: the answer of ``kilter contacts --json``."""
        assembly = self.assembly
        sizes = assembly.geometry.size
        return {
            "units": assembly.units,
            "patches": [self._patch(k, pull) for k, pull in enumerate(self.patch_pull.tolist())],
            "unsupported": [
                {"parts": self._names(u.parts), "kind": u.kind, "point": list(u.point)}
                for u in self.unsupported
            ],
            "rejected": [
                {
                    "parts": self._names(r.parts),
                    "gap": r.gap,
                    "angle_deg": float(np.degrees(r.angle)),
                    "why": r.why,
                }
                for r in self.rejected[:LISTED]
            ],
            "overlaps": [self._overlap(one) for one in self.overlaps],
            "open_pairs": [one.to_dict(assembly.names) for one in self.open_pairs],
            "nearest": self.nearest(),
            "fits": [one.to_dict(assembly.names) for one in self.fits],
            "joints": assembly.joints_data(),
            "sizes": [float(sizes.min()), float(sizes.max())],
            "histogram": {
                "edges": [float(e) if np.isfinite(e) else None for e in self.gap_edges],
                "counts": self.gap_counts.tolist(),
            },
            "tolerance": {
                "gap": self.gap,
                "angle_deg": float(np.degrees(self.tolerance.angle)),
                "clearance": self.tolerance.clearance,
            },
            "warnings": self.remarks(),
        }

    def remarks(self) -> list[str]:
        """Remarks of the reader, of the geometry and of the contacts, in words."""
        left_open = {frozenset(one.parts) for one in self.open_pairs}
        over = [one for one in self.overlaps if frozenset(one.parts) in left_open]
        assembly = self.assembly
        odd = [
            (assembly.names[part], self._names(others), assembly.names[copy])
            for part, others, copy in odd_copies(assembly.geometry, self.overlaps, over)
        ]
        return [
            *assembly.notes,
            *assembly.geometry.warnings,
            *self.warnings,
            *overlap_warnings([self._overlap(one) for one in over], assembly.units),
            *copy_warnings(odd),
        ]

    def _overlap(self, one: Overlap) -> dict[str, Any]:
        sizes = {"volume": one.volume, "depth": one.depth, "share": one.share}
        return {"parts": self._names(one.parts), **sizes, "why": one.why}

    def _names(self, parts: Any) -> list[str]:
        return [self.assembly.names[k] for k in parts]

    def _patch(self, k: int, pull: float) -> dict[str, Any]:
        gap = self.patch_gap[k]
        return {
            "parts": self._names(self.patch_parts[k]),
            "kind": str(self.patch_kind[k]),
            "area": float(self.patch_area[k]),
            "gap": float(gap[np.abs(gap).argmax()]),
            "gap_range": gap.tolist(),
            "normal": self.patch_normal[k].tolist(),
            "mu": float(self.patch_mu[k]),
            "pull": None if np.isnan(pull) else pull,
            "points": self.points[self.patch_start[k] : self.patch_start[k + 1]].tolist(),
        }
