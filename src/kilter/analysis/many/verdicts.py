"""Answers of `check_many`: arrays over all assemblies, and a full `Verdict` for each on access."""

from __future__ import annotations

import dataclasses
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, overload

import numpy as np

from kilter.analysis.many.decided_together import Together
from kilter.analysis.many.deferred_verdict import DeferredVerdict
from kilter.analysis.verdict.verdict import Verdict
from kilter.arrays import Array, Labels, Mask
from kilter.assembly import Assembly
from kilter.assembly.assembly_arrays import AssemblyArrays
from kilter.errors import KilterError
from kilter.mechanics.certificate import ForceProof, MotionProof
from kilter.mechanics.program import Program
from kilter.tell.levels import holds, level_of

__all__ = ["Row", "Verdicts"]

Certificate = tuple[Program, ForceProof | MotionProof]


@dataclass(frozen=True, slots=True, eq=False)
class Row:
    """Verdict word of an assembly, the numerical errors of its proof, and the proof itself."""

    verdict: str
    residual: float = np.nan
    power: float = np.nan
    violation: float = np.nan
    together: tuple[Together, int] | None = None
    certificate: Certificate | None = None
    error: KilterError | None = None

    @classmethod
    def of(cls, decided: Together, n: int) -> Row:
        """Create the row of assembly `n` of a joint computation."""
        proofs = decided.proofs(n)
        if decided.stable[n]:
            return cls("stable", residual=float(proofs.residual[n]), together=(decided, n))
        power, violation = float(proofs.power[n]), float(proofs.violation[n])
        return cls("unstable", power=power, violation=violation, together=(decided, n))

    @classmethod
    def of_verdict(cls, verdict: Verdict) -> Row:
        """Create the row of an assembly from its verdict by `check`."""
        proof = verdict.evidence
        if proof is None:
            return cls(verdict.verdict)
        both = (verdict.program, proof)
        if isinstance(proof, ForceProof):
            return cls(verdict.verdict, residual=proof.residual, certificate=both)
        return cls(verdict.verdict, power=proof.power, violation=proof.violation, certificate=both)

    def without_proof(self) -> Row:
        """Copy of the row without the proof."""
        return dataclasses.replace(self, together=None, certificate=None)


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
        rows: tuple[Row, ...],
        options: Mapping[str, Any],
    ) -> None:
        self.assemblies = assemblies
        self._rows, self._options = rows, options

    def __len__(self) -> int:
        return len(self._rows)

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
        row = self._rows[index]
        if row.error is not None:
            raise row.error
        known = {"verdict": row.verdict, "require": self._options["require"]}
        return DeferredVerdict.of(self.assemblies, index, known, self._options)

    def __iter__(self) -> Iterator[Verdict]:
        return (self[k] for k in range(len(self)))

    @cached_property
    def verdict(self) -> Labels:
        """Verdict word of each assembly, shape (M,)."""
        return np.array([row.verdict for row in self._rows], dtype=object).astype(str)

    @property
    def level(self) -> tuple[str | None, ...]:
        """Verdict level of each assembly; None if it does not hold."""
        return tuple(level_of(row.verdict) for row in self._rows)

    @cached_property
    def stable(self) -> Mask:
        """Whether each assembly reaches the required verdict level, shape (M,)."""
        return np.array(
            [holds(level, self._options["require"]) for level in self.level], dtype=bool
        )

    @property
    def residual(self) -> Array:
        """Largest imbalance of a part under the proving forces, over its weight [-], shape (M,)."""
        return np.array([row.residual for row in self._rows])

    @property
    def power(self) -> Array:
        """Power of the weight in the proving motions [W], shape (M,)."""
        return np.array([row.power for row in self._rows])

    @property
    def violation(self) -> Array:
        """Largest violation of the contacts by the proving motions [-], shape (M,)."""
        return np.array([row.violation for row in self._rows])

    @cached_property
    def errors(self) -> dict[int, KilterError]:
        """Errors that prevented verdicts, by index of the assembly."""
        return {k: row.error for k, row in enumerate(self._rows) if row.error is not None}

    @property
    def counts(self) -> dict[str, int]:
        """Number of assemblies for each verdict word, the most frequent first."""
        return dict(Counter(self.verdict.tolist()).most_common())

    def certificate(self, k: int) -> Certificate | None:
        """The program and the proof of the k-th verdict; None if no proof is stored."""
        row = self._rows[range(len(self))[k]]
        if row.together is not None:
            decided, n = row.together
            return decided.certificate(n)
        return row.certificate

    def __repr__(self) -> str:
        counts = "".join(f", {count} {word}" for word, count in self.counts.items())
        return f"<Verdicts: {len(self)}{counts}>"
