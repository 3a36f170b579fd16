"""Search for a seat: a state of rest in which the weight of carefully placed parts holds them.

Between contacts that give a little, and that start without a gap or a squeeze
(`kilter.friction.springs`), parts under load may have a displacement x at which every part is in
balance: a *seat*. Its forces are forces of equilibrium, each exactly in its cone. A block squeezed
between walls has forces of equilibrium too, but no displacement produces them.

The search starts from the forces of the least elastic energy (`kilter.friction.spring_newton`),
which can be found at any size; then from zero displacement; then with stiffnesses that vary by a
factor of 0.1 to 10 between patches, from squeezed starts. If all starts run away, that is evidence
that no seat exists, and the direction in which the parts ran is returned. A start that failed says
nothing.

A seat is weak evidence: a bracket that falls when it is released has a seat.
`kilter.friction.settling` reports what holds however it is put down.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import inf
from typing import Annotated, Literal

import numpy as np
from scipy.sparse import csc_array, eye_array

from kilter.arrays import TINY, Array
from kilter.friction.friction_tolerances import BALANCED, SOFT_SQUEEZE
from kilter.friction.law import CoulombLaw, coulomb_law
from kilter.friction.relaxing import FIRST, Rest, relaxed
from kilter.friction.spring_newton import (
    ElasticForces,
    SharedFactor,
    balanced_springs,
    elastic_forces,
)
from kilter.friction.springs import Springs, spring_system
from kilter.mechanics.law_check import check_balance
from kilter.mechanics.program import Program
from kilter.tell.record import InPython, Record, Shape, key
from kilter.threads import on_one_thread
from kilter.work import Work

NEAR = 1e4
"""First pseudo-time step if the search starts at the forces of least energy, near a seat."""
SPREAD = 10.0
"""Random stiffnesses of patches are up to this factor above or below 1."""
SQUEEZE = 10.0
"""Largest initial depth to which such a start presses patches; a depth of 1 produces forces of the
weight.
"""
NUDGE = 1.0
"""Size of the random part of its first displacement, in each freedom."""


class Seating(Record, kw_only=False):
    """Result of the search for a seat (a state of rest with slightly elastic contacts)."""

    seated: Literal["yes", "runs-away", "not-found"]
    """A seat exists; every start ran away; some starts failed."""
    forces: InPython[Array]
    """Forces on part b of each row, world frame [N], exactly in their cones, of the start that
    balanced best, shape (K, 3)."""
    residual: float
    """Worst imbalance of a part over its weight, for those forces [-]."""
    starts: InPython[int]
    """Number of starts."""
    iterations: InPython[int]
    """Number of Newton steps."""
    runaway: InPython[Array | None]
    """The same as `direction`."""

    @property
    @key
    def direction(self) -> Annotated[Array, Shape(None, 6)] | None:
        """The direction in which the parts ran away, as an acceleration; null if seated."""
        return self.runaway

    @property
    def holds(self) -> bool:
        """True if the search found a seat."""
        return self.seated == "yes"


@on_one_thread
def find_seating(
    program: Program,
    *,
    seed: int = 0,
    starts: int = 6,
    work: Work | float = inf,
    elastic: ElasticForces | None = None,
    factor: SharedFactor | None = None,
) -> Seating:
    """Search for a seat: a state of rest with elastic contacts, produced by the weight alone.

    Arguments: `work`: work limit, or an effort (`kilter.work`); when it is spent, the search ends
    with its best result.

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
    law = coulomb_law(program) if factor is None else factor.system.law
    if not len(law.load) or not law.strength:
        no_forces = np.zeros((len(program.part_a), 3))
        return Seating("yes", no_forces, check_balance(program, no_forces), 0, 0, None)
    work, factor = Work.of(work), factor or SharedFactor(spring_system(law))
    best: Seating | None = None
    elastic = elastic or elastic_forces(law, work=work, factor=factor)
    size = 1.0 if elastic is None else float(np.abs(elastic.displacement).max())
    iterations, all_run_away = 0, True
    for start, (stiffness, x, first) in enumerate(_starts(law, elastic, seed), 1):
        springs = Springs(factor.system, stiffness)
        rest = _near_rest(springs, x, factor, work) if first == NEAR else None
        rest = rest or relaxed(springs, x, work=work, first=first, size=size)
        iterations += rest.steps
        all_run_away = all_run_away and rest.end == "runs-away"
        forces = law.forces(rest.state.forces)
        residual = check_balance(program, forces)
        if residual <= BALANCED:
            return Seating("yes", forces, residual, start, iterations, None)
        if best is None or residual < best.residual:
            runaway = law.acceleration(
                rest.state.x / max(float(np.linalg.norm(rest.state.x)), TINY)
            )
            best = Seating("not-found", forces, residual, start, iterations, runaway)
        if work.over or start >= starts:
            break
    assert best is not None  # there is at least one start
    seated: Literal["runs-away", "not-found"] = "runs-away" if all_run_away else "not-found"
    return Seating(seated, best.forces, best.residual, start, iterations, best.runaway)


def _near_rest(springs: Springs, x: Array, factor: SharedFactor, work: Work) -> Rest | None:
    """A seat near the displacement of the least energy, by inexact Newton steps."""
    if factor.narrow:
        return None
    balance = balanced_springs(springs, x, factor, work)
    return None if balance is None else Rest(balance[0], "balance", balance[1])


def _starts(
    law: CoulombLaw, elastic: ElasticForces | None, seed: int
) -> Iterator[tuple[Array, Array, float]]:
    """Yield starts, endlessly: stiffness of each row, first displacement and first step."""
    rng = np.random.default_rng(seed)
    if elastic is not None:
        yield np.ones(len(law.mu)), elastic.displacement, NEAR
    yield np.ones(len(law.mu)), np.zeros(len(law.load)), FIRST
    while True:
        yield *_random_squeeze(law, rng), FIRST


def _random_squeeze(law: CoulombLaw, rng: np.random.Generator) -> tuple[Array, Array]:
    """Random stiffness of each patch, and a displacement that presses all patches together."""
    from scipy.sparse.linalg import splu

    patches = int(law.patch.max(initial=-1)) + 1
    stiffness = SPREAD ** rng.uniform(-1.0, 1.0, patches)[law.patch]
    depth = rng.uniform(0.0, SQUEEZE, patches)[law.patch]
    normal = law.matrix[::3]
    nearest = csc_array(normal.T @ normal + SOFT_SQUEEZE * eye_array(len(law.load)))
    x: Array = splu(nearest, permc_spec="MMD_AT_PLUS_A").solve(-(normal.T @ depth))
    return stiffness, x + rng.normal(size=len(x)) * NUDGE
