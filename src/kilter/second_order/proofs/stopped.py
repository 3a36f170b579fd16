"""Proof that stops keep parts from sliding off horizontal faces and edges.

Level motions F shift parts across gravity and turn them about the vertical. At level contacts,
between a level plane and any feature or between level edges and corners, they keep every gap and
the energy to all orders. The other contacts, the stops, carry no force. Let f be forces of
equilibrium on level contacts, Y the neutral motions across F, and K the curvature of the energy
under f. If, over z = (x, y) in F and Y,

    R_i z >= 0 for the stops,     R_j y >= 0 for level contacts without force

and there are weights W > 0 entrywise and S positive definite with

    z.K z = y.S y + sum of W_ij (R_i z) (R_j y)

then only sliding past a stop, R_i z < 0, leads to a fall: a box whose centre is above the edge of
its table may slide in, but not out. Symmetries (level motions and spins) are divided out. If Y is
empty, the energy is least on F: a ball on a table is free beside a wall. Otherwise, if the R_i are
one to one on F and the R_j on Y, the sum is at least c |x| |y| - C |y|^2, and so, with c > 0,

    z.K z >= c (|y|^2 + |x| |y|)        if all R z >= 0

Gaps and energy are level along F, so the rest of E is O(|y| |z|^2), which is smaller. Level
contacts satisfy R_j y >= -O(|y| |z|), and stops R_i z >= -O(|z|^2). A level motion that opens all
stops makes up for this by a step of O(|x|^2 + |y| |z|) within F. So E > E_0 unless y = 0: the
energy is least exactly on the level motions.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from kilter.arrays import Array, Mask, read_only
from kilter.mechanics.program import Program
from kilter.mechanics.proof_form import NUMBER, SIX, Form, keys, list_of, named
from kilter.second_order.gaps.features import Features
from kilter.second_order.gaps.gap_form import formed
from kilter.second_order.gaps.stationary import Stationary
from kilter.second_order.gaps.touched_surfaces import Touched
from kilter.second_order.motions.free_motions import free_span
from kilter.second_order.motions.null_space import null_space
from kilter.second_order.parts.bearing import level_axes
from kilter.second_order.proofs.cluster_facts import ClusterFacts, Judged
from kilter.second_order.proofs.minimum_proof import (
    MalformedProof,
    by_part,
    carry_beyond_doubt,
    carrying_rows,
    definite,
    read_columns,
)
from kilter.second_order.second_order_tolerances import ACROSS, BALANCED, DROPS, LEVEL


@dataclass(frozen=True, slots=True, eq=False)
class Stopped:
    """Proof that stops keep sliding parts from falling: forces, weights, a horizontal motion.

    `forces`, shape (K,), on level contacts, over the weight [-]; `weights`, shape (s, m): W for s
    stops and m level contacts without force; `opening`, shape (n,): a level motion that opens all
    stops, in scaled unknowns.
    """

    FORM: ClassVar[Form] = keys(
        stopped=list_of(NUMBER), weights=list_of(list_of(NUMBER)), motion=named(SIX)
    )
    SURFACES: ClassVar[str] = "exact"
    forces: Array
    weights: Array
    opening: Array

    def __post_init__(self) -> None:
        read_only(self)

    def to_data(self, program: Program, problem: Stationary | None) -> dict[str, Any]:
        """JSON data of this proof by stops, for a proof file."""
        assert problem is not None
        return {
            "stopped": (self.forces * problem.weight).tolist(),
            "weights": self.weights.tolist(),
            "motion": by_part(program, problem, self.opening),
        }

    @classmethod
    def from_data(cls, facts: ClusterFacts, data: dict[str, Any]) -> Stopped:
        """Read a proof by stops from JSON data."""
        problem, weights = facts.problem, data["weights"]
        if len({len(row) for row in weights}) > 1:
            raise MalformedProof("rows of weights differ in length")
        return cls(
            np.array(data["stopped"], dtype=float) / problem.weight,
            np.array(weights, dtype=float),
            read_columns(facts.program, problem, data["motion"]),
        )

    def judge(self, facts: ClusterFacts) -> Judged:
        """Verify the proof by stops: the reason of failure, or the state and counts it proves."""
        question = stop_question(facts)
        if word := judge_stopped(*question, self):
            return word
        forms = stop_forms(*question, self.forces)
        return "free", forms.neutral, forms.neutral - forms.tilts.shape[1]


@dataclass(frozen=True, slots=True, eq=False)
class StopForms:
    """Matrices of the energy and of the stops that a proof by stops combines."""

    carried: bool
    """Whether the forces are positive beyond rounding."""
    one_form: bool
    """Whether no carrying flush corner may slip off its edge."""
    neutral: int
    """Dimension of the neutral motions."""
    level: Array
    """Basis of F across the symmetries, shape (n, f)."""
    tilts: Array
    """Basis of Y, shape (n, d)."""
    stops_level: Array
    stops_tilts: Array
    """Rows R_i on F and on Y, shape (s, f)."""
    rises: Array
    """Rows R_j on Y, shape (m, d)."""
    coupling: Array
    """Twice K between F and Y, shape (f, d)."""
    curvature: Array
    """K on Y, shape (d, d)."""
    uneven: float
    """Largest entry of K that has to be 0."""

    @property
    def size(self) -> float:
        """Largest absolute coefficient of the quadratic forms, or 1 if that is smaller [-]."""
        blocks = (self.coupling, self.curvature)
        return float(max(np.abs(block).max(initial=1.0) for block in blocks))


def level_contacts(program: Program, features: Features, touched: tuple[Touched, Touched]) -> Mask:
    """Mask of contact rows whose gap stays constant in every horizontal motion, shape (K,).

    Their normal is upright. Either a side is a level plane, or both sides are planes, straight
    edges or corners.
    """
    upright = np.linalg.norm(np.cross(program.normal, program.down), axis=1) < BALANCED
    bent = np.zeros(len(upright))
    for curvature in (features.curvature_a, features.curvature_b):
        bent = np.maximum(bent, np.abs(curvature).max(axis=(1, 2), initial=0.0))
    on_plane = touched[0].level(program.down) | touched[1].level(program.down)
    straight = (bent == 0) & ~features.conformal
    level: Mask = upright & formed(program, features) & (straight | on_plane)
    return level


def level_motions(program: Program) -> Array:
    """Basis, (n, f), of horizontal shifts and of turns about verticals of free parts, scaled."""
    axes = level_axes(program)
    six = np.zeros((len(axes) + (not program.planar), 6))
    six[: len(axes), :3], six[len(axes) :, 3:] = axes, program.down
    of_part = six[:, program.freedoms].T
    return np.asarray(np.kron(np.eye(int(program.free.sum())), of_part), dtype=np.float64)


def stop_question(facts: ClusterFacts) -> tuple[Stationary, Mask, Array, Array]:
    """Data of a proof by stops: gaps, horizontal contacts, horizontal motions, symmetries."""
    program, problem = facts.program, facts.problem
    level = level_contacts(program, facts.features, facts.touched)
    span = free_span(program, problem, facts.free_motions.symmetries)
    return problem, level, level_motions(program), span


def stop_forms(
    problem: Stationary, level: Mask, motions: Array, free: Array, forces: Array
) -> StopForms:
    """Matrices of energy and stops for a proof by stops, under given forces, shape (K,).

    The other arguments are those of `judge_stopped`.
    """
    carries = carrying_rows(problem, forces)
    neutral = null_space(problem.rows[carries], problem.blur)
    tilts = neutral @ null_space(np.hstack([motions, free]).T @ neutral, ACROSS)
    x = motions @ null_space(free.T @ motions, ACROSS)
    whole = np.hstack([x, tilts, free])
    curvature = problem.curvature(forces, whole)
    f, d = x.shape[1], tilts.shape[1]
    between = slice(f, f + d)
    even = curvature.copy()
    even[:f, between], even[between, :f], even[between, between] = 0.0, 0.0, 0.0
    return StopForms(
        carry_beyond_doubt(problem, forces, carries, neutral, problem.load),
        bool(problem.one_form(whole)[forces > 0].all()),
        neutral.shape[1],
        x,
        tilts,
        problem.rows[~level] @ x,
        problem.rows[~level] @ tilts,
        problem.rows[level & ~carries] @ tilts,
        2 * curvature[:f, between],
        curvature[between, between],
        float(np.abs(even).max(initial=0.0)),
    )


def judge_stopped(
    problem: Stationary, level: Mask, motions: Array, free: Array, proof: Stopped
) -> str:
    """Reason why a proof by stops fails; empty if it is valid.

    Arguments: `level` (K,): level contacts (`level_contacts`); `motions` (n, f): level motions
    (`level_motions`); `free` (n, g): orthonormal basis of the symmetries
    (`FreeMotions.symmetries`).
    """
    if proof.forces.shape != level.shape or proof.opening.shape != problem.load.shape:
        return "its numbers do not match the parts and contacts"
    given = (proof.forces, proof.weights, proof.opening)
    if not all(np.isfinite(values).all() for values in given):
        return "its numbers are not finite"
    if (proof.forces < 0).any() or proof.forces[~level].any():
        return "a force acts at a contact that is not horizontal"
    if problem.imbalance(proof.forces) > max(BALANCED, problem.blur):
        return "its forces do not balance the load"
    kept = max(
        np.abs(problem.rows[level] @ motions).max(initial=0.0),
        np.abs(problem.load @ motions).max(initial=0.0),
    )
    if kept > ACROSS:
        return "a horizontal motion opens a horizontal contact, or costs energy"
    size = float(np.linalg.norm(proof.opening))
    off = proof.opening - motions @ (motions.T @ proof.opening)
    if not size > 0 or np.abs(off).max(initial=0.0) > ACROSS * size:
        return "its motion is not horizontal"
    if not (problem.rows[~level] @ proof.opening > DROPS * size).all():
        return "its motion does not open every stop"
    return _wrong_forms(stop_forms(problem, level, motions, free, proof.forces), proof.weights)


def _wrong_forms(forms: StopForms, weights: Array) -> str:
    """Reason why these matrices and weights do not prove a minimum; empty if they do."""
    if not forms.carried:
        return "its forces are no larger than rounding errors"
    if not forms.one_form:
        return "a loaded corner lies on edges of both parts and may slip off"
    if forms.uneven > LEVEL * forms.size:
        return "the energy changes along its horizontal motions"
    if not forms.tilts.shape[1]:
        return ""
    if weights.shape != (len(forms.stops_level), len(forms.rises)) or not (weights > 0).all():
        return "the weights of its stops are not positive"
    coupling = forms.stops_level.T @ weights @ forms.rises
    missing = float(np.abs(forms.coupling - coupling).max(initial=0.0))
    least = float(weights.min(initial=np.inf)) * _least(forms.stops_level) * _least(forms.rises)
    if forms.level.shape[1] and not least > LEVEL * forms.size + missing:
        return "its stops do not keep the parts from falling"
    if missing > LEVEL * forms.size:
        return "its weights do not match the curvature of the energy"
    mixed = forms.stops_tilts.T @ weights @ forms.rises
    if not definite(forms.curvature - (mixed + mixed.T) / 2):
        return "the energy does not curve upward across the horizontal motions"
    return ""


def _least(rows: Array) -> float:
    """Least singular value of a matrix (m, d); 0 if it has fewer than d rows."""
    if len(rows) < rows.shape[1]:
        return 0.0
    return float(np.linalg.svd(rows, compute_uv=False).min(initial=np.inf))
