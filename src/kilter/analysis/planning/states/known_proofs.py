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

from dataclasses import dataclass

import numpy as np

from kilter.analysis.planning.states.part_sets import bits_of
from kilter.analysis.planning.states.state_programs import parts_of
from kilter.arrays import TINY, Array, Mask, connected
from kilter.mechanics.certificate import (
    ForceProof,
    MotionProof,
    check_motion,
    part_sizes,
    violations,
)
from kilter.mechanics.mechanics_tolerances import RULED_OUT, STILL
from kilter.mechanics.program import Program
from kilter.mechanics.proof_limits import power_limit

__all__ = ["KnownForces", "KnownMotion", "forces_for_others", "motions_for_others"]


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
