"""Bonds as parts of a program: loads that press the parts together, and rows for shear forces.

A bond lets a contact point pull, f_n >= -T. With f' = f_n + T this is an ordinary contact row,
f' >= 0, together with a known pair of forces T that clamps the parts together. So every program,
solver and certificate applies unchanged: a motion proves a fall if gravity does more work than the
clamps absorb, sum T (opening). Friction on a bonded point is mu (f_n + T) = mu f'.

A bond that carries shear of any size adds two rows across each point, with forces of both signs. A
bond with a shear limit S allows a force across the row itself, |f_t| <= S, like friction but
independent of the normal force: a slipping motion dissipates S |u_t| there.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, Mask, cross
from kilter.assembly.geometry import Geometry
from kilter.contact.contact_set import ContactSet
from kilter.errors import InputError
from kilter.mechanics.area_shares import area_shares
from kilter.mechanics.mechanics_tolerances import SAME_AREA

__all__ = ["BondedPoints", "bonded_points", "clamp_of"]


@dataclass(frozen=True, slots=True, eq=False)
class BondedPoints:
    """Strength of the glue, mortar or other bond at each contact point, in arrays of shape (K,)."""

    bond: Index
    """Position of the point's bond in the assembly; -1 for a point without a bond."""
    pull: Array
    """Largest tension T [N]."""
    tied: Mask
    """True if the bond carries shear of any size."""
    shear: Array
    """Largest shear force [N]; NaN for a bond without such a limit."""
    smooth: Mask
    """True if friction is ignored because the bond itself limits the shear."""


def bonded_points(contacts: ContactSet) -> BondedPoints:
    """Tension and shear strength of the bond at each contact point; no tension without a bond.

    Raises `InputError` if the parts of a bond without points do not touch, or their contact normal
    is fitted.
    """
    bonds = contacts.assembly.bonds
    patch_bond = contacts.patch_bond
    if len(bonds):
        _require_contact(contacts, patch_bond)
    point_bond = patch_bond[contacts.point_patch]
    pull = np.zeros(len(point_bond))
    bonded = point_bond >= 0
    if bonded.any():
        pull[bonded] = _tension_limits(contacts, point_bond)[bonded]
    bears = [bond.bears for bond in bonds]
    tied = np.array([bearing is None for bearing in bears] + [False])[point_bond]
    rubs = np.array([bearing == "mu" for bearing in bears] + [True])[point_bond]
    limits = [bearing if isinstance(bearing, float) else np.nan for bearing in bears]
    shear = np.array([*limits, np.nan])[point_bond]
    return BondedPoints(point_bond, pull, tied, shear, ~rubs)


def _tension_limits(contacts: ContactSet, point_bond: Index) -> Array:
    """Largest tension that the bond of each contact point bears [N], shape (K,).

    A strength per area is multiplied by the area that the point represents.
    """
    bonds = contacts.assembly.bonds
    pull = np.array([bond.pull or 0.0 for bond in bonds] + [0.0])[point_bond]
    stress = np.array([bond.pull_per_area or 0.0 for bond in bonds] + [0.0])
    if not stress.any():
        return pull
    spread = pull + stress[point_bond] * _corner_areas(contacts, stress[contacts.patch_bond] > 0)
    return np.asarray(spread)


def _corner_areas(contacts: ContactSet, by_area: Mask) -> Array:
    """Patch area that each contact point represents [length unit^2], shape (K,).

    Raises `InputError` if a patch in `by_area`, shape (P,), is not flat or not the convex hull of
    its points: the centroid of the shares would then differ from that of the area.
    """
    patch = contacts.point_patch
    shares = area_shares(contacts.points, patch, contacts.patch_normal)
    hull = np.bincount(patch, shares, minlength=len(contacts))
    notched = np.abs(hull - contacts.patch_area) > SAME_AREA * hull
    wrong = np.flatnonzero(by_area & (notched | (contacts.patch_kind != "plane")))
    if len(wrong):
        a, b = (contacts.assembly.names[k] for k in contacts.patch_parts[wrong[0]])
        raise InputError(
            f"the bond of {a!r} and {b!r} has a strength per area, but they do not touch in a "
            "flat convex area",
            file=contacts.assembly.source or None,
            hint="give pull, the strength of each contact point",
        )
    return shares


def _require_contact(contacts: ContactSet, patch_bond: Index) -> None:
    """Raise `InputError` if bonded parts do not touch, or touch at a face of uncertain normal."""
    has_contact = np.zeros(len(contacts.assembly.bonds), dtype=bool)
    has_contact[patch_bond[patch_bond >= 0]] = True
    for patch in np.flatnonzero((patch_bond >= 0) & (contacts.patch_doubt > 0)):
        a, b = (contacts.assembly.names[k] for k in contacts.patch_parts[patch])
        raise InputError(
            f"the bond of {a!r} and {b!r} is at a face whose normal is uncertain",
            file=contacts.assembly.source or None,
            hint="give the points and the normal of the bond",
        )
    if has_contact.all():
        return
    bond = contacts.assembly.bonds[int(np.flatnonzero(~has_contact)[0])]
    names = " and ".join(repr(name) for name in bond.parts)
    raise InputError(
        f"a bond joins {names}, which do not touch",
        file=contacts.assembly.source or None,
        hint="give the points and the normal of the bond, or leave it out",
    )


def clamp_of(
    geometry: Geometry, part_a: Index, part_b: Index, point: Array, normal: Array, pull: Array
) -> Array:
    """Wrenches on all parts, shape (N, 6), by bonds that pull with `pull` [N] at their points.

    A bond in the state f' = 0 pulls with T: the force is -T n on the second part and T n on the
    first.
    """
    total = np.zeros((len(geometry.mass), 6))
    for part, sign in ((part_b, -1.0), (part_a, 1.0)):
        k = np.flatnonzero((part >= 0) & (pull > 0))
        force = sign * pull[k, None] * normal[k]
        moment = cross(point[k] - geometry.center[part[k]], force)
        for axis, column in enumerate((*force.T, *moment.T)):
            total[:, axis] += np.bincount(part[k], column, minlength=len(total))
    return total
