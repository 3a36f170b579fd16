"""Rows of a program: each possible force between two parts, with its label.

A row is (a, b, x, n): the force f n acts on part b at the point x, and -f n on part a; the row of J
is the opening along n. Its label is its `kind` and its `source`, the number of the patch, possible
force or joint that it comes from. Code finds rows by their labels, never by their positions.

    CONTACT     a contact point, which pushes; `source` is its patch
    POSSIBLE    a force that a contact outside the model could transmit; `source` is its number in
                `ContactSet.possible`, -1 for an assumed point
    JOINT       a force or (`angular`) a torque that a joint carries; `source` is the joint
    STICKING    a tangential force of any size at a contact point; `source` is its patch
    BONDED      the same at a point whose bond carries any shear; `source` is its patch
    STRAP       the pull of a strap up to its capacity; `source` is the strap
    STOP        the push of a joint at a limit, along its free motion; `source` is the joint
    DRAG        the friction of a joint, of either sign up to its capacity; `source` is the joint
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from kilter.arrays import Array, Index, Mask, Rows, across, columns, cross
from kilter.assembly import GROUND, Assembly
from kilter.assembly.geometry import Geometry
from kilter.contact.common.gaps import Tolerance, reached_limits
from kilter.contact.common.patches import PossibleContacts
from kilter.contact.contact_set import ContactSet
from kilter.errors import InputError
from kilter.mechanics.area_shares import area_shares
from kilter.mechanics.joints import joint_constraints
from kilter.mechanics.mechanics_tolerances import SAME_AREA
from kilter.rigid import unit

# Bonds as parts of a program: loads that press the parts together, and rows for shear forces.


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


CONTACT, POSSIBLE, JOINT, STICKING, BONDED, STRAP, STOP, DRAG = range(8)
"""Kinds of rows."""
OF_JOINTS = (JOINT, STOP, DRAG)
"""Kinds of rows whose source is a joint."""


@dataclass(frozen=True, slots=True, eq=False)
class RowArrays:
    """Arrays of possible forces between parts, a row each; world frame, assembly's length unit."""

    part_a: Index
    part_b: Index
    """Parts of each row, shape (K,); -1 is the ground."""
    point: Array = columns(3)
    """Points of application, shape (K, 3)."""
    normal: Array = columns(3)
    """Unit directions from part a to part b, shape (K, 3)."""
    kind: Index = columns()
    """CONTACT, POSSIBLE, JOINT, STICKING, BONDED, STRAP, STOP or DRAG, shape (K,)."""
    two_sided: Mask = columns()
    """True for forces of both signs, shape (K,)."""
    angular: Mask = columns()
    """True for torques, shape (K,)."""
    mu: Array = columns()
    """Friction coefficient of each contact row [-], shape (K,); 0 for the other kinds."""
    source: Index = columns()
    """Number of the patch, possible force, joint or strap, shape (K,)."""
    doubt: Array = columns()
    """Uncertainty of a fitted contact normal [rad], shape (K,); else 0."""
    pull: Array = columns()
    """Largest tension of the bond of a contact row [N], else 0, shape (K,). The force of the row
    counts from there: f_n + pull >= 0 (`kilter.mechanics.rows`)."""
    tied: Mask = columns()
    """Contact rows whose bond carries any shear, by rows of the kind BONDED, shape (K,)."""
    shear: Array = columns()
    """Largest shear force of the bond of a contact row [N], instead of friction, shape (K,); NaN
    without such a limit."""
    capacity: Array = columns()
    """Largest size of the force of a strap or of the friction of a joint [N] or [N x length
    unit], shape (K,); infinite for the other kinds."""


@dataclass(frozen=True, slots=True, eq=False)
class ForceRows(RowArrays, Rows):
    """Possible forces between parts, without the parts."""

    @property
    def certain(self) -> Mask:
        """Mask of the rows that can push whatever the true normal is within its uncertainty, (K,).

        A contact whose normal is uncertain has such forces only by friction.
        """
        certain: Mask = (self.doubt == 0) | (self.mu > 0)
        return certain


def _frictionless_rows(
    kind: int, a: Index, b: Index, point: Array, normal: Array, two_sided: Mask, source: Index
) -> ForceRows:
    """Build rows of a given kind, without friction and bonds."""
    count, zeros = len(a), np.zeros(len(a))
    return ForceRows(
        a, b, point, normal, np.full(count, kind), two_sided, zeros > 0, zeros, source, zeros,
        zeros, zeros > 0, np.full(count, np.nan), np.full(count, np.inf),
    )  # fmt: skip


def contact_rows(contacts: ContactSet, geometry: Geometry) -> ForceRows:
    """Rows of all contact points that touch a free part, with their friction and bonds."""
    patch = contacts.point_patch
    a, b = contacts.patch_parts[patch].T
    live = np.flatnonzero(~(geometry.grounded[a] & geometry.grounded[b]))
    two_sided = np.zeros(len(live), dtype=bool)
    rows = _frictionless_rows(
        CONTACT, a[live], b[live], contacts.points[live], contacts.normals[live], two_sided,
        patch[live],
    )  # fmt: skip
    row_patch = patch[live]
    rows = replace(rows, mu=contacts.patch_mu[row_patch], doubt=contacts.patch_doubt[row_patch])
    if not contacts.assembly.bonds:
        return rows
    bonded = bonded_points(contacts)
    mu = np.where(bonded.smooth[live], 0.0, rows.mu)
    pull, tied, shear = bonded.pull[live], bonded.tied[live], bonded.shear[live]
    return replace(rows, mu=mu, pull=pull, tied=tied, shear=shear)


def bonded_rows(contacts: ForceRows) -> ForceRows:
    """Rows for tangential forces at bonds of unlimited shear: all along u, then along v."""
    tied = contacts.take(np.flatnonzero(contacts.tied))
    return _tangential_rows(BONDED, tied.part_a, tied.part_b, tied.point, tied.normal, tied.source)


def pushing_rows(pushes: PossibleContacts, number: Index | int = -1) -> ForceRows:
    """Rows for pushes that unmodelled contacts could exert, with the given numbers as source."""
    source = np.broadcast_to(np.asarray(number, dtype=np.int64), len(pushes))
    return _frictionless_rows(
        POSSIBLE, pushes.part_a, pushes.part_b, pushes.points, pushes.normals, pushes.two_sided,
        source,
    )  # fmt: skip


def possible_rows(possible: PossibleContacts, geometry: Geometry) -> ForceRows:
    """Rows for all forces that unmodelled contacts could exert, with unlimited friction."""
    sharp = np.flatnonzero((possible.mu > 0) & ~possible.two_sided)
    points = possible.take(sharp)
    return ForceRows.join(
        [
            pushing_rows(possible, np.arange(len(possible))),
            _tangential_rows(
                POSSIBLE, points.part_a, points.part_b, points.points, points.normals, sharp
            ),
            _wrench_rows(possible, geometry),
        ]
    )


def sticking_rows(contacts: ContactSet, geometry: Geometry) -> ForceRows:
    """Rows for tangential forces of unlimited size at the contact points with friction."""
    patch = contacts.point_patch
    a, b = contacts.patch_parts[patch].T
    rough = (contacts.patch_mu[patch] > 0) & ~(geometry.grounded[a] & geometry.grounded[b])
    rows = np.flatnonzero(rough)
    points, normals = contacts.points[rows], contacts.normals[rows]
    return _tangential_rows(STICKING, a[rows], b[rows], points, normals, patch[rows])


def _tangential_rows(
    kind: int, a: Index, b: Index, point: Array, normal: Array, source: Index
) -> ForceRows:
    """Two-sided rows along both tangents at each point: all along u, then all along v."""
    twice = np.tile(np.arange(len(normal)), 2)
    tangents = np.concatenate(across(normal))
    two_sided = np.ones(len(twice), dtype=bool)
    return _frictionless_rows(
        kind, a[twice], b[twice], point[twice], tangents, two_sided, source[twice]
    )


def _wrench_rows(possible: PossibleContacts, geometry: Geometry) -> ForceRows:
    """Rows for any force and torque between parts that touch at round surfaces with friction.

    Six forces at shifted points are equivalent to every wrench.
    """
    round_rows = np.flatnonzero((possible.mu > 0) & possible.two_sided)
    pairs = np.column_stack([possible.part_a, possible.part_b])[round_rows]
    _, first = np.unique(pairs, axis=0, return_index=True)
    a, b = pairs[first].T
    point, arm = possible.points[round_rows][first], geometry.radius[np.minimum(a, b)][:, None]
    x, y, z = np.eye(3)
    forces = ((0 * x, x), (0 * x, y), (0 * x, z), (x, y), (x, z), (y, z))
    points = np.concatenate([point + arm * shift for shift, _ in forces])
    directions = np.concatenate([np.tile(along, (len(point), 1)) for _, along in forces])
    two_sided, source = np.ones(6 * len(point), dtype=bool), np.tile(round_rows[first], 6)
    return _frictionless_rows(
        POSSIBLE, np.tile(a, 6), np.tile(b, 6), points, directions, two_sided, source
    )


def joint_rows(assembly: Assembly, geometry: Geometry, tolerance: Tolerance) -> ForceRows:
    """Rows of the joints that constrain a free part, with their stops and their friction."""
    blocks = []
    for number in range(len(assembly.joints)):
        (a, b), point, linear, angular = joint_constraints(assembly, number)
        if not any(k >= 0 and not geometry.grounded[k] for k in (a, b)):
            continue
        blocks.append(fixing_rows((a, b), point, linear, angular, number))
        blocks.append(_guide_rows(assembly, number, (a, b), point, tolerance))
    return ForceRows.join(blocks)


def fixing_rows(
    ends: tuple[int, int], point: Array, linear: Array, angular: Array, number: int = -1
) -> ForceRows:
    """Rows of the forces (m, 3) at a point and of the torques (n, 3) that fix two parts."""
    count = len(linear) + len(angular)
    rows = _frictionless_rows(
        JOINT, np.full(count, ends[0]), np.full(count, ends[1]), np.tile(point, (count, 1)),
        np.concatenate([linear, angular]), np.ones(count, dtype=bool), np.full(count, number),
    )  # fmt: skip
    return replace(rows, angular=np.arange(count) >= len(linear))


def _guide_rows(
    assembly: Assembly, number: int, ends: tuple[int, int], point: Array, tolerance: Tolerance
) -> ForceRows:
    """Rows along the free motion of a joint: its stops, then its friction."""
    joint = assembly.joints[number]
    reached = reached_limits(assembly, joint, tolerance)
    # the opening of a row is that of the second part past the first: the position falls with it
    senses = [sense for sense, there in zip((-1.0, 1.0), reached, strict=True) if there]
    kinds = [STOP] * len(senses) + [DRAG] * (joint.friction > 0)
    count = len(kinds)
    if not count:
        return ForceRows.join([])
    along = np.array([*senses, -1.0][:count])[:, None] * joint.axis
    rows = _frictionless_rows(
        STOP, np.full(count, ends[0]), np.full(count, ends[1]), np.tile(point, (count, 1)), along,
        np.array(kinds) == DRAG, np.full(count, number),
    )  # fmt: skip
    return replace(
        rows,
        kind=np.array(kinds),
        angular=np.full(count, joint.kind == "revolute"),
        capacity=np.where(rows.two_sided, joint.friction, np.inf),
    )


def strap_rows(assembly: Assembly, geometry: Geometry) -> ForceRows:
    """Rows of the straps with a capacity: one for each straight piece that pulls on a free part.

    The force on part b is along its normal, towards part a: the pull of the strap. The opening of
    the row is therefore the rate at which the piece shortens. All pieces of a strap have the same
    pull (`Program.bounded_straps`).
    """
    blocks = []
    for number, strap in enumerate(assembly.straps):
        for piece in strap.pulling if strap.capacity is not None else []:
            names = strap.parts[piece : piece + 2]
            ends = [-1 if name == GROUND else assembly.index_of(name) for name in names]
            if not any(k >= 0 and not geometry.grounded[k] for k in ends):
                continue
            first, last = strap.points[piece], strap.points[piece + 1]
            rows = _frictionless_rows(
                STRAP, np.array(ends[:1]), np.array(ends[1:]), last[None],
                unit(first - last)[None], np.zeros(1, dtype=bool), np.array([number]),
            )  # fmt: skip
            blocks.append(replace(rows, capacity=np.array([strap.capacity])))
    return ForceRows.join(blocks)
