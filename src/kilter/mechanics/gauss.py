"""Gauss's principle as the shortest vector of a cone, halved where the assembly is a mirror image.

With M = L L^T of each part and b = L^T a the principle reads

    min 1/2 |b|^2 - v.b,   R b >= 0          v = L^-1 w,  R = J L^-T, rows of length 1

so that masses of any ratio leave the numbers near 1: `unit` of a row turns its slack and its
force to accelerations over gravity of the lightest part that it touches.

Where reflection in a plane through the centres of all parts maps the rows on themselves, the
motion, being unique, is its own mirror image: it has no part across that plane. Half of the
unknowns and nearly half of the rows then go, and a factorisation costs a tenth.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import bsr_array, csr_array, diags_array

from kilter.arrays import TINY, Array, Index, Mask
from kilter.mechanics.forms import ScaledProblem, impending_motion
from kilter.mechanics.mechanics_tolerances import MIRROR, MIRROR_CELL, MIRROR_ROWS, ZERO_ENTRY
from kilter.solvers.problem import ConeProjection, ConicProgram

__all__ = ["LeastConstraint", "least_constraint", "mirror_half"]


OFFSET = 0.31830988618
"""Where cells begin: round coordinates must not lie on their edges."""


@dataclass(frozen=True, slots=True, eq=False)
class LeastConstraint:
    """The point of the cone of allowed motions nearest to free fall, and how to read it.

    Attributes
    ----------
    cone : ConeProjection
        Blocks are parts; units turn slacks and multipliers to accelerations over gravity.
    columns : ndarray of int, shape (n,)
        Unknowns of the whole problem that are unknowns here.
    inverse : csr_array, shape (n_all, n_all)
        L^-T: a = L^-T b.
    row : ndarray of int, shape (K_all,)
        Row here of each row of the whole problem, in its own order.
    share : ndarray, shape (K_all,)
        Force of each of those rows over the multiplier here.
    """

    cone: ConeProjection
    columns: Index
    inverse: csr_array
    row: Index
    share: Array

    def accelerations(self, unknowns: Array) -> Array:
        """Scaled accelerations of the free parts: what `ScaledProblem.motion` takes."""
        full = np.zeros(self.inverse.shape[0])
        full[self.columns] = unknowns
        return np.asarray(self.inverse @ full)

    def forces(self, multipliers: Array) -> Array:
        """Forces of all rows over the weight of the heaviest part, shape (K_all,)."""
        return multipliers[self.row] * self.share


def least_constraint(problem: ScaledProblem) -> LeastConstraint:
    """The whole problem, in the frame and the freedoms of `problem`."""
    quadratic = impending_motion(problem)
    block = len(problem.program.freedoms)
    inverse = _inverse_root(quadratic, block)
    rows = csr_array(-quadratic.matrix @ inverse)
    length = np.sqrt(np.asarray(rows.multiply(rows).sum(axis=1)).ravel())
    length = np.maximum(length, TINY)
    rows = csr_array(diags_array(1.0 / length) @ rows)
    rows.data[np.abs(rows.data) < ZERO_ENTRY] = 0.0
    rows.eliminate_zeros()
    order = np.argsort(~problem.program.two_sided, kind="stable")
    place = np.empty(len(order), dtype=np.int64)
    place[order] = np.arange(len(order))
    load = -np.asarray(inverse.T @ quadratic.cost)
    places = problem.program.center[problem.program.free]
    return LeastConstraint(
        ConeProjection(rows, load, quadratic.equal, block, length, places),
        np.arange(rows.shape[1]),
        inverse,
        place,
        problem.program.arm / length[place],
    )


def _inverse_root(quadratic: ConicProgram, block: int) -> csr_array:
    """L^-T of M = L L^T, part by part."""
    count = quadratic.quadratic.shape[0] // block
    parts = np.zeros((count, block, block))
    entries = quadratic.quadratic.tocoo()
    i, j = entries.coords
    parts[i // block, i % block, j % block] = entries.data
    inverse = np.linalg.inv(np.linalg.cholesky(parts))
    turned = np.ascontiguousarray(np.swapaxes(inverse, 1, 2))
    root = csr_array(bsr_array((turned, np.arange(count), np.arange(count + 1))))
    root.data[np.abs(root.data) < MIRROR * np.abs(root.data).max(initial=0.0)] = 0.0
    root.eliminate_zeros()
    return root


def mirror_half(whole: LeastConstraint, problem: ScaledProblem) -> LeastConstraint | None:
    """The same problem within a plane of reflection, if there is one along an axis of the frame."""
    cone = whole.cone
    if cone.block != 6 or cone.equal or not len(cone.unit):
        return None
    for axis in (2, 1, 0):
        odd = np.ones(6, dtype=bool)
        odd[[k for k in range(3) if k != axis]] = False
        odd[3 + axis] = False
        across = np.tile(odd, cone.rows.shape[1] // 6)
        if np.abs(cone.load[across]).max(initial=0.0) > MIRROR * np.abs(cone.load).max():
            continue
        if _couples(whole.inverse, across):
            continue
        image = _image(problem, axis)
        sign = diags_array(np.where(across, -1.0, 1.0))
        difference = abs(cone.rows[image] - cone.rows @ sign)
        twice = np.array_equal(image[image], np.arange(len(image)))
        if twice and difference.max() <= MIRROR_ROWS:
            return _within(whole, across, image)
    return None


def _couples(inverse: csr_array, across: Mask) -> bool:
    """Whether inertia couples motions in the plane with motions across it."""
    i, j = inverse.tocoo().coords
    return bool((across[i] != across[j]).any())


def _image(problem: ScaledProblem, axis: int) -> Index:
    """The row that reflection across `axis` of the frame makes of each row, if it is one."""
    program = problem.program
    own = np.where((program.part_b >= 0) & program.free[program.part_b], program.part_b, -1)
    own = np.where(own >= 0, own, program.part_a)
    arm = (program.point - program.center[own]) @ problem.frame.T / program.radius[own][:, None]
    places = np.floor(
        np.column_stack([arm, program.normal @ problem.frame.T]) / MIRROR_CELL + OFFSET
    )
    depth = np.column_stack([arm[:, axis], (program.normal @ problem.frame.T)[:, axis]])
    depth = np.rint(depth / MIRROR_CELL)
    plane = [places[:, k] for k in range(6) if k % 3 != axis]
    keys = [*plane, program.part_a, program.part_b]
    one = np.lexsort([depth[:, 1], depth[:, 0], *keys])
    other = np.lexsort([-depth[:, 1], -depth[:, 0], *keys])
    image = np.empty(len(one), dtype=np.int64)
    image[one] = other
    return image


def _within(whole: LeastConstraint, across: Mask, image: Index) -> LeastConstraint:
    cone = whole.cone
    kept = np.flatnonzero(np.arange(len(image)) <= image)
    columns = np.flatnonzero(~across)
    rows = csr_array(cone.rows[kept][:, columns])
    length = np.maximum(np.sqrt(np.asarray(rows.multiply(rows).sum(axis=1)).ravel()), TINY)
    number = np.empty(len(image), dtype=np.int64)
    number[kept] = np.arange(len(kept))
    number[image[kept]] = np.arange(len(kept))
    alone = image == np.arange(len(image))
    share = np.where(alone, 1.0, 0.5) / (length[number] * cone.unit)
    unit_rows = csr_array(diags_array(1.0 / length) @ rows)
    return LeastConstraint(
        ConeProjection(unit_rows, cone.load[columns], 0, 3, length * cone.unit[kept], cone.place),
        columns,
        whole.inverse,
        number,
        share,
    )
