"""Rims and tips: forces at round rims of flat faces, and candidates at the ends of faces.

The forces of the circumscribed polygon bound the answer from the other side.

The end of a hollow cylinder at the height t of its axis a is a circle of radius r about the point
c = p + t a. A ball of radius R > r about the axis, with its centre at the height h over c, outside
of the hole, touches the whole rim if r^2 + h^2 = R^2. The normals of the contact are those of the
ball: from its centre to the rim, (r u - h a) / R for the direction u away from the axis.

The end of a cylinder or cone at the height h of its axis a is a circle of radius rho about c + h a.
With n the outward normal of the plane, its nearest point to the plane is the farthest along -n, c +
h a + rho u, u = the unit direction of -n less its part along a. The plane touches the rim there
from outside if -n lies between the normal of the side and that of the end, which is +a or -a. The
tip of a cone touches a plane that has the whole side in front of it: n . a >= sin(half_angle).

If -n is along the axis, the end lies flat; if -n is a normal of the side, the part lies on a
generator. Both are other contacts (`flat_contacts`, `kilter.contact.curved.candidates`).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from kilter.arrays import Array, Index, Mask, cross, unit_rows
from kilter.assembly.geometry import Geometry
from kilter.assembly.surfaces import CONE, CYLINDER, FREE, SPHERE, Surfaces
from kilter.contact.common.patches import Patches, PossibleContacts
from kilter.contact.contact_tolerances import APEX, RIM_LEVEL
from kilter.contact.curved.candidates import (
    CIRCLE,
    POINT,
    Candidates,
    Planes,
    Side,
    dot,
    make_candidates,
    without_along,
)
from kilter.contact.curved.contact_points import bands_of

Force = tuple[int, int, Array, Array]
"""Parts a and b, point, and unit direction of a force."""


def possible_forces(forces: list[Force], *, two_sided: bool) -> PossibleContacts:
    """Convert a list of forces to `PossibleContacts` without friction."""
    count = len(forces)
    return PossibleContacts(
        part_a=np.array([a for a, _, _, _ in forces], dtype=np.int64),
        part_b=np.array([b for _, b, _, _ in forces], dtype=np.int64),
        points=np.array([point for _, _, point, _ in forces]).reshape(count, 3),
        normals=np.array([normal for _, _, _, normal in forces]).reshape(count, 3),
        two_sided=np.full(count, two_sided),
        mu=np.zeros(count),
        degenerate=np.full(count, -1),
    )


def rims_clear(
    geometry: Geometry, vertex: Index, normal: Array, off: Array, tolerance: Array
) -> Mask:
    """Mask of corners whose whole circle stays in front of a plane, shape (n,).

    A corner v of the rim of a cylinder or cone lies `off` in front of a plane with unit `normal` n.
    The lowest point of the rim, a circle about c with radius rho across the axis, is lower by (v -
    c).n + rho |n across the axis|.
    """
    s = geometry.surfaces
    if not len(s):
        return np.zeros(len(vertex), dtype=bool)
    surface, exact = _rims_at(geometry, vertex)
    _, rho, away = s.polar(surface, geometry.vertices[vertex])
    normal_across = (
        normal - np.einsum("ij,ij->i", normal, s.axis[surface])[:, None] * s.axis[surface]
    )
    drop = rho * (np.einsum("ij,ij->i", away, normal) + np.linalg.norm(normal_across, axis=1))
    clear: Mask = exact & (off - drop > tolerance)
    return clear


def _rims_at(geometry: Geometry, vertex: Index) -> tuple[Index, Mask]:
    """Curved surface at each corner (-1: none), and mask of exact cylinders and cones."""
    s = geometry.surfaces
    surface_of_vertex = np.full(len(geometry.vertices), -1)
    curved_triangles = np.flatnonzero(geometry.triangle_surface >= 0)
    surface_of_vertex[geometry.triangles[curved_triangles]] = geometry.triangle_surface[
        curved_triangles, None
    ]
    surface = surface_of_vertex[vertex]
    exact = (surface >= 0) & np.isin(s.kind[surface], (CYLINDER, CONE)) & (s.doubt[surface] == 0)
    return surface, exact


def coaxial_clear(geometry: Geometry, vertex: Index, tolerance: Array) -> Mask:
    """Mask of coaxial rims whose true circles keep a distance from each other, shape (n,).

    Circles about the same axis, with radii r and s, a height h apart, have the distance hypot(r -
    s, h).

    `tolerance`, shape (n,): largest gap of touching rims [length unit].
    """
    s = geometry.surfaces
    if not len(s) or not len(vertex):
        return np.zeros(len(vertex), dtype=bool)
    surface, exact = _rims_at(geometry, vertex.reshape(-1))
    surface = surface.reshape(-1, 2, 2)
    clear: Mask = exact.reshape(-1, 4).all(axis=1) & (surface[:, :, 0] == surface[:, :, 1]).all(
        axis=1
    )
    first, second = surface[:, :, 0].T
    axis, base = s.axis[first], s.point[first]
    clear &= np.linalg.norm(cross(axis, s.axis[second]), axis=1) <= RIM_LEVEL
    relative = geometry.vertices[vertex] - base[:, None, None]
    height = np.einsum("nkei,ni->nke", relative, axis)
    radial = relative - height[..., None] * axis[:, None, None]
    radius = np.linalg.norm(radial, axis=3)
    axis_offset = s.point[second] - base
    axis_offset = axis_offset - np.einsum("ni,ni->n", axis_offset, axis)[:, None] * axis
    for value in (height, radius):  # each chord must lie in a circle about the axis
        clear &= (np.ptp(value, axis=2) <= tolerance[:, None]).all(axis=1)
    apart = np.hypot(*(value[:, 0, 0] - value[:, 1, 0] for value in (height, radius)))
    clear &= apart - np.linalg.norm(axis_offset, axis=1) > tolerance
    result: Mask = clear
    return result


def rim_contacts(geometry: Geometry, flat: Patches) -> PossibleContacts:
    """Possible forces at the round rim of a flat patch, on a polygon that contains the rim.

    The contact area of a flat patch with a round rim is larger than the polygon of its corners.

    The corners of a patch on the rim are moved outwards, so that the polygon contains the circle.
    """
    s = geometry.surfaces
    forces: list[Force] = []
    is_round = np.diff(s.start) > 0
    for patch in np.flatnonzero(is_round[flat.parts].any(axis=1)):
        a, b = (int(k) for k in flat.parts[patch])
        corners, normal = flat.corners(int(patch)), flat.normal[patch]
        for part in (a, b):
            for surface in range(int(s.start[part]), int(s.start[part + 1])):
                rim = _rim(s, surface, normal, corners)
                if rim is None:
                    continue
                offsets, stretch = rim
                forces.extend(
                    (a, b, point + (stretch - 1) * offset, normal)
                    for point, offset in zip(corners, offsets, strict=True)
                    if offset.any()
                )
    return possible_forces(forces, two_sided=False)


def _rim(s: Surfaces, surface: int, normal: Array, corners: Array) -> tuple[Array, float] | None:
    """Radial vectors to the corners of a patch on a rim, and the factor that encloses the rim.

    Radii times this factor give a polygon that contains the circle.

    The vector is 0 for corners that are not on the rim; None if the surface has no rim in this
    plane.
    """
    kind, axis, center = int(s.kind[surface]), s.axis[surface], s.point[surface]
    if kind == SPHERE:
        axis = normal
    if kind == FREE or s.hollow[surface] or abs(float(axis @ normal)) < 1 - RIM_LEVEL:
        return None
    height = float((corners[0] - center) @ axis)
    radius = radius_at(s, surface, height)
    if radius is None:
        return None
    offsets = corners - center
    offsets = offsets - np.outer(offsets @ axis, axis)
    sagitta = min(float(s.sagitta[surface]), radius / 2)
    off = radius - np.linalg.norm(offsets, axis=1)
    on_rim = (off <= sagitta + RIM_LEVEL * radius) & (off >= -RIM_LEVEL * radius)
    if not on_rim.any() or sagitta <= 0:
        return None
    return np.where(on_rim[:, None], offsets, 0.0), radius / (radius - sagitta)


def radius_at(s: Surfaces, surface: int, height: float) -> float | None:
    """Radius of the circle in which a plane at `height` cuts a surface; None without a circle.

    The plane is perpendicular to the axis.
    """
    kind, radius = int(s.kind[surface]), float(s.radius[surface])
    if kind == CYLINDER:
        return radius
    if kind == CONE:
        cut = height * float(np.tan(s.half_angle[surface]))
    elif kind == SPHERE:
        cut = float(np.sqrt(max(radius**2 - height**2, 0.0)))
    else:
        tube = float(s.tube[surface])
        near = abs(height) <= tube * (1 + RIM_LEVEL)
        cut = radius + float(np.sqrt(max(tube**2 - height**2, 0.0))) if near else 0.0
    return cut if cut > 0 else None


def balls_on_rims(geometry: Geometry, i: Index, j: Index, gap: Array) -> Candidates:
    """Candidate circle contacts of balls with the ends of hollow cylinders.

    Pairs of other kinds have no candidates. `gap`, shape (n,), is the largest distance of the
    ball's centre from the axis [length unit].
    """
    s = geometry.surfaces

    def are(first: Index, second: Index) -> Index:
        """Rows with a ball in `first` and a narrower hollow cylinder in `second`."""
        pairs = (s.kind[first] == SPHERE) & ~s.hollow[first]
        pairs &= (s.kind[second] == CYLINDER) & s.hollow[second]
        return np.flatnonzero(pairs & (s.radius[second] < s.radius[first]))

    forth, back = are(i, j), are(j, i)
    row = np.concatenate([forth, back])
    if not len(row):
        return Candidates.none()
    ball, hole = Side(s, np.append(i[forth], j[back])), Side(s, np.append(j[forth], i[back]))
    sense = np.append(np.ones(len(forth)), -np.ones(len(back)))
    used, band_row = np.unique(hole.row, return_inverse=True)
    bands = bands_of(geometry, used)
    blocks = []
    for height, end in ((bands.low[band_row], -1.0), (bands.high[band_row], 1.0)):
        center = hole.point + height[:, None] * hole.axis
        over = dot(ball.point - center, hole.axis)
        aside = np.linalg.norm(ball.point - center - over[:, None] * hole.axis, axis=1)
        distance = np.hypot(hole.radius, over)
        out, up = hole.radius / distance, -over / distance
        circle = make_candidates(
            CIRCLE,
            center,
            sense[:, None] * np.column_stack([out, up, 0 * out]),
            distance - ball.radius,
            along=hole.axis,
            radius=hole.radius,
            swing=aside * out,
            bend=ball.radius,
            rim=np.where(sense > 0, 2.0, 1.0),
        )
        blocks.append(replace(circle, row=row).take((end * over > 0) & (aside <= gap[row])))
    return Candidates.join(blocks)


def rims_on_planes(geometry: Geometry, i: Index, planes: Planes, angle: Array) -> Candidates:
    """Candidate point contacts of the circular ends of cylinders and cones `i` with planes.

    Surfaces of other kinds, and hollow surfaces, have no candidates. `angle`, shape (n,), is the
    largest angle at which an end lies flat, or a side lies on the plane [rad].
    """
    s = geometry.surfaces
    row = np.flatnonzero(np.isin(s.kind[i], (CYLINDER, CONE)) & ~s.hollow[i])
    if not len(row):
        return Candidates.none()
    used, band_row = np.unique(i[row], return_inverse=True)
    bands = bands_of(geometry, used)
    low, high = bands.low[band_row], bands.high[band_row]
    side, n, o, level = Side(s, i[row]), planes.normal[row], planes.origin[row], angle[row]
    found = Candidates.join(
        [
            _rims(side, n, o, level, low, -1.0),
            _rims(side, n, o, level, high, 1.0),
            _tips(side, n, o, level, low, high),
        ]
    )
    return replace(found, row=row[found.row])


def _rims(a: Side, n: Array, o: Array, angle: Array, height: Array, end: float) -> Candidates:
    """Candidate contacts: the lowest points of the end circles at `height` over their planes.

    `end` is 1 at the upper and -1 at the lower end.
    """
    alpha = np.where(a.kind == CONE, a.half_angle, 0.0)
    radius = np.where(a.kind == CONE, height * np.tan(alpha), a.radius)
    aside = without_along(-n, a.axis)
    sine = np.linalg.norm(aside, axis=1)
    out = unit_rows(aside)
    # -n = side (out cos - axis sin) + rest (end axis), neither below zero
    rest = end * (dot(-n, a.axis) + sine * np.tan(alpha))
    at = a.point + height[:, None] * a.axis + radius[:, None] * out
    bend = radius / np.maximum(sine, np.sin(angle))
    points = _points(at, n, o, along=out, radius=radius, bend=bend)
    return points.take((sine > np.sin(angle)) & (rest > np.sin(angle)) & (radius > 0))


def _tips(a: Side, n: Array, o: Array, angle: Array, low: Array, high: Array) -> Candidates:
    """Candidate point contacts of the tips of cones with their planes."""
    # angle by which the side rises from the plane
    lean = np.arcsin(np.clip(dot(n, a.axis), -1, 1)) - a.half_angle
    bend = high * np.tan(a.half_angle) / np.sin(np.maximum(lean, angle))
    points = _points(a.point, n, o, along=-a.axis, bend=bend)
    return points.take((a.kind == CONE) & (low <= APEX * high) & (lean > angle))


def _points(at: Array, n: Array, o: Array, **more: Array) -> Candidates:
    """Candidate contacts of points `at` with planes."""
    gap = dot(at - o, n)
    return make_candidates(POINT, at - (gap / 2)[:, None] * n, -n, gap, **more)


def cone_tips(geometry: Geometry) -> Index:
    """Exact solid cones that reach their apex, as rows of the surfaces."""
    s = geometry.surfaces
    cones = np.flatnonzero((s.kind == CONE) & ~s.hollow & (s.doubt == 0))
    cones = cones[np.diff(s.triangle_start)[cones] > 0]
    if not len(cones):
        return cones
    bands = bands_of(geometry, cones)
    sharp: Index = cones[bands.low <= APEX * bands.high]
    return sharp


def tips_on_faces(geometry: Geometry, i: Index, j: Index, angle: Array) -> Candidates:
    """Candidate point contacts of the tips of cones with curved faces.

    Their `along` leads out of the tip. `angle`, shape (n,), is the largest angle at which the side
    of a cone lies on a face [rad].
    """
    s = geometry.surfaces
    tips = cone_tips(geometry)
    blocks = []
    for first, second, sense in ((i, j, -1.0), (j, i, 1.0)):
        row = np.flatnonzero(np.isin(first, tips) & (s.kind[second] != FREE))
        cone, face = Side(s, first[row]), second[row]
        gap, n = s.distance(face, cone.point), s.outward(face, cone.point)
        lean = np.arcsin(np.clip(dot(n, cone.axis), -1, 1)) - cone.half_angle
        middle = cone.point - (gap / 2)[:, None] * n
        rim = np.full(len(row), 1.0 if sense < 0 else 2.0)
        points = make_candidates(POINT, middle, sense * n, gap, along=-cone.axis, rim=rim)
        blocks.append(replace(points, row=row).take(lean > angle[row]))
    return Candidates.join(blocks)
