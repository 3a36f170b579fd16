"""Margins: tilt, friction, load factor and pushes, with the motion that starts at each limit.

Every limit is that of equilibrium forces: beyond it no forces hold. If the assembly rests on
holds, whether it must hold below the limit is another question (`kilter.friction.answer`).
Contacts that are not modelled are left out; more contacts only raise a margin.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any, TypeVar

import numpy as np

from kilter.analysis.check import check
from kilter.analysis.decision.fitted_normals import fits_left_out
from kilter.analysis.margins.bond_factor import BondFactor, find_bond_factor
from kilter.analysis.margins.least_friction import LeastFriction, find_least_friction
from kilter.analysis.margins.limit_level import LevelTilt, find_level_tilt, verdict_outside
from kilter.analysis.margins.load_limit import (
    Limit,
    NoLimit,
    Why,
    find_limit,
    finite,
    gravity_wrench,
)
from kilter.analysis.margins.margin_proofs import margin_proofs
from kilter.analysis.margins.part_loads import PartLoad, find_part_load
from kilter.analysis.margins.pushes import Push, find_weakest_push
from kilter.analysis.margins.tilt import (
    NearestHeld,
    TiltMargin,
    find_nearest_held,
    find_tilt_margin,
    tilt_about,
)
from kilter.analysis.margins.uncertainty import Ranges, Uncertainty, find_uncertainty
from kilter.analysis.margins.what_helps import Help, what_helps
from kilter.analysis.open_pairs.open_question import open_pair_names, open_pairs_answer
from kilter.analysis.turning_tolerances import (
    ACROSS_GRAVITY,
)
from kilter.analysis.verdict.answers import joints_answer
from kilter.analysis.verdict.verdict import Verdict
from kilter.arrays import Array
from kilter.assembly import Assembly, require_assembly
from kilter.assembly.bonds import NO_CONE, NOT_RANGED, require_no_bonds
from kilter.contact import ContactSet, Tolerance
from kilter.errors import InputError, TimeLimitReached, some_names
from kilter.mechanics.bundle import make_bundle
from kilter.mechanics.coulomb_cones import cone_problem
from kilter.mechanics.opening import Opening
from kilter.mechanics.program import Program, build_program
from kilter.rigid import unit
from kilter.tell.levels import level_of, require_level
from kilter.threads import on_one_thread
from kilter.work import EFFORT, Work, stop_after, units_of

__all__ = ["PUSHED", "Margin", "margin"]


T = TypeVar("T")

PUSHED = 20
"""Free parts up to which every part's weakest push is sought where it is not asked for."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Margin:
    """How far an assembly is from falling.

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
    level_tilt : LevelTilt or None
        The tilt up to which the level `require` is reached, if it is above "equilibrium".
    require : str
    about : tuple of (float, Limit), or None
        Angle [rad] about the given axis, and the limit.
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

    assembly: Assembly
    contacts: ContactSet
    verdict: Verdict
    program: Program
    tilt: TiltMargin | None
    tilt_deg: float | None
    tilt_down: Array | None
    nearest: NearestHeld | None
    outside: str | None
    level_tilt: LevelTilt | None
    require: str
    about: tuple[float, Limit] | None
    friction: LeastFriction | None
    bond: BondFactor | None
    load_factor: tuple[Limit | None, Limit | None] | None
    guaranteed: tuple[Limit | None, Limit | None] | None
    pushes: tuple[Push, ...]
    loads: tuple[PartLoad, ...]
    push: Array | None
    missing: dict[str, Why]
    uncertainty: Uncertainty | None
    helps: tuple[Help, ...]
    warnings: tuple[str, ...]
    seconds: dict[str, float]

    def to_dict(self) -> dict[str, Any]:
        """The answer as JSON data, that of ``kilter margin --json``."""
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
            "exact": not self.verdict.contacts.open_pairs,
            "level": self.level,
            "require": self.require,
            "tilt_deg": self.tilt_deg,
            "tilt_outside": self.outside,
            "tilt_at_level": None if self.level_tilt is None else self.level_tilt.to_dict(),
            "tilt_lower_deg": None if tilt is None else float(np.degrees(tilt.lower)),
            "tilt_upper_deg": None
            if self.nearest is None
            else -float(np.degrees(self.nearest.lower)) + 0.0,
            "tilt_down": None if down is None else down.tolist(),
            "tilt_limit": None if tilt is None else tilt.limit.to_dict(program),
            "about": None
            if about is None
            else {"tilt_deg": finite(np.degrees(about[0])), "limit": about[1].to_dict(program)},
            "friction": None if friction is None else float(friction.value),
            "friction_limit": None if friction is None else friction.to_dict(program),
            "bond": None if self.bond is None or not self.bond.value else self.bond.value,
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
        """The level of the limits: "proved" without friction, else "equilibrium"."""
        return "equilibrium" if self.program.mu.any() else "proved"

    def proof(self, *, options: dict[str, Any] | None = None) -> dict[str, Any]:
        """Forces within each limit and a motion beyond it, for `kilter.verify`, as JSON data.

        Raises
        ------
        InputError
            If no limit is known.
        """
        return make_bundle("margin", margin_proofs(self, options=options or {}))

    def _bracket(self) -> dict[str, list[float | None] | None] | None:
        """Bounds of the limits without dilation; None if they were not requested."""
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
    """Least and greatest load factor; None if no factor is held."""
    least, greatest = factor
    return (
        None
        if least is None or greatest is None
        else [finite(-least.value), finite(greatest.value)]
    )


def _limit(program: Program, limit: Limit | None) -> dict[str, Any] | None:
    return None if limit is None else limit.to_dict(program)


@on_one_thread
def margin(
    assembly: Assembly,
    *,
    contacts: ContactSet | None = None,
    push: Any = None,
    about: Any = None,
    pushed: list[str] | None = None,
    loads: bool = False,
    ranges: Ranges | None = None,
    bracket: bool = False,
    require: str = "equilibrium",
    tolerance: Tolerance | None = None,
    effort: float = EFFORT,
    time_limit: float | None = None,
    progress: Callable[[str], None] | None = None,
) -> Margin:
    """Compute the margins of an assembly: tilt, least friction, load factor and pushes.

    Parameters
    ----------
    assembly : Assembly
    contacts : ContactSet, optional
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
        Above "equilibrium", `Margin.level_tilt` is the tilt up to which this level is reached.
    tolerance : Tolerance, optional
        When faces count as touching.
    effort, time_limit : float
        As in `kilter.check`, for the guarantee of friction.
    progress : callable, optional

    Raises
    ------
    InputError
        If a direction is of length zero, the axis is not across gravity, or a part is held or
        unknown, also one that a load pulls on; if `about` comes with bonds or loads, or `ranges`
        with bonds.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> round(margin(scene("tower")).friction.value, 6)
    0.0
    """
    tell = progress or (lambda stage: None)
    started = time.perf_counter()
    require_assembly(assembly, "margin")
    direction = None if push is None else unit(push, "push")
    require = require_level(require)
    axis = None if about is None else _axis(assembly, about)
    if axis is not None:
        _require_turnable(assembly)
    if ranges is not None:
        require_no_bonds(assembly, "the worst case over ranges", NOT_RANGED)
    parts = _pushed(assembly, pushed)
    verdict = check(
        assembly,
        contacts=contacts,
        tolerance=tolerance,
        effort=effort,
        time_limit=time_limit,
        progress=progress,
    )
    program = build_program(assembly, verdict.contacts)
    warnings = list(verdict.warnings)
    if verdict.contacts.open_pairs:
        left_out = open_pair_names(assembly, verdict.contacts)
        warnings.append(
            f"open pairs are left out; the margins may be larger if they hold: {left_out}"
        )
    warnings += fits_left_out(assembly, verdict.contacts, program)
    tell("tilt")
    missing: dict[str, Why] = {}
    limit = None if time_limit is None else time_limit - (time.perf_counter() - started)
    work = Work(units_of(effort), progress, time_limit=limit)

    def in_time(step: Callable[..., T], *arguments: Any) -> T | NoLimit:
        """The result of a step, or the reason that the time limit was reached."""
        try:
            with stop_after(work.seconds):
                return step(*arguments)
        except TimeLimitReached:
            return NoLimit("time")

    gravity = in_time(_tilt, program, warnings, missing)
    if isinstance(gravity, NoLimit):
        missing["tilt"], gravity = gravity.why, None
    tilt = gravity if isinstance(gravity, TiltMargin) else None
    nearest = gravity if isinstance(gravity, NearestHeld) else None
    degrees, down = _boundary(gravity)
    turned = None if axis is None else in_time(tilt_about, program, axis)
    tell("friction" if degrees is None else f"tilt {degrees:.6g} deg; friction")
    fitted = build_program(assembly, verdict.contacts, fitted=True)
    friction = in_time(find_least_friction, fitted)
    least = "" if isinstance(friction, NoLimit) else f"friction {friction.value:.6g}; "
    bond = in_time(find_bond_factor, program, verdict.contacts) if assembly.bonds else None
    tell(f"{least}load factor")
    factor = _both_ends(in_time(_load_factor, assembly, program, direction))
    smooth = program.frictionless
    sure = _both_ends(in_time(_load_factor, assembly, smooth, direction)) if bracket else None
    tell("pushes")
    opening = Opening(cone_problem(program))
    pushes = {}
    for part in parts:
        pushes[part] = in_time(partial(find_weakest_push, opening=opening), program, part)
        tell(f"pushes: {len(pushes)} of {len(parts)}")
    taken, loaded = {}, _pushed(assembly, pushed, most=None) if loads else []
    for part in loaded:
        taken[part] = in_time(partial(find_part_load, opening=opening), program, part)
        tell(f"loads: {len(taken)} of {len(loaded)}")
    asked: dict[str, object] = {"about": turned, "friction": friction, "bond": bond}
    asked |= {f"push of {program.names[part]}": push for part, push in pushes.items()}
    asked |= {f"load on {program.names[part]}": load for part, load in taken.items()}
    missing |= {what: result.why for what, result in asked.items() if isinstance(result, NoLimit)}
    for what, ends in (("load_factor", factor), ("bracket", sure)):
        whys = [end.why for end in ends or () if isinstance(end, NoLimit)]
        if whys:
            missing[what] = next(why for why in ("time", "failed", "none") if why in whys)
    warnings += _missing_words(missing)
    if pushed is None and int(program.free.sum()) > PUSHED:
        warnings.append(
            f"the pushes, and the gain of holding a part, are left out above {PUSHED} free parts;"
            " --part NAME computes those of a part"
        )
    worst = in_time(_worst, program, ranges, direction, warnings, tell)
    if isinstance(worst, NoLimit):
        missing["uncertainty"], worst = worst.why, None
    greatest = None if factor is None else _known(factor[1])
    outside, level_tilt = None, None
    if tilt is not None and down is not None:
        touching, toward = verdict.contacts, tilt.toward
        outside = _known(in_time(verdict_outside, assembly, touching, tilt.angle, toward, work))
        if require != "equilibrium" and level_of(verdict.verdict) not in (None, "equilibrium"):
            tell(f"tilt at the level {require}")
            level_tilt = _known(
                in_time(find_level_tilt, assembly, verdict.contacts, down, require, work)
            )
    helps = in_time(partial(what_helps, held=parts), program, tilt, greatest, direction)
    if isinstance(helps, NoLimit):
        missing["what helps"], helps = helps.why, ()
    seconds = {**verdict.seconds, "total": time.perf_counter() - started}
    return Margin(
        assembly=assembly,
        contacts=verdict.contacts,
        verdict=verdict,
        program=program,
        tilt=tilt,
        tilt_deg=degrees,
        tilt_down=down,
        nearest=nearest,
        outside=outside,
        level_tilt=level_tilt,
        require=require,
        about=_known(turned),
        friction=_known(friction),
        bond=_known(bond),
        load_factor=None if factor is None else (_known(factor[0]), _known(factor[1])),
        guaranteed=None if sure is None else (_known(sure[0]), _known(sure[1])),
        pushes=tuple(push for push in pushes.values() if isinstance(push, Push)),
        loads=tuple(load for load in taken.values() if isinstance(load, PartLoad)),
        push=direction,
        missing=missing,
        uncertainty=worst,
        helps=helps,
        warnings=tuple(warnings),
        seconds=seconds,
    )


def _known(limit: T | NoLimit | None) -> T | None:
    """A limit; None if there is no limit."""
    return None if isinstance(limit, NoLimit) else limit


def _both_ends(
    ends: tuple[Limit | NoLimit, Limit | NoLimit] | NoLimit | None,
) -> tuple[Limit | NoLimit, Limit | NoLimit] | None:
    """Both ends of a load factor, each with the same reason if neither is known."""
    return (ends, ends) if isinstance(ends, NoLimit) else ends


def _missing_words(missing: dict[str, Why]) -> list[str]:
    """Warnings about limits without a value, and about an assembly that resists no push."""
    failed = [what for what, why in missing.items() if why == "failed"]
    words = [f"not known, because the solver failed: {some_names(failed)}"] if failed else []
    late = [what for what, why in missing.items() if why == "time"]
    words += [f"not known, because the time limit was reached: {some_names(late)}"] if late else []
    if any(
        what.startswith(("push of", "load on")) and why == "none" for what, why in missing.items()
    ):
        words.append("it is not in equilibrium as given, so it resists no push and no load")
    return words


def _axis(assembly: Assembly, about: Any) -> Array:
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
    """Reject a tilt about an axis with loads or bonds, which do not turn with gravity."""
    require_no_bonds(assembly, "a tilt about an axis", NO_CONE)
    if assembly.loads:
        raise InputError(
            "a tilt about an axis is not defined with loads: they do not turn with gravity",
            file=assembly.source or None,
            part=assembly.loads[0].part,
            hint="leave the loads out, or compute the margins without an axis",
        )


def _pushed(assembly: Assembly, names: list[str] | None, *, most: int | None = PUSHED) -> list[int]:
    """The named parts; without names all free parts, if there are at most `most` of them."""
    free = [k for k, part in enumerate(assembly.parts) if not part.grounded]
    if names is None:
        return free if most is None or len(free) <= most else []
    chosen = []
    for name in names:
        k = assembly.index_of(name)
        if assembly.parts[k].grounded:
            raise InputError("it is held, so no push moves it", part=name, hint="name a free part")
        chosen.append(k)
    return chosen


def _worst(
    program: Program,
    ranges: Ranges | None,
    push: Array | None,
    warnings: list[str],
    tell: Callable[[str], None],
) -> Uncertainty | None:
    """The worst case over the intervals, with a warning if it was not computed."""
    if ranges is None:
        return None
    tell("uncertainty")
    worst = find_uncertainty(program, ranges, push=push)
    if worst is None:
        warnings.append(
            "no worst case: there are too many parts and contacts for intervals of masses or"
            " centres; without --mass-range and --com-range there is no such limit"
        )
    return worst


def _tilt(
    program: Program, warnings: list[str], missing: dict[str, Why]
) -> TiltMargin | NearestHeld | None:
    """The tilt margin, or the nearest held direction if gravity as given is not held."""
    if program.applied.any():
        warnings.append("no tilt margin: given loads do not turn with gravity")
        return None
    if program.has_strength:
        warnings.append("no tilt margin: bond forces do not turn with gravity")
        return None
    tilt = find_tilt_margin(program)
    if isinstance(tilt, TiltMargin):
        return tilt
    nearest = find_nearest_held(program)
    if tilt.why == "failed" or isinstance(nearest, NoLimit):
        missing["tilt"] = nearest.why if isinstance(nearest, NoLimit) else tilt.why
        return None
    return nearest


def _boundary(gravity: TiltMargin | NearestHeld | None) -> tuple[float | None, Array | None]:
    """The turn to the boundary, negative from outside [deg], and the direction there."""
    if gravity is None:
        return None, None
    if isinstance(gravity, NearestHeld):
        return -float(np.degrees(gravity.angle)), gravity.down
    fails = gravity.angle < np.pi / 2
    return float(np.degrees(gravity.angle)), gravity.down if fails else None


def _load_factor(
    assembly: Assembly, program: Program, direction: Array | None
) -> tuple[Limit | NoLimit, Limit | NoLimit] | None:
    """Least and greatest factor of a body force, or of the given loads."""
    if direction is not None:
        base, wrench = program, gravity_wrench(program, direction)
    elif assembly.loads:
        base = program.with_rows(applied=np.zeros_like(program.applied))
        wrench = program.applied
    else:
        return None
    ends = find_limit(base, -wrench), find_limit(base, wrench)
    whys = {end.why for end in ends if isinstance(end, NoLimit)}
    return (NoLimit("none"), NoLimit("none")) if whys == {"none", "failed"} else ends
