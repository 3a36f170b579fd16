"""Proof of a strict minimum of the energy, checked without a solver.

Forces f >= 0 (of either sign at joints) with J^T f + w = 0 put every critical motion into the null
space Z of the carrying rows, because the terms f_k J_k z >= 0 sum to -w.z = 0. For cones
{z = Z y, R y >= 0} that together cover the critical motions, with separate forces f and weights
N >= 0 for each cone,

    Z^T (S - H(f)) Z - R^T N R  positive definite        (Cholesky)

with the second derivative S of the energy of springs, proves z.L'' z > 0 on the cone (Ioffe;
Ben-Tal): a strict local minimum of the energy over all admissible configurations, under any contact
law that creates no energy. Motions that are proved free (`motions.free_motions`) are divided out
first: Z is then across them.

The cones are the leaves of a tree. Its roots are the orthants of y, those with positive first
coordinate if both signs of a motion are critical. A cone is split in two at the middle of two of
its rays. A single leaf without rays is the whole space.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from scipy.sparse import csr_array, diags_array

from kilter.arrays import TINY, Array, Index, Mask, read_only, unit_rows
from kilter.contact.contact_set import ContactSet
from kilter.mechanics.program import Program
from kilter.mechanics.proof_form import (
    COUNT,
    NUMBER,
    SIX,
    Form,
    MalformedProof,
    keys,
    list_of,
    named,
    nullable,
)
from kilter.second_order.gaps.features_of import detected_rows
from kilter.second_order.gaps.joint_forms import YIELDS
from kilter.second_order.gaps.stationary import Stationary
from kilter.second_order.motions.free_motions import (
    FreeMotions,
    free_span,
    moving_free,
    scaled_columns,
)
from kilter.second_order.motions.null_space import null_space
from kilter.second_order.proofs.cluster_facts import ClusterFacts, Judged
from kilter.second_order.second_order_tolerances import (
    ACROSS,
    BALANCED,
    BEARS,
    CURVED,
    LEVEL,
    SPREAD,
)

__all__ = [
    "Faces",
    "Leaf",
    "LockedTurns",
    "MalformedProof",
    "MinimumProof",
    "all_carry",
    "by_part",
    "carry_beyond_doubt",
    "carrying_rows",
    "counts",
    "definite",
    "faces_of",
    "judge_locked",
    "judge_minimum",
    "leaf_cones",
    "named_motion",
    "orthants",
    "read_columns",
    "read_motion",
    "shifts",
    "sides_of_cone",
    "split",
    "square",
    "stacked",
]


# Contacts whose equilibrium force is larger than rounding errors.


ROUNDING = 1e-13
"""Error of an eigenvalue, over the largest eigenvalue [-]."""


def carrying_rows(problem: Stationary, forces: Array) -> Mask:
    """Mask of the contact rows whose force, of shape (K,), is clearly above the tolerance."""
    limit = max(BALANCED, problem.blur)
    return np.asarray(
        problem.two_sided | (forces > BEARS * limit * np.abs(forces).max(initial=TINY))
    )


def carry_beyond_doubt(
    problem: Stationary, forces: Array, carries: Mask, neutral: Array, load: Array
) -> bool:
    """True if the forces on given rows remain positive after an exact correction of the balance.

    Arguments: `forces` (K,): forces over the weight [-]; those on other rows count as residual;
    `carries` (K,): the given rows; `neutral` (n, d): orthonormal basis of the motions that open
    none of these rows; `load` (n,): the load of the problem, or zero for self-stress.
    """
    rows, limit = problem.rows[carries], max(BALANCED, problem.blur)
    missing = float(np.linalg.norm(rows.T @ forces[carries] + load))
    missing += limit * np.sqrt(len(load)) * float(np.abs(problem.load).max(initial=0.0))
    joined = problem.two_sided[carries]
    return all_carry(csr_array(rows), forces[carries], missing, neutral, joined)


def all_carry(
    rows: csr_array,
    forces: Array,
    missing: float,
    neutral: Array | None = None,
    joined: Mask | None = None,
) -> bool:
    """True if forces (k,) on rows (k, n) remain positive after any correction of their residual.

    Arguments: `neutral` (n, d): orthonormal motions; the rows have to block all motions across
    them; `joined` (k,): rows of joints, which may also pull.
    """
    pushes = np.ones(len(forces), dtype=bool) if joined is None else ~joined
    weights = np.where(pushes, forces, max(float(np.abs(forces).max(initial=0.0)), 1.0))
    held = (rows.T @ diags_array(weights) @ rows).toarray()
    size = max(float(held.diagonal().max(initial=0.0)), TINY)
    least = max(missing**2 / float(forces[pushes].min(initial=np.inf)), ROUNDING * size)
    if neutral is not None:
        held += size * neutral @ neutral.T
    try:
        np.linalg.cholesky(held - least * np.eye(len(held)))
    except np.linalg.LinAlgError:
        return False
    return True


# Numbers of a proof file as arrays, and motions by the names of their parts.


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


@dataclass(frozen=True, slots=True, eq=False)
class Leaf:
    """Proof for a cone {R y >= 0} of motions: forces f, (K,), and N with entries >= 0, (m, m).

    They prove that the energy rises along every motion of the cone (see the module docstring).
    """

    forces: Array
    weights: Array


@dataclass(frozen=True, slots=True, eq=False)
class MinimumProof:
    """Proof of a strict energy minimum for the motions orthogonal to the free motions."""

    FORM: ClassVar[Form] = keys(
        basis=list_of(named(SIX)),
        across=list_of(named(SIX)),
        sides=list_of(list_of(NUMBER)),
        splits=list_of(nullable(list_of(COUNT, 2))),
        forces=list_of(list_of(NUMBER)),
        weights=list_of(list_of(list_of(NUMBER))),
    )
    SURFACES: ClassVar[str] = "known"
    basis: Array
    """Orthonormal basis Z of the neutral motions across the free ones, shape (n, d)."""
    sides: Array
    """Contact rows that bound the critical motions, shape (m, d): sides y >= 0."""
    free: Array
    """Orthonormal basis of the free motions that are divided out, shape (n, f)."""
    splits: tuple[tuple[int, int] | None, ...]
    """The tree in depth-first order: a pair of rays that is split, or None for a leaf. If empty,
    the whole space is a single leaf."""
    leaves: tuple[Leaf, ...]

    def to_data(self, program: Program, problem: Stationary | None) -> dict[str, Any]:
        """JSON data of this proof of a minimum, for a proof file."""
        assert problem is not None
        return {
            "basis": [by_part(program, problem, motion) for motion in self.basis.T],
            "across": [by_part(program, problem, motion) for motion in self.free.T],
            "sides": self.sides.tolist(),
            "splits": [None if pair is None else list(pair) for pair in self.splits],
            "forces": [(leaf.forces * problem.weight).tolist() for leaf in self.leaves],
            "weights": [leaf.weights.tolist() for leaf in self.leaves],
        }

    @classmethod
    def from_data(cls, facts: ClusterFacts, data: dict[str, Any]) -> MinimumProof:
        """Read a proof of a minimum from JSON data."""
        program, problem, sides = facts.program, facts.problem, data["sides"]
        basis, free = (stacked(program, problem, data[key]) for key in ("basis", "across"))
        size = basis.shape[1]
        if any(len(side) != size for side in sides):
            raise MalformedProof("an inequality has the wrong length")
        # counted before the cones are built: their number doubles with each dimension
        if data["splits"] and len(data["splits"]) < 2 ** (size - 1):
            raise MalformedProof("it has fewer cones than orthants")
        if len(data["forces"]) != len(data["weights"]):
            raise MalformedProof("its forces and weights are not of the same cones")
        return cls(
            basis,
            np.array(sides, dtype=float).reshape(len(sides), size),
            free,
            tuple(None if pair is None else (pair[0], pair[1]) for pair in data["splits"]),
            tuple(
                Leaf(np.array(forces, dtype=float) / problem.weight, square(weights))
                for forces, weights in zip(data["forces"], data["weights"], strict=True)
            ),
        )

    def judge(self, facts: ClusterFacts) -> Judged:
        """Verify the proof of a minimum: why it fails, or the state and counts it proves."""
        known = facts.known
        if not known.all() and self.free.shape[1]:
            return "it calls motions free although the curvature at some contacts is unknown"
        wrong = judge_minimum(facts.problem.taking(known), self, facts.bounded(1.0).taking(known))
        if wrong:
            return wrong
        span = free_span(facts.program, facts.problem.taking(known), self._free_motions(facts))
        missing = null_space(span.T, ACROSS).T @ self.free if span.shape[1] else self.free
        if not np.abs(missing).max(initial=0.0) <= ACROSS:
            return "a motion that it calls free is not proved to be"
        free = self.free.shape[1]
        moves = free and len(moving_free(facts.assembly, self._free_motions(facts)))
        return "free" if moves else "minimum", self.basis.shape[1] + free, free

    def _free_motions(self, facts: ClusterFacts) -> FreeMotions:
        """Free motions that may be left out: only symmetries if other motions are neutral."""
        motions = facts.free_motions
        return motions.symmetries if self.basis.shape[1] else motions


def orthants(dimension: int, *, half: bool) -> list[Array]:
    """The orthants of a space, or those with y_0 >= 0, each as a matrix of its rays."""
    signs = itertools.product((1.0, -1.0), repeat=dimension - 1)
    first = [np.diag([1.0, *rest]) for rest in signs]
    return first if half else [*first, *(-rays for rays in first)]


def split(rays: Array, i: int, j: int) -> tuple[Array, Array]:
    """Split a cone in the middle of its rays i and j into two cones."""
    middle = rays[:, i] + rays[:, j]
    middle = middle / np.linalg.norm(middle)
    first, second = rays.copy(), rays.copy()
    first[:, i], second[:, j] = middle, middle
    return first, second


def sides_of_cone(rays: Array) -> Array:
    """Unit rows R such that R y >= 0 describes the cone of independent rays (columns)."""
    return unit_rows(np.asarray(np.linalg.inv(rays), dtype=np.float64))


def leaf_cones(
    dimension: int, splits: Sequence[tuple[int, int] | None], *, half: bool
) -> Iterator[Array | None]:
    """Yield the rays of each undivided cone in a tree of splits; None for the whole space.

    Raises `ValueError` if the splits are not a tree.
    """
    if not splits:
        yield None
        return
    todo = orthants(dimension, half=half)[::-1]
    for pair in splits:
        if not todo:
            raise ValueError("more splits than cones")
        rays = todo.pop()
        if pair is None:
            yield rays
            continue
        i, j = pair
        if not (0 <= i < dimension and 0 <= j < dimension and i != j):
            raise ValueError("a split of rays that do not exist")
        todo += split(rays, i, j)[::-1]
    if todo:
        raise ValueError("cones are left over")


def judge_minimum(problem: Stationary, proof: MinimumProof, worst: Stationary | None = None) -> str:
    """Reason why a proof of a strict minimum fails; empty if it is valid.

    Only the numbers of problem and proof are used: signs, balance, null space, Cholesky.

    Arguments: `worst`: the problem with the gaps that curve the energy least, if gaps are only
    known within bounds.
    """
    worst = worst or problem
    if not proof.leaves:
        return "it has no forces"
    for leaf in proof.leaves:
        wrong = _wrong_forces(problem, leaf.forces)
        if wrong:
            return wrong
    carries = carrying_rows(problem, np.mean([leaf.forces for leaf in proof.leaves], axis=0))
    neutral = null_space(problem.rows[carries], problem.blur)
    wrong = _wrong_spaces(problem, proof, carries, neutral) or next(
        filter(None, (_wrong_free(problem, proof, leaf.forces) for leaf in proof.leaves)), ""
    )
    if wrong:
        return wrong
    try:
        half = not len(proof.sides)
        cones = list(leaf_cones(proof.basis.shape[1], proof.splits, half=half))
    except ValueError as error:
        return f"its cones do not form a tree: {error}"
    if len(cones) != len(proof.leaves):
        return "it does not have a set of forces for each cone"
    basis = neutral @ (neutral.T @ proof.basis)  # errors of the basis might curve upward
    for rays, leaf in zip(cones, proof.leaves, strict=True):
        sides = proof.sides if rays is None else np.vstack([sides_of_cone(rays), proof.sides])
        if leaf.weights.shape != (len(sides), len(sides)) or not _positive(leaf.weights):
            return "the weights of its sides are not positive"
        curvature = worst.curvature(leaf.forces, basis)
        if not definite(curvature - sides.T @ leaf.weights @ sides):
            return "the energy does not curve upward under its forces"
    return ""


def _positive(weights: Array) -> bool:
    return bool((np.isfinite(weights) & (weights >= 0)).all())


def _wrong_forces(problem: Stationary, forces: Array) -> str:
    """Reason why forces, (K,), are not an equilibrium of pushing contacts; empty if they are."""
    if forces.shape != (len(problem.rows),) or not np.isfinite(forces).all():
        return "it does not have a finite force for each contact"
    if (forces[~problem.two_sided] < 0).any():
        return "a contact force pulls"
    if problem.limits is not None and not (np.abs(forces) < (1 - YIELDS) * problem.limits).all():
        return "the friction of a joint is at its limit"
    balanced = problem.imbalance(forces) <= max(BALANCED, problem.blur)
    return "" if balanced else "its forces do not balance the load"


def _wrong_spaces(problem: Stationary, proof: MinimumProof, carries: Mask, neutral: Array) -> str:
    """Reason why the motions of a proof may not include all critical motions; else empty.

    The subspaces are its basis, its free motions and its sides. `carries`, shape (K,), marks the
    contact rows whose force, averaged over the cases of the proof, is not zero. `neutral` is an
    orthonormal basis of the motions that do not open these rows.
    """
    forces = np.mean([leaf.forces for leaf in proof.leaves], axis=0)
    spanned = np.hstack([proof.basis, proof.free])
    if not np.isfinite(spanned).all() or spanned.shape[0] != problem.rows.shape[1]:
        return "its motions are not those of the free parts"
    if np.abs(spanned.T @ spanned - np.eye(spanned.shape[1])).max(initial=0.0) > ACROSS:
        return "its motions are not of length 1 and across one another"
    opened = np.abs(problem.rows[carries] @ spanned).max(initial=0.0)
    if spanned.shape != neutral.shape or opened > ACROSS:
        return "its forces leave other motions neutral, too"
    if not carry_beyond_doubt(problem, forces, carries, neutral, problem.load):
        return "its forces are no larger than rounding errors"
    if np.abs(problem.rows @ proof.free).max(initial=0.0) > ACROSS:
        return "a free motion opens a contact"
    if len(proof.sides):
        other = problem.rows[~carries] @ proof.basis
        turns = np.linalg.norm(other, axis=1) > ACROSS  # a vanishing row has no direction
        apart = proof.sides[:, None] - unit_rows(other[turns])
        if not (np.linalg.norm(apart, axis=2).min(axis=1, initial=np.inf) < ACROSS).all():
            return "an inequality does not belong to a contact"
    return ""


def _wrong_free(problem: Stationary, proof: MinimumProof, forces: Array) -> str:
    """Reason why free motions change the energy to second order; empty if they do not."""
    both = np.hstack([proof.basis, proof.free])
    curvature = problem.curvature(forces, both)
    size = max(1.0, float(np.abs(curvature).max(initial=0.0)))
    level = np.abs(curvature[:, proof.basis.shape[1] :]).max(initial=0.0) <= LEVEL * size
    if not level:
        return "the energy changes along its free motions"
    flush = not problem.one_form(both)[forces > 0].all()
    return "a loaded corner lies on edges of both parts and may slip off" if flush else ""


def definite(matrix: Array) -> bool:
    """True if the symmetric part of a matrix is positive definite beyond rounding.

    Cholesky itself reads only one triangle of a matrix, and accepts infinite numbers.
    """
    if not np.isfinite(matrix).all():
        return False
    form = matrix / 2 + matrix.T / 2  # halved first, because the sum may overflow
    size = max(1.0, float(np.abs(form).max(initial=0.0)))
    try:
        np.linalg.cholesky(form - CURVED * size * np.eye(len(form)))
    except np.linalg.LinAlgError:
        return False
    return True


# Proof that parts can only slide: a self-stress excludes every turn of parts on flat faces.


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
