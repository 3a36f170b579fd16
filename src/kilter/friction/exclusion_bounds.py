"""Bounds of all solutions, as multipliers prove them: no solver is asked, or known here.

The relaxation of some bounds (`kilter.friction.relaxation`) bounds its power, and every quantity
in it, by any multipliers of its rows (`kilter.solvers.problem`). The prover takes those of a
solver (`kilter.friction.contraction`), the check those of a proof (`kilter.friction.
exclusion_check`); what follows from them is the same.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csr_array, eye_array, kron, vstack

from kilter.arrays import Array
from kilter.friction.enclosure import Enclosure, first_enclosure
from kilter.friction.exclusion_steps import PowerStep, ShrinkStep
from kilter.friction.force_bound import force_bound
from kilter.friction.friction_tolerances import COARSEST_NO_POWER, LARGEST_FORCE, NO_POWER
from kilter.friction.reduced_law import ReducedLaw
from kilter.friction.relaxation import TANGENTS, Relaxation
from kilter.mechanics.program import Program
from kilter.solvers.problem import LinearProgram

__all__ = [
    "ALL",
    "FORCES",
    "Quantities",
    "first_bounds",
    "largest_forces",
    "no_power",
    "power_by",
    "quantities",
    "shrunk_by",
    "with_one",
    "with_tangent",
]

ALL = ("un", "fn", "most", "least", "ut", "rest")
"""Bounds that are shrunk, by their names in `Enclosure`."""
FORCES = ("fn", "least")
"""Those of forces; in space a group is one point, and the bound of its N that of its f_n."""


def first_bounds(law: ReducedLaw, relaxation: Relaxation, opening: Array | None) -> Enclosure:
    """What is known before anything is asked; without `opening` a bound of forces is assumed."""
    largest = min(largest_forces(law, opening), LARGEST_FORCE)
    force = np.full(len(law.group), largest)
    return replace(first_enclosure(law, relaxation.fastest, force, TANGENTS), cuts=True)


def largest_forces(law: ReducedLaw, opening: Array | None) -> float:
    """The bound of the sum of all forces that a motion proves; infinity without one."""
    return np.inf if opening is None else force_bound(law, opening)


def no_power(program: Program) -> float:
    """The power that counts as none: that of the data, for the lightest part on its own."""
    mass = program.mass[program.free]
    coarse = min(max(NO_POWER, float(program.tolerance[program.free].max())), COARSEST_NO_POWER)
    return coarse * float(mass.min() / mass.sum())


def power_by(relaxation: Relaxation, bounds: Enclosure, step: PowerStep) -> tuple[Enclosure, float]:
    """The greatest power w.b that the multipliers of a step prove; its tangent in the bounds."""
    program = relaxation.program(bounds)
    power = -program.safe_bound(step.over(program.matrix.shape[0]))
    return with_tangent(bounds, step.tangent), min(max(power, 0.0), bounds.scale)


def with_tangent(bounds: Enclosure, point: Array | None) -> Enclosure:
    """The bounds with a tangent of the ball of motions at another point."""
    if point is None:
        return bounds
    return replace(bounds, tangents=np.vstack([bounds.tangents[:2], point, bounds.tangents[2:-1]]))


@dataclass(frozen=True, slots=True, eq=False)
class Quantities:
    """What is maximised, one after the other: `weights` x, the larger the worse.

    `names` and `places` say which bound of `Enclosure` it is, `limits` what is known of it.
    """

    names: list[str]
    places: list[tuple[int, ...]]
    weights: csr_array
    limits: Array


def quantities(relaxation: Relaxation, b: Enclosure) -> Quantities:
    """Openings, forces, most and least sums N, speeds, and in the plane the g_k of `Relaxation`."""
    at, d = relaxation.columns, relaxation.directions
    groups, wide = len(b.least), d.shape[1]
    kinds = ["un", "fn", "most", "least", "ut", *(["rest"] if wide == 1 else [])]
    eye = eye_array(relaxation.width, format="csr")
    rows = {
        "un": eye[at["un"]],
        "fn": eye[at["fn"]],
        "most": eye[at["total"]],
        "least": -eye[at["total"]],
        "ut": kron(eye_array(groups), d, format="csr") @ eye[at["ut"]],
        "rest": eye[at["rest"]],
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
    """The bounds that the multipliers of a step prove."""
    new = {name: getattr(bounds, name).copy() for name in ALL}
    program = with_one(relaxation, bounds)
    asked = quantities(relaxation, bounds)
    for quantity in step.quantities:
        name, place = asked.names[quantity.number], asked.places[quantity.number]
        cost = -asked.weights[[quantity.number]].toarray()[0]
        least = replace(program, cost=cost).safe_bound(
            quantity.multipliers.over(program.matrix.shape[0])
        )
        if name == "least":
            new[name][place] = max(least, new[name][place])
        else:
            new[name][place] = min(max(-least, 0.0), new[name][place])
    return _consistent(law, relaxation, replace(bounds, **new))


def with_one(relaxation: Relaxation, bounds: Enclosure) -> LinearProgram:
    """The relaxation where l is 1: else no force has a least value but 0."""
    program = relaxation.program(bounds)
    program.lower[relaxation.columns["one"]] = 1.0
    return program


def _consistent(law: ReducedLaw, relaxation: Relaxation, b: Enclosure) -> Enclosure:
    """Bounds that follow from others: |ut| from its directions, N from forces, g from N."""
    wide = law.directions
    members = np.flatnonzero(law.group >= 0)
    total = np.bincount(law.group[members], b.fn[members], minlength=len(law.mu))
    most = np.minimum(b.most, total)
    fn = b.fn.copy()
    fn[members] = np.minimum(fn[members], most[law.group[members]])
    if wide == 1:
        slip = np.minimum(b.slip, b.ut.max(axis=1, initial=0.0))
        rest = np.minimum(b.rest, 2 * (law.mu * most)[:, None])
        return replace(b, most=most, fn=fn, slip=slip, rest=rest)
    # |ut| is at most that of the corner of the polygon whose sides are the bounds
    sides = len(relaxation.directions)
    corner = np.minimum(b.slip, b.ut.max(axis=1, initial=0.0) / np.cos(np.pi / sides))
    rest = np.repeat(2 * (law.mu * most)[:, None], sides, axis=1)
    ut = np.repeat(corner[:, None], sides, axis=1)
    return replace(b, most=most, fn=fn, slip=corner, ut=ut, rest=np.minimum(b.rest, rest))
