"""Settling: whether loosely placed parts come to rest by their own weight alone.

Every contact point has a random gap, between zero and three times the deflection that the weight
causes there, and gives a little (`kilter.friction.springs`). First the parts are held with all
points closed across their gaps. Then they are released, and points that would pull open: Newton's
method finds the balance (`kilter.friction.spring_newton`), with a factorisation that the tries
share. If it finds none, the parts begin at rest in their drawn positions (x = 0) instead, and come
down along their path in pseudo-time (`kilter.friction.relaxing`). They come down from the beginning
if a part has no support in the direction of its load: such a part falls past the states in which it
could jam. Parts *settle* if every try ends in balance. An assembly that settles
needs neither squeeze nor careful placement: of 884 random assemblies, every one for which motions
are excluded settled, and of 166 that a motion refutes, a single one did.

The deflection of a point is the median over the pressed points of its parts, for the forces of the
least elastic energy (`kilter.friction.spring_newton`); the smaller of its two parts counts.

The gaps of each try have a fixed seed: the same assembly has the same tries.
"""

from __future__ import annotations

from dataclasses import replace
from math import inf
from typing import Literal

import numpy as np
from scipy.sparse import csr_array

from kilter.arrays import TINY, Array, Index
from kilter.friction.friction_tolerances import BALANCED, PRESSES
from kilter.friction.law import CoulombLaw, coulomb_law
from kilter.friction.relaxing import Rest, relaxed
from kilter.friction.spring_newton import (
    ElasticForces,
    SharedFactor,
    balanced_springs,
    elastic_forces,
)
from kilter.friction.springs import Springs, SpringState, spring_system
from kilter.mechanics.law_check import check_balance
from kilter.mechanics.program import Program
from kilter.tell.record import InPython, Record
from kilter.threads import on_one_thread
from kilter.work import Work

TRIES = 8
"""Number of tries that must all come to balance."""
LOOSE = 3.0
"""Largest initial gap of a contact point, over its deflection under the weight [-]."""

MEETS = 1e-9
"""Least speed at which a part meets another, over the largest component of the load [-]."""
HOPELESS = 1.5
"""A try ends if all tries at its speed would take this many times the allowed work."""

End = Literal["balance", "runs-away", "not-found"]


class Settling(Record, kw_only=False):
    """Results of the settling tries: parts start with gaps and come down by their weight."""

    ends: tuple[End, ...]
    """End of each try; the first try that is not found is the last."""
    forces: InPython[tuple[Array, ...]]
    """Forces of each try that ended in balance, on part b of each row, world frame [N]."""
    of: int
    """Number of requested tries."""
    iterations: InPython[int]
    """Newton steps of all tries."""
    runaway: InPython[Array | None] = None
    """Direction of the first try that was not in balance, as an acceleration."""

    @property
    def passed(self) -> int:
        """Number of settling tries that ended in balance."""
        return len(self.forces)

    @property
    def settles(self) -> bool:
        """True if every settling try ended in balance."""
        return self.passed == self.of

    @property
    def runs_away(self) -> bool:
        """True if the parts of at least one settling try ran away."""
        return "runs-away" in self.ends


@on_one_thread
def find_settling(
    program: Program,
    *,
    tries: int = TRIES,
    seed: int = 0,
    work: Work | float = inf,
    elastic: ElasticForces | None = None,
    factor: SharedFactor | None = None,
) -> Settling:
    """Put the parts down loosely in several tries, and find whether they come to rest.

    Arguments: `program`: with the friction of its contacts, whose cones hold forces of equilibrium;
    `work`: work limit, or an effort (`kilter.work`); the tries end when it is spent.

    Examples
    --------
    >>> from kilter.contact import contacts
    >>> from kilter.mechanics.program import build_program
    >>> from kilter.scenes import friction, stacks
    >>> for assembly in (stacks.block_on_slope(26.0, friction=0.5), friction.bracket()):
    ...     find_settling(build_program(assembly, contacts(assembly))).passed
    8
    0
    """
    law = coulomb_law(program) if factor is None else factor.system.law
    work = Work.of(work)
    if not len(law.load) or not law.strength:
        no_forces = (np.zeros((len(law.mu), 3)),) * tries
        ends: list[End] = ["balance"] * tries
        return Settling(tuple(ends), no_forces, tries, 0)
    factor = factor or SharedFactor(spring_system(law))
    elastic = elastic or elastic_forces(law, work=work, factor=factor)
    descent = _SpringDescent(factor, elastic)
    deflection = _deflections(law, elastic)
    stiffness = np.ones(len(law.mu))
    endings: list[End] = []
    forces: list[Array] = []
    iterations, runaway = 0, None
    for number in range(tries):
        work.tell(f"putting it down loosely, try {number + 1} of {tries}")
        gap_share = np.random.default_rng([seed + number, 8]).uniform(0.0, LOOSE, len(law.mu))
        gap = np.where(law.tied, 0.0, gap_share * deflection)
        share = work.until(HOPELESS * (number + 1) / tries)
        rest = descent.rest(Springs(factor.system, stiffness, gap), gap, share)
        iterations += rest.steps
        world_forces = law.forces(rest.state.forces)
        balanced = check_balance(program, world_forces) <= BALANCED
        endings.append("balance" if balanced else _unbalanced_end(rest.end))
        if balanced:
            forces.append(world_forces)
        elif runaway is None:
            direction = rest.state.x / max(float(np.linalg.norm(rest.state.x)), TINY)
            runaway = law.acceleration(direction)
        if endings[-1] == "not-found":
            break
    return Settling(tuple(endings), tuple(forces), tries, iterations, runaway)


class _SpringDescent:
    """Descents of the parts to balance, which share a factorisation and the last results."""

    def __init__(self, factor: SharedFactor, elastic: ElasticForces | None) -> None:
        self._factor, self._elastic = factor, elastic
        self._size = 1.0 if elastic is None else float(np.abs(elastic.displacement).max())
        self._supported = _all_supported(factor.system.law)
        self._shifts: list[Array] = []

    def rest(self, springs: Springs, gap: Array, work: Work) -> Rest:
        """Where the parts come to rest from a gap at each point, shape (K,)."""
        zero, steps = np.zeros(len(self._factor.system.law.load)), 0
        if self._supported:
            released, steps = self._release(springs, gap, work)
            if released is not None:
                return Rest(released, "balance", steps)
        rest = relaxed(springs, zero, work=work, size=self._size)
        return replace(rest, steps=rest.steps + steps)

    def _release(self, springs: Springs, gap: Array, work: Work) -> tuple[SpringState | None, int]:
        """Release the parts from rest with all points closed; state in balance, and Newton steps.

        Contact points that pull the parts together across their gaps stop pulling. The displacement
        that follows is first estimated by that of the least energy, then by the earlier tries.
        """
        factor, law = self._factor, self._factor.system.law
        pulls = np.zeros((len(gap), 3))
        pulls[:, 0] = -gap
        closed = factor.start(law.load + factor.system.transposed @ pulls.reshape(-1), work)
        start = closed
        if self._shifts:
            start = closed + np.mean(self._shifts, axis=0)
        elif self._elastic is not None:
            start = closed + self._elastic.displacement - factor.start(law.load, work)
        if factor.narrow:
            rest = relaxed(springs, start, work=work, size=self._size)
            state, steps = rest.state if rest.end == "balance" else None, rest.steps
        else:
            balance = balanced_springs(springs, start, factor, work)
            state, steps = (None, 0) if balance is None else balance
        if state is not None:
            self._shifts.append(state.x - closed)
        return state, steps


def _all_supported(law: CoulombLaw) -> bool:
    """Whether each free part that moves along its load meets a held part or a supported part.

    An unsupported part, such as a bracket on a post, can be held only by friction.
    """
    program, per = law.program, law.root.shape[1]
    number = np.full(len(program.names) + 1, -1)  # the ground is the last
    number[:-1][program.free] = np.arange(len(law.root))
    sides = number[np.column_stack([program.part_a, program.part_b])]
    entries = law.matrix[::3].tocoo()
    part, speed = entries.col // per, entries.data * law.load[entries.col]
    opening = np.zeros(sides.shape)
    for side in range(2):
        own = sides[entries.row, side] == part
        np.add.at(opening[:, side], entries.row[own], speed[own])
    meets = (opening < -MEETS * float(np.abs(law.load).max(initial=0.0))) | law.tied[:, None]
    held = len(law.root)
    above = np.concatenate([sides[:, side][meets[:, side]] for side in range(2)])
    below = np.concatenate([sides[:, 1 - side][meets[:, side]] for side in range(2)])
    used = above >= 0
    links = (np.where(below < 0, held, below)[used], above[used])
    graph = csr_array((np.ones(len(links[0])), links), shape=(held + 1, held + 1))
    from scipy.sparse.csgraph import breadth_first_order  # slow to import

    return len(breadth_first_order(graph, held, return_predecessors=False)) == held + 1


def _unbalanced_end(end: End) -> End:
    """The result of a settling try that did not end in balance: "runs-away" or "not-found"."""
    return "runs-away" if end == "runs-away" else "not-found"


def _deflections(law: CoulombLaw, elastic: ElasticForces | None) -> Array:
    """Deflection of each contact point under the weight [-]; 1 if no forces are known."""
    program = law.program
    if elastic is None:
        return np.ones(len(law.mu))
    depth = np.maximum(elastic.forces[:, 0], 0.0)
    presses = ~law.tied & (depth > PRESSES * max(float(depth.max(initial=0.0)), TINY))
    if not presses.any():
        return np.ones(len(law.mu))
    count = len(program.names) + 1  # the ground is the last
    parts = np.concatenate([program.part_a[presses], program.part_b[presses]]) % count
    part_deflection = _medians(np.tile(depth[presses], 2), parts, count)
    part_deflection[np.append(~program.free, True)] = np.inf
    smaller = np.minimum(part_deflection[program.part_a], part_deflection[program.part_b])
    deflection: Array = np.where(np.isfinite(smaller), smaller, np.median(depth[presses]))
    return deflection


def _medians(values: Array, group: Index, count: int) -> Array:
    """Median of the values of each group, shape (count,); infinite for a group without values."""
    order = np.lexsort((values, group))
    size = np.bincount(group, minlength=count)
    start = np.cumsum(size) - size
    medians = np.full(count, np.inf)
    used = np.flatnonzero(size)
    lower, upper = start[used] + (size[used] - 1) // 2, start[used] + size[used] // 2
    medians[used] = (values[order[lower]] + values[order[upper]]) / 2
    return medians
