"""The least change after which an assembly stands with a given tilt margin.

Let x be the changes: positions of parts along their contacts, masses, sizes, friction. The assembly
stands under gravity g_j, tilted by the margin toward direction j, if forces f_j exist with

    J(x)^T f_j + w_j(x) = 0,    f_j in Coulomb's cones

Sequential convex programs with these rows, linear in x near the last forces, seek the least
change. Imbalances that are left cost much. After each step the contacts are searched again, and the
tilt margin of the changed assembly, proved on both sides, decides whether the step is enough; the
direction in which it is least joins the others.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import block_diag, csc_array, eye_array, hstack, vstack

from kilter.analysis.decision.cascade import decide
from kilter.analysis.gradients.contact_rates import ContactRates, contact_rates
from kilter.analysis.gradients.gradient import no_rates
from kilter.analysis.gradients.limit_power import LimitPower, Rates, SolvedLimit, row_rates
from kilter.analysis.gradients.refined_limit import ForceColumns
from kilter.analysis.gradients.shape_rates import size_rates
from kilter.analysis.load_limit import NoLimit
from kilter.analysis.margins.tilt import find_least_tilt
from kilter.analysis.margins.tried_changes import (
    STANDS,
    growing_sizes,
    grown,
    moving_axes,
    weighing,
)
from kilter.arrays import Array, Index, across
from kilter.assembly import Assembly, FrictionPair
from kilter.contact import ContactSet, contacts
from kilter.contact.round_edges import round_edges
from kilter.errors import InputError, some_names
from kilter.mechanics.clusters import limit_groups
from kilter.mechanics.program import Program, build_program
from kilter.rigid import Pose
from kilter.solvers.problem import ConicProgram
from kilter.tell.numbers import number, vector
from kilter.tell.record import InPython, Lines, OrNull, Record, Word
from kilter.work import Work, stop_if_late

KINDS = ("move", "mass", "size", "friction")
"""Kinds of changes."""
DIRECTIONS = 8
"""Number of directions of tilt at first."""
STEPS = 25
"""Largest number of steps."""
TRUST = 0.2
"""Largest change in a step [size of the part, share of a mass, friction coefficient]."""
IMBALANCE = 100.0
"""Cost of an imbalance of the weight of all free parts, beside that of changes [-]."""
SPARE = 1e-6
"""Tilt beyond the required one that the programs seek [rad]."""
SETTLED = 1e-3
"""Steps end if the change falls by less than this share [-]."""
LEAST = 1e-9
"""Smaller changes are none [size of the part, share of a mass, friction coefficient]."""
LIGHTEST = 0.05
"""Least share of a mass that is left [-]."""


class StandChange(Record):
    """A change of a part or of a pair that makes an assembly stand."""

    what: str
    """Kind of the change: "move", "mass", "size" or "friction"."""
    parts: tuple[str, ...]
    """The part, or the two parts of the contact."""
    by: float
    """Distance or growth [length unit], additional mass [kg] or friction coefficient [-]."""
    sentence: str
    """The change in words."""


class MadeStand(Record):
    """The least change after which an assembly stands with a given tilt margin."""

    stands: bool
    """Whether a change was found after which it stands with the margin; this is proved."""
    required_deg: float
    """Required tilt margin [deg]."""
    tilt_deg: OrNull
    """Tilt margin of the changed assembly, proved to be held [deg]."""
    verdict: Word | None
    """Verdict of the changed assembly, at the level "equilibrium"."""
    change: OrNull
    """Sum of all changes: movements and growths over the size of the part, shares of masses,
    friction coefficients [-]."""
    changes: tuple[StandChange, ...]
    """All changes, the largest first."""
    steps: int
    """Number of convex programs."""
    positions: Lines
    """Positions of all parts of the changed assembly [length unit], shape (N, 3)."""
    assembly: InPython[Assembly]
    """The changed assembly; the given one if no change was found."""


@dataclass(frozen=True, slots=True, eq=False)
class _Variable:
    """A change by a single number, in units in which changes are compared."""

    what: str
    part: int
    other: int
    axis: Array
    size: str
    unit: float
    """Distance, mass or friction per unit of the variable."""


def require_standable(assembly: Assembly, allow: Sequence[str]) -> tuple[str, ...]:
    """Validate the allowed kinds of changes of an assembly.

    Raises `InputError` if there is none, one is unknown, or the assembly has bonds, straps, joints
    or loads.
    """
    unknown = [kind for kind in allow if kind not in KINDS]
    if unknown or not allow:
        named = f"{unknown[0]!r} is no kind of change" if unknown else "no kind of change is named"
        raise InputError(named, hint=f"allow {some_names(KINDS)}")
    if assembly.bonds or assembly.straps or assembly.joints or assembly.loads:
        raise InputError(
            "no change is searched for an assembly with bonds, straps, joints or loads",
            hint="leave them out",
        )
    return tuple(dict.fromkeys(allow))


def find_standing(
    assembly: Assembly, touching: ContactSet, *, kinds: tuple[str, ...], tilt_deg: float, work: Work
) -> MadeStand:
    """Find the least change after which an assembly stands with a tilt margin.

    Arguments: `kinds`: allowed kinds of changes; `tilt_deg`: required margin [deg]; `work`: work of
    each decision whether it stands. Raises `InputError` if the margin is not below a right angle.
    """
    if not 0 <= tilt_deg < 90:
        raise InputError(f"the tilt is {tilt_deg:g} deg", hint="give 0 or more, below 90")
    return _StandSearch(assembly, touching, kinds, float(np.radians(tilt_deg)), work).answer()


class _StandSearch:
    """The search for the least change, from step to step."""

    def __init__(
        self, assembly: Assembly, touching: ContactSet, allow: tuple[str, ...], tilt: float,
        work: Work,
    ) -> None:  # fmt: skip
        self.given, self.tilt, self.work = assembly, tilt, work
        self.tolerance = touching.searched
        self.variables = list(_variables(assembly, touching, allow))
        angles = np.arange(DIRECTIONS) * (2 * np.pi / DIRECTIONS)
        u, v = across(assembly.down)
        if assembly.planar:
            u, v, angles = np.array([1.0, 0, 0]), np.zeros(3), np.array([0.0, np.pi])
        self.directions = [np.cos(angle) * u + np.sin(angle) * v for angle in angles]
        self.x = np.zeros(len(self.variables))
        self.trust = TRUST
        self.steps = 0
        self.best: tuple[float, Array, float, str] | None = None

    def answer(self) -> MadeStand:
        """Run the steps and report the least change that was proved."""
        if self.variables:
            self.run()
        return self.report()

    def run(self) -> None:
        """Take steps until the change settles."""
        last = np.inf
        for _ in range(STEPS):
            stop_if_late()
            assembly = self.changed(self.x)
            touching = contacts(assembly, tolerance=self.tolerance)
            margin, toward = _tilt_of(assembly, touching)
            enough = margin >= self.tilt
            if enough:
                self.keep(assembly, touching, margin)
                cost = float(np.abs(self.x).sum())
                if last - cost <= SETTLED * max(cost, LEAST):
                    return
                last = cost
            elif toward is not None:
                self.directions.append(toward)
            step = _StandProgram(self, assembly, touching).solve()
            self.steps += 1
            if step is None or np.abs(step).max() <= LEAST:
                if enough or self.trust < TRUST / 100:
                    return
                self.trust /= 2
                continue
            self.x = self.x + step
            self.trust *= 0.8

    def keep(self, assembly: Assembly, touching: ContactSet, margin: float) -> None:
        """Keep the changes if they are the least so far and the assembly is decided to stand."""
        cost = float(np.abs(self.x).sum())
        if self.best is not None and self.best[0] <= cost:
            return
        verdict = decide(
            assembly, touching, require="equilibrium", work=self.work.beside(self.work.allowed),
            second_order=False, question=False,
        ).verdict  # fmt: skip
        if verdict in STANDS:
            self.best = cost, self.x.copy(), margin, verdict

    def report(self) -> MadeStand:
        """The answer from the best changes."""
        cost, x, margin, verdict = self.best or (np.inf, np.zeros_like(self.x), np.nan, None)
        assembly = self.changed(x)
        order = np.argsort(-np.abs(x), kind="stable")
        listed = tuple(
            _in_words(self.given, self.variables[k], float(x[k]))
            for k in order.tolist()
            if abs(x[k]) > LEAST
        )
        return MadeStand(
            stands=self.best is not None,
            required_deg=float(np.degrees(self.tilt)),
            tilt_deg=float(np.degrees(margin)),
            verdict=verdict,
            change=cost,
            changes=listed,
            steps=self.steps,
            positions=np.array([part.pose.position for part in assembly.parts]),
            assembly=assembly,
        )

    def changed(self, x: Array) -> Assembly:
        """The given assembly with changes."""
        assembly, parts = self.given, list(self.given.parts)
        pairs = {frozenset(pair.parts): pair for pair in assembly.friction_pairs}
        for variable, value in zip(self.variables, x.tolist(), strict=True):
            k, amount = variable.part, value * variable.unit
            part = parts[k]
            if abs(value) <= LEAST:
                continue
            if variable.what == "move":
                position = np.asarray(part.pose.position) + amount * variable.axis
                parts[k] = replace(part, pose=Pose(position, part.pose.rotation))
            elif variable.what == "mass":
                parts[k] = weighing(part, float(assembly.geometry.mass[k]) + amount)
            elif variable.what == "size":
                parts[k] = grown(part, variable.size, amount)
            else:
                names = part.name, parts[variable.other].name
                known = pairs.get(frozenset(names))
                before = assembly.friction if known is None else known.mu
                pairs[frozenset(names)] = FrictionPair(names, before + amount)
        return replace(assembly, parts=parts, friction_pairs=list(pairs.values()))


def _variables(assembly: Assembly, touching: ContactSet, allow: tuple[str, ...]) -> list[_Variable]:
    """The changes of the allowed kinds."""
    found, none = [], np.zeros(3)
    geometry = assembly.geometry
    free = np.flatnonzero(~geometry.grounded).tolist()
    for k in free:
        size, mass = float(geometry.size[k]), float(geometry.mass[k])
        if "move" in allow:
            for axis in moving_axes(assembly, touching, k):
                found.append(_Variable("move", k, -1, axis, "", size))
        if "mass" in allow:
            found.append(_Variable("mass", k, -1, none, "", mass))
        if "size" in allow:
            found += [
                _Variable("size", k, -1, none, name, size)
                for name in growing_sizes(assembly, touching, k)
            ]
    if "friction" in allow:
        ends = np.unique(np.sort(touching.patch_parts, axis=1), axis=0)
        found += [_Variable("friction", int(a), int(b), none, "", 1.0) for a, b in ends]
    return found


def _in_words(assembly: Assembly, variable: _Variable, value: float) -> StandChange:
    """A change as a record with its words."""
    amount, units = value * variable.unit, assembly.units
    names = [assembly.names[variable.part]]
    if variable.what == "move":
        side = vector(np.sign(amount) * variable.axis)
        words = f"move {names[0]!r} by {number(abs(amount))} {units} along {side}"
    elif variable.what == "mass":
        words = (
            f"make {names[0]!r} {number(abs(amount))} kg {'heavier' if amount > 0 else 'lighter'}"
        )
    elif variable.what == "size":
        grows = "increase" if amount > 0 else "decrease"
        words = f"{grows} {variable.size} of {names[0]!r} by {number(abs(amount))} {units}"
    else:
        names.append(assembly.names[variable.other])
        words = f"increase mu between {names[0]!r} and {names[1]!r} by {number(amount)}"
    return StandChange(what=variable.what, parts=tuple(names), by=amount, sentence=words)


def _tilt_of(assembly: Assembly, touching: ContactSet) -> tuple[float, Array | None]:
    """Tilt margin that is proved to be held [rad], and the direction in which it is least.

    Negative if gravity as given is not held.
    """
    program = build_program(assembly, touching)
    edges = () if program.planar else round_edges(assembly, touching)
    tilt = find_least_tilt(limit_groups(program), edges, lambda _: None)
    if isinstance(tilt, NoLimit):
        return -1.0, None
    return tilt.lower, tilt.toward if tilt.toward.any() else None


class _StandProgram:
    """A convex program for the next change, near an assembly."""

    def __init__(self, search: _StandSearch, assembly: Assembly, touching: ContactSet) -> None:
        self.search, self.assembly, self.touching = search, assembly, touching
        self.program: Program = build_program(assembly, touching)
        self.columns = ForceColumns(
            self.program, np.arange(len(self.program.part_a)), self.program.mu
        )
        down, tilt = self.program.down, search.tilt + SPARE
        self.gravities = [
            self.program.g * (np.cos(tilt) * down + np.sin(tilt) * toward)
            for toward in search.directions
        ]
        self.rates: ContactRates = contact_rates(self.program, touching)

    def solve(self) -> Array | None:
        """The next change of all variables; None if the solver fails."""
        forces = self._solve(None)
        if forces is None:
            return None
        answer = self._solve(forces)
        return None if answer is None else np.asarray(answer[0])

    def _loads(self) -> list[Array]:
        """Scaled load of each direction."""
        weights = (self.program.mass * self.program.free)[:, None]
        none = np.zeros((len(weights), 3))
        return [self.columns.scaled(np.hstack([weights * g, none])) for g in self.gravities]

    def _solve(self, forces: Array | None) -> Array | None:
        """Forces of least imbalance, (J, columns); or with these, the change as a single row."""
        from kilter.solvers.clarabel import solve_conic

        answer = solve_conic(self._conic(forces))
        if not answer.found:
            return None
        count, size = len(self.gravities), self.columns.levers.shape[1]
        if forces is None:
            values: Array = answer.x[: count * size].reshape(count, size)
            return values
        variables = len(self.search.variables)
        more = answer.x[count * size :][: 2 * variables].reshape(2, variables)
        return np.stack([more[0] - more[1]])

    def _conic(self, forces: Array | None) -> ConicProgram:
        """The program: forces, changes up and down, sizes of changes, imbalances up and down."""
        levers, loads = self.columns.levers, self._loads()
        freedoms, size = levers.shape
        count, variables = len(loads), len(self.search.variables)
        changes = np.zeros((count * freedoms, 2 * variables))
        rougher = np.zeros((count * size, 2 * variables))
        if forces is not None:
            for number_, variable in enumerate(self.search.variables):
                for side in (0, 1):
                    column = side * variables + number_
                    balance, heads = self._effect(variable, 1 - 2 * side, forces)
                    changes[:, column], rougher[:, column] = balance, heads
        balance = hstack(
            [
                block_diag([csc_array(levers)] * count),
                csc_array(changes),
                csc_array((count * freedoms, variables)),
                eye_array(count * freedoms),
                -eye_array(count * freedoms),
            ]
        )
        trust = self.search.trust if forces is not None else 0.0
        total = balance.shape[1]
        flat, right = self._limits(count * size, total, trust)
        half, cones, dimensions = self._cones(count, rougher, total)
        matrix = vstack([balance, flat, -half, -cones], format="csc")
        none = np.zeros(half.shape[0] + cones.shape[0])
        bound = np.concatenate([-np.concatenate(loads), right, none])
        cost = np.concatenate(
            [
                np.zeros(count * size), np.full(2 * variables, LEAST), np.ones(variables),
                np.full(2 * count * freedoms, IMBALANCE),
            ]
        )  # fmt: skip
        no_quadratic = csc_array((total, total))
        positive = flat.shape[0] + half.shape[0]
        return ConicProgram(
            no_quadratic, cost, matrix, bound, balance.shape[0], positive, dimensions
        )

    def _limits(self, first: int, total: int, trust: float) -> tuple[csc_array, Array]:
        """Inequalities of the changes: their sizes, the largest step, and no negative unknown.

        Arguments: `first`: number of unknown forces; `total`: number of all unknowns.
        """
        x = self.search.x
        kinds = np.array([variable.what for variable in self.search.variables])
        identity = eye_array(total, format="csr")
        up, down, sizes = (
            identity[first + k * len(x) : first + (k + 1) * len(x)] for k in range(3)
        )
        # sizes and friction only grow, and masses stay above a share
        least = np.select([kinds == "move", kinds == "mass"], [-np.inf, LIGHTEST - 1], 0.0)
        lowest = np.clip(x - least, 0.0, trust)
        rows = [up - down - sizes, down - up - sizes, up, down, -identity[first:]]
        right = [-x, x, np.full(len(x), trust), lowest, np.zeros(total - first)]
        return csc_array(vstack(rows)), np.concatenate(right)

    def _cones(self, count: int, rougher: Array, total: int) -> tuple[csc_array, csc_array, Index]:
        """Half lines of smooth rows, cones of rough rows, and the sizes of the cones."""
        columns = self.columns
        size = columns.levers.shape[1]
        smooth = [k for k in range(len(columns.rows)) if not columns.rough[k]]
        rows, mus, dimensions = [], [], []
        for k in np.flatnonzero(columns.rough).tolist():
            tangents = columns.tangents(k).tolist()
            rows += [k, *tangents]
            mus += [columns.mu[k], *[1.0] * len(tangents)]
            dimensions.append(1 + len(tangents))
        every = np.arange(count)[:, None] * size
        flat = (every + np.array(smooth, dtype=np.int64)).ravel()
        bent = (every + np.array(rows, dtype=np.int64)).ravel()
        identity = eye_array(total, format="csr")
        heads = csc_array(rougher[bent])
        wide = hstack([
            csc_array((len(bent), count * size)), heads,
            csc_array((len(bent), total - count * size - heads.shape[1])),
        ])  # fmt: skip
        cones = csc_array(identity[bent].multiply(np.tile(mus, count)[:, None])) + wide
        return (
            csc_array(identity[flat]),
            csc_array(cones),
            np.array(dimensions * count, dtype=np.int64),
        )

    def _effect(self, variable: _Variable, sign: int, forces: Array) -> tuple[Array, Array]:
        """Change of the balance, and of the heads of the cones, per unit of a variable.

        Arguments: `forces` (J, columns): scaled forces of each direction near which it is linear.
        """
        columns, program = self.columns, self.program
        rates = self._rates(variable, sign)
        moved, _ = row_rates(self._power(), rates.vertices)
        steady, zero = columns.direction, np.zeros((len(columns.row), 3))
        rows = columns.rows[columns.row]
        change = columns.wrenches(steady, moved[rows], rates.center)
        change -= columns.wrenches(steady, zero, np.zeros_like(rates.center))
        balance = []
        for g, force in zip(self.gravities, forces, strict=True):
            load = np.hstack([rates.mass[:, None] * g, np.zeros_like(rates.center)])
            balance.append(change @ force + columns.scaled(load))
        row_mu = rates.mu[program.source[columns.rows]]
        more = np.zeros(len(columns.row))
        heads = []
        for force in forces:
            more[: len(columns.rows)] = row_mu * force[: len(columns.rows)]
            heads.append(more.copy())
        return np.concatenate(balance), np.concatenate(heads)

    def _power(self) -> LimitPower:
        """The rates of rows without forces."""
        program, none = self.program, np.zeros((len(self.program.names), 6))
        count = len(program.part_a)
        solved = SolvedLimit(
            program, np.zeros(count), np.zeros((count, 3)), none, none, 0.0, None, none[:, :3]
        )
        return LimitPower(solved, self.rates, self.assembly.geometry)

    def _rates(self, variable: _Variable, sign: int) -> Rates:
        """Rates of all data per unit of a variable."""
        assembly, geometry = self.assembly, self.assembly.geometry
        rates, k = no_rates(assembly, self.touching), variable.part
        amount = sign * variable.unit
        own = slice(geometry.vertex_start[k], geometry.vertex_start[k + 1])
        if variable.what == "move":
            rates.vertices[own] = amount * variable.axis
            rates.center[k] = amount * variable.axis
        elif variable.what == "mass":
            rates.mass[k] = amount
        elif variable.what == "size":
            moved, center, mass = size_rates(assembly, k, variable.size)
            rates.vertices[own], rates.center[k] = amount * moved, amount * center
            rates.mass[k] = amount * mass
        else:
            pair = {k, variable.other}
            ends = self.touching.patch_parts.tolist()
            rates.mu[[set(each) == pair for each in ends]] = amount
        return rates
