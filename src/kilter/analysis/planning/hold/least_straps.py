"""The fewest of the candidate straps with which an assembly holds, proved.

A motion v of the load proves that the straps of a set T are not enough if it gains more power than
they take up:

    P(v) - sum over T of p_i(v) > tau(v)
    p_i = T_i e_i (tension)  or  LC_i max(e_i, 0) (capacity)

e_i is the rate at which strap i lengthens. P is the power of the load without these straps, and tau
what a proof by this motion needs (`kilter.mechanics.certificate`). Each motion is found for one
set, and excludes many (`kilter.analysis.smallest_set`). A tensioned strap may also do harm: its
p_i is negative. With a code of load securing, a set must hold the load of each of its directions,
and a motion of one of them excludes it.
"""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike

from kilter.analysis.decision.judge import judge
from kilter.analysis.planning.hold.lashing import Lashing, LoadCase, lashed, load_cases
from kilter.analysis.smallest_set import TooManySets, least_cover
from kilter.arrays import Array
from kilter.assembly import Assembly, Strap
from kilter.assembly.strap_wrenches import strap_wrenches
from kilter.contact import ContactSet
from kilter.mechanics.certificate import ForceProof, MotionProof, check_motion, needed_power
from kilter.mechanics.program import Program, build_program

__all__ = ["find_least_straps", "smallest_set", "strap_powers"]

MOST_SETS = 50_000
"""Largest number of sets that one search tries. More sets leave the answer undecided."""
MOTIONS = 1000
"""Largest number of motions, and so of decided sets."""


def find_least_straps(
    assembly: Assembly,
    contacts: ContactSet,
    candidates: Sequence[Strap],
    *,
    code: str | None = None,
    forward: ArrayLike = (1.0, 0.0, 0.0),
    require: str,
    level_of: Callable[[Assembly, ContactSet], str | None],
    progress: Callable[[str], None] | None = None,
) -> Lashing:
    """Find the fewest of the candidate straps with which an assembly is in equilibrium.

    With a code, it is in equilibrium at each of the accelerations of the code.

    Parameters
    ----------
    assembly : Assembly
        Its own straps stay.
    contacts : ContactSet
        The contacts of this assembly.
    candidates : sequence of Strap
    code : str, optional
        Code of load securing (`kilter.analysis.transport.codes`).
    forward : array_like, shape (3,)
        Direction of travel, for `code`.
    require : str
        Level from which the answer is yes; the search is for equilibrium.
    level_of : callable
        Function that returns the level of an assembly with the found straps.
    progress : callable, optional
        Function that is called with the name of each stage.

    Raises
    ------
    InputError
        If a candidate does not fit the assembly, or the code does not exist.
    """
    started = time.perf_counter()
    tell = progress or (lambda stage: None)
    for strap in candidates:
        strap_wrenches(dataclasses.replace(assembly, straps=[strap]))
    cases = load_cases(assembly, code, forward)
    motions: list[tuple[int, tuple[int, ...], MotionProof]] = []
    powers, least = np.zeros((0, 1 + len(candidates))), 0
    chosen: tuple[int, ...] | None = None
    forces: tuple[ForceProof, ...] = ()
    impossible = exhausted = False
    while len(motions) < MOTIONS:
        least, found = smallest_set(powers, least)
        if found is None:
            impossible = exhausted = least > len(candidates)
            break
        tell(f"straps: a set of {len(found)}, after {len(motions)} motions")
        proofs, falls = _decide_all(cases, contacts, [candidates[k] for k in found])
        if len(proofs) == len(cases):
            chosen, forces, exhausted = found, proofs, True
            break
        if falls is None:
            break
        number = len(proofs)
        motions.append((number, found, falls))
        row = strap_powers(cases[number].assembly, contacts, candidates, falls.motion)
        powers = np.vstack([powers, row])
        if row[1:][list(found)].sum() >= row[0]:
            break  # rounding: the motion does not exclude the set that it was found for
    levels: tuple[str | None, ...] = ()
    if chosen is not None:
        straps = [candidates[k] for k in chosen]
        levels = tuple(level_of(*lashed(case.assembly, contacts, straps)) for case in cases)
    named = None if code is None else {"name": code, "forward": np.array(forward, float).tolist()}
    return Lashing(
        assembly, contacts, tuple(candidates), named, cases, chosen, forces, levels, require, least,
        tuple(motions), impossible, exhausted, time.perf_counter() - started,
    )  # fmt: skip


def _decide_all(
    cases: Sequence[LoadCase], contacts: ContactSet, straps: Sequence[Strap]
) -> tuple[tuple[ForceProof, ...], MotionProof | None]:
    """Forces that hold the loads up to the first that they do not hold, and its motion.

    Without a motion, all loads are held or that first load is undecided.
    """
    proofs: list[ForceProof] = []
    for case in cases:
        stable, proof = _decide(*lashed(case.assembly, contacts, straps))
        if not (stable and isinstance(proof, ForceProof)):
            return tuple(proofs), proof if isinstance(proof, MotionProof) else None
        proofs.append(proof)
    return tuple(proofs), None


def _decide(
    assembly: Assembly, contacts: ContactSet
) -> tuple[bool | None, ForceProof | MotionProof | None]:
    """Whether equilibrium forces exist, with their proof; None if it is not proved."""
    program = build_program(assembly, contacts)
    found = judge(program)
    if found.stable:
        return True, found.forces
    outer = build_program(assembly, contacts, possible=True)
    if len(outer.part_a) > len(program.part_a):
        found = judge(outer)
    return (False, found.motion) if found.stable is False else (None, None)


def strap_powers(
    assembly: Assembly, contacts: ContactSet, candidates: Sequence[Strap], motion: Array
) -> Array:
    """Power that straps must take up so that a motion proves nothing, and that each takes up.

    Shape (1 + n,) [W]: first P - tau, then p_i. The motion proves that a set of straps is not
    enough if the sum of its p_i is below the first entry.
    """
    bare = build_program(assembly, contacts, possible=True)
    without = check_motion(bare, motion)
    powers = [without.power - needed_power(bare, without)]
    for strap in candidates:
        program: Program = build_program(*lashed(assembly, contacts, [strap]), possible=True)
        powers.append(without.power - program.power(without.motion))
    return np.array(powers)


def smallest_set(powers: Array, least: int = 0) -> tuple[int, tuple[int, ...] | None]:
    """Least number of straps that no motion excludes, and such straps; not below `least`.

    The straps are None if all sets are excluded, the number then being that of all straps plus 1,
    or if too many sets had to be tried. `powers` has the `strap_powers` of each motion.
    """
    shares = [dict(enumerate(row)) for row in powers[:, 1:].tolist()]
    count = powers.shape[1] - 1
    try:
        found = least_cover(
            shares, count, needs=powers[:, 0].tolist(), fewest=least, steps=MOST_SETS
        )
    except TooManySets as stopped:
        return stopped.fewest, None
    return (count + 1, None) if found is None else (len(found), tuple(sorted(found)))
