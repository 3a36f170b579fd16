"""Contraction: bounds of all solutions of the contact law, shrunk by linear programs.

Each bounded quantity (opening, force, speed of sliding, distance to the cone, total force of a
group) is maximised over the relaxation that the present bounds define; the proved bound of
the optimum replaces the old one, the motion is rescaled to what its greatest power leaves,
and so on. Where the greatest power falls below the tolerance, no motion can start. Nothing
is divided into cases. Every bound is that of `kilter.solvers.solution`, which needs no faith in
the solver, so that each step errs on the safe side.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.sparse import csr_array, eye_array, kron, vstack

from kilter.arrays import TINY, Array
from kilter.friction.enclosure import Enclosure, rescaled
from kilter.friction.exclusion_steps import ExclusionStep, PowerStep, Quantity, ShrinkStep
from kilter.friction.reduced_law import ReducedLaw
from kilter.friction.relaxation import Relaxation
from kilter.solvers.highs import KeptProgram
from kilter.solvers.problem import LinearProgram
from kilter.solvers.solution import Solution
from kilter.work import Work

__all__ = [
    "FORCES",
    "ProofAttempt",
    "contract",
    "power_bound",
    "power_by",
    "shrunk",
    "shrunk_by",
]

ALL = ("un", "fn", "most", "least", "ut", "rest")
"""Bounds that are shrunk, by their names in `Enclosure`."""
FORCES = ("fn", "least")
"""Those of forces; in space a group is one point, and the bound of its N that of its f_n."""
SEEN = 0.95
"""A quantity that reached this fraction of its bound in some solution is not asked about."""
STALLED = 0.1
"""Mean relative progress of the bounds in a round below which contraction stops."""
CURVED = 1e-2
"""Scale |a| below which the kinetic term |a|^2 is too small for its tangents to matter."""
RESCALINGS = 30
"""How often the motion is rescaled before the other bounds are shrunk again."""
RESCALED = 0.95
"""A rescaling to more than this fraction of the old scale is the last."""


@dataclass(slots=True, eq=False)
class ProofAttempt:
    """What the steps of one proof share; `tolerance`: power w.a over |w|^2 that counts as none.

    `steps` are those made so far, for the proof to be repeated without the solver.
    """

    law: ReducedLaw
    relaxation: Relaxation
    solver: KeptProgram
    work: Work
    tolerance: float
    steps: list[ExclusionStep] = field(default_factory=list)

    def closed(self, bounds: Enclosure, power: float) -> bool:
        """Whether a greatest power w.b is nothing: scale * power is w.a."""
        return bounds.scale * power <= self.tolerance


def power_bound(
    attempt: ProofAttempt, bounds: Enclosure, basis: object = None
) -> tuple[Enclosure, float, Solution, PowerStep]:
    """Bounds with the tangent at the solution, the greatest power w.b, the solution, the step."""
    attempt.solver.load(attempt.relaxation.program(bounds), basis)
    attempt.work.loaded(attempt.solver.program.matrix.nnz)
    answer = attempt.solver.solve(work=attempt.work)
    curved = bounds.scale > CURVED and len(answer.x)
    point = answer.x[attempt.relaxation.columns["motion"]] if curved else None
    step = PowerStep.of(answer.multipliers, point)
    bounds, power = _with_tangent(bounds, point), -answer.bound
    return bounds, min(max(power, 0.0), bounds.scale), answer, step


def power_by(relaxation: Relaxation, bounds: Enclosure, step: PowerStep) -> tuple[Enclosure, float]:
    """The greatest power w.b that the multipliers of a step prove; its tangent in the bounds."""
    program = relaxation.program(bounds)
    power = -program.safe_bound(step.over(program.matrix.shape[0]))
    return _with_tangent(bounds, step.tangent), min(max(power, 0.0), bounds.scale)


def _with_tangent(bounds: Enclosure, point: Array | None) -> Enclosure:
    """The bounds with a tangent of the ball of motions at another point."""
    if point is None:
        return bounds
    return replace(bounds, tangents=np.vstack([bounds.tangents[:2], point, bounds.tangents[2:-1]]))


def contract(
    attempt: ProofAttempt, bounds: Enclosure, until: Work | None = None
) -> tuple[Enclosure, float]:
    """Shrink bounds until the power is excluded, they hardly move, or `until` is spent.

    Returns
    -------
    (Enclosure, float)
        The bounds, and the greatest power w.a that they leave.
    """
    relaxation = attempt.relaxation
    until = until or attempt.work
    while True:
        before = bounds
        for _ in range(RESCALINGS):
            bounds, power, answer, step = power_bound(attempt, bounds)
            attempt.steps.append(step)
            if attempt.closed(bounds, power) or attempt.work.over:
                return bounds, bounds.scale * power
            old = bounds.scale
            bounds = rescaled(relaxation.fastest, bounds, power)
            if bounds.scale > RESCALED * old:
                break
        attempt.work.tell(f"motions up to {bounds.scale:.1e} of free fall are not excluded")
        bounds = shrunk(attempt, bounds, answer, until=until)
        if until.over or _progress(before, bounds) < STALLED:
            return bounds, bounds.scale**2


def _progress(before: Enclosure, after: Enclosure) -> float:
    """Mean relative shrinking of the bounds, of motions in units of the scale, and scale."""
    drops = [1.0 - (after.scale / before.scale) ** 2]
    for old, new in (
        (before.un, after.un),
        (before.fn, after.fn),
        (before.ut, after.ut),
        (before.rest, after.rest),
        (before.most, after.most),
    ):
        if old.size:
            drop = 1.0 - new / np.maximum(old, TINY)
            drops.append(float(np.maximum(drop[old > 0], 0.0).mean()) if (old > 0).any() else 0.0)
    return max(drops)


@dataclass(frozen=True, slots=True, eq=False)
class _Quantities:
    """What is maximised, one after the other: `weights` x, the larger the worse.

    `names` and `places` say which bound of `Enclosure` it is, `limits` what is known of it.
    """

    names: list[str]
    places: list[tuple[int, ...]]
    weights: csr_array
    limits: Array


def _quantities(relaxation: Relaxation, b: Enclosure) -> _Quantities:
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
    return _Quantities(
        [kind for kind in kinds for _ in range(limits[kind].size)],
        [place for kind in kinds for place in np.ndindex(limits[kind].shape)],
        csr_array(vstack([rows[kind] for kind in kinds], format="csr")),
        np.concatenate([limits[kind].ravel() for kind in kinds]),
    )


def shrunk(
    attempt: ProofAttempt,
    bounds: Enclosure,
    start: Solution,
    kinds: Sequence[str] = ALL,
    until: Work | None = None,
) -> Enclosure:
    """Every quantity of some kinds bounded once, over the relaxation of the given bounds.

    Parameters
    ----------
    attempt : ProofAttempt
    bounds : Enclosure
    start : Solution
        Of the greatest power within these bounds.
    kinds : sequence of str
        Which of `ALL`.
    until : Work, optional
        What is not asked when it is spent keeps its bound.
    """
    relaxation = attempt.relaxation
    until = until or attempt.work
    attempt.solver.load(_with_one(relaxation, bounds), start.basis)
    attempt.work.loaded(attempt.solver.program.matrix.nnz)
    asked = _quantities(relaxation, bounds)
    best = asked.weights @ start.x if len(start.x) else np.full(len(asked.limits), -np.inf)
    enough = np.where(asked.limits > 0, SEEN * asked.limits, asked.limits / SEEN)
    fixed = np.array([name != "least" for name in asked.names]) & (asked.limits <= 0)
    found: list[Quantity] = []
    for number, name in enumerate(asked.names):
        if until.over:
            break
        if name not in kinds:
            continue
        if fixed[number] or (best[number] >= enough[number] and enough[number] != 0):
            continue
        answer = attempt.solver.solve(-asked.weights[[number]].toarray()[0], work=attempt.work)
        if len(answer.x):
            best = np.maximum(best, asked.weights @ answer.x)
        found.append(Quantity(number, PowerStep.of(answer.multipliers, None)))
        attempt.work.tell(f"bounding forces and motions, {number} of {len(asked.limits)}")
    step = ShrinkStep(tuple(found))
    attempt.steps.append(step)
    return shrunk_by(attempt.law, relaxation, bounds, step)


def shrunk_by(
    law: ReducedLaw, relaxation: Relaxation, bounds: Enclosure, step: ShrinkStep
) -> Enclosure:
    """The bounds that the multipliers of a step prove."""
    new = {name: getattr(bounds, name).copy() for name in ALL}
    program = _with_one(relaxation, bounds)
    asked = _quantities(relaxation, bounds)
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


def _with_one(relaxation: Relaxation, bounds: Enclosure) -> LinearProgram:
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
