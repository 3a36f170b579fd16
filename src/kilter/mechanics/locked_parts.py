"""Parts that a squeeze locks together: a smaller program with the same held loads.

A squeeze is a self-stress: contact forces without a load, A x = 0. The squeeze inside most cones,

    max sum t_k:  A x = 0,  x - t_k e_k in the cones,  0 <= t_k <= 1      e_k: axis of cone k

has t_k = 1 at every contact that some squeeze loads inside its cone, and t_k = 0 at all others: a
multiple of a squeeze is a squeeze. At the contacts with t_k = 1 every force is possible, since a
large multiple of x brings it into its cone. No admissible motion slides or opens them, since s.x =
0 for the motion's openings s. So these contacts are welds: parts between which they stop all
motions are merged to a body (`kilter.mechanics.locked_parts`), and the rest become two-sided rows.
Exactly the same loads are held.

Forces of the smaller program become forces of all contacts: forces of least length at the welds
balance the parts, and a multiple of the squeeze moves them into their cones. A motion of the
bodies is one of their parts. Certificates judge both on the original program.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csc_array, diags_array, eye_array, hstack, vstack
from scipy.sparse.csgraph import connected_components

from kilter.arrays import TINY, Array, Index, Mask, cross, group_sums
from kilter.mechanics.coulomb_cones import ConeProblem, cone_problem
from kilter.mechanics.mechanics_tolerances import LOCKED, RIGID
from kilter.mechanics.program import Program
from kilter.solvers.problem import ConicProgram

# Merge rigidly joined parts of a program to single bodies, so that it has fewer freedoms.


def merge_parts(program: Program, group: Index) -> Program:
    """Copy of a program in which each group of rigidly joined parts is a single part.

    Arguments: `group` (N,).

    Examples
    --------
    >>> from kilter.contact import contacts
    >>> from kilter.mechanics.program import build_program
    >>> from kilter.scenes import scene
    >>> assembly = scene("tower")
    >>> program = build_program(assembly, contacts(assembly))
    >>> merged = merge_parts(program, np.minimum(np.arange(len(assembly)), 1))
    >>> len(merged.names), bool(merged.mass[1] == program.mass[1:].sum())
    (2, True)
    """
    count = int(group.max(initial=-1)) + 1
    mass = np.bincount(group, program.mass, minlength=count)
    center = group_sums(group, program.mass[:, None] * program.center, count) / mass[:, None]
    arm = program.center - center[group]
    square = np.einsum("ij,ij->i", arm, arm)[:, None, None] * np.eye(3)
    steiner = program.mass[:, None, None] * (square - arm[:, :, None] * arm[:, None, :])
    applied, clamp = program.applied.copy(), program.clamp.copy()
    for load in (applied, clamp):
        load[:, 3:] += cross(arm, load[:, :3])
    radius, tolerance = np.zeros(count), np.zeros(count)
    np.maximum.at(radius, group, program.radius + np.linalg.norm(arm, axis=1))
    np.maximum.at(tolerance, group, program.tolerance)
    free = np.ones(count, dtype=bool)
    free[group[~program.free]] = False
    group_or_ground = np.append(group, -1)
    a, b = group_or_ground[program.part_a], group_or_ground[program.part_b]
    still = ~np.append(free, False)
    rows = np.flatnonzero((a != b) & ~(still[a] & still[b]))
    first_part = np.unique(group, return_index=True)[1]
    return program.taking(rows).with_rows(
        names=tuple(program.names[k] for k in first_part),
        free=free,
        center=center,
        mass=mass,
        inertia=group_sums(group, program.inertia + steiner, count),
        radius=radius,
        applied=group_sums(group, applied, count),
        clamp=group_sums(group, clamp, count),
        part_a=a[rows],
        part_b=b[rows],
        tolerance=tolerance,
    )


REFINED = 4
"""Number of corrections of the balance of forces at welds."""
REGULAR = 1e-13
"""Regularisation of the balance of welds, over its largest diagonal entry."""


@dataclass(frozen=True, slots=True, eq=False)
class LockedParts:
    """A program whose locked parts are merged, with the way back to the original program."""

    whole: Program
    program: Program
    """The original program, and the smaller program. They are the same if nothing is locked."""
    group: Index
    """Part of the smaller program for each part of the original program, shape (N,)."""
    source: Index
    """Row of the original program for each row of the smaller program, shape (K',)."""
    welds: Welds | None
    """Rows that the smaller program lacks; None if nothing is locked."""

    def forces(self, down: Array, along: Array, aside: Array) -> tuple[Array, Array]:
        """Forces of the original program from those of the smaller program, for a gravity.

        Arguments: `down` (3,): direction of gravity, unit; `along`, `aside`: forces along and
        across the rows of the smaller program [N]. Returns `along, aside`: forces of the original
        program [N].
        """
        if self.welds is None:
            return along, aside
        vectors = np.zeros((len(self.whole.part_a), 3))
        np.add.at(vectors, self.source, along[:, None] * self.program.normal + aside)
        normal_force = np.einsum("ki,ki->k", vectors, self.whole.normal)
        tangential = vectors - normal_force[:, None] * self.whole.normal
        return self.welds.completed(down, normal_force, tangential)

    def motion(self, motion: Array) -> Array:
        """Motion of all parts, shape (N, 6), from a motion of the smaller program, (N', 6)."""
        if self.welds is None:
            return motion
        twist: Array = motion[self.group].copy()
        arm = self.whole.center - self.program.center[self.group]
        twist[:, :3] += cross(twist[:, 3:], arm)
        return twist


@dataclass(frozen=True, slots=True, eq=False)
class Welds:
    """Contacts that a self-stress (squeeze) loads inside their cones, and this self-stress."""

    wide: ConeProblem
    """Problem of the original program."""
    squeeze: Array
    """Scaled forces of the squeeze, one for each column of `wide`."""
    columns: Index
    """Columns of the welded contacts and of the joints."""
    balancing: Callable[[Array], Array]
    """Shortest forces of these columns, weighted by the depths of the squeeze, for a load."""
    half_lines: Index
    heads: Index
    """Welded rows without friction, and the number of each welded cone in `wide.rough`."""

    def completed(self, down: Array, along: Array, aside: Array) -> tuple[Array, Array]:
        """Forces that also balance each locked part under gravity along `down`, (K,), (K, 3)."""
        wide = self.wide
        problem = wide.problem
        scale = problem.unit * wide.program.arm
        tangents = np.einsum("kdi,ki->dk", wide.directions, aside[wide.rough])
        x = np.concatenate([along / scale, tangents.ravel() / problem.unit])
        right = problem.scaled_load(wide.program.turned(down).load)
        for _ in range(REFINED):
            x[self.columns] += self.balancing(right - problem.matrix @ x)
        needed, firm = -self._depths(x), self._depths(self.squeeze)
        share = max(float((needed / firm).max(initial=0.0)), 0.0)
        return wide.decoded(x + share * self.squeeze)

    def _depths(self, x: Array) -> Array:
        """Depth of each welded force in its half line or cone, scaled."""
        return _depths(self.wide, x, self.half_lines, self.heads)


def _depths(wide: ConeProblem, x: Array, half_lines: Index, heads: Index) -> Array:
    """Depths of scaled forces in the half lines of some rows, then in some of the rough cones."""
    rough = wide.rough[heads]
    tangents = x[len(wide.program.part_a) :].reshape(-1, len(wide.rough))[:, heads]
    cones = wide.program.mu[rough] * x[rough] - np.sqrt((tangents**2).sum(axis=0))
    return np.concatenate([x[half_lines], cones])


def find_locked_parts(program: Program) -> LockedParts:
    """Merge the parts of a program that a self-stress (squeeze) can lock together.

    Examples
    --------
    >>> from kilter.contact import contacts
    >>> from kilter.mechanics.program import build_program
    >>> from kilter.scenes import friction, stacks
    >>> def left(assembly):
    ...     locked = find_locked_parts(build_program(assembly, contacts(assembly)))
    ...     return int(locked.program.free.sum())
    >>> left(stacks.block_on_slope(0.0, friction=0.5)), left(friction.h_block())
    (1, 0)
    """
    from kilter.solvers.clarabel import solve_conic

    count = len(program.part_a)
    same = LockedParts(program, program, np.arange(len(program.names)), np.arange(count), None)
    if program.has_strength or program.planar or not program.mu.any():
        return same
    wide = cone_problem(program)
    half_lines = np.flatnonzero(~program.two_sided & (program.mu <= 0))
    answer = solve_conic(_firmest_squeeze(wide))
    if not answer.found:
        return same
    total = wide.problem.matrix.shape[1]
    welded = answer.x[total:] > LOCKED
    if not welded.any():
        return same
    welds = _welds(wide, answer.x[:total], half_lines, welded)
    rows = np.concatenate([welds.half_lines, wide.rough[welds.heads]])
    group, smaller = _merged(program, rows)
    return LockedParts(program, smaller, group, smaller.source, welds)


def _firmest_squeeze(wide: ConeProblem) -> ConicProgram:
    """Conic program for the self-stress inside the most cones; x = (forces, depths t)."""
    matrix = wide.problem.matrix
    cone_matrix, positive, sizes = wide.cone_rows()
    total, count = matrix.shape[1], positive + len(sizes)
    heads = np.concatenate([np.arange(positive), positive + np.cumsum(sizes) - sizes])
    depth = csc_array(
        (np.ones(count), (heads.astype(np.int64), np.arange(count))),
        shape=(cone_matrix.shape[0], count),
    )
    none = csc_array((count, total))
    rows = [
        hstack([matrix, csc_array((matrix.shape[0], count))]),
        hstack([none, -eye_array(count)]),
        hstack([none, eye_array(count)]),
        hstack([-cone_matrix, depth]),
    ]
    bound = np.zeros(sum(row.shape[0] for row in rows))
    bound[matrix.shape[0] + count : matrix.shape[0] + 2 * count] = 1.0
    return ConicProgram(
        csc_array((total + count, total + count)),
        np.concatenate([np.zeros(total), -np.ones(count)]),
        csc_array(vstack(rows)),
        bound,
        matrix.shape[0],
        2 * count + positive,
        sizes,
    )


def _welds(wide: ConeProblem, squeeze: Array, half_lines: Index, welded: Mask) -> Welds:
    """The welded contacts, and the self-stress corrected by forces there and at joints."""
    count, rough = len(wide.program.part_a), len(wide.rough)
    straight = half_lines[welded[: len(half_lines)]]
    heads = np.flatnonzero(welded[len(half_lines) :])
    sides = [count + k * rough + heads for k in range(wide.directions.shape[1])]
    # joints may take part in the squeeze, with any force
    joints = np.flatnonzero(wide.program.two_sided)
    columns = np.concatenate([straight, wide.rough[heads], *sides, joints])
    depth = _depths(wide, squeeze, straight, heads)
    cones = depth[len(straight) :]
    weight = np.concatenate(
        [depth[: len(straight)], *[cones] * (1 + len(sides)), np.ones(len(joints))]
    )
    balancing = _balancing(wide.problem.matrix[:, columns], weight)
    balanced = np.zeros(len(squeeze))
    balanced[columns] = squeeze[columns]
    for _ in range(REFINED):
        balanced[columns] -= balancing(wide.problem.matrix @ balanced)
    return Welds(wide, balanced, columns, balancing, straight, heads)


def _balancing(matrix: csc_array, weight: Array) -> Callable[[Array], Array]:
    """Solver for the x of A x = b with the least sum of (x / weight)^2; the system may be singular.

    The regularisation leaves an error, which the caller removes by repeated calls.
    """
    from scipy.sparse.linalg import splu

    weighted = csc_array(matrix.multiply(weight**2))
    normal = csc_array(weighted @ matrix.T)
    diagonal = normal.diagonal()
    # a part without a weld has rows of zeros
    regular = np.where(diagonal > 0.0, REGULAR * max(diagonal.max(initial=0.0), TINY), 1.0)
    factor = splu(csc_array(normal + diags_array(regular)))

    def solve(right: Array) -> Array:
        result: Array = weighted.T @ factor.solve(right)
        return result

    return solve


def _merged(program: Program, welded: Index) -> tuple[Index, Program]:
    """Group of each part, and the program of the groups; `source` holds the original rows."""
    labelled = program.with_rows(source=np.arange(len(program.part_a)))
    group = np.arange(len(program.names))
    merged, rows = labelled, welded
    while True:
        joined = _rigid_groups(merged, rows)
        if len(np.unique(joined)) == len(joined):
            break
        merged, group = merge_parts(merged, joined), joined[group]
        rows = np.flatnonzero(np.isin(merged.source, welded))
    return group, _two_sided(merged, rows)


def _rigid_groups(program: Program, welded: Index) -> Index:
    """Group of each part, if parts are joined between which welded rows stop every motion."""
    a, b = program.part_a[welded], program.part_b[welded]
    held = np.append(~program.free, True)
    count = len(program.names)
    # all held parts and the ground are the part `count`
    first, second = np.where(held[a], count, a), np.where(held[b], count, b)
    low, high = np.minimum(first, second), np.maximum(first, second)
    pairs = [
        (low[rows[0]], high[rows[0]])
        for rows in _equal_runs(low * (count + 1) + high)
        if low[rows[0]] != high[rows[0]] and _rigid(program, welded[rows], low[rows[0]])
    ]
    ends = np.array(pairs, dtype=np.int64).reshape(-1, 2).T
    graph = csc_array((np.ones(ends.shape[1]), tuple(ends)), shape=(count + 1, count + 1))
    label = connected_components(graph, directed=False)[1]
    label = np.where(held[:-1], label[-1], label[:-1])
    if held[:-1].any():
        return np.unique(label, return_inverse=True)[1].reshape(-1)
    # without a held part no body is the ground: parts that are locked to it are not merged
    alone = label == label[-1]
    label = np.where(alone, count + 1 + np.arange(count), label)
    return np.unique(label, return_inverse=True)[1].reshape(-1)


def _equal_runs(keys: Index) -> list[Index]:
    """Indices of equal keys, an array for each key."""
    order = np.argsort(keys, kind="stable")
    if not len(order):
        return []
    return np.split(order, np.flatnonzero(np.diff(keys[order])) + 1)


def _rigid(program: Program, rows: Index, part: int) -> bool:
    """Whether welded rows between two parts stop every motion between them."""
    arm = (program.point[rows] - program.center[part]) / program.radius[part]
    normal = program.normal[rows]
    lever = np.hstack([normal, cross(arm, normal)])
    rubs = program.mu[rows] > 0
    sides = []
    for axis in np.eye(3):
        across = axis - normal[rubs] * (normal[rubs] @ axis)[:, None]
        sides.append(np.hstack([across, cross(arm[rubs], across)]))
    sizes = np.linalg.svd(np.vstack([lever, *sides]), compute_uv=False)
    return len(sizes) == 6 and bool(sizes[-1] > RIGID * sizes[0])


def _two_sided(program: Program, welded: Index) -> Program:
    """The program whose welded rows are two-sided, along the normal and across it."""
    if not len(welded):
        return program
    rubs = welded[program.mu[welded] > 0]
    kept = np.arange(len(program.part_a))
    rows = np.concatenate([kept, rubs, rubs])
    changed = program.taking(rows)
    wide = cone_problem(program)
    place = np.searchsorted(wide.rough, rubs)
    normal = changed.normal.copy()
    two_sided, mu = changed.two_sided.copy(), changed.mu.copy()
    two_sided[welded] = True
    mu[welded] = 0.0
    for k in range(2):
        chosen = len(kept) + k * len(rubs) + np.arange(len(rubs))
        normal[chosen], two_sided[chosen], mu[chosen] = wide.directions[place, k], True, 0.0
    return changed.with_rows(normal=normal, two_sided=two_sided, mu=mu)
