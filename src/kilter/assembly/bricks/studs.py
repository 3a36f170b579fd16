"""Find the connections of bricks: points of studs between layers, and sides of neighbours."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, Rows, columns, counted, distinct_rows
from kilter.assembly.bricks.brick_model import BrickModel, cells_of
from kilter.assembly.bricks.stud_rules import NARROW, WIDE

__all__ = ["Sides", "Studs", "sides_of", "studs_of"]


@dataclass(frozen=True, slots=True, eq=False)
class Studs(Rows):
    """Points at which studs connect bricks, sorted by pair of bricks."""

    lower: Index
    upper: Index
    """The brick with the stud, and the brick on it, shape (n,)."""
    point: Array = columns(3)
    """Position, shape (n, 3): x, y [cells], z [plates]."""


@dataclass(frozen=True, slots=True, eq=False)
class Sides(Rows):
    """Rectangles over which two neighbouring bricks touch with their sides."""

    first: Index
    second: Index
    """The two bricks, shape (n,); the second is further along `axis`."""
    axis: Index
    """0 or 1, shape (n,): the axis of the normal from the first to the second brick."""
    low: Index = columns(3)
    high: Index = columns(3)
    """Corners of the rectangle, shape (n, 3): x, y [cells], z [plates]; equal along `axis`."""


def studs_of(model: BrickModel) -> Studs:
    """Find all studs that hold a brick above: points, and pairs of bricks.

    Examples
    --------
    A 1x1 brick on the end of a 1x2 brick has one stud with four points.

    >>> two = BrickModel(
    ...     np.array([[0, 0, 0], [1, 0, 3]]), np.array([[2, 1, 3], [1, 1, 3]]), np.ones(2),
    ...     np.zeros(2, int), np.zeros(2, bool), np.array([1, 2]), np.array([1, 2]))
    >>> studs_of(two).point[:, 0]
    array([1.5 , 1.25, 1.5 , 1.75])
    """
    cells = cells_of(model)
    below, above = cells.brick[:-1], cells.brick[1:]
    k = np.flatnonzero(cells.same_column & (model.top[below] == model.corner[above, 2]))
    narrow = model.size[above[k], :2].min(axis=1) == 1
    stud, place = counted(np.where(narrow, len(NARROW), len(WIDE)))
    offset = np.where(narrow[stud, None], NARROW[place], WIDE[np.minimum(place, len(WIDE) - 1)])
    cell = k[stud]
    xy = cells.xy[cell] + 0.5 + offset
    lower, upper = below[cell], above[cell]
    points = np.column_stack([xy, model.corner[upper, 2]])
    order = np.lexsort((place, stud, upper, lower))
    return Studs(lower[order], upper[order], points[order])


def sides_of(model: BrickModel) -> Sides:
    """Find the rectangle over which each two neighbouring bricks touch with their sides."""
    cells = cells_of(model)
    owner, height = counted(model.size[cells.brick, 2])
    brick = cells.brick[owner]
    place = np.column_stack([cells.xy[owner], model.corner[brick, 2] + height])
    place -= place.min(axis=0)
    wide = place.max(axis=0) + 2  # a step beyond the end of a row reaches no cell of the next row
    steps = (wide[1] * wide[2], wide[2])
    key = place @ np.array([*steps, 1])
    order = np.argsort(key)
    ordered = key[order]
    blocks = []
    for axis in (0, 1):
        nearest = np.minimum(np.searchsorted(ordered, key + steps[axis]), len(key) - 1)
        beside = order[nearest]
        k = np.flatnonzero((ordered[nearest] == key + steps[axis]) & (brick[beside] != brick))
        pairs, _ = distinct_rows(np.column_stack([brick[k], brick[beside[k]]]))
        blocks.append(_rectangles(model, pairs, axis))
    return Sides.join(blocks)


def _rectangles(model: BrickModel, pairs: Index, axis: int) -> Sides:
    """Common side rectangles of brick pairs, shape (n, 2), that are neighbours along an axis."""
    first, second = pairs.T
    low = np.maximum(model.corner[first], model.corner[second])
    ends = model.corner + model.size
    high = np.minimum(ends[first], ends[second])
    low[:, axis] = high[:, axis] = ends[first, axis]
    return Sides(first, second, np.full(len(first), axis), low, high)
