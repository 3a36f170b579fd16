"""The fewest of the candidate straps with which an assembly holds, proved.

A motion v of the load proves that the straps of a set T are not enough if it gains more power than
they take up:

    P(v) - sum over T of p_i(v) > tau(v)
    p_i = T_i e_i (tension)  or  LC_i max(e_i, 0) (capacity)

e_i is the rate at which strap i lengthens. P is the power of the load without these straps, and tau
what a proof by this motion needs (`kilter.mechanics.certificate`). Each motion is found for one
set, and excludes many. The search decides the smallest set that no known motion excludes, until one
holds. A tensioned strap may also do harm, so all sets of a size are compared, not only the minimal
covers.
"""

from __future__ import annotations

import dataclasses
import itertools
import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from kilter.analysis.decision.judge import judge
from kilter.analysis.open_pairs.open_question import open_pairs_answer
from kilter.arrays import Array
from kilter.assembly import Assembly, Strap
from kilter.assembly.strap_wrenches import strap_wrenches
from kilter.contact import ContactSet
from kilter.errors import InputError, some_names
from kilter.mechanics.bundle import make_bundle
from kilter.mechanics.certificate import ForceProof, MotionProof, check_motion, needed_power
from kilter.mechanics.program import Program, build_program
from kilter.mechanics.proof import Evidence, make_proof
from kilter.mechanics.rows import STRAP
from kilter.tell.hold_words import hold_sentence
from kilter.tell.json_answer import AnswerInWords
from kilter.tell.levels import holds

if TYPE_CHECKING:
    from kilter.tell.answer_data.plan_data import HoldData

__all__ = ["Lashing", "find_least_straps", "smallest_set", "strap_powers", "wrong_lashing"]

LARGEST = 2_000_000
"""Largest number of sets of one size that are compared. More sets leave the answer undecided."""
CHUNK = 100_000
"""Number of sets that are compared at a time. A larger number needs more memory."""
MOTIONS = 1000
"""Largest number of motions, and so of decided sets."""


@dataclass(frozen=True, slots=True, eq=False)
class Lashing(AnswerInWords):
    """Answer of `kilter.hold` with candidate straps: the fewest of them, or why there are none.

    Attributes
    ----------
    assembly : Assembly
        Without the candidates.
    contacts : ContactSet
    candidates : tuple of Strap
    chosen : tuple of int or None
        Indices of the straps of the answer; None without an answer.
    forces : ForceProof or None
        Forces that hold the assembly with these straps.
    level : str or None
        Level that `kilter.check` finds with these straps.
    require : str
    least : int
        No set of fewer straps holds, by proof.
    motions : tuple of (tuple of int, MotionProof)
        Sets that do not hold, each with its motion.
    impossible : bool
        True if the motions exclude every set.
    exhausted : bool
        False if a limit or an undecided set ended the search.
    seconds : float
    """

    answer: ClassVar[str] = "hold"

    assembly: Assembly
    contacts: ContactSet
    candidates: tuple[Strap, ...]
    chosen: tuple[int, ...] | None
    forces: ForceProof | None
    level: str | None
    require: str
    least: int
    motions: tuple[tuple[tuple[int, ...], MotionProof], ...]
    impossible: bool
    exhausted: bool
    seconds: float

    @property
    def straps(self) -> tuple[Strap, ...] | None:
        """The straps of the answer; None without an answer."""
        return None if self.chosen is None else tuple(self.candidates[k] for k in self.chosen)

    @property
    def verdict(self) -> str:
        """Verdict: "held", "impossible" (no set of the candidates holds), or "undecided"."""
        if self.chosen is not None:
            return "held"
        return "impossible" if self.impossible else "undecided"

    @property
    def holds(self) -> bool:
        """Whether the assembly reaches the required level with these straps."""
        return holds(self.level, self.require)

    @property
    def pulls(self) -> dict[int, float]:
        """Tension, or computed pull, of each chosen strap [N], by its index."""
        if self.chosen is None or self.forces is None:
            return {}
        assembly, contacts = lashed(self.assembly, self.contacts, self.straps or ())
        program = build_program(assembly, contacts)
        found = {k: strap.tension or 0.0 for k, strap in enumerate(assembly.straps)}
        rows = np.flatnonzero(program.kind == STRAP)
        found |= dict(zip(program.source[rows].tolist(), self.forces.forces[rows], strict=True))
        before = len(self.assembly.straps)
        return {index: float(found[before + k]) for k, index in enumerate(self.chosen)}

    def to_dict(self) -> HoldData:
        """The lashing as JSON data, as printed by ``kilter hold --straps FILE --json``."""
        pulls = self.pulls
        answer: HoldData = {
            "verdict": self.verdict,
            "level": self.level,
            "require": self.require,
            "holds": self.holds,
            "why": None,
            "open_pairs": open_pairs_answer(self.assembly, self.contacts),
            "supports": None if self.chosen is None else [],
            "straps": [
                {
                    "candidate": k + 1,
                    "parts": list(self.candidates[k].parts),
                    "tension": self.candidates[k].tension,
                    "capacity": self.candidates[k].capacity,
                    "pull": pulls.get(k),
                }
                for k in self.chosen or ()
            ],
            "least": self.least,
            "fewest": self.chosen is not None,
            "motions": [],
            "candidates": len(self.candidates),
            "most": None,
            "units": self.assembly.units,
            "base": [part.name for part in self.assembly if part.grounded],
            "judged": len(self.motions) + (self.chosen is not None),
            "exhausted": self.exhausted,
            "interrupted": False,
            "time_limit": None,
            "warnings": self.contacts.remarks(),
            "seconds": {"solve": round(self.seconds, 6)},
            "sentence": "",  # made below from the other data
        }
        answer["sentence"] = hold_sentence(answer)
        return answer

    def proof(self, *, options: dict[str, Any] | None = None) -> dict[str, Any]:
        """Proof that these straps hold the assembly and fewer do not, for `kilter.verify`.

        Raises
        ------
        InputError
            If no straps were found and their absence is not proved.
        """
        if self.verdict == "undecided":
            raise InputError("nothing is proved about the straps, so there is no proof to write")
        stated: list[tuple[str, tuple[int, ...], ForceProof | MotionProof]] = []
        if self.chosen is not None and self.forces is not None:
            stated.append(("held", self.chosen, self.forces))
        stated += [("not enough", chosen, motion) for chosen, motion in self.motions]
        proofs = []
        for about, chosen, certificate in stated:
            straps = [self.candidates[k] for k in chosen]
            assembly, contacts = lashed(self.assembly, self.contacts, straps)
            by_motion = isinstance(certificate, MotionProof)
            program = build_program(assembly, contacts, possible=by_motion)
            if isinstance(certificate, MotionProof):
                certificate, evidence = check_motion(program, certificate.motion), None
            else:
                evidence = Evidence("open") if program.mu.any() else None
            data = make_proof(
                assembly, contacts, program, certificate, options or {}, evidence=evidence
            )
            change = {"straps": [strap.to_dict() for strap in straps]}
            proofs.append(({"about": about, "chosen": list(chosen), "change": change}, data))
        rules = {
            "candidates": [strap.to_dict() for strap in self.candidates],
            "least": self.least,
        }
        return make_bundle("lashing", proofs, rules=rules)

    def __repr__(self) -> str:
        if self.straps is None:
            return f"<Lashing: {self.verdict}, {self.least} or more>"
        return f"<Lashing: {some_names([repr(strap) for strap in self.straps]) or 'nothing'}>"


def find_least_straps(
    assembly: Assembly,
    contacts: ContactSet,
    candidates: Sequence[Strap],
    *,
    require: str,
    level_of: Callable[[Assembly, ContactSet], str | None],
    progress: Callable[[str], None] | None = None,
) -> Lashing:
    """Find the fewest of the candidate straps with which an assembly is in equilibrium.

    Parameters
    ----------
    assembly : Assembly
        Its own straps stay.
    contacts : ContactSet
        The contacts of this assembly.
    candidates : sequence of Strap
    require : str
        Level from which the answer is yes; the search is for equilibrium.
    level_of : callable
        Function that returns the level of an assembly with the found straps.
    progress : callable, optional
        Function that is called with the name of each stage.

    Raises
    ------
    InputError
        If a candidate does not fit the assembly.
    """
    started = time.perf_counter()
    tell = progress or (lambda stage: None)
    for strap in candidates:
        strap_wrenches(dataclasses.replace(assembly, straps=[strap]))
    motions: list[tuple[tuple[int, ...], MotionProof]] = []
    powers, least = np.zeros((0, 1 + len(candidates))), 0
    chosen: tuple[int, ...] | None = None
    forces: ForceProof | None = None
    impossible = exhausted = False
    while len(motions) < MOTIONS:
        least, found = smallest_set(powers, len(candidates), least)
        if found is None:
            impossible = exhausted = least > len(candidates)
            break
        tell(f"straps: a set of {len(found)}, after {len(motions)} motions")
        straps = [candidates[k] for k in found]
        stable, proof = _decide(*lashed(assembly, contacts, straps))
        if stable and isinstance(proof, ForceProof):
            chosen, forces, exhausted = found, proof, True
            break
        if not isinstance(proof, MotionProof):
            break
        motions.append((found, proof))
        row = strap_powers(assembly, contacts, candidates, proof.motion)
        powers = np.vstack([powers, row])
        if row[1:][list(found)].sum() >= row[0]:
            break  # rounding: the motion does not exclude the set that it was found for
    level = None
    if chosen is not None:
        level = level_of(*lashed(assembly, contacts, [candidates[k] for k in chosen]))
    return Lashing(
        assembly, contacts, tuple(candidates), chosen, forces, level, require, least,
        tuple(motions), impossible, exhausted, time.perf_counter() - started,
    )  # fmt: skip


def lashed(
    assembly: Assembly, contacts: ContactSet, straps: Sequence[Strap]
) -> tuple[Assembly, ContactSet]:
    """The assembly with further straps, and its contacts."""
    more = dataclasses.replace(assembly, straps=[*assembly.straps, *straps])
    return more, contacts.of(more)


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


def smallest_set(powers: Array, count: int, least: int) -> tuple[int, tuple[int, ...] | None]:
    """The smallest set of straps that no motion excludes; among those, the strongest.

    Parameters
    ----------
    powers : ndarray, shape (m, 1 + count)
        Of each motion, as `strap_powers` returns them.
    count : int
        Number of straps.
    least : int
        Smaller sets are known to be excluded.

    Returns
    -------
    least : int
        Every set of fewer straps is excluded; `count` + 1 if all sets are.
    chosen : tuple of int or None
        None if all sets are excluded, or if there are too many sets of this size.
    """
    needed, taken = powers[:, 0], powers[:, 1:]
    scale = np.maximum(np.abs(powers).max(axis=1, initial=0.0), np.finfo(float).tiny)
    for size in range(least, count + 1):
        if math.comb(count, size) > LARGEST:
            return size, None
        best: tuple[float, tuple[int, ...] | None] = (-np.inf, None)
        sets = itertools.combinations(range(count), size)
        while chunk := list(itertools.islice(sets, CHUNK)):
            index = np.array(chunk, dtype=np.int64).reshape(len(chunk), size)
            total = taken[:, index].sum(axis=2)
            room = ((total - needed[:, None]) / scale[:, None]).min(axis=0, initial=np.inf)
            widest = int(room.argmax())
            if room[widest] >= 0.0 and room[widest] > best[0]:
                best = (float(room[widest]), chunk[widest])
        if best[1] is not None:
            return size, best[1]
    return count + 1, None


def wrong_lashing(
    assembly: Assembly, contacts: ContactSet, bundle: Mapping[str, Any], verdicts: Sequence[str]
) -> list[str]:
    """Reasons why valid proofs about sets of straps do not prove the fewest straps."""
    rules = bundle["rules"]
    candidates = [_strap_of(data) for data in rules["candidates"]]
    reasons: list[str] = []
    held: list[list[int]] = []
    rows: list[Array] = []
    for entry, verdict in zip(bundle["proofs"], verdicts, strict=True):
        chosen = entry["chosen"]
        if sorted(set(chosen)) != chosen or not all(0 <= k < len(candidates) for k in chosen):
            return ["a set of straps names no candidates"]
        if entry["change"] != {"straps": [candidates[k].to_dict() for k in chosen]}:
            return ["the straps of a proof differ from the candidates that it names"]
        if verdict != "unstable":
            held.append(chosen)
            continue
        motion = np.zeros((len(assembly.parts), 6))
        for name, six in entry["proof"]["motion"].items():
            motion[assembly.index_of(name)] = six
        rows.append(strap_powers(assembly, contacts, candidates, motion))
    powers = np.array(rows).reshape(-1, 1 + len(candidates))
    least, _ = smallest_set(powers, len(candidates), 0)
    if least < rules["least"]:
        reasons.append(f"its motions do not exclude every set of {least} straps")
    if not held and least <= len(candidates):
        reasons.append("it has no straps that hold, and its motions do not exclude every set")
    if any(len(chosen) > rules["least"] for chosen in held):
        reasons.append("its straps are more than the least number that it states")
    return reasons


def _strap_of(data: Mapping[str, Any]) -> Strap:
    """The strap of JSON data."""
    return Strap(**{**data, "path": [tuple(point) for point in data["path"]]})
