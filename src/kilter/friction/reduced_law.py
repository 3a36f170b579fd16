"""Coulomb's contact law in fewer unknowns, for proofs: joints eliminated, points grouped.

The law of `kilter.friction.law`, x = w + H^T g, in fewer unknowns; it is exact, without relaxation.
Joints are eliminated: x = |Z^T w| Z a, with the columns of Z an orthonormal basis of the motions
that all joints allow. Their forces do no work in any of these motions and drop out, without loss.
All forces are measured in a common unit, about the weight of all free parts, instead of each by the
mobility of its point:

    f = g |Z^T w|^-1 / (sigma (total mass)^(1/2)),    Jn, Jt = sigma (total mass)^(1/2) H Z

so that forces of several points can be added and a common bound holds for all. The law is then

    a = w + Jn^T fn + Jt^T ft,   |w| = 1                          dynamics
    un = Jn a >= 0,  fn >= 0,  un fn = 0                          at each point
    |ft| <= mu N,   ft.ut = -mu N |ut|,   ut = Jt a               in each group, N = sum of fn

    so   w.a = |a|^2 + sum of mu N |ut|   and   |a|^2 <= w.a <= 1.

Points that share ut form a *group*: in the plane all points of a straight patch, whose tangential
forces lie on a line, so that a single ft represents them; in space each point alone. Groups that
share a *twist* form a *patch*: t = ut of a single point or of a patch in the plane, t = (v,
length x omega about the normal) of a flat patch in space; ut = L t. A group, and a patch, takes its
points from a single contact patch.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array, diags_array, eye_array

from kilter.arrays import TINY, Array, Index
from kilter.friction.friction_tolerances import FLAT, JOINT_RANK, ZERO_ENTRY
from kilter.friction.law import CoulombLaw, coulomb_law
from kilter.mechanics.program import Program
from kilter.mechanics.rows import CONTACT, POSSIBLE, STICKING

__all__ = ["ReducedLaw", "reduced_law", "refusal"]


@dataclass(frozen=True, slots=True, eq=False)
class ReducedLaw:
    """Coulomb's law in fewer unknowns: joints eliminated, equally sliding points in groups."""

    law: CoulombLaw
    """The law with all rows."""
    allowed: csr_array
    """Z, shape (freedoms of the law, n)."""
    load: Array
    """w, of length 1 (or 0 without load), shape (n,)."""
    rows: Index
    """Row of the program for each point, shape (K,)."""
    normal: csr_array
    """Jn, shape (K, n)."""
    group: Index
    """Group of each point, shape (K,); -1 without friction."""
    mu: Array
    """Friction coefficients [-], shape (G,)."""
    tangent: csr_array
    """Jt, shape (G * T, n)."""
    patch: Index
    """Patch of each group, shape (G,)."""
    twist: tuple[csr_array, ...]
    """Rows of the twist t of each patch, shape (d, n)."""
    lever: Array
    """L: ut = L t of the patch of the group; columns from d on are 0, shape (G, T, 3)."""

    @property
    def directions(self) -> int:
        """Number of tangent directions T at a contact point: 1 in the plane, 2 in space."""
        return int(self.lever.shape[1])


def refusal(program: Program) -> str:
    """Reason why the reduced contact law does not apply to a program; empty if it applies."""
    if np.isin(program.kind, (POSSIBLE, STICKING)).any():
        return "contacts that are not modelled"
    contact = program.kind == CONTACT
    if (program.two_sided & contact).any() or (program.mu[contact] < 0).any():
        return "a contact that pulls"
    if program.planar and (np.abs(program.normal[contact & (program.mu > 0), 1]) > FLAT).any():
        return "friction on a face in the plane of the motion"
    free = program.free
    if not (program.mass[free] > 0).all() or not np.isfinite(program.load[free]).all():
        return "a part without mass"
    if free.any() and not (np.linalg.eigvalsh(program.inertia[free]) > 0).all():
        return "a part without inertia"
    return ""


def reduced_law(program: Program) -> ReducedLaw:
    """Build the reduced contact law of a program for which `refusal` is empty."""
    law = coulomb_law(program)
    allowed = _joint_motions(law)
    w = allowed.T @ law.load
    size = float(np.linalg.norm(w))
    contact = np.flatnonzero(program.kind == CONTACT)
    label = _flat_patches(program, contact)
    if program.planar:
        keep, group, patch, first = _groups_in_the_plane(program, contact, label)
    else:
        keep, group, patch, first = _groups_in_space(program, contact, label)
    rows, heads = contact[keep], contact[first]
    count = 1 if program.planar else 2
    across = law.basis[heads, 1 : 1 + count]
    lines = (3 * heads[:, None] + 1 + np.arange(count)).reshape(-1)
    unit = law.sigma * float(np.sqrt(program.mass[program.free].sum()))
    scaled = csr_array(diags_array(np.repeat(unit, 3)) @ law.matrix @ allowed)
    tangent = csr_array(scaled[lines])
    lever = _group_levers(program.point[heads], across, patch)
    return ReducedLaw(
        law=law,
        allowed=allowed,
        load=w / max(size, TINY),
        rows=rows,
        normal=csr_array(scaled[3 * rows]),
        group=group,
        mu=program.mu[heads],
        tangent=tangent,
        patch=patch,
        twist=_patch_twists(tangent, lever, patch),
        lever=lever,
    )


def _joint_motions(law: CoulombLaw) -> csr_array:
    """Orthonormal basis Z of the motions that all joints allow, as columns."""
    joint_rows = law.matrix[3 * np.flatnonzero(law.tied)].toarray()
    length = np.linalg.norm(joint_rows, axis=1)
    joint_rows = joint_rows[length > 0] / length[length > 0][:, None]
    if not len(joint_rows):
        return csr_array(eye_array(len(law.load)))
    _, values, vectors = np.linalg.svd(joint_rows)
    rank = int((values > JOINT_RANK * values.max(initial=0.0)).sum())
    return csr_array(vectors[rank:].T)


def _flat_patches(program: Program, rows: Index) -> Index:
    """For each contact row, the number of its flat patch; all its points slide alike.

    Each point of a patch that is not flat has its own number.
    """
    size = float(program.radius[program.free].max(initial=1.0))
    along = np.einsum("ki,ki->k", program.normal[rows], program.point[rows])
    ends = [program.part_a, program.part_b]
    exact = np.column_stack([program.kind, program.source, *ends, program.mu])[rows]
    _, label = np.unique(exact, axis=0, return_inverse=True)
    label = np.where(
        program.source[rows] < 0, label.max(initial=-1) + 1 + np.arange(len(rows)), label
    )
    for members in _indices_by_label(label):
        first = members[:1]
        angle_off = np.abs(program.normal[rows[members]] - program.normal[rows[first]]).max(axis=1)
        plane_off = np.abs(along[members] - along[first])
        curved = (angle_off > FLAT) | (plane_off > FLAT * size)
        if curved.any():
            label[members] = label.max() + 1 + np.arange(len(members))
    return np.unique(label, return_inverse=True)[1].reshape(-1).astype(np.int64)


def _groups_in_space(
    program: Program, contact: Index, label: Index
) -> tuple[Index, Index, Index, Index]:
    """For an assembly in space: its contact points, the group of each, and data of the groups.

    A group is a point with friction; -1 stands for a point without. The last two results are the
    patch and the point of each group.
    """
    rough = np.flatnonzero(program.mu[contact] > 0)
    group = np.full(len(contact), -1)
    group[rough] = np.arange(len(rough))
    patch = np.unique(label[rough], return_inverse=True)[1].reshape(-1)
    return np.arange(len(contact)), group, patch, rough


def _groups_in_the_plane(
    program: Program, contact: Index, label: Index
) -> tuple[Index, Index, Index, Index]:
    """For an assembly in the plane: kept points, their groups, and patch and first point of each.

    A group is a straight patch with friction; -1 stands for one without. Only the two ends of a
    patch are kept: forces at points between them are sums of forces at the ends, and if such a
    point touches under force, the whole patch touches.
    """
    normal, point = program.normal[contact], program.point[contact]
    along = normal[:, 2] * point[:, 0] - normal[:, 0] * point[:, 2]
    size = FLAT * float(program.radius.max(initial=1.0))
    kept: list[Index] = [np.empty(0, dtype=np.int64)]
    group: list[Index] = [np.empty(0, dtype=np.int64)]
    group_heads: list[int] = []
    for members in _indices_by_label(label):
        ends = np.sort(members[[along[members].argmin(), along[members].argmax()]])
        ends = ends[:1] if np.ptp(along[members]) <= size else ends
        rough = program.mu[contact[ends[0]]] > 0
        kept.append(ends)
        group.append(np.full(len(ends), len(group_heads) if rough else -1))
        group_heads += [int(ends[0])] if rough else []
    first = np.array(group_heads, dtype=np.int64)
    return np.concatenate(kept), np.concatenate(group), np.arange(len(first)), first


def _indices_by_label(label: Index) -> list[Index]:
    """Indices of the points that share a label, for each label in ascending order."""
    order = np.argsort(label, kind="stable")
    starts = np.unique(label[order], return_index=True)[1]
    return np.split(order, starts[1:]) if len(order) else []


def _group_levers(point: Array, across: Array, patch: Index) -> Array:
    """Lever matrix of each group, from the twist of its patch to the sliding speed."""
    count = across.shape[1]
    lever = np.zeros((len(point), count, 3))
    lever[:, range(count), range(count)] = 1.0
    for members in _indices_by_label(patch):
        if count == 1 or len(members) == 1:
            continue
        arm = point[members] - point[members].mean(axis=0)
        length = max(float(np.linalg.norm(arm, axis=1).max()), TINY)
        # ut(x) = v + omega n x r: n x r along the first point's (u, v) is (-r2, r1)
        basis = across[members[0]]
        plane = arm @ basis.T / length
        rotation = np.einsum("gij,kj->gik", across[members], basis)
        lever[members, :, :2] = rotation
        spin = np.stack([-plane[:, 1], plane[:, 0]], axis=1)
        lever[members, :, 2] = np.einsum("gik,gk->gi", rotation, spin)
    return lever


def _patch_twists(tangent: csr_array, lever: Array, patch: Index) -> tuple[csr_array, ...]:
    """Matrices from a motion to the relative twist of each patch, found from sliding speeds."""
    count = lever.shape[1]
    twists = []
    for members in _indices_by_label(patch):
        lines = csr_array(tangent[(members[:, None] * count + np.arange(count)).reshape(-1)])
        if count == 2 and len(members) > 1:
            twist = np.linalg.pinv(lever[members].reshape(-1, 3)) @ lines.toarray()
            lines = csr_array(np.where(np.abs(twist) < ZERO_ENTRY, 0.0, twist))
        twists.append(lines)
    return tuple(twists)
