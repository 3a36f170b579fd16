"""Oscillation rate about an energy minimum, and growth rate of a push on a balanced assembly."""

from __future__ import annotations

import numpy as np

from kilter.arrays import Array
from kilter.mechanics.program import Program
from kilter.second_order.gaps.stationary import Stationary
from kilter.second_order.motions.null_space import null_space
from kilter.second_order.proofs.minimum_proof import MinimumProof
from kilter.second_order.proofs.paths import Path
from kilter.second_order.searches.critical import Critical
from kilter.second_order.second_order_tolerances import ACROSS, LEVEL
from kilter.units import metres_per_unit

__all__ = ["growth_rate", "least_frequency"]


def least_frequency(program: Program, problem: Stationary, proof: object) -> float | None:
    """Least angular frequency of oscillations about a minimum [rad/s]; None if not proved.

    None if the proof has no neutral motions, or has forces for each of several cones.
    """
    if not isinstance(proof, MinimumProof) or not proof.basis.shape[1] or len(proof.leaves) > 1:
        return None
    curvature = problem.curvature(proof.leaves[0].forces, proof.basis)
    mass = proof.basis.T @ _mass(program, problem) @ proof.basis
    lower = np.linalg.inv(np.linalg.cholesky(mass))
    least = float(np.linalg.eigvalsh(lower @ curvature @ lower.T).min())
    return float(np.sqrt(max(least, 0.0))) * _per_second(program)


def growth_rate(
    program: Program, problem: Stationary, path: Path, critical: Critical | None
) -> float:
    """Exponential growth rate of a small push [1/s]: of the fastest mode of touching motions.

    The modes solve K c = -s^2 M c in the basis of the critical motions, with the curvature K of the
    energy under the contact forces. The rate is that of `path`, which may be slower, if the fastest
    mode closes a contact in both senses or makes a corner slip off a face, or if the forces are not
    unique and K depends on them.
    """
    mass = _mass(program, problem)
    growth = path.power / float(path.first @ mass @ path.first)
    if critical is not None:
        touching = critical.basis @ null_space(critical.sides, problem.blur)
        for basis in (critical.basis, touching):
            growth = max(growth, _fastest(problem, critical, basis, mass))
    return float(np.sqrt(growth)) * _per_second(program)


def _fastest(problem: Stationary, critical: Critical, basis: Array, mass: Array) -> float:
    """Square of the rate of the fastest mode in a basis, scaled; 0 if it is not certain."""
    stresses = null_space(problem.rows[critical.carries].T, problem.blur)
    if not basis.shape[1]:
        return 0.0
    curvature = problem.curvature(critical.forces, basis)
    level = LEVEL * max(float(np.abs(curvature).max()), 1.0)
    for stress in stresses.T:
        forces = np.zeros(len(problem.rows))
        forces[critical.carries] = stress
        if np.abs(problem.curvature(forces, basis)).max() > level:
            return 0.0
    lower = np.linalg.inv(np.linalg.cholesky(basis.T @ mass @ basis))
    values, vectors = np.linalg.eigh(lower @ curvature @ lower.T)
    mode = basis @ (lower.T @ vectors[:, 0])
    mode = mode / float(np.linalg.norm(mode))
    sides = critical.sides @ (critical.basis.T @ mode)
    opens = min(float(-sides.min(initial=0.0)), float(sides.max(initial=0.0))) <= ACROSS
    return max(-float(values[0]), 0.0) if opens and problem.one_form(mode[:, None]).all() else 0.0


def _mass(program: Program, problem: Stationary) -> Array:
    """Mass matrix in scaled unknowns, over weight x length, (n, n) [s^2 x length unit / m]."""
    assert problem.scale is not None
    free, per = np.flatnonzero(program.free), len(program.freedoms)
    total = np.zeros((len(problem.scale), len(problem.scale)))
    for i, part in enumerate(free):
        six = np.zeros((6, 6))
        six[:3, :3] = program.mass[part] * np.eye(3)
        six[3:, 3:] = program.inertia[part]
        block = slice(per * i, per * (i + 1))
        total[block, block] = six[np.ix_(program.freedoms, program.freedoms)]
    return total * np.outer(problem.scale, problem.scale) / (problem.weight * problem.length)


def _per_second(program: Program) -> float:
    """Factor from scaled frequencies to frequencies: sqrt(1 N / (kg x length unit)) [1/s]."""
    return float(1.0 / np.sqrt(metres_per_unit(program.units)))
