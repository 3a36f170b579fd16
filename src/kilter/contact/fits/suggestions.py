"""Parts that lie in the same place, and pairs that look fastened, with suggested joints.

Two parts coincide if they share more than half of the volume of the smaller part, and are neither
both held nor fixed to each other. A screw in a nut that is drawn without its hole shares less. The
causes:

    the same body twice, variants in a single file, the whole beside its parts
        the answer has a warning, whose option leaves parts out; the reader of drawings has left out
        bodies that they contain twice (`kilter.contact.fits.copies`)
    a part modelled without the hole for another, a misplaced part
        the answer has a warning, whose option joins the parts
    files in frames of their own, a table above the lowest part
        the assembly is rejected, since all of its contacts are wrong

Parts that share volume cannot both be positioned as drawn: a thread that is modelled as a cylinder,
a press fit, an insert in its hole, or an inaccurate model. A part whose cylinder fills a hole of
another part, size on size, is meant to be held by it too: a bolt in a nut, a pin, a shaft in its
bearing. Pairs with interference, parts named as nut or insert, and pairs that clamp other parts
between them (the head of a bolt and its nut) are suggested as fixed. Other size-on-size fits are
suggested as a shaft that rotates and slides, which their contact already models. Nothing is joined
automatically (`kilter.contact.fits.fastening`).

The kinds, the most certain first:

    thread         coaxial and thicker by more than a press fit, or named as a screw or a nut, or
                   size on size with other parts clamped between head and nut
    press fit      coaxial and thicker, or round faces that interfere
    insert         the same of a part that is hollow itself, or named as an insert
    overlap        any other shared volume: sloppy modelling, or a weld
    same body      the same body twice: to be left out, not joined
    size on size   coaxial, as thick as the hole: rotates and slides
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from pathlib import Path
from typing import Any, Literal, get_args
from weakref import WeakKeyDictionary

import numpy as np

from kilter.assembly import Assembly
from kilter.contact.common.patches import INTERFERE, SAME_BODY, Overlap
from kilter.contact.contact_set import ContactSet
from kilter.contact.contact_tolerances import (
    ANGLE,
    AXIS_ROUNDING,
    COINCIDENT,
    DEEP,
    GAP,
    INSIDE,
    PRESS_FIT,
    SUNK,
    THREAD,
)
from kilter.contact.curved.coaxial_faces import Fit, coaxial_fits, is_tube
from kilter.errors import InputError, shell_words
from kilter.shape.solid import Solid
from kilter.tell.record import Record

MANY = 3
"""Number of such pairs from which the parts of a folder seem to have separate frames."""

SHARE_DIGITS = 6
"""Digits to which shares are compared: the volume of an intersection has a rounding error."""


def coincident(contacts: ContactSet) -> list[Overlap]:
    """Overlaps of open pairs that fill over half of the smaller part, the largest share first.

    In a folder, deep overlaps of three parts with each other count, too.
    """
    left_open = {frozenset(pair.ends) for pair in contacts.open_pairs}
    known = [overlap for overlap in contacts.overlaps if frozenset(overlap.ends) in left_open]
    about_one_point = _mutual(contacts, known)
    coinciding = [
        overlap
        for overlap in known
        if (overlap.share or 0.0) > COINCIDENT or frozenset(overlap.ends) in about_one_point
    ]
    parts = contacts.assembly.parts

    def rank(overlap: Overlap) -> tuple[float, bool, bool]:
        """The largest share first; of equal shares the table, then the same body twice."""
        share = round(min(overlap.share or 0.0, 1.0), SHARE_DIGITS)
        return -share, not any(parts[k].table for k in overlap.ends), overlap.why != SAME_BODY

    return sorted(coinciding, key=rank)


def _mutual(contacts: ContactSet, overlaps: Sequence[Overlap]) -> set[frozenset[int]]:
    """Pairs of parts of a folder that overlap each other and a third part, all deeply.

    Bolts that are drawn without their holes overlap a common part, but not each other.
    """
    source, size = Path(contacts.assembly.source), contacts.assembly.geometry.size
    if not contacts.assembly.source or source.suffix:
        return set()
    deep = {frozenset(o.ends) for o in overlaps if o.depth > DEEP * size[list(o.ends)].min()}
    parts = sorted({part for pair in deep for part in pair})
    threes = [[frozenset(p) for p in combinations(three, 2)] for three in combinations(parts, 3)]
    return {pair for pairs in threes if deep.issuperset(pairs) for pair in pairs}


def require_apart(assembly: Assembly, contacts: ContactSet) -> None:
    """Raise an InputError if parts lie on each other because all contacts are wrong.

    Raises `InputError` with the pairs, the likely cause, and a remedy.

    Examples
    --------
    >>> from kilter.assembly import Part
    >>> from kilter.contact import contacts
    >>> from kilter.rigid import Pose
    >>> from kilter.shape.primitives import Box
    >>> cubes = [Part(f"a{k}", Box([1, 1, 1]), Pose([0.2 * k, 0, 0])) for k in range(3)]
    >>> require_apart(Assembly(cubes), contacts(Assembly(cubes)))
    Traceback (most recent call last):
    ...
    kilter.errors.InputError: 'a0' and 'a1' share 80 % of 'a1', and 2 more pairs coincide: each ...
    """
    contacts = contacts.of(assembly)
    overlaps = coincident(contacts)
    if not overlaps:
        return
    cause = _cause_and_remedy(contacts, overlaps)
    if cause.rejects:
        raise InputError(
            f"{_pairs_in_words(contacts, overlaps)}: {cause.reason}",
            file=assembly.source or None,
            hint=cause.hint,
            option=cause.option,
        )


def coincident_remarks(contacts: ContactSet) -> list[str]:
    """A warning about parts that lie in the same place, with its remedy; empty without such parts.

    Examples
    --------
    >>> from kilter.assembly import Part
    >>> from kilter.contact import contacts
    >>> from kilter.rigid import Pose
    >>> from kilter.shape.primitives import Box
    >>> cubes = [Part("a", Box([1, 1, 1])), Part("b", Box([1, 1, 1]), Pose([0.3, 0, 0]))]
    >>> coincident_remarks(contacts(Assembly(cubes)))[0].partition(":")[0]
    "'a' and 'b' share 70 % of 'b'"
    """
    overlaps = coincident(contacts)
    if not overlaps:
        return []
    cause = _cause_and_remedy(contacts, overlaps)
    return [f"{_pairs_in_words(contacts, overlaps)}: {cause.reason}; {cause.option}"]


def _pairs_in_words(contacts: ContactSet, overlaps: Sequence[Overlap]) -> str:
    """Describe the first coincident pair, and the second pair or the number of further pairs."""
    more = f", and {len(overlaps) - 1} more pairs coincide" if len(overlaps) > 2 else ""
    if len(overlaps) == 2:
        more = f", and {_describe(contacts, overlaps[1])}"
    return f"{_describe(contacts, overlaps[0])}{more}"


@dataclass(frozen=True, slots=True)
class _Cause:
    """Likely cause of parts in the same place: its remedy in Python (`hint`) and as an option.

    `rejects`: whether no answer is possible.
    """

    reason: str
    hint: str
    option: str
    rejects: bool = False


def _describe(contacts: ContactSet, overlap: Overlap) -> str:
    """Describe in words how two parts occupy the same place; the smaller part comes second."""
    larger, smaller = (repr(contacts.assembly.names[k]) for k in _sort_by_volume(contacts, overlap))
    if overlap.why == SAME_BODY:
        return f"{larger} and {smaller} are the same body twice"
    if (overlap.share or 0.0) > INSIDE:
        return f"{smaller} lies inside {larger}"
    if not overlap.share:
        depth = f"{overlap.depth:.3g} {contacts.assembly.units}"
        return f"{larger} and {smaller} overlap by {depth}"
    return f"{larger} and {smaller} share {100 * overlap.share:.2g} % of {smaller}"


def _sort_by_volume(contacts: ContactSet, overlap: Overlap) -> tuple[int, int]:
    """Indices of the two parts of an overlap, the larger part first."""
    a, b = overlap.ends
    volume = contacts.assembly.geometry.volume
    return (a, b) if volume[a] >= volume[b] else (b, a)


def _whole_of(contacts: ContactSet, overlaps: Sequence[Overlap]) -> int | None:
    """Index of a part that the other overlapping parts together fill, such as a whole; or None."""
    pairs = [_sort_by_volume(contacts, overlap) for overlap in overlaps]
    larger, smaller = {pair[0] for pair in pairs}, [pair[1] for pair in pairs]
    if len(larger) != 1 or len(smaller) < 2:
        return None
    whole, volume = larger.pop(), contacts.assembly.geometry.volume
    shares = [overlap.share or 0.0 for overlap in overlaps]
    filled = sum(share * volume[part] for share, part in zip(shares, smaller, strict=True))
    return whole if filled > COINCIDENT * volume[whole] else None


def _cause_and_remedy(contacts: ContactSet, overlaps: Sequence[Overlap]) -> _Cause:
    """Likely cause of parts in the same place, and its remedy."""
    parts = contacts.assembly.parts
    first = overlaps[0]
    larger, smaller = _sort_by_volume(contacts, first)
    names = parts[larger].name, parts[smaller].name
    if any(parts[k].table for k in first.ends):
        how = "give the floor a lower height"
        option = (
            f"{how}: --floor HEIGHT, or --floor alone; --without NAME leaves out a plane of a scene"
        )
        return _Cause("the table is too high", how, option, rejects=True)
    if first.why == SAME_BODY and len(overlaps) < MANY:
        copy = names[0] if parts[smaller].grounded else names[1]
        return _Cause(
            "a copy or an exploded view, or a file given under two names",
            f"leave a part out with assembly.without({copy!r})",
            f"leave a part out with --without {shell_words((copy,))}",
        )
    whole = _whole_of(contacts, overlaps)
    if whole is not None:
        name = parts[whole].name
        return _Cause(
            f"{name!r} is the whole beside its parts",
            f"leave the whole out with assembly.without({name!r})",
            f"leave the whole out with --without {shell_words((name,))}",
        )
    join = f"kilter.fastened(assembly, [{names!r}])"
    fasten = f"--fasten {shell_words(names[:2])}"
    if len(overlaps) >= MANY and Path(contacts.assembly.source).suffix:
        out = sorted({parts[_sort_by_volume(contacts, pair)[1]].name for pair in overlaps})
        words = " ".join(f"--without {shell_words((name,))}" for name in out)
        return _Cause(
            "copies, or variants drawn over each other",
            f"leave the smaller parts out with assembly.without({out!r}); or join with {join}",
            f"leave the smaller parts out with {words}; "
            f"or join parts that are meant to overlap with {fasten} or --fasten-overlaps",
        )
    if len(overlaps) >= MANY:
        place = "export the parts where they are in the assembly, not each in its own frame"
        return _Cause(
            "each file seems to be in a frame of its own",
            f"{place}; or join parts that are meant to overlap with {join}",
            f"{place}; or join parts that are meant to overlap with {fasten} or --fasten-overlaps",
            rejects=True,
        )
    return _Cause(
        "misplaced, or drawn without the hole for the other",
        f"correct the model; or join parts that are meant to overlap with {join}",
        f"correct the model; or join parts that are meant to overlap with {fasten}",
    )


Kind = Literal["thread", "press fit", "insert", "overlap", "same body", "size on size"]
RANK = {kind: rank for rank, kind in enumerate(get_args(Kind))}


def _word(*words: str) -> re.Pattern[str]:
    """Regular expression for any of some whole words, also in plural."""
    return re.compile(rf"(?<![a-z])({'|'.join(words)})s?(?![a-z])", re.IGNORECASE)


HOLLOW = _word("nut", "insert", "helicoil")
"""Names of parts whose hole is taken for a thread."""
INSERT = _word("insert", "helicoil", "bushing", "bush")
"""Names of parts that are pressed or melted into others."""
THREADED = _word("nut", "screw", "bolt", "stud", "thread", "shcs", "bhcs", "fhcs")
"""Names of parts that have a thread."""


class Suggestion(Record, kw_only=False):
    """A pair of parts that looks fastened, and the option that fastens it."""

    parts: tuple[str, str]
    """The bolt, pin or shaft; the part with the hole."""
    kind: Kind
    """Kind of the fit."""
    why: str
    """Reason, in words."""
    option: str
    """Command-line option that fixes them, or leaves one part out."""
    joint: dict[str, Any] | None
    """Entry to add to the joints of an assembly file."""

    @property
    def fixed(self) -> bool:
        """Whether the joint is fixed; if not, the parts may slide, or one should be left out."""
        return self.joint is not None and self.joint["kind"] == "fixed"


def touching_pairs(contacts: ContactSet) -> list[tuple[int, int]]:
    """Pairs of parts, by index and in order, that touch or overlap."""
    pairs = [(int(a), int(b)) for a, b in contacts.patch_parts]
    pairs += [entry.ends for entry in contacts.unsupported]
    pairs += [entry.ends for entry in contacts.overlaps]
    return sorted({(min(pair), max(pair)) for pair in pairs})


def suggest_joints(assembly: Assembly, contacts: ContactSet) -> list[Suggestion]:
    """Suggest joints for pairs that look fastened and have none, the most certain pairs first.

    They are all pairs that overlap, and solid cylinders in coaxial hollow cylinders of the same
    radius within the tolerance; but no pair of held parts, not the table of `with_floor`, and no
    parts that are merely sunk into each other.
    """
    if assembly is not contacts.assembly:
        return _suggested(assembly, contacts)
    if contacts not in _KNOWN:
        _KNOWN[contacts] = _suggested(assembly, contacts)
    return list(_KNOWN[contacts])


_KNOWN: WeakKeyDictionary[ContactSet, list[Suggestion]] = WeakKeyDictionary()
"""Suggestions for the assemblies of contacts: each rung of the ladder asks for them."""


def _suggested(assembly: Assembly, contacts: ContactSet) -> list[Suggestion]:
    """The suggestions of `suggest_joints`."""
    near_pairs = [*touching_pairs(contacts), *(r.ends for r in contacts.near)]
    overlaps = {_key(overlap.ends): overlap for overlap in contacts.overlaps}
    joinable = [pair for pair in near_pairs if _may_join(assembly, pair)]
    fits: dict[frozenset[int], Fit] = {}
    user_gap = contacts.searched.gap or 0.0
    # the fit as drawn: a gap tolerance of the user makes no thread of a clearance or a press fit
    drawn = replace(contacts.searched, gap=None, relative_gap=GAP)
    for fit in coaxial_fits(assembly, joinable, drawn, thickest=THREAD):
        key = _key(fit.ends)
        # a clearance holds nothing, also if a tolerance counts it as closed
        closed = key in overlaps or fit.interference <= user_gap
        if fit.fit == "clearance" or (fit.tight and not closed):
            continue
        if key not in fits or (fit.tight, fit.length) > (fits[key].tight, fits[key].length):
            fits[key] = fit
    # a pair that overlaps elsewhere is suggested by its overlap, not by a fit size on size
    fits = {key: fit for key, fit in fits.items() if fit.tight or key not in overlaps}
    suggestions = [_from_fit(assembly, contacts, fit) for fit in fits.values()]
    for key, overlap in overlaps.items():
        joinable_pair = key not in fits and _may_join(assembly, overlap.ends)
        if joinable_pair and not merely_sunk(assembly, overlap):
            suggestions.append(_from_overlap(assembly, overlap))
    return sorted(suggestions, key=lambda suggestion: RANK[suggestion.kind])


def _key(parts: tuple[int, int]) -> frozenset[int]:
    return frozenset(parts)


def _may_join(assembly: Assembly, pair: tuple[int, int]) -> bool:
    """Whether a pair may be joined: no joint yet, at least one part free, no table in it."""
    first, second = (assembly.parts[k] for k in pair)
    if (first.grounded and second.grounded) or first.table or second.table:
        return False
    names = {first.name, second.name}
    return not any(names == set(joint.parts) for joint in assembly.joints)


def merely_sunk(assembly: Assembly, overlap: Overlap) -> bool:
    """Whether parts overlap so little that they are sunk, as in a simulator, and not joined.

    Exact solids and parts whose names say that they are fastened are drawn with care.
    """
    pair, geometry = list(overlap.ends), assembly.geometry
    drawn = any(isinstance(assembly.parts[k].shape, Solid) for k in pair)
    names = [_short_name(assembly.names[k]) for k in pair]
    if drawn or any(one.search(name) for one in (INSERT, THREADED, HOLLOW) for name in names):
        return False
    small = overlap.share is not None and overlap.share <= SUNK
    plain = overlap.why not in (SAME_BODY, INTERFERE)
    return plain and small and overlap.depth <= SUNK * float(geometry.size[pair].min())


def _from_fit(assembly: Assembly, contacts: ContactSet, fit: Fit) -> Suggestion:
    """The suggested joint for a shaft in its hole."""
    parts = (assembly.names[fit.ends[0]], assembly.names[fit.ends[1]])
    unit = assembly.units
    size = f"radius {fit.radius:.6g} {unit} over {fit.length:.4g} {unit}"
    if fit.tight:
        why = f"coaxial, {size}, interferes by {fit.interference:.3g} {unit}"
        return _fixed_joint(parts, *_kind_of_fit(assembly, fit, why))
    why = f"coaxial, size on size, {size}"
    nut = HOLLOW.search(_short_name(parts[1]))
    if nut:  # a nut that is drawn size on size still holds its bolt
        return _fixed_joint(parts, "thread", f"{why}, by its name {_with_article(nut[1])}")
    clamped = _clamped_between(contacts, fit)
    if clamped is not None:
        between = assembly.names[clamped]
        return _fixed_joint(parts, "thread", f"{why}: they clamp {between!r} between them")
    joint = {
        "parts": list(parts),
        "kind": "cylindrical",
        "point": (fit.point + 0.0).tolist(),
        "axis": np.where(np.abs(fit.axis) < AXIS_ROUNDING, 0.0, fit.axis).tolist(),
    }
    return Suggestion(parts, "size on size", why, _fasten_option(parts), joint)


def _clamped_between(contacts: ContactSet, fit: Fit) -> int | None:
    """Index of a part that shaft and hole of a fit clamp along its axis; None if there is none.

    The head of a bolt presses a part along the axis, and the nut presses a part behind it in the
    opposite sense. The two may be the same part, or the ends of a stack.
    """
    first, second = contacts.patch_parts.T
    along = contacts.patch_normal @ fit.axis
    flat = (contacts.patch_kind == "plane") & (np.abs(along) > np.cos(ANGLE))
    height = (contacts.points @ fit.axis)[contacts.patch_start[:-1]]
    pressed = []
    for part, other in (fit.ends, fit.ends[::-1]):
        outwards = flat & (first == part) & (second != other)
        inwards = flat & (second == part) & (first != other)
        rows = np.flatnonzero(outwards | inwards)
        sense = np.where(outwards[rows], along[rows], -along[rows])
        neighbour = np.where(outwards[rows], second[rows], first[rows])
        pressed.append(list(zip(np.sign(sense), height[rows], neighbour, strict=True)))
    for sense, low, neighbour in pressed[0]:
        if any(sense == -back and (high - low) * sense > 0 for back, high, _ in pressed[1]):
            return int(neighbour)
    return None


def _kind_of_fit(assembly: Assembly, fit: Fit, why: str) -> tuple[Kind, str]:
    """Kind of fastening (thread, press fit or insert) of a shaft thicker than its hole, and why."""
    shaft, hole = (_short_name(assembly.names[k]) for k in fit.ends)
    insert = INSERT.search(shaft)
    if insert:
        return "insert", f"{why}, by its name {_with_article(insert[1])}"
    thread = THREADED.search(shaft) or HOLLOW.search(hole)
    if thread:
        return "thread", f"{why}, by its name {_with_article(thread[1])}"
    if is_tube(assembly, fit):
        return "insert", f"{why}, and the shaft is hollow: an insert or a bushing"
    if fit.interference > PRESS_FIT * fit.radius:
        return "thread", f"{why}: a screw in its thread"
    return "press fit", f"{why}: pressed in"


def _from_overlap(assembly: Assembly, overlap: Overlap) -> Suggestion:
    """The suggested joint for two parts that overlap otherwise than as a shaft in its hole."""
    parts = (assembly.names[overlap.ends[0]], assembly.names[overlap.ends[1]])
    unit = assembly.units
    if overlap.why == SAME_BODY:
        option = f"--without {shell_words(parts[1:])}"
        return Suggestion(parts, "same body", "the same body twice: leave out a copy", option, None)
    why = f"overlap by {overlap.depth:.3g} {unit}"
    if overlap.volume is not None:
        share = overlap.volume / float(assembly.geometry.volume[list(overlap.ends)].min())
        why += f", {100 * share:.2g} % of the smaller"
    short_names = [_short_name(name) for name in parts]
    for kind, pattern in (("insert", INSERT), ("thread", THREADED)):
        for short_name, pair in zip(short_names, (parts, parts[::-1]), strict=True):
            match = pattern.search(short_name)
            if match:
                matched_kind: Kind = "insert" if kind == "insert" else "thread"
                return _fixed_joint(
                    pair, matched_kind, f"{why}, by its name {_with_article(match[1])}"
                )
    if overlap.why == INTERFERE:
        return _fixed_joint(
            parts, "press fit", f"interfere by {overlap.depth:.3g} {unit}: pressed in"
        )
    return _fixed_joint(parts, "overlap", f"{why}: glued or welded, or not modelled exactly")


def _short_name(name: str) -> str:
    """The last component of a part's name, after the last slash."""
    return name.rpartition("/")[2]


def _with_article(word: str) -> str:
    """The word in lower case with "a" or "an" before it."""
    return f"{'an' if word[0].lower() in 'aeiou' else 'a'} {word.lower()}"


def _fixed_joint(parts: tuple[str, str], kind: Kind, why: str) -> Suggestion:
    """The suggestion of a fixed joint between two parts, with its kind and the reason `why`."""
    return Suggestion(
        parts, kind, why, _fasten_option(parts), {"parts": list(parts), "kind": "fixed"}
    )


def _fasten_option(parts: tuple[str, str]) -> str:
    """The command-line option ``--fasten`` for two parts."""
    return f"--fasten {shell_words(parts)}"
