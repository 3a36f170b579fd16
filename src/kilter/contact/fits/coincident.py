"""Parts that lie in the same place, and so cannot be as drawn: their likely cause and a remedy.

Two parts coincide if they share more than half of the volume of the smaller part, and are neither
both held nor fixed to each other. A screw in a nut that is drawn without its hole shares less. The
causes:

    the same body twice, variants in a single file, the whole beside its parts
        the answer has a warning, and leaving parts out is tried as a remedy
    a part modelled without the hole for another, a misplaced part
        the answer has a warning, and joining the parts is tried as a remedy
    files in frames of their own, a table above the lowest part
        the assembly is rejected, since all of its contacts are wrong
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from kilter.assembly import Assembly
from kilter.contact.contact_set import ContactSet
from kilter.contact.contact_tolerances import COINCIDENT, INSIDE
from kilter.contact.left_out import SAME_BODY, Overlap
from kilter.errors import InputError, shell_words

__all__ = ["coincident", "coincident_remarks", "parts_to_leave_out", "require_apart"]

MANY = 3
"""Number of such pairs from which the parts of a folder seem to have separate frames."""

SHARE_DIGITS = 6
"""Digits to which shares are compared: the volume of an intersection has a rounding error."""


def coincident(contacts: ContactSet) -> list[Overlap]:
    """Overlaps of open pairs that fill over half of the smaller part, the largest share first."""
    left_open = {frozenset(pair.ends) for pair in contacts.open_pairs}
    coinciding = [
        overlap
        for overlap in contacts.overlaps
        if (overlap.share or 0.0) > COINCIDENT and frozenset(overlap.ends) in left_open
    ]
    parts = contacts.assembly.parts

    def rank(overlap: Overlap) -> tuple[float, bool, bool]:
        """The largest share first; of equal shares the table, then the same body twice."""
        share = round(min(overlap.share or 0.0, 1.0), SHARE_DIGITS)
        return -share, not any(parts[k].table for k in overlap.ends), overlap.why != SAME_BODY

    return sorted(coinciding, key=rank)


def require_apart(assembly: Assembly, contacts: ContactSet) -> None:
    """Raise an InputError if parts lie on each other because all contacts are wrong.

    Raises
    ------
    InputError
        With the pairs, the likely cause, and a remedy.

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


def parts_to_leave_out(contacts: ContactSet) -> tuple[str, ...]:
    """Names of the copies, variants or wholes that lie on other parts; empty for other causes."""
    overlaps = coincident(contacts)
    return _cause_and_remedy(contacts, overlaps).leave_out if overlaps else ()


def _pairs_in_words(contacts: ContactSet, overlaps: Sequence[Overlap]) -> str:
    """Describe the first coincident pair, and the second pair or the number of further pairs."""
    more = f", and {len(overlaps) - 1} more pairs coincide" if len(overlaps) > 2 else ""
    if len(overlaps) == 2:
        more = f", and {_describe(contacts, overlaps[1])}"
    return f"{_describe(contacts, overlaps[0])}{more}"


@dataclass(frozen=True, slots=True)
class _Cause:
    """Likely cause of parts in the same place: its remedy in Python (`hint`) and as an option.

    `leave_out`: the parts that the remedy leaves out. `rejects`: whether no answer is possible.
    """

    reason: str
    hint: str
    option: str
    leave_out: tuple[str, ...] = ()
    rejects: bool = False


def _describe(contacts: ContactSet, overlap: Overlap) -> str:
    """Describe in words how two parts occupy the same place; the smaller part comes second."""
    larger, smaller = (repr(contacts.assembly.names[k]) for k in _sort_by_volume(contacts, overlap))
    if overlap.why == SAME_BODY:
        return f"{larger} and {smaller} are the same body twice"
    if (overlap.share or 0.0) > INSIDE:
        return f"{smaller} lies inside {larger}"
    return f"{larger} and {smaller} share {100 * (overlap.share or 0.0):.2g} % of {smaller}"


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
        copy = _copies(contacts, overlaps[:1])
        return _Cause(
            "a copy or an exploded view, or a file given under two names",
            f"leave a part out with assembly.without({copy[0]!r})",
            f"leave a part out with --without {shell_words(copy)}",
            _copies(contacts, overlaps),
        )
    whole = _whole_of(contacts, overlaps)
    if whole is not None:
        name = parts[whole].name
        return _Cause(
            f"{name!r} is the whole beside its parts",
            f"leave the whole out with assembly.without({name!r})",
            f"leave the whole out with --without {shell_words((name,))}",
            (name,),
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
            tuple(out),
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


def _copies(contacts: ContactSet, overlaps: Sequence[Overlap]) -> tuple[str, ...]:
    """Names of the second body of each pair that is the same body twice, without a held body."""
    parts = contacts.assembly.parts
    names = []
    for overlap in overlaps:
        larger, smaller = _sort_by_volume(contacts, overlap)
        if overlap.why == SAME_BODY:
            extra = larger if parts[smaller].grounded else smaller
            names.append(parts[extra].name)
    return tuple(sorted(set(names)))
