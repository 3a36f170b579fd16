"""Contacts of an assembly that changes while its bodies stay in place, without a new search.

The contact search depends on shapes, poses, tolerances, and on the pairs that are searched. It does
not depend on friction, joints, masses, loads and gravity. `KeptContacts` searches once, with free
parts wherever a part may be released later, and then gives the contacts of each changed assembly,
equal to those of a new search.

A contact between two parts does not depend on other parts. So the contacts of an assembly without
some parts are those between the remaining parts.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass, replace

import numpy as np

from kilter.arrays import Index, ragged, starts
from kilter.assembly import Assembly
from kilter.contact.common.contact_search import ContactSearch, begin_search
from kilter.contact.common.gaps import Tolerance
from kilter.contact.common.patches import KeptPairs
from kilter.contact.contact_set import ContactSet
from kilter.contact.detect import contacts_of_findings
from kilter.contact.pair_findings import PairFindings, examine


@dataclass(frozen=True, slots=True, eq=False)
class KeptContacts:
    """Findings of a contact search for all assemblies with the same bodies in the same places.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> tower = scene("tower")
    >>> kept = KeptContacts.find(tower, Tolerance())
    >>> kept.contacts(tower.with_friction(0.5)).patch_mu
    array([0.5, 0.5, 0.5, 0.5, 0.5])
    >>> len(kept.contacts(tower.with_grounded(["cube-1"])))
    4
    """

    assembly: Assembly
    """The assembly of the search; its held parts must be held in each later assembly."""
    tolerance: Tolerance
    findings: PairFindings

    @classmethod
    def find(
        cls,
        assembly: Assembly,
        tolerance: Tolerance,
        *,
        held: Collection[str] = (),
        progress: Callable[[str], None] | None = None,
    ) -> KeptContacts:
        """Search for the contacts of an assembly, also between held parts that may be released.

        `held`: parts that stay held in each later assembly; tables stay held anyway. `progress`:
        called with the name of each stage.
        """
        tell = progress or (lambda stage: None)
        free = [
            replace(part, grounded=False)
            if part.grounded and not part.table and part.name not in held
            else part
            for part in assembly.parts
        ]
        searched = replace(assembly, parts=free)
        search = begin_search(searched, tolerance, tell).without_same_bodies()
        tell(f"contacts of near pairs: {len(search.pairs)}")
        return cls(searched, tolerance, examine(searched, search, tolerance))

    def serves(self, assembly: Assembly, tolerance: Tolerance) -> bool:
        """Whether the findings give the contacts of an assembly.

        It has no part that the search did not know, and each part has the same shape and pose.
        """
        ours, index = self.assembly, self.assembly.index
        if tolerance != self.tolerance or (ours.units, ours.planar) != (
            assembly.units,
            assembly.planar,
        ):
            return False
        if ours.detect != assembly.detect or not _given(ours) <= _given(assembly):
            return False
        old = [index.get(part.name) for part in assembly.parts]
        if old != sorted(k for k in old if k is not None):
            return False
        return all(
            part.shape is ours.parts[k].shape
            and (part.pose is ours.parts[k].pose or part.pose == ours.parts[k].pose)
            and part.table == ours.parts[k].table
            and part.grounded >= ours.parts[k].grounded
            for part, k in zip(assembly.parts, old, strict=True)
            if k is not None
        )

    def contacts(self, assembly: Assembly) -> ContactSet:
        """The contacts of an assembly that these findings serve, as a new search finds them."""
        old = np.array([self.assembly.index[name] for name in assembly.names], dtype=np.int64)
        new_part = np.full(len(self.assembly.parts), -1)
        new_part[old] = np.arange(len(old))
        removed = self._removed(assembly, new_part)
        search = self.findings.search
        keep = np.array(
            [frozenset(pair) not in removed for pair in search.pairs.tolist()], dtype=bool
        )
        rows = np.flatnonzero(keep & (new_part[search.pairs] >= 0).all(axis=1))
        new_row = np.full(len(search.pairs), -1)
        new_row[rows] = np.arange(len(rows))
        kept = KeptPairs(new_part, new_row, removed)
        findings = self.findings.among(kept, _reduced(search, assembly, kept, rows))
        return contacts_of_findings(assembly, findings, self.tolerance)

    def _removed(self, assembly: Assembly, new_part: Index) -> frozenset[frozenset[int]]:
        """Pairs of remaining parts, by their old positions, that a new search leaves out.

        They are the pairs of held parts, and the pairs whose contacts are given.
        """
        held = assembly.geometry.grounded
        search = self.findings.search
        pairs = np.concatenate([search.pairs, search.unknown, search.same_bodies])
        both = pairs[(new_part[pairs] >= 0).all(axis=1)]
        fixed = both[held[new_part[both]].all(axis=1)]
        index = self.assembly.index
        given = [frozenset(index[name] for name in pair) for pair in _given(assembly)]
        return frozenset([*map(frozenset, fixed.tolist()), *given])


def _given(assembly: Assembly) -> set[frozenset[str]]:
    """Pairs of parts whose contacts are given, and not only for some of their pieces."""
    return {frozenset(c.parts) for c in assembly.contacts if c.pieces is None}


def _reduced(
    search: ContactSearch, assembly: Assembly, kept: KeptPairs, rows: Index
) -> ContactSearch:
    """A search with only some of its pairs, and the geometry of the remaining parts."""
    unknown = kept.pairs_of_parts(search.unknown)
    return replace(
        search,
        geometry=assembly.geometry,
        pairs=kept.new_part[search.pairs[rows]],
        limits=search.limits.take(rows),
        unknown=unknown,
        same_bodies=kept.pairs_of_parts(search.same_bodies),
    )


def contacts_among(contacts: ContactSet, assembly: Assembly) -> ContactSet:
    """The contacts that remain if an assembly is reduced to some of its parts in place.

    `contacts`: contacts of all parts. `assembly`: assembly of the subset, with the same names, as
    `Assembly.without` returns. Raises `InputError` if the assembly has a part that the contacts do
    not know.

    Examples
    --------
    >>> from kilter.contact import contacts
    >>> from kilter.scenes import scene
    >>> tower = scene("tower")
    >>> lower = tower.without(tower.names[-1])
    >>> len(contacts(tower)) - len(contacts_among(contacts(tower), lower))
    1
    """
    old = np.array([contacts.assembly.index_of(name) for name in assembly.names])
    new_part = np.full(len(contacts.assembly), -1)
    new_part[old] = np.arange(len(old))
    patches = np.flatnonzero((new_part[contacts.patch_parts] >= 0).all(axis=1))
    _, rows = ragged(contacts.patch_start, patches)
    kept = KeptPairs(new_part, np.empty(0, dtype=np.int64))
    degenerate, points = kept.degenerate(contacts.degenerate)
    return replace(
        contacts,
        assembly=assembly,
        patch_parts=new_part[contacts.patch_parts[patches]],
        patch_start=starts(np.diff(contacts.patch_start)[patches]),
        points=contacts.points[rows],
        normals=contacts.normals[rows],
        unsupported=kept.records(contacts.unsupported),
        possible=kept.possible(contacts.possible, points),
        near=kept.records(contacts.near),
        overlaps=kept.records(contacts.overlaps),
        degenerate=degenerate,
        open_pairs=tuple(
            pair
            for pair in kept.records(contacts.open_pairs)
            if not all(assembly.parts[k].grounded for k in pair.ends)
        ),
        neighbours=(),
        fits=kept.records(contacts.fits),
        **{name: getattr(contacts, name)[patches] for name in PATCH_FIELDS},
    )


PATCH_FIELDS = (
    "patch_normal",
    "patch_area",
    "patch_gap",
    "patch_mu",
    "patch_kind",
    "patch_accuracy",
    "patch_doubt",
    "patch_pieces",
)
"""Fields of a contact set with a row for each patch, except its parts and its points."""


def without_overlaps(contacts: ContactSet, parts: Collection[int]) -> ContactSet:
    """Contacts in which the overlaps of some parts exert no force.

    `parts`: parts whose overlaps, as open pairs, are left out.

    Examples
    --------
    >>> from kilter import Box, Part
    >>> from kilter.contact import contacts
    >>> held = Part("held", Box(1, 1, 1), grounded=True)
    >>> overlapping = contacts(Assembly([held, Part("in it", Box(1, 1, 1), [0, 0, 0.9])]))
    >>> overlapping, without_overlaps(overlapping, [1])
    (<ContactSet: overlapping 1, left open 1>, <ContactSet: nothing touches>)
    """
    chosen = set(parts)
    gone = {
        frozenset(pair.ends)
        for pair in contacts.open_pairs
        if pair.kind == "overlap" and not chosen.isdisjoint(pair.ends)
    }
    return replace(
        contacts,
        overlaps=tuple(pair for pair in contacts.overlaps if frozenset(pair.ends) not in gone),
        open_pairs=tuple(pair for pair in contacts.open_pairs if frozenset(pair.ends) not in gone),
        possible=contacts.possible.without_wrenches(gone),
    )
