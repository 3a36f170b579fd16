"""What only slides: self-stress locks every turn of parts whose faces lie on faces.

Where faces lie on faces at points on no line, a motion that costs nothing to first order turns both
parts alike but for a turn about the normal, which is the same to first order wherever on the face
it is asked, and wherever along the normal. Let X be those of them that turn nothing: gaps of faces
are affine under translations, so that X keeps every gap and the energy for good. Let Y be the rest
of them, and s > 0 a self-stress on all that carries:

    J^T s = 0,     -Y^T H(s) Y positive definite,     J^T f + w = 0,  f >= 0

From any place x of X near by, what costs nothing is the same as seen from what is held, and s is a
self-stress there too, its force on each face at the same place within it. With z = y + m from x, m
across what is neutral, all gaps open and c, C > 0

    0 <= sum of s phi  gives  c |y|^2 <= C |m| (|y| + |m|):  |y| <= C |m|
    E - E_0 >= c |m| - C |m|^2 - C |x| |y|,  as f + t s > 0 on all that carries,

so that the energy is least on X, and there alone. The weight may push at a y from x (a block of the
paper's figure 9 that has slid out of line wants to turn): what is locked does not give.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from kilter.arrays import TINY, Array, Index, Mask, read_only
from kilter.contact.contact_set import ContactSet
from kilter.mechanics.program import Program
from kilter.mechanics.proof_form import NUMBER, Form, keys, list_of
from kilter.second_order.gaps.features_of import detected_rows
from kilter.second_order.gaps.stationary import Stationary
from kilter.second_order.motions.null_space import null_space
from kilter.second_order.proofs.carrying import carry_beyond_doubt
from kilter.second_order.proofs.cluster_facts import ClusterFacts, Outcome
from kilter.second_order.proofs.minimum_proof import definite
from kilter.second_order.second_order_tolerances import ACROSS, BALANCED, BEARS, SPREAD

__all__ = ["Faces", "LockedTurns", "faces_of", "judge_locked", "shifts"]


@dataclass(frozen=True, slots=True, eq=False)
class Faces:
    """Of K rows: the patch (K,), whether faces lie on faces there (K,), where, (K, 3) over L."""

    patch: Index
    flat: Mask
    point: Array


@dataclass(frozen=True, slots=True, eq=False)
class LockedTurns:
    """Forces of equilibrium over the weight and self-stress, shape (K,) each [-]."""

    FORM: ClassVar[Form] = keys(locked=list_of(NUMBER), stress=list_of(NUMBER))
    SURFACES: ClassVar[str] = "exact"
    forces: Array
    stress: Array

    def __post_init__(self) -> None:
        read_only(self)

    def to_data(self, program: Program, problem: Stationary | None) -> dict[str, Any]:
        """Data of a proof file."""
        assert problem is not None
        forces = (self.forces * problem.weight).tolist()
        return {"locked": forces, "stress": self.stress.tolist()}

    @classmethod
    def from_data(cls, facts: ClusterFacts, data: dict[str, Any]) -> LockedTurns:
        """The proof from its data."""
        forces = np.array(data["locked"], dtype=float) / facts.problem.weight
        return cls(forces, np.array(data["stress"], dtype=float))

    def judge(self, facts: ClusterFacts) -> str:
        """Why the proof does not hold; empty if it holds."""
        if facts.program.planar:
            return "parts in a plane have no turns to lock"
        faces = faces_of(facts.program, facts.contacts, facts.problem)
        return judge_locked(facts.problem, faces, self)

    def outcome(self, facts: ClusterFacts) -> Outcome:
        """All shifts are free, and all turns are locked."""
        free, across = (basis.shape[1] for basis in shifts(facts.problem))
        return "free", free + across, free


def faces_of(program: Program, contacts: ContactSet, problem: Stationary) -> Faces:
    """Where faces were found to lie on faces."""
    flat = np.zeros(len(program.source), dtype=bool)
    rows = detected_rows(program, contacts)
    flat[rows] = contacts.patch_kind[program.source[rows]] == "plane"
    return Faces(program.source, flat, program.point / problem.length)


def shifts(problem: Stationary) -> tuple[Array, Array]:
    """Orthonormal bases of the neutral motions that turn nothing, (n, f), and of the rest."""
    neutral = null_space(problem.rows, problem.blur)
    turns = np.arange(neutral.shape[0]) % 6 >= 3
    free = neutral @ null_space(neutral[turns], ACROSS)
    return free, neutral @ null_space(free.T @ neutral, ACROSS)


def judge_locked(problem: Stationary, faces: Faces, proof: LockedTurns) -> str:
    """Why a proof does not hold; empty where it does."""
    count = len(problem.rows)
    if proof.forces.shape != (count,) or proof.stress.shape != (count,):
        return "its forces are not those of the contacts"
    if not (np.isfinite(proof.forces).all() and np.isfinite(proof.stress).all()):
        return "its numbers are not finite"
    if problem.rows.shape[1] % 6 or not faces.flat.all() or not _wide(faces):
        return "not every contact is of faces that lie on each other"
    limit = max(BALANCED, problem.blur)
    if (proof.forces < 0).any() or problem.imbalance(proof.forces) > limit:
        return "its forces do not balance the load"
    most = float(proof.stress.max(initial=TINY))
    if not (proof.stress > BEARS * limit * most).all():
        return "its self-stress does not press on every contact"
    if np.abs(problem.rows.T @ proof.stress).max(initial=0.0) > limit * most:
        return "its self-stress does not balance"
    neutral = null_space(problem.rows, problem.blur)
    scaled, every = proof.stress / most, np.ones(count, dtype=bool)
    if not carry_beyond_doubt(problem, scaled, every, neutral, np.zeros_like(problem.load)):
        return "its self-stress presses by rounding"
    free, across = shifts(problem)
    if np.abs(problem.load @ free).max(initial=0.0) > ACROSS:
        return "its shifts cost energy"
    if not definite(problem.curvature(scaled, across)):
        return "its self-stress does not lock every turn"
    return ""


def _wide(faces: Faces) -> bool:
    """Whether the points of each face are on no line."""
    points = [faces.point[faces.patch == patch] for patch in np.unique(faces.patch)]
    off = [one - one.mean(axis=0) for one in points]
    return all(np.linalg.eigvalsh(one.T @ one)[1] > SPREAD for one in off)
