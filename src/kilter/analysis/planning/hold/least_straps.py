"""The fewest of the candidate straps with which an assembly holds, proved.

A motion v of the load proves that the straps of a set T are not enough if it gains more power than
they take up:

    P(v) - sum over T of p_i(v) > tau(v)
    p_i = T_i e_i (tension)  or  LC_i max(e_i, 0) (capacity)

e_i is the rate at which strap i lengthens. P is the power of the load without these straps, and tau
what a proof by this motion needs (`kilter.mechanics.certificate`). Each motion is found for one
set, and excludes many (`kilter.analysis.smallest_set`). A tensioned strap may also do harm: its
p_i is negative. Without a code the load is the assembly. With a code of load securing, a set must
hold the assembly under the gravity g - a of each acceleration a of the code, and a motion of one
load excludes it.
"""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from kilter.analysis.check import check
from kilter.analysis.decision.judge import judge
from kilter.analysis.planning.hold.fixture import ChosenStrap, Fixture, Stated, StrapCase
from kilter.analysis.smallest_set import TooManySets, least_cover
from kilter.analysis.transport.carrier import CarrierMotion, carried_assembly
from kilter.analysis.transport.transport import code_accelerations
from kilter.arrays import Array
from kilter.assembly import Assembly, Strap
from kilter.assembly.strap_wrenches import strap_wrenches
from kilter.contact import ContactSet
from kilter.mechanics.certificate import ForceProof, MotionProof, check_motion, needed_power
from kilter.mechanics.program import Program, build_program
from kilter.mechanics.rows import STRAP
from kilter.tell.levels import level_rank

MOST_SETS = 50_000
"""Largest number of sets that one search tries. More sets leave the answer undecided."""
MOTIONS = 1000
"""Largest number of motions, and so of decided sets."""


@dataclass(frozen=True, slots=True, eq=False)
class LoadCase:
    """An assembly that straps must hold, with the gravity that it feels.

    `name` is the direction of the code; empty without a code.
    """

    name: str
    assembly: Assembly

    def change(self, straps: Sequence[Strap]) -> dict[str, Any]:
        """The change from the file to this load with straps, as a proof states it."""
        change: dict[str, Any] = {"straps": [strap.to_dict() for strap in straps]}
        return change | ({"gravity": self.assembly.gravity.tolist()} if self.name else {})


def load_cases(
    assembly: Assembly, code: str | None = None, forward: ArrayLike = (1.0, 0.0, 0.0)
) -> tuple[LoadCase, ...]:
    """The loads that straps must hold: the assembly, or one for each direction of a code.

    Raises an InputError if the code does not exist, or a direction is invalid.

    Examples
    --------
    >>> from kilter.scenes import stacks
    >>> cases = load_cases(stacks.tower(1), "eumos:0.5")
    >>> [case.name for case in cases], cases[0].assembly.gravity.tolist()
    (['forward', 'backward', 'left', 'right'], [4.905, 0.0, -9.81])
    """
    if code is None:
        return (LoadCase("", assembly),)
    cases = []
    for name, acceleration in code_accelerations(assembly, code, forward):
        motion = CarrierMotion(acceleration)
        motion.require_in_plane(assembly.planar)
        cases.append(LoadCase(name, carried_assembly(assembly, motion)))
    return tuple(cases)


def lashed(
    assembly: Assembly, contacts: ContactSet, straps: Sequence[Strap]
) -> tuple[Assembly, ContactSet]:
    """The assembly with further straps, and its contacts."""
    more = dataclasses.replace(assembly, straps=[*assembly.straps, *straps])
    return more, contacts.of(more)


def find_least_straps(
    assembly: Assembly,
    contacts: ContactSet,
    candidates: tuple[Strap, ...],
    *,
    code: str | None = None,
    forward: ArrayLike = (1.0, 0.0, 0.0),
    require: str,
    effort: float,
    tell: Callable[[str], None],
) -> Fixture:
    """Find the fewest candidate straps with which an assembly is in equilibrium in all loads.

    The loads are those of the code. Raises an InputError if a candidate does not fit the assembly,
    or the code does not exist.
    """
    started = time.perf_counter()
    for strap in candidates:
        strap_wrenches(dataclasses.replace(assembly, straps=[strap]))
    cases = load_cases(assembly, code, forward)
    found = _search(cases, contacts, candidates, tell)
    chosen = found.chosen
    levels: list[str | None] = [None for _ in cases]
    if chosen is not None:
        every = (lashed(case.assembly, contacts, [candidates[k] for k in chosen]) for case in cases)
        levels = [
            check(load, contacts=touching, require=require, effort=effort).level
            for load, touching in every
        ]
    straps = _chosen_straps(assembly, contacts, candidates, chosen or (), cases, found.forces)
    rules = {"code": {"name": code, "forward": np.array(forward, float).tolist()}}
    return Fixture(
        level=min(levels, key=level_rank) if chosen is not None else None,
        require=require,
        supports=None if chosen is None else (),
        straps=straps,
        code=code,
        cases=tuple(
            StrapCase(
                name=case.name,
                acceleration=assembly.gravity - case.assembly.gravity,
                level=level,
            )
            for case, level in zip(cases, levels, strict=True)
            if code is not None
        ),
        least=found.least,
        judged=len(found.motions) + len(found.forces),
        exhausted=found.exhausted,
        seconds={"solve": round(time.perf_counter() - started, 6)},
        assembly=assembly,
        contacts=contacts,
        offered=candidates,
        chosen=chosen,
        impossible=chosen is None and found.least > len(candidates),
        stated=found.stated(cases, candidates),
        rules=None if code is None else rules,
    )


class _Found(NamedTuple):
    """Result of a search: the chosen straps with forces for each load, and motions of other sets.

    A motion has the numbers of its load and of the straps of the set.
    """

    chosen: tuple[int, ...] | None
    forces: Sequence[ForceProof]
    motions: Sequence[tuple[int, tuple[int, ...], MotionProof]]
    least: int
    exhausted: bool

    def stated(self, cases: Sequence[LoadCase], candidates: Sequence[Strap]) -> list[Stated]:
        """The proofs with their subjects."""

        def subject(about: str, case: LoadCase, chosen: Sequence[int]) -> dict[str, Any]:
            change = case.change([candidates[k] for k in chosen])
            named = {"case": case.name} if case.name else {}
            return {"about": about, "chosen": list(chosen), "change": change, **named}

        held = zip(cases, self.forces, strict=False)
        return [
            *((subject("held", case, self.chosen or ()), proof) for case, proof in held),
            *((subject("not enough", cases[k], chosen), m) for k, chosen, m in self.motions),
        ]


def _search(
    cases: Sequence[LoadCase],
    contacts: ContactSet,
    candidates: Sequence[Strap],
    tell: Callable[[str], None],
) -> _Found:
    """Search for the fewest straps that hold every load."""
    motions: list[tuple[int, tuple[int, ...], MotionProof]] = []
    powers, least = np.zeros((0, 1 + len(candidates))), 0
    while len(motions) < MOTIONS:
        least, chosen = smallest_set(powers, least)
        if chosen is None:
            return _Found(None, (), motions, least, least > len(candidates))
        tell(f"straps: a set of {len(chosen)}, after {len(motions)} motions")
        forces, falls = _decide_all(cases, contacts, [candidates[k] for k in chosen])
        if len(forces) == len(cases):
            return _Found(chosen, forces, motions, least, True)
        if falls is None:
            break
        motions.append((len(forces), chosen, falls))
        row = strap_powers(cases[len(forces)].assembly, contacts, candidates, falls.motion)
        powers = np.vstack([powers, row])
        if row[1:][list(chosen)].sum() >= row[0]:
            break  # rounding: the motion does not exclude the set that it was found for
    return _Found(None, (), motions, least, False)


def _chosen_straps(
    assembly: Assembly,
    contacts: ContactSet,
    candidates: Sequence[Strap],
    chosen: Sequence[int],
    cases: Sequence[LoadCase],
    forces: Sequence[ForceProof],
) -> tuple[ChosenStrap, ...]:
    """The chosen straps with their tension, or their largest pull in a load."""
    straps = [candidates[k] for k in chosen]
    pulls = [strap.tension or 0.0 for strap in straps]
    for case, proof in zip(cases, forces, strict=False):
        program = build_program(*lashed(case.assembly, contacts, straps))
        rows = np.flatnonzero(program.kind == STRAP)
        for source, pull in zip(program.source[rows], proof.forces[rows], strict=True):
            if (k := source - len(assembly.straps)) >= 0:
                pulls[k] = max(pulls[k], float(pull))
    return tuple(
        ChosenStrap(
            candidate=k + 1,
            parts=strap.parts,
            tension=strap.tension,
            capacity=strap.capacity,
            pull=pull,
            strap=strap,
        )
        for k, strap, pull in zip(chosen, straps, pulls, strict=True)
    )


def _decide_all(
    cases: Sequence[LoadCase], contacts: ContactSet, straps: Sequence[Strap]
) -> tuple[list[ForceProof], MotionProof | None]:
    """Forces that hold the loads up to the first that they do not hold, and its motion.

    Without a motion, all loads are held or that first load is undecided.
    """
    proofs: list[ForceProof] = []
    for case in cases:
        assembly, touching = lashed(case.assembly, contacts, straps)
        program = build_program(assembly, touching)
        found = judge(program)
        if found.stable and found.forces is not None:
            proofs.append(found.forces)
            continue
        outer = build_program(assembly, touching, possible=True)
        if len(outer.part_a) > len(program.part_a):
            found = judge(outer)
        return proofs, found.motion if found.stable is False else None
    return proofs, None


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
