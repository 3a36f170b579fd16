"""Verdicts on a half-built assembly, for any set of present parts and any held parts.

A state has the present parts S, of which H are held. It holds if contact forces keep the other
parts in equilibrium (the level "equilibrium" of `kilter.check`). A planner needs thousands of such
verdicts, so the contacts are detected once, and the methods below are tried in turn. The first
certificate that is verified in the state itself decides.

1. Forces along gravity, if no part is held (`kilter.analysis.planning.states.load_paths`): they
   hold the states of layered structures, such as walls, without a search.
2. Forces or a motion of an earlier state (`kilter.analysis.planning.states.known_proofs`).
3. A linear program with friction pyramids, warm-started from the last state, if the state is
   small or near the last state.
4. Exact friction cones, without a warm start. They hold some states that pyramids do not hold.
5. Choices of normals at edges and corners, if the state falls by its certain contacts and holds
   with all possible contacts. If they do not decide, the state is undecided.
6. `kilter.check` of the state, if fitted normals, the accuracy that the file declares, or the
   numerics leave it undecided.

If forces along gravity do not decide a state of several groups of parts that do not touch, each
group is judged by itself, and kept: a state that changes by one part needs the proof of one group.

Each state may also have to hold while its carrier accelerates: it then holds under the gravity
g - a for each given acceleration a, by proofs of its own (`kilter.analysis.transport`). The
accelerations that a state carries are a convex set, so it also carries all between them.

A state that holds also holds with more of its parts held. There is no such rule for the present
parts: both adding and removing a part can make a state fall.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from kilter.analysis.check import check
from kilter.analysis.decision.cascade import Decision, decide
from kilter.analysis.decision.doubts import doubts_of
from kilter.analysis.decision.judge import Judgement, judge
from kilter.analysis.equal_groups import equal_groups
from kilter.analysis.planning.states.holds import Holds, bits_of, find_fewest_holds
from kilter.analysis.planning.states.known_proofs import (
    KnownForces,
    KnownMotion,
    PyramidProgram,
    State,
    StatePrograms,
    build_state_programs,
    forces_for_others,
    motions_for_others,
    rows_of_state,
)
from kilter.analysis.planning.states.load_paths import LoadPaths
from kilter.arrays import Array, Index, Mask, connected
from kilter.assembly import Assembly
from kilter.assembly.bonds import NOT_SET, require_no_bonds
from kilter.assembly.question import Question, question
from kilter.contact import ContactSet, detect
from kilter.contact.fits.suggestions import require_apart
from kilter.contact.kept_contacts import contacts_among
from kilter.errors import InputError
from kilter.mechanics.certificate import (
    ForceProof,
    MotionProof,
    check_forces,
    check_motion,
)
from kilter.mechanics.program import Program, build_program
from kilter.mechanics.proof import Evidence, make_proof
from kilter.rigid import unit
from kilter.tell.levels import level_rank
from kilter.threads import on_one_thread
from kilter.validate import finite, number
from kilter.work import Work, units_of

SMALL, NEAR = 20, 4
"""Numbers of free parts, and of parts that differ from the last state, up to which a state is
solved by the linear program before the exact cones."""

# Parts that touch each other, but no other free part: a state holds if each of its groups does.


def label_groups(contacts: ContactSet, outer: Program) -> Index:
    """Number of the group of each part, shape (N,): free parts of one group may touch each other.

    Arguments: `outer`: the program with all possible forces.
    """
    free = np.append(outer.free, False)
    points = contacts.degenerate
    degenerate = np.column_stack([points.part_a, points.part_b])
    rows = np.column_stack([outer.part_a, outer.part_b])
    pairs = np.concatenate([rows, contacts.adjacent, degenerate])
    inner = np.unique(pairs[free[pairs].all(axis=1)], axis=0)
    return connected(len(outer.free), inner[:, 0], inner[:, 1])


class StateGroup:
    """A group of parts that touch no other free part, with the verdicts on its states.

    - `free`: mask of its parts, shape (N,); `bits`: the same as a bit set.
    """

    def __init__(self, states: States, programs: StatePrograms, parts: Mask) -> None:
        self._of, self._programs = states, programs
        self.free = programs.free & parts
        self.bits = bits_of(self.free)
        self._last, self._on = (0, 0), np.empty(0, dtype=int)
        self._found: dict[tuple[int, int], State] = {}
        self._states: States | None = None

    @property
    def states(self) -> States:
        """The verdicts on states of this group alone, with the grounded parts."""
        if self._states is None:
            whole = self._of
            programs = self._programs.among(self.free)
            self._states = States(whole.assembly, whole.contacts, programs=programs)
            self._states.counts, self._states._count = whole.counts, whole._count
            self._states.carried = tuple(
                next(group.states for group in other.groups if group.bits == self.bits)
                for other in whole.carried
            )
        return self._states

    def judge(self, known: tuple[int, int], state: State) -> State:
        """The state of this group in a state of all parts.

        Arguments: `known`: its present parts and those that are not free, and its free parts.
        """
        if known not in self._found:
            present = state.present & (self.free | ~self._programs.free)
            self._found[known] = self.states._judge_at_rest(present, present & ~state.free)
        return self._found[known]

    def put(self, known: tuple[int, int], state: State, forces: Array, friction: Array) -> None:
        """Put the forces of a state of this group in the place of those that it put last.

        `forces`, shape (K,), and `friction`, (K, 3), have the rows of all parts.
        """
        if known == self._last:
            return
        forces[self._on], friction[self._on] = 0.0, 0.0
        rows = rows_of_state(self._programs.whole, state.present, state.free)
        self._last, self._on = known, np.flatnonzero(rows)
        if state.forces is not None:
            forces[self._on], friction[self._on] = state.forces.forces, state.forces.friction


_Found = ForceProof | MotionProof | Judgement | None


class States:
    """Verdicts on the states of an assembly; a state has some parts present and some held.

    Parameters
    ----------
    assembly : Assembly
    contacts : ContactSet
        Contacts of the assembly.
    accelerations : iterable of array_like, shape (3,)
        Accelerations of the carrier at which a state must hold, besides at rest [m/s^2].

    Attributes
    ----------
    assembly, contacts
    carried : tuple of States
        The states of the same assembly at each of these accelerations.
    counts : dict
        Numbers of states by key: requested (`asked`), held by forces along gravity (`paths`),
        decided by an earlier proof (`known`), solved by linear `programs` or exact `cones`, left
        `open` by possible contacts, and decided by `kilter.check` (`checks`).

    See Also
    --------
    states : Constructor from an assembly.
    """

    def __init__(
        self,
        assembly: Assembly,
        contacts: ContactSet,
        *,
        programs: StatePrograms | None = None,
        accelerations: Iterable[ArrayLike] = (),
    ) -> None:
        self.assembly = assembly
        self.contacts = contacts
        ways = ("asked", "paths", "known", "programs", "cones", "open", "checks")
        self.counts = dict.fromkeys(ways, 0)
        self._count = Work()
        self._programs: StatePrograms = programs or build_state_programs(assembly, contacts)
        self._doubts = doubts_of(assembly, contacts)
        self._paths: LoadPaths | None = None
        self._pyramid: PyramidProgram | None = None
        self._forces: list[KnownForces] = []
        self._motions: list[KnownMotion] = []
        self._found: dict[tuple[int, int], State] = {}
        self._under: dict[tuple[float, ...], States] = {}
        self._groups: tuple[StateGroup, ...] | None = None
        self._parted = False
        if not isinstance(accelerations, Iterable):
            raise InputError(
                f"accelerations is {accelerations!r:.40}", hint="give a list of vectors in m/s^2"
            )
        felt = [
            replace(assembly, gravity=assembly.gravity - finite(one, (3,), "acceleration"))
            for one in accelerations
        ]
        self.carried: tuple[States, ...] = tuple(States(one, contacts.of(one)) for one in felt)

    def __len__(self) -> int:
        return len(self._found)

    def __repr__(self) -> str:
        return f"<States: of {len(self.assembly)} parts, {len(self)} known>"

    def of(
        self,
        present: str | Iterable[str] = "*",
        held: str | Iterable[str] = (),
        *,
        down: ArrayLike | None = None,
        friction: float | None = None,
    ) -> State:
        """Judge the state with the given present and held parts, by name.

        Parameters
        ----------
        present : str or iterable of str
            Names or glob patterns with ``*`` and ``?``. Grounded parts must be named, too.
        held : str or iterable of str
            Parts held in addition to the grounded parts.
        down, friction
            Gravity direction and friction coefficient as in `under`.

        Raises
        ------
        InputError
            If a name matches no part, a held part is not present, or `down` or `friction` is
            invalid.

        Examples
        --------
        >>> from kilter.scenes import scene
        >>> tower = states(scene("tower"))
        >>> tower.of(), tower.of(["base", "cube-2"])
        (<State: 6 parts, 5 free, holds>, <State: 2 parts, 1 free, falls>)
        >>> tower.of(["base", "cube-2"], held="cube-2").stable
        True
        >>> tower.of(down=[0.1, 0, -1]).stable, tower.of(down=[0.1, 0, -1], friction=0.2).stable
        (False, True)
        """
        standing, kept = self.mask(present), self.mask(held)
        if (kept & ~standing).any():
            name = self.assembly.names[int(np.flatnonzero(kept & ~standing)[0])]
            raise InputError("is held but not present", part=name, hint="name it in both")
        return self.under(down=down, friction=friction).judge(standing, kept)

    def under(self, *, down: ArrayLike | None = None, friction: float | None = None) -> States:
        """Copy of these states with another direction of gravity or friction coefficient.

        Parameters
        ----------
        down : array_like, shape (3,), optional
            Direction of gravity in the world frame; need not be a unit vector.
        friction : float, optional
            Friction coefficient of every contact [-].

        Raises
        ------
        InputError
            If the direction is zero, or the coefficient is negative.
        """
        if down is None and friction is None:
            return self
        along = self.assembly.down if down is None else unit(finite(down, (3,), "down"), "down")
        mu = -1.0 if friction is None else number(friction, "friction", lowest=0)
        key = (*along.tolist(), mu)
        if key not in self._under:
            assembly = self.assembly if down is None else self.assembly.with_down(along)
            contacts = self.contacts if friction is None else self.contacts.with_friction(mu)
            rows = None if friction is not None else self._programs.turned(along)
            self._under[key] = States(assembly, contacts.of(assembly), programs=rows)
        return self._under[key]

    @on_one_thread
    def fewest_holds(
        self,
        present: str | Iterable[str] = "*",
        *,
        among: str | Iterable[str] = "*",
        most: int | None = None,
    ) -> Holds[State]:
        """Find the fewest parts to hold, beside the grounded parts, so that present parts stand.

        Parameters
        ----------
        present : str or iterable of str
            Present parts as in `of`.
        among : str or iterable of str
            Parts that may be held.
        most : int, optional
            Largest number of held parts to consider.

        Raises
        ------
        InputError
            If a name matches no part.

        Examples
        --------
        >>> from kilter.scenes.arches import arch
        >>> open_arch = states(arch(9, ratio=0.3, friction=0.6).without("voussoir-4"))
        >>> open_arch.fewest_holds()
        <Holds: voussoir-3, voussoir-5>
        >>> open_arch.fewest_holds(most=1)
        <Holds: none, 2 or more are needed>
        """
        standing, movable = self.mask(present), self.mask(among) & self._programs.free
        return self.holds_of(standing, movable, most=most)

    def holds_of(self, present: Mask, movable: Mask, *, most: int | None = None) -> Holds[State]:
        """Find the fewest parts to hold, from masks of present and holdable parts, shape (N,)."""
        return find_fewest_holds(self.judge, self.assembly.names, present, movable, most=most)

    @property
    def units(self) -> float:
        """Units of work of the programs and of the tests of stored proofs (`kilter.work`)."""
        return self._count.total

    @property
    def no_goods(self) -> int:
        """Number of stored motions; each proves that every state that allows the motion falls."""
        return len(self._motions)

    @property
    def free(self) -> Mask:
        """Mask of the parts that no state holds by itself, shape (N,)."""
        return self._programs.free

    @property
    def groups(self) -> tuple[StateGroup, ...]:
        """Groups of parts that touch each other, but no part of another group.

        Each group is judged by itself. It is empty if there are fewer than two groups.
        """
        if self._groups is None:
            labels = label_groups(self.contacts, self._programs.outer)
            numbers = np.unique(labels[self.free])
            apart = len(numbers) > 1 and not self._programs.outer.has_limits
            self._groups = tuple(
                StateGroup(self, self._programs, labels == number)
                for number in (numbers if apart else numbers[:0])
            )
        return self._groups

    @cached_property
    def copies(self) -> dict[int, tuple[int, Array]]:
        """Earlier group to which a group is equal, and the turn (3, 3) from that to this group.

        The groups are bit sets. Equal groups have the same shapes in the same order, in the same
        places up to a shift and a turn about the vertical. Their contacts and loads may differ.
        """
        bits = [group.bits for group in self.groups]
        equal = equal_groups(self.assembly, [np.flatnonzero(group.free) for group in self.groups])
        return {bits[k]: (bits[source], turn) for k, (source, turn) in equal.items()}

    def mask(self, patterns: str | Iterable[str]) -> Mask:
        """Mask of the parts whose names match the patterns, shape (N,).

        Raises
        ------
        InputError
            If a pattern matches no part.
        """
        chosen = self.assembly.matching(patterns)
        return np.array([name in chosen for name in self.assembly.names], dtype=bool)

    def judge(self, present: Mask, held: Mask) -> State:
        """Judge the state with masks of present and held parts, shape (N,).

        Absent parts cannot be held: `held` is ignored for them. If the state holds at rest but not
        at an acceleration of the carrier, it is returned as it is at this acceleration.
        """
        state = self._judge_at_rest(present, held)
        for accelerated in self.carried:
            if state.stable is False:
                break
            other = accelerated.judge(present, held)
            if other.stable is False or (state.stable and not other.stable):
                state = other
        return state

    def _judge_at_rest(self, present: Mask, held: Mask) -> State:
        """Judge a state without acceleration of its carrier."""
        free = self._programs.free & present & ~held
        key = bits_of(present), bits_of(free)
        state = self._found.get(key)
        if state is None:
            self.counts["asked"] += 1
            state = self._found[key] = self._decide_state(present, free, key)
        return state

    @on_one_thread
    def _decide_state(self, present: Mask, free: Mask, key: tuple[int, int]) -> State:
        """Decide a state by the methods of the module docstring in turn, if it is not stored."""
        held = present & ~free
        state = State(self.assembly.names, present, free, None, self._programs)
        if self._parted:
            known = self._by_groups(state, key)
            if known is not None:
                return known
        program = self._programs.of(present, held)
        proof: _Found = self._by_load_paths(state, program)
        if proof is None and self.groups and not self._parted:
            self._part()
            return self._decide_state(present, free, key)
        outer = self._programs.outer_of(present, held) if self._programs.open else program
        if proof is None:
            proof = self._matching_proof(state, program, outer, key)
        if proof is None:
            ways = [self._by_pyramid, self._by_cones]
            if self._far(state, program):
                ways.reverse()
            proof = ways[0](state, program, outer) or ways[1](state, program, outer)
            if isinstance(proof, Judgement):
                return self._hanging(state)
            if isinstance(proof, MotionProof):
                proof = self._learned_motion(outer, proof)
            elif proof is not None:
                self._learn_forces(state, proof)
        if isinstance(proof, ForceProof):
            return replace(state, stable=True, forces=proof)
        if isinstance(proof, MotionProof) and not self._doubts.explain_motion(outer, proof.motion):
            return replace(state, stable=False, outer=self._programs.open, motion=proof)
        return self._state_by_check(state)

    def _part(self) -> None:
        """Judge states by their groups from now on."""
        count = len(self._programs.whole.part_a)
        self._parted, self._base = True, bits_of(~self._programs.free)
        self._group_forces, self._group_friction = np.zeros(count), np.zeros((count, 3))

    def _by_groups(self, state: State, key: tuple[int, int]) -> State | None:
        """A state whose groups are judged one by one; None if that does not decide it.

        Forces that balance each group balance the whole (`kilter.mechanics.clusters`).
        """
        residual = 0.0
        for group in self.groups:
            known = key[0] & (group.bits | self._base), key[1] & group.bits
            own = group.judge(known, state)
            if own.motion is not None:
                return replace(state, stable=False, outer=own.outer, motion=own.motion)
            if own.forces is None:
                return None
            residual = max(residual, own.forces.residual)
            group.put(known, own, self._group_forces, self._group_friction)
        taken = rows_of_state(self._programs.whole, state.present, state.free)
        friction = self._group_friction
        across = friction[taken] if friction.any() else np.broadcast_to(0.0, (taken.sum(), 3))
        self.counts["known"] += 1
        proof = ForceProof(self._group_forces[taken], across, residual, holds=True)
        return replace(state, stable=True, forces=proof)

    def _by_load_paths(self, state: State, program: Program) -> ForceProof | None:
        """Forces along gravity that hold a layered state without held parts; None without proof."""
        whole = self._programs.whole
        if not np.array_equal(state.free, whole.free & state.present):
            return None
        if self._paths is None:
            self._paths = LoadPaths(whole)
        given = self._paths.forces(state.free)
        if given is None:
            return None
        self._count.weighed(len(program.part_a))
        rows = rows_of_state(whole, state.present, state.free)
        across = None if given[1] is None else given[1][rows]
        proof = check_forces(program, given[0][rows], across)
        self.counts["paths"] += proof.holds
        return proof if proof.holds else None

    def _matching_proof(
        self, state: State, program: Program, outer: Program, key: tuple[int, int]
    ) -> ForceProof | MotionProof | None:
        """The first stored proof that also proves this state; None if there is none."""
        # the rows of a state are taken from those of all parts even if no proof is tested
        self._count.weighed(len(program.part_a))
        for known in self._motions:
            if known.fits(*key):
                self._count.weighed(len(outer.part_a))
                motion = check_motion(outer, known.motion)
                if motion.holds:
                    self.counts["known"] += 1
                    return motion
        rows = rows_of_state(self._programs.whole, state.present, state.free)
        for entry in self._forces:
            if entry.fits(*key):
                self._count.weighed(len(program.part_a))
                forces = check_forces(program, entry.forces[rows], entry.friction[rows])
                if forces.holds:
                    self.counts["known"] += 1
                    return forces
        return None

    def _far(self, state: State, program: Program) -> bool:
        """Whether exact cones are expected to be faster than the linear program for this state."""
        free = int(state.free.sum())
        if free <= SMALL or not program.mu.any():
            return False
        return self._pyramid is None or self._pyramid.far(state.present, state.free) > NEAR

    def _by_pyramid(self, state: State, program: Program, outer: Program) -> _Found:
        """A proof for a state from the linear program with friction pyramids; None if not found."""
        if not state.free.any():
            return check_forces(program, np.zeros(len(program.part_a)))
        if self._pyramid is None:
            self._pyramid = PyramidProgram(self._programs.whole)
        self.counts["programs"] += 1
        work = Work()
        offered = self._pyramid.solve(state.present, state.free, work=work)
        self._count.charge(work.total)
        if isinstance(offered, tuple):
            rows = rows_of_state(self._programs.whole, state.present, state.free)
            forces = check_forces(program, offered[0][rows], offered[1][rows])
            return forces if forces.holds else None
        motion = None if offered is None else check_motion(outer, offered)
        return motion if motion is not None and motion.holds else None

    def _by_cones(self, state: State, program: Program, outer: Program) -> _Found:
        """A proof for a state from exact friction cones; None if not found.

        A Judgement is returned if only possible contacts hold the state.
        """
        self.counts["cones"] += 1
        judgement = self._judge_counted(program)
        if judgement.stable is False and outer is not program:
            judgement = self._judge_counted(outer)
            if judgement.stable:
                return judgement
        if judgement.stable is None:
            return None
        return judgement.forces if judgement.stable else judgement.motion

    def _judge_counted(self, program: Program) -> Judgement:
        """Decide whether forces balance a program, and count the units of work."""
        work = Work()
        judgement = judge(program, work=work)
        self._count.charge(work.total)
        return judgement

    def _learn_forces(self, state: State, proof: ForceProof) -> None:
        """Store forces for reuse, unless stored forces already cover the same states."""
        whole = self._programs.whole
        rows = rows_of_state(whole, state.present, state.free)
        new = forces_for_others(whole, rows, proof, state.free)
        if not any(old.covers(new) for old in self._forces):
            self._forces.append(new)

    def _learned_motion(self, outer: Program, proof: MotionProof) -> MotionProof:
        """Store the motion of each connected group of parts for reuse; return the strongest.

        A motion is not stored if a stored motion proves at least as many states.
        """
        motions = motions_for_others(self._programs.outer, outer, proof)
        for new in motions:
            if not any(old.covers(new) for old in self._motions):
                self._motions.append(new)
        strongest = check_motion(outer, motions[0].motion)
        return strongest if strongest.holds else proof

    def _hanging(self, state: State) -> State:
        """Decide a state that falls with its certain contacts, but may hold with possible contacts.

        Only a choice of normals at degenerate points may still prove that such a state falls.
        """
        self.counts["open"] += 1
        if not self._doubts.normals_open(state.present):
            return state
        assembly = self.sub_assembly(state)
        decision = decide(
            assembly,
            contacts_among(self.contacts, assembly),
            require="equilibrium",
            second_order=False,
            question=False,
        )
        return state if decision.verdict == "undecided" else self._state_by_check(state)

    def _state_by_check(self, state: State) -> State:
        """Judge a state by the full `kilter.check`."""
        self.counts["checks"] += 1
        assembly = self.sub_assembly(state)
        contacts = contacts_among(self.contacts, assembly)
        verdict = check(assembly, contacts=contacts, require="equilibrium", effort=0)
        stable = None if verdict.verdict == "undecided" else verdict.stable
        return replace(state, stable=stable, verdict=verdict)

    def finished(self, *, require: str, effort: float, work: Work) -> tuple[State, Decision]:
        """State of the whole assembly with only its grounded parts held, and its decision.

        Parameters are those of `decide`. The decision comes first: if open pairs decide, the state
        is undecided, and no second search is needed.
        """
        present, grounded = np.ones(len(self.assembly), dtype=bool), ~self._programs.free
        state = State(self.assembly.names, present, self._programs.free, None, self._programs)
        decision = self.decide(state, require=require, effort=effort, work=work, finished=True)
        if decision.question is not None:
            return state, decision
        decisions = [decision] + [
            accelerated.finished(require=require, effort=effort, work=work)[1]
            for accelerated in self.carried
        ]
        lowest = min(decisions, key=lambda decision: level_rank(decision.level))
        return self.judge(present, grounded), lowest

    def decide(
        self,
        state: State,
        *,
        require: str,
        effort: float,
        work: Work | None = None,
        finished: bool = False,
    ) -> Decision:
        """Decide a state as an assembly of its own, as `kilter.check` would.

        Parameters
        ----------
        state : State
        require : {"equilibrium", "settles", "proved"}
            Level at which the decision may stop.
        effort : float
            Effort of the guarantee of friction.
        work : Work, optional
            Work whose time limit also applies.
        finished : bool
            Whether to analyse second order and find the deciding open pairs, too.
        """
        allowed = Work(units_of(effort)) if work is None else work.beside(units_of(effort))
        assembly = self.sub_assembly(state)
        contacts = contacts_among(self.contacts, assembly)
        return decide(
            assembly,
            contacts,
            require=require,
            work=allowed,
            second_order=finished,
            question=finished,
        )

    def level(
        self, state: State, *, require: str, effort: float, work: Work | None = None
    ) -> str | None:
        """Verdict level that a state reaches by first-order motions; None if it does not hold.

        Parameters are those of `decide`.
        """
        levels = [self._level_at_rest(state, require, effort, work)]
        for accelerated in self.carried:
            if levels[-1] is None:
                return None
            other = accelerated.judge(state.present, state.present & ~state.free)
            levels.append(accelerated.level(other, require=require, effort=effort, work=work))
        return min(levels, key=level_rank)

    def _level_at_rest(
        self, state: State, require: str, effort: float, work: Work | None
    ) -> str | None:
        """Verdict level that a state reaches without acceleration of its carrier."""
        if not state.stable:
            return None
        if state.verdict is not None and state.verdict.level is not None:
            return state.verdict.level
        if state.forces is not None and not state.forces.friction.any():
            return "proved"
        if judge(state.program.frictionless).stable:
            return "proved"
        if require == "equilibrium":
            return "equilibrium"
        return self.decide(state, require=require, effort=effort, work=work).level

    def sub_assembly(self, state: State) -> Assembly:
        """The present parts of a state as an assembly, with the held parts grounded."""
        names = np.array(self.assembly.names)
        assembly = self.assembly
        if not state.present.all():
            assembly = assembly.without(names[~state.present].tolist())
        held = names[state.present & ~state.free].tolist()
        return assembly.with_grips(held) if held else assembly

    def held_names(self, state: State) -> list[str]:
        """Names of the held parts of a state, without the grounded parts."""
        held = state.present & ~state.free & self._programs.free
        return [name for name, kept in zip(self.assembly.names, held, strict=True) if kept]

    def owner(self, state: State) -> States:
        """The states to which a state belongs: these, or those at an acceleration of the carrier.

        A state of another owner was judged at the acceleration at which it does not hold.
        """
        for accelerated in self.carried:
            if np.array_equal(state.program.gravity, accelerated.assembly.gravity):
                return accelerated
        return self

    def proof(self, state: State, *, options: dict[str, Any] | None = None) -> dict[str, Any]:
        """Proof of a state as JSON data, for `kilter.verify` with its `sub_assembly`.

        Parameters
        ----------
        state : State
        options : dict, optional
            Options with which the file is read, copied to the proof file.

        Raises
        ------
        InputError
            If the state is undecided.
        """
        owner = self.owner(state)
        if owner is not self:
            return owner.proof(state, options=options)
        if state.stable is None and state.verdict is None:
            state = self._state_by_check(state)
        if state.verdict is not None:
            return state.verdict.proof(options=options or {})
        assembly = self.sub_assembly(state)
        contacts = contacts_among(self.contacts, assembly)
        program = build_program(assembly, contacts, possible=state.motion is not None)
        if state.motion is not None:
            motion = check_motion(program, state.motion.motion[state.present])
            return make_proof(assembly, contacts, program, motion, options or {})
        evidence = Evidence("open") if program.mu.any() else None
        return make_proof(
            assembly, contacts, program, state.forces, options or {}, evidence=evidence
        )


@question(lacks="require effort")
def states(
    asked: Question,
    *,
    accelerations: Iterable[ArrayLike] = (),
) -> States:
    """Prepare verdicts on all states of an assembly that is being built.

    Parameters
    ----------
    assembly : Assembly, or path
        Finished assembly; its grounded parts are held in every state in which they are present.
    time_limit : float, optional
        Time limit [s]. It ends the contact search, as in `kilter.contacts`.
    accelerations : iterable of array_like, shape (3,)
        Accelerations of the carrier at which a state must hold, besides at rest [m/s^2].

    Raises
    ------
    InputError
        If the geometry is not usable, or an acceleration leaves the parts in free fall.

    See Also
    --------
    kilter.plan : a search for an order.
    kilter.check : the complete answer for one state.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> arch = states(scene("arch"))
    >>> arch.of().stable, arch.of("springer*").stable
    (True, True)
    >>> without = [name for name in arch.assembly.names if name != "voussoir-10"]
    >>> arch.of(without).stable
    False
    >>> arch.of(without, held=["voussoir-9", "voussoir-11"]).stable
    True
    """
    require_no_bonds(asked.assembly, "states", NOT_SET)
    contacts = detect.touching(asked)
    require_apart(asked.assembly, contacts)
    return States(asked.assembly, contacts, accelerations=accelerations)
