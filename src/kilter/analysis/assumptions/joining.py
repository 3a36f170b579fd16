"""Bodies of parts that touch or overlap, as the rung "joined" of the ladder of assumptions.

Free parts are joined to each other and to parts that are held by name, never to a floor or a plane
of the world (`Part.table`): parts that stand on the same floor are not one body for that reason.
"""

from __future__ import annotations

import numpy as np

from kilter.arrays import Index, Mask, connected
from kilter.assembly import Assembly, Joint
from kilter.assembly.changed_copies import with_fields
from kilter.contact import ContactSet
from kilter.tell.ladder_words import TOUCHES


def touching_or_overlapping(assembly: Assembly, contacts: ContactSet) -> Index:
    """Pairs of parts that touch, overlap or are joined, without floors, shape (K, 2)."""
    pairs = adjoining(assembly, contacts)
    kept: Index = pairs[~tables(assembly)[pairs].any(axis=1)]
    return kept


def adjoining(assembly: Assembly, contacts: ContactSet) -> Index:
    """Pairs of parts that touch, overlap or are joined, with floors, shape (K, 2)."""
    index = assembly.index
    joints = [
        [index[a], index[b]] for a, b in (j.parts for j in assembly.joints) if {a, b} <= {*index}
    ]
    other = [list(pair.ends) for pair in (*contacts.overlaps, *contacts.unsupported)]
    rows = [contacts.patch_parts, np.array([*joints, *other], dtype=np.int64).reshape(-1, 2)]
    pairs: Index = np.unique(np.sort(np.concatenate(rows), axis=1), axis=0)
    return pairs


def tables(assembly: Assembly) -> Mask:
    """Mask of the floors and planes of the world, shape (N,)."""
    return np.array([part.table for part in assembly.parts], dtype=bool)


def body_labels(assembly: Assembly, contacts: ContactSet) -> Index:
    """The body of each part, shape (N,): parts that touch or overlap have the same label."""
    pairs = touching_or_overlapping(assembly, contacts)
    return connected(len(assembly.parts), pairs[:, 0], pairs[:, 1])


def joined(assembly: Assembly, contacts: ContactSet) -> Assembly:
    """The assembly with a fixed joint between every two parts that touch or overlap."""
    names = assembly.names
    known = {frozenset(joint.parts) for joint in assembly.joints if joint.kind == "fixed"}
    held = assembly.geometry.grounded
    pairs = touching_or_overlapping(assembly, contacts)
    pairs = pairs[~held[pairs].all(axis=1)]
    joints = [Joint((names[a], names[b]), why=TOUCHES) for a, b in pairs.tolist()]
    new = [joint for joint in joints if frozenset(joint.parts) not in known]
    return with_fields(assembly, joints=[*assembly.joints, *new])
