"""By how much: tilt, friction, load factor and pushes, with what starts at each limit.

Every limit is that of equilibrium forces: above it nothing holds. Where friction is what
holds, whether it must hold below the limit is another question (`kilter.friction.answer`).
Contacts that are not modelled are left out; more contacts only raise a margin.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from kilter.analysis.check import check
from kilter.analysis.margins.least_friction import LeastFriction, find_least_friction
from kilter.analysis.margins.load_limit import Limit, find_limit
from kilter.analysis.margins.pushes import Push, find_weakest_push
from kilter.analysis.margins.tilt import (
    TiltMargin,
    find_nearest_held,
    find_tilt_margin,
    gravity_wrench,
    tilt_about,
)
from kilter.analysis.margins.uncertainty import Ranges, Uncertainty, find_uncertainty
from kilter.analysis.margins.what_helps import Help, what_helps
from kilter.analysis.verdict import Verdict
from kilter.arrays import Array
from kilter.assembly import Assembly
from kilter.contact import ContactSet, Tolerance
from kilter.errors import InputError
from kilter.mechanics.coulomb_cones import spread
from kilter.mechanics.program import Program, build_program
from kilter.rigid import unit

__all__ = ["PUSHED", "Margin", "find_margin"]


PUSHED = 20
"""Free parts up to which every part's weakest push is sought where it is not asked for."""
ACROSS = 1e-9
"""A tilt axis is across gravity up to this cosine."""


@dataclass(frozen=True, eq=False)
class Margin:
    """How far an assembly is from falling.

    Attributes
    ----------
    verdict : Verdict
    program : Program
        The modelled contacts, with friction.
    tilt : TiltMargin or None
        None where gravity as given is not held, or where there are loads, or it is thinner
        than a cone.
    tilt_deg : float or None
        Least turn of gravity to the boundary; negative when outside.
    tilt_down : ndarray, shape (3,), or None
        Direction of gravity there.
    about : tuple of (float, Limit or None), or None
        Angle [rad] about the axis that was asked for, and the limit.
    friction : LeastFriction or None
        None where none is enough.
    load_factor : tuple of Limit or None, or None
        Least and greatest; None where no loads were asked about.
    guaranteed : tuple of Limit or None, or None
        Least and greatest factor that are held however slippery the parts: with sliding that
        does not dilate (not associative) the limits lie between these and `load_factor`.
        None where it was not asked for.
    pushes : tuple of Push
    uncertainty : Uncertainty or None
        The worst case over `ranges`; None where none were given, or it is too large.
    helps : tuple of Help
        What would raise the tilt margin, or else the greatest load factor, most.
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
    about: tuple[float, Limit | None] | None
    friction: LeastFriction | None
    load_factor: tuple[Limit | None, Limit | None] | None
    guaranteed: tuple[Limit | None, Limit | None] | None
    pushes: tuple[Push, ...]
    uncertainty: Uncertainty | None
    helps: tuple[Help, ...]
    warnings: tuple[str, ...]
    seconds: dict[str, float]

    def to_dict(self) -> dict[str, Any]:
        """The answer as JSON data."""
        from kilter.analysis.margins.margin_answers import margin_answer

        return margin_answer(self)


def find_margin(
    assembly: Assembly,
    contacts: ContactSet | None = None,
    *,
    push: Any = None,
    about: Any = None,
    pushed: list[str] | None = None,
    ranges: Ranges | None = None,
    bracket: bool = False,
    tolerance: Tolerance | None = None,
    budget: float = 1.0,
    progress: Callable[[str], None] | None = None,
) -> Margin:
    """By how much an assembly holds, or does not.

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
        Parts whose weakest push is sought; where not given all, up to `PUSHED` free parts.
    ranges : Ranges, optional
        Also the worst tilt margin and load factor over these intervals.
    bracket : bool
        Also the load factors up to which no motion that obeys the contact law can start.
    tolerance : Tolerance, optional
        When faces count as touching.
    budget : float
        For what friction guarantees [s].
    progress : callable, optional

    Raises
    ------
    InputError
        If a direction is of length zero, the axis is not across gravity, or a part is held or
        unknown, also one that a load pulls on.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> round(find_margin(scene("tower")).friction.value, 6)
    0.0
    """
    tell = progress or (lambda stage: None)
    started = time.perf_counter()
    direction = None if push is None else unit(push, "push")
    axis = None if about is None else _axis(assembly, about)
    parts = _pushed(assembly, pushed)
    _require_loads_on_free_parts(assembly)
    verdict = check(
        assembly, contacts=contacts, tolerance=tolerance, budget=budget, progress=progress
    )
    program = build_program(assembly, verdict.contacts)
    warnings = list(verdict.warnings)
    if verdict.contacts.unsupported:
        warnings.append("contacts that are not modelled are left out: margins may be larger")
    tell("tilt")
    tilt, degrees, down = _tilt(program, warnings)
    turned = None if axis is None else tilt_about(program, axis)
    tell("friction")
    friction = find_least_friction(program)
    tell("load factor")
    factor = _load_factor(assembly, program, direction)
    sure = _load_factor(assembly, program.frictionless, direction) if bracket else None
    tell("pushes")
    wide = spread(program)
    found = [find_weakest_push(program, part, wide=wide) for part in parts]
    worst = _worst(program, ranges, direction, warnings, tell)
    greatest = None if factor is None else factor[1]
    helps = what_helps(program, tilt, greatest, direction)
    seconds = {**verdict.seconds, "total": time.perf_counter() - started}
    return Margin(
        assembly=assembly,
        contacts=verdict.contacts,
        verdict=verdict,
        program=program,
        tilt=tilt,
        tilt_deg=degrees,
        tilt_down=down,
        about=turned,
        friction=friction,
        load_factor=factor,
        guaranteed=sure,
        pushes=tuple(p for p in found if p is not None),
        uncertainty=worst,
        helps=helps,
        warnings=tuple(warnings),
        seconds=seconds,
    )


def _axis(assembly: Assembly, about: Any) -> Array:
    axis = unit(about, "axis of the tilt")
    if abs(float(axis @ assembly.down)) > ACROSS:
        raise InputError(
            f"the axis {axis.tolist()} is not across gravity", hint="give a horizontal axis"
        )
    if assembly.planar and abs(abs(float(axis[1])) - 1) > ACROSS:
        raise InputError("the axis leaves the plane", hint="give 0 1 0 where planar")
    return axis


def _pushed(assembly: Assembly, names: list[str] | None) -> list[int]:
    free = [k for k, part in enumerate(assembly.parts) if not part.grounded]
    if names is None:
        return free if len(free) <= PUSHED else []
    chosen = []
    for name in names:
        k = assembly.index_of(name)
        if assembly.parts[k].grounded:
            raise InputError("it is held: no push moves it", part=name, hint="name a free part")
        chosen.append(k)
    return chosen


def _require_loads_on_free_parts(assembly: Assembly) -> None:
    for load in assembly.loads:
        if assembly.parts[assembly.index_of(load.part)].grounded:
            raise InputError(
                "a load on it is without effect: it is held",
                part=load.part,
                hint="give the load to a free part",
            )


def _worst(
    program: Program,
    ranges: Ranges | None,
    push: Array | None,
    warnings: list[str],
    tell: Callable[[str], None],
) -> Uncertainty | None:
    """The worst case over the intervals, with a warning where it is none."""
    if ranges is None:
        return None
    tell("uncertainty")
    worst = find_uncertainty(program, ranges, push=push)
    if worst is None:
        warnings.append("too many parts and contacts for masses or centres within intervals")
    return worst


def _tilt(
    program: Program, warnings: list[str]
) -> tuple[TiltMargin | None, float | None, Array | None]:
    """The margin, in degrees, and the direction at the boundary."""
    if program.applied.any():
        warnings.append("given loads do not turn with gravity: no tilt margin")
        return None, None, None
    tilt = find_tilt_margin(program)
    if tilt is not None:
        return tilt, float(np.degrees(tilt.angle)), tilt.down
    nearest = find_nearest_held(program)
    if nearest is None:
        return None, None, None
    return None, -float(np.degrees(nearest[0])), nearest[1]


def _load_factor(
    assembly: Assembly, program: Program, direction: Array | None
) -> tuple[Limit | None, Limit | None] | None:
    """Least and greatest factor of a body force, or of the given loads."""
    if direction is not None:
        base, wrench = program, gravity_wrench(program, direction)
    elif assembly.loads:
        base = program.with_rows(applied=np.zeros_like(program.applied))
        wrench = program.applied
    else:
        return None
    return find_limit(base, -wrench), find_limit(base, wrench)
