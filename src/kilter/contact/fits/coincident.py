"""Rejection of assemblies in which parts lie in the same place, and so cannot be as drawn.

A pair is rejected if it shares more than half of the volume of its smaller part, and the parts are
neither both held nor fixed to each other. Causes: files in frames of their own, a duplicate body,
variants in a single file, the whole beside its parts, a part modelled without the hole for
another. A screw in a nut that is drawn without its hole shares less.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from kilter.assembly import Assembly
from kilter.contact.contact_set import ContactSet
from kilter.contact.contact_tolerances import COINCIDENT, INSIDE
from kilter.contact.left_out import SAME_BODY, Overlap
from kilter.errors import InputError, shell_words

__all__ = ["coincident", "require_apart"]

MANY = 3
"""Number of such pairs from which the parts of a folder seem to have separate frames."""


def coincident(contacts: ContactSet) -> list[Overlap]:
    """Overlaps of open pairs that fill over half of the smaller part, the largest share first."""
    left_open = {frozenset(pair.parts) for pair in contacts.open_pairs}
    coinciding = [
        overlap
        for overlap in contacts.overlaps
        if (overlap.share or 0.0) > COINCIDENT and frozenset(overlap.parts) in left_open
    ]
    return sorted(coinciding, key=lambda overlap: -(overlap.share or 0.0))


def require_apart(assembly: Assembly, contacts: ContactSet) -> None:
    """Raise an InputError if one part lies on another: more than half of it in the same place.

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
    >>> cubes = [Part("a", Box([1, 1, 1])), Part("b", Box([1, 1, 1]), Pose([0.3, 0, 0]))]
    >>> require_apart(Assembly(cubes), contacts(Assembly(cubes)))
    Traceback (most recent call last):
    ...
    kilter.errors.InputError: 'a' and 'b' share 70 % of 'b': ...
    """
    contacts = contacts.of(assembly)
    overlaps = coincident(contacts)
    if not overlaps:
        return
    more = f", and {len(overlaps) - 1} more pairs coincide" if len(overlaps) > 2 else ""
    if len(overlaps) == 2:
        more = f", and {_describe(contacts, overlaps[1])}"
    reason, hint, option = _cause_and_remedy(contacts, overlaps)
    raise InputError(
        f"{_describe(contacts, overlaps[0])}{more}: {reason}",
        file=assembly.source or None,
        hint=hint,
        option=option,
    )


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
    a, b = overlap.parts
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


def _cause_and_remedy(contacts: ContactSet, overlaps: Sequence[Overlap]) -> tuple[str, str, str]:
    """Likely cause of parts in the same place, and the remedy: in Python, then as an option."""
    parts = contacts.assembly.parts
    first = overlaps[0]
    larger, smaller = _sort_by_volume(contacts, first)
    names = parts[larger].name, parts[smaller].name
    if any(parts[k].table for k in first.parts):
        how = "give the floor a lower height"
        return "the table is too high", how, f"{how}: --floor HEIGHT, or --floor alone"
    if first.why == SAME_BODY and len(overlaps) < MANY:
        return (
            "a copy or an exploded view, or a file given under two names",
            f"leave a part out with assembly.without({names[1]!r})",
            f"leave a part out with --without {shell_words(names[1:2])}",
        )
    whole = _whole_of(contacts, overlaps)
    if whole is not None:
        name = parts[whole].name
        return (
            f"{name!r} is the whole beside its parts",
            f"leave the whole out with assembly.without({name!r})",
            f"leave the whole out with --without {shell_words((name,))}",
        )
    join = f"kilter.fastened(assembly, [{names!r}])"
    fasten = f"--fasten {shell_words(names[:2])}"
    if len(overlaps) >= MANY and Path(contacts.assembly.source).suffix:
        out = sorted({parts[_sort_by_volume(contacts, pair)[1]].name for pair in overlaps})
        words = " ".join(f"--without {shell_words((name,))}" for name in out)
        return (
            "copies, or variants drawn over each other",
            f"leave the smaller parts out with assembly.without({out!r}); or join with {join}",
            f"leave the smaller parts out with {words}; "
            f"or join parts that are meant to overlap with {fasten} or --fasten-overlaps",
        )
    if len(overlaps) >= MANY:
        place = "export the parts where they are in the assembly, not each in its own frame"
        return (
            "each file seems to be in a frame of its own",
            f"{place}; or join parts that are meant to overlap with {join}",
            f"{place}; or join parts that are meant to overlap with {fasten} or --fasten-overlaps",
        )
    return (
        "misplaced, or drawn without the hole for the other",
        f"correct the model; or join parts that are meant to overlap with {join}",
        f"correct the model; or join parts that are meant to overlap with {fasten}",
    )
