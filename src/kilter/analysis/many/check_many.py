"""Problem 1 for many small assemblies: the verdicts of `check`, ten times as many a second.

Hundreds are laid side by side: contacts are found of all parts at once, the programs solved one
after the other by one kept solver, the proofs judged in arrays
(`kilter.analysis.many.decided_together`).
What friction, joints, loads, round faces or open pairs make harder is for `check`, one by one.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np

from kilter.analysis.check import check
from kilter.analysis.many.decided_together import Together, decide_together
from kilter.analysis.many.verdicts import Row, Verdicts
from kilter.arrays import Index
from kilter.assembly import Assembly
from kilter.assembly.array_geometry import arrays_side_by_side
from kilter.assembly.assembly_arrays import AssemblyArrays
from kilter.assembly.side_by_side import SideBySide, side_by_side
from kilter.contact import Tolerance
from kilter.errors import InputError, KilterError
from kilter.shape.primitives import Box, Mesh, Prism
from kilter.tell.levels import REQUIRE, require_level
from kilter.threads import on_one_thread
from kilter.work import EFFORT

__all__ = ["check_many"]

AT_ONCE = 300
"""Assemblies side by side."""
SMALL = 100
"""Parts up to which an assembly is laid beside others."""


@on_one_thread
def check_many(
    assemblies: Iterable[Assembly] | AssemblyArrays,
    *,
    tolerance: Tolerance | None = None,
    require: str = REQUIRE,
    effort: float = EFFORT,
    time_limit: float | None = None,
    proofs: bool = False,
    progress: Callable[[int, int], None] | None = None,
) -> Verdicts:
    """Which of many assemblies stay together under gravity?

    Verdicts, levels and words are those of `check`, one by one. An assembly that `check` refuses
    is no error here: its verdict is "error", and `Verdicts.errors` says why.

    Parameters
    ----------
    assemblies : iterable of Assembly, or AssemblyArrays
        Each with its own gravity, friction, units and size. From arrays no part is ever made.
    tolerance : Tolerance, optional
        When faces count as touching, in all of them.
    require : {"equilibrium", "settles", "proved", "strict"}
        The level at which `Verdicts.stable` is true.
    effort, time_limit : float
        Of what is asked by `check`, each by itself.
    proofs : bool
        Keep every proof, about 10 kB each, for `Verdicts.certificate`.
    progress : callable, optional
        Called with how many are done, and of how many, every few hundred.

    Raises
    ------
    InputError
        If the tolerance or an option is none, or one of `assemblies` is no assembly.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> check_many([scene("tower"), scene("paper-figure-8")]).verdict.tolist()
    ['stable', 'unstable']
    """
    tolerance = Tolerance() if tolerance is None else tolerance
    if not isinstance(tolerance, Tolerance):
        raise InputError(
            f"the tolerance is {tolerance!r:.60}", hint="give kilter.Tolerance(gap=...)"
        )
    tolerance.require_sound()
    options = {
        "tolerance": tolerance,
        "require": require_level(require),
        "effort": effort,
        "time_limit": time_limit,
    }
    given = assemblies if isinstance(assemblies, AssemblyArrays) else _listed(assemblies)
    rows: dict[int, Row] = {}
    for first in range(0, len(given), AT_ONCE):
        last = min(first + AT_ONCE, len(given))
        for which, found in _together(given, first, last, tolerance):
            rows |= {k: Row.of(found, n) for n, k in enumerate(which.tolist()) if found.settles(n)}
        for k in range(first, last):
            if k not in rows:
                rows[k] = _alone(given, k, options)
        if not proofs:
            for k in range(first, last):
                rows[k] = rows[k].without_proof()
        if progress is not None:
            progress(last, len(given))
    return Verdicts(given, tuple(rows[k] for k in range(len(given))), options)


def _listed(assemblies: Iterable[Assembly]) -> tuple[Assembly, ...]:
    listed = tuple(assemblies)
    for k, one in enumerate(listed):
        if not isinstance(one, Assembly):
            raise InputError(
                f"assembly {k} is of type {type(one).__name__}",
                hint="give assemblies, as kilter.load or kilter.Assembly makes them",
            )
    return listed


def _together(
    given: Sequence[Assembly] | AssemblyArrays, first: int, last: int, tolerance: Tolerance
) -> Iterable[tuple[Index, Together]]:
    """Which assemblies were asked side by side, and what was found."""
    if isinstance(given, AssemblyArrays):
        apart, which = arrays_side_by_side(given.among(np.arange(first, last)))
        if apart is not None:
            rough = np.full(len(apart), given.friction > 0)
            yield which + first, decide_together(apart, rough, tolerance)
        return
    alike: dict[tuple[str, bool], list[int]] = defaultdict(list)
    for k in range(first, last):
        if _plain(given[k]):
            alike[given[k].units, given[k].planar].append(k)
    for chosen in alike.values():
        apart, kept = _side_by_side(given, chosen)
        if apart is not None:
            rough = np.array([_rough(given[k]) for k in kept])
            yield np.array(kept), decide_together(apart, rough, tolerance)


def _plain(assembly: Assembly) -> bool:
    """Small, of flat faces, held somewhere, with nothing beside detected contacts."""
    beside = assembly.contacts or assembly.joints or assembly.loads or assembly.bonds
    if (
        beside
        or not assembly.detect
        or len(assembly) > SMALL
        or not any(part.grounded for part in assembly.parts)
    ):
        return False
    return all(isinstance(part.shape, Box | Prism | Mesh) for part in assembly.parts)


def _rough(assembly: Assembly) -> bool:
    return assembly.friction > 0 or any(pair.mu > 0 for pair in assembly.friction_pairs)


def _side_by_side(
    given: Sequence[Assembly], chosen: list[int]
) -> tuple[SideBySide | None, list[int]]:
    """Those of flat and closed parts side by side, and which they are."""
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


def _alone(given: Sequence[Assembly] | AssemblyArrays, k: int, options: dict[str, Any]) -> Row:
    """The verdict of `check`, or why there is none."""
    try:
        return Row.of_verdict(check(given[k], **options))
    except KilterError as error:
        return Row("error", error=error)
