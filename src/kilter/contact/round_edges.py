"""Round edges of flat contacts, which the corners of their patches replace by inscribed polygons.

An assembly tips over the circle, and not over the polygon: a tilt limit of the corners is too small
by up to 1 - cos(pi / n) of the distance to the edge, for n corners. On an arc between two corners
each point of the circle

    x(phi) = c + r (cos(phi) u + sin(phi) v)

is a point of the contact if both faces reach as far: the face that ends at the circle by its exact
surface, the other by its triangles or by a circle of its own.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Mask, across
from kilter.assembly import Assembly
from kilter.assembly.geometry import Geometry
from kilter.contact.contact_set import ContactSet
from kilter.contact.contact_tolerances import RIM_LEVEL, SAME_CORNER
from kilter.contact.curved.rims import radius_at
from kilter.shape.covering import covered

WIDEST = np.pi / 4
"""Largest angle of an arc between two neighbouring corners [rad]; a wider gap is a cut."""


@dataclass(frozen=True, slots=True, eq=False)
class RoundEdge:
    """Arcs of a circle to which a flat contact extends beyond its corners; world frame."""

    patch: int
    """Patch of the contact."""
    center: Array
    u: Array
    v: Array
    """Centre of the circle, and unit directions in its plane, shape (3,)."""
    radius: float
    """[length unit]"""
    begin: Array
    extent: Array
    """First angle of each arc from u toward v, in [-pi, pi], and its angle [rad], shape (m,)."""

    def angle(self, point: Array) -> float:
        """Angle of a point about the centre [rad]."""
        arm = point - self.center
        return float(np.arctan2(arm @ self.v, arm @ self.u))

    def contains(self, angle: Array) -> Mask:
        """Mask of the angles that lie on an arc, of any shape."""
        along = (np.asarray(angle)[..., None] - self.begin) % (2 * np.pi)
        inside = along <= self.extent
        return np.asarray(inside.any(axis=-1))

    def points(self, angle: Array) -> Array:
        """Points of the circle at some angles, shape (n, 3)."""
        around = np.outer(np.cos(angle), self.u) + np.outer(np.sin(angle), self.v)
        points: Array = self.center + self.radius * around
        return points


def round_edges(assembly: Assembly, contacts: ContactSet) -> tuple[RoundEdge, ...]:
    """The round edges of all flat contacts, as far as the contact surely extends to them.

    Examples
    --------
    >>> from kilter import Box, Cylinder, Part, contacts
    >>> table = Part("table", Box(4, 4, 1), [0, 0, -0.5], grounded=True)
    >>> stood = Assembly([table, Part("tower", Cylinder(1, 4), [0, 0, 2])])
    >>> [edge] = round_edges(stood, contacts(stood))
    >>> round(edge.radius, 12), round(float(edge.extent.sum() / np.pi), 12)
    (1.0, 2.0)
    """
    g = assembly.geometry
    found = []
    for patch in np.flatnonzero(contacts.patch_kind == "plane"):
        rows = slice(contacts.patch_start[patch], contacts.patch_start[patch + 1])
        corners, normal = contacts.points[rows], contacts.patch_normal[patch]
        parts = [int(part) for part in contacts.patch_parts[patch]]
        for part, other in (parts, parts[::-1]):
            for surface in range(int(g.surfaces.start[part]), int(g.surfaces.start[part + 1])):
                edge = _edge(g, int(patch), (surface, part, other), corners, normal)
                if edge is not None:
                    found.append(edge)
    return tuple(found)


def _edge(
    g: Geometry, patch: int, at: tuple[int, int, int], corners: Array, normal: Array
) -> RoundEdge | None:
    """Arcs of the circle in which a surface of a part ends in the plane of a patch, or None.

    `at`: the surface, its part, and the other part.
    """
    s, (surface, part, other) = g.surfaces, at
    axis = s.axis[surface]
    if s.hollow[surface] or s.doubt[surface] or abs(float(axis @ normal)) < 1 - RIM_LEVEL**2:
        return None
    height = float((corners[0] - s.point[surface]) @ axis)
    radius = radius_at(s, surface, height)
    if radius is None:
        return None
    u, v = across(normal)
    whole = RoundEdge(
        patch, s.point[surface] + height * axis, u, v, radius, np.zeros(1), np.zeros(1)
    )
    arm = corners - whole.center
    near = np.abs(np.linalg.norm(arm, axis=1) - radius) <= SAME_CORNER * radius
    angle = np.sort(np.arctan2(arm[near] @ v, arm[near] @ u))
    if len(angle) < 2:
        return None
    extent = np.diff(angle, append=angle[0] + 2 * np.pi)
    middle, ends = whole.points(angle + extent / 2), whole.points(angle)
    size = max(float(g.size[part]), float(g.size[other]))
    on = (extent <= WIDEST) & _is_chord(g, surface, ends, radius)
    on &= _covers(g, other, middle, normal, size) | _same_circle(g, other, whole, ends, normal)
    if not on.any():
        return None
    return RoundEdge(patch, whole.center, u, v, radius, angle[on], extent[on])


def _is_chord(g: Geometry, surface: int, points: Array, radius: float) -> Mask:
    """Mask of points of a circle that are on one triangle of a surface with the next point."""
    triangles = g.vertices[g.triangles[g.surfaces.triangles_of(surface)]].reshape(-1, 1, 3)
    away = np.linalg.norm(triangles - points, axis=2).reshape(-1, 3, len(points)).min(axis=1)
    close = away <= SAME_CORNER * radius
    on: Mask = (close & np.roll(close, -1, axis=1)).any(axis=0)
    return on


def _covers(g: Geometry, part: int, points: Array, normal: Array, size: float) -> Mask:
    """Mask of points that lie on a flat face of a part in their plane."""
    triangles = g.corners_of(part)
    reach = SAME_CORNER * size
    level = np.abs((triangles - points[0]) @ normal).max(axis=1) <= np.sqrt(SAME_CORNER) * size
    return covered(triangles[level], points, np.tile(normal, (len(points), 1)), reach, reach)


def _same_circle(g: Geometry, part: int, edge: RoundEdge, ends: Array, normal: Array) -> Mask:
    """Mask of arcs, from their first ends, at which a part ends in the same circle."""
    s = g.surfaces
    on, close = np.zeros(len(ends), dtype=bool), SAME_CORNER * edge.radius
    for surface in range(int(s.start[part]), int(s.start[part + 1])):
        axis = s.axis[surface]
        if s.hollow[surface] or s.doubt[surface] or abs(float(axis @ normal)) < 1 - RIM_LEVEL**2:
            continue
        height = float((edge.center - s.point[surface]) @ axis)
        radius = radius_at(s, surface, height)
        apart = float(np.linalg.norm(s.point[surface] + height * axis - edge.center))
        if radius is not None and max(abs(radius - edge.radius), apart) <= close:
            on |= _is_chord(g, surface, ends, edge.radius)
    return on


def has_round_edges(
    assembly: Assembly, contacts: ContactSet, known: Sequence[RoundEdge] = ()
) -> bool:
    """Whether a flat contact ends at a round edge other than the known edges.

    Examples
    --------
    >>> from kilter import Box, Cylinder, Part, contacts
    >>> table = Part("table", Box(4, 4, 1), [0, 0, -0.5], grounded=True)
    >>> for shape in (Box(1, 1, 4), Cylinder(1, 4)):
    ...     stood = Assembly([table, Part("tower", shape, [0, 0, 2])])
    ...     touching = contacts(stood)
    ...     edges = round_edges(stood, touching)
    ...     print(has_round_edges(stood, touching), has_round_edges(stood, touching, edges))
    False False
    True False
    """
    g = assembly.geometry
    curved = g.triangle_surface >= 0
    flat = contacts.patch_kind[contacts.point_patch] == "plane"
    if not (curved.any() and flat.any()):
        return False
    from scipy.spatial import cKDTree  # slow to import

    corners = cKDTree(g.vertices[np.unique(g.triangles[curved])])
    rows = np.flatnonzero(flat)
    away, _ = corners.query(contacts.points[rows])
    on = rows[away <= SAME_CORNER * g.size.max()]
    return not all(_is_inside(contacts, int(row), known) for row in on)


def _is_inside(contacts: ContactSet, row: int, edges: Sequence[RoundEdge]) -> bool:
    """Whether a contact point lies on an edge that continues on both sides of it."""
    point, patch = contacts.points[row], contacts.point_patch[row]
    for edge in edges:
        off = abs(float(np.linalg.norm(point - edge.center)) - edge.radius)
        beside = edge.angle(point) + RIM_LEVEL * np.array([-1.0, 1.0])
        if edge.patch == patch and off <= RIM_LEVEL * edge.radius and edge.contains(beside).all():
            return True
    return False
