"""Parts that lie on one another: no verdict is given, since they cannot be as they are drawn.

Refused is a pair, not held on both sides nor fixed to each other, that shares more than half
of the volume of its smaller part: files that are each in a frame of their own, a body that is
there twice, a part modelled without the hole for another. A screw in a nut that is drawn
without its hole shares less.
"""

from __future__ import annotations

from collections.abc import Sequence

from kilter.assembly import Assembly
from kilter.contact.contact_set import ContactSet
from kilter.contact.contact_tolerances import COINCIDENT, INSIDE
from kilter.contact.left_out import SAME_BODY, Overlap
from kilter.errors import InputError, shell_words

__all__ = ["coincident", "require_apart"]

MANY = 3
"""Pairs from which on the files are taken to be in frames of their own."""


def coincident(contacts: ContactSet) -> list[Overlap]:
    """Overlaps of more than half of the smaller part that nothing joins, the greatest first."""
    left_open = {frozenset(one.parts) for one in contacts.open_pairs}
    found = [
        one
        for one in contacts.overlaps
        if (one.share or 0.0) > COINCIDENT and frozenset(one.parts) in left_open
    ]
    return sorted(found, key=lambda one: -(one.share or 0.0))


def require_apart(assembly: Assembly, contacts: ContactSet) -> None:
    """Refuse parts that lie on one another.

    Raises
    ------
    InputError
        Naming the pairs, the likely reason, and what to do.

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
    found = coincident(contacts)
    if not found:
        return
    more = f", and {len(found) - 1} more pairs lie on one another" if len(found) > 2 else ""
    if len(found) == 2:
        more = f", and {_shared(contacts, found[1])}"
    reason, hint, option = _likely(contacts, found)
    raise InputError(
        f"{_shared(contacts, found[0])}{more}: {reason}",
        file=assembly.source or None,
        hint=hint,
        option=option,
    )


def _shared(contacts: ContactSet, one: Overlap) -> str:
    """How two parts lie on one another; the smaller is the second."""
    larger, smaller = (repr(contacts.assembly.names[k]) for k in _by_volume(contacts, one))
    if one.why == SAME_BODY:
        return f"{larger} and {smaller} are the same body twice"
    if (one.share or 0.0) > INSIDE:
        return f"{smaller} lies inside {larger}"
    return f"{larger} and {smaller} share {100 * (one.share or 0.0):.2g} % of {smaller}"


def _by_volume(contacts: ContactSet, one: Overlap) -> tuple[int, int]:
    """The parts of an overlap, the larger first."""
    a, b = one.parts
    volume = contacts.assembly.geometry.volume
    return (a, b) if volume[a] >= volume[b] else (b, a)


def _likely(contacts: ContactSet, found: Sequence[Overlap]) -> tuple[str, str, str]:
    """Why they lie on one another, and what to do, in Python and as an option."""
    parts = contacts.assembly.parts
    first = found[0]
    larger, smaller = _by_volume(contacts, first)
    names = parts[larger].name, parts[smaller].name
    if any(parts[k].table for k in first.parts):
        how = "give the floor a lower height"
        return "the table is too high", how, f"{how}: --floor HEIGHT, or --floor alone"
    if first.why == SAME_BODY and len(found) < MANY:
        return (
            "a copy or an exploded view, or one file given under two names",
            f"leave one out with assembly.without({names[1]!r})",
            f"leave one out with --without {shell_words(names[1:2])}",
        )
    join = f"kilter.fastened(assembly, [{names!r}])"
    fasten = f"--fasten {shell_words(names[:2])}"
    if len(found) >= MANY:
        place = "export the parts where they are in the assembly, not each in its own frame"
        return (
            "each file seems to be in a frame of its own",
            f"{place}; or join what is meant so with {join}",
            f"{place}; or join what is meant so with {fasten} or --fasten-overlaps",
        )
    return (
        "misplaced, or drawn without the hole for the other",
        f"mend that where it was made; or join what is meant so with {join}",
        f"mend that where it was made; or join what is meant so with {fasten}",
    )
