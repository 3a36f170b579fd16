"""Steps of a margin: each step computes a limit, or notes why the limit has no value."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any, TypeVar

import numpy as np

from kilter.analysis.analysis_tolerances import ACROSS_GRAVITY, NOT_HELD
from kilter.analysis.decision.bond_factor import BondFactor, find_bond_factor
from kilter.analysis.gradients.gradient import Gradient
from kilter.analysis.load_limit import (
    Limit,
    LimitSteps,
    NoLimit,
    Why,
    find_limit,
    gravity_wrench,
    least_limit,
)
from kilter.analysis.margins.brick_changes import brick_changes
from kilter.analysis.margins.least_friction import (
    Failing,
    LeastFriction,
    find_group_friction,
    find_least_friction,
)
from kilter.analysis.margins.level_limits import (
    LevelLimits,
    Limits,
    find_level_limits,
)
from kilter.analysis.margins.limit_level import verdict_outside
from kilter.analysis.margins.part_limits import PartClusters, PartLoad, Push, easily_moved
from kilter.analysis.margins.tilt import (
    NearestHeld,
    TiltMargin,
    find_least_tilt,
    find_nearest_held,
)
from kilter.analysis.margins.tried_changes import TriedChange, tried_changes
from kilter.analysis.margins.uncertainty import Ranges, Uncertainty, find_uncertainty
from kilter.analysis.verdict.verdict import Verdict
from kilter.arrays import Array
from kilter.assembly import Assembly, require_assembly
from kilter.assembly.bonds import NO_CONE, NOT_RANGED, require_no_bonds
from kilter.assembly.bricks.brick_assembly import is_brick_model
from kilter.assembly.question import require_plain_joints
from kilter.contact import ContactSet
from kilter.contact.round_edges import RoundEdge, round_edges
from kilter.errors import InputError, some_names
from kilter.mechanics.certificate import MotionProof, check_motion
from kilter.mechanics.clusters import limit_groups
from kilter.mechanics.program import Program, build_program
from kilter.mechanics.rows import CONTACT
from kilter.rigid import unit
from kilter.tell.levels import require_level
from kilter.work import PER_EFFORT

# The limits that the user requested of `kilter.margin`, validated.


PUSHED = 50
"""Largest number of parts for which the weakest push is computed, unless parts are named."""
HELD_TRIED = 20
"""Largest number of free parts of which any may be held to find what helps."""


@dataclass(frozen=True, slots=True, eq=False)
class MarginQuestion:
    """The limits that `kilter.margin` is to compute, validated."""

    assembly: Assembly
    push: Array | None
    """Unit direction of the body force of the load factor, world frame, shape (3,); None: the
    given loads."""
    axis: Array | None
    """Unit axis of a further tilt, world frame, perpendicular to gravity, shape (3,)."""
    pushed: list[int]
    """Parts for which the weakest push is computed; more than `PUSHED` if the user named them."""
    named: bool
    """Whether the user named the parts that are pushed."""
    held: list[int]
    """Parts of which one is held to find what helps; empty for many free parts."""
    loaded: list[int]
    """Parts for which the largest further load straight down is computed."""
    ranges: Ranges | None
    """Intervals of the worst case; None: no worst case is computed."""
    bracket: bool
    """Whether the load factor without dilation is also computed."""
    improve: bool
    """Whether changes that raise the limits are searched."""
    require: str
    """Level of the further tilt; "equilibrium": no further tilt is computed."""


def margin_question(
    assembly: Assembly,
    *,
    push: Any,
    about: Any,
    pushes: bool,
    pushed: list[str] | None,
    loads: bool,
    ranges: Ranges | None,
    bracket: bool,
    improve: bool,
    require: str,
) -> MarginQuestion:
    """Validate the arguments of `kilter.margin`.

    Raises `InputError` as `kilter.margin`.
    """
    require_assembly(assembly, "margin")
    direction = None if push is None else unit(push, "push")
    level = require_level(require)
    axis = None if about is None else _axis(assembly, about)
    if axis is not None:
        _require_turnable(assembly)
    if ranges is not None:
        require_no_bonds(assembly, "the worst case over ranges", NOT_RANGED)
        require_plain_joints(assembly, "the worst case over ranges")
    chosen = _free_parts(assembly) if pushed is None else _named_parts(assembly, pushed)
    return MarginQuestion(
        assembly=assembly,
        push=direction,
        axis=axis,
        pushed=chosen if pushes or pushed is not None else [],
        named=pushed is not None,
        held=[] if pushed is None and len(chosen) > HELD_TRIED else chosen,
        loaded=chosen if loads else [],
        ranges=ranges,
        bracket=bracket,
        improve=improve,
        require=level,
    )


def _axis(assembly: Assembly, about: Any) -> Array:
    """Validate the unit axis of a tilt: perpendicular to gravity, and y for a planar assembly."""
    axis = unit(about, "axis of the tilt")
    if abs(float(axis @ assembly.down)) > ACROSS_GRAVITY:
        raise InputError(
            f"the axis {axis.tolist()} is not perpendicular to gravity",
            hint="give a horizontal axis",
        )
    if assembly.planar and abs(abs(float(axis[1])) - 1) > ACROSS_GRAVITY:
        raise InputError(
            "the axis is not perpendicular to the plane", hint="give 0 1 0 for planar assemblies"
        )
    return axis


def _require_turnable(assembly: Assembly) -> None:
    """Reject a tilt about an axis if the assembly has loads or bonds, which do not turn with it."""
    require_no_bonds(assembly, "a tilt about an axis", NO_CONE)
    require_plain_joints(assembly, "a tilt about an axis")
    if assembly.loads:
        raise InputError(
            "a tilt about an axis is not defined with loads: they do not turn with gravity",
            file=assembly.source or None,
            part=assembly.loads[0].part,
            hint="leave the loads out, or compute the margins without an axis",
        )


def _free_parts(assembly: Assembly) -> list[int]:
    """Indices of the parts that are not held in place."""
    return [k for k, part in enumerate(assembly.parts) if not part.grounded]


def _named_parts(assembly: Assembly, names: list[str]) -> list[int]:
    """Indices of the named parts, in the given order; each of them must be free."""
    chosen = []
    for name in names:
        k = assembly.index_of(name)
        if assembly.parts[k].grounded:
            raise InputError("it is held, so no push moves it", part=name, hint="name a free part")
        chosen.append(k)
    return chosen


T = TypeVar("T")

ENDED: dict[Why, str] = {
    "time": "the time limit was reached",
    "interrupted": "the command was interrupted",
}
"""Causes that ended a search for a limit."""
LARGE = 500
"""Number of rows of a program above which the number of coefficients is limited."""
COEFFICIENTS, OPEN = 20, 1
"""Number of friction coefficients that are decided at effort 1 or less, and if open pairs decide
and a coefficient is already proved not to be enough.
"""

ENDS: tuple[Why, ...] = ("interrupted", "time", "failed", "none")
"""Reasons for a missing end of the load factor, in order of precedence."""
Ends = tuple[Limit | None, Limit | None]
"""Limits at the least and the greatest load factor; None for an end that has no limit."""


@dataclass(slots=True, kw_only=True, eq=False)
class MarginSteps(LimitSteps):
    """Steps that compute the limits of a margin; `program` has the modelled contacts."""

    question: MarginQuestion
    verdict: Verdict
    program: Program
    warnings: list[str]
    groups: list[Program] = field(default_factory=list)
    """Programs of groups of parts that do not touch; of equal clusters only the first."""

    def __post_init__(self) -> None:
        self.groups = limit_groups(self.program)

    def tilt(self) -> TiltMargin | NearestHeld | None:
        """Compute the tilt margin, or the nearest held direction if the gravity is not held."""
        self.tell("tilt")
        if self.program.applied.any():
            self.warnings.append("no tilt margin: given loads do not turn with gravity")
            return None
        if self.program.has_strength:
            self.warnings.append(
                "no tilt margin: bonds, straps, joint friction and springs do not turn with gravity"
            )
            return None
        # the verdict proves that no tilt limit exists, so that only the nearest direction is open
        falls = self._large and self._falls is not None
        gravity = self.in_time(self._nearest if falls else self._tilt_or_nearest)
        if isinstance(gravity, NoLimit):
            self.missing["tilt"] = gravity.why
            return None
        return gravity

    def friction(self) -> LeastFriction | None:
        """Compute bounds of the least friction coefficient; None without a value.

        The number of coefficients tried is limited for a large assembly, above all if open pairs
        decide: then the limit concerns the drawing only. The motion of the verdict proves a lower
        bound.
        """
        fitted = build_program(self.question.assembly, self.verdict.contact_set, fitted=True)
        contacts, failing, most = fitted.kind == CONTACT, None, np.inf
        if self._large and self._falls is not None and not fitted.has_limits:
            mu = fitted.mu[contacts]
            if len(mu) and mu.min() == mu.max() > 0.0:
                proof = check_motion(fitted, self._falls.motion)
                failing = Failing(float(mu[0]), proof) if proof.holds else None
        if self._large:
            few = self.verdict.question is not None and failing is not None
            most = OPEN if few else COEFFICIENTS * max(self.work.allowed / PER_EFFORT, 1.0)
        if failing is not None:
            find = partial(find_least_friction, failing=failing, programs=most)
            return self.limit("friction", find, fitted)
        find_all = partial(find_group_friction, programs=most)
        return self.limit("friction", find_all, limit_groups(fitted))

    def bond(self) -> BondFactor | None:
        """Least share of the strength of bonds and straps; None without a value."""
        assembly = self.question.assembly
        if not (assembly.bonds or assembly.straps):
            return None
        if any({"friction", "stiffness"} & set(joint.guide) for joint in assembly.joints):
            self.warnings.append("no bond margin: friction and springs of joints are no bonds")
            return None
        return self.limit("bond", find_bond_factor, self.program, self.verdict.contact_set)

    @property
    def edges(self) -> tuple[RoundEdge, ...]:
        """Round edges over which parts tip; none for a large or planar program."""
        if self._large or self.program.planar:
            return ()
        return round_edges(self.question.assembly, self.verdict.contact_set)

    @property
    def _large(self) -> bool:
        """Whether the program has so many rows that limits are searched with less work."""
        return len(self.program.part_a) > LARGE

    @property
    def _falls(self) -> MotionProof | None:
        """The motion by which the verdict proves that the certain contacts do not hold."""
        judgement = self.verdict.judgement
        return judgement.motion if judgement.stable is False else None

    def load_factor(self, name: str, program: Program) -> Ends | None:
        """Least and greatest load factor at which the assembly holds; None if no load is given."""
        groups = self.groups if program is self.program else limit_groups(program)
        limits = self.in_time(_load_factors, self.question, groups)
        if limits is None:
            return None
        least: Limit | NoLimit
        greatest: Limit | NoLimit
        if isinstance(limits, NoLimit):
            least, greatest = limits, limits
        else:
            least, greatest = _load_factor(*limits)
        whys = [end.why for end in (least, greatest) if isinstance(end, NoLimit)]
        if whys:
            self.missing[name] = next(why for why in ENDS if why in whys)
        return _limit_or_none(least), _limit_or_none(greatest)

    def pushes(self, clusters: PartClusters) -> tuple[Push, ...]:
        """The weakest push that moves each requested part, or the parts that move most easily."""
        pushed = self.question.pushed
        if len(pushed) > PUSHED and not self.question.named:
            pushed = easily_moved(self.program, pushed)[:PUSHED]
            self.warnings.append(
                f"pushes: {PUSHED} of {len(self.question.pushed)} parts, which move most easily "
                "if all other parts are held; --part NAME adds others"
            )
        return self._of_parts("push of", "pushes", clusters.push, pushed)

    def parts(self) -> tuple[tuple[Push, ...], tuple[PartLoad, ...]]:
        """Weakest pushes and largest loads of the parts; each concerns the cluster of its part."""
        if not (self.question.pushed or self.question.loaded):
            return (), ()
        self.tell("pushes" if self.question.pushed else "loads")
        clusters = PartClusters(self.program)
        pushes = self.pushes(clusters)
        return pushes, self._of_parts("load on", "loads", clusters.load, self.question.loaded)

    def warn_of_missing(self) -> None:
        """Add warnings about limits that have no value, and about gains that are not computed."""
        self.warnings += _missing_words(self.missing)
        large = not (self.question.held or self.question.named) and self.program.free.any()
        if self.question.improve and large and not is_brick_model(self.question.assembly):
            self.warnings.append(
                f"for more than {HELD_TRIED} free parts, the gain of holding a part is computed "
                "only for parts that --part NAME names"
            )

    def worst_case(self) -> Uncertainty | None:
        """Worst limits over intervals of uncertain data; None, with a warning, if not computed."""
        ranges = self.question.ranges
        if ranges is None:
            return None
        self.tell("uncertainty")
        find = partial(find_uncertainty, push=self.question.push)
        worst = self.limit("uncertainty", find, self.program, ranges)
        if worst is None and "uncertainty" not in self.missing:
            self.warnings.append(
                "no worst case: there are too many parts and contacts for intervals of masses or"
                " centres; without --mass-range and --com-range there is no such limit"
            )
        return worst

    def beyond(self, tilt: TiltMargin) -> str | None:
        """The verdict just beyond the tilt margin."""
        assembly, touching = self.question.assembly, self.verdict.contact_set
        return _limit_or_none(
            self.in_time(verdict_outside, assembly, touching, tilt.angle, tilt.toward, self.work)
        )

    def at_level(self, limits: Limits) -> LevelLimits | None:
        """Margins of the required verdict level; None if that level is "equilibrium"."""
        level = self.question.require
        if level == "equilibrium":
            return None
        self.tell(f"limits at the level {level}")
        find = partial(find_level_limits, level=level, units=self.work.allowed, work=self.work)
        assembly, touching = self.question.assembly, self.verdict.contact_set
        found = self.limit("limits at the level", find, assembly, touching, limits)
        if found is not None:
            self.warnings += found.unknown_words()
        return found

    def tried_changes(
        self, gradient: Callable[[], Gradient], touching: ContactSet, bond: BondFactor | None
    ) -> tuple[TriedChange, ...]:
        """Changes of the assembly that improve a limit most, each tried.

        Of a brick model the needed share of the strength of studs, else the limit of a gradient.
        """
        if not self.question.improve:
            return ()
        self.tell("changes that help")
        assembly = self.question.assembly
        find: Callable[[], tuple[TriedChange, ...]]
        try:
            if is_brick_model(assembly):
                find = partial(
                    brick_changes, assembly, self.verdict, self.program, bond, work=self.work
                )
            else:
                find = partial(
                    tried_changes, assembly, touching, gradient(),
                    push=self.question.push, held=self.question.held, work=self.work,
                )  # fmt: skip
            found = self.limit("what helps", find)
        except InputError as error:
            self.warnings.append(f"no changes were tried: {error.what}")
            return ()
        if not found and "what helps" not in self.missing:
            self.warnings.append("no single change that was tried raises the limit")
        return found or ()

    def _nearest(self) -> NearestHeld | NoLimit:
        """The held direction of gravity that is nearest to the given one, which is not held."""
        return find_nearest_held(self.program)

    def _tilt_or_nearest(self) -> TiltMargin | NearestHeld | NoLimit:
        """The tilt margin; or the nearest held direction, if the given one is proved not held."""
        tilt = find_least_tilt(self.groups, self.edges, self.tell)
        if isinstance(tilt, TiltMargin):
            return tilt
        nearest = self._nearest()
        # without a proof that gravity as given is not held, a nearest direction answers nothing
        failed = tilt.why == "failed" and not isinstance(nearest, NoLimit)
        return tilt if failed else nearest

    def _of_parts(
        self,
        name: str,
        stage: str,
        find: Callable[[int], T | NoLimit],
        parts: list[int],
    ) -> tuple[T, ...]:
        """Compute a limit of each listed part; return the limits that have a value, in order."""
        limits = []
        for count, part in enumerate(parts, 1):
            limits.append(self.limit(f"{name} {self.program.names[part]}", find, part))
            self.tell(f"{stage}: {count} of {len(parts)}")
        return tuple(limit for limit in limits if limit is not None)


def _limit_or_none(limit: T | NoLimit | None) -> T | None:
    """The value of a limit; None if it has no value."""
    return None if isinstance(limit, NoLimit) else limit


def _missing_words(missing: dict[str, Why]) -> list[str]:
    """Warnings about limits without a value, and about an assembly that any push moves."""
    failed = [name for name, why in missing.items() if why == "failed"]
    words = [f"not known, because the solver failed: {some_names(failed)}"] if failed else []
    for why, cause in ENDED.items():
        late = [name for name, reason in missing.items() if reason == why]
        words += [f"not known, because {cause}: {some_names(late)}"] if late else []
    of_parts = (why for name, why in missing.items() if name.startswith(("push of", "load on")))
    if "none" in of_parts:
        words.append("it is not in equilibrium as given, so it resists no push and no load")
    return words


Factors = tuple[list[Limit | NoLimit], list[Limit | NoLimit]]
"""Limits of each group at the least and at the greatest load factor."""


def _load_factors(question: MarginQuestion, groups: Sequence[Program]) -> Factors | None:
    """Least and greatest factor of the body force or the given loads of each group.

    None if no load is given.
    """
    if question.push is None and not question.assembly.loads:
        return None
    least, greatest = [], []
    for program in groups:
        if question.push is not None:
            base, wrench = program, gravity_wrench(program, question.push)
        else:
            base = program.with_rows(applied=np.zeros_like(program.applied))
            wrench = np.where(program.free[:, None], program.applied, 0.0)
        least.append(find_limit(base, -wrench))
        greatest.append(find_limit(base, wrench))
    return least, greatest


def _load_factor(
    least: list[Limit | NoLimit], greatest: list[Limit | NoLimit]
) -> tuple[Limit | NoLimit, Limit | NoLimit]:
    """Least and greatest load factor of all groups together, from those of each group."""
    first = least_limit(least, lambda limit: limit.value)
    last = least_limit(greatest, lambda limit: limit.value)
    # the proof that no factor is held covers both ends: an end at which the solver failed, too
    whys = {end.why for end in (first, last) if isinstance(end, NoLimit)}
    apart = not whys and _limit_value(first) + _limit_value(last) < NOT_HELD
    if whys == {"none", "failed"} or apart:
        return NoLimit("none"), NoLimit("none")
    return first, last


def _limit_value(limit: Limit | NoLimit) -> float:
    """The value of a limit; NaN if it has none."""
    return limit.value if isinstance(limit, Limit) else np.nan
