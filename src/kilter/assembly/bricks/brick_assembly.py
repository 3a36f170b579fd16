"""Convert bricks on their grid to an assembly: shapes, studs as bonds, contacts of sides.

No contact detection is needed: the integer grid determines which stud is in which brick.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np

from kilter.arrays import Array, Index, distinct_rows
from kilter.assembly import Assembly, Bond, GivenContact, Part
from kilter.assembly.assembly_tolerances import ON_GRID
from kilter.assembly.bricks.brick_library import (
    GRAVITY,
    LAYER,
    LIP,
    NO_COLOR,
    UNIT,
    UNLIMITED,
    BrickModel,
    Sides,
    StudRules,
    Studs,
    is_stated,
    sides_of,
    studded_all_over,
    studs_of,
    tops_of,
)
from kilter.assembly.part import BRICK_PLATES, Brick
from kilter.errors import InputError
from kilter.rigid import Pose
from kilter.shape.primitives import Box, Mesh

BASEPLATE = "baseplate"
"""Name of the held plate under the lowest layer."""
MARGIN = 1
"""Margin of the baseplate around all bricks [cells]."""
HEAVY = 0.1
"""Mass above which a brick is named a weight [kg]."""
BRICKS_HINT = "give an assembly as it was read from a file of bricks"
"""Remedy if an assembly is no model of bricks."""
UP = (0.0, 0.0, 1.0)


def assembly_of_bricks(
    model: BrickModel,
    *,
    rules: StudRules | None = None,
    cell: float = UNIT,
    source: str = "",
    notes: Sequence[str] = (),
) -> Assembly:
    """Build the assembly of a brick model, in mm; a baseplate is added if no brick is held.

    Parameters
    ----------
    model : BrickModel
        At least one brick.
    rules : StudRules, optional
        Strength of studs and contacts of sides; default those of StableLego.
    cell : float
        Width of a cell [mm].
    source : str
        Name of the file, for messages.
    notes : sequence of str

    Raises
    ------
    InputError
        If two bricks occupy the same cell; the error names the lines of both.

    Examples
    --------
    >>> two = BrickModel(
    ...     np.array([[0, 0, 0], [1, 0, 3]]), np.array([[4, 2, 3], [4, 2, 3]]), np.full(2, 0.002),
    ...     np.zeros(2, int), np.zeros(2, bool), np.array([1, 2]), np.array([1, 2]),
    ...     np.array([[0, 0, 4, 2], [0, 0, 4, 2]]))
    >>> assembly = assembly_of_bricks(two)
    >>> assembly.names, [len(bond.points) for bond in assembly.bonds]
    (('2x4-1', '2x4-2', 'baseplate'), [18, 24])
    """
    model.require_apart()
    rules = rules or StudRules()
    if not model.held.any():
        model = BrickModel.join([model, _baseplate(model)])
    names, scale = _names(model), np.array([cell, cell, LAYER / BRICK_PLATES])
    return Assembly(
        list(_parts(model, names, scale)),
        units="mm",
        gravity=(0.0, 0.0, -GRAVITY),
        contacts=[
            *_contacts(sides_of(model), names, scale, rules),
            *_tops(tops_of(model), names, scale),
        ],
        bonds=list(_bonds(model, studs_of(model), names, scale, rules)),
        detect=False,
        source=source,
        notes=[*notes, *_estimate_note(model)],
    )


def is_brick_model(assembly: Assembly) -> bool:
    """Whether an assembly consists of bonded toy bricks."""
    return bool(assembly.bonds) and all(part.brick is not None for part in assembly.parts)


def bricks_of(assembly: Assembly) -> tuple[BrickModel, StudRules, float]:
    """Recover the bricks of an assembly that was read from a file of bricks.

    Returns `model`: bricks in the order of the parts; `cell`: width of a cell [mm]. Raises
    `InputError` if a part is not a brick, or the assembly has loads, joints or no bonds.
    """
    _require_bricks(assembly)
    parts, bricks = assembly.parts, [part.brick for part in assembly.parts if part.brick]
    size = np.array([(*brick.cells, brick.plates) for brick in bricks])
    box = np.array([part.shape.size for part in parts if isinstance(part.shape, Box)])
    low = np.array([part.pose.position for part in parts]) - box / 2
    _require_grid(assembly, low * size / box, box / size)
    numbers = [re.search(r"-(\d+)$", part.name) for part in parts]
    model = BrickModel(
        np.round(low * size / box).astype(np.int64),
        size,
        np.array([part.given_mass or 1.0 for part in parts]),
        np.array([NO_COLOR if brick.color is None else brick.color for brick in bricks]),
        np.array([part.grounded for part in parts]),
        np.array([int(match[1]) if match else 0 for match in numbers]),
        np.zeros(len(parts), dtype=np.int64),
        studded_all_over(size),
    )
    bond, sides = assembly.bonds[0], {len(contact.points) for contact in assembly.contacts}
    shear = UNLIMITED if bond.bears is None else bond.bears
    rules = StudRules(bond.pull or 0.0, shear, "face" if 4 in sides else "lower-edge")
    return model, rules, float(box[0, 0] / size[0, 0])


def _require_bricks(assembly: Assembly) -> None:
    """Raise an InputError if a part is no brick, or has joints or other entries."""
    for part in assembly.parts:
        if part.brick is None or not isinstance(part.shape, Box):
            raise InputError("it is not a brick", part=part.name, hint=BRICKS_HINT)
    if assembly.loads or assembly.joints or not assembly.bonds:
        raise InputError(
            "this needs bricks with bonds, and without loads or joints", hint=BRICKS_HINT
        )


def _require_grid(assembly: Assembly, corner: Array, cell: Array) -> None:
    """Raise an InputError if a brick is rotated, or off the grid of the others.

    `corner`: lowest corners in cells, shape (n, 3); `cell`: size of a cell of each brick.
    """
    turned = np.array([np.abs(part.pose.rotation[1:]).max() > ON_GRID for part in assembly.parts])
    apart = np.abs(corner - np.round(corner)).max(axis=1) > ON_GRID
    odd = np.abs(cell / cell[0] - 1).max(axis=1) > ON_GRID
    wrong = np.flatnonzero(turned | apart | odd)
    if len(wrong):
        name = assembly.names[wrong[0]]
        raise InputError("it is not in the cells of the common grid", part=name, hint=BRICKS_HINT)


def _baseplate(model: BrickModel) -> BrickModel:
    """The brick model with a held plate added under all bricks, its top at height 0."""
    low = model.corner.min(axis=0) - MARGIN
    size = (model.corner + model.size).max(axis=0) + MARGIN - low
    zero, mass = np.zeros(1, dtype=np.int64), np.ones(1)
    corner, size = np.array([[*low[:2], -1]]), np.array([[*size[:2], 1]])
    color, studded = zero + NO_COLOR, studded_all_over(size)
    return BrickModel(corner, size, mass, color, mass > 0, zero, zero, studded)


def _names(model: BrickModel) -> list[str]:
    """Names for the parts: ``2x4-7``, ``plate-2x4-7``, ``weight-7`` or ``baseplate``."""
    across, along = np.sort(model.size[:, :2], axis=1).T
    rows = zip(across, along, _kinds(model), model.mass, model.held, model.number, strict=True)
    names = []
    for a, b, kind, mass, held, number in rows:
        if held:
            names.append(f"{BASEPLATE}-{number}" if number > 0 else BASEPLATE)
        elif mass > HEAVY:
            names.append(f"weight-{number}")
        else:
            names.append(f"{kind}{'-' if kind else ''}{a}x{b}-{number}")
    return names


def _kinds(model: BrickModel) -> list[str]:
    """Word for the kind of each brick: "plate", "tile", "slope", or "" for a brick."""
    plates = model.size[:, 2]
    kinds = [model.slopes, model.tiles, plates != BRICK_PLATES]
    words: list[str] = np.select(kinds, ["slope", "tile", "plate"], "").tolist()
    return words


def _parts(model: BrickModel, names: list[str], scale: Index) -> Iterator[Part]:
    """Yield the part of each brick; equal bricks have the same shape object."""
    sloping, plain = model.slopes, ~model.slopes & ~model.tiles
    kinds, kind = distinct_rows(np.column_stack([model.size, model.studded * sloping[:, None]]))
    shapes = [_slope(row, scale) if row[3:].any() else Box(row[:3] * scale) for row in kinds]
    middle = (model.corner + model.size / 2) * scale
    rows = zip(names, kind, middle, model.held, model.mass, model.color, plain, strict=True)
    for name, k, place, held, mass, color, studs in rows:
        a, b, plates = kinds[k, :3].tolist()
        yield Part(
            name,
            shapes[k],
            Pose(place),
            grounded=bool(held),
            mass=float(mass),
            brick=Brick((a, b), plates, None if color == NO_COLOR else int(color))
            if studs
            else None,
        )


def _slope(row: Index, scale: Index) -> Mesh:
    """Shape of a slope about the middle of its cells, from its size and its cells with studs."""
    size, low, high = row[:3], row[3:5], row[5:7]
    sides = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
    base = np.column_stack([sides * size[:2], np.zeros(4)])
    edge = np.column_stack([low + sides * (high - low), np.full(4, size[2])])
    far = sides * size[:2]
    below = ((far >= low) & (far <= high)).all(axis=1)
    lip = np.column_stack([far[~below], np.full(2, LIP)])
    return Mesh.convex_hull((np.concatenate([base, edge, lip]) - size / 2) * scale)


def _bonds(
    model: BrickModel, studs: Studs, names: list[str], scale: Index, rules: StudRules
) -> Iterator[Bond]:
    """Yield a bond for each two bricks that studs connect."""
    points, pairs = studs.point * scale, np.column_stack([studs.lower, studs.upper])
    changes = np.flatnonzero((np.diff(pairs, axis=0) != 0).any(axis=1)) + 1
    first = [0, *changes.tolist(), len(pairs)] if len(pairs) else [0]
    for start, end in pairwise(first):
        a, b = pairs[start].tolist()
        yield Bond(
            (names[a], names[b]),
            pull=rules.pull,
            shear=rules.bond_shear,
            points=points[start:end],
            normal=UP,
        )


def _contacts(
    sides: Sides, names: list[str], scale: Index, rules: StudRules
) -> Iterator[GivenContact]:
    """Yield the contacts of neighbouring bricks: at the lower edge or at all corners of a side."""
    if rules.sides == "none":
        return
    low, high = sides.low * scale, sides.high * scale
    lower = np.stack([low, np.column_stack([high[:, :2], low[:, 2]])], axis=1)
    upper = np.stack([np.column_stack([low[:, :2], high[:, 2]]), high], axis=1)
    corners = lower if rules.sides == "lower-edge" else np.concatenate([lower, upper], axis=1)
    normals = np.eye(3)
    rows = zip(sides.first.tolist(), sides.second.tolist(), sides.axis, corners, strict=True)
    for a, b, axis, points in rows:
        yield GivenContact((names[a], names[b]), points, normals[axis])


def _tops(tops: Sides, names: list[str], scale: Index) -> Iterator[GivenContact]:
    """Yield the contacts of bricks on tiles: at the corners of the rectangle, without a bond."""
    low, high = tops.low * scale, tops.high * scale
    sides = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    corners = low[:, None] + sides * (high - low)[:, None]
    for a, b, points in zip(tops.first.tolist(), tops.second.tolist(), corners, strict=True):
        yield GivenContact((names[a], names[b]), points, UP)


def _estimate_note(model: BrickModel) -> list[str]:
    """A note that lists brick sizes with estimated mass; an empty list if none is estimated."""
    free = np.flatnonzero(~model.held & (model.mass <= HEAVY))
    kinds = _kinds(model)
    sizes = {(kinds[k], *sorted(model.size[k, :2].tolist()), int(model.size[k, 2])) for k in free}
    words = [
        f"{a}x{b}{' ' if kind else ''}{kind}"
        for kind, a, b, plates in sorted(sizes)
        if kind or not is_stated(a, b, plates)
    ]
    return [f"the masses of these bricks are estimates: {', '.join(words)}"] if words else []
