"""Proposal of another upward axis for a file that states none and falls on every assumption.

Joints never make an equilibrium impossible. So an assembly that holds on a rung below "joined"
also holds on "joined", where no search is needed: its bodies touch nothing but the floor. Such an
assembly holds if and only if the centre of mass of each body lies above its support polygon.

The contacts of a body with the floor under another side are detected for the parts that reach that
side only. A body that rests on the border of its polygon, or in a way that the contacts do not
model, leaves a direction undecided; then nothing is proposed.
"""

from __future__ import annotations

import numpy as np
import shapely

from kilter.analysis.assumptions.joined_bodies import body_groups
from kilter.arrays import Array, Index, across
from kilter.assembly import Assembly
from kilter.contact import ContactSet, detect
from kilter.rigid import UP

USUAL = ("y", "x", "-z", "-y", "-x")
"""Upward axes other than z, the most usual first."""
DRAWN = "z"
"""Upward axis of a file that states none."""
SURELY = 1e-6
"""Distance of a centre of mass from the border of a support polygon, above which the side of the
border is certain [sizes of the assembly]."""


def better_up(assembly: Assembly, contacts: ContactSet) -> str | None:
    """The axis with which the assembly holds although it holds on no rung with z up; else None.

    Arguments: `contacts`: those of the assembly. Nothing is proposed if the file or an option
    states the direction of gravity, if a part is held, or if loads or straps act.
    """
    held = any(part.grounded and not part.table for part in assembly.parts)
    fixed = any(set(joint.parts) - {*assembly.names} for joint in assembly.joints)
    if not assembly.up_assumed or held or fixed or assembly.loads or assembly.straps:
        return None
    groups = body_groups(assembly, contacts)
    if _holds(assembly, contacts, groups, DRAWN) is not False:
        return None
    return next((up for up in USUAL if _holds(assembly, contacts, groups, up)), None)


def _holds(assembly: Assembly, contacts: ContactSet, groups: list[Index], axis: str) -> bool | None:
    """Whether the joined assembly holds on a floor under its lowest point; None if undecided.

    Arguments: `groups`: parts of each body; `axis`: the upward axis.
    """
    geometry, up = assembly.geometry, np.array(UP[axis])
    plane = np.stack(across(up), axis=1)
    border = SURELY * float(np.ptp(geometry.vertices, axis=0).max())
    height = np.minimum.reduceat(geometry.vertices @ up, geometry.vertex_start[:-1])
    reach = contacts.searched.gap_of(geometry.size) + 2 * geometry.accuracy + geometry.slack
    parts = np.concatenate(groups)
    low = height <= height[parts].min() + reach
    feet = np.intersect1d(parts, np.flatnonzero(low))
    center = {
        int(group[0]): geometry.mass[group] @ geometry.center[group] / geometry.mass[group].sum()
        for group in groups
    }
    for group in groups:  # no contact of a foot lies beyond its corners
        owner = np.isin(geometry.vertex_part, group[low[group]])
        spare = border + float(geometry.slack[group].max())
        if _is_inside((geometry.vertices[owner] - center[group[0]]) @ plane, spare) is False:
            return False
    standing = Assembly([assembly.parts[k] for k in feet.tolist()], units=assembly.units)
    standing = standing.with_down(-up).with_floor()
    found = detect.contacts(standing, tolerance=contacts.searched)
    floor = len(feet)
    if any(floor in pair.ends for pair in (*found.unsupported, *found.overlaps)):
        return None
    on_floor = (found.patch_parts == floor).any(axis=1)
    foot = feet[np.where(on_floor, found.patch_parts.min(axis=1), 0)]
    every = True
    for group in groups:
        chosen = (on_floor & np.isin(foot, group))[found.point_patch]
        inside = _is_inside((found.points[chosen] - center[group[0]]) @ plane, border)
        if inside is False:
            return False
        every &= inside is True
    return True if every else None


def _is_inside(feet: Array, border: float) -> bool | None:
    """Whether the origin is inside the convex hull of points, shape (n, 2); None near its border.

    False without points.
    """
    if not len(feet):
        return False
    hull, origin = shapely.convex_hull(shapely.multipoints(feet)), shapely.points(0.0, 0.0)
    if shapely.distance(hull, origin) > border:
        return False
    within = hull.geom_type == "Polygon" and shapely.distance(hull.boundary, origin) > border
    return True if within else None
