"""Derivatives of a limit by all data of an assembly: arrays, and slopes in given directions."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from kilter.analysis.analysis_tolerances import SAME_FORCE
from kilter.analysis.gradients.contact_rates import ContactRates, contact_rates
from kilter.analysis.gradients.feature_reach import feature_reach
from kilter.analysis.gradients.limit_case import LimitCase, LimitCases
from kilter.analysis.gradients.limit_faces import scaled_others, slope_on_face
from kilter.analysis.gradients.limit_power import LimitPower, Rates
from kilter.analysis.gradients.shape_rates import size_names, size_rates, vertex_gradient
from kilter.arrays import TINY, Array, Index, Mask
from kilter.assembly import Assembly
from kilter.contact import ContactSet
from kilter.contact.friction_coefficients import friction_coefficients
from kilter.errors import InputError
from kilter.mechanics.program import loads_about
from kilter.mechanics.rows import CONTACT
from kilter.shape.primitives import Mesh, surface

ANGLE = 1e-4
"""Accuracy of the direction with the least derivative [rad]."""
COMBINATIONS = 3
"""Number of random combinations of other optima that are compared with the chosen optimum."""
AXES = {
    "position": ("part", "axis", "side"),
    "rotation": ("part", "axis", "side"),
    "mass": ("part", "side"),
    "center": ("part", "axis", "side"),
    "friction": ("pair", "side"),
    "load": ("part", "axis of force, then of torque", "side"),
}
"""Names of the axes of each array of a gradient."""
Arrays = dict[str, Array]
Turned = Callable[[float], LimitCase | None]


@dataclass(frozen=True, slots=True)
class Slope:
    """One-sided derivatives of a limit by a parameter, and the values for which they hold."""

    left: float
    """Derivative toward smaller values of the parameter; NaN if it is not known."""
    right: float
    """Derivative toward larger values; NaN if it is not known."""
    reach: float
    """Increase of the parameter up to which the same features touch, to first order."""


@dataclass(frozen=True, eq=False)
class Gradient:
    """Derivatives of a limit by the data of the assembly.

    The limit is that of `kilter.margin`, `kilter.transport` or a place of `kilter.place`.

    The last axis of each array has the derivatives toward smaller and toward larger values. They
    differ where edges of two faces coincide, or several limits are equal. All derivatives hold as
    long as the same features of the parts touch. A part that leaves a face loses that contact, so
    only movements that keep the contacts closed have a meaning, alone or of several parts together.

    Contact points, load points and joints that the file lists do not move with the parts.
    """

    of: str
    """The limit: "tilt", "friction", "load factor", "least load factor", "push", "load", the name
    of a limit of `kilter.transport`, or "heaviest" for a place."""
    value: float
    """The limit [`unit`]."""
    unit: str
    """"deg", "-", "N", "g" or "kg"."""
    parts: tuple[str, ...]
    """Names of the parts, in the order of the arrays."""
    pairs: tuple[tuple[str, str], ...]
    """Names of the parts of each pair of `friction`."""
    position: Array
    """By the position of each part, world axes [unit/length unit], shape (N, 3, 2)."""
    rotation: Array
    """By rotations of each part about world axes through its centre of mass [unit/rad], shape
    (N, 3, 2)."""
    mass: Array
    """By the mass of each part [unit/kg], shape (N, 2)."""
    center: Array
    """By the centre of mass of each part, its surface kept [unit/length unit], shape (N, 3, 2)."""
    friction: Array
    """By the friction coefficient of each pair [unit], shape (P, 2); 0 for a least friction."""
    load: Array
    """By forces at the centre of mass of each part [unit/N], and torques, shape (N, 6, 2)."""
    unique: dict[str, Mask]
    """For each array, whether every optimal force and motion gives the same derivative, shapes
    without the last axis. If not, the array has the derivative of a single optimum, which lies
    between those to both sides; `along` computes these."""
    round: tuple[str, ...]
    """Parts with round contacts, whose position and rotation are not followed: NaN."""
    _assembly: Assembly
    _contacts: ContactSet
    _cases: LimitCases
    _powers: tuple[LimitPower, ...]

    def along(self, other: Assembly) -> Slope:
        """Derivatives toward another assembly, whose parts have the same names and surfaces.

        The parameter is 0 at this assembly and 1 at the other: positions, vertices, masses,
        centres, friction and loads change at constant rates.

        Parameters
        ----------
        other : Assembly
            Near to this assembly, so that the differences are small.

        Returns
        -------
        Slope
            Derivatives to both sides, also if forces or motion are not unique.

        Raises
        ------
        InputError
            If the other assembly has other parts, gravity, or numbers of vertices.

        Examples
        --------
        >>> import kilter
        >>> table = kilter.Part("table", kilter.Box(9, 9, 1), [0, 0, -0.5], grounded=True)
        >>> def box(height):
        ...     part = kilter.Part("box", kilter.Box(1, 1, height), [0, 0, height / 2])
        ...     return kilter.Assembly([table, part], friction=0.9)
        >>> slope = kilter.margin(box(2.0)).gradient("tilt").along(box(2.001))
        >>> round(slope.right / 0.001, 3)  # degrees per metre
        -11.459
        """
        assembly = self._assembly
        _require_same_parts(assembly, other)
        rates = _difference(self._assembly, self._contacts, other)
        right = self._slope(rates)
        left = -self._slope(-rates)
        if self._cases.sign < 0:
            left, right = -left, -right
        points = self._powers[0]
        return Slope(left, right, feature_reach(points, rates.vertices))

    def _slope(self, rates: Rates) -> float:
        """Derivative of the least of the cases toward larger values; NaN if it is not known."""
        if self._cases.copied or self._touches_round(rates):
            return np.nan
        slopes = [
            _case_slope(case, power, rates)
            for case, power in zip(self._cases.cases, self._powers, strict=True)
        ]
        if self._cases.turned is None or not np.isfinite(slopes).all():
            return float(np.min(slopes))
        return self._least_turn(self._cases.turned, rates, slopes)

    def _least_turn(self, turned: Turned, rates: Rates, slopes: list[float]) -> float:
        """The least derivative over all directions of a tilt with the same limit in each."""
        from scipy.optimize import minimize_scalar

        step = 2 * np.pi / len(slopes)
        start = int(np.argmin(slopes)) * step

        def slope(angle: float) -> float:
            case = turned(angle)
            return (
                np.inf
                if case is None
                else _case_slope(case, _power(self._assembly, self._contacts, case), rates)
            )

        bounds = (start - step, start + step)
        best = minimize_scalar(slope, bounds=bounds, method="bounded", options={"xatol": ANGLE})
        return float(min(*slopes, best.fun))

    def _touches_round(self, rates: Rates) -> bool:
        """Whether vertices of parts with round contacts move."""
        geometry = self._assembly.geometry
        moved = np.zeros(len(self.parts), dtype=bool)
        moved[geometry.vertex_part[rates.vertices.any(axis=1)]] = True
        return any(moved[self.parts.index(name)] for name in self.round)

    def sizes(self, part: str) -> dict[str, tuple[float, float]]:
        """Derivatives by the sizes of a box, cylinder, prism or sphere [unit/length unit].

        A size grows to both sides of the centre of the shape. Mass and centre of mass follow unless
        they are given. Each value has the derivatives toward smaller and toward larger sizes.

        Raises
        ------
        InputError
            If there is no part of this name.
        """
        found = {}
        for size, rates in self._size_rates(part):
            left, right = -self._slope(-rates), self._slope(rates)
            found[size] = (left, right) if self._cases.sign > 0 else (-left, -right)
        return found

    @property
    def cases(self) -> tuple[LimitCase, ...]:
        """The solved limits of which the least is the limit."""
        return self._cases.cases

    @property
    def copied(self) -> bool:
        """Whether other parts, equal to these, have the same limit."""
        return self._cases.copied

    def quick_sizes(self, part: str) -> dict[str, float]:
        """Derivatives toward larger sizes for the chosen optimum: a first guess of `sizes`."""
        return {
            size: self._cases.sign * min(slope_of(power, rates) for power in self._powers)
            for size, rates in self._size_rates(part)
        }

    def _size_rates(self, part: str) -> Iterator[tuple[str, Rates]]:
        """Yield each size of a part, with the rates of the data by it."""
        assembly, geometry = self._assembly, self._assembly.geometry
        number = assembly.index_of(part)
        for size in size_names(assembly.parts[number]):
            rates = no_rates(assembly, self._contacts)
            own = slice(geometry.vertex_start[number], geometry.vertex_start[number + 1])
            moved, rates.center[number], rates.mass[number] = size_rates(assembly, number, size)
            rates.vertices[own] = moved
            yield size, rates

    def vertices(self, part: str) -> Array:
        """Derivatives by each vertex of a part, world axes [unit/length unit], shape (V, 3, 2).

        Mass and centre of mass follow the shape unless they are given. The order is that of
        `Assembly.geometry.vertices`.

        Raises
        ------
        InputError
            If there is no part of this name.
        """
        assembly = self._assembly
        geometry, number = assembly.geometry, assembly.index_of(part)
        found = []
        for power in self._powers:
            change = power.by_vertices(number)
            by_mass, by_center = float(power.by_mass[number]), power.by_center[number]
            given = vertex_gradient(geometry, assembly.parts[number], number, by_mass, by_center)
            scale = -power.solved.unit / power.gain
            found.append(scale * (change + given[:, :, None]))
        return self._cases.sign * _least(found, self._cases.copied, self.of)

    def __repr__(self) -> str:
        return f"<Gradient of {self.of}: {self.value:.6g} {self.unit}, {len(self.parts)} parts>"


def gradient_of(assembly: Assembly, contacts: ContactSet, cases: LimitCases) -> Gradient:
    """The gradient of a limit that is solved."""
    of = cases.of
    powers = tuple(_power(assembly, contacts, case) for case in cases.cases)
    pairs, pair_of = _pairs(contacts)
    arrays = [_arrays(power, pair_of, len(pairs)) for power in powers]
    together = {name: _least([each[name] for each in arrays], cases.copied, of) for name in AXES}
    unique = {name: np.ones(together[name].shape[:-1], dtype=bool) for name in AXES}
    for case, power, array in zip(cases.cases, powers, arrays, strict=True):
        for name, same in _unique(case, power, array, pair_of, len(pairs)).items():
            unique[name] &= same
    names = assembly.names
    rounded = sorted(_round_parts(powers))
    for name in ("position", "rotation"):
        together[name][rounded] = np.nan
    return Gradient(
        of=of,
        value=cases.value,
        unit=cases.unit,
        parts=names,
        pairs=tuple((names[a], names[b]) for a, b in pairs),
        unique=unique,
        round=tuple(names[k] for k in rounded),
        _assembly=assembly,
        _contacts=contacts,
        _cases=cases,
        _powers=powers,
        **{name: cases.sign * array for name, array in together.items()},
    )


def _power(assembly: Assembly, contacts: ContactSet, case: LimitCase) -> LimitPower:
    """The change of the power of a case, with the rates of its contacts."""
    rates: ContactRates = contact_rates(case.solved.program, contacts)
    return LimitPower(case.solved, rates, assembly.geometry)


def _pairs(contacts: ContactSet) -> tuple[list[tuple[int, int]], Index]:
    """Pairs of parts that touch, and the pair of each patch, shape (P,)."""
    ends = np.sort(contacts.patch_parts, axis=1).reshape(-1, 2)
    pairs, number = np.unique(ends, axis=0, return_inverse=True)
    return [(int(a), int(b)) for a, b in pairs], number.ravel()


def _arrays(power: LimitPower, pair_of: Index, pairs: int) -> Arrays:
    """Derivatives of a case by all data, each with both sides as the last axis."""
    scale = -power.solved.unit / power.gain
    parts = power.by_parts()
    program = power.solved.program
    contact = np.flatnonzero(program.kind == CONTACT)
    by_row = power.by_row_friction[contact] * power.solved.along.any()
    friction = np.bincount(pair_of[program.source[contact]], by_row, minlength=pairs)
    plain = {
        "mass": power.by_mass,
        "center": power.by_center,
        "friction": friction,
        "load": power.by_force,
    }
    sided = {name: np.stack([array, array], axis=-1) for name, array in plain.items()}
    sided |= {"position": parts.position, "rotation": parts.rotation}
    return {name: scale * sided[name] for name in AXES}


def _least(arrays: list[Array], copied: bool, of: str) -> Array:
    """Derivatives of the least of several limits, to both sides.

    If other parts have the same limit, no change of these parts alone raises it.
    """
    stacked = np.array(arrays)
    left, right = stacked[..., 0].max(axis=0), stacked[..., 1].min(axis=0)
    if copied and of == "friction":
        left, right = np.minimum(left, 0.0), np.maximum(right, 0.0)
    elif copied:
        left, right = np.maximum(left, 0.0), np.minimum(right, 0.0)
    return np.stack([left, right], axis=-1)


def _unique(
    case: LimitCase, power: LimitPower, array: Arrays, pair_of: Index, pairs: int
) -> dict[str, Mask]:
    """Whether the derivatives are those of every optimal force and motion; none if unknown."""
    if case.refined is None:
        return {name: np.zeros(array[name].shape[:-1], dtype=bool) for name in AXES}
    unique = {name: np.ones(array[name].shape[:-1], dtype=bool) for name in AXES}
    others = scaled_others(case.refined)
    if not others:
        return unique
    solved, random = case.solved, np.random.default_rng(0)
    scales = _scales(power)
    for _ in range(COMBINATIONS):
        factors = random.uniform(-1, 1, len(others)) / len(others)
        forces, friction, motion = (
            np.tensordot(factors, np.array([other[k] for other in others]), 1) for k in range(3)
        )
        changed = [
            replace(solved, forces=solved.forces + forces, friction=solved.friction + friction),
            replace(solved, motion=solved.motion + motion),
        ]
        for new in changed:
            moved = LimitPower(new, power.rates, power.geometry)
            other = _arrays(moved, pair_of, pairs)
            for name, same in unique.items():
                apart = np.abs(other[name] - array[name])
                size = max(float(np.abs(array[name]).max(initial=0.0)), scales[name])
                same &= (apart <= SAME_FORCE * size).all(axis=-1)
    return unique


def _scales(power: LimitPower) -> dict[str, float]:
    """Size of a derivative of each array that changes the limit by 1 if the data change by 1."""
    program, unit = power.solved.program, power.solved.unit
    size, mass = float(program.radius.min()), float(program.mass.min())
    weight = max(mass * program.g, TINY)
    return {
        "position": unit / size,
        "rotation": unit,
        "mass": unit / mass,
        "center": unit / size,
        "friction": unit,
        "load": unit / weight,
    }


def _round_parts(powers: tuple[LimitPower, ...]) -> set[int]:
    """Parts with round contacts at rows that carry force in a motion."""
    found: set[int] = set()
    for power in powers:
        program = power.solved.program
        rows = np.flatnonzero(power.rates.round & (np.abs(power.solved.forces) > 0))
        found |= {int(k) for k in program.part_a[rows]} | {int(k) for k in program.part_b[rows]}
    return found - {-1}


def slope_of(power: LimitPower, rates: Rates) -> float:
    """Derivative of a limit for the chosen forces and motion, toward larger values."""
    return -power.solved.unit * power.change(rates) / power.gain


def _case_slope(case: LimitCase, power: LimitPower, rates: Rates) -> float:
    """Derivative of a case toward larger values, by a program if the optimum is not unique."""
    first = slope_of(power, rates)
    if case.refined is None:
        return first if case.solvable else np.nan
    if not case.refined.others:
        return first
    solved, differ = case.solved, 0.0
    for forces, friction, motion in scaled_others(case.refined):
        for new in (
            replace(solved, forces=solved.forces + forces, friction=solved.friction + friction),
            replace(solved, motion=solved.motion + motion),
        ):
            differ = max(
                differ, abs(slope_of(LimitPower(new, power.rates, power.geometry), rates) - first)
            )
    if differ <= SAME_FORCE * max(abs(first), solved.unit * TINY):
        return first
    return solved.unit * slope_on_face(power, case.refined, rates)


def no_rates(assembly: Assembly, contacts: ContactSet) -> Rates:
    """Rates of 0 for all data of an assembly."""
    count, vertices = len(assembly.parts), len(assembly.geometry.vertices)
    patches = len(contacts.patch_mu)
    return Rates(
        np.zeros((vertices, 3)),
        np.zeros((count, 3)),
        np.zeros(count),
        np.zeros(patches),
        np.zeros((count, 6)),
    )


def _require_same_parts(assembly: Assembly, other: Assembly) -> None:
    """Raise `InputError` if the data of two assemblies do not correspond."""
    hint = "give an assembly with the same parts, of which only numbers differ"
    if assembly.names != other.names:
        raise InputError("the other assembly has other parts", hint=hint)
    if (assembly.gravity != other.gravity).any() or assembly.units != other.units:
        raise InputError("the other assembly has another gravity or another unit", hint=hint)
    for first, second in zip(assembly.parts, other.parts, strict=True):
        kinds = type(first.shape) is type(second.shape)
        if not kinds or len(surface(first.shape)[0]) != len(surface(second.shape)[0]):
            raise InputError(
                "the shape in the other assembly has other vertices", part=first.name, hint=hint
            )


def _difference(assembly: Assembly, contacts: ContactSet, other: Assembly) -> Rates:
    """Rates from an assembly to another, per unit of the way."""
    first, second = assembly.geometry, other.geometry
    ends = contacts.patch_parts
    mu = friction_coefficients(other, ends) - friction_coefficients(assembly, ends)
    return Rates(
        _vertex_difference(assembly, other),
        second.center - first.center,
        second.mass - first.mass,
        np.where(contacts.patch_mu > 0, mu, 0.0),
        loads_about(other, first.center) - loads_about(assembly, first.center),
    )


def _vertex_difference(assembly: Assembly, other: Assembly) -> Array:
    """Way of each vertex of the geometry from an assembly to another, shape (V, 3)."""
    geometry = assembly.geometry
    ways = np.zeros_like(geometry.vertices)
    for k, (first, second) in enumerate(zip(assembly.parts, other.parts, strict=True)):
        own = slice(geometry.vertex_start[k], geometry.vertex_start[k + 1])
        before, after = surface(first.shape)[0], surface(second.shape)[0]
        way = second.pose.apply(after) - first.pose.apply(before)
        if isinstance(first.shape, Mesh):  # whose geometry has its vertices in another order
            place = geometry.vertices[own][:, None] - first.pose.apply(before)
            way = way[(place**2).sum(axis=2).argmin(axis=1)]
        ways[own] = way
    return ways
