"""Answers of `check_many`: arrays over all assemblies, and a full `Verdict` for each on access."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from functools import cached_property, partial
from typing import Any, overload

import numpy as np

from kilter.analysis.check import check
from kilter.analysis.decision.doubts import fitted_pairs, has_possible_contacts
from kilter.analysis.verdict.verdict import Verdict
from kilter.arrays import Array, Index, Labels, Mask
from kilter.assembly import Assembly
from kilter.assembly.array_geometry import SideBySide
from kilter.assembly.assembly_arrays import AssemblyArrays
from kilter.assembly.assumption import DRAWN
from kilter.contact.common.gaps import Tolerance
from kilter.contact.contact_set import ContactSet
from kilter.contact.detect import contacts_side_by_side
from kilter.contact.fits.suggestions import coincident
from kilter.errors import KilterError
from kilter.mechanics.certificate import ForceProof, MotionProof, check_forces, check_motion
from kilter.mechanics.program import Program, build_program
from kilter.mechanics.program_blocks import (
    BlockProofs,
    ProgramBlocks,
    cluster_blocks,
    program_blocks,
)
from kilter.second_order.proofs.level_rest import level_rows, rest_on_level
from kilter.second_order.searches.level_rest_search import rests_level
from kilter.solvers.highs import solve_blocks
from kilter.tell.levels import holds, level_of

# Joint verdicts of many assemblies by frictionless forces or motions.


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

    def _block_of(self, k: int) -> tuple[ProgramBlocks, BlockProofs]:
        """Programs and proofs of the block of assemblies to which assembly k belongs."""
        outer = self.outer if self.in_outer[k] else None
        return self.certain if outer is None else outer

    @property
    def numbers(self) -> tuple[Array, Array, Array]:
        """Residual, power and violation of the proof of each assembly, shape (M,)."""
        certain = self.certain[1]
        outer = certain if self.outer is None else self.outer[1]
        names = ("residual", "power", "violation")
        a, b, c = (
            np.where(self.in_outer, getattr(outer, name), getattr(certain, name)) for name in names
        )
        return a, b, c

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
    asked = ~_odd(apart.owner, len(apart), contacts)
    certain = program_blocks(apart, contacts, mu)
    proofs, stable = _certain_proofs(certain, contacts, asked)
    falls = proofs.unstable & asked
    bounded = falls.any() and has_possible_contacts(contacts)
    outer = program_blocks(apart, contacts, mu, possible=True) if bounded else certain
    more = falls & (np.diff(outer.row_start) > np.diff(certain.row_start))
    if not more.any():
        return Together(stable, falls, (certain, proofs), None, more)
    kept = outer.checked(np.zeros(len(outer.whole.part_a)), proofs.motion, ~falls & falls, more)
    bounds = _with_programs(outer, kept, more & ~kept.unstable)
    unstable = np.where(more, bounds.unstable, falls)
    return Together(stable, unstable, (certain, proofs), (outer, bounds), more)


def clusters_at_rest(contacts: ContactSet, label: Index) -> Mask:
    """Mask of the clusters of an assembly that are proved stable in a single computation, (M,).

    Arguments: `label` (N,): cluster of each free part, 0 to M - 1, or -1 for parts of no cluster.
    """
    blocks = cluster_blocks(build_program(contacts.assembly, contacts), label)
    odd = _odd(label, len(blocks.gravity), contacts)
    return _certain_proofs(blocks, contacts, ~odd)[1]


def _certain_proofs(
    certain: ProgramBlocks, contacts: ContactSet, asked: Mask
) -> tuple[BlockProofs, Mask]:
    """Proofs with the certain contacts, and a mask of those in `asked` that are stable, (M,)."""
    stacked = certain.stacked(asked)
    proofs = _with_programs(certain, stacked, asked & ~stacked.stable & ~stacked.unstable)
    stable = proofs.stable & asked
    return proofs, stable & _rests_level(certain, contacts, proofs, stable)


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


def _odd(owner: Index, count: int, contacts: ContactSet) -> Mask:
    """Mask of the assemblies with coincident parts or with fitted contact normals, shape (M,).

    Arguments: `owner` (N,): assembly of each part, or -1.
    """
    pairs = np.array([pair.ends for pair in coincident(contacts)], dtype=np.int64).reshape(-1, 2)
    parts = np.concatenate([pairs, fitted_pairs(contacts)])
    odd = np.zeros(count + 1, dtype=bool)
    odd[owner[parts]] = True
    return odd[:-1]


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


# A verdict with only its word computed; access to any other field runs `check`.


WORD = "<U24"
"""Type of arrays of verdict words."""


FIELDS = frozenset(field.name for field in fields(Verdict))


class DeferredVerdict(Verdict):
    """A `Verdict` whose unknown fields are computed at the first access to any of them."""

    @classmethod
    def of(
        cls,
        known: Mapping[str, Any],
        assembly: Callable[[], Assembly],
        whole: Callable[[Assembly], Verdict],
    ) -> DeferredVerdict:
        """Create a verdict from known fields, whose values are those of `check`.

        `assembly` and `whole` return the assembly and its full verdict.
        """
        verdict: DeferredVerdict = object.__new__(cls)
        verdict.__dict__.update(known)
        verdict.__dict__["_deferred"] = (assembly, whole)
        return verdict

    def __getattribute__(self, name: str) -> Any:
        """Return a field of the verdict; an unknown field is computed first, with all others."""
        if name in FIELDS:
            values = object.__getattribute__(self, "__dict__")
            if name not in values and "_deferred" in values:
                assembly, find = values["_deferred"]
                if name == "assembly":
                    values[name] = assembly()
                    return values[name]
                whole = find(self.assembly)
                values.update({field: getattr(whole, field) for field in FIELDS})
                del values["_deferred"]
        return object.__getattribute__(self, name)


Certificate = tuple[Program, ForceProof | MotionProof]


@dataclass(frozen=True, slots=True, eq=False)
class FoundVerdicts:
    """Verdict words of M assemblies and the numbers of their proofs, filled in any order."""

    word: Labels
    """Verdict words, "" where it is not known yet, shape (M,)."""
    residual: Array
    power: Array
    violation: Array
    """As in `Verdicts`, shape (M,)."""
    proofs: dict[int, Callable[[], Certificate | None]]
    """Functions that return the program and the proof of an assembly, by its index."""
    errors: dict[int, KilterError]
    again: list[Callable[[], tuple[Index, Labels]]]
    """Functions that decide assemblies of compiled code without it, and return their indices and
    words."""

    @classmethod
    def empty(cls, count: int) -> FoundVerdicts:
        """Rows of `count` assemblies without a verdict."""
        a, b, c = (np.full(count, np.nan) for _ in range(3))
        return cls(np.full(count, "", dtype=WORD), a, b, c, {}, {}, [])

    @property
    def left(self) -> Index:
        """Indices of the assemblies without a verdict."""
        return np.flatnonzero(self.word == "")

    def put_proved(
        self,
        which: Index,
        stable: Mask,
        unstable: Mask,
        numbers: tuple[Array, Array, Array],
    ) -> None:
        """Put the assemblies `which` that are proved, all shape (m,).

        Arguments: `numbers`: residual, power and violation of their proofs.
        """
        residual, power, violation = numbers
        self.word[which[stable]] = "stable"
        self.word[which[unstable]] = "unstable"
        self.residual[which[stable]] = residual[stable]
        self.power[which[unstable]] = power[unstable]
        self.violation[which[unstable]] = violation[unstable]

    def put_together(self, which: Index, decided: Together, *, proofs: bool) -> None:
        """Put those of the assemblies `which` that a joint computation decided."""
        self.put_proved(which, decided.stable, decided.unstable, decided.numbers)
        if proofs:
            for n in np.flatnonzero(decided.stable | decided.unstable).tolist():
                self.proofs[int(which[n])] = partial(decided.certificate, n)

    def put_verdict(self, k: int, verdict: Verdict, *, proofs: bool) -> None:
        """Put the verdict of `check` about assembly k."""
        self.word[k], proof = verdict.verdict, verdict.evidence
        if proof is None:
            return
        if isinstance(proof, ForceProof):
            self.residual[k] = proof.residual
        else:
            self.power[k], self.violation[k] = proof.power, proof.violation
        if proofs:
            both = (verdict.program, proof)
            self.proofs[k] = lambda: both

    def put_error(self, k: int, error: KilterError) -> None:
        """Put the reason why assembly k has no verdict."""
        self.word[k], self.errors[k] = "error", error


def _full_verdict(options: Mapping[str, Any], assembly: Assembly) -> Verdict:
    """The verdict of `check` about an assembly; `options` are its arguments."""
    return check(assembly, **{"assume": DRAWN, **options})


class Verdicts(Sequence[Verdict]):
    """Verdicts of M assemblies in arrays; ``verdicts[k]`` is the full verdict of `check`.

    Attributes
    ----------
    assemblies : tuple of Assembly, or AssemblyArrays
        Checked assemblies.
    verdict : ndarray of str, shape (M,)
        Verdict words as in `Verdict.verdict`, or "error".
    stable : ndarray of bool, shape (M,)
        Whether each assembly reaches the required level.
    level : tuple of str or None
        Levels as in `Verdict.level`.
    residual : ndarray, shape (M,)
        Largest relative imbalance of the proving forces [-]; NaN without such forces.
    power, violation : ndarray, shape (M,)
        Power of the weight [W] and largest violation [-] of the proving motion, whose fastest part
        moves at 1 m/s; NaN without such a motion.
    errors : mapping from int to KilterError
        Errors by index of the assembly, for assemblies without a verdict.

    Examples
    --------
    >>> import kilter
    >>> from kilter.scenes import scene
    >>> found = kilter.check_many([scene("tower"), scene("paper-figure-8")])
    >>> found
    <Verdicts: 2, 1 stable, 1 unstable>
    >>> found[1].moving
    ['C2', 'C3']
    """

    def __init__(
        self,
        assemblies: Sequence[Assembly] | AssemblyArrays,
        rows: FoundVerdicts,
        options: Mapping[str, Any],
    ) -> None:
        self.assemblies = assemblies
        self._rows, self._options = rows, options
        self.errors = dict(sorted(rows.errors.items()))

    def __len__(self) -> int:
        return len(self._rows.word)

    @overload
    def __getitem__(self, k: int) -> Verdict: ...
    @overload
    def __getitem__(self, k: slice) -> list[Verdict]: ...
    def __getitem__(self, k: int | slice) -> Verdict | list[Verdict]:
        """The verdict with index `k`, or the list of verdicts of a slice.

        Its word, level and assembly are known; `check` computes the rest on the first access.

        Raises `KilterError` if the assembly has no verdict: its error in `errors`.
        """
        if isinstance(k, slice):
            return [self[n] for n in range(len(self))[k]]
        index = range(len(self))[k]
        if index in self.errors:
            raise self.errors[index]
        known = {
            "verdict": str(self._rows.word[index]),
            "require": self._options["require"],
        }
        return DeferredVerdict.of(
            known,
            partial(self.assemblies.__getitem__, index),
            partial(_full_verdict, self._options),
        )

    def __iter__(self) -> Iterator[Verdict]:
        return (self[k] for k in range(len(self)))

    @cached_property
    def verdict(self) -> Labels:
        """Verdict word of each assembly, shape (M,)."""
        return self._rows.word.copy()

    @property
    def level(self) -> tuple[str | None, ...]:
        """Verdict level of each assembly; None if it does not hold."""
        return tuple(level_of(word) for word in self.verdict.tolist())

    @cached_property
    def stable(self) -> Mask:
        """Whether each assembly reaches the required verdict level, shape (M,)."""
        require = self._options["require"]
        words = [word for word in self.counts if holds(level_of(word), require)]
        return np.isin(self.verdict, words)

    @property
    def residual(self) -> Array:
        """Largest imbalance of a part under the proving forces, over its weight [-], shape (M,)."""
        return self._rows.residual.copy()

    @property
    def power(self) -> Array:
        """Power of the weight in the proving motions [W], shape (M,)."""
        return self._rows.power.copy()

    @property
    def violation(self) -> Array:
        """Largest violation of the contacts by the proving motions [-], shape (M,)."""
        return self._rows.violation.copy()

    @property
    def counts(self) -> dict[str, int]:
        """Number of assemblies for each verdict word, the most frequent first."""
        return dict(Counter(self.verdict.tolist()).most_common())

    def rechecked(self) -> Mask:
        """Whether each verdict is proved, shape (M,), also without compiled code.

        Verdicts of compiled code are decided again by the general computation, with its own
        contacts, program and solver, hundreds at once. This takes a third of the time of their
        certificates. The other verdicts have been judged so before.
        """
        holds: Mask = ~np.isin(self.verdict, ("undecided", "error"))
        for decide in self._rows.again:
            which, words = decide()
            holds[which] = words == self.verdict[which]
        return holds

    def certificate(self, k: int) -> Certificate | None:
        """The program and the proof of the k-th verdict; None if no proof is stored."""
        proof = self._rows.proofs.get(range(len(self))[k])
        return None if proof is None else proof()

    def __repr__(self) -> str:
        counts = "".join(f", {count} {word}" for word, count in self.counts.items())
        return f"<Verdicts: {len(self)}{counts}>"
