"""Friction between USD objects, from the physics materials of their colliders.

Each collider has the material that is bound to it. Two materials combine as in PhysX: by the mode
`physxMaterial:frictionCombineMode`, of which the later in this order counts,

    average < min < multiply < max,

and average is the default. A single material counts for the pair. The colliders of an object that
differ in friction are pieces of its part, and each pair of pieces has its own coefficient.
"""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely

from kilter.arrays import Index
from kilter.assembly import Part
from kilter.assembly.interactions import FrictionPair
from kilter.files.usd.usd_masses import bound_material
from kilter.files.usd.usd_objects import UsdObject
from kilter.files.usd.usd_values import number_of, paths_above, token_of
from kilter.shape.primitives import surface

__all__ = ["FrictionMaterial", "collider_pieces", "friction_of_parts"]

REACH = 1.0
"""Distance of two parts up to which their friction is read [sizes of the smaller box]."""
MODES: dict[str, Callable[[float, float], float]] = {
    "average": lambda a, b: (a + b) / 2,
    "min": min,
    "multiply": lambda a, b: a * b,
    "max": max,
}
"""Functions of two coefficients, by the mode, in order of precedence."""
MODE = "physxMaterial:frictionCombineMode"


@dataclass(frozen=True, slots=True)
class FrictionMaterial:
    """Static friction coefficient of a material [-], and its position in `MODES`."""

    mu: float
    mode: int


Materials = Sequence[FrictionMaterial | None]
"""Material of each piece of a part; None without any."""


def collider_pieces(
    entry: UsdObject, filtered: Collection[str] = ()
) -> tuple[list[int], Materials]:
    """The piece to which each collider of an object belongs, and the material of each piece.

    Colliders with equal friction belong to the same piece, if the same `filtered` paths name them.
    """
    found = [
        (
            _material(shape.prim),
            tuple(path for path in paths_above(str(shape.prim.GetPath())) if path in filtered),
        )
        for shape in entry.chosen
    ]
    distinct = list(dict.fromkeys(found))
    return [distinct.index(key) for key in found], [material for material, _ in distinct]


def _material(prim: Any) -> FrictionMaterial | None:
    """The friction of the physics material of a collider; None without any.

    The dynamic coefficient replaces a static coefficient that is not stated.
    """
    material = bound_material(prim)
    if material is None:
        return None
    static, dynamic = material.GetStaticFrictionAttr(), material.GetDynamicFrictionAttr()
    mode = token_of(material.GetPrim().GetAttribute(MODE), MODES, "average")
    mu = number_of(static if static.HasAuthoredValue() else dynamic, 0)
    return FrictionMaterial(mu, list(MODES).index(mode))


def _combined(a: FrictionMaterial | None, b: FrictionMaterial | None) -> float | None:
    """The friction coefficient of two materials [-]; None without any."""
    if a is None or b is None:
        single = a or b
        return None if single is None else single.mu
    return list(MODES.values())[max(a.mode, b.mode)](a.mu, b.mu)


def friction_of_parts(
    parts: Sequence[Part], materials: Sequence[Materials]
) -> tuple[float, list[FrictionPair]]:
    """The most frequent friction coefficient, and the near pairs with another coefficient."""
    distinct = {material for pieces in materials for material in pieces}
    if len(distinct) == 1:
        material = distinct.pop()
        return _combined(material, material) or 0.0, []
    entries: list[tuple[float | None, int, int, tuple[int, int] | None]] = []
    for i, k in _near_pairs(parts).tolist():
        if parts[i].grounded and parts[k].grounded:
            continue
        table = {
            (m, n): _combined(a, b)
            for (m, a), (n, b) in itertools.product(
                enumerate(materials[i]), enumerate(materials[k])
            )
        }
        if len(set(table.values())) == 1:
            entries.append((table[0, 0], i, k, None))
        else:
            entries += [(mu, i, k, pieces) for pieces, mu in table.items()]
    known = [mu for mu, *_ in entries if mu is not None]
    bare = len(known) < len(entries)  # pairs without any material have the friction of the assembly
    usual = 0.0 if bare or not known else Counter(known).most_common(1)[0][0]
    return usual, [
        FrictionPair((parts[i].name, parts[k].name), mu, pieces)
        for mu, i, k, pieces in entries
        if mu is not None and mu != usual
    ]


def _near_pairs(parts: Sequence[Part]) -> Index:
    """Pairs of parts whose boxes are nearer than `REACH` sizes of the smaller box, (n, 2)."""
    corners = [part.pose.apply(surface(part.shape)[0]) for part in parts]
    low = np.array([points.min(axis=0) for points in corners])
    high = np.array([points.max(axis=0) for points in corners])
    reach = REACH * np.linalg.norm(high - low, axis=1)
    flat = shapely.box(*low[:, :2].T, *high[:, :2].T)
    wide = shapely.box(*(low[:, :2] - reach[:, None]).T, *(high[:, :2] + reach[:, None]).T)
    a, b = shapely.STRtree(flat).query(wide, predicate="intersects")
    near = (a != b) & (reach[a] <= reach[b])
    a, b = a[near], b[near]
    near = (low[a, 2] - reach[a] <= high[b, 2]) & (high[a, 2] + reach[a] >= low[b, 2])
    pairs: Index = np.unique(np.sort(np.column_stack([a[near], b[near]]), axis=1), axis=0)
    return pairs
