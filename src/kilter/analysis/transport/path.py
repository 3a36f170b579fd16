"""Largest speed factor of a carrier path before a part of the assembly moves.

At every sample the carrier has an orientation R and accelerations (a, al, O) in its own frame.
Faster by a factor k, the accelerations grow by k^2, and gravity R^T g does not change. The load

    z_still + lam z_move,      lam = k^2,     z_still = (R^T g, 0, 0),   z_move = (-a, al, O)

is carried iff contact forces balance it. The carried z form a convex cone. Each motion m that no
contact stops gives a plane around the cone, and with it a bound at every sample at once:

    q = C^T m,    q . (z_still + lam z_move) <= b      so     lam <= (b - q.z_still) / q.z_move

with b = 0 without loads and bonds, which are fixed in the carrier.

The search computes the exact limit at the sample with the least bound, adds its motion, and repeats
until the bound is attained. Then it confirms the other samples: a positive combination of carried
loads is carried, since the same combination of their forces balances it. For many samples, the
farthest carried loads along each component of z are computed once, so that combinations fill the
space around a sample at rest. Samples that are no such combination get a limit of their own.

Between samples of a straight path at fixed orientation, with accelerations that change linearly,
the load lies on the chord of two carried loads and is carried. Other paths are proved at their
samples only.

References
----------
J. E. Bobrow, S. Dubowsky, J. S. Gibson, Time-optimal control of robotic manipulators along
specified paths, 1985: limits of lam = k^2 along a path.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated

import numpy as np

from kilter.analysis.analysis_tolerances import NOT_HELD
from kilter.analysis.load_limit import (
    Limit,
    NoLimit,
    SharedCones,
    find_limit,
)
from kilter.analysis.transport.carrier import load_matrix
from kilter.analysis.transport.carrier_path import CarrierPath
from kilter.arrays import Array, Mask
from kilter.mechanics.nonnegative import nonnegative
from kilter.mechanics.program import Program
from kilter.tell.record import InPython, OrNull, Record, Shape, key

FASTEST = 1e4
"""Largest squared speed factor of the search [-]."""
AGREES = 1e-7
"""Relative difference of bound and attained limit at which the search ends [-]."""
MANY = 30
"""Number of samples without a proof from which on the rooms around one are computed first."""
ROOM = 10.0
"""Largest multiple of the change of a load component along a path for which rooms are computed."""
SURE = 1e-6
"""Relative distance below the limit at which all samples are confirmed [-]."""
LEFT = 1e-9
"""Largest residual of a combination of carried loads, relative to the weight [-]."""


class PathLimit(Record):
    """Largest factor on the speed along a path at which contact forces can hold the parts."""

    factor: OrNull
    """Largest speed factor [-]; infinite without a limit, 0 if a part moves at any speed."""
    lower: OrNull
    """Factor up to which every sample is proved to be carried [-]."""
    slowest: float
    """Factor below which a part slides [-]; 0 if it is carried at rest."""
    time: float | None
    """Time of the path at which a part moves first [s]."""
    between_samples: bool
    """Whether the factor is also proved between the samples."""
    factors: Annotated[Array, Shape(None, infinite=True)]
    """Upper bound of the factor at every sample [-]."""
    path: InPython[CarrierPath]
    """The path."""
    limit: InPython[Limit | None]
    """Forces and mechanism of the first motion."""
    programs: InPython[int]
    """Number of limits that were computed."""
    rows: InPython[Array]
    """Planes around the carried loads z = (g - a, al, O): ``rows @ z <= levels``, shape (m, 12)."""
    levels: InPython[Array]
    """Zero without loads and bonds, shape (m,)."""

    @property
    @key
    def samples(self) -> int:
        """Number of samples."""
        return len(self.path.time)

    @property
    @key
    def duration(self) -> float:
        """Duration of the path [s]."""
        return float(self.path.time[-1] - self.path.time[0])

    @property
    @key
    def times(self) -> Array:
        """Times of the samples [s]."""
        return self.path.time

    @property
    @key
    def moves(self) -> list[str]:
        """Parts that move first."""
        return [] if self.limit is None else self.limit.moves


class _PathSearch:
    """Search for the speed limit of a path; all samples share carried loads and bounds."""

    def __init__(self, program: Program, path: CarrierPath) -> None:
        self.program, self.path = program, path
        self.matrix = load_matrix(program, path.about)
        self.still, self.move = path.loads(program)
        self.rows, self.levels = np.zeros((0, 12)), np.zeros(0)
        self.carried = np.zeros((0, 12))
        self.limits: dict[int, tuple[float, Limit]] = {}
        self.programs = 0
        self._known: dict[bytes, SharedCones] = {}

    def upper_bounds(self) -> Array:
        """Upper bound of the squared speed factor at each sample, from all known planes, (n,)."""
        rest = self.levels - self.still @ self.rows.T
        rate = self.move @ self.rows.T
        ratio = np.divide(rest, rate, out=np.full_like(rate, FASTEST), where=rate > 0.0)
        bound: Array = ratio.min(axis=1, initial=FASTEST)
        for sample, (value, _) in self.limits.items():
            bound[sample] = value
        return bound

    def solve(self, sample: int) -> Limit | NoLimit:
        """Largest squared speed factor at a sample at which contact forces can hold the parts."""
        limit = self._limit(sample, 1.0)
        if isinstance(limit, Limit):
            self.limits[sample] = (min(limit.value, FASTEST), limit)
        return limit

    def least(self, sample: int) -> float | NoLimit:
        """Least squared speed factor at a sample at which contact forces can hold the parts."""
        limit = self._limit(sample, -1.0)
        if isinstance(limit, NoLimit):
            return limit
        if limit.value >= -NOT_HELD:
            self._carry(self.still[sample])
            return 0.0
        return -limit.value

    def confirmed(self, share: float) -> Mask:
        """Mask of samples proved to be carried at a squared speed factor, shape (n,)."""
        return np.array([self.combines(k, share) for k in range(len(self.still))])

    def combines(self, sample: int, share: float) -> bool:
        """True if a sample is proved to be carried at a squared speed factor."""
        return self._combines(self.still[sample] + share * self.move[sample])

    def _limit(self, sample: int, sign: float) -> Limit | NoLimit:
        """Largest squared speed factor at a sample (least if `sign` is -1); proofs are stored."""
        return self._farthest(self.still[sample], sign * self.move[sample])

    def add_rooms(self, sample: int, share: float) -> None:
        """Add the farthest carried loads along each varying component of the load, both ways.

        They start at a sample at rest. Their combinations fill the space around it, also between
        the loads of samples, up to `ROOM` times the change of each component along the path.
        """
        loads = np.vstack([self.still + share * self.move, self.still])
        sizes = np.ptp(loads, axis=0)
        for component in np.flatnonzero(sizes > 0.0):
            for sign in (1.0, -1.0):
                along = sign * sizes[component] * np.eye(12)[component]
                self._farthest(self.still[sample], along, ROOM)

    def _farthest(self, start: Array, along: Array, most: float = FASTEST) -> Limit | NoLimit:
        """Largest carried multiple of a load vector beside a load at rest; proofs are stored."""
        key = start[:3].tobytes()
        if key not in self._known:
            program = self.program.with_rows(gravity=start[:3])
            self._known = {key: SharedCones(program)}
        shared = self._known[key]
        wrench = np.einsum("pij,j->pi", self.matrix, along)
        self.programs += 1
        limit = find_limit(shared.program, wrench, shared=shared, most=most)
        if isinstance(limit, Limit):
            self._carry(start + min(limit.value, most) * along)
            if limit.motion is not None:
                self._add_plane(limit.motion.motion)
        return limit

    def _carry(self, load: Array) -> None:
        self.carried = np.vstack([self.carried, load])

    def _add_plane(self, motion: Array) -> None:
        """Add the linear bound on carried load vectors that a motion proves: rows . z <= level."""
        row = np.einsum("pij,pi->j", self.matrix, motion)
        weight = float(row[:3] @ self.program.gravity)
        size = float(np.linalg.norm(row))
        if size > 0.0:
            level = -(self.program.power(motion) - weight) / size
            self.rows = np.vstack([self.rows, row / size])
            self.levels = np.append(self.levels, level)

    def _combines(self, load: Array) -> bool:
        """True if a load is a convex combination of carried loads, so that it is carried, too.

        A positive combination suffices if no load of the assembly is fixed.
        """
        points = self.carried
        if not len(points):
            return False
        cone = not (self.program.has_strength or self.program.applied.any())
        size = np.maximum(np.abs(points).max(axis=0), np.abs(load))
        used = size > 0.0
        left = (points[:, used] / size[used]).T
        right = load[used] / size[used]
        if not cone:
            left, right = np.vstack([left, np.ones(len(points))]), np.append(right, 1.0)
        weights, residual = nonnegative(left.T, right)
        return residual <= LEFT and bool(weights.any())


def find_path_limit(
    program: Program, path: CarrierPath, tell: Callable[[str], None]
) -> PathLimit | NoLimit:
    """Find the largest factor by which a carrier may run a path faster.

    The limits are those of equilibrium.

    The result is a `NoLimit` with the reason "none" if no speed is carried: an orientation of the
    path is not held at rest, and no acceleration of the path helps.
    """
    search = _PathSearch(program, path)
    failed = _descend(search, tell)
    if failed is None and _add_rooms(search):
        failed = _descend(search, tell)  # the new planes may bound other samples
    if failed is not None:
        return failed
    slowest = _slowest(search)
    if isinstance(slowest, NoLimit):
        return slowest
    failed = _confirm(search, tell) or _descend(search, tell)
    return failed or _path_limit(search, slowest)


def _add_rooms(search: _PathSearch) -> bool:
    """Add the rooms around a sample if many samples have no proof; whether it did."""
    share = float(search.upper_bounds().min())
    unproved = ~search.confirmed(0.0) | ~search.confirmed(share * (1 - SURE))
    many = int(unproved.sum()) > MANY
    if many:
        search.add_rooms(int(np.flatnonzero(unproved)[0]), share)
    return many


def _slowest(search: _PathSearch) -> float | NoLimit:
    """Least squared speed factor that is carried at all samples."""
    slowest = 0.0
    for sample in _unconfirmed(search, 0.0):
        if search.combines(sample, 0.0):
            continue
        least = search.least(sample)
        if isinstance(least, NoLimit):
            return least
        slowest = max(slowest, least)
    return slowest


def _confirm(search: _PathSearch, tell: Callable[[str], None]) -> NoLimit | None:
    """Confirm all samples just below the least limit; the reason if a limit has no value."""
    share = float(search.upper_bounds().min()) * (1 - SURE)
    for sample in _unconfirmed(search, share):
        if sample in search.limits or search.combines(sample, share):
            continue
        limit = search.solve(sample)
        if isinstance(limit, NoLimit):
            return limit
        tell(f"path: sample {sample + 1} of {len(search.path.time)}")
    return None


def _unconfirmed(search: _PathSearch, share: float) -> list[int]:
    """Samples without a proof at a squared speed factor, ends of intervals before their middles.

    In this order, most samples are combinations of loads around them.
    """
    samples = np.flatnonzero(~search.confirmed(share))
    unconfirmed: list[int] = samples[_halving_order(len(samples))].tolist()
    return unconfirmed


def _halving_order(count: int) -> list[int]:
    """Indices 0 to count - 1, the ends of intervals before their middles.

    Examples
    --------
    >>> _halving_order(5)
    [0, 4, 2, 1, 3]
    """
    step = 1 << max(count - 1, 1).bit_length()
    order = dict.fromkeys([0, count - 1]) if count else {}
    while step:
        order |= dict.fromkeys(range(0, count, step))
        step //= 2
    return list(order)


def _descend(search: _PathSearch, tell: Callable[[str], None]) -> NoLimit | None:
    """Compute limits at the sample of the least bound, until that bound is attained.

    Return the reason if a limit has no value.
    """
    worst = int(np.linalg.norm(search.move, axis=1).argmax())
    if search.limits:
        worst = int(search.upper_bounds().argmin())
    while worst not in search.limits:
        limit = search.solve(worst)
        if isinstance(limit, NoLimit):
            return limit
        bounds = search.upper_bounds()
        worst = int(bounds.argmin())
        attained = min(value for value, _ in search.limits.values())
        if bounds[worst] >= attained - AGREES * abs(attained):
            break
        tell(f"path: factor at most {np.sqrt(max(bounds[worst], 0.0)):.6g}")
    return None


def _path_limit(search: _PathSearch, slowest: float) -> PathLimit | NoLimit:
    """The speed limit of a path from a finished search."""
    bounds = search.upper_bounds()
    first = min(search.limits, key=lambda sample: search.limits[sample][0])
    value = float(bounds[first])
    if value < slowest * (1 - SURE) or value < -NOT_HELD:
        return NoLimit("none")
    unlimited = bounds >= FASTEST * (1 - AGREES)
    factors = np.where(unlimited, np.inf, np.sqrt(np.maximum(bounds, 0.0)))
    path = search.path
    return PathLimit(
        path=path,
        factor=float(factors[first]),
        lower=float(np.sqrt(max(value, 0.0) * (1 - SURE))),
        slowest=float(np.sqrt(slowest)),
        time=None if unlimited[first] else float(path.time[first]),
        limit=None if unlimited[first] else search.limits[first][1],
        factors=factors,
        between_samples=path.linear and slowest == 0.0,
        programs=search.programs,
        rows=search.rows,
        levels=search.levels,
    )
