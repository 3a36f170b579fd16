"""Contacts of an assembly whose bodies stay in place while other properties change.

The contact search depends on shapes, poses, tolerances, and on the pairs that are searched. It does
not depend on friction, joints, masses, loads and gravity. `KeptContacts` searches once, with free
parts wherever a part may be released later, and then gives the contacts of each changed assembly,
equal to those of a new search.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass, replace

import numpy as np

from kilter.arrays import Index
from kilter.assembly import Assembly
from kilter.contact.contact_search import ContactSearch, begin_search
from kilter.contact.contact_set import ContactSet
from kilter.contact.detect import contacts_of_findings
from kilter.contact.gaps import Tolerance
from kilter.contact.kept_pairs import KeptPairs
from kilter.contact.pair_findings import PairFindings, examine

__all__ = ["KeptContacts"]


@dataclass(frozen=True, slots=True, eq=False)
class KeptContacts:
    """Findings of a contact search for all assemblies with the same bodies in the same places.

    Attributes
    ----------
    assembly : Assembly
        The assembly of the search; its held parts must be held in each later assembly.
    tolerance : Tolerance
    findings : PairFindings

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

        Parameters
        ----------
        assembly : Assembly
        tolerance : Tolerance
        held : collection of str
            Parts that stay held in each later assembly; tables stay held anyway.
        progress : callable, optional
            Called with the name of each stage.
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
            and _same_pose(part.pose, ours.parts[k].pose)
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


def _same_pose(first: object, second: object) -> bool:
    return first is second or first == second


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
