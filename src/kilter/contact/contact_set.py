"""ContactSet: the contacts of an assembly as arrays, by patch and by contact point.

A contact point p is (a, b, x, n, mu): parts a and b, position x, unit normal n from a to b.
The points of a patch are the corners of the convex hull of the area of contact in its
plane: every pressure inside the patch is a sum of forces at those corners (the paper,
section 2.1 and Figure 3), so nothing is lost for the equilibrium of rigid parts.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import field, replace
from functools import cached_property
from typing import Annotated, Any, ClassVar

import numpy as np

from kilter.arrays import (
    Array,
    Index,
    Labels,
    read_only,
)
from kilter.assembly import Assembly, ListedJoint
from kilter.assembly.assumption import Body
from kilter.assembly.interactions import GivenContact
from kilter.contact.common.distances import LonePart, Neighbour
from kilter.contact.common.gaps import RejectedPair, Tolerance, joints_beyond, nearest_gap
from kilter.contact.common.patches import (
    INTERFERE,
    SAME_BODY,
    DegeneratePoints,
    Overlap,
    Patch,
    PossibleContacts,
    UnsupportedContact,
)
from kilter.contact.curved.coaxial_faces import Fit, odd_copies
from kilter.contact.friction_coefficients import certain_friction
from kilter.contact.open_pairs import OpenPair, still_open
from kilter.errors import InputError
from kilter.hooks import hook
from kilter.tell.contact_words import copy_warnings, overlap_warnings
from kilter.tell.record import AnswerInWords, InPython, Record, Shape, UnitWord, key

__all__ = [
    "INTERFERE",
    "SAME_BODY",
    "ContactSet",
    "Overlap",
    "PossibleContacts",
    "UnsupportedContact",
]


LISTED = 1000
"""Largest number of rejected pairs in an answer, nearest first."""


class GapHistogram(Record):
    """Numbers of gaps of opposing faces, relative to the size of the smaller part."""

    edges: Annotated[Array, Shape(None, infinite=True)]
    """Edges of the bins [-]; null for an infinite edge."""
    counts: Index
    """Number of gaps in each bin."""


class AppliedTolerance(Record):
    """Tolerances of contact detection."""

    gap: float
    """Largest gap tolerance that was applied to a pair [length unit]."""
    angle_deg: float
    """Angle tolerance [deg]."""
    clearance: float | None
    """Designed clearance [length unit]; null without one."""


class ContactSet(AnswerInWords):
    """Contact patches between parts; world frame, length unit of the file.

    All arrays are read-only. ``for patch in contacts`` yields each `kilter.Patch`.
    """

    answer: ClassVar[str] = "contacts"

    assembly: InPython[Assembly]
    """Assembly with these contacts; it has the names and units."""
    patch_parts: InPython[Index]
    """Parts a and b of each patch, by position in the assembly, shape (P, 2)."""
    patch_normal: InPython[Array]
    """Unit normal from a to b, shape (P, 3); on a curved patch the mean of its point normals."""
    patch_area: InPython[Array]
    """Area of contact [length unit^2], shape (P,), not the area of its hull; 0 for edges, corners
    and given contacts."""
    patch_gap: InPython[Array]
    """Least and greatest gap over the patch [length unit], shape (P, 2); negative = penetration."""
    patch_mu: InPython[Array]
    """Friction coefficient [-], shape (P,), reduced by `patch_doubt`, so that its forces are
    certain."""
    patch_kind: InPython[Labels]
    """Kind of each patch, shape (P,): "plane", "edge-edge", "edge-face", "vertex-face", "cylinder",
    "sphere", "cone", "torus", "smooth" (fitted faces of meshes), "given" for contacts listed in the
    file, or "bond" for points of a bond."""
    patch_accuracy: InPython[Array]
    """Accuracy of the coordinates divided by the size of the patch [-], shape (P,)."""
    patch_doubt: InPython[Array]
    """Largest error of fitted normals [rad], shape (P,); 0 for normals of faces."""
    patch_start: InPython[Index]
    """The points of patch p are rows ``patch_start[p]`` to ``patch_start[p + 1]``."""
    patch_pieces: InPython[Index]
    """Pieces of parts a and b that touch (`Mesh.pieces`), shape (P, 2); -1 for unknown pieces."""
    points: InPython[Array]
    """Contact points [length unit], shape (K, 3)."""
    normals: InPython[Array]
    """Unit normal from a to b at each point, shape (K, 3); on a flat patch that of the patch."""
    unsupported: tuple[UnsupportedContact, ...]
    """Pairs that touch in a way that is not modelled."""
    possible: InPython[PossibleContacts]
    """Forces that contacts outside the patches could exert, including forces along the normals of
    `degenerate` (by row of the point)."""
    near: InPython[tuple[RejectedPair, ...]]
    """Faces that come near but do not count as touching, nearest first."""
    overlaps: tuple[Overlap, ...]
    """Pairs of parts that share volume."""
    gap_edges: InPython[Array]
    """Edges of the histogram of gaps, relative to the size of the smaller part [-]."""
    gap_counts: InPython[Index]
    """Number of gaps between each pair of edges."""
    searched: InPython[Tolerance]
    """Tolerance of the search."""
    gap: InPython[float]
    """Largest gap tolerance that was applied to a pair [length unit]."""
    notes: InPython[tuple[str, ...]]
    """Warnings of the search."""
    degenerate: InPython[DegeneratePoints] = field(default_factory=DegeneratePoints.none)
    """Contact points without a unique normal; also listed in `unsupported`."""
    open_pairs: tuple[OpenPair, ...] = ()
    """Pairs whose contact the geometry leaves open; their largest forces are in `possible`."""
    neighbours: InPython[tuple[Neighbour, ...]] = ()
    """Nearest part of each part that touches nothing."""
    fits: tuple[Fit, ...] = ()
    """Shafts in holes: tight, size on size, or with a clearance."""

    def __post_init__(self) -> None:
        read_only(self)
        left = still_open(self.open_pairs, self.assembly)
        if len(left) < len(self.open_pairs):  # the assembly has joints that the search had not
            still = {frozenset(pair.ends) for pair in left}
            joined = {frozenset(pair.ends) for pair in self.open_pairs} - still
            object.__setattr__(self, "possible", self.possible.without_wrenches(joined))
            object.__setattr__(self, "open_pairs", left)

        for name in ("unsupported", "near", "overlaps", "open_pairs", "fits"):
            records = getattr(self, name)
            if records and records[0].names != self.assembly.names:
                named = tuple(replace(record, names=self.assembly.names) for record in records)
                object.__setattr__(self, name, named)

    def __len__(self) -> int:
        return len(self.patch_area)

    @cached_property
    def stated_features(self) -> dict[int, GivenContact]:
        """The given contact of each patch for which the file states features, by patch."""
        given = [contact for contact in self.assembly.contacts if len(contact.points)]
        patches = np.flatnonzero(self.patch_kind == "given").tolist()
        if len(patches) != len(given):  # the contacts are those of another assembly
            return {}
        pairs = zip(patches, given, strict=True)
        return {patch: contact for patch, contact in pairs if contact.feature is not None}

    def __iter__(self) -> Iterator[Patch]:
        return iter(self.patches)

    def __getitem__(self, k: int) -> Patch:
        if not -len(self) <= k < len(self):
            raise IndexError(f"there are {len(self)} patches")
        return self._patch(k % len(self), self.patch_pull)

    def _patch(self, k: int, pull: Array) -> Patch:
        """The patch with index k; `pull` are the largest tensions of all patches [N]."""
        names, (a, b) = self.assembly.names, self.patch_parts[k].tolist()
        rows = slice(self.patch_start[k], self.patch_start[k + 1])
        low, high = self.patch_gap[k].tolist()
        first, second = self.patch_pieces[k].tolist()
        return Patch(
            parts=(names[a], names[b]),
            kind=str(self.patch_kind[k]),
            area=float(self.patch_area[k]),
            gap_range=(low, high),
            normal=self.patch_normal[k],
            mu=float(self.patch_mu[k]),
            pieces=(first, second) if min(first, second) >= 0 else None,
            pull=None if np.isnan(pull[k]) else float(pull[k]),
            points=self.points[rows],
            normals=self.normals[rows],
        )

    @property
    @key
    def patches(self) -> tuple[Patch, ...]:
        """All contact patches."""
        pull = self.patch_pull
        return tuple(self._patch(k, pull) for k in range(len(self)))

    @property
    @key
    def units(self) -> UnitWord:
        """Length unit."""
        return self.assembly.units

    @property
    @key
    def rejected(self) -> tuple[RejectedPair, ...]:
        """Faces that come near but do not count as touching: the 1000 nearest."""
        return self.near[:LISTED]

    @property
    @key
    def joints(self) -> tuple[ListedJoint, ...]:
        """Joints of the assembly."""
        return self.assembly.joints_data()

    @property
    @key
    def sizes(self) -> tuple[float, float]:
        """Sizes of the smallest and the largest part [length unit]."""
        sizes = self.assembly.geometry.size
        return float(sizes.min()), float(sizes.max())

    @property
    @key
    def histogram(self) -> GapHistogram:
        """Histogram of the gaps of opposing faces."""
        return GapHistogram(edges=self.gap_edges, counts=self.gap_counts)

    @property
    @key
    def tolerance(self) -> AppliedTolerance:
        """Tolerances of contact detection."""
        return AppliedTolerance(
            gap=self.gap,
            angle_deg=math.degrees(self.searched.angle),
            clearance=self.searched.clearance,
        )

    def graph(self) -> Any:
        """Contact graph as a `networkx.Graph`: parts are nodes, touching pairs are edges.

        It needs the extra ``kilter[graph]``.

        A node is the name of a part, with the attributes `grounded` and `mass` [kg]. An edge has
        the attributes `patches` (a list of `Patch`) and `area` [length unit^2].

        Raises
        ------
        InputError
            If networkx is not installed.
        """
        try:
            import networkx
        except ImportError:
            raise InputError(
                "the graph of contacts needs networkx", hint='run: pip install "kilter[graph]"'
            ) from None
        graph = networkx.Graph()
        masses = self.assembly.geometry.mass.tolist()
        for part, mass in zip(self.assembly.parts, masses, strict=True):
            graph.add_node(part.name, grounded=part.grounded, mass=mass)
        for patch in self:
            edge = graph.get_edge_data(*patch.parts, {"patches": [], "area": 0.0})
            patches = [*edge["patches"], patch]
            graph.add_edge(*patch.parts, patches=patches, area=edge["area"] + patch.area)
        return graph

    def __repr__(self) -> str:
        counts = {
            "patches": len(self),
            "points": len(self.points),
            "pairs": self.pairs,
            "not modelled": len(self.unsupported),
            "overlapping": len(self.overlaps),
            "left open": len(self.open_pairs),
        }
        words = ", ".join(f"{label} {count}" for label, count in counts.items() if count)
        return f"<ContactSet: {words or 'nothing touches'}>"

    @property
    def approximate(self) -> PossibleContacts:
        """Forces of degenerate points as the paper approximates them: one normal force at each.

        The force acts along the centre of the cone of normals (section 2.1, Figure 3 (d)).
        """
        points = self.degenerate
        none = np.zeros(len(points))
        return PossibleContacts(
            points.part_a, points.part_b, points.points, points.centers, none > 0, none,
            np.arange(len(points)),
        )  # fmt: skip

    @property
    def point_patch(self) -> Index:
        """Index of the patch to which each contact point belongs, shape (K,)."""
        return np.repeat(np.arange(len(self)), np.diff(self.patch_start))

    @property
    def patch_bond(self) -> Index:
        """Index of the bond that glues each patch, shape (P,); -1 for patches without a bond."""
        bonds = self.assembly.bonds
        if not bonds:
            return np.full(len(self), -1)
        listed = self.patch_kind == "bond"
        index = self.assembly.index
        of_pair = {
            frozenset(index[name] for name in bond.parts): k
            for k, bond in enumerate(bonds)
            if bond.points is None
        }
        pairs = self.patch_parts.tolist()
        bond_of_patch = np.array(
            [of_pair.get(frozenset(pair), -1) for pair in pairs], dtype=np.int64
        )
        bond_of_patch[listed] = [k for k, bond in enumerate(bonds) if bond.points is not None]
        return bond_of_patch

    @property
    def patch_pull(self) -> Array:
        """Largest tension that the bond of each patch bears [N], shape (P,); NaN without a bond."""
        bonds, bond = self.assembly.bonds, self.patch_bond
        pull = np.array([b.pull or 0.0 for b in bonds] + [np.nan])[bond]
        stress = np.array([b.pull_per_area or 0.0 for b in bonds] + [np.nan])[bond]
        return pull * np.diff(self.patch_start) + stress * self.patch_area

    @property
    def counted_gap(self) -> float | None:
        """Widest gap among contacts that the default tolerance would reject [length unit].

        None if the default tolerance accepts every patch.
        """
        given, usual = self.searched, Tolerance()
        if given == usual or not len(self):
            return None
        geometry = self.assembly.geometry
        parts = self.patch_parts
        limit = usual.gap_of(geometry.size[parts].min(axis=1))
        # a gap within the rounding of the coordinates counts by the default tolerance too
        limit = np.maximum(limit, 2 * geometry.accuracy[parts].sum(axis=1))
        spread = self.patch_gap[:, 1] - self.patch_gap[:, 0]
        # a gap that varies more than the default angle over the width of the patch
        tilted = spread > 2 * usual.angle * np.sqrt(self.patch_area) + limit
        wide = (np.abs(nearest_gap(self.patch_gap)) > limit) | tilted
        return float(np.abs(self.patch_gap[wide]).max()) if wide.any() else None

    @property
    def unexamined(self) -> int:
        """Number of open pairs whose contacts were not examined, because of a time limit."""
        return sum(pair.kind == "unexamined" for pair in self.open_pairs)

    @property
    def pairs(self) -> int:
        """Number of pairs of parts that touch."""
        if not len(self):
            return 0
        return len(np.unique(np.sort(self.patch_parts, axis=1), axis=0))

    @property
    def adjacent(self) -> Index:
        """Pairs of parts that touch or may touch, (n, 2); a pair occurs once for each reason.

        The reasons are patches, forces that are not modelled, and open pairs. The ground is -1.
        """
        possible = self.possible
        opened = [pair.ends for pair in self.open_pairs]
        return np.concatenate(
            [
                self.patch_parts,
                np.column_stack([possible.part_a, possible.part_b]),
                np.array(opened, dtype=np.int64).reshape(-1, 2),
            ]
        )

    def of(self, assembly: Assembly) -> ContactSet:
        """The same contacts for a copy of the assembly with other joints or held parts."""
        return self if assembly is self.assembly else replace(self, assembly=assembly)

    def with_friction(self, mu: float) -> ContactSet:
        """Copy of the contacts with friction `mu` everywhere, less the error of fitted normals."""
        return replace(self, patch_mu=certain_friction(mu, self.patch_doubt))

    def with_friction_share(self, share: float) -> ContactSet:
        """Copy of the contacts with every friction coefficient multiplied by `share` [-]."""
        given = self.patch_mu + self.patch_doubt * (self.patch_mu > 0)
        return replace(self, patch_mu=certain_friction(share * given, self.patch_doubt))

    @property
    def alone(self) -> Index:
        """Indices of the parts that touch no part, overlap no part and have no joint.

        Parts in a pair that was not examined are left out.
        """
        index = self.assembly.index
        touched = np.zeros(len(self.assembly.parts), dtype=bool)
        touched[self.patch_parts.ravel()] = True
        pairs = [pair.ends for pair in self.unsupported]
        pairs += [pair.ends for pair in self.overlaps]
        pairs += [pair.ends for pair in self.open_pairs if pair.kind == "unexamined"]
        touched[np.array(pairs, dtype=np.int64).ravel()] = True
        joined = [name for joint in self.assembly.joints for name in joint.parts]
        touched[[index[name] for name in joined if name in index]] = True
        return np.flatnonzero(~touched)

    @property
    @key
    def nearest(self) -> tuple[LonePart, ...]:
        """Parts that touch nothing, each with its nearest part."""
        by_part = {neighbour.part: neighbour for neighbour in self.neighbours}
        names, held = self.assembly.names, self.assembly.geometry.grounded
        touching = self.searched.gap_of(self.assembly.geometry.size)
        entries: list[LonePart] = []
        for k in self.alone.tolist():
            near = by_part.get(k)
            if near is None:
                entries.append(LonePart(part=names[k], grounded=bool(held[k])))
            # between two held parts no contact is detected, also where they touch
            elif not (held[k] and held[near.other] and near.gap <= touching[k] + near.accuracy):
                entries.append(
                    LonePart(
                        part=names[k],
                        nearest=names[near.other],
                        gap=near.gap,
                        accuracy=near.accuracy,
                        grounded=bool(held[k]),
                    )
                )
        return tuple(entries)

    @cached_property
    @key
    def bodies(self) -> tuple[Body, ...]:
        """Bodies of parts that touch or overlap; bodies on a floor or held first, then by mass."""
        # an upper package computes them, which this package cannot import
        found: tuple[Body, ...] = hook("bodies_of")(self.assembly, self)
        return found

    @property
    @key
    def warnings(self) -> tuple[str, ...]:
        """Warnings about the file, the geometry and the contact search."""
        assembly = self.assembly
        warnings = [*assembly.notes, *assembly.geometry.warnings, *self.notes]
        if self.overlaps:
            warnings += self._overlap_warnings()
        if assembly.joints:
            warnings += joints_beyond(assembly, self.searched)
        return tuple(warnings)

    def _overlap_warnings(self) -> list[str]:
        """Warnings about overlaps that are open pairs, and about misplaced copies of parts."""
        left_open = {frozenset(pair.ends) for pair in self.open_pairs}
        over = [overlap for overlap in self.overlaps if frozenset(overlap.ends) in left_open]
        names = self.assembly.names
        odd = [
            (names[part], [names[k] for k in overlapped], names[copy])
            for part, overlapped, copy in odd_copies(self.assembly.geometry, self.overlaps, over)
        ]
        depths = overlap_warnings([overlap.to_dict() for overlap in over], self.assembly.units)
        return [*depths, *copy_warnings(odd)]
