"""Settling: whether loosely placed parts come to rest by their own weight alone.

Parts begin at rest in their drawn positions (x = 0), with a random gap at every contact point,
between zero and three times the deflection that their weight causes there. They come down along
their path in pseudo-time (`kilter.friction.relaxing`) between contacts that give a little
(`kilter.friction.springs`). They *settle* if every try ends in balance. An assembly that settles
needs neither squeeze nor careful placement: of 884 random assemblies, every one for which motions
are excluded settled, and of 166 that a motion refutes, a single one did.

The deflection of a point is the median over the pressed points of its parts, for the forces of the
least elastic energy (`kilter.friction.elastic_forces`); the smaller of its two parts counts.

The gaps of each try have a fixed seed: the same assembly has the same tries.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import Literal

import numpy as np

from kilter.arrays import TINY, Array
from kilter.friction.elastic_forces import ElasticForces, elastic_forces
from kilter.friction.friction_tolerances import BALANCED, PRESSES
from kilter.friction.law import CoulombLaw, coulomb_law
from kilter.friction.relaxing import relaxed
from kilter.friction.springs import Springs, spring_system
from kilter.mechanics.law_check import check_balance
from kilter.mechanics.program import Program
from kilter.threads import on_one_thread
from kilter.work import Work

__all__ = ["TRIES", "Settling", "find_settling"]

TRIES = 8
"""Number of tries that must all come to balance."""
LOOSE = 3.0
"""Largest initial gap of a contact point, over its deflection under the weight [-]."""

HOPELESS = 1.5
"""A try ends if all tries at its speed would take this many times the allowed work."""

End = Literal["balance", "runs-away", "not-found"]


@dataclass(frozen=True, slots=True, eq=False)
class Settling:
    """Results of the settling tries, in which parts start with gaps and come down by their weight.

    Attributes
    ----------
    ends : tuple of {"balance", "runs-away", "not-found"}
        End of each try; the first try that is not found is the last.
    forces : tuple of ndarray, shape (K, 3)
        Forces of each try that ended in balance, on part b of each row, world frame [N].
    of : int
        Number of requested tries.
    iterations : int
        Newton steps of all tries.
    runaway : ndarray, shape (N, 6), or None
        Direction of the first try that was not in balance, as an acceleration.
    """

    ends: tuple[End, ...]
    forces: tuple[Array, ...]
    of: int
    iterations: int
    runaway: Array | None = None

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
) -> Settling:
    """Put the parts down loosely in several tries, and find whether they come to rest.

    Parameters
    ----------
    program : Program
        With the friction of its contacts, whose cones hold forces of equilibrium.
    tries : int
        Number of tries.
    seed : int
        Seed of the first try; each further try adds 1.
    work : Work or float
        Work limit, or an effort (`kilter.work`); the tries end when it is spent.
    elastic : ElasticForces, optional
        Forces of the least energy, if they are known.

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
    law, work = coulomb_law(program), Work.of(work)
    if not len(law.load) or not law.strength:
        no_forces = (np.zeros((len(law.mu), 3)),) * tries
        ends: list[End] = ["balance"] * tries
        return Settling(tuple(ends), no_forces, tries, 0)
    elastic = elastic or elastic_forces(law, work=work)
    deflection = _deflections(law, elastic)
    size = 1.0 if elastic is None else float(np.abs(elastic.displacement).max())
    system, stiffness = spring_system(law), np.ones(len(law.mu))
    endings: list[End] = []
    forces: list[Array] = []
    iterations, runaway = 0, None
    for number in range(tries):
        work.tell(f"putting it down loosely, try {number + 1} of {tries}")
        gap_share = np.random.default_rng([seed + number, 8]).uniform(0.0, LOOSE, len(law.mu))
        springs = Springs(system, stiffness, np.where(law.tied, 0.0, gap_share * deflection))
        share = work.until(HOPELESS * (number + 1) / tries)
        rest = relaxed(springs, np.zeros(len(law.load)), work=share, size=size)
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
    part_deflection = np.full(len(program.names), np.inf)
    for part in np.flatnonzero(program.free):
        of_part = presses & ((program.part_a == part) | (program.part_b == part))
        if of_part.any():
            part_deflection[part] = np.median(depth[of_part])
    smaller = np.minimum(part_deflection[program.part_a], part_deflection[program.part_b])
    deflection: Array = np.where(np.isfinite(smaller), smaller, np.median(depth[presses]))
    return deflection
