"""The rows of a program: the forces there may be, one row a force, each with its label.

A row is (a, b, x, n): the force f n acts on part b at the point x, -f n on part a; the row of
J is the opening along n. What it is of, is its label: `kind`, and `source`, the number of the
patch, of the possible force or of the joint that it comes from. Rows are found by their labels,
never by their places.

    CONTACT     a contact point: pushes; `source` is its patch
    POSSIBLE    what a contact that is not modelled might bring; `source` is its number in
                `ContactSet.possible`, -1 for a point that is only thought
    JOINT       a force or (`angular`) a torque that a joint carries; `source` is the joint
    STICKING    a tangential force of any size at a contact point; `source` is its patch
    BONDED      the same at a point whose bond bears any shear; `source` is its patch
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from kilter.arrays import Array, Index, Mask, Rows, across, columns
from kilter.assembly import Assembly
from kilter.assembly.geometry import Geometry
from kilter.contact.contact_set import ContactSet, PossibleContacts
from kilter.mechanics.bond_rows import bonded_points
from kilter.mechanics.joints import joint_constraints

__all__ = [
    "BONDED",
    "CONTACT",
    "JOINT",
    "KINDS",
    "POSSIBLE",
    "STICKING",
    "ForceRows",
    "bonded_rows",
    "contact_rows",
    "joint_rows",
    "possible_rows",
    "pushing_rows",
    "sticking_rows",
]

CONTACT, POSSIBLE, JOINT, STICKING, BONDED = 0, 1, 2, 3, 4
"""Kinds of row."""
KINDS = ("contact", "possible", "joint", "sticking", "bonded")
"""Their names."""


@dataclass(frozen=True, slots=True, eq=False)
class ForceRows(Rows):
    """Rows, struct of arrays; world frame, length unit of the assembly.

    Attributes
    ----------
    part_a, part_b : ndarray of int, shape (K,)
        Parts of each row; -1 is the ground.
    point, normal : ndarray, shape (K, 3)
        Unit directions, from a to b.
    kind : ndarray of int, shape (K,)
    two_sided, angular : ndarray of bool, shape (K,)
        Rows whose force may have both signs; rows whose force is a torque.
    mu : ndarray, shape (K,)
        Friction coefficient of each contact row [-]; 0 for the other kinds.
    source : ndarray of int, shape (K,)
    doubt : ndarray, shape (K,)
        How far the normal of a contact row may be off that a fit gave [rad]; else 0.
    pull : ndarray, shape (K,)
        What the bond of a contact row may pull [N], else 0; its force counts from there:
        f_n + pull >= 0 (`kilter.mechanics.bond_rows`).
    tied : ndarray of bool, shape (K,)
        Contact rows whose bond bears any shear, by rows of the kind BONDED.
    shear : ndarray, shape (K,)
        What the bond of a contact row bears across it at most [N], in place of friction; NaN
        where there is no such limit.
    """

    part_a: Index
    part_b: Index
    point: Array = columns(3)
    normal: Array = columns(3)
    kind: Index = columns()
    two_sided: Mask = columns()
    angular: Mask = columns()
    mu: Array = columns()
    source: Index = columns()
    doubt: Array = columns()
    pull: Array = columns()
    tied: Mask = columns()
    shear: Array = columns()

    @property
    def certain(self) -> Mask:
        """Rows that hold whatever the normals are within their doubt, shape (K,).

        A contact whose normal is in doubt has such forces by friction only.
        """
        certain: Mask = (self.doubt == 0) | (self.mu > 0)
        return certain


def _of_kind(
    kind: int, a: Index, b: Index, point: Array, normal: Array, two_sided: Mask, source: Index
) -> ForceRows:
    """Rows of forces without friction."""
    count, none = len(a), np.zeros(len(a))
    return ForceRows(
        a, b, point, normal, np.full(count, kind), two_sided, none > 0, none, source, none, none,
        none > 0, np.full(count, np.nan),
    )  # fmt: skip


def contact_rows(contacts: ContactSet, geometry: Geometry) -> ForceRows:
    """A row a contact point, between parts of which one is free."""
    patch = contacts.point_patch
    a, b = contacts.patch_parts[patch].T
    live = np.flatnonzero(~(geometry.grounded[a] & geometry.grounded[b]))
    pushes = np.zeros(len(live), dtype=bool)
    rows = _of_kind(
        CONTACT, a[live], b[live], contacts.points[live], contacts.normals[live], pushes,
        patch[live],
    )  # fmt: skip
    own = patch[live]
    rows = replace(rows, mu=contacts.patch_mu[own], doubt=contacts.patch_doubt[own])
    if not contacts.assembly.bonds:
        return rows
    bonded = bonded_points(contacts)
    mu = np.where(bonded.smooth[live], 0.0, rows.mu)
    pull, tied, shear = bonded.pull[live], bonded.tied[live], bonded.shear[live]
    return replace(rows, mu=mu, pull=pull, tied=tied, shear=shear)


def bonded_rows(touching: ForceRows) -> ForceRows:
    """Forces across the contact rows whose bonds bear any shear: all along u, then along v."""
    tied = touching.take(np.flatnonzero(touching.tied))
    return _sticking(BONDED, tied.part_a, tied.part_b, tied.point, tied.normal, tied.source)


def pushing_rows(pushes: PossibleContacts, number: Index | int = -1) -> ForceRows:
    """Forces that contacts which are not modelled might bring, and their numbers."""
    source = np.broadcast_to(np.asarray(number, dtype=np.int64), len(pushes))
    return _of_kind(
        POSSIBLE, pushes.part_a, pushes.part_b, pushes.points, pushes.normals, pushes.two_sided,
        source,
    )  # fmt: skip


def possible_rows(possible: PossibleContacts, geometry: Geometry) -> ForceRows:
    """Every force that contacts which are not modelled might bring, with any friction."""
    sharp = np.flatnonzero((possible.mu > 0) & ~possible.two_sided)
    points = possible.take(sharp)
    return ForceRows.join(
        [
            pushing_rows(possible, np.arange(len(possible))),
            _sticking(POSSIBLE, points.part_a, points.part_b, points.points, points.normals, sharp),
            _any_force(possible, geometry),
        ]
    )


def sticking_rows(contacts: ContactSet, geometry: Geometry) -> ForceRows:
    """Tangential forces of any size at contact points with friction."""
    patch = contacts.point_patch
    a, b = contacts.patch_parts[patch].T
    rough = (contacts.patch_mu[patch] > 0) & ~(geometry.grounded[a] & geometry.grounded[b])
    rows = np.flatnonzero(rough)
    points, normals = contacts.points[rows], contacts.normals[rows]
    return _sticking(STICKING, a[rows], b[rows], points, normals, patch[rows])


def _sticking(
    kind: int, a: Index, b: Index, point: Array, normal: Array, source: Index
) -> ForceRows:
    twice = np.tile(np.arange(len(normal)), 2)
    both = np.concatenate(across(normal))
    ties = np.ones(len(twice), dtype=bool)
    return _of_kind(kind, a[twice], b[twice], point[twice], both, ties, source[twice])


def _any_force(possible: PossibleContacts, geometry: Geometry) -> ForceRows:
    """Any force and torque between parts that touch at a round surface with friction."""
    round_rows = np.flatnonzero((possible.mu > 0) & possible.two_sided)
    pairs = np.column_stack([possible.part_a, possible.part_b])[round_rows]
    _, first = np.unique(pairs, axis=0, return_index=True)
    a, b = pairs[first].T
    at, arm = possible.points[round_rows][first], geometry.radius[np.minimum(a, b)][:, None]
    x, y, z = np.eye(3)
    forces = ((0 * x, x), (0 * x, y), (0 * x, z), (x, y), (x, z), (y, z))
    points = np.concatenate([at + arm * shift for shift, _ in forces])
    directions = np.concatenate([np.tile(along, (len(at), 1)) for _, along in forces])
    ties, source = np.ones(6 * len(at), dtype=bool), np.tile(round_rows[first], 6)
    return _of_kind(POSSIBLE, np.tile(a, 6), np.tile(b, 6), points, directions, ties, source)


def joint_rows(assembly: Assembly, geometry: Geometry) -> ForceRows:
    """The rows of the joints that act on a free part."""
    blocks = []
    for number in range(len(assembly.joints)):
        (a, b), point, linear, angular = joint_constraints(assembly, number)
        if not any(k >= 0 and not geometry.grounded[k] for k in (a, b)):
            continue
        count = len(linear) + len(angular)
        rows = _of_kind(
            JOINT, np.full(count, a), np.full(count, b), np.tile(point, (count, 1)),
            np.concatenate([linear, angular]), np.ones(count, dtype=bool), np.full(count, number),
        )  # fmt: skip
        blocks.append(replace(rows, angular=np.arange(count) >= len(linear)))
    return ForceRows.join(blocks)
