"""Verdict: the answer of `kilter.check`, with its evidence and derived quantities.

Motion, displacements, forces and neutral motions need further programs. They are computed at the
first access and kept.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from functools import cached_property
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np

from kilter.analysis.analysis_tolerances import MOVES
from kilter.analysis.decision.cascade import Decision, Word
from kilter.analysis.decision.judge import Judgement
from kilter.analysis.decision.motion import (
    NO_MOTION,
    NO_MOTION_BY_LAW,
    NO_MOTION_OF_LIMITS,
    UNKNOWN_MOTION,
    ImpendingMotion,
    falls_freely,
    find_motion,
    find_motion_with_friction,
    motion_of,
    round_mantle,
    still,
    unknown,
    without_opening,
)
from kilter.analysis.decision.open_question import AnsweredPair, OpenQuestion, answered_pairs
from kilter.analysis.force_ranges import ForceRange, force_ranges, pressed_pairs
from kilter.analysis.support_movement import Outcome, SupportMovement, support_movement
from kilter.analysis.verdict.contact_forces import ContactForces, find_contact_forces
from kilter.analysis.verdict.displacement import LIMIT as DISPLACEMENT_LIMIT
from kilter.analysis.verdict.displacement import Displacement, find_displacement
from kilter.analysis.verdict.neutral import Neutral, find_neutral, find_slipping_motion
from kilter.analysis.verdict.part_answer import PartAnswer
from kilter.analysis.verdict.verdict_answer import (
    BondsNeeded,
    ContactCounts,
    Density,
    ProofErrors,
    Tries,
    VerdictTolerance,
    density_of,
)
from kilter.arrays import Array, Mask, sealed
from kilter.assembly import Assembly, ListedBond, ListedJoint
from kilter.assembly.assumption import DRAWN, JOINED, Body, LadderRow, RungWord
from kilter.assembly.supported_answer import SupportedAnswer
from kilter.contact import ContactSet
from kilter.contact.common.distances import LonePart
from kilter.contact.common.patches import UnsupportedContact
from kilter.errors import InputError
from kilter.hooks import hook
from kilter.mechanics.certificate import ForceProof, MotionProof, part_sizes
from kilter.mechanics.mechanics_tolerances import STILL, TOLERANCE
from kilter.mechanics.program import Program, build_program
from kilter.mechanics.rows import POSSIBLE
from kilter.rigid import unit
from kilter.tell.body_words import joined_words
from kilter.tell.html import InCells
from kilter.tell.ladder_words import ladder_sentence, rung_sentence
from kilter.tell.levels import REQUIRE, VerdictWord, holds, level_of
from kilter.tell.record import InPython, LevelWord, OrAbsent, UnitWord, Vector, key
from kilter.tell.words import (
    GAINS,
    NAMED,
    fall_words,
    motion_summary,
    motion_words,
    upward_words,
)
from kilter.threads import on_one_thread
from kilter.units import metres_per_unit
from kilter.validate import finite
from kilter.work import EFFORT

if TYPE_CHECKING:
    from kilter.contact.fits.suggestions import Suggestion
    from kilter.friction.answer import FrictionAnswer, Why
    from kilter.second_order.answer.second_order_answer import SecondOrder, SecondOrderSummary

__all__ = ["Verdict", "Word"]

BONDED_PARTS = 300
"""Largest number of free parts for which a check computes the least share of bond strength;
`margin` has no such limit."""

BARELY = 1e-3
"""Kappa below which a warning mentions the accuracy of the coordinates [-]."""
ROUNDING = 1e-15
"""Accelerations up to this count as zero [g]."""


class Verdict(InCells, SupportedAnswer):
    """Answer of `kilter.check`: the verdict on an assembly, with its proof and its motion."""

    answer: ClassVar[str] = "check"

    verdict: VerdictWord
    """The verdict; it is equal to its text."""
    assume: RungWord = DRAWN
    """The rung of the ladder of assumptions to which verdict, level and proof belong."""
    require: LevelWord = REQUIRE
    """The required level (`kilter.tell.levels`)."""
    time_limit: float | None = None
    """The time limit [s], if it cut the answer short; else null."""
    seconds: Mapping[str, float]
    """Duration of each stage [s]; read-only."""
    suggested_joints: OrAbsent[tuple[Suggestion, ...]] = None
    """Pairs that look fastened; of the option --suggest-joints."""
    ranges: OrAbsent[tuple[ForceRange, ...]] = None
    """Least and greatest forces; of the options --forces and --between."""
    movement: OrAbsent[SupportMovement] = None
    """How the parts follow moving supports; of the options --move and --turn-support."""
    own_sentence: InPython[str]
    """The verdict in words, without the assumptions and the ladder."""
    drawn: InPython[Assembly | None] = None
    """The assembly in its drawn pose, without the joints of the rung; None for an inner verdict."""
    drawn_contacts: InPython[ContactSet | None] = None
    """Contacts of the drawn pose."""
    moved: InPython[float] = 0.0
    """Longest way of a part from its drawn pose [length unit]."""
    joined_pairs: InPython[int] = 0
    """Number of joints that the rung added."""
    rest_gap: InPython[float | None] = None
    """Gap up to which points count as closed, if the proof rests on closed points alone [length
    unit]; else None."""
    assembly: InPython[Assembly]
    """The assembly that was checked."""
    contact_set: InPython[ContactSet]
    """The contacts of the assembly."""
    program: InPython[Program]
    """The program against which the proof is verified."""
    judgement: InPython[Judgement]
    """The verified forces and motion."""
    friction_answer: InPython[FrictionAnswer | None]
    """The guarantee of friction; None if the verdict does not rest on friction."""
    notes: InPython[tuple[str, ...]]
    """Warnings that do not depend on the motion."""
    effort: InPython[float] = EFFORT
    """Effort of the search for motions with friction."""
    question: InPython[OpenQuestion | None] = None
    """The open pairs that decide, if the verdict is undecided because of them."""
    measures: InPython[bool] = False
    """Whether z, kappa and the displacements are reported although friction plays a part."""
    second_order_answer: InPython[SecondOrder | None] = None
    """Answer of second order: whether a neutral assembly is at a minimum of its energy. None if no
    cluster of touching parts rests without friction."""
    decision: InPython[Decision | None] = None
    """The decision from which this verdict was made."""
    seconds_left: InPython[float | None] = None
    """Remainder of the time limit after the verdict [s]; None without a time limit."""
    brief: InPython[bool] = False
    """Whether z, kappa, displacements, neutral motions and shares of friction are left out in any
    case: a first answer, since their programs take ten times longer than equilibrium."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "seconds", MappingProxyType(dict(self.seconds)))
        object.__setattr__(self, "verdict", VerdictWord(self.verdict))
        sealed((self.program, self.judgement, self.friction_answer, self.second_order_answer))

    def __getitem__(self, part: str | int) -> PartAnswer:
        k = self.assembly.index_of(part)
        one, motion = self.assembly.parts[k], self.motion
        shift = self.displacement.displacement if self.measured else None
        slow = not motion.moves.any() and motion.relative[k].max() > ROUNDING
        landing = self._landings.get(k)
        return PartAnswer(
            name=one.name,
            grounded=one.grounded,
            mass=float(self.program.mass[k]),
            material=one.material,
            layer=one.layer,
            displacement=None if shift is None else shift[k],
            acceleration=motion.acceleration[k] if motion.known else None,
            relative=motion.relative[k] if motion.known else None,
            moves=bool(motion.moves[k]),
            moved_by_proof=bool(self.moved_by_proof[k]),
            motion=self.words(k),
            below=None if landing is None else self.program.names[landing[0]],
            fall=None if landing is None else landing[1],
            # reported only if no part is above the threshold of `moves`
            slow_motion=self.words(k, slow=True) if slow and not one.grounded else None,
        )

    @property
    @key
    def sentence(self) -> str:
        """The verdict in words, with its assumptions; of a ladder, the lowest rung that holds."""
        rows = [row.to_dict() for row in self.ladder]
        joined = self._joined_words if rows and self.assume == DRAWN else ("", "")
        words = ladder_sentence(rows, self.verdict, assume=self.assume, joined=joined)
        return words or rung_sentence(
            self.own_sentence, assume=self.assume, moved=self.moved, joined=self.joined_pairs,
            units=self.assembly.units, holds=self.level is not None,
        )  # fmt: skip

    @property
    def _joined_words(self) -> tuple[str, str]:
        """Words about the joined bodies that stand, and about the loose bodies."""
        row = next((row for row in self.ladder if row.assume == JOINED), None)
        holds = row.level is not None if row is not None and row.decided else None
        bodies = [body.to_dict() for body in self.bodies]
        return joined_words(bodies, self.assembly.units, holds=holds)

    @cached_property
    @key
    @on_one_thread
    def ladder(self) -> tuple[LadderRow, ...]:
        """The verdict on each rung, for CAD and meshes whose drawn pose does not hold.

        It is computed at the first access, within the work limit and the time limit of the verdict.
        """
        rows: tuple[LadderRow, ...] = () if self.drawn is None else hook("ladder")(self)
        return rows

    @cached_property
    @on_one_thread
    def better_up(self) -> str | None:
        """Upward axis with which it holds although it holds on no rung with z up; else None."""
        if self.drawn is None or not self.drawn.up_assumed or self.time_limit is not None:
            return None
        if self.level is not None or any(row.level is not None for row in self.ladder):
            return None
        axis: str | None = hook("better_up")(self.drawn, self.drawn_contacts)
        return axis

    @cached_property
    @key
    def bodies(self) -> tuple[Body, ...]:
        """Bodies of the parts that touch or overlap, with a ladder or on the rung joined."""
        if self.drawn is None or not (self.ladder or self.assume == JOINED):
            return ()
        found: tuple[Body, ...] = hook("bodies_of")(self.drawn, self.drawn_contacts)
        if self.assume == JOINED:
            stands = self.level is not None
        else:
            stands = any(r.assume == JOINED and r.level is not None for r in self.ladder)
        # as drawn it may touch the floor at fewer points than at rest
        return tuple(
            dataclasses.replace(body, tilt_deg=None, tilt_down=None, rest_deg=None, rests_on=())
            if stands and body.tilt_deg == 0.0
            else body
            for body in found
        )

    @property
    @key
    def parts(self) -> tuple[PartAnswer, ...]:
        """The answers about every part, in the order of the assembly; ``verdict[name]`` is one."""
        return tuple(self[k] for k in range(len(self.assembly)))

    @property
    @key
    def stable(self) -> bool:
        """Whether the assembly holds at the required verdict level."""
        return holds(self.level, self.require)

    @property
    @key
    def level(self) -> LevelWord | None:
        """Verdict level that the assembly reaches; None if it does not hold.

        "strict" only if it is required.
        """
        # the proof of the level strict is computed only on demand, and only without friction
        examine = self.require == "strict" and self.friction_answer is None
        return level_of(self.verdict, strict=examine and self.verdict == "stable" and self._strict)

    @property
    def _strict(self) -> bool:
        """Whether the level is strict: it is proved that no small push makes the assembly fall."""
        second = self.second_order_answer
        if second is None:
            return self._none_neutral
        return second.strict or self._none_neutral

    @property
    def _none_neutral(self) -> bool:
        """Whether it is known that no motion leaves the energy unchanged to first order."""
        neutral = self.neutral
        return neutral is not None and neutral.two_sided == neutral.one_sided == 0

    @property
    @key
    def second_order(self) -> SecondOrderSummary | None:
        """Answer of second order (curvature); null if not examined or not applicable."""
        if self.second_order_answer is None or self._none_neutral:
            return None
        return self.second_order_answer.summary(self.program.names)

    @property
    @key
    def first_order(self) -> VerdictWord:
        """The verdict without regard to small pushes, as in the paper: "stable" if balanced."""
        if self.verdict != "balanced" and self.why != "push-open":
            return self.verdict
        settles = self.friction_answer is not None and self.friction_answer.guarantee != "proved"
        return VerdictWord.SETTLES if settles else VerdictWord.STABLE

    @property
    @key
    def why(self) -> Why | Literal["balanced", "push-open"] | None:
        """Reason for the verdict potentially-stable or balanced; None for other verdicts.

        The values are "refuted", "jams", "squeeze", "not-found", "not-asked", "push-open" and
        "balanced".
        """
        if self.verdict == "balanced":
            return "balanced"
        if self.verdict != "potentially-stable":
            return None
        if self.friction_answer is None or self.friction_answer.why is None:
            return "push-open"
        return self.friction_answer.why

    @property
    @key
    def guarantee(self) -> Literal["proved", "refuted", "open"]:
        """Whether the contact law excludes every motion from rest: proved, refuted or open."""
        if self.verdict == "potentially-stable":
            return "proved" if self.friction_answer is None else self.friction_answer.guarantee
        known: dict[str, Literal["proved", "refuted", "open"]] = {
            "stable": "proved",
            "balanced": "proved",
            "unstable": "refuted",
        }
        return known.get(self.verdict, "open")

    @property
    @key
    def seated(self) -> str | None:
        """Result of the search for a state of rest: yes, runs-away or not-found; else None.

        None if it was not examined.
        """
        answer = self.friction_answer
        return answer.seating.seated if answer is not None and answer.examined else None

    @property
    @key
    def tries(self) -> Tries | None:
        """Numbers of passed and of all numerical tries of settling; null if not examined."""
        if self.friction_answer is None or not self.friction_answer.examined:
            return None
        settling = self.friction_answer.settling
        return Tries(passed=len(self.friction_answer.tries), of=len(settling.ends))

    @property
    def evidence(self) -> ForceProof | MotionProof | None:
        """The proof of the verdict: forces, or a motion if unstable; None if undecided."""
        if self.level is not None:
            return self.judgement.forces
        return self.judgement.motion if self.verdict == "unstable" else None

    @property
    @key
    def certificate(self) -> ProofErrors:
        """Kind of the proof, and the numerical errors of the best forces and the best motion."""
        forces, motion, proof = self.judgement.forces, self.judgement.motion, self.evidence
        kind: Literal["forces", "motion"] = "forces" if isinstance(proof, ForceProof) else "motion"
        return ProofErrors(
            kind=None if proof is None else kind,
            residual=None if forces is None else forces.residual,
            power=None if motion is None else motion.power,
            violation=None if motion is None else motion.violation,
        )

    @property
    @key
    def friction(self) -> FrictionAnswer | None:
        """Guarantee of friction, with the evidence; null if it was not examined."""
        answer = self.friction_answer
        if answer is None or not answer.examined:
            return None
        return dataclasses.replace(answer, effort=self.effort)

    @property
    @key
    def down(self) -> Vector:
        """Direction of gravity."""
        return self.assembly.down

    @property
    @key
    def gravity(self) -> Vector:
        """Gravity [m/s^2]."""
        gravity: Array = self.assembly.gravity
        return gravity

    @property
    @key
    def units(self) -> UnitWord:
        """Length unit."""
        return self.assembly.units

    @property
    @key
    def size(self) -> Vector:
        """Extents of the free parts along the axes, of all parts if none is free [length unit]."""
        return self.assembly.size

    @property
    @key
    def density(self) -> Density:
        """Densities from which masses of free parts are computed."""
        return density_of(self.assembly)

    @property
    @key
    def z(self) -> float | None:
        """Value of the displacement program [kg x length unit]; null if it was not solved."""
        return self.displacement.z if self.measured else None

    @property
    @key
    def contacts(self) -> ContactCounts:
        """Numbers of touching pairs, contact patches and contact points."""
        found = self.contact_set
        return ContactCounts(pairs=found.pairs, patches=len(found), points=len(found.points))

    @property
    @key
    def unsupported(self) -> tuple[UnsupportedContact, ...]:
        """Contacts of kinds that are not modelled."""
        return self.contact_set.unsupported

    @property
    @key
    def open_pairs(self) -> tuple[AnsweredPair, ...]:
        """Pairs whose contact the geometry does not determine, the deciding pairs first."""
        return answered_pairs(self.assembly, self.contact_set, self.question)

    @property
    @key
    def counted_gap(self) -> float | None:
        """Widest gap among contacts that the default tolerance would reject [length unit]."""
        return self.contact_set.counted_gap

    @property
    @key
    def if_joined(self) -> OpenQuestion | None:
        """Open pairs that decide, and the verdict with these pairs joined."""
        return self.question

    @property
    @key
    def nearest(self) -> tuple[LonePart, ...]:
        """Parts that touch nothing, each with its nearest part."""
        return self.contact_set.of(self.assembly).nearest

    @property
    @key
    def joints(self) -> tuple[ListedJoint, ...]:
        """Joints, including those added by fastening."""
        return self.assembly.joints_data()

    @property
    @key
    def bonds(self) -> tuple[ListedBond, ...]:
        """Bonds and their strength."""
        return tuple(bond.entry for bond in self.assembly.bonds)

    @cached_property
    def modelled(self) -> Program:
        """The program of the certain contacts, without rows for contacts that are only possible."""
        if not self.program.kind.size or not (self.program.kind == POSSIBLE).any():
            return self.program
        return sealed(build_program(self.assembly, self.contact_set))

    @cached_property
    @on_one_thread
    def displacement(self) -> Displacement:
        """Optimum z of the displacement program, without friction, and its displacements."""
        if self._smooth:
            count = len(self.program.names)
            large = int(self.program.free.sum()) > DISPLACEMENT_LIMIT
            return sealed(Displacement(0.0, None if large else np.zeros((count, 6))))
        return sealed(find_displacement(self.modelled))

    @cached_property
    def motion(self) -> ImpendingMotion:
        """Accelerations with which all parts start to move; zero if the assembly is stable.

        Without friction, they follow from Gauss's principle. With friction, they obey Coulomb's
        law; if no such motion is found, they are not `known`, and `gains` is the motion of the
        proof. For the verdict potentially-stable, they are the motion that refutes the guarantee.
        """
        motion = self._motion()
        return sealed(motion if motion.known else unknown(self.program, self.evidence))

    @on_one_thread
    def _motion(self) -> ImpendingMotion:
        """The impending motion, by the method for this verdict and these contacts."""
        if self.verdict in ("stable", "settles", "balanced") or self.why == "push-open":
            return still(self.program)
        if self._not_modelled:
            return unknown(self.program)
        if self.modelled.cohesion.any():
            return find_slipping_motion(self.modelled)
        if not self._rubs:
            return find_motion(self.modelled)
        if self.friction_answer is not None:
            witness = self.friction_answer.witness
            return still(self.program) if witness is None else motion_of(
                self.program, witness.acceleration, witness.law.residual
            )  # fmt: skip
        # an unstable answer needs its motion, however little work its guarantee may take
        motion = find_motion_with_friction(self.modelled, max(self.effort, EFFORT))
        return unknown(self.program) if motion is None else motion

    @property
    def _not_modelled(self) -> bool:
        """Whether no method finds the motion: straps or joints give way, or bonds slip."""
        return bool(len(self.modelled.bounded) or (self.modelled.cohesion.any() and self._rubs))

    @property
    def _rubs(self) -> bool:
        """Whether any contact of the certain ones has friction."""
        return bool(self.modelled.mu.any())

    @cached_property
    def measured(self) -> bool:
        """Whether z, kappa and displacements are reported: without friction, or on request."""
        rubs = self.friction_answer is not None or bool(len(self.program.gripping))
        # the displacement program does not model the limit of a strap
        return (self.measures or not rubs) and not (self.brief or len(self.modelled.bounded))

    @property
    @key
    def instability(self) -> float | None:
        """Size kappa of the impending motion [-], 0 to 1; null with loads or without a motion.

        Like z and the displacements it ignores friction, and is null where these are not reported.
        """
        return self.kappa if self.measured else None

    @cached_property
    @on_one_thread
    def kappa(self) -> float | None:
        """The same as `instability`, also where z and the displacements are not reported."""
        if self.assembly.loads or self.assembly.straps:
            return None
        smooth = self.motion if self._smooth or not self._grips else find_motion(self.modelled)
        return smooth.instability if smooth.known else None

    @property
    def _smooth(self) -> bool:
        """Whether forces without friction hold the assembly."""
        return self.level is not None and self.friction_answer is None

    @property
    def _grips(self) -> bool:
        """Whether any of the certain contacts has friction or a bond with a limited shear."""
        return bool(len(self.modelled.gripping))

    @cached_property
    @key
    def forces(self) -> ContactForces | None:
        """Contact forces that balance every part; null if the proof has no forces."""
        proof = self.evidence
        if not isinstance(proof, ForceProof):
            return None
        shares = not self.brief
        return sealed(find_contact_forces(self.program, proof, self.contact_set, shares=shares))

    @on_one_thread
    def force_ranges(
        self,
        between: Sequence[str | Sequence[str]] | None = None,
        along: Any = None,
        moment: Any = None,
    ) -> tuple[ForceRange, ...]:
        """Least and greatest contact forces over all equilibria, each end with its evidence.

        Parameters
        ----------
        between : sequence, optional
            Pairs of names of parts that touch, or names of held parts for the whole force on them;
            all pairs that touch by default.
        along : array_like, shape (3,), optional
            Axis of the force, world frame: the range is that of the force on the second part along
            it. By default the normal forces of a pair are added.
        moment : array_like, shape (3,), optional
            Axis of a moment, world frame: the range is that of the moment [N m] on the last named
            part about its centre of mass.

        Returns
        -------
        tuple of ForceRange
            Empty if no contact forces balance the assembly.

        Raises
        ------
        InputError
            If a name is unknown, two parts have no contact, contacts are bonded, or two axes are
            given.
        """
        if along is not None and moment is not None:
            raise InputError(
                "along and moment are both given", hint="ask for one of them at a time"
            )
        if self.level is None:
            return ()
        axis = None if along is None else unit(along)
        about = None if moment is None else unit(moment)
        program = build_program(self.assembly, self.contact_set)  # `program` may lack friction
        pairs = pressed_pairs(program)
        if between is not None:
            named = [(one,) if isinstance(one, str) else tuple(one) for one in between]
            pairs = [tuple(self.assembly.index_of(name) for name in names) for names in named]
        return sealed(tuple(force_ranges(program, pairs, axis, about)))

    @on_one_thread
    def range_proofs(
        self, ranges: Sequence[ForceRange], *, options: dict[str, Any] | None = None
    ) -> dict[str, Any]:
        """Proofs of ranges of forces as JSON data, which `kilter.verify` recomputes.

        Each end has forces that attain it and a motion of the parts that bounds it. Ends without a
        limit are left out.

        Parameters
        ----------
        ranges : sequence of ForceRange
            Ranges that `force_ranges` returned.
        options : dict, optional
            Options with which the assembly was read, so that `verify` reads it alike.

        Raises
        ------
        InputError
            If no range has a limit, or the pose is one that came to rest.
        """
        # imported late: only a written proof needs this module
        from kilter.analysis.range_proofs import make_range_proofs

        if self.rest_gap is not None:
            raise InputError(
                "ranges of forces in a pose at rest have no proof file",
                hint="ask about the drawn pose: --assume drawn",
            )
        return make_range_proofs(self.assembly, self.contact_set, ranges, options or {})

    @on_one_thread
    def support_movement(
        self,
        moved: Mapping[str, Any] = MappingProxyType({}),
        turned: Mapping[str, Any] = MappingProxyType({}),
    ) -> SupportMovement:
        """How the parts follow small movements of held parts, to first order.

        Parameters
        ----------
        moved : mapping of str to array_like, shape (3,), optional
            Movement of each held part that moves [length unit], world frame.
        turned : mapping of str to array_like, shape (4,), optional
            Axis, world frame, and angle [deg] by which a held part turns about its centre of mass.

        Returns
        -------
        SupportMovement
            Movements of the parts, contacts that open, and the work of the contact forces on the
            supports. The outcome is "falls" if the assembly is unstable.

        Raises
        ------
        InputError
            If a part is unknown or not held, a movement is larger than a tenth of the size of the
            parts on it, or contacts are bonded.
        """
        twist = np.zeros((len(self.assembly.parts), 6))
        for name, vector in moved.items():
            twist[self._held(name), :3] = finite(vector, (3,), name)
        for name, turn in turned.items():
            *axis, angle = finite(turn, (4,), name)
            twist[self._held(name), 3:] = np.radians(angle) * unit(axis)
        program = build_program(self.assembly, self.contact_set)  # `program` may lack friction
        known: Outcome = "falls" if self.verdict == "unstable" else "unknown"
        return sealed(
            support_movement(program, twist, known=None if self.level is not None else known)
        )

    def _held(self, name: str) -> int:
        """Index of a part that has to be held."""
        k = self.assembly.index_of(name)
        if not self.assembly.parts[k].grounded:
            held = [part.name for part in self.assembly.parts if part.grounded]
            raise InputError(
                f"{name!r} is not held", hint=f"move a held part: {', '.join(held[:5])}"
            )
        return k

    @cached_property
    @key
    def neutral(self) -> Neutral | None:
        """Numbers of neutral motions, which cost no energy; null if they were not counted."""
        return None if self.brief else find_neutral(self.modelled)

    @property
    @key
    def tolerance(self) -> VerdictTolerance:
        """Tolerances of contact detection and of the verdict."""
        return VerdictTolerance(
            **vars(self.contact_set.tolerance),
            verdict=float(self.program.tolerance.max(initial=TOLERANCE)),
            moves=MOVES,
        )

    @property
    def barely(self) -> str:
        """Warning if rounding of the coordinates may have caused the instability; else empty."""
        kappa = self.motion.instability  # with friction, unlike `instability`
        loaded = bool(self.assembly.loads or self.assembly.straps)
        if self.verdict != "unstable" or loaded or not kappa < BARELY:
            return ""
        return (
            f"barely unstable (kappa {kappa:.1e}): rounding of the coordinates by about "
            f"{kappa:.0e} of the size of a part has the same effect; if they are rounded, state "
            "the accuracy of the mesh"
        )

    @property
    def moved_by_proof(self) -> Mask:
        """Mask of the parts that the motion of the proof moves, shape (N,).

        The proof counts every force that open pairs could transmit. `motion` counts the certain
        contacts only.
        """
        proof = self.evidence
        if not isinstance(proof, MotionProof):
            return np.zeros(len(self.program.names), dtype=bool)
        sizes = part_sizes(self.program, proof.motion, per_radius=False)
        return np.asarray(sizes > STILL * sizes.max(initial=0.0))

    @property
    def moving(self) -> list[str]:
        """Names of the parts that start to move."""
        return [n for n, m in zip(self.program.names, self.motion.moves, strict=True) if m]

    def words(self, part: int | str, *, slow: bool = False) -> str:
        """Describe how a part starts to move, as a phrase for users.

        Parameters
        ----------
        part : str or int
            Name of the part, or its index in the assembly.
        slow : bool
            Whether to describe also accelerations below the threshold of `moves`.

        Raises
        ------
        InputError
            If the assembly has no such part.
        """
        k = self.assembly.index_of(part)
        if self.assembly.parts[k].grounded:
            return "is held"
        words, motion = self._motion_words(k, slow), self.motion
        return words if motion.known or not motion.moves[k] else f"{words}{self._gains}"

    @cached_property
    def _landings(self) -> Mapping[int, tuple[int, float]]:
        """For each part that falls freely onto another part: that part, and the way to it."""
        falling = falls_freely(self.motion, self.assembly.gravity) & self.motion.moves
        if not falling.any():
            return {}
        found: Mapping[int, tuple[int, float]] = hook("landings")(
            self.assembly, self.contact_set, falling
        )
        return found

    @property
    def _gains(self) -> str:
        """Suffix of words for the motion of a proof; empty if the words are about none."""
        motion = self.motion
        return "" if motion.known or motion.gains is None else f", {GAINS}"

    def _motion_words(self, k: int, slow: bool = False) -> str:
        """Describe the motion of part `k`: its accelerations, or else the motion of the proof."""
        motion, metres = self.motion, metres_per_unit(self.program.units)
        landing = self._landings.get(k)
        if landing is not None:
            below, way = landing
            onto = fall_words(way, self.program.units, lands=not motion.moves[below])
            return f"{onto} {self.program.names[below]}"
        if motion.known:
            twist, relative = motion.acceleration[k], motion.relative[k] * (slow or motion.moves[k])
        elif motion.gains is None or not motion.moves[k]:
            return UNKNOWN_MOTION[bool(motion.moves[k])]
        else:
            gains = without_opening(self.program, motion.gains, k)
            twist = gains * np.repeat([metres, 1.0], 3)
            sizes = np.linalg.norm(gains.reshape(2, 3), axis=1)
            relative = sizes * [1.0, self.program.radius[k]]
        return motion_words(
            twist,
            relative,
            self.assembly.down,
            center=self.program.center[k],
            unit=metres,
            sizes=motion.known,
            mantle=round_mantle(self.assembly.parts[k]),
        )

    @property
    @key
    def summary(self) -> str:
        """Describe the fastest parts and how they start to move, in a sentence."""
        motion = self.motion
        which = np.flatnonzero(motion.moves)
        if not (motion.known or len(which)):
            return "the moving parts are not known"
        speed = motion.relative[which].max(axis=1)
        if motion.gains is not None:
            speed = part_sizes(self.program, motion.gains, per_radius=False)[which]
        # parts that the proof moves come first, then faster parts
        order = which[np.lexsort([-speed, ~self.moved_by_proof[which]])]
        names = self.program.names
        fastest = [f"{names[k]} {self._motion_words(int(k))}" for k in order[:NAMED]]
        return motion_summary(fastest, len(which)) + self._gains

    def proof(self, *, options: dict[str, Any] | None = None) -> dict[str, Any]:
        """The proof of the verdict as JSON data, which `kilter.verify` accepts.

        Parameters
        ----------
        options : dict, optional
            Options with which the assembly was read, so that `verify` reads it alike.
        """
        from kilter.mechanics.proof import digest_of, make_proof

        # imported late: only a written proof needs these modules
        from kilter.second_order.answer.second_order_file import second_order_data

        proof = make_proof(
            self.assembly,
            self.contact_set,
            self.program,
            self.evidence,
            options or {},
            evidence=None if self.friction_answer is None else self.friction_answer.evidence,
        )
        if self.second_order_answer is not None:
            proof["verdict"] = self.verdict
            proof["second_order"] = second_order_data(self.second_order_answer)
        if self.rest_gap is not None:
            proof["rest"] = {"gap": self.rest_gap}
        proof["digest"] = digest_of(proof)
        return proof

    @cached_property
    @key
    @on_one_thread
    def bonds_needed(self) -> BondsNeeded | None:
        """Least fraction of bond strength that suffices, and the pairs that fail first; else null.

        Null without bonds, without a level, or for more than `BONDED_PARTS` free parts. The contact
        forces of the answer are one equilibrium of many, so they may load bonds more.
        """
        large = int(self.program.free.sum()) > BONDED_PARTS
        if not self.assembly.bonds or self.level is None or large:
            return None
        # imported late: only bonds need these modules
        from kilter.analysis.decision.bond_factor import BondFactor, find_bond_factor

        factor = find_bond_factor(self.program, self.contact_set)
        if not isinstance(factor, BondFactor):
            return None
        return BondsNeeded(share=factor.value, fail=tuple(bond.parts for bond in factor.opens))

    @property
    @key
    def warnings(self) -> tuple[str, ...]:
        """Warnings about the input, the contacts and the numbers."""
        failed = self.measured and self.displacement.z is None
        unfinished = "no solver finished the displacement program: z and displacements are left out"
        why = NO_MOTION_BY_LAW if self._rubs else NO_MOTION
        why = NO_MOTION_OF_LIMITS if self._not_modelled else why
        open_motion = [] if self.motion.known else [why]
        last = [*([unfinished] if failed else []), *open_motion]
        upward = [] if self.better_up is None else [upward_words(self.better_up)]
        return (*self.notes, *upward, *filter(None, [self.barely]), *last)

    def to_dict(self) -> dict[str, Any]:
        """The verdict as JSON data, as ``kilter check --json`` prints it."""
        return on_one_thread(super().to_dict)()

    def __str__(self) -> str:
        return self.sentence

    def __repr__(self) -> str:
        return f"<Verdict: {self.verdict}, {len(self.assembly)} parts>"

    def __bool__(self) -> bool:
        raise TypeError(
            "a verdict is neither true nor false: use .stable, or .verdict, which is a word"
        )

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "seconds": dict(self.seconds)}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update({**state, "seconds": MappingProxyType(state["seconds"])})
