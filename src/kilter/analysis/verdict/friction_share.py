"""The share of the friction that the force and the moment of each contact patch need at least.

A patch presses with n_i at its points x_i, and p_i contains the strength of its bonds. The friction
t_i transmits, together with n_i, the force F and the moment M of the patch:

    s = min max_i |t_i| / (mu p_i):   sum f_i = F,   sum x_i x f_i = M,   n_i >= -pull_i

It is the smallest factor of mu with which the points can carry this force and this moment. The
resultant alone would give a smaller number: friction that only turns has no resultant, and points
at an edge may carry most of the pressure. Faces that can wedge do not press more than they do.

Conic programs find s. From a share s_k with pressures p_i^k, starting with s_0 = 1, the next is

    min z:  |t_i| <= mu (s_k p_i + z p_i^k)         s_{k+1} = max_i |t_i| / (mu p_i)

All patches are in one program, each with its own z; up to ten programs are enough.

References
----------
J. P. Crouzeix, J. A. Ferland, S. Schaible, An algorithm for generalized fractional programs, 1985.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import block_diag, coo_array, csc_array, hstack, vstack

from kilter.arrays import Array, Index, across, cross
from kilter.solvers.problem import ConicProgram

PROGRAMS = 20
"""Largest number of conic programs."""
AGREES = 1e-7
"""Decrease of a share below which it is final [-]."""
NO_SLIP = 1e-8
"""Friction below this share of the mean pressure is none [-]."""
LIGHT = 1e-2
"""Pressures below this share of the mean count as this share in a step [-]. A smaller value takes
more steps to shift pressure to points without pressure."""
RANK = 1e-9
"""Singular values of the equations of a patch below this, over the largest, are zero [-]."""
PARALLEL = 1e-9
"""Normals of a flat patch differ by at most this [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class PressedPatch:
    """Points of a contact patch with friction, and their forces."""

    points: Array
    normals: Array
    forces: Array
    """[length unit], [-], [N], shape (n, 3)."""
    mu: float
    """Coefficient of friction, positive."""
    pull: Array
    extra: Array
    """Tensile strength of bonds, and the limit of friction at a force of 0 over mu [N], shape
    (n,)."""


@dataclass(slots=True, eq=False)
class _Scaled:
    """A patch in units of its mean pressure: forces (n, u, v) of its points, and its equations."""

    mu: float
    forces: Array
    extra: Array
    pull: Array
    equations: Array
    most: float
    flat: bool
    share: float = 1.0
    final: bool = False

    @property
    def pressures(self) -> Array:
        pressures: Array = self.forces[:, 0] + self.extra
        return pressures

    def worst(self) -> float:
        """Largest share of the friction at a point."""
        slip = np.linalg.norm(self.forces[:, 1:], axis=1) / self.mu
        held = np.maximum(self.pressures, NO_SLIP * NO_SLIP)
        return float(np.max(slip / held, where=slip * self.mu > NO_SLIP, initial=0.0))


def friction_shares(patches: list[PressedPatch]) -> Array:
    """Least share of its friction that each pressed patch needs, from 0 to 1, shape (P,).

    If a conic program fails, the share of the last program remains, which is an upper bound.

    Examples
    --------
    >>> corners = np.array([[1.0, 1, 0], [-1, 1, 0], [-1, -1, 0], [1, -1, 0]])
    >>> around = np.column_stack([-corners[:, 1], corners[:, 0], np.zeros(4)]) / 2**0.5
    >>> up = np.tile([0.0, 0, 1], (4, 1))
    >>> none = np.zeros(4)
    >>> turned = PressedPatch(corners, up, 10 * up + 2.97 * around, 0.3, none, none)
    >>> friction_shares([turned]).round(6).tolist()
    [0.99]
    """
    scaled = [_scaled(patch) for patch in patches]
    for patch in scaled:
        patch.share = min(patch.worst(), 1.0)
        patch.final = patch.share == 0.0 or len(patch.forces) == 1
    for _ in range(PROGRAMS):
        open_patches = [patch for patch in scaled if not patch.final]
        if not open_patches or not _step(open_patches):
            break
    return np.array([patch.share for patch in scaled])


def _scaled(patch: PressedPatch) -> _Scaled:
    """The patch in units of its mean pressure, with the independent equations of its wrench."""
    frames = np.stack([patch.normals, *across(patch.normals)], axis=1)
    forces = np.einsum("nij,nj->ni", frames, patch.forces)
    unit = float((forces[:, 0] + patch.extra).mean())
    arms = patch.points - patch.points.mean(axis=0)
    arms = arms / max(float(np.abs(arms).max()), np.finfo(float).tiny)
    moments = cross(np.repeat(arms[:, None], 3, axis=1), frames)
    columns = np.concatenate([frames, moments], axis=2).reshape(-1, 6)
    _, sizes, rows = np.linalg.svd(columns.T, full_matrices=False)
    flat = bool(np.abs(patch.normals - patch.normals[0]).max() <= PARALLEL)
    return _Scaled(
        patch.mu, forces / unit, patch.extra / unit, patch.pull / unit,
        rows[sizes > RANK * sizes[0]], float(forces[:, 0].sum()) / unit, flat,
    )  # fmt: skip


def _step(patches: list[_Scaled]) -> bool:
    """Solve a program for all given patches and lower their shares; False if it fails."""
    from kilter.solvers.clarabel import solve_conic

    answer = solve_conic(_program(patches))
    if not answer.found:
        return False
    ends = np.cumsum([len(patch.forces) for patch in patches])
    found = answer.x[: 3 * ends[-1]].reshape(-1, 3)
    for patch, forces in zip(patches, np.split(found, ends[:-1]), strict=True):
        before, kept = patch.share, patch.forces
        patch.forces = forces
        patch.share = min(patch.worst(), before)
        patch.final = before - patch.share <= AGREES
        if patch.final:
            patch.share, patch.forces = before, kept
    return True


def _program(patches: list[_Scaled]) -> ConicProgram:
    """Conic program of a step: the forces (n, u, v) of all points, then z of each patch."""
    count = np.array([len(patch.forces) for patch in patches])
    total, owner = int(count.sum()), np.repeat(np.arange(len(patches)), count)
    equations = csc_array(block_diag([patch.equations for patch in patches]))
    known = np.concatenate([patch.forces.ravel() for patch in patches])
    none = csc_array((equations.shape[0], len(patches)))
    pressed = np.array([not patch.flat for patch in patches])
    normal = 3 * np.arange(total)
    limited = _entries((np.cumsum(pressed) - 1)[owner][pressed[owner]], normal[pressed[owner]],
                       1.0, (int(pressed.sum()), 3 * total + len(patches)))  # fmt: skip
    most = np.array([patch.most for patch in patches])[pressed]
    pushes = _entries(np.arange(total), normal, -1.0, (total, 3 * total + len(patches)))
    share = np.array([patch.share for patch in patches])[owner]
    mu = np.array([patch.mu for patch in patches])[owner]
    extra = np.concatenate([patch.extra for patch in patches])
    step = np.maximum(np.concatenate([patch.pressures for patch in patches]), LIGHT)
    rows = np.concatenate([normal, normal, normal + 1, normal + 2])
    columns = np.concatenate([normal, 3 * total + owner, normal + 1, normal + 2])
    values = np.concatenate([-share, -step, -1 / mu, -1 / mu])
    cones = _entries(rows, columns, values, (3 * total, 3 * total + len(patches)))
    heads = np.zeros(3 * total)
    heads[::3] = share * extra
    pull = np.concatenate([patch.pull for patch in patches])
    size = 3 * total + len(patches)
    return ConicProgram(
        csc_array((size, size)),
        np.append(np.zeros(3 * total), np.ones(len(patches))),
        csc_array(vstack([hstack([equations, none]), limited, pushes, cones])),
        np.concatenate([equations @ known, most, pull, heads]),
        equations.shape[0],
        len(most) + total,
        np.full(total, 3),
    )


def _entries(
    rows: Index, columns: Index, values: Array | float, shape: tuple[int, int]
) -> csc_array:
    """Sparse matrix with the given entries."""
    return csc_array(coo_array((np.broadcast_to(values, len(rows)), (rows, columns)), shape=shape))
