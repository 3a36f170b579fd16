"""A quasi-static step: how bodies move under their loads, with contact and Coulomb friction.

Let p be the small motions of the bodies, M their inertia, w their loads, and tau the time of the
step. Motion is overdamped: a body that nothing supports moves by tau times its acceleration from
rest. The step obeys

    min p'Mp / 2 - tau (w.p - sum k q'^2 / 2 - sum f |q'|)      g + J_n p + s >= mu |J_t p|
                                                                s = mu |J_t p|

where the points of contact have the gaps g, and J_n, J_t are the rates of gaps and slips; joints
move by q' = G p against springs k and friction f, and their limits are points without friction.
With s = 0 the program is convex, and its optimum is p = 0 exactly if forces in Coulomb's cones
balance all loads at closed points (the relaxation of Anitescu 2006). A sliding contact would open
by mu |J_t p|; s removes this opening. It is found by repetition (Acary and others 2011).

References
----------
M. Anitescu, Optimization-based simulation of nonsmooth rigid multibody dynamics, Math. Prog. 105,
2006. V. Acary, F. Cadoux, C. Lemarechal, J. Malick, A formulation of the linear discrete Coulomb
friction problem via convex optimization, ZAMM 91, 2011.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import block_array, block_diag, csc_array, csr_array, eye_array, vstack

from kilter.analysis.settled_pose.joint_rows import JointGuides, joint_rates
from kilter.analysis.settled_pose.near_points import NearPoints
from kilter.analysis.settled_pose.rest_programs import loads, rates
from kilter.analysis.settled_pose.rigid_bodies import RigidBodies
from kilter.arrays import Array, Index, Mask, across
from kilter.solvers.clarabel import solve_conic
from kilter.solvers.problem import ConicProgram, Solution
from kilter.work import stop_if_late

REPEATS = 5
"""Largest number of repetitions that find the opening of sliding contacts."""
SAME = 1e-3
"""Change of the motion that ends the repetitions, over the motion [-]."""
STANDS = 1e-6
"""Motion that comes from the solver, over the fall in a step [-]: it is not repeated."""
SEVERAL = 10
"""Number of points of a pair of parts that enter the program together [-]."""
MISSED = 1e-9
"""Overlap after a step from which a point must be in its program, over the fall in the step [-]."""
WEDGED = 1e-3
"""Overlap that opens without friction, if it cannot open with it, over the fall in a step [-]."""
WILD = 30.0
"""Motion beyond which overlaps all but wedge a body, over the fall in the step and the deepest
overlap [-]."""
PRESSES = 1e-6
"""Force from which a point presses, over the largest load [-]."""
HEAVIEST = 1e4
"""Largest inertia of a body, in multiples of the median [-]: heavier ones would spoil the numbers,
and the inertia decides about the way only, not about rest."""


@dataclass(frozen=True, slots=True, eq=False)
class Descent:
    """The program of a step, over the points near contact in the current pose."""

    normal: csr_array
    slip: csr_array
    """Rates of gaps (K, n), and of slips along two tangents, interleaved (2 K, n), of K points and
    limits of joints."""
    joint: csr_array
    drift: Array
    """Rates and errors of the constraints of joints."""
    inertia: csc_array
    """M, shape (n, n)."""
    load: Array
    """Loads [weights], shape (n,)."""
    gap: Array
    mu: Array
    """Gap [lengths] and friction of each point, shape (K,)."""
    pair: Index
    """Number of the pair of parts of each point, shape (K,); limits have numbers of their own."""
    guide: csr_array
    """Rates of the positions of joints with friction or a spring, shape (G, n)."""
    stiffness: Array
    friction: Array
    """Stiffness and largest friction of each of these joints, shape (G,)."""
    columns: Index
    """Columns of the moving bodies in the motions of all free bodies."""
    bodies: RigidBodies
    length: float

    @staticmethod
    def of(
        bodies: RigidBodies, points: NearPoints, active: Mask, length: float, weight: float
    ) -> Descent:
        """Build the program for the bodies in `active` (B,); the others stand still.

        `length` and `weight` are the units of length [length unit] and force [N].
        """
        free = np.flatnonzero(bodies.free)
        freedoms = np.array([0, 2, 4]) if bodies.drawn.planar else np.arange(6)
        moving = np.flatnonzero((active & bodies.moves)[free])
        columns = (6 * moving[:, None] + freedoms).ravel()
        guides = JointGuides.of(bodies, length, weight)
        stop, limits = guides.stop[:, columns], len(guides.room)
        normal = vstack([rates(bodies, points, points.normal, length)[:, columns], stop])
        tangents = [
            vstack([rates(bodies, points, d, length)[:, columns], csr_array(stop.shape)])
            for d in across(points.normal)
        ]
        count = len(points) + limits
        order = np.arange(2 * count).reshape(2, count).T.ravel()
        slip = csr_array(vstack(tangents, format="csr"))[order]
        joint, drift = joint_rates(bodies, length)
        joint = csr_array(joint[:, columns])
        used = np.diff(joint.indptr) > 0
        mu = np.where(points.bears, points.mu, 0.0)
        load = loads(bodies, length, weight) + guides.load
        drives = np.diff(csr_array(guides.rate[:, columns]).indptr) > 0
        drives &= (guides.friction > 0) | (guides.stiffness > 0)
        pair = points.part_a * len(bodies.of_part) + points.part_b
        return Descent(
            csr_array(normal), slip, csr_array(joint[used]), drift[used],
            _inertia(bodies, free[moving], freedoms, length, weight), load[columns],
            np.append(points.gap / length, guides.room), np.append(mu, np.zeros(limits)),
            np.append(pair, -1 - np.arange(limits)), csr_array(guides.rate[drives][:, columns]),
            guides.stiffness[drives], guides.friction[drives], columns, bodies, length,
        )  # fmt: skip

    def step(self, times: Array, rough: Mask) -> Array | None:
        """The motion of all bodies in a step: shift [length unit] and rotation [rad], (B, 6).

        Arguments: `times` (B,): time of the step of each body, as the length that it would fall
        [lengths]; `rough` (K,): points with friction. Returns None if the solver fails.
        """
        scale = self._scale(times)
        if not len(self.columns) or not scale.any():
            return np.zeros((len(self.bodies.mass), 6))
        rough = self._padded(rough) & (self.mu > 0)
        opening = np.zeros(len(self.gap))
        motion: Array | None = None
        before: Array | None = None
        chosen = self._most(-self.gap)
        for _ in range(REPEATS):
            stop_if_late()
            answer = self._solve(scale, rough, opening, chosen)
            if answer is None:
                break
            found = answer.x
            largest = float(np.abs(found).max())
            settled = before is not None and np.abs(found - before).max() <= SAME * largest
            before = found
            # a single sliding contact changes the slip by mu^2 / (1 + mu^2) of a change of s
            change = np.where(rough, self.mu * self._slipped(found) - opening, 0.0)
            # an opening beyond that of the slip would let the bodies penetrate
            if motion is None or settled or change.min(initial=0.0) >= -SAME * largest:
                motion = found
            if settled or largest <= STANDS or not rough.any():
                break
            opening = np.maximum(opening + (1 + self.mu**2) * change, 0.0)
        if motion is None:
            return None
        return self._expanded(motion * scale)

    def closing(self, times: Array, rough: Mask) -> Array | None:
        """The part of a step that closes the joints, which has no loads; arguments as of `step`."""
        if not len(self.drift):
            return np.zeros((len(self.bodies.mass), 6))
        return replace(self, load=np.zeros(len(self.load))).step(times, rough)

    def without_friction(
        self, times: Array, rough: Mask, smooth: Mask
    ) -> tuple[Array, Mask] | None:
        """The motion of a step if some points have no friction, and those of them that press.

        Arguments: `smooth` (K,): these points; others: as of `step`. None if the solver fails.
        """
        scale = self._scale(times)
        count, smooth = len(smooth), self._padded(smooth)
        rough = self._padded(rough) & ~smooth & (self.mu > 0)
        chosen = self._most(-self.gap)
        answer = self._solve(scale, rough, np.zeros(len(self.gap)), chosen)
        if answer is None:
            return None
        others = np.flatnonzero(chosen & ~rough)
        begin = self.joint.shape[0]
        force = np.zeros(len(self.gap))
        force[others] = answer.multipliers[begin : begin + len(others)]
        pressed = smooth & (force > PRESSES * float(np.abs(self.load).max(initial=0.0)))
        return self._expanded(answer.x * scale), pressed[:count]

    def _padded(self, mask: Mask) -> Mask:
        """A mask of the points and the limits of joints from a mask of the points."""
        return np.append(mask, np.zeros(len(self.gap) - len(mask), dtype=bool))

    def _slipped(self, motion: Array) -> Array:
        """Length of the slip of each point in a motion, shape (K,)."""
        slipped: Array = np.linalg.norm((self.slip @ motion).reshape(-1, 2), axis=1)
        return slipped

    def _most(self, value: Array) -> Mask:
        """The points of the `SEVERAL` largest values (K,) of each pair of parts."""
        order = np.lexsort((-value, self.pair))
        pair = self.pair[order]
        rank = np.arange(len(pair)) - np.searchsorted(pair, pair)
        chosen = np.zeros(len(pair), dtype=bool)
        chosen[order[rank < SEVERAL]] = True
        return chosen

    def _scale(self, times: Array) -> Array:
        """Unit of each motion: the length that its body would fall in the step [lengths].

        All bodies of an island have the same time, so its part of the program keeps its optimum.
        """
        owner = np.flatnonzero(self.bodies.free)[self.columns // 6]
        scale: Array = times[owner]
        return scale

    @staticmethod
    def _units(matrix: csr_array, scale: Array) -> Array:
        """The largest unit of the motions that change each row of a matrix; 1 without one."""
        unit = np.zeros(matrix.shape[0])
        np.maximum.at(unit, np.repeat(np.arange(len(unit)), np.diff(matrix.indptr)),
                      scale[matrix.indices])  # fmt: skip
        return np.where(unit > 0, unit, 1.0)

    def _solve(self, scale: Array, rough: Mask, opening: Array, chosen: Mask) -> Solution | None:
        """The motion, over `scale`, for given openings of sliding contacts; None: no solution.

        The program has only the points of `chosen` (K,), to which the points are added that its
        motion would lead into an overlap; of the others, none changes the optimum.
        """
        gap = self.gap / self._units(self.normal, scale)
        while True:
            answer = solve_conic(self._program(scale, gap, rough, opening, chosen))
            wedged = rough & (gap < -WEDGED)
            sunk = (gap[chosen] < -MISSED).any()
            if not answer.found or (sunk and self._is_wild(answer.x, scale)):
                # friction may wedge a body that overlaps: it opens without friction, or stays
                if not wedged.any():
                    if (gap[chosen] >= 0.0).all():
                        return None
                    gap = np.maximum(gap, 0.0)
                rough = rough & ~wedged
                continue
            answer = replace(answer, x=answer.x[: len(self.columns)])
            room = gap + self.normal @ answer.x + opening
            room -= np.where(rough, self.mu, 0.0) * self._slipped(answer.x)
            missed = ~chosen & (room < -MISSED)
            if not missed.any():
                return answer
            chosen |= missed & self._most(np.where(missed, -room, -np.inf))

    def _is_wild(self, motion: Array, scale: Array) -> bool:
        """Whether a motion, over `scale`, is far longer than the fall and the deepest overlap."""
        step = self._expanded(motion[: len(self.columns)] * scale)
        most = WILD * self.length * float(scale.max() + np.maximum(-self.gap, 0.0).max())
        return bool(self.bodies.travel(step).max() > most)

    def _program(
        self, scale: Array, gap: Array, rough: Mask, opening: Array, chosen: Mask
    ) -> ConicProgram:
        """The convex program of the step, with the points of `chosen` (K,)."""
        cones, smooth = np.flatnonzero(chosen & rough), np.flatnonzero(chosen & ~rough)
        slips = (2 * cones[:, None] + np.arange(2)).ravel()
        drift = self.drift / self._units(self.joint, scale)
        rows = csr_array(
            vstack([self.normal[cones], _scaled(self.slip[slips], np.repeat(self.mu[cones], 2))])
        )
        k = np.arange(len(cones))
        order = np.column_stack([k, len(k) + 2 * k, len(k) + 2 * k + 1]).ravel()
        bound = np.zeros((len(cones), 3))
        bound[:, 0] = (gap + opening)[cones]
        # |q'| of each joint with friction is at most a further variable
        drag, count = self.guide[self.friction > 0], int(np.count_nonzero(self.friction))
        above = -eye_array(count, format="csr")
        blocks = [[self.joint, None], [-self.normal[smooth], None], [drag, above], [-drag, above]]
        matrix = block_array([*blocks, [-rows[order], csr_array((3 * len(cones), count))]])
        tight = _scaled(self.guide, self.stiffness * self._units(self.guide, scale))
        springs = csc_array(self.guide.T @ tight)
        return ConicProgram(
            csc_array(block_diag([self.inertia + springs, csc_array((count, count))])),
            np.append(-self.load, self.friction[self.friction > 0]),
            csc_array(matrix),
            np.concatenate([-drift, gap[smooth], np.zeros(2 * count), bound.ravel()]),
            self.joint.shape[0],
            len(smooth) + 2 * count,
            np.full(len(cones), 3),
        )

    def _expanded(self, motion: Array) -> Array:
        """The motion of all bodies from that of the moving ones, in length units."""
        free = np.zeros(6 * int(self.bodies.free.sum()))
        free[self.columns] = motion
        steps = np.zeros((len(self.bodies.mass), 6))
        steps[self.bodies.free] = free.reshape(-1, 6)
        steps[:, :3] *= self.length
        return steps


def _scaled(matrix: csr_array, factors: Array) -> csr_array:
    """A matrix with scaled rows."""
    result = csr_array(matrix, copy=True)
    result.data *= np.repeat(factors, np.diff(result.indptr))
    return result


def _inertia(
    bodies: RigidBodies, moving: Index, freedoms: Index, length: float, weight: float
) -> csc_array:
    """Inertia of bodies about their centres, world axes [masses of the unit weight], sparse."""
    assembly = bodies.drawn
    geometry = assembly.geometry
    unit = weight / max(float(np.linalg.norm(assembly.gravity)), 1e-300)
    arm = geometry.center - bodies.drawn_center[bodies.of_part]
    square = np.einsum("ni,ni->n", arm, arm)[:, None, None] * np.eye(3)
    square = square - arm[:, :, None] * arm[:, None, :]
    about = np.zeros((len(bodies.mass), 3, 3))
    np.add.at(about, bodies.of_part, geometry.inertia + geometry.mass[:, None, None] * square)
    turn = bodies.rotation[moving]
    about = turn @ about[moving] @ turn.transpose(0, 2, 1) / length**2 / unit
    mass = bodies.mass[moving] / unit
    blocks = np.zeros((len(moving), 6, 6))
    blocks[:, [0, 1, 2], [0, 1, 2]] = mass[:, None]
    least = mass * (1e-3 * bodies.size[moving] / length) ** 2
    blocks[:, 3:, 3:] = about + least[:, None, None] * np.eye(3)
    median = float(np.median(mass)) if len(mass) else 1.0
    blocks /= np.maximum(mass / (HEAVIEST * median), 1.0)[:, None, None]
    cut = blocks[:, freedoms[:, None], freedoms[None, :]]
    if not len(cut):
        return csc_array((0, 0))
    return csc_array(block_diag(list(cut), format="csc"))
