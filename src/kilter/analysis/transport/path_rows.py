"""Linear constraints on the speed of a carrier along its path, for planners such as TOPPRA.

The carrier runs along the path with s(t), where s is the time of the path: with speed s' and
acceleration s''. With u = s'' and x = s'^2, the load vector of a sample (`carrier_path`) is

    z = z_still + u z_start + x z_move
    z_start = (-v, o, 0),     z_move = (-a, al, O)

The carried (u, x) of a sample are a plane section of the convex cone of carried loads. Its boundary
lies between a polygon, whose corners forces prove, and lines, which motions prove:

    inner    edges of the polygon: (u, x) that obey them are carried
    outer    lines: every carried (u, x) obeys them

References
----------
H. Pham, Q.-C. Pham, A new approach to time-optimal path parameterization based on reachability
analysis, 2018: constraints a u + b x + c <= 0 at each sample.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kilter.analysis.analysis_tolerances import TILT_AGREES
from kilter.analysis.load_limit import Limit, NoLimit, SharedCones, find_limit
from kilter.analysis.transport.carried_set import MOST, Slice
from kilter.analysis.transport.carrier import load_matrix
from kilter.analysis.transport.path import PathLimit
from kilter.analysis.transport.plane_section import SupportLine, enclose_section
from kilter.arrays import TINY, Array
from kilter.errors import InputError
from kilter.mechanics.mechanics_tolerances import TOLERANCE
from kilter.mechanics.program import Program

# Linear constraints A a <= b on the acceleration of a carrier, for path planners.


Known = Sequence[tuple[Array, Limit]]
"""Unit directions, shape (3,), and the largest acceleration along each [g]."""


def inner_rows(program: Program, known: Known, polar: Slice | None) -> tuple[Array, Array]:
    """Constraints A a <= b on an acceleration a [m/s^2]; if a satisfies all, forces can hold."""
    from scipy.spatial import ConvexHull, QhullError

    points = [min(limit.value, MOST) * direction for direction, limit in known]
    if polar is not None:
        points += list(polar.points @ polar.axes)
    carried = np.vstack([np.zeros(3), *points]) * program.g
    used = np.array([0, 2]) if program.planar else np.arange(3)
    try:
        facets = ConvexHull(carried[:, used]).equations
    except QhullError:
        raise InputError(
            "the carried accelerations lie in a plane or on a line", hint="use outer rows"
        ) from None
    facets = np.unique(facets.round(12), axis=0)
    rows = np.zeros((len(facets), 3))
    rows[:, used] = facets[:, :-1]
    return rows, -facets[:, -1]


def outer_rows(program: Program, known: Known, polar: Slice | None) -> tuple[Array, Array]:
    """Constraints A a <= b on an acceleration a [m/s^2]; if a violates one, no forces can hold."""
    rows, bounds = [], []
    for _, limit in known:
        if limit.motion is None:
            continue
        motion = limit.motion.motion
        moment = (program.mass * program.free) @ motion[:, :3]
        size = float(np.linalg.norm(moment))
        if size > 0.0:
            rows.append(-moment / size)
            bounds.append(-program.power(motion) / size)
    if polar is not None:
        proved = polar.proved
        rows += list((polar.normals @ polar.axes)[proved])
        bounds += list(polar.reach[proved] * program.g)
    return np.array(rows).reshape(-1, 3), np.array(bounds)


ACCURACY = 5e-3
"""Largest distance between the polygon and the lines of a sample [g]."""
INSIDE = 0.5
"""Position of the first carried point between the least and the largest squared speed [-]."""


def path_rows(program: Program, speed: PathLimit, *, inner: bool) -> tuple[Array, Array]:
    """Constraints ``A[i] @ (u, x) <= b[i]`` at each sample i of a path.

    Arguments: `inner`: True for constraints that suffice, False for constraints that are necessary.
    Returns `A` (n, m, 2): coefficients of u = s'' [1/s] and x = s'^2 [-]; unused rows are zero; `b`
    (n, m): nonnegative for unused rows. Raises `InputError` if the path has no velocities, or the
    limits of a sample are not known.
    """
    path = speed.path
    still, move = path.loads(program)
    start = path.starting_loads()
    matrix = load_matrix(program, path.about)
    least, largest = speed.slowest**2, min(speed.lower**2, 1.0 + speed.slowest**2)
    base = 0.0 if least == 0.0 else least + INSIDE * (largest - least)
    rows, bounds = [], []
    for sample in range(len(path.time)):
        loads = np.stack([start[sample], move[sample]])
        sizes = _sizes(program, matrix, loads)
        section = _section(program, matrix, still[sample] + base * move[sample], loads / sizes)
        if isinstance(section, NoLimit):
            raise InputError(
                f"the limits of the sample at {path.time[sample]:g} s are not known",
                hint="give a path along which the parts are held with some margin",
            )
        normals, reach = _edges(section) if inner else _lines(section)
        scaled = normals * sizes.ravel()
        rows.append(scaled)
        bounds.append(reach + scaled[:, 1] * base)
    count = max(len(row) for row in rows)
    matrix_rows, levels = np.zeros((len(rows), count, 2)), np.ones((len(rows), count))
    for sample, (row, bound) in enumerate(zip(rows, bounds, strict=True)):
        matrix_rows[sample, : len(row)], levels[sample, : len(row)] = row, bound
    return matrix_rows, levels


def _sizes(program: Program, matrix: Array, loads: Array) -> Array:
    """Largest acceleration of a part that each load causes, in g, shape (2, 1); 1 without any."""
    wrench = np.einsum("pij,kj->kpi", matrix, loads)
    force = np.linalg.norm(wrench[..., :3], axis=2)
    torque = np.linalg.norm(wrench[..., 3:], axis=2) / program.radius
    weight = np.where(program.free, program.mass * program.g, np.inf)
    largest = ((force + torque) / weight).max(axis=1)
    sizes: Array = np.where(largest > TINY, largest, 1.0)[:, None]
    return sizes


def _section(
    program: Program, matrix: Array, base: Array, loads: Array
) -> list[SupportLine] | NoLimit:
    """Boundary of the carried combinations of two loads beside a base load, as points and lines."""
    wrenches = np.einsum("pij,kj->kpi", matrix, loads)
    rest = np.einsum("pij,j->pi", matrix[..., 3:], base[3:])
    at_base = program.with_rows(gravity=base[:3], applied=program.applied + rest)
    shared = SharedCones(at_base)

    def support(direction: Array) -> SupportLine | NoLimit:
        wrench = np.einsum("k,kpi->pi", direction, wrenches)
        limit = find_limit(at_base, wrench, shared=shared, most=MOST, from_none=True)
        return limit if isinstance(limit, NoLimit) else _line(at_base, wrenches, direction, limit)

    section = enclose_section(support, accuracy=ACCURACY)
    return section if isinstance(section, NoLimit) else section[0]


def _line(program: Program, wrenches: Array, direction: Array, limit: Limit) -> SupportLine:
    """Boundary point along a direction, and the line around the carried points of its mechanism."""
    reach = max(min(limit.value, MOST), 0.0)
    point, limited = reach * direction, bool(np.isfinite(limit.value))
    if limit.motion is None:
        return SupportLine(direction, point, direction, reach, limited, False)
    motion = limit.motion.motion
    outward = np.einsum("kpi,pi->k", wrenches, motion)
    size = float(np.linalg.norm(outward))
    distance = -program.power(motion) / size if size > 0.0 else np.inf
    if not 0.0 <= distance <= reach * (1 + TILT_AGREES) + TOLERANCE:
        return SupportLine(direction, point, direction, reach, limited, False)
    return SupportLine(direction, point, outward / size, distance, limited, True)


def _edges(section: list[SupportLine]) -> tuple[Array, Array]:
    """Outward unit normals, (m, 2), and distances, (m,), of the edges of the polygon."""
    from scipy.spatial import ConvexHull

    facets = ConvexHull(np.array([support.point for support in section])).equations
    return facets[:, :2], -facets[:, 2]


def _lines(section: list[SupportLine]) -> tuple[Array, Array]:
    """Unit normals, (m, 2), and distances, (m,), of the lines that motions prove."""
    proved = [support for support in section if support.proved]
    normals = np.array([support.normal for support in proved]).reshape(-1, 2)
    return normals, np.array([support.reach for support in proved])
