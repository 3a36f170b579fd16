"""Read BrickGPT text: one brick ``hxw (x,y,z)`` per line.

h and w are the numbers of studs along x and y, (x, y) is the lowest cell, z the layer from 0.

References
----------
BrickGPT (Pun et al., arXiv 2505.05469), output format of its models.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from kilter.assembly import Assembly
from kilter.assembly.brick import BRICK_PLATES
from kilter.assembly.bricks import BrickModel, StudRules, assembly_of_bricks
from kilter.assembly.bricks.brick_library import STATED, brick_mass, is_stated
from kilter.assembly.bricks.brick_model import NO_COLOR
from kilter.errors import InputError
from kilter.files.limits import MOST_LISTED, MOST_TABLE_BYTES, require_count
from kilter.files.raw import read_bytes
from kilter.files.reader_guard import reader_guard

__all__ = ["BRICK_TEXT", "load_brick_text"]

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
