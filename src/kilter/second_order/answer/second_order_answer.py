"""Second-order answer for parts that are stable to first order, with its evidence.

    minimum    a strict minimum of the energy, up to spins of parts of revolution: small pushes do
               not move the parts away, whatever the friction
    free       a minimum across motions that keep every gap and the energy: parts roll or slide
    balanced   a path leads down: the slightest push makes parts fall, unless friction holds them
    open       unknown; `why` is the reason

`one_cluster` finds the answer for a cluster, and `whole` that for the assembly.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

import numpy as np

from kilter.arrays import Array, Index, Mask
from kilter.mechanics.program import Program
from kilter.second_order.gaps.stationary import Stationary
from kilter.second_order.motions.null_space import null_space
from kilter.second_order.parts.cluster_states import State
from kilter.second_order.proofs.minimum_proof import MinimumProof
from kilter.second_order.proofs.paths import Path
from kilter.second_order.searches.critical import Critical
from kilter.second_order.second_order_tolerances import ACROSS, LEVEL
from kilter.tell.record import Record, Twist
from kilter.units import metres_per_unit

if TYPE_CHECKING:
    from kilter.second_order.motions.rolling import Rolling
    from kilter.second_order.proofs.fall_proof import Configuration
    from kilter.second_order.proofs.proof_kinds import SecondOrderProof
    from kilter.second_order.searches.energy_decision import EnergyDecision


# Oscillation rate about an energy minimum, and growth rate of a push on a balanced assembly.


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


LATE = "the time limit was reached"
SPENT = "its work limit is reached; --require strict or a higher --effort continues"
NAMED = 3
"""Number of parts that a phrase names; it counts the others."""


@dataclass(frozen=True, slots=True, eq=False)
class SecondOrder:
    """Second-order answer (minimum, free, balanced or open) for a cluster or an assembly."""

    state: State
    """One of "minimum", "free", "balanced", "open"."""
    neutral: int
    free: int
    blocked: int
    undecided: int
    """Dimension of the motions that cost no energy to first order, and of their parts: motions
    proved free, motions that cost or gain energy, and motions for which neither is known."""
    rate: float | None
    """For a minimum the least proved angular frequency of small oscillations; for a balanced
    assembly the rate of growth along its path [1/s]."""
    motion: Array | None
    """Motion of the fall, or a free motion, shape (N, 6); the part that moves most moves by 1
    length unit."""
    moving: Index
    """Parts that this motion moves."""
    why: str
    """Reason for an open answer."""
    decision: EnergyDecision | None = None
    """Decision with its proof."""
    problem: Stationary | None = None
    """Problem that the proof is about."""
    configuration: Configuration | None = None
    """Exact configuration on the path of a balanced assembly, if its bodies are known exactly."""
    program: Program | None = None
    """Program of `problem` and `decision`; its free parts are those of the cluster."""
    idle: Index = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    """Contacts of the cluster that carry no force and were left out of `program`. The result
    without them implies the result with them."""
    rolling: Rolling | None = None
    """For a balanced answer with friction, whether friction holds the parts."""
    bending: Index = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    """Round or jointed parts that may roll, rock or swing, about which nothing is proved."""
    alone: bool = False
    """Whether the parts of `program` fall alone, while the other parts of the cluster are held."""
    clusters: tuple[SecondOrder, ...] = ()
    """Answers of the clusters, if there are several. Then `moving` and the counts are those of
    all clusters; decision and configuration are those of the cluster that decides."""

    @property
    def proof(self) -> SecondOrderProof | None:
        """Proof of the answer for a single cluster; None for several clusters or an open answer."""
        # imported late: other answers do not need these modules
        from kilter.second_order.proofs.fall_proof import Fall

        proof = None if self.decision is None else self.decision.proof
        if isinstance(proof, Path):
            return Fall(proof, None if self.configuration is None else self.configuration.motion)
        return proof

    @property
    def names_alone(self) -> list[str] | None:
        """Names of the parts that fall alone; None if the whole cluster falls."""
        if not self.alone or self.program is None:
            return None
        return [self.program.names[k] for k in np.flatnonzero(self.program.free)]

    @property
    def held_by_friction(self) -> bool:
        """True if friction is proved to hold all parts that would fall without it."""
        return self.rolling is not None and self.rolling.state == "holds"

    @property
    def left(self) -> Mask:
        """Mask of the free parts whose cluster is open, shape (N,); groups as their first part."""
        still = [cluster for cluster in self.clusters or (self,) if cluster.state == "open"]
        masks = [cluster.program.free for cluster in still if cluster.program is not None]
        return np.any(masks, axis=0) if masks else np.array(False)

    @property
    def strict(self) -> bool:
        """True if it is proved that no small push makes parts fall, under the given friction."""
        if self.clusters:
            return all(cluster.strict for cluster in self.clusters)
        if self.state == "balanced":
            return self.held_by_friction
        return self.state in ("minimum", "free")

    @property
    def counted(self) -> bool:
        """True if the neutral motions were counted; otherwise counts of 0 have no meaning."""
        if self.clusters:
            return all(cluster.counted for cluster in self.clusters)
        return self.decision is not None and (self.state != "open" or self.neutral > 0)

    def left_open(self, names: tuple[str, ...]) -> str:
        """Phrase about the motions that are not decided, and the reason; empty if all are decided.

        Parameters
        ----------
        names : tuple of str
            Names of all parts.
        """
        still = [cluster for cluster in self.clusters or (self,) if cluster.state == "open"]
        if still:
            free = np.any([c.program.free for c in still if c.program is not None], axis=0)
            whys = " and ".join(dict.fromkeys(cluster.why for cluster in still))
            chosen = self.bending if len(self.bending) else np.flatnonzero(free)
            moving = _listed_names(names, chosen)
            return f"whether a small push makes {moving} fall: {whys}"
        if self.rolling is not None and self.rolling.state == "open":
            return (
                f"whether friction holds {_listed_names(names, self.moving)} against a small push"
            )
        return ""

    def summary(self, names: tuple[str, ...]) -> SecondOrderSummary:
        """The answer as it is printed; `names` are the names of all parts."""
        moving = self.moving.tolist()
        return SecondOrderSummary(
            state=self.state,
            neutral=self.neutral if self.counted else None,
            free=self.free if self.counted else None,
            blocked=self.blocked if self.counted else None,
            undecided=self.undecided if self.counted else None,
            rate=self.rate,
            motion=None if self.motion is None else {names[k]: self.motion[k] for k in moving},
            rolling=None if self.rolling is None else self.rolling.state,
            why=self.why or None,
            left_open=self.left_open(names) or None,
            bending=tuple(names[k] for k in self.bending),
        )


class SecondOrderSummary(Record):
    """Answer of second order; counts are null if kilter did not count."""

    state: State
    """Whether the assembly is at a minimum of its energy."""
    neutral: int | None
    """Dimension of the motions that cost no energy to first order."""
    free: int | None
    """Dimension of those that are proved free."""
    blocked: int | None
    """Dimension of those that cost or gain energy."""
    undecided: int | None
    """Dimension of those for which neither is known."""
    rate: float | None
    """Angular frequency, or rate of growth [1/s]."""
    motion: Mapping[str, Twist] | None
    """A motion that falls or is free, by part."""
    rolling: Literal["holds", "falls", "open"] | None
    """Whether friction holds the parts."""
    why: str | None
    """Reason for an open answer."""
    left_open: str | None
    """Motions that are not decided, and the reason."""
    bending: tuple[str, ...]
    """Parts that a small push may make roll, rock or swing on."""


def _listed_names(names: tuple[str, ...], parts: Index) -> str:
    """Names of the first few parts in a list, and the number of the other parts."""
    shown = [names[k] for k in parts[:NAMED].tolist()]
    if len(parts) > NAMED:
        return f"{', '.join(shown)} or {len(parts) - NAMED} more"
    return " or ".join(shown)


def open_answer(why: str, program: Program) -> SecondOrder:
    """Make an answer "open" with its reason."""
    none = np.zeros(0, dtype=np.int64)
    return SecondOrder("open", 0, 0, 0, 0, None, None, none, why, program=program)


def answer_of(program: Program, problem: Stationary, decision: EnergyDecision) -> SecondOrder:
    """Make the answer with the state and the motion counts of a decision."""
    # imported late: answers without curved gaps do not need these modules

    none = np.zeros(0, dtype=np.int64)
    return SecondOrder(
        decision.state,
        decision.neutral,
        decision.free,
        decision.blocked,
        decision.undecided,
        least_frequency(program, problem, decision.proof),
        None,
        none,
        decision.why,
        decision,
        problem,
        program=program,
    )
