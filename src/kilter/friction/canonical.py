"""The same program for the same assembly, however it is turned, listed or divided.

The work of a proof that no motion can start depends on the order of its rows and on the axes of its
frame, so a limit of work would let a copy of an assembly lose its proof. The proof is therefore
made for a canonical program, and repeated for it:

1. Parts that a fixed joint connects are a single body; contact points of two bodies that lie in one
   plane, with one coefficient, are a single patch; of points at the same place one remains, since
   their forces add. Points of a seam within a patch stay: they may carry the weight with a smaller
   arm than the corners, so that a spin meets less friction.
2. The z axis is the mean of the most frequent contact normals, against gravity. The x axis points
   downhill across it; if no direction is downhill, along another normal or to the farthest point.
3. Bodies are sorted by height and place, rows by their bodies and places, and each normal points
   to the later body.

Programs with bonds or straps, whose rows belong together, and
planar programs, whose frame is given, keep their order.
"""

from __future__ import annotations

import numpy as np

from kilter.arrays import TINY, Array, Index, Mask, cross
from kilter.friction.friction_tolerances import SAME_PLACE
from kilter.mechanics.locked_parts import merge_parts
from kilter.mechanics.mechanics_tolerances import RIGID
from kilter.mechanics.program import Program
from kilter.mechanics.rows import CONTACT, JOINT


def canonical(program: Program) -> Program:
    """The canonical program of an assembly, with the same answer to whether a motion can start.

    Examples
    --------
    >>> from kilter.contact import contacts
    >>> from kilter.mechanics.program import build_program
    >>> from kilter.scenes.pieces import turn
    >>> from kilter.scenes.stacks import block_on_slope
    >>> from kilter.scenes.pieces import moved
    >>> slope = block_on_slope(20.0, friction=0.5)
    >>> one, other = (
    ...     canonical(build_program(made, contacts(made)))
    ...     for made in (slope, moved(slope, turn([1, 2, 3], 40.0), [5.0, 6.0, 7.0]))
    ... )
    >>> bool(np.allclose(one.point, other.point)), bool(np.allclose(one.normal, other.normal))
    (True, True)
    """
    gravity = float(np.linalg.norm(program.gravity))
    kept = program.planar or len(program.bounded) or program.tied.any() or gravity == 0.0
    if kept or not len(program.part_a) or not np.isin(program.kind, (CONTACT, JOINT)).all():
        return program
    group = _rigid_groups(program)
    if int(group.max(initial=-1)) + 1 < len(program.names):
        program = merge_parts(program, group)
    if not len(program.part_a):
        return program
    return _sorted(_framed(_united(program)))


def _rigid_groups(program: Program) -> Index:
    """Group number of each part: parts that fixed joints connect share it."""
    group = np.arange(len(program.names))
    rows = np.flatnonzero((program.kind == JOINT) & (program.part_a >= 0) & (program.part_b >= 0))
    ends = np.sort(np.column_stack([program.part_a[rows], program.part_b[rows]]), axis=1)
    for a, b in np.unique(ends, axis=0):
        own = rows[(ends == (a, b)).all(axis=1)]
        arm = (program.point[own] - program.center[a]) / program.radius[a]
        angular = program.angular[own][:, None]
        straight = np.where(angular, 0.0, program.normal[own])
        turning = np.where(angular, program.normal[own], cross(arm, program.normal[own]))
        values = np.linalg.svd(np.hstack([straight, turning]), compute_uv=False)
        if len(values) == 6 and values[-1] > RIGID * values[0]:
            group[group == group[b]] = group[a]
    return np.unique(group, return_inverse=True)[1].reshape(-1).astype(np.int64)


def _framed(program: Program) -> Program:
    """The program in the canonical frame, about the centre of mass of the free bodies."""
    middle = program.mass[program.free] @ program.center[program.free]
    middle = middle / program.mass[program.free].sum()
    turn = _axes(program, program.point - middle)

    def wrenches(six: Array) -> Array:
        return np.hstack([six[:, :3] @ turn.T, six[:, 3:] @ turn.T])

    return program.with_rows(
        center=(program.center - middle) @ turn.T,
        point=(program.point - middle) @ turn.T,
        normal=program.normal @ turn.T,
        gravity=turn @ program.gravity,
        inertia=turn @ program.inertia @ turn.T,
        applied=wrenches(program.applied),
        clamp=wrenches(program.clamp),
    )


def _axes(program: Program, arm: Array) -> Array:
    """Axes of the canonical frame, as rows: the mean of the most frequent normals, and downhill.

    If gravity is along this normal, the x axis is along another normal, or toward the farthest
    contact point.
    """
    down = program.gravity / np.linalg.norm(program.gravity)
    contact = program.kind == CONTACT
    normal = program.normal[contact] if contact.any() else program.normal
    upward = np.where((normal @ down > 0)[:, None], -normal, normal)
    count = (np.abs(normal @ normal.T) > 1.0 - SAME_PLACE).sum(axis=1)
    z = upward[count == count.max()].mean(axis=0)  # of a trough the middle of both sides
    size = float(np.linalg.norm(z))
    z = -down if size < SAME_PLACE else z / size
    others = upward - (upward @ z)[:, None] * z
    reach = arm - (arm @ z)[:, None] * z
    farthest = reach[_order(-np.linalg.norm(reach, axis=1)[:, None])[0]]
    across = others[_order(-np.linalg.norm(others, axis=1)[:, None])[0]]
    for x in (down - (down @ z) * z, across, farthest / max(np.linalg.norm(arm), TINY), *np.eye(3)):
        size = float(np.linalg.norm(x - (x @ z) * z))
        if size > SAME_PLACE:
            x = (x - (x @ z) * z) / size
            return np.stack([x, cross(z, x), z])
    raise AssertionError("three axes span space")


def _united(program: Program) -> Program:
    """The program with one patch for each plane between two bodies, and no point twice."""
    program = _oriented(program, program.part_a, program.part_b)
    middle = program.center[program.free].mean(axis=0)
    arm = program.point - middle
    size = max(float(np.abs(arm).max()), TINY)
    offset = np.einsum("ij,ij->i", program.normal, arm) / size
    own = np.where(program.kind == CONTACT, -1, program.source)
    ends = [program.kind, program.part_a, program.part_b, own, program.mu]
    source = _labels(np.column_stack([*ends, program.normal, offset]))
    corner = _corners(source, arm / size) | (program.kind != CONTACT)
    return program.with_rows(source=source).taking(corner)


def _oriented(program: Program, a: Index, b: Index) -> Program:
    """The program with parts a and b of each row, and normals that point to the later part."""
    back = a > b
    return program.with_rows(
        part_a=np.where(back, b, a),
        part_b=np.where(back, a, b),
        normal=np.where(back[:, None], -program.normal, program.normal),
    )


def _sorted(program: Program) -> Program:
    """The program with sorted bodies and rows."""
    size = max(float(np.abs(program.point).max()), TINY)
    mass = program.mass / max(float(program.mass[program.free].max()), TINY)
    places = np.where(program.free[:, None], program.center, _middles(program)) / size
    order = _order(np.column_stack([program.free, places[:, [2, 0, 1]], mass * program.free]))
    rank = np.empty(len(order) + 1, dtype=np.int64)
    rank[order], rank[-1] = np.arange(len(order)), -1
    program = _oriented(program, rank[program.part_a], rank[program.part_b])
    ends = [program.kind, program.part_a, program.part_b, program.mu]
    along = [program.normal, program.point[:, [2, 0, 1]] / size]
    rows = _order(np.column_stack([*ends, *along]))
    parts = {
        key: getattr(program, key)[order]
        for key in ("free", "center", "mass", "inertia", "radius", "applied", "clamp", "tolerance")
    }
    _, first, label = np.unique(program.source[rows], return_index=True, return_inverse=True)
    number = np.argsort(np.argsort(first))[label.reshape(-1)]
    names = tuple(program.names[k] for k in order)
    return program.taking(rows).with_rows(names=names, source=number, **parts)


def _corners(source: Index, place: Array) -> Mask:
    """Mask of the points that count: of several points of a patch at the same place the first.

    Their slips are equal, so their forces add. A point of a seam inside the united patch counts:
    it may carry the weight with a smaller arm than the corners, against a spin.
    """
    spot = _labels(np.column_stack([source, place]))
    counts = np.zeros(len(spot), dtype=bool)
    counts[np.unique(spot, return_index=True)[1]] = True
    return counts


def _middles(program: Program) -> Array:
    """Middle of the contact points of each part, (N, 3): no far end of a part moves it."""
    total, count = np.zeros_like(program.center), np.zeros(len(program.names))
    for part in (program.part_a, program.part_b):
        k = np.flatnonzero(part >= 0)
        np.add.at(total, part[k], program.point[k])
        np.add.at(count, part[k], 1.0)
    return total / np.maximum(count, 1.0)[:, None]


def _order(keys: Array) -> Index:
    """Order of rows by their columns, the first column first; nearly equal numbers are equal."""
    order: Index = np.lexsort(_rounded(keys).T[::-1])
    return order


def _labels(keys: Array) -> Index:
    """Number of each row; rows with nearly equal columns share it."""
    return np.unique(_rounded(keys), axis=0, return_inverse=True)[1].reshape(-1).astype(np.int64)


def _rounded(keys: Array) -> Index:
    """Number of each value in the order of its column; close values share it."""
    numbers: Index = np.empty(keys.shape, dtype=np.int64)
    for k, column in enumerate(keys.T):
        order = np.argsort(column, kind="stable")
        steps = np.diff(column[order], prepend=column[order[:1]]) > SAME_PLACE
        numbers[order, k] = np.cumsum(steps)
    return numbers
