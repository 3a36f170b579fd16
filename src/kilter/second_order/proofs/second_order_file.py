"""The proof of second order as data of a proof file, and read from it.

A minimum: forces of each cone [N], motions of the parts that span what is neutral across the free
ones, the free ones, sides, splits and weights. What falls: both derivatives of its path, and the
exact configuration on it. What stands on level faces: forces and a level motion; what is held:
forces; what slides on faces and is locked else: forces and self-stress. Several clusters have one
of these each, None where it is open. Clusters, features, forms, free motions and separations are
found anew.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

from kilter.arrays import Array
from kilter.mechanics.program import Program
from kilter.second_order.gaps.stationary import Stationary
from kilter.second_order.motions.free_span import scaled_columns
from kilter.second_order.proofs.held import Held
from kilter.second_order.proofs.level_rest import LevelRest
from kilter.second_order.proofs.locked import LockedTurns
from kilter.second_order.proofs.minimum_proof import MinimumProof
from kilter.second_order.proofs.paths import Path
from kilter.second_order.proofs.stopped import Stopped
from kilter.validate import LARGEST

if TYPE_CHECKING:
    from kilter.second_order.answer.second_order_answer import SecondOrder

__all__ = [
    "counts",
    "numbers",
    "read_columns",
    "read_motion",
    "second_order_data",
    "square",
    "stacked",
]


def second_order_data(found: SecondOrder) -> dict[str, Any] | None:
    """The proof of an answer; None where it is open."""
    if found.state == "open":
        return None
    if found.clusters:
        entries = [second_order_data(one) for one in found.clusters]
        joint = {"state": found.state, **counts(entries), "clusters": entries}
        return joint | _rolling_of(found)
    problem, decision, program = found.problem, found.decision, found.program
    if decision is None or program is None:
        return None
    proof = decision.proof
    data: dict[str, Any] = {"state": found.state}
    if not isinstance(proof, Path):  # what falls is proved, not how much may move
        data |= {"neutral": found.neutral, "free": found.free}
    if isinstance(proof, Held):
        return data | {"held": proof.forces.tolist()}
    if isinstance(proof, LevelRest):
        named = named_motion(program, proof.motion)
        return data | {"level": proof.forces.tolist(), "motion": named}
    assert problem is not None
    if isinstance(proof, LockedTurns):
        forces = (proof.forces * problem.weight).tolist()
        return data | {"locked": forces, "stress": proof.stress.tolist()}
    if isinstance(proof, Stopped):
        return data | {
            "stopped": (proof.forces * problem.weight).tolist(),
            "weights": proof.weights.tolist(),
            "motion": by_part(program, problem, proof.opening),
        }
    if isinstance(proof, Path):
        place = found.configuration
        return (
            data
            | _rolling_of(found)
            | {
                "first": by_part(program, problem, proof.first),
                "second": by_part(program, problem, proof.second),
                "configuration": None if place is None else named_motion(program, place.motion),
            }
        )
    assert isinstance(proof, MinimumProof)
    if len(found.idle):
        data["idle"] = found.idle.tolist()
        if decision.opening is not None:
            data["motion"] = by_part(program, problem, decision.opening)
    return data | {
        "basis": [by_part(program, problem, one) for one in proof.basis.T],
        "across": [by_part(program, problem, one) for one in proof.free.T],
        "sides": proof.sides.tolist(),
        "splits": [None if one is None else list(one) for one in proof.splits],
        "forces": [(leaf.forces * problem.weight).tolist() for leaf in proof.leaves],
        "weights": [leaf.weights.tolist() for leaf in proof.leaves],
    }


def _rolling_of(found: SecondOrder) -> dict[str, str]:
    """What is proved of rolling."""
    rolling = found.rolling
    return {} if rolling is None or rolling.state == "open" else {"rolling": rolling.state}


def counts(entries: Iterable[dict[str, Any] | None]) -> dict[str, int]:
    """Motions of the clusters that are proved; none where one falls."""
    given = [one for one in entries if one is not None]
    if any(one["state"] == "balanced" for one in given):
        return {}
    return {key: sum(one[key] for one in given) for key in ("neutral", "free")}


def numbers(data: Any) -> Array:
    """An array of what are numbers, and not words for some, as "nan"; their sums are some, too."""
    found = np.asarray(data)
    if found.dtype.kind not in "iuf":
        raise TypeError("not all are numbers")
    found = found.astype(float)
    if not (np.abs(found) <= LARGEST).all():
        raise ValueError("a number is too large")
    return found


def square(weights: Any) -> Array:
    """Rows of numbers as a square, shape (n, n)."""
    size = len(weights)
    return numbers(weights).reshape(size, size)


def stacked(program: Program, problem: Stationary, motions: list[Any]) -> Array:
    """Motions as columns of scaled unknowns, shape (n, d)."""
    columns = [read_columns(program, problem, one) for one in motions]
    return np.array(columns).T if columns else np.zeros((len(problem.load), 0))


def by_part(program: Program, problem: Stationary, columns: Array) -> dict[str, list[float]]:
    assert problem.scale is not None
    return named_motion(program, program.full(columns * problem.scale))


def named_motion(program: Program, motion: Array) -> dict[str, list[float]]:
    """A motion by the names of the free parts."""
    return {program.names[k]: motion[k].tolist() for k in np.flatnonzero(program.free)}


def read_motion(program: Program, named: dict[str, Any]) -> Array:
    """A motion of all parts, shape (N, 6); of no others, and of every free one."""
    free = [program.names[k] for k in np.flatnonzero(program.free)]
    if set(named) != set(free):
        raise ValueError("a motion is not one of the free parts")
    motion = np.zeros((len(program.names), 6))
    motion[program.free] = numbers([named[name] for name in free]).reshape(-1, 6)
    if np.delete(motion, program.freedoms, axis=1).any():
        raise ValueError("a motion leaves the plane")
    return motion


def read_columns(program: Program, problem: Stationary, named: dict[str, Any]) -> Array:
    """A motion in scaled unknowns, shape (n,)."""
    return scaled_columns(program, problem, read_motion(program, named)[None])[:, 0]
