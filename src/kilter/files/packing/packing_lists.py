"""Packing plans: lists of boxes with their places, as packing programs write them.

Two forms are read:

    CSV        a header, then a row for each box: name, length, width, height, mass, x, y, z
               (the corner with the least coordinates), and optionally turned (1 or 90: length and
               width exchanged) and max_load (the largest mass that its top may carry [kg]). A
               unit may stand behind a name: "length/mm", "x [mm]", "mass/kg"
    BED-BPP    JSON: orders by name, each a list of items with "flb_coordinates" and "orientation"

The boxes stand upright along x, y and z. Their order in the file is that of packing.

References
----------
BED-BPP: Kagerer et al., "BED-BPP: Benchmarking dataset for robotic bin packing problems", 2023.
"""

from __future__ import annotations

import csv
import io
import math
import re
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from kilter.assembly import Assembly, Part
from kilter.errors import InputError, nearest_name, some_names
from kilter.files.complaints import parse_json
from kilter.files.limits import MOST_BYTES, MOST_LISTED, MOST_TABLE_BYTES, read_bytes, require_count
from kilter.files.reader_guard import reader_guard
from kilter.rigid import Pose
from kilter.shape.primitives import Box
from kilter.tell.csv_cells import name_of_cell
from kilter.units import metres_per_unit
from kilter.validate import number as require_number

# Rows of a table of comma-separated values, with each fault of the text as an `InputError`.


def decoded_table(data: bytes) -> str:
    """The text of a table; raises `InputError` if it is not UTF-8."""
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(
            f"not UTF-8 at byte {error.start}", hint="save the table as UTF-8"
        ) from None


def table_rows(text: str, separator: str = ",") -> Iterator[tuple[int, list[str]]]:
    """Yield the number of the last line and the cells of each row that is not empty.

    Raises
    ------
    InputError
        If a row is no row of a table, for instance because a cell is too long.

    Examples
    --------
    >>> list(table_rows("a,b\\r1,2\\r"))
    [(1, ['a', 'b']), (2, ['1', '2'])]
    """
    rows = csv.reader(io.StringIO(text, newline=None), delimiter=separator)
    try:
        for row in rows:
            if row:
                yield rows.line_num, row
    except csv.Error as error:
        raise InputError(
            f"line {rows.line_num}: {error}", hint="correct the quotes and cells of this line"
        ) from None


CSV = (".csv",)
"""Endings of packing plans as tables (lower case)."""
NAMES = {
    "name": ("name", "item", "id", "article", "box"),
    "length": ("length", "l", "dx", "size x"),
    "width": ("width", "w", "dy", "size y", "depth"),
    "height": ("height", "h", "dz", "size z"),
    "mass": ("mass", "weight", "m"),
    "x": ("x",),
    "y": ("y",),
    "z": ("z",),
    "max_load": ("max load", "max_load"),
    "turned": ("turned", "orientation", "rotated", "rotation"),
}
"""Names of each column in a table, in lower case."""
NEEDED = ("length", "width", "height", "mass", "x", "y", "z")
MASSES = ("mass", "max_load")
LENGTHS = ("length", "width", "height", "x", "y", "z")
KNOWN_UNITS = ("m", "cm", "mm", "in")
UNTURNED, TURNED = ("", "0", "false", "no"), ("1", "90", "true", "yes")
HEADER = "name,length,width,height,mass,x,y,z"
"""Example of a header, for messages."""


@dataclass(frozen=True, slots=True)
class PackedBox:
    """A box of a packing plan."""

    name: str
    size: tuple[float, float, float]
    """Lengths along x, y, z as it stands [length unit]."""
    mass: float
    """[kg]"""
    corner: tuple[float, float, float]
    """Corner with the least coordinates [length unit]."""
    line: int
    """Line of the table, or number of the item in its order, counted from 1."""
    max_load: float | None = None
    """Largest mass that its top may carry [kg]; None without a limit."""


@dataclass(frozen=True, slots=True)
class PackingPlan:
    """Boxes in the order in which they are packed."""

    boxes: tuple[PackedBox, ...]
    units: str
    """One of "m", "cm", "mm", "in"."""
    order: str = ""
    """Name of the order; empty for a table."""
    source: str = ""
    """Path of the file."""

    @property
    def low(self) -> Any:
        """Least coordinates of all boxes, shape (3,) [length unit]."""
        return np.array([box.corner for box in self.boxes]).min(axis=0)

    @property
    def high(self) -> Any:
        """Largest coordinates of all boxes, shape (3,) [length unit]."""
        corner = np.array([box.corner for box in self.boxes])
        return (corner + np.array([box.size for box in self.boxes])).max(axis=0)

    def assembly(self) -> Assembly:
        """The boxes as parts; none of them is held."""
        parts = [
            Part(
                box.name,
                Box(list(box.size)),
                Pose(np.array(box.corner) + np.array(box.size) / 2),
                mass=box.mass,
            )
            for box in self.boxes
        ]
        return Assembly(parts, units=self.units, source=self.source)


def load_plan(
    path: str | Path, *, order: str | None = None, units: str | None = None
) -> PackingPlan:
    """Read a packing plan from a CSV or JSON file.

    Raises `InputError` if the file is no packing plan, or a box is invalid; the error names the
    line.
    """
    path = Path(path)
    is_table = path.suffix.lower() in CSV
    data = read_bytes(path, most=MOST_TABLE_BYTES if is_table else MOST_BYTES)
    with reader_guard(path):
        if is_table:
            plan = _plan_of_table(data, units)
            if order is not None:
                raise InputError("a table has no orders", hint="leave the order out")
        else:
            plan = plan_of_json(parse_json(data), order)
    return PackingPlan(plan.boxes, plan.units, plan.order, str(path))


def is_packing_plan(content: Any) -> bool:
    """Whether JSON data are orders of BED-BPP."""
    if not isinstance(content, dict) or not content:
        return False
    first = next(iter(content.values()))
    return (
        isinstance(first, list)
        and bool(first)
        and isinstance(first[0], dict)
        and {"item", "flb_coordinates"} <= first[0].keys()
    )


def plan_of_json(content: Any, order: str | None = None) -> PackingPlan:
    """The packing plan of an order in BED-BPP data.

    Raises `InputError` if the data are no orders, the order is missing, or an item is invalid.
    """
    if not is_packing_plan(content):
        raise InputError(
            "this is no packing plan",
            hint=f"give orders of BED-BPP, or a CSV with the header {HEADER}",
        )
    names = list(content)
    if order is None and len(names) > 1:
        raise InputError(
            f"has {len(names)} orders: {some_names(names)}",
            hint=f"give order={names[0]!r}",
            option=f"give --order {names[0]}",
        )
    name = names[0] if order is None else order
    if name not in content:
        raise InputError(f"has no order {name!r:.40}", hint=f"its orders are {some_names(names)}")
    items = content[name]
    if not isinstance(items, list) or not items:
        raise InputError(f"the order {name!r:.40} has no items", hint="give a list of items")
    require_count("boxes", len(items), MOST_LISTED)
    boxes = [_item_of_json(entry, k) for k, entry in enumerate(items, 1)]
    return PackingPlan(_named(boxes), "mm", name)


def _item_of_json(entry: Any, number: int) -> PackedBox:
    """The box of an item in BED-BPP data; lengths in mm, mass in kg."""
    item = entry.get("item") if isinstance(entry, dict) else None
    corner = entry.get("flb_coordinates") if isinstance(entry, dict) else None
    if not isinstance(item, dict) or not isinstance(corner, list) or len(corner) != 3:
        raise InputError(
            f"item {number} has no item or no place",
            hint="give the keys of BED-BPP: item, flb_coordinates (3 numbers), orientation",
        )
    *lengths, mass = (
        require_number(item.get(key), f"item {number}: {key}")
        for key in ("length/mm", "width/mm", "height/mm", "weight/kg")
    )
    place = [require_number(x, f"item {number}: flb_coordinates") for x in corner]
    turned = entry.get("orientation", 0)
    if isinstance(turned, bool) or turned not in (0, 1):
        raise InputError(f"item {number}: orientation is {turned!r:.40}", hint="give 0 or 1")
    name = item.get("article") or item.get("id") or f"item {number}"
    if isinstance(name, dict | list | bool):
        raise InputError(f"item {number}: its name is no text", hint="give a text as article")
    return _box(str(name), lengths, mass, place, bool(turned), number, "item")


def _box(
    name: str,
    lengths: Sequence[float],
    mass: float,
    corner: Sequence[float],
    turned: bool,
    line: int,
    word: str,
) -> PackedBox:
    """A valid box; `word` and `line` name its place in messages."""
    for key, value in zip(("length", "width", "height", "mass"), (*lengths, mass), strict=True):
        if not (math.isfinite(value) and value > 0):
            raise InputError(f"{word} {line}: {key} is {value:g}", hint="give a number above 0")
    if not all(math.isfinite(x) for x in corner):
        raise InputError(f"{word} {line}: the place is not finite", hint="give numbers")
    length, width, height = lengths
    size = (width, length, height) if turned else (length, width, height)
    return PackedBox(name, size, mass, (corner[0], corner[1], corner[2]), line)


def _named(boxes: Sequence[PackedBox]) -> tuple[PackedBox, ...]:
    """The boxes with unique names: a repeated name gets the number of the box."""
    times = Counter(box.name for box in boxes)
    return tuple(
        replace(box, name=f"{box.name}#{k}") if times[box.name] > 1 else box
        for k, box in enumerate(boxes, 1)
    )


# tables --------------------------------------------------------------------------------


def _plan_of_table(data: bytes, units: str | None) -> PackingPlan:
    """The packing plan of a CSV table; commas, semicolons or tabs separate its columns."""
    text = decoded_table(data)
    require_count("boxes", text.count("\n") + text.count("\r"), 2 * MOST_LISTED)
    separator = max(",;\t", key=re.split("[\r\n]", text.lstrip(), maxsplit=1)[0].count)
    rows = table_rows(text, separator)
    header = next(rows, None)
    if header is None:
        raise InputError("the table is empty", hint=f"begin with the header {HEADER}")
    columns, unit = _columns(header[1])
    if unit is not None and units is not None and unit != units:
        raise InputError(
            f"the table is in {unit}, but the units given are {units}", hint="leave the units out"
        )
    boxes = [
        _box_of_row(row, columns, line)
        for line, row in rows
        if any(cell.strip() for cell in row) and not row[0].lstrip().startswith("#")
    ]
    if not boxes:
        raise InputError("the table has no boxes", hint="add a row for each box")
    used = unit or units or "m"
    metres_per_unit(used)
    return PackingPlan(_named(boxes), used)


def _columns(header: Sequence[str]) -> tuple[dict[str, int], str | None]:
    """Position of each column by its key, and the length unit that the header states."""
    found: dict[str, int] = {}
    units: set[str] = set()
    every = {name: key for key, names in NAMES.items() for name in names}
    for k, cell in enumerate(header):
        match = re.fullmatch(r"\s*([^\[(/]*?)\s*(?:[\[(/]\s*([A-Za-z]+)\s*[\])]?)?\s*", cell)
        name, unit = (match[1].lower(), match[2]) if match else (cell.strip().lower(), None)
        key = every.get(name.replace("_", " "))
        if key is None:
            near = nearest_name(name, every)
            hint = f"did you mean {near!r}?" if near else f"use the header {HEADER}"
            raise InputError(f"line 1: unknown column {cell.strip()!r:.40}", hint=hint)
        if key in found:
            raise InputError(f"line 1: two columns for {key}", hint="leave one of them out")
        found[key] = k
        if key in LENGTHS and unit is not None:
            if unit not in KNOWN_UNITS:
                raise InputError(f"line 1: unknown unit {unit!r:.20}", hint="use m, cm, mm or in")
            units.add(unit)
        if key in MASSES and unit not in (None, "kg"):
            raise InputError(f"line 1: {key} in {unit!r:.20}", hint=f"give the {key} in kg")
    missing = [key for key in NEEDED if key not in found]
    if missing:
        raise InputError(
            f"line 1: no column for {', '.join(missing)}", hint=f"use the header {HEADER}"
        )
    if len(units) > 1:
        raise InputError(
            f"line 1: two length units, {' and '.join(sorted(units))}", hint="use a single unit"
        )
    return found, units.pop() if units else None


def _box_of_row(row: Sequence[str], columns: dict[str, int], line: int) -> PackedBox:
    """The box in a row of a table."""

    def cell(key: str) -> str:
        position = columns.get(key)
        return "" if position is None or position >= len(row) else row[position].strip()

    def value(key: str) -> float:
        try:
            return float(cell(key))
        except ValueError:
            raise InputError(
                f"line {line}: {key} is {cell(key)!r:.30}",
                hint="give a number such as 0.5",
            ) from None

    turned = cell("turned").lower().removesuffix(".0")
    if turned not in (*UNTURNED, *TURNED):
        raise InputError(f"line {line}: turned is {turned!r:.20}", hint="give 0 or 90")
    lengths = [value(key) for key in ("length", "width", "height")]
    corner = [value(key) for key in ("x", "y", "z")]
    name = cell("name") or f"box {line - 1}"
    box = _box(name, lengths, value("mass"), corner, turned in TURNED, line, "line")
    if not cell("max_load"):
        return box
    limit = value("max_load")
    if not (math.isfinite(limit) and limit >= 0):
        raise InputError(
            f"line {line}: max_load is {limit:g}",
            hint="give a mass from 0, or leave the cell empty",
        )
    return replace(box, max_load=limit)


# Read an assembly sequence from text, CSV or JSON.


def read_sequence(path: Path) -> list[list[str]]:
    """Read an assembly sequence: the names of the parts that each step adds, in order.

    Raises `InputError` if the file cannot be read or has no valid sequence; the error names the
    file.
    """
    data = read_bytes(path, most=MOST_TABLE_BYTES)
    with reader_guard(path):
        if path.suffix.lower() == ".json":
            return _json_steps(parse_json(data))
        text = decoded_table(data)
        return _csv_steps(text) if path.suffix.lower() == ".csv" else _text_steps(text)


def _text_steps(text: str) -> list[list[str]]:
    """Steps of an assembly sequence in a text file: a part name in each line."""
    lines = [line.strip() for line in text.splitlines()]
    return [[line] for line in lines if line and not line.startswith("#")]


def _csv_steps(text: str) -> list[list[str]]:
    """Steps of an assembly sequence in a CSV table: a step in each row."""
    rows = table_rows(text)
    _, header = next(rows, (0, []))
    if "part" not in header:
        raise InputError("the table has no column 'part'", hint="name it in the first line")
    column = header.index("part")
    cells = [row[column] if column < len(row) else "" for _, row in rows]
    return [[name_of_cell(name.strip()) for name in cell.split(";")] for cell in cells]


def _json_steps(data: Any) -> list[list[str]]:
    """Steps of an assembly sequence in JSON data: a list, or the answer of `kilter plan`."""
    steps = data
    if isinstance(data, dict):
        steps = data.get("steps")
        if isinstance(steps, list):
            steps = [entry.get("parts") if isinstance(entry, dict) else None for entry in steps]
    if not isinstance(steps, list) or not steps:
        raise InputError(
            "the file has no sequence",
            hint="give a list of names, or the output of 'kilter plan --json'",
        )
    order = [[step] if isinstance(step, str) else step for step in steps]
    for step in order:
        if not isinstance(step, list) or not all(isinstance(name, str) for name in step):
            raise InputError(f"a step is {step!r:.40}", hint="give names, or lists of names")
    return order
