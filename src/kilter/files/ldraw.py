"""LDraw models (.ldr, .mpd) of plain bricks, plates and baseplates.

A cell is 20 units of .4 mm, a brick 24 high, a plate 8; y points down, the origin of a part is in
the middle of its top. Models in the file stand for all their parts, wherever they are named. A
baseplate is held; where there is none, one is put under the lowest layer.

    0 FILE name          a model begins (.mpd); the first one is built
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
from kilter.assembly.brick import COLOR_CODES
from kilter.assembly.bricks import BrickModel, StudRules, assembly_of_bricks
from kilter.assembly.bricks.brick_library import LDRAW, brick_mass
from kilter.assembly.bricks.brick_model import NO_COLOR
from kilter.errors import InputError, some
from kilter.files.file_tolerances import OFF_GRID
from kilter.files.raw import read_bytes

__all__ = ["LDRAW_FILES", "load_ldraw"]

LDRAW_FILES = (".ldr", ".mpd")
"""Endings of such files."""
CELL, PLATE = 20.0, 8.0
"""Units of a cell, and of a plate's height."""
CELL_MM = 8.0
"""Width of a cell [mm]."""
INHERITED = 16
"""The colour of the model that names the part."""
DEEPEST = 100
"""Models within models."""
NUMBERS = 13
"""Colour, place and matrix of a line."""
DRAWN = ("2", "3", "4", "5")
"""Lines and faces that are drawn beside the parts."""
TO_CELLS = np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]])
"""From LDraw's axes, y down, to x, y, z with z up."""


@dataclass(frozen=True, slots=True)
class _PartLine:
    """A part as a line of the file places it."""

    number: int
    color: int
    place: Array
    matrix: Array
    part: str


@dataclass(frozen=True, slots=True)
class _Placed:
    """A brick in the whole model."""

    line: int
    color: int
    place: Array
    matrix: Array
    size: tuple[int, int, int]


def load_ldraw(path: Path, *, rules: StudRules | None = None) -> Assembly:
    """The assembly of an LDraw model, in mm.

    Raises
    ------
    InputError
        If a line is broken, a part is no plain brick or plate, stands askew or off the grid, or in
        the cell of another; it names the line.
    """
    try:
        data = read_bytes(path)
        models, notes = _models(data)
        placed = list(_placed(models))
        if not placed:
            raise InputError("no brick in the file", hint="give a model with lines of type 1")
        model = _on_grid(placed)
        return assembly_of_bricks(model, rules=rules, cell=CELL_MM, source=str(path), notes=notes)
    except InputError as error:
        raise error.located(file=str(path)) from None


def _models(data: bytes) -> tuple[dict[str, list[_PartLine]], list[str]]:
    """The lines of each model by its name, the first one first, and notes on what is left out."""
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
            raise InputError(f"line {number}: {text.strip()!r:.60} is no line of LDraw", hint=hint)
    notes = [f"{drawn} lines and faces that are drawn beside the parts are left out"]
    return models, notes if drawn else []


def _key(name: str) -> str:
    return name.strip().lower().replace("\\", "/")


def _line(number: int, text: str) -> _PartLine:
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
            hint="write 1, a colour, three numbers, nine of a matrix, and the part",
        ) from None
    return _PartLine(number, color, values[:3], values[3:].reshape(3, 3), _key(words[-1]))


def _placed(models: dict[str, list[_PartLine]]) -> Iterator[_Placed]:
    """The bricks of the first model, through all models in it.

    Raises
    ------
    InputError
        If models go round in a circle, or parts are not known: it names them all.
    """
    unknown: dict[str, int] = {}

    def within(
        name: str, place: Array, matrix: Array, color: int, way: tuple[str, ...]
    ) -> Iterator[_Placed]:
        for line in models[name]:
            own = color if line.color == INHERITED else line.color
            at, turned = place + matrix @ line.place, matrix @ line.matrix
            size = LDRAW.get(_number(line.part))
            if line.part in models:
                if line.part in way or len(way) > DEEPEST:
                    raise InputError(
                        f"line {line.number}: the model {line.part!r:.60} is within itself",
                        hint="take it out there",
                    )
                yield from within(line.part, at, turned, own, (*way, line.part))
            elif size is not None:
                yield _Placed(line.number, own, at, turned, size)
            else:
                unknown.setdefault(line.part, line.number)

    if models:
        first = next(iter(models))
        yield from within(first, np.zeros(3), np.eye(3), INHERITED, (first,))
    if unknown:
        words = [f"line {number}: {part!r:.60}" for part, number in unknown.items()]
        raise InputError(
            f"no plain brick, plate or baseplate: {some(words, 8)}",
            hint="leave these parts out, or put bricks in their place",
        )


def _number(part: str) -> str:
    """The number of a part: ``3001.dat`` is 3001."""
    return re.sub(r"\.dat$", "", part)


def _on_grid(placed: list[_Placed]) -> BrickModel:
    """The bricks in whole cells and plates, the lowest layer at 0."""
    line = np.array([one.line for one in placed])
    studs = np.array([one.size for one in placed])
    held = studs[:, 2] == 0
    turns = TO_CELLS @ np.array([one.matrix for one in placed]) @ TO_CELLS.T
    whole = np.round(turns)
    upright = (np.abs(turns - whole).max(axis=(1, 2)) <= OFF_GRID) & (whole[:, 2, 2] == 1)
    upright &= (np.abs(whole).sum(axis=1) == 1).all(axis=1)
    upright &= (np.abs(whole).sum(axis=2) == 1).all(axis=1)
    if not upright.all():
        raise InputError(
            f"line {line[~upright][0]}: the part is turned askew or upside down",
            hint="bricks stand upright, turned by quarters",
        )
    # a part's longer side lies along its own x
    along_x = whole[:, 0, 0] != 0
    across = np.where(along_x[:, None], studs[:, [1, 0]], studs[:, [0, 1]])
    plates = np.where(held, 1, studs[:, 2])
    size = np.column_stack([across, plates])
    top = np.array([one.place for one in placed]) @ TO_CELLS.T
    low = (top - np.column_stack([across / 2, plates]) * [CELL, CELL, PLATE]) / [CELL, CELL, PLATE]
    low[held, 2] = top[held, 2] / PLATE - 1
    corner = _whole(low, line)
    corner[:, 2] -= corner[~held, 2].min() if (~held).any() else corner[:, 2].max() + 1
    mass = _masses(studs)
    count = np.arange(1, len(line) + 1)
    color = np.array([NO_COLOR if one.color == INHERITED else one.color for one in placed])
    return BrickModel(corner, size, mass, color, held, count, line)


def _whole(low: Array, line: Index) -> Index:
    """Corners in whole cells from that of the first part."""
    beside = low - low[0]
    whole = np.round(beside)
    off = np.abs(beside - whole).max(axis=1) > OFF_GRID
    if off.any():
        raise InputError(
            f"line {line[off][0]}: the part is off the grid of the part of line {line[0]}",
            hint="bricks stand stud on stud: 20 units aside, 8 up",
        )
    result: Index = whole.astype(np.int64) + np.floor(low[0] + OFF_GRID).astype(np.int64)
    return result


def _masses(studs: Index) -> Array:
    """Mass of each part [kg]; of baseplates, which are held, it does not matter."""
    kinds, kind = np.unique(studs, axis=0, return_inverse=True)
    return np.array([brick_mass(a, b, max(h, 1)) for a, b, h in kinds.tolist()])[kind]
