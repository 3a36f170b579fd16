"""Graph of a scene: which objects touch, and the clusters of objects that touch each other.

The nodes are the free parts. Held parts and the ground do not join clusters, since nothing that
happens at one place of a held part affects another place. Two free parts are joined by

    contact patches, contacts without a formula, overlaps, clearances, unexamined pairs,
    joints, bonds and straps                                            (they touch)
    faces that nearly touch                                             (they are near)
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from kilter.arrays import Index, Mask, connected
from kilter.assembly import Assembly
from kilter.contact import ContactSet


@dataclass(frozen=True, slots=True, eq=False)
class SceneGraph:
    """Pairs of touching and of near parts of a scene; the ground has the number of parts."""

    count: int
    """Number of parts."""
    free: Mask
    """Whether each part is free, shape (count + 1,); the last entry, the ground, is not."""
    touching: Index
    near: Index
    """Pairs of parts, shape (n, 2)."""

    @classmethod
    def of(cls, assembly: Assembly, contacts: ContactSet) -> SceneGraph:
        """Build the graph of an assembly from its contacts."""
        count = len(assembly)
        index = dict(assembly.index)
        linked: list[tuple[str, ...]] = [joint.parts for joint in assembly.joints]
        linked += [bond.parts for bond in assembly.bonds]
        linked += [strap.parts for strap in assembly.straps]
        pairs = [
            (index.get(a, count), index.get(b, count))
            for names in linked
            for a, b in pairwise(names)
        ]
        pairs += [pair.ends for pair in contacts.unsupported]
        pairs += [pair.ends for pair in contacts.open_pairs if pair.kind != "near"]
        near = [pair.ends for pair in contacts.open_pairs if pair.kind == "near"]
        return cls(
            count,
            np.append(~assembly.geometry.grounded, False),
            np.concatenate([contacts.patch_parts, _pairs(pairs)]),
            _pairs(near),
        )

    def clusters(self, among: Mask, *, near: bool) -> list[Index]:
        """The clusters of some of the free parts, each in ascending order.

        Arguments: `among` (count,): free parts that are considered; others do not exist.
        """
        edges = self._edges(near)
        inside = np.append(among, False)
        edges = edges[inside[edges].all(axis=1)]
        label = connected(self.count, *edges.T)
        members = np.flatnonzero(among)
        order = members[np.argsort(label[members], kind="stable")]
        cuts = np.flatnonzero(np.diff(label[order])) + 1
        return np.split(order, cuts) if len(order) else []

    def supported(self) -> Mask:
        """Whether each part touches a held part or the ground, shape (count,)."""
        edges = self.touching
        mixed = edges[self.free[edges].sum(axis=1) == 1]
        marks = np.zeros(self.count + 1, dtype=bool)
        marks[mixed] = True
        return marks[:-1]

    def beside(self, members: Index) -> Index:
        """Other parts, held or free, that touch some of the given parts or are near them."""
        edges = self._edges(near=True)
        inside = np.zeros(self.count + 1, dtype=bool)
        inside[members] = True
        found = edges[inside[edges].any(axis=1)]
        others = np.unique(found[~inside[found]])
        return others[others < self.count]

    def _edges(self, near: bool) -> Index:
        return np.concatenate([self.touching, self.near]) if near else self.touching


def _pairs(pairs: list[tuple[int, int]]) -> Index:
    """Pairs of numbers as an array, shape (n, 2)."""
    return np.array(pairs, dtype=np.int64).reshape(-1, 2)
