"""Contact forces of an equilibrium, and the share of friction that they use.

Forces of equilibrium are not unique: four legs of a rigid table share its weight in many
ways. The forces shown have the least sum of squares, a point inside the set of all
equilibria and not a corner of it: equal contacts take equal shares. Resultants of a
patch, and its centre of pressure, follow from the forces at its points.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.analysis.analysis_tolerances import PRESSES
from kilter.arrays import Array, Index, group_sums
from kilter.mechanics.certificate import ForceProof, check_forces
from kilter.mechanics.coulomb_cones import cone_problem, least_forces
from kilter.mechanics.program import Program
from kilter.mechanics.rows import CONTACT

__all__ = ["LIMIT", "ContactForces", "find_contact_forces"]


LIMIT = 3_000
"""Contact points above which the forces of the verdict's proof are shown as they are."""


@dataclass(frozen=True, slots=True, eq=False)
class ContactForces:
    """Forces of equilibrium at contact points and patches; world frame, on the second part.

    Attributes
    ----------
    rows : ndarray of int, shape (C,)
        Contact rows of the program.
    force : ndarray, shape (C, 3)
        At each point [N].
    patch : ndarray of int, shape (P,)
        Patches, by position in the contact set.
    patch_of : ndarray of int, shape (C,)
        Row of `patch` of each point.
    resultant : ndarray, shape (P, 3)
        Sum of the forces of each patch [N].
    normal_force : ndarray, shape (P,)
        Sum of the forces along the normals [N].
    center : ndarray, shape (P, 3)
        Centre of pressure: the mean of its points, weighted by normal force; for patches with bonds
        by the size of push or pull. NaN without a force.
    utilisation : ndarray, shape (P,)
        Friction over the limit of Coulomb's law, of the resultant and the clamp of bonds [-]; NaN
        without friction.
    bond_utilisation : ndarray, shape (P,)
        Pull over the strength of the bond, or shear over its limit, at the point with the
        largest value [-]; NaN without a bond.
    residual : float
        Worst imbalance of a part over its weight [-].
    least : bool
        True for the forces of the least sum of squares.
    """

    rows: Index
    force: Array
    patch: Index
    patch_of: Index
    resultant: Array
    normal_force: Array
    center: Array
    utilisation: Array
    bond_utilisation: Array
    residual: float
    least: bool


def find_contact_forces(program: Program, proof: ForceProof) -> ContactForces:
    """The forces to show for an equilibrium that `proof` has established.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> from kilter.analysis.check import check
    >>> verdict = check(scene("tower"))
    >>> found = find_contact_forces(verdict.program, verdict.judgement.forces)
    >>> bool(np.allclose(found.force, found.force[0]) or len(set(found.patch_of)) > 1)
    True
    """
    least = _least(program) if len(program.part_a) <= LIMIT else None
    used = proof if least is None else least
    rows = np.flatnonzero(program.kind == CONTACT)
    force = program.point_forces(used.forces, used.friction)
    along = np.einsum("ij,ij->i", force, program.normal[rows])
    across = force - along[:, None] * program.normal[rows]
    patch, patch_of = np.unique(program.source[rows], return_inverse=True)
    count = len(patch)
    normal_force = np.bincount(patch_of, along, minlength=count).astype(np.float64)
    pull = program.pull[rows]
    center = _centers(program, patch_of, count, along)
    mu = np.zeros(count)
    mu[patch_of] = program.mu[rows]
    aside = np.linalg.norm(group_sums(patch_of, across, count), axis=1)
    utilisation = np.full(count, np.nan)
    pressed = normal_force + np.bincount(patch_of, pull, minlength=count)
    rubs = (pressed > PRESSES * float(program.weight.max(initial=0.0))) & (mu > 0)
    utilisation[rubs] = aside[rubs] / (mu[rubs] * pressed[rubs])
    bonded = np.flatnonzero(pull > 0)
    drawn = np.full(count, -np.inf)
    np.maximum.at(drawn, patch_of[bonded], np.maximum(-along[bonded], 0.0) / pull[bonded])
    borne = np.flatnonzero(program.cohesion[rows] > 0)
    slid = np.linalg.norm(across[borne], axis=1) / program.cohesion[rows][borne]
    np.maximum.at(drawn, patch_of[borne], slid)
    return ContactForces(
        rows=rows,
        force=force,
        patch=patch,
        patch_of=patch_of,
        resultant=group_sums(patch_of, force, count),
        normal_force=normal_force,
        center=center,
        utilisation=utilisation,
        bond_utilisation=np.where(np.isfinite(drawn), drawn, np.nan),
        residual=used.residual,
        least=least is not None,
    )


def _centers(program: Program, patch_of: Index, count: int, along: Array) -> Array:
    """Centre of pressure of each patch, from the normal forces at points, shape (P, 3)."""
    rows = np.flatnonzero(program.kind == CONTACT)
    bonded = np.bincount(patch_of, program.pull[rows], minlength=count) > 0
    sizes = np.where(bonded[patch_of], np.abs(along), along)
    size = np.bincount(patch_of, sizes, minlength=count)
    weighted = group_sums(patch_of, sizes[:, None] * program.point[rows], count)
    presses = size > PRESSES * float(program.weight.max(initial=0.0))
    center = np.full((count, 3), np.nan)
    center[presses] = weighted[presses] / size[presses][:, None]
    return center


def _least(program: Program) -> ForceProof | None:
    """Forces of the least sum of squares, if they pass as a proof."""
    from kilter.solvers.clarabel import solve_conic

    if not program.free.any():
        return None
    wide = cone_problem(program)
    answer = solve_conic(least_forces(wide))
    if not answer.found:
        return None
    judged = check_forces(program, *wide.decoded(answer.x))
    return judged if judged.holds else None
