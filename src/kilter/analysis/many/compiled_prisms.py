"""Compiled reading of upright convex prisms, and of the faces at which they touch.

Every test leaves a wide margin: a mesh, or a pair, that is near any limit is not read, and the
general computation decides. A mesh is an upright prism if its corners lie on two levels, the upper
ones above the lower ones, each triangle lies in one side and faces outwards, and each edge has two
triangles in opposite senses.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from kilter.analysis.many.compiled_code import compiled
from kilter.analysis.many.compiled_tolerances import (
    CLEAR,
    CONVEX,
    LEVEL_CORNERS,
    PART_OF_GAP,
    RESOLVED_SHARE,
)
from kilter.arrays import Array, Index, Mask
from kilter.contact.contact_tolerances import THICKNESS

MOST_CORNERS = 8
"""Largest number of corners of the outline of a prism."""
MOST_CUT = 2 * MOST_CORNERS
"""Largest number of corners of the overlap of two outlines."""
MOST_PARTS = 100
"""Largest number of parts of an assembly."""
MOST_CONTACTS = 400
"""Largest number of pairs of parts that touch in an assembly."""


class Meshes(NamedTuple):
    """Meshes of M assemblies with N parts, as in `AssemblyArrays`."""

    vertices: Array
    faces: Index
    vertex_start: Index
    face_start: Index
    part_start: Index
    held: Mask
    gravity: Array
    density: Array
    """Density of each part [kg/m^3], shape (N,)."""
    mass: Array
    """Given mass of each part [kg], else NaN, shape (N,)."""
    friction: Array
    """Largest friction coefficient of each assembly [-], shape (M,)."""
    metres: Array
    """Length unit of each assembly [m], shape (M,)."""


class Prisms(NamedTuple):
    """Upright prisms of one assembly in its level frame, P parts at most."""

    corners: Index
    """Number of corners of each outline, shape (P,)."""
    outline: Array
    """Corners of each outline, counterclockwise from above, shape (P, MOST_CORNERS, 2)."""
    level: Array
    """Height of the lower and of the upper face, shape (P, 2)."""
    centre: Array
    """Centre of mass, shape (P, 3)."""
    size: Array
    """Volume, radius about the centre, thickness (twice the volume over the surface), and largest
    coordinate, shape (P, 4)."""
    bounds: Array
    """Least x, y and largest x, y of each outline, shape (P, 4)."""


class Touches(NamedTuple):
    """Level contacts of one assembly, C at most."""

    lower: Index
    upper: Index
    """Parts below and above each contact, shape (C,)."""
    sides: Index
    """Number of corners of each contact, shape (C,)."""
    points: Array
    """Horizontal coordinates of the corners, shape (C, MOST_CUT, 2)."""


def prisms_of(parts: int) -> Prisms:
    """Empty prisms for an assembly of `parts` parts."""
    return Prisms(
        np.zeros(parts, dtype=np.int64),
        np.zeros((parts, MOST_CORNERS, 2)),
        np.zeros((parts, 2)),
        np.zeros((parts, 3)),
        np.zeros((parts, 4)),
        np.zeros((parts, 4)),
    )


class Desk(NamedTuple):
    """Scratch arrays for reading a prism."""

    local: Array
    """Corners in the level frame, shape (2 MOST_CORNERS, 3)."""
    angle: Array
    ring: Index
    """Lower corners by their angle about their mean, and these angles, shape (MOST_CORNERS,)."""
    label: Index
    """Place of each corner in the ring; MOST_CORNERS more for the upper ones."""
    seen: Index
    """Number of the part in which each pair of labels was last an edge, shape (n, n)."""


def new_desk() -> Desk:
    """Scratch arrays for reading prisms."""
    most = 2 * MOST_CORNERS
    return Desk(
        np.zeros((most, 3)),
        np.zeros(MOST_CORNERS),
        np.zeros(MOST_CORNERS, dtype=np.int64),
        np.zeros(most, dtype=np.int64),
        np.zeros((most, most), dtype=np.int64),
    )


def touches_of(contacts: int) -> Touches:
    """Empty contacts of an assembly."""
    return Touches(
        np.zeros(contacts, dtype=np.int64),
        np.zeros(contacts, dtype=np.int64),
        np.zeros(contacts, dtype=np.int64),
        np.zeros((contacts, MOST_CUT, 2)),
    )


@compiled
def level_frame(gravity: Array, frame: Array) -> bool:
    """Write two horizontal unit vectors and the upward one as rows; false without gravity."""
    size = np.sqrt((gravity * gravity).sum())
    if not 1e-50 < size < 1e50:
        return False
    up = -gravity / size
    k = 0  # the axis farthest from the vertical
    for i in range(1, 3):
        if abs(up[i]) < abs(up[k]):
            k = i
    first = -up[k] * up
    first[k] += 1.0
    first /= np.sqrt((first * first).sum())
    frame[0] = first
    frame[1, 0] = up[1] * first[2] - up[2] * first[1]
    frame[1, 1] = up[2] * first[0] - up[0] * first[2]
    frame[1, 2] = up[0] * first[1] - up[1] * first[0]
    frame[2] = up
    return True


@compiled
def _levels(local: Array, count: int, rounding: float) -> tuple[float, float]:
    """Heights of the two levels of the corners; equal if there are none."""
    low, high = local[0, 2], local[0, 2]
    for i in range(1, count):
        low, high = min(low, local[i, 2]), max(high, local[i, 2])
    for i in range(count):
        z = local[i, 2]
        if min(z - low, high - z) > rounding:
            return 0.0, 0.0
    return low, high


@compiled
def _turn(x: float, y: float) -> float:
    """A number that grows with the angle of a direction, from -2 at (-1, 0) around to 2."""
    away = abs(x) + abs(y)
    if not away > 0:
        return 0.0
    return float(1 - x / away if y >= 0 else x / away - 1)


@compiled
def _ring(desk: Desk, count: int, middle: float) -> int:
    """Write the lower corners by their angle about their mean; return their number."""
    local, ring, angle = desk.local, desk.ring, desk.angle
    n, x, y = 0, 0.0, 0.0
    for i in range(count):
        if local[i, 2] < middle:
            if n == MOST_CORNERS:
                return 0
            ring[n] = i
            x, y, n = x + local[i, 0], y + local[i, 1], n + 1
    if n < 3 or 2 * n != count:
        return 0
    x, y = x / n, y / n
    for k in range(n):
        i = ring[k]
        own = _turn(local[i, 0] - x, local[i, 1] - y)
        at = k
        while at > 0 and angle[at - 1] > own:
            angle[at], ring[at] = angle[at - 1], ring[at - 1]
            at -= 1
        angle[at], ring[at] = own, i
    return n


@compiled
def _label_corners(desk: Desk, count: int, n: int, middle: float, rounding: float) -> bool:
    """Label the lower corners by their place in the ring, and those above by n more."""
    local, ring, label = desk.local, desk.ring, desk.label
    for k in range(n):
        label[ring[k]] = k
    above = 0
    for i in range(count):
        if local[i, 2] < middle:
            continue
        label[i] = -1
        for k in range(n):
            below = ring[k]
            apart = max(abs(local[i, 0] - local[below, 0]), abs(local[i, 1] - local[below, 1]))
            if apart <= rounding:
                label[i] = n + k
                above += 1 << k
    return bool(above == (1 << n) - 1)  # each once: they are as many


@compiled
def _in_a_side(a: int, b: int, c: int, n: int) -> bool:
    """Whether three corners, by their labels, lie in one side of the prism, seen from outside."""
    above = int(a >= n) + int(b >= n) + int(c >= n)
    if above == 1 or above == 2:  # a wall: its single lower or upper corner comes first
        single = above == 1
        if (b >= n) == single:
            a, b, c = b, c, a
        elif (c >= n) == single:
            a, b, c = c, a, b
    p = a - n if a >= n else a
    q = b - n if b >= n else b
    r = c - n if c >= n else c
    if above == 3:
        return (p < q < r) or (q < r < p) or (r < p < q)
    if above == 0:
        return (p > q > r) or (q > r > p) or (r > p > q)
    left, right = (q, r) if above == 1 else (r, q)  # seen from outside
    return right == (left + 1 if left + 1 < n else 0) and p in (q, r)


@compiled
def _closed(meshes: Meshes, part: int, desk: Desk, n: int) -> bool:
    """Whether the triangles of a part lie in the sides of a prism, and cover each side once."""
    wide, first, number = 2 * n, meshes.vertex_start[part], part + 1
    label, seen = desk.label, desk.seen
    low, high = meshes.face_start[part], meshes.face_start[part + 1]
    if high - low != 2 * wide - 4:
        return False
    for f in range(low, high):
        a = meshes.faces[f, 0] - first
        b = meshes.faces[f, 1] - first
        c = meshes.faces[f, 2] - first
        if min(a, b, c) < 0 or max(a, b, c) >= wide:
            return False
        a, b, c = label[a], label[b], label[c]
        if not _in_a_side(a, b, c, n):
            return False
        if seen[a, b] == number or seen[b, c] == number or seen[c, a] == number:
            return False
        seen[a, b] = seen[b, c] = seen[c, a] = number
    for a in range(wide):
        for b in range(a):
            if (seen[a, b] == number) != (seen[b, a] == number):
                return False
    return True


@compiled
def _measure(prisms: Prisms, p: int, high: float) -> bool:
    """Compute the sizes of prism p from its outline and levels; false if it is not convex."""
    n, outline = prisms.corners[p], prisms.outline
    tall = prisms.level[p, 1] - prisms.level[p, 0]
    area = x = y = around = 0.0
    x0, y0 = outline[p, 0, 0], outline[p, 0, 1]
    for k in range(n):
        after = k + 1 if k + 1 < n else 0
        ax, ay = outline[p, k, 0] - x0, outline[p, k, 1] - y0
        bx, by = outline[p, after, 0] - x0, outline[p, after, 1] - y0
        cut = ax * by - ay * bx
        area, x, y = area + cut / 2, x + cut * (ax + bx) / 6, y + cut * (ay + by) / 6
        around += np.hypot(bx - ax, by - ay)
    if not area > CONVEX * around * around:
        return False
    for k in range(n):
        b = k + 1 if k + 1 < n else 0
        c = b + 1 if b + 1 < n else 0
        ax, ay = outline[p, b, 0] - outline[p, k, 0], outline[p, b, 1] - outline[p, k, 1]
        bx, by = outline[p, c, 0] - outline[p, b, 0], outline[p, c, 1] - outline[p, b, 1]
        turn = ax * by - ay * bx
        if not turn > CONVEX * around * around:
            return False
    prisms.centre[p, 0], prisms.centre[p, 1] = x0 + x / area, y0 + y / area
    prisms.centre[p, 2] = (prisms.level[p, 0] + prisms.level[p, 1]) / 2
    farthest = 0.0
    for k in range(n):
        ax, ay = outline[p, k, 0] - prisms.centre[p, 0], outline[p, k, 1] - prisms.centre[p, 1]
        farthest = max(farthest, ax * ax + ay * ay)
    volume = area * tall
    prisms.size[p, 0] = volume
    prisms.size[p, 1] = np.sqrt(farthest + tall * tall / 4)
    prisms.size[p, 2] = 2 * volume / (2 * area + around * tall)
    prisms.size[p, 3] = high
    return bool(prisms.size[p, 2] > RESOLVED_SHARE * max(high, prisms.size[p, 1]))


@compiled
def read_prism(meshes: Meshes, part: int, frame: Array, prisms: Prisms, p: int, desk: Desk) -> bool:
    """Read a part as the prism with index p; false if it is no upright convex prism."""
    first, last = meshes.vertex_start[part], meshes.vertex_start[part + 1]
    count, local, high = last - first, desk.local, 0.0
    if count > 2 * MOST_CORNERS or count < 6:
        return False
    for i in range(count):
        x, y, z = (
            meshes.vertices[first + i, 0],
            meshes.vertices[first + i, 1],
            meshes.vertices[first + i, 2],
        )
        high = max(high, abs(x), abs(y), abs(z))
        for axis in range(3):
            local[i, axis] = frame[axis, 0] * x + frame[axis, 1] * y + frame[axis, 2] * z
    if not high < 1e30:
        return False
    rounding = LEVEL_CORNERS * high
    low, top = _levels(local, count, rounding)
    n = _ring(desk, count, (low + top) / 2)
    if n == 0 or not top - low > 0:
        return False
    if not _label_corners(desk, count, n, (low + top) / 2, rounding):
        return False
    if not _closed(meshes, part, desk, n):
        return False
    prisms.corners[p] = n
    west, south, east, north = np.inf, np.inf, -np.inf, -np.inf
    for k in range(n):
        x, y = local[desk.ring[k], 0], local[desk.ring[k], 1]
        prisms.outline[p, k, 0], prisms.outline[p, k, 1] = x, y
        west, south, east, north = min(west, x), min(south, y), max(east, x), max(north, y)
    bounds = prisms.bounds
    bounds[p, 0], bounds[p, 1], bounds[p, 2], bounds[p, 3] = west, south, east, north
    prisms.level[p, 0], prisms.level[p, 1] = low, top
    return _measure(prisms, p, high)


@compiled
def _separation(prisms: Prisms, a: int, b: int) -> float:
    """Largest distance of two outlines along a normal of a side; negative: how far they overlap."""
    outline = prisms.outline
    most: float = -np.inf
    for side in range(2):
        p, q = (a, b) if side == 0 else (b, a)
        n, m = prisms.corners[p], prisms.corners[q]
        for k in range(n):
            after = k + 1 if k + 1 < n else 0
            x0, y0 = outline[p, k, 0], outline[p, k, 1]
            x, y = outline[p, after, 1] - y0, x0 - outline[p, after, 0]
            least = np.inf
            for j in range(m):
                least = min(least, (outline[q, j, 0] - x0) * x + (outline[q, j, 1] - y0) * y)
            most = max(most, least / np.sqrt(x * x + y * y))
    return float(most)


@compiled
def _box_distance(prisms: Prisms, a: int, b: int) -> float:
    """Distance along x or y of the boxes about two outlines, which is at most their distance."""
    bounds = prisms.bounds
    distance: float = max(
        max(bounds[a, 0] - bounds[b, 2], bounds[b, 0] - bounds[a, 2]),
        max(bounds[a, 1] - bounds[b, 3], bounds[b, 1] - bounds[a, 3]),
    )
    return distance


@compiled
def _overlap(prisms: Prisms, a: int, b: int, points: Array) -> int:
    """Write the corners of the overlap of two outlines; return their number."""
    count, n, outline = int(prisms.corners[a]), prisms.corners[b], prisms.outline
    points[:count] = outline[a, :count]
    cut = np.empty((MOST_CUT, 3))
    for k in range(n):
        after = k + 1 if k + 1 < n else 0
        x0, y0 = outline[b, k, 0], outline[b, k, 1]
        x1, y1 = outline[b, after, 0] - x0, outline[b, after, 1] - y0
        for j in range(count):
            cut[j, 0], cut[j, 1] = points[j, 0], points[j, 1]
            cut[j, 2] = x1 * (cut[j, 1] - y0) - y1 * (cut[j, 0] - x0)
        kept = 0
        for j in range(count):
            following = j + 1 if j + 1 < count else 0
            here, there = cut[j, 2], cut[following, 2]
            if here >= 0:
                points[kept, 0], points[kept, 1] = cut[j, 0], cut[j, 1]
                kept += 1
            if (here > 0 and there < 0) or (here < 0 and there > 0):
                share = here / (here - there)
                points[kept, 0] = cut[j, 0] + share * (cut[following, 0] - cut[j, 0])
                points[kept, 1] = cut[j, 1] + share * (cut[following, 1] - cut[j, 1])
                kept += 1
        count = kept
    return int(count)


@compiled
def find_touches(
    prisms: Prisms, parts: int, relative_gap: float, gap: float, touches: Touches
) -> tuple[int, bool]:
    """Write the level contacts of an assembly.

    Arguments: `relative_gap`, `gap`: the tolerance; `gap` is negative if it is not given. Returns
    the number of contacts, -1 if a pair may touch otherwise; and whether pairs are near, so that
    contacts that are not known may stop a motion.
    """
    found, near = 0, False
    for a in range(parts):
        for b in range(a):
            small = 2 * min(prisms.size[a, 1], prisms.size[b, 1])
            wanted = relative_gap * small if gap < 0 else gap
            clear = max(CLEAR * small, 3 * wanted)
            above = prisms.level[a, 0] - prisms.level[b, 1]
            below = prisms.level[b, 0] - prisms.level[a, 1]
            apart = max(above, below)
            if max(apart, _box_distance(prisms, a, b)) > clear:
                continue
            across = _separation(prisms, a, b)
            if max(apart, across) > 3 * wanted:
                near = near or max(apart, across) <= clear
                continue
            thin = THICKNESS * min(prisms.size[a, 2], prisms.size[b, 2])
            most = PART_OF_GAP * min(wanted, thin)
            if across > -clear or not abs(apart) <= most or found == MOST_CONTACTS:
                return -1, near
            lower, upper = (b, a) if above > below else (a, b)
            count = _overlap(prisms, lower, upper, touches.points[found])
            if count < 3:
                return -1, near
            touches.lower[found], touches.upper[found] = lower, upper
            touches.sides[found] = count
            found += 1
    return found, near
