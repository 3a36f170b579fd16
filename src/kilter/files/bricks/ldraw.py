"""Read LDraw models (.ldr, .mpd) of bricks, plates, tiles, slopes and baseplates.

A cell is 20 units of .4 mm wide, a brick is 24 units high, a plate 8. y points down; the origin of
a part is the centre of its top face. A line may place a model of the file instead of a part.
A baseplate is held; without a baseplate, the reader adds a baseplate under the lowest layer.
Other parts are left out, as are parts that are tilted, off the grid, or in the cells of an earlier
part; a note counts them.

    0 FILE name          start of a model (.mpd); the first model is built, or a named one
    1 colour x y z  a b c d e f g h i  part

References
----------
LDraw file format, version 1.0.2; MPD, multi-part documents.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from kilter.arrays import Array, Index, Mask, distinct_rows
from kilter.assembly import Assembly
from kilter.assembly.bricks import BrickModel, StudRules, assembly_of_bricks
from kilter.assembly.bricks.brick_library import (
    NO_COLOR,
    BrickKind,
    brick_kind,
    brick_mass,
    slope_mass,
)
from kilter.assembly.part import COLOR_CODES
from kilter.errors import InputError, nearest_name, some, some_names
from kilter.files.bricks.brick_lists import FARTHEST
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
    """A brick with its place in the whole model, and its kind."""

    line: int
    color: int
    place: Array
    matrix: Array
    kind: BrickKind
    part: str


def load_ldraw(path: Path, *, rules: StudRules | None = None, name: str | None = None) -> Assembly:
    """Read an LDraw model as an assembly, in mm; `name`: the model of the file, else the first.

    Raises `InputError` if a line is invalid, the file has no model of this name, or no part but
    baseplates is known; the error names the line.
    """
    with reader_guard(path):
        data = read_bytes(path, most=MOST_TABLE_BYTES)
        models, notes = _models(data)
        first = _chosen_model(models, name)
        bricks, unknown = _placed_bricks(models, first)
        left_out = {"kilter knows no such part": unknown}
        model = _apart(*_grid_model(bricks), bricks, left_out) if bricks else None
        words = _left_out_notes(left_out)
        if model is None or model.held.all():
            raise InputError(
                "; ".join(["the file has no bricks that kilter knows", *words]),
                hint="give a model with lines of type 1 that place bricks or plates",
            )
        notes += [*_other_models(models, first, name), *words]
        return assembly_of_bricks(model, rules=rules, cell=CELL_MM, source=str(path), notes=notes)


def _chosen_model(models: dict[str, list[_PartLine]], name: str | None) -> str | None:
    """The model to build: the named one, else the first; None without models.

    Raises `InputError` if no model has the name.
    """
    if name is None:
        return next(iter(models), None)
    if _key(name) not in models:
        near = nearest_name(_key(name), list(models))
        hint = f"did you mean {near!r}?" if near else f"there are: {some_names(list(models))}"
        raise InputError(f"the file has no model {name!r:.60}", hint=hint)
    return _key(name)


def _other_models(
    models: dict[str, list[_PartLine]], first: str | None, asked: str | None
) -> list[str]:
    """A note that names the models of the file that are no part of the one that is built."""
    if asked is not None or first is None:
        return []
    inside, added = {first}, [first]
    while added:
        added = [line.part for name in added for line in models[name] if line.part in models]
        added = list(set(added) - inside)
        inside.update(added)
    others = [name for name in models if name not in inside]
    if not others:
        return []
    return [f"the model {first!r} is read; --model NAME reads another: {some_names(others)}"]


def _left_out_notes(left_out: dict[str, Counter[str]]) -> list[str]:
    """Notes that count and name the parts that are left out, for each reason."""
    notes = []
    for reason, parts in left_out.items():
        count = parts.total()
        words = some([f"{part} ({k})" for part, k in parts.most_common()], 8)
        if count:
            what = "1 part is" if count == 1 else f"{count} parts are"
            notes.append(f"{what} left out ({reason}): {words}; the answer is about the others")
    return notes


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


def _placed_bricks(
    models: dict[str, list[_PartLine]], first: str | None
) -> tuple[list[_PlacedBrick], Counter[str]]:
    """The bricks of a model and of the models that it contains, and counts of unknown parts.

    Raises `InputError` if a model contains itself, or there are too many parts.
    """
    unknown: Counter[str] = Counter()
    if first is None:
        return [], unknown
    parts = _part_counts(models, first)
    require_count("parts", parts[first], MOST_LISTED)

    def within(name: str, place: Array, matrix: Array, color: int) -> Iterator[_PlacedBrick]:
        """Yield the bricks of a model at its place in the whole."""
        for line in models[name]:
            part_color = color if line.color == INHERITED else line.color
            at, turned = place + matrix @ line.place, matrix @ line.matrix
            if line.part in models:
                if parts[line.part]:  # models without parts may be placed without end
                    yield from within(line.part, at, turned, part_color)
            elif kind := brick_kind(_number(line.part)):
                yield _PlacedBrick(line.number, part_color, at, turned, kind, line.part)
            else:
                unknown[line.part[:60]] += 1

    with np.errstate(all="ignore"):  # the grid leaves numbers out that are not finite
        return list(within(first, np.zeros(3), np.eye(3), INHERITED)), unknown


def _part_counts(models: dict[str, list[_PartLine]], first: str) -> dict[str, int]:
    """Number of parts in a model and in each model that it contains, by name.

    Each model is counted once, so that the time does not grow with the number of parts. Raises
    `InputError` for a model that contains itself.
    """
    counts: dict[str, int] = {}

    def count(name: str, way: tuple[str, ...]) -> int:
        """Number of parts of a model; `way` lists the models around it and the model."""
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
            else:
                total += 1
        return total

    counts[first] = count(first, (first,))
    return counts


def _number(part: str) -> str:
    """LDraw number of a part, such as 3001, from the name of its file, ``3001.dat``."""
    return re.sub(r"\.dat$", "", part)


def _apart(
    model: BrickModel,
    fits: Mask,
    bricks: list[_PlacedBrick],
    left_out: dict[str, Counter[str]],
) -> BrickModel | None:
    """The bricks of a model that fit the grid, and lie in no cell of an earlier brick.

    Adds the parts that are left out to `left_out` by their reason. Returns None if none is left.
    """
    free = fits.copy()
    where = np.flatnonzero(fits)
    pairs = where[model.take(fits).overlaps()[0]]
    for first, second in pairs[np.lexsort(pairs.T)].tolist():
        if free[first]:
            free[second] = False
    reasons = {"tilted, or off the grid": ~fits, "in the cells of an earlier part": fits & ~free}
    for reason, odd in reasons.items():
        left_out[reason] = Counter(bricks[k].part[:60] for k in np.flatnonzero(odd).tolist())
    return model.take(free) if free.any() else None


def _grid_model(bricks: list[_PlacedBrick]) -> tuple[BrickModel, Mask]:
    """The bricks on a grid of whole cells and plates, the lowest layer at 0.

    Returns the model, and the mask of the bricks that are not tilted, and fit the grid.
    """
    turns = TO_CELLS @ np.array([brick.matrix for brick in bricks]) @ TO_CELLS.T
    whole = np.round(turns)
    upright = (np.abs(turns - whole).max(axis=(1, 2)) <= OFF_GRID) & (whole[:, 2, 2] == 1)
    upright &= (np.abs(whole).sum(axis=1) == 1).all(axis=1)
    upright &= (np.abs(whole).sum(axis=2) == 1).all(axis=1)
    turn = np.where(upright[:, None, None], whole[:, :2, :2], np.eye(2))
    kinds = [brick.kind for brick in bricks]
    own = np.array([kind.size for kind in kinds])
    held, plates = own[:, 2] == 0, np.maximum(own[:, 2], 1)
    across = np.abs(turn @ own[:, :2, None])[:, :, 0]
    size = np.column_stack([across, plates]).astype(np.int64)
    studded = _turned_cells(np.array([kind.studded for kind in kinds]), own[:, :2], turn)
    middle = turn[:, :, 1] * np.array([[kind.middle] for kind in kinds])
    top = np.array([brick.place for brick in bricks]) @ TO_CELLS.T / [CELL, CELL, PLATE]
    low = top + np.column_stack([middle - across / 2, -plates])
    fits, corner = _cells(low, upright)
    free = fits & ~held
    if free.any():
        corner[:, 2] -= corner[free, 2].min()
    color = np.array([NO_COLOR if b.color == INHERITED else b.color for b in bricks])
    line, count = np.array([brick.line for brick in bricks]), np.arange(1, len(bricks) + 1)
    mass = _masses(kinds)
    return BrickModel(corner, size, mass, color, held, count, line, studded), fits


def _turned_cells(cells: Index, size: Index, turn: Array) -> Index:
    """Cells (n, 4) of bricks of a size (n, 2) after a quarter turn of each about its middle."""
    corners = cells.reshape(-1, 2, 2) - size[:, None] / 2
    turned = corners @ turn.transpose(0, 2, 1)
    turned += np.abs(turn @ size[:, :, None])[:, None, :, 0] / 2
    ends = np.round(np.concatenate([turned.min(axis=1), turned.max(axis=1)], axis=1))
    return np.where((cells == 0).all(axis=1, keepdims=True), 0, ends).astype(np.int64)


def _cells(low: Array, upright: Mask) -> tuple[Mask, Index]:
    """Which bricks fit the grid of the most bricks, and the cell of the lowest corner of each.

    Arguments: `low` (n, 3): lowest corners [cells, cells, plates]; `upright` (n,): bricks that are
    not tilted. Returns the mask (n,) and the cells (n, 3), 0 for bricks that do not fit.
    """
    near = upright & (np.abs(low) < FARTHEST).all(axis=1)
    if not near.any():
        return near, np.zeros(low.shape, dtype=np.int64)
    steps = np.round((low - np.floor(low)) / OFF_GRID).astype(np.int64) % round(1 / OFF_GRID)
    _, kind = distinct_rows(steps[near])
    grid = low[near][int(np.argmax(np.bincount(kind)[kind]))]
    beside = np.where(near[:, None], low - grid, 0.0)
    fits = near & (np.abs(beside - np.round(beside)).max(axis=1) <= OFF_GRID)
    cells = np.round(beside) + np.floor(grid + OFF_GRID)
    return fits, np.where(fits[:, None], cells, 0).astype(np.int64)


def _masses(kinds: Iterable[BrickKind]) -> Array:
    """Mass of each brick [kg]; a baseplate has an arbitrary mass, since it is held."""
    known: dict[BrickKind, float] = {}
    for kind in kinds:
        if kind not in known:
            x, y, plates = kind.size
            sloping = kind.middle != 0
            known[kind] = slope_mass(x, y) if sloping else brick_mass(x, y, max(plates, 1))
    return np.array([known[kind] for kind in kinds])
