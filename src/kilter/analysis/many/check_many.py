"""`kilter.check_many`: verdicts of many small assemblies, ten times as fast as `check` for each.

Hundreds of assemblies are processed together (`kilter.analysis.many.verdicts`): contacts
are detected for all parts at once, a warm solver solves the programs in sequence, and the proofs
are verified in arrays. Assemblies with joints, loads, round faces, undecided friction or open pairs
are left to `check`. With numba installed, compiled code first decides large batches of prisms that
are far from any limit (`kilter.analysis.many.clear_stacks`).
"""

from __future__ import annotations

import os
from collections import defaultdict
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any

import numpy as np

from kilter.analysis.check import check
from kilter.analysis.many.clear_stacks import clear_answers, largest_friction
from kilter.analysis.many.compiled_tolerances import LEFT, STABLE, UNSTABLE
from kilter.analysis.many.verdicts import (
    Certificate,
    FoundVerdicts,
    Together,
    Verdicts,
    decide_together,
)
from kilter.arrays import Index, Labels
from kilter.assembly import Assembly
from kilter.assembly.array_geometry import SideBySide, arrays_side_by_side, side_by_side
from kilter.assembly.assembly_arrays import AssemblyArrays
from kilter.assembly.question import AssemblyOrPath, Question, question
from kilter.contact import Tolerance
from kilter.errors import InputError, KilterError
from kilter.shape.primitives import Box, Mesh, Prism
from kilter.tell.levels import require_level

AT_ONCE = 300
"""Number of assemblies that are processed together."""
SMALL = 100
"""Largest number of parts of an assembly that is processed together with others."""


@question(lacks="contacts progress assume")
def check_many(
    assemblies: Iterable[AssemblyOrPath] | AssemblyArrays,
    *,
    asked: Question,
    proofs: bool = False,
    progress: Callable[[int, int], None] | None = None,
) -> Verdicts:
    """Decide for each of many assemblies whether it stays together under gravity.

    Verdicts and levels are the same as those of `check`. If `check` rejects an assembly, its
    verdict is "error", and `Verdicts.errors` has the reason.

    Parameters
    ----------
    assemblies : iterable of Assembly or path, or AssemblyArrays
        Assemblies, each with its own gravity, friction, units and size. `AssemblyArrays` avoid the
        construction of part objects.
    tolerance : Tolerance, optional
        Tolerances of the detection: gap, angle and clearance. They apply to all assemblies; by
        default each assembly has its own.
    require : {"equilibrium", "settles", "proved", "strict"}
        Level from which the answer is yes. `Verdicts.stable` is true from this level.
    proofs : bool
        Whether to store every proof, about 10 kB each, for `Verdicts.certificate`.
    progress : callable, optional
        Function called with the number of finished assemblies and the total.

    Raises
    ------
    InputError
        If the tolerance or an option is invalid, a file cannot be read, a name matches no part of
        an assembly, or an element of `assemblies` is neither an assembly nor a path.

    See Also
    --------
    kilter.batch : the same for many files, with tables on disk.
    kilter.check : the complete answer for one assembly.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> check_many([scene("tower"), scene("paper-figure-8")]).verdict.tolist()
    ['stable', 'unstable']
    """
    tolerance = Tolerance() if asked.tolerance is None else asked.tolerance
    if not isinstance(tolerance, Tolerance):
        raise InputError(
            f"the tolerance is {tolerance!r:.60}", hint="give kilter.Tolerance(gap=...)"
        )
    tolerance.require_sound()
    options = {
        "tolerance": asked.tolerance,
        "require": require_level(asked.require),
        "effort": asked.effort,
        "time_limit": asked.time_limit,
    }
    given = _given(assemblies, asked)
    rows = FoundVerdicts.empty(len(given))
    _put_clear(given, tolerance, rows, proofs=proofs)
    left = rows.left
    for first in range(0, len(left), AT_ONCE):
        some = left[first : first + AT_ONCE]
        for which, decided in _together(given, some, tolerance):
            rows.put_together(which, decided, proofs=proofs)
        for k in some[rows.word[some] == ""].tolist():
            _put_check(given, k, options, rows, proofs=proofs)
        if progress is not None:
            progress(len(given) - len(left) + first + len(some), len(given))
    if progress is not None and not len(left):
        progress(len(given), len(given))
    return Verdicts(given, rows, options)


def _put_clear(
    given: Sequence[Assembly] | AssemblyArrays,
    tolerance: Tolerance,
    rows: FoundVerdicts,
    *,
    proofs: bool,
) -> None:
    """Put the verdicts of compiled code about assemblies far from any limit.

    Their proofs are made on request, by the computation without compiled code.
    """
    clear = clear_answers(given, tolerance)
    if clear is None:
        return
    which, answers = clear
    numbers = answers.residual, answers.power, answers.violation
    rows.put_proved(which, answers.code == STABLE, answers.code == UNSTABLE, numbers)
    decided = which[answers.code != LEFT]
    late = [
        _LateProofs(given, decided[first : first + AT_ONCE], tolerance)
        for first in range(0, len(decided), AT_ONCE)
    ]
    rows.again.extend(one.words for one in late)
    if proofs:
        rows.proofs.update({k: partial(one.of, k) for one in late for k in one.some.tolist()})


@dataclass(eq=False)
class _LateProofs:
    """Proofs of the assemblies `some` of `given`, shape (m,), which compiled code has decided.

    They are made together at the first request, without compiled code.
    """

    given: Sequence[Assembly] | AssemblyArrays
    some: Index
    tolerance: Tolerance

    @cached_property
    def rows(self) -> FoundVerdicts:
        """The verdicts on `some` of the computation without compiled code, with their proofs."""
        return self._found(proofs=True)

    def words(self) -> tuple[Index, Labels]:
        """The assemblies, and the words of the computation without compiled code."""
        found = self._found(proofs=False)
        for n in found.left.tolist():
            self._check(n, found)
        return self.some, found.word

    def of(self, k: int) -> Certificate | None:
        """The program and the proof of assembly k."""
        n = int(np.searchsorted(self.some, k))
        if n not in self.rows.proofs:
            self._check(n, self.rows)
        proof = self.rows.proofs.get(n)
        return None if proof is None else proof()

    def _found(self, *, proofs: bool) -> FoundVerdicts:
        rows, every = FoundVerdicts.empty(len(self.some)), np.arange(len(self.some))
        for which, decided in _together(self._few, every, self.tolerance):
            rows.put_together(which, decided, proofs=proofs)
        return rows

    def _check(self, n: int, rows: FoundVerdicts) -> None:
        _put_check(self._few, n, {"tolerance": self.tolerance}, rows, proofs=True)

    @property
    def _few(self) -> Sequence[Assembly] | AssemblyArrays:
        if isinstance(self.given, AssemblyArrays):
            return self.given.among(self.some)
        return [self.given[k] for k in self.some.tolist()]


def _given(
    assemblies: Iterable[AssemblyOrPath] | AssemblyArrays, asked: Question
) -> tuple[Assembly, ...] | AssemblyArrays:
    """Return the assemblies with their changes; raise InputError for any other object."""
    if isinstance(assemblies, AssemblyArrays):
        asked.require_unchanged(assemblies)
        return assemblies
    if isinstance(assemblies, Assembly | str | os.PathLike):
        raise InputError(
            "check_many got a single assembly", hint="give a list, or use kilter.check"
        )
    listed = []
    for k, assembly in enumerate(assemblies):
        if not isinstance(assembly, Assembly | str | os.PathLike):
            raise InputError(
                f"assembly {k} is of type {type(assembly).__name__}",
                hint="give assemblies, as kilter.load or kilter.Assembly makes them, or paths",
            )
        try:
            listed.append(asked.read(assembly))
        except InputError as error:
            raise error.located(file=f"assembly {k}") from None
    return tuple(listed)


def _together(
    given: Sequence[Assembly] | AssemblyArrays, some: Index, tolerance: Tolerance
) -> Iterable[tuple[Index, Together]]:
    """Judge suitable assemblies in groups; yield the indices and results of each group."""
    if isinstance(given, AssemblyArrays):
        apart, which = arrays_side_by_side(given.among(some))
        if apart is not None:
            mu = np.full(len(apart), given.friction)
            yield some[which], decide_together(apart, mu, tolerance)
        return
    alike: dict[tuple[str, bool], list[int]] = defaultdict(list)
    for k in some.tolist():
        if _plain(given[k]):
            alike[given[k].units, given[k].planar].append(k)
    for chosen in alike.values():
        apart, kept = _side_by_side(given, chosen)
        if apart is not None:
            mu = np.array([largest_friction(given[k]) for k in kept])
            yield np.array(kept), decide_together(apart, mu, tolerance)


def _plain(assembly: Assembly) -> bool:
    """Whether an assembly is small, flat-faced and grounded, and has detected contacts only."""
    beside = assembly.contacts or assembly.joints or assembly.loads or assembly.bonds
    if (
        beside
        or assembly.straps
        or assembly.tolerance is not None
        or not assembly.detect
        or len(assembly) > SMALL
        or not any(part.grounded for part in assembly.parts)
    ):
        return False
    return all(isinstance(part.shape, Box | Prism | Mesh) for part in assembly.parts)


def _side_by_side(
    given: Sequence[Assembly], chosen: list[int]
) -> tuple[SideBySide | None, list[int]]:
    """Join assemblies of flat, closed parts to one value; return it with their indices."""
    try:
        apart = side_by_side([given[k] for k in chosen])
    except InputError:
        chosen = [k for k in chosen if _has_geometry(given[k])]
        return _side_by_side(given, chosen) if chosen else (None, [])
    geometry, owner = apart.whole.geometry, apart.owner
    odd = set(owner[np.concatenate([geometry.surfaces.part, geometry.unknown.part])].tolist())
    if not odd:
        return apart, chosen
    left = [k for n, k in enumerate(chosen) if n not in odd]
    return _side_by_side(given, left) if left else (None, [])


def _has_geometry(assembly: Assembly) -> bool:
    try:
        return bool(assembly.geometry)
    except InputError:
        return False


def _put_check(
    given: Sequence[Assembly] | AssemblyArrays,
    k: int,
    options: dict[str, Any],
    rows: FoundVerdicts,
    *,
    proofs: bool,
) -> None:
    """Judge assembly k by `check`, and put its verdict or its error."""
    try:
        rows.put_verdict(k, check(given[k], **options), proofs=proofs)
    except KilterError as error:
        rows.put_error(k, error)
