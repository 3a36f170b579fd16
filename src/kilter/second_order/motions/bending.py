"""Open motions that bend: they roll, rock or swing round or jointed parts. No solver is used.

Given forces of equilibrium confine the neutral motions: contacts that press stay closed, joints
stay closed, and contacts that press with friction do not slip. On the null space Z of these rows,
with the second derivatives H_k of the gaps, the energy of frictionless forces f curves by

    E = -Z^T (sum of f_k H_k) Z

Round and jointed parts bend along a motion of negative curvature. Along a motion without curvature
they bend, too, unless it is harmless (`harmless`). If motions move a pair whose curvature is
unknown, E is not used. Loads off the centres of mass add their own curvature (`load_forms`).

Three rules add rows and leave out unknowns, at any number of parts:

- the wrench of a patch may be spread over its points, which then all press
- contacts of two bodies that enclose each other, as a bore its shaft, stay closed without forces
  (`fits`)
- a part whose centre of pressure is within level faces below moves level only (`steady_parts`)

A contact presses only if the load needs it. If a bore and its shaft have no resultant force, or if
joints between the same two bodies can carry the force of a face, the face may be free of force, so
that its friction holds nothing: a plate on an upright hinge beside a wall that it touches falls.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.sparse import diags_array

from kilter.arrays import TINY, Array, Index, Mask, across, connected, read_only
from kilter.assembly import Assembly
from kilter.contact.contact_set import ContactSet
from kilter.mechanics.clusters import clusters
from kilter.mechanics.nonnegative import nonnegative
from kilter.mechanics.program import Program
from kilter.mechanics.rows import CONTACT
from kilter.rigid import skew
from kilter.second_order.gaps.features import Features
from kilter.second_order.gaps.features_of import features_of
from kilter.second_order.gaps.fits import body_pairs, find_fits, stressed, wrenches
from kilter.second_order.gaps.gap_form import formed, gap_forms
from kilter.second_order.gaps.joint_forms import joint_forms, on_joints, spring_form, swings_of
from kilter.second_order.gaps.touched_surfaces import touched_surfaces
from kilter.second_order.motions.harmless import Harmless, level_screws
from kilter.second_order.motions.null_space import null_space
from kilter.second_order.second_order_tolerances import BEARS, BENDS, SLIPS, SPREAD

# Parts that level faces below allow to move level only, by rule, at any number of parts.


SHARE, ROUNDS = 1e-3, 60
"""Least force of a point of a patch, over the mean force [-], and number of rounds to reach it."""


def steady_parts(program: Program, forces: Array, flat: Mask) -> Mask:
    """Mask of free parts that level faces below allow to move level only, shape (N,).

    The points of the faces of held or steady parts below do not sink. Where they press, they do not
    rise either. So the part keeps its height and tilt if its centre of pressure is within the hull
    of all these points: their forces can be spread so that all of them press.

    Arguments: `forces` (K,): forces of an equilibrium [N]; `flat` (K,): rows of contacts that are
    not curved.
    """
    upright = np.linalg.norm(np.cross(program.normal, program.down), axis=1) < BENDS
    rows = np.flatnonzero(flat & upright & (program.kind == CONTACT))
    fixed = np.append(~program.free, True)
    lifts_b = program.normal[rows] @ program.down < 0
    upper = np.where(lifts_b, program.part_b[rows], program.part_a[rows])
    lower = np.where(lifts_b, program.part_a[rows], program.part_b[rows])
    order = np.argsort(upper, kind="stable")
    parts, start = np.unique(upper[order], return_index=True)
    at = dict(zip(parts.tolist(), np.split(order, start[1:] if len(rows) else []), strict=False))
    above: dict[int, set[int]] = {}
    for high, low in zip(upper.tolist(), lower.tolist(), strict=True):
        above.setdefault(low, set()).add(high)
    need = 2 if program.planar else 3
    todo = [part for part in at if not fixed[part]]
    while todo:
        part = todo.pop()
        mine = at[part][fixed[lower[at[part]]]]
        if fixed[part] or len(mine) < need:
            continue
        lever = program.lever(rows[mine], np.full(len(mine), part))[:, program.freedoms]
        lever = lever / np.where(program.freedoms < 3, 1.0, program.radius[part])
        values = np.linalg.svd(lever, compute_uv=False) ** 2
        wide = len(values) >= need and values[need - 1] > SPREAD * values[0]
        if wide and spread_over(lever, forces[rows[mine]]) is not None:
            fixed[part] = True
            todo += [k for k in above.get(part, ()) if not fixed[k]]
    return np.asarray(fixed[:-1] & program.free)


def spread_over(lever: Array, forces: Array) -> Array | None:
    """Forces that press at every point with the wrench of given forces, (k,); None if not found.

    `lever`, shape (k, m): wrench of a unit force at each point.
    """
    total = float(forces.sum())
    if total <= 0.0 or (forces < 0).any():
        return None
    if forces.min() > SHARE * total / len(forces):
        return forces
    return spread_wrench(lever, lever.T @ forces, total)


def spread_wrench(lever: Array, wrench: Array, total: float) -> Array | None:
    """Forces of a given total that press at every point with a given wrench, (k,); or None."""
    if total <= 0.0:
        return None
    least = SHARE * total / len(lever)
    inverse = np.linalg.pinv(lever.T, rcond=1e-9)
    spread = np.full(len(lever), total / len(lever))
    for _ in range(ROUNDS):
        spread = spread + inverse @ (wrench - lever.T @ spread)
        if spread.min() > least:
            return np.asarray(spread)
        spread = np.maximum(spread, 2 * least)
    return None


STRAIGHT = ("plane", "edge-edge", "edge-face", "vertex-face")
"""Kinds of patch that are curved only if a part has curved surfaces."""
MOST = 1500
"""Largest number of unknowns for which the null space is computed; above, bending stays possible.
"""


@dataclass(frozen=True, slots=True, eq=False)
class Bends:
    """Parts that an open motion may bend, and all parts that neutral motions move; masks, (N,)."""

    bending: Mask
    moved: Mask

    def __post_init__(self) -> None:
        read_only(self)


def bending_bodies(
    assembly: Assembly, contacts: ContactSet, program: Program, forces: Array, *, curves: bool
) -> Bends:
    """Find the round or jointed parts that an open motion may bend.

    Arguments: `forces` (K,) [N].
    """
    bending, moved = np.zeros((2, len(program.names)), dtype=bool)
    if not round_rows(program, contacts).any():
        return Bends(bending, moved)
    for cluster in clusters(program):
        rounds = round_rows(cluster.program, contacts)
        if rounds.any():
            mine = forces[cluster.rows]
            search = Bending(assembly, contacts, cluster.program, mine, rounds)
            found = search.parts(curves=curves)
            bending |= found.bending
            moved |= found.moved
    return Bends(bending, moved)


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


def _with_play(program: Program, contacts: ContactSet, curved: Index) -> Index:
    """Rows of cylinders and spheres whose play counts as closed, among the given rows."""
    patch = program.source[curved]
    wide = np.abs(contacts.patch_gap[patch]).max(axis=1, initial=0.0) > contacts.gap
    return np.asarray(curved[wide & np.isin(contacts.patch_kind[patch], ("cylinder", "sphere"))])


class Bending:
    """Neutral motions of a cluster, and the round or jointed parts that they bend."""

    def __init__(
        self,
        assembly: Assembly,
        contacts: ContactSet,
        program: Program,
        forces: Array,
        rounds: Mask,
    ) -> None:
        self.assembly, self.contacts, self.program = assembly, contacts, program
        self.swings = swings_of(assembly, program)
        self.rounds, self.joined = rounds, on_joints(program)
        self.forces = forces / program.arm
        self.blur = max(1e-9, float(program.tolerance.max(initial=0.0)))
        size = max(float(np.abs(self.forces).max(initial=0.0)), TINY)
        self.presses = ~self.joined & (self._spread_out() > BEARS * self.blur * size)
        curved = np.flatnonzero(~self.joined & rounds)
        curved = curved[~np.isin(contacts.patch_kind[program.source[curved]], STRAIGHT)]
        self.fits = find_fits(program, curved, _with_play(program, contacts, curved))
        self.enclosed = self.fits.enclosed
        self.presses &= ~self._may_be_idle()
        self.closed = self.joined | self.presses | self.enclosed
        self.steady = steady_parts(program, self.forces, ~rounds)
        free = np.flatnonzero(program.free)
        units = np.where(np.arange(6) < 3, 1.0, 1 / program.radius[free, None])
        self.scale = units[:, program.freedoms].reshape(-1)
        ends = [program.part_a[rounds], program.part_b[rounds]]
        self.round_parts = np.zeros(len(program.names) + 1, dtype=bool)
        self.round_parts[np.concatenate(ends)] = True
        self.round_parts = self.round_parts[:-1] & program.free

    @cached_property
    def features(self) -> Features:
        """Features of all rows, with the common surfaces of fits."""
        return self.fits.of_features(features_of(self.program, self.contacts, recognised=True))

    def parts(self, *, curves: bool) -> Bends:
        """Parts that an open motion may bend, and parts that neutral motions move.

        `curves`: whether the forces are frictionless, so that the energy curves by the gaps alone.
        """
        bending = np.zeros(len(self.program.names), dtype=bool)
        if not (self.rounds & self.closed).any():
            return Bends(bending, bending)
        motions = self.neutral_motions()
        if motions is None:
            return Bends(self.round_parts, self.program.free)
        if not motions.shape[1]:
            return Bends(bending, bending)
        flat = motions
        if curves and not self._moves_unknown(motions):
            values, axes = np.linalg.eigh(self._curvature(motions))
            # motions of length 1 at forces of 1, up to the accuracy of the coordinates
            least = max(BENDS, self.blur)
            falls, level = values < -least, np.abs(values) <= least
            bending |= self.round_parts & self._moved(motions @ axes[:, falls])
            flat = motions @ axes[:, level]
        bending |= self.round_parts & self._moved(self._harmful(flat))
        return Bends(bending, self._moved(motions))

    def _moved(self, motions: Array) -> Mask:
        """Mask of the parts that scaled motions, (n, d), move, shape (N,)."""
        moved = np.zeros(len(self.program.names), dtype=bool)
        by_part = np.abs(motions).reshape(int(self.program.free.sum()), -1)
        moved[self.program.free] = by_part.max(axis=1, initial=0.0) > np.sqrt(BENDS)
        return moved

    def _moves_unknown(self, motions: Array) -> bool:
        """True if motions move a pair at a pressed contact of unknown curvature."""
        if self.swings.torques[self.program.free].any():
            return True
        rows = np.flatnonzero(self.rounds & self.closed & ~self.joined)
        known = formed(self.program.taking(rows), self.features.take(rows))
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
        forms = np.nan_to_num(gap_forms(part, self.features.take(rows)))
        forms += joint_forms(part, self.assembly.joints)
        ends = [
            np.array([self._of_part(int(end), motions) for end in side]).reshape(
                len(rows), 6, motions.shape[1]
            )
            for side in (part.part_a, part.part_b)
        ]
        both = np.concatenate(ends, axis=1)
        total = -np.einsum("k,kai,kab,kbj->ij", self.forces[rows], both, forms, both)
        for k in np.flatnonzero(self.program.free & self.swings.forms.any(axis=(1, 2))).tolist():
            turn = self._of_part(k, motions)[3:]
            total += turn.T @ self.swings.forms[k] @ turn
        springs = spring_form(self.program, self.assembly.joints)
        if springs is not None:
            moved = self.scale[:, None] * motions
            total += moved.T @ springs @ moved
        length = float(self.program.radius[self.round_parts].max(initial=0.0))
        most = float(np.abs(self.forces[self.rounds]).max(initial=0.0))
        return np.asarray((total + total.T) / 2 * length / max(most, TINY))

    def _harmful(self, motions: Array) -> Array:
        """Rest of scaled motions, (n, d), that is no harmless motion of the round parts."""
        program = self.program
        touching = np.append(self.round_parts, False)
        rows = np.flatnonzero(self.closed & (touching[program.part_a] | touching[program.part_b]))
        part, features = program.taking(rows), self.features.take(rows)
        sides = touched_surfaces(part, features, self.contacts, self.assembly.joints)
        first, second = (self.fits.of_touched(side, rows) for side in sides)
        harmless = Harmless(
            self.assembly, self.contacts, part, features, (first, second), self.round_parts,
            self.swings, self.blur,
        )  # fmt: skip
        return harmless.rest_of(motions, self.scale)

    def _may_be_idle(self) -> Mask:
        """Mask of the rows whose forces the load does not need, shape (K,)."""
        program, idle = self.program, np.zeros(len(self.program.kind), dtype=bool)
        pair = body_pairs(program)
        for number in np.unique(pair[self.enclosed]):
            rows = np.flatnonzero(self.enclosed & (pair == number))
            force = self.forces[rows]
            resultant = np.abs(force @ wrenches(program, rows)).max()
            idle[rows] = resultant <= BENDS * np.abs(force).sum()
        for number in np.unique(pair[self.joined]):
            joint = np.flatnonzero(self.joined & (pair == number))
            rows = np.flatnonzero((program.kind == CONTACT) & (pair == number) & ~self.enclosed)
            if len(rows):
                both = wrenches(program, np.concatenate([joint, rows]))
                beyond = both[len(joint) :] @ null_space(both[: len(joint)], BENDS)
                size = np.linalg.norm(both[len(joint) :], axis=1)
                carried = np.linalg.norm(beyond, axis=1) <= BENDS * size
                idle[rows] = carried | stressed(beyond)
        return idle

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

    def neutral_motions(self) -> Array | None:
        """Basis of the motions that keep closed contacts, in scaled unknowns; None if too large."""
        program, per = self.program, len(self.program.freedoms)
        free = np.flatnonzero(program.free)
        fixed = np.append(~program.free | self.steady, True)
        between = fixed[program.part_a] & fixed[program.part_b] & ~self.rounds
        rows = np.flatnonzero(self.closed & ~between)
        touched = np.unique(np.concatenate([program.part_a[rows], program.part_b[rows]]))
        level = level_screws(program)[program.freedoms]
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


# Parts with flat faces that a motion without work tips: they stand exactly above an edge.


def tipping_parts(
    assembly: Assembly, contacts: ContactSet, program: Program, forces: Array, held: Mask
) -> Mask:
    """Mask of the free parts between flat faces that may tip without work, shape (N,).

    Arguments: `forces` (K,): forces of an equilibrium along the rows [N]; `held` (N,): parts that
    count as held.
    """
    tips = np.zeros(len(program.names), dtype=bool)
    for cluster in clusters(replace(program, free=program.free & ~held)):
        part, mine = cluster.program, forces[cluster.rows]
        rounds = round_rows(part, contacts)
        search = Bending(assembly, contacts, part, mine, rounds)
        loose = part.free & ~search.steady
        if not loose.any():
            continue
        still = _stuck_parts(part, search.presses & (part.mu > 0))
        flat = _stuck_parts(part, search.presses)  # these slide, and spin about the normal
        bent = rounds & search.closed
        ends = np.concatenate([part.part_a[bent], part.part_b[bent]])
        still[ends[ends >= 0]] = True
        still &= part.free
        if not still.any():
            tips |= _tipping(search, loose & ~flat)
        elif (loose & ~still).any():
            tips |= tipping_parts(assembly, contacts, part, mine, still)
    return tips


def _stuck_parts(program: Program, presses: Mask) -> Mask:
    """Mask of the free parts that pressed faces connect to held parts, (N,)."""
    rows = np.flatnonzero(presses & (program.kind == CONTACT))
    if not len(rows):
        return np.zeros_like(program.free)
    count = len(program.free)
    body = np.append(np.where(program.free, np.arange(count), count), count)
    pair = body_pairs(program)[rows]
    order = np.argsort(pair, kind="stable")
    ends = np.flatnonzero(np.diff(pair[order])) + 1
    fixed = [mine[0] for mine in np.split(rows[order], ends) if _wide(program, mine)]
    label = connected(count + 1, body[program.part_a[fixed]], body[program.part_b[fixed]])
    return np.asarray((label[:-1] == label[-1]) & program.free)


def _wide(program: Program, rows: Index) -> bool:
    """True if points span a line, or in space a plane, so that two bodies stuck there move alike.

    Points count as apart if they are so by a small fraction of the bodies' size.
    """
    points = program.point[rows]
    free = np.append(program.free, False)
    ends = np.concatenate([program.part_a[rows], program.part_b[rows]])
    size = float(program.radius[ends[free[ends]]].min())
    if program.planar:
        points = points[:, [0, 2]]
    values = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    need = 1 if program.planar else 2
    return len(values) >= need and bool(values[need - 1] > SLIPS * size)


def _tipping(search: Bending, loose: Mask) -> Mask:
    """Mask of the loose parts that a neutral motion may turn about an axis that is not vertical."""
    program = search.program
    motions = search.neutral_motions()
    if motions is None:
        return loose
    tips, per = np.zeros_like(loose), len(program.freedoms)
    unpressed = np.flatnonzero((program.kind == CONTACT) & ~search.closed)
    opened = program.taking(unpressed).jacobian() @ (search.scale[:, None] * motions)
    size = np.linalg.norm(opened, axis=1, keepdims=True)
    opened = np.divide(opened, size, where=size > BENDS * size.max(initial=0.0), out=0 * opened)
    axes = np.array([[0.0, 1.0, 0.0]]) if program.planar else np.vstack(across(program.down[None]))
    for number, k in enumerate(np.flatnonzero(program.free).tolist()):
        if loose[k]:
            mine = motions[per * number : per * (number + 1)]
            turns = axes[:, 1:2] @ mine[2:] if program.planar else axes @ mine[3:]
            tips[k] = any(_possible(opened, sense * turn) for turn in turns for sense in (1, -1))
    return tips


def _possible(opened: Array, turn: Array) -> bool:
    """True if no multipliers prove that a motion z with `opened` z >= 0 has `turn` z <= 0."""
    size = float(np.linalg.norm(turn))
    if size <= BENDS:
        return False
    return nonnegative(opened, -turn)[1] > BENDS * size
