"""Margins: tilt, friction, load factor and pushes, with the motion that starts at each limit.

Every limit is that of equilibrium forces: beyond it no forces hold. If the assembly rests on
holds, whether it must hold below the limit is another question (`kilter.friction.answer`).
Contacts that are not modelled are left out; more contacts only raise a margin.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any, ClassVar

import numpy as np

from kilter.analysis.check import check
from kilter.analysis.decision.bond_factor import BondFactor
from kilter.analysis.decision.fitted_normals import fits_left_out
from kilter.analysis.decision.open_question import open_pair_names
from kilter.analysis.load_limit import Limit, Why
from kilter.analysis.margins.least_friction import LeastFriction
from kilter.analysis.margins.level_limits import LevelLimits, Limits
from kilter.analysis.margins.margin_proofs import margin_proofs
from kilter.analysis.margins.margin_question import MarginQuestion, margin_question
from kilter.analysis.margins.margin_steps import MarginSteps
from kilter.analysis.margins.part_loads import PartLoad
from kilter.analysis.margins.pushes import Push
from kilter.analysis.margins.tilt import NearestHeld, TiltAbout, TiltMargin, tilt_about
from kilter.analysis.margins.uncertainty import Ranges, Uncertainty
from kilter.analysis.margins.what_helps import Help
from kilter.analysis.verdict.answers import OfAssembly
from kilter.analysis.verdict.verdict import Verdict
from kilter.arrays import Array
from kilter.assembly import Assembly
from kilter.assembly.question import Question, question
from kilter.contact import ContactSet
from kilter.contact.round_edges import RoundEdge, has_round_edges
from kilter.mechanics.bundle import make_bundle
from kilter.mechanics.program import Program, build_program
from kilter.tell.levels import REQUIRE
from kilter.tell.record import (
    Ends,
    Guarantee,
    InPython,
    LevelWord,
    Record,
    Seconds,
    Vector,
    Word,
    key,
)
from kilter.work import Work

__all__ = ["Margin", "margin"]


class Bracket(Record):
    """Bounds of the least and of the greatest load factor, if slipping contacts do not dilate.

    The inner bounds are held however slippery the parts.
    """

    least: Ends | None
    """Bounds of the least factor."""
    greatest: Ends | None
    """Bounds of the greatest factor."""


class Margin(OfAssembly):
    """Answer of `kilter.margin`: limits of tilt, friction, load factor and pushes."""

    answer: ClassVar[str] = "margin"

    check: InPython[Verdict]
    """Answer of `kilter.check`."""
    program: InPython[Program]
    """The modelled contacts, with friction."""
    verdict: Word
    """Verdict of `kilter.check`."""
    sentence: str
    """The verdict in words."""
    guarantee: Guarantee
    """Guarantee of the verdict."""
    level: LevelWord
    """Level of the limits: "proved" without friction, else "equilibrium"."""
    require: LevelWord
    """Level of `at_level`."""
    tilt: InPython[TiltMargin | None]
    """None if gravity as given is not held, with loads, or if the region is thinner than a cone."""
    nearest: InPython[NearestHeld | None]
    """Least turn that is held, from both sides, if gravity as given is not held."""
    tilt_deg: float | None
    """Least turn of gravity to the boundary [deg]; negative when outside."""
    tilt_outside: Word | None
    """Verdict of `kilter.check` just beyond the tilt limit, at the level "equilibrium"."""
    at_level: LevelLimits | None
    """Values up to which the level `require` is reached, if it is above "equilibrium"."""
    tilt_lower_deg: float | None
    """Turn that is proved to be held in every direction [deg]."""
    tilt_upper_deg: float | None
    """Turn that is proved not to reach a held direction, negative [deg]."""
    tilt_down: Vector | None
    """Direction of gravity at the limit; None if no tilt up to a right angle fails."""
    tilt_limit: Limit | None
    """Proofs of the tilt."""
    about: TiltAbout | None
    """Turn about the given axis."""
    friction: float | None
    """Least coefficient, the same at every contact [-]; None if none is enough."""
    friction_limit: LeastFriction | None
    """Proof of the least friction coefficient."""
    clamped_by: tuple[str, ...]
    """Bonds and straps, of which `bond` is the needed share."""
    bond: float | None
    """Least share of the strength of bonds and straps that is enough [-]; None if it is 0."""
    bond_limit: BondFactor | None
    """Proof of the least share of the bond strength; None if no share is enough."""
    load_factor: Ends | None
    """Least and greatest load factor [-], infinite without a limit; None without loads."""
    load_factor_bracket: Bracket | None
    """Bounds of the load factor without dilation, if requested."""
    load_limits: tuple[Limit | None, Limit | None] | None
    """Proofs of both ends; the values of the least have the opposite sign."""
    pushes: tuple[Push, ...]
    """Weakest push of each part."""
    loads: tuple[PartLoad, ...]
    """Additional load straight down of each part; empty if it was not requested."""
    push: InPython[Vector | None]
    """Direction of the body force of `load_factor`; None if the factor is that of the loads."""
    edges: InPython[tuple[RoundEdge, ...]]
    """Round edges over which parts tip, in the tilt."""
    missing: dict[str, Why]
    """Requested limits without a value, and why: "none", proved that there is none (it is not held
    as given, or no friction or factor is enough); "failed", the numbers did."""
    uncertainty: Uncertainty | None
    """The worst case of inexact data; None without ranges, or if there are too many cases."""
    helps: tuple[Help, ...]
    """Changes that raise the tilt margin, or else the greatest load factor, most."""
    warnings: tuple[str, ...]
    """What to know about the answer."""
    seconds: Seconds
    """Duration of each stage [s]."""

    @property
    @key
    def exact(self) -> bool:
        """Whether all limits are those of the solids: no open pair, and no polygon for a circle.

        Only the tilt counts round edges as circles; every other limit is that of polygons inside.
        """
        if self.contacts.open_pairs:
            return False
        others = self.about, self.load_limits, self.bond_limit, self.uncertainty, *self.pushes
        tilts = self.tilt is not None and not (any(others) or self.loads)
        tilts = tilts and not self.friction
        known = self.edges if tilts and self.tilt is not None and self.tilt.closed else ()
        return not has_round_edges(self.assembly, self.contacts, known)

    def proof(self, *, options: dict[str, Any] | None = None) -> dict[str, Any]:
        """Forces within each limit and a motion beyond it, for `kilter.verify`, as JSON data.

        Raises
        ------
        InputError
            If no limit is known.
        """
        return make_bundle("margin", margin_proofs(self, options=options or {}))

    def __repr__(self) -> str:
        tilt = "none" if self.tilt_deg is None else f"{self.tilt_deg:.6g} deg"
        if self.tilt is not None and self.tilt_down is None:
            tilt = "over 90 deg"
        mu = "none" if self.friction is None else f"{self.friction:.6g}"
        if self.friction_limit is not None and not self.friction_limit.attained:
            mu = f"above {mu}"
        return f"Margin({self.verdict}, tilt {tilt}, least friction {mu})"


def _interval(factor: tuple[Limit | None, Limit | None] | None) -> Ends | None:
    """Least and greatest load factor as numbers; None if no factor holds the assembly."""
    least, greatest = factor or (None, None)
    return None if least is None or greatest is None else (-least.value, greatest.value)


def _bracket(factor: Ends | None, sure: Ends | None) -> Bracket:
    """Least and greatest load factor, each as two bounds."""
    if factor is None:
        return Bracket(least=None, greatest=None)
    inner = (np.nan, np.nan) if sure is None else sure
    return Bracket(least=(factor[0], inner[0]), greatest=(inner[1], factor[1]))


@question(require="equilibrium")
def margin(
    asked: Question,
    *,
    push: Any = None,
    about: Any = None,
    pushed: list[str] | None = None,
    loads: bool = False,
    ranges: Ranges | None = None,
    bracket: bool = False,
) -> Margin:
    """Compute the margins of an assembly: tilt, least friction, load factor and pushes.

    Parameters
    ----------
    assembly : Assembly, or path
    push : array_like, shape (3,), optional
        The load factor of a body force in this direction, in units of each part's weight;
        else that of the given loads, if there are any.
    about : array_like, shape (3,), optional
        Also the tilt about this axis, across gravity, by the right-hand rule.
    pushed : list of str, optional
        Parts for which the weakest push, and the gain of holding them, are computed;
        by default all, up to `PUSHED` free parts.
    loads : bool
        Also the load straight down that each free part takes, or each of `pushed`.
    ranges : Ranges, optional
        Also the worst tilt margin and load factor over these intervals.
    bracket : bool
        Also the load factors up to which no motion that obeys the contact law can start.
    require : {"equilibrium", "settles", "proved"}
        Level from which the answer is yes. Above "equilibrium", `Margin.at_level` has the values up
        to which this level is reached. The default is lower than that of `check`, because each
        further value is a search.

    Raises
    ------
    InputError
        If a direction is of length zero, the axis is not across gravity, or a part is held or
        unknown, also one that a load pulls on; if `about` comes with bonds or loads, or `ranges`
        with bonds.

    See Also
    --------
    kilter.check : the verdict on the given direction and friction.
    kilter.transport : limits of the acceleration of a carrier.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> round(margin(scene("tower")).friction, 6)
    0.0
    """
    question = margin_question(
        asked.assembly,
        push=push,
        about=about,
        pushed=pushed,
        loads=loads,
        ranges=ranges,
        bracket=bracket,
        require=asked.require,
    )
    verdict = check(asked.but(require=REQUIRE))
    limits = _limits(question, verdict, asked.work(), asked.tell)
    seconds = {**verdict.seconds, "total": time.perf_counter() - asked.begun}
    return Margin(
        assembly=asked.assembly,
        contacts=verdict.contact_set,
        check=verdict,
        verdict=verdict.verdict,
        sentence=verdict.sentence,
        guarantee=verdict.guarantee,
        require=question.require,
        push=question.push,
        clamped_by=tuple(name for name in ("bonds", "straps") if getattr(asked.assembly, name)),
        seconds=seconds,
        **limits,
    )


def _limits(
    question: MarginQuestion, verdict: Verdict, work: Work, tell: Callable[[str], None]
) -> dict[str, Any]:
    """Compute the limits of a margin: the members of `Margin` that need a program."""
    assembly = question.assembly
    program = build_program(assembly, verdict.contact_set)
    warnings = [*verdict.notes, *_left_out(assembly, verdict.contact_set, program)]
    steps = MarginSteps(
        work=work,
        tell=tell,
        question=question,
        verdict=verdict,
        program=program,
        warnings=warnings,
    )
    gravity = steps.tilt()
    tilt = gravity if isinstance(gravity, TiltMargin) else None
    degrees, down = _boundary(gravity)
    about = None
    if question.axis is not None:
        about = steps.limit("about", tilt_about, program, question.axis)
    tell("friction" if degrees is None else f"tilt {degrees:.6g} deg; friction")
    friction = steps.friction()
    bond = steps.bond()
    tell(f"{'' if friction is None else f'friction {friction.value:.6g}; '}load factor")
    factor = steps.load_factor("load_factor", program)
    sure = steps.load_factor("bracket", program.frictionless) if question.bracket else None
    pushes, part_loads = steps.parts()
    steps.warn_of_missing()
    worst = steps.worst_case()
    outside = None if tilt is None or down is None else steps.beyond(tilt)
    limits = Limits(friction=friction)
    if program.mu.any():  # without friction, the limits of equilibrium are proved
        limits = Limits(tilt, about, friction, factor or (), question.push, pushes, part_loads)
    return {
        "program": program,
        "level": "equilibrium" if program.mu.any() else "proved",
        **_tilt_keys(gravity),
        "tilt_outside": outside,
        "at_level": steps.at_level(limits),
        "about": about,
        "friction": None if friction is None else float(friction.value),
        "friction_limit": friction,
        "bond": None if bond is None else bond.value or None,
        "bond_limit": bond,
        "load_factor": _interval(factor),
        "load_limits": factor,
        "load_factor_bracket": None
        if sure is None or factor is None
        else _bracket(_interval(factor), _interval(sure)),
        "pushes": pushes,
        "loads": part_loads,
        "uncertainty": worst,
        "helps": steps.helps(tilt, None if factor is None else factor[1]),
        "edges": steps.edges,
        "missing": steps.missing,
        "warnings": tuple(warnings),
    }


def _tilt_keys(gravity: TiltMargin | NearestHeld | None) -> dict[str, Any]:
    """The members of `Margin` about the tilt."""
    tilt = gravity if isinstance(gravity, TiltMargin) else None
    nearest = gravity if isinstance(gravity, NearestHeld) else None
    degrees, down = _boundary(gravity)
    return {
        "tilt": tilt,
        "nearest": nearest,
        "tilt_deg": degrees,
        "tilt_down": down,
        "tilt_lower_deg": None if tilt is None else float(np.degrees(tilt.lower)),
        "tilt_upper_deg": None if nearest is None else -float(np.degrees(nearest.lower)),
        "tilt_limit": None if tilt is None else tilt.limit,
    }


def _left_out(assembly: Assembly, contacts: ContactSet, program: Program) -> list[str]:
    """Warnings about open pairs and fitted contacts, whose forces the margins ignore."""
    fits = fits_left_out(assembly, contacts, program)
    if not contacts.open_pairs:
        return fits
    names = open_pair_names(assembly, contacts)
    return [f"open pairs are left out; the margins may be larger if they hold: {names}", *fits]


def _boundary(gravity: TiltMargin | NearestHeld | None) -> tuple[float | None, Array | None]:
    """Angle from gravity to the boundary of the stable region [deg], and the direction there.

    Negative if gravity is outside.
    """
    if gravity is None:
        return None, None
    if isinstance(gravity, NearestHeld):
        return -float(np.degrees(gravity.angle)), gravity.down
    fails = gravity.angle < np.pi / 2
    return float(np.degrees(gravity.angle)), gravity.down if fails else None
