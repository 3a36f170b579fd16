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
            of dimension 1 or 0; and no force of equilibrium lets a contact slip
    falls   K has an eigenvalue for Z^T M Z that is negative or not real, so that a push grows
            exponentially; self-stress, up to which f is known, does not change K

Parts that do not move relative to each other along Z need no curvature where they touch. Loads off
the centres of mass add their curvature to K (`load_forms`). Contacts without friction of bodies
that enclose each other (`fits`) are two-sided, as joints are.

No contact slips if the self-stress of all rows leaves the normal force of every single contact, and
the resultant of the normal forces of every face on which parts stick, as it is. Let f* be forces of
equilibrium with which a motion z slips, and f those of an equilibrium without friction. By the
first, friction takes power from z: w.z = sum of mu f*_n |slip| >= 0. By the second, w.z = -(sum of
f_n times opening) <= 0. So z opens no contact with f_n > 0, and slips only where f*_n = 0. A single
contact has f*_n = f_n > 0. A face that slips has at most one point without slip, where f*_n cannot
act alone, because its resultant is strictly within the face. Thus z slips nowhere. For example, a
body on two points has f up to a squeeze along their line, and a box on a plank on a roller has f up
to the distribution over its corners.

If friction is needed to hold the parts, `guarantee` decides whether another motion can start.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from kilter.arrays import TINY, Array, Index, Mask, cross, read_only
from kilter.assembly import Assembly
from kilter.mechanics.clusters import Cluster
from kilter.mechanics.program import Program
from kilter.mechanics.rows import CONTACT, JOINT
from kilter.second_order.gaps.features import EDGE, FACE, Features
from kilter.second_order.gaps.fits import find_fits
from kilter.second_order.gaps.gap_form import formed, gap_forms
from kilter.second_order.gaps.joint_forms import joint_forms, sprung_rows, swings_of
from kilter.second_order.motions.bending import spread_wrench
from kilter.second_order.motions.null_space import null_space
from kilter.second_order.parts.cluster_states import falling_alone
from kilter.second_order.second_order_tolerances import BALANCED, CURVED, SLIPS

# Velocities of contact points past each other, and how they change along a rolling motion.


def slip_axes(program: Program) -> Array:
    """Unit directions in which contact points must not slip, as rows: three, or two planar."""
    return np.eye(3)[[0, 2]] if program.planar else np.eye(3)


def slip_rows(program: Program) -> Array:
    """Matrix G from motions of the free parts to slips at all contacts."""
    columns = np.eye(len(program.columns))
    slips = [contact_slips(program, program.full(column)) for column in columns]
    return np.array([(slip @ slip_axes(program).T).reshape(-1) for slip in slips]).T


def _velocity(program: Program, motion: Array, part: Index) -> Array:
    """Velocities at the contact points of the material of the given parts, shape (K, 3).

    Points of the ground have the velocity 0.
    """
    padded = np.vstack([motion, np.zeros((1, 6))])[part]
    center = np.vstack([program.center, np.zeros((1, 3))])[part]
    return padded[:, :3] + cross(padded[:, 3:], program.point - center)


def contact_slips(program: Program, motion: Array) -> Array:
    """Velocity of part b relative to part a at each contact point, shape (K, 3)."""
    over = _velocity(program, motion, program.part_b)
    return over - _velocity(program, motion, program.part_a)


def contact_shifts(program: Program, inverse: Array, motion: Array) -> tuple[Array, Array]:
    """Velocity of each contact point past the centres of parts a and b along a rolling, (K, 3)."""
    padded = np.vstack([motion, np.zeros((1, 6))])
    a, b = padded[program.part_a], padded[program.part_b]
    turn = cross(program.normal, b[:, 3:] - a[:, 3:])
    at = _velocity(program, motion, program.part_a) - np.einsum("kij,kj->ki", inverse, turn)
    return at - a[:, :3], at - b[:, :3]


def slip_changes(program: Program, shifts: tuple[Array, Array], motion: Array) -> Array:
    """Change of the slip of a motion at each contact by shifts of the contact point, (K, 3)."""
    padded = np.vstack([motion, np.zeros((1, 6))])[:, 3:]
    over_a, over_b = shifts
    return np.asarray(cross(padded[program.part_b], over_b) - cross(padded[program.part_a], over_a))


def rolling_shifts(program: Program, features: Features) -> Array:
    """Inverse of the sum of both curvatures, within their common directions, (K, 3, 3).

    Along a direction in which both surfaces are equally curved, as a rim in a cone along itself,
    they touch on a whole line, and no point of contact shifts.
    """
    total = features.curvature_a + features.curvature_b
    inverse = np.zeros_like(total)
    for k in range(len(total)):
        axes = _common(program, features, k)
        if axes.size:
            within = axes @ total[k] @ axes.T
            values, along = np.linalg.eigh(within)
            # equal curvatures cancel up to rounding of their own size
            size = max(np.abs(features.curvature_a[k]).max(), np.abs(features.curvature_b[k]).max())
            bent = np.abs(values) > BALANCED * size
            along = axes.T @ along[:, bent]
            inverse[k] = along / values[bent] @ along.T
    return inverse


def _common(program: Program, features: Features, k: int) -> Array:
    """Unit tangents along which both features of contact k extend, as rows."""
    away = [program.normal[k]]
    if features.conformal[k]:
        return np.zeros((0, 3))
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


Rolls = Literal["holds", "falls", "open"]
MOST = 600
"""Largest number of rows for which rolling is decided."""
ORDER: tuple[Rolls, ...] = ("falls", "open", "holds")
"""Results about rolling; an assembly has the first one that any of its clusters has."""


@dataclass(frozen=True, slots=True, eq=False)
class Rolling:
    """Result about rolling without slip (holds, falls or open), with its proof."""

    state: Rolls
    """One of "holds", "falls", "open"."""
    dimension: int
    """Dimension of the rollings."""
    curvature: float
    """Least E'' over weight and length, for rollings of length 1 [-]; 0 if there are none."""
    why: str
    """Reason for an open result."""
    forces: Array
    """Forces on part b [N], shape (K, 3)."""
    motion: Array
    """Rolling with the least E'', of length 1, shape (N, 6); 0 if there is none."""

    def __post_init__(self) -> None:
        read_only(self)


def worst_rolling(states: Iterable[Rolls]) -> Rolls:
    """Combine the results about rolling of several clusters to the result of the assembly."""
    return min(states, key=ORDER.index, default="open")


def rolling_of(
    cluster: Cluster,
    features: Features,
    assembly: Assembly,
    alone: Iterable[str] | None = None,
) -> Rolling:
    """Rolling of a cluster, or of the parts of it that fall alone while its other parts are held.

    Parameters
    ----------
    cluster : Cluster
        Cluster with friction.
    features : Features
        Features of all rows of the assembly.
    assembly : Assembly
    alone : iterable of str, optional
        Names of the parts that fall alone.
    """
    if not (cluster.program.mu > 0).any():
        return open_rolling(cluster.program, "no contact has friction")
    mine = features.take(cluster.rows)
    part = None if alone is None else falling_alone(cluster.program, alone)
    if part is not None:
        found = find_rolling(part.program, mine.take(part.rows), assembly)
        if found.state == "falls":
            return found
    # the other parts may move, too, so that friction may fail there
    return find_rolling(cluster.program, mine, assembly)


def find_rolling(program: Program, features: Features, assembly: Assembly) -> Rolling:
    """Decide whether friction holds a balanced cluster against rolling without slip."""
    why = _unmodelled_reason(program, assembly)
    if why:
        return open_rolling(program, why)
    return _RollingForces(program, features, assembly).result()


class _RollingForces:
    """Rows of a cluster that rolls without slip, forces of equilibrium on them, and their work.

    The first rows are the slips at contacts with friction, three (two) for each; then follow the
    gaps of other contacts and of joints.
    """

    def __init__(self, program: Program, features: Features, assembly: Assembly) -> None:
        self.program, contact = program, program.kind == CONTACT
        bent = np.abs(features.curvature_a).max(axis=(1, 2), initial=0.0) > 0
        fits = find_fits(program, np.flatnonzero(contact & (features.open | bent)))
        self.features, self.enclosed = fits.of_features(features), fits.enclosed
        self.swings = swings_of(assembly, program)
        self.rough = np.flatnonzero(program.mu > 0)
        self.other = np.flatnonzero(program.mu == 0)
        self.forms = np.nan_to_num(gap_forms(program, self.features))[self.other]
        self.forms += joint_forms(program, assembly.joints)[self.other]
        self.inverse = rolling_shifts(program, self.features)[self.rough]
        self.scale = _scale(program)
        slips = slip_rows(program.taking(self.rough)) if len(self.rough) else None
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
            return open_rolling(program, "no forces balance it")
        basis = null_space(rows, BALANCED) * self.scale[:, None]
        still = self._still(basis)
        if self.swings.torques[program.free].any():
            return open_rolling(program, "rolling is not modelled with torques")
        if not self._modelled(still):
            return open_rolling(program, "the curvature of its surfaces at a contact is not known")
        faces = self._faces(still)
        if not self._presses(components, faces):
            return open_rolling(program, "its forces are not within the cones of friction")
        each = self._stiffness_of_each(basis)
        stiffness = np.tensordot(components, each, axes=1) + self._swinging(basis)
        stressed = np.tensordot(left[:, rank:].T, each, axes=1)
        size = np.abs(stiffness).max(initial=0.0) / max(np.abs(components).max(), TINY)
        same = np.abs(stressed).max(initial=0.0) <= SLIPS * size
        sure = self._sticks(left[:, rank:], faces)
        return self._judged(basis, stiffness, self._forces(components), same=same, sure=sure)

    def _still(self, basis: Array) -> Mask:
        """Mask of the rows whose parts do not move relative to each other along Z, (K,)."""
        program = self.program
        still = np.ones(len(program.kind), dtype=bool)
        for column in basis.T:
            motion = program.full(column)
            turns = np.vstack([motion, np.zeros((1, 6))])[:, 3:]
            turn = turns[program.part_b] - turns[program.part_a]
            size = float(np.abs(motion[:, :3]).max() + np.abs(motion[:, 3:]).max() * self._length)
            moved = np.abs(contact_slips(program, motion)) + np.abs(turn) * self._length
            still &= moved.max(axis=1) <= SLIPS * size
        return still

    @property
    def _length(self) -> float:
        """Radius of the largest free part [length unit]."""
        return float(self.program.radius[self.program.free].max())

    def _modelled(self, still: Mask) -> bool:
        """True if the gaps of all contacts that move are known to second order."""
        program, features = self.program, self.features
        fits = self.enclosed & (program.mu == 0)
        known = still | (formed(program, features) & (fits | ~features.conformal))
        known &= ~self.enclosed | fits
        return bool(known[program.kind == CONTACT].all())

    def _faces(self, still: Mask) -> list[Index]:
        """Rows of each face with friction on which two parts stick together."""
        group = np.where(still & (self.program.mu > 0), self.features.group, -1)
        faces = [np.flatnonzero(group == number) for number in np.unique(group[group >= 0])]
        least = 2 if self.program.planar else 3
        return [rows for rows in faces if len(rows) >= least and self._wide(rows)]

    def _wide(self, rows: Index) -> bool:
        """True if points of a patch span a plane, or in the plane a line."""
        off = self.program.point[rows] - self.program.point[rows].mean(axis=0)
        sizes = np.linalg.svd(off, compute_uv=False)
        flat = np.abs(off @ self.program.normal[rows[0]]).max() <= SLIPS * sizes[0]
        return bool(flat and (self.program.planar or sizes[1] > SLIPS * sizes[0]))

    def _sticks(self, stress: Array, faces: list[Index]) -> bool:
        """True if self-stress, (C, q), changes no normal force and no resultant of a face."""
        program = self.program
        normal = np.array([
            np.einsum("ki,ki->k", self._forces(column), program.normal) for column in stress.T
        ]).reshape(-1, len(program.kind))  # fmt: skip
        single = (program.kind == CONTACT) & ~self.enclosed
        for rows in faces:
            single[rows] = False
            lever = program.lever(rows, np.full(len(rows), self._body(rows)))
            size = np.abs(lever).max(axis=0)
            if (np.abs(normal[:, rows] @ lever) > SLIPS * np.maximum(size, TINY)).any():
                return False
        return bool((np.abs(normal[:, single]) <= SLIPS).all())

    def _body(self, rows: Index) -> int:
        """A free part at rows of a patch."""
        return int(max(self.program.part_a[rows[0]], self.program.part_b[rows[0]]))

    def _swinging(self, basis: Array) -> Array:
        """Stiffness by the loads off the centres of mass, shape (d, d)."""
        turns = np.array([self.program.full(column)[:, 3:] for column in basis.T])
        turns = turns.reshape(basis.shape[1], len(self.program.names), 3)
        forms = np.where(self.program.free[:, None, None], self.swings.forms, 0.0)
        return np.asarray(np.einsum("inx,nxy,jny->ij", turns, forms, turns))

    def _presses(self, components: Array, faces: list[Index]) -> bool:
        """True if contacts press, those with friction strictly within their cones."""
        program, forces = self.program, self._forces(components)
        along = np.einsum("ki,ki->k", forces, program.normal)
        aside = np.linalg.norm(forces - along[:, None] * program.normal, axis=1)
        for rows in faces:
            lever = program.lever(rows, np.full(len(rows), self._body(rows)))
            lever = lever / np.where(np.arange(6) < 3, 1.0, program.radius[self._body(rows)])
            spread = spread_wrench(lever, lever.T @ along[rows], float(along[rows].sum()))
            along[rows] = along[rows] if spread is None else spread
        weight = float(program.weight[program.free].max())
        within = aside < (1 - SLIPS) * program.mu * along
        within[self.other] = True
        pressing = ((along > SLIPS * weight) & within) | self.enclosed
        return bool(pressing[program.kind == CONTACT].all())

    def _forces(self, components: Array) -> Array:
        """Forces on part b at the rows of the program, shape (K, 3); 0 at torques of joints."""
        program = self.program
        forces = np.zeros((len(program.kind), 3))
        axes = slip_axes(program)
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
            moved = contact_shifts(rough, self.inverse, along)
            for i, virtual in enumerate(motions):
                turned[i, j] = slip_changes(rough, moved, virtual)
        axes = slip_axes(program)
        slips = (turned @ axes.T).reshape(dimension, dimension, len(self.rough) * len(axes))
        six = np.concatenate([motions, np.zeros((dimension, 1, 6))], axis=1)
        ends = [six[:, end[self.other]] for end in (program.part_a, program.part_b)]
        both = np.concatenate(ends, axis=2)
        bent = np.einsum("ika,kab,jkb->ijk", both, self.forms, both)
        return -np.moveaxis(np.concatenate([slips, bent], axis=2), 2, 0)

    def _judged(
        self, basis: Array, stiffness: Array, forces: Array, *, same: bool, sure: bool
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


def open_rolling(program: Program, why: str) -> Rolling:
    """Make an open result with its reason."""
    none = np.zeros((len(program.part_a), 3)), np.zeros((len(program.names), 6))
    return Rolling("open", 0, 0.0, why, *none)


def _unmodelled_reason(program: Program, assembly: Assembly) -> str:
    """Reason why rolling of a cluster cannot be modelled; empty if it can."""
    if program.has_strength or program.tied.any() or program.cohesion.any():
        return "rolling is not modelled with bonds"
    known = np.isin(program.kind, (CONTACT, JOINT)).all()
    if not known or len(sprung_rows(program, assembly.joints)):
        return "rolling is not modelled with stops, friction and springs of joints"
    if 3 * len(program.kind) > MOST:
        return "its contacts are too many to decide whether it rolls"
    return ""


def _scale(program: Program) -> Array:
    """Displacement for one unit of each unknown, shape (n,): 1 for shifts, 1 / radius for turns."""
    units = np.where(np.arange(6) < 3, 1.0, 1 / program.radius[program.free, None])
    return np.asarray(units[:, program.freedoms].reshape(-1))
