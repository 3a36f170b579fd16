"""Read LDraw models (.ldr, .mpd) of plain bricks, plates and baseplates.

A cell is 20 units of .4 mm wide, a brick is 24 units high, a plate 8. y points down; the origin of
a part is the centre of its top face. A line may place a model of the file instead of a part.
A baseplate is held; without a baseplate, the reader adds a baseplate under the lowest layer.

    0 FILE name          start of a model (.mpd); the first model is built
    1 colour x y z  a b c d e f g h i  part

References
----------
LDraw file format, version 1.0.2; MPD, multi-part documents.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from kilter.arrays import Array, Index
from kilter.assembly import Assembly
from kilter.assembly.bricks import BrickModel, StudRules, assembly_of_bricks
from kilter.assembly.bricks.brick_library import LDRAW, NO_COLOR, brick_mass
from kilter.assembly.part import COLOR_CODES
from kilter.errors import InputError, some
from kilter.files.file_tolerances import OFF_GRID
from kilter.files.limits import DEEPEST, MOST_LISTED, MOST_TABLE_BYTES, read_bytes, require_count
from kilter.files.reader_guard import reader_guard

LDRAW_FILES = (".ldr", ".mpd")
"""Endings of LDraw files."""
CELL, PLATE = 20.0, 8.0
"""Width of a cell, and height of a plate [LDraw units]."""
CELL_MM = 8.0
"""Width of a cell [mm]."""
INHERITED = 16
"""Colour code of a part that takes the colour of the model around it."""
NUMBERS = 13
"""Number of values before the part name in a line of type 1: colour, position, matrix."""
DRAWN = ("2", "3", "4", "5")
"""Types of lines that draw edges and faces and place no part."""
TO_CELLS = np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]])
"""Rotation from the axes of LDraw (y down) to axes with z up."""


@dataclass(frozen=True, slots=True)
class _PartLine:
    """A line of an LDraw file that places a part, or another model of the file."""

    number: int
    color: int
    place: Array
    matrix: Array
    part: str


@dataclass(frozen=True, slots=True)
class _PlacedBrick:
    """A brick with its place in the whole model, and its size in studs and plates."""

    line: int
    color: int
    place: Array
    matrix: Array
    size: tuple[int, int, int]


def load_ldraw(path: Path, *, rules: StudRules | None = None) -> Assembly:
    """Read an LDraw model as an assembly, in mm.

    Raises `InputError` if a line is invalid, or a part is not a plain brick or plate, is tilted or
    off the grid, or occupies a cell of another part; the error names the line.
    """
    with reader_guard(path):
        data = read_bytes(path, most=MOST_TABLE_BYTES)
        models, notes = _models(data)
        bricks = list(_placed_bricks(models))
        if not bricks:
            raise InputError("the file has no bricks", hint="give a model with lines of type 1")
        model = _grid_model(bricks)
        return assembly_of_bricks(model, rules=rules, cell=CELL_MM, source=str(path), notes=notes)


def _models(data: bytes) -> tuple[dict[str, list[_PartLine]], list[str]]:
    """Lines that place parts, for each model of the file by name, and notes."""
    models: dict[str, list[_PartLine]] = {}
    lines: list[_PartLine] = []
    drawn = 0
    for number, text in enumerate(data.decode("utf-8-sig", errors="replace").splitlines(), 1):
        words = text.split(maxsplit=2)
        if words[:2] == ["0", "FILE"]:
            name = _key(words[2] if len(words) > 2 else "")
            if name in models:
                raise InputError(f"line {number}: two models are named {name!r:.60}")
            lines = models[name] = []
        elif words and words[0] == "1":
            if not models:
                models[""] = lines
            lines.append(_line(number, text))
        elif words and words[0] in DRAWN:
            drawn += 1
        elif words and words[0] != "0":
            hint = "lines begin with a number from 0 to 5"
            raise InputError(
                f"line {number}: {text.strip()!r:.60} is not a line of LDraw", hint=hint
            )
    notes = [f"{drawn} drawn edges and faces are ignored"]
    return models, notes if drawn else []


def _key(name: str) -> str:
    """Name of a part or model in a normal form, so that equal names compare equal."""
    return name.strip().lower().replace("\\", "/")


def _line(number: int, text: str) -> _PartLine:
    """Parse a line that places a part (type 1); raises `InputError` if it is invalid."""
    words = text.split(maxsplit=NUMBERS + 1)
    try:
        values = np.array([float(word) for word in words[2 : NUMBERS + 1]])
        if len(words) < NUMBERS + 2 or not np.isfinite(values).all():
            raise ValueError
        color = int(words[1], 0)
        if not 0 <= color < COLOR_CODES:
            raise ValueError
    except ValueError:
        raise InputError(
            f"line {number}: {text.strip()!r:.60} does not place a part",
            hint="write 1, a colour, three coordinates, nine numbers of a matrix, and the part",
        ) from None
    return _PartLine(number, color, values[:3], values[3:].reshape(3, 3), _key(words[-1]))


def _placed_bricks(models: dict[str, list[_PartLine]]) -> Iterator[_PlacedBrick]:
    """Yield the bricks of the first model, including those of the models that it contains.

    Raises `InputError` if a model contains itself, parts are unknown, or there are too many bricks;
    the error names all unknown parts.
    """
    if not models:
        return
    first = next(iter(models))
    bricks = _brick_counts(models, first)
    require_count("parts", bricks[first], MOST_LISTED)

    def within(name: str, place: Array, matrix: Array, color: int) -> Iterator[_PlacedBrick]:
        """Yield the bricks of a model at its place in the whole."""
        for line in models[name]:
            part_color = color if line.color == INHERITED else line.color
            at, turned = place + matrix @ line.place, matrix @ line.matrix
            if line.part not in models:
                size = LDRAW[_number(line.part)]
                yield _PlacedBrick(line.number, part_color, at, turned, size)
            elif bricks[line.part]:  # models without bricks may be placed without end
                yield from within(line.part, at, turned, part_color)

    with np.errstate(all="ignore"):  # the grid rejects numbers that are not finite
        yield from within(first, np.zeros(3), np.eye(3), INHERITED)


def _brick_counts(models: dict[str, list[_PartLine]], first: str) -> dict[str, int]:
    """Number of bricks in the first model and in each model that it contains, by name.

    Each model is counted once, so that the time does not grow with the number of bricks. Raises
    `InputError` for a model that contains itself and for unknown parts.
    """
    counts: dict[str, int] = {}
    unknown: dict[str, int] = {}

    def count(name: str, way: tuple[str, ...]) -> int:
        """Number of bricks of a model; `way` lists the models around it and the model."""
        total = 0
        for line in models[name]:
            if line.part in way or len(way) > DEEPEST:
                fault = "contains itself" if line.part in way else "is nested too deeply"
                raise InputError(
                    f"line {line.number}: the model {line.part!r:.60} {fault}",
                    hint="remove the line",
                )
            if line.part in models:
                if line.part not in counts:
                    counts[line.part] = count(line.part, (*way, line.part))
                total += counts[line.part]
            elif _number(line.part) in LDRAW:
                total += 1
            else:
                unknown.setdefault(line.part, line.number)
        return total

    counts[first] = count(first, (first,))
    if unknown:
        words = [f"line {number}: {part!r:.60}" for part, number in unknown.items()]
        raise InputError(
            f"not a plain brick, plate or baseplate: {some(words, 8)}",
            hint="remove these parts, or replace them by bricks",
        )
    return counts


def _number(part: str) -> str:
    """LDraw number of a part, such as 3001, from the name of its file, ``3001.dat``."""
    return re.sub(r"\.dat$", "", part)


def _grid_model(bricks: list[_PlacedBrick]) -> BrickModel:
    """The bricks on a grid of whole cells and plates, the lowest layer at 0.

    Raises `InputError` if a brick does not fit the grid.
    """
    line = np.array([brick.line for brick in bricks])
    studs = np.array([brick.size for brick in bricks])
    held = studs[:, 2] == 0
    turns = TO_CELLS @ np.array([brick.matrix for brick in bricks]) @ TO_CELLS.T
    whole = np.round(turns)
    upright = (np.abs(turns - whole).max(axis=(1, 2)) <= OFF_GRID) & (whole[:, 2, 2] == 1)
    upright &= (np.abs(whole).sum(axis=1) == 1).all(axis=1)
    upright &= (np.abs(whole).sum(axis=2) == 1).all(axis=1)
    if not upright.all():
        raise InputError(
            f"line {line[~upright][0]}: the part is tilted or upside down",
            hint="bricks must be upright, turned by multiples of 90 degrees",
        )
    # the longer side of a part lies along x of its own frame
    along_x = whole[:, 0, 0] != 0
    across = np.where(along_x[:, None], studs[:, [1, 0]], studs[:, [0, 1]])
    plates = np.where(held, 1, studs[:, 2])
    size = np.column_stack([across, plates])
    top = np.array([brick.place for brick in bricks]) @ TO_CELLS.T
    low = (top - np.column_stack([across / 2, plates]) * [CELL, CELL, PLATE]) / [CELL, CELL, PLATE]
    low[held, 2] = top[held, 2] / PLATE - 1
    corner = _cells(low, line)
    corner[:, 2] -= corner[~held, 2].min() if (~held).any() else corner[:, 2].max() + 1
    mass = _masses(studs)
    count = np.arange(1, len(line) + 1)
    color = np.array([NO_COLOR if b.color == INHERITED else b.color for b in bricks])
    return BrickModel(corner, size, mass, color, held, count, line)


def _cells(low: Array, line: Index) -> Index:
    """Grid cell of the lowest corner of each brick, shape (n, 3), from corners in cell units.

    Arguments: `low` (n, 3): lowest corners [cells, cells, plates]; they share the fraction of the
    first corner; `line` (n,): line of each part, for the message.
    """
    beside = low - low[0]
    whole = np.round(beside)
    off = np.abs(beside - whole).max(axis=1) > OFF_GRID
    if off.any():
        raise InputError(
            f"line {line[off][0]}: the part is off the grid of the part in line {line[0]}",
            hint="place bricks stud on stud, in steps of 20 units sideways and 8 upwards",
        )
    result: Index = whole.astype(np.int64) + np.floor(low[0] + OFF_GRID).astype(np.int64)
    return result


def _masses(studs: Index) -> Array:
    """Mass of each brick [kg]; a baseplate has an arbitrary mass, since it is held."""
    kinds, kind = np.unique(studs, axis=0, return_inverse=True)
    return np.array([brick_mass(a, b, max(h, 1)) for a, b, h in kinds.tolist()])[kind]
