"""Contacts of a MuJoCo model: which geoms may touch, and their friction, as its engine decides.

Of two geoms g, h with priorities p, sliding coefficients mu and contact dimensions d,

    an explicit pair          mu, d of the pair; nothing filters it
    p_g > p_h                 mu, d of g
    p_g = p_h                 max(mu_g, mu_h), max(d_g, d_h)

and mu = 0 if d = 1. Dimensions 4 and 6 also have torsional and rolling friction, which kilter does
not have: without it less is held. Other pairs touch unless the bits of the geoms, an excluded pair
of bodies, or the rule for parent and child filter them. Geoms of a part with equal rules are a
piece of it.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import Any

import numpy as np

from kilter.arrays import Array, Index, Mask, counted, starts
from kilter.assembly import Part
from kilter.assembly.interactions import FrictionPair, GivenContact
from kilter.files.objects.mujoco_snapshot import Snapshot


class GeomRules:
    """Rules of a model for the contacts of its geoms.

    - `collides` (ngeom,): whether a geom may touch any other geom.
    - `unequal`: number of explicit pairs with two sliding coefficients, of which the lesser
      counts.
    """

    def __init__(self, model: Snapshot) -> None:
        self.model = model
        lesser = np.minimum(model.pair_friction[:, 0], model.pair_friction[:, 1])
        uneven = np.ptp(model.pair_friction[:, :2], axis=1) > 0
        self.unequal = int(np.count_nonzero(uneven & (model.pair_dim > 1)))
        given = zip(lesser.tolist(), model.pair_dim.tolist(), strict=True)
        ends = zip(model.pair_geom1.tolist(), model.pair_geom2.tolist(), strict=True)
        self.explicit = dict(zip(map(frozenset[int], ends), given, strict=True))
        """Friction and dimension of explicit pairs."""
        self.partners: dict[int, set[tuple[float, ...]]] = {}
        """Other geom, friction and dimension of the explicit pairs of each geom."""
        for pair, values in self.explicit.items():
            for geom in pair:
                self.partners.setdefault(geom, set()).add((*(pair - {geom}), *values))
        self.collides: Mask = (model.geom_contype | model.geom_conaffinity) != 0
        self.collides[list(self.partners)] = True

    def pieces(self, geoms: Sequence[int]) -> list[int]:
        """The piece of each geom of a part; geoms with equal rules belong to the same piece."""
        model = self.model
        rules: dict[Any, int] = {}
        pieces = []
        for geom in geoms:
            names = ("priority", "condim", "contype", "conaffinity", "bodyid")
            own = [int(getattr(model, f"geom_{name}")[geom]) for name in names]
            pairs = frozenset(self.partners.get(geom, ()))
            rule = (*own, float(model.geom_friction[geom, 0]), pairs)
            pieces.append(rules.setdefault(rule, len(rules)))
        return pieces

    def of_pairs(self, g: Index, h: Index) -> tuple[Array, Index, Mask]:
        """Friction coefficient [-] and dimension of pairs of geoms, and whether they may touch."""
        model = self.model
        mu, condim, rank = model.geom_friction[:, 0], model.geom_condim, model.geom_priority
        order = np.sign(rank[g] - rank[h])
        both = [np.maximum(values[g], values[h]) for values in (mu, condim)]
        friction, dimension = (
            np.choose(order + 1, [values[h], equal, values[g]])
            for values, equal in zip((mu, condim), both, strict=True)
        )
        touches = ~self._filtered(g, h)
        if self.explicit:
            for k, pair in enumerate(zip(g.tolist(), h.tolist(), strict=True)):
                if frozenset(pair) in self.explicit:
                    friction[k], dimension[k] = self.explicit[frozenset(pair)]
                    touches[k] = True
        if model.common_friction is not None:
            friction = np.full(len(g), model.common_friction)
        return np.where(dimension == 1, 0.0, friction), dimension, touches

    def _filtered(self, g: Index, h: Index) -> Mask:
        """Mask of the pairs of geoms that the model filters.

        Bits filter nothing in a model without colliding geoms, whose visible geoms count.
        """
        model = self.model
        types, bits = model.geom_contype, model.geom_conaffinity
        masked: Mask = ((types[g] & bits[h]) | (types[h] & bits[g])) == 0
        masked &= bool(self.collides.any())
        bodies = model.geom_bodyid.astype(np.int64)
        weld = model.body_weldid[bodies]
        above = model.body_weldid[model.body_parentid[weld]]
        family: Mask = (weld[g] == weld[h]) & (weld[g] != 0)
        if "FILTERPARENT" not in model.disabled:
            family |= (above[g] == weld[h]) & (weld[h] != 0)
            family |= (above[h] == weld[g]) & (weld[g] != 0)
        a, b = bodies[g], bodies[h]
        signs = np.minimum(a, b) << 16 | np.maximum(a, b)
        return masked | family | np.isin(signs, model.exclude_signature)


def contact_entries(
    rules: GeomRules,
    parts: Sequence[Part],
    geoms: Sequence[Sequence[int]],
    near: tuple[Index, Index],
    notes: list[str],
) -> tuple[float, list[FrictionPair], list[GivenContact]]:
    """The usual friction coefficient, pairs with another one, and pairs that never touch.

    Arguments: `notes`: notes are appended for filtered pairs and friction that kilter does not
    have.
    """
    free = np.array([not part.grounded for part in parts])
    first, second = (ends[free[near[0]] | free[near[1]]] for ends in near)
    members = [_representatives(rules.pieces(each), each) for each in geoms]
    count = np.array([len(each) for each in members])
    of_part, geom = starts(count), np.concatenate([np.empty(0, np.int64), *members])
    row, k = counted(count[first] * count[second])
    i, j = k // count[second[row]], k % count[second[row]]
    g, h = geom[of_part[first[row]] + i], geom[of_part[second[row]] + j]
    mu, dimension, touches = rules.of_pairs(g, h)
    ends = zip(first.tolist(), second.tolist(), strict=True)
    entries = _PairEntries([(parts[a].name, parts[b].name) for a, b in ends])
    entries.add(row, np.column_stack([i, j]), np.where(touches, mu, np.nan))
    turning = len(np.unique(row[touches & (dimension > 3)]))
    if turning:
        notes.append(f"torsional and rolling friction is ignored: {turning} pairs of parts")
    if entries.filtered:
        notes.append(f"pairs whose contacts the model filters: {entries.filtered}")
    return entries.stated()


def _representatives(pieces: Sequence[int], geoms: Sequence[int]) -> Index:
    """The first geom of each piece of a part."""
    chosen = [geoms[pieces.index(piece)] for piece in range(max(pieces, default=-1) + 1)]
    return np.array(chosen, dtype=np.int64)


class _PairEntries:
    """Friction of pairs of parts and of their pieces, as entries of an assembly."""

    def __init__(self, names: list[tuple[str, str]]) -> None:
        self.names = names
        self.values: list[dict[tuple[int, int], float]] = [{} for _ in names]
        """For each pair of parts, the coefficient of each pair of pieces; NaN: they never touch."""

    def add(self, row: Index, pieces: Index, mu: Array) -> None:
        """Add the friction coefficients of pairs of pieces, and the row of their pair of parts."""
        for k, (i, j), value in zip(row.tolist(), pieces.tolist(), mu.tolist(), strict=True):
            self.values[k][i, j] = value

    @property
    def filtered(self) -> int:
        """Number of pairs of parts of which some pieces never touch."""
        return sum(any(mu != mu for mu in values.values()) for values in self.values)

    def stated(self) -> tuple[float, list[FrictionPair], list[GivenContact]]:
        """The usual coefficient, friction pairs, and pairs that never touch."""
        usual = [_most_frequent(values.values()) for values in self.values]
        friction = _most_frequent(mu for mu in usual if mu is not None) or 0.0
        pairs, apart = [], []
        for names, values, most in zip(self.names, self.values, usual, strict=True):
            if most is None:
                apart.append(GivenContact(names, [], [0, 0, 1]))
                continue
            if most != friction:
                pairs.append(FrictionPair(names, most))
            for pieces, mu in values.items():
                if mu != mu:
                    apart.append(GivenContact(names, [], [0, 0, 1], pieces=pieces))
                elif mu != most:
                    pairs.append(FrictionPair(names, mu, pieces))
        return friction, pairs, apart


def _most_frequent(values: Any) -> float | None:
    """The most frequent number that is not NaN; None without such a number."""
    counts = Counter(value for value in values if value == value)
    return counts.most_common(1)[0][0] if counts else None
