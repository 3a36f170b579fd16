"""Findings about the pairs of a contact search, complete or until a time limit.

Every pair of parts is examined independently of all other pairs. Without a time limit all pairs are
examined together, in arrays. With a time limit they are examined in batches, and the clock is read
between batches and in long loops; the joined findings do not depend on the division into batches.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf
from time import perf_counter

import numpy as np

from kilter.arrays import Mask
from kilter.assembly import Assembly
from kilter.contact.common.contact_search import ContactSearch
from kilter.contact.common.gaps import RejectedPair, Tolerance, unknown_contacts
from kilter.contact.common.patches import KeptPairs, Overlap, Patches, UnsupportedContact
from kilter.contact.curved.curved_patches import CurvedContacts, no_curved, without_repeats
from kilter.contact.face_patches import FacePatches
from kilter.contact.flat_contacts import FlatContacts, find_flat
from kilter.contact.overlap import find_overlaps
from kilter.contact.sharp.feature_pairs import near_edges
from kilter.contact.sharp.sharp_contacts import NearContacts, near_contacts
from kilter.contact.smooth.smooth_joints import SmoothJoints, find_smooth
from kilter.errors import TimeLimitReached
from kilter.work import is_late, stop_if_late, take_at_least

__all__ = [
    "PairFindings",
    "RoundAndSharp",
    "examine",
    "examine_in_time",
    "find_round_and_sharp",
]


FIRST_BATCH = 32
"""Number of pairs in the first batch under a time limit."""
BATCH_TIME = 0.2
"""Time of a batch under a time limit [s]; a larger value loses more work when the limit ends it."""
GROWTH = 4.0
"""Largest ratio of the sizes of successive batches [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class PairFindings:
    """Contacts, near features and overlaps of the pairs of a search.

    Attributes
    ----------
    search : ContactSearch
        The search, with only the pairs that were examined.
    flat, curved, smooth, near
        Contacts of flat faces, of curved faces, of smooth faces, and of edges and corners.
    overlaps : tuple of Overlap
    near_edges : tuple of RejectedPair
        Near pairs without any other record.
    """

    search: ContactSearch
    flat: FlatContacts
    curved: CurvedContacts
    smooth: SmoothJoints
    near: NearContacts
    overlaps: tuple[Overlap, ...]
    near_edges: tuple[RejectedPair, ...]

    @property
    def faces(self) -> Patches:
        """Contact patches of all faces."""
        return Patches.join([self.flat.patches, self.curved.patches, self.smooth.patches])

    @property
    def unsupported(self) -> tuple[UnsupportedContact, ...]:
        """Records of the contacts that are not modelled."""
        return (*self.near.unsupported(self.search.geometry), *self.smooth.unsure)

    @property
    def refused(self) -> list[RejectedPair]:
        """Near faces that do not count as touching, and pairs with an unknown surface."""
        unknown = unknown_contacts(self.search.unknown)
        return [*self.flat.rejected, *self.curved.rejected, *self.near.rejected, *unknown]

    @staticmethod
    def join(search: ContactSearch, blocks: Sequence[tuple[int, PairFindings]]) -> PairFindings:
        """Findings about successive pairs of a search.

        Parameters
        ----------
        search : ContactSearch
            The search, with only the pairs of the blocks.
        blocks : sequence of (int, PairFindings)
            The first pair of each block, and the findings about its pairs; at least one block.
        """
        return PairFindings(
            search=search,
            flat=FlatContacts.join([(begin, block.flat) for begin, block in blocks]),
            curved=CurvedContacts.join([(begin, block.curved) for begin, block in blocks]),
            smooth=SmoothJoints.join(search, [(begin, block.smooth) for begin, block in blocks]),
            near=NearContacts.join([(begin, block.near) for begin, block in blocks]),
            overlaps=tuple(overlap for _, block in blocks for overlap in block.overlaps),
            near_edges=tuple(pair for _, block in blocks for pair in block.near_edges),
        )

    def among(self, kept: KeptPairs, search: ContactSearch) -> PairFindings:
        """The findings about some of the pairs.

        Parameters
        ----------
        kept : KeptPairs
            The remaining pairs and parts.
        search : ContactSearch
            The search with only these pairs.
        """
        return PairFindings(
            search=search,
            flat=self.flat.among(kept),
            curved=self.curved.among(kept),
            smooth=self.smooth.among(kept, search),
            near=self.near.among(kept),
            overlaps=kept.records(self.overlaps),
            near_edges=kept.records(self.near_edges),
        )


def _find_curved(search: ContactSearch) -> CurvedContacts:
    """Find the contacts of curved faces, if any part has such faces."""
    if len(search.geometry.surfaces) == 0:
        return no_curved(search)
    # imported late: parts with flat faces do not need these modules
    from kilter.contact.curved.curved_contacts import find_curved

    return find_curved(search)


@dataclass(frozen=True, slots=True, eq=False)
class RoundAndSharp:
    """Contacts of all faces, edges and corners of the pairs of a search, without overlaps."""

    flat: FlatContacts
    faces: FacePatches
    near: NearContacts

    @property
    def smooth(self) -> SmoothJoints:
        """Contacts of smooth faces."""
        return self.faces.smooth


def find_round_and_sharp(search: ContactSearch) -> RoundAndSharp:
    """Find the contacts of faces, edges and corners for all pairs of a search.

    Raises
    ------
    TimeLimitReached
        If the limit of `kilter.work.stop_after` is reached.
    """
    curved = _find_curved(search)
    smooth = find_smooth(search)
    flat = find_flat(search, smooth)
    faces = FacePatches(
        search, flat.patches, without_repeats(curved, flat.patches, search.limits.gap), smooth
    )
    stop_if_late()
    near = near_contacts(faces, [*flat.rejected, *curved.rejected])
    stop_if_late()
    return RoundAndSharp(flat, faces, near)


def examine(assembly: Assembly, search: ContactSearch, tolerance: Tolerance) -> PairFindings:
    """Examine all pairs of a search together.

    Raises
    ------
    TimeLimitReached
        If the limit of `kilter.work.stop_after` is reached.
    """
    found = find_round_and_sharp(search)
    flat, faces, near = found.flat, found.faces, found.near
    overlaps = find_overlaps(assembly, faces, tolerance)
    findings = PairFindings(search, flat, faces.curved, faces.smooth, near, overlaps, ())
    return replace(findings, near_edges=tuple(near_edges(search, _unrecorded_pairs(findings))))


def examine_in_time(
    assembly: Assembly, search: ContactSearch, tolerance: Tolerance
) -> PairFindings:
    """Examine the pairs of a search in order, until the limit of `kilter.work.stop_after`.

    Returns the findings about the first pairs; `PairFindings.search` has their number.
    """
    blocks: list[tuple[int, PairFindings]] = []
    begin, size = 0, float(FIRST_BATCH)
    while begin < len(search.pairs) and not is_late():
        end = min(begin + int(size), len(search.pairs))
        started = perf_counter()
        try:
            blocks.append((begin, examine(assembly, search.of_rows(begin, end), tolerance)))
        except TimeLimitReached:
            break
        seconds = perf_counter() - started
        growth = BATCH_TIME / seconds if seconds else GROWTH
        size = max((end - begin) * min(growth, GROWTH), 1.0)
        begin = end
    if not blocks:
        with take_at_least(inf):
            blocks.append((0, examine(assembly, search.of_rows(0, 0), tolerance)))
    return PairFindings.join(search.of_rows(0, begin), blocks)


def _unrecorded_pairs(findings: PairFindings) -> Mask:
    """Mask of the pairs without a patch, a near face, an overlap and an unmodelled contact."""
    pairs = findings.search.pairs
    silent = np.ones(len(pairs), dtype=bool)
    silent[np.concatenate([findings.faces.pair, findings.near.patches.pair])] = False
    records: list[RejectedPair | Overlap | UnsupportedContact] = [*findings.refused]
    records += [*findings.overlaps, *findings.unsupported]
    recorded = {frozenset(record.ends) for record in records}
    rows = np.flatnonzero(silent)
    is_recorded = [frozenset(pair) in recorded for pair in pairs[rows].tolist()]
    silent[rows[np.array(is_recorded, dtype=bool)]] = False
    return silent
