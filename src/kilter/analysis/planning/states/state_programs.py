"""Programs of the states of a half-built assembly, taken from the program of all parts.

A state is a set S of parts that are present and a set H of them that are held. Its program has
the rows between present parts of which one is free, F = S - H - G (G: the grounded parts):

    J_SF^T f + w_F = 0        the rows of `Program` of all parts, those of absent parts left out

Absent parts stay in the arrays as parts that are not free and that no row names, so that every
state has the parts of the assembly, by their positions.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from kilter.arrays import Array, Index, Mask
from kilter.assembly import Assembly
from kilter.contact import ContactSet
from kilter.mechanics.mechanics_tolerances import BLUR, TOLERANCE
from kilter.mechanics.program import Program, build_program
from kilter.mechanics.rows import CONTACT

__all__ = ["StatePrograms", "build_state_programs", "parts_of", "rows_of_state"]


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
