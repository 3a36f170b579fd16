"""Harmless motions of round and jointed parts: they keep all gaps and the energy, to all orders.

In a harmless motion each part moves level, and spins about its centre of mass,

- its spin keeps all its touched surfaces in place, or is that of a part of revolution: a ball, a
  shaft in its bore
- its level motion against each part that it touches is a level motion that keeps the surface of
  the first part in place, and then one that keeps the surface of the second; or level lines cross:
  an edge over an edge or over a cylinder

Both motions must be level. A ball that rolls around a ball below also turns first about one centre
and then about the other, but neither turn is level: it falls.

A load off the centre of its part must keep its height, too: the part may only spin about the line
from its centre to the load. Under inclined loads, and under torques, no part may turn, because a
turn moves the centres along arcs.
"""

from __future__ import annotations

import numpy as np

from kilter.arrays import Array, Mask, across
from kilter.assembly import Assembly
from kilter.contact.contact_set import ContactSet
from kilter.mechanics.program import Program
from kilter.rigid import skew
from kilter.second_order.gaps.features import Features
from kilter.second_order.gaps.gap_form import formed
from kilter.second_order.gaps.joint_forms import Swings
from kilter.second_order.gaps.touched_surfaces import LINE, Touched
from kilter.second_order.motions.free_motions import spins_unseen
from kilter.second_order.motions.null_space import null_space
from kilter.second_order.second_order_tolerances import BENDS

ROUNDING = 1e-12
"""Size of a condition that is 0 up to rounding, over the largest [-]."""


class Harmless:
    """Harmless motions of the round and jointed parts of a cluster.

    Arguments: `part`: rows of the cluster that stay closed and that touch a round or jointed part;
    `rounds` (N,): round and jointed free parts; `blur`: relative accuracy of the coordinates [-].
    """

    def __init__(
        self,
        assembly: Assembly,
        contacts: ContactSet,
        part: Program,
        features: Features,
        touched: tuple[Touched, Touched],
        rounds: Mask,
        swings: Swings,
        blur: float,
    ) -> None:
        self.assembly, self.contacts, self.program = assembly, contacts, part
        self.rounds, self.swings, self.blur = rounds, swings, blur
        self.touched = touched
        self.origin = part.center[rounds].mean(axis=0)
        self.keeps = [side.conditions(self.origin, 1.0) for side in touched]
        self.level = level_screws(part)
        if swings.inclined[part.free].any() and not part.planar:
            self.level = self.level[:, :2]
        # level motions keep the distance of level lines that cross
        upright = np.linalg.norm(np.cross(part.normal, part.down), axis=1) < BENDS
        lines = (touched[0].kind == LINE) & (touched[1].kind == LINE)
        self.crossing = upright & lines & formed(part, features)

    def rest_of(self, motions: Array, scale: Array) -> Array:
        """Rest of scaled motions, (n, d), of the round parts that is not harmless.

        `scale`: displacement for a unit of each unknown, shape (n,).
        """
        program, per = self.program, len(self.program.freedoms)
        spanned, place = self._spanned(scale)
        rules = [
            self._level_rule(row, place, spanned.shape[1])
            for row in np.flatnonzero(~self.crossing).tolist()
        ]
        kept = np.repeat(self.rounds[program.free], per)
        alone = motions @ null_space(motions[kept], 1e-9)  # no round part moves
        pad = np.zeros((sum(len(rule) for rule in rules), alone.shape[1]))
        whole = np.hstack([np.vstack([spanned, *rules]), np.vstack([alone, pad])])
        right = np.vstack([motions, np.zeros((len(whole) - len(motions), motions.shape[1]))])
        found = np.linalg.lstsq(whole, right, rcond=1e-9)[0]
        rest = np.abs(whole @ found - right).max(axis=0, initial=0.0)
        off = rest > max(BENDS, self.blur)
        return np.where(kept[:, None], motions, 0.0)[:, off]

    def _spanned(self, scale: Array) -> tuple[Array, dict[int, slice]]:
        """Level motions and spins of all free parts as columns, (n, c), in scaled unknowns.

        The second result gives the columns of the level motions of each round part.
        """
        program, per = self.program, len(self.program.freedoms)
        blocks = []
        for k in np.flatnonzero(program.free).tolist():
            spins = self._spins(k) if self.rounds[k] else np.zeros((6, 0))
            blocks.append((k, np.hstack([self.level, spins])))
        spanned = np.zeros((len(scale), sum(screws.shape[1] for _, screws in blocks)))
        place: dict[int, slice] = {}
        column = 0
        for number, (k, screws) in enumerate(blocks):
            arm = program.center[k] - self.origin
            six = np.vstack([screws[:3] - skew(arm) @ screws[3:], screws[3:]])[program.freedoms]
            rows = slice(per * number, per * (number + 1))
            spanned[rows, column : column + screws.shape[1]] = six / scale[rows, None]
            if self.rounds[k]:
                place[k] = slice(column, column + self.level.shape[1])
            column += screws.shape[1]
        return spanned, place

    def _spins(self, k: int) -> Array:
        """Spins of a part about its centre of mass that keep its surfaces, as screws, (6, s)."""
        part, arm = self.program, self.program.center[k] - self.origin
        still = self.swings.conditions(k)
        mine = [self.keeps[0][i] for i in np.flatnonzero(part.part_a == k)]
        mine += [self.keeps[1][i] for i in np.flatnonzero(part.part_b == k)]
        stays = np.hstack([np.eye(3), -skew(arm)])
        loaded = np.hstack([np.zeros_like(still), still])
        spins = null_space(np.vstack([stays, loaded, *mine]), self.blur)
        own = self._own_spins(k, arm)
        return np.hstack([spins, own[:, np.abs(still @ own[3:]).max(axis=0, initial=0.0) < BENDS]])

    def _own_spins(self, part: int, arm: Array) -> Array:
        """Spins of a part of revolution about its axis, as screws (v, omega), shape (6, s).

        `arm`: vector from the origin of the screws to its centre of mass.
        """
        assembly = self.contacts.assembly
        fixed = [joint for joint in self.assembly.joints if joint.kind == "fixed"]
        names = {name for joint in fixed for name in joint.parts}
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

    def _level_rule(self, row: int, place: dict[int, slice], columns: int) -> Array:
        """Conditions, (c, columns), that the relative level motion at a row keeps a surface.

        The level motions of parts without curved contacts are not known, so none is required there.
        """
        part = self.program
        ends = int(part.part_a[row]), int(part.part_b[row])
        if not all(end < 0 or not part.free[end] or end in place for end in ends):
            return np.zeros((0, columns))
        kept = np.hstack([self._level_kept(side[row]) for side in self.keeps])
        outside = null_space(kept.T, 1e-9).T if kept.shape[1] else np.eye(self.level.shape[1])
        rule = np.zeros((len(outside), columns))
        for end, sense in zip(ends, (-1.0, 1.0), strict=True):
            if end in place:
                rule[:, place[end]] += sense * outside
        return rule

    def _level_kept(self, conditions: Array) -> Array:
        """Level motions that keep a surface, as columns of coefficients, (l, k)."""
        moved = conditions @ self.level
        rounding = ROUNDING * float(np.abs(conditions).max())
        return null_space(np.where(np.abs(moved) > rounding, moved, 0.0), 1e-9)


def level_screws(program: Program) -> Array:
    """Screws (v, omega) that move level, shape (6, 3), or (6, 1) in the plane."""
    down = program.down
    six = np.zeros((6, 3))
    if program.planar:
        six[:3, 0] = np.cross(down, [0.0, 1.0, 0.0])
        return six[:, :1]
    first, second = across(down[None])
    six[:3, 0], six[:3, 1], six[3:, 2] = first[0], second[0], down
    return six
