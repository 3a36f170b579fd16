"""The programs of a step towards rest, over the points near contact in the current pose.

Let p be the small motions of the bodies, J_n p the rates of the gaps g, and f the forces at the
points in Coulomb's cones. M weighs motions by the squares of the distances that points move, and
by the masses of the bodies, unless the least motion is searched: a heavy bin stays where it is, and
its light contents move.

    push apart     min p'Mp                                     g + J_n p >= 0
    carry          min sum f_n c + PRICE |J'f + w|_1            f in the cones, c >= 0
    close          min kappa p'Mp / 2 + sum c (g + J_n p)       g + J_n p >= 0, c >= 0
    least overlap  min t + epsilon p'Mp                         g + J_n p + t >= 0

`carry` selects the points whose forces balance the weights at the least sum of force times gap;
`close` closes them. Lengths are in units of the median size; forces in units of the mean weight.
Constraints of joints are equations in all programs, and their forces have any sign. Limits of
joints are further rows of J_n, after those of the points, without friction.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import block_array, coo_array, csc_array, csr_array, diags_array, eye_array

from kilter.analysis.settled_pose.joint_rows import JointGuides, joint_rates
from kilter.analysis.settled_pose.near_points import NearPoints
from kilter.analysis.settled_pose.rigid_bodies import RigidBodies
from kilter.arrays import Array, Index, Mask, across
from kilter.solvers.clarabel import solve_conic
from kilter.solvers.problem import ConicProgram
from kilter.work import stop_if_late

PRICE = 1e3
"""Price of an unbalanced force, per force times gap of the widest gap [-]. A larger value is less
accurate, a smaller value prefers falling to closing."""
LEAST_PUSH = 0.1
"""Least weight of a carrying point in the closing of gaps, in units of the mean weight [-]; without
it, points with small forces stay open."""
FAR = 1e4
"""Largest gap of a point in a step, in multiples of the widest carrying gap [-]."""
UPRIGHT = 1e6
"""Weight of a turn in the opening of overlaps, over that of a shift, where faces stay parallel [-].
"""
HEAVIER = 1e3
"""Largest and least mass of a body in the opening of overlaps, over the median mass [-]."""
OVERLAP_WEIGHT = 1e-6
"""Weight of the motion in the least overlap [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class RestPrograms:
    """Rates of gaps, slips and joints, and the load, of bodies near contact."""

    normal: csr_array
    slips: csr_array
    """Rates of the gaps, shape (K, 6 F), and of the slips along two tangents, first all along
    the first, shape (2 K, 6 F), for unit motions of the F free bodies; K points and limits."""
    parts: Index
    """The two parts of each row, shape (K, 2); -1 is the ground."""
    joint: csr_array
    """Rates of the constraints of joints, shape (L, 6 F)."""
    drift: Array
    """Error of each constraint in the current pose, shape (L,)."""
    guides: JointGuides
    """Limits, friction and springs of joints."""
    load: Array
    """Forces and torques on the free bodies, shape (6 F,)."""
    gap: Array
    """Gaps, shape (K,); negative: penetration."""
    mu: Array
    """Shape (K,)."""
    bears: Mask
    """Shape (K,)."""
    columns: Index
    """Columns of the bodies that may move."""
    balanced: Index
    """Columns in which forces must balance; a planar assembly has three for each body."""
    weights: Array
    """Diagonal of M for `columns`."""
    length: float
    """Unit of length [length unit]."""

    @staticmethod
    def of(
        bodies: RigidBodies,
        points: NearPoints,
        length: float,
        weight: float,
        *,
        inertia: Array | None = None,
    ) -> RestPrograms:
        """Build the programs of bodies with the given points near contact.

        `length` and `weight` are the units of length [length unit] and force [N]; `inertia` (B,):
        weight of the motion of each body in M, in any unit; None: all are equal.
        """
        free = np.flatnonzero(bodies.free)
        n, (u, v) = points.normal, across(points.normal)
        normal = rates(bodies, points, n, length)
        guides = JointGuides.of(bodies, length, weight)
        count = len(guides.room)
        still = csr_array(guides.stop.shape)
        slips = [_stacked([rates(bodies, points, d, length), still]) for d in (u, v)]
        joint, drift = joint_rates(bodies, length)
        parts = np.column_stack([points.part_a, points.part_b])
        planar = bodies.drawn.planar
        freedoms = np.array([0, 2, 4]) if planar else np.arange(6)
        balanced = (6 * np.arange(len(free))[:, None] + freedoms).ravel()
        movable = bodies.moves[free]
        columns = (6 * np.flatnonzero(movable)[:, None] + freedoms).ravel()
        arm = bodies.size[free] / 2 / length
        weights = np.concatenate(
            [np.ones((len(free), 3)), np.repeat(arm[:, None] ** 2, 3, axis=1)], axis=1
        ).ravel()[columns]
        if inertia is not None and len(columns):
            heavy = inertia[free[columns // 6]]
            weights *= np.clip(heavy / np.median(heavy), 1 / HEAVIER, HEAVIER)
        return RestPrograms(
            _stacked([normal, guides.stop]), _stacked(slips), np.vstack([parts, guides.stop_parts]),
            joint, drift, guides, loads(bodies, length, weight) + guides.load,
            np.append(points.gap / length, guides.room), np.append(points.mu, np.zeros(count)),
            np.append(points.bears, np.ones(count, dtype=bool)),
            columns, balanced, weights, length,
        )  # fmt: skip

    @property
    def rates(self) -> csr_array:
        """Rates of the gaps for motions of the bodies that may move."""
        return csr_array(self.normal[:, self.columns])

    def push_apart(self, *, upright: bool = False) -> Array | None:
        """Least motion that opens all overlaps; None if none exists to first order.

        `upright`: whether bodies shift rather than turn, so that their faces stay parallel.
        """
        deep = float(max(-self.gap.min(initial=0.0), np.abs(self.drift).max(initial=0.0)))
        if deep == 0.0:
            return np.zeros(len(self.columns))
        turns = upright & (self.columns % 6 >= 3)
        weights = np.where(turns, UPRIGHT * self.weights, self.weights)
        step = self._step(weights, np.zeros(len(self.columns)), self.gap / deep, deep)
        return None if step is None else deep * step

    def least_overlap(self) -> tuple[float, Array, Array]:
        """Least depth of overlap that small motions leave, forces at the points, and the motion.

        The forces, shape (K,), are a certificate: they press against each other in balance.
        """
        deep = float(-self.gap.min(initial=0.0))
        count, rows = len(self.columns), len(self.gap)
        if deep == 0.0 or not count:
            return deep, (self.gap <= -deep).astype(np.float64), np.zeros(count)
        matrix = block_array(
            [
                [self._joints(), csc_array((len(self.drift), 1))],
                [-self.rates, csc_array(-np.ones((rows, 1)))],
                [None, csc_array([[-1.0]])],
            ],
            format="csc",
        )
        quadratic = diags_array(np.append(OVERLAP_WEIGHT * self.weights, 0.0), format="csc")
        program = ConicProgram(
            quadratic,
            np.append(np.zeros(count), 1.0),
            matrix,
            np.concatenate([-self.drift / deep, self.gap / deep, [0.0]]),
            len(self.drift),
            rows + 1,
            np.empty(0, dtype=np.int64),
        )
        answer = solve_conic(program)
        if not answer.found:
            return deep, np.zeros(rows), np.zeros(count)
        forces = answer.multipliers[len(self.drift) : len(self.drift) + rows]
        return deep * float(answer.x[-1]), np.maximum(forces, 0.0), deep * answer.x[:-1]

    def carry(self, cost: Array, allowed: Mask) -> tuple[Array, Array]:
        """Normal forces that carry the load at the least cost, and the imbalance they leave.

        Arguments: `cost` (K,): price of a normal force at each point [-]; `allowed` (K,): points
        that may carry force. Returns `forces` (K,): normal forces [mean weights]; 0 if the solver
        fails; `imbalance` (6 F,): unbalanced forces and torques; infinite if the solver fails.
        """
        stop_if_late()
        forces = np.zeros(len(self.gap))
        rows = np.flatnonzero(allowed)
        smooth, rough = rows[self.mu[rows] == 0], rows[self.mu[rows] > 0]
        load = self.load[self.balanced]
        imbalance = np.full(len(self.load), np.inf)
        if not len(load):
            return forces, np.zeros(0)
        triples = np.column_stack([rough, rough + len(self.gap), rough + 2 * len(self.gap)]).ravel()
        every = csr_array(_stacked([self.normal, self.slips])[:, self.balanced])
        acting = [csc_array(every[smooth].T), csc_array(every[triples].T)]
        drags = self.guides.friction > 0
        joint = _stacked([self.joint, csr_array(self.guides.rate[drags])])
        acting.append(csc_array(joint[:, self.balanced].T))
        sizes = [len(smooth), len(triples), joint.shape[0], len(load), len(load)]
        columns = np.concatenate([[0], np.cumsum(sizes)])
        total = int(columns[-1])
        identity = eye_array(len(load), format="csc")
        balance = block_array([[*acting, identity, -identity]], format="csc")
        positive = _selection(
            np.concatenate([np.arange(sizes[0]), np.arange(columns[3], total)]), total, -1.0
        )
        drag = np.arange(columns[2] + self.joint.shape[0], columns[3])
        positive = _stacked([positive, *(_selection(drag, total, sign) for sign in (1.0, -1.0))])
        scale = np.ones(sizes[1])
        scale[::3] = self.mu[rough]
        cones = _selection(columns[1] + np.arange(sizes[1]), total, -scale)
        matrix = csc_array(_stacked([csr_array(balance), positive, cones]))
        bound = np.concatenate([-load, np.zeros(matrix.shape[0] - len(load))])
        first = len(load) + positive.shape[0] - 2 * len(drag)
        bound[first : first + 2 * len(drag)] = np.tile(self.guides.friction[drags], 2)
        prices = np.zeros(total)
        prices[: sizes[0]] = cost[smooth]
        prices[columns[1] : columns[2] : 3] = cost[rough]
        prices[columns[3] :] = PRICE
        program = ConicProgram(
            csc_array((total, total)),
            prices,
            matrix,
            bound,
            len(load),
            positive.shape[0],
            np.full(len(rough), 3),
        )
        answer = solve_conic(program)
        if not answer.found:
            return forces, imbalance
        x = answer.x
        forces[smooth] = x[: sizes[0]]
        forces[rough] = x[columns[1] : columns[2] : 3]
        imbalance[:] = 0.0
        imbalance[self.balanced] = x[columns[3] : columns[4]] - x[columns[4] :]
        return forces, imbalance

    def close(self, push: Array, scale: float, kappa: float) -> Array | None:
        """Motion, over `scale`, that closes the points with a push as far as the gaps allow."""
        gap = np.minimum(self.gap / scale, FAR)
        return self._step(kappa * self.weights, self.rates.T @ push, gap, scale)

    def _step(self, weights: Array, cost: Array, gap: Array, scale: float) -> Array | None:
        """Minimise weights p^2 / 2 + cost.p under gap + J_n p >= 0; None without a solution."""
        stop_if_late()
        if not len(self.columns):  # every free body is kept in place
            return None if min(gap.min(initial=0.0), 0.0) < 0.0 else np.zeros(0)
        joints = self._joints()
        matrix = csc_array(_stacked([csr_array(joints), csr_array(-self.rates)]))
        program = ConicProgram(
            diags_array(weights, format="csc"),
            cost,
            matrix,
            np.concatenate([-self.drift / scale, gap]),
            joints.shape[0],
            len(gap),
            np.empty(0, dtype=np.int64),
        )
        answer = solve_conic(program)
        return answer.x if answer.found else None

    def _joints(self) -> csc_array:
        return csc_array(self.joint[:, self.columns])

    def steps(self, motion: Array, bodies: RigidBodies) -> Array:
        """Shift [length unit] and rotation [rad] of all bodies for a motion, shape (B, 6)."""
        free = np.zeros(len(self.load))
        free[self.columns] = motion
        steps = np.zeros((len(bodies.mass), 6))
        steps[bodies.free] = free.reshape(-1, 6)
        steps[:, :3] *= self.length
        return steps


def _stacked(blocks: list[csr_array]) -> csr_array:
    """Sparse blocks one below the other."""
    from scipy.sparse import vstack

    return csr_array(vstack(blocks, format="csr"))


def _selection(columns: Index, width: int, value: Array | float) -> csr_array:
    """A matrix whose row k has a single entry, in column ``columns[k]``."""
    count = len(columns)
    values = np.broadcast_to(np.asarray(value, dtype=np.float64), count)
    return csr_array((values, (np.arange(count), columns)), shape=(count, width))


def rates(bodies: RigidBodies, points: NearPoints, along: Array, length: float) -> csr_array:
    """Rates of the distances of points along directions, for unit motions of the free bodies."""
    number = np.cumsum(bodies.free) - 1
    data, row, column = [], [], []
    for part, sign in ((points.part_a, -1.0), (points.part_b, 1.0)):
        body = bodies.of_part[part]
        rows = np.flatnonzero(bodies.free[body])
        arm = (points.point[rows] - bodies.center[body[rows]]) / length
        entries = sign * np.concatenate([along[rows], np.cross(arm, along[rows])], axis=1)
        data.append(entries.ravel())
        row.append(np.repeat(rows, 6))
        column.append((6 * number[body[rows]][:, None] + np.arange(6)).ravel())
    shape = (len(along), 6 * int(bodies.free.sum()))
    entries, at = np.concatenate(data), (np.concatenate(row), np.concatenate(column))
    return csr_array(coo_array((entries, at), shape=shape))


def loads(bodies: RigidBodies, length: float, weight: float) -> Array:
    """Weights and loads on the free bodies: force [weights], torque [weights x lengths]."""
    assembly = bodies.drawn
    load = np.zeros((len(bodies.mass), 6))
    load[:, :3] = bodies.mass[:, None] * assembly.gravity
    for entry in assembly.loads:
        body = bodies.body_of(entry.part)
        drawn = assembly.geometry.center[assembly.index[entry.part]]
        point = bodies.placed(body, drawn if entry.point is None else entry.point)
        load[body, :3] += entry.force
        arm = point - bodies.center[body]
        load[body, 3:] += (entry.torque + np.cross(arm, entry.force)) / length
    result: Array = load[bodies.free].ravel() / weight
    return result
