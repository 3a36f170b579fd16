"""Margins: tilt, friction, load factor and pushes, with the motion that starts at each limit.

Every limit is that of equilibrium forces: beyond it no forces hold. If the assembly rests on
holds, whether it must hold below the limit is another question (`kilter.friction.answer`).
Contacts that are not modelled are left out; more contacts only raise a margin.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from kilter.analysis.check import check
from kilter.analysis.decision.cascade import fits_left_out
from kilter.analysis.decision.open_question import open_pair_names
from kilter.analysis.load_limit import Limit
from kilter.analysis.margins.level_limits import Limits
from kilter.analysis.margins.make_stand import find_standing, require_standable
from kilter.analysis.margins.margin_answer import Bracket, Margin
from kilter.analysis.margins.margin_steps import MarginQuestion, MarginSteps, margin_question
from kilter.analysis.margins.tilt import NearestHeld, TiltMargin, tilt_about
from kilter.analysis.margins.uncertainty import Ranges
from kilter.analysis.verdict.verdict import Verdict
from kilter.arrays import Array
from kilter.assembly import Assembly
from kilter.assembly.question import Question, question
from kilter.contact import ContactSet
from kilter.mechanics.program import Program, build_program
from kilter.tell.levels import REQUIRE
from kilter.tell.record import (
    Ends,
)

STAND_TILT = 2.0
"""Default of the tilt margin of an assembly that is made to stand [deg]."""


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
    pushes: bool = False,
    pushed: list[str] | None = None,
    loads: bool = False,
    ranges: Ranges | None = None,
    bracket: bool = False,
    improve: bool = False,
    make_stand: Sequence[str] | None = None,
    stand_tilt_deg: float = STAND_TILT,
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
    pushes : bool
        Also the weakest push of each free part. Of more than 50 parts, those that move most
        easily.
    pushed : list of str, optional
        Only the pushes of these parts; with `improve`, only these parts are held in turn.
    loads : bool
        Also the load straight down that each free part takes, or each of `pushed`.
    ranges : Ranges, optional
        Also the worst tilt margin and load factor over these intervals.
    bracket : bool
        Also the load factors up to which no motion that obeys the contact law can start.
    improve : bool
        Also changes of the assembly that raise the tilt margin most, each tried; without a tilt
        margin those for the load factor, or for the least friction.
    make_stand : list of {"move", "mass", "size", "friction"}, optional
        Also the least change of these kinds after which the assembly stands: parts moved along
        their contacts, other masses, larger sizes across the contacts, more friction.
    stand_tilt_deg : float
        Tilt margin with which it then stands [deg].
    require : {"equilibrium", "settles", "proved"}
        Level from which the answer is yes. Above "equilibrium", `Margin.at_level` has the values up
        to which this level is reached. The default is lower than that of `check`, because each
        further value is a search.

    Raises
    ------
    InputError
        If a direction is of length zero, the axis is not across gravity, or a part is held or
        unknown, also one that a load pulls on; if `about` comes with bonds or loads, or `ranges`
        with bonds; if a kind of change is unknown, or `make_stand` comes with bonds, straps, joints
        or loads.

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
        pushes=pushes,
        pushed=pushed,
        loads=loads,
        ranges=ranges,
        bracket=bracket,
        improve=improve,
        require=asked.require,
    )
    kinds = None if make_stand is None else require_standable(question.assembly, make_stand)
    verdict = check(asked.but(require=REQUIRE))
    steps, limits = _limits(question, verdict, asked)
    answer = Margin(
        assembly=asked.assembly,
        contacts=verdict.contact_set,
        check=verdict,
        verdict=verdict.verdict,
        sentence=verdict.sentence,
        guarantee=verdict.guarantee,
        require=question.require,
        push=question.push,
        clamped_by=tuple(name for name in ("bonds", "straps") if getattr(asked.assembly, name)),
        improvements=(),
        made_stand=None,
        seconds=verdict.seconds,
        **limits,
    )
    improvements = steps.tried_changes(answer.gradient, verdict.contact_set, answer.bond_limit)
    made = None
    if kinds is not None:
        find = partial(find_standing, kinds=kinds, tilt_deg=stand_tilt_deg, work=steps.work)
        made = steps.limit("make stand", find, asked.assembly, verdict.contact_set)
    seconds = {**verdict.seconds, "total": time.perf_counter() - asked.begun}
    return replace(
        answer,
        improvements=improvements,
        made_stand=made,
        warnings=tuple(steps.warnings),
        seconds=seconds,
    )


def _limits(
    question: MarginQuestion, verdict: Verdict, asked: Question
) -> tuple[MarginSteps, dict[str, Any]]:
    """Compute the limits of a margin: the members of `Margin` that need a program."""
    assembly, tell = question.assembly, asked.tell
    program = build_program(assembly, verdict.contact_set)
    warnings = [*verdict.notes, *_left_out(assembly, verdict.contact_set, program)]
    steps = MarginSteps(
        work=asked.work(),
        tell=tell,
        keeps=getattr(asked.progress, "keeps", False),
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
        about = steps.limit("about", tilt_about, steps.groups, question.axis)
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
    return steps, {
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
        "edges": steps.edges,
        "missing": steps.missing,
        "warnings": (),
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
