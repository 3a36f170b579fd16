"""Warnings of an answer: remarks of the reader, parts that touch nothing, no free parts."""

from __future__ import annotations

import numpy as np

from kilter.arrays import connected
from kilter.assembly import Assembly
from kilter.contact import ContactSet
from kilter.tell.contact_words import group_warnings, lone_warnings

__all__ = ["floating_groups", "loose_parts", "remarks", "touching_nothing"]


def remarks(assembly: Assembly, contacts: ContactSet) -> list[str]:
    """Remarks of the reader, of the geometry and of the contacts, and if nothing can move."""
    found = contacts.of(assembly).remarks()
    if assembly.geometry.grounded.all():
        found.append("every part is held: nothing can move")
    return found


def loose_parts(assembly: Assembly, contacts: ContactSet) -> list[str]:
    """Parts and groups of parts that touch no other part, with the nearest part of each."""
    alone = lone_warnings(contacts.of(assembly).nearest(), assembly.units)
    return alone + group_warnings(floating_groups(assembly, contacts))


def floating_groups(assembly: Assembly, contacts: ContactSet) -> list[list[str]]:
    """Names of the parts of each group that touches no other part and has no held part.

    The parts of a group are connected by contacts, open pairs, joints or bonds. Single parts are
    no groups.
    """
    named = [joint.parts for joint in assembly.joints] + [bond.parts for bond in assembly.bonds]
    index = assembly.index
    linked = [[index[a], index[b]] for a, b in named if a in index and b in index]
    links = np.array(linked, dtype=np.int64).reshape(-1, 2)
    first, second = np.concatenate([contacts.adjacent, links]).T
    count = len(assembly.parts)
    # the ground, index -1, is a further node, which is held
    label = connected(count + 1, first % (count + 1), second % (count + 1))
    held = np.append(assembly.geometry.grounded, True)
    floats = ~np.isin(label, label[held])
    groups = [np.flatnonzero(label == group) for group in np.unique(label[floats])]
    return [[assembly.names[k] for k in group] for group in groups if len(group) > 1]


def touching_nothing(assembly: Assembly, contacts: ContactSet) -> list[str]:
    """Names of the free parts that touch nothing and are joined to nothing."""
    return [one["part"] for one in contacts.of(assembly).nearest() if not one["grounded"]]
