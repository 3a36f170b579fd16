"""ContactSet: the contacts of an assembly as arrays, by patch and by contact point.

A contact point p is (a, b, x, n, mu): parts a and b, position x, unit normal n from a to b.
The points of a patch are the corners of the convex hull of the area of contact in its
plane: every pressure inside the patch is a sum of forces at those corners (the paper,
section 2.1 and Figure 3), so nothing is lost for the equilibrium of rigid parts.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from kilter.arrays import (
    Array,
    Index,
    Labels,
    read_only,
)
from kilter.assembly import Assembly
from kilter.contact.common.distances import Neighbour
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
from kilter.tell.contact_words import copy_warnings, overlap_warnings
from kilter.tell.json_answer import AnswerInWords

if TYPE_CHECKING:
    from kilter.tell.answer_data.common_data import LoneData, NeighbourData
    from kilter.tell.answer_data.contacts_data import ContactsData, OverlapData, PatchData

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


@dataclass(frozen=True, slots=True, eq=False)
class ContactSet(AnswerInWords):
    """Contact patches between parts; world frame, length unit of the file.

    All arrays are read-only. ``for patch in contacts`` yields each `kilter.Patch`.

    Attributes
    ----------
    assembly : Assembly
        Assembly with these contacts; it has the names and units.
    patch_parts : ndarray of int, shape (P, 2)
        Parts a and b of each patch, by position in the assembly.
    patch_normal : ndarray, shape (P, 3)
        Unit normal from a to b; on a curved patch the mean of its point normals.
    patch_area : ndarray, shape (P,)
        Area of contact [length unit^2], not the area of its hull; 0 for edges, corners and
        given contacts.
    patch_gap : ndarray, shape (P, 2)
        Least and greatest gap over the patch [length unit]; negative = penetration.
    patch_mu : ndarray, shape (P,)
        Friction coefficient [-], reduced by `patch_doubt`, so that its forces are certain.
    patch_kind : ndarray of str, shape (P,)
        "plane", "edge-edge", "edge-face", "vertex-face", "cylinder", "sphere", "cone", "torus",
        "smooth" (fitted faces of meshes), "given" for contacts listed in the file, or "bond"
        for points of a bond.
    patch_accuracy : ndarray, shape (P,)
        Accuracy of the coordinates divided by the size of the patch [-].
    patch_doubt : ndarray, shape (P,)
        Largest error of fitted normals; 0 for normals of faces [rad].
    patch_start : ndarray of int, shape (P + 1,)
        The points of patch p are rows ``patch_start[p]`` to ``patch_start[p + 1]``.
    patch_pieces : ndarray of int, shape (P, 2)
        Pieces of parts a and b that touch (`Mesh.pieces`); -1 where they are not known.
    points : ndarray, shape (K, 3)
        Contact points [length unit].
    normals : ndarray, shape (K, 3)
        Unit normal from a to b at each point; on a flat patch the normal of the patch.
    unsupported : tuple of UnsupportedContact
        Pairs that touch in a way that is not modelled.
    possible : PossibleContacts
        Forces that contacts outside the patches could exert, including forces along the
        normals of `degenerate` (by row of the point).
    rejected : tuple of RejectedPair
        Faces that come near but do not count as touching, nearest first.
    overlaps : tuple of Overlap
        Pairs of parts that share volume.
    gap_edges, gap_counts : ndarray, shape (n + 1,) and (n,)
        Histogram of the gaps of opposing faces, relative to the size of the smaller part [-].
    tolerance : Tolerance
        Tolerance of the search.
    gap : float
        Largest gap tolerance that was applied to a pair [length unit].
    warnings : tuple of str
    degenerate : DegeneratePoints
        Contact points without a unique normal; also listed in `unsupported`.
    open_pairs : tuple of OpenPair
        Pairs whose contact the geometry leaves open; their largest forces are in `possible`.
    neighbours : tuple of Neighbour
        Nearest part of each part that touches nothing.
    fits : tuple of Fit
        Shafts in holes: tight, size on size, or with a clearance.
    """

    answer: ClassVar[str] = "contacts"

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
    patch_pieces: Index
    points: Array
    normals: Array
    unsupported: tuple[UnsupportedContact, ...]
    possible: PossibleContacts
    rejected: tuple[RejectedPair, ...]
    overlaps: tuple[Overlap, ...]
    gap_edges: Array
    gap_counts: Index
    tolerance: Tolerance
    gap: float
    warnings: tuple[str, ...]
    degenerate: DegeneratePoints = field(default_factory=DegeneratePoints.none)
    open_pairs: tuple[OpenPair, ...] = ()
    neighbours: tuple[Neighbour, ...] = ()
    fits: tuple[Fit, ...] = ()

    def __post_init__(self) -> None:
        read_only(self)
        left = still_open(self.open_pairs, self.assembly)
        if len(left) < len(self.open_pairs):  # the assembly has joints that the search had not
            joined = {frozenset(pair.parts) for pair in self.open_pairs if pair not in left}
            object.__setattr__(self, "possible", self.possible.without_wrenches(joined))
            object.__setattr__(self, "open_pairs", left)

    def __len__(self) -> int:
        return len(self.patch_area)

    def __iter__(self) -> Iterator[Patch]:
        return (self[k] for k in range(len(self)))

    def __getitem__(self, k: int) -> Patch:
        if not -len(self) <= k < len(self):
            raise IndexError(f"there are {len(self)} patches")
        k %= len(self)
        a, b = self._names(self.patch_parts[k])
        rows = slice(self.patch_start[k], self.patch_start[k + 1])
        return Patch(
            (a, b),
            str(self.patch_kind[k]),
            float(self.patch_area[k]),
            (float(self.patch_gap[k, 0]), float(self.patch_gap[k, 1])),
            self.patch_normal[k],
            float(self.patch_mu[k]),
            self.points[rows],
            self.normals[rows],
            self._pieces(k),
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
        given, usual = self.tolerance, Tolerance()
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
        opened = [pair.parts for pair in self.open_pairs]
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
        pairs = [pair.parts for pair in self.unsupported]
        pairs += [pair.parts for pair in self.overlaps]
        pairs += [pair.parts for pair in self.open_pairs if pair.kind == "unexamined"]
        touched[np.array(pairs, dtype=np.int64).ravel()] = True
        joined = [name for joint in self.assembly.joints for name in joint.parts]
        touched[[index[name] for name in joined if name in index]] = True
        return np.flatnonzero(~touched)

    def nearest(self) -> list[LoneData]:
        """JSON data: for each part that touches nothing, the nearest part and its distance."""
        by_part = {neighbour.part: neighbour for neighbour in self.neighbours}
        names, held = self.assembly.names, self.assembly.geometry.grounded
        touching = self.tolerance.gap_of(self.assembly.geometry.size)
        entries: list[LoneData] = []
        for k in self.alone.tolist():
            data: NeighbourData = {
                "part": names[k], "nearest": None, "gap": None, "accuracy": None
            }  # fmt: skip
            if k in by_part:
                near = by_part[k]
                # between two held parts no contact is detected, also where they touch
                if held[k] and held[near.other] and near.gap <= touching[k] + near.accuracy:
                    continue
                data = near.to_dict(names)
            entries.append({**data, "grounded": bool(held[k])})
        return entries

    def to_dict(self) -> ContactsData:
        """JSON data of the contacts, as ``kilter contacts --json`` prints them."""
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
            "overlaps": [self._overlap(overlap) for overlap in self.overlaps],
            "open_pairs": [pair.to_dict(assembly.names) for pair in self.open_pairs],
            "nearest": self.nearest(),
            "fits": [fit.to_dict(assembly.names) for fit in self.fits],
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
        """Sentences for the user about the file, the geometry and the contact search."""
        left_open = {frozenset(pair.parts) for pair in self.open_pairs}
        over = [overlap for overlap in self.overlaps if frozenset(overlap.parts) in left_open]
        assembly = self.assembly
        odd = [
            (assembly.names[part], self._names(overlapped), assembly.names[copy])
            for part, overlapped, copy in odd_copies(assembly.geometry, self.overlaps, over)
        ]
        return [
            *assembly.notes,
            *assembly.geometry.warnings,
            *self.warnings,
            *overlap_warnings([self._overlap(overlap) for overlap in over], assembly.units),
            *copy_warnings(odd),
            *joints_beyond(assembly, self.tolerance),
        ]

    def _overlap(self, overlap: Overlap) -> OverlapData:
        return {
            "parts": self._names(overlap.parts),
            "volume": overlap.volume,
            "depth": overlap.depth,
            "share": overlap.share,
            "why": overlap.why,
        }

    def _names(self, parts: Any) -> list[str]:
        return [self.assembly.names[k] for k in parts]

    def _pieces(self, k: int) -> tuple[int, int] | None:
        """Pieces that touch in the patch with index k; None if they are unknown."""
        first, second = self.patch_pieces[k].tolist()
        return (first, second) if min(first, second) >= 0 else None

    def _patch(self, k: int, pull: float) -> PatchData:
        """JSON data of the patch with index k; `pull` is the largest tension of its bond [N]."""
        gap = self.patch_gap[k]
        return {
            "parts": self._names(self.patch_parts[k]),
            "kind": str(self.patch_kind[k]),
            "area": float(self.patch_area[k]),
            "gap": float(gap[np.abs(gap).argmax()]),
            "gap_range": gap.tolist(),
            "normal": self.patch_normal[k].tolist(),
            "mu": float(self.patch_mu[k]),
            "pieces": None if (pieces := self._pieces(k)) is None else list(pieces),
            "pull": None if np.isnan(pull) else pull,
            "points": self.points[self.patch_start[k] : self.patch_start[k + 1]].tolist(),
        }
