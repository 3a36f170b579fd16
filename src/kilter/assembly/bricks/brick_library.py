"""Sizes, LDraw part numbers and masses of bricks, plates, tiles, slopes and baseplates.

The libraries of StableLego and BrickGPT state the masses of some sizes. The masses of other sizes
are estimated by a fit to the stated masses, with a term for the top with its studs and a term for
the walls:

    m = top * cells + wall * perimeter * height

References
----------
StableLego (arXiv 2402.10711), ``lego_library.json``; BrickGPT, ``brick_library.json``;
LDraw parts library, numbers of "Brick", "Plate", "Tile", "Slope Brick", "Baseplate".
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from functools import cache
from typing import NamedTuple

import numpy as np

from kilter.arrays import Array, Index, Mask, Rows, columns, counted, distinct_rows
from kilter.assembly.part import BRICK_PLATES
from kilter.errors import InputError
from kilter.validate import number

STABLE_LEGO: dict[int, tuple[int, int, float]] = {
    1: (2, 2, 0.2),
    2: (2, 4, 0.00216),
    3: (2, 6, 0.00323),
    4: (1, 8, 0.00303),
    5: (1, 4, 0.00157),
    6: (1, 6, 0.00228),
    9: (1, 2, 0.00081),
    10: (1, 1, 0.00043),
    12: (2, 2, 0.00115),
}
"""Studs across, studs along and mass [kg] by the number in the library; number 1 is a weight."""
STATED = {(across, along): mass for k, (across, along, mass) in STABLE_LEGO.items() if k != 1}
"""Stated masses of bricks [kg], by size."""


def _sizes(plates: int, listed: str) -> dict[str, tuple[int, int, int]]:
    """Parse words ``number:acrossxalong`` to the size of each brick: studs, studs, plates."""
    sizes = {}
    for word in listed.split():
        number, size = word.split(":")
        across, along = map(int, size.split("x"))
        sizes[number] = (across, along, plates)
    return sizes


LDRAW: dict[str, tuple[int, int, int]] = {
    **_sizes(
        BRICK_PLATES,
        "3005:1x1 3004:1x2 3622:1x3 3010:1x4 3009:1x6 3008:1x8 6111:1x10 6112:1x12 2465:1x16 "
        "3003:2x2 3002:2x3 3001:2x4 2456:2x6 44237:2x6 3007:2x8 3006:2x10 4201:8x8 4202:4x12",
    ),
    **_sizes(
        1,
        "3024:1x1 3023:1x2 3623:1x3 3710:1x4 3666:1x6 3460:1x8 4477:1x10 60479:1x12 "
        "3022:2x2 3021:2x3 3020:2x4 3795:2x6 3034:2x8 3832:2x10 2445:2x12 91988:2x14 4282:2x16 "
        "11212:3x3 3031:4x4 3032:4x6 3035:4x8 3030:4x10 3029:4x12 "
        "3958:6x6 3036:6x8 3033:6x10 3028:6x12 3456:6x14 3027:6x16 3026:6x24 41539:8x8 92438:8x16",
    ),
    **_sizes(0, "3865:8x16 3867:16x16 3334:16x24 3857:16x32 3811:32x32 4186:48x48"),
}
"""Studs across, studs along and height in plates by LDraw part number; height 0 is a baseplate."""
TILES: dict[str, tuple[int, int, int]] = _sizes(
    1,
    "3070:1x1 3069:1x2 63864:1x3 2431:1x4 6636:1x6 4162:1x8 3068:2x2 26603:2x3 87079:2x4 69729:2x6"
    " 6934:3x6 1751:4x4 48288:8x16",
)
"""Tiles by LDraw part number: plates without studs."""
SLOPES: dict[str, tuple[int, int, int]] = _sizes(
    BRICK_PLATES,
    "3040:1x2 3039:2x2 3038:3x2 3037:4x2 23949:6x2 4445:8x2 4286:1x3 3298:2x3 4161:3x3 3297:4x3 "
    "3939:6x3",
)
"""Slopes by LDraw part number: cells along the edge and down the slope; the first row has studs."""
LIP = 0.5
"""Height of the low edge of a slope [plates]."""


class BrickKind(NamedTuple):
    """Size of an LDraw part in its own frame, x along the part and y towards its back [cells].

    `size`: cells along x and y, plates (0: a baseplate); `studded`: lowest and highest corner of
    the cells with studs, (x, y, x, y); `middle`: y of the middle of its cells.
    """

    size: tuple[int, int, int]
    studded: tuple[int, int, int, int]
    middle: float = 0.0


def brick_kind(number: str) -> BrickKind | None:
    """Find the kind of an LDraw part; letters behind its number are moulds and prints.

    Examples
    --------
    >>> brick_kind("3069bp07"), brick_kind("3039").middle, brick_kind("3176")
    (BrickKind(size=(2, 1, 1), studded=(0, 0, 0, 0), middle=0.0), -0.5, None)
    """
    plain = re.fullmatch(r"(\d+)[a-d]?(p\w+)?", number)
    base = plain[1] if plain else ""
    if base in LDRAW:
        across, along, plates = LDRAW[base]
        return BrickKind((along, across, plates), (0, 0, along, across))
    if base in TILES:
        across, along, plates = TILES[base]
        return BrickKind((along, across, plates), (0, 0, 0, 0))
    if base in SLOPES:
        wide, deep, plates = SLOPES[base]
        return BrickKind((wide, deep, plates), (0, deep - 1, wide, deep), 0.5 - deep / 2)
    return None


@cache
def _fit() -> Array:
    """Fitted masses of a cell of the top, and of a wall one stud long and one brick high [kg]."""
    sizes = np.array(list(STATED))
    stated = np.array([*STATED.values()])
    masses: Array = np.linalg.lstsq(_terms(sizes, BRICK_PLATES), stated, rcond=None)[0]
    return masses


def _terms(sizes: Index, plates: Index | int) -> Array:
    """Terms of the mass estimate for brick sizes: cells, and perimeter times height, (n, 2)."""
    height = np.broadcast_to(plates, len(sizes)) / BRICK_PLATES
    return np.column_stack([sizes.prod(axis=1), 2 * sizes.sum(axis=1) * height])


def is_stated(across: int, along: int, plates: int) -> bool:
    """Whether a brick library states the mass of a brick size, so that it is not estimated."""
    return plates == BRICK_PLATES and (min(across, along), max(across, along)) in STATED


def brick_mass(across: int, along: int, plates: int = BRICK_PLATES) -> float:
    """Mass of a brick or plate of the given size, from a library or estimated [kg].

    Examples
    --------
    >>> brick_mass(4, 2)
    0.00216
    >>> f"{brick_mass(2, 3):.5f}, {brick_mass(2, 4, plates=1):.5f}"
    '0.00180, 0.00141'
    """
    if is_stated(across, along, plates):
        return STATED[min(across, along), max(across, along)]
    return float((_terms(np.array([[across, along]]), plates) @ _fit())[0])


def slope_mass(wide: int, deep: int) -> float:
    """Estimated mass of a slope [kg], `wide` cells along its edge and `deep` cells down.

    Examples
    --------
    >>> brick_mass(2, 2, plates=1) < slope_mass(2, 2) < brick_mass(2, 2)
    True
    """
    flank = BRICK_PLATES + (deep - 1) * (BRICK_PLATES + LIP) / 2
    walls = wide * (BRICK_PLATES + LIP) + 2 * flank
    return float(np.array([wide * deep, walls / BRICK_PLATES]) @ _fit())


# BrickModel: bricks on their grid, one row per brick.


NO_COLOR = -1
"""Value of `BrickModel.color` for a brick without a stated colour."""


@dataclass(frozen=True, slots=True, eq=False)
class BrickModel(Rows):
    """N toy bricks on a grid, as arrays."""

    corner: Index = columns(3)
    """Lowest cell of each brick, shape (N, 3): x, y [cells], z [plates]."""
    size: Index = columns(3)
    """Size along x, y [cells] and z [plates], shape (N, 3)."""
    mass: Array = columns()
    """Masses [kg], shape (N,)."""
    color: Index = columns()
    """LDraw colour codes, shape (N,); `NO_COLOR` if none is stated."""
    held: Mask = columns()
    """Whether each brick is held, shape (N,); true for baseplates."""
    number: Index = columns()
    """Number of the brick in the file, shape (N,): its key, or its line."""
    line: Index = columns()
    """Line of the file, shape (N,); 0 for a brick that is in no file."""
    studded: Index = columns(4)
    """Cells with studs from the lowest corner, shape (N, 4): x, y of their lowest and highest
    corner. A tile has none. A slope falls from its cells with studs to the other side."""

    @property
    def top(self) -> Index:
        """Height of the top of each brick [plates], shape (N,)."""
        top: Index = self.corner[:, 2] + self.size[:, 2]
        return top

    @property
    def tiles(self) -> Mask:
        """Bricks without studs, shape (N,)."""
        tiles: Mask = (self.studded == 0).all(axis=1)
        return tiles

    @property
    def slopes(self) -> Mask:
        """Bricks of which some cells have studs, shape (N,)."""
        whole = np.column_stack([np.zeros((len(self), 2), dtype=np.int64), self.size[:, :2]])
        slopes: Mask = (self.studded != whole).any(axis=1) & ~self.tiles
        return slopes

    @property
    def blocks(self) -> BrickModel:
        """The model in which a slope is only the block under its studs."""
        slopes, corner, size = self.slopes, self.corner.copy(), self.size.copy()
        corner[slopes, :2] += self.studded[slopes, :2]
        size[slopes, :2] = self.studded[slopes, 2:] - self.studded[slopes, :2]
        return replace(self, corner=corner, size=size, studded=studded_all_over(size))

    def overlaps(self) -> tuple[Index, Index]:
        """Pairs of bricks that occupy the same cell, shape (n, 2), and x, y of the cell, (n, 2).

        The sloping half of a slope counts as free.
        """
        cells = cells_of(self.blocks)
        low, high = self.corner[cells.brick, 2], self.top[cells.brick]
        clash = np.flatnonzero(cells.same_column & (low[1:] < high[:-1]))
        pairs = np.sort(np.column_stack([cells.brick[clash], cells.brick[clash + 1]]))
        return pairs, cells.xy[clash]

    def require_apart(self) -> None:
        """Raise an InputError if two bricks occupy the same grid cell.

        Raises `InputError` if two bricks overlap; the error names the lines of both, and the cell.
        """
        overlapping, cells = self.overlaps()
        if not len(overlapping):
            return
        pairs = np.sort(self.line[overlapping])
        k = np.lexsort(pairs.T)[0]
        x, y = cells[k]
        other, line = pairs[k]
        raise InputError(
            f"line {line}: cell ({x}, {y}) is occupied by the brick in line {other}",
            hint="move either brick",
        )


def studded_all_over(size: Index) -> Index:
    """Value of `BrickModel.studded` of bricks with studs on all cells, from their sizes (N, 3)."""
    return np.column_stack([np.zeros((len(size), 2), dtype=np.int64), size[:, :2]])


@dataclass(frozen=True, slots=True, eq=False)
class Cells:
    """Grid cells that the bricks cover, sorted by column and height."""

    brick: Index
    """Brick of each cell, shape (C,)."""
    xy: Index
    """Position of each cell, shape (C, 2)."""
    same_column: Mask
    """Whether cell k + 1 is above cell k, shape (C - 1,)."""


def cells_of(model: BrickModel) -> Cells:
    """List the grid cells that the bricks of a model cover."""
    brick, place = counted(model.size[:, 0] * model.size[:, 1])
    along = model.size[brick, 1]
    xy = model.corner[brick, :2] + np.column_stack([place // along, place % along])
    order = np.lexsort((model.corner[brick, 2], xy[:, 1], xy[:, 0]))
    xy = xy[order]
    return Cells(brick[order], xy, (xy[1:] == xy[:-1]).all(axis=1))


# StudRules: the strength of studs, and the contacts between neighbouring bricks.


UNIT = 7.8
"""Width of a cell in StableLego [mm]."""
LAYER = 9.6
"""Height of a brick [mm]."""
GRAVITY = 9.8
"""Acceleration of gravity in StableLego [m/s^2]."""
PULL = 0.98
"""Largest pull at a point of a stud in StableLego [N]: the weight of 100 g."""
NARROW: Array = np.array([[0, -0.25], [-0.25, 0], [0, 0.25], [0.25, 0]])
"""Points of a stud under a brick of width 1, relative to the middle of the stud [cells]."""
WIDE: Array = np.array([[0.125, -0.125], [-0.25, 0], [0.125, 0.125]])
"""Points of a stud under a wider brick, at two walls and a tube [cells]."""
SIDES = ("lower-edge", "face", "none")
"""Values of `sides`: the contact points between neighbouring bricks."""
UNLIMITED, FRICTION = "unlimited", "mu"


@dataclass(frozen=True, slots=True)
class StudRules:
    """Rules for toy bricks: strength of the studs, and contacts of neighbouring bricks.

    Arguments: `pull`: largest pull at each point of a stud [N]; `shear`: largest sideways force at
    each point of a stud: no limit, mu (f_n + pull), or a number [N]. Raises `InputError` if a force
    is negative, or a value is unknown.

    Examples
    --------
    >>> StudRules().pull
    0.98
    >>> StudRules(sides="edge")
    Traceback (most recent call last):
    ...
    kilter.errors.InputError: the sides of bricks are 'edge'; use lower-edge or face or none
    """

    pull: float = PULL
    shear: float | str = UNLIMITED
    sides: str = "lower-edge"

    def __post_init__(self) -> None:
        object.__setattr__(self, "pull", number(self.pull, "pull of a stud", lowest=0))
        if self.shear not in (UNLIMITED, FRICTION):
            try:
                object.__setattr__(self, "shear", number(_float(self.shear), "shear", lowest=0))
            except InputError:
                hint = "use unlimited, mu, or a force in N"
                raise InputError(f"the shear of studs is {self.shear!r:.40}", hint=hint) from None
        if self.sides not in SIDES:
            raise InputError(
                f"the sides of bricks are {self.sides!r:.40}", hint=f"use {' or '.join(SIDES)}"
            )

    @property
    def bond_shear(self) -> float | str | None:
        """Shear strength of studs, as `Bond` expects it; None for no limit."""
        return None if self.shear == UNLIMITED else self.shear


def _float(value: float | str) -> object:
    """A value converted to a float; other values unchanged, for the error message."""
    try:
        return float(value)
    except ValueError:
        return value


# Find the connections of bricks: points of studs between layers, and sides of neighbours.


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
    ...     np.zeros(2, int), np.zeros(2, bool), np.array([1, 2]), np.array([1, 2]),
    ...     np.array([[0, 0, 2, 1], [0, 0, 1, 1]]))
    >>> studs_of(two).point[:, 0]
    array([1.5 , 1.25, 1.5 , 1.75])
    """
    cells = cells_of(model)
    below, above = cells.brick[:-1], cells.brick[1:]
    place = cells.xy[:-1] - model.corner[below, :2]
    studded = (place >= model.studded[below, :2]) & (place < model.studded[below, 2:])
    on = cells.same_column & (model.top[below] == model.corner[above, 2])
    k = np.flatnonzero(on & studded.all(axis=1))
    narrow = model.size[above[k], :2].min(axis=1) == 1
    stud, place = counted(np.where(narrow, len(NARROW), len(WIDE)))
    offset = np.where(narrow[stud, None], NARROW[place], WIDE[np.minimum(place, len(WIDE) - 1)])
    cell = k[stud]
    xy = cells.xy[cell] + 0.5 + offset
    lower, upper = below[cell], above[cell]
    points = np.column_stack([xy, model.corner[upper, 2]])
    order = np.lexsort((place, stud, upper, lower))
    return Studs(lower[order], upper[order], points[order])


def tops_of(model: BrickModel) -> Sides:
    """Find the rectangle over which each tile touches a brick on it; `axis` is 2."""
    cells = cells_of(model)
    below, above = cells.brick[:-1], cells.brick[1:]
    on = cells.same_column & (model.top[below] == model.corner[above, 2]) & model.tiles[below]
    pairs, _ = distinct_rows(np.column_stack([below[on], above[on]]))
    return _rectangles(model, pairs, 2)


def sides_of(model: BrickModel) -> Sides:
    """Find the rectangle over which each two neighbouring bricks touch with their sides.

    The sloping half of a slope pushes no neighbour.
    """
    model = model.blocks
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
