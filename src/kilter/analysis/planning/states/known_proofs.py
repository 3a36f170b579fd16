"""Reuse of proved forces and motions as proofs for other states of a half-built assembly.

A state has some of the parts present, and some of these held.

Forces f that balance the free parts F, on parts of P alone, prove every state (S', H') with

    F' among F,   P among S'            F' = S' - H' - G

and a motion of the parts M that enters no part but those of Q proves that nothing holds

    M among F',   no part of Q in S'

Both are kept as sets, asked for in the order in which they were found, and judged again in the
state that they are to prove: a set that fits is no proof yet.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from kilter.analysis.planning.states.holds import bits_of
from kilter.analysis.verdict.verdict import Verdict
from kilter.arrays import TINY, Array, Index, Mask, connected
from kilter.assembly import Assembly
from kilter.contact import ContactSet
from kilter.mechanics.certificate import (
    ForceProof,
    MotionProof,
    check_motion,
    part_sizes,
    violations,
)
from kilter.mechanics.clusters import power_limit
from kilter.mechanics.coulomb_cones import pyramid, pyramid_forces
from kilter.mechanics.forms import load_factor, scaled_problem
from kilter.mechanics.mechanics_tolerances import BLUR, RULED_OUT, STILL, TOLERANCE
from kilter.mechanics.program import Program, build_program
from kilter.mechanics.rows import CONTACT
from kilter.work import Work

# Programs of the states of a half-built assembly, taken from the program of all parts.


@dataclass(frozen=True, slots=True, eq=False)
class StatePrograms:
    """The program of all parts, from which the program of any state is taken."""

    whole: Program
    """All parts present, none held but the grounded ones."""
    outer: Program
    """The same with every force that contacts which are not modelled might bring; `whole` itself
    where there are none."""
    patch_blur: Array
    """The tolerance that the accuracy of each patch asks for [-], shape (P,)."""

    @property
    def free(self) -> Mask:
        """Mask of the parts that are not grounded, shape (N,)."""
        return self.whole.free

    @property
    def open(self) -> bool:
        """Whether contacts that are not modelled may exert forces."""
        return self.outer is not self.whole

    def turned(self, down: Array) -> StatePrograms:
        """Copy of these programs under gravity along `down`, shape (3,), of any length."""
        whole = self.whole.turned(down)
        return replace(self, whole=whole, outer=self.outer.turned(down) if self.open else whole)

    def among(self, parts: Mask) -> StatePrograms:
        """Copy in which only the given parts, a mask of shape (N,), are free.

        It has the rows between them and with parts that are not free.
        """
        rows = [np.flatnonzero(rows_of_state(p, ~self.free | parts, parts)) for p in self.both]
        whole, outer = (
            replace(p, free=self.free & parts).taking(row)
            for p, row in zip(self.both, rows, strict=True)
        )
        return replace(self, whole=whole, outer=outer if self.open else whole)

    @property
    def both(self) -> tuple[Program, Program]:
        """The program without and with the possible forces."""
        return self.whole, self.outer

    def of(self, present: Mask, held: Mask) -> Program:
        """The program of the state with the given present and held parts, masks of shape (N,)."""
        return self.taken(self.whole, present, held)

    def outer_of(self, present: Mask, held: Mask) -> Program:
        """The program of a state with the possible forces of contacts that are not modelled."""
        return self.taken(self.outer, present, held)

    def taken(self, program: Program, present: Mask, held: Mask) -> Program:
        """Restrict a program of all parts to the rows and free parts of a state."""
        free = self.free & present & ~held
        rows = np.flatnonzero(rows_of_state(program, present, free))
        tolerance = np.full(len(free), TOLERANCE)
        contacts = rows[program.kind[rows] == CONTACT]
        blur = self.patch_blur[program.source[contacts]]
        np.maximum.at(tolerance, program.part_a[contacts], blur)
        np.maximum.at(tolerance, program.part_b[contacts], blur)
        return replace(program.taking(rows), free=free, tolerance=tolerance)


def rows_of_state(program: Program, present: Mask, free: Mask) -> Mask:
    """Mask of the rows between present parts at least one of which is free, shape (K,)."""
    here, moves = np.append(present, True), np.append(free, False)
    a, b = program.part_a, program.part_b
    rows: Mask = here[a] & here[b] & (moves[a] | moves[b])
    return rows


def build_state_programs(assembly: Assembly, contacts: ContactSet) -> StatePrograms:
    """Build the program of all parts, with and without forces that are not modelled."""
    whole = build_program(assembly, contacts)
    outer = build_program(assembly, contacts, possible=True)
    blur: Array = np.maximum(TOLERANCE, BLUR * contacts.patch_accuracy)
    return StatePrograms(whole, outer if len(outer.part_a) > len(whole.part_a) else whole, blur)


def parts_of(program: Program, rows: Index) -> Mask:
    """Mask of the parts on which the given rows act, shape (N,), without the ground."""
    is_part = np.zeros(len(program.names) + 1, dtype=bool)
    is_part[program.part_a[rows]] = is_part[program.part_b[rows]] = True
    return is_part[:-1]


@dataclass(frozen=True, slots=True, eq=False)
class KnownForces:
    """Proved forces on all contacts of an assembly, and the states that they may hold."""

    forces: Array
    friction: Array
    """[N], shape (K,)."""
    balanced: int
    needed: int
    """The sets F and P."""

    def fits(self, present: int, free: int) -> bool:
        """Whether these forces may balance a state, given its present and free parts (bit sets)."""
        return not free & ~self.balanced and not self.needed & ~present

    def covers(self, other: KnownForces) -> bool:
        """Whether these forces may balance every state that the other forces may balance."""
        return not other.balanced & ~self.balanced and not self.needed & ~other.needed


@dataclass(frozen=True, slots=True, eq=False)
class KnownMotion:
    """A proved motion of all parts, shape (N, 6), and the states for which it may be a proof."""

    motion: Array
    """[length unit, rad], shape (N, 6)."""
    moving: int
    entered: int
    """The sets M and Q."""

    def fits(self, present: int, free: int) -> bool:
        """Whether this motion may prove that a state falls, given its present and free parts."""
        return not self.moving & ~free and not self.entered & present

    def covers(self, other: KnownMotion) -> bool:
        """Whether this motion may prove every state that the other motion may prove."""
        return not self.moving & ~other.moving and not self.entered & ~other.entered


def forces_for_others(whole: Program, rows: Mask, proof: ForceProof, free: Mask) -> KnownForces:
    """Convert forces that hold one state into forces that may be reused for other states.

    Arguments: `rows` (K,): its rows that the state has; `free` (N,).
    """
    forces, friction = np.zeros(len(rows)), np.zeros((len(rows), 3))
    forces[rows], friction[rows] = proof.forces, proof.friction
    push = np.flatnonzero((forces != 0) | friction.any(axis=1))
    return KnownForces(forces, friction, bits_of(free), bits_of(parts_of(whole, push)))


def motions_for_others(outer: Program, state: Program, proof: MotionProof) -> list[KnownMotion]:
    """Split a proved motion into motions of connected groups of parts, reusable for other states.

    Returns those that prove the state by themselves, the strongest first; where none does, the
    whole.
    """
    sizes = part_sizes(state, proof.motion, per_radius=False)
    moving = sizes > STILL * sizes.max(initial=TINY)
    a, b = state.part_a, state.part_b
    moves = np.append(moving, False)
    both = moves[a] & moves[b]
    label = connected(len(moving), a[both], b[both])
    alone = [(label == k) & moving for k in np.unique(label[moving])]
    groups = []
    for group in alone:
        motion = check_motion(state, np.where(group[:, None], proof.motion, 0.0))
        if motion.holds:
            groups.append((motion, group))
    if not groups:
        groups = [(proof, sizes > 0)]
    groups.sort(key=lambda pair: -pair[0].ratio)
    return [_stored_motion(outer, motion, group) for motion, group in groups]


def _stored_motion(outer: Program, proof: MotionProof, moving: Mask) -> KnownMotion:
    """Store a proved motion, with the parts that it would penetrate if they were present."""
    sizes = part_sizes(outer, proof.motion, per_radius=False)
    level = np.zeros(len(outer.part_a))
    spare = proof.power - power_limit(outer, level, sizes).largest(outer.weight[None])
    total = float(outer.weight[outer.free].sum())
    most = max(spare / (2 * RULED_OUT * total), proof.violation)
    opened = violations(outer, proof.motion)
    entered = parts_of(outer, np.flatnonzero(opened < -most)) & ~moving
    return KnownMotion(proof.motion, bits_of(moving), bits_of(entered))


# A linear program for the load factor of many states, which only changes its bounds.


SIDES = 4
"""Rays of each pyramid in space."""


class PyramidProgram:
    """The load factor of each state of an assembly, with friction pyramids in place of cones.

    - `solves`: number of programs that were solved.
    """

    def __init__(self, whole: Program) -> None:
        from kilter.solvers.highs import KeptProgram

        self._whole = whole
        self._rays = pyramid(whole, SIDES)
        self._problem = scaled_problem(self._rays)
        program = load_factor(self._problem)
        self._kept = KeptProgram(program, warm="dual", goal="point")
        self._lower, self._upper = program.lower[:-1], program.upper[:-1]
        self._free, self._present = whole.free.copy(), np.ones(len(whole.free), dtype=bool)
        self._on = np.ones(len(self._upper), dtype=bool)

    @property
    def solves(self) -> int:
        """Number of linear programs that were solved."""
        return self._kept.solves

    def far(self, present: Mask, free: Mask) -> int:
        """Number of parts whose presence or freedom differs from the state that was solved last."""
        return int(((present != self._present) | (free != self._free)).sum())

    def solve(
        self, present: Mask, free: Mask, *, work: Work | None = None
    ) -> tuple[Array, Array] | Array | None:
        """Solve a state: balancing forces (normal, tangential), or a motion; None if unsolved.

        Arguments: `present`, `free` (N,). Returns (K,).
        """
        self._change(present, free)
        answer = self._kept.solve(work=work)
        if not answer.found:
            return None
        factor = float(answer.x[-1])
        if factor > 0.5:
            forces = self._problem.forces(answer.x[:-1]) / factor
            return pyramid_forces(self._whole, self._rays, forces)
        if not len(answer.multipliers):
            return None
        motion = self._problem.motion(self._problem.over_weight(-answer.multipliers))
        return np.where(free[:, None], motion, 0.0)

    def _change(self, present: Mask, free: Mask) -> None:
        """Set the bounds of the linear program to those of a state."""
        on = rows_of_state(self._rays, present, free)
        columns = np.flatnonzero(on != self._on)
        if len(columns):
            lower = np.where(on[columns], self._lower[columns], 0.0)
            upper = np.where(on[columns], self._upper[columns], 0.0)
            self._kept.change_bounds(columns, lower, upper)
            self._on = on
        movable = np.flatnonzero(self._whole.free)
        changed = np.flatnonzero((free != self._free)[movable])
        if len(changed):
            per = len(self._whole.freedoms)
            rows = (changed[:, None] * per + np.arange(per)).reshape(-1)
            side = np.where(np.repeat(free[movable[changed]], per), 0.0, np.inf)
            self._kept.change_sides(rows, -side, side)
        self._present, self._free = present.copy(), free.copy()


# Verdict and proof of an assembly with some parts present and some of these held.


@dataclass(frozen=True, slots=True, eq=False)
class State:
    """Verdict and proof of a state: some parts of an assembly present, some of these held.

    Attributes
    ----------
    names : tuple of str
        Names of all N parts.
    present, free : ndarray of bool, shape (N,)
        Masks of the present parts, and of the present parts that are neither held nor grounded.
    stable : bool or None
        Whether contact forces can hold the state (level equilibrium); None if undecided.
        `kilter.check` requires the level settles by default: `States.level` gives the level.
    programs : StatePrograms
        Programs of the assembly, from which `program` is taken.
    outer : bool
        Whether the proof refers to the program with the forces of contacts that are not modelled.
    forces : ForceProof or None
        Proof that the state holds.
    motion : MotionProof or None
        Proof that the state falls.
    verdict : Verdict or None
        Answer of `kilter.check` with its own proof; None if a simpler method decided.
    """

    names: tuple[str, ...]
    present: Mask
    free: Mask
    stable: bool | None
    programs: StatePrograms
    outer: bool = False
    forces: ForceProof | None = None
    motion: MotionProof | None = None
    verdict: Verdict | None = None

    @property
    def program(self) -> Program:
        """Program of the state, to whose rows the proof refers.

        It is taken anew at each call, since the programs of thousands of states would fill the
        memory.
        """
        held = self.present & ~self.free
        take = self.programs.outer_of if self.outer else self.programs.of
        return take(self.present, held)

    @property
    def moving(self) -> list[str]:
        """Names of the parts that move in this state; empty if the state holds."""
        return [name for name, moves in zip(self.names, self.moves, strict=True) if moves]

    @property
    def moves(self) -> Mask:
        """Mask of the parts that move in this state, shape (N,)."""
        if self.motion is None:
            proved_verdict = None if self.stable is not False else self.verdict
            named = set() if proved_verdict is None else set(proved_verdict.moving)
            return np.array([name in named for name in self.names], dtype=bool)
        sizes = part_sizes(self.programs.whole, self.motion.motion, per_radius=False)
        moves: Mask = sizes > STILL * sizes.max(initial=0.0)
        return moves

    def __repr__(self) -> str:
        word = {True: "holds", False: "falls", None: "undecided"}[self.stable]
        free = int(self.free.sum())
        return f"<State: {int(self.present.sum())} parts, {free} free, {word}>"

    def __bool__(self) -> bool:
        raise TypeError("a state is neither true nor false: use .stable")
