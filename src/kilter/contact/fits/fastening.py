"""Fastening: fixed joints between parts that touch, by their names or by suggestion.

By name: every two matching parts that touch. As suggested: the pairs that
`kilter.contact.fits.suggestions` takes for fixed. As they overlap: every pair that shares volume,
except the same body twice. Joints that were not named pair by pair state their reason: `Joint.why`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from kilter.assembly import Assembly, Bond, GivenContact, Joint
from kilter.assembly.changed_copies import with_fields
from kilter.contact import detect
from kilter.contact.common.gaps import Tolerance
from kilter.contact.contact_set import ContactSet
from kilter.contact.contact_tolerances import DECIDED, LOOKED_AT_ANGLE, LOOSE_ANGLE
from kilter.contact.fits.suggestions import Suggestion, suggest_joints, touching_pairs
from kilter.errors import InputError, some_names
from kilter.files.reading import Reading
from kilter.values.guesses import guarded

# Decisions of a user about pairs of parts: joined, touching or apart.


def with_decided_pairs(
    assembly: Assembly,
    decisions: Iterable[Mapping[str, Any]],
    *,
    tolerance: Tolerance | None = None,
) -> Assembly:
    """The assembly with the user's decisions on pairs of parts: joined, touching or apart.

    Raises `InputError` if a part does not exist, or no faces of a pair that is said to touch come
    near.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> tower = scene("tower")
    >>> apart = with_decided_pairs(tower, [{"parts": ["cube-1", "cube-2"], "as": "apart"}])
    >>> len(detect.contacts(tower)) - len(detect.contacts(apart))
    1
    """
    tolerance = tolerance or assembly.tolerance or Tolerance()
    joints: list[Joint] = []
    contacts: list[GivenContact] = []
    for decision in decisions:
        first, second = decision["parts"]
        assembly.index_of(first), assembly.index_of(second)
        if decision["as"] == "joined":
            joints.append(Joint((first, second)))
        elif decision["as"] == "apart":
            contacts.append(GivenContact((first, second), [], [0, 0, 1]))
        else:
            contacts += _touching(assembly, (first, second), tolerance)
    decided = {frozenset(contact.parts) for contact in contacts}
    others = [c for c in assembly.contacts if frozenset(c.parts) not in decided]
    return with_fields(assembly, joints=[*assembly.joints, *joints], contacts=[*others, *contacts])


def _touching(
    assembly: Assembly, pair: tuple[str, str], tolerance: Tolerance
) -> list[GivenContact]:
    """Contacts between the nearest faces of two parts; empty if detection finds some already."""
    free = [replace(assembly[name], grounded=False) for name in pair]
    two = Assembly(free, units=assembly.units, gravity=assembly.gravity)
    if len(detect.contacts(two, tolerance=tolerance)):
        return []
    for gap, angle in _nearest(detect.contacts(two, tolerance=Tolerance.loose())):
        wide = replace(
            tolerance, gap=gap * DECIDED, clearance=gap * DECIDED, angle=max(tolerance.angle, angle)
        )
        contacts = detect.contacts(two, tolerance=wide)
        if len(contacts):
            return _given(contacts)
    raise InputError(
        f"no faces of {pair[0]!r} and {pair[1]!r} come near enough to touch",
        file=assembly.source or None,
        hint="decide that the pair is joined or apart",
    )


def _nearest(contacts: ContactSet) -> list[tuple[float, float]]:
    """Gaps [length unit] and angles [rad] between near faces of two parts, the closest first."""
    touching = [(float(np.abs(gap).max()), LOOSE_ANGLE) for gap in contacts.patch_gap]
    near = [(abs(pair.gap), min(pair.angle * DECIDED, LOOKED_AT_ANGLE)) for pair in contacts.near]
    deep = [(o.depth, 0.0) for o in contacts.overlaps if o.depth is not None]
    return [(gap, angle) for gap, angle in [*touching, *near, *deep] if gap > 0]


def _given(contacts: ContactSet) -> list[GivenContact]:
    """Convert detected patches to given contacts; a curved patch gives one for each point."""
    names, given = contacts.assembly.names, []
    for k, (low, high) in enumerate(
        zip(contacts.patch_start[:-1].tolist(), contacts.patch_start[1:].tolist(), strict=True)
    ):
        parts = (names[contacts.patch_parts[k, 0]], names[contacts.patch_parts[k, 1]])
        points, normals = contacts.points[low:high], contacts.normals[low:high]
        if np.ptp(normals, axis=0).any():
            given += [GivenContact(parts, x[None], n) for x, n in zip(points, normals, strict=True)]
        else:
            given.append(GivenContact(parts, points, normals[0]))
    return given


Pair = tuple[str, ...]


@guarded
def fastened(
    assembly: Assembly,
    pairs: Iterable[Sequence[str]] = (),
    *,
    suggested: bool = False,
    overlaps: bool = False,
    contacts: ContactSet | None = None,
    tolerance: Tolerance | None = None,
) -> Assembly:
    """The assembly with additional fixed joints between touching parts, by name or suggestion.

    Parameters
    ----------
    assembly : Assembly
    pairs : iterable of pairs of str
        Names or globs (``*`` and ``?``): every part of the first is fastened to every part of the
        second that it touches. Globs do not match held parts: name a held part in full.
    suggested : bool
        Fasten the pairs that look fastened: threads, press fits, inserts and other overlaps.
    overlaps : bool
        Fasten every pair that overlaps.
    contacts : ContactSet, optional
        Contacts of the assembly; by default computed from its geometry.
    tolerance : Tolerance, optional
        Largest gap and angle at which faces count as touching.

    Returns
    -------
    Assembly
        Its notes state if `suggested` or `overlaps` joined no pair.

    Raises
    ------
    InputError
        If a glob matches no free part, or no two parts of a pair touch.

    See Also
    --------
    kilter.contacts : lists the touching pairs and the suggestions.
    kilter.hold : the fewest supports from outside.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> joined = fastened(scene("tower"), [("cube-1", "cube-*")])
    >>> [joint.parts for joint in joined.joints]
    [('cube-1', 'cube-2')]
    >>> fastened(scene("tower"), suggested=True).notes[-1]
    'nothing is fastened as suggested: no pair looks fastened'
    """
    patterns = [tuple(pair) for pair in pairs]
    if any(len(pair) != 2 for pair in patterns):
        raise InputError(
            "an entry of the pairs to fasten does not have two names", hint="give pairs of names"
        )
    if not (patterns or suggested or overlaps):
        return assembly
    matched = [tuple(_parts_matching(assembly, pattern) for pattern in pair) for pair in patterns]
    if contacts is None:
        contacts = detect.contacts(assembly, tolerance=tolerance)
    joints_by_name = _joints_by_name(assembly, contacts, patterns, matched)
    assembly = assembly.with_joints(
        joints_by_name, notes=_skipped_held_notes(assembly, contacts, patterns, matched)
    )
    if not (suggested or overlaps):
        return assembly
    return _fasten_found(assembly, contacts, suggested=suggested, overlaps=overlaps)


def _fasten_found(
    assembly: Assembly, contacts: ContactSet, *, suggested: bool, overlaps: bool
) -> Assembly:
    """Join suggested or overlapping pairs by fixed joints; add a note if there are none."""
    suggestions = [s for s in suggest_joints(assembly, contacts) if s.fixed]
    if suggested:
        how = "as suggested", "no pair looks fastened"
        assembly = assembly.with_joints(
            _suggested_joints(suggestions), notes=_nothing_fastened(suggestions, *how)
        )
    if overlaps:
        overlapping = {
            frozenset(contacts.assembly.names[k] for k in o.ends) for o in contacts.overlaps
        }
        suggestions = [s for s in suggestions if frozenset(s.parts) in overlapping]
        how = "as they overlap", "no overlapping pair can be joined"
        joints = [] if suggested else _suggested_joints(suggestions)
        assembly = assembly.with_joints(joints, notes=_nothing_fastened(suggestions, *how))
    return assembly


def fasten_as_read(
    assembly: Assembly,
    reading: Reading,
    *,
    tolerance: Tolerance | None = None,
    find: Callable[[Assembly], ContactSet] | None = None,
    progress: Callable[[str], None] | None = None,
) -> tuple[Assembly, ContactSet | None]:
    """The assembly with the joints and bonds of the reading options, and the contacts if found.

    The contacts are returned too if they had to be detected, else None. `find` replaces the
    detection, for a caller that keeps the contacts of earlier assemblies.
    """
    if not reading.fastens:
        return assembly, None
    reading, _ = reading.for_parts(assembly.names)
    assembly = with_decided_pairs(
        assembly, reading.entries.get("open_pairs", ()), tolerance=tolerance
    )
    contacts = (
        detect.contacts(assembly, tolerance=tolerance, progress=progress)
        if find is None
        else find(assembly)
    )
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
    assembly: Assembly, contacts: ContactSet, patterns: Sequence[tuple[str, str, float]]
) -> list[Bond]:
    """Bonds between touching parts whose names match a pair of patterns.

    If patterns match the same parts twice, the last bond counts.
    """
    bonds: dict[frozenset[str], Bond] = {}
    for pattern_a, pattern_b, pull in patterns:
        first, second = _parts_matching(assembly, pattern_a), _parts_matching(assembly, pattern_b)
        pairs = _touching_matches(assembly, contacts, (pattern_a, pattern_b), first, second)
        bonds |= {frozenset(pair): Bond((pair[0], pair[1]), pull=pull) for pair in pairs}
    return list(bonds.values())


def _touching_matches(
    assembly: Assembly,
    contacts: ContactSet,
    pair: Sequence[str],
    first: set[str],
    second: set[str],
) -> list[Pair]:
    """Touching pairs of a part in `first` and a part in `second`; raises an error if none touch."""
    matching: list[Pair] = [
        (a, b)
        for x, y in _touching_names(assembly, contacts)
        for a, b in ((x, y), (y, x))
        if a in first and b in second
    ]
    if not matching and tuple(pair) in _pairs_with_play(assembly, contacts):
        return [tuple(pair)]
    if not matching:
        raise _no_contact_error(assembly, contacts, pair, first, second)
    return matching


def _pairs_with_play(assembly: Assembly, contacts: ContactSet) -> set[Pair]:
    """Names, in both orders, of parts that do not touch as drawn, so only full names join them.

    They are shafts in holes with clearance (threads drawn with their play), and parts that touch
    nothing but are nearer to another part than the gap tolerance: they overlap by less, as an
    O-ring does, and the overlapping faces are not parallel.
    """
    nearest = contacts.neighbours
    size = assembly.geometry.size
    smaller = np.minimum(size[[n.part for n in nearest]], size[[n.other for n in nearest]])
    gap = contacts.searched.gap_of(smaller)
    pairs = [pair.ends for pair in contacts.open_pairs if pair.kind == "clearance"]
    pairs += [(n.part, n.other) for n, most in zip(nearest, gap, strict=True) if n.gap <= most]
    names = {(assembly.names[a], assembly.names[b]) for a, b in pairs}
    return {*names, *(pair[::-1] for pair in names)}


def _parts_matching(assembly: Assembly, pattern: str) -> set[str]:
    """Names of parts that a pattern matches; held parts only if the pattern is their full name."""
    names = assembly.matching([pattern])
    free = {name for name in names if name == pattern or not assembly[name].grounded}
    if not free:
        raise InputError(
            f"{pattern!r} matches only held parts: {some_names(sorted(names), 3)}",
            file=assembly.source or None,
            hint="name a held part in full to fasten something to it",
        )
    return free


def _touching_names(assembly: Assembly, contacts: ContactSet) -> list[Pair]:
    """Pairs of touching parts, by name."""
    return [tuple(assembly.names[k] for k in pair) for pair in touching_pairs(contacts)]


def _joints_by_name(
    assembly: Assembly,
    contacts: ContactSet,
    patterns: Sequence[Pair],
    matched: Sequence[Sequence[set[str]]],
) -> list[Joint]:
    """Fixed joints between touching parts that match a pair of patterns and have no joint yet."""
    joined = {frozenset(joint.parts) for joint in assembly.joints if joint.kind == "fixed"}
    joints = []
    for pair, (first, second) in zip(patterns, matched, strict=True):
        for a, b in _touching_matches(assembly, contacts, pair, first, second):
            if frozenset((a, b)) not in joined:
                joined.add(frozenset((a, b)))
                joints.append(Joint((a, b)))
    return joints


def _skipped_held_notes(
    assembly: Assembly,
    contacts: ContactSet,
    patterns: Sequence[Pair],
    matched: Sequence[Sequence[set[str]]],
) -> list[str]:
    """A note on held parts that wildcards did not join although a matching part touches them."""
    skipped_parts: set[str] = set()
    touching = _touching_names(assembly, contacts)
    for (pattern_a, pattern_b), (parts_a, parts_b) in zip(patterns, matched, strict=True):
        for pattern, chosen_parts, partners in (
            (pattern_a, parts_a, parts_b),
            (pattern_b, parts_b, parts_a),
        ):
            skipped = assembly.matching([pattern]) - chosen_parts
            pairs = [(a, b) for x, y in touching for a, b in ((x, y), (y, x))]
            skipped_parts |= {a for a, b in pairs if a in skipped and b in partners}
    skipped_parts -= {part.name for part in assembly if part.table}
    if not skipped_parts:
        return []
    return [
        "wildcards match no held part: "
        f"nothing is fastened to {some_names(sorted(skipped_parts))}; "
        "name it in full where it should be"
    ]


def _suggested_joints(suggestions: Sequence[Suggestion]) -> list[Joint]:
    """A fixed joint for each suggestion, with the kind of fastening as its reason."""
    return [Joint(s.parts, why=s.kind) for s in suggestions]


def _nothing_fastened(suggestions: Sequence[Suggestion], how: str, nothing: str) -> list[str]:
    """A note that an option joins no pair, with the reason `nothing`; empty if it joins some.

    Joined pairs need no note, since the user requested them: the joints of the answer name them.
    """
    return [] if suggestions else [f"nothing is fastened {how}: {nothing}"]


def _no_contact_error(
    assembly: Assembly,
    contacts: ContactSet,
    pair: Sequence[str],
    first: set[str],
    second: set[str],
) -> InputError:
    """Build the error for patterns whose parts do not touch; it states their least distance."""
    names = assembly.names
    near = ""
    for rejected in contacts.near:
        a, b = (names[k] for k in rejected.ends)
        if (a in first and b in second) or (b in first and a in second):
            near = f": {a!r} and {b!r} come within {abs(rejected.gap):.3g} {assembly.units}"
            break
    left, right = (some_names(sorted(names_of_set), 3) for names_of_set in (first, second))
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
