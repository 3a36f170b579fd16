"""Verdicts of assemblies side by side, where forces or a motion without friction settle them.

The order is that of `check`: forces of equilibrium prove stable whatever the friction; a motion
that nothing stops, open pairs and degenerate contacts counted as if they held by any force,
proves unstable where there is no friction. What is left over is for `check`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.analysis.decision.doubts import fitted_pairs
from kilter.arrays import Index, Mask
from kilter.assembly.side_by_side import SideBySide
from kilter.contact.contact_set import ContactSet
from kilter.contact.detect import contacts_side_by_side
from kilter.contact.fits.coincident import coincident
from kilter.contact.gaps import Tolerance
from kilter.mechanics.certificate import ForceProof, MotionProof, check_forces, check_motion
from kilter.mechanics.program import Program
from kilter.mechanics.program_blocks import BlockProofs, ProgramBlocks, program_blocks
from kilter.solvers.blocks import solve_blocks

__all__ = ["Together", "decide_together"]


@dataclass(frozen=True, slots=True, eq=False)
class Together:
    """What is proved of M assemblies side by side.

    Attributes
    ----------
    stable, unstable : ndarray of bool, shape (M,)
        None of the two: it is for `check`.
    certain, outer : pair of ProgramBlocks and BlockProofs
        Of the certain contacts, and with all that might hold; the second where it was asked.
    in_outer : ndarray of bool, shape (M,)
        The proof is one of the second.
    """

    stable: Mask
    unstable: Mask
    certain: tuple[ProgramBlocks, BlockProofs]
    outer: tuple[ProgramBlocks, BlockProofs] | None
    in_outer: Mask

    def settles(self, k: int) -> bool:
        """Whether assembly k is settled."""
        return bool(self.stable[k] or self.unstable[k])

    def _of(self, k: int) -> tuple[ProgramBlocks, BlockProofs]:
        outer = self.outer if self.in_outer[k] else None
        return self.certain if outer is None else outer

    def proofs(self, k: int) -> BlockProofs:
        """Those among which that of assembly k is."""
        return self._of(k)[1]

    def certificate(self, k: int) -> tuple[Program, ForceProof | MotionProof]:
        """The program of assembly k, and its proof, judged anew by itself."""
        blocks, proofs = self._of(k)
        program = blocks.program(k)
        if self.stable[k]:
            return program, check_forces(
                program, proofs.forces[slice(*blocks.row_start[k : k + 2])]
            )
        return program, check_motion(program, proofs.motion[slice(*blocks.start[k : k + 2])])


def decide_together(apart: SideBySide, rough: Mask, tolerance: Tolerance) -> Together:
    """Decide what can be decided of assemblies side by side.

    Parameters
    ----------
    apart : SideBySide
    rough : ndarray of bool, shape (M,)
        Some contact has friction: there a motion without it proves nothing.
    tolerance : Tolerance
    """
    contacts = contacts_side_by_side(apart, tolerance)
    asked = ~_odd(apart, contacts)
    certain = program_blocks(apart, contacts)
    proofs = certain.judged(solve_blocks(certain.scaled, np.flatnonzero(asked)))
    stable, falls = proofs.stable & asked, proofs.unstable & asked & ~rough
    outer = program_blocks(apart, contacts, possible=True) if falls.any() else certain
    more = falls & (np.diff(outer.row_start) > np.diff(certain.row_start))
    if not more.any():
        return Together(stable, falls, (certain, proofs), None, more)
    bounds = outer.judged(solve_blocks(outer.scaled, np.flatnonzero(more)))
    unstable = np.where(more, bounds.unstable, falls)
    return Together(stable, unstable, (certain, proofs), (outer, bounds), more)


def _odd(apart: SideBySide, contacts: ContactSet) -> Mask:
    """Assemblies with parts that lie on one another, or with contacts that a fit gave."""
    owner = apart.owner
    odd = np.zeros(len(apart), dtype=bool)
    parts: Index = np.array([one.parts[0] for one in coincident(contacts)], dtype=np.int64)
    odd[owner[parts]] = True
    odd[owner[fitted_pairs(contacts)[:, 0]]] = True
    return odd
