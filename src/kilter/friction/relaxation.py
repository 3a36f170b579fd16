"""A linear program that contains every motion that obeys Coulomb's contact law.

With the bounds of `kilter.friction.enclosure` (they hold for every solution (a, f) of the
law of `kilter.friction.reduced_law` that is asked about), e for the size of a, b = a / e,
and l for 1 (or less: all rows are homogeneous, so that x = 0 is feasible whatever the modes,
and no answer rests on a claim that a program is infeasible), the rows are, each implied by
the law and by the bounds:

    e b = l w + Jn^T fn + Jt^T ft,   un = Jn b,   ut = Jt b,   N = sum of fn of a group
    g_k = mu N + d_k.ft >= 0                  cone: exact in the plane, circumscribed in space
    un + (U/F) fn <= U l                      un fn = 0, un <= U, fn <= F
    d_k.ut + (S_k/G_k) g_k <= S_k l           see below
    s >= d_k.ut,  D >= Nmin s,  D >= Nmax s + S (N - Nmax l)      s = |ut|, D = N |ut|
    w.b >= e q + sum of mu D,   q >= 2 c.b - |c|^2 l              q = |b|^2, at points c
    N >= Nmin l,   w.b <= e l
    un1 + (U1/U2) un2 <= U1 l   in the plane, of the two ends of a patch with Nmin > 0, which
                                cannot both open

The tangential cut: in the plane g_k ut_k+ = 0, as where it slides along d_k, ft = -mu N d_k.
In space let c be the cosine between ut and d_k: then g_k = (1 - c) mu N, and the cut holds if
S bounds the norm |ut| (not d_k.ut alone) and G_k both mu N and g_k: for c >= 0 it says
c |ut|/S + (1 - c) mu N/G <= 1, for c < 0 the first term is negative.

Where the twist of a patch lies in a cone that makes ut of a group point between two
directions less than half a turn apart, -ft / (mu N) lies in the circular segment between
them; its chord, the two sides of the sector and three tangents of the circle are rows. They
contain the segment: every true solution is in. Twist 0 is not: it is a case of its own.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import csc_array, csr_array

from kilter.arrays import TINY, Array, Index
from kilter.friction.enclosure import Enclosure, largest_speeds, sector, widened
from kilter.friction.reduced_law import ReducedLaw
from kilter.solvers.problem import LinearProgram

__all__ = ["Relaxation", "directions_of"]


SIDES = 8
"""Sides of the polygon circumscribed about the friction circle."""
TANGENTS = 12
"""Tangents of the ball of accelerations that are kept."""


def directions_of(law: ReducedLaw) -> Array:
    """The directions d_k across a contact, shape (m, T)."""
    if law.directions == 1:
        return np.array([[1.0], [-1.0]])
    angle = 2 * np.pi * np.arange(SIDES) / SIDES
    return np.stack([np.cos(angle), np.sin(angle)], axis=1)


class Relaxation:
    """Columns and rows of the program for one law; bounds and modes fill in the numbers.

    Parameters
    ----------
    law : ReducedLaw

    Attributes
    ----------
    fastest : LargestSpeeds
        Of contact points in motions of size 1.
    columns : dict
        Slices of the columns: motion b, one l, q, fn, un, ft, ut, s, d, total N, g, twist.
    """

    def __init__(self, law: ReducedLaw) -> None:
        self.law = law
        self.directions = directions_of(law)
        n, points = len(law.load), len(law.group)
        groups, sides = len(law.mu), len(self.directions)
        self.sizes = (n, points, groups, law.directions, sides)
        wide = groups * law.directions
        self._twist_at, spare = self._twists()
        lengths = {
            "motion": n, "one": 1, "square": 1, "fn": points, "un": points, "ft": wide,
            "ut": wide, "slip": groups, "loss": groups, "total": groups,
            "rest": groups * sides, "twist": spare,
        }  # fmt: skip
        ends = np.cumsum([0, *lengths.values()])
        self.columns = {
            name: slice(int(a), int(b))
            for name, a, b in zip(lengths, ends[:-1], ends[1:], strict=True)
        }
        self.width = int(ends[-1])
        self._blocks: list[tuple[Index, Index, Array]] = []
        self._places: dict[str, slice] = {}
        self._kinds: list[tuple[str, int]] = []
        self._height = self._filled = 0
        self._twist_columns = [
            self._of("ut")[at] if own else self._of("twist")[at] for own, at in self._twist_at
        ]
        order = np.argsort(law.group, kind="stable")
        double = np.bincount(law.group + 1, minlength=groups + 1)[law.group[order] + 1] == 2
        chosen = order[double & (law.group[order] >= 0) & (law.directions == 1)]
        self._ends = chosen.reshape(-1, 2)
        self._dynamics()
        self._kinematics()
        self._friction()
        self._cuts()
        self._sectors()
        self._assemble()
        self.fastest = largest_speeds(law, self.directions)
        own = [np.sqrt(np.asarray(rows.multiply(rows).sum(axis=1)).ravel()) for rows in law.twist]
        self._twist_reach = np.concatenate(
            [
                np.empty(0),
                *(far for far, (same, _) in zip(own, self._twist_at, strict=True) if not same),
            ]
        )

    def _of(self, name: str) -> Index:
        part = self.columns[name]
        return np.arange(part.start, part.stop)

    def _twists(self) -> tuple[list[tuple[bool, Index]], int]:
        """For each patch: whether its twist is ut itself, and where; extra columns."""
        law, found, spare = self.law, [], 0
        for patch, rows in enumerate(law.twist):
            members = np.flatnonzero(law.patch == patch)
            if law.directions == 2 and rows.shape[0] == 3:
                found.append((False, spare + np.arange(3)))
                spare += 3
            else:
                found.append((True, members[0] * law.directions + np.arange(law.directions)))
        return found, spare

    def _rows(self, count: int, kind: str) -> Index:
        """Numbers of `count` new rows; kind "=" 0, ">" >= 0, "<" <= 0."""
        at = self._height + np.arange(count)
        self._kinds.append((kind, count))
        self._height += count
        return at

    def _put(self, rows: Index, columns: Index, values: object, name: str = "") -> None:
        """Entries; named ones are set anew for each program."""
        rows, columns = np.broadcast_arrays(rows, columns)
        data = np.broadcast_to(np.asarray(values, dtype=np.float64), rows.shape)
        self._blocks.append((rows.ravel(), columns.ravel(), data.ravel()))
        if name:
            self._places[name] = slice(self._filled, self._filled + rows.size)
        self._filled += rows.size

    def _put_matrix(self, rows: Index, matrix: csr_array, start: int, sign: float) -> None:
        coo = matrix.tocoo()
        self._put(rows[coo.row], start + coo.col, sign * coo.data)

    def _dynamics(self) -> None:
        law, n = self.law, len(self.law.load)
        rows = self._rows(n, "=")
        self._put(rows, self._of("motion"), 1.0, "scale")
        self._put(rows, self._of("one")[0], -law.load)
        self._put_matrix(rows, csr_array(law.normal.T), self.columns["fn"].start, -1.0)
        self._put_matrix(rows, csr_array(law.tangent.T), self.columns["ft"].start, -1.0)
        row = self._rows(1, ">")
        self._put(row, self._of("motion"), law.load)
        self._put(row, self._of("square"), -1.0, "kinetic")
        self._put(row, self._of("loss"), -law.mu)
        row = self._rows(1, "<")
        self._put(row, self._of("motion"), law.load)
        self._put(row, self._of("one"), -1.0, "power")
        rows = self._rows(TANGENTS, ">")
        self._put(rows, self._of("square"), 1.0)
        self._put(rows[:, None], self._of("motion")[None], 0.0, "tangents")
        self._put(rows, self._of("one"), 0.0, "heights")

    def _kinematics(self) -> None:
        law = self.law
        rows = self._rows(len(law.group), "=")
        self._put(rows, self._of("un"), 1.0)
        self._put_matrix(rows, law.normal, self.columns["motion"].start, -1.0)
        wide, own = law.directions, np.zeros(len(law.mu), dtype=bool)
        for patch, (same, at) in enumerate(self._twist_at):
            own[law.patch == patch] = same
            if not same:
                rows = self._rows(3, "=")
                self._put(rows, self._of("twist")[at], 1.0)
                self._put_matrix(rows, law.twist[patch], self.columns["motion"].start, -1.0)
        ut = self._of("ut").reshape(-1, wide)
        rows = self._rows(int(own.sum()) * wide, "=")
        self._put(rows, ut[own].ravel(), 1.0)
        chosen = np.repeat(own, wide)
        self._put_matrix(rows, law.tangent[chosen], self.columns["motion"].start, -1.0)
        for group in np.flatnonzero(~own):
            rows = self._rows(wide, "=")
            self._put(rows, ut[group], 1.0)
            columns = self._twist_columns[law.patch[group]]
            self._put(rows[:, None], columns[None], -law.lever[group])

    def _friction(self) -> None:
        law, (_, _, groups, wide, sides) = self.law, self.sizes
        rows = self._rows(groups, "=")
        self._put(rows, self._of("total"), 1.0)
        rough = np.flatnonzero(law.group >= 0)
        self._put(rows[law.group[rough]], self._of("fn")[rough], -1.0)
        rows = self._rows(groups * sides, "=").reshape(groups, sides)
        self._put(rows, self._of("rest").reshape(groups, sides), 1.0)
        self._put(rows, self._of("total")[:, None], -law.mu[:, None])
        ft = self._of("ft").reshape(groups, wide)
        self._put(rows[:, :, None], ft[:, None, :], -self.directions[None])

    def _cuts(self) -> None:
        _, points, groups, wide, sides = self.sizes
        one, ut = self._of("one")[0], self._of("ut").reshape(groups, wide)
        rows = self._rows(points, "<")
        self._put(rows, self._of("un"), 1.0)
        self._put(rows, self._of("fn"), 0.0, "normal force")
        self._put(rows, one, 0.0, "normal one")
        ends = self._ends
        rows = self._rows(len(ends), "<")
        self._put(rows, self._of("un")[ends[:, 0]], 1.0)
        self._put(rows, self._of("un")[ends[:, 1]], 0.0, "hinge")
        self._put(rows, one, 0.0, "hinge one")
        rows = self._rows(groups * sides, "<").reshape(groups, sides)
        self._put(rows[:, :, None], ut[:, None, :], self.directions[None])
        self._put(rows, self._of("rest").reshape(groups, sides), 0.0, "tangential force")
        self._put(rows, one, 0.0, "tangential one")
        rows = self._rows(groups * sides, ">").reshape(groups, sides)
        self._put(rows, self._of("slip")[:, None], 1.0)
        self._put(rows[:, :, None], ut[:, None, :], -self.directions[None])
        rows = self._rows(groups, ">")
        self._put(rows, self._of("loss"), 1.0)
        self._put(rows, self._of("slip"), 0.0, "loss least")
        rows = self._rows(groups, ">")
        self._put(rows, self._of("loss"), 1.0)
        self._put(rows, self._of("slip"), 0.0, "loss most")
        self._put(rows, self._of("total"), 0.0, "loss total")
        self._put(rows, one, 0.0, "loss one")
        rows = self._rows(groups, ">")
        self._put(rows, self._of("total"), 1.0)
        self._put(rows, one, 0.0, "least")

    def _sectors(self) -> None:
        """In space: cones of twists (3 rows a patch), sectors of groups (6 + 1 rows)."""
        _, _, groups, wide, _ = self.sizes
        if wide == 1:
            return
        for patch, columns in enumerate(self._twist_columns):
            rows = self._rows(len(columns), ">")
            self._put(rows[:, None], columns[None], 0.0, f"cone {patch}")
        ft, ut = self._of("ft").reshape(groups, wide), self._of("ut").reshape(groups, wide)
        rows = self._rows(groups * 6, "<").reshape(groups, 6)
        self._put(rows[:, :, None], ft[:, None, :], 0.0, "segment")
        self._put(rows, self._of("total")[:, None], 0.0, "segment total")
        rows = self._rows(groups, ">")
        self._put(rows, self._of("slip"), 1.0)
        self._put(rows[:, None], ut, 0.0, "along")

    def _assemble(self) -> None:
        row, column, self._data = (
            np.concatenate([block[k] for block in self._blocks]) for k in range(3)
        )
        self._blocks = []
        order = np.lexsort((row, column))
        self._order = order
        self._index = row[order].astype(np.int32)
        starts = np.searchsorted(column[order], np.arange(self.width + 1))
        self._start = starts.astype(np.int32)
        kind = np.concatenate([np.full(count, ord(name)) for name, count in self._kinds])
        self._lower = np.where(kind == ord("<"), -np.inf, 0.0)
        self._upper = np.where(kind == ord(">"), np.inf, 0.0)

    def program(self, bounds: Enclosure, cost: Array | None = None) -> LinearProgram:
        """The linear program for bounds and modes; `cost` of all columns, to be minimised.

        Without `cost` the power w.b is maximised.
        """
        data = self._data.copy()
        for name, value in self._numbers(bounds).items():
            data[self._places[name]] = np.ravel(value) if np.ndim(value) else value
        matrix = csc_array(
            (data[self._order], self._index, self._start), shape=(self._height, self.width)
        )
        lower, upper = self._limits(bounds)
        if cost is None:
            cost = self.power()
        return LinearProgram(cost, matrix, self._lower, self._upper, lower, upper)

    def power(self) -> Array:
        """The cost whose minimum is the greatest power."""
        cost = np.zeros(self.width)
        cost[self.columns["motion"]] = -self.law.load
        return cost

    def _numbers(self, b: Enclosure) -> dict[str, Array | float]:
        """Values of the named entries."""
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
        first, second = b.un[self._ends].T
        one_closed = (b.least[self.law.group[self._ends[:, 0]]] > 0) & (first > 0) & (second > 0)
        values["hinge"] = np.where(one_closed, first / np.where(one_closed, second, 1.0), 0.0)
        values["hinge one"] = -first
        if self.law.directions == 2:
            values |= self._sector_numbers(b)
        if not b.cuts:
            return values
        values |= {"loss most": -b.most, "loss total": -b.slip, "loss one": b.slip * b.most}
        values["normal force"] = b.un / np.maximum(b.fn, np.maximum(b.un, TINY))
        values["normal one"] = -b.un * (1 + (b.fn < b.un))
        force = np.maximum(b.rest, np.maximum(b.ut, TINY))
        values["tangential force"] = b.ut / force
        values["tangential one"] = -b.ut * (1 + (b.rest < b.ut))
        return values

    def _sector_numbers(self, b: Enclosure) -> dict[str, Array | float]:
        groups = len(self.law.mu)
        values: dict[str, Array | float] = {}
        segment, total, along = (
            np.zeros((groups, 6, 2)),
            np.zeros((groups, 6)),
            np.zeros((groups, 2)),
        )
        for patch, cone in enumerate(b.cones):
            size = len(self._twist_columns[patch])
            if cone is None or not cone.size:
                values[f"cone {patch}"] = np.zeros((size, size))
                continue
            cone = widened(cone)
            values[f"cone {patch}"] = np.asarray(np.linalg.inv(cone), dtype=np.float64)
            for group in np.flatnonzero(self.law.patch == patch):
                found = sector(cone, self.law.lever[group])
                if found is not None:
                    segment[group], total[group], along[group] = _segment(*found)
        values["segment"] = segment
        values["segment total"] = total * self.law.mu[:, None]
        values["along"] = -along
        return values

    def _limits(self, b: Enclosure) -> tuple[Array, Array]:
        """Bounds of the columns."""
        lower, upper = np.zeros(self.width), np.zeros(self.width)
        at = self.columns
        wide = self.sizes[3]
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
                held = self._twist_columns[patch]
                lower[held] = upper[held] = 0.0
        return lower, upper

    def named(self, x: Array) -> dict[str, Array]:
        """A solution by the names of its columns."""
        return {name: x[where] for name, where in self.columns.items()}


def _segment(middle: Array, half: float) -> tuple[Array, Array, Array]:
    """Rows n.ft + c mu N <= 0 of a circular segment, and its middle direction."""
    turn = np.array([[np.cos(half), -np.sin(half)], [np.sin(half), np.cos(half)]])
    left, right = turn @ middle, turn.T @ middle
    # -ft = mu N d: d.middle >= cos(half); d right of `left`, left of `right`; d.x <= 1
    rows = np.array([middle, [left[1], -left[0]], [-right[1], right[0]], -middle, -left, -right])
    return rows, np.array([np.cos(half), 0.0, 0.0, -1.0, -1.0, -1.0]), middle
