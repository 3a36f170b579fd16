"""Verification of a pose at rest: gaps and normals from the geometry, and forces at closed points.

A pose is at rest if no two parts overlap deeper than a tolerance, and if forces in Coulomb's cones
balance every part at closed points alone. A point with a normal n from part a to b is closed if

- the sum of its distances from the surfaces of a and b is at most the tolerance, and
- n lies in the cone of the outward normals of the faces of a at the point, and -n in that of b,
  each within the angle by which touching faces may be tilted, and between both within rounding.

The overlaps are those of kilter's detection of contacts with this tolerance. The search supplies
only the points; the same functions verify a proof file.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from kilter.analysis.settled_pose.near_points import NearPoints, surface_gaps
from kilter.analysis.settled_pose.settle_tolerances import BETWEEN_FACES, CLOSED, NORMAL
from kilter.arrays import Array, Index, Mask
from kilter.assembly import Assembly, GivenContact
from kilter.assembly.geometry import Geometry
from kilter.contact import ContactSet, Tolerance, detect
from kilter.contact.common.facets import Facets, find_facets
from kilter.contact.contact_tolerances import ROUNDINGS
from kilter.contact.friction_coefficients import friction_coefficients
from kilter.errors import some_names
from kilter.mechanics.mechanics_tolerances import AGREES
from kilter.mechanics.nonnegative import nonnegative
from kilter.mechanics.proof_form import NUMBER

WARPS = 2.0
"""Least gap that counts as closed, in multiples of the warp of a face: both faces of a contact may
be warped [-]."""
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


def closed_gap(assembly: Assembly) -> float:
    """Gap at which a point counts as closed [length unit].

    It is a fraction of the median size of the parts, and at least the rounding of coordinates and
    the warp of flat faces, whose corners lie off their common plane.
    """
    geometry = assembly.geometry
    facets = find_facets(geometry)
    owner = np.repeat(np.arange(len(facets)), np.diff(facets.corner_start))
    offset = geometry.vertices[facets.corners] - facets.origin[owner]
    warp = np.abs(np.einsum("ij,ij->i", offset, facets.normal[owner]))[~facets.curved[owner]]
    free = ~geometry.grounded
    size = float(np.median(geometry.size[free] if free.any() else geometry.size))
    return max(
        CLOSED * size,
        ROUNDINGS * float(geometry.accuracy.max()),
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
    apart, sound = closed_points(assembly.geometry, parts, points.point, points.normal, gap)
    closed = (apart <= gap) & sound
    points, parts = points.take(closed), parts[closed]
    if detected is None:
        detected = strict_contacts(assembly, gap, progress)
    deepest, fault, ends = deepest_overlap(detected, gap)
    listed = _with_contacts(assembly, parts, points)
    widest = float(apart[closed].max(initial=0.0))
    return ClosedContacts(listed, detect.contacts(listed), widest, deepest, fault, ends)


def strict_contacts(
    assembly: Assembly, gap: float, progress: Callable[[str], None] | None = None
) -> ContactSet:
    """Detect the contacts of a pose; overlaps deeper than `gap` [length unit] are listed."""
    usual = assembly.tolerance or Tolerance()
    tolerance = replace(usual, gap=gap, clearance=None)
    return detect.contacts(assembly, tolerance=tolerance, progress=progress)


def deepest_overlap(contacts: ContactSet, gap: float) -> tuple[float, str, tuple[int, ...]]:
    """Deepest overlap of two parts [length unit]; if it exceeds `gap`, a clause and both parts."""
    names, units = contacts.assembly.names, contacts.assembly.units
    lowest = contacts.patch_gap[:, 0]
    penetration = max(0.0, -float(lowest.min(initial=0.0)))
    if contacts.overlaps:
        worst = max(contacts.overlaps, key=lambda overlap: overlap.depth)
        both = some_names([names[k] for k in worst.ends])
        clause = f"{both} overlap by {worst.depth:.3g} {units}"
        return max(worst.depth, penetration), clause, tuple(worst.ends)
    if penetration > 2 * gap:
        ends = tuple(contacts.patch_parts[int(lowest.argmin())].tolist())
        both = some_names([names[k] for k in ends])
        return penetration, f"{both} penetrate each other by {penetration:.3g} {units}", ends
    return penetration, "", ()


def closed_points(
    geometry: Geometry, parts: Index, points: Array, normals: Array, gap: float
) -> tuple[Array, Mask]:
    """Gap of each point, and whether its normal fits the faces of both parts there.

    Arguments: `parts` (n, 2): parts a and b; `points`, `normals` (n, 3): points [length unit] and
    unit normals from a to b; `gap`: largest distance of a point from a face on which it lies
    [length unit]. Returns `apart` (n,): sum of the distances from the surfaces of both parts
    [length unit]; `sound` (n,).
    """
    facets = find_facets(geometry)
    sound = np.ones(len(points), dtype=bool)
    for k in range(len(points)):
        of_a, of_b = (_normals_at(geometry, facets, p, points[k], gap) for p in parts[k].tolist())
        sound[k] = _in_cone(of_a, normals[k], NORMAL) and _in_cone(of_b, -normals[k], NORMAL)
        sound[k] &= _in_cone(np.concatenate([of_a, -of_b]), normals[k], BETWEEN_FACES)
    return surface_gaps(geometry, parts, points), sound


def _normals_at(geometry: Geometry, facets: Facets, part: int, point: Array, gap: float) -> Array:
    """Outward normals of the faces of a part on which a point lies within `gap`, shape (m, 3)."""
    rows = np.arange(facets.start[part], facets.start[part + 1])
    height = np.einsum("fi,fi->f", point - facets.origin[rows], facets.normal[rows])
    away = np.linalg.norm(point - facets.origin[rows], axis=1)
    near = (np.abs(height) <= gap) & (away <= facets.reach[rows] + gap) & ~facets.curved[rows]
    surface = np.arange(*geometry.surfaces.start[part : part + 2])
    # a flat face that a curved one bounds is an inscribed polygon: its edge is off by the sagitta
    slack = gap + float(geometry.surfaces.sagitta[surface].max(initial=0.0))
    on = [row for row in rows[near].tolist() if _on_facet(geometry, facets, row, point, slack)]
    if not len(surface):
        return facets.normal[on]
    each = np.tile(point, (len(surface), 1))
    surface = surface[np.abs(geometry.surfaces.distance(surface, each)) <= gap]
    outward = geometry.surfaces.outward(surface, np.tile(point, (len(surface), 1)))
    return np.concatenate([facets.normal[on], outward])


def _on_facet(geometry: Geometry, facets: Facets, row: int, point: Array, gap: float) -> bool:
    """Whether a point near the plane of a facet lies within the facet, or within `gap` beside.

    The distance from the surface is verified separately (`surface_gaps`).
    """
    rows = facets.corners[facets.corner_start[row] : facets.corner_start[row + 1]]
    corners = geometry.vertices[rows]
    loops = corners[None] if facets.convex[row] else corners.reshape(-1, 3, 3)
    along = np.roll(loops, -1, axis=1) - loops
    inward = np.cross(facets.normal[row], along)
    inward /= np.maximum(np.linalg.norm(inward, axis=2), 1e-300)[..., None]
    depth = np.einsum("lci,lci->lc", point - loops, inward).min(axis=1)
    return bool(depth.max() >= -gap - FIT * facets.reach[row])


def _in_cone(rays: Array, direction: Array, angle: float) -> bool:
    """Whether a unit direction lies in the cone of unit rays, within an angle [rad]."""
    if not len(rays):
        return False
    if float(np.linalg.norm(rays - direction, axis=1).min()) <= angle:
        return True
    return nonnegative(rays, direction)[1] <= angle


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
    apart, sound = closed_points(assembly.geometry, parts.reshape(-1, 2), points, normals, gap)
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
