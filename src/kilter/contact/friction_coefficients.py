"""Friction coefficients of contacts: of pairs of parts, and of the pieces of parts.

The search keeps flat patches of different pieces apart. Of other patches, the points show the
pieces. Where several pieces meet, the pieces of a contact may be uncertain. The patch then has the
least coefficient, and the greatest counts as a possible force: a verdict must hold for both.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from kilter.arrays import Array, Index, ragged
from kilter.assembly import Assembly, FrictionPair, GivenContact
from kilter.contact.common.contact_search import ContactSearch
from kilter.contact.common.distances import surface_distance
from kilter.contact.common.patches import Patches, PossibleContacts


def friction_coefficients(
    assembly: Assembly, parts: Index, given: Array | None = None, *, greatest: bool = False
) -> Array:
    """Friction coefficients [-] of contacts between pairs of parts, shape (n,).

    The pieces that touch are unknown here. The coefficient is the least of all pieces of the pair,
    which is certain, or the greatest.

    `parts`, shape (n, 2): parts of each contact, by position. `given`, shape (n,): friction
    coefficient that is known for each contact; NaN: that of its pair [-].

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> friction_coefficients(scene("tower"), np.array([[0, 1], [1, 2]]), np.array([np.nan, 0.5]))
    array([0. , 0.5])
    """
    mu = np.full(len(parts), assembly.friction)
    if assembly.friction_pairs:
        by_pair: dict[frozenset[int], list[float]] = {}
        whole = set[frozenset[int]]()
        for entry in assembly.friction_pairs:
            pair = frozenset(assembly.index_of(name) for name in entry.parts)
            by_pair.setdefault(pair, []).append(entry.mu)
            if entry.pieces is None:
                whole.add(pair)
        of_pieces = max if greatest else min
        for pair, values in by_pair.items():
            values += [] if pair in whole else [assembly.friction]
        for k, ends in enumerate(parts.tolist()):
            values = by_pair.get(frozenset(ends), [])
            mu[k] = of_pieces(values, default=mu[k])
    return mu if given is None else np.where(np.isnan(given), mu, given)


def certain_friction(mu: Array | float, doubt: Array) -> Array:
    """Friction coefficient that remains for every normal within the error `doubt`, shape (n,).

    A force within the angle mu - doubt of the fitted normal lies within mu of the true normal.

    Examples
    --------
    >>> certain_friction(0.5, np.array([0.0, 0.125, 1.0]))
    array([0.5  , 0.375, 0.   ])
    """
    certain: Array = np.maximum(mu - doubt, 0.0)
    return certain


Table = dict[tuple[int, int], dict[tuple[int, int], float | None]]
"""Friction coefficient of pieces (i, j) of parts (a, b), a < b; None: they never touch [-]."""


def with_piece_friction(
    assembly: Assembly, search: ContactSearch, patches: Patches
) -> tuple[Patches, PossibleContacts]:
    """Patches with the friction of their pieces, and the forces that are possible beyond it.

    Patches of pieces that never touch are left out.
    """
    table = _friction_table(assembly)
    if not table:
        return patches, PossibleContacts.none()
    pieces, mu = patches.pieces.copy(), patches.mu.copy()
    keep = np.ones(len(patches), dtype=bool)
    rows: list[int] = []
    most: list[float] = []
    parts = patches.parts.tolist()
    # a listed contact, whose pair is -1, has its own coefficient
    for k in np.flatnonzero(patches.pair >= 0).tolist():
        a, b = parts[k]
        stated = table.get((min(a, b), max(a, b)))
        if stated is None:
            continue
        sides = [_touching_pieces(search, patches, k, side) for side in (0, 1)]
        pairs = [(i, j) if a < b else (j, i) for i in sides[0] for j in sides[1]]
        if len(pairs) == 1:
            pieces[k] = sides[0][0], sides[1][0]
        usual = stated[-1, -1]
        values = [stated.get(pair, usual) for pair in pairs]
        certain = [value for value in values if value is not None]
        keep[k] = len(certain) == len(values)
        if certain:
            mu[k] = min(certain)
            if not keep[k] or max(certain) > mu[k]:
                rows.append(k)
                most.append(max(certain))
    known = replace(patches, pieces=pieces, mu=mu)
    return known.take(np.flatnonzero(keep)), _possible(known, np.array(rows, np.int64), most)


def _friction_table(assembly: Assembly) -> Table:
    """The stated friction of the pieces of each pair; the key (-1, -1) has that of its rest."""
    table: Table = {}
    entries: list[FrictionPair | GivenContact] = [*assembly.friction_pairs, *assembly.contacts]
    for entry in entries:
        if entry.pieces is not None:
            ends = map(assembly.index_of, entry.parts)
            (a, i), (b, j) = sorted(zip(ends, entry.pieces, strict=True))
            table.setdefault((a, b), {})[i, j] = entry.mu
    whole = {
        frozenset(map(assembly.index_of, entry.parts)): entry.mu
        for entry in assembly.friction_pairs
        if entry.pieces is None
    }
    for pair, stated in table.items():
        stated[-1, -1] = whole.get(frozenset(pair), assembly.friction)
    return table


def _touching_pieces(search: ContactSearch, patches: Patches, k: int, side: int) -> list[int]:
    """The pieces of a part that may touch in patch k: those near each of its points, if any."""
    if patches.pieces[k, side] >= 0:
        return [int(patches.pieces[k, side])]
    geometry, part = search.geometry, int(patches.parts[k, side])
    span = slice(geometry.triangle_start[part], geometry.triangle_start[part + 1])
    label = geometry.triangle_piece[span]
    names = np.unique(label).tolist()
    if len(names) == 1:
        return [int(names[0])]
    corners, points = geometry.corners_of(part), patches.corners(k)
    off = np.array([surface_distance(points, corners[label == name]) for name in names])
    reach = 2 * (search.limits.gap[patches.pair[k]] + geometry.slack[part])
    near = off <= off.min(axis=0) + reach
    chosen = near.all(axis=1) if near.all(axis=1).any() else near.any(axis=1)
    return [int(name) for name, is_near in zip(names, chosen, strict=True) if is_near]


def _possible(patches: Patches, rows: Index, mu: list[float]) -> PossibleContacts:
    """Forces at the points of the given patches, with the given friction coefficients."""
    owner, points = ragged(patches.start, rows)
    ends = patches.parts[rows[owner]]
    return PossibleContacts(
        ends[:, 0],
        ends[:, 1],
        patches.points[points],
        patches.normals[points],
        np.zeros(len(points), dtype=bool),
        np.array(mu, dtype=np.float64)[owner],
        np.full(len(points), -1),
    )
