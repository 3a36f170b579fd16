"""Pairs of parts whose findings are known: copies in the same relative pose, and earlier searches.

The findings about a pair of parts depend on both shapes, on their relative pose, on the tolerance,
and on which part is held. A rigid motion of both parts moves the findings with them:

    x -> R x + t,   R = R_new R_old^T,   t = p_new - R p_old,

with the poses (R, p) of part a. So such a pair is examined once for all copies of a sub-assembly.
Later searches reuse findings about the same poses only, such as the tries of a command that move
other parts: an answer does not depend on the questions before it.
"""

from __future__ import annotations

import atexit
from collections.abc import Hashable, Iterable
from dataclasses import dataclass, field, replace
from typing import Any, TypeVar

import numpy as np

from kilter.arrays import Array, Index, Mask, ragged, starts
from kilter.assembly import Assembly
from kilter.contact.common.contact_search import ContactSearch
from kilter.contact.common.patches import DegeneratePoints, Patches, PossibleContacts
from kilter.contact.contact_tolerances import COPY_PLACE
from kilter.rigid import quaternion_to_matrix

MOST_KNOWN = 20_000
"""Largest number of pairs whose findings are kept."""

OfPair = TypeVar("OfPair", bound=Any)


@dataclass(frozen=True, slots=True, eq=False)
class MovedPairs:
    """Examined pairs of parts, and the pairs to which a rigid motion carries their findings."""

    source: Index
    """Row of the examined pair, shape (m,)."""
    examined: Index
    """Parts of all examined pairs, shape (n, 2)."""
    pairs: Index
    """Parts of the pairs that have the same findings, shape (m, 2)."""
    turn: Array
    shift: Array
    """The motion x -> turn x + shift of each pair, shapes (m, 3, 3) and (m, 3) [length unit]."""

    def _points(self, target: Index, points: Array) -> Array:
        """Points after the motion of their pair, shape (k, 3)."""
        return self._directions(target, points) + self.shift[target]

    def _directions(self, target: Index, directions: Array) -> Array:
        """Directions after the motion of their pair, shape (k, 3)."""
        turned: Array = np.einsum("kij,kj->ki", self.turn[target], directions)
        return turned

    def _spread(self, pair: Index) -> tuple[Index, Index]:
        """Rows of `pairs`, and entries that they receive; `pair` has the source of each entry."""
        order = np.argsort(pair, kind="stable")
        start = np.searchsorted(pair[order], np.arange(len(self.examined) + 1))
        target, position = ragged(start, self.source)
        return target, order[position]

    def _of_parts(self, a: Index, b: Index) -> tuple[Index, Mask]:
        """Row of the examined pair of the parts a and b, and whether a is its second part."""
        count = int(self.examined.max(initial=0)) + 1
        key = self.examined[:, 0] * count + self.examined[:, 1]
        order = np.argsort(key)
        row: Index = order[np.searchsorted(key[order], np.minimum(a, b) * count + np.maximum(a, b))]
        return row, a > b

    def _ends(self, target: Index, swapped: Mask) -> tuple[Index, Index]:
        """Parts a and b of the receiving pairs, exchanged if `swapped`."""
        a, b = self.pairs[target].T
        return np.where(swapped, b, a), np.where(swapped, a, b)

    def patches(self, given: Patches) -> Patches:
        """Contact patches of the receiving pairs."""
        target, patch = self._spread(given.pair)
        moved = given.take(patch)
        of_point = np.repeat(target, np.diff(moved.start))
        swapped = moved.parts[:, 0] != self.examined[moved.pair, 0]
        return replace(
            moved,
            pair=target,
            parts=np.column_stack(self._ends(target, swapped)),
            normal=self._directions(target, moved.normal),
            points=self._points(of_point, moved.points),
            normals=self._directions(of_point, moved.normals),
        )

    def entries(self, given: Index) -> Index:
        """Entries of the receiving pairs; their first column is the row of the pair, (n, k)."""
        target, entry = self._spread(given[:, 0])
        return np.column_stack([target, given[entry, 1:]])

    def records(self, records: Iterable[OfPair]) -> tuple[OfPair, ...]:
        """Records of the receiving pairs, ordered by pair."""
        listed = list(records)
        if not listed:
            return ()
        pair, swapped = self._of_parts(*np.array([record.ends for record in listed]).T)
        target, entry = self._spread(pair)
        ends = np.column_stack(self._ends(target, swapped[entry])).tolist()
        moved = []
        for k, number, (a, b) in zip(target.tolist(), entry.tolist(), ends, strict=True):
            changed: dict[str, Any] = {"ends": (a, b)}
            point = getattr(listed[number], "point", None)
            if point is not None:
                changed["point"] = tuple((self.turn[k] @ point + self.shift[k]).tolist())
            moved.append(replace(listed[number], **changed))
        return tuple(moved)

    def possible(self, given: PossibleContacts) -> PossibleContacts:
        """Possible forces between the receiving pairs; they follow no degenerate point."""
        pair, swapped = self._of_parts(given.part_a, given.part_b)
        target, entry = self._spread(pair)
        a, b = self._ends(target, swapped[entry])
        moved = given.take(entry)
        points, normals = (
            self._points(target, moved.points),
            self._directions(target, moved.normals),
        )
        return replace(moved, part_a=a, part_b=b, points=points, normals=normals)

    def degenerate(self, given: DegeneratePoints) -> DegeneratePoints:
        """Degenerate points of the receiving pairs."""
        pair, swapped = self._of_parts(given.part_a, given.part_b)
        target, point = self._spread(pair)
        a, b = self._ends(target, swapped[point])
        of_normal, normal = ragged(given.start, point)
        held_pair, held_swapped = self._of_parts(*given.held_parts.T)
        holder, held = self._spread(held_pair)
        return DegeneratePoints(
            a,
            b,
            self._points(target, given.points[point]),
            starts(np.diff(given.start)[point]),
            self._directions(target[of_normal], given.normals[normal]),
            given.exact[point],
            np.column_stack(self._ends(holder, held_swapped[held])),
            self._points(holder, given.held_points[held]),
            self._directions(holder, given.held_normals[held]),
        )


@dataclass(frozen=True, slots=True, eq=False)
class KnownBlock:
    """Findings about examined pairs."""

    findings: Any
    pairs: Index
    """Parts of the pairs, shape (n, 2)."""
    assembly: Assembly
    """The assembly of the search, for the poses of its parts; it keeps the shapes alive."""


@dataclass(slots=True, eq=False)
class KnownPairs:
    """Findings of earlier searches, by the keys of their pairs."""

    blocks: list[KnownBlock] = field(default_factory=list)
    where: dict[Hashable, tuple[KnownBlock, int]] = field(default_factory=dict)
    """Block of each key, and its row there."""

    def add(self, block: KnownBlock, row: dict[Hashable, int]) -> None:
        """Keep the findings of a block, in place of the oldest ones; `row`: the row of each key."""
        if not row:
            return
        self.blocks.append(block)
        self.where.update({key: (block, k) for key, k in row.items()})
        while len(self.where) > MOST_KNOWN and len(self.blocks) > 1:
            oldest = self.blocks.pop(0)
            self.where = {key: at for key, at in self.where.items() if at[0] is not oldest}


known_pairs = KnownPairs()
"""Findings about the pairs that were examined last."""


@atexit.register
def forget_pairs() -> None:
    """Release the findings before the interpreter ends, as `contact_search.forget` does."""
    known_pairs.blocks.clear()
    known_pairs.where.clear()


def may_repeat(search: ContactSearch) -> Mask:
    """Mask of the pairs of a search that take long enough to look for an equal pair, shape (n,).

    Pairs of convex parts with flat faces are examined in arrays, in less time.
    """
    simple = search.facets.convex_part & (np.diff(search.geometry.surfaces.start) == 0)
    result: Mask = ~simple[search.pairs].all(axis=1)
    return result


def _poses(assembly: Assembly) -> tuple[Array, Array]:
    """Rotations and positions of all parts, shapes (N, 3, 3) and (N, 3) [length unit]."""
    turns = quaternion_to_matrix(np.array([part.pose.rotation for part in assembly.parts]))
    return turns, np.array([part.pose.position for part in assembly.parts])


def pair_keys(
    search: ContactSearch, rows: Index, assembly: Assembly, tolerance: Hashable
) -> list[Hashable]:
    """Keys of the given pairs of a search, which are equal for pairs with equal findings.

    Relative poses are rounded to `COPY_PLACE` of the gap tolerance.
    """
    pairs, gap = search.pairs[rows], search.limits.gap[rows]
    turns, places = _poses(assembly)
    a, b = pairs.T
    identity = np.array([id(part.shape) for part in assembly.parts])
    step = COPY_PLACE * gap[:, None]
    size = search.geometry.size[pairs].max(axis=1)[:, None]
    back = turns[a].transpose(0, 2, 1)
    numbers = [
        identity[pairs],
        search.geometry.grounded[pairs],
        np.round(np.log2(gap) / COPY_PLACE),
        np.round(np.einsum("nij,nj->ni", back, places[b] - places[a]) / step),
        np.round((back @ turns[b]).reshape(-1, 9) * (size / step)),
    ]
    table = np.column_stack(numbers) + 0.0  # no negative zeros; integers would overflow
    return [(tolerance, row.tobytes()) for row in table]


def pose_key(search: ContactSearch, row: int, assembly: Assembly) -> Hashable:
    """Gap tolerance of a pair of a search, and the poses of both parts, for an equal pair."""
    poses = [assembly.parts[part].pose for part in search.pairs[row].tolist()]
    numbers = [np.append(pose.position, pose.rotation) for pose in poses]
    return np.append(numbers, search.limits.gap[row]).tobytes()


def moved_pairs(block: KnownBlock, source: Index, pairs: Index, assembly: Assembly) -> MovedPairs:
    """The motions that carry examined pairs to pairs of an assembly.

    `source`, shape (m,): rows of the block; `pairs`, shape (m, 2): parts of the assembly.
    """
    (turn_before, place_before), (turn, place) = (
        (turns[parts], places[parts])
        for (turns, places), parts in (
            (_poses(block.assembly), block.pairs[source, 0]),
            (_poses(assembly), pairs[:, 0]),
        )
    )
    across = turn @ turn_before.transpose(0, 2, 1)
    across[(turn == turn_before).all(axis=(1, 2))] = np.eye(3)  # exact
    shift = place - np.einsum("nij,nj->ni", across, place_before)
    return MovedPairs(source, block.pairs, pairs, across, shift)
