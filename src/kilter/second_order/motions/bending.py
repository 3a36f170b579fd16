"""Motions that bend: they roll, rock or swing round or jointed parts. No solver is used.

Given forces of equilibrium confine the neutral motions: contacts that press stay closed, joints
stay closed, and contacts that press with friction do not slip. On the null space Z of these rows,
the motions bend at a pair of parts if

    Z^T (sum of f_k H_k) Z  is not 0          over the rows of a curved contact, or of a joint

with the second derivatives H_k of the gaps. Then a small push may topple the parts, even if no
first-order motion loses energy. No motion bends along a spin of a round part, a shaft that turns or
slides in its bore, a ball that rolls on a plane, or a slide of flat faces. If Z moves a pair whose
curvature is unknown, bending is not excluded.

Two rules leave out rows and unknowns, at any number of parts:

- contacts of two parts that enclose each other, as a bore its shaft, stay closed without forces:
  some s > 0 with J^T s = 0 exists for their rows alone, so J z >= 0 implies J z = 0
- a part on level faces whose forces fix its height and tilt moves level only (`steady_parts`)
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import diags_array

from kilter.arrays import TINY, Array, Index, Mask, across
from kilter.assembly import Assembly
from kilter.contact.contact_set import ContactSet
from kilter.mechanics.clusters import clusters
from kilter.mechanics.program import Program
from kilter.mechanics.rows import CONTACT, JOINT
from kilter.second_order.gaps.features import Features
from kilter.second_order.gaps.features_of import features_of
from kilter.second_order.gaps.gap_form import formed, gap_forms
from kilter.second_order.gaps.joint_forms import joint_forms, on_joints
from kilter.second_order.motions.null_space import null_space
from kilter.second_order.parts.rigid_groups import RigidGroups
from kilter.second_order.second_order_tolerances import BEARS, BENDS, SPREAD

__all__ = ["bending_bodies", "bending_parts", "round_rows", "steady_parts"]

STRAIGHT = ("plane", "edge-edge", "edge-face", "vertex-face")
"""Kinds of patch that are curved only if a part has curved surfaces."""
MOST = 1500
"""Largest number of unknowns for which the null space is computed; above, bending stays possible.
"""


def bending_parts(
    assembly: Assembly, contacts: ContactSet, program: Program, forces: Array | None
) -> Mask:
    """Mask of the round or jointed parts that may roll, rock or swing without work, shape (N,).

    Parameters
    ----------
    assembly : Assembly
    contacts : ContactSet
    program : Program
        Rows of these contacts; rows with friction do not slip.
    forces : ndarray, shape (K,), optional
        Forces of an equilibrium along the rows [N]. Without them no contact is known to press.
    """
    groups = RigidGroups.of(assembly)
    forces = np.zeros(len(program.kind)) if forces is None else forces
    whole = groups.merged(program, assembly)
    if groups.tied:
        forces = forces[groups.between(program, assembly)]
    kept = np.isin(whole.kind, (CONTACT, JOINT))
    whole, forces = whole.taking(kept), forces[kept]
    return np.asarray(bending_bodies(assembly, contacts, whole, forces)[groups.first])


def bending_bodies(
    assembly: Assembly, contacts: ContactSet, program: Program, forces: Array
) -> Mask:
    """The same mask for a program whose rigid groups are merged, with contacts and joints only."""
    bending = np.zeros(len(program.names), dtype=bool)
    if not round_rows(program, contacts).any():
        return bending
    for cluster in clusters(program):
        rounds = round_rows(cluster.program, contacts)
        if rounds.any():
            search = _Bending(assembly, contacts, cluster.program, forces[cluster.rows], rounds)
            bending |= search.parts()
    return bending


def round_rows(program: Program, contacts: ContactSet) -> Mask:
    """Mask of the rows of joints, and of contacts at which a surface is or may be curved, (K,)."""
    rounds = on_joints(program)
    rows = np.flatnonzero(program.kind == CONTACT)
    kinds = contacts.patch_kind[program.source[rows]]
    curved = np.append(np.diff(contacts.assembly.geometry.surfaces.start) > 0, False)
    parts = contacts.patch_parts[program.source[rows]]
    may_curve = curved[parts].any(axis=1) | ~np.isin(kinds, STRAIGHT)
    rows = rows[may_curve]
    if len(rows):
        features = features_of(program.taking(rows), contacts, recognised=True)
        bent = [features.curvature_a, features.curvature_b]
        rounds[rows] = np.any([np.abs(k).max(axis=(1, 2)) > 0 for k in bent], axis=0)
        rounds[rows] |= features.open
    return rounds


def steady_parts(program: Program, presses: Mask) -> Mask:
    """Mask of free parts that level faces under load allow to move level only, shape (N,).

    A part is steady if the rows that press it on held or steady parts, along the vertical, fix its
    height and tilt.

    Parameters
    ----------
    program : Program
    presses : ndarray of bool, shape (K,)
        Rows of flat contacts that press.
    """
    upright = np.linalg.norm(np.cross(program.normal, program.down), axis=1) < BENDS
    rows = np.flatnonzero(presses & upright & (program.kind == CONTACT))
    fixed = np.append(~program.free, True)
    at: dict[int, list[int]] = {}
    for k in rows.tolist():
        for part in (int(program.part_a[k]), int(program.part_b[k])):
            if not fixed[part]:
                at.setdefault(part, []).append(k)
    need = 2 if program.planar else 3
    todo = list(at)
    while todo:
        part = todo.pop()
        mine = np.array(at[part])
        other = np.where(program.part_a[mine] == part, program.part_b[mine], program.part_a[mine])
        on_fixed = mine[fixed[other]]
        if fixed[part] or len(on_fixed) < need:
            continue
        lever = program.lever(on_fixed, np.full(len(on_fixed), part))[:, program.freedoms]
        lever = lever / np.where(program.freedoms < 3, 1.0, program.radius[part])
        values = np.linalg.svd(lever, compute_uv=False) ** 2
        if len(values) >= need and values[need - 1] > SPREAD * values[0]:
            fixed[part] = True
            todo += [k for k in np.unique(other).tolist() if k in at and not fixed[k]]
    return np.asarray(fixed[:-1] & program.free)


class _Bending:
    """Neutral motions of a cluster, and the pairs at which they bend."""

    def __init__(
        self,
        assembly: Assembly,
        contacts: ContactSet,
        program: Program,
        forces: Array,
        rounds: Mask,
    ) -> None:
        self.joints, self.program, self.rounds = assembly.joints, program, rounds
        self.forces = forces / program.arm
        joined = on_joints(program)
        size = float(np.abs(self.forces).max(initial=0.0))
        limit = BEARS * max(1e-9, float(program.tolerance.max(initial=0.0)))
        self.presses = ~joined & (self.forces > limit * max(size, TINY))
        self.closed = joined | self.presses | self._enclosed()
        self.features: Features = features_of(program, contacts, recognised=True)

    def parts(self) -> Mask:
        """Mask of the parts at which a neutral motion bends, shape (N,)."""
        program = self.program
        bending = np.zeros(len(program.names), dtype=bool)
        rows = np.flatnonzero(self.rounds & self.closed)
        if not len(rows):
            return bending
        motions = self._neutral_motions()
        joined = on_joints(program)
        # a group of rows: a patch (from 0), or a joint (below 0)
        group = np.where(joined, -1 - program.source, program.source)[rows]
        for number in np.unique(group):
            mine = rows[group == number]
            if motions is None or self._bends(mine, motions):
                ends = np.array([program.part_a[mine[0]], program.part_b[mine[0]]])
                bending[ends[ends >= 0]] = True
        return bending & program.free

    def _bends(self, rows: Index, motions: Array) -> bool:
        """True if a neutral motion bends at rows of a patch or joint, or if this is unknown."""
        part = self.program.taking(rows)
        ends = [int(part.part_a[0]), int(part.part_b[0])]
        six = np.concatenate([self._of_part(end, motions) for end in ends])
        if not six.shape[1]:
            return False
        size = float(self.program.radius[[end for end in ends if end >= 0]].min())
        if not (on_joints(part) | formed(part, self.features.take(rows))).all():
            turn, arms = six[9:] - six[3:6], part.point[:1] - self._centers(ends)
            slip = six[6:9] - np.cross(arms[1], six[9:].T).T
            slip -= six[:3] - np.cross(arms[0], six[3:6].T).T
            return bool(max(np.abs(slip).max(), np.abs(turn).max() * size) > BENDS)
        forms = np.nan_to_num(gap_forms(part, self.features.take(rows)))
        forms += joint_forms(part, self.joints)
        form = six.T @ np.tensordot(self.forces[rows], forms, axes=1) @ six
        pressed = float(np.abs(self.forces[rows]).sum())
        return bool(np.abs(form).max() * size > BENDS * pressed)

    def _centers(self, ends: list[int]) -> Array:
        """Centres of mass of two parts, shape (2, 3); 0 for the ground."""
        return np.array([self.program.center[k] if k >= 0 else np.zeros(3) for k in ends])

    def _of_part(self, part: int, motions: Array) -> Array:
        """Motions of a part, shape (6, d); 0 for held parts."""
        result = np.zeros((6, motions.shape[1]))
        if part >= 0 and self.program.free[part]:
            place = int(self.program.free[:part].sum()) * len(self.program.freedoms)
            result[self.program.freedoms] = motions[place : place + len(self.program.freedoms)]
        return result

    def _neutral_motions(self) -> Array | None:
        """Basis of the motions that keep closed contacts, as columns; None if it is too large."""
        program, per = self.program, len(self.program.freedoms)
        free = np.flatnonzero(program.free)
        units = np.where(np.arange(6) < 3, 1.0, 1 / program.radius[free, None])
        scale = diags_array(units[:, program.freedoms].reshape(-1))
        steady = steady_parts(program, self.presses & ~self.rounds)
        ends = np.append(~program.free | steady, True)
        fixed = ends[program.part_a] & ends[program.part_b]
        rows = np.flatnonzero(self.closed & (~fixed | self.rounds))
        touched = np.unique(np.concatenate([program.part_a[rows], program.part_b[rows]]))
        level = self._level_columns()
        blocks, at = [], []
        for i, part in enumerate(free.tolist()):
            if part in touched:
                blocks.append(level if steady[part] else np.eye(per))
                at.append(i)
        count = sum(block.shape[1] for block in blocks)
        if count > MOST:
            return None
        spread = np.zeros((per * len(free), count))
        column = 0
        for i, block in zip(at, blocks, strict=True):
            spread[per * i : per * (i + 1), column : column + block.shape[1]] = block
            column += block.shape[1]
        basis = np.asarray(scale @ spread)
        matrix = diags_array(program.arm[rows]) @ program.taking(rows).jacobian()
        slips = self._sticking(rows)
        whole = np.vstack([matrix @ basis, slips.jacobian() @ basis])
        return basis @ null_space(whole, max(1e-9, float(program.tolerance.max(initial=0.0))))

    def _level_columns(self) -> Array:
        """Unknowns of a part that moves level: shifts, and the turn about the vertical."""
        program = self.program
        six = np.zeros((6, 3))
        if program.planar:
            six[:3, 0] = np.cross(program.down, [0.0, 1.0, 0.0])
            return six[program.freedoms, :1]
        first, second = across(program.down[None])
        six[:3, 0], six[:3, 1], six[3:, 2] = first[0], second[0], program.down
        return six

    def _sticking(self, rows: Index) -> Program:
        """Rows of the slips, which are 0, at the pressed contacts with friction among `rows`."""
        rough = rows[self.presses[rows] & (self.program.mu[rows] > 0)]
        pair = self.program.taking(np.tile(rough, 2))
        return pair.with_rows(normal=np.concatenate(across(self.program.normal[rough])))

    def _enclosed(self) -> Mask:
        """Mask of the rows of pairs that enclose each other at curved contacts, shape (K,)."""
        program = self.program
        enclosed = np.zeros(len(program.kind), dtype=bool)
        contact = program.kind == CONTACT
        curved = np.flatnonzero(contact & self.rounds)
        count = len(program.names) + 1
        pair = (program.part_a % count) * count + program.part_b % count
        for number in np.unique(pair[curved]):
            rows = np.flatnonzero(contact & (pair == number))
            part = max(program.part_a[rows[0]], program.part_b[rows[0]])
            lever = program.lever(rows, np.full(len(rows), part))[:, program.freedoms]
            lever = lever / np.where(program.freedoms < 3, 1.0, program.radius[part])
            ones = np.ones(len(rows))
            stress = ones - lever @ np.linalg.lstsq(lever, ones, rcond=1e-9)[0]
            enclosed[rows] = stress.min() > BENDS
        return enclosed
