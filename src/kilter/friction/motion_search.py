"""A motion that obeys Coulomb's law exactly, though forces of equilibrium may exist.

With friction more than one solution of the contact law may exist: rest and a motion. One such
motion shows that forces of equilibrium alone do not hold the parts. It is looked for

1. by De Saxce's iteration s <- mu |u_t(x(s))| (`kilter.friction.bipotential`), from starts
   with some or all patches lubricated;
2. from where the parts ran away when their weight was to seat them (`kilter.friction.seating`);
3. by branch and bound over contact modes (`kilter.friction.mode_search`), which alone finds
   solutions that repel the iteration.

Every candidate is made exact (`kilter.friction.polish`) and counts only if
`kilter.mechanics.law_check.check_law` accepts it. That none is found proves nothing.

Where no forces of equilibrium exist, the motion is the impending one, with friction.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from time import perf_counter

import numpy as np

from kilter.arrays import Array, Mask
from kilter.friction.bipotential import Bipotential, bipotential
from kilter.friction.frictional import frictional
from kilter.friction.mode_search import by_modes
from kilter.friction.polish import Candidate, polished
from kilter.friction.seating import find_seating
from kilter.mechanics.law_check import POWER, LawProof, check_law
from kilter.mechanics.program import Program

__all__ = ["EXACTLY", "CoulombMotion", "find_coulomb_motion"]


EXACTLY = 1e-9
"""Residual of the law that ends the search."""
STARTS = 8
"""Starts of De Saxce's iteration."""
ITERATIONS = 40
"""Steps of one start."""
FEW = 2
"""Steps from a candidate of branch and bound."""
NODES = 300
"""Nodes of branch and bound."""
MOST_POINTS = 150
"""Contact points above which 300 nodes decide too little to be worth their time."""
BY_MODES = "contact modes"
"""How a motion was found."""
CLOSE = 0.01
"""Residual over |a|^2 / |w|^2 of the nearest motion beyond which it tells nothing."""
SHARP = 1e-11
"""Tolerance of the conic programs: an interior point's x is good to its root only."""
GONE = 1e-5
"""A start whose |x| falls below this has come to rest."""
STEADY = 1e-7
"""Change of s, over |x|, at which a start has converged."""
TRIES = (0, 1, 3, 10)
"""Steps after which a candidate is made exact, besides the last."""


@dataclass(frozen=True, slots=True, eq=False)
class CoulombMotion:
    """Accelerations and forces that obey the contact law.

    Attributes
    ----------
    acceleration : ndarray, shape (N, 6)
        Linear [m/s^2], angular [rad/s^2].
    forces : ndarray, shape (K, 3)
        On part b of each row, world frame [N].
    law : LawProof
        It holds, unless the nearest was asked for too.
    found : str
        By what.
    programs : int
        Conic programs solved until then.
    """

    acceleration: Array
    forces: Array
    law: LawProof
    found: str
    programs: int

    @property
    def exact(self) -> bool:
        """Whether the law holds to 1e-9."""
        return self.law.holds and self.law.residual <= EXACTLY


class _Search:
    """What one search knows: the law, the time, the best so far."""

    def __init__(self, program: Program, budget: float, tell: Callable[[str], None] | None) -> None:
        self.program = program
        self.law = frictional(program)
        self.family: Bipotential = bipotential(self.law)
        self.end = perf_counter() + budget
        self.tell = tell or (lambda _: None)
        self.programs = 0
        self.seen: set[bytes] = set()
        self.best: CoulombMotion | None = None

    @property
    def over(self) -> bool:
        """Whether there is nothing more to do."""
        found = self.best is not None and self.best.exact
        return found or self.late()

    def late(self) -> bool:
        """Whether the time is over."""
        return perf_counter() > self.end

    @property
    def left(self) -> float:
        """Time that is left, at least a little [s]."""
        return max(self.end - perf_counter(), 0.05)

    def solve(self, shift: Array, lubricated: Mask) -> Candidate | None:
        """One step of De Saxce's iteration; None where the solver broke down."""
        from kilter.solvers.conic import solve_conic

        answer = solve_conic(
            self.family.program(shift, lubricated), tolerance=SHARP, seconds=self.left
        )
        self.programs += 1
        if answer.outcome == "infeasible" or not np.isfinite(answer.x).all():
            return None
        return Candidate(answer.x, self.family.forces(answer.multipliers, lubricated))

    def shift(self, x: Array) -> Array:
        """S = mu |u_t|, shape (K,)."""
        u = (self.law.matrix @ x).reshape(-1, 3)
        shift: Array = self.law.mu * np.linalg.norm(u[:, 1:], axis=1)
        return shift

    def offer(self, candidate: Candidate, found: str) -> None:
        """Make a candidate exact, judge it, keep the best."""
        seen = self.seen if found == BY_MODES else set()
        for one in [candidate, *polished(self.law, candidate, seen, self.late)]:
            acceleration, forces = self.law.acceleration(one.x), self.law.forces(one.forces)
            law = check_law(self.program, acceleration, forces)
            if law.power > POWER and (self.best is None or _merit(law) < _merit(self.best.law)):
                self.best = CoulombMotion(acceleration, forces, law, found, self.programs)
            if self.over:
                return


def _merit(law: LawProof) -> tuple[bool, float]:
    """Less is better."""
    return not law.holds, law.residual / max(law.size, 1e-300)


def find_coulomb_motion(
    program: Program,
    *,
    budget: float,
    seed: int = 0,
    tell: Callable[[str], None] | None = None,
    nearest: bool = False,
    runaway: Array | None = None,
) -> CoulombMotion | None:
    """A motion that obeys the contact law, or None where none was found.

    Parameters
    ----------
    program : Program
        Contacts with mu, no pyramids.
    budget : float
        [s]
    seed : int
        Of the patches that are lubricated.
    tell : callable, optional
        Called with a line of text before each kind of search.
    nearest : bool
        Also a motion that does not obey the law well enough to count, the nearest.
    runaway : ndarray, shape (N, 6), optional
        Of `find_seating`, where that has been asked already.
    """
    search = _Search(program, budget, tell)
    if not len(search.law.load) or not search.law.strength:
        return None
    rng = np.random.default_rng(seed)
    for found, candidate in _starts(search, rng, runaway):
        if candidate is not None:
            _iterate(search, candidate, found)
        if search.over:
            break
    best = search.best
    if best is None or best.law.holds:
        return best
    close = best.law.residual <= CLOSE * best.law.size
    return best if nearest and close else None


def _starts(
    search: _Search, rng: np.random.Generator, runaway: Array | None
) -> Iterator[tuple[str, Candidate | None]]:
    """First candidates, with what to call them."""
    law = search.law
    zero, patches = np.zeros(len(law.mu)), int(law.patch.max(initial=-1)) + 1
    search.tell("looking for a motion: some contacts lubricated")
    yield "falling freely", Candidate(law.load, np.zeros((len(law.mu), 3)))
    yield "all contacts lubricated", search.solve(zero, np.ones(len(law.mu), dtype=bool))
    yield "cones without sliding", search.solve(zero, np.zeros(len(law.mu), dtype=bool))
    for start in range(3, STARTS):
        slippery = rng.random(patches) < rng.uniform(0.2, 0.8)
        yield (
            f"contacts lubricated at random, start {start}",
            search.solve(zero, slippery[law.patch]),
        )
    search.tell("looking for a motion: where the weight does not seat the parts")
    if runaway is None:
        runaway = find_seating(search.program, starts=1, budget=search.left).runaway
    if runaway is not None:
        x = law.columns(runaway)
        x = x * (law.load @ x) / max(float(x @ x), 1e-300)
        yield "run-away from its seat", Candidate(x, np.zeros((len(law.mu), 3)))
    search.tell("looking for a motion: contact modes")
    if len(law.mu) <= MOST_POINTS:
        for candidate in by_modes(law, nodes=NODES, seconds=search.left):
            search.programs += 1
            yield BY_MODES, candidate


def _iterate(search: _Search, candidate: Candidate, found: str) -> None:
    """De Saxce's iteration from a first candidate."""
    none = np.zeros(len(search.law.mu), dtype=bool)
    shift = search.shift(candidate.x)
    for step in range(FEW if found == BY_MODES else ITERATIONS):
        if step in TRIES[: 1 if found == BY_MODES else None]:
            search.offer(candidate, found)
        size = float(np.linalg.norm(candidate.x))
        if search.over or size < GONE:
            return
        new = search.solve(shift, none)
        if new is None:
            return
        candidate, last = new, shift
        shift = search.shift(candidate.x)
        if float(np.abs(shift - last).max(initial=0.0)) < STEADY * size:
            break
    search.offer(candidate, found)
