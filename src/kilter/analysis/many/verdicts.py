"""Verdicts: the answers of `check_many`, in arrays, each one in full when it is asked for."""

from __future__ import annotations

import dataclasses
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, overload

import numpy as np

from kilter.analysis.check import check
from kilter.analysis.many.decided_together import Together
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
    """What is kept of one verdict."""

    verdict: str
    residual: float = np.nan
    power: float = np.nan
    violation: float = np.nan
    together: tuple[Together, int] | None = None
    certificate: Certificate | None = None
    error: KilterError | None = None

    @classmethod
    def of(cls, found: Together, n: int) -> Row:
        """Of an assembly that was settled beside others."""
        proofs = found.proofs(n)
        if found.stable[n]:
            return cls("stable", residual=float(proofs.residual[n]), together=(found, n))
        power, violation = float(proofs.power[n]), float(proofs.violation[n])
        return cls("unstable", power=power, violation=violation, together=(found, n))

    @classmethod
    def of_verdict(cls, verdict: Verdict) -> Row:
        """Of one that `check` judged."""
        proof = verdict.certificate
        if proof is None:
            return cls(verdict.verdict)
        both = (verdict.program, proof)
        if isinstance(proof, ForceProof):
            return cls(verdict.verdict, residual=proof.residual, certificate=both)
        return cls(verdict.verdict, power=proof.power, violation=proof.violation, certificate=both)

    def without_proof(self) -> Row:
        """The row without what it was proved by."""
        return dataclasses.replace(self, together=None, certificate=None)


class Verdicts(Sequence[Verdict]):
    """Verdicts of M assemblies: in arrays; ``verdicts[k]`` is the k-th in full, by `check`.

    Attributes
    ----------
    assemblies : tuple of Assembly, or AssemblyArrays
        What was asked.
    verdict : ndarray of str, shape (M,)
        As `Verdict.verdict`, or "error".
    stable : ndarray of bool, shape (M,)
        It holds at the level that is asked for.
    level : tuple of str or None
        As `Verdict.level`.
    residual : ndarray, shape (M,)
        Worst relative imbalance of the forces that prove it [-]; NaN where a motion does.
    power, violation : ndarray, shape (M,)
        Of the motion that proves it [W where the fastest part moves at 1 m/s, -]; else NaN.
    errors : mapping from int to KilterError
        Why there is no verdict.

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
        """The k-th verdict in full.

        Raises
        ------
        KilterError
            Where there is none, that of `errors`.
        """
        if isinstance(k, slice):
            return [self[n] for n in range(len(self))[k]]
        return check(self.assemblies[range(len(self))[k]], **self._options)

    def __iter__(self) -> Iterator[Verdict]:
        return (self[k] for k in range(len(self)))

    @cached_property
    def verdict(self) -> Labels:
        """Words, shape (M,)."""
        return np.array([row.verdict for row in self._rows], dtype=object).astype(str)

    @property
    def level(self) -> tuple[str | None, ...]:
        """The level that each reaches."""
        return tuple(level_of(row.verdict) for row in self._rows)

    @cached_property
    def stable(self) -> Mask:
        """Whether each holds at the level that is asked for, shape (M,)."""
        return np.array(
            [holds(level, self._options["require"]) for level in self.level], dtype=bool
        )

    @property
    def residual(self) -> Array:
        """Of forces [-], shape (M,)."""
        return np.array([row.residual for row in self._rows])

    @property
    def power(self) -> Array:
        """Of motions [W], shape (M,)."""
        return np.array([row.power for row in self._rows])

    @property
    def violation(self) -> Array:
        """Of motions [-], shape (M,)."""
        return np.array([row.violation for row in self._rows])

    @cached_property
    def errors(self) -> dict[int, KilterError]:
        """Why there is no verdict, by position."""
        return {k: row.error for k, row in enumerate(self._rows) if row.error is not None}

    @property
    def counts(self) -> dict[str, int]:
        """How many there are of each verdict, the most first."""
        return dict(Counter(self.verdict.tolist()).most_common())

    def certificate(self, k: int) -> Certificate | None:
        """The program and the proof of verdict k, judged anew; None where none was kept."""
        row = self._rows[range(len(self))[k]]
        if row.together is not None:
            found, n = row.together
            return found.certificate(n)
        return row.certificate

    def __repr__(self) -> str:
        counts = "".join(f", {count} {word}" for word, count in self.counts.items())
        return f"<Verdicts: {len(self)}{counts}>"
