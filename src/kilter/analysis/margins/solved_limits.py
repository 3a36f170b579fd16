"""The limits of a margin as solved programs: forces, motion and the load that each multiplies.

The least tilt and the weakest push are the least of many limits, one for each direction. Their
derivative is that of the limit along the least direction, which the motion gives. If several
directions have the same limit, each is a case: the least of them all is the limit.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Protocol, get_args

import numpy as np

from kilter.analysis.analysis_tolerances import SAME_LIMIT, STEEPEST
from kilter.analysis.gradients.limit_case import (
    LimitCase,
    LimitCases,
    LimitWord,
    least_direction,
    refined_case,
)
from kilter.analysis.gradients.limit_power import SolvedLimit
from kilter.analysis.load_limit import Limit, NoLimit, SharedCones, gravity_wrench
from kilter.analysis.margins.least_friction import LeastFriction
from kilter.analysis.margins.part_limits import PartLoad, Push
from kilter.analysis.margins.tilt import TiltMargin, held_limit
from kilter.arrays import TINY, Array, across, cross
from kilter.assembly import Assembly
from kilter.contact.round_edges import RoundEdge
from kilter.errors import InputError, some_names
from kilter.mechanics.clusters import clusters, different_clusters
from kilter.mechanics.program import Program

DIRECTIONS = 8
"""From this number of directions with the same limit on, all directions are searched."""
APART = 1e-3
"""Directions that differ by more are different cases [rad]."""
SAME_WAY = 1e-6
"""Refined directions that differ by less are the same case [-]."""
SAME_VALUE = 1e-9
"""Limits whose relative difference is below this are equal; refined limits have twelve digits."""


class KnownAssembly(Protocol):
    """An assembly with its contacts."""

    @property
    def assembly(self) -> Assembly:
        """The assembly."""

    @property
    def program(self) -> Program:
        """The modelled contacts, with friction."""

    @property
    def edges(self) -> tuple[RoundEdge, ...]:
        """Round edges over which parts tip."""


class KnownLimits(KnownAssembly, Protocol):
    """The limits of an answer of `kilter.margin`."""

    @property
    def tilt(self) -> TiltMargin | None:
        """The least tilt."""

    @property
    def friction_limit(self) -> LeastFriction | None:
        """The least friction."""

    @property
    def load_limits(self) -> tuple[Limit | None, Limit | None] | None:
        """The least and the greatest load factor."""

    @property
    def push(self) -> Array | None:
        """Direction of the body force of the load factor, shape (3,)."""

    @property
    def pushes(self) -> tuple[Push, ...]:
        """The weakest pushes of parts."""

    @property
    def loads(self) -> tuple[PartLoad, ...]:
        """The largest loads on parts."""


def limit_cases(margin: KnownLimits, of: str, part: str | None) -> LimitCases:
    """The solved limits of an answer of `kilter.margin`.

    Raises `InputError` if the answer has no finite limit of this kind.
    """
    if of not in get_args(LimitWord):
        raise InputError(
            f"there is no limit {of!r}", hint=f"name {some_names(get_args(LimitWord))}"
        )
    require_plain(margin.program)
    found = {
        "tilt": _tilt,
        "friction": _friction,
        "load factor": _load_factor,
        "least load factor": _load_factor,
        "push": _part_limit,
        "load": _part_limit,
    }[of](margin, of, part)
    if found is None:
        raise InputError(
            f"there is no finite limit {of!r} of this assembly",
            hint="request another limit; one that does not stand has a change that makes it stand",
        )
    return found


def require_plain(program: Program) -> None:
    """Reject bonds, straps and springs, whose limits have no derivatives."""
    if program.has_limits or program.clamp.any():
        raise InputError(
            "derivatives are not computed for bonds, straps, springs and friction of joints",
            hint="leave them out",
        )


def _tilt(margin: KnownLimits, of: str, part: str | None) -> LimitCases | None:
    """The directions of tilt with the least limit."""
    tilt = margin.tilt
    if tilt is None or not 0 <= tilt.angle < np.pi / 2 or not tilt.toward.any():
        return None
    unit = float(np.degrees(np.cos(tilt.angle) ** 2))
    search = LeastDirection(margin, tilt.shared, tilt.toward, float(np.tan(tilt.angle)), unit)
    return search.cases(of, float(np.degrees(tilt.angle)), "deg")


@dataclass(frozen=True, slots=True, eq=False)
class LeastDirection:
    """The least limit of a horizontal body force over all directions: a tilt, or an acceleration.

    Arguments: `toward` (3,): direction of the least limit; `slope`: the limit, as a share of the
    weights; `unit`: derivative of the reported number by it.
    """

    known: KnownAssembly
    shared: SharedCones
    toward: Array
    slope: float
    unit: float

    def cases(self, of: str, value: float, unit: str) -> LimitCases | None:
        """The directions with the least limit, each a case."""
        chosen = self.directions()
        turned = None
        if len(chosen) >= DIRECTIONS:
            turned = self.at_angle
            angles = np.arange(DIRECTIONS) * (2 * np.pi / DIRECTIONS)
            found = [turned(float(angle)) for angle in angles]
        else:
            found = [self.case(direction) for direction in chosen]
        cases = _least(tuple(case for case in found if case is not None), bool(turned))
        if not cases:
            return None
        copied = _has_copies(self.known.program, cases[0].solved)
        return LimitCases(of, value, unit, 1.0, cases, copied, turned)

    def at_angle(self, angle: float) -> LimitCase | None:
        """The limit at an angle across gravity [rad]."""
        u, v = across(self.shared.program.down)
        return self.case(np.cos(angle) * u + np.sin(angle) * v, turns=False)

    def directions(self) -> list[Array]:
        """Horizontal unit directions in which motions bound the limit by the least.

        The motions are those of the search for it, and of limits across from it.
        """
        program = self.shared.program
        motions = list(self.shared.mechanisms)
        aside = cross(program.down, self.toward)
        across_from = (-self.toward, aside, -aside) if not program.planar else (-self.toward,)
        for direction in across_from:
            limit = self.limit(direction)
            if isinstance(limit, Limit) and limit.motion is not None:
                motions.append(limit.motion.motion)
        chosen = [self.toward]
        for motion in motions:
            way, size = self.way(motion)
            power = float((program.load * motion).sum()) / program.g
            if size == 0 or -power / size > self.slope * (1 + SAME_LIMIT) + SAME_LIMIT:
                continue
            if all(np.linalg.norm(way - other) > APART for other in chosen):
                chosen.append(way)
        return chosen

    def way(self, motion: Array) -> tuple[Array, float]:
        """Horizontal direction in which the masses move, unit vector, and the moment of it."""
        program = self.shared.program
        moment = (program.mass * program.free) @ motion[:, :3]
        aside = moment - (moment @ program.down) * program.down
        size = float(np.linalg.norm(aside))
        return np.asarray(aside / max(size, TINY)), size

    def limit(self, direction: Array) -> Limit | NoLimit:
        """The limit of a body force along a direction."""
        wrench = gravity_wrench(self.shared.program, direction)
        return held_limit(wrench, shared=self.shared, most=STEEPEST, edges=self.known.edges)

    def case(self, direction: Array, *, turns: bool = True) -> LimitCase | None:
        """The limit toward a direction, or the least beside it; None if it is not least."""
        limit = self.limit(direction)
        if not isinstance(limit, Limit) or limit.motion is None:
            return None
        solved = body_force_limit(self.known, limit, direction, unit=self.unit)

        def sought(solved: SolvedLimit) -> Array:
            return self.way(solved.motion)[0]

        def aimed(solved: SolvedLimit, aside: Array) -> SolvedLimit:
            along = gravity_wrench(solved.program, aside)
            return replace(solved, along=along, along_mass=solved.program.g * aside)

        case = least_direction(solved, direction, sought, aimed) if turns else refined_case(solved)
        return case if case.solved.value <= self.slope * (1 + SAME_LIMIT) + SAME_LIMIT else None


def body_force_limit(
    known: KnownAssembly, limit: Limit, direction: Array, *, unit: float = 1.0
) -> SolvedLimit:
    """The solved limit of a body force along a direction, as a share of the weights."""
    solved = solved_limit(limit, gravity_wrench(limit.program, direction), unit=unit)
    along_mass = limit.program.g * direction
    return replace(solved, along_mass=along_mass, fixed=fixed_loads(known.assembly, 1.0))


def _least(cases: tuple[LimitCase, ...], even: bool) -> tuple[LimitCase, ...]:
    """The cases with the least limit to rounding, one for each direction; all at even angles.

    Of several cases with the same direction, that counts in which most rows carry force.
    """
    settled = [case for case in cases if case.refined is not None]
    if even or not settled:
        return cases
    most = min(case.solved.value for case in settled)
    most += SAME_VALUE * abs(most)
    distinct: list[LimitCase] = []
    for case in sorted(cases, key=_carrying_rows, reverse=True):
        ways = [np.abs(case.solved.along - other.solved.along).max() for other in distinct]
        same = (SAME_WAY if case.refined else APART) * float(np.abs(case.solved.along).max())
        if case.solved.value <= most and min(ways, default=np.inf) > same:
            distinct.append(case)
    return tuple(distinct)


def _carrying_rows(case: LimitCase) -> int:
    """Number of rows that carry force in a refined limit; else 0."""
    return 0 if case.refined is None else len(case.refined.contacting.rows)


def _friction(margin: KnownLimits, of: str, part: str | None) -> LimitCases | None:
    """The least friction coefficient."""
    limit = margin.friction_limit
    if limit is None or limit.motion is None or limit.value == 0.0 or not limit.attained:
        return None
    program = limit.program
    count = len(program.names)
    solved = SolvedLimit(
        program,
        limit.forces.forces,
        limit.forces.friction,
        limit.motion.motion,
        np.zeros((count, 6)),
        limit.value,
        None,
        fixed_loads(margin.assembly, 1.0),
    )
    copied = _has_copies(program, solved)
    return LimitCases(of, limit.value, "-", 1.0, (refined_case(solved),), copied)


def _load_factor(margin: KnownLimits, of: str, part: str | None) -> LimitCases | None:
    """The greatest or the least load factor."""
    greatest = of == "load factor"
    sign = 1.0 if greatest else -1.0
    limit = None if margin.load_limits is None else margin.load_limits[int(greatest)]
    if limit is None or limit.motion is None or not np.isfinite(limit.value):
        return None
    program = limit.program
    if margin.push is None:
        wrench = np.where(program.free[:, None], margin.program.applied, 0.0)
        solved = solved_limit(limit, sign * wrench)
        share = sign * limit.value
        solved = replace(solved, fixed=fixed_loads(margin.assembly, share), load_share=share)
    else:
        solved = body_force_limit(margin, limit, sign * margin.push)
    copied = _has_copies(margin.program, solved)
    return LimitCases(of, sign * limit.value, "-", sign, (refined_case(solved),), copied)


def _part_limit(margin: KnownLimits, of: str, part: str | None) -> LimitCases | None:
    """The weakest push of a part, or the largest load on it."""
    pushes = {each.part: each for each in margin.pushes}
    loads = {each.part: each for each in margin.loads}
    if part is None or part not in (pushes if of == "push" else loads):
        raise InputError(
            f"the answer has no {of} of {part!r}",
            hint=f"compute the margin with {'pushes' if of == 'push' else 'loads'}=True, and give "
            "part=NAME",
        )
    limit, amount, along = (
        (pushes[part].limit, pushes[part].force, pushes[part].along)
        if of == "push"
        else (loads[part].limit, loads[part].load, margin.program.down)
    )
    if limit.motion is None or not 0 < amount < np.inf:
        return None
    program = limit.program
    k = program.names.index(part)
    wrench = np.zeros((len(program.names), 6))
    wrench[k, :3] = along
    solved = replace(
        solved_limit(limit, wrench), value=amount, fixed=fixed_loads(margin.assembly, 1.0)
    )

    def sought(given: SolvedLimit) -> Array:
        step = given.motion[k, :3]
        return np.asarray(step / max(float(np.linalg.norm(step)), TINY))

    def aimed(given: SolvedLimit, way: Array) -> SolvedLimit:
        along = np.zeros_like(wrench)
        along[k, :3] = way
        return replace(given, along=along)

    fixed = of == "load"
    case = refined_case(solved) if fixed else least_direction(solved, along, sought, aimed)
    return LimitCases(of, amount, "N", 1.0, (case,), False)


def solved_limit(limit: Limit, along: Array, *, unit: float = 1.0) -> SolvedLimit:
    """A limit as a solved program, with a load per unit of it, shape (N, 6)."""
    assert limit.motion is not None
    none = np.zeros((len(limit.program.names), 3))
    return SolvedLimit(
        limit.program,
        limit.forces.forces,
        limit.forces.friction,
        limit.motion.motion,
        along,
        limit.value,
        None,
        none,
        unit,
    )


def fixed_loads(assembly: Assembly, factor: float) -> Array:
    """Forces of given loads at points that do not move with the parts, shape (N, 3) [N]."""
    forces = np.zeros((len(assembly.parts), 3))
    for load in assembly.loads:
        if load.point is not None:
            forces[assembly.index_of(load.part)] += factor * load.force
    return forces


def _has_copies(program: Program, solved: SolvedLimit) -> bool:
    """Whether another cluster is equal to the one that moves: then both have the limit."""
    if len(parted := clusters(program)) < 2:
        return False
    fastest = int(np.abs(solved.motion[:, :3]).max(axis=1).argmax())
    same = different_clusters(parted)
    number = next(k for k, cluster in enumerate(parted) if cluster.program.free[fastest])
    return bool((same == same[number]).sum() > 1)
