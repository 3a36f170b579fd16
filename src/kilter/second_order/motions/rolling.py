"""Rolling without slip: does friction hold a balanced assembly, or does it roll and fall?

If no contact with friction slips, the velocities there are equal: G z = 0, with three rows for each
contact (two in the plane). Contacts without friction and joints have their own rows. The velocity
of a virtual motion y at a contact changes along a rolling z by

    g(z, y) = w_b x (x' - c_b') - w_a x (x' - c_a'),     x' = v_a(x) + s

with the angular velocities w of y, and for z the velocities c' of the centres of mass and s of the
contact point over both surfaces: s = -(A + B)^-1 n x (w_b - w_a) in the directions in which both
features extend. At joints, and contacts without friction, g is the second derivative of the gap.
With forces f of equilibrium, G^T f + w = 0, small motions Z u without slip obey

    Z^T M Z u'' = -K u,      K_ij = -sum of f_k . g_k(Z_j, Z_i)

K is symmetric if rolling is holonomic; then the energy curves by K. Only proved results are
reported, for forces that are strictly within the friction cones, so that no contact slips at first:

    holds   K is positive definite, if rolling is holonomic: all turns are about parallel axes, or
            of dimension 1 or 0; and f is unique
    falls   K has an eigenvalue for Z^T M Z that is negative or not real, so that a push grows
            exponentially; self-stress, up to which f is known, does not change K

A single body on two points has f up to a squeeze along their line, which does no work. Points of a
body slip alike along their line, so if an f is within the cones, no other f makes a point slip: a
slip straight across the line needs the friction across it, which is unique, at its limit, and any
other slip moves both points to the same side, each with all the friction that is left of the limit.

`guarantee` decides whether another motion starts from rest. An assembly that is stable without
friction, as `check` requires here, has no other start.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from kilter.arrays import TINY, Array, Index, cross, read_only
from kilter.assembly import Joint
from kilter.mechanics.clusters import Cluster
from kilter.mechanics.program import Program
from kilter.mechanics.rows import CONTACT, JOINT
from kilter.second_order.gaps.features import EDGE, FACE, Features
from kilter.second_order.gaps.gap_form import formed, gap_forms
from kilter.second_order.gaps.joint_forms import joint_forms
from kilter.second_order.gaps.joint_springs import sprung_rows
from kilter.second_order.motions.null_space import null_space
from kilter.second_order.parts.cluster_states import falling_alone
from kilter.second_order.second_order_tolerances import BALANCED, CURVED, SLIPS

__all__ = ["Rolling", "Rolls", "find_rolling", "rolling_of", "worst_rolling"]

Rolls = Literal["holds", "falls", "open"]
MOST = 600
"""Largest number of rows for which rolling is decided."""
ORDER: tuple[Rolls, ...] = ("falls", "open", "holds")
"""Results about rolling; an assembly has the first one that any of its clusters has."""


@dataclass(frozen=True, slots=True, eq=False)
class Rolling:
    """Result about rolling without slip (holds, falls or open), with its proof.

    Attributes
    ----------
    state : {"holds", "falls", "open"}
    dimension : int
        Dimension of the rollings.
    curvature : float
        Least E'' over weight and length, for rollings of length 1 [-]; 0 if there are none.
    why : str
        Reason for an open result.
    forces : ndarray, shape (K, 3)
        Forces on part b [N].
    motion : ndarray, shape (N, 6)
        Rolling with the least E'', of length 1; 0 if there is none.
    """

    state: Rolls
    dimension: int
    curvature: float
    why: str
    forces: Array
    motion: Array

    def __post_init__(self) -> None:
        read_only(self)


def worst_rolling(states: Iterable[Rolls]) -> Rolls:
    """Combine the results about rolling of several clusters to the result of the assembly."""
    return min(states, key=ORDER.index, default="open")


def rolling_of(
    cluster: Cluster,
    features: Features,
    alone: Iterable[str] | None = None,
    joints: Sequence[Joint] = (),
) -> Rolling:
    """Rolling of a cluster, or of the parts of it that fall alone while its other parts are held.

    Parameters
    ----------
    cluster : Cluster
        Cluster with friction.
    features : Features
        Features of all rows of the assembly.
    alone : iterable of str, optional
        Names of the parts that fall alone.
    joints : sequence of Joint
        Joints of the assembly.
    """
    mine = features.take(cluster.rows)
    part = None if alone is None else falling_alone(cluster.program, alone)
    if part is None:
        return find_rolling(cluster.program, mine, joints)
    found = find_rolling(part.program, mine.take(part.rows), joints)
    # the other parts may move, too, so that friction may fail there
    return replace(found, state="open") if found.state == "holds" else found


def find_rolling(program: Program, features: Features, joints: Sequence[Joint] = ()) -> Rolling:
    """Decide whether friction holds a balanced cluster against rolling without slip.

    Parameters
    ----------
    program : Program
        Contacts of the cluster, with friction, and joints.
    features : Features
        Features of its rows.
    joints : sequence of Joint
        Joints of the assembly.
    """
    why = _unmodelled_reason(program, features, joints)
    if why:
        return _open(program, why)
    return _RollingForces(program, features, joints).result()


class _RollingForces:
    """Rows of a cluster that rolls without slip, forces of equilibrium on them, and their work.

    The first rows are the slips at contacts with friction, three (two) for each; then follow the
    gaps of other contacts and of joints.
    """

    def __init__(self, program: Program, features: Features, joints: Sequence[Joint]) -> None:
        self.program, self.features = program, features
        self.rough = np.flatnonzero(program.mu > 0)
        self.other = np.flatnonzero(program.mu == 0)
        self.forms = np.nan_to_num(gap_forms(program, features))[self.other]
        self.forms += joint_forms(program, joints)[self.other]
        self.inverse = _rolls_over(program, features)[self.rough]
        self.scale = _scale(program)
        slips = _grip(program.taking(self.rough)) if len(self.rough) else None
        gaps = program.taking(self.other).jacobian().toarray() * program.arm[self.other, None]
        self.rows = (gaps if slips is None else np.vstack([slips, gaps])) * self.scale

    def result(self) -> Rolling:
        """Result about rolling from the forces and the stiffness."""
        program, rows = self.program, self.rows
        load = program.load[np.ix_(program.free, program.freedoms)].reshape(-1) * self.scale
        left, sizes, _ = np.linalg.svd(rows)
        rank = int((sizes > BALANCED * sizes.max(initial=TINY)).sum())
        components = np.linalg.lstsq(rows.T, -load, rcond=None)[0]
        if np.abs(rows.T @ components + load).max() > BALANCED * np.abs(load).max():
            return _open(program, "no forces balance it")
        if not self._presses(components):
            return _open(program, "its forces are not within the cones of friction")
        basis = null_space(rows, BALANCED) * self.scale[:, None]
        each = self._stiffness_of_each(basis)
        stiffness = np.tensordot(components, each, axes=1)
        stressed = np.tensordot(left[:, rank:].T, each, axes=1)
        size = np.abs(stiffness).max(initial=0.0) / max(np.abs(components).max(), TINY)
        same = np.abs(stressed).max(initial=0.0) <= SLIPS * size
        unique = rank == len(rows)
        return self._judged(basis, stiffness, self._forces(components), same=same, unique=unique)

    def _presses(self, components: Array) -> bool:
        """True if contacts press, those with friction strictly within their cones."""
        program, forces = self.program, self._forces(components)
        along = np.einsum("ki,ki->k", forces, program.normal)
        aside = np.linalg.norm(forces - along[:, None] * program.normal, axis=1)
        weight = float(program.weight[program.free].max())
        within = aside < (1 - SLIPS) * program.mu * along
        within[self.other] = True
        return bool(((along > SLIPS * weight) & within)[program.kind == CONTACT].all())

    def _forces(self, components: Array) -> Array:
        """Forces on part b at the rows of the program, shape (K, 3); 0 at torques of joints."""
        program = self.program
        forces = np.zeros((len(program.kind), 3))
        axes = _directions(program)
        split = len(self.rough) * len(axes)
        forces[self.rough] = components[:split].reshape(-1, len(axes)) @ axes
        forces[self.other] = components[split:, None] * program.normal[self.other]
        forces[program.angular] = 0.0
        return forces

    def _stiffness_of_each(self, basis: Array) -> Array:
        """Stiffness of small rolling motions under a unit force on each row, shape (C, d, d)."""
        program, dimension = self.program, basis.shape[1]
        motions = np.array([program.full(column) for column in basis.T])
        motions = motions.reshape(dimension, len(program.names), 6)
        rough = program.taking(self.rough)
        turned = np.zeros((dimension, dimension, len(self.rough), 3))
        for j, along in enumerate(motions):
            moved = _contact_shifts(rough, self.inverse, along)
            for i, virtual in enumerate(motions):
                turned[i, j] = _turning(rough, moved, virtual)
        axes = _directions(program)
        slips = (turned @ axes.T).reshape(dimension, dimension, len(self.rough) * len(axes))
        six = np.concatenate([motions, np.zeros((dimension, 1, 6))], axis=1)
        ends = [six[:, end[self.other]] for end in (program.part_a, program.part_b)]
        both = np.concatenate(ends, axis=2)
        bent = np.einsum("ika,kab,jkb->ijk", both, self.forms, both)
        return -np.moveaxis(np.concatenate([slips, bent], axis=2), 2, 0)

    def _judged(
        self, basis: Array, stiffness: Array, forces: Array, *, same: bool, unique: bool
    ) -> Rolling:
        """Result about rolling, from the stiffness of small rolling motions."""
        program, dimension = self.program, basis.shape[1]
        weight = float(program.weight[program.free].max())
        length = float(program.radius[program.free].max())
        curved = stiffness / (weight * length)
        values, axes = np.linalg.eigh((curved + curved.T) / 2)
        least = float(values[0]) if dimension else 0.0
        motion = program.full(basis @ axes[:, 0] if dimension else np.zeros(len(basis)))
        size = max(float(np.abs(curved).max(initial=0.0)), 1.0)
        symmetric = np.abs(curved - curved.T).max(initial=0.0) < CURVED * size
        holonomic = dimension <= 1 or _about_one_axis(program, basis)
        if dimension and same:
            falls = symmetric and least < -CURVED
            if falls or (not symmetric and _grows(program, basis, curved)):
                return Rolling("falls", dimension, least, "", forces, motion)
        # a squeeze of a single body on two points does no work
        sure = unique or (len(program.kind) == 2 and program.free.sum() == 1)
        if sure and holonomic and symmetric and (not dimension or least > CURVED):
            return Rolling("holds", dimension, least, "", forces, motion)
        why = "its rolling depends on the path, which is not modelled"
        if not sure:
            why = "its friction forces are not unique"
        elif holonomic:
            why = "it is too close to the boundary of two answers"
        return Rolling("open", dimension, least, why, forces, motion)


def _about_one_axis(program: Program, basis: Array) -> bool:
    """True if all motions turn about parallel axes only and shift across these axes."""
    if program.planar:
        return True
    motions = np.array([program.full(column) for column in basis.T])
    turns = (motions[..., 3:] * program.radius[:, None]).reshape(-1, 3)
    _, values, right = np.linalg.svd(turns)
    parallel = values[1:].max(initial=0.0) <= SLIPS * values[0]
    along = np.abs(motions[..., :3] @ right[0]).max()
    return bool(parallel and along <= SLIPS * values[0])


def _grows(program: Program, basis: Array, curved: Array) -> bool:
    """True if an eigenvalue of the stiffness for the masses is negative or not real."""
    free = np.flatnonzero(program.free)
    motions = np.array([program.full(column) for column in basis.T])[:, free]
    shifts, turns = motions[..., :3], motions[..., 3:]
    mass = np.einsum("n,inx,jnx->ij", program.mass[free], shifts, shifts)
    mass += np.einsum("inx,nxy,jny->ij", turns, program.inertia[free], turns)
    values = np.linalg.eigvals(np.linalg.solve(mass, curved))
    size = float(np.abs(values).max())
    return bool((values.real < -SLIPS * size).any() or (np.abs(values.imag) > SLIPS * size).any())


def _open(program: Program, why: str) -> Rolling:
    none = np.zeros((len(program.part_a), 3)), np.zeros((len(program.names), 6))
    return Rolling("open", 0, 0.0, why, *none)


def _unmodelled_reason(program: Program, features: Features, joints: Sequence[Joint]) -> str:
    """Reason why rolling of a cluster cannot be modelled; empty if it can."""
    contact = program.kind == CONTACT
    if program.pull.any() or program.tied.any():
        return "rolling is not modelled with bonds"
    if not (contact | (program.kind == JOINT)).all() or len(sprung_rows(program, joints)):
        return "rolling is not modelled with stops, friction and springs of joints"
    if not (program.mu > 0).any():
        return "no contact has friction"
    if 3 * len(program.kind) > MOST:
        return "its contacts are too many to decide whether it rolls"
    if np.abs(program.applied[program.free, 3:]).max(initial=0.0) > 0:
        return "rolling is not modelled with loads beside a centre of mass"
    if not formed(program, features)[contact].all() or features.conformal.any():
        return "the curvature of its surfaces at a contact is not known"
    return ""


def _scale(program: Program) -> Array:
    """Displacement for one unit of each unknown, shape (n,): 1 for shifts, 1 / radius for turns."""
    units = np.where(np.arange(6) < 3, 1.0, 1 / program.radius[program.free, None])
    return np.asarray(units[:, program.freedoms].reshape(-1))


def _directions(program: Program) -> Array:
    """Unit directions in which contact points must not slip, as rows: three, or two planar."""
    return np.eye(3)[[0, 2]] if program.planar else np.eye(3)


def _grip(program: Program) -> Array:
    """Matrix G from motions of the free parts to slips at all contacts."""
    columns = np.eye(len(program.columns))
    slips = [_slip(program, program.full(column)) for column in columns]
    return np.array([(slip @ _directions(program).T).reshape(-1) for slip in slips]).T


def _velocity(program: Program, motion: Array, part: Index) -> Array:
    """Velocities at the contact points of the material of the given parts, shape (K, 3).

    Points of the ground have the velocity 0.
    """
    padded = np.vstack([motion, np.zeros((1, 6))])[part]
    center = np.vstack([program.center, np.zeros((1, 3))])[part]
    return padded[:, :3] + cross(padded[:, 3:], program.point - center)


def _slip(program: Program, motion: Array) -> Array:
    """Velocity of part b relative to part a at each contact point, shape (K, 3)."""
    over = _velocity(program, motion, program.part_b)
    return over - _velocity(program, motion, program.part_a)


def _contact_shifts(program: Program, inverse: Array, motion: Array) -> tuple[Array, Array]:
    """Velocity of each contact point past the centres of parts a and b along a rolling, (K, 3)."""
    padded = np.vstack([motion, np.zeros((1, 6))])
    a, b = padded[program.part_a], padded[program.part_b]
    turn = cross(program.normal, b[:, 3:] - a[:, 3:])
    at = _velocity(program, motion, program.part_a) - np.einsum("kij,kj->ki", inverse, turn)
    return at - a[:, :3], at - b[:, :3]


def _turning(program: Program, shifts: tuple[Array, Array], motion: Array) -> Array:
    """Change of the slip of a motion at each contact by shifts of the contact point, (K, 3)."""
    padded = np.vstack([motion, np.zeros((1, 6))])[:, 3:]
    over_a, over_b = shifts
    return np.asarray(cross(padded[program.part_b], over_b) - cross(padded[program.part_a], over_a))


def _rolls_over(program: Program, features: Features) -> Array:
    """Inverse of the sum of both curvatures, within their common directions, (K, 3, 3)."""
    total = features.curvature_a + features.curvature_b
    inverse = np.zeros_like(total)
    for k in range(len(total)):
        axes = _common(program, features, k)
        if axes.size:
            inverse[k] = axes.T @ np.linalg.inv(axes @ total[k] @ axes.T) @ axes
    return inverse


def _common(program: Program, features: Features, k: int) -> Array:
    """Unit tangents along which both features of contact k extend, as rows."""
    away = [program.normal[k]]
    for kind, edge in (
        (features.kind_a[k], features.edge_a[k]),
        (features.kind_b[k], features.edge_b[k]),
    ):
        if kind == EDGE:
            away.append(np.cross(program.normal[k], edge))
        elif kind != FACE:
            return np.zeros((0, 3))
    if features.fibre[k].any():
        away.append(features.fibre[k])
    if program.planar:
        away.append(np.array([0.0, 1.0, 0.0]))
    return null_space(np.array(away), BALANCED).T
