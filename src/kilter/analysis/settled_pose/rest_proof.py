"""Verification of a pose at rest: gaps and normals from the geometry, and forces at closed points.

A pose is at rest if no two parts overlap deeper than a tolerance, and if forces in Coulomb's cones
balance every part at closed points alone. A point with a normal n from part a to b is closed if

- the sum of its distances from the surfaces of a and b is at most the tolerance, and
- n lies in the cone of the outward normals of the faces of a at the point, and -n in that of b,
  each within the angle by which touching faces may be tilted, and between both within rounding, the
  warp of flat faces, and the turn of the normal of a curved surface over the tolerance.

The overlaps are those of kilter's detection of contacts with this tolerance. The search supplies
only the points; the same functions verify a proof file.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from kilter.analysis.settled_pose.near_points import NearPoints, surface_gaps
from kilter.analysis.settled_pose.rigid_bodies import rigid_bodies
from kilter.analysis.settled_pose.settle_tolerances import BETWEEN_FACES, CLOSED, NORMAL
from kilter.arrays import TINY, Array, Index, Mask, cross, lengths, ragged, starts
from kilter.assembly import Assembly, GivenContact, Part
from kilter.assembly.geometry import Geometry
from kilter.assembly.surfaces import TORUS
from kilter.contact import ContactSet, Tolerance, detect
from kilter.contact.common.facets import Facets, find_facets, warps
from kilter.contact.contact_tolerances import ROUNDINGS
from kilter.contact.friction_coefficients import friction_coefficients
from kilter.errors import some_names
from kilter.files.robots.one_body import compose
from kilter.mechanics.mechanics_tolerances import AGREES
from kilter.mechanics.nonnegative import nonnegative
from kilter.mechanics.proof_form import NUMBER
from kilter.rigid import Pose
from kilter.shape.primitives import Mesh, Shape, surface

WARPS = 2.0
"""Least gap that counts as closed, in multiples of the warp of a face: both faces of a contact may
be warped [-]."""
BATCH = 1_000_000
"""Pairs of a point and a facet that are compared at once; a larger value needs more memory."""
FIT = 1e-9
"""Slack of the sides of a facet for a point on it, over the reach of the facet [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class ClosedContacts:
    """The contacts of a pose at points that are closed."""

    assembly: Assembly
    """The assembly in this pose, with the closed points as its only contacts."""
    contacts: ContactSet
    """These contacts."""
    widest_gap: float
    """Widest gap of a closed point [length unit]."""
    deepest_overlap: float
    """Deepest overlap of two parts [length unit]; 0 without overlaps."""
    fault: str
    """Reason why the pose is not at rest whatever the forces, as a clause; empty if none is
    known."""
    overlapping: tuple[int, ...] = ()
    """The two parts of the fault; empty without a fault."""


def closed_gap(assembly: Assembly, aside: Mask | None = None) -> float:
    """Gap at which a point counts as closed [length unit].

    It is a fraction of the median size of the parts, and at least the rounding of coordinates and
    the warp of flat faces, whose corners lie off their common plane. `aside` (N,): held parts that
    do not count.
    """
    geometry = assembly.geometry
    counts = np.ones(len(assembly), dtype=bool) if aside is None else ~aside
    facets = find_facets(geometry)
    warp = warps(geometry, facets)[counts[facets.part]]
    free = ~geometry.grounded
    size = float(np.median(geometry.size[free] if free.any() else geometry.size))
    return max(
        CLOSED * size,
        ROUNDINGS * float(geometry.accuracy[counts].max()),
        WARPS * float(warp.max(initial=0.0)),
    )


def closed_contacts(
    assembly: Assembly,
    points: NearPoints,
    *,
    detected: ContactSet | None = None,
    progress: Callable[[str], None] | None = None,
) -> ClosedContacts:
    """Keep the points of a pose that are closed, and find its deepest overlap.

    Arguments: `detected`: contacts of `strict_contacts`; None: they are detected.
    """
    gap = closed_gap(assembly)
    parts = np.column_stack([points.part_a, points.part_b])
    apart, sound = closed_points(assembly, parts, points.point, points.normal, gap)
    closed = (apart <= gap) & sound
    points, parts = points.take(closed), parts[closed]
    if detected is None:
        detected = strict_contacts(assembly, gap, progress)
    deepest, fault, ends = deepest_overlap(detected, gap)
    listed = _with_contacts(assembly, parts, points)
    widest = float(apart[closed].max(initial=0.0))
    contacts = detect.without_neighbours(listed, listed.tolerance or Tolerance())
    return ClosedContacts(listed, contacts, widest, deepest, fault, ends)


def strict_contacts(
    assembly: Assembly, gap: float, progress: Callable[[str], None] | None = None
) -> ContactSet:
    """Detect the contacts of a pose; overlaps deeper than `gap` [length unit] are listed."""
    usual = assembly.tolerance or Tolerance()
    tolerance = replace(usual, gap=gap, clearance=None)
    return detect.without_neighbours(assembly, tolerance, progress or (lambda stage: None))


def deepest_overlap(contacts: ContactSet, gap: float) -> tuple[float, str, tuple[int, ...]]:
    """Deepest overlap of two parts [length unit]; if it exceeds `gap`, a clause and both parts.

    Parts of a rigid body may overlap, as a screw in its thread does.
    """
    names, units = contacts.assembly.names, contacts.assembly.units
    body = rigid_bodies(contacts.assembly, ()).of_part
    apart = body[contacts.patch_parts[:, 0]] != body[contacts.patch_parts[:, 1]]
    lowest = np.where(apart, contacts.patch_gap[:, 0], 0.0)
    penetration = max(0.0, -float(lowest.min(initial=0.0)))
    overlaps = [o for o in contacts.overlaps if body[o.ends[0]] != body[o.ends[1]]]
    if overlaps:
        worst = max(overlaps, key=lambda overlap: overlap.depth)
        both = some_names([names[k] for k in worst.ends])
        clause = f"{both} overlap by {worst.depth:.3g} {units}"
        return max(worst.depth, penetration), clause, tuple(worst.ends)
    if penetration > 2 * gap:
        ends = tuple(contacts.patch_parts[int(lowest.argmin())].tolist())
        both = some_names([names[k] for k in ends])
        return penetration, f"{both} penetrate each other by {penetration:.3g} {units}", ends
    return penetration, "", ()


def closed_points(
    assembly: Assembly, parts: Index, points: Array, normals: Array, gap: float
) -> tuple[Array, Mask]:
    """Gap of each point, and whether its normal fits the faces of both parts there.

    A compound is measured on its members (`Mesh.members`): they are exact, its triangles are not.
    A point on a member within another member is an overlap, which the detection lists.

    Arguments: `parts` (n, 2): parts a and b; `points`, `normals` (n, 3): points [length unit] and
    unit normals from a to b; `gap`: largest distance of a point from a face on which it lies
    [length unit]. Returns `apart` (n,): sum of the distances from the surfaces of both parts
    [length unit]; `sound` (n,).
    """
    geometry, start = _member_geometry(assembly, parts, points, gap)
    facets = find_facets(geometry)
    apart = np.zeros(len(points))
    owners, outward, turns = [], [], np.full(len(points), BETWEEN_FACES)
    for part in parts.T:
        point, member = ragged(start, part)
        apart += _nearest_gaps(geometry, point, member, points, gap)
        row, rays, turn = _normals_at(geometry, facets, member, points[point], gap)
        owners.append(point[row])
        outward.append(rays)
        np.maximum.at(turns, point[row], BETWEEN_FACES + turn)
    (own, other), (rays_a, rays_b) = owners, outward
    sound = _in_cones(own, rays_a, normals, NORMAL) & _in_cones(other, rays_b, -normals, NORMAL)
    both, rays = np.concatenate([own, other]), np.concatenate([rays_a, -rays_b])
    rows = np.flatnonzero(sound)
    kept = sound[both]
    number = np.cumsum(sound) - 1
    sound[rows] = _in_cones(number[both[kept]], rays[kept], normals[rows], turns[rows])
    return apart, sound


def _nearest_gaps(
    geometry: Geometry, row: Index, member: Index, points: Array, gap: float
) -> Array:
    """Distance of each point from the nearest of its members [length unit], shape (n,).

    Members whose boxes are farther than `gap` from a point count only if no other one is so near.

    Arguments: `row`, `member` (m,): rows of `points` (n, 3), and a part of the geometry for each.
    """
    first = geometry.vertex_start[:-1]
    room = (gap + geometry.slack)[:, None]
    low = np.minimum.reduceat(geometry.vertices, first) - room
    high = np.maximum.reduceat(geometry.vertices, first) + room
    nearest = np.full(len(points), np.inf)
    beside = ((points[row] >= low[member]) & (points[row] <= high[member])).all(axis=1)
    for chosen in (beside, ~beside):
        k = np.flatnonzero(chosen & (nearest[row] > gap))
        np.minimum.at(nearest, row[k], surface_gaps(geometry, member[k, None], points[row[k]]))
    return nearest


def _member_geometry(
    assembly: Assembly, parts: Index, points: Array, gap: float
) -> tuple[Geometry, Index]:
    """Geometry in which the members of compounds near the points are parts of their own.

    Arguments as of `closed_points`. Returns also the first member of each part, shape (N + 1,).
    """
    if not any(isinstance(part.shape, Mesh) and part.shape.members for part in assembly.parts):
        return assembly.geometry, np.arange(len(assembly) + 1)
    placed, count = [], []
    for k, part in enumerate(assembly.parts):
        found = [(part.shape, part.pose)]
        if isinstance(part.shape, Mesh) and part.shape.members:
            near = part.pose.inverse().apply(points[(parts == k).any(axis=1)])
            members = list(part.shape.members)
            found = [each for each in members if _comes_near(*each, near, gap)] or members[:1]
            found = [(shape, compose(part.pose, pose)) for shape, pose in found]
        placed += [Part(f"{k} {j}", *each, mass=1.0) for j, each in enumerate(found)]
        count.append(len(found))
    return Assembly(placed).geometry, starts(np.array(count))


def _comes_near(shape: Shape, pose: Pose, points: Array, gap: float) -> bool:
    """Whether the sphere around the corners of a shape contains one of the points."""
    corners = surface(shape)[0]
    middle = (corners.min(axis=0) + corners.max(axis=0)) / 2
    radius = (1 + FIT) * float(lengths(corners - middle).max()) + gap
    return bool((lengths(points - pose.apply([middle])) <= radius).any())


def _normals_at(
    geometry: Geometry, facets: Facets, part: Index, points: Array, gap: float
) -> tuple[Index, Array, Array]:
    """Outward normals of the faces of a part for each point that lies on them within `gap`.

    Returns the row of the point, shape (m,), the normal, shape (m, 3), and its uncertainty [rad],
    shape (m,): the tilt of a warped face, or the turn of the normal of a curved surface over `gap`.
    """
    rows, normals, turns = [np.empty(0, dtype=np.int64)], [np.empty((0, 3))], [np.empty(0)]
    # warp over half the mean width of a face
    tilt = 4 * warps(geometry, facets) * facets.reach / np.maximum(facets.area, TINY)
    width = int(np.diff(facets.start)[part].max(initial=1))
    for batch in np.array_split(np.arange(len(points)), 1 + len(points) * width // BATCH):
        owner, row = ragged(facets.start, part[batch])
        point = batch[owner]
        off = points[point] - facets.origin[row]
        near = np.abs(np.einsum("fi,fi->f", off, facets.normal[row])) <= gap
        # the exact rim of a flat face beside a curved one lies beyond the corners of its polygon
        beside = gap + geometry.slack[facets.part[row]]
        near &= (lengths(off) <= facets.reach[row] + beside) & ~facets.curved[row]
        point, row, beside = point[near], row[near], beside[near]
        on = _are_on_facets(geometry, facets, row, points[point], beside)
        rows.append(point[on])
        normals.append(facets.normal[row[on]])
        turns.append(tilt[row[on]])
    surfaces = geometry.surfaces
    point, surface = ragged(surfaces.start, part)
    on = np.abs(surfaces.distance(surface, points[point])) <= gap
    point, surface = point[on], surface[on]
    rows.append(point)
    normals.append(surfaces.outward(surface, points[point]))
    away = surfaces.polar(surface, points[point])[1]
    tube = np.where(surfaces.kind == TORUS, surfaces.tube, np.inf)[surface]
    turns.append(gap / np.maximum(np.minimum(away, tube), gap))
    return np.concatenate(rows), np.concatenate(normals), np.concatenate(turns)


def _are_on_facets(
    geometry: Geometry, facets: Facets, row: Index, points: Array, beside: Array
) -> Mask:
    """Mask of points near the planes of facets that lie in them, or at most `beside` beside."""
    if not len(row):
        return np.zeros(0, dtype=bool)
    owner, begin = ragged(facets.corner_start, row)
    first = facets.corner_start[row][owner]
    loop = np.where(facets.convex[row], np.diff(facets.corner_start)[row], 3)[owner]
    place = (begin - first) % loop
    end = begin + np.where(place + 1 < loop, 1, 1 - loop)
    corner, after = (geometry.vertices[facets.corners[k]] for k in (begin, end))
    inward = cross(facets.normal[row][owner], after - corner)
    inward /= np.maximum(lengths(inward), 1e-300)[:, None]
    depth = np.einsum("ci,ci->c", points[owner] - corner, inward)
    starts_loop = np.flatnonzero(place == 0)
    of_loop = np.minimum.reduceat(depth, starts_loop)
    deepest = np.full(len(row), -np.inf)
    np.maximum.at(deepest, owner[starts_loop], of_loop)
    on: Mask = deepest >= -beside - FIT * facets.reach[row]
    return on


def _in_cones(owner: Index, rays: Array, directions: Array, angle: Array | float) -> Mask:
    """Mask of unit directions that lie in the cones of their unit rays, within an angle [rad].

    Arguments: `owner` (m,), `rays` (m, 3): the direction of each ray, and the ray; `angle`: for all
    directions (n,), or for each.
    """
    angle = np.broadcast_to(angle, len(directions))
    apart = np.full(len(directions), np.inf)
    np.minimum.at(apart, owner, lengths(rays - directions[owner]))
    inside: Mask = apart <= angle
    order = np.argsort(owner, kind="stable")
    start = np.searchsorted(owner[order], np.arange(len(directions) + 1))
    for k in np.flatnonzero(~inside & np.isfinite(apart)).tolist():
        of_point = rays[order[start[k] : start[k + 1]]]
        inside[k] = nonnegative(of_point, directions[k])[1] <= angle[k]
    return inside


def _with_contacts(assembly: Assembly, parts: Index, points: NearPoints) -> Assembly:
    """The assembly with points as its only contacts."""
    names = assembly.names
    given = [
        GivenContact((names[a], names[b]), [points.point[k]], points.normal[k], mu=points.mu[k])
        for k, (a, b) in enumerate(parts.tolist())
    ]
    return replace(assembly, contacts=given, detect=False)


# Recheck of a proof of rest without a solver: gaps and normals of its points from the geometry.


def is_proof_of_rest(proof: Mapping[str, Any]) -> bool:
    """Whether a proof states that a pose is at rest on closed points."""
    rest = proof.get("rest")
    return isinstance(rest, Mapping) and not NUMBER(rest.get("gap"), "rest.gap")


def at_closed_points(assembly: Assembly, proof: Mapping[str, Any]) -> Assembly:
    """The assembly with the points of the proof as its only contacts."""
    given = [
        GivenContact(tuple(point["parts"]), [point["x"]], point["normal"], mu=point["mu"])
        for point in proof["points"]
    ]
    return replace(assembly, contacts=given, detect=False)


def open_point_objections(assembly: Assembly, proof: Mapping[str, Any]) -> list[str]:
    """Reasons why the points of a proof are not closed in this pose; empty if all are."""
    gap, most = float(proof["rest"]["gap"]), closed_gap(assembly)
    if "forces" not in proof:
        return ["a motion does not prove that a pose is at rest"]
    if not gap <= (1 + AGREES) * most:
        return [f"its gap is {gap:.3g} {assembly.units}; a point is closed up to {most:.3g}"]
    entries = proof["points"]
    names = [entry["parts"] for entry in entries]
    parts = np.array([[assembly.index_of(name) for name in pair] for pair in names], dtype=np.int64)
    points = np.array([entry["x"] for entry in entries], dtype=np.float64).reshape(-1, 3)
    normals = np.array([entry["normal"] for entry in entries], dtype=np.float64).reshape(-1, 3)
    apart, sound = closed_points(assembly, parts.reshape(-1, 2), points, normals, gap)
    objections = []
    if (apart > gap).any():
        k = int(apart.argmax())
        objections.append(
            f"a point of {some_names(names[k])} is {apart[k]:.3g} {assembly.units} from their "
            f"surfaces, more than {gap:.3g}"
        )
    if not sound.all():
        k = int(np.argmin(sound))
        objections.append(f"the normal at a point of {some_names(names[k])} fits no face there")
    mu = np.array([entry["mu"] for entry in entries], dtype=np.float64)
    rougher = mu > friction_coefficients(assembly, parts.reshape(-1, 2)) + AGREES
    if rougher.any():
        k = int(rougher.argmax())
        objections.append(f"a point of {some_names(names[k])} has more friction than its pair")
    _, fault, _ = deepest_overlap(strict_contacts(assembly, gap), gap)
    return objections + ([fault] if fault else [])
