"""Warnings in an answer about the input, parts that touch nothing, and missing free parts."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from kilter.arrays import connected
from kilter.assembly import Assembly
from kilter.contact import ContactSet
from kilter.contact.common.distances import nearest_parts
from kilter.contact.fits.suggestions import coincident_remarks
from kilter.tell.contact_words import group_warnings, lone_warnings
from kilter.tell.numbers import rounded_up


def remarks(assembly: Assembly, contacts: ContactSet) -> list[str]:
    """Warnings about file, geometry and contacts; a further warning if no part is free."""
    contacts = contacts.of(assembly)
    texts = [*contacts.warnings, *coincident_remarks(contacts)]
    if assembly.geometry.grounded.all():
        texts.append("every part is held: nothing can move")
    return texts


def gaps_under_straps(assembly: Assembly, contacts: ContactSet) -> list[str]:
    """Warnings about gaps between parts that a strap pulls together, each with its width."""
    index, touching = assembly.index, {frozenset(pair) for pair in contacts.adjacent.tolist()}
    texts = []
    for number, strap in enumerate(assembly.straps, start=1):
        for a, b in pairwise(strap.parts):
            pair = frozenset((index.get(a, -1), index.get(b, -1)))
            if len(pair) < 2 or -1 in pair or pair in touching:
                continue
            both = Assembly([assembly[a], assembly[b]], units=assembly.units)
            for near in nearest_parts(both.geometry, [0]):
                gap = rounded_up(near.gap, 3)
                texts.append(
                    f"strap {number} pulls {a!r} and {b!r} together, which do not touch: the gap "
                    f"between them is {gap} {assembly.units} (--clearance {gap} counts it as "
                    "closed)"
                )
    return list(dict.fromkeys(texts))


def loose_parts(assembly: Assembly, contacts: ContactSet) -> list[str]:
    """Warnings about parts and groups that touch no other part, with their nearest parts."""
    if assembly.geometry.grounded.all():
        return []  # contacts between held parts are not detected, so nothing is known to be alone
    nearest = contacts.of(assembly).nearest
    warnings = []
    if nearest:
        warnings += lone_warnings([entry.to_dict() for entry in nearest], assembly.units)
    groups = floating_groups(assembly, contacts)
    return warnings + group_warnings(groups) if groups else warnings


def floating_groups(assembly: Assembly, contacts: ContactSet) -> list[list[str]]:
    """Names of the parts in each group that touches no other part and has no held part.

    Contacts, open pairs, joints or bonds connect the parts of a group. A single part is not a
    group.
    """
    named = [joint.parts for joint in assembly.joints] + [bond.parts for bond in assembly.bonds]
    index = assembly.index
    linked = [[index[a], index[b]] for a, b in named if a in index and b in index]
    links = np.array(linked, dtype=np.int64).reshape(-1, 2)
    first, second = np.concatenate([contacts.adjacent, links]).T
    count = len(assembly.parts)
    # the ground has index -1; the modulus maps it to a further node, which is held
    label = connected(count + 1, first % (count + 1), second % (count + 1))
    held = np.append(assembly.geometry.grounded, True)
    floats = ~np.isin(label, label[held])
    groups = [np.flatnonzero(label == group) for group in np.unique(label[floats])]
    return [[assembly.names[k] for k in group] for group in groups if len(group) > 1]


def touching_nothing(assembly: Assembly, contacts: ContactSet) -> list[str]:
    """Names of the free parts that touch no other part and are joined to none."""
    return [entry.part for entry in contacts.of(assembly).nearest if not entry.grounded]
