"""Forces and motions of many stacks of parts on level faces, from the highest part down.

Parts that rest on level faces need no linear program. The load of a part is its weight and the
forces of the parts on it. Supports balance the load if its line of action meets their convex hull:
in the horizontal coordinates u, v from the centre of the part,

    f = g (1, u, v) . y,     sum f (1, u, v) = load       g = 1, or f itself (largest entropy)

Otherwise the part tips over an edge of the hull, with all parts on it. The distribution is one of
many, so a part on several others may tip although a program finds forces. Therefore both results
are candidates, which the caller verifies.

The result of a program depends on its own parts alone: sums have a fixed order, and the iterations
of each part end by its own residual.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from kilter.arrays import TINY, Array, Index, Mask, cross, ragged, starts
from kilter.mechanics.program import Program
from kilter.mechanics.rows import CONTACT

LEVEL = 1e-9
"""Largest sine of the angle between a normal and the vertical for a level contact [rad]."""
MOST_DEPTH = 101
"""Largest number of parts above each other; parts that support each other exceed it."""
MOST_POINTS = 12
"""Largest number of support points of a part whose edge of tipping is searched."""
PULLS = 1e-3
"""Fraction of the mean force below which forces of least squares are replaced [-]."""
STEPS = 30
"""Largest number of Newton steps."""
ROUNDING = 1e-13
"""Relative residual at which Newton's method ends, and relative regularisation [-]."""
INSIDE = 1e-9
"""Distance over the radius of a part within which a point counts as on an edge [-]."""
NARROW = 1e-10
"""Least determinant of the second moments of support points, over the cube of their trace [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class StackAnswers:
    """Candidates of forces or of a motion for M programs."""

    carried: Mask
    tips: Mask
    """Programs with candidate forces, and programs with a candidate motion, shape (M,)."""
    forces: Array
    """Forces of all rows [N], shape (K,)."""
    motion: Array
    """Motion of all parts, shape (N, 6)."""


@dataclass(slots=True, eq=False)
class _Supports:
    """Level contacts, ordered by depth of the upper part (the deepest first), then by part."""

    rows: Index
    upper: Index
    lower: Index
    """Row of the program, and the parts above and below it, shape (k,)."""
    above: Array
    below: Array
    """(1, u, v) of the contact point from the centre of the upper and of the lower part; u and v
    are over the radius of the part, shape (k, 3)."""
    parts: Index
    """Parts with supports, in the same order, shape (p,)."""
    start: Index
    """First row of each of these parts, shape (p + 1,)."""
    depth: Index
    """0 for held parts, else 1 plus the largest depth of the parts below, shape (N,)."""


def stack_answers(
    program: Program, start: Index, frames: Array, weight: Array, which: Mask
) -> StackAnswers:
    """Find candidate forces or a candidate motion of many programs whose parts are stacked.

    Arguments: `start` (M + 1,): first part of each program; `frames` (M, 3, 3): rows of two
    horizontal unit vectors and the upward one of each program; `weight` (N,): weight of each part
    [N]; `which` (M,): programs to consider.
    """
    count = len(start) - 1
    owner = np.repeat(np.arange(count), np.diff(start))
    axes, up = frames[:, :2], frames[:, 2]
    supports = _supports(program, owner, up, axes, which)
    forces = np.zeros(len(program.part_a))
    carried = which.copy()
    carried[owner[supports.depth >= MOST_DEPTH]] = False
    need = np.zeros((len(owner) + 1, 3))
    need[:-1, 0] = np.where(program.free, weight, 0.0)
    fails = np.zeros(len(owner), dtype=bool)
    unsupported = program.free.copy()
    unsupported[supports.parts] = False
    fails |= unsupported & which[owner]
    shares = _shares(supports)
    for first, last in _levels(supports):
        level = slice(int(supports.start[first]), int(supports.start[last]))
        force, fits = _spread(supports, shares, slice(first, last), need)
        forces[supports.rows[level]] = force
        fails[supports.parts[first:last][~fits]] = True
        below = supports.lower[level]
        for k in range(3):
            need[:, k] += np.bincount(below, force * supports.below[level, k], minlength=len(need))
    carried[owner[fails]] = False
    motion, tips = _tipping(program, owner, axes, up, supports, need, fails & which[owner])
    forces[~carried[_owner_of_rows(program, owner)]] = 0.0
    return StackAnswers(carried, tips & which & ~carried, forces, motion)


def _owner_of_rows(program: Program, owner: Index) -> Index:
    """Index of the program to which each row belongs, shape (K,)."""
    extended = np.append(owner, -1)
    row_owner: Index = np.maximum(extended[program.part_a], extended[program.part_b])
    return row_owner


def _supports(program: Program, owner: Index, up: Array, axes: Array, which: Mask) -> _Supports:
    """Find the level contacts, and order them by the depth of their upper part."""
    row_owner = _owner_of_rows(program, owner)
    vertical = up[row_owner]
    sine = cross(program.normal, vertical)
    level = (program.kind == CONTACT) & ~program.two_sided & which[row_owner]
    level &= (sine * sine).sum(axis=1) < LEVEL**2
    rises = (program.normal * vertical).sum(axis=1) > 0
    upper = np.where(rises, program.part_b, program.part_a)
    lower = np.where(rises, program.part_a, program.part_b)
    level &= np.append(program.free, False)[upper]
    rows = np.flatnonzero(level)
    upper, lower = upper[rows], lower[rows]
    depth = _depths(program.free, upper, lower)
    order = np.lexsort((upper, -depth[upper]))
    rows, upper, lower = rows[order], upper[order], lower[order]
    first = np.flatnonzero(np.diff(upper, prepend=-1))
    flat = axes[row_owner[rows]]
    point = program.point[rows]

    def footing(part: Index) -> Array:
        """(1, u, v) of the contact points from the centres of parts; the ground has no centre."""
        known = np.minimum(part, len(program.center) - 1)
        arm = (point - program.center[known]) / program.radius[known][:, None]
        columns = [(arm * flat[:, k]).sum(axis=1) for k in range(2)]
        return np.column_stack([np.ones(len(part)), *columns])

    start = np.append(first, len(rows))
    return _Supports(rows, upper, lower, footing(upper), footing(lower), upper[first], start, depth)


def _depths(free: Mask, upper: Index, lower: Index) -> Index:
    """Depth of each part: 0 for held parts, else 1 plus the largest depth of the parts below."""
    count = len(free) + 1
    pairs = np.unique(upper * count + lower)
    above, below = pairs // count, pairs % count
    depth = np.append(free, False).astype(np.int64)
    for _ in range(MOST_DEPTH):
        deeper = depth.copy()
        np.maximum.at(deeper, above, depth[below] + 1)
        if (deeper == depth).all():
            break
        depth = deeper
    return depth[:-1]


def _moments(above: Array, weights: Array, part: Index, count: int) -> Array:
    """Sums of weighted outer products of (1, u, v) over the rows of each part, (count, 3, 3)."""
    sums = np.empty((count, 3, 3))
    for i in range(3):
        for j in range(i, 3):
            products = weights * above[:, i] * above[:, j]
            sums[:, i, j] = sums[:, j, i] = np.bincount(part, products, minlength=count)
    return sums


@dataclass(slots=True, eq=False)
class _Shares:
    """Linear functions of the load by which the supports of each part share it."""

    inverse: Array
    """Inverse second moments of the supports, shape (p, 3, 3): the forces of least squares."""
    wide: Mask
    """Parts whose supports are on no line, shape (p,)."""
    across: Array
    """For supports at the corners of a parallelogram, its coordinates of a load (1, u, v): both
    are between 0 and 1 inside, shape (p, 2, 3)."""
    is_four: Mask
    """Parts with such supports, shape (p,)."""


def _shares(supports: _Supports) -> _Shares:
    """Find how the supports of each part share a load."""
    size = np.diff(supports.start)
    part = np.repeat(np.arange(len(size)), size)
    sums = _moments(supports.above, np.ones(len(part)), part, len(size))
    wide: Mask = np.linalg.det(sums) > NARROW * np.trace(sums, axis1=1, axis2=2) ** 3
    sums[~wide] = np.eye(3)
    across, is_four = np.zeros((len(size), 2, 3)), np.zeros(len(size), dtype=bool)
    four = np.flatnonzero(wide & (size == 4))
    a, b, c, d = (supports.above[supports.start[four] + k, 1:] for k in range(4))
    p, q = b - a, d - a
    area = p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]
    # three of four corners of a wide figure may be on a line
    is_four[four] = (np.abs(a - b + c - d).max(axis=1, initial=0.0) < INSIDE) & (area != 0)
    area = np.where(area == 0, 1.0, area)[:, None]
    across[four, 0, 1:] = np.column_stack([q[:, 1], -q[:, 0]]) / area
    across[four, 1, 1:] = np.column_stack([-p[:, 1], p[:, 0]]) / area
    across[four, :, 0] = -(across[four, :, 1:] * a[:, None]).sum(axis=2)
    return _Shares(np.asarray(np.linalg.inv(sums), dtype=np.float64), wide, across, is_four)


def _spread(supports: _Supports, shares: _Shares, parts: slice, need: Array) -> tuple[Array, Mask]:
    """Forces of the supports of some parts, and a mask of the parts that they balance.

    At four corners of a parallelogram the forces are products of its coordinates. Else the forces
    of least squares are used if all push, else those of the largest entropy.
    """
    start = supports.start[parts.start : parts.stop + 1]
    rows = slice(int(start[0]), int(start[-1]))
    start = start - start[0]
    above, goal = supports.above[rows], need[supports.parts[parts]]
    force, fits = np.zeros(len(above)), np.zeros(len(goal), dtype=bool)
    four = np.flatnonzero(shares.is_four[parts])
    s, t = (shares.across[parts][four] * goal[four, None]).sum(axis=2).T / goal[four, 0]
    fits[four] = (s > INSIDE) & (s < 1 - INSIDE) & (t > INSIDE) & (t < 1 - INSIDE)
    for k, share in enumerate(((1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t)):
        force[start[four] + k] = share * goal[four, 0]
    others = np.flatnonzero(~shares.is_four[parts] & shares.wide[parts])
    if len(others):
        part, places = ragged(start, others)
        few, load = starts(np.diff(start)[others]), goal[others]
        points = above[places]
        y = (shares.inverse[parts][others] * load[:, None]).sum(axis=2)
        force[places] = (points * y[part]).sum(axis=1)
        least = np.minimum.reduceat(force[places], few[:-1])
        good = least > PULLS * load[:, 0] / np.diff(few)
        tried = np.flatnonzero(~good)
        tried = tried[~_is_outside(points, few, load, tried)]
        if len(tried):
            which, chosen = ragged(few, tried)
            force[places[chosen]], good[tried] = _pushing_forces(which, points[chosen], load[tried])
        fits[others] = good
    force[~np.repeat(fits, np.diff(start))] = 0.0
    return force, fits


def _pushing_forces(part: Index, above: Array, goal: Array) -> tuple[Array, Mask]:
    """Positive forces [N] that carry loads, and a mask of the parts for which they were found.

    Newton's method minimises the sum of exp(y . (1, u, v)) minus y . goal for each part; a step
    changes no force by more than a factor of e.
    """
    count, weight = len(goal), goal[:, 0]
    goal = goal / weight[:, None]
    y = np.zeros_like(goal)
    y[:, 0] = -np.log(np.bincount(part))
    found = np.zeros(count, dtype=bool)
    force: Array = np.zeros(len(part))
    for _ in range(STEPS):
        rows = np.flatnonzero(~found[part])
        if not len(rows):
            break
        mine, points = part[rows], above[rows]
        force[rows] = np.exp((points * y[mine]).sum(axis=1))
        gap = goal.copy()
        for k in range(3):
            gap[:, k] -= np.bincount(mine, force[rows] * points[:, k], minlength=count)
        found |= (np.abs(gap).max(axis=1) < ROUNDING) & (np.bincount(mine, minlength=count) > 0)
        gram = _moments(points, force[rows], mine, count) + ROUNDING * np.eye(3)
        gram[found] = np.eye(3)
        step = np.linalg.solve(gram, gap[:, :, None])[:, :, 0]
        step[found] = 0.0
        change = np.zeros(count)
        np.maximum.at(change, mine, np.abs((points * step[mine]).sum(axis=1)))
        y += step / np.maximum(change, 1.0)[:, None]
    return force * weight[part], found


def _is_outside(above: Array, start: Index, goal: Array, parts: Index) -> Mask:
    """Whether the load of each of some parts acts outside the convex hull of its supports."""
    which, rows = ragged(start, parts)
    first = starts(np.bincount(which, minlength=len(parts)))
    outside: Mask = _worst_edges(above[rows], first, goal[parts])[0] > INSIDE
    return outside


def _worst_edges(above: Array, start: Index, goal: Array) -> tuple[Array, Index, Array]:
    """For each part the edge of the hull of its supports beyond which its load acts farthest.

    Returns `beyond` (p,): distance of the load beyond the edge over the radius; -inf without an
    edge; `corner` (p,): row of a point of the edge; `outward` (p, 2): horizontal unit vector across
    the edge.
    """
    beyond, corner = np.full(len(goal), -np.inf), np.zeros(len(goal), dtype=np.int64)
    outward, size = np.zeros((len(goal), 2)), np.diff(start)
    points, load = above[:, 1:], goal[:, 1:] / np.maximum(goal[:, 0], TINY)[:, None]
    for number in np.unique(size[size <= MOST_POINTS]).tolist():
        parts = np.flatnonzero(size == number)
        corners = points[start[parts][:, None] + np.arange(number)]
        edge = corners[:, None] - corners[:, :, None]
        length = np.hypot(edge[..., 0], edge[..., 1])
        normal = np.stack([edge[..., 1], -edge[..., 0]], axis=-1)
        normal /= np.maximum(length, INSIDE)[..., None]
        side = normal[..., 0] * corners[:, :, None, 0] + normal[..., 1] * corners[:, :, None, 1]
        reach = (
            normal[..., None, 0] * corners[:, None, None, :, 0]
            + normal[..., None, 1] * corners[:, None, None, :, 1]
        ).max(axis=-1)
        out = normal[..., 0] * load[parts, None, None, 0]
        out += normal[..., 1] * load[parts, None, None, 1] - side
        out[(reach > side + INSIDE) | (length <= INSIDE)] = -np.inf
        best = out.reshape(len(parts), -1).argmax(axis=1)
        each = np.arange(len(parts))
        beyond[parts] = out.reshape(len(parts), -1)[each, best]
        corner[parts] = start[parts] + best // number
        outward[parts] = normal.reshape(len(parts), -1, 2)[each, best]
    return beyond, corner, outward


def _tipping(
    program: Program,
    owner: Index,
    axes: Array,
    up: Array,
    supports: _Supports,
    need: Array,
    fails: Mask,
) -> tuple[Array, Mask]:
    """Motion of each program in which a part tips or drops, with all parts on it; and a mask.

    It is the highest part that fails, since the load of a lower part is then unknown.
    """
    motion, tips = np.zeros((len(owner), 6)), np.zeros(len(up), dtype=bool)
    failed = np.flatnonzero(fails)
    if not len(failed):
        return motion, tips
    failed = failed[np.lexsort((failed, -supports.depth[failed], owner[failed]))]
    part = failed[np.flatnonzero(np.diff(owner[failed], prepend=-1))]
    place = np.full(len(owner), -1)
    place[supports.parts] = np.arange(len(supports.parts))
    stands = part[place[part] >= 0]
    which, rows = ragged(supports.start, place[stands])
    begin = starts(np.bincount(which, minlength=len(stands)))
    beyond, corner, outward = _worst_edges(supports.above[rows], begin, need[stands])
    sure = beyond > INSIDE
    stands, outward = stands[sure], outward[sure]
    pivot = np.zeros((len(up), 3))
    turn = np.zeros((len(up), 3))
    fall = np.zeros((len(up), 3))
    mine = owner[stands]
    pivot[mine] = program.point[supports.rows[rows[corner[sure]]]]
    along = outward[:, :1] * axes[mine, 0] + outward[:, 1:] * axes[mine, 1]
    turn[mine] = cross(up[mine], along)
    drops = part[place[part] < 0]
    fall[owner[drops]] = -up[owner[drops]]
    moves = np.zeros(len(owner) + 1, dtype=bool)
    moves[stands] = moves[drops] = True
    tips[mine] = tips[owner[drops]] = True
    for first, last in _levels(supports)[::-1]:
        level = slice(int(supports.start[first]), int(supports.start[last]))
        moves[supports.upper[level][moves[supports.lower[level]]]] = True
    chosen = np.flatnonzero(moves[:-1])
    mine = owner[chosen]
    motion[chosen, :3] = fall[mine] + cross(turn[mine], program.center[chosen] - pivot[mine])
    motion[chosen, 3:] = turn[mine]
    return motion, tips


def _levels(supports: _Supports) -> list[tuple[int, int]]:
    """First part of each depth, and the first part after them, from the highest parts down."""
    depth = supports.depth[supports.parts]
    first = np.flatnonzero(np.diff(depth, prepend=-1)).tolist()
    return list(itertools.pairwise([*first, len(depth)]))
