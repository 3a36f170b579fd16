"""Bounds of motions and forces recomputed from the multipliers of a proof, without a solver.

The relaxation of an enclosure (`kilter.friction.relaxation`) bounds its power, and every quantity
in it, by any multipliers of its rows (`kilter.solvers.problem`). The prover takes the multipliers
of a solver (`kilter.friction.contraction`), the check those of a proof
(`kilter.friction.exclusion_file`). The consequences are the same.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from scipy.sparse import csr_array, eye_array, kron, vstack

from kilter.arrays import Array, Index
from kilter.friction.enclosure import Enclosure, first_enclosure
from kilter.friction.force_bound import force_bound
from kilter.friction.friction_tolerances import COARSEST_NO_POWER, LARGEST_FORCE, NO_POWER
from kilter.friction.moment_bound import MomentStep
from kilter.friction.reduced_law import ReducedLaw
from kilter.friction.relaxation import Relaxation
from kilter.mechanics.program import Program
from kilter.mechanics.proof_form import MalformedProof
from kilter.solvers.problem import LinearProgram

# Steps of a proof that no motion can start, with all data needed to repeat them.


@dataclass(frozen=True, slots=True, eq=False)
class PowerStep:
    """Row multipliers that bound the power in a linear program, and the next tangent point."""

    rows: Index
    """Rows with nonzero multipliers."""
    values: Array
    """Multipliers of these rows."""
    tangent: Array | None
    """Motion at which the ball of motions gets a further tangent, shape (n,)."""

    @classmethod
    def of(cls, multipliers: Array, tangent: Array | None) -> PowerStep:
        """Make a `PowerStep` from the multipliers of all rows, without storing zeros."""
        rows = np.flatnonzero(multipliers)
        return cls(rows, multipliers[rows], tangent)

    def over(self, count: int) -> Array:
        """Multipliers of all `count` rows as a dense array, with zeros added.

        Raises `MalformedProof` if a row does not exist.
        """
        if self.rows.max(initial=-1) >= count:
            raise MalformedProof("a row does not exist")
        multipliers = np.zeros(count)
        multipliers[self.rows] = self.values
        return multipliers


@dataclass(frozen=True, slots=True, eq=False)
class Quantity:
    """A bounded quantity by its number, with the row multipliers that prove its new bound."""

    number: int
    multipliers: PowerStep


@dataclass(frozen=True, slots=True, eq=False)
class ShrinkStep:
    """New bounds of several quantities, proved one after the other."""

    quantities: tuple[Quantity, ...]


@dataclass(slots=True, eq=False)
class CaseStep:
    """A case of contact modes: proofs of its power bound, and subcases if it is divided."""

    powers: list[PowerStep] = field(default_factory=list)
    point: int = -1
    patch: int = -1
    """Index of the point or patch at which it is divided; both -1 if it is closed."""
    cases: list[CaseStep] = field(default_factory=list)
    """The cases that cover it."""


ExclusionStep = MomentStep | PowerStep | ShrinkStep | CaseStep


ALL = ("un", "fn", "most", "least", "ut", "rest")
"""Names of the bounds in `Enclosure` that are shrunk."""
FORCES = ("fn", "least")
"""Names of the force bounds among them. In space a group is a single point, so the bound of its N
equals that of its f_n.
"""
TOTALS = ("most", "least")
"""Names of the bounds of the force sums N. In the plane these alone are shrunk: a positive lower
bound makes a sliding patch dissipate power and one of its ends touch. All bounds together need five
times as many programs, and do not save as many cases.
"""


def first_bounds(law: ReducedLaw, relaxation: Relaxation, opening: Array | None) -> Enclosure:
    """Bounds of motions and forces before the first step; forces are bounded by `opening`."""
    largest = min(largest_forces(law, opening), LARGEST_FORCE)
    force = np.full(len(law.group), largest)
    first = first_enclosure(law, relaxation.fastest, force, relaxation.tangents)
    return replace(first, cuts=True)


def largest_forces(law: ReducedLaw, opening: Array | None) -> float:
    """Upper bound of the sum of normal forces, from a motion that opens every contact."""
    return np.inf if opening is None else force_bound(law, opening)


def no_power(program: Program) -> float:
    """Scaled power (w.a / |w|^2) that counts as zero, for the accuracy of the parts' data."""
    mass = program.mass[program.free]
    coarse = min(max(NO_POWER, float(program.tolerance[program.free].max())), COARSEST_NO_POWER)
    return coarse * float(mass.min() / mass.sum())


def power_by(relaxation: Relaxation, bounds: Enclosure, step: PowerStep) -> tuple[Enclosure, float]:
    """Bound of the load's power from the multipliers of a step, and the bounds with its tangent."""
    if step.tangent is not None and step.tangent.shape != relaxation.law.load.shape:
        raise MalformedProof("a tangent at another number of freedoms")
    program = relaxation.program(bounds)
    power = -program.safe_bound(step.over(program.matrix.shape[0]))
    return with_tangent(bounds, step.tangent), min(max(power, 0.0), bounds.scale)


def with_tangent(bounds: Enclosure, point: Array | None) -> Enclosure:
    """Copy of the bounds with a new tangent plane at `point`; the oldest tangent is dropped."""
    if point is None:
        return bounds
    return replace(bounds, tangents=np.vstack([bounds.tangents[:2], point, bounds.tangents[2:-1]]))


@dataclass(frozen=True, slots=True, eq=False)
class Quantities:
    """Linear functions of the solution (speeds, forces) whose bounds a contraction shrinks."""

    names: list[str]
    """Bound of `Enclosure` to which each belongs."""
    places: list[tuple[int, ...]]
    """Index in that bound."""
    weights: csr_array
    """Rows w such that w.x is maximised."""
    limits: Array
    """Known upper bounds of w.x."""


def quantities(relaxation: Relaxation, b: Enclosure) -> Quantities:
    """List the quantities to bound: openings, normal forces and their sums, sliding speeds."""
    at, d = relaxation.columns, relaxation.directions
    groups, wide = len(b.least), d.shape[1]
    kinds = ["un", "fn", "most", "least", "ut", *(["rest"] if wide == 1 else [])]
    identity = eye_array(relaxation.width, format="csr")
    rows = {
        "un": identity[at["un"]],
        "fn": identity[at["fn"]],
        "most": identity[at["total"]],
        "least": -identity[at["total"]],
        "ut": kron(eye_array(groups), d, format="csr") @ identity[at["ut"]],
        "rest": identity[at["rest"]],
    }
    limits = {kind: getattr(b, kind) * (-1.0 if kind == "least" else 1.0) for kind in kinds}
    return Quantities(
        [kind for kind in kinds for _ in range(limits[kind].size)],
        [place for kind in kinds for place in np.ndindex(limits[kind].shape)],
        csr_array(vstack([rows[kind] for kind in kinds], format="csr")),
        np.concatenate([limits[kind].ravel() for kind in kinds]),
    )


def shrunk_by(
    law: ReducedLaw, relaxation: Relaxation, bounds: Enclosure, step: ShrinkStep
) -> Enclosure:
    """Shrink bounds as far as the multipliers of a step prove, without a solver."""
    new = {name: getattr(bounds, name).copy() for name in ALL}
    program = with_one(relaxation, bounds)
    targets = quantities(relaxation, bounds)
    for quantity in step.quantities:
        if quantity.number >= len(targets.names):
            raise MalformedProof("a quantity does not exist")
        name, place = targets.names[quantity.number], targets.places[quantity.number]
        cost = -targets.weights[[quantity.number]].toarray()[0]
        bound = replace(program, cost=cost).safe_bound(
            quantity.multipliers.over(program.matrix.shape[0])
        )
        if name == "least":
            new[name][place] = max(bound, new[name][place])
        else:
            new[name][place] = min(max(-bound, 0.0), new[name][place])
    return _consistent(law, relaxation, replace(bounds, **new))


def with_one(relaxation: Relaxation, bounds: Enclosure) -> LinearProgram:
    """The linear program of a relaxation, with the column named "one" fixed to 1."""
    program = relaxation.program(bounds)
    program.lower[relaxation.columns["one"]] = 1.0
    return program


def _consistent(law: ReducedLaw, relaxation: Relaxation, b: Enclosure) -> Enclosure:
    """Tighten bounds that follow from other bounds: speeds by directions, force sums by forces."""
    directions = law.directions
    members = np.flatnonzero(law.group >= 0)
    total = np.bincount(law.group[members], b.fn[members], minlength=len(law.mu))
    most = np.minimum(b.most, total)
    fn = b.fn.copy()
    fn[members] = np.minimum(fn[members], most[law.group[members]])
    if directions == 1:
        slip = np.minimum(b.slip, b.ut.max(axis=1, initial=0.0))
        rest = np.minimum(b.rest, 2 * (law.mu * most)[:, None])
        return replace(b, most=most, fn=fn, slip=slip, rest=rest)
    # the bounds are sides of a polygon, and |ut| is largest at its corners
    sides = len(relaxation.directions)
    corner = np.minimum(b.slip, b.ut.max(axis=1, initial=0.0) / np.cos(np.pi / sides))
    rest = np.repeat(2 * (law.mu * most)[:, None], sides, axis=1)
    ut = np.repeat(corner[:, None], sides, axis=1)
    return replace(b, most=most, fn=fn, slip=corner, ut=ut, rest=np.minimum(b.rest, rest))
