"""The decision on a part at a given place, and the heaviest mass that is carried there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from kilter.analysis.check import check
from kilter.analysis.load_limit import Limit, find_limit
from kilter.analysis.placing.default_density import density_matters
from kilter.analysis.placing.uncertain_part import part_cases
from kilter.analysis.placing.upright_prisms import Top, placed_prism, shifted
from kilter.analysis.verdict.verdict import Verdict
from kilter.assembly import Assembly, Part
from kilter.assembly.masses import density_warnings
from kilter.assembly.question import Question
from kilter.contact import detect
from kilter.errors import InputError
from kilter.mechanics.mechanics_tolerances import TOLERANCE
from kilter.mechanics.program import Program, build_program
from kilter.rigid import Pose
from kilter.tell.levels import level_rank
from kilter.tell.record import InPython, Record, key
from kilter.validate import finite

__all__ = ["AtPlace", "decide_at"]


class AtPlace(Record):
    """The decision on the part at a given place."""

    x: float
    """Centre of the part, world frame [length unit]."""
    y: float
    """Centre of the part, world frame [length unit]."""
    height: float
    """Height of the centre of the part [length unit]."""
    heaviest: float | None
    """Largest mass that is carried there, with each centre [kg]; null: not known, or no limit."""
    part: InPython[Part]
    """The part at the place."""
    verdicts: InPython[tuple[Verdict, ...]]
    """`kilter.check` of the assembly with the part: a verdict, or one for each corner of its
    masses and centres."""

    @property
    def worst(self) -> Verdict:
        """The worst verdict: unstable, then undecided, then the lowest level."""
        words = ("unstable", "undecided")
        return min(
            self.verdicts,
            key=lambda verdict: (
                words.index(verdict.verdict) if verdict.verdict in words else len(words),
                level_rank(verdict.level),
            ),
        )

    @property
    @key
    def verdict(self) -> str:
        """Word of the worst verdict."""
        return self.worst.verdict

    @property
    @key
    def level(self) -> str | None:
        """Level at the place for all masses and centres.

        Corners decide equilibrium for all of them. Without friction equilibrium is a proof.
        """
        level = self.worst.level
        if len(self.verdicts) == 1:
            return level
        most = "equilibrium" if (self.worst.contact_set.patch_mu > 0).any() else "proved"
        return min(level, most, key=level_rank)

    @property
    @key
    def moving(self) -> list[str]:
        """Parts that move."""
        return list(self.worst.moving)

    @property
    @key
    def unlimited(self) -> bool:
        """Whether any mass is carried."""
        return self.heaviest is not None and not np.isfinite(self.heaviest)

    def remarks(self, base: Assembly) -> tuple[str, ...]:
        """Warnings about the assembly with the part.

        The warning about the default density is left out if the verdict and the heaviest mass do
        not depend on it, unless the assembly without the part (`base`) has this warning, too.
        """
        remarks = self.worst.contact_set.warnings
        idle = set(density_warnings(self.worst.assembly.parts)) - {*base.geometry.warnings}
        limited = self.heaviest is not None and 0.0 < self.heaviest < np.inf
        if not idle or limited or any(map(density_matters, self.verdicts)):
            return remarks
        return tuple(remark for remark in remarks if remark not in idle)


def decide_at(
    asked: Question,
    part: Part,
    mass: tuple[float, float],
    center_within: float,
    tops: Sequence[Top],
    at: Any,
) -> AtPlace:
    """Decide whether a part stands with its centre of mass at a place, and how heavy it may be.

    `mass` [kg] and `center_within` are limits of its mass and centre of mass, as in `part_cases`.
    """
    assembly, quiet = asked.assembly, asked.but(progress=None, contacts=None)
    x, y = finite(at, (2,), "place").tolist()
    alone = Assembly([part], units=assembly.units)
    height = _lowered(assembly, alone, tops, x, y)
    shift = np.array([x, y, height]) - alone.geometry.center[0]
    pose = Pose(np.asarray(part.pose.position) + shift, part.pose.rotation)
    part = replace(part, pose=pose)
    verdicts, heaviest = [], []
    for case in part_cases(part, mass, center_within):
        whole = assembly.with_parts([case])
        contacts = detect.contacts(quiet.but(assembly=whole))
        verdicts.append(check(quiet.but(assembly=whole, contacts=contacts)))
        heaviest.append(_heaviest(build_program(whole, contacts), part.name))
    known = [mass for mass in heaviest if mass is not None]
    least = min(known) if len(known) == len(heaviest) else None
    return AtPlace(x=x, y=y, height=height, heaviest=least, part=part, verdicts=tuple(verdicts))


def _lowered(assembly: Assembly, alone: Assembly, tops: Sequence[Top], x: float, y: float) -> float:
    """Height of the centre of the part when it is lowered onto upright tops at a place.

    Raises an `InputError` if nothing or a part of another form is below it.
    """
    prism = placed_prism(alone)
    if prism is None:
        raise InputError(
            "only a box or another upright convex prism can be lowered", hint="give a box"
        )
    under = shifted(prism.footprint, (x, y))
    met = [top for top in tops if top.polygon.intersection(under).area > 0]
    if not met:
        raise InputError(
            f"nothing is below the part at {x:g}, {y:g}", hint="give a place above a part"
        )
    highest = max(met, key=lambda top: top.high)
    if not highest.upright:
        raise InputError(
            "the part below has no level top, so the height of the part is not known",
            part=assembly.names[highest.part],
            hint="add the part to the file at its height, and call check",
        )
    return highest.high + prism.below


def _heaviest(program: Program, name: str) -> float | None:
    """Largest mass of a part that is carried [kg]; infinite without a limit, None if unknown.

    0 if the largest mass is below the share of the weight that a certificate tolerates.
    """
    k = program.names.index(name)
    weight = np.zeros((len(program.names), 6))
    weight[k, :3] = program.mass[k] * program.gravity
    # the load of the part itself is share 0
    limit = find_limit(program, weight)
    if not isinstance(limit, Limit):
        return None
    share = 1 + limit.value
    if share < -TOLERANCE:
        return None
    return float(program.mass[k] * share) if share > TOLERANCE else 0.0
