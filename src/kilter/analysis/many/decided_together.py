"""Joint verdicts of many assemblies by frictionless forces or motions.

The methods follow the order of `check`. Equilibrium forces without friction prove stability for
any friction. A motion that neither contacts nor their friction stop proves instability; open
pairs and degenerate contacts then count as contacts with any force. A stable assembly may be only
balanced, which second order decides. It is not balanced if forces on level faces fix the height
and the tilts of every part. Other assemblies are left to `check`.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from kilter.analysis.decision.doubts import fitted_pairs, has_possible_contacts
from kilter.arrays import Array, Index, Mask
from kilter.assembly.side_by_side import SideBySide
from kilter.contact.common.gaps import Tolerance
from kilter.contact.contact_set import ContactSet
from kilter.contact.detect import contacts_side_by_side
from kilter.contact.fits.suggestions import coincident
from kilter.mechanics.certificate import ForceProof, MotionProof, check_forces, check_motion
from kilter.mechanics.program import Program
from kilter.mechanics.program_blocks import BlockProofs, ProgramBlocks, program_blocks
from kilter.second_order.proofs.level_rest import level_rows, rest_on_level
from kilter.second_order.searches.level_rest_search import rests_level
from kilter.solvers.blocks import solve_blocks

__all__ = ["Together", "decide_together"]


@dataclass(frozen=True, slots=True, eq=False)
class Together:
    """Proofs for M assemblies that were decided in a single computation."""

    stable: Mask
    unstable: Mask
    """Whether an assembly is proved stable, and not only balanced, or unstable, shape (M,); if
    neither, `check` must decide."""
    certain: tuple[ProgramBlocks, BlockProofs]
    outer: tuple[ProgramBlocks, BlockProofs] | None
    """Programs and proofs with the certain contacts, and with all possible contacts; `outer` is
    None if it was not necessary."""
    in_outer: Mask
    """Whether the proof of an assembly is in `outer`, shape (M,)."""

    def decides(self, k: int) -> bool:
        """Whether the batch computation proves assembly k stable or unstable."""
        return bool(self.stable[k] or self.unstable[k])

    def _block_of(self, k: int) -> tuple[ProgramBlocks, BlockProofs]:
        """Programs and proofs of the block of assemblies to which assembly k belongs."""
        outer = self.outer if self.in_outer[k] else None
        return self.certain if outer is None else outer

    def proofs(self, k: int) -> BlockProofs:
        """Proofs of the block of assemblies to which assembly k belongs."""
        return self._block_of(k)[1]

    def certificate(self, k: int) -> tuple[Program, ForceProof | MotionProof]:
        """The program of assembly k and its proof, verified without the other assemblies."""
        blocks, proofs = self._block_of(k)
        program = blocks.program(k)
        if self.stable[k]:
            return program, check_forces(
                program, proofs.forces[slice(*blocks.row_start[k : k + 2])]
            )
        if blocks.mu[k] > 0:
            program = program.with_friction(float(blocks.mu[k]))
        return program, check_motion(program, proofs.motion[slice(*blocks.start[k : k + 2])])


def decide_together(apart: SideBySide, mu: Array, tolerance: Tolerance) -> Together:
    """Decide as many assemblies as possible in a single computation without friction.

    Arguments: `mu` (M,) [-].
    """
    contacts = contacts_side_by_side(apart, tolerance)
    asked = ~_odd(apart, contacts)
    certain = program_blocks(apart, contacts, mu)
    stacked = certain.stacked(asked)
    proofs = _with_programs(certain, stacked, asked & ~stacked.stable & ~stacked.unstable)
    stable, falls = proofs.stable & asked, proofs.unstable & asked
    stable &= _rests_level(certain, contacts, proofs, stable)
    bounded = falls.any() and has_possible_contacts(contacts)
    outer = program_blocks(apart, contacts, mu, possible=True) if bounded else certain
    more = falls & (np.diff(outer.row_start) > np.diff(certain.row_start))
    if not more.any():
        return Together(stable, falls, (certain, proofs), None, more)
    kept = outer.checked(np.zeros(len(outer.whole.part_a)), proofs.motion, ~falls & falls, more)
    bounds = _with_programs(outer, kept, more & ~kept.unstable)
    unstable = np.where(more, bounds.unstable, falls)
    return Together(stable, unstable, (certain, proofs), (outer, bounds), more)


def _with_programs(blocks: ProgramBlocks, proofs: BlockProofs, left: Mask) -> BlockProofs:
    """Proofs in which the assemblies in the mask `left` have the proofs of linear programs."""
    which = np.flatnonzero(left)
    if not len(which):
        return proofs
    few = blocks.among(which)
    solved = few.judged(solve_blocks(few.scaled, np.arange(len(which))))
    places = {"forces": blocks.rows(which), "motion": blocks.parts(which)}
    merged = {}
    for field in fields(BlockProofs):
        merged[field.name] = getattr(proofs, field.name).copy()
        merged[field.name][places.get(field.name, which)] = getattr(solved, field.name)
    return BlockProofs(**merged)


def _odd(apart: SideBySide, contacts: ContactSet) -> Mask:
    """Mask of the assemblies with coincident parts or with fitted contact normals, shape (M,)."""
    owner = apart.owner
    odd = np.zeros(len(apart), dtype=bool)
    parts: Index = np.array([pair.ends[0] for pair in coincident(contacts)], dtype=np.int64)
    odd[owner[parts]] = True
    odd[owner[fitted_pairs(contacts)[:, 0]]] = True
    return odd


def _rests_level(
    blocks: ProgramBlocks, contacts: ContactSet, proofs: BlockProofs, stable: Mask
) -> Mask:
    """Mask of the stable assemblies whose parts rest on horizontal faces, shape (M,)."""
    rests = np.zeros_like(stable)
    chosen = np.flatnonzero(stable)
    few, program = blocks.among(chosen), blocks.upright(chosen)
    rows = blocks.rows(chosen)
    rests[chosen] = rest_on_level(
        program, level_rows(program, contacts), proofs.forces[rows], few.owner
    )
    for k in np.flatnonzero(stable & ~rests).tolist():
        # another distribution of the load may fix the parts
        single = blocks.program(k)
        rows = blocks.rows(np.array([k]))
        rests[k] = rests_level(single, level_rows(single, contacts), proofs.forces[rows])
    return rests
