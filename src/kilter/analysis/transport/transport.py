"""`kilter.transport`: the accelerations under which an assembly stays on a moving carrier.

The carrier is the frame of the assembly: a truck, a trolley, a robot's wrist, shaking ground. Held
parts are fixed to it. Without a question the answer has the largest acceleration along each axis
and the least over all horizontal directions. A question is an acceleration, a turn, a rule
of load securing or a path.

Every limit is one of equilibrium: up to it forces that hold the assembly exist. A question is
decided by `kilter.check` on the assembly under gravity g - a, with the loads of a turn, so it has
the levels of check.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from kilter.analysis.check import check
from kilter.analysis.margins.load_limit import EXACT, Limit, NoLimit, Why
from kilter.analysis.margins.uncertainty import Ranges
from kilter.analysis.transport.carried_set import CarriedSet, LeastAcceleration, Slice
from kilter.analysis.transport.carrier import CarrierMotion, carried_assembly
from kilter.analysis.transport.carrier_path import CarrierPath
from kilter.analysis.transport.codes import code_accelerations
from kilter.analysis.transport.collapse import (
    CONFIDENCE_FACTOR,
    CollapseMultiplier,
    find_collapse,
)
from kilter.analysis.transport.path import PathLimit, find_path_limit
from kilter.analysis.transport.transport_answer import CarriedCase, DirectionLimit, Transport
from kilter.analysis.turning_tolerances import ACROSS_GRAVITY
from kilter.arrays import Array
from kilter.assembly import Assembly
from kilter.assembly.question import Question, question
from kilter.contact import ContactSet
from kilter.contact.round_edges import round_edges
from kilter.errors import InputError, TimeLimitReached
from kilter.mechanics.program import Program, build_program
from kilter.tell.levels import level_rank, require_level
from kilter.validate import number
from kilter.work import Work, stop_after

if TYPE_CHECKING:
    pass

__all__ = ["transport"]

T = TypeVar("T")
AXES = (("+x", (1, 0, 0)), ("-x", (-1, 0, 0)), ("+y", (0, 1, 0)), ("-y", (0, -1, 0)),
        ("+z", (0, 0, 1)), ("-z", (0, 0, -1)))  # fmt: skip
"""Names and directions of acceleration of an answer without a question."""


@question()
def transport(
    asked: Question,
    *,
    accelerate: ArrayLike | None = None,
    turn: CarrierMotion | None = None,
    code: str | None = None,
    forward: ArrayLike = (1.0, 0.0, 0.0),
    path: CarrierPath | None = None,
    polar: bool = True,
    collapse: bool = False,
    fc: float = CONFIDENCE_FACTOR,
    mu_range: tuple[float, float] | None = None,
) -> Transport:
    """Compute the accelerations of a carrier under which an assembly stays in place.

    Parameters
    ----------
    assembly : Assembly, or path
        Its frame is fixed in the carrier, and its held parts belong to the carrier. Loads and
        bonds are fixed in the carrier.
    accelerate : array_like, shape (3,), optional
        Is this acceleration of the carrier carried [m/s^2]?
    turn : CarrierMotion, optional
        Is this motion carried?
    code : str, optional
        Are the accelerations of this rule of load securing carried? See
        `kilter.analysis.transport.codes`.
    forward : array_like, shape (3,)
        Direction of travel, for `code`.
    path : CarrierPath, optional
        How many times as fast may the carrier follow this path?
    polar : bool
        Without a question: also the boundary of all horizontal accelerations.
    collapse : bool
        Without a question: also the collapse multipliers of horizontal forces, with participating
        mass and spectral acceleration (`kilter.analysis.transport.collapse`).
    fc : float
        Confidence factor FC of the spectral accelerations, at least 1 [-].
    mu_range : (float, float), optional
        Factors between which every friction coefficient varies. The least friction is the worst
        case of every limit, exactly; a level above "equilibrium" is decided at both ends.
    require : {"equilibrium", "settles", "proved"}
        Level from which the answer is yes. `Transport.carried` is true from this level.

    Raises
    ------
    InputError
        If several questions are given, a vector is invalid or leaves the plane of a planar
        assembly, the rule does not exist, the interval of friction is empty or negative, or the
        confidence factor is below 1.

    See Also
    --------
    kilter.margin : limits of tilt and push at rest.
    kilter.check : the verdict at rest.

    Examples
    --------
    >>> from kilter.scenes import stacks
    >>> answer = transport(stacks.block_on_slope(0.0, friction=0.4), polar=False)
    >>> round(answer.least.value, 6)
    0.4
    >>> question = transport(stacks.block_on_slope(0.0, friction=0.4), accelerate=[3.0, 0, 0])
    >>> question.carried, round(question.cases[0].factor.value, 4)
    (True, 1.308)
    """
    assembly, require, tell = asked.assembly, require_level(asked.require), asked.tell
    motions = _questions(assembly, accelerate, turn, code, forward, path)
    fc = number(fc, "confidence factor", lowest=1.0)
    if collapse and (motions or path is not None):
        raise InputError(
            "collapse multipliers are those of all horizontal directions",
            hint="ask for them without another question",
        )
    ends = [1.0] if mu_range is None else sorted(set(Ranges(mu=mu_range).mu))
    work, at_rest = asked.work(), asked.but(require="equilibrium")
    rest = check(at_rest)
    detected = rest.contacts
    frictions = [detected if end == 1.0 else detected.with_friction_share(end) for end in ends]
    if frictions[0] is not detected:
        rest = check(at_rest.but(contacts=frictions[0], progress=None))
    program = build_program(assembly, frictions[0])
    # a copy of a contact point would also copy its bond
    round_ = not (program.planar or program.has_strength or len(program.part_a) > EXACT)
    edges = round_edges(assembly, frictions[0]) if round_ else ()
    carried = CarriedSet(program, edges=edges)
    missing: dict[str, Why] = {}

    def in_time(name: str, step: Callable[[], T | NoLimit]) -> T | None:
        """Result of a step of the analysis; None, with the reason in `missing`, if it has none."""
        try:
            with stop_after(work.seconds):
                result = step()
        except TimeLimitReached:
            result = NoLimit("time")
        if isinstance(result, NoLimit):
            missing[name] = result.why
            return None
        return result

    limits: list[DirectionLimit] = []
    least: DirectionLimit | None = None
    section: Slice | None = None
    speed: PathLimit | None = None
    if not (motions or path is not None) and rest.verdict != "unstable":
        for name, direction in _axes(assembly):
            tell(f"acceleration along {name}")
            limit = in_time(name, lambda direction=direction: carried.along(direction))  # type: ignore[misc]
            if limit is not None:
                limits.append(DirectionLimit(name, direction, limit.value, limit.value, limit))
        tell("least horizontal acceleration")
        weakest = in_time("least", carried.least)
        least = None if weakest is None else _least_limit(weakest)
        if polar and not assembly.planar and weakest is not None:
            tell("all horizontal accelerations")
            axes = _horizontal(assembly)
            section = in_time("polar", lambda: carried.slice(axes))
    multipliers: list[CollapseMultiplier] = []
    if collapse:
        tell("mechanisms of collapse")
        for entry in (*limits, *([] if least is None else [least])):
            if abs(entry.direction @ assembly.down) <= ACROSS_GRAVITY and entry.direction.any():
                found = in_time(
                    f"alpha {entry.name}",
                    lambda entry=entry: _multiplier(program, entry),  # type: ignore[misc]
                )
                multipliers += [] if found is None else [found]
    if path is not None:
        tell("path")
        speed = in_time("path", lambda: find_path_limit(program, path, tell))
    cases = tuple(
        _decide(assembly, frictions, carried, name, motion, require, asked.effort, work, in_time)
        for name, motion in motions
    )
    return Transport(
        assembly=assembly,
        contacts=detected,
        rest=rest,
        program=program,
        edges=edges,
        limits=tuple(limits),
        least=least,
        polar=section,
        cases=cases,
        code=code,
        forward=None if code is None else np.array(forward, dtype=np.float64).tolist(),
        path=speed,
        collapse=tuple(multipliers),
        fc=fc if collapse else None,
        mu_range=mu_range,
        require=require,
        missing=missing,
        warnings=tuple(rest.warnings),
        seconds={**rest.seconds, "total": time.perf_counter() - asked.begun},
    )


def _questions(
    assembly: Assembly,
    accelerate: ArrayLike | None,
    turn: CarrierMotion | None,
    code: str | None,
    forward: ArrayLike,
    path: CarrierPath | None,
) -> list[tuple[str, CarrierMotion]]:
    """Names and carrier motions that the arguments ask about; empty for a path or no question."""
    given = [name for name, value in (("accelerate", accelerate), ("turn", turn), ("code", code),
                                      ("path", path)) if value is not None]  # fmt: skip
    if len(given) > 1:
        raise InputError(f"{' and '.join(given)} are given together", hint="ask one question")
    motions = []
    if isinstance(accelerate, str):
        raise InputError(
            f"accelerate is {accelerate!r:.40}",
            hint="give three numbers [m/s^2], as in accelerate=[0.5 * 9.81, 0, 0]",
        )
    if accelerate is not None:
        motions = [("acceleration", CarrierMotion(accelerate))]
    elif turn is not None:
        if not isinstance(turn, CarrierMotion):
            raise InputError(f"turn is {turn!r:.40}", hint="give a kilter.CarrierMotion")
        motions = [("motion", turn)]
    elif code is not None:
        motions = [
            (name, CarrierMotion(acceleration))
            for name, acceleration in code_accelerations(assembly, code, forward)
        ]
    for _, motion in motions:
        motion.require_in_plane(assembly.planar)
    return motions


def _decide(
    assembly: Assembly,
    frictions: list[ContactSet],
    carried: CarriedSet,
    name: str,
    motion: CarrierMotion,
    require: str,
    effort: float,
    work: Work,
    in_time: Callable[[str, Callable[[], Limit | NoLimit]], Limit | None],
) -> CarriedCase:
    """Decide if an assembly stays in place under a carrier motion, and find its largest factor.

    The verdict is the lowest of those with each friction of `frictions`, the least of which is
    first.
    """
    felt = carried_assembly(assembly, motion)
    verdicts = [
        check(
            felt,
            contacts=contacts.of(felt),
            require=require,
            effort=effort,
            time_limit=work.seconds,
        )
        for contacts in frictions
    ]
    verdict = min(verdicts, key=lambda verdict: level_rank(verdict.level))
    return CarriedCase(name, motion, verdict, in_time(name, lambda: carried.share(motion)))


def _axes(assembly: Assembly) -> Iterator[tuple[str, Array]]:
    """Names and unit directions of the coordinate axes; without y for a planar assembly."""
    for name, direction in AXES:
        if not (assembly.planar and direction[1]):
            yield name, np.array(direction, dtype=np.float64)


def _horizontal(assembly: Assembly) -> Array:
    """Two horizontal unit directions, shape (2, 3): x and y if gravity is along z."""
    down = assembly.down
    first = np.eye(3)[int(np.abs(down).argmin())] if abs(down[2]) < 1.0 else np.eye(3)[0]
    first = first - (first @ down) * down
    first = first / float(np.linalg.norm(first))
    second = np.cross(-down, first)
    return np.stack([first, second])


def _least_limit(weakest: LeastAcceleration) -> DirectionLimit:
    return DirectionLimit("least", weakest.direction, weakest.value, weakest.lower, weakest.limit)


def _multiplier(program: Program, limit: DirectionLimit) -> CollapseMultiplier:
    """Collapse multiplier of the forces that an acceleration limit of the ground causes."""
    name = limit.name.translate(str.maketrans("+-", "-+"))  # the ground moves against the forces
    return find_collapse(program, name, -limit.direction, limit.limit)
