"""Margins: tilt, friction, load factor and pushes, with the motion that starts at each limit.

Every limit is that of equilibrium forces: beyond it no forces hold. If the assembly rests on
holds, whether it must hold below the limit is another question (`kilter.friction.answer`).
Contacts that are not modelled are left out; more contacts only raise a margin.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from kilter.analysis.check import check
from kilter.analysis.decision.fitted_normals import fits_left_out
from kilter.analysis.margins.bond_factor import BondFactor, find_bond_factor
from kilter.analysis.margins.least_friction import LeastFriction
from kilter.analysis.margins.level_limits import LevelLimits, Limits
from kilter.analysis.margins.load_limit import Limit, Why, finite
from kilter.analysis.margins.margin_proofs import margin_proofs
from kilter.analysis.margins.margin_question import MarginQuestion, margin_question
from kilter.analysis.margins.margin_steps import MarginSteps
from kilter.analysis.margins.part_loads import PartLoad
from kilter.analysis.margins.pushes import Push
from kilter.analysis.margins.tilt import NearestHeld, TiltMargin, tilt_about
from kilter.analysis.margins.uncertainty import Ranges, Uncertainty
from kilter.analysis.margins.what_helps import Help
from kilter.analysis.open_pairs.open_question import open_pair_names, open_pairs_answer
from kilter.analysis.verdict.answers import joints_answer
from kilter.analysis.verdict.verdict import Verdict
from kilter.arrays import Array
from kilter.assembly import Assembly
from kilter.assembly.question import Question, question
from kilter.contact import ContactSet
from kilter.contact.round_edges import RoundEdge, has_round_edges
from kilter.mechanics.bundle import make_bundle
from kilter.mechanics.program import Program, build_program
from kilter.tell.json_answer import AnswerInWords
from kilter.tell.levels import REQUIRE
from kilter.work import Work

if TYPE_CHECKING:
    from kilter.tell.answer_data.common_data import LimitData
    from kilter.tell.answer_data.margin_data import BracketData, MarginData

__all__ = ["Margin", "margin"]


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Margin(AnswerInWords):
    """The limits up to which an assembly holds: tilt, friction, load factor and pushes.

    Attributes
    ----------
    assembly : Assembly
    contacts : ContactSet
        Contacts of the assembly.
    verdict : Verdict
    program : Program
        The modelled contacts, with friction.
    tilt : TiltMargin or None
        None if gravity as given is not held, with loads, or if the region is thinner
        than a cone.
    tilt_deg : float or None
        Least turn of gravity to the boundary; negative when outside.
    tilt_down : ndarray, shape (3,), or None
        Direction of gravity there; None if no tilt up to a right angle fails.
    nearest : NearestHeld or None
        Least turn that is held, from both sides, if gravity as given is not held.
    outside : str or None
        The verdict of `kilter.check` just beyond the tilt limit, at the level "equilibrium".
    at_level : LevelLimits or None
        The values up to which the level `require` is reached, if it is above "equilibrium".
    require : str
    about : tuple of (ndarray, float, Limit), or None
        The given axis, the angle about it by the right-hand rule [rad], and the limit.
    friction : LeastFriction or None
        None if no coefficient is enough.
    bond : BondFactor or None
        Least share of their strength that bonds need; None without bonds, or if no share is
        enough.
    load_factor : tuple of Limit or None, or None
        Least and greatest factor; None without loads.
    guaranteed : tuple of Limit or None, or None
        Least and greatest factor that are held however slippery the parts: with sliding that
        does not dilate (not associative) the limits lie between these and `load_factor`.
        None if it was not requested.
    pushes : tuple of Push
    loads : tuple of PartLoad
        Additional load straight down of each part; empty if it was not requested.
    push : ndarray, shape (3,), or None
        Direction of the body force of `load_factor`; None if the factor is that of the loads.
    edges : tuple of RoundEdge
        Round edges over which parts tip, in the tilt.
    missing : dict
        Requested limits without a value, "tilt", "about", "friction", "load_factor",
        "bracket", "push of NAME" or "load on NAME", and why: "none", proved that there is none (it
        is not held as given, or no friction or factor is enough); "failed", the numbers did.
    uncertainty : Uncertainty or None
        The worst case over `ranges`; None without ranges, or if there are too many cases.
    helps : tuple of Help
        Changes that raise the tilt margin, or else the greatest load factor, most.
    warnings : tuple of str
    seconds : dict
    """

    answer: ClassVar[str] = "margin"

    assembly: Assembly
    contacts: ContactSet
    verdict: Verdict
    program: Program
    tilt: TiltMargin | None
    tilt_deg: float | None
    tilt_down: Array | None
    nearest: NearestHeld | None
    outside: str | None
    at_level: LevelLimits | None
    require: str
    about: tuple[Array, float, Limit] | None
    friction: LeastFriction | None
    bond: BondFactor | None
    load_factor: tuple[Limit | None, Limit | None] | None
    guaranteed: tuple[Limit | None, Limit | None] | None
    pushes: tuple[Push, ...]
    loads: tuple[PartLoad, ...]
    push: Array | None
    edges: tuple[RoundEdge, ...]
    missing: dict[str, Why]
    uncertainty: Uncertainty | None
    helps: tuple[Help, ...]
    warnings: tuple[str, ...]
    seconds: dict[str, float]

    @property
    def exact(self) -> bool:
        """Whether all limits are those of the solids: no open pair, and no polygon for a circle.

        Only the tilt counts round edges as circles; every other limit is that of polygons inside.
        """
        if self.verdict.contacts.open_pairs:
            return False
        others = self.about, self.load_factor, self.bond, self.uncertainty, *self.pushes
        tilts = self.tilt is not None and not (any(others) or self.loads)
        tilts = tilts and (self.friction is None or self.friction.value == 0.0)
        known = self.edges if tilts and self.tilt is not None and self.tilt.closed else ()
        return not has_round_edges(self.assembly, self.contacts, known)

    def to_dict(self) -> MarginData:
        """The margin as JSON data, as ``kilter margin --json`` prints it."""
        program, tilt, factor = self.program, self.tilt, self.load_factor
        about, friction, down = self.about, self.friction, self.tilt_down
        return {
            "verdict": self.verdict.verdict,
            "sentence": self.verdict.sentence,
            "guarantee": self.verdict.guarantee,
            "units": self.assembly.units,
            "down": self.assembly.down.tolist(),
            "joints": joints_answer(self.assembly),
            "open_pairs": open_pairs_answer(self.assembly, self.verdict.contacts),
            "exact": self.exact,
            "level": self.level,
            "require": self.require,
            "tilt_deg": self.tilt_deg,
            "tilt_outside": self.outside,
            "at_level": None if self.at_level is None else self.at_level.to_dict(),
            "tilt_lower_deg": None if tilt is None else float(np.degrees(tilt.lower)),
            "tilt_upper_deg": None
            if self.nearest is None
            else -float(np.degrees(self.nearest.lower)) + 0.0,
            "tilt_down": None if down is None else down.tolist(),
            "tilt_limit": None if tilt is None else tilt.limit.to_dict(program),
            "about": None
            if about is None
            else {
                "axis": about[0].tolist(),
                "tilt_deg": finite(np.degrees(about[1])),
                "limit": about[2].to_dict(program),
            },
            "friction": None if friction is None else float(friction.value),
            "friction_limit": None if friction is None else friction.to_dict(program),
            "bond": None if self.bond is None or not self.bond.value else self.bond.value,
            "clamped_by": [name for name in ("bonds", "straps") if getattr(self.assembly, name)],
            "bond_limit": None if self.bond is None else self.bond.to_dict(program, self.assembly),
            "load_factor": None if factor is None else _interval(factor),
            "load_factor_bracket": self._bracket(),
            "load_limits": None if factor is None else [_limit(program, f) for f in factor],
            "pushes": [push.to_dict(program) for push in self.pushes],
            "loads": [load.to_dict(program) for load in self.loads],
            "missing": dict(self.missing),
            "uncertainty": None if self.uncertainty is None else self.uncertainty.to_dict(program),
            "helps": [change.to_dict() for change in self.helps],
            "warnings": list(self.warnings),
            "seconds": self.seconds,
        }

    @property
    def level(self) -> str:
        """Verdict level of the limits: "proved" without friction, else "equilibrium"."""
        return "equilibrium" if self.program.mu.any() else "proved"

    def proof(self, *, options: dict[str, Any] | None = None) -> dict[str, Any]:
        """Forces within each limit and a motion beyond it, for `kilter.verify`, as JSON data.

        Raises
        ------
        InputError
            If no limit is known.
        """
        return make_bundle("margin", margin_proofs(self, options=options or {}))

    def _bracket(self) -> BracketData | None:
        """Least and greatest load factor, each as two bounds; None if not requested."""
        if self.guaranteed is None or self.load_factor is None:
            return None
        sure, most = _interval(self.guaranteed), _interval(self.load_factor)
        if most is None:
            return {"least": None, "greatest": None}
        inner = sure if sure is not None else [None, None]
        return {"least": [most[0], inner[0]], "greatest": [inner[1], most[1]]}

    def __repr__(self) -> str:
        tilt = "none" if self.tilt_deg is None else f"{self.tilt_deg:.6g} deg"
        if self.tilt is not None and self.tilt_down is None:
            tilt = "over 90 deg"
        mu = "none" if self.friction is None else f"{self.friction.value:.6g}"
        if self.friction is not None and not self.friction.attained:
            mu = f"above {mu}"
        return f"Margin({self.verdict.verdict}, tilt {tilt}, least friction {mu})"


def _interval(factor: tuple[Limit | None, Limit | None]) -> list[float | None] | None:
    """Least and greatest load factor as numbers; None if no factor holds the assembly."""
    least, greatest = factor
    return (
        None
        if least is None or greatest is None
        else [finite(-least.value), finite(greatest.value)]
    )


def _limit(program: Program, limit: Limit | None) -> LimitData | None:
    return None if limit is None else limit.to_dict(program)


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
    >>> round(margin(scene("tower")).friction.value, 6)
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
        contacts=verdict.contacts,
        verdict=verdict,
        require=question.require,
        push=question.push,
        seconds=seconds,
        **limits,
    )


def _limits(
    question: MarginQuestion, verdict: Verdict, work: Work, tell: Callable[[str], None]
) -> dict[str, Any]:
    """Compute the limits of a margin: the members of `Margin` that need a program."""
    assembly = question.assembly
    program = build_program(assembly, verdict.contacts)
    warnings = [*verdict.warnings, *_left_out(assembly, verdict.contacts, program)]
    steps = MarginSteps(question, verdict, program, work, tell, warnings)
    gravity = steps.tilt()
    tilt = gravity if isinstance(gravity, TiltMargin) else None
    degrees, down = _boundary(gravity)
    axis = question.axis
    turned = None if axis is None else steps.limit("about", tilt_about, program, axis)
    tell("friction" if degrees is None else f"tilt {degrees:.6g} deg; friction")
    friction = steps.friction()
    bonded = (find_bond_factor, program, verdict.contacts)
    strong = bool(assembly.bonds or assembly.straps)
    if strong and any({"friction", "stiffness"} & set(joint.guide) for joint in assembly.joints):
        strong = False
        warnings.append("no bond margin: friction and springs of joints are no bonds")
    bond = steps.limit("bond", *bonded) if strong else None
    tell(f"{'' if friction is None else f'friction {friction.value:.6g}; '}load factor")
    factor = steps.load_factor("load_factor", program)
    sure = steps.load_factor("bracket", program.frictionless) if question.bracket else None
    pushes, part_loads = steps.parts()
    steps.warn_of_missing()
    worst = steps.worst_case()
    outside = None if tilt is None or down is None else steps.beyond(tilt)
    limits = Limits(friction=friction)
    if program.mu.any():  # without friction, the limits of equilibrium are proved
        limits = Limits(
            tilt=tilt,
            about=None if axis is None or turned is None else (axis, turned[0]),
            friction=friction,
            factor=factor or (),
            force=question.push,
            pushes=pushes,
            loads=part_loads,
        )
    return {
        "program": program,
        "tilt": tilt,
        "tilt_deg": degrees,
        "tilt_down": down,
        "nearest": gravity if isinstance(gravity, NearestHeld) else None,
        "outside": outside,
        "at_level": steps.at_level(limits),
        "about": None if axis is None or turned is None else (axis, *turned),
        "friction": friction,
        "bond": bond,
        "load_factor": factor,
        "guaranteed": sure,
        "pushes": pushes,
        "loads": part_loads,
        "uncertainty": worst,
        "helps": steps.helps(tilt, None if factor is None else factor[1]),
        "edges": steps.edges,
        "missing": steps.missing,
        "warnings": tuple(warnings),
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
