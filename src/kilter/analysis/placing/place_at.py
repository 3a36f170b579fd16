"""The decision on a part at a given place, and the heaviest mass that is carried there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np

from kilter.analysis.check import check
from kilter.analysis.decision.judge import judge
from kilter.analysis.gradients.gradient import Gradient, gradient_of
from kilter.analysis.gradients.limit_case import LimitCases, refined_case
from kilter.analysis.load_limit import Limit, find_limit
from kilter.analysis.margins.solved_limits import fixed_loads, require_plain, solved_limit
from kilter.analysis.placing.upright_prisms import Top, placed_prism, shifted
from kilter.analysis.verdict.verdict import Verdict
from kilter.arrays import Array
from kilter.assembly import Assembly, Part
from kilter.assembly.mesh_surface import density_warnings, reweighed
from kilter.assembly.question import Question
from kilter.contact import detect
from kilter.errors import InputError
from kilter.mechanics.certificate import MotionProof
from kilter.mechanics.mechanics_tolerances import TOLERANCE
from kilter.mechanics.program import Program, build_program
from kilter.rigid import Pose
from kilter.shape.primitives import Box
from kilter.tell.levels import level_rank
from kilter.tell.record import InPython, Record, key
from kilter.validate import finite, number

# Whether a verdict depends on the density of parts that state neither a density nor a mass.


def density_matters(verdict: Verdict) -> bool:
    """True unless it is proved that the verdict is the same for every value of the default density.

    A verdict that rests on friction, and an undecided verdict, count as dependent.
    """
    program = verdict.program
    weights = _default_weights(verdict, program)
    if not weights.any():
        return False
    if verdict.friction_answer is not None or program.has_strength:
        return True
    if isinstance(verdict.evidence, MotionProof):
        motion = verdict.evidence.motion
        shares = [float((load * motion).sum()) for load in (weights, program.load - weights)]
        return min(shares) < 0.0
    if verdict.level is None:
        return True
    known = program.with_rows(applied=program.applied - weights)
    default = program.with_rows(applied=weights - _free_weights(program))
    return not (judge(known).stable and judge(default).stable)


def _free_weights(program: Program) -> Array:
    """Weights of the free parts [N], shape (N, 6)."""
    weights = np.zeros((len(program.names), 6))
    weights[:, :3] = (program.mass * program.free)[:, None] * program.gravity
    return weights


def _default_weights(verdict: Verdict, program: Program) -> Array:
    """Weights of the free parts at the default density [N]; zero for the other parts, (N, 6)."""
    default = [part.density is None and part.given_mass is None for part in verdict.assembly.parts]
    weights: Array = _free_weights(program) * np.array(default)[:, None]
    return weights


# A part whose mass and centre of mass are uncertain: the cases that decide for all of them.


MOST_SHARE = 0.5
"""Largest shift of the centre of mass from the middle [sizes of the part]: it lies inside."""


def mass_limits(mass: float | Sequence[float] | None, part: Part) -> tuple[float, float]:
    """Least and largest mass of a part [kg].

    Raises `InputError` if a mass is not positive, or the limits are reversed.
    """
    if mass is None:
        return part.mass, part.mass
    if np.ndim(mass) == 0:
        value = number(mass, "mass", lowest=0, above=True)
        return value, value
    low, high = finite(mass, (2,), "mass").tolist()
    if not 0 < low <= high:
        raise InputError(
            f"the mass is {low:g} to {high:g} kg", hint="give the least, then the largest mass"
        )
    return low, high


def part_cases(part: Part, mass: tuple[float, float], center_within: float) -> list[Part]:
    """The part with each corner of its masses and centres of mass.

    Arguments: `mass`: least and largest mass [kg]; `center_within`: largest horizontal shift of the
    centre of mass along each axis of the part [sizes of the part along this axis]; a box has its
    own axes, another part those of the world.

    Examples
    --------
    >>> crate = Part("crate", Box([4, 2, 1]), mass=5)
    >>> [(case.mass, case.center_of_mass.tolist()) for case in part_cases(crate, (5, 5), 0.1)]
    ... # doctest: +NORMALIZE_WHITESPACE
    [(5.0, [-0.4, -0.2, 0.0]), (5.0, [-0.4, 0.2, 0.0]), (5.0, [0.4, -0.2, 0.0]),
     (5.0, [0.4, 0.2, 0.0])]
    """
    share = number(center_within, "center_within", lowest=0)
    if share >= MOST_SHARE:
        raise InputError(
            f"the centre of mass lies within {share:g} sizes of the middle",
            hint=f"give less than {MOST_SHARE:g}",
            option="give less than 50%",
        )
    masses = sorted(set(mass))
    if not share:
        return [reweighed(part, given_mass=value, density=None) for value in masses]
    geometry = Assembly([part]).geometry
    turned = part.pose.matrix
    own = turned.T @ (geometry.center[0] - np.asarray(part.pose.position))
    return [
        reweighed(part, given_mass=value, density=None, center_of_mass=own + turned.T @ shift)
        for value in masses
        for shift in _shifts(part, geometry.vertices, share)
    ]


def _shifts(part: Part, vertices: Array, share: float) -> list[Array]:
    """The corners of the shifts of a centre of mass, world frame, each of shape (3,)."""
    level: list[Array] = []
    if isinstance(part.shape, Box):
        axes = (part.pose.matrix * np.asarray(part.shape.size)).T
        level = [axis for axis in axes if abs(axis[2]) <= UPRIGHT * float(np.linalg.norm(axis))]
    if len(level) != 2:
        size = np.ptp(vertices, axis=0)
        level = [np.array([size[0], 0, 0]), np.array([0, size[1], 0])]
    return [
        share * (first * level[0] + second * level[1])
        for first, second in product((-1, 1), (-1, 1))
    ]


UPRIGHT = 1e-6
"""Largest slope of a side of a box that counts as horizontal [-]."""


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

    def gradient(self) -> Gradient:
        """Derivatives of the heaviest mass by the data of the parts [kg per unit].

        The part is one of the parts of the gradient. Its own mass has no effect.

        Returns
        -------
        Gradient

        Raises
        ------
        InputError
            If the heaviest mass is not finite or 0, the centre of the part is uncertain, or the
            assembly has bonds, straps or springs.

        Examples
        --------
        A shelf of 6 kg, whose centre lies .3 m before the edge, carries 12 kg at .15 m beyond it:

        >>> import kilter
        >>> from kilter import Box, Part
        >>> table = Part("table", Box(1, 1, 1), [-0.5, 0, -0.5], grounded=True)
        >>> shelf = Part("shelf", Box(1, 0.5, 0.1), [-0.3, 0, 0.05], mass=6)
        >>> jar = kilter.box_to_place([0.1, 0.1, 0.1], 1.0, name="jar")
        >>> at = kilter.place(kilter.Assembly([table, shelf]), jar, at=[0.15, 0]).at
        >>> round(at.heaviest, 6), at.gradient().mass[1].round(6).tolist()
        (12.0, [2.0, 2.0])
        """
        if len({verdict.program.center.tobytes() for verdict in self.verdicts}) > 1:
            raise InputError(
                "derivatives are not computed for an uncertain centre", hint="give a single centre"
            )
        verdict = self.verdicts[0]
        assembly, contacts = verdict.assembly, verdict.contact_set
        program = build_program(assembly, contacts)
        require_plain(program)
        weight = _weight(program, self.part.name)
        limit = find_limit(program, weight)
        if not self.heaviest or not isinstance(limit, Limit) or limit.motion is None:
            raise InputError(
                "the heaviest mass is 0, unlimited or not known", hint="give another place"
            )
        number = assembly.index_of(self.part.name)
        solved = solved_limit(limit, weight / program.mass[number])
        solved = replace(
            solved, value=limit.value * program.mass[number], fixed=fixed_loads(assembly, 1.0)
        )
        cases = (refined_case(solved),)
        found = gradient_of(
            assembly, contacts, LimitCases("heaviest", self.heaviest, "kg", 1.0, cases, False)
        )
        mass = found.mass.copy()
        mass[number] = 0.0  # a heavier part is nearer to the same heaviest mass
        return replace(found, mass=mass)

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
    # the load of the part itself is share 0
    limit = find_limit(program, _weight(program, name))
    if not isinstance(limit, Limit):
        return None
    share = 1 + limit.value
    if share < -TOLERANCE:
        return None
    mass = float(program.mass[program.names.index(name)])
    return mass * share if share > TOLERANCE else 0.0


def _weight(program: Program, name: str) -> Array:
    """Weight of a part as a load of all parts [N], shape (N, 6)."""
    k = program.names.index(name)
    weight = np.zeros((len(program.names), 6))
    weight[k, :3] = program.mass[k] * program.gravity
    return weight
