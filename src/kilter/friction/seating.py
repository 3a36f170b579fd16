"""Seating: does its own weight hold it somewhere, if it is put there with care?

Between contacts that give a little, and that neither a gap nor a squeeze separated or pressed
before (`kilter.friction.springs`), parts under load may have a displacement x at which every
part is in balance: a *seat*. Its forces are forces of equilibrium, each exactly in its cone. A
block squeezed between walls has such forces too, but no displacement makes them.

A seat is looked for from the forces of the least elastic energy (`kilter.friction.
elastic_forces`), which is found at any size; then from no displacement at all; then with a
stiffness that varies by 0.1 to 10 a patch, from squeezed starts. Where all of them run away,
that is evidence that there is no seat, and the direction in which they ran is told. That a
start was given up says nothing.

A seat is weak evidence: a bracket that falls when it is let go has one. What holds however it
is put down is said by `kilter.friction.settling`.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import inf
from typing import Literal

import numpy as np
from scipy.sparse import csc_array, eye_array

from kilter.arrays import TINY, Array
from kilter.friction.elastic_forces import ElasticForces, elastic_forces
from kilter.friction.friction_tolerances import BALANCED, SOFT_SQUEEZE
from kilter.friction.law import CoulombLaw, coulomb_law
from kilter.friction.relaxing import FIRST, relaxed
from kilter.friction.springs import Springs, spring_system
from kilter.mechanics.law_check import check_balance
from kilter.mechanics.program import Program
from kilter.threads import on_one_thread
from kilter.work import Work

__all__ = ["Seating", "find_seating"]

NEAR = 1e4
"""First step h from the forces of the least energy, which are near a seat."""
SPREAD = 10.0
"""At random the stiffness of a patch is up to this factor above or below 1."""
SQUEEZE = 10.0
"""Largest depth to which such a start presses patches at first; 1 makes forces of the weight."""
NUDGE = 1.0
"""Size of the random part of its first displacement, in each freedom."""


@dataclass(frozen=True, slots=True, eq=False)
class Seating:
    """Whether the weight seats the parts.

    Attributes
    ----------
    seated : {"yes", "runs-away", "not-found"}
        There is a seat; every start ran away; some were given up.
    forces : ndarray, shape (K, 3)
        On part b of each row, world frame [N]; exactly in their cones; those of the start that
        balanced best.
    residual : float
        Worst imbalance of a part over its weight, of those forces [-].
    starts, iterations : int
        How many were needed.
    runaway : ndarray, shape (N, 6), or None
        The direction in which the parts ran away, as an acceleration; None where seated.
    """

    seated: Literal["yes", "runs-away", "not-found"]
    forces: Array
    residual: float
    starts: int
    iterations: int
    runaway: Array | None

    @property
    def holds(self) -> bool:
        """Whether there is a seat."""
        return self.seated == "yes"


@on_one_thread
def find_seating(
    program: Program,
    *,
    seed: int = 0,
    starts: int = 6,
    work: Work | float = inf,
    elastic: ElasticForces | None = None,
) -> Seating:
    """Whether the weight of the parts seats them.

    Parameters
    ----------
    program : Program
        With the friction of its contacts.
    seed : int
        Of the stiffnesses and first displacements at random.
    starts : int
        Starts at most.
    work : Work or float
        Or an effort (`kilter.work`); when it is spent, the search ends with what it has.
    elastic : ElasticForces, optional
        Where they are known already.

    Examples
    --------
    >>> from kilter.contact import contacts
    >>> from kilter.mechanics.program import build_program
    >>> from kilter.scenes.stacks import block_on_slope
    >>> for tilt in (26.5, 26.6):  # the limit is atan 0.5 = 26.565 degrees
    ...     block = block_on_slope(tilt, friction=0.5)
    ...     find_seating(build_program(block, contacts(block))).seated
    'yes'
    'runs-away'
    """
    law = coulomb_law(program)
    if not len(law.load) or not law.strength:
        none = np.zeros((len(program.part_a), 3))
        return Seating("yes", none, check_balance(program, none), 0, 0, None)
    work, system = Work.of(work), spring_system(law)
    best: Seating | None = None
    elastic = elastic or elastic_forces(law, work=work)
    size = 1.0 if elastic is None else float(np.abs(elastic.displacement).max())
    iterations, gone = 0, True
    for start, (stiffness, x, first) in enumerate(_starts(law, elastic, seed), 1):
        rest = relaxed(Springs(system, stiffness), x, work=work, first=first, size=size)
        iterations += rest.steps
        gone = gone and rest.end == "runs-away"
        forces = law.forces(rest.state.forces)
        residual = check_balance(program, forces)
        if residual <= BALANCED:
            return Seating("yes", forces, residual, start, iterations, None)
        if best is None or residual < best.residual:
            away = law.acceleration(rest.state.x / max(float(np.linalg.norm(rest.state.x)), TINY))
            best = Seating("not-found", forces, residual, start, iterations, away)
        if work.over or start >= starts:
            break
    assert best is not None  # there is at least one start
    seated: Literal["runs-away", "not-found"] = "runs-away" if gone else "not-found"
    return Seating(seated, best.forces, best.residual, start, iterations, best.runaway)


def _starts(
    law: CoulombLaw, elastic: ElasticForces | None, seed: int
) -> Iterator[tuple[Array, Array, float]]:
    """Stiffness of each row, first displacement and first step of each start, without end."""
    rng = np.random.default_rng(seed)
    if elastic is not None:
        yield np.ones(len(law.mu)), elastic.displacement, NEAR
    yield np.ones(len(law.mu)), np.zeros(len(law.load)), FIRST
    while True:
        yield *_squeezed(law, rng), FIRST


def _squeezed(law: CoulombLaw, rng: np.random.Generator) -> tuple[Array, Array]:
    """A stiffness a patch, and a first displacement that squeezes what it can, and a little."""
    from scipy.sparse.linalg import splu

    patches = int(law.patch.max(initial=-1)) + 1
    stiffness = SPREAD ** rng.uniform(-1.0, 1.0, patches)[law.patch]
    depth = rng.uniform(0.0, SQUEEZE, patches)[law.patch]
    normal = law.matrix[::3]
    nearest = csc_array(normal.T @ normal + SOFT_SQUEEZE * eye_array(len(law.load)))
    x: Array = splu(nearest, permc_spec="MMD_AT_PLUS_A").solve(-(normal.T @ depth))
    return stiffness, x + rng.normal(size=len(x)) * NUDGE
