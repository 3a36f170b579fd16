"""Fall of a balanced assembly as exact configurations, each lower and without penetration.

The fall starts at the exact configuration of an answer. Each step has the direction in which the
parts would start to move from rest (Gauss's principle): the du of length h in the metric of the
masses that loses most energy,

    max w.du:   bodies apart by a small gap (`parting_planes`),   du.M du <= h^2

It is linearised again at each configuration that it leads to, until the bodies there are exactly
apart and lower; otherwise h is halved. So parts slide along each other without friction until a
part has moved by its size. Parts that are pressed between planes stay on them. The result is a
sequence of configurations, without times.
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
from kilter.second_order.parts.parting_planes import PartingPlanes, PartPlaces
from kilter.second_order.parts.separation import least_separation
from kilter.second_order.second_order_tolerances import APART, KEEPS
from kilter.solvers.clarabel import solve_conic
from kilter.solvers.problem import ConicProgram
from kilter.threads import on_one_thread
from kilter.work import PER_EFFORT, Work

STEP = 0.05
"""Largest displacement of a part in one step, over its size [-]."""
FAR, TURNED = 2.0, np.pi / 3
"""Shift of a part, over its size [-], and turn of a part [rad], at which a path ends."""
TRIES = 100
"""Largest number of steps, failed steps included."""
GAP, SHARE = 1e-4, 0.05
"""Largest gap in a step, over the size of the smallest part [-], and over the height lost [-]."""
AGAIN, HOLDS = 2, 10.0
"""Number of corrections after a step, and their stiffness over the load [-]."""
BEYOND = 0.01
"""Distance, over the size of the smallest part [-], above which separation is not computed."""
GAINS = 1e-6
"""Least loss of height in a step, over its length [-]; a smaller loss counts as rest."""
CRUMB = 1e-3
"""Least length of a step, over the size of the smallest part [-]."""
REACH = 4.0
"""Reach of a body in a step, over the length of the step [-]; pairs out of reach are skipped."""
TILT = 4.0
"""Largest tilt of a separating plane in a step [rad], over the length of the step relative to the
size [-]."""
STIFF = 1e-5
"""Cost of a squared tilt of a plane, over the energy loss: planes do not tilt without a gain."""
BLUR = 1e-9
"""Relative rounding error of the conditions of kept plane contacts [-]."""
PLANE = 600.0
"""Units of work for the search of a separating plane."""
ALLOWED = 4 * PER_EFFORT
"""Units of work for a path; a path ends early once they are spent."""


@dataclass(frozen=True, slots=True, eq=False)
class PathPlaces:
    """Configurations of the parts along a fall: the start, and k configurations below it."""

    motions: Array
    """Shift of each centre of mass [length unit] and rotation vector [rad], from the start,
    shape (k + 1, N, 6)."""
    energies: Array
    """Energy of the loads, relative to the start [N x length unit], shape (k + 1,)."""
    lengths: Array
    """Sum of the steps so far, each measured by the part that moves most [length unit], shape (k
    + 1,)."""
    apart: Array
    """Least separation of two parts in each configuration after the start [length unit], shape
    (k,)."""

    @property
    def half_way(self) -> int:
        """Index of the first configuration at or beyond half the length of the fall."""
        return int(np.searchsorted(self.lengths, self.lengths[-1] / 2))


@on_one_thread
def find_path_places(
    assembly: Assembly, answer: SecondOrder, *, work: Work | None = None
) -> PathPlaces | None:
    """Compute the fall of a balanced assembly without friction; None if it cannot be computed.

    Returns None if the answer has no exact configuration, if the assembly has given contacts,
    joints or bonds, or if no configuration after the first was found.
    """
    falling = [
        cluster
        for cluster in answer.clusters or (answer,)
        if cluster.state == "balanced" and cluster.configuration is not None
    ]
    if not falling or assembly.contacts or assembly.joints or assembly.bonds or assembly.straps:
        return None
    start = np.sum([c.configuration.motion for c in falling if c.configuration], axis=0)
    first = np.sum([c.motion for c in falling if c.motion is not None], axis=0)
    programs = [c.program for c in falling if c.program is not None]
    planes = np.concatenate([c.problem.planes for c in falling if c.problem is not None])
    descent = _Descent(assembly, _joined_program(programs), work or Work(ALLOWED))
    descent.keep(planes, start)
    path = descent.follow(start, first)
    return path if len(path.lengths) > 2 else None


def _joined_program(programs: list[Program]) -> Program:
    """A single program with the free parts and contact rows of several clusters."""
    rows = ForceRows.join([program.force_rows for program in programs])
    free = np.any([program.free for program in programs], axis=0)
    return replace(programs[0].with_force_rows(rows), free=free)


@dataclass(frozen=True, slots=True, eq=False)
class _Lower:
    """A step of the fall, shape (N, 6), the configuration after it, and its least separation."""

    motion: Array
    place: PartPlaces
    apart: float


class _Descent:
    """Descent of the parts from configuration to configuration, each as steep as possible."""

    def __init__(self, assembly: Assembly, program: Program, work: Work) -> None:
        self.assembly, self.program, self.work = assembly, program, work
        self.planes = PartingPlanes(assembly, program)
        self.length = float(program.radius[program.free].min())
        self.load = program.load
        self.weight = float(np.linalg.norm(self.load[:, :3], axis=1).sum())
        self.kept = np.zeros(len(program.part_a), dtype=bool)

    def keep(self, planes: Mask, start: Array) -> None:
        """Keep plane contacts, (K,), closed in the fall, unless the parts separate anyway.

        Parts that are pressed between planes shift along them and do not turn.
        """
        if self._apart(start) > APART * self.length:
            return
        program = self.program
        a, b = program.part_a, program.part_b
        opened = np.einsum("ki,ki->k", start[b, :3] - start[a, :3], program.normal)
        turned = np.abs(start[a, 3:]).max(axis=1) + np.abs(start[b, 3:]).max(axis=1)
        self.kept = planes & (np.abs(opened) <= KEEPS * self.length) & (turned == 0)
        self.planes.kept = set(zip(a[self.kept].tolist(), b[self.kept].tolist(), strict=True))

    def follow(self, start: Array, first: Array) -> PathPlaces:
        """Follow the fall from rest; the first displacement and direction are given, (N, 6)."""
        place, along, h = PartPlaces.of(start), first, STEP
        motions, steps, apart = [np.zeros_like(start), start], [start], [self._apart(start)]
        for _ in range(TRIES):
            step = None if self.work.over else self._step(place, h * self.length, along)
            moved = 0.0 if step is None else self._largest_move(step.motion)
            if step is None or moved > 2 * STEP:
                h /= 2
                if h < CRUMB or self.work.over:
                    break
                continue
            place, along = step.place, step.motion
            motions.append(place.motion)
            steps.append(along)
            apart.append(step.apart)
            if self._ends(motions[-1]):
                break
            h *= min(2.0, STEP / max(moved, CRUMB))
        lengths = np.append(0.0, np.cumsum([self._length(step) for step in steps]))
        path = np.array(motions)
        return PathPlaces(path, self._energy(path), lengths, np.array(apart))

    def _energy(self, motion: Array) -> Array:
        """Potential energy of the loads at displacements (..., N, 6) [N x length unit]."""
        return np.asarray(0.0 - (motion[..., :3] * self.load[:, :3]).sum(axis=(-2, -1)))

    def _length(self, step: Array) -> float:
        """Largest displacement of a part in a step, turns times the radius [length unit]."""
        far, turned = (np.linalg.norm(rows, axis=1) for rows in (step[:, :3], step[:, 3:]))
        return float(np.maximum(far, turned * self.program.radius).max())

    def _largest_move(self, step: Array) -> float:
        """Largest displacement of a part in a step, over the radius of the part [-]."""
        far, turned = (np.linalg.norm(rows, axis=1) for rows in (step[:, :3], step[:, 3:]))
        return float(np.maximum(far / self.program.radius, turned).max())

    def _ends(self, motion: Array) -> bool:
        """True if a part has moved so far that the fall ends here."""
        far, turned = (np.linalg.norm(rows, axis=1) for rows in (motion[:, :3], motion[:, 3:]))
        return bool((far > FAR * self.program.radius).any() or (turned > TURNED).any())

    def _apart(self, motion: Array) -> float:
        """Least separation of the parts, at most `BEYOND` [length unit]; -inf if it is unknown."""
        beyond = BEYOND * self.length
        least = least_separation(
            self.assembly, self.program, motion, beyond=beyond, planes=self.kept
        )
        return -np.inf if least is None else least

    def _step(self, place: PartPlaces, h: float, along: Array) -> _Lower | None:
        """A step of length h to a lower configuration without penetration; None if none is found.

        Steepest descent is tried first, then the direction of the last step: near rest, the
        steepest direction may curve upward sooner.
        """
        basis = self._basis(place)
        down = self._steepest_step(place, basis, h, self._gap(place))
        within = np.linalg.lstsq(basis, along.reshape(-1), rcond=None)[0]
        on = np.asarray(within / np.linalg.norm(within), dtype=np.float64)
        for direction in [on] if down is None else [down, on]:
            step = self._corrected_step(place, basis, h, direction)
            if step is not None:
                return step
        return None

    def _gap(self, place: PartPlaces) -> float:
        """Gap to leave between the bodies in the next step [length unit]."""
        fallen = -float(self._energy(place.motion)) / self.weight
        return min(GAP * self.length, SHARE * fallen)

    def _corrected_step(
        self, place: PartPlaces, basis: Array, h: float, direction: Array
    ) -> _Lower | None:
        """Step of length h along a direction, corrected to leave small gaps; None if it fails.

        None if the configuration after it is not apart, or not lower.
        """
        gap, after = self._gap(place), place.after((h * basis @ direction).reshape(-1, 6))
        for _ in range(AGAIN):
            correction = self._steepest_step(after, basis, h, gap, HOLDS)
            if correction is None:
                return None
            direction = direction + correction
            step = (h * basis @ direction).reshape(-1, 6)
            after = place.after(step)
        motion = after.motion
        lost = float(self._energy(place.motion) - self._energy(motion))
        if lost <= GAINS * h * self.weight:
            return None
        apart = self._apart(motion)
        return _Lower(step, after, apart) if apart > APART * self.length else None

    def _basis(self, place: PartPlaces) -> Array:
        """Basis of the motions of the free parts, orthonormal for the masses, (6 N, n)."""
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
        columns = basis.reshape(basis.shape[0] * 6, -1)
        return columns @ null_space(self._plane_conditions() @ columns, BLUR)

    def _plane_conditions(self) -> Array:
        """Matrix, (7 K, 6 N), that is 0 on steps in which parts shift along kept planes only."""
        rows = np.flatnonzero(self.kept)
        program, count = self.program, len(rows)
        across = np.zeros((count, 7, len(self.load), 6))
        for sign, part in ((-1.0, program.part_a[rows]), (1.0, program.part_b[rows])):
            k = np.arange(count)
            across[k, 0, part, :3] = sign * program.normal[rows]
            first = 1 if sign < 0 else 4
            across[k[:, None], first + np.arange(3), part[:, None], 3 + np.arange(3)] = 1.0
        return across.reshape(7 * count, 6 * len(self.load))

    def _steepest_step(
        self, place: PartPlaces, basis: Array, h: float, gap: float, holds: float = 0.0
    ) -> Array | None:
        """Steepest descent in the basis, (n,), in units of h; None if no solver finished.

        `holds` is a stiffness: this times half the squared length is added to the cost. None if the
        program was not solved.
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
