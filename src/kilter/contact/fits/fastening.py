"""Fastening: fixed joints between all parts of two names that touch."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from kilter.assembly import Assembly, Joint
from kilter.contact import detect
from kilter.contact.contact_set import ContactSet
from kilter.contact.gaps import Tolerance
from kilter.errors import InputError, some_names

__all__ = ["fastened", "touching_pairs"]


def fastened(
    assembly: Assembly,
    pairs: Iterable[Sequence[str]],
    *,
    contacts: ContactSet | None = None,
    tolerance: Tolerance | None = None,
) -> Assembly:
    """The assembly with fixed joints between every two matching parts that touch.

    Parameters
    ----------
    assembly : Assembly
    pairs : iterable of pairs of str
        Names or globs (``*`` and ``?``): every part of the first is fastened to every part
        of the second that it touches.
    contacts : ContactSet, optional
        Of the assembly; found from its geometry where not given.
    tolerance : Tolerance, optional
        When faces count as touching.

    Raises
    ------
    InputError
        If a glob matches no part, or no two parts of a pair touch.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> joined = fastened(scene("tower"), [("cube-1", "cube-*")])
    >>> [joint.parts for joint in joined.joints]
    [('cube-1', 'cube-2')]
    """
    wanted = [tuple(pair) for pair in pairs]
    if any(len(pair) != 2 for pair in wanted):
        raise InputError("something to fasten is not two names", hint="give pairs of names")
    if not wanted:
        return assembly
    chosen = [tuple(assembly.matching([pattern]) for pattern in pair) for pair in wanted]
    if contacts is None:
        contacts = detect.contacts(assembly, tolerance=tolerance)
    touching = [tuple(assembly.names[k] for k in pair) for pair in touching_pairs(contacts)]
    there = {frozenset(joint.parts) for joint in assembly.joints if joint.kind == "fixed"}
    joints = []
    for pair, (first, second) in zip(wanted, chosen, strict=True):
        matching = [
            (a, b) for x, y in touching for a, b in ((x, y), (y, x)) if a in first and b in second
        ]
        if not matching:
            raise _nothing_touches(assembly, contacts, pair, first, second)
        for a, b in matching:
            if frozenset((a, b)) not in there:
                there.add(frozenset((a, b)))
                joints.append(Joint((a, b)))
    return assembly.with_joints(joints)


def touching_pairs(contacts: ContactSet) -> list[tuple[int, int]]:
    """Pairs of parts that touch in any way, overlaps included, in order."""
    pairs = [(int(a), int(b)) for a, b in contacts.patch_parts]
    pairs += [entry.parts for entry in contacts.unsupported]
    pairs += [entry.parts for entry in contacts.overlaps]
    return sorted({(min(pair), max(pair)) for pair in pairs})


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
