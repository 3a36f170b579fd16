"""Margins of a verdict level above equilibrium: tilt, friction, load factor, pushes, part loads.

Each limit of `kilter.margin` is a limit of equilibrium. With `require` above "equilibrium", the
answer adds for each limit the value up to which `kilter.check` reaches that level. The search goes
from the assembly as drawn along the way to the limit (`limit_level.find_level_end`). The least
friction is approached from a larger coefficient that reaches the level.

All searches together may take `SHARE` times the work of a check; each gets an equal share.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from kilter.analysis.load_limit import Limit
from kilter.analysis.margins.least_friction import LeastFriction
from kilter.analysis.margins.limit_level import NEAR, LevelDecisions, LevelLimit, find_level_end
from kilter.analysis.margins.part_limits import PartLoad, Push
from kilter.analysis.margins.tilt import TiltAbout, TiltMargin
from kilter.arrays import Array, cross
from kilter.assembly import Assembly
from kilter.assembly.interactions import Load
from kilter.contact import ContactSet, detect
from kilter.errors import some_names
from kilter.tell.record import LevelWord, Record
from kilter.work import Work

SHARE = 5.0
"""Work of all searches together, in units of the work of a check [-]."""
LEAST_UNITS = 100_000.0
"""Smallest work of a check that is counted, also with effort 0 [units]."""
ROUGHER = (1.0 + NEAR, 1.5, 3.0, 10.0)
"""Friction coefficients that are decided first, as multiples of the least coefficient [-]."""
SMALL_MU = 0.1
"""Replaces the least coefficient in these multiples if every positive coefficient holds [-]."""

ENDED = {
    "effort": "the work limit was reached before {limits} were found: {names} (a higher --effort "
    "allows more)",
    "time": "the time limit was reached before {limits} were found: {names}",
}
"""Words of limits whose search ended without a value, by the reason."""


@dataclass(frozen=True, slots=True, eq=False)
class Limits:
    """The margins of equilibrium, from which the margins of a higher verdict level are computed."""

    tilt: TiltMargin | None = None
    about: TiltAbout | None = None
    friction: LeastFriction | None = None
    factor: tuple[Limit | None, ...] = ()
    """Least and greatest load factor, the least with the opposite sign; empty without loads."""
    force: Array | None = None
    """Direction of the body force of the load factor, shape (3,); None for the given loads."""
    pushes: Sequence[Push] = ()
    loads: Sequence[PartLoad] = ()


class LevelLimits(Record):
    """For each margin, the limit up to which the assembly reaches the required level.

    None if there is no such limit of equilibrium.
    """

    level: LevelWord
    """"settles" or "proved"."""
    tilt_deg: LevelLimit | None = None
    """Tilt [deg]."""
    about_deg: LevelLimit | None = None
    """Turn about the given axis [deg]."""
    friction: LevelLimit | None = None
    """Coefficient [-]; `inside` is the larger coefficient."""
    load_factor: tuple[LevelLimit, ...] | None = None
    """Least and greatest load factor [-]."""
    pushes: dict[str, LevelLimit] = field(default_factory=dict)
    """Push by part [N]."""
    loads: dict[str, LevelLimit] = field(default_factory=dict)
    """Additional load by part [N]."""

    def unknown_words(self) -> list[str]:
        """Warnings that name all limits whose search ended without a value, one a reason.

        Examples
        --------
        >>> ended = LevelLimit(why="effort")
        >>> limits = LevelLimits(level="settles", tilt_deg=ended, pushes={"a": ended, "b": ended})
        >>> (words,) = limits.unknown_words()
        >>> words.removeprefix("the work limit was reached before these limits at the level ")
        "settles were found: 'tilt', 'push of a', 'push of b' (a higher --effort allows more)"
        """
        named = [
            *(("tilt", self.tilt_deg), ("tilt about the axis", self.about_deg)),
            ("friction", self.friction),
            *(("load factor", end) for end in self.load_factor or ()),
            *((f"push of {part}", push) for part, push in self.pushes.items()),
            *((f"load on {part}", load) for part, load in self.loads.items()),
        ]
        words = []
        for why, cause in ENDED.items():
            ended = [name for name, limit in named if limit is not None and limit.why == why]
            if ended:
                limits = f"these limits at the level {self.level}"
                names = some_names(list(dict.fromkeys(ended)))
                words.append(cause.format(limits=limits, names=names))
        return words


def find_level_limits(
    assembly: Assembly,
    contacts: ContactSet,
    limits: Limits,
    *,
    level: str,
    units: float,
    work: Work,
) -> LevelLimits:
    """Find how far gravity and loads may change before an assembly misses a verdict level."""
    allowed = SHARE * max(units, LEAST_UNITS)
    search = _LevelSearch(assembly, contacts, LevelDecisions(level, units, work.beside(allowed)))
    steps = search.steps(limits)
    drawn = None
    if any(name != "friction" for name, _ in steps):
        drawn = search.decisions.reach(assembly, contacts)
    results: dict[Any, LevelLimit] = {}
    for done, (name, step) in enumerate(steps):
        if name != "friction" and not drawn:
            results[name] = LevelLimit(why="none")
        elif search.decisions.work.over:
            results[name] = search.decisions.no_limit()
        else:
            results[name] = step(search.decisions.share(1.0 / (len(steps) - done)))
    ends = [results[key] for key in (("factor", 0), ("factor", 1)) if key in results]
    return LevelLimits(
        level=level,
        tilt_deg=results.get("tilt"),
        about_deg=results.get("about"),
        friction=results.get("friction"),
        load_factor=tuple(ends) or None,
        pushes={push.part: results["push", push.part] for push in limits.pushes},
        loads={load.part: results["load", load.part] for load in limits.loads},
    )


_Step = tuple[Any, Callable[[LevelDecisions], LevelLimit]]
"""Key of a limit, and the function that finds it with a share of the work."""


@dataclass(frozen=True, slots=True, eq=False)
class _LevelSearch:
    """Searches for the margins of a verdict level; each starts from the assembly as drawn."""

    assembly: Assembly
    contacts: ContactSet
    decisions: LevelDecisions

    def steps(self, limits: Limits) -> list[_Step]:
        """The searches to run, each with the key of its margin."""
        steps: list[_Step] = []
        down = self.assembly.down
        tilt, friction = limits.tilt, limits.friction
        if tilt is not None and tilt.toward.any():
            steps.append(("tilt", self._turn(tilt.toward, tilt.angle)))
        if limits.about is not None:
            angle = min(float(np.radians(limits.about.tilt_deg)), 2 * np.pi)
            steps.append(("about", self._turn(cross(limits.about.axis, down), angle)))
        if friction is not None:
            steps.append(("friction", lambda share: self._least_friction(friction, share)))
        if len(limits.factor) == 2 and None not in limits.factor:
            first = 0.0 if limits.force is not None else 1.0
            for side, sign in ((0, -1.0), (1, 1.0)):
                end = limits.factor[side]
                assert end is not None
                steps.append((("factor", side), self._factor(limits.force, first, sign, end.value)))
        for push in limits.pushes:
            step = self._pushed(push.part, push.direction, push.force)
            steps.append((("push", push.part), step))
        for load in limits.loads:
            steps.append((("load", load.part), self._pushed(load.part, down, load.load)))
        return steps

    def _turn(self, toward: Array, angle: float) -> Callable[[LevelDecisions], LevelLimit]:
        """Create the search over tilts of gravity toward a horizontal direction, from 0 to `angle`.

        The angle is in radians; the search returns degrees.
        """
        start = self.assembly.down

        def step(share: LevelDecisions) -> LevelLimit:
            def reaches(turn: float) -> bool:
                down = np.cos(turn) * start + np.sin(turn) * toward
                return share.reach(self.assembly.with_down(down), self.contacts)

            limit = find_level_end(share, reaches, angle)
            inside, outside = np.degrees([limit.inside, limit.outside]).tolist()
            return replace(limit, inside=inside, outside=outside)

        return step

    def _factor(
        self, force: Array | None, first: float, sign: float, end: float
    ) -> Callable[[LevelDecisions], LevelLimit]:
        """Create the search over load factors, from the given factor to `sign` times `end`."""
        assembly = self.assembly
        size = float(np.linalg.norm(assembly.gravity))

        def step(share: LevelDecisions) -> LevelLimit:
            def reaches(more: float) -> bool:
                factor = first + sign * more
                if force is not None:
                    other = replace(assembly, gravity=assembly.gravity + factor * size * force)
                else:
                    loads = [
                        replace(load, force=factor * load.force, torque=factor * load.torque)
                        for load in assembly.loads
                    ]
                    other = replace(assembly, loads=loads)
                return share.reach(other, self.contacts)

            limit = find_level_end(share, reaches, max(end - sign * first, 0.0))
            inside, outside = first + sign * limit.inside, first + sign * limit.outside
            return replace(limit, inside=inside, outside=outside)

        return step

    def _pushed(
        self, part: str, direction: Array, force: float
    ) -> Callable[[LevelDecisions], LevelLimit]:
        """Create the search over pushes on a part in a direction, from 0 to `force` [N]."""
        assembly = self.assembly
        weight = float(np.linalg.norm(assembly.gravity)) * float(assembly.geometry.mass.sum())

        def step(share: LevelDecisions) -> LevelLimit:
            def reaches(size: float) -> bool:
                load = Load(part, force=size * direction)
                return share.reach(replace(assembly, loads=[*assembly.loads, load]), self.contacts)

            return find_level_end(share, reaches, force, size=weight)

        return step

    def _least_friction(self, friction: LeastFriction, share: LevelDecisions) -> LevelLimit:
        """Find the least friction coefficient that reaches the verdict level."""
        least = float(friction.value)
        if least == 0.0 and friction.attained:  # equilibrium without friction is proved
            return LevelLimit(inside=0.0, outside=0.0)
        unit = least if least > 0.0 else SMALL_MU
        given = [float(mu) for mu in np.unique(self.contacts.patch_mu) if mu > least]
        tried = sorted({*given[:1], *(unit * more for more in ROUGHER)})
        below = least
        for top in tried:
            if share.work.over:
                return share.no_limit()
            if share.reach(*self._rough(top)):
                break
            below = top
        else:
            return LevelLimit(why="none")
        if top <= least * (1 + NEAR):
            return LevelLimit(inside=least, outside=least)
        limit = find_level_end(
            share, lambda less: share.reach(*self._rough(top - less)), top - below
        )
        return replace(limit, inside=top - limit.inside, outside=top - limit.outside)

    def _rough(self, mu: float) -> tuple[Assembly, ContactSet]:
        """Copy of the assembly with friction `mu` at every contact, and its contacts."""
        assembly = replace(self.assembly, friction=mu, friction_pairs=())
        if self.assembly.contacts:  # their own coefficients would remain
            return assembly, self.contacts.with_friction(mu)
        return assembly, detect.detected_with_friction(self.contacts, mu)
