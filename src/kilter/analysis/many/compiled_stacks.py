"""Compiled verdicts of assemblies of upright prisms on level faces, with their proofs.

The parts are taken from the highest to the lowest. The load of a part is its weight and the forces
of the parts on it. Its supports share the load

    by least squares, f = (1, u, v) . y,               if all of these forces push
    by mean value coordinates of the hull's corners,   if the load acts within the hull

and the forces of all parts are a proof if every part is balanced, and steady
(`kilter.second_order.proofs.level_rest`). If the load of a part acts outside the hull, the part
tips over the nearest edge with all parts on it, and a part without supports drops; that motion is a
proof if it closes no contact, against friction as well, and the weight has power. All other
assemblies are left to the general computation (`kilter.analysis.many.verdicts`), and so are those
near a limit (`kilter.analysis.many.compiled_tolerances`).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from kilter.analysis.many.compiled_code import compiled
from kilter.analysis.many.compiled_prisms import (
    MOST_CONTACTS,
    MOST_CUT,
    MOST_PARTS,
    Desk,
    Meshes,
    Prisms,
    Touches,
    find_touches,
    level_frame,
    new_desk,
    prisms_of,
    read_prism,
    touches_of,
)
from kilter.analysis.many.compiled_tolerances import (
    CARRIES,
    CHANGED,
    INSIDE,
    LEAST_POWER,
    LEFT,
    PRESSED,
    RESIDUAL,
    STABLE,
    STEADY,
    UNSTABLE,
    VIOLATION,
)
from kilter.arrays import Array, Index, Mask

MOST_POINTS = 64
"""Largest number of support points of a part."""


class Statics(NamedTuple):
    """Loads and forces of an assembly while its parts are taken from the highest to the lowest."""

    weight: Array
    """Weight of each part [N], shape (P,); 0 for held parts."""
    held: Mask
    order: Index
    """Parts from the highest lower face to the lowest, shape (P,)."""
    need: Array
    """Load of each part: force [N], and its moments about the centre over the radius, (P, 3)."""
    force: Array
    """Force at each corner of each contact [N], shape (C, MOST_CUT)."""
    moving: Mask
    """Parts that tip or drop, shape (P,)."""
    motion: Array
    """Velocity of the centre of a moving part and its angular velocity, shape (P, 6)."""


def statics_of(parts: int, contacts: int) -> Statics:
    """Empty loads and forces."""
    return Statics(
        np.zeros(parts),
        np.zeros(parts, dtype=np.bool_),
        np.zeros(parts, dtype=np.int64),
        np.zeros((parts, 3)),
        np.zeros((contacts, MOST_CUT)),
        np.zeros(parts, dtype=np.bool_),
        np.zeros((parts, 6)),
    )


class Answers(NamedTuple):
    """Verdict of each of M assemblies (`LEFT`, `STABLE`, `UNSTABLE`), and its proof's numbers."""

    code: Index
    residual: Array
    power: Array
    violation: Array


@compiled
def _solve(
    gram: tuple[float, float, float, float, float, float], x: float, y: float, z: float
) -> tuple[float, float, float, float]:
    """Solve a symmetric system of three equations; also bound its least eigenvalue from below.

    Arguments: `gram`: entries 11, 12, 13, 22, 23 and 33; `x`, `y`, `z`: right side.
    """
    a, b, c, d, e, f = gram
    p, q, r = d * f - e * e, c * e - b * f, b * e - c * d
    det = a * p + b * q + c * r
    trace = a + d + f
    if not det > 0:
        return 0.0, 0.0, 0.0, 0.0
    s, t, w = a * f - c * c, b * c - a * e, a * d - b * b
    # the product of the two larger eigenvalues is at most a quarter of the square of the trace
    return (
        (p * x + q * y + r * z) / det,
        (q * x + s * y + t * z) / det,
        (r * x + t * y + w * z) / det,
        4 * det / (trace * trace),
    )


@compiled
def _footing(prisms: Prisms, p: int, point: Array) -> tuple[float, float]:
    """Horizontal place (u, v) of a point from the centre of part p, over its radius."""
    return (
        (point[0] - prisms.centre[p, 0]) / prisms.size[p, 1],
        (point[1] - prisms.centre[p, 1]) / prisms.size[p, 1],
    )


@compiled
def _share_least(feet: Array, count: int, need: Array, force: Array) -> bool:
    """Share a load by least squares; false if a force pulls or the supports are on a line."""
    su = sv = suu = suv = svv = 0.0
    for k in range(count):
        u, v = feet[k, 0], feet[k, 1]
        su, sv, suu, suv, svv = su + u, sv + v, suu + u * u, suv + u * v, svv + v * v
    gram = (float(count), su, sv, suu, suv, svv)
    a, b, c, least = _solve(gram, need[0], need[1], need[2])
    if not least > STEADY * (count + suu + svv):
        return False
    for k in range(count):
        force[k] = a + b * feet[k, 0] + c * feet[k, 1]
        if not force[k] > 1e-3 * need[0] / count:
            return False
    return True


@compiled
def _hull(feet: Array, count: int, hull: Index) -> int:
    """Write the corners of the convex hull, counterclockwise; return their number (Jarvis)."""
    start = 0
    for k in range(1, count):
        if (feet[k, 0], feet[k, 1]) < (feet[start, 0], feet[start, 1]):
            start = k
    here, n = start, 0
    while n < count:
        hull[n], n = here, n + 1
        best = -1
        for k in range(count):
            x, y = feet[k, 0] - feet[here, 0], feet[k, 1] - feet[here, 1]
            if x * x + y * y < INSIDE * INSIDE:
                continue
            if best < 0:
                best = k
                continue
            bx, by = feet[best, 0] - feet[here, 0], feet[best, 1] - feet[here, 1]
            turn = bx * y - by * x
            if turn < -1e-12 or (turn <= 1e-12 and x * x + y * y > bx * bx + by * by):
                best = k
        if best < 0:
            break
        x, y = feet[best, 0] - feet[start, 0], feet[best, 1] - feet[start, 1]
        if x * x + y * y < INSIDE * INSIDE:
            break
        here = best
    return n


@compiled
def _beyond(feet: Array, hull: Index, n: int, u: float, v: float) -> tuple[float, int]:
    """Largest distance of a place beyond an edge of a hull, and the edge."""
    most, edge = -np.inf, -1
    for k in range(n):
        a, b = hull[k], hull[(k + 1) % n]
        x, y = feet[b, 0] - feet[a, 0], feet[b, 1] - feet[a, 1]
        out = ((u - feet[a, 0]) * y - (v - feet[a, 1]) * x) / np.sqrt(x * x + y * y)
        if out > most:
            most, edge = out, k
    return most, edge


@compiled
def _share_hull(feet: Array, count: int, hull: Index, n: int, need: Array, force: Array) -> None:
    """Share a load within a hull by mean value coordinates, which are positive."""
    u, v = need[1] / need[0], need[2] / need[0]
    force[:count] = 0.0
    tangent = np.empty(n)
    for k in range(n):
        a, b = hull[k], hull[(k + 1) % n]
        ax, ay, bx, by = feet[a, 0] - u, feet[a, 1] - v, feet[b, 0] - u, feet[b, 1] - v
        cross, dot = ax * by - ay * bx, ax * bx + ay * by
        tangent[k] = cross / (np.sqrt((ax * ax + ay * ay) * (bx * bx + by * by)) + dot)
    total = 0.0
    for k in range(n):
        a = hull[k]
        far = np.hypot(feet[a, 0] - u, feet[a, 1] - v)
        force[a] = (tangent[k - 1] + tangent[k]) / far
        total += force[a]
    force[:count] *= need[0] / total


@compiled
def _gather(prisms: Prisms, touches: Touches, found: int, p: int, feet: Array) -> int:
    """Write the footings of the supports of part p; return their number, -1 if too many."""
    count = 0
    for c in range(found):
        if touches.upper[c] == p:
            for k in range(touches.sides[c]):
                if count == MOST_POINTS:
                    return -1
                feet[count, 0], feet[count, 1] = _footing(prisms, p, touches.points[c, k])
                count += 1
    return count


@compiled
def _pass_down(
    prisms: Prisms, touches: Touches, found: int, p: int, force: Array, statics: Statics
) -> None:
    """Store the forces of the supports of part p, and add them to the loads of the parts below."""
    at = 0
    for c in range(found):
        if touches.upper[c] == p:
            lower = touches.lower[c]
            for k in range(touches.sides[c]):
                statics.force[c, k] = force[at]
                u, v = _footing(prisms, lower, touches.points[c, k])
                statics.need[lower, 0] += force[at]
                statics.need[lower, 1] += force[at] * u
                statics.need[lower, 2] += force[at] * v
                at += 1


@compiled
def _tip(
    prisms: Prisms, p: int, feet: Array, a: int, b: int, statics: Statics, touches: Touches,
    found: int,
) -> None:  # fmt: skip
    """Let part p and all parts on it turn about the edge from support a to b; drop if a = b < 0."""
    statics.moving[:] = False
    statics.motion[:] = 0.0
    statics.moving[p] = True
    changed = True
    while changed:
        changed = False
        for c in range(found):
            if statics.moving[touches.lower[c]] and not statics.moving[touches.upper[c]]:
                statics.moving[touches.upper[c]] = changed = True
    if a < 0:
        for q in range(len(statics.order)):
            if statics.moving[q]:
                statics.motion[q, 2] = -1.0
        return
    radius = prisms.size[p, 1]
    x, y = feet[b, 0] - feet[a, 0], feet[b, 1] - feet[a, 1]
    long = np.sqrt(x * x + y * y)
    x, y = x / long, y / long  # the hull is to the left of the edge: it turns to the right
    px = prisms.centre[p, 0] + radius * feet[a, 0]
    py = prisms.centre[p, 1] + radius * feet[a, 1]
    pz = prisms.level[p, 0]
    for q in range(len(statics.order)):
        if not statics.moving[q]:
            continue
        dx, dy = prisms.centre[q, 0] - px, prisms.centre[q, 1] - py
        dz = prisms.centre[q, 2] - pz
        # the angular velocity (x, y, 0) times the arm
        statics.motion[q, 0], statics.motion[q, 1] = y * dz, -x * dz
        statics.motion[q, 2] = x * dy - y * dx
        statics.motion[q, 3], statics.motion[q, 4] = x, y


@compiled
def _point_speed(
    prisms: Prisms, statics: Statics, part: int, x: float, y: float, z: float
) -> tuple[float, float, float]:
    motion, centre = statics.motion[part], prisms.centre[part]
    dx, dy, dz = x - centre[0], y - centre[1], z - centre[2]
    return (
        motion[0] + motion[4] * dz,
        motion[1] - motion[3] * dz,
        motion[2] + motion[3] * dy - motion[4] * dx,
    )


@compiled
def _judge_motion(
    prisms: Prisms, touches: Touches, found: int, parts: int, mu: float, statics: Statics
) -> tuple[bool, float, float]:
    """Whether the motion is a proof, its power [W at 1 m/s], and its largest violation."""
    fastest = power = total = 0.0
    for p in range(parts):
        total += statics.weight[p]
        if not statics.moving[p]:
            continue
        if statics.held[p]:
            return False, 0.0, 0.0
        v = statics.motion[p]
        turn = (v[3] * v[3] + v[4] * v[4]) * prisms.size[p, 1] * prisms.size[p, 1]
        fastest = max(fastest, np.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2] + turn))
        power -= statics.weight[p] * v[2]
    violation = 0.0
    for c in range(found):
        lower, upper = touches.lower[c], touches.upper[c]
        if statics.moving[lower] == statics.moving[upper]:
            continue
        z = prisms.level[upper, 0]
        for k in range(touches.sides[c]):
            x, y = touches.points[c, k]
            up = _point_speed(prisms, statics, upper, x, y, z)
            down = _point_speed(prisms, statics, lower, x, y, z)
            slip = np.hypot(up[0] - down[0], up[1] - down[1])
            violation = max(violation, mu * slip - (up[2] - down[2]))
    if not fastest > 0:
        return False, 0.0, 0.0
    power, violation = power / fastest, violation / fastest
    return violation <= VIOLATION and power > LEAST_POWER * total, power, violation


@compiled
def _carried_sums(
    prisms: Prisms, touches: Touches, found: int, parts: int, statics: Statics
) -> tuple[Array, Array, float]:
    """Balance (force and moments over the radius) and sum of forces of each part; the largest."""
    left, sums, largest = np.zeros((parts, 3)), np.zeros(parts), 0.0
    left[:, 0] = -statics.weight[:parts]
    for c in range(found):
        for k in range(touches.sides[c]):
            force = statics.force[c, k]
            if force < 0:
                return left, sums, -1.0
            largest = max(largest, force)
            for side in range(2):
                p = touches.upper[c] if side == 0 else touches.lower[c]
                u, v = _footing(prisms, p, touches.points[c, k])
                push = force if side == 0 else -force
                left[p, 0] += push
                left[p, 1] += push * u
                left[p, 2] += push * v
                sums[p] += force
    return left, sums, largest


@compiled
def _judge_forces(
    prisms: Prisms, touches: Touches, found: int, parts: int, statics: Statics
) -> tuple[bool, float]:
    """Whether the forces prove that all parts stay, and their largest relative imbalance."""
    left, sums, largest = _carried_sums(prisms, touches, found, parts, statics)
    worst = 0.0
    if largest < 0:
        return False, 0.0
    for place in range(parts):
        p = statics.order[place]
        if statics.held[p]:
            continue
        size = np.sqrt(left[p, 0] ** 2 + left[p, 1] ** 2 + left[p, 2] ** 2)
        worst = max(worst, size / statics.weight[p])
        if not (worst <= RESIDUAL and sums[p] <= PRESSED * statics.weight[p]):
            return False, worst
    for place in range(parts):  # the exact correction of the forces, from the highest part down
        p = statics.order[place]
        if statics.held[p]:
            continue
        s = su = sv = suu = suv = svv = 0.0
        for c in range(found):
            if touches.upper[c] == p:
                for k in range(touches.sides[c]):
                    force = statics.force[c, k]
                    if force > CARRIES * largest:
                        u, v = _footing(prisms, p, touches.points[c, k])
                        s, su, sv = s + force, su + force * u, sv + force * v
                        suu, suv = suu + force * u * u, suv + force * u * v
                        svv += force * v * v
        gram = (s, su, sv, suu, suv, svv)
        a, b, d, least = _solve(gram, -left[p, 0], -left[p, 1], -left[p, 2])
        if not least > STEADY * (s + suu + svv):
            return False, worst
        for c in range(found):
            if touches.upper[c] == p:
                for k in range(touches.sides[c]):
                    u, v = _footing(prisms, p, touches.points[c, k])
                    change = a + b * u + d * v
                    if not abs(change) < CHANGED:
                        return False, worst
                    lower, force = touches.lower[c], statics.force[c, k] * change
                    u, v = _footing(prisms, lower, touches.points[c, k])
                    left[lower, 0] -= force
                    left[lower, 1] -= force * u
                    left[lower, 2] -= force * v
    return True, worst


@compiled
def _spread(prisms: Prisms, touches: Touches, found: int, parts: int, statics: Statics) -> int:
    """Find forces, or the motion of the highest part that no forces hold."""
    feet, force = np.empty((MOST_POINTS, 2)), np.empty(MOST_POINTS)
    hull = np.empty(MOST_POINTS, dtype=np.int64)
    for place in range(parts):
        p = statics.order[place]
        if statics.held[p]:
            continue
        count, need = _gather(prisms, touches, found, p, feet), statics.need[p]
        if count < 0:
            return LEFT
        if count == 0:
            _tip(prisms, p, feet, -1, -1, statics, touches, found)
            return UNSTABLE
        if not _share_least(feet, count, need, force):
            n = _hull(feet, count, hull)
            if n < 3:
                return LEFT
            beyond, edge = _beyond(feet, hull, n, need[1] / need[0], need[2] / need[0])
            if beyond > INSIDE:
                a, b = hull[edge], hull[(edge + 1) % n]
                _tip(prisms, p, feet, a, b, statics, touches, found)
                return UNSTABLE
            if beyond > -INSIDE:
                return LEFT
            _share_hull(feet, count, hull, n, need, force)
        _pass_down(prisms, touches, found, p, force, statics)
    return STABLE


@compiled
def _prepare(
    meshes: Meshes, k: int, frame: Array, prisms: Prisms, statics: Statics, desk: Desk
) -> bool:
    """Read the parts of assembly k, their weights, and their order; false if one is not read."""
    first, last = meshes.part_start[k], meshes.part_start[k + 1]
    gravity = np.sqrt((meshes.gravity[k] * meshes.gravity[k]).sum())
    held = False
    for p in range(last - first):
        if not read_prism(meshes, first + p, frame, prisms, p, desk):
            return False
        mass = meshes.mass[first + p]
        if mass != mass:  # by its density
            mass = meshes.density[first + p] * (prisms.size[p, 0] * meshes.metres[k] ** 3)
        if not 1e-50 < mass < 1e50:
            return False
        statics.held[p] = meshes.held[first + p]
        held = held or statics.held[p]
        statics.weight[p] = 0.0 if statics.held[p] else mass * gravity
        statics.need[p] = 0.0
        statics.need[p, 0] = statics.weight[p]
        at, low = p, prisms.level[p, 0]
        while at > 0 and prisms.level[statics.order[at - 1], 0] < low:
            statics.order[at] = statics.order[at - 1]
            at -= 1
        statics.order[at] = p
    return held


@compiled
def decide_prisms(
    meshes: Meshes,
    tolerance: tuple[float, float],
    answers: Answers,
    scratch: tuple[Prisms, Touches, Statics, Desk],
) -> None:
    """Write the verdict of each assembly of upright prisms that is clear.

    Arguments: `tolerance`: the relative and the absolute gap, which is negative if not given.
    """
    prisms, touches, statics, desk = scratch
    frame = np.empty((3, 3))
    for k in range(len(meshes.gravity)):
        parts = meshes.part_start[k + 1] - meshes.part_start[k]
        if parts > MOST_PARTS or not level_frame(meshes.gravity[k], frame):
            continue
        if not _prepare(meshes, k, frame, prisms, statics, desk):
            continue
        found, near = find_touches(prisms, parts, tolerance[0], tolerance[1], touches)
        if found < 0:
            continue
        code = _spread(prisms, touches, found, parts, statics)
        if code == STABLE:
            good, residual = _judge_forces(prisms, touches, found, parts, statics)
            if good:
                answers.code[k], answers.residual[k] = STABLE, residual
        elif code == UNSTABLE and not near:
            mu = meshes.friction[k]
            good, power, violation = _judge_motion(prisms, touches, found, parts, mu, statics)
            if good:
                answers.code[k] = UNSTABLE
                answers.power[k], answers.violation[k] = power, violation


def decide_meshes(meshes: Meshes, relative_gap: float, gap: float | None) -> Answers:
    """Decide the clear assemblies among meshes; the others are `LEFT`."""
    count = len(meshes.gravity)
    unknown = (np.full(count, np.nan) for _ in range(3))
    answers = Answers(np.zeros(count, dtype=np.int64), *unknown)
    scratch = (
        prisms_of(MOST_PARTS),
        touches_of(MOST_CONTACTS),
        statics_of(MOST_PARTS, MOST_CONTACTS),
        new_desk(),
    )
    tolerance = (float(relative_gap), -1.0 if gap is None else float(gap))
    decide_prisms(meshes, tolerance, answers, scratch)
    return answers
