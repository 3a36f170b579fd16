"""Read StableLego JSON: ``{"1": {"x", "y", "z", "brick_id", "ori"}}``, one brick per key.

(x, y) is the lowest cell, z the layer from 0. With ori 0 the first number of studs of the library
is along x, with 1 along y.

References
----------
StableLego: Stability Analysis of Block Stacking Assembly, arXiv 2402.10711, and its data set.
"""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np

from kilter.arrays import Index
from kilter.assembly import Assembly
from kilter.assembly.bricks import BrickModel, StudRules, assembly_of_bricks
from kilter.assembly.bricks.brick_library import (
    NO_COLOR,
    STABLE_LEGO,
    STATED,
    brick_mass,
    is_stated,
    studded_all_over,
)
from kilter.assembly.part import BRICK_PLATES
from kilter.errors import InputError
from kilter.files.limits import MOST_LISTED, MOST_TABLE_BYTES, read_bytes, require_count
from kilter.files.reader_guard import reader_guard

# Read BrickGPT text: one brick ``hxw (x,y,z)`` per line.


BRICK_TEXT = (".txt",)
"""Endings of BrickGPT files."""
BRICK = re.compile(r"(\d{1,4})x(\d{1,4}) \((-?\d{1,6}), ?(-?\d{1,6}), ?(-?\d{1,6})\)")
EXAMPLE = "write a brick like 2x4 (10,3,0)"


def load_brick_text(path: Path, *, rules: StudRules | None = None) -> Assembly:
    """Read a BrickGPT file as an assembly; empty lines are ignored.

    Raises `InputError` if a line is not a brick, or its brick has an unknown size, a negative
    layer, or a cell of another brick; the error names the line.
    """
    with reader_guard(path):
        return _read(read_bytes(path, most=MOST_TABLE_BYTES), rules, str(path))


def _read(data: bytes, rules: StudRules | None, source: str) -> Assembly:
    """Parse the bytes of a BrickGPT file into an assembly."""
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise InputError(f"line {line}: not UTF-8", hint=EXAMPLE) from None
    lines = [(k, line.strip()) for k, line in enumerate(text.splitlines(), 1) if line.strip()]
    if not lines:
        raise InputError("the file has no bricks", hint=EXAMPLE)
    require_count("parts", len(lines), MOST_LISTED)
    matches = [(k, BRICK.fullmatch(line)) for k, line in lines]
    rows = np.array(
        [[k, *map(int, match.groups())] if match else [k, 0, 0, 0, 0, 0] for k, match in matches]
    )
    number, size, corner = rows[:, 0], rows[:, 1:3], rows[:, 3:]
    kinds, kind = np.unique(size, axis=0, return_inverse=True)
    known = np.array([is_stated(a, b, BRICK_PLATES) for a, b in kinds.tolist()])
    wrong = np.flatnonzero(~known[kind] | (corner[:, 2] < 0))
    if len(wrong):
        k = wrong[0]
        raise _line_error(lines[k], matches[k][1])
    mass = np.array([brick_mass(a, b) for a, b in kinds.tolist()])[kind]
    zeros = np.zeros(len(rows), dtype=np.int64)
    model = BrickModel(
        corner=corner * [1, 1, BRICK_PLATES],
        size=np.column_stack([size, zeros + BRICK_PLATES]),
        mass=mass,
        color=zeros + NO_COLOR,
        held=zeros > 0,
        number=number,
        line=number,
        studded=studded_all_over(size),
    )
    return assembly_of_bricks(model, rules=rules, source=source)


def _line_error(line: tuple[int, str], match: re.Match[str] | None) -> InputError:
    """The error for an invalid line, given as (number, text), with its partial match if any."""
    number, text = line
    if match is None:
        return InputError(f"line {number}: {text!r:.60} is not a brick", hint=EXAMPLE)
    across, along, _, _, z = map(int, match.groups())
    if z < 0:
        hint = "layers are counted from 0, on the baseplate"
        return InputError(f"line {number}: the brick is in layer {z}", hint=hint)
    sizes = sorted(STATED)
    return InputError(
        f"line {number}: a brick of {across}x{along} is unknown",
        hint=f"known sizes are {', '.join(f'{a}x{b}' for a, b in sizes)}, in either order",
    )


KEYS = ("x", "y", "z", "brick_id", "ori")
"""Keys of a brick."""
FARTHEST = 10**6
"""Largest coordinate of a brick [cells]; grid positions are computed as integers."""


def is_stable_lego(data: Any) -> bool:
    """Whether JSON data are a StableLego model, even if entries of bricks are invalid.

    Examples
    --------
    >>> is_stable_lego({"1": {"x": 0, "y": 0, "z": 0, "brick_id": 2, "ori": 0}})
    True
    >>> is_stable_lego({"kilter": 1, "parts": []}), is_stable_lego([1])
    (False, False)
    """
    return isinstance(data, dict) and any(
        isinstance(brick, dict) and "brick_id" in brick for brick in data.values()
    )


def from_stable_lego(
    data: dict[str, Any], text: bytes, *, rules: StudRules | None = None, source: str = ""
) -> Assembly:
    """Build the assembly of a StableLego file.

    Raises `InputError` if a brick is unknown, damaged, in a negative layer, or in a cell of another
    brick; the error names the line.
    """
    try:
        values = [list(map(brick.get, KEYS)) for brick in data.values()]
        whole = all(type(value) is int for row in values for value in row)
        rows = np.array(values) if whole else np.zeros((0, len(KEYS)))
        whole = whole and rows.dtype.kind == "i" and bool((np.abs(rows) <= FARTHEST).all())
        whole = whole and bool((rows[:, 2] >= 0).all())
    except (AttributeError, TypeError, ValueError, OverflowError):
        whole = False
    with reader_guard(source):
        require_count("parts", len(data), MOST_LISTED)
        if not whole or not _in_library(rows).all():
            raise _first_error(data, text)
        library = np.array([STABLE_LEGO[k] for k in rows[:, 3].tolist()])
        size = library[:, :2].astype(np.int64)
        turned = rows[:, 4] == 1
        size[turned] = size[turned, ::-1]
        count = len(rows)
        layer = np.full(count, BRICK_PLATES)
        model = BrickModel(
            corner=np.column_stack([rows[:, :2], rows[:, 2] * BRICK_PLATES]),
            size=np.column_stack([size, layer]),
            mass=library[:, 2],
            color=np.full(count, NO_COLOR),
            held=np.zeros(count, dtype=bool),
            number=_numbers(data),
            line=_lines(data, text),
            studded=studded_all_over(size),
        )
        return assembly_of_bricks(model, rules=rules, source=source)


def _in_library(rows: Any) -> Any:
    """Mask of bricks whose brick_id and orientation are known, shape (n,)."""
    return np.isin(rows[:, 3], list(STABLE_LEGO)) & np.isin(rows[:, 4], (0, 1))


def _numbers(data: dict[str, Any]) -> Index:
    """Number of each brick: its key if all keys are distinct integers, else its position."""
    if all(re.fullmatch(r"\d{1,9}", key) for key in data):
        numbers = np.array([int(key) for key in data])
        if len(np.unique(numbers)) == len(numbers):
            return numbers
    return np.arange(1, len(data) + 1)


def _lines(data: dict[str, Any], text: bytes) -> Index:
    """Line number in the file of each brick's key; 0 for all if they cannot be located."""
    matches = re.compile(rb'\n|"((?:[^"\\]|\\.)*)"\s*:\s*\{').finditer(text)
    line, lines = 1, []
    for match in matches:
        if match.group(1) is None:
            line += 1
        else:
            lines.append(line)
            line += match.group(0).count(b"\n")
    if len(lines) != len(data):
        return np.zeros(len(data), dtype=np.int64)
    return np.array(lines, dtype=np.int64)


def _first_error(data: dict[str, Any], text: bytes) -> InputError:
    """Build the error for the first invalid brick of a file."""
    lines = _lines({k: v for k, v in data.items() if isinstance(v, dict)}, text).tolist()
    line_of_key = dict(zip([k for k, v in data.items() if isinstance(v, dict)], lines, strict=True))
    for key, brick in data.items():
        fault = _fault(brick)
        if fault:
            line = line_of_key.get(key) or _line_of(key, text)
            return InputError(f"line {line}: brick {key!r:.40} {fault[0]}", hint=fault[1])
    return InputError("the bricks cannot be read", hint="export the model again")


def _line_of(key: str, text: bytes) -> int:
    """Number of the line in which a key first occurs in the text."""
    place = text.find(json.dumps(key).encode())
    return text.count(b"\n", 0, max(place, 0)) + 1


def _fault(brick: Any) -> tuple[str, str] | None:
    """Two phrases for a brick's first fault: the fault, and what to do; None if it is valid."""
    if not isinstance(brick, dict):
        return f"is {brick!r:.40}", f"give an object with {', '.join(KEYS)}"
    for name in KEYS:
        value = brick.get(name)
        if type(value) is not int or abs(value) > FARTHEST:
            return f"has {name} {value!r:.40}", "give a whole number"
    if brick["z"] < 0:
        return f"is in layer {brick['z']}", "layers are counted from 0, on the baseplate"
    if brick["brick_id"] not in STABLE_LEGO:
        known = ", ".join(map(str, STABLE_LEGO))
        return f"has the unknown brick_id {brick['brick_id']}", f"the library has {known}"
    if brick["ori"] not in (0, 1):
        return f"has ori {brick['ori']}", "give 0 for along x, 1 for along y"
    return None
