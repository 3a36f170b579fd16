"""Gauss's principle as the shortest vector of a cone; mirror symmetry halves the problem.

With M = L L^T of each part and b = L^T a the principle reads

    min 1/2 |b|^2 - v.b,   R b >= 0          v = L^-1 w,  R = J L^-T, rows of length 1

so that the numbers are near 1 for masses of any ratio. The `unit` of a row converts its slack and
its force to accelerations over gravity of the lightest part at the row.

If reflection in a plane through the centres of all parts maps the rows onto themselves, the unique
motion is its own mirror image: it has no component across that plane. Half of the unknowns and
nearly half of the rows can then be removed, and a factorisation costs a tenth.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import bsr_array, csr_array, diags_array

from kilter.arrays import TINY, Array, Index, Mask
from kilter.mechanics.forms import ScaledProblem, impending_motion
from kilter.mechanics.mechanics_tolerances import MIRROR, MIRROR_CELL, MIRROR_ROWS, ZERO_ENTRY
from kilter.solvers.problem import ConeProjection, ConicProgram

OFFSET = 0.31830988618
"""Shift of the grid cells by an irrational fraction, so that round coordinates do not lie on
borders."""


@dataclass(frozen=True, slots=True, eq=False)
class LeastConstraint:
    """Gauss's problem: the admissible motion nearest to free fall, with the data to decode it."""

    cone: ConeProjection
    """The problem. Blocks are parts; units convert slacks and multipliers to accelerations over
    gravity."""
    columns: Index
    """Unknowns of the whole problem that are unknowns of `cone`, shape (n,)."""
    inverse: csr_array
    """L^-T, shape (n_all, n_all): a = L^-T b."""
    row: Index
    """Row of `cone` for each row of the whole problem, in the order of the whole problem, shape
    (K_all,)."""
    share: Array
    """Force of each of those rows over the multiplier of its row in `cone`, shape (K_all,)."""

    def accelerations(self, unknowns: Array) -> Array:
        """Scaled accelerations of the free parts, from the unknowns of this problem."""
        full = np.zeros(self.inverse.shape[0])
        full[self.columns] = unknowns
        return np.asarray(self.inverse @ full)

    def forces(self, multipliers: Array) -> Array:
        """Forces of all rows over the heaviest part's weight, (K_all,), from the multipliers."""
        return multipliers[self.row] * self.share


def least_constraint(problem: ScaledProblem) -> LeastConstraint:
    """Build Gauss's problem (motion nearest to free fall) in all freedoms of `problem`."""
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
    """Matrix L^-T of the Cholesky factors of the inertia M = L L^T, with a block for each part."""
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
    """Restrict Gauss's problem to mirror-symmetric motions; None without a mirror plane."""
    cone = whole.cone
    if cone.block != 6 or cone.equal or not len(cone.unit):
        return None
    for axis in (2, 1, 0):
        antisymmetric_freedoms = np.ones(6, dtype=bool)
        antisymmetric_freedoms[[k for k in range(3) if k != axis]] = False
        antisymmetric_freedoms[3 + axis] = False
        antisymmetric = np.tile(antisymmetric_freedoms, cone.rows.shape[1] // 6)
        # a load across the plane breaks the symmetry, and so do inertias that couple in and out of
        # plane
        if np.abs(cone.load[antisymmetric]).max(initial=0.0) > MIRROR * np.abs(cone.load).max():
            continue
        if _couples(whole.inverse, antisymmetric):
            continue
        image = _mirrored_rows(problem, axis)
        sign = diags_array(np.where(antisymmetric, -1.0, 1.0))
        difference = abs(cone.rows[image] - cone.rows @ sign)
        is_involution = np.array_equal(image[image], np.arange(len(image)))
        if is_involution and difference.max() <= MIRROR_ROWS:
            return _restrict(whole, antisymmetric, image)
    return None


def _couples(inverse: csr_array, antisymmetric: Mask) -> bool:
    """Whether the inertia couples motions within the mirror plane to motions across it."""
    i, j = inverse.tocoo().coords
    return bool((antisymmetric[i] != antisymmetric[j]).any())


def _mirrored_rows(problem: ScaledProblem, axis: int) -> Index:
    """Index of the mirror image of each row across the plane perpendicular to `axis`.

    The result is a guess from sorted rounded coordinates; the caller verifies it on the matrix.
    """
    program = problem.program
    part = np.where((program.part_b >= 0) & program.free[program.part_b], program.part_b, -1)
    part = np.where(part >= 0, part, program.part_a)
    arm = (program.point - program.center[part]) @ problem.frame.T / program.radius[part][:, None]
    places = np.floor(
        np.column_stack([arm, program.normal @ problem.frame.T]) / MIRROR_CELL + OFFSET
    )
    depth = np.column_stack([arm[:, axis], (program.normal @ problem.frame.T)[:, axis]])
    depth = np.rint(depth / MIRROR_CELL)
    in_plane = [places[:, k] for k in range(6) if k % 3 != axis]
    keys = [*in_plane, program.part_a, program.part_b]
    order = np.lexsort([depth[:, 1], depth[:, 0], *keys])
    mirrored_order = np.lexsort([-depth[:, 1], -depth[:, 0], *keys])
    image = np.empty(len(order), dtype=np.int64)
    image[order] = mirrored_order
    return image


def _restrict(whole: LeastConstraint, across: Mask, image: Index) -> LeastConstraint:
    """Restrict Gauss's problem to the mirror-symmetric unknowns, with one row per mirror pair."""
    cone = whole.cone
    kept = np.flatnonzero(np.arange(len(image)) <= image)
    columns = np.flatnonzero(~across)
    rows = csr_array(cone.rows[kept][:, columns])
    length = np.maximum(np.sqrt(np.asarray(rows.multiply(rows).sum(axis=1)).ravel()), TINY)
    kept_row = np.empty(len(image), dtype=np.int64)
    kept_row[kept] = np.arange(len(kept))
    kept_row[image[kept]] = np.arange(len(kept))
    self_image = image == np.arange(len(image))
    share = np.where(self_image, 1.0, 0.5) / (length[kept_row] * cone.unit)
    unit_rows = csr_array(diags_array(1.0 / length) @ rows)
    return LeastConstraint(
        ConeProjection(unit_rows, cone.load[columns], 0, 3, length * cone.unit[kept], cone.place),
        columns,
        whole.inverse,
        kept_row,
        share,
    )
