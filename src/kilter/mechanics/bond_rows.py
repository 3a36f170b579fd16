"""Bonds in a program: a known clamp, and rows across.

A bond lets a contact point pull, f_n >= -T. With f' = f_n + T that is an ordinary contact row,
f' >= 0, beside a known pair of loads T that clamps the parts together. So every program, solver
and certificate stays what it is: a motion proves that it falls where gravity does more work than
the clamps absorb, sum T (opening). Friction on a bonded point is mu (f_n + T) = mu f'.

Shear of any size is two more rows across each point, whose forces have both signs. Shear up to
a force S is a force across the row itself, |f_t| <= S, as friction is, but beside a push of any
size: a motion that slips takes up S |u_t| there.
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
    """What bonds give to each contact point of a contact set, shape (K,).

    Attributes
    ----------
    bond : ndarray of int
        Its bond, by position in the assembly; -1 where there is none.
    pull : ndarray
        T [N].
    tied : ndarray of bool
        Shear of any size is borne.
    shear : ndarray
        Shear up to this force is borne [N]; NaN where there is no such limit.
    smooth : ndarray of bool
        Friction counts for nothing there: shear is borne otherwise.
    """

    bond: Index
    pull: Array
    tied: Mask
    shear: Array
    smooth: Mask


def bonded_points(contacts: ContactSet) -> BondedPoints:
    """The strength of the bonds at each contact point.

    Raises
    ------
    InputError
        If the parts of a bond without points do not touch, or a fit gave their normal.
    """
    bonds = contacts.assembly.bonds
    patch_bond = contacts.patch_bond
    if len(bonds):
        _require_touching(contacts, patch_bond)
    point_bond = patch_bond[contacts.point_patch]
    pull = np.zeros(len(point_bond))
    bonded = point_bond >= 0
    if bonded.any():
        pull[bonded] = _pulls(contacts, point_bond)[bonded]
    bears = [bond.bears for bond in bonds]
    tied = np.array([one is None for one in bears] + [False])[point_bond]
    rubs = np.array([one == "mu" for one in bears] + [True])[point_bond]
    limits = [one if isinstance(one, float) else np.nan for one in bears]
    shear = np.array([*limits, np.nan])[point_bond]
    return BondedPoints(point_bond, pull, tied, shear, ~rubs)


def _pulls(contacts: ContactSet, point_bond: Index) -> Array:
    """T of each point [N], shape (K,): of a bond by area, its strength times the corner's share."""
    bonds = contacts.assembly.bonds
    pull = np.array([bond.pull or 0.0 for bond in bonds] + [0.0])[point_bond]
    stress = np.array([bond.pull_per_area or 0.0 for bond in bonds] + [0.0])
    if not stress.any():
        return pull
    spread = pull + stress[point_bond] * _areas(contacts, stress[contacts.patch_bond] > 0)
    return np.asarray(spread)


def _areas(contacts: ContactSet, by_area: Mask) -> Array:
    """What of its patch's area each contact point stands for, shape (K,).

    Raises
    ------
    InputError
        If a patch that counts, `by_area`, shape (P,), is not flat, or not the convex hull of its
        points: their shares would have another middle than the area.
    """
    patch = contacts.point_patch
    shares = area_shares(contacts.points, patch, contacts.patch_normal)
    hull = np.bincount(patch, shares, minlength=len(contacts))
    notched = np.abs(hull - contacts.patch_area) > SAME_AREA * hull
    wrong = np.flatnonzero(by_area & (notched | (contacts.patch_kind != "plane")))
    if len(wrong):
        a, b = (contacts.assembly.names[k] for k in contacts.patch_parts[wrong[0]])
        raise InputError(
            f"the bond of {a!r} and {b!r} is by area, and where they touch is no flat convex area",
            file=contacts.assembly.source or None,
            hint="give pull, of each point",
        )
    return shares


def _require_touching(contacts: ContactSet, patch_bond: Index) -> None:
    """Refuse bonds that hold nothing."""
    held = np.zeros(len(contacts.assembly.bonds), dtype=bool)
    held[patch_bond[patch_bond >= 0]] = True
    for patch in np.flatnonzero((patch_bond >= 0) & (contacts.patch_doubt > 0)):
        a, b = (contacts.assembly.names[k] for k in contacts.patch_parts[patch])
        raise InputError(
            f"a bond holds {a!r} and {b!r} by a face whose normal is in doubt",
            file=contacts.assembly.source or None,
            hint="give the points and the normal of the bond",
        )
    if held.all():
        return
    bond = contacts.assembly.bonds[int(np.flatnonzero(~held)[0])]
    names = " and ".join(repr(name) for name in bond.parts)
    raise InputError(
        f"a bond holds {names}, which do not touch",
        file=contacts.assembly.source or None,
        hint="give the points and the normal of the bond, or leave it out",
    )


def clamp_of(
    geometry: Geometry, part_a: Index, part_b: Index, point: Array, normal: Array, pull: Array
) -> Array:
    """The loads with which bonds press parts together: force and torque, shape (N, 6).

    As the parts see them at rest at f' = 0: -T n on the second part, T n on the first.
    """
    total = np.zeros((len(geometry.mass), 6))
    for part, sign in ((part_b, -1.0), (part_a, 1.0)):
        k = np.flatnonzero((part >= 0) & (pull > 0))
        force = sign * pull[k, None] * normal[k]
        moment = cross(point[k] - geometry.center[part[k]], force)
        for axis, column in enumerate((*force.T, *moment.T)):
            total[:, axis] += np.bincount(part[k], column, minlength=len(total))
    return total
