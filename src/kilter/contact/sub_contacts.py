"""The contacts among a subset of the parts, such as those of a half-built assembly.

A contact between two parts does not depend on other parts. So the contacts of an assembly without
some parts are those between the remaining parts.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np

from kilter.arrays import Index, Mask, ragged, starts
from kilter.assembly import Assembly
from kilter.contact.contact_set import ContactSet, DegeneratePoints
from kilter.contact.left_out import PossibleContacts

__all__ = ["contacts_among"]

OfPair = TypeVar("OfPair", bound=Any)


def contacts_among(contacts: ContactSet, assembly: Assembly) -> ContactSet:
    """The contacts that remain if an assembly is reduced to some of its parts in place.

    Parameters
    ----------
    contacts : ContactSet
        Contacts of all parts.
    assembly : Assembly
        Assembly of the subset, with the same names, as `Assembly.without` returns.

    Raises
    ------
    InputError
        If the assembly has a part that the contacts do not know.

    Examples
    --------
    >>> from kilter.contact import contacts
    >>> from kilter.scenes import scene
    >>> tower = scene("tower")
    >>> lower = tower.without(tower.names[-1])
    >>> len(contacts(tower)) - len(contacts_among(contacts(tower), lower))
    1
    """
    kept = np.array([contacts.assembly.index_of(name) for name in assembly.names])
    new_position = np.full(len(contacts.assembly), -1)
    new_position[kept] = np.arange(len(kept))
    patches = np.flatnonzero((new_position[contacts.patch_parts] >= 0).all(axis=1))
    _, rows = ragged(contacts.patch_start, patches)
    degenerate, points = _degenerate_among(contacts.degenerate, new_position)
    return replace(
        contacts,
        assembly=assembly,
        patch_parts=new_position[contacts.patch_parts[patches]],
        patch_start=starts(np.diff(contacts.patch_start)[patches]),
        points=contacts.points[rows],
        normals=contacts.normals[rows],
        unsupported=_renumber(contacts.unsupported, new_position),
        possible=_possible_among(contacts.possible, new_position, points),
        rejected=_renumber(contacts.rejected, new_position),
        overlaps=_renumber(contacts.overlaps, new_position),
        degenerate=degenerate,
        open_pairs=_still_free(_renumber(contacts.open_pairs, new_position), assembly),
        neighbours=(),
        fits=_renumber(contacts.fits, new_position),
        **{name: getattr(contacts, name)[patches] for name in PATCH_FIELDS},
    )


PATCH_FIELDS = (
    "patch_normal",
    "patch_area",
    "patch_gap",
    "patch_mu",
    "patch_kind",
    "patch_accuracy",
    "patch_doubt",
)
"""Fields of a contact set with a row for each patch, except its parts and its points."""


def _renumber(pairs: Sequence[OfPair], new_position: Index) -> tuple[OfPair, ...]:
    """Records of pairs of which both parts remain, with new part indices."""
    kept = []
    for record in pairs:
        a, b = (int(new_position[k]) for k in record.parts)
        if a >= 0 and b >= 0:
            kept.append(replace(record, parts=(a, b)))
    return tuple(kept)


def _still_free(pairs: tuple[OfPair, ...], assembly: Assembly) -> tuple[OfPair, ...]:
    """The open pairs that still have at least one free part."""
    return tuple(p for p in pairs if not all(assembly.parts[k].grounded for k in p.parts))


def _degenerate_among(
    given: DegeneratePoints, new_position: Index
) -> tuple[DegeneratePoints, Index]:
    """Degenerate points between remaining parts, and new index of every old point, (n + 1,).

    The row is -1 for points that are dropped; the last entry is -1 too, for rows -1.
    """
    kept: Mask = (new_position[given.part_a] >= 0) & (new_position[given.part_b] >= 0)
    points = np.flatnonzero(kept)
    _, normals = ragged(given.start, points)
    held = (new_position[given.held_parts] >= 0).all(axis=1)
    new_row = np.full(len(given) + 1, -1)
    new_row[points] = np.arange(len(points))
    return DegeneratePoints(
        new_position[given.part_a[points]],
        new_position[given.part_b[points]],
        given.points[points],
        starts(np.diff(given.start)[points]),
        given.normals[normals],
        given.exact[points],
        new_position[given.held_parts[held]],
        given.held_points[held],
        given.held_normals[held],
    ), new_row


def _possible_among(
    given: PossibleContacts, new_position: Index, new_row: Index
) -> PossibleContacts:
    """Possible forces between remaining parts; the ground, part -1, remains."""
    ends = np.append(new_position, -1)
    a, b = ends[given.part_a], ends[given.part_b]
    rows = np.flatnonzero(((a >= 0) | (given.part_a < 0)) & ((b >= 0) | (given.part_b < 0)))
    kept = given.take(rows)
    return replace(kept, part_a=a[rows], part_b=b[rows], degenerate=new_row[kept.degenerate])
