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
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import ArrayLike

from kilter.analysis.analysis_tolerances import ACROSS_GRAVITY
from kilter.analysis.check import check
from kilter.analysis.load_limit import EXACT, Limit, LimitSteps
from kilter.analysis.margins.uncertainty import Ranges
from kilter.analysis.transport.carried_set import CarriedSet, Slice
from kilter.analysis.transport.carrier import CarrierMotion, carried_assembly
from kilter.analysis.transport.carrier_path import CarrierPath
from kilter.analysis.transport.collapse import CONFIDENCE_FACTOR, CollapseMultiplier, find_collapse
from kilter.analysis.transport.path import PathLimit, find_path_limit
from kilter.analysis.transport.transport_answer import (
    CARRIER,
    CarriedCase,
    DirectionLimit,
    Transport,
    carried_at,
)
from kilter.analysis.verdict.verdict import Verdict
from kilter.arrays import Array, cross
from kilter.assembly import Assembly
from kilter.assembly.question import Question, question
from kilter.contact import ContactSet
from kilter.contact.round_edges import round_edges
from kilter.errors import InputError, nearest_name
from kilter.mechanics.program import build_program
from kilter.rigid import unit
from kilter.tell.levels import level_rank, require_level
from kilter.validate import number

# Accelerations that codes of load securing (such as EN 12195) require, with their sources.


@dataclass(frozen=True, slots=True)
class CodeCase:
    """An acceleration that a code of load securing requires, in multiples of g."""

    name: str
    """Direction in which the load is pressed, as the rule calls it."""
    inertia: tuple[float, float]
    """Direction in which the load is pressed [-]."""
    size: float
    """[g]"""

    def acceleration(self, forward: Array, down: Array, g: float) -> Array:
        """Acceleration of the carrier [m/s^2], shape (3,), opposite to the required inertia force.

        Arguments: `forward`, `down` (3,): unit directions of travel and of gravity, perpendicular
        to each other; `g` [m/s^2].
        """
        left = cross(forward, down)
        pressed = self.inertia[0] * forward + self.inertia[1] * left
        return -self.size * g * pressed


def _road(forward: float, backward: float, sideways: float) -> tuple[CodeCase, ...]:
    """Cases of a code for road transport: braking, starting and both sides."""
    return (
        CodeCase("forward", (1.0, 0.0), forward),
        CodeCase("backward", (-1.0, 0.0), backward),
        CodeCase("left", (0.0, 1.0), sideways),
        CodeCase("right", (0.0, -1.0), sideways),
    )


CODES: dict[str, tuple[CodeCase, ...]] = {
    "en12195": _road(0.8, 0.5, 0.5),
    "en12195:tipping": _road(0.8, 0.5, 0.6),
    "gdv": _road(0.8, 0.5, 0.5),
    "vdi2700:3.5t": _road(0.8, 0.5, 0.5),
    "vdi2700:up-to-3.5t": _road(0.8, 0.5, 0.6),
    "eumos": _road(0.5, 0.5, 0.5),
}
"""Cases of each rule. ``eumos:K`` sets the acceleration of the test to K g."""
FREE = ("eumos",)
"""Rules whose acceleration the user chooses."""


def code_cases(name: str) -> tuple[CodeCase, ...]:
    """Required accelerations of a code, by its name such as "EN 12195-1" or "eumos:0.4".

    Raises `InputError` if the rule does not exist or its acceleration is not a positive number.

    Examples
    --------
    >>> [(case.name, case.size) for case in code_cases("EN 12195-1")][:2]
    [('forward', 0.8), ('backward', 0.5)]
    >>> code_cases("eumos:0.4")[0].size
    0.4
    """
    plain = name.lower().replace(" ", "").replace("en12195-1", "en12195")
    if plain in CODES:
        return CODES[plain]
    head, colon, tail = plain.partition(":")
    if colon and head in FREE:
        try:
            size = float(tail)
        except ValueError:
            size = np.nan
        if not 0.0 < size < np.inf:
            raise InputError(
                f"the acceleration {tail!r} of {head} is not a positive number",
                hint=f"write {head}:0.5 for half of gravity",
            )
        return _road(size, size, size)
    near = nearest_name(plain, CODES)
    hint = f"did you mean {near}?" if near else f"use one of {', '.join(CODES)}"
    raise InputError(f"the rule {name!r:.60} does not exist", hint=hint)


def code_accelerations(
    assembly: Assembly, code: str, forward: ArrayLike
) -> tuple[tuple[str, Array], ...]:
    """Names and accelerations of the carrier [m/s^2] that a code requires for an assembly.

    For a planar assembly only those in its plane.

    Raises `InputError` if the rule does not exist, or the direction of travel is zero or vertical.
    """
    cases = code_cases(code)
    size = float(np.linalg.norm(assembly.gravity))
    ahead = travel_direction(forward, assembly.down)
    return tuple(
        (case.name, case.acceleration(ahead, assembly.down, size))
        for case in cases
        if not (assembly.planar and case.inertia[1] != 0.0)
    )


def travel_direction(forward: object, down: Array) -> Array:
    """The direction of travel as a horizontal unit vector, shape (3,).

    Raises `InputError` if it is zero or vertical.
    """
    vector = unit(forward, "the direction of travel")  # type: ignore[arg-type]
    level = vector - (vector @ down) * down
    if float(np.linalg.norm(level)) < 1e-6:
        raise InputError("the direction of travel is vertical", hint="give a horizontal direction")
    return unit(level)


AXES = (("+x", (1, 0, 0)), ("-x", (-1, 0, 0)), ("+y", (0, 1, 0)), ("-y", (0, -1, 0)),
        ("+z", (0, 0, 1)), ("-z", (0, 0, -1)))  # fmt: skip
"""Names and directions of acceleration of an answer without a question."""
TURNED = str.maketrans("+-", "-+")
"""Names of opposite directions."""


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
        `kilter.analysis.transport.transport`.
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
    >>> round(answer.least.g, 6)
    0.4
    >>> question = transport(stacks.block_on_slope(0.0, friction=0.4), accelerate=[3.0, 0, 0])
    >>> question.carried, round(question.cases[0].factor, 4)
    (True, 1.308)
    """
    assembly, require = asked.assembly, require_level(asked.require)
    motions = _questions(assembly, accelerate, turn, code, forward, path)
    fc = number(fc, "confidence factor", lowest=1.0)
    narrow = bool(motions) or path is not None
    if collapse and narrow:
        raise InputError(
            "collapse multipliers are those of all horizontal directions",
            hint="ask for them without another question",
        )
    steps = _steps(asked.but(require=require), mu_range)
    limits = [] if narrow else steps.limits()
    return Transport(
        assembly=assembly,
        contacts=steps.detected,
        rest=steps.rest,
        program=steps.carried.program,
        edges=steps.carried.edges,
        limits=tuple(limits),
        polar=steps.polar() if polar and limits and limits[-1].least else None,
        alpha=tuple(steps.multipliers(limits, fc) if collapse else ()),
        speed=None if path is None else steps.speed(path),
        cases=tuple(steps.case(name, motion) for name, motion in motions),
        code=code,
        forward=None if code is None else np.array(forward, dtype=np.float64),
        fc=fc if collapse else None,
        mu_range=mu_range,
        require=require,
        missing=steps.missing,
        warnings=steps.rest.notes,
        seconds={**steps.rest.seconds, "total": time.perf_counter() - asked.begun},
    )


@dataclass(slots=True, kw_only=True, eq=False)
class TransportSteps(LimitSteps):
    """Steps that compute the limits of a carrier; `frictions` has the least friction first."""

    asked: Question
    detected: ContactSet
    frictions: list[ContactSet]
    rest: Verdict
    carried: CarriedSet

    def limits(self) -> list[DirectionLimit]:
        """Known limits along the axes, then that of the weakest horizontal direction."""
        limits: list[DirectionLimit] = []
        if self.rest.verdict == "unstable":
            return limits
        for name, direction in _axes(self.asked.assembly):
            self.tell(f"acceleration along {name}")
            limit = self.limit(name, self.carried.along, direction)
            if limit is not None:
                limits.append(self._along(name, direction, limit.value, limit.value, limit))
        self.tell("least horizontal acceleration")
        least = self.limit("least", self.carried.least)
        if least is not None:
            limits.append(
                self._along("least", least.direction, least.value, least.lower, least.limit)
            )
        return limits

    def _along(
        self, name: str, direction: Array, value: float, lower: float, limit: Limit
    ) -> DirectionLimit:
        """The limit along a direction, from accelerations in g."""
        size = self.carried.program.g
        return DirectionLimit(
            name=name,
            direction=direction,
            acceleration=lower * size,
            upper=value * size,
            g=value,
            least=name == "least",
            limit=limit,
            assembly=self.asked.assembly,
        )

    def polar(self) -> Slice | None:
        """Boundary of the horizontal accelerations; None for a planar assembly."""
        if self.asked.assembly.planar:
            return None
        self.tell("all horizontal accelerations")
        return self.limit("polar", self.carried.slice, _horizontal(self.asked.assembly))

    def multipliers(
        self, limits: Iterable[DirectionLimit], fc: float
    ) -> Iterator[CollapseMultiplier]:
        """Collapse multipliers of the forces that horizontal accelerations of the ground cause."""
        self.tell("mechanisms of collapse")
        for entry in limits:
            if abs(entry.direction @ self.asked.assembly.down) > ACROSS_GRAVITY:
                continue
            if not entry.direction.any():
                continue
            name = entry.name.translate(TURNED)  # the ground moves against the forces
            find = partial(find_collapse, fc=fc)
            found = self.limit(
                f"alpha {entry.name}",
                find,
                self.carried.program,
                name,
                -entry.direction,
                entry.limit,
            )
            if found is not None:
                yield found

    def speed(self, path: CarrierPath) -> PathLimit | None:
        """Largest speed factor of a path."""
        self.tell("path")
        return self.limit("path", find_path_limit, self.carried.program, path, self.tell)

    def case(self, name: str, motion: CarrierMotion) -> CarriedCase:
        """Decide if an assembly stays in place under a carrier motion, and find its largest factor.

        The verdict is the lowest of those with each friction.
        """
        felt = carried_assembly(self.asked.assembly, motion)
        verdicts = [
            check(
                self.asked.but(
                    assembly=felt, contacts=contacts.of(felt), time_limit=self.work.seconds
                )
            )
            for contacts in self.frictions
        ]
        verdict = min(verdicts, key=lambda verdict: level_rank(verdict.level))
        limit = self.limit(name, self.carried.share, motion)
        return CarriedCase(
            name=name,
            **{vector: getattr(motion, vector) for vector in CARRIER},
            g=float(np.linalg.norm(motion.acceleration)) / self.carried.program.g,
            carried=carried_at((verdict,), self.asked.require),
            verdict=verdict.verdict,
            level=verdict.level,
            guarantee=verdict.guarantee,
            factor=None if limit is None else limit.value,
            limit=limit,
            carrier=motion,
            check=verdict,
            assembly=self.asked.assembly,
        )


def _steps(asked: Question, mu_range: tuple[float, float] | None) -> TransportSteps:
    """Decide the assembly at rest, and prepare the steps with the least friction."""
    assembly, work = asked.assembly, asked.work()
    ends = [1.0] if mu_range is None else sorted(set(Ranges(mu=mu_range).mu))
    at_rest = asked.but(require="equilibrium")
    rest = check(at_rest)
    detected = rest.contact_set
    frictions = [detected if end == 1.0 else detected.with_friction_share(end) for end in ends]
    if frictions[0] is not detected:
        rest = check(at_rest.but(contacts=frictions[0], progress=None))
    program = build_program(assembly, frictions[0])
    # a copy of a contact point would also copy its bond
    round_ = not (program.planar or program.has_strength or len(program.part_a) > EXACT)
    edges = round_edges(assembly, frictions[0]) if round_ else ()
    return TransportSteps(
        work=work,
        tell=asked.tell,
        asked=asked,
        detected=detected,
        frictions=frictions,
        rest=rest,
        carried=CarriedSet(program, edges=edges),
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
