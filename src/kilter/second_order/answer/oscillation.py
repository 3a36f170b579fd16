"""Oscillation rate about an energy minimum, and growth rate of a push on a balanced assembly."""

from __future__ import annotations

import numpy as np

from kilter.arrays import Array
from kilter.mechanics.program import Program
from kilter.second_order.gaps.stationary import Stationary
from kilter.second_order.proofs.minimum_proof import MinimumProof
from kilter.second_order.proofs.paths import Path
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


def growth_rate(program: Program, problem: Stationary, path: Path) -> float:
    """Exponential growth rate of a small push along a path that leads down [1/s]."""
    growth = path.power / float(path.first @ _mass(program, problem) @ path.first)
    return float(np.sqrt(growth)) * _per_second(program)


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
