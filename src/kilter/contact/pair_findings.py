"""Findings about the pairs of a contact search, complete or until a time limit.

Every pair of parts is examined independently of all other pairs. Without a time limit all pairs are
examined together, in arrays. With a time limit they are examined in batches, and the clock is read
between batches and in long loops; the joined findings do not depend on the division into batches.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from math import inf
from time import perf_counter
from typing import Any, NamedTuple

import numpy as np

from kilter.arrays import Index, Mask
from kilter.assembly import Assembly
from kilter.contact.common.contact_search import ContactSearch
from kilter.contact.common.findings import (
    CurvedFindings,
    FacePatches,
    Findings,
    is_settled,
    may_be_smooth,
)
from kilter.contact.common.gaps import UNKNOWN, RejectedPair, Tolerance
from kilter.contact.common.known_pairs import (
    KnownBlock,
    MovedPairs,
    OfPair,
    known_pairs,
    may_repeat,
    moved_pairs,
    pair_keys,
    pose_key,
)
from kilter.contact.common.patches import KeptPairs, Overlap, Patches, UnsupportedContact
from kilter.contact.flat_contacts import find_flat
from kilter.contact.overlap import find_overlaps
from kilter.contact.smooth.smooth_joints import find_smooth
from kilter.errors import TimeLimitReached
from kilter.work import is_late, stop_if_late, take_at_least

FIRST_BATCH = 32
"""Number of pairs in the first batch under a time limit."""
BATCH_TIME = 0.2
"""Time of a batch under a time limit [s]; a larger value loses more work when the limit ends it."""
GROWTH = 4.0
"""Largest ratio of the sizes of successive batches [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class PairFindings:
    """Findings of all families about the pairs of a search, with the overlaps.

    `search` has only the pairs that were examined; `near_edges` are near pairs without any other
    record.
    """

    search: ContactSearch
    smooth: Findings
    flat: Findings
    curved: Findings
    sharp: Findings
    overlaps: tuple[Overlap, ...]
    near_edges: tuple[RejectedPair, ...] = ()

    @property
    def faces(self) -> Patches:
        """Contact patches of all faces."""
        return Patches.join([self.flat.patches, self.curved.patches, self.smooth.patches])

    @property
    def unsupported(self) -> tuple[UnsupportedContact, ...]:
        """Records of the contacts that are not modelled."""
        return (*self.sharp.unsupported, *self.smooth.unsupported)

    @property
    def refused(self) -> list[RejectedPair]:
        """Near faces that do not count as touching, and pairs with an unknown surface."""
        unknown = [RejectedPair((a, b), 0.0, 0.0, UNKNOWN) for a, b in self.search.unknown.tolist()]
        return [*self.flat.rejected, *self.curved.rejected, *self.sharp.rejected, *unknown]

    @staticmethod
    def join(
        search: ContactSearch, blocks: Sequence[tuple[Index, PairFindings | KnownFindings]]
    ) -> PairFindings:
        """Findings about the pairs of a search, which has only the pairs of the blocks.

        A block gives the rows of its pairs, and its findings.
        """
        row = {frozenset(pair): k for k, pair in enumerate(search.pairs.tolist())}

        def ordered(records: Iterable[OfPair]) -> tuple[OfPair, ...]:
            """Records in the order of their pairs."""
            return tuple(sorted(records, key=lambda record: row.get(frozenset(record.ends), -1)))

        def joined(name: str) -> Findings:
            """Findings of a family about all pairs."""
            found = Findings.join([(rows, getattr(block, name)) for rows, block in blocks])
            rejected, unsupported = ordered(found.rejected), ordered(found.unsupported)
            return replace(found, rejected=rejected, unsupported=unsupported)

        return PairFindings(
            search,
            **{name: joined(name) for name, _, _ in FAMILIES},
            overlaps=ordered(overlap for _, block in blocks for overlap in block.overlaps),
            near_edges=ordered(pair for _, block in blocks for pair in block.near_edges),
        )

    def kept(self) -> KnownFindings:
        """The findings about the pairs of the search, for pairs with equal findings."""
        families = {name: replace(getattr(self, name), joints=()) for name, _, _ in FAMILIES}
        twice = {frozenset(pair) for pair in self.search.same_bodies.tolist()}  # not examined
        overlaps = tuple(o for o in self.overlaps if frozenset(o.ends) not in twice)
        return KnownFindings(**families, overlaps=overlaps, near_edges=self.near_edges)

    def among(self, kept: KeptPairs, search: ContactSearch) -> PairFindings:
        """The findings about some of the pairs; `search` has only these."""
        return PairFindings(
            search,
            **{name: getattr(self, name).among(kept) for name, _, _ in FAMILIES},
            overlaps=kept.records(self.overlaps),
            near_edges=kept.records(self.near_edges),
        )


class KnownFindings(NamedTuple):
    """Findings of all families about pairs, as in `PairFindings`."""

    smooth: Findings
    flat: Findings
    curved: Findings
    sharp: Findings
    overlaps: tuple[Overlap, ...]
    near_edges: tuple[RejectedPair, ...]

    def moved(self, moved: MovedPairs) -> KnownFindings:
        """The findings about pairs to which a motion carries these pairs."""
        return KnownFindings(
            **{name: getattr(self, name).moved(moved) for name, _, _ in FAMILIES},
            overlaps=moved.records(self.overlaps),
            near_edges=moved.records(self.near_edges),
        )


class Family(NamedTuple):
    """A family of contacts: its field of `FacePatches`, a cheap test for it, and its search."""

    name: str
    is_present: Callable[[FacePatches], bool]
    find: Callable[[FacePatches, bool], Findings]
    """Its second argument: whether contacts without a formula are searched for."""


def _find_curved(faces: FacePatches, _: bool) -> CurvedFindings:
    from kilter.contact.curved.curved_contacts import find_curved

    return find_curved(faces)


def _find_sharp(faces: FacePatches, unmodelled: bool) -> Findings:
    from kilter.contact.sharp.sharp_contacts import find_sharp

    return find_sharp(faces, unmodelled=unmodelled)


FAMILIES = (
    Family(
        "smooth",
        lambda faces: bool(may_be_smooth(faces.search).any()),
        lambda faces, _: find_smooth(faces),
    ),
    Family("flat", lambda faces: True, lambda faces, _: find_flat(faces)),
    Family("curved", lambda faces: len(faces.search.geometry.surfaces) > 0, _find_curved),
    Family("sharp", lambda faces: not is_settled(faces).all(), _find_sharp),
)
"""Families in the order of their search: each may use the findings of those before it."""


def find_families(search: ContactSearch, *, unmodelled: bool = True) -> FacePatches:
    """Find the contacts of all families for all pairs of a search, without overlaps.

    A family that is absent is skipped, and its modules are not imported.

    `unmodelled`: whether contacts of edges without a formula are searched for, too.

    Raises `TimeLimitReached` if the limit of `kilter.work.stop_after` is reached.
    """
    found = FacePatches(search)
    for family in FAMILIES:
        if family.is_present(found):
            of_family: dict[str, Any] = {family.name: family.find(found, unmodelled)}
            found = replace(found, **of_family)
            stop_if_late()
    return found


def examine(assembly: Assembly, search: ContactSearch, tolerance: Tolerance) -> PairFindings:
    """Examine all pairs of a search, equal pairs in equal relative poses only once.

    Raises `TimeLimitReached` if the limit of `kilter.work.stop_after` is reached.
    """
    repeats = np.flatnonzero(may_repeat(search))
    if not len(repeats):
        return _examine_each(assembly, search, tolerance)
    keys = dict(zip(repeats.tolist(), pair_keys(search, repeats, assembly, tolerance), strict=True))
    first_of = {keys[row]: row for row in reversed(keys)}
    # only the same poses find earlier findings: the answer does not depend on earlier questions
    placed = {key: (key, pose_key(search, row, assembly)) for key, row in first_of.items()}
    fresh = {
        row: placed[key] for key, row in first_of.items() if placed[key] not in known_pairs.where
    }
    later = np.array([row for row in keys if row not in fresh], dtype=np.int64)
    rows = np.setdiff1d(np.arange(len(search.pairs)), later)
    first = _examine_each(assembly, search.of_rows(rows, first=True), tolerance)
    block = KnownBlock(first.kept(), first.search.pairs, assembly)
    # smooth joints hold whole faces: such a pair is examined each time
    smooth = {joint.pair for joint in first.smooth.joints}
    known_pairs.add(block, {fresh[row]: k for k, row in enumerate(rows.tolist())
                            if row in fresh and k not in smooth})  # fmt: skip
    if not len(later):
        return replace(first, search=search)
    known = [known_pairs.where.get(placed[keys[row]]) for row in later.tolist()]
    of_block = np.array([-1 if at is None else known_pairs.blocks.index(at[0]) for at in known])
    blocks = [(rows, first)]
    for number in np.unique(of_block).tolist():
        here = later[of_block == number]
        if number < 0:
            each = search.of_rows(here, first=False)
            blocks.append((here, _examine_each(assembly, each, tolerance)))
            continue
        source = np.array([at[1] for at in known if at and at[0] is known_pairs.blocks[number]])
        pairs = search.pairs[here]
        moved = moved_pairs(known_pairs.blocks[number], source, pairs, assembly)
        blocks.append((here, known_pairs.blocks[number].findings.moved(moved)))
    return PairFindings.join(search, blocks)


def examine_in_time(
    assembly: Assembly, search: ContactSearch, tolerance: Tolerance
) -> PairFindings:
    """Examine the pairs of a search in order, until the limit of `kilter.work.stop_after`.

    Returns the findings about the first pairs; `PairFindings.search` has their number.
    """
    blocks: list[tuple[Index, PairFindings]] = []
    begin, size = 0, float(FIRST_BATCH)
    while begin < len(search.pairs) and not is_late():
        end = min(begin + int(size), len(search.pairs))
        started = perf_counter()
        try:
            rows = np.arange(begin, end)
            batch = search.of_rows(rows, first=begin == 0)
            blocks.append((rows, examine(assembly, batch, tolerance)))
        except TimeLimitReached:
            break
        seconds = perf_counter() - started
        growth = BATCH_TIME / seconds if seconds else GROWTH
        size = max((end - begin) * min(growth, GROWTH), 1.0)
        begin = end
    if not blocks:
        with take_at_least(inf):
            none = np.arange(0)
            blocks.append((none, examine(assembly, search.of_rows(none, first=True), tolerance)))
    return PairFindings.join(search.of_rows(np.arange(begin), first=True), blocks)


def _examine_each(assembly: Assembly, search: ContactSearch, tolerance: Tolerance) -> PairFindings:
    """Examine all pairs of a search together."""
    found = find_families(search)
    findings = PairFindings(
        search,
        **{name: getattr(found, name) for name, _, _ in FAMILIES},
        overlaps=find_overlaps(assembly, found, tolerance),
    )
    unrecorded = _unrecorded_pairs(findings)
    if not unrecorded.any():
        return findings
    from kilter.contact.sharp.feature_pairs import near_edges

    return replace(findings, near_edges=tuple(near_edges(search, unrecorded)))


def _unrecorded_pairs(findings: PairFindings) -> Mask:
    """Mask of the pairs without a patch, a near face, an overlap and an unmodelled contact."""
    pairs = findings.search.pairs
    silent = np.ones(len(pairs), dtype=bool)
    silent[np.concatenate([findings.faces.pair, findings.sharp.patches.pair])] = False
    records: list[RejectedPair | Overlap | UnsupportedContact] = [*findings.refused]
    records += [*findings.overlaps, *findings.unsupported]
    recorded = {frozenset(record.ends) for record in records}
    rows = np.flatnonzero(silent)
    is_recorded = [frozenset(pair) in recorded for pair in pairs[rows].tolist()]
    silent[rows[np.array(is_recorded, dtype=bool)]] = False
    return silent
