"""Walls of bricks: running bond, stack bond, openings, short bases, published walls.

A wall stands along x on a held base whose top is z = 0, centred on y = 0. Courses are given
bottom up as widths in bricks; a negative width is an opening. The names are
"brick-COURSE-NUMBER", both counted from 0, left to right without the openings.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from kilter.assembly import Assembly, Part
from kilter.errors import InputError
from kilter.rigid import Pose
from kilter.scenes.pieces import block
from kilter.scenes.registry import listed
from kilter.shape.primitives import Box

Courses = Sequence[Sequence[float]]

BRICK = (0.2, 0.1, 0.06)
"""Length, depth and height of a brick [m]."""

FERRIS_TIN_LOI: dict[int, tuple[str, dict[str, list[float]]]] = {
    1: ("E U" + " E U" * 2, {"E": [0.5, 1, 1, 1, 1, 0.5], "U": [1] * 5}),
    2: ("E U" + " E U" * 4, {"E": [0.5, 1, 1, 1, 1, 0.5], "U": [1] * 5}),
    3: (
        "Fe Fu Fe Wu We Wu We Wu Fe Fu Fe",
        {
            "Fe": [1, 1, 1, 1],
            "Fu": [0.5, 1, 1, 1, 0.5],
            "We": [1, 0.5, -1, 0.5, 1],
            "Wu": [0.5, 1, -1, 1, 0.5],
        },
    ),
    4: (
        "Fe Fu Fe Wu We Wu We Wu Fe Fu Fe",
        {
            "Fe": [0.5, 1, 1, 1, 1, 0.5],
            "Fu": [1, 1, 1, 1, 1],
            "We": [0.5, 0.5, -1, 0.5, 0.5, -1, 0.5, 0.5],
            "Wu": [1, -1, 1, -1, 1],
        },
    ),
    5: (
        "Fe Fu Fe Wu We Wu We Wu Fe Fu Fe Wu We Wu We Wu Fe Fu Fe",
        {
            "Fe": [0.5, 1, 1, 0.5],
            "Fu": [1, 1, 1],
            "We": [0.5, 0.5, -1, 0.5, 0.5],
            "Wu": [1, -1, 1],
        },
    ),
    6: (
        "Fe Fu Fe Fu Wu We Wu We Wu Fu Fe Fu Wu We Wu We Wu Fu Fe Fu Fe",
        {
            "Fe": [0.5, 1, 1, 1, 1, 1, 1, 0.5],
            "Fu": [1] * 7,
            "We": [1, 0.5, -1, 0.5, 1, 0.5, -1, 0.5, 1],
            "Wu": [0.5, 1, -1, 1, 1, -1, 1, 0.5],
        },
    ),
}
"""The six walls: their courses bottom up, and the widths of each kind of course [brick]."""


def wall_from_courses(
    courses: Courses,
    *,
    size: Sequence[float] = BRICK,
    gap: float = 0.0,
    base: tuple[float, float] | None = None,
    density: float | None = None,
    **assembly: Any,
) -> Assembly:
    """Build a brick wall from the widths of the bricks in each course, bottom up.

    Arguments: `courses` [brick]; `size` (3,) [length unit]; `gap` [length unit]; `base` [length
    unit]; `density` [kg/m^3]. Raises `InputError` if the gap is at least the width of a brick.

    Examples
    --------
    >>> wall_from_courses([[1, -1, 1], [3]]).names
    ('base', 'brick-0-0', 'brick-0-1', 'brick-1-0')
    """
    length, depth, height = (float(value) for value in size)
    right = length * sum(abs(width) for width in courses[0])
    low, high = (-length / 2, right + length / 2) if base is None else base
    held = block("base", [low, -depth, -height], [high, depth, 0], grounded=True, density=density)
    return Assembly([held, *_bricks(courses, (length, depth, height), gap, density)], **assembly)


def _bricks(
    courses: Courses, size: tuple[float, float, float], gap: float, density: float | None
) -> Iterator[Part]:
    """Yield the bricks of all courses; bricks of equal width share a shape."""
    length, depth, height = size
    shapes: dict[float, Box] = {}
    for row, widths in enumerate(courses):
        edges = np.concatenate([[0.0], np.cumsum(np.abs(widths))])
        middles = ((edges[:-1] + edges[1:]) * (length / 2)).tolist()
        z, number = (row + 0.5) * height, 0
        for width, x in zip(widths, middles, strict=True):
            if width < 0:
                continue
            if width not in shapes:
                if width * length <= gap:
                    raise InputError(
                        f"gap {gap:g} is too large for a brick of width {width:g}",
                        hint="give a smaller gap",
                    )
                shapes[width] = Box([width * length - gap, depth, height])
            yield Part(f"brick-{row}-{number}", shapes[width], Pose((x, 0.0, z)), density=density)
            number += 1


def bond(courses: int, per_course: int) -> list[list[float]]:
    """Widths of the bricks of a running bond; every second course ends in half bricks.

    Examples
    --------
    >>> bond(2, 3)
    [[1.0, 1.0, 1.0], [0.5, 1.0, 1.0, 0.5]]
    """
    if courses < 1 or per_course < 1:
        raise InputError(f"a wall of {courses} x {per_course} bricks", hint="give 1 or more")
    full = [1.0] * per_course
    half = [0.5, *[1.0] * (per_course - 1), 0.5]
    return [full if row % 2 == 0 else half for row in range(courses)]


@listed("wall", "a running-bond wall", source="running bond", answer="stable")
def wall(courses: int = 6, per_course: int = 6, **options: Any) -> Assembly:
    """A running-bond wall, stable without friction; `options` go to `wall_from_courses`."""
    return wall_from_courses(bond(courses, per_course), **options)


def wall_of(count: int, **options: Any) -> Assembly:
    """A running-bond wall of about `count` bricks, with as many courses as bricks per course.

    Examples
    --------
    >>> len(wall_of(100).parts)
    106
    """
    courses = max(1, round(count**0.5))
    return wall(courses, max(1, round(count / courses)), **options)


def stack_bond(courses: int = 6, per_course: int = 6, **options: Any) -> Assembly:
    """A wall with aligned head joints (towers side by side), stable without friction."""
    return wall_from_courses([[1.0] * per_course for _ in range(courses)], **options)


@listed(
    "wall-with-opening",
    "a wall with an opening; a brick above it is not supported",
    source="running bond",
    answer="unstable",
)
def wall_with_opening(
    courses: int = 8,
    per_course: int = 8,
    *,
    opening: tuple[int, int, int, int] = (3, 5, 2, 5),
    **options: Any,
) -> Assembly:
    """A running-bond wall with an opening and no lintel.

    Arguments: `opening`: first and last brick along x, first and last course of the opening (last
    ones excluded).

    Notes
    -----
    Unsupported bricks above the opening are not left out. The default opening, two bricks wide,
    has an unsupported brick above it, which falls without friction.
    """
    return wall_from_courses(_with_opening(bond(courses, per_course), opening), **options)


@listed("wall-with-lintel", "the same wall with a lintel", source="running bond", answer="stable")
def wall_with_lintel(
    courses: int = 8,
    per_course: int = 8,
    *,
    opening: tuple[int, int, int, int] = (3, 5, 2, 5),
    **options: Any,
) -> Assembly:
    """A running-bond wall with an opening, and a lintel over it that the wall supports.

    The wall is stable without friction.
    """
    left, right, _, top = opening
    rows = _with_opening(bond(courses, per_course), opening)
    if top < len(rows):
        half = 0.5 if top % 2 else 1.0  # so that the lintel ends at joints of its course
        rows[top] = _with_brick(rows[top], left - half, right + half)
    return wall_from_courses(rows, **options)


@listed(
    "hanging-brick",
    "a brick of a wall hangs in the air",
    source="running bond",
    answer="unstable",
)
def hanging_brick(courses: int = 6, per_course: int = 6, **options: Any) -> Assembly:
    """A running-bond wall with a lintel, and an unsupported brick under the lintel.

    The brick touches only the lintel, from below. It falls at 1 g, and the rest stays.

    Raises `InputError` if the wall is too small for the opening and the lintel.
    """
    if courses < 4 or per_course < 4:
        raise InputError(
            f"a wall of {courses} courses of {per_course} bricks has no room for a lintel",
            hint="give at least 4 courses of 4 bricks",
        )
    middle = per_course // 2
    rows = _with_opening(bond(courses, per_course), (middle - 1, middle + 2, 1, 3))
    rows[3] = _with_brick(rows[3], middle - 1.5, middle + 2.5)
    hung = [-abs(width) if width < 0 else width for width in rows[2]]
    opening = next(k for k, width in enumerate(hung) if width < 0)
    spare = (-hung[opening] - 1.0) / 2
    rows[2] = [*hung[:opening], -spare, 1.0, -spare, *hung[opening + 1 :]]
    return wall_from_courses(rows, **options)


@listed(
    "wall-on-short-base",
    "a wall that is longer than its base",
    source="running bond",
    answer="unstable",
)
def short_base(
    courses: int = 4, per_course: int = 6, *, held: float = 3.25, **options: Any
) -> Assembly:
    """A running-bond wall on a base that ends after `held` lengths of a brick.

    Without friction, the bricks of the first course beyond the base fall.
    """
    length = float(options.get("size", BRICK)[0])
    return wall(courses, per_course, base=(-length / 2, held * length), **options)


@listed(
    "tilted-wall",
    "a wall tilted 5 degrees out of its plane, friction 0.6",
    source="S7",
    answer="settles",
)
def tilted_wall(
    degrees: float = 5.0, *, friction: float = 0.6, courses: int = 9, per_course: int = 6
) -> Assembly:
    """Case S7: a running-bond wall of 200 x 100 x 60 mm bricks, tilted out of its plane.

    Gravity leans toward +y by `degrees`. The wall overturns at atan(W / (9 H)) = 10.49 deg; with
    friction 0.15 it slides at 8.53 deg.
    """
    angle = np.radians(degrees)
    down = [0.0, 9.81 * np.sin(angle), -9.81 * np.cos(angle)]
    return wall(courses, per_course, gravity=down, friction=friction)


@listed(
    "pierced-wall",
    "a wall with two openings, friction 0.65",
    source="Ferris and Tin-Loi, wall 4",
    answer="stable",
    number=4,
)
def ferris_tin_loi(number: int = 1, *, friction: float = 0.65) -> Assembly:
    """A published test wall by Ferris and Tin-Loi: planar, blocks of 0.4 x 0.175 m, 0.2 m deep.

    The publication gives the load factor of a horizontal body force.

    Arguments: `friction`: friction coefficient of bed and head joints [-].

    References
    ----------
    Ferris and Tin-Loi (2001), Limit analysis of frictional block assemblies as a
    mathematical program with complementarity constraints, Int. J. Mech. Sci. 43, 209-224.

    Examples
    --------
    >>> [len(ferris_tin_loi(k).parts) - 1 for k in range(1, 7)]
    [33, 55, 46, 55, 61, 146]
    """
    if number not in FERRIS_TIN_LOI:
        raise InputError(f"there is no wall {number!r}", hint="give 1 to 6")
    order, widths = FERRIS_TIN_LOI[number]
    rows = [widths[name] for name in order.split()]
    return wall_from_courses(rows, size=(0.4, 0.2, 0.175), friction=friction, planar=True)


def _with_opening(rows: list[list[float]], opening: tuple[int, int, int, int]) -> list[list[float]]:
    """Brick widths of courses after cutting an opening of whole bricks into some of them."""
    left, right, bottom, top = opening
    opened = list(rows)
    for k in range(max(bottom, 0), min(top, len(rows))):
        opened[k] = _cut(rows[k], left, right)
    return opened


def _cut(widths: Sequence[float], left: float, right: float) -> list[float]:
    """Brick widths of a course after an opening is cut from `left` to `right`: a negative width."""
    edges = [0.0, *np.cumsum(np.abs(widths)).tolist()]
    pairs = list(pairwise(edges))
    before = [min(b, left) - a for a, b in pairs if a < left]
    after = [b - max(a, right) for a, b in pairs if b > right]
    return [*before, -(min(right, edges[-1]) - max(left, 0.0)), *after]


def _with_brick(widths: Sequence[float], left: float, right: float) -> list[float]:
    """Brick widths of a course in which a single brick replaces all from `left` to `right`."""
    return [abs(width) if width < 0 else width for width in _cut(widths, left, right)]
