"""The answer of `kilter.transport`: largest accelerations, cases and straps."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from kilter.analysis.analysis_tolerances import AROUND_LIMIT
from kilter.analysis.gradients.gradient import Gradient, gradient_of
from kilter.analysis.load_limit import Limit, Why
from kilter.analysis.margins.margin_answer import changed_proof
from kilter.analysis.transport.carried_gradient import carried_cases
from kilter.analysis.transport.carried_set import Slice
from kilter.analysis.transport.carrier import (
    CarrierMotion,
    FirstMotion,
    carried_assembly,
    first_motions,
    kind_of_motion,
)
from kilter.analysis.transport.collapse import CollapseMultiplier
from kilter.analysis.transport.path import PathLimit
from kilter.analysis.transport.path_rows import inner_rows, outer_rows, path_rows
from kilter.analysis.verdict.answers import OfAssembly
from kilter.analysis.verdict.verdict import Verdict
from kilter.arrays import Array
from kilter.assembly import Assembly
from kilter.contact import ContactSet
from kilter.contact.round_edges import RoundEdge, has_round_edges
from kilter.errors import InputError, some_names
from kilter.mechanics.bundle import make_bundle
from kilter.mechanics.certificate import ForceProof, MotionProof
from kilter.mechanics.program import Program
from kilter.tell.levels import holds, level_rank
from kilter.tell.record import (
    Guarantee,
    InPython,
    LevelWord,
    OrNull,
    Record,
    Seconds,
    Vector,
    Word,
    key,
)
from kilter.tell.transport_facts import transport_sentence

# Proofs of acceleration limits, as data that anyone can verify.


ALPHA = "alpha "
"""Start of the name of a collapse multiplier in a proof file."""
SAME_MECHANISM = 1e-6
"""Relative difference of participating masses up to which a motion is the same mechanism [-]."""
About = tuple[dict[str, Any], dict[str, Any]]


def transport_proofs(
    assembly: Assembly,
    contacts: ContactSet,
    motions: Iterable[tuple[str, CarrierMotion, Limit, float | None]],
    weaker: Mapping[str, float],
    *,
    options: dict[str, Any],
) -> list[About]:
    """Proofs just below and just beyond the limit of each carrier motion, as data.

    Unlimited motions have none.

    Arguments: `motions`: name, motion, the largest factor of the motion, and the participating mass
    of a collapse multiplier; `weaker`: further change of the file with which the limits were
    computed: a factor on every friction coefficient.
    """
    proofs = []
    for name, motion, limit, mass in motions:
        if not np.isfinite(limit.value):
            continue
        for held in (True, False):
            sides = _near_limit(assembly, contacts, motion, limit, held, weaker, options)
            nearest = next(sides, None)
            if nearest is None:
                continue
            about, data = nearest
            if mass is not None and not held:
                for side in (nearest, *sides):  # the nearest motion may be another mechanism
                    stated = participating_mass(
                        assembly, np.asarray(motion.acceleration), side[1]["motion"]
                    )
                    if abs(stated - mass) <= SAME_MECHANISM * mass:
                        about, data = side
                        about["participating_mass"] = stated
                        break
            given = {key: np.asarray(getattr(motion, key)).tolist() for key in CARRIER}
            proofs.append(({"about": name, **about, "motion": given}, data))
    return proofs


def _near_limit(
    assembly: Assembly,
    contacts: ContactSet,
    motion: CarrierMotion,
    limit: Limit,
    held: bool,
    weaker: Mapping[str, float],
    options: dict[str, Any],
) -> Iterator[About]:
    """Yield statements with proofs on one side of a limit, the nearest first."""
    mechanism = None if held else limit.motion
    for step in AROUND_LIMIT:
        share = limit.value + (-step if held else step) * max(abs(limit.value), 1.0)
        change = carried_change(assembly, motion, share)
        if change is not None:
            change |= weaker
            data = changed_proof(assembly, contacts, change, held, mechanism, options)
            if data is not None:
                yield {"value": share, "held": held, "change": change}, data


def participating_mass(
    assembly: Assembly, acceleration: Array, mechanism: Mapping[str, list[float]]
) -> float:
    """Participating mass M* [kg] of a motion in a proof, under the forces of an acceleration.

    It is 0 for a motion without displacement along the forces.
    """
    parts = zip(assembly, assembly.geometry.mass, strict=True)
    known = [(m, mechanism[part.name][:3]) for part, m in parts if part.name in mechanism]
    mass = np.array([m for m, _ in known])
    shift = np.array([velocity for _, velocity in known]).reshape(-1, 3) @ acceleration
    return float((mass @ shift) ** 2 / (mass @ shift**2)) if shift.any() else 0.0


CARRIER = ("acceleration", "angular_velocity", "angular_acceleration", "about")
"""Names of the vectors of a carrier motion."""


def carried_change(
    assembly: Assembly, motion: CarrierMotion, share: float
) -> dict[str, Any] | None:
    """Change of a file to the gravity and loads at a fraction of a carrier motion.

    None in free fall.
    """
    spin = np.sqrt(max(share, 0.0)) * np.asarray(motion.angular_velocity)
    part = CarrierMotion(
        share * np.asarray(motion.acceleration),
        spin,
        share * np.asarray(motion.angular_acceleration),
        motion.about,
    )
    try:
        felt = carried_assembly(assembly, part)
    except InputError:
        return None
    change: dict[str, Any] = {"gravity": felt.gravity.tolist()}
    if part.turns:
        change["loads"] = [
            {
                "part": load.part,
                "force": load.force.tolist(),
                "torque": load.torque.tolist(),
                "point": None if load.point is None else load.point.tolist(),
            }
            for load in felt.loads
        ]
    return change


class DirectionLimit(Record):
    """Largest acceleration of the carrier in a direction at which forces can hold the parts."""

    name: str
    """"+x", ..., or "least" for the weakest horizontal direction."""
    direction: Vector
    """Direction of the acceleration, unit, in the frame of the assembly."""
    acceleration: OrNull
    """Largest carried acceleration [m/s^2]; infinite without a limit."""
    upper: OrNull
    """Acceleration beyond which nothing is carried, as is proved [m/s^2]."""
    g: OrNull
    """`upper` in units of g; infinite without a limit."""
    least: bool
    """Whether it is the weakest horizontal direction."""
    limit: Limit
    """Proofs on both sides of the limit."""
    assembly: InPython[Assembly]
    """The assembly at rest on the carrier."""

    @cached_property
    @key
    def motion(self) -> list[FirstMotion]:
        """How the parts start to move, the fastest first."""
        along = CarrierMotion(self.limit.program.g * self.direction)
        return first_motions(self.assembly, self.limit, along)

    @property
    @key
    def moves(self) -> list[str]:
        """Parts that move first, the fastest first."""
        return [first.part for first in self.motion]

    @property
    @key
    def how(self) -> str:
        """Slides, tips, or other words: the first of them."""
        return kind_of_motion(self.motion[0].words) if self.motion else ""


class CarriedCase(Record):
    """Whether the parts stay in place at a motion of the carrier, and how surely."""

    name: str
    """Name of the direction or rule."""
    acceleration: Vector
    """Acceleration of the reference point [m/s^2]."""
    angular_velocity: Vector
    """Angular velocity of the carrier [rad/s]."""
    angular_acceleration: Vector
    """Angular acceleration of the carrier [rad/s^2]."""
    about: Vector
    """Point of the carrier [length unit]."""
    g: float
    """Size of the acceleration [g]."""
    carried: bool | None
    """At the required level; None: undecided."""
    verdict: Word
    """Verdict of `kilter.check`."""
    level: LevelWord | None
    """Level of the verdict."""
    guarantee: Guarantee
    """Guarantee of the verdict."""
    factor: OrNull | None
    """Largest factor of the motion [-]."""
    limit: Limit | None
    """Proofs on both sides of the factor."""
    carrier: InPython[CarrierMotion]
    """The motion."""
    check: InPython[Verdict]
    """Answer of `kilter.check` for the assembly that feels this motion."""
    assembly: InPython[Assembly]
    """The assembly at rest on the carrier."""

    @cached_property
    @key
    def motion(self) -> list[FirstMotion]:
        """How the parts start to move beyond the factor, the fastest first."""
        if self.limit is None:
            return []
        return first_motions(self.assembly, self.limit, self.carrier)


class StrapUse(Record):
    """A strap and its pull in the forces that prove that the assembly holds."""

    name: str
    """Name of the strap."""
    tension: float | None
    """[N]; None: the strap has a capacity."""
    capacity: float | None
    """[N]; None: the strap has a tension."""
    used: float | None
    """Largest pull over the cases [N]; None: not known."""


class Transport(OfAssembly):
    """Answer of `kilter.transport`: accelerations of the carrier that the assembly withstands.

    Without a question, it has the limits along the axes and of the weakest horizontal direction.
    """

    answer: ClassVar[str] = "transport"

    rest: InPython[Verdict]
    """The assembly without acceleration, at the level "equilibrium"."""
    program: InPython[Program]
    """The modelled contacts, with friction."""
    edges: InPython[tuple[RoundEdge, ...]]
    """Round edges over which parts tip."""
    limits: tuple[DirectionLimit, ...]
    """Along +x -x +y -y +z -z; then the weakest horizontal direction. Empty with a question."""
    polar: Slice | None
    """Boundary of all horizontal accelerations at which contact forces can hold the parts."""
    alpha: tuple[CollapseMultiplier, ...]
    """Collapse multipliers of horizontal forces; empty if they were not requested."""
    fc: float | None
    """Confidence factor FC of the spectral accelerations [-]."""
    mu_range: tuple[float, float] | None
    """Factors on every mu; the limits are of the least, the levels the lower of both."""
    code: str | None
    """Rule of load securing whose accelerations are the cases."""
    forward: Vector | None
    """Direction of travel of the code."""
    cases: tuple[CarriedCase, ...]
    """The motions of the question."""
    speed: PathLimit | None
    """Speed of a path."""
    require: LevelWord
    """Level of `carried`."""
    missing: dict[str, Why]
    """Limits without a value, and why."""
    warnings: tuple[str, ...]
    """Warnings about the assembly and its contacts."""
    seconds: Seconds
    """Duration of each stage [s]."""

    @property
    @key
    def sentence(self) -> str:
        """The answer in a sentence: the first line that the command prints."""
        return transport_sentence(self.data_without("sentence"))

    @property
    @key
    def carried(self) -> bool | None:
        """True if the assembly stays in place under every given motion, at the required level.

        None without a question, or if open pairs or a time limit leave a motion undecided and no
        other motion falls.
        """
        if "path" in self.missing:
            return False if self.missing["path"] == "none" else None
        if self.speed is not None:
            return self.speed.factor >= 1.0 >= self.speed.slowest
        if not self.cases:
            return None
        return carried_at([case.check for case in self.cases], self.require)

    @property
    @key
    def verdict(self) -> Word:
        """Verdict at rest."""
        return self.rest.verdict

    @property
    @key
    def level(self) -> LevelWord | None:
        """Lowest verdict level over the given motions; without motions, the level of the limits."""
        if self.cases:
            return min((case.level for case in self.cases), key=level_rank)
        if not holds(self.rest.level, "equilibrium"):
            return None
        return "equilibrium" if self.friction else "proved"

    @property
    @key
    def gravity(self) -> float:
        """Size of gravity [m/s^2]."""
        return self.program.g

    @property
    @key
    def friction(self) -> bool:
        """Whether forces of friction were counted."""
        return bool(self.program.mu.any())

    @property
    @key
    def exact(self) -> bool:
        """Whether all limits are those of the solids: no open pair, and no polygon for a circle.

        The limits of a path, and those of large assemblies, count a round edge as a polygon inside.
        """
        if self.contacts.open_pairs:
            return False
        known = self.edges if self.speed is None else ()
        return not has_round_edges(self.assembly, self.contacts, known)

    @property
    @key
    def straps(self) -> list[StrapUse]:
        """Straps, with their largest pull in the forces of the verdicts."""
        verdicts = [case.check for case in self.cases] or [self.rest]
        return strap_uses(self.assembly, self.program, verdicts)

    @property
    def least(self) -> DirectionLimit | None:
        """The limit of the weakest horizontal direction, if it is known."""
        return next((limit for limit in self.limits if limit.least), None)

    @property
    def mechanism(self) -> MotionProof | None:
        """The motion that starts first: beyond the least limit, along the path, or of the question.

        With collapse multipliers, the motion of the least multiplier; None without a known motion.
        """
        limits = [entry.limit for entry in self.alpha if entry.limit.motion is not None]
        if not limits:
            path = None if self.speed is None else self.speed.limit
            rest = None if self.least is None else self.least.limit
            limits = [case.limit for case in self.cases if case.limit is not None]
            limits += [limit for limit in (path, rest) if limit is not None]
        first = min(limits, key=lambda limit: limit.value, default=None)
        return None if first is None else first.motion

    def gradient(self, name: str = "least") -> Gradient:
        """Derivatives of the largest acceleration along a direction, in units of g.

        Parameters
        ----------
        name : str
            Name of an entry of `limits`: "+x", "-x", "+y", "-y", "+z", "-z", or "least".

        Raises
        ------
        InputError
            If there is no finite limit of this name, the answer is that of a range of friction, or
            the assembly has bonds, straps or springs.

        Examples
        --------
        >>> import kilter
        >>> box = kilter.Part("box", kilter.Box(1, 1, 2), [0, 0, 1])
        >>> table = kilter.Part("table", kilter.Box(9, 9, 1), [0, 0, -0.5], grounded=True)
        >>> assembly = kilter.Assembly([table, box], friction=0.9)
        >>> gradient = kilter.transport(assembly, polar=False).gradient("+x")
        >>> [round(float(slope), 6) for slope in gradient.center[1, 2]]  # g per metre
        [-0.5, -0.5]
        """
        if self.mu_range is not None:
            raise InputError(
                "derivatives are not computed for a range of friction", hint="leave mu_range out"
            )
        named = {each.name: each for each in self.limits}
        if name not in named:
            raise InputError(
                f"the answer has no limit {name!r}",
                hint=f"name {some_names(list(named))}" if named else "ask no other question",
            )
        of = named[name]
        direction = np.asarray(of.direction)
        cases = carried_cases(self, name, of.limit, direction, of.g, least=of.least)
        return gradient_of(self.assembly, self.contacts, cases)

    def rows(self, *, inner: bool = True) -> tuple[Array, Array]:
        """Linear constraints ``A @ y <= b`` on the motion of the carrier, for a planner of paths.

        Without a question, y is the acceleration a [m/s^2] of a straight motion. Of a path, y is
        (u, x) at each sample: the carrier runs along the path with s(t), where s is the time of the
        path, u = s'' [1/s] and x = s'^2 [-]. This is the form of constraints that TOPPRA uses.
        The constraints hold at the samples only.

        Parameters
        ----------
        inner : bool
            True: every y that obeys the constraints is carried (the hull of carried motions that
            forces prove). False: every carried y obeys them (planes that motions prove).

        Returns
        -------
        A : ndarray, shape (m, 3); of a path (n, m, 2)
            Frame of the assembly; unit rows without a question. Rows of zeros fill up the
            constraints of a sample.
        b : ndarray, shape (m,); of a path (n, m)

        Raises
        ------
        InputError
            If the answer is that of a motion or a rule, which has no such constraints, or the path
            has no velocities or is not carried.

        Examples
        --------
        >>> from kilter import transport
        >>> from kilter.scenes import stacks
        >>> answer = transport(stacks.block_on_slope(0.0, friction=0.4))
        >>> rows, bounds = answer.rows()
        >>> bool((rows @ [3.9, 0, 0] <= bounds).all()), bool((rows @ [4, 0, 0] <= bounds).all())
        (True, False)
        """
        if self.speed is not None:
            return path_rows(self.program, self.speed, inner=inner)
        if not self.limits:
            raise InputError(
                "this answer has no largest accelerations along the axes",
                hint="call kilter.transport(assembly), or give a path that is carried",
            )
        known = [(limit.direction, limit.limit) for limit in self.limits]
        rows = inner_rows if inner else outer_rows
        return rows(self.program, known, self.polar)

    def proof(self, *, options: dict[str, Any] | None = None) -> dict[str, Any]:
        """Proofs on both sides of each limit and multiplier, as JSON data for `kilter.verify`.

        Raises
        ------
        InputError
            If no limit is known.
        """
        size = self.program.g
        motions: list[tuple[str, CarrierMotion, Limit, float | None]] = [
            (entry.name, CarrierMotion(size * entry.direction), entry.limit, None)
            for entry in self.limits
        ]
        motions += [
            (case.name, case.carrier, case.limit, None)
            for case in self.cases
            if case.limit is not None
        ]
        for entry in self.alpha:
            mass = None if entry.limit.motion is None else entry.participating_mass
            motion = CarrierMotion(-size * entry.direction)
            motions.append((ALPHA + entry.name, motion, entry.limit, mass))
        weaker = {} if self.mu_range is None else {"mu_share": self.mu_range[0]}
        proofs = transport_proofs(
            self.assembly, self.contacts, motions, weaker, options=options or {}
        )
        return make_bundle("transport", proofs)

    def __repr__(self) -> str:
        if self.speed is not None:
            return f"Transport(path: factor {self.speed.factor:.6g})"
        if self.cases:
            words = ", ".join(f"{case.name} {case.verdict}" for case in self.cases)
            return f"Transport({words})"
        least = "none" if self.least is None else f"{self.least.g:.6g} g"
        return f"Transport({self.verdict} at rest, least horizontal acceleration {least})"


def strap_uses(assembly: Assembly, program: Program, verdicts: Sequence[Verdict]) -> list[StrapUse]:
    """Tension or capacity of each strap, and its largest pull in the forces of the verdicts."""
    proofs = [verdict.evidence for verdict in verdicts]
    forces = [proof.forces for proof in proofs if isinstance(proof, ForceProof)]
    first, _ = program.bounded_straps
    pulls = iter(np.max([force[first] for force in forces], axis=0) if forces else [])
    uses = []
    for k, strap in enumerate(assembly.straps, 1):
        pull = strap.tension if strap.capacity is None else next(pulls, None)
        uses.append(
            StrapUse(
                name=strap.name or f"strap {k}",
                tension=strap.tension,
                capacity=strap.capacity,
                used=None if pull is None else float(pull),
            )
        )
    return uses


def carried_at(verdicts: Sequence[Verdict], require: str) -> bool | None:
    """Whether all verdicts reach the required level; None if one is undecided and none falls."""
    words = {verdict.verdict for verdict in verdicts}
    if "unstable" in words:
        return False
    if "undecided" in words:
        return None
    return all(holds(verdict.level, require) for verdict in verdicts)
