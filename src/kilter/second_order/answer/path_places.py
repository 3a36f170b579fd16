"""Places along which what is balanced falls: each exact, apart, and lower than the one before.

From the exact configuration of an answer, step by step in the direction in which the parts would
start to move from rest there (Gauss's principle): the du of length h in the metric of the masses
that loses most energy,

    max w.du:   bodies apart by a small gap (`parting_planes`),   du.M du <= h^2,

linearised anew at each place that it leads to, until the bodies there are apart, by planes and
distances, and lower; else h is halved. So parts hug one another, without friction, as far as they
have moved by their own size; what is pressed between planes stays on them. The way is one of
places, not of times.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csc_array

from kilter.arrays import Array, Mask
from kilter.assembly import Assembly
from kilter.mechanics.program import Program
from kilter.mechanics.rows import ForceRows
from kilter.second_order.answer.second_order_answer import SecondOrder
from kilter.second_order.motions.null_space import null_space
from kilter.second_order.parts.parting_planes import PartingPlanes, Places
from kilter.second_order.parts.separation import least_separation
from kilter.second_order.second_order_tolerances import APART, KEEPS
from kilter.solvers.clarabel import solve_conic
from kilter.solvers.problem import ConicProgram
from kilter.threads import on_one_thread
from kilter.work import PER_EFFORT, Work

__all__ = ["PathPlaces", "find_path_places"]

STEP = 0.05
"""How far a part moves in one step, over its size."""
FAR, TURNED = 2.0, np.pi / 3
"""A path ends where a part has moved so far, over its size, or turned [rad]."""
TRIES = 100
"""Steps that are tried at most."""
GAP, SHARE = 1e-4, 0.05
"""The gap that is left, over the size of the smallest part; and over the height that is lost."""
AGAIN, HOLDS = 2, 10.0
"""Times that parts sink, or are pushed apart, after a step, each linearised anew; and what holds
them where it led, over the load."""
BEYOND = 0.01
"""Parts farther apart than this, over the size of the smallest, are not measured."""
GAINS = 1e-6
"""Least loss of height of a step, over its length: less is rest."""
CRUMB = 1e-3
"""Steps are not halved below this, over the size of a part."""
REACH = 4.0
"""Bodies that come no nearer than this, over a step, are left out."""
TILT = 4.0
"""Planes tilt by at most this, over a step over the size."""
STIFF = 1e-5
"""What the square of a tilt costs, over the loss of energy: planes turn for a gain alone."""
BLUR = 1e-9
"""Of what kept planes forbid, rounding."""
PLANE = 600.0
"""Units of work of a plane that is sought."""
ALLOWED = 4 * PER_EFFORT
"""Units of work of a path; where they end it is shorter."""


@dataclass(frozen=True, slots=True, eq=False)
class PathPlaces:
    """Parts along a path, the start first; k places after it.

    Attributes
    ----------
    motions : ndarray, shape (k + 1, N, 6)
        Shift of each centre of mass [length unit] and rotation vector [rad], from the start.
    energies : ndarray, shape (k + 1,)
        Of the loads, less that at the start [N x length unit].
    lengths : ndarray, shape (k + 1,)
        How far along: the sum of the steps, each as far as a part moves most [length unit].
    apart : ndarray, shape (k,)
        Least separation of two parts at each place but the start [length unit].
    """

    motions: Array
    energies: Array
    lengths: Array
    apart: Array

    @property
    def half_way(self) -> int:
        """The place that is half as far along as the last, or the next one."""
        return int(np.searchsorted(self.lengths, self.lengths[-1] / 2))


@on_one_thread
def find_path_places(
    assembly: Assembly, found: SecondOrder, *, work: Work | None = None
) -> PathPlaces | None:
    """Places along which what is balanced falls without friction.

    Parameters
    ----------
    assembly : Assembly
    found : SecondOrder
        Its answer; of several clusters all that are balanced fall at once.
    work : Work, optional
        Where it ends, so does the path.

    Returns
    -------
    PathPlaces or None
        None where the answer has no exact configuration, where contacts are given, which have no
        bodies, of what joints or bonds hold, and where no place beyond the configuration is found.
    """
    falling = [
        one
        for one in found.clusters or (found,)
        if one.state == "balanced" and one.configuration is not None
    ]
    if not falling or assembly.contacts or assembly.joints or assembly.bonds:
        return None
    start = np.sum([one.configuration.motion for one in falling if one.configuration], axis=0)
    first = np.sum([one.motion for one in falling if one.motion is not None], axis=0)
    programs = [one.program for one in falling if one.program is not None]
    planes = np.concatenate([one.problem.planes for one in falling if one.problem is not None])
    way = _Descent(assembly, _joined(programs), work or Work(ALLOWED))
    way.keep(planes, start)
    path = way.followed(start, first)
    return path if len(path.lengths) > 2 else None


def _joined(programs: list[Program]) -> Program:
    """The free parts and rows of several clusters as one."""
    rows = ForceRows.join([one.force_rows for one in programs])
    free = np.any([one.free for one in programs], axis=0)
    return replace(programs[0].with_force_rows(rows), free=free)


@dataclass(frozen=True, slots=True, eq=False)
class _Lower:
    """A step, shape (N, 6), where it leads, and how far apart bodies are there."""

    motion: Array
    place: Places
    apart: float


class _Descent:
    """A way from place to place, in the metric of the masses."""

    def __init__(self, assembly: Assembly, program: Program, work: Work) -> None:
        self.assembly, self.program, self.work = assembly, program, work
        self.planes = PartingPlanes(assembly, program)
        self.length = float(program.radius[program.free].min())
        self.load = program.load
        self.weight = float(np.linalg.norm(self.load[:, :3], axis=1).sum())
        self.kept = np.zeros(len(program.part_a), dtype=bool)

    def keep(self, planes: Mask, start: Array) -> None:
        """Stay on planes of contact, shape (K,), where a first place is apart only if it does.

        Parts that are pressed between planes shift along them, and turn not at all.
        """
        if self._apart(start) > APART * self.length:
            return
        program = self.program
        a, b = program.part_a, program.part_b
        opened = np.einsum("ki,ki->k", start[b, :3] - start[a, :3], program.normal)
        turned = np.abs(start[a, 3:]).max(axis=1) + np.abs(start[b, 3:]).max(axis=1)
        self.kept = planes & (np.abs(opened) <= KEEPS * self.length) & (turned == 0)
        self.planes.kept = set(zip(a[self.kept].tolist(), b[self.kept].tolist(), strict=True))

    def followed(self, start: Array, first: Array) -> PathPlaces:
        """The places, from rest by way of a first one, and its direction; shapes (N, 6)."""
        place, along, h = Places.of(start), first, STEP
        motions, steps, apart = [np.zeros_like(start), start], [start], [self._apart(start)]
        for _ in range(TRIES):
            found = None if self.work.over else self._step(place, h * self.length, along)
            moved = 0.0 if found is None else self._moved(found.motion)
            if found is None or moved > 2 * STEP:
                h /= 2
                if h < CRUMB or self.work.over:
                    break
                continue
            place, along = found.place, found.motion
            motions.append(place.motion)
            steps.append(along)
            apart.append(found.apart)
            if self._ends(motions[-1]):
                break
            h *= min(2.0, STEP / max(moved, CRUMB))
        lengths = np.append(0.0, np.cumsum([self._length(one) for one in steps]))
        path = np.array(motions)
        return PathPlaces(path, self._energy(path), lengths, np.array(apart))

    def _energy(self, motion: Array) -> Array:
        """Of shifts, shape (..., N, 6): the loads are constant, their torques are none."""
        return np.asarray(0.0 - (motion[..., :3] * self.load[:, :3]).sum(axis=(-2, -1)))

    def _length(self, step: Array) -> float:
        """How far a part moves at most, a turn by its radius [length unit]."""
        far, turned = (np.linalg.norm(one, axis=1) for one in (step[:, :3], step[:, 3:]))
        return float(np.maximum(far, turned * self.program.radius).max())

    def _moved(self, step: Array) -> float:
        """The same over the size of each part."""
        far, turned = (np.linalg.norm(one, axis=1) for one in (step[:, :3], step[:, 3:]))
        return float(np.maximum(far / self.program.radius, turned).max())

    def _ends(self, motion: Array) -> bool:
        """Whether a part has moved by its width, or turned far."""
        far, turned = (np.linalg.norm(one, axis=1) for one in (motion[:, :3], motion[:, 3:]))
        return bool((far > FAR * self.program.radius).any() or (turned > TURNED).any())

    def _apart(self, motion: Array) -> float:
        """Least separation, up to a limit; minus infinity where it is not known."""
        beyond = BEYOND * self.length
        found = least_separation(
            self.assembly, self.program, motion, beyond=beyond, planes=self.kept
        )
        return -np.inf if found is None else found

    def _step(self, place: Places, h: float, along: Array) -> _Lower | None:
        """A step of length h to a place that is apart and lower; None where none was found.

        Down; where the way curves upward sooner, as it does near rest, on along the last step.
        """
        basis = self._basis(place)
        down = self._solved(place, basis, h, self._gap(place))
        on = np.linalg.lstsq(basis, along.reshape(-1), rcond=None)[0]
        ways = [on / np.linalg.norm(on)] if down is None else [down, on / np.linalg.norm(on)]
        for way in ways:
            step = self._pushed(place, basis, h, way)
            if step is not None:
                return step
        return None

    def _gap(self, place: Places) -> float:
        """The gap that is left on from a place."""
        fallen = -float(self._energy(place.motion)) / self.weight
        return min(GAP * self.length, SHARE * fallen)

    def _pushed(self, place: Places, basis: Array, h: float, way: Array) -> _Lower | None:
        """Near the end of a way of length 1, where bodies touch; None if that is no lower."""
        gap, after = self._gap(place), place.after((h * basis @ way).reshape(-1, 6))
        for _ in range(AGAIN):
            more = self._solved(after, basis, h, gap, HOLDS)
            if more is None:
                return None
            way = way + more
            step = (h * basis @ way).reshape(-1, 6)
            after = place.after(step)
        motion = after.motion
        lost = float(self._energy(place.motion) - self._energy(motion))
        if lost <= GAINS * h * self.weight:
            return None
        apart = self._apart(motion)
        return _Lower(step, after, apart) if apart > APART * self.length else None

    def _basis(self, place: Places) -> Array:
        """Motions of the free parts of length 1 in the metric of the masses, shape (6 N, n)."""
        program, per = self.program, self.program.freedoms
        free = np.flatnonzero(program.free)
        mean = float(program.mass[free].mean())
        basis = np.zeros((len(program.names), 6, len(free), len(per)))
        for k, part in enumerate(free.tolist()):
            turn, six = place.turns[part], np.zeros((6, 6))
            six[:3, :3] = program.mass[part] * np.eye(3)
            six[3:, 3:] = turn @ program.inertia[part] @ turn.T
            root = np.linalg.cholesky(six[np.ix_(per, per)] / mean)
            basis[part, per, k] = np.linalg.inv(root).T
        whole = basis.reshape(basis.shape[0] * 6, -1)
        return whole @ null_space(self._across() @ whole, BLUR)

    def _across(self) -> Array:
        """What kept planes forbid: to shift across them, and to turn, shape (7 K, 6 N)."""
        rows = np.flatnonzero(self.kept)
        program, count = self.program, len(rows)
        across = np.zeros((count, 7, len(self.load), 6))
        for sign, part in ((-1.0, program.part_a[rows]), (1.0, program.part_b[rows])):
            k = np.arange(count)
            across[k, 0, part, :3] = sign * program.normal[rows]
            first = 1 if sign < 0 else 4
            across[k[:, None], first + np.arange(3), part[:, None], 3 + np.arange(3)] = 1.0
        return across.reshape(7 * count, 6 * len(self.load))

    def _solved(
        self, place: Places, basis: Array, h: float, gap: float, holds: float = 0.0
    ) -> Array | None:
        """The step, over h in a basis, no longer than 1, that loses most energy, shape (n,).

        `holds` times its square is counted against it.
        """
        count = basis.shape[1]
        reach = REACH * h * np.abs(basis.reshape(len(self.load), 6, -1)[:, :3]).max(axis=(1, 2))
        rows, bound = self.planes.rows(place, reach, gap)
        planes = rows.shape[1] - len(basis)
        self.work.charge(PLANE * planes / 3)
        units = np.where(np.arange(planes) % 3 < 2, h / self.length, h)
        tilts = np.eye(planes)[np.arange(planes) % 3 < 2]
        none = np.zeros((len(tilts), count))
        cone = np.vstack([np.zeros(count), -np.eye(count)])
        matrix = np.block(
            [
                [rows[:, : len(basis)] @ basis, rows[:, len(basis) :] * units / h],
                [none, tilts],
                [none, -tilts],
                [cone, np.zeros((count + 1, planes))],
            ]
        )
        squares = np.append(np.full(count, holds), STIFF * tilts.sum(axis=0))
        gain = np.append(self.load.reshape(-1) @ basis / self.weight, np.zeros(planes))
        sides = np.concatenate([bound / h, np.full(2 * len(tilts), TILT), [1.0], np.zeros(count)])
        flat = len(sides) - count - 1
        cones = np.array([count + 1])
        answer = solve_conic(
            ConicProgram(
                csc_array(np.diag(squares)), -gain, csc_array(matrix), sides, 0, flat, cones
            ),
            work=self.work,
        )
        return np.asarray(answer.x[:count]) if answer.found else None
