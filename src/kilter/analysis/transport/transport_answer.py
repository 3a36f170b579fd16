"""The answer of `kilter.transport`: largest accelerations, cases, straps, and their JSON data."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from kilter.analysis.margins.load_limit import Limit, Why, finite
from kilter.analysis.open_pairs.open_question import open_pairs_answer
from kilter.analysis.transport.acceleration_rows import KnownAccelerations, inner_rows, outer_rows
from kilter.analysis.transport.carried_set import Slice
from kilter.analysis.transport.carrier import CarrierMotion
from kilter.analysis.transport.collapse import (
    CollapseMultiplier,
)
from kilter.analysis.transport.first_motion import first_motions, kind_of_motion
from kilter.analysis.transport.path import PathLimit
from kilter.analysis.transport.path_rows import path_rows
from kilter.analysis.transport.transport_proofs import ALPHA, transport_proofs
from kilter.analysis.verdict.answers import joints_answer
from kilter.analysis.verdict.verdict import Verdict
from kilter.arrays import Array
from kilter.assembly import Assembly
from kilter.contact import ContactSet
from kilter.contact.round_edges import RoundEdge, has_round_edges
from kilter.errors import InputError
from kilter.mechanics.bundle import make_bundle
from kilter.mechanics.certificate import ForceProof, MotionProof
from kilter.mechanics.program import Program
from kilter.tell.json_answer import AnswerInWords
from kilter.tell.levels import holds, level_rank
from kilter.tell.transport_facts import transport_sentence

if TYPE_CHECKING:
    from kilter.tell.answer_data.transport_data import (
        CaseData,
        DirectionLimitData,
        PolarData,
        StrapUseData,
        TransportData,
    )

__all__ = ["CarriedCase", "DirectionLimit", "Transport"]


@dataclass(frozen=True, slots=True, eq=False)
class DirectionLimit:
    """The largest carrier acceleration along a direction at which the assembly stays in place.

    Attributes
    ----------
    name : str
        "+x", ..., or "least" for the weakest horizontal direction.
    direction : ndarray, shape (3,)
        Of the acceleration of the carrier, unit, in the frame of the assembly.
    value : float
        [g]; infinite without a limit.
    lower : float
        Acceleration that is proved to be carried [g].
    limit : Limit
        Forces and mechanism there.
    """

    name: str
    direction: Array
    value: float
    lower: float
    limit: Limit

    def to_dict(self, assembly: Assembly, program: Program) -> DirectionLimitData:
        """The largest acceleration along the direction as JSON data."""
        along = CarrierMotion(program.g * self.direction)
        motion = first_motions(assembly, program, self.limit, along)
        return {
            "name": self.name,
            "direction": self.direction.tolist(),
            "acceleration": finite(self.lower * program.g),
            "upper": finite(self.value * program.g),
            "g": finite(self.value),
            "moves": [first["part"] for first in motion],
            "how": kind_of_motion(motion[0]["words"]) if motion else "",
            "least": self.name == "least",
            "motion": motion,
            "limit": self.limit.to_dict(program),
        }


@dataclass(frozen=True, slots=True, eq=False)
class CarriedCase:
    """The decision whether an assembly stays in place under a motion of the carrier.

    Attributes
    ----------
    name : str
    motion : CarrierMotion
    verdict : Verdict
        `kilter.check` of the assembly that feels this motion.
    factor : Limit or None
        Largest factor of all accelerations of the motion; None if it is not known.
    """

    name: str
    motion: CarrierMotion
    verdict: Verdict
    factor: Limit | None

    def to_dict(self, assembly: Assembly, program: Program, require: str) -> CaseData:
        """The decision on a carrier motion, at a required level, as JSON data."""
        size = float(np.linalg.norm(np.asarray(self.motion.acceleration)))
        return {
            "name": self.name,
            **self.motion.to_dict(),
            "g": size / program.g,
            "carried": carried_at((self.verdict,), require),
            "verdict": self.verdict.verdict,
            "level": self.verdict.level,
            "guarantee": self.verdict.guarantee,
            "factor": None if self.factor is None else finite(self.factor.value),
            "motion": []
            if self.factor is None
            else first_motions(assembly, program, self.factor, self.motion),
            "limit": None if self.factor is None else self.factor.to_dict(program),
        }


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Transport(AnswerInWords):
    """Answer of `kilter.transport`: accelerations under which an assembly stays in place.

    Attributes
    ----------
    assembly : Assembly
    contacts : ContactSet
    rest : Verdict
        The assembly without acceleration, at the level "equilibrium".
    program : Program
        The modelled contacts, with friction.
    edges : tuple of RoundEdge
        Round edges over which parts tip.
    limits : tuple of DirectionLimit
        Along the axes; empty if a question was asked, or if rest is not held.
    least : DirectionLimit or None
        The weakest horizontal direction.
    polar : Slice or None
        All horizontal accelerations.
    cases : tuple of CarriedCase
        The motions of the question.
    code : str or None
        Name of the rule whose accelerations are the cases.
    forward : list of float or None
        Direction of travel of the rule.
    path : PathLimit or None
        Speed factor of a path.
    collapse : tuple of CollapseMultiplier
        Multipliers of horizontal forces; empty if they were not requested.
    fc : float or None
        Confidence factor of the spectral accelerations; None if they were not requested.
    mu_range : (float, float) or None
        Factors between which every friction coefficient varies. The limits are those of the least
        friction, and the level of a motion is the lower of those at both ends.
    require : str
        The level of `carried`.
    missing : dict
        Names of limits without a value, and why: "none", "failed" or "time".
    warnings : tuple of str
    seconds : dict
    """

    answer: ClassVar[str] = "transport"

    assembly: Assembly
    contacts: ContactSet
    rest: Verdict
    program: Program
    edges: tuple[RoundEdge, ...]
    limits: tuple[DirectionLimit, ...]
    least: DirectionLimit | None
    polar: Slice | None
    cases: tuple[CarriedCase, ...]
    code: str | None
    forward: list[float] | None
    path: PathLimit | None
    collapse: tuple[CollapseMultiplier, ...]
    fc: float | None
    mu_range: tuple[float, float] | None
    require: str
    missing: dict[str, Why]
    warnings: tuple[str, ...]
    seconds: dict[str, float]

    @property
    def carried(self) -> bool | None:
        """True if the assembly stays in place under every given motion, at the required level.

        None without a question, or if open pairs or a time limit leave a motion undecided and no
        other motion falls.
        """
        if "path" in self.missing:
            return False if self.missing["path"] == "none" else None
        if self.path is not None:
            return self.path.factor >= 1.0 >= self.path.slowest
        if not self.cases:
            return None
        return carried_at([case.verdict for case in self.cases], self.require)

    @property
    def level(self) -> str | None:
        """Lowest verdict level over the given motions; without motions, the level of the limits."""
        if self.cases:
            return min((case.verdict.level for case in self.cases), key=level_rank)
        if not holds(self.rest.level, "equilibrium"):
            return None
        return "equilibrium" if self.program.mu.any() else "proved"

    def to_dict(self) -> TransportData:
        """The transport answer as JSON data, as ``kilter transport --json`` prints it."""
        program = self.program
        answer: TransportData = {
            "sentence": "",  # made below from the other data
            "carried": self.carried,
            "verdict": self.rest.verdict,
            "level": self.level,
            "require": self.require,
            "units": self.assembly.units,
            "down": self.assembly.down.tolist(),
            "gravity": program.g,
            "friction": bool(program.mu.any()),
            "mu_range": None if self.mu_range is None else list(self.mu_range),
            "joints": joints_answer(self.assembly),
            "open_pairs": open_pairs_answer(self.assembly, self.contacts),
            "exact": self.exact,
            "limits": [
                limit.to_dict(self.assembly, program)
                for limit in (*self.limits, *([] if self.least is None else [self.least]))
            ],
            "polar": None if self.polar is None else _polar_answer(self.polar),
            "alpha": [entry.to_dict(program, self.fc or 1.0) for entry in self.collapse],
            "fc": self.fc,
            "code": self.code,
            "forward": self.forward,
            "cases": [case.to_dict(self.assembly, program, self.require) for case in self.cases],
            "straps": strap_uses(self.assembly, self.program, self._verdicts()),
            "speed": None if self.path is None else self.path.to_dict(program),
            "missing": dict(self.missing),
            "warnings": list(self.warnings),
            "seconds": self.seconds,
        }
        answer["sentence"] = transport_sentence(answer)
        return answer

    @property
    def exact(self) -> bool:
        """Whether all limits are those of the solids: no open pair, and no polygon for a circle.

        The limits of a path, and those of large assemblies, count a round edge as a polygon inside.
        """
        if self.contacts.open_pairs:
            return False
        known = self.edges if self.path is None else ()
        return not has_round_edges(self.assembly, self.contacts, known)

    @property
    def mechanism(self) -> MotionProof | None:
        """The motion that starts first: beyond the least limit, along the path, or of the question.

        With collapse multipliers, the motion of the least multiplier; None without a known motion.
        """
        limits = [entry.limit for entry in self.collapse if entry.limit.mechanism is not None]
        if limits:
            return min(limits, key=lambda limit: limit.value).mechanism
        limits = [case.factor for case in self.cases if case.factor is not None]
        if self.path is not None and self.path.limit is not None:
            limits.append(self.path.limit)
        if self.least is not None:
            limits.append(self.least.limit)
        first = min(limits, key=lambda limit: limit.value, default=None)
        return None if first is None else first.mechanism

    def _verdicts(self) -> list[Verdict]:
        """Verdicts of the given motions; without a question, the verdict at rest."""
        return [case.verdict for case in self.cases] or [self.rest]

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
        if self.path is not None:
            return path_rows(self.program, self.path, inner=inner)
        if not self.limits:
            raise InputError(
                "this answer has no largest accelerations along the axes",
                hint="call kilter.transport(assembly), or give a path that is carried",
            )
        limits = [*self.limits, *([] if self.least is None else [self.least])]
        known = KnownAccelerations(
            self.program, [(limit.direction, limit.limit) for limit in limits], self.polar
        )
        return inner_rows(known) if inner else outer_rows(known)

    def proof(self, *, options: dict[str, Any] | None = None) -> dict[str, Any]:
        """Proofs on both sides of each limit and multiplier, as JSON data for `kilter.verify`.

        Raises
        ------
        InputError
            If no limit is known.
        """
        motions: list[tuple[str, CarrierMotion, Limit, float | None]] = [
            (limit.name, CarrierMotion(self.program.g * limit.direction), limit.limit, None)
            for limit in (*self.limits, *([self.least] if self.least is not None else []))
        ]
        motions += [
            (case.name, case.motion, case.factor, None)
            for case in self.cases
            if case.factor is not None
        ]
        motions += [
            (
                ALPHA + entry.name,
                CarrierMotion(-self.program.g * entry.direction),
                entry.limit,
                None if entry.limit.mechanism is None else entry.participating_mass,
            )
            for entry in self.collapse
        ]
        weaker = {} if self.mu_range is None else {"mu_share": self.mu_range[0]}
        proofs = transport_proofs(
            self.assembly, self.contacts, motions, weaker, options=options or {}
        )
        return make_bundle("transport", proofs)

    def __repr__(self) -> str:
        if self.path is not None:
            return f"Transport(path: factor {self.path.factor:.6g})"
        if self.cases:
            words = ", ".join(f"{case.name} {case.verdict.verdict}" for case in self.cases)
            return f"Transport({words})"
        least = "none" if self.least is None else f"{self.least.value:.6g} g"
        return f"Transport({self.rest.verdict} at rest, least horizontal acceleration {least})"


def _polar_answer(polar: Slice) -> PolarData:
    """The boundary of the carried horizontal accelerations as JSON data."""
    return {
        "axes": polar.axes.tolist(),
        "points": polar.points.tolist(),
        "limited": polar.limited.tolist(),
        "proved": polar.proved.tolist(),
        "normals": polar.normals.tolist(),
        "reach": polar.reach.tolist(),
        "gap": finite(polar.gap),
    }


def strap_uses(
    assembly: Assembly, program: Program, verdicts: Sequence[Verdict]
) -> list[StrapUseData]:
    """Tension or capacity of each strap, and its largest pull in the forces of the verdicts."""
    proofs = [verdict.evidence for verdict in verdicts]
    forces = [proof.forces for proof in proofs if isinstance(proof, ForceProof)]
    first, _ = program.bounded_straps
    pulls = iter(np.max([force[first] for force in forces], axis=0) if forces else [])
    uses: list[StrapUseData] = []
    for k, strap in enumerate(assembly.straps, 1):
        pull = strap.tension if strap.capacity is None else next(pulls, None)
        uses.append(
            {
                "name": strap.name or f"strap {k}",
                "tension": strap.tension,
                "capacity": strap.capacity,
                "used": None if pull is None else float(pull),
            }
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
