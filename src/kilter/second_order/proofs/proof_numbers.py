"""Numbers of a proof file as arrays, and motions by the names of their parts."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from kilter.arrays import Array
from kilter.mechanics.program import Program
from kilter.mechanics.proof_form import MalformedProof
from kilter.second_order.gaps.stationary import Stationary
from kilter.second_order.motions.free_span import scaled_columns

__all__ = [
    "MalformedProof",
    "by_part",
    "counts",
    "named_motion",
    "read_columns",
    "read_motion",
    "square",
    "stacked",
]


def counts(entries: Iterable[dict[str, Any] | None]) -> dict[str, int]:
    """Total counts of motions over the proofs of clusters; empty if any cluster falls."""
    given = [entry for entry in entries if entry is not None]
    if any(entry["state"] == "balanced" for entry in given):
        return {}
    return {key: sum(entry[key] for entry in given) for key in ("neutral", "free")}


def square(weights: list[Any]) -> Array:
    """Square matrix from its list of rows, shape (n, n)."""
    size = len(weights)
    if any(len(row) != size for row in weights):
        raise MalformedProof("weights are not square")
    return np.array(weights, dtype=float).reshape(size, size)


def stacked(program: Program, problem: Stationary, motions: Iterable[Any]) -> Array:
    """Convert motions of proof data to columns of scaled unknowns, shape (n, d)."""
    columns = [read_columns(program, problem, motion) for motion in motions]
    return np.array(columns).T if columns else np.zeros((len(problem.load), 0))


def by_part(program: Program, problem: Stationary, columns: Array) -> dict[str, list[float]]:
    """Convert a motion in scaled unknowns, shape (n,), to numbers by part name."""
    assert problem.scale is not None
    return named_motion(program, program.full(columns * problem.scale))


def named_motion(program: Program, motion: Array) -> dict[str, list[float]]:
    """Convert a motion of all parts, shape (N, 6), to numbers by part name."""
    return {program.names[k]: motion[k].tolist() for k in np.flatnonzero(program.free)}


def read_motion(program: Program, named: dict[str, Any]) -> Array:
    """Read a motion of all parts, shape (N, 6), from six numbers for each free part.

    Raises `MalformedProof` if the names are not those of the free parts, or a motion leaves the
    plane.
    """
    free = [program.names[k] for k in np.flatnonzero(program.free)]
    if set(named) != set(free):
        raise MalformedProof("a motion does not belong to the free parts")
    motion = np.zeros((len(program.names), 6))
    motion[program.free] = np.array([named[name] for name in free], dtype=float).reshape(-1, 6)
    if np.delete(motion, program.freedoms, axis=1).any():
        raise MalformedProof("a motion leaves the plane")
    return motion


def read_columns(program: Program, problem: Stationary, named: dict[str, Any]) -> Array:
    """Read a motion by part names, and convert it to scaled unknowns, shape (n,)."""
    return scaled_columns(program, problem, read_motion(program, named)[None])[:, 0]
