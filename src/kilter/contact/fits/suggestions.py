"""Pairs that look as if they were fastened, with the joint that each would be.

Parts that share volume cannot both be where they are drawn: a thread that is modelled as a
cylinder, a press fit, an insert in its hole, or a model that is not true. A part whose
cylinder fills a hole of another, size on size, is meant to be held by it too: a bolt in a
nut, a pin, a shaft in its bearing. What interferes is taken for fixed, and so is what is
named a nut or an insert; else size on size for a shaft that turns and slides, which its
contact says already. Nothing is joined by itself (`kilter.contact.fits.fastening`).

The kinds, the surest first:

    thread         coaxial and thicker by more than a press fit, or named a screw or a nut
    press fit      coaxial and thicker, or round faces that interfere
    insert         the same of a part that is hollow itself, or named an insert
    overlap        anything else that shares volume: sloppy modelling, or a weld
    same body      the same body twice: to be left out, not joined
    size on size   coaxial, as thick as the hole: turns and slides
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np

from kilter.assembly import Assembly
from kilter.contact.contact_set import INTERFERE, SAME_BODY, ContactSet, Overlap
from kilter.contact.contact_tolerances import AXIS_ROUNDING, PRESS_FIT, THREAD
from kilter.contact.fits.coaxial import Fit, coaxial_fits, is_tube
from kilter.errors import shell_words

__all__ = ["Kind", "Suggestion", "suggest_joints", "touching_pairs"]

Kind = Literal["thread", "press fit", "insert", "overlap", "same body", "size on size"]
RANK = {kind: rank for rank, kind in enumerate(get_args(Kind))}


def _word(*words: str) -> re.Pattern[str]:
    return re.compile(rf"(?<![a-z])({'|'.join(words)})s?(?![a-z])", re.IGNORECASE)


HOLLOW = _word("nut", "insert", "helicoil")
"""Names of parts whose hole is taken for a thread."""
INSERT = _word("insert", "helicoil", "bushing", "bush")
"""Names of parts that are pressed or melted into others."""
THREADED = _word("nut", "screw", "bolt", "stud", "thread", "shcs", "bhcs", "fhcs")
"""Names of parts that have a thread."""


@dataclass(frozen=True, slots=True, eq=False)
class Suggestion:
    """A pair that looks as if it were fastened.

    Attributes
    ----------
    parts : pair of str
        The bolt, pin or shaft; the part with the hole.
    kind : str
    why : str
    option : str
        What to add to a command: it fixes them, or leaves one out.
    joint : dict or None
        What to add to the file's `joints`.
    """

    parts: tuple[str, str]
    kind: Kind
    why: str
    option: str
    joint: dict[str, Any] | None

    @property
    def fixed(self) -> bool:
        """It is to be fixed; else it is to be left to slide, or left out."""
        return self.joint is not None and self.joint["kind"] == "fixed"

    def to_dict(self) -> dict[str, Any]:
        """As JSON data."""
        entry = {"parts": list(self.parts), "kind": self.kind, "why": self.why}
        return {**entry, "option": self.option, "joint": self.joint}


def touching_pairs(contacts: ContactSet) -> list[tuple[int, int]]:
    """Pairs of parts that touch in any way, overlaps included, in order."""
    pairs = [(int(a), int(b)) for a, b in contacts.patch_parts]
    pairs += [entry.parts for entry in contacts.unsupported]
    pairs += [entry.parts for entry in contacts.overlaps]
    return sorted({(min(pair), max(pair)) for pair in pairs})


def suggest_joints(assembly: Assembly, contacts: ContactSet) -> list[Suggestion]:
    """Pairs that look as if they were fastened and are not joined yet, the surest first.

    Every pair that overlaps, and coaxial cylinders, a solid one in a hollow one, that are as
    thick within the tolerance. Never a pair of held parts, nor the table of `with_floor`.
    """
    near = [*touching_pairs(contacts), *(r.parts for r in contacts.rejected)]
    overlaps = {_key(overlap.parts): overlap for overlap in contacts.overlaps}
    wanted = [pair for pair in near if _may_join(assembly, pair)]
    fits: dict[frozenset[int], Fit] = {}
    for fit in coaxial_fits(assembly, wanted, contacts.tolerance, thickest=THREAD):
        key = _key(fit.parts)
        if fit.tight and key not in overlaps:
            continue
        if key not in fits or (fit.tight, fit.length) > (fits[key].tight, fits[key].length):
            fits[key] = fit
    found = [
        _of_fit(assembly, fit, overlaps.get(key))
        for key, fit in fits.items()
        if fit.tight or key not in overlaps
    ]
    told = {key for key, fit in fits.items() if fit.tight or key not in overlaps}
    for key, overlap in overlaps.items():
        if key not in told and _may_join(assembly, overlap.parts):
            found.append(_of_overlap(assembly, overlap))
    return sorted(found, key=lambda one: RANK[one.kind])


def _key(parts: tuple[int, int]) -> frozenset[int]:
    return frozenset(parts)


def _may_join(assembly: Assembly, pair: tuple[int, int]) -> bool:
    """A pair that is not joined yet, not held on both sides, and not one with the table."""
    one, other = (assembly.parts[k] for k in pair)
    if (one.grounded and other.grounded) or one.table or other.table:
        return False
    both = {one.name, other.name}
    return not any(both == set(joint.parts) for joint in assembly.joints)


def _of_fit(assembly: Assembly, fit: Fit, overlap: Overlap | None) -> Suggestion:
    parts = (assembly.names[fit.parts[0]], assembly.names[fit.parts[1]])
    unit = assembly.units
    size = f"radius {fit.radius:.6g} {unit} over {fit.length:.4g} {unit}"
    if fit.tight:
        why = f"coaxial, {size}, interferes by {fit.interference:.3g} {unit}"
        return _fixed(parts, *_kind_of_fit(assembly, fit, why))
    why = f"coaxial, size on size, {size}"
    nut = HOLLOW.search(_tail(parts[1]))
    if nut:
        return _fixed(parts, "thread", f"{why}, by its name {_a(nut[1])}")
    joint = {
        "parts": list(parts),
        "kind": "cylindrical",
        "point": (fit.point + 0.0).tolist(),
        "axis": np.where(np.abs(fit.axis) < AXIS_ROUNDING, 0.0, fit.axis).tolist(),
    }
    return Suggestion(parts, "size on size", why, _option(parts), joint)


def _kind_of_fit(assembly: Assembly, fit: Fit, why: str) -> tuple[Kind, str]:
    """Of a shaft that is thicker than its hole: a thread, a press fit or an insert."""
    shaft, hole = (_tail(assembly.names[k]) for k in fit.parts)
    insert = INSERT.search(shaft)
    if insert:
        return "insert", f"{why}, by its name {_a(insert[1])}"
    thread = THREADED.search(shaft) or HOLLOW.search(hole)
    if thread:
        return "thread", f"{why}, by its name {_a(thread[1])}"
    if is_tube(assembly, fit):
        return "insert", f"{why}, hollow itself: an insert or a bushing"
    if fit.interference > PRESS_FIT * fit.radius:
        return "thread", f"{why}: a screw in its thread"
    return "press fit", f"{why}: pressed in"


def _of_overlap(assembly: Assembly, overlap: Overlap) -> Suggestion:
    """Of parts that share volume and are no shaft in its hole."""
    parts = (assembly.names[overlap.parts[0]], assembly.names[overlap.parts[1]])
    unit = assembly.units
    if overlap.why == SAME_BODY:
        option = f"--without {shell_words(parts[1:])}"
        return Suggestion(parts, "same body", "the same body twice: leave one out", option, None)
    why = f"overlap by {overlap.depth:.3g} {unit}"
    if overlap.volume is not None:
        share = overlap.volume / float(assembly.geometry.volume[list(overlap.parts)].min())
        why += f", {100 * share:.2g} % of the smaller"
    tails = [_tail(name) for name in parts]
    for kind, names in (("insert", INSERT), ("thread", THREADED)):
        for tail, pair in zip(tails, (parts, parts[::-1]), strict=True):
            named = names.search(tail)
            if named:
                sure: Kind = "insert" if kind == "insert" else "thread"
                return _fixed(pair, sure, f"{why}, by its name {_a(named[1])}")
    if overlap.why == INTERFERE:
        return _fixed(parts, "press fit", f"interfere by {overlap.depth:.3g} {unit}: pressed in")
    return _fixed(parts, "overlap", f"{why}: glued or welded, or not modelled true")


def _tail(name: str) -> str:
    return name.rpartition("/")[2]


def _a(word: str) -> str:
    """A word with its article."""
    return f"{'an' if word[0].lower() in 'aeiou' else 'a'} {word.lower()}"


def _fixed(parts: tuple[str, str], kind: Kind, why: str) -> Suggestion:
    return Suggestion(parts, kind, why, _option(parts), {"parts": list(parts), "kind": "fixed"})


def _option(parts: tuple[str, str]) -> str:
    return f"--fasten {shell_words(parts)}"
