"""Assembly with candidate supports: its verdict with some of them, and supports that may help."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from kilter.analysis.decision.cascade import Decision, decide
from kilter.analysis.decision.deciding_pairs import joining_wrenches
from kilter.analysis.decision.doubts import doubts_of
from kilter.analysis.decision.judge import judge
from kilter.analysis.planning.hold.fixture import HeldSupport, Stated
from kilter.analysis.planning.hold.least_loads import least_loads
from kilter.analysis.planning.states.known_proofs import StatePrograms, build_state_programs
from kilter.analysis.smallest_set import Shares, irreducible_subset
from kilter.arrays import Array, Index, Mask, cross
from kilter.assembly import Assembly
from kilter.contact import ContactSet
from kilter.contact.supports import Support, with_supports
from kilter.mechanics.bundle import apply_change
from kilter.mechanics.certificate import ForceProof, MotionProof, part_sizes, violations
from kilter.mechanics.mechanics_tolerances import STILL
from kilter.mechanics.program import Program
from kilter.mechanics.rows import CONTACT
from kilter.units import metres_per_unit
from kilter.work import Work

LEFT = 1e-3
"""Least share of its power that a motion must keep for a set of supports to be ruled out."""


@dataclass(frozen=True, slots=True, eq=False)
class SupportedState:
    """Verdict on an assembly with a subset of its candidate supports, with the proof.

    `decision` is the decision up to the required level, of a state in equilibrium.
    """

    chosen: frozenset[int]
    stable: bool | None
    program: Program
    forces: ForceProof | None
    motion: MotionProof | None
    decision: Decision | None = None

    @property
    def moving(self) -> list[str]:
        """Names of the parts that move in the proved motion."""
        assert self.motion is not None
        sizes = part_sizes(self.program, self.motion.motion, per_radius=False)
        moves = sizes > STILL * np.max(sizes, initial=0.0)
        return [name for name, moving in zip(self.program.names, moves, strict=True) if moving]


class Supported:
    """An assembly with candidate supports, of which any subset may be present.

    `asked` counts the sets of supports that were judged.
    """

    def __init__(
        self, assembly: Assembly, contacts: ContactSet, supports: Sequence[Support]
    ) -> None:
        self.assembly, self.contacts, self.supports = assembly, contacts, tuple(supports)
        self.asked = 0
        self._acting = [k for k, support in enumerate(supports) if support.kind != "grip"]
        self._loaded, self._touching = with_supports(
            assembly, contacts, [supports[k] for k in self._acting]
        )
        self._programs: StatePrograms = build_state_programs(self._loaded, self._touching)
        self._doubts = doubts_of(self._loaded, self._touching)
        self._first = len(contacts.patch_mu)  # the first patch of a support
        self._found: dict[frozenset[int], SupportedState] = {}

    @property
    def whole(self) -> Program:
        """The program with every candidate support except the grips."""
        return self._programs.whole

    def without_supports(self) -> Program:
        """The program of the certain contacts without any candidate support."""
        return self._program(frozenset(), self._programs.whole)

    def given(self, chosen: Iterable[int]) -> tuple[list[str], list[Support]]:
        """Split chosen supports into the names of gripped parts and the other supports."""
        members = sorted(chosen)
        gripped = {self.supports[k].part for k in members if self.supports[k].kind == "grip"}
        others = [self.supports[k] for k in members if self.supports[k].kind != "grip"]
        return [name for name in self.assembly.names if name in gripped], others

    def decide(self, state: SupportedState, *, require: str, work: Work) -> SupportedState:
        """Decide the verdict of a state that is in equilibrium, up to the level `require`."""
        gripped, others = self.given(state.chosen)
        # without other supports the assembly has no part for the outside, as in a check
        supports = [support.to_dict() for support in others] or None
        change = {"held": gripped, "supports": supports}
        assembly, contacts = apply_change(self.assembly, self.contacts, change)
        decision = decide(
            assembly,
            contacts,
            require=require,
            work=work,
            second_order=not state.chosen,
            question=False,
        )
        return replace(state, decision=decision)

    def stated(self, about: str, state: SupportedState) -> Stated:
        """The proof about a set of supports with its subject."""
        gripped, others = self.given(state.chosen)
        change = {"held": gripped, "supports": [support.to_dict() for support in others]}
        proof = state.forces if state.motion is None else state.motion
        assert proof is not None
        return {"about": about, "supports": sorted(state.chosen), "change": change}, proof

    def held(self, state: SupportedState) -> tuple[HeldSupport, ...]:
        """The supports of a state that holds, with the least loads that suffice."""
        gripped, _ = self.given(state.chosen)
        hands = [self._loaded.index[name] for name in gripped]
        program = self._program(state.chosen, self._programs.whole, grips=False)
        of = self.support_rows(program)
        pulls = np.array([self.supports[k].capacity for k in self._acting] + [np.nan])
        points = np.bincount(of[of >= 0], minlength=len(self._acting))
        least = least_loads(program, hands, pulls[of] / np.append(points, 1)[of])
        held = []
        for k in sorted(state.chosen):
            support, force, torque = self.supports[k], None, None
            if least is not None and support.kind == "grip":
                load = least.hands[gripped.index(support.part)]
                force, torque = load[:3], load[3:] * metres_per_unit(self.assembly.units)
            elif least is not None:
                mine = self.support_rows(least.program) == self._acting.index(k)
                proof, normal = least.forces, least.program.normal[mine]
                force = (proof.forces[mine, None] * normal + proof.friction[mine]).sum(axis=0)
                force -= support.capacity * support.pushing(self.assembly)
            held.append(HeldSupport(**support.to_dict(), force=force, torque=torque))
        return tuple(held)

    def judge(self, chosen: Iterable[int], work: Work) -> SupportedState:
        """Judge the assembly with the chosen supports; each set is judged once."""
        key = frozenset(chosen)
        if key not in self._found:
            self.asked += 1
            self._found[key] = self._judge_chosen(key, work)
        return self._found[key]

    def _judge_chosen(self, chosen: frozenset[int], work: Work) -> SupportedState:
        """Judge the assembly with the chosen supports, first by its certain contacts alone."""
        program = self._program(chosen, self._programs.whole)
        judgement = judge(program, work=work)
        state = SupportedState(chosen, None, program, judgement.forces, None)
        if judgement.stable:
            return replace(state, stable=True)
        if judgement.stable is False and self._programs.open:
            program = self._program(chosen, self._programs.outer)
            judgement = judge(program, work=work)
        if judgement.stable is not False or self._doubts.explain_motion(program):
            return replace(state, forces=None)
        return SupportedState(chosen, False, program, None, judgement.motion)

    def _program(self, chosen: frozenset[int], whole: Program, *, grips: bool = True) -> Program:
        """The program with the chosen supports only, and with the gripped parts held if `grips`."""
        gripped = self.given(chosen)[0] if grips else []
        held = np.array([name in gripped for name in self._loaded.names], dtype=bool)
        present = np.array([k in chosen for k in self._acting], dtype=bool)
        program = replace(whole, applied=whole.applied - self._loads(~present, whole))
        of = self.support_rows(program)
        on = (of < 0) | np.append(present, True)[of]
        return self._programs.taken(program.taking(on), np.ones(len(held), dtype=bool), held)

    def support_rows(self, program: Program) -> Index:
        """Index of the support of each row, counted without grips; -1 for other rows."""
        is_support = (program.kind == CONTACT) & (program.source >= self._first)
        return np.where(is_support, program.source - self._first, -1)

    def _loads(self, which: Mask, program: Program) -> Array:
        """Total load of a subset of the supports on each part, shape (N, 6)."""
        loads = np.zeros((len(program.names), 6))
        for place in np.flatnonzero(which):
            support = self.supports[self._acting[place]]
            part = self.assembly.index[support.part]
            force = -support.capacity * support.pushing(self.assembly)
            loads[part, :3] += force
            loads[part, 3:] += cross(support.point - program.center[part], force)
        return loads

    def shares(self, state: SupportedState) -> Shares:
        """The absent supports that may stop the motion of a state, and how much work each takes."""
        assert state.motion is not None
        return shares_of(self.supports, self.whole, self._first, state.motion, state.chosen)


def shares_of(
    supports: Sequence[Support],
    whole: Program,
    first: int,
    proof: MotionProof,
    present: frozenset[int],
) -> dict[int, float]:
    """Absent supports that may stop a motion, and the fraction of its work that each takes.

    `whole` has every support but the grips, from the patch `first` on. The motion of the proof may
    lack the held part that stands for the outside.
    """
    motion = np.zeros((len(whole.names), 6))
    motion[: len(proof.motion)] = proof.motion
    moves = part_sizes(whole, motion, per_radius=False) > 0
    opening, bad = whole.velocities(motion), violations(whole, motion)
    rows = {int(whole.source[k]) - first: k for k in np.flatnonzero(whole.kind == CONTACT)}
    keeps = proof.ratio * LEFT >= 1.0
    number = {name: k for k, name in enumerate(whole.names)}
    share_of, place = {}, -1
    for k, support in enumerate(supports):
        place += support.kind != "grip"
        if k in present:
            continue
        row = rows.get(place) if support.kind != "grip" else None
        if support.kind == "grip":
            share = float(moves[number[support.part]])
        elif row is None:  # between parts that are held
            share = 0.0
        elif bad[row] < 0 or not keeps:
            share = float(bad[row] < 0 or support.capacity > 0)
        else:
            share = min(support.capacity * float(opening[row]) / proof.power, 1.0)
        if share > 0:
            share_of[k] = share
    return share_of


# Parts of a large assembly whose grips hold it, from least wrenches of grips on all parts.


WRENCHES = (1e-2, 1e-4)
"""Grips with a wrench above this are tried, in multiples of the typical weight [-]. The second
value serves if the grips of the first do not hold.
"""
REDUCING = 0.25
"""Fraction of the remaining work after which no further grip is left out [-]."""


def grips_that_hold(given: Supported, work: Work, charge: float) -> frozenset[int] | None:
    """Grips that hold an assembly, none of which can be left out; None if none were found.

    The assembly does not hold without supports, and a judgement costs `charge` units of work. If a
    quarter of the work is spent, grips may be left that are not needed.
    """
    program, index = given.without_supports(), given.assembly.index
    held = np.flatnonzero(~program.free)
    grips = [k for k, support in enumerate(given.supports) if support.kind == "grip"]
    grips = [k for k in grips if program.free[index[given.supports[k].part]]]
    if not grips or not len(held):
        return None
    ends = np.array([[held[0], index[given.supports[k].part]] for k in grips])
    norms = joining_wrenches(program, ends, work=work)
    if norms is None:
        return None
    budget = work.fraction_left(REDUCING)

    def suffices(chosen: list[int]) -> bool:
        work.charge(charge)
        return given.judge(chosen, work).stable is True

    order = np.argsort(-norms, kind="stable")
    for least in WRENCHES:
        chosen = [grips[k] for k in order[norms[order] > least].tolist()]
        if chosen and suffices(chosen):
            return frozenset(irreducible_subset(chosen, suffices, lambda: budget.over))
    return None
