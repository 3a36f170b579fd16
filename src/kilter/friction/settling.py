"""Settling: put down loosely, do the parts come to rest, and by their own weight alone?

Parts begin at rest where they are drawn (x = 0), with a gap at every contact point, at random
between none and three times the deflection that their weight makes there, and come down along
their path in pseudo-time (`kilter.friction.relaxing`) between contacts that give a little
(`kilter.friction.springs`). They *settle* if every try ends in balance. What settles needs no
squeeze, and no care in putting it there: on 884 random assemblies every one in which motions
are excluded settled, and of 166 which a motion refutes one did.

The deflection of a point is the median over the points that press on its parts, of the forces
of the least elastic energy (`kilter.friction.elastic_forces`); of its two parts the smaller.

The gaps are drawn with a seed of their own a try: the same assembly has the same tries.
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
"""Tries that must all come to balance."""
LOOSE = 3.0
"""Largest gap, over the deflection of its point."""

End = Literal["balance", "runs-away", "not-found"]


@dataclass(frozen=True, slots=True, eq=False)
class Settling:
    """How the tries ended.

    Attributes
    ----------
    ends : tuple of {"balance", "runs-away", "not-found"}
        Of each try that was made; the tries end with one that was not found.
    forces : tuple of ndarray, shape (K, 3)
        Of each try that ended in balance, on part b of each row, world frame [N].
    of : int
        Tries that were asked for.
    iterations : int
        Newton steps of all tries.
    runaway : ndarray, shape (N, 6), or None
        Where the first try that was not in balance went, as an acceleration.
    """

    ends: tuple[End, ...]
    forces: tuple[Array, ...]
    of: int
    iterations: int
    runaway: Array | None = None

    @property
    def passed(self) -> int:
        """Tries that ended in balance."""
        return len(self.forces)

    @property
    def settles(self) -> bool:
        """Whether every try ended in balance."""
        return self.passed == self.of

    @property
    def runs_away(self) -> bool:
        """Whether some try ran away."""
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
    """Whether parts that are put down loosely come to rest.

    Parameters
    ----------
    program : Program
        With the friction of its contacts, whose cones hold forces of equilibrium.
    tries : int
    seed : int
        Of the first try; the next have the next.
    work : Work or float
        Or an effort (`kilter.work`); the tries end when it is spent.
    elastic : ElasticForces, optional
        Where they are known already.

    Examples
    --------
    >>> from kilter.contact import contacts
    >>> from kilter.mechanics.program import build_program
    >>> from kilter.scenes import friction, stacks
    >>> for one in (stacks.block_on_slope(26.0, friction=0.5), friction.bracket()):
    ...     find_settling(build_program(one, contacts(one))).passed
    8
    0
    """
    law, work = coulomb_law(program), Work.of(work)
    if not len(law.load) or not law.strength:
        none = (np.zeros((len(law.mu), 3)),) * tries
        ends: list[End] = ["balance"] * tries
        return Settling(tuple(ends), none, tries, 0)
    elastic = elastic or elastic_forces(law, work=work)
    deflection = _deflections(law, elastic)
    size = 1.0 if elastic is None else float(np.abs(elastic.displacement).max())
    system, stiffness = spring_system(law), np.ones(len(law.mu))
    endings: list[End] = []
    forces: list[Array] = []
    iterations, runaway = 0, None
    for number in range(tries):
        work.tell(f"putting it down loosely, try {number + 1} of {tries}")
        share = np.random.default_rng([seed + number, 8]).uniform(0.0, LOOSE, len(law.mu))
        springs = Springs(system, stiffness, np.where(law.tied, 0.0, share * deflection))
        rest = relaxed(springs, np.zeros(len(law.load)), work=work, size=size)
        iterations += rest.steps
        own = law.forces(rest.state.forces)
        balanced = check_balance(program, own) <= BALANCED
        endings.append("balance" if balanced else _lost(rest.end))
        if balanced:
            forces.append(own)
        elif runaway is None:
            away = rest.state.x / max(float(np.linalg.norm(rest.state.x)), TINY)
            runaway = law.acceleration(away)
        if endings[-1] == "not-found":
            break
    return Settling(tuple(endings), tuple(forces), tries, iterations, runaway)


def _lost(end: End) -> End:
    return "runs-away" if end == "runs-away" else "not-found"


def _deflections(law: CoulombLaw, elastic: ElasticForces | None) -> Array:
    """The deflection of each point, where it is 1 for a force of the weight."""
    program = law.program
    if elastic is None:
        return np.ones(len(law.mu))
    depth = np.maximum(elastic.forces[:, 0], 0.0)
    presses = ~law.tied & (depth > PRESSES * max(float(depth.max(initial=0.0)), TINY))
    if not presses.any():
        return np.ones(len(law.mu))
    own = np.full(len(program.names), np.inf)
    for part in np.flatnonzero(program.free):
        of_it = presses & ((program.part_a == part) | (program.part_b == part))
        if of_it.any():
            own[part] = np.median(depth[of_it])
    smaller = np.minimum(own[program.part_a], own[program.part_b])
    found: Array = np.where(np.isfinite(smaller), smaller, np.median(depth[presses]))
    return found
