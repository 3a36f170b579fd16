"""Open motions that bend: they roll, rock or swing round or jointed parts. No solver is used.

Given forces of equilibrium confine the neutral motions: contacts that press stay closed, joints
stay closed, and contacts that press with friction do not slip. On the null space Z of these rows,
with the second derivatives H_k of the gaps, the energy of frictionless forces f curves by

    E = -Z^T (sum of f_k H_k) Z

Round and jointed parts bend along a motion of negative curvature. Along a motion without curvature
they bend, too, unless it is harmless: each of them moves level, and spins about its centre of mass,

- its spin keeps all its touched surfaces in place, or is that of a part of revolution: a ball, a
  shaft in its bore
- its level motion against each part that it touches keeps the surface of one of both in place, or
  level lines that cross: an edge over an edge or over a cylinder

Then gaps and energy stay, to all orders. If motions move a pair whose curvature is unknown, and
neither part encloses the other, E is not used. Three rules add rows and leave out unknowns, at any
number of parts:

- the wrench of a patch may be spread over its points, which then all press
- contacts of two parts that enclose each other, as a bore its shaft, stay closed without forces:
  some s > 0 with J^T s = 0 exists for their rows alone, so J z >= 0 implies J z = 0
- a part whose centre of pressure is within level faces below moves level only (`steady_parts`)
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.sparse import diags_array

from kilter.arrays import TINY, Array, Index, Mask, across
from kilter.assembly import Joint
from kilter.contact.contact_set import ContactSet
from kilter.mechanics.clusters import clusters
from kilter.mechanics.program import Program
from kilter.mechanics.rows import CONTACT
from kilter.rigid import skew
from kilter.second_order.gaps.features_of import features_of
from kilter.second_order.gaps.gap_form import formed, gap_forms
from kilter.second_order.gaps.joint_forms import joint_forms, on_joints
from kilter.second_order.gaps.joint_springs import spring_form
from kilter.second_order.gaps.touched_surfaces import LINE, touched_surfaces
from kilter.second_order.motions.free_span import spins_unseen
from kilter.second_order.motions.null_space import null_space
from kilter.second_order.motions.steady import spread_over, steady_parts
from kilter.second_order.second_order_tolerances import BEARS, BENDS

__all__ = ["bending_bodies", "round_rows"]

STRAIGHT = ("plane", "edge-edge", "edge-face", "vertex-face")
"""Kinds of patch that are curved only if a part has curved surfaces."""
MOST = 1500
"""Largest number of unknowns for which the null space is computed; above, bending stays possible.
"""


def bending_bodies(
    contacts: ContactSet,
    joints: Sequence[Joint],
    program: Program,
    forces: Array,
    *,
    curves: bool,
) -> Mask:
    """Mask of the round or jointed parts that an open motion may bend, shape (N,).

    Parameters
    ----------
    contacts : ContactSet
    joints : sequence of Joint
        Joints of the assembly.
    program : Program
        Contacts and joints only; rigid groups are merged. Rows with friction do not slip.
    forces : ndarray, shape (K,)
        Forces of an equilibrium along the rows [N].
    curves : bool
        Whether these forces have no friction.
    """
    bending = np.zeros(len(program.names), dtype=bool)
    if not round_rows(program, contacts).any():
        return bending
    for cluster in clusters(program):
        rounds = round_rows(cluster.program, contacts)
        if rounds.any():
            mine = forces[cluster.rows]
            search = _Bending(contacts, joints, cluster.program, mine, rounds)
            bending |= search.parts(curves=curves)
    return bending


def round_rows(program: Program, contacts: ContactSet) -> Mask:
    """Mask of the rows of joints, and of contacts at which a surface is or may be curved, (K,)."""
    rounds = on_joints(program)
    rows = np.flatnonzero(program.kind == CONTACT)
    kinds = contacts.patch_kind[program.source[rows]]
    curved = np.append(np.diff(contacts.assembly.geometry.surfaces.start) > 0, False)
    parts = contacts.patch_parts[program.source[rows]]
    of_curved = curved[parts].any(axis=1) | ~np.isin(kinds, (*STRAIGHT, "given", "bond"))
    sharp = np.isin(kinds, STRAIGHT[1:])
    rounds[rows[sharp]] = True
    may_curve = of_curved | (kinds == "given")
    chosen = may_curve & (kinds != "plane")  # the rim of a flat face is in its plane
    rows, of_curved = rows[chosen], of_curved[chosen]
    if len(rows):
        features = features_of(program.taking(rows), contacts, recognised=True)
        bent = [features.curvature_a, features.curvature_b]
        rounds[rows] = np.any([np.abs(k).max(axis=(1, 2)) > 0 for k in bent], axis=0)
        rounds[rows] |= features.open & of_curved
    return rounds


class _Bending:
    """Neutral motions of a cluster, and the round or jointed parts that they bend."""

    def __init__(
        self,
        contacts: ContactSet,
        joints: Sequence[Joint],
        program: Program,
        forces: Array,
        rounds: Mask,
    ) -> None:
        self.contacts, self.joints, self.program = contacts, joints, program
        self.rounds, self.joined = rounds, on_joints(program)
        self.forces = forces / program.arm
        self.blur = max(1e-9, float(program.tolerance.max(initial=0.0)))
        size = max(float(np.abs(self.forces).max(initial=0.0)), TINY)
        self.presses = ~self.joined & (self._spread_out() > BEARS * self.blur * size)
        self.enclosed = self._enclosed()
        self.closed = self.joined | self.presses | self.enclosed
        self.steady = steady_parts(program, self.forces, ~rounds)
        free = np.flatnonzero(program.free)
        units = np.where(np.arange(6) < 3, 1.0, 1 / program.radius[free, None])
        self.scale = units[:, program.freedoms].reshape(-1)
        ends = [program.part_a[rounds], program.part_b[rounds]]
        self.round_parts = np.zeros(len(program.names) + 1, dtype=bool)
        self.round_parts[np.concatenate(ends)] = True
        self.round_parts = self.round_parts[:-1] & program.free

    def parts(self, *, curves: bool) -> Mask:
        """Mask of the parts that an open motion may bend, shape (N,).

        `curves`: whether the forces are frictionless, so that the energy curves by the gaps alone.
        """
        bending = np.zeros(len(self.program.names), dtype=bool)
        if not (self.rounds & self.closed).any():
            return bending
        motions = self._neutral_motions()
        if motions is None:
            return self.round_parts
        if not motions.shape[1]:
            return bending
        flat = motions
        if curves and not self._moves_unknown(motions):
            values, axes = np.linalg.eigh(self._curvature(motions))
            # motions of length 1 at forces of 1
            falls, level = values < -BENDS, np.abs(values) <= BENDS
            bending |= self.round_parts & self._moved(motions @ axes[:, falls])
            flat = motions @ axes[:, level]
        return bending | (self.round_parts & self._moved(self._harmful(flat)))

    def _moved(self, motions: Array) -> Mask:
        """Mask of the parts that scaled motions, (n, d), move, shape (N,)."""
        moved = np.zeros(len(self.program.names), dtype=bool)
        by_part = np.abs(motions).reshape(int(self.program.free.sum()), -1)
        moved[self.program.free] = by_part.max(axis=1, initial=0.0) > np.sqrt(BENDS)
        return moved

    def _moves_unknown(self, motions: Array) -> bool:
        """True if motions move a pair at a pressed contact of unknown curvature."""
        rows = np.flatnonzero(self.rounds & self.presses & ~self.enclosed)
        part = self.program.taking(rows)
        known = formed(part, features_of(part, self.contacts, recognised=True))
        for k in rows[~known].tolist():
            ends = [int(self.program.part_a[k]), int(self.program.part_b[k])]
            six = [self._of_part(end, motions) for end in ends]
            arms = [self.program.point[k] - self._center(end) for end in ends]
            moved = [v[:3] - skew(arm) @ v[3:] for v, arm in zip(six, arms, strict=True)]
            slip, turn = np.abs(moved[1] - moved[0]), np.abs(six[1][3:] - six[0][3:])
            if max(slip.max(initial=0.0), turn.max(initial=0.0) * self._size(ends)) > BENDS:
                return True
        return False

    def _size(self, ends: list[int]) -> float:
        """Radius of the smaller of two parts, without the ground."""
        return float(self.program.radius[[end for end in ends if end >= 0]].min())

    def _center(self, part: int) -> Array:
        """Centre of mass of a part; 0 for the ground."""
        return self.program.center[part] if part >= 0 else np.zeros(3)

    def _of_part(self, part: int, motions: Array) -> Array:
        """Motions of a part from scaled motions, shape (6, d); 0 for held parts."""
        result = np.zeros((6, motions.shape[1]))
        if part >= 0 and self.program.free[part]:
            per = len(self.program.freedoms)
            mine = slice(per * int(self.program.free[:part].sum()), None)
            result[self.program.freedoms] = (self.scale[mine, None] * motions[mine])[:per]
        return result

    def _curvature(self, motions: Array) -> Array:
        """Second derivative of the energy, (d, d), over the largest force and the size of parts."""
        fixed = np.append(~self.program.free | self.steady, True)
        between = fixed[self.program.part_a] & fixed[self.program.part_b] & ~self.rounds
        rows = np.flatnonzero((self.forces != 0) & ~between)
        part = self.program.taking(rows)
        forms = np.nan_to_num(
            gap_forms(part, features_of(part, self.contacts, recognised=True))
        ) + joint_forms(part, self.joints)
        ends = [
            np.array([self._of_part(int(end), motions) for end in side]).reshape(
                len(rows), 6, motions.shape[1]
            )
            for side in (part.part_a, part.part_b)
        ]
        both = np.concatenate(ends, axis=1)
        total = -np.einsum("k,kai,kab,kbj->ij", self.forces[rows], both, forms, both)
        springs = spring_form(self.program, self.joints)
        if springs is not None:
            moved = self.scale[:, None] * motions
            total += moved.T @ springs @ moved
        length = float(self.program.radius[self.round_parts].max(initial=0.0))
        most = float(np.abs(self.forces[self.rounds]).max(initial=0.0))
        return np.asarray((total + total.T) / 2 * length / max(most, TINY))

    def _harmful(self, motions: Array) -> Array:
        """Rest of scaled motions, (n, d), that is no harmless motion of the round parts."""
        program, per = self.program, len(self.program.freedoms)
        rounds = np.flatnonzero(self.round_parts)
        touching = np.append(self.round_parts, False)
        rows = np.flatnonzero(self.closed & (touching[program.part_a] | touching[program.part_b]))
        part = program.taking(rows)
        features = features_of(part, self.contacts, recognised=True)
        touched = touched_surfaces(part, features, self.contacts, self.joints)
        origin = program.center[rounds].mean(axis=0)
        keeps = [side.conditions(origin, 1.0) for side in touched]
        blocks, level = [], self._level_screws()
        columns = 0
        for k in rounds.tolist():
            mine = [keeps[0][i] for i in np.flatnonzero(part.part_a == k)]
            mine += [keeps[1][i] for i in np.flatnonzero(part.part_b == k)]
            arm = program.center[k] - origin
            stays = np.hstack([np.eye(3), -skew(arm)])
            spins = null_space(np.vstack([stays, *mine]), 1e-9)
            spins = np.hstack([spins, self._own_spins(k, arm)])
            blocks.append((k, level.shape[1], np.hstack([level, spins]), arm))
            columns += level.shape[1] + spins.shape[1]
        for k in np.flatnonzero(program.free & ~self.round_parts).tolist():
            blocks.append((k, -1, level, program.center[k] - origin))
            columns += level.shape[1]
        spanned = np.zeros((len(motions), columns))
        place: dict[int, slice] = {}
        column = 0
        for k, count, screws, arm in blocks:
            six = np.vstack([screws[:3] - skew(arm) @ screws[3:], screws[3:]])[program.freedoms]
            at = per * int(program.free[:k].sum())
            here = slice(column, column + screws.shape[1])
            spanned[at : at + per, here] = six / self.scale[at : at + per, None]
            if count >= 0:
                place[k] = slice(column, column + count)
            column += screws.shape[1]
        # level motions keep the distance of level lines that cross
        upright = np.linalg.norm(np.cross(part.normal, program.down), axis=1) < BENDS
        lines = (touched[0].kind == LINE) & (touched[1].kind == LINE)
        crossing = upright & lines & formed(part, features)
        rules = [
            self._level_rule(part, keeps, row, place, level, columns)
            for row in np.flatnonzero(~crossing).tolist()
        ]
        kept = np.repeat(self.round_parts[program.free], per)
        wanted = motions
        alone = motions @ null_space(motions[kept], 1e-9)  # no round part moves
        pad = np.zeros((sum(len(rule) for rule in rules), alone.shape[1]))
        whole = np.hstack([np.vstack([spanned, *rules]), np.vstack([alone, pad])])
        right = np.vstack([wanted, np.zeros((len(whole) - len(wanted), motions.shape[1]))])
        found = np.linalg.lstsq(whole, right, rcond=1e-9)[0]
        off = np.abs(whole @ found - right).max(axis=0, initial=0.0) > BENDS
        return np.where(kept[:, None], wanted, 0.0)[:, off]

    def _own_spins(self, part: int, arm: Array) -> Array:
        """Spins of a part of revolution about its axis, as screws (v, omega), shape (6, s).

        `arm`: vector from the origin of the screws to its centre of mass.
        """
        assembly = self.contacts.assembly
        names = {name for joint in self.joints if joint.kind == "fixed" for name in joint.parts}
        surfaces = assembly.geometry.surfaces
        if self.program.planar or assembly.names[part] in names:
            return np.zeros((6, 0))
        axes = surfaces.axis[surfaces.start[part] : surfaces.start[part + 1]]
        spins = [
            np.append(np.cross(arm, axis), axis)
            for axis in np.unique(axes.round(12), axis=0)
            if axis.any() and spins_unseen(assembly, part, np.append(np.zeros(3), axis))
        ]
        return np.array(spins).reshape(-1, 6).T

    def _level_screws(self) -> Array:
        """Screws (v, omega) that move level, shape (6, 3), or (6, 1) in the plane."""
        down = self.program.down
        six = np.zeros((6, 3))
        if self.program.planar:
            six[:3, 0] = np.cross(down, [0.0, 1.0, 0.0])
            return six[:, :1]
        first, second = across(down[None])
        six[:3, 0], six[:3, 1], six[3:, 2] = first[0], second[0], down
        return six

    def _level_rule(
        self,
        part: Program,
        keeps: list[list[Array]],
        row: int,
        place: dict[int, slice],
        level: Array,
        columns: int,
    ) -> Array:
        """Conditions, (c, columns), that the relative level motion at a row keeps a surface.

        The level motions of parts without curved contacts are not known, so none is required there.
        """
        ends = int(part.part_a[row]), int(part.part_b[row])
        known = [end < 0 or not self.program.free[end] or end in place for end in ends]
        if not all(known):
            return np.zeros((0, columns))
        kept = np.hstack([null_space(side[row], 1e-9) for side in keeps])
        outside = null_space(kept.T, 1e-9).T if kept.shape[1] else np.eye(6)
        rule = np.zeros((len(outside), columns))
        for end, sense in zip(ends, (-1.0, 1.0), strict=True):
            if end in place:
                rule[:, place[end]] += sense * outside @ level
        return rule

    def _spread_out(self) -> Array:
        """Forces that are spread over all points of each patch, if these then press alike, (K,).

        The wrench of each patch is the same, so the forces still balance every part. Forces of a
        linear program press at few points.
        """
        program, spread = self.program, self.forces.copy()
        contact = np.flatnonzero((program.kind == CONTACT) & (self.forces >= 0))
        order = contact[np.argsort(program.source[contact], kind="stable")]
        ends = np.flatnonzero(np.diff(program.source[order])) + 1
        for rows in np.split(order, ends):
            if len(rows) > 1:
                part = max(program.part_a[rows[0]], program.part_b[rows[0]])
                lever = program.lever(rows, np.full(len(rows), part))
                mine = spread_over(lever, self.forces[rows])
                spread[rows] = spread[rows] if mine is None else mine
        return spread

    def _neutral_motions(self) -> Array | None:
        """Basis of the motions that keep closed contacts, in scaled unknowns; None if too large."""
        program, per = self.program, len(self.program.freedoms)
        free = np.flatnonzero(program.free)
        fixed = np.append(~program.free | self.steady, True)
        between = fixed[program.part_a] & fixed[program.part_b] & ~self.rounds
        rows = np.flatnonzero(self.closed & ~between)
        touched = np.unique(np.concatenate([program.part_a[rows], program.part_b[rows]]))
        level = self._level_screws()[program.freedoms]
        at = [(i, k) for i, k in enumerate(free.tolist()) if k in set(touched.tolist())]
        blocks = [level if self.steady[k] else np.eye(per) for _, k in at]
        count = sum(block.shape[1] for block in blocks)
        if count > MOST:
            return None
        spread = np.zeros((per * len(free), count))
        column = 0
        for (i, _), block in zip(at, blocks, strict=True):
            spread[per * i : per * (i + 1), column : column + block.shape[1]] = block
            column += block.shape[1]
        scaled = self.scale[:, None] * spread
        matrix = diags_array(program.arm[rows]) @ program.taking(rows).jacobian() @ scaled
        slips = self._sticking(rows).jacobian() @ scaled
        return spread @ null_space(np.vstack([matrix, slips]), self.blur)

    def _sticking(self, rows: Index) -> Program:
        """Rows of the slips, which are 0, at the pressed contacts with friction among `rows`."""
        rough = rows[self.presses[rows] & (self.program.mu[rows] > 0)]
        pair = self.program.taking(np.tile(rough, 2))
        return pair.with_rows(normal=np.concatenate(across(self.program.normal[rough])))

    def _enclosed(self) -> Mask:
        """Mask of the rows of pairs that enclose each other at curved contacts, shape (K,)."""
        program = self.program
        enclosed = np.zeros(len(program.kind), dtype=bool)
        curved = np.flatnonzero(~self.joined & self.rounds)
        kinds = self.contacts.patch_kind[program.source[curved]]
        curved = curved[~np.isin(kinds, STRAIGHT)]
        count = len(program.names) + 1
        pair = (program.part_a % count) * count + program.part_b % count
        for number in np.unique(pair[curved]):
            rows = curved[pair[curved] == number]
            part = max(program.part_a[rows[0]], program.part_b[rows[0]])
            lever = program.lever(rows, np.full(len(rows), part))[:, program.freedoms]
            lever = lever / np.where(program.freedoms < 3, 1.0, program.radius[part])
            ones = np.ones(len(rows))
            stress = ones - lever @ np.linalg.lstsq(lever, ones, rcond=1e-9)[0]
            enclosed[rows] = stress.min() > BENDS
        return enclosed
