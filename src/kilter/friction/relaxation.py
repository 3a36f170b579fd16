"""Linear program whose feasible set contains every motion that obeys Coulomb's law.

The law (`kilter.friction.reduced_law`) is not convex: un fn = 0 at each point, and in each group
friction dissipates mu N |ut|. Given bounds of all its solutions (`kilter.friction.enclosure`), both
are replaced by linear rows that every solution satisfies. So the greatest power w.b of the program
bounds the power of every motion; if it is 0, no motion exists.

Motions are in units of a size e, b = a / e with |b| <= 1. The column l is 1; when the power is
maximised, it may be less. All rows are homogeneous in the columns, so x = 0 is feasible for all
bounds and modes, and no result depends on the infeasibility of a program. Upper bounds: U of un, F
of fn, S of |ut|, Nmin and Nmax of N. The rows:

    e b = l w + Jn^T fn + Jt^T ft,   un = Jn b,   ut = Jt b        the law's equations, and
    N = sum of fn of a group                                       its inequalities
    g_k = mu N + d_k.ft >= 0       the cone: exact in the plane, in space a polygon about it

    w.b >= e q + sum of mu D       power is kinetic energy and dissipation, with
    q >= 2 c.b - |c|^2 l           q = |b|^2 above its tangents at points c
    s >= d_k.ut                    s = |ut|
    D >= Nmin s                    D = N |ut| above its two tangent planes at the
    D >= Nmax s + S (N - Nmax l)   corners of the box of N and |ut|
    w.b <= e l,   N >= Nmin l

    un + (U/F) fn <= U l           *normal cut*: un = 0 or fn = 0
    d_k.ut + (S_k/G_k) g_k <= S_k l                 *tangential cut*, G_k a bound of g_k
    un1 + (U1/U2) un2 <= U1 l      *hinge*: in the plane, of the two ends of a patch with
                                   Nmin > 0, which cannot both open

The tangential cut: in the plane g_k (d_k.ut) = 0 for d_k.ut > 0, as a group that slides along d_k
has ft = -mu N d_k. In space let c be the cosine between ut and d_k: then g_k = (1 - c) mu N, and
the cut holds if S bounds the norm |ut| (not d_k.ut alone) and G_k both mu N and g_k. For c >= 0 it
reads c |ut|/S + (1 - c) mu N/G <= 1; for c < 0 the first term is negative.

*Sectors*, in space. If the twist of a patch lies in a cone for which ut of a group points between
two directions less than half a turn apart, -ft / (mu N) lies in the circular segment between them.
The chord of the segment, the two sides of the sector and three tangents of the circle are rows.
They contain the segment, and so every true solution, except the twist 0, which is a separate case.
"""

from __future__ import annotations

import numpy as np

from kilter.arrays import TINY, Array, Index
from kilter.friction.enclosure import Enclosure, largest_speeds, sector, widened
from kilter.friction.reduced_law import ReducedLaw
from kilter.friction.template import MatrixTemplate
from kilter.solvers.problem import LinearProgram

SIDES = 8
"""Number of sides of the polygon circumscribed about the friction circle. A larger value gives
tighter bounds and larger programs.
"""
TANGENTS, TANGENTS_IN_PLANE = 12, 6
"""Number of tangents of the ball of accelerations that are kept, by their points c, in space and in
the plane. Each fills a row; with 12 in the plane, fewer arches are proved with the same work.
"""
SEGMENT_SIDES = 6
"""Number of rows of a circular segment: chord, two sides of its sector, three tangents of the
circle.
"""


class Relaxation:
    """Linear relaxation of a contact law; bounds and contact modes enter as numbers.

    - `directions` (m, T): the d_k across a contact: in the plane both signs, in space `SIDES`
      around.
    - `fastest`: largest speeds of contact points in motions of size 1.
    - `tangents`: number of tangents of the ball of accelerations.
    - `columns`: slices of the columns: "motion" b, "one" l, "square" q, "fn", "un", "ft", "ut",
      "slip" s, "loss" D, "total" N, "rest" g, "twist" t of flat patches in space.
    """

    def __init__(self, law: ReducedLaw) -> None:
        self.law = law
        self.directions = _directions(law)
        self.fastest = largest_speeds(law, self.directions)
        self.tangents = TANGENTS_IN_PLANE if law.directions == 1 else TANGENTS
        groups, wide = len(law.mu), len(law.mu) * law.directions
        points = len(law.group)
        # a twist that differs from the ut of a group has separate columns
        is_planar = [law.directions == 2 and rows.shape[0] == 3 for rows in law.twist]
        self._template = MatrixTemplate({
            "motion": len(law.load), "one": 1, "square": 1, "fn": points, "un": points,
            "ft": wide, "ut": wide, "slip": groups, "loss": groups, "total": groups,
            "rest": groups * len(self.directions), "twist": 3 * sum(is_planar),
        })  # fmt: skip
        self.columns, self.width = self._template.columns, self._template.width
        self._of = self._template.of
        self._ut, self._ft = (
            self._of(name).reshape(groups, law.directions) for name in ("ut", "ft")
        )
        self._own_twist, self.twist_columns = (
            np.array(is_planar, dtype=bool),
            self._columns_of_twists(is_planar),
        )
        self._patch_ends = _patch_ends(law)
        self._add_dynamics()
        self._add_power()
        self._add_kinematics()
        self._add_friction()
        self._add_cuts()
        self._add_sectors()
        self._template.finish()
        self._twist_reach = np.concatenate([
            np.empty(0),
            *(np.sqrt(np.asarray(rows.multiply(rows).sum(axis=1)).ravel())
              for rows, alone in zip(law.twist, is_planar, strict=True) if alone),
        ])  # fmt: skip

    # rows ------------------------------------------------------------------------------------

    def _columns_of_twists(self, is_planar: list[bool]) -> list[Index]:
        """Add the columns for the relative twist of each patch."""
        columns, place = [], self.columns["twist"].start
        for patch, alone in enumerate(is_planar):
            if alone:
                columns.append(place + np.arange(3))
                place += 3
            else:
                columns.append(self._ut[np.flatnonzero(self.law.patch == patch)[0]])
        return columns

    def _add_dynamics(self) -> None:
        """Add the rows of the equations of motion, e b = l w + Jn^T fn + Jt^T ft."""
        law, add = self.law, self._template
        rows = add.rows(len(law.load), "=")
        add.put(rows, self._of("motion"), 1.0, "scale")
        add.put(rows, self._of("one")[0], -law.load)
        add.put_matrix(rows, "fn", law.normal.T, -1.0)
        add.put_matrix(rows, "ft", law.tangent.T, -1.0)

    def _add_power(self) -> None:
        """Add the rows of the power w.b: friction dissipates, and |b|^2 is bounded by tangents."""
        law, add = self.law, self._template
        row = add.rows(1, ">")
        add.put(row, self._of("motion"), law.load)
        add.put(row, self._of("square"), -1.0, "kinetic")
        add.put(row, self._of("loss"), -law.mu)
        row = add.rows(1, "<")
        add.put(row, self._of("motion"), law.load)
        add.put(row, self._of("one"), -1.0, "power")
        rows = add.rows(self.tangents, ">")
        add.put(rows, self._of("square"), 1.0)
        add.put(rows[:, None], self._of("motion")[None], 0.0, "tangents")
        add.put(rows, self._of("one"), 0.0, "heights")

    def _add_kinematics(self) -> None:
        """Add the rows of the speeds: un = Jn b, ut = Jt b; of a flat patch through its twist."""
        law, add = self.law, self._template
        rows = add.rows(len(law.group), "=")
        add.put(rows, self._of("un"), 1.0)
        add.put_matrix(rows, "motion", law.normal, -1.0)
        for patch in np.flatnonzero(self._own_twist):
            rows = add.rows(3, "=")
            add.put(rows, self.twist_columns[patch], 1.0)
            add.put_matrix(rows, "motion", law.twist[patch], -1.0)
        direct = ~self._own_twist[law.patch]
        rows = add.rows(int(direct.sum()) * law.directions, "=")
        add.put(rows, self._ut[direct].ravel(), 1.0)
        add.put_matrix(rows, "motion", law.tangent[np.repeat(direct, law.directions)], -1.0)
        for group in np.flatnonzero(~direct):
            rows = add.rows(law.directions, "=")
            add.put(rows, self._ut[group], 1.0)
            columns = self.twist_columns[law.patch[group]]
            add.put(rows[:, None], columns[None], -law.lever[group])

    def _add_friction(self) -> None:
        """Add the rows of friction limits: force sums N, and reserves g_k = mu N + d_k.ft."""
        law, add = self.law, self._template
        groups, sides = len(law.mu), len(self.directions)
        rows = add.rows(groups, "=")
        add.put(rows, self._of("total"), 1.0)
        rough = np.flatnonzero(law.group >= 0)
        add.put(rows[law.group[rough]], self._of("fn")[rough], -1.0)
        rows = add.rows(groups * sides, "=").reshape(groups, sides)
        add.put(rows, self._of("rest").reshape(groups, sides), 1.0)
        add.put(rows, self._of("total")[:, None], -law.mu[:, None])
        add.put(rows[:, :, None], self._ft[:, None, :], -self.directions[None])

    def _add_cuts(self) -> None:
        """Add the rows that limit sliding speeds, dissipated power and normal forces by bounds."""
        add, groups, sides = self._template, len(self.law.mu), len(self.directions)
        unit_column, ut, slip = self._of("one")[0], self._ut[:, None, :], self._of("slip")
        rows = add.rows(len(self.law.group), "<")
        add.put(rows, self._of("un"), 1.0)
        add.put(rows, self._of("fn"), 0.0, "normal force")
        add.put(rows, unit_column, 0.0, "normal one")
        rows = add.rows(len(self._patch_ends), "<")
        add.put(rows, self._of("un")[self._patch_ends[:, 0]], 1.0)
        add.put(rows, self._of("un")[self._patch_ends[:, 1]], 0.0, "hinge")
        add.put(rows, unit_column, 0.0, "hinge one")
        rows = add.rows(groups * sides, "<").reshape(groups, sides)
        add.put(rows[:, :, None], ut, self.directions[None])
        add.put(rows, self._of("rest").reshape(groups, sides), 0.0, "tangential force")
        add.put(rows, unit_column, 0.0, "tangential one")
        rows = add.rows(groups * sides, ">").reshape(groups, sides)
        add.put(rows, slip[:, None], 1.0)
        add.put(rows[:, :, None], ut, -self.directions[None])
        rows = add.rows(groups, ">")
        add.put(rows, self._of("loss"), 1.0)
        add.put(rows, slip, 0.0, "loss least")
        rows = add.rows(groups, ">")
        add.put(rows, self._of("loss"), 1.0)
        add.put(rows, slip, 0.0, "loss most")
        add.put(rows, self._of("total"), 0.0, "loss total")
        add.put(rows, unit_column, 0.0, "loss one")
        rows = add.rows(groups, ">")
        add.put(rows, self._of("total"), 1.0)
        add.put(rows, unit_column, 0.0, "least")

    def _add_sectors(self) -> None:
        """In space, add the rows of twist cones and of sectors of sliding directions."""
        add, groups = self._template, len(self.law.mu)
        if self.law.directions == 1:
            return
        for patch, columns in enumerate(self.twist_columns):
            rows = add.rows(len(columns), ">")
            add.put(rows[:, None], columns[None], 0.0, f"cone {patch}")
        rows = add.rows(groups * SEGMENT_SIDES, "<").reshape(groups, SEGMENT_SIDES)
        add.put(rows[:, :, None], self._ft[:, None, :], 0.0, "segment")
        add.put(rows, self._of("total")[:, None], 0.0, "segment total")
        rows = add.rows(groups, ">")
        add.put(rows, self._of("slip"), 1.0)
        add.put(rows[:, None], self._ut, 0.0, "along")

    # numbers ---------------------------------------------------------------------------------

    def program(self, bounds: Enclosure) -> LinearProgram:
        """The linear program for given bounds and contact modes: minimise -w.b."""
        lower, upper = self._column_bounds(bounds)
        cost = np.zeros(self.width)
        cost[self.columns["motion"]] = -self.law.load
        add = self._template
        matrix = add.matrix(self._entry_values(bounds))
        return LinearProgram(cost, matrix, add.lower, add.upper, lower, upper)

    def named(self, x: Array) -> dict[str, Array]:
        """Values of a solution x by the names of its columns."""
        return {name: x[part] for name, part in self.columns.items()}

    def _entry_values(self, b: Enclosure) -> dict[str, Array | float]:
        """Values of the matrix entries that depend on the bounds, by name."""
        values: dict[str, Array | float] = {
            "scale": b.scale,
            "kinetic": -b.scale,
            "power": -b.scale,
            "tangents": -2 * b.tangents,
            "heights": (b.tangents**2).sum(axis=1),
            "loss least": -b.least,
            "least": -b.least,
            "normal one": -b.un,
            "tangential one": -b.ut,
        }
        first, second = b.un[self._patch_ends].T
        hinged = (b.least[self.law.group[self._patch_ends[:, 0]]] > 0) & (first > 0) & (second > 0)
        values["hinge"] = np.where(hinged, first / np.where(hinged, second, 1.0), 0.0)
        values["hinge one"] = -first
        if self.law.directions == 2:
            values |= self._sector_values(b)
        if not b.cuts:
            return values
        values |= {"loss most": -b.most, "loss total": -b.slip, "loss one": b.slip * b.most}
        # for F < U the cut would have a large coefficient: use un + fn <= 2 U, which is inactive
        values["normal force"] = b.un / np.maximum(b.fn, np.maximum(b.un, TINY))
        values["normal one"] = -b.un * (1 + (b.fn < b.un))
        force = np.maximum(b.rest, np.maximum(b.ut, TINY))
        values["tangential force"] = b.ut / force
        values["tangential one"] = -b.ut * (1 + (b.rest < b.ut))
        return values

    def _sector_values(self, b: Enclosure) -> dict[str, Array | float]:
        """Values of the entries for twist cones and for circular segments of groups, by name."""
        groups = len(self.law.mu)
        values: dict[str, Array | float] = {}
        segment, total = np.zeros((groups, SEGMENT_SIDES, 2)), np.zeros((groups, SEGMENT_SIDES))
        along = np.zeros((groups, 2))
        for patch, cone in enumerate(b.cones):
            size = len(self.twist_columns[patch])
            if cone is None or not cone.size:
                values[f"cone {patch}"] = np.zeros((size, size))
                continue
            cone = widened(cone)
            values[f"cone {patch}"] = np.asarray(np.linalg.inv(cone), dtype=np.float64)
            for group in np.flatnonzero(self.law.patch == patch):
                group_sector = sector(cone, self.law.lever[group])
                if group_sector is not None:
                    segment[group], total[group] = _segment(*group_sector)
                    along[group] = group_sector[0]
        values["segment"] = segment
        values["segment total"] = total * self.law.mu[:, None]
        values["along"] = -along
        return values

    def _column_bounds(self, b: Enclosure) -> tuple[Array, Array]:
        """Lower and upper bounds of the columns of the program."""
        lower, upper = np.zeros(self.width), np.zeros(self.width)
        at, wide = self.columns, self.law.directions
        lower[at["motion"]], upper[at["motion"]] = -1.0, 1.0
        upper[at["one"]] = upper[at["square"]] = 1.0
        upper[at["fn"]], upper[at["un"]] = b.fn, b.un
        force = np.repeat(self.law.mu * b.most, wide)
        lower[at["ft"]], upper[at["ft"]] = -force, force
        if wide == 1:
            lower[at["ut"]], upper[at["ut"]] = -b.ut[:, 1], b.ut[:, 0]
        else:
            size = np.repeat(b.slip, wide)
            lower[at["ut"]], upper[at["ut"]] = -size, size
        upper[at["slip"]], upper[at["total"]] = b.slip, b.most
        upper[at["loss"]] = b.slip * b.most
        upper[at["rest"]] = b.rest.ravel()
        lower[at["twist"]], upper[at["twist"]] = -self._twist_reach, self._twist_reach
        for patch, cone in enumerate(b.cones):
            if cone is not None and not cone.size:
                sticking = self.twist_columns[patch]
                lower[sticking] = upper[sticking] = 0.0
        return lower, upper


def _directions(law: ReducedLaw) -> Array:
    """Tangent directions along which friction is bounded by the relaxation, shape (m, T)."""
    if law.directions == 1:
        return np.array([[1.0], [-1.0]])
    angle = 2 * np.pi * np.arange(SIDES) / SIDES
    return np.stack([np.cos(angle), np.sin(angle)], axis=1)


def _patch_ends(law: ReducedLaw) -> Index:
    """Indices of the two points of each group that has two, in the plane, shape (E, 2)."""
    order = np.argsort(law.group, kind="stable")
    members = np.bincount(law.group + 1, minlength=len(law.mu) + 1)[law.group[order] + 1]
    paired = order[(members == 2) & (law.group[order] >= 0) & (law.directions == 1)]
    ends: Index = paired.reshape(-1, 2)
    return ends


def _segment(middle: Array, half: float) -> tuple[Array, Array]:
    """Constraint rows that keep friction in a circular segment opposite to the sliding."""
    turn = np.array([[np.cos(half), -np.sin(half)], [np.sin(half), np.cos(half)]])
    left, right = turn @ middle, turn.T @ middle
    # -ft = mu N d: d.middle >= cos(half); d right of `left`, left of `right`; d.x <= 1
    rows = np.array([middle, [left[1], -left[0]], [-right[1], right[0]], -middle, -left, -right])
    return rows, np.array([np.cos(half), 0.0, 0.0, -1.0, -1.0, -1.0])
