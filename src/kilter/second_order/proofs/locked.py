"""Proof that parts can only slide: a self-stress excludes every turn of parts on flat faces.

If faces touch at points that are not collinear, a motion that costs no energy to first order turns
both parts alike, except for a relative turn about the normal. To first order this turn is the same
everywhere on the face and along the normal. Let X be the neutral motions without turns: gaps of
faces are affine under translations, so X keeps every gap and the energy to all orders. Let Y be
the other neutral motions, and s > 0 a self-stress on all contacts:

    J^T s = 0,     -Y^T H(s) Y positive definite,     J^T f + w = 0,  f >= 0

At any configuration x of X near by, the neutral motions are the same, and s is a self-stress there
too, its force on each face acting at the same point of the face. With z = y + m from x, m across
the neutral motions, all gaps open, and c, C > 0

    0 <= sum of s phi  gives  c |y|^2 <= C |m| (|y| + |m|):  |y| <= C |m|
    E - E_0 >= c |m| - C |m|^2 - C |x| |y|,  as f + t s > 0 on all contacts,

so that the energy is least exactly on X. The weight may do work along a y from x (a block of the
paper's figure 9 that has slid out of line tends to turn), but a locked turn does not yield.
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
from kilter.second_order.proofs.cluster_facts import ClusterFacts, Judged
from kilter.second_order.proofs.minimum_proof import definite
from kilter.second_order.second_order_tolerances import ACROSS, BALANCED, BEARS, SPREAD

__all__ = ["Faces", "LockedTurns", "faces_of", "judge_locked", "shifts"]


@dataclass(frozen=True, slots=True, eq=False)
class Faces:
    """Contacts of a face on a face: their patches, a mask, and the contact points.

    `patch`, shape (K,): patch of each row; `flat`, shape (K,): rows of faces on faces; `point`,
    shape (K, 3): contact points over L [-].
    """

    patch: Index
    flat: Mask
    point: Array


@dataclass(frozen=True, slots=True, eq=False)
class LockedTurns:
    """Equilibrium forces and self-stress, (K,) each [-], which prove that parts cannot turn."""

    FORM: ClassVar[Form] = keys(locked=list_of(NUMBER), stress=list_of(NUMBER))
    SURFACES: ClassVar[str] = "exact"
    forces: Array
    stress: Array

    def __post_init__(self) -> None:
        read_only(self)

    def to_data(self, program: Program, problem: Stationary | None) -> dict[str, Any]:
        """JSON data of this proof of locked turns, for a proof file."""
        assert problem is not None
        forces = (self.forces * problem.weight).tolist()
        return {"locked": forces, "stress": self.stress.tolist()}

    @classmethod
    def from_data(cls, facts: ClusterFacts, data: dict[str, Any]) -> LockedTurns:
        """Read a proof of locked turns from JSON data."""
        forces = np.array(data["locked"], dtype=float) / facts.problem.weight
        return cls(forces, np.array(data["stress"], dtype=float))

    def judge(self, facts: ClusterFacts) -> Judged:
        """Verify the proof of locked turns: why it fails, or the state and counts it proves."""
        if facts.program.planar:
            return "parts in a plane have no turns to lock"
        faces = faces_of(facts.program, facts.contacts, facts.problem)
        free, across = (basis.shape[1] for basis in shifts(facts.problem))
        return judge_locked(facts.problem, faces, self) or ("free", free + across, free)


def faces_of(program: Program, contacts: ContactSet, problem: Stationary) -> Faces:
    """Detected contacts of flat faces on flat faces in a program."""
    flat = np.zeros(len(program.source), dtype=bool)
    rows = detected_rows(program, contacts)
    flat[rows] = contacts.patch_kind[program.source[rows]] == "plane"
    return Faces(program.source, flat, program.point / problem.length)


def shifts(problem: Stationary) -> tuple[Array, Array]:
    """Orthonormal bases of the neutral motions: without turns, (n, f), and orthogonal to these."""
    neutral = null_space(problem.rows, problem.blur)
    turns = np.arange(neutral.shape[0]) % 6 >= 3
    free = neutral @ null_space(neutral[turns], ACROSS)
    return free, neutral @ null_space(free.T @ neutral, ACROSS)


def judge_locked(problem: Stationary, faces: Faces, proof: LockedTurns) -> str:
    """Reason why a proof of locked turns fails; empty if it is valid."""
    count = len(problem.rows)
    if proof.forces.shape != (count,) or proof.stress.shape != (count,):
        return "it does not have a finite force for each contact"
    if not (np.isfinite(proof.forces).all() and np.isfinite(proof.stress).all()):
        return "its numbers are not finite"
    if problem.rows.shape[1] % 6 or not faces.flat.all() or not _wide(faces):
        return "not every contact is a contact of faces on faces"
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
        return "its self-stress is no larger than rounding errors"
    free, across = shifts(problem)
    if np.abs(problem.load @ free).max(initial=0.0) > ACROSS:
        return "its shifts cost energy"
    if not definite(problem.stress_curvature(scaled, across)):
        return "its self-stress does not exclude every turn"
    return ""


def _wide(faces: Faces) -> bool:
    """True if the contact points of every face span an area, not only a line."""
    points = [faces.point[faces.patch == patch] for patch in np.unique(faces.patch)]
    arms = [point - point.mean(axis=0) for point in points]
    return all(np.linalg.eigvalsh(arm.T @ arm)[1] > SPREAD for arm in arms)
