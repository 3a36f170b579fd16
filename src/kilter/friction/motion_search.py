"""Search for a motion that obeys Coulomb's law, although equilibrium forces exist.

With friction the contact law may have several solutions: rest, and a motion. A single such motion
shows that forces of equilibrium alone do not hold the parts. If no forces of equilibrium exist, the
motion is the impending motion, with friction. The search uses

1. De Saxce's iteration, below, from starts with some or all patches lubricated; 2. the direction in
which the parts ran away during seating (`kilter.friction.seating`); 3. branch and bound over
contact modes (`kilter.friction.mode_search`), which alone finds solutions that repel the iteration.

Candidates are made exact (`kilter.friction.polish`). A cheap test selects those that may obey the
law (`kilter.friction.law`), and of these a motion counts only if
`kilter.mechanics.law_check.check_law` accepts it. A search without a result proves nothing.

De Saxce's iteration. With s = mu |u_t| held fixed, accelerations x and forces f that obey the law
(scaled as in `kilter.friction.law`, u = H x) are the optimum and the multipliers of

    min 1/2 |x|^2 - w.x,     u_n + s >= mu |u_t|   a point with friction
                             u_n >= 0              a point without,  u_n = 0   a joint

so that solutions of the law are the fixed points of s -> mu |H_t x(s)|. A *lubricated* point has no
friction in the first step: the iteration then starts with parts sliding that friction would hold.

References
----------
G. De Saxce, Z.-Q. Feng, The bipotential method, Math. Comput. Modelling 28, 1998. V. Acary, F.
Cadoux, C. Lemaréchal, J. Malick, A formulation of the linear discrete Coulomb friction problem via
convex optimization, ZAMM 91, 2011, section 3.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import chain
from typing import Literal

import numpy as np
from scipy.sparse import csc_array, eye_array

from kilter.arrays import TINY, Array, Index, Mask
from kilter.friction.friction_tolerances import EXACTLY, GONE, SHARP, STEADY
from kilter.friction.law import CoulombLaw, breach, coulomb_law, may_obey
from kilter.friction.mode_search import by_modes
from kilter.friction.polish import TrialMotion, polished
from kilter.friction.seating import find_seating
from kilter.mechanics.law_check import LawProof, check_law
from kilter.mechanics.program import Program
from kilter.solvers.problem import ConicProgram
from kilter.tell.record import InPython, Record, key
from kilter.threads import on_one_thread
from kilter.work import Work

Part = Literal["starts", "modes"]

STARTS = 8
"""Number of starts of De Saxce's iteration: free fall, all lubricated, none, the rest at random."""
ITERATIONS = 40
"""Maximum number of iterations from each start."""
FEW = 2
"""Number of iterations from a candidate of branch and bound."""
NODES = 300
"""Maximum number of nodes of branch and bound."""
MOST_POINTS = 150
"""Number of contact points above which 300 nodes decide too few modes to be useful, and above which
a candidate of the iteration is made exact only if it is near the law: each takes longer than a step
of the iteration.
"""
NEAR = 0.1
"""Largest breach of the law, over the power, up to which the optimum of a relaxation is made exact
directly. For books, all motions are found after steps of De Saxce's iteration, and optima with a
breach above 0.3 of their power lead to none.
"""
NEARER = 1e-3
"""The same for a motion of parts that no forces hold. Each iteration reduces the breach to a
quarter, and costs a tenth of a Newton step: polishing waits longer."""
BY_MODES, CONES = "contact modes", "cones without sliding"
"""Names of the method of contact modes, and of the start with all cones."""
TRIES = (0, 1, 3, 10)
"""Iterations after which a candidate is made exact, in addition to the last."""


class CoulombMotion(Record, kw_only=False):
    """A motion from rest that obeys the contact law, although forces of equilibrium exist."""

    acceleration: InPython[Array]
    """Linear [m/s^2] and angular [rad/s^2] acceleration, shape (N, 6)."""
    forces: InPython[Array]
    """Force on part b of each row, world frame [N], shape (K, 3)."""
    law: InPython[LawProof]
    """Check of the law: it holds, or is obeyed by a motion of any power (`impending`)."""
    found: str
    """Name of the method."""
    programs: InPython[int]
    """Number of conic programs solved until then."""

    @property
    @key
    def power(self) -> float:
        """Power of the weight in the motion."""
        return self.law.power

    @property
    @key
    def residual(self) -> float:
        """Largest error of the contact law [-]."""
        return self.law.residual

    @property
    def exact(self) -> bool:
        """True if the motion obeys the contact law to 1e-9, also relative to its acceleration."""
        return self.law.obeyed and self.law.residual <= EXACTLY


class _MotionSearch:
    """State of the search for a motion that obeys the law: the work, and the best motion so far."""

    def __init__(self, program: Program, work: Work, impending: bool) -> None:
        self.program = program
        self.impending = impending
        self.law = coulomb_law(program)
        self.family = de_saxce_programs(self.law)
        self.work = work
        self.programs = 0
        self.seen: set[bytes] = set()
        self.best: CoulombMotion | None = None

    @property
    def over(self) -> bool:
        """Whether the search is complete or its work is spent."""
        return (self.best is not None and self.best.exact) or self.work.over

    def solve(self, shift: Array, lubricated: Mask) -> TrialMotion | None:
        """Make a step of De Saxce's iteration; None if the solver fails."""
        from kilter.solvers.clarabel import solve_conic

        answer = solve_conic(
            self.family.program(shift, lubricated), tolerance=SHARP, work=self.work
        )
        self.programs += 1
        if not answer.found:
            return None
        return TrialMotion(answer.x, self.family.forces(answer.multipliers, lubricated))

    def shift(self, x: Array) -> Array:
        """Speed mu |u_t| that De Saxce's method adds to each row's opening speed, shape (K,)."""
        u = (self.law.matrix @ x).reshape(-1, 3)
        shift: Array = self.law.mu * np.linalg.norm(u[:, 1:], axis=1)
        return shift

    def near(self, candidate: TrialMotion) -> bool:
        """True if a candidate nearly obeys the law, so that polishing it is worthwhile."""
        self.work.weighed(len(candidate.forces))
        most = NEARER if self.impending else NEAR
        return breach(self.law, candidate.x, candidate.forces) <= most * float(
            self.law.load @ candidate.x
        )

    def worthwhile(self, candidate: TrialMotion, method: str, step: int) -> bool:
        """True if a candidate should be polished now, before the iteration has ended."""
        if method == BY_MODES:
            return step == 0 and self.near(candidate)
        if len(self.law.mu) <= MOST_POINTS:
            return step in TRIES
        # at step 0 a candidate has no forces, or those of other coefficients of friction
        known = step > 0 or method == CONES
        return known and step in TRIES and self.near(candidate)

    def offer(self, candidate: TrialMotion, method: str) -> None:
        """Polish a candidate to an exact motion, check it, and keep the best motion."""
        seen = self.seen if method == BY_MODES else set()
        motions = polished(self.law, candidate, seen, self.work, impending=self.impending)
        for motion in chain((candidate,), motions):
            self.work.weighed(len(motion.forces))
            if not self.impending and not may_obey(self.law, motion.x, motion.forces):
                continue
            acceleration, forces = self.law.acceleration(motion.x), self.law.forces(motion.forces)
            law = check_law(self.program, acceleration, forces)
            self.work.judged(len(forces))
            counts = law.obeyed if self.impending else law.holds
            if counts and (self.best is None or law.residual < self.best.law.residual):
                self.best = CoulombMotion(acceleration, forces, law, method, self.programs)
            if self.over:
                return


@on_one_thread
def find_coulomb_motion(
    program: Program,
    *,
    work: Work | float,
    seed: int = 0,
    impending: bool = False,
    runaway: Array | None = None,
    only: Part | None = None,
) -> CoulombMotion | None:
    """Search for a motion from rest that obeys Coulomb's contact law; None if none was found.

    Arguments: `runaway` (N, 6).
    """
    search = _MotionSearch(program, Work.of(work), impending)
    if not len(search.law.load) or not search.law.strength:
        return None
    starts = _starts(search, np.random.default_rng(seed), runaway) if only != "modes" else ()
    modes = _mode_candidates(search) if only != "starts" else ()
    for method, candidate in chain(starts, modes):
        if candidate is not None:
            _iterate(search, candidate, method)
        if search.over:
            break
    return search.best


def _starts(
    search: _MotionSearch, rng: np.random.Generator, runaway: Array | None
) -> Iterator[tuple[str, TrialMotion | None]]:
    """Yield the first candidate motions, with the names of their methods."""
    law, report_stage = search.law, search.work.stage
    zero, patches = np.zeros(len(law.mu)), int(law.patch.max(initial=-1)) + 1
    report_stage("looking for a motion: some contacts lubricated")
    if search.impending:  # near a limit the motion is that of the proof, with little or no dilation
        yield CONES, search.solve(zero, np.zeros(len(law.mu), dtype=bool))
    yield "falling freely", TrialMotion(law.load, np.zeros((len(law.mu), 3)))
    yield "all contacts lubricated", search.solve(zero, np.ones(len(law.mu), dtype=bool))
    yield CONES, search.solve(zero, np.zeros(len(law.mu), dtype=bool))
    for start in range(3, STARTS):
        slippery = rng.random(patches) < rng.uniform(0.2, 0.8)
        yield (
            f"contacts lubricated at random, start {start}",
            search.solve(zero, slippery[law.patch]),
        )
    report_stage("looking for a motion: where the weight does not seat the parts")
    if runaway is None:
        runaway = find_seating(search.program, starts=1, work=search.work).runaway
    if runaway is not None:
        x = law.columns(runaway)
        x = x * (law.load @ x) / max(float(x @ x), TINY)
        yield "run-away from its seat", TrialMotion(x, np.zeros((len(law.mu), 3)))


def _mode_candidates(search: _MotionSearch) -> Iterator[tuple[str, TrialMotion]]:
    """Yield candidate motions of the branch and bound over contact modes."""
    if search.over or len(search.law.mu) > MOST_POINTS:
        return
    search.work.stage("looking for a motion: contact modes")
    for candidate in by_modes(search.law, nodes=NODES, work=search.work):
        search.programs += 1
        yield BY_MODES, candidate


def _iterate(search: _MotionSearch, candidate: TrialMotion, method: str) -> None:
    """Run De Saxce's iteration from a candidate; polish and keep motions on the way."""
    no_lubrication = np.zeros(len(search.law.mu), dtype=bool)
    shift = search.shift(candidate.x)
    for step in range(FEW if method == BY_MODES else ITERATIONS):
        if search.worthwhile(candidate, method, step):
            search.offer(candidate, method)
        size = float(np.linalg.norm(candidate.x))
        if search.over or size < GONE:
            return
        new = search.solve(shift, no_lubrication)
        if new is None:
            return
        candidate, last_shift = new, shift
        shift = search.shift(candidate.x)
        if float(np.abs(shift - last_shift).max(initial=0.0)) < STEADY * size:
            break
    small = len(search.law.mu) <= MOST_POINTS
    if float(np.linalg.norm(candidate.x)) >= GONE and (small or search.near(candidate)):
        search.offer(candidate, method)


@dataclass(frozen=True, slots=True, eq=False)
class DeSaxcePrograms:
    """Convex programs of De Saxce's iteration, which differ in the shift of the opening speeds."""

    law: CoulombLaw
    tied: Index
    smooth: Index
    rough: Index
    """Rows of joints, without friction, with friction."""
    lines: csc_array
    """Rows of H in the order of the program: joints, smooth, (n, u, v) of each rough row."""
    identity: csc_array

    def program(self, shift: Array, lubricated: Mask) -> ConicProgram:
        """The convex program for given shifts of the opening speeds, (K,), and lubricated rows."""
        law, before = self.law, len(self.tied) + len(self.smooth)
        scale, bound = np.ones(self.lines.shape[0]), np.zeros(self.lines.shape[0])
        friction = np.where(lubricated, 0.0, law.mu)[self.rough]
        scale[before + 1 :: 3] = friction
        scale[before + 2 :: 3] = friction
        bound[before::3] = np.where(lubricated, 0.0, shift)[self.rough]
        lines = self.lines
        entries = -lines.data * scale[lines.indices]
        return ConicProgram(
            self.identity,
            -law.load,
            csc_array((entries, lines.indices, lines.indptr), shape=lines.shape),
            bound,
            len(self.tied),
            len(self.smooth),
            np.full(len(self.rough), 3),
        )

    def forces(self, multipliers: Array, lubricated: Mask) -> Array:
        """Scaled forces (n, u, v), shape (K, 3), from the multipliers of a solved program."""
        forces = np.zeros((len(self.law.mu), 3))
        before = len(self.tied) + len(self.smooth)
        forces[self.tied, 0] = multipliers[: len(self.tied)]
        forces[self.smooth, 0] = multipliers[len(self.tied) : before]
        rough_forces = multipliers[before:].reshape(-1, 3).copy()
        rough_forces[:, 1:] *= np.where(lubricated, 0.0, self.law.mu)[self.rough][:, None]
        forces[self.rough] = rough_forces
        return forces


def de_saxce_programs(law: CoulombLaw) -> DeSaxcePrograms:
    """Build the programs of De Saxce's iteration for a contact law."""
    tied = np.flatnonzero(law.tied)
    smooth = np.flatnonzero(~law.tied & (law.mu <= 0))
    rough = np.flatnonzero(~law.tied & (law.mu > 0))
    triples = (3 * rough[:, None] + np.arange(3)).reshape(-1)
    order = np.concatenate([3 * tied, 3 * smooth, triples])
    identity = csc_array(eye_array(len(law.load)))
    return DeSaxcePrograms(law, tied, smooth, rough, csc_array(law.matrix[order]), identity)
