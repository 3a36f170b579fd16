"""Fastening: fixed joints between parts that touch, by their names or as they look.

By name: every two matching parts that touch. As suggested: the pairs that
`kilter.contact.fits.suggestions` takes for fixed. As they overlap: every pair that shares
volume, but for the same body twice. What was not named pair by pair is told with its reason:
`Joint.why`, and a note of the assembly.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from kilter.assembly import Assembly, Bond, Joint
from kilter.contact import detect
from kilter.contact.contact_set import ContactSet
from kilter.contact.fits.suggestions import Suggestion, suggest_joints, touching_pairs
from kilter.contact.gaps import Tolerance
from kilter.errors import InputError, some, some_names
from kilter.files.reading import Reading

__all__ = ["fasten_as_read", "fastened"]

Pair = tuple[str, ...]
TOLD = 20
"""Pairs that a note names; the joints of an answer list all."""


def fastened(
    assembly: Assembly,
    pairs: Iterable[Sequence[str]] = (),
    *,
    suggested: bool = False,
    overlaps: bool = False,
    contacts: ContactSet | None = None,
    tolerance: Tolerance | None = None,
) -> Assembly:
    """The assembly with fixed joints between parts that touch.

    Parameters
    ----------
    assembly : Assembly
    pairs : iterable of pairs of str
        Names or globs (``*`` and ``?``): every part of the first is fastened to every part
        of the second that it touches. A held part is meant only where it is named in full:
        globs do not match it.
    suggested : bool
        Fasten what looks fastened: threads, press fits, inserts, and what else overlaps.
    overlaps : bool
        Fasten every pair that overlaps.
    contacts : ContactSet, optional
        Of the assembly; found from its geometry where not given.
    tolerance : Tolerance, optional
        When faces count as touching.

    Returns
    -------
    Assembly
        Its notes name what `suggested` and `overlaps` joined, or that there was nothing.

    Raises
    ------
    InputError
        If a glob matches no part that is free, or no two parts of a pair touch.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> joined = fastened(scene("tower"), [("cube-1", "cube-*")])
    >>> [joint.parts for joint in joined.joints]
    [('cube-1', 'cube-2')]
    >>> fastened(scene("tower"), suggested=True).notes[-1]
    'nothing is fastened as suggested: no pair looks as if it were'
    """
    wanted = [tuple(pair) for pair in pairs]
    if any(len(pair) != 2 for pair in wanted):
        raise InputError("something to fasten is not two names", hint="give pairs of names")
    if not (wanted or suggested or overlaps):
        return assembly
    chosen = [tuple(_chosen(assembly, pattern) for pattern in pair) for pair in wanted]
    if contacts is None:
        contacts = detect.contacts(assembly, tolerance=tolerance)
    named = _named(assembly, contacts, wanted, chosen)
    assembly = assembly.with_joints(named, notes=_left_held(assembly, contacts, wanted, chosen))
    if not (suggested or overlaps):
        return assembly
    listed = [one for one in suggest_joints(assembly, contacts) if one.fixed]
    if suggested:
        how = "as suggested", "no pair looks as if it were"
        assembly = assembly.with_joints(_joints(listed), notes=[_told(listed, *how)])
    if overlaps:
        over = {frozenset(contacts.assembly.names[k] for k in o.parts) for o in contacts.overlaps}
        listed = [one for one in listed if frozenset(one.parts) in over]
        how = "as they overlap", "no pair overlaps that is free to be joined"
        joints = [] if suggested else _joints(listed)
        assembly = assembly.with_joints(joints, notes=[_told(listed, *how)])
    return assembly


def fasten_as_read(
    assembly: Assembly,
    reading: Reading,
    *,
    tolerance: Tolerance | None = None,
    progress: Callable[[str], None] | None = None,
) -> tuple[Assembly, ContactSet | None]:
    """The assembly with what its reading joins, and its contacts where that asked for them."""
    if not reading.fastens:
        return assembly, None
    contacts = detect.contacts(assembly, tolerance=tolerance, progress=progress)
    bonded = assembly.with_bonds(_bonds(assembly, contacts, reading.bond))
    joined = fastened(
        bonded,
        reading.fasten,
        suggested=reading.fasten_suggested,
        overlaps=reading.fasten_overlaps,
        contacts=contacts,
    )
    return joined, contacts.of(joined)


def _bonds(
    assembly: Assembly, contacts: ContactSet, wanted: Sequence[tuple[str, str, float]]
) -> list[Bond]:
    """Bonds of every two parts that touch, one of each side of a pair; the last word counts."""
    found: dict[frozenset[str], Bond] = {}
    for one, other, pull in wanted:
        first, second = _chosen(assembly, one), _chosen(assembly, other)
        pairs = _matching(assembly, contacts, (one, other), first, second)
        found |= {frozenset(pair): Bond((pair[0], pair[1]), pull=pull) for pair in pairs}
    return list(found.values())


def _matching(
    assembly: Assembly,
    contacts: ContactSet,
    pair: Sequence[str],
    first: set[str],
    second: set[str],
) -> list[Pair]:
    """Every two parts that touch, one of each set; the names of the sets are for the message."""
    matching: list[Pair] = [
        (a, b)
        for x, y in _touching(assembly, contacts)
        for a, b in ((x, y), (y, x))
        if a in first and b in second
    ]
    if not matching:
        raise _nothing_touches(assembly, contacts, pair, first, second)
    return matching


def _chosen(assembly: Assembly, pattern: str) -> set[str]:
    """Names that a pattern means: held parts only where it is their name."""
    found = assembly.matching([pattern])
    free = {name for name in found if name == pattern or not assembly[name].grounded}
    if not free:
        raise InputError(
            f"{pattern!r} matches held parts alone: {some_names(sorted(found), 3)}",
            file=assembly.source or None,
            hint="name a held part in full to fasten something to it",
        )
    return free


def _touching(assembly: Assembly, contacts: ContactSet) -> list[Pair]:
    return [tuple(assembly.names[k] for k in pair) for pair in touching_pairs(contacts)]


def _named(
    assembly: Assembly,
    contacts: ContactSet,
    wanted: Sequence[Pair],
    chosen: Sequence[Sequence[set[str]]],
) -> list[Joint]:
    """Joints of every two parts that touch, one of each side of a pair."""
    there = {frozenset(joint.parts) for joint in assembly.joints if joint.kind == "fixed"}
    joints = []
    for pair, (first, second) in zip(wanted, chosen, strict=True):
        for a, b in _matching(assembly, contacts, pair, first, second):
            if frozenset((a, b)) not in there:
                there.add(frozenset((a, b)))
                joints.append(Joint((a, b)))
    return joints


def _left_held(
    assembly: Assembly,
    contacts: ContactSet,
    wanted: Sequence[Pair],
    chosen: Sequence[Sequence[set[str]]],
) -> list[str]:
    """Which held parts globs passed by although something that they match touches them."""
    left: set[str] = set()
    touching = _touching(assembly, contacts)
    for (one, other), (mine, theirs) in zip(wanted, chosen, strict=True):
        for pattern, meant, beside in ((one, mine, theirs), (other, theirs, mine)):
            passed = assembly.matching([pattern]) - meant
            pairs = [(a, b) for x, y in touching for a, b in ((x, y), (y, x))]
            left |= {a for a, b in pairs if a in passed and b in beside}
    left -= {part.name for part in assembly if part.table}
    if not left:
        return []
    return [
        f"globs match no held part: nothing is fastened to {some_names(sorted(left))}; "
        "name it in full where it should be"
    ]


def _joints(suggestions: Sequence[Suggestion]) -> list[Joint]:
    return [Joint(one.parts, why=one.kind) for one in suggestions]


def _told(suggestions: Sequence[Suggestion], how: str, nothing: str) -> str:
    """A note that names what was joined."""
    if not suggestions:
        return f"nothing is fastened {how}: {nothing}"
    pairs = [f"{one.parts[0]!r} and {one.parts[1]!r} ({one.kind})" for one in suggestions]
    many = "1 pair" if len(pairs) == 1 else f"{len(pairs)} pairs"
    return f"fastened {how}, {many}: {some(pairs, TOLD)}"


def _nothing_touches(
    assembly: Assembly,
    contacts: ContactSet,
    pair: Sequence[str],
    first: set[str],
    second: set[str],
) -> InputError:
    """Why nothing is fastened: how near they come."""
    names = assembly.names
    near = ""
    for rejected in contacts.rejected:
        a, b = (names[k] for k in rejected.parts)
        if (a in first and b in second) or (b in first and a in second):
            near = f": {a!r} and {b!r} come within {abs(rejected.gap):.3g} {assembly.units}"
            break
    left, right = (some_names(sorted(chosen), 3) for chosen in (first, second))
    return InputError(
        f"nothing to fasten with {pair[0]!r} {pair[1]!r}: of {left} none touches any of "
        f"{right}{near}",
        file=assembly.source or None,
        hint="give a tolerance of more gap or clearance, or list a joint in the assembly"
        if near
        else "see kilter.contacts for what touches, or list a joint in the assembly",
        option="set --gap or --clearance, or list a joint in the file"
        if near
        else "see 'kilter contacts' for what touches, or list a joint in the file",
    )
